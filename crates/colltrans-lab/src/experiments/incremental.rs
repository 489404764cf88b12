//! Figure 18: from query to query, beside enhanced GJK.

use colltrans::Region;

use super::{
    Coherence, Parts, Race, Results, about, axis, claim, extremes, reference, series, share,
    shares, thousands, time,
};
use crate::Experiment;
use crate::contestants::{PAPER_GAP, Until, Who};
use crate::finding::{Claim, Figure, Finding, Point};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::Kind;
use colltrans_kit::timing::median;

pub(super) const FIGURE_18: Experiment =
    Experiment { id: "figure-18", title: "incremental queries beside EGJK", run };

const WHO: [Who; 3] = [Who::CtaRegion(Region::Automatic, Until::Near), Who::Egjk, Who::Tracker];
const EGJK: usize = 1;
const TRACKER: usize = 2;

/// Changes from query to query, in diameters.
const DELTAS: [f64; 6] = [0.000_625, 0.001_25, 0.002_5, 0.005, 0.01, 0.02];

/// Medians of `time / time(EGJK)` against the change, at one size.
struct Incremental {
    n: f64,
    region: Vec<Point>,
    tracker: Vec<Point>,
    /// Median times of region focus, EGJK and feature focus, at the smallest and largest change.
    times: [[f64; 3]; 2],
}

fn run(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let sizes: Vec<_> = plan.sizes().iter().copied().filter(|n| *n < 100_000).collect();
    let mut parts = Parts::new(progress, shares(&sizes));
    let measured: Vec<_> = sizes
        .iter()
        .map(|&n| {
            parts.begin(share(n), &format!("{} vertices", thousands(n as f64)));
            let results = DELTAS.map(|delta| sequences(plan, n, delta));
            let points = |who: usize| {
                let point = |(delta, r): (&f64, &Results)| {
                    Point::median(100.0 * delta, &r.ratios(who, EGJK))
                };
                DELTAS.iter().zip(&results).map(point).collect()
            };
            let at = |k: usize| [0, EGJK, TRACKER].map(|who| median(&results[k].times(who)));
            let times = [at(0), at(DELTAS.len() - 1)];
            Incremental { n: n as f64, region: points(0), tracker: points(TRACKER), times }
        })
        .collect();
    let name = |what: &str, m: &Incremental| format!("{what}, {} vertices", thousands(m.n));
    let mut lines: Vec<_> =
        measured.iter().map(|m| series(name("CTA", m), m.region.clone())).collect();
    let ends = measured.first().into_iter().chain(measured.last());
    lines.extend(ends.map(|m| series(name("feature focus", m), m.tracker.clone())));
    let figure = Figure {
        id: "figure-18".into(),
        title: "Incremental queries: time over the time of EGJK, median and quartiles".into(),
        x: axis("change from query to query (% D)", true),
        y: axis("time / time(EGJK)", true),
        series: lines,
        references: vec![reference("EGJK", DELTAS.iter().map(|d| 100.0 * d), |_| 1.0)],
    };
    Finding { figures: vec![figure], tables: Vec::new(), claims: vec![falls_to_two(&measured)] }
}

fn sequences(plan: &Plan, n: usize, delta: f64) -> Results {
    let race = Race {
        plan,
        figure: 18,
        kind: Kind::Balanced,
        n,
        who: &WHO,
        coherence: Coherence::Blocks,
        length: 51,
        blocks: plan.by_scale(2, 120, 600),
    };
    race.run((delta * 1e6) as u64, |bodies, count, random| {
        Setting::sequence(bodies, Meeting::Colliding, delta, count, random)
    })
}

/// The paper's 10 and 2, each give or take a quarter, in the middle of all sizes at the ends of the
/// range of changes.
fn falls_to_two(measured: &[Incremental]) -> Claim {
    let middle_at = |k: usize| {
        let points: Vec<_> = measured.iter().map(|m| m.region[k]).collect();
        super::middle(&points)
    };
    let [small, large] = [middle_at(0), middle_at(DELTAS.len() - 1)];
    let text: Vec<_> = measured
        .iter()
        .map(|m| {
            let [low, high] = extremes(&m.region);
            format!("{low:.1} to {high:.1} at {} vertices", thousands(m.n))
        })
        .collect();
    let tracker: Vec<_> = measured.iter().map(|m| m.tracker[0]).collect();
    claim(
        "Incremental: time(CTA)/time(EGJK) falls from 10 to 2 as the change from query to query \
         falls.",
        format!(
            "In the middle of all sizes {large:.1} at {} %, {small:.1} at {} %; {}. Feature focus \
             instead of the paper's: {:.2} at {} %.",
            100.0 * DELTAS[DELTAS.len() - 1],
            100.0 * DELTAS[0],
            text.join(", "),
            super::middle(&tracker),
            100.0 * DELTAS[0],
        ),
        small < large && about(large, 10.0) && about(small, 2.0),
        || {
            let times = |m: &Incremental| {
                let [small, large] = m.times.map(|of| of.map(time));
                format!(
                    "At {} vertices, from the largest to the smallest change, CTA goes from {} to \
                     {}, EGJK from {} to {} and feature focus from {} to {}.",
                    thousands(m.n),
                    large[0],
                    small[0],
                    large[1],
                    small[1],
                    large[2],
                    small[2]
                )
            };
            format!(
                "{} A query with region focus, to a gap of {PAPER_GAP}, solves one planar problem \
                 whatever the change (figure 14), and frames, portal refinement and certificate \
                 cost as much as ever; EGJK has less and less to do, down to confirming a simplex \
                 with support points next to the last ones.",
                measured.get(measured.len() / 2).map_or(String::new(), times)
            )
        },
    )
}
