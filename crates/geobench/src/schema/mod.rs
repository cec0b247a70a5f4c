//! The result file: every field, defined once. Times are seconds, sizes bytes, distances the
//! model's own units, and numbers are stored unrounded. A figure that does not exist is `null`,
//! never 0.

pub(crate) mod difference;
mod plan_record;
pub mod result_file;

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use geobench_window::{Counter, Counters};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

pub use self::plan_record::{
    PlanRecord, PlannedAlgorithm, PlannedGroup, PlannedModel, Precision, Shard,
};

/// The schema that this version writes.
pub const SCHEMA: &str = "geobench/1";

/// A whole result file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResultFile {
    /// Always [`SCHEMA`].
    pub schema: String,
    /// The program that measured.
    pub tool: Tool,
    /// The machine it measured on.
    pub host: Host,
    /// The command, word by word.
    pub command: Vec<String>,
    /// When it started, RFC 3339 in UTC.
    pub started: String,
    /// When it finished, RFC 3339 in UTC; in an intermediate file, when that was written.
    pub finished: String,
    /// Where the cells ran; null in files of older programs.
    #[serde(default)]
    pub isolation: Option<IsolationRecord>,
    /// The groups of cells, in the order of the run; a single one without a name unless a suite
    /// file defines groups.
    #[serde(default)]
    pub groups: Vec<GroupRecord>,
    /// The models, in the order of the run, each once.
    pub models: Vec<ModelRecord>,
    /// The cells, in the order of the run.
    pub cells: Vec<Cell>,
    /// Identifier shared by files whose runs alternated: sample i of a cell in one file was taken
    /// next to sample i of that cell in the other. Null otherwise.
    #[serde(default)]
    pub pairing: Option<String>,
    /// Disturbances during the run; null in intermediate files.
    #[serde(default)]
    pub conditions: Option<Conditions>,
    /// The plan, with all parameters.
    #[serde(default)]
    pub plan: Option<PlanRecord>,
    /// The processes that measured, in order; several if a run was resumed or shards were merged.
    #[serde(default)]
    pub sessions: Vec<SessionRecord>,
}

impl ResultFile {
    /// How many cells ran at the same time, if more than one.
    pub fn jobs(&self) -> Option<usize> {
        self.isolation.as_ref()?.jobs
    }

    /// The suite: the name of the suite file in the command, without its ending.
    pub fn suite(&self) -> Option<String> {
        let mut words = self.command.iter();
        let given = words.find_map(|word| {
            let rest = word.strip_prefix("--config")?;
            (rest.is_empty() || rest.starts_with('=')).then_some(rest)
        })?;
        let path = match given.strip_prefix('=') {
            Some(path) => path,
            None => words.next()?,
        };
        let stem = Path::new(path).file_stem()?;
        Some(stem.to_string_lossy().into_owned())
    }

    /// The machine that measured `cell`: that of its part of the plan, if that was split.
    pub fn host_of(&self, cell: &Cell) -> &Host {
        let of_shard = |session: &&SessionRecord| {
            let shard = session.shard.map(|shard| shard.index);
            shard.is_some() && shard == cell.shard
        };
        let session = self.sessions.iter().find(of_shard);
        session.map_or(&self.host, |session| &session.host)
    }
}

/// A process that measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SessionRecord {
    /// Its part of the plan; null for the whole plan.
    pub shard: Option<Shard>,
    /// The machine.
    pub host: Host,
    /// The command, word by word.
    pub command: Vec<String>,
    /// When it started, RFC 3339 in UTC.
    pub started: String,
    /// When it finished, RFC 3339 in UTC; null if it was stopped and a later one resumed.
    pub finished: Option<String>,
    /// The program, in files that were joined of several; else absent, and that of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tool: Option<Tool>,
}

/// The program that measured.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tool {
    /// Version of the program.
    pub version: String,
    /// Commit it was built from, if it was built in a checkout.
    pub commit: Option<String>,
    /// Compiler it was built with.
    pub rustc: Option<String>,
    /// Compiler flags from outside, as by `RUSTFLAGS`; empty if none, absent in files of older
    /// programs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rustflags: Option<String>,
    /// `release` or `debug`.
    pub profile: String,
    /// Cargo features.
    pub features: Vec<String>,
}

/// The machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Host {
    /// Name of the processor.
    pub cpu: Option<String>,
    /// Processors that this process may use.
    pub cores: usize,
    /// Main memory.
    pub memory_bytes: Option<u64>,
    /// Operating system.
    pub os: String,
    /// Version of its kernel.
    pub kernel: Option<String>,
    /// Load average over one minute when the run started.
    pub load_start: Option<f64>,
    /// The widest vector instructions that it has and the program uses, `avx512`, `avx2` or
    /// `scalar`. Those of a cell are narrower if `--simd` or a parameter `simd` asks for it.
    #[serde(default)]
    pub simd: Option<String>,
    /// Its name in the cluster; absent outside of one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub node: Option<String>,
}

impl Host {
    /// The class of the machine in words: processor, number of processors and operating system.
    pub fn in_words(&self) -> String {
        let cpu = self.cpu.as_deref().unwrap_or("unknown processor");
        format!("{cpu}, {} cores, {}", self.cores, self.os)
    }

    /// Whether `other` is the same machine, as far as can be told: node of the cluster, processor,
    /// cores and main memory, of which kernels report a little more or less.
    pub fn is_same_machine(&self, other: &Self) -> bool {
        let same_memory = match (self.memory_bytes, other.memory_bytes) {
            (Some(a), Some(b)) => a.abs_diff(b) <= a.max(b) / 100,
            (a, b) => a == b,
        };
        let same_node = match (&self.node, &other.node) {
            (Some(a), Some(b)) => a == b,
            _ => true,
        };
        self.cpu == other.cpu && self.cores == other.cores && same_memory && same_node
    }
}

/// Where cells ran.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct IsolationRecord {
    /// Whether each cell had a process of its own.
    pub process: bool,
    /// Processors to which the cells were pinned; null if to none.
    pub cpus: Option<Vec<usize>>,
    /// How many cells ran at the same time, which disturbs their times; absent for one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub jobs: Option<usize>,
}

/// A group of cells that are shown together.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GroupRecord {
    /// Its name, unique within the file; null for the only group of a run without a suite.
    pub name: Option<String>,
    /// What its table shows.
    pub shows: Option<String>,
    /// The rows of its tables, by name; the default rows if empty.
    pub rows: Vec<String>,
    /// The base of its table of ratios; null for no such table.
    pub ratios_to: Option<String>,
    /// Time limit of each run in seconds; null for none.
    #[serde(default)]
    pub timeout: Option<f64>,
    /// Memory limit of the process of each cell in bytes; null for none.
    #[serde(default)]
    pub memory_limit: Option<u64>,
    /// Whether its cells hold samples of the wavefront.
    #[serde(default)]
    pub wavefront: bool,
}

impl GroupRecord {
    /// The group of a run without a suite.
    pub const fn unnamed() -> Self {
        Self {
            name: None,
            shows: None,
            rows: Vec::new(),
            ratios_to: None,
            timeout: None,
            memory_limit: None,
            wavefront: false,
        }
    }
}

/// A model. A refused one has its name and path, and little else.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ModelRecord {
    /// Name in tables and cells, unique within the file.
    pub name: String,
    /// The file, or the generator's spec.
    pub path: String,
    /// Hash of the file's bytes as they lie on the disk; of a generated model, of its positions
    /// (little-endian f64) followed by its triangles (little-endian u32).
    pub sha256: Option<String>,
    /// Vertices, isolated ones included.
    pub vertices: Option<u64>,
    /// Triangles.
    pub faces: Option<u64>,
    /// Edges.
    pub edges: Option<u64>,
    /// Edges with one face only.
    pub boundary_edges: Option<u64>,
    /// Parts of the surface that have no vertex in common; isolated vertices do not count.
    pub components: Option<u64>,
    /// Handles of all components together.
    pub genus: Option<u64>,
    /// Vertices at which a shortest path may bend.
    pub saddles: Option<u64>,
    /// Mean over the faces of P H / (2 sqrt(3) S): half perimeter, longest edge, area; 1 for
    /// equilateral faces. Faces without area are left out.
    pub anisotropy: Option<f64>,
    /// Length of the longest edge, in the units of the model.
    #[serde(default)]
    pub longest_edge: Option<f64>,
    /// Seconds to read or generate the model.
    pub load_seconds: Option<f64>,
    /// Seconds to check it and to build the half-edge mesh.
    pub build_seconds: Option<f64>,
}

impl ModelRecord {
    /// Number of vertices; 0 if it is not known.
    pub(crate) fn vertex_count(&self) -> usize {
        self.vertices.unwrap_or(0) as usize
    }
}

/// The name of a source, or of several that a run has together. It is a number in files if it is
/// one vertex, else a text.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(untagged)]
pub enum SourceLabel {
    /// A vertex, counted from 0 in the file's order.
    Vertex(u32),
    /// Another point or several sources, as on the command line.
    Other(String),
}

impl SourceLabel {
    /// The vertex, if it is one.
    pub const fn vertex(&self) -> Option<u32> {
        match self {
            Self::Vertex(vertex) => Some(*vertex),
            Self::Other(_) => None,
        }
    }

    /// In words.
    pub(crate) fn in_words(&self) -> String {
        match self {
            Self::Vertex(vertex) => format!("vertex {vertex}"),
            Self::Other(text) => text.clone(),
        }
    }
}

impl From<u32> for SourceLabel {
    fn from(vertex: u32) -> Self {
        Self::Vertex(vertex)
    }
}

impl fmt::Display for SourceLabel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Vertex(vertex) => write!(f, "{vertex}"),
            Self::Other(text) => f.write_str(text),
        }
    }
}

/// One algorithm on one model from one source.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Name of the model.
    pub model: String,
    /// Name of the algorithm.
    pub algorithm: String,
    /// Source vertex, counted from 0 in the file's order, or a text for another point of the
    /// surface and for several sources together; null where the model was refused before its
    /// vertices were known.
    pub source: Option<SourceLabel>,
    /// What its runs were to find, such as `to 17,3` or `within 2.5`: the run ends early, and only
    /// this is compared with the reference. `None` for the distances of all vertices.
    #[serde(default)]
    pub goal: Option<String>,
    /// Threads that the algorithm used.
    pub threads: usize,
    /// The widest vector instructions that its timed runs could use, `avx512`, `avx2` or `scalar`;
    /// null for an outside program, and in files of older programs.
    #[serde(default)]
    pub simd: Option<String>,
    /// Whether the algorithm is approximate: compared with the reference, but not held to the
    /// tolerance.
    #[serde(default)]
    pub approximate: bool,
    /// Outcome.
    pub status: Status,
    /// Reason of a failure, or a note; one line.
    pub message: Option<String>,
    /// Times of the solve alone.
    pub time: Time,
    /// Counters, of a run apart from the timed ones.
    #[serde(with = "counters_as_map")]
    pub counters: Counters,
    /// Memory, of the run that counted.
    pub memory: Memory,
    /// Where the time goes, by sampling a run of its own.
    pub phases: Phases,
    /// How the answer compares with the reference.
    pub check: Check,
    /// Name of the group; null if that has none.
    #[serde(default)]
    pub group: Option<String>,
    /// Instructions of the first solve after set-up, counted by callgrind; null without
    /// `--instructions`.
    #[serde(default)]
    pub instructions: Option<u64>,
    /// The widest vector instructions of the solve whose instructions were counted, `avx512`,
    /// `avx2` or `scalar`: narrower than in the timed runs where Valgrind does not support those.
    /// Null if nothing was counted, and in files of older programs.
    #[serde(default)]
    pub instructions_simd: Option<String>,
    /// Index of its shard; null if the plan was not split.
    #[serde(default)]
    pub shard: Option<u32>,
    /// Samples of the wavefront at even intervals of the counted run; absent without `--wavefront`
    /// and for algorithms without one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wavefront: Vec<WavefrontRecord>,
}

impl Cell {
    /// A cell without results.
    pub fn new(model: &str, algorithm: &str) -> Self {
        Self {
            model: model.to_owned(),
            algorithm: algorithm.to_owned(),
            threads: 1,
            ..Self::default()
        }
    }

    /// Its place in its file.
    pub(crate) fn place(&self) -> CellPlace {
        let (group, model) = (self.group.clone(), self.model.clone());
        let (source, algorithm) = (self.source.clone(), self.algorithm.clone());
        (group, model, source, algorithm, self.threads)
    }
}

/// A cell within a file: group, model, source, algorithm and threads.
pub(crate) type CellPlace = (Option<String>, String, Option<SourceLabel>, String, usize);

/// Instruction count of a solve.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InstructionCount {
    /// The count.
    pub count: u64,
    /// The widest vector instructions among them; null if that is not known.
    #[serde(default)]
    pub simd: Option<String>,
}

/// A sample of the wavefront; the distance of a window is its least one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WavefrontRecord {
    /// Windows propagated until then.
    pub parents: u64,
    /// Windows in the queue.
    pub windows: u64,
    /// Mean of their distances.
    pub distance: f64,
    /// Standard deviation of their distances.
    pub deviation: f64,
    /// Batch size of the current round; null for a queue without rounds.
    pub k: Option<u64>,
}

impl From<geobench_window::WavefrontRecord> for WavefrontRecord {
    fn from(sample: geobench_window::WavefrontRecord) -> Self {
        Self {
            parents: sample.parents,
            windows: sample.windows,
            distance: sample.distance,
            deviation: sample.deviation,
            k: sample.k,
        }
    }
}

/// Outcome of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Done; the check, if any, passed.
    #[default]
    Ok,
    /// Time limit exceeded.
    Timeout,
    /// Memory limit exceeded.
    OutOfMemory,
    /// The process ended early, or the solver panicked.
    Crashed,
    /// The answer differs from the reference.
    Wrong,
    /// The model or the source cannot be used.
    Refused,
}

impl Status {
    /// The word for it in files and tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Timeout => "timeout",
            Self::OutOfMemory => "out_of_memory",
            Self::Crashed => "crashed",
            Self::Wrong => "wrong",
            Self::Refused => "refused",
        }
    }

    /// The same without underscores.
    pub fn in_words(self) -> String {
        self.name().replace('_', " ")
    }
}

/// Times in seconds; empty and null unless the status is `ok`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Time {
    /// Every repetition, in the order taken.
    pub samples: Vec<f64>,
    /// Their median.
    pub median: Option<f64>,
    /// Their minimum.
    pub min: Option<f64>,
    /// Their median absolute deviation.
    pub mad: Option<f64>,
    /// 95 % bootstrap interval of the median; null from fewer than five samples.
    pub ci95: Option<[f64; 2]>,
    /// Reason for a missing interval.
    pub note: Option<String>,
    /// Set-up time of the solver, not included in the samples.
    pub setup: Option<f64>,
    /// Time of making the Voronoi diagram after a solve (stage 2), not included in the samples; the
    /// median of three. Null for algorithms that keep no windows for it.
    #[serde(default)]
    pub extraction: Option<f64>,
    /// Number of outliers: samples more than ten standard deviations, estimated from the MAD, from
    /// the median. All figures include them. Null from fewer than five samples.
    #[serde(default)]
    pub outliers: Option<usize>,
    /// For each sample, its position in the order of its round, failed algorithms included.
    #[serde(default)]
    pub places: Vec<usize>,
    /// For each sample, the number of solves that it is the mean of; empty if each is of one solve.
    #[serde(default)]
    pub solves: Vec<usize>,
    /// The share of the median within which its interval was to lie; null if the number of samples
    /// was fixed. The interval may be wider, if the time or the number of runs ended.
    #[serde(default)]
    pub precision: Option<f64>,
    /// For an outside program, for each run the seconds between request and answer, measured from
    /// outside; of a process that solves once, from its start.
    #[serde(default)]
    pub outside: Vec<f64>,
    /// For an outside program, for each run the seconds that it claims.
    #[serde(default)]
    pub claimed: Vec<f64>,
    /// Whether the claims exceed the time from outside, or are a small part of that time. The
    /// samples are then those from outside.
    #[serde(default)]
    pub doubted: bool,
}

impl Time {
    /// Half of the 95 % interval, the longer side, relative to the median.
    pub fn half_width(&self) -> Option<f64> {
        let ([low, high], median) = (self.ci95?, self.median?);
        (median > 0.0).then(|| (high - median).max(median - low) / median)
    }

    /// Whether a precision was wanted and the interval is wider.
    pub fn is_imprecise(&self) -> bool {
        let width = self.half_width();
        self.precision
            .is_some_and(|wanted| width.is_some_and(|width| width > wanted))
    }
}

/// Conditions of the machine between the start and the end of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Conditions {
    /// The governors of the processors' frequencies at the end, each once.
    pub governors: Option<Vec<String>>,
    /// Frequency of the fastest processor at the start, in hertz.
    pub frequency_start: Option<u64>,
    /// The same at the end.
    pub frequency_end: Option<u64>,
    /// The highest frequency that a processor has, in hertz.
    pub frequency_max: Option<u64>,
    /// Load average over one minute at the end; that of the start is in `host`.
    pub load_end: Option<f64>,
    /// Mean number of processors busy with other processes; null for runs of less than a second.
    pub other_load: Option<f64>,
    /// Share of processor time that the host of a virtual machine gave to others; null for runs of
    /// less than a second.
    pub stolen: Option<f64>,
    /// Swap space in use at the end, in bytes.
    pub swap_used_bytes: Option<u64>,
    /// Pages that the system moved to and from swap space.
    pub swapped_pages: Option<u64>,
    /// Number of thermal throttles.
    pub thermal_throttles: Option<u64>,
    /// Number of times that the control group exceeded its share of the processors.
    pub cgroup_throttles: Option<u64>,
    /// Seconds that its tasks were throttled.
    pub cgroup_throttled_seconds: Option<f64>,
    /// Warnings on disturbances that make the times doubtful.
    pub warnings: Vec<String>,
}

/// Memory in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Memory {
    /// The papers' figure: 80 bytes for each window stored at the end (algorithms that keep every
    /// window) or alive at the peak (the others).
    pub papers_bytes: Option<u64>,
    /// Peak bytes of the windows as stored here.
    pub windows_peak_bytes: Option<u64>,
    /// Peak heap bytes of the algorithm: set-up, run and answer, without the mesh.
    pub heap_peak_bytes: Option<u64>,
    /// Peak RSS of the process during the run: mesh, solver and code pages touched. Loading is
    /// excluded. Of an outside program measured from outside, with its descendants. Linux only.
    pub rss_peak_bytes: Option<u64>,
}

/// Seconds of one run in each phase: its time, divided in proportion to samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Phases {
    /// Computing child windows and distances.
    pub propagation: Option<f64>,
    /// Filters, trims and checks between windows.
    pub pruning: Option<f64>,
    /// Queues, lists, storage and all else.
    pub management: Option<f64>,
    /// Number of samples. `None` in records whose phases were clocked, which makes short phases
    /// look several times as long as they are.
    #[serde(default)]
    pub samples: Option<u64>,
}

/// How an answer compares with the reference; the largest of all runs of the cell.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// The algorithm, or the file, whose answer it is; null if nothing was compared.
    pub reference: Option<String>,
    /// Largest absolute difference; null if not finite (the message names the vertex).
    pub max_abs: Option<f64>,
    /// Largest relative difference; null if not finite.
    pub max_rel: Option<f64>,
    /// Unreachable vertices.
    pub unreachable: Option<u64>,
    /// Vertices that were compared, fewer than all if the reference is a file of some; null if
    /// nothing was compared.
    #[serde(default)]
    pub compared: Option<u64>,
    /// The vertex with the largest relative difference; null if the answer agrees with the
    /// reference.
    #[serde(default)]
    pub worst_vertex: Option<u64>,
    /// Mean error, relative to the reference, over all compared vertices that it reaches, without
    /// the sources; null if not finite.
    #[serde(default)]
    pub mean_rel: Option<f64>,
    /// Root of the mean square of the same errors; null if not finite.
    #[serde(default)]
    pub rms_rel: Option<f64>,
    /// Most by which the distances of the ends of an edge differ beyond its length, in the units of
    /// the model, which breaks the triangle inequality; null unless the algorithm is approximate.
    #[serde(default)]
    pub edge_excess: Option<f64>,
    /// Bound on the error of a distance next to edges too long for `f64` to place a path on them,
    /// in the units of the model; null without such edges, as on nearly all models.
    #[serde(default)]
    pub doubt: Option<f64>,
    /// Number of the cluster of answers that agree, for this model and source; 0 is that of the
    /// reference. Null without an answer, and for approximate algorithms.
    #[serde(default)]
    pub cluster: Option<u32>,
    /// Vertices whose label is not that of a nearest source, by one run of the reference from each
    /// source; null if labels were not checked.
    #[serde(default)]
    pub wrong_labels: Option<u64>,
}

/// Counters as a map from name to count or `null`, in the order of their table.
pub(crate) mod counters_as_map {
    use serde::de::Error;

    use super::{BTreeMap, Counter, Counters, Deserialize, Deserializer, SerializeMap, Serializer};

    pub(crate) fn serialize<S: Serializer>(
        counters: &Counters,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(Counter::ALL.len() + 1))?;
        for (counter, count) in counters.iter() {
            map.serialize_entry(counter.key(), &count)?;
        }
        let deviation = counters.wavefront_deviation;
        map.serialize_entry(Counters::WAVEFRONT_DEVIATION, &deviation)?;
        map.end()
    }

    /// The value of a counter in a file.
    #[derive(Clone, Copy, Deserialize)]
    #[serde(untagged)]
    enum CounterValue {
        Count(u64),
        Real(f64),
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Counters, D::Error> {
        let map = BTreeMap::<String, Option<CounterValue>>::deserialize(deserializer)?;
        let figure = |key| map.get(key).copied().flatten();
        let mut counters = Counters::default();
        for &counter in Counter::ALL {
            match figure(counter.key()) {
                Some(CounterValue::Count(count)) => counters.set(counter, count),
                Some(CounterValue::Real(_)) => {
                    return Err(D::Error::custom("a count is not whole"));
                }
                None => {}
            }
        }
        counters.wavefront_deviation =
            figure(Counters::WAVEFRONT_DEVIATION).map(|figure| match figure {
                CounterValue::Count(count) => count as f64,
                CounterValue::Real(real) => real,
            });
        Ok(counters)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counters_are_read_as_they_were_written() {
        let mut cell = Cell::new("m", "a");
        cell.counters.set(Counter::Propagated, u64::MAX);
        for deviation in [None, Some(0.1 + 0.2), Some(3.0)] {
            cell.counters.wavefront_deviation = deviation;
            let text = serde_json::to_string(&cell).unwrap();
            assert_eq!(serde_json::from_str::<Cell>(&text).unwrap(), cell);
        }
        let text = serde_json::to_string(&cell).unwrap();
        let half = text.replace("\"kept\":null", "\"kept\":0.5");
        assert!(serde_json::from_str::<Cell>(&half).is_err());
    }
}
