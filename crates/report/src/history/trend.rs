//! Figures over the commits of a history, and their change points.

use std::collections::HashMap;

use geobench_harness::measure::mann_whitney::mann_whitney;
use geobench_harness::measure::statistics::summarise;
use geobench_harness::schema::Status;
use serde::Serialize;

use crate::history::changes::{self, LevelChange};
use crate::history::compare::CellKey;
use crate::history::records::{CellRecord, Record};

/// A figure of a cell over the commits of one machine class and one suite.
#[derive(Clone, Debug)]
pub struct TrendSeries {
    /// The cell.
    pub cell: CellKey,
    /// The machine, in words.
    pub machine: String,
    /// The suite, if there was one.
    pub suite: Option<String>,
    /// The name of the figure.
    pub figure: &'static str,
    /// Its values, the oldest first.
    pub points: Vec<TrendPoint>,
    /// Changes of level. The `index` of each is one into `points`.
    pub changes: Vec<LevelChange>,
}

/// A figure at a commit.
#[derive(Clone, Debug, PartialEq)]
pub struct TrendPoint {
    /// The commit, shortened.
    pub commit: String,
    /// The number of the commit among those of the history, the oldest first.
    pub place: usize,
    /// The value.
    pub value: f64,
    /// 95 % interval of a time with enough samples; else `None`.
    pub interval: Option<[f64; 2]>,
}

/// A change point in JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChangePoint {
    /// The cell.
    pub cell: CellKey,
    /// The machine, in words.
    pub machine: String,
    /// The suite; null without one.
    pub suite: Option<String>,
    /// The figure: `time` or a name of result files.
    pub figure: &'static str,
    /// The first commit of the new level.
    pub commit: String,
    /// The median of the level before.
    pub before: f64,
    /// The median of the level since.
    pub after: f64,
    /// The new level relative to the old one.
    pub ratio: f64,
    /// The p-value of the Mann-Whitney test between the values of both levels.
    pub p: Option<f64>,
}

/// The figures whose trends are shown, with the least change that is reported, as a share. The
/// instruction count of unchanged code varies by up to 1.5 % from commit to commit, because of
/// changes elsewhere in the program. Its threshold is therefore 2 %.
const FIGURES: [(&str, f64); 5] = [
    ("time", 0.03),
    ("instructions", 0.02),
    ("heap_peak_bytes", 0.01),
    ("propagated", 1e-4),
    ("kept", 1e-4),
];

/// All series of `records`, which are in the order of their commits, with their change points.
pub fn series(records: &[Record]) -> Vec<TrendSeries> {
    let mut all: Vec<TrendSeries> = Vec::new();
    let mut places: HashMap<_, usize> = HashMap::new();
    let mut commits: HashMap<&str, usize> = HashMap::new();
    for record in records {
        let machine = record.machine();
        let next = commits.len();
        let commit = *commits.entry(&record.commit).or_insert(next);
        for cell in record.cells.iter().filter(|c| c.status == Status::Ok) {
            let identity = cell.cell.identity();
            for (figure, _) in FIGURES {
                let Some(point) = point(record, commit, cell, figure) else {
                    continue;
                };
                let key = (
                    figure,
                    machine.clone(),
                    record.suite.clone(),
                    identity.clone(),
                );
                let place = *places.entry(key).or_insert(all.len());
                if place == all.len() {
                    all.push(TrendSeries {
                        cell: cell.cell.clone(),
                        machine: machine.clone(),
                        suite: record.suite.clone(),
                        figure,
                        points: Vec::new(),
                        changes: Vec::new(),
                    });
                }
                all[place].cell.claimed |= cell.cell.claimed;
                all[place].points.push(point);
            }
        }
    }
    for series in &mut all {
        let values: Vec<f64> = series.points.iter().map(|point| point.value).collect();
        let figure = FIGURES.iter().find(|(figure, _)| *figure == series.figure);
        series.changes = changes::changes(&values, figure.map_or(0.0, |(_, least)| *least));
    }
    all
}

fn point(record: &Record, place: usize, cell: &CellRecord, figure: &str) -> Option<TrendPoint> {
    let (value, interval) = match figure {
        "time" => {
            let summary = summarise(&cell.samples)?;
            (summary.median, summary.ci95)
        }
        name => (*cell.figures.get(name)?, None),
    };
    Some(TrendPoint {
        commit: record.short().to_owned(),
        place,
        value,
        interval,
    })
}

/// The change points of all series, in their order.
pub fn change_points(all: &[TrendSeries]) -> Vec<ChangePoint> {
    let of = |series: &TrendSeries| {
        let values: Vec<f64> = series.points.iter().map(|point| point.value).collect();
        let ends: Vec<usize> = series.changes.iter().map(|change| change.index).collect();
        let point = |(i, change): (usize, &LevelChange)| {
            let start = if i == 0 { 0 } else { ends[i - 1] };
            let end = ends.get(i + 1).copied().unwrap_or(values.len());
            let (before, after) = (&values[start..change.index], &values[change.index..end]);
            ChangePoint {
                cell: series.cell.clone(),
                machine: series.machine.clone(),
                suite: series.suite.clone(),
                figure: series.figure,
                commit: series.points[change.index].commit.clone(),
                before: change.before,
                after: change.after,
                ratio: change.ratio(),
                p: mann_whitney(before, after).map(|test| test.p),
            }
        };
        series
            .changes
            .iter()
            .enumerate()
            .map(point)
            .collect::<Vec<_>>()
    };
    all.iter().flat_map(of).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use geobench_mesh::SplitMix64;

    use super::*;
    use geobench_harness::exec::mock::MockBackend;
    use geobench_harness::run::mock::{plan, result, run_mock};

    /// Twenty commits with noise of 2 % in the times. The times of `vtp` are longer from the 13th
    /// commit on. A count changes at the 9th commit.
    pub(crate) fn history() -> Vec<Record> {
        let records = run_mock(&plan(&["horse"], "mmp,vtp", "0"), &MockBackend::default());
        let file = result(records);
        let mut random = SplitMix64::new(3);
        (0..20)
            .map(|i| {
                let committed = Some(format!("2025-03-{:02}T00:00:00Z", i + 1));
                let commit = format!("{i:012x}");
                let mut record = Record::new(&file, &commit, Vec::new(), committed, None).unwrap();
                for cell in &mut record.cells {
                    let slower = if cell.cell.algorithm == "vtp" && i >= 12 {
                        1.15
                    } else {
                        1.0
                    };
                    for sample in &mut cell.samples {
                        *sample *=
                            slower * (1.0 + 0.04 * (random.below(1000) as f64 / 1000.0 - 0.5));
                    }
                    if i >= 8 {
                        *cell.figures.get_mut("propagated").unwrap() *= 1.5;
                    }
                }
                record
            })
            .collect()
    }

    #[test]
    fn a_slow_commit_is_caught_and_named_and_no_other() {
        let found = change_points(&series(&history()));
        let named: Vec<String> = found
            .iter()
            .map(|c| format!("{} {} {}", c.cell.algorithm, c.figure, c.commit))
            .collect();
        assert_eq!(
            named,
            [
                "mmp propagated 000000000008",
                "vtp time 00000000000c",
                "vtp propagated 000000000008"
            ]
        );
        assert!((found[1].ratio - 1.15).abs() < 0.02, "{}", found[1].ratio);
        assert!(found[1].p.unwrap() < 0.001);
    }

    #[test]
    fn machines_and_suites_are_told_apart() {
        let mut records = history();
        for record in &mut records[10..] {
            record.host.cores = 64;
        }
        records[19].suite = Some("other".into());
        let all = series(&records);
        // Three combinations of machine and suite, two cells, three figures.
        assert_eq!(all.len(), 3 * 2 * 3);
        let found = change_points(&all);
        assert!(
            found.iter().all(|change| change.figure != "time"),
            "{found:?}"
        );
    }
}
