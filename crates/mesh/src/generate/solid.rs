//! Regular solids with edges of length 1, and the icosphere.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use super::keys::{Key, Params};
use super::subdivide::split;
use crate::soup::TriangleSoup;

pub(super) const TETRAHEDRON_KEYS: &[Key] = &[subdiv(5)];
pub(super) const OCTAHEDRON_KEYS: &[Key] = &[subdiv(4)];
pub(super) const ICOSAHEDRON_KEYS: &[Key] = &[subdiv(4)];
pub(super) const SPHERE_KEYS: &[Key] = &[subdiv(4)];

const fn subdiv(default: u64) -> Key {
    Key::whole(
        "subdiv",
        default,
        [0, 12],
        "times each face is split in four",
    )
}

/// Faces after splitting each of `base` in four `subdiv` times.
fn faces(params: &Params<'_>, base: u64) -> u64 {
    base << (2 * params.whole("subdiv"))
}

pub(super) fn tetrahedron_faces(params: &Params<'_>) -> u64 {
    faces(params, 4)
}

pub(super) fn octahedron_faces(params: &Params<'_>) -> u64 {
    faces(params, 8)
}

pub(super) fn icosahedron_faces(params: &Params<'_>) -> u64 {
    faces(params, 20)
}

/// The corners, first in number, are four corners of a cube around the origin.
pub(super) fn tetrahedron(params: &Params<'_>) -> TriangleSoup {
    let s = SQRT_2 / 4.0;
    let corners = [[s, s, s], [s, -s, -s], [-s, s, -s], [-s, -s, s]];
    let triangles = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    flat(params, &corners, &triangles)
}

/// The corners, first in number, are on the axes.
pub(super) fn octahedron(params: &Params<'_>) -> TriangleSoup {
    let s = FRAC_1_SQRT_2;
    let corners = [
        [s, 0.0, 0.0],
        [-s, 0.0, 0.0],
        [0.0, s, 0.0],
        [0.0, -s, 0.0],
        [0.0, 0.0, s],
        [0.0, 0.0, -s],
    ];
    let triangles = [
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    flat(params, &corners, &triangles)
}

/// The corners are first in number. The flat faces stay flat.
pub(super) fn icosahedron(params: &Params<'_>) -> TriangleSoup {
    flat(params, &icosahedron_corners(), &ICOSAHEDRON)
}

/// Icosphere of radius 1: the icosahedron, whose new vertices are moved onto the sphere at each
/// split.
pub(super) fn sphere(params: &Params<'_>) -> TriangleSoup {
    let onto_sphere = |p: [f64; 3]| {
        let length = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt();
        p.map(|x| x / length)
    };
    let corners = icosahedron_corners().map(onto_sphere);
    let mut soup = TriangleSoup::new(corners.to_vec(), ICOSAHEDRON.to_vec());
    for _ in 0..params.whole("subdiv") {
        let old = soup.positions.len();
        soup = split(&soup);
        for position in &mut soup.positions[old..] {
            *position = onto_sphere(*position);
        }
    }
    soup
}

fn flat(params: &Params<'_>, corners: &[[f64; 3]], triangles: &[[u32; 3]]) -> TriangleSoup {
    let mut soup = TriangleSoup::new(corners.to_vec(), triangles.to_vec());
    for _ in 0..params.whole("subdiv") {
        soup = split(&soup);
    }
    soup
}

/// Corners of three golden rectangles, one in each coordinate plane.
fn icosahedron_corners() -> [[f64; 3]; 12] {
    let (s, l) = (0.5, f64::midpoint(1.0, 5f64.sqrt()) / 2.0);
    [
        [-s, l, 0.0],
        [s, l, 0.0],
        [-s, -l, 0.0],
        [s, -l, 0.0],
        [0.0, -s, l],
        [0.0, s, l],
        [0.0, -s, -l],
        [0.0, s, -l],
        [l, 0.0, -s],
        [l, 0.0, s],
        [-l, 0.0, -s],
        [-l, 0.0, s],
    ]
}

const ICOSAHEDRON: [[u32; 3]; 20] = [
    [0, 11, 5],
    [0, 5, 1],
    [0, 1, 7],
    [0, 7, 10],
    [0, 10, 11],
    [1, 5, 9],
    [5, 11, 4],
    [11, 10, 2],
    [10, 7, 6],
    [7, 1, 8],
    [3, 9, 4],
    [3, 4, 2],
    [3, 2, 6],
    [3, 6, 8],
    [3, 8, 9],
    [4, 9, 5],
    [2, 4, 11],
    [6, 2, 10],
    [8, 6, 7],
    [9, 8, 1],
];
