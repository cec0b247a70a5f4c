//! From where a model is looked at.

use geobench_mesh::{Mesh, VertexId};

type Vector = [f64; 3];

/// An orthographic view.
#[derive(Clone, Debug)]
pub(super) struct Camera {
    /// To the right, up, and towards the viewer; of length 1 and at right angles.
    axes: [Vector; 3],
    /// What is seen in the middle, in the coordinates of the axes.
    middle: [f64; 2],
    /// Pixels for each unit of the model.
    scale: f64,
    /// Width and height in pixels.
    pub(super) size: [usize; 2],
}

/// Part of the picture that the model may fill.
const FILL: f64 = 0.96;

/// Side of the grid on which views are compared.
const GRID: usize = 96;

impl Camera {
    /// The view that shows most of the surface of `mesh`, its source if possible, on a picture of
    /// `size` pixels. Up is the y-axis, as in most files, or the z-axis if the model is flat along
    /// that. O(directions x vertices).
    pub(super) fn choose(mesh: &Mesh, source: VertexId, size: [usize; 2]) -> Self {
        let positions = mesh.positions();
        let (low, high) = bounds(positions);
        let extent: Vector = std::array::from_fn(|k| high[k] - low[k]);
        let flat = extent[2] < 0.35 * extent[0].min(extent[1]);
        let up = if flat {
            [0.0, 0.0, 1.0]
        } else {
            [0.0, 1.0, 0.0]
        };
        // What lies flat is looked at from above, what stands upright from the side.
        let heights: &[f64] = if flat { &[50.0, 70.0] } else { &[12.0, 32.0] };
        let normal = normal_at(mesh, source);
        let directions = (0..16).flat_map(|k| {
            let turn = (f64::from(k) * 22.5 + 11.0).to_radians();
            heights
                .iter()
                .map(move |height| direction(up, turn, height.to_radians()))
        });
        let mut best = (f64::NEG_INFINITY, [0.0, 0.0, 1.0]);
        for towards in directions {
            let axes = axes(towards, up);
            let score = score(positions, source, &axes, dot(normal, towards));
            if score > best.0 {
                best = (score, towards);
            }
        }
        Self::fitted(positions, axes(best.1, up), size)
    }

    fn fitted(positions: &[Vector], axes: [Vector; 3], size: [usize; 2]) -> Self {
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for position in positions {
            for k in 0..2 {
                let at = dot(*position, axes[k]);
                low[k] = low[k].min(at);
                high[k] = high[k].max(at);
            }
        }
        let fit = |k: usize| FILL * size[k] as f64 / (high[k] - low[k]).max(1e-300);
        Self {
            axes,
            middle: std::array::from_fn(|k| f64::midpoint(low[k], high[k])),
            scale: fit(0).min(fit(1)),
            size,
        }
    }

    /// Where a point is seen, from the top left, and how near it is to the viewer, all in pixels.
    pub(super) fn project(&self, position: Vector) -> Vector {
        let [right, up, towards] = self.axes.map(|axis| dot(position, axis));
        [
            (right - self.middle[0]) * self.scale + self.size[0] as f64 / 2.0,
            (self.middle[1] - up) * self.scale + self.size[1] as f64 / 2.0,
            towards * self.scale,
        ]
    }

    /// A direction in the coordinates of the axes.
    pub(super) fn turn(&self, direction: Vector) -> Vector {
        self.axes.map(|axis| dot(direction, axis))
    }

    /// The same view with `times` as many pixels each way.
    pub(super) fn enlarged(&self, times: usize) -> Self {
        Self {
            scale: self.scale * times as f64,
            size: self.size.map(|s| s * times),
            ..self.clone()
        }
    }
}

/// How much of the surface a view shows: cells of a grid in which some vertex is seen; more if the
/// source is among what is seen, and yet more if it looks at the viewer.
fn score(positions: &[Vector], source: VertexId, axes: &[Vector; 3], facing: f64) -> f64 {
    let (low, high) = bounds(positions);
    let size = (0..3)
        .map(|k| (high[k] - low[k]).powi(2))
        .sum::<f64>()
        .sqrt()
        .max(1e-300);
    let middle: Vector = std::array::from_fn(|k| f64::midpoint(low[k], high[k]));
    let mut nearest = vec![f64::NEG_INFINITY; GRID * GRID];
    let place = |position: &Vector| {
        let offset: Vector = std::array::from_fn(|k| (position[k] - middle[k]) / size);
        let [x, y, z] = axes.map(|axis| dot(offset, axis));
        let cell = |t: f64| (((t + 0.5) * GRID as f64) as usize).min(GRID - 1);
        (cell(x) + GRID * cell(y), z)
    };
    for position in positions {
        let (cell, z) = place(position);
        nearest[cell] = nearest[cell].max(z);
    }
    let covered = nearest.iter().filter(|z| z.is_finite()).count();
    let (cell, z) = place(&positions[source.index()]);
    let seen = facing > 0.1 && z > nearest[cell] - 2.0 / GRID as f64;
    let bonus = if seen { 1.3 + 0.4 * facing } else { 1.0 };
    covered as f64 * bonus
}

/// The direction from the model to the viewer.
fn direction(up: Vector, turn: f64, height: f64) -> Vector {
    // libm: the same view on every machine.
    let (flat, lift) = (libm::cos(height), libm::sin(height));
    let (a, b) = (flat * libm::sin(turn), flat * libm::cos(turn));
    if up[1] > 0.0 {
        [a, lift, b]
    } else {
        [a, -b, lift]
    }
}

/// To the right, up and towards the viewer.
fn axes(towards: Vector, up: Vector) -> [Vector; 3] {
    let right = unit(cross(up, towards));
    [right, cross(towards, right), towards]
}

fn normal_at(mesh: &Mesh, vertex: VertexId) -> Vector {
    let positions = mesh.positions();
    let mut sum = [0.0; 3];
    for &h in mesh.outgoing(vertex) {
        let corners = [mesh.tail(h), mesh.head(h), mesh.apex_vertex(h)];
        let normal = face_normal(corners.map(|v| positions[v.index()]));
        for k in 0..3 {
            sum[k] += normal[k];
        }
    }
    unit(sum)
}

/// The normal of a triangle, as long as twice its area.
pub(super) fn face_normal([a, b, c]: [Vector; 3]) -> Vector {
    let edge = |to: Vector| std::array::from_fn(|k| to[k] - a[k]);
    cross(edge(b), edge(c))
}

fn bounds(positions: &[Vector]) -> (Vector, Vector) {
    let fold = |start: f64, choose: fn(f64, f64) -> f64| {
        positions.iter().fold([start; 3], |so_far, position| {
            std::array::from_fn(|k| choose(so_far[k], position[k]))
        })
    };
    (
        fold(f64::INFINITY, f64::min),
        fold(f64::NEG_INFINITY, f64::max),
    )
}

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The vector of length 1 in this direction; what has no direction stays as it is.
pub(super) fn unit(v: Vector) -> Vector {
    let length = dot(v, v).sqrt();
    if length > 0.0 {
        v.map(|x| x / length)
    } else {
        v
    }
}
