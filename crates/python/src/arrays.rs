//! Reads NumPy arrays. Each is copied once; types that are not read directly are converted by
//! NumPy first.

use numpy::ndarray::ArrayView2;
use numpy::{
    Element, PyArray1, PyArray2, PyArrayDescrMethods, PyArrayMethods, PyReadonlyArray2,
    PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyIndexError, PyMemoryError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::errors::mesh_error;

/// Refuses masked arrays, whose masked values would be read like the others.
fn check_mask(value: &Bound<'_, PyAny>, name: &str) -> PyResult<()> {
    if value.hasattr("mask")? && value.hasattr("filled")? {
        return Err(PyTypeError::new_err(format!(
            "{name}: a masked array; fill or compress it first"
        )));
    }
    Ok(())
}

/// The array of an object that has one, such as a table of pandas, whose items are the names of its
/// columns. Other values are returned as they are.
pub(crate) fn taken<'py>(value: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    check_mask(value, name)?;
    let is_array = value.is_instance_of::<PyUntypedArray>();
    if is_array || !value.hasattr("__array__")? {
        return Ok(value.clone());
    }
    Ok(array_of(value, name)?.into_any())
}

/// `value` as an array. Other sequences are converted with `numpy.asarray`.
pub(crate) fn array_of<'py>(
    value: &Bound<'py, PyAny>,
    name: &str,
) -> PyResult<Bound<'py, PyUntypedArray>> {
    check_mask(value, name)?;
    if let Ok(array) = value.cast::<PyUntypedArray>() {
        return Ok(array.clone());
    }
    let made = value
        .py()
        .import("numpy")?
        .call_method1("asarray", (value,));
    let array = made.map_err(|error| {
        let error = error.value(value.py()).to_string();
        PyTypeError::new_err(format!("{name}: not an array: {error}"))
    })?;
    Ok(array.cast_into::<PyUntypedArray>()?)
}

/// Refuses an array whose shape is not `(n, 3)`.
fn check_triples(array: &Bound<'_, PyUntypedArray>, name: &str) -> PyResult<()> {
    if array.ndim() == 2 && array.shape()[1] == 3 {
        return Ok(());
    }
    Err(PyValueError::new_err(format!(
        "{name}: the shape is {}, but (n, 3) is needed",
        shape_of(array)
    )))
}

pub(crate) fn shape_of(array: &Bound<'_, PyUntypedArray>) -> String {
    match array.shape() {
        [n] => format!("({n},)"),
        shape => {
            let sizes: Vec<String> = shape.iter().map(ToString::to_string).collect();
            format!("({})", sizes.join(", "))
        }
    }
}

/// The array converted by NumPy to the number type `to`.
fn converted<'py>(
    array: &Bound<'py, PyUntypedArray>,
    to: &str,
) -> PyResult<Bound<'py, PyUntypedArray>> {
    let made = array.call_method1("astype", (to,))?;
    Ok(made.cast_into::<PyUntypedArray>()?)
}

fn wrong_type(array: &Bound<'_, PyUntypedArray>, name: &str, wanted: &str) -> PyErr {
    PyTypeError::new_err(format!(
        "{name}: the type is {}, but {wanted} are needed",
        array.dtype()
    ))
}

fn views<'py, T: Element>(array: &Bound<'py, PyUntypedArray>) -> Option<PyReadonlyArray2<'py, T>> {
    let array = array.as_any().cast::<PyArray2<T>>().ok()?;
    array.try_readonly().ok()
}

/// The rows of an array, or the index of the first row with a number that cannot be converted, and
/// that number.
type Rows<T, U> = Result<Vec<[U; 3]>, (usize, T)>;

/// The rows of an `(n, 3)` array with each number converted by `convert`. The outer error is a lack
/// of memory, the inner one a number for which `convert` returns `None`.
fn rows<T: Element + Copy, U: Copy + Default>(
    view: ArrayView2<'_, T>,
    convert: impl Fn(T) -> Option<U>,
) -> PyResult<Rows<T, U>> {
    let mut rows: Vec<[U; 3]> = Vec::new();
    rows.try_reserve_exact(view.nrows())
        .map_err(|error| PyMemoryError::new_err(error.to_string()))?;
    for (i, row) in view.outer_iter().enumerate() {
        let mut numbers = [U::default(); 3];
        for (k, number) in numbers.iter_mut().enumerate() {
            match convert(row[k]) {
                Some(converted) => *number = converted,
                None => return Ok(Err((i, row[k]))),
            }
        }
        rows.push(numbers);
    }
    Ok(Ok(rows))
}

/// Reads positions: an `(n, 3)` array of real numbers. `name` is the argument's, for messages.
pub(crate) fn positions(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<[f64; 3]>> {
    let mut array = array_of(value, name)?;
    check_triples(&array, name)?;
    match array.dtype().kind() {
        b'f' => {}
        b'i' | b'u' => array = converted(&array, "float64")?,
        _ => return Err(wrong_type(&array, name, "real numbers")),
    }
    if let Some(view) = views::<f32>(&array) {
        return Ok(rows(view.as_array(), |x| Some(f64::from(x)))?.unwrap_or_default());
    }
    if views::<f64>(&array).is_none() {
        // Half or extended precision, or another byte order.
        array = converted(&array, "float64")?;
    }
    let view = views::<f64>(&array).ok_or_else(|| wrong_type(&array, name, "real numbers"))?;
    Ok(rows(view.as_array(), Some)?.unwrap_or_default())
}

/// Reads a vector: three real numbers.
pub(crate) fn vector(value: &Bound<'_, PyAny>, name: &str) -> PyResult<[f64; 3]> {
    let array = array_of(value, name)?;
    if array.shape() != [3] {
        return Err(PyValueError::new_err(format!(
            "{name}: the shape is {}, but (3,) is needed",
            shape_of(&array)
        )));
    }
    let numbers = reals(array.as_any(), name)?;
    Ok(std::array::from_fn(|k| numbers[k]))
}

/// Reads triangles: an `(m, 3)` array of vertex numbers.
pub(crate) fn triangles(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<[u32; 3]>> {
    let mut array = array_of(value, name)?;
    if array.is_empty() && array.shape() == [0] {
        return Ok(Vec::new());
    }
    check_triples(&array, name)?;
    if !matches!(array.dtype().kind(), b'i' | b'u') {
        return Err(wrong_type(&array, name, "integers"));
    }
    let named = |found: Result<Vec<[u32; 3]>, (usize, i128)>| {
        found.map_err(|(face, vertex)| {
            let message =
                format!("{name}: face {face} names vertex {vertex}; vertices are numbered from 0");
            mesh_error(value.py(), message, Vec::new())
        })
    };
    macro_rules! try_as {
        ($($number:ty),*) => {
            $(if let Some(view) = views::<$number>(&array) {
                let found = rows(view.as_array(), |v| u32::try_from(v).ok())?;
                return named(found.map_err(|(face, vertex)| (face, i128::from(vertex))));
            })*
        };
    }
    try_as!(i64, i32, u32, u64);
    array = converted(&array, "int64")?;
    try_as!(i64);
    Err(wrong_type(&array, name, "integers"))
}

/// Reads a one-dimensional array of real numbers.
pub(crate) fn reals(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<f64>> {
    let mut array = array_of(value, name)?;
    if array.ndim() != 1 {
        return Err(PyValueError::new_err(format!(
            "{name}: the shape is {}, but one dimension is needed",
            shape_of(&array)
        )));
    }
    if array.is_empty() {
        return Ok(Vec::new());
    }
    if !matches!(array.dtype().kind(), b'f' | b'i' | b'u') {
        return Err(wrong_type(&array, name, "real numbers"));
    }
    if array.as_any().cast::<PyArray1<f64>>().is_err() {
        array = converted(&array, "float64")?;
    }
    let array = array.as_any().cast::<PyArray1<f64>>()?;
    Ok(array.readonly().as_array().to_vec())
}

/// Reads distances: an array of one real number per vertex, none of them NaN or negative.
pub(crate) fn distances(
    value: &Bound<'_, PyAny>,
    name: &str,
    vertices: usize,
) -> PyResult<Vec<f64>> {
    let array = array_of(value, name)?;
    if array.ndim() != 1 || array.shape()[0] != vertices {
        return Err(PyValueError::new_err(format!(
            "{name}: the shape is {}, but ({vertices},) is needed, a distance for each vertex",
            shape_of(&array)
        )));
    }
    let distances = reals(array.as_any(), name)?;
    match distances.iter().position(|d| d.is_nan() || *d < 0.0) {
        None => Ok(distances),
        Some(v) => Err(PyValueError::new_err(format!(
            "{name}: the distance of vertex {v} is {}",
            if distances[v].is_nan() {
                "not a number"
            } else {
                "negative"
            }
        ))),
    }
}

/// Reads `count` numbers of elements from 0 on.
pub(crate) fn numbers(value: &Bound<'_, PyAny>, name: &str, count: usize) -> PyResult<Vec<u32>> {
    let array = array_of(value, name)?;
    if array.ndim() != 1 || array.len() != count {
        return Err(PyValueError::new_err(format!(
            "{name}: the shape of the faces is {}, but ({count},) is needed",
            shape_of(&array)
        )));
    }
    if !matches!(array.dtype().kind(), b'i' | b'u') {
        return Err(wrong_type(&array, name, "integers"));
    }
    let array = converted(&array, "int64")?;
    let numbers = array.as_any().cast::<PyArray1<i64>>()?.readonly();
    let numbers = numbers.as_array();
    let each = numbers.iter().map(|&number| {
        u32::try_from(number)
            .map_err(|_| PyIndexError::new_err(format!("{name}: face {number} does not exist")))
    });
    each.collect()
}

/// Reads a count, called `name` in messages, of at least `least`.
pub(crate) fn count(value: i64, name: &str, least: u32) -> PyResult<usize> {
    match usize::try_from(value) {
        Ok(count) if count >= least as usize => Ok(count),
        _ => Err(PyValueError::new_err(format!(
            "{name}: {value}, but at least {least} is needed"
        ))),
    }
}

/// Reads polygons: a list of sequences of vertex numbers.
pub(crate) fn polygons(value: &Bound<'_, PyList>, name: &str) -> PyResult<Vec<Vec<u32>>> {
    let each = value.iter().enumerate().map(|(face, corners)| {
        // So that Ctrl-C ends the call.
        if face.is_multiple_of(1 << 12) {
            value.py().check_signals()?;
        }
        // Bytes and truth values would be read as numbers.
        let array = array_of(&corners, name)?;
        let corners: Option<Vec<i64>> = match array.dtype().kind() {
            b'i' | b'u' => corners.extract().ok(),
            _ => None,
        };
        let corners = corners.ok_or_else(|| {
            PyTypeError::new_err(format!(
                "{name}: face {face} is no sequence of vertex numbers"
            ))
        })?;
        let number = |&v: &i64| {
            u32::try_from(v).map_err(|_| {
                let message =
                    format!("{name}: face {face} names vertex {v}; vertices are numbered from 0");
                mesh_error(value.py(), message, Vec::new())
            })
        };
        corners.iter().map(number).collect()
    });
    each.collect()
}
