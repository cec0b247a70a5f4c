//! The measurements of all records, by program and model.

use std::collections::HashMap;

use geobench_harness::figures::time;
use geobench_harness::measure::statistics::median;
use geobench_harness::schema::{Cell, ModelRecord, ProgramRecord, Status};

use super::records::{SiteRecord, SiteRecords};
use crate::table::group::{GroupCells, distinct, geometric_mean};
use crate::table::results;

/// The program whose time is the unit of comparisons.
pub(super) const BASE: &str = "vtp";

/// An algorithm on a model, in a group of a record.
#[derive(Clone, Debug)]
pub(super) struct Measurement<'r> {
    pub(super) record: &'r SiteRecord,
    pub(super) model: &'r ModelRecord,
    /// The name with parameters.
    pub(super) label: &'r str,
    /// The cells, one for each source.
    pub(super) cells: Vec<&'r Cell>,
    /// The median time in seconds.
    pub(super) time: Option<f64>,
    /// The median set-up time in seconds.
    setup: Option<f64>,
    /// Its ratio to that of [`BASE`] in the same group.
    pub(super) to_base: Option<BaseRatio<'r>>,
    /// Its ratios to those of the other algorithms of the group.
    to_others: Vec<OtherRatio<'r>>,
}

/// A ratio to the time of [`BASE`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BaseRatio<'r> {
    pub(super) ratio: f64,
    /// The widest vector instructions of the base, if they are known.
    pub(super) simd: Option<&'r str>,
}

/// A ratio to the time of another algorithm.
#[derive(Clone, Copy, Debug)]
struct OtherRatio<'r> {
    label: &'r str,
    simd: Option<&'r str>,
    ratio: f64,
}

impl BaseRatio<'_> {
    /// The vector instructions of the base in words; empty if it ran without or they are unknown.
    pub(super) fn vectors(&self) -> &str {
        self.simd.filter(|simd| *simd != SCALAR).unwrap_or_default()
    }
}

/// The name of instructions without vectors.
const SCALAR: &str = "scalar";

/// The widest vector instructions of these cells of one algorithm.
fn simd_of<'r>(cells: &[&'r Cell]) -> Option<&'r str> {
    cells.first().and_then(|cell| cell.simd.as_deref())
}

impl<'r> Measurement<'r> {
    /// All measurements, the newest first.
    pub(super) fn all(records: &'r SiteRecords) -> Vec<Self> {
        let of_record = |record: &'r SiteRecord| {
            let groups = results::groups(&record.result);
            groups
                .into_iter()
                .flat_map(move |group| Self::of_group(record, &group))
        };
        records.results.iter().flat_map(of_record).collect()
    }

    fn of_group(record: &'r SiteRecord, group: &GroupCells<'r>) -> Vec<Self> {
        let mut all = Vec::new();
        // Times of cells that ran at the same time are disturbed: only the answers count.
        let is_timed = record.result.jobs().is_none();
        for model in &group.models {
            for label in &group.algorithms {
                let cells = group.of(&model.name, label);
                if cells.is_empty() {
                    continue;
                }
                let ratio = |base: &str| {
                    if !is_timed {
                        return None;
                    }
                    if base == *label {
                        return group.value(time(), &model.name, label).map(|_| 1.0);
                    }
                    Some(group.ratio(time(), &model.name, label, base)?.value)
                };
                let simd = |label: &str| simd_of(&group.of(&model.name, label));
                let others = group.algorithms.iter();
                let to_others = others.filter_map(|other| {
                    Some(OtherRatio {
                        label: other,
                        simd: simd(other),
                        ratio: ratio(other)?,
                    })
                });
                let to_base = ratio(BASE).map(|ratio| BaseRatio {
                    ratio,
                    simd: simd(BASE),
                });
                let setups: Vec<f64> = cells.iter().filter_map(|cell| cell.time.setup).collect();
                all.push(Self {
                    record,
                    model,
                    label,
                    time: group
                        .value(time(), &model.name, label)
                        .map(|time| time.value)
                        .filter(|_| is_timed),
                    setup: median(&setups),
                    to_base,
                    to_others: to_others.collect(),
                    cells,
                });
            }
        }
        all
    }

    /// The name without parameters.
    pub(super) fn program(&self) -> &'r str {
        self.label.split('{').next().unwrap_or(self.label)
    }

    /// Whether the program is not part of the suite.
    pub(super) fn is_outside(&self) -> bool {
        self.label.starts_with("ext:")
    }

    /// The record of an outside program. Of several in one file the first.
    pub(super) fn recorded(&self) -> Option<&'r ProgramRecord> {
        let mut programs = self.record.result.programs().into_iter();
        programs.find(|program| program.name == self.program())
    }

    pub(super) fn is_approximate(&self) -> bool {
        self.cells.iter().any(|cell| cell.approximate)
    }

    /// Whether each run gave the distances of all vertices from one vertex. Other runs are not
    /// compared across records.
    pub(super) fn is_plain(&self) -> bool {
        self.cells.iter().all(|cell| {
            let source = cell.source.as_ref();
            cell.goal.is_none() && source.is_some_and(|source| source.vertex().is_some())
        })
    }

    /// The first failed cell.
    pub(super) fn failure(&self) -> Option<&'r Cell> {
        self.cells.iter().copied().find(|c| c.status != Status::Ok)
    }

    /// The cells whose reference is an algorithm or a proof. Distances of a file may be those of
    /// the smooth surface that the model stands for.
    fn compared(&self) -> impl Iterator<Item = &'r Cell> {
        self.cells.iter().copied().filter(|cell| {
            let reference = cell.check.reference.as_deref();
            reference.is_some_and(|reference| !reference.contains(['/', '.']))
        })
    }

    /// The largest relative difference from the reference.
    pub(super) fn max_error(&self) -> Option<f64> {
        let errors = self.compared().filter_map(|cell| cell.check.max_rel);
        errors.reduce(f64::max)
    }

    /// The mean relative difference from the reference.
    pub(super) fn mean_error(&self) -> Option<f64> {
        let errors = self.compared().filter_map(|cell| cell.check.mean_rel);
        let errors: Vec<f64> = errors.collect();
        (!errors.is_empty()).then(|| errors.iter().sum::<f64>() / errors.len() as f64)
    }

    /// Whether an answer is wrong.
    pub(super) fn is_wrong(&self) -> bool {
        self.failure()
            .is_some_and(|cell| cell.status == Status::Wrong)
    }

    /// The identity of the model: its hash, or its name if it has none.
    pub(super) fn key(&self) -> &'r str {
        key(self.model)
    }
}

/// The identity of a model: its hash, or its name if it has none.
pub(super) fn key(model: &ModelRecord) -> &str {
    model.sha256.as_deref().unwrap_or(&model.name)
}

/// The time of a program on a set of models, as a multiple of that of [`BASE`].
#[derive(Clone, Debug)]
pub(super) struct Standing<'r> {
    pub(super) program: &'r str,
    /// The geometric mean over the models.
    pub(super) ratio: f64,
    pub(super) range: [f64; 2],
    pub(super) models: usize,
    /// The number of models whose ratio goes through a third program.
    pub(super) linked: usize,
    /// The vector instructions of the base in the ratios.
    pub(super) base_simd: Vec<&'r str>,
    /// The geometric mean of the set-up times, as multiples of the time of [`BASE`]; `None` without
    /// any.
    pub(super) setup: Option<f64>,
    /// The mean of the relative errors over the models.
    pub(super) error: f64,
    /// The largest relative error.
    pub(super) max_error: f64,
    /// The measurements, the newest first.
    pub(super) measured: Vec<&'r Measurement<'r>>,
}

/// The standings of all programs on the models that `counts`, the fastest first. Of several
/// measurements of a program on a model the newest counts. Forms of a program other than its
/// default count only if that was not measured.
pub(super) fn standings<'r>(
    all: &'r [Measurement<'r>],
    counts: impl Fn(&ModelRecord) -> bool,
) -> Vec<Standing<'r>> {
    type OfModel<'r> = HashMap<&'r str, &'r Measurement<'r>>;
    let mut newest: HashMap<&str, OfModel<'r>> = HashMap::new();
    let plain = all.iter().filter(|one| one.is_plain() && counts(one.model));
    for one in plain.filter(|one| one.time.is_some()) {
        let of_program = newest.entry(one.program()).or_default();
        let known = of_program.entry(one.key()).or_insert(one);
        let is_default = |one: &Measurement<'_>| one.label == one.program();
        let has_ratio = |one: &Measurement<'_>| one.to_base.is_some();
        if (is_default(one), has_ratio(one)) > (is_default(known), has_ratio(known)) {
            *known = one;
        }
    }
    let standing = |(program, measured): (&'r str, OfModel<'r>)| {
        let mut measured: Vec<&Measurement<'_>> = measured.into_values().collect();
        measured.sort_by(|a, b| {
            b.record
                .date()
                .cmp(a.record.date())
                .then(a.key().cmp(b.key()))
        });
        let mut linked = 0;
        let (mut found, mut setups) = (Vec::new(), Vec::new());
        for one in &measured {
            let through = || link(one, all).inspect(|_| linked += 1);
            if let Some(to_base) = one.to_base.or_else(through) {
                let setup = one.setup.zip(one.time).filter(|(setup, _)| *setup > 0.0);
                setups.extend(setup.map(|(setup, time)| setup / time * to_base.ratio));
                found.push(to_base);
            }
        }
        let ratios: Vec<f64> = found.iter().map(|one| one.ratio).collect();
        let errors: Vec<f64> = measured.iter().filter_map(|one| one.mean_error()).collect();
        Some(Standing {
            program,
            ratio: geometric_mean(&ratios)?,
            range: [f64::min, f64::max].map(|pick| ratios.iter().copied().fold(ratios[0], pick)),
            models: ratios.len(),
            linked,
            base_simd: distinct(found.iter().filter_map(|one| one.simd)),
            setup: geometric_mean(&setups),
            error: errors.iter().sum::<f64>() / errors.len().max(1) as f64,
            max_error: measured
                .iter()
                .filter_map(|one| one.max_error())
                .fold(0.0, f64::max),
            measured,
        })
    };
    let mut standings: Vec<Standing<'_>> = newest.into_iter().filter_map(standing).collect();
    standings.sort_by(|a, b| a.ratio.total_cmp(&b.ratio).then(a.program.cmp(b.program)));
    standings
}

/// The ratio of a measurement to [`BASE`] through an exact program that its group has, and that
/// another record measured, with the same instructions, together with the base on the same model.
/// Both ratios are of runs in turns on one machine each.
fn link<'r>(one: &Measurement<'r>, all: &[Measurement<'r>]) -> Option<BaseRatio<'r>> {
    one.to_others.iter().find_map(|other| {
        let of_other = |m: &&Measurement<'r>| {
            let is_same = m.label == other.label && simd_of(&m.cells) == other.simd;
            is_same && m.key() == one.key() && m.is_plain() && !m.is_approximate()
        };
        let to_base = all.iter().filter(of_other).find_map(|m| m.to_base)?;
        Some(BaseRatio {
            ratio: other.ratio * to_base.ratio,
            simd: to_base.simd,
        })
    })
}
