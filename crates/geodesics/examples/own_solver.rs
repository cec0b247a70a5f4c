//! A solver of one's own in the benchmark: the policy of ICH under a queue from the standard
//! library.
//!
//! `geobench` starts it as an outside program, which answers requests and times its own solves
//! (`docs/protocol.md`), checks both and shows it beside the others:
//!
//! ```sh
//! cargo build --release -p geodesics --example own_solver
//! PATH=target/release/examples:$PATH geobench run --algo ich,ext:own-solver \
//!     --ext crates/geodesics/examples/own_solver.toml gen:torus,faces=5000
//! ```

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::io::{self, BufRead};
use std::time::Instant;

use geodesics::ich::Splitting;
use geodesics::window::continuous::Continuous;
use geodesics::window::queue::{Discipline, Event};
use geodesics::window::{Counter, Probe, VertexFilter};
use geodesics::{Mesh, Solver};

/// Windows and pseudo-sources by distance. Labels are not negative, so their bits sort as they do.
#[derive(Default)]
struct StdHeap(BinaryHeap<Reverse<(u64, Event)>>);

impl Discipline for StdHeap {
    const COUNTERS: &'static [Counter] = &[];

    fn push<P: Probe>(&mut self, label: f64, event: Event, _: &mut P) {
        self.0.push(Reverse((label.to_bits(), event)));
    }

    fn pop<P: Probe>(&mut self, _: &mut P) -> Option<(f64, Event)> {
        let Reverse((label, event)) = self.0.pop()?;
        Some((f64::from_bits(label), event))
    }

    fn events(&self) -> impl Iterator<Item = (f64, Event)> {
        let waiting = self.0.iter();
        waiting.map(|&Reverse((label, event))| (f64::from_bits(label), event))
    }

    fn clear(&mut self) {
        self.0.clear();
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut requests = io::stdin().lock().lines();
    let model = loop {
        let request = requests.next().ok_or("no model was loaded")??;
        match request.strip_prefix("load ") {
            Some(path) => break path.to_owned(),
            None => println!("{{}}"),
        }
    };
    let mesh = Mesh::read(model)?;
    let start = Instant::now();
    let policy = Splitting::new(&mesh, VertexFilter::On);
    let mut solver = Continuous::new(&mesh, policy, StdHeap::default());
    println!(r#"{{"setup_seconds": {}}}"#, start.elapsed().as_secs_f64());

    let mut distances = Vec::new();
    for request in requests {
        let request = request?;
        match request.split_once(' ').unwrap_or((&request, "")) {
            ("ping", _) => println!("{{}}"),
            ("solve", source) => {
                let source: u32 = source.parse()?;
                let start = Instant::now();
                distances = solver.distances_from(source)?;
                println!(r#"{{"seconds": {}}}"#, start.elapsed().as_secs_f64());
            }
            ("write", output) => {
                let mut text = String::from("vertex,distance\n");
                for (vertex, distance) in distances.iter().enumerate() {
                    writeln!(text, "{vertex},{distance}")?;
                }
                fs::write(output, text)?;
                println!("{{}}");
            }
            _ => return Err(format!("unknown request: {request}").into()),
        }
    }
    Ok(())
}
