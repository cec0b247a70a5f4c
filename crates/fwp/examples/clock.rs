#![allow(clippy::all, clippy::pedantic, missing_docs)]
//! scratch
use geobench_fwp::*;
use geobench_mesh::{Mesh, VertexId};
use geobench_window::{Count, Counter, Propagate, Solution, Solver};
use std::time::Instant;
fn load(path: &str) -> Mesh {
    let soup = geobench_mesh::io::read(std::path::Path::new(path)).unwrap();
    Mesh::from_soup(soup).unwrap().0
}
#[inline(never)]
fn clock<S: Solver + Propagate>(name: &str, model: &str, mut s: S, reps: usize) {
    let src = [VertexId::new(0)];
    let mut best = f64::INFINITY;
    let mut sum = 0.0;
    for _ in 0..reps {
        let t = Instant::now();
        let r: Solution = s.solve(&src).unwrap();
        best = best.min(t.elapsed().as_secs_f64());
        sum = r.distances.iter().filter(|d| d.is_finite()).sum();
    }
    if std::env::var("COUNT").is_ok() {
        let mut c = Count::default();
        s.propagate(&src, &mut c);
        let c = c.counters(&S::counters());
        for k in [
            Counter::Parents,
            Counter::Children,
            Counter::Kept,
            Counter::Spawned,
            Counter::Filtered,
            Counter::PeakWindows,
            Counter::QueuePeak,
            Counter::Iterations,
        ] {
            eprint!("{}={:?} ", k.key(), c.get(k));
        }
        eprintln!();
    }
    println!("{model} {name} {best:.4} {sum:.12e}");
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let reps: usize = a[1].parse().unwrap();
    let algos = &a[2];
    for path in &a[3..] {
        let mesh = load(path);
        let model = path.rsplit('/').next().unwrap().trim_end_matches(".obj");
        for algo in algos.split(',') {
            match algo {
                "ich" => clock(algo, model, geobench_ich::ich(&mesh), reps),
                "ich1" => clock(algo, model, geobench_ich::ich1(&mesh), reps),
                "fwp-ch" => clock(algo, model, fwp_ch(&mesh, BucketOptions::default()), reps),
                "lc-ch" => clock(
                    algo,
                    model,
                    lc_ch(&mesh, LabelCorrectingOptions::default()),
                    reps,
                ),
                "vtp-ch" => clock(algo, model, vtp_ch(&mesh), reps),
                "fwp-mmp" => clock(algo, model, fwp_mmp(&mesh, BucketOptions::default()), reps),
                _ => panic!(),
            }
        }
    }
}
