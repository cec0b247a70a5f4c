//! The levels of waiting windows in the sequence tree.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use geobench_window::Window;

use super::kernels::Triangle;

/// A source image with the distance of its pseudo-source, as bits.
type Image = [u64; 3];

/// A map with a fixed seed: with random seeds the memory of a run would vary.
type Map<K, V> = HashMap<K, V, BuildHasherDefault<Mixer>>;

/// A hash of few words: each is mixed in by a multiplication, whose high bits are folded back. The
/// keys are coordinates, not chosen to collide.
#[derive(Default)]
struct Mixer(u64);

impl Mixer {
    fn add(&mut self, word: u64) {
        let product =
            u128::from(self.0.rotate_left(5) ^ word) * u128::from(0x9e37_79b9_7f4a_7c15_u64);
        self.0 = (product as u64) ^ ((product >> 64) as u64);
    }
}

impl Hasher for Mixer {
    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            self.add(u64::from_le_bytes(word));
        }
    }

    fn write_u32(&mut self, word: u32) {
        self.add(word.into());
    }

    fn write_u64(&mut self, word: u64) {
        self.add(word);
    }

    fn finish(&self) -> u64 {
        self.0
    }
}

/// The level of the windows of each source image, for one list.
type OfList = Map<Image, u32>;

/// The number of triangles that the ancestors of each waiting window have crossed.
///
/// No rule needs levels. They are counted because the papers count them, so they are kept beside
/// the lists and in counted runs only. A window is identified by its half-edge and source image.
/// Windows that share both have crossed the same triangles, or have passed a vertex on both sides
/// on a flat part of the surface. The deeper level then stands for both.
#[derive(Clone, Debug, Default)]
pub(crate) struct Levels {
    lists: Map<u32, OfList>,
}

impl Levels {
    /// Resets the levels at the start of a run.
    pub(crate) fn clear(&mut self) {
        self.lists.clear();
    }

    /// Records a window that a vertex sends to the list on half-edge `h`.
    pub(crate) fn start(&mut self, h: u32, source: [f64; 2], sigma: f64) {
        let levels = self.lists.entry(h).or_default();
        levels.entry(image(source, sigma)).or_insert(0);
    }

    /// Removes the list on `h`, which has crossed its triangle or become empty.
    pub(crate) fn forget(&mut self, h: u32) {
        self.lists.remove(&h);
    }

    /// The levels of the children of the list on `h`, which is about to cross `triangle`.
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

    /// Records `children` that left through exit `side` and arrived at the list on `h`. Returns the
    /// deepest level among them.
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

/// The levels of the children of a list, for each exit.
#[derive(Debug)]
pub(crate) struct Departure {
    beyond: [OfList; 2],
}

fn image([px, py]: [f64; 2], sigma: f64) -> Image {
    // Adding 0 makes both zeros equal.
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
