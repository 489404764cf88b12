//! What looks odd about the parts as they were read: said, never applied.
//!
//! - *Identical* parts are those of one shape ([`likes`]).
//! - *Frames*: parts that are one body in one place, or of which most pairs overlap deeply around the origin, stand in
//!   frames of their own rather than where they belong.
//! - *Units*: of two parts of one shape one is 1,000 or 25.4 times as large; or sizes fall in two groups so far apart that
//!   one is in millimetres and the other in metres. Where most pairs overlap deeply, a smaller ratio counts, and
//!   the hint about frames is left out.

use std::cell::Cell;

use colltrans::{Aabb, Solid};
use colltrans_mesh::words::first_named;
use glam::DVec3;

use crate::bodies::Bodies;
use crate::boxes::BoxTree;
use crate::likes::{common_name, likes};
use crate::part::{Assembly, Part};
use crate::start::{Overlap, Start};

/// Boxes that differ by less than this share of their size are one.
const SAME: f64 = 1e-6;
/// So large a share of all pairs overlaps deeply where parts stand in frames of their own, ...
const MOST: f64 = 0.5;
/// ... of so many parts at least, whose middles are within this share of their size from the origin.
const FEWEST: usize = 3;
const NEAR: f64 = 0.75;
/// Factors between units: of millimetres and metres, and of millimetres and inches.
const FACTORS: [f64; 2] = [1_000.0, 25.4];
/// Sizes that are so many times apart are of different units.
const APART: f64 = 250.0;
/// Ratio of sizes from which on a factor of 1,000 brings them nearer to each other: its square root. It counts where
/// most pairs of parts overlap deeply.
const NEARER: f64 = 32.0;
/// Lengths of equal shapes differ by less than this share.
const EQUAL: f64 = 1e-3;
/// Names that a hint lists.
const MAX_NAMED: usize = 4;

/// What looks odd, or may be used.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Hint {
    /// Of what it is.
    pub kind: HintKind,
    /// Positions of the parts, in increasing order.
    pub parts: Vec<usize>,
    /// In words, with what may be done.
    pub words: String,
}

/// Of what a hint is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum HintKind {
    /// One shape in several places.
    Identical,
    /// Parts that do not stand where they belong.
    Frames,
    /// Parts in different units.
    Units,
}

impl HintKind {
    /// `identical`, `frames` or `units`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Identical => "identical",
            Self::Frames => "frames",
            Self::Units => "units",
        }
    }
}

/// All of them: identical parts first, largest groups first.
pub fn hints(bodies: &Bodies, start: &Start) -> Vec<Hint> {
    let assembly = bodies.assembly();
    let likes = likes(assembly);
    let mut all = identical(assembly, &likes);
    let frames = frames(bodies, start, &likes);
    let overlaps = frames.as_ref().is_some_and(|hint| hint.parts.len() == assembly.parts().len());
    let units = units(assembly, &likes, if overlaps { NEARER } else { APART });
    // Parts a thousand times too large overlap as parts in frames of their own do.
    all.extend(frames.filter(|_| !(overlaps && units.is_some())));
    all.extend(units);
    all
}

fn identical(assembly: &Assembly, likes: &[usize]) -> Vec<Hint> {
    let group = |first: usize| (first..likes.len()).filter(move |&k| likes[k] == first).collect();
    let all = (0..likes.len()).filter(|&k| likes[k] == k).map(group);
    let mut groups: Vec<Vec<usize>> = all.filter(|group: &Vec<usize>| group.len() > 1).collect();
    groups.sort_by_key(|group| std::cmp::Reverse(group.len()));
    let told = |parts: Vec<usize>| {
        let names = assembly.names(&parts);
        let words = match common_name(&names) {
            Some(name) => format!("{} x {name} are identical", parts.len()),
            None => format!("{} are identical", first_named(&names, MAX_NAMED)),
        };
        Hint { kind: HintKind::Identical, parts, words }
    };
    groups.into_iter().map(told).collect()
}

fn frames(bodies: &Bodies, start: &Start, likes: &[usize]) -> Option<Hint> {
    let assembly = bodies.assembly();
    let parts = assembly.parts();
    let same = |a: &usize, b: &usize| {
        let [p, q] = [a, b].map(|k| parts[*k].bounds());
        let off = (p.low - q.low).abs().max((p.high - q.high).abs()).max_element();
        likes[*a] == likes[*b] && off <= SAME * p.size().max_element()
    };
    // Twins have their low corners in one place, so only parts with a corner near there are compared.
    let corner = |k: usize| Aabb::of_points([parts[k].bounds().low]);
    let corners = BoxTree::new((0..parts.len()).map(corner));
    let twice = |b: &usize| {
        let reach = 2.0 * SAME * parts[*b].bounds().size().max_element();
        let (near, found) = (corner(*b).grown(reach), Cell::new(false));
        corners.visit(
            |corner| !found.get() && corner.meets(&near),
            |_, a| found.set(found.get() || a < *b && same(&a, b)),
        );
        found.get()
    };
    let twins: Vec<usize> = (0..parts.len()).filter(|b| twice(b)).collect();
    let advice = "give a manifest with their places, or export the assembly as one file";
    if let Some(&twin) = twins.first() {
        let first = (0..twin).find(|a| same(a, &twin)).unwrap_or(twin);
        let mut group = vec![first];
        group.extend(twins.into_iter().filter(|k| same(&first, k)));
        let names = first_named(&assembly.names(&group), MAX_NAMED);
        let words = format!(
            "{names} are one body in one place: parts seem to stand in frames of their own; {advice}"
        );
        return Some(Hint { kind: HintKind::Frames, parts: group, words });
    }
    let is_near = |part: &&Part| {
        let Aabb { low, high } = part.bounds();
        ((low + high) * 0.5).length() <= NEAR * (high - low).length()
    };
    let near = parts.iter().filter(is_near).count();
    let deep = |o: &&Overlap| !o.is_shallow(bodies);
    let deep = start.overlaps.iter().filter(deep).count();
    let pairs = parts.len() * (parts.len().max(1) - 1) / 2;
    let odd = parts.len() >= FEWEST && near == parts.len() && deep as f64 >= MOST * pairs as f64;
    odd.then(|| Hint {
        kind: HintKind::Frames,
        parts: (0..parts.len()).collect(),
        words: format!(
            "{deep} of {pairs} pairs of parts overlap deeply around the origin: parts seem to stand in frames of their \
             own; {advice}"
        ),
    })
}

/// Finds parts in another unit; `apart` is the ratio of sizes that shows two units where no two parts have one shape.
fn units(assembly: &Assembly, likes: &[usize], apart: f64) -> Option<Hint> {
    let parts = assembly.parts();
    let said = |small: Vec<usize>, factor: f64, why: &str| {
        let names = assembly.names(&small);
        let words = format!(
            "{} may be in another unit, {factor} times too small: {why}; --scale {}={factor} corrects it",
            first_named(&names, MAX_NAMED),
            names[0]
        );
        Hint { kind: HintKind::Units, parts: small, words }
    };
    // In a source in metres, as URDF is, the larger parts have the wrong unit.
    let is_in_metres = assembly.unit() == Some("m");
    // The same shape in two sizes.
    let shapes: Vec<usize> = (0..parts.len()).filter(|&k| likes[k] == k).collect();
    for (&a, &b) in shapes.iter().flat_map(|a| shapes.iter().map(move |b| (a, b))) {
        let [small, large] = [a, b].map(|k| parts[k].solid());
        let found = FACTORS.into_iter().find(|factor| is_scaled(small, large, *factor));
        if let Some(factor) = found {
            let group = |like: usize| (0..parts.len()).filter(|&k| likes[k] == like).collect();
            if is_in_metres && factor == FACTORS[0] {
                return Some(in_millimetres(assembly, group(b)));
            }
            let why = format!("{} has its shape", parts[b].name());
            return Some(said(group(a), factor, &why));
        }
    }
    let mut sizes: Vec<(f64, usize)> = (0..parts.len())
        .map(|k| (parts[k].bounds().size().max_element(), k))
        .filter(|(size, _)| *size > 0.0)
        .collect();
    sizes.sort_by(|x, y| x.0.total_cmp(&y.0));
    let gap = (1..sizes.len()).find(|&k| sizes[k].0 >= apart * sizes[k - 1].0)?;
    let numbers = |group: &[(f64, usize)]| {
        let mut numbers: Vec<usize> = group.iter().map(|x| x.1).collect();
        numbers.sort_unstable();
        numbers
    };
    if is_in_metres {
        return Some(in_millimetres(assembly, numbers(&sizes[gap..])));
    }
    Some(said(numbers(&sizes[..gap]), FACTORS[0], "all others are hundreds of times as large"))
}

/// Returns the hint that these parts of a source in metres have the numbers of millimetres.
fn in_millimetres(assembly: &Assembly, large: Vec<usize>) -> Hint {
    let names = assembly.names(&large);
    let scales: Vec<String> =
        names.iter().take(MAX_NAMED).map(|name| format!("--scale {name}=0.001")).collect();
    let words = format!(
        "{} may be in millimetres beside parts in metres, 1000 times too large: {} corrects it",
        first_named(&names, MAX_NAMED),
        scales.join(" ")
    );
    Hint { kind: HintKind::Units, parts: large, words }
}

/// Whether one solid has the shape of another one, so many times as large.
fn is_scaled(small: &Solid, large: &Solid, factor: f64) -> bool {
    let counts = |solid: &Solid| [solid.vertices().len(), solid.triangles().len()];
    let sizes = |solid: &Solid| {
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| solid.vertices()[v as usize]);
            (b - a).cross(c - a).length() / 2.0
        };
        let area: f64 = solid.triangles().iter().map(area).sum();
        DVec3::new(area.sqrt(), solid.volume().abs().cbrt(), 0.0)
    };
    counts(small) == counts(large) && {
        let (a, b) = (sizes(small) * factor, sizes(large));
        (a - b).abs().max_element() <= EQUAL * b.max_element()
    }
}
