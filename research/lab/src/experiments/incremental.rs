//! Figure 18: from query to query, beside enhanced GJK.

use colltrans::Region;
use colltrans_baselines::egjk::SupportSearch;

use super::{
    Coherence, Parts, Race, Results, against_size, axis, median, medians, middle, reference,
    series, share, shares, thousands, time,
};
use crate::Experiment;
use crate::claims::{Claim, judged};
use crate::finding::{Figure, Finding, Point};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::Kind;
use crate::solvers::{PAPER_GAP, Until, Who};
use crate::statistics::{Sample, estimate};

pub(super) const FIGURE_18: Experiment =
    Experiment { id: "figure-18", title: "incremental queries beside EGJK", run };

const WHO: [Who; 3] = [
    Who::CtaRegion(Region::Automatic, Until::Near),
    Who::Egjk(SupportSearch::Climbing),
    Who::Tracker,
];
const REGION: usize = 0;
const EGJK: usize = 1;
const TRACKER: usize = 2;

/// The paper's changes from query to query, in diameters.
const DELTAS: [f64; 4] = [0.01, 0.005, 0.002_5, 0.001_3];

/// All sizes and changes, for one kind of face.
struct Raced(Vec<[Results; DELTAS.len()]>);

fn run(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let sizes: Vec<_> = plan.sizes().iter().copied().filter(|n| *n < 100_000).collect();
    let mut parts = Parts::new(progress, 2.0 * shares(&sizes));
    let [balanced, thin] = [Kind::Balanced, Kind::Thin].map(|kind| {
        let at = |&n: &usize| {
            let doing = format!("{} bodies, {} vertices", kind.name(), thousands(n as f64));
            parts.begin(share(n), &doing);
            DELTAS.map(|delta| sequences(plan, kind, n, delta))
        };
        Raced(sizes.iter().map(at).collect())
    });
    let claims = vec![
        range(&balanced),
        favourable(&balanced),
        falls_with_change(&balanced),
        falls_with_size(&balanced),
        faces(&balanced, &thin),
    ];
    Finding { figures: vec![figure(&balanced, &thin)], tables: Vec::new(), claims }
}

fn sequences(plan: &Plan, kind: Kind, n: usize, delta: f64) -> Results {
    let race = Race {
        plan,
        figure: 18,
        kind,
        n,
        given: None,
        who: &WHO,
        coherence: Coherence::Blocks,
        length: 1 + plan.by_scale(20, 100, 100),
        blocks: plan.by_scale(2, 24, 120),
    };
    race.run((delta * 1e6) as u64, |bodies, count, random| {
        Setting::sequence(bodies, Meeting::Colliding, delta, count, random)
    })
}

impl Raced {
    /// `time(who) / time(EGJK)`: for each size the samples of all changes.
    fn ratios(&self, who: usize) -> Vec<Sample> {
        self.0.iter().flatten().map(|r| r.ratios(who, EGJK)).collect()
    }

    fn points(&self, who: usize, change: usize) -> Vec<Point> {
        let point = |at: &[Results; DELTAS.len()]| {
            let results = &at[change];
            Point::median(results.vertices, &results.ratios(who, EGJK).values())
        };
        self.0.iter().map(point).collect()
    }

    /// Median ratios: sizes, and at each the changes.
    fn text(&self, who: usize) -> String {
        let at = |k: usize| {
            let ratios: Vec<_> =
                self.points(who, k).iter().map(|p| format!("{:.2}", p.y)).collect();
            format!("{} at {} %", ratios.join(", "), 100.0 * DELTAS[k])
        };
        (0..DELTAS.len()).map(at).collect::<Vec<_>>().join("; ")
    }

    fn why(&self) -> String {
        let middle = &self.0[self.0.len() / 2];
        let at = |r: &Results| {
            let [cta, egjk, tracker] = [0, 1, 2].map(|who| time(median(&r.times(who))));
            format!("CTA {cta}, EGJK {egjk}, feature focus {tracker}")
        };
        format!(
            "At {} vertices: at a change of 1 % {}; at 0.13 % {}. Every query with region focus, to a gap of {PAPER_GAP}, pays for \
             frames, a planar problem or more, portal refinement and a certificate.",
            thousands(middle[0].vertices),
            at(&middle[0]),
            at(&middle[DELTAS.len() - 1])
        )
    }
}

fn figure(balanced: &Raced, thin: &Raced) -> Figure {
    let mut lines: Vec<_> = (0..DELTAS.len())
        .map(|k| series(format!("CTA, {} % D", 100.0 * DELTAS[k]), balanced.points(REGION, k)))
        .collect();
    lines.push(series("CTA, 1 % D, thin faces", thin.points(REGION, 0)));
    let last = DELTAS.len() - 1;
    lines.push(series("feature focus, 1 % D", balanced.points(TRACKER, 0)));
    lines.push(series("feature focus, 0.13 % D", balanced.points(TRACKER, last)));
    let mut figure = against_size(
        "figure-18",
        "Incremental queries: time over the time of EGJK (climbing), median and quartiles",
        axis("time / time(EGJK)", true),
        lines,
    );
    let sizes: Vec<_> = balanced.0.iter().map(|at| at[0].vertices).collect();
    let level = |name: &str, y: f64| reference(name, sizes.iter().copied(), move |_| y);
    figure.references =
        vec![level("EGJK", 1.0), level("the paper: from 10", 10.0), level("the paper: to 2", 2.0)];
    figure
}

fn range(raced: &Raced) -> Claim {
    let ratios = raced.ratios(REGION);
    let most = estimate(&ratios, |s| medians(s).into_iter().fold(0.0, f64::max));
    let least = estimate(&ratios, |s| medians(s).into_iter().fold(f64::INFINITY, f64::min));
    let details = format!(
        "Medians from the smallest to the largest bodies: {}. Feature focus instead of region focus: \
         {}.",
        raced.text(REGION),
        raced.text(TRACKER)
    );
    judged("18-range", vec![most, least], details, || raced.why())
}

fn favourable(raced: &Raced) -> Claim {
    let fold = |s: &[Vec<f64>]| medians(s).into_iter().fold(f64::INFINITY, f64::min);
    let least = estimate(&raced.ratios(REGION), fold);
    let tracker = estimate(&raced.ratios(TRACKER), fold);
    judged("18-egjk", vec![least], format!("With feature focus: {tracker}."), || raced.why())
}

fn falls_with_change(raced: &Raced) -> Claim {
    let last = DELTAS.len() - 1;
    let measured = estimate(&raced.ratios(REGION), |s| {
        let fall = |at: &[Vec<f64>]| median(&at[last]) / median(&at[0]);
        median(&s.chunks(DELTAS.len()).map(fall).collect::<Vec<_>>())
    });
    judged("18-change", vec![measured], String::new(), || raced.why())
}

fn falls_with_size(raced: &Raced) -> Claim {
    let measured = estimate(&raced.ratios(REGION), |s| {
        let (first, last) = (&s[..DELTAS.len()], &s[s.len() - DELTAS.len()..]);
        let fall: Vec<_> = last.iter().zip(first).map(|(l, f)| median(l) / median(f)).collect();
        median(&fall)
    });
    judged("18-size", vec![measured], String::new(), || raced.why())
}

fn faces(balanced: &Raced, thin: &Raced) -> Claim {
    let samples = [thin.ratios(REGION), balanced.ratios(REGION)].concat();
    let measured = estimate(&samples, |s| {
        let (thin, balanced) = s.split_at(s.len() / 2);
        middle(thin) / middle(balanced)
    });
    let details = format!("In the middle of all sizes and changes. Thin: {}.", thin.text(REGION));
    judged("18-faces", vec![measured], details, || {
        let at = |raced: &Raced| raced.0[raced.0.len() / 2][DELTAS.len() - 1].iterations(REGION);
        format!(
            "Iterations of all loops of CTA in bodies of the middle size, at a change of 0.13 %: {:.0} \
             on balanced and {:.0} on thin faces.",
            at(balanced),
            at(thin)
        )
    })
}
