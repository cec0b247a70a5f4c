//! Several surfaces in one model: disjoint, or joined at single vertices.

use crate::model::{Geometry, Model};

/// Two surfaces in space as one model, without common vertices.
///
/// # Panics
///
/// If either has no positions.
pub fn side_by_side(a: &Model, b: &Model) -> Model {
    let (Some(first), Some(second)) = (a.positions(), b.positions()) else {
        panic!("{} and {} need positions", a.name, b.name);
    };
    let shift = first.len() as u32;
    let positions = [first, second].concat();
    let shifted = b.triangles.iter().map(|t| t.map(|v| v + shift));
    let triangles = a.triangles.iter().copied().chain(shifted).collect();
    let name = format!("{} and {}", a.name, b.name);
    Model::new(name, positions, triangles).starting_at(&[0, shift])
}

/// `a` and `b` joined at one vertex: vertex `at_b` of `b` becomes vertex `at_a` of `a`, and `b` is
/// moved there.
///
/// # Panics
///
/// If either has no positions.
pub fn pinched(a: &Model, at_a: u32, b: &Model, at_b: u32) -> Model {
    let both = side_by_side(a, b);
    let Geometry::Positions(mut positions) = both.geometry else {
        unreachable!("two surfaces in space make one in space");
    };
    let first = a.vertex_count as u32;
    let joint = first + at_b;
    let offset = [0, 1, 2].map(|i| positions[at_a as usize][i] - positions[joint as usize][i]);
    for position in &mut positions[first as usize..] {
        for (x, move_by) in position.iter_mut().zip(offset) {
            *x += move_by;
        }
    }
    positions.remove(joint as usize);
    let renumbered = |v: u32| match v {
        v if v == joint => at_a,
        v if v > joint => v - 1,
        v => v,
    };
    let triangles = both.triangles.iter().map(|t| t.map(renumbered)).collect();
    let name = format!("{} pinched at {at_a} to {}", a.name, b.name);
    let far = positions.len() as u32 - 1;
    Model::new(name, positions, triangles).starting_at(&[at_a, far])
}

/// The same surface with an isolated vertex before each of the vertices `before`, and one at the
/// end.
///
/// # Panics
///
/// If the model has no positions.
pub fn with_isolated_vertices(model: &Model, before: &[u32]) -> Model {
    let Some(old) = model.positions() else {
        panic!("{} has no positions", model.name);
    };
    let lone = [7.0, 7.0, 7.0];
    let mut positions = Vec::new();
    let mut numbers = Vec::new();
    let mut isolated = Vec::new();
    for (v, &position) in old.iter().enumerate() {
        if before.contains(&(v as u32)) {
            isolated.push(positions.len() as u32);
            positions.push(lone);
        }
        numbers.push(positions.len() as u32);
        positions.push(position);
    }
    isolated.push(positions.len() as u32);
    positions.push(lone);
    let triangles = model
        .triangles
        .iter()
        .map(|t| t.map(|v| numbers[v as usize]))
        .collect();
    let name = format!("{} with isolated vertices", model.name);
    Model::new(name, positions, triangles).starting_at(&isolated)
}
