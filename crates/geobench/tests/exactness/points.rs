//! Meshes refined at points on their surface: compares every algorithm with the oracle.

use std::io::{self, Write};

use geobench_mesh::{FaceId, Mesh, SplitMix64, SurfacePoint, VertexId};
use geobench_oracle::{DoubleDouble, Geometry, Model, distances, rounded, zoo};

use crate::support::{AGREEMENT, Failures, Run, caught, exact_runs, mesh_of};

#[path = "../../../oracle/examples/fuzz/slivers.rs"]
mod slivers;

/// The tolerance for rounding near points that are 1e-6 of an edge away from a corner. The needles
/// there are wider than the slivers of the study and as hard for a solver.
const NEAR_CORNERS: f64 = 1e-11;

/// A number from 0 to 1.
fn number(random: &mut SplitMix64) -> f64 {
    (random.next() >> 11) as f64 / (1_u64 << 53) as f64
}

/// Points in faces, on edges and close to a corner, several in one face.
fn points_of(mesh: &Mesh, random: &mut SplitMix64) -> Vec<SurfacePoint> {
    let mut points = Vec::new();
    for _ in 0..2 {
        let face = FaceId::new(random.below(mesh.face_count()) as u32);
        let corners = mesh.face_vertices(face);
        let k = random.below(3);
        let ends = [corners[k], corners[(k + 1) % 3]];
        points.push(mesh.point_on_edge(ends, number(random)).unwrap());
        for near in [1.0, 1.0, 1e-6] {
            let (u, v) = (near * number(random) / 2.0, near * number(random) / 2.0);
            let mut weights = [u, v, 1.0 - u - v];
            weights.rotate_left(k);
            points.push(mesh.point_in_face(face, weights).unwrap());
        }
    }
    points
}

/// The refined mesh as input of the oracle: only positions or lengths.
fn model_of(name: &str, mesh: &Mesh) -> Model {
    let faces = || mesh.faces();
    let triangles = faces()
        .map(|f| mesh.face_vertices(f).map(VertexId::raw))
        .collect();
    if mesh.positions().is_empty() {
        let lengths = |f: FaceId| mesh.side_lengths(f);
        let lengths = faces().map(lengths).collect();
        return Model::from_lengths(name, mesh.vertex_count(), triangles, lengths);
    }
    Model::new(name, mesh.positions().to_vec(), triangles)
}

#[test]
fn refined_models_match_the_oracle() {
    let mut failures = Failures::default();
    for (seed, model) in (0..).zip(zoo::small()) {
        let mesh = mesh_of(&model);
        let mut random = SplitMix64::new(seed);
        let points = points_of(&mesh, &mut random);
        let refined = mesh.with_points(&points).unwrap();
        refined.mesh.sanity_check().unwrap();
        let original = model.surface::<f64>();
        // In f64, the oracle itself has errors of 1e-11 near points close to corners.
        let fine = model_of(&model.name, &refined.mesh).surface::<DoubleDouble>();
        let [first, .., last] = refined.vertices[..] else {
            panic!("there are several points");
        };
        let old = model.sources[0];
        let of_original = rounded(&distances(&original, &[old]));
        let sources = [
            vec![old],
            vec![first.raw()],
            vec![last.raw()],
            vec![first.raw(), last.raw(), old],
        ];
        let expected: Vec<Vec<f64>> = sources
            .iter()
            .map(|sources| rounded(&distances(&fine, sources)))
            .collect();
        // Positions of added vertices are rounded. Meshes of lengths only lose more accuracy.
        let tolerance = match model.geometry {
            Geometry::Positions(_) => NEAR_CORNERS,
            Geometry::Lengths(_) => AGREEMENT,
        };
        for mut run in exact_runs(&model.name, &refined.mesh) {
            for (sources, expected) in sources.iter().zip(&expected) {
                let Some(found) = caught(&mut failures, || run.distances(sources)) else {
                    continue;
                };
                let at = || format!("refined {}", run.at(sources));
                failures.compare_all(at, &found, expected, tolerance);
                if sources == &[old] {
                    let known = of_original.iter().copied().enumerate();
                    failures.compare(at, &found, known, NEAR_CORNERS);
                }
            }
        }
    }
    failures.report();
}

#[test]
fn refined_slivers_have_the_distances_of_slivers() {
    let Ok(slivers) = slivers::read() else {
        // Bypasses the capture of test output, which would hide it.
        let shown = slivers::path();
        let _ = writeln!(io::stderr(), "SKIPPED: {} is missing", shown.display());
        return;
    };
    let mut failures = Failures::default();
    for (seed, sliver) in (0..).zip(slivers) {
        let mesh = Mesh::new(sliver.vertices, sliver.faces).unwrap();
        let points = points_of(&mesh, &mut SplitMix64::new(seed));
        let refined = mesh.with_points(&points).unwrap();
        // No `sanity_check` here: its tolerance is relative to the length of each edge. In thin
        // faces, coordinates are rounded relative to the whole face, which exceeds that tolerance.
        let expected = sliver.distances.iter().map(|d| d.unwrap_or(f64::INFINITY));
        let expected: Vec<f64> = expected.collect();
        for selection in geobench_registry::select("vtp-fast,vtp,mmp,ich,fwp-ch").unwrap() {
            let mut run = Run::new(selection, &sliver.name, &refined.mesh);
            let Some(found) = caught(&mut failures, || run.distances(&sliver.source)) else {
                continue;
            };
            let at = || format!("refined {}", run.at(&sliver.source));
            failures.compare(at, &found, expected.iter().copied().enumerate(), AGREEMENT);
        }
    }
    failures.report();
}
