//! Answers of queries about solids.

use colltrans::record::{Record, SolidClearanceRecord, StartOverlapRecord};
use colltrans::solid::SolidCast as _;
use colltrans::solid::{Overlap, SolidOverlap, StartOverlap};
use colltrans::{Clearance, ProofFile};
use pyo3::prelude::*;

use crate::answer::{Answer, answer, object};
use crate::arrays::{Vector, coordinates, row};
use crate::errors::{OrRaise, error};
use crate::features::Feature;
use crate::frozen::getters;
use crate::number::number;
use crate::solid::Piece;
use crate::solid_cast::SolidCast;

type SolidClearance = Clearance<colltrans::Solid>;
type SolidOutcome = colltrans::Outcome<colltrans::Solid>;

/// The contact that stops a solid, or the first contact of a cast.
///
/// :meth:`to_dict` and the proof are those of the clearance: the travel from the pose of the moving body. They say
/// nothing about negative translations, and a contact behind the pose has neither: both raise a CaseError.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct SolidContact {
    contact: colltrans::solid::SolidContact,
    query: Py<SolidCast>,
}

answer!(SolidContact("translation", "normal", "point") of colltrans::solid::SolidContact, SolidCast, |it| it.contact);

getters!(SolidContact, |it| {
    /// float: The translation at which the faces that stop the body meet in their nominal position, in
    /// multiples of the direction; the best estimate.
    translation: f64 = it.contact.translation.value;
    /// tuple of (float, float): Proven bounds of the translation. Up to the first one the shrunk bodies do
    /// not overlap and these two faces have not met. Beyond the second one the nominal bodies overlap, or the
    /// shrunk bodies if the nominal faces pass each other.
    translation_bounds: (f64, f64) = it.contact.translation.bounds().into();
    /// float: The first of :attr:`translation_bounds`.
    lower: f64 = it.contact.translation.lower;
    /// float: The second of :attr:`translation_bounds`.
    upper: f64 = it.contact.translation.upper;
    /// float: The free travel of the bodies shrunk by half the tolerance each, in multiples of the direction.
    offset_distance: f64 = it.contact.offset_distance.value;
    /// tuple of (float, float): Proven bounds of the free travel of the shrunk bodies.
    offset_distance_bounds: (f64, f64) = it.contact.offset_distance.bounds().into();
    /// ndarray of shape (3,): Unit contact normal in the world, from the moving body to the fixed one.
    normal(py): Vector<'py> = row(py, it.contact.normal);
    /// ndarray of shape (3,): The contact point on the fixed body, in the world.
    point(py): Vector<'py> = row(py, it.contact.point_on_fixed);
    /// ndarray of shape (3,): The contact point on the moving body at its start pose, in the world.
    point_at_start(py): Vector<'py> = row(py, it.contact.point_on_moving);
    /// Feature: The feature of the moving body in contact: a vertex, a whole edge, or the whole polygon of a
    /// face.
    moving_feature: PyResult<Feature> =
        convert_feature(it.contact.moving_feature, &it.query.get().bodies[0]);
    /// Feature: The feature of the fixed body in contact.
    fixed_feature: PyResult<Feature> = convert_feature(it.contact.fixed_feature, &it.query.get().bodies[1]);
});

number!(SolidContact, f64, |it| it.contact.translation.value,
    /// float: The :attr:`translation`.
);

#[pymethods]
impl SolidContact {
    fn __repr__(&self) -> String {
        let (t, n) = (self.contact.translation.value, coordinates(self.contact.normal));
        format!("SolidContact(translation={t:?}, normal={n:?})")
    }
}

fn convert_feature(feature: colltrans::Feature, body: &Piece) -> PyResult<Feature> {
    Ok(Feature::from_feature(feature, body.solid().or_raise()?))
}

/// A solid can move until it touches.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct SolidBlocked {
    distance: f64,
    contact: colltrans::solid::SolidContact,
    query: Py<SolidCast>,
}

answer!(SolidBlocked("distance", "contact") of SolidClearance, SolidCast, |it| {
    SolidClearance::Blocked { distance: it.distance, contact: it.contact }
});

getters!(SolidBlocked, |it| {
    /// float: The free travel in multiples of the direction: the lower bound of the stopping translation,
    /// never negative.
    distance: f64 = it.distance;
    /// float: The :attr:`distance`, which is proven: the shrunk bodies do not overlap up to it.
    lower: f64 = it.distance;
    /// float: A proven upper bound of the translation of the contact that stops the body.
    upper: f64 = it.contact.translation.upper.max(0.0);
    /// SolidContact: The contact that stops the body.
    contact(py): SolidContact = SolidContact { contact: it.contact, query: it.query(py) };
    /// list of str: The bodies, ``moving`` or ``fixed``, that are open surfaces at least in part; their
    /// interior is not known.
    surfaces: PyResult<Vec<&'static str>> = surface_names(&it.query);
});

number!(SolidBlocked, f64, |it| it.distance,
    /// float: The free travel, :attr:`distance`.
);

#[pymethods]
impl SolidBlocked {
    fn __repr__(&self) -> String {
        format!("SolidBlocked(distance={:?})", self.distance)
    }
}

/// A solid can move without a limit.
///
/// As the answer of :func:`cast` it also states that the bodies do not meet at negative translations. The proof is that
/// of the clearance, which does not cover these.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct SolidFree {
    free: colltrans::solid::SolidFree,
    query: Py<SolidCast>,
}

answer!(SolidFree() of SolidClearance, SolidCast, |it| SolidClearance::Free(it.free));

getters!(SolidFree, |it| {
    /// float: Infinite.
    distance: f64 = f64::INFINITY;
    /// float: Infinite.
    lower: f64 = f64::INFINITY;
    /// float: Infinite.
    upper: f64 = f64::INFINITY;
    /// float or None: The margin of a plane between the bodies, parallel to the direction, a length; None if
    /// no such plane was found, for example because the body slides along the other one, moves away from it, or
    /// passes through a hole.
    margin: Option<f64> = it.free.separation.map(|s| s.margin);
    /// ndarray of shape (3,) or None: Unit normal of that plane, in the world.
    normal(py): Option<Vector<'py>> = it.free.separation.map(|s| row(py, s.normal));
    /// list of str: The bodies, ``moving`` or ``fixed``, that are open surfaces at least in part; their
    /// interior is not known.
    surfaces: PyResult<Vec<&'static str>> = surface_names(&it.query);
});

number!(SolidFree, f64, |_| f64::INFINITY,
    /// float: Infinite, because nothing blocks.
);

#[pymethods]
impl SolidFree {
    fn __repr__(&self) -> &'static str {
        "SolidFree()"
    }
}

/// Two solids overlap at the start by more than the tolerance, or are closer than the minimum gap.
#[pyclass(frozen, module = "colltrans")]
pub(crate) struct SolidOverlapping {
    pub(crate) overlap: SolidOverlap,
    pub(crate) query: Py<SolidCast>,
}

answer!(SolidOverlapping("least_tolerance") of SolidClearance, SolidCast, |it| SolidClearance::Overlapping(it.overlap));

getters!(SolidOverlapping, |it| {
    /// None: An overlap has no clearance.
    distance: Option<f64> = None;
    /// None: An overlap has no clearance.
    lower: Option<f64> = None;
    /// None: An overlap has no clearance.
    upper: Option<f64> = None;
    /// float or None: The smallest tolerance at which the solids would not overlap, a length, rounded up; None if
    /// there is no such tolerance, as for open surfaces.
    least_tolerance: Option<f64> = it.overlap.least_tolerance;
    /// tuple of (int or None, int or None): A place where the bodies, shrunk by half the tolerance each,
    /// overlap: two faces of the input that cross or are closer than the minimum gap, one of each body. If one
    /// entry is None, the shell with the other face is inside that body.
    place: PyResult<(Option<u32>, Option<u32>)> = {
        let [moving, fixed] = &it.query.get().bodies;
        let face = |body: &Piece, at: u32| -> PyResult<_> {
            Ok(Some(body.solid().or_raise()?.facet_indices()[at as usize].0))
        };
        Ok(match it.overlap.place {
            Overlap::Facets(s, t) => (face(moving, s)?, face(fixed, t)?),
            Overlap::MovingInside(s) => (face(moving, s)?, None),
            Overlap::FixedInside(t) => (None, face(fixed, t)?),
        })
    };
    /// list of str: The bodies, ``moving`` or ``fixed``, that are open surfaces at least in part; their
    /// interior is not known.
    surfaces: PyResult<Vec<&'static str>> = surface_names(&it.query);
});

number!(SolidOverlapping, Option<f64>, |_| None,
    /// None: An overlap has no free travel. ``float`` raises a TypeError.
);

#[pymethods]
impl SolidOverlapping {
    fn __repr__(&self) -> String {
        format!(
            "SolidOverlapping(least_tolerance={})",
            self.overlap.least_tolerance.map_or("None".into(), |d| format!("{d:?}"))
        )
    }
}

fn surface_names(query: &Py<SolidCast>) -> PyResult<Vec<&'static str>> {
    let mut found = Vec::new();
    for (name, body) in ["moving", "fixed"].into_iter().zip(&query.get().bodies) {
        if !body.solid().or_raise()?.is_closed() {
            found.push(name);
        }
    }
    Ok(found)
}

/// Rejects a contact of a cast that lies behind the start: records and proofs are those of clearances.
fn refuse_behind(contact: &colltrans::solid::SolidContact) -> PyResult<()> {
    if contact.translation.upper < 0.0 {
        let what = "a contact behind the start has no record and no proof; call clearance()";
        return Err(error("CaseError", what));
    }
    Ok(())
}

/// Builds the proof of a clearance, which depends on the query alone.
fn proof(query: &Bound<'_, SolidCast>) -> PyResult<String> {
    let asked = query.clone().unbind();
    SolidCast::ask(query, move |cast| -> Result<String, PyErr> {
        let [moving, fixed] = &asked.get().bodies;
        let pieces = [moving.pieces().or_raise()?, fixed.pieces().or_raise()?];
        Ok(ProofFile::of_solids(cast, [&pieces[0], &pieces[1]]).or_raise()?.to_json())
    })?
}

impl Answer for SolidClearance {
    type Query = SolidCast;

    fn object<'py>(self, asked: &Bound<'py, SolidCast>) -> PyResult<Bound<'py, PyAny>> {
        let (py, query) = (asked.py(), asked.clone().unbind());
        match self {
            Self::Blocked { distance, contact } => {
                object(py, SolidBlocked { distance, contact, query })
            }
            Self::Free(free) => object(py, SolidFree { free, query }),
            Self::Overlapping(overlap) => object(py, SolidOverlapping { overlap, query }),
        }
    }

    fn record(&self, query: &Bound<'_, SolidCast>) -> PyResult<Record> {
        let clearance = *self;
        SolidCast::ask(query, move |cast| {
            let mut record = SolidClearanceRecord::from_clearance(&clearance, cast.exit(), cast);
            if cast.options().start_overlap == StartOverlap::Ignore {
                record.start_overlaps = cast
                    .start_overlap()
                    .map(|of| StartOverlapRecord {
                        least_tolerance: of.least_tolerance,
                        ..Default::default()
                    })
                    .into_iter()
                    .collect();
            }
            record.into()
        })
    }

    fn proof(&self, query: &Bound<'_, SolidCast>) -> PyResult<String> {
        proof(query)
    }
}

impl Answer for SolidOutcome {
    type Query = SolidCast;

    fn object<'py>(self, query: &Bound<'py, SolidCast>) -> PyResult<Bound<'py, PyAny>> {
        match self {
            Self::Contact(contact) => contact.object(query),
            Self::Grazing(never) => match never {},
            Self::Separated(free) => SolidClearance::Free(free).object(query),
        }
    }

    fn record(&self, query: &Bound<'_, SolidCast>) -> PyResult<Record> {
        match self {
            Self::Contact(contact) => contact.record(query),
            Self::Grazing(never) => match *never {},
            Self::Separated(free) => SolidClearance::Free(*free).record(query),
        }
    }

    fn proof(&self, query: &Bound<'_, SolidCast>) -> PyResult<String> {
        proof(query)
    }
}

impl Answer for colltrans::solid::SolidContact {
    type Query = SolidCast;

    fn object<'py>(self, query: &Bound<'py, SolidCast>) -> PyResult<Bound<'py, PyAny>> {
        object(query.py(), SolidContact { contact: self, query: query.clone().unbind() })
    }

    fn record(&self, query: &Bound<'_, SolidCast>) -> PyResult<Record> {
        refuse_behind(self)?;
        let distance = self.translation.lower.max(0.0);
        SolidClearance::Blocked { distance, contact: *self }.record(query)
    }

    fn proof(&self, query: &Bound<'_, SolidCast>) -> PyResult<String> {
        refuse_behind(self)?;
        proof(query)
    }
}
