//! Sparse symmetric matrices of a triangulation, factorised.

use faer::linalg::solvers::SolveCore;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Side};

use super::Face;

/// By how much the diagonal grows first where rounding leaves a matrix without a factor.
const FIRST_GROWTH: f64 = 1e-13;

/// The Laplace matrix of a triangulation: its places, which all matrices of a mesh share with the
/// order of their elimination, and its entries.
pub(super) struct Pattern {
    /// The lower triangle by columns; each starts with the diagonal.
    places: SymbolicSparseColMat<usize>,
    weights: Vec<f64>,
    order: SymbolicLlt<usize>,
}

/// A factorised matrix.
#[derive(Debug)]
pub(super) struct Factor(Llt<usize, f64>);

impl Pattern {
    /// The cotangent matrix of `faces`; `None` if there is no memory for its factors.
    pub(super) fn new(vertices: usize, faces: &[Face]) -> Option<Self> {
        // Entries (row, weight) by columns, several for an edge.
        let mut starts = vec![0_usize; vertices + 1];
        for_edges(faces, |low, _, _| starts[low + 1] += 1);
        for i in 0..vertices {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut entries = vec![(0, 0.0); starts[vertices]];
        let mut diagonal = vec![0.0; vertices];
        for_edges(faces, |low, high, weight| {
            entries[next[low]] = (high, weight);
            next[low] += 1;
            diagonal[low] += weight;
            diagonal[high] += weight;
        });
        let mut columns = Vec::with_capacity(vertices + 1);
        let mut rows = Vec::with_capacity(vertices + entries.len());
        let mut weights = Vec::with_capacity(vertices + entries.len());
        columns.push(0);
        for v in 0..vertices {
            rows.push(v);
            weights.push(diagonal[v]);
            let column = &mut entries[starts[v]..starts[v + 1]];
            column.sort_unstable_by_key(|entry| entry.0);
            for edge in column.chunk_by(|a, b| a.0 == b.0) {
                rows.push(edge[0].0);
                weights.push(-edge.iter().map(|entry| entry.1).sum::<f64>());
            }
            columns.push(rows.len());
        }
        let places = SymbolicSparseColMat::new_checked(vertices, vertices, columns, None, rows);
        let order = SymbolicLlt::try_new(places.as_ref(), Side::Lower).ok()?;
        Some(Self {
            places,
            weights,
            order,
        })
    }

    /// The factor of the matrix with `diagonal(vertex, weight)` on its diagonal and
    /// `other(vertex, vertex, weight)` beside it. Where rounding has made it indefinite, its
    /// diagonal grows until it is not.
    pub(super) fn factor(
        &self,
        diagonal: impl Fn(usize, f64) -> f64,
        other: impl Fn(usize, usize, f64) -> f64,
    ) -> Option<Factor> {
        let mut values = Vec::with_capacity(self.weights.len());
        let mut places = Vec::new();
        for v in 0..self.places.ncols() {
            let column = self.places.col_range(v);
            for place in column {
                let (row, weight) = (self.places.row_idx()[place], self.weights[place]);
                values.push(if row == v {
                    places.push(place);
                    // Vertices without a face have nothing.
                    let value = diagonal(v, weight);
                    if value == 0.0 { 1.0 } else { value }
                } else {
                    other(v, row, weight)
                });
            }
        }
        let mut growth = FIRST_GROWTH;
        while growth.is_finite() {
            let matrix = SparseColMatRef::new(self.places.as_ref(), &values);
            if let Ok(factor) = Llt::try_new_with_symbolic(self.order.clone(), matrix, Side::Lower)
            {
                return Some(Factor(factor));
            }
            for &place in &places {
                values[place] += growth * values[place].abs().max(f64::MIN_POSITIVE);
            }
            growth *= 100.0;
        }
        None
    }
}

/// Calls `visit` with the ends of each edge of each face, the lower first, and its weight there.
fn for_edges(faces: &[Face], mut visit: impl FnMut(usize, usize, f64)) {
    for face in faces {
        let cotangents = face.cotangents();
        for (k, cotangent) in cotangents.into_iter().enumerate() {
            let [a, b] = [(k + 1) % 3, (k + 2) % 3].map(|i| face.vertices[i] as usize);
            // Flips can leave an edge with both ends at one vertex.
            if a != b {
                visit(a.min(b), a.max(b), 0.5 * cotangent);
            }
        }
    }
}

impl Factor {
    /// Replaces the right-hand side by the solution.
    pub(super) fn solve(&self, values: &mut [f64]) {
        let rows = values.len();
        let column = MatMut::from_column_major_slice_mut(values, rows, 1);
        self.0.solve_in_place_with_conj(Conj::No, column);
    }
}
