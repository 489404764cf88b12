//! Parts that need not be convex: the library's solids, as the commands use them.
//!
//! A body is made of one file or of several; each is a *piece* and keeps its name, so that an
//! answer can say which files are involved. This is the only module that knows the library's
//! solids: [`load`](Body::load) makes them of files, [`ask`] asks them for a clearance, [`pair`] where they
//! are, [`free`] for all directions.

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
use colltrans::{ConvexPolyhedron, Pose, QueryError, Solid};
use colltrans_mesh::Mesh;
use colltrans_mesh::body::{self, BodyOptions, Loaded, Note, Refused, load_solid};

use crate::body::{hint, of_file, refusal};
use crate::failure::{Code, Failure};
use crate::numbers::counted;
pub(crate) use ask::{Answer, PartsQuery};
pub(crate) use free::{FreeAnswer, PartsFree};
pub(crate) use motion::PartsMotion;
pub(crate) use pair::PartsPair;
use shrinkable::Reports;

/// A body of one piece or several.
#[derive(Debug)]
pub(crate) struct Body {
    pieces: Vec<Piece>,
    /// All pieces together, where there are several.
    union: Option<Solid>,
    /// What was mended.
    pub(crate) notes: Vec<String>,
}

#[derive(Debug)]
struct Piece {
    file: PathBuf,
    solid: Solid,
    /// In the unit of the body.
    precision: f64,
    /// What of it cannot be shrunk.
    reports: Reports,
}

impl Piece {
    fn new(file: PathBuf, solid: Solid, precision: f64) -> Self {
        Self { file, solid, precision, reports: Reports::default() }
    }
}

impl Body {
    /// Reads files as one body; `done` is called after each. The message of an error names the file
    /// and says what would help.
    pub(crate) fn load(
        files: &[PathBuf],
        options: &BodyOptions,
        mut done: impl FnMut(),
    ) -> Result<Self, String> {
        let mut pieces = Vec::with_capacity(files.len());
        let mut notes = Vec::new();
        for file in files {
            let Loaded { body: solid, precision, notes: mended } =
                load_solid(file, options).map_err(|error| refusal(&error))?;
            notes.extend(mended.iter().map(|note| of_file(file, note)));
            pieces.push(Piece::new(file.clone(), solid, precision));
            done();
        }
        Self::of_pieces(pieces, notes)
    }

    /// Makes a body of the surface of a convex one, in double precision. A point or a segment is a facet without area.
    pub(crate) fn of_convex(body: &ConvexPolyhedron) -> Result<Self, String> {
        let made = body.as_surface().map_err(|error| Refused::Solid(error).to_string())?;
        let piece = Piece::new(PathBuf::new(), made.clone(), 0.0);
        Self::of_pieces(vec![piece], Vec::new())
    }

    fn of_pieces(pieces: Vec<Piece>, notes: Vec<String>) -> Result<Self, String> {
        let union = match pieces.as_slice() {
            [_] => None,
            several => Some(
                Solid::from_pieces(several.iter().map(|piece| &piece.solid))
                    .map_err(|error| error.to_string())?,
            ),
        };
        Ok(Self { pieces, union, notes })
    }

    pub(crate) fn solid(&self) -> &Solid {
        self.union.as_ref().unwrap_or_else(|| &self.pieces[0].solid)
    }

    /// The solids that it is the union of.
    fn solids(&self) -> Vec<&Solid> {
        self.pieces.iter().map(|piece| &piece.solid).collect()
    }

    /// The coarsest of its files.
    pub(crate) fn precision(&self) -> f64 {
        self.pieces.iter().map(|piece| piece.precision).fold(0.0, f64::max)
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        let pieces: usize = self.pieces.iter().map(|piece| piece.solid.memory_bytes()).sum();
        pieces + self.union.as_ref().map_or(0, Solid::memory_bytes)
    }

    /// Its vertices where it is placed, relative to a point, and its triangles.
    pub(crate) fn surface(&self, pose: &Pose, origin: DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let solid = self.solid();
        let offset = pose.translation() - origin;
        let placed = solid.vertices().iter().map(|&v| pose.matrix() * v + offset).collect();
        (placed, solid.triangles().to_vec())
    }
}

/// Returns why a query about two bodies has no answer. If nobody chose the tolerance, a tolerance that leaves
/// nothing of a body is a fault of the file with the largest coordinates, because these ask for it.
pub(crate) fn refused(error: QueryError, bodies: [&Body; 2], tolerance: Option<f64>) -> Failure {
    let (QueryError::NothingLeft { .. }, None) = (&error, tolerance) else { return error.into() };
    let largest = |piece: &Piece| {
        let bounds = piece.solid.bounds();
        bounds.low.abs().max(bounds.high.abs()).max_element()
    };
    let pieces = bodies.into_iter().flat_map(|body| &body.pieces);
    let sized = pieces.map(|piece| (largest(piece), &piece.file));
    let Some((size, file)) = sized.max_by(|a, b| a.0.total_cmp(&b.0)) else { return error.into() };
    let text = format!(
        "{}: its coordinates reach {size:e}, and the default tolerance follows from their rounding; {error}. \
         Check the unit of the file, or give --tolerance",
        file.display()
    );
    Failure::new(Code::Input, text)
}

/// The vertices of a convex body where it is placed, relative to a point, and triangles of its faces.
pub(crate) fn surface_of(
    body: &ConvexPolyhedron,
    pose: &Pose,
    origin: DVec3,
) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let offset = pose.translation() - origin;
    let placed = body.vertices().iter().map(|&v| pose.matrix() * v + offset).collect();
    let faces = (0..body.face_count() as u32).map(|f| body.face_vertices(f).collect::<Vec<_>>());
    let fan = |face: Vec<u32>| (2..face.len()).map(move |k| [face[0], face[k - 1], face[k]]);
    (placed, faces.flat_map(fan).collect())
}

/// What `info` says of a mesh as a solid: a line for each heading.
pub(crate) fn describe(mesh: &Mesh) -> Vec<(&'static str, String)> {
    if mesh.faces.is_empty() {
        return Vec::new();
    }
    let Loaded { body: solid, notes, .. } = match body::solid(mesh, &BodyOptions::default()) {
        Ok(loaded) => loaded,
        Err(refused) => {
            let mut lines = vec![("solid", format!("no: {refused}{}", hint(&refused)))];
            let open = body::solid(mesh, &BodyOptions::default().with_open(true));
            let surface = open.ok().and_then(|open| open.body.report().surface());
            lines.extend(surface.map(|surface| ("with --open", surface)));
            return lines;
        }
    };
    let mut lines = vec![("solid", format!("yes: {}", shells(solid.report())))];
    lines.extend(notes.iter().filter_map(|note| match note {
        // It has a line of its own.
        Note::Merged(_) => None,
        Note::Crowded(_) => Some(("touches", format!("itself: {note}"))),
        mended => Some(("mended", mended.to_string())),
    }));
    lines
}

/// Shells, cavities and holes through.
fn shells(report: &SolidReport) -> String {
    let cavities = report.shells.iter().filter(|shell| shell.volume < 0.0).count();
    let mut text = counted(report.shells.len() - cavities, "shell", "shells");
    if cavities > 0 {
        let _ = write!(text, ", {}", counted(cavities, "cavity", "cavities"));
    }
    let holes = counted(report.holes_through() as usize, "hole", "holes");
    let _ = write!(text, ", {holes} through");
    let unknown = report.shells.iter().filter(|shell| shell.holes_through.is_none()).count();
    if unknown > 0 {
        let shells = counted(unknown, "shell", "shells");
        let _ = write!(text, " (not counted in {shells} that touch themselves)");
    }
    text
}

/// Renumbers features as the files do; returns the names of the files that they are of.
fn name_features(bodies: [&Body; 2], features: &mut Option<FeaturesRecord>) -> [Option<String>; 2] {
    let Some(FeaturesRecord { moving, fixed }) = features else { return [None, None] };
    [Some(bodies[0].renumber(moving)), Some(bodies[1].renumber(fixed))]
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::shapes::block;

    use super::*;

    /// A cube of side 2 around a cavity of side 1, and beside it a cube of side 1 inside out.
    fn cubes() -> Mesh {
        let cube = |low: f64, high: f64| block([low; 3], [high; 3]);
        let all = cube(0.0, 2.0).joined(&cube(0.5, 1.5).reversed());
        let all = all.joined(&cube(5.0, 6.0).reversed());
        Mesh::new(all.vertices, all.faces)
    }

    #[test]
    fn shells_cavities_and_turned_ones_are_told_apart() {
        let lines = describe(&cubes());
        assert_eq!(lines[0], ("solid", "yes: 2 shells, 1 cavity, 0 holes through".into()));
        assert_eq!(lines[1], ("mended", "1 shell turned, inside out in the file".into()));
        assert_eq!(lines.len(), 2);
        let mut open = cubes();
        open.faces.pop();
        let [("solid", what), ("with --open", surface)] = &describe(&open)[..] else {
            panic!("two lines")
        };
        assert!(what.starts_with("no: ") && what.contains("--open"), "{what}");
        assert!(surface.starts_with("1 sheet, "), "{surface}");
        assert!(surface.ends_with("2 closed shells keep their inside"), "{surface}");
    }
}
