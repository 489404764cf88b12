//! Statements as text, each in one line.

use std::fmt;

use super::file::{Choices, Query};
use super::statement::{Contacts, DistanceStatement, FreeStatement, Slide, SolidStatement, Stop};
use super::{ProofFile, Statement, motion};
use colltrans_convex::answer::{Bounded, Depth, Separation};
use colltrans_convex::body::ObstacleId;
use colltrans_removal::directions::CellProof;
use colltrans_scene::{ClearanceProof, NearbyProof, NearestProof};
use colltrans_solid::cast::{SolidCertificate, StartOverlap, StartProof};
use colltrans_solid::pair::DistanceCertificate;
use colltrans_solid::penetration::{CommonPartCertificate, DepthCertificate, ProvenRelation};

/// Maximum number of obstacles that a text names.
const MAX_NAMED: usize = 12;

impl fmt::Display for ProofFile {
    /// Writes the statement as one line of text. Translations are multiples of the direction.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.query, &self.statement) {
            (Query::Cast(along), _) if along.min_gap > 0.0 => {
                let min_gap = along.min_gap;
                write!(f, "counted as meeting where they are {min_gap:?} apart or nearer, ")?;
                // Facets may be closer than the minimum gap by up to eight noises.
                if matches!(self.statement, Statement::Clearance(_)) {
                    f.write_str("to within rounding, ")?;
                }
            }
            (Query::Scene(choices), statement) => {
                write!(f, "of {} obstacles, ", self.obstacle_count().unwrap_or_default())?;
                if let Statement::SceneClearance(_) = statement {
                    choices.write_text(f)?;
                }
            }
            _ => {}
        }
        match (&self.query, &self.statement) {
            (Query::Motions(pair_options), Statement::Motions(of)) => {
                f.write_str(&motion::text(pair_options, of))?;
            }
            (Query::Path(joints), Statement::Path(of)) => of.write_text(f, joints)?,
            (_, statement) => statement.write_text(f)?,
        }
        let [moving, fixed] = self.inverted_facets();
        if [moving, fixed] == [0; 2] {
            return Ok(());
        }
        write!(
            f,
            "; at this offset {moving} facets of moving bodies and {fixed} of fixed ones are inside out: where a \
             body is thinner than the tolerance, the statement does not cover its original surface"
        )
    }
}

impl Choices {
    fn write_text(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { min_gap, tolerance, graze_tolerance, .. } = *self;
        if min_gap > 0.0 {
            write!(f, "counted as met where they are {min_gap:?} away or nearer, ")?;
        }
        if graze_tolerance > 0.0 {
            write!(f, "passed where they overlap sideways by no more than {graze_tolerance:?}, ")?;
        }
        if let Some(tolerance) = tolerance.filter(|by| *by > 0.0) {
            write!(f, "solids shrunk by {:?} each, ", tolerance / 2.0)?;
        }
        Ok(())
    }
}

impl Statement {
    fn write_text(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Contacts(contacts) => fmt::Display::fmt(contacts, f),
            Self::Separation(Separation { margin, .. }) => {
                write!(
                    f,
                    "the bodies never meet along the direction, because their shadows are at least {margin:?} apart"
                )
            }
            Self::Clearance(statement) => fmt::Display::fmt(statement, f),
            Self::Distance(DistanceStatement { gap, near }) => {
                let near = near.as_ref().map(|near| near.distance);
                f.write_str(&distance_text(gap.map(|gap| gap.gap), near))
            }
            Self::Depth(Depth { upper: 0.0, .. }) => write!(f, "the bodies do not overlap"),
            Self::Depth(Depth { lower, upper, direction, .. }) => write!(
                f,
                "a translation of the moving body by {upper:?} along {:?} separates the bodies, none below \
                 {lower:?} does",
                direction.to_array()
            ),
            Self::SolidDistance(DistanceCertificate { lower, near, .. }) => {
                let lower = Some(*lower).filter(|lower| *lower > 0.0);
                f.write_str(&distance_text(lower, Some(near.distance())))
            }
            Self::SolidDepth(DepthCertificate { lower, upper, translation, .. }) => write!(
                f,
                "the bodies are apart after a translation of at most {upper:?}, of the moving one to {:?}; no \
                 translation below {lower:?} separates their interiors",
                translation.to_array()
            ),
            Self::SolidCommonPart(of) => write_common_part(of, f),
            Self::FreeDirections(statement) => fmt::Display::fmt(statement, f),
            Self::Nearest(NearestProof { lower, obstacle, near, .. }) => {
                let upper = near.distance();
                write!(
                    f,
                    "obstacle {obstacle} is at most {upper:?} away, none is nearer than {lower:?}"
                )
            }
            Self::Within(NearbyProof { length, closer, undecided, .. }) => {
                let closer: Vec<ObstacleId> = closer.iter().map(|(id, _)| *id).collect();
                let (which, is) = obstacle_list(&closer);
                if undecided.is_empty() {
                    write!(f, "{which} {is} at most {length:?} away")?;
                } else {
                    let open = obstacle_list(undecided).0;
                    write!(f, "{which} {is} proven to be at most {length:?} away, {open} may be")?;
                }
                f.write_str(", all others are farther")
            }
            Self::SceneClearance(ClearanceProof { stop: None, lower, .. })
                if lower.is_infinite() =>
            {
                f.write_str("none ever stops the moving body")
            }
            Self::SceneClearance(of) => {
                let ClearanceProof { lower, stop, .. } = of;
                let Some(stop) = stop else {
                    return write!(
                        f,
                        "none stops the moving body before a translation of {lower:?}"
                    );
                };
                match of.upper() {
                    upper if upper <= 0.0 => {
                        write!(f, "obstacle {stop} overlaps the moving body, or stops it at once")
                    }
                    upper => write!(
                        f,
                        "none stops the moving body before a translation of {lower:?}, obstacle {stop} does by {upper:?}"
                    ),
                }
            }
            // The caller writes these statements together with their queries.
            Self::Motions(_) | Self::Path(_) => Ok(()),
        }
    }
}

impl fmt::Display for FreeStatement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.tolerance > 0.0 {
            write!(f, "shrunk by {:?} each, ", self.tolerance / 2.0)?;
        }
        let count = |of: fn(&CellProof) -> bool| self.cells.iter().filter(|cell| of(cell)).count();
        let cells = count(|cell| !matches!(cell, CellProof::Cut));
        let blocked = count(|cell| matches!(cell, CellProof::Blocked(_)));
        let inner = count(|cell| matches!(cell, CellProof::Inner(_)));
        let undecided = count(|cell| matches!(cell, CellProof::Undecided(_)));
        let exactly = cells - blocked - inner - undecided;
        let inside = if inner > 0 {
            format!("{inner} by a pair of boxes inside the bodies each, ")
        } else {
            String::new()
        };
        write!(
            f,
            "of {cells} cells of the sphere of directions {blocked} are blocked by a pair of facets each, \
             {inside}{exactly} are decided exactly, {undecided} are undecided"
        )
    }
}

/// Writes the claims about a common part.
fn write_common_part(of: &CommonPartCertificate, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let CommonPartCertificate { volume: [lower, upper], relation, bounds, .. } = of;
    f.write_str(match relation {
        Some(ProvenRelation::Disjoint) => return f.write_str("the interiors have no common point"),
        Some(ProvenRelation::Crossing { .. }) => "no body contains the other, ",
        Some(ProvenRelation::MovingContained) => "the fixed body contains the moving one, ",
        Some(ProvenRelation::FixedContained) => "the moving body contains the fixed one, ",
        _ => "",
    })?;
    write!(f, "the common part of the interiors has a volume between {lower:?} and {upper:?}")?;
    if let Some(bounds) = bounds {
        let [low, high] = [bounds.low, bounds.high].map(|corner| corner.to_array());
        write!(f, ", in the box from {low:?} to {high:?}")?;
    }
    Ok(())
}

/// Returns the bounds of a distance as text.
fn distance_text(lower: Option<f64>, upper: Option<f64>) -> String {
    match (lower, upper) {
        (_, Some(0.0)) => "the bodies have a point in common".into(),
        (Some(a), Some(b)) => format!("the bodies are between {a:?} and {b:?} apart"),
        (Some(a), None) => format!("the bodies are at least {a:?} apart"),
        (None, Some(b)) => format!("the bodies are at most {b:?} apart"),
        (None, None) => "nothing".into(),
    }
}

impl fmt::Display for Contacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(Slide { overlap, .. }) = self.slide {
            write!(
                f,
                "the bodies slide along each other, their shadows overlap by at most {overlap:?}; "
            )?;
        }
        match self.bounds() {
            [Some([a, b]), Some([c, d])] if b.is_finite() && c.is_finite() => {
                write!(
                    f,
                    "the bodies meet from a translation between {a:?} and {b:?} to one between {c:?} and {d:?}"
                )
            }
            [Some([a, _]), Some([_, d])] => {
                write!(f, "the bodies meet at no translation below {a:?} or above {d:?}")
            }
            [Some([a, b]), None] if b.is_finite() => {
                write!(f, "the bodies first meet at a translation between {a:?} and {b:?}")
            }
            [Some([a, _]), None] => write!(f, "the bodies meet at no translation below {a:?}"),
            [None, Some([c, d])] if c.is_finite() => {
                write!(f, "the bodies last meet at a translation between {c:?} and {d:?}")
            }
            [None, Some([_, d])] => write!(f, "the bodies meet at no translation above {d:?}"),
            [None, None] => write!(f, "nothing"),
        }
    }
}

impl fmt::Display for SolidStatement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let SolidCertificate { tolerance, start, lower, .. } = &self.certificate;
        if *tolerance > 0.0 {
            write!(f, "shrunk by {:?} each, ", tolerance / 2.0)?;
        }
        let overlapping = matches!(start, StartProof::Overlapping(_));
        f.write_str(if overlapping {
            "the bodies overlap where they are"
        } else {
            "the bodies do not overlap where they are"
        })?;
        if overlapping && self.start_overlap == StartOverlap::Refuse {
            return Ok(());
        }
        let later = if overlapping { " that touches later" } else { "" };
        match self.stop {
            None => write!(f, ", and nothing{later} ever stops the moving one"),
            Some(Stop { translation, .. }) => write!(
                f,
                ", and nothing{later} stops the moving one before a translation of {lower:?}; {}",
                contact_bounds_text(translation)
            ),
        }
    }
}

/// Returns the bounds of the contact of the blocking facets as text.
fn contact_bounds_text(Bounded { lower, upper, .. }: Bounded) -> String {
    match [lower.is_finite(), upper.is_finite()] {
        [true, true] => {
            format!("the blocking facets meet in nominal position between {lower:?} and {upper:?}")
        }
        [true, false] => {
            format!("the blocking facets meet in nominal position not before {lower:?}")
        }
        [false, true] => format!("the blocking facets meet in nominal position by {upper:?}"),
        [false, false] => {
            "no claim is made where the blocking facets meet in nominal position".into()
        }
    }
}

/// Returns a body's name for a sentence. It is quoted unless it is one word of letters, digits and `_-.:/`.
pub(super) fn quoted_name(name: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "_-.:/".contains(c);
    if !name.is_empty() && name.chars().all(is_plain) { name.into() } else { format!("{name:?}") }
}

/// Returns the number and the indices of obstacles as text, and the verb that follows.
fn obstacle_list(of: &[ObstacleId]) -> (String, &'static str) {
    let named: Vec<String> = of.iter().take(MAX_NAMED).map(ToString::to_string).collect();
    let more = if of.len() > MAX_NAMED { ", ..." } else { "" };
    let (count, is) = (of.len(), if of.len() == 1 { "is" } else { "are" });
    if of.is_empty() {
        ("none".into(), "is")
    } else {
        (format!("{count} ({}{more})", named.join(", ")), is)
    }
}
