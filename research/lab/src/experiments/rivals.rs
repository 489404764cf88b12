//! Figures 15 to 17: single queries compared with enhanced GJK and PQP, which compute the distance at the start of
//! the same settings, and with the ray cast, which answers the same question.
//!
//! EGJK is Cameron's: in a query from scratch every climb starts at the first vertex. Claims are judged by it. Two more
//! curves keep the seeds within a query, or search all vertices.

use colltrans_baselines::egjk::SupportSearch;

use super::{
    Coherence, Race, Results, Unit, against_size, exponent_of, grouped_digits, in_passes,
    listed_values, median_of_medians, new_axis, new_series, reference_curve, sample_medians,
    time_text,
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

pub(super) const WHO: [Who; 8] = [
    Who::Cta(Until::End),
    Who::Egjk(SupportSearch::FirstVertex),
    Who::Egjk(SupportSearch::Climbing),
    Who::Egjk(SupportSearch::Linear),
    Who::Pqp,
    Who::Cta(Until::Near),
    Who::Portal,
    Who::RayCast,
];
pub(super) const CTA: usize = 0;
pub(super) const EGJK: usize = 1;
const SEEDS_KEPT: usize = 2;
const LINEAR: usize = 3;
pub(super) const PQP: usize = 4;
const HYBRID: usize = 5;

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

    /// Returns `cost(who) / cost(CTA)` for each query.
    fn ratios(&self, who: usize, unit: Unit) -> Vec<Sample> {
        self.0.iter().map(|at| at.ratios(who, CTA, unit)).collect()
    }

    /// Returns the medians of the ratios with quartiles.
    fn points(&self, who: usize, unit: Unit) -> Vec<Point> {
        let ratios = self.ratios(who, unit);
        ratios
            .iter()
            .zip(&self.0)
            .map(|(s, at)| Point::median(at.vertices(), &s.values()))
            .collect()
    }

    /// Returns the median ratio at one size, or at the largest size if that is smaller.
    fn ratio_at(&self, who: usize, n: f64, unit: Unit) -> Estimate {
        let last = self.0.len() - 1;
        let k = self.0.iter().position(|at| at.vertices() > 0.9 * n).unwrap_or(last);
        estimate(&[self.0[k].ratios(who, CTA, unit)], |s| median(&s[0]))
    }

    /// Returns the number of vertices at which a rival costs as much as CTA.
    fn parity(&self, who: usize, unit: Unit) -> Estimate {
        let sizes = self.sizes();
        estimate(&self.ratios(who, unit), |s| parity_size(&sizes, &sample_medians(s)))
    }

    /// Returns the exponent of the median cost as a power of the size, from a size on.
    fn exponent(&self, who: usize, from: f64, unit: Unit) -> Estimate {
        let few = self.0.len().saturating_sub(2);
        let first = self.0.iter().position(|at| at.vertices() > 0.9 * from).unwrap_or(few).min(few);
        let sizes = self.sizes().split_off(first);
        let costs: Vec<_> = self.0[first..].iter().map(|at| at.costs(who, unit)).collect();
        estimate(&costs, |s| exponent_of(&sizes, s))
    }

    fn figure(&self, id: &str, title: &str, unit: Unit, paper: &[(&str, f64)]) -> Figure {
        let lines =
            (1..WHO.len()).map(|who| new_series(WHO[who].name(), self.points(who, unit))).collect();
        let cost = match unit {
            Unit::Instructions => "instructions",
            Unit::Time => "time",
        };
        let y = new_axis(&format!("{cost} / {cost}(CTA)"), true);
        let title = format!("{title}: {cost} over the {cost} of CTA, median and quartiles");
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

    /// Returns the mean steps of a solver at the smallest and the largest size.
    fn steps_of(&self, who: usize) -> [f64; 2] {
        [0, self.0.len() - 1].map(|at| mean(&self.0[at].steps(who).values()))
    }

    /// Explains a ratio of EGJK by the counts and by the instructions in a nanosecond.
    fn why_egjk(&self, reason: Reason) -> Why {
        let at = |at: &Results| {
            let climbed = at.iterations(EGJK) - mean(&at.steps(EGJK).values());
            format!(
                "at {} vertices EGJK climbs over {climbed:.0} vertices, {}; CTA does {:.0} iterations, {}",
                grouped_digits(at.vertices()),
                at.cost_text(EGJK),
                at.iterations(CTA),
                at.cost_text(CTA)
            )
        };
        let ends = [self.0.first(), self.0.last()].map(|end| end.map(at).unwrap_or_default());
        reason.because(format!("Means of counts, medians of costs: {}; {}.", ends[0], ends[1]))
    }

    /// Explains a ratio of PQP: the number of tests, and the costs.
    fn why_pqp(&self) -> Why {
        let [least, most] = self.steps_of(PQP);
        let last = &self.0[self.0.len() - 1];
        Reason::Sentence.because(format!(
            "The paper does not state how thin the faces are. PQP tests {least:.0} and {most:.0} pairs of volumes on \
             average, in the smallest and largest bodies. In the largest: PQP {}, CTA {}.",
            last.cost_text(PQP),
            last.cost_text(CTA)
        ))
    }

    fn all_ratios(&self, unit: Unit) -> String {
        let [egjk, kept, linear, pqp, hybrid] =
            [(EGJK, 2), (SEEDS_KEPT, 2), (LINEAR, 2), (PQP, 1), (HYBRID, 2)]
                .map(|(who, digits)| listed_values(&self.points(who, unit), digits));
        format!(
            "EGJK {egjk}; EGJK with seeds kept {kept}; EGJK with linear search {linear}; PQP {pqp}; the hybrid {hybrid}"
        )
    }

    /// Formats the median ratios by size, in both units.
    fn details(&self) -> String {
        format!(
            "Medians of instructions by size: {}. Of times: {}.",
            self.all_ratios(Unit::Instructions),
            self.all_ratios(Unit::Time)
        )
    }
}

/// Returns the size at which the ratio of costs rises to 1, between two sizes or, on the line through the nearest two,
/// beyond all of them. Both are logarithmic. A ratio that does not rise there yields one of [`PARITY_LIMITS`].
fn parity_size(sizes: &[f64], ratios: &[f64]) -> f64 {
    let crosses = |k: &usize| ratios[*k] < 1.0 && ratios[k + 1] >= 1.0;
    let last = sizes.len() - 2;
    let beyond = if ratios[0] >= 1.0 { 0 } else { last };
    let k = (0..=last).find(crosses).unwrap_or(beyond);
    let [x, y] = [k, k + 1].map(|k| [sizes[k].ln(), ratios[k].ln()]);
    let slope = (y[1] - x[1]) / (y[0] - x[0]);
    let [low, high] = PARITY_LIMITS;
    if slope > 0.0 {
        (x[0] - x[1] / slope).exp().clamp(low, high)
    } else if ratios[0] >= 1.0 {
        low
    } else {
        high
    }
}

/// Least and largest size at which costs count as equal.
const PARITY_LIMITS: [f64; 2] = [1.0, 1e9];

fn balanced_experiment(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let kinds = [Kind::Balanced, Kind::Triangles];
    let [field, triangles] = run_race(plan, progress, 15, kinds, Meeting::Colliding);
    let fifth = ("the paper, EGJK: from 1/5", 0.2);
    let paper = [fifth, ("the paper, PQP: 6.5", 6.5), ("the paper, PQP: 10", 10.0)];
    let five = ("the paper, PQP: 5.5", 5.5);
    let claims = vec![
        growth_claim(&field),
        growth_claim_of_egjk(&field),
        egjk_rises(&field),
        parity_claim("15-parity", &field, Unit::Instructions),
        parity_claim("15-parity-time", &field, Unit::Time),
        fastest_claim("15-fastest", &field, None),
        pqp_claim("15-pqp-trapezoids", &field),
        pqp_claim("15-pqp-triangles", &triangles),
    ];
    Finding {
        figures: vec![
            field.figure("figure-15-trapezoids", "Balanced trapezoids", Unit::Time, &paper),
            field.figure(
                "figure-15-instructions",
                "Balanced trapezoids",
                Unit::Instructions,
                &paper,
            ),
            triangles.figure(
                "figure-15-triangles",
                "Balanced triangles",
                Unit::Time,
                &[fifth, five],
            ),
        ],
        tables: vec![
            field.table("figure-15-times-trapezoids", "Balanced trapezoids, collisions"),
            triangles.table("figure-15-times-triangles", "Balanced triangles, collisions"),
        ],
        claims,
    }
}

fn growth_claim(field: &Field) -> Claim {
    let of = |who: usize| field.exponent(who, 0.0, Unit::Instructions);
    let times = |who: usize| field.exponent(who, 0.0, Unit::Time);
    let details = format!(
        "Exponents of medians as powers of the number of vertices. Of times: CTA {}, PQP {}.",
        times(CTA),
        times(PQP)
    );
    judged("15-growth", vec![of(CTA), of(PQP)], details, || {
        let last = &field.0[field.0.len() - 1];
        Reason::Implementation.because(format!(
            "In the largest bodies: CTA {}, PQP {}.",
            last.cost_text(CTA),
            last.cost_text(PQP)
        ))
    })
}

fn growth_claim_of_egjk(field: &Field) -> Claim {
    let of = |who: usize, unit: Unit| field.exponent(who, 3_200.0, unit);
    let measured =
        vec![of(EGJK, Unit::Instructions), of(LINEAR, Unit::Instructions), of(EGJK, Unit::Time)];
    let all = field.exponent(EGJK, 0.0, Unit::Instructions);
    let details = format!("From 200 vertices, the exponent of EGJK is {all}.");
    judged("15-growth-egjk", measured, details, || {
        Reason::Sentence.because(
            "The paper's own numbers contradict a linear growth. From 200 to 20,000 vertices the ratio rises from 1/5 to \
             1. With times of CTA that follow log² n, as the paper states, EGJK grows with an exponent of 0.62. A climb \
             from the first vertex passes about as many vertices as lie between two points of a body, which is a power \
             of 0.5.",
        )
    })
}

fn egjk_rises(field: &Field) -> Claim {
    let ratios = field.ratios(EGJK, Unit::Instructions);
    let ends = [ratios[0].clone(), ratios[ratios.len() - 1].clone()];
    let growth = estimate(&ends, |s| median(&s[1]) / median(&s[0]));
    let measured = vec![
        field.ratio_at(EGJK, 0.0, Unit::Instructions),
        growth,
        field.ratio_at(EGJK, 0.0, Unit::Time),
    ];
    judged("15-egjk", measured, field.details(), || field.why_egjk(Reason::Implementation))
}

/// Judges the size from which CTA is faster than EGJK.
fn parity_claim(id: &str, field: &Field, unit: Unit) -> Claim {
    let others = [SEEDS_KEPT, LINEAR]
        .map(|who| format!("{} {}", WHO[who].name(), size_text(field.parity(who, unit).value)));
    let details = format!("Equal costs of the other curves: {}.", others.join(", "));
    let reason = match unit {
        Unit::Instructions => Reason::Implementation,
        Unit::Time => Reason::Machine,
    };
    judged(id, vec![field.parity(EGJK, unit)], details, || field.why_egjk(reason))
}

/// Formats a size of equal costs, which may be far beyond all sizes.
fn size_text(size: f64) -> String {
    if size < 1e6 { format!("at {} vertices", grouped_digits(size)) } else { "never".into() }
}

/// Judges who is fastest at the size above the paper's 20,000 vertices, which are between two of the sizes here. For
/// thin faces, the ratios with a fixed stretch are quoted.
fn fastest_claim(id: &str, field: &Field, stretch: Option<&Field>) -> Claim {
    let mut measured: Vec<_> = [EGJK, PQP]
        .map(|who| field.ratio_at(who, 51_200.0, Unit::Instructions))
        .into_iter()
        .collect();
    measured.extend([EGJK, PQP].map(|who| field.ratio_at(who, 51_200.0, Unit::Time)));
    measured.extend(stretch.map(|field| field.ratio_at(EGJK, 51_200.0, Unit::Instructions)));
    judged(id, measured, field.details(), || field.why_egjk(Reason::Implementation))
}

fn pqp_claim(id: &str, field: &Field) -> Claim {
    let of = |unit: Unit| estimate(&field.ratios(PQP, unit), median_of_medians);
    let details = format!(
        "Medians of instructions by size: {}.",
        listed_values(&field.points(PQP, Unit::Instructions), 1)
    );
    judged(id, vec![of(Unit::Instructions), of(Unit::Time)], details, || {
        let last = &field.0[field.0.len() - 1];
        Reason::Machine.because(format!(
            "PQP tests as many pairs of volumes as the authors' program. In the largest bodies: PQP {}, CTA {}.",
            last.cost_text(PQP),
            last.cost_text(CTA)
        ))
    })
}

fn thin_experiment(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let kinds = [Kind::Thin, Kind::ThinMeridians];
    let [stretch, meridians] = run_race(plan, progress, 16, kinds, Meeting::Colliding);
    let paper = [
        ("the paper, EGJK: from 1/5", 0.2),
        ("the paper, EGJK: to 14", 14.0),
        ("the paper, PQP: over 100", 100.0),
    ];
    let titles = ["Thin trapezoids, a stretch of 100", "Thin trapezoids, 16 meridians"];
    Finding {
        figures: vec![
            stretch.figure("figure-16", titles[0], Unit::Time, &paper),
            meridians.figure("figure-16-meridians", titles[1], Unit::Time, &paper),
            meridians.figure("figure-16-instructions", titles[1], Unit::Instructions, &paper),
        ],
        tables: vec![
            stretch.table("figure-16-times", "Thin trapezoids, a stretch of 100, collisions"),
            meridians
                .table("figure-16-times-meridians", "Thin trapezoids, 16 meridians, collisions"),
        ],
        claims: thin_claims(&meridians, &stretch),
    }
}

/// Judges the claims of figure 16 with 16 meridians, and quotes the numbers with a fixed stretch.
fn thin_claims(field: &Field, stretch: &Field) -> Vec<Claim> {
    let ratio = |field: &Field, n: f64, unit: Unit| field.ratio_at(EGJK, n, unit);
    let egjk = vec![
        ratio(field, 0.0, Unit::Instructions),
        ratio(field, 200_000.0, Unit::Instructions),
        ratio(field, 200_000.0, Unit::Time),
        ratio(stretch, 200_000.0, Unit::Instructions),
    ];
    let most = |field: &Field, unit: Unit| {
        estimate(&field.ratios(PQP, unit), |s| sample_medians(s).into_iter().fold(0.0, f64::max))
    };
    let pqp = vec![
        most(field, Unit::Instructions),
        most(field, Unit::Time),
        most(stretch, Unit::Instructions),
    ];
    let exponent = |field: &Field, unit: Unit| field.exponent(PQP, 3_200.0, unit);
    let growth = vec![
        exponent(field, Unit::Instructions),
        exponent(field, Unit::Time),
        exponent(stretch, Unit::Instructions),
    ];
    vec![
        judged("16-egjk", egjk, field.details(), || field.why_egjk(Reason::Sentence)),
        judged("16-pqp", pqp, field.details(), || field.why_pqp()),
        judged("16-pqp-growth", growth, String::new(), || field.why_pqp()),
    ]
}

fn thin_and_near(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let kinds = [Kind::Thin, Kind::ThinMeridians];
    let [stretch, meridians] = run_race(plan, progress, 17, kinds, Meeting::PassingWithin(0.01));
    let title = |reading: &str| format!("Thin trapezoids, {reading}, passing within 1 %");
    let titles = ["a stretch of 100", "16 meridians"].map(title);
    Finding {
        figures: vec![
            stretch.figure("figure-17", &titles[0], Unit::Time, &[]),
            meridians.figure("figure-17-meridians", &titles[1], Unit::Time, &[]),
            meridians.figure("figure-17-instructions", &titles[1], Unit::Instructions, &[]),
        ],
        tables: vec![
            stretch.table("figure-17-times", &titles[0]),
            meridians.table("figure-17-times-meridians", &titles[1]),
        ],
        claims: vec![fastest_claim("17-fastest", &meridians, Some(&stretch))],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parity_is_where_costs_are_equal() {
        let sizes = [200.0, 2_000.0, 20_000.0];
        let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-9;
        assert!(near(parity_size(&sizes, &[0.1, 0.1, 10.0]), 2_000.0 * 10.0_f64.sqrt()));
        assert!(near(
            parity_size(&sizes, &[0.01, 0.1, 0.5]),
            20_000.0 * 10.0_f64.powf(2.0_f64.ln() / 5.0_f64.ln())
        ));
        assert!(near(parity_size(&sizes, &[10.0, 100.0, 100.0]), 20.0));
        assert_eq!(parity_size(&sizes, &[0.1, 0.5, 0.4]), PARITY_LIMITS[1]);
        assert_eq!(parity_size(&sizes, &[2.0, 1.5, 1.2]), PARITY_LIMITS[0]);
    }
}
