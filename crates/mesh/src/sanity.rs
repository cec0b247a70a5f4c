//! The promises a mesh makes to solvers, as a check for tests and fuzzers.

use std::f64::consts::PI;

use crate::ids::{HalfEdgeId, VertexId};
use crate::mesh::Mesh;

/// A promise that a mesh does not keep: a bug of this crate, never of a model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BrokenInvariant {
    /// An array does not have one entry for each element.
    #[error("array `{array}` has {found} entries, not {expected}")]
    ArrayLength {
        /// Name of the array.
        array: &'static str,
        /// Its number of entries.
        found: usize,
        /// The number of elements.
        expected: usize,
    },
    /// A half-edge starts at a vertex that does not exist, or ends where it starts.
    #[error("{0:?} does not join two vertices")]
    Ends(HalfEdgeId),
    /// A half-edge is not the twin of its twin, or does not run the opposite way.
    #[error("{0:?} and its twin do not run along the same edge in opposite directions")]
    Twin(HalfEdgeId),
    /// A length is not positive and finite, or not that of the twin.
    #[error("the length {1:e} of {0:?} is not positive, or not that of its twin")]
    Length(HalfEdgeId, f64),
    /// An apex is not above its half-edge, or not as far from its tail as the length says.
    #[error("the apex {1:?} over {0:?} does not fit its lengths")]
    Apex(HalfEdgeId, [f64; 2]),
    /// The half-edges around a vertex are not all that start there, fan after fan and
    /// counter-clockwise.
    #[error("the half-edges around {0:?} are not its fans")]
    Fans(VertexId),
    /// A flag or angle of a vertex is not what its faces say.
    #[error("the angle or flags of {0:?} do not fit its faces")]
    VertexData(VertexId),
}

impl Mesh {
    /// Checks everything a mesh promises about itself, in linear time.
    ///
    /// # Errors
    ///
    /// The first promise that is not kept, which is a bug of this crate.
    pub fn sanity_check(&self) -> Result<(), BrokenInvariant> {
        self.check_array_lengths()?;
        for h in self.half_edges() {
            self.check_half_edge(h)?;
        }
        for v in self.vertices() {
            self.check_vertex(v)?;
        }
        Ok(())
    }

    fn check_array_lengths(&self) -> Result<(), BrokenInvariant> {
        let (vertices, half_edges) = (self.vertex_count(), self.half_edge_count());
        let data = &*self.data;
        let positions = if data.positions.is_empty() {
            0
        } else {
            vertices
        };
        let out_ends = data.outgoing_starts.last().map_or(0, |&end| end as usize);
        for (array, found, expected) in [
            ("positions", data.positions.len(), positions),
            ("tails", half_edges, 3 * self.face_count()),
            ("twins", data.twins.len(), half_edges),
            ("lengths", data.lengths.len(), half_edges),
            ("outgoing_starts", data.outgoing_starts.len(), vertices + 1),
            ("outgoing", data.outgoing.len(), half_edges),
            ("outgoing of all vertices", out_ends, half_edges),
            ("total_angles", data.total_angles.len(), vertices),
        ] {
            if found != expected {
                return Err(BrokenInvariant::ArrayLength {
                    array,
                    found,
                    expected,
                });
            }
        }
        Ok(())
    }

    fn check_half_edge(&self, h: HalfEdgeId) -> Result<(), BrokenInvariant> {
        let (tail, head) = (self.tail(h), self.head(h));
        if tail == head || tail.index() >= self.vertex_count() {
            return Err(BrokenInvariant::Ends(h));
        }
        let length = self.length(h);
        if !(length > 0.0 && length.is_finite()) {
            return Err(BrokenInvariant::Length(h, length));
        }
        if let Some(twin) = self.twin(h) {
            if twin.index() >= self.half_edge_count()
                || self.twin(twin) != Some(h)
                || (self.tail(twin), self.head(twin)) != (head, tail)
            {
                return Err(BrokenInvariant::Twin(h));
            }
            if self.length(twin).to_bits() != length.to_bits() {
                return Err(BrokenInvariant::Length(h, length));
            }
        }
        let [x, y] = self.apex(h);
        let from_tail = self.length(h.prev());
        // An apex known by lengths alone is uncertain by their errors times the slenderness.
        let tolerance = 1e-11 * from_tail * (from_tail / length).max(1.0);
        let fits = (libm::hypot(x, y) - from_tail).abs() <= tolerance;
        if !(y > 0.0 && y.is_finite() && fits) {
            return Err(BrokenInvariant::Apex(h, [x, y]));
        }
        Ok(())
    }

    fn check_vertex(&self, v: VertexId) -> Result<(), BrokenInvariant> {
        let outgoing = self.outgoing(v);
        let mut sorted = outgoing.to_vec();
        sorted.sort_unstable();
        sorted.dedup();
        if sorted.len() != outgoing.len() || outgoing.iter().any(|&h| self.tail(h) != v) {
            return Err(BrokenInvariant::Fans(v));
        }
        let (mut boundary, mut saddle, mut fans, mut total) = (false, false, 0, 0.0);
        let mut rest = outgoing;
        while let Some(&first) = rest.first() {
            let follows = |pair: &[HalfEdgeId]| self.twin(pair[0].prev()) == Some(pair[1]);
            let size = 1 + rest.windows(2).take_while(|pair| follows(pair)).count();
            let (fan, others) = rest.split_at(size);
            rest = others;
            // A fan is whole if it comes back to its start, or begins and ends at the boundary.
            let (start, end) = (self.twin(first), self.twin(fan[size - 1].prev()));
            if end.map_or(start.is_some(), |next| next != first) {
                return Err(BrokenInvariant::Fans(v));
            }
            let corner = |h: &HalfEdgeId| {
                let [x, y] = self.apex(*h);
                libm::atan2(y, x)
            };
            let angle: f64 = fan.iter().map(corner).sum();
            let straight = if start.is_none() { PI } else { 2.0 * PI };
            boundary |= start.is_none();
            saddle |= angle > straight + 1e-8;
            total += angle;
            fans += 1;
        }
        let flags = (self.is_boundary(v), self.is_saddle(v), self.is_pinched(v));
        let angle_fits = (self.total_angle(v) - total).abs() <= 1e-9 * total;
        if flags != (boundary, saddle, fans > 1) || !angle_fits {
            return Err(BrokenInvariant::VertexData(v));
        }
        Ok(())
    }
}
