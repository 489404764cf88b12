//! Solids against what is known exactly.

use std::collections::HashMap;

use colltrans_testkit::cases;
use colltrans_testkit::oracle::solids::settings::{FAMILIES, MotionOutcome, Setting};
use colltrans_testkit::oracle::solids::{depth, sheets, unions};
use colltrans_testkit::tally::Tally;

/// Examines a setting of a family with a seed.
type Examine = fn(&str, u64, &mut Tally) -> Result<(), String>;

/// Settings of all families together.
const SETTINGS: u64 = 10_000;

fn each_was_seen(seen: &HashMap<MotionOutcome, usize>) {
    let least = [
        MotionOutcome::Overlapping,
        MotionOutcome::Free,
        MotionOutcome::BlockedNow,
        MotionOutcome::Blocked,
    ];
    for outcome in least {
        let count = seen.get(&outcome).copied().unwrap_or(0);
        assert!(count as u64 > cases(SETTINGS) / 40, "{outcome:?} only {count} times");
    }
}

#[test]
fn bodies_of_cubes_agree_with_exact_arithmetic() {
    let mut seen: HashMap<MotionOutcome, usize> = HashMap::new();
    for family in FAMILIES {
        // Coordinates without exact values in `f64` take whole numbers for every tie.
        let slow = matches!(family, "rotated" | "mould");
        for seed in 0..if slow { cases(SETTINGS) / 20 } else { cases(SETTINGS) * 9 / 40 } {
            let setting = Setting::draw(family, seed).expect("a family");
            match setting.examine(seed.is_multiple_of(64)) {
                Ok(outcome) => *seen.entry(outcome).or_default() += 1,
                Err(error) => panic!("{family}:{seed}: {error}"),
            }
        }
    }
    each_was_seen(&seen);
}

#[test]
fn open_surfaces_agree_with_exact_arithmetic() {
    let mut seen: HashMap<MotionOutcome, usize> = HashMap::new();
    for family in sheets::FAMILIES {
        for seed in
            0..if family == "sheets-rotated" { cases(SETTINGS) / 20 } else { cases(SETTINGS) / 5 }
        {
            let setting = sheets::Setting::draw(family, seed).expect("a setting");
            match setting.examine() {
                Ok(outcome) => *seen.entry(outcome).or_default() += 1,
                Err(error) => panic!("{family}:{seed}: {error}"),
            }
        }
    }
    each_was_seen(&seen);
}

#[test]
fn depths_and_unions_agree_with_cubes() {
    let depths = depth::FAMILIES.map(|family| (family, depth::examine as Examine));
    let unions = unions::FAMILIES.map(|family| (family, unions::examine as Examine));
    for (family, examine) in depths.into_iter().chain(unions) {
        let mut tally = Tally::default();
        for seed in 0..cases(80) {
            if let Err(error) = examine(family, seed, &mut tally) {
                panic!("{family}:{seed}: {error}");
            }
        }
        assert!(tally.get("settings") > cases(40), "{family}");
    }
}
