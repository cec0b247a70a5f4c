//! VTP on several threads.

// Kernels must be inlined into the functions that enable the instructions.
#![allow(clippy::inline_always)]

mod clock;
mod handoff;
mod lag_limit;
mod load_estimate;
mod padded;
mod placement;
mod schedule_fuzz;
mod shared;
#[cfg(test)]
mod test_run;
mod thread_view;
mod worker;

use std::sync::{Mutex, PoisonError};

use geobench_mesh::{Mesh, Numbering, Splice, VertexId};
use geobench_window::simd::{Lanes, Simd, SimdProgram};
use geobench_window::{CompiledRuns, Count, Counter, Probe, Propagate, Solution, SolveError};
use rayon::{ThreadPool, ThreadPoolBuilder};

use self::lag_limit::BreakOnPanic;
use self::placement::Placement;
use self::shared::Shared;
use self::worker::Worker;
use crate::engine::layout::MeshLayout;
use crate::fast::{FastOptions, VtpFast};

/// The largest number of threads.
const MOST_THREADS: usize = 1024;

/// [`VtpFast`] on several threads, on one mesh.
///
/// Distances differ from those of [`VtpFast`] by rounding only. Counts vary from run to run. Time
/// and space are those of [`VtpFast`], over all threads.
///
/// ```
/// use geobench_mesh::Mesh;
/// use geobench_vtp::{Pvtp, VtpFast};
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("terrain,n=8,seed=1")?;
/// let two_threads = Pvtp::new(&mesh, 2).distances_from(5)?;
/// let one = VtpFast::new(&mesh).distances_from(5)?;
/// assert!(two_threads.iter().zip(one).all(|(a, b)| (a - b).abs() <= 1e-12 * b));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Pvtp {
    mesh: Mesh,
    options: FastOptions,
    numbering: Numbering,
    shared: Shared,
    workers: Vec<Worker>,
    /// The threads of all workers but the first, which runs on the caller's thread.
    pool: Option<ThreadPool>,
}

impl Pvtp {
    /// Sets up for `mesh` with every improvement; O(threads · faces). `threads` is clamped to
    /// 1..=1024.
    ///
    /// Solving within a task of `rayon` is sound. But while the thread waits for the others to end,
    /// it may run other tasks of its pool, so the task must not hold a lock that these take. If the
    /// system does not start the threads, solving returns an error.
    pub fn new(mesh: &Mesh, threads: usize) -> Self {
        Self::with_options(mesh, threads, FastOptions::default())
    }

    /// As [`new`](Self::new), with other options.
    pub fn with_options(mesh: &Mesh, threads: usize, options: FastOptions) -> Self {
        let threads = threads.clamp(1, MOST_THREADS);
        let mut numbering = options.numbering(mesh);
        let layout = MeshLayout::new(mesh, &numbering);
        let placement = Placement::new(mesh, &numbering, threads);
        numbering.keep_new_vertices();
        Self {
            mesh: mesh.clone(),
            options: options.available(),
            numbering,
            workers: workers(threads, &layout, &options),
            shared: Shared::new(layout, &options, threads, placement),
            pool: pool_of(threads - 1),
        }
    }

    /// The options in use, with instructions that the processor has.
    pub fn options(&self) -> FastOptions {
        self.options
    }

    /// The number of threads.
    pub fn threads(&self) -> usize {
        self.workers.len()
    }
}

fn workers(threads: usize, layout: &MeshLayout, options: &FastOptions) -> Vec<Worker> {
    (0..threads)
        .map(|thread| Worker::new(thread, layout, options))
        .collect()
}

/// A pool of `threads` threads; `None` if that is 0 or if the system does not start them.
fn pool_of(threads: usize) -> Option<ThreadPool> {
    let named = ThreadPoolBuilder::new().thread_name(|i| format!("pvtp-{}", i + 1));
    let pool = (threads > 0).then(|| named.num_threads(threads).build());
    pool.and_then(Result::ok)
}

/// The data that all threads of a run share.
#[derive(Clone, Copy)]
struct ParallelRun<'a> {
    shared: &'a Shared,
    numbering: &'a Numbering,
    sources: &'a [u32],
    simd: Simd,
}

impl ParallelRun<'_> {
    /// Runs the task of `worker`, and then fills its share of `distances`, in the mesh's order.
    fn task<P: Probe>(self, worker: &mut Worker, distances: &mut [f64], probe: &mut P) {
        if self.shared.coalesces {
            let task = ThreadTask::<P, true> {
                run: self,
                worker,
                distances,
                probe,
            };
            self.simd.run(task);
        } else {
            let task = ThreadTask::<P, false> {
                run: self,
                worker,
                distances,
                probe,
            };
            self.simd.run(task);
        }
    }
}

/// The task of one thread in a run.
struct ThreadTask<'a, P, const COALESCE: bool> {
    run: ParallelRun<'a>,
    worker: &'a mut Worker,
    distances: &'a mut [f64],
    probe: &'a mut P,
}

impl<P: Probe, const COALESCE: bool> SimdProgram for ThreadTask<'_, P, COALESCE> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, simd: L::Token) {
        let ParallelRun {
            shared,
            numbering,
            sources,
            ..
        } = self.run;
        let _guard = BreakOnPanic(&shared.lag);
        self.worker
            .run::<L, P, COALESCE>(simd, shared, sources, self.probe);
        self.worker.repair(shared);
        if !shared.lag.meet() {
            return;
        }
        let first = shared
            .share(self.worker.thread, shared.distances.len())
            .start;
        for (i, distance) in self.distances.iter_mut().enumerate() {
            let v = numbering.new_vertex(VertexId::new((first + i) as u32));
            *distance = shared.distances[v.index()].get();
        }
    }
}

impl Propagate for Pvtp {
    /// Those of [`VtpFast`] without levels: handed-over windows have none.
    fn counters() -> Vec<Counter> {
        let mut all = <VtpFast as Propagate>::counters();
        all.retain(|&counter| counter != Counter::Levels);
        all
    }

    fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    fn splice(&mut self, splice: &Splice) -> Option<Splice> {
        let layout = &mut self.shared.layout;
        let around = layout.around(&self.mesh, &self.numbering, splice);
        let undo = self.mesh.splice(splice);
        layout.splice(&self.mesh, &self.numbering, splice, &around);
        self.shared.splice();
        for worker in &mut self.workers {
            worker.splice(&self.shared.layout);
        }
        Some(undo)
    }

    #[inline(never)]
    fn runs(&self) -> CompiledRuns<Self> {
        CompiledRuns::new()
    }

    fn check(&self) -> Result<(), SolveError> {
        let threads = self.threads();
        if threads > 1 && self.pool.is_none() {
            return Err(SolveError::NoThreads { threads });
        }
        Ok(())
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        if P::TRACES {
            // Origins from several threads would have to be compared, so traced runs use one
            // thread.
            return VtpFast::with_options(&self.mesh, self.options).propagate(sources, probe);
        }
        let others = self.threads() - 1;
        if !P::COUNTS {
            return self.propagate_with(sources, probe, &mut vec![(); others]);
        }
        // Threads reach their peaks at different times. The reported peak is the sum of their
        // peaks, which is an upper bound.
        let mut first = Count::default();
        let mut counts = vec![Count::default(); others];
        let solution = self.propagate_with(sources, &mut first, &mut counts);
        let all = Self::counters();
        counts.push(first);
        for counted in counts.iter().map(|count| count.counters(&all)) {
            for &counter in &all {
                probe.add(counter, counted.get(counter).unwrap_or(0));
            }
        }
        probe.add(Counter::WindowBytes, 40);
        solution
    }
}

impl Pvtp {
    /// As [`propagate`](Propagate::propagate), with separate probes for the first thread and the
    /// others.
    fn propagate_with<P: Probe, Q: Probe + Send>(
        &mut self,
        sources: &[VertexId],
        first: &mut P,
        others: &mut [Q],
    ) -> Solution {
        if self.shared.lag.is_broken() {
            // A probe panicked in the last run, and the caller went on.
            self.workers = workers(self.threads(), &self.shared.layout, &self.options);
            self.shared.recover();
        }
        // Without a pool, the first thread does all work.
        let threads = self.pool.as_ref().map_or(1, |_| self.threads());
        self.shared.start(threads);
        let sources: Vec<u32> = sources
            .iter()
            .map(|&s| self.numbering.new_vertex(s).raw())
            .collect();
        let vertices = self.mesh.vertex_count();
        let mut distances = vec![0.0; vertices];
        let run = ParallelRun {
            shared: &self.shared,
            numbering: &self.numbering,
            sources: &sources,
            simd: Simd::new(self.options.instructions),
        };
        let mut rest = distances.as_mut_slice();
        let mut shares = self.workers.iter_mut().enumerate().map(|(thread, worker)| {
            let share = run.shared.share(thread, vertices).len();
            let (state, others) = std::mem::take(&mut rest).split_at_mut(share);
            rest = others;
            (worker, state)
        });
        let of_first = shares.next();
        let of_others: Vec<_> = shares
            .zip(others)
            .map(|task| Mutex::new(Some(task)))
            .collect();
        let run_first = || {
            if let Some((worker, distances)) = of_first {
                run.task(worker, distances, first);
            }
        };
        let run_other = |thread: usize| {
            let task = of_others[thread].lock();
            let task = task.unwrap_or_else(PoisonError::into_inner).take();
            if let Some(((worker, distances), probe)) = task {
                run.task(worker, distances, probe);
            }
        };
        match &self.pool {
            None => {
                run_first();
                // The other workers only have to fill their shares of the distances.
                (0..of_others.len()).for_each(run_other);
            }
            // If a thread panics, all threads end, and the panic continues in the caller.
            Some(pool) => pool.in_place_scope(|scope| {
                scope.spawn_broadcast(|_, thread| run_other(thread.index()));
                run_first();
            }),
        }
        Solution::new(distances)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geobench_mesh::generate::generate;
    use geobench_window::Solver;

    /// Threads are delayed at random between steps; see [`schedule_fuzz`].
    #[test]
    fn delays_at_any_moment_lose_no_path() {
        let soup = generate(&"gen:terrain,n=90,seed=2".parse().unwrap()).unwrap();
        let (mesh, _) = Mesh::from_soup(soup).unwrap();
        let source = [VertexId::new(0)];
        let expected = Pvtp::new(&mesh, 1).solve(&source).unwrap().distances;
        for threads in [2, 3, 5] {
            let mut solver = Pvtp::new(&mesh, threads);
            let (mut run, mut given) = (0, 0);
            // Nothing changes hands where the system gives the other threads no turn.
            while run < 20 || given == 0 && run < 10_000 {
                let distances = solver.solve(&source).unwrap().distances;
                given += solver.workers.iter().map(|w| w.given).sum::<usize>();
                for (v, (d, e)) in distances.iter().zip(&expected).enumerate() {
                    assert!(
                        (d - e).abs() <= 1e-12 * e,
                        "{threads} threads, run {run}, vertex {v}: {d}, expected {e}"
                    );
                }
                run += 1;
            }
            assert!(given > 0, "{threads} threads: nothing has changed hands");
        }
    }

    /// Windows wound around a needle thousands of times too often when another thread had the
    /// straight ones.
    #[test]
    fn a_surface_with_a_needle_stays_with_one_thread() {
        let soup = generate(&"gen:terrain,n=90,seed=2".parse().unwrap()).unwrap();
        let (terrain, _) = Mesh::from_soup(soup).unwrap();
        let mut positions = terrain.positions().to_vec();
        let corners = |f| terrain.face_vertices(f).map(|v| v.index() as u32);
        let mut faces: Vec<[u32; 3]> = terrain.faces().map(corners).collect();
        // A needle of three sides beside the terrain.
        let first = positions.len() as u32;
        let far = 1e3;
        positions.extend([
            [far, 0.0, 0.0],
            [far + 0.01, 0.0, 0.0],
            [far, 0.01, 0.0],
            [far, 0.0, 1.0],
        ]);
        faces.extend([[0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|face| face.map(|v| first + v)));
        let mesh = Mesh::new(positions, faces).unwrap();
        let mut solver = Pvtp::new(&mesh, 2);
        for _ in 0..20 {
            solver.solve(&[VertexId::new(0)]).unwrap();
            assert_eq!(solver.workers.iter().map(|w| w.given).sum::<usize>(), 0);
        }
    }

    /// More threads than the system starts once caused a panic.
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
