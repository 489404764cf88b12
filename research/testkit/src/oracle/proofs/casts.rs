//! Proofs of contacts, slides and separations of convex bodies, with and without a minimum gap.

use colltrans::{Cast, ContactRange, ConvexPolyhedron, ProofFile};
use glam::DVec3;
use serde_json::Value;

use super::file::{Bodies, differences, is_at_limit, numbers, scene, square, vector};
use super::mutants::{number, with};
use super::{CheckerKind, Claim, Kind};
use crate::oracle::exact::Ratio;
use crate::oracle::scene::size;
use crate::oracle::settings::{Bodies as Convex, FAMILIES, Setting, near_contact, setting};
use crate::oracle::shadow::SignedDistance;
use crate::random::Random;

/// Casts of bodies that may touch.
pub const CASTS: Kind = Kind {
    name: "casts",
    focus: "/statement",
    draw_proof: |seed| cast(seed, false),
    claims,
    to_limits: worst,
    find_falsehood: falsehood,
    is_marginal,
};

/// Casts with a minimum gap.
pub const WITH_GAP: Kind =
    Kind { name: "casts-with-gap", draw_proof: |seed| cast(seed, true), ..CASTS };

/// Maximum number of vertices of both bodies.
const MOST_VERTICES: usize = 40;

/// A number larger than all claims.
pub(super) const HUGE: f64 = 1e300;

/// Number of noises by which the library may reject a true claim.
pub(super) const BAND: f64 = 8.0;

/// Draws a setting with few vertices, and its bodies. The moving body is as drawn, far behind, next to the
/// fixed one, or near contact.
pub(super) fn drawn(seed: u64) -> Option<(Setting, Convex)> {
    let count = FAMILIES.len() as u64;
    let family = FAMILIES[(seed % count) as usize].0;
    let mut setting = setting(family, seed / count);
    let mut bodies = setting.bodies().ok()?;
    let random = &mut Random::stream(seed, &[0xd0a1]);
    if random.one_in(3) {
        setting.moving = rounded_cloud(&bodies.moving, random);
        bodies = setting.bodies().ok()?;
    }
    let vertices = bodies.moving.vertices().len() + bodies.fixed.vertices().len();
    if vertices > MOST_VERTICES {
        return None;
    }
    let size = setting.judge(&bodies).scene.size;
    let unit = setting.direction.normalize();
    let across = unit.any_orthonormal_vector();
    let by = match random.index(6) {
        0 => unit * -size * 10.0_f64.powf(random.range(0.0, 9.0)),
        1 => across * size * random.range(0.2, 1.0),
        2 => across * size + unit * -size * 10.0_f64.powf(random.range(0.0, 9.0)),
        3 => {
            if let Some(near) = near_contact(&setting, &bodies, random) {
                setting.moving_pose = near;
            }
            DVec3::ZERO
        }
        _ => DVec3::ZERO,
    };
    setting.moving_pose = setting.moving_pose.translated_by(by).ok()?;
    if random.one_in(4) {
        beside(&mut setting, &bodies, random);
    }
    Some((setting, bodies))
}

/// Returns the vertices of a body, rotated, and points of its faces. Because of rounding some points are
/// outside of the hull that the library stores.
pub(super) fn rounded_cloud(body: &ConvexPolyhedron, random: &mut Random) -> Vec<DVec3> {
    let turn = random.rotation();
    let vertices = body.vertices();
    let mut points = vertices.to_vec();
    for face in 0..body.face_count() as u32 {
        let corners: Vec<DVec3> = body.face_vertices(face).map(|v| vertices[v as usize]).collect();
        for _ in 0..4 {
            let weights: Vec<f64> = corners.iter().map(|_| random.range(0.0, 1.0)).collect();
            let sum: f64 = weights.iter().sum();
            points.push(corners.iter().zip(&weights).map(|(v, w)| *v * (w / sum)).sum());
        }
    }
    points.iter().map(|v| turn * *v).collect()
}

/// Moves the moving body laterally until the shadows are almost a small distance apart.
fn beside(setting: &mut Setting, bodies: &Convex, random: &mut Random) -> Option<()> {
    let overlap = setting.judge(bodies).scene;
    let overlap = crate::oracle::shadow::sideways_overlap(&overlap).to_f64();
    let unit = setting.direction.normalize();
    let across = random.direction().reject_from(unit).try_normalize()?;
    let little = 10.0_f64.powf(-random.range(0.0, 16.0)) * overlap.abs();
    let cast = setting.query(bodies).ok()?;
    let ContactRange::Separated(separated) = cast.contact_range().ok()? else {
        setting.moving_pose = setting.moving_pose.translated_by(across * overlap).ok()?;
        return Some(());
    };
    let toward = separated.certificate.normal * (separated.certificate.margin - little);
    setting.moving_pose = setting.moving_pose.translated_by(toward).ok()?;
    Some(())
}

fn cast(seed: u64, with_gap: bool) -> Option<String> {
    let (setting, bodies) = drawn(seed)?;
    let mut cast = setting.query(&bodies).ok()?;
    if with_gap {
        cast = cast.with_min_gap(gap(&cast, &mut Random::stream(seed, &[0x6a9]))).ok()?;
    }
    if seed.is_multiple_of(5) && !with_gap {
        let clearance = cast.clearance().ok()?;
        return Some(ProofFile::of_clearance(&cast, &clearance).to_json());
    }
    Some(ProofFile::of_range(&cast, &cast.contact_range().ok()?).to_json())
}

/// Draws a gap of some noises, or of any size relative to the bodies.
fn gap(cast: &Cast, random: &mut Random) -> f64 {
    let poses = [&cast.moving_pose(), &cast.fixed_pose()];
    let size = size([cast.moving().vertices(), cast.fixed().vertices()], poses);
    if random.one_in(3) {
        16.0 * f64::EPSILON * size * random.range(0.0, 20.0)
    } else {
        size * 10.0_f64.powf(random.range(-12.0, 1.0))
    }
}

/// A statement of a cast, with its pointer.
enum Part {
    Contact { at: String, reversed: bool },
    Slide(String),
    Separation(String),
}

fn parts(file: &Value) -> Vec<Part> {
    let mut found = Vec::new();
    for (name, reversed) in [("first", false), ("last", true)] {
        let at = format!("/statement/contacts/{name}");
        if file.pointer(&at).is_some_and(Value::is_object) {
            found.push(Part::Contact { at, reversed });
        }
    }
    let slide = "/statement/contacts/slide".to_owned();
    if file.pointer(&slide).is_some_and(Value::is_object) {
        found.push(Part::Slide(slide));
    }
    let separation = "/statement/separation".to_owned();
    if file.pointer(&separation).is_some_and(Value::is_object) {
        found.push(Part::Separation(separation));
    }
    found
}

fn claims(file: &Value) -> Vec<Claim> {
    let Some(bodies) = Bodies::read(file) else { return Vec::new() };
    let Some(d) = bodies.direction else { return Vec::new() };
    let band = BAND * bodies.noise();
    let mut claims = Vec::new();
    let mut claim = |pointer: String, weakest: f64, strongest: f64, band: f64| {
        claims.push(Claim { pointer, weakest, strongest, band });
    };
    for part in parts(file) {
        match part {
            Part::Contact { at, reversed } => {
                let normal = file.pointer(&format!("{at}/normal")).and_then(vector);
                let along = normal.unwrap_or(DVec3::ZERO).dot(if reversed { -d } else { d });
                let band = band / along.abs().max(f64::MIN_POSITIVE);
                claim(format!("{at}/lower"), -HUGE, HUGE, band);
                if file.pointer(&format!("{at}/upper")).is_some_and(Value::is_number) {
                    claim(format!("{at}/upper"), HUGE, -HUGE, band);
                }
                claim(format!("{at}/rounding"), 0.0, HUGE, band);
            }
            Part::Slide(at) => claim(format!("{at}/overlap"), HUGE, -HUGE, band),
            Part::Separation(at) => {
                claim(format!("{at}/margin"), bodies.min_gap.next_up(), HUGE, band);
            }
        }
    }
    claims
}

/// Draws a number, mostly small relative to 1.
pub(super) fn some_little(random: &mut Random) -> f64 {
    let sign = if random.one_in(2) { 1.0 } else { -1.0 };
    match random.index(3) {
        0 => sign * 0.5 * f64::EPSILON * random.range(0.0, 40.0),
        1 => sign * 0.5 * f64::EPSILON * random.pick(&[31.0, 32.0, 33.0, 35.0, 36.0, 37.0]),
        _ => sign * 10.0_f64.powf(-random.range(0.0, 17.0)),
    }
}

/// Draws a different normal: tilted, along or across the direction, longer or shorter.
pub(super) fn other_normal(n: DVec3, d: DVec3, random: &mut Random) -> DVec3 {
    let unit = d.normalize_or(DVec3::X);
    let little = some_little(random);
    match random.index(6) {
        0 => n + unit * little,
        1 => (n + unit * little).normalize_or(n),
        2 => (n + random.direction() * little).normalize_or(n),
        3 => n * (1.0 + little),
        4 => (n - unit * n.dot(unit)).normalize_or(n) + unit * little.abs(),
        _ => random.direction(),
    }
}

/// Draws different weights of a mean.
pub(super) fn other_weights(count: usize, random: &mut Random) -> Value {
    let mut weights: Vec<f64> = (0..count).map(|_| random.range(0.0, 1.0)).collect();
    let sum: f64 = weights.iter().sum();
    for w in &mut weights {
        *w /= sum;
    }
    if random.one_in(2) {
        weights = vec![0.0; count];
        weights[random.index(count)] = 1.0;
    }
    let k = random.index(count);
    match random.index(4) {
        0 => weights[k] += some_little(random),
        1 => weights[k] = -f64::from_bits(1),
        _ => {}
    }
    Value::from(weights)
}

/// Replaces a pair of vertices of a list.
pub(super) fn other_pair(file: &mut Value, at: &str, random: &mut Random) {
    let Some(bodies) = Bodies::read(file) else { return };
    let count = file.pointer(at).and_then(Value::as_array).map_or(0, Vec::len);
    if count == 0 {
        return;
    }
    let end = if random.one_in(2) { "moving" } else { "fixed" };
    let most = bodies.points[usize::from(end == "fixed")].len();
    let at = format!("{at}/{}/{end}", random.index(count));
    *file = with(file, &at, Some(Value::from(random.index(most))));
}

fn worst(file: &mut Value, random: &mut Random) {
    let Some(d) = file.pointer("/query/cast/direction").and_then(vector) else { return };
    let parts = parts(file);
    if parts.is_empty() {
        return;
    }
    let (at, is_contact) = match &parts[random.index(parts.len())] {
        Part::Contact { at, .. } => (at.clone(), true),
        Part::Slide(at) | Part::Separation(at) => (at.clone(), false),
    };
    match random.index(if is_contact { 5 } else { 3 }) {
        3 => {
            *file = with(file, &format!("{at}/weights"), Some(other_weights(3, random)));
        }
        4 => other_pair(file, &format!("{at}/pairs"), random),
        _ => {
            let at = format!("{at}/normal");
            let Some(normal) = file.pointer(&at).and_then(vector) else { return };
            let other = other_normal(normal, d, random).to_array();
            *file = with(file, &at, Some(Value::from(other.to_vec())));
        }
    }
}

fn falsehood(file: &Value, who: CheckerKind) -> Option<String> {
    let Some(bodies) = Bodies::read(file) else { return Some("invalid bodies".into()) };
    let Some(d) = bodies.direction else { return Some("missing direction".into()) };
    let parts = parts(file);
    if parts.is_empty() {
        return Some("no statements".into());
    }
    parts.iter().find_map(|part| match part {
        Part::Contact { at, reversed } => {
            let d = if *reversed { -d } else { d };
            false_contact(&bodies, d, file.pointer(at)?).map(|why| format!("{at}: {why}"))
        }
        Part::Slide(at) => {
            let overlap = file.pointer(&format!("{at}/overlap"))?.as_f64()?;
            false_gap(&bodies, d, bodies.min_gap, overlap)
        }
        Part::Separation(at) => {
            let margin = file.pointer(&format!("{at}/margin"))?.as_f64()?;
            let is_less = margin <= bodies.min_gap;
            let less = || is_less.then(|| format!("a margin of {margin:e}"));
            let _ = who;
            false_gap(&bodies, d, margin, 0.0).or_else(less)
        }
    })
}

/// Returns the reason why the shadows are not `gap - overlap` apart; `None` if they are.
pub(super) fn false_gap(bodies: &Bodies, d: DVec3, gap: f64, overlap: f64) -> Option<String> {
    let truth = bodies.overlap_of_shadows(d);
    // Rounded up, in favour of the claim.
    let most = if gap == 0.0 {
        overlap
    } else if overlap == 0.0 {
        -gap
    } else {
        (overlap - gap).next_up()
    };
    truth.exceeds(most).then(|| {
        let SignedDistance { .. } = truth;
        format!("shadows that overlap by {:e}, not {most:e}", truth.to_f64())
    })
}

fn false_contact(bodies: &Bodies, d: DVec3, claim: &Value) -> Option<String> {
    let lower = claim.get("lower")?.as_f64()?;
    let min_gap = bodies.min_gap;
    if min_gap == 0.0 {
        if let Some(first) = bodies.first(d)
            && first < Ratio::from_f64(lower)
        {
            return Some(format!("they meet at {:e}, before {lower:e}", first.to_f64()));
        }
    } else if bodies.least_distance_until(d, lower) < square(min_gap) {
        return Some(format!("they are nearer than {min_gap:e} before {lower:e}"));
    }
    let near = |count: f64| min_gap.max(bodies.noises(count));
    match claim.get("upper")?.as_f64() {
        None if min_gap == 0.0 => {
            let overlap = bodies.overlap_of_shadows(d);
            let apart = overlap.to_f64();
            (apart < -bodies.noises(46.0)).then(|| format!("shadows that are {apart:e} apart"))
        }
        None => None,
        Some(upper) if min_gap > 8.02 * bodies.noise() => {
            let found = bodies.distance_at(d, upper);
            let far = found > square(min_gap);
            far.then(|| format!("they are {:e} apart at {upper:e}", found.sqrt_to_f64()))
        }
        Some(upper) => {
            let found = bodies.least_distance_until(d, upper);
            let far = found > square(near(3.25));
            far.then(|| format!("they are {:e} apart until {upper:e}", found.sqrt_to_f64()))
        }
    }
}

fn is_marginal(file: &Value) -> bool {
    marginal(file).unwrap_or(false)
}

fn marginal(file: &Value) -> Option<bool> {
    let bodies = Bodies::read(file)?;
    let (d, noise) = (bodies.direction?, bodies.noise());
    let unit = d.normalize_or(DVec3::X);
    let gap = bodies.min_gap / noise;
    let mut near = (7.9..8.1).contains(&gap);
    for part in parts(file) {
        let (at, across) = match &part {
            Part::Contact { at, .. } => (at, false),
            Part::Slide(at) | Part::Separation(at) => (at, true),
        };
        let normal = vector(file.pointer(&format!("{at}/normal"))?)?;
        near |= is_at_limit(normal.length() - 1.0);
        near |= across && is_at_limit(normal.dot(unit));
        // The claim must exceed the gap, and may be smaller than the library requires.
        let margin = file.pointer(&format!("{at}/margin")).and_then(Value::as_f64);
        near |= margin.is_some_and(|margin| margin - bodies.min_gap <= BAND * noise);
        if across {
            continue;
        }
        near |= normal.dot(unit).abs() < 1e-200;
        let weights = numbers(file.pointer(&format!("{at}/weights"))?)?;
        let sum: f64 = weights.iter().sum();
        near |= is_at_limit(sum - 1.0);
        let corners = differences(&bodies, file.pointer(&format!("{at}/pairs"))?)?;
        let mean: DVec3 = corners.iter().zip(&weights).map(|(m, w)| *m * (*w / sum)).sum();
        let off = mean.reject_from(unit).length() / noise;
        near |= (2.5..3.75).contains(&off) || (43.0..47.0).contains(&off);
        if let Some(upper) = file.pointer(&format!("{at}/upper"))?.as_f64() {
            near |= ((mean - d * upper).length() - bodies.min_gap).abs() <= noise;
        }
    }
    Some(near)
}

/// Returns the first translation at which two facets meet; `None` if there is none.
pub(super) fn first_of(facets: [&[crate::oracle::exact::Vector]; 2], d: DVec3) -> Option<Ratio> {
    crate::oracle::simplex::collision_translation(&scene(facets, d))
}

/// Replaces a number.
pub(super) fn put(file: &mut Value, at: &str, x: f64) {
    *file = with(file, at, Some(number(x)));
}
