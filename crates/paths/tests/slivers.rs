//! Paths on the meshes with slivers on which solvers have failed. The test does nothing if the file
//! of these meshes is missing.

mod judged;

use std::io::Read;
use std::path::PathBuf;

use flate2::read::GzDecoder;
use geobench_mesh::{Mesh, TriangleSoup};
use serde_json::Value;

use crate::judged::{check, report};

fn slivers() -> Option<Vec<Value>> {
    let shared = std::env::var_os("GEOBENCH_SHARED").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        PathBuf::from,
    );
    let file = std::fs::File::open(shared.join("slivers/slivers.json.gz")).ok()?;
    let mut text = String::new();
    GzDecoder::new(file).read_to_string(&mut text).unwrap();
    Some(serde_json::from_str(&text).unwrap())
}

#[test]
fn paths_beside_slivers_are_straight_and_as_long_as_the_distances() {
    let Some(cases) = slivers() else {
        return;
    };
    let mut failures = Vec::new();
    for case in &cases {
        let positions = serde_json::from_value(case["vertices"].clone()).unwrap();
        let faces = serde_json::from_value(case["faces"].clone()).unwrap();
        let sources: Vec<u32> = serde_json::from_value(case["source"].clone()).unwrap();
        let (mesh, _) = Mesh::from_soup(TriangleSoup::new(positions, faces)).unwrap();
        let name = case["name"].to_string();
        check(&name, &mesh, &sources, &mut failures);
    }
    report(&failures);
}
