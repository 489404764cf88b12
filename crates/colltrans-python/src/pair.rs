//! Queries of two bodies at fixed poses, as values.

use colltrans::record::{Dents, PairQuestion};
use colltrans::solid::VolumeOptions;
use colltrans::{ConvexPolyhedron, ProofFile, QueryError, Solid};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::{OrRaise, error};
use crate::frozen::{Options, Shown, html, show};
use crate::pose::Pose;
use crate::solid::Piece;
use crate::solid_cast::{placed_bodies, run_patiently};

/// Two bodies at fixed poses, as a value: query their distance or the depth of their overlap.
///
/// Parameters
/// ----------
/// moving, fixed : ConvexPolyhedron or Solid
///     Neither body moves; the names only distinguish them. If one of them is a solid, both are treated as
///     solids.
/// moving_pose, fixed_pose : array_like or Pose, optional
///     Poses of the bodies in the world; see :class:`Pose`.
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron, Pair
/// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
/// >>> pair = Pair(cube, cube, moving_pose=[-3, 0.5, 0])
/// >>> found = pair.distance()
/// >>> found.lower <= 2 <= found.upper
/// True
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct Pair {
    pub(crate) bodies: [Piece; 2],
    pub(crate) poses: [colltrans::Pose; 2],
}

/// A value for convex bodies or for solids.
#[derive(Clone, Copy, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Of<C, S> {
    Convex(C),
    Solids(S),
}

/// The bodies, and their poses by name.
type Arguments<'py> = ((Py<PyAny>, Py<PyAny>), Bound<'py, PyDict>);

/// The pair of the library.
pub(crate) type AnyPair<'a> = Of<colltrans::Pair<'a>, colltrans::Pair<'a, Solid>>;

impl Pair {
    /// Returns the dents of the two meshes, if these are convex only within the tolerance.
    pub(crate) fn dents(&self) -> Option<Dents> {
        Dents::from_depths(self.bodies.each_ref().map(Piece::dent))
    }

    pub(crate) fn from_arguments(
        moving: &Bound<'_, PyAny>,
        fixed: &Bound<'_, PyAny>,
        poses: [Option<&Bound<'_, PyAny>>; 2],
    ) -> PyResult<Self> {
        let (moving, moving_pose) = Piece::placed(moving, poses[0], "moving")?;
        let (fixed, fixed_pose) = Piece::placed(fixed, poses[1], "fixed")?;
        Ok(Self { bodies: [moving, fixed], poses: [moving_pose, fixed_pose] })
    }

    /// Builds the pair of the library.
    pub(crate) fn asked(&self) -> PyResult<AnyPair<'_>> {
        let [at, to] = self.poses;
        let pair = if let [Piece::Convex(p), Piece::Convex(q)] = &self.bodies {
            let (p, q): (&ConvexPolyhedron, &ConvexPolyhedron) = (&p.get().0, &q.get().0);
            colltrans::Pair::new(p.at(at), q.at(to)).map(Of::Convex)
        } else {
            return self.solids().map(Of::Solids);
        };
        pair.or_raise()
    }

    /// Builds the pair of the library, with both bodies as solids.
    pub(crate) fn solids(&self) -> PyResult<colltrans::Pair<'_, Solid>> {
        let [p, q] = [self.bodies[0].solid().or_raise()?, self.bodies[1].solid().or_raise()?];
        colltrans::Pair::new(p.at(self.poses[0]), q.at(self.poses[1])).or_raise()
    }

    /// Runs a query of the library. Releases the interpreter's lock for solids, and for convex bodies if
    /// `is_long` is set, because such queries take more than a microsecond.
    pub(crate) fn ask<T: Send + 'static>(
        slf: &Bound<'_, Self>,
        is_long: bool,
        question: impl FnOnce(&AnyPair<'_>) -> Result<T, QueryError> + Send + 'static,
    ) -> PyResult<T> {
        let query = slf.clone().unbind();
        let work = move || {
            let failed = |what: QueryError| match what {
                QueryError::NotConverged { .. } => error("NotConvergedError", what),
                what => error("QueryError", what),
            };
            question(&query.get().asked()?).map_err(failed)
        };
        match &slf.get().bodies {
            [Piece::Convex(_), Piece::Convex(_)] if !is_long => work(),
            [Piece::Convex(_), Piece::Convex(_)] => slf.py().detach(work),
            bodies => run_patiently(slf.py(), bodies, work),
        }
    }

    /// Builds the proof between solids, by running the query again.
    pub(crate) fn solid_proof(&self, question: PairQuestion) -> PyResult<ProofFile> {
        let Of::Solids(pair) = self.asked()? else {
            return Err(error("CaseError", "the bodies are convex"));
        };
        let pieces = [self.bodies[0].pieces().or_raise()?, self.bodies[1].pieces().or_raise()?];
        Ok(question.prove_solids(&pair, [&pieces[0], &pieces[1]]).or_raise()?.1)
    }

    /// Builds the proof of the common part. Convex bodies are treated as solids.
    pub(crate) fn common_part_proof(&self, options: VolumeOptions) -> PyResult<ProofFile> {
        let ([p, q], [at, to]) = (&self.bodies, self.poses);
        let [moving, fixed] = [p.solid_with_area().or_raise()?, q.solid_with_area().or_raise()?];
        let pair = colltrans::Pair::new(moving.at(at), fixed.at(to)).or_raise()?;
        let pieces = [p.pieces().or_raise()?, q.pieces().or_raise()?];
        ProofFile::of_solid_common_part(&pair, [&pieces[0], &pieces[1]], options).or_raise()
    }
}

placed_bodies!(Pair);

#[pymethods]
impl Pair {
    #[new]
    #[pyo3(signature = (moving, fixed, *, moving_pose=None, fixed_pose=None))]
    fn new(
        moving: &Bound<'_, PyAny>,
        fixed: &Bound<'_, PyAny>,
        moving_pose: Option<&Bound<'_, PyAny>>,
        fixed_pose: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let query = Self::from_arguments(moving, fixed, [moving_pose, fixed_pose])?;
        query.asked()?;
        Ok(query)
    }

    /// Draws the bodies and the shortest segment between them; see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> Shown<'py> {
        html(slf)
    }

    /// Returns the arguments that build the pair again, for `pickle` and `copy`.
    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<Arguments<'py>> {
        let named = PyDict::new(py);
        named.set_item("moving_pose", self.moving_pose())?;
        named.set_item("fixed_pose", self.fixed_pose())?;
        Ok(((self.moving(py), self.fixed(py)), named))
    }

    fn __repr__(&self) -> &'static str {
        match self.bodies {
            [Piece::Convex(_), Piece::Convex(_)] => "Pair(of convex bodies)",
            _ => "Pair(of solids)",
        }
    }
}
