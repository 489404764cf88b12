//! Beyond the paper: shapes other than ellipsoids, and real parts.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use colltrans::ConvexPolyhedron;

use super::rivals::{CTA, EGJK, PQP, WHO};
use super::{
    Coherence, Gathered, Race, Results, Unit, against_size, grouped_digits, in_passes, new_axis,
    new_series, time_text,
};
use crate::Experiment;
use crate::finding::{Finding, Point, Table};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::{Bodies, Kind};
use crate::statistics::{mean, short};
use colltrans_testkit::timing::median;

pub(super) const BEYOND: Experiment =
    Experiment { id: "beyond", title: "other shapes than ellipsoids", seconds: [5.0, 20.0], run };

const KINDS: [Kind; 5] =
    [Kind::Balanced, Kind::Superellipsoid, Kind::HalfEllipsoid, Kind::RandomHull, Kind::Prism];

/// Bodies that pass at this least distance, in diameters.
const NEAR: f64 = 0.005;

/// Results for one kind at one size, or for one part.
struct Measured {
    name: String,
    colliding: Results,
    passing: Results,
}

impl Gathered for Measured {
    fn gather(&mut self, more: Self) {
        self.colliding.gather(more.colliding);
        self.passing.gather(more.passing);
    }
}

/// Subject of a race: a kind at a size, or hulls of a part.
struct Item {
    name: String,
    kind: Kind,
    n: usize,
    given: Option<Arc<Bodies>>,
}

fn run(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let sizes =
        plan.by_scale(&[50, 200][..], &[200, 3_200, 12_800], &[200, 800, 3_200, 12_800, 51_200]);
    let (found, refused) = plan.parts.as_deref().map_or_else(Default::default, read_parts);
    let shape = |kind: Kind, n: usize| {
        let name = format!("{}, {}", kind.name(), grouped_digits(n as f64));
        Item { name, kind, n, given: None }
    };
    let part = |(k, (name, bodies)): (usize, (String, Arc<Bodies>))| Item {
        name,
        kind: Kind::Balanced,
        n: k,
        given: Some(bodies),
    };
    let shapes = KINDS.into_iter().flat_map(|kind| sizes.iter().map(move |n| shape(kind, *n)));
    let items: Vec<_> = shapes.chain(found.into_iter().enumerate().map(part)).collect();
    let told = |item: &Item| (item.n, item.name.clone());
    let mut measured =
        in_passes(plan, progress, &items, told, |item, pass| measure(plan, item, pass));
    let parts = measured.split_off(KINDS.len() * sizes.len());
    let rows: Vec<_> = measured.chunks(sizes.len()).collect();
    let ratios = KINDS.iter().zip(&rows).flat_map(|(kind, of_kind)| {
        [EGJK, PQP].map(|who| {
            let point = |m: &Measured| {
                Point::median(
                    m.colliding.vertices(),
                    &m.colliding.ratios(who, CTA, Unit::Time).values(),
                )
            };
            new_series(
                format!("{}, {}", WHO[who].name(), kind.name()),
                of_kind.iter().map(point).collect(),
            )
        })
    });
    let figure = against_size(
        "beyond",
        "Other shapes: time over the time of CTA, median and quartiles",
        new_axis("time / time(CTA)", true),
        ratios.collect(),
    );
    let mut tables = vec![times_table("beyond-shapes", "Other shapes", measured.iter())];
    if plan.parts.is_some() {
        let title = format!(
            "Hulls of real parts, each against itself ({refused} files hold no solid and are left out)"
        );
        tables.push(times_table("beyond-parts", &title, parts.iter()));
    }
    Finding { figures: vec![figure], tables, claims: Vec::new() }
}

fn measure(plan: &Plan, Item { name, kind, n, given }: &Item, pass: u32) -> Measured {
    // Folders of parts hold a hundred files, and nothing but medians is made of these queries.
    let blocks = if given.is_some() { 1 } else { plan.by_scale(2, 2, 2) };
    let race = Race {
        plan,
        figure: 20,
        kind: *kind,
        n: *n,
        given: given.clone(),
        who: &WHO,
        coherence: Coherence::Scratch,
        length: plan.by_scale(5, 30, 30),
        blocks,
    };
    let [colliding, passing] = race.run_in_turns(pass, 0, |variant, bodies, count, random| {
        let meeting = [Meeting::Colliding, Meeting::Passing(NEAR)][variant];
        (0..count).map(|_| Setting::draw(bodies, meeting, random)).collect()
    });
    Measured { name: name.clone(), colliding, passing }
}

fn times_table<'m>(id: &str, title: &str, rows: impl Iterator<Item = &'m Measured>) -> Table {
    let rivals = 1..WHO.len();
    let mut columns = vec!["shape, vertices".to_owned(), "CTA".into(), "steps".into()];
    columns.push(format!("passing at {NEAR} D / colliding"));
    columns.extend(rivals.clone().map(|who| format!("{} / CTA", WHO[who].name())));
    columns.push("contradictions".into());
    let row = |m: &Measured| {
        let usual = median(&m.colliding.times(0));
        let mut cells = vec![
            m.name.clone(),
            time_text(usual),
            short(mean(&m.colliding.steps(0).values())),
            short(median(&m.passing.times(0)) / usual),
        ];
        let ratio = |who: usize| short(median(&m.colliding.ratios(who, CTA, Unit::Time).values()));
        cells.extend(rivals.clone().map(ratio));
        let wrong = |r: &Results| (0..WHO.len()).map(|who| r.contradictions(who)).sum::<usize>();
        cells.push((wrong(&m.colliding) + wrong(&m.passing)).to_string());
        cells
    };
    let rows = rows.map(row).collect();
    Table { id: id.into(), title: format!("{title}: medians"), columns, rows }
}

/// Reads the hulls of all mesh files in a folder and its subfolders, by name, and counts the files without a hull.
fn read_parts(folder: &Path) -> (Vec<(String, Arc<Bodies>)>, usize) {
    let (mut parts, mut refused) = (Vec::new(), 0);
    for path in files_below(folder) {
        if colltrans_mesh::Format::from_path(&path).is_err() {
            continue;
        }
        let Some(body) = read_hull(&path) else {
            refused += 1;
            continue;
        };
        let name = path.strip_prefix(folder).unwrap_or(&path).display().to_string();
        let name = format!("{name}, {}", grouped_digits(body.vertices().len() as f64));
        parts.push((name, Arc::new(Bodies::new([body.clone(), body]))));
    }
    (parts, refused)
}

fn read_hull(path: &Path) -> Option<ConvexPolyhedron> {
    let mesh = colltrans_mesh::read(path).ok()?;
    ConvexPolyhedron::from_points(&mesh.vertices).ok().filter(|body| body.dimension() == 3)
}

fn files_below(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    let each =
        paths.into_iter().map(|path| if path.is_dir() { files_below(&path) } else { vec![path] });
    each.flatten().collect()
}
