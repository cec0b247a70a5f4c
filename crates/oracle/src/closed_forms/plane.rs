//! Plates: paths are straight, or bend at the corners of holes.

use super::ClosedForm;
use crate::model::Model;
use crate::zoo::{Diagonal, Rectangle, dog_ear, grid, plate, staircase, with_flat_faces};

const DIAGONALS: [Diagonal; 3] = [Diagonal::Rising, Diagonal::Falling, Diagonal::Alternating];

/// A convex plate: `flat` holds its vertices before any folding.
fn convex(model: Model, flat: &Model) -> ClosedForm {
    let flat = flat.positions().unwrap_or_default().to_vec();
    ClosedForm::new(model, move |from, to| {
        Some(straight(flat[from as usize], flat[to as usize]))
    })
}

fn unfolded(model: &Model) -> ClosedForm {
    convex(model.clone(), model)
}

fn straight(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

pub(super) fn whole_plates() -> Vec<ClosedForm> {
    let mut cases = Vec::new();
    for diagonal in DIAGONALS {
        for size in [[1, 1], [2, 2], [12, 12], [40, 3]] {
            let model = grid(size, diagonal);
            let middle = model.vertex_count as u32 / 2;
            cases.push(unfolded(&model.clone().starting_at(&[0, middle])));
            cases.push(unfolded(&model.jittered(0.2)));
        }
        // Heights of 1 and lengths of 3 and 4 make exact distances, and ties between them.
        let stretched = grid([8, 6], diagonal).moved("3 by 4", |[x, y, z]| [3.0 * x, 4.0 * y, z]);
        cases.push(unfolded(&stretched));
        for (count, at) in [(1, 0.5), (10, 0.25), (40, 0.5)] {
            cases.push(unfolded(&with_flat_faces(
                grid([4, 4], diagonal),
                count,
                at,
            )));
        }
        let tilted = grid([6, 6], diagonal).moved("3 by 4", |[x, y, z]| [3.0 * x, 4.0 * y, z]);
        let flat = with_flat_faces(tilted, 10, 0.5);
        let model = flat
            .clone()
            .moved("tilted", |[x, y, _]| [x, 0.6 * y, 0.8 * y]);
        cases.push(convex(model, &flat));
    }
    cases
}

pub(super) fn folded_plates() -> Vec<ClosedForm> {
    let mut cases = Vec::new();
    for diagonal in DIAGONALS {
        for size in [[10, 10], [30, 2]] {
            let flat = grid(size, diagonal);
            cases.push(convex(staircase(flat.clone()), &flat));
        }
    }
    let flat = grid([10, 10], Diagonal::Falling);
    cases.push(convex(dog_ear(flat.clone(), 13.0), &flat));
    cases.push(convex(dog_ear(flat.clone(), 10.0), &flat));
    cases
}

pub(super) fn plates_with_holes() -> Vec<ClosedForm> {
    let layouts: [(&str, [u32; 2], &[Rectangle]); 6] = [
        ("window", [9, 9], &[Rectangle::new([3, 3], [6, 6])]),
        ("L", [9, 9], &[Rectangle::new([4, 4], [10, 10])]),
        ("U", [9, 8], &[Rectangle::new([3, 3], [6, 9])]),
        (
            "S",
            [11, 8],
            &[
                Rectangle::new([2, 2], [4, 9]),
                Rectangle::new([7, -1], [9, 6]),
            ],
        ),
        (
            "two windows",
            [11, 7],
            &[
                Rectangle::new([2, 2], [4, 5]),
                Rectangle::new([6, 1], [9, 4]),
            ],
        ),
        (
            "windows touching in a point",
            [8, 8],
            &[
                Rectangle::new([2, 2], [4, 4]),
                Rectangle::new([4, 4], [6, 6]),
            ],
        ),
    ];
    let mut cases = Vec::new();
    for (name, size, holes) in layouts {
        for diagonal in DIAGONALS {
            let model = plate(size, diagonal, holes);
            let named = |model: Model| model.moved(name, |p| p);
            cases.push(around(named(model.clone()), holes));
            cases.push(around(named(model.clone().jittered(0.2)), holes));
            cases.push(around(named(with_flat_faces(model, 25, 0.5)), holes));
        }
    }
    cases
}

/// A plate with holes: shortest paths over the corners of the holes that see each other.
fn around(model: Model, holes: &[Rectangle]) -> ClosedForm {
    let points: Vec<_> = model.positions().unwrap_or_default().to_vec();
    let holes = holes.to_vec();
    // A corner of a hole that is not a vertex is outside the plate.
    let corners: Vec<_> = holes
        .iter()
        .flat_map(|hole| {
            let [[x0, y0], [x1, y1]] = [hole.from, hole.to].map(|p| p.map(f64::from));
            [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
        })
        .map(|[x, y]| [x, y, 0.0])
        .filter(|corner| points.contains(corner))
        .collect();
    ClosedForm::new(model, move |from, to| {
        let [start, end] = [from, to].map(|v| points[v as usize]);
        let stops = [&[start], &corners[..], &[end]].concat();
        Some(shortest_over(&stops, &holes))
    })
}

/// The shortest path from the first to the last of `stops`, straight between stops that see each
/// other.
fn shortest_over(stops: &[[f64; 3]], holes: &[Rectangle]) -> f64 {
    let mut best = vec![f64::INFINITY; stops.len()];
    best[0] = 0.0;
    // Every round settles one more leg, and a path has fewer legs than there are stops.
    for _ in 0..stops.len() {
        for i in 0..stops.len() {
            for j in 0..stops.len() {
                let length = best[i] + straight(stops[i], stops[j]);
                if length < best[j] && holes.iter().all(|h| misses(h, stops[i], stops[j])) {
                    best[j] = length;
                }
            }
        }
    }
    best[stops.len() - 1]
}

/// Whether the segment from `a` to `b` does not meet the open rectangle.
fn misses(hole: &Rectangle, a: [f64; 3], b: [f64; 3]) -> bool {
    // The part of the segment inside runs from the last entry into a strip to the first exit from
    // one.
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let [from, to] = [hole.from[axis], hole.to[axis]].map(f64::from);
        let step = b[axis] - a[axis];
        if step == 0.0 {
            if a[axis] <= from || a[axis] >= to {
                return true;
            }
            continue;
        }
        let [first, second] = [(from - a[axis]) / step, (to - a[axis]) / step];
        enter = enter.max(first.min(second));
        leave = leave.min(first.max(second));
    }
    leave - enter < 1e-12
}
