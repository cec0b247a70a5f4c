//! Times of checking and building. Those of large meshes are printed by
//! `cargo test --release -p geobench-mesh --test validate_speed -- --ignored --nocapture`.

mod processor_time;
mod validate_support;

use std::f64::consts::TAU;
use std::iter;
use std::time::{Duration, Instant};

use geobench_mesh::{Mesh, MeshMeasures, TriangleSoup};
use processor_time::ProcessorTime;
use validate_support::{fan, grid, mesh_of};

fn report_time(name: &str, soup: TriangleSoup) {
    let faces = soup.triangles.len();
    let start = Instant::now();
    let (mesh, _) = Mesh::from_soup(soup).expect("the soup is usable");
    let built = start.elapsed();
    let start = Instant::now();
    let measures = MeshMeasures::of(&mesh);
    let measured = start.elapsed();
    assert_eq!(measures.faces, faces);
    println!("{name}: {faces} faces built in {built:.3?}, measured in {measured:.3?}");
}

#[test]
#[ignore = "prints times, checks nothing that other tests do not"]
fn half_a_million_faces() {
    report_time("grid", grid(500, 500));
    let mut shuffled = grid(500, 500);
    // Steps by a number without common factors: neighbours in the list are far apart.
    let count = shuffled.triangles.len();
    shuffled.triangles = (0..count)
        .map(|i| shuffled.triangles[i * 314_159 % count])
        .collect();
    for t in shuffled.triangles.iter_mut().step_by(3) {
        t.swap(0, 1);
    }
    report_time("grid in disorder", shuffled);
    report_time("cone", fan(500_000, true, |_| 1.0));
    mesh_of(grid(500, 500));
}

#[test]
fn a_vertex_of_very_many_faces_is_quick_enough() {
    let count = 20_000;
    let place = |i: u32| {
        let angle = f64::from(i) / f64::from(count) * TAU;
        [angle.cos(), angle.sin(), 1e-4]
    };
    let positions = iter::once([0.0; 3]).chain((0..count).map(place)).collect();
    let triangles = (0..count)
        .map(|i| [0, 1 + i, 1 + (i + 1) % count])
        .collect();
    let start = ProcessorTime::now();
    assert!(Mesh::new(positions, triangles).is_ok());
    assert!(start.elapsed() < Duration::from_secs(5));
}
