//! What a wavefront runs over.

use crate::engine::surface::Surface;

/// The surface as one wave finds it: the faces, the lists of this wavefront that wait on them, and what
/// is known of distances.
pub(crate) trait SurfaceState {
    /// Whether the levels of windows are counted: not where windows come from other wavefronts, which
    /// know them.
    const COUNTS_LEVELS: bool;

    /// The faces and vertices.
    fn surface(&self) -> &Surface;

    /// The list that waits on a half-edge, given by its face and corner.
    fn list(&self, f: usize, corner: usize) -> u32;

    /// Has `list` wait on a half-edge, and nothing else.
    fn set_list(&mut self, f: usize, corner: usize, list: u32);

    /// Takes the list from a half-edge, which is not queued any more.
    fn take_list(&mut self, f: usize, corner: usize) -> u32;

    /// Marks a half-edge as queued, if its face has joined the traversed area; returns whether it
    /// was not and is now.
    fn enqueue(&mut self, f: usize, corner: usize) -> bool;

    /// A face joins the traversed area of this wavefront; returns whether it had not.
    fn join(&mut self, f: usize) -> bool;

    /// The length of the shortest path to `v` that is known.
    fn distance(&self, v: u32) -> f64;

    /// A path of length `d` reaches `v`. Returns whether the wavefront must
    /// [settle](super::Wave::settle) that: if it is shorter than all that are known, or if the
    /// vertex is to have a turn of which this wavefront does not know.
    fn offer(&mut self, v: u32, d: f64) -> bool;

    /// The length of the path to `v` that this wavefront has [settled](super::Wavefront::settle) last or is
    /// to settle: the one whose origin it knows.
    fn reached(&self, v: u32) -> f64;

    /// Asks the processor for a face, and for the lists on it.
    fn prefetch_face(&self, f: usize);

    /// Asks the processor for the lists on a face.
    fn prefetch_lists(&self, f: usize);

    /// Asks the processor for the distance of a vertex.
    fn prefetch_distance(&self, v: u32);
}
