//! Faces laid out in an order of their own are the faces of the mesh.

use geobench_mesh::generate::generate;
use geobench_mesh::{Mesh, Numbering};
use geobench_window::{FaceView, Faces};

#[test]
fn faces_in_another_order_are_the_same_faces() {
    // With a boundary, and numbered by rows, which the other order does not follow.
    let spec = "plate".parse().expect("the name of a generator");
    let soup = generate(&spec).expect("its parameters have defaults");
    let (mesh, _) = Mesh::from_soup(soup).expect("generated meshes are valid");
    let plain = Faces::new(&mesh);
    for (numbering, is_other) in [
        (Numbering::same(), false),
        (Numbering::breadth_first(&mesh), true),
    ] {
        let faces = Faces::in_order(&mesh, numbering);
        assert_eq!(mesh.half_edges().any(|h| faces.number(h) != h), is_other);
        for h in mesh.half_edges() {
            let expected = plain.face_view(h);
            let expected = FaceView {
                exits: expected.exits.map(|exit| exit.map(|e| faces.number(e))),
                ..expected
            };
            assert_eq!(faces.face_view(faces.number(h)), expected, "{h:?}");
        }
    }
}
