//! Shared parts of frozen classes: names for `match`, pictures, and text for `pickle` and `copy`.
//!
//! `__reduce__` of an answer names the static method `_of` of its class and the serialised state, which restores
//! the same bits. Restored answers are trusted like any pickle; `verify` checks a proof in them as usual. The Python
//! function `show` of the package draws pictures.

use pyo3::PyClass;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;
use serde::de::DeserializeOwned;

pub(crate) type Options<'a, 'py> = &'a Bound<'py, PyDict>;
pub(crate) type Shown<'py> = PyResult<Bound<'py, PyAny>>;

pub(crate) fn show<'py, T>(
    answer: &Bound<'py, T>,
    options: Option<Options<'_, 'py>>,
) -> Shown<'py> {
    let show = answer.py().import("colltrans.pictures")?.getattr("show")?;
    show.call((answer.as_any(),), options)
}

/// Builds the HTML that a notebook shows.
pub(crate) fn html<'py, T>(thing: &Bound<'py, T>) -> Shown<'py> {
    thing.py().import("colltrans.light")?.getattr("html")?.call1((thing.as_any(),))
}

/// The result of `__reduce__`.
pub(crate) type Reduced<'py, T> = (Bound<'py, PyAny>, T);

/// Builds the result of `__reduce__`: the static method `_of` of class `C` and its arguments.
pub(crate) fn reduced<C: PyClass, T>(py: Python<'_>, state: T) -> PyResult<Reduced<'_, T>> {
    Ok((py.get_type::<C>().getattr("_of")?, state))
}

/// Serialises a value to text that restores the same bits.
pub(crate) fn written<T: Serialize>(value: &T) -> PyResult<String> {
    serde_json::to_string(value).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// Deserialises the text of [`written`].
pub(crate) fn read<T: DeserializeOwned>(text: &str) -> PyResult<T> {
    serde_json::from_str(text).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// Converts a value to dictionaries, lists and numbers of Python.
pub(crate) fn plain<'py, T: Serialize>(py: Python<'py>, value: &T) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (written(value)?,))
}

/// Implements pickling for classes that serde serialises.
macro_rules! pickled {
    ($($class:ident),*) => {$(
        #[pyo3::pymethods]
        impl $class {
            fn __reduce__<'py>(
                &self,
                py: pyo3::Python<'py>,
            ) -> pyo3::PyResult<$crate::frozen::Reduced<'py, (String,)>> {
                $crate::frozen::reduced::<Self, _>(py, ($crate::frozen::written(self)?,))
            }

            #[staticmethod]
            #[pyo3(name = "_of")]
            fn of_text(text: &str) -> pyo3::PyResult<Self> {
                $crate::frozen::read(text)
            }
        }
    )*};
}
pub(crate) use pickled;

/// Defines the attributes of a class: documentation, name and type of each, and its value, computed on access.
macro_rules! getters {
    ($class:ident, |$it:ident| {
        $($(#[$documentation:meta])* $name:ident $(($py:ident))?: $type:ty = $value:expr;)*
    }) => {
        #[pyo3::pymethods]
        impl $class {$(
            $(#[$documentation])*
            #[getter]
            #[allow(
                clippy::extra_unused_lifetimes,
                clippy::elidable_lifetime_names,
                reason = "only some values need the interpreter"
            )]
            pub(crate) fn $name<'py>(&self $(, $py: pyo3::Python<'py>)?) -> $type {
                #[allow(unused_variables, reason = "some values are constants")]
                let $it = self;
                $value
            }
        )*}
    };
}
pub(crate) use getters;

/// Defines the attributes by which `match` destructures a class.
macro_rules! match_args {
    ($class:ident($($name:literal),*)) => {
        #[pyo3::pymethods]
        impl $class {
            #[classattr]
            #[pyo3(name = "__match_args__")]
            fn match_args(
                py: pyo3::Python<'_>,
            ) -> pyo3::PyResult<pyo3::Bound<'_, pyo3::types::PyTuple>> {
                pyo3::types::PyTuple::new(py, { const NAMES: &[&str] = &[$($name),*]; NAMES })
            }
        }
    };
}
pub(crate) use match_args;
