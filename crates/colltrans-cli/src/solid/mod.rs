//! Bodies of parts that need not be convex, and their queries.
//!
//! A body has one file or several. Each is a *piece* with a name, so that an answer can name the files involved.
//! [`load`](Body::load) reads them. [`ask`] answers clearances, [`pair`] distances and depths, [`free`] sets of directions,
//! and [`motion`] motions.

mod ask;
mod free;
mod motion;
mod pair;
mod shrinkable;

use std::fmt::Write as _;
use std::path::PathBuf;

use colltrans::glam::DVec3;
use colltrans::record::FeaturesRecord;
use colltrans::solid::{AsSolid, SolidReport};
use colltrans::{Aabb, ConvexPolyhedron, Pose, QueryError, Solid};
use colltrans_mesh::Mesh;
use colltrans_mesh::body::{self, BodyError, BodyOptions, Loaded, Note, drawn_body, load_solid};

use crate::body::{load_error_message, note_of_file, option_hint};
use crate::failure::{Code, Failure};
use crate::numbers::{count_text, error_bound, smaller_extent};
pub(crate) use ask::{Answer, PartsQuery};
pub(crate) use free::{DirectionsAnswer, PartsDirections};
pub(crate) use motion::PartsMotion;
pub(crate) use pair::PartsPair;
use shrinkable::Reports;

/// A body of one or several pieces.
#[derive(Debug)]
pub(crate) struct Body {
    pieces: Vec<Piece>,
    /// Union of all pieces; `None` if there is only one.
    union: Option<Solid>,
    /// Notes about repairs.
    pub(crate) notes: Vec<String>,
}

/// The solid of one file.
#[derive(Debug)]
struct Piece {
    file: PathBuf,
    solid: Solid,
    /// Rounding error of the coordinates in the file, in the unit of the body.
    precision: f64,
    /// Reports about its offsets.
    reports: Reports,
}

impl Piece {
    /// Returns the piece of a file.
    fn new(file: PathBuf, solid: Solid, precision: f64) -> Self {
        Self { file, solid, precision, reports: Reports::default() }
    }
}

impl Body {
    /// Reads files as one body. Calls `file_done` after each.
    ///
    /// # Errors
    /// A file cannot be read or is not a closed surface. The message names the file and options that avoid the error.
    pub(crate) fn load(
        files: &[PathBuf],
        options: &BodyOptions,
        mut file_done: impl FnMut(),
    ) -> Result<Self, String> {
        let mut pieces = Vec::with_capacity(files.len());
        let mut notes = Vec::new();
        for file in files {
            let Loaded { body: solid, precision, notes: repairs } =
                load_solid(file, options).map_err(|error| load_error_message(&error))?;
            notes.extend(repairs.iter().map(|note| note_of_file(file, note)));
            pieces.push(Piece::new(file.clone(), solid, precision));
            file_done();
        }
        Self::from_pieces(pieces, notes)
    }

    /// Builds a body of the surface of a convex one, with precision 0. A point or a segment becomes a facet without area.
    pub(crate) fn from_convex(body: &ConvexPolyhedron) -> Result<Self, String> {
        let surface = body.as_surface().map_err(|error| BodyError::Solid(error).to_string())?;
        let piece = Piece::new(PathBuf::new(), surface.clone(), 0.0);
        Self::from_pieces(vec![piece], Vec::new())
    }

    /// Returns the body swept by a ball of the radius.
    ///
    /// # Errors
    /// The radius is negative, not finite or out of range.
    pub(crate) fn rounded(mut self, radius: f64) -> Result<Self, String> {
        let whole = self.union.as_mut().unwrap_or(&mut self.pieces[0].solid);
        *whole = whole.clone().rounded(radius).map_err(|error| error.to_string())?;
        Ok(self)
    }

    /// Builds the body of pieces, and their union if there are several.
    fn from_pieces(pieces: Vec<Piece>, notes: Vec<String>) -> Result<Self, String> {
        let union = match pieces.as_slice() {
            [_] => None,
            several => Some(
                Solid::from_pieces(several.iter().map(|piece| &piece.solid))
                    .map_err(|error| error.to_string())?,
            ),
        };
        Ok(Self { pieces, union, notes })
    }

    /// Returns the union of all pieces.
    pub(crate) fn solid(&self) -> &Solid {
        self.union.as_ref().unwrap_or_else(|| &self.pieces[0].solid)
    }

    /// Returns the solids of all pieces.
    fn solids(&self) -> Vec<&Solid> {
        self.pieces.iter().map(|piece| &piece.solid).collect()
    }

    /// Returns the coarsest precision of its files.
    pub(crate) fn precision(&self) -> f64 {
        self.pieces.iter().map(|piece| piece.precision).fold(0.0, f64::max)
    }

    /// Returns the memory of all solids.
    pub(crate) fn memory_bytes(&self) -> usize {
        let pieces: usize = self.pieces.iter().map(|piece| piece.solid.memory_bytes()).sum();
        pieces + self.union.as_ref().map_or(0, Solid::memory_bytes)
    }

    /// Returns the bounding box, including the radius.
    pub(crate) fn bounds(&self) -> Aabb {
        solid_bounds(self.solid())
    }

    /// Returns the vertices at a pose, relative to `origin`, and the triangles. Those of a rounded solid form
    /// polyhedra around its facets, or its core if it has too many.
    pub(crate) fn surface(&self, pose: &Pose, origin: DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let solid = self.solid();
        if solid.radius() != 0.0 && solid.triangles().len() <= MAX_DRAWN_FACETS {
            return rounded_surface(solid, pose, origin);
        }
        let offset = pose.translation() - origin;
        let placed = solid.vertices().iter().map(|&v| pose.matrix() * v + offset).collect();
        (placed, solid.triangles().to_vec())
    }
}

/// Returns the bounding box of a solid, including its radius.
pub(crate) fn solid_bounds(solid: &Solid) -> Aabb {
    solid.bounds().expanded(solid.radius())
}

/// Returns the failure of a query of two bodies. If the default tolerance removes a body completely, the message names the
/// file with the largest coordinates, because the default follows from their rounding error.
pub(crate) fn query_failure(
    error: QueryError,
    bodies: [&Body; 2],
    tolerance: Option<f64>,
) -> Failure {
    let (QueryError::NothingLeft { .. }, None) = (&error, tolerance) else { return error.into() };
    let largest = |piece: &Piece| {
        let bounds = piece.solid.bounds();
        bounds.low.abs().max(bounds.high.abs()).max_element()
    };
    let pieces = bodies.into_iter().flat_map(|body| &body.pieces);
    let sizes = pieces.map(|piece| (largest(piece), &piece.file));
    let Some((size, file)) = sizes.max_by(|a, b| a.0.total_cmp(&b.0)) else { return error.into() };
    let text = format!(
        "{}: coordinates up to {}, whose rounding determines the default tolerance; {error}. Check the unit of the \
         file, or give --tolerance",
        file.display(),
        error_bound(size)
    );
    Failure::new(Code::Input, text)
}

/// Maximum number of facets of a rounded solid that is drawn with its radius.
const MAX_DRAWN_FACETS: usize = 100;

/// Returns the surfaces of polyhedra around the facets of a rounded solid, at a pose, relative to `origin`.
fn rounded_surface(solid: &Solid, pose: &Pose, origin: DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for corners in solid.triangles() {
        let corners = corners.map(|v| solid.vertices()[v as usize]);
        let facet = ConvexPolyhedron::from_points(&corners);
        let Ok(facet) = facet.and_then(|facet| facet.rounded(solid.radius())) else { continue };
        let (points, faces) = placed_surface(&facet, pose, origin);
        let first = vertices.len() as u32;
        triangles.extend(faces.iter().map(|face| face.map(|v| v + first)));
        vertices.extend(points);
    }
    (vertices, triangles)
}

/// Returns the vertices of a convex body at a pose, relative to `origin`, and triangles of its faces.
pub(crate) fn placed_surface(
    body: &ConvexPolyhedron,
    pose: &Pose,
    origin: DVec3,
) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let body = &*drawn_body(body);
    let offset = pose.translation() - origin;
    let placed = body.vertices().iter().map(|&v| pose.matrix() * v + offset).collect();
    let faces = (0..body.face_count() as u32).map(|f| body.face_vertices(f).collect::<Vec<_>>());
    let fan = |face: Vec<u32>| (2..face.len()).map(move |k| [face[0], face[k - 1], face[k]]);
    (placed, faces.flat_map(fan).collect())
}

/// The report on a mesh as a solid, with the notes on its repair.
pub(crate) type SolidCheck = Result<(SolidReport, Vec<Note>), BodyError>;

/// Returns the lines of `info` about a mesh as a solid, with their headings; none for a point cloud. `check` is the
/// [`body::solid_report`] of the mesh with the default options.
pub(crate) fn description_lines(mesh: &Mesh, check: &SolidCheck) -> Vec<(&'static str, String)> {
    if mesh.faces.is_empty() {
        return Vec::new();
    }
    let (report, notes) = match check {
        Ok(found) => found,
        Err(refused) => {
            let mut lines = vec![("solid", format!("no: {refused}{}", option_hint(refused)))];
            let open = body::solid_report(mesh, &BodyOptions::default().with_open(true));
            let surface = open.ok().and_then(|(report, _)| report.open_shell_summary());
            lines.extend(surface.map(|surface| ("with --open", surface)));
            return lines;
        }
    };
    let mut lines = vec![("solid", format!("yes: {}", shell_counts(report)))];
    lines.extend(notes.iter().filter_map(|note| match note {
        // `info` has another line for it.
        Note::Merged(_) => None,
        Note::Crowded(_) => Some(("touches", format!("itself: {note}"))),
        repair => Some(("repaired", repair.to_string())),
    }));
    lines
}

/// Returns the numbers of shells, of cavities and of through holes.
fn shell_counts(report: &SolidReport) -> String {
    let cavities = report.shells.iter().filter(|shell| shell.volume < 0.0).count();
    let mut text = count_text(report.shells.len() - cavities, "shell", "shells");
    if cavities > 0 {
        let _ = write!(text, ", {}", count_text(cavities, "cavity", "cavities"));
    }
    let holes = count_text(report.holes_through() as usize, "hole", "holes");
    let _ = write!(text, ", {holes} through");
    let unknown = report.shells.iter().filter(|shell| shell.holes_through.is_none()).count();
    if unknown > 0 {
        let shells = count_text(unknown, "shell", "shells");
        let _ = write!(text, " (not counted in {shells} that touch themselves)");
    }
    text
}

/// Returns the extent of the smaller body.
pub(crate) fn extent(bodies: [&Body; 2]) -> f64 {
    smaller_extent(bodies.map(Body::bounds))
}

/// Renumbers the vertices of features as in their files. Returns the names of the two files; `None` without features.
fn renumber_features(
    bodies: [&Body; 2],
    features: &mut Option<FeaturesRecord>,
) -> [Option<String>; 2] {
    let Some(FeaturesRecord { moving, fixed }) = features else { return [None, None] };
    [Some(bodies[0].renumber_feature(moving)), Some(bodies[1].renumber_feature(fixed))]
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::shapes::block;

    use super::*;

    /// Returns a cube of side 2 with a cavity of side 1, and next to it a reversed cube of side 1.
    fn cubes() -> Mesh {
        let cube = |low: f64, high: f64| block([low; 3], [high; 3]);
        let all = cube(0.0, 2.0).joined(&cube(0.5, 1.5).reversed());
        let all = all.joined(&cube(5.0, 6.0).reversed());
        Mesh::new(all.vertices, all.faces)
    }

    fn lines_of(mesh: &Mesh) -> Vec<(&'static str, String)> {
        description_lines(mesh, &body::solid_report(mesh, &BodyOptions::default()))
    }

    #[test]
    fn description_counts_shells_cavities_and_reversed_shells() {
        let lines = lines_of(&cubes());
        assert_eq!(lines[0], ("solid", "yes: 2 shells, 1 cavity, 0 holes through".into()));
        assert_eq!(lines[1], ("repaired", "1 shell turned, inside out in the file".into()));
        assert_eq!(lines.len(), 2);
        let mut open = cubes();
        open.faces.pop();
        let [("solid", what), ("with --open", surface)] = &lines_of(&open)[..] else {
            panic!("two lines")
        };
        assert!(what.starts_with("no: ") && what.contains("--open"), "{what}");
        assert!(surface.starts_with("1 sheet, "), "{surface}");
        assert!(surface.ends_with("2 closed shells keep their inside"), "{surface}");
    }
}
