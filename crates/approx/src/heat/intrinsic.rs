//! An intrinsic triangulation: it has lengths only, and its edges can be flipped within the
//! surface.

use geobench_mesh::{FaceId, HalfEdgeId, Mesh};
use geobench_window::queue::mean_edge_length;

use super::FlowFace;

/// Least amount by which two sides of a face exceed the third, in mean edge lengths. Without it,
/// faces without area would have no cotangents.
const LEAST_EXCESS: f64 = 1e-10;

/// How negative the sum of the cotangents opposite to an edge must be, relatively, to flip the
/// edge.
const MARGIN: f64 = 1e-10;

/// Most flips, as a multiple of the number of edges.
const MOST_FLIPS: usize = 100;

const NO_TWIN: u32 = u32::MAX;

/// Half-edge `3 * face + corner` starts at that corner. The unit of lengths is the mean edge length
/// of the mesh.
#[derive(Clone, Debug)]
pub(super) struct Intrinsic {
    /// The mean edge length of the mesh.
    unit: f64,
    tails: Vec<u32>,
    twins: Vec<u32>,
    lengths: Vec<f64>,
}

fn next(h: usize) -> usize {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

fn prev(h: usize) -> usize {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

/// The apex over the first of three sides.
fn apex([l, from_head, from_tail]: [f64; 3]) -> [f64; 2] {
    let x = (l * l + (from_tail - from_head) * (from_tail + from_head)) / (2.0 * l);
    let mut sides = [l, from_head, from_tail];
    sides.sort_unstable_by(f64::total_cmp);
    let [c, b, a] = sides;
    // Kahan's form of Heron's formula.
    let product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    [x, 0.5 * product.max(0.0).sqrt() / l]
}

/// The amount by which the two shorter sides exceed the longest.
fn excess([a, b, c]: [f64; 3]) -> f64 {
    (a + b - c).min(b + c - a).min(c + a - b)
}

impl Intrinsic {
    /// The triangulation of `mesh`. If it has faces without area, all edges are lengthened by the
    /// same small amount (Sharp and Crane 2020).
    pub(super) fn new(mesh: &Mesh) -> Self {
        let unit = mean_edge_length(mesh);
        let mut surface = Self {
            unit,
            tails: mesh.half_edges().map(|h| mesh.tail(h).raw()).collect(),
            twins: mesh
                .half_edges()
                .map(|h| mesh.twin(h).map_or(NO_TWIN, HalfEdgeId::raw))
                .collect(),
            lengths: mesh.half_edges().map(|h| mesh.length(h) / unit).collect(),
        };
        let missing = mesh
            .faces()
            .map(|face: FaceId| LEAST_EXCESS - excess(surface.sides(face.index())));
        let missing = missing.fold(0.0, f64::max);
        if missing > 0.0 {
            for length in &mut surface.lengths {
                *length += missing;
            }
        }
        surface
    }

    pub(super) fn unit(&self) -> f64 {
        self.unit
    }

    fn sides(&self, face: usize) -> [f64; 3] {
        [0, 1, 2].map(|k| self.lengths[3 * face + k])
    }

    pub(super) fn faces(&self) -> impl Iterator<Item = FlowFace> {
        (0..self.tails.len() / 3).map(|face| {
            let sides = self.sides(face);
            FlowFace {
                vertices: [0, 1, 2].map(|k| self.tails[3 * face + k]),
                length: sides[0],
                apex: apex(sides),
            }
        })
    }

    /// The apex over half-edge `h` in its frame.
    fn apex(&self, h: usize) -> [f64; 2] {
        apex([h, next(h), prev(h)].map(|h| self.lengths[h]))
    }

    /// Flips edges whose opposite angles exceed π in sum, until there are none or [`MOST_FLIPS`] is
    /// reached.
    pub(super) fn flip_to_delaunay(&mut self) {
        let mut stack: Vec<usize> = (0..self.tails.len()).rev().collect();
        let mut left = MOST_FLIPS.saturating_mul(self.tails.len());
        while let Some(h) = stack.pop() {
            if left > 0
                && let Some(length) = self.flipped(h)
            {
                left -= 1;
                stack.extend(self.flip(h, length));
            }
        }
    }

    /// The length of the other diagonal, if the edge of `h` must be flipped.
    fn flipped(&self, h: usize) -> Option<f64> {
        let g = self.twins[h];
        if g == NO_TWIN || g as usize / 3 == h / 3 {
            return None;
        }
        let g = g as usize;
        let l = self.lengths[h];
        let [above, below] = [self.apex(h), self.apex(g)];
        let cotangents = [above, below].map(|[x, y]| (x * (x - l) + y * y) / (l * y));
        let [a, b] = cotangents;
        if a + b >= -MARGIN * a.abs().max(b.abs()) {
            return None;
        }
        let length = (above[0] - (l - below[0])).hypot(above[1] + below[1]);
        let sides = |x: usize, y: usize| [length, self.lengths[x], self.lengths[y]];
        let both = [sides(prev(g), next(h)), sides(prev(h), next(g))];
        both.iter()
            .all(|&sides| excess(sides) > 0.1 * LEAST_EXCESS)
            .then_some(length)
    }

    /// Replaces the edge of `h` by the other diagonal; returns the half-edges around it.
    fn flip(&mut self, h: usize, length: f64) -> [usize; 4] {
        let g = self.twins[h] as usize;
        let (f0, f1) = (h / 3 * 3, g / 3 * 3);
        // The quadrilateral a, d, b, c around the edge from a to b.
        let old = [next(g), prev(g), next(h), prev(h)];
        let tails = old.map(|h| self.tails[h]);
        let twins = old.map(|h| self.twins[h]);
        let lengths = old.map(|h| self.lengths[h]);
        let [_, d, _, c] = tails;
        let new = [f1 + 2, f0 + 1, f0 + 2, f1 + 1];
        for i in 0..4 {
            self.tails[new[i]] = tails[i];
            self.lengths[new[i]] = lengths[i];
            // Two sides of the quadrilateral may be twins.
            let twin = twins[i];
            let side = (0..4).find(|&k| old[k] as u32 == twin && twin != NO_TWIN);
            if let Some(k) = side {
                self.twins[new[i]] = new[k] as u32;
            } else {
                self.twins[new[i]] = twin;
                if twin != NO_TWIN {
                    self.twins[twin as usize] = new[i] as u32;
                }
            }
        }
        for (at, tail, twin) in [(f0, c, f1), (f1, d, f0)] {
            self.tails[at] = tail;
            self.lengths[at] = length;
            self.twins[at] = twin as u32;
        }
        new
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that half-edges are consistent and that twins have equal lengths.
    fn check(surface: &Intrinsic) {
        for h in 0..surface.tails.len() {
            let g = surface.twins[h];
            if g != NO_TWIN {
                let g = g as usize;
                assert_eq!(surface.twins[g] as usize, h);
                assert_eq!(surface.lengths[h], surface.lengths[g]);
                assert_eq!(surface.tails[h], surface.tails[next(g)]);
            }
            assert!(excess(surface.sides(h / 3)) > 0.0);
        }
    }

    #[test]
    fn flips_end_in_a_delaunay_triangulation_of_the_same_area() {
        for spec in [
            "anisotropic,g=8,faces=1000",
            "torus,faces=800,bump=0.3,seed=5",
            "grid,n=5",
        ] {
            let mesh = Mesh::generate(spec).unwrap();
            let mut surface = Intrinsic::new(&mesh);
            let area = |s: &Intrinsic| s.faces().map(|f| f.area()).sum::<f64>();
            let before = area(&surface);
            surface.flip_to_delaunay();
            check(&surface);
            assert!((area(&surface) - before).abs() < 1e-9 * before, "{spec}");
            assert!((0..surface.tails.len()).all(|h| surface.flipped(h).is_none()));
        }
    }

    #[test]
    fn faces_without_area_get_one() {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
        let mesh = Mesh::new(positions, vec![[0, 1, 2], [2, 3, 0]]).unwrap();
        let surface = Intrinsic::new(&mesh);
        check(&surface);
        let heights: Vec<f64> = surface.faces().map(|face| face.apex[1]).collect();
        assert!(heights.iter().all(|&y| y > 1e-6), "{heights:?}");
    }
}
