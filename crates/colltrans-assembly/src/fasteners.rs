//! Recognises fasteners and other standard parts from their shape and name: screws, nuts, washers, dowels, circlips,
//! keys and bearings.
//!
//! A part is measured about an axis of its inertia (module `profile`) and compared with the shapes of each kind
//! (`shapes`) and with standard sizes (`sizes`). The shape decides. A name alone (`names`) is never enough. It is
//! needed where other parts have the same shape: plain cylinders of unusual size, heads without a drive, boxes, rings.
//!
//! Lengths are in the unit of the files, sizes of standards in millimetres. Without a unit, the files count as
//! millimetres. Diameters are accurate to 0.1 %, with a modelled thread to 1 %. A metric size is at most 4 % off, or
//! 20 % if the name states it (a shank drawn at its core). The result names parts and affects the order of a plan,
//! never which directions are free.

mod holds;
mod names;
mod profile;
mod shapes;
mod sizes;

use colltrans::Solid;
use glam::DVec3;
use rayon::prelude::*;

use crate::bodies::Bodies;
use crate::error::AssemblyError;
use crate::part::{Assembly, Part};
use crate::{cylinders, inertia, units};
pub use holds::{Hold, Unscrewing};
use names::{NamedFastener, read_name};
use profile::Profile;
use shapes::Shape;
use sizes::length_text;

/// Minimum share of the lateral area that faces the axis or away from it.
const MIN_REVOLVED_SHARE: f64 = 0.72;
/// Maximum relative deviation of a diameter from the size that the name states.
const MAX_NAMED_DEVIATION: f64 = 0.2;
/// Maximum number of facets of a key.
const MAX_KEY_FACETS: usize = 4_000;
/// Maximum height of a named washer, in outer diameters.
const MAX_WASHER_HEIGHT: f64 = 0.5;

/// Kind of a fastener.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FastenerKind {
    /// A screw, a bolt, a set screw or a stud.
    Screw,
    /// A hexagon nut.
    Nut,
    /// A washer.
    Washer,
    /// A dowel: a solid cylinder that locates parts.
    Dowel,
    /// A circlip: a thin open ring.
    Circlip,
    /// A parallel key.
    Key,
    /// A bearing as one part.
    Bearing,
}

/// Form of the head of a screw.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Head {
    /// A hexagon.
    Hexagon,
    /// A hexagon with a flange.
    FlangedHexagon,
    /// A cylinder.
    Cylinder,
    /// A cone below a flat top.
    Countersunk,
    /// A dome, a pan or another surface of revolution.
    Rounded,
    /// No head.
    None,
}

/// Recess of the head of a screw.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Drive {
    /// A hexagon socket; its width is that across flats.
    HexSocket,
    /// A hexalobular socket; its width is the largest diameter.
    Hexalobular,
    /// A square socket.
    SquareSocket,
    /// A cross.
    Cross,
    /// A slot.
    Slot,
}

/// A recognised part. Lengths are in the unit of the files.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Fastener {
    /// The kind.
    pub kind: FastenerKind,
    /// A point on the axis, and its unit direction: of a screw from the tip to the head. For a key, the direction of
    /// its length.
    pub axis: [DVec3; 2],
    /// Coordinates along the axis, measured from its point, at which the part begins and ends.
    pub range: [f64; 2],
    /// Diameter of the shank or cylinder, diameter of the hole, or width of a key.
    pub diameter: f64,
    /// Nominal length of a screw (without the head, unless it is countersunk), length of a dowel or key, or height.
    pub length: f64,
    /// Width of the head (across flats of a hexagon), outer diameter, width across flats of a nut, or height of a key.
    pub width: f64,
    /// Form of the head of a screw.
    pub head: Option<Head>,
    /// Height of the head; 0 without one.
    pub head_height: f64,
    /// Recess of the head, and its width.
    pub drive: Option<(Drive, f64)>,
    /// Pitch of the modelled thread, negative for a left-handed one; `None` if the thread is plain.
    pub pitch: Option<f64>,
    /// Coarse pitch of the metric size; `None` without one.
    pub standard_pitch: Option<f64>,
    /// Nominal diameter of the metric thread in millimetres; `None` if no metric size is near enough.
    pub metric: Option<f64>,
    /// Designation in millimetres, for example `M5 x 20`, `6 x 20`, `608`.
    pub designation: String,
    /// Whether the kind rests on the name too, because other parts have this shape.
    pub needs_name: bool,
}

/// The fasteners of an assembly.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Fasteners {
    parts: Vec<Option<Fastener>>,
    holds: Vec<Hold>,
    work: u64,
}

impl FastenerKind {
    /// Returns the kind as a word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Screw => "screw",
            Self::Nut => "nut",
            Self::Washer => "washer",
            Self::Dowel => "dowel",
            Self::Circlip => "circlip",
            Self::Key => "key",
            Self::Bearing => "bearing",
        }
    }
}

impl Head {
    /// Checks whether a tool grips the head from outside.
    pub const fn is_hexagonal(self) -> bool {
        matches!(self, Self::Hexagon | Self::FlangedHexagon)
    }

    /// Returns the form as a word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hexagon => "hexagon",
            Self::FlangedHexagon => "flanged hexagon",
            Self::Cylinder => "cylinder",
            Self::Countersunk => "countersunk",
            Self::Rounded => "rounded",
            Self::None => "none",
        }
    }
}

impl Drive {
    /// Returns the recess as words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::HexSocket => "hexagon socket",
            Self::Hexalobular => "hexalobular socket",
            Self::SquareSocket => "square socket",
            Self::Cross => "cross",
            Self::Slot => "slot",
        }
    }
}

impl Fastener {
    /// Recognises a part of an assembly whose unit is `scale` millimetres long. Returns `None` if the part is none of
    /// these. Adds the number of visits of facets and vertices to `work`.
    pub fn recognise(part: &Part, scale: f64, work: &mut u64) -> Option<Self> {
        if part.is_surface() {
            return None;
        }
        let (solid, named) = (part.solid(), read_name(part.name()));
        let principal = inertia::principal_axes(solid);
        *work += solid.triangles().len() as u64;
        let axes = if principal.is_empty() {
            *work += 3 * solid.triangles().len() as u64;
            cylinders::cylinder_axes(solid).into_iter().map(|(_, axis)| axis).collect()
        } else {
            principal
        };
        for axis in axes {
            let Some(mut profile) = Profile::new(solid, axis) else { continue };
            let is_round = profile.revolved_share() >= MIN_REVOLVED_SHARE;
            let (shape, profile) =
                if is_round { shapes::recognise_profile(profile, scale) } else { (None, profile) };
            *work += profile.work;
            if let Some(shape) = shape.and_then(|shape| confirmed_shape(shape, named)) {
                return Some(Self::from_shape(&shape, (profile.axis, profile.range), scale, named));
            }
        }
        recognise_key(solid, scale, named, work)
    }

    /// Builds the description of a shape.
    fn from_shape(
        shape: &Shape,
        (axis, range): ([DVec3; 2], [f64; 2]),
        scale: f64,
        named: NamedFastener,
    ) -> Self {
        let [d, length, width] = [shape.diameter, shape.length, shape.width].map(|x| x * scale);
        let stated = named.diameter.and_then(sizes::metric_named).filter(|m| {
            matches!(shape.kind, FastenerKind::Screw | FastenerKind::Nut | FastenerKind::Washer)
                && sizes::agrees(d, m.diameter, MAX_NAMED_DEVIATION)
        });
        let metric = stated.or_else(|| match shape.kind {
            FastenerKind::Screw => sizes::nearest_metric(d),
            FastenerKind::Nut => sizes::metric_nut(shape.hole.map(|x| x * scale / 2.0), width),
            FastenerKind::Washer => sizes::metric_washer(d),
            _ => None,
        });
        let text = length_text;
        let size = metric.map_or_else(|| sizes::diameter_text(d), |m| format!("M{}", m.diameter));
        let three = || format!("{size} x {} x {}", text(width), text(length));
        let designation = match shape.kind {
            FastenerKind::Nut => size,
            FastenerKind::Washer if metric.is_some() => size,
            FastenerKind::Screw | FastenerKind::Dowel | FastenerKind::Circlip => {
                format!("{size} x {}", text(length))
            }
            FastenerKind::Washer | FastenerKind::Key => three(),
            FastenerKind::Bearing => {
                sizes::bearing([d, width, length]).map_or_else(three, str::to_owned)
            }
        };
        Self {
            kind: shape.kind,
            axis,
            range,
            diameter: shape.diameter,
            length: shape.length,
            width: shape.width,
            head: shape.head,
            head_height: shape.head_height,
            drive: shape.drive,
            pitch: shape.pitch,
            standard_pitch: metric.map(|m| m.pitch / scale),
            metric: metric.map(|m| m.diameter),
            designation,
            needs_name: shape.needs_name,
        }
    }

    /// Returns the kind and the designation: `screw M5 x 20`.
    pub fn title(&self) -> String {
        format!("{} {}", self.kind.name(), self.designation)
    }

    /// Returns the form of the head, the drive and the thread of a screw, or the sizes of another fastener.
    pub fn details(&self) -> String {
        let mut words = Vec::new();
        match self.head {
            Some(Head::None) => words.push("without head".to_owned()),
            Some(head) => words.push(format!("{} head", head.name())),
            None => (),
        }
        words.extend(self.drive.map(|(drive, _)| drive.name().to_owned()));
        if self.kind == FastenerKind::Screw {
            let plain = "thread not modelled".to_owned();
            words.push(self.pitch.map_or(plain, |pitch| {
                let hand = if pitch < 0.0 { "left-handed " } else { "" };
                format!("{hand}thread modelled")
            }));
        }
        if self.needs_name {
            words.push("by its name".to_owned());
        }
        words.join(", ")
    }
}

/// Returns the shape if the name need not or does confirm it. A name may turn a thick ring into a washer.
fn confirmed_shape(shape: Shape, named: NamedFastener) -> Option<Shape> {
    let is_ring = shape.kind == FastenerKind::Bearing && shape.needs_name;
    if is_ring
        && named.kind == Some(FastenerKind::Washer)
        && shape.length < MAX_WASHER_HEIGHT * shape.width
    {
        return Some(Shape { kind: FastenerKind::Washer, ..shape });
    }
    (!shape.needs_name || named.kind == Some(shape.kind)).then_some(shape)
}

/// Recognises a parallel key: a box with flat or round ends.
fn recognise_key(
    solid: &Solid,
    scale: f64,
    named: NamedFastener,
    work: &mut u64,
) -> Option<Fastener> {
    if solid.triangles().len() > MAX_KEY_FACETS {
        return None;
    }
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| solid.vertices()[v as usize]);
        (b - a).cross(c - a)
    };
    let largest = |across: Option<DVec3>| {
        let areas = solid.triangles().iter().map(area);
        let usable = |n: &DVec3| across.is_none_or(|axis| n.dot(axis).abs() < 0.01 * n.length());
        let best = areas.filter(usable).max_by(|a, b| a.length().total_cmp(&b.length()));
        best.and_then(DVec3::try_normalize)
    };
    let first = largest(None)?;
    let second = largest(Some(first))?;
    let directions = [first, second, first.cross(second)];
    let range = |d: DVec3| {
        let along = solid.vertices().iter().map(|p| p.dot(d));
        along.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)])
    };
    let ranges = directions.map(range);
    *work += 6 * solid.triangles().len() as u64;
    let extents = ranges.map(|[low, high]| high - low);
    let shape = shapes::key_shape(extents, solid.volume(), scale)?;
    let shape = confirmed_shape(shape, named)?;
    let k = (0..3).max_by(|&a, &b| extents[a].total_cmp(&extents[b]))?;
    let middle = |j: usize| directions[j] * ranges[j][0].midpoint(ranges[j][1]);
    let point = middle((k + 1) % 3) + middle((k + 2) % 3);
    Some(Fastener::from_shape(&shape, ([point, directions[k]], ranges[k]), scale, named))
}

/// Returns the length of the unit of an assembly in millimetres; 1 if the unit is unknown.
pub(crate) fn millimetres_per_unit(assembly: &Assembly) -> f64 {
    assembly.unit().and_then(units::unit_in_metres).map_or(1.0, |metres| metres * 1e3)
}

impl Fasteners {
    /// Recognises the fasteners of an assembly.
    pub fn find(assembly: &Assembly) -> Self {
        let scale = millimetres_per_unit(assembly);
        let examine = |part: &Part| {
            let mut work = 0;
            let found = Fastener::recognise(part, scale, &mut work);
            (found, work)
        };
        let all: Vec<(Option<Fastener>, u64)> = assembly.parts().par_iter().map(examine).collect();
        let work = all.iter().map(|(_, work)| work).sum();
        let parts = all.into_iter().map(|(found, _)| found).collect();
        Self { parts, holds: Vec::new(), work }
    }

    /// Recognises the fasteners of an assembly, and finds the parts that screws and dowels connect.
    ///
    /// # Errors
    /// [`AssemblyError::TooMany`] if too many boxes of parts intersect.
    pub fn with_holds(bodies: &Bodies) -> Result<Self, AssemblyError> {
        let found = Self::find(bodies.assembly());
        Ok(Self { holds: holds::find_holds(bodies, &found)?, ..found })
    }

    /// Returns the connections by screws and dowels; empty unless [`Self::with_holds`] found them.
    pub fn holds(&self) -> &[Hold] {
        &self.holds
    }

    /// Returns the first connection whose screw or dowel, or whose seat, is this part; `None` without one.
    pub(crate) fn hold_of(&self, part: usize) -> Option<&Hold> {
        self.holds.iter().find(|hold| hold.fastener == part || hold.seat == part)
    }

    /// Returns the fastener that a part is; `None` if it is none.
    pub fn get(&self, part: usize) -> Option<&Fastener> {
        self.parts.get(part).and_then(Option::as_ref)
    }

    /// Iterates over the fasteners with the indices of their parts.
    pub fn recognised(&self) -> impl Iterator<Item = (usize, &Fastener)> {
        self.parts.iter().enumerate().filter_map(|(k, found)| Some((k, found.as_ref()?)))
    }

    /// Checks whether no part is a fastener.
    pub fn is_empty(&self) -> bool {
        self.recognised().next().is_none()
    }

    /// Returns the number of visits of facets and vertices by the recognition.
    pub const fn work(&self) -> u64 {
        self.work
    }
}
