//! Parts that need not be convex: the library's solids, as the commands use them.
//!
//! A body is made of one file or of several; each is a *piece* and keeps its name, so that an
//! answer can say which files are involved. This is the only module that knows the library's
//! solids: [`load`](Body::load) makes them of files, [`ask`] asks them.
//!
//! Precision of a file, a length: how far apart its vertices may be written that were meant to be
//! one, which is what the reader merges by default: `2^-22` of the largest coordinate in single
//! precision, else `2^-48` of it.

mod ask;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use colltrans::glam::DVec3;
use colltrans::{ConvexPolyhedron, Pose, Solid, SolidError, SolidReport};
use colltrans_mesh::{Mesh, ReadOptions};

use crate::body::merged;
use crate::numbers::counted;
pub(crate) use ask::{Answer, Kind, Overlap, Question, Stop, Touch};

/// How mesh files become a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Recipe {
    /// Lengths are multiplied by this, after the merging.
    pub(crate) scale: f64,
    pub(crate) merge_tolerance: Option<f64>,
    /// Whether surfaces may be open.
    pub(crate) open: bool,
}

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
}

impl Body {
    /// Reads files as one body; `done` is called after each. The message of an error names the file
    /// and says what would help.
    pub(crate) fn load(
        files: &[PathBuf],
        recipe: Recipe,
        mut done: impl FnMut(),
    ) -> Result<Self, String> {
        let mut pieces = Vec::with_capacity(files.len());
        let mut notes = Vec::new();
        for file in files {
            let (mut mesh, precision) = read(file, recipe.merge_tolerance)?;
            let told = |what: String| format!("{}: {what}", file.display());
            notes.extend(merged(&mesh).map(told));
            mesh.vertices.iter_mut().for_each(|v| *v *= recipe.scale);
            let solid = build(&mesh, recipe.open).map_err(|error| told(refusal(&error)))?;
            notes.extend(mended(solid.report()).map(told));
            notes.extend(gaps(solid.report()).map(told));
            pieces.push(Piece { file: file.clone(), solid, precision: precision * recipe.scale });
            done();
        }
        Self::of_pieces(pieces, notes)
    }

    /// A convex body, in double precision.
    pub(crate) fn of_convex(body: &ConvexPolyhedron) -> Result<Self, String> {
        let solid = Solid::from_convex(body).map_err(|error| match error {
            SolidError::Empty => "without an area, which bodies asked against solids need".into(),
            other => refusal(&other),
        })?;
        let piece = Piece { file: PathBuf::new(), solid, precision: 0.0 };
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

    fn solid(&self) -> &Solid {
        self.union.as_ref().unwrap_or_else(|| &self.pieces[0].solid)
    }

    /// Whether some shell of it is open.
    fn is_surface(&self) -> bool {
        !self.solid().is_closed()
    }

    /// The coarsest of its files.
    fn precision(&self) -> f64 {
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

/// A mesh, and the precision of its file.
fn read(file: &Path, merge_tolerance: Option<f64>) -> Result<(Mesh, f64), String> {
    let with = |tolerance| {
        let options = ReadOptions::default().with_merge_tolerance(tolerance);
        colltrans_mesh::read_with(file, options).map_err(|error| error.to_string())
    };
    let mesh = with(None)?;
    let precision = mesh.merged.tolerance;
    match merge_tolerance {
        None => Ok((mesh, precision)),
        asked => Ok((with(asked)?, precision)),
    }
}

fn build(mesh: &Mesh, open: bool) -> Result<Solid, SolidError> {
    match Solid::from_mesh(&mesh.vertices, &mesh.faces) {
        Err(SolidError::Open { .. }) if open => Solid::from_open_mesh(&mesh.vertices, &mesh.faces),
        built => built,
    }
}

/// Why a mesh is no solid, and what would help.
fn refusal(error: &SolidError) -> String {
    match error {
        SolidError::Open { count, from, to, facet } => format!(
            "the surface is not closed: {} have a face on one side only, the first runs from \
             vertex {from} to vertex {to} of face {facet}; --merge-tolerance closes gaps, `clear \
             --open` takes it as a surface without an inside",
            counted(*count, "edge", "edges")
        ),
        SolidError::Empty => "holds no faces with an area".into(),
        other => other.to_string(),
    }
}

/// What was mended when a solid was built, if anything was.
fn mended(report: &SolidReport) -> Option<String> {
    let mut text = Vec::new();
    let mut tell = |count: usize, one: &str, many: &str, what: &str| {
        if count > 0 {
            text.push(format!("{} {what}", counted(count, one, many)));
        }
    };
    tell(report.turned(), "shell", "shells", "turned, inside out in the file");
    tell(report.facets_without_area, "face", "faces", "without area left out");
    tell(report.slits_closed, "slit", "slits", "without area closed");
    (!text.is_empty()).then(|| text.join("; "))
}

/// What an open surface is taken for.
fn gaps(report: &SolidReport) -> Option<String> {
    let edges = counted(report.open_edges, "open edge", "open edges");
    report.surface().map(|surface| format!("an open surface ({edges}): {surface}"))
}

/// What `info` says of a mesh as a solid: a line for each heading.
pub(crate) fn describe(mesh: &Mesh) -> Vec<(&'static str, String)> {
    if mesh.faces.is_empty() {
        return Vec::new();
    }
    let solid = match Solid::from_mesh(&mesh.vertices, &mesh.faces) {
        Ok(solid) => solid,
        Err(error) => {
            let mut lines = vec![("solid", format!("no: {}", refusal(&error)))];
            let open = Solid::from_open_mesh(&mesh.vertices, &mesh.faces);
            let surface = open.ok().and_then(|open| open.report().surface());
            lines.extend(surface.map(|surface| ("with --open", surface)));
            return lines;
        }
    };
    let report = solid.report();
    let mut lines = vec![("solid", format!("yes: {}", shells(report)))];
    lines.extend(mended(report).map(|what| ("mended", what)));
    if report.crowded_edges > 0 {
        let edges = counted(report.crowded_edges, "edge is", "edges are");
        lines.push(("touches", format!("itself: {edges} shared by more than two faces")));
    }
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
