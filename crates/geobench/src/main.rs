//! The `geobench` command.

fn main() {}
