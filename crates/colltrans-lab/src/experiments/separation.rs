//! Figure 12: what it costs to find that bodies pass each other.

use super::{
    Coherence, Parts, Race, Results, about, against_size, axis, claim, listed, reference, series,
    share, shares, thousands, time,
};
use crate::Experiment;
use crate::contestants::{PAPER_GAP, Until, Who};
use crate::finding::{Claim, Finding, Point};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::Kind;
use colltrans_kit::timing::{mean_and_deviation, median};

pub(super) const FIGURE_12: Experiment =
    Experiment { id: "figure-12", title: "separation beside collision", run };

const WHO: [Who; 2] = [Who::Cta(Until::Near), Who::Portal];

/// Shadow gaps, in diameters: near, and far.
const GAPS: [f64; 4] = [0.005, 0.05, 0.5, 1.5];

/// At every size, the settings that collide, and those that pass, by gap.
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
            let passing = |k: usize| measure(plan, n, 1 + k as u64, Meeting::Passing(GAPS[k]));
            Measured {
                colliding: measure(plan, n, 0, Meeting::Colliding),
                passing: std::array::from_fn(passing),
            }
        })
        .collect();
    // All gaps for the paper's algorithm, the nearest and farthest for ours.
    let drawn = [(0, 0), (0, 1), (0, 2), (0, 3), (1, 0), (1, 3)];
    let lines = drawn.map(|(who, gap)| {
        let name = format!("{}, passing at {} D", WHO[who].name(), GAPS[gap]);
        series(name, ratios(&all, who, gap))
    });
    let mut figure = against_size(
        "figure-12",
        "Time to find a separation over the median time to find a collision, median and quartiles",
        axis("time(separation) / time(collision)", false),
        lines.to_vec(),
    );
    let at = || all.iter().map(|m| m.colliding.vertices);
    figure.references =
        vec![reference("1/2", at(), |_| 0.5), reference("1/3", at(), |_| 1.0 / 3.0)];
    Finding { figures: vec![figure], tables: Vec::new(), claims: vec![near(&all), far(&all)] }
}

fn measure(plan: &Plan, n: usize, purpose: u64, meeting: Meeting) -> Results {
    let race = Race {
        plan,
        figure: 12,
        kind: Kind::Balanced,
        n,
        who: &WHO,
        coherence: Coherence::Scratch,
        length: plan.by_scale(5, 60, 100),
        blocks: plan.by_scale(2, 20, 80),
    };
    race.run(purpose, |bodies, count, random| {
        (0..count).map(|_| Setting::draw(bodies, meeting, random)).collect()
    })
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

/// The mean over all sizes.
fn typical(all: &[Measured], gap: usize) -> f64 {
    let points = ratios(all, 0, gap);
    points.iter().map(|p| p.y).sum::<f64>() / points.len() as f64
}

fn near(all: &[Measured]) -> Claim {
    let typical = typical(all, 0);
    claim(
        "Bodies that pass at 0.005 diameters cost about half as much as bodies that collide.",
        format!("{typical:.2} on average over all sizes: {}.", listed(&ratios(all, 0, 0), 2)),
        about(typical, 0.5),
        || why(all),
    )
}

fn far(all: &[Measured]) -> Claim {
    let each = [1, 2, 3].map(|gap| typical(all, gap));
    let text: Vec<_> =
        GAPS[1..].iter().zip(each).map(|(gap, t)| format!("{t:.2} at {gap} D")).collect();
    claim(
        "Bodies that pass at 0.05 diameters or more cost about a third.",
        format!("On average over all sizes {}.", text.join(", ")),
        each.iter().all(|typical| about(*typical, 1.0 / 3.0)),
        || why(all),
    )
}

/// What the planar problems say, at the middle size.
fn why(all: &[Measured]) -> String {
    let Some(m) = all.get(all.len() / 2) else { return String::new() };
    let steps = |r: &Results| mean_and_deviation(&r.counts(0, |w| w.steps))[0];
    let each = |r: &Results| {
        let steps = steps(r);
        format!("{steps:.1}, {} each", time(median(&r.times(0)) / steps))
    };
    let passing: Vec<_> =
        GAPS.iter().zip(&m.passing).map(|(gap, r)| format!("{} at {gap} D", each(r))).collect();
    format!(
        "It is not the number of steps alone. At {} vertices a collision takes as many planar \
         problems as this, down to a gap of {PAPER_GAP}, where portal refinement takes over: {}, \
         all the rest of the query shared out among them. A separation: {}.",
        thousands(m.colliding.vertices),
        each(&m.colliding),
        passing.join("; ")
    )
}
