//! Paths on the meshes with slivers on which solvers have failed. The test does nothing if the file
//! of these meshes is missing.

mod straight;

use std::io::Read;
use std::path::PathBuf;

use flate2::read::GzDecoder;
use geobench_ich::ich;
use geobench_mesh::{Mesh, TriangleSoup};
use geobench_mmp::mmp;
use geobench_paths::Paths;
use geobench_vtp::{Vtp, VtpFast};
use geobench_window::{Goal, Solver};
use serde_json::Value;

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
        let solvers: [(&str, Box<dyn Solver>); 4] = [
            ("mmp", Box::new(mmp(&mesh))),
            ("ich", Box::new(ich(&mesh))),
            ("vtp", Box::new(Vtp::new(&mesh))),
            ("vtp-fast", Box::new(VtpFast::new(&mesh))),
        ];
        for (algorithm, mut solver) in solvers {
            let paths = Paths::find(solver.as_mut(), &mesh, &sources, &Goal::everything()).unwrap();
            for v in mesh.vertices() {
                let d = paths.distances()[v.index()];
                let wrong = match paths.to(v) {
                    Ok(Some(path)) => straight::check_path(&mesh, &path, &sources, v, d).err(),
                    Ok(None) => (d < f64::INFINITY).then(|| "no path".to_owned()),
                    Err(lost) => Some(lost.to_string()),
                };
                if let Some(wrong) = wrong {
                    let name = &case["name"];
                    failures.push(format!("{name}, {algorithm}, to {v}: {wrong}"));
                }
            }
        }
    }
    let first = failures.iter().take(60);
    let lines: Vec<&str> = first.map(String::as_str).collect();
    assert!(
        failures.is_empty(),
        "{} failures:\n  {}",
        failures.len(),
        lines.join("\n  ")
    );
}
