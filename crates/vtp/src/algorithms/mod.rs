//! The algorithms that have names, a page each.
//!
//! Figures are those of a horse of 48,485 vertices and 96,966 faces, from vertex 0, as defined in
//! [`geobench_window::Counter`]; the time is of one thread, relative to VTP:
//!
//! | algorithm | propagations | parents | children | prime | secondary | peak windows | time |
//! |---|---|---|---|---|---|---|---|
//! | VTP | 3,004,694 | 2,945,542 | 2,996,224 | 2,969,129 | 35,565 | 14,992 | 1 |
//! | OPVTP | 3,020,296 | 2,960,761 | 3,010,800 | 2,984,797 | 35,499 | 15,036 | 1.1 |
//! | FTP | 3,006,872 | 2,954,265 | 2,999,882 | 2,988,467 | 18,405 | 15,795 | 1.3 |
//! | OPFTP | 3,041,670 | 2,988,448 | 3,033,740 | 3,023,024 | 18,646 | 15,946 | 1.4 |
//! | VTP-Exhaustive | 2,941,150 | 2,898,142 | 2,940,075 | 2,911,862 | 29,288 | 14,776 | 8.5 |
//! | VTP-Trimming | 2,876,773 | 2,818,814 | 2,869,862 | 2,842,703 | 34,070 | 14,275 | 1.5 |
//! | without rule 1 | 5,963,746 | 2,981,873 | 3,121,432 | 5,909,002 | 54,744 | 15,289 | 1.0 |
//! | without rules 2 and 3 | 4,696,425 | 4,594,143 | 4,629,860 | 4,646,166 | 50,259 | 22,746 | 0.8 |
//! | edge-based | 2,995,988 | 2,944,980 | 2,987,619 | 2,966,205 | 29,783 | 14,988 | 1.1 |
//!
//! A *prime* propagation crosses a face that has just joined the traversed area, a *secondary* one
//! a face that had joined before.

pub mod edge_based;
pub mod ftp;
pub mod opftp;
pub mod opvtp;
pub mod pvtp;
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
pub use pvtp::Pvtp;
pub use vtp::Vtp;
pub use vtp_exhaustive::VtpExhaustive;
pub use vtp_fast::VtpFast;
pub use vtp_no_rule1::VtpNoRule1;
pub use vtp_no_rules23::VtpNoRules23;
pub use vtp_trimming::VtpTrimming;
