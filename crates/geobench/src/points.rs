//! Locates the sources and targets of a command on a mesh.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail};
use clap::{ArgGroup, Args};
use geobench_harness::exec::model::{largest_component, surface_components};
use geobench_harness::exec::point::{Locator, PointSpec};
use geobench_harness::exec::point_files::{Pair, curve_in, pairs_in};
use geobench_harness::exec::source::{SourceSpec, TargetSpec};
use geobench_harness::plan::suite::options::{GoalOptions, SourceOption, TargetOption, Wanted};
use geobench_harness::schema::SourceLabel;
use geobench_harness::usage::read_text;
use geobench_mesh::{Curve, CurveError, Mesh, Refined, SurfacePoint, VertexId};

use crate::terminal;

/// Sources of a command on one model.
#[derive(Args, Debug)]
#[command(
    mut_arg("source", |source| source.help(SOURCES_HELP)),
    // Commands with other sources add these.
    group(ArgGroup::new("from").required(true).multiple(true).args(["source", "sources"])),
)]
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
    /// The sources of the options and of the sources file, where `-` is standard input. A note
    /// names those given twice.
    ///
    /// # Errors
    ///
    /// If the file cannot be read, has no sources, or has a line that is not a source.
    pub(crate) fn all(&self) -> anyhow::Result<Vec<Wanted<SourceSpec>>> {
        let all = self.source.wanted(read_text)?;
        distinct(all.iter().map(|(source, _)| source));
        let all = all.into_iter();
        let all = all.map(|(source, place)| (self.far.sources(source), place));
        Ok(all.collect())
    }

    /// The sources file.
    pub(crate) fn file(&self) -> Option<&Path> {
        self.source.file()
    }
}

/// Pairs of points in place of sources and targets.
#[derive(Args, Debug)]
pub(crate) struct PairsOption {
    /// The distances between pairs of points, from a file with a source and a target in each line,
    /// as in 0,17 or 0,"face:3,0.2,0.3,0.5"
    #[arg(long, value_name = "FILE", conflicts_with_all = ["source", "sources", "target", "targets"])]
    pub(crate) pairs: Option<PathBuf>,
}

impl PairsOption {
    /// The pairs of the file, where `-` is standard input.
    ///
    /// # Errors
    ///
    /// If the file cannot be read, has no pairs, or has a line that is not a pair.
    pub(crate) fn read(&self, far: FarOption) -> anyhow::Result<Option<Vec<Pair>>> {
        let Some(path) = &self.pairs else {
            return Ok(None);
        };
        let text = read_text(path).map_err(|error| anyhow!("{}: {error}", path.display()))?;
        let pairs = pairs_in(path, &text)?.into_iter();
        let pairs = pairs.map(|(points, place)| (points.map(|point| far.point(point)), place));
        Ok(Some(pairs.collect()))
    }
}

/// Curves as sources.
#[derive(Args, Debug)]
pub(crate) struct CurvesOption {
    /// A curve as source, from a file with its points in order, one SRC in each line. Two that
    /// follow each other lie in one face, and a last point equal to the first closes the curve;
    /// may be repeated. Distances of vertices only, by mmp
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = ["each", "pairs", "target", "targets"]
    )]
    curve: Vec<PathBuf>,

    /// The edges that have one face only as sources. Distances of vertices only, by mmp
    #[arg(long, conflicts_with_all = ["each", "pairs", "target", "targets"])]
    borders: bool,
}

impl CurvesOption {
    /// The option that asks for the first curve, for messages.
    pub(crate) fn option(&self) -> &'static str {
        if self.curve.is_empty() {
            "--borders"
        } else {
            "--curve"
        }
    }

    /// The files of curves.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        self.curve.iter().map(PathBuf::as_path)
    }

    /// The curves on `mesh`, each with its label. Notes on points that were moved are told, unless
    /// `is_quiet`.
    ///
    /// # Errors
    ///
    /// If a file cannot be read, has no curve or one that does not lie on the mesh, or if borders
    /// are asked for and there are none.
    pub(crate) fn on(
        &self,
        mesh: &Mesh,
        far: FarOption,
        is_quiet: bool,
    ) -> anyhow::Result<Vec<(SourceLabel, Curve)>> {
        let mut all = Vec::new();
        let mut locator = Locator::new(mesh);
        for path in &self.curve {
            let text = read_text(path).map_err(|error| anyhow!("{}: {error}", path.display()))?;
            let lines = curve_in(path, &text)?;
            let mut points = Vec::new();
            for (spec, place) in &lines {
                let found = locator.locate(far.point(*spec));
                let found = found.with_context(|| place.clone())?;
                terminal::notes(found.note().filter(|_| !is_quiet).as_slice());
                points.push(found.point);
            }
            let curve = Curve::new(points);
            curve.segments(mesh).map_err(|error| match error {
                CurveError::Apart { ends } | CurveError::Ambiguous { ends, .. } => {
                    anyhow!("{}: {error}", lines[ends[1]].1)
                }
                _ => anyhow!("{}: {error}", path.display()),
            })?;
            let label = format!("curve:{}", path.display());
            all.push((SourceLabel::Other(label), curve));
        }
        if self.borders {
            let borders = mesh.borders();
            if borders.is_empty() {
                bail!("--borders: each edge of the model has two faces or more");
            }
            let label = || SourceLabel::Other("borders".to_owned());
            all.extend(borders.into_iter().map(|border| (label(), border)));
        }
        Ok(all)
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

    const fn point(self, point: PointSpec) -> PointSpec {
        if self.far { point.even_far() } else { point }
    }

    /// The targets of the options and of their file, where `-` is standard input. `None` if there
    /// are none, which means all vertices.
    ///
    /// # Errors
    ///
    /// If the file cannot be read, has no targets, or has a line that is not a target.
    pub(crate) fn targets(
        self,
        options: &TargetOption,
    ) -> anyhow::Result<Option<Vec<Wanted<TargetSpec>>>> {
        let all = options.wanted(read_text)?.into_iter();
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
    /// Locates the sources, each once, and the targets, which are `None` for all vertices. `model`
    /// is the name of the mesh in messages.
    ///
    /// # Errors
    ///
    /// If a point does not exist.
    pub(crate) fn new(
        mesh: &Mesh,
        sources: &[Wanted<SourceSpec>],
        targets: Option<&[Wanted<TargetSpec>]>,
        model: &str,
    ) -> anyhow::Result<Self> {
        let vertices = mesh.vertex_count();
        let first = || largest_component(mesh).map_or(0, |largest| largest.first);
        let mut from = Vec::new();
        let mut seen = HashSet::new();
        for (source, line) in sources {
            let place = line.as_deref().unwrap_or(model);
            let points = source.with_largest(first).points(vertices);
            let mut points = points.with_context(|| place.to_owned())?;
            if sources.len() > 1 {
                points.retain(|point| seen.insert(point.to_string()));
            }
            from.extend(points.into_iter().map(|point| (point, place)));
        }
        let mut to = Vec::new();
        for (target, line) in targets.into_iter().flatten() {
            let place = line.as_deref().unwrap_or(model);
            let points = target.points(vertices).with_context(|| place.to_owned())?;
            to.extend(points.into_iter().map(|point| (point, place)));
        }
        let count = from.len();
        let all = from.into_iter().chain(to);
        Self::located(mesh, all, count, targets.is_some())
    }

    /// Locates the points of `pairs`: as many sources as targets.
    ///
    /// # Errors
    ///
    /// If a point does not exist.
    pub(crate) fn of_pairs(mesh: &Mesh, pairs: &[Pair]) -> anyhow::Result<Self> {
        let ends = |end: usize| pairs.iter().map(move |(pair, line)| (pair[end], &**line));
        Self::located(mesh, ends(0).chain(ends(1)), pairs.len(), true)
    }

    /// Locates points, each with its place in messages: the `sources` first ones are sources, the
    /// others targets, unless all vertices are.
    fn located<'p>(
        mesh: &Mesh,
        points: impl Iterator<Item = (PointSpec, &'p str)>,
        sources: usize,
        has_targets: bool,
    ) -> anyhow::Result<Self> {
        let mut locator = Locator::new(mesh);
        let mut notes = Vec::new();
        let mut places: Vec<SurfacePoint> = Vec::new();
        let mut labels = Vec::new();
        for (point, place) in points {
            let found = locator.locate(point);
            let found = found.with_context(|| place.to_owned())?;
            notes.extend(found.note());
            places.push(found.point);
            labels.push(point.label());
        }
        let refined = mesh.with_points(&places)?;
        let of_targets = labels.split_off(sources);
        let (from, to) = refined.vertices.split_at(sources);
        Ok(Self {
            sources: labels.into_iter().zip(from.iter().copied()).collect(),
            targets: has_targets.then(|| (of_targets, to.to_vec())),
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

    /// The vertices of the targets; `None` for all vertices.
    pub(crate) fn target_vertices(&self) -> Option<&[VertexId]> {
        self.targets.as_ref().map(|(_, vertices)| &vertices[..])
    }

    /// Says on standard error where points were found, and how much of the model is connected with
    /// the sources, if not all is. Distances are from the nearest source, or `apart`, from each.
    pub(crate) fn tell(&self, mesh: &Mesh, apart: bool) {
        terminal::notes(&self.notes);
        self.tell_components(mesh, apart && self.sources.len() > 1);
    }

    fn tell_components(&self, mesh: &Mesh, apart: bool) {
        let of_vertices = self.refined.mesh.components();
        let components = surface_components(mesh, &of_vertices);
        let mut reached: Vec<u32> = (self.sources.iter())
            .map(|(_, v)| of_vertices[v.index()])
            .collect();
        reached.sort_unstable();
        reached.dedup();
        let (all, vertices) = (components.len(), mesh.vertex_count());
        // A vertex in no face is a component of its own, which is not counted.
        let on_surface = reached.iter().filter(|part| components.contains_key(part));
        let on_surface = on_surface.count();
        if all <= 1 || !apart && on_surface >= all {
            return;
        }
        let connected = reached.iter().map(|part| components.get(part));
        let sizes: Vec<usize> = connected
            .map(|part| part.map_or(1, |part| part.vertices))
            .collect();
        let connected: usize = sizes.iter().sum();
        terminal::notes(&[match &self.sources[..] {
            _ if apart => {
                let [least, most] = [sizes.iter().min(), sizes.iter().max()];
                let [least, most] = [least, most].map(|size| size.copied().unwrap_or(0));
                let size = if least < most {
                    format!("{least} to {most}")
                } else {
                    most.to_string()
                };
                format!(
                    "each source is in a component of {size} of {vertices} vertices; {all} \
                     components"
                )
            }
            [(label, _)] => format!(
                "source {label} is in a component of {connected} of {vertices} vertices; {all} \
                 components"
            ),
            _ => format!(
                "the sources are in {on_surface} of {all} components, with {connected} of {vertices} \
                 vertices"
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
