//! Checks invariances of free directions: under rotation of both bodies, and with a larger tolerance.

use colltrans::removal::directions::{FreeDirections, FreeError, FreeOptions, Verdict};
use colltrans::{Pose, QueryError, Solid};
use glam::{DMat3, DVec3};

use super::{bodies::Bodies, direction};
use crate::random::Random;

/// Number of directions of each check.
const DIRECTIONS: u64 = 20;
/// Tolerance of areas after a rotation, which is rounded.
const ROUNDED: f64 = 1e-6;

/// Checks that all free directions remain free with a larger tolerance.
pub(super) fn larger(
    all: &FreeDirections,
    bodies: &Bodies,
    tolerance: f64,
    rng: &mut Random,
) -> Result<u64, String> {
    let options = all.options().with_tolerance(tolerance);
    let [a, b] = [0, 1].map(|k| bodies.solids[k].at(bodies.poses[k]));
    // A body may vanish with this tolerance.
    if let Err(FreeError::Query(QueryError::NothingLeft { .. })) =
        FreeDirections::compute(&a, &b, options)
    {
        return Ok(0);
    }
    let loose = asked(&bodies.solids, bodies.poses, options)?;
    if loose.free_area()[1] + loose.undecided_area() < all.free_area()[0] {
        return Err(format!("less is free with the tolerance {tolerance}"));
    }
    compare(rng, all, &loose, |d| d, |tight, loose| !tight || loose)
}

/// Checks the answers after quarter turns, exactly, and after arbitrary rotations, approximately.
pub(super) fn turned(
    all: &FreeDirections,
    bodies: &Bodies,
    rng: &mut Random,
) -> Result<u64, String> {
    // An even permutation of the axes, two of them reversed.
    let mut quarter = [DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X), DMat3::IDENTITY]
        [usize::from(rng.one_in(3))];
    let kept = rng.int(0, 2) as usize;
    let signs = DVec3::from([0, 1, 2].map(|axis| if axis == kept { 1.0 } else { -1.0 }));
    quarter = DMat3::from_diagonal(signs) * quarter;
    let same = asked(&bodies.solids, by(quarter, bodies.poses)?, all.options())?;
    let compared = compare(rng, all, &same, |d| quarter * d, |one, other| one == other)?;
    if all.tolerance() > 0.0 {
        let turn = Pose::new(rng.rotation(), DVec3::ZERO).map_err(|e| e.to_string())?;
        let same = asked(&bodies.solids, by(turn.matrix(), bodies.poses)?, all.options())?;
        let open = all.undecided_area() + same.undecided_area() + ROUNDED;
        let [here, there] = [all, &same].map(FreeDirections::free_area);
        if here[0] > there[1] + open || there[0] > here[1] + open {
            return Err(format!("{here:?} is free, and turned {there:?}"));
        }
    }
    Ok(compared)
}

fn by(turn: DMat3, poses: [Pose; 2]) -> Result<[Pose; 2], String> {
    let turned = |p: Pose| Pose::from_matrix(turn * p.matrix(), turn * p.translation());
    match poses.map(turned) {
        [Ok(p), Ok(q)] => Ok([p, q]),
        _ => Err("a rotation is none".to_owned()),
    }
}

fn asked(
    [a, b]: &[Solid; 2],
    [p, q]: [Pose; 2],
    options: FreeOptions,
) -> Result<FreeDirections<'_>, String> {
    let all = FreeDirections::compute(&a.at(p), &b.at(q), options).map_err(|e| e.to_string())?;
    all.verify().map_err(|e| e.to_string())?;
    Ok(all)
}

/// Counts the directions for which both answers are compatible.
fn compare(
    rng: &mut Random,
    here: &FreeDirections,
    there: &FreeDirections,
    map: impl Fn(DVec3) -> DVec3,
    fits: impl Fn(bool, bool) -> bool,
) -> Result<u64, String> {
    let mut compared = 0;
    for _ in 0..DIRECTIONS {
        let d = direction(here, rng);
        let says =
            [here.classify(d), there.classify(map(d))].map(|says| says.map_err(|e| e.to_string()));
        let [one, other] = says;
        let (one, other) = (one?, other?);
        if one == Verdict::Undecided || other == Verdict::Undecided {
            continue;
        }
        if !fits(one == Verdict::Free, other == Verdict::Free) {
            return Err(format!("{one:?} along {d:?}, but {other:?} along {:?}", map(d)));
        }
        compared += 1;
    }
    Ok(compared)
}
