//! Questions about two bodies in their poses: distance, depth, and the comparison of the distance with a length.

use colltrans::glam::DVec3;
use colltrans::record::{DepthRecord, DistanceRecord, Ending, PairQuestion, Record};
use colltrans::{ByKind, Pair};

use super::answers::{Depth, Distance, Encode as _, FeatureField, Found, Within};
use super::bodies::Placement;
use super::error::{Failure, Fallible};
use super::question::Question;

/// Answers a question. Only the comparison uses the length.
pub(crate) fn answer(
    question: Question,
    placement: &Placement<'_>,
    length: f64,
) -> Fallible<Found> {
    let question = match question {
        Question::Depth => PairQuestion::Depth,
        Question::Within => PairQuestion::Within(length),
        _ => PairQuestion::Distance,
    };
    let record = match placement.placed()? {
        ByKind::Convex([moving, fixed]) => {
            let pair = Pair::new(moving, fixed)?;
            question.answer(&pair)?.record(&pair)
        }
        ByKind::Solid([moving, fixed]) => {
            let pair = Pair::new(moving, fixed)?;
            question.answer_solids(&pair)?.record(&pair)?
        }
    };
    match (record, question) {
        (Record::Distance(of), PairQuestion::Within(_)) => Ok(within(&of).found()),
        (Record::Distance(of), _) => Ok(distance(&of).found()),
        (Record::Depth(of), _) => Ok(depth(&of).found()),
        (other, _) => Err(Failure::input("", format_args!("unexpected {}", other.outcome()))),
    }
}

/// Returns the middle of two bounds. It is exact for equal bounds.
pub(crate) fn middle(lower: f64, upper: f64) -> f64 {
    if upper.is_finite() { lower + (upper - lower) / 2.0 } else { lower }
}

fn distance(of: &DistanceRecord) -> Distance {
    let (lower, upper) = (of.lower.unwrap_or(0.0), of.upper.unwrap_or(f64::INFINITY));
    let [point_on_moving, point_on_fixed] =
        of.points.map_or([None; 2], |points| points.map(|point| Some(DVec3::from_array(point))));
    Distance {
        value: middle(lower, upper),
        lower,
        upper,
        meets: of.outcome == Ending::Meeting,
        point_on_moving,
        point_on_fixed,
        normal: of.normal.map(DVec3::from_array),
        features: of
            .features
            .as_ref()
            .map(|of| [&of.moving, &of.fixed].map(FeatureField::from_record)),
    }
}

fn within(of: &DistanceRecord) -> Within {
    let closer = match of.outcome {
        Ending::Closer => Some(true),
        Ending::Farther => Some(false),
        _ => None,
    };
    Within { closer, lower: of.lower, upper: of.upper }
}

fn depth(of: &DepthRecord) -> Depth {
    let (lower, upper) = (of.lower.unwrap_or(0.0), of.upper.unwrap_or(f64::INFINITY));
    Depth {
        value: middle(lower, upper),
        lower,
        upper,
        overlaps: of.outcome == Ending::Overlapping,
        direction: of.direction.map(DVec3::from_array),
    }
}
