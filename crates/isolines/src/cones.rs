//! The cones of straight paths that reach the points of a face, and the arcs of an isoline in them.

use geobench_mesh::{FaceId, HalfEdgeId, Mesh};
use geobench_window::Window;
use geobench_window::precision::PLACE;

use geobench_mesh::vector::{Point, add, cross_2d, dot, norm, scale, sub, turned};

/// A point outside a cone counts as inside if the sine of its angle to the cone is at most this.
/// Rounding leaves gaps between windows that touch. A path that bends by so small an angle is
/// longer by less than 1e-20 of its length.
const CONE_SLACK: f64 = 1e-10;

/// Relative difference up to which two distances of a point count as equal.
const ROUNDING: f64 = 1e-13;

/// A face is flat if its height is less than this fraction of its size plus the level. Rounding
/// then decides which points are inside.
const FLAT: f64 = 1e-13;

/// The part of the plane of a face that straight paths through a window, or from a vertex of the
/// face, reach. The apex is the image of the (pseudo-)source, or the vertex. The distance of a
/// point in the cone is `sigma` plus its distance from the apex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cone {
    /// The apex.
    pub(crate) centre: Point,
    /// The distance from the source to the apex.
    sigma: f64,
    /// Unit directions of the right and the left side of the cone.
    right: Point,
    left: Point,
    /// The angle from the right to the left side.
    angle: f64,
    /// The distance from the centre to the nearest point of the face in the cone.
    nearest: f64,
}

/// An arc around the apex of a cone, from one angle to another, counter-clockwise from the right
/// side of the cone in radians.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ConeArc {
    /// The index of the cone in [`FaceCones::cones`].
    pub(crate) cone: usize,
    pub(crate) from: f64,
    pub(crate) to: f64,
}

/// A face in its plane, with the cones of all windows that enter it and of its vertices.
pub(crate) struct FaceCones {
    pub(crate) corners: [Point; 3],
    pub(crate) cones: Vec<Cone>,
    /// The length of the longest side.
    pub(crate) size: f64,
}

/// The corners of `face` in the frame of its first half-edge.
pub(crate) fn corners(mesh: &Mesh, face: FaceId) -> [Point; 3] {
    let h = face.half_edge(0);
    [[0.0; 2], [mesh.length(h), 0.0], mesh.apex(h)]
}

impl Cone {
    /// The cone with apex `centre` between two vectors, the right and the left side; `None` if
    /// `angle` is not positive.
    fn new(centre: Point, sigma: f64, sides: [Point; 2], angle: f64, nearest: f64) -> Option<Self> {
        let [right, left] = sides.map(|side| scale(side, 1.0 / norm(side)));
        (angle > 0.0).then_some(Self {
            centre,
            sigma,
            right,
            left,
            angle,
            nearest,
        })
    }

    /// The point of the circle of `radius` at `angle` from the right side.
    pub(crate) fn at(&self, angle: f64, radius: f64) -> Point {
        let (sin, cos) = libm::sincos(angle);
        let direction = add(scale(self.right, cos), scale(turned(self.right), sin));
        add(self.centre, scale(direction, radius))
    }

    /// The angle from the right side to the direction of `x`.
    fn angle_of(&self, x: Point) -> f64 {
        let ray = sub(x, self.centre);
        libm::atan2(cross_2d(self.right, ray), dot(self.right, ray))
    }

    /// The radius of the circle of points at distance `level`; not positive if there is none.
    pub(crate) fn radius(&self, level: f64) -> f64 {
        level - self.sigma
    }

    /// The length of the path from the source through the apex to `x`.
    pub(crate) fn distance(&self, x: Point) -> f64 {
        self.sigma + norm(sub(x, self.centre))
    }

    /// Whether `x` is in the cone, or outside by no more than rounding: that of its rays
    /// ([`CONE_SLACK`]), or that of a place in a face of this `size`.
    ///
    /// A window that its rays graze has a cone of one direction along the edge. Points of the edge
    /// between the image and the window, or behind the image, are on the line of the cone, but no
    /// path through the window reaches them.
    fn sees(&self, x: Point, size: f64) -> bool {
        let ray = sub(x, self.centre);
        let length = norm(ray);
        let rounding = PLACE * size;
        let slack = -(CONE_SLACK * length + rounding);
        cross_2d(self.right, ray) >= slack
            && cross_2d(ray, self.left) >= slack
            && dot(self.right, ray).max(dot(self.left, ray)) >= slack
            && length >= (1.0 - ROUNDING) * self.nearest - rounding
    }

    /// The intersections of its circle of `radius` with the line through `through`. `direction` has
    /// length 1.
    fn meets_line(&self, radius: f64, through: Point, direction: Point) -> [Option<Point>; 2] {
        let normal = turned(direction);
        let height = dot(normal, sub(through, self.centre));
        let half = radius * radius - height * height;
        if half.is_nan() || half < 0.0 {
            return [None; 2];
        }
        let foot = add(self.centre, scale(normal, height));
        let half = half.sqrt();
        [half, -half].map(|t| Some(add(foot, scale(direction, t))))
    }

    /// The intersections of its circle of `radius` with the circle of `other` of `its_radius`.
    fn meets_circle(&self, radius: f64, other: &Self, its_radius: f64) -> [Option<Point>; 2] {
        let between = sub(other.centre, self.centre);
        let apart = norm(between);
        let along = (apart * apart + (radius - its_radius) * (radius + its_radius)) / (2.0 * apart);
        let half = (radius - along) * (radius + along);
        // NaN if both have the same centre.
        if half.is_nan() || half < 0.0 {
            return [None; 2];
        }
        let unit = scale(between, 1.0 / apart);
        let foot = add(self.centre, scale(unit, along));
        let half = half.sqrt();
        [half, -half].map(|t| Some(add(foot, scale(turned(unit), t))))
    }

    /// The part of a segment that is in the cone, as a window in the frame of the segment; `None`
    /// if it is empty. The segment has length `l` and starts at `from` in the unit `direction`.
    pub(crate) fn window(&self, from: Point, direction: Point, l: f64) -> Option<Window> {
        let centre = sub(self.centre, from);
        let (mut b0, mut b1) = (0.0_f64, l);
        let start = sub(from, self.centre);
        // The point at abscissa x is on the inner side of a side of the cone if
        // `value + x * slope` is positive.
        for (value, slope) in [
            (cross_2d(self.right, start), cross_2d(self.right, direction)),
            (cross_2d(start, self.left), cross_2d(direction, self.left)),
        ] {
            let zero = -value / slope;
            if slope > 0.0 {
                b0 = b0.max(zero);
            } else if slope < 0.0 {
                b1 = b1.min(zero);
            } else if value < 0.0 {
                return None;
            }
        }
        (b0 < b1).then_some(Window {
            b0,
            b1,
            px: dot(centre, direction),
            py: cross_2d(direction, centre),
            sigma: self.sigma,
        })
    }
}

impl FaceCones {
    /// The cones of the vertices of `face` and of the windows that enter it. `windows` returns the
    /// windows that enter through a half-edge.
    pub(crate) fn new<W: Iterator<Item = Window>>(
        mesh: &Mesh,
        distances: &[f64],
        windows: impl Fn(HalfEdgeId) -> W,
        face: FaceId,
    ) -> Self {
        let corners = corners(mesh, face);
        let mut cones = Vec::new();
        for (k, v) in mesh.face_vertices(face).into_iter().enumerate() {
            let sides = [1, 2].map(|i| sub(corners[(k + i) % 3], corners[k]));
            let angle = libm::atan2(cross_2d(sides[0], sides[1]), dot(sides[0], sides[1]));
            cones.extend(Cone::new(
                corners[k],
                distances[v.index()],
                sides,
                angle,
                0.0,
            ));
        }
        for k in 0..3 {
            let h = face.half_edge(k);
            if mesh.is_boundary_edge(h) {
                continue;
            }
            let [origin, end] = [0, 1].map(|i| corners[(k as usize + i) % 3]);
            let u = scale(sub(end, origin), 1.0 / mesh.length(h));
            let turn = |x: f64, y: f64| add(scale(u, x), scale(turned(u), y));
            for w in windows(h) {
                let centre = add(origin, turn(w.px, w.py));
                let sides = [w.b1, w.b0].map(|x| turn(x - w.px, -w.py));
                // Computed in the frame of the edge: the height of an image above the edge can be
                // smaller than the rounding errors of `turn`. For an image on the edge and within
                // the window the angle is π; adding 0.0 turns -0.0, which would give -π, into 0.0.
                let height = -w.py + 0.0;
                let opposite = (w.b1 - w.px) * (w.b0 - w.px) + w.py * w.py;
                let angle = libm::atan2(height * (w.b1 - w.b0), opposite);
                let nearest = libm::hypot(w.nearest_abscissa() - w.px, w.py);
                cones.extend(Cone::new(centre, w.sigma, sides, angle, nearest));
            }
        }
        let lengths = mesh.side_lengths(face);
        Self {
            corners,
            cones,
            size: lengths.into_iter().fold(0.0, f64::max),
        }
    }

    fn is_inside(&self, x: Point) -> bool {
        let [a, b, c] = self.corners;
        let left = |from: Point, to: Point| cross_2d(sub(to, from), sub(x, from)) >= 0.0;
        left(a, b) && left(b, c) && left(c, a)
    }

    /// Whether no other cone gives `x` a shorter distance than cone `i`, which gives it the
    /// distance `level`. If distances are equal up to `slack`, the cone with the lowest index
    /// counts as the nearest.
    fn is_nearest(&self, i: usize, x: Point, level: f64, slack: f64) -> bool {
        let rivals = self.cones.iter().enumerate();
        let mut rivals = rivals.filter(|&(j, _)| j != i);
        !rivals.any(|(j, rival)| {
            let margin = if j < i { slack } else { -slack };
            rival.distance(x) < level + margin && rival.sees(x, self.size)
        })
    }

    /// Whether the face is so thin that rounding decides which points lie inside ([`FLAT`]).
    fn is_flat(&self, level: f64) -> bool {
        let [a, b, c] = self.corners;
        let height = cross_2d(sub(b, a), sub(c, a)) / self.size;
        height < FLAT * (self.size + level)
    }

    /// The index of the cone that gives `x` the shortest distance; `None` if no cone contains `x`.
    pub(crate) fn nearest(&self, x: Point) -> Option<usize> {
        let seen = self
            .cones
            .iter()
            .enumerate()
            .filter(|(_, s)| s.sees(x, self.size));
        let nearest = seen.min_by(|a, b| a.1.distance(x).total_cmp(&b.1.distance(x)));
        nearest.map(|(i, _)| i)
    }

    /// The rays to corner `i` from the centres of all cones but its own: distance, centre, and the
    /// sine of the angle by which the ray is outside the angle of the corner, 0 if it is inside.
    pub(crate) fn rays_to_corner(&self, i: usize) -> impl Iterator<Item = (f64, Point, f64)> {
        let [x, next, last] = [0, 1, 2].map(|k| self.corners[(i + k) % 3]);
        let unit = move |to: Point| {
            let way = sub(to, x);
            scale(way, 1.0 / norm(way))
        };
        let [first, second] = [next, last].map(unit);
        let least = ROUNDING * self.size;
        self.cones.iter().filter_map(move |cone| {
            let is_ray = norm(sub(cone.centre, x)) > least && cone.sees(x, self.size);
            let distance = cone.distance(x);
            let back = unit(cone.centre);
            let outside = -cross_2d(first, back).min(cross_2d(back, second)).min(0.0);
            (is_ray && distance.is_finite()).then_some((distance, cone.centre, outside))
        })
    }

    /// The arcs of the isoline at `level` inside the face. None if the face is flat: an isoline
    /// then enters and leaves it at the same point up to rounding.
    ///
    /// Takes O(k² + a k) time for k cones whose circles cut each other into a pieces.
    pub(crate) fn arcs(&self, level: f64) -> Vec<ConeArc> {
        if self.is_flat(level) {
            return Vec::new();
        }
        let slack = ROUNDING * (level + self.size);
        let mut all_cuts = vec![Vec::new(); self.cones.len()];
        for (i, cone) in self.cones.iter().enumerate() {
            let radius = cone.radius(level);
            let farthest = self.corners.map(|c| norm(sub(c, cone.centre)));
            if radius.is_nan()
                || radius <= 0.0
                || radius < cone.nearest
                || farthest.iter().all(|&d| d < radius)
            {
                continue;
            }
            self.cuts(i, level, slack, &mut all_cuts[i]);
        }
        let arcs = self.arcs_between(&all_cuts, level, slack);
        if self.share_ends(&arcs, level, slack, &mut all_cuts) {
            return self.arcs_between(&all_cuts, level, slack);
        }
        arcs
    }

    /// Cuts the circles of other cones where `arcs` end, if they give the end the same distance up
    /// to `slack`; returns whether any has a new cut.
    ///
    /// Where two circles nearly touch, as of a vertex that is reached on two sheets, they are equal
    /// up to `slack` far beyond their intersection. Which cone counts as the nearest is decided in
    /// the middle of a piece, so both need the same pieces: else both take a part, or none does.
    fn share_ends(
        &self,
        arcs: &[ConeArc],
        level: f64,
        slack: f64,
        all_cuts: &mut [Vec<f64>],
    ) -> bool {
        let mut has_new = false;
        for arc in arcs {
            let cone = &self.cones[arc.cone];
            for end in [arc.from, arc.to] {
                let x = cone.at(end, cone.radius(level));
                for (other, cuts) in self.cones.iter().zip(&mut *all_cuts) {
                    let angle = other.angle_of(x);
                    let is_known = |cut: &f64| (cut - angle).abs() * other.radius(level) <= slack;
                    if !cuts.is_empty()
                        && angle > 0.0
                        && angle < other.angle
                        && (other.distance(x) - level).abs() <= slack
                        && !cuts.iter().any(is_known)
                    {
                        cuts.push(angle);
                        cuts.sort_by(f64::total_cmp);
                        has_new = true;
                    }
                }
            }
        }
        has_new
    }

    /// The pieces between the cuts of each cone's circle that are inside the face and nearest.
    fn arcs_between(&self, all_cuts: &[Vec<f64>], level: f64, slack: f64) -> Vec<ConeArc> {
        let mut arcs: Vec<ConeArc> = Vec::new();
        for (i, (cone, cuts)) in self.cones.iter().zip(all_cuts).enumerate() {
            let radius = cone.radius(level);
            for pair in cuts.windows(2) {
                let [from, to] = [pair[0], pair[1]];
                let middle = cone.at(f64::midpoint(from, to), radius);
                if !self.is_inside(middle) || !self.is_nearest(i, middle, level, slack) {
                    continue;
                }
                match arcs.last_mut() {
                    Some(last) if last.cone == i && last.to == from => last.to = to,
                    _ => arcs.push(ConeArc { cone: i, from, to }),
                }
            }
        }
        arcs
    }

    /// Sets `cuts` to the angles, in ascending order, at which an arc of the isoline in cone `i`
    /// may end: at the sides of the cone, at the sides of the face, at the circles of other cones
    /// and at the sides of other cones.
    fn cuts(&self, i: usize, level: f64, slack: f64, cuts: &mut Vec<f64>) {
        let cone = &self.cones[i];
        let radius = cone.radius(level);
        cuts.clear();
        cuts.extend([0.0, cone.angle]);
        let mut cut = |x: Point| {
            let angle = cone.angle_of(x);
            if angle > 0.0 && angle < cone.angle {
                cuts.push(angle);
            }
        };
        for k in 0..3 {
            let [from, to] = [self.corners[k], self.corners[(k + 1) % 3]];
            let side = sub(to, from);
            let direction = scale(side, 1.0 / norm(side));
            let found = cone.meets_line(radius, from, direction);
            found.into_iter().flatten().for_each(&mut cut);
        }
        for (j, other) in self.cones.iter().enumerate() {
            let its_radius = other.radius(level);
            if j == i || its_radius.is_nan() || its_radius <= 0.0 || its_radius < other.nearest {
                continue;
            }
            let circle = cone.meets_circle(radius, other, its_radius);
            let circle = circle
                .into_iter()
                .flatten()
                .filter(|&x| other.sees(x, self.size));
            circle.for_each(&mut cut);
            for side in [other.right, other.left] {
                let found = cone.meets_line(radius, other.centre, side);
                let found = found.into_iter().flatten();
                let hides = |x: &Point| {
                    dot(sub(*x, other.centre), side) >= 0.0 && other.distance(*x) < level + slack
                };
                found.filter(hides).for_each(&mut cut);
            }
        }
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
    }
}
