//! Table I: where the time of a query goes.

use std::hint::black_box;

use colltrans::observe::{Clock, Profile};

use super::{Parts, share, shares, thousands};
use crate::Experiment;
use crate::claims::{Claim, judged};
use crate::finding::{Finding, Table};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::{Kind, bodies};
use crate::solvers::{PAPER_GAP, Until};
use crate::statistics::{Estimate, Sample, estimate};
use colltrans_testkit::random::Random;

pub(super) const TABLE_1: Experiment =
    Experiment { id: "table-1", title: "time profile of the collision translation algorithm", run };

/// The part of the time that each phase takes, by size.
struct Profiled {
    vertices: f64,
    /// Shares of the time, by name.
    shares: Vec<(&'static str, f64)>,
    /// Nanoseconds of planar problems, of the region, and of everything, query by query.
    each: Sample,
    queries: usize,
}

fn run(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let sizes = [800, 12_800, 200_000].map(|n| plan.size(n));
    let mut parts = Parts::new(progress, shares(&sizes));
    let profiled: Vec<_> = sizes
        .iter()
        .map(|n| {
            parts.begin(share(*n), &format!("{} vertices", thousands(*n as f64)));
            measure(plan, *n)
        })
        .collect();
    let claims = vec![planar_problems(&profiled), region(&profiled)];
    Finding { figures: Vec::new(), tables: vec![table(&profiled)], claims }
}

/// Profiles casts by the paper's algorithm.
fn measure(plan: &Plan, n: usize) -> Profiled {
    let bodies = bodies(plan.seed, Kind::Balanced, n, 0);
    let mut random = Random::stream(plan.seed, &[1, n as u64]);
    let queries: usize = plan.by_scale(20, 1_500, 10_000);
    let settings: Vec<_> =
        (0..queries).map(|_| Setting::draw(&bodies, Meeting::Colliding, &mut random)).collect();
    let options = Until::Near.options();
    let mut profiles: Vec<_> = settings
        .iter()
        .map(|s| {
            let mut clock = Clock::new();
            let cast = s.cast(&bodies, &options);
            let _ = black_box(cast.and_then(|cast| cast.first_contact_observed(&mut clock)));
            clock.profile()
        })
        .collect();
    // Other programs on the machine disturb some queries, in whatever phase they are.
    profiles.sort_by(|a, b| a.total().total_cmp(&b.total()));
    profiles.truncate((queries * 19).div_ceil(20));
    let total: f64 = profiles.iter().map(Profile::total).sum();
    let names = profiles.first().map_or(Vec::new(), |p| p.phases().map(|(name, _)| name).to_vec());
    let part = |k: usize| profiles.iter().map(|p| p.phases()[k].1).sum::<f64>() / total;
    let shares = names.into_iter().enumerate().map(|(k, name)| (name, part(k))).collect();
    let of = |p: &Profile, name: &str| {
        p.phases().iter().filter(|(phase, _)| *phase == name).map(|(_, t)| t).sum::<f64>()
    };
    let three =
        |(k, p): (u32, &Profile)| [of(p, PLANAR), of(p, REGION), p.total()].map(|time| (k, time));
    let each = Sample::of((0..).zip(&profiles).flat_map(three));
    Profiled { vertices: bodies.vertices(), shares, each, queries }
}

/// Name of the phases in [`colltrans::observe`] that the claims are about.
const PLANAR: &str = "planar problems";
const REGION: &str = "search region";

impl Profiled {
    /// The part of a phase.
    fn part(&self, name: &str) -> f64 {
        self.shares.iter().find(|(phase, _)| *phase == name).map_or(f64::NAN, |(_, part)| *part)
    }

    /// The per cent of the time that a phase takes, the first or the second of `each`.
    fn estimated(&self, phase: usize) -> Estimate {
        estimate(std::slice::from_ref(&self.each), |s| {
            let sum = |k: usize| s[0].iter().skip(k).step_by(3).sum::<f64>();
            100.0 * sum(phase) / sum(2)
        })
    }

    /// The phases of the minimisation, without the frame around it: the certificate and the answer.
    fn part_of_minimisation(&self, name: &str) -> f64 {
        let around = ["portal refinement", "answer"].map(|phase| self.part(phase));
        self.part(name) / (1.0 - around.iter().sum::<f64>())
    }
}

fn table(profiled: &[Profiled]) -> Table {
    let head = |p: &Profiled| format!("{} vertices", thousands(p.vertices));
    let columns = std::iter::once("phase".into()).chain(profiled.iter().map(head)).collect();
    let phases = profiled.first().map_or(&[][..], |p| &p.shares);
    let row = |(name, _): &(&'static str, f64)| {
        let cell = |p: &Profiled| format!("{:.1} %", 100.0 * p.part(name));
        std::iter::once((*name).into()).chain(profiled.iter().map(cell)).collect()
    };
    let queries = profiled.first().map_or(0, |p| p.queries);
    let title = format!(
        "Where the time of a query from scratch goes: CTA to a gap of {PAPER_GAP}, balanced faces, \
         bodies that collide, {queries} queries at each size, the slowest twentieth left out"
    );
    Table { id: "table-1".into(), title, columns, rows: phases.iter().map(row).collect() }
}

fn parts(profiled: &[Profiled], part: impl Fn(&Profiled) -> f64) -> String {
    let text = |p: &Profiled| format!("{:.1} % ({})", 100.0 * part(p), thousands(p.vertices));
    profiled.iter().map(text).collect::<Vec<_>>().join(", ")
}

/// Judged at the middle size.
fn planar_problems(profiled: &[Profiled]) -> Claim {
    let middle = &profiled[profiled.len() / 2];
    let details = format!(
        "{} of the whole query; of the minimisation alone {}.",
        parts(profiled, |p| p.part(PLANAR)),
        parts(profiled, |p| p.part_of_minimisation(PLANAR))
    );
    judged("table-1-planar", vec![middle.estimated(0)], details, || {
        if middle.part(PLANAR) > 0.5 {
            "Here a planar problem includes finding the edges of both sections, and its part grows with \
             the bodies as less and less of them is found in the processor's caches (figure 11). What a \
             step does besides touches no body at all."
                .into()
        } else {
            let rest =
                ["portal refinement", "answer", "lower bound"].map(|phase| middle.part(phase));
            format!(
                "A proven lower bound, portal refinement and the certificate, which the paper does not \
                 have, take {:.0} % of the query.",
                100.0 * rest.iter().sum::<f64>()
            )
        }
    })
}

/// The paper's "negligible", taken as less than a twentieth, at the size where it is most.
fn region(profiled: &[Profiled]) -> Claim {
    let each = profiled.iter().map(|p| p.estimated(1));
    let most = each.max_by(|a, b| a.value.total_cmp(&b.value)).expect("three sizes");
    let details = parts(profiled, |p| p.part(REGION)) + ".";
    judged("table-1-region", vec![most], details, || {
        "The region is cut and its centroid computed at every step, a few dozen operations, while \
         planar problems have become cheap: a part that was small beside them is no longer."
            .into()
    })
}
