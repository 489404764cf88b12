//! Proofs of clearances and distances of solids.

use colltrans::solid::SolidCast;
use colltrans::{Cast, Pair, ProofFile, Solid};
use glam::DVec3;
use serde_json::Value;

use super::casts::{BAND, HUGE, false_gap, first_of, other_normal, other_weights, put};
use super::file::{Bodies, is_at_limit, numbers, square, vector};
use super::mutants::with;
use super::{CheckerKind, Claim, Kind};
use crate::oracle::exact::{Dyadic, Ratio, Vector};
use crate::oracle::solids::facets::rule;
use crate::oracle::solids::{nearest, settings};
use crate::random::Random;

/// Clearances.
pub const CLEARANCES: Kind = Kind {
    name: "solid-clearances",
    focus: "/statement",
    draw_proof: clearance,
    claims,
    to_limits: worst,
    find_falsehood: falsehood,
    is_marginal,
};

/// Distances.
pub const DISTANCES: Kind = Kind { name: "solid-distances", draw_proof: distance, ..CLEARANCES };

const STOP: &str = "/statement/clearance/stop/translation";
const CERTIFICATE: &str = "/statement/clearance/certificate";
const SEPARATION: &str = "/statement/clearance/separation";
const DISTANCE: &str = "/statement/solid_distance";
const POINTS: &str = "/statement/solid_distance/near/points";

/// Maximum number of facets of both bodies.
const MOST_FACETS: usize = 160;

pub(super) fn of_cubes(seed: u64) -> Option<([Solid; 2], [colltrans::Pose; 2], DVec3)> {
    let families = ["grid", "halves", "sheared", "quarter", "rotated", "mould"];
    let family = families[(seed % 6) as usize];
    let setting = settings::Setting::draw(family, seed / 6)?;
    let made =
        setting.surfaces.each_ref().map(|(points, faces)| Solid::from_mesh(points, faces).ok());
    let [Some(a), Some(b)] = made else { return None };
    let mut poses = setting.poses;
    let random = &mut Random::stream(seed, &[0x501d]);
    if random.one_in(3) {
        let far = setting.direction.normalize() * -(10.0_f64.powf(random.range(0.0, 9.0)));
        let aside = setting.direction.normalize().any_orthonormal_vector() * random.range(0.0, 9.0);
        poses[0] = poses[0].translated_by(far + aside).ok()?;
    }
    if a.triangles().len() + b.triangles().len() > MOST_FACETS {
        return None;
    }
    Some(([a, b], poses, setting.direction))
}

/// Rounds one or both of two solids for every fourth seed.
pub(super) fn sometimes_rounded(solids: [Solid; 2], seed: u64) -> Option<[Solid; 2]> {
    let random = &mut Random::stream(seed, &[0x2ad1]);
    if !random.one_in(4) {
        return Some(solids);
    }
    let [a, b] = solids;
    let mut radius = || if random.one_in(3) { 0.0 } else { 10.0_f64.powf(random.range(-3.0, 0.0)) };
    Some([a.rounded(radius()).ok()?, b.rounded(radius()).ok()?])
}

fn clearance(seed: u64) -> Option<String> {
    let (solids, poses, direction) = of_cubes(seed)?;
    let [a, b] = sometimes_rounded(solids, seed)?;
    let cast = Cast::new(a.at(poses[0]), b.at(poses[1]), direction).ok()?;
    let tolerance = if seed.is_multiple_of(3) { cast.tolerance() } else { 0.0 };
    let options = cast.options().with_tolerance(tolerance);
    let cast = cast.with_options(options).ok()?;
    let proof = ProofFile::of_solids(&cast, [&[&a], &[&b]]).ok()?;
    Some(proof.to_json())
}

fn distance(seed: u64) -> Option<String> {
    let families = ["thin", "hollow", "mixed", "balls"];
    let drawn = nearest::Setting::draw(families[(seed % 4) as usize], seed / 4);
    let (solids, poses) = if let Ok(Some(setting)) = drawn {
        (setting.solids, setting.poses)
    } else {
        let (solids, poses, _) = of_cubes(seed)?;
        (solids, poses)
    };
    let [a, b] = &sometimes_rounded(solids, seed)?;
    if a.triangles().len() + b.triangles().len() > MOST_FACETS {
        return None;
    }
    let pair = Pair::new(a.at(poses[0]), b.at(poses[1])).ok()?;
    let proof = ProofFile::of_solid_distance(&pair, [&[a], &[b]], None).ok()?;
    Some(proof.to_json())
}

fn claims(file: &Value) -> Vec<Claim> {
    let Some(bodies) = Bodies::read(file) else { return Vec::new() };
    let length = bodies.direction.map_or(1.0, DVec3::length);
    let band = 2.0 * BAND * bodies.noise();
    let all = [
        (format!("{STOP}/lower"), -HUGE, HUGE, band / length),
        (format!("{STOP}/upper"), HUGE, -HUGE, band / length),
        (format!("{SEPARATION}/margin"), bodies.min_gap.next_up(), HUGE, band),
        (format!("{CERTIFICATE}/lower"), 0.0, HUGE, band / length),
        (format!("{DISTANCE}/lower"), 0.0, HUGE, band),
        (format!("{POINTS}/distance"), HUGE, 0.0, band),
    ];
    let there = all.into_iter().filter(|(at, ..)| file.pointer(at).is_some_and(Value::is_number));
    there
        .map(|(pointer, weakest, strongest, band)| Claim { pointer, weakest, strongest, band })
        .collect()
}

fn worst(file: &mut Value, random: &mut Random) {
    let toward = file.pointer("/query/cast/direction").and_then(vector).unwrap_or(DVec3::X);
    let normal = format!("{SEPARATION}/normal");
    if let Some(n) = file.pointer(&normal).and_then(vector) {
        let other = other_normal(n, toward, random).to_array();
        *file = with(file, &normal, Some(Value::from(other.to_vec())));
        return;
    }
    if file.pointer(POINTS).is_some() {
        let side = random.index(2);
        match random.index(3) {
            0 => {
                let at = format!("{POINTS}/triangles/{side}");
                *file = with(file, &at, Some(Value::from(random.index(12))));
            }
            1 => put(file, &format!("{POINTS}/distance"), 0.0),
            _ => {
                let at = format!("{POINTS}/weights/{side}");
                *file = with(file, &at, Some(other_weights(3, random)));
            }
        }
        return;
    }
    let value = format!("{STOP}/value");
    if let Some(x) = file.pointer(&value).and_then(Value::as_f64) {
        put(file, &value, super::mutants::other_number(x, random));
    }
}

fn falsehood(file: &Value, who: CheckerKind) -> Option<String> {
    let Some(bodies) = Bodies::read(file) else { return Some("invalid bodies".into()) };
    if file.pointer(DISTANCE).is_some_and(Value::is_object) {
        return false_distance(&bodies, file, who);
    }
    false_clearance(&bodies, file, who)
}

pub(super) fn surface(bodies: &Bodies, body: usize) -> Vec<[Vector; 3]> {
    (0..bodies.facets[body].len()).filter_map(|k| bodies.facet(body, k)).collect()
}

fn false_distance(bodies: &Bodies, file: &Value, who: CheckerKind) -> Option<String> {
    let at = |at: String| file.pointer(&at).and_then(Value::as_f64);
    let truth = nearest::surfaces(&[surface(bodies, 0), surface(bodies, 1)]);
    let say = |what: &str, x: f64| Some(format!("{what} {x:e} of {:e}", truth.sqrt_to_f64()));
    if let Some(near) = at(format!("{POINTS}/distance"))
        && (near < 0.0 || bodies.square_between_cores(near) < truth)
    {
        return say("points within", near);
    }
    let lower = at(format!("{DISTANCE}/lower"))?;
    let is_larger = lower > 0.0 && bodies.square_between_cores(lower) > truth;
    if lower < 0.0 || who == CheckerKind::Library && is_larger {
        return say("a distance of at least", lower);
    }
    None
}

fn false_clearance(bodies: &Bodies, file: &Value, who: CheckerKind) -> Option<String> {
    let at = |at: String| file.pointer(&at).and_then(Value::as_f64);
    let d = bodies.direction?;
    let shrunk = at(format!("{CERTIFICATE}/tolerance")) != Some(0.0);
    // Rounded down, in favour of the claim.
    let radii = bodies.radii.to_f64();
    let of_cores = |margin: f64| if radii == 0.0 { margin } else { (margin + radii).next_down() };
    if let Some(margin) = at(format!("{SEPARATION}/margin"))
        && !shrunk
        && let Some(why) = false_gap(bodies, d, of_cores(margin), 0.0)
    {
        return Some(why);
    }
    let starts_apart = file.pointer(&format!("{CERTIFICATE}/start/apart")).is_some();
    if shrunk {
        return None;
    }
    let core_gap = bodies.min_gap + radii;
    if core_gap > 0.0 {
        let lower = at(format!("{CERTIFICATE}/lower"))
            .unwrap_or(4.0 * (bodies.size + core_gap) / d.length());
        let is_claimed = who == CheckerKind::Library && starts_apart;
        return is_claimed.then(|| nearer_before(bodies, d, lower, core_gap)).flatten();
    }
    let bounds = [at(format!("{STOP}/lower")), at(format!("{STOP}/upper"))];
    let facets = file.pointer("/statement/clearance/stop/facets");
    if let Some(facets) = facets.and_then(super::file::indices)
        && let [f, g] = facets[..]
    {
        let (f, g) = (bodies.facet(0, f)?, bodies.facet(1, g)?);
        let Some(met) = first_of([&f, &g], d) else { return Some("facets that never meet".into()) };
        let zero = Ratio::from_f64(0.0);
        let met = if who == CheckerKind::Library && met < zero { zero } else { met };
        let is_outside = bounds[0].is_some_and(|lower| met < Ratio::from_f64(lower))
            || bounds[1].is_some_and(|upper| met > Ratio::from_f64(upper));
        if is_outside {
            return Some(format!("facets that meet at {:e}, not within {bounds:?}", met.to_f64()));
        }
    }
    if who == CheckerKind::Library && starts_apart {
        let lower = at(format!("{CERTIFICATE}/lower"));
        let truth = rule(&surface(bodies, 0), &surface(bodies, 1), d).stop;
        return match (lower, truth) {
            (None, Some(stop)) => Some(format!("never stopped, and {:e} is", stop.to_f64())),
            (Some(lower), Some(stop)) if stop < Ratio::from_f64(lower) => {
                Some(format!("stopped at {:e}, before {lower:e}", stop.to_f64()))
            }
            _ => None,
        };
    }
    None
}

/// Number of translations at which the distance of the cores is compared with their gap.
const SAMPLES: u32 = 5;
/// Number of noises by which facets may pass each other below the gap, including the errors of this module.
const GRAZE: f64 = 9.0;

/// Returns the reason why solids are nearer than the gap of their cores before a translation; `None` if no sample
/// shows it.
fn nearer_before(bodies: &Bodies, d: DVec3, end: f64, core_gap: f64) -> Option<String> {
    let least = square((core_gap - bodies.noises(GRAZE)).max(0.0));
    let [moving, fixed] = [0, 1].map(|k| surface(bodies, k));
    (0..SAMPLES).find_map(|k| {
        let t = end * f64::from(k) / f64::from(SAMPLES - 1);
        let by = Vector::new(d).times(&Dyadic::new(t));
        let moved = moving.iter().map(|f| f.each_ref().map(|corner| corner.plus(&by))).collect();
        let found = nearest::surfaces(&[moved, fixed.clone()]);
        let text = || format!("cores {:e} apart at {t:e}", found.sqrt_to_f64());
        (found < least).then(text)
    })
}

fn is_marginal(file: &Value) -> bool {
    let unit =
        file.pointer("/query/cast/direction").and_then(vector).map_or(DVec3::X, DVec3::normalize);
    let mut near = false;
    if let Some(normal) = file.pointer(&format!("{SEPARATION}/normal")).and_then(vector) {
        near |= is_at_limit(normal.length() - 1.0) || is_at_limit(normal.dot(unit));
    }
    for side in 0..2 {
        let weights = file.pointer(&format!("{POINTS}/weights/{side}")).and_then(numbers);
        near |= weights.is_some_and(|weights| is_at_limit(weights.iter().sum::<f64>() - 1.0));
    }
    near
}
