//! The compiled part of the Python package `geodesics`. The rest is in `python/geodesics`.
//!
//! Arrays of the caller are copied once, distances are returned without a copy. Long calls release
//! the lock of the interpreter and end on Ctrl-C (`interrupt`).

use std::alloc::System;

use peakmem_alloc::{INSTRUMENTED_SYSTEM, PeakMemAlloc};
use pyo3::prelude::*;

mod algorithm;
mod arrays;
mod bench;
mod certificate;
mod curve;
mod errors;
mod field;
mod from_arrays;
mod interrupt;
mod isolines;
mod location;
mod making;
mod mesh;
mod path;
mod points;
mod pool;
mod solver;
mod voronoi;

/// Counts bytes on the heap for the memory figures of `run`, as the command line does.
#[global_allocator]
static ALLOCATOR: &PeakMemAlloc<System> = &INSTRUMENTED_SYSTEM;

// Classes are frozen, and what they share is behind locks, so that free-threaded interpreters need
// no lock of their own.
#[pymodule(name = "_core", gil_used = false)]
fn core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    // Load NumPy and its C interface now. A Ctrl-C while they are loaded on first use would cause a
    // panic.
    py.import("numpy")?;
    numpy::PyArray1::<f64>::from_vec(py, Vec::new());
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("MeshError", py.get_type::<errors::MeshError>())?;
    module.add(
        "PrecisionWarning",
        py.get_type::<errors::PrecisionWarning>(),
    )?;
    module.add_class::<mesh::PyMesh>()?;
    module.add_class::<solver::PySolver>()?;
    module.add_class::<field::PyField>()?;
    module.add_class::<points::PyPoint>()?;
    module.add_class::<curve::PyCurve>()?;
    module.add_class::<path::PyPath>()?;
    module.add_class::<voronoi::PyVoronoi>()?;
    module.add_class::<voronoi::PyCell>()?;
    module.add_class::<voronoi::PyArc>()?;
    module.add_class::<voronoi::PyVoronoiVertex>()?;
    module.add_class::<certificate::PyCertificate>()?;
    module.add_class::<isolines::PyIsoline>()?;
    module.add_class::<isolines::PyLine>()?;
    module.add_function(wrap_pyfunction!(making::read, module)?)?;
    module.add_function(wrap_pyfunction!(making::generated, module)?)?;
    module.add_function(wrap_pyfunction!(points::vertex, module)?)?;
    module.add_function(wrap_pyfunction!(points::edge, module)?)?;
    module.add_function(wrap_pyfunction!(points::face, module)?)?;
    module.add_function(wrap_pyfunction!(points::at, module)?)?;
    module.add_function(wrap_pyfunction!(solver::algorithms, module)?)?;
    module.add_function(wrap_pyfunction!(certificate::certify, module)?)?;
    module.add_function(wrap_pyfunction!(bench::run_to_json, module)?)?;
    // They make pickled objects anew.
    module.add_function(wrap_pyfunction!(making::_mesh, module)?)?;
    module.add_function(wrap_pyfunction!(points::_point, module)?)?;
    module.add_function(wrap_pyfunction!(solver::_solver, module)?)?;
    module.add_function(wrap_pyfunction!(field::_field, module)?)?;
    module.add_function(wrap_pyfunction!(path::_path, module)?)?;
    module.add_function(wrap_pyfunction!(voronoi::_voronoi, module)?)?;
    module.add_function(wrap_pyfunction!(certificate::_certificate, module)?)?;
    Ok(())
}
