//! Sets of removal directions as text.

use std::fmt::Write as _;

use colltrans::glam::DVec3;
use colltrans::record::{BlockedByRecord, Ending, FreeRecord, FreeRegionRecord};
use colltrans::removal::directions::FreeArc;

use crate::numbers::{
    at_most, count_text, interval_of_unit, length_up, six_digits, unit_vector, unit_vector_within,
};
use crate::report::{overlap_hint, push_line, push_start_overlaps};
use crate::terminal::escape_line;

/// Maximum number of regions, of arcs and of points that are listed.
const MAX_LISTED: usize = 8;
/// Maximum number of corners of a region that are listed.
const MAX_CORNERS: usize = 12;

/// Returns the answer of `colltrans directions`.
pub(super) fn answer_text(record: &FreeRecord) -> String {
    let mut text = match record.outcome {
        Ending::Free => "free along some directions\n",
        Ending::Blocked => "blocked: proven that it cannot leave along any direction\n",
        Ending::Undecided => {
            "undecided: no direction is known to be free, and not all are decided\n"
        }
        _ => "overlapping: the bodies overlap now\n",
    }
    .to_owned();
    push_directions(&mut text, record);
    if record.outcome == Ending::Overlapping {
        push_start_overlaps(&mut text, &record.start_overlaps, "overlap");
        push_line(&mut text, "", overlap_hint(&record.start_overlaps));
    }
    if let Some(tolerance) = record.tolerance {
        let how = if tolerance > 0.0 { " (each body is offset inwards by half of it)" } else { "" };
        push_line(&mut text, "tolerance", &format!("{}{how}", length_up(tolerance)));
    }
    text
}

/// Appends lines about shares, regions, arcs, points and blocking files.
pub(crate) fn push_directions(text: &mut String, record: &FreeRecord) {
    let (Some(free), Some(undecided)) = (record.free_share, record.undecided_share) else { return };
    let mut put = |name: &str, value: String| push_line(text, name, &value);
    if record.outcome != Ending::Blocked {
        let none = free[1] == 0.0 && record.undecided_cells == Some(0);
        put("free", if none { "no region of directions".into() } else { share_text(free) });
    }
    let count =
        |cells: Option<u64>| count_text(cells.unwrap_or_default() as usize, "cell", "cells");
    put(
        "undecided",
        match record.undecided_cells {
            Some(0) | None => "nothing".into(),
            cells => {
                format!(
                    "{}, {}; larger --depth and --looks decide more",
                    at_most_share(undecided),
                    count(cells)
                )
            }
        },
    );
    put("proof", format!("{} of the sphere of directions", count(record.cells)));
    for region in record.regions.iter().take(MAX_LISTED) {
        put("region", region_text(region));
    }
    let direction = |d: [f64; 3]| unit_vector(DVec3::from(d).normalize());
    for arc in record.arcs.iter().take(MAX_LISTED) {
        put("arc", arc_text(arc));
    }
    for point in record.points.iter().take(MAX_LISTED) {
        let [a, b] = point.planes.map(|plane| unit_vector(plane.normal.normalize()));
        let d = unit_vector(point.direction.normalize());
        put("point", format!("{d}, isolated; exactly perpendicular to {a} and {b}"));
    }
    for also in record.also_free.iter().take(MAX_LISTED).copied() {
        put("also free", format!("{}, in an undecided cell", direction(also)));
    }
    for by in record.blocked_by.iter().filter(|by| by.moving.is_some() || by.fixed.is_some()) {
        put("blocked by", blocker_text(by));
    }
    let [regions, arcs, points] = [record.regions.len(), record.arcs.len(), record.points.len()]
        .map(|n| n.saturating_sub(MAX_LISTED));
    if regions + arcs + points > 0 {
        put(
            "",
            format!(
                "and {regions} more regions, {arcs} more arcs, {points} more points (--json has all)"
            ),
        );
    }
}

/// Returns the statement of a checked proof in one line.
pub(crate) fn verified_text(record: &FreeRecord) -> String {
    let mut text = if record.outcome == Ending::Blocked {
        "the moving body cannot leave along any direction".to_owned()
    } else {
        let free = record.free_share.unwrap_or_default();
        let none = free[1] == 0.0;
        let what = if none { "no known region of directions".into() } else { share_text(free) };
        format!("the moving body can leave along {what}")
    };
    let kinds = [
        (record.arcs.len(), "arc", "arcs"),
        (record.points.len(), "isolated direction", "isolated directions"),
    ];
    for (count, one, many) in kinds.into_iter().filter(|(count, ..)| *count > 0) {
        let _ = write!(text, ", {}", count_text(count, one, many));
    }
    if let Some(undecided) = record.undecided_share.filter(|_| record.undecided_cells > Some(0)) {
        let _ = write!(text, "; undecided: {}", at_most_share(undecided));
    }
    text
}

/// Describes an arc of directions.
fn arc_text(arc: &FreeArc) -> String {
    let turns = arc.along.windows(2).map(|ends| ends[0].angle_between(ends[1]));
    let degrees = six_digits(turns.sum::<f64>().to_degrees());
    let across = unit_vector(arc.plane.normal.normalize());
    let Some(ends) = arc.ends else {
        return format!("full circle perpendicular to {across}, {degrees} degrees");
    };
    let [from, to] = ends.map(|end| unit_vector(end.direction.normalize()));
    format!("from {from} to {to}, {degrees} degrees, perpendicular to {across}")
}

/// Describes a region of directions.
fn region_text(region: &FreeRegionRecord) -> String {
    let center = region.center.into();
    let mut text =
        format!("{} around {}", percent(region.share), unit_vector_within(center, region.margin));
    let corners = &region.corners;
    let _ = write!(text, ", {} degrees from its border", six_digits(region.margin.to_degrees()));
    if corners.is_empty() {
        text.push_str(", without corners");
    } else if corners.len() <= MAX_CORNERS {
        let all: Vec<String> =
            corners.iter().map(|c| unit_vector(DVec3::from(*c).normalize())).collect();
        let _ = write!(text, ", corners {}", all.join("; "));
    } else {
        let _ = write!(text, ", {} corners", corners.len());
    }
    text
}

/// Describes the files of a blocking pair, and the share of the blocked cells that are attributed to it. The pair may
/// block more or, if boxes inside the bodies block cells, less.
fn blocker_text(by: &BlockedByRecord) -> String {
    let name = |name: &Option<String>| name.as_ref().map(escape_line);
    let who = match (name(&by.moving), name(&by.fixed)) {
        (Some(moving), Some(fixed)) => format!("{fixed}, which blocks {moving}"),
        (None, Some(fixed)) => fixed,
        (Some(moving), None) => format!("a file that blocks {moving}"),
        (None, None) => String::new(),
    };
    format!("{who}: {} of all directions are attributed to it", percent(by.share))
}

/// Returns a share of all directions with its two bounds.
fn share_text([low, high]: [f64; 2]) -> String {
    if high == 0.0 {
        return "no region of directions is known to be".into();
    }
    let bounds = [(100.0 * low).next_down().max(0.0), (100.0 * high).next_up()];
    interval_of_unit(bounds, "% of all directions")
}

/// Returns an upper bound of a share of all directions.
fn at_most_share(share: f64) -> String {
    format!("at most {} % of all directions", at_most((100.0 * share).next_up()))
}

/// Returns a share in percent, with six digits.
fn percent(share: f64) -> String {
    format!("{} %", six_digits(100.0 * share))
}
