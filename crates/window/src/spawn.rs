//! The windows that a source or pseudo-source sends out.

use geobench_mesh::HalfEdgeId;

use crate::frame::Faces;
use crate::window::Window;

/// The window that the tail of `h` sends across the face of `h`, with the half-edge at which it
/// arrives; `None` if the opposite edge is on the boundary.
///
/// `sigma` is the distance at the tail. In the frame of the returned half-edge the window spans the
/// whole edge, and its source is the tail itself. A (pseudo-)source sends one window for each of
/// its outgoing half-edges.
#[inline]
pub fn spawn_window(faces: &Faces, h: HalfEdgeId, sigma: f64) -> Option<(HalfEdgeId, Window)> {
    let opposite = h.next();
    let target = faces.twin(opposite)?;
    let [px, py] = faces.apex_below(opposite);
    Some((
        target,
        Window {
            b0: 0.0,
            b1: faces.length(target),
            px,
            py,
            sigma,
        },
    ))
}
