//! Shortest paths along edges, in the place of solvers that have not landed yet.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use geobench_mesh::{Mesh, VertexId};
use geobench_window::{Counter, Probe, Propagate, Solution};

pub(crate) struct StandIn<'m>(pub(crate) &'m Mesh);

impl Propagate for StandIn<'_> {
    const COUNTERS: &'static [Counter] = &[
        Counter::Propagated,
        Counter::PeakWindows,
        Counter::StoredWindows,
        Counter::WindowBytes,
    ];

    fn mesh(&self) -> &Mesh {
        self.0
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        let mut distances = vec![f64::INFINITY; self.0.vertex_count()];
        let mut queue = BinaryHeap::new();
        probe.raise(Counter::WindowBytes, 16);
        for &source in sources {
            distances[source.index()] = 0.0;
            queue.push(Reverse((0u64, source)));
        }
        while let Some(Reverse((bits, vertex))) = queue.pop() {
            let distance = f64::from_bits(bits);
            if distance > distances[vertex.index()] {
                continue;
            }
            for (next, length) in self.0.neighbours(vertex) {
                probe.add(Counter::Propagated, 1);
                let through = distance + length;
                if through < distances[next.index()] {
                    distances[next.index()] = through;
                    queue.push(Reverse((through.to_bits(), next)));
                    probe.raise(Counter::PeakWindows, queue.len() as u64);
                    probe.add(Counter::StoredWindows, 1);
                }
            }
        }
        Solution::new(distances)
    }
}
