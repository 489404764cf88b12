//! Figure 18: sequences of queries, compared with enhanced GJK.

use colltrans::cta;
use colltrans::observe::Clock;

use super::{
    Coherence, Race, Results, Unit, against_size, by_kind_and_size, grouped_digits, median,
    median_of_medians, new_axis, new_series, reference_curve, sample_medians, time_text,
};
use crate::Experiment;
use crate::claims::{Claim, Reason, Why, judged};
use crate::finding::{Figure, Finding, Point, Table};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::{Kind, bodies};
use crate::solvers::{Algorithm, Tracked, Until, Who};
use crate::statistics::{Sample, estimate, mean};
use colltrans_testkit::random::Random;

pub(super) const FIGURE_18: Experiment = Experiment {
    id: "figure-18",
    title: "incremental queries beside EGJK",
    seconds: [22.0, 110.0],
    run,
};

const WHO: [Who; 6] = [
    Who::CtaRegion(cta::Region::Automatic, Until::End),
    Who::EgjkTracked,
    Who::CtaRegion(cta::Region::Automatic, Until::Near),
    Who::Tracker,
    Who::CtaCold(cta::Region::Automatic),
    Who::VClip,
];
const REGION: usize = 0;
const EGJK: usize = 1;
const HYBRID: usize = 2;
const TRACKER: usize = 3;
const COLD: usize = 4;
const VCLIP: usize = 5;

/// Changes from query to query as in the paper, in diameters.
const DELTAS: [f64; 4] = [0.01, 0.005, 0.002_5, 0.001_3];

/// Results for all sizes and changes, for one kind of face.
struct Raced(Vec<[Results; DELTAS.len()]>);

fn run(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let [balanced, stretch, meridians] = by_kind_and_size(plan, progress, |kind, n, pass| {
        DELTAS.map(|delta| measure_sequences(plan, kind, n, delta, pass))
    })
    .map(Raced);
    let claims = vec![
        range_claim(&balanced),
        favourable_claim(&balanced),
        falls_with_change(&balanced),
        falls_with_size(&balanced),
        faces_claim(&balanced, &meridians, &stretch),
    ];
    let figures = vec![ratio_figure(&balanced, [&stretch, &meridians])];
    Finding { figures, tables: vec![phase_table(plan)], claims }
}

fn measure_sequences(plan: &Plan, kind: Kind, n: usize, delta: f64, pass: u32) -> Results {
    let race = Race {
        plan,
        figure: 18,
        kind,
        n,
        given: None,
        who: &WHO,
        coherence: Coherence::Blocks,
        length: 1 + plan.by_scale(20, 100, 100),
        blocks: plan.by_scale(2, 3, if n < 20_000 { 8 } else { 5 }),
    };
    race.run(pass, (delta * 1e6) as u64, |bodies, count, random| {
        Setting::sequence(bodies, Meeting::Colliding, delta, count, random)
    })
}

impl Raced {
    /// Returns the samples of `cost(who) / cost(EGJK)` for all sizes and changes.
    fn ratios(&self, who: usize, unit: Unit) -> Vec<Sample> {
        self.0.iter().flatten().map(|r| r.ratios(who, EGJK, unit)).collect()
    }

    fn points(&self, who: usize, change: usize, unit: Unit) -> Vec<Point> {
        let point = |at: &[Results; DELTAS.len()]| {
            let results = &at[change];
            Point::median(results.vertices(), &results.ratios(who, EGJK, unit).values())
        };
        self.0.iter().map(point).collect()
    }

    /// Formats median ratios by change and size.
    fn text(&self, who: usize, unit: Unit) -> String {
        let at = |k: usize| {
            let ratios: Vec<_> =
                self.points(who, k, unit).iter().map(|p| format!("{:.2}", p.y)).collect();
            format!("{} at {} %", ratios.join(", "), 100.0 * DELTAS[k])
        };
        (0..DELTAS.len()).map(at).collect::<Vec<_>>().join("; ")
    }

    /// Explains the range by the costs at the middle size, for the largest and the smallest change.
    fn why(&self) -> Why {
        let middle = &self.0[self.0.len() / 2];
        let at = |r: &Results| {
            let each = |who: usize| format!("{} {}", WHO[who].name(), r.cost_text(who));
            let steps = mean(&r.steps(REGION).values());
            format!(
                "{} with {steps:.1} planar problems, {}, {}",
                each(REGION),
                each(EGJK),
                each(TRACKER)
            )
        };
        Reason::Implementation.because(format!(
            "At {} vertices and a change of 1 %: {}; at 0.13 %: {}. Each query with region focus includes frames, at least \
             one planar problem, the exit test, one portal and a certificate; the paper's had no certificate: \
             [minimum of an incremental query](paper.md#what-an-incremental-query-costs-at-least).",
            grouped_digits(middle[0].vertices()),
            at(&middle[0]),
            at(&middle[DELTAS.len() - 1])
        ))
    }

    /// Explains the trend with the size: planar problems and vertices that EGJK climbs over, in the smallest and the
    /// largest bodies.
    fn why_size(&self) -> Why {
        let at = |at: &[Results; DELTAS.len()]| {
            let steps = |k: usize| mean(&at[k].steps(REGION).values());
            format!(
                "{} vertices: {:.2} planar problems at 1 %, {:.2} at 0.13 %, EGJK {:.1} and {:.1} iterations",
                grouped_digits(at[0].vertices()),
                steps(0),
                steps(DELTAS.len() - 1),
                at[0].iterations(EGJK),
                at[DELTAS.len() - 1].iterations(EGJK)
            )
        };
        Reason::Sentence.because(format!(
            "Cells shrink as bodies grow, so that the same change leads further away from the last cell. {}; {}. The paper \
             plots four curves and states the trend without numbers.",
            at(&self.0[0]),
            at(&self.0[self.0.len() - 1])
        ))
    }
}

fn ratio_figure(balanced: &Raced, thin: [&Raced; 2]) -> Figure {
    let mut lines: Vec<_> = (0..DELTAS.len())
        .map(|k| {
            new_series(
                format!("CTA, {} % D", 100.0 * DELTAS[k]),
                balanced.points(REGION, k, Unit::Time),
            )
        })
        .collect();
    lines.push(new_series(
        "CTA, 1 % D, thin (stretch of 100)",
        thin[0].points(REGION, 0, Unit::Time),
    ));
    lines
        .push(new_series("CTA, 1 % D, thin (16 meridians)", thin[1].points(REGION, 0, Unit::Time)));
    lines
        .push(new_series("CTA, 1 % D, planar problems cold", balanced.points(COLD, 0, Unit::Time)));
    lines.push(new_series("hybrid, 1 % D", balanced.points(HYBRID, 0, Unit::Time)));
    lines.push(new_series("V-Clip, 1 % D", balanced.points(VCLIP, 0, Unit::Time)));
    lines.push(new_series("feature focus, 1 % D", balanced.points(TRACKER, 0, Unit::Time)));
    let mut figure = against_size(
        "figure-18",
        "Incremental queries: time over the time of EGJK, median and quartiles",
        new_axis("time / time(EGJK)", true),
        lines,
    );
    let sizes: Vec<_> = balanced.0.iter().map(|at| at[0].vertices()).collect();
    let level = |name: &str, y: f64| reference_curve(name, sizes.iter().copied(), move |_| y);
    figure.references =
        vec![level("EGJK", 1.0), level("the paper: from 10", 10.0), level("the paper: to 2", 2.0)];
    figure
}

/// Returns the table of phases for queries that start from the solution of nearly the same one, of which most
/// need one planar problem: the minimum cost of a query with region focus.
fn phase_table(plan: &Plan) -> Table {
    let sizes = [200, 3_200, 51_200].map(|n| plan.size(n));
    let columns = std::iter::once("phase".to_owned())
        .chain(sizes.iter().map(|n| format!("{} vertices", grouped_digits(*n as f64))));
    let profiles = sizes.map(|n| phase_medians(plan, n));
    let mut rows: Vec<Vec<String>> =
        profiles[0].iter().map(|(name, _)| vec![(*name).into()]).collect();
    for profile in &profiles {
        rows.iter_mut().zip(profile).for_each(|(row, (_, each))| row.push(time_text(*each)));
    }
    rows.push(std::iter::once("together".to_owned()).collect());
    for profile in &profiles {
        let sum = profile.iter().map(|(_, each)| each).sum();
        rows.last_mut().expect("a row").push(time_text(sum));
    }
    let title = "Median time of each phase of a query of CTA with region focus, at a change of 0.01 % D, in \
                 sequences of bodies that collide"
        .into();
    Table { id: "figure-18-floor".into(), title, columns: columns.collect(), rows }
}

/// Returns the median nanoseconds of each phase.
fn phase_medians(plan: &Plan, n: usize) -> Vec<(&'static str, f64)> {
    let bodies = bodies(plan.seed, Kind::Balanced, n, 0);
    let mut random = Random::stream(plan.seed, &[18, n as u64]);
    let mut tracked = Tracked::in_region(&bodies, cta::Region::Automatic, Until::End.options());
    let mut phases: Vec<(&'static str, Vec<f64>)> = Vec::new();
    for _ in 0..plan.by_scale(2, 20, 50) {
        let sequence = Setting::sequence(&bodies, Meeting::Colliding, 1e-4, 50, &mut random);
        tracked.forget();
        for (k, setting) in sequence.iter().enumerate() {
            let mut clock = Clock::new();
            let answer = tracked.watched(setting, &mut clock);
            if k == 0 || answer.is_err() {
                continue;
            }
            let each = clock.profile().phase_times();
            if phases.is_empty() {
                phases = each.iter().map(|(name, _)| (*name, Vec::new())).collect();
            }
            phases.iter_mut().zip(each).for_each(|((_, all), (_, time))| all.push(time));
        }
    }
    phases.into_iter().map(|(name, all)| (name, median(&all))).collect()
}

/// Returns the largest of the medians.
fn largest(samples: &[Vec<f64>]) -> f64 {
    sample_medians(samples).into_iter().fold(0.0, f64::max)
}

/// Returns the smallest of the medians.
fn smallest(samples: &[Vec<f64>]) -> f64 {
    sample_medians(samples).into_iter().fold(f64::INFINITY, f64::min)
}

fn range_claim(raced: &Raced) -> Claim {
    let [counts, times] = [Unit::Instructions, Unit::Time].map(|unit| raced.ratios(REGION, unit));
    let measured = vec![
        estimate(&counts, largest),
        estimate(&counts, smallest),
        estimate(&times, largest),
        estimate(&times, smallest),
    ];
    let details = format!(
        "Medians from the smallest to the largest bodies, instructions: {}. Times: {}. Times of the hybrid: {}; with \
         planar problems cold: {}; of feature focus: {}; of V-Clip: {}.",
        raced.text(REGION, Unit::Instructions),
        raced.text(REGION, Unit::Time),
        raced.text(HYBRID, Unit::Time),
        raced.text(COLD, Unit::Time),
        raced.text(TRACKER, Unit::Time),
        raced.text(VCLIP, Unit::Time)
    );
    judged("18-range", measured, details, || raced.why())
}

fn favourable_claim(raced: &Raced) -> Claim {
    let least = |who: usize, unit: Unit| estimate(&raced.ratios(who, unit), smallest);
    let details = format!("Of the times of feature focus: {}.", least(TRACKER, Unit::Time));
    let measured = vec![least(REGION, Unit::Instructions), least(REGION, Unit::Time)];
    judged("18-egjk", measured, details, || raced.why())
}

fn falls_with_change(raced: &Raced) -> Claim {
    let last = DELTAS.len() - 1;
    let fall_of = |unit: Unit| {
        estimate(&raced.ratios(REGION, unit), |s| {
            let fall = |at: &[Vec<f64>]| median(&at[last]) / median(&at[0]);
            median(&s.chunks(DELTAS.len()).map(fall).collect::<Vec<_>>())
        })
    };
    let measured = vec![fall_of(Unit::Instructions), fall_of(Unit::Time)];
    judged("18-change", measured, String::new(), || raced.why())
}

fn falls_with_size(raced: &Raced) -> Claim {
    let fall_of = |unit: Unit| {
        estimate(&raced.ratios(REGION, unit), |s| {
            let (first, last) = (&s[..DELTAS.len()], &s[s.len() - DELTAS.len()..]);
            let fall: Vec<_> = last.iter().zip(first).map(|(l, f)| median(l) / median(f)).collect();
            median(&fall)
        })
    };
    let measured = vec![fall_of(Unit::Instructions), fall_of(Unit::Time)];
    judged("18-size", measured, String::new(), || raced.why_size())
}

/// Judges thin faces with 16 meridians, and quotes the number with a fixed stretch.
fn faces_claim(balanced: &Raced, meridians: &Raced, stretch: &Raced) -> Claim {
    let ratio_of = |thin: &Raced, unit: Unit| {
        let samples = [thin.ratios(REGION, unit), balanced.ratios(REGION, unit)].concat();
        estimate(&samples, |s| {
            let (thin, balanced) = s.split_at(s.len() / 2);
            median_of_medians(thin) / median_of_medians(balanced)
        })
    };
    let measured = vec![
        ratio_of(meridians, Unit::Instructions),
        ratio_of(meridians, Unit::Time),
        ratio_of(stretch, Unit::Instructions),
    ];
    let details = format!(
        "In the middle of all sizes and changes. Instructions on thin faces: {}.",
        meridians.text(REGION, Unit::Instructions)
    );
    judged("18-faces", measured, details, || {
        let at = |raced: &Raced| {
            let at = &raced.0[raced.0.len() / 2][DELTAS.len() - 1];
            [at.iterations(REGION), at.iterations(EGJK)]
                .map(|count| format!("{count:.1}"))
                .join(" and ")
        };
        Reason::Sentence.because(format!(
            "The paper does not state how thin the faces are. Iterations of CTA and of EGJK in bodies of the middle size, \
             at a change of 0.13 %: {} on balanced faces, {} on thin ones.",
            at(balanced),
            at(meridians)
        ))
    })
}
