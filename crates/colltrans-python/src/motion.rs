//! What a body does, and when two such bodies first meet.

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
use crate::errors::{OrRaise, error, input, query_error};
use crate::features::{Feature, Features};
use crate::frozen::{Options, Shown, getters, html, pickled, show};
use crate::pair::Of;
use crate::pose::{Bare, Pose, bare_numbers, of_bare, pose};
use crate::solid::Piece;
use crate::solid_cast::patiently;

/// Where a body is at every time from 0 to 1: it rests, slides, turns, unscrews, is thrown, or goes
/// through poses.
///
/// Made by :meth:`still`, :meth:`slide`, :meth:`turn`, :meth:`screw`, :meth:`thrown`, :meth:`between`,
/// :meth:`through` and :meth:`about`. Angles are keywords, ``degrees=`` or ``radians=``. Answers hold of the
/// motion as the real function of its numbers.
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
    /// Pose: Where the body is at time 0.
    start: Pose = Pose(it.0.start());
});

#[pymethods]
impl Motion {
    /// None: the body rests at a pose.
    #[staticmethod]
    #[pyo3(signature = (pose=None))]
    fn still(pose: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        Ok(Self(motion::Motion::still(crate::pose::pose(pose, "pose")?)))
    }

    /// A translation from a pose on, by a vector in world units.
    ///
    /// Raises
    /// ------
    /// QueryError
    ///     A vector that is not finite or out of range; so do all others.
    #[staticmethod]
    #[pyo3(signature = (by, *, pose=None))]
    fn slide(by: &Bound<'_, PyAny>, pose: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        motion::Motion::slide(crate::pose::pose(pose, "pose")?, vector(by, "by")?)
            .or_raise()
            .map(Self)
    }

    /// Turns about an axis through a point of the world, counter-clockwise as seen against the axis.
    ///
    /// Parameters
    /// ----------
    /// point, axis : array_like of shape (3,)
    ///     A point of the axis, and its direction, of any length above 0.
    /// degrees, radians : float
    ///     The angle: one of the two, by its name.
    /// pose : array_like, Pose or object with ``as_matrix()``, optional
    ///     Where the body is at time 0.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     An angle without its unit, with both units, or none.
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
        Self::of_screw(point, axis, angle, 0.0, pose)
    }

    /// Turns about an axis, which itself moves along its own direction by ``rise``, a length.
    ///
    /// Parameters
    /// ----------
    /// point, axis, degrees, radians, pose
    ///     As for :meth:`turn`.
    /// rise : float
    ///     By how much the axis moves along its direction.
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
        Self::of_screw(point, axis, angle, rise, pose)
    }

    /// A point of the body, given in the world, goes straight by ``velocity``, and the body turns about it
    /// by the angular velocity's length in radians, about its direction.
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
        motion::Motion::thrown(crate::pose::pose(pose, "pose")?, center, velocity, spin)
            .or_raise()
            .map(Self)
    }

    /// The screw from one pose to another, by the shorter turn; it ends there to rounding.
    #[staticmethod]
    fn between(start: &Bound<'_, PyAny>, end: &Bound<'_, PyAny>) -> PyResult<Self> {
        motion::Motion::between(pose(Some(start), "start")?, pose(Some(end), "end")?)
            .or_raise()
            .map(Self)
    }

    /// Screws from each pose to the next one, in equal times.
    ///
    /// Parameters
    /// ----------
    /// poses : sequence
    ///     Of array_like or :class:`Pose` each.
    #[staticmethod]
    fn through(poses: &Bound<'_, PyAny>) -> PyResult<Self> {
        let each = poses.try_iter()?.map(|item| pose(Some(&item?), "poses"));
        let poses = each.collect::<PyResult<Vec<_>>>()?;
        motion::Motion::through(&poses).or_raise().map(Self)
    }

    /// Makes a motion from the numbers that define it: the vector from a point of the axis to the origin of
    /// the body's frame, the axis, the angle, and the translation of the axis.
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
        motion::Motion::about(start, arm, axis, angle, way).or_raise().map(Self)
    }

    /// Where the body is at a time from 0 to 1, to rounding.
    fn at(&self, time: f64) -> PyResult<Pose> {
        self.0.at(time).or_raise().map(Pose)
    }

    /// Writes a call that makes the motion again, to rounding: its kind, axis, angle and the pose at time 0.
    fn __repr__(&self) -> String {
        let start = Pose(self.0.start()).text();
        let [piece] = self.0.pieces() else {
            return format!("Motion.through({} screws, from {start})", self.0.pieces().len());
        };
        let is_elsewhere = self.0.start() != colltrans::Pose::IDENTITY;
        let pose = is_elsewhere.then(|| format!("pose={start}"));
        let point = piece.start.translation() - piece.arm;
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
    fn of_screw(
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

/// Returns the angle of `Motion.{call}, ...)` in radians. Refuses one that does not name its unit.
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
        input("angle", format_args!("it {wrong}: call {} or {}", calls[0], calls[1]))
    })
}

/// Returns the motion that an argument gives: a motion, or a pose at which the body rests. Refuses three
/// numbers, since they could be a displacement as well as a place.
fn motion_of(of: Option<&Bound<'_, PyAny>>, name: &str) -> PyResult<motion::Motion> {
    let Some(given) = of else { return Ok(motion::Motion::still(colltrans::Pose::IDENTITY)) };
    if let Ok(motion) = given.cast::<Motion>() {
        return Ok(motion.get().0.clone());
    }
    if given.is_instance_of::<Pose>() {
        return Ok(motion::Motion::still(pose(of, name)?));
    }
    let bare = bare_numbers(given, name)?;
    if let Bare::Numbers(Numbers { values: [x, y, z, ..], shape: Shape::Row(3) }) = bare {
        let vector = [x, y, z].map(|c| c + 0.0);
        return Err(input(
            name,
            format_args!(
                "{vector:?} could be a displacement or a place: Motion.slide({vector:?}) moves the \
                 body by it, Motion.still({vector:?}) lets the body rest there"
            ),
        ));
    }
    Ok(motion::Motion::still(of_bare(given.py(), &bare, name)?))
}

/// Two bodies and what they do, as a value: asked when they first meet, saved and replayed.
///
/// Parameters
/// ----------
/// moving, fixed : ConvexPolyhedron or Solid
///     If one of them is a solid, both are asked as solids.
/// moving_motion, fixed_motion : Motion, Pose or array_like, optional
///     What they do. A :class:`Pose`, or seven numbers or a matrix that give one, stands for rest. Three
///     numbers are refused, because they could be a displacement (:meth:`Motion.slide`) or a place
///     (:meth:`Motion.still`).
/// keep : float
///     A gap to be kept, a length: asked is when the bodies are first as near as that.
/// tolerance : float, optional
///     Of convex bodies, a depth that is tolerated, in the place of ``keep``: asked is when they first
///     overlap by more. Solids are shrunk by half of it; by default by what the precision of their files,
///     and rounding, ask for.
/// ignore_start_overlaps : bool
///     For :meth:`clearance` of solids: whether facets that cross when the motion begins do not count until
///     they are apart.
///
/// Raises
/// ------
/// QueryError, PoseError, InputError
///     An argument that is refused.
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron, Motion, MotionCast
/// >>> door = ConvexPolyhedron.cuboid([0, -0.02, 0], [1, 0.02, 2])
/// >>> post = ConvexPolyhedron.cuboid([0.55, 0.55, 0], [0.65, 0.65, 2])
/// >>> swing = Motion.turn([0, 0, 0], [0, 0, 1], degrees=90)
/// >>> found = MotionCast(door, post, moving_motion=swing).first_contact()
/// >>> found.outcome, round(found.lower, 9), found.upper - found.lower < 1e-11
/// ('contact', 0.432115832, True)
/// >>> found.verify()
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct MotionCast {
    bodies: [Piece; 2],
    motions: [motion::Motion; 2],
    keep: f64,
    tolerance: Option<f64>,
    start_overlap: StartOverlap,
}

/// The library's cast.
type Asked<'a> = Of<motion::MotionCast<'a>, motion::MotionCast<'a, Solid>>;

/// The bodies, and all else by name.
type Arguments<'py> = ((Py<PyAny>, Py<PyAny>), Bound<'py, PyDict>);

impl MotionCast {
    /// Returns the dents of the two meshes where these are convex only to within the tolerance.
    pub(crate) fn dents(&self) -> Option<Dents> {
        Dents::of(self.bodies.each_ref().map(Piece::dent))
    }

    pub(crate) fn of(
        bodies: [&Bound<'_, PyAny>; 2],
        motions: [Option<&Bound<'_, PyAny>>; 2],
        keep: f64,
        tolerance: Option<f64>,
        ignore_start_overlaps: bool,
    ) -> PyResult<Self> {
        let start_overlap =
            if ignore_start_overlaps { StartOverlap::Ignore } else { StartOverlap::Refuse };
        Ok(Self {
            bodies: [Piece::of(bodies[0], "moving")?, Piece::of(bodies[1], "fixed")?],
            motions: [
                motion_of(motions[0], "moving_motion")?,
                motion_of(motions[1], "fixed_motion")?,
            ],
            keep,
            tolerance,
            start_overlap,
        })
    }

    /// The library's.
    fn asked(&self) -> PyResult<Asked<'_>> {
        let [a, b] = &self.motions;
        if let [Piece::Convex(p), Piece::Convex(q)] = &self.bodies {
            let (p, q): (&ConvexPolyhedron, &ConvexPolyhedron) = (&p.get().0, &q.get().0);
            return convex_cast([p, q], [a, b], self.keep, self.tolerance)
                .or_raise()
                .map(Of::Convex);
        }
        let [p, q] = [self.bodies[0].solid().or_raise()?, self.bodies[1].solid().or_raise()?];
        let precisions = [0, 1].map(|i| self.bodies[i].precision());
        let cast = solid_cast([p, q], [a, b], precisions, self.keep, self.tolerance).or_raise()?;
        Ok(Of::Solids(cast.with_start_overlap(self.start_overlap)))
    }

    /// Asks the library; without the interpreter's lock, as it may take long.
    pub(crate) fn first(slf: &Bound<'_, Self>) -> PyResult<Found> {
        let query = slf.clone().unbind();
        patiently(slf.py(), &slf.get().bodies, move || match query.get().asked()? {
            Of::Convex(cast) => {
                let found = cast.first_contact();
                found
                    .map(Of::Convex)
                    .map_err(|what| query_error(&what, || MotionCase::of(&cast).to_json()))
            }
            Of::Solids(cast) => cast.first_contact().or_raise().map(Of::Solids),
        })
    }
}

impl MotionCast {
    /// How far, of the library; as [`Self::first`].
    fn cleared(slf: &Bound<'_, Self>) -> PyResult<Cleared> {
        let query = slf.clone().unbind();
        patiently(slf.py(), &slf.get().bodies, move || match query.get().asked()? {
            Of::Convex(cast) => {
                let found = cast.clearance();
                found
                    .map(Of::Convex)
                    .map_err(|what| query_error(&what, || MotionCase::of(&cast).to_json()))
            }
            Of::Solids(cast) => cast.clearance().or_raise().map(Of::Solids),
        })
    }
}

pub(crate) const EITHER: &str = "convex bodies have either keep or tolerance";

/// Of convex bodies.
pub(crate) fn convex_cast<'a>(
    [p, q]: [&'a ConvexPolyhedron; 2],
    [a, b]: [&'a motion::Motion; 2],
    keep: f64,
    tolerance: Option<f64>,
) -> Result<motion::MotionCast<'a>, QueryError> {
    let cast = motion::MotionCast::new(p.along(a), q.along(b))?;
    match tolerance {
        // Both: what is to be kept is refused where it is none, and one takes the place of the other.
        Some(depth) => cast.keeping(keep)?.tolerating(depth),
        None => cast.keeping(keep),
    }
}

/// Of solids.
pub(crate) fn solid_cast<'a>(
    [p, q]: [&'a Solid; 2],
    [a, b]: [&'a motion::Motion; 2],
    precisions: [f64; 2],
    keep: f64,
    tolerance: Option<f64>,
) -> Result<motion::MotionCast<'a, Solid>, QueryError> {
    between_motions(p.along(a), q.along(b), precisions, tolerance)?.keeping(keep)
}

getters!(MotionCast, |it| {
    /// ConvexPolyhedron or Solid: The moving body.
    moving(py): Py<PyAny> = it.bodies[0].object(py);
    /// ConvexPolyhedron or Solid: The fixed body.
    fixed(py): Py<PyAny> = it.bodies[1].object(py);
    /// Motion: What the moving body does.
    moving_motion: Motion = Motion(it.motions[0].clone());
    /// Motion: What the fixed body does.
    fixed_motion: Motion = Motion(it.motions[1].clone());
    /// float: The gap to be kept; 0 if there is none.
    keep: f64 = it.keep;
    /// float: The depth that is tolerated; of solids the tolerance that is used.
    tolerance: PyResult<f64> = Ok(match it.asked()? {
        Of::Convex(cast) => cast.tolerance(),
        Of::Solids(cast) => cast.tolerance(),
    });
    /// bool: Whether what overlaps when the motion begins is ignored.
    ignore_start_overlaps: bool = it.start_overlap == StartOverlap::Ignore;
});

#[pymethods]
impl MotionCast {
    #[new]
    #[pyo3(signature = (moving, fixed, *, moving_motion=None, fixed_motion=None, keep=0.0,
        tolerance=None, ignore_start_overlaps=false))]
    fn new(
        moving: &Bound<'_, PyAny>,
        fixed: &Bound<'_, PyAny>,
        moving_motion: Option<&Bound<'_, PyAny>>,
        fixed_motion: Option<&Bound<'_, PyAny>>,
        keep: f64,
        tolerance: Option<f64>,
        ignore_start_overlaps: bool,
    ) -> PyResult<Self> {
        let motions = [moving_motion, fixed_motion];
        let query = Self::of([moving, fixed], motions, keep, tolerance, ignore_start_overlaps)?;
        if let [Piece::Convex(_), Piece::Convex(_)] = query.bodies {
            if tolerance.is_some() && keep != 0.0 {
                return Err(error("QueryError", EITHER));
            }
            if ignore_start_overlaps {
                return Err(error("QueryError", "ignore_start_overlaps is for solids"));
            }
        }
        query.asked()?;
        Ok(query)
    }

    /// When do the bodies first meet? See :func:`first_contact`.
    fn first_contact(slf: &Bound<'_, Self>) -> PyResult<FirstContact> {
        Ok(FirstContact { found: Self::first(slf)?, query: slf.clone().unbind() })
    }

    /// How far can the body go? See :func:`motion_clearance`.
    fn clearance(slf: &Bound<'_, Self>) -> PyResult<MotionClearance> {
        Ok(MotionClearance { found: Self::cleared(slf)?, query: slf.clone().unbind() })
    }

    /// The question as text, of convex bodies: bodies, motions and what is to be kept, exact in bits.
    ///
    /// ``colltrans replay`` of the command line reads the same.
    fn to_json(&self) -> PyResult<String> {
        match self.asked()? {
            Of::Convex(cast) => Ok(MotionCase::of(&cast).to_json()),
            Of::Solids(_) => Err(error("CaseError", "a motion of solids has no file")),
        }
    }

    /// From what `to_json`, or the command line, has written.
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
            keep: cast.keep(),
            tolerance: Some(cast.tolerance()).filter(|depth| *depth > 0.0),
            start_overlap: StartOverlap::Refuse,
        })
    }

    /// A picture of the bodies at the start, where they touch and at the end: see :func:`colltrans.show`.
    #[pyo3(signature = (**options))]
    fn show<'py>(slf: &Bound<'py, Self>, options: Option<Options<'_, 'py>>) -> Shown<'py> {
        show(slf, options)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> Shown<'py> {
        html(slf)
    }

    /// The arguments that make it once more, for `pickle` and `copy`.
    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<Arguments<'py>> {
        let named = PyDict::new(py);
        named.set_item("moving_motion", self.moving_motion())?;
        named.set_item("fixed_motion", self.fixed_motion())?;
        named.set_item("keep", self.keep)?;
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

/// An answer; those of solids are proven when that is asked for.
type Found = Of<MotionOutcome, MotionOutcome<()>>;

/// When two bodies that move first meet, from 0 at the start of the motion to 1 at its end.
///
/// ``outcome`` is ``"contact"``: they do not meet before ``lower``, and at ``upper`` they do;
/// ``"grazing"``: they come nearer than rounding can tell, not before ``lower``, and nothing is said
/// after it; ``"free"``: they never meet throughout the motion (never come as near as the gap to be kept, or
/// never overlap by more than the tolerance); ``"overlapping"``: they overlap when it begins;
/// ``"undecided"``: the search took its maximum number of steps, they do not meet before ``lower``, and whether
/// they do later is open.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct FirstContact {
    found: Found,
    query: Py<MotionCast>,
}

answer!(FirstContact("outcome", "lower", "upper") of Found, MotionCast, |it| it.found.clone());

/// What there is of a contact, of either kind.
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
    /// float: The bodies do not meet before: 1 if they never do, 0 if they overlap when the motion begins.
    lower: f64 = {
        let free = matches!(
            it.found,
            Of::Convex(MotionOutcome::Free(_)) | Of::Solids(MotionOutcome::Free(_))
        );
        let none = if free { 1.0 } else { 0.0 };
        contact!(it.found, contact => contact.lower).unwrap_or(none)
    };
    /// float or None: At this time they do meet; None where that is not proven, or they never do.
    upper: Option<f64> = {
        let overlapping = matches!(
            it.found,
            Of::Convex(MotionOutcome::Overlapping(_)) | Of::Solids(MotionOutcome::Overlapping(_))
        );
        let upper =
            contact!(it.found, contact => contact.upper).filter(|upper| upper.is_finite());
        upper.or(overlapping.then_some(0.0))
    };
    /// tuple of (Pose, Pose) or None: Where both bodies are at ``lower``, to rounding; None if they never
    /// meet or overlap at the start.
    poses: Option<(Pose, Pose)> =
        contact!(it.found, contact => (Pose(contact.poses[0]), Pose(contact.poses[1])));
    /// ndarray of shape (3,) or None: The point of the fixed body that is nearest then, in the world.
    point(py): Option<Vector<'py>> =
        contact!(it.found, contact => contact.points)?.map(|points| row(py, points[1]));
    /// ndarray of shape (3,) or None: Unit normal in the world, from the moving body to the fixed one.
    normal(py): Option<Vector<'py>> =
        contact!(it.found, contact => contact.normal)?.map(|normal| row(py, normal));
    /// Features or None: What of each body faces the other one.
    features: PyResult<Option<Features>> = {
        let features = contact!(it.found, contact => contact.features).flatten();
        let Some(colltrans::Features { moving, fixed }) = features else { return Ok(None) };
        let of = |moving, fixed| Ok(Some(Features { moving, fixed }));
        match it.query.get().asked()? {
            Of::Convex(cast) => {
                let [p, q] = cast.bodies();
                of(Feature::of(moving, p), Feature::of(fixed, q))
            }
            Of::Solids(cast) => {
                let [p, q] = cast.bodies();
                of(Feature::of(moving, p), Feature::of(fixed, q))
            }
        }
    };
    /// int: At how many times the bodies were looked at.
    looks: u32 = match &it.found {
        Of::Convex(found) => found.steps().looks,
        Of::Solids(found) => found.steps().looks,
    };
});

#[pymethods]
impl FirstContact {
    /// Checks the proof against the bodies alone; between solids they are asked once more for it.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     What is not proven.
    fn verify(&self, py: Python<'_>) -> PyResult<()> {
        let (query, found) = (self.query.clone_ref(py), self.found.clone());
        let refused = |what: motion::MotionProofError| error("CertificateError", what);
        patiently(py, &self.query.get().bodies, move || {
            match (query.get().asked()?, &found) {
                (Of::Convex(cast), Of::Convex(found)) => cast.verify(found.proof()),
                (Of::Solids(cast), _) => {
                    cast.verify(cast.certified_first_contact().or_raise()?.proof())
                }
                _ => return Err(other_bodies()),
            }
            .map(|_| ())
            .map_err(refused)
        })
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let outcome = self.outcome(py)?;
        let upper = self.upper().map_or_else(|| "None".into(), |upper| format!("{upper:?}"));
        Ok(format!("FirstContact({outcome:?}, lower={:?}, upper={upper})", self.lower()))
    }
}

/// An answer that is not of the bodies that it comes with.
fn other_bodies() -> PyErr {
    error("CaseError", "an answer of other bodies")
}

impl Answer for Found {
    type Query = MotionCast;

    fn object<'py>(self, query: &Bound<'py, MotionCast>) -> PyResult<Bound<'py, PyAny>> {
        object(query.py(), FirstContact { found: self, query: query.clone().unbind() })
    }

    fn record(&self, query: &Bound<'_, MotionCast>) -> PyResult<Record> {
        match (self, query.get().asked()?) {
            (Self::Convex(found), Of::Convex(cast)) => Ok(MotionRecord::of(found, &cast).into()),
            (Self::Solids(found), Of::Solids(cast)) => {
                Ok(MotionRecord::of_solids(found, &cast).into())
            }
            _ => Err(other_bodies()),
        }
    }

    fn proof(&self, query: &Bound<'_, MotionCast>) -> PyResult<String> {
        match (self, query.get().asked()?) {
            (Self::Convex(found), Of::Convex(cast)) => {
                Ok(ProofFile::of_motion(&cast, found).to_json())
            }
            (Self::Solids(_), Of::Solids(cast)) => solid_proof(&cast),
            _ => Err(other_bodies()),
        }
    }
}

/// The proof of a first contact of solids, which are asked once more for it.
fn solid_proof(cast: &motion::MotionCast<'_, Solid>) -> PyResult<String> {
    ProofFile::with_solid_motion(cast).map(|(_, file)| file.to_json()).or_raise()
}

/// An answer about how far a body can go; those of solids are proven when that is asked for.
type Cleared = Of<motion::MotionClearance, motion::MotionClearance<()>>;

/// How far along its motion a body can go, from 0 at its start to 1 at its end.
///
/// ``outcome`` is ``"blocked"``: up to ``time`` for certain, 0 if it is pushed in at once; ``"free"``: to the
/// end; ``"overlapping"``: the bodies overlap when the motion begins, by more than is tolerated.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct MotionClearance {
    found: Cleared,
    query: Py<MotionCast>,
}

answer!(MotionClearance("outcome", "time") of Cleared, MotionCast, |it| it.found.clone());

/// What stops a body: the bounds of when that meets in its true place, the tolerance, and the bounds of when the bodies
/// meet as it leaves them.
struct Stop {
    place: [f64; 2],
    tolerance: f64,
    shrunk: [f64; 2],
}

impl Stop {
    fn of<P>(found: &motion::MotionClearance<P>) -> Option<Self> {
        let motion::MotionClearance::Blocked { contact, .. } = found else { return None };
        let (place, shrunk) = (contact.time, &contact.shrunk);
        Some(Self {
            place: [place.lower, place.upper],
            tolerance: contact.tolerance,
            shrunk: [shrunk.lower, shrunk.upper],
        })
    }
}

/// Bounds as Python has them: none where one is not proven.
fn bounds([lower, upper]: [f64; 2]) -> (f64, Option<f64>) {
    (lower, Some(upper).filter(|upper| upper.is_finite()))
}

impl MotionClearance {
    fn stop(&self) -> Option<Stop> {
        match &self.found {
            Of::Convex(found) => Stop::of(found),
            Of::Solids(found) => Stop::of(found),
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
    /// float or None: Up to then the body may go: 1 to the end; None if the bodies overlap when it begins.
    time: Option<f64> = match &it.found {
        Of::Convex(found) => found.time(),
        Of::Solids(found) => found.time(),
    };
    /// tuple of (float, float or None) or None: When what stops it meets in its true place: not before the
    /// first, for certain at the second, if there is one.
    bounds: Option<(f64, Option<f64>)> = it.stop().map(|stop| bounds(stop.place));
    /// tuple of (float, float or None) or None: When the bodies meet as the tolerance leaves them.
    shrunk: Option<(f64, Option<f64>)> = it.stop().map(|stop| bounds(stop.shrunk));
    /// float or None: The tolerance that was used, a length, where something stops it.
    tolerance: Option<f64> = it.stop().map(|stop| stop.tolerance);
    /// float or None: The least tolerance with which the bodies would not overlap when the motion begins.
    least_tolerance: Option<f64> = match &it.found {
        Of::Convex(motion::MotionClearance::Overlapping(found))
        | Of::Solids(motion::MotionClearance::Overlapping(found)) => found.least_tolerance,
        _ => None,
    };
});

#[pymethods]
impl MotionClearance {
    /// Checks the proof of the bounds ``shrunk`` against the bodies alone; between solids they are asked once
    /// more for it.
    ///
    /// Raises
    /// ------
    /// CertificateError
    ///     What is not proven; all, of bodies that overlap when the motion begins, or may.
    fn verify(&self, py: Python<'_>) -> PyResult<()> {
        let (query, found) = (self.query.clone_ref(py), self.found.clone());
        let refused = |what: motion::MotionProofError| error("CertificateError", what);
        patiently(py, &self.query.get().bodies, move || {
            match (query.get().asked()?, &found) {
                (Of::Convex(cast), Of::Convex(found)) => {
                    let outcome = first_of(found).ok_or_else(unproven)?;
                    cast.cleared().verify(outcome.proof())
                }
                (Of::Solids(cast), Of::Solids(found)) => {
                    if first_of(found).is_none() || query.get().ignore_start_overlaps() {
                        return Err(unproven());
                    }
                    cast.verify(cast.certified_first_contact().or_raise()?.proof())
                }
                _ => return Err(other_bodies()),
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

fn unproven() -> PyErr {
    error("CertificateError", "of bodies that overlap when the motion begins nothing is proven")
}

/// The first contact of the bodies as the tolerance leaves them, of which a clearance is made.
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
            _ => Err(other_bodies()),
        }
    }

    fn proof(&self, query: &Bound<'_, MotionCast>) -> PyResult<String> {
        match (self, query.get().asked()?) {
            (Self::Convex(found), Of::Convex(cast)) => {
                let outcome = first_of(found).ok_or_else(unproven)?;
                Ok(ProofFile::of_motion(&cast.cleared(), &outcome).to_json())
            }
            (Self::Solids(found), Of::Solids(cast)) => {
                if first_of(found).is_none() || query.get().ignore_start_overlaps() {
                    return Err(unproven());
                }
                solid_proof(&cast)
            }
            _ => Err(other_bodies()),
        }
    }
}

/// When do two bodies that move first meet?
///
/// Parameters
/// ----------
/// moving, fixed, moving_motion, fixed_motion, keep, tolerance
///     As for :class:`MotionCast`.
///
/// Returns
/// -------
/// FirstContact
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron, Motion, first_contact
/// >>> cube = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
/// >>> slide = Motion.slide([8, 0, 0], pose=[-4, 0.5, 0])
/// >>> found = first_contact(cube, cube, slide)
/// >>> found.lower <= 0.375 <= found.upper, found.normal
/// (True, array([1., 0., 0.]))
#[pyfunction]
#[pyo3(signature = (moving, fixed, moving_motion, fixed_motion=None, *, keep=0.0, tolerance=None))]
pub(crate) fn first_contact(
    py: Python<'_>,
    moving: &Bound<'_, PyAny>,
    fixed: &Bound<'_, PyAny>,
    moving_motion: &Bound<'_, PyAny>,
    fixed_motion: Option<&Bound<'_, PyAny>>,
    keep: f64,
    tolerance: Option<f64>,
) -> PyResult<FirstContact> {
    let motions = [Some(moving_motion), fixed_motion];
    let query = MotionCast::new(moving, fixed, motions[0], motions[1], keep, tolerance, false)?;
    MotionCast::first_contact(&Bound::new(py, query)?)
}

/// How far along its motion can a body go? What touches may slide, turn and leave, and is stopped where it
/// is pushed in: with the tolerance, or without one with what rounding can do to a fit.
///
/// Parameters
/// ----------
/// moving, fixed, moving_motion, fixed_motion, keep, tolerance, ignore_start_overlaps
///     As for :class:`MotionCast`.
///
/// Returns
/// -------
/// MotionClearance
///
/// Examples
/// --------
/// >>> from colltrans import ConvexPolyhedron, Motion, motion_clearance
/// >>> block = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
/// >>> table = ConvexPolyhedron.cuboid([-4, -4, -1], [4, 4, 0])
/// >>> motion_clearance(block, table, Motion.turn([0.5, 0.5, 0], [0, 0, 1], radians=2))
/// MotionClearance("free", time=1.0)
/// >>> motion_clearance(block, table, Motion.turn([0.5, 0.5, 0], [1, 0, 0], radians=2))
/// MotionClearance("blocked", time=0.0)
#[pyfunction]
#[pyo3(signature = (moving, fixed, moving_motion, fixed_motion=None, *, keep=0.0, tolerance=None,
    ignore_start_overlaps=false))]
#[expect(clippy::too_many_arguments, reason = "they are keywords")]
pub(crate) fn motion_clearance(
    py: Python<'_>,
    moving: &Bound<'_, PyAny>,
    fixed: &Bound<'_, PyAny>,
    moving_motion: &Bound<'_, PyAny>,
    fixed_motion: Option<&Bound<'_, PyAny>>,
    keep: f64,
    tolerance: Option<f64>,
    ignore_start_overlaps: bool,
) -> PyResult<MotionClearance> {
    let query = MotionCast::new(
        moving,
        fixed,
        Some(moving_motion),
        fixed_motion,
        keep,
        tolerance,
        ignore_start_overlaps,
    )?;
    MotionCast::clearance(&Bound::new(py, query)?)
}
