//! How often histories raise false alarms, and how soon they catch a slow commit.
//! `docs/methodology` names these tests.

use geobench_mesh::SplitMix64;

use crate::history::compare::Rules;
use crate::history::gate::{GateReport, gate};
use crate::history::records::Record;
use crate::history::trend::tests::history;
use crate::history::trend::{change_points, series};

/// Number of series.
const SERIES: usize = 400;

/// Number of commits.
const COMMITS: usize = 40;

/// A normal number.
fn normal(random: &mut SplitMix64) -> f64 {
    let mut uniform = || (random.below(1 << 30) as f64 + 0.5) / f64::from(1 << 30);
    (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()
}

/// Records with noise of 2 % from commit to commit, in which the times of some series are doubled
/// from a commit on.
fn records(doubled: usize, from: usize) -> Vec<Record> {
    let (model, mut random) = (history().swap_remove(0), SplitMix64::new(11));
    let record = |commit: usize| {
        let mut record = model.clone();
        record.commit = format!("{commit:012x}");
        let base = record.cells.swap_remove(0);
        let cells = (0..SERIES).map(|number| {
            let mut cell = base.clone();
            cell.cell.algorithm = "ext:solver".to_owned();
            cell.cell.model = format!("model {number}");
            cell.cell.sha256 = None;
            let slow = number < doubled && commit >= from;
            let level = if slow { 2.0 } else { 1.0 };
            let time = level * (0.02 * normal(&mut random)).exp();
            cell.samples = vec![time; 6];
            cell.figures.clear();
            cell
        });
        record.cells = cells.collect();
        record
    };
    (0..COMMITS).map(record).collect()
}

/// The comparison of the last of `records` with those before it.
fn judged(records: &[Record]) -> GateReport {
    let earlier: Vec<String> = records.iter().map(|r| r.commit.clone()).collect();
    let rules: Rules = "time=15%".parse().unwrap();
    gate(records, &[], &earlier, &rules).unwrap()
}

#[test]
fn four_hundred_series_of_noise_raise_no_alarm() {
    let records = records(0, 0);
    for count in 1..=COMMITS {
        let found = change_points(&series(&records[..count]));
        assert_eq!(found.len(), 0, "{found:?}");
        assert!(!judged(&records[..count]).is_worse(), "commit {count}");
    }
}

#[test]
fn a_doubled_time_is_caught_within_three_commits() {
    let doubled = 40;
    for from in [3, 10, 30] {
        let records = records(doubled, from);
        // The gate judges from the third base commit on, and catches the first slow commit.
        let broken = |report: GateReport| {
            let lines = report.lines.iter();
            lines.filter(|line| line.broken.is_some()).count()
        };
        assert_eq!(broken(judged(&records[..=from])), doubled, "gate, {from}");
        // A level has three commits.
        let found = change_points(&series(&records[..from + 3]));
        assert_eq!(found.len(), doubled, "trend, {from}");
        let commit = format!("{from:012x}");
        assert!(found.iter().all(|change| change.commit == commit));
    }
}
