//! Candidate directions for removal.
//!
//! Samples of the sphere miss tight fits, whose free directions are isolated. Candidates therefore come from the
//! parts:
//!
//! - the axes of the world,
//! - normals of contacts, and vectors orthogonal to two of them (a pin in a hole, a key in a groove),
//! - axes of cylinders ([`cylinders`]),
//! - principal axes of inertia ([`inertia`]).
//!
//! A direction within [`CandidateOptions::min_angle`] of an earlier one is omitted. The most significant candidates
//! (largest contact, longest cylinder) come first, so that slivers do not replace them.

use colltrans::glam::DVec3;

use rayon::prelude::*;

use crate::bodies::Bodies;
use crate::error::AssemblyError;
use crate::liaisons::Liaison;
use crate::sphere::{angle_between, normalized_direction};
use crate::{cylinders, inertia};

/// Source of a candidate direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CandidateSource {
    /// Given by the caller.
    Given,
    /// An axis of the world.
    World,
    /// The normal of a contact.
    Contact,
    /// Orthogonal to the normals of two contacts of one part.
    Orthogonal,
    /// The axis of a cylinder.
    Cylinder,
    /// A principal axis of inertia.
    Inertia,
    /// A sample of the sphere.
    Sample,
}

impl CandidateSource {
    /// Returns a short name for users.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Given => "given",
            Self::World => "axis of the world",
            Self::Contact => "contact normal",
            Self::Orthogonal => "orthogonal to two contacts",
            Self::Cylinder => "axis of a cylinder",
            Self::Inertia => "principal axis",
            Self::Sample => "sample",
        }
    }
}

/// A candidate direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// The direction, of length 1.
    pub direction: DVec3,
    /// Source of the direction.
    pub source: CandidateSource,
}

/// Options for the choice of candidate directions.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CandidateOptions {
    /// Directions of the caller, of any nonzero length. They are always included.
    pub given: Vec<DVec3>,
    /// Direction of gravity, of any nonzero length. It and its opposite are included like given directions, because
    /// supports are determined along gravity. Ignored if [`search`](Self::search) is false.
    pub gravity: Option<DVec3>,
    /// Whether to search for directions beyond the given ones.
    pub search: bool,
    /// Angle below which two directions are equal, in radians.
    pub min_angle: f64,
    /// Maximum number of directions for all parts in addition to the given ones. Further directions are finer ones.
    pub max_main: usize,
    /// Maximum number of finer directions.
    pub max_finer: usize,
}

impl Default for CandidateOptions {
    fn default() -> Self {
        Self {
            given: Vec::new(),
            gravity: None,
            search: true,
            min_angle: 0.005,
            max_main: 14,
            max_finer: 512,
        }
    }
}

impl CandidateOptions {
    /// Returns the options with other [`given`](Self::given) directions.
    #[must_use]
    pub fn with_given(self, given: Vec<DVec3>) -> Self {
        Self { given, ..self }
    }

    /// Returns the options with another direction of [`gravity`](Self::gravity).
    #[must_use]
    pub fn with_gravity(self, gravity: Option<DVec3>) -> Self {
        Self { gravity, ..self }
    }

    /// Returns the options with [`search`](Self::search) enabled or disabled.
    #[must_use]
    pub fn with_search(self, search: bool) -> Self {
        Self { search, ..self }
    }
}

/// A direction that is tested only for parts that no other direction moves.
#[derive(Debug, Clone, PartialEq)]
pub struct FinerCandidate {
    /// The direction, of length 1.
    pub direction: DVec3,
    /// Source of the direction.
    pub source: CandidateSource,
    /// Index of the part that it comes from; `None` if it may concern any part.
    pub part: Option<usize>,
}

impl FinerCandidate {
    /// Checks whether it comes from a part of the mask.
    pub fn concerns_any_of(&self, parts: &[bool]) -> bool {
        self.part.is_none_or(|part| parts[part])
    }
}

/// The directions to test for all parts, those of the caller first, and finer ones.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Candidates {
    /// Directions to test for all parts.
    pub main: Vec<Candidate>,
    /// Directions to test for parts that none of those moves.
    pub finer: Vec<FinerCandidate>,
}

impl Candidates {
    /// Returns the directions to test for all parts.
    pub fn directions(&self) -> Vec<DVec3> {
        self.main.iter().map(|c| c.direction).collect()
    }
}

/// Computes the candidate directions of an assembly.
///
/// # Errors
/// Returns an error if a direction of the caller is zero or not finite.
pub fn find_candidates(
    bodies: &Bodies,
    liaisons: &[Liaison],
    choice: &CandidateOptions,
) -> Result<Candidates, AssemblyError> {
    let mut main = Vec::new();
    let gravity = choice.gravity.filter(|_| choice.search);
    let both = gravity.into_iter().flat_map(|gravity| [gravity, -gravity]);
    for given in choice.given.iter().copied().chain(both) {
        main.push(Candidate {
            direction: normalized_direction(given)?,
            source: CandidateSource::Given,
        });
    }
    if !choice.search {
        return Ok(Candidates { main, finer: Vec::new() });
    }
    let given = main.len();
    let mut chosen =
        Chosen { found: Candidates { main, finer: Vec::new() }, apart: choice.min_angle };
    for axis in DVec3::AXES {
        chosen.add_main(axis, CandidateSource::World);
    }
    let mut axes: Vec<Axis> = (0..bodies.len())
        .into_par_iter()
        .flat_map_iter(|part| part_axes(bodies, liaisons, part))
        .collect();
    axes.sort_by(|x, y| x.rank.cmp(&y.rank).then(y.weight.total_cmp(&x.weight)));
    for axis in axes {
        if chosen.found.main.len() + 2 <= given + choice.max_main && axis.rank < 2 {
            chosen.add_main(axis.along, axis.origin);
        } else if chosen.found.finer.len() + 2 <= choice.max_finer {
            chosen.add_finer(&axis);
        }
    }
    Ok(chosen.found)
}

struct Chosen {
    found: Candidates,
    apart: f64,
}

impl Chosen {
    fn is_new(&self, direction: DVec3) -> bool {
        self.found.main.iter().all(|c| angle_between(c.direction, direction) > self.apart)
    }

    fn add_main(&mut self, axis: DVec3, origin: CandidateSource) {
        for direction in [without_signed_zeros(axis), without_signed_zeros(-axis)] {
            if self.is_new(direction) {
                self.found.main.push(Candidate { direction, source: origin });
            }
        }
    }

    fn add_finer(&mut self, axis: &Axis) {
        for direction in [without_signed_zeros(axis.along), without_signed_zeros(-axis.along)] {
            let same = |f: &FinerCandidate| {
                f.part == Some(axis.part) && angle_between(f.direction, direction) <= self.apart
            };
            if self.is_new(direction) && !self.found.finer.iter().any(same) {
                let Axis { origin, part, .. } = *axis;
                self.found.finer.push(FinerCandidate {
                    direction,
                    source: origin,
                    part: Some(part),
                });
            }
        }
    }
}

/// Returns the direction with zeros of positive sign.
fn without_signed_zeros(d: DVec3) -> DVec3 {
    d + DVec3::ZERO
}

struct Axis {
    /// Priority class, lowest first: 0 for axes of cylinders, 1 for the normal of the largest contact and the vector
    /// orthogonal to the two largest ones. Higher classes only give finer candidates.
    rank: usize,
    weight: f64,
    along: DVec3,
    origin: CandidateSource,
    part: usize,
}

/// Maximum number of contact normals of a part that are combined in pairs.
const NORMALS: usize = 6;

/// Returns the candidate axes of one part.
fn part_axes(bodies: &Bodies, liaisons: &[Liaison], part: usize) -> Vec<Axis> {
    let solid = bodies.assembly().parts()[part].solid();
    let mut axes = Vec::new();
    let mut add =
        |rank, weight, axis, origin| axes.push(Axis { rank, weight, along: axis, origin, part });
    for (length, axis) in cylinders::cylinder_axes(solid) {
        add(0, length, axis, CandidateSource::Cylinder);
    }
    let normals = contact_normals(liaisons, part, NORMALS);
    for (k, &(weight, n)) in normals.iter().enumerate() {
        // The normal of the largest contact often is the removal direction; the others are finer candidates.
        add(if k == 0 { 1 } else { 3 }, weight, n, CandidateSource::Contact);
        for &(other, m) in &normals[..k] {
            let cross = n.cross(m);
            // Nearly parallel normals define no axis. The closer they are to orthogonal, the better the axis is
            // defined.
            if cross.length() > 0.1 {
                let weight = weight.min(other) * cross.length_squared();
                add(
                    if k == 1 { 1 } else { 2 },
                    weight,
                    cross.normalize(),
                    CandidateSource::Orthogonal,
                );
            }
        }
    }
    for axis in inertia::principal_axes(solid) {
        add(4, 1.0, axis, CandidateSource::Inertia);
    }
    axes
}

/// Returns the contact normals of a part without signs, largest area first. A normal within a degree of a larger one
/// is merged with it.
fn contact_normals(liaisons: &[Liaison], part: usize, most: usize) -> Vec<(f64, DVec3)> {
    const TOGETHER: f64 = 0.017;
    let own = liaisons.iter().filter(|l| l.parts.contains(&part));
    let mut patches: Vec<(f64, DVec3)> = own
        .flat_map(|l| &l.patches)
        .flat_map(|p| [(p.area, p.normal), (p.area, p.other_normal)])
        .collect();
    patches.sort_by(|x, y| y.0.total_cmp(&x.0));
    let mut normals: Vec<(f64, DVec3)> = Vec::new();
    for (area, normal) in patches {
        let near = |m: DVec3| angle_between(m, normal).min(angle_between(m, -normal)) < TOGETHER;
        let count = normals.len();
        match normals.iter_mut().find(|x| near(x.1)) {
            Some(known) => known.0 += area,
            // Round contacts have many normals. Those of the largest facets are enough to define an axis.
            None if count < 8 * most => normals.push((area, normal)),
            None => (),
        }
    }
    normals.sort_by(|x, y| y.0.total_cmp(&x.0));
    normals.truncate(most);
    normals
}
