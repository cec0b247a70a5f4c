//! The algorithms that have names, a page each.
//!
//! Figures are those of a horse of 48,485 vertices and 96,966 faces, from vertex 0, as defined in
//! [`geobench_window::Counter`]; the time is of one thread, relative to VTP:
//!
//! | algorithm | propagations | parents | children | prime | secondary | peak windows | time |
//! |---|---|---|---|---|---|---|---|
//! | VTP | 2,997,733 | 2,938,889 | 2,989,896 | 2,962,220 | 35,513 | 14,981 | 1 |
//! | OPVTP | 3,009,335 | 2,950,081 | 3,001,665 | 2,973,906 | 35,429 | 15,020 | 1.0 |
//! | FTP | 2,999,552 | 2,947,257 | 2,993,301 | 2,981,189 | 18,363 | 15,784 | 1.2 |
//! | OPFTP | 3,033,734 | 2,980,815 | 3,026,550 | 3,015,232 | 18,502 | 15,911 | 1.2 |
//! | VTP-Exhaustive | 2,940,408 | 2,897,398 | 2,939,578 | 2,911,120 | 29,288 | 14,772 | 4.1 |
//! | VTP-Trimming | 2,876,561 | 2,818,612 | 2,869,833 | 2,842,487 | 34,074 | 14,276 | 1.5 |
//! | without rule 1 | 5,953,842 | 2,976,921 | 3,116,234 | 5,899,152 | 54,690 | 15,289 | 1.0 |
//! | without rules 2 and 3 | 4,694,048 | 4,596,918 | 4,632,776 | 4,643,755 | 50,293 | 22,762 | 0.8 |
//! | edge-based | 2,989,085 | 2,938,354 | 2,981,332 | 2,959,336 | 29,749 | 14,978 | 1.1 |
//!
//! A *prime* propagation crosses a face that has just joined the traversed area, a *secondary* one
//! a face that had joined before.

pub mod edge_based;
pub mod ftp;
pub mod opftp;
pub mod opvtp;
pub mod vtp;
pub mod vtp_exhaustive;
pub mod vtp_fast;
pub mod vtp_no_rule1;
pub mod vtp_no_rules23;
pub mod vtp_trimming;

pub use edge_based::EdgeBased;
pub use ftp::Ftp;
pub use opftp::Opftp;
pub use opvtp::Opvtp;
pub use vtp::Vtp;
pub use vtp_exhaustive::VtpExhaustive;
pub use vtp_fast::VtpFast;
pub use vtp_no_rule1::VtpNoRule1;
pub use vtp_no_rules23::VtpNoRules23;
pub use vtp_trimming::VtpTrimming;
