//! Locates the sources and targets of a command on a mesh.

use std::path::PathBuf;

use anyhow::{Context, anyhow};
use clap::Args;
use geobench_harness::exec::goal::{GoalSpec, targets_in};
use geobench_harness::exec::model::{largest_component, surface_components};
use geobench_harness::exec::source::{Locator, PointSpec, SourceSpec, TargetSpec};
use geobench_harness::schema::SourceLabel;
use geobench_harness::usage::read_text;
use geobench_mesh::{Mesh, Refined, SurfacePoint, VertexId};
use geobench_window::Goal;

use crate::terminal;

/// Sources of a command on one model.
#[derive(Args, Debug)]
pub(crate) struct SourcesOptions {
    /// The source: first, largest (the first vertex of the largest component), a vertex number,
    /// random:N[,seed=S], all, edge:A-B,T, face:F,U,V,W, at:X,Y,Z or a list of these; may be
    /// repeated. Of several sources the nearest counts
    #[arg(
        long,
        value_name = "SRC",
        required = true,
        allow_negative_numbers = true
    )]
    pub(crate) source: Vec<SourceSpec>,

    #[command(flatten)]
    pub(crate) far: FarOption,
}

impl SourcesOptions {
    /// All sources, each once. A note names those given twice.
    pub(crate) fn all(&self) -> SourceSpec {
        self.far.sources(distinct(&self.source))
    }
}

/// Which positions are accepted.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct FarOption {
    /// Take the nearest point of the surface also for positions that are farther from it than its
    /// size
    #[arg(long)]
    far: bool,
}

impl FarOption {
    pub(crate) fn sources(self, sources: SourceSpec) -> SourceSpec {
        if self.far {
            sources.even_far()
        } else {
            sources
        }
    }

    pub(crate) fn targets(self, targets: TargetSpec) -> TargetSpec {
        if self.far {
            targets.even_far()
        } else {
            targets
        }
    }
}

/// All sources, each once. A note names those given twice.
pub(crate) fn distinct(sources: &[SourceSpec]) -> SourceSpec {
    let (sources, notes) = SourceSpec::of_all(sources.iter().cloned()).distinct();
    terminal::notes(&notes);
    sources
}

/// What runs are to find.
#[derive(Args, Debug)]
pub(crate) struct GoalOptions {
    /// Only the distances of these points, in the forms of --source; may be repeated. Runs end as
    /// soon as they are final [default: all vertices]
    #[arg(long, value_name = "DST", allow_negative_numbers = true)]
    pub(crate) target: Vec<TargetSpec>,

    /// The same from a file with one DST in a line
    #[arg(long, value_name = "FILE")]
    pub(crate) targets: Option<PathBuf>,

    /// Only distances up to R, in the units of the model; others are infinite. Runs end there
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = radius)]
    pub(crate) radius: Option<f64>,
}

/// Parses a distance that is at least 0.
fn radius(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(radius) if radius >= 0.0 && radius.is_finite() => Ok(radius),
        _ => Err("give a distance of 0 or more".to_owned()),
    }
}

/// A target as specified by the user, and its file and line if it was read from a file.
pub(crate) type WantedTarget = (TargetSpec, Option<String>);

impl GoalOptions {
    /// The targets of the options and of the targets file, where `-` is standard input. `None` if
    /// there are none, which means all vertices.
    ///
    /// # Errors
    ///
    /// If the file cannot be read, has no targets, or has a line that is not a target.
    pub(crate) fn wanted(&self, far: FarOption) -> anyhow::Result<Option<Vec<WantedTarget>>> {
        let named = self.target.iter().map(|target| (target.clone(), None));
        let mut all: Vec<WantedTarget> = named.collect();
        if let Some(path) = &self.targets {
            let text = read_text(path).map_err(|error| anyhow!("{}: {error}", path.display()))?;
            let read = targets_in(path, &text)?.into_iter();
            all.extend(read.map(|(target, place)| (target, Some(place))));
        }
        for (target, _) in &mut all {
            *target = far.targets(target.clone());
        }
        Ok((!all.is_empty()).then_some(all))
    }

    /// The goal of the runs.
    ///
    /// # Errors
    ///
    /// As [`wanted`](Self::wanted).
    pub(crate) fn goal(&self, far: FarOption) -> anyhow::Result<GoalSpec> {
        let targets = self.wanted(far)?;
        let targets = targets.map(|all| TargetSpec::of_all(all.into_iter().map(|(one, _)| one)));
        Ok(GoalSpec {
            targets,
            radius: self.radius,
        })
    }
}

/// Sources and targets as vertices of a refined mesh. The refined mesh is the mesh of the model
/// with further vertices at the points that are not vertices.
pub(crate) struct LocatedPoints {
    pub(crate) refined: Refined,
    /// The points on the mesh of the model, in the order of `refined.vertices`: sources, then
    /// targets.
    pub(crate) places: Vec<SurfacePoint>,
    pub(crate) sources: Vec<(SourceLabel, VertexId)>,
    /// Labels and vertices of the targets; `None` for all vertices of the model.
    pub(crate) targets: Option<(Vec<SourceLabel>, Vec<VertexId>)>,
    /// Messages to the user, for example on a point that was moved onto the mesh.
    pub(crate) notes: Vec<String>,
}

impl LocatedPoints {
    /// Locates the sources and the targets `wanted`, which are `None` for all vertices. `model` is
    /// the name of the mesh in messages.
    ///
    /// # Errors
    ///
    /// If a point does not exist.
    pub(crate) fn new(
        mesh: &Mesh,
        sources: &SourceSpec,
        wanted: Option<&[WantedTarget]>,
        model: &str,
    ) -> anyhow::Result<Self> {
        let vertices = mesh.vertex_count();
        let mut locator = Locator::new(mesh);
        let mut notes = Vec::new();
        let mut places: Vec<SurfacePoint> = Vec::new();
        let mut locate = |points: Vec<PointSpec>| -> anyhow::Result<Vec<SourceLabel>> {
            for &point in &points {
                let found = locator.locate(point)?;
                notes.extend(found.note());
                places.push(found.point);
            }
            Ok(points.iter().map(PointSpec::label).collect())
        };
        let first = || largest_component(mesh).map_or(0, |largest| largest.first);
        let sources = sources.with_largest(first).points(vertices);
        let sources = sources.map_err(anyhow::Error::new);
        let sources = sources.and_then(&mut locate);
        let sources = sources.with_context(|| model.to_owned())?;
        let mut labels = Vec::new();
        for (target, place) in wanted.into_iter().flatten() {
            let found = target.points(vertices).map_err(anyhow::Error::new);
            let found = found.and_then(&mut locate);
            let place = || place.clone().unwrap_or_else(|| model.to_owned());
            labels.extend(found.with_context(place)?);
        }
        let refined = mesh.with_points(&places)?;
        let (from, to) = refined.vertices.split_at(sources.len());
        Ok(Self {
            sources: sources.into_iter().zip(from.iter().copied()).collect(),
            targets: wanted.is_some().then(|| (labels, to.to_vec())),
            notes,
            places,
            refined,
        })
    }

    /// The sources as vertices.
    pub(crate) fn source_vertices(&self) -> Vec<VertexId> {
        self.sources.iter().map(|(_, vertex)| *vertex).collect()
    }

    /// The labels of the sources.
    pub(crate) fn source_labels(&self) -> Vec<SourceLabel> {
        self.sources
            .iter()
            .map(|(label, _)| label.clone())
            .collect()
    }

    /// The goal of a solver: the distances of the targets, or of all vertices without targets, up
    /// to `radius`.
    pub(crate) fn goal(&self, radius: Option<f64>) -> Goal {
        let goal = GoalSpec {
            targets: None,
            radius,
        };
        goal.of_solver(self.targets.as_ref().map(|(_, vertices)| &vertices[..]))
    }

    /// Says on standard error where points were found, and how much of the model is connected with
    /// the sources, if not all is.
    pub(crate) fn tell(&self, mesh: &Mesh) {
        terminal::notes(&self.notes);
        self.tell_components(mesh);
    }

    fn tell_components(&self, mesh: &Mesh) {
        let of_vertices = self.refined.mesh.components();
        let components = surface_components(mesh, &of_vertices);
        let mut reached: Vec<u32> = (self.sources.iter())
            .map(|(_, v)| of_vertices[v.index()])
            .collect();
        reached.sort_unstable();
        reached.dedup();
        let (all, vertices) = (components.len(), mesh.vertex_count());
        if all <= 1 || reached.len() >= all {
            return;
        }
        // A vertex in no face is a component of its own.
        let connected = reached.iter().map(|part| components.get(part));
        let connected: usize = connected
            .map(|part| part.map_or(1, |part| part.vertices))
            .sum();
        terminal::notes(&[match &self.sources[..] {
            [(label, _)] => format!(
                "source {label} is in a component of {connected} of {vertices} vertices; {all} \
                 components"
            ),
            _ => format!(
                "the sources are in {} of {all} components, with {connected} of {vertices} vertices",
                reached.len()
            ),
        }]);
    }

    /// The labels of the targets; `None` for all vertices.
    pub(crate) fn labels(&self) -> Option<&[SourceLabel]> {
        self.targets.as_ref().map(|(labels, _)| &labels[..])
    }

    /// Coordinates of the sources; empty for a mesh without positions.
    pub(crate) fn positions(&self, mesh: &Mesh) -> Vec<[f64; 3]> {
        let places = self.places.iter().take(self.sources.len());
        places.filter_map(|place| mesh.position_of(place)).collect()
    }
}
