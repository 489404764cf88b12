//! Single settings: bodies held against their input points, cast with every solver, each answer checked
//! exactly, a sample solved again.

use colltrans::{Options, Outcome, QueryError, Solver, cta};
use colltrans_testkit::oracle::check::Proof;
use colltrans_testkit::oracle::settings::{Bodies, Setting, setting};

use crate::print;

/// Who answers: every solver, and the collision translation algorithm as a first guess alone.
const WHO: [(&str, Solver, Option<cta::Options>); 4] = [
    ("Cta", Solver::Cta, None),
    ("Cta, rough", Solver::Cta, Some(cta::Options::ROUGH)),
    ("Portal", Solver::Portal, None),
    ("Auto", Solver::Auto, None),
];

fn ask(
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

/// What became of the settings of one family.
#[derive(Debug, Default, Clone)]
pub(crate) struct Tally {
    settings: u64,
    contact: u64,
    grazing: u64,
    separated: u64,
    /// Answers whose certificate proves outcome and value without any rounding.
    proven: u64,
    answers: u64,
    /// Settings solved by the linear programme too.
    lp: u64,
    worst: Proof,
    disagreements: Vec<String>,
}

impl crate::Tally for Tally {
    const CHUNK: u64 = 64;

    fn header() -> String {
        format!(
            "{:>8} {:>8} {:>8} {:>9} {:>9} {:>7} {:>10} {:>7} {:>7} {:>6}",
            "settings",
            "contact",
            "grazing",
            "separated",
            "proven",
            "lp",
            "gap/size",
            "gap/tol",
            "miss/u",
            "wrong"
        )
    }

    fn line(&self) -> String {
        format!(
            "{:>8} {:>8} {:>8} {:>9} {:>9.3} {:>7} {:>10.2e} {:>7.3} {:>7.3} {:>6}",
            self.settings,
            self.contact,
            self.grazing,
            self.separated,
            self.proven as f64 / self.answers.max(1) as f64,
            self.lp,
            self.worst.gap_over_size,
            self.worst.gap_over_tolerance,
            self.worst.residual_in_noises,
            self.disagreements.len()
        )
    }

    fn merge(mut self, other: Self) -> Self {
        self.settings += other.settings;
        self.contact += other.contact;
        self.grazing += other.grazing;
        self.separated += other.separated;
        self.proven += other.proven;
        self.answers += other.answers;
        self.lp += other.lp;
        self.worst = self.worst.worse(&other.worst);
        self.disagreements.extend(other.disagreements);
        self
    }

    fn disagreements(&self) -> &[String] {
        &self.disagreements
    }
}

/// Examines the setting of a family with a seed; one in `every` is solved again.
pub(crate) fn examine(family: &str, seed: u64, every: u64, tally: &mut Tally) {
    let index = seed & u64::from(u32::MAX);
    examine_setting(&setting(family, seed), index.is_multiple_of(every), tally);
}

/// Casts with every solver, checks every answer, and compares the answers.
pub(crate) fn examine_setting(setting: &Setting, with_oracle: bool, tally: &mut Tally) {
    tally.settings += 1;
    let bodies = match setting.bodies() {
        Ok(bodies) => bodies,
        Err(error) => {
            tally.disagreements.push(format!("{setting} no body: {error}"));
            return;
        }
    };
    if let Err(objection) = setting.judge_bodies(&bodies) {
        tally.disagreements.push(format!("{setting} {objection}"));
    }
    let judge = setting.judge(&bodies);
    let mut oracle_asked = false;
    for (index, (name, solver, narrowing)) in WHO.into_iter().enumerate() {
        let outcome = match ask(setting, &bodies, solver, narrowing) {
            Ok(outcome) => outcome,
            Err(error) => {
                tally.disagreements.push(format!("{setting} {name}: {error}"));
                continue;
            }
        };
        if index == 0 {
            match outcome {
                Outcome::Contact(_) => tally.contact += 1,
                Outcome::Grazing(_) => tally.grazing += 1,
                Outcome::Separated(_) => tally.separated += 1,
            }
        }
        tally.answers += 1;
        let verdict = judge.check(&outcome).and_then(|proof| {
            tally.proven += u64::from(proof.exact);
            tally.worst = tally.worst.worse(&proof);
            if with_oracle || !proof.exact {
                oracle_asked = true;
                judge.compare_with_oracle(&outcome)?;
            }
            Ok(())
        });
        if let Err(objection) = verdict {
            tally.disagreements.push(format!("{setting} {name}: {objection}"));
        }
    }
    tally.lp += u64::from(oracle_asked);
}

/// One setting, with all its numbers.
pub(crate) fn replay(family: &str, seed: u64) -> bool {
    let setting = setting(family, seed);
    println!("{setting:#?}");
    if let Ok(bodies) = setting.bodies() {
        print_answers(&setting, &bodies);
    }
    let mut tally = Tally::default();
    examine_setting(&setting, true, &mut tally);
    print(family, &tally);
    tally.disagreements.is_empty()
}

/// What one-off queries answer, and what the oracle says.
pub(crate) fn print_answers(setting: &Setting, bodies: &Bodies) {
    for (name, solver, narrowing) in WHO {
        println!("{name}: {:#?}", ask(setting, bodies, solver, narrowing));
    }
    let scene = setting.judge(bodies).scene;
    println!("noise {:e}", scene.noise);
    println!("overlap {:e}", colltrans_testkit::oracle::shadow::sideways_overlap(&scene).to_f64());
    let value = colltrans_testkit::oracle::simplex::collision_translation(&scene);
    println!("oracle {:?}", value.map(|t| t.to_f64()));
}
