//! Mesh files: what is read from them, what is refused and how, and that nothing is lost.

mod arrays;
mod bounds;
mod damage;
mod errors;
mod forms;
mod fuzz;
mod good;
mod models;
#[path = "../processor_time/mod.rs"]
mod processor_time;
mod round_trip;
mod samples;
mod scene_samples;
mod scenes;

use std::alloc::System;
use std::io::Write;
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;
use geobench_mesh::TriangleSoup;
use geobench_mesh::io::{FileError, Format, ObjReader, ReadOptions, read_bytes};
use peakmem_alloc::{INSTRUMENTED_SYSTEM, PeakMemAlloc};

/// Counts the memory that readers take.
#[global_allocator]
static ALLOCATOR: &PeakMemAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Reads a file that exists only in memory, under the name `test`.
fn parse(format: Format, bytes: impl AsRef<[u8]>) -> Result<TriangleSoup, FileError> {
    read_bytes(bytes.as_ref(), format, Path::new("test"))
}

/// Asserts that a file is refused with a message that has these words.
#[track_caller]
fn fails(format: Format, bytes: impl AsRef<[u8]>, words: &str) {
    let error = parse(format, bytes).unwrap_err().to_string();
    assert!(error.contains(words), "{error}");
}

/// Reads an OBJ file, which may be compressed, with the second reader.
fn tobj(bytes: impl AsRef<[u8]>) -> Result<TriangleSoup, FileError> {
    let options = ReadOptions {
        max_decompressed: Some(1 << 20),
        obj_reader: ObjReader::Tobj,
        weld: None,
    };
    options.read_bytes(bytes.as_ref(), Format::Obj, Path::new("test"))
}

/// Compresses `bytes`.
fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}
