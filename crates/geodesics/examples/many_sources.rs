//! Distances from many vertices in parallel: each solver is set up once and asked again and again.
//!
//! It prints the diameter of a model as far as its sources see it.
//!
//! ```sh
//! cargo run --release -p geodesics --example many_sources -- gen:torus,faces=5000 100
//! ```

use std::error::Error;

use geodesics::{Mesh, SolveError, Solver, VtpFast};
use rayon::prelude::*;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let model = arguments.next().unwrap_or("gen:sphere".to_owned());
    let count: usize = arguments.next().unwrap_or("20".to_owned()).parse()?;

    let mesh = Mesh::generate(&model)?;
    let step = (mesh.vertex_count() / count.max(1)).max(1);
    let sources: Vec<u32> = (0..mesh.vertex_count() as u32).step_by(step).collect();

    // Rayon cuts the list into pieces. A solver is set up for each piece, so there should be few.
    let pieces = 4 * rayon::current_num_threads();
    let farthest = sources
        .par_iter()
        .with_min_len(sources.len().div_ceil(pieces))
        .map_init(
            || VtpFast::new(&mesh),
            |solver, &source| {
                let distances = solver.distances_from(source)?;
                let reached = distances.into_iter().filter(|d| d.is_finite());
                Ok((reached.fold(0.0, f64::max), source))
            },
        )
        .collect::<Result<Vec<_>, SolveError>>()?;

    let (distance, source) = (farthest.into_iter())
        .max_by(|(a, _), (b, _)| a.total_cmp(b))
        .ok_or("no sources")?;
    println!("{model}: {distance} is farthest, from vertex {source}");
    Ok(())
}
