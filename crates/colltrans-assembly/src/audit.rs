//! The audit of an assembly: all pairs of parts that interfere, touch, or are nearer than a required clearance.
//!
//! - Candidates are the pairs whose boxes come within the clearance or the tolerance of the pair, found by a tree of
//!   boxes. All other pairs are farther apart.
//! - A pair *interferes* if its bodies of a plan, each shrunk by its share of the tolerance, overlap, and no translation
//!   of at most the tolerance was found that separates the parts. A part inside another one also counts: *contained* if
//!   the surfaces do not cross.
//! - A pair *touches* if it does not interfere, and its distance is at most the tolerance of the pair. Hence rounding of
//!   the files and permitted overlaps are contacts.
//! - All other pairs are *apart*. They are reported if they are proven to be nearer than the clearance.
//!
//! Pairs with a role or tolerance of their own are meant to touch, and have no clearance unless a [level](ClearanceLevel)
//! covers both parts. Ignored and glued pairs are left out. Results do not depend on the number of threads. Memory is
//! proportional to the number of reported pairs.

mod proofs;
mod tables;

use std::cmp::Ordering;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use colltrans::solid::{
    CommonPart, Overlap, PreparedPair, Relation, SolidDepth, SurfaceDistance, VolumeOptions,
};
use colltrans::{Aabb, MAX_MAGNITUDE, Pair, Pose, QueryError};
use glam::DVec3;
use rayon::prelude::*;

use crate::bodies::{Bodies, MOST_NEIGHBOURS};
use crate::boxes::BoxTree;
use crate::error::AssemblyError;
use crate::part::Assembly;
use crate::roles::PairTolerance;
use crate::start::Overlap as StartOverlap;
use crate::watch::{Stage, Watch};

#[cfg(feature = "proofs")]
pub use proofs::prove_pairs;
pub use proofs::{PairProof, ProofClaim};
pub use tables::{QUANTITIES, Quantity, audit_csv, audit_json};

/// Maximum number of cells of a volume. Thin common parts of curved fits would take ten times more for 1 %.
const MAX_CELLS: u32 = 10_000;

/// Clearance between two groups of parts.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ClearanceLevel {
    /// Names or patterns of the parts of both groups, as given.
    pub names: [Vec<String>; 2],
    /// Required clearance.
    pub length: f64,
    /// Indices of the parts of both groups, sorted.
    groups: [Vec<usize>; 2],
}

/// Required clearances of an [`audit`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct AuditOptions {
    /// Clearance of pairs without a level of their own. The default is 0: only interferences are violations.
    pub within: f64,
    /// Whether pairs that touch satisfy every clearance.
    pub allow_contact: bool,
    /// Accuracy and cost of volumes. The default has at most 10,000 cells.
    pub volume: VolumeOptions,
    /// Clearances of groups. A later one replaces an earlier one.
    levels: Vec<ClearanceLevel>,
}

impl Default for AuditOptions {
    fn default() -> Self {
        let (allow_contact, volume) = (false, VolumeOptions::default().with_max_cells(MAX_CELLS));
        Self { within: 0.0, allow_contact, volume, levels: Vec::new() }
    }
}

impl AuditOptions {
    /// Returns the options with another clearance of pairs without a level of their own.
    ///
    /// # Errors
    /// [`AssemblyError::InvalidValue`] if the length is negative, not finite or too large.
    pub fn with_within(self, within: f64) -> Result<Self, AssemblyError> {
        Ok(Self { within: checked_clearance(within)?, ..self })
    }

    /// Returns the options with a clearance between two groups of parts. It replaces earlier ones of the same pairs.
    /// Names are patterns of [`Assembly::parts_named`].
    ///
    /// # Errors
    /// - [`AssemblyError::UnknownPart`]
    /// - [`AssemblyError::InvalidValue`] if the length is negative, not finite or too large.
    pub fn with_level<S: AsRef<str>>(
        mut self,
        assembly: &Assembly,
        [first, second]: [&[S]; 2],
        length: f64,
    ) -> Result<Self, AssemblyError> {
        let groups = [assembly.parts_named(first)?, assembly.parts_named(second)?];
        let names =
            [first, second].map(|all| all.iter().map(|name| name.as_ref().to_owned()).collect());
        self.levels.push(ClearanceLevel { names, length: checked_clearance(length)?, groups });
        Ok(self)
    }

    /// Returns the clearances of groups, in the order in which they were given. A later one replaces an earlier one.
    pub fn levels(&self) -> &[ClearanceLevel] {
        &self.levels
    }

    /// Returns the options that let pairs touch, or not.
    #[must_use]
    pub fn with_allow_contact(self, allow_contact: bool) -> Self {
        Self { allow_contact, ..self }
    }

    /// Returns the required clearance of a pair. It is 0 for pairs with a role or tolerance of their own, unless a level
    /// covers them.
    fn clearance(&self, assembly: &Assembly, [a, b]: [usize; 2]) -> f64 {
        let general = if assembly.pair_fit(a, b).is_some() { 0.0 } else { self.within };
        let covers = |level: &&ClearanceLevel| {
            let has = |group: usize, part| level.groups[group].binary_search(&part).is_ok();
            has(0, a) && has(1, b) || has(0, b) && has(1, a)
        };
        self.levels.iter().rev().find(covers).map_or(general, |level| level.length)
    }

    /// Returns for each part the largest clearance or tolerance of its pairs.
    fn reaches(&self, bodies: &Bodies) -> Vec<f64> {
        let general = self.within.max(bodies.fit().tolerance());
        let mut reaches = vec![general; bodies.len()];
        let mut raise = |part: usize, length: f64| reaches[part] = reaches[part].max(length);
        for (pair, _) in bodies.assembly().pair_fits() {
            for part in pair {
                raise(part, bodies.pair_tolerance(pair));
            }
        }
        for level in &self.levels {
            for &part in level.groups.iter().flatten() {
                raise(part, level.length);
            }
        }
        reaches
    }
}

/// Checks a clearance.
fn checked_clearance(value: f64) -> Result<f64, AssemblyError> {
    let is_valid = (0.0..=MAX_MAGNITUDE).contains(&value);
    if is_valid { Ok(value) } else { Err(AssemblyError::InvalidValue { what: "clearance", value }) }
}

/// The common part of two parts, and how to separate them.
#[derive(Debug, Clone, PartialEq)]
pub struct Interference {
    /// Bounds of the depth, and a translation of the first part that separates the parts.
    pub depth: SolidDepth,
    /// Relation, volume and box of the common part.
    pub common: CommonPart,
    /// Tolerance with which the parts would not overlap; `None` if no tolerance up to their size suffices.
    pub least_tolerance: Option<f64>,
    /// Point inside both parts; if none was found, a point of both, in the world.
    pub place: DVec3,
}

impl Interference {
    /// Returns the depth; `None` if it is unknown, as for open surfaces.
    pub fn known_depth(&self) -> Option<&SolidDepth> {
        Some(&self.depth).filter(|depth| depth.upper > 0.0 && depth.upper.is_finite())
    }

    /// Returns bounds of the common volume; `None` if the depth is unknown.
    pub fn known_volume(&self) -> Option<[f64; 2]> {
        self.known_depth().map(|_| self.common.volume)
    }
}

/// The distance of two surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Lower and upper bound of the distance; both are 0 if the surfaces have a common point.
    pub distance: [f64; 2],
    /// Nearest points of the first and of the second part, in the world.
    pub points: [DVec3; 2],
}

impl From<SurfaceDistance> for Nearest {
    fn from(found: SurfaceDistance) -> Self {
        let (distance, points) = ([found.lower, found.upper], [found.on_moving, found.on_fixed]);
        Self { distance, points }
    }
}

/// How two parts lie to each other.
#[derive(Debug, Clone, PartialEq)]
pub enum PairFinding {
    /// The surfaces cross deeper than the tolerance.
    Interfering(Box<Interference>),
    /// One part lies inside the other.
    Contained {
        /// Index of the inner part.
        inner: usize,
        /// Distance of both surfaces: how thick the wall between them is. 0 if open shells cross the other part.
        wall: Nearest,
        /// Their common part.
        interference: Box<Interference>,
    },
    /// The parts are at most the tolerance apart, or overlap within it.
    Touching(Nearest),
    /// The parts are apart by more than the tolerance.
    Apart(Nearest),
}

impl PairFinding {
    /// Returns the name in answers.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Interfering(_) => "interfering",
            Self::Contained { .. } => "contained",
            Self::Touching(_) => "touching",
            Self::Apart(_) => "apart",
        }
    }

    /// Returns the common part of parts that interfere or contain each other; `None` for others.
    pub fn interference(&self) -> Option<&Interference> {
        match self {
            Self::Interfering(found) | Self::Contained { interference: found, .. } => Some(found),
            Self::Touching(_) | Self::Apart(_) => None,
        }
    }

    /// Returns the index of the part inside the other one, of a contained pair.
    pub const fn inner(&self) -> Option<usize> {
        match self {
            Self::Contained { inner, .. } => Some(*inner),
            Self::Interfering(_) | Self::Touching(_) | Self::Apart(_) => None,
        }
    }

    /// Returns the distance of parts that touch or are apart; `None` for others.
    pub fn nearest(&self) -> Option<&Nearest> {
        match self {
            Self::Touching(found) | Self::Apart(found) => Some(found),
            Self::Interfering(_) | Self::Contained { .. } => None,
        }
    }

    /// Returns the distance of the surfaces of a contained pair, which is the thickness of the wall between them; `None`
    /// for others.
    pub const fn wall(&self) -> Option<&Nearest> {
        match self {
            Self::Contained { wall, .. } => Some(wall),
            Self::Interfering(_) | Self::Touching(_) | Self::Apart(_) => None,
        }
    }

    /// Returns the place of the pair: a point of both parts, or else the nearest point of the first part.
    pub fn place(&self) -> DVec3 {
        match self {
            Self::Interfering(found) | Self::Contained { interference: found, .. } => found.place,
            Self::Touching(found) | Self::Apart(found) => found.points[0],
        }
    }

    /// Returns the kind of the finding as a number, the most severe kind first.
    const fn rank(&self) -> u8 {
        match self {
            Self::Interfering(_) => 0,
            Self::Contained { .. } => 1,
            Self::Touching(_) => 2,
            Self::Apart(_) => 3,
        }
    }
}

/// A pair of parts with its finding.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct AuditedPair {
    /// Indices of the parts, the smaller first.
    pub parts: [usize; 2],
    /// How the parts lie to each other.
    pub finding: PairFinding,
    /// Required clearance.
    pub clearance: f64,
    /// Tolerance of the pair: the sum of the lengths by which closed bodies are shrunk. Open surfaces are not. It has no
    /// effect if the role of the pair permits every overlap.
    pub tolerance: f64,
    /// Whether the pair interferes, is contained, or is proven to be nearer than the clearance.
    pub is_violation: bool,
    /// Whether each part has open shells, which have no inside: containment, depth and volume are those of its closed
    /// shells alone.
    pub has_open_shells: [bool; 2],
    /// Proof files of the finding; empty before `prove_pairs`.
    pub proofs: Vec<PairProof>,
}

impl AuditedPair {
    /// Iterates over the parts with open shells.
    pub fn open_parts(&self) -> impl Iterator<Item = usize> {
        let parts = self.parts.into_iter().zip(self.has_open_shells);
        parts.filter_map(|(part, is_open)| is_open.then_some(part))
    }

    /// Compares by severity: violations first, the deepest interference, the deepest contained part, contacts, and the
    /// pair that lacks most of its clearance.
    fn cmp_severity(&self, other: &Self) -> Ordering {
        let length = |pair: &Self| match (pair.finding.interference(), pair.finding.nearest()) {
            (Some(found), _) => -found.depth.upper,
            (None, Some(found)) => found.distance[0] - pair.clearance,
            (None, None) => 0.0,
        };
        let violations_first = other.is_violation.cmp(&self.is_violation);
        let kinds = violations_first.then(self.finding.rank().cmp(&other.finding.rank()));
        let lengths = kinds.then(length(self).total_cmp(&length(other)));
        lengths.then(self.parts.cmp(&other.parts))
    }
}

/// Numbers of pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct AuditCounts {
    /// Pairs whose boxes come within the clearance or the tolerance.
    pub examined: usize,
    /// Pairs of these boxes that are ignored or glued, and not examined.
    pub ignored: usize,
    /// Pairs that interfere.
    pub interfering: usize,
    /// Pairs of which one part contains the other.
    pub contained: usize,
    /// Pairs that touch.
    pub touching: usize,
    /// Pairs that are apart and nearer than the clearance.
    pub near: usize,
    /// Violations among all of them.
    pub violations: usize,
}

/// Result of [`audit`].
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Audit {
    /// Pairs that interfere, touch, or are nearer than their clearance: violations first, and of these the worst.
    pub pairs: Vec<AuditedPair>,
    /// Numbers of pairs.
    pub counts: AuditCounts,
}

impl Audit {
    /// Iterates over the pairs that violate their clearance, the worst first.
    pub fn violations(&self) -> impl Iterator<Item = &AuditedPair> {
        self.pairs.iter().filter(|pair| pair.is_violation)
    }
}

/// Finds all pairs of parts that interfere, touch, or are nearer than their clearance.
///
/// # Errors
/// - [`AssemblyError::Query`]: a query of a pair has no answer.
/// - [`AssemblyError::TooMany`]: too many pairs are reported.
/// - [`AssemblyError::Cancelled`].
pub fn audit(
    bodies: &Bodies,
    options: &AuditOptions,
    watch: Watch,
) -> Result<Audit, AssemblyError> {
    let parts = bodies.assembly().parts();
    let boxes: Vec<Aabb> = parts.iter().map(|part| part.solid().bounds()).collect();
    let tree = BoxTree::new(boxes.iter().copied());
    let reaches = options.reaches(bodies);
    let largest = reaches.iter().copied().fold(0.0, f64::max);
    // Covers the rounding of boxes that are expanded and compared.
    let slack = 8.0 * f64::EPSILON * (bodies.assembly().coordinate_size() + largest);
    let tally = watch.start_stage(Stage::Start, parts.len());
    let reported = AtomicUsize::new(0);
    let part_pairs = |a: usize| {
        let mut counts = AuditCounts::default();
        let mut near = tree.intersecting(&boxes[a].expanded(reaches[a] + slack));
        near.retain(|&b| b > a);
        near.retain(|&b| {
            let pair = [a, b];
            let reach = options.clearance(bodies.assembly(), pair).max(bodies.pair_tolerance(pair));
            boxes[a].expanded(reach + slack).intersects(&boxes[b])
        });
        let candidates = near.len();
        near.retain(|&b| {
            bodies.assembly().ignored_contacts(a, b).is_none()
                && bodies.tolerated_contacts([a, b]) != Some(PairTolerance::Glued)
        });
        counts.examined = near.len();
        counts.ignored = candidates - near.len();
        let examine = |&b: &usize| {
            watch.check_cancelled()?;
            let found = examine_pair(bodies, [a, b], options)?;
            let is_listed = found.is_violation || !matches!(found.finding, PairFinding::Apart(_));
            if is_listed && reported.fetch_add(1, Relaxed) >= MOST_NEIGHBOURS {
                let (what, most) = ("pairs of parts to report", MOST_NEIGHBOURS);
                return Err(AssemblyError::TooMany { what, most });
            }
            Ok(is_listed.then_some(found))
        };
        let found: Result<Vec<_>, _> = near.par_iter().map(examine).collect();
        tally.finish_item()?;
        Ok((found?.into_iter().flatten().collect::<Vec<_>>(), counts))
    };
    let by_part: Result<Vec<_>, AssemblyError> =
        (0..parts.len()).into_par_iter().map(part_pairs).collect();
    let mut audit = Audit::default();
    for (mut pairs, counts) in by_part? {
        audit.counts.examined += counts.examined;
        audit.counts.ignored += counts.ignored;
        audit.pairs.append(&mut pairs);
    }
    audit.pairs.sort_by(AuditedPair::cmp_severity);
    for pair in &audit.pairs {
        audit.counts.violations += usize::from(pair.is_violation);
        *match pair.finding {
            PairFinding::Interfering(_) => &mut audit.counts.interfering,
            PairFinding::Contained { .. } => &mut audit.counts.contained,
            PairFinding::Touching(_) => &mut audit.counts.touching,
            PairFinding::Apart(_) => &mut audit.counts.near,
        } += 1;
    }
    Ok(audit)
}

/// Examines one pair of parts. A pair that is glued or always ignored has no interference.
///
/// # Errors
/// [`AssemblyError::Query`]: a query has no answer.
pub fn examine_pair(
    bodies: &Bodies,
    pair: [usize; 2],
    options: &AuditOptions,
) -> Result<AuditedPair, AssemblyError> {
    let parts = [pair[0].min(pair[1]), pair[0].max(pair[1])];
    let least_tolerance = || bodies.least_tolerance(parts[0], parts[1]).flatten();
    examine(bodies, parts, options, &least_tolerance)
}

/// Examines two parts that overlap at the start like [`examine_pair`], with their known least tolerance.
///
/// # Errors
/// [`AssemblyError::Query`]: a query has no answer.
pub fn examine_overlap(
    bodies: &Bodies,
    overlap: &StartOverlap,
    options: &AuditOptions,
) -> Result<AuditedPair, AssemblyError> {
    examine(bodies, overlap.parts, options, &|| overlap.depth)
}

/// Examines one pair of parts, the smaller index first.
fn examine(
    bodies: &Bodies,
    parts: [usize; 2],
    options: &AuditOptions,
    least_tolerance: &dyn Fn() -> Option<f64>,
) -> Result<AuditedPair, AssemblyError> {
    let finding =
        pair_finding(bodies, parts, options.volume, least_tolerance).map_err(|source| {
            let [a, b] = parts.map(|part| bodies.assembly().parts()[part].name().to_owned());
            AssemblyError::Query { a, b, source }
        })?;
    let clearance = options.clearance(bodies.assembly(), parts);
    let is_violation = match &finding {
        PairFinding::Interfering(_) | PairFinding::Contained { .. } => true,
        PairFinding::Touching(_) if options.allow_contact => false,
        PairFinding::Touching(found) | PairFinding::Apart(found) => found.distance[1] < clearance,
    };
    let tolerance = bodies.pair_tolerance(parts);
    let has_open_shells = parts.map(|part| bodies.assembly().parts()[part].is_surface());
    let proofs = Vec::new();
    Ok(AuditedPair { parts, finding, clearance, tolerance, is_violation, has_open_shells, proofs })
}

/// Decides how two parts lie to each other.
fn pair_finding(
    bodies: &Bodies,
    parts: [usize; 2],
    volume: VolumeOptions,
    least_tolerance: &dyn Fn() -> Option<f64>,
) -> Result<PairFinding, QueryError> {
    let of = parts.map(|k| &bodies.assembly().parts()[k]);
    let [a, b] = of.map(|part| part.solid().at(Pose::IDENTITY));
    let pair = Pair::new(a, b)?;
    let pair = PreparedPair::new(&pair)?;
    let tolerance = bodies.pair_tolerance(parts);
    let may_cross = bodies.tolerated_contacts(parts) == Some(PairTolerance::Crossing);
    let overlaps = bodies.overlaps(parts[0], parts[1]);
    // Open surfaces are not shrunk.
    let crosses_sheet = overlaps && of.iter().any(|part| part.is_surface());
    // The distance of the surfaces is not needed for closed bodies that interfere.
    let is_needed = may_cross || !overlaps || crosses_sheet;
    let surfaces = if is_needed { Some(pair.surface_distance()?) } else { None };
    let may_interfere = |found: &SurfaceDistance| match found.place {
        Some(Overlap::Facets(..)) => crosses_sheet && !separates_within(bodies, parts, found),
        place => place.is_some(),
    };
    let surface_distance = || surfaces.map_or_else(|| pair.surface_distance(), Ok);
    if !may_cross && surfaces.as_ref().is_none_or(may_interfere) {
        let depth = pair.depth()?;
        // Open surfaces have no depth.
        if depth.upper > tolerance || crosses_sheet {
            let common = pair.common_part(volume)?;
            let inner = match common.relation {
                Relation::MovingContained => Some(0),
                Relation::FixedContained => Some(1),
                _ => None,
            };
            // A point of both bodies: of the surface of the inner one, or else of both surfaces.
            let on_surface = || {
                surface_distance().map(|found| match inner {
                    Some(1) => found.on_fixed,
                    _ => found.on_moving,
                })
            };
            let place = common.point.map_or_else(on_surface, Ok)?;
            let least_tolerance = least_tolerance();
            let found = Interference { depth, common, least_tolerance, place };
            let interference = Box::new(found);
            match (inner, common.relation) {
                (Some(side), _) => {
                    let wall = surface_distance()?.into();
                    return Ok(PairFinding::Contained { inner: parts[side], wall, interference });
                }
                // Open surfaces nearer than a minimum gap overlap without a common point of their interiors.
                (None, Relation::Disjoint | Relation::Touching(_)) => {}
                (None, _) => return Ok(PairFinding::Interfering(interference)),
            }
        }
    }
    let found = surface_distance()?;
    let touches = found.place.is_some() || found.lower <= tolerance;
    let nearest = found.into();
    Ok(if touches { PairFinding::Touching(nearest) } else { PairFinding::Apart(nearest) })
}

/// Checks whether a translation by the tolerance of a pair, along an axis or the normal of a facet in contact, separates
/// both parts.
fn separates_within(bodies: &Bodies, parts: [usize; 2], found: &SurfaceDistance) -> bool {
    let normals = [0, 1].map(|k| {
        let solid = bodies.assembly().parts()[parts[k]].solid();
        let corners = solid.triangles()[found.triangles[k] as usize];
        let [a, b, c] = corners.map(|v| solid.vertices()[v as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    });
    let tolerance = bodies.pair_tolerance(parts);
    normals.into_iter().chain(DVec3::AXES).any(|way| {
        [tolerance, -tolerance]
            .iter()
            .any(|by| !bodies.overlaps_displaced(parts[0], way * *by, parts[1]))
    })
}
