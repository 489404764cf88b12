//! Answers as text: casts and clearances of convex bodies, and lines that several commands share.

use std::fmt::Write as _;

use colltrans::glam::DVec3;
use colltrans::record::{
    Answer, CastRecord, ContactRecord, Ending, FeatureRecord, FeaturesRecord, MotionRecord,
    Question, Record, StartOverlapRecord,
};
use colltrans::{
    Bounded, Clearance, Contact, ContactRange, FreeReason, Grazing, OverlapAhead, Separated,
    Solver, Steps,
};

use crate::numbers::{
    at_least, at_most, error_bound, estimate, interval, length_down, length_up, point, six_digits,
    unit_vector, vector,
};
use crate::record::{Hulls, Line};
use crate::terminal::escape_line;

/// Maximum number of vertices of a feature that are listed.
const MAX_VERTICES: usize = 12;

/// Returns the answer of a cast or a clearance of convex bodies. `extent` is that of the smaller body.
pub(crate) fn cast_answer_text(
    answer: &Answer,
    line: &Line,
    direction: DVec3,
    extent: f64,
) -> String {
    let empty = ContactRecord::default();
    let record = line.record.contact().unwrap_or(&empty);
    let context = Context { record, direction, extent };
    let mut text = match answer {
        Answer::Contact(range) => contact_range_text(range, &context),
        Answer::Clearance(clearance) => clearance_text(clearance, &context),
    };
    push_min_gap(&mut text, record.min_gap);
    push_hulls(&mut text, line.hull, line.record.outcome(), false);
    text
}

/// The query and the record of an answer.
struct Context<'a> {
    record: &'a ContactRecord,
    direction: DVec3,
    /// Extent of the smaller body.
    extent: f64,
}

/// Returns the answer of `colltrans cast`.
fn contact_range_text(answer: &ContactRange, context: &Context<'_>) -> String {
    let direction = context.direction;
    let mut text = String::new();
    match answer {
        ContactRange::Contact { first, last } => {
            text.push_str("contact\n");
            push_range(&mut text, first, last, direction);
            push_contact(&mut text, first, context);
        }
        ContactRange::Grazing { first, last } => {
            text.push_str("grazing: the bodies slide along each other\n");
            push_overlap(&mut text, first);
            push_range(&mut text, &first.contact, &last.contact, direction);
            push_contact(&mut text, &first.contact, context);
        }
        ContactRange::Separated(answer) => {
            text.push_str("separated: the bodies never meet along this direction\n");
            push_separation(&mut text, answer);
        }
    }
    text
}

/// Returns the answer of `colltrans clearance` for convex bodies.
fn clearance_text(answer: &Clearance, context: &Context<'_>) -> String {
    let direction = context.direction;
    let mut text = String::new();
    match answer {
        Clearance::Blocked { distance, contact: first } => {
            text.push_str("blocked\n");
            let is_touching = first.translation.abs() <= first.certificate.rounding;
            let remark = if is_touching { " (the bodies touch)" } else { "" };
            let [distance, length] = safe_distance(Some(*distance), direction);
            let distance = format!("{distance} times the direction, a length of {length}{remark}");
            push_line(&mut text, "distance", &distance);
            let translation =
                translation_text(first.translation, first.certificate.rounding, direction);
            push_line(&mut text, "translation", &translation);
            push_contact(&mut text, first, context);
        }
        Clearance::Free(FreeReason::Slides(grazing)) => {
            text.push_str("slides: free, the bodies slide along each other\n");
            push_overlap(&mut text, grazing);
            let first = &grazing.contact;
            let translation =
                translation_text(first.translation, first.certificate.rounding, direction);
            push_line(&mut text, "translation", &translation);
            push_contact(&mut text, first, context);
        }
        Clearance::Free(FreeReason::Behind(last)) => {
            text.push_str("behind: free, the bodies only meet behind\n");
            push_line(&mut text, "last contact", &exit_text(last, direction));
        }
        Clearance::Free(FreeReason::Separated(answer)) => {
            text.push_str("separated: free, the bodies never meet along this direction\n");
            push_separation(&mut text, answer);
        }
        Clearance::Overlapping(OverlapAhead { first, last }) => {
            text.push_str("overlapping: the bodies overlap now\n");
            // The last contact is the first one of the backward motion.
            for (name, contact, sense) in
                [("free after", first, "backwards"), ("or after", last, "forwards")]
            {
                let travel = at_most(-contact.certificate.lower);
                push_line(&mut text, name, &format!("{travel} times the direction, {sense}"));
                let estimate =
                    translation_text(-contact.translation, contact.certificate.rounding, direction);
                push_line(&mut text, "", &format!("best estimate {estimate}"));
            }
        }
    }
    text
}

/// Returns the line of one direction of `--directions`, below [`scan_header`].
pub(crate) fn scan_line(line: &Line, direction: DVec3) -> String {
    let mut columns = vec![line.record.outcome().name().to_owned()];
    match &line.record {
        Record::Clearance(record) => columns.extend(safe_distance(record.distance, direction)),
        Record::Cast(CastRecord {
            contact: ContactRecord { translation, rounding, .. }, ..
        }) => {
            let (length, error) = (direction.length(), rounding.unwrap_or_default());
            columns.extend(match *translation {
                Some(t) => [estimate(t, error), estimate(t * length, error * length)],
                None => ["-", "-"].map(str::to_owned),
            });
        }
        _ => columns.push(line.message.clone().unwrap_or_default()),
    }
    if let Some(normal) = line.record.contact().and_then(|contact| contact.normal) {
        columns.push(unit_vector(DVec3::from_array(normal)));
    }
    let direction = vector(direction);
    format!("{direction:<24} {}\n", align_columns(&columns))
}

/// Returns a distance that is safe to move by, as a multiple of the direction and as a length; `-` if there is none. Both
/// are rounded down.
pub(crate) fn safe_distance(distance: Option<f64>, direction: DVec3) -> [String; 2] {
    let Some(distance) = distance else { return ["-", "-"].map(str::to_owned) };
    // The length of the direction and the product have three rounding errors.
    let length = distance * direction.length();
    let length = if direction.length_squared() == 1.0 {
        distance
    } else {
        (length - 4.0 * f64::EPSILON * length).max(0.0)
    };
    [distance, length].map(at_least)
}

/// Returns the header of the columns of [`scan_line`].
pub(crate) fn scan_header(question: Question) -> String {
    let travel = match question {
        Question::Contact => "translation",
        Question::Clearance => "distance",
    };
    let columns = ["outcome", travel, "length", "normal"].map(str::to_owned);
    format!("{:<24} {}\n", "direction", align_columns(&columns))
}

/// Joins columns with fixed widths.
fn align_columns(columns: &[String]) -> String {
    let mut text = String::new();
    for (column, width) in columns.iter().zip([11, 19, 19, 0]) {
        let _ = write!(text, "{column:<width$} ");
    }
    text.truncate(text.trim_end().len());
    text
}

/// Returns a translation that is known to within `error`, and its length.
fn translation_text(t: f64, error: f64, direction: DVec3) -> String {
    let length = direction.length();
    let shown = estimate(t * length, error * length);
    format!("{} times the direction, a length of {shown}", estimate(t, error))
}

/// Returns a translation that is safe to move by, and its length. The known digits of `t` are used if the rounded number
/// does not exceed `limit`, the travel of the offset bodies. Otherwise the proven bound `lower` is rounded down.
pub(crate) fn safe_travel(
    t: f64,
    error: f64,
    [lower, limit]: [f64; 2],
    direction: DVec3,
) -> String {
    let length = direction.length();
    let shown = [estimate(t, error), estimate(t * length, error * length)];
    let limits = [limit, (1.0 - 4.0 * f64::EPSILON) * limit * length];
    let is_safe = |(text, limit): (&String, f64)| text.parse::<f64>().is_ok_and(|t| t <= limit);
    let all = shown.iter().zip(limits).all(is_safe);
    let [travel, length] = if all { shown } else { safe_distance(Some(lower), direction) };
    format!("{travel} times the direction, a length of {length}")
}

/// Returns the translation of the last contact, and the bound after which the bodies never meet.
fn exit_text(last: &Contact, direction: DVec3) -> String {
    let Bounded { value, upper, .. } = last.exit();
    let shown = translation_text(value, last.certificate.rounding, direction);
    format!("{shown}; never after {}", at_most(upper))
}

/// Appends the translations of the first and the last contact.
fn push_range(text: &mut String, first: &Contact, last: &Contact, direction: DVec3) {
    // For bodies that slide, the contact under the assumption that their overlap is real.
    let remark = match (ContactRange::Contact { first: *first, last: *last }).clearance() {
        Clearance::Free(FreeReason::Behind(_)) => " (the contact lies behind)",
        Clearance::Overlapping(_) => " (the bodies overlap now)",
        _ if first.translation.abs() <= first.certificate.rounding => " (the bodies touch)",
        _ => "",
    };
    let translation = translation_text(first.translation, first.certificate.rounding, direction);
    push_line(text, "translation", &format!("{translation}{remark}"));
    push_line(text, "exit", &exit_text(last, direction));
}

/// Appends the normal, the point, the features, the bounds and the work of a contact.
fn push_contact(text: &mut String, first: &Contact, context: &Context<'_>) {
    let Context { record, direction, extent } = context;
    let proof = &first.certificate;
    push_line(text, "normal", &unit_vector(first.normal));
    if let Some(place) = record.point {
        let error = proof.rounding * direction.length();
        push_line(text, "point", &point(place.into(), error, *extent));
    }
    push_features(text, record.features.as_ref(), [None; 2]);
    let bounds = if proof.upper.is_finite() {
        format!(
            "{}; with all digits the gap is {} (rounding alone: up to {})",
            interval([proof.lower, proof.upper]),
            error_bound(proof.gap()),
            error_bound(proof.rounding)
        )
    } else {
        let bounds = interval([proof.lower, proof.upper]);
        format!("{bounds}; rounding does not resolve whether they touch")
    };
    push_line(text, "bounds", &bounds);
    push_line(text, "solver", &work_text(first.solver, first.steps));
}

/// Appends the sideways overlap of bodies that slide along each other.
fn push_overlap(text: &mut String, grazing: &Grazing) {
    let direction = unit_vector(grazing.separating_direction);
    push_line(
        text,
        "overlap",
        &format!("{} sideways, along {direction}", six_digits(grazing.overlap)),
    );
    text.push_str("  the contact, if the overlap is real:\n");
}

/// Appends the margin, the normal and the work of a separation.
fn push_separation(text: &mut String, separation: &Separated) {
    let margin = separation.certificate.margin;
    push_line(
        text,
        "margin",
        &format!("{}, the gap between the projections along this normal", at_least(margin)),
    );
    let normal = unit_vector(separation.certificate.normal);
    push_line(text, "normal", &format!("{normal} of the separating plane"));
    push_line(text, "solver", &work_text(separation.solver, separation.steps));
}

/// Returns the verb for bodies that touch, or come as near as the minimum gap.
pub(crate) fn meet_verb(min_gap: Option<f64>) -> String {
    min_gap.map_or("meet".into(), |gap| format!("come as near as {}", length_down(gap)))
}

/// Returns the statement about bodies that are free throughout a motion. With a tolerance they may overlap.
pub(crate) fn never_statement(record: &MotionRecord) -> String {
    let meet = meet_verb(record.min_gap);
    match record.tolerance {
        None => format!("the bodies never {meet}"),
        // Only proofs of convex bodies have planes: their tolerance is a depth. Solids are offset.
        Some(depth) if record.planes.is_some() => {
            format!("the bodies never overlap by more than {}", length_up(depth))
        }
        Some(_) => {
            format!("the bodies, each offset inwards by half of the tolerance, never {meet}")
        }
    }
}

/// Appends the minimum gap, if there is one.
pub(crate) fn push_min_gap(text: &mut String, min_gap: Option<f64>) {
    if let Some(gap) = min_gap {
        let what = "at which the bodies count as meeting";
        push_line(text, "minimum gap", &format!("{}, {what}", length_down(gap)));
    }
}

/// Appends the excess of hulls over their meshes, and the meaning of the answer for the meshes.
pub(crate) fn push_hulls(text: &mut String, hulls: Option<Hulls>, outcome: Ending, is_depth: bool) {
    let Some(hulls) = hulls else { return };
    for (name, excess) in hulls.named_excesses() {
        push_line(text, name, &excess.to_string());
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
            format!("a bound for {whose}: separated by this translation, perhaps by a shorter one")
        }
        Ending::Overlapping => {
            format!("a bound for {whose}: free after these translations, perhaps no overlap at all")
        }
        Ending::Apart => format!("a bound for {whose}: no nearer to each other, perhaps farther"),
        Ending::Meeting | Ending::Touching => {
            format!("no statement about {whose}, perhaps apart from each other")
        }
        Ending::Closer | Ending::Undecided => {
            format!("no statement about {whose}, perhaps farther from each other")
        }
        Ending::Contact | Ending::Blocked | Ending::Free | Ending::Error => {
            format!("a bound for {whose}: no contact before this one, perhaps later or none")
        }
    };
    push_line(text, "so this is", &meaning);
    if dropped > 0.0 {
        let near = format!("at most {} beyond a hull, which were dropped", six_digits(dropped));
        push_line(text, "except for", &format!("points of {whose} {near}"));
    }
}

/// Appends a line with a name and a value.
pub(crate) fn push_line(text: &mut String, name: &str, value: &str) {
    let _ = writeln!(text, "  {name:<12} {value}");
}

/// Appends a line for each feature in contact, with the name of its file if there is one.
pub(crate) fn push_features(
    text: &mut String,
    features: Option<&FeaturesRecord>,
    files: [Option<&str>; 2],
) {
    let Some(FeaturesRecord { moving, fixed }) = features else { return };
    for (name, what, file) in [("moving", moving, files[0]), ("fixed", fixed, files[1])] {
        let file = file.map_or(String::new(), |file| format!(" of {}", escape_line(file)));
        push_line(text, name, &format!("{}{file}", feature_text(what)));
    }
}

/// Returns the kind of a feature and its vertices, at most [`MAX_VERTICES`] of them.
fn feature_text(feature: &FeatureRecord) -> String {
    let count = feature.vertices.len();
    let mut text = feature.kind.to_owned();
    if count != 1 {
        text.push_str(" of vertices");
    }
    for vertex in feature.vertices.iter().take(MAX_VERTICES) {
        let _ = write!(text, " {vertex}");
    }
    if count > MAX_VERTICES {
        let _ = write!(text, " ... ({count} in all)");
    }
    text
}

/// Returns the name of the solver and the work of its search.
fn work_text(solver: Solver, steps: Steps) -> String {
    let Steps { planar_problems, supports, pivots, .. } = steps;
    let sections = match steps {
        Steps { planar_problems: 0, .. } => String::new(),
        // The first iteration ended the search, so no region was cut.
        Steps { iterations, region_sides: 0, .. } => format!(" ({iterations} iterations)"),
        Steps { iterations, region_sides, .. } => {
            format!(" ({iterations} iterations; a region of at most {region_sides} sides)")
        }
    };
    format!(
        "{solver}: {planar_problems} planar problems{sections}, {supports} supports, {pivots} pivots"
    )
}

/// Returns the options that permit overlaps at the start.
pub(crate) fn overlap_hint(overlaps: &[StartOverlapRecord]) -> &'static str {
    if overlaps.iter().all(|overlap| overlap.least_tolerance.is_some()) {
        "--tolerance permits it, --ignore-start-overlaps ignores it"
    } else {
        "--ignore-start-overlaps ignores it"
    }
}

/// Appends a line for each pair of files that overlap at the start.
pub(crate) fn push_start_overlaps(text: &mut String, overlaps: &[StartOverlapRecord], name: &str) {
    for StartOverlapRecord { moving, fixed, least_tolerance } in overlaps {
        let [moving, fixed] =
            [moving, fixed].map(|name| escape_line(name.as_deref().unwrap_or_default()));
        let remedy = match least_tolerance {
            Some(least) => format!("a tolerance of {} would separate them", length_up(*least)),
            None => "no tolerance would separate them".into(),
        };
        push_line(text, name, &format!("{moving} in {fixed}: {remedy}"));
    }
}
