//! An answer in words.

use std::fmt::Write as _;

use colltrans::glam::DVec3;
use colltrans::record::{
    Answer, CastRecord, ContactRecord, Ending, FeatureRecord, FeaturesRecord, MotionRecord,
    Question, Record, StartOverlapRecord,
};
use colltrans::{
    Bounded, Clearance, Contact, ContactRange, Grazing, OverlapAhead, Separated, Solver, Steps,
    WhyFree,
};

use crate::numbers::{about, decade, known, known_vector, number, six_digits, unit_vector};
use crate::record::{Hulls, Line};
use crate::terminal::shown;

/// Vertices of a feature that are listed.
const LISTED: usize = 12;

/// The readable answer.
pub(crate) fn answer(answer: &Answer, told: &Line, direction: DVec3) -> String {
    let nothing = ContactRecord::default();
    let record = told.record.contact().unwrap_or(&nothing);
    let mut text = match answer {
        Answer::Contact(range) => cast(range, record, direction),
        Answer::Clearance(far) => clearance(far, record, direction),
    };
    kept(&mut text, record.keep);
    hulls(&mut text, told.hull, told.record.outcome(), false);
    text
}

/// The readable answer of `colltrans cast`.
fn cast(answer: &ContactRange, record: &ContactRecord, direction: DVec3) -> String {
    let mut text = String::new();
    match answer {
        ContactRange::Contact { first, last } => {
            text.push_str("contact\n");
            range(&mut text, first, last, direction);
            contact(&mut text, first, record, direction);
        }
        ContactRange::Grazing { first, last } => {
            text.push_str("grazing: the bodies slide along each other\n");
            overlap(&mut text, first);
            range(&mut text, &first.contact, &last.contact, direction);
            contact(&mut text, &first.contact, record, direction);
        }
        ContactRange::Separated(answer) => {
            text.push_str("separated: the bodies never meet along this direction\n");
            separated(&mut text, answer);
        }
    }
    text
}

/// The readable answer of `colltrans clearance`.
fn clearance(answer: &Clearance, record: &ContactRecord, direction: DVec3) -> String {
    let mut text = String::new();
    match answer {
        Clearance::Blocked { distance, contact: first } => {
            text.push_str("blocked\n");
            let touch = first.translation.abs() <= first.certificate.rounding;
            let remark = if touch { " (the bodies touch)" } else { "" };
            let [far, length] = safe(Some(*distance), direction);
            let far = format!("{far} times the direction, a length of {length}{remark}");
            line(&mut text, "distance", &far);
            let translation = along(first.translation, first.certificate.rounding, direction);
            line(&mut text, "translation", &translation);
            contact(&mut text, first, record, direction);
        }
        Clearance::Free(WhyFree::Slides(grazing)) => {
            text.push_str("slides: free, the bodies slide along each other\n");
            overlap(&mut text, grazing);
            let first = &grazing.contact;
            let translation = along(first.translation, first.certificate.rounding, direction);
            line(&mut text, "translation", &translation);
            contact(&mut text, first, record, direction);
        }
        Clearance::Free(WhyFree::Behind(last)) => {
            text.push_str("behind: free, the bodies only meet behind\n");
            line(&mut text, "last contact", &exit(last, direction));
        }
        Clearance::Free(WhyFree::Separated(answer)) => {
            text.push_str("separated: free, the bodies never meet along this direction\n");
            separated(&mut text, answer);
        }
        Clearance::Overlapping(OverlapAhead { first, last }) => {
            text.push_str("overlapping: the bodies overlap now\n");
            // The last contact is the first one of the way back.
            for (name, contact, way) in [("free after", first, "back"), ("or after", last, "on")] {
                line(&mut text, name, &format!("{}, {way}", times(-contact.certificate.lower)));
                let far = along(-contact.translation, contact.certificate.rounding, direction);
                line(&mut text, "", &format!("best estimate {far}"));
            }
        }
    }
    text
}

/// One line of a scan, under [`scan_head`].
pub(crate) fn scan_line(told: &Line, direction: DVec3) -> String {
    let mut columns = vec![told.record.outcome().name().to_owned()];
    match &told.record {
        Record::Clearance(of) => columns.extend(safe(of.distance, direction)),
        Record::Cast(CastRecord {
            contact: ContactRecord { translation, rounding, .. }, ..
        }) => {
            let (length, error) = (direction.length(), rounding.unwrap_or_default());
            columns.extend(match *translation {
                Some(t) => [known(t, error), known(t * length, error * length)],
                None => ["-", "-"].map(str::to_owned),
            });
        }
        _ => columns.push(told.message.clone().unwrap_or_default()),
    }
    if let Some(normal) = told.record.contact().and_then(|contact| contact.normal) {
        columns.push(unit_vector(DVec3::from_array(normal)));
    }
    let d = known_vector(direction, 0.0);
    format!("{d:<24} {}\n", align(&columns))
}

/// A distance that is safe, with all its digits, and a length that is, too.
pub(crate) fn safe(distance: Option<f64>, direction: DVec3) -> [String; 2] {
    let Some(distance) = distance else { return ["-", "-"].map(str::to_owned) };
    // The direction's length and the product are rounded: three roundings down.
    let length = distance * direction.length();
    let length = if direction.length_squared() == 1.0 {
        distance
    } else {
        (length - 4.0 * f64::EPSILON * length).max(0.0)
    };
    [number(distance), number(length)]
}

/// The names of the columns of a scan.
pub(crate) fn scan_head(question: Question) -> String {
    let far = match question {
        Question::Contact => "translation",
        Question::Clearance => "distance",
    };
    let columns = ["outcome", far, "length", "normal"].map(str::to_owned);
    format!("{:<24} {}\n", "direction", align(&columns))
}

fn align(columns: &[String]) -> String {
    let mut text = String::new();
    for (column, width) in columns.iter().zip([11, 19, 19, 0]) {
        let _ = write!(text, "{column:<width$} ");
    }
    text.truncate(text.trim_end().len());
    text
}

/// A translation, which has an error, and its length.
pub(crate) fn along(t: f64, error: f64, direction: DVec3) -> String {
    let length = direction.length();
    let shown = known(t * length, error * length);
    format!("{} times the direction, a length of {shown}", known(t, error))
}

/// A translation that is safe, and its length: with the digits that are known, where such a number is
/// still safe for the shrunk bodies; else the proven one with all its digits.
pub(crate) fn safely(t: f64, error: f64, [lower, limit]: [f64; 2], direction: DVec3) -> String {
    let length = direction.length();
    let shown = [known(t, error), known(t * length, error * length)];
    let most = [limit, (1.0 - 4.0 * f64::EPSILON) * limit * length];
    let is_safe = |(text, most): (&String, f64)| text.parse::<f64>().is_ok_and(|t| t <= most);
    let all = shown.iter().zip(most).all(is_safe);
    let [far, length] = if all { shown } else { safe(Some(lower), direction) };
    format!("{far} times the direction, a length of {length}")
}

/// Where bodies meet last, and from where on they certainly do no more.
fn exit(last: &Contact, direction: DVec3) -> String {
    let Bounded { value, upper, .. } = last.exit();
    let shown = along(value, last.certificate.rounding, direction);
    format!("{shown}; never after {}", number(upper))
}

/// A proven bound, with all its digits.
pub(crate) fn times(t: f64) -> String {
    format!("{} times the direction", number(t))
}

fn range(text: &mut String, first: &Contact, last: &Contact, direction: DVec3) {
    // Also of bodies that slide: where the contact lies if their overlap is taken for real.
    let remark = match (ContactRange::Contact { first: *first, last: *last }).clearance() {
        Clearance::Free(WhyFree::Behind(_)) => " (the contact lies behind)",
        Clearance::Overlapping(_) => " (the bodies overlap now)",
        _ if first.translation.abs() <= first.certificate.rounding => " (the bodies touch)",
        _ => "",
    };
    let translation = along(first.translation, first.certificate.rounding, direction);
    line(text, "translation", &format!("{translation}{remark}"));
    line(text, "exit", &exit(last, direction));
}

fn contact(text: &mut String, first: &Contact, record: &ContactRecord, direction: DVec3) {
    let proof = &first.certificate;
    line(text, "normal", &unit_vector(first.normal));
    if let Some(point) = record.point {
        let point = DVec3::from_array(point);
        line(text, "point", &known_vector(point, proof.rounding * direction.length()));
    }
    features(text, record.features.as_ref(), [None; 2]);
    let bounds = if proof.upper.is_finite() {
        format!(
            "{} to {}, gap {} (rounding alone: up to {})",
            number(proof.lower),
            number(proof.upper),
            about(proof.gap()),
            about(proof.rounding)
        )
    } else {
        format!("at least {}; whether they touch is beyond rounding", number(proof.lower))
    };
    line(text, "bounds", &bounds);
    line(text, "solver", &work(first.solver, first.steps));
}

fn overlap(text: &mut String, grazing: &Grazing) {
    let direction = unit_vector(grazing.separating_direction);
    line(text, "overlap", &format!("{} sideways, along {direction}", six_digits(grazing.overlap)));
    text.push_str("  the contact, if the overlap is taken for real:\n");
}

fn separated(text: &mut String, separated: &Separated) {
    let margin = separated.certificate.margin;
    let shown = known(margin, 1e-14 * margin);
    line(text, "margin", &format!("{shown}, the gap between the shadows along this normal"));
    let normal = unit_vector(separated.certificate.normal);
    line(text, "normal", &format!("{normal} of the separating plane"));
    line(text, "solver", &work(separated.solver, separated.steps));
}

/// What bodies do that touch, or come as near as the gap that is kept.
pub(crate) fn meet(keep: Option<f64>) -> String {
    keep.map_or("meet".into(), |gap| format!("come as near as {}", number(gap)))
}

/// What bodies that are free never do: with a tolerance they may be in each other all the time.
pub(crate) fn never(record: &MotionRecord) -> String {
    let meet = meet(record.keep);
    match record.tolerance {
        None => format!("the bodies never {meet}"),
        // Of convex bodies a depth, whose proof has planes; solids are shrunk.
        Some(depth) if record.planes.is_some() => {
            format!("the bodies never overlap by more than {}", number(depth))
        }
        Some(_) => format!("the bodies, each shrunk by half of the tolerance, never {meet}"),
    }
}

/// The gap that is kept, if there is one.
pub(crate) fn kept(text: &mut String, keep: Option<f64>) {
    if let Some(gap) = keep {
        let what = "a gap: they count as meeting where they are as near";
        line(text, "kept", &format!("{}, {what}", number(gap)));
    }
}

/// By how much hulls exceed their parts, and what the answer then means.
pub(crate) fn hulls(text: &mut String, hulls: Option<Hulls>, outcome: Ending, is_depth: bool) {
    let Some(hulls) = hulls else { return };
    for (name, excess) in hulls.named() {
        line(text, name, &excess.to_string());
    }
    let Hulls { moving, fixed, dropped } = hulls;
    let whose = match (moving, fixed) {
        (Some(_), Some(_)) => "the parts themselves",
        (Some(_), None) => "the moving part itself",
        _ => "the fixed part itself",
    };
    let meaning = match outcome {
        Ending::Separated | Ending::Farther => format!("proven for {whose} too"),
        Ending::Behind => format!("proven for {whose} too: free ahead"),
        Ending::Grazing | Ending::Slides => {
            format!("a bound for {whose}: no more overlap sideways, perhaps none")
        }
        Ending::Overlapping if is_depth => {
            format!("a bound for {whose}: parted by this translation, perhaps by a shorter one")
        }
        Ending::Overlapping => {
            format!("a bound for {whose}: free after these ways, perhaps no overlap at all")
        }
        Ending::Apart => format!("a bound for {whose}: no nearer to each other, perhaps farther"),
        Ending::Meeting | Ending::Touching => {
            format!("nothing for {whose}, perhaps apart from each other")
        }
        Ending::Closer | Ending::Undecided => {
            format!("nothing for {whose}, perhaps farther from each other")
        }
        Ending::Contact | Ending::Blocked | Ending::Free | Ending::Error => {
            format!("a bound for {whose}: no contact before this one, perhaps later or none")
        }
    };
    line(text, "so this is", &meaning);
    if dropped > 0.0 {
        let near =
            format!("that is {} beyond a hull at most, and was dropped", six_digits(dropped));
        line(text, "but for", &format!("what of {whose} {near}"));
    }
}

pub(crate) fn line(text: &mut String, name: &str, value: &str) {
    let _ = writeln!(text, "  {name:<12} {value}");
}

/// Writes a line for each feature in contact, with the name of its file if there is one.
pub(crate) fn features(
    text: &mut String,
    features: Option<&FeaturesRecord>,
    files: [Option<&str>; 2],
) {
    let Some(FeaturesRecord { moving, fixed }) = features else { return };
    for (name, what, file) in [("moving", moving, files[0]), ("fixed", fixed, files[1])] {
        let file = file.map_or(String::new(), |file| format!(" of {}", shown(file)));
        line(text, name, &format!("{}{file}", feature(what)));
    }
}

/// A feature by its vertices, a few of them where there are many.
fn feature(feature: &FeatureRecord) -> String {
    let count = feature.vertices.len();
    let mut text = feature.kind.to_owned();
    if count != 1 {
        text.push_str(" of vertices");
    }
    for vertex in feature.vertices.iter().take(LISTED) {
        let _ = write!(text, " {vertex}");
    }
    if count > LISTED {
        let _ = write!(text, " ... ({count} in all)");
    }
    text
}

fn work(solver: Solver, steps: Steps) -> String {
    // One-off queries start from scratch.
    let Steps { planar_problems, supports, pivots, .. } = steps;
    let sections = match steps {
        Steps { planar_problems: 0, .. } => String::new(),
        // The first one ended it: nothing was cut.
        Steps { iterations, region_sides: 0, .. } => format!(" ({iterations} iterations)"),
        Steps { iterations, region_sides, .. } => {
            format!(" ({iterations} iterations; a region of at most {region_sides} sides)")
        }
    };
    format!(
        "{solver}: {planar_problems} planar problems{sections}, {supports} supports, {pivots} pivots"
    )
}

/// Returns which flags let bodies move that overlap at the start.
pub(crate) fn remedy(overlaps: &[StartOverlapRecord]) -> &'static str {
    if overlaps.iter().all(|overlap| overlap.least_tolerance.is_some()) {
        "--tolerance allows for it, --ignore-start-overlaps lets it pass"
    } else {
        "--ignore-start-overlaps lets it pass"
    }
}

/// What overlaps what, a line each.
pub(crate) fn overlaps(text: &mut String, overlaps: &[StartOverlapRecord], name: &str) {
    for StartOverlapRecord { moving, fixed, least_tolerance } in overlaps {
        let [moving, fixed] =
            [moving, fixed].map(|name| shown(name.as_deref().unwrap_or_default()));
        let remedy = match least_tolerance {
            Some(least) => format!("a tolerance of {} would part them", above(*least)),
            None => "no tolerance would part them".into(),
        };
        line(text, name, &format!("{moving} in {fixed}: {remedy}"));
    }
}

/// A few digits, and no less than the value.
fn above(value: f64) -> String {
    let short: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    let step: f64 = format!("1e{}", decade(value) - 3).parse().unwrap_or(0.0);
    let rounded = if short >= value { short } else { short + step };
    let shown: f64 = format!("{rounded:.3e}").parse().unwrap_or(rounded);
    number(if shown >= value { shown } else { value })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_suggested_tolerance_suffices() {
        for value in [0.1, 0.12345, 0.999_96, 7.0, 1e-7 / 3.0, 2.0 / 3.0, 123_456.7] {
            let shown: f64 = above(value).parse().unwrap();
            assert!(shown >= value && shown <= value * 1.002, "{value} as {shown}");
        }
        assert_eq!(above(0.25), "0.25");
    }
}
