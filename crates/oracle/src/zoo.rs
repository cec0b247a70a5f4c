//! Small surfaces with all features that have broken geodesic programs.
//!
//! [`small`] has surfaces on which the oracle takes a moment. [`slow`] has those on which it takes
//! seconds to minutes; their distances are stored in this crate. Tests that need variants make them
//! with the other functions.

use crate::model::Model;
use crate::random::Random;

mod intrinsic;
mod joined;
mod plane;
mod rough;
mod solids;

pub use intrinsic::cone;
pub(crate) use intrinsic::{EQUILATERAL, SADDLE_FANS, flat_torus};
pub use joined::{pinched, side_by_side, with_isolated_vertices};
pub use plane::{Diagonal, Rectangle, grid, plate, with_flat_faces};
pub(crate) use plane::{dog_ear, staircase};
pub(crate) use rough::{caps, double_cone};
pub use rough::{needles, star, stretched, terrain, whole_terrain};
pub use solids::{cuboid, disphenoid, icosahedron, icosphere, octahedron, prism, torus};
pub(crate) use solids::{noisy_sphere, pillow};

/// All surfaces that the oracle solves in a moment.
pub fn small() -> Vec<Model> {
    let mut all = tiny();
    all.extend(plain());
    all.extend(rough_ones());
    all.extend(thin());
    all.extend(apart_or_pinched());
    all.extend(without_area());
    all
}

/// Surfaces of some 400 to 650 vertices on which the oracle is slow, above all in double-double.
pub fn slow() -> Vec<Model> {
    vec![
        icosphere(3),
        cuboid([8, 8, 8], Diagonal::Alternating),
        noisy_sphere(3, 0.1),
        terrain(24, 0.4),
        terrain(22, 1.5),
        whole_terrain(24, 4),
        torus([32, 16], 2.0, 1.0),
        torus([30, 20], 20.0, 1.0),
    ]
}

/// Surfaces of one to eight faces.
fn tiny() -> Vec<Model> {
    let point = |x: u8, y: u8, z: u8| [x, y, z].map(f64::from);
    let triangle = vec![point(0, 0, 0), point(4, 0, 0), point(1, 3, 0)];
    let kite = vec![
        point(0, 0, 0),
        point(3, 1, 0),
        point(3, 4, 1),
        point(0, 5, 2),
    ];
    vec![
        Model::new("triangle", triangle.clone(), vec![[0, 1, 2]]),
        Model::new(
            "triangle covered twice",
            triangle,
            vec![[0, 1, 2], [0, 2, 1]],
        ),
        Model::new("two triangles", kite.clone(), vec![[0, 1, 2], [0, 2, 3]]),
        Model::new(
            "tetrahedron",
            kite,
            vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]],
        ),
        needles(5, 1.0, 0.5),
        octahedron(),
        star(6, 1.0, 0.5),
        star(8, 0.5, -0.25),
    ]
}

fn plain() -> Vec<Model> {
    let hole = [Rectangle::new([3, 3], [6, 5])];
    let mut all = vec![
        icosahedron(),
        icosphere(1),
        icosphere(2),
        pillow([4, 3]).0,
        torus([12, 8], 2.0, 1.0),
        torus([16, 6], 20.0, 1.0),
        prism(12, 5, 1.0, Diagonal::Rising),
        disphenoid([2.0, 3.0, 4.0]).subdivided(4),
        flat_torus([6, 5], [1.0, 0.25], [0.0, 1.0], 0.2).0,
        cone(8, EQUILATERAL, 4).0,
        cone(12, EQUILATERAL, 3).0,
    ];
    for diagonal in [Diagonal::Rising, Diagonal::Falling, Diagonal::Alternating] {
        let holed = plate([9, 8], diagonal, &hole);
        all.extend([
            cuboid([1, 1, 1], diagonal),
            cuboid([4, 4, 4], diagonal),
            cuboid([1, 3, 5], diagonal),
            grid([1, 12], diagonal),
            grid([10, 10], diagonal),
            holed.clone(),
            holed.jittered(0.2),
        ]);
    }
    all
}

fn rough_ones() -> Vec<Model> {
    let hole = [Rectangle::new([4, 4], [7, 7])];
    let holed = plate([10, 10], Diagonal::Rising, &hole);
    let mut heights = Random::new(1);
    vec![
        terrain(6, 0.4),
        terrain(12, 0.4),
        terrain(6, 1.5),
        terrain(12, 1.5),
        whole_terrain(10, 2),
        whole_terrain(12, 4),
        noisy_sphere(1, 0.3),
        noisy_sphere(2, 0.1),
        holed.moved("with whole heights", |[x, y, _]| {
            [x, y, f64::from(heights.below(3))]
        }),
    ]
}

fn thin() -> Vec<Model> {
    let mut all = vec![
        star(200, 1.0, 0.0),
        star(200, 0.5, 0.1),
        double_cone(100, -0.5),
        double_cone(60, 0.9),
        stretched(8, 1e4, 1.0),
        caps(8, 1e-3),
    ];
    for width in [1e-3, 1e-4, 1e-5, 1e-6] {
        all.push(needles(40, width, 0.0));
        all.push(needles(40, width, width));
        all.push(needles(40, width, 0.1));
        all.push(stretched(6, width, 0.1));
    }
    all
}

fn apart_or_pinched() -> Vec<Model> {
    let solid = disphenoid([2.0, 3.0, 4.0]);
    let kite = grid([1, 1], Diagonal::Rising);
    let disc = star(6, 1.0, 0.0);
    let plane = grid([6, 6], Diagonal::Alternating);
    let middle = 24;
    let saddle = star(8, 1.0, 1.0);
    let hill = terrain(6, 1.5);
    let ball = icosphere(1);
    let two_holes = [
        Rectangle::new([2, 2], [4, 4]),
        Rectangle::new([4, 4], [6, 6]),
    ];
    let chain = pinched(&pinched(&solid, 3, &ball, 5), 8, &plane, 0);
    let three_fans = pinched(&pinched(&disc, 0, &saddle, 0), 0, &solid, 2);
    vec![
        side_by_side(&solid, &ball),
        side_by_side(&plane, &solid),
        with_isolated_vertices(&solid, &[0, 2]),
        with_isolated_vertices(&plane, &[0, 17]),
        pinched(&solid, 0, &solid, 3),
        pinched(&kite, 0, &kite, 3),
        pinched(&double_cone(7, 0.0), 0, &double_cone(9, -1.0), 1),
        pinched(&disc, 0, &disc, 0),
        pinched(&plane, 3, &kite, 0),
        pinched(&plane, middle, &kite, 0),
        pinched(&plane, middle, &plane, middle),
        pinched(&hill, middle, &hill, 7),
        pinched(&saddle, 0, &ball, 0),
        plate([8, 8], Diagonal::Rising, &two_holes),
        plate([8, 8], Diagonal::Falling, &two_holes).jittered(0.2),
        chain,
        three_fans,
    ]
}

/// Surfaces with faces of no area at sources, saddles and boundaries, and next to each other.
fn without_area() -> Vec<Model> {
    let hole = [Rectangle::new([2, 2], [4, 4])];
    let flat_triangle = vec![
        [0.0, 0.0, 0.0],
        [4.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [2.0, 3.0, 0.0],
    ];
    let mut all = vec![
        Model::new("flat face", flat_triangle.clone(), vec![[0, 1, 2]]),
        Model::new(
            "flat face on the boundary",
            flat_triangle,
            vec![[1, 0, 2], [0, 1, 3]],
        ),
        with_flat_faces(terrain(6, 1.5), 30, 0.5),
        with_flat_faces(noisy_sphere(1, 0.3), 30, 0.5),
        with_flat_faces(icosphere(1), 20, 0.3),
        with_flat_faces(cuboid([2, 2, 2], Diagonal::Rising), 25, 0.5),
        with_flat_faces(star(8, 1.0, 1.0), 12, 0.5),
        with_flat_faces(disphenoid([1.0, 1.0, 1.0]), 12, 0.25),
    ];
    for at in [0.5, 0.25, 0.3] {
        let plate = plate([6, 6], Diagonal::Falling, &hole);
        all.push(with_flat_faces(plate, 30, at));
    }
    all
}
