//! Sparse symmetric matrices of a triangulation and their Cholesky factors.

use std::slice::ChunksExact;
use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Par, Side, Spec};

use super::FlowFace;

/// The first increase of the diagonal, relatively, of a matrix that rounding has made indefinite.
const FIRST_GROWTH: f64 = 1e-13;

/// The Laplace matrix of a triangulation. All matrices of a mesh share its sparsity pattern and
/// elimination order.
pub(super) struct Pattern {
    /// The pattern of the lower triangle by columns. Each column starts with the diagonal.
    places: SymbolicSparseColMat<usize>,
    weights: Vec<f64>,
    order: Arc<EliminationOrder>,
}

/// The elimination order and the pattern of the factors.
#[derive(Debug)]
struct EliminationOrder {
    symbolic: SymbolicCholesky<usize>,
    /// The vertex of each row.
    vertices: Vec<u32>,
    blocks: Vec<Supernode>,
    /// The rows below all blocks, block by block.
    rows: Vec<u32>,
    /// The most rows below a block.
    most: usize,
}

/// A supernode: adjacent columns of a factor with the same rows below them. Its entries are a dense
/// matrix by columns, whose first rows are those of its own columns.
#[derive(Clone, Copy, Debug)]
struct Supernode {
    /// The first column, and one past the last.
    columns: [usize; 2],
    /// The start of its rows in [`EliminationOrder::rows`], and one past their end.
    rows: [usize; 2],
    /// The start of its entries in the values of a factor.
    values: usize,
}

/// A factorised matrix.
#[derive(Debug)]
pub(super) struct Factor {
    order: Arc<EliminationOrder>,
    values: Vec<f64>,
}

impl Pattern {
    /// The cotangent matrix of `faces`; `None` if there is not enough memory for its factors.
    pub(super) fn new(vertices: usize, faces: &[FlowFace]) -> Option<Self> {
        // Entries (row, weight) by columns, with one entry for each face of an edge.
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
        let order = Arc::new(EliminationOrder::new(&places)?);
        Some(Self {
            places,
            weights,
            order,
        })
    }

    /// The factor of the matrix with `diagonal(vertex, weight)` on its diagonal and `other(vertex,
    /// vertex, weight)` off it. If rounding has made the matrix indefinite, the diagonal is
    /// increased until it is not.
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
                    // Isolated vertices have zero entries.
                    let value = diagonal(v, weight);
                    if value == 0.0 { 1.0 } else { value }
                } else {
                    other(v, row, weight)
                });
            }
        }
        let mut memory = self.order.memory()?;
        let mut growth = FIRST_GROWTH;
        while growth.is_finite() {
            let matrix = SparseColMatRef::new(self.places.as_ref(), &values);
            if let Some(values) = self.order.factor(matrix, &mut memory) {
                return Some(Factor {
                    order: self.order.clone(),
                    values,
                });
            }
            for &place in &places {
                values[place] += growth * values[place].abs().max(f64::MIN_POSITIVE);
            }
            growth *= 100.0;
        }
        None
    }
}

/// Calls `visit` with the ends of each edge of each face, the lower one first, and its weight in
/// the face.
fn for_edges(faces: &[FlowFace], mut visit: impl FnMut(usize, usize, f64)) {
    for face in faces {
        let cotangents = face.cotangents();
        for (k, cotangent) in cotangents.into_iter().enumerate() {
            let [a, b] = [(k + 1) % 3, (k + 2) % 3].map(|i| face.vertices[i] as usize);
            // Flips can produce an edge with both ends at one vertex.
            if a != b {
                visit(a.min(b), a.max(b), 0.5 * cotangent);
            }
        }
    }
}

impl EliminationOrder {
    /// `None` if there is not enough memory for it.
    fn new(places: &SymbolicSparseColMat<usize>) -> Option<Self> {
        let parameters = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..CholeskySymbolicParams::default()
        };
        let order = SymmetricOrdering::Amd;
        let symbolic =
            factorize_symbolic_cholesky(places.as_ref(), Side::Lower, order, parameters).ok()?;
        let SymbolicCholeskyRaw::Supernodal(blocks) = symbolic.raw() else {
            return None;
        };
        let (vertices, _) = symbolic.perm()?.arrays();
        let vertices = vertices.iter().map(|&v| v as u32).collect();
        let mut rows: Vec<u32> = Vec::with_capacity(blocks.row_idx().len());
        let block = |i: usize| {
            let start = rows.len();
            let pattern = blocks.supernode(i).pattern();
            rows.extend(pattern.iter().map(|&row| row as u32));
            Supernode {
                columns: [blocks.supernode_begin()[i], blocks.supernode_end()[i]],
                rows: [start, rows.len()],
                values: blocks.col_ptr_for_val()[i],
            }
        };
        let blocks: Vec<Supernode> = (0..blocks.n_supernodes()).map(block).collect();
        let most = blocks.iter().map(|block| block.rows[1] - block.rows[0]);
        Some(Self {
            most: most.max().unwrap_or(0),
            vertices,
            blocks,
            rows,
            symbolic,
        })
    }

    /// What factorising needs; `None` if there is not so much.
    fn memory(&self) -> Option<MemBuffer> {
        let symbolic = &self.symbolic;
        let need = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        MemBuffer::try_new(need).ok()
    }

    /// The entries of the factor of `matrix`; `None` if it is not positive definite, or there is
    /// not enough memory.
    fn factor(
        &self,
        matrix: SparseColMatRef<'_, usize, f64>,
        memory: &mut MemBuffer,
    ) -> Option<Vec<f64>> {
        let mut values = Vec::new();
        values.try_reserve_exact(self.symbolic.len_val()).ok()?;
        values.resize(self.symbolic.len_val(), 0.0);
        let done = self.symbolic.factorize_numeric_llt(
            &mut values,
            matrix,
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(memory),
            Spec::default(),
        );
        done.is_ok().then_some(values)
    }
}

impl Factor {
    /// Replaces the right-hand side by the solution.
    ///
    /// The loops are written out, because the blocks of a surface are small. Calls of general
    /// matrix products for each of them would take most of the time.
    pub(super) fn solve(&self, values: &mut [f64]) {
        let order = &*self.order;
        let mut x: Vec<f64> = order.vertices.iter().map(|&v| values[v as usize]).collect();
        let mut below = vec![0.0; order.most];
        for block in &order.blocks {
            self.solve_block(block, &mut x, &mut below);
        }
        for block in order.blocks.iter().rev() {
            self.solve_transposed(block, &mut x, &mut below);
        }
        for (&v, x) in order.vertices.iter().zip(x) {
            values[v as usize] = x;
        }
    }

    /// The columns of a block, and the rows below it.
    fn parts(&self, block: &Supernode) -> (ChunksExact<'_, f64>, &[u32]) {
        let rows = &self.order.rows[block.rows[0]..block.rows[1]];
        let own = block.columns[1] - block.columns[0];
        let height = own + rows.len();
        let values = &self.values[block.values..block.values + own * height];
        (values.chunks_exact(height), rows)
    }

    /// Solves for the unknowns of a block, and subtracts their part from the rows below.
    fn solve_block(&self, block: &Supernode, x: &mut [f64], below: &mut [f64]) {
        let (columns, rows) = self.parts(block);
        let below = &mut below[..rows.len()];
        below.fill(0.0);
        let own = &mut x[block.columns[0]..block.columns[1]];
        for (i, column) in columns.enumerate() {
            let (within, under) = column.split_at(own.len());
            let solved = own[i] / within[i];
            own[i] = solved;
            for (x, l) in own[i + 1..].iter_mut().zip(&within[i + 1..]) {
                *x -= l * solved;
            }
            for (sum, l) in below.iter_mut().zip(under) {
                *sum += l * solved;
            }
        }
        for (&row, sum) in rows.iter().zip(below) {
            x[row as usize] -= *sum;
        }
    }

    /// As [`solve_block`](Self::solve_block), for the transposed factor: subtracts the rows below
    /// from the unknowns, then solves.
    fn solve_transposed(&self, block: &Supernode, x: &mut [f64], below: &mut [f64]) {
        let (columns, rows) = self.parts(block);
        let below = &mut below[..rows.len()];
        for (known, &row) in below.iter_mut().zip(rows) {
            *known = x[row as usize];
        }
        let own = &mut x[block.columns[0]..block.columns[1]];
        for (i, column) in columns.enumerate().rev() {
            let (within, under) = column.split_at(own.len());
            let later = product(&within[i + 1..], &own[i + 1..]);
            own[i] = (own[i] - later - product(under, below)) / within[i];
        }
    }
}

/// The dot product, in four partial sums, which vectorise.
fn product(a: &[f64], b: &[f64]) -> f64 {
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest = a4.remainder().iter().zip(b4.remainder());
    let rest: f64 = rest.map(|(a, b)| a * b).sum();
    let mut sums = [0.0; 4];
    for (a, b) in a4.zip(b4) {
        for i in 0..4 {
            sums[i] += a[i] * b[i];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

#[cfg(test)]
mod tests {
    use geobench_mesh::{Mesh, SplitMix64};

    use super::*;
    use crate::heat::intrinsic::Intrinsic;

    #[test]
    fn solutions_solve() {
        for spec in [
            "tetrahedron",
            "grid,n=3",
            "terrain,n=30,seed=2",
            "sphere,subdiv=4",
        ] {
            let mesh = Mesh::generate(spec).unwrap();
            let faces: Vec<FlowFace> = Intrinsic::new(&mesh).faces().collect();
            let n = mesh.vertex_count();
            let pattern = Pattern::new(n, &faces).unwrap();
            let factor = pattern.factor(|_, w| 1.0 + w, |_, _, w| w).unwrap();
            let mut random = SplitMix64::new(7);
            let right: Vec<f64> = (0..n).map(|_| random.unit() - 0.5).collect();
            let mut found = right.clone();
            factor.solve(&mut found);
            let mut product: Vec<f64> = found.clone();
            for_edges(&faces, |a, b, weight| {
                let through = weight * (found[a] - found[b]);
                product[a] += through;
                product[b] -= through;
            });
            for (got, want) in product.iter().zip(&right) {
                assert!((got - want).abs() < 1e-12, "{spec}: {got} {want}");
            }
        }
    }
}
