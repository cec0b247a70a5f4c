//! Chains of cells. Each cell ends at a pseudo-source that a path reaches first that is longer than
//! the shortest one by less than a comparison of windows can resolve. Errors must not add up.

use geobench_mesh::VertexId;
use geobench_oracle::{DoubleDouble, Model, Random, Search, rounded, search};
use geobench_registry::select;

use crate::goals;
use crate::support::{Failures, ROUNDING, Run, exact_runs, mesh_of};

/// Far more beams than the oracle needs for any chain here.
const MOST_BEAMS: u64 = 300_000;

/// A few roundings of the greatest distance, whatever the number of cells.
const PLAIN: f64 = 4e-15;

/// A chain of cells along the x axis, under construction.
#[derive(Default)]
struct Chain {
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    /// The vertices at which cells end, on the x axis.
    pins: Vec<u32>,
}

impl Chain {
    /// A chain that begins at vertex 0 with a triangle of this length; without one if it is 0.
    fn behind(length: f64) -> Self {
        let mut chain = Self::default();
        chain.pin(0.0);
        if length > 0.0 {
            let corner = chain.vertex([0.5 * length, -0.5 * length, 0.0]);
            let end = chain.pin(length);
            chain.faces.push([0, corner, end]);
        }
        chain
    }

    fn vertex(&mut self, position: [f64; 3]) -> u32 {
        self.positions.push(position);
        self.positions.len() as u32 - 1
    }

    fn pin(&mut self, x: f64) -> u32 {
        let v = self.vertex([x, 0.0, 0.0]);
        self.pins.push(v);
        v
    }

    /// The last pin and its abscissa.
    fn end(&self) -> (u32, f64) {
        let &v = self.pins.last().expect("every chain has a pin");
        (v, self.positions[v as usize][0])
    }

    /// A cell of two routes from pin to pin, each as wide as `width`: one across `rows` rows of
    /// vertices in the plane, and one of two faces, which is longer by `loss`.
    fn pinched(mut self, length: f64, width: f64, rows: u32, loss: f64) -> Self {
        let (first, x) = self.end();
        let length = x + length - x;
        let bump = (0.5 * loss * length).sqrt();
        let [r, s] =
            [1.0, -1.0].map(|side| self.vertex([x + 0.5 * length, 0.5 * side * width, bump]));
        let ways = f64::from(rows + 1);
        let rows: Vec<[u32; 2]> = (1..=rows)
            .map(|row| {
                let x = x + length * f64::from(row) / ways;
                [1.0, -1.0].map(|side| self.vertex([x, 0.5 * side * width, 0.0]))
            })
            .collect();
        let last = self.pin(x + length);
        self.faces.extend([[first, s, r], [last, r, s]]);
        let [r, s] = rows[0];
        self.faces.push([first, s, r]);
        for pair in rows.windows(2) {
            let ([r, s], [far_r, far_s]) = (pair[0], pair[1]);
            self.faces.extend([[r, s, far_s], [r, far_s, far_r]]);
        }
        let [r, s] = rows[rows.len() - 1];
        self.faces.push([last, r, s]);
        self
    }

    /// A strip of triangles of random sizes around `size`. Its vertices lie up to `height` above or
    /// below the plane, so that they are saddles, or paths bend around them by less than that.
    fn strip(mut self, columns: u32, size: f64, height: f64, random: &mut Random) -> Self {
        let (first, mut x) = self.end();
        let mut column = vec![first];
        for k in 0..columns {
            x += size * random.between(0.6, 1.4);
            let rows = 1 + random.below(3);
            let next: Vec<u32> = if k + 1 == columns {
                vec![self.pin(x)]
            } else {
                let row = |row| {
                    let y = size * (2.0 * f64::from(row) / f64::from(rows) - 1.0);
                    let [dx, dy, z] = random.in_ball();
                    self.vertex([x + 0.2 * size * dx, y + 0.1 * size * dy, height * z])
                };
                (0..=rows).map(row).collect()
            };
            let (mut i, mut j) = (0, 0);
            while i + 1 < column.len() || j + 1 < next.len() {
                if i + 1 == column.len()
                    || j + 1 < next.len() && (j + 1) * column.len() <= (i + 1) * next.len()
                {
                    self.faces.push([column[i], next[j], next[j + 1]]);
                    j += 1;
                } else {
                    self.faces.push([column[i], next[j], column[i + 1]]);
                    i += 1;
                }
            }
            column = next;
        }
        self
    }

    /// The distances of the pins from the nearest of `sources`, which are pins. In a chain without
    /// strips the shortest paths are straight.
    fn distances_of_pins(&self, sources: &[u32]) -> Vec<(usize, f64)> {
        let x = |v: u32| self.positions[v as usize][0];
        let distance = |v: u32| {
            let from = sources.iter().map(|&source| (x(v) - x(source)).abs());
            from.fold(f64::INFINITY, f64::min)
        };
        self.pins
            .iter()
            .map(|&v| (v as usize, distance(v)))
            .collect()
    }

    fn model(&self, name: String) -> Model {
        Model::new(name, self.positions.clone(), self.faces.clone())
    }
}

/// Thin cells of width 1. One route is longer by what a position on so long an edge can resolve.
fn thin(cells: u32, length: f64) -> Chain {
    let cell = |chain: Chain, _| chain.pinched(length, 1.0, 4, 3.6e-15);
    (0..cells).fold(Chain::behind(0.0), cell)
}

/// Small cells of good shape, far from the source. One route is longer by nearly 1e-13 of the
/// distance.
fn far(cells: u32) -> Chain {
    let cell = |chain: Chain, _| {
        let (_, x) = chain.end();
        chain.pinched(1e-5, 6e-6, 4, 0.95e-13 * x)
    };
    (0..cells).fold(Chain::behind(1.0), cell)
}

/// Cells of all kinds, lengths and differences.
fn mixed(seed: u64) -> Chain {
    let mut random = Random::new(seed);
    let size = 10_f64.powf(random.between(-6.0, -1.0));
    let mut chain = Chain::behind(f64::from(random.below(2)));
    for _ in 0..3 + random.below(20) {
        // Up to twice what counts as equal.
        let loss = random.between(0.0, 2e-13) * (chain.end().1 + size);
        chain = match random.below(5) {
            0 => chain.pinched(size, 1.0, 2 + random.below(4), random.between(0.0, 8e-15)),
            1 | 2 => chain.pinched(size, size, 2 + random.below(4), loss),
            _ => chain.strip(2 + random.below(8), size, (size * loss).sqrt(), &mut random),
        };
    }
    chain
}

/// Checks the pins of a chain without strips from both ends.
fn check(name: &str, chain: &Chain, mut runs: Vec<Run<'_>>, failures: &mut Failures) {
    let (end, _) = chain.end();
    for run in &mut runs {
        for sources in [&[0][..], &[end], &[0, end]] {
            let found = run.distances(sources);
            let expected = chain.distances_of_pins(sources);
            let at = || format!("{name}, {}", run.at(sources));
            failures.compare(at, &found, expected, PLAIN);
        }
    }
}

#[test]
fn no_error_adds_up_along_a_chain_of_any_length() {
    let mut failures = Failures::default();
    for cells in [1, 4, 16, 64] {
        for (name, chain) in [
            ("thin cells", thin(cells, 1e-6)),
            ("thinner cells", thin(cells, 1e-9)),
            ("cells far away", far(cells)),
        ] {
            let name = format!("{cells} {name}");
            let mesh = mesh_of(&chain.model(name.clone()));
            check(&name, &chain, exact_runs(&name, &mesh), &mut failures);
        }
    }
    failures.report();
}

/// Runs for minutes.
#[test]
#[ignore = "slow: 130,000 faces"]
fn no_error_adds_up_along_a_very_long_chain() {
    // Without the algorithms that take windows first in, first out, or in wide buckets: they send
    // windows from the last vertex once for each cell.
    let algorithms = "mmp,mmp-edge,mmp-fast,ich,lc-mmp,lc-ch,vtp-mmp,vtp-ch,ftp,vtp,vtp-trimming,\
        edge-based,window-vtp,lct11,xls14,vtp-fast,vtp-fast{simd=scalar},pvtp{threads=2}";
    let mut failures = Failures::default();
    for (name, chain) in [
        ("1,000 thin cells", thin(1000, 1e-9)),
        ("13,000 cells far away", far(13_000)),
    ] {
        let mesh = mesh_of(&chain.model(name.to_owned()));
        let runs = select(algorithms).expect("all are algorithms");
        let runs = runs.into_iter().map(|a| Run::new(a, name, &mesh)).collect();
        check(name, &chain, runs, &mut failures);
    }
    failures.report();
}

#[test]
fn mixed_chains_match_the_oracle() {
    let mut failures = Failures::default();
    for seed in 0..24 {
        let chain = mixed(seed);
        let name = format!("mixed chain {seed}");
        let model = chain.model(name.clone());
        let mesh = mesh_of(&model);
        // The mesh has its faces oriented consistently.
        let faces = mesh.faces().map(|f| mesh.face_vertices(f));
        let faces = faces.map(|corners| corners.map(VertexId::raw)).collect();
        let surface = Model::new("", chain.positions.clone(), faces).surface::<DoubleDouble>();
        let (end, _) = chain.end();
        for sources in [&[0][..], &[0, end]] {
            let found = search(&surface, sources, Search::pruned(MOST_BEAMS));
            let expected = rounded(&found.expect("enough beams for every chain"));
            for mut run in exact_runs(&name, &mesh) {
                let found = run.distances(sources);
                failures.compare_all(|| run.at(sources), &found, &expected, ROUNDING);
            }
        }
    }
    failures.report();
}

#[test]
fn runs_along_a_chain_may_end_early() {
    let mut failures = Failures::default();
    for (seed, chain) in [(1, thin(16, 1e-6)), (2, far(16)), (3, mixed(0))] {
        let mesh = mesh_of(&chain.model(String::new()));
        for mut run in exact_runs("chain", &mesh) {
            goals::check(&mut run, &[0], seed, &mut failures);
        }
    }
    failures.report();
}
