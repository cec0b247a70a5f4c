//! Pools repeated runs into one result.
//!
//! To compare two versions of a program, each is started for one round at a time, in turns: old,
//! new, old, new. This module joins the rounds of one version into one result file, with a sample
//! from every round. The files of both versions have the same `pairing`.

use anyhow::{Context, bail};
use geobench_harness::measure::conditions;
use geobench_harness::measure::statistics::{self, median};
use geobench_harness::schema::{Cell, ResultFile, Status, Time, changed_program};

use crate::history::compare::CellKeys;

/// Joins `rounds`, each given with the name of its file, in the order in which they were run.
///
/// The samples of a cell are concatenated. A cell that failed in one round is the failed one.
/// Counts are those of the first round, and so are the figures of memory that follow from them.
/// Measured peaks of memory are the largest. The check is that of the round with the largest error.
/// Set-up and phases are medians, and the conditions of the machine the worst.
///
/// # Errors
///
/// When `rounds` is empty, or the programs, models or cells of the rounds differ.
pub fn pool(
    rounds: Vec<(String, ResultFile)>,
    pairing: Option<String>,
) -> anyhow::Result<ResultFile> {
    let mut rest = rounds.into_iter();
    let (first, mut joined) = rest.next().context("there are no rounds to join")?;
    let mut conditions = vec![joined.conditions.take()];
    let mut cells: Vec<Vec<Cell>> = joined.cells.drain(..).map(|cell| vec![cell]).collect();
    for (name, round) in rest {
        if let Some(difference) = difference(&joined, &cells, &round) {
            bail!("{name}: not a round of the same benchmark as {first}: {difference}");
        }
        joined.finished = round.finished;
        joined.sessions.extend(round.sessions);
        conditions.push(round.conditions);
        for (all, cell) in cells.iter_mut().zip(round.cells) {
            all.push(cell);
        }
    }
    joined.pairing = pairing;
    joined.conditions = conditions::worst(conditions.into_iter().flatten());
    joined.cells = cells.into_iter().map(join).collect();
    Ok(joined)
}

/// The first difference between the benchmark of `round` and that of the first round.
fn difference(joined: &ResultFile, cells: &[Vec<Cell>], round: &ResultFile) -> Option<String> {
    if joined.tool != round.tool {
        let of = |file: &ResultFile| {
            let tool = &file.tool;
            let commit = tool.commit.as_deref().unwrap_or("unknown");
            format!("{} {} of commit {commit}", tool.version, tool.profile)
        };
        let (old, new) = (of(joined), of(round));
        return Some(format!("the program is {new} and not {old}"));
    }
    if let Some(changed) = changed_program(joined.programs(), round.programs()) {
        return Some(changed);
    }
    for (a, b) in joined.models.iter().zip(&round.models) {
        if (&a.name, &a.sha256) != (&b.name, &b.sha256) {
            return Some(format!(
                "model {} is not {}, or has changed",
                b.name, a.name
            ));
        }
    }
    if joined.models.len() != round.models.len() || cells.len() != round.cells.len() {
        return Some("it has another number of models or cells".to_owned());
    }
    if !joined.host.is_same_machine(&round.host) {
        let [here, there] = [round, joined].map(|file| file.host.in_words());
        return Some(format!("its machine is {here} and not {there}"));
    }
    let (keys, keys_of_round) = (CellKeys::of(joined), CellKeys::of(round));
    cells.iter().zip(&round.cells).find_map(|(all, cell)| {
        let first = &all[0];
        let (known, own) = (keys.key(first), keys_of_round.key(cell));
        if known != own {
            return Some(format!("it has the cell {own} instead of {known}"));
        }
        let simd = |cell: &Cell| cell.simd.clone().unwrap_or_else(|| "unknown".to_owned());
        (first.simd != cell.simd).then(|| {
            format!(
                "the vector instructions of {own} are {} and not {}",
                simd(cell),
                simd(first)
            )
        })
    })
}

/// Joins the rounds of one cell. `rounds` is not empty.
fn join(mut rounds: Vec<Cell>) -> Cell {
    if let Some(failed) = rounds.iter().position(|c| c.status != Status::Ok) {
        return rounds.swap_remove(failed);
    }
    let over = |of: fn(&Cell) -> Option<f64>| {
        let known: Vec<f64> = rounds.iter().filter_map(of).collect();
        median(&known)
    };
    let most = |of: fn(&Cell) -> Option<u64>| rounds.iter().filter_map(of).max();
    let mut cell = rounds[0].clone();
    let all = |of: fn(&Cell) -> &Vec<f64>| -> Vec<f64> {
        let values = rounds.iter().flat_map(of);
        values.copied().collect()
    };
    let (samples, setup) = (all(|c| &c.time.samples), over(|c| c.time.setup));
    let (outside, claimed) = (all(|c| &c.time.outside), all(|c| &c.time.claimed));
    let time = if claimed.is_empty() {
        Time {
            outside,
            ..statistics::time(samples, setup)
        }
    } else {
        statistics::time_of_program(claimed, outside, all(|c| &c.time.ping), setup)
    };
    cell.time = Time {
        places: rounds.iter().flat_map(|c| c.time.places.clone()).collect(),
        solves: joined_solves(&rounds),
        extraction: over(|c| c.time.extraction),
        ..time
    };
    cell.phases.propagation = over(|c| c.phases.propagation);
    cell.phases.pruning = over(|c| c.phases.pruning);
    cell.phases.management = over(|c| c.phases.management);
    cell.phases = cell.phases.of_time(cell.time.median);
    // `None` if the phases of one round were measured by a clock instead of by sampling.
    let samples = rounds.iter().map(|c| c.phases.samples);
    cell.phases.samples = samples.reduce(|a, b| Some(a?.saturating_add(b?))).flatten();
    cell.memory.heap_peak_bytes = most(|c| c.memory.heap_peak_bytes);
    cell.memory.rss_peak_bytes = most(|c| c.memory.rss_peak_bytes);
    // No largest error is known if it is not finite.
    let error = |c: &&Cell| c.check.max_rel.unwrap_or(f64::INFINITY);
    if let Some(worst) = rounds.iter().max_by(|a, b| error(a).total_cmp(&error(b))) {
        cell.check.clone_from(&worst.check);
    }
    let doubts = rounds.iter().filter_map(|c| c.check.doubt);
    cell.check.doubt = doubts.reduce(f64::max);
    cell.check.wrong_labels = most(|c| c.check.wrong_labels);
    if let Some(counted) = rounds.iter().find(|c| c.instructions.is_some()) {
        cell.instructions = counted.instructions;
        cell.instructions_simd
            .clone_from(&counted.instructions_simd);
    }
    cell
}

/// The number of solves in each sample of all rounds; empty if every sample is one solve.
fn joined_solves(rounds: &[Cell]) -> Vec<usize> {
    if rounds.iter().all(|cell| cell.time.solves.is_empty()) {
        return Vec::new();
    }
    let each = rounds.iter().flat_map(|cell| {
        let solves = cell.time.solves.iter().copied();
        solves
            .chain(std::iter::repeat(1))
            .take(cell.time.samples.len())
    });
    each.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use geobench_harness::exec::mock::{MockBackend, crash_ich};
    use geobench_harness::run::mock::{plan, result, run_mock};

    fn round(backend: &MockBackend) -> ResultFile {
        let mut plan = plan(&["horse"], "mmp,ich", "0");
        plan.sampling = geobench_harness::plan::sampling::Sampling::Fixed(1);
        result(run_mock(&plan, backend))
    }

    fn named(rounds: Vec<ResultFile>) -> Vec<(String, ResultFile)> {
        let names = (1..).map(|i| format!("{i}.json"));
        names.zip(rounds).collect()
    }

    #[test]
    fn samples_follow_each_other_and_are_summarised_anew() {
        // All rounds share a backend, so that the mock times keep increasing.
        let backend = MockBackend::default();
        let rounds: Vec<ResultFile> = (0..6).map(|_| round(&backend)).collect();
        let samples: Vec<f64> = rounds.iter().map(|r| r.cells[1].time.samples[0]).collect();
        assert!(rounds[0].cells[1].time.ci95.is_none() && rounds[0].cells[1].time.note.is_some());

        let joined = pool(named(rounds), Some("turns".to_owned())).unwrap();
        assert_eq!(joined.pairing.as_deref(), Some("turns"));
        assert_eq!(joined.cells.len(), 2);
        let time = &joined.cells[1].time;
        assert_eq!(time.samples, samples);
        assert_eq!(time.median, Some(f64::midpoint(samples[2], samples[3])));
        assert!(time.ci95.is_some() && time.note.is_none());
    }

    #[test]
    fn counts_of_phases_beyond_the_largest_number_stay_there() {
        let first = round(&MockBackend::default());
        let mut second = first.clone();
        second.cells[0].phases.samples = Some(u64::MAX);
        for (of_first, expected) in [(Some(7), Some(u64::MAX)), (None, None)] {
            let mut first = first.clone();
            first.cells[0].phases.samples = of_first;
            let joined = pool(named(vec![first, second.clone()]), None).unwrap();
            assert_eq!(joined.cells[0].phases.samples, expected);
        }
    }

    #[test]
    fn a_failure_in_one_round_is_one_of_the_cell() {
        let crashing = MockBackend {
            alter: Some(crash_ich),
            ..MockBackend::default()
        };
        let rounds = vec![round(&MockBackend::default()), round(&crashing)];
        let joined = pool(named(rounds), None).unwrap();
        assert_eq!(joined.cells[0].time.samples.len(), 2);
        assert_eq!(joined.cells[1].status, Status::Crashed);
        assert!(joined.cells[1].time.samples.is_empty());
    }

    #[test]
    fn rounds_of_something_else_are_refused() {
        let refused = |change: fn(&mut ResultFile)| {
            let first = round(&MockBackend::default());
            let mut second = first.clone();
            change(&mut second);
            let error = pool(named(vec![first, second]), None).unwrap_err();
            error.to_string()
        };
        let start = "2.json: not a round of the same benchmark as 1.json: ";
        assert_eq!(
            refused(|r| r.tool.commit = Some("c0ffee".into())),
            format!(
                "{start}the program is 1.2.3 release of commit c0ffee and not 1.2.3 release of commit unknown"
            )
        );
        assert_eq!(
            refused(|r| r.models[0].sha256 = None),
            format!("{start}model horse is not horse, or has changed")
        );
        assert_eq!(
            refused(|r| r.cells[1].source = Some(9.into())),
            format!("{start}it has the cell horse, ich, source 9 instead of horse, ich, source 0")
        );
        assert_eq!(
            refused(|r| r.cells.truncate(1)),
            format!("{start}it has another number of models or cells")
        );
        let error = pool(Vec::new(), None).unwrap_err();
        assert_eq!(error.to_string(), "there are no rounds to join");
    }
}
