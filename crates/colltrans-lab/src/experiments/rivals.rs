//! Figures 15 to 17: single queries beside enhanced GJK and PQP, which compute the distance at the
//! start of the same settings, and beside the ray cast, which asks the same question.

use super::{
    Coherence, Parts, Race, Results, about, against_size, axis, claim, extremes, listed, middle,
    reference, series, share, shares, thousands, time,
};
use crate::Experiment;
use crate::contestants::{Until, Who};
use crate::finding::{Claim, Figure, Finding, Point, Table};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::Kind;
use colltrans_kit::timing::median;

pub(super) const FIGURE_15: Experiment =
    Experiment { id: "figure-15", title: "balanced faces, beside EGJK and PQP", run: balanced };

pub(super) const FIGURE_16: Experiment =
    Experiment { id: "figure-16", title: "thin faces, beside EGJK and PQP", run: thin };

pub(super) const FIGURE_17: Experiment = Experiment {
    id: "figure-17",
    title: "thin faces, bodies that pass within 1 %, beside EGJK and PQP",
    run: thin_and_near,
};

const WHO: [Who; 6] =
    [Who::Cta(Until::Near), Who::Egjk, Who::Pqp, Who::Portal, Who::RayCast, Who::HWalk(PATIENCE)];
const CTA: usize = 0;
const EGJK: usize = 1;
const PQP: usize = 2;

/// From scratch H-Walk's patience matters little: it comes down through all layers.
const PATIENCE: u32 = 16;

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
                who: &WHO,
                coherence: Coherence::Scratch,
                // Long blocks: an algorithm in use finds its bodies in the caches.
                length: plan.by_scale(5, 60, 100),
                blocks: plan.by_scale(2, 12, 80),
            };
            race.run(0, |bodies, count, random| {
                (0..count).map(|_| Setting::draw(bodies, meeting, random)).collect()
            })
        };
        Self(plan.sizes().iter().map(measure).collect())
    }

    /// `time(who) / time(CTA)`, query by query: medians with quartiles.
    fn ratio(&self, who: usize) -> Vec<Point> {
        self.0.iter().map(|at| Point::median(at.vertices, &at.ratios(who, CTA))).collect()
    }

    fn figure(&self, id: &str, title: &str) -> Figure {
        let lines = (1..WHO.len()).map(|who| series(WHO[who].name(), self.ratio(who))).collect();
        let y = axis("time / time(CTA)", true);
        let title = format!("{title}: time over the time of CTA, median and quartiles");
        let mut figure = against_size(id, &title, y, lines);
        figure.references = vec![reference("CTA", self.0.iter().map(|at| at.vertices), |_| 1.0)];
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

    /// Average steps of one at the smallest and largest size.
    fn steps(&self, who: usize) -> [f64; 2] {
        [self.0.first(), self.0.last()].map(|at| {
            at.map_or(f64::NAN, |at| {
                colltrans_kit::timing::mean_and_deviation(&at.counts(who, |w| w.steps))[0]
            })
        })
    }

    /// Why EGJK does better against CTA than in the paper, from what was measured.
    fn why_egjk(&self) -> String {
        let [least, most] = self.steps(EGJK);
        let growth = |who: usize| {
            let [small, large] = [self.0.first(), self.0.last()]
                .map(|at| at.map_or(f64::NAN, |at| median(&at.times(who))));
            large / small
        };
        format!(
            "Median times {}. From the smallest to the largest bodies EGJK's time grows by a \
             factor of {:.0}, its iterations only from {least:.1} to {most:.1}: what grows is the \
             climbing to support points. CTA's grows by {:.0}, for reasons that figure 11 tells \
             apart.",
            self.times(&[CTA, EGJK]),
            growth(EGJK),
            growth(CTA)
        )
    }

    fn why_pqp(&self) -> String {
        let [least, most] = self.steps(PQP);
        format!(
            "Median times {}. PQP tests {least:.0} and {most:.0} pairs of volumes on average.",
            self.times(&[CTA, PQP])
        )
    }
}

fn balanced(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let mut parts = Parts::new(progress, 2.0 * shares(plan.sizes()));
    let field = Field::race(plan, 15, Kind::Balanced, Meeting::Colliding, &mut parts);
    let triangles = Field::race(plan, 15, Kind::Triangles, Meeting::Colliding, &mut parts);
    Finding {
        figures: vec![
            field.figure("figure-15-trapezoids", "Balanced trapezoids"),
            triangles.figure("figure-15-triangles", "Balanced triangles"),
        ],
        tables: vec![
            field.table("figure-15-times-trapezoids", "Balanced trapezoids, collisions"),
            triangles.table("figure-15-times-triangles", "Balanced triangles, collisions"),
        ],
        claims: vec![
            egjk_rises(&field),
            fastest_from(&field),
            pqp_on_trapezoids(&field),
            pqp_on_triangles(&triangles),
        ],
    }
}

fn egjk_rises(field: &Field) -> Claim {
    let ratio = field.ratio(EGJK);
    let ends = [ratio.first(), ratio.last()].map(|p| p.map_or(f64::NAN, |p| p.y));
    claim(
        "Balanced: time(EGJK)/time(CTA) is 1/5 for small bodies and rises with size.",
        format!("Medians: {}. About 1/5 is 0.15 to 0.25.", listed(&ratio, 2)),
        about(ends[0], 0.2) && ends[1] > ends[0],
        || field.why_egjk(),
    )
}

/// The size from which CTA is fastest in the paper, and how far off the crossing may be.
const FASTEST_FROM: f64 = 20_000.0;
const FACTOR: f64 = 2.0;

fn fastest_from(field: &Field) -> Claim {
    let rivals = [field.ratio(EGJK), field.ratio(PQP)];
    let slowest_rival_wins = |k: usize| rivals.iter().all(|ratio| ratio[k].y > 1.0);
    let sizes: Vec<_> = field.0.iter().map(|at| at.vertices).collect();
    let large: Vec<_> = (0..sizes.len()).filter(|k| sizes[*k] >= FASTEST_FROM * FACTOR).collect();
    let from = (0..sizes.len()).find(|k| (*k..sizes.len()).all(slowest_rival_wins));
    claim(
        "Balanced: CTA is the fastest of CTA, EGJK and PQP from about 20,000 vertices.",
        match from {
            Some(k) => format!("CTA is fastest from {} vertices on.", thousands(sizes[k])),
            None => format!(
                "CTA is not fastest at the largest size; {}.",
                field.times(&[CTA, EGJK, PQP])
            ),
        },
        !large.is_empty() && large.into_iter().all(slowest_rival_wins),
        || {
            if sizes.last().is_none_or(|n| *n < FASTEST_FROM * FACTOR) {
                return "No body of this run is that large.".into();
            }
            field.why_egjk()
        },
    )
}

fn pqp_on_trapezoids(field: &Field) -> Claim {
    let ratio = field.ratio(PQP);
    let typical = middle(&ratio);
    claim(
        "Balanced trapezoids: time(PQP)/time(CTA) is 6.5 to 10.",
        format!("{typical:.1} in the middle of all sizes: {}.", listed(&ratio, 1)),
        (6.5..=10.0).contains(&typical),
        || field.why_pqp(),
    )
}

fn pqp_on_triangles(triangles: &Field) -> Claim {
    let ratio = triangles.ratio(PQP);
    let typical = middle(&ratio);
    claim(
        "Balanced triangles: time(PQP)/time(CTA) is about 5.5.",
        format!("{typical:.1} in the middle of all sizes: {}.", listed(&ratio, 1)),
        about(typical, 5.5),
        || triangles.why_pqp(),
    )
}

fn thin(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let mut parts = Parts::new(progress, shares(plan.sizes()));
    let field = Field::race(plan, 16, Kind::Thin, Meeting::Colliding, &mut parts);
    let [egjk, pqp] = [field.ratio(EGJK), field.ratio(PQP)];
    let claims = vec![
        claim(
            "Thin faces: time(EGJK)/time(CTA) reaches about 14.",
            format!("At most {:.1}: {}.", extremes(&egjk)[1], listed(&egjk, 2)),
            about(extremes(&egjk)[1], 14.0),
            || field.why_egjk(),
        ),
        claim(
            "Thin faces: time(PQP)/time(CTA) exceeds 100.",
            format!("At most {:.0}: {}.", extremes(&pqp)[1], listed(&pqp, 1)),
            extremes(&pqp)[1] > 100.0,
            || field.why_pqp(),
        ),
    ];
    Finding {
        figures: vec![field.figure("figure-16", "Thin trapezoids")],
        tables: vec![field.table("figure-16-times", "Thin trapezoids, collisions")],
        claims,
    }
}

fn thin_and_near(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let mut parts = Parts::new(progress, shares(plan.sizes()));
    let field = Field::race(plan, 17, Kind::Thin, Meeting::PassingWithin(0.01), &mut parts);
    let [egjk, pqp] = [field.ratio(EGJK), field.ratio(PQP)];
    let least = [extremes(&egjk)[0], extremes(&pqp)[0]];
    let fastest = claim(
        "Thin faces, bodies that pass within 1 % of the diameter: CTA is the fastest of CTA, EGJK \
         and PQP.",
        format!(
            "time(EGJK)/time(CTA): {}; time(PQP)/time(CTA): {}.",
            listed(&egjk, 2),
            listed(&pqp, 1)
        ),
        least.iter().all(|ratio| *ratio > 1.0),
        || {
            let slower: Vec<_> =
                egjk.iter().filter(|p| p.y <= 1.0).map(|p| thousands(p.x)).collect();
            format!("EGJK is faster at {} vertices. {}", slower.join(", "), field.why_egjk())
        },
    );
    Finding {
        figures: vec![field.figure("figure-17", "Thin trapezoids, passing within 1 %")],
        tables: vec![field.table("figure-17-times", "Thin trapezoids, passing within 1 %")],
        claims: vec![fastest],
    }
}
