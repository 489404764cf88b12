//! Artificial findings.

use colltrans_lab::Experiment;
use colltrans_lab::claims::{Better, Claim, Criterion, PaperClaim, Reason, Subject, Theme, Why};
use colltrans_lab::finding::{Axis, Figure, Finding, Point, Series, Table};
use colltrans_lab::plan::{Plan, Progress};
use colltrans_lab::statistics::Estimate;

/// A series through `f` at sizes from 20 to 200,000 with a spread around it.
pub(crate) fn series(name: &str, f: impl Fn(f64) -> f64) -> Series {
    let sizes = [20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 1e4, 2e4, 5e4, 2e5];
    let points = sizes.map(|x| {
        let y = f(x);
        Point { x, y, low: 0.7 * y, high: 1.4 * y, count: 100 }
    });
    Series { name: name.into(), points: points.to_vec() }
}

/// A figure with everything a figure can have.
pub(crate) fn figure(id: &str) -> Figure {
    Figure {
        id: id.into(),
        title: "Time per query against the number of vertices of bodies that are far from each \
                other (median; bars from quartile to quartile)"
            .into(),
        x: Axis { label: "vertices of each body".into(), log: true },
        y: Axis { label: "time per query, µs".into(), log: true },
        series: vec![
            series("a < b & \"c\"", |n| 1.5 * n.ln()),
            series("costs $5 or $6", |n| 6.0 * n.ln() + 0.01 * n),
            series("linear", |n| 0.5 * n.powf(0.9)),
        ],
        references: vec![series("log n", f64::ln), series("√n", f64::sqrt)],
    }
}

static GROWS: PaperClaim = PaperClaim {
    id: "12-grows",
    statement: "Time grows like log n & not faster.",
    paper: "<log n>",
    place: "V-A, figure 12",
    theme: Theme::Scratch,
    subject: Subject::Cta,
    criteria: &[Criterion { what: "exponent", low: 0.0, high: 0.2, better: Better::Neither }],
};

static FASTER: PaperClaim = PaperClaim {
    id: "12-faster",
    statement: "It is faster than the others.",
    paper: "half",
    place: "V-A, figure 12",
    theme: Theme::Scratch,
    subject: Subject::Cta,
    criteria: &[Criterion { what: "ratio", low: 0.4, high: 0.6, better: Better::Less }],
};

pub(crate) fn finding(id: &str) -> Finding {
    let claim = |paper: &'static PaperClaim, [value, low, high]: [f64; 3], why: Option<&str>| {
        let measured = vec![Estimate { value, low, high }];
        let (verdict, details) = (paper.judge(&measured), "More <about> it.".into());
        let why = why.map(|text| Why { reason: Reason::Machine, text: text.into() });
        Claim { paper, measured, details, verdict, why }
    };
    let cells = |cells: [&str; 3]| cells.map(String::from).to_vec();
    Finding {
        figures: vec![figure(id), figure(&format!("{id}-near"))],
        tables: vec![Table {
            id: format!("{id}-table"),
            title: "Times, <all> of them".into(),
            columns: cells(["body", "vertices", "time, µs"]),
            rows: vec![cells(["ball, round", "20", "1.5"]), cells(["needle", "1,000", "2.5"])],
        }],
        claims: vec![
            claim(&GROWS, [0.12, 0.1, 0.14], None),
            claim(&FASTER, [2.0, 1.5, 2.5], Some("caches hold <64 vertices. Nothing else.")),
            claim(&FASTER, [2.0, 0.5, 2.5], Some("too few queries")),
            claim(&FASTER, [0.2, 0.1, 0.3], None),
        ],
    }
}

fn measure(id: &str, progress: &mut dyn Progress) -> Finding {
    progress.at(1.0, 4.0, "bodies");
    progress.at(4.0, 4.0, "queries");
    finding(id)
}

pub(crate) fn experiments() -> [Experiment; 2] {
    [
        Experiment {
            id: "figure-12",
            title: "time against <size>",
            seconds: [1.0; 2],
            run: |_: &Plan, progress| measure("figure-12", progress),
        },
        Experiment {
            id: "table-1",
            title: "bodies",
            seconds: [1.0; 2],
            run: |plan: &Plan, progress| {
                let mut finding = measure("table-1", progress);
                finding.figures.clear();
                finding.tables[0].rows.push(vec![plan.seed.to_string(); 3]);
                finding
            },
        },
    ]
}
