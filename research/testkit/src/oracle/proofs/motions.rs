//! Proofs of motions of convex bodies and of solids.
//!
//! The truth is evaluated at some times, with the motion as a real function of its numbers. A file that claims
//! that bodies are disjoint up to a time is false if they are not disjoint at one of these times.

use colltrans::motion::{Motion, MotionCast};
use colltrans::{ConvexPolyhedron, Pose, ProofFile, Solid};
use glam::{DMat3, DVec3};
use serde_json::{Value, json};

use super::casts::{other_normal, other_pair, other_weights, rounded_cloud};
use super::checkers::{Verdict, verify};
use super::file::{body_at, indices, is_at_limit, numbers, radius_of_solid, vector, vectors};
use super::mutants::{number, with};
use super::solids::sometimes_rounded;
use super::{CheckerKind, Claim, Kind};
use crate::oracle::distance::distance;
use crate::oracle::exact::{Ratio, Vector};
use crate::oracle::motion::{Spin, points_at};
use crate::oracle::nearest::depth;
use crate::random::Random;
use crate::shapes::random_hull;

/// Motions of convex bodies, with a minimum gap, a tolerated depth, or neither.
pub const CONVEX: Kind = Kind {
    name: "motions",
    focus: CONVEX_PROOF,
    draw_proof: base,
    claims,
    to_limits: worst,
    find_falsehood: falsehood,
    is_marginal,
};

/// Motions of solids.
pub const SOLIDS: Kind = Kind {
    name: "solid-motions",
    focus: SOLID_PROOF,
    draw_proof: solid_base,
    claims: solid_claims,
    to_limits: solid_worst,
    find_falsehood: solid_falsehood,
    is_marginal,
};

/// The pointer to the proof of a pair of convex bodies.
const CONVEX_PROOF: &str = "/statement/motions/0/convex";

/// The pointer to the proof of a pair of solids.
const SOLID_PROOF: &str = "/statement/motions/0/solids/proof";

/// Number of times at which bodies are checked, in addition to those of the proof.
const TIMES: usize = 6;

/// Maximum number of times of the proof that are checked.
const MOST_TIMES: usize = 6;

/// Relative tolerance for the rounding of the judge.
const OWN: f64 = 1e-25;

/// Draws a body of a few vertices. One in three omits some of its input points.
pub(super) fn body(random: &mut Random) -> ConvexPolyhedron {
    let body = plain_body(random);
    if random.one_in(3) {
        let cloud = rounded_cloud(&body, random);
        return ConvexPolyhedron::from_points(&cloud).expect("a body");
    }
    body
}

fn plain_body(random: &mut Random) -> ConvexPolyhedron {
    let size = random.pick(&[0.3, 1.0, 1.0]);
    let points = if random.one_in(2) {
        let half = DVec3::new(1.0, random.range(0.1, 1.0), random.range(0.1, 1.0)) * (0.5 * size);
        return ConvexPolyhedron::cuboid(-half, half).expect("a box");
    } else {
        let count = random.pick(&[4, 6]);
        random_hull(count, random).vertices
    };
    let points: Vec<DVec3> = points.into_iter().map(|v| v * size).collect();
    ConvexPolyhedron::from_points(&points).expect("a body")
}

/// Draws the motion of the moving body, which passes the other one, and that of the other one.
fn motions(random: &mut Random) -> Option<[Motion; 2]> {
    let around =
        |random: &mut Random, far: f64| Pose::new(random.rotation(), random.direction() * far).ok();
    let far = random.range(0.7, 2.5);
    let start = around(random, far)?;
    let there = if random.one_in(2) { Pose::IDENTITY } else { around(random, 0.2)? };
    let axis = random.direction();
    let angle = random.range(-1.0, 1.0) * random.pick(&[1e-6, 1.0, 3.0, 20.0]);
    let way = -start.translation() * random.range(0.0, 2.0);
    let point = random.vector();
    let moving = match random.index(5) {
        0 => Motion::translation(start, way),
        1 => Motion::rotation_about(start, point, axis, angle),
        2 => Motion::free_flight(start, start.translation(), way, axis * angle),
        3 => Motion::through_poses(&[start, around(random, 1.0)?, around(random, far)?]),
        _ => Motion::from_arm_and_axis(start, start.translation() - point, axis, angle, way),
    };
    let fixed = match random.index(4) {
        0 => Motion::rotation_about(
            there,
            random.vector() * 0.3,
            random.direction(),
            random.range(-2.0, 2.0),
        ),
        // Both rotate as one.
        1 => {
            Motion::from_arm_and_axis(there, there.translation() - point, axis, angle, DVec3::ZERO)
        }
        _ => Ok(Motion::at_rest(there)),
    };
    Some([moving.ok()?, fixed.ok()?])
}

fn base(seed: u64) -> Option<String> {
    let random = &mut Random::stream(seed, &[0x0710_7104]);
    let (p, q) = (body(random), body(random));
    let [a, b] = motions(random)?;
    let cast = MotionCast::new(p.with_motion(&a), q.with_motion(&b)).ok()?;
    let length = 10.0_f64.powf(random.range(-6.0, -0.5));
    let cast = match random.index(4) {
        0 => cast.with_min_gap(length),
        1 => cast.with_tolerance(length),
        _ => Ok(cast),
    };
    let cast = cast.ok()?;
    let outcome = cast.first_contact().ok()?;
    (outcome.proof().spans.iter().map(Vec::len).sum::<usize>() < 40)
        .then(|| ProofFile::of_motion(&cast, &outcome).to_json())
}

fn solid_base(seed: u64) -> Option<String> {
    let random = &mut Random::stream(seed, &[0x501d_7104]);
    let mut solid = || {
        let one = body(random);
        if random.one_in(2) {
            return Solid::from_convex(&one).ok();
        }
        // Two pieces, whose union is not convex.
        let by = Pose::from_translation(DVec3::X * 1.5).ok()?;
        let moved: Vec<DVec3> = one.vertices().iter().map(|v| by.transform_point(*v)).collect();
        Solid::from_pieces([&one, &ConvexPolyhedron::from_points(&moved).ok()?]).ok()
    };
    let [p, q] = sometimes_rounded([solid()?, solid()?], seed)?;
    let [a, b] = motions(random)?;
    let mut cast = MotionCast::<Solid>::new(p.with_motion(&a), q.with_motion(&b)).ok()?;
    if random.one_in(4) {
        cast = cast.with_min_gap(10.0_f64.powf(random.range(-4.0, -1.0))).ok()?;
    }
    match random.index(3) {
        0 => cast = cast.with_tolerance(1e-3).ok()?,
        1 => cast = cast.with_tolerance(0.0).ok()?,
        _ => {}
    }
    let text = ProofFile::with_solid_motion(&cast).ok()?.1.to_json();
    (text.len() < 15_000).then_some(text)
}

/// Returns the pointer to the last plane of a proof.
fn last_plane(file: &Value) -> Option<String> {
    let spans = file.pointer(&format!("{CONVEX_PROOF}/spans"))?.as_array()?;
    let planes = spans.last()?.as_array()?;
    let last = planes.len().checked_sub(1)?;
    Some(format!("{CONVEX_PROOF}/spans/{}/{last}", spans.len() - 1))
}

fn claims(file: &Value) -> Vec<Claim> {
    let mut found = Vec::new();
    let mut claim = |pointer: String, strongest: f64, band: f64| {
        if let Some(weakest) = file.pointer(&pointer).and_then(Value::as_f64) {
            found.push(Claim { pointer, weakest, strongest, band });
        }
    };
    if let Some(last) = last_plane(file) {
        claim(format!("{last}/time"), 1.0, 1e-9);
        claim(format!("{last}/gap"), 1e300, 1e-9);
    }
    claim(format!("{CONVEX_PROOF}/meeting/time"), 0.0, 1e-9);
    claim(format!("{CONVEX_PROOF}/meeting/met/deep/lower"), 1e300, 1e-9);
    claim(format!("{CONVEX_PROOF}/meeting/met/deep/upper"), 0.0, 1e-9);
    claim(format!("{CONVEX_PROOF}/meeting/met/near/distance"), 0.0, 1e-9);
    found
}

fn solid_claims(file: &Value) -> Vec<Claim> {
    let last =
        file.pointer(&format!("{SOLID_PROOF}/spans")).and_then(Value::as_array).map_or(0, Vec::len);
    let until = format!("{SOLID_PROOF}/spans/{}/until", last.wrapping_sub(1));
    let places = [(until, 1.0), (format!("{SOLID_PROOF}/meeting/time"), 0.0)];
    let value = |at: &str| file.pointer(at).and_then(Value::as_f64);
    let claim = |(pointer, strongest): (String, f64)| {
        let weakest = value(&pointer)?;
        Some(Claim { pointer, weakest, strongest, band: 1e-9 })
    };
    places.into_iter().filter_map(claim).collect()
}

/// Returns the pointers to all planes of a file.
fn planes(file: &Value) -> Vec<String> {
    let all = super::mutants::pointers(file);
    all.iter().filter_map(|at| at.strip_suffix("/alone")).map(ToOwned::to_owned).collect()
}

fn worst(file: &mut Value, random: &mut Random) {
    let planes = planes(file);
    if planes.is_empty() {
        return;
    }
    let at = planes[random.index(planes.len())].clone();
    let place = |name: &str| format!("{at}/{name}");
    match random.index(9) {
        0 | 1 => {
            let Some(normal) = file.pointer(&place("normal")).and_then(vector) else { return };
            let other = other_normal(normal, random.direction(), random).to_array();
            *file = with(file, &place("normal"), Some(Value::from(other.to_vec())));
        }
        2 => {
            let old = file.pointer(&place("alone")).and_then(Value::as_bool).unwrap_or(false);
            *file = with(file, &place("alone"), Some(Value::from(!old)));
        }
        3 => *file = with(file, &at, None),
        4 => {
            let gap = file.pointer(&place("gap")).and_then(Value::as_f64).unwrap_or(0.0);
            let gap = gap * random.pick(&[0.5, 1.0 - 1e-12, 1.0 + 1e-12, 2.0]);
            *file = with(file, &place("gap"), Some(number(gap)));
        }
        5 => {
            // Removes the planes from here on, so that later times are not proven.
            let Some((list, k)) = at.rsplit_once('/') else { return };
            let k = k.parse().unwrap_or(0);
            if let Some(list) = file.pointer_mut(list).and_then(Value::as_array_mut) {
                list.truncate(k);
            }
        }
        6 => *file = with(file, &format!("{CONVEX_PROOF}/meeting"), Some(Value::Null)),
        7 => met(file, &format!("{CONVEX_PROOF}/meeting/met"), random),
        _ => {
            let time = file.pointer(&place("time")).and_then(Value::as_f64).unwrap_or(0.0);
            let time = time + random.range(-0.1, 0.1) * random.pick(&[1.0, 1e-3, 1e-9]);
            *file = with(file, &place("time"), Some(number(time)));
        }
    }
}

/// Worsens the proof of a meeting.
pub(super) fn met(file: &mut Value, at: &str, random: &mut Random) {
    if random.one_in(8) {
        // An overlap by at least zero, which is true for any two bodies.
        let enclosure = json!({"pairs": [], "triangles": [], "normals": []});
        let direction = random.direction().to_array();
        let deep =
            json!({"lower": 0.0, "upper": 0.0, "direction": direction, "enclosure": enclosure});
        *file = with(file, at, Some(json!({"deep": deep})));
        return;
    }
    if file.pointer(&format!("{at}/near")).is_some() {
        if random.one_in(2) {
            other_pair(file, &format!("{at}/near/pairs"), random);
        } else {
            *file = with(file, &format!("{at}/near/weights"), Some(other_weights(4, random)));
        }
        return;
    }
    let surface = format!("{at}/deep/enclosure");
    let count = |name: &str| {
        file.pointer(&format!("{surface}/{name}")).and_then(Value::as_array).map_or(0, Vec::len)
    };
    let (pairs, triangles) = (count("pairs"), count("triangles"));
    if pairs == 0 || triangles == 0 {
        return;
    }
    let k = random.index(triangles);
    match random.index(3) {
        0 => other_pair(file, &format!("{surface}/pairs"), random),
        1 => {
            for list in ["triangles", "normals"] {
                *file = with(file, &format!("{surface}/{list}/{k}"), None);
            }
        }
        _ => {
            let place = format!("{surface}/normals/{k}");
            let Some(normal) = file.pointer(&place).and_then(vector) else { return };
            let other = other_normal(normal, random.direction(), random).to_array();
            *file = with(file, &place, Some(Value::from(other.to_vec())));
        }
    }
}

fn solid_worst(file: &mut Value, random: &mut Random) {
    match random.index(7) {
        0 | 1 => {
            let spans = file
                .pointer(&format!("{SOLID_PROOF}/spans"))
                .and_then(Value::as_array)
                .map_or(0, Vec::len);
            let place = format!("{SOLID_PROOF}/spans/{}/cover", random.index(spans.max(1)));
            let Some(cover) = file.pointer(&place).and_then(Value::as_str) else { return };
            let mut letters: Vec<u8> = cover.bytes().collect();
            if letters.is_empty() {
                return;
            }
            let k = random.index(letters.len());
            if random.one_in(3) {
                letters.remove(k);
            } else {
                letters[k] = random.pick(b"TPQLmabcxyzpq123456789");
            }
            let cover = String::from_utf8(letters).unwrap_or_default();
            *file = with(file, &place, Some(Value::from(cover)));
        }
        2 => {
            let side = random.index(2);
            let corners = format!("/statement/motions/0/solids/parts/{side}/corners");
            let count = file.pointer(&corners).and_then(Value::as_array).map_or(1, Vec::len);
            let place = format!("{corners}/{}/{}", random.index(count), random.index(3));
            let Some(v) = file.pointer(&place).and_then(vector) else { return };
            let v = v + random.vector() * random.pick(&[1e-12, 1e-3, 1.0]);
            *file = with(file, &place, Some(Value::from(v.to_array().to_vec())));
        }
        3 => *file = with(file, &format!("{SOLID_PROOF}/meeting"), Some(Value::Null)),
        4 => {
            let edge = random.index(4);
            let place = format!("{SOLID_PROOF}/meeting/met/crossing/edge");
            *file = with(file, &place, Some(Value::from(edge)));
        }
        5 => {
            let place = format!("{SOLID_PROOF}/meeting/triangles/{}", random.index(2));
            *file = with(file, &place, Some(Value::from(random.index(24))));
        }
        _ => worst(file, random),
    }
}

/// The motion of a body in a file.
struct Moves(Vec<(f64, Spin)>);

impl Moves {
    fn read(pieces: &Value) -> Option<Self> {
        let piece = |of: &Value| {
            let start = pose(of.get("start")?)?;
            let spin = Spin {
                start,
                arm: vector(of.get("arm")?)?,
                axis: vector(of.get("axis")?)?,
                angle: of.get("rate")?.as_f64()?,
                way: vector(of.get("velocity")?)?,
            };
            Some((of.get("since")?.as_f64()?, spin))
        };
        Some(Self(pieces.as_array()?.iter().map(piece).collect::<Option<_>>()?))
    }

    /// Returns points at a time. At the transition between two pieces of the motion, `ends` selects the earlier
    /// one.
    fn at(&self, points: &[DVec3], time: f64, ends: bool) -> Vec<Vector> {
        let begun = |since: &f64| if ends { *since < time } else { *since <= time };
        let all = self.0.iter().rev();
        let (since, spin) =
            all.clone().find(|(since, _)| begun(since)).or(self.0.first()).expect("pieces");
        points_at(points, spin, *since, time)
    }
}

/// Reads a pose.
pub(super) fn pose(of: &Value) -> Option<Pose> {
    let entries: [f64; 9] = numbers(of.get("matrix")?)?.try_into().ok()?;
    Pose::from_matrix(DMat3::from_cols_array(&entries), vector(of.get("translation")?)?).ok()
}

/// Checks whether convex bodies meet, are nearer than a gap, or overlap deeper than tolerated. A negative `by`
/// weakens the condition slightly, a positive one strengthens it.
pub(super) fn meets(points: [&[Vector]; 2], min_gap: f64, by: f64) -> bool {
    let square = distance(points[0], points[1]).square;
    if min_gap < 0.0 {
        let least = -min_gap * (1.0 + by * OWN.max(2.0 * f64::EPSILON));
        return square.is_zero() && depth(points[0], points[1], 1e-12) > squared(least);
    }
    let most = (min_gap + by * -1e-30) * (1.0 - by * 2.0 * f64::EPSILON);
    square < squared(most.max(0.0)) || square.is_zero()
}

fn squared(x: f64) -> Ratio {
    Ratio::from_f64(x).times(&Ratio::from_f64(x))
}

/// Returns the times to check before `until`, including times between those of the proof.
fn times(named: &[f64], until: f64) -> Vec<f64> {
    let evenly = (0..TIMES).map(|k| until * (k as f64 + 0.37) / TIMES as f64);
    let mut between: Vec<f64> = named.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    let stride = between.len().div_ceil(MOST_TIMES).max(1);
    between = between.into_iter().rev().step_by(stride).collect();
    let all = evenly.chain(between).chain([0.0, until.next_down()]);
    all.filter(|time| (0.0..until).contains(time)).collect()
}

fn falsehood(file: &Value, who: CheckerKind) -> Option<String> {
    first(found(file, who))
}

/// Returns the first false statement, or that the file is invalid.
pub(super) fn first(found: Option<Vec<String>>) -> Option<String> {
    found.map_or_else(|| Some("invalid file".into()), |all| all.into_iter().next())
}

/// Returns the false statements; `None` if the file is invalid.
fn found(file: &Value, _: CheckerKind) -> Option<Vec<String>> {
    let min_gap = file.pointer("/query/motions/0/min_gap").map_or(Some(0.0), Value::as_f64)?;
    let movers = file.pointer("/placement/motions/0")?;
    let body = |k: usize| vectors(body_at(file, &movers[k])?.pointer("/convex/vertices")?);
    let bodies = [body(0)?, body(1)?];
    let moves = [Moves::read(&movers[0]["motion"])?, Moves::read(&movers[1]["motion"])?];
    let points = |time: f64, ends: bool| [0, 1].map(|k| moves[k].at(&bodies[k], time, ends));
    let named: Vec<f64> = planes(file)
        .iter()
        .map(|at| file.pointer(&format!("{at}/time")).and_then(Value::as_f64))
        .collect::<Option<_>>()?;
    let reached = named.last().copied().unwrap_or(0.0);
    let mut all: Vec<(f64, bool)> =
        times(&named, reached).into_iter().map(|t| (t, false)).collect();
    if reached == 1.0 {
        all.push((1.0, true));
    }
    for (time, ends) in all {
        let at = points(time, ends);
        if meets([&at[0], &at[1]], min_gap, 1.0) {
            return Some(vec![format!("they meet at {time}, before {reached}")]);
        }
    }
    let meeting = file.pointer(&format!("{CONVEX_PROOF}/meeting"))?;
    if meeting.is_null() {
        return Some(Vec::new());
    }
    let time = meeting.get("time")?.as_f64()?;
    // A meeting is in the last span.
    let ends = [true, false].map(|ends| {
        let at = points(time, ends);
        (meets([&at[0], &at[1]], min_gap, -1.0), at)
    });
    let Some((_, at)) = ends.iter().find(|(meets, _)| *meets) else {
        return Some(vec![format!("they do not meet at {time}")]);
    };
    let size = bodies.iter().flatten().map(|v| v.length()).fold(1.0, f64::max);
    let far = moves
        .iter()
        .flat_map(|of| &of.0)
        .map(|(_, spin)| spin.arm.length() + spin.way.length() + spin.start.translation().length());
    let room = 2e-13 * (size + far.fold(0.0, f64::max));
    Some(depth_is_false(meeting.get("met")?, [&at[0], &at[1]], room).into_iter().collect())
}

/// Returns the reason why a depth or distance is false beyond rounding; `None` if it is true.
pub(super) fn depth_is_false(met: &Value, at: [&[Vector]; 2], room: f64) -> Option<String> {
    if let Some(near) = met.get("near").and_then(|near| near.get("distance")?.as_f64()) {
        let square = distance(at[0], at[1]).square;
        return (near < 0.0 || square > squared(near + room))
            .then(|| format!("they are not within {near:e}"));
    }
    let of = met.get("deep")?;
    let [lower, upper] = ["lower", "upper"].map(|name| of.get(name).and_then(Value::as_f64));
    let (lower, upper) = (lower?, upper?);
    let deep = depth(at[0], at[1], 1e-12);
    let is_false = (lower > room && squared(lower - room) > deep) || squared(upper + room) < deep;
    is_false.then(|| format!("a depth between {lower:e} and {upper:e} of {:e}", deep.sqrt_to_f64()))
}

fn solid_falsehood(file: &Value, who: CheckerKind) -> Option<String> {
    first(found_of_solids(file, who))
}

/// Returns the false statements about the facets of a file, which for the library are those of the shrunk
/// solids.
fn found_of_solids(file: &Value, who: CheckerKind) -> Option<Vec<String>> {
    let movers = file.pointer("/placement/motions/0")?;
    let radius = |k: usize| radius_of_solid(body_at(file, &movers[k])?);
    let gap = file.pointer("/query/motions/0/min_gap").map_or(Some(0.0), Value::as_f64)?;
    let min_gap = gap + radius(0)? + radius(1)?;
    let facets = |k: usize| -> Option<Vec<Vec<DVec3>>> {
        file.pointer(&format!("/statement/motions/0/solids/parts/{k}/corners"))?
            .as_array()?
            .iter()
            .map(vectors)
            .collect()
    };
    let bodies = [facets(0)?, facets(1)?];
    let moves = [Moves::read(&movers[0]["motion"])?, Moves::read(&movers[1]["motion"])?];
    let start = file.pointer(&format!("{SOLID_PROOF}/start"))?;
    let apart = start.get("apart").is_some();
    let crosses = |time: f64, ends: bool, by: f64| {
        let places = [0, 1].map(|k| -> Vec<Vec<Vector>> {
            bodies[k].iter().map(|facet| moves[k].at(facet, time, ends)).collect()
        });
        places[0]
            .iter()
            .any(|f| places[1].iter().any(|g| near(f, g, min_gap) && meets([f, g], min_gap, by)))
    };
    let spans = file.pointer(&format!("{SOLID_PROOF}/spans"))?.as_array()?;
    let reached = spans.last().map_or(Some(0.0), |span| span.get("until")?.as_f64())?;
    if !apart {
        // check.py makes no statement about solids that overlap at the start.
        let said = who == CheckerKind::Library
            && !crosses(0.0, false, 1.0)
            && start.get("facets").is_some();
        let what = said.then(|| "facets do not cross at the beginning".to_owned());
        return Some(what.into_iter().collect());
    }
    let mut all: Vec<(f64, bool)> = times(&[], reached).into_iter().map(|t| (t, false)).collect();
    if reached == 1.0 {
        all.push((1.0, true));
    }
    if let Some((time, _)) = all.into_iter().find(|(time, ends)| crosses(*time, *ends, 1.0)) {
        return Some(vec![format!("facets meet at {time}, before {reached}")]);
    }
    let meeting = file.pointer(&format!("{SOLID_PROOF}/meeting"))?;
    if meeting.is_null() || meeting.pointer("/met/inside").is_some() {
        return Some(Vec::new());
    }
    let time = meeting.get("time")?.as_f64()?;
    let [f, g] = indices(meeting.get("triangles")?)?[..] else { return None };
    let pair = [bodies[0].get(f)?, bodies[1].get(g)?];
    let is_met = [true, false].into_iter().any(|ends| {
        let at = [0, 1].map(|k| moves[k].at(pair[k], time, ends));
        meets([&at[0], &at[1]], min_gap, -1.0)
    });
    let what = (!is_met).then(|| format!("the facets do not meet at {time}"));
    Some(what.into_iter().collect())
}

/// Checks whether facets may be within a gap, by their boxes.
fn near(f: &[Vector], g: &[Vector], min_gap: f64) -> bool {
    let bounds = |points: &[Vector]| {
        let all = points.iter().map(Vector::to_f64);
        all.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
    };
    let ([a, b], [c, d]) = (bounds(f), bounds(g));
    let more = DVec3::splat(min_gap.max(0.0) + 1e-9);
    (a - more).cmple(d).all() && (c - more).cmple(b).all()
}

/// Margin by which the library may reject a true number, in addition to that for the size of the bodies.
const ROUNDED: f64 = 1e-9;

/// Checks whether the library rejects a file because of its rounding margins.
fn is_marginal(file: &Value) -> bool {
    is_at_the_limit(file) || refused_for_rounding(&verify(&file.to_string()), size(file))
}

/// Returns the largest number of two motions, to which their rounding is proportional.
fn size(file: &Value) -> f64 {
    let all = super::mutants::pointers(file);
    let of_motion = all.iter().filter(|at| at.starts_with("/placement/motions/"));
    let sizes = of_motion.filter_map(|at| Some(file.pointer(at)?.as_f64()?.abs()));
    sizes.fold(0.0, f64::max)
}

/// Checks whether a rejection is due to rounding: the proven value is slightly less than the claimed one, or
/// planes are valid but too far from each other, for which the two checkers compute different bounds. `size` is
/// the largest number of the motions.
pub(super) fn refused_for_rounding(verdict: &Verdict, size: f64) -> bool {
    let Verdict::Refused(reason) = verdict else { return false };
    let number = |text: &str| text.trim_matches(|c: char| c == ',' || c == ';').parse::<f64>().ok();
    let words: Vec<&str> = reason.split_whitespace().collect();
    let after =
        |word: &str| words.iter().rposition(|w| *w == word).and_then(|k| number(words.get(k + 1)?));
    let claimed = after("not");
    let proven = after("of").or_else(|| words.iter().rev().skip(1).find_map(|w| number(w)));
    let said = ["do not prove", "does not hold", "meet at", "contact at time"]
        .iter()
        .any(|part| reason.contains(part));
    match (claimed, proven) {
        (Some(claimed), Some(proven)) => {
            (claimed - proven).abs() <= ROUNDED * (1.0 + claimed.abs()) + 1e-12 * size
        }
        _ => said || reason.ends_with("is not proven"),
    }
}

/// Checks whether a normal or weights are at a limit.
pub(super) fn is_at_the_limit(file: &Value) -> bool {
    let of = |at: &String| file.pointer(at).and_then(vector);
    let all = super::mutants::pointers(file);
    let unit =
        |at: &&String| at.contains("normal") || at.ends_with("axis") || at.ends_with("direction");
    all.iter().filter(unit).filter_map(of).any(|v| is_at_limit(v.length() - 1.0))
        || all
            .iter()
            .filter(|at| at.ends_with("weights"))
            .filter_map(|at| file.pointer(at).and_then(numbers))
            .any(|weights| is_at_limit(weights.iter().sum::<f64>() - 1.0))
}
