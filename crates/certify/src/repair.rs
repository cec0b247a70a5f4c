//! Windows that a solver left out.
//!
//! Solvers drop windows that are narrower than their margin, such as those of a saddle vertex whose
//! angle exceeds a full turn by a billionth. The windows beside a dropped one diverge, so the gap
//! between them grows from edge to edge: 1e-10 of an edge becomes 1e-7 after a few faces. In a gap
//! only paths along the edge are left, which are far too long. The proof may use any function on
//! the edges, so a gap is filled here by the windows that reach it through the faces beside it:
//! straight continuations, and those that bend at the end of a piece.
//!
//! A repair only lowers the function. Where a claimed distance itself is too long, it differs from
//! the repaired function, and the proof counts this difference.

use geobench_mesh::{FaceId, HalfEdgeId};

use crate::ball::Ball;
use crate::difference::{Chord, RoundedDistance};
use crate::envelope::{EnvelopeBuilder, EnvelopePiece, WindowData, piece};
use crate::face::{FaceSize, MARGIN, SIZES, TINY};
use crate::field::{EdgeField, FaceSide, PieceBlock, canonical};
use crate::interval::{greater, lesser};
use crate::shape::FaceShape;

/// Checks of faces in a repair: this many and one for each [`FACES_PER_CHECK`] faces. On scans a
/// few dozen faces have gaps, of 1e-10 and more of their size; rounding of 1e-14 and more is in
/// half of all faces, and its repair would take longer than the proof.
const MOST_CHECKS: usize = 2000;
const FACES_PER_CHECK: usize = 20;

/// Comparisons of pieces for each of these checks. A check compares all pairs of the pieces of a
/// face; sides of nearly flat faces gathered thousands, and a mesh of 100 faces took 18 s.
const COMPARISONS_PER_CHECK: usize = 100_000;

/// Comparisons for each piece of an edge that gets another one. It takes time and memory.
const COMPARISONS_PER_PIECE: usize = 100;

/// A violation above this fraction of the size of a face is repaired.
pub(crate) const REPAIR: f64 = 1e-14;

/// Lowers the distances on the sides of these faces, worst first, and on those that follow, until
/// no face has a violation above rounding, or there were too [many checks](MOST_CHECKS) or
/// [comparisons](COMPARISONS_PER_CHECK). Returns the faces that were checked and those with a
/// changed side, sorted.
pub(crate) fn repair(field: &mut EdgeField<'_>, worst_first: &[FaceId]) -> Vec<FaceId> {
    let mesh = field.mesh;
    let mut left = MOST_CHECKS + mesh.face_count() / FACES_PER_CHECK;
    let mut comparisons = left.saturating_mul(COMPARISONS_PER_CHECK);
    let mut faces = worst_first[..left.min(worst_first.len())].to_vec();
    let mut touched = faces.clone();
    let mut sides: [FaceSide; 3] = std::array::from_fn(|_| FaceSide::default());
    let mut envelope = Vec::new();
    let mut builder = EnvelopeBuilder::default();
    while !faces.is_empty() {
        left -= faces.len();
        let mut found = Vec::new();
        for face in faces {
            let counts = face.half_edges().map(|h| field.pieces(h).len());
            let pieces = counts.into_iter().sum::<usize>();
            let Some(rest) = comparisons.checked_sub(pieces * pieces) else {
                left = 0;
                break;
            };
            comparisons = rest;
            shorter_windows(field, face, &mut sides, &mut found);
        }
        // Many of them are the same up to rounding, so each is compared again after those that are
        // shorter.
        found.sort_by(|a, b| a.edge.cmp(&b.edge).then(b.by.total_cmp(&a.by)));
        faces = Vec::new();
        for shorter in found {
            let (edge, window) = (shorter.edge, shorter.window);
            let pieces = field.pieces(edge);
            let Some(rest) = comparisons.checked_sub(COMPARISONS_PER_PIECE * pieces.len()) else {
                left = 0;
                break;
            };
            comparisons = rest;
            let mut above = pieces.iter().map(|p| p.height_above(&window));
            if !above.any(|by| by > shorter.least) {
                continue;
            }
            envelope.clear();
            builder.merge([pieces, &[window]], mesh.length(edge), 0.0, &mut envelope);
            field.replace(edge, &envelope);
            faces.extend(mesh.along_edge(edge).map(HalfEdgeId::face));
        }
        faces.sort_unstable();
        faces.dedup();
        touched.extend_from_slice(&faces);
        faces.truncate(left);
    }
    touched.sort_unstable();
    touched.dedup();
    touched
}

/// A window by which points of an edge have less than their distance, by more than rounding.
#[derive(Clone, Copy, Debug)]
struct ShorterWindow {
    /// The canonical half-edge.
    edge: HalfEdgeId,
    window: EnvelopePiece,
    /// How much less at most.
    by: f64,
    /// The least that is more than rounding.
    least: f64,
}

/// Adds the windows that lead through `face` to its sides and are shorter there. In rounded
/// arithmetic.
fn shorter_windows(
    field: &EdgeField<'_>,
    face: FaceId,
    sides: &mut [FaceSide; 3],
    found: &mut Vec<ShorterWindow>,
) {
    let mesh = field.mesh;
    let shape = FaceShape::of(mesh, face);
    let lengths = shape.lengths.map(Ball::middle);
    for (k, side) in (0..).zip(&mut *sides) {
        side.set(field, face.half_edge(k), lengths[k as usize]);
    }
    let size = FaceSize::of(sides, lengths).all;
    if !SIZES.contains(&size) {
        return;
    }
    let least = REPAIR * size;
    let mut compare = |k: usize, distance: &RoundedDistance, bounds: [f64; 2]| {
        let is_clear = |chord: &Chord| chord.is_below(distance, -least);
        let overlaps = |from: f64, to: f64| from < bounds[1] && to > bounds[0];
        let blocks = sides[k].blocks().iter().filter(|block| {
            let [first, last] = [block.first, block.end - 1].map(|i| &sides[k].pieces[i]);
            overlaps(first.from, last.to) && !is_clear(&block.chord)
        });
        let pieces = blocks.flat_map(|block| &sides[k].pieces[block.first..block.end]);
        let above = pieces
            .filter(|p| overlaps(p.from, p.to) && !is_clear(&p.chord))
            .map(|p| p.height_above(distance, bounds));
        let by = above.fold(f64::NEG_INFINITY, greater);
        if by > least {
            let h = face.half_edge(k as u32);
            let window = WindowData {
                interval: bounds,
                image: distance.image,
                sigma: distance.sigma,
            };
            let (edge, is_turned) = canonical(mesh, h);
            let window = piece(&window, lengths[k], is_turned);
            found.push(ShorterWindow {
                edge,
                window,
                by,
                least,
            });
        }
    };
    for k in 0..3 {
        for pair in sides[k].pieces.windows(2) {
            let (left, right) = (pair[0].at_ends()[1], pair[1].at_ends()[0]);
            if (left - right).abs() > least {
                let along = RoundedDistance {
                    image: [pair[0].to, 0.0],
                    sigma: lesser(left, right),
                };
                compare(k, &along, [0.0, lengths[k]]);
            }
        }
        for step in [1, 2] {
            let near = shape.transform(k, step).rounded(TINY * MARGIN * size);
            if !near.is_finite() {
                return;
            }
            let there = (k + step) % 3;
            for piece in &sides[k].pieces {
                // As in the comparisons of the proof, in `face`.
                let straight = near.straight(&piece.distance);
                let is_clear = |whole: PieceBlock| whole.chord.is_below(&straight, -least);
                if sides[there].whole.is_none_or(is_clear) {
                    continue;
                }
                let reaches = near.reaches(piece, straight);
                for part in 0..3 {
                    compare(there, reaches.distance(part), reaches.bounds(part));
                }
            }
        }
    }
}
