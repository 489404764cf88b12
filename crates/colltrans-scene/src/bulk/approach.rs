//! A map of the faces that lines along one direction enter, of `M0`, the Minkowski difference without translations.
//!
//! The map stores the corners of these faces, in a frame whose third axis is the direction. At each edge of the
//! silhouette it stores a plane parallel to the direction. A grid over the shadow stores, for each cell, the face at
//! which a walk starts.

use glam::{DVec2, DVec3};

use super::FixedRotations;
use super::faces::Faces;
use super::proof::{
    Line, LineMargins, SilhouettePlane, build_contact, build_separation, direction_axes,
};
use super::search::{
    LineView, MIN_ENTRY_COMPONENT, WalkEnd, coordinates_along, walk_faces, walk_steps,
};
use colltrans_convex::answer::{Clearance, ContactRange, Outcome};
use colltrans_convex::cast::{Cast, clearance_by_casts, contact_range_by_casts};
use colltrans_convex::setting::check_direction;
use colltrans_convex::setting::error::QueryError;

/// Casts of one pair with fixed rotations along one direction: [`FixedRotations::for_direction`]. Casts along another
/// direction are answered by [`FixedRotations`].
#[derive(Debug)]
pub struct DirectionMap<'f, 'a> {
    rotations: &'f FixedRotations<'a>,
    direction: DVec3,
    axes: [DVec3; 3],
    map: Option<Map>,
}

/// The entered faces, in coordinates of the direction.
#[derive(Debug)]
struct Map {
    /// Index of the first corner of each entered face, with one entry past the end.
    starts: Vec<u32>,
    corners: Vec<Corner>,
    /// Indices of the entered faces among all faces.
    faces: Vec<u32>,
    /// Planes beyond sides without an entered face; `None` if the two faces have nearly opposite normals.
    silhouettes: Vec<Option<SilhouettePlane>>,
    grid: Grid,
}

/// A corner of an entered face.
#[derive(Debug, Clone, Copy)]
struct Corner {
    pub at: DVec3,
    /// Content beyond the side that starts at this corner.
    beyond: Beyond,
}

/// An entered face, or a plane at the silhouette.
#[derive(Debug, Clone, Copy)]
enum Beyond {
    Face(u32),
    Silhouette(u32),
}

/// Start faces of walks, over a rectangle perpendicular to the direction.
#[derive(Debug)]
struct Grid {
    low: DVec2,
    per_cell: DVec2,
    side: usize,
    cells: Vec<u32>,
}

/// Margin of the grid around the shadow, relative to its size.
const GRID_MARGIN: f64 = 0.25;

impl<'f, 'a> DirectionMap<'f, 'a> {
    /// Builds the map of a direction.
    pub(super) fn new(
        rotations: &'f FixedRotations<'a>,
        direction: DVec3,
    ) -> Result<Self, QueryError> {
        check_direction(direction)?;
        let axes = direction_axes(direction * (1.0 / direction.length()));
        let map = rotations.faces.as_ref().and_then(|faces| Map::new(faces, &axes));
        Ok(Self { rotations, direction, axes, map })
    }

    /// Computes the answer of [`Cast::first_contact`].
    ///
    /// # Errors
    /// Returns the errors of [`Cast::first_contact`].
    pub fn first_contact(&self, cast: &Cast<'a>) -> Result<Outcome, QueryError> {
        if cast.setting.direction != self.direction {
            return self.rotations.first_contact(cast);
        }
        match self.outcome_by_faces(cast) {
            Some(outcome) => Ok(outcome),
            None => cast.first_contact(),
        }
    }

    /// Computes the answer of [`Cast::contact_range`].
    ///
    /// # Errors
    /// Returns the errors of [`Cast::first_contact`].
    pub fn contact_range(&self, cast: &Cast<'a>) -> Result<ContactRange, QueryError> {
        contact_range_by_casts(cast, |cast| self.first_contact(cast))
    }

    /// Computes the answer of [`Cast::clearance`].
    ///
    /// # Errors
    /// Returns the errors of [`Cast::first_contact`].
    pub fn clearance(&self, cast: &Cast<'a>) -> Result<Clearance, QueryError> {
        clearance_by_casts(cast, |cast| self.first_contact(cast))
    }

    /// Returns the answer by the map, or `None` if it is not certain.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "moved about, an outcome goes through memory")]
    fn outcome_by_faces(&self, cast: &Cast<'a>) -> Option<Outcome> {
        let faces = self.rotations.faces_for(cast)?;
        let map = self.map.as_ref()?;
        let line = Line::from_cast(cast);
        let view = MapView { map, at: coordinates_along(&self.axes, line.setting.offset) };
        match walk_faces(&view, map.grid.guessed_face(-view.at.truncate()), &line.margins)? {
            (WalkEnd::Face { face, certain: true }, visited) => {
                let of = map.faces[face as usize];
                build_contact(faces, of, (&view, face), &line, walk_steps(visited))
                    .map(Outcome::Contact)
            }
            (WalkEnd::Face { .. }, _) => None,
            (WalkEnd::Silhouette { face, side }, visited) => {
                let Beyond::Silhouette(silhouette) = map.corners(face)[side].beyond else {
                    return None;
                };
                build_separation(
                    map.silhouettes[silhouette as usize].as_ref()?,
                    &line,
                    walk_steps(visited),
                )
                .map(Outcome::Separated)
            }
        }
    }
}

impl Map {
    /// Builds the map. Returns `None` if no face is entered.
    fn new(faces: &Faces, axes: &[DVec3; 3]) -> Option<Self> {
        let mut number = vec![None; faces.planes.len()];
        let mut entered = Vec::new();
        for (face, plane) in faces.planes.iter().enumerate() {
            if plane.normal.dot(axes[2]) > MIN_ENTRY_COMPONENT {
                number[face] = Some(entered.len() as u32);
                entered.push(face as u32);
            }
        }
        let (mut starts, mut corners, mut silhouettes) = (vec![0], Vec::new(), Vec::new());
        for &face in &entered {
            for side in faces.sides(face) {
                let beyond = number[side.beyond as usize].map_or_else(
                    || {
                        let [of, other] = [face, side.beyond].map(|f| &faces.planes[f as usize]);
                        silhouettes.push(SilhouettePlane::new(of, other, axes[2]));
                        Beyond::Silhouette(silhouettes.len() as u32 - 1)
                    },
                    Beyond::Face,
                );
                let at = coordinates_along(axes, faces.points[side.corner as usize]);
                corners.push(Corner { at, beyond });
            }
            starts.push(corners.len() as u32);
        }
        let shadows = || corners.iter().map(|corner| corner.at.truncate());
        let low = shadows().reduce(DVec2::min)?;
        let high = shadows().reduce(DVec2::max)?;
        let around = (high - low) * GRID_MARGIN;
        let side = (2 * entered.len()).isqrt().clamp(4, 64);
        let per_cell = side as f64 / (high - low + around * 2.0);
        let grid = Grid { low: low - around, per_cell, side, cells: Vec::new() };
        let mut map = Self { starts, corners, faces: entered, silhouettes, grid };
        map.grid.cells = map.start_faces();
        Some(map)
    }

    /// Computes for each cell of the grid the face where a walk to its middle ends.
    fn start_faces(&self) -> Vec<u32> {
        let mut last = 0;
        let face = |cell: usize| {
            let middle = self.grid.cell_middle(cell);
            let view = MapView { map: self, at: (-middle).extend(0.0) };
            let reached = walk_faces(&view, last, &LineMargins::default());
            if let Some((WalkEnd::Face { face, .. } | WalkEnd::Silhouette { face, .. }, _)) =
                reached
            {
                last = face;
            }
            last
        };
        (0..self.grid.side * self.grid.side).map(face).collect()
    }

    /// Returns the corners of an entered face.
    #[inline]
    fn corners(&self, face: u32) -> &[Corner] {
        let [start, end] = [face, face + 1].map(|face| self.starts[face as usize] as usize);
        &self.corners[start..end]
    }
}

impl Grid {
    /// Returns the middle of a cell.
    fn cell_middle(&self, cell: usize) -> DVec2 {
        let place = DVec2::new((cell % self.side) as f64, (cell / self.side) as f64);
        self.low + (place + 0.5) / self.per_cell
    }

    /// Returns the start face of a point in the shadow.
    #[inline]
    fn guessed_face(&self, x: DVec2) -> u32 {
        let place = (x - self.low) * self.per_cell;
        // NaN and negative numbers convert to 0.
        let [x, y] = place.to_array().map(|c| (c as usize).min(self.side - 1));
        self.cells[y * self.side + x]
    }
}

/// The map relative to a line, with faces by their indices in the map.
struct MapView<'m> {
    map: &'m Map,
    at: DVec3,
}

impl LineView for MapView<'_> {
    type Side = Corner;

    #[inline]
    fn sides(&self, face: u32) -> &[Corner] {
        self.map.corners(face)
    }

    #[inline]
    fn corner_coordinates(&self, side: &Corner) -> DVec3 {
        side.at + self.at
    }

    #[inline]
    fn face_beyond(&self, side: &Corner) -> Option<u32> {
        match side.beyond {
            Beyond::Face(face) => Some(face),
            Beyond::Silhouette(_) => None,
        }
    }
}
