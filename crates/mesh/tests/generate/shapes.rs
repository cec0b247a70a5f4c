//! Every family is the surface that it says it is.

use std::f64::consts::{PI, TAU};

use geobench_mesh::generate::{FAMILIES, GenerateError, Spec};
use geobench_mesh::vector::{dot, sub};
use geobench_mesh::{Mesh, MeshMeasures, TriangleSoup, VertexId};

use crate::model;
use crate::surface::{assert_close, measure};

/// Spec, Euler characteristic, number of boundary edges.
const SHAPES: &[(&str, i64, usize)] = &[
    ("grid", 1, 160),
    ("grid,n=1", 1, 4),
    ("grid,nx=7,ny=3,diagonal=alternating,jitter=0.24", 1, 20),
    ("holes", 1 - 16, 2 * (49 + 37) + 16 * 2 * (6 + 3)),
    ("holes,holes=1,width=1,height=1,wall=1,jitter=0.2", 0, 16),
    ("strip", 1, 3002),
    ("strip,n=1", 1, 3),
    ("strip,n=10,aspect=1e6", 1, 12),
    ("corridor", 1, 2 * (1 + 512 + 16) + 3),
    ("corridor,levels=1", 1, 2 * (1 + 4 + 2) + 3),
    (
        "corridor,levels=3,holes=9",
        1 - 9,
        2 * (9 + 1 + 16 + 6) + 3 + 5 * 9,
    ),
    ("terrain", 1, 200),
    ("terrain,n=1", 1, 4),
    ("terrain,n=33,roughness=1,height=5,seed=9", 1, 132),
    ("terrain,n=10,roughness=0,height=0", 1, 40),
    ("tetrahedron", 2, 0),
    ("tetrahedron,subdiv=0", 2, 0),
    ("cube", 2, 0),
    ("cube,n=1", 2, 0),
    ("cube,n=2,side=5", 2, 0),
    ("box", 2, 0),
    ("box,nx=1,ny=2,nz=3", 2, 0),
    ("box,n=4,a=1,b=1,c=100", 2, 0),
    ("octahedron", 2, 0),
    ("octahedron,subdiv=0", 2, 0),
    ("icosahedron", 2, 0),
    ("icosahedron,subdiv=0", 2, 0),
    ("sphere", 2, 0),
    ("sphere,subdiv=0", 2, 0),
    ("uvsphere", 2, 0),
    ("uvsphere,slices=3,stacks=2", 2, 0),
    ("cylinder", 0, 128),
    ("cylinder,slices=3,stacks=1", 0, 6),
    ("cylinder,ends=capped", 2, 0),
    ("cone", 1, 48),
    ("cone,slices=3,stacks=1,angle=1", 1, 3),
    ("cone,ends=capped", 2, 0),
    ("cone,angle=360,slices=6,ends=capped", 2, 0),
    ("cone,angle=1112.4,slices=12,ends=capped", 2, 0),
    ("torus", 0, 0),
    ("torus,faces=18", 0, 0),
    ("torus,r=0.65,bump=0.5,faces=20000", 0, 0),
    ("torus,faces=50000,bump=0.1,seed=7", 0, 0),
    ("knot", 0, 0),
    ("knot,faces=300,r=0.01", 0, 0),
    ("knot,faces=300,r=0.6", 0, 0),
    ("knot,faces=30000,r=0.6", 0, 0),
    ("anisotropic", 0, 0),
    ("anisotropic,g=12,faces=10000", 0, 0),
];

#[test]
fn every_shape_is_an_oriented_manifold_of_its_topology() {
    for &(text, euler, boundary_edges) in SHAPES {
        let spec: Spec = text.parse().expect(text);
        let soup = model(text);
        assert_eq!(
            spec.face_count(),
            Some(soup.triangles.len() as u64),
            "{text}"
        );
        let surface = measure(text, &soup);
        assert_eq!(surface.euler, euler, "{text}: Euler characteristic");
        assert_eq!(surface.boundary_edges, boundary_edges, "{text}: boundary");
        if boundary_edges == 0 {
            assert!(surface.volume > 0.0, "{text}: volume {}", surface.volume);
        }
    }
}

#[test]
fn shapes_above_cover_every_family() {
    for family in FAMILIES.iter().filter(|family| family.name != "file") {
        assert!(
            SHAPES.iter().any(|(spec, ..)| *spec == family.name),
            "{family:?}"
        );
        let faces = model(family.name).triangles.len();
        assert!(
            (1_000..10_000).contains(&faces),
            "{family:?}: {faces} faces"
        );
    }
}

#[test]
fn wanted_face_counts_are_met() {
    for faces in [1_000u32, 5_000, 12_345, 200_000] {
        for family in [
            "torus",
            "torus,r=0.1",
            "knot",
            "anisotropic",
            "anisotropic,g=2",
        ] {
            let family = family.replacen(',', &format!(",faces={faces},"), 1);
            let spec = if family.contains(',') {
                family
            } else {
                format!("{family},faces={faces}")
            };
            let made: Spec = spec.parse().expect(&spec);
            let made = made.face_count().expect("not a file") as f64;
            assert_close(made, f64::from(faces), 0.03);
        }
    }
}

#[test]
fn jittered_plates_do_not_fold() {
    for spec in [
        "grid,n=30,jitter=0.24",
        "grid,n=30,jitter=0.24,diagonal=alternating",
        "holes,jitter=0.24",
    ] {
        let soup = model(spec);
        for t in &soup.triangles {
            let [a, b, c] = t.map(|v| soup.positions[v as usize]);
            let (u, v) = (sub(b, a), sub(c, a));
            assert!(u[0] * v[1] - u[1] * v[0] > 0.0, "{spec}: {t:?}");
        }
        let flat = measure(spec, &model(spec.split(",jitter").next().expect("some")));
        assert_close(measure(spec, &soup).area, flat.area, 1e-12);
    }
}

#[test]
fn regular_solids_have_edges_of_length_1() {
    for solid in ["tetrahedron", "octahedron", "icosahedron"] {
        let soup = model(&format!("{solid},subdiv=0"));
        let (mesh, _) = Mesh::from_soup(soup).expect(solid);
        for h in mesh.half_edges() {
            assert_close(mesh.length(h), 1.0, 1e-15);
        }
    }
}

#[test]
fn spheres_lie_on_the_unit_sphere() {
    for sphere in ["sphere", "uvsphere"] {
        for p in model(sphere).positions {
            assert_close(dot(p, p), 1.0, 1e-15);
        }
        assert_close(measure(sphere, &model(sphere)).volume, 4.0 / 3.0 * PI, 0.02);
    }
}

#[test]
fn blocks_have_their_corners_first_and_last() {
    let soup = model("cube,n=20,side=20");
    assert_eq!(soup.positions[0], [0.0; 3]);
    assert_eq!(soup.positions.last(), Some(&[20.0; 3]));
    assert!(
        soup.positions
            .as_flattened()
            .iter()
            .all(|x| x.fract() == 0.0)
    );
    let surface = measure("box", &model("box,a=3,b=2,c=1"));
    assert_close(surface.area, 22.0, 1e-12);
    assert_close(surface.volume, 6.0, 1e-12);
}

#[test]
fn cones_have_their_angle_at_the_apex_and_are_flat_elsewhere() {
    for angle in [1.0, 60.0, 180.0, 360.0, 381.6, 676.8, 1112.4] {
        let spec = format!("cone,slices=16,stacks=5,angle={angle}");
        let (mesh, _) = Mesh::from_soup(model(&spec)).expect("valid");
        let apex = VertexId::new(0);
        assert_close(mesh.total_angle(apex), f64::to_radians(angle), 1e-11);
        assert_eq!(mesh.is_saddle(apex), angle > 360.0, "{angle}");
        for v in mesh
            .vertices()
            .filter(|&v| v != apex && !mesh.is_boundary(v))
        {
            assert_close(mesh.total_angle(v), TAU, 1e-12);
        }
        let outermost = mesh.vertices().last().expect("some");
        let p = mesh.positions()[outermost.index()];
        assert_close(dot(p, p), 1.0, 1e-14);
    }
}

#[test]
fn cones_that_cannot_be_folded_are_refused() {
    for spec in ["cone,angle=400,slices=15", "cone,angle=1112,slices=6"] {
        let error = spec.parse::<Spec>().expect_err(spec);
        assert!(matches!(error, GenerateError::Unfit { .. }), "{error}");
        assert!(error.to_string().contains("slices"), "{error}");
    }
}

#[test]
fn tori_enclose_their_volume() {
    let volume = measure("torus", &model("torus,faces=20000,r=0.3")).volume;
    assert_close(volume, 2.0 * PI * PI * 0.09, 0.01);
}

/// The tube stays clear of itself: vertices of distant rings keep their distance.
#[test]
fn the_knot_does_not_touch_itself() {
    let spec: Spec = "knot,faces=4000,r=0.6".parse().expect("right");
    let soup = model("knot,faces=4000,r=0.6");
    // Rings follow each other, so vertices far apart in number, both ways, are far along the knot.
    let n = soup.positions.len();
    let mut nearest = f64::INFINITY;
    for i in 0..n {
        for j in i + n / 6..n.min(i + n - n / 6) {
            let d = sub(soup.positions[i], soup.positions[j]);
            nearest = nearest.min(dot(d, d).sqrt());
        }
    }
    assert!(nearest > 0.05, "{spec}: {nearest}");
}

fn anisotropy(soup: &TriangleSoup) -> f64 {
    let (mesh, _) = Mesh::from_soup(soup.clone()).unwrap();
    MeshMeasures::of(&mesh).anisotropy
}

#[test]
fn anisotropy_is_reached_and_the_shape_stays() {
    let plain = measure("torus", &model("torus,faces=20000"));
    for g in [1.05, 1.1, 1.14, 1.5, 2.0, 2.36, 4.0, 7.7, 15.0, 30.0, 60.0] {
        let spec = format!("anisotropic,g={g},faces=20000");
        let soup = model(&spec);
        assert_close(anisotropy(&soup), g, 1e-3);
        let surface = measure(&spec, &soup);
        assert_close(surface.volume, plain.volume, 0.08);
        assert_close(surface.area, plain.area, 0.06);
    }
}

#[test]
fn the_error_for_an_unreachable_anisotropy_has_the_range() {
    let error = "anisotropic,g=100"
        .parse::<Spec>()
        .expect_err("too stretched");
    let message = error.to_string();
    let faces: u32 = message
        .rsplit('=')
        .next()
        .and_then(|number| number.parse().ok())
        .unwrap_or_else(|| panic!("no number of faces: {message}"));
    let soup = model(&format!("anisotropic,g=100,faces={faces}"));
    assert_close(anisotropy(&soup), 100.0, 1e-3);
}

#[test]
fn equilateral_triangles_have_anisotropy_1() {
    assert_close(anisotropy(&model("tetrahedron,subdiv=2")), 1.0, 1e-14);
    // A right triangle with legs 1: P = 1 + 1/√2, H = √2, S = 1/2.
    let g = (1.0 + 0.5f64.sqrt()) * 2f64.sqrt() / 3f64.sqrt();
    assert_close(anisotropy(&model("grid")), g, 1e-12);
}

#[test]
fn terrain_is_rough_within_its_height() {
    let soup = model("terrain,n=60,height=0.5,roughness=0.6");
    let heights: Vec<f64> = soup.positions.iter().map(|p| p[2]).collect();
    let highest = heights
        .iter()
        .copied()
        .fold(0.0, |m: f64, z| m.max(z.abs()));
    assert!((0.1..=0.5).contains(&highest), "{highest}");
    let (mesh, _) = Mesh::from_soup(soup).expect("valid");
    let saddles = mesh.vertices().filter(|&v| mesh.is_saddle(v)).count();
    assert!(saddles * 4 > mesh.vertex_count(), "{saddles} saddles");
}

#[test]
fn bumps_stay_within_their_height() {
    let soup = model("torus,faces=20000,r=0.4,bump=0.25");
    let radii: Vec<f64> = soup
        .positions
        .iter()
        .map(|[x, y, z]| {
            let out = (x * x + y * y).sqrt() - 1.0;
            (out * out + z * z).sqrt() / 0.4
        })
        .collect();
    let least = radii.iter().copied().fold(f64::INFINITY, f64::min);
    let most = radii.iter().copied().fold(0.0, f64::max);
    assert!((0.75 - 1e-12..0.9).contains(&least), "{least}");
    assert!((1.1..=1.25 + 1e-12).contains(&most), "{most}");
}
