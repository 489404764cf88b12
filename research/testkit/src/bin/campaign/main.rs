//! Compares the library with exact arithmetic on many random settings.
//!
//! Each option selects a campaign: single casts with every solver, sequences of settings with trackers, nearly
//! flat bodies, distances, scenes, casts with a minimum gap, rounded bodies, bulk casts without rotation,
//! motions of convex bodies or solids, arms on paths, bodies that rotate with little play, forged proofs,
//! removal paths, free directions of solids, and depths of solids. Certificates are verified in exact arithmetic, and a sample is
//! solved by the rational linear programme. Bodies are compared with their input points in exact arithmetic, so
//! that answers are judged for the input.
//!
//! `--help` lists the options. The exit code is 1 if there are disagreements.

mod bodies;
mod bulk;
mod casts;
mod distances;
mod min_gap;
mod motions;
mod paths;
mod play;
mod proofs;
mod rounded;
mod sequences;
mod solids;
mod ways;

use std::process::ExitCode;
use std::str::FromStr;
use std::time::Instant;

use colltrans_testkit::oracle::among;
use colltrans_testkit::oracle::proofs::{self as forged, KINDS};
use colltrans_testkit::oracle::settings::{FAMILIES, NEARLY_FLAT};
use colltrans_testkit::oracle::solids::{depth, free, unions};
use colltrans_testkit::oracle::still::CASTS;
use colltrans_testkit::tally::{Tally, header};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

/// Maximum number of disagreements to print for each family. All are counted.
const SHOWN: usize = 12;
/// Default number of settings of casts.
const SETTINGS: u64 = 20_000;
/// Default number of settings that the linear programme solves.
const LP: u64 = 1_000;
/// Number of free directions to judge for each setting.
const DIRECTIONS: u64 = 500;

/// A kind of campaign.
struct Campaign {
    /// The option, and the unit of its value.
    option: &'static str,
    counts: &'static str,
    /// Number of these units in one examination.
    each: u64,
    families: fn() -> Vec<String>,
    columns: &'static [&'static str],
    examine: Examine,
}

/// Examines a setting. A disagreement is returned as an error, or recorded in the tally.
type Examine = fn(&Asked<'_>, &mut Tally) -> Result<(), String>;

/// A setting to examine.
struct Asked<'a> {
    family: &'a str,
    seed: u64,
    /// For casts: the linear programme solves one setting out of this many.
    every: u64,
}

impl Asked<'_> {
    /// Returns the index of the setting in its family.
    fn index(&self) -> u64 {
        self.seed & u64::from(u32::MAX)
    }
}

impl Campaign {
    /// Examines a setting and records an error as a disagreement.
    fn examine(&self, asked: &Asked<'_>, tally: &mut Tally) {
        if let Err(what) = (self.examine)(asked, tally) {
            tally.disagree(format!("{}:{} {what}", asked.family, asked.seed));
        }
    }
}

/// Returns the column that counts an outcome of a motion or path.
macro_rules! column_of {
    ($outcome:expr, $Outcome:ident, $undecided:literal) => {
        match $outcome {
            $Outcome::Contact(_) => "contacts",
            $Outcome::Grazing(_) => "grazing",
            $Outcome::Overlapping(_) => "overlapping",
            $Outcome::Undecided(_) => $undecided,
            _ => "free",
        }
    };
}
use column_of;

/// Builds a campaign in which each examination is one setting.
const fn campaign(
    option: &'static str,
    families: fn() -> Vec<String>,
    columns: &'static [&'static str],
    examine: Examine,
) -> Campaign {
    Campaign { option, counts: "N", each: 1, families, columns, examine }
}

/// All campaigns. The first one is the default.
const CAMPAIGNS: [Campaign; 22] = [
    campaign("--settings", settings, casts::COLUMNS, casts::examine),
    Campaign {
        counts: "QUERIES",
        each: sequences::QUERIES,
        ..campaign("--sequences", settings, sequences::COLUMNS, sequences::examine)
    },
    campaign("--solids", solids::cast_families, solids::CASTS, solids::casts),
    campaign("--solid-distances", solids::mesh_families, solids::DISTANCES, solids::distances),
    campaign("--solid-min-gaps", solids::mesh_families, solids::MIN_GAPS, solids::min_gaps),
    campaign(
        "--rounded-solid-distances",
        solids::mesh_families,
        solids::DISTANCES,
        solids::rounded_distances,
    ),
    campaign("--rounded-solids", solids::mesh_families, solids::MIN_GAPS, solids::rounded_casts),
    campaign("--depths", solids::depth_families, depth::COLUMNS, solids::depths),
    campaign("--unions", solids::union_families, unions::COLUMNS, solids::overlapping_unions),
    campaign("--solid-motions", solids::motion_families, solids::MOTIONS, solids::motions),
    Campaign {
        counts: "DIRECTIONS",
        each: DIRECTIONS,
        ..campaign(
            "--free",
            || to_strings(&free::FAMILIES),
            free::COLUMNS,
            |asked, tally| free::examine(asked.family, asked.seed, DIRECTIONS, tally),
        )
    },
    campaign("--bodies", || to_strings(NEARLY_FLAT), bodies::COLUMNS, bodies::examine),
    campaign("--distances", settings, distances::COLUMNS, distances::examine),
    campaign(
        "--scenes",
        || to_strings(&among::FAMILIES),
        among::COLUMNS,
        |asked, tally| among::examine(asked.family, asked.seed, tally),
    ),
    campaign("--min-gaps", min_gap_families, min_gap::COLUMNS, min_gap::examine),
    campaign("--rounded", rounded_families, rounded::COLUMNS, rounded::examine),
    campaign("--motions", settings, motions::COLUMNS, motions::examine),
    campaign("--paths", || to_strings(&paths::FAMILIES), paths::COLUMNS, paths::examine),
    campaign("--play", || to_strings(&play::families()), play::COLUMNS, play::examine),
    campaign("--ways", || to_strings(&ways::FAMILIES), ways::COLUMNS, ways::examine),
    Campaign {
        counts: "MUTANTS",
        each: proofs::MUTANTS,
        ..campaign("--proofs", proof_kinds, forged::COLUMNS, proofs::examine)
    },
    Campaign {
        counts: "CASTS",
        each: CASTS as u64,
        ..campaign("--bulk", settings, bulk::COLUMNS, |asked, tally| {
            bulk::examine(asked, tally);
            Ok(())
        })
    },
];

/// Returns the names as strings.
fn to_strings(families: &[&str]) -> Vec<String> {
    families.iter().map(|&name| name.to_owned()).collect()
}

/// Returns the families of convex settings.
fn settings() -> Vec<String> {
    FAMILIES.iter().map(|family| family.0.to_owned()).collect()
}

/// Returns the families of casts with a minimum gap.
fn min_gap_families() -> Vec<String> {
    settings().into_iter().chain([min_gap::GLIDING.to_owned()]).collect()
}

/// Returns the families of rounded bodies.
fn rounded_families() -> Vec<String> {
    settings().into_iter().chain([rounded::SHAPES.to_owned()]).collect()
}

/// Returns the kinds of proofs.
fn proof_kinds() -> Vec<String> {
    KINDS.iter().map(|kind| kind.name.to_owned()).collect()
}

/// Returns the text of `--help`.
fn usage_text() -> String {
    let lines = CAMPAIGNS.iter().map(|campaign| {
        let Campaign { option, counts, .. } = campaign;
        format!("campaign {option} {counts} [--seed S] [--only FAMILY | --case FAMILY:SEED]\n")
    });
    let rest = "\
        campaign --settings N --lp N\n    N of them are also solved by the linear programme\n\
        campaign --case FAMILY:SEED | FAMILY:SEED:STEP\n    \
        one cast, or one step of a sequence, with all its numbers\n";
    lines.chain([rest.to_owned()]).collect()
}

/// The arguments of the command line.
struct Arguments {
    campaign: Option<(&'static Campaign, u64)>,
    lp: u64,
    seed: u64,
    only: Option<String>,
    case: Option<Case>,
}

/// A setting of a campaign, or a step of a sequence.
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
            [family, seed, step] => (family, seed, Some(parse_number(step)?)),
            _ => {
                return Err(format!(
                    "invalid case {text}; accepted: FAMILY:SEED or FAMILY:SEED:STEP"
                ));
            }
        };
        Ok(Self { family: family.to_owned(), seed: parse_number(seed)?, step })
    }
}

fn main() -> ExitCode {
    if std::env::args().any(|word| word == "--help" || word == "-h") {
        print!("{}", usage_text());
        return ExitCode::SUCCESS;
    }
    match parse(std::env::args().skip(1)).and_then(|arguments| carry_out(&arguments)) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

/// Parses the arguments.
fn parse(mut words: impl Iterator<Item = String>) -> Result<Arguments, String> {
    let mut arguments = Arguments { campaign: None, lp: LP, seed: 1, only: None, case: None };
    while let Some(word) = words.next() {
        let value = words.next().ok_or_else(|| format!("missing value of {word}"))?;
        match word.as_str() {
            "--lp" => arguments.lp = parse_number(&value)?,
            "--seed" => arguments.seed = parse_number(&value)?,
            "--only" => arguments.only = Some(value),
            "--case" => arguments.case = Some(value.parse()?),
            _ => {
                let campaign = CAMPAIGNS.iter().find(|campaign| campaign.option == word);
                let campaign =
                    campaign.ok_or_else(|| format!("unknown option {word}\n{}", usage_text()))?;
                arguments.campaign = Some((campaign, parse_number(&value)?));
            }
        }
    }
    Ok(arguments)
}

/// Parses a number.
fn parse_number<T: FromStr>(text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{text} is not a number of the accepted range"))
}

/// Runs the campaign or the case of the arguments. Returns whether there are no disagreements.
fn carry_out(arguments: &Arguments) -> Result<bool, String> {
    let (campaign, count) = match (arguments.campaign, &arguments.case) {
        (Some(asked), _) => asked,
        (None, Some(case)) => return replay(case),
        (None, None) => (&CAMPAIGNS[0], SETTINGS),
    };
    let families = (campaign.families)();
    println!("{:<20} {}", "family", header(campaign.columns));
    if let Some(Case { family, seed, .. }) = &arguments.case {
        if !families.contains(family) {
            return Err(unknown_family(family, &families));
        }
        let mut tally = Tally::default();
        campaign.examine(&Asked { family, seed: *seed, every: 1 }, &mut tally);
        return Ok(print_tally(family, &tally, campaign.columns));
    }
    let chosen: Vec<&String> = families
        .iter()
        .filter(|name| arguments.only.as_ref().is_none_or(|only| only == *name))
        .collect();
    match &arguments.only {
        Some(only) if chosen.is_empty() => Err(unknown_family(only, &families)),
        _ => Ok(run_campaign(campaign, &chosen, count, arguments)),
    }
}

/// Examines `count` settings, divided equally among the families. Returns whether there are no disagreements.
fn run_campaign(
    campaign: &Campaign,
    families: &[&String],
    count: u64,
    arguments: &Arguments,
) -> bool {
    let per_family = count.div_ceil(campaign.each).div_ceil(families.len() as u64);
    let every = (count / arguments.lp.max(1)).max(1);
    let started = Instant::now();
    let bar = ProgressBar::new(per_family * families.len() as u64).with_style(
        ProgressStyle::with_template("{msg:20} {wide_bar} {pos}/{len} {eta}").expect("a template"),
    );
    let mut total = Tally::default();
    for &name in families {
        bar.set_message(name.to_owned());
        let tally = (0..per_family)
            .into_par_iter()
            .fold(Tally::default, |mut tally, index| {
                let seed = arguments.seed << 32 | index;
                campaign.examine(&Asked { family: name, seed, every }, &mut tally);
                bar.inc(1);
                tally
            })
            .reduce(Tally::default, Tally::merged);
        bar.suspend(|| print_tally(name, &tally, campaign.columns));
        total = total.merged(tally);
    }
    bar.finish_and_clear();
    println!("{:<20} {}", "all", total.line(campaign.columns));
    println!("{:.1} s", started.elapsed().as_secs_f64());
    total.disagreements.is_empty()
}

/// Prints a line of the table and the first disagreements. Returns whether there are none.
fn print_tally(name: &str, tally: &Tally, columns: &[&str]) -> bool {
    println!("{name:<20} {}", tally.line(columns));
    for line in tally.disagreements.iter().take(SHOWN) {
        println!("    {line}");
    }
    tally.disagreements.is_empty()
}

/// Prints and examines a setting of casts, or a step of a sequence.
fn replay(Case { family, seed, step }: &Case) -> Result<bool, String> {
    let families = settings();
    if !families.contains(family) {
        return Err(unknown_family(family, &families));
    }
    Ok(match step {
        Some(step) => sequences::replay(family, *seed, *step),
        None => casts::replay(family, *seed),
    })
}

/// Returns the message for an unknown family.
fn unknown_family(family: &str, families: &[String]) -> String {
    format!("unknown family {family}; families of this campaign: {}", families.join(", "))
}
