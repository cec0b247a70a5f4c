//! The models that somebody has, to take the place of those that only stand for them.

use std::path::{Path, PathBuf};

use crate::exec::model::{self, ModelError, ModelRef};

/// The models in a directory and below it.
#[derive(Clone, Debug)]
pub struct Library {
    directory: PathBuf,
    models: Vec<ModelRef>,
}

impl Library {
    /// Looks through a directory.
    ///
    /// # Errors
    ///
    /// When it is no directory that can be read, or holds no mesh file.
    pub fn open(directory: &Path) -> Result<Self, ModelError> {
        if directory.is_file() {
            return Err(ModelError::Missing {
                path: directory.display().to_string(),
                problem: "a directory of models is expected".to_owned(),
            });
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

    /// The first model that goes by one of these names, the first of which counts most: by the name
    /// of its file without the ending, in which only letters and digits count, in any case.
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
    fn models_are_found_by_what_their_files_are_called() {
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
        assert!(
            matches!(error, ModelError::EmptyDirectory { .. }),
            "{error}"
        );
        let file = directory.path().join("horse.obj");
        std::fs::write(&file, "").unwrap();
        for wrong in [file, directory.path().join("none")] {
            let error = Library::open(&wrong).unwrap_err();
            assert!(matches!(error, ModelError::Missing { .. }), "{error}");
        }
    }
}
