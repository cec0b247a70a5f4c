//! The leaves of the sequence tree: windows that wait to be propagated.

use geobench_mesh::VertexId;
use geobench_window::blocks::number;
use geobench_window::{Side, Window, prefetch};

use crate::route::Route;

/// The nearest split above a window. If another window has occupied that angle since, the subtree
/// on its far side is dead.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Guard {
    /// The fraction of the half-edge at which the split window's ray to the apex entered.
    entry: f64,
    /// Twice the number of the angle, plus 1 for the right child.
    place: u32,
}

impl Guard {
    /// The guard of a window without a split above it. Comparisons with it are false for every
    /// angle.
    pub(crate) const NONE: Self = Self {
        entry: f64::NAN,
        place: 0,
    };

    /// The guard of the child on one side of a window that was split at `angle`.
    pub(crate) const fn new(angle: u32, entry: f64, side: Side) -> Self {
        let side = match side {
            Side::Left => 0,
            Side::Right => 1,
        };
        Self {
            entry,
            place: 2 * angle + side,
        }
    }

    /// In place of the guard of a window that needs none: its route.
    const fn of_route(route: Route) -> Self {
        Self {
            entry: f64::NAN,
            place: route.0,
        }
    }

    /// The number of the angle.
    #[inline]
    pub(crate) fn angle_index(self) -> usize {
        self.place as usize / 2
    }

    /// How far the ray that enters at `entry` is on the child's side of the ray of the split: left
    /// of it for the left child, right of it for the right child. NaN if there is no split.
    #[inline]
    pub(crate) fn beyond(self, entry: f64) -> f64 {
        // The difference, negated without a branch for the right child.
        let sign = u64::from(self.place) << 63;
        f64::from_bits((self.entry - entry).to_bits() ^ sign)
    }
}

/// The triangles that a window has crossed since its root. The highest bit tells that the window
/// goes on whatever becomes of its guard: beside a thin face or at a junction, it or a window above
/// it has been stored in the place of equal ones.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Level(u32);

impl Level {
    const GOES_ON: u32 = 1 << 31;

    /// The level of windows that start at the root.
    const ROOT: Self = Self(0);

    /// The level of the children.
    #[inline]
    pub(crate) fn next(self) -> Self {
        Self(self.0 + 1)
    }

    /// Number of triangles.
    #[inline]
    pub(crate) fn count(self) -> u32 {
        self.0 & !Self::GOES_ON
    }

    #[inline]
    pub(crate) fn goes_on(self) -> bool {
        self.0 & Self::GOES_ON != 0
    }
}

/// The data that decides whether a window is stale when it leaves the queue.
#[derive(Clone, Copy, Debug)]
pub struct Lineage {
    /// The (pseudo-)source.
    pub(crate) root: VertexId,
    pub(crate) level: Level,
    /// Of a window that [goes on](Level::goes_on), its [route](Guard::of_route).
    pub(crate) guard: Guard,
}

impl Lineage {
    /// The lineage of windows that start from `root`.
    pub(crate) const fn new(root: VertexId) -> Self {
        Self {
            root,
            level: Level::ROOT,
            guard: Guard::NONE,
        }
    }

    /// The route of the window. All that have crossed a junction go on.
    #[inline]
    pub(crate) fn route(&self) -> Route {
        if self.level.goes_on() {
            Route(self.guard.place)
        } else {
            Route::DIRECT
        }
    }

    /// The lineage of the child on one side of a window that occupies `angle`.
    #[inline]
    #[must_use]
    pub(crate) fn split(self, angle: u32, entry: f64, side: Side) -> Self {
        if self.level.goes_on() {
            return self;
        }
        let guard = Guard::new(angle, entry, side);
        Self { guard, ..self }
    }

    /// Makes the window, which has come by `route`, and its descendants go on.
    #[inline]
    pub(crate) fn go_on(&mut self, route: Route) {
        self.level.0 |= Level::GOES_ON;
        self.guard = Guard::of_route(route);
    }
}

/// A window that waits to be propagated, in one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Leaf {
    pub(crate) window: Window,
    pub(crate) lineage: Lineage,
}

/// No node.
const NONE: u32 = u32::MAX;

/// Nodes in reused slots.
#[derive(Clone, Debug)]
pub(crate) struct Leaves {
    nodes: Vec<Leaf>,
    /// The slot freed last. Its level is the number of the slot freed before it.
    free: u32,
    len: usize,
}

impl Default for Leaves {
    fn default() -> Self {
        Self {
            nodes: Vec::new(),
            free: NONE,
            len: 0,
        }
    }
}

impl Leaves {
    #[inline]
    pub(crate) fn insert(&mut self, node: Leaf) -> u32 {
        self.len += 1;
        let slot = self.free;
        if let Some(place) = self.nodes.get_mut(slot as usize) {
            self.free = place.lineage.level.0;
            *place = node;
            slot
        } else {
            self.nodes.push(node);
            number(self.nodes.len() - 1)
        }
    }

    /// Frees a slot; returns what it held.
    #[inline]
    pub(crate) fn remove(&mut self, slot: u32) -> Leaf {
        let place = &mut self.nodes[slot as usize];
        let leaf = *place;
        place.lineage.level = Level(self.free);
        self.free = slot;
        self.len -= 1;
        leaf
    }

    /// The window in a slot.
    #[inline]
    pub(crate) fn window(&self, slot: u32) -> &Window {
        &self.nodes[slot as usize].window
    }

    /// Prefetches a slot that is to be [removed](Self::remove) soon.
    #[inline]
    pub(crate) fn announce(&self, slot: u32) {
        prefetch(&self.nodes, slot as usize);
    }

    /// The lineage of the window in a slot.
    #[inline]
    pub(crate) fn lineage(&self, slot: u32) -> &Lineage {
        &self.nodes[slot as usize].lineage
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    pub(crate) fn clear(&mut self) {
        self.nodes.clear();
        self.free = NONE;
        self.len = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packing_keeps_the_split() {
        assert!(Guard::NONE.beyond(0.5).is_nan());
        for angle in [0, 7, (1 << 31) - 2] {
            let [left, right] = [Side::Left, Side::Right].map(|side| Guard::new(angle, 0.25, side));
            assert_eq!(
                [left.angle_index(), right.angle_index()],
                [angle as usize; 2]
            );
            assert_eq!([left.beyond(0.0), right.beyond(0.0)], [0.25, -0.25]);
        }
        assert_eq!(size_of::<Leaf>(), 64);
    }
}
