//! The shortest path between two vertices of a model, as lines `x,y,z`.
//!
//! ```sh
//! cargo run --release -p geodesics --example path -- bunny.ply 0 17 > path.csv
//! cargo run --release -p geodesics --example path -- gen:torus,faces=5000
//! ```

use std::error::Error;
use std::io::{self, BufWriter, Write};

use geodesics::generate::Spec;
use geodesics::{Distances, Mesh};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let model = arguments.next().unwrap_or("gen:sphere".to_owned());
    let source: u32 = arguments.next().unwrap_or("0".to_owned()).parse()?;
    let target: u32 = arguments.next().unwrap_or("17".to_owned()).parse()?;

    let mesh = if Spec::is_spec(&model) {
        Mesh::generate(&model)?
    } else {
        Mesh::read(&model)?
    };
    let path = mesh.path(source, target)?;
    let path = path.ok_or_else(|| format!("no path leads from {source} to {target}"))?;

    let mut out = BufWriter::new(io::stdout().lock());
    writeln!(out, "x,y,z")?;
    for [x, y, z] in path.polyline(&mesh) {
        writeln!(out, "{x},{y},{z}")?;
    }
    Ok(out.flush()?)
}
