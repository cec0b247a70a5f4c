//! Subdivision, noise and scale, on generated models and on soups as files deliver them.

use geobench_mesh::TriangleSoup;
use geobench_mesh::generate::{
    FAMILIES, GenerateError, MAX_FACES, Modifiers, add_noise, midpoint_subdivide,
};
use geobench_mesh::vector::{dot, sub};

use crate::model;
use crate::surface::{assert_close, measure};

#[test]
fn subdivision_keeps_old_vertices_and_the_surface() {
    for family in FAMILIES.iter().filter(|family| family.name != "file") {
        let coarse = model(family.name);
        let fine = midpoint_subdivide(&coarse);
        assert_eq!(fine.triangles.len(), 4 * coarse.triangles.len());
        assert_eq!(fine.positions[..coarse.positions.len()], coarse.positions);
        let (before, after) = (measure(family.name, &coarse), measure(family.name, &fine));
        assert_eq!(after.euler, before.euler, "{}", family.name);
        assert_eq!(after.boundary_edges, 2 * before.boundary_edges);
        assert_close(after.area, before.area, 1e-12);
        assert_eq!(fine.file_face(4 * 17 + 3), 17);
        let by_key = model(&format!("{},subdivide=1", family.name));
        assert_eq!(by_key.positions, fine.positions);
        assert_eq!(by_key.triangles, fine.triangles);
        assert!(by_key.file_faces.is_empty());
    }
}

/// Two triangles joined at a point only, and three at one edge.
#[test]
fn subdivision_takes_pinches_and_fins() {
    let positions = (0..8u8)
        .map(|i| [f64::from(i), f64::from(i * i), f64::from(i % 2)])
        .collect();
    let soup = TriangleSoup::new(
        positions,
        vec![[0, 1, 2], [2, 3, 4], [5, 6, 0], [5, 6, 1], [5, 6, 7]],
    );
    let fine = midpoint_subdivide(&soup);
    // Each of the 13 edges gets one midpoint, that of 5-6 shared by its three triangles.
    assert_eq!(fine.positions.len(), 8 + 13);
    assert_eq!(fine.triangles.len(), 20);
    assert_eq!(fine.triangles[8][1], fine.triangles[12][1]);
    assert_eq!(fine.triangles[8][1], fine.triangles[16][1]);
}

#[test]
fn subdivision_leaves_broken_triangles_for_validation() {
    let soup = TriangleSoup {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 7], [0, 1, 2], [1, 1, 2], [u32::MAX, 0, 1]],
        file_faces: vec![3, 3, 5, 6],
        ..TriangleSoup::default()
    };
    let fine = midpoint_subdivide(&soup);
    assert_eq!(fine.triangles.len(), 7);
    assert_eq!(fine.triangles[0], [0, 1, 7]);
    assert_eq!(fine.triangles[5..], [[1, 1, 2], [u32::MAX, 0, 1]]);
    assert_eq!(fine.file_faces, [3, 3, 3, 3, 3, 5, 6]);
    assert_eq!(
        midpoint_subdivide(&TriangleSoup::default()),
        TriangleSoup::default()
    );
}

#[test]
fn noise_moves_every_vertex_within_its_amplitude() {
    let (plain, noisy) = (model("grid"), model("grid,noise=0.2"));
    assert_eq!(noisy.triangles, plain.triangles);
    let mean = (2.0 + 2f64.sqrt()) / 3.0;
    let mut largest = 0.0f64;
    for (p, q) in plain.positions.iter().zip(&noisy.positions) {
        assert_eq!(p[..2], q[..2], "moved across the normal");
        assert!(p != q);
        largest = largest.max((p[2] - q[2]).abs());
    }
    assert!((0.19..=0.2).contains(&(largest / mean)), "{largest}");
}

#[test]
fn noise_keeps_the_topology() {
    for spec in [
        "sphere,noise=0.3",
        "torus,noise=1",
        "holes,noise=0.5",
        "cone,noise=0.2",
    ] {
        let plain = spec.split(",noise").next().expect("some");
        let (before, after) = (measure(plain, &model(plain)), measure(spec, &model(spec)));
        assert_eq!(before.euler, after.euler, "{spec}");
        assert!(after.area > before.area, "{spec}");
    }
}

#[test]
fn noise_leaves_broken_faces_and_vertices_alone() {
    let mut soup = TriangleSoup::new(
        vec![
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [5.0; 3],
            [f64::NAN; 3],
        ],
        vec![[0, 1, 2], [0, 1, 99], [0, 0, 1], [1, 2, 4]],
    );
    add_noise(&mut soup, 0.5, 1);
    // Only vertex 0 has a normal: the broken triangle takes theirs from 1 and 2.
    assert!(soup.positions[0][2] != 0.0 && soup.positions[0][2].abs() < 1.0);
    assert_eq!(
        soup.positions[1..4],
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [5.0; 3]]
    );
}

#[test]
fn noise_works_at_any_scale() {
    for exponent in [-250, -100, 100, 150] {
        let scale = 10f64.powi(exponent);
        let mut soup = model("octahedron,subdiv=1");
        let plain = soup.clone();
        for x in soup.positions.as_flattened_mut() {
            *x *= scale;
        }
        let before = soup.clone();
        add_noise(&mut soup, 0.1, 1);
        let moved = soup.positions.iter().zip(&before.positions).map(|(p, q)| {
            let step = sub(*p, *q).map(|x| x / scale);
            dot(step, step).sqrt()
        });
        for (step, p) in moved.zip(&plain.positions) {
            // Below 1e-154 areas underflow, and vertices without a normal stay.
            assert!(
                step < 0.2 && (step > 0.0 || exponent < -150),
                "{p:?}: {step}"
            );
        }
    }
}

#[test]
fn seeds_decide_and_nothing_else() {
    for spec in [
        "terrain",
        "torus,bump=0.2",
        "grid,jitter=0.1",
        "holes,jitter=0.2",
        "sphere,noise=0.1",
    ] {
        let one = model(&format!("{spec},seed=1"));
        assert_eq!(one, model(spec), "{spec}: the default seed is 1");
        let two = model(&format!("{spec},seed=2"));
        assert_ne!(one.positions, two.positions, "{spec}");
        assert_eq!(one.triangles, two.triangles, "{spec}");
    }
    assert_eq!(model("torus,seed=1"), model("torus,seed=2"));
}

#[test]
fn scaling_by_powers_of_two_is_exact() {
    let (one, half) = (model("knot,noise=0.1"), model("knot,noise=0.1,scale=0.5"));
    for (p, q) in one.positions.iter().zip(&half.positions) {
        assert_eq!(p.map(|x| x / 2.0), *q);
    }
}

#[test]
fn default_modifiers_change_nothing() {
    let soup = model("cone");
    assert_eq!(Modifiers::default().apply(soup.clone()), Ok(soup));
}

#[test]
fn too_many_faces_are_refused_before_anything_is_made() {
    let modifiers = |subdivide| Modifiers {
        subdivide,
        ..Modifiers::default()
    };
    let faces = model("sphere").triangles.len() as u64;
    assert_eq!(
        modifiers(7).apply(model("sphere")),
        Err(GenerateError::TooManyFaces { faces: faces << 14 })
    );
    assert!(faces << 14 > MAX_FACES);
    assert_eq!(
        modifiers(u32::MAX).apply(model("sphere")),
        Err(GenerateError::TooManyFaces { faces: u64::MAX })
    );
}
