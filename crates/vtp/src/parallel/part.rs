//! The surface as the wave of one thread finds it.

use super::jitter::jitter;
use super::shared::{Distance, Shared};
use crate::engine::face_state::FaceState;
use crate::engine::prefetch::{line, prefetch};
use crate::engine::surface::Surface;
use crate::wave::Field;

/// What a thread keeps of faces and vertices, for itself.
#[derive(Debug)]
pub(super) struct Own {
    faces: Vec<FaceState>,
    /// The length of the path to each vertex whose origin the wave of this thread knows; infinite otherwise.
    reached: Vec<f64>,
    /// Vertices that have had their turns in this wave or are to have them, as far as paths reached them here and they were not given away.
    met: Vec<bool>,
    /// The number of this run.
    run: u8,
}

impl Own {
    pub(super) fn new(surface: &Surface) -> Self {
        Self {
            faces: vec![FaceState::default(); surface.faces.len()],
            reached: vec![f64::INFINITY; surface.vertices.len()],
            met: vec![false; surface.vertices.len()],
            run: 0,
        }
    }

    /// Forgets what the last run has learnt.
    pub(super) fn reset(&mut self) {
        if self.run == u8::MAX {
            self.run = 0;
            self.faces.fill(FaceState::default());
        }
        self.run += 1;
        self.reached.fill(f64::INFINITY);
        self.met.fill(false);
    }
}

/// What threads share and what this one has for itself, at hand without detours.
#[derive(Debug)]
pub(super) struct Part<'a> {
    surface: &'a Surface,
    distances: &'a [Distance],
    /// Whether there is no other thread.
    alone: bool,
    faces: &'a mut [FaceState],
    reached: &'a mut [f64],
    met: &'a mut [bool],
    run: u8,
}

impl<'a> Part<'a> {
    pub(super) fn new(shared: &'a Shared, own: &'a mut Own) -> Self {
        Self {
            surface: &shared.surface,
            distances: &shared.distances,
            alone: shared.threads == 1,
            faces: &mut own.faces,
            reached: &mut own.reached,
            met: &mut own.met,
            run: own.run,
        }
    }
}

impl Part<'_> {
    /// The turn of `v` is up to another thread; returns the length of the path to it that is known, infinite if none is.
    pub(super) fn give_up(&mut self, v: u32) -> f64 {
        self.met[v as usize] = false;
        std::mem::replace(&mut self.reached[v as usize], f64::INFINITY)
    }

    /// The turn of `v` is up to this thread from now on.
    pub(super) fn take_over(&mut self, v: u32) {
        self.met[v as usize] = true;
    }
}

impl Field for Part<'_> {
    const COUNTS_LEVELS: bool = false;

    #[inline(always)]
    fn surface(&self) -> &Surface {
        self.surface
    }

    #[inline(always)]
    fn list(&self, f: usize, corner: usize) -> u32 {
        self.faces[f].list(corner)
    }

    #[inline(always)]
    fn set_list(&mut self, f: usize, corner: usize, list: u32) {
        self.faces[f].set_list(corner, list);
    }

    #[inline(always)]
    fn take_list(&mut self, f: usize, corner: usize) -> u32 {
        self.faces[f].take_list(corner)
    }

    #[inline(always)]
    fn enqueue(&mut self, f: usize, corner: usize) -> bool {
        self.faces[f].enqueue(corner, self.run)
    }

    #[inline(always)]
    fn join(&mut self, f: usize) -> bool {
        self.faces[f].join(self.run)
    }

    #[inline(always)]
    fn distance(&self, v: u32) -> f64 {
        self.distances[v as usize].get()
    }

    /// A vertex that another thread has reached by a shorter path is to have a turn in this wave too, for the lists of this wave
    /// around it.
    #[inline(always)]
    fn offer(&mut self, v: u32, d: f64) -> bool {
        jitter();
        let distance = &self.distances[v as usize];
        let mut nearer = d < distance.get();
        if nearer {
            jitter();
            if self.alone {
                distance.set(d);
            } else {
                nearer = distance.lower(d);
            }
        }
        let met = std::mem::replace(&mut self.met[v as usize], true);
        nearer || !met
    }

    #[inline(always)]
    fn reached(&self, v: u32) -> f64 {
        self.reached[v as usize]
    }

    #[inline(always)]
    fn reach(&mut self, v: u32, d: f64) {
        self.reached[v as usize] = d;
    }

    #[inline(always)]
    fn prefetch_face(&self, f: usize) {
        if let Some(face) = self.surface.faces.get(f) {
            line(face);
            line(&face.apex_x);
        }
        self.prefetch_lists(f);
    }

    #[inline(always)]
    fn prefetch_lists(&self, f: usize) {
        prefetch(self.faces, f);
    }

    #[inline(always)]
    fn prefetch_distance(&self, v: u32) {
        if let Some(distance) = self.distances.get(v as usize) {
            line(distance);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::test_run::{path, saddle, two_threads};
    use geobench_window::{Count, Counter};

    #[test]
    fn a_wave_settles_what_is_shortest_and_what_it_meets_first() {
        let (shared, [mut a, mut b]) = two_threads();
        let (_, mut a) = a.part(&shared);
        let (_, mut b) = b.part(&shared);
        assert!(a.offer(7, 3.0) && !a.offer(7, 3.0) && !a.offer(7, 4.0));
        assert!(b.offer(7, 5.0) && !b.offer(7, 5.0) && b.offer(7, 2.0));
        assert!(a.offer(7, 1.0) && !b.offer(7, 2.0));
        assert_eq!([a.distance(7), b.distance(7)], [1.0; 2]);
    }

    /// The distance of a vertex once was lowered by another thread, and its turn came before it was known by
    /// which path: windows started into the shadow of the old path, and never into that of the new one.
    #[test]
    fn windows_do_not_start_into_the_shadow_of_a_path_that_is_no_longer_the_shortest() {
        let (shared, mut threads) = two_threads();
        let v = saddle(&shared.surface);
        let path = |place, distance| path(&shared.surface, v, place, distance);
        threads[0].find(&shared, path(0, 10.0));
        threads[1].find(&shared, path(2, 9.0));
        assert_eq!(shared.distances[v as usize].get(), 9.0);
        for (thread, bucket, started) in [(0, 10, 0), (1, 9, 1)] {
            let mut count = Count::default();
            let (wave, mut part) = threads[thread].part(&shared);
            wave.take_turn(&mut part, bucket, &mut count);
            let counted = count.counters(&[Counter::PseudoSources]);
            assert_eq!(counted.get(Counter::PseudoSources), Some(started));
        }
        assert_eq!(threads[1].wave.origins[v as usize].h, path(2, 0.0).h);
    }
}
