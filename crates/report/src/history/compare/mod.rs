//! Compares two result files and finds regressions of the newer one.
//!
//! Two cells match if they have the same model (by its hash), algorithm with parameters, source,
//! goal, threads and group. Figures are compared by kind:
//!
//! * Times vary, so a difference counts only beyond their variation. If the runs of both files took
//!   turns ([`ResultFile::pairing`]), samples are compared pair by pair. Otherwise the ratio has
//!   the interval of Mann and Whitney's test, and the test its p-value. A rule on time is
//!   broken if the whole interval lies beyond its limit.
//! * Counts do not vary. Any change, up or down, means that the algorithm works differently.
//!   Instructions and memory are costs, which may decrease.
//! * A rule is broken if one of the files lacks its figure. Otherwise a gate would pass when the
//!   figure disappears.
//! * A cell that is ok in the old file and not in the new one is always a regression.
//! * A cell that the new file lacks is a regression only under a rule on missing cells, because
//!   users compare parts of a benchmark with the whole.

use std::collections::{BTreeMap, HashMap};

use geobench_harness::measure::mann_whitney::mann_whitney;
use geobench_harness::measure::number::{counted, group};
use geobench_harness::measure::statistics::{median, paired_ratio, unpaired_ratio};
use geobench_harness::schema::{Cell, CellId, ResultFile, Status, changed_program};
use geobench_registry::UsageError;
use geobench_window::{Counter, Counters};
use serde::{Serialize, Serializer};

mod cells;
mod rules;
#[cfg(test)]
mod tests;

pub use cells::CellKey;
pub(crate) use cells::CellKeys;
use cells::matched;
pub use rules::{ComparisonRule, Rules, Subject, TimeKind};

/// The schema of a comparison in JSON.
pub const SCHEMA: &str = "geobench-comparison/1";

/// The comparison of two result files.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FileComparison {
    /// Always [`SCHEMA`].
    pub schema: &'static str,
    /// The older file.
    pub old: ComparedFile,
    /// The newer file.
    pub new: ComparedFile,
    /// The rules, as they are written.
    pub rules: Vec<String>,
    /// Whether the runs of both files took turns, so that samples are compared pair by pair.
    pub paired: bool,
    /// Number of cells with a regression.
    pub regressions: usize,
    /// The cells of both files, in the order of the new file.
    pub cells: Vec<CellChange>,
    /// Cells of the old file that the new one lacks.
    pub missing: Vec<CellKey>,
    /// Cells of the new file that the old one lacks.
    pub added: Vec<CellKey>,
    /// Regressions of the new file as a whole.
    pub overall: Vec<Regression>,
    /// What limits the comparison, such as different machines; one line each.
    pub notes: Vec<String>,
}

impl FileComparison {
    /// Whether there is a regression.
    pub fn is_worse(&self) -> bool {
        self.regressions > 0 || !self.overall.is_empty()
    }

    /// The rule on times and the cells in which nothing is judged by it: all, or all of an
    /// algorithm. A comparison that can never fail is no comparison.
    pub fn unjudged_rule(&self, rules: &Rules) -> Option<String> {
        let kinds = TimeKind::ALL.into_iter();
        kinds
            .filter_map(|kind| Some((kind, rules.on(Subject::Time(kind))?)))
            .find_map(|(kind, rule)| self.unjudged(kind, rule))
    }

    fn unjudged(&self, kind: TimeKind, rule: &ComparisonRule) -> Option<String> {
        let of_programs = kind != TimeKind::Time;
        let mut judged = BTreeMap::<&str, bool>::new();
        for cell in self.cells.iter().filter(|c| c.status == [Status::Ok; 2]) {
            // Our algorithms have no times from outside, and claim none.
            if of_programs && !cell.cell.algorithm.starts_with("ext:") {
                continue;
            }
            let time = match kind {
                TimeKind::Time => &cell.time,
                TimeKind::Outside => &cell.outside_time,
                TimeKind::Claimed => &cell.claimed_time,
            };
            let is_judged = time.as_ref().is_some_and(|time| time.ci95.is_some());
            let is_gone = !cell.regressions.is_empty();
            *judged.entry(&cell.cell.algorithm).or_default() |= is_judged || is_gone;
        }
        if of_programs && judged.is_empty() {
            return Some(format!("{rule} is judged in no cell"));
        }
        let (first, _) = judged.iter().find(|(_, is_judged)| !**is_judged)?;
        Some(if judged.values().any(|is_judged| *is_judged) {
            format!("{rule} is judged in no cell of {first}")
        } else {
            format!("{rule} is judged in no cell")
        })
    }
}

/// One of the two files.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ComparedFile {
    /// The name of the file.
    pub file: String,
    /// Version of the program.
    pub version: String,
    /// Commit of the program.
    pub commit: Option<String>,
    /// Commit of the repository in which the run was started, unless the program is built from it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repository: Option<String>,
    /// The start of the run.
    pub started: String,
}

/// A cell that both files have.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CellChange {
    /// The identity of the cell.
    pub cell: CellKey,
    /// The status in each file.
    pub status: [Status; 2],
    /// Time; null unless both cells are ok and have samples above 0.
    pub time: Option<TimeChange>,
    /// Of an outside program, the time from outside.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outside_time: Option<TimeChange>,
    /// Of an outside program, the time that it claims.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub claimed_time: Option<TimeChange>,
    /// All other figures that at least one of the cells has or that a rule requires.
    pub figures: Vec<FigureChange>,
    /// Regressions of the cell.
    pub regressions: Vec<Regression>,
    /// Figures that are better by more than their rule allows them to be worse.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub improvements: Vec<ImprovedFigure>,
}

/// An improvement.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ImprovedFigure {
    /// The rule.
    pub rule: String,
    /// The description.
    pub what: String,
}

/// A change of a figure that is compared exactly.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FigureChange {
    /// Its name in result files.
    pub name: &'static str,
    /// Its old value, if there is one.
    #[serde(serialize_with = "whole_if_it_is")]
    pub old: Option<f64>,
    /// Its new value, if there is one.
    #[serde(serialize_with = "whole_if_it_is")]
    pub new: Option<f64>,
}

/// Writes counts and bytes without a decimal point, as in result files.
#[allow(clippy::ref_option, clippy::cast_sign_loss)] // Serde's signature; no count is negative.
fn whole_if_it_is<S: Serializer>(value: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    match value {
        Some(value) if value.fract() == 0.0 => serializer.serialize_u64(*value as u64),
        Some(value) => serializer.serialize_f64(*value),
        None => serializer.serialize_none(),
    }
}

impl FigureChange {
    /// New divided by old; 1 if both are equal, also if both are 0. `None` if one is missing.
    pub fn ratio(&self) -> Option<f64> {
        let (old, new) = (self.old?, self.new?);
        Some(if old == new { 1.0 } else { new / old })
    }
}

/// A regression.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Regression {
    /// The broken rule; `None` if the cell was ok and is not any more.
    pub rule: Option<String>,
    /// The description.
    pub what: String,
}

impl Regression {
    fn new(rule: Option<&ComparisonRule>, what: String) -> Self {
        let rule = rule.map(ComparisonRule::to_string);
        Self { rule, what }
    }
}

/// Compares `new` with `old`, each given with the name of its file.
///
/// # Errors
///
/// When they have no cell in common.
pub fn compare(
    (old_name, old): (&str, &ResultFile),
    (new_name, new): (&str, &ResultFile),
    rules: &Rules,
) -> Result<FileComparison, UsageError> {
    let matched = matched(old, new);
    if matched.common.is_empty() {
        return Err(UsageError(format!(
            "{old_name} and {new_name} have no cell in common: models (by their hash), algorithms, \
             sources, threads and groups must be the same"
        )));
    }
    let notes_on_simd = [
        note_on_times(&matched.common),
        note_on_instructions(&matched.common),
    ];
    let paired = old.pairing.is_some() && old.pairing == new.pairing;
    let cells: Vec<CellChange> = matched
        .common
        .into_iter()
        .map(|(key, old, new)| change(key, old, new, rules, paired))
        .collect();
    let mut notes = matched.notes;
    notes.extend(notes_on_machines(old, new));
    notes.extend(notes_on_rules(&cells, rules));
    notes.extend(notes_on_simd.into_iter().flatten());
    Ok(FileComparison {
        schema: SCHEMA,
        old: side(old_name, old),
        new: side(new_name, new),
        rules: rules.iter().map(ComparisonRule::to_string).collect(),
        paired,
        regressions: cells.iter().filter(|c| !c.regressions.is_empty()).count(),
        cells,
        overall: too_many_missing(matched.missing.len(), old.cells.len(), rules)
            .into_iter()
            .collect(),
        missing: matched.missing,
        added: matched.added,
        notes,
    })
}

/// The schema of several comparisons in JSON.
pub const SEVERAL: &str = "geobench-comparisons/1";

/// Several files, each compared with the same one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BaselineComparisons {
    /// Always [`SEVERAL`].
    pub schema: &'static str,
    /// The comparison of each file with the baseline, which is the old file of all.
    pub comparisons: Vec<FileComparison>,
}

impl BaselineComparisons {
    /// Compares each of `files` with `baseline`. Every file is given with its name.
    ///
    /// # Errors
    ///
    /// When one of them has no cell in common with the baseline.
    pub fn new(
        baseline: (&str, &ResultFile),
        files: &[(String, ResultFile)],
        rules: &Rules,
    ) -> Result<Self, UsageError> {
        let compared = files
            .iter()
            .map(|(name, file)| compare(baseline, (name, file), rules));
        Ok(Self {
            schema: SEVERAL,
            comparisons: compared.collect::<Result<_, _>>()?,
        })
    }

    /// Whether one of the files has a regression.
    pub fn is_worse(&self) -> bool {
        self.comparisons.iter().any(FileComparison::is_worse)
    }
}

/// The regression if more cells are missing than a rule allows.
fn too_many_missing(missing: usize, all: usize, rules: &Rules) -> Option<Regression> {
    let rule = rules.on(Subject::Missing)?;
    let share = missing as f64 / all as f64;
    let are = if missing == 1 { "is" } else { "are" };
    (share > rule.limit).then(|| {
        let what = format!("{missing} of {all} cells {are} missing");
        Regression::new(Some(rule), what)
    })
}

fn side(name: &str, file: &ResultFile) -> ComparedFile {
    let is_built = |commit: &String| Some(commit) == file.tool.commit.as_ref();
    let repository = file.repository.as_ref().filter(|repository| {
        !is_built(&repository.commit) && !repository.ancestors.iter().any(is_built)
    });
    ComparedFile {
        file: name.to_owned(),
        version: file.tool.version.clone(),
        commit: file.tool.commit.clone(),
        repository: repository.map(|repository| repository.commit.clone()),
        started: file.started.clone(),
    }
}

fn change(cell: CellKey, old: &Cell, new: &Cell, rules: &Rules, paired: bool) -> CellChange {
    let (mut regressions, mut improvements) = (Vec::new(), Vec::new());
    if old.status == Status::Ok && new.status != Status::Ok {
        let why = new.message.as_deref().unwrap_or("no message");
        let what = format!("was ok, is {}: {why}", new.status.in_words());
        regressions.push(Regression::new(None, what));
    }
    let both_ok = old.status == Status::Ok && new.status == Status::Ok;
    let mut times = TimeKind::ALL.map(|kind| {
        let [old, new] = [old, new].map(|cell| kind.of(&cell.time));
        let time = TimeChange::between(old, new, paired).filter(|_| both_ok);
        let rule = rules.on(Subject::Time(kind)).filter(|_| both_ok);
        // Our algorithms have no times from outside, and claim none.
        let rule = rule.filter(|_| kind == TimeKind::Time || !(old.is_empty() && new.is_empty()));
        if let Some(rule) = rule {
            if let Some(what) = worse_time(kind, time.as_ref(), old, new, rule) {
                regressions.push(Regression::new(Some(rule), what));
            } else if let Some(time) = time.as_ref().filter(|time| time.is_below(rule.limit)) {
                improvements.push(ImprovedFigure {
                    rule: rule.to_string(),
                    what: format!("{} {}", kind.name(), time.in_words()),
                });
            }
        }
        time
    });
    let [time, outside_time, claimed_time] = times.each_mut().map(Option::take);
    let mut figures = Vec::new();
    for measure in Measure::all() {
        let figure = FigureChange {
            name: measure.name(),
            old: measure.of(old),
            new: measure.of(new),
        };
        let rule = rules.on(Subject::Figure(measure)).filter(|_| both_ok);
        let is_due = rule.is_some() && measure.is_due(&new.algorithm);
        if figure.old.is_none() && figure.new.is_none() && !is_due {
            continue;
        }
        figures.push(figure);
        let Some(rule) = rule else {
            continue;
        };
        let kinds = different_instructions(old, new).filter(|_| measure == Measure::Instructions);
        let what = match (figure.old, figure.new, kinds) {
            // The difference may hide a slower solver.
            (Some(old), Some(new), Some([from, to])) => {
                let [old, new] = [old, new].map(exact);
                format!("instructions {old} with {from} -> {new} with {to} do not compare")
            }
            (Some(old), Some(new), None) if rule.is_broken(old, new) => {
                let [from, to] = [old, new].map(exact);
                format!("{} {from} -> {to} ({})", figure.name, percent(new / old))
            }
            (Some(old), Some(new), None) if rule.is_surpassed(old, new) => {
                let [from, to] = [old, new].map(exact);
                improvements.push(ImprovedFigure {
                    rule: rule.to_string(),
                    what: format!("{} {from} -> {to} ({})", figure.name, percent(new / old)),
                });
                continue;
            }
            (Some(_), Some(_), _) => continue,
            (old, new, _) => missing(figure.name, old.map(exact), new.map(exact)),
        };
        regressions.push(Regression::new(Some(rule), what));
    }
    CellChange {
        cell,
        status: [old.status, new.status],
        time,
        outside_time,
        claimed_time,
        figures,
        regressions,
        improvements,
    }
}

/// The description of the regression if one or both files lack a figure.
fn missing(name: &str, old: Option<String>, new: Option<String>) -> String {
    let file = match (&old, &new) {
        (Some(_), None) => "the new file",
        (None, Some(_)) => "the old file",
        _ => "both files",
    };
    let [old, new] = [old, new].map(|value| value.unwrap_or_else(|| "none".to_owned()));
    format!("{name} {old} -> {new}: missing in {file}")
}

/// The description of the regression if the time of an ok cell breaks the rule on times.
fn worse_time(
    kind: TimeKind,
    time: Option<&TimeChange>,
    old: &[f64],
    new: &[f64],
    rule: &ComparisonRule,
) -> Option<String> {
    if let Some(time) = time {
        let is_worse = time.is_above(rule.limit);
        return is_worse.then(|| format!("{} {}", kind.name(), time.in_words()));
    }
    let median = |samples: &[f64]| median(samples).map(|median| format!("{median} s"));
    match [median(old), median(new)] {
        // Both files have samples, but one of them is 0.
        [Some(_), Some(_)] => None,
        [old, new] => Some(missing(kind.name(), old, new)),
    }
}

/// A ratio as a change in percent.
pub(crate) fn percent(ratio: f64) -> String {
    let change = 100.0 * (ratio - 1.0);
    match change.abs() {
        0.0 => "=".to_owned(),
        size if size < 0.01 => format!("{change:+.4} %"),
        size if size < 9.95 => format!("{change:+.2} %"),
        _ => format!("{change:+.1} %"),
    }
}

/// A figure with all digits; whole numbers have thousands separators.
pub(crate) fn exact(value: f64) -> String {
    if value.fract() == 0.0 {
        group(&format!("{value:.0}"))
    } else {
        value.to_string()
    }
}

/// Number of cells of both files that ran on different nodes.
fn cells_on_other_nodes(old: &ResultFile, new: &ResultFile) -> usize {
    let nodes = |file: &ResultFile| -> HashMap<CellId, String> {
        let cells = file.cells.iter();
        let cells = cells.filter_map(|c| Some((c.id(), file.host_of(c).node.clone()?)));
        cells.collect()
    };
    let new = nodes(new);
    let differs = |(cell, node): &(_, _)| new.get(cell).is_some_and(|other| other != node);
    nodes(old).into_iter().filter(differs).count()
}

/// Differences between the machines and programs that make times hard to compare, and conditions
/// that disturbed the runs.
fn notes_on_machines(old: &ResultFile, new: &ResultFile) -> Vec<String> {
    let mut notes = Vec::new();
    if !old.host.is_same_machine(&new.host) {
        notes.push("the files are from different machines: times say little".to_owned());
    }
    let elsewhere = cells_on_other_nodes(old, new);
    if elsewhere > 0 {
        notes.push(format!(
            "{} ran on different nodes of a cluster: such times say little",
            counted(elsewhere, "cell")
        ));
    }
    if old.tool.rustc != new.tool.rustc {
        let name = |file: &ResultFile| file.tool.rustc.clone().unwrap_or_else(|| "unknown".into());
        notes.push(format!(
            "the compilers differ: {} and {}",
            name(old),
            name(new)
        ));
    }
    if let (Some(a), Some(b)) = (&old.tool.rustflags, &new.tool.rustflags)
        && a != b
    {
        notes.push(format!("the compilers' flags differ: '{a}' and '{b}'"));
    }
    let changed = changed_program(old.programs(), new.programs());
    notes.extend(changed.map(|changed| format!("an outside program has changed: {changed}")));
    for (which, file) in [("old", old), ("new", new)] {
        if file.tool.profile != "release" {
            notes.push(format!(
                "the {which} file is of a {} build: its times mean little",
                file.tool.profile
            ));
        }
        let warnings = file.conditions.iter().flat_map(|c| &c.warnings);
        notes.extend(warnings.map(|warning| format!("during the {which} runs {warning}")));
    }
    notes
}

/// The SIMD levels with which instructions were counted in the old and the new cell, if they
/// differ.
fn different_instructions<'c>(old: &'c Cell, new: &'c Cell) -> Option<[&'c str; 2]> {
    let old = old.instructions_simd.as_deref()?;
    let new = new.instructions_simd.as_deref()?;
    (old != new).then_some([old, new])
}

/// A note on the cells whose instructions were counted with different SIMD levels.
fn note_on_instructions(cells: &[(CellKey, &Cell, &Cell)]) -> Option<String> {
    let named = first_and_more(cells, different_instructions)?;
    Some(format!(
        "`instructions` were counted with different vector instructions and do not compare: {named}"
    ))
}

/// A note if times were measured with different vector instructions.
fn note_on_times(cells: &[(CellKey, &Cell, &Cell)]) -> Option<String> {
    fn differ<'c>(old: &'c Cell, new: &'c Cell) -> Option<[&'c str; 2]> {
        let [old, new] = [old, new].map(|cell| cell.simd.as_deref());
        Some([old?, new?]).filter(|[old, new]| old != new)
    }
    let named = first_and_more(cells, differ)?;
    Some(format!(
        "the vector instructions of the solves differ, so that their times compare these as well: {named}"
    ))
}

/// Names the first of the cells whose vector instructions differ, and the number of the others.
fn first_and_more(
    cells: &[(CellKey, &Cell, &Cell)],
    differ: for<'c> fn(&'c Cell, &'c Cell) -> Option<[&'c str; 2]>,
) -> Option<String> {
    let mut others = cells.iter().filter_map(|(key, old, new)| {
        let [old, new] = differ(old, new)?;
        Some(format!("{key} ({old} and {new})"))
    });
    let first = others.next()?;
    Some(match others.count() {
        0 => first,
        more => format!("{first} and {more} more"),
    })
}

/// Notes on rules that could not be applied.
fn notes_on_rules(cells: &[CellChange], rules: &Rules) -> Vec<String> {
    let well: Vec<&CellChange> = cells
        .iter()
        .filter(|c| c.status == [Status::Ok; 2])
        .collect();
    let mut notes = Vec::new();
    let rule_on_time = rules
        .on(Subject::Time(TimeKind::Time))
        .map(ComparisonRule::to_string);
    let without_effect = rule_on_time.as_ref().map_or_else(String::new, |rule| {
        format!(", so that the rule {rule} cannot be broken there")
    });
    let mut note_on_times = |cells: usize, what: &str| {
        if cells > 0 {
            let all = well.len();
            notes.push(format!("{cells} of {all} cells {what}{without_effect}"));
        }
    };
    let times = well.iter().filter_map(|c| c.time.as_ref());
    note_on_times(
        times.filter(|time| time.ci95.is_none()).count(),
        "have too few samples for an interval of the time",
    );
    let broken = |c: &CellChange| {
        let mut rules = c.regressions.iter().filter_map(|r| r.rule.as_ref());
        rules.any(|rule| Some(rule) == rule_on_time.as_ref())
    };
    note_on_times(
        well.iter()
            .filter(|c| c.time.is_none() && !broken(c))
            .count(),
        "lack times above 0 in one of the files",
    );
    for rule in rules.iter() {
        let Subject::Figure(measure) = rule.subject else {
            continue;
        };
        let name = measure.name();
        let of = |cell: &&&CellChange| cell.figures.iter().find(|f| f.name == name).copied();
        // Some algorithms lack counters by design.
        if well.iter().all(|cell| of(&cell).is_none()) {
            notes.push(format!(
                "`{name}` is not compared in {0} of {0} cells: neither file has it",
                well.len()
            ));
        }
        let lacks = |cell: &&&CellChange| {
            of(cell).is_some_and(|figure| figure.old.is_none() || figure.new.is_none())
        };
        let lacking = well.iter().filter(lacks).count();
        if lacking > 0 {
            let how = match measure {
                Measure::Instructions => "run both versions with --instructions",
                _ => "run both versions so that it is measured",
            };
            notes.push(format!(
                "`{name}` is missing in {lacking} of {} cells: {how}, or leave the rule out",
                well.len()
            ));
        }
    }
    notes
}

/// A figure that is compared exactly. Times are not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// A counter of the algorithm.
    Counter(Counter),
    /// The deviation of the wavefront.
    WavefrontDeviation,
    /// The number of instructions executed.
    Instructions,
    /// A figure of memory, by its index in `MEMORY`.
    Memory(usize),
}

type MemoryFigure = (&'static str, fn(&Cell) -> Option<u64>);

/// The figures of memory by their names in result files.
const MEMORY: [MemoryFigure; 4] = [
    ("papers_bytes", |c| c.memory.papers_bytes),
    ("windows_peak_bytes", |c| c.memory.windows_peak_bytes),
    ("heap_peak_bytes", |c| c.memory.heap_peak_bytes),
    ("rss_peak_bytes", |c| c.memory.rss_peak_bytes),
];

impl Measure {
    /// All figures, in the order of the result file.
    pub fn all() -> impl Iterator<Item = Self> {
        let counters = Counter::ALL.iter().copied().map(Self::Counter);
        counters
            .chain([Self::WavefrontDeviation, Self::Instructions])
            .chain((0..MEMORY.len()).map(Self::Memory))
    }

    /// Its name, that of the field in result files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Counter(counter) => counter.key(),
            Self::WavefrontDeviation => Counters::WAVEFRONT_DEVIATION,
            Self::Instructions => "instructions",
            Self::Memory(place) => MEMORY[place].0,
        }
    }

    /// The value in `cell`, if it has one.
    pub fn of(self, cell: &Cell) -> Option<f64> {
        match self {
            Self::Counter(counter) => cell.counters.get(counter).map(|n| n as f64),
            Self::WavefrontDeviation => cell.counters.wavefront_deviation,
            Self::Instructions => cell.instructions.map(|n| n as f64),
            Self::Memory(place) => MEMORY[place].1(cell).map(|n| n as f64),
        }
    }

    /// Whether a rule requires this figure of cells of `algorithm`. Algorithms lack some counters
    /// by design, and external programs may omit any figure.
    pub fn is_due(self, algorithm: &str) -> bool {
        // The other memory figures are derived from counters.
        let is_measured = matches!(
            self.name(),
            "instructions" | "heap_peak_bytes" | "rss_peak_bytes"
        );
        is_measured && !algorithm.starts_with("ext:")
    }

    /// Whether only an increase is worse. Any change of a counter means that the algorithm works
    /// differently.
    const fn is_cost(self) -> bool {
        matches!(self, Self::Instructions | Self::Memory(_))
    }
}

/// How times are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TimeMethod {
    /// By pairs of samples from the same round.
    Paired,
    /// By all samples of both files.
    Unpaired,
}

/// The times of a cell in two files.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimeChange {
    /// The method of comparison.
    pub method: TimeMethod,
    /// Medians of the old and the new times, in seconds.
    pub medians: [f64; 2],
    /// Numbers of old and new samples.
    pub samples: [usize; 2],
    /// New to old: the median of the ratios of pairs, or of all new samples to all old ones.
    pub ratio: f64,
    /// 95 % interval of the ratio; null from fewer than six samples.
    pub ci95: Option<[f64; 2]>,
    /// The p-value of the Mann-Whitney test; null for pairs.
    pub p: Option<f64>,
}

impl TimeChange {
    /// Compares `new` samples with `old` ones. `None` if one of them has none, or one of 0.
    fn between(old: &[f64], new: &[f64], paired: bool) -> Option<Self> {
        let pairs = paired_ratio(new, old).filter(|_| paired);
        let (method, ratio) = match pairs {
            Some(ratio) => (TimeMethod::Paired, ratio),
            None => (TimeMethod::Unpaired, unpaired_ratio(new, old)?),
        };
        Some(Self {
            method,
            medians: [median(old)?, median(new)?],
            samples: [old.len(), new.len()],
            ratio: ratio.ratio,
            ci95: ratio.ci95,
            p: mann_whitney(new, old)
                .filter(|_| method == TimeMethod::Unpaired)
                .map(|test| test.p),
        })
    }

    /// Whether the whole interval lies above an increase by `limit`, as a share of the old time.
    pub fn is_above(&self, limit: f64) -> bool {
        self.ci95.is_some_and(|[low, _]| low > 1.0 + limit)
    }

    /// Whether the whole interval lies below a decrease by `limit`, as a share of the old time.
    pub fn is_below(&self, limit: f64) -> bool {
        self.ci95.is_some_and(|[_, high]| high < 1.0 - limit)
    }

    /// The change with its interval, such as `+3.00 % (+1.0 to +5.0)`.
    pub fn in_words(&self) -> String {
        let change = percent(self.ratio);
        if let Some(ends) = self.ci95 {
            let [low, high] = ends.map(|ratio| 100.0 * (ratio - 1.0));
            format!("{change} ({low:+.1} to {high:+.1})")
        } else {
            let samples = self.samples[0].min(self.samples[1]);
            format!("{change} (of {samples}: no interval)")
        }
    }
}
