//! The state of the surface under a wavefront.

use crate::engine::layout::MeshLayout;

/// The faces, the lists of one wavefront that wait on them, and the known distances.
pub(crate) trait SurfaceState {
    /// Whether this is the only wavefront. Where others are, windows are handed over as columns and
    /// without their tree levels: levels are not counted, and windows do not stay in unfolded
    /// planes.
    const IS_ALONE: bool;

    /// The faces and vertices.
    fn layout(&self) -> &MeshLayout;

    /// The list that waits on half-edge `corner` of face `f`.
    fn list(&self, f: usize, corner: usize) -> u32;

    /// Sets the list that waits on half-edge `corner` of face `f`.
    fn set_list(&mut self, f: usize, corner: usize, list: u32);

    /// Takes the list from half-edge `corner` of face `f` and marks the half-edge as not queued.
    fn take_list(&mut self, f: usize, corner: usize) -> u32;

    /// Marks a half-edge as queued, if its face has joined the traversed area. Returns whether this
    /// is a change.
    fn enqueue(&mut self, f: usize, corner: usize) -> bool;

    /// Makes face `f` join the traversed area of this wavefront. Returns whether it had not joined.
    fn join(&mut self, f: usize) -> bool;

    /// The length of the shortest known path to `v`.
    fn distance(&self, v: u32) -> f64;

    /// Offers `v` a path of length `d`. Returns whether the wavefront must
    /// [settle](super::Wavefront::settle) it: the path is the shortest known, or the first path of
    /// this wavefront to a vertex that must have a turn in it.
    fn offer(&mut self, v: u32, d: f64) -> bool;

    /// The length of the last path to `v` that this wavefront has
    /// [settled](super::Wavefront::settle) or will settle. Its origin is known.
    fn reached(&self, v: u32) -> f64;

    /// Prefetches a face and the lists on it.
    fn prefetch_face(&self, f: usize);

    /// Prefetches the lists on a face.
    fn prefetch_lists(&self, f: usize);

    /// Prefetches the distance of a vertex.
    fn prefetch_distance(&self, v: u32);
}
