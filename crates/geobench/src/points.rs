//! Locates the sources and targets of a command on a mesh.

use anyhow::Context;
use clap::Args;
use geobench_harness::exec::goal::GoalSpec;
use geobench_harness::exec::model::{largest_component, surface_components};
use geobench_harness::exec::source::{Locator, PointSpec, SourceSpec, TargetSpec};
use geobench_harness::plan::suite::options::{GoalOptions, SourceOption, WantedTarget};
use geobench_harness::schema::SourceLabel;
use geobench_harness::usage::read_text;
use geobench_mesh::{Mesh, Refined, SurfacePoint, VertexId};
use geobench_window::Goal;

use crate::terminal;

/// Sources of a command on one model.
#[derive(Args, Debug)]
#[command(mut_arg("source", |source| source.required(true).help(SOURCES_HELP)))]
pub(crate) struct SourcesOptions {
    #[command(flatten)]
    source: SourceOption,

    #[command(flatten)]
    pub(crate) far: FarOption,
}

const SOURCES_HELP: &str = "The source: first, largest (the first vertex of the largest component), a \
    vertex number, random:N[,seed=S], all, edge:A-B,T, face:F,U,V,W, at:X,Y,Z or a list of these; may \
    be repeated. Of several sources the nearest counts";

impl SourcesOptions {
    /// All sources, each once. A note names those given twice.
    pub(crate) fn all(&self) -> SourceSpec {
        self.far
            .sources(distinct(self.source.source.iter().flatten()))
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

    pub(crate) fn target(self, target: TargetSpec) -> TargetSpec {
        if self.far { target.even_far() } else { target }
    }

    /// The targets of `goal` and of its file, where `-` is standard input. `None` if there are
    /// none, which means all vertices.
    ///
    /// # Errors
    ///
    /// If the file cannot be read, has no targets, or has a line that is not a target.
    pub(crate) fn targets(self, goal: &GoalOptions) -> anyhow::Result<Option<Vec<WantedTarget>>> {
        let all = goal.wanted(read_text)?.into_iter();
        let all = all.map(|(target, place)| (self.target(target), place));
        Ok(Some(all.collect()).filter(|all: &Vec<_>| !all.is_empty()))
    }

    /// Accepts distant sources and targets, if they are to be accepted.
    pub(crate) fn apply(self, source: &mut SourceOption, goal: &mut GoalOptions) {
        for one in source.source.iter_mut().flatten() {
            *one = self.sources(one.clone());
        }
        for one in goal.target.target.iter_mut().flatten() {
            *one = self.target(one.clone());
        }
    }
}

/// All sources, each once. A note names those given twice.
pub(crate) fn distinct<'s>(sources: impl Iterator<Item = &'s SourceSpec>) -> SourceSpec {
    let (sources, notes) = SourceSpec::of_all(sources.cloned()).distinct();
    terminal::notes(&notes);
    sources
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
