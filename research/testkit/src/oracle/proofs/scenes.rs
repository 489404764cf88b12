//! Proofs of scene queries of convex bodies, judged for each obstacle.

use colltrans::{ConvexPolyhedron, Obstacles, Pose, ProofFile, SceneQuery};
use glam::DVec3;
use serde_json::Value;

use super::casts::{other_normal, other_weights};
use super::checkers::{Verdict, verify};
use super::file::{Bodies, body_at, is_at_limit, numbers, vector, vectors};
use super::motions::{body, first, is_at_the_limit, pose, refused_for_rounding};
use super::mutants::{number, pointers, with};
use super::{CheckerKind, Claim, Kind};
use crate::oracle::exact::{Dyadic, Ratio, Vector, place};
use crate::oracle::nearest::depth;
use crate::random::Random;
use crate::shapes::reach;

/// The nearest obstacle, the obstacles within a length, and the clearance.
pub const SCENES: Kind = Kind {
    name: "scenes",
    focus: "/statement",
    draw_proof: base,
    claims,
    to_limits: worst,
    find_falsehood: falsehood,
    is_marginal,
};

/// Tolerance in noises of a bound at an obstacle that is passed, which decides about sliding or being behind.
const PASSED: f64 = 300.0;

fn base(seed: u64) -> Option<String> {
    let random = &mut Random::stream(seed, &[0x5ce_4e5]);
    let bodies: Vec<ConvexPolyhedron> = (0..2).map(|_| body(random)).collect();
    let mut room = Obstacles::new();
    for _ in 0..=random.index(4) {
        let turn = if random.one_in(2) { glam::DQuat::IDENTITY } else { random.rotation() };
        let at = if random.one_in(2) { random.grid(-2, 2) } else { random.vector() * 2.5 };
        room.insert(bodies[random.index(2)].clone(), Pose::new(turn, at).ok()?);
    }
    let at = Pose::new(random.rotation(), random.vector() * 2.0).ok()?;
    let mut asked = SceneQuery::new(bodies[0].at(at), &room).ok()?;
    if random.one_in(4) {
        let min_gap = 10.0_f64.powf(random.range(-6.0, -0.5));
        asked = asked.with_options(asked.options().with_min_gap(min_gap)).ok()?;
        asked = asked.with_solid_options(asked.solid_options().with_min_gap(min_gap));
    }
    let file = match random.index(4) {
        0 => ProofFile::of_nearest(&asked).ok()??,
        1 => ProofFile::of_within(&asked, random.range(0.0, 3.0)).ok()?,
        2 => ProofFile::of_scene_clearance(&asked, random.grid(-1, 1)).ok()?,
        _ => ProofFile::of_scene_clearance(&asked, random.direction()).ok()?,
    };
    Some(file.to_json())
}

/// Checks whether the library rejects a file because of its rounding margins.
fn is_marginal(file: &Value) -> bool {
    let verdict = |file: &Value| verify(&file.to_string());
    let length = "/statement/within/length";
    let moved = |by: f64| {
        let old = file.pointer(length).and_then(Value::as_f64)?;
        Some(verdict(&with(file, length, Some(number(old + by)))).accepts())
    };
    // The library also reads parts of an answer that claim nothing.
    let reads_more = |verdict: &Verdict| match verdict {
        Verdict::Refused(reason) => reason.starts_with("not a saved proof"),
        _ => false,
    };
    let passed = file.pointer("/statement/scene_clearance/passed").is_some();
    is_at_the_limit(file)
        || has_a_normal_at_the_limit(file)
        || refused_for_rounding(&verdict(file), 0.0)
        || (passed && reads_more(&verdict(file)))
        || [1e-9, -1e-9].into_iter().any(|by| moved(by) == Some(true))
}

/// Checks whether a normal of a separation is orthogonal to the direction up to the limit.
fn has_a_normal_at_the_limit(file: &Value) -> bool {
    let vector_at = |at: &str| file.pointer(at).and_then(vector);
    let Some(direction) = vector_at("/statement/scene_clearance/direction") else { return false };
    let all = super::mutants::pointers(file);
    let normals = all.iter().filter(|at| at.ends_with("/separated/certificate/normal"));
    let along = |normal: DVec3| normal.dot(direction) / direction.length();
    normals.filter_map(|at| vector_at(at)).any(|normal| is_at_limit(along(normal)))
}

fn claims(file: &Value) -> Vec<Claim> {
    [
        ("/statement/nearest/lower", 0.0, 1e300),
        ("/statement/nearest/near/convex/distance", 1e300, 0.0),
        ("/statement/within/length", 0.0, 1e300),
        ("/statement/within/length", 1e300, 0.0),
        ("/statement/scene_clearance/lower", 0.0, 1e300),
    ]
    .into_iter()
    .filter(|(pointer, ..)| file.pointer(pointer).is_some_and(Value::is_number))
    .map(|(pointer, weakest, strongest)| {
        // A length is not a bound, so it is changed in both directions.
        let old = file.pointer(pointer).and_then(Value::as_f64).unwrap_or(weakest);
        let weakest = if pointer.ends_with("length") { old } else { weakest };
        Claim { pointer: pointer.into(), weakest, strongest, band: 1e-9 }
    })
    .collect()
}

fn worst(file: &mut Value, random: &mut Random) {
    let all = pointers(file);
    let ending = |end: &str| -> Vec<&String> {
        all.iter().filter(|at| at.starts_with("/statement") && at.ends_with(end)).collect()
    };
    let count = file.pointer("/placement/poses").and_then(Value::as_array).map_or(1, Vec::len);
    let pick = |of: &[&String], random: &mut Random| {
        (!of.is_empty()).then(|| of[random.index(of.len())].clone())
    };
    match random.index(8) {
        0 | 1 => {
            let normals = [ending("/normal"), ending("/separating_direction")].concat();
            let Some(at) = pick(&normals, random) else { return };
            let Some(normal) = file.pointer(&at).and_then(vector) else { return };
            let other = other_normal(normal, random.direction(), random).to_array();
            *file = with(file, &at, Some(Value::from(other.to_vec())));
        }
        2 => {
            let Some(at) = pick(&ending("/weights"), random) else { return };
            let count = file.pointer(&at).and_then(numbers).map_or(3, |w| w.len());
            *file = with(file, &at, Some(other_weights(count, random)));
        }
        3 => {
            let bounds = [
                ending("/lower"),
                ending("/upper"),
                ending("/gap"),
                ending("/distance"),
                ending("/rounding"),
                ending("/margin"),
            ];
            let Some(at) = pick(&bounds.concat(), random) else { return };
            let old = file.pointer(&at).and_then(Value::as_f64).unwrap_or(0.0);
            let by = random.pick(&[1e-13, -1e-13, 0.1, -0.1, 1e-6, -1e-6]);
            *file = with(file, &at, Some(number(old + by)));
        }
        4 => {
            let lists = [
                "/statement/nearest/apart",
                "/statement/within/apart",
                "/statement/within/closer",
                "/statement/within/undecided",
                "/statement/scene_clearance/passed",
            ];
            let there: Vec<String> = lists
                .iter()
                .filter(|at| file.pointer(at).is_some())
                .map(|at| (*at).to_owned())
                .collect();
            if there.is_empty() {
                return;
            }
            let at = &there[random.index(there.len())];
            let entries = file.pointer(at).and_then(Value::as_array).map_or(0, Vec::len);
            if at.ends_with("undecided") {
                let Some(list) = file.pointer_mut(at).and_then(Value::as_array_mut) else { return };
                list.push(Value::from(random.index(count)));
            } else if entries > 0 {
                let entry = format!("{at}/{}", random.index(entries));
                let to = Some(Value::from(random.index(count)));
                *file = if random.one_in(2) {
                    with(file, &entry, None)
                } else {
                    with(file, &format!("{entry}/0"), to)
                };
            }
        }
        5 => {
            for at in ["/statement/nearest/obstacle", "/statement/scene_clearance/stop"] {
                *file = with(file, at, Some(Value::from(random.index(count))));
            }
        }
        6 => {
            let old = file.pointer("/statement/scene_clearance/direction").and_then(vector);
            let Some(d) = old else { return };
            let d = (d + random.direction() * random.pick(&[1e-15, 1e-3])).to_array();
            *file =
                with(file, "/statement/scene_clearance/direction", Some(Value::from(d.to_vec())));
        }
        _ => {
            let place = format!("/placement/poses/{}/pose/translation", random.index(count));
            let Some(at) = file.pointer(&place).and_then(vector) else { return };
            let at = (at + random.direction() * random.pick(&[1e-15, 1e-9, 0.1])).to_array();
            *file = with(file, &place, Some(Value::from(at.to_vec())));
        }
    }
}

/// Returns the pairs of the moving body and each obstacle.
fn read_pairs(file: &Value) -> Option<Vec<Bodies>> {
    let placed = |at: &Value| {
        let body = body_at(file, at)?;
        let points = vectors(body.pointer("/convex/vertices")?)?;
        let pose: Pose = pose(at.get("pose")?)?;
        let placed = place(pose.matrix(), pose.translation(), &points);
        Some((placed, reach(&points), pose.translation()))
    };
    let [moving, obstacles @ ..] = &file.pointer("/placement/poses")?.as_array()?[..] else {
        return None;
    };
    let (p, reach, origin) = placed(moving)?;
    let min_gap = file.pointer("/query/scene/min_gap").map_or(Some(0.0), Value::as_f64)?;
    let direction = match file.pointer("/statement/scene_clearance/direction") {
        Some(direction) => Some(vector(direction)?),
        None => None,
    };
    let of = |at: &Value| {
        let (q, other, there) = placed(at)?;
        let size = reach + other + (there - origin).length();
        Some(Bodies {
            points: [p.clone(), q],
            facets: [Vec::new(), Vec::new()],
            direction,
            min_gap,
            radii: Dyadic::ZERO,
            size,
        })
    };
    obstacles.iter().map(of).collect()
}

fn falsehood(file: &Value, who: CheckerKind) -> Option<String> {
    first(found(file, who))
}

fn exact_square(x: f64) -> Ratio {
    Ratio::from_f64(x).times(&Ratio::from_f64(x))
}

/// Returns the false statements; `None` if the file is invalid.
fn found(file: &Value, _: CheckerKind) -> Option<Vec<String>> {
    let all = read_pairs(file)?;
    let at = |k: &Value| all.get(k.as_u64()? as usize);
    let near = |of: &Value| of.pointer("/convex/distance").and_then(Value::as_f64);
    if let Some(of) = file.pointer("/statement/nearest") {
        let (lower, upper) = (of.get("lower")?.as_f64()?, near(of.get("near")?)?);
        if at(of.get("obstacle")?)?.distance() > exact_square(upper) {
            return Some(vec![format!("the obstacle is not within {upper}")]);
        }
        let nearer = all.iter().position(|pair| pair.distance() < exact_square(lower));
        let what = nearer.map(|k| format!("obstacle {k} is nearer than {lower}"));
        return Some(what.into_iter().collect());
    }
    if let Some(of) = file.pointer("/statement/within") {
        let length = of.get("length")?.as_f64().unwrap_or(f64::INFINITY);
        if length < 0.0 {
            return Some(vec!["a length that is negative".into()]);
        }
        let square = length.is_finite().then(|| exact_square(length));
        let named = |list: &str| -> Option<Vec<usize>> {
            let index = |entry: &Value| entry.get(0).unwrap_or(entry).as_u64().map(|k| k as usize);
            of.get(list)?.as_array()?.iter().map(index).collect()
        };
        let (closer, open) = (named("closer")?, named("undecided")?);
        for (k, pair) in all.iter().enumerate() {
            let is_close = square.as_ref().is_none_or(|square| pair.distance() <= *square);
            if closer.contains(&k) && !is_close {
                return Some(vec![format!("obstacle {k} is not closer")]);
            }
            if !closer.contains(&k) && !open.contains(&k) && is_close {
                return Some(vec![format!("obstacle {k} is closer")]);
            }
        }
        return Some(Vec::new());
    }
    let of = file.pointer("/statement/scene_clearance")?;
    let lower = of.get("lower")?.as_f64().unwrap_or(f64::INFINITY);
    let graze = file.pointer("/query/scene/graze_tolerance").map_or(Some(0.0), Value::as_f64)?;
    let d = vector(of.get("direction")?)?;
    let claim = |k: usize| {
        let passed = of.get("passed")?.as_array()?;
        Some(&passed.iter().find(|entry| entry[0].as_u64() == Some(k as u64))?[1])
    };
    let stop = of.get("stop")?.as_u64().map(|k| k as usize);
    let overlapping =
        stop.and_then(claim).is_some_and(|of| of.pointer("/convex/overlapping").is_some());
    if lower == 0.0 && overlapping {
        let pair = all.get(stop?)?;
        let what = (pair.distance() > exact_square(pair.min_gap)).then(|| "no overlap".to_owned());
        return Some(what.into_iter().collect());
    }
    for (k, pair) in all.iter().enumerate() {
        let free = claim(k).and_then(|of| of.pointer("/convex/free"));
        let to_rounding = free.is_some_and(|free| free.get("separated").is_none());
        let allowed = if to_rounding { graze.max(0.0) + PASSED * pair.noise() } else { 0.0 };
        let far = 4.0 * pair.size / d.length();
        if swept_meets(pair, d, lower.min(far), allowed) {
            return Some(vec![format!("obstacle {k} stops the body before {lower}")]);
        }
    }
    let Some(stop) = stop else { return Some(Vec::new()) };
    let pair = all.get(stop)?;
    let upper = claim(stop)?.pointer("/convex/blocked/contact/certificate/upper")?.as_f64()?;
    let allowed = pair.min_gap.max(pair.noises(3.06));
    let met = pair.least_distance_until(d, upper) <= exact_square(allowed);
    let what = (!met).then(|| format!("obstacle {stop} does not stop the body by {upper}"));
    Some(what.into_iter().collect())
}

/// Checks whether the moving body comes nearer to an obstacle than the minimum gap, beyond the tolerance.
fn swept_meets(pair: &Bodies, d: DVec3, until: f64, allowed: f64) -> bool {
    let until = until.next_down();
    if until < 0.0 {
        return false;
    }
    let mut swept = pair.points[0].clone();
    let by = Vector::new(d).times(&Dyadic::new(until));
    swept.extend(pair.points[0].iter().map(|p| p.plus(&by)));
    let square = crate::oracle::distance::distance(&swept, &pair.points[1]).square;
    if pair.min_gap > 0.0 {
        return square < exact_square((pair.min_gap * (1.0 - f64::EPSILON) - allowed).max(0.0));
    }
    square.is_zero()
        && (allowed == 0.0 || depth(&swept, &pair.points[1], pair.noise()) > exact_square(allowed))
}
