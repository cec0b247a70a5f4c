//! Stored distances, used as references of checks.

use std::path::{Path, PathBuf};
use std::{fmt, fs};

use geobench_registry::UsageError;

use crate::schema::SourceLabel;
use crate::usage::{first_field, quoted, read_text};

/// Where stored distances are looked up.
///
/// A file `MODEL.sSOURCE.csv` holds lines `vertex,distance` for all or some vertices. MODEL is the
/// file name of the model without extensions, for a welded model with the end of its name, such as
/// `-weld`; SOURCE is the number of the source vertex.
#[derive(Clone, Debug)]
pub enum Expected {
    /// Beside the model, or in the folder `expected` in or beside the folder of the model.
    BesideModels,
    /// This file, whatever its name.
    File(PathBuf),
}

/// Distances read from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredDistances {
    /// The file.
    pub path: PathBuf,
    /// Vertices and their distances, at least one.
    pub distances: Vec<(usize, f64)>,
}

impl fmt::Display for Expected {
    /// In the notation of the command line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BesideModels => f.write_str("file"),
            Self::File(path) => write!(f, "{}", path.display()),
        }
    }
}

impl Expected {
    /// Reads the distances stored for `model`, welded within the tolerance `weld`, which has
    /// `vertices` vertices, and a source.
    ///
    /// # Errors
    ///
    /// If there is no such file, or it is invalid.
    pub fn find(
        &self,
        model: &Path,
        weld: Option<f64>,
        source: &SourceLabel,
        vertices: usize,
    ) -> Result<StoredDistances, UsageError> {
        let path = match self {
            Self::File(path) => path.clone(),
            Self::BesideModels => {
                let name = format!("{}.s{}.csv", welded_stem(model, weld), file_word(source));
                let mut paths = folders(model).into_iter().map(|folder| folder.join(&name));
                paths.find(|path| path.is_file()).ok_or_else(|| {
                    UsageError(format!(
                        "there is no {name} beside the model, in its folder `expected` or in `../expected`"
                    ))
                })?
            }
        };
        read(&path, vertices)
    }
}

/// The source as it appears in file names: `17`, `face-12_0.2_0.3_0.5`.
pub fn file_word(source: &SourceLabel) -> String {
    let word = |c: char| match c {
        ':' | '-' => '-',
        ',' => '_',
        c => c,
    };
    source.to_string().chars().map(word).collect()
}

/// The source vertices for which distances of `model`, welded within `weld`, are stored; ascending.
pub fn stored_sources(model: &Path, weld: Option<f64>) -> Vec<u32> {
    let numbers = stored(model, weld).filter_map(|(source, _)| source.parse().ok());
    let mut sources: Vec<u32> = numbers.collect();
    sources.sort_unstable();
    sources.dedup();
    sources
}

/// The files that hold distances of `model`, welded within `weld`.
pub(crate) fn stored_files(model: &Path, weld: Option<f64>) -> Vec<PathBuf> {
    stored(model, weld).map(|(_, path)| path).collect()
}

/// The files that hold distances of `model`, each behind its source as in its name.
fn stored(model: &Path, weld: Option<f64>) -> impl Iterator<Item = (String, PathBuf)> {
    let prefix = format!("{}.s", welded_stem(model, weld));
    let folders = folders(model).into_iter();
    let entries = folders.filter_map(|folder| fs::read_dir(folder).ok());
    entries.flatten().filter_map(move |entry| {
        let path = entry.ok()?.path();
        let name = path.file_name()?.to_str()?;
        let source = name.strip_prefix(&prefix)?.strip_suffix(".csv")?;
        Some((source.to_owned(), path))
    })
}

fn folders(model: &Path) -> [PathBuf; 3] {
    let folder = match model.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    };
    let expected = folder.join("expected");
    let beside = match (folder.parent(), folder.file_name()) {
        (Some(parent), Some(_)) => parent.join("expected"),
        _ => folder.join("..").join("expected"),
    };
    [folder, expected, beside]
}

/// The end of the name of a model that is welded within `weld`.
pub(crate) fn weld_suffix(weld: Option<f64>) -> String {
    match weld {
        None => String::new(),
        Some(0.0) => "-weld".to_owned(),
        Some(tolerance) => format!("-weld={tolerance:?}"),
    }
}

fn welded_stem(model: &Path, weld: Option<f64>) -> String {
    format!("{}{}", stem(model), weld_suffix(weld))
}

/// The file name without `.gz` and without the extension before it.
pub fn stem(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = match name.len().checked_sub(3) {
        Some(at) if name.is_char_boundary(at) && name[at..].eq_ignore_ascii_case(".gz") => {
            &name[..at]
        }
        _ => &name,
    };
    match name.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem.to_owned(),
        _ => name.to_owned(),
    }
}

fn read(path: &Path, vertices: usize) -> Result<StoredDistances, UsageError> {
    let text = read_text(path);
    let text = text.map_err(|error| UsageError(format!("{}: {error}", path.display())))?;
    parse(path, &text, vertices)
}

/// Parses the text of the file `path`.
///
/// # Errors
///
/// Names the first invalid line.
pub(crate) fn parse(
    path: &Path,
    text: &str,
    vertices: usize,
) -> Result<StoredDistances, UsageError> {
    let error = |line: usize, problem: &str| {
        UsageError(format!("{}, line {line}: {problem}", path.display()))
    };
    let mut distances = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || (distances.is_empty() && is_header(line)) {
            continue;
        }
        let parsed = parse_line(line, vertices);
        distances.push(parsed.map_err(|problem| error(index + 1, &problem))?);
    }
    if distances.is_empty() {
        return Err(error(1, "the file holds no distances"));
    }
    Ok(StoredDistances {
        path: path.to_owned(),
        distances,
    })
}

/// Whether a line names the columns of distances.
fn is_header(line: &str) -> bool {
    let (first, rest) = first_field(line);
    let second = rest.map(|rest| first_field(rest).0);
    ["vertex", "target"]
        .iter()
        .any(|name| first.eq_ignore_ascii_case(name))
        && second.is_some_and(|second| second.eq_ignore_ascii_case("distance"))
}

/// Parses `vertex,distance`. The distance is `inf` if the vertex is unreachable.
fn parse_line(line: &str, vertices: usize) -> Result<(usize, f64), String> {
    let (vertex, rest) = first_field(line);
    let rest =
        rest.ok_or_else(|| format!("`{}` is not of the form vertex,distance", quoted(line)))?;
    let (distance, rest) = first_field(rest);
    if rest.is_some() {
        return Err(format!(
            "`{}` is not of the form vertex,distance",
            quoted(line)
        ));
    }
    let vertex: usize = vertex
        .parse()
        .map_err(|_| format!("`{}` is not a vertex number", quoted(&vertex)))?;
    if vertex >= vertices {
        return Err(format!(
            "vertex {vertex} does not exist: the model has {vertices} vertices, numbered from 0"
        ));
    }
    match distance.parse::<f64>() {
        Ok(value) if value >= 0.0 => Ok((vertex, value)),
        _ => Err(format!("`{}` is not a distance", quoted(&distance))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_are_taken_off() {
        assert_eq!(stem(Path::new("a/horse.obj")), "horse");
        assert_eq!(stem(Path::new("horse.v2.ply.GZ")), "horse.v2");
        assert_eq!(stem(Path::new("horse")), "horse");
        assert_eq!(stem(Path::new(".off")), ".off");
    }

    #[test]
    fn files_are_found_beside_the_model_and_beside_its_folder() {
        let root = tempfile::tempdir().unwrap();
        let model = root.path().join("models/cow.off");
        for folder in ["models", "expected"] {
            fs::create_dir(root.path().join(folder)).unwrap();
        }
        fs::write(
            root.path().join("expected/cow.s3.csv"),
            "vertex,distance\n3,0.0\n1,inf\n",
        )
        .unwrap();
        fs::write(root.path().join("models/cow.s0.csv"), "0,0\n").unwrap();
        fs::write(root.path().join("models/cow.sx.csv"), "").unwrap();

        assert_eq!(stored_sources(&model, None), [0, 3]);
        let field = Expected::BesideModels
            .find(&model, None, &3.into(), 4)
            .unwrap();
        assert_eq!(field.distances, [(3, 0.0), (1, f64::INFINITY)]);
        assert!(
            Expected::BesideModels
                .find(&model, None, &0.into(), 4)
                .is_ok()
        );
        assert_eq!(
            Expected::BesideModels
                .find(&model, None, &1.into(), 4)
                .unwrap_err()
                .to_string(),
            "there is no cow.s1.csv beside the model, in its folder `expected` or in `../expected`"
        );
    }

    #[test]
    fn a_bad_line_is_named() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("x.csv");
        for (text, problem) in [
            (
                "vertex,distance\n0,0\n1;2\n",
                "line 3: `1;2` is not of the form vertex,distance",
            ),
            ("0,0\n-1,2\n", "line 2: `-1` is not a vertex number"),
            (
                "7,0\n",
                "line 1: vertex 7 does not exist: the model has 4 vertices, numbered from 0",
            ),
            ("0,NaN\n", "line 1: `NaN` is not a distance"),
            ("0,-1\n", "line 1: `-1` is not a distance"),
            ("vertex,distance\n", "line 1: the file holds no distances"),
        ] {
            fs::write(&path, text).unwrap();
            let error = Expected::File(path.clone())
                .find(Path::new("x.obj"), None, &0.into(), 4)
                .unwrap_err();
            assert!(error.to_string().ends_with(problem), "{error}");
        }
        assert!(
            Expected::File("/no/such.csv".into())
                .find(Path::new("x"), None, &0.into(), 4)
                .is_err()
        );
    }
}
