//! Figure 12: what it costs to find that bodies pass each other.

use super::{
    Coherence, Parts, Race, Results, against_size, axis, listed, median, reference, series, share,
    shares, thousands, time,
};
use crate::Experiment;
use crate::claims::{Claim, judged};
use crate::finding::{Finding, Point};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::Kind;
use crate::solvers::{PAPER_GAP, Until, Who};
use crate::statistics::{Sample, estimate, mean};

pub(super) const FIGURE_12: Experiment =
    Experiment { id: "figure-12", title: "separation beside collision", run };

const WHO: [Who; 2] = [Who::Cta(Until::Near), Who::Portal];

/// The paper's least distances during the motion, in diameters: from very close to far.
const GAPS: [f64; 4] = [0.005, 0.05, 0.5, 1.5];
const NEAR: usize = 0;
const FAR: usize = 3;

/// At every size, the settings that collide, and those that pass, by least distance.
struct Measured {
    colliding: Results,
    passing: [Results; GAPS.len()],
}

fn run(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let mut parts = Parts::new(progress, shares(plan.sizes()));
    let all: Vec<_> = plan
        .sizes()
        .iter()
        .map(|&n| {
            parts.begin(share(n), &format!("{} vertices", thousands(n as f64)));
            measure(plan, n)
        })
        .collect();
    // All distances for the paper's algorithm, the least and largest for ours.
    let drawn = [(0, 0), (0, 1), (0, 2), (0, 3), (1, 0), (1, 3)];
    let lines = drawn.map(|(who, gap)| {
        let name = format!("{}, passing at {} D", WHO[who].name(), GAPS[gap]);
        series(name, ratios(&all, who, gap))
    });
    let mut figure = against_size(
        "figure-12",
        "Time to find a separation over the median time to find a collision, median and quartiles",
        axis("time(separation) / time(collision)", true),
        lines.to_vec(),
    );
    let at = || all.iter().map(|m| m.colliding.vertices);
    figure.references = vec![
        reference("the paper, 0.005 D: half", at(), |_| 0.5),
        reference("the paper, 1.5 D: a third", at(), |_| 1.0 / 3.0),
    ];
    let claims = vec![passes(&all, "12-near", NEAR), passes(&all, "12-far", FAR)];
    Finding { figures: vec![figure], tables: Vec::new(), claims }
}

fn measure(plan: &Plan, n: usize) -> Measured {
    let race = Race {
        plan,
        figure: 12,
        kind: Kind::Balanced,
        n,
        given: None,
        who: &WHO,
        coherence: Coherence::Scratch,
        length: plan.by_scale(5, 50, 100),
        blocks: plan.by_scale(2, 12, 60),
    };
    let [colliding, a, b, c, d] = race.run_in_turns(0, |variant, bodies, count, random| {
        let meeting = match variant {
            0 => Meeting::Colliding,
            gap => Meeting::Passing(GAPS[gap - 1]),
        };
        (0..count).map(|_| Setting::draw(bodies, meeting, random)).collect()
    });
    Measured { colliding, passing: [a, b, c, d] }
}

/// Times of separations over the median time of collisions, at every size.
fn ratios(all: &[Measured], who: usize, gap: usize) -> Vec<Point> {
    let point = |m: &Measured| {
        let usual = median(&m.colliding.times(who));
        let ratios: Vec<_> = m.passing[gap].times(who).iter().map(|t| t / usual).collect();
        Point::median(m.colliding.vertices, &ratios)
    };
    all.iter().map(point).collect()
}

/// The ratio of medians, the mean over all sizes.
fn passes(all: &[Measured], id: &str, gap: usize) -> Claim {
    let of = |results: fn(&Measured, usize) -> &Results| {
        all.iter().map(move |m| results(m, gap).time_sample(0))
    };
    let samples: Vec<Sample> =
        of(|m, gap| &m.passing[gap]).chain(of(|m, _| &m.colliding)).collect();
    let measured = estimate(&samples, |s| {
        let (passing, colliding) = s.split_at(s.len() / 2);
        let ratios = passing.iter().zip(colliding).map(|(p, c)| median(p) / median(c));
        mean(&ratios.collect::<Vec<_>>())
    });
    let others: Vec<_> = (0..GAPS.len())
        .map(|k| {
            let typical: Vec<_> = ratios(all, 0, k).iter().map(|p| p.y).collect();
            format!("{:.2} at {} D", mean(&typical), GAPS[k])
        })
        .collect();
    let details = format!(
        "The mean over all sizes; by size {}. All distances: {}.",
        listed(&ratios(all, 0, gap), 2),
        others.join(", ")
    );
    judged(id, vec![measured], details, || why(all))
}

/// What the planar problems say, at the middle size.
fn why(all: &[Measured]) -> String {
    let Some(m) = all.get(all.len() / 2) else { return String::new() };
    let each = |r: &Results| {
        let steps = mean(&r.steps(0).values());
        let (each, inner) = (time(median(&r.times(0)) / steps), r.iterations(0) / steps);
        format!("{steps:.1}, {each} and {inner:.0} iterations each")
    };
    let passing: Vec<_> =
        GAPS.iter().zip(&m.passing).map(|(gap, r)| format!("{} at {gap} D", each(r))).collect();
    format!(
        "Planar problems at {} vertices, and the time of a query shared out among them: {} for a \
         collision, down to a gap of {PAPER_GAP}, where portal refinement takes over; {}.",
        thousands(m.colliding.vertices),
        each(&m.colliding),
        passing.join("; ")
    )
}
