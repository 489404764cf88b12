//! Motions of bodies, and the first contact of two moving bodies.

use colltrans::glam::DVec3;
use colltrans::motion::{self, MotionCase, MotionOutcome};
use colltrans::record::{Dents, MotionRecord, Record};
use colltrans::solid::StartOverlap;
use colltrans::{ConvexPolyhedron, ProofFile, QueryError, Solid};
use colltrans_mesh::body::between_motions;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use serde::{Deserialize, Serialize};

use crate::answer::{Answer, answer, object};
use crate::arrays::{Numbers, Shape, Vector, coordinates, row, vector};
use crate::body;
use crate::errors::{OrRaise, error, input_error, other_bodies_error, query_error};
use crate::features::{Feature, Features};
use crate::frozen::{Options, Shown, getters, html, pickled, show};
use crate::number::{middle, number};
use crate::pair::Of;
use crate::placed::Placed;
use crate::pose::{Bare, Pose, bare_numbers, pose, pose_from_bare};
use crate::solid::Piece;
use crate::solid_cast::run_patiently;

/// A motion: the pose of a body at every time from 0 to 1.
///
/// The body rests, slides, turns, unscrews, is thrown, or passes through poses. Built by :meth:`still`,
/// :meth:`slide`, :meth:`turn`, :meth:`screw`, :meth:`thrown`, :meth:`between`, :meth:`through` and
/// :meth:`about`. Angles are keywords, ``degrees=`` or ``radians=``. Answers hold for the motion as a
/// function of real numbers that the stored numbers define.
///
/// Examples
/// --------
/// >>> from colltrans import Motion
/// >>> door = Motion.turn([0, 0, 0], [0, 0, 1], degrees=90)
/// >>> door.at(1).rotation.round(12)[0]
/// array([ 0., -1.,  0.])
/// >>> door
/// Motion.turn([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], radians=1.5707963267948966)
#[pyclass(frozen, eq, module = "colltrans")]
#[derive(Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Motion(pub(crate) motion::Motion);

pickled!(Motion);

getters!(Motion, |it| {
    /// Pose: The pose of the body at time 0.
    start: Pose = Pose(it.0.start_pose());
});

#[pymethods]
impl Motion {
    /// Builds the motion of a body that rests at a pose.
    #[staticmethod]
    #[pyo3(signature = (pose=None))]
    fn still(pose: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        Ok(Self(motion::Motion::at_rest(crate::pose::pose(pose, "pose")?)))
    }

    /// Builds a translation from a pose by a vector, in world units.
    ///
    /// Raises
    /// ------
    /// QueryError
    ///     The vector is not finite or out of range. All other methods that build a motion from numbers raise
    ///     this error too.
    #[staticmethod]
    #[pyo3(signature = (by, *, pose=None))]
    fn slide(by: &Bound<'_, PyAny>, pose: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        motion::Motion::translation(crate::pose::pose(pose, "pose")?, vector(by, "by")?)
            .or_raise()
            .map(Self)
    }

    /// Builds a rotation about an axis through a point, counter-clockwise as seen against the axis.
    ///
    /// Parameters
    /// ----------
    /// point, axis : array_like of shape (3,)
    ///     A point of the axis and its direction in the world. The direction has any length above 0.
    /// degrees, radians : float
    ///     The angle, as exactly one of the two keywords.
    /// pose : array_like, Pose or object with ``as_matrix()``, optional
    ///     The pose of the body at time 0.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The angle has no unit, has two units, or is missing.
    #[staticmethod]
    #[pyo3(signature = (point, axis, *angle, degrees=None, radians=None, pose=None))]
    fn turn(
        point: &Bound<'_, PyAny>,
        axis: &Bound<'_, PyAny>,
        angle: &Bound<'_, PyTuple>,
        degrees: Option<f64>,
        radians: Option<f64>,
        pose: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let angle = angle_in_radians("turn(point, axis", angle, degrees, radians)?;
        Self::from_screw(point, axis, angle, 0.0, pose)
    }

    /// Builds a screw: a rotation about an axis that itself moves along its direction by ``rise``.
    ///
    /// Parameters
    /// ----------
    /// point, axis, degrees, radians, pose
    ///     See :meth:`turn`.
    /// rise : float
    ///     The translation of the axis along its direction, a length.
    #[staticmethod]
    #[pyo3(signature = (point, axis, *angle, rise, degrees=None, radians=None, pose=None))]
    fn screw(
        point: &Bound<'_, PyAny>,
        axis: &Bound<'_, PyAny>,
        angle: &Bound<'_, PyTuple>,
        rise: f64,
        degrees: Option<f64>,
        radians: Option<f64>,
        pose: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let angle = angle_in_radians("screw(point, axis, rise=...", angle, degrees, radians)?;
        Self::from_screw(point, axis, angle, rise, pose)
    }

    /// Builds the motion of a thrown body.
    ///
    /// The point ``center``, given in the world, moves straight by ``velocity``. The body turns about it by
    /// the length of ``angular_velocity`` in radians, about the direction of this vector.
    #[staticmethod]
    #[pyo3(signature = (center, velocity, angular_velocity, *, pose=None))]
    fn thrown(
        center: &Bound<'_, PyAny>,
        velocity: &Bound<'_, PyAny>,
        angular_velocity: &Bound<'_, PyAny>,
        pose: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (center, velocity) = (vector(center, "center")?, vector(velocity, "velocity")?);
        let spin = vector(angular_velocity, "angular_velocity")?;
        motion::Motion::free_flight(crate::pose::pose(pose, "pose")?, center, velocity, spin)
            .or_raise()
            .map(Self)
    }

    /// Builds the screw from one pose to another with the smaller angle. It ends there up to rounding.
    #[staticmethod]
    fn between(start: &Bound<'_, PyAny>, end: &Bound<'_, PyAny>) -> PyResult<Self> {
        motion::Motion::between_poses(pose(Some(start), "start")?, pose(Some(end), "end")?)
            .or_raise()
            .map(Self)
    }

    /// Builds screws from each pose to the next one, in equal times.
    ///
    /// Parameters
    /// ----------
    /// poses : sequence
    ///     At least one pose, each an array_like or a :class:`Pose`.
    #[staticmethod]
    fn through(poses: &Bound<'_, PyAny>) -> PyResult<Self> {
        let each = poses.try_iter()?.map(|item| pose(Some(&item?), "poses"));
        let poses = each.collect::<PyResult<Vec<_>>>()?;
        motion::Motion::through_poses(&poses).or_raise().map(Self)
    }

    /// Builds a motion from the numbers that define it.
    ///
    /// The numbers are the vector ``arm`` from a point of the axis to the origin of the body frame, the axis,
    /// the angle, and the translation ``way`` of the axis.
    #[staticmethod]
    #[pyo3(signature = (arm, axis, way, *angle, degrees=None, radians=None, pose=None))]
    fn about(
        arm: &Bound<'_, PyAny>,
        axis: &Bound<'_, PyAny>,
        way: &Bound<'_, PyAny>,
        angle: &Bound<'_, PyTuple>,
        degrees: Option<f64>,
        radians: Option<f64>,
        pose: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let angle = angle_in_radians("about(arm, axis, way", angle, degrees, radians)?;
        let start = crate::pose::pose(pose, "pose")?;
        let (arm, axis, way) = (vector(arm, "arm")?, vector(axis, "axis")?, vector(way, "way")?);
        motion::Motion::from_arm_and_axis(start, arm, axis, angle, way).or_raise().map(Self)
    }

    /// Returns the pose of the body at a time from 0 to 1, up to rounding.
    ///
    /// Raises
    /// ------
    /// QueryError
    ///     The time is not from 0 to 1.
    fn at(&self, time: f64) -> PyResult<Pose> {
        self.0.pose_at(time).or_raise().map(Pose)
    }

    /// Formats the motion. A motion of one piece becomes a call that builds it again up to rounding, with its kind,
    /// axis, angle and the pose at time 0. Several screws become their number and this pose.
    fn __repr__(&self) -> String {
        let start = Pose(self.0.start_pose()).text();
        let [piece] = self.0.pieces() else {
            return format!("Motion.through({} screws, from {start})", self.0.pieces().len());
        };
        let is_elsewhere = self.0.start_pose() != colltrans::Pose::IDENTITY;
        let pose = is_elsewhere.then(|| format!("pose={start}"));
        let point = piece.start_pose.translation() - piece.arm;
        let [point, axis, arm, way] =
            [point, piece.axis, piece.arm, piece.velocity].map(coordinates);
        let rise = piece.velocity.dot(piece.axis);
        let (kind, mut arguments) = if piece.rate == 0.0 && piece.velocity == DVec3::ZERO {
            ("still", Vec::new())
        } else if piece.rate == 0.0 {
            ("slide", vec![format!("{way:?}")])
        } else if piece.velocity == DVec3::ZERO {
            ("turn", vec![format!("{point:?}"), format!("{axis:?}")])
        } else if piece.velocity == piece.axis * rise {
            ("screw", vec![format!("{point:?}"), format!("{axis:?}"), format!("rise={rise:?}")])
        } else {
            ("about", vec![format!("{arm:?}"), format!("{axis:?}"), format!("{way:?}")])
        };
        if piece.rate != 0.0 {
            arguments.push(format!("radians={:?}", piece.rate));
        }
        arguments.extend(pose);
        format!("Motion.{kind}({})", arguments.join(", "))
    }
}

impl Motion {
    fn from_screw(
        point: &Bound<'_, PyAny>,
        axis: &Bound<'_, PyAny>,
        angle: f64,
        rise: f64,
        pose: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (point, axis) = (vector(point, "point")?, vector(axis, "axis")?);
        motion::Motion::screw(crate::pose::pose(pose, "pose")?, point, axis, angle, rise)
            .or_raise()
            .map(Self)
    }
}

/// Returns the angle of `Motion.{call}, ...)` in radians. Rejects an angle without a unit.
fn angle_in_radians(
    call: &str,
    positional: &Bound<'_, PyTuple>,
    degrees: Option<f64>,
    radians: Option<f64>,
) -> PyResult<f64> {
    let named = match (degrees, radians) {
        (Some(degrees), None) => Some(degrees.to_radians()),
        (None, radians) => radians,
        (Some(_), Some(_)) => None,
    };
    named.filter(|_| positional.is_empty()).ok_or_else(|| {
        let given = positional.iter().next().map_or_else(|| "90".into(), |angle| angle.to_string());
        let wrong = match (degrees, radians) {
            (Some(_), Some(_)) => "has two units",
            (None, None) if positional.is_empty() => "is missing",
            _ => "has no unit",
        };
        let calls = ["degrees", "radians"].map(|unit| format!("Motion.{call}, {unit}={given})"));
        input_error("angle", format_args!("it {wrong}: call {} or {}", calls[0], calls[1]))
    })
}

/// Returns the motion of an argument: a motion, or a pose at which the body rests. Rejects three numbers,
/// because they could be a displacement or a position.
fn motion_of(of: Option<&Bound<'_, PyAny>>, name: &str) -> PyResult<motion::Motion> {
    let Some(given) = of else { return Ok(motion::Motion::at_rest(colltrans::Pose::IDENTITY)) };
    if let Ok(motion) = given.cast::<Motion>() {
        return Ok(motion.get().0.clone());
    }
    if given.is_instance_of::<Pose>() {
        return Ok(motion::Motion::at_rest(pose(of, name)?));
    }
    let bare = bare_numbers(given, name)?;
    if let Bare(Numbers { values: [x, y, z, ..], shape: Shape::Row(3) }) = bare {
        let vector = [x, y, z].map(|c| c + 0.0);
        return Err(input_error(
            name,
            format_args!(
                "{vector:?} could be a displacement or a position: Motion.slide({vector:?}) moves the \
                 body by it, Motion.still({vector:?}) lets the body rest there"
            ),
        ));
    }
    Ok(motion::Motion::at_rest(pose_from_bare(given.py(), &bare, name)?))
}

/// Reads a body and its motion. A placed body without a motion rests in its pose.
fn moving_body(
    body: &Bound<'_, PyAny>,
    motion: Option<&Bound<'_, PyAny>>,
    name: &str,
) -> PyResult<(Piece, motion::Motion)> {
    let argument = format!("{name}_motion");
    match (body.cast::<Placed>(), motion) {
        (Ok(_), Some(_)) => Err(input_error(
            &argument,
            format_args!(
                "{name} has a pose already, from body.at(pose); give the pose to the motion alone"
            ),
        )),
        (Ok(placed), None) => {
            let Placed { body, pose } = placed.get();
            Ok((body.copy(placed.py()), motion::Motion::at_rest(*pose)))
        }
        (Err(_), _) => Ok((Piece::from_python(body, name)?, motion_of(motion, &argument)?)),
    }
}

/// Two bodies and their motions, as a value: query the first contact, save and replay it.
///
/// Parameters
/// ----------
/// moving, fixed : ConvexPolyhedron or Solid
///     If one of them is a solid, both are treated as solids.
/// moving_motion, fixed_motion : Motion, Pose or array_like, optional
///     The motions of the bodies. A :class:`Pose`, or seven numbers or a matrix of a pose, stands for rest.
///     Three numbers are rejected, because they could be a displacement (:meth:`Motion.slide`) or a position
///     (:meth:`Motion.still`).
/// min_gap : float
///     A minimum gap, a length. With a gap, bodies count as meeting as soon as their distance falls to it.
/// tolerance : float, optional
///     For convex bodies a tolerated depth, instead of ``min_gap``: they count as meeting as soon as they overlap
///     by more. Solids are shrunk by half of it; the default follows from the precision of their files and from
///     rounding.
/// ignore_start_overlaps : bool
///     For :meth:`clearance` of solids: whether facets that cross at the start of the motion are ignored
///     until they are apart.
///
/// Raises
/// ------
/// QueryError, PoseError, InputError
///     An argument is rejected.
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron, Motion, MotionCast
/// >>> door = ConvexPolyhedron.cuboid([0, -0.02, 0], [1, 0.02, 2])
/// >>> post = ConvexPolyhedron.cuboid([0.55, 0.55, 0], [0.65, 0.65, 2])
/// >>> swing = Motion.turn([0, 0, 0], [0, 0, 1], degrees=90)
/// >>> found = MotionCast(door, post, moving_motion=swing).motion()
/// >>> found.outcome, round(found.lower, 9), found.upper - found.lower < 1e-11
/// ('contact', 0.432115832, True)
/// >>> found.verify()
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct MotionCast {
    bodies: [Piece; 2],
    motions: [motion::Motion; 2],
    min_gap: f64,
    tolerance: Option<f64>,
    start_overlap: StartOverlap,
}

/// The cast of the library.
type AnyMotionCast<'a> = Of<motion::MotionCast<'a>, motion::MotionCast<'a, Solid>>;

/// The bodies, and all other arguments by name.
type Arguments<'py> = ((Py<PyAny>, Py<PyAny>), Bound<'py, PyDict>);

impl MotionCast {
    /// Returns the dents of the two meshes, if these are convex only within the tolerance.
    pub(crate) fn dents(&self) -> Option<Dents> {
        Dents::from_depths(self.bodies.each_ref().map(Piece::dent))
    }

    pub(crate) fn from_arguments(
        bodies: [&Bound<'_, PyAny>; 2],
        motions: [Option<&Bound<'_, PyAny>>; 2],
        min_gap: f64,
        tolerance: Option<f64>,
        ignore_start_overlaps: bool,
    ) -> PyResult<Self> {
        let start_overlap =
            if ignore_start_overlaps { StartOverlap::Ignore } else { StartOverlap::Refuse };
        let (moving, moving_motion) = moving_body(bodies[0], motions[0], "moving")?;
        let (fixed, fixed_motion) = moving_body(bodies[1], motions[1], "fixed")?;
        Ok(Self {
            bodies: [moving, fixed],
            motions: [moving_motion, fixed_motion],
            min_gap,
            tolerance,
            start_overlap,
        })
    }

    /// Builds the cast of the library.
    fn asked(&self) -> PyResult<AnyMotionCast<'_>> {
        let [a, b] = &self.motions;
        if let [Piece::Convex(p), Piece::Convex(q)] = &self.bodies {
            let (p, q): (&ConvexPolyhedron, &ConvexPolyhedron) = (&p.get().0, &q.get().0);
            return convex_cast([p, q], [a, b], self.min_gap, self.tolerance)
                .or_raise()
                .map(Of::Convex);
        }
        let [p, q] = [self.bodies[0].solid().or_raise()?, self.bodies[1].solid().or_raise()?];
        let precisions = [0, 1].map(|i| self.bodies[i].precision());
        let cast =
            solid_cast([p, q], [a, b], precisions, self.min_gap, self.tolerance).or_raise()?;
        Ok(Of::Solids(cast.with_start_overlap(self.start_overlap)))
    }

    /// Computes the first contact without the interpreter's lock, because it may take long.
    pub(crate) fn first(slf: &Bound<'_, Self>) -> PyResult<Found> {
        let query = slf.clone().unbind();
        run_patiently(slf.py(), &slf.get().bodies, move || match query.get().asked()? {
            Of::Convex(cast) => {
                let found = cast.first_contact();
                found
                    .map(Of::Convex)
                    .map_err(|what| query_error(&what, || MotionCase::from_cast(&cast).to_json()))
            }
            Of::Solids(cast) => cast.first_contact().or_raise().map(Of::Solids),
        })
    }
}

impl MotionCast {
    /// Computes the clearance without the interpreter's lock, because it may take long.
    fn cleared(slf: &Bound<'_, Self>) -> PyResult<Cleared> {
        let query = slf.clone().unbind();
        run_patiently(slf.py(), &slf.get().bodies, move || match query.get().asked()? {
            Of::Convex(cast) => {
                let found = cast.clearance();
                found
                    .map(Of::Convex)
                    .map_err(|what| query_error(&what, || MotionCase::from_cast(&cast).to_json()))
            }
            Of::Solids(cast) => cast.clearance().or_raise().map(Of::Solids),
        })
    }
}

pub(crate) const EITHER: &str =
    "min_gap and tolerance are both given; convex bodies accept only one of them";

/// Builds the cast of two convex bodies.
pub(crate) fn convex_cast<'a>(
    [p, q]: [&'a ConvexPolyhedron; 2],
    [a, b]: [&'a motion::Motion; 2],
    min_gap: f64,
    tolerance: Option<f64>,
) -> Result<motion::MotionCast<'a>, QueryError> {
    let cast = motion::MotionCast::new(p.with_motion(a), q.with_motion(b))?;
    match tolerance {
        // Both calls run: the first one rejects an invalid gap, the second one replaces the gap by the depth.
        Some(depth) => cast.with_min_gap(min_gap)?.with_tolerance(depth),
        None => cast.with_min_gap(min_gap),
    }
}

/// Builds the cast of two solids.
pub(crate) fn solid_cast<'a>(
    [p, q]: [&'a Solid; 2],
    [a, b]: [&'a motion::Motion; 2],
    precisions: [f64; 2],
    min_gap: f64,
    tolerance: Option<f64>,
) -> Result<motion::MotionCast<'a, Solid>, QueryError> {
    between_motions(p.with_motion(a), q.with_motion(b), precisions, tolerance)?
        .with_min_gap(min_gap)
}

getters!(MotionCast, |it| {
    /// ConvexPolyhedron or Solid: The moving body.
    moving(py): Py<PyAny> = it.bodies[0].object(py);
    /// ConvexPolyhedron or Solid: The fixed body.
    fixed(py): Py<PyAny> = it.bodies[1].object(py);
    /// Motion: The motion of the moving body.
    moving_motion: Motion = Motion(it.motions[0].clone());
    /// Motion: The motion of the fixed body.
    fixed_motion: Motion = Motion(it.motions[1].clone());
    /// float: The minimum gap; 0 if there is none.
    min_gap: f64 = it.min_gap;
    /// float: The tolerated depth; for solids the tolerance that is used.
    tolerance: PyResult<f64> = Ok(match it.asked()? {
        Of::Convex(cast) => cast.tolerance(),
        Of::Solids(cast) => cast.tolerance(),
    });
    /// bool: Whether overlaps at the start of the motion are ignored.
    ignore_start_overlaps: bool = it.start_overlap == StartOverlap::Ignore;
});

#[pymethods]
impl MotionCast {
    #[new]
    #[pyo3(signature = (moving, fixed, *, moving_motion=None, fixed_motion=None, min_gap=0.0,
        tolerance=None, ignore_start_overlaps=false))]
    fn new(
        moving: &Bound<'_, PyAny>,
        fixed: &Bound<'_, PyAny>,
        moving_motion: Option<&Bound<'_, PyAny>>,
        fixed_motion: Option<&Bound<'_, PyAny>>,
        min_gap: f64,
        tolerance: Option<f64>,
        ignore_start_overlaps: bool,
    ) -> PyResult<Self> {
        let motions = [moving_motion, fixed_motion];
        let query = Self::from_arguments(
            [moving, fixed],
            motions,
            min_gap,
            tolerance,
            ignore_start_overlaps,
        )?;
        if let [Piece::Convex(_), Piece::Convex(_)] = query.bodies {
            if tolerance.is_some() && min_gap != 0.0 {
                return Err(error("QueryError", EITHER));
            }
            if ignore_start_overlaps {
                return Err(error("QueryError", "ignore_start_overlaps is for solids"));
            }
        }
        query.asked()?;
        Ok(query)
    }

    /// Computes when the bodies first meet; see :func:`motion`.
    #[pyo3(name = "motion")]
    fn first_contact(slf: &Bound<'_, Self>) -> PyResult<FirstContact> {
        Ok(FirstContact { found: Self::first(slf)?, query: slf.clone().unbind() })
    }

    /// Computes how far the body can move; see :func:`colltrans.motions.motion_clearance`.
    fn clearance(slf: &Bound<'_, Self>) -> PyResult<MotionClearance> {
        Ok(MotionClearance { found: Self::cleared(slf)?, query: slf.clone().unbind() })
    }

    /// Returns the query of convex bodies as text: bodies, motions, and the gap or the tolerance, exact in bits.
    ///
    /// The command ``colltrans replay`` reads this text too.
    ///
    /// Raises
    /// ------
    /// CaseError
    ///     The bodies are solids.
    fn to_json(&self) -> PyResult<String> {
        match self.asked()? {
            Of::Convex(cast) => Ok(MotionCase::from_cast(&cast).to_json()),
            Of::Solids(_) => Err(error("CaseError", "a motion of solids has no file")),
        }
    }

    /// Reads the text that `to_json` or the command line wrote.
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<Self> {
        let saved = MotionCase::from_json(text).or_raise()?;
        let cast = saved.cast();
        let [p, q] = cast.bodies();
        let [a, b] = cast.motions();
        let piece = |body: &ConvexPolyhedron| {
            Ok::<_, PyErr>(Piece::Convex(Py::new(py, body::ConvexPolyhedron::from(body.clone()))?))
        };
        Ok(Self {
            bodies: [piece(p)?, piece(q)?],
            motions: [a.clone(), b.clone()],
            min_gap: cast.min_gap(),
            tolerance: Some(cast.tolerance()).filter(|depth| *depth > 0.0),
            start_overlap: StartOverlap::Refuse,
        })
    }

    /// Draws the bodies at the start, at the contact and at the end; see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> Shown<'py> {
        html(slf)
    }

    /// Returns the arguments that build the query again, for `pickle` and `copy`.
    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<Arguments<'py>> {
        let named = PyDict::new(py);
        named.set_item("moving_motion", self.moving_motion())?;
        named.set_item("fixed_motion", self.fixed_motion())?;
        named.set_item("min_gap", self.min_gap)?;
        named.set_item("tolerance", self.tolerance)?;
        named.set_item("ignore_start_overlaps", self.ignore_start_overlaps())?;
        Ok(((self.moving(py), self.fixed(py)), named))
    }

    fn __repr__(&self) -> &'static str {
        match self.bodies {
            [Piece::Convex(_), Piece::Convex(_)] => "MotionCast(of convex bodies)",
            _ => "MotionCast(of solids)",
        }
    }
}

/// An answer. For solids the proof is built on request.
type Found = Of<MotionOutcome, MotionOutcome<()>>;

/// The first contact of two moving bodies, at a time from 0 (start of the motion) to 1 (end).
///
/// The ``outcome`` is one of:
///
/// - ``"contact"``: the bodies do not meet before ``lower``, and meet at ``upper``;
/// - ``"grazing"``: they do not meet before ``lower``, then come closer than rounding can resolve; the time
///   after it is not examined;
/// - ``"free"``: they never meet during the motion (never reach the minimum gap, or never overlap by more
///   than the tolerance);
/// - ``"overlapping"``: they overlap at the start of the motion;
/// - ``"undecided"``: the search reached its maximum number of steps. They do not meet before ``lower``;
///   later contacts are open.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct FirstContact {
    found: Found,
    query: Py<MotionCast>,
}

answer!(FirstContact("outcome", "lower", "upper") of Found, MotionCast, |it| it.found.clone());

/// Evaluates an expression for the contact in an answer, for convex bodies or solids.
macro_rules! contact {
    ($of:expr, $contact:ident => $value:expr) => {
        match &$of {
            Of::Convex(
                MotionOutcome::Contact($contact)
                | MotionOutcome::Grazing($contact)
                | MotionOutcome::Undecided($contact),
            ) => Some($value),
            Of::Solids(
                MotionOutcome::Contact($contact)
                | MotionOutcome::Grazing($contact)
                | MotionOutcome::Undecided($contact),
            ) => Some($value),
            _ => None,
        }
    };
}

impl FirstContact {
    fn told(&self, py: Python<'_>) -> PyResult<Record> {
        self.found.record(self.query.bind(py))
    }
}

getters!(FirstContact, |it| {
    /// str: ``"contact"``, ``"grazing"``, ``"free"``, ``"overlapping"`` or ``"undecided"``.
    outcome(py): PyResult<&'static str> = Ok(it.told(py)?.outcome().name());
    /// float: The bodies do not meet before this time. It is 1 if they never meet, 0 if they overlap at the
    /// start.
    lower: f64 = {
        let free = matches!(
            it.found,
            Of::Convex(MotionOutcome::Free(_)) | Of::Solids(MotionOutcome::Free(_))
        );
        let none = if free { 1.0 } else { 0.0 };
        contact!(it.found, contact => contact.lower).unwrap_or(none)
    };
    /// float: The bodies meet at this time; infinite if that is not proven, or if they never meet.
    upper: f64 = {
        let overlapping = matches!(
            it.found,
            Of::Convex(MotionOutcome::Overlapping(_)) | Of::Solids(MotionOutcome::Overlapping(_))
        );
        let none = if overlapping { 0.0 } else { f64::INFINITY };
        contact!(it.found, contact => contact.upper).unwrap_or(none)
    };
    /// tuple of (Pose, Pose) or None: The poses of both bodies at ``lower``, up to rounding; None if they
    /// never meet or overlap at the start.
    poses: Option<(Pose, Pose)> =
        contact!(it.found, contact => (Pose(contact.poses[0]), Pose(contact.poses[1])));
    /// ndarray of shape (3,) or None: The nearest point of the fixed body at that time, in the world.
    point(py): Option<Vector<'py>> =
        contact!(it.found, contact => contact.points)?.map(|points| row(py, points[1]));
    /// ndarray of shape (3,) or None: Unit normal in the world at that time, from the moving body to the fixed
    /// one; None without a contact, or if no plane between the bodies was found.
    normal(py): Option<Vector<'py>> =
        contact!(it.found, contact => contact.normal)?.map(|normal| row(py, normal));
    /// Features or None: The nearest feature of each body.
    features: PyResult<Option<Features>> = {
        let features = contact!(it.found, contact => contact.features).flatten();
        let Some(colltrans::Features { moving, fixed }) = features else { return Ok(None) };
        let of = |moving, fixed| Ok(Some(Features { moving, fixed }));
        match it.query.get().asked()? {
            Of::Convex(cast) => {
                let [p, q] = cast.bodies();
                of(Feature::from_feature(moving, p), Feature::from_feature(fixed, q))
            }
            Of::Solids(cast) => {
                let [p, q] = cast.bodies();
                of(Feature::from_feature(moving, p), Feature::from_feature(fixed, q))
            }
        }
    };
    /// int: Number of distance samples and contact tests of the search.
    looks: u32 = match &it.found {
        Of::Convex(found) => found.steps().looks,
        Of::Solids(found) => found.steps().looks,
    };
});

impl FirstContact {
    /// Returns the time of the first contact: infinite if there is none, `None` if the search was cut off.
    fn time(&self) -> Option<f64> {
        match &self.found {
            Of::Convex(MotionOutcome::Free(_)) | Of::Solids(MotionOutcome::Free(_)) => {
                Some(f64::INFINITY)
            }
            Of::Convex(MotionOutcome::Undecided(_)) | Of::Solids(MotionOutcome::Undecided(_)) => {
                None
            }
            _ => Some(middle(self.lower(), self.upper())),
        }
    }
}

number!(FirstContact, Option<f64>, |it| it.time(),
    /// float or None: The time of the first contact, from 0 to 1: the middle of both bounds, or ``lower`` without a
    /// finite ``upper``. Infinite if the bodies never meet. None if the answer is undecided, for which ``float`` raises
    /// a TypeError.
);

#[pymethods]
impl FirstContact {
    /// Checks the proof with the bodies alone. Between solids the query runs again to build the proof.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     The proof does not hold; the message names the failed condition.
    fn verify(&self, py: Python<'_>) -> PyResult<()> {
        let (query, found) = (self.query.clone_ref(py), self.found.clone());
        let refused = |what: motion::MotionProofError| error("CertificateError", what);
        run_patiently(py, &self.query.get().bodies, move || {
            match (query.get().asked()?, &found) {
                (Of::Convex(cast), Of::Convex(found)) => cast.verify(found.proof()),
                (Of::Solids(cast), _) => {
                    cast.verify(cast.certified_first_contact().or_raise()?.proof())
                }
                _ => return Err(other_bodies_error()),
            }
            .map(|_| ())
            .map_err(refused)
        })
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let outcome = self.outcome(py)?;
        Ok(format!("FirstContact({outcome:?}, lower={:?}, upper={:?})", self.lower(), self.upper()))
    }
}

impl Answer for Found {
    type Query = MotionCast;

    fn object<'py>(self, query: &Bound<'py, MotionCast>) -> PyResult<Bound<'py, PyAny>> {
        object(query.py(), FirstContact { found: self, query: query.clone().unbind() })
    }

    fn record(&self, query: &Bound<'_, MotionCast>) -> PyResult<Record> {
        match (self, query.get().asked()?) {
            (Self::Convex(found), Of::Convex(cast)) => {
                Ok(MotionRecord::from_outcome(found, &cast).into())
            }
            (Self::Solids(found), Of::Solids(cast)) => {
                Ok(MotionRecord::of_solids(found, &cast).into())
            }
            _ => Err(other_bodies_error()),
        }
    }

    fn proof(&self, query: &Bound<'_, MotionCast>) -> PyResult<String> {
        match (self, query.get().asked()?) {
            (Self::Convex(found), Of::Convex(cast)) => {
                Ok(ProofFile::of_motion(&cast, found).to_json())
            }
            (Self::Solids(_), Of::Solids(cast)) => solid_proof(&cast),
            _ => Err(other_bodies_error()),
        }
    }
}

/// Builds the proof of a first contact of solids, by running the query again.
fn solid_proof(cast: &motion::MotionCast<'_, Solid>) -> PyResult<String> {
    ProofFile::with_solid_motion(cast).map(|(_, file)| file.to_json()).or_raise()
}

/// A clearance. For solids the proof is built on request.
type Cleared = Of<motion::MotionClearance, motion::MotionClearance<()>>;

/// How far along its motion a body can move, as a time from 0 (start) to 1 (end).
///
/// The ``outcome`` is one of:
///
/// - ``"blocked"``: the body can safely move until ``time``, which is 0 if it is blocked at the start;
/// - ``"free"``: the body can move to the end;
/// - ``"overlapping"``: at the start of the motion the bodies overlap by more than the tolerance.
#[pyclass(frozen, module = "colltrans.motions")]
pub(crate) struct MotionClearance {
    found: Cleared,
    query: Py<MotionCast>,
}

answer!(MotionClearance("outcome", "time") of Cleared, MotionCast, |it| it.found.clone());

/// The contact that stops a body: bounds of its time for the nominal bodies, the tolerance, and bounds of the
/// time at which the shrunk bodies meet.
struct Stop {
    place: [f64; 2],
    tolerance: f64,
    shrunk: [f64; 2],
}

impl Stop {
    fn from_clearance<P>(found: &motion::MotionClearance<P>) -> Option<Self> {
        let motion::MotionClearance::Blocked { contact, .. } = found else { return None };
        let (place, shrunk) = (contact.time, &contact.shrunk);
        Some(Self {
            place: [place.lower, place.upper],
            tolerance: contact.tolerance,
            shrunk: [shrunk.lower, shrunk.upper],
        })
    }
}

/// Converts bounds: an upper bound that is not proven becomes `None`.
fn bounds([lower, upper]: [f64; 2]) -> (f64, Option<f64>) {
    (lower, Some(upper).filter(|upper| upper.is_finite()))
}

impl MotionClearance {
    fn stop(&self) -> Option<Stop> {
        match &self.found {
            Of::Convex(found) => Stop::from_clearance(found),
            Of::Solids(found) => Stop::from_clearance(found),
        }
    }
}

getters!(MotionClearance, |it| {
    /// str: ``"blocked"``, ``"free"`` or ``"overlapping"``.
    outcome: &'static str = match (it.time(), it.stop()) {
        (_, Some(_)) => "blocked",
        (Some(_), None) => "free",
        (None, None) => "overlapping",
    };
    /// float or None: The body can move until this time; 1 for the whole motion, None if the bodies overlap
    /// at the start.
    time: Option<f64> = match &it.found {
        Of::Convex(found) => found.time(),
        Of::Solids(found) => found.time(),
    };
    /// float or None: The :attr:`time`.
    lower: Option<f64> = it.time();
    /// float or None: An upper bound of the time at which the body is stopped: the second of :attr:`bounds`, infinite
    /// if it is not proven. It is 1 if the body can move to the end, None if the bodies overlap at the start.
    upper: Option<f64> = match it.stop() {
        Some(stop) => Some(stop.place[1]),
        None => it.time(),
    };
    /// tuple of (float, float or None) or None: Bounds of the time at which the stopping features meet in
    /// their nominal position; None if nothing stops the body. The first one is extrapolated, without a proof, if
    /// the nominal bodies are apart at no sampled time or no contact of them is found. At the second one the
    /// nominal bodies meet, or the bodies after the tolerance is applied. It is None if neither is proven.
    bounds: Option<(f64, Option<f64>)> = it.stop().map(|stop| bounds(stop.place));
    /// tuple of (float, float or None) or None: Proven bounds of the time at which the bodies meet after the
    /// tolerance is applied. The second one is None if no contact is proven.
    shrunk: Option<(f64, Option<f64>)> = it.stop().map(|stop| bounds(stop.shrunk));
    /// float or None: The tolerance that was used, a length; None if nothing stops the body.
    tolerance: Option<f64> = it.stop().map(|stop| stop.tolerance);
    /// float or None: The smallest tolerance at which the bodies do not overlap at the start of the motion, rounded
    /// up; None if there is no such tolerance, or unless the outcome is ``"overlapping"``.
    least_tolerance: Option<f64> = match &it.found {
        Of::Convex(motion::MotionClearance::Overlapping(found))
        | Of::Solids(motion::MotionClearance::Overlapping(found)) => found.least_tolerance,
        _ => None,
    };
});

number!(MotionClearance, Option<f64>, |it| it.time(),
    /// float or None: The :attr:`time`; ``float`` raises a TypeError if it is None.
);

#[pymethods]
impl MotionClearance {
    /// Checks with the bodies alone the proof of the bounds ``shrunk``, or that the body can move to the end.
    ///
    /// Between solids the query runs again to build the proof.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     The proof does not hold. There is no proof if the bodies overlap at the start of the motion, or if
    ///     such overlaps are ignored.
    fn verify(&self, py: Python<'_>) -> PyResult<()> {
        let (query, found) = (self.query.clone_ref(py), self.found.clone());
        let refused = |what: motion::MotionProofError| error("CertificateError", what);
        run_patiently(py, &self.query.get().bodies, move || {
            match (query.get().asked()?, &found) {
                (Of::Convex(cast), Of::Convex(found)) => {
                    let outcome = first_of(found).ok_or_else(unproven_error)?;
                    cast.with_clearance_tolerance().verify(outcome.proof())
                }
                (Of::Solids(cast), Of::Solids(found)) => {
                    if first_of(found).is_none() || query.get().ignore_start_overlaps() {
                        return Err(unproven_error());
                    }
                    cast.verify(cast.certified_first_contact().or_raise()?.proof())
                }
                _ => return Err(other_bodies_error()),
            }
            .map(|_| ())
            .map_err(refused)
        })
    }

    fn __repr__(&self) -> String {
        let time = self.time().map_or_else(|| "None".into(), |time| format!("{time:?}"));
        format!("MotionClearance({:?}, time={time})", self.outcome())
    }
}

fn unproven_error() -> PyErr {
    error("CertificateError", "of bodies that overlap when the motion begins nothing is proven")
}

/// Returns the first contact of the bodies after the tolerance is applied; `None` if they overlap at the
/// start.
fn first_of<P: Clone>(found: &motion::MotionClearance<P>) -> Option<MotionOutcome<P>> {
    match found {
        motion::MotionClearance::Blocked { contact, .. } => {
            let (shrunk, proven) = (contact.shrunk.clone(), contact.shrunk.upper.is_finite());
            let of = if proven { MotionOutcome::Contact } else { MotionOutcome::Grazing };
            Some(of(shrunk))
        }
        motion::MotionClearance::Free(free) => Some(MotionOutcome::Free(free.clone())),
        motion::MotionClearance::Overlapping(_) => None,
    }
}

impl Answer for Cleared {
    type Query = MotionCast;

    fn object<'py>(self, query: &Bound<'py, MotionCast>) -> PyResult<Bound<'py, PyAny>> {
        object(query.py(), MotionClearance { found: self, query: query.clone().unbind() })
    }

    fn record(&self, query: &Bound<'_, MotionCast>) -> PyResult<Record> {
        match (self, query.get().asked()?) {
            (Self::Convex(found), Of::Convex(cast)) => {
                Ok(MotionRecord::of_clearance(found, &cast).into())
            }
            (Self::Solids(found), Of::Solids(cast)) => {
                Ok(MotionRecord::of_solid_clearance(found, &cast).into())
            }
            _ => Err(other_bodies_error()),
        }
    }

    fn proof(&self, query: &Bound<'_, MotionCast>) -> PyResult<String> {
        match (self, query.get().asked()?) {
            (Self::Convex(found), Of::Convex(cast)) => {
                let outcome = first_of(found).ok_or_else(unproven_error)?;
                Ok(ProofFile::of_motion(&cast.with_clearance_tolerance(), &outcome).to_json())
            }
            (Self::Solids(found), Of::Solids(cast)) => {
                if first_of(found).is_none() || query.get().ignore_start_overlaps() {
                    return Err(unproven_error());
                }
                solid_proof(&cast)
            }
            _ => Err(other_bodies_error()),
        }
    }
}

/// Computes when two moving bodies first meet.
///
/// Parameters
/// ----------
/// moving, fixed, moving_motion, fixed_motion, min_gap, tolerance
///     See :class:`MotionCast`.
///
/// Returns
/// -------
/// FirstContact
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron, Motion, motion
/// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
/// >>> slide = Motion.slide([8, 0, 0], pose=[-4, 0.5, 0])
/// >>> found = motion(cube, cube, slide)
/// >>> found.lower <= 0.375 <= found.upper, found.normal
/// (True, array([1., 0., 0.]))
#[pyfunction]
#[pyo3(name = "motion")]
#[pyo3(signature = (moving, fixed, moving_motion, fixed_motion=None, *, min_gap=0.0, tolerance=None))]
pub(crate) fn first_contact(
    py: Python<'_>,
    moving: &Bound<'_, PyAny>,
    fixed: &Bound<'_, PyAny>,
    moving_motion: &Bound<'_, PyAny>,
    fixed_motion: Option<&Bound<'_, PyAny>>,
    min_gap: f64,
    tolerance: Option<f64>,
) -> PyResult<FirstContact> {
    let motions = [Some(moving_motion), fixed_motion];
    let query = MotionCast::new(moving, fixed, motions[0], motions[1], min_gap, tolerance, false)?;
    MotionCast::first_contact(&Bound::new(py, query)?)
}

/// Computes how far along its motion a body can move.
///
/// Touching bodies may slide, turn and separate. A body is stopped where it is pushed into the other one by more
/// than the tolerance. Without a given tolerance, that of convex bodies is a multiple of the rounding errors, and
/// that of solids follows from their files and from rounding.
///
/// Parameters
/// ----------
/// moving, fixed, moving_motion, fixed_motion, min_gap, tolerance, ignore_start_overlaps
///     See :class:`MotionCast`.
///
/// Returns
/// -------
/// MotionClearance
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron, Motion
/// >>> from colltrans.motions import motion_clearance
/// >>> block = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
/// >>> table = ConvexPolyhedron.cuboid([-4, -4, -1], [4, 4, 0])
/// >>> motion_clearance(block, table, Motion.turn([0.5, 0.5, 0], [0, 0, 1], radians=2))
/// MotionClearance("free", time=1.0)
/// >>> motion_clearance(block, table, Motion.turn([0.5, 0.5, 0], [1, 0, 0], radians=2))
/// MotionClearance("blocked", time=0.0)
#[pyfunction]
#[pyo3(signature = (moving, fixed, moving_motion, fixed_motion=None, *, min_gap=0.0, tolerance=None,
    ignore_start_overlaps=false))]
#[expect(clippy::too_many_arguments, reason = "they are keywords")]
pub(crate) fn motion_clearance(
    py: Python<'_>,
    moving: &Bound<'_, PyAny>,
    fixed: &Bound<'_, PyAny>,
    moving_motion: &Bound<'_, PyAny>,
    fixed_motion: Option<&Bound<'_, PyAny>>,
    min_gap: f64,
    tolerance: Option<f64>,
    ignore_start_overlaps: bool,
) -> PyResult<MotionClearance> {
    let query = MotionCast::new(
        moving,
        fixed,
        Some(moving_motion),
        fixed_motion,
        min_gap,
        tolerance,
        ignore_start_overlaps,
    )?;
    MotionCast::clearance(&Bound::new(py, query)?)
}
