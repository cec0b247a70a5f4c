//! What can be switched.

use geobench_window::simd::Instructions;

/// The improvements of [`VtpFast`](crate::VtpFast). None of them changes a distance by more than
/// rounding does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The instructions to use; fewer if the processor lacks them.
    pub instructions: Instructions,
    /// Rules 2 and 3 are applied to one of so many of the longer lists; to all lists if 1, to none
    /// if 0.
    pub pairs: u32,
    /// Width of a bucket of vertices that have their turns together, in mean edge lengths; more
    /// than 0.
    pub bucket: f64,
    /// Whether vertices and faces are put into an order of their own, breadth first.
    pub renumber: bool,
    /// Whether pseudo-sources send windows only into the shadow of the path that reached them.
    pub spawn_wedge: bool,
    /// Whether windows that a flat vertex has parted become one again behind it, on surfaces where
    /// at least an eighth of the vertices is flat.
    pub coalesce: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            instructions: Instructions::detect(),
            pairs: 8,
            bucket: 0.25,
            renumber: true,
            spawn_wedge: true,
            coalesce: true,
        }
    }
}
