//! A map of the faces that one direction enters.
//!
//! Corners are kept as the direction sees them, face by face, and so are the planes over the rim; a grid over the
//! shadow says at which face to begin.

use glam::{DVec2, DVec3};

use super::FixedRotations;
use super::faces::Faces;
use super::proof::{Clear, Line, Rim, axes, contact, separated};
use super::search::{ENTERED, Reached, Seen, axes_of, steps, walk};
use colltrans_convex::answer::{Clearance, ContactRange, Outcome};
use colltrans_convex::cast::{Cast, clearance_of, contact_range_by_casts};
use colltrans_convex::setting::check_direction;
use colltrans_convex::setting::error::QueryError;

/// Casts of one pair with one rotation of each body along one direction: [`FixedRotations::along`].
///
/// What it is asked along another direction is answered as [`FixedRotations`] does.
#[derive(Debug)]
pub struct Approach<'f, 'a> {
    rotations: &'f FixedRotations<'a>,
    direction: DVec3,
    axes: [DVec3; 3],
    map: Option<Map>,
}

#[derive(Debug)]
struct Map {
    /// First corner of each face that is entered, and one entry past the end.
    starts: Vec<u32>,
    corners: Vec<Corner>,
    /// Their numbers among all faces.
    faces: Vec<u32>,
    /// Beyond sides that lead to no face; none where two faces are nearly each other's back.
    rims: Vec<Option<Rim>>,
    grid: Grid,
}

#[derive(Debug, Clone, Copy)]
struct Corner {
    pub at: DVec3,
    /// The face beyond the side that begins here.
    beyond: Beyond,
}

#[derive(Debug, Clone, Copy)]
enum Beyond {
    Face(u32),
    Rim(u32),
}

/// Faces to begin at, over a rectangle across the direction.
#[derive(Debug)]
struct Grid {
    low: DVec2,
    per_cell: DVec2,
    side: usize,
    cells: Vec<u32>,
}

/// How far the grid reaches beyond the shadow, as a share of its size.
const AROUND: f64 = 0.25;

impl<'f, 'a> Approach<'f, 'a> {
    pub(super) fn new(
        rotations: &'f FixedRotations<'a>,
        direction: DVec3,
    ) -> Result<Self, QueryError> {
        check_direction(direction)?;
        let axes = axes(direction * (1.0 / direction.length()));
        let map = rotations.faces.as_ref().and_then(|faces| Map::new(faces, &axes));
        Ok(Self { rotations, direction, axes, map })
    }

    /// [`Cast::first_contact`].
    ///
    /// # Errors
    /// As [`Cast::first_contact`].
    pub fn first_contact(&self, cast: &Cast<'a>) -> Result<Outcome, QueryError> {
        if cast.setting.direction != self.direction {
            return self.rotations.first_contact(cast);
        }
        match self.found(cast) {
            Some(outcome) => Ok(outcome),
            None => cast.first_contact(),
        }
    }

    /// [`Cast::contact_range`].
    ///
    /// # Errors
    /// As [`Cast::first_contact`].
    pub fn contact_range(&self, cast: &Cast<'a>) -> Result<ContactRange, QueryError> {
        contact_range_by_casts(cast, |cast| self.first_contact(cast))
    }

    /// [`Cast::clearance`].
    ///
    /// # Errors
    /// As [`Cast::first_contact`].
    pub fn clearance(&self, cast: &Cast<'a>) -> Result<Clearance, QueryError> {
        clearance_of(cast, |cast| self.first_contact(cast))
    }

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "moved about, an outcome goes through memory")]
    fn found(&self, cast: &Cast<'a>) -> Option<Outcome> {
        let faces = self.rotations.faces_for(cast)?;
        let map = self.map.as_ref()?;
        let line = Line::of(cast);
        let seen = Here { map, at: axes_of(&self.axes, line.setting.offset) };
        match walk(&seen, map.grid.guess(-seen.at.truncate()), &line.clear)? {
            (Reached::Face { face, certain: true }, looked) => {
                let of = map.faces[face as usize];
                contact(faces, of, (&seen, face), &line, steps(looked)).map(Outcome::Contact)
            }
            (Reached::Face { .. }, _) => None,
            (Reached::Rim { face, side }, looked) => {
                let Beyond::Rim(rim) = map.corners(face)[side].beyond else { return None };
                separated(map.rims[rim as usize].as_ref()?, &line, steps(looked))
                    .map(Outcome::Separated)
            }
        }
    }
}

impl Map {
    /// `None` if no face is entered.
    fn new(faces: &Faces, axes: &[DVec3; 3]) -> Option<Self> {
        let mut number = vec![None; faces.planes.len()];
        let mut entered = Vec::new();
        for (face, plane) in faces.planes.iter().enumerate() {
            if plane.normal.dot(axes[2]) > ENTERED {
                number[face] = Some(entered.len() as u32);
                entered.push(face as u32);
            }
        }
        let (mut starts, mut corners, mut rims) = (vec![0], Vec::new(), Vec::new());
        for &face in &entered {
            for side in faces.sides(face) {
                let beyond = number[side.beyond as usize].map_or_else(
                    || {
                        let [of, other] = [face, side.beyond].map(|f| &faces.planes[f as usize]);
                        rims.push(Rim::new(of, other, axes[2]));
                        Beyond::Rim(rims.len() as u32 - 1)
                    },
                    Beyond::Face,
                );
                let at = axes_of(axes, faces.points[side.corner as usize]);
                corners.push(Corner { at, beyond });
            }
            starts.push(corners.len() as u32);
        }
        let shadows = || corners.iter().map(|corner| corner.at.truncate());
        let low = shadows().reduce(DVec2::min)?;
        let high = shadows().reduce(DVec2::max)?;
        let around = (high - low) * AROUND;
        let side = (2 * entered.len()).isqrt().clamp(4, 64);
        let per_cell = side as f64 / (high - low + around * 2.0);
        let grid = Grid { low: low - around, per_cell, side, cells: Vec::new() };
        let mut map = Self { starts, corners, faces: entered, rims, grid };
        map.grid.cells = map.begin();
        Some(map)
    }

    /// For each cell of the grid the face where a walk to its middle ends.
    fn begin(&self) -> Vec<u32> {
        let mut last = 0;
        let face = |cell: usize| {
            let middle = self.grid.middle(cell);
            let seen = Here { map: self, at: (-middle).extend(0.0) };
            let reached = walk(&seen, last, &Clear::default());
            if let Some((Reached::Face { face, .. } | Reached::Rim { face, .. }, _)) = reached {
                last = face;
            }
            last
        };
        (0..self.grid.side * self.grid.side).map(face).collect()
    }

    #[inline]
    fn corners(&self, face: u32) -> &[Corner] {
        let [start, end] = [face, face + 1].map(|face| self.starts[face as usize] as usize);
        &self.corners[start..end]
    }
}

impl Grid {
    fn middle(&self, cell: usize) -> DVec2 {
        let place = DVec2::new((cell % self.side) as f64, (cell / self.side) as f64);
        self.low + (place + 0.5) / self.per_cell
    }

    #[inline]
    fn guess(&self, x: DVec2) -> u32 {
        let place = (x - self.low) * self.per_cell;
        // What is not a number, or negative, is 0 as a whole one.
        let [x, y] = place.to_array().map(|c| (c as usize).min(self.side - 1));
        self.cells[y * self.side + x]
    }
}

/// The map, relative to a line: faces by their numbers in the map.
struct Here<'m> {
    map: &'m Map,
    at: DVec3,
}

impl Seen for Here<'_> {
    type Side = Corner;

    #[inline]
    fn sides(&self, face: u32) -> &[Corner] {
        self.map.corners(face)
    }

    #[inline]
    fn corner(&self, side: &Corner) -> DVec3 {
        side.at + self.at
    }

    #[inline]
    fn beyond(&self, side: &Corner) -> Option<u32> {
        match side.beyond {
            Beyond::Face(face) => Some(face),
            Beyond::Rim(_) => None,
        }
    }
}
