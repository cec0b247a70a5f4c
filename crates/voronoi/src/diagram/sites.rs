//! Sites: the (pseudo-)sources from which the points of a face are reached.

use geobench_mesh::{FaceId, Mesh};
use geobench_window::Window;

use super::line::SegmentCells;
use crate::field::{LabelledField, NO_SOURCE};
use crate::store::{Stored, edge_of};
use geobench_mesh::vector::{Point, along, between, cross_2d, dot, norm, sub, unit};

/// A (pseudo-)source as seen from a face, unfolded into the plane of the face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Site {
    pub(crate) image: Point,
    /// σ, the distance from the source of the run to the (pseudo-)source.
    pub(crate) sigma: f64,
    pub(crate) source: u32,
    /// The gate: the ends of the interval through which the paths enter the face, the left one
    /// first as seen from the image. `None` for a vertex of the face, and for an image on the line
    /// of its gate.
    pub(super) gate: Option<[Point; 2]>,
    /// The lengths of the paths to these ends; both σ without a gate.
    pub(super) to_gate: [f64; 2],
}

/// A path from a [`Site`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct SitePath {
    pub(crate) length: f64,
    /// Where it turns last: at the image, or at an end of the gate.
    turn: Point,
}

impl Site {
    /// The length of the straight path to `x`, even if it misses the gate.
    #[inline]
    pub(crate) fn straight(&self, x: Point) -> f64 {
        self.sigma + norm(sub(x, self.image))
    }

    /// As [`straight`](Self::straight), with the direction in which the path arrives.
    pub(crate) fn straight_path(&self, x: Point) -> (f64, Point) {
        (self.straight(x), unit(sub(x, self.image)))
    }

    /// The shortest path to `x` through the gate: straight, or bent around the end of the gate that
    /// the straight line misses. All these paths are paths on the surface, and their length is a
    /// convex function of `x`.
    #[inline]
    pub(crate) fn path(&self, x: Point) -> SitePath {
        let mut turn = self.image;
        let mut before = self.sigma;
        if let Some([left, right]) = self.gate {
            let ray = sub(x, self.image);
            if cross_2d(sub(left, self.image), ray) > 0.0 {
                (turn, before) = (left, self.to_gate[0]);
            } else if cross_2d(sub(right, self.image), ray) < 0.0 {
                (turn, before) = (right, self.to_gate[1]);
            }
        }
        SitePath {
            length: before + norm(sub(x, turn)),
            turn,
        }
    }

    /// The points at which the bisector with `other` leaves the part of the plane that is visible
    /// through the gate, for each end of the gate; `None` where it does not. Each ray from the
    /// image meets the bisector at most once.
    pub(crate) fn exits(&self, other: &Self) -> [Option<Point>; 2] {
        let Some(gate) = self.gate else {
            return [None; 2];
        };
        let c = sub(self.image, other.image);
        let ahead = self.sigma - other.sigma;
        gate.map(|end| {
            let u = unit(sub(end, self.image));
            let r = (ahead * ahead - dot(c, c)) / (2.0 * (dot(c, u) - ahead));
            (r > 0.0 && r + ahead >= 0.0).then(|| along(self.image, r, u))
        })
    }

    /// The straight paths to the points of the segment from `from` to `to`, of length `l`, as a
    /// window in the frame of the segment; `None` if no part of the segment is visible through the
    /// gate.
    pub(crate) fn window(&self, from: Point, to: Point, l: f64) -> Option<Window> {
        let u = sub(to, from).map(|c| c / l);
        let frame = |p: Point| {
            let p = sub(p, from);
            [dot(p, u), cross_2d(u, p)]
        };
        let [px, py] = frame(self.image);
        let mut window = Window {
            b0: 0.0,
            b1: l,
            px,
            py,
            sigma: self.sigma,
        };
        let Some(gate) = self.gate else {
            return Some(window);
        };
        // The visible part of the segment is on the right of the ray through the left end of the
        // gate, and on the left of the other ray. The slack keeps rounding from opening a gap
        // between the parts that two neighbouring windows see.
        for (end, side) in gate.into_iter().zip([1.0, -1.0]) {
            let ray = sub(end, self.image);
            let slack = VISIBLE * l * norm(ray);
            let [out0, out1] = [from, to].map(|x| side * cross_2d(ray, sub(x, self.image)) - slack);
            if out0 > 0.0 && out1 > 0.0 {
                return None;
            }
            let place = l * out0 / (out0 - out1);
            if out0 > 0.0 {
                window.b0 = window.b0.max(place);
            } else if out1 > 0.0 {
                window.b1 = window.b1.min(place);
            }
        }
        (window.b0 < window.b1).then_some(window)
    }
}

/// How far beyond the rays through the ends of its gate a site sees, as a fraction of the segment.
const VISIBLE: f64 = 1e-9;

/// A face in the plane, and all sites that reach it.
#[derive(Clone, Debug)]
pub(crate) struct FaceSites {
    pub(crate) corners: [Point; 3],
    pub(crate) sites: Vec<Site>,
    /// Length of the longest side.
    pub(crate) size: f64,
}

impl FaceSites {
    pub(crate) fn new(field: &LabelledField<'_>, face: FaceId) -> Self {
        let mesh = field.mesh;
        let corners = corners(mesh, face);
        let directions = directions(mesh, face);
        let mut sites = Vec::new();
        for k in 0..3 {
            let h = face.half_edge(k);
            let Some(twin) = mesh.twin(h) else {
                continue;
            };
            let (e, is_reversed) = edge_of(h, twin);
            let l = mesh.length(h);
            let (origin, u) = (corners[k as usize], directions[k as usize]);
            let place = |x: f64, y: f64| {
                [
                    origin[0] + x * u[0] - y * u[1],
                    origin[1] + x * u[1] + y * u[0],
                ]
            };
            let enters = |s: &&Stored| s.is_reversed() == is_reversed;
            for stored in field.store.list(e).iter().filter(enters) {
                let w = if is_reversed {
                    stored.window.reversed(l)
                } else {
                    stored.window
                };
                let (image, gate) = (place(w.px, w.py), [place(w.b0, 0.0), place(w.b1, 0.0)]);
                let to_gate = gate.map(|end| w.sigma + norm(sub(end, image)));
                let source = stored.source();
                let near = usize::from(to_gate[1] < to_gate[0]);
                // The image is on the line of the edge. Only the paths through the nearer end of
                // the gate are straight, so this end replaces the image.
                sites.push(if w.py.abs() <= GRAZING * (to_gate[near] - w.sigma) {
                    Site {
                        image: gate[near],
                        sigma: to_gate[near],
                        source,
                        gate: None,
                        to_gate: [to_gate[near]; 2],
                    }
                } else {
                    Site {
                        image,
                        sigma: w.sigma,
                        source,
                        gate: Some(gate),
                        to_gate,
                    }
                });
            }
        }
        for (v, image) in mesh.face_vertices(face).into_iter().zip(corners) {
            let (sigma, source) = (field.distances[v.index()], field.labels[v.index()]);
            if source != NO_SOURCE {
                sites.push(Site {
                    image,
                    sigma,
                    source,
                    gate: None,
                    to_gate: [sigma; 2],
                });
            }
        }
        let lengths = mesh.side_lengths(face);
        Self {
            corners,
            sites,
            size: lengths.into_iter().fold(0.0, f64::max),
        }
    }

    /// The same face, in which the paths of each source are a little longer than those of the
    /// source before it, by more than rounding. Then no two sources tie throughout a part of the
    /// face.
    pub(crate) fn ranked(&self) -> Self {
        let mut ranked = self.clone();
        let mut sources: Vec<u32> = self.sites.iter().map(|site| site.source).collect();
        sources.sort_unstable();
        sources.dedup();
        let step = RANK * (self.distance(self.corners[0]) + self.size);
        for site in &mut ranked.sites {
            let rank = sources.partition_point(|&source| source < site.source);
            let more = rank as f64 * step;
            site.sigma += more;
            site.to_gate = site.to_gate.map(|length| length + more);
        }
        ranked
    }

    /// The cells along a segment of the face. `ends` are the cells at its ends, which are decided
    /// already.
    pub(crate) fn line(&self, from: Point, to: Point, ends: [u32; 2]) -> SegmentCells {
        let l = norm(sub(to, from));
        let windows = self.sites.iter();
        let windows = windows.filter_map(|s| Some((s.window(from, to, l)?, s.source)));
        let line = SegmentCells::envelope(Vec::new(), windows, l, ends);
        line.settled(self.size, |t, wanted| {
            let x = between(from, to, t);
            let sites = self.sites.iter();
            let sites = sites.filter(|site| wanted.is_none_or(|source| site.source == source));
            let paths = sites.map(|site| (site.path(x).length, site.source));
            paths.fold((f64::INFINITY, NO_SOURCE), |least, path| {
                if path.0 < least.0 { path } else { least }
            })
        })
    }

    /// The length of the shortest path to `x`.
    pub(crate) fn distance(&self, x: Point) -> f64 {
        let lengths = self.sites.iter().map(|site| site.path(x).length);
        lengths.fold(f64::INFINITY, f64::min)
    }

    /// The rounding error of distances of about `d` in this face.
    pub(crate) fn rounding(&self, d: f64) -> f64 {
        ROUNDING * (d + self.size)
    }
}

/// Height of an image over the line of its gate, relative to its distance from the gate, up to
/// which the image counts as on that line.
const GRAZING: f64 = 1e-14;

/// By how much a path from a vertex of the face must be shorter than a straight path through a gate
/// to be preferred to it, relative to its length.
pub(super) const FROM_VERTEX: f64 = 1e-15;

/// By how much a bent path must be shorter than a straight one to be preferred to it, relative to
/// the sum of its length and the size of the face. This is less than [`ROUNDING`], so that a
/// straight path that is preferred is as short up to rounding.
pub(super) const BENT: f64 = 1e-13;

/// Relative error of distances at a point of a face.
pub(crate) const ROUNDING: f64 = 2e-13;

/// By how much paths differ from one source to the next in [ranked](FaceSites::ranked) sites, as a
/// fraction of the distance and the size of the face. This is more than trimming and [`ROUNDING`]
/// leave undecided.
const RANK: f64 = 1e-12;

/// A site and its shortest path to a point; see [`nearest`](super::table::MeasuredSites::nearest).
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearestSite {
    pub(crate) site: usize,
    pub(crate) length: f64,
    turn: Point,
}

impl NearestSite {
    pub(super) fn of(site: usize, path: SitePath) -> Self {
        Self {
            site,
            length: path.length,
            turn: path.turn,
        }
    }

    pub(super) const NONE: Self = Self {
        site: usize::MAX,
        length: f64::INFINITY,
        turn: [0.0; 2],
    };

    /// The direction in which its path arrives at `x`, its end.
    pub(crate) fn direction(&self, x: Point) -> Point {
        unit(sub(x, self.turn))
    }
}

/// See [`nearest`](super::table::MeasuredSites::nearest).
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearestSites<const N: usize> {
    /// The length of the shortest path.
    pub(crate) least: f64,
    /// The shortest path of each source, infinitely long if it has no site.
    pub(crate) each: [NearestSite; N],
}

impl NearestSites<2> {
    /// The sites of both sources; `None` if one has none.
    pub(super) fn pair(&self) -> Option<[usize; 2]> {
        let pair = self.each.map(|site| site.site);
        (!pair.contains(&usize::MAX)).then_some(pair)
    }
}

/// The corners of `face` in the frame of its first half-edge.
pub(crate) fn corners(mesh: &Mesh, face: FaceId) -> [Point; 3] {
    let h = face.half_edge(0);
    [[0.0; 2], [mesh.length(h), 0.0], mesh.apex(h)]
}

/// The unit vectors along the sides of `face` in the frame of its first half-edge.
///
/// The images behind a short side can be far away, and turn with its direction. So the direction
/// must be more accurate than the difference of two corners of a long face. It follows from the
/// angle to the first side, in the frame that gives this angle best.
fn directions(mesh: &Mesh, face: FaceId) -> [Point; 3] {
    let [third, first, second] = mesh.apexes(face);
    let lengths = [0, 2].map(|k| mesh.length(face.half_edge(k)));
    let last = if lengths[0] < lengths[1] {
        [-third[0], -third[1]]
    } else {
        [second[0] - lengths[1], -second[1]]
    };
    [[1.0, 0.0], unit([-first[0], first[1]]), unit(last)]
}
