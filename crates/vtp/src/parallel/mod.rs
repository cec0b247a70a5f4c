//! VTP on several threads.

// The kernels must be inlined into the functions that have the features of the processor.
#![allow(clippy::inline_always)]

mod cross;
mod exchange;
mod field;
mod handover;
mod jitter;
mod mail;
mod owners;
mod pace;
mod padded;
mod settle;
mod spawn;
mod split;
#[cfg(test)]
mod test_run;
mod turn;
mod worker;

use std::sync::{Mutex, PoisonError};

use geobench_mesh::{Mesh, Numbering, VertexId};
use geobench_window::{Counter, Probe, Propagate, Solution, SolveError};
use rayon::{ThreadPool, ThreadPoolBuilder};

use self::field::Field;
use self::owners::MOST_THREADS;
use self::pace::BreakOnPanic;
use self::worker::Worker;
use crate::engine::Instructions;
use crate::engine::dispatch::{self, Program};
use crate::engine::lanes::Lanes;
use crate::engine::surface::Surface;
use crate::fast::Options;

/// VTP on several threads, on one mesh; see [the page](crate::algorithms::pvtp).
#[derive(Debug)]
pub struct Pvtp<'m> {
    mesh: &'m Mesh,
    options: Options,
    numbering: Numbering,
    field: Field,
    workers: Vec<Worker>,
    /// The threads of all workers but the first, which works on the thread of the caller.
    pool: Option<ThreadPool>,
}

impl<'m> Pvtp<'m> {
    /// Sets up for `mesh` and a number of threads, from 1 to 1024, with every improvement; O(faces + threads · vertices).
    ///
    /// To solve from within a task of `rayon` is sound, but the thread may take up another of its tasks while it waits for the others
    /// to end; so a task must not hold a lock meanwhile that others take. Where the system does not start so many threads,
    /// solving is an error.
    pub fn new(mesh: &'m Mesh, threads: usize) -> Self {
        Self::with_options(mesh, threads, Options::default())
    }

    /// The same with other options.
    pub fn with_options(mesh: &'m Mesh, threads: usize, options: Options) -> Self {
        let threads = threads.clamp(1, MOST_THREADS);
        let instructions = options.instructions.or_less();
        let mut numbering = if options.renumber {
            Numbering::along_curve(mesh)
        } else {
            Numbering::same()
        };
        let surface = Surface::new(mesh, &numbering);
        numbering.keep_new_vertices();
        Self {
            mesh,
            options: Options {
                instructions,
                ..options
            },
            numbering,
            workers: workers(threads, &surface, &options),
            field: Field::new(surface, &options, threads),
            pool: pool_of(threads - 1),
        }
    }

    /// The options in force, with instructions that the processor has.
    pub fn options(&self) -> Options {
        self.options
    }

    /// The number of threads.
    pub fn threads(&self) -> usize {
        self.workers.len()
    }
}

fn workers(threads: usize, surface: &Surface, options: &Options) -> Vec<Worker> {
    let bucket = options.bucket * surface.mean_length;
    (0..threads)
        .map(|thread| Worker::new(thread, threads, surface, bucket))
        .collect()
}

/// A pool of so many threads; none if there are to be none, or if the system does not start them.
fn pool_of(threads: usize) -> Option<ThreadPool> {
    let named = ThreadPoolBuilder::new().thread_name(|i| format!("pvtp-{}", i + 1));
    let pool = (threads > 0).then(|| named.num_threads(threads).build());
    pool.and_then(Result::ok)
}

/// What all threads know of a run.
struct Run<'a> {
    field: &'a Field,
    numbering: &'a Numbering,
    sources: &'a [u32],
    instructions: Instructions,
}

impl Run<'_> {
    /// The part of `worker`, with its share of the distances, in the mesh's order.
    fn part(&self, worker: &mut Worker, distances: &mut [f64], probe: &mut impl Probe) {
        if self.field.reunites {
            self.part_with::<true>(worker, distances, probe);
        } else {
            self.part_with::<false>(worker, distances, probe);
        }
    }

    fn part_with<const REUNITE: bool>(
        &self,
        worker: &mut Worker,
        distances: &mut [f64],
        probe: &mut impl Probe,
    ) {
        let part = Part::<_, REUNITE> {
            run: self,
            worker,
            distances,
            probe,
        };
        dispatch::run(part, self.instructions);
    }
}

/// One thread's part of a run.
struct Part<'a, P, const REUNITE: bool> {
    run: &'a Run<'a>,
    worker: &'a mut Worker,
    distances: &'a mut [f64],
    probe: &'a mut P,
}

impl<P: Probe, const REUNITE: bool> Program for Part<'_, P, REUNITE> {
    type Output = ();

    #[allow(unsafe_code)] // For a processor with the instructions of `L`, which only the caller knows.
    #[inline(always)]
    unsafe fn run<L: Lanes>(self) {
        let Run {
            field,
            numbering,
            sources,
            ..
        } = self.run;
        let _guard = BreakOnPanic(&field.pace);
        // SAFETY: promised by the caller.
        unsafe { self.worker.run::<L, P, REUNITE>(field, sources, self.probe) };
        let first = self.worker.share(field, field.vertices.len()).start;
        for (i, distance) in self.distances.iter_mut().enumerate() {
            let v = numbering.new_vertex(VertexId::new((first + i) as u32));
            *distance = field.distance(v.raw());
        }
    }
}

impl Propagate for Pvtp<'_> {
    fn counters() -> Vec<Counter> {
        vec![
            Counter::Propagated,
            Counter::Parents,
            Counter::Children,
            Counter::Spawned,
            Counter::Filtered,
            Counter::PeakWindows,
            Counter::WindowBytes,
            Counter::QueuePushes,
            Counter::QueuePeak,
            Counter::Iterations,
            Counter::PseudoSources,
        ]
    }

    fn mesh(&self) -> &Mesh {
        self.mesh
    }

    fn check(&self) -> Result<(), SolveError> {
        let threads = self.threads();
        if threads > 1 && self.pool.is_none() {
            return Err(SolveError::NoThreads { threads });
        }
        Ok(())
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        if self.field.pace.is_broken() {
            // A probe has panicked, and the caller goes on all the same.
            self.workers = workers(self.threads(), &self.field.surface, &self.options);
            self.field.recover();
        }
        self.field.start();
        probe.add(Counter::WindowBytes, 40);
        let sources: Vec<u32> = sources
            .iter()
            .map(|&s| self.numbering.new_vertex(s).raw())
            .collect();
        let vertices = self.mesh.vertex_count();
        let mut distances = vec![0.0; vertices];
        let field = &self.field;
        let run = Run {
            field,
            numbering: &self.numbering,
            sources: &sources,
            instructions: self.options.instructions,
        };
        let mut rest = distances.as_mut_slice();
        let mut shares = self.workers.iter_mut().map(|worker| {
            let share = worker.share(field, vertices).len();
            let (own, others) = std::mem::take(&mut rest).split_at_mut(share);
            rest = others;
            (worker, own)
        });
        let first = shares.next();
        let others: Vec<_> = shares.map(|share| Mutex::new(Some(share))).collect();
        let run_first = || {
            if let Some((worker, distances)) = first {
                run.part(worker, distances, probe);
            }
        };
        let run_other = |thread: usize| {
            let share = others[thread].lock();
            if let Some((worker, distances)) = share.unwrap_or_else(PoisonError::into_inner).take()
            {
                run.part(worker, distances, &mut ());
            }
        };
        match &self.pool {
            None => run_first(),
            // If one panics, all end, and the panic goes on from here.
            Some(pool) => pool.in_place_scope(|scope| {
                scope.spawn_broadcast(|_, thread| run_other(thread.index()));
                run_first();
            }),
        }
        for worker in &self.workers {
            worker.tally.report(probe);
        }
        Solution::new(distances)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geobench_mesh::generate::generate;
    use geobench_window::Solver;

    /// Whatever one thread does between two steps of another one; see [`jitter`].
    #[test]
    fn delays_at_any_moment_lose_no_path() {
        let soup = generate(&"gen:terrain,n=90,seed=2".parse().unwrap()).unwrap();
        let (mesh, _) = Mesh::from_soup(soup).unwrap();
        let source = [VertexId::new(0)];
        let expected = Pvtp::new(&mesh, 1).solve(&source).unwrap().distances;
        for threads in [2, 3, 5] {
            let mut solver = Pvtp::new(&mesh, threads);
            let mut given = 0;
            for run in 0..20 {
                let distances = solver.solve(&source).unwrap().distances;
                given += solver.workers.iter().map(|w| w.tally.given).sum::<u64>();
                for (v, (d, e)) in distances.iter().zip(&expected).enumerate() {
                    assert!(
                        (d - e).abs() <= 1e-12 * e,
                        "{threads} threads, run {run}, vertex {v}: {d}, expected {e}"
                    );
                }
            }
            assert!(given > 0, "{threads} threads: nothing has changed hands");
        }
    }

    /// More threads than the system starts once ended in a panic.
    #[test]
    fn threads_that_the_system_does_not_start_are_an_error() {
        let soup = generate(&"gen:cube,n=2".parse().unwrap()).unwrap();
        let (mesh, _) = Mesh::from_soup(soup).unwrap();
        let mut solver = Pvtp::new(&mesh, 3);
        solver.pool = None;
        let refused = solver.solve(&[VertexId::new(0)]).unwrap_err();
        assert_eq!(refused, SolveError::NoThreads { threads: 3 });
        assert!(Pvtp::new(&mesh, 1).solve(&[VertexId::new(0)]).is_ok());
    }
}
