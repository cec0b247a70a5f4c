//! Surfaces with many saddles, with needles, and with vertices of high degree.

use std::f64::consts::PI;

use super::plane::{Diagonal, grid};
use crate::model::Model;
use crate::random::Random;

/// A terrain of n × n unit cells with independent random heights of standard deviation `sigma`.
pub fn terrain(n: u32, sigma: f64) -> Model {
    let mut random = Random::new(u64::from(n));
    // The sum of twelve uniform numbers is nearly normal with variance 1, and the same on every
    // machine.
    let mut normal = || (0..12).map(|_| random.between(-0.5, 0.5)).sum::<f64>();
    let flat = grid([n, n], Diagonal::Alternating);
    let mut model = flat.moved("rough", |[x, y, _]| [x, y, sigma * normal()]);
    model.name = format!("{n} x {n} terrain, roughness {sigma}");
    model
}

/// A terrain of n × n unit cells with random integer heights below `levels`. Many distances tie,
/// and paths run through many vertices.
pub fn whole_terrain(n: u32, levels: u32) -> Model {
    let mut random = Random::new(u64::from(n));
    let flat = grid([n, n], Diagonal::Rising);
    let mut model = flat.moved("rough", |[x, y, _]| [x, y, f64::from(random.below(levels))]);
    model.name = format!("{n} x {n} terrain of {levels} levels");
    model
}

/// A strip of `count` triangles of height 1 on bases of length `width`, with random heights up to
/// `noise` out of the plane.
pub fn needles(count: u32, width: f64, noise: f64) -> Model {
    let mut random = Random::new(u64::from(count));
    let point = |i: u32| {
        let x = f64::from(i) * width / 2.0;
        [x, f64::from(i % 2), random.between(-noise, noise)]
    };
    let positions = (0..count + 2).map(point).collect();
    let triangle = |i: u32| {
        if i.is_multiple_of(2) {
            [i, i + 2, i + 1]
        } else {
            [i, i + 1, i + 2]
        }
    };
    let triangles = (0..count).map(triangle).collect();
    let name = format!("{count} needles of width {width:e}, noise {noise:e}");
    Model::new(name, positions, triangles).starting_at(&[0, count + 1, count / 2])
}

/// A plate whose cells are `ratio` times as long as wide, with random heights up to `noise`.
pub fn stretched(n: u32, ratio: f64, noise: f64) -> Model {
    let mut random = Random::new(u64::from(n));
    let name = format!("stretched by {ratio:e}, noise {noise:e}");
    grid([n, n], Diagonal::Alternating).moved(&name, |[x, y, _]| {
        [x * ratio, y, random.between(-noise, noise)]
    })
}

/// Rhombi of two caps each, in a row: triangles of the given `height` over long bases, with two
/// small angles.
pub(crate) fn caps(count: u32, height: f64) -> Model {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..count {
        let y = f64::from(i) * 2.0 * height;
        positions.extend([[0.0, y, 0.0], [1.0, y, 0.0], [0.375, y + height, 0.0]]);
    }
    for i in 0..count {
        let [a, b, c] = [3 * i, 3 * i + 1, 3 * i + 2];
        triangles.push([a, b, c]);
        if i + 1 < count {
            let [above_a, above_b] = [a + 3, b + 3];
            triangles.extend([[c, above_b, above_a], [a, c, above_a], [b, above_b, c]]);
        }
    }
    let name = format!("{count} caps of height {height:e}");
    Model::new(name, positions, triangles).starting_at(&[2, 3 * (count / 2) + 2])
}

/// A disc of `spokes` triangles around vertex 0. Vertices on the rim alternate between radius 1 and
/// height 0, and `other_radius` and `height`.
pub fn star(spokes: u32, other_radius: f64, height: f64) -> Model {
    let mut positions = vec![[0.0, 0.0, 0.0]];
    for i in 0..spokes {
        let (sin, cos) = (2.0 * PI * f64::from(i) / f64::from(spokes)).sin_cos();
        let (radius, z) = if i % 2 == 0 {
            (1.0, 0.0)
        } else {
            (other_radius, height)
        };
        positions.push([radius * cos, radius * sin, z]);
    }
    let triangles = (0..spokes)
        .map(|i| [0, i + 1, (i + 1) % spokes + 1])
        .collect();
    let name = format!("star of {spokes} spokes, {other_radius}, {height}");
    Model::new(name, positions, triangles).starting_at(&[0, 1, 2])
}

/// A double cone of `spokes` faces on each side, with apexes 0 and 1 at heights 1 and `low`.
pub(crate) fn double_cone(spokes: u32, low: f64) -> Model {
    let mut positions = vec![[0.0, 0.0, 1.0], [0.0, 0.0, low]];
    for i in 0..spokes {
        let (sin, cos) = (2.0 * PI * f64::from(i) / f64::from(spokes)).sin_cos();
        positions.push([cos, sin, 0.0]);
    }
    let mut triangles = Vec::new();
    for i in 0..spokes {
        let [a, b] = [i + 2, (i + 1) % spokes + 2];
        triangles.extend([[0, a, b], [1, b, a]]);
    }
    Model::new(
        format!("double cone of {spokes} spokes to {low}"),
        positions,
        triangles,
    )
    .starting_at(&[0, 1])
}
