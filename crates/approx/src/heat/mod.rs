//! The heat method.

mod cholesky;
mod intrinsic;

use std::collections::HashSet;

use geobench_mesh::{Mesh, Splice, VertexId};
use geobench_window::{CompiledRuns, Counter, Phase, Probe, Propagate, Solution, SolveError};

use crate::attached::{Attached, AttachedPoint, PointInFace};
use cholesky::{Factor, Pattern};
use intrinsic::Intrinsic;

/// The condition on heat at the boundary of the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Boundary {
    /// The mean of the two other solutions, as the paper recommends.
    #[default]
    Average,
    /// No heat crosses the boundary (Neumann).
    Insulated,
    /// The boundary has no heat (Dirichlet). That of sources there is put at the nearest ring of
    /// inner vertices. Components without inner vertices are insulated.
    Cold,
}

/// Options of [`Heat`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeatOptions {
    /// The time of the heat flow, in squares of the mean edge length.
    pub time: f64,
    /// The condition at the boundary.
    pub boundary: Boundary,
    /// Whether edges are first flipped within the surface until they are Delaunay.
    pub delaunay: bool,
    /// A number added to the diagonal of the Laplace matrix, which is singular. With 0, the
    /// distance of one vertex of each component is fixed instead, which changes no distance.
    pub shift: f64,
}

impl Default for HeatOptions {
    fn default() -> Self {
        Self {
            time: 1.0,
            boundary: Boundary::Average,
            delaunay: true,
            shift: 0.0,
        }
    }
}

/// The heat of a source. It is a power of two, so it changes no distance. Heat underflows at 1330
/// mean edge lengths from the source.
const SOURCE: f64 = f64::from_bits((1023 + 900) << 52);

/// The heat method (Crane, Weischedel and Wardetzky 2013).
///
/// Heat flows from the sources for a short time. Its normalised gradient points towards the
/// sources, and the distances are the function whose gradient is closest to the opposite of this
/// field. Both steps solve a linear system whose matrix does not depend on the sources. Set-up
/// factorises the matrices. A solve takes time linear in the size of the factors.
///
/// Distances are smooth. Their error is about the length of an edge, and they may be too long or
/// too short. They are 0 at the sources.
///
/// ```
/// use geobench_approx::{Heat, HeatOptions};
/// use geobench_mesh::Mesh;
/// use geobench_window::Solver;
///
/// let mesh = Mesh::generate("sphere,subdiv=3")?; // Of radius 1.
/// let mut solver = Heat::new(&mesh, HeatOptions::default());
/// for source in [0, 7] {
///     let distances = solver.distances_from(source)?;
///     let farthest = distances.into_iter().fold(0.0, f64::max);
///     assert!((farthest - std::f64::consts::PI).abs() < 0.1);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Heat {
    mesh: Mesh,
    /// The mean edge length of the mesh, which is the unit of lengths in `faces`.
    unit: f64,
    faces: Vec<FlowFace>,
    /// The component of each vertex.
    components: Vec<u32>,
    /// Whether each vertex is on a boundary, in a component that has inner vertices.
    boundary: Vec<bool>,
    factors: Option<Factors>,
    component_count: usize,
    points: Attached,
}

/// A point as vertices with weights: itself, or the corners of its face with its barycentric
/// coordinates.
#[derive(Clone, Copy, Debug)]
struct HeatPoint {
    corners: [u32; 3],
    weights: [f64; 3],
    /// Distances from the corners.
    ways: [f64; 3],
}

impl HeatPoint {
    fn at_vertex(v: VertexId) -> Self {
        Self {
            corners: [v.raw(); 3],
            weights: [1.0, 0.0, 0.0],
            ways: [0.0; 3],
        }
    }

    fn in_face(point: &PointInFace) -> Self {
        Self {
            corners: point.corners.map(VertexId::raw),
            weights: point.weights,
            ways: point.corner_distances(),
        }
    }

    /// The corners with their weights, without those of weight 0, and their distances from the
    /// point.
    fn parts(&self) -> impl Iterator<Item = (usize, f64, f64)> {
        let all = (0..3).map(|k| (self.corners[k] as usize, self.weights[k], self.ways[k]));
        all.filter(|&(_, weight, _)| weight > 0.0)
    }
}

#[derive(Debug)]
struct Factors {
    insulated: Option<Factor>,
    cold: Option<Factor>,
    poisson: Factor,
}

/// A face of the triangulation on which heat flows.
#[derive(Clone, Copy, Debug)]
struct FlowFace {
    vertices: [u32; 3],
    /// Length of the first side, which is on the x-axis with its start at 0.
    length: f64,
    apex: [f64; 2],
}

impl FlowFace {
    fn cotangents(&self) -> [f64; 3] {
        let (l, [x, y]) = (self.length, self.apex);
        [x / y, (l - x) / y, (x * (x - l) + y * y) / (l * y)]
    }

    fn area(&self) -> f64 {
        0.5 * self.length * self.apex[1]
    }

    /// The unit vector against the gradient of `heat`; 0 where `heat` is constant.
    fn flow(&self, heat: &[f64]) -> [f64; 2] {
        let [a, b, c] = self.vertices.map(|v| heat[v as usize]);
        let (mut along, mut rise) = (b - a, c - a);
        // Scaled, because heat may be so small that its square underflows.
        let most = along.abs().max(rise.abs());
        if !(most > 0.0 && most.is_finite()) {
            return [0.0; 2];
        }
        along /= most;
        rise /= most;
        // The gradient times twice the area.
        let gx = along * self.apex[1];
        let gy = rise * self.length - along * self.apex[0];
        let norm = (gx * gx + gy * gy).sqrt();
        if norm > 0.0 {
            [-gx / norm, -gy / norm]
        } else {
            [0.0; 2]
        }
    }
}

impl Heat {
    /// Sets up for `mesh`: builds the triangulation and factorises two matrices, or three for
    /// [`Boundary::Average`] if the mesh has a boundary.
    ///
    /// If there is not enough memory for the factors, solving returns an error.
    pub fn new(mesh: &Mesh, options: HeatOptions) -> Self {
        let mut surface = Intrinsic::new(mesh);
        if options.delaunay {
            surface.flip_to_delaunay();
        }
        let faces: Vec<FlowFace> = surface.faces().collect();
        let vertices = mesh.vertex_count();
        let (components, component_count) = components(vertices, &faces);
        let mut has_inner = vec![false; component_count];
        for (v, &component) in mesh.vertices().zip(&components) {
            has_inner[component as usize] |= !mesh.is_boundary(v);
        }
        let can_be_cold = mesh.vertices().zip(&components);
        let boundary: Vec<bool> = can_be_cold
            .map(|(v, &component)| mesh.is_boundary(v) && has_inner[component as usize])
            .collect();
        let factors = Factors::new(&faces, &components, &boundary, &options);
        Self {
            mesh: mesh.clone(),
            unit: surface.unit(),
            faces,
            components,
            boundary,
            factors,
            component_count,
            points: Attached::new(mesh),
        }
    }

    /// The heat after the time of the options.
    fn heat(&self, factors: &Factors, sources: &[HeatPoint]) -> Vec<f64> {
        let start = |takes: &dyn Fn(usize) -> bool| {
            let mut heat = vec![0.0; self.components.len()];
            for (v, weight, _) in sources.iter().flat_map(HeatPoint::parts) {
                if takes(v) {
                    heat[v] += SOURCE * weight;
                }
            }
            heat
        };
        let mut heat = start(&|_| true);
        if let Some(insulated) = &factors.insulated {
            insulated.solve(&mut heat);
        }
        if let Some(cold) = &factors.cold {
            let mut other = start(&|v| !self.boundary[v]);
            if factors.insulated.is_none() {
                self.heat_beside_boundary(sources, &mut other);
            }
            cold.solve(&mut other);
            if factors.insulated.is_some() {
                for (heat, other) in heat.iter_mut().zip(&other) {
                    *heat = 0.5 * (*heat + other);
                }
            } else {
                heat = other;
            }
        }
        heat
    }

    /// Puts the heat of sources on the boundary, which stays cold, at the inner vertices of the
    /// first ring around each source that has any. Else no heat would flow from there.
    fn heat_beside_boundary(&self, sources: &[HeatPoint], heat: &mut [f64]) {
        let is_outside = |s: &&HeatPoint| s.parts().all(|(v, ..)| self.boundary[v]);
        for source in sources.iter().filter(is_outside) {
            let mut ring: HashSet<u32> = source.parts().map(|(v, ..)| v as u32).collect();
            loop {
                let touches = |face: &&FlowFace| face.vertices.iter().any(|v| ring.contains(v));
                let next = self.faces.iter().filter(touches);
                let next: HashSet<u32> = next.flat_map(|face| face.vertices).collect();
                let inner = next.iter().filter(|&&v| !self.boundary[v as usize]);
                let mut is_found = false;
                for &v in inner {
                    heat[v as usize] = SOURCE;
                    is_found = true;
                }
                if is_found || next.len() <= ring.len() {
                    break;
                }
                ring = next;
            }
        }
    }

    /// Minus the divergence of the unit field of `heat`, integrated around each vertex.
    fn sinks(&self, heat: &[f64]) -> Vec<f64> {
        let mut sinks = vec![0.0; heat.len()];
        for face in &self.faces {
            let flow = face.flow(heat);
            let (l, [x, y]) = (face.length, face.apex);
            // The gradients of the three hat functions, times the area.
            let gradients = [[-y, x - l], [y, -x], [0.0, l]];
            for (v, [gx, gy]) in face.vertices.into_iter().zip(gradients) {
                sinks[v as usize] += 0.5 * (gx * flow[0] + gy * flow[1]);
            }
        }
        sinks
    }

    /// Shifts the distances of each component so that they are 0 at the sources on average, and
    /// counts those that are negative then and become 0.
    ///
    /// A source in a face is where the distances of its corners suggest: its distance is the mean
    /// of theirs, less their straight distances from it. Interpolated, it would be too large, since
    /// distances form the tip of a cone there.
    fn place(&self, found: &[f64], sources: &[VertexId], heated: &[HeatPoint]) -> Solution {
        let mut sums = vec![(0.0, 0.0); self.component_count];
        for source in heated {
            let (sum, count) = &mut sums[self.components[source.corners[0] as usize] as usize];
            for (v, weight, way) in source.parts() {
                *sum += weight * (found[v] - way / self.unit);
            }
            *count += 1.0;
        }
        let mut negative = 0;
        let placed = found.iter().zip(&self.components);
        let placed = placed.map(|(&d, &component)| {
            let (sum, count) = sums[component as usize];
            if count == 0.0 {
                f64::INFINITY
            } else {
                let d = d - sum / count;
                negative += usize::from(d < 0.0);
                // Never NaN.
                d.max(0.0) * self.unit
            }
        });
        let mut distances: Vec<f64> = placed.collect();
        for &source in sources.iter().filter(|s| s.index() < found.len()) {
            let mean = sums[self.components[source.index()] as usize];
            negative -= usize::from(found[source.index()] - mean.0 / mean.1 < 0.0);
            distances[source.index()] = 0.0;
        }
        self.extend_to_points(&mut distances, sources);
        let mut solution = Solution::new(distances);
        solution.negative = negative;
        solution
    }

    /// Appends the distances of the points: interpolated in their faces, or straight from sources
    /// in the same face.
    fn extend_to_points(&self, distances: &mut Vec<f64>, sources: &[VertexId]) {
        let of_point = |(v, point): (VertexId, &AttachedPoint)| {
            if sources.binary_search(&v).is_ok() {
                return 0.0;
            }
            let place = HeatPoint::in_face(&point.faces[0]);
            let interpolated = place
                .parts()
                .map(|(v, weight, _)| weight * distances[v])
                .sum();
            let is_source = |&&(end, _): &&(VertexId, f64)| sources.binary_search(&end).is_ok();
            let straight = point
                .ways
                .iter()
                .filter(is_source)
                .map(|&(_, length)| length);
            straight.fold(interpolated, f64::min)
        };
        let found: Vec<f64> = self.points.numbered().map(of_point).collect();
        distances.extend(found);
    }
}

impl Propagate for Heat {
    const TRACES: bool = false;

    fn counters() -> Vec<Counter> {
        vec![Counter::Negative]
    }

    fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    fn splice(&mut self, splice: &Splice) -> Option<Splice> {
        self.points.splice(&mut self.mesh, splice)
    }

    #[inline(never)]
    fn runs(&self) -> CompiledRuns<Self> {
        CompiledRuns::new()
    }

    fn check(&self) -> Result<(), SolveError> {
        let is_ready = self.factors.is_some();
        is_ready.then_some(()).ok_or(SolveError::NoFactor)
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        probe.enter(Phase::Propagation);
        let Some(factors) = &self.factors else {
            return Solution::new(vec![f64::INFINITY; self.mesh.vertex_count()]);
        };
        let mut sources = sources.to_vec();
        sources.sort_unstable();
        sources.dedup();
        let heated = sources
            .iter()
            .map(|&source| match self.points.point(source) {
                Some((_, point)) => HeatPoint::in_face(&point.faces[0]),
                None => HeatPoint::at_vertex(source),
            });
        let heated: Vec<HeatPoint> = heated.collect();
        let heat = self.heat(factors, &heated);
        let mut found = self.sinks(&heat);
        factors.poisson.solve(&mut found);
        let solution = self.place(&found, &sources, &heated);
        probe.add(Counter::Negative, solution.negative as u64);
        solution
    }
}

impl Factors {
    /// `None` if there is not enough memory for them.
    fn new(
        faces: &[FlowFace],
        components: &[u32],
        boundary: &[bool],
        options: &HeatOptions,
    ) -> Option<Self> {
        let pattern = Pattern::new(components.len(), faces)?;
        let mut masses = vec![0.0; components.len()];
        for face in faces {
            for v in face.vertices {
                masses[v as usize] += face.area() / 3.0;
            }
        }
        let time = options.time;
        let has_boundary = boundary.contains(&true);
        let wants = |wanted| options.boundary == Boundary::Average || options.boundary == wanted;
        let insulated = (wants(Boundary::Insulated) || !has_boundary).then(|| {
            pattern.factor(
                |v, weight| masses[v] + time * weight,
                |_, _, weight| time * weight,
            )
        });
        let cold = (wants(Boundary::Cold) && has_boundary).then(|| {
            pattern.factor(
                |v, weight| masses[v] + time * weight,
                |v, w, weight| {
                    if boundary[v] || boundary[w] {
                        0.0
                    } else {
                        time * weight
                    }
                },
            )
        });
        // The distance of the first vertex of each component is fixed.
        let mut held = vec![false; components.len()];
        if options.shift == 0.0 {
            let mut next = 0;
            for (held, &component) in held.iter_mut().zip(components) {
                *held = component == next;
                next += u32::from(*held);
            }
        }
        let poisson = pattern.factor(
            |v, weight| options.shift + if held[v] { 2.0 * weight } else { weight },
            |_, _, weight| weight,
        )?;
        Some(Self {
            insulated: match insulated {
                Some(factor) => Some(factor?),
                None => None,
            },
            cold: match cold {
                Some(factor) => Some(factor?),
                None => None,
            },
            poisson,
        })
    }
}

/// The component of each vertex, numbered in the order of their first vertices, and the number of
/// components.
fn components(vertices: usize, faces: &[FlowFace]) -> (Vec<u32>, usize) {
    let mut roots: Vec<u32> = (0..vertices as u32).collect();
    let find = |roots: &mut Vec<u32>, mut v: u32| {
        while roots[v as usize] != v {
            roots[v as usize] = roots[roots[v as usize] as usize];
            v = roots[v as usize];
        }
        v
    };
    for face in faces {
        let [a, b, c] = face.vertices.map(|v| find(&mut roots, v));
        let least = a.min(b).min(c);
        for v in [a, b, c] {
            roots[v as usize] = least;
        }
    }
    let mut components = vec![0; vertices];
    let mut count = 0;
    for v in 0..vertices as u32 {
        let root = find(&mut roots, v);
        // The root is the least vertex of its component.
        if root == v {
            components[v as usize] = count;
            count += 1;
        } else {
            components[v as usize] = components[root as usize];
        }
    }
    (components, count as usize)
}
