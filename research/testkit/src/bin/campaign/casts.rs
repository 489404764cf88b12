//! Campaign of single settings. Bodies are compared with their input points, and cast with every solver. Each
//! answer is checked exactly, and the oracle solves a sample.

use colltrans::{Options, Outcome, QueryError, Solver, cta};
use colltrans_testkit::oracle::settings::{Bodies, Setting, setting};
use colltrans_testkit::tally::Tally;

use crate::{Asked, print_tally};

/// The solvers: each one, and the collision translation algorithm as a first guess only, or with a guessed solution.
const WHO: [(&str, Solver, Option<cta::Options>); 6] = [
    ("Cta", Solver::Cta, None),
    ("Cta, rough", Solver::Cta, Some(cta::Options::ROUGH)),
    ("Cta, guess", Solver::Cta, Some(GUESS)),
    ("Cta, guess across cells", Solver::Cta, Some(GUESS.with_keeps_to_cell(false))),
    ("Portal", Solver::Portal, None),
    ("Auto", Solver::Auto, None),
];

/// The paper's algorithm in the neighbourhood of a guessed solution.
const GUESS: cta::Options = cta::Options::new(cta::Start::Guess, cta::Until::Exit);

/// Computes the first contact with a solver.
fn first_contact_with(
    setting: &Setting,
    bodies: &Bodies,
    solver: Solver,
    narrowing: Option<cta::Options>,
) -> Result<Outcome, QueryError> {
    let options = Options::default()
        .with_solver(solver)
        .with_narrowing(narrowing.unwrap_or_default())
        .with_graze_tolerance(setting.graze_tolerance);
    setting.query(bodies)?.with_options(options)?.first_contact()
}

/// Columns of the table.
pub(crate) const COLUMNS: &[&str] = &[
    "settings",
    "contact",
    "grazing",
    "separated",
    "proven",
    "lp",
    "gap/size",
    "gap/tol",
    "miss/u",
];

/// Examines the setting of a family with a seed. The oracle solves one out of `asked.every`.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    let with_oracle = asked.index().is_multiple_of(asked.every);
    examine_setting(&setting(asked.family, asked.seed), with_oracle, tally)
}

/// Returns the name of an outcome in tables.
pub(crate) fn kind(outcome: &Outcome) -> &'static str {
    match outcome {
        Outcome::Contact(_) => "contact",
        Outcome::Grazing(_) => "grazing",
        Outcome::Separated(_) => "separated",
    }
}

/// Casts with every solver, and checks each answer. If `with_oracle`, or if a certificate is not exact,
/// compares the answer with the oracle.
pub(crate) fn examine_setting(
    setting: &Setting,
    with_oracle: bool,
    tally: &mut Tally,
) -> Result<(), String> {
    tally.count("settings");
    let bodies = setting.bodies().map_err(|error| format!("no body: {error}"))?;
    if let Err(objection) = setting.judge_bodies(&bodies) {
        tally.disagree(format!("{setting} {objection}"));
    }
    let judge = setting.judge(&bodies);
    let mut oracle_asked = false;
    for (index, (name, solver, narrowing)) in WHO.into_iter().enumerate() {
        let outcome = match first_contact_with(setting, &bodies, solver, narrowing) {
            Ok(outcome) => outcome,
            Err(error) => {
                tally.disagree(format!("{setting} {name}: {error}"));
                continue;
            }
        };
        if index == 0 {
            tally.count(kind(&outcome));
        }
        let verdict = judge.check(&outcome).and_then(|proof| {
            tally.mean("proven", u8::from(proof.exact));
            tally.largest("gap/size", proof.gap_over_size);
            tally.largest("gap/tol", proof.gap_over_tolerance);
            tally.largest("miss/u", proof.residual_in_noises);
            if with_oracle || !proof.exact {
                oracle_asked = true;
                judge.compare_with_oracle(&outcome)?;
            }
            Ok(())
        });
        if let Err(objection) = verdict {
            tally.disagree(format!("{setting} {name}: {objection}"));
        }
    }
    tally.count_if("lp", oracle_asked);
    Ok(())
}

/// Prints and examines one setting. Returns whether there are no disagreements.
pub(crate) fn replay(family: &str, seed: u64) -> bool {
    let setting = setting(family, seed);
    println!("{setting:#?}");
    if let Ok(bodies) = setting.bodies() {
        print_answers(&setting, &bodies);
    }
    let mut tally = Tally::default();
    if let Err(what) = examine_setting(&setting, true, &mut tally) {
        tally.disagree(format!("{setting} {what}"));
    }
    print_tally(family, &tally, COLUMNS)
}

/// Prints the answers of single queries and of the oracle.
pub(crate) fn print_answers(setting: &Setting, bodies: &Bodies) {
    for (name, solver, narrowing) in WHO {
        println!("{name}: {:#?}", first_contact_with(setting, bodies, solver, narrowing));
    }
    let scene = setting.judge(bodies).scene;
    println!("noise {:e}", scene.noise);
    println!("overlap {:e}", colltrans_testkit::oracle::shadow::sideways_overlap(&scene).to_f64());
    let value = colltrans_testkit::oracle::simplex::collision_translation(&scene);
    println!("oracle {:?}", value.map(|t| t.to_f64()));
}
