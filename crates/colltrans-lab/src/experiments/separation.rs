//! Figure 12: what it costs to find that bodies pass each other.

use super::{
    ABOUT, Coherence, Parts, Race, Results, about, against_size, axis, claim, listed, reference,
    series, share, shares, thousands,
};
use crate::Experiment;
use crate::contestants::Who;
use crate::finding::{Claim, Finding, Point};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::Kind;
use crate::timing::{median, median_point};

pub(super) const FIGURE_12: Experiment =
    Experiment { id: "figure-12", title: "separation beside collision", run };

const WHO: [Who; 2] = [Who::Cta, Who::Portal];

/// Shadow gaps, in diameters: near, and far.
const GAPS: [f64; 4] = [0.005, 0.05, 0.5, 1.5];

fn run(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let mut parts = Parts::new(progress, shares(plan.sizes()));
    // Curve by contestant and gap.
    let mut curves = [const { [const { Vec::<Point>::new() }; GAPS.len()] }; WHO.len()];
    for &n in plan.sizes() {
        parts.begin(share(n), &format!("{} vertices", thousands(n as f64)));
        let colliding = measure(plan, n, 0, Meeting::Colliding);
        for (k, gap) in GAPS.into_iter().enumerate() {
            let passing = measure(plan, n, 1 + k as u64, Meeting::Passing(gap));
            for (who, curves) in curves.iter_mut().enumerate() {
                let usual = median(&colliding.times(who));
                let ratios: Vec<_> = passing.times(who).iter().map(|t| t / usual).collect();
                curves[k].push(median_point(passing.vertices, &ratios));
            }
        }
    }
    let lines = WHO.iter().zip(&curves).flat_map(|(who, curves)| {
        let name = |gap: f64| format!("{}, passing at {gap} D", who.name());
        GAPS.iter().zip(curves).map(move |(gap, points)| series(name(*gap), points.clone()))
    });
    let mut figure = against_size(
        "figure-12",
        "Time to find a separation over the median time to find a collision, median and quartiles",
        axis("time(separation) / time(collision)", false),
        lines.collect(),
    );
    let at = || plan.sizes().iter().map(|n| *n as f64);
    figure.references =
        vec![reference("1/2", at(), |_| 0.5), reference("1/3", at(), |_| 1.0 / 3.0)];
    let claims = vec![near(&curves[0][0]), far(&curves[0][1..])];
    Finding { figures: vec![figure], tables: Vec::new(), claims }
}

fn measure(plan: &Plan, n: usize, purpose: u64, meeting: Meeting) -> Results {
    let race = Race {
        plan,
        figure: 12,
        kind: Kind::Balanced,
        n,
        who: &WHO,
        coherence: Coherence::Scratch,
        length: plan.by_scale(5, 20, 20),
        blocks: plan.by_scale(2, 15, 60),
    };
    race.run(purpose, |bodies, count, random| {
        (0..count).map(|_| Setting::draw(bodies, meeting, random)).collect()
    })
}

fn mean(points: &[Point]) -> f64 {
    points.iter().map(|p| p.y).sum::<f64>() / points.len() as f64
}

fn near(points: &[Point]) -> Claim {
    let typical = mean(points);
    claim(
        "Bodies that pass at 0.005 diameters cost about half as much as bodies that collide.",
        format!("{typical:.2} on average over all sizes: {}.", listed(points, 2)),
        about(typical, 0.5),
        || why(typical < 0.5),
    )
}

fn far(curves: &[Vec<Point>]) -> Claim {
    let typical = curves.iter().map(|points| mean(points)).sum::<f64>() / curves.len() as f64;
    let text: Vec<_> = GAPS[1..]
        .iter()
        .zip(curves)
        .map(|(gap, points)| format!("{:.2} at {gap} D", mean(points)))
        .collect();
    claim(
        "Bodies that pass at 0.05 diameters or more cost about a third.",
        format!("{typical:.2} on average over all sizes; {}.", text.join(", ")),
        about(typical, 1.0 / 3.0),
        || why(typical < 1.0 / 3.0),
    )
}

fn why(less: bool) -> String {
    if less {
        format!(
            "They cost less here, by more than {:.0} %: two or three planar problems that find \
             separated sections, put together, prove that the bodies pass, and the proof is made at \
             once; a collision, which is also followed down to its last feature, pays for more.",
            100.0 * ABOUT
        )
    } else {
        "They cost more here: a collision has become cheaper, because portal refinement ends it \
         after a few planar problems, while every query pays for frames, the first planar problem \
         and the certificate."
            .into()
    }
}
