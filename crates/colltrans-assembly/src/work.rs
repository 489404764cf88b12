//! Growth of the number of queries with the number of parts. Queries are counted, not timed, so that the load of the
//! machine has no effect.

use std::path::Path;
use std::sync::atomic::Ordering::Relaxed;

use colltrans::solid::StartOverlap;
use colltrans_mesh::Format;
use glam::{DAffine3, DVec3};

use crate::bodies::{Bodies, Fit};
use crate::findings::AnalysisRequest;
use crate::liaisons::find_liaisons;
use crate::matrix::ContactMatrix;
use crate::part::{Assembly, Part, Piece};
use crate::plan::disassemble;
use crate::start::Start;
use crate::travel::travels_of_parts;
use crate::watch::Watch;
use colltrans::Aabb;

/// Number of cubes along each axis.
const GRID: [usize; 3] = [20, 15, 10];
const CUBE: &str = "OFF\n8 6 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n\
    4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n";

/// Returns an assembly of 3,000 unit cubes at distances of 2.
fn grid_assembly() -> Assembly {
    let at = |k: usize| [k % GRID[0], k / GRID[0] % GRID[1], k / GRID[0] / GRID[1]];
    cube_assembly((0..GRID.iter().product()).map(|k| at(k).map(|x| 2 * x)))
}

/// Returns an assembly of unit cubes at the given positions.
fn cube_assembly(places: impl Iterator<Item = [usize; 3]>) -> Assembly {
    let mesh = colltrans_mesh::parse(Format::Off, CUBE.into(), Path::new("cube.off")).unwrap();
    let parts = places.enumerate().map(|(k, place)| {
        let at = DVec3::from_array(place.map(|x| x as f64));
        let piece = Piece { mesh: mesh.clone(), world_from_piece: DAffine3::from_translation(at) };
        Part::new(format!("p{k}"), &[piece]).unwrap()
    });
    Assembly::new(parts.collect()).unwrap()
}

#[test]
fn plan_of_a_row_queries_at_most_four_pairs_per_part() {
    for count in [300, 600, 1_200] {
        let assembly = cube_assembly((0..count).map(|k| [2 * k, 0, 0]));
        let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
        let asked = || bodies.query_count.swap(0, Relaxed);
        asked();
        let found = AnalysisRequest::default().analyse(&bodies, Watch::default()).unwrap();
        assert_eq!((found.plan.steps.len(), found.plan.base.len()), (count - 1, 1));
        // Each part needs about one query for each direction of the row; all leave upwards.
        let asked = asked();
        assert!(asked <= 4 * count, "{asked} pairs of {count} parts");
        assert!(!found.matrix.is_complete());
    }
}

#[test]
fn plan_of_a_row_visits_n_log_n_items() {
    for count in [250, 1_000] {
        let assembly = cube_assembly((0..count).map(|k| [2 * k, 0, 0]));
        let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
        let (question, watch) = (AnalysisRequest::default(), Watch::default());
        let found = question.analyse_without_plan(&bodies, watch).unwrap();
        bodies.visit_count.store(0, Relaxed);
        let (matrix, finer) = (&found.matrix, &found.candidates.finer);
        let plan = disassemble(&bodies, matrix, finer, question.options, watch).unwrap();
        assert_eq!((plan.steps.len(), plan.base.len()), (count - 1, 1));
        // Visits of parts, pairs and nodes of the tree over the parts, whose depth this is.
        let (looks, depth) = (bodies.visit_count.load(Relaxed), count.ilog2() as usize);
        assert!(looks <= 16 * count * depth, "{looks} of {count} parts");
    }
}

/// Counts the ordered pairs of boxes of which the first meets the second along a direction, by testing all pairs.
fn count_pairs_ahead(boxes: &[Aabb], d: DVec3) -> usize {
    let meets = |a: &Aabb, b: &Aabb| {
        let (mut enter, mut exit) = (0.0_f64, f64::INFINITY);
        for k in 0..3 {
            let (low, high) = (b.low[k] - a.high[k], b.high[k] - a.low[k]);
            if d[k] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return false;
                }
                continue;
            }
            let (x, y) = (low / d[k], high / d[k]);
            enter = enter.max(x.min(y));
            exit = exit.min(x.max(y));
        }
        enter <= exit
    };
    let of = |a: &Aabb| boxes.iter().filter(|b| !std::ptr::eq(a, *b) && meets(a, b)).count();
    boxes.iter().map(of).sum()
}

#[test]
fn grid_of_3000_parts_queries_only_blocking_pairs() {
    let (assembly, watch) = (grid_assembly(), Watch::default());
    let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
    let asked = || bodies.query_count.swap(0, Relaxed);
    assert_eq!(bodies.len(), 3_000);
    // No two cubes are near, so overlaps and contacts need no query.
    assert!(bodies.neighbouring_pairs(0.5).unwrap().is_empty());
    assert!(Start::new(&bodies, watch).unwrap().overlaps.is_empty());
    assert!(find_liaisons(&bodies, watch).unwrap().is_empty());
    assert_eq!(asked(), 0);
    // The matrix computes each pair in a row once for both directions.
    let axes: Vec<DVec3> = DVec3::AXES.iter().flat_map(|&d| [d, -d]).collect();
    let all = vec![true; 3_000];
    let start = StartOverlap::Refuse;
    let matrix = ContactMatrix::new(&bodies, &axes, &all, start, watch).unwrap();
    let in_rows: usize = GRID.iter().map(|n| 3_000 / n * (n * (n - 1) / 2)).sum();
    assert_eq!(asked(), in_rows);
    let met: usize = (0..6).map(|k| matrix.contacts_along(k).len()).sum();
    assert_eq!(met, 2 * in_rows);
    // Free travel queries the nearest part, and parts whose boxes may be equally near.
    travels_of_parts(&bodies, &axes, start, watch).unwrap();
    let nearest = asked();
    let blocked: usize = GRID.iter().map(|n| 2 * 3_000 / n * (n - 1)).sum();
    assert!((blocked..=blocked + blocked / 10).contains(&nearest), "{nearest} of {blocked}");
    // Along oblique directions, at most the pairs whose boxes meet are queried.
    let boxes: Vec<Aabb> = (0..3_000).map(|k| bodies.bounds(k)).collect();
    for d in [DVec3::new(0.6, 0.0, -0.8), DVec3::new(2.0, -3.0, 6.0) / 7.0] {
        travels_of_parts(&bodies, &[d], start, watch).unwrap();
        let (count, most) = (asked(), count_pairs_ahead(&boxes, d));
        assert!(count > 1_000 && count <= most && most < 100_000, "{count} of {most}");
    }
}
