//! A regression gate: compares the newest record of a history with earlier ones. The noise of times
//! is estimated from the variation between commits, not within one run.

use std::collections::{HashMap, HashSet};

use anyhow::bail;
use geobench_harness::measure::statistics::median;
use geobench_harness::schema::Status;
use serde::Serialize;

use crate::history::changes::{FAR, NORMAL_MAD, changes};
use crate::history::compare::{CellKey, Measure, Rules, Subject, TimeKind, percent};
use crate::history::records::{CellRecord, Record};

/// The schema of the comparison in JSON.
pub const SCHEMA: &str = "geobench-gate/1";

/// Fewest base commits from which the noise of times is estimated.
pub const FEWEST: usize = 3;

/// The comparison of the newest record with the records of base commits.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GateReport {
    /// Always [`SCHEMA`].
    pub schema: &'static str,
    /// The newest commit.
    pub commit: String,
    /// The commits of the base, the oldest first.
    pub base: Vec<String>,
    /// The number of base commits with a record while they are too few to judge by, 0 to 2; null
    /// once they are enough.
    pub learning: Option<usize>,
    /// The figures that were compared.
    pub lines: Vec<GateLine>,
    /// What could not be compared.
    pub notes: Vec<String>,
}

/// A figure of a cell, compared with the base.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GateLine {
    /// The cell.
    pub cell: CellKey,
    /// The figure.
    pub figure: &'static str,
    /// The value of the base. For times, the geometric mean of the medians of the base commits. For
    /// other figures, the value at the last base commit that solved the cell. Null for the figure
    /// `status`, and if it is missing.
    pub base: Option<f64>,
    /// The new value; null as for `base`.
    pub new: Option<f64>,
    /// New divided by base; null if one of them is missing.
    pub ratio: Option<f64>,
    /// 95 % prediction interval of the ratio, from the noise between the base commits; null for
    /// figures that are compared exactly.
    pub ci95: Option<[f64; 2]>,
    /// The largest change from commit to commit that counts as noise in the history of the cell, as
    /// a share: the third quartile of these changes and three interquartile ranges. Null for
    /// figures that are compared exactly.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<f64>,
    /// The broken rule, or the new status of a failed cell; null if the cell is not worse.
    pub broken: Option<String>,
    /// The rule beyond whose limit the figure is better; null if it is not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub improved: Option<String>,
}

impl GateReport {
    /// Whether a rule is broken. While the history is learning, none is.
    pub fn is_worse(&self) -> bool {
        self.learning.is_none() && self.lines.iter().any(|line| line.broken.is_some())
    }

    /// Whether enough base commits have records, but nothing could be compared.
    pub fn has_compared_nothing(&self) -> bool {
        self.learning.is_none() && self.lines.is_empty()
    }
}

/// The note on cells that no base commit solved.
fn note_on_unsolved(cells: &[String]) -> Option<String> {
    match cells {
        [] => None,
        [cell] => Some(format!("{cell}: no base commit solved it")),
        [first, ..] => Some(format!(
            "no base commit solved {} cells, of which the first is {first}",
            cells.len()
        )),
    }
}

/// Compares the last of `records`, which are in the order of their commits, with the records of the
/// commits `against`, which are full hashes. These may also be among the records `apart`, of
/// commits on other lines. Only records of the same machine class and suite are used. While the
/// history has records of fewer than [`FEWEST`] other commits, whatever the machine, it is
/// learning.
///
/// # Errors
///
/// When `records` is empty, or the history has records of enough commits but none of those asked
/// for that can be compared with the last.
pub fn gate(
    records: &[Record],
    apart: &[Record],
    against: &[String],
    rules: &Rules,
) -> anyhow::Result<GateReport> {
    let Some(newest) = records.last() else {
        bail!("the history has no records");
    };
    let known: Vec<&Record> = apart.iter().chain(records).collect();
    let (base, learning) = base(&known, newest, against)?;
    let solved = solved_cells(&base);
    let (mut lines, mut notes) = (Vec::new(), Vec::new());
    let mut unsolved = Vec::new();
    for cell in &newest.cells {
        let earlier = solved.get(&cell.cell.identity());
        let earlier = earlier.map_or(&[][..], Vec::as_slice);
        let Some(last) = earlier.last() else {
            unsolved.push(cell.cell.to_string());
            continue;
        };
        if cell.status != Status::Ok {
            let broken = format!("was ok, is {}", cell.status.in_words());
            lines.push(GateLine::of_status(cell, broken));
            continue;
        }
        // Times of other vector instructions do not compare.
        let alike = |c: &&&CellRecord| c.simd.is_none() || c.simd == cell.simd;
        let timed: Vec<&CellRecord> = earlier.iter().filter(alike).copied().collect();
        for kind in [TimeKind::Outside, TimeKind::Claimed] {
            if rules.on(Subject::Time(kind)).is_some() {
                lines.extend(time(kind, cell, &timed, rules));
            }
        }
        match time(TimeKind::Time, cell, &timed, rules) {
            Some(line) => lines.push(line),
            None if rules.on(Subject::Time(TimeKind::Time)).is_some() => {
                let with = if timed.len() < earlier.len() {
                    " of the same vector instructions"
                } else {
                    ""
                };
                notes.push(format!(
                    "{}: time is not compared: the noise needs {FEWEST} base commits with times{with}",
                    cell.cell
                ));
            }
            None => {}
        }
        lines.extend(Measure::all().filter_map(|measure| figure(measure, last, cell, rules)));
    }
    notes.extend(note_on_unsolved(&unsolved));
    let last = base.last().map_or(&[][..], |record| &record.cells);
    let present = newest.cells.iter().map(|cell| cell.cell.identity());
    let present: HashSet<CellKey> = present.collect();
    let is_left = |cell: &&CellRecord| !present.contains(&cell.cell.identity());
    let missing: Vec<&CellRecord> = last.iter().filter(is_left).collect();
    let rule = rules.on(Subject::Missing);
    let rule = rule.filter(|rule| missing.len() as f64 / last.len() as f64 > rule.limit);
    for cell in missing {
        match rule {
            Some(rule) => lines.push(GateLine::of_status(cell, rule.to_string())),
            None => notes.push(format!("{}: not in the new record", cell.cell)),
        }
    }
    if learning.is_none() && rules.iter().next().is_none() {
        notes.push("no rules: no figure is judged, only whether cells end well".to_owned());
    }
    Ok(GateReport {
        schema: SCHEMA,
        commit: newest.commit.clone(),
        learning,
        base: base.iter().map(|r| r.short().to_owned()).collect(),
        lines,
        notes,
    })
}

/// The line on a figure of `cell` against that of the last record of the base, if there is a rule
/// on it.
fn figure(
    measure: Measure,
    last: &CellRecord,
    cell: &CellRecord,
    rules: &Rules,
) -> Option<GateLine> {
    let rule = rules.on(Subject::Figure(measure))?;
    let name = measure.name();
    let [base, new] = [last, cell].map(|cell| cell.figures.get(name).copied());
    if base.is_none() && new.is_none() && !measure.is_due(&cell.cell.algorithm) {
        return None;
    }
    let differ = measure == Measure::Instructions
        && last.instructions_simd.is_some()
        && last.instructions_simd != cell.instructions_simd;
    let (ratio, broken, improved) = match (base, new) {
        (Some(base), Some(new)) if !differ => {
            let ratio = if base == new { 1.0 } else { new / base };
            (
                Some(ratio),
                rule.is_broken(base, new),
                rule.is_surpassed(base, new),
            )
        }
        // A rule on a figure that is missing or does not compare is broken, or the gate would stay
        // open.
        _ => (None, true, false),
    };
    Some(GateLine {
        cell: cell.cell.clone(),
        figure: name,
        base,
        new,
        ratio,
        ci95: None,
        noise: None,
        broken: broken.then(|| rule.to_string()),
        improved: improved.then(|| rule.to_string()),
    })
}

/// The cells that the records of the base have solved, in their order, by what they measure.
fn solved_cells<'r>(base: &[&'r Record]) -> HashMap<CellKey, Vec<&'r CellRecord>> {
    let mut solved: HashMap<CellKey, Vec<&CellRecord>> = HashMap::new();
    let cells = base.iter().flat_map(|record| &record.cells);
    for cell in cells.filter(|cell| cell.status == Status::Ok) {
        solved.entry(cell.cell.identity()).or_default().push(cell);
    }
    solved
}

/// The records of the commits `against` that can be compared with `newest`, and, while the history
/// has too few to judge by, of how many other commits it has records.
///
/// # Errors
///
/// As [`gate`].
fn base<'r>(
    records: &[&'r Record],
    newest: &Record,
    against: &[String],
) -> anyhow::Result<(Vec<&'r Record>, Option<usize>)> {
    let others = records.iter().copied();
    let others = others.filter(|record| record.commit != newest.commit);
    let commits: HashSet<&str> = others
        .clone()
        .map(|record| record.commit.as_str())
        .collect();
    let learning = (commits.len() < FEWEST).then_some(commits.len());
    let is_asked = |record: &&Record| {
        let mut asked = against.iter();
        asked.any(|commit| commit.starts_with(&record.commit))
    };
    let asked: Vec<&Record> = others.filter(is_asked).collect();
    if asked.is_empty() && learning.is_none() {
        bail!(
            "the history has no record of the commits to compare with, apart from the newest, {}",
            newest.short()
        );
    }
    let is_base =
        |record: &&Record| record.machine() == newest.machine() && record.suite == newest.suite;
    let base: Vec<&Record> = asked.into_iter().filter(is_base).collect();
    if base.is_empty() && learning.is_none() {
        bail!(
            "the history has no record of these commits on this class of machine ({}) and suite, \
             apart from the newest, {}",
            newest.machine(),
            newest.short()
        );
    }
    Ok((base, learning))
}

/// Fewest values of which a minority can be told.
const FEWEST_OF_LEVEL: usize = 5;

/// The last level of a series of times: the values since the last change of level by a factor of
/// `1 + least`, without those that are farther from their median than that and than noise (Hampel
/// 1974). So a few slow commits neither widen the noise nor are the measure of the next ones. A
/// level of [`FEWEST`] commits or more is taken to be meant.
fn last_level(values: &[f64], least: f64) -> Vec<f64> {
    let start = changes(values, least)
        .last()
        .map_or(0, |change| change.index);
    let level = &values[start..];
    let middle = |values: &[f64]| median(values).unwrap_or(f64::NAN);
    let centre = middle(level);
    let off = |value: &f64| libm::log(value / centre).abs();
    let spread = middle(&level.iter().map(off).collect::<Vec<_>>()) / NORMAL_MAD;
    let far = (FAR * spread).max(libm::log(1.0 + least));
    let is_kept = |value: &&f64| level.len() < FEWEST_OF_LEVEL || off(value) <= far;
    level.iter().filter(is_kept).copied().collect()
}

/// Compares the time of a cell with the medians of the base commits, as far as they are of their
/// [last level](last_level). The interval is the 95 % prediction interval for one more value, from
/// the mean and the standard deviation of the logarithms and Student's t-distribution. `None` if
/// fewer than [`FEWEST`] commits have times.
fn time(
    kind: TimeKind,
    cell: &CellRecord,
    earlier: &[&CellRecord],
    rules: &Rules,
) -> Option<GateLine> {
    let of = |cell: &CellRecord| median(cell.samples_of(kind)).filter(|median| *median > 0.0);
    let medians: Vec<f64> = earlier.iter().filter_map(|cell| of(cell)).collect();
    let rule = rules.on(Subject::Time(kind));
    let medians = last_level(&medians, rule.map_or(USUAL_LIMIT, |rule| rule.limit));
    let new = of(cell)?;
    if medians.len() < FEWEST {
        return None;
    }
    let n = medians.len() as f64;
    let logarithms: Vec<f64> = medians.iter().map(|&median| libm::log(median)).collect();
    let mean = logarithms.iter().sum::<f64>() / n;
    let squares: f64 = logarithms.iter().map(|x| (x - mean).powi(2)).sum();
    let deviation = (squares / (n - 1.0)).sqrt() * (1.0 + 1.0 / n).sqrt();
    let reach = student(medians.len() - 1) * deviation;
    let ratio = libm::exp(libm::log(new) - mean);
    let ci95 = [ratio * libm::exp(-reach), ratio * libm::exp(reach)];
    let noise = noise(&logarithms);
    let is_noise = noise.is_some_and(|noise| (ratio.max(1.0 / ratio) - 1.0) <= noise);
    let rule = rule.filter(|_| !is_noise);
    let broken = rule.filter(|rule| ci95[0] > 1.0 + rule.limit);
    let improved = rule.filter(|rule| ci95[1] < 1.0 - rule.limit);
    Some(GateLine {
        cell: cell.cell.clone(),
        figure: kind.name(),
        base: Some(libm::exp(mean)),
        new: Some(new),
        ratio: Some(ratio),
        ci95: Some(ci95),
        noise,
        broken: broken.map(ToString::to_string),
        improved: improved.map(ToString::to_string),
    })
}

/// The change that ends a level where no rule has a limit.
const USUAL_LIMIT: f64 = 0.05;

/// Fewest changes from commit to commit from which the threshold of a cell is taken.
const FEWEST_CHANGES: usize = 4;

/// The threshold of a cell by its history, as that of rustc-perf: the third quartile of the changes
/// from commit to commit, as shares, and three interquartile ranges. A level that a past commit
/// changed is one change among many, and does not move the quartiles. `None` if there are too few.
fn noise(logarithms: &[f64]) -> Option<f64> {
    let changes = logarithms.windows(2);
    let mut changes: Vec<f64> = changes
        .map(|pair| libm::exp((pair[1] - pair[0]).abs()) - 1.0)
        .collect();
    if changes.len() < FEWEST_CHANGES {
        return None;
    }
    changes.sort_unstable_by(f64::total_cmp);
    // Interpolated order statistics.
    let quartile = |share: f64| {
        let place = share * (changes.len() - 1) as f64;
        let low = place.floor();
        #[expect(clippy::cast_sign_loss, reason = "a place is not negative")]
        let at = low as usize;
        let next = changes.get(at + 1).unwrap_or(&changes[at]);
        changes[at] + (place - low) * (next - changes[at])
    };
    let [first, third] = [0.25, 0.75].map(quartile);
    Some(third + 3.0 * (third - first))
}

/// The 97.5th percentile of Student's t-distribution with `freedom` degrees of freedom.
fn student(freedom: usize) -> f64 {
    const TABLE: [f64; 30] = [
        12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160,
        2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064, 2.060, 2.056,
        2.052, 2.048, 2.045, 2.042,
    ];
    match freedom {
        0 => f64::INFINITY,
        few => TABLE.get(few - 1).copied().unwrap_or(2.042),
    }
}

impl GateLine {
    /// The line of a cell that failed or is missing.
    fn of_status(cell: &CellRecord, broken: String) -> Self {
        Self {
            cell: cell.cell.clone(),
            figure: "status",
            base: None,
            new: None,
            ratio: None,
            ci95: None,
            noise: None,
            broken: Some(broken),
            improved: None,
        }
    }

    /// The change in words; empty for a status.
    pub fn in_words(&self) -> String {
        match (self.ratio, self.ci95) {
            (Some(ratio), Some(ends)) => {
                let [low, high] = ends.map(|ratio| 100.0 * (ratio - 1.0));
                format!("{} ({low:+.1} to {high:+.1})", percent(ratio))
            }
            (Some(ratio), None) => percent(ratio),
            (None, _) if self.base.is_some() && self.new.is_some() => {
                "other vector instructions".to_owned()
            }
            (None, _) if self.figure == "status" => String::new(),
            (None, _) => "missing".to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::history::trend::tests::history;

    fn compared(records: &[Record], rules: &str) -> GateReport {
        let all: Vec<String> = records.iter().map(|r| r.commit.clone()).collect();
        gate(records, &[], &all, &rules.parse().unwrap()).unwrap()
    }

    fn broken(gate: &GateReport) -> Vec<String> {
        let lines = gate.lines.iter().filter(|line| line.broken.is_some());
        lines
            .map(|l| format!("{} {}", l.cell.algorithm, l.figure))
            .collect()
    }

    #[test]
    fn the_gate_opens_for_noise_and_closes_for_a_slow_commit() {
        let records = history();
        assert_eq!(
            broken(&compared(&records[..8], "time=5%,propagated=0")),
            [""; 0]
        );
        // First the slow commit, then the commit that changes a count.
        assert_eq!(
            broken(&compared(&records[..13], "time=5%,propagated=0")),
            ["vtp time"]
        );
        assert_eq!(
            broken(&compared(&records[..9], "time=5%,propagated=0")),
            ["mmp propagated", "vtp propagated"]
        );
        let mut failed = records[..5].to_vec();
        failed[4].cells[0].status = Status::Crashed;
        assert_eq!(broken(&compared(&failed, "time=5%")), ["mmp status"]);
    }

    #[test]
    fn a_slow_commit_opens_the_gate_for_no_other() {
        // Ten commits at one level, then twice that.
        let mut records = history()[..8].to_vec();
        let fast = records[7].clone();
        let push = |records: &mut Vec<Record>, factor: f64| {
            let mut next = fast.clone();
            let number = records.len();
            next.commit = format!("{number:040x}");
            for (k, sample) in next.cells[0].samples.iter_mut().enumerate() {
                // Noise of a percent.
                *sample *= factor * (1.0 + 0.01 * (f64::from((7 * number + k) as u32 % 5) - 2.0));
            }
            records.push(next);
        };
        push(&mut records, 1.0);
        push(&mut records, 1.0);
        let mut verdicts = Vec::new();
        for _ in 0..6 {
            push(&mut records, 2.0);
            verdicts.push(compared(&records, "time=5%").is_worse());
        }
        // After three commits the new level is taken to be meant.
        assert_eq!(verdicts, [true, true, true, false, false, false]);
    }

    #[test]
    fn commits_on_another_line_are_a_base_and_too_few_are_no_pass() {
        let records = history()[..8].to_vec();
        let rules = "time=5%".parse().unwrap();
        let (apart, line) = (&records[..7], &records[7..]);
        let all: Vec<String> = apart.iter().map(|r| r.commit.clone()).collect();
        let found = gate(line, apart, &all, &rules).unwrap();
        assert_eq!((found.learning, found.base.len()), (None, 7));
        // A range with records of one commit, in a history of many.
        let found = gate(line, apart, &all[..1], &rules).unwrap();
        assert!(found.has_compared_nothing(), "{found:?}");
        assert!(gate(line, apart, &["f".repeat(40)], &rules).is_err());
    }

    #[test]
    fn a_time_below_the_limit_is_an_improvement() {
        let mut records = history()[..8].to_vec();
        for sample in &mut records[7].cells[0].samples {
            *sample /= 1.3;
        }
        let gate = compared(&records, "time=5%,propagated=0");
        assert!(!gate.is_worse());
        let improved = gate.lines.iter().filter_map(|line| line.improved.as_ref());
        assert_eq!(improved.collect::<Vec<_>>(), ["time=5%"]);
    }

    #[test]
    fn a_cell_that_always_varies_has_a_wide_threshold() {
        let steady = [0.0, 0.01, 0.0, 0.01, 0.02, 0.01];
        assert!(noise(&steady).unwrap() < 0.02);
        let noisy = [0.0, 0.4, 0.0, 0.1, -0.3, 0.3];
        assert!(noise(&noisy).unwrap() > 0.4);
        // One change of level among many does not widen it.
        let mut level = [0.0; 12];
        level[6..].fill(0.7);
        assert_eq!(noise(&level), Some(0.0));
        assert_eq!(noise(&steady[..4]), None);
    }

    #[test]
    fn figures_and_cells_that_disappear_passed_the_gate() {
        let mut records = history()[..5].to_vec();
        let last = &mut records[4];
        last.cells[0].figures.remove("propagated");
        assert_eq!(
            broken(&compared(&records, "propagated=0")),
            ["mmp propagated"]
        );
        // The base can lack a figure, too.
        let mut records_without = history()[..5].to_vec();
        records_without[3].cells[0].figures.remove("propagated");
        assert_eq!(
            broken(&compared(&records_without, "propagated=0")),
            ["mmp propagated"]
        );
        records[4].cells.remove(0);
        assert_eq!(broken(&compared(&records, "missing=0")), ["mmp status"]);
        let kept = compared(&records, "missing=50%");
        assert!(broken(&kept).is_empty() && kept.notes[0].contains("not in the new record"));
    }

    #[test]
    fn too_few_commits_and_none_are_said() {
        let records = history();
        let gate_of_two = compared(&records[..3], "time=5%");
        assert!(gate_of_two.notes[0].contains("the noise needs 3 base commits"));
        assert!(gate_of_two.lines.is_empty());
        assert_eq!(gate_of_two.learning, Some(2));
        // None of those asked for has a record, in a history of many.
        assert!(gate(&records, &[], &[], &Rules::default()).is_err());
        let of_none = gate(&records[..1], &[], &[], &Rules::default()).unwrap();
        assert_eq!(of_none.learning, Some(0));
        assert!(!of_none.is_worse() && !of_none.has_compared_nothing());
        // A slow commit is not judged by two others.
        assert!(!compared(&records[10..13], "time=5%").is_worse());
        // From three on, another machine is an error.
        let mut records = records[..4].to_vec();
        records[3].host.cores = 64;
        let all: Vec<String> = records.iter().map(|r| r.commit.clone()).collect();
        let error = gate(&records, &[], &all, &Rules::default()).unwrap_err();
        assert!(error.to_string().contains("no record of these commits"));
    }
}
