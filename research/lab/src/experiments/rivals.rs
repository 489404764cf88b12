//! Figures 15 to 17: single queries compared with enhanced GJK and PQP, which compute the distance at the start of
//! the same settings, and with the ray cast, which answers the same question.

use colltrans_baselines::egjk::SupportSearch;

use super::{
    Coherence, Race, Results, against_size, exponent_of, grouped_digits, in_passes, listed_values,
    median_of_medians, new_axis, new_series, reference_curve, time_text,
};
use crate::Experiment;
use crate::claims::{Claim, Reason, Why, judged};
use crate::finding::{Figure, Finding, Point, Table};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::Kind;
use crate::solvers::{Until, Who};
use crate::statistics::{Estimate, Sample, estimate, mean};
use colltrans_testkit::timing::median;

pub(super) const FIGURE_15: Experiment = Experiment {
    id: "figure-15",
    title: "balanced faces, beside EGJK and PQP",
    seconds: [20.0, 80.0],
    run: balanced_experiment,
};

pub(super) const FIGURE_16: Experiment = Experiment {
    id: "figure-16",
    title: "thin faces, beside EGJK and PQP",
    seconds: [22.0, 90.0],
    run: thin_experiment,
};

pub(super) const FIGURE_17: Experiment = Experiment {
    id: "figure-17",
    title: "thin faces, bodies that pass within 1 %, beside EGJK and PQP",
    seconds: [35.0, 130.0],
    run: thin_and_near,
};

pub(super) const WHO: [Who; 7] = [
    Who::Cta(Until::End),
    Who::Egjk(SupportSearch::Climbing),
    Who::Egjk(SupportSearch::Linear),
    Who::Pqp,
    Who::Cta(Until::Near),
    Who::Portal,
    Who::RayCast,
];
const CTA: usize = 0;
const CLIMBING: usize = 1;
const LINEAR: usize = 2;
const PQP: usize = 3;
const HYBRID: usize = 4;

/// One race at every size.
struct Field(Vec<Results>);

/// Runs a race on two kinds of bodies at all sizes.
fn run_race(
    plan: &Plan,
    progress: &mut dyn Progress,
    figure: u64,
    kinds: [Kind; 2],
    meeting: Meeting,
) -> [Field; 2] {
    let items: Vec<_> =
        kinds.into_iter().flat_map(|kind| plan.sizes().iter().map(move |n| (kind, *n))).collect();
    let told = |&(kind, n): &(Kind, usize)| {
        (n, format!("{} bodies, {} vertices", kind.name(), grouped_digits(n as f64)))
    };
    let mut measured = in_passes(plan, progress, &items, told, |&(kind, n), pass| {
        let is_large = n >= 20_000;
        let race = Race {
            plan,
            figure,
            kind,
            n,
            given: None,
            who: &WHO,
            coherence: Coherence::Scratch,
            // Blocks are long, because an algorithm in use finds its bodies in the caches.
            length: plan.by_scale(5, if is_large { 40 } else { 50 }, 50),
            blocks: plan.by_scale(2, if is_large { 1 } else { 3 }, if is_large { 1 } else { 4 }),
        };
        race.run(pass, 0, |bodies, count, random| {
            (0..count).map(|_| Setting::draw(bodies, meeting, random)).collect()
        })
    })
    .into_iter();
    kinds.map(|_| Field(measured.by_ref().take(plan.sizes().len()).collect()))
}

impl Field {
    fn sizes(&self) -> Vec<f64> {
        self.0.iter().map(Results::vertices).collect()
    }

    /// Returns `time(who) / time(CTA)` for each query.
    fn ratios(&self, who: usize) -> Vec<Sample> {
        self.0.iter().map(|at| at.ratios(who, CTA)).collect()
    }

    /// Returns the medians of the ratios with quartiles.
    fn points(&self, who: usize) -> Vec<Point> {
        let ratios = self.ratios(who);
        ratios
            .iter()
            .zip(&self.0)
            .map(|(s, at)| Point::median(at.vertices(), &s.values()))
            .collect()
    }

    /// Returns the median ratio at one size, or at the largest size if that is smaller.
    fn ratio_at(&self, who: usize, n: f64) -> Estimate {
        let last = self.0.len() - 1;
        let k = self.0.iter().position(|at| at.vertices() > 0.9 * n).unwrap_or(last);
        estimate(&[self.0[k].ratios(who, CTA)], |s| median(&s[0]))
    }

    /// Returns the exponent of the median time as a power of the size, from a size on.
    fn exponent(&self, who: usize, from: f64) -> Estimate {
        let few = self.0.len().saturating_sub(2);
        let first = self.0.iter().position(|at| at.vertices() > 0.9 * from).unwrap_or(few).min(few);
        let sizes = self.sizes().split_off(first);
        let times: Vec<_> = self.0[first..].iter().map(|at| at.time_sample(who)).collect();
        estimate(&times, |s| exponent_of(&sizes, s))
    }

    fn figure(&self, id: &str, title: &str, paper: &[(&str, f64)]) -> Figure {
        let lines =
            (1..WHO.len()).map(|who| new_series(WHO[who].name(), self.points(who))).collect();
        let y = new_axis("time / time(CTA)", true);
        let title = format!("{title}: time over the time of CTA, median and quartiles");
        let mut figure = against_size(id, &title, y, lines);
        let level =
            |name: &str, y: f64| reference_curve(name, self.sizes().into_iter(), move |_| y);
        figure.references = vec![level("CTA", 1.0)];
        figure.references.extend(paper.iter().map(|(name, y)| level(name, *y)));
        figure
    }

    /// Returns the table of median times and numbers of contradictions.
    fn table(&self, id: &str, title: &str) -> Table {
        let head = |at: &Results| format!("{} vertices", grouped_digits(at.vertices()));
        let columns = std::iter::once("median time (answers that contradict another)".into())
            .chain(self.0.iter().map(head))
            .collect();
        let row = |who: usize| {
            let cell = |at: &Results| {
                format!("{} ({})", time_text(median(&at.times(who))), at.contradictions(who))
            };
            std::iter::once(WHO[who].name()).chain(self.0.iter().map(cell)).collect()
        };
        let rows = (0..WHO.len()).map(row).collect();
        Table { id: id.into(), title: title.into(), columns, rows }
    }

    /// Formats median times at the smallest and the largest size.
    fn times(&self, who: &[usize]) -> String {
        let ends = [self.0.first(), self.0.last()];
        let at = |at: &Results| {
            let each = |who: &usize| {
                format!("{} {}", WHO[*who].name(), time_text(median(&at.times(*who))))
            };
            let text: Vec<_> = who.iter().map(each).collect();
            format!("at {} vertices {}", grouped_digits(at.vertices()), text.join(", "))
        };
        ends.into_iter().flatten().map(at).collect::<Vec<_>>().join("; ")
    }

    /// Returns the mean steps of a solver at the smallest and the largest size.
    fn steps_of(&self, who: usize) -> [f64; 2] {
        [0, self.0.len() - 1].map(|at| mean(&self.0[at].steps(who).values()))
    }

    fn why_egjk(&self) -> Why {
        let [least, most] = self.steps_of(CLIMBING);
        let climbed = [0, self.0.len() - 1].map(|at| self.0[at].iterations(CLIMBING));
        Reason::Machine.because(format!(
            "What it says is of times on a machine of 2005, and holds against counts: EGJK's steps grow only from \
             {least:.1} to {most:.1}, and with those of climbing from {:.0} to {:.0}, where a linear search looks at \
             all vertices in each. Median times {}.",
            climbed[0],
            climbed[1],
            self.times(&[CTA, CLIMBING, LINEAR])
        ))
    }

    /// Explains the result: the paper's claim is about EGJK with linear search, and the climbing one is faster.
    fn why_climbing(&self) -> Why {
        let last = &self.0[self.0.len() - 1];
        Reason::Sentence.because(format!(
            "It is of EGJK that grows linearly (figure 15), and holds of that. Climbing it does not: at {} vertices it \
             takes {:.0} steps with {:.0} vertices climbed over, CTA {:.1} planar problems with {:.0} iterations. Median \
             times {}.",
            grouped_digits(last.vertices()),
            mean(&last.steps(CLIMBING).values()),
            last.iterations(CLIMBING) - mean(&last.steps(CLIMBING).values()),
            mean(&last.steps(CTA).values()),
            last.iterations(CTA),
            self.times(&[CTA, CLIMBING, LINEAR])
        ))
    }

    /// Explains the result: PQP needs as many tests as the original, but today a test has another cost relative to a
    /// planar problem.
    fn why_pqp(&self) -> Why {
        let [least, most] = self.steps_of(PQP);
        Reason::Machine.because(format!(
            "PQP tests {least:.0} and {most:.0} pairs of volumes in the smallest and largest bodies, as many as the \
             original; what a test costs beside a planar problem is another thing today. Median times {}.",
            self.times(&[CTA, PQP])
        ))
    }

    /// Explains the result: faces of a fixed stretch do not become thinner as bodies grow.
    fn why_pqp_of_stretch(&self) -> Why {
        let [least, most] = self.steps_of(PQP);
        Reason::Sentence.because(format!(
            "It does not say how thin, and faces of a fixed stretch do not get thinner as bodies grow: PQP tests \
             {least:.0} and {most:.0} pairs of volumes on average, in the smallest and largest bodies. Median times {}.",
            self.times(&[CTA, PQP])
        ))
    }

    fn all_ratios(&self) -> String {
        format!(
            "Medians by size: EGJK climbing {}; EGJK with linear search {}; PQP {}; the hybrid {}.",
            listed_values(&self.points(CLIMBING), 2),
            listed_values(&self.points(LINEAR), 2),
            listed_values(&self.points(PQP), 1),
            listed_values(&self.points(HYBRID), 2)
        )
    }
}

fn balanced_experiment(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let kinds = [Kind::Balanced, Kind::Triangles];
    let [field, triangles] = run_race(plan, progress, 15, kinds, Meeting::Colliding);
    let fifth = ("the paper, EGJK: from 1/5", 0.2);
    let band = [("the paper, PQP: 6.5", 6.5), ("the paper, PQP: 10", 10.0)];
    let five = ("the paper, PQP: 5.5", 5.5);
    let mut claims = vec![growth_claim(&field), egjk_rises(&field)];
    claims.extend(fastest_claims(["15-fastest", "15-fastest-climbing"], &field));
    claims.push(pqp_claim("15-pqp-trapezoids", &field));
    claims.push(pqp_claim("15-pqp-triangles", &triangles));
    Finding {
        figures: vec![
            field.figure("figure-15-trapezoids", "Balanced trapezoids", &[fifth, band[0], band[1]]),
            triangles.figure("figure-15-triangles", "Balanced triangles", &[fifth, five]),
        ],
        tables: vec![
            field.table("figure-15-times-trapezoids", "Balanced trapezoids, collisions"),
            triangles.table("figure-15-times-triangles", "Balanced triangles, collisions"),
        ],
        claims,
    }
}

fn growth_claim(field: &Field) -> Claim {
    let measured =
        vec![field.exponent(LINEAR, 3_200.0), field.exponent(CTA, 0.0), field.exponent(PQP, 0.0)];
    let details = format!(
        "Exponents of median times as powers of the number of vertices. EGJK with climbing: {}. Up to \
         0.75 is taken as sublinear.",
        field.exponent(CLIMBING, 3_200.0)
    );
    judged("15-growth", measured, details, || {
        let [least, most] = field.steps_of(LINEAR);
        Reason::Machine.because(format!(
            "EGJK's steps grow from {least:.1} to {most:.1}, each a look at all vertices: what grows faster than \
             linearly is the time of a look, of bodies that do not fit the processor's caches. Median times {}.",
            field.times(&[CTA, LINEAR, PQP])
        ))
    })
}

fn egjk_rises(field: &Field) -> Claim {
    let ratios = field.ratios(LINEAR);
    let ends = [ratios[0].clone(), ratios[ratios.len() - 1].clone()];
    let growth = estimate(&ends, |s| median(&s[1]) / median(&s[0]));
    let measured = vec![field.ratio_at(LINEAR, 0.0), growth, field.ratio_at(CLIMBING, 0.0)];
    judged("15-egjk", measured, field.all_ratios(), || field.why_egjk())
}

/// Judges the claims at the size above the paper's 20,000 vertices, which are between two of the sizes here.
fn fastest_claims(ids: [&str; 2], field: &Field) -> [Claim; 2] {
    let at = |who: &[usize]| who.iter().map(|who| field.ratio_at(*who, 51_200.0)).collect();
    [
        judged(ids[0], at(&[LINEAR, PQP]), field.all_ratios(), || field.why_egjk()),
        judged(ids[1], at(&[CLIMBING]), field.all_ratios(), || field.why_climbing()),
    ]
}

fn pqp_claim(id: &str, field: &Field) -> Claim {
    let measured = estimate(&field.ratios(PQP), median_of_medians);
    let details = format!("Medians by size: {}.", listed_values(&field.points(PQP), 1));
    judged(id, vec![measured], details, || field.why_pqp())
}

fn thin_experiment(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let kinds = [Kind::Thin, Kind::ThinMeridians];
    let fields = run_race(plan, progress, 16, kinds, Meeting::Colliding);
    let paper = [
        ("the paper, EGJK: from 1/5", 0.2),
        ("the paper, EGJK: to 14", 14.0),
        ("the paper, PQP: over 100", 100.0),
    ];
    let [stretch, meridians] = &fields;
    let mut claims = Vec::new();
    let ids = ["16-egjk-stretch", "16-pqp-stretch", "16-pqp-growth-stretch"];
    claims.extend(beside_thin(ids, stretch, Field::why_pqp_of_stretch));
    let ids = ["16-egjk-meridians", "16-pqp-meridians", "16-pqp-growth-meridians"];
    claims.extend(beside_thin(ids, meridians, Field::why_pqp));
    Finding {
        figures: vec![
            stretch.figure("figure-16", "Thin trapezoids, a stretch of 100", &paper),
            meridians.figure("figure-16-meridians", "Thin trapezoids, 16 meridians", &paper),
        ],
        tables: vec![
            stretch.table("figure-16-times", "Thin trapezoids, a stretch of 100, collisions"),
            meridians
                .table("figure-16-times-meridians", "Thin trapezoids, 16 meridians, collisions"),
        ],
        claims,
    }
}

/// Judges the claims of figure 16 for one reading of "thin".
fn beside_thin(
    [egjk, pqp, growth]: [&str; 3],
    field: &Field,
    why: fn(&Field) -> Why,
) -> [Claim; 3] {
    let ratios = vec![
        field.ratio_at(LINEAR, 0.0),
        field.ratio_at(LINEAR, 200_000.0),
        field.ratio_at(CLIMBING, 200_000.0),
    ];
    let most =
        estimate(&field.ratios(PQP), |s| super::sample_medians(s).into_iter().fold(0.0, f64::max));
    let exponent = field.exponent(PQP, 3_200.0);
    let details = "Above 0.9 is taken as linear.";
    [
        judged(egjk, ratios, field.all_ratios(), || field.why_egjk()),
        judged(pqp, vec![most], field.all_ratios(), || why(field)),
        judged(growth, vec![exponent], details.into(), || why(field)),
    ]
}

fn thin_and_near(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let kinds = [Kind::Thin, Kind::ThinMeridians];
    let [stretch, meridians] = run_race(plan, progress, 17, kinds, Meeting::PassingWithin(0.01));
    let mut claims = Vec::new();
    claims.extend(fastest_claims(["17-fastest-stretch", "17-fastest-stretch-climbing"], &stretch));
    claims.extend(fastest_claims(
        ["17-fastest-meridians", "17-fastest-meridians-climbing"],
        &meridians,
    ));
    let figure = |id: &str, title: &str, field: &Field| field.figure(id, title, &[]);
    let title = |reading: &str| format!("Thin trapezoids, {reading}, passing within 1 %");
    let titles = ["a stretch of 100", "16 meridians"].map(title);
    Finding {
        figures: vec![
            figure("figure-17", &titles[0], &stretch),
            figure("figure-17-meridians", &titles[1], &meridians),
        ],
        tables: vec![
            stretch.table("figure-17-times", &titles[0]),
            meridians.table("figure-17-times-meridians", &titles[1]),
        ],
        claims,
    }
}
