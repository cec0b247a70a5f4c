//! Certificates of random meshes: their bounds hold, and no wrong distance is certified.

use std::path::Path;

use geobench_mesh::{Mesh, Tolerance, TriangleSoup, VertexId};
use geobench_oracle::{DoubleDouble, Model, Random, Search, nasty, rounded, search};
use geodesics::{Certificate, Distances, Judgement};

const TOLERANCE: f64 = 1e-9;

/// A random mesh with its sources and the right distances. `None` if the mesh has a defect or the
/// oracle takes too long.
fn case(seed: u64) -> Option<(Mesh, Vec<u32>, Vec<f64>)> {
    let model = nasty::mesh(seed).model;
    let positions = model.positions()?.to_vec();
    let soup = TriangleSoup::new(positions.clone(), model.triangles.clone());
    let (mesh, _) = Mesh::from_soup(soup).ok()?;
    // The mesh has its faces oriented consistently.
    let faces = mesh.faces().map(|f| mesh.face_vertices(f));
    let faces = faces.map(|corners| corners.map(VertexId::raw)).collect();
    let surface = Model::new("", positions, faces).surface::<DoubleDouble>();
    let kept = model.sources.iter().map(|&v| mesh.kept_vertex(v.into()));
    let kept: Vec<u32> = kept.map(VertexId::raw).collect();
    let found = search(&surface, &kept, Search::pruned(20_000)).ok()?;
    let mut right = rounded(&found);
    mesh.fill_copies(&mut right);
    Some((mesh, model.sources, right))
}

/// A field with its proof, and the right distances.
struct Proven {
    proof: Certificate,
    right: Vec<f64>,
    rule: Tolerance,
}

impl Proven {
    /// Whether a distance is wrong beyond what the rule allows, with some space for the bounds.
    fn is_wrong(&self, v: usize, given: f64) -> bool {
        let right = self.right[v];
        given.is_nan()
            || given != right && (given - right).abs() > 2.0 * self.rule.allowed(v, right)
    }

    /// The vertices with a wrong distance that is proven right.
    fn accepted(&self, given: &[f64]) -> Vec<usize> {
        let accepts = |&v: &usize| {
            self.is_wrong(v, given[v])
                && self.proof.judge(v, given[v], TOLERANCE) == Judgement::Right
        };
        (0..given.len()).filter(accepts).collect()
    }

    /// The vertices whose right distances are said to be wrong.
    fn refuted(&self) -> Vec<usize> {
        let refutes = |&v: &usize| {
            matches!(
                self.proof.judge(v, self.right[v], TOLERANCE),
                Judgement::Wrong(_)
            )
        };
        (0..self.right.len()).filter(refutes).collect()
    }

    /// The vertices whose bounds do not enclose the right distance, which is known up to
    /// `rounding`.
    fn outside(&self, rounding: f64) -> Vec<usize> {
        let is_outside = |&v: &usize| {
            let ([least, greatest], d) = (self.proof.bounds(v), self.right[v]);
            least * (1.0 - rounding) > d || greatest * (1.0 + rounding) < d
        };
        (0..self.right.len()).filter(is_outside).collect()
    }
}

#[test]
fn no_damaged_field_is_certified() {
    const NONE: [usize; 0] = [];
    let (mut proven, mut all) = (0, 0);
    for seed in 0..600 {
        let Some((mesh, sources, right)) = case(seed) else {
            continue;
        };
        let proof = Certificate::of(&mesh, &sources).unwrap();
        let rule = Tolerance::on(&mesh, &right);
        all += 1;
        proven += usize::from(proof.relative() <= TOLERANCE);
        let field = Proven { proof, right, rule };
        assert_eq!(field.outside(1e-15), NONE, "seed {seed}: bounds");
        assert_eq!(field.refuted(), NONE, "seed {seed}: right distances");
        let right = &field.right;
        let mut random = Random::new(seed);
        for change in [
            1.0 + 1e-6,
            1.0 - 1e-6,
            1.0 + 1e-3,
            0.0,
            f64::NAN,
            f64::INFINITY,
        ] {
            let moved: Vec<f64> = right.iter().map(|d| d * change).collect();
            assert_eq!(field.accepted(&moved), NONE, "seed {seed}: times {change}");
            // A block of vertices.
            let first = random.below(right.len() as u32) as usize;
            let mut block = right.clone();
            let end = right.len().min(first + 5);
            block[first..end].copy_from_slice(&moved[first..end]);
            assert_eq!(
                field.accepted(&block),
                NONE,
                "seed {seed}: block times {change}"
            );
        }
        let mut exchanged = right.clone();
        for _ in 0..10 {
            let [a, b] = [0; 2].map(|_| random.below(right.len() as u32) as usize);
            exchanged.swap(a, b);
        }
        assert_eq!(field.accepted(&exchanged), NONE, "seed {seed}: exchanged");
        let v = random.below(right.len() as u32) as usize;
        let mut positions = mesh.positions().to_vec();
        positions[v] = positions[v].map(|x| x + random.between(-0.1, 0.1) * mesh.longest_edge());
        let corners = mesh.faces().map(|f| mesh.face_vertices(f));
        let corners = corners.map(|corners| corners.map(VertexId::raw)).collect();
        if let Ok((other, _)) = Mesh::from_soup(TriangleSoup::new(positions, corners)) {
            let given = other.distances_from(&sources[..]).unwrap();
            assert_eq!(
                field.accepted(&given),
                NONE,
                "seed {seed}: vertex {v} elsewhere"
            );
        }
        if sources.len() > 1 {
            let fewer = mesh.distances_from(&sources[1..]).unwrap();
            assert_eq!(
                field.accepted(&fewer),
                NONE,
                "seed {seed}: a source missing"
            );
        }
    }
    assert!(all > 400 && proven > all * 2 / 3, "{proven} of {all}");
}

/// The proof takes sixth powers of lengths. With edges near 1e57, thin faces had bounds of up to
/// the whole distance.
#[test]
fn proofs_do_not_depend_on_the_unit() {
    let mut proven = 0;
    for seed in 0..60 {
        let model = nasty::mesh(seed).model;
        let positions = model.positions().unwrap();
        let scaled = |factor: f64| {
            let positions = positions.iter().map(|p| p.map(|x| x * factor)).collect();
            Mesh::from_soup(TriangleSoup::new(positions, model.triangles.clone()))
        };
        let Ok((mesh, _)) = scaled(1.0) else { continue };
        let proof = Certificate::of(&mesh, &model.sources[..]).unwrap();
        if proof.relative() > TOLERANCE {
            continue;
        }
        let lengths = mesh.half_edges().map(|h| mesh.length(h));
        let shortest = lengths.fold(f64::INFINITY, f64::min);
        // Lengths may be from 1e-60 to 1e60.
        for limit in [190.0 - mesh.longest_edge().log2(), -190.0 - shortest.log2()] {
            let Ok((mesh, _)) = scaled(limit.floor().exp2()) else {
                continue;
            };
            let proof = Certificate::of(&mesh, &model.sources[..]).unwrap();
            let error = proof.relative();
            assert!(error <= TOLERANCE, "seed {seed}, 2^{limit}: {error}");
            proven += 1;
        }
    }
    assert!(proven > 60, "{proven}");
}

#[path = "../../oracle/examples/fuzz/slivers.rs"]
mod slivers;

/// The file has distances that two propagations in 128-bit floats agree on to 1e-12.
#[test]
fn slivers_are_proven_and_no_damaged_field_is() {
    const NONE: [usize; 0] = [];
    let Ok(all) = slivers::read() else {
        println!("without {}", slivers::path().display());
        return;
    };
    let mut failed = Vec::new();
    let count = all.len();
    for sliver in all {
        let name = sliver.name;
        let soup = TriangleSoup::new(sliver.vertices, sliver.faces);
        let (mesh, _) = Mesh::from_soup(soup).unwrap();
        let proof = Certificate::of(&mesh, &sliver.source[..]).unwrap();
        if proof.relative() > TOLERANCE {
            failed.push(name.clone());
        }
        let right = sliver.distances.iter();
        let right: Vec<f64> = right.map(|d| d.unwrap_or(f64::INFINITY)).collect();
        let rule = Tolerance::on(&mesh, &right);
        let field = Proven { proof, right, rule };
        assert_eq!(field.outside(1e-12), NONE, "{name}: bounds");
        assert_eq!(field.refuted(), NONE, "{name}: right distances");
        for change in [1.0 + 1e-6, 1.0 - 1e-6, 0.0, f64::NAN, f64::INFINITY] {
            let moved: Vec<f64> = field.right.iter().map(|d| d * change).collect();
            assert_eq!(field.accepted(&moved), NONE, "{name}: times {change}");
        }
        let mut exchanged = field.right.clone();
        exchanged.reverse();
        assert_eq!(field.accepted(&exchanged), NONE, "{name}: exchanged");
    }
    assert!(20 * failed.len() <= count, "{failed:?} of {count}");
}

/// Paths with up to 1,000 bends were traced from the source to each vertex, for minutes.
#[test]
fn chains_are_proven() {
    for name in ["chain16", "chain40", "chain1000"] {
        let shared = slivers::path();
        let shared = shared.parent().and_then(Path::parent).unwrap();
        let path = shared.join(format!("cases/exact/{name}.obj"));
        let Ok(mesh) = Mesh::read(&path) else {
            println!("without {}", path.display());
            continue;
        };
        let proof = Certificate::of(&mesh, 0).unwrap();
        assert!(
            proof.relative() <= TOLERANCE,
            "{name}: {}",
            proof.relative()
        );
    }
}
