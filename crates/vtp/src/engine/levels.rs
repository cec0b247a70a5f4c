//! The levels in the sequence tree of the windows that wait.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, DefaultHasher};

use geobench_window::Window;

use super::kernels::Triangle;

/// A source image with the distance of its pseudo-source, to the bit.
type Image = [u64; 3];

/// A map without a seed of its own: one with a random seed takes another amount of memory each
/// time.
type Map<K, V> = HashMap<K, V, BuildHasherDefault<DefaultHasher>>;

/// The level of the windows of each source image in a list.
type OfList = Map<Image, u32>;

/// How many triangles the ancestors of each waiting window have crossed.
///
/// No rule needs levels; they are counted because the papers count them. So they are kept in
/// counted runs only, and beside the lists. A window is known by its half-edge and source image.
/// Those that have both in common have crossed the same triangles, or are on a flat part of the
/// surface and came by both sides of a vertex; the deeper level then stands for both.
#[derive(Clone, Debug, Default)]
pub(crate) struct Levels {
    lists: Map<u32, OfList>,
}

impl Levels {
    /// To be called at the start of a run.
    pub(crate) fn clear(&mut self) {
        self.lists.clear();
    }

    /// A window that starts from a vertex comes to the list on half-edge `h`.
    pub(crate) fn start(&mut self, h: u32, source: [f64; 2], sigma: f64) {
        let levels = self.lists.entry(h).or_default();
        levels.entry(image(source, sigma)).or_insert(0);
    }

    /// The list on `h` has crossed its triangle or come to nothing.
    pub(crate) fn forget(&mut self, h: u32) {
        self.lists.remove(&h);
    }

    /// The list on `h` is about to cross `triangle`.
    pub(crate) fn leave(&self, h: u32, triangle: &Triangle) -> Departure {
        let none = OfList::default();
        let parents = self.lists.get(&h).unwrap_or(&none);
        let beyond = |side| {
            let mut children = OfList::default();
            for (&[px, py, sigma], &level) in parents {
                let source = triangle.source_beyond(side, [px, py].map(f64::from_bits));
                let child = image(source, f64::from_bits(sigma));
                let known = children.entry(child).or_insert(level + 1);
                *known = (level + 1).max(*known);
            }
            children
        };
        Departure {
            beyond: [beyond(0), beyond(1)],
        }
    }

    /// `children` that left through exit `side` come to the list on `h`; returns the deepest level
    /// among them.
    pub(crate) fn arrive(
        &mut self,
        h: u32,
        children: impl Iterator<Item = Window>,
        departure: &Departure,
        side: usize,
    ) -> u32 {
        let levels = self.lists.entry(h).or_default();
        let mut deepest = 0;
        for child in children {
            let image = image(child.source(), child.sigma);
            let level = departure.beyond[side].get(&image).copied();
            debug_assert!(level.is_some(), "a child has the source of its parent");
            let level = level.unwrap_or(0);
            let known = levels.entry(image).or_insert(level);
            *known = level.max(*known);
            deepest = level.max(deepest);
        }
        deepest
    }
}

/// The levels that children of a list have, for each exit.
#[derive(Debug)]
pub(crate) struct Departure {
    beyond: [OfList; 2],
}

fn image([px, py]: [f64; 2], sigma: f64) -> Image {
    // There are two zeros.
    [px, py, sigma].map(|x| (x + 0.0).to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_is_that_of_the_window_not_of_its_list() {
        let triangle = Triangle {
            l: 1.0,
            exits: [1.0, 1.0],
            apex: [0.5, 0.75_f64.sqrt()],
            directions: [[0.5, 0.75_f64.sqrt()], [0.5, -(0.75_f64.sqrt())]],
        };
        let window = |[px, py]: [f64; 2]| Window {
            b0: 0.0,
            b1: 1.0,
            px,
            py,
            sigma: 0.0,
        };
        let mut levels = Levels::default();
        let deep = [0.5, -2.0];
        levels.start(0, deep, 0.0);
        let departure = levels.leave(0, &triangle);
        let child = triangle.source_beyond(0, deep);
        assert_eq!(
            levels.arrive(1, [window(child)].into_iter(), &departure, 0),
            1
        );
        let shallow = [0.25, -1.0];
        levels.start(1, shallow, 0.0);
        let departure = levels.leave(1, &triangle);
        let alone = [window(triangle.source_beyond(1, shallow))].into_iter();
        assert_eq!(levels.arrive(2, alone, &departure, 1), 1);
        let both = [child, shallow].map(|source| window(triangle.source_beyond(1, source)));
        assert_eq!(levels.arrive(2, both.into_iter(), &departure, 1), 2);
    }
}
