//! The library behind the `geobench` binary.
