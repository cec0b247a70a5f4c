//! Files of what `geobench` computes on a mesh, and pictures of it.
//!
//! A [`FileFormat`] is chosen by the ending of a file's name: [`distances`] as CSV, JSON, NPY, PLY,
//! VTK or VTP, [`paths`] and [`isolines`] as lines, Voronoi [`diagrams`], and a [`picture`] of each
//! as SVG or PNG. An [`output::OutputFile`] is checked before the work starts and replaced whole.

pub mod diagrams;
pub mod distances;
pub mod escape;
mod format;
pub mod isolines;
mod label;
pub mod output;
pub mod paths;
pub mod picture;
mod polylines;
pub mod svg;
pub mod temporary;
mod vtk_xml;

pub(crate) use format::json_line;
pub use format::{
    FileFormat, STANDARD, UnknownEnding, ending_of, json_lines, no_coordinates,
    set_standard_output_form,
};
pub use label::SourceLabel;
pub use polylines::LineFormat;
