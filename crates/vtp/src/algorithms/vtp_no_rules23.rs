//! VTP without rules 2 and 3, for ablation.
//!
//! Qin et al. 2016, section 6.2. No two windows are compared; the vertex filter and rule 1 alone
//! prune. Everything else is as in [VTP](super::vtp).
//!
//! On the horse there are 55 % more children than in VTP, and as many more propagations: the rules
//! save 36 % of them, "about 30 %" in the paper. The comparisons cost a sixth more time than they
//! save there.
//!
//! **Cost** as VTP. **Keeps** the windows of the wavefront, half as many again as VTP at the peak.
//! **Choose it** to see what rules 2 and 3 do.

use crate::{ListPropagation, NearestVertex, NoPairs, OneAngleTwoSides, OrderFree};

/// VTP without rules 2 and 3 on one mesh; see [the page](self).
pub type VtpNoRules23 = ListPropagation<NearestVertex, OrderFree, NoPairs, OneAngleTwoSides>;
