//! VTP on several threads.
//!
//! The same as [`vtp_fast`](super::vtp_fast), with the same kernels and the same switches, on any number of threads.
//! Its distances and counts are the same bits for every number of threads and from run to run.
//!
//! **How.** A run is a sequence of *steps*, in each of which every list that is ready crosses its face and the vertices of the
//! nearest bucket have their turns. A step has two halves:
//!
//! 1. Lists cross, and windows start from pseudo-sources. Distances do not change; what a list finds for its apex is an
//!    offer. A list receives windows from one face only, whose lists cross in a fixed order.
//! 2. Each vertex takes the shortest of its offers; of equally short ones, the one with the least half-edge. Then turns are
//!    taken, whose faces join the traversed area, without waiting until no list can cross: the windows that are left are
//!    few and far behind the front mostly. Where they are not, since faces are small and the front would outrun its windows,
//!    the turn waits a step.
//!
//! So what a step does depends on neither the order of its lists nor on who takes them, and threads may share
//! them in any way. They share the surface: faces and vertices are numbered along a space-filling curve, each thread has a range
//! of numbers, and a face or vertex belongs for the rest of the run to the thread in whose range it is when a window or a path
//! reaches it first. The ranges are cut anew every other step, such that about as many windows come to each; neighbouring faces
//! belong to the same thread mostly, and few windows go from one to another. Those travel by mail: at the end of each
//! half of a step threads meet at a barrier, behind which each finds what the others have for it.
//!
//! **Why no work stealing.** A step takes 45 µs of two threads on a model of 70 thousand faces. Threads
//! that spin meet within 0.2 µs; the fork and join of a pool, or waking a thread that sleeps, takes tens. Nor could
//! a list be taken by any thread: a window that another processor wrote takes longer to fetch than to
//! cross. Handing just what one thread has more than the mean to others in each step was tried, and cost more than it
//! saved. For the same reasons threads are started for each run, for 30 µs, and not kept.
//!
//! **Gain.** Two threads on two processors with AVX-512, against `vtp_fast`: 1.4 on models of 70 and 100 thousand faces, 1.5 on 270 to
//! 330 thousand; one thread is 0.91 to 0.95 as fast. In each step the thread with more to cross has 4 to 6 % more than the mean.
//!
//! **Cost.** As [`vtp_fast`](super::vtp_fast), and 16 bytes for each face and 32 for each vertex. On small models, below some
//! 20 thousand faces, threads wait for each other more than they save; and more threads than idle processors are
//! far slower than one, since all wait for those that have to wait. **Choose it** for large models on a machine
//! that has nothing else to do.

pub use crate::parallel::Pvtp;
