//! Steps of Lloyd's algorithm: each site moves to the centre of its cell.

use std::collections::HashMap;

use geobench_mesh::{FaceId, Mesh, Refined, SurfacePoint, VertexId};
use geobench_paths::Paths;
use geobench_vtp::VtpFast;
use geobench_window::Goal;

use super::RemeshError;
use super::tangent::{Tangents, Vector};
use crate::diagram::Diagram;

/// The integral of the logarithms over a cell, and the area of the cell; see [`centres`].
#[derive(Clone, Copy, Debug, Default)]
struct Moment {
    area: f64,
    sum: Vector,
}

impl Moment {
    /// Adds a part of the cell: its area, with the mean of the logarithms of its corners. Does
    /// nothing without corners.
    fn add(&mut self, area: f64, logarithms: impl Iterator<Item = Vector>) {
        let (mut count, mut sum) = (0.0, [0.0; 2]);
        for [x, y] in logarithms {
            count += 1.0;
            sum = [sum[0] + x, sum[1] + y];
        }
        if count > 0.0 && area > 0.0 {
            self.area += area;
            self.sum = [0, 1].map(|k| self.sum[k] + area * sum[k] / count);
        }
    }
}

/// The centres of all cells of `diagram`, and their mean distance from the sites. `refined` is
/// `mesh` refined at `sites`. The vertices at the sites are the sources of the diagram.
///
/// The *logarithm* of a point at a site is a vector in the plane of directions at the site: the
/// direction and the length of the shortest path to the point. The centre of a cell is the point
/// whose logarithm is the mean of the logarithms of all points of the cell. In a plane, it is the
/// centre of mass. Inside faces, logarithms are interpolated. Of a face that several cells share,
/// each part uses only the corners that are in its cell. Sites on the boundary stay.
pub(super) fn centres(
    mesh: &Mesh,
    sites: &[SurfacePoint],
    refined: &Refined,
    diagram: &Diagram,
) -> Result<(Vec<SurfacePoint>, f64), RemeshError> {
    let logarithms = logarithms(refined)?;
    let mut moments = vec![Moment::default(); sites.len()];
    let labels = diagram.labels();
    let add = |moment: &mut Moment, face: FaceId, source: u32, area: f64| {
        let corners = refined.mesh.face_vertices(face).map(VertexId::index);
        let own = corners.into_iter().filter(|&v| labels[v] == source);
        moment.add(area, own.filter_map(|v| logarithms[v]));
    };
    for face in refined.mesh.faces() {
        if let Some(source) = diagram.cell_of_face(face) {
            let h = face.half_edge(0);
            let area = 0.5 * refined.mesh.length(h) * refined.mesh.apex(h)[1];
            add(&mut moments[source as usize], face, source, area);
        }
    }
    for part in diagram.parts(0) {
        let next = part.outline.iter().cycle().skip(1);
        let twice = part.outline.iter().zip(next);
        let area = 0.5 * twice.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>();
        let moment = &mut moments[part.source as usize];
        add(moment, part.face, part.source, area);
    }
    let mut moved = 0.0;
    let mut centres = Vec::with_capacity(sites.len());
    for ((&site, &v), moment) in sites.iter().zip(&refined.vertices).zip(&moments) {
        let stays = refined.mesh.is_boundary(v) || moment.area == 0.0;
        let vector = moment.sum.map(|x| x / moment.area);
        let line = if stays {
            None
        } else {
            Tangents::new(&refined.mesh, v).exponential(vector)
        };
        let centre = line.and_then(|line| {
            let weights = refined.in_parent(line.face, line.weights);
            let centre = mesh.point_in_face(refined.parent(line.face), weights);
            Some((centre.ok()?, line.length))
        });
        let (centre, length) = centre.unwrap_or((site, 0.0));
        centres.push(centre);
        moved += length;
    }
    Ok((centres, moved / sites.len().max(1) as f64))
}

/// The logarithm of each vertex at its nearest site; `None` if no path leads there or the path
/// cannot be traced.
fn logarithms(refined: &Refined) -> Result<Vec<Option<Vector>>, RemeshError> {
    let mesh = &refined.mesh;
    let mut solver = VtpFast::new(mesh);
    let paths = Paths::find(&mut solver, mesh, &refined.vertices, &Goal::everything())?;
    let mut tangents: HashMap<VertexId, Tangents<'_>> = HashMap::new();
    let logarithm = |v: VertexId| {
        // A path that cannot be traced leaves out one vertex of many.
        let path = paths.to(v).ok()??;
        let site = path.points.first()?.vertex()?;
        let tangents = tangents.entry(site);
        let tangents = tangents.or_insert_with(|| Tangents::new(mesh, site));
        tangents.logarithm(&path)
    };
    Ok(mesh.vertices().map(logarithm).collect())
}

#[cfg(test)]
mod tests {
    use super::super::{diagram, refine};
    use super::*;

    #[test]
    fn the_centre_of_a_square_is_its_middle() {
        let mesh = Mesh::generate("grid,n=10").unwrap();
        let mut sites = vec![VertexId::new(4 + 11 * 3).into()];
        let refined = refine(&mesh, &mut sites).unwrap();
        let (diagram, ()) = diagram(&refined, |_| ()).unwrap();
        let (centres, moved) = centres(&mesh, &sites, &refined, &diagram).unwrap();
        let positions = [centres[0], sites[0]].map(|point| mesh.position_of(&point).unwrap());
        let way = [0, 1].map(|k| positions[0][k] - positions[1][k]);
        assert!((moved - libm::hypot(way[0], way[1])).abs() < 1e-12);
        let middle = mesh.positions()[60];
        let off = [0, 1].map(|k| (positions[0][k] - middle[k]).abs());
        assert!(off[0].max(off[1]) < 1e-12, "{:?}", positions[0]);
    }
}
