//! One angle, one split: which window may have two children at a corner.

use geobench_mesh::HalfEdgeId;

use geobench_window::{Side, prefetch};

use crate::tree::Guard;

/// Distance, relative to the half-edge, within which two rays to an apex count as one: which of
/// them is further left is then a matter of rounding.
const TIE: f64 = 1e-9;

/// The best window so far to see an apex through one half-edge, its *occupant*.
#[derive(Clone, Copy, Debug)]
struct Angle {
    best: f64,
    /// Where its ray to the apex comes in, as a fraction of the half-edge.
    entry: f64,
}

impl Angle {
    const FREE: Self = Self {
        best: f64::INFINITY,
        entry: 0.0,
    };
}

/// Which children a window that covers the apex may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Split {
    /// It is the new occupant: both, guarded by the angle in its present state.
    Occupies,
    /// Its ray is that of the occupant: both.
    Ties,
    /// It loses: only the child that does not cross the occupant's ray.
    Only(Side),
}

/// The occupants of all angles of a mesh. The angle at an apex is numbered by the half-edge
/// opposite it, through which windows come.
#[derive(Clone, Debug)]
pub(crate) struct Angles {
    angles: Vec<Angle>,
}

impl Angles {
    pub(crate) fn new(half_edges: usize) -> Self {
        Self {
            angles: vec![Angle::FREE; half_edges],
        }
    }

    pub(crate) fn clear(&mut self) {
        self.angles.fill(Angle::FREE);
    }

    pub(crate) fn clear_at(&mut self, h: HalfEdgeId) {
        self.angles[h.index()] = Angle::FREE;
    }

    /// A window reaches the apex at distance `d`, its ray meeting `h` at the fraction `entry` of
    /// its length; NaN if rounding blurs that.
    ///
    /// The shortest of two straight paths to one apex kills every ray of the other window that
    /// crosses it, which are those on its far side. Where both paths enter at one point there is no
    /// telling which side that is, and the loser keeps both children, however much longer it is:
    /// the occupant may stand on the border ray of the window (a saddle that has been reached by a
    /// shorter path since), and then crosses none of its rays.
    pub(crate) fn split(&mut self, h: HalfEdgeId, d: f64, entry: f64) -> Split {
        let angle = &mut self.angles[h.index()];
        if entry.is_nan() {
            // Nothing tells on which side of another ray it is.
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

    /// Asks for the memory of the angle of `guard`.
    #[inline]
    pub(crate) fn announce(&self, guard: &Guard) {
        prefetch(&self.angles, guard.angle_index());
    }

    /// Whether the angle of `guard` has a new occupant whose ray cuts the guarded subtree off.
    ///
    /// A new ray further left cuts off the left child, one further right the right child. As long
    /// as the occupant is the same its ray is, too.
    #[inline]
    pub(crate) fn cuts_off(&self, guard: &Guard) -> bool {
        let angle = &self.angles[guard.angle_index()];
        guard.beyond(angle.entry) > TIE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: HalfEdgeId = HalfEdgeId::new(0);

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

    /// An occupant that is shorter by 3e-5 on the border ray of a window made it lose all its rays
    /// on integer terrain, because its ray was taken to be further right by 1e-16 of the edge.
    #[test]
    fn a_shorter_path_along_the_border_ray_takes_no_side() {
        let mut angles = Angles::new(3);
        angles.split(H, 2.0, 0.5);
        assert_eq!(angles.split(H, 2.1, 0.5 - 1e-16), Split::Ties);
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
