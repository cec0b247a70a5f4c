//! Paths to all vertices on meshes that break tracers: random nasty ones, graded ones, near
//! duplicates of vertices on rough surfaces.

mod judged;

use std::env;
use std::path::PathBuf;

use geobench_mesh::{Mesh, SplitMix64, TriangleSoup};
use geobench_oracle::nasty::{self, Kind};

use crate::judged::oracle_mesh::mesh_of;
use crate::judged::{check, report};

/// The number in the environment variable `name`, for more seeds than by default.
fn number(name: &str, default: u64) -> u64 {
    env::var(name).map_or(default, |text| text.parse().unwrap())
}

#[test]
fn nasty_meshes() {
    let mut failures = Vec::new();
    for seed in number("FROM", 0)..number("TO", 250) {
        let model = nasty::mesh(seed).model;
        if let Ok(mesh) = mesh_of(&model) {
            check(&model.name, &mesh, &model.sources, &mut failures);
        }
    }
    report(&failures);
}

#[test]
fn meshes_with_junctions() {
    let mut failures = Vec::new();
    for &kind in Kind::JOINED {
        for seed in number("FROM", 0)..number("TO", 30) {
            let model = kind.mesh(seed).model;
            if let Ok(mesh) = mesh_of(&model) {
                check(&model.name, &mesh, &model.sources, &mut failures);
            }
        }
    }
    report(&failures);
}

/// Regression test: meshes of the fuzzer on which paths were bent.
///
/// * `comb`: a line was unfolded across an edge a millionth as long as the line.
/// * `corridor`, `lenses`: the direction of a line at the vertex where it ends was measured on the
///   far side of a face a millionth as wide as long.
/// * `book`, `touching`, `tee`: a path along an edge of several faces turned by less than π in one
///   of them.
/// * `rolled`: the ends of a line were on one side of a face without height.
/// * `graded`: a search gave up before it had tried the second line to the target.
/// * `touching` 83684, 85529 and `membranes` 15420: of two windows that tie beside a vertex at a
///   junction, a search kept the one that does not lead straight on.
/// * `near-duplicates`: a line turned around a vertex by more than π within the rounding of its
///   images, and ran beyond its end and back.
/// * `collinear-fan`: the judge measured the direction back along a side as -π.
/// * `graded` 2220: a recorded line wound around a tip smaller than the rounding of distances.
#[test]
fn seeds_that_failed() {
    let mut failures = Vec::new();
    for (kind, seed) in [
        (Kind::Comb, 2236),
        (Kind::Corridor, 542),
        (Kind::Lenses, 22213),
        (Kind::Book, 27531),
        (Kind::Touching, 19244),
        (Kind::Tee, 18292),
        (Kind::Rolled, 9114),
        (Kind::Graded, 17719),
        (Kind::Touching, 83684),
        (Kind::Touching, 85529),
        (Kind::Membranes, 15420),
        (Kind::NearDuplicates, 4667),
        (Kind::CollinearFan, 4420),
        (Kind::Graded, 2220),
    ] {
        let model = kind.mesh(seed).model;
        let mesh = mesh_of(&model).unwrap();
        check(&model.name, &mesh, &model.sources, &mut failures);
    }
    report(&failures);
}

/// A closed fan of `rings` rings around vertex 0; the edges of each ring are `factor` times as long
/// as those of the next one. The rings are not round, and not flat.
fn graded(corners: u32, rings: u32, factor: f64, seed: u64) -> Mesh {
    let mut random = SplitMix64::new(seed);
    let mut positions = vec![[0.0; 3]];
    let mut faces = Vec::new();
    for ring in 0..rings {
        let size = factor.powi((rings - 1 - ring).cast_signed());
        let first = 1 + ring * corners;
        for i in 0..corners {
            let turn =
                std::f64::consts::TAU * (f64::from(i) + 0.4 * random.unit()) / f64::from(corners);
            let radius = size * (0.7 + 0.3 * random.unit());
            let height = size * 0.5 * random.unit();
            positions.push([radius * turn.cos(), radius * turn.sin(), height]);
            let next = (i + 1) % corners;
            if ring == 0 {
                faces.push([0, first + i, first + next]);
            } else {
                let below = first - corners;
                faces.push([below + i, first + i, first + next]);
                faces.push([below + i, first + next, below + next]);
            }
        }
    }
    Mesh::new(positions, faces).unwrap()
}

#[test]
fn graded_meshes() {
    let mut failures = Vec::new();
    for seed in 0..number("GRADED", 12) {
        let corners = 3 + (seed % 4) as u32;
        for (rings, factor) in [(11, 1e-2), (21, 0.1), (6, 1e-4), (3, 1e-10)] {
            let mesh = graded(corners, rings, factor, seed);
            let last = mesh.vertex_count() as u32 - 1;
            for sources in [vec![0], vec![last], vec![1, last - 2], vec![last / 2]] {
                let name = format!("graded {seed}, {rings} rings, {factor:e}");
                check(&name, &mesh, &sources, &mut failures);
            }
        }
    }
    report(&failures);
}

/// A rough sphere with `count` vertices beside others, at about `distance`: on edges and in faces.
fn near_duplicates(count: usize, distance: f64, seed: u64) -> Mesh {
    let rough = Mesh::generate(&format!("sphere,subdiv=1,noise=0.3,seed={}", seed + 1)).unwrap();
    let mut soup = rough.to_soup();
    let mut random = SplitMix64::new(seed);
    for _ in 0..count {
        let f = random.below(soup.triangles.len());
        let k = random.below(3);
        let [a, b, c] = [0, 1, 2].map(|i| soup.triangles[f][(k + i) % 3]);
        let d = soup.positions.len() as u32;
        let [pa, pb, pc] = [a, b, c].map(|v| soup.positions[v as usize]);
        let inside = random.below(2) == 0;
        let (s, t) = (distance * random.unit(), distance * random.unit());
        let t = if inside { t } else { 0.0 };
        let at = |i: usize| pa[i] + s * (pb[i] - pa[i]) + t * (pc[i] - pa[i]);
        soup.positions.push([at(0), at(1), at(2)]);
        if inside {
            soup.triangles[f] = [a, b, d];
            soup.triangles.extend([[b, c, d], [c, a, d]]);
        } else {
            let is_beyond = |t: &[u32; 3]| (0..3).any(|i| [t[i], t[(i + 1) % 3]] == [b, a]);
            let beyond = soup.triangles.iter().position(is_beyond).unwrap();
            let e = soup.triangles[beyond]
                .into_iter()
                .find(|v| ![a, b].contains(v))
                .unwrap();
            soup.triangles[f] = [a, d, c];
            soup.triangles[beyond] = [b, d, e];
            soup.triangles.extend([[d, b, c], [d, a, e]]);
        }
    }
    Mesh::from_soup(TriangleSoup::new(soup.positions, soup.triangles))
        .unwrap()
        .0
}

#[test]
fn near_duplicates_on_rough_surfaces() {
    let mut failures = Vec::new();
    for seed in 0..number("NEAR", 12) {
        for distance in [1e-6, 1e-9, 1e-11, 1e-13] {
            let mesh = near_duplicates(8, distance, seed);
            let last = mesh.vertex_count() as u32 - 1;
            for sources in [vec![0], vec![last], vec![3, last - 1]] {
                let name = format!("near duplicates {seed}, {distance:e}");
                check(&name, &mesh, &sources, &mut failures);
            }
        }
    }
    report(&failures);
}

/// Inputs that failed, with all vertices as targets. The test does nothing where they are missing.
#[test]
fn cases_that_failed() {
    let shared = env::var_os("GEOBENCH_SHARED").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        PathBuf::from,
    );
    let mut failures = Vec::new();
    for (name, sources) in [
        ("path-min", [10, 0, 4]),
        ("path-graded-min", [2, 0, 20]),
        ("path-neardup5", [29, 5, 27]),
        ("chain16", [0, 112, 50]),
        ("chain40", [0, 440, 220]),
        ("verify-neardup", [0, 1, 2]),
    ] {
        let file = shared.join(format!("cases/exact/{name}.obj"));
        if !file.exists() {
            continue;
        }
        let mesh = Mesh::read(&file).unwrap();
        for source in sources {
            check(name, &mesh, &[source], &mut failures);
        }
    }
    report(&failures);
}
