//! Every kind of defect, alone and together with others.

mod validate_support;

use geobench_mesh::{
    Defect, DefectKind, HalfEdgeId, InvalidMesh, Mesh, MeshMeasures, Report, Severity,
    TriangleSoup, VertexId,
};
use validate_support::{abstract_soup, cube, fan, grid, mesh_of, tetrahedron, torus};

#[track_caller]
fn refused(soup: TriangleSoup) -> InvalidMesh {
    let error = Mesh::from_soup(soup).expect_err("the soup must be refused");
    assert!(error.report.is_fatal());
    assert_eq!(error.to_string().lines().count(), 1, "{error}");
    error
}

fn kinds(report: &Report) -> Vec<DefectKind> {
    report.defects.iter().map(Defect::kind).collect()
}

#[test]
fn clean_models_have_nothing_to_report() {
    for soup in [grid(4, 3), cube(), torus(5, 7), fan(6, true, |_| 1.0)] {
        let triangles = soup.triangles.clone();
        let (mesh, report) = mesh_of(soup);
        assert_eq!(report, Report::default());
        let same = mesh.faces().zip(&triangles);
        for (face, expected) in same {
            assert_eq!(mesh.face_vertices(face).map(VertexId::raw), *expected);
        }
    }
}

#[test]
fn without_vertices_or_faces_there_is_no_surface() {
    let nothing = refused(TriangleSoup::default());
    assert_eq!(
        nothing.report.defects,
        [Defect::NoVertices, Defect::NoFaces]
    );
    let points = refused(abstract_soup(3, &[]));
    assert_eq!(points.report.defects, [Defect::NoFaces]);
    assert_eq!(
        points.to_string(),
        "the mesh cannot be used: it has no faces; distances need a surface: triangulate the \
         points first"
    );
    let vertex_count = 0;
    assert_eq!(
        refused(abstract_soup(0, &[[0, 1, 2]])).report.defects[0..2],
        [
            Defect::NoVertices,
            Defect::IndexOutOfRange {
                face: 0,
                vertex: 0,
                vertex_count
            },
        ]
    );
}

#[test]
fn vertices_that_do_not_exist_are_named_with_their_face() {
    let error = refused(abstract_soup(4, &[[0, 1, 2], [1, 4, u32::MAX], [2, 1, 3]]));
    let missing = |vertex| Defect::IndexOutOfRange {
        face: 1,
        vertex,
        vertex_count: 4,
    };
    assert_eq!(error.report.defects, [missing(4), missing(u32::MAX)]);
    assert!(
        error.to_string().contains("face 1 names vertex 4 of 4"),
        "{error}"
    );
}

#[test]
fn coordinates_that_are_not_finite_are_named() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut soup = grid(2, 2);
        soup.positions[4][1] = bad;
        let defects = refused(soup).report.defects;
        assert_eq!(defects, [Defect::NonFiniteCoordinate { vertex: 4 }]);
    }
}

#[test]
fn a_face_with_a_vertex_twice_is_left_out_and_named() {
    for face in [[1, 1, 2], [2, 1, 1], [1, 2, 1], [1, 1, 1]] {
        let (mesh, report) = mesh_of(abstract_soup(3, &[[0, 1, 2], face]));
        let expected = Defect::CollapsedFace { face: 1, vertex: 1 };
        assert_eq!(report.defects, [expected]);
        assert_eq!(mesh.face_count(), 1);
    }
    let error = refused(abstract_soup(3, &[[0, 1, 1]]));
    assert_eq!(kinds(&error.report)[0], DefectKind::NoFaces);
    let refused = Mesh::from_lengths(3, &[[0, 1, 1], [0, 1, 2]], &[[1.0; 3]; 2]).unwrap_err();
    assert_eq!(kinds(&refused.report), [DefectKind::RepeatedVertex]);
}

#[test]
fn the_ends_of_an_edge_of_no_length_are_one_vertex() {
    let mut soup = grid(2, 1);
    soup.positions[4] = soup.positions[0];
    soup.positions[4][2] = -0.0;
    let (mesh, report) = mesh_of(soup);
    let edge = Defect::ZeroLengthEdge {
        vertices: [0, 4],
        faces: vec![0, 1],
    };
    let collapsed = [0, 1].map(|face| Defect::CollapsedFace { face, vertex: 0 });
    assert_eq!(report.defects[..2], collapsed);
    assert_eq!(report.defects[2], edge);
    assert_eq!(mesh.copies().collect::<Vec<_>>(), [[4.into(), 0.into()]]);
    assert_eq!(mesh.face_count(), 2);
    assert_eq!(mesh.file_triangle(0.into()), 2);
}

#[test]
fn sizes_that_overflow_or_vanish_are_refused() {
    for scale in [1e200, 1e61, 1e-61, 1e-200, f64::MIN_POSITIVE] {
        let mut soup = abstract_soup(3, &[[0, 1, 2]]);
        for position in soup.positions.as_flattened_mut() {
            *position *= scale;
        }
        let report = refused(soup).report;
        assert_eq!(kinds(&report), [DefectKind::LengthOutOfRange; 3], "{scale}");
    }
    // The report names the size even where its square overflows.
    let far = TriangleSoup::new(
        vec![[0.0; 3], [3e200, 4e200, 0.0], [1.0; 3]],
        vec![[0, 1, 2]],
    );
    let error = refused(far);
    assert!(
        error.to_string().contains("vertices 0 and 1: 5.000e200"),
        "{error}"
    );
    for scale in [1e58, 1e-58] {
        let mut soup = grid(3, 3);
        for position in soup.positions.as_flattened_mut() {
            *position *= scale;
        }
        let (_, report) = mesh_of(soup);
        assert_eq!(report, Report::default(), "{scale}");
    }
}

#[test]
fn an_edge_of_three_faces_names_them_all() {
    let (mesh, report) = mesh_of(abstract_soup(5, &[[0, 1, 2], [1, 0, 3], [4, 0, 1]]));
    assert_eq!(
        report.defects,
        [Defect::NonManifoldEdge {
            vertices: [0, 1],
            faces: vec![0, 1, 2],
        }]
    );
    let [summary] = &report.summaries()[..] else {
        panic!("{report:?}");
    };
    assert_eq!(
        summary.text,
        "1 edge has more than two faces (vertices 0 and 1 in faces 0, 1, 2)"
    );
    let along = [0, 3, 7].map(HalfEdgeId::new);
    for h in mesh.half_edges() {
        let expected: &[HalfEdgeId] = if along.contains(&h) { &along } else { &[] };
        assert_eq!((mesh.junction(h), mesh.twin(h)), (expected, None));
        assert_eq!(mesh.is_boundary_edge(h), expected.is_empty());
    }
    let ends = mesh.vertices().filter(|&v| mesh.is_pseudo_source(v));
    assert_eq!(ends.collect::<Vec<_>>(), [0, 1].map(VertexId::new));
    let measures = MeshMeasures::of(&mesh);
    assert_eq!((measures.edges, measures.boundary_edges), (7, 6));
    assert_eq!((measures.junctions, measures.genus), (1, 0));
    assert_eq!(measures.euler_characteristic, 1);
}

/// Cubes on two opposite corners of a square, which share an edge.
#[test]
fn cubes_that_touch_along_an_edge_are_two_pieces() {
    let mut soup = cube();
    let second = soup
        .positions
        .iter()
        .map(|[x, y, z]| [x + 1.0, y + 1.0, *z]);
    let second: Vec<[f64; 3]> = second.collect();
    let number = |v: u32| match v {
        0 => 3,
        4 => 7,
        v => v + 8,
    };
    let faces = soup.triangles.clone();
    soup.triangles
        .extend(faces.iter().map(|face| face.map(number)));
    soup.positions.extend(second);
    let (mesh, report) = mesh_of(soup);
    let found = kinds(&report);
    assert_eq!(
        found,
        [
            DefectKind::NonManifoldEdge,
            DefectKind::IsolatedVertex,
            DefectKind::IsolatedVertex
        ]
    );
    let sides: Vec<HalfEdgeId> = mesh.junction_sides().collect();
    assert_eq!(sides.len(), 4);
    assert!(sides.iter().all(|&h| mesh.junction(h) == sides));
    // Half of them in either direction, as each cube is oriented.
    let up = sides
        .iter()
        .filter(|&&h| mesh.tail(h) == mesh.tail(sides[0]));
    assert_eq!(up.count(), 2);
    let measures = MeshMeasures::of(&mesh);
    assert_eq!((measures.boundary_edges, measures.boundary_loops), (0, 0));
    assert_eq!((measures.edges, measures.genus), (35, 0));
}

#[test]
fn a_face_that_repeats_another_in_a_surface_is_left_out() {
    let mut soup = cube();
    let [a, b, c] = soup.triangles[5];
    for copy in [[b, c, a], [b, a, c]] {
        soup.triangles.insert(7, copy);
    }
    let (mesh, report) = mesh_of(soup);
    let copies = [7, 8].map(|face| Defect::RepeatedFace { face, first: 5 });
    assert_eq!(report.defects, copies);
    assert_eq!(mesh.face_count(), 12);
    let file: Vec<u32> = mesh.faces().map(|f| mesh.file_triangle(f)).collect();
    assert_eq!(file, [0, 1, 2, 3, 4, 5, 6, 9, 10, 11, 12, 13]);
    // A point of a copy is the point of the face that stands for it.
    let weights = [0.2, 0.3, 0.5];
    let point = mesh.point_in_file_triangle(5, weights).unwrap();
    let [u, v, w] = weights;
    assert_eq!(mesh.point_in_file_triangle(7, [v, u, w]), Ok(point));
    assert_eq!(mesh.point_in_file_triangle(8, [v, w, u]), Ok(point));
    assert!(mesh.point_in_file_triangle(14, weights).is_err());
}

#[test]
fn two_faces_on_the_same_vertices_make_a_pillow() {
    // Wound against each other they are a closed surface; wound alike, one is turned over.
    for (second, flipped) in [([0, 2, 1], false), ([1, 2, 0], true)] {
        let (mesh, report) = mesh_of(abstract_soup(3, &[[0, 1, 2], second]));
        assert!(mesh.half_edges().all(|h| mesh.twin(h).is_some()));
        let mut expected = vec![DefectKind::DuplicateFace];
        if flipped {
            expected.insert(0, DefectKind::FlippedFace);
        }
        assert_eq!(kinds(&report), expected);
    }
}

#[test]
fn the_minority_is_turned_over() {
    let clean = torus(4, 5);
    for wrong in [vec![7], vec![0, 1, 2], (3..30).collect::<Vec<u32>>()] {
        let mut soup = clean.clone();
        for &t in &wrong {
            soup.triangles[t as usize].swap(0, 1);
        }
        let minority: Vec<u32> = if wrong.len() > 20 {
            (0..40).filter(|t| !wrong.contains(t)).collect()
        } else {
            wrong
        };
        let given = soup.triangles.clone();
        let (mesh, report) = mesh_of(soup);
        let flipped = |&face: &u32| Defect::FlippedFace { face };
        assert_eq!(
            report.defects,
            minority.iter().map(flipped).collect::<Vec<_>>()
        );
        assert!(mesh.half_edges().all(|h| mesh.twin(h).is_some()));
        for face in mesh.faces() {
            let given = given[face.index()];
            let found = mesh.face_vertices(face).map(VertexId::raw);
            let turned = [given[0], given[2], given[1]];
            let expected = if minority.contains(&face.raw()) {
                turned
            } else {
                given
            };
            assert_eq!(found, expected);
        }
    }
}

#[test]
fn of_two_equal_parts_the_first_face_stays() {
    let (_, report) = mesh_of(abstract_soup(4, &[[0, 1, 2], [1, 2, 3]]));
    assert_eq!(report.defects, [Defect::FlippedFace { face: 1 }]);
    assert_eq!(report.defects[0].severity(), Severity::Repaired);
}

#[test]
fn each_component_keeps_its_own_majority() {
    let [a, b] = [tetrahedron([0, 1, 2, 3]), tetrahedron([4, 5, 6, 7])];
    let mut triangles = [a, b].concat();
    for t in [1, 4, 5, 6] {
        triangles[t].swap(1, 2);
    }
    let (_, report) = mesh_of(abstract_soup(8, &triangles));
    assert_eq!(
        report.defects,
        [
            Defect::FlippedFace { face: 1 },
            Defect::FlippedFace { face: 7 },
            Defect::SeveralComponents {
                triangles: vec![4, 4]
            },
        ]
    );
}

/// A strip of five triangles, its ends joined with a half turn.
const MOEBIUS: [[u32; 3]; 5] = [[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]];

#[test]
fn a_surface_with_one_side_has_a_junction() {
    let (mesh, report) = mesh_of(abstract_soup(5, &MOEBIUS));
    let Defect::NotOrientable { vertices, faces } = report.defects[0] else {
        panic!("{report:?}");
    };
    let sides: Vec<HalfEdgeId> = mesh.junction_sides().collect();
    let [a, b] = sides[..] else {
        panic!("one edge is enough: {sides:?}");
    };
    assert_eq!(mesh.tail(a), mesh.tail(b));
    assert!(!mesh.has_edges_of_many_faces());
    let measures = MeshMeasures::of(&mesh);
    assert_eq!((measures.boundary_edges, measures.boundary_loops), (5, 1));
    assert_eq!((measures.edges, measures.junctions), (10, 1));
    for face in faces {
        assert!(vertices.iter().all(|v| MOEBIUS[face as usize].contains(v)));
    }
    assert_ne!(faces[0], faces[1]);
    // A second, sound component does not hide it, nor does it hide faces to turn over there.
    let mut triangles = MOEBIUS.to_vec();
    triangles.extend([[5, 6, 7], [5, 6, 8], [7, 6, 9]]);
    let (_, report) = mesh_of(abstract_soup(10, &triangles));
    let mut found = kinds(&report);
    found.dedup();
    assert_eq!(
        found,
        [
            DefectKind::NotOrientable,
            DefectKind::FlippedFace,
            DefectKind::SeveralComponents
        ]
    );
}

#[test]
fn fans_that_meet_in_a_point_are_noted_and_used() {
    // Two tetrahedra on one tip.
    let triangles = [tetrahedron([0, 1, 2, 3]), tetrahedron([3, 4, 5, 6])].concat();
    let (mesh, report) = mesh_of(abstract_soup(7, &triangles));
    let expected = Defect::PinchedVertex { vertex: 3, fans: 2 };
    assert_eq!(report.defects, [expected]);
    let pinched: Vec<u32> = mesh
        .vertices()
        .filter(|&v| mesh.is_pinched(v))
        .map(VertexId::raw)
        .collect();
    assert_eq!(pinched, [3]);
    // Two triangles on one tip, wound either way.
    for second in [[0, 3, 4], [4, 3, 0]] {
        let (mesh, report) = mesh_of(abstract_soup(5, &[[0, 1, 2], second]));
        let expected = Defect::PinchedVertex { vertex: 0, fans: 2 };
        assert_eq!(report.defects, [expected]);
        assert!(mesh.vertices().all(|v| mesh.is_boundary(v)));
    }
}

#[test]
fn pinched_vertices_are_found_beside_edges_of_many_faces() {
    let mut triangles = [tetrahedron([0, 1, 2, 3]), tetrahedron([3, 4, 5, 6])].concat();
    triangles.push([4, 5, 0]);
    let (_, report) = mesh_of(abstract_soup(7, &triangles));
    assert_eq!(
        report.defects,
        [
            Defect::NonManifoldEdge {
                vertices: [4, 5],
                faces: vec![4, 6, 8]
            },
            Defect::PinchedVertex { vertex: 0, fans: 2 },
            Defect::PinchedVertex { vertex: 3, fans: 2 },
        ]
    );
}

#[test]
fn isolated_vertices_are_kept_and_noted() {
    let (mesh, report) = mesh_of(abstract_soup(6, &[[1, 2, 4]]));
    let isolated = |vertex| Defect::IsolatedVertex { vertex };
    assert_eq!(report.defects, [0, 3, 5].map(isolated));
    assert_eq!(mesh.vertex_count(), 6);
    assert!(mesh.outgoing(mesh.vertices().next().unwrap()).is_empty());
}

#[test]
fn faces_without_area_are_noted_and_used() {
    let mut soup = grid(2, 1);
    // The middle vertex of the lower side moves onto the diagonal of the first square.
    soup.positions[1] = [0.5, 0.5, 0.0];
    let (_, report) = mesh_of(soup);
    assert_eq!(report.defects, [Defect::FlatFace { face: 0 }]);
}

#[test]
fn polygons_are_named_not_their_triangles() {
    let mut soup = abstract_soup(6, &[[0, 1, 2], [0, 2, 3], [1, 9, 4], [1, 4, 9], [5, 5, 4]]);
    soup.file_faces = vec![0, 0, 1, 1, 2];
    assert_eq!(
        refused(soup).report.defects,
        [
            Defect::IndexOutOfRange {
                face: 1,
                vertex: 9,
                vertex_count: 6
            },
            Defect::CollapsedFace { face: 2, vertex: 5 },
            Defect::IsolatedVertex { vertex: 5 },
        ]
    );
}

#[test]
fn no_defect_hides_another() {
    let mut soup = grid(3, 3); // Vertices 0 to 15, faces 0 to 17.
    soup.positions.extend(validate_support::any_positions(5)); // 16 to 20.
    for position in &mut soup.positions[16..] {
        position[2] += 7.0;
    }
    soup.positions.extend([[1e99, 0.0, 0.0], [0.0; 3]]); // 21, and 22 in no face.
    soup.positions[0] = soup.positions[1];
    soup.positions[15][0] = f64::NAN;
    soup.triangles[8].swap(0, 1);
    soup.triangles.extend(MOEBIUS.map(|t| t.map(|v| v + 16))); // Faces 18 to 22.
    soup.triangles.extend([[3, 3, 4], [2, 77, 1]]); // 23, 24.
    soup.triangles.extend([[5, 6, 18], [12, 21, 8]]); // 25, 26: bring along edges (5, 6), (8, 12).
    let error = refused(soup);
    let mut found = kinds(&error.report);
    found.dedup();
    assert_eq!(
        found,
        [
            DefectKind::IndexOutOfRange,
            DefectKind::NonFiniteCoordinate,
            DefectKind::LengthOutOfRange,
            DefectKind::NonManifoldEdge,
            DefectKind::NotOrientable,
            DefectKind::FlippedFace,
            DefectKind::CollapsedFace,
            DefectKind::ZeroLengthEdge,
            DefectKind::PinchedVertex,
            DefectKind::IsolatedVertex,
        ]
    );
}

#[test]
fn summaries_count_and_name_the_first_few() {
    let (_, report) = mesh_of(abstract_soup(9, &[[0, 1, 2], [1, 2, 3]]));
    let texts: Vec<String> = report.summaries().into_iter().map(|s| s.text).collect();
    assert_eq!(
        texts,
        [
            "1 face was wound against its neighbours and is used turned over (face 1)",
            "5 vertices are in no face and cannot be reached \
             (vertex 4; vertex 5; vertex 6; and 2 more)",
        ]
    );
}

#[test]
fn lengths_alone_make_a_mesh() {
    let unit = [[1.0; 3]; 4];
    let triangles = tetrahedron([0, 1, 2, 3]);
    let (mesh, report) = Mesh::from_lengths(4, &triangles, &unit).unwrap();
    mesh.sanity_check().unwrap();
    assert_eq!(report, Report::default());
    assert!(mesh.positions().is_empty());
    for v in mesh.vertices() {
        assert!((mesh.total_angle(v) - std::f64::consts::PI).abs() < 1e-15);
    }
}

#[test]
fn lengths_follow_their_edges_when_a_face_is_turned_over() {
    // Face 1 is wound the wrong way; its edges are 1-2, 2-3 and 3-1.
    let lengths = [[3.0, 4.0, 5.0], [4.0, 6.0, 7.0], [3.0, 7.0, 4.5]];
    let triangles = [[0, 1, 2], [1, 2, 3], [1, 0, 3]];
    let mut lengths = lengths;
    lengths[2] = [3.0, 4.5, 7.0];
    let (mesh, report) = Mesh::from_lengths(4, &triangles, &lengths).unwrap();
    mesh.sanity_check().unwrap();
    assert_eq!(report.defects, [Defect::FlippedFace { face: 1 }]);
    for h in mesh.half_edges() {
        let mut ends = [mesh.tail(h).raw(), mesh.head(h).raw()];
        ends.sort_unstable();
        let expected = match ends {
            [0, 1] => 3.0,
            [1, 2] => 4.0,
            [0, 2] => 5.0,
            [2, 3] => 6.0,
            [1, 3] => 7.0,
            _ => 4.5,
        };
        assert_eq!(mesh.length(h), expected, "{ends:?}");
    }
}

#[test]
fn lengths_that_cannot_be_are_named() {
    let advice = |length: f64| {
        let lengths = [[1.0, length, 1.0]];
        let error = Mesh::from_lengths(3, &[[0, 1, 2]], &lengths).unwrap_err();
        error.to_string()
    };
    for (length, action) in [
        (-1.0, "correct the"),
        (f64::NAN, "correct the"),
        (1e99, "scale the"),
    ] {
        let message = advice(length);
        assert!(message.contains(action), "{message}");
        assert!(
            message.contains("so that all lengths lie between 1e-60 and 1e60"),
            "{message}"
        );
    }
    let one = |lengths: [f64; 3]| {
        let error = Mesh::from_lengths(3, &[[0, 1, 2]], &[lengths]).unwrap_err();
        error.report.defects
    };
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let [Defect::LengthOutOfRange { vertices, length }] = one([1.0, bad, 1.0])[..] else {
            panic!("{bad}");
        };
        assert_eq!(vertices, [1, 2]);
        assert_eq!(length.to_bits(), bad.to_bits());
    }
    let lengths = [1.0, 1.0, 2.000_001];
    assert_eq!(
        one(lengths),
        [Defect::TriangleInequality { face: 0, lengths }]
    );
    let error =
        Mesh::from_lengths(4, &[[0, 1, 2], [2, 1, 3]], &[[1.0; 3], [1.5, 1.0, 1.0]]).unwrap_err();
    assert_eq!(
        error.report.defects,
        [Defect::UnequalLengths {
            vertices: [1, 2],
            lengths: [1.0, 1.5],
            faces: [0, 1]
        }]
    );
    let error = Mesh::from_lengths(3, &[[0, 1, 2]], &[]).unwrap_err();
    assert_eq!(kinds(&error.report), [DefectKind::LengthCount]);
}

#[test]
fn lengths_within_rounding_of_a_line_are_used() {
    let lengths = [0.1, 0.2, 0.1 + 0.2]; // The sum is rounded up.
    let (mesh, report) = Mesh::from_lengths(3, &[[0, 1, 2]], &[lengths]).unwrap();
    mesh.sanity_check().unwrap();
    assert_eq!(report.defects, [Defect::FlatFace { face: 0 }]);
}

#[test]
fn giant_numbers_are_refused_without_memory_for_them() {
    let error = Mesh::from_lengths(usize::MAX, &[], &[]).unwrap_err();
    assert_eq!(kinds(&error.report), [DefectKind::TooLarge]);
}
