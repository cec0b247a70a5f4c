//! Bounds of rounding, and the margins of all comparisons that delete windows.
//!
//! A solver deletes windows because a real path is shorter than all of their rays. It computes in
//! `f64`, so each such comparison must be safe against the rounding that both sides have
//! accumulated. This page derives bounds. All comparisons that delete windows take their margins
//! from four numbers, [`MARGIN`], [`GRAIN`], [`PLACE`] and [`RESOLUTION`]. Two other margins are
//! documented beside their code: how close two rays to an apex count as one (`geobench-ich`), and
//! how narrow a window is that trimming drops
//! ([`trimming::is_sliver`](crate::trimming::is_sliver)).
//!
//! # Exact quantities
//!
//! Let ε = 1.1e-16. The frame of a half-edge ([`Faces`](crate::Faces)) has a length, and the
//! abscissa and the ordinate of the apex, each with a relative error of a few ε. No quantity of a
//! frame is found by subtracting two numbers that may be close:
//!
//! * The area comes from the cross product of the two shorter edges, not from three lengths.
//! * The distance of the apex's foot from the head, l - cx, is not subtracted but taken from the
//!   next half-edge: both are projections of one edge on the other. So the direction of the right
//!   exit is a unit vector, however short that exit is.
//!
//! # What a crossing adds
//!
//! A window holds the image p of its source, an interval b0..b1 and σ. Crossing a face has two
//! steps:
//!
//! * Turning p into the frame of the exit. The turned point errs by some ε·(|p| + S), where S is
//!   the longest side of the face. The part ε·S matters where a source is nearer to the edge than
//!   the face is long.
//! * Finding where the rays through b0 and b1 meet the exit. A ray divides the exit as n : m. Both
//!   are non-negative areas, so their sum has no cancellation. An end errs by some ε of the length
//!   of the exit, and by ε·|p - b| over the sine of the angle at which the ray meets it, which is a
//!   lateral error of ε·|p - b|.
//!
//! After n faces the length of a path errs by at most some n·ε of itself and of the longest side
//! that it has crossed; errors have either sign, so √n·ε is observed. An image that comes out
//! above its edge, where no ray can come from, is mirrored: its distance from every point of the
//! edge stays what it was, and no path becomes too short.
//!
//! A gap that rounding opens between two windows is no wider than that. A vertex in the gap is
//! reached by the bent path of either window ([`Crossing::bent_distance`]). A bend by the angle δ
//! lengthens a path by at most δ²/2 of itself. So an error of δ in a direction costs δ²/2 in a
//! distance, and a gap of ε·S beside a source at distance r costs (ε·S/r)²·r. Behind a face of no
//! area the bent path goes along the edge, and costs half of the gap there, which has grown on the
//! way. So MMP's lists leave no gaps beside a source within 1e-6 of an edge
//! ([`closing_gaps`](crate::trimming::closing_gaps)).
//!
//! # Comparisons that delete longer paths
//!
//! The vertex filter, rules 1, 2 and 3 and the eviction of lists delete a window only if another
//! path is shorter by [`MARGIN`] of its length and of the longest side that the window has crossed:
//! ten thousand ε. A window that is shorter by less is kept, beside the one that beats it. A margin
//! that is too wide only keeps more windows.
//!
//! * A window does not record the sides that it has crossed. VTP takes the longest edge of the
//!   mesh. The extent of the last face is no bound: past the tip of a far vertex, windows come from
//!   long faces to edges that are 1e-6 times as long.
//! * Where sides are compared instead of lengths, a point counts as beside a ray only if its
//!   distance from the ray exceeds [`MARGIN`] of the coordinates and of the same side.
//! * Rule 1 takes the shortest path to the apex, without a margin, but cuts nothing that does not
//!   cross it beyond doubt. Beside a source on the edge, a width of [`MARGIN`] of the edge holds
//!   rays of all directions, and is spared.
//! * A margin m hides angles up to √(2m). Caps flatter than [`SLIVER_HEIGHT`] have no two rays that
//!   lengths can tell apart, so all three of their vertices send windows of their own, whatever
//!   their angles are.
//!
//! # Parallel rays
//!
//! A [`Beam`](crate::Beam) is a window whose source is at infinity. It holds a direction and an
//! offset in place of an image. Turning the direction into the next frame errs by some ε, so a ray
//! errs by a lateral ε of the way to come, as that of an image does; moving the offset there errs
//! by some ε·(d + S). Ends of intervals come from the same areas n and m. Beams that are equal
//! along a range have equal slopes there, hence equal directions. They have no foot: all of their
//! rays have one direction. So the comparisons below hold for beams and cones alike.
//!
//! A beam touches the cone at an end of its segment along one ray, on which both are equal. A tie
//! elsewhere is between rays that cross, so that both windows reach beyond it; this one is between
//! rays that are parallel. If rounding put the end of the beam beyond its ray, there would be a
//! gap, of an angle ε·S/r at the distance r. So a beam begins and ends [`PLACE`]·S within its
//! segment. The cone is as short there, and both overlap beyond.
//!
//! # Comparisons in which the first of equal windows stays
//!
//! Trimming ([`trimming`](crate::trimming)) gives each point of an edge to one window. Of two equal
//! windows one is dropped, so windows may count as equal only within rounding: [`GRAIN`] of the
//! distance and [`PLACE`] of the edge, 500 and 20 ulps. The first one stays. Its path to the point
//! is as short; and beyond the point the other one would have to leave at an angle too small to
//! resolve, with two exceptions:
//!
//! * A pseudo-source that has come nearer sends its windows again. They take the place of its old
//!   ones without a margin; see the next section.
//! * A source on the edge sends rays of all directions through one point, its *foot*. A window
//!   along the edge ties with it there and has one direction only. So the foot of a window is a
//!   piece of its own. It stays among equals, and yields only to a window that is shorter at the
//!   foot. The rest of the window has one direction, along the edge. It yields to another window
//!   that is shorter by a sixteenth of [`GRAIN`].
//!
//! # Along a chain of pseudo-sources
//!
//! A shortest path bends at pseudo-sources v1, v2, ..., and the error of each one's distance is in
//! all that follow. If each comparison could cost a [`GRAIN`], errors would grow with the number of
//! bends. They do not, because an improvement of a pseudo-source reaches all that its windows
//! reached before, however small it is:
//!
//! * *Distances of vertices* are compared without a margin. A pseudo-source sends windows again
//!   whenever its distance has decreased, be it by one ulp. All families do, in any order.
//! * *Its older windows* have crossed the same faces, so that their images are equal bit for bit,
//!   and have a greater σ. Wherever one of them is stored, the new window is shorter by the
//!   difference of the σ and takes its place without a margin, at its foot as well. By induction
//!   over the faces it comes to every point that an older one has held. With a margin it would lose
//!   the tie on the first edge, and the next pseudo-source would keep its old distance.
//! * *Families that store no windows* compare with a [`MARGIN`] and lose nothing that is shorter.
//!   "One angle, one split" compares the lengths of two paths to an apex without a margin: the
//!   window that loses a side is not shorter. Windows whose root has come nearer are deleted,
//!   because the root has sent them again. Beside thin faces these families store windows, and trim
//!   them by the rule above.
//!
//! The families that store windows are MMP in all forms and orders (of half-edges, of edges,
//! batched, in buckets, label correcting, by vertices) and the Voronoi kinds. They share the
//! comparison.
//!
//! What is left are ties between windows of *different* sources or faces. Such a tie is lost
//! between two bends only where a longer path came first, over the same faces as the path that
//! bends, so that it need not bend there itself. A chain of n bends with such a path beside it, and
//! with shorter detours on other sheets of the surface, may cost n times [`GRAIN`] of the distance
//! and n times [`PLACE`] of the edges: 1e-9 of the distance for 10,000 bends. The margin cannot be
//! relative to the way from the last bend instead. Images err by a fraction of the longest side
//! that they have crossed, and on the short edges around a needle nothing but the distance tells
//! how long that is.
//!
//! # Limits of `f64`
//!
//! A position on a side of length L is a multiple of ε·L. A bent path through an end of the side is
//! compared with the distance of that vertex, which shorter edges give more exactly
//! ([`length_past_end`](crate::length_past_end)). Other paths have no such help. Where all
//! distances are far less than L, an error of ε·L is not small beside them. No order of operations
//! helps, because the abscissa itself is rounded. The same holds where one distance is less than
//! what a path accumulates across many such faces: [`PLACE`]·L on each where windows are equal.
//! [`doubt`] finds these faces and bounds the error.
//!
//! Whether a path shows the error depends on the direction in which it crosses the side. An
//! abscissa is measured from the tail, so a position beside the tail is exact and one beside the
//! head errs by ε·L. Mirroring the mesh exchanges the two. Algorithms that store the windows of
//! both directions in one frame turn positions around, and may lose an exact one. So agreement of
//! several algorithms beside a far vertex proves nothing.
//!
//! The far vertex itself must not hide this. Its distance is as long as the side, and right to
//! [`GRAIN`]; those of the vertices around it are not. What counts as the size of the distances is
//! therefore the [scale](geobench_mesh::tolerance::scale) by which answers are compared, which one
//! far vertex does not raise.
//!
//! # Termination in reasonable time
//!
//! Lengths do not distinguish a path from one that winds around a thin needle, so no filter of
//! lengths ends such windows: without trimming they wind on for millions of crossings. Trimming
//! ends them, since a window that arrives at an edge for the second time is no shorter. So
//! algorithms that store no windows store those beside thin faces, and at junctions,
//! ([`KeptWindows`](crate::trimming::KeptWindows)), and those that store windows but do not filter
//! them filter there ([`ThinFaces`](crate::trimming::ThinFaces)).
//!
//! Windows that are sent again do not change that. A window that comes back has the σ with which it
//! left. Let it win against others, and these against it, until it takes a place that it has held
//! before. σ cannot fall all around: at least once a window won that has no smaller σ, so it was
//! shorter by more than the margin. All gains together are what rounding has made of one turn,
//! which is less than the margin. So no window takes its own place again.
//!
//! This requires that a window meets what it has stored one turn before, and not only many turns
//! later, with the rounding of all. One stored edge on each way around is enough for that, so the
//! VTP kinds store no windows between faces of a [group](crate::trimming::KeptWindows::in_groups).
//! On a needle without area it comes back to its own foot. So a stored foot leaves a later one of
//! the same place no margin, and a window with a foot reaches to the ends of the edge to which its
//! rays lead.
//!
//! The order matters as well. Windows narrower than the step by which they advance at each turn do
//! not meet themselves. They are ended by a straight window that covers the edge, which must come
//! first. So windows and lists beside thin faces are taken nearest first, also by algorithms with
//! another order elsewhere, and no list there is evicted.
//!
//! The same holds for faces that are tiny beside others: the filter's margin of the distance may be
//! more than the whole region. They count as thin.
//!
//! Of two equal windows, the one that is dropped may be that of a better path to a root, or of the
//! occupant of an angle. So a window that has been stored there is not stale, nor are its
//! descendants, unless its root has come nearer by more than [`MARGIN`] of the distance and of the
//! sides there: then those that were dropped for it are as stale. Elsewhere windows are given up as
//! usual, on the same mesh. Only windows that shorter ones
//! [have replaced](crate::trimming::KeptWindows::has_replaced) altogether do not cross: what is
//! stored instead crosses, and stands for the same windows.
//!
//! [`Crossing::bent_distance`]: crate::Crossing::bent_distance

use std::fmt;

use geobench_mesh::tolerance::{self, RELATIVE};
use geobench_mesh::{FaceId, Mesh};

pub use geobench_mesh::precision::{GRAIN, MARGIN, PLACE, RESOLUTION, SLIVER_HEIGHT};

/// How many times as long as the distances a side must be to be too long for them.
const TOO_LONG: f64 = 10.0;

/// As [`TOO_LONG`], where a corner of the face is nearer than the [margin](MARGIN) of the side: no
/// digit of its distance is certain. Distances beside shorter sides err by no more than others do.
const LONG: f64 = 1.5;

/// How near a corner must be to a side that is [too long](TOO_LONG) only for the scale, as a
/// fraction of the side. Beyond that the error of the side, [`GRAIN`] of it, is within the relative
/// error of a right distance.
const NEAR: f64 = GRAIN / RELATIVE;

/// Faces that are so long, for the distances around them, that `f64` cannot resolve positions on
/// their sides.
///
/// A position on a side of length L is known to [`PLACE`]·L at best. Where all distances are far
/// less than L, because the faces are thin or sources are all around, that exceeds the last digits
/// of a distance. It also matters where one distance is a tiny part of L: a path across some dozens
/// of such faces accumulates more than [`GRAIN`]·L.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Doubt {
    /// How many such faces there are.
    pub faces: usize,
    /// The first of them, in the order of the mesh.
    pub first: FaceId,
    /// Upper bound of the error of a distance, in the units of the mesh: [`MARGIN`] of their
    /// longest side.
    pub bound: f64,
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} {} too long and thin for these distances (the first is face {}): each may be off by up \
             to {:.1e}; split the long edges to be sure",
            self.faces,
            if self.faces == 1 {
                "face is"
            } else {
                "faces are"
            },
            self.first.raw(),
            self.bound
        )
    }
}

/// The size of the finite distances in one component.
#[derive(Clone, Copy, Debug)]
struct Size {
    greatest: f64,
    scale: f64,
}

impl Size {
    fn of(distances: Vec<f64>) -> Self {
        let reached = distances.iter().filter(|d| d.is_finite());
        Self {
            greatest: reached.fold(0.0, |a, &b| f64::max(a, b)),
            scale: tolerance::scale(distances),
        }
    }

    /// Whether a side of length `longest` may be [too long](Self::is_exceeded).
    fn may_be_exceeded(self, longest: f64) -> bool {
        let least = (LONG * self.greatest).min(TOO_LONG * self.scale);
        self.greatest > 0.0 && longest > least
    }

    /// Whether a side of length `longest` is too long for distances of this size, where those at
    /// the corners of its face are `corners`.
    fn is_exceeded(self, longest: f64, corners: &[f64]) -> bool {
        let is_within = |part: f64| corners.iter().any(|&d| 0.0 < d && d < part * longest);
        self.may_be_exceeded(longest)
            && (longest > TOO_LONG * self.greatest
                || longest > LONG * self.greatest && is_within(MARGIN)
                || longest > TOO_LONG * self.scale && is_within(NEAR))
    }
}

/// Upper bound of the error of `distances`, if the longest edge has length `longest`; `None` if
/// that is not too long for them. O(distances).
///
/// [`doubt`] knows more: which distances belong to the corners of a face, and to its component.
pub fn doubtful_by(longest: f64, distances: &[f64]) -> Option<f64> {
    let size = Size::of(distances.to_vec());
    let is_long = size.is_exceeded(longest, distances);
    is_long.then_some(MARGIN * longest)
}

/// The faces of `mesh` that put its vertex `distances` in [`Doubt`]; `None` on nearly all meshes.
/// O(faces).
pub fn doubt(mesh: &Mesh, distances: &[f64]) -> Option<Doubt> {
    // One source reaches one component.
    let has_one_source = distances.iter().filter(|&&d| d == 0.0).nth(1).is_none();
    let (components, sizes) = if has_one_source {
        (Vec::new(), vec![Size::of(distances.to_vec())])
    } else {
        let components = mesh.components();
        let fields = tolerance::by_component(distances, &components);
        (components, fields.into_iter().map(Size::of).collect())
    };
    let longest = mesh.longest_edge();
    if !sizes.iter().any(|size| size.may_be_exceeded(longest)) {
        return None;
    }
    let mut doubt: Option<Doubt> = None;
    for face in mesh.faces() {
        let vertices = mesh.face_vertices(face);
        let corners = vertices.map(|v| distances[v.index()]);
        let is_reached = corners.iter().any(|d| d.is_finite());
        let lengths = mesh.side_lengths(face);
        let longest = lengths.into_iter().fold(0.0, f64::max);
        let component = components
            .get(vertices[0].index())
            .map_or(0, |&c| c as usize);
        if is_reached && sizes[component].is_exceeded(longest, &corners) {
            let so_far = doubt.get_or_insert(Doubt {
                faces: 0,
                first: face,
                bound: 0.0,
            });
            so_far.faces += 1;
            so_far.bound = so_far.bound.max(MARGIN * longest);
        }
    }
    doubt
}

#[cfg(test)]
mod tests {
    use geobench_mesh::TriangleSoup;

    use super::*;

    /// A rectangle with sides of 1 and `width`, of two faces.
    fn strip(width: f64) -> Mesh {
        let positions = vec![
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, width, 0.0],
            [1.0, width, 0.0],
        ];
        let soup = TriangleSoup::new(positions, vec![[0, 1, 2], [1, 3, 2]]);
        Mesh::from_soup(soup).unwrap().0
    }

    #[test]
    fn distances_far_below_the_sides_around_them_are_in_doubt() {
        let mesh = strip(1e-8);
        let found = doubt(&mesh, &[0.0, 0.0, 1e-8, 1e-8]).unwrap();
        assert_eq!((found.faces, found.first.raw()), (2, 0));
        assert!((found.bound / 1e-12 - 1.0).abs() < 1e-9);
        assert!(
            found
                .to_string()
                .starts_with("2 faces are too long and thin")
        );
    }

    #[test]
    fn a_distance_without_a_certain_digit_is_in_doubt() {
        let found = doubt(&strip(1e-13), &[0.0, 0.5, 1e-13, 0.5]).unwrap();
        assert!((found.bound / 1e-12 - 1.0).abs() < 1e-9);
        assert_eq!(doubtful_by(1.0, &[0.0, 0.5, 1e-13, 0.5]), Some(found.bound));
        // Other distances err as much, or it has digits.
        assert_eq!(doubt(&strip(1e-13), &[0.0, 1.0, 1e-13, 1.0]), None);
        assert_eq!(doubt(&strip(1e-11), &[0.0, 0.5, 1e-11, 0.5]), None);
        assert_eq!(doubtful_by(1.0, &[0.0, 1.0, 1e-13, 1.0]), None);
    }

    #[test]
    fn distances_of_the_size_of_the_mesh_are_not_in_doubt() {
        let mesh = strip(1e-8);
        assert_eq!(doubt(&mesh, &[0.0, 1.0, 1e-8, 1.0]), None);
        assert_eq!(
            doubt(&mesh, &[0.0, f64::INFINITY, 0.0, f64::INFINITY]),
            None
        );
    }

    /// A far vertex, at distance 1, beside a fan of `count` vertices at distances around `near`.
    fn fan(count: u32, near: f64) -> (TriangleSoup, Vec<f64>) {
        let ring = (0..=count).map(|k| [0.0, near * f64::from(k), 0.0]);
        let positions: Vec<[f64; 3]> = [[1.0, 0.0, 0.0]].into_iter().chain(ring).collect();
        let faces = (1..=count).map(|k| [0, k, k + 1]).collect();
        let distances = positions.iter().map(|[x, y, _]| x + y).collect();
        (TriangleSoup::new(positions, faces), distances)
    }

    /// Its own distance once hid that no other one is certain.
    #[test]
    fn a_far_vertex_puts_those_around_it_in_doubt() {
        for (near, expected) in [(1e-6, Some(6)), (2.2e-5, Some(5)), (2e-3, None)] {
            let (soup, distances) = fan(6, near);
            let mesh = Mesh::from_soup(soup).unwrap().0;
            let found = doubt(&mesh, &distances).map(|found| found.faces);
            assert_eq!(found, expected, "{near}");
            assert_eq!(doubtful_by(1.0, &distances).is_some(), expected.is_some());
        }
    }

    #[test]
    fn distances_of_another_component_do_not_hide_doubt() {
        let (mut soup, mut distances) = fan(6, 1e-6);
        let first = soup.positions.len() as u32;
        soup.positions
            .extend([[0.0; 3], [1e3, 0.0, 0.0], [0.0, 1e3, 0.0]].map(|p| [p[0], p[1], 1.0]));
        soup.triangles.push([first, first + 1, first + 2]);
        distances.extend([0.0, 1e3, 1e3]);
        let mesh = Mesh::from_soup(soup).unwrap().0;
        assert_eq!(doubt(&mesh, &distances).map(|found| found.faces), Some(6));
    }
}
