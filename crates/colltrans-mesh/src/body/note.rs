//! What is to be said about a body made of a mesh.

use std::fmt;

use colltrans::solid::SolidReport;

use super::Excess;
use crate::words::{about, counted, six_digits};
use crate::{Merged, Mesh};

/// What was mended when a body was made of a mesh, or is not as it is in the file. `Display` says it in
/// words, without the file's name.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// Vertices on open edges were merged.
    Merged(Merged),
    /// Faces with the corners of another one were left out.
    Doubles(Left),
    /// Faces that hung on the surface by a few edges were left out.
    Fins(Left),
    /// Faces inside the surface were left out: walls between bodies, or the second of two ways to close it.
    Walls(Left),
    /// So many faces ran against the others of their shell, and were turned.
    FacesTurned(usize),
    /// So many shells were inside out, and were turned.
    ShellsTurned(usize),
    /// So many faces without an area were left out.
    WithoutArea(usize),
    /// So many slits without an area were closed.
    SlitsClosed(usize),
    /// At so many edges more than two faces meet.
    Crowded(usize),
    /// Some shells are open.
    Surface {
        /// Edges with a face on one side only.
        open_edges: usize,
        /// The first of them: its vertices and its face.
        first: Option<[usize; 3]>,
        /// What the body is taken for, in words.
        what: String,
    },
    /// This many vertices are in no face, and not in the hull.
    Stray(usize),
    /// The hull has what its part has not.
    Exceeds(Excess),
    /// The mesh is convex only to within the tolerance: its surface lies up to this depth below its hull, which
    /// is more than the precision of the file explains.
    Dented(f64),
}

/// Faces that were left out.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Left {
    /// How many.
    pub facets: usize,
    /// Their area, in square units.
    pub area: f64,
}

impl Left {
    pub(super) fn count(&mut self, area: f64) {
        self.facets += 1;
        self.area += area;
    }
}

impl Note {
    /// Whether faces of the file were merged, left out or turned.
    const fn changes_faces(&self) -> bool {
        matches!(
            self,
            Self::Merged(_)
                | Self::Doubles(_)
                | Self::Fins(_)
                | Self::Walls(_)
                | Self::FacesTurned(_)
        )
    }

    /// Whether the surface is another one than that of the file: what was merged, left out or turned.
    pub const fn is_mended(&self) -> bool {
        self.changes_faces() || matches!(self, Self::ShellsTurned(_))
    }

    /// Whether it is of the file as a whole, no matter which of its shells are taken together.
    pub(super) const fn is_of_file(&self) -> bool {
        self.changes_faces() || matches!(self, Self::WithoutArea(_))
    }

    /// Returns the note about the vertices that a mesh's hull leaves out, if there are any.
    pub(super) fn stray(mesh: &Mesh) -> Option<Self> {
        let stray = mesh.stray_vertices();
        (stray > 0).then_some(Self::Stray(stray))
    }

    /// What was merged when a mesh was read, if anything was.
    pub fn merged(mesh: &Mesh) -> Option<Self> {
        (mesh.merged.vertices > 0).then_some(Self::Merged(mesh.merged))
    }
}

/// What was done to make a solid of a surface; `first` is the first open edge, where it is known.
pub fn report_notes(report: &SolidReport, first: Option<[usize; 3]>) -> Vec<Note> {
    let some = |count: usize, note: fn(usize) -> Note| (count > 0).then(|| note(count));
    let mended = [
        some(report.turned(), Note::ShellsTurned),
        some(report.facets_without_area, Note::WithoutArea),
        some(report.slits_closed, Note::SlitsClosed),
        some(report.crowded_edges, Note::Crowded),
    ];
    let mut notes: Vec<Note> = mended.into_iter().flatten().collect();
    let open_edges = report.open_edges;
    notes.extend(report.surface().map(|what| Note::Surface { open_edges, first, what }));
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
                     which stands for it"
                );
            }
            Self::Surface { open_edges, first, what } => {
                return surface(f, *open_edges, *first, what);
            }
            Self::Doubles(left) => return left.told(f, "with the corners of another one"),
            Self::Fins(left) => return left.told(f, "that hung on the surface"),
            Self::Walls(left) => return left.told(f, "inside the surface"),
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
        f.write_str(&counted(*count, one, many))
    }
}

impl Left {
    fn told(&self, f: &mut fmt::Formatter<'_>, which: &str) -> fmt::Result {
        let faces = counted(self.facets, "face", "faces");
        write!(f, "{faces} {which} left out (area {})", six_digits(self.area))
    }
}

fn surface(
    f: &mut fmt::Formatter<'_>,
    open_edges: usize,
    first: Option<[usize; 3]>,
    what: &str,
) -> fmt::Result {
    if open_edges == 0 {
        return write!(f, "a surface with rims at edges where more than two faces meet: {what}");
    }
    write!(f, "an open surface ({}", counted(open_edges, "open edge", "open edges"))?;
    if let Some([from, to, face]) = first {
        write!(f, ", the first from vertex {from} to vertex {to} of face {face}")?;
    }
    write!(f, "): {what}")
}

impl fmt::Display for Merged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let which = counted(self.vertices, "vertex", "vertices");
        let (far, tolerance) = (about(self.largest_distance), about(self.tolerance));
        write!(f, "{which} on open edges merged with another, at most {far} away")?;
        write!(f, " (tolerance {tolerance})")?;
        if self.dropped_faces > 0 {
            let (one, many) = ("face without area dropped", "faces without area dropped");
            write!(f, "; {}", counted(self.dropped_faces, one, many))?;
        }
        if self.ambiguous > 0 {
            let which = counted(self.ambiguous, "vertex", "vertices");
            write!(f, "; {which} had more than one to choose from: the tolerance is large")?;
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
