//! Operations on several result files (compare, pool, join), and histories over commits.

#[cfg(test)]
mod alarms;
pub mod changes;
pub mod compare;
pub mod gate;
pub mod join;
pub mod order;
pub mod pool;
pub mod records;
pub mod trend;
