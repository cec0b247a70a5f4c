//! Distances from one vertex of a model, as lines `vertex,distance`.
//!
//! ```sh
//! cargo run --release -p geodesics --example one_field -- bunny.ply 0 > distances.csv
//! cargo run --release -p geodesics --example one_field -- gen:torus,faces=5000
//! ```

use std::error::Error;
use std::io::{self, BufWriter, Write};

use geodesics::generate::Spec;
use geodesics::{Distances, Mesh};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let model = arguments.next().unwrap_or("gen:sphere".to_owned());
    let source: u32 = arguments.next().unwrap_or("0".to_owned()).parse()?;

    let mesh = if Spec::is_spec(&model) {
        Mesh::generate(&model)?
    } else {
        Mesh::read(&model)?
    };
    let distances = mesh.distances_from(source)?;

    let mut out = BufWriter::new(io::stdout().lock());
    writeln!(out, "vertex,distance")?;
    for (vertex, distance) in distances.iter().enumerate() {
        writeln!(out, "{vertex},{distance}")?;
    }
    Ok(out.flush()?)
}
