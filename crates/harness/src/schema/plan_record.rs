//! The record of a plan. Result files hold it so that a run can be repeated, and journals so that a
//! run is not resumed with another plan. It holds everything that may change a result, and nothing
//! else.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;

use serde::{Deserialize, Deserializer, Serialize};

use super::IsolationRecord;

/// A plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanRecord {
    /// The shard of the plan; null for the whole plan.
    pub shard: Option<Shard>,
    /// Process isolation of the cells.
    pub isolation: IsolationRecord,
    /// The groups, in order.
    pub groups: Vec<PlannedGroup>,
}

/// A group: every algorithm on every model from every source.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlannedGroup {
    /// Name of the group; null if it has none.
    pub name: Option<String>,
    /// The models, in order.
    pub models: Vec<PlannedModel>,
    /// The algorithms, in order.
    pub algorithms: Vec<PlannedAlgorithm>,
    /// The sources, in the notation of the command line.
    pub sources: String,
    /// Whether each run starts from all sources together.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub sources_together: bool,
    /// The targets, in the notation of the command line; null for all vertices.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub targets: Option<String>,
    /// The radius of the search, in the units of the models; null for no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Number of timed runs of each cell; the maximum if `precision` is set.
    pub repeat: usize,
    /// When a cell has enough timed runs; null if their number is fixed, and in files of older
    /// versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub precision: Option<Precision>,
    /// Number of untimed runs of each cell before the timed ones.
    pub warmup: usize,
    /// The reference of the checks, in the notation of the command line.
    pub reference: String,
    /// Largest relative difference from the reference that passes.
    pub tolerance: f64,
    /// Seed of the order of the runs.
    pub seed: u64,
    /// Vector instructions of all algorithms, in the notation of the command line. Null in files of
    /// older versions, which used the widest of the processor.
    #[serde(default)]
    pub simd: Option<String>,
    /// Time limit of each run in seconds; null for none.
    pub timeout: Option<f64>,
    /// Memory limit of the process of a cell in bytes; null for none.
    pub memory_limit: Option<u64>,
    /// Maximum number of decompressed bytes of a model; null for the default.
    #[serde(default)]
    pub max_decompressed: Option<u64>,
}

/// When a cell has enough timed runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Precision {
    /// Enough if the 95 % interval of the median lies within this share of the median.
    pub relative: f64,
    /// The timed runs take at least this many seconds.
    pub min_time: f64,
    /// No timed run starts after this many seconds, even if the interval is too wide.
    pub max_time: f64,
}

/// A model of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlannedModel {
    /// Name of the model, unique in the plan.
    pub name: String,
    /// Specification of the generator with all defaults; null for a file.
    pub spec: Option<String>,
    /// Tolerance within which its vertices are welded; null if none are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weld: Option<f64>,
    /// SHA-256 of the file, or of the file that the generator starts from; null if there is none,
    /// and if it cannot be read.
    pub file_sha256: Option<String>,
}

/// An algorithm of a plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlannedAlgorithm {
    /// Name of the algorithm in cells.
    pub label: String,
    /// All parameters, defaults included, and `queue` and `crossing` of algorithms without such a
    /// parameter. For an external program, its description.
    pub parameters: BTreeMap<String, serde_json::Value>,
}

impl<'de> Deserialize<'de> for PlannedAlgorithm {
    /// Parameters of older versions get the names of today.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        struct AsWritten {
            label: String,
            parameters: BTreeMap<String, serde_json::Value>,
        }

        let AsWritten { label, parameters } = AsWritten::deserialize(deserializer)?;
        let mut one = Self { label, parameters };
        one.complete();
        Ok(one)
    }
}

impl PlannedAlgorithm {
    /// Gives parameters of older versions the names of today. Without a `crossing`, the record is
    /// of a version whose priority queues of windows were calendar queues, and whose CH kinds
    /// crossed eight windows at once.
    pub(super) fn complete(&mut self) {
        let parameters = &mut self.parameters;
        for (former, name) in [("shadow", "spawn_wedge"), ("reunite", "merge_split")] {
            if let Some(value) = parameters.remove(former) {
                parameters.insert(name.to_owned(), value);
            }
        }
        let words = [
            ("lists", "forget", "evict"),
            ("queue", "priority", "calendar"),
        ];
        for (name, former, word) in words {
            if let Some(value) = parameters.get_mut(name).filter(|value| *value == former) {
                *value = word.into();
            }
        }
        let name = self.label.split('{').next().unwrap_or_default();
        // `ich` meant today's `ich-fast`, and was the default, which no label has.
        if name == "svg"
            && !self.label.contains("build=ich")
            && let Some(build) = parameters.get_mut("build").filter(|build| *build == "ich")
        {
            *build = "ich-fast".into();
        }
        let Some(algorithm) = geobench_registry::find(name) else {
            return;
        };
        if !parameters.contains_key("crossing") {
            let joint = ["ch", "ich1", "ich", "fwp-ch", "lc-ch", "vtp-ch", "avtp"];
            let word = if joint.contains(&name) {
                "joint"
            } else {
                algorithm.crossing
            };
            parameters.insert("crossing".to_owned(), word.into());
            let in_label = self.label.contains("queue=");
            match (name, parameters.get("queue")) {
                ("mmp" | "mmp-edge" | "ich" | "mmp-approx" | "lct11", None) if !in_label => {
                    parameters.insert("queue".to_owned(), "calendar".into());
                }
                ("lct11", Some(queue)) if *queue == "heap" => {
                    parameters.insert("queue".to_owned(), "calendar".into());
                }
                _ => {}
            }
        }
        let has_queue = (algorithm.parameters.iter()).any(|parameter| parameter.name == "queue");
        if !has_queue {
            let queue = parameters.entry("queue".to_owned());
            queue.or_insert_with(|| algorithm.queue.into());
        }
    }
}

/// Shard `index` of `count`. Shards take the units of a plan in turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// Index of the shard, from 1.
    pub index: u32,
    /// Number of shards.
    pub count: u32,
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl Shard {
    /// Whether this shard contains the unit of this index.
    pub const fn holds(self, unit: u128) -> bool {
        unit % self.count as u128 == self.index as u128 - 1
    }

    /// Number of units in the range that this shard contains.
    pub const fn held(self, units: Range<u128>) -> u128 {
        let (count, index) = (self.count as u128, self.index as u128);
        // Units below x in this shard: those congruent to index - 1 modulo count.
        let below_start = (units.start + count - index) / count;
        let below_end = (units.end + count - index) / count;
        below_end - below_start
    }
}
