//! VTP on several threads.
//!
//! The same as [`vtp_fast`](super::vtp_fast), with the same kernels and the same switches, on any number of threads;
//! buckets are twice as wide, so that there is more to divide in a round.
//! Its distances and counts are the same bits for every number of threads and from run to run.
//!
//! **How.** A run is a sequence of *rounds*, in each of which the vertices of the nearest bucket have their turns, and
//! a round of *steps*, in each of which every list that is ready crosses its face. A step has two halves:
//!
//! 1. Lists cross, and windows start from pseudo-sources. Distances do not change; what a list finds for its apex is an
//!    offer. A list receives windows from one face only, whose lists cross in a fixed order.
//! 2. Each vertex takes the shortest of its offers; of equally short ones, the one with the least half-edge. What follows of
//!    it, turns and windows that start, is noted for later.
//!
//! So what a step does depends on neither the order of its lists nor on who takes them, and threads may share
//! them in any way. They share the surface: a face belongs to the thread that brought it into the traversed area, and
//! a vertex to the one that reached it. The vertices of a round are divided anew, as ranges of numbers along
//! a space-filling curve, such that all threads should take as long; neighbouring faces belong to the same thread mostly,
//! and few windows go from one to another. Those travel by mail: at the end of each half of a step threads meet
//! at a barrier, behind which each finds what the others have for it.
//!
//! **Why no work stealing.** A step takes 20 µs on models of 100 thousand faces, and there are thousands of them. Threads
//! that spin meet within 0.2 µs; the fork and join of a pool, or waking a thread that sleeps, takes tens. Nor could
//! a list be taken by any thread: a window that another processor wrote takes longer to fetch than to
//! cross. For the same reasons threads are started for each run, for 30 µs, and not kept.
//!
//! **Gain.** Two threads on two processors with AVX-512 and nothing else to do, against `vtp_fast`: 1.6 on models of 270 to
//! 330 thousand faces, 1.4 on 70 and 100 thousand; one thread is 0.93 as fast. A fifth of the time of two threads goes
//! by at barriers, mostly since a step is not divided evenly.
//!
//! **Cost.** As [`vtp_fast`](super::vtp_fast), and 16 bytes for each face and 32 for each vertex. On small models, below some
//! 20 thousand faces, threads wait for each other more than they save; and more threads than idle processors are
//! far slower than one, since all wait for those that have to wait. **Choose it** for large models on a machine
//! that has nothing else to do.

pub use crate::parallel::Pvtp;
