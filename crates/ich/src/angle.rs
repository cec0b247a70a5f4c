//! One angle, one split: which window may have two children at an apex.

use std::collections::HashMap;

use geobench_mesh::HalfEdgeId;
use geobench_window::blocks::number;
use geobench_window::{Side, prefetch};

use crate::route::Route;
use crate::tree::Guard;

/// Distance, relative to the half-edge, within which two rays to an apex count as one. Which of
/// them is further left is then decided by rounding.
const TIE: f64 = 1e-9;

/// The *occupant* of an angle: the best window so far, of those of one [`Route`], to see an apex
/// through one half-edge.
#[derive(Clone, Copy, Debug)]
struct Angle {
    best: f64,
    /// The fraction of the half-edge at which its ray to the apex enters.
    entry: f64,
}

impl Angle {
    const FREE: Self = Self {
        best: f64::INFINITY,
        entry: 0.0,
    };
}

/// The children that a window that covers the apex may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Split {
    /// The window is the new occupant: both children, guarded by the angle as it is now.
    Occupies,
    /// The window's ray is that of the occupant: both children.
    Ties,
    /// The window is longer than the occupant: only the child that does not cross the occupant's
    /// ray.
    Only(Side),
}

/// The occupants of all angles of a mesh. The angle at an apex has the number of the half-edge
/// opposite to the apex, through which windows enter. For windows that have crossed junctions it
/// has another number for each of their routes.
#[derive(Clone, Debug)]
pub(crate) struct Angles {
    occupants: Vec<Angle>,
    half_edges: usize,
    /// The numbers from `half_edges` on.
    beyond_junctions: HashMap<(HalfEdgeId, Route), u32>,
}

impl Angles {
    pub(crate) fn new(half_edges: usize) -> Self {
        Self {
            occupants: vec![Angle::FREE; half_edges],
            half_edges,
            beyond_junctions: HashMap::new(),
        }
    }

    /// Changes the number of half-edges. The next [`clear`](Self::clear) frees their angles.
    pub(crate) fn resize(&mut self, half_edges: usize) {
        self.half_edges = half_edges;
        self.occupants.resize(half_edges, Angle::FREE);
    }

    pub(crate) fn clear(&mut self) {
        self.clear_beyond_junctions();
        self.occupants.fill(Angle::FREE);
    }

    pub(crate) fn clear_at(&mut self, h: HalfEdgeId) {
        self.occupants[h.index()] = Angle::FREE;
    }

    pub(crate) fn clear_beyond_junctions(&mut self) {
        self.occupants.truncate(self.half_edges);
        self.beyond_junctions.clear();
    }

    /// The number of the angle above `h` for windows that have come by `route`.
    #[inline]
    pub(crate) fn number(&mut self, h: HalfEdgeId, route: Route) -> u32 {
        if route == Route::DIRECT {
            h.raw()
        } else {
            self.number_beyond_junctions(h, route)
        }
    }

    #[cold]
    #[inline(never)]
    fn number_beyond_junctions(&mut self, h: HalfEdgeId, route: Route) -> u32 {
        let occupants = &mut self.occupants;
        *self.beyond_junctions.entry((h, route)).or_insert_with(|| {
            occupants.push(Angle::FREE);
            number(occupants.len() - 1)
        })
    }

    /// Decides the split at `angle` of a window that reaches the apex at distance `d`. Its ray
    /// meets the half-edge at the fraction `entry` of its length, which is NaN if rounding leaves
    /// it undetermined.
    ///
    /// The shorter of two straight paths to an apex makes every ray of the other window useless
    /// that crosses it. These are the rays on its far side. If both paths enter at the same point,
    /// that side is undetermined, and the longer window keeps both children, however much longer it
    /// is. The occupant may be on the border ray of the window (a saddle that has since been
    /// reached by a shorter path). It then crosses none of the window's rays.
    ///
    /// The rays cross in the unfolded plane. They do on the surface if both windows have come by
    /// one route: see `docs/algorithms/junctions.md`.
    pub(crate) fn split(&mut self, angle: u32, d: f64, entry: f64) -> Split {
        let angle = &mut self.occupants[angle as usize];
        if entry.is_nan() {
            // The side on which the ray lies of other rays is undetermined.
            Split::Ties
        } else if d < angle.best {
            angle.best = d;
            angle.entry = entry;
            Split::Occupies
        } else if (entry - angle.entry).abs() <= TIE {
            Split::Ties
        } else if entry < angle.entry {
            Split::Only(Side::Left)
        } else {
            Split::Only(Side::Right)
        }
    }

    /// Prefetches the angle of `guard`.
    #[inline]
    pub(crate) fn announce(&self, guard: &Guard) {
        prefetch(&self.occupants, guard.angle_index());
    }

    /// Whether the angle of `guard` has a new occupant whose ray cuts off the guarded subtree.
    ///
    /// A new ray further left cuts off the left child, one further right the right child. While the
    /// occupant is the same, its ray is the same.
    #[inline]
    pub(crate) fn cuts_off(&self, guard: &Guard) -> bool {
        let angle = &self.occupants[guard.angle_index()];
        guard.beyond(angle.entry) > TIE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: u32 = 0;

    #[test]
    fn the_best_window_occupies_the_angle_and_losers_keep_one_side() {
        let mut angles = Angles::new(3);
        assert_eq!(angles.split(H, 2.0, 0.5), Split::Occupies);
        assert_eq!(angles.split(H, 3.0, 0.3), Split::Only(Side::Left));
        assert_eq!(angles.split(H, 3.0, 0.7), Split::Only(Side::Right));
        assert_eq!(angles.split(H, 1.0, 0.6), Split::Occupies);
    }

    #[test]
    fn collinear_sources_tie_instead_of_losing_a_side_to_rounding() {
        let mut angles = Angles::new(3);
        angles.split(H, 2.0, 0.5);
        assert_eq!(angles.split(H, 2.0 + 1e-15, 0.5 - 1e-16), Split::Ties);
        assert_eq!(angles.split(H, 2.0, 0.5 + 1e-16), Split::Ties);
    }

    /// On integer terrain a window once lost all its rays to an occupant that was shorter by 3e-5
    /// on its border ray: the occupant's ray seemed to be further right by 1e-16 of the edge.
    #[test]
    fn a_shorter_path_along_the_border_ray_takes_no_side() {
        let mut angles = Angles::new(3);
        angles.split(H, 2.0, 0.5);
        assert_eq!(angles.split(H, 2.1, 0.5 - 1e-16), Split::Ties);
    }

    #[test]
    fn windows_of_different_routes_occupy_angles_of_their_own() {
        let mut angles = Angles::new(3);
        let h = HalfEdgeId::new(2);
        let [direct, one, other] =
            [Route::DIRECT, Route(1), Route(2)].map(|route| angles.number(h, route));
        assert_eq!([direct, one, other], [2, 3, 4]);
        assert_eq!(angles.number(h, Route(1)), one);
        assert_eq!(angles.split(one, 1.0, 0.5), Split::Occupies);
        assert_eq!(angles.split(other, 2.0, 0.7), Split::Occupies);
        assert_eq!(angles.split(one, 2.0, 0.7), Split::Only(Side::Right));
        let guard = Guard::new(other, 0.7, Side::Right);
        angles.split(one, 0.5, 0.8);
        assert!(!angles.cuts_off(&guard));
        angles.clear();
        assert_eq!(angles.number(h, Route(2)), 3);
    }

    #[test]
    fn a_displaced_occupant_loses_the_child_behind_the_new_ray() {
        let mut angles = Angles::new(3);
        angles.split(H, 2.0, 0.5);
        let [left, right] = [Side::Left, Side::Right].map(|side| Guard::new(H, 0.5, side));
        assert!(!angles.cuts_off(&left) && !angles.cuts_off(&right));
        angles.split(H, 1.0, 0.7);
        assert!(
            !angles.cuts_off(&left),
            "the left child lies before the new ray"
        );
        assert!(angles.cuts_off(&right));
        assert!(!angles.cuts_off(&Guard::NONE));
    }
}
