//! The order of the records of a history. It is that of git: of the first parents of one commit,
//! the head. Dates order nothing, because clocks differ and a rebase gives many commits one second.

use std::collections::{HashMap, HashSet};

use geobench_harness::measure::number::counted;

use crate::history::records::Record;

/// The records of a history, in the order of their commits.
#[derive(Clone, Debug, Default)]
pub struct OrderedHistory {
    /// Those of the head and its first parents, the oldest first.
    pub records: Vec<Record>,
    /// Those of other commits, by the times of their runs.
    pub apart: Vec<Record>,
    /// The commits of the line, the newest first, as far as they are known, whether or not they
    /// have records.
    pub line: Vec<String>,
    /// The commit that was measured last on the line.
    pub head: Option<String>,
    /// What is unusual about the order, in sentences.
    pub notes: Vec<String>,
}

impl OrderedHistory {
    /// Orders `records`. `known` is the head and its first parents, the newest first, as far as a
    /// repository knows them; empty without one. Where it ends, as in a shallow clone, the first
    /// parents that records hold carry on. Without a repository, the head is the recorded commit
    /// that is no first parent of another; of several, the one with the most records behind it.
    ///
    /// Records that hold no first parents, without a repository that knows them, are ordered by the
    /// times of their commits, and a note says so.
    pub fn new(records: Vec<Record>, known: &[String]) -> Self {
        // A clone of one commit knows nothing about the order.
        if known.len() <= 1 && records.iter().all(|record| record.ancestors.is_empty()) {
            return Self::by_time(records);
        }
        let of_repository = extended(known.to_vec(), &records);
        if records.iter().any(|r| place(&of_repository, r).is_some()) {
            return Self::on_line(&of_repository, records);
        }
        let parents: HashSet<&str> = records
            .iter()
            .flat_map(|record| record.ancestors.iter().map(String::as_str))
            .collect();
        let tips = records
            .iter()
            .filter(|record| !record.ancestors.is_empty())
            .filter(|record| !parents.contains(record.commit.as_str()));
        let count = |line: &Vec<String>| {
            let placed = records.iter().filter(|r| place(line, r).is_some());
            placed.count()
        };
        let lines = tips.map(|tip| extended(vec![tip.commit.clone()], &records));
        match lines.max_by_key(count) {
            Some(line) => Self::on_line(&line, records),
            None => Self::by_time(records),
        }
    }

    fn on_line(line: &[String], records: Vec<Record>) -> Self {
        let mut placed = Vec::new();
        let mut apart = Vec::new();
        let places: HashMap<&str, usize> = (line.iter().enumerate().rev())
            .map(|(place, commit)| (commit.as_str(), place))
            .collect();
        for record in records {
            let found = places.get(record.commit.as_str()).copied();
            match found.or_else(|| place(line, &record)) {
                Some(place) => placed.push((place, record)),
                None => apart.push(record),
            }
        }
        // RFC 3339 times sort as text.
        placed.sort_by(|(a, one), (b, other)| (b, &one.started).cmp(&(a, &other.started)));
        apart.sort_by(|one, other| one.started.cmp(&other.started));
        let records: Vec<Record> = placed.into_iter().map(|(_, record)| record).collect();
        Self {
            head: records.last().map(|record| record.commit.clone()),
            notes: Self::note(&apart, line).into_iter().collect(),
            line: line.to_vec(),
            records,
            apart,
        }
    }

    fn by_time(mut records: Vec<Record>) -> Self {
        records.sort_by(|a, b| (a.time(), &a.started).cmp(&(b.time(), &b.started)));
        let note = "the records are ordered by the times of their commits: they hold no first \
                    parents, and no repository here knows their commits";
        Self {
            head: records.last().map(|record| record.commit.clone()),
            notes: (records.len() > 1)
                .then(|| note.to_owned())
                .into_iter()
                .collect(),
            line: records
                .iter()
                .rev()
                .map(|record| record.commit.clone())
                .collect(),
            records,
            apart: Vec::new(),
        }
    }

    /// A note on the records that are apart.
    fn note(apart: &[Record], line: &[String]) -> Option<String> {
        let mut names: Vec<&str> = apart.iter().map(Record::short).collect();
        names.sort_unstable();
        names.dedup();
        let head = line.first()?.get(..12).unwrap_or(&line[0]);
        if names.is_empty() {
            return None;
        }
        let more = if names.len() > NAMED { ", ..." } else { "" };
        let shown = names[..names.len().min(NAMED)].join(", ");
        Some(format!(
            "{} not among the first parents of {head}, shown apart: {shown}{more}",
            counted(names.len(), "commit")
        ))
    }
}

/// The most commits that a note names.
const NAMED: usize = 5;

/// `line`, the newest commit first, carried on by the first parents that `records` hold.
fn extended(mut line: Vec<String>, records: &[Record]) -> Vec<String> {
    let held: HashMap<&str, &[String]> = records
        .iter()
        .map(|record| (record.commit.as_str(), record.ancestors.as_slice()))
        .fold(HashMap::new(), |mut held, (commit, ancestors)| {
            let longest = held.entry(commit).or_insert(ancestors);
            if longest.len() < ancestors.len() {
                *longest = ancestors;
            }
            held
        });
    let mut index = 0;
    while let Some(commit) = line.get(index) {
        if let Some(ancestors) = held.get(commit.as_str())
            && index + 1 + ancestors.len() > line.len()
        {
            line.truncate(index + 1);
            line.extend_from_slice(ancestors);
        }
        index += 1;
    }
    line
}

/// The distance of the commit of `record` from the head of `line`. A commit may be abbreviated in
/// records that were made where no repository knew it.
fn place(line: &[String], record: &Record) -> Option<usize> {
    let is_whole = record.commit.len() >= 40;
    line.iter().position(|commit| {
        if is_whole {
            *commit == record.commit
        } else {
            commit.starts_with(&record.commit)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::history::trend::tests::history;

    /// Records of commits named by letters, each with the first parents that follow it.
    fn records(lines: &[&str]) -> Vec<Record> {
        let base = history().swap_remove(0);
        let record = |(i, line): (usize, &&str)| {
            let mut commits = line.chars().map(hash);
            Record {
                commit: commits.next().unwrap(),
                ancestors: commits.collect(),
                started: format!("2025-01-{:02}T00:00:00Z", i + 1),
                // A clock that runs backwards.
                committed: Some(format!("2025-01-{:02}T00:00:00Z", 28 - i)),
                ..base.clone()
            }
        };
        lines.iter().enumerate().map(record).collect()
    }

    fn hash(letter: char) -> String {
        letter.to_string().repeat(40)
    }

    fn names(records: &[Record]) -> String {
        records.iter().map(|record| &record.commit[..1]).collect()
    }

    #[test]
    fn commits_are_in_the_order_of_git_and_not_of_dates() {
        // Measured in the order e, a, c, b; d was not measured.
        let records = records(&["edcba", "a", "cba", "ba"]);
        let ordered = OrderedHistory::new(records.clone(), &[]);
        assert_eq!(names(&ordered.records), "abce");
        assert!(ordered.apart.is_empty() && ordered.notes.is_empty());
        // A clone knows more than the records.
        let known: Vec<String> = "gfedcba".chars().map(hash).collect();
        let ordered = OrderedHistory::new(records.clone(), &known);
        assert_eq!(names(&ordered.records), "abce");
        // A shallow clone knows less.
        let ordered = OrderedHistory::new(records, &known[2..3]);
        assert_eq!(names(&ordered.records), "abce");
    }

    #[test]
    fn records_hold_as_many_parents_as_the_record_before_needs() {
        let ordered = OrderedHistory::new(records(&["cb", "ba", "a"]), &[]);
        assert_eq!(names(&ordered.records), "abc");
    }

    #[test]
    fn commits_beside_the_line_are_apart_and_named() {
        let records = records(&["cba", "ba", "a", "xa"]);
        let ordered = OrderedHistory::new(records, &[]);
        assert_eq!(names(&ordered.records), "abc");
        assert_eq!(names(&ordered.apart), "x");
        assert_eq!(
            ordered.notes,
            ["1 commit not among the first parents of cccccccccccc, shown apart: xxxxxxxxxxxx"]
        );
    }

    #[test]
    fn dates_order_commits_that_no_repository_has() {
        let ordered = OrderedHistory::new(records(&["a", "b"]), &[hash('z')]);
        assert_eq!(names(&ordered.records), "ba");
        assert!(ordered.notes[0].contains("by the times of their commits"));
    }
}
