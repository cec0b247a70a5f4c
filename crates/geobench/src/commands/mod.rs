//! The commands: each file has the options of a command, and runs it.

pub(crate) mod algos;
pub(crate) mod certify;
pub(crate) mod claims;
pub(crate) mod cluster;
pub(crate) mod compare;
pub(crate) mod corpus;
pub(crate) mod distance;
pub(crate) mod generate;
pub(crate) mod info;
pub(crate) mod init;
pub(crate) mod isolines;
pub(crate) mod merge;
pub(crate) mod path;
pub(crate) mod pool;
pub(crate) mod record;
pub(crate) mod remesh;
pub(crate) mod report;
pub(crate) mod run;
pub(crate) mod shell;
pub(crate) mod site;
pub(crate) mod suites;
pub(crate) mod trend;
pub(crate) mod verify;
pub(crate) mod voronoi;
