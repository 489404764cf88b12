//! Hand tools that turn or spread fasteners, and whether they reach them.
//!
//! - Each fastener has the tools that fit it (module `table`), each at several *positions* of its lever. A position sweeps
//!   convex prisms: rods about the axis, and the lever over the angle that it turns at a time. All are extended along
//!   the axis by the way on which the fastener still turns.
//! - The prisms enclose the tool: their sides are tangents of its circles. They are tested exactly against the parts as
//!   drawn. A position is *free* if no part has a point in its prisms, other than the fastener and what lies inside the
//!   tool: the screw of a nut, the shaft of a circlip.
//! - The parts stay where they are until they are removed. Therefore the parts in the way of a position are found once.
//!   A tool reaches as soon as all of them are gone.
//!
//! Hands are not considered, nor a second tool that holds against the first one.

mod table;

use std::f64::consts::{PI, TAU};

use colltrans::solid::SolidCast;
use colltrans::{Aabb, Cast, ConvexPolyhedron, Pose, Solid};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::boxes::BoxTree;
use crate::fasteners::{Drive, Fastener, FastenerKind, Fasteners, Head, millimetres_per_unit};
use crate::part::Assembly;
use table::{Lever, Rod, ToolShape};

/// Number of sides of a prism around a cylinder, and of corners around the arc of a lever.
const SIDES: usize = 24;
/// Number of positions of a lever.
const POSITIONS: usize = 24;
/// Factor by which prisms are enlarged, above the rounding errors of their corners.
const ENLARGED: f64 = 1.0 + 1e-9;
/// Share of the height of a hexagon that a tool leaves free below it.
const HEXAGON_GAP: f64 = 0.1;
/// Cosine of the largest angle between the axis and a direction of removal.
const ALONG_AXIS: f64 = 0.99;
/// Share of the inner radius of a circlip within which a shaft is searched.
const WITHIN_RING: f64 = 0.9;

/// A tool for a fastener, from one side, and what is in its way.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FittingTool {
    /// Name with the size in millimetres, for example `hex key 4, short arm in the screw`.
    pub name: String,
    /// Unit direction from the fastener to the tool, in which the fastener leaves.
    pub direction: DVec3,
    /// For each position of its lever, the indices of the parts in the way, in increasing order. One empty list if the
    /// tool reaches at once; otherwise no list contains another one.
    pub blockers: Vec<Vec<usize>>,
}

/// The tools for the fasteners of an assembly.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tools {
    /// For each part, the tools that fit it, the most convenient first.
    of_part: Vec<Vec<FittingTool>>,
}

/// Whether a tool reaches a fastener.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ToolReach {
    /// Name of the tool: the first one that reaches, or else the one with the fewest parts in its way.
    pub tool: String,
    /// Indices of the parts in its way, in increasing order; empty if it is proven to reach.
    pub blockers: Vec<usize>,
}

impl ToolReach {
    /// Returns the tool and whether it reaches, for a text that says that this is about a tool.
    pub fn finding(&self, assembly: &Assembly) -> String {
        let (tool, names) = (&self.tool, assembly.part_names(&self.blockers).join(", "));
        match self.blockers.len() {
            0 => format!("{tool}; it reaches, which is proven"),
            1 => format!("no tool reaches: {names} is in the way of {tool}"),
            _ => format!("no tool reaches: {names} are in the way of {tool}"),
        }
    }

    /// Returns a description.
    pub fn describe(&self, assembly: &Assembly) -> String {
        let about = if self.blockers.is_empty() { "tool: " } else { "" };
        format!("{about}{}", self.finding(assembly))
    }
}

impl Tools {
    /// Finds the tools for all fasteners, and the parts in their way.
    pub fn find(assembly: &Assembly, fasteners: &Fasteners) -> Self {
        let boxes = assembly.parts().iter().map(|part| part.solid().bounds());
        let (tree, scale) = (BoxTree::new(boxes), millimetres_per_unit(assembly));
        let scene = Scene { assembly, fasteners, tree, scale };
        let of_part = |part: usize| {
            fasteners.get(part).map_or_else(Vec::new, |own| scene.fitting_tools(part, own))
        };
        Self { of_part: (0..assembly.parts().len()).into_par_iter().map(of_part).collect() }
    }

    /// Returns the tools that fit a part, the most convenient first; empty if it needs none.
    pub fn fitting(&self, part: usize) -> &[FittingTool] {
        self.of_part.get(part).map_or(&[], |tools| &tools[..])
    }

    /// Finds a tool that reaches a fastener that leaves along a direction, among the parts that are present. Returns
    /// `None` if it needs no tool of the table, or leaves along another direction than that of its tools.
    pub fn reach(
        &self,
        part: usize,
        direction: DVec3,
        is_present: impl Fn(usize) -> bool,
    ) -> Option<ToolReach> {
        let mut best: Option<ToolReach> = None;
        let along = |tool: &&FittingTool| tool.direction.dot(direction) >= ALONG_AXIS;
        for tool in self.fitting(part).iter().filter(along) {
            for blockers in &tool.blockers {
                let blockers: Vec<usize> =
                    blockers.iter().copied().filter(|&other| is_present(other)).collect();
                if best.as_ref().is_none_or(|best| blockers.len() < best.blockers.len()) {
                    best = Some(ToolReach { tool: tool.name.clone(), blockers });
                }
            }
        }
        best
    }

    /// Returns for each fastener that no tool reaches at first the smallest set of parts that must leave before it so
    /// that one does, among the sets without parts that `stay` for it. Each pair has a part of the set first. Screws and
    /// nuts count if they hold parts.
    pub(crate) fn order_pairs(
        &self,
        fasteners: &Fasteners,
        stays: impl Fn(usize, usize) -> bool,
    ) -> Vec<[usize; 2]> {
        let holds = |part: usize| {
            fasteners.get(part).is_some_and(|of| of.kind == FastenerKind::Circlip)
                || fasteners.hold_of(part).is_some()
        };
        let smallest = |(own, tools): (usize, &Vec<FittingTool>)| {
            let sets = || tools.iter().flat_map(|tool| &tool.blockers);
            let may_leave = |set: &&Vec<usize>| !set.iter().any(|&other| stays(own, other));
            let least = sets().filter(may_leave).min_by_key(|set| set.len());
            least.into_iter().flatten().map(|&other| [other, own]).collect::<Vec<_>>()
        };
        let all = self.of_part.iter().enumerate();
        all.filter(|(part, tools)| !tools.is_empty() && holds(*part)).flat_map(smallest).collect()
    }
}

/// The place where a tool grips a fastener.
#[derive(Clone, Copy)]
struct Grip {
    /// Point on the axis, and the direction of the tool.
    point: DVec3,
    out: DVec3,
    /// Way on which the fastener still turns.
    way: f64,
}

/// The parts around fasteners.
struct Scene<'a> {
    assembly: &'a Assembly,
    fasteners: &'a Fasteners,
    /// Boxes of the parts as drawn.
    tree: BoxTree,
    /// Length of the unit in millimetres.
    scale: f64,
}

impl Scene<'_> {
    /// Returns the tools that fit a fastener, with the parts in their way.
    fn fitting_tools(&self, part: usize, fastener: &Fastener) -> Vec<FittingTool> {
        let ([origin, axis], [low, high], scale) = (fastener.axis, fastener.range, self.scale);
        let hold = self.fasteners.hold_of(part);
        let way = hold.map_or(0.0, |hold| hold.engaged.max(0.0));
        let grip = |at: f64, out: DVec3| Grip { point: origin + axis * at, out, way };
        let across = fastener.width * scale;
        let (shapes, grips, mut inside) = match fastener.kind {
            FastenerKind::Screw => {
                let is_outside =
                    fastener.drive.is_none() && fastener.head.is_some_and(Head::is_hexagonal);
                let gap = (1.0 - HEXAGON_GAP) * fastener.head_height;
                let at = if is_outside { high - gap } else { high };
                (screw_tools(fastener, scale), vec![grip(at, axis)], Vec::new())
            }
            FastenerKind::Nut => {
                let gap = HEXAGON_GAP * (high - low);
                let both = [grip(low + gap, axis), grip(high - gap, -axis)];
                // A nut leaves towards the tip of its screw.
                let screw = hold.map(|hold| hold.fastener);
                let head = screw.and_then(|screw| Some(self.fasteners.get(screw)?.axis[1]));
                let is_used = |grip: &Grip| head.is_none_or(|head| grip.out.dot(head) < 0.0);
                let sides = both.into_iter().filter(is_used).collect();
                (table::for_hexagon(across), sides, screw.into_iter().collect())
            }
            FastenerKind::Circlip => {
                let radius = WITHIN_RING * fastener.diameter * scale / 2.0;
                let bore = Rod { radius, range: [0.0, (high - low) * scale] };
                let start = Grip { way: 0.0, ..grip(low, axis) };
                let shaft = self.parts_in(&rod_prism(start, &bore, scale), &[part]);
                let shapes = table::for_circlip([fastener.diameter * scale, across]);
                (shapes, vec![grip(high, axis), grip(low, -axis)], shaft)
            }
            FastenerKind::Washer
            | FastenerKind::Dowel
            | FastenerKind::Key
            | FastenerKind::Bearing => return Vec::new(),
        };
        inside.push(part);
        let mut tools = Vec::new();
        for shape in &shapes {
            for &grip in &grips {
                let blockers = self.blockers(grip, shape, &inside);
                tools.push(FittingTool { name: shape.name.clone(), direction: grip.out, blockers });
            }
        }
        tools
    }

    /// Returns the parts in the way of each position of a tool: one empty list if a position is free, otherwise all
    /// lists that contain no other one. The parts `inside` the tool do not count.
    fn blockers(&self, grip: Grip, shape: &ToolShape, inside: &[usize]) -> Vec<Vec<usize>> {
        let scale = self.scale;
        let rods = shape.rods.iter().map(|rod| rod_prism(grip, rod, scale));
        let mut always: Vec<usize> = rods.flat_map(|rod| self.parts_in(&rod, inside)).collect();
        always.sort_unstable();
        always.dedup();
        let Some(lever) = shape.lever else { return vec![always] };
        // Parts beside the whole turn are beside each position.
        let reach = lever.length.hypot(lever.half_width);
        let turn = Rod { radius: reach, range: lever.range };
        let around = self.parts_in(&rod_prism(grip, &turn, scale), inside);
        if around.iter().all(|part| always.contains(part)) {
            return vec![always];
        }
        let contains = |all: &[usize], some: &[usize]| some.iter().all(|part| all.contains(part));
        let mut positions: Vec<Vec<usize>> = Vec::new();
        for k in 0..POSITIONS {
            let prism = lever_prism(grip, &lever, TAU * k as f64 / POSITIONS as f64, scale);
            let mut blockers = always.clone();
            let beside = around.iter().filter(|part| !always.contains(part));
            blockers.extend(beside.filter(|&&part| self.is_in(part, &prism)));
            blockers.sort_unstable();
            if blockers == always {
                return vec![blockers];
            }
            if !positions.iter().any(|known| contains(&blockers, known)) {
                positions.retain(|known| !contains(known, &blockers));
                positions.push(blockers);
            }
        }
        positions
    }

    /// Returns the parts that have a point in a prism, other than some.
    fn parts_in(&self, prism: &Prism, without: &[usize]) -> Vec<usize> {
        let mut near = self.tree.intersecting(&prism.bounds);
        near.retain(|part| !without.contains(part) && self.is_in(*part, prism));
        near
    }

    /// Checks whether a part has a point in a prism. A query without an answer counts as such a point.
    fn is_in(&self, part: usize, prism: &Prism) -> bool {
        let solid = self.assembly.parts()[part].solid();
        if !prism.bounds.intersects(&solid.bounds()) {
            return false;
        }
        let Some(tool) = &prism.body else { return true };
        let (tool, solid) = (tool.at(Pose::IDENTITY), solid.at(Pose::IDENTITY));
        // The test does not depend on the direction.
        let cast = <Cast<'_, Solid> as SolidCast>::between(tool, solid, DVec3::Z);
        cast.and_then(|cast| cast.intersects()).map_or(true, |found| found.meets)
    }
}

/// Returns the tools that turn a screw.
fn screw_tools(screw: &Fastener, scale: f64) -> Vec<ToolShape> {
    let head = screw.width * scale;
    match (screw.drive, screw.head) {
        (Some((drive, width)), _) => {
            let width = width * scale;
            match drive {
                Drive::HexSocket => table::for_hex_socket(width),
                Drive::Hexalobular => table::for_hexalobular(width),
                Drive::SquareSocket => table::for_square_socket(width),
                Drive::Cross => table::for_cross(screw.metric.unwrap_or(screw.diameter * scale)),
                Drive::Slot => table::for_slot(width, head),
            }
        }
        (None, Some(form)) if form.is_hexagonal() => table::for_hexagon(head),
        (None, Some(form)) => {
            screw.metric.map_or_else(Vec::new, |metric| table::for_plain_head(form, metric))
        }
        (None, None) => Vec::new(),
    }
}

/// A convex body in the world that encloses a part of a tool.
struct Prism {
    body: Option<ConvexPolyhedron>,
    bounds: Aabb,
}

impl Prism {
    /// Builds the prism over a polygon across the axis, in units of the files, between two heights.
    fn new(grip: Grip, polygon: &[DVec2], [low, high]: [f64; 2]) -> Self {
        let (x, y) = grip.out.any_orthonormal_pair();
        let height = (high - low).max(0.0);
        // Enlarged about its middle.
        let [low, high] = [low + height * (1.0 - ENLARGED), low + height * ENLARGED];
        let corner = |at: &DVec2, z: f64| grip.point + x * at.x + y * at.y + grip.out * z;
        let corners: Vec<DVec3> =
            polygon.iter().flat_map(|at| [corner(at, low), corner(at, high)]).collect();
        let bounds = Aabb::from_points(corners.iter().copied());
        Self { body: ConvexPolyhedron::from_points(&corners).ok(), bounds }
    }
}

/// Returns the prism around a rod, extended by the way of the fastener.
fn rod_prism(grip: Grip, rod: &Rod, scale: f64) -> Prism {
    let radius = rod.radius / scale * ENLARGED / (PI / SIDES as f64).cos();
    let ring: Vec<DVec2> =
        (0..SIDES).map(|k| DVec2::from_angle(TAU * k as f64 / SIDES as f64) * radius).collect();
    let [low, high] = rod.range.map(|z| z / scale);
    Prism::new(grip, &ring, [low, high + grip.way])
}

/// Returns the prism around a lever that turns from an angle on, extended by the way of the fastener.
fn lever_prism(grip: Grip, lever: &Lever, angle: f64, scale: f64) -> Prism {
    let [length, half] = [lever.length, lever.half_width].map(|x| x / scale * ENLARGED);
    let sweep = lever.degrees.to_radians();
    // All points of the lever at an angle are within a rectangle. Its corners at the end move on an arc.
    let reach = length.hypot(half);
    let ends = [angle, angle + sweep];
    let mut polygon: Vec<DVec2> = ends
        .iter()
        .flat_map(|&a| {
            let along = DVec2::from_angle(a);
            let side = along.perp() * half;
            [side, -side, along * length + side, along * length - side]
        })
        .collect();
    let spread = half.atan2(length);
    let [first, last] = [angle - spread, angle + sweep + spread];
    let step = (last - first) / SIDES as f64;
    // Tangents of the arc.
    let arc = (0..SIDES)
        .map(|k| DVec2::from_angle(first + (k as f64 + 0.5) * step) * (reach / (step / 2.0).cos()));
    polygon.extend(arc);
    let [low, high] = lever.range.map(|z| z / scale);
    Prism::new(grip, &polygon, [low, high + grip.way])
}

#[cfg(test)]
mod tests {
    use colltrans_mesh::Mesh;
    use colltrans_testkit::machines::flange;
    use colltrans_testkit::random::Random;
    use colltrans_testkit::shapes::block;
    use glam::{DAffine3, DQuat};

    use super::*;
    use crate::part::{Part, Piece};

    /// Checks by sampling whether a point, in the frame of a grip, is in a tool whose lever turns from an angle on. All
    /// lengths are enlarged by `more`.
    fn is_in_tool(at: DVec3, way: f64, shape: &ToolShape, angle: f64, more: f64) -> bool {
        let along = |[low, high]: [f64; 2]| (low - more..=high + way + more).contains(&at.z);
        let in_rod = |rod: &Rod| along(rod.range) && at.truncate().length() <= rod.radius + more;
        let in_lever = |lever: &Lever| {
            let steps = 20;
            let turned = |k: u32| {
                let sweep = lever.degrees.to_radians() * f64::from(k) / f64::from(steps);
                DVec2::from_angle(-(angle + sweep)).rotate(at.truncate())
            };
            let is_at = |p: DVec2| {
                (-more..=lever.length + more).contains(&p.x) && p.y.abs() <= lever.half_width + more
            };
            along(lever.range) && (0..=steps).map(turned).any(is_at)
        };
        shape.rods.iter().any(in_rod) || shape.lever.iter().any(in_lever)
    }

    fn corners_on_grid(low: DVec3, size: DVec3, step: f64) -> Vec<DVec3> {
        let count = (size / step).ceil();
        let axis = |k: usize| (0..=count[k] as u32).map(move |i| f64::from(i) / count[k]);
        let at = |x: f64, y: f64, z: f64| low + size * DVec3::new(x, y, z);
        axis(0).flat_map(|x| axis(1).flat_map(move |y| axis(2).map(move |z| at(x, y, z)))).collect()
    }

    #[test]
    fn blockers_enclose_those_of_sampled_tools() {
        let mut random = Random::new(31);
        let (bolt, named) = (flange(4, 24)[3].1[0].clone(), "bolt");
        let (mut free, mut blocked) = (0, 0);
        for round in 0..16 {
            let turn = DQuat::from_euler(
                glam::EulerRot::XYZ,
                random.range(-1.0, 1.0),
                random.range(-3.0, 3.0),
                random.range(-1.0, 1.0),
            );
            let world = DAffine3::from_rotation_translation(turn, random.vector() * 10.0);
            let placed =
                |name: String, vertices: Vec<DVec3>, faces: Vec<Vec<u32>>, world_from_piece| {
                    Part::new(name, &[Piece { mesh: Mesh::new(vertices, faces), world_from_piece }])
                };
            let mut parts = vec![
                placed(named.into(), bolt.vertices.clone(), bolt.faces.clone(), world).unwrap(),
            ];
            let fastener = Fastener::recognise(&parts[0], 1.0, &mut 0).expect("a screw");
            let [point, out] = fastener.axis;
            let way = random.range(0.0, 20.0);
            let at = point + out * random.range(fastener.range[0], fastener.range[1]);
            let grip = Grip { point: at, out, way };
            let (x, y) = out.any_orthonormal_pair();
            let frame = DAffine3::from_mat3_translation(glam::DMat3::from_cols(x, y, out), at);
            let mut boxes = Vec::new();
            for k in 0..4 {
                let size = DVec3::new(
                    random.range(6.0, 50.0),
                    random.range(6.0, 50.0),
                    random.range(6.0, 50.0),
                );
                let low = (random.vector() * 60.0 - size / 2.0) + DVec3::Z * 40.0;
                boxes.push(corners_on_grid(low, size, 3.0));
                let body = block(low, low + size);
                parts.push(placed(format!("box_{k}"), body.vertices, body.faces, frame).unwrap());
            }
            let assembly = Assembly::new(parts).unwrap();
            let fasteners = Fasteners::find(&assembly);
            let boxes_of_parts = assembly.parts().iter().map(|part| part.solid().bounds());
            let tree = BoxTree::new(boxes_of_parts);
            let scene = Scene { assembly: &assembly, fasteners: &fasteners, tree, scale: 1.0 };
            let mut shapes = table::for_hexagon(10.0);
            shapes.extend(table::for_hex_socket(5.0));
            shapes.extend(table::for_circlip([20.0, 26.0]));
            for shape in &shapes {
                let found = scene.blockers(grip, shape, &[0]);
                let hit = |angle: f64, more: f64| -> Vec<usize> {
                    let is_hit = |points: &Vec<DVec3>| {
                        points.iter().any(|at| is_in_tool(*at, way, shape, angle, more))
                    };
                    (0..boxes.len()).filter(|&k| is_hit(&boxes[k])).map(|k| k + 1).collect()
                };
                let within = |some: &[usize], all: &[usize]| some.iter().all(|k| all.contains(k));
                let angles = (0..POSITIONS).map(|k| TAU * k as f64 / POSITIONS as f64);
                let sampled: Vec<[Vec<usize>; 2]> = angles
                    .map(|angle| {
                        let more = 3.0 + 0.03 * shape.lever.map_or(0.0, |lever| lever.length);
                        [hit(angle, 0.0), hit(angle, more)]
                    })
                    .collect();
                let name = &shape.name;
                for set in &found {
                    assert!(
                        sampled.iter().any(|[least, most]| within(least, set) && within(set, most)),
                        "{round} {name}: {set:?} {sampled:?}"
                    );
                    *if set.is_empty() { &mut free } else { &mut blocked } += 1;
                }
                for [_, most] in &sampled {
                    assert!(found.iter().any(|set| within(set, most)), "{round} {name} {most:?}");
                }
            }
        }
        assert!(free > 20 && blocked > 30, "{free} {blocked}");
    }

    #[test]
    fn tools_are_those_of_the_standards() {
        let names = |all: Vec<ToolShape>| all.into_iter().map(|tool| tool.name).collect::<Vec<_>>();
        assert_eq!(
            names(table::for_hex_socket(4.0)),
            [
                "hex driver 4 x 150",
                "hex key 4, long arm in the screw",
                "hex key 4, short arm in the screw"
            ]
        );
        assert_eq!(
            names(table::for_cross(4.0)),
            ["cross driver PH2 x 100", "cross driver PH2 x 25"]
        );
        assert_eq!(names(table::for_slot(1.2, 7.0))[0], "slotted driver 6.5 x 150");
        assert_eq!(names(table::for_hexagon(13.0))[2], "ring spanner 13");
        assert!(names(table::for_hexalobular(4.5))[0].starts_with("hexalobular driver T25"));
    }
}
