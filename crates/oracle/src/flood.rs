//! The oracle: all straight lines from every point where a shortest path can start or bend.

use std::error::Error;
use std::fmt;

use crate::bounds::edge_graph;
use crate::scalar::RealNumber;
use crate::surface::{PreciseSurface, next, prev};

/// The factor of the largest distance still wanted, up to which a line is followed.
const MARGIN: f64 = 1.0 + 1e-9;

/// Adjacent straight lines from one point that cross one side.
///
/// They arrive from below the side's frame, and cross the side's triangle next.
#[derive(Clone, Copy)]
struct FloodBeam<S> {
    side: usize,
    from: S,
    to: S,
    origin: [S; 2],
}

/// Options of the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Search {
    /// Whether lines start at every vertex, not only where a shortest path can bend.
    pub everywhere: bool,
    /// Whether lines are dropped that are longer, everywhere on the side that they reach, than a
    /// known path to an end of the side and on along it; and, for surfaces in space, lines that
    /// meet a triangle again. Distances do not change.
    pub prune: bool,
    /// The number of beams after which the search gives up.
    pub most_beams: u64,
}

impl Search {
    /// All lines from every vertex where a path can bend.
    pub(crate) const EXHAUSTIVE: Self = Self {
        everywhere: false,
        prune: false,
        most_beams: u64::MAX,
    };

    /// Lines from every vertex where a path can bend, pruned, in at most `most_beams` beams.
    pub const fn pruned(most_beams: u64) -> Self {
        Self {
            prune: true,
            most_beams,
            ..Self::EXHAUSTIVE
        }
    }

    /// The same search with lines from every vertex.
    #[must_use]
    pub const fn from_everywhere(self) -> Self {
        Self {
            everywhere: true,
            ..self
        }
    }
}

/// The search needs more beams than it is allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GaveUp;

impl fmt::Display for GaveUp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the oracle gave up: too many lines")
    }
}

impl Error for GaveUp {}

/// The distance of every vertex from the nearest of `sources`; `None` where no path leads.
///
/// Exact up to rounding. This is Dijkstra's algorithm on the vertices at which a path can bend,
/// where all straight lines between these vertices are the edges. When such a vertex is final, all
/// lines from it are followed, depth first, until they are longer than any distance that could
/// still improve. A line that runs exactly into a vertex is covered by the beams on both sides of
/// it, whose end rays are also offered to the vertices near them.
///
/// The number of lines, and the time, grow with the number of bends. On curved surfaces they grow
/// much faster than the number of triangles. Memory stays small.
///
/// # Panics
///
/// If a source is not a vertex.
pub fn distances<S: RealNumber>(surface: &PreciseSurface<S>, sources: &[u32]) -> Vec<Option<S>> {
    match search(surface, sources, Search::EXHAUSTIVE) {
        Ok(distances) => distances,
        Err(gave_up) => unreachable!("{gave_up}, but it may take any number of them"),
    }
}

/// As [`distances`], with a search that may prune and may give up.
///
/// ```
/// use geobench_oracle::{DoubleDouble, Search, rounded, search, zoo};
///
/// let surface = zoo::octahedron().surface::<DoubleDouble>();
/// let found = search(&surface, &[0], Search::pruned(1_000)).expect("1,000 beams are enough");
/// assert_eq!(rounded(&found)[1], 6.0_f64.sqrt());
/// assert!(search(&surface, &[0], Search::pruned(3)).is_err());
/// ```
///
/// # Errors
///
/// If the search needs more beams than allowed.
///
/// # Panics
///
/// If a source is not a vertex.
pub fn search<S: RealNumber>(
    surface: &PreciseSurface<S>,
    sources: &[u32],
    search: Search,
) -> Result<Vec<Option<S>>, GaveUp> {
    let mut best = edge_graph(surface, sources);
    let mut open: Vec<usize> = (0..best.len()).filter(|&v| best[v].is_some()).collect();
    let mut beams_left = search.most_beams;
    let nearer = |best: &[Option<S>], a: usize, b: usize| best[a] < best[b];
    while let Some(at) = (0..open.len()).reduce(|i, j| {
        if nearer(&best, open[j], open[i]) {
            j
        } else {
            i
        }
    }) {
        let vertex = open.swap_remove(at);
        let Some(start) = best[vertex] else { continue };
        for &side in &surface.leaving[vertex] {
            let (ahead, back) = (next(side), prev(side));
            offer(
                &mut best[surface.sides[ahead].tail],
                start + surface.sides[side].length,
            );
            offer(
                &mut best[surface.sides[back].tail],
                start + surface.sides[back].length,
            );
        }
        let is_source = sources.contains(&(vertex as u32));
        let furthest = open.iter().filter_map(|&v| best[v]).reduce(RealNumber::max);
        if let Some(furthest) = furthest
            && (is_source || search.everywhere || surface.bends_at(vertex as u32))
        {
            let mut lines = VertexLines {
                surface,
                start,
                limit: furthest * S::from_f64(MARGIN),
                prune: search.prune,
                best: &mut best,
                beams_left: &mut beams_left,
            };
            lines.follow_from(vertex)?;
        }
    }
    Ok(best)
}

fn offer<S: RealNumber>(best: &mut Option<S>, length: S) {
    if best.is_none_or(|b| length < b) {
        *best = Some(length);
    }
}

/// The lines from one vertex.
struct VertexLines<'a, S> {
    surface: &'a PreciseSurface<S>,
    /// Distance of the vertex.
    start: S,
    /// The distance up to which lines are followed.
    limit: S,
    prune: bool,
    best: &'a mut [Option<S>],
    beams_left: &'a mut u64,
}

impl<S: RealNumber> VertexLines<'_, S> {
    fn follow_from(&mut self, vertex: usize) -> Result<(), GaveUp> {
        let surface = self.surface;
        let mut waiting: Vec<(usize, FloodBeam<S>)> = surface.leaving[vertex]
            .iter()
            .flat_map(|&leaving| {
                // In the frame of the neighbour across the opposite side, that side is rotated by
                // half a turn about its midpoint.
                let opposite = surface.sides[next(leaving)];
                let beam = FloodBeam {
                    side: next(leaving),
                    from: S::zero(),
                    to: opposite.length,
                    origin: [from_head(surface, next(leaving)), -opposite.apex[1]],
                };
                entering(surface, beam).map(|beam| (0, beam))
            })
            .collect();
        // The triangles that the current beam has crossed.
        let mut crossed: Vec<usize> = Vec::new();
        // In depth-first order few beams wait at any time.
        while let Some((depth, beam)) = waiting.pop() {
            let [x, y] = beam.origin;
            let nearest = beam.from.max(beam.to.min(x));
            if self.start + (nearest - x).hypot(y) > self.limit {
                continue;
            }
            crossed.truncate(depth);
            let triangle = beam.side / 3;
            if self.prune && (self.is_beaten(&beam) || self.returns(triangle, &crossed)) {
                continue;
            }
            crossed.push(triangle);
            *self.beams_left = self.beams_left.checked_sub(1).ok_or(GaveUp)?;
            let apex_vertex = surface.sides[prev(beam.side)].tail;
            let (split, through) = reach_apex(surface, &beam);
            offer(&mut self.best[apex_vertex], self.start + through);
            let parts = [
                left_part(surface, &beam, split),
                right_part(surface, &beam, split),
            ];
            for part in parts.into_iter().flatten() {
                waiting.extend(entering(surface, part).map(|beam| (depth + 1, beam)));
            }
        }
        Ok(())
    }

    /// Whether a beam that has `crossed` triangles meets one of them again. Between two points of a
    /// triangle in space no path is shorter than the straight one within it.
    fn returns(&self, triangle: usize, crossed: &[usize]) -> bool {
        self.surface.in_space && crossed.contains(&triangle)
    }

    /// Whether a path to an end of the side and along it is shorter than `beam` everywhere on the
    /// side.
    ///
    /// The advantage of the path through the tail decreases along the side, because no length grows
    /// faster than the position on the side. Its least value is therefore at the far end of the
    /// beam. The head is symmetric.
    fn is_beaten(&self, beam: &FloodBeam<S>) -> bool {
        let entered = &self.surface.sides[beam.side];
        let head = self.surface.sides[next(beam.side)].tail;
        let [x, y] = beam.origin;
        let beaten = |end: usize, along: S, place: S| {
            let here = self.start + (place - x).hypot(y);
            self.best[end].is_some_and(|d| (d + along) * S::from_f64(1.0 + S::LEAD) < here)
        };
        beaten(entered.tail, beam.to, beam.to)
            || beaten(head, entered.length - beam.from, beam.from)
    }
}

/// The position at which the line to the apex crosses the beam's side, and the length of the
/// shortest path to the apex through the beam: straight if the position is within the beam, else
/// along its end ray.
fn reach_apex<S: RealNumber>(surface: &PreciseSurface<S>, beam: &FloodBeam<S>) -> (S, S) {
    let [cx, cy] = surface.sides[beam.side].apex;
    let [px, py] = beam.origin;
    let split = (cy * px - py * cx) / (cy - py);
    let through = if beam.from <= split && split <= beam.to {
        (cx - px).hypot(cy - py)
    } else {
        let bend = beam.from.max(beam.to.min(split));
        (bend - px).hypot(py) + (bend - cx).hypot(cy)
    };
    (split, through)
}

/// The beams into all other triangles along a side, from one that leaves its triangle there. That
/// one is in the frame of a neighbour whose side has the opposite direction.
fn entering<S: RealNumber>(
    surface: &PreciseSurface<S>,
    leaving: FloodBeam<S>,
) -> impl Iterator<Item = FloodBeam<S>> {
    let length = surface.sides[leaving.side].length;
    surface.beyond[leaving.side].iter().map(move |beyond| {
        let side = beyond.side;
        if !beyond.turned {
            return FloodBeam { side, ..leaving };
        }
        let [x, y] = leaving.origin;
        FloodBeam {
            side,
            from: length - leaving.to,
            to: length - leaving.from,
            origin: [length - x, y],
        }
    })
}

/// The lines that leave through the side from tail to apex.
fn left_part<S: RealNumber>(
    surface: &PreciseSurface<S>,
    beam: &FloodBeam<S>,
    split: S,
) -> Option<FloodBeam<S>> {
    let entered = surface.sides[beam.side];
    let side = prev(beam.side);
    let left = surface.sides[side];
    if beam.from >= split {
        return None;
    }
    let ([cx, cy], [px, py]) = (entered.apex, beam.origin);
    let length = left.length;
    // The side is divided as n : m, with non-negative parts, so their sum has no cancellation.
    let at = |s: S| {
        let (n, m) = (-(py * s), (split - s).max(S::zero()) * (cy - py));
        clamp(length * n / (n + m), length)
    };
    let (ux, uy) = (cx / length, cy / length);
    kept(FloodBeam {
        side,
        from: at(beam.from),
        to: if beam.to >= split {
            length
        } else {
            at(beam.to)
        },
        origin: [ux * px + uy * py, ux * py - uy * px],
    })
}

/// The lines that leave through the side from apex to head.
fn right_part<S: RealNumber>(
    surface: &PreciseSurface<S>,
    beam: &FloodBeam<S>,
    split: S,
) -> Option<FloodBeam<S>> {
    let entered = surface.sides[beam.side];
    let side = next(beam.side);
    let right = surface.sides[side];
    if beam.to <= split {
        return None;
    }
    let ([cx, cy], [px, py]) = (entered.apex, beam.origin);
    let (length, base) = (right.length, entered.length);
    let at = |s: S| {
        let (n, m) = (-(py * (base - s)), (s - split).max(S::zero()) * (cy - py));
        clamp(length * m / (n + m), length)
    };
    let (ux, uy) = (from_head(surface, beam.side) / length, -cy / length);
    kept(FloodBeam {
        side,
        from: if beam.from <= split {
            S::zero()
        } else {
            at(beam.from)
        },
        to: at(beam.to),
        origin: [
            ux * (px - cx) + uy * (py - cy),
            ux * (py - cy) - uy * (px - cx),
        ],
    })
}

/// The distance from the foot of the apex to the head of a side. Subtracting the abscissa from the
/// length would cancel on a short side. Two adjacent sides project on each other instead.
fn from_head<S: RealNumber>(surface: &PreciseSurface<S>, side: usize) -> S {
    let ahead = &surface.sides[next(side)];
    ahead.apex[0] * ahead.length / surface.sides[side].length
}

fn clamp<S: RealNumber>(x: S, length: S) -> S {
    x.max(S::zero()).min(length)
}

/// The beam, if it has a width and comes from below its side. A beam for which rounding says
/// otherwise has at most one line.
fn kept<S: RealNumber>(beam: FloodBeam<S>) -> Option<FloodBeam<S>> {
    (beam.from < beam.to && beam.origin[1] < S::zero()).then_some(beam)
}
