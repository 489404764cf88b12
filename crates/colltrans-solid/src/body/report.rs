//! What was noticed when a mesh was read.

/// What a shell is to others: an inside, a side, or neither.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ShellKind {
    /// Every edge has a facet on either side: it has an inside.
    Closed,
    /// Open, but all but closed: just inside of 99 % of its area the generalised winding number is above
    /// 0.9. It blocks from both sides, and with its rim, and is shrunk and grown as closed ones are.
    Sided,
    /// Open, and without an inside to speak of. It blocks from both sides, and with its rim, and is
    /// neither shrunk nor grown: there is no side to go to.
    Sheet,
}

impl ShellKind {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Closed, Self::Sided, Self::Sheet];

    /// `closed`, `sided` or `sheet`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Closed => "closed",
            Self::Sided => "sided",
            Self::Sheet => "sheet",
        }
    }
}

/// A connected part of a surface: facets that are joined across edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shell {
    /// Number of triangles.
    pub triangles: usize,
    /// The volume it encloses, in cubic units; negative for the wall of a cavity, meaningless for
    /// an open shell.
    pub volume: f64,
    /// Holes through it (its genus); `None` for an open shell, or one that touches itself in
    /// vertices.
    pub holes_through: Option<u32>,
    /// Whether it was inside out, and turned.
    pub turned: bool,
    /// Whether it has an inside, or a side to which it could be shrunk.
    pub kind: ShellKind,
}

/// What was noticed, and mended, when a solid was built.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SolidReport {
    /// The connected parts.
    pub shells: Vec<Shell>,
    /// Vertices that had the same coordinates as another one.
    pub vertices_merged: usize,
    /// Facets left out because they have no area, exactly.
    pub facets_without_area: usize,
    /// Edges subdivided because vertices of their other side lie on them, exactly.
    pub slits_closed: usize,
    /// Edges at which more than two facets meet.
    pub crowded_edges: usize,
    /// Edges with a facet on one side only; none for a closed solid.
    pub open_edges: usize,
}

impl SolidReport {
    /// How many shells were inside out.
    pub fn turned(&self) -> usize {
        self.shells.iter().filter(|s| s.turned).count()
    }

    /// How many shells are of a kind.
    pub fn count(&self, kind: ShellKind) -> usize {
        self.shells.iter().filter(|s| s.kind == kind).count()
    }

    /// What a body with open shells is taken for, in words; `None` if all are closed.
    pub fn surface(&self) -> Option<String> {
        let [closed, sided, sheets] = ShellKind::ALL.map(|kind| self.count(kind));
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

    /// Holes through all shells together, where they are known.
    pub fn holes_through(&self) -> u32 {
        self.shells.iter().filter_map(|s| s.holes_through).sum()
    }

    pub(super) fn absorb(&mut self, other: &Self) {
        self.shells.extend_from_slice(&other.shells);
        self.vertices_merged += other.vertices_merged;
        self.facets_without_area += other.facets_without_area;
        self.slits_closed += other.slits_closed;
        self.crowded_edges += other.crowded_edges;
        self.open_edges += other.open_edges;
    }
}
