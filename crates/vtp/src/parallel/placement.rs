//! The regions of the surface in which threads work.

use std::sync::atomic::AtomicU32;
use std::sync::atomic::Ordering::Relaxed;

use geobench_mesh::{Mesh, Numbering, VertexId};

use super::padded::Padded;
use crate::engine::layout::{MeshLayout, parts};

/// A position. Single precision suffices to compare distances.
type Position = [f32; 3];

/// The positions of vertices, and the centre of the region of each thread.
///
/// Compact regions have few half-edges on which two threads have windows, and windows that travel
/// away from the source stay close to each other. So a thread hands off vertices on the side of the
/// receiver.
#[derive(Debug)]
pub(super) struct Placement {
    positions: Vec<Position>,
    centers: Vec<Padded<Center>>,
}

impl Placement {
    /// The placement for the vertices of `mesh`, by their new numbers. Without positions, vertices
    /// with close numbers count as close.
    pub(super) fn new(mesh: &Mesh, numbering: &Numbering, threads: usize) -> Self {
        let positions = mesh.positions();
        // Positions are shifted and scaled so that single precision distinguishes vertices wherever
        // the model is and however large it is. Vertices without faces may be anywhere, so they do
        // not count.
        let on_faces = mesh.vertices().filter(|&v| !mesh.outgoing(v).is_empty());
        let mut places = on_faces.filter_map(|v| positions.get(v.index())).peekable();
        let origin = places.peek().copied().copied().unwrap_or_default();
        let coordinates = places.flat_map(|p| [0, 1, 2].map(|i| p[i] - origin[i]));
        let size = coordinates.fold(f64::MIN_POSITIVE, |size, x| size.max(x.abs()));
        let position = |v: VertexId| match positions.get(numbering.old_vertex(v).index()) {
            Some(p) => [0, 1, 2].map(|i| ((p[i] - origin[i]) / size) as f32),
            None => [v.raw() as f32, 0.0, 0.0],
        };
        Self {
            positions: mesh.vertices().map(position).collect(),
            centers: (0..threads).map(|_| Padded::default()).collect(),
        }
    }

    /// Follows a change of the mesh, of which `layout` is the layout now. An added vertex counts as
    /// being where the lowest neighbour is; it has one that is no added one, or is beside one.
    pub(super) fn splice(&mut self, layout: &MeshLayout) {
        let known = self.positions.len().min(layout.vertices.len());
        self.positions.truncate(known);
        for v in known..layout.vertices.len() {
            let faces = layout.ring(v as u32).iter().map(|&h| parts(h).0);
            let around = faces.flat_map(|f| layout.faces[f].vertex);
            let lowest = around.min().unwrap_or(0) as usize;
            let position = self.positions.get(lowest).copied();
            self.positions.push(position.unwrap_or_default());
        }
    }

    /// Clears the regions of all threads.
    pub(super) fn reset(&mut self) {
        self.centers.fill_with(Padded::default);
    }

    /// Sets the region of a thread to the centre of `vertices`, if there are any.
    pub(super) fn come_to(&self, thread: usize, vertices: &[u32]) {
        if let Some(center) = self.center(vertices.iter().copied()) {
            self.centers[thread].0.set(center);
        }
    }

    /// About `share` of `vertices`, but not all: those farthest on the side of thread `to`,
    /// farthest first. If that thread has no region yet, or its centre is the same, those at one
    /// end of the longest axis. O(m + n log n) for n of m vertices.
    pub(super) fn on_the_side_of<'a>(
        &self,
        to: usize,
        vertices: impl Iterator<Item = u32>,
        share: f64,
        buffer: &'a mut Vec<Candidate>,
    ) -> &'a [Candidate] {
        buffer.clear();
        buffer.extend(vertices.map(|vertex| Candidate { vertex, along: 0.0 }));
        let Some(middle) = self.center(buffer.iter().map(|c| c.vertex)) else {
            return &[];
        };
        let from_middle = |v: u32| difference(self.positions[v as usize], middle);
        let side = self.centers[to]
            .0
            .get()
            .map(|other| difference(other, middle));
        let axis = side
            .filter(|side| *side != Position::default())
            .unwrap_or_else(|| longest_axis(buffer.iter().map(|c| from_middle(c.vertex))));
        for candidate in &mut *buffer {
            candidate.along = dot(from_middle(candidate.vertex), axis);
        }
        let all = buffer.len();
        #[allow(clippy::cast_sign_loss)] // No share is negative.
        let count = ((share * all as f64).ceil() as usize).min(all - 1);
        let farthest_first = |a: &Candidate, b: &Candidate| b.along.total_cmp(&a.along);
        buffer.select_nth_unstable_by(count, farthest_first);
        let given = &mut buffer[..count];
        given.sort_unstable_by(farthest_first);
        given
    }

    fn center(&self, vertices: impl Iterator<Item = u32>) -> Option<Position> {
        let (mut sum, mut count) = (Position::default(), 0.0);
        for v in vertices {
            let position = self.positions[v as usize];
            sum = [0, 1, 2].map(|i| sum[i] + position[i]);
            count += 1.0;
        }
        (count > 0.0).then(|| sum.map(|x| x / count))
    }
}

/// A vertex that may be handed off.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) vertex: u32,
    /// Its position in the direction of a possible receiver.
    along: f32,
}

/// The centre of the vertices that a thread processed last; NaN if there were none.
#[derive(Debug)]
struct Center([AtomicU32; 3]);

impl Default for Center {
    fn default() -> Self {
        Self([0; 3].map(|_| AtomicU32::new(f32::NAN.to_bits())))
    }
}

impl Center {
    /// Not atomic as a whole: other threads may see some of the coordinates before the others.
    fn set(&self, position: Position) {
        for (to, x) in self.0.iter().zip(position) {
            to.store(x.to_bits(), Relaxed);
        }
    }

    fn get(&self) -> Option<Position> {
        let position = self.0.each_ref().map(|x| f32::from_bits(x.load(Relaxed)));
        position.iter().all(|x| !x.is_nan()).then_some(position)
    }
}

fn difference(a: Position, b: Position) -> Position {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn dot(a: Position, b: Position) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The coordinate axis with the greatest mean square of the positions.
fn longest_axis(places: impl Iterator<Item = Position>) -> Position {
    let mut sums = Position::default();
    for place in places {
        sums = [0, 1, 2].map(|i| sums[i] + place[i] * place[i]);
    }
    let mut axis = Position::default();
    let longest = (0..3).max_by(|&a, &b| sums[a].total_cmp(&sums[b]));
    axis[longest.unwrap_or(0)] = 1.0;
    axis
}

#[cfg(test)]
mod tests {
    use super::*;
    use geobench_mesh::TriangleSoup;
    use geobench_mesh::generate::generate;

    /// A plane of 5 × 5 vertices, numbered by rows.
    fn plane() -> TriangleSoup {
        generate(&"gen:grid,n=4".parse().unwrap()).unwrap()
    }

    fn placement(soup: TriangleSoup) -> Placement {
        let (mesh, _) = Mesh::from_soup(soup).unwrap();
        Placement::new(&mesh, &Numbering::same(), 3)
    }

    fn given(placement: &Placement, to: usize, vertices: &[u32], share: f64) -> Vec<u32> {
        let mut buffer = Vec::new();
        let vertices = vertices.iter().copied();
        let given = placement.on_the_side_of(to, vertices, share, &mut buffer);
        given.iter().map(|c| c.vertex).collect()
    }

    #[test]
    fn vertices_on_the_side_of_another_thread_are_given_first() {
        for (scale, shift) in [(1.0, 0.0), (1.0, 1e9), (1e50, 0.0), (1e-50, 0.0)] {
            let mut soup = plane();
            for position in &mut soup.positions {
                *position = position.map(|x| x * scale + shift);
            }
            let mut placement = placement(soup);
            let row = [10, 12, 14, 11, 13];
            placement.come_to(1, &[15, 20]);
            placement.come_to(2, &[19, 24]);
            assert_eq!(given(&placement, 1, &row, 0.6), [10, 11, 12]);
            assert_eq!(given(&placement, 2, &row, 0.5), [14, 13, 12]);
            placement.come_to(2, &[]);
            assert_eq!(given(&placement, 2, &row, 0.01), [14]);
            assert_eq!(given(&placement, 2, &row, 1.0), [14, 13, 12, 11]);
            placement.reset();
            // No thread has a region: one end of the longer side.
            let vertices = [10, 11, 12, 13, 14, 17];
            assert_eq!(given(&placement, 1, &vertices, 0.2), [14, 13]);
            placement.come_to(1, &[12]);
            assert_eq!(given(&placement, 1, &row, 0.4), [14, 13]);
        }
    }

    #[test]
    fn vertices_without_faces_do_not_count_wherever_they_lie() {
        for stray in [1e30, -1e308, f64::MAX] {
            let mut soup = plane();
            for position in &mut soup.positions {
                *position = position.map(|x| x + 1e9);
            }
            // The first vertex and the last one.
            soup.positions.insert(0, [stray; 3]);
            soup.positions.push([0.0; 3]);
            for corner in soup.triangles.iter_mut().flatten() {
                *corner += 1;
            }
            let placement = placement(soup);
            placement.come_to(1, &[16, 21]);
            assert_eq!(given(&placement, 1, &[13, 12, 11], 0.6), [11, 12]);
        }
    }

    #[test]
    fn of_a_single_vertex_or_of_none_nothing_is_given() {
        let placement = placement(plane());
        for (vertices, share) in [(vec![], 1.0), (vec![3], 1.0), (vec![3, 4], 0.0)] {
            assert_eq!(given(&placement, 1, &vertices, share), [0; 0]);
        }
    }

    #[test]
    fn without_positions_neighbours_in_number_lie_together() {
        let strip: Vec<[u32; 3]> = (0..6).map(|i| [i, i + 1, i + 2]).collect();
        let oriented: Vec<_> = strip
            .iter()
            .map(|&[a, b, c]| if a % 2 == 0 { [a, b, c] } else { [b, a, c] })
            .collect();
        let (mesh, _) = Mesh::from_lengths(8, &oriented, &[[1.0; 3]; 6]).unwrap();
        let placement = Placement::new(&mesh, &Numbering::same(), 2);
        placement.come_to(1, &[6, 7]);
        assert_eq!(given(&placement, 1, &[2, 5, 3, 4], 0.5), [5, 4]);
    }
}
