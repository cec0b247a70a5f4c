//! Angles, fans and flags of small surfaces with known answers.

mod validate_support;

use std::f64::consts::PI;

use geobench_mesh::{Mesh, TriangleSoup, VertexId};
use validate_support::{abstract_soup, cube, fan, grid, mesh_of, tetrahedron};

fn vertex(v: u32) -> VertexId {
    VertexId::new(v)
}

fn heads(mesh: &Mesh, v: u32) -> Vec<u32> {
    mesh.outgoing(vertex(v))
        .iter()
        .map(|&h| mesh.head(h).raw())
        .collect()
}

#[test]
fn corners_of_a_cube_have_three_right_angles() {
    let (mesh, _) = mesh_of(cube());
    for v in mesh.vertices() {
        assert!((mesh.total_angle(v) - 1.5 * PI).abs() < 1e-15);
        assert!(!mesh.is_boundary(v) && !mesh.is_saddle(v) && !mesh.is_pinched(v));
        assert!(!mesh.is_pseudo_source(v));
    }
}

#[test]
fn a_plane_has_no_saddles() {
    let (mesh, _) = mesh_of(grid(4, 4));
    for v in mesh.vertices() {
        let [x, y, _] = mesh.positions()[v.index()];
        let inside = |x: f64| x > 0.0 && x < 4.0;
        let expected = match (inside(x), inside(y)) {
            (true, true) => 2.0 * PI,
            (false, false) => PI / 2.0,
            _ => PI,
        };
        assert!((mesh.total_angle(v) - expected).abs() < 2e-15);
        assert_eq!(mesh.is_boundary(v), expected < 6.0);
        assert!(!mesh.is_saddle(v));
    }
}

#[test]
fn a_plane_of_needles_has_no_saddles() {
    let mut soup = grid(30, 30);
    for position in &mut soup.positions {
        *position = [position[0] * 1e-6 + 0.7 * position[1], position[1], 0.0];
    }
    let (mesh, _) = mesh_of(soup);
    for v in mesh.vertices() {
        assert!(!mesh.is_saddle(v), "{v:?}: {}", mesh.total_angle(v));
    }
}

#[test]
fn seven_equilateral_triangles_make_a_saddle() {
    let triangles: Vec<[u32; 3]> = (0..7).map(|i| [0, 1 + i, 1 + (i + 1) % 7]).collect();
    let (mesh, _) = Mesh::from_lengths(8, &triangles, &[[1.0; 3]; 7]).unwrap();
    mesh.sanity_check().unwrap();
    assert!((mesh.total_angle(vertex(0)) - 7.0 * PI / 3.0).abs() < 1e-14);
    assert!(mesh.is_saddle(vertex(0)) && mesh.is_pseudo_source(vertex(0)));
    assert!((1..8).all(|v| mesh.is_boundary(vertex(v)) && !mesh.is_saddle(vertex(v))));
    // Six are flat, and one open fan of four bends a path along its boundary.
    let (flat, _) = Mesh::from_lengths(
        7,
        &(0..6)
            .map(|i| [0, 1 + i, 1 + (i + 1) % 6])
            .collect::<Vec<_>>(),
        &[[1.0; 3]; 6],
    )
    .unwrap();
    assert!(!flat.is_saddle(vertex(0)));
    for (count, saddle) in [(3, false), (4, true)] {
        let triangles: Vec<[u32; 3]> = (0..count).map(|i| [0, 1 + i, 2 + i]).collect();
        let lengths = vec![[1.0; 3]; triangles.len()];
        let (open, _) = Mesh::from_lengths(6, &triangles, &lengths).unwrap();
        assert!(open.is_boundary(vertex(0)));
        assert_eq!(open.is_saddle(vertex(0)), saddle);
    }
}

#[test]
fn half_edges_go_round_counter_clockwise() {
    let (closed, _) = mesh_of(fan(6, true, |_| 0.0));
    let mut ring = heads(&closed, 0);
    let smallest = ring.iter().position(|&v| v == 1).unwrap();
    ring.rotate_left(smallest);
    assert_eq!(ring, [1, 2, 3, 4, 5, 6]);
    // An open fan starts where its boundary leaves the vertex, whatever the order of its faces.
    let mut open = fan(5, false, f64::from);
    open.triangles.swap(0, 3);
    let (open, _) = mesh_of(open);
    assert_eq!(heads(&open, 0), [1, 2, 3, 4, 5]);
    assert!(open.twin(open.outgoing(vertex(0))[0]).is_none());
    let neighbours: Vec<u32> = open.neighbours(vertex(0)).map(|n| n.0.raw()).collect();
    assert_eq!(neighbours, [1, 2, 3, 4, 5, 6]);
}

#[test]
fn a_pinched_vertex_has_fan_after_fan() {
    let unit = [[1.0; 3]; 8];
    let triangles = [tetrahedron([0, 1, 2, 3]), tetrahedron([3, 4, 5, 6])].concat();
    let (mesh, _) = Mesh::from_lengths(7, &triangles, &unit).unwrap();
    mesh.sanity_check().unwrap();
    assert!((mesh.total_angle(vertex(3)) - 2.0 * PI).abs() < 1e-14);
    assert!(mesh.is_pinched(vertex(3)) && mesh.is_pseudo_source(vertex(3)));
    assert!(!mesh.is_saddle(vertex(3)), "no fan of it exceeds 2 pi");
    let sides: Vec<bool> = heads(&mesh, 3).iter().map(|&v| v > 3).collect();
    assert!(
        sides == [false, false, false, true, true, true]
            || sides == [true, true, true, false, false, false]
    );
}

#[test]
fn open_and_closed_fans_may_meet() {
    // A tetrahedron on a tip with two triangles, and one more triangle.
    let mut triangles = tetrahedron([0, 1, 2, 3]).to_vec();
    triangles.extend([[3, 4, 5], [3, 5, 6], [7, 8, 3]]);
    let (mesh, report) = mesh_of(abstract_soup(9, &triangles));
    assert_eq!(report.defects.len(), 1);
    assert!(mesh.is_pinched(vertex(3)) && mesh.is_boundary(vertex(3)));
    let mut neighbours: Vec<u32> = mesh.neighbours(vertex(3)).map(|n| n.0.raw()).collect();
    neighbours.sort_unstable();
    assert_eq!(neighbours, [0, 1, 2, 4, 5, 6, 7, 8]);
}

#[test]
fn a_flat_face_keeps_the_angles_of_its_neighbours() {
    // A square whose lower side carries a middle vertex, with a face of no area on that side.
    let positions = [[0., 0.], [1., 0.], [2., 0.], [2., 2.], [0., 2.]];
    let soup = TriangleSoup::new(
        positions.map(|[x, y]| [x, y, 0.0]).to_vec(),
        vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]],
    );
    let (mesh, _) = mesh_of(soup);
    for (v, expected) in [(0, 0.5), (1, 1.0), (2, 0.5), (3, 0.5), (4, 0.5)] {
        let angle = mesh.total_angle(vertex(v));
        assert!((angle - expected * PI).abs() < 1e-15, "{v}: {angle}");
    }
}

#[test]
fn powers_of_two_scale_a_mesh_bit_for_bit() {
    let soup = fan(7, true, |i| f64::from(i % 2) * 0.3);
    let (mesh, _) = mesh_of(soup.clone());
    for scale in [2f64.powi(-120), 0.5, 2f64.powi(120)] {
        let mut scaled = soup.clone();
        for x in scaled.positions.as_flattened_mut() {
            *x *= scale;
        }
        let (scaled, _) = mesh_of(scaled);
        for h in mesh.half_edges() {
            assert_eq!(scaled.length(h), mesh.length(h) * scale);
            assert_eq!(scaled.apex(h), mesh.apex(h).map(|x| x * scale));
        }
        for v in mesh.vertices() {
            assert_eq!(scaled.total_angle(v), mesh.total_angle(v));
        }
    }
}

#[test]
fn a_vertex_in_very_many_faces_is_no_trouble() {
    let (mesh, report) = mesh_of(fan(100_000, true, |_| -1.0));
    assert_eq!(report.defects, []);
    assert_eq!(mesh.outgoing(vertex(0)).len(), 100_000);
    let expected = 2.0 * PI / 2f64.sqrt();
    assert!((mesh.total_angle(vertex(0)) - expected).abs() < 1e-8);
}
