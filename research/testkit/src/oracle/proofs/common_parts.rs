//! Proofs of common parts of solids.
//!
//! The volume is compared with a sum over pairs of tetrahedra: a body is the sum of the tetrahedra between a point and
//! its facets, with signs. The sum of the volumes that pairs have in common, with both signs, is the integral of `a b`,
//! where `a` and `b` are the winding numbers. It differs from the volume by at most the integrals of `a^2 - a` and `b^2 -
//! b`. Points are compared by solid angles.

use colltrans::solid::{AsSolid, VolumeOptions};
use colltrans::{Pair, Pose, ProofFile, Solid};
use glam::DVec3;
use serde_json::{Value, json};

use super::casts::{HUGE, drawn};
use super::file::{Bodies, vector};
use super::mutants::with;
use super::solids::of_cubes;
use super::{CheckerKind, Claim, Kind, solids};
use crate::random::Random;

/// Common parts.
pub const COMMON_PARTS: Kind = Kind {
    name: "common-parts",
    focus: COMMON,
    draw_proof: common_part,
    claims,
    to_limits: worst,
    find_falsehood: falsehood,
    ..solids::DISTANCES
};

const COMMON: &str = "/statement/solid_common_part";
/// Maximum number of facets of both bodies.
const MOST_FACETS: usize = 90;
/// Error of the compared volume, in cubes of the size of both bodies.
const VOLUME_ERROR: f64 = 1e-9;
/// Height of a corner up to which it counts as in a plane, in sizes of both bodies.
const HEIGHT_ERROR: f64 = 1e-12;
/// Number of points at which winding numbers are compared.
const SAMPLES: usize = 60;
/// Distance from an integer up to which a sum of solid angles is certain.
const ANGLE_ERROR: f64 = 1e-6;

/// Draws solids of cubes or convex bodies, most of which overlap, and the proof of their common part.
fn common_part(seed: u64) -> Option<String> {
    let random = &mut Random::stream(seed, &[0xc0_44_04]);
    let (solids, mut poses): ([Solid; 2], [Pose; 2]) = if seed.is_multiple_of(3) {
        let (setting, bodies) = drawn(seed / 3)?;
        let solid = |body: &colltrans::ConvexPolyhedron| body.as_solid().ok().cloned();
        let solids = [solid(&bodies.moving)?, solid(&bodies.fixed)?];
        (solids, [setting.moving_pose, setting.fixed_pose])
    } else {
        let (solids, poses, _) = of_cubes(seed)?;
        (solids, poses)
    };
    if solids.iter().map(|solid| solid.triangles().len()).sum::<usize>() > MOST_FACETS {
        return None;
    }
    if !random.one_in(6) {
        // The bodies are moved over each other.
        let [p, q] = [0, 1].map(|k| poses[k].transform_point(solids[k].bounds().center()));
        let size = solids[1].bounds().side_lengths().length() * 0.3;
        let by = q - p + random.direction() * (size * random.range(0.0, 1.0));
        poses[0] = poses[0].translated_by(by).ok()?;
    }
    let pair = Pair::new(solids[0].at(poses[0]), solids[1].at(poses[1])).ok()?;
    let cells = random.pick(&[4, 40, 400]);
    let options = VolumeOptions::default().with_accuracy(0.0).with_max_cells(cells);
    let pieces = [&solids[0], &solids[1]];
    let proof =
        ProofFile::of_solid_common_part(&pair, [&pieces[..1], &pieces[1..]], options).ok()?;
    Some(proof.to_json())
}

fn claims(file: &Value) -> Vec<Claim> {
    let volume = |k: usize| file.pointer(&format!("{COMMON}/volume/{k}")).and_then(Value::as_f64);
    let [Some(lower), Some(upper)] = [volume(0), volume(1)] else { return Vec::new() };
    // The library rounds volumes, and compares everything else exactly.
    let band = 1e-10 * upper;
    let claim = |k: usize, weakest, strongest| {
        let pointer = format!("{COMMON}/volume/{k}");
        Claim { pointer, weakest, strongest, band }
    };
    vec![claim(0, 0.0, upper), claim(1, HUGE, lower)]
}

fn worst(file: &mut Value, random: &mut Random) {
    let put = |file: &mut Value, at: &str, value: Value| {
        *file = with(file, &format!("{COMMON}/{at}"), Some(value));
    };
    let count =
        file.pointer(&format!("{COMMON}/nodes")).and_then(Value::as_array).map_or(0, Vec::len);
    let node = format!("nodes/{}", random.index(count.max(1)));
    let shift = random.direction() * 10.0_f64.powf(random.range(-16.0, 0.5));
    let moved = |file: &Value, at: &str| {
        let point = file.pointer(&format!("{COMMON}/{at}")).and_then(vector)?;
        Some(json!((point + shift).to_array()))
    };
    match random.index(8) {
        0 | 1 => {
            let cells = ["both", "outside_moving", "outside_fixed", "undecided"];
            put(file, &node, json!(random.pick(&cells)));
        }
        2 => {
            let cuts = ["moving", "fixed"];
            put(file, &node, json!({ random.pick(&cuts): random.index(40) }));
        }
        3 => {
            let at = random.range(-3.0, 3.0);
            put(file, &node, json!({ random.pick(&["x", "y", "z"]): at }));
        }
        4 => {
            let at = random.pick(&["bounds/low", "bounds/high", "root/low", "root/high"]);
            if let Some(other) = moved(file, at) {
                put(file, at, other);
            }
        }
        5 => {
            let at = random.pick(&[
                "point",
                "relation/crossing/only_moving",
                "relation/crossing/only_fixed",
            ]);
            if let Some(other) = moved(file, at) {
                put(file, at, other);
            }
        }
        6 => {
            let kinds = ["disjoint", "moving_contained", "fixed_contained"];
            put(file, "relation", json!(random.pick(&kinds)));
        }
        _ => {
            // The other body's facets, and a mirrored piece.
            let body = random.index(2);
            let at = format!("/bodies/{body}/pieces/0/triangles");
            let Some(Value::Array(facets)) = file.pointer(&at) else { return };
            let turned = facets.iter().filter_map(|facet| {
                let [a, b, c] = [0, 1, 2].map(|k| facet[k].as_u64());
                Some(json!([a?, c?, b?]))
            });
            *file = with(file, &at, Some(turned.collect()));
        }
    }
}

/// A tetrahedron, or its part in half-spaces: its faces as polygons.
type Faces = Vec<Vec<DVec3>>;

/// Returns a tetrahedron with its corners in positive order, and the sign of the given order.
fn tetrahedron([a, b, c, d]: [DVec3; 4]) -> ([DVec3; 4], f64) {
    let volume = (b - a).dot((c - a).cross(d - a));
    if volume < 0.0 { ([a, c, b, d], -1.0) } else { ([a, b, c, d], 1.0) }
}

fn faces_of([a, b, c, d]: [DVec3; 4]) -> Faces {
    vec![vec![a, c, b], vec![a, b, d], vec![b, c, d], vec![c, a, d]]
}

/// Returns the volume of the part of a tetrahedron in another one. Corners whose height above a side is below `error`
/// count as in this side.
fn common_volume(p: [DVec3; 4], q: [DVec3; 4], error: f64) -> f64 {
    let mut faces = faces_of(p);
    for wall in faces_of(q) {
        let normal = (wall[1] - wall[0]).cross(wall[2] - wall[0]).normalize_or_zero();
        let height = |v: &DVec3| {
            let height = normal.dot(*v - wall[0]);
            if height.abs() < error { 0.0 } else { height }
        };
        let is_outside = |v: &DVec3| height(v) > 0.0;
        if !faces.iter().flatten().any(is_outside) {
            continue;
        }
        let mut lid = Vec::new();
        let mut kept = Faces::new();
        for face in &faces {
            let mut part = Vec::new();
            for (k, v) in face.iter().enumerate() {
                let w = &face[(k + 1) % face.len()];
                let (h, i) = (height(v), height(w));
                if h <= 0.0 {
                    part.push(*v);
                }
                if h == 0.0 {
                    lid.push(*v);
                }
                if (h < 0.0 && i > 0.0) || (h > 0.0 && i < 0.0) {
                    let between = *v + (*w - *v) * (h / (h - i));
                    part.push(between);
                    lid.push(between);
                }
            }
            if part.len() > 2 && part.iter().any(|v| height(v) < 0.0) {
                kept.push(part);
            }
        }
        // The lid is ordered by angles around its centre. A corner that it has several times adds nothing.
        if kept.is_empty() {
            return 0.0;
        }
        if lid.len() > 2 {
            let center = lid.iter().sum::<DVec3>() / lid.len() as f64;
            let x = normal.any_orthonormal_vector();
            let y = normal.cross(x);
            lid.sort_by(|v, w| {
                let angle = |v: &DVec3| (*v - center).dot(y).atan2((*v - center).dot(x));
                angle(v).total_cmp(&angle(w))
            });
            kept.push(lid);
        }
        faces = kept;
    }
    let Some(top) = faces.first().map(|face| face[0]) else { return 0.0 };
    let cone = |face: &Vec<DVec3>| {
        face[1..]
            .windows(2)
            .map(|v| (face[0] - top).dot((v[0] - top).cross(v[1] - top)))
            .sum::<f64>()
    };
    faces.iter().map(cone).sum::<f64>() / 6.0
}

/// Returns the integral of the product of the winding numbers of two surfaces of a size.
fn integral(p: &[[DVec3; 3]], q: &[[DVec3; 3]], top: DVec3, size: f64) -> f64 {
    let fans = [p, q].map(|facets| {
        facets.iter().map(|[a, b, c]| tetrahedron([top, *a, *b, *c])).collect::<Vec<_>>()
    });
    let pairs = fans[0].iter().flat_map(|f| fans[1].iter().map(move |g| (f, g)));
    pairs.map(|((f, s), (g, t))| s * t * common_volume(*f, *g, HEIGHT_ERROR * size)).sum()
}

fn signed_volume(facets: &[[DVec3; 3]], top: DVec3) -> f64 {
    facets.iter().map(|[a, b, c]| (*a - top).dot((*b - top).cross(*c - top)) / 6.0).sum()
}

/// Returns the winding number of a surface around a point; `None` near the surface.
fn winding(facets: &[[DVec3; 3]], at: DVec3) -> Option<f64> {
    let angle = |facet: &[DVec3; 3]| {
        let [a, b, c] = facet.map(|v| v - at);
        let [x, y, z] = [a, b, c].map(DVec3::length);
        let below = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
        2.0 * a.dot(b.cross(c)).atan2(below)
    };
    let sum = facets.iter().map(angle).sum::<f64>() / (2.0 * std::f64::consts::TAU);
    let near = sum.round();
    ((sum - near).abs() < ANGLE_ERROR).then_some(near)
}

/// Compares the volume with a sum over tetrahedra, and the other claims with winding numbers of points.
fn falsehood(file: &Value, _: CheckerKind) -> Option<String> {
    let Some(bodies) = Bodies::read(file) else { return Some("invalid bodies".into()) };
    let at = |name: &str| file.pointer(&format!("{COMMON}/{name}"));
    let [Some(lower), Some(upper)] =
        ["volume/0", "volume/1"].map(|name| at(name).and_then(Value::as_f64))
    else {
        return Some("no bounds".into());
    };
    if !(0.0 <= lower && lower <= upper) {
        return Some(format!("bounds {lower:e} and {upper:e}"));
    }
    // Coordinates relative to a vertex, so that few bits are lost.
    let base = bodies.points[1].first()?.clone();
    let points =
        bodies.points.each_ref().map(|all| all.iter().map(|v| v.minus(&base).to_f64()).collect());
    let points: [Vec<DVec3>; 2] = points;
    let facets: [Vec<[DVec3; 3]>; 2] =
        [0, 1].map(|k| bodies.facets[k].iter().map(|f| f.map(|v| points[k][v])).collect());
    let size = points.iter().flatten().fold(0.0_f64, |most, v| most.max(v.abs().max_element()));
    let top = points[1].iter().sum::<DVec3>() / points[1].len() as f64
        + DVec3::new(0.013, 0.007, -0.011) * size;
    let [a, b] = &facets;
    let both = integral(a, b, top, size);
    let excess = [a, b]
        .map(|own| (integral(own, own, top, size) - signed_volume(own, top)).max(0.0))
        .iter()
        .sum::<f64>();
    let off = VOLUME_ERROR * size.powi(3) + excess;
    if lower > both + off || upper < both - off {
        return Some(format!("a volume from {lower:e} to {upper:e}, not {both:e} +- {off:e}"));
    }
    let here = |point: DVec3| crate::oracle::exact::Vector::new(point).minus(&base).to_f64();
    let named = |name: &str| at(name).and_then(vector).map(here);
    let crossing = at("relation/crossing").is_some();
    let claims = [
        ("point", at("point").is_some_and(|of| !of.is_null()), [true, true]),
        ("relation/crossing/only_moving", crossing, [true, false]),
        ("relation/crossing/only_fixed", crossing, [false, true]),
    ];
    for (name, is_claimed, inside) in claims {
        let found = named(name);
        let Some(point) = found.filter(|_| is_claimed) else { continue };
        let windings = [0, 1].map(|k| winding(&facets[k], point));
        let is_false = |k: usize| windings[k].is_some_and(|w| (w > 0.0) != inside[k]);
        if is_false(0) || is_false(1) {
            return Some(format!("{name} has the winding numbers {windings:?}"));
        }
    }
    let bounds = [named("bounds/low"), named("bounds/high")];
    let relation = at("relation").and_then(Value::as_str).unwrap_or_default();
    let ends = |k: usize| {
        let all = points[k].iter();
        all.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], v| {
            [low.min(*v), high.max(*v)]
        })
    };
    let random = &mut Random::new(17);
    for (k, side) in (0..SAMPLES).map(|k| (k, k % 2)) {
        let [low, high] = ends(side);
        let share =
            DVec3::new(random.range(0.0, 1.0), random.range(0.0, 1.0), random.range(0.0, 1.0));
        let point = low + (high - low) * share;
        let [Some(p), Some(q)] = [0, 1].map(|k| winding(&facets[k], point)) else { continue };
        let inside = [p > 0.0, q > 0.0];
        let is_out = match bounds {
            [Some(low), Some(high)] => (low - point).max(point - high).max_element() > 1e-9 * size,
            _ => true,
        };
        let is_false = match inside {
            [true, true] => is_out || relation == "disjoint",
            [true, false] => relation == "moving_contained",
            [false, true] => relation == "fixed_contained",
            _ => false,
        };
        if is_false {
            return Some(format!(
                "sample {k} at {point} is inside {inside:?}: {relation} {bounds:?}"
            ));
        }
    }
    None
}
