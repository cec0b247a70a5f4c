//! Bisectors of two sites: branches of hyperbolas, or lines.

use super::plane::{Point, along, between, cross, norm, sub};
use super::sites::Site;

/// The points between two ends at which two sites are equally near, a branch of a hyperbola with
/// their images as foci.
///
/// ```
/// use geobench_voronoi::Bisector;
///
/// let mut bisector = Bisector { images: [[0.0, 0.0], [2.0, 0.0]], sigmas: [0.0, 0.0] };
/// assert!(bisector.is_line());
/// bisector.sigmas[1] = 1.0;
/// assert!(!bisector.is_line()); // A branch of a hyperbola.
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bisector {
    /// The images of both sites in the plane of the face.
    pub images: [[f64; 2]; 2],
    /// The lengths of the paths up to the images.
    pub sigmas: [f64; 2],
}

/// Nodes and weights of Gauss's rule with four points on 0..1, for parts that are [short](SHORT).
const GAUSS_SHORT: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Length of a part, relative to its distance from both images, below which its height over the
/// chord is a polynomial of degree seven, but for 1e-13.
const SHORT: f64 = 0.1;

/// The same with eight points.
const GAUSS: [(f64, f64); 8] = [
    (0.019_855_071_751_231_856, 0.050_614_268_145_188_13),
    (0.101_666_761_293_186_64, 0.111_190_517_226_687_24),
    (0.237_233_795_041_835_5, 0.156_853_322_938_943_64),
    (0.408_282_678_752_175_1, 0.181_341_891_689_181),
    (0.591_717_321_247_825, 0.181_341_891_689_181),
    (0.762_766_204_958_164_5, 0.156_853_322_938_943_64),
    (0.898_333_238_706_813_4, 0.111_190_517_226_687_24),
    (0.980_144_928_248_768_1, 0.050_614_268_145_188_13),
];

/// Rate at which a function changes across a border below which rounding hides where the border is.
///
/// Two paths that run nearly side by side, as where one source is right behind the other, are equally
/// long in a wide strip.
const FLAT: f64 = 1e-6;

/// Length of a step of Newton's method, as a fraction of the chord, after which none is needed.
const CONVERGED: f64 = 1e-10;

/// Steps of Newton's method after which it is given up.
const STEPS: usize = 40;

impl Bisector {
    pub(crate) fn of(sites: [&Site; 2]) -> Self {
        Self {
            images: sites.map(|site| site.image),
            sigmas: sites.map(|site| site.sigma),
        }
    }

    /// Whether it is a straight line.
    pub fn is_line(&self) -> bool {
        self.sigmas[0] == self.sigmas[1]
    }

    /// By how much the path from the first image to `x` is longer than that from the second, and
    /// the gradient of that.
    fn difference(&self, x: Point) -> (f64, Point) {
        let ways = self.images.map(|image| sub(x, image));
        let lengths = ways.map(norm);
        let [a, b] = [0, 1].map(|i| {
            if lengths[i] > 0.0 {
                ways[i].map(|c| c / lengths[i])
            } else {
                [0.0; 2]
            }
        });
        let difference = (lengths[0] - lengths[1]) + (self.sigmas[0] - self.sigmas[1]);
        (difference, sub(a, b))
    }

    /// The point of the bisector that is beside fraction `t` of the chord from `from` to `to`;
    /// `None` if there is none near it.
    pub(crate) fn beside(&self, from: Point, to: Point, t: f64) -> Option<Point> {
        let start = between(from, to, t);
        newton_across(start, sub(to, from), |x| {
            let (difference, gradient) = self.difference(x);
            Some((difference, gradient))
        })
    }

    /// Length of the part from `from` to `to`, and the area between it and its chord, positive on
    /// the left of the chord.
    pub(crate) fn length_and_area(&self, from: Point, to: Point) -> (f64, f64) {
        let chord = sub(to, from);
        let c = norm(chord);
        let (mut length, mut area) = (0.0, 0.0);
        let mut ways = self
            .images
            .into_iter()
            .flat_map(|p| [sub(from, p), sub(to, p)]);
        let rule = if ways.all(|way| c < SHORT * norm(way)) {
            &GAUSS_SHORT[..]
        } else {
            &GAUSS
        };
        for &(t, weight) in rule {
            let on_chord = between(from, to, t);
            // Where rounding hides the curve, it is its chord.
            let x = self.beside(from, to, t).unwrap_or(on_chord);
            let (_, gradient) = self.difference(x);
            let height = cross(chord, sub(x, on_chord)) / c;
            // The curve runs across the gradient.
            let [with, across] = [cross(gradient, chord), super::plane::dot(gradient, chord)];
            let slope = if with == 0.0 { 0.0 } else { across / with };
            length += weight * c * slope.hypot(1.0);
            area += weight * c * height;
        }
        (length, area)
    }
}

/// The point nearest to `start` across `direction` at which a function vanishes, by Newton's
/// method, or a point around which it hardly changes; `function` gives its value and its gradient.
pub(crate) fn newton_across(
    start: Point,
    direction: Point,
    function: impl Fn(Point) -> Option<(f64, Point)>,
) -> Option<Point> {
    let chord = norm(direction);
    if chord == 0.0 {
        return None;
    }
    let normal = [-direction[1] / chord, direction[0] / chord];
    let mut x = start;
    let mut last = f64::INFINITY;
    for _ in 0..STEPS {
        let (value, gradient) = function(x)?;
        let slope = super::plane::dot(gradient, normal);
        if slope.abs() < FLAT {
            return Some(x);
        }
        let step = (-value / slope).clamp(-chord, chord);
        if step.is_nan() || step.abs() >= last {
            // As near as rounding allows, or lost.
            return (last <= 1e-6 * chord || step == 0.0).then_some(x);
        }
        last = step.abs();
        x = along(x, step, normal);
        // The next step would be shorter by as much again.
        if last <= CONVERGED * chord {
            return Some(x);
        }
    }
    (last <= 1e-6 * chord).then_some(x)
}
