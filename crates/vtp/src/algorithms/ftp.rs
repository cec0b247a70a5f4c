//! FTP: face-sorted propagation of whole window lists.
//!
//! Qin et al. 2016, section 5.1. One face at a time joins the traversed area: the one whose far
//! vertex the windows on its border reach on the shortest path. Pseudo-sources have turns of their
//! own in the same queue, by their distances. Everything else is as in [VTP](super::vtp).
//!
//! Keeping the order costs a distance to the far vertex for every window that comes to wait, and
//! three times the insertions into the queue. On the horse it saves a half of the secondary
//! propagations and takes as many children as VTP (0.1 % more) in a third more time; the paper
//! finds 1 % to 5 % fewer propagations and more time.
//!
//! **Cost.** Time O(n²) for n faces in the worst case, apart from the queue of faces; space O(n).
//! **Keeps** the windows of the wavefront. **Choose it** to compare schedules; VTP is faster.

use crate::{ListPropagation, NearestFace, Neighbours, OneAngleTwoSides, OrderFree};

/// FTP on one mesh; see [the page](self).
pub type Ftp = ListPropagation<NearestFace, OrderFree, Neighbours, OneAngleTwoSides>;
