//! The `geobench` command.

mod cli;

use std::alloc::System;
use std::process::ExitCode;

use peakmem_alloc::{INSTRUMENTED_SYSTEM, PeakMemAlloc};

/// Counts heap bytes, for the peak memory of algorithms; see `geobench_harness::measure::memory`.
#[global_allocator]
static ALLOCATOR: &PeakMemAlloc<System> = &INSTRUMENTED_SYSTEM;

fn main() -> ExitCode {
    cli::main()
}
