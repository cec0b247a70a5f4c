//! The result file. Every field is defined once, here.
//!
//! Times are in seconds, sizes in bytes, distances in the units of the model. Numbers are stored
//! unrounded. A missing figure is `null`, never 0.

pub mod difference;
pub mod labels;
mod plan_record;
mod program_record;
pub mod result_file;
pub mod unfinished;

use std::collections::BTreeMap;
use std::path::Path;

use geobench_window::{Counter, Counters};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

pub use geobench_export::SourceLabel;

pub use self::plan_record::{
    PlanRecord, PlannedAlgorithm, PlannedGroup, PlannedModel, Precision, Shard,
};
pub use self::program_record::{ProgramFile, ProgramRecord, changed_program};

/// The schema that this version writes.
pub const SCHEMA: &str = "geobench/1";

/// A whole result file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResultFile {
    /// Always [`SCHEMA`].
    pub schema: String,
    /// The program that measured.
    pub tool: Tool,
    /// The machine that ran it.
    pub host: Host,
    /// The command line, one word per element.
    pub command: Vec<String>,
    /// Start of the run, RFC 3339 in UTC.
    pub started: String,
    /// End of the run, RFC 3339 in UTC. In an intermediate file: the time of writing.
    pub finished: String,
    /// Process isolation and pinning of the cells; null in files of older versions.
    #[serde(default)]
    pub isolation: Option<IsolationRecord>,
    /// The groups of cells, in the order of the run. Without a suite file there is one unnamed
    /// group.
    #[serde(default)]
    pub groups: Vec<GroupRecord>,
    /// The models, in the order of the run, without repetition.
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
    /// The plan, with all parameters; null in files of older versions.
    #[serde(default)]
    pub plan: Option<PlanRecord>,
    /// The git repository of the working directory at the start of the run; null outside of one,
    /// and in files of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repository: Option<RepositoryRecord>,
    /// The parameters of the algorithms, in files joined from several plans. Absent if the file has
    /// a plan.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub algorithms: Vec<PlannedAlgorithm>,
    /// The processes that measured, in order. Several if a run was resumed or shards were merged.
    #[serde(default)]
    pub sessions: Vec<SessionRecord>,
}

impl ResultFile {
    /// Adds a model, or the notes that its record lacks. Returns the new notes.
    pub fn add_model(&mut self, model: &ModelRecord) -> Vec<String> {
        let mut known = self.models.iter_mut();
        let Some(known) = known.find(|known| known.name == model.name) else {
            self.models.push(model.clone());
            return model.notes.clone();
        };
        let before = known.notes.len();
        known.add_notes(model.notes.iter().cloned());
        known.notes[before..].to_vec()
    }

    /// Number of cells that ran concurrently; `None` for one.
    pub fn jobs(&self) -> Option<usize> {
        self.isolation.as_ref()?.jobs
    }

    /// The algorithms of the plan or of the joined plans, without repetition.
    pub fn planned_algorithms(&self) -> Vec<&PlannedAlgorithm> {
        let groups = self.plan.iter().flat_map(|plan| &plan.groups);
        let planned = groups.flat_map(|group| &group.algorithms);
        let mut all: Vec<&PlannedAlgorithm> = Vec::new();
        for one in planned.chain(&self.algorithms) {
            if !all.contains(&one) {
                all.push(one);
            }
        }
        all
    }

    /// The outside programs of all sessions, without repetition. Several of one name if the
    /// sessions ran different ones.
    pub fn programs(&self) -> Vec<&ProgramRecord> {
        let mut all: Vec<&ProgramRecord> = Vec::new();
        for one in self.sessions.iter().flat_map(|session| &session.programs) {
            if !all.contains(&one) {
                all.push(one);
            }
        }
        all
    }

    /// Name of the suite: the file name after `--config` in the command, without its extension, or
    /// the name after `--suite`. `None` without a suite.
    pub fn suite(&self) -> Option<String> {
        let mut words = self.command.iter();
        let given = words.find_map(|word| {
            let rest = word.strip_prefix("--config");
            let rest = rest.or_else(|| word.strip_prefix("--suite"))?;
            (rest.is_empty() || rest.starts_with('=')).then_some(rest)
        })?;
        let path = match given.strip_prefix('=') {
            Some(path) => path,
            None => words.next()?,
        };
        // The names of embedded suites may have dots.
        let name = Path::new(path).file_name()?.to_string_lossy().into_owned();
        let stem = name.strip_suffix(".toml").map(str::to_owned);
        Some(stem.unwrap_or(name))
    }

    /// Name of the suite if the models are its own, so that its text and the numbers of its paper
    /// apply.
    pub fn suite_with_its_models(&self) -> Option<String> {
        // Groups whose models were replaced have no text.
        let has_text = self.groups.iter().any(|group| group.shows.is_some());
        self.suite().filter(|_| has_text)
    }

    /// The machine that measured `cell`: the machine of its shard, or of the whole file if the plan
    /// was not split.
    pub fn host_of(&self, cell: &Cell) -> &Host {
        let of_shard = |session: &&SessionRecord| {
            let shard = session.shard.map(|shard| shard.index);
            shard.is_some() && shard == cell.shard
        };
        let session = self.sessions.iter().find(of_shard);
        session.map_or(&self.host, |session| &session.host)
    }
}

/// A process that measured all or part of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SessionRecord {
    /// Its shard of the plan; null for the whole plan.
    pub shard: Option<Shard>,
    /// The machine.
    pub host: Host,
    /// The command line, one word per element.
    pub command: Vec<String>,
    /// Start, RFC 3339 in UTC.
    pub started: String,
    /// End, RFC 3339 in UTC; null if the process was stopped and another one resumed its run.
    pub finished: Option<String>,
    /// The program of this session, in files merged from several programs. If absent, that of the
    /// file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tool: Option<Tool>,
    /// The outside programs of its plan. Absent if there are none, and in files of older versions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub programs: Vec<ProgramRecord>,
}

/// The program that measured.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tool {
    /// Version of the program.
    pub version: String,
    /// Git commit of the build; null if it was not built in a checkout.
    pub commit: Option<String>,
    /// Version of the compiler that built it.
    pub rustc: Option<String>,
    /// Extra compiler flags, as from `RUSTFLAGS`; empty if none, absent in files of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rustflags: Option<String>,
    /// `release`, `quick` (without optimisation across crates) or `debug`.
    pub profile: String,
    /// Cargo features.
    pub features: Vec<String>,
}

/// The state of a git repository.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RepositoryRecord {
    /// The commit that is checked out.
    pub commit: String,
    /// Whether files that git tracks differ from that commit.
    pub dirty: bool,
    /// The first parents of the commit, the newest first, at most
    /// [`FIRST_PARENTS`](Self::FIRST_PARENTS). They order results without a clone.
    pub ancestors: Vec<String>,
}

impl RepositoryRecord {
    /// The most first parents that are kept.
    pub const FIRST_PARENTS: usize = 1000;
}

/// The machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Host {
    /// Model name of the processor.
    pub cpu: Option<String>,
    /// Number of processors available to this process.
    pub cores: usize,
    /// Size of main memory in bytes.
    pub memory_bytes: Option<u64>,
    /// Operating system.
    pub os: String,
    /// Version of the kernel.
    pub kernel: Option<String>,
    /// One-minute load average when the run started.
    pub load_start: Option<f64>,
    /// The widest vector instructions that the machine has and the program uses: `avx512`, `avx2`
    /// or `scalar`. A cell uses narrower ones if `--simd` or its parameter `simd` says so.
    #[serde(default)]
    pub simd: Option<String>,
    /// Name of the cluster node; absent outside of a cluster.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub node: Option<String>,
}

impl Host {
    /// The class of the machine as text: processor, number of processors, operating system.
    pub fn in_words(&self) -> String {
        let cpu = self.cpu.as_deref().unwrap_or("unknown processor");
        format!("{cpu}, {} cores, {}", self.cores, self.os)
    }

    /// Whether `other` appears to be the same machine: same processor, number of processors, memory
    /// size within 1 % (kernels differ a little in what they report) and cluster node, if both name
    /// one.
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

/// Process isolation of the cells.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct IsolationRecord {
    /// Whether each cell ran in a process of its own.
    pub process: bool,
    /// Processors to which the cells were pinned; null if not pinned.
    pub cpus: Option<Vec<usize>>,
    /// Number of cells that ran concurrently, which disturbs their times; absent for one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub jobs: Option<usize>,
}

/// A group of cells that are shown together. The default is the group of a run without a suite.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GroupRecord {
    /// Its name, unique within the file; null for the only group of a run without a suite.
    pub name: Option<String>,
    /// What the table of the group shows, as text for the reader.
    pub shows: Option<String>,
    /// Names of the rows of its tables; the default rows if empty.
    pub rows: Vec<String>,
    /// The algorithm that is the base of the table of ratios; null for no such table.
    pub ratios_to: Option<String>,
    /// Time limit of each run in seconds; null for none.
    #[serde(default)]
    pub timeout: Option<f64>,
    /// Memory limit of the process of a cell in bytes; null for none.
    #[serde(default)]
    pub memory_limit: Option<u64>,
    /// Whether its cells record samples of the wavefront.
    #[serde(default)]
    pub wavefront: bool,
    /// Algorithms that have no cells on models with `junctions`: they do not cross them, and were
    /// selected as part of a family, `exact`, `all` or a default. Absent if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub left_out_at_junctions: Vec<String>,
}

impl GroupRecord {
    /// The algorithms that have no cells on `model`.
    pub(crate) fn left_out_of(&self, model: &ModelRecord) -> &[String] {
        if model.junctions.is_some() {
            &self.left_out_at_junctions
        } else {
            &[]
        }
    }

    /// Names the algorithms that have no cells on `model`, and says why. `None` if there are none.
    pub fn note_on_left_out(&self, model: &ModelRecord) -> Option<String> {
        let names = self.left_out_of(model);
        (!names.is_empty()).then(|| {
            format!(
                "left out, because they cross no edges with more than two faces and no surface \
                 that cannot be oriented: {}",
                names.join(", ")
            )
        })
    }
}

/// A model. One that was refused has its name and path, and few other fields.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ModelRecord {
    /// Name in tables and cells, unique within the file.
    pub name: String,
    /// Path of the file, or specification of the generator.
    pub path: String,
    /// SHA-256 of the bytes of the file on disk, before decompression. Of a generated model: of its
    /// positions (little-endian f64) followed by its triangles (little-endian u32). Of a welded
    /// model: of that hash and the tolerance.
    pub sha256: Option<String>,
    /// Tolerance within which vertices are welded, as a fraction of the diagonal of the bounding
    /// box; 0 for those at exactly one place. Null if none are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weld: Option<f64>,
    /// Number of vertices, isolated ones included.
    pub vertices: Option<u64>,
    /// Number of triangles.
    pub faces: Option<u64>,
    /// Number of edges.
    pub edges: Option<u64>,
    /// Number of edges with one face only.
    pub boundary_edges: Option<u64>,
    /// Number of edges with more than two faces, or with two whose orientations contradict each
    /// other. Null if there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub junctions: Option<u64>,
    /// Number of connected components, that is, parts without a common vertex. Isolated vertices do
    /// not count.
    pub components: Option<u64>,
    /// Sum of the genera of all components.
    pub genus: Option<u64>,
    /// Number of saddle vertices, at which a shortest path may bend.
    pub saddles: Option<u64>,
    /// Mean over the faces of P H / (2 sqrt(3) S), with half perimeter P, longest edge H and area
    /// S; 1 for equilateral faces. Faces without area are left out.
    pub anisotropy: Option<f64>,
    /// Length of the longest edge, in the units of the model.
    #[serde(default)]
    pub longest_edge: Option<f64>,
    /// Seconds to read or generate the model.
    pub load_seconds: Option<f64>,
    /// Seconds to check it and to build the half-edge mesh.
    pub build_seconds: Option<f64>,
    /// The component with the most vertices; null if there are not several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_component: Option<LargestComponent>,
    /// Repairs and notes, in words.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

impl ModelRecord {
    /// Adds the notes that it lacks.
    pub fn add_notes(&mut self, notes: impl IntoIterator<Item = String>) {
        for note in notes {
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
    }

    /// Number of vertices; 0 if it is not known.
    pub fn vertex_count(&self) -> usize {
        self.vertices.unwrap_or(0) as usize
    }

    /// The first vertex of the largest component.
    pub fn first_of_largest(&self) -> u32 {
        self.largest_component.map_or(0, |largest| largest.first)
    }
}

/// The component of a model with the most vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LargestComponent {
    /// Its first vertex.
    pub first: u32,
    /// Number of its vertices.
    pub vertices: u64,
}

/// The results of one algorithm on one model from one source.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Name of the model.
    pub model: String,
    /// Name of the algorithm.
    pub algorithm: String,
    /// The source; null if the model was refused before its vertices were known.
    pub source: Option<SourceLabel>,
    /// The goal of its runs, such as `to 17,3` or `within 2.5`. The runs end early, and only the
    /// distances of the goal are compared with the reference. Null for the distances of all
    /// vertices.
    #[serde(default)]
    pub goal: Option<String>,
    /// Number of threads of the algorithm.
    pub threads: usize,
    /// The widest vector instructions that its timed runs could use: `avx512`, `avx2` or `scalar`.
    /// Null for an external program, and in files of older versions.
    #[serde(default)]
    pub simd: Option<String>,
    /// Whether the algorithm is approximate. Its answers are compared with the reference, but the
    /// tolerance does not apply.
    #[serde(default)]
    pub approximate: bool,
    /// Outcome.
    pub status: Status,
    /// Reason of a failure, or a note; a single line.
    pub message: Option<String>,
    /// Times of the solve, without loading and set-up.
    pub time: Time,
    /// Counters, from a separate untimed run.
    #[serde(with = "counters_as_map")]
    pub counters: Counters,
    /// Memory: peaks from the profiled run, the others from the counted run.
    pub memory: Memory,
    /// Time in each phase, from a separate run that is sampled.
    pub phases: PhaseSeconds,
    /// Comparison with the reference.
    pub check: Check,
    /// Name of the group; null if the group has none.
    #[serde(default)]
    pub group: Option<String>,
    /// Instructions of the first solve after set-up, counted by callgrind; null without
    /// `--instructions`.
    #[serde(default)]
    pub instructions: Option<u64>,
    /// The widest vector instructions of the solve whose instructions were counted: `avx512`,
    /// `avx2` or `scalar`. Narrower than in the timed runs if Valgrind does not support those. Null
    /// if nothing was counted, and in files of older versions.
    #[serde(default)]
    pub instructions_simd: Option<String>,
    /// Index of its shard, from 1; null if the plan was not split.
    #[serde(default)]
    pub shard: Option<u32>,
    /// Samples of the wavefront at even intervals of the run that counts. Absent without
    /// `--wavefront`, and for algorithms without a wavefront.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wavefront: Vec<WavefrontSample>,
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

    /// The key of this cell within its file.
    pub fn id(&self) -> CellId {
        let (group, model) = (self.group.clone(), self.model.clone());
        let (source, algorithm) = (self.source.clone(), self.algorithm.clone());
        (group, model, source, algorithm, self.threads)
    }
}

/// Identifies a cell within a file: group, model, source, algorithm and number of threads.
pub type CellId = (Option<String>, String, Option<SourceLabel>, String, usize);

/// Number of instructions of a solve.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InstructionCount {
    /// The count.
    pub count: u64,
    /// The widest vector instructions among them; null if unknown.
    #[serde(default)]
    pub simd: Option<String>,
}

/// A sample of the wavefront. The distance of a window is its smallest distance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WavefrontSample {
    /// Number of windows propagated before the sample.
    pub parents: u64,
    /// Number of windows in the queue.
    pub windows: u64,
    /// Mean distance of those windows.
    pub distance: f64,
    /// Standard deviation of those distances.
    pub deviation: f64,
    /// Batch size of the current round; null for a queue without rounds.
    pub k: Option<u64>,
}

impl From<geobench_window::WavefrontRecord> for WavefrontSample {
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
    /// Completed. The check passed, if there was one.
    #[default]
    Ok,
    /// Time limit exceeded.
    Timeout,
    /// Memory limit exceeded.
    OutOfMemory,
    /// The process ended unexpectedly, or the solver panicked.
    Crashed,
    /// The answer differs from the reference by more than the tolerance.
    Wrong,
    /// The model or the source is unusable.
    Refused,
}

impl Status {
    /// The status as it stands in files and tables.
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

    /// The status without underscores.
    pub fn in_words(self) -> String {
        self.name().replace('_', " ")
    }
}

/// Times in seconds. Empty and null unless the status is `ok`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Time {
    /// The time of every timed run, in the order of the runs.
    pub samples: Vec<f64>,
    /// Median of the samples.
    pub median: Option<f64>,
    /// Minimum of the samples.
    pub min: Option<f64>,
    /// Median absolute deviation of the samples, unscaled.
    pub mad: Option<f64>,
    /// 95 % interval of the median; null for fewer than six samples.
    pub ci95: Option<[f64; 2]>,
    /// Why there is no interval.
    pub note: Option<String>,
    /// Set-up time of the solver, not included in the samples.
    pub setup: Option<f64>,
    /// Time to extract the Voronoi diagram after a solve (stage 2), not included in the samples;
    /// median of three. Null for algorithms that do not keep the windows for it.
    #[serde(default)]
    pub extraction: Option<f64>,
    /// Number of outliers: samples that lie more than ten standard deviations (estimated from the
    /// MAD) from the median. All figures include them. Null for fewer than six samples.
    #[serde(default)]
    pub outliers: Option<usize>,
    /// For each sample, its position in the order of its round, failed algorithms included.
    #[serde(default)]
    pub places: Vec<usize>,
    /// For each sample, the number of solves that it is the mean of; empty if every sample is one
    /// solve.
    #[serde(default)]
    pub solves: Vec<usize>,
    /// The requested precision: the interval should lie within this share of the median. The
    /// interval is wider if the limit of time or of runs came first. Null if the number of samples
    /// was fixed.
    #[serde(default)]
    pub precision: Option<f64>,
    /// Of an external program, for each run: seconds from request to answer by the clock of the
    /// harness, under protocol 2 less `ping`. If the process solves once, from its start.
    #[serde(default)]
    pub outside: Vec<f64>,
    /// Of an external program, for each run: seconds that the program reports.
    #[serde(default)]
    pub claimed: Vec<f64>,
    /// Of an external program under protocol 2, for each run: seconds to answer a ping, the median
    /// of several. Empty for the other protocols.
    #[serde(default)]
    pub ping: Vec<f64>,
    /// Whether the claims are below the times by the clock of the harness by more than the noise of
    /// these. The samples are then the times by the clock of the harness.
    #[serde(default)]
    pub doubted: bool,
    /// Whether the samples are claims of an external program that nothing confirms: its protocol
    /// does not let anyone check them, or its answers to pings are too slow. Tables mark them as
    /// claimed.
    #[serde(default)]
    pub unconfirmed: bool,
}

impl Time {
    /// Distance from the median to the farther end of the 95 % interval, relative to the median.
    pub fn half_width(&self) -> Option<f64> {
        let ([low, high], median) = (self.ci95?, self.median?);
        (median > 0.0).then(|| (high - median).max(median - low) / median)
    }

    /// Whether a precision was requested and the interval is wider.
    pub fn is_imprecise(&self) -> bool {
        let width = self.half_width();
        self.precision
            .is_some_and(|wanted| width.is_some_and(|width| width > wanted))
    }
}

/// State of the machine between the start and the end of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Conditions {
    /// Frequency governors of the processors at the end, without repetition.
    pub governors: Option<Vec<String>>,
    /// Frequency of the fastest processor at the start, in hertz.
    pub frequency_start: Option<u64>,
    /// The same at the end, in hertz.
    pub frequency_end: Option<u64>,
    /// Highest frequency of any processor, in hertz.
    pub frequency_max: Option<u64>,
    /// One-minute load average at the end; that at the start is in `host`.
    pub load_end: Option<f64>,
    /// Mean number of processors busy with other processes; null for runs of less than a second.
    pub other_load: Option<f64>,
    /// Share of processor time that the hypervisor gave to other virtual machines (steal time);
    /// null for runs of less than a second.
    pub stolen: Option<f64>,
    /// Swap space in use at the end, in bytes.
    pub swap_used_bytes: Option<u64>,
    /// Number of pages moved to and from swap space.
    pub swapped_pages: Option<u64>,
    /// Number of thermal throttling events.
    pub thermal_throttles: Option<u64>,
    /// Number of periods in which the cgroup was throttled, for it had used up its CPU quota.
    pub cgroup_throttles: Option<u64>,
    /// Seconds for which the cgroup was throttled.
    pub cgroup_throttled_seconds: Option<f64>,
    /// Warnings about disturbances that make the times unreliable.
    pub warnings: Vec<String>,
}

/// Memory in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Memory {
    /// Memory as the papers count it: 80 bytes for each window stored at the end (algorithms that
    /// keep every window) or alive at the peak (the others).
    pub papers_bytes: Option<u64>,
    /// Peak bytes of the windows in the representation of this program.
    pub windows_peak_bytes: Option<u64>,
    /// Peak heap bytes of the algorithm: set-up, run and answer, without the mesh.
    pub heap_peak_bytes: Option<u64>,
    /// Peak RSS of the process during the run: mesh, solver and code pages touched. Loading is
    /// excluded. For an external program that the harness measures, descendants are included. Linux
    /// only.
    pub rss_peak_bytes: Option<u64>,
}

/// Seconds of a run in each phase: the median time, divided in proportion to the samples of the
/// profiled run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PhaseSeconds {
    /// Computing child windows and distances.
    pub propagation: Option<f64>,
    /// Filtering, trimming and comparing windows.
    pub pruning: Option<f64>,
    /// Queues, lists, storage and everything else.
    pub management: Option<f64>,
    /// Number of samples. Null in files of older versions, which timed each phase with a clock.
    /// That overstates short phases several times.
    #[serde(default)]
    pub samples: Option<u64>,
}

impl PhaseSeconds {
    /// The same shares of `time`; unchanged if one of them is unknown.
    #[must_use]
    pub fn of_time(self, time: Option<f64>) -> Self {
        let all = [self.propagation, self.pruning, self.management];
        let all = all
            .into_iter()
            .sum::<Option<f64>>()
            .filter(|all| *all > 0.0);
        let (Some(time), Some(all)) = (time, all) else {
            return self;
        };
        let share = |phase: Option<f64>| phase.map(|phase| phase / all * time);
        Self {
            propagation: share(self.propagation),
            pruning: share(self.pruning),
            management: share(self.management),
            samples: self.samples,
        }
    }
}

/// Comparison of the answers with the reference. Figures are the largest over all runs of the cell.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// The algorithm or file that the answers were compared with; null if nothing was compared.
    pub reference: Option<String>,
    /// Largest absolute difference; null if not finite (the message names the vertex).
    pub max_abs: Option<f64>,
    /// Largest relative difference; null if not finite.
    pub max_rel: Option<f64>,
    /// Number of unreachable vertices.
    pub unreachable: Option<u64>,
    /// Number of vertices compared. Fewer than all if the reference is a file of some vertices.
    /// Null if nothing was compared.
    #[serde(default)]
    pub compared: Option<u64>,
    /// The vertex whose difference is the largest multiple of what is allowed; null if none exceeds
    /// it.
    #[serde(default)]
    pub worst_vertex: Option<u64>,
    /// Mean relative error over the compared vertices that the reference reaches, without the
    /// sources; null if not finite.
    #[serde(default)]
    pub mean_rel: Option<f64>,
    /// Root mean square of the same errors; null if not finite.
    #[serde(default)]
    pub rms_rel: Option<f64>,
    /// Largest violation of the triangle inequality along an edge, in the units of the model: the
    /// difference of the distances of its ends minus its length. Null unless the algorithm is
    /// approximate.
    #[serde(default)]
    pub edge_excess: Option<f64>,
    /// Bound on the error of the distances near edges so long that `f64` cannot place a path on
    /// them, in the units of the model. Null without such edges, as on nearly all models.
    #[serde(default)]
    pub doubt: Option<f64>,
    /// Index of the cluster of agreeing answers for this model and source; 0 is the cluster of the
    /// reference. Null without an answer, and for approximate algorithms.
    #[serde(default)]
    pub cluster: Option<u32>,
    /// Number of vertices whose label is not a nearest source. Checked with one run of the
    /// reference from each source. Null if labels were not checked.
    #[serde(default)]
    pub wrong_labels: Option<u64>,
    /// The least relative tolerance with which the answer is right beside the reference; null if
    /// there is none. Less than `max_rel` where rounding explains differences.
    #[serde(default)]
    pub least_tolerance: Option<f64>,
    /// Whether a proof shows that the answer is right or wrong. Null if no exact answers for this
    /// model and source disagreed, or neither was proven.
    #[serde(default)]
    pub proven: Option<bool>,
    /// What was proven by what, or why nothing was; null if no exact answers disagreed.
    #[serde(default)]
    pub proof: Option<String>,
    /// The reference that was proven wrong, if proven distances or bounds took its place.
    #[serde(default)]
    pub replaced: Option<String>,
}

/// Serializes counters as a map from name to count or `null`, in the order of [`Counter::ALL`].
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
    #[serde(untagged, expecting = "a number is expected")]
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
                    let problem = format!("`{}` is no whole number", counter.key());
                    return Err(D::Error::custom(problem));
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
    fn counters_that_are_no_numbers_are_errors() {
        let problem = |text: &str| {
            let value: serde_json::Value = serde_json::from_str(text).unwrap();
            counters_as_map::deserialize(value).unwrap_err().to_string()
        };
        assert_eq!(problem(r#"{"levels": 1.5}"#), "`levels` is no whole number");
        assert_eq!(problem(r#"{"levels": "many"}"#), "a number is expected");
    }

    #[test]
    fn phases_are_shares_of_a_time() {
        let sampled = PhaseSeconds {
            propagation: Some(3.0),
            pruning: Some(0.0),
            management: Some(1.0),
            samples: Some(40),
        };
        let scaled = sampled.of_time(Some(2.0));
        assert_eq!(
            (scaled.propagation, scaled.management),
            (Some(1.5), Some(0.5))
        );
        assert_eq!(scaled.samples, Some(40));
        assert_eq!(sampled.of_time(None), sampled);
        let unknown = PhaseSeconds::default();
        assert_eq!(unknown.of_time(Some(2.0)), unknown);
    }

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
