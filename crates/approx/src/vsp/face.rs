//! Faces with their virtual sources, and how a source enters a face.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use geobench_mesh::{HalfEdgeId, Mesh, Numbering};

/// The number of a half-edge: four times that of its face, and the corner where it starts.
pub(super) type Edge = u32;

/// The bits of a corner in an [`Edge`]. A corner of 3 in [`Face::exits`] means that no twin is
/// there.
pub(super) const CORNER: u32 = 3;

/// The exit of a half-edge at a boundary.
pub(super) const BOUNDARY: u32 = u32::MAX >> 1;

/// The flag of an exit whose half-edge starts at a saddle.
pub(super) const SADDLE: u32 = 1 << 31;

/// The largest number of faces, by the bits of an exit.
pub(super) const MOST_FACES: usize = 1 << 29;

/// The label of a face that no source has reached: an infinite distance.
pub(super) const UNREACHED: u32 = f32::INFINITY.to_bits();

/// The flag of a label whose source has not left the face yet.
pub(super) const WAITS: u32 = 1;

/// The bits of a label that are no distance.
const NO_DISTANCE: u32 = 127;

/// The label of a face: the distance of its centroid to 16 bits, then `round` modulo 16, the
/// `corner` of the half-edge where the source came in, and [`WAITS`]. Lesser labels win. Among
/// distances that agree to 16 bits the earlier of nearby rounds wins, so that rounding does not
/// send sources around a vertex again and again; in one round the corner decides, so that the order
/// of sources matters only where two come in by one half-edge. Neither NaN nor infinity is less
/// than [`UNREACHED`].
#[inline]
pub(super) const fn label(distance: f32, round: u32, corner: usize) -> u32 {
    (distance.to_bits() & !NO_DISTANCE) | (round % 16) << 3 | (corner as u32) << 1 | WAITS
}

/// The distance in a label.
#[inline]
pub(super) const fn distance_of(label: u32) -> f32 {
    f32::from_bits(label & !NO_DISTANCE)
}

/// The corner in a label.
#[inline]
pub(super) const fn corner_of(label: u32) -> usize {
    (label as usize >> 1) % 4
}

/// The corner after `corner`.
pub(super) const fn next(corner: usize) -> usize {
    [1, 2, 0][corner]
}

const fn previous(corner: usize) -> usize {
    [2, 0, 1][corner]
}

/// A virtual source: the end of a path of length `sigma`, at a place in the plane of a face.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Source {
    /// In the frame of a half-edge: its tail is the origin, its head on the x axis, the face above.
    pub(super) place: [f32; 2],
    pub(super) sigma: f32,
}

impl Source {
    /// The length of the path and the straight line on to `point`.
    #[inline]
    pub(super) fn distance(self, [x, y]: [f32; 2]) -> f32 {
        self.sigma + length(x - self.place[0], y - self.place[1])
    }
}

#[inline]
fn length(x: f32, y: f32) -> f32 {
    (x * x + y * y).sqrt()
}

/// A source that is about to enter a face through a half-edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct EnteringSource {
    pub(super) edge: Edge,
    /// The label that the face would get; set by [`Face::admit`].
    pub(super) label: u32,
    pub(super) source: Source,
}

/// A face, with lengths in mean edge lengths: one cache line.
#[derive(Debug)]
#[repr(align(64))]
pub(super) struct Face {
    /// The third corner in the frame of each half-edge.
    apexes: [[f32; 2]; 3],
    lengths: [f32; 3],
    /// The twin of each half-edge, [`BOUNDARY`], or the place of a junction with the corner 3; and
    /// [`SADDLE`].
    pub(super) exits: [u32; 3],
    label: AtomicU32,
    /// The bits of the [`Source`], in the frame of the half-edge that the label names.
    source: [AtomicU32; 3],
}

impl Face {
    /// The face of these half-edges, with lengths multiplied by `scale`. `exit` gives the exit of a
    /// half-edge without a twin.
    pub(super) fn new(
        mesh: &Mesh,
        half_edges: [HalfEdgeId; 3],
        numbering: &Numbering,
        scale: f64,
        mut exit: impl FnMut(HalfEdgeId) -> u32,
    ) -> Self {
        let scaled = |x: f64| (x * scale) as f32;
        Self {
            apexes: mesh
                .apexes(half_edges[0].face())
                .map(|apex| apex.map(scaled)),
            lengths: half_edges.map(|h| scaled(mesh.length(h))),
            exits: half_edges.map(|h| {
                let twin = mesh.twin(h).map(|twin| edge(numbering, twin));
                let saddle = if mesh.is_saddle(mesh.tail(h)) {
                    SADDLE
                } else {
                    0
                };
                twin.unwrap_or_else(|| exit(h)) | saddle
            }),
            label: AtomicU32::new(UNREACHED),
            source: [0; 3].map(AtomicU32::new),
        }
    }

    /// Forgets the source.
    pub(super) fn clear(&self) {
        self.label.store(UNREACHED, Relaxed);
    }

    /// The label, with the source that it belongs to once a round has ended.
    #[inline]
    pub(super) fn state(&self) -> (u32, Source) {
        let [x, y, sigma] = [0, 1, 2].map(|i| f32::from_bits(self.source[i].load(Relaxed)));
        let place = [x, y];
        (self.label.load(Relaxed), Source { place, sigma })
    }

    /// The distances of the three corners, each with its number.
    pub(super) fn corners(&self) -> Option<[(usize, f32); 3]> {
        let (label, source) = self.state();
        let corner = corner_of(label);
        let head = [self.lengths.get(corner).copied()?, 0.0];
        (label != UNREACHED).then(|| {
            let apex = self.apexes[corner];
            [
                (corner, source.distance([0.0; 2])),
                (next(corner), source.distance(head)),
                (previous(corner), source.distance(apex)),
            ]
        })
    }

    /// Lets `candidate` in, if it brings the least label so far. Its source bends at an end of the
    /// half-edge if the line to the aim does not cross the half-edge.
    #[inline]
    pub(super) fn admit(&self, candidate: &mut EnteringSource, round: u32, shared: bool) {
        let corner = (candidate.edge & CORNER) as usize;
        let (length_here, [x, y]) = (self.lengths[corner], self.apexes[corner]);
        let centroid = [(x + length_here) * (1.0 / 3.0), y * (1.0 / 3.0)];
        let source = &mut candidate.source;
        let [px, py] = source.place;
        let bend = if py > 0.0 {
            // The source lies on the side of the face: its path has turned around one end.
            let by_tail = length(px, py) + length(centroid[0], centroid[1]);
            let to_head = length(px - length_here, py);
            let by_head = to_head + length(centroid[0] - length_here, centroid[1]);
            Some(by_tail < by_head)
        } else {
            let aim = |end: usize| {
                let t = slack(self.exits[end] & SADDLE != 0, y < FLAT * length_here);
                [x + t * (centroid[0] - x), y + t * (centroid[1] - y)]
            };
            let tail_side = aim(corner);
            let head_side = aim(next(corner));
            if px * tail_side[1] < tail_side[0] * py {
                Some(true)
            } else if (length_here - px) * head_side[1] < (length_here - head_side[0]) * py {
                Some(false)
            } else {
                None
            }
        };
        if let Some(at_tail) = bend {
            let end = if at_tail { 0.0 } else { length_here };
            source.sigma = source.distance([end, 0.0]);
            source.place = [end, 0.0];
        }
        candidate.label = label(source.distance(centroid), round, corner);
        lower(&self.label, candidate.label, shared);
    }

    /// Takes the source of `candidate` if its label has won: true at most once for a label, unless
    /// the distance is not below `bound`. Then the source waits in the face, and the last candidate
    /// with the label stays; threads must not settle equal labels at the same time.
    #[inline]
    pub(super) fn settle(&self, candidate: &EnteringSource, bound: f32, shared: bool) -> bool {
        let label = candidate.label;
        if self.label.load(Relaxed) != label {
            return false;
        }
        if distance_of(label) < bound {
            if !shared {
                self.label.store(label & !WAITS, Relaxed);
            } else if self
                .label
                .compare_exchange(label, label & !WAITS, Relaxed, Relaxed)
                .is_err()
            {
                return false;
            }
        }
        let Source { place, sigma } = candidate.source;
        for (kept, x) in self.source.iter().zip([place[0], place[1], sigma]) {
            kept.store(x.to_bits(), Relaxed);
        }
        true
    }

    /// Ends the wait of the source, and returns it with its corner if it was waiting.
    #[inline]
    pub(super) fn wake(&self) -> Option<(usize, Source)> {
        let label = self.label.fetch_and(!WAITS, Relaxed);
        (label & WAITS != 0).then(|| (corner_of(label), self.state().1))
    }

    /// The exits of a `source` that came in at `corner`, with the source in the frames of their
    /// twins.
    #[inline]
    pub(super) fn leave(&self, corner: usize, source: Source) -> [(u32, Source); 2] {
        let [x, y] = self.apexes[corner];
        let [px, py] = source.place;
        let [left, right] = [previous(corner), next(corner)];
        let turned = |[ux, uy]: [f32; 2], [px, py]: [f32; 2]| Source {
            place: [ux * px + uy * py, ux * py - uy * px],
            ..source
        };
        let [a, b] = [left, right].map(|k| 1.0 / self.lengths[k]);
        let along_right = [(self.lengths[corner] - x) * b, -y * b];
        [
            (self.exits[left], turned([x * a, y * a], [px, py])),
            (self.exits[right], turned(along_right, [px - x, py - y])),
        ]
    }

    /// The length of the half-edge of `corner`.
    pub(super) const fn length(&self, corner: usize) -> f32 {
        self.lengths[corner]
    }
}

/// A face with a height below this part of a half-edge is flat, seen from there.
const FLAT: f32 = 0.5;

/// Where between the third corner (0) and the centroid (1) of a face the aim of a source is, for
/// one end of the half-edge. Beside a saddle paths bend, so a line that just misses the half-edge
/// is too short. Elsewhere the source goes on straight, since the surface on the other side of the
/// vertex sends a better one soon. Fitted on scans, terrains and tori; the docs have the errors.
const fn slack(saddle: bool, flat: bool) -> f32 {
    match (saddle, flat) {
        (true, false) => 0.9,
        (true, true) => 0.6,
        (false, _) => 1.3,
    }
}

/// The number of a half-edge of the mesh.
pub(super) fn edge(numbering: &Numbering, h: HalfEdgeId) -> Edge {
    numbering.new_face(h.face()).raw() << 2 | h.corner()
}

/// Sets `kept` to `value` if that is less.
#[inline]
pub(super) fn lower(kept: &AtomicU32, value: u32, shared: bool) {
    if value < kept.load(Relaxed) {
        if shared {
            kept.fetch_min(value, Relaxed);
        } else {
            kept.store(value, Relaxed);
        }
    }
}
