//! The cases: from seeds, from the slivers, or from files of an earlier run.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use geobench_oracle::nasty::{self, Kind};

use crate::case::{Case, Expected};
use crate::files;
use crate::slivers::{self, Sliver};

/// A case with a name.
pub(crate) struct Item {
    pub(crate) name: String,
    /// The row of the table.
    pub(crate) kind: String,
    pub(crate) case: Case,
    /// The known distances, if any.
    pub(crate) expected: Option<Expected>,
}

/// Cases, each made on demand.
pub(crate) enum Items {
    Seeds(Range<u64>, Option<Kind>),
    Slivers(Vec<Sliver>),
    Files(Vec<PathBuf>),
}

impl Items {
    pub(crate) fn slivers() -> io::Result<Self> {
        Ok(Self::Slivers(slivers::read()?))
    }

    /// Files saved by an earlier run, or folders of them.
    pub(crate) fn files(paths: &[PathBuf]) -> io::Result<Self> {
        let mut files = Vec::new();
        for path in paths {
            if path.is_dir() {
                let mut inside = Vec::new();
                for entry in path.read_dir()? {
                    let file = entry?.path();
                    if file.extension().is_some_and(|ending| ending == "obj") {
                        inside.push(file);
                    }
                }
                inside.sort();
                files.extend(inside);
            } else {
                files.push(path.clone());
            }
        }
        Ok(Self::Files(files))
    }

    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Seeds(seeds, _) => (seeds.end.saturating_sub(seeds.start)) as usize,
            Self::Slivers(slivers) => slivers.len(),
            Self::Files(files) => files.len(),
        }
    }

    pub(crate) fn get(&self, place: usize) -> io::Result<Item> {
        match self {
            Self::Seeds(seeds, kind) => {
                let seed = seeds.start + place as u64;
                Ok(of_seed(seed, *kind))
            }
            Self::Slivers(slivers) => Ok(of_sliver(&slivers[place])),
            Self::Files(files) => of_file(&files[place]),
        }
    }
}

fn of_seed(seed: u64, kind: Option<Kind>) -> Item {
    let mesh = match kind {
        Some(kind) => kind.mesh(seed),
        None => nasty::mesh(seed),
    };
    Item {
        name: mesh.model.name.clone(),
        kind: mesh.kind.to_string(),
        case: mesh.into(),
        expected: None,
    }
}

fn of_sliver(sliver: &Sliver) -> Item {
    Item {
        name: sliver.name.clone(),
        kind: "sliver".to_owned(),
        case: Case {
            vertices: sliver.vertices.clone(),
            faces: sliver.faces.clone(),
            sources: sliver.source.clone(),
            bounded: true,
        },
        expected: Some(sliver.distances.clone()),
    }
}

fn of_file(path: &Path) -> io::Result<Item> {
    Ok(Item {
        name: path.display().to_string(),
        kind: "file".to_owned(),
        case: files::read(path)?,
        expected: None,
    })
}
