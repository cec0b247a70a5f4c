//! The heat method.

mod cholesky;
mod intrinsic;

use geobench_mesh::{Mesh, VertexId};
use geobench_window::{Counter, Phase, Probe, Propagate, Solution, SolveError};

use cholesky::{Factor, Pattern};
use intrinsic::Intrinsic;

/// What heat does at the boundary of the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Boundary {
    /// The mean of the two others, as the paper recommends.
    #[default]
    Average,
    /// It does not cross the boundary (Neumann).
    Insulated,
    /// The boundary stays cold (Dirichlet).
    Cold,
}

/// Options of [`Heat`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeatOptions {
    /// For how long heat flows, in squares of the mean edge length.
    pub time: f64,
    /// What it does at the boundary.
    pub boundary: Boundary,
    /// Whether edges are flipped first, inside the surface, until they are Delaunay.
    pub delaunay: bool,
    /// A number added to the diagonal of the Laplace matrix, which has no inverse. With 0 the
    /// distance of one vertex is fixed instead, which changes no distance.
    pub shift: f64,
}

impl Default for HeatOptions {
    fn default() -> Self {
        Self {
            time: 1.0,
            boundary: Boundary::Average,
            delaunay: false,
            shift: 0.0,
        }
    }
}

/// The heat of a source; a power of two, so that it changes no distance. What decays from it to
/// nothing is 1330 mean edge lengths away.
const SOURCE: f64 = f64::from_bits((1023 + 900) << 52);

/// The heat method (Crane, Weischedel, Wardetzky 2013).
///
/// Heat flows from the sources for a short time. Its gradient, made a unit field, points away from
/// them; the distances are the function whose gradient is nearest to that field. Both steps solve a
/// linear system whose matrix does not depend on the sources. Set-up factorises the matrices, and a
/// solve takes time linear in the factors.
///
/// Distances are smooth, and off by about the length of an edge; they may be too long or too short.
/// At the sources they are 0.
#[derive(Debug)]
pub struct Heat {
    /// The mean edge length of the mesh, which is 1 in `faces`.
    unit: f64,
    faces: Vec<FlowFace>,
    /// The component of each vertex.
    components: Vec<u32>,
    boundary: Vec<bool>,
    factors: Option<Factors>,
    component_count: usize,
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
    /// The corners: the first at 0, the second on the x-axis.
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

    /// The unit vector against the gradient of `heat`; 0 where that is constant.
    fn flow(&self, heat: &[f64]) -> [f64; 2] {
        let [a, b, c] = self.vertices.map(|v| heat[v as usize]);
        let (mut along, mut rise) = (b - a, c - a);
        // Heat may be so small that its square is nothing.
        let most = along.abs().max(rise.abs());
        if !(most > 0.0 && most.is_finite()) {
            return [0.0; 2];
        }
        along /= most;
        rise /= most;
        // The gradient, times the double of the area.
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
    /// Sets up for `mesh`: lays out the triangulation and factorises two matrices, or three if
    /// there is a boundary.
    pub fn new(mesh: &Mesh, options: HeatOptions) -> Self {
        let mut surface = Intrinsic::new(mesh);
        if options.delaunay {
            surface.flip_to_delaunay();
        }
        let faces: Vec<FlowFace> = surface.faces().collect();
        let vertices = mesh.vertex_count();
        let boundary: Vec<bool> = mesh.vertices().map(|v| mesh.is_boundary(v)).collect();
        let (components, component_count) = components(vertices, &faces);
        let factors = Factors::new(&faces, &components, &boundary, &options);
        Self {
            unit: surface.unit(),
            faces,
            components,
            boundary,
            factors,
            component_count,
        }
    }

    /// The heat after a short time.
    fn heat(&self, factors: &Factors, sources: &[VertexId]) -> Vec<f64> {
        let start = |is_source: &dyn Fn(VertexId) -> bool| {
            let mut heat = vec![0.0; self.components.len()];
            for &source in sources.iter().filter(|&&s| is_source(s)) {
                heat[source.index()] = SOURCE;
            }
            heat
        };
        let mut heat = start(&|_| true);
        if let Some(insulated) = &factors.insulated {
            insulated.solve(&mut heat);
        }
        if let Some(cold) = &factors.cold {
            let mut other = start(&|v| !self.boundary[v.index()]);
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

    /// Minus the divergence, integrated around each vertex, of the unit field of `heat`.
    fn sinks(&self, heat: &[f64]) -> Vec<f64> {
        let mut sinks = vec![0.0; heat.len()];
        for face in &self.faces {
            let flow = face.flow(heat);
            let (l, [x, y]) = (face.length, face.apex);
            // The gradients of the three functions that are 1 at a corner, times the area.
            let gradients = [[-y, x - l], [y, -x], [0.0, l]];
            for (v, [gx, gy]) in face.vertices.into_iter().zip(gradients) {
                sinks[v as usize] += 0.5 * (gx * flow[0] + gy * flow[1]);
            }
        }
        sinks
    }

    /// Puts the sources of each component at 0, on average.
    fn place(&self, found: &[f64], sources: &[VertexId]) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); self.component_count];
        for &source in sources {
            let (sum, count) = &mut sums[self.components[source.index()] as usize];
            *sum += found[source.index()];
            *count += 1.0;
        }
        let placed = found.iter().zip(&self.components);
        let placed = placed.map(|(&d, &component)| {
            let (sum, count) = sums[component as usize];
            if count == 0.0 {
                f64::INFINITY
            } else {
                // Never NaN.
                (d - sum / count).max(0.0) * self.unit
            }
        });
        let mut distances: Vec<f64> = placed.collect();
        for &source in sources {
            distances[source.index()] = 0.0;
        }
        distances
    }
}

impl Propagate for Heat {
    const TRACES: bool = false;

    fn counters() -> Vec<Counter> {
        Vec::new()
    }

    fn vertex_count(&self) -> usize {
        self.components.len()
    }

    fn check(&self) -> Result<(), SolveError> {
        let is_ready = self.factors.is_some();
        is_ready.then_some(()).ok_or(SolveError::NoFactor)
    }

    fn propagate<P: Probe>(&mut self, sources: &[VertexId], probe: &mut P) -> Solution {
        probe.enter(Phase::Propagation);
        let Some(factors) = &self.factors else {
            return Solution::new(vec![f64::INFINITY; self.vertex_count()]);
        };
        let mut sources = sources.to_vec();
        sources.sort_unstable();
        sources.dedup();
        let heat = self.heat(factors, &sources);
        let mut found = self.sinks(&heat);
        factors.poisson.solve(&mut found);
        Solution::new(self.place(&found, &sources))
    }
}

impl Factors {
    /// `None` if there is no memory for them.
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
        // The first vertex of each component is held.
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

/// The component of each vertex, numbered in the order of their first vertices, and their number.
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
