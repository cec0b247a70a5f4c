//! The state of the surface under a wavefront.

use crate::engine::layout::MeshLayout;

/// The faces, the lists of one wavefront that wait on them, and the distances known.
pub(crate) trait SurfaceState {
    /// Whether the levels of windows are counted. They are not where windows come from other
    /// wavefronts, which have their levels.
    const COUNTS_LEVELS: bool;

    /// The faces and vertices.
    fn layout(&self) -> &MeshLayout;

    /// The list that waits on a half-edge, given by its face and corner.
    fn list(&self, f: usize, corner: usize) -> u32;

    /// Sets the list that waits on a half-edge.
    fn set_list(&mut self, f: usize, corner: usize, list: u32);

    /// Takes the list from a half-edge, which is not queued any more.
    fn take_list(&mut self, f: usize, corner: usize) -> u32;

    /// Marks a half-edge as queued, if its face has joined the traversed area; returns whether it
    /// was not and is now.
    fn enqueue(&mut self, f: usize, corner: usize) -> bool;

    /// Whether a face has joined the traversed area of this wavefront.
    fn contains(&self, f: usize) -> bool;

    /// A face joins the traversed area of this wavefront; returns whether it had not.
    fn join(&mut self, f: usize) -> bool;

    /// The length of the shortest path to `v` that is known.
    fn distance(&self, v: u32) -> f64;

    /// A path of length `d` reaches `v`. Returns whether the wavefront must
    /// [settle](super::Wavefront::settle) it: if it is the shortest known, or the first path of
    /// this wavefront to a vertex that must have a turn in it.
    fn offer(&mut self, v: u32, d: f64) -> bool;

    /// The length of the last path to `v` that this wavefront has
    /// [settled](super::Wavefront::settle) or will settle: the path whose origin it knows.
    fn reached(&self, v: u32) -> f64;

    /// Requests the cache lines of a face and of the lists on it.
    fn prefetch_face(&self, f: usize);

    /// Requests the cache line of the lists on a face.
    fn prefetch_lists(&self, f: usize);

    /// Requests the cache line of the distance of a vertex.
    fn prefetch_distance(&self, v: u32);
}
