//! Compares trackers with single queries along a sequence of settings.
//!
//! A *lane* is a tracker with one focus and one sequence of solvers, which is used for the whole sequence of
//! settings. Its answer must equal that of a single query: the same outcome, translations that agree, and a
//! valid certificate.

use colltrans::{
    Contact, Focus, Grazing, Outcome, QueryError, Solver, StartedFrom, Steps, Tracker, cta,
};

use crate::oracle::check::{Judge, Objection, Proof, compare_answers};
use crate::oracle::settings::{Bodies, Setting};
use crate::shapes::reach;

/// A tracker's solvers and focus.
#[derive(Debug, Clone, Copy)]
pub struct TrackedSequence {
    /// The name in reports.
    pub name: &'static str,
    /// The solvers, used in turn.
    pub solvers: &'static [Solver],
    /// The focus.
    pub focus: Focus,
}

/// Returns the lanes for bodies with this reach, which determines the size of the fixed region.
pub fn lanes(reach: f64) -> [TrackedSequence; 7] {
    let (auto, cta) = (&[Solver::Auto][..], &[Solver::Cta][..]);
    let lane = |name, solvers, features, region| {
        let focus = Focus::NONE.with_features(features).with_region(region);
        TrackedSequence { name, solvers, focus }
    };
    [
        lane("auto", auto, true, cta::Region::Automatic),
        lane("auto, features", auto, true, cta::Region::Everywhere),
        lane("cta", cta, true, cta::Region::Automatic),
        lane("cta, features", cta, true, cta::Region::Everywhere),
        lane("cta, region", cta, false, cta::Region::Automatic),
        lane("cta, fixed region", cta, false, cta::Region::Fixed(0.05 * reach)),
        lane("in turn", &[Solver::Cta, Solver::Auto, Solver::Portal], true, cta::Region::Automatic),
    ]
}

/// The answer of a lane with its verdict.
#[derive(Debug, Clone)]
pub struct Finding {
    /// The lane.
    pub lane: &'static str,
    /// The solver.
    pub solver: Solver,
    /// The answer.
    pub answer: Result<Outcome, QueryError>,
    /// The verdict.
    pub verdict: Result<Agreement, Objection>,
}

/// The properties of a correct answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// The data with which the search started.
    pub path: StartedFrom,
    /// The properties of its proof.
    pub proof: Proof,
    /// Whether outcome or value differ from those of the single query, and both are admissible, because
    /// rounding decides at the boundary of the shadows.
    pub rounding_decides: bool,
}

/// The lanes of two bodies.
#[derive(Debug, Clone)]
pub struct Lanes<'a> {
    bodies: &'a Bodies,
    trackers: Vec<(TrackedSequence, Tracker<'a>)>,
    asked: usize,
}

impl<'a> Lanes<'a> {
    /// Builds all trackers.
    ///
    /// # Panics
    /// Never, because the regions have a positive size.
    pub fn new(bodies: &'a Bodies) -> Self {
        let reach = reach(bodies.moving.vertices()).max(reach(bodies.fixed.vertices()));
        let tracker = |lane: TrackedSequence| {
            let tracker = Tracker::new().with_focus(lane.focus);
            (lane, tracker.expect("a region with a size"))
        };
        Self { bodies, trackers: lanes(reach).map(tracker).to_vec(), asked: 0 }
    }

    /// Queries every lane, and judges the answers. All are checked exactly. The oracle solves a query if
    /// `with_oracle`, or if outcome and value are not proven by the certificate alone.
    ///
    /// Returns an empty list if the setting is not a valid query.
    pub fn ask(&mut self, setting: &Setting, with_oracle: bool) -> Vec<Finding> {
        let bodies = self.bodies;
        let Ok(cast) = setting.query(bodies) else { return Vec::new() };
        let from_scratch =
            [Solver::Auto, Solver::Cta].map(|solver| cast.with_solver(solver).first_contact());
        let asked = self.asked;
        self.asked += 1;
        let judge = Judge::new(cast).with_input(&setting.moving, &setting.fixed);
        let find = |(lane, tracker): &mut (TrackedSequence, Tracker<'a>)| {
            let solver = lane.solvers[asked % lane.solvers.len()];
            let answer = tracker.first_contact(&cast.with_solver(solver));
            // `Auto` stands for `Portal`.
            let one_off = &from_scratch[usize::from(solver == Solver::Cta)];
            let verdict = judge_tracked(&judge, &answer, one_off, with_oracle);
            Finding { lane: lane.name, solver, answer, verdict }
        };
        self.trackers.iter_mut().map(find).collect()
    }
}

/// Returns the answer of a tracker for a setting.
///
/// # Errors
/// The errors of [`Setting::query`] and [`Tracker::first_contact`].
pub fn track<'a>(
    tracker: &mut Tracker<'a>,
    setting: &Setting,
    bodies: &'a Bodies,
    solver: Solver,
) -> Result<Outcome, QueryError> {
    tracker.first_contact(&setting.query(bodies)?.with_solver(solver))
}

/// Judges an answer of a tracker.
fn judge_tracked(
    judge: &Judge,
    answer: &Result<Outcome, QueryError>,
    one_off: &Result<Outcome, QueryError>,
    with_oracle: bool,
) -> Result<Agreement, Objection> {
    let answer = answer.as_ref().map_err(|e| Objection(format!("tracked: {e}")))?;
    let one_off = one_off.as_ref().map_err(|e| Objection(format!("one-off: {e}")))?;
    let judged = judge_answer(judge, answer, one_off, with_oracle);
    judged.map_err(|objection| match judge_alone(judge, one_off, true) {
        Ok(_) => objection,
        Err(same) => Objection(format!("{objection}; the one-off answer: {same}")),
    })
}

/// Judges an answer by itself.
fn judge_alone(judge: &Judge, answer: &Outcome, with_oracle: bool) -> Result<Proof, Objection> {
    let proof = judge.check(answer)?;
    verify_certificate(judge, answer)?;
    if with_oracle || !proof.exact {
        judge.compare_with_oracle(answer)?;
    }
    Ok(proof)
}

/// Judges an answer by itself, and compares it with that of a single query.
pub(crate) fn judge_answer(
    judge: &Judge,
    answer: &Outcome,
    one_off: &Outcome,
    with_oracle: bool,
) -> Result<Agreement, Objection> {
    let difference = compare_answers(answer, one_off).err();
    let rounding_decides = difference.is_some();
    let judged = judge_alone(judge, answer, with_oracle || rounding_decides);
    let proof = match (judged, difference) {
        (Ok(proof), Some(_)) => judge.compare_with_oracle(one_off).map(|()| proof),
        (Err(objection), Some(difference)) => Err(Objection(format!("{difference}; {objection}"))),
        (judged, None) => judged,
    }?;
    Ok(Agreement { path: answer.steps().started_from, proof, rounding_decides })
}

/// Checks the certificate with the library, and the gap that it states.
fn verify_certificate(judge: &Judge, answer: &Outcome) -> Result<(), Objection> {
    let refused = |e| Objection(format!("rejected by verify: {e}"));
    match answer {
        Outcome::Contact(Contact { certificate, .. })
        | Outcome::Grazing(Grazing { contact: Contact { certificate, .. }, .. }) => {
            judge.cast.verify(certificate).map_err(refused)?;
            let (gap, tolerance) = (certificate.gap(), certificate.rounding);
            if gap <= tolerance || matches!(answer, Outcome::Grazing(_)) {
                Ok(())
            } else {
                Err(Objection(format!("gap {gap:e}, tolerance {tolerance:e}")))
            }
        }
        Outcome::Separated(separated) => {
            judge.cast.verify(&separated.certificate).map(|_| ()).map_err(refused)
        }
    }
}

/// Returns an answer without its statistics. The remaining bits must be equal if the same work was done in the
/// same order.
#[must_use]
pub fn ignoring_steps(outcome: &Outcome) -> Outcome {
    let mut outcome = *outcome;
    match &mut outcome {
        Outcome::Contact(contact) | Outcome::Grazing(Grazing { contact, .. }) => {
            contact.steps = Steps::default();
        }
        Outcome::Separated(separated) => separated.steps = Steps::default(),
    }
    outcome
}
