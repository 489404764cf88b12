//! Builds meshes of bodies that are not convex: turned parts, threads, plates, bumpy balls. Polygons are
//! counter-clockwise seen from outside.

use std::collections::HashMap;
use std::f64::consts::TAU;

use glam::DVec3;

use crate::shapes::{Mesh, extruded};

/// Boxes, by their low and high corners, of a room from -2.2 to 2.2 with a window in its wall towards x.
pub const ROOM_WITH_WINDOW: [[[f64; 3]; 2]; 9] = [
    [[-2.2, -2.2, -2.2], [2.2, 2.2, -2.0]],
    [[-2.2, -2.2, 2.0], [2.2, 2.2, 2.2]],
    [[-2.2, -2.2, -2.2], [-2.0, 2.2, 2.2]],
    [[-2.2, -2.2, -2.2], [2.2, -2.0, 2.2]],
    [[-2.2, 2.0, -2.2], [2.2, 2.2, 2.2]],
    [[2.0, -2.2, -2.2], [2.2, 2.2, 0.5]],
    [[2.0, -2.2, 1.3], [2.2, 2.2, 2.2]],
    [[2.0, -2.2, -2.2], [2.2, -0.8, 2.2]],
    [[2.0, 0.8, -2.2], [2.2, 2.2, 2.2]],
];

/// Boxes, by their low and high corners, of a tray with grooves for a lid, which slides along x up to a stop.
pub const TRAY_WITH_GROOVES: [[[f64; 3]; 2]; 10] = [
    [[-1.0, -1.0, -1.0], [5.0, 4.0, 0.0]],
    [[-1.0, -1.0, 0.0], [0.0, 4.0, 3.5]],
    [[4.0, -1.0, 0.0], [5.0, 4.0, 2.0]],
    [[0.0, -1.0, 0.0], [4.0, 0.0, 2.0]],
    [[0.0, 3.0, 0.0], [4.0, 4.0, 2.0]],
    [[-1.0, -1.0, 2.0], [9.0, -0.5, 4.0]],
    [[-1.0, 3.5, 2.0], [9.0, 4.0, 4.0]],
    [[-1.0, -0.5, 3.0], [9.0, 0.0, 4.0]],
    [[-1.0, 3.0, 3.0], [9.0, 3.5, 4.0]],
    [[8.5, -1.0, 2.0], [9.0, 4.0, 4.0]],
];

/// Builds a solid of revolution about `z` with `sides` sides. The closed profile of points `[radius, height]`
/// is counter-clockwise, with radii to the right and heights upwards. Points with radius 0 are on the axis.
///
/// Side `k` has its corner at the angle `TAU k / sides`. The corners are on the circle.
pub fn turned(profile: &[[f64; 2]], sides: usize) -> Mesh {
    let mut surface = Mesh::default();
    let mut rings: Vec<Vec<u32>> = Vec::new();
    for &[radius, height] in profile {
        let first = surface.vertices.len() as u32;
        if radius == 0.0 {
            surface.vertices.push(DVec3::new(0.0, 0.0, height));
            rings.push(vec![first; sides]);
            continue;
        }
        for k in 0..sides {
            let angle_rad = TAU * k as f64 / sides as f64;
            let (sine, cosine) = angle_rad.sin_cos();
            surface.vertices.push(DVec3::new(radius * cosine, radius * sine, height));
        }
        rings.push((first..first + sides as u32).collect());
    }
    for i in 0..rings.len() {
        let (low, high) = (&rings[i], &rings[(i + 1) % rings.len()]);
        for k in 0..sides {
            let l = (k + 1) % sides;
            let mut corners = vec![low[k], low[l], high[l], high[k]];
            corners.dedup();
            if corners.first() == corners.last() {
                corners.pop();
            }
            if corners.len() >= 3 {
                surface.faces.push(corners);
            }
        }
    }
    surface
}

/// Builds a cylinder with a radius between two heights.
pub fn pin(radius: f64, [low, high]: [f64; 2], sides: usize) -> Mesh {
    turned(&[[0.0, low], [radius, low], [radius, high], [0.0, high]], sides)
}

/// Builds a round plate with a round hole along its axis.
pub fn washer([hole, outside]: [f64; 2], [low, high]: [f64; 2], sides: usize) -> Mesh {
    turned(&[[hole, low], [outside, low], [outside, high], [hole, high]], sides)
}

/// Builds a bolt: a shaft from `low` to `seat`, and a head from there to `top`.
pub fn bolt([shaft, head]: [f64; 2], [low, seat, top]: [f64; 3], sides: usize) -> Mesh {
    let profile = [[0.0, low], [shaft, low], [shaft, seat], [head, seat], [head, top], [0.0, top]];
    turned(&profile, sides)
}

/// Builds a threaded rod about `z`, or a nut if there is an outer radius. At the angle `a` and the height `z`
/// the surface of the thread has the radius `radius + depth cos (TAU z / pitch - a)`. It has `sides` sides and
/// `rows` rows along the axis.
pub fn thread(
    [radius, depth, pitch]: [f64; 3],
    [low, high]: [f64; 2],
    [sides, rows]: [usize; 2],
    outer: Option<f64>,
) -> Mesh {
    let mut surface = Mesh::default();
    let mut ring = |height: f64, of: &dyn Fn(f64) -> f64| {
        for k in 0..sides {
            let angle_rad = TAU * k as f64 / sides as f64;
            let (sine, cosine) = angle_rad.sin_cos();
            let r = of(angle_rad);
            surface.vertices.push(DVec3::new(r * cosine, r * sine, height));
        }
    };
    for j in 0..=rows {
        let z = low + (high - low) * j as f64 / rows as f64;
        ring(z, &|angle| radius + depth * (TAU * z / pitch - angle).cos());
    }
    if let Some(outer) = outer {
        ring(high, &|_| outer);
        ring(low, &|_| outer);
    }
    let rings = surface.vertices.len() / sides;
    let at = |ring: usize, k: usize| (ring % rings * sides + k % sides) as u32;
    // A rod ends with its last row. The rings of a nut form a cycle.
    for j in 0..if outer.is_some() { rings } else { rows } {
        for k in 0..sides {
            let [a, b, c, d] = [at(j, k), at(j, k + 1), at(j + 1, k + 1), at(j + 1, k)];
            surface.faces.extend([vec![a, b, c], vec![a, c, d]]);
        }
    }
    if outer.is_some() {
        return surface.reversed();
    }
    for (j, z) in [(0, low), (rows, high)] {
        let middle = surface.vertices.len() as u32;
        surface.vertices.push(DVec3::Z * z);
        for k in 0..sides {
            let [a, b] = if j == 0 { [k + 1, k] } else { [k, k + 1] };
            surface.faces.push(vec![at(j, a), at(j, b), middle]);
        }
    }
    surface
}

/// Builds a box whose six sides are grids of squares.
pub fn slab(low: DVec3, high: DVec3, counts: [usize; 3]) -> Mesh {
    let mut surface = Mesh::default();
    let mut index: HashMap<[usize; 3], u32> = HashMap::new();
    let size = high - low;
    for (axis, up) in [(0, false), (0, true), (1, false), (1, true), (2, false), (2, true)] {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        for a in 0..counts[i] {
            for b in 0..counts[j] {
                let mut square: Vec<u32> = [(0, 0), (1, 0), (1, 1), (0, 1)]
                    .map(|(x, y)| {
                        let mut step = [0; 3];
                        (step[axis], step[i], step[j]) =
                            (if up { counts[axis] } else { 0 }, a + x, b + y);
                        *index.entry(step).or_insert_with(|| {
                            let share = |k: usize| step[k] as f64 / counts[k] as f64;
                            let at = DVec3::new(share(0), share(1), share(2));
                            surface.vertices.push(low + at * size);
                            surface.vertices.len() as u32 - 1
                        })
                    })
                    .to_vec();
                if !up {
                    square.reverse();
                }
                surface.faces.push(square);
            }
        }
    }
    surface
}

/// Builds a ball of radius 1 with bumps. It has about `triangles` triangles, two for each square of six grids.
pub fn bumpy_ball(triangles: usize) -> Mesh {
    let n = ((triangles as f64 / 12.0).sqrt().round() as usize).max(1);
    let cube = slab(DVec3::NEG_ONE, DVec3::ONE, [n; 3]);
    let bump = |v: DVec3| {
        let p = v.normalize();
        let waves = (7.0 * p.x + 1.0).sin() * (6.0 * p.y + 2.0).sin() * (5.0 * p.z).cos();
        p * (1.0 + 0.2 * waves + 0.02 * (31.0 * p.x).sin() * (29.0 * p.z).cos())
    };
    cube.mapped(bump).triangulated()
}

/// Returns the outline of a comb in `x, y`: teeth of width 1 and length 4, at distances of 1, on a bar of
/// height 1.
pub fn comb_outline(teeth: usize) -> Vec<DVec3> {
    let tooth = |x: f64| [[x + 1.0, 1.0], [x + 1.0, 5.0], [x, 5.0], [x, 1.0]];
    let bar = [[0.0, 0.0], [2.0 * teeth as f64 - 1.0, 0.0]];
    let corners = bar.into_iter().chain((0..teeth).rev().flat_map(|k| tooth(2.0 * k as f64)));
    corners.map(|[x, y]| DVec3::new(x, y, 0.0)).collect()
}

/// Builds a comb of height 1. Each cap is a fan of long triangles from one corner of the bar, and two triangles
/// for each tooth.
pub fn comb(teeth: usize) -> Mesh {
    let mut comb = extruded(&comb_outline(teeth), [0.0, 1.0]);
    let walls = comb.faces.split_off(2);
    let tooth = |k: u32| [2, 3, 4, 5].map(|corner| 4 * k + corner);
    let teeth = 0..teeth as u32;
    let roots = teeth.clone().map(tooth).flat_map(|[a, .., d]| [a, d]);
    let roots: Vec<u32> = [1].into_iter().chain(roots).collect();
    let fan = roots.windows(2).map(|pair| [0, pair[0], pair[1]]);
    let above = comb.vertices.len() as u32 / 2;
    let cap = fan.chain(teeth.map(tooth).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]));
    comb.faces = cap
        .flat_map(|[a, b, c]| [[c, b, a], [a, b, c].map(|v| v + above)])
        .map(Vec::from)
        .collect();
    comb.faces.extend(walls);
    comb
}

/// Builds a plate in `x, y` with a grid of round holes, in long thin faces as CAD programs write them. Each
/// hole is connected only to the nearest corners of its square.
pub fn perforated_plate(holes: [usize; 2], thickness: f64, sides: usize) -> Mesh {
    let quarter = (sides / 4).max(1);
    let sides = 4 * quarter;
    let mut surface = Mesh::default();
    let mut index: HashMap<[u64; 3], u32> = HashMap::new();
    let mut vertex = |surface: &mut Mesh, p: DVec3| {
        *index.entry(p.to_array().map(|c| (c + 0.0).to_bits())).or_insert_with(|| {
            surface.vertices.push(p);
            surface.vertices.len() as u32 - 1
        })
    };
    for cell in 0..holes[0] * holes[1] {
        let (i, j) = (cell % holes[0], cell / holes[0]);
        let center = DVec3::new(i as f64 + 0.5, j as f64 + 0.5, 0.0);
        let corner = |k: usize| {
            let (x, y) = [(1, 1), (0, 1), (0, 0), (1, 0)][k % 4];
            DVec3::new((i + x) as f64, (j + y) as f64, 0.0)
        };
        let rim = |k: usize| {
            let (sine, cosine) = (TAU * (k % sides) as f64 / sides as f64).sin_cos();
            center + DVec3::new(0.35 * cosine, 0.35 * sine, 0.0)
        };
        let mut flat: Vec<[DVec3; 3]> = Vec::new();
        for side in 0..4 {
            // The corner between this quarter of the hole's boundary and the next side of the square.
            for k in side * quarter..(side + 1) * quarter {
                flat.push([rim(k), corner(side), rim(k + 1)]);
            }
            flat.push([rim((side + 1) * quarter), corner(side), corner(side + 1)]);
        }
        for triangle in flat {
            let top = triangle.map(|p| vertex(&mut surface, p + DVec3::Z * thickness));
            let bottom = triangle.map(|p| vertex(&mut surface, p));
            surface.faces.push(top.to_vec());
            surface.faces.push(vec![bottom[0], bottom[2], bottom[1]]);
        }
        for k in 0..sides {
            let wall = [rim(k), rim(k), rim(k + 1), rim(k + 1)];
            let wall = [0, 1, 2, 3].map(|m| {
                let lift = if m == 1 || m == 2 { thickness } else { 0.0 };
                vertex(&mut surface, wall[m] + DVec3::Z * lift)
            });
            surface.faces.push(vec![wall[0], wall[1], wall[2], wall[3]]);
        }
        for side in 0..4 {
            let (dx, dy) = [(0, 1), (-1, 0), (0, -1), (1, 0)][side];
            let beyond = |at: usize, d: i32, count: usize| {
                d != 0 && (at as i32 + d < 0 || at as i32 + d >= count as i32)
            };
            if beyond(i, dx, holes[0]) || beyond(j, dy, holes[1]) {
                let (a, b) = (corner(side), corner(side + 1));
                let up = DVec3::Z * thickness;
                let wall = [a, b, b + up, a + up].map(|p| vertex(&mut surface, p));
                surface.faces.push(wall.to_vec());
            }
        }
    }
    surface
}
