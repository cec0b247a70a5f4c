//! VTP on several threads.
//!
//! The same as [`vtp_fast`](super::vtp_fast), with the same kernels and the same switches, on any number of threads.
//!
//! **How.** Every thread runs the loop of `vtp_fast` on its own part of the wavefront: lists cross their faces until none can, then the
//! vertices of its nearest bucket have their turns. Faces and vertices are numbered along a space-filling curve, and each thread has a
//! range of numbers. Blocks of 32 faces and of 16 vertices belong to the thread in whose range they are
//! when a window or a path reaches them, or a face joins, first. The ranges are cut anew every four buckets: by where windows have crossed since, and such
//! that all threads are at work for as long. Then blocks near the wavefront that have come to lie in the range of another thread are handed
//! over to it, with the windows that wait there and the vertices that wait for their turns; without that a cut would tell only when the wave has
//! come through the blocks that are taken, some 16 buckets later. Neighbouring faces belong to the same thread mostly, and 1 to 5 % of the windows go from
//! one to another. They travel by mail, with the paths to vertices and the faces that the wave has reached; every 16 lists a thread
//! looks for letters and sends its own. A letter about a block that its reader has handed over goes on to the new owner.
//!
//! **Why it is exact.** In whatever order windows cross, all that may hold a shortest path do, as in any form of VTP. Distances are seen by
//! all threads, and one that is out of date is too long, which prunes less. Whether a face has joined is seen by all too, and whoever has it
//! join writes to its owner. Nothing else is read but by its owner, and whoever gets a block sees all that was done with it before.
//!
//! **Who waits.** Nobody waits for others until a bucket is done: a thread may be two buckets ahead of the last one, so that what one has more
//! to do in one bucket and less in the next evens out. Whoever gets a letter falls back to where the sender is, for others must
//! not go on without what the letter leads to: they would flood its part of the surface with windows that come too early. So threads do
//! as much work together as one alone within 0.1 % of the windows, and within 1 % if there are more of them than processors.
//!
//! **Why distances may differ in the last bits.** With one thread they are the same from run to run. With several it is a matter of chance which
//! window arrives first, so of paths that are equally long but for rounding one or the other is kept, and a window may be cut by
//! one or the other: distances agree to 1e-12 of their length, and counts to about as much as said above. A form whose threads met at
//! two barriers in each step, so that bits and counts were the same for any number of threads, took longer, since all waited
//! for the slowest in every step and windows that came in a step waited for the next: in turns in one run, least times, on two threads it took
//! 1.0 to 1.1 times as long on models of 70 to 270 thousand faces and 1.2 to 1.45 times on 6 to 13 thousand, and on one 1.04 to 1.25
//! times.
//!
//! **Why no work stealing.** A bucket takes some 50 µs of two threads on a model of 70 thousand faces. The fork and join of a pool, or
//! waking a thread that sleeps, takes tens. Nor could a list be taken by any thread: a window that another processor wrote takes longer to
//! fetch than to cross. For the same reason parts are cut along a curve: to give what is next to another thread's part to whoever
//! had less to do was tried, and three times as many windows travelled. Of parts that are cut along directions from the source seven times as many
//! did: paths run along such a border, and cross it at every face.
//!
//! **Why threads are kept.** The solver has a pool of its own, whose threads sleep between runs and wake where they were. One that is started
//! for a run may begin on the processor of the one that starts it, and stay there for 5 to 15 ms, far longer than a
//! small model takes: the median of such runs was 4 to 6 times that of these, though the least was the same.
//!
//! **Gain.** Two threads on two processors against `vtp_fast`, in turns, by medians: 1.6 to 1.7 on models of 70 to 270 thousand faces, 1.1 to 1.4
//! on 6 to 13 thousand; one thread is 0.8 to 0.98 as fast. To hand parts over gains up to a sixth of that on small models and
//! up to 5 % on large ones. What is lost is waiting, letters, and memory that one thread has written and another one reads.
//!
//! **Cost.** As [`vtp_fast`](super::vtp_fast), and 16 bytes for each face, 8 for each vertex, and 4 for each vertex and thread. Each thread counts
//! its own most windows and most entries of its queue, without letters; what is reported is the sum. Phases are those of the first thread,
//! whose waiting counts as management. More threads than idle processors are slower than one, since all wait for those that have
//! to wait. **Choose it** for large models on a machine that has nothing else to do.

pub use crate::parallel::Pvtp;
