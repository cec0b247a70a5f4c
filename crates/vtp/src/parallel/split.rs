//! Who gets which part of the surface.

use crate::engine::surface::Surface;

/// Parts of the surface whose loads are counted, at most.
const BLOCKS: usize = 2048;

/// What a list that is taken across a face costs besides its windows, in windows.
pub(super) const LIST: u64 = 16;

/// How much of the shares that differ from an equal one is kept from one division to the next, and how much a load that
/// differs from the mean adds to them.
const KEPT: f64 = 0.9;
const GAIN: f64 = 0.2;

/// Cuts the surface into ranges of its faces, one for each thread, of about the same load.
///
/// Numbers follow a space-filling curve, so that a range is a part of the surface in one piece or a few. Windows of
/// one step come to faces that nobody has yet mostly, all around the source, and those of the next step to faces
/// nearby. So blocks of faces count the windows that come to them, and ranges are cut such that all had got as
/// many since the last time. Windows cross a few steps after they have come, and not everywhere as many after; so whoever had
/// more to cross than others gets a lesser share. Every thread makes the same cuts from the same counts.
#[derive(Clone, Debug)]
pub(super) struct Split {
    threads: usize,
    /// Faces of a block, as a power of 2.
    shift: u32,
    /// What this thread has counted in each block since the last division.
    own: Vec<u32>,
    /// What all threads have.
    all: Vec<u64>,
    /// By how much the share of each thread is to exceed an equal one, relatively.
    excess: Vec<f64>,
    /// The first face of each range but the first, and its first vertex.
    faces: Vec<u32>,
    vertices: Vec<u32>,
}

impl Split {
    pub(super) fn new(surface: &Surface, threads: usize) -> Self {
        let faces = surface.faces.len();
        let shift = (faces / BLOCKS).checked_ilog2().map_or(0, |log| log + 1);
        let blocks = if threads > 1 { (faces >> shift) + 1 } else { 0 };
        Self {
            threads,
            shift,
            own: vec![0; blocks],
            all: vec![0; blocks],
            excess: vec![0.0; threads],
            faces: vec![0; threads - 1],
            vertices: vec![0; threads - 1],
        }
    }

    /// Starts a run, with ranges of the same size.
    pub(super) fn reset(&mut self, surface: &Surface) {
        self.own.fill(0);
        self.excess.fill(0.0);
        self.all.fill(1);
        self.cut(surface);
    }

    #[inline]
    pub(super) fn owner_of_face(&self, f: usize) -> usize {
        self.faces.partition_point(|&cut| cut as usize <= f)
    }

    #[inline]
    pub(super) fn owner_of_vertex(&self, v: u32) -> usize {
        self.vertices.partition_point(|&cut| cut <= v)
    }

    /// So many windows come to a face.
    #[inline(always)]
    pub(super) fn note(&mut self, f: usize, windows: usize) {
        if let Some(load) = self.own.get_mut(f >> self.shift) {
            // Windows come to a list twice, from both sides of the face below.
            *load += windows as u32 + LIST as u32 / 2;
        }
    }

    /// What has been counted since it was asked for last: blocks and their loads.
    pub(super) fn drain(&mut self, loads: &mut Vec<(u32, u32)>) {
        for (block, load) in (0..).zip(&mut self.own) {
            if *load > 0 {
                loads.push((block, std::mem::take(load)));
            }
        }
    }

    /// Adds what one of the threads has counted.
    pub(super) fn learn(&mut self, loads: &[(u32, u32)]) {
        for &(block, load) in loads {
            self.all[block as usize] += u64::from(load);
        }
    }

    /// Learns what the threads had to cross in the last step.
    pub(super) fn compare(&mut self, loads: impl Iterator<Item = u64> + Clone) {
        let mean = loads.clone().sum::<u64>() as f64 / self.threads as f64;
        if mean == 0.0 {
            return;
        }
        for (excess, load) in self.excess.iter_mut().zip(loads) {
            let lacks = 1.0 - load as f64 / mean;
            *excess = (*excess * KEPT + lacks * GAIN).clamp(-0.5, 0.5);
        }
    }

    /// Cuts anew.
    pub(super) fn cut(&mut self, surface: &Surface) {
        let total: u64 = self.all.iter().sum();
        let shares = 1.0 / (self.threads as f64 + self.excess.iter().sum::<f64>());
        let (mut block, mut before, mut share) = (0, 0, 0.0);
        for t in 1..self.threads {
            share += (1.0 + self.excess[t - 1]) * shares;
            #[allow(clippy::cast_sign_loss)] // No share is negative.
            let wanted = (total as f64 * share) as u64;
            while block + 1 < self.all.len() && before + self.all[block] < wanted {
                before += self.all[block];
                block += 1;
            }
            // The load of a block is taken as spread evenly over it.
            let part = ((wanted - before) << self.shift).checked_div(self.all[block]);
            let face = (block << self.shift) + part.unwrap_or(0) as usize;
            (self.faces[t - 1], self.vertices[t - 1]) = match surface.faces.get(face) {
                // The vertex along whose part of the curve the face was numbered.
                Some(first) => {
                    let [a, b, c] = first.vertex;
                    (face as u32, a.min(b).min(c))
                }
                None => (u32::MAX, u32::MAX),
            };
        }
        self.all.fill(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geobench_mesh::generate::generate;
    use geobench_mesh::{Mesh, Numbering};

    fn surface() -> Surface {
        let soup = generate(&"gen:terrain,n=60,seed=2".parse().unwrap()).unwrap();
        let (mesh, _) = Mesh::from_soup(soup).unwrap();
        let numbering = Numbering::along_curve(&mesh);
        Surface::new(&mesh, &numbering)
    }

    /// Windows that come to the faces in `range`, as each thread would get.
    fn counts(split: &Split, range: std::ops::Range<usize>, threads: usize) -> Vec<usize> {
        let mut counts = vec![0; threads];
        for f in range {
            counts[split.owner_of_face(f)] += 1;
        }
        counts
    }

    #[test]
    fn ranges_follow_the_load_and_are_of_one_size_at_first() {
        let surface = surface();
        let faces = surface.faces.len();
        for threads in [1, 2, 3, 7] {
            let mut split = Split::new(&surface, threads);
            split.reset(&surface);
            for range in [0..faces, 400..1400, faces - 900..faces] {
                let mut loads = Vec::new();
                for f in range.clone() {
                    split.note(f, 5);
                }
                split.drain(&mut loads);
                split.learn(&loads);
                if range.len() < faces {
                    split.cut(&surface);
                }
                let counts = counts(&split, range.clone(), threads);
                let equal = range.len() / threads;
                assert!(
                    counts.iter().all(|n| n.abs_diff(equal) <= 10),
                    "{threads} threads, {range:?}: {counts:?}"
                );
                split.cut(&surface);
            }
        }
    }

    #[test]
    fn vertices_go_with_their_faces() {
        let surface = surface();
        let mut split = Split::new(&surface, 3);
        split.reset(&surface);
        let apart = (0..surface.faces.len()).filter(|&f| {
            let owner = split.owner_of_face(f);
            let vertices = surface.faces[f].vertex;
            // The faces of the vertex at a cut are on both sides.
            vertices.iter().all(|&v| split.owner_of_vertex(v) != owner)
                && !split.vertices.iter().any(|v| vertices.contains(v))
        });
        assert_eq!(apart.count(), 0);
    }

    #[test]
    fn whoever_has_more_to_cross_gets_less() {
        let surface = surface();
        let mut split = Split::new(&surface, 2);
        split.reset(&surface);
        let mut last = counts(&split, 1000..2000, 2)[0];
        for step in 0..4 {
            let mut loads = Vec::new();
            (1000..2000).for_each(|f| split.note(f, 9));
            split.drain(&mut loads);
            split.learn(&loads);
            split.compare([3, 1].into_iter());
            split.cut(&surface);
            let now = counts(&split, 1000..2000, 2)[0];
            assert!(step == 0 || now < last, "{now} after {last}");
            last = now;
        }
        assert!((250..400).contains(&last), "{last}");
    }
}
