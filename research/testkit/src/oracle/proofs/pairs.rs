//! Proofs of distances and depths of convex bodies.

use colltrans::{Pair, ProofFile};
use glam::DVec3;
use serde_json::Value;

use super::casts::{BAND, HUGE, drawn, other_normal, other_pair, other_weights, put};
use super::file::{Bodies, differences, indices, is_at_limit, numbers, square, vector, vectors};
use super::mutants::with;
use super::{CheckerKind, Claim, Kind};
use crate::oracle::exact::{Dyadic, Ratio, Vector};
use crate::oracle::nearest::depth;
use crate::random::Random;

/// Distances, and whether bodies are closer than a length.
pub const DISTANCES: Kind = Kind {
    name: "distances",
    focus: "/statement",
    draw_proof: distance,
    claims,
    to_limits: worst,
    find_falsehood: falsehood,
    is_marginal,
};

/// Depths.
pub const DEPTHS: Kind = Kind { name: "depths", draw_proof: deep, ..DISTANCES };

/// Maximum number of vertices of both bodies for which a depth is computed exactly.
const MOST_DEEP: usize = 20;

const GAP: &str = "/statement/distance/gap";
const NEAR: &str = "/statement/distance/near";
const DEPTH: &str = "/statement/depth";

fn distance(seed: u64) -> Option<String> {
    let (setting, bodies) = drawn(seed)?;
    let (p, q) = (setting.moving_pose, setting.fixed_pose);
    let pair = Pair::new(bodies.moving.at(p), bodies.fixed.at(q)).ok()?;
    let distance = pair.distance().ok()?;
    if seed.is_multiple_of(4) {
        let within = pair.within(distance.upper * 0.75).ok()?;
        return Some(ProofFile::of_distance(&pair, &within).to_json());
    }
    Some(ProofFile::of_distance(&pair, &distance).to_json())
}

fn deep(seed: u64) -> Option<String> {
    let (mut setting, bodies) = drawn(seed)?;
    if bodies.moving.vertices().len() + bodies.fixed.vertices().len() > MOST_DEEP {
        return None;
    }
    let random = &mut Random::stream(seed, &[0xdee9]);
    if !random.one_in(6) {
        // The bodies are moved over each other.
        let center = |points: &[DVec3]| points.iter().sum::<DVec3>() / points.len() as f64;
        let p = setting.moving_pose.transform_point(center(bodies.moving.vertices()));
        let q = setting.fixed_pose.transform_point(center(bodies.fixed.vertices()));
        let size = bodies.fixed.bounds_size() * 0.4;
        let by = q - p + random.direction() * (size * random.range(0.0, 1.0));
        setting.moving_pose = setting.moving_pose.translated_by(by).ok()?;
    }
    let (p, q) = (setting.moving_pose, setting.fixed_pose);
    let pair = Pair::new(bodies.moving.at(p), bodies.fixed.at(q)).ok()?;
    Some(ProofFile::of_depth(&pair, &pair.depth().ok()?).to_json())
}

/// The extent of a body.
trait Reaches {
    fn bounds_size(&self) -> f64;
}

impl Reaches for colltrans::ConvexPolyhedron {
    fn bounds_size(&self) -> f64 {
        let points = self.vertices();
        points.iter().map(|v| v.distance(points[0])).fold(0.0, f64::max)
    }
}

fn has(file: &Value, at: &str) -> bool {
    file.pointer(at).is_some_and(Value::is_object)
}

fn claims(file: &Value) -> Vec<Claim> {
    let Some(bodies) = Bodies::read(file) else { return Vec::new() };
    let band = BAND * bodies.noise();
    let all = [
        (GAP, "gap", 0.0, HUGE),
        (NEAR, "distance", HUGE, 0.0),
        (DEPTH, "lower", 0.0, HUGE),
        (DEPTH, "upper", HUGE, 0.0),
    ];
    let there = all.into_iter().filter(|(at, ..)| has(file, at));
    there
        .map(|(at, name, weakest, strongest)| Claim {
            pointer: format!("{at}/{name}"),
            weakest,
            strongest,
            band,
        })
        .collect()
}

fn worst(file: &mut Value, random: &mut Random) {
    let normal = |file: &mut Value, at: &str, random: &mut Random| {
        let Some(normal) = file.pointer(at).and_then(vector) else { return };
        let toward = random.direction();
        let other = other_normal(normal, toward, random).to_array();
        *file = with(file, at, Some(Value::from(other.to_vec())));
    };
    let parts: Vec<&str> = [GAP, NEAR, DEPTH].into_iter().filter(|at| has(file, at)).collect();
    if parts.is_empty() {
        return;
    }
    match parts[random.index(parts.len())] {
        GAP => normal(file, &format!("{GAP}/normal"), random),
        NEAR => match random.index(3) {
            0 => other_pair(file, &format!("{NEAR}/pairs"), random),
            1 => put(file, &format!("{NEAR}/distance"), 0.0),
            _ => *file = with(file, &format!("{NEAR}/weights"), Some(other_weights(4, random))),
        },
        _ => {
            let count = |name: &str| {
                let list = file.pointer(&format!("{DEPTH}/enclosure/{name}"));
                list.and_then(Value::as_array).map_or(0, Vec::len)
            };
            let (normals, triangles) = (count("normals"), count("triangles"));
            match random.index(6) {
                0 => normal(file, &format!("{DEPTH}/direction"), random),
                1 => other_pair(file, &format!("{DEPTH}/enclosure/pairs"), random),
                2 if triangles > 0 => {
                    let at = format!("{DEPTH}/enclosure/triangles/{}", random.index(triangles));
                    let old = file.pointer(&at).and_then(indices).unwrap_or_default();
                    let turned: Vec<usize> = old.into_iter().rev().collect();
                    *file = with(file, &at, Some(Value::from(turned)));
                }
                3 if triangles > 0 => {
                    let k = random.index(triangles);
                    for list in ["triangles", "normals"] {
                        *file = with(file, &format!("{DEPTH}/enclosure/{list}/{k}"), None);
                    }
                }
                4 if triangles > 0 => {
                    for list in ["triangles", "normals"] {
                        let at = format!("{DEPTH}/enclosure/{list}");
                        *file = with(file, &at, Some(Value::Array(Vec::new())));
                    }
                }
                _ if normals > 0 => {
                    let k = random.index(normals);
                    normal(file, &format!("{DEPTH}/enclosure/normals/{k}"), random);
                }
                _ => {}
            }
        }
    }
}

fn falsehood(file: &Value, _: CheckerKind) -> Option<String> {
    let Some(bodies) = Bodies::read(file) else { return Some("invalid bodies".into()) };
    let at = |at: &str, name: &str| file.pointer(&format!("{at}/{name}")).and_then(Value::as_f64);
    let (gap, near) = (at(GAP, "gap"), at(NEAR, "distance"));
    let bounds = [at(DEPTH, "lower"), at(DEPTH, "upper")];
    if gap.is_none() && near.is_none() && bounds[0].is_none() {
        return Some("no statements".into());
    }
    let truth = bodies.distance();
    let say = |what: &str, x: f64| Some(format!("{what} {x:e} of {:e}", truth.sqrt_to_f64()));
    if let Some(gap) = gap.filter(|gap| *gap < 0.0 || square(*gap) > truth) {
        return say("a gap of", gap);
    }
    if let Some(near) = near.filter(|near| *near < 0.0 || square(*near) < truth) {
        return say("points within", near);
    }
    let [Some(lower), Some(upper)] = bounds else { return None };
    let few = bodies.points[0].len() + bodies.points[1].len() <= MOST_DEEP;
    let deep = if !truth.is_zero() {
        Ratio::from_f64(0.0)
    } else if few {
        depth(&bodies.points[0], &bodies.points[1], bodies.noise())
    } else {
        return None;
    };
    let say =
        |what: &str, x: f64| Some(format!("a depth {what} {x:e} of {:e}", deep.sqrt_to_f64()));
    if lower < 0.0 || square(lower) > deep {
        return say("of at least", lower);
    }
    if upper < 0.0 || square(upper) < deep {
        return say("of at most", upper);
    }
    // The depth along the direction is part of the statement.
    let n = Vector::new(vector(file.pointer(&format!("{DEPTH}/direction"))?)?);
    let reach = -bodies.along(&n.times(&Dyadic::new(-1.0)));
    let claimed = Dyadic::new(upper);
    let is_short = reach.is_positive() && &reach * &reach > &(&claimed * &claimed) * &n.dot(&n);
    is_short.then(|| format!("{upper:e} along {:?} does not part them", n.to_f64()))
}

fn is_marginal(file: &Value) -> bool {
    marginal(file).unwrap_or(false)
}

fn marginal(file: &Value) -> Option<bool> {
    let bodies = Bodies::read(file)?;
    let mut near = false;
    for at in [format!("{GAP}/normal"), format!("{DEPTH}/direction")] {
        if let Some(normal) = file.pointer(&at).and_then(vector) {
            near |= is_at_limit(normal.length() - 1.0);
        }
    }
    let gap = file.pointer(&format!("{GAP}/gap")).and_then(Value::as_f64);
    near |= gap.is_some_and(|gap| gap <= BAND * bodies.noise());
    if let Some(weights) = file.pointer(&format!("{NEAR}/weights")).and_then(numbers) {
        near |= is_at_limit(weights.iter().sum::<f64>() - 1.0);
    }
    if has(file, DEPTH) {
        let surface = |name: &str| file.pointer(&format!("{DEPTH}/enclosure/{name}"));
        let points = differences(&bodies, surface("pairs")?)?;
        let normals = vectors(surface("normals")?)?;
        for (triangle, normal) in surface("triangles")?.as_array()?.iter().zip(normals) {
            near |= is_at_limit(normal.length() - 1.0);
            for k in indices(triangle)? {
                near |= normal.dot(*points.get(k)?).abs() <= bodies.noise();
            }
        }
    }
    Some(near)
}
