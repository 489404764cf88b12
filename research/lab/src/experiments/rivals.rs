//! Figures 15 to 17: single queries beside enhanced GJK and PQP, which compute the distance at the
//! start of the same settings, and beside the ray cast, which asks the same question.

use colltrans_baselines::egjk::SupportSearch;

use super::{
    Coherence, Parts, Race, Results, against_size, axis, exponent_of, listed, middle, reference,
    series, share, shares, thousands, time,
};
use crate::Experiment;
use crate::claims::{Claim, judged};
use crate::finding::{Figure, Finding, Point, Table};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::Kind;
use crate::solvers::{Until, Who};
use crate::statistics::{Estimate, Sample, estimate, mean};
use colltrans_testkit::timing::median;

pub(super) const FIGURE_15: Experiment =
    Experiment { id: "figure-15", title: "balanced faces, beside EGJK and PQP", run: balanced };

pub(super) const FIGURE_16: Experiment =
    Experiment { id: "figure-16", title: "thin faces, beside EGJK and PQP", run: thin };

pub(super) const FIGURE_17: Experiment = Experiment {
    id: "figure-17",
    title: "thin faces, bodies that pass within 1 %, beside EGJK and PQP",
    run: thin_and_near,
};

pub(super) const WHO: [Who; 6] = [
    Who::Cta(Until::Near),
    Who::Egjk(SupportSearch::Climbing),
    Who::Egjk(SupportSearch::Linear),
    Who::Pqp,
    Who::Portal,
    Who::RayCast,
];
const CTA: usize = 0;
const CLIMBING: usize = 1;
const LINEAR: usize = 2;
const PQP: usize = 3;

/// One race at every size.
struct Field(Vec<Results>);

impl Field {
    fn race(plan: &Plan, figure: u64, kind: Kind, meeting: Meeting, parts: &mut Parts) -> Self {
        let measure = |n: &usize| {
            parts.begin(
                share(*n),
                &format!("{} bodies, {} vertices", kind.name(), thousands(*n as f64)),
            );
            let race = Race {
                plan,
                figure,
                kind,
                n: *n,
                given: None,
                who: &WHO,
                coherence: Coherence::Scratch,
                // Long blocks: an algorithm in use finds its bodies in the caches.
                length: plan.by_scale(5, 50, 100),
                blocks: plan.by_scale(2, if *n < 20_000 { 12 } else { 8 }, 48),
            };
            race.run(0, |bodies, count, random| {
                (0..count).map(|_| Setting::draw(bodies, meeting, random)).collect()
            })
        };
        Self(plan.sizes().iter().map(measure).collect())
    }

    fn sizes(&self) -> Vec<f64> {
        self.0.iter().map(|at| at.vertices).collect()
    }

    /// `time(who) / time(CTA)`, query by query.
    fn ratios(&self, who: usize) -> Vec<Sample> {
        self.0.iter().map(|at| at.ratios(who, CTA)).collect()
    }

    /// Its medians with quartiles.
    fn points(&self, who: usize) -> Vec<Point> {
        let ratios = self.ratios(who);
        ratios.iter().zip(&self.0).map(|(s, at)| Point::median(at.vertices, &s.values())).collect()
    }

    /// The median ratio at one size; the largest size there is if that is smaller.
    fn ratio_at(&self, who: usize, n: f64) -> Estimate {
        let last = self.0.len() - 1;
        let k = self.0.iter().position(|at| at.vertices > 0.9 * n).unwrap_or(last);
        estimate(&[self.0[k].ratios(who, CTA)], |s| median(&s[0]))
    }

    /// The exponent of the median time as a power of the size, from a size on.
    fn exponent(&self, who: usize, from: f64) -> Estimate {
        let few = self.0.len().saturating_sub(2);
        let first = self.0.iter().position(|at| at.vertices > 0.9 * from).unwrap_or(few).min(few);
        let sizes = self.sizes().split_off(first);
        let times: Vec<_> = self.0[first..].iter().map(|at| at.time_sample(who)).collect();
        estimate(&times, |s| exponent_of(&sizes, s))
    }

    fn figure(&self, id: &str, title: &str, paper: &[(&str, f64)]) -> Figure {
        let lines = (1..WHO.len()).map(|who| series(WHO[who].name(), self.points(who))).collect();
        let y = axis("time / time(CTA)", true);
        let title = format!("{title}: time over the time of CTA, median and quartiles");
        let mut figure = against_size(id, &title, y, lines);
        let level = |name: &str, y: f64| reference(name, self.sizes().into_iter(), move |_| y);
        figure.references = vec![level("CTA", 1.0)];
        figure.references.extend(paper.iter().map(|(name, y)| level(name, *y)));
        figure
    }

    /// Median times, and how often an answer contradicted another.
    fn table(&self, id: &str, title: &str) -> Table {
        let head = |at: &Results| format!("{} vertices", thousands(at.vertices));
        let columns = std::iter::once("median time (answers that contradict another)".into())
            .chain(self.0.iter().map(head))
            .collect();
        let row = |who: usize| {
            let cell = |at: &Results| {
                format!("{} ({})", time(median(&at.times(who))), at.contradictions(who))
            };
            std::iter::once(WHO[who].name()).chain(self.0.iter().map(cell)).collect()
        };
        let rows = (0..WHO.len()).map(row).collect();
        Table { id: id.into(), title: title.into(), columns, rows }
    }

    /// Median times of some at the smallest and largest size, for people.
    fn times(&self, who: &[usize]) -> String {
        let ends = [self.0.first(), self.0.last()];
        let at = |at: &Results| {
            let each =
                |who: &usize| format!("{} {}", WHO[*who].name(), time(median(&at.times(*who))));
            let text: Vec<_> = who.iter().map(each).collect();
            format!("at {} vertices {}", thousands(at.vertices), text.join(", "))
        };
        ends.into_iter().flatten().map(at).collect::<Vec<_>>().join("; ")
    }

    fn why_egjk(&self) -> String {
        let ends = [self.0.first(), self.0.last()];
        let [least, most] =
            ends.map(|at| at.map_or(f64::NAN, |at| mean(&at.steps(CLIMBING).values())));
        format!(
            "Median times {}. EGJK's iterations grow only from {least:.1} to {most:.1}: what grows is \
             the way to a support point, by climbing far less than by looking at all vertices.",
            self.times(&[CTA, CLIMBING, LINEAR])
        )
    }

    fn why_pqp(&self) -> String {
        let ends = [self.0.first(), self.0.last()];
        let [least, most] = ends.map(|at| at.map_or(f64::NAN, |at| mean(&at.steps(PQP).values())));
        format!(
            "Median times {}. PQP tests {least:.0} and {most:.0} pairs of volumes on average.",
            self.times(&[CTA, PQP])
        )
    }

    fn all_ratios(&self) -> String {
        format!(
            "Medians by size: EGJK climbing {}; EGJK with linear search {}; PQP {}.",
            listed(&self.points(CLIMBING), 2),
            listed(&self.points(LINEAR), 2),
            listed(&self.points(PQP), 1)
        )
    }
}

fn balanced(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let mut parts = Parts::new(progress, 2.0 * shares(plan.sizes()));
    let field = Field::race(plan, 15, Kind::Balanced, Meeting::Colliding, &mut parts);
    let triangles = Field::race(plan, 15, Kind::Triangles, Meeting::Colliding, &mut parts);
    let fifth = ("the paper, EGJK: from 1/5", 0.2);
    let band = [("the paper, PQP: 6.5", 6.5), ("the paper, PQP: 10", 10.0)];
    let five = ("the paper, PQP: 5.5", 5.5);
    let mut claims = vec![grow(&field), egjk_rises(&field)];
    claims.extend(fastest(["15-fastest", "15-fastest-climbing"], &field));
    claims.push(pqp("15-pqp-trapezoids", &field));
    claims.push(pqp("15-pqp-triangles", &triangles));
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

fn grow(field: &Field) -> Claim {
    let measured =
        vec![field.exponent(LINEAR, 3_200.0), field.exponent(CTA, 0.0), field.exponent(PQP, 0.0)];
    let details = format!(
        "Exponents of median times as powers of the number of vertices. EGJK with climbing: {}. Up to \
         0.75 is taken as sublinear.",
        field.exponent(CLIMBING, 3_200.0)
    );
    judged("15-growth", measured, details, || {
        format!(
            "Looks at all vertices take more than linear time here, perhaps because those of large \
             bodies do not fit the processor's caches. {}",
            field.why_egjk()
        )
    })
}

fn egjk_rises(field: &Field) -> Claim {
    let ratios = field.ratios(LINEAR);
    let ends = [ratios[0].clone(), ratios[ratios.len() - 1].clone()];
    let growth = estimate(&ends, |s| median(&s[1]) / median(&s[0]));
    let measured = vec![field.ratio_at(LINEAR, 0.0), growth, field.ratio_at(CLIMBING, 0.0)];
    judged("15-egjk", measured, field.all_ratios(), || field.why_egjk())
}

/// The paper's 20,000 vertices lie between two of the sizes here: judged is the one above.
fn fastest(ids: [&str; 2], field: &Field) -> [Claim; 2] {
    let at = |who: &[usize]| who.iter().map(|who| field.ratio_at(*who, 51_200.0)).collect();
    [
        judged(ids[0], at(&[LINEAR, PQP]), field.all_ratios(), || field.why_egjk()),
        judged(ids[1], at(&[CLIMBING]), field.all_ratios(), || field.why_egjk()),
    ]
}

fn pqp(id: &str, field: &Field) -> Claim {
    let measured = estimate(&field.ratios(PQP), middle);
    let details = format!("Medians by size: {}.", listed(&field.points(PQP), 1));
    judged(id, vec![measured], details, || field.why_pqp())
}

fn thin(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let mut parts = Parts::new(progress, 2.0 * shares(plan.sizes()));
    let field = Field::race(plan, 16, Kind::Thin, Meeting::Colliding, &mut parts);
    let meridians = Field::race(plan, 16, Kind::ThinMeridians, Meeting::Colliding, &mut parts);
    let paper = [
        ("the paper, EGJK: from 1/5", 0.2),
        ("the paper, EGJK: to 14", 14.0),
        ("the paper, PQP: over 100", 100.0),
    ];
    let beside = |text: String| {
        format!(
            "Faces of a fixed stretch of 100. {text} With 16 meridians at any size: {}",
            meridians.all_ratios()
        )
    };
    let egjk = vec![
        field.ratio_at(LINEAR, 0.0),
        field.ratio_at(LINEAR, 200_000.0),
        field.ratio_at(CLIMBING, 200_000.0),
    ];
    let most = |field: &Field| {
        estimate(&field.ratios(PQP), |s| super::medians(s).into_iter().fold(0.0, f64::max))
    };
    let growth = [&field, &meridians].map(|field| field.exponent(PQP, 3_200.0));
    let claims = vec![
        judged("16-egjk", egjk, beside(field.all_ratios()), || field.why_egjk()),
        judged(
            "16-pqp",
            vec![most(&field)],
            format!("With 16 meridians at any size: {}.", most(&meridians)),
            || field.why_pqp(),
        ),
        judged(
            "16-pqp-growth",
            vec![growth[0]],
            format!("With 16 meridians at any size: {}. Above 0.9 is taken as linear.", growth[1]),
            || field.why_pqp(),
        ),
    ];
    Finding {
        figures: vec![
            field.figure("figure-16", "Thin trapezoids, a stretch of 100", &paper),
            meridians.figure("figure-16-meridians", "Thin trapezoids, 16 meridians", &paper),
        ],
        tables: vec![
            field.table("figure-16-times", "Thin trapezoids, a stretch of 100, collisions"),
            meridians
                .table("figure-16-times-meridians", "Thin trapezoids, 16 meridians, collisions"),
        ],
        claims,
    }
}

fn thin_and_near(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let mut parts = Parts::new(progress, shares(plan.sizes()));
    let field = Field::race(plan, 17, Kind::Thin, Meeting::PassingWithin(0.01), &mut parts);
    Finding {
        figures: vec![field.figure("figure-17", "Thin trapezoids, passing within 1 %", &[])],
        tables: vec![field.table("figure-17-times", "Thin trapezoids, passing within 1 %")],
        claims: fastest(["17-fastest", "17-fastest-climbing"], &field).into(),
    }
}
