//! Beyond the paper: algorithms for neighbouring questions on the same settings ("casts, 2026").
//!
//! - *Casts*: the paper's question, from scratch, for bodies that collide or pass each other. Growth distance and
//!   distance algorithms answer their own question at the start.
//! - *Overlap*: whether the bodies overlap if the moving one stops shortly before the contact, or shortly beyond it.
//!
//! An answer *fails* if the algorithm reaches its limit of steps, or if it contradicts that of another contestant.

use colltrans::Outcome;
use colltrans_baselines::egjk::SupportSearch;

use super::{
    Coherence, Gathered, Race, Results, against_size, grouped_digits, in_passes, new_axis,
    new_series, time_text,
};
use crate::Experiment;
use crate::finding::{Figure, Finding, Point, Table};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::{Bodies, Kind};
use crate::solvers::{Until, Who};
use crate::statistics::{mean, short};
use colltrans_testkit::random::Random;
use colltrans_testkit::timing::median;

pub(super) const CASTS: Experiment = Experiment {
    id: "casts-2026",
    title: "algorithms for neighbouring questions",
    seconds: [5.0, 20.0],
    run,
};

/// Contestants of casts.
const CASTERS: [Who; 7] = [
    Who::Portal,
    Who::Cta(Until::End),
    Who::RayCast,
    Who::Growth,
    Who::Egjk(SupportSearch::FirstVertex),
    Who::VClip,
    Who::HWalk(0.0),
];

/// Contestants of overlap queries.
const OVERLAPPERS: [Who; 5] =
    [Who::Intersects, Who::Mpr, Who::Growth, Who::Egjk(SupportSearch::FirstVertex), Who::VClip];

/// Kinds of bodies: round, with thin faces, with irregular triangles.
const KINDS: [Kind; 3] = [Kind::Balanced, Kind::Thin, Kind::RandomHull];

/// Least distance of bodies that pass, and distance from the contact in overlap queries, in diameters.
const NEAR: f64 = 0.01;

/// Situations, in the order of [`Measured`]: two of casts, two of overlap queries.
const SITUATIONS: [&str; 4] = ["colliding", "passing", "before contact", "beyond contact"];

/// Results for one kind and size: casts and overlap queries, two situations of each.
struct Measured {
    casts: [Results; 2],
    overlaps: [Results; 2],
}

impl Gathered for Measured {
    fn gather(&mut self, more: Self) {
        self.casts.gather(more.casts);
        self.overlaps.gather(more.overlaps);
    }
}

impl Measured {
    /// Returns each situation with its contestants and results.
    fn situations(&self) -> [(&'static str, &'static [Who], &Results); 4] {
        let [colliding, passing] = &self.casts;
        let [before, beyond] = &self.overlaps;
        [
            (SITUATIONS[0], &CASTERS, colliding),
            (SITUATIONS[1], &CASTERS, passing),
            (SITUATIONS[2], &OVERLAPPERS, before),
            (SITUATIONS[3], &OVERLAPPERS, beyond),
        ]
    }
}

fn run(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let sizes =
        plan.by_scale(&[50, 200][..], &[200, 3_200, 51_200], &[200, 800, 3_200, 12_800, 51_200]);
    let items: Vec<_> = KINDS.iter().flat_map(|kind| sizes.iter().map(|n| (*kind, *n))).collect();
    let describe = |&(kind, n): &(Kind, usize)| {
        (n, format!("{} bodies, {} vertices", kind.name(), grouped_digits(n as f64)))
    };
    let measured = in_passes(plan, progress, &items, describe, |&(kind, n), pass| {
        measure(plan, kind, n, pass)
    });
    let balanced = &measured[..sizes.len()];
    Finding {
        figures: [0, 2].map(|situation| times_figure(balanced, situation)).to_vec(),
        tables: (0..SITUATIONS.len())
            .map(|situation| times_table(&items, &measured, situation))
            .collect(),
        claims: Vec::new(),
    }
}

fn measure(plan: &Plan, kind: Kind, n: usize, pass: u32) -> Measured {
    let race = |who: &'static [Who]| Race {
        plan,
        figure: 21,
        kind,
        n,
        given: None,
        who,
        coherence: Coherence::Scratch,
        length: plan.by_scale(5, 40, 40),
        blocks: plan.by_scale(1, 2, 3),
    };
    let casts = race(&CASTERS).run_in_turns(pass, 0, |variant, bodies, count, random| {
        let meeting = [Meeting::Colliding, Meeting::Passing(NEAR)][variant];
        (0..count).map(|_| Setting::draw(bodies, meeting, random)).collect()
    });
    let overlaps = race(&OVERLAPPERS).run_in_turns(pass, 1, |variant, bodies, count, random| {
        let beyond = [-NEAR, NEAR][variant] * bodies.diameter;
        (0..count).map(|_| draw_near_contact(bodies, beyond, random)).collect()
    });
    Measured { casts, overlaps }
}

/// Draws a setting whose moving body has advanced to its contact and `beyond` it, in world units.
fn draw_near_contact(bodies: &Bodies, beyond: f64, random: &mut Random) -> Setting {
    loop {
        let setting = Setting::draw(bodies, Meeting::Colliding, random);
        let cast = setting.cast(bodies, &colltrans::Options::default());
        if let Ok(Outcome::Contact(contact)) = cast.and_then(|cast| cast.first_contact()) {
            return setting.advanced(contact.translation + beyond);
        }
    }
}

fn times_figure(balanced: &[Measured], situation: usize) -> Figure {
    let (name, who, _) = balanced[0].situations()[situation];
    let line = |k: usize| {
        let point = |m: &Measured| {
            let results = m.situations()[situation].2;
            let times: Vec<_> = results.times(k).iter().map(|t| t / 1e3).collect();
            Point::median(results.vertices(), &times)
        };
        new_series(who[k].name(), balanced.iter().map(point).collect())
    };
    against_size(
        &format!("casts-2026-{}", name.replace(' ', "-")),
        &format!("Balanced faces, {name}: time of a query from scratch, median and quartiles"),
        new_axis("time (µs)", true),
        (0..who.len()).map(line).collect(),
    )
}

fn times_table(items: &[(Kind, usize)], measured: &[Measured], situation: usize) -> Table {
    let (name, who, _) = measured[0].situations()[situation];
    let columns = std::iter::once("bodies, vertices".into())
        .chain(who.iter().map(|who| who.name()))
        .collect();
    let row = |((kind, n), m): (&(Kind, usize), &Measured)| {
        let results = m.situations()[situation].2;
        let cell = |k: usize| {
            format!(
                "{}, {} steps, {} iterations, {} failed",
                time_text(median(&results.times(k))),
                short(mean(&results.steps(k).values())),
                short(results.iterations(k)),
                results.contradictions(k)
            )
        };
        let head = format!("{}, {}", kind.name(), grouped_digits(*n as f64));
        std::iter::once(head).chain((0..who.len()).map(cell)).collect()
    };
    Table {
        id: format!("casts-2026-{}-table", name.replace(' ', "-")),
        title: format!("Queries from scratch, {name}: median times, mean counts, failures"),
        columns,
        rows: items.iter().zip(measured).map(row).collect(),
    }
}
