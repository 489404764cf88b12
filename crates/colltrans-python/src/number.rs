//! Answers as numbers: one value with proven bounds, conversion to a float, and comparison with numbers.
//!
//! `colltrans.answers` documents for Python what the value of each answer is.

use pyo3::basic::CompareOp;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBool, PyFloat, PyInt, PyType};

/// Returns the middle of two bounds. It is exact for equal bounds.
pub(crate) fn middle(lower: f64, upper: f64) -> f64 {
    if upper.is_finite() { lower + (upper - lower) / 2.0 } else { lower }
}

/// Checks whether an object is a real number, as Python's `numbers.Real` defines it.
fn is_real(other: &Bound<'_, PyAny>) -> PyResult<bool> {
    static REAL: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    if other.is_instance_of::<PyFloat>() || other.is_instance_of::<PyInt>() {
        return Ok(true);
    }
    other.is_instance(REAL.import(other.py(), "numbers", "Real")?)
}

/// Returns the value of an answer for `float`, or a `TypeError` for an answer without one.
pub(crate) fn to_float(answer: &Bound<'_, PyAny>, value: Option<f64>) -> PyResult<f64> {
    value.ok_or_else(|| {
        let class = answer.get_type().name().map_or_else(|_| "answer".into(), |n| n.to_string());
        PyTypeError::new_err(format!(
            "{class} has no number: the question has no answer for these bodies; check its class or outcome first"
        ))
    })
}

/// Compares an answer with a number or with another answer that has a number.
///
/// Two answers are equal if they are the same object. An answer without a number equals no number, and cannot
/// be ordered.
pub(crate) fn compare<'py>(
    answer: &Bound<'py, PyAny>,
    value: Option<f64>,
    other: &Bound<'py, PyAny>,
    operator: CompareOp,
) -> PyResult<Bound<'py, PyAny>> {
    let py = answer.py();
    let real = is_real(other)?;
    let is = |found: bool| -> PyResult<Bound<'py, PyAny>> {
        Ok(PyBool::new(py, found).to_owned().into_any())
    };
    if matches!(operator, CompareOp::Eq | CompareOp::Ne) {
        let equal = if real {
            value.is_some_and(|value| other.extract::<f64>().is_ok_and(|other| value == other))
        } else if other.hasattr("__array__")? {
            return Ok(py.NotImplemented().into_bound(py));
        } else {
            answer.is(other)
        };
        return is(equal == matches!(operator, CompareOp::Eq));
    }
    let is_answer = !real && other.hasattr("value")? && other.hasattr("__float__")?;
    if !real && !is_answer {
        return Ok(py.NotImplemented().into_bound(py));
    }
    let (value, other) = (to_float(answer, value)?, other.extract::<f64>()?);
    is(value.partial_cmp(&other).is_some_and(|order| operator.matches(order)))
}

/// Defines the value of an answer, its conversion to a float and its comparison.
///
/// The class has the getters `lower` and `upper` of its bounds. `$value` is an `Option<f64>`.
macro_rules! number {
    ($class:ident, $type:ty, |$it:pat_param| $value:expr, $(#[$doc:meta])*) => {
        #[pymethods]
        impl $class {
            $(#[$doc])*
            #[getter]
            fn value(&self) -> PyResult<$type> {
                let $it = self;
                Ok($value)
            }

            fn __float__(slf: &Bound<'_, Self>) -> PyResult<f64> {
                $crate::number::to_float(slf.as_any(), slf.get().value()?.into())
            }

            fn __richcmp__<'py>(
                slf: &Bound<'py, Self>,
                other: &Bound<'py, PyAny>,
                operator: pyo3::basic::CompareOp,
            ) -> PyResult<Bound<'py, PyAny>> {
                $crate::number::compare(slf.as_any(), slf.get().value()?.into(), other, operator)
            }

            fn __hash__(slf: &Bound<'_, Self>) -> isize {
                slf.as_ptr() as isize >> 4
            }
        }
    };
}
pub(crate) use number;
