//! The long campaign: many settings of every family, each cast with every solver, every certificate
//! re-verified in exact arithmetic, and a sample compared with the rational linear programme.
//!
//! ```text
//! campaign [--settings N] [--lp N] [--seed S] [--only FAMILY] [--case FAMILY:SEED]
//! ```
//! Exit code 1 if anything disagrees.

use std::process::ExitCode;
use std::str::FromStr;
use std::time::Instant;

use colltrans::{Outcome, Solver};
use colltrans_oracle::check::Proof;
use colltrans_oracle::settings::{Bodies, FAMILIES, Setting, setting};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

const SOLVERS: [Solver; 3] = [Solver::Cta, Solver::Portal, Solver::Auto];

/// Settings handed to a thread at a time.
const CHUNK: u64 = 64;

/// Disagreements printed for each family; all are counted.
const SHOWN: usize = 12;

struct Arguments {
    settings: u64,
    lp: u64,
    seed: u64,
    only: Option<String>,
    case: Option<String>,
}

fn main() -> ExitCode {
    let arguments = match parse(std::env::args().skip(1)) {
        Ok(arguments) => arguments,
        Err(message) => {
            eprintln!("{message}");
            return ExitCode::from(2);
        }
    };
    let clean = match &arguments.case {
        Some(case) => replay(case),
        None => run(&arguments),
    };
    if clean { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn parse(mut words: impl Iterator<Item = String>) -> Result<Arguments, String> {
    let mut arguments = Arguments { settings: 20_000, lp: 1_000, seed: 1, only: None, case: None };
    while let Some(word) = words.next() {
        let value = words.next().ok_or_else(|| format!("{word} needs a value"))?;
        match word.as_str() {
            "--settings" => arguments.settings = number(&value)?,
            "--lp" => arguments.lp = number(&value)?,
            "--seed" => arguments.seed = number(&value)?,
            "--only" => arguments.only = Some(value),
            "--case" => arguments.case = Some(value),
            _ => return Err(format!("unknown option {word}")),
        }
    }
    Ok(arguments)
}

fn number<T: FromStr>(text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{text} is not a number"))
}

/// What became of the settings of one family.
#[derive(Debug, Default, Clone)]
struct Tally {
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

impl Tally {
    fn merge(mut self, other: Self) -> Self {
        self.settings += other.settings;
        self.contact += other.contact;
        self.grazing += other.grazing;
        self.separated += other.separated;
        self.proven += other.proven;
        self.answers += other.answers;
        self.lp += other.lp;
        self.note(&other.worst);
        self.disagreements.extend(other.disagreements);
        self
    }

    fn note(&mut self, proof: &Proof) {
        let worst = &mut self.worst;
        worst.gap_over_size = worst.gap_over_size.max(proof.gap_over_size);
        worst.gap_over_tolerance = worst.gap_over_tolerance.max(proof.gap_over_tolerance);
        worst.residual_in_noises = worst.residual_in_noises.max(proof.residual_in_noises);
    }

    fn print(&self, name: &str) {
        println!(
            "{name:<20} {:>8} {:>8} {:>8} {:>9} {:>9.3} {:>7} {:>10.2e} {:>7.3} {:>7.3} {:>6}",
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
        );
    }
}

fn run(arguments: &Arguments) -> bool {
    let families: Vec<&str> = FAMILIES
        .iter()
        .map(|f| f.0)
        .filter(|name| arguments.only.as_ref().is_none_or(|only| only == name))
        .collect();
    let per_family = arguments.settings.div_ceil(families.len() as u64);
    let every = (arguments.settings / arguments.lp.max(1)).max(1);
    let started = Instant::now();
    let bar = ProgressBar::new(per_family * families.len() as u64).with_style(
        ProgressStyle::with_template("{msg:20} {wide_bar} {pos}/{len} {eta}").expect("a template"),
    );
    println!(
        "{:<20} {:>8} {:>8} {:>8} {:>9} {:>9} {:>7} {:>10} {:>7} {:>7} {:>6}",
        "family",
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
    );
    let mut total = Tally::default();
    for name in families {
        bar.set_message(name);
        let chunks = per_family.div_ceil(CHUNK);
        let tally = (0..chunks)
            .into_par_iter()
            .map(|chunk| {
                let mut tally = Tally::default();
                let range = chunk * CHUNK..(chunk * CHUNK + CHUNK).min(per_family);
                bar.inc(range.end - range.start);
                for index in range {
                    let setting = setting(name, arguments.seed << 32 | index);
                    examine(&setting, index.is_multiple_of(every), &mut tally);
                }
                tally
            })
            .reduce(Tally::default, Tally::merge);
        bar.suspend(|| {
            tally.print(name);
            for line in tally.disagreements.iter().take(SHOWN) {
                println!("    {line}");
            }
        });
        total = total.merge(tally);
    }
    bar.finish_and_clear();
    total.print("all");
    println!("{:.1} s", started.elapsed().as_secs_f64());
    total.disagreements.is_empty()
}

/// Casts with every solver, checks every answer, and compares the answers.
fn examine(setting: &Setting, with_oracle: bool, tally: &mut Tally) {
    tally.settings += 1;
    let bodies = match setting.bodies() {
        Ok(bodies) => bodies,
        Err(error) => {
            tally.disagreements.push(format!("{setting} no body: {error}"));
            return;
        }
    };
    let judge = setting.judge(&bodies);
    let mut oracle_asked = false;
    for (index, solver) in SOLVERS.into_iter().enumerate() {
        let outcome = match setting.cast(&bodies, solver) {
            Ok(outcome) => outcome,
            Err(error) => {
                tally.disagreements.push(format!("{setting} {solver:?}: {error}"));
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
            tally.note(&proof);
            if with_oracle || !proof.exact {
                oracle_asked = true;
                judge.compare_with_oracle(&outcome)?;
            }
            Ok(())
        });
        if let Err(objection) = verdict {
            tally.disagreements.push(format!("{setting} {solver:?}: {objection}"));
        }
    }
    tally.lp += u64::from(oracle_asked);
}

/// One setting, with all its numbers.
fn replay(case: &str) -> bool {
    let Some((family, seed)) = case.split_once(':') else {
        eprintln!("a case is FAMILY:SEED");
        return false;
    };
    let Ok(seed) = number(seed) else { return false };
    let setting = setting(family, seed);
    println!("{setting:#?}");
    if let Ok(bodies) = setting.bodies() {
        print_answers(&setting, &bodies);
    }
    let mut tally = Tally::default();
    examine(&setting, true, &mut tally);
    tally.print(family);
    for line in &tally.disagreements {
        println!("    {line}");
    }
    tally.disagreements.is_empty()
}

fn print_answers(setting: &Setting, bodies: &Bodies) {
    for solver in SOLVERS {
        println!("{solver:?}: {:#?}", setting.cast(bodies, solver));
    }
    let scene = setting.judge(bodies).scene;
    println!("noise {:e}", scene.noise);
    println!("overlap {:e}", colltrans_oracle::shadow::sideways_overlap(&scene).to_f64());
    let value = colltrans_oracle::simplex::collision_translation(&scene);
    println!("oracle {:?}", value.map(|t| t.to_f64()));
}
