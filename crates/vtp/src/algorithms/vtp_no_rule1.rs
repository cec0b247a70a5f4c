//! VTP without rule 1, for ablation.
//!
//! Qin et al. 2016, section 6.2. Each window is tried on both exits, without any clipping; the
//! windows' paths are still offered to the apex. Everything else is as in [VTP](super::vtp).
//!
//! On the horse there are 99 % more propagations than in VTP, which is the paper's "saves about 50
//! %"; but a propagation is counted when it is tried, and rule 1 decides a side before trying. Of
//! the windows that come of it, the children, there are 4 % more.
//!
//! **Cost** as VTP. **Keeps** the windows of the wavefront. **Choose it** to see what rule 1 does.

use crate::{AnyExit, ListPropagation, NearestVertex, Neighbours, OrderFree};

/// VTP without rule 1 on one mesh; see [the page](self).
pub type VtpNoRule1 = ListPropagation<NearestVertex, OrderFree, Neighbours, AnyExit>;
