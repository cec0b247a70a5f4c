//! The meshes in `shared/slivers`, on which solvers were wrong, with the right distances.
//!
//! They are beside the project, or at the path in the environment variable `GEOBENCH_SHARED`.

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
    /// By vertex; `None` if unreachable.
    pub(crate) distances: Vec<Option<f64>>,
}

/// The path of the file, whether it exists or not.
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
