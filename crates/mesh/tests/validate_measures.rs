//! Counts and sizes of surfaces with known answers.

mod validate_support;

use geobench_mesh::{Mesh, MeshMeasures, TriangleSoup};
use validate_support::{abstract_soup, cube, grid, mesh_of, tetrahedron, torus};

fn measures(soup: TriangleSoup) -> MeshMeasures {
    MeshMeasures::of(&mesh_of(soup).0)
}

/// Genus, Euler characteristic, components, boundary loops, boundary edges.
fn topology(soup: TriangleSoup) -> (usize, i64, usize, usize, usize) {
    let m = measures(soup);
    (
        m.genus,
        m.euler_characteristic,
        m.components,
        m.boundary_loops,
        m.boundary_edges,
    )
}

#[test]
fn a_cube_is_a_sphere_of_known_size() {
    let m = measures(cube());
    assert_eq!((m.vertices, m.edges, m.faces), (8, 18, 12));
    assert_eq!((m.genus, m.euler_characteristic, m.components), (0, 2, 1));
    assert_eq!((m.boundary_edges, m.boundary_loops, m.saddles), (0, 0, 0));
    assert!((m.area - 6.0).abs() < 1e-14);
    assert_eq!((m.min_edge_length, m.max_edge_length), (1.0, 2f64.sqrt()));
    assert!((m.mean_edge_length - (12.0 + 6.0 * 2f64.sqrt()) / 18.0).abs() < 1e-15);
    assert_eq!(m.bounding_box, Some([[0.0; 3], [1.0; 3]]));
    // Half a unit square: P = 1 + 1/√2, H = √2, S = 1/2.
    let g = (1.0 + 0.5f64.sqrt()) * 2f64.sqrt() / 3f64.sqrt();
    assert!((m.anisotropy - g).abs() < 1e-14);
}

#[test]
fn handles_and_holes_are_counted() {
    assert_eq!(topology(torus(5, 6)), (1, 0, 1, 0, 0));
    assert_eq!(topology(grid(5, 4)), (0, 1, 1, 1, 18));
    // A grid with two holes, one a triangle and one a square.
    let mut holed = grid(5, 5);
    for t in [32, 17, 16] {
        holed.triangles.remove(t);
    }
    assert_eq!(topology(holed), (0, -1, 1, 3, 27));
    // A torus with a hole keeps its handle.
    let mut holed = torus(5, 6);
    holed.triangles.remove(9);
    assert_eq!(topology(holed), (1, -1, 1, 1, 3));
    // A torus and a sphere together.
    let mut both = torus(5, 6);
    both.triangles.extend(tetrahedron([30, 31, 32, 33]));
    both.positions.extend(validate_support::any_positions(4));
    assert_eq!(topology(both), (1, 2, 2, 0, 0));
}

#[test]
fn pinched_vertices_add_no_handles() {
    let two = [tetrahedron([0, 1, 2, 3]), tetrahedron([3, 4, 5, 6])].concat();
    assert_eq!(topology(abstract_soup(7, &two)), (0, 3, 1, 0, 0));
    assert_eq!(
        topology(abstract_soup(5, &[[0, 1, 2], [0, 3, 4]])),
        (0, 1, 1, 2, 6)
    );
    // Three tetrahedra in a ring, each on the tips of its neighbours, enclose no handle.
    let ring = [
        tetrahedron([0, 3, 4, 1]),
        tetrahedron([1, 5, 6, 2]),
        tetrahedron([2, 7, 8, 0]),
    ]
    .concat();
    assert_eq!(topology(abstract_soup(9, &ring)), (0, 3, 1, 0, 0));
}

#[test]
fn isolated_vertices_are_no_components() {
    let m = measures(abstract_soup(9, &[[0, 1, 2], [3, 4, 5]]));
    assert_eq!((m.components, m.isolated_vertices, m.vertices), (2, 3, 9));
    assert_eq!(m.euler_characteristic, 2);
}

#[test]
fn equilateral_faces_have_anisotropy_one_and_flat_faces_none() {
    let triangles = tetrahedron([0, 1, 2, 3]);
    let (mesh, _) = Mesh::from_lengths(4, &triangles, &[[0.3; 3]; 4]).unwrap();
    let m = MeshMeasures::of(&mesh);
    assert!((m.anisotropy - 1.0).abs() < 1e-14);
    assert_eq!(m.bounding_box, None);
    let (flat, _) = Mesh::from_lengths(3, &[[0, 1, 2]], &[[1.0, 1.0, 2.0]]).unwrap();
    let m = MeshMeasures::of(&flat);
    assert_eq!((m.flat_faces, m.anisotropy), (1, 1.0));
}
