//! How far rounding may move a window, and what every comparison that deletes one allows for it.
//!
//! A solver deletes windows because a real path is shorter than all of their rays. It computes in
//! `f64`, so each of these comparisons must be safe against the rounding that both sides have
//! gathered. This page says how much that is. All tolerances of the solvers follow from the three
//! numbers here, [`MARGIN`], [`GRAIN`] and [`RESOLUTION`].
//!
//! # What is exact to begin with
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
//! A window holds the image p of its source, an interval b0..b1 and σ. To cross a face is
//!
//! * to turn p into the frame of the exit. The turned point errs by some ε·(|p| + S), S being the
//!   extent of the face: its longest side will do. The part ε·S matters where a source is nearer to
//!   the edge than the face is long.
//! * to find where the rays through b0 and b1 meet the exit. A ray divides the exit as n : m, both
//!   of which are areas that are not negative, and their sum loses nothing. An end errs by some
//!   ε of the length of the exit, and by ε·|p - b| over the sine of the angle at which the ray
//!   meets it, which is a lateral error of ε·|p - b|.
//!
//! After n faces the length of a path errs by at most some n·ε of itself and of the longest side
//! that it has crossed; errors have either sign, so √n·ε is what is seen. An image that comes out
//! above its edge, where no ray can come from, is mirrored: its distance from every point of
//! the edge stays what it was, and no path becomes too short.
//!
//! A gap between two windows that rounding has opened is no wider than that. A vertex in the gap
//! is reached by the bent path of either window ([`Passage::bent_distance`]): a bend by
//! the angle δ lengthens a path by at most δ²/2 of itself. So an error of δ in a direction costs
//! δ²/2 in a distance, and a gap of ε·S beside a source at distance r costs (ε·S/r)²·r.
//!
//! # Comparisons that delete what is longer
//!
//! The vertex filter, rules 1, 2 and 3 and the giving up of lists delete a window only if another
//! path is shorter by [`MARGIN`] of its length and of the extent of the face: ten thousand ε.
//! A window that is shorter by less stays, beside the one that beats it. The margin may be too
//! wide without harm, since it only keeps windows.
//!
//! * Where sides are compared instead of lengths, a point counts as beside a ray only if it is off
//!   it by [`MARGIN`] of the coordinates and of the extent.
//! * Rule 1 takes the shortest path to the apex, without a margin, but cuts nothing that does not
//!   cross it beyond doubt. Beside a source on the edge, a width of [`MARGIN`] of the edge holds rays of
//!   all directions, and is spared.
//! * A margin m hides angles up to √(2m). Caps flatter than [`SLIVER_HEIGHT`] have no
//!   two rays that lengths can tell apart, so all three of their vertices send windows of their
//!   own, whatever their angles are.
//!
//! # Comparisons in which the first of equal windows stays
//!
//! Trimming ([`trimming`](crate::trimming)) gives each point of an edge to one window. Of equal
//! windows one must go, so what counts as equal may be lost, and must be as little as rounding
//! allows: [`GRAIN`] of the distance and of the edge, 50 ulps. The first one stays. Its path to the
//! point is as short; and beyond, the other one would have to leave the point at an angle
//! that is too small to see, but in one case:
//!
//! * A source that stands on the edge sends rays of all directions through one point, its *foot*. A
//!   window along the edge ties with it there and has one direction. So the foot of a window is a
//!   piece of its own, which stays among equals and yields only to what is shorter at the foot.
//!
//! # Work
//!
//! Lengths do not tell a path from one that winds around a thin needle, so no filter of lengths
//! stops that: without trimming, windows wind on for millions of crossings. Trimming does stop
//! it, since what comes to an edge for the second time is no shorter. So algorithms that keep no windows keep
//! those beside thin faces ([`KeptWindows`](crate::trimming::KeptWindows)), and those that keep
//! windows but do not filter do so there ([`ThinFaces`](crate::trimming::ThinFaces)).
//!
//! [`Passage::bent_distance`]: crate::Passage::bent_distance

pub use geobench_mesh::precision::{GRAIN, MARGIN, RESOLUTION, SLIVER_HEIGHT};
