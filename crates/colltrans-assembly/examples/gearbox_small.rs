//! Writes `data/gearbox_small`: a shaft with a gear, a spacer, a bush and a ball bearing in a housing with a bolted
//! cover; 16 parts, fits without clearance, in millimetres.
//!
//! `cargo run --release -p colltrans-assembly --example gearbox_small -- data/gearbox_small`

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;

use colltrans_mesh::{Mesh, write};
use glam::DVec3;

/// Number of sides of round shapes, equal for all so that fits are exact.
const SIDES: usize = 32;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "data/gearbox_small".into());
    std::fs::create_dir_all(&folder)?;
    for (name, mesh) in parts() {
        write(&mesh, Path::new(&folder).join(format!("{name}.off")))?;
    }
    Ok(())
}

/// Returns all parts with their names.
fn parts() -> Vec<(String, Mesh)> {
    let mut parts: Vec<(String, Mesh)> = vec![
        ("housing".into(), block(0.0, 30.0, Hole::new(10.0, 26.0), Hole::new(2.0, 14.0))),
        ("cover".into(), block(30.0, 34.0, Hole::new(4.0, 4.0), Hole::new(2.0, 4.0))),
        ("rear_bush".into(), ring(4.0, 10.0, 4.0, 9.0)),
        (
            "shaft".into(),
            solid_of_revolution(&[
                (0.0, 4.0),
                (4.0, 4.0),
                (4.0, 9.0),
                (6.0, 9.0),
                (6.0, 12.0),
                (4.0, 12.0),
                (4.0, 42.0),
                (0.0, 42.0),
            ]),
        ),
        ("gear".into(), gear(4.0, 7.6, 9.4, 12.0, 20.0)),
        ("spacer".into(), ring(4.0, 6.0, 20.0, 25.0)),
        ("bearing_inner".into(), raceway(4.0, 6.0, 25.0, 30.0)),
        ("bearing_outer".into(), raceway(10.0, 8.0, 25.0, 30.0)),
    ];
    for k in 0..4 {
        let [x, y] = [[16.0, 16.0], [-16.0, 16.0], [-16.0, -16.0], [16.0, -16.0]][k];
        let profile =
            [(0.0, 18.0), (2.0, 18.0), (2.0, 34.0), (3.5, 34.0), (3.5, 37.0), (0.0, 37.0)];
        parts.push((
            format!("bolt_{k}"),
            moved(solid_of_revolution(&profile), DVec3::new(x, y, 0.0)),
        ));
    }
    for k in 0..4 {
        let (s, c) = (TAU * f64::from(k) / 4.0).sin_cos();
        parts.push((
            format!("bearing_ball_{k}"),
            moved(ball(1.8), DVec3::new(7.0 * c, 7.0 * s, 27.5)),
        ));
    }
    parts
}

/// Returns a displaced mesh.
fn moved(mesh: Mesh, by: DVec3) -> Mesh {
    let Mesh { mut vertices, faces, .. } = mesh;
    for v in &mut vertices {
        *v += by;
    }
    outward_mesh(vertices, faces)
}

/// Creates a mesh, reversed if it is inside out.
fn outward_mesh(vertices: Vec<DVec3>, faces: Vec<Vec<u32>>) -> Mesh {
    let mut mesh = Mesh::default();
    (mesh.vertices, mesh.faces) = (vertices, faces);
    if mesh.signed_volume() < 0.0 {
        mesh.faces.iter_mut().for_each(|face| face.reverse());
    }
    mesh
}

/// Returns cosine and sine of the `k`-th side.
fn circle(k: usize) -> (f64, f64) {
    let (s, c) = (TAU * (k % SIDES) as f64 / SIDES as f64).sin_cos();
    (c, s)
}

/// Rotates a closed profile of radii and heights about z. The profile ends on the axis, or forms a ring.
fn solid_of_revolution(profile: &[(f64, f64)]) -> Mesh {
    let (mut vertices, mut rows) = (Vec::new(), Vec::new());
    for &(r, z) in profile {
        let first = vertices.len() as u32;
        let count = if r == 0.0 { 1 } else { SIDES };
        vertices.extend((0..count).map(circle).map(|(c, s)| DVec3::new(r * c, r * s, z)));
        rows.push((first, count));
    }
    let mut faces = Vec::new();
    for (i, &low) in rows.iter().enumerate() {
        let high = rows[(i + 1) % rows.len()];
        let at = |row: (u32, usize), k: usize| row.0 + (k % row.1) as u32;
        for k in 0..SIDES {
            let mut face = vec![at(low, k), at(low, k + 1), at(high, k + 1), at(high, k)];
            face.dedup();
            if face.first() == face.last() {
                face.pop();
            }
            if face.len() > 2 {
                faces.push(face);
            }
        }
    }
    outward_mesh(vertices, faces)
}

/// Returns a ring with rectangular profile.
fn ring(inner: f64, outer: f64, low: f64, high: f64) -> Mesh {
    solid_of_revolution(&[(inner, low), (outer, low), (outer, high), (inner, high)])
}

/// Returns a ring from a radius to the shoulders of a groove of radius 2 around the centres of the balls at radius 7.
fn raceway(away: f64, shoulder: f64, low: f64, high: f64) -> Mesh {
    let middle = f64::midpoint(low, high);
    let side = (7.0 - shoulder).signum();
    let start = (shoulder - 7.0_f64).abs() / 2.0;
    let mut profile = vec![(away, low), (shoulder, low)];
    for k in 0..=8 {
        let angle = (1.0 - 2.0 * f64::from(k) / 8.0) * start.acos();
        profile.push((7.0 - side * 2.0 * angle.cos(), middle - 2.0 * angle.sin()));
    }
    profile.extend([(shoulder, high), (away, high)]);
    solid_of_revolution(&profile)
}

/// Returns a sphere.
fn ball(radius: f64) -> Mesh {
    let at = |k: u32| (f64::from(k) / 12.0 * TAU / 2.0).sin_cos();
    let mut profile: Vec<(f64, f64)> = vec![(0.0, -radius)];
    profile.extend((1..12).map(at).map(|(s, c)| (radius * s, -radius * c)));
    profile.push((0.0, radius));
    solid_of_revolution(&profile)
}

/// Returns a gear, with a tooth on every other pair of sides.
fn gear(bore: f64, root: f64, tip: f64, low: f64, high: f64) -> Mesh {
    let radius = |k: usize| if k % 4 < 2 { tip } else { root };
    let Mesh { mut vertices, faces, .. } = ring(bore, tip, low, high);
    for (k, v) in
        vertices.iter_mut().enumerate().filter(|(_, v)| v.truncate().length() > bore + 1.0)
    {
        let (c, s) = circle(k % SIDES);
        let r = radius(k % SIDES);
        (v.x, v.y) = (r * c, r * s);
    }
    outward_mesh(vertices, faces)
}

/// A hole from above.
#[derive(Clone, Copy)]
struct Hole {
    radius: f64,
    depth: f64,
}

impl Hole {
    /// Creates a hole.
    const fn new(radius: f64, depth: f64) -> Self {
        Self { radius, depth }
    }
}

/// Coordinates of the divisions of a square plate.
const GRID: [f64; 4] = [-20.0, -12.0, 12.0, 20.0];

/// Returns a square block with a hole in the middle and one in each corner, from above.
fn block(low: f64, high: f64, middle: Hole, corner: Hole) -> Mesh {
    let mut vertices = Vec::new();
    let mut faces: Vec<Vec<u32>> = Vec::new();
    for z in [low, high] {
        for k in 0..16 {
            vertices.push(DVec3::new(GRID[k % 4], GRID[k / 4], z));
        }
    }
    for tile in 0..9 {
        let (i, j) = (tile % 3, tile / 3);
        let square =
            [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| (4 * j + i) as u32);
        let below = square.map(|k| k + 16);
        let hole = match (i, j) {
            (1, 1) => Some(middle),
            (0 | 2, 0 | 2) => Some(corner),
            _ => None,
        };
        let Some(hole) = hole else {
            faces.push(below.to_vec());
            faces.push(square.iter().rev().copied().collect());
            continue;
        };
        let center = [i, j].map(|k| f64::midpoint(GRID[k], GRID[k + 1]));
        let bottom = (high - hole.depth).max(low);
        let top_rim = rim(&mut vertices, center, hole.radius, high);
        let low_rim = rim(&mut vertices, center, hole.radius, bottom);
        triangulate_square_with_hole(&mut faces, below, top_rim, false);
        for k in 0..SIDES as u32 {
            let l = (k + 1) % SIDES as u32;
            faces.push(vec![top_rim + k, top_rim + l, low_rim + l, low_rim + k]);
        }
        if bottom == low {
            triangulate_square_with_hole(&mut faces, square, low_rim, true);
        } else {
            faces.push((0..SIDES as u32).map(|k| low_rim + k).collect());
            faces.push(square.iter().rev().copied().collect());
        }
    }
    let border = [0, 1, 2, 3, 7, 11, 15, 14, 13, 12, 8, 4];
    for k in 0..12 {
        let (a, b) = (border[k], border[(k + 1) % 12]);
        faces.push(vec![a, b, b + 16, a + 16]);
    }
    outward_mesh(vertices, faces)
}

/// Adds the vertices of a circle, and returns the first index.
fn rim(vertices: &mut Vec<DVec3>, [x, y]: [f64; 2], radius: f64, z: f64) -> u32 {
    let first = vertices.len() as u32;
    vertices
        .extend((0..SIDES).map(circle).map(|(c, s)| DVec3::new(x + radius * c, y + radius * s, z)));
    first
}

/// Triangulates a square (from its lower left corner, counter-clockwise) without a circle.
fn triangulate_square_with_hole(
    faces: &mut Vec<Vec<u32>>,
    square: [u32; 4],
    first: u32,
    reversed: bool,
) {
    let quarter = SIDES / 4;
    let mut add = |mut face: Vec<u32>| {
        if reversed {
            face.reverse();
        }
        faces.push(face);
    };
    for k in 0..4 {
        // The corner that lies beyond the rim's quarter from angle k * 90 degrees on.
        let corner = square[(k + 2) % 4];
        let next = square[(k + 3) % 4];
        let at = |j: usize| first + ((k * quarter + j) % SIDES) as u32;
        for j in 0..quarter {
            add(vec![corner, at(j + 1), at(j)]);
        }
        add(vec![corner, next, at(quarter)]);
    }
}
