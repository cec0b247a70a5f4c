//! The points at which isolines cross edges.

use geobench_window::Window;

/// The widest gap across which two intervals that end with their windows are joined, as a fraction
/// of the edge. Rounding leaves such gaps between windows that touch.
const GAP_BETWEEN_WINDOWS: f64 = 1e-6;

/// The same, if one of the intervals ends where its window reaches the level.
const GAP_AT_LEVEL: f64 = 1e-9;

/// An interval of an edge whose points are nearer than the level, by one window or one vertex.
#[derive(Clone, Copy)]
struct NearPart {
    from: f64,
    to: f64,
    /// Whether its start, and its end, is that of its window, so that the distance is still below
    /// the level there. Otherwise the distance reaches the level.
    cut: [bool; 2],
}

impl NearPart {
    /// The part of a window that is nearer than `level`.
    fn of(w: Window, level: f64) -> Option<Self> {
        let radius = level - w.sigma;
        let half = radius * radius - w.py * w.py;
        if radius.is_nan() || half.is_nan() || radius <= 0.0 || half <= 0.0 {
            return None;
        }
        let half = half.sqrt();
        let (from, to) = (w.px - half, w.px + half);
        let part = Self {
            from: from.max(w.b0),
            to: to.min(w.b1),
            cut: [from < w.b0, to > w.b1],
        };
        (part.from < part.to).then_some(part)
    }
}

/// The abscissas, in ascending order, at which the distance along an edge of length `l` passes
/// `level`. `windows` are those of both sides of the edge in one frame, and `ends` the distances of
/// the first and the second end.
///
/// The result is consistent in spite of rounding: between crossings, the distance is alternately
/// below and above `level`, as `ends` require.
pub(crate) fn crossings(
    windows: impl Iterator<Item = Window>,
    ends: [f64; 2],
    l: f64,
    level: f64,
) -> Vec<f64> {
    let mut parts: Vec<NearPart> = windows.filter_map(|w| NearPart::of(w, level)).collect();
    if ends[0] < level {
        let to = level - ends[0];
        parts.push(NearPart {
            from: 0.0,
            to: to.min(l),
            cut: [true, to > l],
        });
    }
    if ends[1] < level {
        let from = l - (level - ends[1]);
        parts.push(NearPart {
            from: from.max(0.0),
            to: l,
            cut: [from < 0.0, true],
        });
    }
    parts.sort_by(|a, b| a.from.total_cmp(&b.from).then(b.to.total_cmp(&a.to)));
    let mut joined: Vec<NearPart> = Vec::new();
    for part in parts {
        if let Some(last) = joined.last_mut() {
            let gap = match (last.cut[1], part.cut[0]) {
                (true, true) => GAP_BETWEEN_WINDOWS,
                (false, false) => 0.0,
                _ => GAP_AT_LEVEL,
            };
            if part.from <= last.to + gap * l {
                if part.to > last.to {
                    (last.to, last.cut[1]) = (part.to, part.cut[1]);
                } else if part.to == last.to {
                    last.cut[1] &= part.cut[1];
                }
                continue;
            }
        }
        joined.push(part);
    }
    let mut found = Vec::with_capacity(2 * joined.len());
    let last = joined.len().wrapping_sub(1);
    for (i, part) in joined.into_iter().enumerate() {
        if i > 0 || ends[0] >= level {
            found.push(part.from.clamp(0.0, l));
        }
        if i < last || ends[1] >= level {
            found.push(part.to.clamp(0.0, l));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(b0: f64, b1: f64, px: f64, py: f64) -> Window {
        Window {
            b0,
            b1,
            px,
            py,
            sigma: 0.0,
        }
    }

    #[test]
    fn distances_pass_the_level_on_both_sides_of_a_foot() {
        let far = [10.0, 10.0];
        let w = window(0.0, 10.0, 5.0, -3.0);
        assert_eq!(crossings([w].into_iter(), far, 10.0, 5.0), [1.0, 9.0]);
        assert!(crossings([w].into_iter(), far, 10.0, 3.0).is_empty());
        // Two windows that touch, with a gap from rounding.
        let two = [
            window(0.0, 5.0, 5.0, -3.0),
            window(5.0 + 1e-12, 10.0, 5.0, -3.0),
        ];
        assert_eq!(crossings(two.into_iter(), far, 10.0, 5.0), [1.0, 9.0]);
    }

    #[test]
    fn the_ends_of_an_edge_are_nearer_than_the_level_or_not() {
        let none = || std::iter::empty();
        assert_eq!(crossings(none(), [1.0, 3.0], 4.0, 2.0), [1.0]);
        assert_eq!(crossings(none(), [3.0, 1.0], 4.0, 2.0), [3.0]);
        assert_eq!(crossings(none(), [1.0, 1.0], 4.0, 2.0), [1.0, 3.0]);
        assert!(crossings(none(), [1.0, 1.0], 4.0, 3.5).is_empty());
        assert!(crossings(none(), [5.0, 4.5], 4.0, 3.5).is_empty());
        // A window that reaches the level at its end, a vertex: the crossing is the vertex.
        let w = window(0.0, 4.0, 0.0, -3.0);
        assert_eq!(crossings([w].into_iter(), [3.0, 5.0], 4.0, 5.0), [4.0]);
    }
}
