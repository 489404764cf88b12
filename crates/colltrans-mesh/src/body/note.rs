//! Notes about a body built from a mesh.

use std::fmt;

use colltrans::solid::SolidReport;

use super::Excess;
use crate::words::{count_text, error_bound, six_digits};
use crate::{Merged, Mesh};

/// A repair of the mesh, or another difference between the body and the file. `Display` writes a text without
/// the name of the file.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// Vertices on open edges were merged.
    Merged(Merged),
    /// Faces with the same corners as another one were removed.
    Duplicates(RemovedFaces),
    /// Fins, which adjoin the surface at a few edges, were removed.
    Fins(RemovedFaces),
    /// Faces inside the surface were removed: walls between bodies, or the second of two ways to close a hole.
    Walls(RemovedFaces),
    /// Number of faces that were oriented against the others of their shell, and were reversed.
    FacesTurned(usize),
    /// Number of shells that were inside out, and were reversed.
    ShellsTurned(usize),
    /// Number of faces without area that were left out.
    WithoutArea(usize),
    /// Number of slits without area that were closed.
    SlitsClosed(usize),
    /// Number of edges at which more than two faces meet.
    Crowded(usize),
    /// Some shells are open.
    Surface {
        /// Number of edges with a face on one side only.
        open_edges: usize,
        /// The first of them: its two vertices and its face.
        first: Option<[usize; 3]>,
        /// A description of the body.
        what: String,
    },
    /// Number of vertices without a face, which are not in the hull.
    Stray(usize),
    /// The hull exceeds the part.
    Exceeds(Excess),
    /// The mesh is convex only to within the tolerance. The value is the depth of its surface below its hull,
    /// which exceeds the precision of the file.
    Dented(f64),
}

/// Faces that were removed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RemovedFaces {
    /// Number of faces.
    pub facets: usize,
    /// The area, in square units.
    pub area: f64,
}

impl RemovedFaces {
    /// Adds a facet.
    pub(super) fn count(&mut self, area: f64) {
        self.facets += 1;
        self.area += area;
    }
}

impl Note {
    /// Checks whether vertices of the file were merged, or faces of the file were removed or reversed. Faces
    /// without area do not count.
    const fn changes_faces(&self) -> bool {
        matches!(
            self,
            Self::Merged(_)
                | Self::Duplicates(_)
                | Self::Fins(_)
                | Self::Walls(_)
                | Self::FacesTurned(_)
        )
    }

    /// Checks whether the surface was repaired: vertices were merged, faces were removed or reversed, or whole
    /// shells were reversed. Faces without area and closed slits do not count.
    pub const fn is_repair(&self) -> bool {
        self.changes_faces() || matches!(self, Self::ShellsTurned(_))
    }

    /// Checks whether the note applies to the file as a whole, independent of how its shells are grouped.
    pub(super) const fn is_of_file(&self) -> bool {
        self.changes_faces() || matches!(self, Self::WithoutArea(_))
    }

    /// Returns the note on the vertices that are not in the hull because no face uses them; `None` if there are
    /// none.
    pub(super) fn stray(mesh: &Mesh) -> Option<Self> {
        let stray = mesh.stray_vertices();
        (stray > 0).then_some(Self::Stray(stray))
    }

    /// Returns the note on merged vertices; `None` if none were merged.
    pub fn merged(mesh: &Mesh) -> Option<Self> {
        (mesh.merged.vertices > 0).then_some(Self::Merged(mesh.merged))
    }
}

/// Returns the notes on how a solid was built from a surface. `first` is the first open edge, if known.
pub fn report_notes(report: &SolidReport, first: Option<[usize; 3]>) -> Vec<Note> {
    let some = |count: usize, note: fn(usize) -> Note| (count > 0).then(|| note(count));
    let mended = [
        some(report.turned(), Note::ShellsTurned),
        some(report.facets_without_area, Note::WithoutArea),
        some(report.slits_closed, Note::SlitsClosed),
        some(report.non_manifold_edges, Note::Crowded),
    ];
    let mut notes: Vec<Note> = mended.into_iter().flatten().collect();
    let open_edges = report.open_edges;
    notes.extend(report.open_shell_summary().map(|what| Note::Surface { open_edges, first, what }));
    notes
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (count, one, many) = match self {
            Self::Merged(merged) => return merged.fmt(f),
            Self::Exceeds(excess) => return excess.fmt(f),
            Self::Dented(depth) => {
                let deep = six_digits(*depth);
                return write!(
                    f,
                    "convex only to within the tolerance: the surface lies up to {deep} below its hull, \
                     which replaces it"
                );
            }
            Self::Surface { open_edges, first, what } => {
                return write_open_surface(f, *open_edges, *first, what);
            }
            Self::Duplicates(left) => {
                return left.write_removed(f, "with the corners of another one");
            }
            Self::Fins(left) => return left.write_removed(f, "that hung on the surface"),
            Self::Walls(left) => return left.write_removed(f, "inside the surface"),
            Self::FacesTurned(n) => {
                (n, "face turned, against the others", "faces turned, against the others")
            }
            Self::ShellsTurned(n) => {
                (n, "shell turned, inside out in the file", "shells turned, inside out in the file")
            }
            Self::WithoutArea(n) => {
                (n, "face without area left out", "faces without area left out")
            }
            Self::Stray(n) => (
                n,
                "vertex that no face uses is not in the hull",
                "vertices that no face uses are not in the hull",
            ),
            Self::SlitsClosed(n) => (n, "slit without area closed", "slits without area closed"),
            Self::Crowded(n) => (
                n,
                "edge is shared by more than two faces",
                "edges are shared by more than two faces",
            ),
        };
        f.write_str(&count_text(*count, one, many))
    }
}

impl RemovedFaces {
    /// Writes the note on these faces.
    fn write_removed(&self, f: &mut fmt::Formatter<'_>, which: &str) -> fmt::Result {
        let faces = count_text(self.facets, "face", "faces");
        write!(f, "{faces} {which} left out (area {})", six_digits(self.area))
    }
}

/// Writes the note on an open surface.
fn write_open_surface(
    f: &mut fmt::Formatter<'_>,
    open_edges: usize,
    first: Option<[usize; 3]>,
    what: &str,
) -> fmt::Result {
    if open_edges == 0 {
        return write!(f, "a surface with rims at edges where more than two faces meet: {what}");
    }
    write!(f, "an open surface ({}", count_text(open_edges, "open edge", "open edges"))?;
    if let Some([from, to, face]) = first {
        write!(f, ", the first from vertex {from} to vertex {to} of face {face}")?;
    }
    write!(f, "): {what}")
}

impl fmt::Display for Merged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let which = count_text(self.vertices, "vertex", "vertices");
        let (far, tolerance) = (error_bound(self.largest_distance), error_bound(self.tolerance));
        write!(f, "{which} on open edges merged with another, at most {far} away")?;
        write!(f, " (tolerance {tolerance})")?;
        if self.dropped_faces > 0 {
            let (one, many) = ("face without area dropped", "faces without area dropped");
            write!(f, "; {}", count_text(self.dropped_faces, one, many))?;
        }
        if self.ambiguous > 0 {
            let which = count_text(self.ambiguous, "vertex", "vertices");
            write!(f, "; {which} had several candidates: the tolerance is large")?;
        }
        Ok(())
    }
}

impl fmt::Display for Excess {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hull = six_digits(self.hull_volume);
        if let Some(part) = self.part_volume {
            let more = (self.hull_volume - part).max(0.0);
            let share = 100.0 * more / self.hull_volume;
            write!(f, "{} of its volume {hull} is not the part ({share:.3} %)", six_digits(more))?;
        } else {
            let turned = "its faces are oriented inwards";
            let why = if self.is_closed { turned } else { "it is not closed" };
            write!(f, "volume {hull}, the part's is unknown ({why})")?;
        }
        match self.depth {
            Some(depth) => {
                write!(f, "; the part's surface lies up to {} below it", six_digits(depth))
            }
            None => Ok(()),
        }
    }
}
