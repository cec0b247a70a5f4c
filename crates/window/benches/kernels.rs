//! What an algorithm does with one window, on windows that are made up: the crossing of a triangle and what trimming
//! compares.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use geobench_window::{Frame, Passage, Window, tie_points};

/// Windows of each bench: few enough for the first cache.
const COUNT: usize = 256;

/// Numbers in [0, 1) that are the same each time: a linear congruence (Knuth, MMIX).
fn numbers(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Windows on an edge of length 1, seen from 1 to 21 edges away.
fn windows() -> Vec<Window> {
    let mut next = numbers(1);
    let window = |_| {
        let b0 = 0.9 * next();
        Window {
            b0,
            b1: b0 + (1.0 - b0) * (0.01 + 0.99 * next()),
            px: 6.0 * next() - 2.5,
            py: -1.0 - 20.0 * next(),
            sigma: 0.1 * next(),
        }
    };
    (0..COUNT).map(window).collect()
}

/// The equilateral triangle on that edge.
fn frame() -> Frame {
    let cy = 0.75f64.sqrt();
    Frame {
        l: 1.0,
        la: 1.0,
        lb: 1.0,
        cx: 0.5,
        cy,
        left: [0.5, cy],
        right: [0.5, -cy],
    }
}

fn kernels(criterion: &mut Criterion) {
    let (windows, frame) = (windows(), frame());
    let mut group = criterion.benchmark_group("window");
    group.throughput(Throughput::Elements(COUNT as u64));
    group.bench_function("propagate", |b| {
        b.iter(|| {
            for w in &windows {
                let passage = Passage::new(black_box(&frame), w);
                black_box(passage.apex_distance_below(black_box(10.0)));
                black_box((passage.left_child(), passage.right_child()));
            }
        });
    });
    group.bench_function("separating-point", |b| {
        b.iter(|| {
            for w in &windows {
                black_box(Passage::new(black_box(&frame), w).separation());
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
