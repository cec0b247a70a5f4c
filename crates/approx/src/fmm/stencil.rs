//! The triangles through which a front arrives, unfolded at obtuse corners.

use geobench_mesh::vector::{cross_2d, dot, sub};
use geobench_mesh::{HalfEdgeId, Mesh, VertexId};

use crate::attached::PointInFace;

/// Most faces that are unfolded for an obtuse corner.
const MOST_UNFOLDED: usize = 100;

/// A triangle through whose base a front reaches its apex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stencil {
    pub(super) base: [VertexId; 2],
    pub(super) apex: VertexId,
    /// Length of the base.
    length: f64,
    /// The apex, in a frame with the base on the x-axis and its first end at 0.
    position: [f64; 2],
    /// Distances of the apex from the ends of the base.
    pub(super) sides: [f64; 2],
}

impl Stencil {
    /// The parts of a face that a point in it splits; the point, with the number `apex`, is the
    /// apex of each.
    pub(super) fn of_parts(point: &PointInFace, apex: VertexId) -> [Self; 3] {
        let sides = point.corner_distances();
        [0, 1, 2].map(|k| {
            let next = (k + 1) % 3;
            Self {
                base: [point.corners[k], point.corners[next]],
                apex,
                length: point.sides[k],
                position: point.places[k],
                sides: [sides[k], sides[next]],
            }
        })
    }

    /// The distance of the apex, given those of the ends of the base.
    ///
    /// It is the least sum, over all points of the base, of the point's distance (interpolated
    /// linearly) and the straight way from the point to the apex.
    #[inline]
    pub(super) fn arrival(&self, ends: [f64; 2]) -> f64 {
        let [x, y] = self.position;
        let along = (ends[0] + self.sides[0]).min(ends[1] + self.sides[1]);
        // The gradient of the front has length 1, and its component along the base is known.
        let slope = (ends[1] - ends[0]) / self.length;
        if slope.abs() >= 1.0 {
            return along;
        }
        let rise = ((1.0 - slope) * (1.0 + slope)).sqrt();
        // The abscissa at which the ray to the apex crosses the base, times `rise`.
        let entry = x * rise - y * slope;
        if entry > 0.0 && entry < self.length * rise {
            along.min(ends[0] + slope * x + rise * y)
        } else {
            along
        }
    }
}

/// All stencils of a mesh, by the vertices of their bases.
#[derive(Clone, Debug)]
pub(super) struct Stencils {
    all: Vec<Stencil>,
    /// The start of the list of each vertex in `of`.
    starts: Vec<u32>,
    /// For each vertex, the stencils with the vertex in their base.
    of: Vec<u32>,
}

impl Stencils {
    pub(super) fn new(mesh: &Mesh, unfold: bool) -> Self {
        let mut all = Vec::with_capacity(mesh.half_edge_count());
        for face in mesh.faces() {
            let apexes = mesh.apexes(face);
            for (corner, position) in (0..).zip(apexes) {
                let h = face.half_edge(corner);
                let corner = Corner {
                    h,
                    length: mesh.length(h),
                    position,
                };
                let split = unfold.then(|| corner.split(mesh)).flatten();
                match split {
                    Some(two) => all.extend(two),
                    None => all.push(corner.stencil(mesh)),
                }
            }
        }
        let mut starts = vec![0; mesh.vertex_count() + 1];
        for v in all.iter().flat_map(|stencil| stencil.base) {
            starts[v.index() + 1] += 1;
        }
        for i in 0..mesh.vertex_count() {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut of = vec![0; 2 * all.len()];
        for (i, stencil) in (0..).zip(&all) {
            for v in stencil.base {
                let place = &mut next[v.index()];
                of[*place as usize] = i;
                *place += 1;
            }
        }
        Self { all, starts, of }
    }

    /// The stencils with `v` in their base.
    #[inline]
    pub(super) fn with_base(&self, v: VertexId) -> impl Iterator<Item = &Stencil> {
        let places = self.starts[v.index()] as usize..self.starts[v.index() + 1] as usize;
        self.of[places].iter().map(|&i| &self.all[i as usize])
    }
}

/// A corner of a face, opposite to `h`.
struct Corner {
    h: HalfEdgeId,
    length: f64,
    /// The position of the corner in the frame of `h`.
    position: [f64; 2],
}

impl Corner {
    fn stencil(&self, mesh: &Mesh) -> Stencil {
        Stencil {
            base: [mesh.tail(self.h), mesh.head(self.h)],
            apex: mesh.apex_vertex(self.h),
            length: self.length,
            position: self.position,
            sides: [mesh.length(self.h.prev()), mesh.length(self.h.next())],
        }
    }

    /// Two acute triangles with a vertex found beyond `h`; `None` if the corner is acute or there
    /// is no such vertex.
    fn split(&self, mesh: &Mesh) -> Option<[Stencil; 2]> {
        let apex = self.position;
        let ends = [[0.0; 2], [self.length, 0.0]];
        let [to_tail, to_head] = ends.map(|end| sub(end, apex));
        if dot(to_tail, to_head) >= 0.0 {
            return None;
        }
        // The edge to cross next, with its ends. The front to the corner arrives between the
        // perpendiculars to its sides, which all cross this edge.
        let mut crossed = self.h;
        let [mut tail, mut head] = [ends[1], ends[0]];
        for _ in 0..MOST_UNFOLDED {
            let g = mesh.twin(crossed)?;
            let v = mesh.apex_vertex(g);
            if v == mesh.apex_vertex(self.h) {
                return None;
            }
            let place = unfolded(tail, head, mesh.apex(g), mesh.length(g));
            let ray = sub(place, apex);
            if dot(ray, to_tail) <= 0.0 {
                crossed = g.next();
                tail = place;
            } else if dot(ray, to_head) <= 0.0 {
                crossed = g.prev();
                head = place;
            } else {
                let whole = self.stencil(mesh);
                let reach = length(ray);
                let [a, b] = whole.base;
                let part = |base, from, to, sides| {
                    let (length, position) = in_frame(from, to, apex)?;
                    Some(Stencil {
                        base,
                        apex: whole.apex,
                        length,
                        position,
                        sides,
                    })
                };
                return Some([
                    part([a, v], ends[0], place, [whole.sides[0], reach])?,
                    part([v, b], place, ends[1], [reach, whole.sides[1]])?,
                ]);
            }
        }
        None
    }
}

/// The apex of a face to the left of the edge from `tail` to `head`. `length` is the length of the
/// edge, and `apex` the position of the apex in its frame.
fn unfolded(tail: [f64; 2], head: [f64; 2], apex: [f64; 2], length: f64) -> [f64; 2] {
    let along = sub(head, tail).map(|x| x / length);
    [
        tail[0] + along[0] * apex[0] - along[1] * apex[1],
        tail[1] + along[1] * apex[0] + along[0] * apex[1],
    ]
}

/// Length of the base, and position of `apex` in its frame; `None` if the base has no length.
fn in_frame(from: [f64; 2], to: [f64; 2], apex: [f64; 2]) -> Option<(f64, [f64; 2])> {
    let base = sub(to, from);
    let length = length(base);
    let along = base.map(|x| x / length);
    let to_apex = sub(apex, from);
    let position = [dot(to_apex, along), cross_2d(along, to_apex)];
    let is_usable = length > 0.0 && position.iter().all(|x| x.is_finite());
    is_usable.then_some((length, [position[0], position[1].abs()]))
}

fn length(a: [f64; 2]) -> f64 {
    a[0].hypot(a[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flat strip: an obtuse corner at vertex 0 over the edge from 1 to 2, and vertex 3 below it.
    fn strip(below: [f64; 3]) -> Mesh {
        let positions = vec![[0.0, 0.5, 0.0], [-2.0, 0.0, 0.0], [2.0, 0.0, 0.0], below];
        Mesh::new(positions, vec![[1, 2, 0], [2, 1, 3]]).unwrap()
    }

    #[test]
    fn an_obtuse_corner_is_split_by_the_vertex_that_sees_it() {
        let stencils = Stencils::new(&strip([0.1, -1.0, 0.0]), true);
        // Each of the two faces has one obtuse corner, which is split by the apex of the other
        // face.
        assert_eq!(stencils.all.len(), 8);
        let split: Vec<_> = stencils
            .all
            .iter()
            .filter(|s| s.apex == VertexId::new(0) && s.base.contains(&VertexId::new(3)))
            .collect();
        assert_eq!(split.len(), 2);
        for stencil in split {
            let place = usize::from(stencil.base[1] == VertexId::new(3));
            assert!((stencil.sides[place] - 0.1_f64.hypot(1.5)).abs() < 1e-15);
            // The frame agrees with the sides.
            let [x, y] = stencil.position;
            assert!((x.hypot(y) - stencil.sides[0]).abs() < 1e-14);
            assert!(((x - stencil.length).hypot(y) - stencil.sides[1]).abs() < 1e-14);
        }
    }

    #[test]
    fn a_corner_stays_obtuse_where_the_surface_ends() {
        let stencils = Stencils::new(&strip([5.0, -0.1, 0.0]), true);
        assert!(
            stencils
                .all
                .iter()
                .all(|s| { s.apex != VertexId::new(0) || !s.base.contains(&VertexId::new(3)) })
        );
    }

    #[test]
    fn a_straight_front_arrives_on_time() {
        let stencils = Stencils::new(&strip([0.1, -1.0, 0.0]), false);
        let stencil = stencils
            .all
            .iter()
            .find(|s| s.apex == VertexId::new(0))
            .unwrap();
        // Parallel to the base, and from its first end.
        assert_eq!(stencil.arrival([3.0, 3.0]), 3.5);
        assert_eq!(stencil.arrival([1.0, 5.0]), 1.0 + stencil.sides[0]);
        // A front at an angle whose sine is 0.1.
        let rise = 0.99_f64.sqrt();
        assert!((stencil.arrival([1.0, 1.4]) - (1.2 + 0.5 * rise)).abs() < 1e-15);
    }
}
