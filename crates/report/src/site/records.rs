//! What a site is made from: result files, certificates and the words of the owners of machines.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;
use geobench_harness::schema::{Host, ResultFile, SCHEMA, result_file};
use geobench_harness::usage::document::{DocumentError, TomlDocument};
use geobench_harness::usage::files_in;
use serde::Deserialize;

/// The schema of files of certificates, which `scripts/certificates` writes.
const CERTIFICATES: &str = "geobench-certificates/1";

/// The name of the file that describes the machines of the records beside it.
const MACHINES: &str = "machines.toml";

/// The records of a site.
#[derive(Clone, Debug, Default)]
pub struct SiteRecords {
    /// Result files, the newest first.
    pub(super) results: Vec<SiteRecord>,
    pub(super) certificates: Vec<ProvenMesh>,
    pub(super) machines: Vec<Machine>,
    /// The files of all these.
    pub(super) files: Vec<PathBuf>,
    /// Files that were skipped, in words.
    pub notes: Vec<String>,
}

/// A result file.
#[derive(Clone, Debug)]
pub(super) struct SiteRecord {
    /// Its name in the site: its path below the directory that was given, without ending.
    pub(super) name: String,
    pub(super) path: PathBuf,
    pub(super) result: ResultFile,
}

/// A proof of the distances on a mesh.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct ProvenMesh {
    pub(super) name: String,
    pub(super) faces: u64,
    pub(super) certified: bool,
    /// The largest relative error that the proof leaves.
    pub(super) relative: Option<f64>,
}

/// A machine, in its owner's words.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Machine {
    /// Its name on pages.
    pub(super) key: String,
    cpu: String,
    /// The numbers of processors that programs could use.
    cores: Vec<usize>,
    pub(super) owner: String,
    pub(super) words: String,
}

impl SiteRecords {
    /// Reads result files, files of certificates, and directories of both with their
    /// subdirectories. Other files in directories are skipped with a note.
    ///
    /// # Errors
    ///
    /// When something cannot be read, and when no result file is among it.
    pub fn read(paths: &[PathBuf]) -> anyhow::Result<Self> {
        let mut records = Self::default();
        for path in paths {
            if path.is_dir() {
                records.add_directory(path, "")?;
            } else {
                let name = path.file_stem().unwrap_or_default().to_string_lossy();
                records.add(path, name.into_owned())?;
            }
        }
        let names: Vec<String> = paths
            .iter()
            .map(|path| path.display().to_string())
            .collect();
        anyhow::ensure!(
            !records.results.is_empty(),
            "{}: no result file is there; name one that `run -o FILE.json` has written, or a \
             directory of them",
            names.join(", ")
        );
        let started = |record: &SiteRecord| record.result.started.clone();
        records.results.sort_by(|a, b| {
            let newest_first = started(b).cmp(&started(a));
            newest_first.then_with(|| a.name.cmp(&b.name))
        });
        // Records of one name have copies of their own.
        let mut taken = HashSet::new();
        for record in &mut records.results {
            let name = record.name.clone();
            for number in 2.. {
                if taken.insert(record.address()) {
                    break;
                }
                record.name = format!("{name}-{number}");
            }
        }
        Ok(records)
    }

    fn add_directory(&mut self, directory: &Path, prefix: &str) -> anyhow::Result<()> {
        for path in files_in(directory, "json")? {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            let name = format!("{prefix}{stem}");
            match schema(&path)?.as_deref() {
                Some(SCHEMA | CERTIFICATES) => self.add(&path, name)?,
                _ => self
                    .notes
                    .push(format!("{}: skipped, no result file", path.display())),
            }
        }
        let machines = directory.join(MACHINES);
        if machines.is_file() {
            self.machines.extend(read_machines(&machines)?);
            self.files.push(machines);
        }
        let failed = || format!("{}: cannot be read", directory.display());
        let entries = fs::read_dir(directory).with_context(failed)?;
        let mut below: Vec<PathBuf> = entries
            .filter_map(|entry| Some(entry.ok()?.path()))
            .filter(|path| path.is_dir() && !path.is_symlink())
            .collect();
        below.sort_unstable();
        for path in below {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let prefix = format!("{prefix}{name}/");
            self.add_directory(&path, &prefix)?;
        }
        Ok(())
    }

    fn add(&mut self, path: &Path, name: String) -> anyhow::Result<()> {
        self.files.push(path.to_owned());
        if schema(path)?.as_deref() == Some(CERTIFICATES) {
            #[derive(Deserialize)]
            struct File {
                certificates: Vec<ProvenMesh>,
            }
            let text = fs::read_to_string(path)?;
            let file: File = serde_json::from_str(&text)
                .with_context(|| format!("{}: no file of certificates", path.display()))?;
            self.certificates.extend(file.certificates);
            return Ok(());
        }
        self.results.push(SiteRecord {
            name,
            path: path.to_owned(),
            result: result_file::read(path)?,
        });
        Ok(())
    }

    /// The key of a machine: that of its description, or else made from its processor.
    pub(super) fn machine(&self, host: &Host) -> String {
        let described = self.machines.iter().find(|machine| {
            let is_cpu = host.cpu.as_ref() == Some(&machine.cpu);
            is_cpu && machine.cores.contains(&host.cores)
        });
        described.map_or_else(|| host.in_words(), |machine| machine.key.clone())
    }
}

impl SiteRecord {
    /// The day of its run.
    pub(super) fn date(&self) -> &str {
        let started = &self.result.started;
        started.get(..10).unwrap_or(started)
    }

    /// Its address in the site.
    pub(super) fn address(&self) -> String {
        format!("records/{}.json", self.name.replace('/', "-"))
    }
}

/// The schema that a file names.
fn schema(path: &Path) -> anyhow::Result<Option<String>> {
    #[derive(Deserialize)]
    struct Head {
        schema: Option<String>,
    }
    let failed = || format!("{}: cannot be read", path.display());
    let text = fs::read_to_string(path).with_context(failed)?;
    Ok(serde_json::from_str::<Head>(&text)
        .ok()
        .and_then(|head| head.schema))
}

fn read_machines(path: &Path) -> Result<Vec<Machine>, DocumentError> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct File {
        #[serde(default, rename = "machine")]
        machines: Vec<Machine>,
    }
    let document = TomlDocument::open(path)?;
    let file: File = document.read(document.parse()?)?;
    Ok(file.machines)
}
