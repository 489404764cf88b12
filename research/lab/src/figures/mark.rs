//! The mark of `phi`: all cells in which the same features determine the contact.

use colltrans::observe::SectionContact;
use glam::DVec2;

use super::planar::{Face, Features, View};

/// Number of samples along each axis of levels.
const SAMPLES: usize = 120;

/// A cell in which the sections meet.
#[derive(Debug, Clone)]
pub(super) struct Cell {
    pub(super) faces: [Face; 2],
    pub(super) touch: SectionContact,
    pub(super) corners: Vec<DVec2>,
}

/// Cells, and the boundaries of those in which the sections do not meet.
#[derive(Debug)]
pub(super) struct Mark {
    pub(super) cells: Vec<Cell>,
    /// Boundaries between neighbouring cells outside of the domain, as short lines.
    pub(super) lines: Vec<[DVec2; 2]>,
    /// A point well inside each cell outside of the domain.
    pub(super) outside: Vec<DVec2>,
}

impl Mark {
    /// Finds the cells by samples. Cells with contact are complete, even if they contain few samples.
    pub(super) fn new(view: &View, [low, high]: [DVec2; 2]) -> Self {
        let place = |i: usize, j: usize| {
            let share = |k: usize| (k as f64 + 0.5) / SAMPLES as f64;
            low + (high - low) * DVec2::new(share(i), share(j))
        };
        let seen = |at: DVec2| view.instance(at).map(|found| (found.features, found.touch));
        let mut looks = Vec::with_capacity(SAMPLES * SAMPLES);
        for i in 0..SAMPLES {
            for j in 0..SAMPLES {
                looks.push(seen(place(i, j)));
            }
        }
        let look = |i: usize, j: usize| looks[i * SAMPLES + j];
        let mut cells: Vec<Cell> = Vec::new();
        let mut groups: Vec<(Features, Vec<(usize, usize)>)> = Vec::new();
        for i in 0..SAMPLES {
            for j in 0..SAMPLES {
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
        let outside = groups
            .iter()
            .filter_map(|(_, all)| deepest_sample(all))
            .map(|(i, j)| place(i, j))
            .collect();
        let mut lines = Vec::new();
        for i in 0..SAMPLES - 1 {
            for j in 0..SAMPLES - 1 {
                let square = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
                let corners = square.map(|(i, j)| (place(i, j), look(i, j)));
                lines.extend(cell_borders(&corners, &seen));
            }
        }
        Self { cells, lines, outside }
    }
}

/// Returns the sample that is farthest from the boundary of some samples; `None` for very few samples.
fn deepest_sample(all: &[(usize, usize)]) -> Option<(usize, usize)> {
    let depth = |&(i, j): &(usize, usize)| {
        (1..SAMPLES).find(|&far| {
            let ends =
                [(i.wrapping_sub(far), j), (i + far, j), (i, j.wrapping_sub(far)), (i, j + far)];
            ends.iter().any(|end| !all.contains(end))
        })
    };
    all.iter().max_by_key(|at| depth(at)).filter(|at| depth(at) >= Some(4)).copied()
}

/// Sample of a pair of levels.
type Sample = Option<(Features, SectionContact)>;

/// Returns the boundary between different cells within a small square in which the sections do not meet.
fn cell_borders(
    corners: &[(DVec2, Sample); 4],
    seen: &impl Fn(DVec2) -> Sample,
) -> Vec<[DVec2; 2]> {
    let meets = |look: &Sample| look.is_none_or(|(_, touch)| touch.intersects());
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
