//! Definition of the command line: the commands, the options of the commands that work on models,
//! and groups of options that several commands share. Options of the other commands are defined in
//! the files of these commands.

use std::path::{Path, PathBuf};

use clap::builder::RangedI64ValueParser;
use clap::{Args, Parser, Subcommand, ValueEnum, value_parser};
use geobench_export::output::{self, OutputFile};
use geobench_harness::exec::source::{SourceSpec, TargetSpec};
use geobench_harness::figures;
use geobench_harness::measure::instructions;
use geobench_harness::plan::sampling::{Seconds, Share};
use geobench_harness::plan::suite::{self, MOST_RUNS};
use geobench_harness::schema::Shard;
use geobench_registry::UsageError;
use geobench_registry::{self as registry, MOST_THREADS, Selection, SimdChoice};
use geobench_report::page::{Form, PictureChoice, Tables};
use geobench_report::table::Format;

use super::algos::AlgosOptions;
use super::claims::ClaimsOptions;
use super::cluster::ClusterOptions;
use super::compare::CompareOptions;
use super::generate::GenOptions;
use super::history::{RecordOptions, TrendOptions};
use super::info::InfoOptions;
use super::isolation::{DecompressionOptions, IsolationOptions, ReadingOptions};
use super::merge::MergeOptions;
use super::pool::PoolOptions;
use super::shell::{CompletionsOptions, ManOptions};
use super::terminal::ColorChoice;

/// Help text on models, for all commands that take models.
pub(super) const MODELS_HELP: &str = "MODEL is a file (.obj, .ply, .off, .stl, each also .gz), a directory (searched \
    recursively) or a generated model such as gen:sphere,subdiv=5 or gen:terrain,n=100,seed=1.";

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

    /// Format of a model that is read from standard input (-): obj, ply, off or stl
    #[arg(long, global = true, value_name = "FORM")]
    pub(super) input_format: Option<String>,

    /// Format of a file that is written to standard output (-): one of its endings, such as csv
    #[arg(long, global = true, value_name = "FORM")]
    pub(super) output_format: Option<String>,

    #[command(subcommand)]
    pub(super) command: Command,
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
    /// Make a new mesh for a surface, with evenly spread vertices: the dual of a Voronoi diagram
    Remesh(RemeshOptions),
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

    /// Suite file with models, algorithms and settings in groups; options override it
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
    pub(super) source: RunSourceOptions,

    #[command(flatten)]
    pub(super) goal: GoalOptions,

    /// Timed runs of each cell [default: 5 to 100, as many as --precision needs]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_RUNS)))]
    pub(super) repeat: Option<u32>,

    /// Repeat until the 95 % interval of the median time lies within this share of the median; short
    /// solves are timed in batches [default: 3%]
    #[arg(long, value_name = "P", conflicts_with = "repeat")]
    pub(super) precision: Option<Share>,

    /// Least time that the timed runs of a cell take together, such as 1s [default: 0.2s]
    #[arg(long, value_name = "T", conflicts_with = "repeat")]
    pub(super) min_time: Option<Seconds>,

    /// Time after which no timed run of a cell starts, such as 1m [default: 20s; 1s for the
    /// built-in suite]
    #[arg(long, value_name = "T", conflicts_with = "repeat")]
    pub(super) max_time: Option<Seconds>,

    /// Untimed runs of each cell before the timed ones [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(..=i64::from(MOST_RUNS)))]
    pub(super) warmup: Option<u32>,

    /// What answers must agree with: an algorithm, certificate (mmp with a proof of its distances),
    /// none, file (MODEL.sSOURCE.csv beside the model or in a folder named expected there or beside
    /// its folder), or the path of such a file
    /// [default: mmp-fast if it runs, else the first exact algorithm]
    #[arg(long, value_name = "REF")]
    pub(super) check: Option<String>,

    /// Largest relative difference that passes [default: 1e-9]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = tolerance)]
    pub(super) tolerance: Option<f64>,

    /// Seed of the order in which the algorithms take turns [default: 1]
    #[arg(long, value_name = "N")]
    pub(super) seed: Option<u64>,

    /// Threads of the parallel algorithms (pvtp, pch), of the set-up of svg, and of outside programs
    /// whose command has {threads} [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = threads())]
    pub(super) threads: Option<u32>,

    /// Instructions of every algorithm: auto (the widest of the processor), scalar, avx2 or avx512;
    /// narrower ones where the processor lacks them. Distances and counts do not depend on it
    /// [default: auto; scalar for the papers' algorithms without --algo and --config]
    #[arg(long, value_name = "SIMD")]
    pub(super) simd: Option<SimdChoice>,

    /// Cells that run at the same time; more than 1 disturbs the times, and tables and files say so
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value_t = 1, value_parser = threads())]
    pub(super) jobs: u32,

    #[command(flatten)]
    pub(super) isolation: IsolationOptions,

    /// Rows of tables: time, propagated and any other counter, generated, valid, ...; separated by
    /// commas [default: time, propagations and two measures of memory]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = row)]
    pub(super) rows: Option<Vec<String>>,

    /// Show the ratio of each algorithm to this one as well; of times, the median of the ratios run
    /// by run
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

    /// Journal that notes every run as it ends; runs that it holds are not repeated, so the same
    /// command continues where it was interrupted
    #[arg(long, value_name = "FILE")]
    pub(super) resume: Option<PathBuf>,

    /// Result file (.json) to add to; it keeps its cells and gets the others of this run, and the
    /// timed runs that a cell lacks
    #[arg(long, value_name = "FILE", conflicts_with = "shard")]
    pub(super) add_to: Option<PathBuf>,

    /// Run only part I of N of the plan, such as 2/3; every machine splits alike, and `geobench
    /// merge` joins the parts
    #[arg(long, value_name = "I/N")]
    pub(super) shard: Option<Shard>,

    /// Print no progress and no warnings
    #[arg(long)]
    pub(super) quiet: bool,

    /// Show no progress bar
    #[arg(long)]
    pub(super) no_progress: bool,
}

/// Where runs start.
#[derive(Args, Debug)]
pub(super) struct RunSourceOptions {
    /// Sources: first, a vertex number, random:N[,seed=S], all, edge:A-B,T (from vertex A the
    /// fraction T of the way to B), face:F,U,V,W (barycentric coordinates), at:X,Y,Z (the nearest
    /// point), or a list of these; may be repeated [default: first]
    #[arg(long, value_name = "SRC", allow_negative_numbers = true)]
    pub(super) source: Vec<SourceSpec>,

    /// Run once from all sources together, with distances from the nearest, not once from each
    #[arg(long)]
    pub(super) sources_together: bool,
}

/// Sources of a command on one model.
#[derive(Args, Debug)]
pub(super) struct SourcesOptions {
    /// The source: first, a vertex number, random:N[,seed=S], all, edge:A-B,T, face:F,U,V,W,
    /// at:X,Y,Z or a list of these; may be repeated. Of several sources the nearest counts
    #[arg(
        long,
        value_name = "SRC",
        required = true,
        allow_negative_numbers = true
    )]
    pub(super) source: Vec<SourceSpec>,
}

impl SourcesOptions {
    /// All sources.
    ///
    /// # Errors
    ///
    /// If a source is named twice.
    pub(super) fn all(&self) -> Result<SourceSpec, UsageError> {
        SourceSpec::of_all(self.source.iter().cloned())
    }
}

/// What runs are to find.
#[derive(Args, Debug)]
pub(super) struct GoalOptions {
    /// Only the distances of these points, in the forms of --source; may be repeated. Runs end as
    /// soon as they are final [default: all vertices]
    #[arg(long, value_name = "DST", allow_negative_numbers = true)]
    pub(super) target: Vec<TargetSpec>,

    /// The same from a file with one DST in a line
    #[arg(long, value_name = "FILE")]
    pub(super) targets: Option<PathBuf>,

    /// Only distances up to R, in the units of the model; others are infinite. Runs end there
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = radius)]
    pub(super) radius: Option<f64>,
}

impl RunSourceOptions {
    /// All given sources as one list; `None` if none are given.
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
    /// Directory of models that replace the stand-ins of the suite with the same names
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
    /// `format`, with these kinds of rows if it is CSV.
    pub(super) fn of(self, format: Format) -> Format {
        match (format, self.csv) {
            (Format::Csv, CsvRows::Samples) => Format::Samples,
            (format, _) => format,
        }
    }

    /// The output files at `paths` with their formats; CSV files get these kinds of rows.
    pub(super) fn outputs(self, paths: &[PathBuf]) -> anyhow::Result<Vec<(Format, OutputFile)>> {
        let outputs = output::prepare(paths)?.into_iter();
        Ok(outputs
            .map(|(format, file)| (self.of(format), file))
            .collect())
    }
}

/// What is found out beside the usual figures.
#[derive(Args, Debug)]
pub(super) struct ExtraOptions {
    /// Keep samples of the wavefront of each counted run, for the plots of `geobench report`
    #[arg(long)]
    pub(super) wavefront: bool,

    /// Count the instructions of one solve of each cell under Valgrind, which takes some fifty times
    /// as long as the solve (row `instructions`)
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

    #[command(flatten)]
    pub(super) goal: GoalOptions,

    /// Largest relative difference that passes
    #[arg(long, value_name = "T", allow_negative_numbers = true, default_value_t = 1e-9, value_parser = tolerance)]
    pub(super) tolerance: f64,

    /// Threads of the parallel algorithms (pvtp, pch), of the set-up of svg, and of outside programs
    /// whose command has {threads}
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value_t = 1, value_parser = threads())]
    pub(super) threads: u32,

    /// Instructions of every algorithm: auto (the widest of the processor), scalar, avx2 or avx512;
    /// narrower ones where the processor lacks them. Distances and counts do not depend on it
    #[arg(long, value_name = "SIMD", default_value_t)]
    pub(super) simd: SimdChoice,

    /// Where answers disagree, prove which are right, as `geobench certify` does
    #[arg(long)]
    pub(super) certify: bool,

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

    #[command(flatten)]
    pub(super) sources: SourcesOptions,

    /// Distances to prove, of any program: lines `vertex,distance`, for all vertices or some
    /// [default: those of mmp]
    #[arg(long, value_name = "FILE")]
    pub(super) distances: Option<PathBuf>,

    /// Largest error that passes, as a fraction of each distance
    #[arg(long, value_name = "T", allow_negative_numbers = true, default_value_t = 1e-9, value_parser = tolerance)]
    pub(super) tolerance: f64,

    /// Threads that read the model and share the proof
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value_t = 1, value_parser = threads())]
    pub(super) threads: u32,

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

    #[command(flatten)]
    pub(super) sources: SourcesOptions,

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

    /// Print no summary
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

    #[command(flatten)]
    pub(super) sources: SourcesOptions,

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

    /// Print no summary
    #[arg(long)]
    pub(super) quiet: bool,
}

#[derive(Args, Debug)]
#[command(after_help = MODELS_HELP)]
pub(super) struct DistanceOptions {
    /// The model
    #[arg(value_name = "MODEL")]
    pub(super) model: String,

    #[command(flatten)]
    pub(super) sources: SourcesOptions,

    #[command(flatten)]
    pub(super) goal: GoalOptions,

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

    /// Threads that read the model, set up the solver and write the distances; also of a parallel
    /// algorithm (pvtp), or with --each so many sources at a time
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value_t = 1, value_parser = threads())]
    pub(super) threads: u32,

    /// Instructions of every algorithm: auto (the widest of the processor), scalar, avx2 or avx512;
    /// narrower ones where the processor lacks them. Distances and counts do not depend on it
    #[arg(long, value_name = "SIMD", default_value_t)]
    pub(super) simd: SimdChoice,

    #[command(flatten)]
    pub(super) reading: ReadingOptions,

    /// File to write, by its ending: .csv, .json, .npy, .ply or .vtk
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,

    /// Print no summary
    #[arg(long)]
    pub(super) quiet: bool,
}

#[derive(Args, Debug)]
#[command(after_help = MODELS_HELP)]
pub(super) struct VoronoiOptions {
    /// The model
    #[arg(value_name = "MODEL")]
    pub(super) model: String,

    /// The source: first, a vertex number, random:N[,seed=S], all, edge:A-B,T, face:F,U,V,W,
    /// at:X,Y,Z or a list of these; may be repeated. One that is named twice has one cell
    #[arg(long, value_name = "SRC", required = true, allow_negative_numbers = true, value_parser = SourceSpec::with_repeats)]
    pub(super) source: Vec<SourceSpec>,

    /// The algorithm: window-vtp, lct11 or xls14
    #[arg(long, value_name = "A", default_value = "window-vtp", value_parser = registry::select_one)]
    pub(super) algo: Selection,

    #[command(flatten)]
    pub(super) reading: ReadingOptions,

    /// File to write, by its ending: .json (cells, vertices, arcs), .obj or .vtk (borders as
    /// polylines), .ply (the model coloured by cell, cut along the borders), .svg or .png (a
    /// picture)
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,

    /// Mesh to write as well, .obj, .ply, .off or .stl: the dual triangulation, whose vertices are
    /// the sources
    #[arg(long, value_name = "FILE")]
    pub(super) dual: Option<PathBuf>,

    /// File to write as well, .obj, .ply or .vtk: the borders between cells as polylines
    #[arg(long, value_name = "FILE")]
    pub(super) borders: Option<PathBuf>,

    /// File to write as well, .csv or .npy: the place of the nearest source of each vertex in the
    /// list of sources
    #[arg(long, value_name = "FILE")]
    pub(super) labels: Option<PathBuf>,

    /// Print no summary
    #[arg(long)]
    pub(super) quiet: bool,
}

#[derive(Args, Debug)]
#[command(after_help = MODELS_HELP)]
pub(super) struct RemeshOptions {
    /// The model
    #[arg(value_name = "MODEL")]
    pub(super) model: String,

    /// Number of vertices of the new mesh; a few more are added where needed
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..))]
    pub(super) sites: u32,

    /// Steps of Lloyd's algorithm, each of which moves the sites to the centres of their cells
    #[arg(long, value_name = "K", default_value_t = 5, value_parser = value_parser!(u32).range(..=1000))]
    pub(super) lloyd: u32,

    /// Draws the first site
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub(super) seed: u64,

    #[command(flatten)]
    pub(super) reading: ReadingOptions,

    /// Mesh to write: .obj, .ply, .off or .stl, each also .gz
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,

    /// Picture to write as well, .svg or .png: the model with the cells of the sites, and the new
    /// mesh beside it
    #[arg(long, value_name = "FILE")]
    pub(super) picture: Option<PathBuf>,

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
    pub(super) picture: Option<PictureChoice>,

    /// Tables of the papers to compare ratios with, such as 000-table-1, separated by commas, or
    /// none [default: that of the suite that the result was made with]
    #[arg(long, value_name = "LIST")]
    pub(super) papers: Option<Tables>,

    #[command(flatten)]
    pub(super) decompression: DecompressionOptions,

    /// Print no summary and no warnings
    #[arg(long)]
    pub(super) quiet: bool,
}

impl ReportOptions {
    /// The requested forms of report files, each with its directory.
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
pub(super) struct CountOneSolveOptions {
    pub(super) model: String,
    pub(super) algorithm: String,
    pub(super) source: SourceSpec,
    /// The targets; all vertices without any
    #[arg(long, allow_negative_numbers = true)]
    pub(super) target: Option<TargetSpec>,
    /// The largest distance asked for
    #[arg(long)]
    pub(super) radius: Option<f64>,
    /// The widest instructions to use
    #[arg(long)]
    pub(super) simd: Option<String>,
    #[command(flatten)]
    pub(super) decompression: DecompressionOptions,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum ListFormat {
    #[default]
    Table,
    Json,
}

/// A list of algorithms. This is a separate type because clap treats a `Vec` as a repeated option.
#[derive(Clone, Debug)]
pub(super) struct Algorithms(pub(super) Vec<Selection>);

pub(super) fn algorithms(list: &str) -> Result<Algorithms, UsageError> {
    registry::select(list).map(Algorithms)
}

/// Parses a distance that is at least 0.
fn radius(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(radius) if radius >= 0.0 && radius.is_finite() => Ok(radius),
        _ => Err("give a distance of 0 or more".to_owned()),
    }
}

/// Parses a distance above 0.
fn positive_distance(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(distance) if distance > 0.0 && distance.is_finite() => Ok(distance),
        _ => Err("give a distance above 0".to_owned()),
    }
}

fn tolerance(text: &str) -> Result<f64, String> {
    suite::tolerance(text.parse().ok())
}

fn row(name: &str) -> Result<String, UsageError> {
    figures::figure(name).map(|figure| figure.key.to_owned())
}

/// The parser of a number of threads.
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
