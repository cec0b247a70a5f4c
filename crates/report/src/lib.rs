//! Shows results of `geobench`.
//!
//! [`history`] compares result files, pools and joins them, and follows records over commits.
//! [`table`] has one table model and one file for each form of it. [`page`] makes a document of
//! results, with charts, and [`claims`] judges what papers claim.

pub mod claims;
pub mod history;
pub mod page;
pub mod table;
