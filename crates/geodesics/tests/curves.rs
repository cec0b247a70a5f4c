//! Distances from curves against closed forms, samples and the distances of their points.

use geobench_oracle::nasty;
use geodesics::mesh::{CurveSegment, FaceId, HalfEdgeId, SplitMix64};
use geodesics::{
    Curve, CurveError, CurveSourceError, DistanceField, Distances, Mesh, Stop, SurfacePoint,
    SurfaceSolver, VertexId, distances_from_curves, solvers,
};

#[path = "../../oracle/tests/support/mesh.rs"]
mod oracle_mesh;

fn solve(mesh: &Mesh, curves: &[Curve]) -> Vec<f64> {
    distances_from_curves(mesh, curves, f64::INFINITY, &Stop::default()).unwrap()
}

fn inside(mesh: &Mesh, face: FaceId, random: &mut SplitMix64) -> SurfacePoint {
    let (u, v) = (random.unit(), random.unit());
    let (u, v) = if u + v > 1.0 {
        (1.0 - u, 1.0 - v)
    } else {
        (u, v)
    };
    mesh.point_in_face(face, [u, v, 1.0 - u - v]).unwrap()
}

/// A curve that walks at random through faces, over edges and vertices.
fn walk(mesh: &Mesh, steps: usize, random: &mut SplitMix64) -> Curve {
    let mut face = FaceId::new(random.below(mesh.face_count()) as u32);
    let mut points = vec![inside(mesh, face, random)];
    while points.len() < steps {
        let h = face.half_edge(random.below(3) as u32);
        match random.below(6) {
            0 => points.push(inside(mesh, face, random)),
            1 => {
                let v = mesh.tail(h);
                points.push(v.into());
                let around = mesh.outgoing(v);
                face = around[random.below(around.len())].face();
            }
            _ => {
                let ends = [mesh.tail(h), mesh.head(h)];
                points.push(mesh.point_on_edge(ends, random.unit()).unwrap());
                let sides: Vec<HalfEdgeId> = mesh.along_edge(h).collect();
                face = sides[random.below(sides.len())].face();
            }
        }
    }
    Curve::new(points)
}

/// Walks on `mesh`, each of which has a place in its faces.
fn curves(mesh: &Mesh, steps: usize, random: &mut SplitMix64) -> Vec<Curve> {
    let count = 1 + random.below(3);
    let all = (0..count).map(|_| {
        let steps = 1 + random.below(steps);
        walk(mesh, steps, random)
    });
    all.filter(|curve| curve.segments(mesh).is_ok()).collect()
}

/// The point of a segment at the fraction `t`.
fn at(mesh: &Mesh, segment: &CurveSegment, t: f64) -> SurfacePoint {
    let [a, b] = segment.ends;
    let weights = [0, 1, 2].map(|k| (1.0 - t) * a[k] + t * b[k]);
    mesh.point_in_face(segment.face, weights).unwrap()
}

fn segments(mesh: &Mesh, curves: &[Curve]) -> Vec<CurveSegment> {
    let all = curves
        .iter()
        .flat_map(|curve| curve.segments(mesh).unwrap());
    all.collect()
}

fn length(mesh: &Mesh, segment: &CurveSegment) -> f64 {
    let lengths = mesh.side_lengths(segment.face);
    let [a, b] = segment.ends;
    let d = [0, 1, 2].map(|k| b[k] - a[k]);
    // Half-edge k joins corners k and k + 1.
    let squared: f64 = (0..3)
        .map(|k| -d[k] * d[(k + 1) % 3] * lengths[k] * lengths[k])
        .sum();
    squared.max(0.0).sqrt()
}

/// The least distance of a point of the curves in `field`, by a search along each segment.
fn least(mesh: &Mesh, field: &DistanceField, curves: &[Curve], parts: usize) -> f64 {
    let points = curves.iter().flat_map(Curve::points);
    let of_points = points.map(|point| field.distance(point).unwrap());
    let mut best = of_points.fold(f64::INFINITY, f64::min);
    for segment in segments(mesh, curves) {
        let f = |t: f64| field.distance(&at(mesh, &segment, t)).unwrap();
        let step = 1.0 / parts as f64;
        let samples: Vec<f64> = (0..=parts).map(|i| f(i as f64 * step)).collect();
        for i in 0..=parts {
            let beside = [i.saturating_sub(1), (i + 1).min(parts)];
            if beside.iter().any(|&j| samples[j] < samples[i]) {
                continue;
            }
            let [mut lo, mut hi] = beside.map(|j| j as f64 * step);
            for _ in 0..60 {
                let [x, y] = [lo + 0.382 * (hi - lo), hi - 0.382 * (hi - lo)];
                if f(x) < f(y) {
                    hi = y;
                } else {
                    lo = x;
                }
            }
            best = best.min(f(0.5 * (lo + hi))).min(samples[i]);
        }
    }
    best
}

/// Checks the distances of some vertices by a search along the curves.
fn check_by_search(
    name: &str,
    mesh: &Mesh,
    curves: &[Curve],
    vertices: usize,
    random: &mut SplitMix64,
) {
    let found = solve(mesh, curves);
    let scale = found
        .iter()
        .filter(|d| d.is_finite())
        .fold(0.0, |a: f64, &b| a.max(b));
    for _ in 0..vertices {
        let v = VertexId::new(random.below(mesh.vertex_count()) as u32);
        let field = DistanceField::new(mesh, &[v.into()]).unwrap();
        let expected = least(mesh, &field, curves, 24);
        let d = found[v.index()];
        if expected.is_infinite() && d.is_infinite() {
            continue;
        }
        let tolerance = 1e-9 * expected + 1e-11 * scale.max(mesh.longest_edge());
        assert!(
            (d - expected).abs() <= tolerance,
            "{name}, vertex {v}: {d:e}, but the search finds {expected:e}, off by {:e}",
            d - expected
        );
    }
}

fn plane_distance([px, py]: [f64; 2], [[ax, ay], [bx, by]]: [[f64; 2]; 2]) -> f64 {
    let (dx, dy) = (bx - ax, by - ay);
    let squared = dx * dx + dy * dy;
    let t = if squared > 0.0 {
        (((px - ax) * dx + (py - ay) * dy) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (px - ax - t * dx).hypot(py - ay - t * dy)
}

#[test]
fn in_the_plane_distances_are_those_of_polylines() {
    for (spec, seeds) in [("grid,n=6", 60), ("grid,n=17", 10)] {
        let mesh = Mesh::generate(spec).unwrap();
        let flat = |p: [f64; 3]| [p[0], p[1]];
        for seed in 0..seeds {
            let mut random = SplitMix64::new(seed);
            let curves = curves(&mesh, 12, &mut random);
            let found = solve(&mesh, &curves);
            for v in mesh.vertices() {
                let p = flat(mesh.positions()[v.index()]);
                let mut expected = f64::INFINITY;
                for curve in &curves {
                    let places: Vec<[f64; 2]> = (curve.points().iter())
                        .map(|point| flat(mesh.position_of(point).unwrap()))
                        .collect();
                    let pairs = places.windows(2).map(|pair| [pair[0], pair[1]]);
                    let pairs = pairs.chain([[places[0]; 2]]);
                    expected = pairs.fold(expected, |d, pair| d.min(plane_distance(p, pair)));
                }
                let d = found[v.index()];
                assert!(
                    (d - expected).abs() < 1e-12,
                    "{spec}, seed {seed}, {v}: {d} {expected}"
                );
            }
        }
    }
}

#[test]
fn the_border_of_a_square_is_at_the_distance_of_its_nearest_side() {
    let mesh = Mesh::generate("grid,n=9").unwrap();
    let borders = mesh.borders();
    assert_eq!(borders.len(), 1);
    for (p, d) in mesh.positions().iter().zip(solve(&mesh, &borders)) {
        let [x, y, _] = *p;
        let expected = x.min(y).min(9.0 - x).min(9.0 - y);
        assert!((d - expected).abs() < 1e-13, "{p:?}: {d}");
    }
}

#[test]
fn around_a_cube_rays_are_those_of_the_unfolded_faces() {
    let mesh = Mesh::generate("cube,n=4").unwrap();
    let [low, high] = mesh.bounding_box().unwrap();
    let side = high[0] - low[0];
    // The edge of the cube along the first axis, at the lowest y and z.
    let mut along: Vec<(f64, VertexId)> = (mesh.vertices())
        .map(|v| (mesh.positions()[v.index()], v))
        .filter(|(p, _)| p[1] == low[1] && p[2] == low[2])
        .map(|(p, v)| (p[0], v))
        .collect();
    along.sort_by(|a, b| a.0.total_cmp(&b.0));
    let curve = Curve::new(along.iter().map(|(_, v)| *v));
    for (p, d) in mesh.positions().iter().zip(solve(&mesh, &[curve])) {
        let [x, y, z] = [0, 1, 2].map(|k| p[k] - low[k]);
        // Over a face at the edge, and on over the next one or over an end of the cube.
        let on = |holds: bool, ways: [f64; 3]| {
            let shortest = ways.into_iter().fold(f64::INFINITY, f64::min);
            if holds { shortest } else { f64::INFINITY }
        };
        let beyond = |z: f64| [side + z, (side + x).hypot(z), (2.0 * side - x).hypot(z)];
        let ways = [
            on(y == 0.0, [z; 3]),
            on(z == 0.0, [y; 3]),
            on(x == 0.0 || x == side, [y.hypot(z); 3]),
            on(y == side, beyond(z)),
            on(z == side, beyond(y)),
        ];
        let expected = ways.into_iter().fold(f64::INFINITY, f64::min);
        assert!(
            (d - expected).abs() < 1e-12,
            "{x} {y} {z}: {d}, not {expected}"
        );
    }
}

#[test]
fn samples_of_growing_density_converge_from_above() {
    for (spec, steps) in [
        ("terrain,n=8,seed=3", 20),
        ("torus,faces=400,bump=0.3,seed=1", 20),
        ("anisotropic,faces=1000,g=6", 12),
        ("sphere,subdiv=2,noise=0.1,seed=5", 30),
    ] {
        let mesh = Mesh::generate(spec).unwrap();
        for seed in 0..4 {
            let mut random = SplitMix64::new(seed);
            let curves = vec![walk(&mesh, steps, &mut random)];
            let found = solve(&mesh, &curves);
            let scale = found.iter().fold(0.0, |a: f64, &b| a.max(b));
            let segments = segments(&mesh, &curves);
            let mut last = f64::INFINITY;
            for parts in [1, 4, 16, 64] {
                let steps = || (0..=parts).map(|i| f64::from(i) / f64::from(parts));
                let samples: Vec<SurfacePoint> = (segments.iter())
                    .flat_map(|segment| steps().map(|t| at(&mesh, segment, t)).collect::<Vec<_>>())
                    .collect();
                let widest = segments.iter().map(|segment| length(&mesh, segment));
                let step = widest.fold(0.0, f64::max) / f64::from(parts);
                let mut solver = SurfaceSolver::with(&mesh, |mesh| Box::new(solvers::mmp(mesh)));
                let sampled = solver.distances_from(&samples).unwrap();
                let gaps: Vec<f64> = sampled.iter().zip(&found).map(|(s, d)| s - d).collect();
                let least = gaps.iter().copied().fold(f64::INFINITY, f64::min);
                let most = gaps.iter().copied().fold(0.0, f64::max);
                assert!(least >= -1e-12 * scale, "{spec}, seed {seed}: {least:e}");
                assert!(
                    most <= 0.5 * step + 1e-12 * scale,
                    "{spec}, seed {seed}: {most:e}"
                );
                let sum: f64 = gaps.iter().sum();
                assert!(sum <= last + 1e-12 * scale, "{spec}, seed {seed}");
                last = sum;
            }
            // The step is below a hundredth of an edge: the gap is of second order nearly
            // everywhere.
            let mean = last / found.len() as f64;
            assert!(mean < 1e-4 * scale, "{spec}, seed {seed}: {mean:e}");
        }
    }
}

#[test]
fn distances_are_the_least_along_the_curve() {
    for (spec, seeds) in [
        ("terrain,n=6,seed=1", 8),
        ("torus,faces=200,bump=0.4,seed=2", 8),
        ("anisotropic,faces=1000,g=8", 3),
        ("sphere,subdiv=2,noise=0.2,seed=7", 6),
        ("cube,n=2", 8),
    ] {
        let mesh = Mesh::generate(spec).unwrap();
        for seed in 0..seeds {
            let mut random = SplitMix64::new(100 + seed);
            let curves = curves(&mesh, 10, &mut random);
            check_by_search(
                &format!("{spec}, seed {seed}"),
                &mesh,
                &curves,
                6,
                &mut random,
            );
        }
    }
}

#[test]
fn distances_on_nasty_meshes_are_the_least_along_the_curve() {
    for seed in 0..150 {
        let Ok(mesh) = oracle_mesh::mesh_of(&nasty::mesh(seed).model) else {
            continue;
        };
        let mut random = SplitMix64::new(seed);
        let curves = curves(&mesh, 6, &mut random);
        if !curves.is_empty() {
            check_by_search(&format!("seed {seed}"), &mesh, &curves, 4, &mut random);
        }
    }
}

#[test]
fn a_curve_of_one_point_is_that_point() {
    let mesh = Mesh::generate("terrain,n=9,seed=2").unwrap();
    for seed in 0..10 {
        let mut random = SplitMix64::new(seed);
        let points: Vec<SurfacePoint> = (0..=random.below(3))
            .map(|_| {
                let face = FaceId::new(random.below(mesh.face_count()) as u32);
                inside(&mesh, face, &mut random)
            })
            .collect();
        let found = solve(
            &mesh,
            &points.iter().map(|p| Curve::new([*p])).collect::<Vec<_>>(),
        );
        for (d, expected) in found.iter().zip(mesh.distances_from(&points).unwrap()) {
            assert!((d - expected).abs() <= 1e-12 * expected, "{d} {expected}");
        }
    }
}

#[test]
fn closed_curves_have_a_segment_back() {
    let mesh = Mesh::generate("grid,n=4").unwrap();
    // The corners 0, 4 and 24 of the grid, by the vertices between them.
    let around: Vec<u32> = (0..5).chain([9, 14, 19, 24, 18, 12, 6]).collect();
    let [open, closed] = [Curve::new(around.clone()), Curve::closed(around)];
    let [open, closed] = [open, closed].map(|curve| solve(&mesh, &[curve])[5]);
    assert!(
        (open - 1.0).abs() < 1e-15 && (closed - 0.5_f64.sqrt()).abs() < 1e-15,
        "{open} {closed}"
    );
}

#[test]
fn distances_beyond_the_radius_are_infinite() {
    let mesh = Mesh::generate("terrain,n=12,seed=4").unwrap();
    let mut random = SplitMix64::new(1);
    let curves = vec![walk(&mesh, 8, &mut random)];
    let all = solve(&mesh, &curves);
    let radius = 0.4 * all.iter().fold(0.0, |a: f64, &b| a.max(b));
    let near = distances_from_curves(&mesh, &curves, radius, &Stop::default()).unwrap();
    for (d, all) in near.iter().zip(&all) {
        assert_eq!(*d, if *all <= radius { *all } else { f64::INFINITY });
    }
}

#[test]
fn degenerate_curves_are_points_and_unplaced_ones_are_refused() {
    let mesh = Mesh::generate("grid,n=3").unwrap();
    let face = FaceId::new(4);
    let p = mesh.point_in_face(face, [0.2, 0.3, 0.5]).unwrap();
    let points = solve(&mesh, &[Curve::new([p])]);
    assert_eq!(solve(&mesh, &[Curve::closed([p, p, p])]), points);
    let q = mesh
        .point_in_face(face, [0.2 + 1e-15, 0.3, 0.5 - 1e-15])
        .unwrap();
    let close = solve(&mesh, &[Curve::new([p, q])]);
    assert!(
        close
            .iter()
            .zip(&points)
            .all(|(a, b)| (a - b).abs() < 1e-14)
    );

    let refused = |curves: &[Curve]| {
        distances_from_curves(&mesh, curves, f64::INFINITY, &Stop::default()).unwrap_err()
    };
    assert_eq!(refused(&[]), CurveSourceError::NoCurve);
    let none: [u32; 0] = [];
    let of = |index, error| CurveSourceError::Curve { index, error };
    assert_eq!(
        refused(&[Curve::new([0]), Curve::new(none)]),
        of(1, CurveError::Empty)
    );
    assert_eq!(
        refused(&[Curve::new([0, 1, 15])]),
        of(0, CurveError::Apart { ends: [1, 2] })
    );
    let missing = refused(&[Curve::new([0, 99])]).to_string();
    assert!(
        missing.contains("curve 0: point 1: vertex 99 does not exist"),
        "{missing}"
    );
}

/// The points differ in one coordinate by an ulp. In the frame of one side they were equal, and the
/// rays between them had no direction: they kept out other windows.
#[test]
fn rounding_makes_the_ends_of_a_segment_one_point() {
    let positions = [0.25, 0.25, 0.25, 0.0, 0.0, 0.0].into_iter().enumerate();
    let position = |(k, z): (usize, f64)| [(k % 2) as f64, 10.0 * (k / 2) as f64, z];
    let faces = vec![[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]];
    let mesh = Mesh::new(positions.map(position).collect(), faces).unwrap();
    let middle = mesh.point_on_edge([5.into(), 3.into()], 0.5).unwrap();
    let [p, q] = [0.125, 0.125_f64.next_up()].map(|weight| {
        let weights = [0.125, weight, 0.75];
        mesh.point_in_face(FaceId::new(2), weights).unwrap()
    });
    assert_ne!(p, q);
    let points = solve(&mesh, &[Curve::new([middle]), Curve::new([p])]);
    let found = solve(&mesh, &[Curve::new([middle]), Curve::new([p, q])]);
    for (d, expected) in found.iter().zip(points) {
        assert!((d - expected).abs() < 1e-14, "{d} {expected}");
    }
}

#[test]
fn a_segment_that_may_lie_in_two_faces_is_refused() {
    // Both sides of a triangle.
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 2, 1]]).unwrap();
    let middle = mesh.point_on_edge([1.into(), 2.into()], 0.5).unwrap();
    let across = Curve::new([0.into(), middle]);
    assert_eq!(
        across.segments(&mesh),
        Err(CurveError::Ambiguous {
            ends: [0, 1],
            faces: 2
        })
    );
    let inside = mesh
        .point_in_face(FaceId::new(0), [0.5, 0.25, 0.25])
        .unwrap();
    let across = Curve::new([0.into(), inside, middle]);
    assert_eq!(across.segments(&mesh).unwrap().len(), 2);
    let edge = Curve::new([1, 2]);
    assert_eq!(edge.segments(&mesh).unwrap().len(), 2);
    assert!((solve(&mesh, &[edge])[0] - 0.5_f64.sqrt()).abs() < 1e-15);
}

#[test]
fn rays_go_on_in_every_sheet_of_a_junction() {
    // Three half-strips on a line of edges, one of them turned over.
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for x in [0.0, 1.0, 2.0] {
        positions.extend([[x, 0.0, 0.0], [x, 1.0, 0.0], [x, -1.0, 0.0], [x, 0.0, 1.0]]);
    }
    for sheet in 1..4 {
        for i in [0, 4] {
            let [a, b, c, d] = [i, i + 4, i + sheet, i + 4 + sheet];
            triangles.extend([[a, b, c], [b, d, c]].map(|[p, q, r]| match sheet {
                3 => [q, p, r],
                _ => [p, q, r],
            }));
        }
    }
    let mesh = Mesh::new(positions, triangles).unwrap();
    assert!(mesh.has_junctions());
    // The outer side of the first sheet, and the line itself.
    for (curve, expected) in [
        ([1, 5, 9], [1.0, 0.0, 2.0, 2.0]),
        ([0, 4, 8], [0.0, 1.0, 1.0, 1.0]),
    ] {
        let found = solve(&mesh, &[Curve::new(curve)]);
        for x in 0..3 {
            let got: Vec<f64> = (0..4).map(|k| found[4 * x + k]).collect();
            assert!(
                got.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15),
                "{got:?}"
            );
        }
    }
}
