//! Proofs of paths of joints, judged at some positions of each row.

use colltrans::motion::path::{Frame, Joint, JointPath, Mechanism, PathBody, PathCast, PathPlace};
use colltrans::{Pose, ProofFile, Solid};
use glam::DVec3;
use serde_json::Value;

use super::checkers::verify;
use super::file::{body_at, numbers, vector, vectors};
use super::motions::{
    body, depth_is_false, first, is_at_the_limit, meets, met, pose, refused_for_rounding,
};
use super::mutants::{number, pointers, with};
use super::{CheckerKind, Claim, Kind};
use crate::oracle::exact::Vector;
use crate::oracle::motion::{Stage, points_carried};
use crate::random::Random;

/// Paths of a few joints and bodies.
pub const PATHS: Kind = Kind {
    name: "paths",
    focus: PROOF,
    draw_proof: base,
    claims,
    to_limits: worst,
    find_falsehood: falsehood,
    is_marginal,
};

/// The pointer to the proof.
const PROOF: &str = "/statement/path/proof";

/// Number of positions of each row that are checked.
const PLACES: usize = 4;

fn base(seed: u64) -> Option<String> {
    let random = &mut Random::stream(seed, &[0x9a_7104]);
    let count = 1 + random.index(3);
    let mut frames: Vec<Frame> = Vec::new();
    for k in 0..count {
        let axis = random.direction();
        let joint = match random.index(5) {
            0 => Joint::Sliding(axis),
            1 if k > 0 => Joint::Fixed,
            _ => Joint::Turning(axis),
        };
        let turn = if random.one_in(2) { glam::DQuat::IDENTITY } else { random.rotation() };
        let origin = Pose::new(turn, random.direction() * random.range(0.0, 0.8)).ok()?;
        frames.push(Frame { parent: k.checked_sub(1), origin, joint });
    }
    let mechanism = Mechanism::new(frames).ok()?;
    let rows = random.pick(&[1, 2, 2, 3]);
    let most = random.pick(&[0.3, 2.0]);
    let mut row: Vec<f64> = (0..mechanism.joint_count()).map(|_| random.range(-1.0, 1.0)).collect();
    let mut all = Vec::new();
    for _ in 0..rows {
        all.push(row.clone());
        for value in &mut row {
            *value += random.range(-most, most);
        }
    }
    let path = JointPath::at_unit_times(all).ok()?;
    let solid = random.one_in(4).then(|| Solid::from_convex(&body(random))).transpose().ok()?;
    let convex = [body(random), body(random), body(random)];
    let mut bodies = Vec::new();
    for (k, one) in convex.iter().enumerate() {
        let frame = [Some(count - 1), Some(0), None][k];
        let far = if frame.is_none() { random.range(0.5, 2.0) } else { 0.3 };
        let pose = Pose::new(random.rotation(), random.direction() * far).ok()?;
        bodies.push(PathBody { frame, placed: one.at(pose).into() });
    }
    if let Some(solid) = &solid {
        let pose =
            Pose::new(random.rotation(), random.direction() * random.range(0.7, 2.0)).ok()?;
        bodies.push(PathBody::at_rest(solid.at(pose)));
    }
    let mut pairs = vec![[0, 2], [1, 2]];
    pairs.extend(solid.is_some().then_some([0, 3]));
    let cast = PathCast::new(&mechanism, &path, bodies, pairs).ok()?;
    let min_gap = 10.0_f64.powf(random.range(-5.0, -1.0));
    let cast = if random.one_in(3) { cast.with_min_gap(min_gap) } else { Ok(cast) }.ok()?;
    let (_, file) = ProofFile::with_path(&cast, &[]).ok()?;
    let text = file.to_json();
    (text.len() < 20_000).then_some(text)
}

/// Checks whether the library rejects a file because of its rounding margins.
fn is_marginal(file: &Value) -> bool {
    is_at_the_limit(file) || refused_for_rounding(&verify(&file.to_string()), 0.0)
}

fn claims(file: &Value) -> Vec<Claim> {
    let Some(times) = file.pointer("/query/path/path/times").and_then(numbers) else {
        return Vec::new();
    };
    let [Some(&from), Some(&to)] = [times.first(), times.last()] else { return Vec::new() };
    let claim = |name: &str, weakest, strongest| {
        let pointer = format!("/statement/path/{name}");
        let is_there = file.pointer(&pointer).is_some_and(Value::is_number);
        is_there.then_some(Claim { pointer, weakest, strongest, band: 1e-9 })
    };
    [claim("lower", from, to), claim("upper", 1e300, from)].into_iter().flatten().collect()
}

fn worst(file: &mut Value, random: &mut Random) {
    let all = pointers(file);
    let under = |end: &str| -> Vec<String> {
        all.iter().filter_map(|at| at.strip_suffix(end)).map(ToOwned::to_owned).collect()
    };
    let (planes, parts) = (under("/alone"), under("/parts"));
    let pairs = file.pointer("/statement/path/pairs").and_then(Value::as_array).map_or(0, Vec::len);
    match random.index(10) {
        0..=3 if !planes.is_empty() => {
            let at = &planes[random.index(planes.len())];
            let place = |name: &str| format!("{at}/{name}");
            let old =
                |name: &str| file.pointer(&place(name)).and_then(Value::as_f64).unwrap_or(0.0);
            match random.index(4) {
                0 => *file = with(file, at, None),
                1 => {
                    let gap = old("gap") * random.pick(&[0.5, 1.0 + 1e-12, 2.0, -1.0]);
                    *file = with(file, &place("gap"), Some(number(gap)));
                }
                2 => {
                    let time = old("time") + random.range(-0.1, 0.1);
                    *file = with(file, &place("time"), Some(number(time)));
                }
                _ => {
                    let Some(normal) = file.pointer(&place("normal")).and_then(vector) else {
                        return;
                    };
                    let other = (normal + random.direction() * 1e-3).normalize().to_array();
                    *file = with(file, &place("normal"), Some(Value::from(other.to_vec())));
                }
            }
        }
        4 if !parts.is_empty() => {
            let at = format!("{}/parts/until", parts[random.index(parts.len())]);
            let (row, share) = (random.index(4), random.pick(&[0.0, 0.5, 1.0, 5.0, -1.0]));
            *file = with(file, &at, Some(serde_json::json!({"row": row, "share": share})));
        }
        5 => {
            let (row, share) = (random.index(4), random.pick(&[0.0, 0.5, 1.0, 5.0, -1.0]));
            let place = serde_json::json!({"row": row, "share": share});
            *file = with(file, &format!("{PROOF}/meeting/place"), Some(place));
        }
        6 if pairs > 0 => {
            // Replaces or removes a pair.
            let k = random.index(pairs);
            let at = format!("/statement/path/pairs/{k}");
            if random.one_in(2) {
                *file = with(file, &at, Some(serde_json::json!(["body 0", "body 2"])));
            } else {
                for list in ["/statement/path/pairs", "/statement/path/proof/covers"] {
                    *file = with(file, &format!("{list}/{k}"), None);
                }
            }
        }
        7 if pairs > 0 => {
            let at = format!("{PROOF}/covers/{}/steps", random.index(pairs));
            *file = with(file, &at, Some(Value::Array(Vec::new())));
        }
        8 => met(file, &format!("{PROOF}/meeting/how/pieces/met"), random),
        _ => {
            *file = with(file, &format!("{PROOF}/meeting"), Some(Value::Null));
            *file = with(file, "/statement/path/upper", Some(Value::Null));
        }
    }
}

/// A frame: its parent, its origin, its axis and whether it rotates, and the column of its value.
type Framed = (Option<usize>, Pose, Option<(DVec3, bool)>, usize);

/// The path of a file.
struct Path {
    times: Vec<f64>,
    rows: Vec<Vec<f64>>,
    frames: Vec<Framed>,
    bodies: Vec<(String, Option<usize>, Pose, Vec<DVec3>)>,
    min_gap: f64,
}

impl Path {
    fn read(file: &Value) -> Option<Self> {
        let times = file.pointer("/query/path/path/times").and_then(numbers)?;
        let rows = file.pointer("/query/path/path/rows")?.as_array()?;
        let rows = rows.iter().map(numbers).collect::<Option<Vec<_>>>()?;
        let (mut frames, mut column) = (Vec::new(), 0);
        let index = |of: &Value| of.as_u64().map(|k| k as usize);
        for frame in file.pointer("/placement/robot/frames")?.as_array()? {
            let joint = frame.get("joint")?;
            let axis = joint.get("turning").map(|axis| (axis, true));
            let axis = axis.or_else(|| joint.get("sliding").map(|axis| (axis, false)));
            let axis = match axis {
                Some((axis, turns)) => Some((vector(axis)?, turns)),
                None => None,
            };
            frames.push((index(frame.get("parent")?), pose(frame.get("origin")?)?, axis, column));
            column += usize::from(axis.is_some());
        }
        let body = |of: &Value| -> Option<_> {
            let shape = body_at(file, of)?;
            let points = match shape.get("convex") {
                Some(convex) => vectors(convex.get("vertices")?)?,
                None => vectors(shape.pointer("/pieces/0/vertices")?)?,
            };
            let name = of.get("name")?.as_str()?.to_owned();
            Some((name, index(of.get("frame")?), pose(of.get("pose")?)?, points))
        };
        let links = file.pointer("/placement/robot/bodies")?.as_array()?;
        let bodies = links.iter().map(body).collect::<Option<_>>()?;
        let min_gap = file.pointer("/query/path/min_gap").map_or(Some(0.0), Value::as_f64)?;
        Some(Self { times, rows, frames, bodies, min_gap })
    }

    /// Returns the points of a convex body at a position of the path.
    fn points(&self, name: &str, PathPlace { row, share }: PathPlace) -> Option<Vec<Vector>> {
        let (_, frame, pose, points) = self.bodies.iter().find(|of| of.0 == name)?;
        let next = self.rows.get(row + 1).unwrap_or(&self.rows[row]);
        let (mut stages, mut at) = (Vec::new(), *frame);
        while let Some(k) = at {
            let (parent, origin, axis, column) = *self.frames.get(k)?;
            let values = match axis {
                Some(_) => [*self.rows[row].get(column)?, *next.get(column)?],
                None => [0.0; 2],
            };
            stages.push(Stage { origin, axis, values });
            at = parent;
        }
        stages.reverse();
        Some(points_carried(points, pose, &stages, share))
    }

    fn time(&self, PathPlace { row, share }: PathPlace) -> f64 {
        let next = self.times.get(row + 1).unwrap_or(&self.times[row]);
        self.times[row] + share * (next - self.times[row])
    }

    /// Returns positions before a time, and the end of the path if `ends`.
    fn places(&self, until: f64, ends: bool) -> Vec<PathPlace> {
        let rows = self.rows.len() - 1;
        let within = |row: usize| {
            (0..PLACES)
                .map(move |k| (k as f64 + 0.3) / PLACES as f64 - 0.075)
                .map(move |share| PathPlace { row, share })
        };
        let mut all: Vec<PathPlace> = (0..rows).flat_map(within).collect();
        all.extend((0..rows).map(|row| PathPlace { row, share: 0.0 }));
        // A position just before the time.
        let row = self.times.partition_point(|time| *time < until).saturating_sub(1);
        if row < rows {
            let share = (until - self.times[row]) / (self.times[row + 1] - self.times[row]);
            all.push(PathPlace { row, share: (share - 1e-13).clamp(0.0, 1.0) });
        }
        all.retain(|place| self.time(*place) < until);
        if ends {
            all.push(PathPlace { row: rows, share: 0.0 });
        }
        all
    }
}

fn falsehood(file: &Value, who: CheckerKind) -> Option<String> {
    first(false_statements(file, who))
}

/// Returns the false statements; `None` if the file is invalid.
fn false_statements(file: &Value, _: CheckerKind) -> Option<Vec<String>> {
    let path = Path::read(file)?;
    let lower = file.pointer("/statement/path/lower")?.as_f64()?;
    let upper = file.pointer("/statement/path/upper")?.as_f64();
    let meeting = file.pointer(&format!("{PROOF}/meeting"))?;
    let pairs = file.pointer("/statement/path/pairs")?.as_array()?;
    let covers = file.pointer(&format!("{PROOF}/covers"))?.as_array()?;
    if covers.len() != pairs.len() {
        return Some(vec!["not a cover for each pair".into()]);
    }
    let begins = |cover: &Value| cover.to_string().contains("\"gap\"");
    let whole = meeting.is_null()
        && lower == *path.times.last()?
        && (path.rows.len() > 1 || covers.iter().all(begins));
    let names = |pair: &Value| -> Option<[String; 2]> {
        Some([pair.get(0)?.as_str()?.to_owned(), pair.get(1)?.as_str()?.to_owned()])
    };
    for pair in pairs {
        let [a, b] = names(pair)?;
        for place in path.places(lower, whole) {
            let (p, q) = (path.points(&a, place)?, path.points(&b, place)?);
            if meets([&p, &q], path.min_gap, 1.0) {
                return Some(vec![format!("{a} and {b} meet at {place:?}, before {lower}")]);
            }
        }
    }
    if meeting.is_null() {
        let what = upper.map(|upper| format!("nothing meets by {upper}"));
        return Some(what.into_iter().collect());
    }
    let [a, b] = names(pairs.get(meeting.get("pair")?.as_u64()? as usize)?)?;
    let at = meeting.get("place")?;
    let place =
        PathPlace { row: at.get("row")?.as_u64()? as usize, share: at.get("share")?.as_f64()? };
    if place.row >= path.rows.len() {
        return None;
    }
    if let Some(upper) = upper.filter(|upper| path.time(place) > upper + 1e-14 * upper.abs()) {
        return Some(vec![format!("they meet at {place:?}, after {upper}")]);
    }
    let (p, q) = (path.points(&a, place)?, path.points(&b, place)?);
    if !meets([&p, &q], path.min_gap, -1.0) {
        return Some(vec![format!("{a} and {b} do not meet at {place:?}")]);
    }
    // A depth of pieces of solids refers to the pieces.
    let both = [a, b].iter().all(|name| {
        let links = file.pointer("/placement/robot/bodies").and_then(Value::as_array);
        let of = links.and_then(|all| all.iter().find(|of| of["name"] == **name));
        of.and_then(|of| body_at(file, of)).is_some_and(|body| body.get("convex").is_some())
    });
    let met = meeting.pointer("/how/pieces/met").filter(|_| both);
    Some(met.and_then(|met| depth_is_false(met, [&p, &q], 1e-11)).into_iter().collect())
}
