//! Counts of verdicts by algorithm and kind of mesh.

use std::collections::BTreeMap;
use std::fmt;

use crate::case::{FailureKind, Reference, Skip, Verdict};
use crate::child::Judged;

/// The counts so far.
#[derive(Default)]
pub(crate) struct Table {
    by_algorithm: Vec<(String, Row)>,
    by_kind: BTreeMap<String, Row>,
    /// Number of meshes judged by each reference.
    references: BTreeMap<Reference, usize>,
}

#[derive(Clone, Default)]
struct Row {
    judged: usize,
    unproven: usize,
    skipped: BTreeMap<Skip, usize>,
    in_doubt: usize,
    failed: BTreeMap<FailureKind, usize>,
}

impl Table {
    pub(crate) fn new(algorithms: &[String]) -> Self {
        let row = |name: &String| (name.clone(), Row::default());
        Self {
            by_algorithm: algorithms.iter().map(row).collect(),
            by_kind: BTreeMap::new(),
            references: BTreeMap::new(),
        }
    }

    pub(crate) fn skip(&mut self, kind: &str, skip: Skip) {
        let row = self.by_kind.entry(kind.to_owned()).or_default();
        *row.skipped.entry(skip).or_default() += 1;
        for (_, row) in &mut self.by_algorithm {
            *row.skipped.entry(skip).or_default() += 1;
        }
    }

    /// Adds the verdicts on all algorithms, in their order, for one mesh.
    pub(crate) fn add(&mut self, kind: &str, judged: &Judged) {
        *self.references.entry(judged.reference).or_default() += 1;
        let of_kind = self.by_kind.entry(kind.to_owned()).or_default();
        for ((_, row), verdict) in self.by_algorithm.iter_mut().zip(&judged.verdicts) {
            for row in [row, &mut *of_kind] {
                match verdict {
                    Verdict::LeftOut => continue,
                    Verdict::Right => {}
                    Verdict::InDoubt => row.in_doubt += 1,
                    Verdict::Unproven => row.unproven += 1,
                    Verdict::Failed(failure) => *row.failed.entry(failure.kind).or_default() += 1,
                }
                row.judged += 1;
            }
        }
    }

    pub(crate) fn failures(&self) -> usize {
        self.by_kind.values().map(Row::failures).sum()
    }
}

impl Row {
    fn failures(&self) -> usize {
        let unbuilt = self.skipped.get(&Skip::MeshPanics).copied().unwrap_or(0);
        unbuilt + self.failed.values().sum::<usize>()
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let header = |f: &mut fmt::Formatter<'_>, what: &str, skipped: &str| {
            write!(
                f,
                "{what:<40} {:>8} {skipped:>9} {:>8} {:>8} {:>8}",
                "judged", "in doubt", "unproven", "failed"
            )?;
            for kind in FailureKind::ALL {
                write!(f, " {kind:>9}")?;
            }
            writeln!(f)
        };
        let row = |f: &mut fmt::Formatter<'_>, name: &str, row: &Row| {
            let skipped: usize = row.skipped.values().sum();
            write!(
                f,
                "{name:<40} {:>8} {skipped:>9} {:>8} {:>8} {:>8}",
                row.judged,
                row.in_doubt,
                row.unproven,
                row.failures()
            )?;
            for kind in FailureKind::ALL {
                write!(f, " {:>9}", row.failed.get(&kind).copied().unwrap_or(0))?;
            }
            writeln!(f)
        };
        header(f, "algorithm", "skipped")?;
        for (name, found) in &self.by_algorithm {
            row(f, name, found)?;
        }
        writeln!(f)?;
        header(f, "kind of mesh (answers)", "skipped")?;
        let mut skipped: BTreeMap<Skip, usize> = BTreeMap::new();
        for (name, found) in &self.by_kind {
            row(f, name, found)?;
            for (&why, count) in &found.skipped {
                *skipped.entry(why).or_default() += count;
            }
        }
        let of = |why| skipped.get(&why).copied().unwrap_or(0);
        writeln!(
            f,
            "\nskipped meshes: {} refused, {} that panic when they are built, \
             {} too hard for the oracle, {} on which it is unsure",
            of(Skip::Refused),
            of(Skip::MeshPanics),
            of(Skip::GaveUp),
            of(Skip::Unsure)
        )?;
        let of = |by| self.references.get(&by).copied().unwrap_or(0);
        writeln!(
            f,
            "judged meshes: {} by the oracle, {} by a certificate, {} by agreement",
            of(Reference::Oracle),
            of(Reference::Certificate),
            of(Reference::Agreement)
        )
    }
}
