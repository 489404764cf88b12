//! Hints about oddities of the parts as read. They are reported and never applied.
//!
//! - *Identical*: parts of the same shape ([`first_identical_parts`]).
//! - *Frames*: parts seem to be in their own frames instead of at their places in the assembly. Either equal parts
//!   coincide, or all parts surround the origin and most pairs overlap deeply.
//! - *Units*: parts seem to have another unit of length. Either one of two parts of the same shape is 1,000 or 25.4
//!   times as large, or the sizes form two groups at least 250 times apart. If most pairs overlap deeply, a smaller
//!   ratio suffices, and a units hint replaces the frames hint.

use std::cell::Cell;

use colltrans::{Aabb, Solid};
use colltrans_mesh::words::first_named;
use glam::DVec3;

use crate::bodies::Bodies;
use crate::boxes::BoxTree;
use crate::identical::{common_name, first_identical_parts};
use crate::part::{Assembly, Part};
use crate::start::{Overlap, Start};

/// Maximum difference of coinciding boxes, as a share of their size.
const COINCIDENT: f64 = 1e-6;
/// Minimum share of pairs that overlap deeply, for the frames hint.
const MIN_DEEP_SHARE: f64 = 0.5;
/// Minimum number of parts for the frames hint on deep overlaps.
const MIN_PARTS: usize = 3;
/// Maximum distance of a part's centre from the origin, as a share of its size, for the frames hint.
const MAX_CENTER_DISTANCE: f64 = 0.75;
/// Ratios of units: metres to millimetres, and inches to millimetres.
const UNIT_RATIOS: [f64; 2] = [1_000.0, 25.4];
/// Minimum ratio of sizes of parts in different units.
const UNIT_GAP: f64 = 250.0;
/// Minimum ratio of sizes from which a factor of 1,000 brings them closer together: its square root. It
/// applies if most pairs overlap deeply.
const UNIT_GAP_OF_OVERLAPS: f64 = 32.0;
/// Maximum difference of lengths of equal shapes, as a share.
const EQUAL: f64 = 1e-3;
/// Names that a hint lists.
const MAX_NAMED: usize = 4;

/// An oddity of the parts, or a property that may be used.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Hint {
    /// Kind of the hint.
    pub kind: HintKind,
    /// Indices of the parts, in increasing order.
    pub parts: Vec<usize>,
    /// Description, with a suggestion where there is one.
    pub description: String,
}

/// Kind of a hint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum HintKind {
    /// Several parts have the same shape.
    Identical,
    /// Parts are not at their places in the assembly.
    Frames,
    /// Parts are in different units of length.
    Units,
}

impl HintKind {
    /// Returns `identical`, `frames` or `units`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Identical => "identical",
            Self::Frames => "frames",
            Self::Units => "units",
        }
    }
}

/// Returns all hints: identical parts first, the largest group first.
pub fn find_hints(bodies: &Bodies, start: &Start) -> Vec<Hint> {
    let assembly = bodies.assembly();
    let likes = first_identical_parts(assembly);
    let mut all = identical_parts_hints(assembly, &likes);
    let frames = frame_hint(bodies, start, &likes);
    let overlaps = frames.as_ref().is_some_and(|hint| hint.parts.len() == assembly.parts().len());
    let units = unit_hint(assembly, &likes, if overlaps { UNIT_GAP_OF_OVERLAPS } else { UNIT_GAP });
    // Parts that are a thousand times too large overlap like parts in their own frames.
    all.extend(frames.filter(|_| !(overlaps && units.is_some())));
    all.extend(units);
    all
}

/// Returns a hint for each group of identical parts, the largest group first.
fn identical_parts_hints(assembly: &Assembly, likes: &[usize]) -> Vec<Hint> {
    let group = |first: usize| (first..likes.len()).filter(move |&k| likes[k] == first).collect();
    let all = (0..likes.len()).filter(|&k| likes[k] == k).map(group);
    let mut groups: Vec<Vec<usize>> = all.filter(|group: &Vec<usize>| group.len() > 1).collect();
    groups.sort_by_key(|group| std::cmp::Reverse(group.len()));
    let hint = |parts: Vec<usize>| {
        let names = assembly.part_names(&parts);
        let words = match common_name(&names) {
            Some(name) => format!("{} x {name} are identical", parts.len()),
            None => format!("{} are identical", first_named(&names, MAX_NAMED)),
        };
        Hint { kind: HintKind::Identical, parts, description: words }
    };
    groups.into_iter().map(hint).collect()
}

/// Returns the hint that parts are in their own frames; `None` without signs of that.
fn frame_hint(bodies: &Bodies, start: &Start, likes: &[usize]) -> Option<Hint> {
    let assembly = bodies.assembly();
    let parts = assembly.parts();
    let same = |a: &usize, b: &usize| {
        let [p, q] = [a, b].map(|k| parts[*k].bounds());
        let off = (p.low - q.low).abs().max((p.high - q.high).abs()).max_element();
        likes[*a] == likes[*b] && off <= COINCIDENT * p.side_lengths().max_element()
    };
    // The low corners of coinciding parts coincide, so only parts with nearby corners are compared.
    let corner = |k: usize| Aabb::from_points([parts[k].bounds().low]);
    let corners = BoxTree::new((0..parts.len()).map(corner));
    let has_twin = |b: &usize| {
        let reach = 2.0 * COINCIDENT * parts[*b].bounds().side_lengths().max_element();
        let (near, found) = (corner(*b).expanded(reach), Cell::new(false));
        corners.visit(
            |corner| !found.get() && corner.intersects(&near),
            |_, a| found.set(found.get() || a < *b && same(&a, b)),
        );
        found.get()
    };
    let twins: Vec<usize> = (0..parts.len()).filter(|b| has_twin(b)).collect();
    let advice = "add a manifest with their places, or export the assembly as one file";
    if let Some(&twin) = twins.first() {
        let first = (0..twin).find(|a| same(a, &twin)).unwrap_or(twin);
        let mut group = vec![first];
        group.extend(twins.into_iter().filter(|k| same(&first, k)));
        let names = first_named(&assembly.part_names(&group), MAX_NAMED);
        let words = format!(
            "{names} are one body in one place: parts seem to be in frames of their own; {advice}"
        );
        return Some(Hint { kind: HintKind::Frames, parts: group, description: words });
    }
    let is_near = |part: &&Part| {
        let Aabb { low, high } = part.bounds();
        ((low + high) * 0.5).length() <= MAX_CENTER_DISTANCE * (high - low).length()
    };
    let near = parts.iter().filter(is_near).count();
    let deep = |o: &&Overlap| !o.is_shallow(bodies);
    let deep = start.overlaps.iter().filter(deep).count();
    let pairs = parts.len() * (parts.len().max(1) - 1) / 2;
    let odd = parts.len() >= MIN_PARTS
        && near == parts.len()
        && deep as f64 >= MIN_DEEP_SHARE * pairs as f64;
    odd.then(|| Hint {
        kind: HintKind::Frames,
        parts: (0..parts.len()).collect(),
        description: format!(
            "{deep} of {pairs} pairs of parts overlap deeply around the origin: parts seem to be in frames of their \
             own; {advice}"
        ),
    })
}

/// Returns the hint that parts are in another unit; `None` without signs of that. `apart` is the minimum
/// ratio of sizes that indicates two units where no two parts have the same shape.
fn unit_hint(assembly: &Assembly, likes: &[usize], apart: f64) -> Option<Hint> {
    let parts = assembly.parts();
    let hint_of_small = |small: Vec<usize>, factor: f64, why: &str| {
        let names = assembly.part_names(&small);
        let words = format!(
            "{} may be in another unit, {factor} times too small: {why}; --scale {}={factor} corrects it",
            first_named(&names, MAX_NAMED),
            names[0]
        );
        Hint { kind: HintKind::Units, parts: small, description: words }
    };
    // In a source in metres, such as URDF, the larger parts have the wrong unit.
    let is_in_metres = assembly.unit() == Some("m");
    // Two parts of the same shape but different size.
    let shapes: Vec<usize> = (0..parts.len()).filter(|&k| likes[k] == k).collect();
    for (&a, &b) in shapes.iter().flat_map(|a| shapes.iter().map(move |b| (a, b))) {
        let [small, large] = [a, b].map(|k| parts[k].solid());
        let found = UNIT_RATIOS.into_iter().find(|factor| is_scaled(small, large, *factor));
        if let Some(factor) = found {
            let group = |like: usize| (0..parts.len()).filter(|&k| likes[k] == like).collect();
            if is_in_metres && factor == UNIT_RATIOS[0] {
                return Some(millimetre_hint(assembly, group(b)));
            }
            let why = format!("{} has its shape", parts[b].name());
            return Some(hint_of_small(group(a), factor, &why));
        }
    }
    let mut sizes: Vec<(f64, usize)> = (0..parts.len())
        .map(|k| (parts[k].bounds().side_lengths().max_element(), k))
        .filter(|(size, _)| *size > 0.0)
        .collect();
    sizes.sort_by(|x, y| x.0.total_cmp(&y.0));
    let gap = (1..sizes.len()).find(|&k| sizes[k].0 >= apart * sizes[k - 1].0)?;
    let indices = |group: &[(f64, usize)]| {
        let mut indices: Vec<usize> = group.iter().map(|x| x.1).collect();
        indices.sort_unstable();
        indices
    };
    if is_in_metres {
        return Some(millimetre_hint(assembly, indices(&sizes[gap..])));
    }
    Some(hint_of_small(
        indices(&sizes[..gap]),
        UNIT_RATIOS[0],
        "all others are hundreds of times as large",
    ))
}

/// Returns the hint that parts of a source in metres have their coordinates in millimetres.
fn millimetre_hint(assembly: &Assembly, large: Vec<usize>) -> Hint {
    let names = assembly.part_names(&large);
    let scales: Vec<String> =
        names.iter().take(MAX_NAMED).map(|name| format!("--scale {name}=0.001")).collect();
    let words = format!(
        "{} may be in millimetres beside parts in metres, 1000 times too large: {} corrects it",
        first_named(&names, MAX_NAMED),
        scales.join(" ")
    );
    Hint { kind: HintKind::Units, parts: large, description: words }
}

/// Checks whether one solid has the shape of another one scaled by `factor`. Compares the numbers of vertices
/// and triangles, the area and the volume.
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
