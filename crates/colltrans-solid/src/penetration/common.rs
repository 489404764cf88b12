//! The common part of two solids: how they lie to each other, its volume, its box, and a point of it.
//!
//! - The exact tests of [`overlap`](crate::solve::overlap) find the relation. If no facets cross, each shell is inside
//!   or outside the other body as a whole.
//! - One body contains the other if all shells of the inner one lie inside the outer one, and no shell that bounds
//!   material of the outer one, such as the wall of a cavity, lies inside the inner one.
//! - The volume is a sum over facets ([`arrangement`](super::arrangement)) or, if its error is too large, that of
//!   [`cells`](super::cells). The box and the point are those of cells. If a contained body is convex, all of them are
//!   its own.

use glam::DVec3;

use super::arrangement::{DISPLACEMENTS, common_volume};
use super::cells::{CommonCells, box_cells, common_box, common_cells};
use super::placed_solids;
use super::prepared::PreparedPair;
use crate::body::{Solid, check_is_not_rounded};
use crate::solve::hulls::ConvexBody;
use crate::solve::inside::{bounding_shells_inside, shells_inside};
use crate::solve::nearest::search::facet_corners;
use crate::solve::nearest::triangle::Corners;
use crate::solve::overlap::{Overlap, find_contact};
use crate::solve::scene::PairFrame;
use crate::solve::steps::SolidSteps;
use colltrans_convex::body::Aabb;
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::error::QueryError;

/// Number of halvings of the distance of a point below a facet.
const MOST_HALVINGS: i32 = 50;
/// Maximum number of boxes and pieces of facets in a sum, for each cell of the options.
const WORK_PER_CELL: u64 = 16_384;
/// Maximum number of cells that only bound the box.
const BOX_CELLS: u32 = 512;

/// How two solids lie to each other.
///
/// All tests are exact. [`MovingContained`](Self::MovingContained) and [`FixedContained`](Self::FixedContained) are
/// proven. [`Crossing`](Self::Crossing) and [`PartlyContained`](Self::PartlyContained) do not exclude that one body
/// contains the other: facets within a union of overlapping pieces count as surface, and so does a facet that lies in a
/// face of the outer body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum Relation {
    /// The bodies have no common point.
    Disjoint,
    /// The bodies have common points, but their interiors have none.
    Touching(Overlap),
    /// Facets show that the interiors have common points, or that an open shell passes through the other body. A body
    /// within the other one that has a part of a facet in common with it is of this kind.
    Crossing(Overlap),
    /// The moving body lies inside the fixed one. Their surfaces have isolated points and edges in
    /// common at most, except for facets within a union.
    MovingContained,
    /// The fixed body lies inside the moving one. Their surfaces have isolated points and edges in
    /// common at most, except for facets within a union.
    FixedContained,
    /// Some shells of one body lie inside the other one, but not all, or it is not known that one body contains the
    /// other. No facets cross.
    PartlyContained(Overlap),
}

/// Accuracy and cost of [`SolidPenetration::common_part`](super::SolidPenetration::common_part).
///
/// More fields may be added, so start from the default options.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[non_exhaustive]
pub struct VolumeOptions {
    /// Difference of the bounds of the volume at which the search ends, as a share of the lower one. The default is 1
    /// %. If it is 0, negative or not a number, the search ends when it has `max_cells` cells or rounding prevents
    /// more.
    pub accuracy: f64,
    /// Maximum number of cells. The default is 100,000. The search also ends when it has clipped 64 facets for each of
    /// them, and all facets near the common part eight times more. Each sum over facets examines at most 16,384 boxes and
    /// pieces of facets for each of them.
    pub max_cells: u32,
}

impl VolumeOptions {
    /// Returns the options with another accuracy, a share of the volume.
    #[must_use]
    pub const fn with_accuracy(self, accuracy: f64) -> Self {
        Self { accuracy, ..self }
    }

    /// Returns the options with another maximum number of cells.
    #[must_use]
    pub const fn with_max_cells(self, max_cells: u32) -> Self {
        Self { max_cells, ..self }
    }
}

impl Default for VolumeOptions {
    fn default() -> Self {
        Self { accuracy: 0.01, max_cells: 100_000 }
    }
}

/// The common part of two solids.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct CommonPart {
    /// How the bodies lie to each other.
    pub relation: Relation,
    /// Lower and upper bound of the volume, in cubic world units, rounded outwards. The lower one is 0 unless the
    /// interiors have common points. Both are 0 for bodies that are disjoint or touch. Open shells have no volume.
    /// Overlaps of pieces of one solid count once.
    pub volume: [f64; 2],
    /// Whether the bounds of the volume are as close as the options require. Otherwise the number of cells, or
    /// rounding, prevents that.
    pub is_accurate: bool,
    /// Box around the common part, in the world, except for parts thinner than rounding errors (128 noises, `4096 u S`);
    /// `None` if no other part was found.
    pub bounds: Option<Aabb>,
    /// Point inside both bodies, in the world, verified exactly; `None` if none was found, or if its rounded coordinates
    /// leave a body.
    pub point: Option<DVec3>,
    /// Number of cells into which the box of both bodies was divided; 0 if no cells were necessary.
    pub cells: u32,
}

/// Decides how two bodies lie to each other.
fn relation(prepared: &PreparedPair) -> Relation {
    let scene = &prepared.scene;
    let place = match prepared.overlap() {
        None => {
            return find_contact(scene, &mut SolidSteps::default())
                .map_or(Relation::Disjoint, Relation::Touching);
        }
        Some(place @ Overlap::Facets(..)) => return Relation::Crossing(place),
        Some(place) => place,
    };
    let is_within = |moving: bool| {
        let all = scene.side(moving).solid.shell_bounds().len();
        shells_inside(scene, moving).count() == all
            && bounding_shells_inside(scene, !moving).next().is_none()
    };
    if is_within(true) {
        Relation::MovingContained
    } else if is_within(false) {
        Relation::FixedContained
    } else {
        Relation::PartlyContained(place)
    }
}

/// Checks whether a point of the world is inside both bodies and on no surface.
fn is_inside_both(pair: &Pair<'_, Solid>, at: DVec3) -> bool {
    placed_solids(pair).iter().all(|solid| {
        let found = solid.body.signed_distances(solid.pose, &[at]);
        found.is_ok_and(|found| found.iter().all(|distance| distance.is_inside))
    })
}

/// Computes the common part of two bodies.
pub(super) fn common_part(
    prepared: &PreparedPair,
    options: VolumeOptions,
) -> Result<CommonPart, QueryError> {
    let PreparedPair { pair, scene, .. } = prepared;
    for body in [pair.moving(), pair.fixed()] {
        check_is_not_rounded(body.radius())?;
    }
    let accuracy = options.accuracy;
    let relation = relation(prepared);
    if matches!(relation, Relation::Disjoint | Relation::Touching(_)) {
        let (volume, is_accurate) = ([0.0; 2], true);
        let nothing =
            CommonPart { relation, volume, is_accurate, bounds: None, point: None, cells: 0 };
        return Ok(nothing);
    }
    let own = match relation {
        Relation::MovingContained => convex_part(pair, scene, true),
        Relation::FixedContained => convex_part(pair, scene, false),
        _ => None,
    };
    let found = own.unwrap_or_else(|| part_by_facets(scene, options));
    let [lower, upper] = found.volume;
    let origin = pair.bodies.translations[0];
    let point = found.point.map(|at| at + origin).filter(|at| is_inside_both(pair, *at));
    let Aabb { low, high } = found.bounds;
    let bounds = (low.cmple(high).all()).then(|| Aabb {
        low: (low + origin).map(f64::next_down),
        high: (high + origin).map(f64::next_up),
    });
    let is_accurate = upper - lower <= accuracy * lower;
    let (volume, cells) = (found.volume, found.cells);
    Ok(CommonPart { relation, volume, is_accurate, bounds, point, cells })
}

/// Computes the common part of two overlapping bodies. If the sums over facets have the volume, cells only bound the
/// box.
fn part_by_facets(scene: &PairFrame, options: VolumeOptions) -> CommonCells {
    let VolumeOptions { accuracy, max_cells } = options;
    let room = common_box(scene);
    if !room.low.cmplt(room.high).all() {
        return common_cells(scene, accuracy, max_cells);
    }
    let max_work = WORK_PER_CELL * u64::from(max_cells);
    let (mut volume, mut point, mut is_accurate) = ([0.0, f64::INFINITY], None, false);
    // Facets in one plane are undecided unless the bodies are displaced.
    for displacement in DISPLACEMENTS {
        let Some(sum) = common_volume(scene, &room, displacement, max_work) else { break };
        volume = [volume[0].max(sum.bounds[0]), volume[1].min(sum.bounds[1])];
        point = point.or(sum.point);
        is_accurate = volume[1] - volume[0] <= accuracy * volume[0];
        if is_accurate {
            break;
        }
    }
    let mut found = if is_accurate {
        box_cells(scene, max_cells.min(BOX_CELLS))
    } else {
        common_cells(scene, accuracy, max_cells)
    };
    let both = [found.volume[0].max(volume[0]), found.volume[1].min(volume[1])];
    debug_assert!(both[0] <= both[1], "{:?} {volume:?}", found.volume);
    if both[0] <= both[1] {
        found.volume = both;
    }
    found.point = found.point.or(point);
    found
}

/// Returns the common part of two bodies one of which is contained in the other: the inner body. `None` if it is not
/// convex. A surface that is star-shaped about the centre of a ball inside the hull does not intersect itself, so that
/// its volume is that of the space inside.
fn convex_part(pair: &Pair<'_, Solid>, scene: &PairFrame, is_moving: bool) -> Option<CommonCells> {
    let inner = scene.side(is_moving);
    ConvexBody::cached(inner.solid).filter(|convex| convex.is_star_shaped)?;
    let [lower, upper] = inner.solid.volume_bounds()?;
    // The determinant of a matrix `M` with a defect `|M^T M - I| <= d` lies within `1 - 2 d` and `1 + 2 d`.
    let stretch = 2.0 * inner.defect + 64.0 * f64::EPSILON;
    let volume = [lower.max(0.0) * (1.0 - stretch), upper * (1.0 + stretch)];
    let facets = || (0..inner.solid.triangles().len()).map(|t| facet_corners(inner, t));
    let bounds = Aabb::from_points(facets().flatten()).expanded(4.0 * scene.noise);
    let doubled = |[a, b, c]: Corners| (b - a).cross(c - a);
    let largest = |f: &Corners, g: &Corners| {
        doubled(*f).length_squared().total_cmp(&doubled(*g).length_squared())
    };
    let [a, b, c] = facets().max_by(largest)?;
    let inwards = -doubled([a, b, c]).try_normalize()?;
    let far = bounds.side_lengths().length();
    let origin = pair.bodies.translations[0];
    let point = (1..MOST_HALVINGS)
        .map(|k| (a + b + c) / 3.0 + inwards * far * 0.5_f64.powi(k))
        .find(|at| is_inside_both(pair, *at + origin));
    Some(CommonCells { volume, bounds, point, cells: 0 })
}
