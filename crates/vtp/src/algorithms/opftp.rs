//! OPFTP: [FTP](super::ftp) with order-preserving secondary merges.
//!
//! Qin et al. 2016, section 5.1. Windows that come to a waiting list after the step in which it
//! formed are put in their places by the left ends of their intervals, as in [OPVTP](super::opvtp).
//! On the horse this costs 1.1 % more children than FTP.
//!
//! **Cost** as FTP, and O(k) to put a window into a list of k. **Keeps** what FTP keeps. **Choose
//! it** to repeat the paper's comparison; FTP is faster.

use crate::{ListPropagation, NearestFace, Neighbours, OneAngleTwoSides, OrderPreserving};

/// OPFTP on one mesh; see [the page](self).
pub type Opftp = ListPropagation<NearestFace, OrderPreserving, Neighbours, OneAngleTwoSides>;
