//! Comparisons of windows that compete for an edge: of windows of points alone, or of segments as
//! well.

use super::compare::{SLIVER, bisected, doubt, is_sent_again, is_sliver, ties_between};
use super::foot::{ALONG, does_new_win, grazes, is_foot, is_shorter_at_foot};
use crate::rays::{Beam, Rays};
use crate::tie::TiePoints;
use crate::window::Window;

/// Windows of one edge that may be compared with each other.
pub(super) trait Contender: Copy {
    /// The interval.
    fn interval(&self) -> [f64; 2];

    /// The distance offered at `x`.
    fn offers(&self, x: f64) -> f64;

    /// As [`is_sliver`].
    fn is_sliver(&self, start: f64, end: f64, l: f64) -> bool;

    /// As [`grazes`].
    fn grazes(&self, l: f64) -> bool;

    /// As [`is_sent_again`].
    fn is_sent_again(old: &Self, new: &Self) -> bool;

    /// As [`ties_between`].
    fn ties_between(old: &Self, new: &Self, lo: f64, hi: f64, l: f64) -> TiePoints;

    /// As [`does_new_win`].
    fn does_new_win(old: &Self, new: &Self, l: f64) -> Option<bool>;
}

impl Contender for Window {
    #[inline]
    fn interval(&self) -> [f64; 2] {
        [self.b0, self.b1]
    }

    #[inline]
    fn offers(&self, x: f64) -> f64 {
        self.distance(x)
    }

    #[inline]
    fn is_sliver(&self, start: f64, end: f64, l: f64) -> bool {
        is_sliver(self, start, end, l)
    }

    #[inline]
    fn grazes(&self, l: f64) -> bool {
        grazes(self, l)
    }

    #[inline]
    fn is_sent_again(old: &Self, new: &Self) -> bool {
        is_sent_again(old, new)
    }

    #[inline]
    fn ties_between(old: &Self, new: &Self, lo: f64, hi: f64, l: f64) -> TiePoints {
        ties_between(old, new, lo, hi, l)
    }

    #[inline]
    fn does_new_win(old: &Self, new: &Self, l: f64) -> Option<bool> {
        does_new_win(old, new, l)
    }
}

/// Parallel rays have one direction, so they have no foot and are never sent again. A sliver of
/// them is narrow for the way that they have come: the cones at the ends of their segment are then
/// as short.
impl Contender for Rays {
    fn interval(&self) -> [f64; 2] {
        self.interval()
    }

    fn offers(&self, x: f64) -> f64 {
        self.distance(x)
    }

    fn is_sliver(&self, start: f64, end: f64, l: f64) -> bool {
        match self {
            Self::Cone(w) => is_sliver(w, start, end, l),
            Self::Beam(w) => {
                let way = w.distance(start).min(w.distance(end));
                end - start <= SLIVER * l.min(way)
            }
        }
    }

    fn grazes(&self, l: f64) -> bool {
        match self {
            Self::Cone(w) => grazes(w, l),
            Self::Beam(w) => w.direction[1] <= ALONG,
        }
    }

    fn is_sent_again(old: &Self, new: &Self) -> bool {
        match (old, new) {
            (Self::Cone(old), Self::Cone(new)) => is_sent_again(old, new),
            _ => false,
        }
    }

    fn ties_between(old: &Self, new: &Self, lo: f64, hi: f64, l: f64) -> TiePoints {
        let ties = match (old, new) {
            (Self::Cone(old), Self::Cone(new)) => return ties_between(old, new, lo, hi, l),
            (Self::Beam(old), Self::Beam(new)) => ties_of_beams(old, new),
            (Self::Cone(cone), Self::Beam(beam)) | (Self::Beam(beam), Self::Cone(cone)) => {
                ties_of_beam_and_cone(beam, cone)
            }
        };
        let gain = |x: f64| old.distance(x) - new.distance(x);
        let gains = [gain(lo), gain(hi)];
        let doubt = doubt(old.distance(lo) + (hi - lo), l);
        let is_crossed = gains[0].max(gains[1]) > doubt && gains[0].min(gains[1]) < -doubt;
        let inside = ties.as_slice().iter().filter(|&&x| lo < x && x < hi);
        if is_crossed && inside.count() != 1 {
            // One window is shorter at each end, but rounding has moved the tie.
            return TiePoints::one(bisected(gain, lo, hi));
        }
        ties
    }

    fn does_new_win(old: &Self, new: &Self, l: f64) -> Option<bool> {
        match (old, new) {
            (Self::Cone(old), Self::Cone(new)) => does_new_win(old, new, l),
            (Self::Cone(foot), beam) => is_foot(foot, l).then(|| is_shorter_at_foot(beam, foot, l)),
            (beam, Self::Cone(foot)) => {
                is_foot(foot, l).then(|| !is_shorter_at_foot(beam, foot, l))
            }
            _ => None,
        }
    }
}

/// Where two linear distances are equal.
fn ties_of_beams(old: &Beam, new: &Beam) -> TiePoints {
    let slope = old.direction[0] - new.direction[0];
    TiePoints::of([(new.offset - old.offset) / slope, f64::NAN])
}

/// Where a linear distance o + u·x equals σ + √(t² + y²), with t = x - px.
///
/// With k = o + u·px - σ the square of k + u·t = √(t² + y²) is v²·t² - 2ku·t + y² - k² = 0, where v
/// is the ordinate of the direction, so that u² + v² = 1. A quarter of its discriminant is k² -
/// v²y². Both roots are ties if k is positive, else none is.
fn ties_of_beam_and_cone(beam: &Beam, cone: &Window) -> TiePoints {
    let [u, v] = beam.direction;
    let k = beam.distance(cone.px) - cone.sigma;
    let quarter = (k - v * cone.py) * (k + v * cone.py);
    if k <= 0.0 || quarter < 0.0 {
        return TiePoints::default();
    }
    let greater = k * u + quarter.sqrt().copysign(u);
    let product = (cone.py - k) * (cone.py + k);
    TiePoints::of([greater / (v * v), product / greater].map(|t| cone.px + t))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::overlap::{Overlap, Owner};
    use super::*;

    fn rays() -> impl Strategy<Value = Rays> {
        let beam = (-0.999..0.999f64, 0.0..3.0f64).prop_map(|(u, offset)| {
            let direction = [u, (1.0 - u * u).sqrt()];
            (direction, offset)
        });
        let cone = (-2.0..3.0f64, -3.0..0.0f64, 0.0..2.0f64);
        let ends = (0.0..1.0f64, 0.0..1.0f64);
        (beam, cone, ends, any::<bool>()).prop_map(
            |((direction, offset), (px, py, sigma), (x, y), is_beam)| {
                let (b0, b1) = (x.min(y), x.max(y).max(x.min(y) + 1e-3));
                if is_beam {
                    Rays::Beam(Beam {
                        b0,
                        b1,
                        direction,
                        offset,
                    })
                } else {
                    Rays::Cone(Window {
                        b0,
                        b1,
                        px,
                        py,
                        sigma,
                    })
                }
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(5000))]

        #[test]
        fn each_range_goes_to_the_shorter_one(
            old in rays(), new in rays(), at in 0.0..1.0f64,
        ) {
            let [a, b] = [old, new].map(|rays| rays.interval());
            let shared = a[1].min(b[1]) - a[0].max(b[0]);
            if shared <= 0.0 {
                return Ok(());
            }
            let mut overlap = Overlap::default();
            overlap.share_out_rays(&[old], &new, 1.0);
            let covers = |rays: &Rays, x: f64| {
                let [b0, b1] = rays.interval();
                b0 <= x && x <= b1
            };
            for segment in overlap.segments() {
                let x = segment.start + at * (segment.end - segment.start);
                let (owner, other) = match segment.owner {
                    Owner::New => (new, old),
                    Owner::Old(_) => (old, new),
                };
                prop_assert!(covers(&owner, x));
                if covers(&other, x) {
                    let [won, lost] = [owner, other].map(|rays| rays.distance(x));
                    prop_assert!(won <= lost + 1e-12 * (1.0 + lost), "{x}: {won} {lost}");
                }
            }
            // Only slivers are left out.
            let width: f64 = overlap.segments().iter().map(|s| s.end - s.start).sum();
            prop_assert!((width - (a[1] - a[0] + b[1] - b[0] - shared)).abs() < 1e-9);
        }

        #[test]
        fn distances_agree_at_every_tie(old in rays(), new in rays()) {
            for &x in Rays::ties_between(&old, &new, 0.0, 1.0, 1.0).as_slice() {
                let (a, b) = (old.distance(x), new.distance(x));
                prop_assert!((a - b).abs() <= 1e-9 * (1.0 + a.abs() + x.abs()), "{x}: {a} {b}");
            }
        }
    }

    /// A beam touches the cones at the ends of its segment along the outermost rays.
    #[test]
    fn a_beam_beats_the_cones_of_its_ends() {
        let beam = Rays::Beam(Beam {
            b0: 0.2,
            b1: 0.7,
            direction: [0.0, 1.0],
            offset: 0.3,
        });
        for px in [0.2, 0.7] {
            let (b0, b1, py, sigma) = (0.0, 1.0, -0.3, 0.0);
            let cone = Rays::Cone(Window {
                b0,
                b1,
                px,
                py,
                sigma,
            });
            for (old, new) in [(beam, cone), (cone, beam)] {
                let mut overlap = Overlap::default();
                overlap.share_out_rays(&[old], &new, 1.0);
                let of_beam = |owner| (owner == Owner::New) == (new == beam);
                let beams = overlap.segments().iter().filter(|s| of_beam(s.owner));
                let width: f64 = beams.map(|s| s.end - s.start).sum();
                assert!((width - 0.5).abs() < 1e-6, "{width}");
            }
        }
    }
}
