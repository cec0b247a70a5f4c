//! VTP-Exhaustive: [VTP](super::vtp) that checks every pair of windows.
//!
//! Qin et al. 2016, section 6.2, and all of cases 1 to 12 of section 3. One full sweep, when a list
//! is about to cross:
//!
//! * every pair of its windows is compared, not only neighbours (cases 1 to 6);
//! * no ray crosses the path to the apex of *any* window of the list that is shorter than its own
//!   window's, where rule 1 looks at the shortest one only (cases 7 to 10);
//! * no ray crosses a shorter path across the face to one of its other vertices, by windows that
//!   wait at the other two half-edges of the face or have come through them before (case 11).
//!
//! Cases 8 and 10 as printed delete more than is proved: rays that the shorter path need not cross.
//! Here they take the form that rule 1 has in VTP.
//!
//! On the horse all this saves 2 % of the children of VTP, and takes eight times as long, for
//! windows are compared one by one here and eight at a time in VTP. The paper finds 3 % to 5 %
//! fewer propagations in 5 to 30 times the time: neighbours do nearly all.
//!
//! **Cost.** Time O(k²) for a list of k windows, O(n³) for n faces in the worst case; space O(n).
//! **Keeps** the windows of the wavefront, and one length for each half-edge. **Choose it** to see
//! how little there is left to prune.

use crate::{AllPairs, EveryPath, ListPropagation, NearestVertex, OrderFree};

/// VTP-Exhaustive on one mesh; see [the page](self).
pub type VtpExhaustive = ListPropagation<NearestVertex, OrderFree, AllPairs, EveryPath>;
