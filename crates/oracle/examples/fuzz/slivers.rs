//! The meshes in `shared/slivers`, on which solvers were wrong, with the right distances.
//!
//! They lie beside the project, or where the environment variable `GEOBENCH_SHARED` says.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::{env, io};

use flate2::read::GzDecoder;
use serde::Deserialize;

/// One mesh of the file.
#[derive(Deserialize)]
pub(crate) struct Sliver {
    pub(crate) name: String,
    pub(crate) vertices: Vec<[f64; 3]>,
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) source: Vec<u32>,
    /// Of each vertex; `None` is unreachable.
    pub(crate) distances: Vec<Option<f64>>,
}

/// Where the file is, or would be.
pub(crate) fn path() -> PathBuf {
    let shared = env::var_os("GEOBENCH_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        PathBuf::from,
    );
    shared.join("slivers/slivers.json.gz")
}

/// All meshes of the file.
pub(crate) fn read() -> io::Result<Vec<Sliver>> {
    let file = GzDecoder::new(File::open(path())?);
    Ok(serde_json::from_reader(io::BufReader::new(file))?)
}
