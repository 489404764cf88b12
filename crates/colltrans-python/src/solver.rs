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
/// start : {"center", "ellipsoids", "guess"}
///     The start of the minimisation: the centre of all sections, the contact of two ellipsoids, or the
///     neighbourhood of a solution guessed from a few support points.
/// until : "exit" or float
///     The end of the minimisation: when the features in contact are found to solve the problem, or earlier,
///     when the difference of the bounds falls to this fraction of the extent of both bodies along the
///     direction.
/// cuts : {"shifted", "centroid"}
///     The value at which the region of levels is cut: the least one found, or that of the planar problem as
///     in the method before the paper.
/// across_cells : bool
///     Whether shifts continue into neighbouring cells, which takes fewer planar problems.
/// cold : bool
///     Whether each planar problem is searched without a hint, as in the paper.
///
/// Raises
/// ------
/// QueryError
///     The start, the end or the cut is unknown.
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
    /// str: The value at which the region of levels is cut.
    cuts: &'static str = it.0.cuts.name();
    /// bool: Whether shifts continue into neighbouring cells.
    across_cells: bool = !it.0.keeps_to_cell;
    /// bool: Whether each planar problem is searched without a hint.
    cold: bool = it.0.starts_cold;
    /// str or float: The end of the minimisation.
    until(py): PyResult<Bound<'py, PyAny>> = Ok(match it.0.until {
        cta::Until::Exit => "exit".into_pyobject(py)?.into_any(),
        cta::Until::Gap(gap) => gap.into_pyobject(py)?.into_any(),
    });
});

#[pymethods]
impl Cta {
    #[new]
    #[pyo3(
        signature = (*, start=None, until=None, cuts=None, across_cells=false, cold=false),
        text_signature = "(*, start='center', until='exit', cuts='shifted', across_cells=False, cold=False)"
    )]
    fn new(
        start: Option<&str>,
        until: Option<&Bound<'_, PyAny>>,
        cuts: Option<&str>,
        across_cells: bool,
        cold: bool,
    ) -> PyResult<Self> {
        let start = parsed::<cta::Start>(start)?;
        let cuts = parsed::<cta::Cuts>(cuts)?;
        let until = match until {
            None => Ok(cta::Until::default()),
            Some(until) => until.str()?.to_str()?.parse::<cta::Until>().map_err(solver_error),
        };
        Ok(Self(
            cta::Options::new(start, until?)
                .with_cuts(cuts)
                .with_keeps_to_cell(!across_cells)
                .with_starts_cold(cold),
        ))
    }

    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyTuple>, Bound<'py, PyDict>)> {
        let named = PyDict::new(py);
        named.set_item("start", self.start())?;
        named.set_item("until", self.until(py)?)?;
        named.set_item("cuts", self.cuts())?;
        named.set_item("across_cells", self.across_cells())?;
        named.set_item("cold", self.cold())?;
        Ok((PyTuple::empty(py), named))
    }

    fn __repr__(&self) -> String {
        let quote = if self.0.until == cta::Until::Exit { "'" } else { "" };
        let mut options = format!("start='{}', until={quote}{}{quote}", self.0.start, self.0.until);
        if self.0.cuts != cta::Cuts::default() {
            options.extend([", cuts='", &self.0.cuts.to_string(), "'"]);
        }
        for (name, is_set) in [("across_cells", self.across_cells()), ("cold", self.cold())] {
            if is_set {
                options.extend([", ", name, "=True"]);
            }
        }
        format!("Cta({options})")
    }
}

/// Parses the name of an option; the default if there is none.
fn parsed<T: Default + std::str::FromStr<Err: std::fmt::Display>>(
    name: Option<&str>,
) -> PyResult<T> {
    name.map_or(Ok(T::default()), |name| name.parse::<T>().map_err(solver_error))
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
