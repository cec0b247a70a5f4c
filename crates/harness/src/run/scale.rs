//! The scale of a check, from the whole field of its reference.

use geobench_mesh::Tolerance;
use geobench_mesh::tolerance;

use crate::exec::goal::GoalSpec;
use crate::exec::source::SourceSpec;
use crate::exec::{Failure, Pass, Session, Step};
use crate::schema::ModelRecord;

/// The scale of each distance of an answer; see [`Tolerance`].
#[derive(Clone, Debug, Default)]
pub(crate) enum FieldScale {
    /// No difference has needed it so far. It can cost a run, since it comes from all vertices also
    /// where a run has targets or a radius.
    #[default]
    NotSought,
    /// One for each distance of an answer, or one for all.
    Known(Vec<f64>),
    /// The run of the reference to all vertices failed. No rounding is allowed then.
    Unknown(Failure),
}

impl FieldScale {
    /// The rule with this scale, which allows the relative error `relative`.
    pub(crate) fn rule(&self, relative: f64) -> Tolerance {
        match self {
            Self::Known(scales) => Tolerance::with_scales(scales.clone()).with_relative(relative),
            Self::NotSought | Self::Unknown(_) => Tolerance::relative(relative),
        }
    }

    /// Addition to the message of a disagreement.
    pub(crate) fn remark(&self) -> String {
        match self {
            Self::Unknown(failure) => format!(
                "; no rounding is allowed for, because the reference failed at all vertices: {}",
                failure.message
            ),
            Self::NotSought | Self::Known(_) => String::new(),
        }
    }

    /// Finds the scale for `step` of the reference. `field` has its distances of the vertices, if
    /// they are known. Otherwise the reference runs without the goal of the step.
    pub(crate) fn find(
        session: &mut dyn Session,
        step: &Step<'_>,
        field: Option<Vec<(usize, f64)>>,
    ) -> Self {
        match scales(session, step, field) {
            Ok(scales) => Self::Known(scales),
            Err(failure) => Self::Unknown(failure),
        }
    }
}

fn scales(
    session: &mut dyn Session,
    step: &Step<'_>,
    field: Option<Vec<(usize, f64)>>,
) -> Result<Vec<f64>, Failure> {
    let several = may_be_several(session.model(), step.source);
    let field = if let Some(field) = field {
        field
    } else {
        let whole = Step {
            goal: &GoalSpec::default(),
            pass: Pass::Warmup,
            solves: 1,
            ..*step
        };
        let found = session.execute(&whole)?.distances;
        found.into_iter().enumerate().collect()
    };
    let (vertices, distances): (Vec<usize>, Vec<f64>) = field.into_iter().unzip();
    if !several {
        return Ok(vec![tolerance::scale(distances)]);
    }
    let found = session.components(step)?;
    let components: Vec<u32> = vertices.iter().map(|&v| found.vertices[v]).collect();
    let scales = tolerance::scales(&distances, &components);
    let scale = |&component: &u32| scales.get(component as usize).copied().unwrap_or(0.0);
    Ok(found.places.iter().map(scale).collect())
}

/// Whether distances from `source` may be finite in several components.
fn may_be_several(model: &ModelRecord, source: &SourceSpec) -> bool {
    let points = source.points(model.vertex_count());
    model.components != Some(1) && points.is_ok_and(|points| points.len() > 1)
}
