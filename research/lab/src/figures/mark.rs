//! The mark of `phi`: all cells in which the same features decide.

use colltrans::observe::Touch;
use glam::DVec2;

use super::planar::{Face, Features, View};

/// Levels of either body that are looked at.
const LOOKS: usize = 120;

/// A cell where sections meet.
#[derive(Debug, Clone)]
pub(super) struct Cell {
    pub(super) faces: [Face; 2],
    pub(super) touch: Touch,
    pub(super) corners: Vec<DVec2>,
}

/// Cells, and what bounds those where sections miss each other.
#[derive(Debug)]
pub(super) struct Mark {
    pub(super) cells: Vec<Cell>,
    /// Between neighbouring cells outside of the domain: short lines.
    pub(super) lines: Vec<[DVec2; 2]>,
    /// A point well inside of each cell outside of the domain.
    pub(super) outside: Vec<DVec2>,
}

impl Mark {
    /// From many looks. Cells with contact are whole, however few of them fell into one.
    pub(super) fn new(view: &View, [low, high]: [DVec2; 2]) -> Self {
        let place = |i: usize, j: usize| {
            let share = |k: usize| (k as f64 + 0.5) / LOOKS as f64;
            low + (high - low) * DVec2::new(share(i), share(j))
        };
        let seen = |at: DVec2| view.instance(at).map(|found| (found.features, found.touch));
        let mut looks = Vec::with_capacity(LOOKS * LOOKS);
        for i in 0..LOOKS {
            for j in 0..LOOKS {
                looks.push(seen(place(i, j)));
            }
        }
        let look = |i: usize, j: usize| looks[i * LOOKS + j];
        let mut cells: Vec<Cell> = Vec::new();
        let mut groups: Vec<(Features, Vec<(usize, usize)>)> = Vec::new();
        for i in 0..LOOKS {
            for j in 0..LOOKS {
                let Some((features, touch)) = look(i, j) else { continue };
                if let Features::Touching(faces) = features {
                    if cells.iter().all(|cell| cell.faces != faces) {
                        let corners = view.cell(faces, [low, high]);
                        cells.push(Cell { faces, touch, corners });
                    }
                    continue;
                }
                match groups.iter_mut().find(|(of, _)| *of == features) {
                    Some((_, all)) => all.push((i, j)),
                    None => groups.push((features, vec![(i, j)])),
                }
            }
        }
        let outside =
            groups.iter().filter_map(|(_, all)| deepest(all)).map(|(i, j)| place(i, j)).collect();
        let mut lines = Vec::new();
        for i in 0..LOOKS - 1 {
            for j in 0..LOOKS - 1 {
                let square = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
                let corners = square.map(|(i, j)| (place(i, j), look(i, j)));
                lines.extend(borders(&corners, &seen));
            }
        }
        Self { cells, lines, outside }
    }
}

/// The one of some looks that is farthest from where they end; none of very few.
fn deepest(all: &[(usize, usize)]) -> Option<(usize, usize)> {
    let depth = |&(i, j): &(usize, usize)| {
        (1..LOOKS).find(|&far| {
            let ends =
                [(i.wrapping_sub(far), j), (i + far, j), (i, j.wrapping_sub(far)), (i, j + far)];
            ends.iter().any(|end| !all.contains(end))
        })
    };
    all.iter().max_by_key(|at| depth(at)).filter(|at| depth(at) >= Some(4)).copied()
}

type Look = Option<(Features, Touch)>;

/// The border between different cells within a small square, where sections miss each other.
fn borders(corners: &[(DVec2, Look); 4], seen: &impl Fn(DVec2) -> Look) -> Vec<[DVec2; 2]> {
    let meets = |look: &Look| look.is_none_or(|(_, touch)| touch.meets());
    if corners.iter().any(|(_, look)| meets(look)) {
        return Vec::new();
    }
    let mut crossings = Vec::new();
    for (k, (from, here)) in corners.iter().enumerate() {
        let (to, there) = &corners[(k + 1) % 4];
        if here == there {
            continue;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..12 {
            let middle = 0.5 * (low + high);
            if seen(from.lerp(*to, middle)) == *here { low = middle } else { high = middle }
        }
        crossings.push(from.lerp(*to, low));
    }
    match crossings[..] {
        [a, b] => vec![[a, b]],
        [] | [_] => Vec::new(),
        _ => {
            let middle = super::setting::middle(&crossings);
            crossings.iter().map(|&at| [at, middle]).collect()
        }
    }
}
