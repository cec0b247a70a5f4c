//! Rules for the exits through which windows may leave a face.

use super::columns::Windows;
use super::filter::Gate;
use crate::engine::store::{COLUMNS, Columns};
use crate::precision::{CLEARANCE, MARGIN, RESOLUTION, WINS, blur};
use geobench_window::length_past_end;
use geobench_window::precision::PLACE;
use geobench_window::simd::{LaneMask, Lanes, Scalar};

/// How far beyond the best path, as a fraction of the half-edge and of the path, rays of a source
/// close to the edge must be before rule 1 cuts them. The rounding of the source is added.
///
/// The rays of all directions of such a source pass through a width smaller than the rounding of
/// the path. Of two paths with equal lengths one may turn at the source, and the other as far from
/// it as the rounding of their lengths.
const SLACK: f64 = MARGIN;

/// How close such a source is, as a fraction of both. A nearer source sees the slack under an angle
/// above [`RESOLUTION`]. A source no farther than its own rounding counts as close as well.
const CLOSE: f64 = RESOLUTION;

/// How far from the straight line to the apex, as a fraction of the half-edge and of the path, a
/// path may enter so that lengths hardly tell whether it is bent: a detour by δ is longer by 2·δ²
/// or more.
const HARDLY_BENT: f64 = 2.0 * RESOLUTION;

/// Windows that enter a face, and the sides on which their rays leave.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EnteringRays<L: Lanes> {
    pub(super) windows: Windows<L>,
    /// The lanes whose windows are kept.
    pub(super) kept: L::Mask,
    /// cy - py and cy·px - cx·py: a ray through abscissa s leaves to the left if s·e < d.
    pub(super) e: L,
    pub(super) d: L,
}

/// What a rule leaves of windows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sides<L: Lanes> {
    /// The windows to be tried at the left and at the right exit.
    pub(super) tried: [L::Mask; 2],
    /// Those of them that lose a part of their rays at that exit.
    pub(super) cut: [L::Mask; 2],
    /// The limits: only rays left of the first may leave to the left, and only rays right of the
    /// second to the right.
    pub(super) limits: [L; 2],
}

impl<L: Lanes> Sides<L> {
    /// The rays that both rules allow.
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        // Closures would be separate functions, compiled without the features of the processor.
        let either = [self.cut[0] | other.cut[0], self.cut[1] | other.cut[1]];
        let both = [self.cut[0] & other.cut[0], self.cut[1] & other.cut[1]];
        let one = [
            L::select(self.cut[0], self.limits[0], other.limits[0]),
            L::select(self.cut[1], self.limits[1], other.limits[1]),
        ];
        Self {
            tried: [
                self.tried[0] & other.tried[0],
                self.tried[1] & other.tried[1],
            ],
            cut: either,
            limits: [
                L::select(both[0], self.limits[0].min(other.limits[0]), one[0]),
                L::select(both[1], self.limits[1].max(other.limits[1]), one[1]),
            ],
        }
    }
}

/// What a rule leaves of one window for one exit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum AllowedAngle {
    /// All rays that lead there.
    All,
    /// Those on the side of the exit from this abscissa.
    Until(f64),
    /// None.
    None,
}

/// Decides which rays may leave through which exit.
pub(crate) trait Rule {
    /// What the rule leaves of `rays`. That each ray leaves on its own side is ensured elsewhere.
    fn sides<L: Lanes>(&self, simd: L::Token, rays: &EnteringRays<L>) -> Sides<L>;
}

/// No rule: all rays leave.
#[derive(Clone, Copy, Debug)]
pub struct Free;

impl Rule for Free {
    #[inline(always)]
    fn sides<L: Lanes>(&self, simd: L::Token, rays: &EnteringRays<L>) -> Sides<L> {
        let (none, zero) = (L::mask(simd, 0), L::splat(simd, 0.0));
        Sides {
            tried: [rays.kept; 2],
            cut: [none; 2],
            limits: [zero; 2],
        }
    }
}

/// The shortest path to the apex of all windows in a list, for rule 1 (one angle, two sides).
///
/// Let S be the point where it enters and q its source. Every path of a window to the apex C is at
/// least as long. A ray that enters left of S but leads to the right exit crosses the segment from
/// S to C, and is useless from there on. So rays left of S may leave only to the left, and rays
/// right of S only to the right. Rays on their own side survive, unless the best path has crossed
/// them before S. All rays right of S are crossed if q is right of the window's last ray and the
/// window's source is left of the best path. The left side is symmetric.
///
/// Of a window that does not see C, the path is bent at S. If it is bent by less than lengths tell,
/// another window may see C by a path as long, which enters on the side of the straight line from q
/// to C. So rays between S and that line leave on either side.
///
/// The rule as printed (proposition 4.1 of Qin et al. 2016) drops a window's whole side by
/// comparing where rays to C enter. That is unsound where intervals overlap.
#[derive(Clone, Copy, Debug)]
pub struct BestPath {
    /// The abscissa at which it crosses the half-edge.
    pub(crate) entry: f64,
    /// The abscissas between which paths may enter that are as short up to rounding.
    entries: [f64; 2],
    /// Its source.
    pub(crate) source: [f64; 2],
    /// The bound of the rounding error of sources, in addition to that of their own coordinates.
    blur: f64,
    /// The bound of the rounding error of the entry.
    slack: f64,
    /// The part of `slack` that applies to windows whose sources are below `close`: 0, unless the
    /// source of the path itself is close to the half-edge.
    least_slack: f64,
    close: f64,
}

impl BestPath {
    /// The path that crosses a half-edge at `entry`. `size` is the length of the half-edge plus
    /// that of the path. `blur` is the [rounding error](crate::precision::blur) of sources.
    #[inline(always)]
    pub(crate) fn new(entry: f64, source: [f64; 2], size: f64, blur: f64) -> Self {
        let (slack, close) = (SLACK * size + blur, -(CLOSE * size + blur));
        Self {
            entry,
            entries: [entry; 2],
            source,
            blur,
            slack,
            least_slack: if source[1] < close { 0.0 } else { slack },
            close,
        }
    }

    /// The path of window `i` of `list` to the apex behind `gate`, of length `distance`.
    #[inline(always)]
    pub(crate) fn of(list: Columns<'_>, i: usize, gate: &Gate, distance: f64) -> Self {
        Self::of_window(list.row(i), gate, distance)
    }

    /// The path of `window` to the apex behind `gate`, of length `distance`.
    #[inline(always)]
    pub(crate) fn of_window(window: [f64; COLUMNS], gate: &Gate, distance: f64) -> Self {
        let [b0, b1, px, py, _] = window;
        let apex = gate.apex;
        let sp = (apex[1] * px - apex[0] * py) / (apex[1] - py);
        let entry = if sp < b0 {
            b0
        } else if sp > b1 {
            b1
        } else {
            sp
        };
        let size = gate.l + distance;
        let mut path = Self::new(entry, [px, py], size, blur(gate.longest));
        // How far the entry is from the straight line, times the length of the line.
        let (run, rise) = (apex[0] - px, apex[1] - py);
        let across = (sp - entry) * rise;
        let limit = HARDLY_BENT * size;
        let is_hardly_bent = across * across <= limit * limit * (run * run + rise * rise);
        if is_hardly_bent && (sp - entry).abs() > PLACE * gate.l {
            path.entries = [sp.min(entry), sp.max(entry)];
        }
        path
    }

    /// The shortest path of `list` to the apex behind `gate`, and its length. By the windows alone
    /// it is that of window `best`, of length `distance`. `sides` are the lengths of the other two
    /// edges of the face.
    #[inline(always)]
    pub(crate) fn shortest(
        list: Columns<'_>,
        (best, distance): (usize, f64),
        gate: &Gate,
        sides: impl Fn() -> [f64; 2],
    ) -> (Self, f64) {
        let path = Self::of(list, best, gate, distance);
        // Only beside needles is a path through an end shorter than the distance there.
        let past_tail = path.entry <= 0.0 && gate.ends[0] > distance;
        if past_tail || path.entry >= gate.l && gate.ends[1] > distance {
            let sides = sides();
            if length_past_end(distance, path.entry, gate.l, gate.ends, sides) > distance {
                return Self::shortest_past_end(list, gate, sides);
            }
        }
        (path, distance)
    }

    /// What the rule leaves of `window`, which has rays on both sides of the `apex`, for the left
    /// and the right exit.
    pub(crate) fn allowed(&self, window: [f64; COLUMNS], apex: [f64; 2]) -> [AllowedAngle; 2] {
        let [cx, cy] = apex;
        let lane = |x: f64| Scalar::splat((), x);
        let windows = Windows::new(window.map(lane));
        let rays = EnteringRays {
            windows,
            kept: Scalar::mask((), 1),
            e: lane(cy) - windows.py,
            d: lane(cy) * windows.px - lane(cx) * windows.py,
        };
        let Sides { tried, cut, limits } = self.sides((), &rays);
        [0, 1].map(|side| {
            if !tried[side].any() {
                AllowedAngle::None
            } else if cut[side].any() {
                AllowedAngle::Until(limits[side].least())
            } else {
                AllowedAngle::All
            }
        })
    }

    /// As [`shortest`](Self::shortest), with the lengths of all windows by [`length_past_end`].
    #[cold]
    #[inline(never)]
    fn shortest_past_end(list: Columns<'_>, gate: &Gate, sides: [f64; 2]) -> (Self, f64) {
        let [cx, cy] = gate.apex;
        let lengths = (0..list.len()).map(|i| {
            let [.., px, py, sigma] = list.row(i);
            let path = Self::of(list, i, gate, 0.0);
            let is_straight = path.entry == (cy * px - cx * py) / (cy - py);
            let d = if is_straight {
                sigma + (cx - px).hypot(cy - py)
            } else {
                sigma + (path.entry - px).hypot(py) + (cx - path.entry).hypot(cy)
            };
            length_past_end(d, path.entry, gate.l, gate.ends, sides)
        });
        let shortest = lengths.enumerate().min_by(|(_, a), (_, b)| a.total_cmp(b));
        let (best, distance) = shortest.unwrap_or((0, f64::INFINITY));
        let path = Self::of(list, best, gate, distance);
        (path, distance)
    }
}

impl Rule for BestPath {
    #[inline(always)]
    fn sides<L: Lanes>(&self, simd: L::Token, rays: &EnteringRays<L>) -> Sides<L> {
        let Windows { b0, b1, py, .. } = rays.windows;
        let [first, last] = self.entries;
        let slack = L::splat(simd, self.slack);
        let (least, close) = (L::splat(simd, self.least_slack), L::splat(simd, self.close));
        let slack = L::select(py.lt(close), least, slack);
        let (before, behind) = (L::splat(simd, first) - slack, L::splat(simd, last) + slack);
        let mut left = rays.kept & b0.lt(behind);
        let mut right = rays.kept & before.lt(b1);
        let mut cut_left = left & behind.lt(b1) & (behind * rays.e).lt(rays.d);
        let mut cut_right = right & b0.lt(before) & rays.d.lt(before * rays.e);
        if (cut_left | cut_right).any() {
            let [crossed_left, crossed_right] = crossed::<L>(simd, &rays.windows, self);
            left = left & !(cut_left & crossed_left);
            right = right & !(cut_right & crossed_right);
            cut_left = cut_left & left;
            cut_right = cut_right & right;
        }
        Sides {
            tried: [left, right],
            cut: [cut_left, cut_right],
            limits: [behind, before],
        }
    }
}

/// The lanes in which the best path has clearly crossed all rays of a window left of its entry, and
/// all rays right of it: its source is beyond the outer ray, and the window's source is on the
/// other side of the path.
#[inline(always)]
fn crossed<L: Lanes>(simd: L::Token, w: &Windows<L>, best: &BestPath) -> [L::Mask; 2] {
    let Windows { b0, b1, px, py, .. } = *w;
    let (qx, qy, s, clearance, zero) = (
        L::splat(simd, best.source[0]),
        L::splat(simd, best.source[1]),
        L::splat(simd, best.entry),
        L::splat(simd, CLEARANCE),
        L::splat(simd, 0.0),
    );
    let (dx, dy) = (qx - px, qy - py);
    let blur = L::splat(simd, best.blur);
    let size = clearance * (px.abs() + py.abs() + qx.abs() + qy.abs()) + blur;
    // Twice the area of the window's source, its end on the edge, and the best source. The sign is
    // the side of the best source.
    let left = (b0 - px) * dy + py * dx;
    let left_doubt = size * ((b0 - px).abs() + py.abs());
    let right = (b1 - px) * dy + py * dx;
    let right_doubt = size * ((b1 - px).abs() + py.abs());
    // The same for the best path and the window's source.
    let own = zero - ((s - qx) * dy + qy * dx);
    let own_doubt = size * ((s - qx).abs() + qy.abs());
    [
        left_doubt.lt(left) & own.lt(zero - own_doubt),
        right.lt(zero - right_doubt) & own_doubt.lt(own),
    ]
}

/// The lengths of paths across the face from its other two half-edges to the ends of this one.
///
/// A path from BC to A separates AB from AC, so every ray of a window for the left exit crosses it.
/// The crossing is on a path of the window to A, and the shortest of these is bent at `b0`. If the
/// path from BC is shorter, it is shorter up to the crossing, and the ray is useless from there on.
/// B and the right exit are symmetric (strategy II of the transfer report, figure 5.6 c; case 11 of
/// Qin et al. 2016).
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    /// Length of the half-edge.
    pub(crate) l: f64,
    /// The length of a path to the tail A that enters through the edge BC, plus the blur.
    pub(crate) tail: f64,
    /// The length of a path to the head B that enters through the edge CA, plus the blur.
    pub(crate) head: f64,
}

impl Rule for Reach {
    #[inline(always)]
    fn sides<L: Lanes>(&self, simd: L::Token, rays: &EnteringRays<L>) -> Sides<L> {
        let Windows {
            b0,
            b1,
            px,
            py,
            sigma,
        } = rays.windows;
        let margin = L::splat(simd, WINS);
        let py2 = py * py;
        let (x0, x1) = (b0 - px, b1 - px);
        let to_tail = (sigma + (x0 * x0 + py2).sqrt() + b0) * margin;
        let to_head = (sigma + (x1 * x1 + py2).sqrt() + (L::splat(simd, self.l) - b1)) * margin;
        let none = L::mask(simd, 0);
        Sides {
            tried: [
                rays.kept & to_tail.le(L::splat(simd, self.tail)),
                rays.kept & to_head.le(L::splat(simd, self.head)),
            ],
            cut: [none; 2],
            limits: [b0; 2],
        }
    }
}

/// Both rules.
impl<A: Rule, B: Rule> Rule for (A, B) {
    #[inline(always)]
    fn sides<L: Lanes>(&self, simd: L::Token, rays: &EnteringRays<L>) -> Sides<L> {
        self.0.sides(simd, rays).and(self.1.sides(simd, rays))
    }
}

/// The paths of all windows of a list to the apex C. No ray of a window crosses such a path if it
/// is shorter than the window's own path to C (cases 7 to 10 of Qin et al. 2016, for all pairs;
/// rule 1 applies them to the best window only).
#[derive(Clone, Copy, Debug)]
pub struct EveryBetterPath<'a> {
    pub(crate) apex: [f64; 2],
    /// The paths, and their lengths plus the blur.
    pub(crate) paths: &'a [(BestPath, f64)],
}

impl Rule for EveryBetterPath<'_> {
    #[inline(always)]
    fn sides<L: Lanes>(&self, simd: L::Token, rays: &EnteringRays<L>) -> Sides<L> {
        let own = to_apex(simd, rays, self.apex) * L::splat(simd, WINS);
        let mut sides = Free.sides(simd, rays);
        for (path, length) in self.paths {
            let longer = rays.kept & L::splat(simd, *length).lt(own);
            if longer.any() {
                let of_path = path.sides(
                    simd,
                    &EnteringRays {
                        kept: longer,
                        ..*rays
                    },
                );
                let tried = [of_path.tried[0] | !longer, of_path.tried[1] | !longer];
                sides = sides.and(Sides { tried, ..of_path });
            }
        }
        sides
    }
}

/// The lengths of the shortest paths of windows to the apex: straight if the window sees it, else
/// bent at the end nearest to the straight ray.
#[inline(always)]
fn to_apex<L: Lanes>(simd: L::Token, rays: &EnteringRays<L>, apex: [f64; 2]) -> L {
    let Windows {
        b0,
        b1,
        px,
        py,
        sigma,
    } = rays.windows;
    let (cx, cy) = (L::splat(simd, apex[0]), L::splat(simd, apex[1]));
    let passes_left = rays.d.lt(b0 * rays.e);
    let passes_right = (b1 * rays.e).lt(rays.d);
    let bend = L::select(passes_left, b0, b1);
    let (x, beside) = (bend - px, cx - bend);
    let bent = (x * x + py * py).sqrt() + (beside * beside + cy * cy).sqrt();
    let across = cx - px;
    let straight = (across * across + rays.e * rays.e).sqrt();
    sigma + L::select(passes_left | passes_right, bent, straight)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The limits within which a window may leave to the left and to the right.
    #[derive(Debug, PartialEq)]
    struct Open {
        left: Option<f64>,
        right: Option<f64>,
    }

    fn window(b0: f64, b1: f64, px: f64, py: f64) -> [f64; 5] {
        [b0, b1, px, py, 0.0]
    }

    fn best(entry: f64, source: [f64; 2]) -> BestPath {
        BestPath::new(entry, source, 1.0, blur(1.0))
    }

    /// What `rule` leaves of a window whose ray to the apex enters at `sp`.
    fn sides(rule: &impl Rule, window: [f64; 5], sp: f64) -> Open {
        let lane = |x: f64| Scalar::splat((), x);
        let [b0, b1, px, py, sigma] = window.map(lane);
        let windows = Windows {
            b0,
            b1,
            px,
            py,
            sigma,
        };
        let sides = rule.sides(
            (),
            &EnteringRays {
                windows,
                kept: Scalar::mask((), 1),
                e: lane(1.0),
                d: lane(sp),
            },
        );
        let limit = |side: usize, natural: f64| {
            let limit = if sides.cut[side].any() {
                sides.limits[side].least()
            } else {
                natural
            };
            sides.tried[side].any().then_some(limit)
        };
        Open {
            left: limit(0, window[1].min(sp)),
            right: limit(1, window[0].max(sp)),
        }
    }

    fn open(left: Option<f64>, right: Option<f64>) -> Open {
        Open { left, right }
    }

    #[test]
    fn windows_on_either_side_of_the_best_path_go_one_way() {
        let best = best(0.5, [0.5, -1.0]);
        let on_the_left = sides(&best, window(0.1, 0.4, 0.5, -1.0), 0.5);
        assert_eq!(on_the_left, open(Some(0.4), None));
        let on_the_right = sides(&best, window(0.6, 0.9, 0.5, -1.0), 0.5);
        assert_eq!(on_the_right, open(None, Some(0.6)));
    }

    #[test]
    fn the_best_window_is_split_at_its_own_ray() {
        let sides = sides(&best(0.5, [0.5, -1.0]), window(0.1, 0.9, 0.5, -1.0), 0.5);
        assert_eq!(sides, open(Some(0.5), Some(0.5)));
    }

    #[test]
    fn a_window_split_left_of_the_best_path_is_cut_there() {
        // Its rays between 0.3 and 0.5 lead to the right and cross the best path. Those beyond 0.5
        // lead to the right as well, and are crossed before the edge if the best source is beyond
        // them.
        let w = window(0.1, 0.9, 0.2, -1.0);
        let beside = sides(&best(0.5, [0.6, -0.2]), w, 0.3);
        assert_eq!(beside, open(Some(0.3), Some(0.5)));
        let beyond = sides(&best(0.5, [3.0, -0.5]), w, 0.3);
        assert_eq!(beyond, open(Some(0.3), None));
    }

    #[test]
    fn a_window_split_right_of_the_best_path_is_cut_there() {
        let w = window(0.1, 0.9, 0.8, -1.0);
        let beside = sides(&best(0.5, [0.4, -0.2]), w, 0.7);
        assert_eq!(beside, open(Some(0.5), Some(0.7)));
        let beyond = sides(&best(0.5, [-2.0, -0.5]), w, 0.7);
        assert_eq!(beyond, open(None, Some(0.7)));
    }

    /// On a flat grid all windows have one source, seen through different triangles. When the
    /// rounding of its images decided the side on which they lie, whole windows were deleted, and
    /// hundreds of vertices stayed at infinity.
    #[test]
    fn rounding_between_images_of_one_source_deletes_nothing() {
        let noise = [-3e-16, 0.0, 3e-16];
        for dx in noise {
            for dy in noise {
                for ds in noise {
                    let w = window(0.1, 0.9, 0.5 + dx, -1.0 + dy);
                    let open = sides(&best(0.5 + ds, [0.5, -1.0]), w, 0.5 - ds);
                    assert!(
                        open.left.is_some() && open.right.is_some(),
                        "{dx} {dy} {ds}"
                    );
                }
            }
        }
    }

    #[test]
    fn of_two_rules_the_narrower_limits_hold() {
        let w = window(0.1, 0.9, 0.2, -1.0);
        let both = (best(0.5, [0.6, -0.2]), best(0.6, [0.7, -0.2]));
        assert_eq!(sides(&both, w, 0.3), open(Some(0.3), Some(0.6)));
        assert_eq!(sides(&(Free, both.0), w, 0.3), open(Some(0.3), Some(0.5)));
    }

    /// A window whose source is on the edge. The shortest paths to both ends have length 1 + 0.25 +
    /// 0.25.
    const ON_EDGE: [f64; 5] = [0.25, 0.75, 0.5, 0.0, 1.0];

    #[test]
    fn a_shorter_path_across_the_face_closes_the_exit_behind_it() {
        let reach = |tail, head| sides(&Reach { l: 1.0, tail, head }, ON_EDGE, 0.5);
        let (left, right) = (Some(0.5), Some(0.5));
        assert_eq!(reach(2.0, f64::INFINITY), open(left, right));
        assert_eq!(reach(1.4, 2.0), open(None, right));
        assert_eq!(reach(2.0, 1.4), open(left, None));
    }

    #[test]
    fn an_equal_path_across_the_face_closes_nothing() {
        for noise in [-1e-15, 0.0, 1e-15] {
            let equal = Reach {
                l: 1.0,
                tail: 1.5 + noise,
                head: 1.5 - noise,
            };
            assert_eq!(sides(&equal, ON_EDGE, 0.5), open(Some(0.5), Some(0.5)));
        }
    }

    #[test]
    fn only_paths_shorter_than_a_window_s_own_part_it() {
        // The apex is 1 above the source (the e of `sides`). The window's own path, through 0.25,
        // is a little longer.
        let w = window(0.1, 0.9, 0.2, -1.0);
        let paths = |length| [(best(0.5, [0.6, -0.2]), length)];
        let every = |paths: &[(BestPath, f64)]| {
            let apex = [0.3, 0.0];
            sides(&EveryBetterPath { apex, paths }, w, 0.25)
        };
        assert_eq!(every(&paths(0.9)), open(Some(0.25), Some(0.5)));
        assert_eq!(every(&paths(1.1)), open(Some(0.25), Some(0.25)));
    }
}
