//! Builds machines with a known disassembly order: flanges, a radial engine, a block with threaded screws, and
//! a table with screwed-in legs. All parts are named and in their assembled position, with `z` upwards. Fits
//! have no clearance: both sides have the same corners.
//!
//! Notation: an *outline* is a polygon in `x, y`, counter-clockwise. A *loop* is a polygon in space.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use earcut::Earcut;
use glam::{DMat3, DVec2, DVec3};

use crate::shapes::{Mesh, helical};

/// A name and the bodies of a part, mostly one.
pub type NamedPart = (String, Vec<Mesh>);

/// Number of sides of round features, except on flanges.
const SIDES: usize = 32;

/// Builds two flanges with a gasket, held by `bolts` bolts with washers and nuts. Round features have `sides`
/// sides. The disassembly order is: the bolts upwards, the washers, the upper flange and the gasket. The nuts
/// go down, and the lower flange stays.
pub fn flange(bolts: usize, sides: usize) -> Vec<NamedPart> {
    let circle = (14.0 * bolts as f64 / TAU).max(40.0);
    let at = |k: usize| DVec2::from_angle(TAU * k as f64 / bolts as f64) * circle;
    let around = (4 * bolts).max(2 * sides);
    let plate = |[inner, outer]: [f64; 2], [low, high]: [f64; 2]| {
        let mut holes = vec![regular_polygon(inner, around)];
        holes.extend((0..bolts).map(|k| translated_outline(&regular_polygon(3.0, sides), at(k))));
        stack_prisms(low, &[(regular_polygon(outer, around), high)], &holes)
    };
    let mut parts: Vec<NamedPart> = vec![
        ("lower".into(), vec![plate([circle - 20.0, circle + 12.0], [-12.0, 0.0])]),
        ("gasket".into(), vec![plate([circle - 16.0, circle + 8.0], [0.0, 2.0])]),
        ("upper".into(), vec![plate([circle - 20.0, circle + 12.0], [2.0, 14.0])]),
    ];
    let bolt = stack_prisms(
        -20.0,
        &[(regular_polygon(3.0, sides), 15.0), (regular_polygon(5.5, 6), 19.0)],
        &[],
    );
    let washer =
        stack_prisms(14.0, &[(regular_polygon(6.0, sides), 15.0)], &[regular_polygon(3.0, sides)]);
    let nut =
        stack_prisms(-17.0, &[(regular_polygon(5.5, 6), -12.0)], &[regular_polygon(3.0, sides)]);
    for k in 0..bolts {
        let place = |mesh: &Mesh| vec![mesh.clone().translated(at(k).extend(0.0))];
        parts.push((format!("bolt_{k}"), place(&bolt)));
        parts.push((format!("washer_{k}"), place(&washer)));
        parts.push((format!("nut_{k}"), place(&nut)));
    }
    parts
}

/// Builds a radial engine with its shaft along `z`, and a cover held by one bolt per cylinder. For each
/// cylinder the order is: head, barrel, the pin along the shaft, piston, rod. The shaft comes after the cover,
/// and the cover after its bolts. The case stays.
pub fn radial_engine(cylinders: usize) -> Vec<NamedPart> {
    const DEPTH: f64 = 14.0;
    const CORNER: f64 = 1.0;
    const PIN: f64 = 2.5;
    let slope = (PI / cylinders as f64).tan();
    let inner = 13.0 / slope;
    let outer = inner + 6.0;
    let corner = |k: usize| {
        DVec2::from_angle(TAU * (k as f64 + 0.5) / cylinders as f64)
            * (f64::midpoint(inner, outer) * (1.0 + slope * slope).sqrt())
    };
    let screws: Vec<Vec<DVec2>> = (0..cylinders)
        .map(|k| translated_outline(&regular_polygon(CORNER, SIDES), corner(k)))
        .collect();
    let case = Drum {
        sides: cylinders,
        apothems: [inner, outer],
        heights: [-DEPTH, DEPTH],
        floor: 5.0,
        bore: (12.0, 0.0),
        bored: vec![true; cylinders],
        screws: screws.clone(),
    };
    let (rim, neck) = (polygon_with_apothem(outer, cylinders), regular_polygon(4.0, SIDES));
    let cover_holes: Vec<Vec<DVec2>> = std::iter::once(neck.clone()).chain(screws).collect();
    let cover = stack_prisms(DEPTH, &[(rim, DEPTH + 4.0)], &cover_holes);
    let hub = 6.0 * cylinders as f64 / TAU + 2.0;
    let shaft = stack_prisms(
        -DEPTH,
        &[(polygon_with_apothem(hub, cylinders), 6.0), (neck, DEPTH + 20.0)],
        &[],
    );
    let mut parts: Vec<NamedPart> = vec![
        ("case".into(), vec![case.mesh()]),
        ("cover".into(), vec![cover]),
        ("shaft".into(), vec![shaft]),
    ];
    let screw =
        [(regular_polygon(CORNER, SIDES), DEPTH + 4.0), (regular_polygon(2.2, 6), DEPTH + 6.0)];
    let screw = stack_prisms(-DEPTH, &screw, &[]);
    // The following parts are built along their own axis `z`, with the pin along `x`.
    let seat = outer + 24.0;
    let bore = polygon_with_apothem(10.0, 8);
    let barrel = [(regular_polygon(12.0, SIDES), outer), (polygon_with_apothem(13.0, 8), seat)];
    let barrel = stack_prisms(inner + 1.0, &barrel, std::slice::from_ref(&bore));
    let head =
        stack_prisms(seat - 2.0, &[(bore, seat), (polygon_with_apothem(13.5, 8), seat + 4.0)], &[]);
    let pin_at = outer + 7.0;
    let piston = Drum {
        sides: 8,
        apothems: [7.0, 10.0],
        heights: [-(pin_at + 9.0), -(pin_at - 5.0)],
        floor: 3.0,
        bore: (PIN, -pin_at),
        bored: (0..8).map(|k| k % 4 == 0).collect(),
        screws: Vec::new(),
    };
    // A drum has its floor below, a piston above.
    let piston = piston.mesh().mapped(|p| DVec3::new(p.x, -p.y, -p.z));
    let upright = |p: DVec3| DVec3::new(p.z, p.x, p.y);
    let pin = stack_prisms(-9.0, &[(regular_polygon(PIN, SIDES), 9.0)], &[]).mapped(upright);
    let pin = pin.translated(DVec3::Z * pin_at);
    let rod = stack_prisms(
        -3.0,
        &[(rod_outline(hub, pin_at), 3.0)],
        &[translated_outline(&regular_polygon(PIN, SIDES), DVec2::Y * pin_at)],
    );
    let rod = rod.mapped(upright);
    for k in 0..cylinders {
        let angle = TAU * k as f64 / cylinders as f64;
        let out = DVec3::new(angle.cos(), angle.sin(), 0.0);
        let place = DMat3::from_cols(DVec3::Z, out.cross(DVec3::Z), out);
        let mut add = |name: &str, mesh: &Mesh| {
            parts.push((format!("{name}_{k}"), vec![mesh.clone().mapped(|p| place * p)]));
        };
        add("head", &head);
        add("barrel", &barrel);
        add("piston", &piston);
        add("pin", &pin);
        add("rod", &rod);
        let at = corner(k).extend(0.0);
        parts.push((format!("screw_{k}"), vec![screw.clone().translated(at)]));
    }
    parts
}

/// Builds a cap on a base, around a shaft, held by two screws. Their threads of two turns are in inserts, which
/// are bodies of the base. The screws are unscrewed, then the cap and the shaft are lifted.
pub fn threaded_block() -> Vec<NamedPart> {
    let wave = |phase: f64| 1.0 - (2.0 * phase - 1.0).abs();
    let at = |k: usize| DVec2::X * [14.0, -14.0][k];
    let holes = |radius: f64, sides: usize| -> Vec<Vec<DVec2>> {
        (0..2).map(|k| translated_outline(&regular_polygon(radius, sides), at(k))).collect()
    };
    let square = |x: f64, y: f64| -> Vec<DVec2> {
        [[-x, -y], [x, -y], [x, y], [-x, y]].map(DVec2::from_array).to_vec()
    };
    let insert = helical(Some(4.0), |phase| 2.5 + 0.05 + 0.3 * wave(phase), 2.0, 2);
    let mut base = vec![stack_prisms(0.0, &[(square(30.0, 22.0), 4.0)], &holes(4.0, 24))];
    let mut screws = Vec::new();
    for k in 0..2 {
        let place = at(k).extend(0.0);
        base.push(insert.clone().translated(place));
        let thread = helical(None, |phase| 2.5 + 0.3 * wave(phase), 2.0, 2);
        let shank = stack_prisms(
            4.0,
            &[(regular_polygon(2.4, SIDES), 10.0), (regular_polygon(4.5, 6), 13.0)],
            &[],
        );
        screws
            .push((format!("screw_{k}"), vec![thread.translated(place), shank.translated(place)]));
    }
    let along_y = |p: DVec3| DVec3::new(p.x, -p.z, p.y);
    let arch = [
        [8.0, 4.0],
        [8.0, 10.0],
        [-8.0, 10.0],
        [-8.0, 4.0],
        [-4.0, 4.0],
        [-4.0, 8.0],
        [4.0, 8.0],
        [4.0, 4.0],
    ];
    let arch: Vec<DVec2> = arch.map(DVec2::from_array).to_vec();
    let middle = stack_prisms(-16.0, &[(arch, 16.0)], &[]).mapped(along_y);
    let ear = |side: f64| {
        let shifted = |hole: Vec<DVec2>| translated_outline(&hole, DVec2::new(-15.0 * side, 0.0));
        let own = |k: usize| at(k).x * side > 0.0;
        let holes = holes(3.0, SIDES).into_iter().enumerate().filter(|(k, _)| own(*k));
        let holes: Vec<_> = holes.map(|(_, hole)| shifted(hole)).collect();
        stack_prisms(4.0, &[(square(7.0, 16.0), 10.0)], &holes).translated(DVec3::X * 15.0 * side)
    };
    let bar =
        stack_prisms(-30.0, &[(translated_outline(&square(4.0, 2.0), DVec2::Y * 6.0), 30.0)], &[]);
    let mut parts = vec![
        ("base".into(), base),
        ("cap".into(), vec![middle, ear(1.0), ear(-1.0)]),
        ("shaft".into(), vec![bar.mapped(along_y)]),
    ];
    parts.extend(screws);
    parts
}

/// For each leg of [`screwed_table`] its rotation in turns and its lateral offset from the fitting position.
pub const TABLE_LEGS: [(f64, [f64; 2]); 4] =
    [(0.2, [0.0, 0.0]), (-0.3, [0.03, -0.02]), (0.45, [0.0, 0.05]), (-0.15, [-0.04, 0.0])];

/// Builds a table top with four legs. Each leg is screwed into an insert, which is a body of the top. The legs
/// are misplaced, so that threads overlap. The threads end within the common length. The legs are unscrewed,
/// and the top stays.
pub fn screwed_table() -> Vec<NamedPart> {
    let wave = |phase: f64| 1.0 - (2.0 * phase - 1.0).abs();
    let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
    let corners = corners.map(|corner| DVec2::from_array(corner) * 22.0);
    let holes = corners.map(|corner| translated_outline(&regular_polygon(4.0, 24), corner));
    let insert = helical(Some(4.0), |phase| 2.6 + 0.3 * wave(phase), 2.0, 3);
    let thread = helical(None, |phase| 2.5 + 0.3 * wave(phase), 2.0, 2);
    let leg = stack_prisms(
        -35.0,
        &[(polygon_with_apothem(4.5, 4), 0.0), (regular_polygon(2.4, SIDES), 5.5)],
        &[],
    );
    let mut top = vec![stack_prisms(0.0, &[(polygon_with_apothem(30.0, 4), 6.0)], &holes)];
    let mut legs = Vec::new();
    for (k, (by, aside)) in TABLE_LEGS.into_iter().enumerate() {
        let at = corners[k].extend(0.0);
        top.push(insert.clone().translated(at));
        let turned = DMat3::from_rotation_z(TAU * by);
        let place = |mesh: &Mesh| {
            let aside = DVec2::from_array(aside).extend(0.0);
            mesh.clone().mapped(|p| turned * p).translated(at + aside)
        };
        legs.push((format!("leg_{k}"), vec![place(&thread), place(&leg)]));
    }
    let mut parts = vec![("top".into(), top)];
    parts.extend(legs);
    parts
}

/// Returns the outline of a rod, from its foot at the height `foot` to a round eye at the height `eye`.
fn rod_outline(foot: f64, eye: f64) -> Vec<DVec2> {
    const EYE: f64 = 5.0;
    let steps = 24;
    let arc = (0..=steps).map(|k| {
        let angle = PI * (-1.0 / 3.0 + 5.0 / 3.0 * f64::from(k) / f64::from(steps));
        DVec2::from_angle(angle) * EYE + DVec2::Y * eye
    });
    [DVec2::new(-2.5, foot), DVec2::new(2.5, foot)].into_iter().chain(arc).collect()
}

/// Returns the corners of a regular polygon with this circumradius. The first one is on the `x` axis.
fn regular_polygon(radius: f64, sides: usize) -> Vec<DVec2> {
    (0..sides).map(|k| DVec2::from_angle(TAU * k as f64 / sides as f64) * radius).collect()
}

/// Returns a regular polygon whose sides have this distance from the centre. The first side crosses the `x`
/// axis.
fn polygon_with_apothem(apothem: f64, sides: usize) -> Vec<DVec2> {
    let radius = apothem / (PI / sides as f64).cos();
    let angle = |k: usize| TAU * (k as f64 - 0.5) / sides as f64;
    (0..sides).map(|k| DVec2::from_angle(angle(k)) * radius).collect()
}

/// Returns an outline translated by a vector.
fn translated_outline(outline: &[DVec2], by: DVec2) -> Vec<DVec2> {
    outline.iter().map(|p| *p + by).collect()
}

/// Returns an outline as a loop at the height `z`.
fn loop_at_height(outline: &[DVec2], z: f64) -> Vec<DVec3> {
    outline.iter().map(|p| p.extend(z)).collect()
}

/// Returns a loop in the opposite direction.
fn reversed_loop(mut loops: Vec<DVec3>) -> Vec<DVec3> {
    loops.reverse();
    loops
}

/// Builds a stack of prisms from a height upwards, each with an outline and an upper end, with holes through
/// all of them. Of two consecutive outlines, one contains the other.
fn stack_prisms(mut low: f64, prisms: &[(Vec<DVec2>, f64)], holes: &[Vec<DVec2>]) -> Mesh {
    let mut made = Surface::default();
    let through =
        |z: f64| -> Vec<Vec<DVec3>> { holes.iter().map(|hole| loop_at_height(hole, z)).collect() };
    let bottom = low;
    made.face(&reversed_loop(loop_at_height(&prisms[0].0, low)), &through(low));
    for (k, (outline, high)) in prisms.iter().enumerate() {
        made.wall(&loop_at_height(outline, low), &loop_at_height(outline, *high));
        low = *high;
        match prisms.get(k + 1) {
            None => made.face(&loop_at_height(outline, low), &through(low)),
            Some((next, _)) if signed_area(next) > signed_area(outline) => {
                made.face(
                    &reversed_loop(loop_at_height(next, low)),
                    &[loop_at_height(outline, low)],
                );
            }
            Some((next, _)) => {
                made.face(&loop_at_height(outline, low), &[loop_at_height(next, low)]);
            }
        }
    }
    for hole in holes {
        made.wall(
            &reversed_loop(loop_at_height(hole, bottom)),
            &reversed_loop(loop_at_height(hole, low)),
        );
    }
    made.mesh
}

/// Returns the signed area.
fn signed_area(outline: &[DVec2]) -> f64 {
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>() / 2.0
}

/// Flat walls around `z` on a floor, with round holes through the middle of some walls.
struct Drum {
    sides: usize,
    /// The distances of the inner and outer sides of the walls from the axis.
    apothems: [f64; 2],
    /// The lower and the upper end of the walls, inside.
    heights: [f64; 2],
    /// The thickness of the floor.
    floor: f64,
    /// Radius and height of the holes.
    bore: (f64, f64),
    /// For each wall whether it has a hole.
    bored: Vec<bool>,
    /// Outlines of holes through walls and floor, along `z`.
    screws: Vec<Vec<DVec2>>,
}

impl Drum {
    /// Builds the mesh.
    fn mesh(&self) -> Mesh {
        let mut made = Surface::default();
        let [inner, outer] = self.apothems.map(|apothem| polygon_with_apothem(apothem, self.sides));
        let [low, high] = self.heights;
        let below = low - self.floor;
        let screws = |z: f64| -> Vec<Vec<DVec3>> {
            self.screws.iter().map(|hole| loop_at_height(hole, z)).collect()
        };
        let mut top = vec![loop_at_height(&inner, high)];
        top.extend(screws(high));
        made.face(&loop_at_height(&outer, high), &top);
        made.face(&reversed_loop(loop_at_height(&outer, below)), &screws(below));
        made.face(&loop_at_height(&inner, low), &[]);
        for hole in &self.screws {
            made.wall(
                &reversed_loop(loop_at_height(hole, below)),
                &reversed_loop(loop_at_height(hole, high)),
            );
        }
        for k in 0..self.sides {
            let next = (k + 1) % self.sides;
            let panel = |outline: &[DVec2], low: f64| {
                [(k, low), (next, low), (next, high), (k, high)]
                    .map(|(corner, z)| outline[corner].extend(z))
            };
            let out = DVec2::from_angle(TAU * k as f64 / self.sides as f64);
            let ring = |apothem: f64| -> Vec<DVec3> {
                let (radius, z) = self.bore;
                let across = out.perp().extend(0.0);
                let middle = (out * apothem).extend(z);
                let point = |p: DVec2| middle + across * p.x + DVec3::Z * p.y;
                regular_polygon(radius, SIDES).into_iter().map(point).collect()
            };
            let [near, far] = self.apothems.map(ring);
            let holes =
                |ring: &Vec<DVec3>| if self.bored[k] { vec![ring.clone()] } else { Vec::new() };
            made.face(&panel(&outer, below), &holes(&far));
            let mut inside = panel(&inner, low);
            inside.reverse();
            made.face(&inside, &holes(&near));
            if self.bored[k] {
                made.wall(&reversed_loop(near), &reversed_loop(far));
            }
        }
        made.mesh
    }
}

/// A closed surface while it is built. Vertices with equal coordinates are merged.
#[derive(Default)]
struct Surface {
    mesh: Mesh,
    known: HashMap<[u64; 3], u32>,
}

impl Surface {
    /// Returns the index of a vertex, which is added if it is new.
    fn vertex(&mut self, p: DVec3) -> u32 {
        // Adding zero converts -0 to 0.
        let p = p + DVec3::ZERO;
        *self.known.entry(p.to_array().map(f64::to_bits)).or_insert_with(|| {
            self.mesh.vertices.push(p);
            self.mesh.vertices.len() as u32 - 1
        })
    }

    /// Adds a flat face with holes. The outer loop is counter-clockwise seen from outside.
    fn face(&mut self, outer: &[DVec3], holes: &[Vec<DVec3>]) {
        let next = outer.iter().cycle().skip(1);
        let normal: DVec3 =
            outer.iter().zip(next).map(|(a, b)| (a - outer[0]).cross(b - outer[0])).sum();
        let (u, v) = normal.normalize().any_orthonormal_pair();
        let points: Vec<DVec3> = outer.iter().chain(holes.iter().flatten()).copied().collect();
        let mut starts = Vec::new();
        let mut count = outer.len();
        for hole in holes {
            starts.push(count as u32);
            count += hole.len();
        }
        let mut corners: Vec<u32> = Vec::new();
        let flat = points.iter().map(|p| [p.dot(u), p.dot(v)]);
        Earcut::new().earcut(flat, &starts, &mut corners);
        for triangle in corners.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|k| points[triangle[k] as usize]);
            let outwards = (b - a).cross(c - a).dot(normal) > 0.0;
            let mut face = vec![self.vertex(a), self.vertex(b), self.vertex(c)];
            if !outwards {
                face.reverse();
            }
            self.mesh.faces.push(face);
        }
    }

    /// Adds flat quadrilaterals between two loops. Seen from outside, the first is below and runs to the right.
    fn wall(&mut self, low: &[DVec3], high: &[DVec3]) {
        for k in 0..low.len() {
            let next = (k + 1) % low.len();
            let quad = [low[k], low[next], high[next], high[k]].map(|p| self.vertex(p));
            self.mesh.faces.push(quad.to_vec());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_bodies_are_closed_with_positive_volume() {
        let engines = [radial_engine(5), radial_engine(9)];
        let threaded = [threaded_block(), screwed_table()];
        let machines = [flange(8, 32), flange(16, 24)].into_iter().chain(engines).chain(threaded);
        for (name, bodies) in machines.flatten() {
            for mesh in bodies {
                let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
                for [a, b, c] in mesh.triangles() {
                    for [from, to] in [[a, b], [b, c], [c, a]] {
                        *edges.entry([from.min(to), from.max(to)]).or_default() +=
                            if from < to { 1 } else { 1000 };
                    }
                }
                assert!(edges.values().all(|count| *count == 1001), "{name}");
                let at = |v: u32| mesh.vertices[v as usize];
                let volumes = mesh.triangles().map(|[a, b, c]| at(a).dot(at(b).cross(at(c))));
                assert!(volumes.sum::<f64>() > 0.0, "{name}");
            }
        }
    }
}
