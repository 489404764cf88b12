//! Proofs of depths of solids.

use colltrans::solid::AsSolid;
use colltrans::{Pair, Pose, ProofFile, Solid};
use glam::DVec3;
use serde_json::Value;

use super::casts::{BAND, HUGE, drawn, other_weights, put};
use super::file::{Bodies, numbers, square, vector};
use super::mutants::with;
use super::solids::{of_cubes, sometimes_rounded, surface};
use super::{CheckerKind, Claim, Kind, solids};
use crate::oracle::exact::{Ratio, Vector};
use crate::oracle::solids::nearest;
use crate::random::Random;

/// Depths.
pub const DEPTHS: Kind = Kind {
    name: "solid-depths",
    draw_proof: depth,
    claims,
    to_limits: worst,
    find_falsehood: falsehood,
    ..solids::DISTANCES
};

const DEPTH: &str = "/statement/solid_depth";

/// Maximum number of facets of both bodies.
const MOST_FACETS: usize = 100;

/// Draws solids of cubes or convex bodies, most of which overlap, and the proof of their depth.
fn depth(seed: u64) -> Option<String> {
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
    let random = &mut Random::stream(seed, &[0xdee9, 0x501d]);
    if !random.one_in(6) {
        // The bodies are moved over each other.
        let [p, q] = [0, 1].map(|k| poses[k].transform_point(solids[k].bounds().center()));
        let size = solids[1].bounds().side_lengths().length() * 0.3;
        let by = q - p + random.direction() * (size * random.range(0.0, 1.0));
        poses[0] = poses[0].translated_by(by).ok()?;
    }
    let solids = sometimes_rounded(solids, seed)?;
    let pair = Pair::new(solids[0].at(poses[0]), solids[1].at(poses[1])).ok()?;
    let proof = ProofFile::of_solid_depth(&pair, [&[&solids[0]], &[&solids[1]]]).ok()?;
    Some(proof.to_json())
}

fn claims(file: &Value) -> Vec<Claim> {
    let Some(bodies) = Bodies::read(file) else { return Vec::new() };
    let band = 2.0 * BAND * bodies.noise();
    let all = [
        ("lower", 0.0, HUGE),
        ("upper", HUGE, 0.0),
        ("apart/lower", f64::MIN_POSITIVE, HUGE),
        ("apart/near/points/distance", HUGE, 0.0),
        ("cores/0/0/radius", 0.0, HUGE),
        ("cores/0/1/radius", 0.0, HUGE),
    ];
    let claim = |(name, weakest, strongest)| {
        let pointer = format!("{DEPTH}/{name}");
        Claim { pointer, weakest, strongest, band }
    };
    let claims = all.into_iter().map(claim);
    claims.filter(|of| file.pointer(&of.pointer).is_some_and(Value::is_number)).collect()
}

fn worst(file: &mut Value, random: &mut Random) {
    let count = |at: &str| file.pointer(at).and_then(Value::as_array).map_or(0, Vec::len);
    let move_point = |file: &mut Value, at: &str, random: &mut Random| {
        let Some(point) = file.pointer(at).and_then(vector) else { return };
        let moved = point + random.direction() * 10.0_f64.powf(random.range(-16.0, 0.5));
        *file = with(file, at, Some(Value::from(moved.to_array().to_vec())));
    };
    let (triangles, side) = (count(&format!("{DEPTH}/enclosure/triangles")), random.index(2));
    match random.index(6) {
        0 => move_point(file, &format!("{DEPTH}/translation"), random),
        1 => put(file, &format!("{DEPTH}/apart/near/points/distance"), 0.0),
        2 => {
            let at = format!("{DEPTH}/apart/near/points/weights/{side}");
            *file = with(file, &at, Some(other_weights(3, random)));
        }
        3 if triangles > 0 => {
            let k = random.index(triangles);
            for list in ["triangles", "normals"] {
                *file = with(file, &format!("{DEPTH}/enclosure/{list}/{k}"), None);
            }
        }
        4 => {
            let sides = 10.0_f64.powf(random.range(-6.0, 0.5));
            let sides = Value::from(DVec3::splat(sides).to_array().to_vec());
            *file = with(file, &format!("{DEPTH}/cores/0/{side}/size"), Some(sides));
        }
        _ => move_point(file, &format!("{DEPTH}/cores/0/{side}/origin"), random),
    }
}

/// Returns the lowest and the highest coordinates of points, rounded outwards.
fn ends(points: &[Vector]) -> [DVec3; 2] {
    let all = points.iter().map(Vector::to_f64);
    let [low, high] = all
        .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)]);
    [low.map(f64::next_down), high.map(f64::next_up)]
}

/// Compares the claims with the translation that the file states, and with those beyond the boxes of the bodies.
fn falsehood(file: &Value, _: CheckerKind) -> Option<String> {
    let Some(bodies) = Bodies::read(file) else { return Some("invalid bodies".into()) };
    let at = |name: &str| file.pointer(&format!("{DEPTH}/{name}"));
    let numbers_at = |name: &str| at(name).and_then(Value::as_f64);
    let [Some(lower), Some(upper)] = [numbers_at("lower"), numbers_at("upper")] else {
        return Some("no bounds".into());
    };
    let start = file.pointer("/placement/poses/0/pose/translation").and_then(vector)?;
    let by = Vector::new(at("translation").and_then(vector)?).minus(&Vector::new(start));
    let length = Ratio::new(by.dot(&by), crate::oracle::exact::Dyadic::new(1.0));
    if upper < 0.0 || square(upper) < length {
        return Some(format!("an upper bound of {upper:e} of {:e}", length.sqrt_to_f64()));
    }
    let moved = surface(&bodies, 0).into_iter().map(|f| f.map(|corner| corner.plus(&by))).collect();
    let apart = nearest::surfaces(&[moved, surface(&bodies, 1)]);
    let claimed = numbers_at("apart/lower").unwrap_or(0.0);
    if claimed <= 0.0 || bodies.square_between_cores(claimed) > apart {
        return Some(format!("{claimed:e} apart, not {:e}", apart.sqrt_to_f64()));
    }
    let [[low, high], [least, most]] = [0, 1].map(|k| ends(&bodies.points[k]));
    let exits = (most - low).min(high - least);
    // The exits of bodies that are apart may be negative.
    let most = (exits.min_element() + bodies.radii.to_f64()).next_up().max(0.0);
    if lower < 0.0 || square(lower) > length || lower > most {
        return Some(format!("a depth of at least {lower:e}, along the axes {exits:?}"));
    }
    let cores = at("cores").and_then(Value::as_array).map_or(0, Vec::len);
    (0..2 * cores).find_map(|place| {
        let k = place % 2;
        let core = at(&format!("cores/{}/{k}", place / 2))?;
        let radius = core.get("radius")?.as_f64()?;
        let [origin, size] = ["origin", "size"].map(|of| core.get(of).and_then(numbers));
        let (origin, size) = (DVec3::from_slice(&origin?), DVec3::from_slice(&size?));
        let corner = |i: usize| {
            let share = [i & 1, i >> 1 & 1, i >> 2 & 1].map(|bit| bit as f64);
            Vector::new(origin).plus(&Vector::new(size * DVec3::from_array(share)))
        };
        let sides =
            [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        let facets = sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
        let facets = facets.map(|facet| facet.map(corner)).collect();
        let near = nearest::surfaces(&[facets, surface(&bodies, k)]);
        let is_false = radius < 0.0 || near.is_zero() || square(radius) > near;
        is_false.then(|| format!("a core of radius {radius:e}, not {:e}", near.sqrt_to_f64()))
    })
}
