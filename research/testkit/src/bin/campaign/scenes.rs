//! Scenes: one body among many that came, moved and went.

use colltrans_testkit::oracle::among::Setting;

use crate::Asked;
use crate::tally::Tally;

/// What is counted.
pub(crate) const COLUMNS: &[&str] =
    &["scenes", "obstacles", "asked", "overlapped", "tied", "stopped", "refused"];

/// Draws a scene, asks everything, and judges it.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) {
    let Asked { family, seed, .. } = *asked;
    tally.count("scenes");
    match Setting::draw(family, seed).and_then(|setting| setting.examine()) {
        Ok(seen) => {
            tally.add("obstacles", seen.obstacles as u64);
            tally.add("asked", seen.asked as u64);
            tally.count_if("overlapped", seen.overlapped);
            tally.count_if("tied", seen.tied);
            tally.count_if("stopped", seen.stopped);
            tally.add("refused", seen.refused as u64);
        }
        Err(objection) => tally.disagree(format!("{family}:{seed}: {objection}")),
    }
}
