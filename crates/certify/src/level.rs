//! The part of a field below a level.

use crate::envelope::EnvelopePiece;
use crate::field::EdgeField;
use crate::jump::sum_of_jumps;

/// The field without the points of edges at which the distance exceeds `level`. Pieces are cut a
/// little beyond, so rounding removes no other point.
pub(crate) fn below<'a>(field: &EdgeField<'a>, level: f64) -> EdgeField<'a> {
    let mut part = EdgeField {
        mesh: field.mesh,
        ranges: Vec::with_capacity(field.ranges.len()),
        pieces: Vec::new(),
        jumps: Vec::with_capacity(field.jumps.len()),
    };
    for range in &field.ranges {
        let first = part.pieces.len();
        let pieces = field.pieces[range.clone()].iter();
        part.pieces
            .extend(pieces.filter_map(|piece| cut(piece, level)));
        let runs = part.pieces[first..].chunk_by(|a, b| a.to == b.from);
        part.jumps.push(
            runs.map(sum_of_jumps)
                .fold(0.0, |sum, jump| (sum + jump).next_up()),
        );
        part.ranges.push(first..part.pieces.len());
    }
    part
}

/// The part of a piece below a level. Its distance is convex, so it is an interval.
fn cut(piece: &EnvelopePiece, level: f64) -> Option<EnvelopePiece> {
    let [x, y] = piece.image;
    // A few units in the last place of numbers up to the level and to the image.
    let reach = (level - piece.sigma) * (1.0 + 1e-14) + 1e-15 * (level + piece.sigma);
    let square = (reach - y) * (reach + y);
    if reach < 0.0 || square < 0.0 {
        return None;
    }
    let half = square.sqrt() * (1.0 + 1e-15) + 1e-15 * (reach + x.abs());
    let (from, to) = (piece.from.max(x - half), piece.to.min(x + half));
    (from <= to).then_some(EnvelopePiece { from, to, ..*piece })
}
