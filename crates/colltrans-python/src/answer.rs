//! Answers: frozen objects that hold the library's answer and the query.
//!
//! Arrays, points, features, the contacts in an answer and its proof are built on access. A *last* contact is
//! the first contact of the reversed query, as in the library. The contact of a `Behind` holds the reversed query.
//! A `LastContact` holds both queries.

use std::path::Path;
use std::{fs, io};

use colltrans::record::{Dents, Record};
use pyo3::PyClass;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// An answer type of the library that becomes a Python object.
pub(crate) trait Answer: Serialize + DeserializeOwned + Send {
    /// The Python class of the query.
    type Query: PyClass;

    /// Converts the answer to an object of the Python class for its case.
    fn object<'py>(self, query: &Bound<'py, Self::Query>) -> PyResult<Bound<'py, PyAny>>;

    /// Returns the record of the answer, with the fields that the command line writes.
    fn record(&self, query: &Bound<'_, Self::Query>) -> PyResult<Record>;

    /// Returns the proof of the answer as the text of a proof file.
    fn proof(&self, query: &Bound<'_, Self::Query>) -> PyResult<String>;
}

/// A record with the dents of both bodies.
#[derive(Serialize)]
pub(crate) struct WithDents {
    #[serde(flatten)]
    pub(crate) record: Record,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) dents: Option<Dents>,
}

/// Builds a Python object of a class.
pub(crate) fn object<T>(py: Python<'_>, of: T) -> PyResult<Bound<'_, PyAny>>
where
    T: PyClass + Into<PyClassInitializer<T>>,
{
    Ok(Bound::new(py, of)?.into_any())
}

/// Writes a text and a newline to a file.
pub(crate) fn save(path: &Path, text: String) -> PyResult<()> {
    fs::write(path, text + "\n").map_err(|error| write_error(path, &error))
}

/// Converts the error of writing a file.
pub(crate) fn write_error(path: &Path, error: &io::Error) -> PyErr {
    let words = error.to_string();
    let words = words.split(" (os error").next().unwrap_or_default().to_owned();
    // With these arguments Python creates the subclass, such as FileNotFoundError, and adds the file name to the
    // message.
    PyOSError::new_err((error.raw_os_error(), words, path.to_owned()))
}

/// Defines the members that all answer classes share. `$again` rebuilds the library's answer from an object.
macro_rules! answer {
    ($class:ident($($name:literal),*) of $of:ty, $query:ident, |$it:ident| $again:expr) => {
        $crate::frozen::match_args!($class($($name),*));

        $crate::frozen::getters!($class, |it| {
            /// Cast or SolidCast or Pair or MotionCast: The query. The contact of a :class:`Behind` has the
            /// reversed query.
            query(py): Py<$query> = it.query.clone_ref(py);
        });

        #[pymethods]
        impl $class {
            /// Draws a picture; see :func:`colltrans.show`.
            #[pyo3(signature = (**options))]
            fn show<'py>(
                slf: &Bound<'py, Self>,
                options: Option<$crate::frozen::Options<'_, 'py>>,
            ) -> $crate::frozen::Shown<'py> {
                $crate::frozen::show(slf, options)
            }

            fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> $crate::frozen::Shown<'py> {
                $crate::frozen::html(slf)
            }

            /// Returns the answer as plain Python: the fields that ``--json`` of the command line writes,
            /// with the same bits.
            ///
            /// None stands for an infinite bound.
            ///
            /// Returns
            /// -------
            /// dict
            fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                let $it = self;
                let record =
                    <$of as $crate::answer::Answer>::record(&$again, self.query.bind(py))?;
                let dents = self.query.get().dents();
                $crate::frozen::plain(py, &$crate::answer::WithDents { record, dents })
            }

            /// Returns the proof with everything that it refers to, as text.
            ///
            /// The text is a file of ``--save-proof``, which ``colltrans verify`` and ``python -m
            /// colltrans.check`` check. Between solids the query runs again to build it.
            ///
            /// Returns
            /// -------
            /// str
            ///
            /// Raises
            /// ------
            /// CaseError
            ///     The answer is about a union of solids that was shrunk or grown as a whole, or is an
            ///     :class:`OverlapDepth`.
            /// CertificateError
            ///     The answer is a :class:`MotionClearance` of bodies that overlap at the start of the motion, or
            ///     whose overlaps there are ignored.
            fn proof_json(&self, py: Python<'_>) -> PyResult<String> {
                let $it = self;
                <$of as $crate::answer::Answer>::proof(&$again, self.query.bind(py))
            }

            /// Writes :meth:`proof_json` to a file.
            ///
            /// Parameters
            /// ----------
            /// path : str or os.PathLike
            fn save_proof(&self, py: Python<'_>, path: std::path::PathBuf) -> PyResult<()> {
                $crate::answer::save(&path, self.proof_json(py)?)
            }

            fn __reduce__<'py>(
                &self,
                py: Python<'py>,
            ) -> PyResult<$crate::frozen::Reduced<'py, (Py<$query>, String)>> {
                let $it = self;
                let state = (self.query(py), $crate::frozen::written::<$of>(&$again)?);
                $crate::frozen::reduced::<Self, _>(py, state)
            }

            #[staticmethod]
            fn _of<'py>(query: &Bound<'py, $query>, text: &str) -> PyResult<Bound<'py, PyAny>> {
                $crate::answer::Answer::object($crate::frozen::read::<$of>(text)?, query)
            }
        }
    };
}
pub(crate) use answer;
