//! The long campaign: many settings of every family, each cast with every solver, every certificate
//! re-verified in exact arithmetic, and a sample compared with the rational linear programme. Or
//! many sequences of settings, each asked of trackers, whose answers are judged in the same way and
//! compared with those of one-off queries. Or bodies alone, nearly flat ones, each with a cast onto it.
//! Or distances of settings as they are, near contact and overlapping. Or scenes, one body among many. Or casts
//! that keep a gap. Or casts of bodies that do not turn, in bulk. Or motions that turn, of convex bodies or of solids.
//! Or arms on paths. Or bodies that turn with little play. Or forged proofs, which neither checker may accept. Or
//! ways out in several moves. Or all free directions of solids, each held against casts along
//! some of them.
//! In all of them bodies are held against the points that they were made of, in exact arithmetic, so
//! that answers are judged for the input.
//!
//! `--help` lists its options. Exit code 1 if anything disagrees.

mod bodies;
mod bulk;
mod casts;
mod distances;
mod free;
mod keeping;
mod motions;
mod paths;
mod play;
mod proofs;
mod scenes;
mod sequences;
mod solids;
mod ways;

use std::process::ExitCode;
use std::str::FromStr;
use std::time::Instant;

use colltrans_testkit::oracle::among;
use colltrans_testkit::oracle::proofs::KINDS;
use colltrans_testkit::oracle::settings::{FAMILIES, NEARLY_FLAT};
use colltrans_testkit::oracle::still::CASTS;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

/// Disagreements printed for each family; all are counted.
const SHOWN: usize = 12;

const USAGE: &str = "\
campaign [--settings N] [--lp N] [--seed S] [--only FAMILY]
campaign --sequences QUERIES [--seed S] [--only FAMILY]
campaign --solids N [--seed S] [--only FAMILY]
campaign --solid-distances N [--seed S] [--only FAMILY]
campaign --free DIRECTIONS [--seed S] [--only FAMILY]
campaign --bodies N [--seed S] [--only FAMILY]
campaign --distances N [--seed S] [--only FAMILY]
campaign --scenes N [--seed S] [--only FAMILY]
campaign --keeping N [--seed S] [--only FAMILY]
campaign --solid-keeping N [--seed S] [--only FAMILY]
campaign --motions N [--seed S] [--only FAMILY]
campaign --solid-motions N [--seed S] [--only FAMILY]
campaign --paths N [--seed S] [--only FAMILY]
campaign --play N [--seed S] [--only FAMILY]
campaign --ways N [--seed S] [--only FAMILY]
campaign --proofs MUTANTS [--seed S] [--only KIND]
campaign --bulk CASTS [--seed S] [--only FAMILY]
campaign --case FAMILY:SEED | FAMILY:SEED:STEP
campaign --free 1 --case FAMILY:SEED
    one setting of that campaign; so of all others, but for those of solids
";

struct Arguments {
    settings: u64,
    sequences: Option<u64>,
    solids: Option<u64>,
    solid_distances: Option<u64>,
    solid_keeping: Option<u64>,
    solid_motions: Option<u64>,
    free: Option<u64>,
    motions: Option<u64>,
    paths: Option<u64>,
    play: Option<u64>,
    ways: Option<u64>,
    proofs: Option<u64>,
    bulk: Option<u64>,
    bodies: Option<u64>,
    distances: Option<u64>,
    scenes: Option<u64>,
    keeping: Option<u64>,
    lp: u64,
    seed: u64,
    only: Option<String>,
    case: Option<Case>,
}

/// One setting of a campaign, or a step of a sequence.
struct Case {
    family: String,
    seed: u64,
    step: Option<u32>,
}

impl FromStr for Case {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split(':').collect();
        let (family, seed, step) = match parts[..] {
            [family, seed] => (family, seed, None),
            [family, seed, step] => (family, seed, Some(number(step)?)),
            _ => return Err(format!("a case is FAMILY:SEED or FAMILY:SEED:STEP, not {text}")),
        };
        Ok(Self { family: family.to_owned(), seed: number(seed)?, step })
    }
}

fn main() -> ExitCode {
    if std::env::args().any(|word| word == "--help" || word == "-h") {
        print!("{USAGE}");
        return ExitCode::SUCCESS;
    }
    let arguments = match parse(std::env::args().skip(1)) {
        Ok(arguments) => arguments,
        Err(message) => {
            eprintln!("{message}");
            return ExitCode::from(2);
        }
    };
    if let Some(count) = arguments.solids {
        return exit_code(solids::run(count, arguments.seed, arguments.only.as_deref()));
    }
    if let Some(count) = arguments.solid_distances {
        return exit_code(solids::distances(count, arguments.seed, arguments.only.as_deref()));
    }
    if let Some(count) = arguments.solid_keeping {
        return exit_code(solids::keeping(count, arguments.seed, arguments.only.as_deref()));
    }
    if let Some(count) = arguments.solid_motions {
        return exit_code(solids::motions(count, arguments.seed, arguments.only.as_deref()));
    }
    let families: Vec<&str> = FAMILIES.iter().map(|f| f.0).collect();
    exit_code(if let Some(directions) = arguments.free {
        run(&arguments, &free::FAMILIES, directions.div_ceil(free::DIRECTIONS), free::examine)
    } else if let Some(count) = arguments.bodies {
        run(&arguments, NEARLY_FLAT, count, bodies::examine)
    } else if let Some(count) = arguments.distances {
        run(&arguments, &families, count, distances::examine)
    } else if let Some(count) = arguments.motions {
        run(&arguments, &families, count, motions::examine)
    } else if let Some(count) = arguments.paths {
        run(&arguments, &paths::FAMILIES, count, paths::examine)
    } else if let Some(count) = arguments.play {
        run(&arguments, &play::families(), count, play::examine)
    } else if let Some(count) = arguments.ways {
        run(&arguments, &ways::FAMILIES, count, ways::examine)
    } else if let Some(count) = arguments.proofs {
        let kinds: Vec<&str> = KINDS.iter().map(|kind| kind.name).collect();
        run(&arguments, &kinds, count.div_ceil(proofs::MUTANTS), proofs::examine)
    } else if let Some(count) = arguments.bulk {
        run(&arguments, &families, count.div_ceil(CASTS as u64), bulk::examine)
    } else if let Some(count) = arguments.scenes {
        run(&arguments, &among::FAMILIES, count, scenes::examine)
    } else if let Some(count) = arguments.keeping {
        let families: Vec<&str> = families.into_iter().chain([keeping::GLIDING]).collect();
        run(&arguments, &families, count, keeping::examine)
    } else if let Some(queries) = arguments.sequences {
        run(&arguments, &families, queries.div_ceil(sequences::QUERIES), sequences::examine)
    } else if let Some(case) = &arguments.case {
        replay(case)
    } else {
        let every = (arguments.settings / arguments.lp.max(1)).max(1);
        run(&arguments, &families, arguments.settings, |name, seed, tally| {
            casts::examine(name, seed, every, tally);
        })
    })
}

fn exit_code(clean: bool) -> ExitCode {
    if clean { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn parse(mut words: impl Iterator<Item = String>) -> Result<Arguments, String> {
    let mut arguments = Arguments {
        settings: 20_000,
        sequences: None,
        solids: None,
        solid_distances: None,
        solid_keeping: None,
        solid_motions: None,
        free: None,
        motions: None,
        paths: None,
        play: None,
        ways: None,
        proofs: None,
        bulk: None,
        bodies: None,
        distances: None,
        scenes: None,
        keeping: None,
        lp: 1_000,
        seed: 1,
        only: None,
        case: None,
    };
    while let Some(word) = words.next() {
        let value = words.next().ok_or_else(|| format!("{word} needs a value"))?;
        match word.as_str() {
            "--settings" => arguments.settings = number(&value)?,
            "--sequences" => arguments.sequences = Some(number(&value)?),
            "--solids" => arguments.solids = Some(number(&value)?),
            "--distances" => arguments.distances = Some(number(&value)?),
            "--keeping" => arguments.keeping = Some(number(&value)?),
            "--solid-keeping" => arguments.solid_keeping = Some(number(&value)?),
            "--solid-motions" => arguments.solid_motions = Some(number(&value)?),
            "--motions" => arguments.motions = Some(number(&value)?),
            "--paths" => arguments.paths = Some(number(&value)?),
            "--play" => arguments.play = Some(number(&value)?),
            "--ways" => arguments.ways = Some(number(&value)?),
            "--proofs" => arguments.proofs = Some(number(&value)?),
            "--bulk" => arguments.bulk = Some(number(&value)?),
            "--free" => arguments.free = Some(number(&value)?),
            "--solid-distances" => arguments.solid_distances = Some(number(&value)?),
            "--scenes" => arguments.scenes = Some(number(&value)?),
            "--bodies" => arguments.bodies = Some(number(&value)?),
            "--lp" => arguments.lp = number(&value)?,
            "--seed" => arguments.seed = number(&value)?,
            "--only" => arguments.only = Some(value),
            "--case" => arguments.case = Some(value.parse()?),
            _ => return Err(format!("unknown option {word}\n{USAGE}")),
        }
    }
    Ok(arguments)
}

fn number<T: FromStr>(text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{text} is not a number"))
}

/// What became of the settings, or the sequences, of one family.
trait Tally: Default + Send {
    /// How many of them a thread is handed at a time.
    const CHUNK: u64;

    /// The heads of the columns.
    fn header() -> String;
    /// A line of the table.
    fn line(&self) -> String;
    /// Both together.
    fn merge(self, other: Self) -> Self;
    /// What is wrong.
    fn disagreements(&self) -> &[String];
}

/// Examines so many seeds, the same number of each family, or the one case that is asked for; `true` if nothing
/// disagrees.
fn run<T: Tally>(
    arguments: &Arguments,
    families: &[&str],
    count: u64,
    examine: impl Fn(&str, u64, &mut T) + Sync,
) -> bool {
    if let Some(Case { family, seed, .. }) = &arguments.case {
        if !families.contains(&family.as_str()) {
            return unknown(family);
        }
        let mut tally = T::default();
        examine(family, *seed, &mut tally);
        println!("{:<20} {}", "family", T::header());
        print(family, &tally);
        return tally.disagreements().is_empty();
    }
    let families: Vec<&str> = families
        .iter()
        .copied()
        .filter(|name| arguments.only.as_ref().is_none_or(|only| only == name))
        .collect();
    let per_family = count.div_ceil(families.len().max(1) as u64);
    let started = Instant::now();
    let bar = ProgressBar::new(per_family * families.len() as u64).with_style(
        ProgressStyle::with_template("{msg:20} {wide_bar} {pos}/{len} {eta}").expect("a template"),
    );
    println!("{:<20} {}", "family", T::header());
    let mut total = T::default();
    for name in families {
        bar.set_message(name.to_owned());
        let tally = (0..per_family.div_ceil(T::CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let mut tally = T::default();
                let range = chunk * T::CHUNK..((chunk + 1) * T::CHUNK).min(per_family);
                bar.inc(range.end - range.start);
                for index in range {
                    examine(name, arguments.seed << 32 | index, &mut tally);
                }
                tally
            })
            .reduce(T::default, T::merge);
        bar.suspend(|| print(name, &tally));
        total = total.merge(tally);
    }
    bar.finish_and_clear();
    println!("{:<20} {}", "all", total.line());
    println!("{:.1} s", started.elapsed().as_secs_f64());
    total.disagreements().is_empty()
}

/// A line of the table, and the first disagreements.
fn print(name: &str, tally: &impl Tally) {
    println!("{name:<20} {}", tally.line());
    for line in tally.disagreements().iter().take(SHOWN) {
        println!("    {line}");
    }
}

/// One setting of casts, or one step of a sequence, with all its numbers.
fn replay(Case { family, seed, step }: &Case) -> bool {
    if !FAMILIES.iter().any(|f| f.0 == family) {
        return unknown(family);
    }
    match step {
        Some(step) => sequences::replay(family, *seed, *step),
        None => casts::replay(family, *seed),
    }
}

fn unknown(family: &str) -> bool {
    eprintln!("this campaign has no family {family}");
    false
}
