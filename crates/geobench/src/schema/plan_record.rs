//! The record of a plan: in result files, to repeat a run, and at the top of journals, to refuse
//! another plan. It holds everything that may change a result, and nothing else.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::IsolationRecord;

/// A plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanRecord {
    /// The part of the plan; null for the whole.
    pub shard: Option<Shard>,
    /// Where cells run.
    pub isolation: IsolationRecord,
    /// The groups, in order.
    pub groups: Vec<PlannedGroup>,
}

/// A group: every algorithm on every model from every source.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlannedGroup {
    /// Its name; null if it has none.
    pub name: Option<String>,
    /// The models, in order.
    pub models: Vec<PlannedModel>,
    /// The algorithms, in order.
    pub algorithms: Vec<PlannedAlgorithm>,
    /// The sources, as on the command line.
    pub sources: String,
    /// Whether each run starts from all sources together.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub sources_together: bool,
    /// The targets, as on the command line; null for all vertices.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub targets: Option<String>,
    /// The largest distance asked for, in the units of the models; null for no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Timed runs of each cell; with a precision the most.
    pub repeat: usize,
    /// When a cell has enough timed runs; null if their number is fixed, and in files of older
    /// programs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub precision: Option<Precision>,
    /// Untimed runs of each cell before those.
    pub warmup: usize,
    /// The reference of the checks, as on the command line.
    pub reference: String,
    /// Largest relative difference that passes.
    pub tolerance: f64,
    /// Seed of the order of the runs.
    pub seed: u64,
    /// Instructions of all algorithms, as on the command line; null in files of older programs,
    /// where they were the widest of the processor.
    #[serde(default)]
    pub simd: Option<String>,
    /// Time limit of each run in seconds; null for none.
    pub timeout: Option<f64>,
    /// Memory limit of the process of each cell in bytes; null for none.
    pub memory_limit: Option<u64>,
    /// Limit of decompressed bytes of a model; null for the default.
    #[serde(default)]
    pub max_decompressed: Option<u64>,
}

/// When a cell has enough timed runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Precision {
    /// The 95 % interval of the median lies within this share of the median.
    pub relative: f64,
    /// Seconds that the timed runs take at least.
    pub min_time: f64,
    /// Seconds after which no timed run starts, whatever the interval.
    pub max_time: f64,
}

/// A model.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlannedModel {
    /// Its name, unique in the plan.
    pub name: String,
    /// The generator's spec with all defaults; null for a file.
    pub spec: Option<String>,
    /// SHA-256 of the file; null without a file, and if it cannot be read.
    pub file_sha256: Option<String>,
}

/// An algorithm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlannedAlgorithm {
    /// Its name in cells.
    pub label: String,
    /// All its parameters, defaults included; of an outside program, its description.
    pub parameters: BTreeMap<String, serde_json::Value>,
}

/// Part `index` of `count`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// Index of the part, from 1.
    pub index: u32,
    /// Number of parts.
    pub count: u32,
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl Shard {
    /// Whether this part holds a unit.
    pub const fn holds(self, unit: u128) -> bool {
        unit % self.count as u128 == self.index as u128 - 1
    }

    /// How many of these units this part holds.
    pub const fn held(self, units: Range<u128>) -> u128 {
        let (count, index) = (self.count as u128, self.index as u128);
        // Units below x that are held: those congruent to index - 1.
        let below_start = (units.start + count - index) / count;
        let below_end = (units.end + count - index) / count;
        below_end - below_start
    }
}
