//! Farthest point sampling: each site is the vertex that is farthest from the sites before it.

use geobench_mesh::{Mesh, SplitMix64, VertexId};
use geobench_vtp::VtpFast;
use geobench_window::{Goal, SolveError, Solver};

/// Sites, and the distance of every vertex from the nearest of them.
pub(super) struct Sampler<'a> {
    mesh: &'a Mesh,
    solver: VtpFast,
    nearest: Vec<f64>,
    sites: Vec<VertexId>,
}

impl<'a> Sampler<'a> {
    pub(super) fn new(mesh: &'a Mesh) -> Self {
        Self {
            mesh,
            solver: VtpFast::new(mesh),
            nearest: vec![f64::INFINITY; mesh.vertex_count()],
            sites: Vec::new(),
        }
    }

    /// Adds site `v`.
    ///
    /// `greatest` is the greatest distance of a vertex from the other sites. A vertex that becomes
    /// nearer is within this distance of `v`, so the run ends there.
    fn add(&mut self, v: VertexId, greatest: f64) -> Result<(), SolveError> {
        let goal = Goal::everything().within(greatest);
        let found = self.solver.solve_until(&[v], &goal)?.distances;
        for (nearest, d) in self.nearest.iter_mut().zip(found) {
            *nearest = nearest.min(d);
        }
        self.nearest[v.index()] = 0.0;
        self.sites.push(v);
        Ok(())
    }

    fn is_in_face(&self, v: VertexId) -> bool {
        !self.mesh.outgoing(v).is_empty()
    }

    /// The vertex in a face that is farthest from all sites; the first of several.
    fn farthest(&self) -> Option<(VertexId, f64)> {
        let mut farthest: Option<(VertexId, f64)> = None;
        for (v, &d) in self.mesh.vertices().zip(&self.nearest) {
            let is_farther = farthest.is_none_or(|(_, greatest)| d > greatest);
            if is_farther && d > 0.0 && self.is_in_face(v) {
                farthest = Some((v, d));
            }
        }
        farthest
    }

    /// Adds vertices to the sites `first` until there are `sites`. There are fewer if the mesh has
    /// not enough vertices, more if a component would have no site. If `first` is empty, the first
    /// site is drawn by `seed`.
    pub(super) fn sample(
        mut self,
        first: &[VertexId],
        sites: usize,
        seed: u64,
    ) -> Result<Vec<VertexId>, SolveError> {
        if first.is_empty() {
            let all = self.mesh.vertices().filter(|&v| self.is_in_face(v));
            let all: Vec<VertexId> = all.collect();
            let drawn = SplitMix64::new(seed).below(all.len().max(1));
            if let Some(&v) = all.get(drawn) {
                self.add(v, f64::INFINITY)?;
            }
        } else {
            self.nearest = self.solver.solve(first)?.distances;
            self.sites = first.to_vec();
        }
        while let Some((v, d)) = self.farthest() {
            if self.sites.len() >= sites && d.is_finite() {
                break;
            }
            self.add(v, d)?;
        }
        Ok(self.sites)
    }
}
