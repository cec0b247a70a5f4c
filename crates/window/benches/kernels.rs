//! The work for one window, on synthetic windows: crossing a triangle, and the comparisons of
//! trimming.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use geobench_mesh::generate::generate;
use geobench_mesh::{HalfEdgeId, Mesh, SplitMix64};
use geobench_window::{Crossing, Crossings, Faces, LANES, Side, Window, tie_points};

/// Windows of each bench, few enough for the first-level cache.
const COUNT: usize = 256;

/// Numbers in [0, 1), the same in each run.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut random = SplitMix64::new(seed);
    move || random.unit()
}

/// The icosahedron, whose edges have equal lengths.
fn icosahedron() -> Mesh {
    let soup = "gen:sphere,subdiv=0".parse().map(|spec| generate(&spec));
    let Ok(Ok(soup)) = soup else {
        panic!("there is no icosahedron");
    };
    match Mesh::from_soup(soup) {
        Ok((mesh, _)) => mesh,
        Err(error) => panic!("{error}"),
    }
}

/// Windows on an edge of length `l`, seen from 1 to 21 edges away.
fn windows(l: f64) -> Vec<Window> {
    let mut next = numbers(1);
    let window = |_| {
        let b0 = 0.9 * next();
        Window {
            b0: l * b0,
            b1: l * (b0 + (1.0 - b0) * (0.01 + 0.99 * next())),
            px: l * (6.0 * next() - 2.5),
            py: l * (-1.0 - 20.0 * next()),
            sigma: l * 0.1 * next(),
        }
    };
    (0..COUNT).map(window).collect()
}

/// The half-edge through which the windows enter.
const H: HalfEdgeId = HalfEdgeId::new(0);

fn kernels(criterion: &mut Criterion) {
    let faces = Faces::new(&icosahedron());
    let frame = faces.frame(H);
    let windows = windows(frame.l);
    let mut group = criterion.benchmark_group("window");
    group.throughput(Throughput::Elements(COUNT as u64));
    group.bench_function("propagate", |b| {
        b.iter(|| {
            for w in &windows {
                let crossing = Crossing::new(black_box(&frame), w);
                if crossing.covers_apex() {
                    let [left, right] = [Side::Left, Side::Right].map(|s| faces.exit(H, &frame, s));
                    black_box(crossing.straight_distance());
                    black_box((crossing.left_child(&left), crossing.right_child(&right)));
                } else {
                    let exit = faces.exit(H, &frame, crossing.side());
                    black_box((crossing.bent_distance(&exit), crossing.only_child(&exit)));
                }
            }
        });
    });
    group.bench_function("propagate-together", |b| {
        let mut crossings = Crossings::default();
        b.iter(|| {
            for some in windows.chunks(LANES) {
                crossings.clear();
                for w in some {
                    crossings.add(H, w);
                }
                crossings.cross(black_box(&faces));
                black_box(&crossings);
            }
        });
    });
    group.bench_function("separating-point", |b| {
        b.iter(|| {
            for w in &windows {
                black_box(Crossing::new(black_box(&frame), w).separation());
            }
        });
    });
    group.bench_function("tie-points", |b| {
        b.iter(|| {
            for pair in windows.windows(2) {
                black_box(tie_points(&pair[0], &pair[1]));
            }
        });
    });
    group.bench_function("least-distance", |b| {
        b.iter(|| {
            for w in &windows {
                black_box(w.min_distance());
            }
        });
    });
    group.finish();
}

criterion_group!(benches, kernels);
criterion_main!(benches);
