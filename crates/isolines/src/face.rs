//! Joins the arcs in a face and the crossings of its edges into parts of lines.

use crate::arc::CircleArc;
use geobench_mesh::vector::{Point, norm, sub};

/// A connected part of an isoline in one face: from the crossing at which it enters to that at
/// which it leaves, or a loop inside the face.
#[derive(Default)]
pub(crate) struct Link {
    /// The number of the crossing at which it leaves the face; `None` for a loop.
    pub(crate) exit: Option<usize>,
    /// For a link without arcs, the points at which it enters and leaves the face.
    pub(crate) straight: Option<[Point; 2]>,
    /// The numbers of its arcs, each with its start and its end. An arc starts at the end of the
    /// previous one. Except in a loop, the first starts and the last ends at a crossing.
    pub(crate) ends: Vec<(usize, [Point; 2])>,
    /// Its arcs, which the caller makes from the other fields.
    pub(crate) arcs: Vec<CircleArc>,
}

/// The ends of arcs in a face, and the crossings of its edges.
#[derive(Default)]
pub(crate) struct FaceConnections {
    /// The crossings at which lines enter the face, with their numbers.
    entries: Vec<(usize, Point)>,
    /// The crossings at which lines leave the face, with their numbers.
    exits: Vec<(usize, Point)>,
    /// The start and the end of each arc.
    arcs: Vec<[Point; 2]>,
}

impl FaceConnections {
    /// Adds the crossing `number` at point `at`, where the line enters or leaves the face.
    pub(crate) fn cross(&mut self, number: usize, at: Point, enters: bool) {
        if enters {
            self.entries.push((number, at));
        } else {
            self.exits.push((number, at));
        }
    }

    /// Adds an arc with this start and this end.
    pub(crate) fn arc(&mut self, ends: [Point; 2]) {
        self.arcs.push(ends);
    }

    /// Whether no line crosses an edge of the face.
    pub(crate) fn is_empty(&self) -> bool {
        self.entries.is_empty() && self.exits.is_empty()
    }

    /// Joins each entry and each end of an arc with an exit or the start of an arc, closest pairs
    /// first. Returns the links from all entries with the numbers of these, the loops, and the
    /// largest gap between joined points.
    ///
    /// No point is left over: entries and exits alternate around the face, so there are as many of
    /// one as of the other.
    pub(crate) fn connect(self) -> (Vec<(usize, Link)>, Vec<Link>, f64) {
        let Self {
            entries,
            exits,
            arcs,
        } = self;
        let entered = entries.len();
        let from: Vec<Point> = entries.iter().map(|&(_, at)| at).collect();
        let from: Vec<Point> = from.into_iter().chain(arcs.iter().map(|a| a[1])).collect();
        let to: Vec<Point> = exits.iter().map(|&(_, at)| at).collect();
        let to: Vec<Point> = to.into_iter().chain(arcs.iter().map(|a| a[0])).collect();
        let mut pairs = Vec::with_capacity(from.len() * to.len());
        for (i, &a) in from.iter().enumerate() {
            pairs.extend(to.iter().enumerate().map(|(j, &b)| (norm(sub(a, b)), i, j)));
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let mut next = vec![None; from.len()];
        let mut taken = vec![false; to.len()];
        let mut gap = 0.0_f64;
        for (apart, i, j) in pairs {
            if next[i].is_none() && !taken[j] {
                next[i] = Some(j);
                taken[j] = true;
                gap = gap.max(apart);
            }
        }
        let mut is_used = vec![false; arcs.len()];
        let mut follow = |start: usize| {
            let mut link = Link::default();
            let mut here = start;
            // The start of the next arc: the entry, or the end of the previous arc.
            let mut at = (start < entered).then(|| from[start]);
            while let Some(j) = next[here] {
                let Some(i) = j.checked_sub(exits.len()) else {
                    link.exit = Some(exits[j].0);
                    if let Some((_, ends)) = link.ends.last_mut() {
                        ends[1] = exits[j].1;
                    } else {
                        link.straight = at.map(|at| [at, exits[j].1]);
                    }
                    break;
                };
                if is_used[i] {
                    break;
                }
                is_used[i] = true;
                let [start, end] = arcs[i];
                link.ends.push((i, [at.unwrap_or(start), end]));
                at = Some(end);
                here = entered + i;
            }
            link
        };
        let ways = (0..entered).map(|e| (entries[e].0, follow(e))).collect();
        let mut loops = Vec::new();
        for i in 0..arcs.len() {
            // Follow the loop from the predecessor of arc `i`. The link is empty if the arc is
            // used already.
            let before = next.iter().position(|&j| j == Some(exits.len() + i));
            if let Some(before) = before {
                let link = follow(before);
                if !link.ends.is_empty() {
                    loops.push(link);
                }
            }
        }
        (ways, loops, gap)
    }
}
