//! Trackers against one-off queries: the same question asked of both, along a sequence of settings.
//!
//! A *lane* is a tracker with one focus and one solver that lives through the whole sequence. Its
//! answer must be the one-off answer: the same outcome, translations that agree, and a certificate
//! that holds by itself.

use colltrans::{
    Contact, Focus, Grazing, Outcome, QueryError, Solver, StartedFrom, Steps, Tracker, cta,
};

use crate::oracle::check::{Judge, Objection, Proof, same};
use crate::oracle::settings::{Bodies, Setting};
use crate::shapes::reach;

/// A tracker's solver and focus.
#[derive(Debug, Clone, Copy)]
pub struct Lane {
    /// Its name in reports.
    pub name: &'static str,
    /// One solver after the other.
    pub solvers: &'static [Solver],
    /// The focus.
    pub focus: Focus,
}

/// The lanes for bodies with this reach: the region of a fixed size is a part of it.
pub fn lanes(reach: f64) -> [Lane; 7] {
    let (auto, cta) = (&[Solver::Auto][..], &[Solver::Cta][..]);
    let lane = |name, solvers, features, region| {
        let focus = Focus::NONE.with_features(features).with_region(region);
        Lane { name, solvers, focus }
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

/// What a lane's answer was found to be.
#[derive(Debug, Clone)]
pub struct Finding {
    /// The lane.
    pub lane: &'static str,
    /// The solver that it was given.
    pub solver: Solver,
    /// The answer.
    pub answer: Result<Outcome, QueryError>,
    /// What is right about it, or wrong.
    pub verdict: Result<Agreement, Objection>,
}

/// An answer that is right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// What the search began with.
    pub path: StartedFrom,
    /// What the answer proves.
    pub proof: Proof,
    /// It is not the one-off outcome, or not its value, and both are admissible: the shadows' rim
    /// is where rounding decides.
    pub rounding_decides: bool,
}

/// The lanes of two bodies.
#[derive(Debug, Clone)]
pub struct Lanes<'a> {
    bodies: &'a Bodies,
    trackers: Vec<(Lane, Tracker<'a>)>,
    asked: usize,
}

impl<'a> Lanes<'a> {
    /// All trackers new.
    ///
    /// # Panics
    /// Never: the regions have a size.
    pub fn new(bodies: &'a Bodies) -> Self {
        let reach = reach(bodies.moving.vertices()).max(reach(bodies.fixed.vertices()));
        let tracker = |lane: Lane| {
            let tracker = Tracker::new().with_focus(lane.focus);
            (lane, tracker.expect("a region with a size"))
        };
        Self { bodies, trackers: lanes(reach).map(tracker).to_vec(), asked: 0 }
    }

    /// Asks every lane about a setting, and says what is to be said of the answers. All are checked
    /// exactly; they are solved again by the oracle if `with_oracle`, and where outcome and value
    /// are not proven by the certificate alone.
    ///
    /// A setting that makes no query is not asked about.
    pub fn ask(&mut self, setting: &Setting, with_oracle: bool) -> Vec<Finding> {
        let bodies = self.bodies;
        let Ok(cast) = setting.query(bodies) else { return Vec::new() };
        let from_scratch =
            [Solver::Auto, Solver::Cta].map(|solver| cast.with_solver(solver).first_contact());
        let asked = self.asked;
        self.asked += 1;
        let judge = Judge::new(cast).with_input(&setting.moving, &setting.fixed);
        let find = |(lane, tracker): &mut (Lane, Tracker<'a>)| {
            let solver = lane.solvers[asked % lane.solvers.len()];
            let answer = tracker.first_contact(&cast.with_solver(solver));
            // Portal is what Auto stands for.
            let one_off = &from_scratch[usize::from(solver == Solver::Cta)];
            let verdict = judge_tracked(&judge, &answer, one_off, with_oracle);
            Finding { lane: lane.name, solver, answer, verdict }
        };
        self.trackers.iter_mut().map(find).collect()
    }
}

/// A tracker's answer about a setting.
///
/// # Errors
/// As [`Setting::query`] and [`Tracker::first_contact`].
pub fn track<'a>(
    tracker: &mut Tracker<'a>,
    setting: &Setting,
    bodies: &'a Bodies,
    solver: Solver,
) -> Result<Outcome, QueryError> {
    tracker.first_contact(&setting.query(bodies)?.with_solver(solver))
}

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

/// Everything that an answer says, by itself.
fn judge_alone(judge: &Judge, answer: &Outcome, with_oracle: bool) -> Result<Proof, Objection> {
    let proof = judge.check(answer)?;
    verify(judge, answer)?;
    if with_oracle || !proof.exact {
        judge.compare_with_oracle(answer)?;
    }
    Ok(proof)
}

/// An answer that was not found by the ordinary way, beside one that was.
pub(crate) fn judge_answer(
    judge: &Judge,
    answer: &Outcome,
    one_off: &Outcome,
    with_oracle: bool,
) -> Result<Agreement, Objection> {
    let difference = same(answer, one_off).err();
    let rounding_decides = difference.is_some();
    let judged = judge_alone(judge, answer, with_oracle || rounding_decides);
    let proof = match (judged, difference) {
        (Ok(proof), Some(_)) => judge.compare_with_oracle(one_off).map(|()| proof),
        (Err(objection), Some(difference)) => Err(Objection(format!("{difference}; {objection}"))),
        (judged, None) => judged,
    }?;
    Ok(Agreement { path: answer.steps().started_from, proof, rounding_decides })
}

/// The library's own check of an answer's certificate, and the gap that it states.
fn verify(judge: &Judge, answer: &Outcome) -> Result<(), Objection> {
    let refused = |e| Objection(format!("refused by verify: {e}"));
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

/// An answer without the account of the work done for it: what has to be the same bits where the
/// same work was done in the same order.
#[must_use]
pub fn without_steps(outcome: &Outcome) -> Outcome {
    let mut outcome = *outcome;
    match &mut outcome {
        Outcome::Contact(contact) | Outcome::Grazing(Grazing { contact, .. }) => {
            contact.steps = Steps::default();
        }
        Outcome::Separated(separated) => separated.steps = Steps::default(),
    }
    outcome
}
