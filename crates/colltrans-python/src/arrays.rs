//! Conversion of numbers between Python and the library.
//!
//! Small arguments (directions, poses) are read here if they are tuples or lists of numbers, or aligned arrays in
//! native double precision, strided or not. `get_owned` copies one number and borrows nothing. All other
//! arguments go through `colltrans._arrays`, which accepts what numpy accepts and reports what is wrong
//! otherwise.

use colltrans::glam::DVec3;
use numpy::{
    Element, IntoPyArray, PyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1,
    PyReadonlyArray2, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt, PyList, PyTuple};

use crate::errors::input_error;

/// An array of numbers for Python.
pub(crate) type Vector<'py> = Bound<'py, PyArray1<f64>>;
/// An array of indices for Python.
pub(crate) type Indices<'py> = Bound<'py, PyArray1<u32>>;

/// Up to 4 x 4 numbers.
pub(crate) struct Numbers {
    pub(crate) values: [f64; 16],
    pub(crate) shape: Shape,
}

/// The shape of the numbers. If they do not fit, only the shape is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shape {
    Row(usize),
    Table(usize, usize),
}

impl Shape {
    /// Formats the shape as numpy does.
    pub(crate) fn text(self) -> String {
        match self {
            Self::Row(n) => format!("({n},)"),
            Self::Table(rows, columns) => format!("({rows}, {columns})"),
        }
    }
}

/// Reads the numbers of the argument called `name`.
pub(crate) fn numbers(of: &Bound<'_, PyAny>, name: &str) -> PyResult<Numbers> {
    if let Some(found) = plain_numbers(of) {
        return Ok(found);
    }
    let array = python_helper(of.py(), "floats")?.call1((of, name))?;
    numbers_from_array(&array)
        .ok_or_else(|| wrong_shape_error(&array, name, "a row or a table of numbers"))
}

/// Reads a tuple or list of numbers, or an aligned array in double precision; `None` for anything else.
#[inline]
pub(crate) fn plain_numbers(of: &Bound<'_, PyAny>) -> Option<Numbers> {
    numbers_from_sequence(of).or_else(|| numbers_from_array(of))
}

/// Reads a vector with three coordinates.
pub(crate) fn vector(of: &Bound<'_, PyAny>, name: &str) -> PyResult<DVec3> {
    let Numbers { values: [x, y, z, ..], shape } = numbers(of, name)?;
    if shape == Shape::Row(3) {
        Ok(DVec3::new(x, y, z))
    } else {
        Err(input_error(name, format_args!("an array of shape {}, not (3,)", shape.text())))
    }
}

fn numbers_from_sequence(of: &Bound<'_, PyAny>) -> Option<Numbers> {
    if let Ok(tuple) = of.cast::<PyTuple>() {
        numbers_from_items(tuple.len(), tuple.iter())
    } else if let Ok(list) = of.cast::<PyList>() {
        numbers_from_items(list.len(), list.iter())
    } else {
        None
    }
}

fn numbers_from_items<'py>(
    n: usize,
    items: impl Iterator<Item = Bound<'py, PyAny>>,
) -> Option<Numbers> {
    let mut values = [0.0; 16];
    if n > values.len() {
        return None;
    }
    for (value, item) in values.iter_mut().zip(items) {
        if !item.is_exact_instance_of::<PyFloat>() && !item.is_exact_instance_of::<PyInt>() {
            return None;
        }
        *value = item.extract().ok()?;
    }
    Some(Numbers { values, shape: Shape::Row(n) })
}

fn numbers_from_array(of: &Bound<'_, PyAny>) -> Option<Numbers> {
    let mut values = [0.0; 16];
    // A subclass of an array may hide some of its numbers, as masked arrays do.
    if !of.get_type().is(of.py().get_type::<PyUntypedArray>()) {
        return None;
    }
    if let Ok(array) = of.cast::<PyArray1<f64>>() {
        let n = array.len();
        if n <= values.len() && is_aligned(array) {
            for (i, value) in values.iter_mut().take(n).enumerate() {
                *value = array.get_owned([i])?;
            }
        } else if n <= values.len() {
            return None;
        }
        return Some(Numbers { values, shape: Shape::Row(n) });
    }
    let array = of.cast::<PyArray2<f64>>().ok()?;
    let &[rows, columns] = array.shape() else { return None };
    if rows <= 4 && columns <= 4 {
        if !is_aligned(array) {
            return None;
        }
        for i in 0..rows {
            for j in 0..columns {
                values[i * columns + j] = array.get_owned([i, j])?;
            }
        }
    }
    Some(Numbers { values, shape: Shape::Table(rows, columns) })
}

fn is_aligned<D: numpy::ndarray::Dimension>(array: &Bound<'_, PyArray<f64, D>>) -> bool {
    let size = size_of::<f64>() as isize;
    array.data().is_aligned() && array.strides().iter().all(|stride| stride % size == 0)
}

/// Reads points: an array of shape `(N, 3)`.
pub(crate) fn points(of: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<DVec3>> {
    let array = python_helper(of.py(), "floats")?.call1((of, name))?;
    let refused = || wrong_shape_error(&array, name, "(N, 3)");
    // numpy converts an empty list to a row.
    if array.cast::<PyArray1<f64>>().is_ok_and(|row| row.is_empty()) {
        return Ok(Vec::new());
    }
    let table: PyReadonlyArray2<'_, f64> = array.extract().map_err(|_| refused())?;
    let (values, rest) = table.as_slice().map_err(|_| refused())?.as_chunks::<3>();
    if table.shape()[1] != 3 || !rest.is_empty() {
        return Err(refused());
    }
    Ok(values.iter().copied().map(DVec3::from_array).collect())
}

/// Reads faces as lists of vertex indices.
pub(crate) fn faces(of: &Bound<'_, PyAny>) -> PyResult<Vec<Vec<u32>>> {
    let runs = python_helper(of.py(), "faces")?.call1((of,))?;
    let (corners, ends): (PyReadonlyArray1<'_, u32>, PyReadonlyArray1<'_, u32>) = runs.extract()?;
    let (corners, ends) = (corners.as_slice()?, ends.as_slice()?);
    Ok(ends.windows(2).map(|w| corners[w[0] as usize..w[1] as usize].to_vec()).collect())
}

/// Returns a function of `colltrans._arrays`.
fn python_helper<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("colltrans._arrays")?.getattr(name)
}

fn wrong_shape_error(array: &Bound<'_, PyAny>, name: &str, wanted: &str) -> PyErr {
    let shape = array.getattr("shape").map_or_else(|_| "?".into(), |shape| shape.to_string());
    input_error(name, format_args!("an array of shape {shape}, not {wanted}"))
}

/// Marks an array as read-only, because writing to it would change nothing in the library.
pub(crate) fn read_only<T: Element, D: numpy::ndarray::Dimension>(
    array: Bound<'_, PyArray<T, D>>,
) -> Bound<'_, PyArray<T, D>> {
    (*array.readwrite().make_nonwriteable()).clone()
}

/// Converts numbers of vertices or facets to an array.
pub(crate) fn ids<'py, T: Copy + Into<u32>>(py: Python<'py>, of: &[T]) -> Indices<'py> {
    PyArray1::from_iter(py, of.iter().map(|&number| number.into()))
}

/// Converts a vector to an array without -0, as the command line writes it.
pub(crate) fn row(py: Python<'_>, v: DVec3) -> Bound<'_, PyArray1<f64>> {
    PyArray1::from_slice(py, &coordinates(v))
}

/// Returns the coordinates of a vector, with 0 for -0.
pub(crate) fn coordinates(v: DVec3) -> [f64; 3] {
    v.to_array().map(|c| c + 0.0)
}

/// Converts rows of `K` numbers to a table.
pub(crate) fn table<T: Element, const K: usize>(
    py: Python<'_>,
    rows: impl IntoIterator<Item = [T; K]>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let flat: Vec<T> = rows.into_iter().flatten().collect();
    let n = flat.len() / K;
    flat.into_pyarray(py).reshape([n, K])
}
