//! Solids: bodies of cubes against exact arithmetic, and convex bodies as solids against the convex
//! core and against the rule over all pairs of facets.

use std::sync::Mutex;
use std::time::Instant;

use colltrans_testkit::oracle::settings;
pub(crate) use colltrans_testkit::oracle::solids::settings::FAMILIES;
use colltrans_testkit::oracle::solids::settings::Setting;
use colltrans_testkit::oracle::solids::{Seen, as_solids, keep, nearest, sheets, turning};
use rayon::prelude::*;

use super::SHOWN;

/// One proof in so many is judged in fractions, if the bodies are small.
const FRACTIONS_EVERY: u64 = 64;

/// What came out, and in which column of the table it is counted.
trait Kind {
    fn column(self) -> usize;
}

impl Kind for Seen {
    fn column(self) -> usize {
        self as usize
    }
}

impl Kind for nearest::Seen {
    fn column(self) -> usize {
        self as usize
    }
}

impl Kind for keep::Seen {
    fn column(self) -> usize {
        self as usize
    }
}

impl Kind for turning::Seen {
    fn column(self) -> usize {
        self as usize
    }
}

/// Examines so many settings of cubes and a tenth as many convex pairs; `true` if nothing disagrees.
pub(crate) fn run(count: u64, seed: u64, only: Option<&str>) -> bool {
    let wanted = |name: &&str| only.is_none_or(|only| only == *name);
    let mut clean = true;
    println!(
        "{:<20} {:>10} {:>12} {:>10} {:>10} {:>10} {:>8} {:>8}",
        "family", "settings", "overlapping", "free", "touching", "blocked", "skipped", "wrong"
    );
    let cubes: Vec<&str> = FAMILIES.iter().copied().filter(wanted).collect();
    for &name in &cubes {
        let each = count.div_ceil(FAMILIES.len() as u64);
        clean &= family(name, seed, each, |seed| {
            let in_fractions = seed.is_multiple_of(FRACTIONS_EVERY);
            Setting::draw(name, seed).ok_or("no such family")?.examine(in_fractions).map(Some)
        });
    }
    for &name in sheets::FAMILIES.iter().filter(|name| wanted(name)) {
        let each = count.div_ceil(FAMILIES.len() as u64);
        clean &=
            family(name, seed, each, |seed| sheets::Setting::draw(name, seed)?.examine().map(Some));
    }
    let convex: Vec<&str> = settings::FAMILIES.iter().map(|f| f.0).collect();
    for &name in
        convex.iter().filter(|name| only.is_none_or(|only| only == format!("convex-{name}")))
    {
        let each = (count / 10).div_ceil(convex.len() as u64);
        let label = format!("convex-{name}");
        clean &= family(&label, seed, each, |seed| as_solids(&settings::setting(name, seed)));
    }
    clean
}

/// Examines distances of so many settings, the same number of each family; `true` if nothing disagrees.
pub(crate) fn distances(count: u64, seed: u64, only: Option<&str>) -> bool {
    of_meshes(["touching", "inside", "near", "apart"], &[], count, seed, only, |name, seed| {
        nearest::Setting::draw(name, seed)?.map(|setting| setting.examine()).transpose()
    })
}

/// The same of casts that keep a gap.
pub(crate) fn keeping(count: u64, seed: u64, only: Option<&str>) -> bool {
    of_meshes(["nearer", "free", "blocked", ""], &[], count, seed, only, keep::examine)
}

/// The same of what turns.
pub(crate) fn motions(count: u64, seed: u64, only: Option<&str>) -> bool {
    let heads = ["overlapping", "free", "grazing", "contact"];
    of_meshes(heads, &turning::FAMILIES, count, seed, only, turning::examine)
}

fn of_meshes<Seen: Kind>(
    [a, b, c, d]: [&str; 4],
    more: &[&'static str],
    count: u64,
    seed: u64,
    only: Option<&str>,
    examine: impl Fn(&str, u64) -> Result<Option<Seen>, String> + Sync,
) -> bool {
    let convex = settings::FAMILIES.iter().map(|f| format!("convex-{}", f.0));
    let known = FAMILIES
        .into_iter()
        .chain(sheets::FAMILIES)
        .chain(nearest::MESHES)
        .chain(more.iter().copied());
    let all: Vec<String> = known.map(str::to_owned).chain(convex).collect();
    let wanted: Vec<&String> =
        all.iter().filter(|name| only.is_none_or(|only| only == name.as_str())).collect();
    println!(
        "{:<20} {:>10} {a:>12} {b:>10} {c:>10} {d:>10} {:>8} {:>8}",
        "family", "settings", "skipped", "wrong"
    );
    let each = count.div_ceil(wanted.len().max(1) as u64);
    let mut clean = true;
    for name in wanted {
        clean &= family(name, seed << 32, each, |seed| examine(name, seed));
    }
    clean
}

fn family<Seen: Kind>(
    name: &str,
    first: u64,
    count: u64,
    examine: impl Fn(u64) -> Result<Option<Seen>, String> + Sync,
) -> bool {
    let started = Instant::now();
    let wrong = Mutex::new(Vec::new());
    let counts = (first..first + count)
        .into_par_iter()
        .map(|seed| {
            let mut counts = [0_u64; 6];
            match examine(seed) {
                Ok(None) => counts[4] = 1,
                Ok(Some(seen)) => counts[seen.column()] = 1,
                Err(error) => {
                    counts[5] = 1;
                    if let Ok(mut wrong) = wrong.lock() {
                        wrong.push((seed, error));
                    }
                }
            }
            counts
        })
        .reduce(|| [0; 6], |a, b| std::array::from_fn(|k| a[k] + b[k]));
    let [overlapping, free, now, later, skipped, bad] = counts;
    println!(
        "{name:<20} {count:>10} {overlapping:>12} {free:>10} {now:>10} {later:>10} {skipped:>8} \
         {bad:>8}   {:.0} s",
        started.elapsed().as_secs_f64()
    );
    let mut wrong = wrong.into_inner().unwrap_or_default();
    wrong.sort();
    for (seed, error) in wrong.iter().take(SHOWN) {
        println!("    {name}:{seed}: {error}");
    }
    bad == 0
}
