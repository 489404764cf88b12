//! Free directions as an answer: classification of a direction, regions and areas.

use std::f64::consts::PI;
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

use glam::DVec3;

use super::bodies::Bodies;
use super::cell::Cell;
use super::cone::Cone;
use super::error::FreeError;
use super::inner::InnerBox;
use super::lower_dimensional::{FreeArc, FreePoint, LowerDimensional, find_lower_dimensional};
use super::options::FreeOptions;
use super::proof::{CellState, FreeProof, cell_proofs, cell_states};
use super::region::{FreeRegion, connected_regions};
use super::remainder::{Piece, Remainder};
use super::search::{Search, SearchResult};
use super::verify::{blocking_pair, claim_holds, names_exist, remainder_of};
use colltrans_convex::answer::CertificateError;
use colltrans_convex::body::Placed;
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::check_direction;
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::SolidSteps;
use colltrans_solid::body::{AsSolid, Solid, check_is_not_rounded};
use colltrans_solid::cast::StartOverlap;
use colltrans_solid::solve::overlap;
use colltrans_solid::{SolidCast, SolidScene};

/// Classification of a direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Verdict {
    /// No translation along the direction is blocked.
    Free,
    /// This pair of triangles blocks the direction: indices into [`Solid::triangles`] of the moving and the
    /// fixed body.
    Blocked([u32; 2]),
    /// The search did not decide the direction.
    Undecided,
}

/// Convex piece of the free directions, including its boundary.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FreePiece {
    /// Corners in cyclic order, as directions with a largest component of 1 or -1. Only their last roundings
    /// make them inexact.
    pub corners: Vec<DVec3>,
    /// Solid angle in steradians.
    pub area: f64,
}

/// Cell of directions on the sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FreeCell {
    /// Corners in cyclic order. They are exact, and the cell is their convex cone.
    pub corners: [DVec3; 4],
    /// Classification of the cell.
    pub kind: CellKind,
    /// For a blocked cell a pair of triangles, as indices into [`Solid::triangles`] of the moving and the
    /// fixed body; `None` for other cells. If one pair of facets blocks the cell, this is that pair. If boxes
    /// inside the bodies block the cell, this pair blocks the direction at the center of the cell.
    pub blocked_by: Option<[u32; 2]>,
    /// Solid angle in steradians.
    pub area: f64,
}

/// Classification of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum CellKind {
    /// All directions of the cell are free.
    Free,
    /// One pair of facets, or of boxes inside the bodies, blocks the whole cell.
    Blocked,
    /// A list of pairs blocks part of the cell, possibly all of it. All other directions are free.
    Both,
    /// Some directions of the cell may be undecided.
    Undecided,
}

/// Maximum number of directions in undecided cells that are tested by a cast.
const MAX_TESTED: usize = 64;

/// Solid angles in steradians; `free` is an interval of bounds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Areas {
    free: [f64; 2],
    undecided: f64,
}

/// All directions along which a solid can leave another one. [`Self::compute`] computes them.
pub struct FreeDirections<'a> {
    /// The cast along an arbitrary direction.
    cast: Cast<'a, Solid>,
    bodies: Bodies<'a>,
    options: FreeOptions,
    /// Boxes inside the moving and inside the fixed body.
    boxes: [Vec<InnerBox>; 2],
    states: Vec<CellState>,
    visits: u64,
    areas: Areas,
    /// Free arcs and isolated directions, computed at the first request.
    lower_dimensional: OnceLock<LowerDimensional>,
}

impl<'a> FreeDirections<'a> {
    /// Computes the directions along which the moving body can leave the fixed one. A convex body is treated
    /// as a solid.
    ///
    /// A direction is free if and only if [`Cast::clearance`] along it, with the same tolerance and start
    /// overlap, reports a free translation. All decisions are exact. Directions that the allowed work does
    /// not decide remain undecided.
    ///
    /// # Errors
    /// Returns [`FreeError::Query`] for bodies or options that a cast rejects, [`FreeError::Open`] for an
    /// open shell, and [`FreeError::Overlapping`] if the bodies overlap at the start and the overlap is not
    /// ignored.
    ///
    /// ```
    /// use colltrans::removal::directions::{FreeDirections, FreeOptions, Verdict};
    /// use colltrans::glam::DVec3;
    /// use colltrans::{ConvexPolyhedron, Pose};
    ///
    /// // A lid on a box can move up and sideways, but not down.
    /// let block = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let above = Pose::from_translation(DVec3::Z)?;
    /// let free =
    ///     FreeDirections::compute(&block.at(above), &block.at(Pose::IDENTITY), FreeOptions::default())?;
    /// assert_eq!(free.classify(DVec3::X)?, Verdict::Free);
    /// assert!(matches!(free.classify(DVec3::new(1.0, 0.0, -1e-50))?, Verdict::Blocked(_)));
    /// assert_eq!(free.undecided_area(), 0.0);
    /// let half = std::f64::consts::TAU;
    /// assert!(free.free_area()[0] <= half && half <= free.free_area()[1]);
    /// free.verify()?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn compute<A: AsSolid, B: AsSolid>(
        moving: &Placed<'a, A>,
        fixed: &Placed<'a, B>,
        options: FreeOptions,
    ) -> Result<Self, FreeError> {
        Self::search_all(moving, fixed, options, None)
    }

    /// Computes the free directions like [`Self::compute`], and stops soon after the flag is set.
    ///
    /// # Errors
    /// Returns the errors of [`Self::compute`], and [`FreeError::Cancelled`] if the flag was set.
    pub fn compute_unless_cancelled<A: AsSolid, B: AsSolid>(
        moving: &Placed<'a, A>,
        fixed: &Placed<'a, B>,
        options: FreeOptions,
        cancel: &AtomicBool,
    ) -> Result<Self, FreeError> {
        Self::search_all(moving, fixed, options, Some(cancel))
    }

    fn search_all<A: AsSolid, B: AsSolid>(
        moving: &Placed<'a, A>,
        fixed: &Placed<'a, B>,
        options: FreeOptions,
        cancel: Option<&AtomicBool>,
    ) -> Result<Self, FreeError> {
        let (cast, bodies) = checked_bodies(moving, fixed, &options)?;
        let found = Search::new(&bodies, options, cancel).run();
        let SearchResult { states, boxes, visits } = found.ok_or(FreeError::Cancelled)?;
        let (areas, lower_dimensional) = (Areas::default(), OnceLock::new());
        let mut all =
            Self { cast, bodies, options, boxes, states, visits, areas, lower_dimensional };
        all.areas = all.measure_areas();
        Ok(all)
    }

    /// Returns the classification of a direction of any length.
    ///
    /// # Errors
    /// Returns an error for a direction that is zero, not finite or out of range.
    pub fn classify(&self, direction: DVec3) -> Result<Verdict, QueryError> {
        check_direction(direction)?;
        let mut at = Cell::root_index(direction);
        let mut cell = Cell::root_cells()[at];
        while let CellState::Cut(first) = self.states[at] {
            let quarter = cell.quarter_of(direction);
            at = first as usize + quarter;
            cell = cell.quarter(quarter);
        }
        let blocking = |pairs: &[[u32; 2]]| {
            let holds = |pair: &&[u32; 2]| {
                Cone::new(&self.bodies, **pair).contains_direction(&self.bodies, direction)
            };
            pairs.iter().find(holds).map(|pair| Verdict::Blocked(*pair))
        };
        Ok(match &self.states[at] {
            CellState::Blocked(pair) => Verdict::Blocked(*pair),
            CellState::Inner(_) => blocking_pair(&self.bodies, &cell, direction)
                .map_or(Verdict::Undecided, Verdict::Blocked),
            CellState::Open(pairs) => blocking(pairs).unwrap_or(Verdict::Free),
            CellState::Undecided(pairs) => blocking(pairs).unwrap_or(Verdict::Undecided),
            CellState::Cut(_) => Verdict::Undecided,
        })
    }

    /// Returns a lower and an upper bound of the solid angle of the free directions, in steradians. The whole
    /// sphere has `4 PI`. Undecided directions are not included and may also be free.
    pub fn free_area(&self) -> [f64; 2] {
        self.areas.free
    }

    /// Returns an upper bound of the solid angle of the undecided directions, in steradians.
    pub fn undecided_area(&self) -> f64 {
        self.areas.undecided
    }

    /// Checks whether it is certain that no direction is free.
    pub fn is_blocked(&self) -> bool {
        self.leaf_cells().all(|(cell, state)| match state {
            CellState::Cut(_) | CellState::Blocked(_) | CellState::Inner(_) => true,
            CellState::Undecided(_) => false,
            CellState::Open(pairs) => remainder_of(&self.bodies, cell, pairs)
                .is_ok_and(|remainder| remainder.pieces.is_empty()),
        })
    }

    /// Checks whether it is certain that some direction is free. Unlike [`Self::arcs`] and [`Self::points`], this has
    /// no limit of pieces. Returns `false` if only undecided directions may be free.
    pub fn has_free_direction(&self) -> bool {
        self.leaf_cells().any(|(cell, state)| match state {
            CellState::Open(pairs) => remainder_of(&self.bodies, cell, pairs)
                .is_ok_and(|remainder| !remainder.pieces.is_empty()),
            _ => false,
        })
    }

    /// Checks whether no cell is undecided.
    pub fn is_complete(&self) -> bool {
        self.leaf_cells().all(|(_, state)| !matches!(state, CellState::Undecided(_)))
    }

    /// Returns convex pieces whose union is the set of free directions with an area. Pieces do not extend
    /// across cells, and neighbours share boundaries.
    pub fn pieces(&self) -> Vec<FreePiece> {
        let piece = |(cell, piece): (Cell, Piece)| {
            piece.is_region().then(|| FreePiece {
                corners: corner_directions(&cell, &piece),
                area: piece.area(),
            })
        };
        self.free_pieces().filter_map(piece).collect()
    }

    /// Returns the connected regions of free directions with an area, the largest first.
    pub fn regions(&self) -> Vec<FreeRegion> {
        connected_regions(&self.pieces(), |d| matches!(self.classify(d), Ok(Verdict::Free)))
    }

    /// Returns the arcs of free directions that border no region of free or undecided directions. If more than 20
    /// million pairs of pieces would have to be compared, no arcs are reported although some may exist.
    pub fn arcs(&self) -> &[FreeArc] {
        &self.lower_dimensional().arcs
    }

    /// Returns the free directions that have no free or undecided direction next to them. If more than 20 million
    /// pairs of pieces would have to be compared, no points are reported although some may exist.
    pub fn points(&self) -> &[FreePoint] {
        &self.lower_dimensional().points
    }

    /// Checks exactly whether a direction, of any length, is the direction of a free point. Returns `false`
    /// if the planes of the point name vertices that do not exist.
    ///
    /// # Errors
    /// Returns an error for a direction that is zero, not finite or out of range.
    ///
    /// ```
    /// use colltrans::removal::directions::{FreeDirections, FreeOptions};
    /// use colltrans::glam::DVec3;
    /// use colltrans::{ConvexPolyhedron, Pose, Solid};
    ///
    /// // A bar in a tube that is open at both ends.
    /// let cuboid = |low: [f64; 3], high: [f64; 3]| ConvexPolyhedron::cuboid(low.into(), high.into());
    /// let walls = Solid::from_pieces(&[
    ///     cuboid([-1.0, -1.0, 0.0], [4.0, 0.0, 1.0])?,
    ///     cuboid([-1.0, 1.0, 0.0], [4.0, 2.0, 1.0])?,
    ///     cuboid([-1.0, -1.0, -1.0], [4.0, 2.0, 0.0])?,
    ///     cuboid([-1.0, -1.0, 1.0], [4.0, 2.0, 2.0])?,
    /// ])?;
    /// let (bar, here) = (cuboid([0.0, 0.0, 0.0], [3.0, 1.0, 1.0])?, Pose::IDENTITY);
    /// let options = FreeOptions::default().with_no_tolerance();
    /// let free = FreeDirections::compute(&bar.at(here), &walls.at(here), options)?;
    /// let points = free.points();
    /// assert_eq!(points.len(), 2);
    /// assert!(points.iter().any(|point| free.is_at_point(point, DVec3::X) == Ok(true)));
    /// assert!(points.iter().all(|point| free.is_at_point(point, DVec3::new(1.0, 1e-50, 0.0)) == Ok(false)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn is_at_point(&self, point: &FreePoint, direction: DVec3) -> Result<bool, QueryError> {
        check_direction(direction)?;
        Ok(point.has_direction(&self.bodies, direction))
    }

    /// Checks exactly whether a direction, of any length, lies on an arc or at one of its ends. Returns
    /// `false` if the planes of the arc name vertices that do not exist.
    ///
    /// # Errors
    /// Returns an error for a direction that is zero, not finite or out of range.
    pub fn is_on_arc(&self, arc: &FreeArc, direction: DVec3) -> Result<bool, QueryError> {
        check_direction(direction)?;
        Ok(arc.has_direction(&self.bodies, direction))
    }

    fn lower_dimensional(&self) -> &LowerDimensional {
        self.lower_dimensional
            .get_or_init(|| find_lower_dimensional(&self.bodies, self.leaf_cells()))
    }

    /// Returns the cast between the bodies. Its direction is arbitrary.
    #[cfg(feature = "json")]
    #[doc(hidden)]
    pub fn cast(&self) -> &Cast<'a, Solid> {
        &self.cast
    }

    /// Returns free directions in undecided cells. The candidates are corners of arcs and points that border
    /// undecided directions, and corners and centers of undecided cells. If [`arcs`](Self::arcs) exceeds its
    /// limit, one corner of each arc and point is a candidate too. At most 64 candidates are tested, each by one
    /// cast.
    pub fn free_among_undecided(&self) -> Vec<DVec3> {
        let undecided = |(cell, state): (Cell, &CellState)| match state {
            CellState::Undecided(_) => {
                let middle = cell.side.direction_at(cell.center());
                Some(cell.corner_directions().into_iter().chain([middle]))
            }
            _ => None,
        };
        let mut asked: Vec<DVec3> = Vec::new();
        let corners = self.leaf_cells().filter_map(undecided).flatten();
        for d in self.lower_dimensional().unclear.iter().copied().chain(corners) {
            // Two sides of the cube share the directions on their common edge.
            if !asked.contains(&d) {
                asked.push(d);
            }
            if asked.len() == MAX_TESTED {
                break;
            }
        }
        asked.retain(|&d| {
            let (moving, fixed) = (self.cast.moving(), self.cast.fixed());
            let (p, q) = (self.cast.moving_pose(), self.cast.fixed_pose());
            let options = self.options.with_tolerance(self.tolerance()).cast_options();
            let cast = Cast::<Solid>::new(moving.at(p), fixed.at(q), d);
            let answer = cast.and_then(|cast| cast.with_options(options)?.clearance());
            answer.is_ok_and(|answer| answer.is_free())
        });
        asked
    }

    /// Returns the options.
    pub fn options(&self) -> FreeOptions {
        self.options
    }

    /// Returns the number of cells of the subdivision that are not divided, and the number of node visits as
    /// [`FreeOptions::looks`] counts them. The latter is 0 for an answer that is built from a proof.
    pub fn work_counts(&self) -> [u64; 2] {
        [self.leaf_cells().count() as u64, self.visits]
    }

    /// Returns the tolerance in use, a length.
    pub fn tolerance(&self) -> f64 {
        self.cast.tolerance()
    }

    /// Checks the claim about every cell on its own, without a search.
    ///
    /// # Errors
    /// Returns [`FreeError::NotProven`] for the first box that is not proven to be inside its body, or the first
    /// cell whose claim is not proven. If an overlap at the start is ignored, boxes inside the bodies prove
    /// nothing, and an answer that has one is rejected.
    pub fn verify(&self) -> Result<(), FreeError> {
        for (moving, boxes) in [(true, &self.boxes[0]), (false, &self.boxes[1])] {
            // Bodies whose present overlap is ignored are not blocked by boxes inside them.
            let counts = self.options.start_overlap == StartOverlap::Refuse;
            let inside = |one: &InnerBox| counts && one.is_inside(&self.bodies, moving);
            if !boxes.iter().all(inside) {
                return Err(CertificateError::StartClaim.into());
            }
        }
        for (number, (cell, state)) in self.leaf_cells().enumerate() {
            if !claim_holds(&self.bodies, &self.boxes, &cell, state) {
                return Err(CertificateError::Cover { entry: number }.into());
            }
        }
        Ok(())
    }

    /// Returns the cells of the proof. Cells are small near boundaries of the free directions and large
    /// elsewhere.
    pub fn cells(&self) -> impl Iterator<Item = FreeCell> {
        self.leaf_cells().map(|(cell, state)| FreeCell {
            corners: cell.corner_directions(),
            kind: match state {
                CellState::Blocked(_) | CellState::Inner(_) => CellKind::Blocked,
                CellState::Open(pairs) if pairs.is_empty() => CellKind::Free,
                CellState::Open(_) => CellKind::Both,
                CellState::Cut(_) | CellState::Undecided(_) => CellKind::Undecided,
            },
            blocked_by: match state {
                CellState::Blocked(pair) => Some(*pair),
                CellState::Inner(_) => {
                    let middle = cell.side.direction_at(cell.center());
                    blocking_pair(&self.bodies, &cell, middle)
                }
                _ => None,
            },
            area: cell.area(),
        })
    }

    /// Returns the claims about all cells, which prove the answer.
    pub fn proof(&self) -> FreeProof {
        FreeProof {
            tolerance: self.cast.tolerance(),
            start_overlap: self.options.start_overlap,
            boxes: self.boxes.clone(),
            cells: cell_proofs(&self.states),
        }
    }

    /// Builds the answer from a proof after checking every claim. It runs no search, and the proof may have
    /// any origin.
    ///
    /// # Errors
    /// Returns the errors of [`Self::compute`], and [`FreeError::NotProven`] if a claim is not proven.
    pub fn from_proof<A: AsSolid, B: AsSolid>(
        moving: &Placed<'a, A>,
        fixed: &Placed<'a, B>,
        proof: &FreeProof,
    ) -> Result<Self, FreeError> {
        let options = FreeOptions::DEFAULT
            .with_tolerance(proof.tolerance)
            .with_start_overlap(proof.start_overlap);
        let mut all = Self::with_cells(moving, fixed, proof, options)?;
        all.verify()?;
        all.areas = all.measure_areas();
        Ok(all)
    }

    /// Builds the answer from a proof without checking its claims. It is meant for callers that computed the
    /// proof themselves. Areas are 0.
    ///
    /// # Errors
    /// Returns the errors of [`Self::compute`], and [`FreeError::NotProven`] if the cells do not partition the
    /// sphere or name facets or boxes that do not exist.
    pub fn from_trusted_proof<A: AsSolid, B: AsSolid>(
        moving: &Placed<'a, A>,
        fixed: &Placed<'a, B>,
        proof: &FreeProof,
    ) -> Result<Self, FreeError> {
        let options = FreeOptions::DEFAULT
            .with_tolerance(proof.tolerance)
            .with_start_overlap(proof.start_overlap);
        Self::with_cells(moving, fixed, proof, options)
    }

    fn with_cells<A: AsSolid, B: AsSolid>(
        moving: &Placed<'a, A>,
        fixed: &Placed<'a, B>,
        proof: &FreeProof,
        options: FreeOptions,
    ) -> Result<Self, FreeError> {
        let (cast, bodies) = checked_bodies(moving, fixed, &options)?;
        let misfit = CertificateError::Cover { entry: proof.cells.len() };
        let states = cell_states(&proof.cells).ok_or(misfit)?;
        let boxes = proof.boxes.clone();
        let (areas, lower_dimensional) = (Areas::default(), OnceLock::new());
        let all =
            Self { cast, bodies, options, boxes, states, visits: 0, areas, lower_dimensional };
        let exist = |state: &CellState| names_exist(&all.bodies, &all.boxes, state);
        let strange = all.leaf_cells().position(|(_, state)| !exist(state));
        match strange {
            Some(entry) => Err(CertificateError::Cover { entry }.into()),
            None => Ok(all),
        }
    }

    /// Returns this answer with other options. The tolerance and the treatment of a start overlap do not
    /// change.
    #[must_use]
    pub fn with_options(self, options: FreeOptions) -> Self {
        let FreeOptions { tolerance, start_overlap, .. } = self.options;
        let options = options.with_tolerance(tolerance).with_start_overlap(start_overlap);
        Self { options, ..self }
    }

    /// Returns the cells that are not divided, in preorder.
    fn leaf_cells(&self) -> impl Iterator<Item = (Cell, &CellState)> {
        let mut stack: Vec<(usize, Cell)> =
            Cell::root_cells().into_iter().enumerate().rev().collect();
        std::iter::from_fn(move || {
            loop {
                let (at, cell) = stack.pop()?;
                match &self.states[at] {
                    CellState::Cut(first) => {
                        let quarter = |k: usize| (*first as usize + k, cell.quarter(k));
                        stack.extend((0..4).rev().map(quarter));
                    }
                    state => return Some((cell, state)),
                }
            }
        })
    }

    /// Returns all free pieces, each with its cell.
    fn free_pieces(&self) -> impl Iterator<Item = (Cell, Piece)> {
        let remainder = |(cell, state): (Cell, &CellState)| {
            let remainder = match state {
                CellState::Open(pairs) => remainder_of(&self.bodies, cell, pairs).ok(),
                _ => None,
            };
            let pieces = remainder.map_or_else(Vec::new, |remainder| remainder.pieces);
            pieces.into_iter().map(move |piece| (cell, piece))
        };
        self.leaf_cells().flat_map(remainder)
    }

    fn measure_areas(&self) -> Areas {
        let (mut free, mut error, mut undecided) = (0.0, 0.0, 0.0);
        for (cell, state) in self.leaf_cells() {
            let (pairs, open) = match state {
                CellState::Open(pairs) => (pairs, true),
                CellState::Undecided(pairs) => (pairs, false),
                _ => continue,
            };
            let remainder = remainder_of(&self.bodies, cell, pairs)
                .unwrap_or_else(|_| Remainder::of_cell(cell));
            let area: f64 = remainder.pieces.iter().map(Piece::area).sum();
            let off: f64 = remainder.pieces.iter().map(Piece::area_error).sum();
            if open {
                (free, error) = (free + area, error + off);
            } else {
                undecided += area + off;
            }
        }
        error += 64.0 * f64::EPSILON * free;
        Areas { free: [(free - error).max(0.0), (free + error).min(4.0 * PI)], undecided }
    }
}

/// Returns the directions of the corners of a piece.
fn corner_directions(cell: &Cell, piece: &Piece) -> Vec<DVec3> {
    piece.corner_places().into_iter().map(|place| cell.side.direction_at(place)).collect()
}

/// Checks the bodies and the options, and returns the cast and the bodies in the setting frame.
pub(super) fn checked_bodies<'a, A: AsSolid, B: AsSolid>(
    moving: &Placed<'a, A>,
    fixed: &Placed<'a, B>,
    options: &FreeOptions,
) -> Result<(Cast<'a, Solid>, Bodies<'a>), FreeError> {
    let cast = Cast::between(*moving, *fixed, DVec3::Z)?.with_options(options.cast_options())?;
    let scene = cast.checked_query_scene()?;
    for (which, solid) in [("moving", cast.moving()), ("fixed", cast.fixed())] {
        check_is_not_rounded(solid.radius()).map_err(QueryError::from)?;
        if !solid.is_closed() {
            return Err(FreeError::Open { which });
        }
    }
    if options.start_overlap == StartOverlap::Refuse
        && let Some(place) = overlap::find_overlap(&scene, &mut SolidSteps::default())
    {
        return Err(FreeError::Overlapping { place });
    }
    Ok((cast, Bodies::new(scene)))
}
