//! Writes the distances of the zoo's slow models, computed in double-double, to `data/`.
//!
//! `cargo run --release -p geobench-oracle --example make_reference [PART OF A NAME]`
//!
//! With an argument, only the models whose names contain it.

use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::Instant;
use std::{env, fs, io};

use geobench_oracle::{DoubleDouble, distances, reference, rounded, zoo};

fn main() -> io::Result<()> {
    let wanted = env::args().nth(1).unwrap_or_default();
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    fs::create_dir_all(&directory)?;
    for model in zoo::slow() {
        if !model.name.contains(&wanted) {
            continue;
        }
        let path = directory.join(reference::file_name(&model));
        let mut file = BufWriter::new(fs::File::create(&path)?);
        writeln!(file, "source,vertex,distance")?;
        let surface = model.surface::<DoubleDouble>();
        let start = Instant::now();
        for &source in &model.sources[..reference::SOURCES] {
            let found = rounded(&distances(&surface, &[source]));
            for (vertex, distance) in found.iter().enumerate() {
                writeln!(file, "{source},{vertex},{distance:?}")?;
            }
        }
        file.flush()?;
        eprintln!("{}: {:.1} s", path.display(), start.elapsed().as_secs_f64());
    }
    Ok(())
}
