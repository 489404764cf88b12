//! Casts of bodies that do not turn, by the faces of their difference, against the ordinary cast.
//!
//! Places and directions are made of a setting's own: near it and far, and such that the line passes a vertex of
//! `M`, the middle of two or the middle of many, which is where ties are.

use colltrans::{Approach, Cast, FixedRotations, Outcome, Pose, QueryError};
use glam::DVec3;

use crate::oracle::check::{Judge, Objection};
use crate::oracle::settings::{Bodies, Setting};
use crate::oracle::tracked::{Agreement, judge_answer};
use crate::random::Random;
use crate::shapes::reach;

/// What is asked of one setting, itself among them.
pub const CASTS: usize = 8;

/// Who answered what, and whether it is right.
pub type Finding = (&'static str, Outcome, Result<Agreement, Objection>);

/// What both ways of asking for a cast answer. All answers are checked exactly, and solved again if `with_oracle` or
/// where the certificate alone does not prove them.
///
/// # Errors
/// Where one way has no answer and the ordinary cast has; if neither has, there is nothing to judge.
pub fn ask<'a>(
    rotations: &FixedRotations<'a>,
    approach: &Approach<'_, 'a>,
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
                let judged = judged.and_then(|agreement| overlapping(&answer, ordinary, agreement));
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

/// Bounds of both have the true translation between them, so they overlap.
fn overlapping(
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

/// One cast of a setting's bodies as they are turned: the first is the setting's own.
///
/// # Errors
/// A place or a direction out of range.
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
    // From whose frames the line through a point of `M` is the axis.
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
