//! Beyond the paper: other shapes than ellipsoids, and real parts.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use colltrans::ConvexPolyhedron;

use super::rivals::WHO;
use super::{Coherence, Parts, Race, Results, against_size, axis, series, share, thousands, time};
use crate::Experiment;
use crate::finding::{Finding, Point, Table};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::{Bodies, Kind};
use crate::solvers::{Until, Who};
use crate::statistics::{mean, short};
use colltrans_testkit::timing::median;

pub(super) const BEYOND: Experiment =
    Experiment { id: "beyond", title: "other shapes than ellipsoids", run };

const KINDS: [Kind; 5] =
    [Kind::Balanced, Kind::Superellipsoid, Kind::HalfEllipsoid, Kind::RandomHull, Kind::Prism];

/// The one whose steps are counted to the end, after all of the figures 15 to 17.
const TO_THE_END: usize = WHO.len();

/// Bodies that pass at this least distance, in diameters.
const NEAR: f64 = 0.005;

/// What was measured on one kind at one size, or on one part.
struct Measured {
    name: String,
    colliding: Results,
    passing: Results,
}

fn run(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let sizes =
        plan.by_scale(&[50, 200][..], &[200, 3_200, 12_800], &[200, 800, 3_200, 12_800, 51_200]);
    let (found, refused) = plan.parts.as_deref().map_or_else(Default::default, read_parts);
    let all = KINDS.len() as f64 * super::shares(sizes) + found.len() as f64;
    let mut progress = Parts::new(progress, all);
    let mut rows: Vec<Vec<Measured>> = Vec::new();
    for kind in KINDS {
        let of_size = |&n: &usize| {
            let name = format!("{}, {}", kind.name(), thousands(n as f64));
            progress.begin(share(n), &name);
            measure(plan, name, (kind, n), None)
        };
        rows.push(sizes.iter().map(of_size).collect());
    }
    let ratios = KINDS.iter().zip(&rows).flat_map(|(kind, of_kind)| {
        [1, 3].map(|who| {
            let point = |m: &Measured| {
                Point::median(m.colliding.vertices, &m.colliding.ratios(who, 0).values())
            };
            series(
                format!("{}, {}", WHO[who].name(), kind.name()),
                of_kind.iter().map(point).collect(),
            )
        })
    });
    let figure = against_size(
        "beyond",
        "Other shapes: time over the time of CTA, median and quartiles",
        axis("time / time(CTA)", true),
        ratios.collect(),
    );
    let shapes = table("beyond-shapes", "Other shapes", rows.iter().flatten());
    let mut tables = vec![shapes];
    if plan.parts.is_some() {
        let measured: Vec<_> = found
            .into_iter()
            .enumerate()
            .map(|(k, (name, bodies))| {
                progress.begin(1.0, &name);
                measure(plan, name, (Kind::Balanced, k), Some(bodies))
            })
            .collect();
        let title = format!(
            "Hulls of real parts, each against itself ({refused} files hold no solid and are left out)"
        );
        tables.push(table("beyond-parts", &title, measured.iter()));
    }
    Finding { figures: vec![figure], tables, claims: Vec::new() }
}

fn measure(
    plan: &Plan,
    name: String,
    (kind, n): (Kind, usize),
    given: Option<Arc<Bodies>>,
) -> Measured {
    // Folders of parts hold a hundred files, and nothing but medians is made of these queries.
    let blocks = if given.is_some() { plan.by_scale(2, 3, 3) } else { plan.by_scale(2, 8, 12) };
    let who: Vec<_> = WHO.into_iter().chain([Who::Cta(Until::End)]).collect();
    let race = Race {
        plan,
        figure: 20,
        kind,
        n,
        given,
        who: &who,
        coherence: Coherence::Scratch,
        length: plan.by_scale(5, 30, 100),
        blocks,
    };
    let [colliding, passing] = race.run_in_turns(0, |variant, bodies, count, random| {
        let meeting = [Meeting::Colliding, Meeting::Passing(NEAR)][variant];
        (0..count).map(|_| Setting::draw(bodies, meeting, random)).collect()
    });
    Measured { name, colliding, passing }
}

fn table<'m>(id: &str, title: &str, rows: impl Iterator<Item = &'m Measured>) -> Table {
    let rivals = 1..WHO.len();
    let mut columns = vec!["shape, vertices".to_owned(), "CTA".into(), "steps to the end".into()];
    columns.push(format!("passing at {NEAR} D / colliding"));
    columns.extend(rivals.clone().map(|who| format!("{} / CTA", WHO[who].name())));
    columns.push("contradictions".into());
    let row = |m: &Measured| {
        let usual = median(&m.colliding.times(0));
        let mut cells = vec![
            m.name.clone(),
            time(usual),
            short(mean(&m.colliding.steps(TO_THE_END).values())),
            short(median(&m.passing.times(0)) / usual),
        ];
        let ratio = |who: usize| short(median(&m.colliding.ratios(who, 0).values()));
        cells.extend(rivals.clone().map(ratio));
        let wrong = |r: &Results| (0..=TO_THE_END).map(|who| r.contradictions(who)).sum::<usize>();
        cells.push((wrong(&m.colliding) + wrong(&m.passing)).to_string());
        cells
    };
    let rows = rows.map(row).collect();
    Table { id: id.into(), title: format!("{title}: medians"), columns, rows }
}

/// The hulls of all mesh files in a folder and its folders, by name, and how many files hold none.
fn read_parts(folder: &Path) -> (Vec<(String, Arc<Bodies>)>, usize) {
    let (mut parts, mut refused) = (Vec::new(), 0);
    for path in files(folder) {
        if colltrans_mesh::Format::of_path(&path).is_err() {
            continue;
        }
        let Some(body) = hull(&path) else {
            refused += 1;
            continue;
        };
        let name = path.strip_prefix(folder).unwrap_or(&path).display().to_string();
        let name = format!("{name}, {}", thousands(body.vertices().len() as f64));
        parts.push((name, Arc::new(Bodies::new([body.clone(), body]))));
    }
    (parts, refused)
}

fn hull(path: &Path) -> Option<ConvexPolyhedron> {
    let mesh = colltrans_mesh::read(path).ok()?;
    ConvexPolyhedron::from_points(&mesh.vertices).ok().filter(|body| body.dimension() == 3)
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    let each = paths.into_iter().map(|path| if path.is_dir() { files(&path) } else { vec![path] });
    each.flatten().collect()
}
