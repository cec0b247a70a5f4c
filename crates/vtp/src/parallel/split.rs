//! Who gets which part of the surface.

use std::mem;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::atomic::{AtomicU32, AtomicU64};
use std::sync::{Mutex, PoisonError};

use super::padded::Padded;
use crate::engine::surface::Surface;

/// Parts of the surface whose loads are counted, at most.
const PARTS: usize = 512;

/// What a list that is taken across a face costs besides its windows, in windows.
const LIST: u32 = 16;

/// Buckets after which the surface is divided anew.
const BUCKETS: u32 = 4;

/// How much of the shares that differ from an equal one is kept from one division to the next, and how much a time that
/// differs from the mean adds to them.
const KEPT: f64 = 0.9;
const GAIN: f64 = 0.2;

/// Cuts the surface into ranges of its faces, one for each thread, of about the same load.
///
/// Numbers follow a space-filling curve, so that a range is a part of the surface in one piece or a few. The wave
/// comes to faces that nobody has yet, near those that lists cross now. So parts of the surface count the windows that cross them,
/// and ranges are cut such that all had as many since the last time. Lists do not cost the same everywhere, nor are processors
/// equally fast; so whoever has worked longer than others gets a lesser share.
#[derive(Debug)]
pub(super) struct Split {
    /// Faces of a part, as a power of 2.
    shift: u32,
    /// What each thread has counted in each part in this run.
    counts: Vec<Vec<AtomicU32>>,
    /// How long each thread has worked in this run, in nanoseconds.
    busy: Vec<Padded<AtomicU64>>,
    /// The first face of each range but the first, and its first vertex.
    faces: Vec<AtomicU32>,
    vertices: Vec<AtomicU32>,
    divider: Mutex<Divider>,
    /// How often it has been divided anew.
    divisions: AtomicU32,
}

/// What is known of the last division.
#[derive(Debug)]
struct Divider {
    /// The bucket at which it was.
    bucket: u32,
    /// What had been counted, and what has been since.
    counted: Vec<u32>,
    loads: Vec<u64>,
    /// How long each thread had worked, and has since.
    busy: Vec<u64>,
    worked: Vec<u64>,
    /// By how much the share of each thread is to exceed an equal one, relatively.
    excess: Vec<f64>,
}

impl Split {
    pub(super) fn new(surface: &Surface, threads: usize) -> Self {
        let faces = surface.faces.len();
        let shift = (faces / PARTS).checked_ilog2().map_or(0, |log| log + 1);
        let parts = if threads > 1 { (faces >> shift) + 1 } else { 0 };
        let numbers = |n: usize| (0..n).map(|_| AtomicU32::new(0)).collect();
        Self {
            shift,
            counts: (0..threads).map(|_| numbers(parts)).collect(),
            busy: (0..threads).map(|_| Padded::default()).collect(),
            faces: numbers(threads - 1),
            vertices: numbers(threads - 1),
            divider: Mutex::new(Divider {
                bucket: 0,
                counted: vec![0; parts],
                loads: vec![0; parts],
                busy: vec![0; threads],
                worked: vec![0; threads],
                excess: vec![0.0; threads],
            }),
            divisions: AtomicU32::new(0),
        }
    }

    /// Starts a run, with ranges of the same size.
    pub(super) fn reset(&mut self, surface: &Surface) {
        for counts in &mut self.counts {
            counts.fill_with(AtomicU32::default);
        }
        self.busy.fill_with(Padded::default);
        let mut divider = self.divider.lock().unwrap_or_else(PoisonError::into_inner);
        divider.bucket = 0;
        divider.counted.fill(0);
        divider.loads.fill(1);
        divider.busy.fill(0);
        divider.excess.fill(0.0);
        self.cut(surface, &divider);
    }

    /// How often the surface has been divided anew, in all runs; it starts again from 0 after 2³² times.
    pub(super) fn divisions(&self) -> u32 {
        self.divisions.load(Relaxed)
    }

    /// In whose range a face is: who gets it if it is nobody's, and whom it is given to if it is near the wavefront.
    pub(super) fn owner_of_face(&self, f: usize) -> usize {
        let mut cuts = self.faces.iter();
        let first_beyond = cuts.position(|cut| cut.load(Relaxed) as usize > f);
        first_beyond.unwrap_or(self.faces.len())
    }

    /// In whose range a vertex is, as for a face.
    pub(super) fn owner_of_vertex(&self, v: u32) -> usize {
        let first_beyond = self.vertices.iter().position(|cut| cut.load(Relaxed) > v);
        first_beyond.unwrap_or(self.vertices.len())
    }

    /// `thread` takes so many windows across a face.
    #[inline(always)]
    pub(super) fn note(&self, thread: usize, f: usize, windows: usize) {
        if let Some(count) = self.counts[thread].get(f >> self.shift) {
            // Nobody else writes there.
            count.store(
                count.load(Relaxed).wrapping_add(windows as u32 + LIST),
                Relaxed,
            );
        }
    }

    /// `thread` has come to a bucket, and has worked for so many nanoseconds. Divides anew if it is time to, unless another
    /// thread is about to.
    pub(super) fn come_to(&self, thread: usize, bucket: u32, busy: u64, surface: &Surface) {
        self.busy[thread].0.store(busy, Relaxed);
        let Ok(mut divider) = self.divider.try_lock() else {
            return;
        };
        if bucket < divider.bucket.saturating_add(BUCKETS) {
            return;
        }
        divider.bucket = bucket;
        divider.count(&self.counts);
        divider.compare(self.busy.iter().map(|busy| busy.0.load(Relaxed)));
        self.cut(surface, &divider);
        self.divisions.fetch_add(1, Relaxed);
    }

    /// Cuts anew.
    fn cut(&self, surface: &Surface, Divider { loads, excess, .. }: &Divider) {
        let total: u64 = loads.iter().sum();
        if total == 0 {
            return;
        }
        let shares = 1.0 / (excess.len() as f64 + excess.iter().sum::<f64>());
        let (mut part, mut before, mut share) = (0, 0, 0.0);
        for ((face_cut, vertex_cut), excess) in self.faces.iter().zip(&self.vertices).zip(excess) {
            share += (1.0 + excess) * shares;
            #[allow(clippy::cast_sign_loss)] // No share is negative.
            let wanted = (total as f64 * share) as u64;
            while part + 1 < loads.len() && before + loads[part] < wanted {
                before += loads[part];
                part += 1;
            }
            // The load of a part is taken as spread evenly over it.
            let within = ((wanted - before) << self.shift).checked_div(loads[part]);
            let face = (part << self.shift) + within.unwrap_or(0) as usize;
            let (face, vertex) = match surface.faces.get(face) {
                // The vertex along whose part of the curve the face was numbered; without a curve, any.
                Some(first) => {
                    let [a, b, c] = first.vertex;
                    (face as u32, a.min(b).min(c))
                }
                None => (u32::MAX, u32::MAX),
            };
            face_cut.store(face, Relaxed);
            vertex_cut.store(vertex, Relaxed);
        }
    }
}

impl Divider {
    /// Learns what has been counted since the last division.
    fn count(&mut self, counts: &[Vec<AtomicU32>]) {
        for (part, (counted, load)) in self.counted.iter_mut().zip(&mut self.loads).enumerate() {
            let counts = counts.iter().map(|counts| counts[part].load(Relaxed));
            let now = counts.fold(0, u32::wrapping_add);
            *load = u64::from(now.wrapping_sub(mem::replace(counted, now)));
        }
    }

    /// Learns how long the threads have worked in all, and so since the last division.
    fn compare(&mut self, busy: impl Iterator<Item = u64>) {
        for ((before, worked), now) in self.busy.iter_mut().zip(&mut self.worked).zip(busy) {
            *worked = now.saturating_sub(mem::replace(before, now));
        }
        let mean = self.worked.iter().sum::<u64>() as f64 / self.worked.len() as f64;
        if mean == 0.0 {
            return;
        }
        for (excess, &worked) in self.excess.iter_mut().zip(&self.worked) {
            let lacks = 1.0 - worked as f64 / mean;
            *excess = (*excess * KEPT + lacks * GAIN).clamp(-0.5, 0.5);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geobench_mesh::generate::generate;
    use geobench_mesh::{Mesh, Numbering};
    use std::ops::Range;

    fn surface() -> Surface {
        let soup = generate(&"gen:terrain,n=60,seed=2".parse().unwrap()).unwrap();
        let (mesh, _) = Mesh::from_soup(soup).unwrap();
        let numbering = Numbering::along_curve(&mesh);
        Surface::new(&mesh, &numbering)
    }

    /// How many of the faces in `range` each thread would get.
    fn faces(split: &Split, range: Range<usize>, threads: usize) -> Vec<usize> {
        let mut faces = vec![0; threads];
        for f in range {
            faces[split.owner_of_face(f)] += 1;
        }
        faces
    }

    #[test]
    fn ranges_follow_the_load_and_are_of_one_size_at_first() {
        let surface = surface();
        let all = surface.faces.len();
        for threads in [1, 2, 3, 7] {
            let mut split = Split::new(&surface, threads);
            for range in [0..all, 400..1400, all - 900..all] {
                split.reset(&surface);
                if range.len() < all {
                    // Whoever counts. Nothing has been counted since when it is divided once more.
                    for f in range.clone() {
                        split.note(f % threads, f, 5);
                    }
                    for bucket in [BUCKETS - 1, BUCKETS, 3 * BUCKETS] {
                        split.come_to(threads - 1, bucket, 0, &surface);
                    }
                }
                let faces = faces(&split, range.clone(), threads);
                let equal = range.len() / threads;
                assert!(
                    faces.iter().all(|n| n.abs_diff(equal) <= 20),
                    "{threads} threads, {range:?}: {faces:?}"
                );
            }
        }
    }

    #[test]
    fn vertices_go_with_their_faces() {
        let surface = surface();
        let split = {
            let mut split = Split::new(&surface, 3);
            split.reset(&surface);
            split
        };
        let cuts: Vec<_> = split.vertices.iter().map(|v| v.load(Relaxed)).collect();
        let apart = (0..surface.faces.len()).filter(|&f| {
            let owner = split.owner_of_face(f);
            let vertices = surface.faces[f].vertex;
            // The faces of the vertex at a cut are on both sides.
            vertices.iter().all(|&v| split.owner_of_vertex(v) != owner)
                && !cuts.iter().any(|v| vertices.contains(v))
        });
        assert_eq!(apart.count(), 0);
    }

    #[test]
    fn whoever_has_worked_longer_gets_less() {
        let surface = surface();
        let mut split = Split::new(&surface, 2);
        split.reset(&surface);
        let mut last = faces(&split, 1000..2000, 2)[0];
        for step in 1..5 {
            (1000..2000).for_each(|f| split.note(0, f, 9));
            split.come_to(1, BUCKETS * step - 1, 1000 * u64::from(step), &surface);
            split.come_to(0, BUCKETS * step, 3000 * u64::from(step), &surface);
            let now = faces(&split, 1000..2000, 2)[0];
            assert!(step == 1 || now < last, "{now} after {last}");
            last = now;
        }
        assert!((250..400).contains(&last), "{last}");
    }
}
