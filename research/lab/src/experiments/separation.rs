//! Figure 12: the cost of detecting that bodies pass each other.

use super::{
    Coherence, Gathered, Race, Results, Unit, against_size, grouped_digits, in_passes,
    listed_values, median, new_axis, new_series, reference_curve, time_text,
};
use crate::Experiment;
use crate::claims::{Claim, Reason, Why, judged};
use crate::finding::{Finding, Point};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::Kind;
use crate::solvers::{PAPER_GAP, Until, Who};
use crate::statistics::{Sample, estimate, mean};

pub(super) const FIGURE_12: Experiment =
    Experiment { id: "figure-12", title: "separation beside collision", seconds: [7.0, 28.0], run };

const WHO: [Who; 3] = [Who::Cta(Until::End), Who::Cta(Until::Near), Who::Portal];
const CTA: usize = 0;
const HYBRID: usize = 1;
const PORTAL: usize = 2;

/// Least distances during the motion as in the paper, in diameters: from very close to far.
const GAPS: [f64; 4] = [0.005, 0.05, 0.5, 1.5];
const NEAR: usize = 0;
const FAR: usize = 3;

/// For each size, the settings that collide, and those that pass, by least distance.
struct Measured {
    colliding: Results,
    passing: [Results; GAPS.len()],
}

impl Gathered for Measured {
    fn gather(&mut self, more: Self) {
        self.colliding.gather(more.colliding);
        self.passing.gather(more.passing);
    }
}

/// Runs the experiment.
fn run(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let told = |&n: &usize| (n, format!("{} vertices", grouped_digits(n as f64)));
    let all = in_passes(plan, progress, plan.sizes(), told, |&n, pass| measure(plan, n, pass));
    // For the paper's algorithm all distances are drawn, for others the smallest and the largest one.
    let drawn =
        [(CTA, 0), (CTA, 1), (CTA, 2), (CTA, 3), (HYBRID, NEAR), (PORTAL, NEAR), (PORTAL, FAR)];
    let lines = drawn.map(|(who, gap)| {
        let name = format!("{}, passing at {} D", WHO[who].name(), GAPS[gap]);
        new_series(name, time_ratios(&all, who, gap))
    });
    let mut figure = against_size(
        "figure-12",
        "Time to find a separation over the median time to find a collision, median and quartiles",
        new_axis("time(separation) / time(collision)", true),
        lines.to_vec(),
    );
    let at = || all.iter().map(|m| m.colliding.vertices());
    figure.references = vec![
        reference_curve("the paper, 0.005 D: half", at(), |_| 0.5),
        reference_curve("the paper, 1.5 D: a third", at(), |_| 1.0 / 3.0),
    ];
    let claims =
        vec![separation_claim(&all, "12-near", NEAR), separation_claim(&all, "12-far", FAR)];
    Finding { figures: vec![figure], tables: Vec::new(), claims }
}

/// Measures one pass at one size.
fn measure(plan: &Plan, n: usize, pass: u32) -> Measured {
    let race = Race {
        plan,
        figure: 12,
        kind: Kind::Balanced,
        n,
        given: None,
        who: &WHO,
        coherence: Coherence::Scratch,
        length: plan.by_scale(5, 50, 50),
        blocks: plan.by_scale(2, 3, if n < 20_000 { 6 } else { 3 }),
    };
    let [colliding, a, b, c, d] = race.run_in_turns(pass, 0, |variant, bodies, count, random| {
        let meeting = match variant {
            0 => Meeting::Colliding,
            gap => Meeting::Passing(GAPS[gap - 1]),
        };
        (0..count).map(|_| Setting::draw(bodies, meeting, random)).collect()
    });
    Measured { colliding, passing: [a, b, c, d] }
}

/// Returns the times of separations over the median time of collisions, for every size.
fn time_ratios(all: &[Measured], who: usize, gap: usize) -> Vec<Point> {
    let point = |m: &Measured| {
        let usual = median(&m.colliding.times(who));
        let ratios: Vec<_> = m.passing[gap].times(who).iter().map(|t| t / usual).collect();
        Point::median(m.colliding.vertices(), &ratios)
    };
    all.iter().map(point).collect()
}

/// Judges the ratio of medians, as the mean over all sizes.
fn separation_claim(all: &[Measured], id: &str, gap: usize) -> Claim {
    let of = |who: usize, unit: Unit| {
        let passing = all.iter().map(|m| m.passing[gap].costs(who, unit));
        let colliding = all.iter().map(|m| m.colliding.costs(who, unit));
        let samples: Vec<Sample> = passing.chain(colliding).collect();
        estimate(&samples, |s| {
            let (passing, colliding) = s.split_at(s.len() / 2);
            let ratios = passing.iter().zip(colliding).map(|(p, c)| median(p) / median(c));
            mean(&ratios.collect::<Vec<_>>())
        })
    };
    let others: Vec<_> = (0..GAPS.len())
        .map(|k| {
            let typical: Vec<_> = time_ratios(all, CTA, k).iter().map(|p| p.y).collect();
            format!("{:.2} at {} D", mean(&typical), GAPS[k])
        })
        .collect();
    let details = format!(
        "The means over all sizes. Ratios of times by size: {}; of all distances: {}. Of the times of the hybrid {}: its \
         collisions end at a gap of {PAPER_GAP}, its separations do not.",
        listed_values(&time_ratios(all, CTA, gap), 2),
        others.join(", "),
        of(HYBRID, Unit::Time)
    );
    let measured = vec![of(CTA, Unit::Instructions), of(CTA, Unit::Time)];
    judged(id, measured, details, || explanation(all))
}

/// Explains the result by the planar problems at the middle size.
fn explanation(all: &[Measured]) -> Why {
    let m = &all[all.len() / 2];
    let each = |r: &Results| {
        let steps = mean(&r.steps(CTA).values());
        let (each, inner) = (time_text(median(&r.times(CTA)) / steps), r.iterations(CTA) / steps);
        format!("{steps:.1}, {each} and {inner:.0} iterations each")
    };
    let passing: Vec<_> =
        GAPS.iter().zip(&m.passing).map(|(gap, r)| format!("{} at {gap} D", each(r))).collect();
    Reason::Implementation.because(format!(
        "Planar problems at {} vertices, and the time of a query shared out among them: {} for a \
         collision; {}.",
        grouped_digits(m.colliding.vertices()),
        each(&m.colliding),
        passing.join("; ")
    ))
}
