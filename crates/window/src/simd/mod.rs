//! Vector instructions: their names and their detection at run time.

mod instructions;

pub use instructions::{Instructions, UnknownInstructions};
