//! Division of a face among the cells that share it.
//!
//! Given are the points at which cells change along the sides of the face. Every cell reaches its
//! points by straight lines from the sides, so each part of a cell touches a side. Hence the
//! borders inside the face form a forest whose leaves are the changes on the sides.
//!
//! A triangle is simple in two cases. Two changes are joined by one border. Changes between cells
//! that are all different meet in one vertex, if a point is equally far from all these cells. Any
//! other triangle is cut in two, the largest first, until each part is simple or too small to
//! matter. So the result is always a division of the face, regardless of rounding.

use geobench_window::queue::MinHeap;

use super::border::{BorderPart, BorderTracer, meeting_point};
use super::curve::Bisector;
use super::line::{Change, SegmentCells};
use super::sites::FaceSites;
use super::table::MeasuredSites;
use geobench_mesh::vector::{Point, between, cross_2d, norm, sub};

/// A point of the diagram inside a face or on its sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FaceNode {
    pub(crate) at: Point,
    pub(crate) kind: FaceNodeKind,
}

/// The position of a [`FaceNode`] in the face and in the borders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FaceNodeKind {
    /// Change number `change` of side `side`.
    Side { side: u8, change: u32 },
    /// Inside the face: a border continues along another bisector, or crosses a cut.
    Inside,
    /// A Voronoi vertex at which this many borders meet.
    Vertex(u32),
}

/// A piece of a border inside a face.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Piece {
    /// The indices of the nodes at which it begins and ends.
    pub(crate) nodes: [usize; 2],
    /// The cells on its left and on its right.
    pub(crate) sources: [u32; 2],
    /// The bisector that contains it; `None` if it is a straight line up to rounding.
    pub(crate) curve: Option<Bisector>,
}

/// A part of a cell in one of the triangles into which a face was cut.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Region {
    pub(crate) source: u32,
    /// Its border, counter-clockwise.
    pub(crate) border: Vec<Span>,
    /// The numbers of the runs on its border.
    pub(crate) runs: Vec<u32>,
}

/// A part of the border of a [`Region`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Span {
    /// Along the sides of the triangle.
    Sides(Vec<Point>),
    /// The index of a piece, and whether it is followed from its first node to its second.
    Inside(usize, bool),
}

/// The division of a face.
#[derive(Clone, Debug, Default)]
pub(crate) struct Arrangement {
    pub(crate) nodes: Vec<FaceNode>,
    pub(crate) pieces: Vec<Piece>,
    pub(crate) regions: Vec<Region>,
    /// The cell of each run along the cuts. Cuts separate [regions](Self::regions) of one cell.
    pub(crate) cuts: Vec<u32>,
    /// The Voronoi vertices: the index of the node, and the cells around it, counter-clockwise.
    pub(crate) vertices: Vec<(usize, Vec<u32>)>,
}

/// Size of a triangle, as a fraction of the face, up to which it is too small to matter. Along any
/// border in it, the distances of both cells differ by at most twice its size.
const SMALL: f64 = 1e-10;

/// Greatest number of triangles of a face that are cut in two. About eighty of them lie around each
/// point that is in doubt.
const MOST_CUTS: u32 = 1000;

/// The same for the first attempts. If they leave doubt, the face is divided anew with
/// [ranked](FaceSites::ranked) sites.
const FEW_CUTS: u32 = 300;

/// How far outside a triangle rounding may place a point of it, as a fraction of the width of the
/// triangle.
const SLACK: f64 = 1e-9;

/// The same, as a fraction of the size of the face.
pub(super) const FACE_SLACK: f64 = 1e-14;

/// A change on a side of a triangle.
#[derive(Clone, Copy, Debug)]
struct SideChange {
    /// The position on the side, from 0 to 1.
    at: f64,
    node: usize,
    /// The cell after it.
    next: u32,
}

/// A side of a triangle.
#[derive(Clone, Debug)]
struct TriangleSide {
    first: u32,
    marks: Vec<SideChange>,
    /// The numbers of its runs: the one before the first change, and the one after each change.
    runs: Vec<u32>,
}

impl TriangleSide {
    fn last(&self) -> u32 {
        self.marks.last().map_or(self.first, |mark| mark.next)
    }

    fn reversed(&self) -> Self {
        let mut next = self.first;
        let mut marks: Vec<SideChange> = Vec::with_capacity(self.marks.len());
        for mark in &self.marks {
            marks.push(SideChange {
                at: 1.0 - mark.at,
                next,
                ..*mark
            });
            next = mark.next;
        }
        marks.reverse();
        Self {
            first: next,
            marks,
            runs: self.runs.iter().rev().copied().collect(),
        }
    }

    /// Its two halves.
    fn halves(&self) -> [Self; 2] {
        let count = self.marks.iter().take_while(|mark| mark.at <= 0.5).count();
        let (near, far) = self.marks.split_at(count);
        let scaled = |marks: &[SideChange], from: f64| {
            let scale = |mark: &SideChange| SideChange {
                at: (2.0 * (mark.at - from)).clamp(0.0, 1.0),
                ..*mark
            };
            marks.iter().map(scale).collect()
        };
        let near = Self {
            first: self.first,
            marks: scaled(near, 0.0),
            runs: self.runs[..=count].to_vec(),
        };
        let far = Self {
            first: near.last(),
            marks: scaled(far, 0.5),
            runs: self.runs[count..].to_vec(),
        };
        [near, far]
    }
}

/// A triangle of a face, with the cells along its sides.
pub(super) struct FaceTriangle {
    corners: [Point; 3],
    sides: [TriangleSide; 3],
}

/// A change on the border of a triangle, reached by a counter-clockwise walk around the triangle.
#[derive(Clone)]
struct BoundaryChange {
    node: usize,
    side: usize,
    /// The cells before and after it.
    before: u32,
    next: u32,
    /// The numbers of the runs up to the next change, and the border of the cell along them.
    runs: Vec<u32>,
    border: Vec<Span>,
}

impl FaceTriangle {
    /// The changes around the triangle, counter-clockwise from its first corner.
    fn changes(&self, nodes: &[FaceNode]) -> Vec<BoundaryChange> {
        let mut changes: Vec<BoundaryChange> = Vec::new();
        let mut leading = Vec::new();
        let mut before = self.sides[0].first;
        for (number, side) in self.sides.iter().enumerate() {
            let runs = changes
                .last_mut()
                .map_or(&mut leading, |change| &mut change.runs);
            runs.push(side.runs[0]);
            for (mark, &run) in side.marks.iter().zip(&side.runs[1..]) {
                changes.push(BoundaryChange {
                    node: mark.node,
                    side: number,
                    before,
                    next: mark.next,
                    runs: vec![run],
                    border: Vec::new(),
                });
                before = mark.next;
            }
        }
        if let Some(last) = changes.last_mut() {
            last.runs.extend(leading);
        }
        for i in 0..changes.len() {
            let j = (i + 1) % changes.len();
            let outline = self.outline(&changes[i], &changes[j], j == 0, nodes);
            changes[i].border.push(Span::Sides(outline));
        }
        changes
    }

    /// The longest side.
    pub(super) fn size(&self) -> f64 {
        let [a, b, c] = self.corners;
        norm(sub(b, a)).max(norm(sub(c, b))).max(norm(sub(a, c)))
    }

    /// The height over the longest side.
    fn width(&self) -> f64 {
        let [a, b, c] = self.corners;
        cross_2d(sub(b, a), sub(c, a)).abs() / self.size()
    }

    /// Whether `x` is inside, or outside by no more than `slack`.
    pub(super) fn contains(&self, x: Point, slack: f64) -> bool {
        (0..3).all(|k| {
            let (a, b) = (self.corners[k], self.corners[(k + 1) % 3]);
            let side = sub(b, a);
            cross_2d(side, sub(x, a)) >= -slack * norm(side)
        })
    }

    /// The sides between two changes, counter-clockwise. `wraps` tells whether the walk passes the
    /// first corner.
    fn outline(
        &self,
        from: &BoundaryChange,
        to: &BoundaryChange,
        wraps: bool,
        nodes: &[FaceNode],
    ) -> Vec<Point> {
        let mut outline = vec![nodes[from.node].at];
        let end = to.side + if wraps { 3 } else { 0 };
        for side in from.side..end {
            outline.push(self.corners[(side + 1) % 3]);
        }
        outline.push(nodes[to.node].at);
        outline
    }
}

/// Divides a face. `lines` are the cells along its sides, and `runs` the numbers of the runs there.
/// Runs along cuts are numbered from `next_run` on.
///
/// If several cells tie throughout a part of the face, no border can be found there. Such a face is
/// divided as if each source were a little nearer than the next one. The attempts end with the
/// first one that leaves no doubt; otherwise the one with the least doubt is taken.
pub(crate) fn arrange(
    sites: &FaceSites,
    lines: &[SegmentCells; 3],
    runs: &[Vec<u32>; 3],
    next_run: u32,
) -> Arrangement {
    let simple = Effort {
        most_cuts: FEW_CUTS,
        joins_neighbours: false,
    };
    let joining = Effort {
        joins_neighbours: true,
        ..simple
    };
    let thorough = Effort {
        most_cuts: MOST_CUTS,
        ..joining
    };
    let mut best: Option<(Arrangement, f64)> = None;
    for (effort, is_ranked) in [
        (simple, false),
        (joining, false),
        (thorough, true),
        (thorough, false),
    ] {
        let ranked = is_ranked.then(|| sites.ranked());
        let sites = ranked.as_ref().unwrap_or(sites);
        let found = arrange_within(effort, sites, lines, runs, next_run);
        if best.as_ref().is_none_or(|(_, doubt)| found.1 < *doubt) {
            best = Some(found);
        }
        if let Some((arrangement, 0.0)) = best {
            return arrangement;
        }
    }
    best.unwrap_or_default().0
}

/// How thoroughly a face is divided.
#[derive(Clone, Copy, Debug)]
struct Effort {
    most_cuts: u32,
    /// Whether neighbouring changes are [joined](Arranger::join_neighbours) before a triangle is
    /// cut in two, and whether the [meeting](Arranger::meeting) point is also searched for if some
    /// cells tie.
    joins_neighbours: bool,
}

/// Divides a face with the given effort. Also returns the size of the largest triangle that is in
/// doubt; 0 if there is none.
fn arrange_within(
    effort: Effort,
    sites: &FaceSites,
    lines: &[SegmentCells; 3],
    runs: &[Vec<u32>; 3],
    next_run: u32,
) -> (Arrangement, f64) {
    let mut arranger = Arranger {
        sites,
        measured: MeasuredSites::new(sites),
        next_run,
        cut_count: 0,
        effort,
        doubt: 0.0,
        found: Arrangement::default(),
    };
    let sides = [0, 1, 2].map(|k| {
        let (from, to) = (sites.corners[k], sites.corners[(k + 1) % 3]);
        let place = |(i, change): (usize, &Change)| {
            let node = arranger.node(
                between(from, to, change.at),
                FaceNodeKind::Side {
                    side: k as u8,
                    change: i as u32,
                },
            );
            SideChange {
                at: change.at,
                node,
                next: change.next,
            }
        };
        TriangleSide {
            first: lines[k].first,
            marks: lines[k].changes.iter().enumerate().map(place).collect(),
            runs: runs[k].clone(),
        }
    });
    let corners = sites.corners;
    arranger.solve(FaceTriangle { corners, sides });
    (arranger.found, arranger.doubt)
}

struct Arranger<'a> {
    sites: &'a FaceSites,
    measured: MeasuredSites<'a>,
    next_run: u32,
    /// Number of triangles that have been cut in two.
    cut_count: u32,
    effort: Effort,
    /// Size of the largest triangle that should have been cut in two, but was divided as it is.
    doubt: f64,
    found: Arrangement,
}

impl Arranger<'_> {
    fn node(&mut self, at: Point, kind: FaceNodeKind) -> usize {
        self.found.nodes.push(FaceNode { at, kind });
        self.found.nodes.len() - 1
    }

    /// Divides a triangle, the largest of its parts first. So the parts are small once the greatest
    /// number of cuts is reached.
    fn solve(&mut self, whole: FaceTriangle) {
        let mut largest = MinHeap::default();
        largest.push(-whole.size(), 0);
        let mut parts = vec![Some(whole)];
        while let Some((_, part)) = largest.pop() {
            let Some(triangle) = parts[part].take() else {
                continue;
            };
            if !self.try_solve(&triangle) {
                self.cut_count += 1;
                for half in self.halves(&triangle) {
                    largest.push(-half.size(), parts.len());
                    parts.push(Some(half));
                }
            }
        }
    }

    /// Divides a triangle that is simple enough; `false` if it has to be cut.
    fn try_solve(&mut self, triangle: &FaceTriangle) -> bool {
        let changes = triangle.changes(&self.found.nodes);
        if changes.is_empty() {
            self.found.regions.push(Region {
                source: triangle.sides[0].first,
                border: vec![Span::Sides(triangle.corners.to_vec())],
                runs: triangle.sides.iter().map(|side| side.runs[0]).collect(),
            });
            return true;
        }
        let before = (
            self.found.nodes.len(),
            self.found.pieces.len(),
            self.found.regions.len(),
        );
        let small = SMALL * self.sites.size;
        // In a narrow triangle, a single border from one end to the other is close to its chord. If
        // several borders meet, the position of their vertex matters, so the width does not
        // suffice.
        let is_small = triangle.size() <= small || changes.len() == 2 && triangle.width() <= small;
        if self.solve_simple(triangle, &changes, is_small).is_some() {
            return true;
        }
        self.found.nodes.truncate(before.0);
        self.found.pieces.truncate(before.1);
        self.found.regions.truncate(before.2);
        if self.cut_count < self.effort.most_cuts {
            return false;
        }
        self.doubt = self.doubt.max(triangle.size());
        self.solve_simple(triangle, &changes, true).is_some()
    }

    /// Cuts a triangle in two at the middle of its longest side, so that needles become shorter.
    fn halves(&mut self, triangle: &FaceTriangle) -> [FaceTriangle; 2] {
        let FaceTriangle { corners, sides } = triangle;
        let lengths = [0, 1, 2].map(|k| norm(sub(corners[(k + 1) % 3], corners[k])));
        let mut k = 0;
        for other in [1, 2] {
            if lengths[other] > lengths[k] {
                k = other;
            }
        }
        let [a, b, c] = [k, (k + 1) % 3, (k + 2) % 3];
        let [near, far] = sides[a].halves();
        let middle = between(corners[a], corners[b], 0.5);
        let cut = self.cut(middle, corners[c], [far.first, sides[c].first]);
        [
            FaceTriangle {
                corners: [corners[a], middle, corners[c]],
                sides: [near, cut.clone(), sides[c].clone()],
            },
            FaceTriangle {
                corners: [middle, corners[b], corners[c]],
                sides: [far, sides[b].clone(), cut.reversed()],
            },
        ]
    }

    /// Cuts along a segment: adds its nodes and runs, and returns the cells along it.
    fn cut(&mut self, from: Point, to: Point, ends: [u32; 2]) -> TriangleSide {
        let line = self.sites.line(from, to, ends);
        let runs = line.cells().map(|source| {
            self.found.cuts.push(source);
            self.next_run + self.found.cuts.len() as u32 - 1
        });
        let runs = runs.collect();
        let marks = line.changes.iter().map(|change| SideChange {
            at: change.at,
            node: self.node(between(from, to, change.at), FaceNodeKind::Inside),
            next: change.next,
        });
        TriangleSide {
            first: line.first,
            marks: marks.collect(),
            runs,
        }
    }

    /// Divides a triangle that has two changes, or whose cells all meet in one point; `None` if it
    /// does not. If `is_last`, any triangle is divided, if necessary with a vertex at the mean of
    /// the changes.
    fn solve_simple(
        &mut self,
        triangle: &FaceTriangle,
        changes: &[BoundaryChange],
        is_last: bool,
    ) -> Option<()> {
        let mut changes = changes.to_vec();
        if self.effort.joins_neighbours {
            while self.join_neighbours(triangle, &mut changes) {}
        }
        if let [a, b] = &changes[..] {
            let sources = [a.before, a.next];
            let pieces = self.join(triangle, [a.node, b.node], sources, is_last)?;
            let backward = pieces.clone().rev().map(|piece| (piece, false));
            self.add_region(a, backward);
            self.add_region(b, pieces.map(|piece| (piece, true)));
            return Some(());
        }
        let at = match self.meeting(triangle, &changes) {
            Some(at) => at,
            None if is_last => centre(
                changes
                    .iter()
                    .map(|change| self.found.nodes[change.node].at),
            ),
            None => return None,
        };
        let vertex = self.node(at, FaceNodeKind::Vertex(changes.len() as u32));
        let mut arms = Vec::new();
        for change in &changes {
            let sources = [change.before, change.next];
            arms.push(self.join(triangle, [change.node, vertex], sources, is_last)?);
        }
        for (i, change) in changes.iter().enumerate() {
            let j = (i + 1) % changes.len();
            let inward = arms[j].clone().map(|piece| (piece, true));
            let outward = arms[i].clone().rev().map(|piece| (piece, false));
            self.add_region(change, inward.chain(outward));
        }
        let around = changes.iter().map(|change| change.next).collect();
        self.found.vertices.push((vertex, around));
        Some(())
    }

    /// Adds the region of the cell after `change`. `pieces` complete its border.
    fn add_region(&mut self, change: &BoundaryChange, pieces: impl Iterator<Item = (usize, bool)>) {
        let inside = pieces.map(|(piece, is_forward)| Span::Inside(piece, is_forward));
        self.found.regions.push(Region {
            source: change.next,
            border: change.border.iter().cloned().chain(inside).collect(),
            runs: change.runs.clone(),
        });
    }

    /// Looks for two consecutive changes, from one cell to another and back, in a triangle that has
    /// more. If the border between them is beyond doubt, adds the border and the region that it
    /// cuts off, and removes both changes from `changes`. Returns whether it did.
    fn join_neighbours(
        &mut self,
        triangle: &FaceTriangle,
        changes: &mut Vec<BoundaryChange>,
    ) -> bool {
        let count = changes.len();
        if count < 3 {
            return false;
        }
        for i in 0..count {
            let (j, last) = ((i + 1) % count, (i + count - 1) % count);
            let (outer, inner) = (changes[i].before, changes[i].next);
            if changes[j].next != outer {
                continue;
            }
            let nodes = [changes[i].node, changes[j].node];
            let before = (self.found.nodes.len(), self.found.pieces.len());
            let Some(pieces) = self.join(triangle, nodes, [outer, inner], false) else {
                self.found.nodes.truncate(before.0);
                self.found.pieces.truncate(before.1);
                continue;
            };
            let backward = pieces.clone().rev().map(|piece| (piece, false));
            self.add_region(&changes[i].clone(), backward);
            let BoundaryChange { border, runs, .. } = changes[j].clone();
            let along = pieces.map(|piece| Span::Inside(piece, true));
            changes[last].border.extend(along.chain(border));
            changes[last].runs.extend(runs);
            let mut number = 0..;
            changes.retain(|_| number.next().is_none_or(|k| k != i && k != j));
            return true;
        }
        false
    }

    /// The point at which all cells around a triangle meet, if these are all different and the
    /// point is beyond doubt.
    fn meeting(&self, triangle: &FaceTriangle, changes: &[BoundaryChange]) -> Option<Point> {
        let cells: Vec<u32> = changes.iter().map(|change| change.next).collect();
        let mut sorted = cells.clone();
        sorted.sort_unstable();
        if sorted.windows(2).any(|pair| pair[0] == pair[1]) {
            return None;
        }
        let nodes = changes
            .iter()
            .map(|change| self.found.nodes[change.node].at);
        let (size, start) = (triangle.size(), centre(nodes.clone()));
        let of_three = |three: [u32; 3]| {
            meeting_point(start, size, |x| {
                let nearest = self.measured.nearest(three, x);
                nearest.each.map(|site| (site.length, site.direction(x)))
            })
        };
        let do_meet = |&x: &Point| {
            let least = self.measured.distance(x);
            let slack = self.sites.rounding(least);
            let is_near =
                |&source: &u32| self.measured.nearest([source], x).each[0].length <= least + slack;
            triangle.contains(x, self.slack(triangle)) && cells.iter().all(is_near)
        };
        let first = of_three([cells[0], cells[1], cells[2]]).filter(do_meet);
        if first.is_some() || !self.effort.joins_neighbours {
            return first;
        }
        // Two of the first three cells may tie throughout a part of the triangle. Try other
        // triples, and then the points that are known.
        let count = cells.len();
        let others = (1..count).filter_map(|i| {
            let three = [0, 1, 2].map(|k| cells[(i + k) % count]);
            of_three(three)
        });
        others.chain(nodes).chain(triangle.corners).find(do_meet)
    }

    /// How far outside a triangle rounding may place a point of it.
    fn slack(&self, triangle: &FaceTriangle) -> f64 {
        SLACK * triangle.width() + FACE_SLACK * self.sites.size
    }

    /// Joins two nodes by a border with these cells on its left and on its right. Returns the
    /// indices of its pieces; `None` if the course of the border is in doubt. If `is_last`, the
    /// border is a straight line.
    fn join(
        &mut self,
        triangle: &FaceTriangle,
        [from, to]: [usize; 2],
        sources: [u32; 2],
        is_last: bool,
    ) -> Option<std::ops::Range<usize>> {
        let start = self.found.pieces.len();
        let ends = [from, to].map(|node| self.found.nodes[node].at);
        let mut parts = Vec::new();
        let is_short = norm(sub(ends[1], ends[0])) <= FACE_SLACK * self.sites.size;
        if is_short || is_last {
            parts.push(BorderPart {
                to: ends[1],
                sites: None,
            });
        } else {
            let tracer = BorderTracer {
                sites: self.sites,
                measured: &self.measured,
                triangle,
                slack: self.slack(triangle),
                sources,
                near: self.measured.room().into(),
            };
            if tracer.is_straight(ends) {
                parts.push(BorderPart {
                    to: ends[1],
                    sites: None,
                });
            } else {
                tracer.trace(ends, &mut 0, &mut parts)?;
            }
        }
        let mut node = from;
        let count = parts.len();
        for (i, part) in parts.into_iter().enumerate() {
            let next = if i + 1 == count {
                to
            } else {
                self.node(part.to, FaceNodeKind::Inside)
            };
            let curve = part
                .sites
                .map(|pair| Bisector::of(pair.map(|site| &self.sites.sites[site])));
            self.found.pieces.push(Piece {
                nodes: [node, next],
                sources,
                curve,
            });
            node = next;
        }
        Some(start..self.found.pieces.len())
    }
}

/// The mean of `points`.
fn centre(points: impl Iterator<Item = Point>) -> Point {
    let (mut sum, mut count) = ([0.0; 2], 0.0);
    for p in points {
        sum = [sum[0] + p[0], sum[1] + p[1]];
        count += 1.0;
    }
    sum.map(|s| s / count)
}
