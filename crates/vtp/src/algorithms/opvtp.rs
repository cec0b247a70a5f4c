//! OPVTP: [VTP](super::vtp) with order-preserving secondary merges.
//!
//! Qin et al. 2016, sections 5.1 and 5.2. Windows that come to a waiting list after the step in
//! which it formed are put in their places by the left ends of their intervals instead of at one
//! end of the list, so that rules 2 and 3 find more of them beside their neighbours.
//!
//! Only some 1 % of all windows come that late, and the others are in the order of their rays
//! either way. On the horse this costs 0.5 % more children than VTP; the paper finds 0.5 % to 1.4 %
//! fewer on four models and 0.3 % more on a fifth, and like us more time.
//!
//! **Cost** as VTP, and O(k) to put a window into a list of k. **Keeps** what VTP keeps. **Choose
//! it** to repeat the paper's comparison; VTP is faster.

use crate::{ListPropagation, NearestVertex, Neighbours, OneAngleTwoSides, OrderPreserving};

/// OPVTP on one mesh; see [the page](self).
pub type Opvtp = ListPropagation<NearestVertex, OrderPreserving, Neighbours, OneAngleTwoSides>;
