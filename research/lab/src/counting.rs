//! Queries without timing, for a tool that counts instructions.
//!
//! `research/lab/instructions.py` runs them under callgrind, which counts in `answer_all` only. The script divides
//! by the number of queries, and fits the costs of `solvers/cost.rs`.

use std::fmt::Write;

use colltrans::cta;
use colltrans_baselines::egjk::SupportSearch;
use colltrans_testkit::random::Random;

use crate::settings::{Meeting, Setting};
use crate::shapes::{Kind, bodies};
use crate::solvers::{Algorithm, Until, Who, Work};
use crate::statistics::mean;

/// Contestants of queries from scratch.
const SCRATCH: [Who; 13] = [
    Who::Cta(Until::End),
    Who::Cta(Until::Near),
    Who::Cta(Until::EndAcrossCells),
    Who::CtaColdScratch,
    Who::Portal,
    Who::Egjk(SupportSearch::FirstVertex),
    Who::Egjk(SupportSearch::Climbing),
    Who::Egjk(SupportSearch::Linear),
    Who::Pqp,
    Who::RayCast,
    Who::Intersects,
    Who::Mpr,
    Who::Growth,
];

/// Contestants of queries in a sequence.
const TRACKED: [Who; 6] = [
    Who::CtaRegion(cta::Region::Automatic, Until::End),
    Who::CtaCold(cta::Region::Automatic),
    Who::Tracker,
    Who::EgjkTracked,
    Who::HWalk(0.0),
    Who::VClip,
];

/// Seed of bodies and settings.
const SEED: u64 = 2007;

/// Kinds of bodies, by name.
pub const KINDS: [&str; 4] = ["balanced", "thin", "meridians", "triangles"];

/// Answers `count` queries of each contestant about bodies of a kind of [`KINDS`] with about `n` vertices. Returns a
/// line `situation,contestant,steps,iterations` for each call of `answer_all`, with means.
///
/// # Panics
/// If the kind is not in [`KINDS`].
pub fn count_queries(kind: &str, n: usize, count: usize) -> String {
    let kind = match kind {
        "balanced" => Kind::Balanced,
        "thin" => Kind::Thin,
        "meridians" => Kind::ThinMeridians,
        "triangles" => Kind::Triangles,
        _ => panic!("{kind} is not a kind of body"),
    };
    let bodies = bodies(SEED, kind, n, 0);
    let mut random = Random::stream(SEED, &[kind as u64, n as u64]);
    let mut lines = String::new();
    for (name, meeting) in
        [("colliding", Meeting::Colliding), ("passing", Meeting::PassingWithin(0.01))]
    {
        let settings: Vec<_> =
            (0..count).map(|_| Setting::draw(&bodies, meeting, &mut random)).collect();
        for who in SCRATCH {
            let mut solver = who.enter(&bodies);
            // Tables that are computed at the first query do not count.
            solver.ask(&settings[0]);
            push_line(&mut lines, name, who, &answer_all(solver.as_mut(), &settings, true));
        }
    }
    for (name, delta) in [("change of 1 %", 0.01), ("change of 0.13 %", 0.001_3)] {
        let settings =
            Setting::sequence(&bodies, Meeting::Colliding, delta, count + 1, &mut random);
        for who in TRACKED {
            let mut solver = who.enter(&bodies);
            solver.ask(&settings[0]);
            push_line(&mut lines, name, who, &answer_all(solver.as_mut(), &settings[1..], false));
        }
    }
    lines
}

/// Answers queries, from scratch or each from the preceding one.
#[inline(never)]
fn answer_all(who: &mut dyn Algorithm, settings: &[Setting], from_scratch: bool) -> Vec<Work> {
    let answer = |setting| {
        if from_scratch {
            who.forget();
        }
        who.ask(setting)
    };
    settings.iter().map(answer).collect()
}

/// Adds a line with the mean steps and iterations.
fn push_line(lines: &mut String, situation: &str, who: Who, work: &[Work]) {
    let mean_of =
        |of: fn(&Work) -> u32| mean(&work.iter().map(|w| f64::from(of(w))).collect::<Vec<_>>());
    let [steps, iterations] = [mean_of(|w| w.steps), mean_of(|w| w.iterations)];
    let name = who.name().replace(',', ";");
    // Writing to a string cannot fail.
    let _ = writeln!(lines, "{situation},{name},{steps},{iterations}");
}
