//! Answers: the library's own with the query that was asked, frozen.
//!
//! Arrays, points and features, the contacts in an answer and its proof are made on access. A *last*
//! contact is the first one of the query turned round, and keeps that query, as in the library.

use std::fs;
use std::path::Path;

use colltrans::record::{Dents, Record};
use pyo3::PyClass;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// An answer of the library's, of any of its types.
pub(crate) trait Answer: Serialize + DeserializeOwned + Send {
    /// The class of what is asked.
    type Query: PyClass;

    /// As Python has it: a class for each case.
    fn object<'py>(self, query: &Bound<'py, Self::Query>) -> PyResult<Bound<'py, PyAny>>;

    /// What it says, as the command line writes it.
    fn record(&self, query: &Bound<'_, Self::Query>) -> PyResult<Record>;

    /// Its proof, as a file.
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

/// An object of a class of Python.
pub(crate) fn object<T>(py: Python<'_>, of: T) -> PyResult<Bound<'_, PyAny>>
where
    T: PyClass + Into<PyClassInitializer<T>>,
{
    Ok(Bound::new(py, of)?.into_any())
}

/// Writes a file of text, with an end of line.
pub(crate) fn save(path: &Path, text: String) -> PyResult<()> {
    fs::write(path, text + "\n").map_err(|error| {
        let words = error.to_string();
        let words = words.split(" (os error").next().unwrap_or_default().to_owned();
        // Of these arguments Python makes the subclass, such as FileNotFoundError, and the name in its words.
        PyOSError::new_err((error.raw_os_error(), words, path.to_owned()))
    })
}

/// What all classes of answers have. `$again` makes the library's answer once more of one of them.
macro_rules! answer {
    ($class:ident($($name:literal),*) of $of:ty, $query:ident, |$it:ident| $again:expr) => {
        $crate::frozen::match_args!($class($($name),*));

        $crate::frozen::getters!($class, |it| {
            /// Cast or SolidCast or Pair: The query; of a last contact the one turned round.
            query(py): Py<$query> = it.query.clone_ref(py);
        });

        #[pymethods]
        impl $class {
            /// A picture: see :func:`colltrans.show`.
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

            /// What it says, as plain Python: the fields of ``--json`` of the command line, with the same
            /// bits. None stands for a bound that is infinite.
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

            /// The proof, with all that it is about, as text: the file of ``--save-proof``, which
            /// ``colltrans verify`` and ``python -m colltrans.check`` check. Between solids the question is
            /// asked once more for it.
            ///
            /// Returns
            /// -------
            /// str
            ///
            /// Raises
            /// ------
            /// CaseError
            ///     Of a union of solids that was shrunk or grown as a whole.
            fn proof_json(&self, py: Python<'_>) -> PyResult<String> {
                let $it = self;
                <$of as $crate::answer::Answer>::proof(&$again, self.query.bind(py))
            }

            /// Writes :meth:`proof_json` as a file.
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
