//! A mesh from arrays.

use geodesics::mesh::{Defect, DefectKind, Report};
use geodesics::{Mesh, Stop, TriangleSoup, Weld, io};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::arrays;
use crate::errors::{invalid, mesh_error};
use crate::interrupt;
use crate::points::warn_user;

/// The mesh of the arguments of `Mesh`. Without `weld` there is a warning if vertices are at one
/// place.
pub(crate) fn from_arrays(
    py: Python<'_>,
    vertices: &Bound<'_, PyAny>,
    faces: Option<&Bound<'_, PyAny>>,
    weld: Option<&Bound<'_, PyAny>>,
    repair: bool,
) -> PyResult<(Mesh, Report)> {
    // Meshes of other packages, and polygons as a list of lists, are taken apart in Python.
    let (vertices, faces): (Bound<'_, PyAny>, Bound<'_, PyAny>) = py
        .import("geodesics._meshes")?
        .call_method1("arrays_of", (vertices, faces))?
        .extract()?;
    let positions = arrays::positions(&vertices, "vertices")?;
    let soup = if let Ok(polygons) = faces.cast::<PyList>() {
        let polygons = arrays::polygons(polygons, "faces")?;
        if !repair && let Some(text) = repeated_corner(&polygons) {
            return Err(mesh_error(
                py,
                format!("repair is needed: {text}"),
                vec![text],
            ));
        }
        let corners = polygons.iter().map(Vec::len).sum();
        interrupt::call(py, corners, &Stop::default(), move || {
            io::polygons(positions, polygons)
        })?
        .map_err(|error| mesh_error(py, error.to_string(), Vec::new()))?
    } else {
        TriangleSoup::new(positions, arrays::triangles(&faces, "faces")?)
    };
    let wanted = weld_of(weld)?;
    let made = interrupt::call(py, soup.triangles.len(), &Stop::default(), move || {
        let mut soup = soup;
        if let Some(weld) = wanted {
            soup.weld(weld);
        }
        Mesh::from_soup(soup)
    })?;
    let (mesh, report) = made.map_err(|error| invalid(py, &error, ""))?;
    if !repair {
        let repaired = report.summaries().into_iter();
        let repaired = repaired.filter(|summary| summary.kind.changes_faces());
        let texts: Vec<String> = repaired.map(|summary| summary.text).collect();
        if let Some(first) = texts.first() {
            return Err(mesh_error(py, format!("repair is needed: {first}"), texts));
        }
    }
    if weld.is_none() {
        warn_of_copies(py, &report, "vertices")?;
    }
    Ok((mesh, report))
}

/// Names the first polygon with the same vertex twice in a row, one of which a repair would drop.
fn repeated_corner(polygons: &[Vec<u32>]) -> Option<String> {
    let outlines = polygons
        .iter()
        .enumerate()
        .filter(|(_, outline)| outline.len() > 2);
    let mut pairs = outlines.flat_map(|(face, outline)| {
        let next = outline.iter().cycle().skip(1);
        outline.iter().zip(next).map(move |(a, b)| (face, a, b))
    });
    let (face, v, _) = pairs.find(|(_, a, b)| a == b)?;
    Some(format!("face {face} names vertex {v} twice in a row"))
}

/// A `UserWarning` on vertices at the place of another, if `report` has any. `name` is where they
/// are from.
pub(crate) fn warn_of_copies(py: Python<'_>, report: &Report, name: &str) -> PyResult<()> {
    let weld = report.defects.iter().find_map(|defect| match defect {
        Defect::CoincidentVertices { near: 0, .. } => Some("True".to_owned()),
        Defect::CoincidentVertices { tolerance, .. } => Some(format!("{tolerance:e}")),
        _ => None,
    });
    let mut known = report.summaries().into_iter();
    let twice = known.find(|summary| summary.kind == DefectKind::CoincidentVertices);
    let (Some(weld), Some(twice)) = (weld, twice) else {
        return Ok(());
    };
    let text = twice.text;
    let hint = "no path crosses a seam between them";
    let note = format!("{text}; {hint}; weld={weld} makes them one, weld=False leaves them");
    warn_user(py, name, &[note])
}

/// Reads the argument `weld`: none, a truth value or a tolerance.
pub(crate) fn weld_of(value: Option<&Bound<'_, PyAny>>) -> PyResult<Option<Weld>> {
    let Some(value) = value else {
        return Ok(None);
    };
    if let Ok(wanted) = value.extract::<bool>() {
        return Ok(wanted.then_some(Weld::COINCIDENT));
    }
    let tolerance = value.extract::<f64>().map_err(|_| {
        let given = value
            .repr()
            .map_or_else(|_| "this".to_owned(), |text| text.to_string());
        PyTypeError::new_err(format!(
            "weld: {given} is neither a truth value nor a fraction of the diagonal"
        ))
    });
    let weld = Weld::within(tolerance?);
    weld.map(Some)
        .map_err(|error| PyValueError::new_err(format!("weld: {error}")))
}
