//! `geobench gen`.

use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::Args;
use geobench_export::output::{OutputFile, check_files};
use geobench_export::{STANDARD, ending_of};
use geobench_harness::exec::model::ModelRef;
use geobench_harness::plan::suite::options::DecompressionOption;
use geobench_mesh::io as mesh_io;

use crate::args::QuietOption;
use crate::progress::TaskBar;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
#[command(after_long_help = geobench_mesh::generate::help())]
pub(crate) struct GenOptions {
    /// NAME[,key=value...], such as torus,faces=50000,bump=0.1,seed=7
    #[arg(value_name = "SPEC")]
    pub(crate) spec: String,

    #[command(flatten)]
    pub(crate) decompression: DecompressionOption,

    /// File to write: .obj, .ply, .off or .stl, each also .gz
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,

    #[command(flatten)]
    quiet: QuietOption,
}

/// Extensions of the mesh files that can be written.
const ENDINGS: [&str; 8] = [
    ".obj", ".ply", ".off", ".stl", ".obj.gz", ".ply.gz", ".off.gz", ".stl.gz",
];

pub(crate) fn generate(options: &GenOptions) -> anyhow::Result<Verdict> {
    let ending = ending(&options.output)?;
    let output = OutputFile::prepare(&options.output)?;
    let model = ModelRef::generated(&options.spec)?;
    check_files([&output], model.source_file())?;
    let is_shown = !options.quiet.is_set && options.output != Path::new(STANDARD);
    let bar = TaskBar::new(&format!("{}: vertices and faces", model.path), 2, is_shown);
    let soup = model.read(options.decompression.limit())?;
    bar.done();
    output.write_with(ending, |path| Ok(mesh_io::write(path, &soup)?))?;
    Ok(Verdict::Passed)
}

/// The extension of a mesh file to write, which determines its format.
///
/// # Errors
///
/// If meshes cannot be written in a file with this extension.
pub(crate) fn ending(path: &Path) -> anyhow::Result<&'static str> {
    let (name, how) = if path == Path::new(STANDARD) {
        (format!(".{}", ending_of(path)), "--output-format")
    } else {
        (path.to_string_lossy().to_lowercase(), "the ending")
    };
    match ENDINGS.iter().find(|ending| name.ends_with(*ending)) {
        Some(ending) => Ok(ending),
        None => bail!(
            "{}: {how} says in which form to write a model; use .obj, .ply, .off or .stl, each also with .gz",
            path.display()
        ),
    }
}
