//! The Lipschitz check of one face: upper bounds of `d(y) - d(x) - |xy|` for its boundary points.
//!
//! Let x range over an envelope piece on one side. The least `d(x) + |xy|` is a function of the
//! point y on another side. It has three parts ([`LeastDistance`]). Where the segment from the
//! image of the piece to y crosses the piece, the path is *straight*. On either side of this part,
//! the path is *bent*: it turns at an end of the piece.
//!
//! Pairs of pieces that clearly satisfy the condition are accepted in rounded arithmetic, with a
//! margin of about 90 times its error bound. All others are compared again, in the [`Arithmetic`]
//! of the proof.

use std::sync::atomic::{AtomicUsize, Ordering};

use geobench_mesh::{FaceId, HalfEdgeId, Mesh};

use crate::ball::Ball;
use crate::field::{EdgeField, FaceSide};
use crate::interval::greater;
use crate::shape::FaceShape;
use crate::side_pair::{ChainLink, MOST_LINKS, Parts, SidePair};

/// More than the error of rounded arithmetic, as a fraction of the *size* of a face. The size is
/// the greatest distance on its sides plus their lengths.
///
/// Windows have non-negative sigmas. So the distance between an image and a point of the side is at
/// most the distance of the point, and both coordinates of the image are at most the size. Let u be
/// 2^-53, half a unit in the last place of 1. Lengths, cosines and sines are the middles of
/// intervals from at most 20 operations; their error is at most 40 u. An image in the frame of
/// another side is at most 4 times the size from the origin, and results from 7 operations with
/// these factors; its error is at most 300 u of the size. A distance to a given image has an error
/// of at most 4 u of it. Differences and tangents add a few more. The sum is below 1000 u, or
/// 1.2e-13.
pub(crate) const MARGIN: f64 = 1e-11;

/// Sizes of faces for which no square overflows, or underflows by more than the margin covers.
pub(crate) const SIZES: std::ops::Range<f64> = 1e-130..1e130;

/// Greatest number of pairs of pieces of two sides that are compared; with more, nothing is proven
/// for the face. On scans a face has some hundred pairs.
const MOST_PAIRS: usize = 1 << 28;

/// Greatest number of these pairs, for each side, that are compared in numbers of two doubles, so
/// that a face takes seconds at most. The others have the bound of rounded arithmetic.
const MOST_EXACT: usize = 1 << 16;

/// Vectors shorter than this fraction of the margin have no reliable direction.
pub(crate) const TINY: f64 = 0.1;

/// The radius of the neighbourhood of a vertex, as a fraction of its shortest edge. The points in
/// it form one node with the vertex, because segments of almost no length lead around it in all
/// directions.
const NEAR_VERTEX: f64 = 0.01;

/// The radius of the neighbourhood of each vertex.
fn radii(mesh: &Mesh) -> Vec<f64> {
    let mut radii = vec![f64::INFINITY; mesh.vertex_count()];
    for h in mesh.half_edges() {
        for v in [mesh.tail(h), mesh.head(h)] {
            let radius = &mut radii[v.index()];
            *radius = radius.min(NEAR_VERTEX * mesh.length(h));
        }
    }
    radii
}

/// How pairs of pieces are compared of which one is nearly the continuation of the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arithmetic {
    /// In rounded arithmetic. Its error is a violation. In two doubles if more is found.
    Double,
    /// In numbers of two doubles.
    TwoDoubles,
}

/// What the checkers of all faces share.
pub(crate) struct FaceChecks<'a> {
    field: &'a EdgeField<'a>,
    /// The radius of the neighbourhood of each vertex.
    radii: Vec<f64>,
    /// Links with a detour above this are left out.
    clear: f64,
    precision: Arithmetic,
    /// The number of links that all checkers have found.
    found: AtomicUsize,
}

impl<'a> FaceChecks<'a> {
    /// Checks of the pieces of `field`, which leave out links with a detour above `clear`.
    pub(crate) fn new(field: &'a EdgeField<'a>, clear: f64, precision: Arithmetic) -> Self {
        Self {
            field,
            radii: radii(field.mesh),
            clear,
            precision,
            found: AtomicUsize::new(0),
        }
    }

    /// Whether there are more than [`MOST_LINKS`] links, so that checkers have dropped some.
    pub(crate) fn has_too_many_links(&self) -> bool {
        self.found.load(Ordering::Relaxed) > MOST_LINKS
    }
}

/// Checks faces one after another. Keeps its buffers.
pub(crate) struct Checker<'a> {
    shared: &'a FaceChecks<'a>,
    /// The links of the faces that were checked; none if there are too many.
    pub(crate) links: Vec<ChainLink>,
    sides: [FaceSide; 3],
    parts: Parts,
}

impl<'a> Checker<'a> {
    pub(crate) fn new(shared: &'a FaceChecks<'a>) -> Self {
        Self {
            shared,
            links: Vec::new(),
            sides: std::array::from_fn(|_| FaceSide::default()),
            parts: Parts::default(),
        }
    }

    /// An upper bound of `d(y) - d(x) - |xy|` over all points x and y of the boundary of `face`, at
    /// least 0, and the side on which d(y) is too long. Adds the links across the face.
    pub(crate) fn violation(&mut self, face: FaceId) -> (f64, HalfEdgeId) {
        let field = self.shared.field;
        if (0..3).all(|k| field.pieces(face.half_edge(k)).is_empty()) {
            return (0.0, face.half_edge(0));
        }
        let before = self.links.len();
        let mut sides = std::mem::take(&mut self.sides);
        let shape = FaceShape::of(self.shared.field.mesh, face);
        let lengths = shape.lengths.map(Ball::middle);
        for (k, side) in (0..).zip(&mut sides) {
            side.set(self.shared.field, face.half_edge(k), lengths[k as usize]);
        }
        let found = self.violation_of_sides(face, &shape, lengths, &sides);
        self.sides = sides;
        let new = self.links.len() - before;
        self.shared.found.fetch_add(new, Ordering::Relaxed);
        if self.shared.has_too_many_links() {
            self.links = Vec::new();
        }
        found
    }

    /// The same, from the pieces of all `sides`. Infinite if they are too many, or too large or too
    /// small for rounded arithmetic.
    fn violation_of_sides(
        &mut self,
        face: FaceId,
        shape: &FaceShape,
        lengths: [f64; 3],
        sides: &[FaceSide; 3],
    ) -> (f64, HalfEdgeId) {
        let nothing = (f64::INFINITY, face.half_edge(0));
        let size = FaceSize::of(sides, lengths);
        if !SIZES.contains(&size.all) || has_too_many_pairs(sides) {
            return nothing;
        }
        let compared = ComparedSides {
            face,
            shape,
            lengths,
            sides,
            corners: self.corners(face),
            margin: MARGIN * size.all,
            error: size.error(self.off(face, lengths)),
        };
        let mut most = (0.0_f64, face.half_edge(0));
        for k in 0..3 {
            let Some((violation, side)) = self.violation_from(&compared, k) else {
                return nothing;
            };
            if violation > most.0 {
                most = (violation, face.half_edge(side as u32));
            }
        }
        most
    }

    /// The nodes of the corners of `face`, and the radii of their neighbourhoods.
    fn corners(&self, face: FaceId) -> [(usize, f64); 3] {
        let corners = self.shared.field.mesh.face_vertices(face);
        corners.map(|v| (v.index(), self.shared.radii[v.index()]))
    }

    /// How much the lengths of the sides of `face` differ in the mesh from the exact ones.
    fn off(&self, face: FaceId, lengths: [f64; 3]) -> f64 {
        let mesh = self.shared.field.mesh;
        let off = |k: usize| (mesh.length(face.half_edge(k as u32)) - lengths[k]).abs();
        off(0) + off(1) + off(2)
    }

    /// An upper bound of the violations by paths from side `k`, at least 0, and the side on which
    /// they are greatest. Adds the links. `None` if a side has no reliable image.
    fn violation_from(&mut self, compared: &ComparedSides<'_>, k: usize) -> Option<(f64, usize)> {
        let (face, margin, error) = (compared.face, compared.margin, compared.error);
        let ends = |k: usize| [compared.corners[k], compared.corners[(k + 1) % 3]];
        let (mut found, mut worst) = (0.0_f64, k);
        let mut skips_bends = false;
        for step in [1, 2] {
            let there = (k + step) % 3;
            let transform = compared.shape.transform(k, step);
            let near = transform.rounded(TINY * margin);
            if !near.is_finite() {
                return None;
            }
            let mut across = SidePair {
                field: self.shared.field,
                sides: [&compared.sides[k], &compared.sides[there]],
                half_edges: [k, there].map(|k| face.half_edge(k as u32)),
                exact_lengths: [k, there].map(|k| compared.shape.lengths[k]),
                lengths: [k, there].map(|k| compared.lengths[k]),
                transform: &transform,
                near,
                balls: [ends(k), ends(there)],
                margin,
                error,
                accepted: match self.shared.precision {
                    Arithmetic::Double => 2.0 * error,
                    Arithmetic::TwoDoubles => 0.0,
                },
                clear: self.shared.clear,
                excess: found,
                exact_left: MOST_EXACT,
                skips_bends: false,
                parts: &mut self.parts,
            };
            across.compare_all(&mut self.links);
            skips_bends |= across.skips_bends;
            if across.excess > found {
                (found, worst) = (across.excess, there);
            }
        }
        // Between two points of one side, only jumps violate the condition. A path that bends at a
        // concave kink is no shorter than one through the next piece, up to the jump at the kink.
        let side = self.shared.field.mesh.edge_of(face.half_edge(k as u32));
        let jump = self.shared.field.jumps[side.index()];
        let violation = if skips_bends {
            (found + jump).next_up()
        } else {
            greater(found, jump)
        };
        Some((violation, if jump > found { k } else { worst }))
    }
}

/// Whether two of `sides` have more pairs of pieces than are compared.
fn has_too_many_pairs(sides: &[FaceSide; 3]) -> bool {
    let count = |k: usize| sides[k % 3].pieces.len();
    (0..3).any(|k| count(k).saturating_mul(count(k + 1)) > MOST_PAIRS)
}

/// The sides of a face that are compared with each other.
struct ComparedSides<'a> {
    face: FaceId,
    shape: &'a FaceShape,
    lengths: [f64; 3],
    sides: &'a [FaceSide; 3],
    /// The nodes of the corners, and the radii of their neighbourhoods.
    corners: [(usize, f64); 3],
    margin: f64,
    /// See [`FaceSize::error`].
    error: f64,
}

/// What rounding errors in a face are relative to.
pub(crate) struct FaceSize {
    /// The greatest distance on the sides plus their lengths.
    pub(crate) all: f64,
    /// The greatest distance of a point of a side from its image, plus the lengths of the sides.
    reach: f64,
}

impl FaceSize {
    pub(crate) fn of(sides: &[FaceSide; 3], lengths: [f64; 3]) -> Self {
        let (mut all, mut reach) = (0.0, 0.0);
        for piece in sides.iter().flat_map(|side| &side.pieces) {
            let most = greater(piece.at_ends()[0], piece.at_ends()[1]);
            all = greater(most, all);
            reach = greater(most - piece.distance.sigma, reach);
        }
        let lengths = lengths.iter().sum::<f64>();
        Self {
            all: all + lengths,
            reach: reach + lengths,
        }
    }

    /// More than the error of a difference of two distances in rounded arithmetic, one of them by
    /// paths across the face. `off` is how much the lengths of the sides differ in the mesh from
    /// the exact ones: the last piece of a side ends by the one, and the side by the other.
    ///
    /// Let u be 2^-53 and R the reach. The ends and the image of a piece are exact in one direction
    /// of the edge; in the other, they result from a subtraction of the rounded length: 2uR. A
    /// length, a cosine and a sine have an error of u each. So the image in the frame of another
    /// side, at most R from each of its points, has an error of 12uR, and the end of a piece, with
    /// a distance of its own, one of 16uR. A distance to an image has an error of 4uR. That of a
    /// point changes by no more than the point. A tangent adds 5uR. In all this is at most 60uR.
    /// Four sums contain a sigma, and have an error of u times the size.
    fn error(&self, off: f64) -> f64 {
        f64::EPSILON * (32.0 * self.reach + 4.0 * self.all) + 4.0 * off
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::{Mesh, SplitMix64, VertexId};
    use geobench_mmp::{mmp, windows_of};
    use geobench_window::Solver;

    use super::*;
    use crate::Claim;
    use crate::difference::Distance;
    use crate::envelope::{EnvelopePiece, WindowData};
    use crate::field::ExactPiece;

    /// Face 11996 of the scan igea, source vertex 0, and two of its pieces. The paths that bend at
    /// the end of the first piece reach exactly the end of the second, where the straight ones
    /// begin.
    #[test]
    #[expect(clippy::unreadable_literal, reason = "as the program prints them")]
    fn pieces_that_meet_in_one_point_are_compared_there() {
        let positions = vec![
            [
                0.028835000470280647,
                0.025356000289320946,
                -0.008697000332176685,
            ],
            [
                0.02889700047671795,
                0.025023000314831734,
                -0.008716000244021416,
            ],
            [
                0.0287299994379282,
                0.025356000289320946,
                -0.009185000322759151,
            ],
            [0.029, 0.0252, -0.0084],
            [0.0287, 0.0257, -0.0089],
        ];
        // Two other faces with lower numbers, so that sides 0 and 2 are not canonical.
        let mesh = Mesh::new(positions, vec![[1, 0, 3], [0, 2, 4], [0, 1, 2]]).unwrap();
        let far = EnvelopePiece {
            from: 1.4883927423876347e-15,
            to: 8.178653061323015e-5,
            image: [-0.03639741439737471, 0.0034468109485394187],
            sigma: 0.05372740948147406,
        };
        let near = EnvelopePiece {
            from: 3.20819438888775e-5,
            to: 3.218347146565396e-5,
            image: [5.532985414092948e-6, 0.0003392099151418724],
            sigma: 0.09028766495827824,
        };
        let field = EdgeField {
            mesh: &mesh,
            ranges: [0..1, 1..1, 1..1, 1..2, 2..2, 2..2, 2..2, 2..2, 2..2].to_vec(),
            pieces: vec![far, near],
            jumps: vec![0.0; 9],
        };
        let violation = |field: &EdgeField<'_>, precision| {
            Checker::new(&FaceChecks::new(field, 1e-9, precision)).violation(FaceId::new(2))
        };
        for precision in [Arithmetic::Double, Arithmetic::TwoDoubles] {
            let (found, _) = violation(&field, precision);
            assert!(found < 1e-12, "{found:e}");
        }
        // The pair is compared: making the second piece longer is a violation.
        let mut field = field;
        field.pieces[1].sigma += 1e-10;
        for precision in [Arithmetic::Double, Arithmetic::TwoDoubles] {
            let (found, side) = violation(&field, precision);
            assert_eq!(side, FaceId::new(2).half_edge(2));
            assert!(found > 0.9e-10 && found < 1.1e-10, "{found:e}");
        }
    }

    /// The greatest violation of a face that samples show: at the ends of pieces and between them,
    /// and where straight lines to them begin.
    fn sampled(field: &EdgeField<'_>, face: FaceId) -> f64 {
        let shape = FaceShape::of(field.mesh, face);
        let sides = [0, 1, 2].map(|k| {
            let (h, length) = (face.half_edge(k), shape.lengths[k as usize]);
            let mut side = FaceSide::default();
            side.set(field, h, length.middle());
            let pieces = side.pieces.iter().map(|p| field.exact(h, length, p.node));
            pieces.collect::<Vec<_>>()
        });
        let mut most = f64::NEG_INFINITY;
        for (k, step) in (0..3).flat_map(|k| [(k, 1), (k, 2)]) {
            let there = (k + step) % 3;
            let [onto, back] = [(k, step), (there, 3 - step)].map(|(k, step)| {
                let transform = shape.transform(k, step);
                move |t: Ball| {
                    let point = Distance {
                        image: [t, Ball::ZERO],
                        sigma: Ball::ZERO,
                    };
                    transform.straight(&point)
                }
            });
            for (from, other) in sides[k]
                .iter()
                .flat_map(|p| sides[there].iter().map(move |q| (p, q)))
            {
                let between = |p: &ExactPiece, at: f64| p.from + (p.to - p.from) * Ball::exact(at);
                for at in [0.0, 0.3, 0.5, 0.9, 1.0] {
                    let y = between(other, at);
                    let [image, point] =
                        [&from.distance, &back(y)].map(|d| d.image.map(Ball::middle));
                    let part = image[1].abs() / (image[1].abs() + point[1].abs());
                    let crossing = image[0] + (point[0] - image[0]) * part;
                    let [first, last] = [from.from, from.to];
                    let crossing = Ball::exact(crossing);
                    let mut starts = vec![first, last, between(from, 0.4)];
                    if crossing.middle() > first.upper() && crossing.middle() < last.lower() {
                        starts.push(crossing);
                    }
                    for x in starts {
                        let by = other.distance.at(y) - from.distance.at(x) - onto(x).at(y);
                        most = greater(by.lower(), most);
                    }
                }
            }
        }
        most
    }

    /// Fields of a solver, and the same with errors of all sizes.
    #[test]
    fn no_sample_exceeds_a_violation() {
        let mut random = SplitMix64::new(7);
        for (spec, stretch) in [
            ("torus,faces=60,bump=0.2,seed=3", 1.0),
            ("terrain,n=4,seed=2", 1.0),
            ("terrain,n=4,seed=2", 1e4),
        ] {
            let mut mesh = Mesh::generate(spec).unwrap();
            let faces = mesh
                .faces()
                .map(|f| mesh.face_vertices(f).map(VertexId::raw));
            let positions = mesh
                .positions()
                .iter()
                .map(|&[x, y, z]| [stretch * x, y, z]);
            mesh = Mesh::new(positions.collect(), faces.collect()).unwrap();
            let source = [VertexId::new(0)];
            let mut solver = mmp(&mesh);
            let distances = solver.distances_from(0).unwrap();
            let claim = Claim::new(&mesh, &source, &distances).unwrap();
            for by in [0.0, 1e-16, 1e-15, 1e-14, 1e-12, 1e-6] {
                let windows: Vec<Vec<WindowData>> = mesh
                    .half_edges()
                    .map(|h| {
                        let mut moved = |x: f64| x * (1.0 + by * (random.unit() - 0.5));
                        let all = windows_of(&solver, h);
                        let of = all.map(|w| WindowData {
                            interval: [w.b0, w.b1],
                            image: [moved(w.px), moved(w.py)],
                            sigma: moved(w.sigma),
                        });
                        of.collect()
                    })
                    .collect();
                let field = claim.edge_field(|h| windows[h.index()].iter().copied());
                for face in mesh.faces() {
                    let least = sampled(&field, face);
                    let found = [Arithmetic::Double, Arithmetic::TwoDoubles].map(|precision| {
                        let checks = FaceChecks::new(&field, 1e-9, precision);
                        Checker::new(&checks).violation(face).0
                    });
                    let of = format!("{spec}, {stretch}, {by:e}, {face}: {found:?} {least:e}");
                    assert!(found.iter().all(|&bound| bound >= least), "{of}");
                    let rounding = 1e-13 * claim.scale(face);
                    assert!(found[0] <= found[1] + rounding, "{of}");
                }
            }
        }
    }
}
