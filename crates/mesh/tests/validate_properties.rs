//! What must hold for every soup, however it was made.

mod validate_support;

use geobench_mesh::{Defect, Mesh, MeshMeasures, Severity, TriangleSoup, VertexId};
use proptest::prelude::*;
use validate_support::{cube, grid, torus};

/// Coordinates that often coincide, line up, vanish, overflow or are not numbers.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => (-2i32..3).prop_map(f64::from),
        4 => -1.0..1.0f64,
        1 => prop::num::f64::ANY,
    ]
}

/// Up to ten vertices with a few triangles of any kind.
fn any_soup() -> impl Strategy<Value = TriangleSoup> {
    let positions = prop::collection::vec(prop::array::uniform3(coordinate()), 0..10);
    let corner = prop_oneof![40 => 0..10u32, 1 => any::<u32>()];
    let triangles = prop::collection::vec(prop::array::uniform3(corner), 0..12);
    (positions, triangles)
        .prop_map(|(positions, triangles)| TriangleSoup::new(positions, triangles))
}

/// As [`any_soup`], but with sound positions and vertices, so that most are surfaces.
fn sound_soup() -> impl Strategy<Value = TriangleSoup> {
    let face = (0..9u32, 0..9u32, 0..9u32)
        .prop_filter("corners differ", |&(a, b, c)| a != b && b != c && c != a)
        .prop_map(|(a, b, c)| [a, b, c]);
    prop::collection::vec(face, 1..7)
        .prop_map(|triangles| TriangleSoup::new(validate_support::any_positions(9), triangles))
}

fn surface() -> impl Strategy<Value = TriangleSoup> {
    prop_oneof![
        Just(cube()),
        (3..6u32, 3..6u32).prop_map(|(a, b)| torus(a, b)),
        (1..5u32, 1..5u32).prop_map(|(a, b)| grid(a, b)),
    ]
}

/// All shapes of the corners of a mesh, in an order that does not depend on numbering.
fn sorted_lengths(mesh: &Mesh) -> Vec<f64> {
    let mut lengths: Vec<f64> = mesh.half_edges().map(|h| mesh.length(h)).collect();
    lengths.sort_by(f64::total_cmp);
    lengths
}

proptest! {
    #[test]
    fn every_soup_is_built_soundly_or_refused_with_a_reason(
        soup in prop_oneof![any_soup(), sound_soup()]
    ) {
        match Mesh::from_soup(soup.clone()) {
            Ok((mesh, report)) => {
                prop_assert_eq!(mesh.sanity_check(), Ok(()));
                prop_assert!(!report.is_fatal());
                prop_assert_eq!(mesh.vertex_count(), soup.positions.len());
                for face in mesh.faces() {
                    let of_file = soup.triangles[mesh.file_triangle(face) as usize];
                    let mut expected = of_file.map(|v| mesh.kept_vertex(VertexId::new(v)));
                    let mut found = mesh.face_vertices(face);
                    found.sort_unstable();
                    expected.sort_unstable();
                    prop_assert_eq!(found, expected);
                }
                let measures = MeshMeasures::of(&mesh);
                prop_assert!(measures.anisotropy >= 1.0 - 1e-12);
                let pinched = report.defects.iter().filter_map(|defect| match defect {
                    Defect::PinchedVertex { vertex, .. } => Some(*vertex),
                    _ => None,
                });
                let flagged = mesh.vertices().filter(|&v| mesh.is_pinched(v)).map(VertexId::raw);
                prop_assert!(mesh.has_junctions() || pinched.eq(flagged));
                // What was repaired needs no repair a second time.
                let repaired = mesh.faces().map(|f| mesh.face_vertices(f).map(VertexId::raw));
                let again = TriangleSoup::new(soup.positions, repaired.collect());
                let (_, again) = Mesh::from_soup(again).unwrap();
                prop_assert_eq!(again.with_severity(Severity::Repaired).count(), 0);
            }
            Err(error) => {
                prop_assert!(error.report.is_fatal());
                prop_assert_eq!(error.to_string().lines().count(), 1);
            }
        }
    }

    #[test]
    fn lengths_of_any_kind_never_panic(
        triangles in prop::collection::vec(prop::array::uniform3(0..6u32), 0..6),
        lengths in prop::collection::vec(prop::array::uniform3(coordinate()), 0..6),
    ) {
        if let Ok((mesh, _)) = Mesh::from_lengths(6, &triangles, &lengths) {
            prop_assert_eq!(mesh.sanity_check(), Ok(()));
        }
    }

    #[test]
    fn faces_wound_at_random_are_turned_back(
        soup in surface(),
        coins in prop::collection::vec(any::<bool>(), 50),
    ) {
        let (clean, _) = Mesh::from_soup(soup.clone()).unwrap();
        let mut mixed = soup.clone();
        let mut turned = 0;
        for (t, &coin) in mixed.triangles.iter_mut().zip(&coins) {
            if coin {
                t.swap(1, 2);
                turned += 1;
            }
        }
        let (mesh, report) = Mesh::from_soup(mixed).unwrap();
        prop_assert_eq!(mesh.sanity_check(), Ok(()));
        let repairs = report.with_severity(Severity::Repaired).count();
        prop_assert_eq!(repairs, turned.min(soup.triangles.len() - turned));
        prop_assert_eq!(sorted_lengths(&mesh), sorted_lengths(&clean));
        for v in clean.vertices() {
            prop_assert_eq!(mesh.outgoing(v).len(), clean.outgoing(v).len());
            prop_assert!((mesh.total_angle(v) - clean.total_angle(v)).abs() < 1e-13);
            prop_assert_eq!(mesh.is_saddle(v), clean.is_saddle(v));
            prop_assert_eq!(mesh.is_boundary(v), clean.is_boundary(v));
        }
    }

    #[test]
    fn renumbering_changes_nothing_but_numbers(
        (soup, vertex_order, face_order) in surface().prop_flat_map(|soup| {
            let vertices: Vec<u32> = (0..soup.positions.len() as u32).collect();
            let faces: Vec<usize> = (0..soup.triangles.len()).collect();
            (Just(soup), Just(vertices).prop_shuffle(), Just(faces).prop_shuffle())
        }),
        turns in prop::collection::vec(0..3usize, 100),
    ) {
        let (mesh, _) = Mesh::from_soup(soup.clone()).unwrap();
        let mut positions = soup.positions.clone();
        for (old, &new) in vertex_order.iter().enumerate() {
            positions[new as usize] = soup.positions[old];
        }
        let triangles = face_order.iter().zip(turns.iter().cycle()).map(|(&face, &turn)| {
            let mut t = soup.triangles[face].map(|v| vertex_order[v as usize]);
            t.rotate_left(turn);
            t
        });
        let shuffled = TriangleSoup::new(positions, triangles.collect());
        let (other, report) = Mesh::from_soup(shuffled).unwrap();
        prop_assert_eq!(other.sanity_check(), Ok(()));
        prop_assert_eq!(report.defects, vec![]);
        prop_assert_eq!(sorted_lengths(&other), sorted_lengths(&mesh));
        for v in mesh.vertices() {
            let w = VertexId::new(vertex_order[v.index()]);
            prop_assert_eq!(other.outgoing(w).len(), mesh.outgoing(v).len());
            prop_assert!((other.total_angle(w) - mesh.total_angle(v)).abs() < 1e-13);
            prop_assert_eq!(other.is_saddle(w), mesh.is_saddle(v));
            prop_assert_eq!(other.is_boundary(w), mesh.is_boundary(v));
        }
    }
}
