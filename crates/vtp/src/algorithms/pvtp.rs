//! VTP on several threads.
//!
//! The same as [`vtp_fast`](super::vtp_fast), with the same kernels and the same switches, on any
//! number of threads.
//!
//! **How.** Every thread runs the loop of `vtp_fast` on a part of the *windows*: it has lists and
//! queues of its own for the whole surface, and what comes of its windows stays with it. Two
//! threads may have windows on the same half-edge, which they take across its face each for itself.
//! Shared are the distances: a window is dropped, and a vertex sends windows, by the shortest path
//! that any thread has found. The first thread starts alone. Every four buckets each looks whether
//! its part of the wavefront is likely to take it more than a tenth longer than the mean: by the
//! lists and windows that wait, and by how long turns of so many have taken it so far. If so it
//! gives to the thread that has least: vertices whose turns are to come, with the windows that wait
//! around them. Given away are those that lie, in space, farthest on the side of the thread that
//! gets them, so that the parts of threads lie together; without positions, numbers count as
//! places. On two threads some twenty handoffs are made in a run, with one window in a hundred.
//!
//! **Why it is exact.** In whatever order windows cross, all that may hold a shortest path do, as
//! in any form of VTP. A distance that a thread sees may be out of date, or overwritten by a longer
//! one that another thread found at the same time; it is too long then, which prunes less. Whoever
//! writes a distance keeps it too, or hands it over with the vertex, and mends with it at the end.
//! Of threads that find paths to a vertex one finds the shortest, and knows where it came from:
//! that one, or whoever it gives the vertex to, sends windows from there. Each list waits until one
//! of the vertices of its face has its turn in the thread whose list it is; so a thread that meets
//! a vertex for the first time has a turn of it to come, even if another one has found the shorter
//! path, and a vertex is given away with all windows that wait for it.
//!
//! **Who waits.** A thread may be two buckets ahead of the last one, four of the other one if there
//! are two, so that what one has more to do in one bucket and less in the next evens out; whoever
//! gets a handoff falls back to where the giver is, for others must not go on without what it leads
//! to. Nobody waits for a thread that has not woken up, but for its share of the distances at the
//! end. On two threads 1 % to 4 % of the time is waiting, most on models of some thousand faces.
//! More windows than on one thread cross, since what one knows comes late to the other, by up to 1
//! %, and since half-edges with windows of two threads have two lists, 1 % to 5 % more lists.
//!
//! **Why distances may differ in the last bits.** With one thread they are the same from run to
//! run. With several it is a matter of chance which window arrives first, so of paths that are
//! equally long but for rounding one or the other is kept, and a window may be cut by one or the
//! other: distances agree to 1e-12 of their length, and counts to some percent. A form whose
//! threads met at two barriers in each step, so that bits and counts were the same for any number
//! of threads, took up to 1.45 times as long, since all waited for the slowest in every step.
//!
//! **Why by windows, and not by faces.** A form in which each face belonged to one thread, with
//! windows that travel by mail to the owner of the next face, took 15 to 60 % longer on models of
//! some thousand faces and up to 10 % longer on large ones: letters, a division of the surface that
//! follows the wavefront, and faces that change hands cost more than windows of two threads on one
//! half-edge.
//!
//! **Why threads are kept.** The solver has a pool of its own, whose threads sleep between runs and
//! wake where they were. One that is started for a run may begin on the processor of the one that
//! starts it, and stay there for 5 to 15 ms, far longer than a small model takes: the median of
//! such runs was 4 to 6 times that of these, though the least was the same.
//!
//! **Gain.** Two threads on two processors are 1.65 to 1.9 times as fast as `vtp_fast` on models of
//! 6 to 13 thousand faces and twice as fast on 70 thousand and more, measured while `vtp_fast` runs
//! on both at once; 2 % to 12 % less if it has the machine alone. One thread takes 5 % to 7 %
//! longer than `vtp_fast`.
//!
//! **Cost.** As [`vtp_fast`](super::vtp_fast), for each thread 16 bytes a face and 37 bytes a
//! vertex, and 12 bytes a vertex for where they are. Each thread counts its own most windows, most
//! entries of its queue and turns; what is reported are the sums. Phases are those of the first
//! thread, whose waiting counts as management. More threads than idle processors are slower than as
//! many threads as those, since others wait for what was given to one that does not run. **Choose
//! it** on a machine that has nothing else to do.

pub use crate::parallel::Pvtp;
