//! Fixed defects of the geometry of windows, each as a test named after what went wrong. Defects
//! that show in distances are tested in the crates of the solvers.

use geobench_mesh::{Mesh, TriangleSoup, VertexId};
use geobench_window::{Faces, Side};

/// `l - cx` cancels where the right exit is short. The vector along it was wrong by 1e-6 here.
#[test]
fn the_direction_of_a_short_right_exit_lost_its_digits() {
    // From the right end of the edge to the apex.
    for short in [[-6e-12, 8e-12], [8e-12, 6e-12], [-1e-9, 3e-10]] {
        let (b, c) = ([3.0, 1.0], [3.0 + short[0], 1.0 + short[1]]);
        let positions = vec![[0.0; 3], [b[0], b[1], 0.0], [c[0], c[1], 0.0]];
        let (mesh, _) = Mesh::from_soup(TriangleSoup::new(positions, vec![[0, 1, 2]])).unwrap();
        let faces = Faces::new(&mesh);
        let h = mesh.outgoing(VertexId::new(0))[0];
        let face = faces.face_view(h);
        // The differences of the positions are exact.
        let exit = [b[0] - c[0], b[1] - c[1]];
        let scale = exit[0].hypot(exit[1]) * b[0].hypot(b[1]);
        let along = (b[0] * exit[0] + b[1] * exit[1]) / scale;
        let across = (b[0] * exit[1] - b[1] * exit[0]) / scale;
        for found in [
            face.frame.right,
            face.exit(Side::Right).direction,
            faces.exit(h, &face.frame, Side::Right).direction,
        ] {
            let error = (found[0] - along).abs().max((found[1] - across).abs());
            assert!(error <= 1e-15, "{found:?} instead of {:?}", [along, across]);
        }
    }
}
