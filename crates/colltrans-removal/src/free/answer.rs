//! The answer: what is said of a direction, regions, and areas.

use std::f64::consts::PI;
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

use glam::DVec3;

use super::bodies::Bodies;
use super::cell::Cell;
use super::cone::Cone;
use super::error::FreeError;
use super::inner::InnerBox;
use super::options::FreeOptions;
use super::proof::{Fate, FreeProof, cells, fates};
use super::region::{FreeRegion, regions};
use super::rest::{Piece, Rest};
use super::search::{Found, Search};
use super::thin::{FreeArc, FreePoint, Thin, thin};
use super::verify::{blocking_pair, holds, names_exist, rest_of};
use colltrans_convex::answer::CertificateError;
use colltrans_convex::body::Placed;
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::check_direction;
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::SolidSteps;
use colltrans_solid::body::{AsSolid, Solid};
use colltrans_solid::cast::StartOverlap;
use colltrans_solid::solve::overlap;
use colltrans_solid::{SolidCast, SolidScene};

/// What is said of a direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Verdict {
    /// Nothing blocks it, ever.
    Free,
    /// These two triangles block it: positions in [`Solid::triangles`] of the moving and of the fixed body.
    Blocked([u32; 2]),
    /// It was not found out.
    Undecided,
}

/// A convex piece of the free directions, borders included.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FreePiece {
    /// Its corners in order, directions with a largest component of 1 (or -1), exact but for their last roundings.
    pub corners: Vec<DVec3>,
    /// Its solid angle.
    pub area: f64,
}

/// A cell of the sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FreeCell {
    /// Its corners in order, exact: it is all that is between them.
    pub corners: [DVec3; 4],
    /// What is known of it.
    pub kind: CellKind,
    /// If one pair of facets blocks all of it, these, and if boxes inside the bodies do, a pair that blocks its
    /// middle: positions in [`Solid::triangles`] of the moving and of the fixed
    /// body.
    pub blocked_by: Option<[u32; 2]>,
    /// Its solid angle.
    pub area: f64,
}

/// What is known of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum CellKind {
    /// All of it is free.
    Free,
    /// One pair of facets, or of boxes inside the bodies, blocks all of it.
    Blocked,
    /// Some pairs block all that is not free, which may be nothing.
    Both,
    /// Not all of it is known.
    Undecided,
}

/// Directions in undecided cells that are asked one by one, at most.
const MOST_ASKED: usize = 64;

/// Solid angles, each enclosed: `[at least, at most]`, in steradians.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Areas {
    free: [f64; 2],
    undecided: f64,
}

/// All directions along which a solid can leave another one: see [`Self::of`].
pub struct FreeDirections<'a> {
    /// Along any direction.
    cast: Cast<'a, Solid>,
    bodies: Bodies<'a>,
    options: FreeOptions,
    /// Boxes inside either body.
    boxes: [Vec<InnerBox>; 2],
    fates: Vec<Fate>,
    looks: u64,
    areas: Areas,
    /// What is free without an area, when first asked for.
    thin: OnceLock<Thin>,
}

impl<'a> FreeDirections<'a> {
    /// Along which directions can the moving body leave the fixed one? Bodies of either kind; a convex one as the
    /// solid that it is.
    ///
    /// A direction is free exactly where [`Cast::clearance`] along it, with the same tolerance and meaning of an
    /// overlap, says that it is. All decisions are exact; what is not decided within the work allowed is called
    /// undecided.
    ///
    /// # Errors
    /// Bodies that no cast can be asked about; open shells; an overlap that is not to be ignored.
    ///
    /// ```
    /// use colltrans::free::{FreeDirections, FreeOptions, Verdict};
    /// use colltrans::glam::DVec3;
    /// use colltrans::{ConvexPolyhedron, Pose};
    ///
    /// // A lid on a box: it can go up and aside, not down.
    /// let block = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let above = Pose::from_translation(DVec3::Z)?;
    /// let free =
    ///     FreeDirections::of(&block.at(above), &block.at(Pose::IDENTITY), FreeOptions::default())?;
    /// assert_eq!(free.says(DVec3::X)?, Verdict::Free);
    /// assert!(matches!(free.says(DVec3::new(1.0, 0.0, -1e-50))?, Verdict::Blocked(_)));
    /// assert_eq!(free.undecided_area(), 0.0);
    /// let half = std::f64::consts::TAU;
    /// assert!(free.free_area()[0] <= half && half <= free.free_area()[1]);
    /// free.verify()?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of<A: AsSolid, B: AsSolid>(
        moving: &Placed<'a, A>,
        fixed: &Placed<'a, B>,
        options: FreeOptions,
    ) -> Result<Self, FreeError> {
        Self::search(moving, fixed, options, None)
    }

    /// The same, which ends with [`FreeError::Cancelled`] soon after the flag is set.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn of_unless<A: AsSolid, B: AsSolid>(
        moving: &Placed<'a, A>,
        fixed: &Placed<'a, B>,
        options: FreeOptions,
        cancel: &AtomicBool,
    ) -> Result<Self, FreeError> {
        Self::search(moving, fixed, options, Some(cancel))
    }

    fn search<A: AsSolid, B: AsSolid>(
        moving: &Placed<'a, A>,
        fixed: &Placed<'a, B>,
        options: FreeOptions,
        cancel: Option<&AtomicBool>,
    ) -> Result<Self, FreeError> {
        let (cast, bodies) = setting(moving, fixed, &options)?;
        let found = Search::new(&bodies, options, cancel).run();
        let Found { fates, boxes, looks } = found.ok_or(FreeError::Cancelled)?;
        let (areas, thin) = (Areas::default(), OnceLock::new());
        let mut all = Self { cast, bodies, options, boxes, fates, looks, areas, thin };
        all.areas = all.measure();
        Ok(all)
    }

    /// What is said of a direction, of any length.
    ///
    /// # Errors
    /// A direction that is zero, not finite or out of range.
    pub fn says(&self, direction: DVec3) -> Result<Verdict, QueryError> {
        check_direction(direction)?;
        let mut at = Cell::root_of(direction);
        let mut cell = Cell::roots()[at];
        while let Fate::Cut(first) = self.fates[at] {
            let quarter = cell.quarter_of(direction);
            at = first as usize + quarter;
            cell = cell.quarter(quarter);
        }
        let blocking = |pairs: &[[u32; 2]]| {
            let holds =
                |pair: &&[u32; 2]| Cone::new(&self.bodies, **pair).holds(&self.bodies, direction);
            pairs.iter().find(holds).map(|pair| Verdict::Blocked(*pair))
        };
        Ok(match &self.fates[at] {
            Fate::Blocked(pair) => Verdict::Blocked(*pair),
            Fate::Inner(_) => blocking_pair(&self.bodies, &cell, direction)
                .map_or(Verdict::Undecided, Verdict::Blocked),
            Fate::Open(pairs) => blocking(pairs).unwrap_or(Verdict::Free),
            Fate::Undecided(pairs) => blocking(pairs).unwrap_or(Verdict::Undecided),
            Fate::Cut(_) => Verdict::Undecided,
        })
    }

    /// The solid angle that is free, from below and from above, in steradians: of all directions `4 PI`. What is
    /// undecided may be free besides.
    pub fn free_area(&self) -> [f64; 2] {
        self.areas.free
    }

    /// At most so much is undecided, in steradians.
    pub fn undecided_area(&self) -> f64 {
        self.areas.undecided
    }

    /// Whether no direction is free, for certain.
    pub fn is_blocked(&self) -> bool {
        self.leaves().all(|(cell, fate)| match fate {
            Fate::Cut(_) | Fate::Blocked(_) | Fate::Inner(_) => true,
            Fate::Undecided(_) => false,
            Fate::Open(pairs) => {
                rest_of(&self.bodies, cell, pairs).is_ok_and(|rest| rest.pieces.is_empty())
            }
        })
    }

    /// Whether nothing is undecided.
    pub fn is_complete(&self) -> bool {
        self.leaves().all(|(_, fate)| !matches!(fate, Fate::Undecided(_)))
    }

    /// Convex pieces that together are all that is free with an area, by cells: neighbours share borders.
    pub fn pieces(&self) -> Vec<FreePiece> {
        let piece = |(cell, piece): (Cell, Piece)| {
            piece
                .is_region()
                .then(|| FreePiece { corners: directions(&cell, &piece), area: piece.area() })
        };
        self.parts().filter_map(piece).collect()
    }

    /// The connected regions of what is free with an area, the largest first.
    pub fn regions(&self) -> Vec<FreeRegion> {
        regions(&self.pieces(), |d| matches!(self.says(d), Ok(Verdict::Free)))
    }

    /// Arcs of free directions beside which there is no region.
    pub fn arcs(&self) -> &[FreeArc] {
        &self.thin().arcs
    }

    /// Free directions with no other beside them.
    pub fn points(&self) -> &[FreePoint] {
        &self.thin().points
    }

    /// Whether a direction, of any length, is that of a point, exactly; not if there are no such planes.
    ///
    /// # Errors
    /// A direction that is zero, not finite or out of range.
    ///
    /// ```
    /// use colltrans::free::{FreeDirections, FreeOptions};
    /// use colltrans::glam::DVec3;
    /// use colltrans::{ConvexPolyhedron, Pose, Solid};
    ///
    /// // A bar in a tube that is open at its ends.
    /// let cuboid = |low: [f64; 3], high: [f64; 3]| ConvexPolyhedron::cuboid(low.into(), high.into());
    /// let walls = Solid::from_pieces(&[
    ///     cuboid([-1.0, -1.0, 0.0], [4.0, 0.0, 1.0])?,
    ///     cuboid([-1.0, 1.0, 0.0], [4.0, 2.0, 1.0])?,
    ///     cuboid([-1.0, -1.0, -1.0], [4.0, 2.0, 0.0])?,
    ///     cuboid([-1.0, -1.0, 1.0], [4.0, 2.0, 2.0])?,
    /// ])?;
    /// let (bar, here) = (cuboid([0.0, 0.0, 0.0], [3.0, 1.0, 1.0])?, Pose::IDENTITY);
    /// let options = FreeOptions::default().with_no_tolerance();
    /// let free = FreeDirections::of(&bar.at(here), &walls.at(here), options)?;
    /// let points = free.points();
    /// assert_eq!(points.len(), 2);
    /// assert!(points.iter().any(|point| free.is_at(point, DVec3::X) == Ok(true)));
    /// assert!(points.iter().all(|point| free.is_at(point, DVec3::new(1.0, 1e-50, 0.0)) == Ok(false)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn is_at(&self, point: &FreePoint, direction: DVec3) -> Result<bool, QueryError> {
        check_direction(direction)?;
        Ok(point.is(&self.bodies, direction))
    }

    /// Whether a direction, of any length, is on an arc or at one of its ends, exactly; not if there are no such planes.
    ///
    /// # Errors
    /// A direction that is zero, not finite or out of range.
    pub fn is_on(&self, arc: &FreeArc, direction: DVec3) -> Result<bool, QueryError> {
        check_direction(direction)?;
        Ok(arc.has(&self.bodies, direction))
    }

    fn thin(&self) -> &Thin {
        self.thin.get_or_init(|| thin(&self.bodies, self.leaves()))
    }

    /// The bodies, with a direction that plays no part.
    #[cfg(feature = "json")]
    #[doc(hidden)]
    pub fn cast(&self) -> &Cast<'a, Solid> {
        &self.cast
    }

    /// Free directions in cells that are undecided: arcs and points on their borders, their corners and middles, each asked by an ordinary cast, some
    /// of them if there are many.
    pub fn free_among_undecided(&self) -> Vec<DVec3> {
        let undecided = |(cell, fate): (Cell, &Fate)| match fate {
            Fate::Undecided(_) => {
                let middle = cell.side.direction(cell.center());
                Some(cell.corners().into_iter().chain([middle]))
            }
            _ => None,
        };
        let mut asked: Vec<DVec3> = Vec::new();
        let corners = self.leaves().filter_map(undecided).flatten();
        for d in self.thin().unclear.iter().copied().chain(corners) {
            // Of two sides of the cube the same direction.
            if !asked.contains(&d) {
                asked.push(d);
            }
            if asked.len() == MOST_ASKED {
                break;
            }
        }
        asked.retain(|&d| {
            let (moving, fixed) = (self.cast.moving(), self.cast.fixed());
            let (p, q) = (self.cast.moving_pose(), self.cast.fixed_pose());
            let options = self.options.with_tolerance(self.tolerance()).of_cast();
            let cast = Cast::<Solid>::new(moving.at(p), fixed.at(q), d);
            let answer = cast.and_then(|cast| cast.with_options(options)?.clearance());
            answer.is_ok_and(|answer| answer.is_free())
        });
        asked
    }

    /// The choices.
    pub fn options(&self) -> FreeOptions {
        self.options
    }

    /// How many cells the sphere was cut into, and how many pairs of nodes were looked at.
    pub fn work(&self) -> [u64; 2] {
        [self.leaves().count() as u64, self.looks]
    }

    /// The tolerance that is used, as a length.
    pub fn tolerance(&self) -> f64 {
        self.cast.tolerance()
    }

    /// Checks what is said of every cell by itself, without a search.
    ///
    /// # Errors
    /// What is not proven.
    pub fn verify(&self) -> Result<(), FreeError> {
        for (moving, boxes) in [(true, &self.boxes[0]), (false, &self.boxes[1])] {
            // Bodies that overlap now, which is ignored, do not block by what is inside.
            let counts = self.options.start_overlap == StartOverlap::Refuse;
            let inside = |one: &InnerBox| counts && one.is_inside(&self.bodies, moving);
            if !boxes.iter().all(inside) {
                return Err(CertificateError::Start.into());
            }
        }
        for (number, (cell, fate)) in self.leaves().enumerate() {
            if !holds(&self.bodies, &self.boxes, &cell, fate) {
                return Err(CertificateError::Cover { entry: number }.into());
            }
        }
        Ok(())
    }

    /// The cells of the proof. They are small beside borders and large elsewhere.
    pub fn cells(&self) -> impl Iterator<Item = FreeCell> {
        self.leaves().map(|(cell, fate)| FreeCell {
            corners: cell.corners(),
            kind: match fate {
                Fate::Blocked(_) | Fate::Inner(_) => CellKind::Blocked,
                Fate::Open(pairs) if pairs.is_empty() => CellKind::Free,
                Fate::Open(_) => CellKind::Both,
                Fate::Cut(_) | Fate::Undecided(_) => CellKind::Undecided,
            },
            blocked_by: match fate {
                Fate::Blocked(pair) => Some(*pair),
                Fate::Inner(_) => {
                    let middle = cell.side.direction(cell.center());
                    blocking_pair(&self.bodies, &cell, middle)
                }
                _ => None,
            },
            area: cell.area(),
        })
    }

    /// All that is said, with its proof.
    pub fn proof(&self) -> FreeProof {
        FreeProof {
            tolerance: self.cast.tolerance(),
            start_overlap: self.options.start_overlap,
            boxes: self.boxes.clone(),
            cells: cells(&self.fates),
        }
    }

    /// What a proof says of two bodies, if it holds: no search, whoever has made it.
    ///
    /// # Errors
    /// As [`Self::of`]; what is not proven, [`FreeError::NotProven`].
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
        all.areas = all.measure();
        Ok(all)
    }

    /// The same without a check, for who has made the proof: areas are told to be 0.
    ///
    /// # Errors
    /// As [`Self::of`]; cells that are not those of a sphere, facets that do not exist.
    pub fn believing<A: AsSolid, B: AsSolid>(
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
        let (cast, bodies) = setting(moving, fixed, &options)?;
        let misfit = CertificateError::Cover { entry: proof.cells.len() };
        let fates = fates(&proof.cells).ok_or(misfit)?;
        let boxes = proof.boxes.clone();
        let (areas, thin) = (Areas::default(), OnceLock::new());
        let all = Self { cast, bodies, options, boxes, fates, looks: 0, areas, thin };
        let exist = |fate: &Fate| names_exist(&all.bodies, &all.boxes, fate);
        let strange = all.leaves().position(|(_, fate)| !exist(fate));
        match strange {
            Some(entry) => Err(CertificateError::Cover { entry }.into()),
            None => Ok(all),
        }
    }

    /// The same with other choices for when it is asked once more; the tolerance and the meaning of an overlap stay.
    #[must_use]
    pub fn with_options(self, options: FreeOptions) -> Self {
        let FreeOptions { tolerance, start_overlap, .. } = self.options;
        let options = options.with_tolerance(tolerance).with_start_overlap(start_overlap);
        Self { options, ..self }
    }

    /// The cells that are not cut, in order.
    fn leaves(&self) -> impl Iterator<Item = (Cell, &Fate)> {
        let mut stack: Vec<(usize, Cell)> = Cell::roots().into_iter().enumerate().rev().collect();
        std::iter::from_fn(move || {
            loop {
                let (at, cell) = stack.pop()?;
                match &self.fates[at] {
                    Fate::Cut(first) => {
                        let quarter = |k: usize| (*first as usize + k, cell.quarter(k));
                        stack.extend((0..4).rev().map(quarter));
                    }
                    fate => return Some((cell, fate)),
                }
            }
        })
    }

    /// All that is free, in pieces of cells.
    fn parts(&self) -> impl Iterator<Item = (Cell, Piece)> {
        let rest = |(cell, fate): (Cell, &Fate)| {
            let rest = match fate {
                Fate::Open(pairs) => rest_of(&self.bodies, cell, pairs).ok(),
                _ => None,
            };
            let pieces = rest.map_or_else(Vec::new, |rest| rest.pieces);
            pieces.into_iter().map(move |piece| (cell, piece))
        };
        self.leaves().flat_map(rest)
    }

    fn measure(&self) -> Areas {
        let (mut free, mut error, mut undecided) = (0.0, 0.0, 0.0);
        for (cell, fate) in self.leaves() {
            let (pairs, open) = match fate {
                Fate::Open(pairs) => (pairs, true),
                Fate::Undecided(pairs) => (pairs, false),
                _ => continue,
            };
            let rest = rest_of(&self.bodies, cell, pairs).unwrap_or_else(|_| Rest::whole(cell));
            let area: f64 = rest.pieces.iter().map(Piece::area).sum();
            let off: f64 = rest.pieces.iter().map(Piece::area_error).sum();
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

/// Directions of the corners of a piece.
fn directions(cell: &Cell, piece: &Piece) -> Vec<DVec3> {
    piece.places().into_iter().map(|place| cell.side.direction(place)).collect()
}

/// The bodies, checked.
pub(super) fn setting<'a, A: AsSolid, B: AsSolid>(
    moving: &Placed<'a, A>,
    fixed: &Placed<'a, B>,
    options: &FreeOptions,
) -> Result<(Cast<'a, Solid>, Bodies<'a>), FreeError> {
    let cast = Cast::between(*moving, *fixed, DVec3::Z)?.with_options(options.of_cast())?;
    let scene = cast.asked_of_something()?;
    for (which, solid) in [("moving", cast.moving()), ("fixed", cast.fixed())] {
        if !solid.is_closed() {
            return Err(FreeError::Open { which });
        }
    }
    if options.start_overlap == StartOverlap::Refuse
        && let Some(place) = overlap::find(&scene, &mut SolidSteps::default())
    {
        return Err(FreeError::Overlapping { place });
    }
    Ok((cast, Bodies::new(scene)))
}
