//! The arguments of every command, as clap reads them.

use std::path::{Path, PathBuf};

use clap::builder::RangedI64ValueParser;
use clap::{Args, Parser, Subcommand, ValueEnum, value_parser};

use super::isolation::{DecompressionOptions, IsolationOptions, ReadingOptions};
use crate::UsageError;
use crate::exec::source::{SourceSpec, TargetSpec};
use crate::history::compare::Rules;
use crate::measure::instructions;
use crate::plan::sampling::{Seconds, Share};
use crate::plan::suite::{self, MOST_RUNS};
use crate::registry::{self, MOST_THREADS, Selection, Simd};
use crate::report::claims::ClaimsFormat;
use crate::report::{Form, Tables, Wanted};
use crate::schema::Shard;
use crate::table::output::{self, OutputFile};
use crate::table::{self, ComparisonFormat, Format};

/// Help text on models, for every command that takes some.
const MODELS_HELP: &str = "MODEL is a file (.obj, .ply, .off, .stl, each also .gz), a directory (searched \
    recursively) or a generated model such as gen:sphere,subdiv=5 or gen:terrain,n=100,seed=1.";

/// Help text on rules, for `compare`.
const RULES_HELP: &str = "A rule is NAME=LIMIT, such as time=10%,propagated=0,heap_peak_bytes=5%. `time` is broken if the \
    95 % interval of the ratio of the times lies wholly beyond the limit. A counter (`geobench algos \
    --counters`) may change by no more than the limit in either direction, or, with a plus as in \
    propagated=+0, only not grow by more. `instructions` and the memories papers_bytes, \
    windows_peak_bytes, heap_peak_bytes and rss_peak_bytes may shrink. `missing` is broken if the new file lacks \
    more than this share of the cells of the old one. Exit status: 0 nothing is worse; 1 \
    something is worse; 2 a file cannot be used.";

/// Runs, checks and compares exact geodesic-distance algorithms on triangle meshes.
#[derive(Debug, Parser)]
#[command(
    name = "geobench",
    version,
    about,
    max_term_width = 100,
    arg_required_else_help = true
)]
#[command(
    after_help = "Exit status: 0 done and every check passed; 1 a check or a cell failed; 2 wrong usage or \
    unreadable input; 130 interrupted, with what was done until then."
)]
pub(super) struct Arguments {
    /// When to use colour; auto: on a terminal, unless `NO_COLOR` is set
    #[arg(long, global = true, value_name = "WHEN", value_enum, default_value_t)]
    pub(super) color: ColorChoice,

    /// Form of the model that is read from standard input as -: obj, ply, off or stl
    #[arg(long, global = true, value_name = "FORM")]
    pub(super) input_format: Option<String>,

    /// Form of what is written to standard output as -: an ending of the command's output files
    #[arg(long, global = true, value_name = "FORM")]
    pub(super) output_format: Option<String>,

    #[command(subcommand)]
    pub(super) command: Command,
}

/// When to use colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum ColorChoice {
    #[default]
    Auto,
    Always,
    Never,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Benchmark algorithms on models and check every answer
    Run(Box<RunOptions>),
    /// Compare the answers of all algorithms with each other and with stored distances
    Verify(VerifyOptions),
    /// Compare result files, or the newest commit of a history with earlier ones, and fail if
    /// something is worse
    Compare(CompareOptions),
    /// Make tables, plots and a picture of result files: one page, or files to take into a paper
    Report(ReportOptions),
    /// Compute what results say of the papers' claims: confirmed, partly, not, or cannot be judged
    Claims(ClaimsOptions),
    /// Write the distances of all vertices from one or several sources
    Distance(Box<DistanceOptions>),
    /// Trace shortest paths over the surface
    Path(PathOptions),
    /// Write the points at given distances: arcs of circles, as lines or as a picture
    Isolines(IsolinesOptions),
    /// Write the Voronoi diagram of several sources: cells, their borders, the dual triangulation
    Voronoi(VoronoiOptions),
    /// Prove distances right, or say where they are not
    Certify(CertifyOptions),
    /// Write a generated model to a file
    Gen(GenOptions),
    /// Show counts, defects, genus and anisotropy of models
    Info(InfoOptions),
    /// List the algorithms and which one to take, or all about some: paper, cost, use, parameters
    Algos(AlgosOptions),
    /// Join the parts of a benchmark that was run with --shard, or different runs on one machine
    Merge(MergeOptions),
    /// Run a benchmark on a cluster, as a job array of Slurm
    Cluster(ClusterOptions),
    /// Join the rounds of a benchmark that was started once for each round, as when two versions of
    /// geobench take turns
    Pool(PoolOptions),
    /// Add result files to a history: a directory with a small file for each commit, class of
    /// machine and suite
    Record(RecordOptions),
    /// Show how the figures of a history have changed, and since which commits
    Trend(TrendOptions),
    /// Print a script that lets a shell complete commands, options and values
    Completions(CompletionsOptions),
    /// Print the manual page of the program or of a command
    Man(ManOptions),
    /// Solve once, under callgrind
    #[command(hide = true, name = instructions::COMMAND)]
    CountOneSolve(CountOneSolveOptions),
}

#[derive(Args, Debug)]
#[command(after_help = MODELS_HELP)]
pub(super) struct RunOptions {
    /// Models; without any, those of the suite file, or a built-in suite of generated ones
    #[arg(value_name = "MODEL")]
    pub(super) models: Vec<String>,

    /// Suite file: models, algorithms and settings in groups; options given beside it come before
    /// what it says
    #[arg(long, value_name = "SUITE.toml")]
    pub(super) config: Option<PathBuf>,

    #[command(flatten)]
    pub(super) scale: ScaleOptions,

    /// Algorithms by name, by family, or exact, or all; separated by commas; with parameters as
    /// name{key=value,...} [default: mmp,ich,fwp-mmp,fwp-ch,vtp with --simd scalar, and mmp-fast,
    /// vtp,vtp-fast with the widest instructions]
    #[arg(long, value_name = "LIST", value_parser = algorithms)]
    pub(super) algo: Option<Algorithms>,

    #[command(flatten)]
    pub(super) source: SourceOptions,

    /// Timed runs of each cell [default: 5 to 100, as many as --precision needs]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_RUNS)))]
    pub(super) repeat: Option<u32>,

    /// Repeat until the 95 % interval of the median time lies within this share of the median; short
    /// solves are timed in batches [default: 3%]
    #[arg(long, value_name = "P", conflicts_with = "repeat")]
    pub(super) precision: Option<Share>,

    /// Repeat at least until the timed runs of a cell have taken this long [default: 0.2s]
    #[arg(long, value_name = "T", conflicts_with = "repeat")]
    pub(super) min_time: Option<Seconds>,

    /// Stop repeating when the timed runs of a cell have taken this long [default: 20s; 1s for the
    /// built-in suite]
    #[arg(long, value_name = "T", conflicts_with = "repeat")]
    pub(super) max_time: Option<Seconds>,

    /// Untimed runs of each cell before those [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(..=i64::from(MOST_RUNS)))]
    pub(super) warmup: Option<u32>,

    /// What answers must agree with: an algorithm, none, file (MODEL.sSOURCE.csv beside the model
    /// or in a folder named expected there or beside its folder), or the path of such a file
    /// [default: mmp-fast if it runs, else the first algorithm]
    #[arg(long, value_name = "REF")]
    pub(super) check: Option<String>,

    /// Largest relative difference that passes [default: 1e-9]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = tolerance)]
    pub(super) tolerance: Option<f64>,

    /// What the order of the runs is drawn from, which changes from round to round [default: 1]
    #[arg(long, value_name = "N")]
    pub(super) seed: Option<u64>,

    /// Threads of the parallel algorithms (pvtp), and of outside programs whose command has
    /// {threads} [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = threads())]
    pub(super) threads: Option<u32>,

    /// Instructions of every algorithm: auto (the widest of the processor), scalar, avx2 or avx512;
    /// narrower ones where the processor lacks them. Distances and counts do not depend on it
    /// [default: auto; scalar for the papers' algorithms without --algo and --config]
    #[arg(long, value_name = "SIMD")]
    pub(super) simd: Option<Simd>,

    #[command(flatten)]
    pub(super) isolation: IsolationOptions,

    /// Rows of tables: time, propagated and any other counter, generated, valid, ...; separated by
    /// commas [default: time, propagations and two measures of memory]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = row)]
    pub(super) rows: Option<Vec<String>>,

    /// Also show the ratios of all algorithms to this one, of times run by run
    #[arg(long, value_name = "A", value_parser = registry::select_one)]
    pub(super) ratios_to: Option<Selection>,

    #[command(flatten)]
    pub(super) extras: ExtraOptions,

    /// What goes to standard output
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t = Format::Table)]
    pub(super) format: Format,

    /// Result file, by its ending: .json, .csv, .md or .tex; may be repeated
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Vec<PathBuf>,

    #[command(flatten)]
    pub(super) csv_rows: CsvOptions,

    /// Journal: every run is noted in it as soon as it ends; runs that it holds already are not
    /// made again, so the same command goes on where it was interrupted
    #[arg(long, value_name = "FILE")]
    pub(super) resume: Option<PathBuf>,

    /// Result file (.json) to add to: cells that it has are kept, and it gets the others of this run.
    /// A cell with fewer timed runs than asked for gets the rest
    #[arg(long, value_name = "FILE", conflicts_with = "shard")]
    pub(super) add_to: Option<PathBuf>,

    /// Only part I of N of the plan, such as 2/3; the same split on every machine, for `geobench
    /// merge`
    #[arg(long, value_name = "I/N")]
    pub(super) shard: Option<Shard>,

    /// No progress, no warnings
    #[arg(long)]
    pub(super) quiet: bool,

    /// No progress bar
    #[arg(long)]
    pub(super) no_progress: bool,
}

/// Where runs start.
#[derive(Args, Debug)]
pub(super) struct SourceOptions {
    /// Sources: first, a vertex number, random:N[,seed=S], all, edge:A-B,T (from vertex A the
    /// fraction T of the way to B), face:F,U,V,W (barycentric coordinates), at:X,Y,Z (the nearest
    /// point), or a list of these; may be repeated [default: first]
    #[arg(long, value_name = "SRC", allow_negative_numbers = true)]
    pub(super) source: Vec<SourceSpec>,

    /// One run from all sources together, not one for each: distances are those from the nearest
    #[arg(long)]
    pub(super) sources_together: bool,
}

impl SourceOptions {
    /// All sources, if any are named.
    pub(super) fn sources(&self) -> Result<Option<SourceSpec>, UsageError> {
        if self.source.is_empty() {
            return Ok(None);
        }
        SourceSpec::of_all(self.source.iter().cloned()).map(Some)
    }
}

/// Which models of a suite.
#[derive(Args, Debug)]
pub(super) struct ScaleOptions {
    /// Directory of models to take the place of those in the suite that only stand for them, by the
    /// names of their files
    #[arg(
        long = "models",
        value_name = "DIR",
        requires = "config",
        conflicts_with = "models"
    )]
    pub(super) library: Option<PathBuf>,

    /// Run the suite in the sizes of the paper, which takes hours and a large machine
    #[arg(long, requires = "config")]
    pub(super) full: bool,
}

/// The rows of CSV.
#[derive(Args, Clone, Copy, Debug)]
pub(super) struct CsvOptions {
    /// Rows of CSV: one for each cell, or one for each sample of its time
    #[arg(long, value_name = "ROWS", value_enum, default_value_t)]
    csv: CsvRows,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum CsvRows {
    #[default]
    Cells,
    Samples,
}

impl CsvOptions {
    /// `format`, with these rows if it is CSV.
    pub(super) fn of(self, format: Format) -> Format {
        match (format, self.csv) {
            (Format::Csv, CsvRows::Samples) => Format::Samples,
            (format, _) => format,
        }
    }

    /// The same for the files at `paths`.
    pub(super) fn outputs(self, paths: &[PathBuf]) -> anyhow::Result<Vec<(Format, OutputFile)>> {
        let outputs = output::results(paths)?.into_iter();
        Ok(outputs
            .map(|(format, file)| (self.of(format), file))
            .collect())
    }
}

/// What is found out beside the usual figures.
#[derive(Args, Debug)]
pub(super) struct ExtraOptions {
    /// Keep the wavefront at some moments of each run that counts: its windows, their distances and
    /// how much these differ, for the plots of `geobench report`
    #[arg(long)]
    pub(super) wavefront: bool,

    /// Count the instructions of one solve of each cell as well, under Valgrind, which must be
    /// installed and takes some fifty times as long as the solve (row `instructions`)
    #[arg(long)]
    pub(super) instructions: bool,
}

#[derive(Args, Debug)]
#[command(after_help = MODELS_HELP)]
pub(super) struct VerifyOptions {
    /// Models; without any, a built-in suite of generated ones
    #[arg(value_name = "MODEL")]
    pub(super) models: Vec<String>,

    /// Algorithms by name, by family, or exact, or all; separated by commas [default: exact,
    /// without ch where it would take hours]
    #[arg(long, value_name = "LIST", value_parser = algorithms)]
    pub(super) algo: Option<Algorithms>,

    /// Sources: first, a vertex number, random:N[,seed=S], all, edge:A-B,T, face:F,U,V,W, at:X,Y,Z
    /// or a list of these; may be repeated. Vertices for which distances are stored
    /// (MODEL.sSOURCE.csv) are added
    #[arg(
        long,
        value_name = "SRC",
        default_value = "first",
        allow_negative_numbers = true
    )]
    pub(super) source: Vec<SourceSpec>,

    /// Largest relative difference that passes
    #[arg(long, value_name = "T", allow_negative_numbers = true, default_value_t = 1e-9, value_parser = tolerance)]
    pub(super) tolerance: f64,

    /// Threads of the parallel algorithms (pvtp), and of outside programs whose command has
    /// {threads}
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value_t = 1, value_parser = threads())]
    pub(super) threads: u32,

    /// Instructions of every algorithm: auto (the widest of the processor), scalar, avx2 or avx512;
    /// narrower ones where the processor lacks them. Distances and counts do not depend on it
    #[arg(long, value_name = "SIMD", default_value_t)]
    pub(super) simd: Simd,

    #[command(flatten)]
    pub(super) isolation: IsolationOptions,

    /// Print only disagreements
    #[arg(long)]
    pub(super) quiet: bool,
}

#[derive(Args, Debug)]
#[command(after_help = MODELS_HELP)]
pub(super) struct CertifyOptions {
    /// The model
    #[arg(value_name = "MODEL")]
    pub(super) model: String,

    /// The source: a vertex number, first, a list of numbers or random:N[,seed=S]; of several
    /// sources the nearest counts
    #[arg(
        long,
        value_name = "SRC",
        required = true,
        allow_negative_numbers = true
    )]
    pub(super) source: Vec<SourceSpec>,

    /// Distances to prove, of any program: lines `vertex,distance`, for all vertices or some
    /// [default: those of mmp]
    #[arg(long, value_name = "FILE")]
    pub(super) distances: Option<PathBuf>,

    /// Largest error that passes, as a fraction of each distance
    #[arg(long, value_name = "T", allow_negative_numbers = true, default_value_t = 1e-9, value_parser = tolerance)]
    pub(super) tolerance: f64,

    #[command(flatten)]
    pub(super) reading: ReadingOptions,

    /// Form of the answer on standard output
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t = CertificateFormat::Text)]
    pub(super) format: CertificateFormat,
}

/// Form of a certificate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum CertificateFormat {
    #[default]
    Text,
    Json,
}

#[derive(Args, Debug)]
#[command(after_help = MODELS_HELP)]
pub(super) struct PathOptions {
    /// The model
    #[arg(value_name = "MODEL")]
    pub(super) model: String,

    /// The source: first, a vertex number, random:N[,seed=S], all, edge:A-B,T, face:F,U,V,W,
    /// at:X,Y,Z or a list of these; may be repeated. From several sources a path starts at the
    /// nearest
    #[arg(
        long,
        value_name = "SRC",
        required = true,
        allow_negative_numbers = true
    )]
    pub(super) source: Vec<SourceSpec>,

    /// The targets, in the same forms; the search ends when all are reached
    #[arg(
        long,
        value_name = "DST",
        required_unless_present = "all_targets",
        allow_negative_numbers = true
    )]
    pub(super) target: Vec<TargetSpec>,

    /// Paths to all vertices
    #[arg(long, conflicts_with = "target")]
    pub(super) all_targets: bool,

    /// The algorithm, an exact one
    #[arg(long, value_name = "A", default_value = "vtp-fast", value_parser = registry::select_one)]
    pub(super) algo: Selection,

    #[command(flatten)]
    pub(super) reading: ReadingOptions,

    /// File to write, by its ending: .json, .csv, .obj, .ply, .vtk, or a picture of the model with
    /// the paths, .svg or .png
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,

    /// No summary
    #[arg(long)]
    pub(super) quiet: bool,
}

#[derive(Args, Debug)]
#[command(
    after_help = MODELS_HELP,
    group(clap::ArgGroup::new("wanted").required(true).args(["every", "levels"])),
)]
pub(super) struct IsolinesOptions {
    /// The model
    #[arg(value_name = "MODEL")]
    pub(super) model: String,

    /// The source: first, a vertex number, random:N[,seed=S], all, edge:A-B,T, face:F,U,V,W,
    /// at:X,Y,Z or a list of these; may be repeated. From several sources the distance is that from
    /// the nearest
    #[arg(
        long,
        value_name = "SRC",
        required = true,
        allow_negative_numbers = true
    )]
    pub(super) source: Vec<SourceSpec>,

    /// Isolines at all multiples of this distance
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = positive_distance)]
    pub(super) every: Option<f64>,

    /// Isolines at these distances, separated by commas
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_negative_numbers = true,
        value_parser = positive_distance
    )]
    pub(super) levels: Vec<f64>,

    /// How far the chords of lines may be from their arcs, in .obj, .ply, .vtk, .svg and .png
    /// [default: a ten thousandth of the size of the model]
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = positive_distance)]
    pub(super) tolerance: Option<f64>,

    #[command(flatten)]
    pub(super) reading: ReadingOptions,

    /// File to write, by its ending: .json has the arcs; .obj, .ply and .vtk lines; .svg and .png a
    /// picture of the model
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,

    /// No summary
    #[arg(long)]
    pub(super) quiet: bool,
}

#[derive(Args, Debug)]
#[command(after_help = MODELS_HELP)]
pub(super) struct DistanceOptions {
    /// The model
    #[arg(value_name = "MODEL")]
    pub(super) model: String,

    /// The source: first, a vertex number, random:N[,seed=S], all, edge:A-B,T, face:F,U,V,W,
    /// at:X,Y,Z or a list of these; may be repeated. From several sources the distance is that from
    /// the nearest, but see --each
    #[arg(
        long,
        value_name = "SRC",
        required = true,
        allow_negative_numbers = true
    )]
    pub(super) source: Vec<SourceSpec>,

    /// Only the distances of these points, in the forms of --source; may be repeated. The run ends
    /// as soon as they are final [default: all vertices]
    #[arg(long, value_name = "DST", allow_negative_numbers = true)]
    pub(super) target: Vec<TargetSpec>,

    /// The same from a file with one DST in a line
    #[arg(long, value_name = "FILE")]
    pub(super) targets: Option<PathBuf>,

    /// Only distances up to R, in the units of the model; others are infinite. The run ends there
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = radius)]
    pub(super) radius: Option<f64>,

    /// The algorithm
    #[arg(long, value_name = "A", default_value = "vtp-fast", value_parser = registry::select_one)]
    pub(super) algo: Selection,

    /// One field for each source, in a file of its own, which is called FILE with the source before
    /// the ending, as in d.s17.csv
    #[arg(long)]
    pub(super) each: bool,

    /// One matrix of all distances in FILE (.npy or .csv): a row for each source, a column for each
    /// vertex or target
    #[arg(long, requires = "each")]
    pub(super) matrix: bool,

    /// Threads, if the algorithm is a parallel one (pvtp) or with --each: then so many sources at a
    /// time
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value_t = 1, value_parser = threads())]
    pub(super) threads: u32,

    /// Instructions of every algorithm: auto (the widest of the processor), scalar, avx2 or avx512;
    /// narrower ones where the processor lacks them. Distances and counts do not depend on it
    #[arg(long, value_name = "SIMD", default_value_t)]
    pub(super) simd: Simd,

    #[command(flatten)]
    pub(super) reading: ReadingOptions,

    /// File to write, by its ending: .csv, .json, .npy, .ply or .vtk
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,

    /// No summary
    #[arg(long)]
    pub(super) quiet: bool,
}

#[derive(Args, Debug)]
#[command(after_help = MODELS_HELP)]
pub(super) struct VoronoiOptions {
    /// The model
    #[arg(value_name = "MODEL")]
    pub(super) model: String,

    /// The sources: first, a vertex number, random:N[,seed=S], all, edge:A-B,T, face:F,U,V,W,
    /// at:X,Y,Z or a list of these; may be repeated
    #[arg(
        long,
        value_name = "SRC",
        required = true,
        allow_negative_numbers = true
    )]
    pub(super) source: Vec<SourceSpec>,

    /// The algorithm: window-vtp, lct11 or xls14
    #[arg(long, value_name = "A", default_value = "window-vtp", value_parser = registry::select_one)]
    pub(super) algo: Selection,

    #[command(flatten)]
    pub(super) reading: ReadingOptions,

    /// File to write, by its ending: .json (cells, vertices, arcs), .obj or .vtk (borders as
    /// polylines) or .ply (the model coloured by cell, cut along the borders)
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,

    /// Mesh to write as well, .obj or .ply: the dual triangulation, whose vertices are the sources
    #[arg(long, value_name = "FILE")]
    pub(super) dual: Option<PathBuf>,

    /// File to write as well, .csv or .npy: the place of the nearest source of each vertex in the
    /// list of sources
    #[arg(long, value_name = "FILE")]
    pub(super) labels: Option<PathBuf>,

    /// No summary
    #[arg(long)]
    pub(super) quiet: bool,
}

#[derive(Args, Debug)]
pub(super) struct ReportOptions {
    /// Result files (.json)
    #[arg(value_name = "RESULT", required = true)]
    pub(super) results: Vec<PathBuf>,

    /// Page to write: one self-contained HTML file
    #[arg(short, long, value_name = "FILE", required_unless_present = "format")]
    pub(super) output: Option<PathBuf>,

    /// Files to write into a directory: html (the page), svg (every plot), csv (every table and the
    /// numbers behind every plot) or tex (every table and plot for LaTeX); may be repeated
    #[arg(long, num_args = 2, value_names = ["FORMAT", "DIR"])]
    pub(super) format: Vec<String>,

    /// Algorithm to which all are compared [default: that of the suite, else vtp, else the
    /// reference of the checks]
    #[arg(long, value_name = "ALGO")]
    pub(super) ratio_to: Option<String>,

    /// Model of the result to draw coloured by distance from a vertex, or none [default: the first
    /// one that can be loaded again and is the same, from its first source]
    #[arg(long, value_name = "MODEL[:SOURCE]")]
    pub(super) picture: Option<Wanted>,

    /// Tables of the papers to compare ratios with, such as 000-table-1, separated by commas, or
    /// none [default: that of the suite that the result was made with]
    #[arg(long, value_name = "LIST")]
    pub(super) papers: Option<Tables>,

    #[command(flatten)]
    pub(super) decompression: DecompressionOptions,

    /// No summary, no warnings
    #[arg(long)]
    pub(super) quiet: bool,
}

impl ReportOptions {
    /// The forms of files with their directories.
    pub(super) fn files(&self) -> anyhow::Result<Vec<(Form, &Path)>> {
        let pairs = self.format.chunks_exact(2);
        pairs
            .map(|pair| match Form::from_str(&pair[0], true) {
                Ok(form) => Ok((form, Path::new(&pair[1]))),
                Err(_) => anyhow::bail!("--format {}: use html, svg, csv or tex", pair[0]),
            })
            .collect()
    }
}

#[derive(Args, Debug)]
#[command(
    after_help = "A claim is decided by the results of its suite (`run --config bench-configs/SUITE.toml`). docs/claims.md has \
    the rules and the form of files of claims. Exit status: 0 whatever the verdicts are; 2 a file cannot be used."
)]
pub(super) struct ClaimsOptions {
    /// Result files (.json), or directories of some; at most one of each suite
    #[arg(value_name = "RESULT", required = true)]
    pub(super) results: Vec<PathBuf>,

    /// File of claims (.toml), or a directory of some [default: those of the papers, which are part
    /// of the program]
    #[arg(long, value_name = "DIR|FILE")]
    pub(super) claims: Option<PathBuf>,

    /// What goes to standard output
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t = ClaimsFormat::Markdown)]
    pub(super) format: ClaimsFormat,

    /// File to write instead, by its ending: .md, .json, .csv or .txt; may be repeated
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Vec<PathBuf>,

    /// No warnings
    #[arg(long)]
    pub(super) quiet: bool,
}

#[derive(Args, Debug)]
pub(super) struct GenOptions {
    /// NAME[,key=value...], such as torus,faces=50000,bump=0.1,seed=7
    #[arg(value_name = "SPEC")]
    pub(super) spec: String,

    #[command(flatten)]
    pub(super) decompression: DecompressionOptions,

    /// File to write: .obj or .ply, each also .gz
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,
}

#[derive(Args, Debug)]
#[command(after_help = MODELS_HELP)]
pub(super) struct InfoOptions {
    /// Models
    #[arg(value_name = "MODEL", required = true)]
    pub(super) models: Vec<String>,

    #[command(flatten)]
    pub(super) reading: ReadingOptions,

    /// How to show them
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t)]
    pub(super) format: ListFormat,
}

#[derive(Args, Debug)]
#[command(after_help = RULES_HELP)]
pub(super) struct CompareOptions {
    /// Result files (.json), the older ones first; with --against the directory of a history
    #[arg(value_name = "FILE", required = true)]
    pub(super) files: Vec<PathBuf>,

    /// The file that counts as 1 [default: the first]
    #[arg(long, value_name = "FILE", conflicts_with = "against")]
    pub(super) baseline: Option<PathBuf>,

    /// Compare the newest record of a history with those of these commits, such as main~10..main;
    /// the noise of a time is that from commit to commit
    #[arg(long, value_name = "RANGE", conflicts_with = "output")]
    pub(super) against: Option<String>,

    /// What counts as a regression, separated by commas; without any, only a cell that does not end
    /// well any more
    #[arg(long, value_name = "RULES", default_value = "", hide_default_value = true, value_parser = rules)]
    pub(super) fail_on: Rules,

    /// What goes to standard output
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t = ComparisonFormat::Table)]
    pub(super) format: ComparisonFormat,

    /// File to write as well, by its ending: .json, .md or .txt; may be repeated
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Vec<PathBuf>,
}

#[derive(Args, Debug)]
#[command(
    after_help = "The exit status is that of the whole run: 1 if a cell failed, 2 if a model was refused."
)]
pub(super) struct MergeOptions {
    /// Result files (.json) of all parts, in any order, or of different runs, of which the first has
    /// the cells that several have
    #[arg(value_name = "PART", required = true)]
    pub(super) parts: Vec<PathBuf>,

    /// Result file, by its ending: .json, .csv, .md or .tex; may be repeated
    #[arg(short, long, value_name = "FILE", required = true)]
    pub(super) output: Vec<PathBuf>,

    #[command(flatten)]
    pub(super) csv_rows: CsvOptions,
}

#[derive(Args, Debug)]
#[command(
    after_help = "Every part of the plan is a job of an array, and one job more joins their files. DIR must be on a \
    file system that all nodes see; it gets the scripts, journals, logs and the result. Cores, memory and time \
    follow from --threads, --memory-limit and --timeout of the plan. A part that is started again on the same \
    node goes on from its journal; on another it starts anew, so that ratios are of one node."
)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is an option of its own"
)]
pub(super) struct ClusterOptions {
    /// Suite file
    #[arg(long, value_name = "SUITE.toml")]
    pub(super) config: Option<PathBuf>,

    /// Number of parts, each of which is a job
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(super) shards: Option<u32>,

    /// Partition of the cluster [default: that of Slurm]
    #[arg(long, value_name = "P")]
    pub(super) partition: Option<String>,

    /// No other jobs on a node while a part runs there
    #[arg(long)]
    pub(super) exclusive: bool,

    /// Time limit of each part [default: all its cells at their time limit]
    #[arg(long, value_name = "DUR")]
    pub(super) time: Option<humantime::Duration>,

    /// Another option of sbatch, such as --sbatch=--account=NAME; may be repeated
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    pub(super) sbatch: Vec<String>,

    /// Directory of the benchmark, on a file system that the nodes share
    #[arg(short, long, value_name = "DIR")]
    pub(super) output: PathBuf,

    /// Show which parts are done, wait, run or have failed
    #[arg(long, conflicts_with_all = ["resume", "config", "shards", "run"])]
    pub(super) status: bool,

    /// Submit the parts that have failed again
    #[arg(long, conflicts_with_all = ["config", "shards", "run"])]
    pub(super) resume: bool,

    /// Write the scripts and print the commands that would submit them
    #[arg(long, conflicts_with_all = ["status", "resume"])]
    pub(super) no_submit: bool,

    /// Models and options of `geobench run`
    #[arg(last = true, value_name = "RUN OPTIONS")]
    pub(super) run: Vec<String>,
}

#[derive(Args, Debug)]
pub(super) struct RecordOptions {
    /// Result files (.json)
    #[arg(value_name = "RESULT", required = true)]
    pub(super) results: Vec<PathBuf>,

    /// Directory of the history; made if it does not exist
    #[arg(long, value_name = "DIR")]
    pub(super) into: PathBuf,

    /// The commit that was measured [default: that of the result file]
    #[arg(long, value_name = "HASH")]
    pub(super) commit: Option<String>,

    /// The suite; records of different suites are not compared [default: the name of the suite file]
    #[arg(long, value_name = "NAME")]
    pub(super) suite: Option<String>,

    /// Do not print the path of the record
    #[arg(long)]
    pub(super) quiet: bool,
}

#[derive(Args, Debug)]
pub(super) struct TrendOptions {
    /// Directory of the history
    #[arg(value_name = "DIR")]
    pub(super) history: PathBuf,

    /// Page to write: one self-contained HTML file
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,

    /// How to show the change points
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t)]
    pub(super) format: ListFormat,
}

#[derive(Args, Debug)]
pub(super) struct PoolOptions {
    /// Result files (.json) of the rounds, in the order in which they were run
    #[arg(value_name = "ROUND", required = true)]
    pub(super) rounds: Vec<PathBuf>,

    /// Result file, by its ending: .json, .csv, .md or .tex; may be repeated
    #[arg(short, long, value_name = "FILE", required = true)]
    pub(super) output: Vec<PathBuf>,

    /// Any text that the files of both versions have in common, so that `compare` knows that sample
    /// i of the one was taken next to sample i of the other
    #[arg(long, value_name = "ID")]
    pub(super) pairing: Option<String>,
}

#[derive(Args, Debug)]
#[command(
    after_help = "For bash: geobench completions bash > ~/.local/share/bash-completion/completions/geobench"
)]
pub(super) struct CompletionsOptions {
    /// The shell
    #[arg(value_name = "SHELL", value_enum)]
    pub(super) shell: clap_complete::Shell,
}

#[derive(Args, Debug)]
#[command(after_help = "To read it: geobench man run | man -l -")]
pub(super) struct ManOptions {
    /// The command; without one, the page of the program, which lists all commands
    #[arg(value_name = "COMMAND")]
    pub(super) command: Option<String>,
}

#[derive(Args, Debug)]
pub(super) struct CountOneSolveOptions {
    pub(super) model: String,
    pub(super) algorithm: String,
    pub(super) source: SourceSpec,
    /// The widest instructions to use
    #[arg(long)]
    pub(super) simd: Option<String>,
}

#[derive(Args, Debug)]
pub(super) struct AlgosOptions {
    /// Algorithms to describe in full: by name, by family, or exact, or all; separated by commas.
    /// Without any, one line for each of all, and which one to take
    #[arg(value_name = "LIST", value_parser = algorithms)]
    pub(super) list: Option<Algorithms>,

    /// List the counters of result files instead, each with its definition
    #[arg(long)]
    pub(super) counters: bool,

    /// How to list them
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t)]
    pub(super) format: ListFormat,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum ListFormat {
    #[default]
    Table,
    Json,
}

/// A list of algorithms; a type of its own because clap takes a `Vec` for a repeated option.
#[derive(Clone, Debug)]
pub(super) struct Algorithms(pub(super) Vec<Selection>);

fn algorithms(list: &str) -> Result<Algorithms, UsageError> {
    registry::select(list).map(Algorithms)
}

fn rules(text: &str) -> Result<Rules, UsageError> {
    if text.is_empty() {
        Ok(Rules::default())
    } else {
        text.parse()
    }
}

/// A distance that is not negative.
fn radius(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(radius) if radius >= 0.0 && radius.is_finite() => Ok(radius),
        _ => Err("give a distance of 0 or more".to_owned()),
    }
}

/// A distance above 0.
fn positive_distance(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(distance) if distance > 0.0 && distance.is_finite() => Ok(distance),
        _ => Err("give a distance above 0".to_owned()),
    }
}

fn tolerance(text: &str) -> Result<f64, String> {
    suite::tolerance(text.parse().ok())
}

fn row(name: &str) -> Result<String, table::UnknownFigure> {
    table::figure(name).map(|figure| figure.key.to_owned())
}

/// A number of threads.
fn threads() -> RangedI64ValueParser<u32> {
    value_parser!(u32).range(1..=i64::from(MOST_THREADS))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_are_consistent() {
        use clap::CommandFactory;
        Arguments::command().debug_assert();
    }
}
