//! Paths through way points.

use geobench_mesh::{Refined, VertexId};

use crate::path::Path;
use crate::trace::TraceError;

/// A path through way points.
#[derive(Clone, Copy, Debug, Default)]
pub struct Through {
    /// Whether the path returns to its first point.
    pub closed: bool,
    /// Whether the path leaves its way points where that makes it [shorter](Path::shortened). An
    /// open path keeps its ends.
    pub shorten: bool,
}

impl Through {
    /// The path from the first of `vertices` of the refined mesh to the second, and so on, on the
    /// original mesh. `between` finds a shortest path on the refined mesh, once for each part.
    /// `None` if it finds none, and without vertices.
    ///
    /// # Errors
    ///
    /// Those of `between`.
    pub fn path<E: From<TraceError>>(
        self,
        refined: &Refined,
        vertices: &[VertexId],
        mut between: impl FnMut([VertexId; 2]) -> Result<Option<Path>, E>,
    ) -> Result<Option<Path>, E> {
        let Some(&first) = vertices.first() else {
            return Ok(None);
        };
        let back = self.closed.then_some(first);
        let mut from = first;
        let mut pieces = Vec::new();
        for &to in vertices[1..].iter().chain(&back) {
            let Some(piece) = between([from, to])? else {
                return Ok(None);
            };
            pieces.push(piece);
            from = to;
        }
        let is_refined = refined.mesh.vertex_count() > refined.original().vertex_count();
        let told = |path: Path| {
            if is_refined {
                path.of_original(refined)
            } else {
                path
            }
        };
        if !self.shorten {
            return Ok(Some(Path::joined(pieces.into_iter().map(told))));
        }
        let path = Path::joined(pieces).shortened(&refined.mesh, self.closed);
        let path = path.ok_or(TraceError::Lost { target: from })?;
        Ok(Some(told(path)))
    }
}
