//! The corpus: the models that results are compared on, by the hashes of their files.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use geobench_harness::exec::limits::DecompressionLimit;
use geobench_harness::exec::model::{self, ModelRef};
use geobench_harness::schema::ModelRecord;
use geobench_harness::usage::document::{DocumentError, TomlDocument};
use geobench_mesh::generate::Spec;
use serde::{Deserialize, Serialize};

/// The models of a corpus.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Corpus {
    /// In the order of the file.
    #[serde(default, rename = "model")]
    pub models: Vec<CorpusModel>,
}

/// A model of a corpus.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CorpusModel {
    /// Its name; of a file also the name of the file, with any ending.
    pub name: String,
    /// Where it is from, the specification of its generator, or how it was made.
    pub address: String,
    /// The hash, as in result files.
    pub sha256: String,
    /// The licence of a file.
    pub licence: Option<String>,
    /// The number of its faces.
    pub faces: u64,
    /// What it adds to the others.
    pub why: String,
}

/// Whether a model of the corpus is at hand.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "status", content = "detail")]
pub enum Presence {
    /// It has its hash; the path of its file, or its generator.
    Present(String),
    /// No file has its name.
    Missing,
    /// The file of its name has another content.
    Differs(String),
}

impl Corpus {
    /// The corpus of `bench-configs/site/corpus.toml`, which is part of the program.
    ///
    /// # Errors
    ///
    /// Never: a test parses it.
    pub fn known() -> Result<Self, DocumentError> {
        let text = include_str!("../embedded/corpus.toml");
        Self::of(&TomlDocument::new(Path::new("corpus.toml"), text))
    }

    /// Reads a corpus.
    ///
    /// # Errors
    ///
    /// When the file cannot be read or is no corpus.
    pub fn read(path: &Path) -> Result<Self, DocumentError> {
        Self::of(&TomlDocument::open(path)?)
    }

    fn of(document: &TomlDocument<'_>) -> Result<Self, DocumentError> {
        let corpus: Self = document.read(document.parse()?)?;
        for (i, model) in corpus.models.iter().enumerate() {
            let hash = &model.sha256;
            if hash.len() != 64 || !hash.bytes().all(|b| b.is_ascii_hexdigit()) {
                let problem = format!("of {} is no SHA-256 in hexadecimal digits", model.name);
                return Err(document.error_at("sha256", None, &problem));
            }
            let is_same = |other: &CorpusModel| other.name == model.name || other.sha256 == *hash;
            if corpus.models[..i].iter().any(is_same) {
                let problem = format!("{} is there twice", model.name);
                return Err(document.error_at("name", None, &problem));
            }
        }
        Ok(corpus)
    }

    /// The model with the hash of `record`.
    pub(crate) fn of_record(&self, record: &ModelRecord) -> Option<&CorpusModel> {
        let hash = record.sha256.as_ref()?;
        self.models.iter().find(|model| model.sha256 == *hash)
    }

    /// Looks for each model in `directory` and its subdirectories, and makes those that are
    /// generated. The order is that of the corpus.
    ///
    /// # Errors
    ///
    /// When the directory holds no models or cannot be read.
    pub fn check(
        &self,
        directory: &Path,
        limit: DecompressionLimit,
    ) -> anyhow::Result<Vec<(&CorpusModel, Presence)>> {
        let files = model::collect(&[directory.to_string_lossy()])?;
        let files: HashMap<String, &ModelRef> = files
            .iter()
            .filter_map(|file| {
                let path = PathBuf::from(&file.path);
                let name = path.file_name()?.to_string_lossy().into_owned();
                Some((name.split('.').next()?.to_owned(), file))
            })
            .collect();
        let presence = |model: &CorpusModel| {
            if model.is_generated() {
                let made = ModelRef::generated(&model.address);
                let hash = made.and_then(|made| Ok(made.load(limit)?.record.sha256));
                return match hash {
                    Ok(Some(hash)) if hash == model.sha256 => {
                        Presence::Present(model.address.clone())
                    }
                    Ok(_) => Presence::Differs("the generator makes another model".to_owned()),
                    Err(error) => Presence::Differs(error.to_string()),
                };
            }
            match files.get(&model.name) {
                None => Presence::Missing,
                Some(file) if file.file_sha256().as_ref() == Some(&model.sha256) => {
                    Presence::Present(file.path.clone())
                }
                Some(file) => Presence::Differs(format!("{} has another hash", file.path)),
            }
        };
        let models = self.models.iter();
        Ok(models.map(|model| (model, presence(model))).collect())
    }
}

impl CorpusModel {
    /// Whether a generator makes it.
    pub(crate) fn is_generated(&self) -> bool {
        Spec::is_spec(&self.address)
    }

    /// Whether the model was published elsewhere: its address is a URL. The others are generated,
    /// or files that were made by a rule.
    pub(crate) fn is_real(&self) -> bool {
        self.address.contains("://")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_a_rule_made_are_not_real() {
        let corpus = Corpus::known().unwrap();
        let real = corpus.models.iter().filter(|model| model.is_real());
        let names: Vec<&str> = real.map(|model| model.name.as_str()).collect();
        let scans = ["spot", "cow", "horse", "stanford-bunny", "igea", "suzanne"];
        assert_eq!(names, scans);
    }

    #[test]
    fn the_corpus_can_be_read_and_its_generated_models_are_theirs() {
        let corpus = Corpus::known().unwrap();
        assert!(corpus.models.iter().any(|model| model.name == "horse"));
        for model in corpus.models.iter().filter(|model| model.faces < 6000) {
            if model.is_generated() {
                let made = ModelRef::generated(&model.address).unwrap();
                let record = made.load(DecompressionLimit::default()).unwrap().record;
                assert_eq!(
                    record.sha256.as_ref(),
                    Some(&model.sha256),
                    "{}",
                    model.name
                );
                assert_eq!(record.faces, Some(model.faces), "{}", model.name);
                assert_eq!(corpus.of_record(&record).unwrap().name, model.name);
            } else {
                assert!(model.licence.is_some(), "{}", model.name);
            }
        }
    }

    #[test]
    fn missing_and_changed_models_are_named() {
        let directory = tempfile::tempdir().unwrap();
        let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        std::fs::write(directory.path().join("spot.obj"), triangle).unwrap();
        let hash = "00".repeat(32);
        let text = format!(
            "[[model]]\nname = \"spot\"\naddress = \"x\"\nsha256 = \"{hash}\"\nfaces = 1\nwhy = \"y\"\n\
             [[model]]\nname = \"none\"\naddress = \"x\"\nsha256 = \"{}\"\nfaces = 1\nwhy = \"y\"\n",
            "11".repeat(32)
        );
        let corpus = Corpus::of(&TomlDocument::new(Path::new("c.toml"), &text)).unwrap();
        let found = corpus
            .check(directory.path(), DecompressionLimit::default())
            .unwrap();
        assert!(matches!(&found[0].1, Presence::Differs(_)), "{found:?}");
        assert_eq!(found[1].1, Presence::Missing);
        let twice = text.replace("none", "spot");
        let error = Corpus::of(&TomlDocument::new(Path::new("c.toml"), &twice)).unwrap_err();
        assert!(error.to_string().contains("spot is there twice"), "{error}");
    }
}
