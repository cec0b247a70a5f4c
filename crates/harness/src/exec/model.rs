//! Models: what users name, and loading it.

use std::cmp::Reverse;
use std::collections::{BTreeMap, HashMap};
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::iter;
use std::path::{Path, PathBuf};
use std::time::Instant;

pub mod standard_input;

use geobench_mesh::generate::{self, Spec};
use geobench_mesh::io::{ObjReader, ReadOptions, files_beside};
use geobench_mesh::{
    InvalidMesh, Mesh, MeshMeasures, Report, TriangleSoup, VertexId, Weld, io as mesh_io,
};
use sha2::{Digest, Sha256};

use crate::exec::expected::{stem, weld_suffix};
use crate::exec::limits::MemoryLimit;
use crate::schema::{LargestComponent, ModelRecord};

/// A model that a user named, not loaded yet.
#[derive(Clone, Debug)]
pub struct ModelRef {
    /// Its name in tables and results, unique among the models of the command.
    pub name: String,
    /// The file as the user wrote it, or `gen:` and the spec.
    pub path: String,
    origin: ModelOrigin,
    /// Which of its vertices are welded. Its name says so, too.
    weld: Option<Weld>,
    /// What reads it if it is an OBJ file.
    reader: ObjReader,
}

#[derive(Clone, Debug)]
enum ModelOrigin {
    File(PathBuf),
    Generated(Spec),
    Memory(Mesh),
}

/// A model in memory.
#[derive(Clone, Debug)]
pub struct LoadedModel {
    /// The mesh.
    pub mesh: Mesh,
    /// Its counts and sizes.
    pub measures: MeshMeasures,
    /// Defects and repairs.
    pub report: Report,
    /// Its record in result files.
    pub record: ModelRecord,
}

/// Why a model cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The file does not exist or is not accessible.
    #[error("{path}: {problem}; give a mesh file, a directory or `gen:NAME,...`")]
    Missing {
        /// The argument.
        path: String,
        /// The error.
        problem: String,
    },
    /// The file, the directory or the spec cannot be read: the error and its place.
    #[error("{0}")]
    Unreadable(String),
    /// The mesh has fatal defects.
    #[error("{path}: {error}")]
    Invalid {
        /// The argument.
        path: String,
        /// The defects.
        error: InvalidMesh,
    },
}

/// The only model that `argument` names.
///
/// # Errors
///
/// As [`collect`]; also when it names several.
pub fn only(argument: &str) -> anyhow::Result<ModelRef> {
    let mut models = collect(&[argument])?;
    match (models.pop(), models.len()) {
        (Some(model), 0) => Ok(model),
        (_, others) => anyhow::bail!("{argument}: holds {} models; name one of them", others + 1),
    }
}

/// The models that `arguments` name: files, directories (searched recursively, sorted by name)
/// and `gen:` specs.
///
/// # Errors
///
/// When an argument is none of these; models themselves are only read by [`ModelRef::load`].
pub fn collect<S: AsRef<str>>(arguments: &[S]) -> Result<Vec<ModelRef>, ModelError> {
    let mut models = Vec::new();
    for argument in arguments {
        let argument = argument.as_ref();
        if Spec::is_spec(argument) {
            models.push(ModelRef::generated(argument)?);
            continue;
        }
        let of_standard_input;
        let mut path = Path::new(argument);
        if argument == "-" {
            of_standard_input = standard_input::file().map_err(ModelError::Unreadable)?;
            path = &of_standard_input;
        }
        let missing = |error: io::Error| ModelError::Missing {
            path: argument.to_owned(),
            problem: match error.kind() {
                io::ErrorKind::NotFound => "no such file or directory".to_owned(),
                kind => kind.to_string(),
            },
        };
        if fs::metadata(path).map_err(missing)?.is_dir() {
            let mut found = Vec::new();
            search(path, &mut found);
            if found.is_empty() {
                return Err(ModelError::Unreadable(format!(
                    "{argument}: no mesh file in this directory or below it; they end in {}",
                    mesh_io::READABLE
                )));
            }
            models.extend(found.into_iter().map(ModelRef::file));
        } else if mesh_io::is_mesh_file(path) {
            models.push(ModelRef {
                path: argument.to_owned(),
                ..ModelRef::file(path.to_owned())
            });
        } else {
            let problem = mesh_io::problem_of_ending(path);
            return Err(ModelError::Unreadable(format!("{argument}: {problem}")));
        }
    }
    make_names_unique(&mut models);
    Ok(models)
}

/// Adds the mesh files in `directory` and below it, sorted by name. Links to directories are not
/// followed: they could lead in a circle.
///
/// Whatever has the ending of a mesh file is added, also a link to nothing or a pipe, and so is a
/// directory that cannot be read: [`ModelRef::load`] tells why it cannot be used. Without them a
/// data set that is not there in full would give a smaller table.
fn search(directory: &Path, found: &mut Vec<PathBuf>) {
    let entries = fs::read_dir(directory).and_then(Iterator::collect::<io::Result<Vec<_>>>);
    let Ok(mut entries) = entries else {
        found.push(directory.to_owned());
        return;
    };
    entries.sort_unstable_by_key(fs::DirEntry::file_name);
    for entry in entries {
        let path = entry.path();
        let before = found.len();
        let is_directory = entry.file_type().is_ok_and(|kind| kind.is_dir());
        if is_directory {
            search(&path, found);
        }
        let is_mesh = mesh_io::is_mesh_file(&path) || mesh_io::is_packed(&path);
        if is_mesh && (!is_directory || found.len() == before) {
            found.push(path);
        }
    }
}

/// Models of the same name get their whole path as name, and a number if that is the same too.
pub(crate) fn make_names_unique(models: &mut [ModelRef]) {
    let mut uses = HashMap::<String, usize>::new();
    for model in models.iter() {
        *uses.entry(model.name.clone()).or_default() += 1;
    }
    let mut seen = HashMap::<String, usize>::new();
    for model in models {
        if uses[&model.name] > 1 {
            model.name = model.named_path();
        }
        let count = seen.entry(model.name.clone()).or_default();
        *count += 1;
        if *count > 1 {
            model.name = format!("{} #{count}", model.name);
        }
    }
}

impl ModelRef {
    fn file(path: PathBuf) -> Self {
        Self {
            name: stem(&path),
            path: path.display().to_string(),
            origin: ModelOrigin::File(path),
            weld: None,
            reader: ObjReader::default(),
        }
    }

    /// The model that a generator makes from `spec`. Its name is the spec as written, without
    /// `gen:`. Its path is the spec with all defaults.
    ///
    /// # Errors
    ///
    /// When there is no such generator or its parameters are not valid.
    pub fn generated(spec: &str) -> Result<Self, ModelError> {
        let parsed = spec.parse::<Spec>();
        let parsed = parsed.map_err(|error| ModelError::Unreadable(format!("{spec}: {error}")))?;
        Ok(Self {
            name: spec.strip_prefix("gen:").unwrap_or(spec).to_owned(),
            path: parsed.to_string(),
            origin: ModelOrigin::Generated(parsed),
            weld: None,
            reader: ObjReader::default(),
        })
    }

    /// A mesh that the caller has, for runs in this process only.
    pub fn in_memory(name: &str, mesh: &Mesh) -> Self {
        Self {
            name: name.to_owned(),
            path: name.to_owned(),
            origin: ModelOrigin::Memory(mesh.clone()),
            weld: None,
            reader: ObjReader::default(),
        }
    }

    /// The model with these vertices welded. It is another model: its name ends in `-weld` or, with
    /// a tolerance, such as `-weld=1e-6`. A mesh in memory stays as it is.
    #[must_use]
    pub fn welded(mut self, weld: Option<Weld>) -> Self {
        if !matches!(self.origin, ModelOrigin::Memory(_)) {
            self.weld = weld;
            self.name += &self.weld_suffix();
        }
        self
    }

    /// The model, read by `reader` if it is an OBJ file. All readers make the same of it.
    #[must_use]
    pub fn read_by(self, reader: ObjReader) -> Self {
        Self { reader, ..self }
    }

    /// What reads it if it is an OBJ file.
    pub(crate) const fn reader(&self) -> ObjReader {
        self.reader
    }

    /// Which of its vertices are welded.
    pub const fn weld(&self) -> Option<Weld> {
        self.weld
    }

    /// Its path, with the end of the name of a welded model.
    pub(crate) fn named_path(&self) -> String {
        format!("{}{}", self.path, self.weld_suffix())
    }

    fn weld_suffix(&self) -> String {
        weld_suffix(self.weld.map(Weld::tolerance))
    }

    /// The model of a file, each face split into four `times` times. Its name has the factor by
    /// which the faces grow, such as `horse-x16`. A generated model stays as it is.
    ///
    /// # Errors
    ///
    /// When the spec is invalid.
    pub(crate) fn subdivided(&self, times: u32) -> Result<Self, ModelError> {
        let Some(path) = self.file_path().filter(|_| times > 0) else {
            return Ok(self.clone());
        };
        // In quotation marks, in which a quotation mark is doubled: a path may have commas.
        let path_text = path.display().to_string().replace('"', "\"\"");
        let spec = format!("gen:file,path=\"{path_text}\",subdivide={times}");
        Ok(Self {
            name: format!("{}-x{}", stem(path), 4_u64.saturating_pow(times)),
            ..Self::generated(&spec)?
        })
    }

    /// A model that does not exist, for tests.
    #[cfg(any(test, feature = "mock"))]
    pub(crate) fn named(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            path: format!("{name}.obj"),
            origin: ModelOrigin::File(PathBuf::from(format!("{name}.obj"))),
            weld: None,
            reader: ObjReader::default(),
        }
    }

    /// The inverse of [`argument`](Self::argument).
    ///
    /// # Errors
    ///
    /// When the argument is invalid.
    pub(crate) fn named_by(
        argument: &OsStr,
        name: String,
        weld: Option<Weld>,
        reader: ObjReader,
    ) -> Result<Self, ModelError> {
        let model = match argument.to_str().filter(|text| Spec::is_spec(text)) {
            Some(spec) => Self::generated(spec)?,
            None => Self::file(argument.into()),
        };
        Ok(Self {
            name,
            weld,
            reader,
            ..model
        })
    }

    /// Identifies the model, except its name, weld and reader, to a child process.
    pub(crate) fn argument(&self) -> &OsStr {
        match &self.origin {
            ModelOrigin::File(path) => path.as_os_str(),
            ModelOrigin::Generated(_) | ModelOrigin::Memory(_) => OsStr::new(&self.path),
        }
    }

    /// The file behind it; none if it is generated.
    pub fn file_path(&self) -> Option<&Path> {
        match &self.origin {
            ModelOrigin::File(path) => Some(path),
            ModelOrigin::Generated(_) | ModelOrigin::Memory(_) => None,
        }
    }

    /// The generator's spec with all defaults written out; none if it is read from a file.
    pub fn spec(&self) -> Option<String> {
        match &self.origin {
            ModelOrigin::File(_) | ModelOrigin::Memory(_) => None,
            ModelOrigin::Generated(spec) => Some(spec.to_string()),
        }
    }

    /// The file that it is read from, or that its generator starts from.
    pub fn source_file(&self) -> Option<&Path> {
        match &self.origin {
            ModelOrigin::File(path) => Some(path),
            ModelOrigin::Generated(spec) => spec.path().map(Path::new),
            ModelOrigin::Memory(_) => None,
        }
    }

    /// An upper bound of its number of faces, by its spec or the size of its file; `None` if
    /// unknown.
    pub(crate) fn faces_at_most(&self) -> Option<f64> {
        /// Bytes of a face and half a vertex in a compact binary PLY.
        const BYTES: f64 = 19.0;
        /// Ratio by which gzip makes mesh files smaller.
        const COMPRESSED: f64 = 4.0;
        match &self.origin {
            ModelOrigin::Memory(mesh) => Some(mesh.face_count() as f64),
            ModelOrigin::Generated(spec) => spec.face_count().map(|faces| faces as f64),
            ModelOrigin::File(path) => {
                let size = fs::metadata(path).ok()?.len() as f64;
                let is_compressed = path
                    .extension()
                    .is_some_and(|e| e.eq_ignore_ascii_case("gz"));
                Some(size / BYTES * if is_compressed { COMPRESSED } else { 1.0 })
            }
        }
    }

    /// `text` on its file, with the name that the user wrote: standard input is kept as a temporary
    /// file.
    pub(crate) fn named_as_given(&self, text: &str) -> String {
        match self.file_path() {
            Some(path) if self.path == "-" => text.replace(&*path.to_string_lossy(), "-"),
            _ => text.to_owned(),
        }
    }

    /// SHA-256 of its [source file](Self::source_file); none if there is no such file or it cannot
    /// be read.
    pub fn file_sha256(&self) -> Option<String> {
        hash_file(self.source_file()?).ok()
    }

    /// Its record before it is loaded.
    pub fn record(&self) -> ModelRecord {
        ModelRecord {
            name: self.name.clone(),
            path: self.path.clone(),
            weld: self.weld.map(Weld::tolerance),
            ..ModelRecord::default()
        }
    }

    /// Reads or generates the triangles, unchecked, and welds their vertices.
    ///
    /// # Errors
    ///
    /// When the file or generator does not exist or is invalid.
    pub fn read(&self, options: impl Into<ReadOptions>) -> Result<TriangleSoup, ModelError> {
        let options = ReadOptions {
            obj_reader: self.reader,
            ..options.into()
        };
        let mut soup = match &self.origin {
            ModelOrigin::File(path) => {
                // Polygons are cut for the welded surface.
                let weld = self.weld.or(options.weld);
                return read_file(path, ReadOptions { weld, ..options })
                    .map_err(|problem| ModelError::Unreadable(self.named_as_given(&problem)));
            }
            ModelOrigin::Memory(mesh) => mesh.to_soup(),
            ModelOrigin::Generated(spec) => {
                let made = match spec.path() {
                    Some(path) => {
                        let read = read_file(Path::new(path), options);
                        spec.modifiers()
                            .apply(read.map_err(ModelError::Unreadable)?)
                    }
                    None => generate::generate(spec),
                };
                made.map_err(|error| ModelError::Unreadable(format!("{}: {error}", self.path)))?
            }
        };
        if let Some(weld) = self.weld {
            soup.weld(weld);
        }
        Ok(soup)
    }

    /// Reads or generates the model, checks it and builds its mesh. Files are read with `options`,
    /// such as a limit of what compressed ones decompress to.
    ///
    /// # Errors
    ///
    /// Names the file and the line or the elements that make it unusable.
    pub fn load(&self, options: impl Into<ReadOptions>) -> Result<LoadedModel, ModelError> {
        if let ModelOrigin::Memory(mesh) = &self.origin {
            let known_by_positions = mesh.positions().len() == mesh.vertex_count();
            let sha256 = known_by_positions.then(|| hash_soup(&mesh.to_soup()));
            return Ok(self.loaded(mesh.clone(), Report::default(), sha256));
        }
        let start = Instant::now();
        let soup = self.read(options)?;
        let load_seconds = start.elapsed().as_secs_f64();
        let sha256 = match &self.origin {
            ModelOrigin::File(path) => hash_file(path).ok(),
            ModelOrigin::Generated(_) | ModelOrigin::Memory(_) => Some(hash_soup(&soup)),
        };
        let sha256 = sha256.map(|hash| match self.weld {
            None => hash,
            Some(weld) => hexadecimal(Sha256::new_with_prefix(format!("{hash} weld={weld}"))),
        });
        let start = Instant::now();
        let (mesh, report) = self.build(soup)?;
        let build_seconds = start.elapsed().as_secs_f64();
        let mut loaded = self.loaded(mesh, report, sha256);
        loaded.record.load_seconds = Some(load_seconds);
        loaded.record.build_seconds = Some(build_seconds);
        Ok(loaded)
    }

    /// Its mesh, with its defects and repairs. As [`load`](Self::load), but nothing is hashed or
    /// measured.
    ///
    /// # Errors
    ///
    /// As [`load`](Self::load).
    pub fn mesh_within(
        &self,
        options: impl Into<ReadOptions>,
    ) -> Result<(Mesh, Report), ModelError> {
        if let ModelOrigin::Memory(mesh) = &self.origin {
            return Ok((mesh.clone(), Report::default()));
        }
        self.build(self.read(options)?)
    }

    fn build(&self, soup: TriangleSoup) -> Result<(Mesh, Report), ModelError> {
        Mesh::from_soup(soup).map_err(|error| ModelError::Invalid {
            path: self.path.clone(),
            error,
        })
    }

    /// The model with its measures and record.
    fn loaded(&self, mesh: Mesh, report: Report, sha256: Option<String>) -> LoadedModel {
        let measures = MeshMeasures::of(&mesh);
        let record = ModelRecord {
            sha256,
            vertices: Some(measures.vertices as u64),
            faces: Some(measures.faces as u64),
            edges: Some(measures.edges as u64),
            boundary_edges: Some(measures.boundary_edges as u64),
            junctions: Some(measures.junctions as u64).filter(|&count| count > 0),
            components: Some(measures.components as u64),
            genus: Some(measures.genus as u64),
            saddles: Some(measures.saddles as u64),
            anisotropy: Some(measures.anisotropy),
            longest_edge: Some(measures.max_edge_length),
            largest_component: (measures.components > 1)
                .then(|| largest_component(&mesh))
                .flatten(),
            notes: report.notes(),
            ..self.record()
        };
        LoadedModel {
            mesh,
            measures,
            report,
            record,
        }
    }
}

/// A component of a mesh that has faces.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceComponent {
    /// The first of its vertices.
    pub first: VertexId,
    /// How many they are.
    pub vertices: usize,
}

/// The components of `mesh` that have faces, by their numbers in `components`, which has that of
/// each vertex.
pub fn surface_components(mesh: &Mesh, components: &[u32]) -> BTreeMap<u32, SurfaceComponent> {
    let is_isolated = |v: VertexId| mesh.outgoing(v).is_empty() && !mesh.is_copy(v);
    let mut found: BTreeMap<u32, SurfaceComponent> = BTreeMap::new();
    for (v, &component) in mesh.vertices().zip(components) {
        if !is_isolated(v) {
            let component = found.entry(component).or_insert(SurfaceComponent {
                first: v,
                vertices: 0,
            });
            component.vertices += 1;
        }
    }
    found
}

/// The component with the most vertices, the first of several; `None` without faces.
pub fn largest_component(mesh: &Mesh) -> Option<LargestComponent> {
    let all = surface_components(mesh, &mesh.components());
    let by_size = |c: &&SurfaceComponent| (c.vertices, Reverse(c.first));
    all.values()
        .max_by_key(by_size)
        .map(|largest| LargestComponent {
            first: largest.first.raw(),
            vertices: largest.vertices as u64,
        })
}

/// Why the path is not that of a file that can be read as often as needed; `None` if it is, or does
/// not exist.
fn not_a_file(path: &Path) -> Option<String> {
    let kind = fs::metadata(path).ok()?.file_type();
    let problem = if kind.is_dir() {
        match fs::read_dir(path) {
            Err(error) => format!("the directory cannot be searched: {error}"),
            Ok(_) => "a directory, and no mesh file is in it".to_owned(),
        }
    } else if kind.is_file() {
        return None;
    } else {
        "not a regular file; `-` reads a model from standard input".to_owned()
    };
    Some(format!("{}: {problem}", path.display()))
}

fn read_file(path: &Path, options: ReadOptions) -> Result<TriangleSoup, String> {
    if let Some(problem) = not_a_file(path) {
        return Err(problem);
    }
    options.read(path).map_err(|error| {
        let problem = match &error {
            mesh_io::FileError::TooLarge {
                compressed, limit, ..
            } => format!(
                "{} decompress to more than {}",
                MemoryLimit(Some(*compressed)),
                MemoryLimit(Some(*limit))
            ),
            mesh_io::FileError::OverLimit { place, problem, .. } => format!("{place}{problem}"),
            error => return error.to_string(),
        };
        format!(
            "{}: {problem}; if the file can be trusted, raise the limit with --max-decompressed SIZE",
            path.display()
        )
    })
}

/// SHA-256 in hexadecimal of the bytes of a regular file and of those that it names, in their
/// order.
pub(crate) fn hash_file(path: &Path) -> io::Result<String> {
    let mut hash = Sha256::new();
    for path in iter::once(path.to_owned()).chain(files_beside(path)) {
        if !fs::metadata(&path)?.is_file() {
            return Err(io::ErrorKind::InvalidInput.into());
        }
        io::copy(&mut File::open(path)?, &mut HashWriter(&mut hash))?;
    }
    Ok(hexadecimal(hash))
}

/// SHA-256 of positions and triangles as little-endian numbers.
fn hash_soup(soup: &TriangleSoup) -> String {
    let mut hash = Sha256::new();
    for coordinate in soup.positions.as_flattened() {
        hash.update(coordinate.to_le_bytes());
    }
    for vertex in soup.triangles.as_flattened() {
        hash.update(vertex.to_le_bytes());
    }
    hexadecimal(hash)
}

fn hexadecimal(hash: Sha256) -> String {
    use std::fmt::Write;
    hash.finalize()
        .iter()
        .fold(String::new(), |mut text, byte| {
            let _ = write!(text, "{byte:02x}"); // Writing to a string cannot fail.
            text
        })
}

struct HashWriter<'h>(&'h mut Sha256);

impl io::Write for HashWriter<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exec::limits::DecompressionLimit;

    const FACE: &str = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

    fn names(arguments: &[String]) -> Vec<String> {
        let models = collect(arguments).unwrap();
        models.into_iter().map(|model| model.name).collect()
    }

    #[test]
    fn names_are_short_where_they_can_be_and_always_unique() {
        let root = tempfile::tempdir().unwrap();
        let path = |name: &str| root.path().join(name).display().to_string();
        for name in ["a.off", "b.off", "b.off.gz", "b.txt"] {
            fs::write(path(name), FACE).unwrap();
        }
        assert_eq!(
            names(&[path("a.off"), "gen:cube,n=2".into()]),
            ["a", "cube,n=2"]
        );
        assert_eq!(
            names(&[path("a.off"), path("a.off")]),
            [path("a.off"), format!("{} #2", path("a.off"))]
        );
        assert_eq!(
            names(&[path("")]),
            ["a".to_owned(), path("b.off"), path("b.off.gz")]
        );
    }

    #[test]
    fn unreadable_model_files_are_named() {
        let root = tempfile::tempdir().unwrap();
        let path = |name: &str| root.path().join(name);
        fs::write(path("a.off"), FACE).unwrap();
        std::os::unix::fs::symlink("/no/such.off", path("b.off")).unwrap();
        fs::create_dir(path("c.off")).unwrap();
        fs::create_dir(path("d.off")).unwrap();
        fs::write(path("d.off/e.off"), FACE).unwrap();
        rustix::fs::mkfifoat(rustix::fs::CWD, path("f.off"), 0o600.into()).unwrap();
        fs::write(path("g.off.xz"), FACE).unwrap();
        fs::write(path("h.zip"), FACE).unwrap();
        let models = collect(&[root.path().display().to_string()]).unwrap();
        let outcomes = models.iter().map(|model| {
            let loaded = model.load(DecompressionLimit::default());
            let problem = loaded.map_or_else(|error| error.to_string(), |_| String::new());
            (model.name.as_str(), problem)
        });
        let outcomes: Vec<_> = outcomes.collect();
        for ((name, problem), (wanted, text)) in outcomes.iter().zip([
            ("a", ""),
            ("b", "no such file"),
            ("c", "a directory, and no mesh file is in it"),
            ("e", ""),
            ("f", "not a regular file"),
            ("g.off", "it is compressed by xz"),
        ]) {
            assert_eq!(*name, wanted);
            assert!(problem.contains(text), "{name}: {problem}");
            assert_eq!(problem.is_empty(), text.is_empty(), "{name}: {problem}");
        }
        assert_eq!(models[4].file_sha256(), None);
    }

    #[test]
    fn a_file_is_hashed_as_it_lies_on_the_disk() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("abc");
        fs::write(&path, "abc").unwrap();
        // The example of FIPS 180-2.
        assert_eq!(
            hash_file(&path).unwrap(),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
    }

    #[test]
    fn a_generated_model_is_hashed_by_its_data() {
        let load = |spec: &str| {
            ModelRef::generated(spec)
                .unwrap()
                .load(DecompressionLimit::default())
                .unwrap()
                .record
        };
        let plain = load("gen:cube,n=2");
        assert_eq!(plain.path, "gen:cube,n=2,side=1");
        assert_eq!(plain.sha256, load("gen:cube,side=1,n=2").sha256);
        assert_ne!(plain.sha256, load("gen:cube,n=2,side=2").sha256);
        assert_eq!(
            (plain.vertices, plain.faces, plain.genus),
            (Some(26), Some(48), Some(0))
        );
    }
}
