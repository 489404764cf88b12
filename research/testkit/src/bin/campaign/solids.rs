//! Campaign of solids: bodies of cubes are compared with exact arithmetic, convex bodies as solids with the
//! convex core, and with the rule over all pairs of facets.

use colltrans_testkit::oracle::settings;
use colltrans_testkit::oracle::solids::settings::{FAMILIES, Setting};
use colltrans_testkit::oracle::solids::{
    MotionOutcome, as_solids, depth, min_gap, nearest, sheets, turning, unions,
};
use colltrans_testkit::random::Random;
use colltrans_testkit::tally::Tally;

use crate::Asked;

/// One proof out of this many is judged in rational arithmetic, if the bodies are small.
const FRACTIONS_EVERY: u64 = 64;
/// One convex pair out of this many is cast as solids.
const CONVEX_EVERY: u64 = 10;

/// Columns of casts.
pub(crate) const CASTS: &[&str] =
    &["settings", "overlapping", "free", "touching", "blocked", "skipped"];
/// Columns of distances.
pub(crate) const DISTANCES: &[&str] =
    &["settings", "touching", "inside", "near", "apart", "skipped"];
/// Columns of casts with a minimum gap.
pub(crate) const MIN_GAPS: &[&str] = &["settings", "nearer", "free", "blocked", "skipped"];
/// Columns of motions.
pub(crate) const MOTIONS: &[&str] =
    &["settings", "overlapping", "free", "grazing", "contact", "skipped"];

/// Returns the families of depths.
pub(crate) fn depth_families() -> Vec<String> {
    crate::to_strings(&depth::FAMILIES)
}

/// Returns the families of unions.
pub(crate) fn union_families() -> Vec<String> {
    crate::to_strings(&unions::FAMILIES)
}

/// Returns the families of casts: bodies of cubes, open sheets, convex bodies.
pub(crate) fn cast_families() -> Vec<String> {
    families(&[])
}

/// Returns the families of distances and of casts with a minimum gap.
pub(crate) fn mesh_families() -> Vec<String> {
    families(&nearest::MESHES)
}

/// Returns the families of motions.
pub(crate) fn motion_families() -> Vec<String> {
    families(&[&nearest::MESHES[..], &turning::FAMILIES].concat())
}

/// Returns the families of casts, with others.
fn families(more: &[&str]) -> Vec<String> {
    let known = FAMILIES.iter().chain(&sheets::FAMILIES).chain(more).map(|&name| name.to_owned());
    known.chain(settings::FAMILIES.iter().map(|family| format!("convex-{}", family.0))).collect()
}

/// Examines casts of bodies of cubes, of sheets, or of one convex pair out of [`CONVEX_EVERY`].
pub(crate) fn casts(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    let Asked { family, seed, .. } = *asked;
    let found = if let Some(convex) = family.strip_prefix("convex-") {
        if !asked.index().is_multiple_of(CONVEX_EVERY) {
            return Ok(());
        }
        as_solids(&settings::setting(convex, seed))
    } else if sheets::FAMILIES.contains(&family) {
        sheets::Setting::draw(family, seed).and_then(|setting| setting.examine()).map(Some)
    } else {
        let in_fractions = seed.is_multiple_of(FRACTIONS_EVERY);
        let setting = Setting::draw(family, seed).ok_or_else(|| "no such family".to_owned());
        setting.and_then(|setting| setting.examine(in_fractions)).map(Some)
    };
    count_outcome(found, tally, |seen| match seen {
        MotionOutcome::Overlapping => "overlapping",
        MotionOutcome::Free => "free",
        MotionOutcome::BlockedNow => "touching",
        MotionOutcome::Blocked => "blocked",
    })
}

/// Examines distances.
pub(crate) fn distances(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    let setting = nearest::Setting::draw(asked.family, asked.seed);
    let found = setting.and_then(|found| found.map(|setting| setting.examine()).transpose());
    count_distance(found, tally)
}

/// Examines distances of rounded solids.
pub(crate) fn rounded_distances(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    let setting = nearest::Setting::draw(asked.family, asked.seed);
    let random = &mut Random::stream(asked.seed, &[asked.family.len() as u64, 0x2ad]);
    let examined = |setting: nearest::Setting| setting.rounded(random)?.examine();
    count_distance(setting.and_then(|found| found.map(examined).transpose()), tally)
}

/// Counts the outcome of a distance.
fn count_distance(
    found: Result<Option<nearest::DistanceOutcome>, String>,
    tally: &mut Tally,
) -> Result<(), String> {
    count_outcome(found, tally, |seen| match seen {
        nearest::DistanceOutcome::Touching => "touching",
        nearest::DistanceOutcome::Inside => "inside",
        nearest::DistanceOutcome::Near => "near",
        nearest::DistanceOutcome::Apart => "apart",
    })
}

/// Examines casts with a minimum gap.
pub(crate) fn min_gaps(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    count_gap(min_gap::examine(asked.family, asked.seed, false), tally)
}

/// Examines casts of rounded solids.
pub(crate) fn rounded_casts(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    count_gap(min_gap::examine(asked.family, asked.seed, true), tally)
}

/// Counts the outcome of a cast with a minimum gap.
fn count_gap(
    found: Result<Option<min_gap::GapOutcome>, String>,
    tally: &mut Tally,
) -> Result<(), String> {
    count_outcome(found, tally, |seen| match seen {
        min_gap::GapOutcome::Nearer => "nearer",
        min_gap::GapOutcome::Free => "free",
        min_gap::GapOutcome::Blocked => "blocked",
    })
}

/// Examines motions.
pub(crate) fn motions(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    count_outcome(turning::examine(asked.family, asked.seed), tally, |seen| match seen {
        turning::TurningOutcome::Overlapping => "overlapping",
        turning::TurningOutcome::Free => "free",
        turning::TurningOutcome::Grazing => "grazing",
        turning::TurningOutcome::Contact => "contact",
    })
}

/// Examines common parts and depths.
pub(crate) fn depths(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    depth::examine(asked.family, asked.seed, tally)
}

/// Examines casts, common parts and depths of unions of pieces that overlap.
pub(crate) fn overlapping_unions(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    unions::examine(asked.family, asked.seed, tally)
}

/// Counts the outcome of a setting. Bodies that are not solids are counted as skipped.
fn count_outcome<S>(
    found: Result<Option<S>, String>,
    tally: &mut Tally,
    name: impl Fn(S) -> &'static str,
) -> Result<(), String> {
    tally.count("settings");
    tally.count(found?.map_or("skipped", name));
    Ok(())
}
