//! Trackers for sequences of similar queries.
//!
//! The library's tracker borrows its bodies, so both are stored in one cell. Other bodies get a new cell,
//! because a tracker does not use its memory of other bodies anyway.

use colltrans::{Focus, QueryError, cta};
use pyo3::prelude::*;
use self_cell::self_cell;

use crate::answer::Answer;
use crate::body::ConvexPolyhedron;
use crate::errors::error;
use crate::features::Steps;
use crate::query::{Arguments, Cast};

type Bodies = [Py<ConvexPolyhedron>; 2];
type Borrowing<'a> = colltrans::Tracker<'a>;

self_cell!(
    struct Tracked {
        owner: Bodies,
        #[not_covariant]
        dependent: Borrowing,
    }
);

/// A tracker for sequences of similar queries. Each query starts from the previous answer.
///
/// Answers are as accurate as those of the functions with the same names; the normal and the points may differ if
/// vertices or parallel edges meet. Poses, directions and bodies may change arbitrarily: a poor start only costs
/// time.
///
/// Parameters
/// ----------
/// features : bool, optional
///     Whether a query starts from the features in contact of the last answer. The default is yes, unless the
///     solver is "cta", which starts as in the paper in the region around the last solution, or unless a
///     region is given.
/// region : "automatic", "everywhere" or float, optional
///     The region of section levels in which "cta" starts: a square with this half-side, a length. With
///     "automatic" the half-side follows from the change since the last query. With "everywhere" there is no
///     region.
///
/// Raises
/// ------
/// QueryError
///     The region is an unknown name, negative or not a number.
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron, Tracker
/// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
/// >>> tracker = Tracker()
/// >>> for x in (0.0, 0.1, 0.2):
/// ...     contact = tracker.cast(cube, cube, [0, 0, -1], moving_pose=[x, 0.2, 4])
/// ...     print(contact.translation, contact.steps.started_from)
/// 3.0 scratch
/// 3.0 features
/// 3.0 features
#[pyclass(module = "colltrans")]
pub(crate) struct Tracker {
    tracked: Option<Tracked>,
    focus: Option<Focus>,
    steps: colltrans::Steps,
}

impl Tracker {
    /// Runs a query with the library's tracker for these bodies.
    fn ask<T>(
        &mut self,
        py: Python<'_>,
        query: &Cast,
        question: impl for<'a> FnOnce(&mut Borrowing<'a>, &colltrans::Cast<'a>) -> Result<T, QueryError>,
    ) -> PyResult<T> {
        let bodies = [&query.moving, &query.fixed];
        let same = |cell: &Tracked| {
            let known = cell.borrow_owner();
            known[0].is(bodies[0]) && known[1].is(bodies[1])
        };
        if !self.tracked.as_ref().is_some_and(same) {
            let owned = bodies.map(|body| body.clone_ref(py));
            let begun = match self.focus {
                None => Borrowing::new(),
                Some(focus) => {
                    Borrowing::new().with_focus(focus).map_err(|e| error("QueryError", &e))?
                }
            };
            self.tracked = Some(Tracked::new(owned, |_| begun));
        }
        let Some(cell) = &mut self.tracked else {
            return Err(error("ColltransError", "no bodies"));
        };
        let (answer, steps) = cell.with_dependent_mut(|[moving, fixed], tracker| {
            let moving = moving.get().0.at(query.poses[0]);
            let fixed = fixed.get().0.at(query.poses[1]);
            let cast = colltrans::Cast::new(moving, fixed, query.direction)
                .and_then(|cast| cast.with_options(query.options));
            (cast.and_then(|cast| question(tracker, &cast)), tracker.steps())
        });
        self.steps = steps;
        answer.map_err(|what| query.error(&what))
    }
}

/// Reads the options of a tracker. Missing options have their defaults.
fn tracker_focus(
    features: Option<bool>,
    region: Option<&Bound<'_, PyAny>>,
) -> PyResult<Option<Focus>> {
    if features.is_none() && region.is_none() {
        return Ok(None);
    }
    let focus = Focus::default().with_features(features.unwrap_or(false));
    let Some(region) = region else { return Ok(Some(focus)) };
    let region = match region.extract::<f64>() {
        Ok(half_side) => cta::Region::Fixed(half_side),
        Err(_) => match region.extract::<&str>()? {
            "automatic" => cta::Region::Automatic,
            "everywhere" => cta::Region::Everywhere,
            other => {
                let known = format_args!(
                    "unknown region {other:?}; accepted: automatic, everywhere, or a length"
                );
                return Err(error("QueryError", known));
            }
        },
    };
    let focus = focus.with_region(region);
    colltrans::Tracker::new().with_focus(focus).map_err(|e| error("QueryError", &e))?;
    Ok(Some(focus))
}

/// Defines the query methods of a tracker.
macro_rules! questions {
    ($($(#[$doc:meta])* $name:ident => $ask:ident;)*) => {
        #[pymethods]
        impl Tracker {
            #[new]
            #[pyo3(signature = (*, features=None, region=None))]
            fn new(features: Option<bool>, region: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
                let focus = tracker_focus(features, region)?;
                Ok(Self { tracked: None, focus, steps: colltrans::Steps::default() })
            }

            /// Discards the last answer: the next query starts from scratch.
            fn reset(&mut self) {
                self.tracked = None;
            }

            /// Steps: Number of steps of the last query, in all its casts together.
            #[getter]
            fn steps(&self) -> Steps {
                Steps(self.steps)
            }

            fn __repr__(&self) -> &'static str {
                if self.tracked.is_some() { "Tracker(with an answer)" } else { "Tracker()" }
            }

            $(
                $(#[$doc])*
                #[pyo3(signature = (moving, fixed, direction, *, moving_pose=None, fixed_pose=None,
                    graze_tolerance=0.0, min_gap=0.0, solver=None), text_signature = "($self, \
                    moving, fixed, direction, *, moving_pose=None, fixed_pose=None, \
                    graze_tolerance=0.0, min_gap=0.0, solver='auto')")]
                #[expect(clippy::too_many_arguments, reason = "they are keywords")]
                fn $name<'py>(
                    &mut self,
                    py: Python<'py>,
                    moving: &Bound<'py, PyAny>,
                    fixed: &Bound<'py, PyAny>,
                    direction: &Bound<'py, PyAny>,
                    moving_pose: Option<&Bound<'py, PyAny>>,
                    fixed_pose: Option<&Bound<'py, PyAny>>,
                    graze_tolerance: f64,
                    min_gap: f64,
                    solver: Option<&Bound<'py, PyAny>>,
                ) -> PyResult<Bound<'py, PyAny>> {
                    let poses = [moving_pose, fixed_pose];
                    let arguments = Arguments {
                        moving,
                        fixed,
                        direction,
                        poses,
                        graze_tolerance,
                        min_gap,
                        solver,
                    };
                    let query = Bound::new(py, Cast::from_arguments(arguments)?)?;
                    self.ask(py, query.get(), |tracker, cast| tracker.$ask(cast))?.object(&query)
                }
            )*
        }
    };
}

questions! {
    /// Runs :func:`cast` from the last answer.
    cast => first_contact;
    /// Runs :func:`contact_range` from the last answer.
    contact_range => contact_range;
    /// Runs :func:`clearance` from the last answer.
    clearance => clearance;
    /// Runs :func:`directional_depth` from the last answer.
    directional_depth => directional_depth;
    /// Runs :func:`intersects` from the last answer to this question.
    intersects => intersects;
}
