//! Compares casts without rotation, by the faces of the Minkowski difference, with normal casts.
//!
//! Positions and directions are derived from a setting: near it and far from it, and so that the line passes a
//! vertex of `M`, or the mean of two or four points of `M`, where ties occur.

use colltrans::{Cast, DirectionMap, FixedRotations, Outcome, Pose, QueryError};
use glam::DVec3;

use crate::oracle::check::{Judge, Objection};
use crate::oracle::settings::{Bodies, Setting};
use crate::oracle::tracked::{Agreement, judge_answer};
use crate::random::Random;
use crate::shapes::reach;

/// Number of casts for a setting, including its own.
pub const CASTS: usize = 8;

/// The method, its outcome, and the verdict.
pub type Finding = (&'static str, Outcome, Result<Agreement, Objection>);

/// Answers a cast by both bulk methods. All answers are checked exactly. The oracle solves the cast if
/// `with_oracle`, or if the certificate alone does not prove an answer.
///
/// # Errors
/// [`Objection`] if a method has no answer and the normal cast has one. If neither has an answer, nothing is
/// judged.
pub fn ask<'a>(
    rotations: &FixedRotations<'a>,
    approach: &DirectionMap<'_, 'a>,
    cast: &Cast<'a>,
    setting: &Setting,
    with_oracle: bool,
) -> Result<Vec<Finding>, Objection> {
    let ordinary = cast.first_contact();
    let judge = Judge::new(*cast).with_input(&setting.moving, &setting.fixed);
    let answers = [
        ("any direction", rotations.first_contact(cast)),
        ("one direction", approach.first_contact(cast)),
    ];
    let mut findings = Vec::new();
    for (who, answer) in answers {
        match (answer, &ordinary) {
            (Ok(answer), Ok(ordinary)) => {
                let judged = judge_answer(&judge, &answer, ordinary, with_oracle);
                let judged = judged
                    .and_then(|agreement| check_overlapping_bounds(&answer, ordinary, agreement));
                findings.push((who, answer, judged));
            }
            (Err(QueryError::NotConverged { .. }), Err(QueryError::NotConverged { .. })) => {}
            (answer, _) => {
                return Err(Objection(format!("{who} {answer:?}, ordinarily {ordinary:?}")));
            }
        }
    }
    Ok(findings)
}

/// Checks that the bounds of both answers overlap, because both contain the exact translation.
fn check_overlapping_bounds(
    answer: &Outcome,
    ordinary: &Outcome,
    agreement: Agreement,
) -> Result<Agreement, Objection> {
    if let (Outcome::Contact(a), Outcome::Contact(b)) = (answer, ordinary) {
        let (a, b) = (a.certificate, b.certificate);
        if a.lower > b.upper || b.lower > a.upper {
            let text = format!(
                "{:?} to {:?}, ordinarily {:?} to {:?}",
                a.lower, a.upper, b.lower, b.upper
            );
            return Err(Objection(text));
        }
    }
    Ok(agreement)
}

/// Derives cast number `which` from a setting, with the same rotations. Number 0 is the setting's own.
///
/// # Errors
/// [`QueryError`] if a position or direction is out of range.
pub fn cast<'a>(
    setting: &Setting,
    bodies: &'a Bodies,
    which: usize,
    random: &mut Random,
) -> Result<Cast<'a>, QueryError> {
    let Setting { moving_pose, fixed_pose, direction, graze_tolerance, .. } = *setting;
    let [p, q] = [&bodies.moving, &bodies.fixed];
    let mut point = || {
        let [v, w] = [p, q].map(|body| body.vertices()[random.index(body.vertices().len())]);
        fixed_pose.transform_vector(w) - moving_pose.transform_vector(v)
    };
    // Returns the translation for which the line of the cast passes a point of `M`.
    let through = |point: DVec3| fixed_pose.translation() + point;
    let size = reach(p.vertices()) + reach(q.vertices());
    let (place, along) = match which {
        0 => (moving_pose.translation(), direction),
        1 => (moving_pose.translation(), -direction),
        2 => (through(point()) - direction, direction),
        3 => (through((point() + point()) * 0.5) - direction, direction),
        4 => (through((point() + point() + point() + point()) * 0.25) - direction, direction),
        5 => {
            let middle = (point() + point() + point() + point()) * 0.25;
            (through(middle + random.direction() * (0.5 * size)), direction)
        }
        6 => {
            let middle = (point() + point()) * 0.5;
            let along = random.direction();
            (through(middle) - along * size, along)
        }
        _ => (through(random.direction() * size), random.direction()),
    };
    let pose = Pose::from_matrix(moving_pose.matrix(), place);
    let pose = pose.map_err(|_| QueryError::Direction { direction: place })?;
    Cast::new(p.at(pose), q.at(fixed_pose), along)?.with_graze_tolerance(graze_tolerance)
}
