//! Shows results of `geobench`.
//!
//! [`history`] compares result files, pools and joins them, and follows records over commits.
//! [`table`] has one table model and one file for each form of it. [`page`] makes a document of
//! results, with charts, and [`claims`] judges what papers claim. [`site`] makes a static site of
//! many results, and [`corpus`] names the models that it compares them on.

pub mod claims;
pub mod corpus;
pub mod history;
pub mod page;
pub mod site;
pub mod table;
