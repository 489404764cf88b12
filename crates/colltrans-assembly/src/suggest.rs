//! Suggested [roles](crate::roles) of pairs. Suggestions are reported, not proven, and never applied silently.
//!
//! A ring with a name such as circlip *snaps* into the groove of a part that stops it in both directions. Other
//! overlapping pairs are, in this order, *soft* (by the name of a part), a *thread* (by a helix), round, or a shallow
//! overlap. A round pair is a *press* fit if the inner vertices lie farther out than the outer ones, otherwise it has
//! chord errors. A shallow overlap gets a tolerance. Deeper overlaps get no suggestion: with a tolerance such parts
//! would slip through their blockers. Threads with play are searched among interlocked parts. A pair gets at most one
//! role, and a snap ring is never a thread, because its gap may look like a helix.

use std::collections::{BTreeMap, BTreeSet};

use colltrans::Solid;
use colltrans::solid::{StartOverlap, Workspace};
use glam::DVec3;
use rayon::prelude::*;

use crate::bodies::{Bodies, Fit, FreeTravel, two_digits_up};
use crate::boxes::value_range;
use crate::digits::short_number;
use crate::error::AssemblyError;
use crate::identical::first_identical_parts;
use crate::inertia;
use crate::part::{Assembly, Part};
use crate::roles::{PairFit, Role};
use crate::start::{Overlap, Start};
use crate::threads::{RoundContacts, Thread, round_axes};

/// Words in the names of soft parts.
const SOFT_NAMES: [&str; 8] =
    ["o-ring", "oring", "o_ring", "seal", "gasket", "belt", "rubber", "grommet"];
/// Words in the names of rings that snap into a groove.
const SNAP_NAMES: [&str; 7] =
    ["circlip", "snap ring", "snap_ring", "snapring", "retaining ring", "retaining_ring", "e-clip"];
/// Maximum depth of an overlap for which a tolerance is suggested by its depth alone, as a fraction of the thickness of
/// both parts. [`Overlap::is_shallow`] has a larger limit. This is the chord error of a round part of 16 sides. Deeper
/// overlaps belong to the model, and a plan that ignores them need not apply to the real parts.
const MAX_SHALLOW_DEPTH: f64 = 0.01;
/// Factor by which a tolerance exceeds the depth of an overlap.
const TOLERANCE_FACTOR: f64 = 1.05;

/// A suggested fit of a pair.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Suggestion {
    /// Indices of the parts, the smaller first.
    pub parts: [usize; 2],
    /// The suggested fit.
    pub fit: PairFit,
    /// The reason.
    pub reason: String,
}

/// Returns suggestions for pairs without a specified fit: pairs that overlap with the fit of the bodies, and rings
/// that snap into a groove.
pub fn suggest_fits(bodies: &Bodies, start: &Start) -> Vec<Suggestion> {
    let lacks_fit = |[a, b]: [usize; 2]| bodies.assembly().pair_fit(a, b).is_none();
    let snaps = find_snaps(bodies);
    let rings: BTreeSet<usize> = snaps.iter().map(|(ring, _)| *ring).collect();
    let snaps = snaps.into_iter().map(|(_, snap)| snap);
    let snaps: Vec<Suggestion> = snaps.filter(|snap| lacks_fit(snap.parts)).collect();
    let candidates = start
        .remaining()
        .filter(|o| lacks_fit(o.parts) && !snaps.iter().any(|snap| snap.parts == o.parts))
        // Pairs that only violate the minimum gap do not overlap.
        .filter(|o| !matches!(bodies.fit(), Fit::MinGap(_)) || o.depth != Some(0.0));
    let candidates: Vec<&Overlap> = candidates.collect();
    let used: BTreeSet<usize> = candidates.iter().flat_map(|overlap| overlap.parts).collect();
    let used: Vec<usize> = used.into_iter().collect();
    let axes = |&part: &usize| (part, round_axes(bodies.assembly().parts()[part].solid()));
    let axes: BTreeMap<usize, Vec<DVec3>> = used.par_iter().map(axes).collect();
    let found = candidates.par_iter().filter_map(|overlap| {
        let own = overlap.parts.map(|part| &axes[&part][..]).concat();
        suggest_fit(bodies, &rings, overlap, &own)
    });
    let found: Vec<Suggestion> = found.collect();
    found.into_iter().chain(snaps.iter().cloned()).collect()
}

/// Finds rings by their names, each with the part in whose groove it lies. This part stops the ring in both
/// directions along its axis, within its thickness.
fn find_snaps(bodies: &Bodies) -> Vec<(usize, Suggestion)> {
    let parts = bodies.assembly().parts();
    let mut found = Vec::new();
    for ring in (0..parts.len()).filter(|&k| is_called(&parts[k], &SNAP_NAMES)) {
        let thickness = |axis: DVec3| {
            let along = parts[ring].solid().vertices().iter().map(|p| p.dot(axis));
            let [low, high] = value_range(along);
            high - low
        };
        let axes = inertia::principal_axes(parts[ring].solid()).into_iter();
        let Some(axis) = axes.min_by(|a, b| thickness(*a).total_cmp(&thickness(*b))) else {
            continue;
        };
        let length = thickness(axis);
        let mut workspace = Workspace::default();
        let mut stops = |other: usize, d: DVec3| match bodies.free_travel(
            [ring, other],
            d,
            None,
            StartOverlap::Refuse,
            &mut workspace,
        ) {
            FreeTravel::Free => false,
            FreeTravel::Blocked(stop) => stop.distance() <= length,
            FreeTravel::Overlapping => true,
        };
        for other in (0..parts.len()).filter(|&k| k != ring) {
            let near = bodies.bounds(ring).expanded(length).intersects(&bodies.bounds(other));
            if near && stops(other, axis) && stops(other, DVec3::ZERO - axis) {
                let fit =
                    PairFit { role: Some(Role::Snap), tolerance: Some(two_digits_up(length)) };
                let why = format!(
                    "the name of {} says so, it is {} thick, and {} stops it in both directions",
                    parts[ring].name(),
                    short_number(length),
                    parts[other].name()
                );
                let parts = [ring.min(other), ring.max(other)];
                found.push((ring, Suggestion { parts, fit, reason: why }));
            }
        }
    }
    found
}

fn is_called(part: &Part, words: &[&str]) -> bool {
    let name = part.name().to_lowercase();
    words.iter().any(|word| name.contains(word))
}

/// Suggests a fit for an overlap of parts that may be round about some axes.
fn suggest_fit(
    bodies: &Bodies,
    rings: &BTreeSet<usize>,
    overlap: &Overlap,
    axes: &[DVec3],
) -> Option<Suggestion> {
    let parts = overlap.parts;
    let of = parts.map(|k| &bodies.assembly().parts()[k]);
    let solids = of.map(Part::solid);
    let tolerance = overlap.depth.map(|depth| two_digits_up(depth * TOLERANCE_FACTOR));
    let with_fit = |role, tolerance, why| {
        Some(Suggestion { parts, fit: PairFit { role, tolerance }, reason: why })
    };
    let soft = of.iter().find(|part| is_called(part, &SOFT_NAMES));
    if let Some(soft) = soft {
        return with_fit(
            Some(Role::Soft),
            tolerance,
            format!("the name of {} says so", soft.name()),
        );
    }
    let screwed = !parts.iter().any(|part| rings.contains(part));
    let contacts = RoundContacts::find(solids, axes);
    let thread = screwed.then(|| contacts.surrounded_thread()).flatten();
    if let Some((thread, pitch)) = thread {
        return with_fit(Some(Role::Thread), None, describe_helix(&thread, pitch));
    }
    let tolerance = Some(tolerance?);
    if let Some(round) = contacts.longest() {
        let by = round.interference();
        let why =
            format!("one lies around the other, at a radius of {}", short_number(round.radius()));
        return if by > bodies.noise() {
            with_fit(
                Some(Role::Press),
                tolerance,
                format!("{why}, by {} too large", short_number(by)),
            )
        } else {
            with_fit(None, tolerance, format!("{why}: chord errors"))
        };
    }
    overlap.is_at_most_share(bodies, MAX_SHALLOW_DEPTH).then_some(())?;
    with_fit(None, tolerance, "a shallow overlap".into())
}

/// Returns the thread of two parts and its pitch, or `None` if there is no helix.
fn find_helix(solids: [&Solid; 2]) -> Option<(Thread, f64)> {
    let thread = Thread::detect(solids)?;
    Some((thread, thread.pitch?))
}

fn describe_helix(thread: &Thread, pitch: f64) -> String {
    let hand = if pitch < 0.0 { ", left-handed" } else { "" };
    let [hole, crest] = thread.radii.map(short_number);
    format!(
        "a helix of pitch {}{hand}, between radii of {hole} and {crest}",
        short_number(pitch.abs())
    )
}

/// Returns the threads with play among interlocked parts, for pairs that do not overlap and have no specified fit.
///
/// One part surrounds the helix of the other, and stops it in both directions along its axis within one turn. Rings
/// that snap into a groove are excluded.
///
/// # Errors
/// Returns an error if the boxes of too many parts overlap.
pub fn suggest_loose_threads(
    bodies: &Bodies,
    stuck: &[usize],
) -> Result<Vec<Suggestion>, AssemblyError> {
    let among = bodies.part_mask(stuck);
    let mut pairs = bodies.neighbouring_pairs(0.0)?;
    let rings: BTreeSet<usize> = find_snaps(bodies).into_iter().map(|(ring, _)| ring).collect();
    pairs.retain(|&[a, b]| {
        let stuck = among[a] && among[b] && !bodies.overlaps(a, b);
        let has_fit = bodies.assembly().pair_fit(a, b).is_some();
        stuck && !has_fit && !rings.contains(&a) && !rings.contains(&b)
    });
    let found = pairs.into_par_iter().filter_map(|parts| {
        let solids = parts.map(|k| bodies.assembly().parts()[k].solid());
        let mut workspace = Workspace::default();
        let mut stops = |d: DVec3, within: f64| {
            let room = bodies.free_travel(parts, d, None, StartOverlap::Refuse, &mut workspace);
            matches!(room, FreeTravel::Blocked(stop) if stop.distance() <= within)
        };
        let mut held =
            |axis: DVec3, within| stops(axis, within) && stops(DVec3::ZERO - axis, within);
        // A screwed part cannot move along any axis. Pairs with a free axis are skipped, so that no helix is
        // searched.
        if !DVec3::AXES.into_iter().all(|axis| held(axis, f64::INFINITY)) {
            return None;
        }
        let (thread, pitch) = find_helix(solids)?;
        let holds =
            thread.is_surrounded(solids[1 - thread.screw]) && held(thread.axis[1], pitch.abs());
        let fit = PairFit { role: Some(Role::Thread), tolerance: None };
        let why = format!("{}, with play", describe_helix(&thread, pitch));
        holds.then_some(Suggestion { parts, fit, reason: why })
    });
    Ok(found.collect())
}

/// Returns the assembly with all suggestions applied, and a note for each.
///
/// # Errors
/// Returns the errors of [`Assembly::with_pair`].
pub fn apply_suggestions(
    mut assembly: Assembly,
    suggestions: &[Suggestion],
) -> Result<Assembly, AssemblyError> {
    for suggestion in describe_suggestions(&assembly, suggestions) {
        assembly = assembly.with_note(format!("taken as suggested: {suggestion}"));
    }
    for Suggestion { parts, fit, .. } in suggestions {
        let [a, b] = parts.map(|k| assembly.parts()[k].name().to_owned());
        assembly = assembly.with_pair([&[a], &[b]], *fit)?;
    }
    Ok(assembly)
}

/// Returns descriptions of the suggestions. Pairs of identical parts are combined.
pub fn describe_suggestions(assembly: &Assembly, suggestions: &[Suggestion]) -> Vec<String> {
    let likes = first_identical_parts(assembly);
    let mut groups: BTreeMap<([usize; 2], Option<Role>), Vec<&Suggestion>> = BTreeMap::new();
    for suggestion in suggestions {
        let mut shapes = suggestion.parts.map(|k| likes[k]);
        shapes.sort_unstable();
        groups.entry((shapes, suggestion.fit.role)).or_default().push(suggestion);
    }
    let words = |((_, role), all): (([usize; 2], Option<Role>), Vec<&Suggestion>)| {
        let pairs = all.iter().map(|s| assembly.part_names(&s.parts).join(","));
        let role = role.map_or("tolerance", Role::name);
        let length = all.iter().filter_map(|s| s.fit.tolerance).reduce(f64::max);
        let length = length.map_or_else(String::new, |length| format!("={length}"));
        let count = if all.len() > 1 { format!("{} x ", all.len()) } else { String::new() };
        let pairs = pairs.collect::<Vec<_>>().join("; ");
        format!("{count}{role}{length} of {pairs} ({})", all[0].reason)
    };
    groups.into_iter().map(words).collect()
}
