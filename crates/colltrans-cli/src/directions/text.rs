//! The answer in words.

use std::fmt::Write as _;

use colltrans::free::FreeArc;
use colltrans::glam::DVec3;
use colltrans::record::{BlockedByRecord, Ending, FreeRecord, FreeRegionRecord};

use crate::numbers::{counted, number, six_digits, unit_vector};
use crate::report::{line, overlaps, remedy};
use crate::terminal::shown;

/// Regions, arcs, points and what blocks are listed up to so many, and corners up to so many.
const MOST: usize = 8;
const MOST_CORNERS: usize = 12;

/// The readable answer of `colltrans directions`.
pub(super) fn answer(record: &FreeRecord) -> String {
    let mut text = match record.outcome {
        Ending::Free => "free along some directions\n",
        Ending::Blocked => "blocked: it cannot leave along any direction, which is proven\n",
        Ending::Undecided => "undecided: no direction is known to be free, and not all are known\n",
        _ => "overlapping: the bodies overlap now\n",
    }
    .to_owned();
    told(&mut text, record);
    if record.outcome == Ending::Overlapping {
        overlaps(&mut text, &record.start_overlaps, "overlap");
        line(&mut text, "", remedy(&record.start_overlaps));
    }
    if let Some(tolerance) = record.tolerance {
        let how = if tolerance > 0.0 { " (both bodies are shrunk by half of it)" } else { "" };
        line(&mut text, "tolerance", &format!("{}{how}", number(tolerance)));
    }
    text
}

/// Lines on shares, regions, arcs, points and what blocks.
pub(crate) fn told(text: &mut String, record: &FreeRecord) {
    let (Some(free), Some(undecided)) = (record.free_share, record.undecided_share) else { return };
    let mut say = |name: &str, value: String| line(text, name, &value);
    if record.outcome != Ending::Blocked {
        let none = free[1] == 0.0 && record.undecided_cells == Some(0);
        say("free", if none { "no region of directions".into() } else { shares(free) });
    }
    let count = |cells: Option<u64>| counted(cells.unwrap_or_default() as usize, "cell", "cells");
    say(
        "undecided",
        match record.undecided_cells {
            Some(0) | None => "nothing".into(),
            cells => {
                format!("{}, {}; --depth and --looks do more", at_most(undecided), count(cells))
            }
        },
    );
    say("proof", format!("{} of the sphere of directions", count(record.cells)));
    for region in record.regions.iter().take(MOST) {
        say("region", self::region(region));
    }
    let direction = |d: [f64; 3]| unit_vector(DVec3::from(d).normalize());
    for arc in record.arcs.iter().take(MOST) {
        say("arc", self::arc(arc));
    }
    for point in record.points.iter().take(MOST) {
        let [a, b] = point.planes.map(|plane| unit_vector(plane.normal.normalize()));
        let d = unit_vector(point.direction.normalize());
        say("point", format!("{d}, alone; exactly across {a} and {b}"));
    }
    for also in record.also_free.iter().take(MOST).copied() {
        say("also free", format!("{}, among what is undecided", direction(also)));
    }
    for by in record.blocked_by.iter().filter(|by| by.moving.is_some() || by.fixed.is_some()) {
        say("blocked by", blocker(by));
    }
    let [regions, arcs, points] = [record.regions.len(), record.arcs.len(), record.points.len()]
        .map(|n| n.saturating_sub(MOST));
    if regions + arcs + points > 0 {
        say(
            "",
            format!(
                "and {regions} more regions, {arcs} more arcs, {points} more points (--json has all)"
            ),
        );
    }
}

/// What a proof says that was checked, in one line.
pub(crate) fn verified(record: &FreeRecord) -> String {
    let mut text = if record.outcome == Ending::Blocked {
        "the moving body cannot leave along any direction".to_owned()
    } else {
        let free = record.free_share.unwrap_or_default();
        let none = free[1] == 0.0;
        let what = if none { "no region of directions that is known".into() } else { shares(free) };
        format!("the moving body can leave along {what}")
    };
    let kinds = [
        (record.arcs.len(), "arc", "arcs"),
        (record.points.len(), "isolated direction", "isolated directions"),
    ];
    for (count, one, many) in kinds.into_iter().filter(|(count, ..)| *count > 0) {
        let _ = write!(text, ", {}", counted(count, one, many));
    }
    if let Some(undecided) = record.undecided_share.filter(|_| record.undecided_cells > Some(0)) {
        let _ = write!(text, "; undecided are {}", at_most(undecided));
    }
    text
}

fn arc(arc: &FreeArc) -> String {
    let turns = arc.along.windows(2).map(|ends| ends[0].angle_between(ends[1]));
    let degrees = six_digits(turns.sum::<f64>().to_degrees());
    let across = unit_vector(arc.plane.normal.normalize());
    let Some(ends) = arc.ends else { return format!("all across {across}, {degrees} degrees") };
    let [from, to] = ends.map(|end| unit_vector(end.direction.normalize()));
    format!("from {from} to {to}, {degrees} degrees across {across}")
}

fn region(region: &FreeRegionRecord) -> String {
    let mut text =
        format!("{} around {}", percent(region.share), unit_vector(region.center.into()));
    let corners = &region.corners;
    let _ = write!(text, ", {} degrees from its border", six_digits(region.margin.to_degrees()));
    if corners.is_empty() {
        text.push_str(", without corners");
    } else if corners.len() <= MOST_CORNERS {
        let all: Vec<String> =
            corners.iter().map(|c| unit_vector(DVec3::from(*c).normalize())).collect();
        let _ = write!(text, ", corners {}", all.join("; "));
    } else {
        let _ = write!(text, ", {} corners", corners.len());
    }
    text
}

fn blocker(by: &BlockedByRecord) -> String {
    let name = |name: &Option<String>| name.as_ref().map(shown);
    let who = match (name(&by.moving), name(&by.fixed)) {
        (Some(moving), Some(fixed)) => format!("{fixed}, which stops {moving}"),
        (None, Some(fixed)) => fixed,
        (Some(moving), None) => format!("what stops {moving}"),
        (None, None) => String::new(),
    };
    format!("{who}: at least {} of all directions", percent(by.share))
}

/// Between two bounds.
fn shares([low, high]: [f64; 2]) -> String {
    if high == 0.0 {
        return "no region of directions is known to be".into();
    }
    format!(
        "{} of all directions (at least {}, at most {})",
        percent(low + 0.5 * (high - low)),
        number(low),
        number(high)
    )
}

fn at_most(share: f64) -> String {
    format!("at most {} of all directions", percent(share))
}

fn percent(share: f64) -> String {
    format!("{} %", six_digits(100.0 * share))
}
