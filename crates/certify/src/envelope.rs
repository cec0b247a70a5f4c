//! The lower envelope of the windows of an edge: the distance of each of its points.

use crate::difference::RoundedDistance;
use crate::field::SidePiece;
use crate::interval::lesser;

/// A window as a solver reports it, in the frame of its half-edge. The tail is the origin, the
/// abscissa runs along the half-edge, and units are those of the mesh.
///
/// ```
/// use geobench_certify::{Claim, WindowData};
/// use geobench_mesh::{HalfEdgeId, Mesh, VertexId};
///
/// // A unit square: from corner 1 to corner 3 across the diagonal of corners 0 and 2.
/// let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]])?;
/// let (source, half) = ([VertexId::new(1)], 0.5_f64.sqrt());
/// let window = WindowData {
///     interval: [0.0, 2.0 * half],
///     image: [half, -half],
///     sigma: 0.0,
/// };
/// let enters = |h: HalfEdgeId| mesh.twin(h).is_some() && h.face().index() == 1;
/// let windows = |h| enters(h).then_some(window);
/// let bound = Claim::new(&mesh, &source, &[1.0, 0.0, 1.0, 2.0 * half])?.not_too_long(windows);
/// assert!(bound.relative < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowData {
    /// The abscissas at which the window begins and ends.
    pub interval: [f64; 2],
    /// The image of its source, or pseudo-source, in the plane of the half-edge. The sign of the
    /// ordinate does not matter.
    pub image: [f64; 2],
    /// The distance of the pseudo-source from the nearest source; 0 for a window of a source.
    pub sigma: f64,
}

/// A distance function along an edge, `sigma` plus the distance to the image, valid on an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EnvelopePiece {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) image: [f64; 2],
    pub(crate) sigma: f64,
}

impl EnvelopePiece {
    pub(crate) fn at(&self, t: f64) -> f64 {
        let [x, y] = self.image;
        self.sigma + ((t - x) * (t - x) + y * y).sqrt()
    }

    /// The value and the slope; the slope is NaN at the image.
    fn at_with_slope(&self, t: f64) -> [f64; 2] {
        let [x, y] = [t - self.image[0], self.image[1]];
        let length = (x * x + y * y).sqrt();
        [self.sigma + length, x / length]
    }

    /// How much it is above another one at most where both are, in rounded arithmetic; minus
    /// infinity if they do not overlap.
    pub(crate) fn height_above(&self, other: &Self) -> f64 {
        let piece = SidePiece::new(self.distance(), self.from, self.to, 0);
        piece.height_above(&other.distance(), [other.from, other.to])
    }

    fn distance(&self) -> RoundedDistance {
        RoundedDistance {
            image: self.image,
            sigma: self.sigma,
        }
    }

    fn is_same_function(&self, other: &Self) -> bool {
        self.image == other.image && self.sigma == other.sigma
    }

    fn on(&self, from: f64, to: f64) -> Self {
        Self { from, to, ..*self }
    }
}

/// A piece also covers gaps next to it up to this fraction of edge length plus distance, which
/// rounding leaves between windows. Beyond its end a window is shorter than any path, so wider gaps
/// are left to [`crate::repair`].
pub(crate) const GAP: f64 = 1e-12;

/// The number of pieces up to which all pairs are compared.
const AT_ONCE: usize = 24;

/// Two functions that differ by no more than this fraction are equal up to rounding. In a merge
/// they are one: their noise would make pieces at each merge.
const EQUAL: f64 = 4.0 * f64::EPSILON;

/// Converts a window of a half-edge of this length to a piece. With `turned`, the canonical
/// half-edge of the edge has the opposite direction.
pub(crate) fn piece(window: &WindowData, length: f64, turned: bool) -> EnvelopePiece {
    let [b0, b1] = window.interval;
    let [x, y] = window.image;
    let (from, to, x) = if turned {
        (length - b1, length - b0, length - x)
    } else {
        (b0, b1, x)
    };
    EnvelopePiece {
        from,
        to,
        image: [x, y.abs()],
        sigma: window.sigma,
    }
}

/// Builds lower envelopes. Keeps its buffers between calls.
#[derive(Default)]
pub(crate) struct EnvelopeBuilder {
    /// Sorted abscissas at which a piece begins, ends or has a kink.
    cuts: Vec<f64>,
    /// The pieces that can be least between two cuts, each with its value in the middle.
    here: Vec<(EnvelopePiece, f64)>,
    /// The values and slopes of these pieces at both cuts.
    at_ends: Vec<[[f64; 2]; 2]>,
    /// Sorted abscissas at which two of these pieces are equal.
    meetings: Vec<f64>,
}

impl EnvelopeBuilder {
    /// Appends the lower envelope of `pieces` on an edge of this length. Together they must cover
    /// the edge. A piece also covers gaps next to it up to `gap` times the edge length plus
    /// distance. The appended pieces are sorted and cover the edge without gaps, from 0 to
    /// `length`.
    ///
    /// Rounding may misplace a boundary between two pieces by a few units in the last place. The
    /// proof allows for it: it measures the jump at the boundary.
    pub(crate) fn lower_envelope(
        &mut self,
        pieces: &[EnvelopePiece],
        length: f64,
        gap: f64,
        envelope: &mut Vec<EnvelopePiece>,
    ) {
        let distances = pieces.iter().map(|p| p.at(length / 2.0));
        let gap = gap * (length + distances.fold(f64::INFINITY, lesser));
        let equal = if pieces.len() > AT_ONCE { EQUAL } else { 0.0 };
        self.by_halves(pieces, length, gap, equal, envelope);
    }

    /// As [`lower_envelope`](Self::lower_envelope), for a `gap` in units of the mesh. Functions
    /// that differ by no more than the fraction `equal` are not told apart.
    ///
    /// Of many pieces the envelopes of both halves are merged, in O(n log² n). All pairs would be
    /// compared if the pieces are equal up to rounding, as those of the faces at one edge.
    fn by_halves(
        &mut self,
        pieces: &[EnvelopePiece],
        length: f64,
        gap: f64,
        equal: f64,
        envelope: &mut Vec<EnvelopePiece>,
    ) {
        if pieces.len() <= AT_ONCE {
            self.set_cuts(pieces, length);
            let covering = |ends_by: f64, begins_by: f64| {
                let covers = move |p: &&EnvelopePiece| p.from <= begins_by && p.to >= ends_by;
                pieces.iter().filter(covers)
            };
            self.append_least(covering, gap, equal, envelope);
            return;
        }
        let (left, right) = pieces.split_at(pieces.len() / 2);
        let halves = [left, right].map(|half| {
            let mut own = Vec::new();
            self.by_halves(half, length, gap, equal, &mut own);
            own
        });
        let both = halves.each_ref().map(|half| &half[..]);
        self.merge(both, length, gap, envelope);
    }

    /// Appends the lower envelope of two envelopes on an edge of this length. A piece also covers
    /// gaps next to it up to `gap`. O((m + n) log (m + n)) for m and n pieces.
    pub(crate) fn merge(
        &mut self,
        both: [&[EnvelopePiece]; 2],
        length: f64,
        gap: f64,
        envelope: &mut Vec<EnvelopePiece>,
    ) {
        self.set_cuts(both.into_iter().flatten(), length);
        let covering = |ends_by: f64, begins_by: f64| {
            both.into_iter().flat_map(move |pieces| {
                let first = pieces.partition_point(|p| p.to < ends_by);
                let behind = pieces[first..].iter();
                behind.take_while(move |p| p.from <= begins_by)
            })
        };
        self.append_least(covering, gap, EQUAL, envelope);
    }

    /// Appends the least of the pieces between each two of the cuts. `covering` finds those that
    /// end not before the first of two abscissas and begin not behind the second. Functions that
    /// differ by no more than the fraction `equal` are not told apart.
    fn append_least<'a, I: Iterator<Item = &'a EnvelopePiece>>(
        &mut self,
        covering: impl Fn(f64, f64) -> I,
        gap: f64,
        equal: f64,
        envelope: &mut Vec<EnvelopePiece>,
    ) {
        let begin = envelope.len();
        let mut append =
            |piece: &EnvelopePiece, from: f64, to: f64| match envelope[begin..].last_mut() {
                Some(last) if last.is_same_function(piece) && last.to == from => last.to = to,
                _ => envelope.push(piece.on(from, to)),
            };
        for i in 1..self.cuts.len() {
            let (from, to) = (self.cuts[i - 1], self.cuts[i]);
            let middle = f64::midpoint(from, to);
            let pad = if to - from < gap { gap } else { 0.0 };
            // Both functions are 1-Lipschitz. One that is above the least by more than both can
            // change on the interval is nowhere the least.
            let change = (to - from) * (1.0 + 1e-12);
            let mut most = f64::INFINITY;
            self.here.clear();
            for piece in covering(middle - pad, middle + pad) {
                let value = piece.at(middle);
                if value <= most {
                    most = lesser(value + change, most);
                    self.here.push((*piece, value));
                }
            }
            self.here.retain(|(_, value)| *value <= most);
            if let [(only, _)] = &self.here[..] {
                append(only, from, to);
                continue;
            }
            self.set_meetings(from, to, equal);
            for part in self.meetings.windows(2) {
                // Two functions that are equal up to rounding almost everywhere differ by far more
                // near an image that is close to the edge, which is an end.
                let points = [part[0], f64::midpoint(part[0], part[1]), part[1]];
                let sum = |piece: &EnvelopePiece| points.iter().map(|&t| piece.at(t)).sum::<f64>();
                let best = self.here.iter();
                let best = best.min_by(|a, b| sum(&a.0).total_cmp(&sum(&b.0)));
                if let Some((best, _)) = best {
                    append(best, part[0], part[1]);
                }
            }
        }
    }

    /// Sets `cuts` for these pieces.
    fn set_cuts<'a>(&mut self, pieces: impl IntoIterator<Item = &'a EnvelopePiece>, length: f64) {
        let cuts = &mut self.cuts;
        cuts.clear();
        cuts.push(0.0);
        let mut cut = |t: f64| {
            if t > 0.0 && t < length {
                cuts.push(t);
            }
        };
        for piece in pieces {
            cut(piece.from);
            cut(piece.to);
            // Two functions can agree on one side of a kink and differ on the other.
            if piece.image[1] < 1e-6 * length {
                cut(piece.image[0]);
            }
        }
        cuts.push(length);
        cuts.sort_unstable_by(f64::total_cmp);
        cuts.dedup();
    }

    /// Sets `meetings` to both cuts and the abscissas between them at which two pieces of `here`
    /// meet, unless they differ by no more than the fraction `equal` at the cuts and in the middle.
    fn set_meetings(&mut self, from: f64, to: f64, equal: f64) {
        let (here, at_ends, meetings) = (&self.here, &mut self.at_ends, &mut self.meetings);
        at_ends.clear();
        at_ends.extend(
            here.iter()
                .map(|(p, _)| [from, to].map(|t| p.at_with_slope(t))),
        );
        meetings.clear();
        meetings.push(from);
        for (i, (a, _)) in here.iter().enumerate() {
            for (j, (b, _)) in here.iter().enumerate().skip(i + 1) {
                let is_equal = || {
                    let values = [0, 1].map(|end| [at_ends[i][end][0], at_ends[j][end][0]]);
                    let mut all = values.into_iter().chain([[here[i].1, here[j].1]]);
                    all.all(|[a, b]| (a - b).abs() <= equal * a)
                };
                if !stay_apart(&at_ends[i], &at_ends[j]) && !is_equal() {
                    let known = meetings.len();
                    let found = crossings(a, b).into_iter();
                    meetings.extend(found.filter(|&t| t > from && t < to));
                    let above = [0, 1].map(|end| {
                        let [a, b] = [at_ends[i][end][0], at_ends[j][end][0]];
                        let by = a - b;
                        if by.abs() > EQUAL * a { by } else { 0.0 }
                    });
                    if meetings.len() == known && above[0] * above[1] < 0.0 {
                        meetings.push(bisected_crossing(a, b, from, to));
                    }
                }
            }
        }
        meetings.push(to);
        meetings.sort_unstable_by(f64::total_cmp);
        meetings.dedup();
    }
}

/// Whether two functions with these values and slopes at the ends of an interval are certainly
/// equal nowhere between. One must be less at both ends, and their difference, which has at most
/// one critical point, must have none in between. Returns false in doubt.
fn stay_apart(a: &[[f64; 2]; 2], b: &[[f64; 2]; 2]) -> bool {
    let [first, last] = [0, 1].map(|end| a[end][0] - b[end][0]);
    let [rises, falls] = [0, 1].map(|end| a[end][1] - b[end][1]);
    let doubt = 1e-12 * (a[0][0] + b[0][0]);
    let are_apart = first.abs().min(last.abs()) > doubt && first * last > 0.0;
    are_apart && rises.abs().min(falls.abs()) > 1e-9 && rises * falls > 0.0
}

/// The abscissas at which two functions are equal: at most two, else NaN or infinity. They can
/// include a point at which the sum of the distances to the images, and not their difference, is
/// the difference of the sigmas. An extra point is harmless for an envelope.
fn crossings(a: &EnvelopePiece, b: &EnvelopePiece) -> [f64; 2] {
    // Let X be the abscissa relative to the midpoint m of both images, and ra and rb the distances
    // to the images. Then ra² - rb² = k X + c, and ra - rb = d gives 2 rb d = k X + c - d².
    let d = b.sigma - a.sigma;
    let m = f64::midpoint(a.image[0], b.image[0]);
    let half = (b.image[0] - a.image[0]) / 2.0;
    let k = 4.0 * half;
    let c = (a.image[1] - b.image[1]) * (a.image[1] + b.image[1]);
    let e = c - d * d;
    // 4 d² ((X - half)² + yb²) = (k X + e)²
    let q2 = 4.0 * d * d - k * k;
    let q1 = -8.0 * d * d * half - 2.0 * k * e;
    let q0 = 4.0 * d * d * (half * half + b.image[1] * b.image[1]) - e * e;
    let mut roots = quadratic_roots(q2, q1, q0);
    for x in &mut roots {
        *x += m;
        // Newton's method on the difference itself.
        for _ in 0..3 {
            let [a, b] = [a, b].map(|p| p.at_with_slope(*x));
            let step = (a[0] - b[0]) / (a[1] - b[1]);
            if !step.is_finite() {
                break;
            }
            *x -= step;
            if step.abs() <= f64::EPSILON / 4.0 * x.abs() {
                break;
            }
        }
    }
    roots
}

/// The abscissa between these two at which functions are equal of which each is less at one of
/// them. Rounding hides it from [`crossings`] if there is another one nearby, beyond the edge.
#[cold]
fn bisected_crossing(a: &EnvelopePiece, b: &EnvelopePiece, mut from: f64, mut to: f64) -> f64 {
    let is_above = |t: f64| a.at(t) > b.at(t);
    let first = is_above(from);
    loop {
        let middle = f64::midpoint(from, to);
        if middle <= from || middle >= to {
            return middle;
        }
        if is_above(middle) == first {
            from = middle;
        } else {
            to = middle;
        }
    }
}

/// The real roots of `a x² + b x + c`; a missing root is NaN or infinite.
fn quadratic_roots(a: f64, b: f64, c: f64) -> [f64; 2] {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        // Rounding has made the discriminant of a double root negative.
        return [-b / (2.0 * a), f64::NAN];
    }
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    [q / a, c / q]
}

#[cfg(test)]
mod tests {
    use geobench_mesh::SplitMix64;
    use proptest::prelude::*;

    use super::*;

    fn lower_envelope(pieces: &[EnvelopePiece], length: f64) -> Vec<EnvelopePiece> {
        let mut envelope = Vec::new();
        EnvelopeBuilder::default().lower_envelope(pieces, length, GAP, &mut envelope);
        envelope
    }

    prop_compose! {
        fn pieces()(
            ends in (0.0..1.0f64, 0.0..1.0f64), x in -1.0..2.0f64, y in 0.0..2.0f64,
            sigma in 0.0..1.0f64,
        ) -> EnvelopePiece {
            EnvelopePiece {
                from: ends.0.min(ends.1),
                to: ends.0.max(ends.1),
                image: [x, y],
                sigma,
            }
        }
    }

    proptest! {
        #[test]
        fn the_envelope_is_the_least_of_all_pieces(
            mut all in prop::collection::vec(pieces(), 0..6), ts in prop::collection::vec(0.0..1.0f64, 50),
        ) {
            let whole = EnvelopePiece { from: 0.0, to: 1.0, image: [0.0, 0.0], sigma: 1.0 };
            all.push(whole);
            let envelope = lower_envelope(&all, 1.0);
            prop_assert_eq!(envelope[0].from, 0.0);
            prop_assert_eq!(envelope.last().unwrap().to, 1.0);
            for pair in envelope.windows(2) {
                prop_assert_eq!(pair[0].to, pair[1].from);
            }
            for t in ts {
                let least = all.iter().filter(|p| p.from <= t && t <= p.to).map(|p| p.at(t));
                let least = least.fold(f64::INFINITY, f64::min);
                let found = envelope.iter().find(|p| p.from <= t && t <= p.to).unwrap().at(t);
                prop_assert!((found - least).abs() < 1e-9, "{} {} at {}", found, least, t);
            }
        }
    }

    /// A pseudo-source 1e-9 beside the edge is as near as the end of the edge, up to rounding, on
    /// half of the edge, and 1e-9 farther next to it. The proof had a jump there.
    #[test]
    fn functions_that_are_equal_up_to_rounding_are_compared_at_the_ends() {
        let along = EnvelopePiece {
            from: 0.0,
            to: 1.0,
            image: [1.0, 0.0],
            sigma: 0.0,
        };
        let beside = EnvelopePiece {
            image: [0.5, 1e-9],
            sigma: 0.5,
            ..along
        };
        for pieces in [[along, beside], [beside, along]] {
            assert_eq!(lower_envelope(&pieces, 1.0), [along]);
        }
    }

    /// `near-duplicates` 3 of the fuzzer: of two paths to a vertex one is longer by 4e-9. Its
    /// window ends at the vertex, and is as long as the way through the vertex both 2e-9 before the
    /// end of the edge and 2e-8 behind it. Only the second place was found, so the vertex was 4e-9
    /// too far.
    #[test]
    fn two_meetings_beside_the_end_of_an_edge_are_told_apart() {
        let length = 2.738_612_809_980_58;
        let window = EnvelopePiece {
            from: 0.0,
            to: length,
            image: [-0.958_514_467_159_264_4, 2.565_394_708_014_633],
            sigma: 0.0,
        };
        let vertex = EnvelopePiece {
            image: [length, 0.0],
            sigma: 4.500_000_008_275_856,
            ..window
        };
        let found = lower_envelope(&[window, vertex], length);
        let [first, last] = found[..] else {
            panic!("{found:?}")
        };
        assert!(first.is_same_function(&window) && last.is_same_function(&vertex));
        assert!(length - last.from > 2e-9 && length - last.from < 3e-9);
    }

    /// The windows of 3,000 faces at one edge, equal up to rounding: all pairs were compared.
    #[test]
    fn many_equal_functions_are_one() {
        let mut builder = EnvelopeBuilder::default();
        let images = [[0.2, 0.5], [0.7, 0.25], [0.9, 1.0]];
        let turned = |x: f64| 1.1 - (1.1 - x);
        let copies = (0..3000).flat_map(|k| {
            images.map(|[x, y]| EnvelopePiece {
                from: 0.0,
                to: 1.1,
                image: [if k % 2 == 0 { x } else { turned(x) }, y],
                sigma: 0.0,
            })
        });
        let copies: Vec<EnvelopePiece> = copies.collect();
        let mut found = Vec::new();
        builder.lower_envelope(&copies, 1.1, GAP, &mut found);
        let single = lower_envelope(&copies[..3], 1.1);
        // Where they meet, rounding decides between the two forms of a function.
        assert!(found.len() <= 4 * single.len(), "{found:?}");
        for k in 0..=100 {
            let t = 0.011 * f64::from(k);
            let at = |all: &[EnvelopePiece]| {
                let covers = |p: &&EnvelopePiece| p.from <= t && t <= p.to;
                all.iter().find(covers).unwrap().at(t)
            };
            assert!((at(&found) - at(&single)).abs() < 1e-14, "at {t}");
        }
    }

    /// A merge finds what a comparison of all pairs does.
    #[test]
    fn halves_have_the_envelope_of_all() {
        let mut random = SplitMix64::new(5);
        for _ in 0..50 {
            let pieces = (0..200).map(|_| {
                let mut between = |from: f64, to: f64| from + random.unit() * (to - from);
                let from = between(0.0, 0.9);
                EnvelopePiece {
                    from,
                    to: between(from, 1.0),
                    image: [between(-1.0, 2.0), between(0.0, 0.5)],
                    sigma: between(0.0, 0.3),
                }
            });
            let mut pieces: Vec<EnvelopePiece> = pieces.collect();
            let whole = EnvelopePiece {
                from: 0.0,
                to: 1.0,
                image: [0.0, 0.0],
                sigma: 1.0,
            };
            pieces.push(whole);
            let found = lower_envelope(&pieces, 1.0);
            assert!(found.windows(2).all(|pair| pair[0].to == pair[1].from));
            for _ in 0..200 {
                let t = random.unit();
                let covers = |p: &&EnvelopePiece| p.from <= t && t <= p.to;
                let least = pieces.iter().filter(covers).map(|p| p.at(t));
                let least = least.fold(f64::INFINITY, f64::min);
                let value = found.iter().find(covers).unwrap().at(t);
                assert!((value - least).abs() < 1e-9, "{value} {least} at {t}");
            }
        }
    }

    #[test]
    fn small_gaps_are_closed_and_large_ones_are_not() {
        let window = |b0, b1| WindowData {
            interval: [b0, b1],
            image: [0.5, -1.0],
            sigma: 0.0,
        };
        let mut pieces = vec![EnvelopePiece {
            from: 0.0,
            to: 1.0,
            image: [0.0, 0.0],
            sigma: 3.0,
        }];
        for window in [
            window(1e-12, 0.3),
            window(0.3 + 1e-12, 0.5),
            window(0.6, 1.0),
        ] {
            pieces.push(piece(&window, 1.0, false));
        }
        let envelope = lower_envelope(&pieces, 1.0);
        let ends: Vec<[f64; 2]> = envelope.iter().map(|p| [p.from, p.to]).collect();
        assert_eq!(ends, [[0.0, 0.5], [0.5, 0.6], [0.6, 1.0]]);
        assert_eq!(envelope[1].sigma, 3.0);
    }

    #[test]
    fn a_window_of_the_twin_is_turned() {
        let window = WindowData {
            interval: [0.25, 0.5],
            image: [2.0, -1.0],
            sigma: 0.5,
        };
        let turned = piece(&window, 1.0, true);
        assert_eq!([turned.from, turned.to], [0.5, 0.75]);
        assert_eq!(turned.image, [-1.0, 1.0]);
    }
}
