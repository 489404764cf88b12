//! Table I: the shares of the phases in the time of a query.

use std::hint::black_box;

use colltrans::observe::{Clock, Profile};

use super::{Gathered, grouped_digits, in_passes};
use crate::Experiment;
use crate::claims::{Claim, Reason, judged};
use crate::finding::{Finding, Table};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::{Kind, bodies};
use crate::solvers::Until;
use crate::statistics::{Estimate, Group, Sample, estimate};
use colltrans_testkit::random::Random;

pub(super) const TABLE_1: Experiment = Experiment {
    id: "table-1",
    title: "time profile of the collision translation algorithm",
    seconds: [4.0, 16.0],
    run,
};

/// Profiles of queries about bodies of one size.
struct Profiled {
    vertices: Vec<f64>,
    /// For each query, the nanoseconds of each phase.
    queries: Vec<(Group, Profile)>,
}

impl Gathered for Profiled {
    fn gather(&mut self, more: Self) {
        self.vertices.extend(more.vertices);
        self.queries.extend(more.queries);
    }
}

/// Runs the experiment.
fn run(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    // Equal sizes are measured once, as at the smallest scale.
    let mut sizes = [800, 12_800, 200_000].map(|n| plan.size(n)).to_vec();
    sizes.dedup();
    let told = |&n: &usize| (n, format!("{} vertices", grouped_digits(n as f64)));
    let profiled = in_passes(plan, progress, &sizes, told, |&n, pass| measure(plan, n, pass));
    let claims = vec![planar_problems(&profiled), region_claim(&profiled)];
    Finding { figures: Vec::new(), tables: vec![shares_table(&profiled)], claims }
}

/// Profiles casts by the paper's algorithm.
fn measure(plan: &Plan, n: usize, pass: u32) -> Profiled {
    let bodies = bodies(plan.seed, Kind::Balanced, n, u64::from(pass));
    let mut random = Random::stream(plan.seed, &[1, n as u64, u64::from(pass)]);
    let count: u32 = plan.by_scale(20, 400, 500);
    let options = Until::End.options();
    let mut queries: Vec<_> = (0..count)
        .map(|number| {
            let setting = Setting::draw(&bodies, Meeting::Colliding, &mut random);
            let mut clock = Clock::new();
            let cast = setting.cast(&bodies, &options);
            let _ = black_box(cast.and_then(|cast| cast.first_contact_observed(&mut clock)));
            (Group { pass, number }, clock.profile())
        })
        .collect();
    // Other programs on the machine disturb some queries, in any phase. The slowest twentieth is discarded.
    queries.sort_by(|(_, a), (_, b)| a.total_nanoseconds().total_cmp(&b.total_nanoseconds()));
    queries.truncate((queries.len() * 19).div_ceil(20));
    Profiled { vertices: vec![bodies.vertices()], queries }
}

/// Name in [`colltrans::observe`] of the phase of planar problems.
const PLANAR: &str = "planar problems";
/// Name in [`colltrans::observe`] of the phase of the search region.
const REGION: &str = "search region";

impl Profiled {
    /// Returns the mean number of vertices.
    fn vertices(&self) -> f64 {
        self.vertices.iter().sum::<f64>() / self.vertices.len() as f64
    }

    /// Returns the share of a phase in the time.
    fn part(&self, name: &str) -> f64 {
        self.estimated(name).value / 100.0
    }

    /// Returns the share of a phase in per cent, with its interval.
    fn estimated(&self, name: &str) -> Estimate {
        let of =
            |p: &Profile| p.phase_times().iter().filter(|(n, _)| *n == name).map(|(_, t)| t).sum();
        let sample = |time: &dyn Fn(&Profile) -> f64| {
            Sample::of(self.queries.iter().map(|(group, profile)| (*group, time(profile))))
        };
        let samples = [sample(&of), sample(&Profile::total_nanoseconds)];
        estimate(&samples, |s| 100.0 * s[0].iter().sum::<f64>() / s[1].iter().sum::<f64>())
    }

    /// Returns the share of a phase in the minimisation, without the certificate and the answer.
    fn part_of_minimisation(&self, name: &str) -> f64 {
        let around = ["portal refinement", "answer"].map(|phase| self.part(phase));
        self.part(name) / (1.0 - around.iter().sum::<f64>())
    }
}

/// Returns the table of all shares.
fn shares_table(profiled: &[Profiled]) -> Table {
    let head = |p: &Profiled| format!("{} vertices", grouped_digits(p.vertices()));
    let columns = std::iter::once("phase".into()).chain(profiled.iter().map(head)).collect();
    let first = &profiled[0].queries[0].1;
    let row = |(name, _): &(&'static str, f64)| {
        let cell = |p: &Profiled| format!("{:.1} %", 100.0 * p.part(name));
        std::iter::once((*name).into()).chain(profiled.iter().map(cell)).collect()
    };
    let title = format!(
        "Where the time of a query from scratch goes: CTA, balanced faces, bodies that collide, {} queries at \
         {} vertices, the slowest twentieth left out",
        profiled[0].queries.len(),
        grouped_digits(profiled[0].vertices())
    );
    let rows = first.phase_times().iter().map(row).collect();
    Table { id: "table-1".into(), title, columns, rows }
}

/// Formats a share at all sizes.
fn shares_text(profiled: &[Profiled], part: impl Fn(&Profiled) -> f64) -> String {
    let text =
        |p: &Profiled| format!("{:.1} % ({})", 100.0 * part(p), grouped_digits(p.vertices()));
    profiled.iter().map(text).collect::<Vec<_>>().join(", ")
}

/// Judges the share of planar problems, at the middle size.
fn planar_problems(profiled: &[Profiled]) -> Claim {
    let middle = &profiled[profiled.len() / 2];
    let details = format!(
        "{} of the whole query; of the minimisation alone {}.",
        shares_text(profiled, |p| p.part(PLANAR)),
        shares_text(profiled, |p| p.part_of_minimisation(PLANAR))
    );
    judged("table-1-planar", vec![middle.estimated(PLANAR)], details, || {
        if middle.part(PLANAR) > 0.5 {
            let ends =
                [&profiled[0], &profiled[profiled.len() - 1]].map(|p| 100.0 * p.part(PLANAR));
            Reason::Implementation.because(format!(
                "Here a planar problem includes finding the edges of both sections, and its part grows with \
                 the bodies as less and less of them is found in the processor's caches (figure 11): {:.0} % of the \
                 time in the smallest and {:.0} % in the largest. What a step does besides touches few vertices.",
                ends[0], ends[1]
            ))
        } else {
            let rest =
                ["portal refinement", "answer", "lower bound"].map(|phase| middle.part(phase));
            Reason::Implementation.because(format!(
                "A proven lower bound, portal refinement and the certificate, which the paper does not \
                 have, take {:.0} % of the query.",
                100.0 * rest.iter().sum::<f64>()
            ))
        }
    })
}

/// Judges the share of the search region at the size where it is largest. The paper's "negligible" is taken
/// as less than a twentieth.
fn region_claim(profiled: &[Profiled]) -> Claim {
    let each = profiled.iter().map(|p| p.estimated(REGION));
    let most = each.max_by(|a, b| a.value.total_cmp(&b.value)).expect("three sizes");
    let details = shares_text(profiled, |p| p.part(REGION)) + ".";
    judged("table-1-region", vec![most], details, || {
        Reason::Implementation.because(
            "The region is cut and its centroid computed at every step, a few dozen operations, while \
             planar problems have become cheap: a part that was small beside them is no longer.",
        )
    })
}
