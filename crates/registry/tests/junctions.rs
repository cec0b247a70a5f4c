//! Which algorithms solve meshes with junctions.

use geobench_mesh::{Mesh, VertexId};
use geobench_registry::{algorithms, certificate, select_one, usual};
use geobench_window::SolveError;

/// Three triangles on one edge, and a strip of five triangles with its ends joined after half a
/// turn.
fn meshes() -> [Mesh; 2] {
    let book = vec![
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    let strip = (0..5).map(f64::from).map(|x| [x, x * x, x * x * x]);
    let of_strip = vec![[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]];
    [
        Mesh::new(book, vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]]).unwrap(),
        Mesh::new(strip.collect(), of_strip).unwrap(),
    ]
}

/// The memory of an edge grows with the number of its faces. For every pair of these faces it would
/// take gigabytes.
#[test]
fn an_edge_may_have_many_faces() {
    const SHEETS: u32 = 20_000;
    let apex = |i: u32| [0.5, f64::from(i).cos(), f64::from(i).sin()];
    let mut positions = vec![[0.0; 3], [1.0, 0.0, 0.0]];
    positions.extend((0..SHEETS).map(apex));
    // Every second sheet is wound the other way.
    let sheet = |i: u32| {
        if i.is_multiple_of(2) {
            [0, 1, i + 2]
        } else {
            [1, 0, i + 2]
        }
    };
    let mesh = Mesh::new(positions, (0..SHEETS).map(sheet).collect()).unwrap();
    let found = usual(&mesh).build(&mesh).solve(&[VertexId::new(2)]);
    let distances = found.unwrap().distances;
    assert!(distances[3..].iter().all(|d| (d - 2.0).abs() < 1e-12));
    assert!((distances[0] - 1.25_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn algorithms_solve_meshes_with_junctions_or_refuse_them() {
    for mesh in meshes() {
        let refusal = SolveError::at_junctions(&mesh);
        let of_diagrams = SolveError::diagram_at_junctions(&mesh);
        assert!(refusal.is_some() && of_diagrams.is_some());
        let source = [VertexId::new(2)];
        let expected = usual(&mesh).build(&mesh).solve(&source).unwrap().distances;
        for algorithm in algorithms() {
            let selection = select_one(algorithm.name).unwrap();
            let found = selection.build(&mesh).solve(&source);
            match found {
                Ok(found) => {
                    assert!(selection.crosses_junctions(), "{}", algorithm.name);
                    let is_right = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-12 * b || a == b;
                    let mut pairs = found.distances.iter().zip(&expected);
                    assert!(
                        !algorithm.exact || pairs.all(is_right),
                        "{}",
                        algorithm.name
                    );
                }
                Err(error) => {
                    assert!(!selection.crosses_junctions(), "{}", algorithm.name);
                    let error = Some(error);
                    let is_named = error == refusal || error == of_diagrams;
                    assert!(is_named, "{}: {error:?}", algorithm.name);
                }
            }
            if let Some(mut field) = selection.field_solver(&mesh) {
                assert_eq!(
                    field.field(&source).err(),
                    of_diagrams,
                    "{}",
                    algorithm.name
                );
            }
        }
        let certified = certificate(1e-9).build(&mesh).solve(&source).unwrap();
        assert_eq!(certified.distances.len(), expected.len());
    }
}
