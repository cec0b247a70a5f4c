//! The cases: from seeds, from the slivers, or from files of an earlier run.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use geobench_oracle::nasty::Kind;

use crate::case::{Case, Expected, Limited};
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

/// Kinds of meshes, which seeds take in turn.
#[derive(Clone, Debug)]
pub(crate) struct Kinds {
    kinds: Vec<Kind>,
    are_large: bool,
}

/// Reads the name of a kind, or of a set of kinds, as in the command line.
pub(crate) fn kinds(name: &str) -> Result<Kinds, String> {
    const LARGE: &str = "large";
    let of = |kinds: &[Kind], are_large| Kinds {
        kinds: kinds.to_vec(),
        are_large,
    };
    let named = |name: &str, among: &[Kind]| among.iter().copied().find(|kind| kind.name() == name);
    let large = name
        .strip_prefix(LARGE)
        .and_then(|rest| rest.strip_prefix('-'));
    match name {
        "general" => Ok(of(Kind::GENERAL, false)),
        "built" => Ok(of(Kind::BUILT, false)),
        "joined" => Ok(of(Kind::JOINED, false)),
        LARGE => Ok(of(Kind::BUILT, true)),
        _ => {
            let small = [Kind::GENERAL, Kind::BUILT, Kind::JOINED].concat();
            let kind = named(name, &small).map(|kind| of(&[kind], false));
            let large = large.and_then(|name| named(name, Kind::BUILT));
            kind.or(large.map(|kind| of(&[kind], true))).ok_or_else(|| {
                let list = |kinds: &[Kind]| -> String {
                    let names: Vec<&str> = kinds.iter().map(|kind| kind.name()).collect();
                    names.join(", ")
                };
                format!(
                    "known are general ({}), built ({}), joined ({}), and large, the same as \
                     built, but of up to 20,000 faces (large-chain, ...)",
                    list(Kind::GENERAL),
                    list(Kind::BUILT),
                    list(Kind::JOINED)
                )
            })
        }
    }
}

/// Cases, each made on demand.
pub(crate) enum Items {
    Seeds(Range<u64>, Vec<Kinds>),
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
            Self::Seeds(seeds, kinds) => seeds.clone().count() * kinds.len(),
            Self::Slivers(slivers) => slivers.len(),
            Self::Files(files) => files.len(),
        }
    }

    pub(crate) fn get(&self, place: usize) -> io::Result<Item> {
        match self {
            Self::Seeds(seeds, kinds) => {
                let count = seeds.clone().count();
                let seed = seeds.start + (place % count) as u64;
                Ok(of_seed(seed, &kinds[place / count]))
            }
            Self::Slivers(slivers) => Ok(of_sliver(&slivers[place])),
            Self::Files(files) => of_file(&files[place]),
        }
    }
}

fn of_seed(seed: u64, Kinds { kinds, are_large }: &Kinds) -> Item {
    let kind = kinds[(seed % kinds.len() as u64) as usize];
    let mesh = if *are_large {
        kind.large_mesh(seed)
    } else {
        kind.mesh(seed)
    };
    let name = mesh.model.name.clone();
    Item {
        kind: name.split(' ').next().unwrap_or_default().to_owned(),
        name,
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
            limited: Limited::All,
            transform: None,
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
