//! Report of the construction of a solid: shells and repairs.

/// The kind of a shell. It determines whether the shell has an interior and an offset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ShellKind {
    /// Every edge has a facet on both sides. The shell has an interior.
    Closed,
    /// Open, but almost closed: the generalised winding number, sampled on the facets, is between 0.9 and 1.1 just
    /// inside at 99 % of the samples or more. The shell blocks from both sides and with its boundary edges. It has an
    /// offset.
    Sided,
    /// Any other open shell. It blocks from both sides and with its boundary edges. It has no offset, because it has
    /// no inner side.
    Sheet,
}

impl ShellKind {
    /// All kinds of shells.
    pub const ALL: [Self; 3] = [Self::Closed, Self::Sided, Self::Sheet];

    /// Returns `closed`, `sided` or `sheet`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Closed => "closed",
            Self::Sided => "sided",
            Self::Sheet => "sheet",
        }
    }
}

/// A connected part of a surface. Its facets are joined across edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shell {
    /// Number of triangles.
    pub triangles: usize,
    /// Enclosed volume, in cubic units. It is negative for the wall of a cavity, and has no meaning for an open
    /// shell.
    pub volume: f64,
    /// Number of through holes (the genus). It is `None` for an open shell, for a shell that shares a vertex with
    /// another one, and for an odd Euler characteristic, which occurs if the shell touches itself in vertices.
    pub holes_through: Option<u32>,
    /// Whether the shell was inside out and has been reversed.
    pub reversed: bool,
    /// The kind of the shell.
    pub kind: ShellKind,
}

/// Shells and repairs of a solid, recorded during its construction.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SolidReport {
    /// The connected parts of the surface.
    pub shells: Vec<Shell>,
    /// Number of vertices with the coordinates of an earlier vertex.
    pub vertices_merged: usize,
    /// Number of removed facets, whose area is exactly 0.
    pub facets_without_area: usize,
    /// Number of edges that are subdivided because vertices of the opposite side lie exactly on them.
    pub slits_closed: usize,
    /// Number of edges with more than two facets, as many in each direction.
    pub non_manifold_edges: usize,
    /// Number of edges with a facet on one side only; 0 for a closed solid.
    pub open_edges: usize,
}

impl SolidReport {
    /// Returns the number of shells that have been reversed.
    pub fn turned(&self) -> usize {
        self.shells.iter().filter(|s| s.reversed).count()
    }

    /// Returns the number of shells of a kind.
    pub fn shell_count(&self, kind: ShellKind) -> usize {
        self.shells.iter().filter(|s| s.kind == kind).count()
    }

    /// Describes the open shells of the body in words; `None` if all shells are closed.
    pub fn open_shell_summary(&self) -> Option<String> {
        let [closed, sided, sheets] = ShellKind::ALL.map(|kind| self.shell_count(kind));
        let of = |count: usize, one: &str, many: &str| match count {
            0 => None,
            1 => Some(format!("1 {one}")),
            _ => Some(format!("{count} {many}")),
        };
        let open = [
            of(sheets, "sheet", "sheets"),
            of(sided, "shell that is all but closed", "shells that are all but closed"),
        ];
        let open: Vec<String> = open.into_iter().flatten().collect();
        let inside = match closed {
            0 => "without an inside".to_owned(),
            1 => "1 closed shell keeps its inside".to_owned(),
            _ => format!("{closed} closed shells keep their inside"),
        };
        (!open.is_empty()).then(|| {
            format!("{}, blocking from both sides, rims included; {inside}", open.join(" and "))
        })
    }

    /// Returns the number of through holes of all shells for which it is known.
    pub fn holes_through(&self) -> u32 {
        self.shells.iter().filter_map(|s| s.holes_through).sum()
    }

    pub(super) fn add_counts(&mut self, other: &Self) {
        self.shells.extend_from_slice(&other.shells);
        self.vertices_merged += other.vertices_merged;
        self.facets_without_area += other.facets_without_area;
        self.slits_closed += other.slits_closed;
        self.non_manifold_edges += other.non_manifold_edges;
        self.open_edges += other.open_edges;
    }
}
