//! Search algorithms: a solver by name, or the paper's algorithm with its options.

use colltrans::{Options, Solver, cta};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::errors::error;
use crate::frozen::getters;

/// The paper's algorithm with its options, as a value of ``solver``.
///
/// Parameters
/// ----------
/// start : {"center", "ellipsoids"}
///     The start of the minimisation: the centre of all sections, or the contact of two ellipsoids.
/// until : "exit" or float
///     The end of the minimisation: when the features in contact are found to solve the problem, or earlier,
///     when the difference of the bounds falls to this fraction of the extent of both bodies along the
///     direction.
///
/// Raises
/// ------
/// QueryError
///     The start or the end is unknown.
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron, Cta, cast
/// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
/// >>> nearly = Cta(until=0.1)
/// >>> nearly
/// Cta(start='center', until=0.1)
/// >>> cast(cube, cube, [1, 0, 0], moving_pose=[-3, 0.5, 0], solver=nearly).translation
/// 2.0
#[pyclass(frozen, eq, module = "colltrans")]
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Cta(cta::Options);

getters!(Cta, |it| {
    /// str: The start of the minimisation.
    start: &'static str = it.0.start.name();
    /// str or float: The end of the minimisation.
    until(py): PyResult<Bound<'py, PyAny>> = Ok(match it.0.until {
        cta::Until::Exit => "exit".into_pyobject(py)?.into_any(),
        cta::Until::Gap(gap) => gap.into_pyobject(py)?.into_any(),
    });
});

#[pymethods]
impl Cta {
    #[new]
    #[pyo3(signature = (*, start=None, until=None), text_signature = "(*, start='center', until='exit')")]
    fn new(start: Option<&str>, until: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let cta::Options { start: default, .. } = cta::Options::default();
        let start =
            start.map_or(Ok(default), |name| name.parse::<cta::Start>().map_err(solver_error));
        let until = match until {
            None => Ok(cta::Until::default()),
            Some(until) => until.str()?.to_str()?.parse::<cta::Until>().map_err(solver_error),
        };
        Ok(Self(cta::Options::new(start?, until?)))
    }

    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyTuple>, Bound<'py, PyDict>)> {
        let named = PyDict::new(py);
        named.set_item("start", self.start())?;
        named.set_item("until", self.until(py)?)?;
        Ok((PyTuple::empty(py), named))
    }

    fn __repr__(&self) -> String {
        let quote = if self.0.until == cta::Until::Exit { "'" } else { "" };
        format!("Cta(start='{}', until={quote}{}{quote})", self.0.start, self.0.until)
    }
}

fn solver_error(what: impl std::fmt::Display) -> PyErr {
    error("QueryError", what)
}

/// Returns options with the given solver; the default is `auto`.
pub(crate) fn options_of(solver: Option<&Bound<'_, PyAny>>) -> PyResult<Options> {
    let options = Options::default();
    let Some(solver) = solver else { return Ok(options) };
    if let Ok(cta) = solver.cast::<Cta>() {
        return Ok(options.with_solver(Solver::Cta).with_narrowing(cta.get().0));
    }
    let name: &str = solver.extract()?;
    let unknown = |_| {
        error(
            "QueryError",
            format_args!("unknown solver {name:?}; known solvers: auto, cta, portal"),
        )
    };
    Ok(options.with_solver(name.parse().map_err(unknown)?))
}
