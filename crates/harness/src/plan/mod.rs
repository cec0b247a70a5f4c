//! Plans: the cells of a benchmark, determined before any model is loaded.

use std::fs::File;
use std::path::Path;
use std::str::FromStr;

use geobench_mesh::Weld;
use geobench_registry::UsageError;
use geobench_registry::{self as registry, Program, Programs, Selection, SimdChoice};
use serde::de::Error;
use serde::{Deserialize, Deserializer};

use crate::exec::expected::Expected;
use crate::exec::goal::GoalSpec;
use crate::exec::limits::Limits;
use crate::exec::model::{ModelRef, hash_file};
use crate::exec::source::SourceSpec;
use crate::plan::sampling::Sampling;
use crate::schema::{
    GroupRecord, IsolationRecord, ModelRecord, PlanRecord, PlannedAlgorithm, PlannedGroup,
    PlannedModel, ProgramFile, ProgramRecord, Shard,
};

pub mod sampling;
pub mod suite;

/// A benchmark: one cell for each combination of model, algorithm and source.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name and tables of the group.
    pub group: GroupRecord,
    /// The models, with unique names.
    pub models: Vec<ModelRef>,
    /// The algorithms, without duplicates.
    pub algorithms: Vec<Selection>,
    /// The sources in each model.
    pub sources: SourceSpec,
    /// Whether each run starts from all sources together.
    pub sources_together: bool,
    /// The goal of each run.
    pub goal: GoalSpec,
    /// Number of timed runs of each cell.
    pub sampling: Sampling,
    /// Number of untimed runs of each cell before the timed ones.
    pub warmup: usize,
    /// Whether each cell has a profiled and a counted run after the timed ones.
    pub counts: bool,
    /// The reference of the checks.
    pub reference: Reference,
    /// Largest relative difference from the reference that passes.
    pub tolerance: f64,
    /// Seed of the order of the runs.
    pub seed: u64,
    /// Vector instructions of all algorithms. For the record only: each algorithm has its own copy.
    pub simd: SimdChoice,
    /// The shard that this process runs; `None` for the whole plan.
    pub shard_range: Option<ShardRange>,
    /// Limits of each run.
    pub limits: Limits,
}

/// The greatest number of faces on which the default reference runs.
pub(crate) const MOST_FACES_UNASKED: u64 = 1_000_000;

/// The answers with which others are compared.
#[derive(Clone, Debug)]
pub enum Reference {
    /// No comparison.
    None,
    /// The answers of an algorithm, which need not be one that is measured.
    Algorithm(Selection),
    /// The answers of an algorithm that checks the only measured one, without being asked for. It
    /// has no row, does not run above a million faces, and its failure fails nothing.
    Unasked(Selection),
    /// Stored distances.
    Files(Expected),
}

impl Reference {
    /// The default: `mmp-fast` if it is measured; otherwise the first exact algorithm; otherwise
    /// `mmp-fast`, which then runs for the check only. Never an approximate algorithm, which would
    /// make correct answers count as wrong. The only exact algorithm of a run is compared with
    /// another one. The default is optional: a model may get another one.
    pub fn usual(algorithms: &[Selection]) -> Self {
        const USUAL: &str = "mmp-fast";
        const OTHER: &str = "ich-fast";
        let usual = algorithms.iter().find(|a| a.label() == USUAL);
        let exact = usual.or_else(|| algorithms.iter().find(|a| a.is_exact()));
        let named = |name| registry::select_one(name);
        match (exact, algorithms) {
            (Some(_), [one]) if one.algorithm().name == USUAL => {
                named(OTHER).map_or(Self::None, Self::Unasked)
            }
            (Some(_), [_]) => named(USUAL).map_or(Self::None, Self::Unasked),
            (Some(selection), _) => Self::Algorithm(selection.clone().as_optional()),
            (None, []) => Self::None,
            (None, _) => named(USUAL).map_or(Self::None, Self::Algorithm),
        }
    }

    /// The algorithm whose answers are the reference.
    pub const fn algorithm(&self) -> Option<&Selection> {
        match self {
            Self::Algorithm(one) | Self::Unasked(one) => Some(one),
            Self::None | Self::Files(_) => None,
        }
    }

    /// Whether a cell fails that could not be compared with it.
    pub const fn is_required(&self) -> bool {
        matches!(self, Self::Algorithm(_) | Self::Files(_))
    }

    /// Resolves the path of a file relative to `directory`.
    ///
    /// # Errors
    ///
    /// If the file cannot be opened.
    pub fn resolve(&mut self, directory: &Path) -> Result<(), UsageError> {
        if let Self::Files(Expected::File(path)) = self {
            *path = directory.join(&path);
            File::open(&path)
                .map_err(|error| UsageError(format!("{}: {error}", path.display())))?;
        }
        Ok(())
    }
}

impl FromStr for Reference {
    type Err = UsageError;

    /// Parses `none`, `file`, the path of a .csv file, or the name of an algorithm.
    fn from_str(text: &str) -> Result<Self, UsageError> {
        if text.eq_ignore_ascii_case("none") {
            return Ok(Self::None);
        }
        if text.eq_ignore_ascii_case("file") {
            return Ok(Self::Files(Expected::BesideModels));
        }
        let ending = Path::new(text).extension();
        if ending.is_some_and(|e| e.eq_ignore_ascii_case("csv")) {
            return Ok(Self::Files(Expected::File(text.into())));
        }
        if let Err(error) = registry::select(text) {
            return Err(UsageError(format!(
                "{error}; also `certificate`, `none`, `file` or a .csv file"
            )));
        }
        registry::select_one(text).map(Self::Algorithm)
    }
}

impl<'de> Deserialize<'de> for Reference {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map_err(D::Error::custom)
    }
}

impl Plan {
    /// Checks that the reference is usable for this plan.
    ///
    /// # Errors
    ///
    /// If the reference is approximate, or is a single file of distances and the plan has more than
    /// one model or source.
    pub fn check_reference(&self) -> Result<(), UsageError> {
        match &self.reference {
            Reference::Algorithm(one) if !one.is_exact() => Err(UsageError(format!(
                "`{}` is not exact, and no reference therefore; take an exact one, such as \
                 `mmp-fast`",
                one.label()
            ))),
            Reference::Files(Expected::File(path))
                if self.models.len() > 1
                    || self.sources_of_model() > 1
                    || self.sources.has_all() =>
            {
                Err(UsageError(format!(
                    "{}: one file holds the distances from one source in one model, but more are \
                     asked for; use `file`",
                    path.display()
                )))
            }
            _ => Ok(()),
        }
    }

    /// Looks up the external programs among the algorithms.
    ///
    /// # Errors
    ///
    /// Names the program that is not in `programs`, or the requested reference if it is not exact.
    pub fn find_programs(&mut self, programs: &Programs) -> Result<(), UsageError> {
        // Until programs are looked up, all count as exact, so one may be the default reference.
        let default = match Reference::usual(&self.algorithms) {
            Reference::Algorithm(usual) => usual.label().to_owned(),
            _ => String::new(),
        };
        let found = self.algorithms.iter().map(|a| a.find_programs(programs));
        let found = found.collect::<Result<Vec<_>, UsageError>>()?;
        self.algorithms = found.into_iter().flatten().collect();
        if let Reference::Algorithm(reference) = &self.reference {
            // A program with several parameter values is the reference only as the first algorithm.
            let found = reference.find_programs(programs)?.into_iter().next();
            self.reference = match found {
                Some(found) if found.is_exact() => Reference::Algorithm(found),
                Some(_) if reference.label() == default => Reference::usual(&self.algorithms),
                Some(found) => Reference::Algorithm(found),
                None => Reference::None,
            };
        }
        self.check_reference()
    }

    /// Number of sources or sets of sources in each model. `all` counts as one source until the
    /// model is known. Units of different models then share indices, but each unit still belongs to
    /// one shard.
    fn sources_of_model(&self) -> usize {
        if self.sources_together {
            1
        } else {
            self.sources.count()
        }
    }

    /// Whether the number of units depends on the models.
    pub(crate) fn is_open(&self) -> bool {
        self.sources.has_all() && !self.sources_together
    }

    /// Whether `model` is solved without this algorithm.
    fn leaves_out(&self, algorithm: &str, model: &ModelRecord) -> bool {
        let mut left_out = self.group.left_out_of(model).iter();
        left_out.any(|label| label == algorithm)
    }

    /// The algorithms that run on `model`.
    pub(crate) fn algorithms_on(&self, model: &ModelRecord) -> impl Iterator<Item = &Selection> {
        let all = self.algorithms.iter();
        all.filter(|one| !self.leaves_out(one.label(), model))
    }

    /// The reference on `model`. A default is chosen anew among the algorithms that are not left
    /// out and cross the junctions of the model.
    pub(crate) fn reference_on(&self, model: &ModelRecord) -> Reference {
        match &self.reference {
            Reference::Algorithm(one) if one.is_optional() => {
                let is_able =
                    |one: &&Selection| model.junctions.is_none() || one.crosses_junctions();
                let able: Vec<_> = self.algorithms_on(model).filter(is_able).cloned().collect();
                if able.len() == self.algorithms.len() {
                    return self.reference.clone();
                }
                match Reference::usual(&able) {
                    Reference::Unasked(other) => Reference::Algorithm(other),
                    usual => usual,
                }
            }
            reference => reference.clone(),
        }
    }

    /// The sources of each unit in `model`, in order.
    ///
    /// # Errors
    ///
    /// If a vertex does not exist, or the model has fewer vertices than `random:N` asks for.
    pub fn units_in(&self, model: &ModelRecord) -> Result<Vec<SourceSpec>, UsageError> {
        let sources = self.sources.with_largest(|| model.first_of_largest());
        let points = sources.points(model.vertex_count())?;
        Ok(if self.sources_together {
            vec![sources]
        } else {
            points.into_iter().map(Into::into).collect()
        })
    }

    /// Number of units, model x source, in the whole plan.
    pub fn units(&self) -> u128 {
        self.models.len() as u128 * self.sources_of_model() as u128
    }

    /// Whether this process runs the unit with these indices of model and source.
    pub(crate) fn has_unit(&self, model: usize, source: usize) -> bool {
        self.shard_range.is_none_or(|shard_range| {
            let before = model as u128 * self.sources_of_model() as u128;
            shard_range
                .shard
                .holds(shard_range.first_unit + before + source as u128)
        })
    }

    /// Number of units of a model in this process.
    pub(crate) fn units_of_model(&self, model: usize) -> u128 {
        let sources = self.sources_of_model() as u128;
        let held = self.shard_range.map_or(sources, |shard_range| {
            let first = shard_range.first_unit + model as u128 * sources;
            shard_range.shard.held(first..first + sources)
        });
        // With `all` sources, every shard may have units of every model.
        held.max(u128::from(self.is_open()))
    }

    /// Number of cells, saturating; `None` if it depends on the models.
    pub fn cells(&self) -> Option<usize> {
        let units = (0..self.models.len()).map(|model| self.units_of_model(model));
        let units = usize::try_from(units.sum::<u128>()).unwrap_or(usize::MAX);
        (!self.is_open()).then(|| units.saturating_mul(self.algorithms.len()))
    }

    /// Total number of runs of all cells, saturating.
    pub fn runs(&self) -> usize {
        (0..self.models.len())
            .map(|model| self.runs_of_model(model))
            .fold(0, usize::saturating_add)
    }

    /// Number of runs of all cells of one model, saturating.
    pub(crate) fn runs_of_model(&self, model: usize) -> usize {
        let units = usize::try_from(self.units_of_model(model)).unwrap_or(usize::MAX);
        units.saturating_mul(self.runs_of_unit())
    }

    /// Number of runs of all cells of one unit, saturating.
    pub(crate) const fn runs_of_unit(&self) -> usize {
        self.algorithms.len().saturating_mul(self.runs_per_cell())
    }

    /// Minimum number of runs of a cell that succeeds: warm-ups, timed runs, one counting and one
    /// profiled run.
    pub(crate) const fn runs_per_cell(&self) -> usize {
        let untimed = if self.counts { 2 } else { 0 };
        self.warmup + self.sampling.fewest() + untimed
    }
}

/// Labels of the algorithms without which a model with junctions is solved: the optional ones that
/// do not cross them. None if no other would be left.
pub fn left_out_at_junctions(algorithms: &[Selection]) -> Vec<String> {
    let left_out = algorithms
        .iter()
        .filter(|one| one.is_optional() && !one.crosses_junctions());
    let labels: Vec<String> = left_out.map(|one| one.label().to_owned()).collect();
    if labels.len() == algorithms.len() {
        return Vec::new();
    }
    labels
}

/// The algorithms for `goal`. Optional ones that cannot end early are left out if it asks for
/// that, unless none would be left; a note names them.
///
/// # Errors
///
/// Names the others that cannot.
pub fn able_to_end_early(
    mut algorithms: Vec<Selection>,
    goal: &GoalSpec,
) -> Result<(Vec<Selection>, Option<String>), UsageError> {
    let can = |one: &Selection| goal.is_everything() || one.ends_early();
    let mut left_out = Vec::new();
    if algorithms.iter().any(can) {
        left_out.extend(algorithms.extract_if(.., |one| one.is_optional() && !can(one)));
    }
    let others = algorithms.iter().filter(|one| !can(one));
    let others: Vec<&str> = others.map(Selection::label).collect();
    let Some(first) = others.first() else {
        let names: Vec<&str> = left_out.iter().map(Selection::label).collect();
        let note = format!(
            "left out, because they cannot end early: {}",
            names.join(", ")
        );
        return Ok((algorithms, (!names.is_empty()).then_some(note)));
    };
    if first.starts_with("ext:") {
        return Err(UsageError(format!(
            "{first} is an outside program, which is asked for all distances; leave it out, or \
             leave out targets and radius"
        )));
    }
    Err(UsageError(format!(
        "{} cannot end early; leave out such algorithms, or leave out targets and radius",
        others.join(", ")
    )))
}

/// The record of `plans`, one per group. Reads the files of all models to hash them.
pub fn record(plans: &[Plan], isolation: IsolationRecord) -> PlanRecord {
    PlanRecord {
        isolation,
        shard: plans.iter().find_map(|plan| Some(plan.shard_range?.shard)),
        groups: plans.iter().map(group).collect(),
    }
}

fn group(plan: &Plan) -> PlannedGroup {
    PlannedGroup {
        name: plan.group.name.clone(),
        models: plan.models.iter().map(model).collect(),
        algorithms: plan.algorithms.iter().map(planned).collect(),
        sources: plan.sources.to_string(),
        sources_together: plan.sources_together,
        targets: plan.goal.targets.as_ref().map(ToString::to_string),
        radius: plan.goal.radius,
        repeat: plan.sampling.most(),
        precision: plan.sampling.precision(),
        warmup: plan.warmup,
        reference: match &plan.reference {
            Reference::None => "none".to_owned(),
            Reference::Algorithm(selection) | Reference::Unasked(selection) => {
                selection.label().to_owned()
            }
            Reference::Files(files) => files.to_string(),
        },
        tolerance: plan.tolerance,
        seed: plan.seed,
        simd: Some(plan.simd.to_string()),
        timeout: plan.limits.timeout.0.map(|time| time.as_secs_f64()),
        memory_limit: plan.limits.memory.0,
        max_decompressed: plan.limits.decompressed.0,
    }
}

fn model(model: &ModelRef) -> PlannedModel {
    PlannedModel {
        name: model.name.clone(),
        spec: model.spec(),
        weld: model.weld().map(Weld::tolerance),
        file_sha256: model.file_sha256(),
    }
}

/// The record of an algorithm with its parameters or, of an external program, its commands.
pub fn planned(selection: &Selection) -> PlannedAlgorithm {
    let settings = selection.settings();
    let program = selection.program().into_iter().flat_map(|program| {
        [
            ("command", program.command.clone().into()),
            ("protocol", program.protocol.name().into()),
            ("prepare", program.prepare.clone().into()),
            ("cleanup", program.cleanup.clone().into()),
            ("parameters", serde_json::json!(program.parameters)),
            ("approximate", program.approximate.into()),
            ("threads", selection.threads().into()),
        ]
    });
    PlannedAlgorithm {
        label: selection.label().to_owned(),
        parameters: settings
            .map(|(name, value)| (name.to_owned(), serde_json::json!(value)))
            .chain(program.map(|(name, value)| (name.to_owned(), value)))
            .collect(),
    }
}

/// The records of the external programs of `plans`, and of the references, in the order of the
/// plans. Reads their files to hash them.
pub fn programs(plans: &[Plan]) -> Vec<ProgramRecord> {
    let mut all: Vec<ProgramRecord> = Vec::new();
    let selections = plans
        .iter()
        .flat_map(|plan| plan.algorithms.iter().chain(plan.reference.algorithm()));
    for program in selections.filter_map(Selection::program) {
        let name = program.described_name();
        if all.iter().all(|known| known.name != name) {
            all.push(ProgramRecord {
                name,
                provenance: program.provenance.clone(),
                files: files(program),
            });
        }
    }
    all
}

/// The executable of an external program, the files among the other words of its command, and those
/// that its table names.
fn files(program: &Program) -> Vec<ProgramFile> {
    let file = |word: &String, place: &Path| ProgramFile {
        path: word.clone(),
        sha256: hash_file(place).ok(),
    };
    let (executable, arguments) = program.command.split_at(program.command.len().min(1));
    let executable = executable.iter().map(|word| {
        let directory = Some(program.directory.clone()).filter(|_| word.contains('/'));
        let path = std::env::var_os("PATH").filter(|_| directory.is_none());
        let searched = path.iter().flat_map(std::env::split_paths);
        let places = directory.into_iter().chain(searched);
        let mut places = places.map(|directory| directory.join(word));
        file(
            word,
            &places.find(|place| place.is_file()).unwrap_or_default(),
        )
    });
    let in_directory = |word: &String| program.directory.join(word);
    let arguments = arguments.iter().filter(|word| in_directory(word).is_file());
    let named = arguments.chain(&program.files);
    executable
        .chain(named.map(|word| file(word, &in_directory(word))))
        .collect()
}

/// The units of one plan that a shard runs.
///
/// A *unit* is one model with one source in one group. Its cells are compared with each other, and
/// their runs are interleaved. Units are numbered from 0 by group, model and source, in the order
/// of the plan. Unit `u` belongs to shard `u mod N + 1` of `N`. Every machine thus computes the
/// same split without loading a model. Neighbouring units, often of similar size, go to different
/// shards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShardRange {
    /// The shard.
    pub shard: Shard,
    /// Index of the first unit of this plan among the units of all plans.
    pub first_unit: u128,
}

impl FromStr for Shard {
    type Err = UsageError;

    fn from_str(text: &str) -> Result<Self, UsageError> {
        let parse = || {
            let (index, count) = text.split_once('/')?;
            let (index, count) = (index.trim().parse().ok()?, count.trim().parse().ok()?);
            (1..=count)
                .contains(&index)
                .then_some(Self { index, count })
        };
        parse().ok_or_else(|| {
            UsageError(format!(
                "`{text}` is not a part: give I/N such as 2/3, with I from 1 to N"
            ))
        })
    }
}

/// Restricts the plans of one benchmark to one shard.
pub fn restrict(plans: &mut [Plan], shard: Shard) {
    let mut first_unit = 0;
    for plan in plans {
        plan.shard_range = Some(ShardRange { shard, first_unit });
        first_unit += plan.units();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::exec::mock::MockBackend;
    use crate::run::mock::{plan, run_mock};
    use crate::schema::SourceLabel;

    #[test]
    fn parts_are_read() {
        assert_eq!("2/3".parse(), Ok(Shard { index: 2, count: 3 }));
        for text in ["", "1", "0/3", "4/3", "1/0", "-1/3", "1/3/5", "a/b"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }

    proptest! {
        #[test]
        fn every_unit_belongs_to_exactly_one_part(count in 1_u32..20, start in 0_u128..50, length in 0_u128..50) {
            let units = start..start + length;
            let mut held = 0;
            for index in 1..=count {
                let shard = Shard { index, count };
                let those = units.clone().filter(|&unit| shard.holds(unit)).count() as u128;
                prop_assert_eq!(shard.held(units.clone()), those);
                held += those;
            }
            prop_assert_eq!(held, length);
        }

        /// Together, all shards have every cell once. Cells that are compared are in the same
        /// shard.
        #[test]
        fn parts_are_disjoint_and_complete(
            models in 1_usize..5,
            sources in prop::sample::select(vec!["0", "3,1", "random:3", "all", "2,0,1,3", "random:9", "1,7"]),
            count in 1_u32..9,
            groups in 1_usize..3,
        ) {
            let names = ["a", "b", "c", "d"];
            let mut plans: Vec<Plan> = (0..groups)
                .map(|g| {
                    let mut plan = plan(&names[..models - g.min(models - 1)], "mmp,vtp", sources);
                    plan.group.name = Some(format!("group {g}"));
                    plan.sampling = Sampling::Fixed(1);
                    plan
                })
                .collect();
            let keys = |plans: &[Plan]| -> Vec<(String, String, Option<SourceLabel>, String)> {
                let backend = MockBackend { refuse: vec!["b"], ..MockBackend::default() };
                plans
                    .iter()
                    .flat_map(|plan| run_mock(plan, &backend).cells)
                    .map(|c| (c.group.unwrap(), c.model, c.source, c.algorithm))
                    .collect()
            };
            let mut whole = keys(&plans);
            let mut parts = Vec::new();
            for index in 1..=count {
                restrict(&mut plans, Shard { index, count });
                let part = keys(&plans);
                for pair in part.chunks(2) {
                    prop_assert_eq!((&pair[0].1, &pair[0].2), (&pair[1].1, &pair[1].2));
                }
                parts.extend(part);
            }
            whole.sort();
            parts.sort();
            // Every part refuses a model that has no number of sources.
            parts.dedup_by(|a, b| a.2.is_none() && a == b);
            prop_assert_eq!(parts, whole);
        }
    }
}
