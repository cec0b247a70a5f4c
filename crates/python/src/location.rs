//! Where points lie on a mesh.

use geodesics::{Mesh, SurfacePoint};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::algorithm::named;
use crate::path::tuples;
use crate::points::{Finder, SharedMesh, several, single};

/// A face, barycentric coordinates in it, the position, and the distance from the position that was
/// given.
type Located = (i64, (f64, f64, f64), Option<(f64, f64, f64)>, f64);

/// The `Location` of one point or several.
pub(crate) fn locate<'py>(
    py: Python<'py>,
    surface: &SharedMesh,
    points: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let mesh = &surface.mesh;
    let mut finder = Finder::new(py, surface);
    if let Ok(spec) = single(points, "points") {
        let found = finder.find_from(spec, "points")?;
        return named(py, "Location", located(mesh, &found));
    }
    let specs = several(points, "points", mesh.vertex_count())?.into_iter();
    let places = specs.map(|spec| Ok(located(mesh, &finder.find_from(spec, "points")?)));
    let places: Vec<Located> = places.collect::<PyResult<_>>()?;
    let weights: Vec<[f64; 3]> = places.iter().map(|p| p.1.into()).collect();
    let positions: Option<Vec<[f64; 3]>> = places.iter().map(|p| p.2.map(Into::into)).collect();
    let arrays = (
        PyArray1::from_iter(py, places.iter().map(|p| p.0)),
        tuples(py, &weights)?,
        positions
            .map(|positions| tuples(py, &positions))
            .transpose()?,
        PyArray1::from_iter(py, places.iter().map(|p| p.3)),
    );
    named(py, "Location", arrays)
}

/// The place of a point that was found, with its distance from the position that was given.
fn located(mesh: &Mesh, (found, distance): &(SurfacePoint, f64)) -> Located {
    let (face, weights) = match mesh.face_of(found) {
        Some((face, weights)) => {
            let (triangle, weights) = mesh.in_file(face, weights);
            (i64::from(triangle), weights)
        }
        None => (-1, [0.0; 3]),
    };
    let position = mesh.position_of(found);
    (face, weights.into(), position.map(Into::into), *distance)
}
