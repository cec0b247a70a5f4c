//! VTP-Trimming: [VTP](super::vtp) with overlaps cut at tie points.
//!
//! Qin et al. 2016, section 6.2. Where neighbours in a list overlap, each keeps exactly the range
//! on which it is shorter, as in MMP; their tie points are the roots of a quadratic equation
//! ([`geobench_window::tie_points`]), which VTP avoids. As in the procedure of Mitchell, Mount and
//! Papadimitriou (1987), the ends of the overlap are compared first, which may cut more than the
//! overlap: the rays that a shorter path crosses before the edge. Neighbours apart from each other
//! are compared as in VTP (cases 3 and 6).
//!
//! On the horse it saves 4 % of the children of VTP and takes half as long again; the paper finds 3
//! % to 5 % fewer propagations and 10 % to 45 % more time. With ties alone, without the comparison
//! at the ends, there are 2 % *more* children than in VTP.
//!
//! **Cost** as VTP. **Keeps** the windows of the wavefront. **Choose it** to weigh trimming against
//! pruning; VTP is faster.

use crate::{ListPropagation, NearestVertex, OneAngleTwoSides, OrderFree, TiePoints};

/// VTP-Trimming on one mesh; see [the page](self).
pub type VtpTrimming = ListPropagation<NearestVertex, OrderFree, TiePoints, OneAngleTwoSides>;
