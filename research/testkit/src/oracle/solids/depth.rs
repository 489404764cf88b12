//! Judges common parts and depths of solids.
//!
//! - Bodies of cubes with translations in quarters, in integers. After a displacement two cubes share interior points
//!   if it lies in an open cube `c + (-1, 1)^3`. The planes of all these cubes divide space into open boxes, rectangles,
//!   segments and points, each of which lies in a cube or outside. The displacements that separate the bodies are
//!   those outside of all cubes. This set is closed, so the depth is the distance of the closure of the nearest part.
//! - The same bodies rotated: all exact numbers with an error below `ROTATED`.
//! - Convex bodies: the depth of the convex search, and the volume of the hull of all vertices of the common part:
//!   points in which an edge of one body meets a face of the other, and vertices of one inside the other.

use std::collections::BTreeSet;

use colltrans::solid::{
    CommonPart, InnerPair, Relation, SolidDepth, SolidPenetration, VolumeOptions,
};
use colltrans::{ConvexPolyhedron, Pair, Pose, Solid};
use glam::{DMat3, DVec3};

use super::cells::Cells;
use crate::random::Random;
use crate::shapes::prism;
use crate::tally::Tally;

/// The families.
pub const FAMILIES: [&str; 6] = ["cubes", "hollow", "nested", "rotated", "convex", "pieces"];
/// Columns of the campaign: settings by relation, how many bounds equal the exact depth to `1e-9`, lower bounds of at
/// least 98 % of it, and answers that do not reach the accuracy.
pub const COLUMNS: &[&str] = &[
    "settings",
    "disjoint",
    "touching",
    "crossing",
    "contained",
    "partly",
    "upper met",
    "lower met",
    "lower 98 %",
    "coarse",
];

/// Number of integer units in the side of a cube.
const UNIT: i64 = 4;
/// Bound on the differences by the rounding of a rotation, for coordinates below 16 and volumes below 64.
const ROTATED: f64 = 1e-11;
/// Maximum relative error of the volume of the common part of convex bodies as it is computed here.
const CONVEX_VOLUME: f64 = 1e-9;

/// Two bodies of cubes. The moving one is displaced by `by`, in units of a quarter.
pub(super) struct Exact<'c> {
    pub(super) moving: &'c Cells,
    pub(super) fixed: &'c Cells,
    pub(super) by: [i64; 3],
}

impl Exact<'_> {
    /// Returns the differences of the corners of cubes of the fixed and the moving body: the displacements after which
    /// these cubes coincide.
    fn centers(&self) -> BTreeSet<[i64; 3]> {
        let apart = |p: &[i32; 3], q: &[i32; 3]| {
            [0, 1, 2].map(|k| UNIT * i64::from(q[k] - p[k]) - self.by[k])
        };
        self.moving.0.iter().flat_map(|p| self.fixed.0.iter().map(move |q| apart(p, q))).collect()
    }

    /// Returns the volume of the common part in cubes of a quarter.
    pub(super) fn volume(&self) -> i64 {
        let common = |p: &[i32; 3], q: &[i32; 3]| {
            let sides = [0, 1, 2].map(|k| {
                let apart = UNIT * i64::from(q[k] - p[k]) - self.by[k];
                (UNIT - apart.abs()).max(0)
            });
            sides.iter().product::<i64>()
        };
        self.moving.0.iter().map(|p| self.fixed.0.iter().map(|q| common(p, q)).sum::<i64>()).sum()
    }

    /// Checks whether the closed bodies have a common point.
    pub(super) fn touch(&self) -> bool {
        self.centers().iter().any(|center| center.iter().all(|c| c.abs() <= UNIT))
    }

    /// Returns the square of the depth, in square quarters.
    pub(super) fn squared_depth(&self) -> i64 {
        // Parts of an axis in units of an eighth: planes have even numbers, and intervals lie between them.
        let centers = self.centers();
        let parts = [0, 1, 2].map(|axis| {
            let planes: BTreeSet<i64> =
                centers.iter().flat_map(|c| [c[axis] - UNIT, c[axis] + UNIT]).collect();
            let planes: Vec<i64> = planes.into_iter().collect();
            let (first, last) = (planes[0], planes[planes.len() - 1]);
            let mut parts = vec![[first - 4 * UNIT, first], [last, last + 4 * UNIT]];
            parts.extend(planes.iter().map(|plane| [*plane; 2]));
            parts.extend(planes.windows(2).map(|pair| [pair[0], pair[1]]));
            // The distance of a part from 0. The parts beyond all planes have no end.
            let distance = |[low, high]: [i64; 2]| {
                if low >= last {
                    low.max(0)
                } else if high <= first {
                    (-high).max(0)
                } else {
                    low.max(-high).max(0)
                }
            };
            let mut parts: Vec<(i64, [i64; 2])> =
                parts.into_iter().map(|part| (distance(part).pow(2), part)).collect();
            parts.sort_unstable();
            parts
        });
        let mut best = i64::MAX;
        for (x, first) in &parts[0] {
            for (y, second) in &parts[1] {
                if x + y >= best {
                    break;
                }
                for (z, third) in &parts[2] {
                    let square = x + y + z;
                    if square >= best {
                        break;
                    }
                    let part = [first, second, third];
                    let covers = |center: &[i64; 3]| {
                        (0..3).all(|k| {
                            let [low, high] = *part[k];
                            let [from, to] = [center[k] - UNIT, center[k] + UNIT];
                            if low == high {
                                from < low && low < to
                            } else {
                                from <= low && high <= to
                            }
                        })
                    };
                    if !centers.iter().any(covers) {
                        best = square;
                    }
                }
            }
        }
        best
    }

    /// Returns the number of cubes of the moving and of the fixed body, in cubes of a quarter.
    pub(super) fn volumes(&self) -> [i64; 2] {
        [self.moving, self.fixed].map(|body| body.0.len() as i64 * UNIT.pow(3))
    }

    /// Judges the answers for solids with the map `x -> matrix x` of the grid, with errors up to `error`. Contact and
    /// containment are judged if there is no error. `are_plain`: no body has facets inside.
    pub(super) fn judge(
        &self,
        pair: &Pair<'_, Solid>,
        error: f64,
        are_plain: bool,
        tally: &mut Tally,
    ) -> Result<(), String> {
        let common =
            pair.common_part(VolumeOptions::default()).map_err(|e| format!("common part: {e}"))?;
        let depth = pair.depth().map_err(|e| format!("depth: {e}"))?;
        let (volume, touch) = (self.volume(), self.touch());
        let unit = (UNIT as f64).powi(3);
        let exact = volume as f64 / unit;
        let say = |what: &str| {
            Err(format!("{what}: {common:?}, {depth:?}, volume {exact}, touching: {touch}"))
        };
        if common.volume[0] > exact + error || exact > common.volume[1] + error {
            return say("volume");
        }
        tally.count_if("coarse", !common.is_accurate);
        let [whole, around] = self.volumes().map(|all| all == volume);
        let is_right = match common.relation {
            Relation::Disjoint => volume == 0 && !touch,
            Relation::Touching(_) => volume == 0 && touch,
            Relation::MovingContained => whole,
            Relation::FixedContained => around,
            Relation::Crossing(_) | Relation::PartlyContained(_) => {
                volume > 0 && !(are_plain && self.is_strictly_contained())
            }
            _ => false,
        };
        if error == 0.0 && !is_right {
            return say("relation");
        }
        let overlaps = count_relation(&common, tally);
        judge_common(pair, &common).or_else(|what| say(&what))?;
        if overlaps != (depth.upper > 0.0) {
            return say("depth and relation");
        }
        let squared = if volume == 0 { 0 } else { self.squared_depth() };
        let right = (squared as f64).sqrt() / UNIT as f64;
        // Squares of a bound are exact to a few units of roundoff.
        let squares = [depth.lower, depth.upper].map(|bound| (bound * UNIT as f64).powi(2));
        let slack = 4.0 * f64::EPSILON * squared as f64;
        let bounds_hold = if error == 0.0 {
            squares[0] <= squared as f64 + slack && squared as f64 <= squares[1] + slack
        } else {
            depth.lower <= right + error && right <= depth.upper + error
        };
        if !bounds_hold {
            return say(&format!("depth {right}"));
        }
        if right > 0.0 {
            tally.count_if("upper met", depth.upper <= right + 1e-9);
            tally.count_if("lower met", depth.lower >= right - 1e-9);
            tally.count_if("lower 98 %", depth.lower >= 0.98 * right);
        }
        judge_depth(pair, &depth, error).or_else(|what| say(&what))
    }

    /// Checks whether one body lies in the interior of the other one: all cubes, grown by an eighth, are filled.
    fn is_strictly_contained(&self) -> bool {
        let fills = |own: &Cells, other: &Cells, sign: i64| {
            own.0.iter().all(|p| {
                // In eighths: the grown cube has the side `2 UNIT + 2`.
                let covered: i64 = other
                    .0
                    .iter()
                    .map(|q| {
                        let side = |k: usize| {
                            let low = 2 * (UNIT * i64::from(p[k]) + sign * self.by[k]) - 1;
                            let high = low + 2 * UNIT + 2;
                            let from = 2 * UNIT * i64::from(q[k]);
                            (high.min(from + 2 * UNIT) - low.max(from)).max(0)
                        };
                        side(0) * side(1) * side(2)
                    })
                    .sum();
                covered == (2 * UNIT + 2).pow(3)
            })
        };
        fills(self.moving, self.fixed, 1) || fills(self.fixed, self.moving, -1)
    }
}

/// Counts a relation. Returns whether the bodies overlap.
fn count_relation(common: &CommonPart, tally: &mut Tally) -> bool {
    let (name, overlaps) = match common.relation {
        Relation::Disjoint => ("disjoint", false),
        Relation::Touching(_) => ("touching", false),
        Relation::Crossing(_) => ("crossing", true),
        Relation::MovingContained | Relation::FixedContained => ("contained", true),
        _ => ("partly", true),
    };
    tally.count(name);
    overlaps
}

/// Checks the point and the box of a common part.
fn judge_common(pair: &Pair<'_, Solid>, common: &CommonPart) -> Result<(), String> {
    let Some(point) = common.point else { return Ok(()) };
    for body in [pair.bodies.moving_placed(), pair.bodies.fixed_placed()] {
        let found = body.body.signed_distances(body.pose, &[point]).map_err(|e| e.to_string())?;
        if !found[0].is_inside {
            return Err("the point is outside".to_owned());
        }
    }
    let within = common
        .bounds
        .is_some_and(|bounds| bounds.low.cmple(point).all() && point.cmple(bounds.high).all());
    if within { Ok(()) } else { Err("the point is not in the box".to_owned()) }
}

/// Checks that the translation of a depth separates the bodies, and that the convex bodies that prove its lower bound are
/// inside.
pub(super) fn judge_depth(
    pair: &Pair<'_, Solid>,
    depth: &SolidDepth,
    error: f64,
) -> Result<(), String> {
    let [moving, fixed] = [pair.bodies.moving_placed(), pair.bodies.fixed_placed()];
    if depth.lower > depth.upper || depth.translation.length() > depth.upper {
        return Err("bounds of the depth".to_owned());
    }
    let pose = moving.pose.with_translation(moving.pose.translation() + depth.translation);
    let away = Pair::new(moving.body.at(pose.map_err(|e| e.to_string())?), fixed);
    let rest = away.and_then(|pair| pair.common_part(VolumeOptions::default()));
    match rest.map_err(|e| e.to_string())?.relation {
        Relation::Disjoint | Relation::Touching(_) => {}
        relation => return Err(format!("{relation:?} after the translation")),
    }
    for (k, body) in [moving, fixed].into_iter().enumerate() {
        match depth.inner {
            None => {}
            Some(InnerPair::Balls { center, radii }) => {
                let found = body.body.signed_distances(body.pose, &[center]);
                let found = found.map_err(|e| e.to_string())?[0];
                if !found.is_inside || -found.lower < radii[k] {
                    return Err(format!("a ball is not inside body {k}"));
                }
            }
            Some(InnerPair::Boxes { moving, fixed }) => {
                let inner = [moving, fixed][k];
                let mesh = ConvexPolyhedron::cuboid(inner.low, inner.high)
                    .map(|cuboid| Solid::from_convex(&cuboid))
                    .map_err(|e| e.to_string())?
                    .map_err(|e| e.to_string())?;
                let full = inner.side_lengths().element_product();
                let common = Pair::new(mesh.at(Pose::IDENTITY), body)
                    .and_then(|pair| pair.common_part(VolumeOptions::default()))
                    .map_err(|e| e.to_string())?;
                if common.volume[1] < full * (1.0 - 1e-9) - error {
                    return Err(format!("a box is not inside body {k}: {common:?}"));
                }
            }
            _ => return Err("an unknown kind of inner bodies".to_owned()),
        }
    }
    Ok(())
}

/// Draws a setting of a family, computes the answers, and judges them.
///
/// # Errors
/// A description of the first disagreement.
pub fn examine(family: &str, seed: u64, tally: &mut Tally) -> Result<(), String> {
    let random = &mut Random::stream(seed, &[family.len() as u64, 0xde97]);
    match family {
        "convex" => return examine_convex(false, random, tally),
        "pieces" => return examine_convex(true, random, tally),
        _ => {}
    }
    let hollow = |random: &mut Random| {
        let body = Cells::random(random.int(1, 3) as usize, random);
        let open = random.int(0, 2) as usize;
        body.mould(random.one_in(3).then_some(open))
    };
    let count = random.int(1, 8) as usize;
    let moving = Cells::random(count, random);
    let fixed = match family {
        "cubes" | "rotated" => Cells::random(random.int(1, 8) as usize, random),
        "hollow" => hollow(random),
        "nested" => filled_box(random),
        _ => return Err(format!("unknown family {family}")),
    };
    let (moving, fixed) = if random.one_in(4) { (fixed, moving) } else { (moving, fixed) };
    let by = if random.one_in(4) { random.grid(-2, 2) * UNIT as f64 } else { random.grid(-9, 9) };
    let rotation = if family == "rotated" { random.rotation() } else { glam::DQuat::IDENTITY };
    let mut are_plain = true;
    let mut solids = Vec::new();
    for body in [&moving, &fixed] {
        let in_pieces = random.one_in(4);
        are_plain &= !in_pieces;
        match solid(body, in_pieces, random) {
            Some(solid) => solids.push(solid),
            None => return Ok(()),
        }
    }
    tally.count("settings");
    let exact = Exact { moving: &moving, fixed: &fixed, by: by.to_array().map(|c| c as i64) };
    let pose = |by: DVec3| Pose::new(rotation, rotation * by).map_err(|e| e.to_string());
    let placed = [pose(by / UNIT as f64)?, pose(DVec3::ZERO)?];
    let pair = Pair::new(solids[0].at(placed[0]), solids[1].at(placed[1]));
    let error = if family == "rotated" { ROTATED } else { 0.0 };
    if error > 0.0 && exact.volume() == 0 && exact.touch() {
        // The rounded rotation decides whether the bodies touch or overlap.
        return Ok(());
    }
    exact.judge(&pair.map_err(|e| e.to_string())?, error, are_plain, tally)
}

/// Draws a box of cubes, in half of the cases without one cube inside.
fn filled_box(random: &mut Random) -> Cells {
    let sides = [0; 3].map(|_| random.int(3, 5) as i32);
    let cells = (0..sides.iter().product::<i32>())
        .map(|k| [k % sides[0], k / sides[0] % sides[1], k / (sides[0] * sides[1])].map(|c| c - 2));
    let left_out = random.one_in(2).then_some([-1; 3]);
    Cells(cells.filter(|cell| Some(*cell) != left_out).collect())
}

/// Builds the solid of a body of cubes, also as a union of the cubes. `None` if its surface is rejected because cubes
/// share only an edge.
fn solid(body: &Cells, in_pieces: bool, random: &mut Random) -> Option<Solid> {
    if in_pieces {
        let cubes: Option<Vec<ConvexPolyhedron>> = body
            .0
            .iter()
            .map(|cell| {
                let low = DVec3::from_array(cell.map(f64::from));
                ConvexPolyhedron::cuboid(low, low + 1.0).ok()
            })
            .collect();
        return Solid::from_pieces(&cubes?).ok();
    }
    let (vertices, facets) = body.surface(DMat3::IDENTITY, random);
    Solid::from_mesh(&vertices, &facets).ok()
}

/// Draws two convex bodies, and judges the answers for them as solids, or as unions of each body with itself.
fn examine_convex(in_pieces: bool, random: &mut Random, tally: &mut Tally) -> Result<(), String> {
    let message = |e: &dyn std::error::Error| e.to_string();
    let mut hulls = Vec::new();
    for _ in 0..2 {
        let half = DVec3::new(1.0, random.range(0.5, 1.0), random.pick(&[0.001, 0.1, 1.0]));
        let points = match random.int(0, 2) {
            0 => {
                let corner = |k: u32| {
                    DVec3::from_array([0, 1, 2].map(|a| if k >> a & 1 == 1 { 1.0 } else { -1.0 }))
                };
                (0..8).map(|k| corner(k) * half).collect()
            }
            1 => prism(random.int(3, 9) as usize, half.z).vertices,
            _ => (0..random.int(5, 14)).map(|_| random.vector()).collect::<Vec<DVec3>>(),
        };
        hulls.push(ConvexPolyhedron::from_points(&points).map_err(|e| message(&e))?);
    }
    let place = |random: &mut Random, by: f64| {
        Pose::new(random.rotation(), random.vector() * by).map_err(|e| message(&e))
    };
    let poses = [place(random, 1.0)?, place(random, 0.3)?];
    let convex =
        Pair::new(hulls[0].at(poses[0]), hulls[1].at(poses[1])).map_err(|e| message(&e))?;
    let exact = convex.depth().map_err(|e| message(&e))?;
    let mut solids = Vec::new();
    for hull in &hulls {
        let Ok(solid) = Solid::from_convex(hull) else { return Ok(()) };
        let solid = if in_pieces { Solid::from_pieces([&solid, &solid]) } else { Ok(solid) };
        solids.push(solid.map_err(|e| message(&e))?);
    }
    tally.count("settings");
    let pair =
        Pair::new(solids[0].at(poses[0]), solids[1].at(poses[1])).map_err(|e| message(&e))?;
    let common = pair.common_part(VolumeOptions::default()).map_err(|e| message(&e))?;
    let depth = pair.depth().map_err(|e| message(&e))?;
    let volume = common_volume([&hulls[0], &hulls[1]], &poses);
    let say =
        |what: String| Err(format!("{what}: {common:?}, {depth:?}, volume {volume}, {exact:?}"));
    count_relation(&common, tally);
    tally.count_if("coarse", !common.is_accurate);
    let error = CONVEX_VOLUME;
    if common.volume[0] > volume + error || volume > common.volume[1] + error {
        return say("volume".to_owned());
    }
    if depth.lower > exact.upper || exact.lower > depth.upper {
        return say("depth".to_owned());
    }
    if exact.lower > 0.0 {
        tally.count_if("upper met", depth.upper <= exact.upper + 1e-9);
        tally.count_if("lower met", depth.lower >= exact.lower - 1e-9);
        tally.count_if("lower 98 %", depth.lower >= 0.98 * exact.lower);
    }
    judge_common(&pair, &common).or_else(say)?;
    judge_depth(&pair, &depth, error).or_else(say)
}

/// Returns the volume of the common part of two placed convex bodies, from the hull of its vertices.
fn common_volume(hulls: [&ConvexPolyhedron; 2], poses: &[Pose; 2]) -> f64 {
    let placed = [0, 1].map(|k| {
        let vertices: Vec<DVec3> =
            hulls[k].vertices().iter().map(|v| poses[k].transform_point(*v)).collect();
        let faces: Vec<Vec<u32>> = (0..hulls[k].face_count() as u32)
            .map(|face| hulls[k].face_vertices(face).collect())
            .collect();
        let planes: Vec<(DVec3, f64)> = (0..hulls[k].face_count() as u32)
            .map(|face| {
                let normal = poses[k].matrix() * hulls[k].face_normal(face);
                let top = faces[face as usize].iter().map(|v| normal.dot(vertices[*v as usize]));
                (normal, top.fold(f64::NEG_INFINITY, f64::max))
            })
            .collect();
        (vertices, faces, planes)
    });
    let mut corners = Vec::new();
    for k in 0..2 {
        let (vertices, faces, _) = &placed[k];
        let planes = &placed[1 - k].2;
        let is_inside = |p: DVec3| planes.iter().all(|(normal, top)| normal.dot(p) <= top + 1e-13);
        corners.extend(vertices.iter().copied().filter(|p| is_inside(*p)));
        for face in faces {
            for (i, &v) in face.iter().enumerate() {
                let ends = [vertices[v as usize], vertices[face[(i + 1) % face.len()] as usize]];
                for (normal, top) in planes {
                    let [from, to] = ends.map(|p| normal.dot(p) - top);
                    if from < 0.0 && to > 0.0 {
                        let p = ends[0] + (ends[1] - ends[0]) * (from / (from - to));
                        if is_inside(p) {
                            corners.push(p);
                        }
                    }
                }
            }
        }
    }
    let hull = ConvexPolyhedron::from_points(&corners).ok();
    let solid =
        hull.filter(|hull| hull.dimension() == 3).and_then(|hull| Solid::from_convex(&hull).ok());
    solid.map_or(0.0, |solid| solid.volume())
}
