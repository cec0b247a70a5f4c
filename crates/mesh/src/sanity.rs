//! The invariants of a mesh, as a check for tests and fuzzers.

use std::f64::consts::PI;

use crate::ids::{HalfEdgeId, VertexId};
use crate::mesh::Mesh;

impl Mesh {
    /// Checks the invariants of the mesh, in linear time: its arrays, twins, lengths and fans. What
    /// is derived from the lengths for needles and slivers is not computed again.
    ///
    /// # Errors
    ///
    /// The first invariant that does not hold. This is a bug of this crate, not a defect of a
    /// model.
    pub fn sanity_check(&self) -> Result<(), String> {
        self.check_array_lengths()?;
        for h in self.half_edges() {
            self.check_half_edge(h)?;
        }
        for v in self.vertices() {
            self.check_vertex(v)?;
        }
        Ok(())
    }

    fn check_array_lengths(&self) -> Result<(), String> {
        let (vertices, half_edges) = (self.vertex_count(), self.half_edge_count());
        let data = &*self.data;
        let positions = if data.positions.is_empty() {
            0
        } else {
            vertices
        };
        let rows = data.outgoing_rows.ranges();
        let of_rows: usize = rows.map(|row| row.len()).sum();
        for (array, found, expected) in [
            ("positions", data.positions.len(), positions),
            ("tails", half_edges, 3 * self.face_count()),
            ("twins", data.twins.len(), half_edges),
            ("lengths", data.lengths.len(), half_edges),
            ("outgoing_rows", data.outgoing_rows.ranges().len(), vertices),
            ("outgoing of all vertices", of_rows, half_edges),
            ("total_angles", data.total_angles.len(), vertices),
        ] {
            if found != expected {
                return Err(format!(
                    "array `{array}` has {found} entries, not {expected}"
                ));
            }
        }
        Ok(())
    }

    fn check_half_edge(&self, h: HalfEdgeId) -> Result<(), String> {
        let (tail, head) = (self.tail(h), self.head(h));
        if tail == head || tail.index() >= self.vertex_count() {
            return Err(format!("{h:?} does not join two vertices"));
        }
        let length = self.length(h);
        let not_its_length =
            || format!("the length {length:e} of {h:?} is not positive, or not that of its twin");
        if !(length > 0.0 && length.is_finite()) {
            return Err(not_its_length());
        }
        if let Some(twin) = self.twin(h) {
            if twin.index() >= self.half_edge_count()
                || self.twin(twin) != Some(h)
                || (self.tail(twin), self.head(twin)) != (head, tail)
            {
                return Err(format!(
                    "{h:?} and its twin do not run along the same edge in opposite directions"
                ));
            }
            if self.length(twin).to_bits() != length.to_bits() {
                return Err(not_its_length());
            }
        }
        let junction = self.junction(h);
        let joins = |&other: &HalfEdgeId| {
            let ends = [self.tail(other), self.head(other)];
            ends == [tail, head] || ends == [head, tail]
        };
        let is_pair = match *junction {
            [a, b] => self.tail(a) != self.tail(b),
            [_] => true,
            _ => false,
        };
        let is_none = junction.is_empty();
        if is_pair || !is_none && (self.twin(h).is_some() || !junction.contains(&h)) {
            return Err(format!("{h:?} is along no junction"));
        }
        if !(junction.iter().all(joins) && junction.is_sorted_by(|a, b| a < b)) {
            return Err(format!("the junction of {h:?} is no edge"));
        }
        if junction
            .iter()
            .any(|&other| self.length(other).to_bits() != length.to_bits())
        {
            return Err(not_its_length());
        }
        let [x, y] = self.apex(h);
        let from_tail = self.length(h.prev());
        // The error of an apex computed from lengths is their error times the slenderness.
        let tolerance = 1e-11 * from_tail * (from_tail / length).max(1.0);
        let fits = (libm::hypot(x, y) - from_tail).abs() <= tolerance;
        if !(y > 0.0 && y.is_finite() && fits) {
            return Err(format!(
                "the apex {:?} over {h:?} does not fit its lengths",
                [x, y]
            ));
        }
        Ok(())
    }

    fn check_vertex(&self, v: VertexId) -> Result<(), String> {
        let not_its_fans = || format!("the half-edges around {v:?} are not its fans");
        let outgoing = self.outgoing(v);
        let mut sorted = outgoing.to_vec();
        sorted.sort_unstable();
        sorted.dedup();
        if sorted.len() != outgoing.len() || outgoing.iter().any(|&h| self.tail(h) != v) {
            return Err(not_its_fans());
        }
        let (mut boundary, mut saddle, mut fans, mut total) = (false, false, 0, 0.0);
        let mut rest = outgoing;
        while let Some(&first) = rest.first() {
            let follows = |pair: &[HalfEdgeId]| self.twin(pair[0].prev()) == Some(pair[1]);
            let size = 1 + rest.windows(2).take_while(|pair| follows(pair)).count();
            let (fan, others) = rest.split_at(size);
            rest = others;
            // A fan is complete if it returns to its start, or begins and ends at the boundary.
            let (start, end) = (self.twin(first), self.twin(fan[size - 1].prev()));
            if end.map_or(start.is_some(), |next| next != first) {
                return Err(not_its_fans());
            }
            let angle: f64 = fan.iter().map(|&h| self.corner_angle(h)).sum();
            let straight = if start.is_none() { PI } else { 2.0 * PI };
            boundary |= start.is_none()
                && [first, fan[size - 1].prev()]
                    .iter()
                    .any(|&end| self.is_boundary_edge(end));
            saddle |= angle > straight + 1e-8;
            total += angle;
            fans += 1;
        }
        let flags = (self.is_boundary(v), self.is_saddle(v), self.is_pinched(v));
        let angle_fits = (self.total_angle(v) - total).abs() <= 1e-9 * total;
        if flags != (boundary, saddle, fans > 1) || !angle_fits {
            return Err(format!("the angle or flags of {v:?} do not fit its faces"));
        }
        Ok(())
    }
}
