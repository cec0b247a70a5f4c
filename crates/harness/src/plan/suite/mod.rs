//! Suites: combines settings of the command line, of a suite file and defaults into plans.
//!
//! A suite file (`geobench run --config SUITE.toml`) has one or more groups, each with models,
//! algorithms and a text about what it shows. Settings above the first group apply to all groups.
//! `bench-configs/README.md` describes the format.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use geobench_mesh::Weld;
use geobench_registry::UsageError;
use geobench_registry::{self as registry, Selection, SimdChoice};
use geobench_window::simd::Instructions;
use toml::Spanned;

use crate::exec::expected::{Expected, stored_files};
use crate::exec::model::{self, ModelError, ModelRef};
use crate::exec::source::SourceSpec;
use crate::plan::sampling::Seconds;
use crate::plan::{Plan, Reference, able_to_end_early, left_out_at_junctions};
use crate::schema::GroupRecord;
use crate::usage::DocumentError;
use options::{Algorithms, AlgorithmsOption, SimdOption};

#[cfg(feature = "suites")]
mod embedded;
mod file;
pub mod options;
mod programs;
mod settings;

#[cfg(feature = "suites")]
pub use embedded::{EmbeddedSuite, SUITES};
pub use file::{Suite, SuiteGroup};
pub use programs::read_programs;
pub use settings::{Settings, WantedModel};

/// Default seed of the order of the runs.
pub(crate) const DEFAULT_SEED: u64 = 1;

/// The plans of a benchmark.
#[derive(Clone, Debug)]
pub struct Plans {
    /// One plan per group, in order. A model has the same name in all plans.
    pub plans: Vec<Plan>,
    /// Warnings about models and algorithms that are left out and sources named twice, one line
    /// each.
    pub notes: Vec<String>,
    /// Files of sources and targets that settings name.
    pub point_files: Vec<PathBuf>,
}

impl Plans {
    /// The files that the runs read: models, stored distances, files of sources and targets.
    pub fn input_files(&self) -> Vec<PathBuf> {
        let models = self.plans.iter().flat_map(|plan| &plan.models);
        let models = models.filter_map(|model| model.source_file().map(Path::to_owned));
        let mut files: Vec<PathBuf> = models.chain(self.point_files.iter().cloned()).collect();
        for plan in &self.plans {
            match &plan.reference {
                Reference::Files(Expected::File(path)) => files.push(path.clone()),
                Reference::Files(Expected::BesideModels) => {
                    let of_model = |model: &ModelRef| {
                        let weld = model.weld().map(Weld::tolerance);
                        model.file_path().map(|path| stored_files(path, weld))
                    };
                    files.extend(plan.models.iter().filter_map(of_model).flatten());
                }
                Reference::None | Reference::Algorithm(_) | Reference::Unasked(_) => {}
            }
        }
        files
    }

    fn add(
        &mut self,
        settings: &Settings,
        models: Vec<ModelRef>,
        group: GroupRecord,
    ) -> Result<(), UsageError> {
        let sources = settings.source.source.clone().map(SourceSpec::of_all);
        let (sources, notes) = sources.unwrap_or_else(SourceSpec::largest).distinct();
        for note in notes {
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
        let files = [settings.source.file(), settings.goal.target.file()];
        let files = files.into_iter().flatten().map(Path::to_owned);
        self.point_files.extend(files);
        let reader = settings.reader.reader.unwrap_or_default();
        let models = models
            .into_iter()
            .map(|model| model.welded(settings.weld.vertices()).read_by(reader));
        let models = models.collect();
        let (plan, note) = plan(settings, sources, models, group)?;
        self.notes.extend(note);
        self.plans.push(plan);
        Ok(())
    }
}

/// Selects among the models of a suite.
#[derive(Clone, Debug, Default)]
pub struct ModelChoice {
    /// Whether to use the sizes of the paper instead of sizes for a small machine.
    pub full: bool,
    /// Real models, which replace their substitutes.
    pub library: Option<Library>,
}

/// The plans of `suite`, or a single plan without a suite. The settings `asked` take precedence
/// over those of the suite in all groups.
///
/// # Errors
///
/// If a model is missing that is not optional, or the reference is not usable for the plan.
pub fn plans(
    suite: Option<&Suite>,
    asked: &Settings,
    scale: &ModelChoice,
) -> anyhow::Result<Plans> {
    let mut done = Plans {
        plans: Vec::new(),
        notes: Vec::new(),
        point_files: Vec::new(),
    };
    let Some(suite) = suite else {
        let mut asked = asked.clone();
        let models = if let Some(models) = &asked.models {
            let arguments = models.iter().map(|model| &model.get_ref().path);
            let arguments: Vec<&str> = arguments.map(String::as_str).collect();
            model::collect(&arguments)?
        } else {
            // This bounds the built-in suite to about a minute, even on a noisy machine.
            let least = asked.min_time.map_or(0.0, |time| time.0);
            asked
                .max_time
                .get_or_insert(Seconds(MODELS_MAX_TIME.0.max(least)));
            model::collect(MODELS)?
        };
        if asked.algorithms.algorithms.is_some() || asked.simd.simd.is_some() {
            done.add(&asked, models, GroupRecord::default())?;
            return Ok(done);
        }
        for (name, shows, simd, algorithms) in GROUPS {
            let settings = Settings {
                simd: SimdOption { simd: Some(simd) },
                algorithms: AlgorithmsOption {
                    algorithms: Some(Algorithms(set(algorithms)?)),
                },
                ..Settings::default()
            };
            let record = GroupRecord {
                name: Some(name.to_owned()),
                shows: Some(shows.to_owned()),
                ..GroupRecord::default()
            };
            let settings = asked.or(&settings);
            done.add(&settings, models.clone(), record)?;
        }
        return Ok(done);
    };
    for group in &suite.groups {
        let settings = if scale.full {
            asked.or(&group.full).or(&group.settings)
        } else {
            asked.or(&group.settings)
        };
        let fail = |line, problem: String| DocumentError {
            path: suite.path.clone(),
            line,
            problem,
        };
        let Some(wanted) = &settings.models else {
            let problem = format!("group `{}` has no models", group.name);
            return Err(fail(None, problem).into());
        };
        let mut models = Vec::new();
        for wanted in wanted.iter().map(Spanned::get_ref) {
            if let Some(library) = scale.library.as_ref().filter(|_| !wanted.real.is_empty()) {
                if let Some(real) = library.find(&wanted.real) {
                    models.push(real.subdivided(wanted.subdivide)?);
                    continue;
                }
                done.notes.push(format!(
                    "group `{}`: no model called {} is in {}; {} stands for it",
                    group.name,
                    wanted.real.join(" or "),
                    library.directory().display(),
                    wanted.path
                ));
            }
            match model::collect(&[&wanted.path]) {
                Ok(found) => models.extend(found),
                Err(ModelError::Missing { path, problem }) if wanted.optional => {
                    done.notes.push(format!(
                        "group `{}`: the optional model {path} is left out: {problem}",
                        group.name
                    ));
                }
                Err(error) if wanted.line.is_some() => {
                    return Err(fail(wanted.line, format!("`models`: {error}")).into());
                }
                Err(error) => return Err(error.into()),
            }
        }
        if models.is_empty() {
            done.notes.push(format!(
                "group `{}` is left out: none of its models is there",
                group.name
            ));
            continue;
        }
        let record = GroupRecord {
            name: Some(group.name.clone()),
            // The text is about the models of the suite.
            shows: group.shows.clone().filter(|_| asked.models.is_none()),
            ..GroupRecord::default()
        };
        done.add(&settings, models, record)?;
    }
    name_alike(&mut done.plans);
    Ok(done)
}

/// Makes names of models unique across all plans. The same model has the same name in each.
fn name_alike(plans: &mut [Plan]) {
    let key = |model: &ModelRef| model.named_path();
    let mut known = HashSet::new();
    let models = plans.iter().flat_map(|plan| &plan.models);
    let all = models.filter(|model| known.insert(key(model)));
    let mut all: Vec<ModelRef> = all.cloned().collect();
    model::make_names_unique(&mut all);
    let names: HashMap<String, &str> = all
        .iter()
        .map(|model| (key(model), model.name.as_str()))
        .collect();
    for plan in plans {
        for model in &mut plan.models {
            names[&key(model)].clone_into(&mut model.name);
        }
        // A model given twice in one group would give two cells of the same name.
        let mut seen = HashSet::new();
        plan.models.retain(|model| seen.insert(model.name.clone()));
    }
}

/// The plan of a group, and a note on algorithms that are left out.
fn plan(
    settings: &Settings,
    sources: SourceSpec,
    models: Vec<ModelRef>,
    group: GroupRecord,
) -> Result<(Plan, Option<String>), UsageError> {
    let threads = settings.threads.number();
    let simd = settings.simd.simd.unwrap_or_default();
    let with_settings =
        |algorithm: Selection| algorithm.with_threads(threads).with_simd_in_table(simd);
    let algorithms = settings.algorithms.algorithms.clone();
    let algorithms = algorithms.map_or_else(usual, |algorithms| algorithms.0);
    let goal = settings.goal.spec();
    let (algorithms, note) = able_to_end_early(algorithms, &goal)?;
    let algorithms: Vec<Selection> = algorithms.into_iter().map(with_settings).collect();
    let reference = settings.check.clone().map(Spanned::into_inner);
    let reference = match reference {
        Some(Reference::Algorithm(one)) => Some(Reference::Algorithm(with_settings(one))),
        other => other,
    };
    let plan = Plan {
        group: GroupRecord {
            rows: settings.rows.clone().unwrap_or_default(),
            ratios_to: settings
                .ratios_to
                .as_ref()
                .map(|one| one.label().to_owned()),
            wavefront: settings.wavefront.unwrap_or(false),
            left_out_at_junctions: left_out_at_junctions(&algorithms),
            ..group
        },
        models,
        sources,
        sources_together: settings.sources_together.unwrap_or(false),
        goal,
        sampling: settings.sampling()?,
        warmup: settings.warmup.map_or(1, |runs| runs.0 as usize),
        counts: settings.counts.unwrap_or(true),
        reference: reference.unwrap_or_else(|| Reference::usual(&algorithms)),
        tolerance: settings.tolerance.number(),
        seed: settings.seed.map_or(DEFAULT_SEED, |seed| seed.0),
        simd,
        shard_range: None,
        limits: settings.limits.with(&settings.decompression),
        algorithms,
    };
    plan.check_reference()?;
    Ok((plan, note))
}

/// The algorithms of `list` as a set.
fn set(list: &str) -> Result<Vec<Selection>, UsageError> {
    let selected = registry::select(list)?.into_iter();
    Ok(selected.map(Selection::as_optional).collect())
}

/// The algorithms of a group without algorithms, and of `--simd` without `--algo`.
fn usual() -> Vec<Selection> {
    let [(_, _, _, papers), _] = GROUPS;
    set(papers).unwrap_or_default()
}

/// The built-in suite: closed and open surfaces, with and without handles, of regular and of
/// slender triangles, with about 3,000 to 20,000 faces. Its groups take less than a minute.
pub const MODELS: &[&str] = &[
    "gen:sphere,subdiv=4",
    "gen:torus,faces=20000,bump=0.1,seed=7",
    "gen:knot,faces=10000",
    "gen:terrain,n=100,seed=1",
    "gen:holes",
    "gen:anisotropic,faces=10000,g=4",
];

/// Default of `max-time` for the built-in suite: no timed run of a cell starts after it.
pub(crate) const MODELS_MAX_TIME: Seconds = Seconds(1.0);

/// Smaller surfaces of the same kinds, for comparing answers. The slowest algorithm takes seconds.
pub const SMALL_MODELS: &[&str] = &[
    "gen:sphere,subdiv=3",
    "gen:torus,faces=1200,bump=0.1,seed=7",
    "gen:knot,faces=1500",
    "gen:terrain,n=24,seed=1",
    "gen:holes",
    "gen:anisotropic,faces=1200,g=4",
];

/// The groups of the built-in suite: name, text, instructions and algorithms. Not all algorithms
/// are included: some are slower by orders of magnitude.
const GROUPS: [(&str, &str, SimdChoice, &str); 2] = [
    (
        "papers",
        "The algorithms that the papers compare, all with scalar instructions.",
        SimdChoice::AtMost(Instructions::Scalar),
        "mmp,ich,fwp-mmp,fwp-ch,vtp",
    ),
    (
        "fast",
        "The fast forms, with the widest instructions of the processor, beside vtp with scalar ones.",
        SimdChoice::Auto,
        "mmp-fast,ich-fast,vtp,vtp-fast",
    ),
];

/// The models in a directory and below it.
#[derive(Clone, Debug)]
pub struct Library {
    directory: PathBuf,
    models: Vec<ModelRef>,
}

impl Library {
    /// Finds the models in a directory.
    ///
    /// # Errors
    ///
    /// If the directory cannot be read, or contains no mesh file.
    pub fn open(directory: &Path) -> Result<Self, ModelError> {
        if directory.is_file() {
            let problem = format!("{}: not a directory", directory.display());
            return Err(ModelError::Unreadable(problem));
        }
        Ok(Self {
            directory: directory.to_owned(),
            models: model::collect(&[directory.display().to_string()])?,
        })
    }

    /// The directory.
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// The first model that has one of these names, which are in order of preference. Names are
    /// compared with file names without extensions. Only letters and digits count, and case is
    /// ignored.
    pub fn find(&self, names: &[String]) -> Option<&ModelRef> {
        names.iter().find_map(|name| {
            let wanted = letters_and_digits(name);
            let models = self.models.iter();
            models.into_iter().find(|model| {
                let stem = model.file_path().map(crate::exec::expected::stem);
                stem.is_some_and(|stem| letters_and_digits(&stem) == wanted)
            })
        })
    }
}

fn letters_and_digits(name: &str) -> String {
    name.chars()
        .filter(|c| c.is_alphanumeric())
        .flat_map(char::to_lowercase)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_are_found_by_the_names_of_their_files() {
        let directory = tempfile::tempdir().unwrap();
        std::fs::create_dir(directory.path().join("scans")).unwrap();
        for name in ["horse.obj", "scans/Asian_Dragon.ply.gz", "notes.txt"] {
            std::fs::write(directory.path().join(name), "").unwrap();
        }
        let library = Library::open(directory.path()).unwrap();
        let find = |names: &[&str]| {
            let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
            let path = library.find(&names)?.file_path()?.to_owned();
            Some(path.strip_prefix(directory.path()).unwrap().to_owned())
        };
        assert_eq!(find(&["Horse"]), Some("horse.obj".into()));
        assert_eq!(
            find(&["xyzrgb dragon", "asian dragon"]),
            Some("scans/Asian_Dragon.ply.gz".into())
        );
        assert_eq!(find(&["hor", "notes"]), None);
    }

    #[test]
    fn a_file_or_an_empty_directory_is_refused() {
        let directory = tempfile::tempdir().unwrap();
        let error = Library::open(directory.path()).unwrap_err();
        assert!(error.to_string().contains("no mesh file"), "{error}");
        let file = directory.path().join("horse.obj");
        std::fs::write(&file, "").unwrap();
        let error = Library::open(&file).unwrap_err().to_string();
        assert!(error.ends_with("horse.obj: not a directory"), "{error}");
        let error = Library::open(&directory.path().join("none")).unwrap_err();
        assert!(matches!(error, ModelError::Missing { .. }), "{error}");
    }
}
