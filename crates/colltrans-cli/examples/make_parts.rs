//! Writes the example parts of `data/`: `cargo run --release --example make_parts [FOLDER]`.
//!
//! Only `+ - * /` and square roots are used, which IEEE 754 defines to the last bit, so every
//! machine writes the same files.

use std::f64::consts::FRAC_1_SQRT_2;
use std::path::{Path, PathBuf};

use colltrans::ConvexPolyhedron;
use colltrans_mesh::{Error, Mesh, write};
use glam::{DVec2, DVec3};

/// Writes to the folder that is named, or to `data/`.
pub(crate) fn main() -> Result<(), Error> {
    write_parts(&std::env::args_os().nth(1).map_or_else(|| PathBuf::from("data"), PathBuf::from))
}

/// Writes all parts to a folder.
pub(crate) fn write_parts(folder: &Path) -> Result<(), Error> {
    write(&bracket(), folder.join("bracket.obj"))?;
    write(&dodecahedron(), folder.join("dodecahedron.off"))?;
    write(&triangulated(&gear_hull()), folder.join("gear_hull.stl"))?;
    write(&ellipsoid(DVec3::new(1.0, 0.7, 1.3), 24, 24), folder.join("ellipsoid_a.obj"))?;
    write(&ellipsoid(DVec3::new(0.8, 1.2, 0.6), 48, 24), folder.join("ellipsoid_b.off"))?;
    write(&triangulated(&bolt()), folder.join("bolt.stl"))?;
    write(&plate(), folder.join("plate.off"))
}

/// A bolt along z: a shank of radius 1.5 from -5 to 0 with 24 sides, above it a hexagonal head of
/// circumradius 3 and height 2. It is not convex.
fn bolt() -> Mesh {
    let shank: Vec<DVec2> = circle(24).into_iter().map(|c| c * 1.5).collect();
    let head: Vec<DVec2> = circle(12).into_iter().step_by(2).map(|c| c * 3.0).collect();
    let at = |outline: &[DVec2], z: f64| outline.iter().map(|c| c.extend(z)).collect::<Vec<_>>();
    let vertices = [at(&shank, -5.0), at(&shank, 0.0), at(&head, 0.0), at(&head, 2.0)].concat();
    let mut faces = vec![(0..24).rev().collect(), (54..60).collect()];
    faces.extend(walls(0, 24, 24));
    faces.extend(walls(48, 54, 6));
    // Below the head, from each of its corners to a part of the shank's rim.
    faces.extend(ring(48, 6, 24, 24).map(|face| face.into_iter().rev().collect()));
    Mesh::new(vertices, faces)
}

/// A square plate, 14 x 14, from z = -3 to 0, with a round hole of radius 1.6 in its middle.
fn plate() -> Mesh {
    let hole: Vec<DVec2> = circle(48).into_iter().map(|c| c * 1.6).collect();
    let square = [[7.0, 7.0], [-7.0, 7.0], [-7.0, -7.0], [7.0, -7.0]].map(DVec2::from_array);
    let at = |outline: &[DVec2], z: f64| outline.iter().map(|c| c.extend(z)).collect::<Vec<_>>();
    let vertices = [at(&square, -3.0), at(&square, 0.0), at(&hole, -3.0), at(&hole, 0.0)].concat();
    let mut faces: Vec<Vec<u32>> = walls(0, 4, 4).collect();
    faces.extend(walls(8, 56, 48).map(|face| face.into_iter().rev().collect()));
    faces.extend(ring(4, 4, 56, 48));
    faces.extend(ring(0, 4, 8, 48).map(|face| face.into_iter().rev().collect()));
    Mesh::new(vertices, faces)
}

/// The walls between two outlines of `count` vertices, one above the other, facing outwards.
fn walls(lower: u32, upper: u32, count: u32) -> impl Iterator<Item = Vec<u32>> {
    (0..count).map(move |i| {
        let j = (i + 1) % count;
        vec![lower + i, lower + j, upper + j, upper + i]
    })
}

/// Triangles between an outline of `corners` vertices and a circle inside it of `count`, a multiple of
/// them, facing upwards. Each corner sees an equal part of the circle.
fn ring(outer: u32, corners: u32, inner: u32, count: u32) -> impl Iterator<Item = Vec<u32>> {
    let part = count / corners;
    let shift = if corners == 4 { 0 } else { part / 2 };
    (0..corners).flat_map(move |corner| {
        let rim = move |i: u32| inner + (corner * part + i + count - shift) % count;
        let fan = (0..part).map(move |i| vec![outer + corner, rim(i + 1), rim(i)]);
        let next = outer + (corner + 1) % corners;
        fan.chain([vec![outer + corner, next, rim(part)]])
    })
}

/// A prism over the convex outline of a bracket, 6 long, 5 high, 2 deep.
fn bracket() -> Mesh {
    let outline = [[0.0, 0.0], [6.0, 0.0], [6.0, 1.0], [2.0, 5.0], [0.0, 5.0]];
    let count = outline.len() as u32;
    let ring = |y: f64| outline.map(|[x, z]| DVec3::new(x, y, z));
    let vertices = [ring(0.0), ring(2.0)].concat();
    let mut faces: Vec<Vec<u32>> =
        (0..count).map(|i| vec![(i + 1) % count, i, i + count, (i + 1) % count + count]).collect();
    faces.push((0..count).collect());
    faces.push((count..2 * count).rev().collect());
    Mesh::new(vertices, faces)
}

/// The regular dodecahedron whose cube of vertices has sides of 2.
fn dodecahedron() -> Mesh {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut points = Vec::new();
    for a in [-1.0, 1.0] {
        for b in [-1.0, 1.0] {
            let (short, long) = (a / golden, b * golden);
            points.extend([-1.0, 1.0].map(|c| DVec3::new(a, b, c)));
            points.push(DVec3::new(0.0, short, long));
            points.push(DVec3::new(short, long, 0.0));
            points.push(DVec3::new(long, 0.0, short));
        }
    }
    hull(&points)
}

/// The convex hull of a ring of 24 teeth with bevelled flanks, radius 3, thickness 1.
fn gear_hull() -> Mesh {
    let teeth = 24;
    let directions = circle(4 * teeth);
    let mut points = Vec::new();
    for tooth in 0..teeth {
        // A tooth's tip spans one of four parts of its pitch, its root the next but one.
        for (part, radius, half_thickness) in [
            (0, 3.0, 0.375),
            (1, 3.0, 0.375),
            (0, 2.75, 0.5),
            (1, 2.75, 0.5),
            (2, 2.5, 0.5),
            (3, 2.5, 0.5),
        ] {
            let at = directions[4 * tooth + part] * radius;
            points.extend([-half_thickness, half_thickness].map(|z| at.extend(z)));
        }
    }
    hull(&points)
}

/// An ellipsoid: a pole, rings from north to south, a pole, over as many meridians and
/// parallels as the full turn is cut into.
fn ellipsoid(semi_axes: DVec3, meridians: usize, parallels: usize) -> Mesh {
    let around = circle(meridians);
    let latitudes = circle(parallels);
    // The half circle from the north pole to the south pole, both poles left out.
    let rings: Vec<DVec2> = latitudes[1..parallels / 2].to_vec();
    let mut vertices = vec![DVec3::Z];
    for ring in &rings {
        vertices.extend(around.iter().map(|a| (*a * ring.y).extend(ring.x)));
    }
    vertices.push(DVec3::NEG_Z);
    let south = vertices.len() as u32 - 1;
    let count = meridians as u32;
    let at = |ring: u32, i: u32| 1 + ring * count + i % count;
    let mut faces = Vec::new();
    for i in 0..count {
        faces.push(vec![0, at(0, i), at(0, i + 1)]);
        for ring in 0..rings.len() as u32 - 1 {
            faces.push(vec![at(ring, i), at(ring + 1, i), at(ring + 1, i + 1), at(ring, i + 1)]);
        }
        faces.push(vec![south, at(rings.len() as u32 - 1, i + 1), at(rings.len() as u32 - 1, i)]);
    }
    let vertices = vertices.into_iter().map(|v| v * semi_axes).collect();
    Mesh::new(vertices, faces)
}

/// The corners of a regular polygon on the unit circle, starting at (1, 0); `count` must be
/// three times a power of two, at least 12.
///
/// The angle of 30 degrees is halved as often as needed, and the corners are its multiples,
/// each made from the one before: square roots and products only.
fn circle(count: usize) -> Vec<DVec2> {
    let mut step = DVec2::new(3.0_f64.sqrt() / 2.0, 0.5);
    let mut corners_per_turn = 12;
    while corners_per_turn < count {
        let cosine = (0.5 * (1.0 + step.x)).sqrt();
        step = DVec2::new(cosine, step.y / (2.0 * cosine));
        corners_per_turn *= 2;
    }
    let eighth = count / 8;
    // One eighth is computed, the rest are its mirror images, so that the symmetry is exact.
    let mut quarter = vec![DVec2::X];
    for i in 1..count / 4 {
        let previous: DVec2 = quarter[i - 1];
        quarter.push(if count.is_multiple_of(8) && i == eighth {
            DVec2::splat(FRAC_1_SQRT_2)
        } else if i <= eighth {
            previous.rotate(step)
        } else {
            let mirrored = quarter[count / 4 - i];
            DVec2::new(mirrored.y, mirrored.x)
        });
    }
    let mut corners = quarter.clone();
    for _ in 1..4 {
        let turned: Vec<DVec2> =
            corners[corners.len() - quarter.len()..].iter().map(|c| c.perp()).collect();
        corners.extend(turned);
    }
    // `perp` makes -0 of 0.
    corners.into_iter().map(|c| c + DVec2::ZERO).collect()
}

/// The convex hull as a mesh, in an order that does not depend on how it was found: vertices in the
/// order of the points, each face from its first vertex on, faces in the order of their vertices.
fn hull(points: &[DVec3]) -> Mesh {
    let body = ConvexPolyhedron::from_points(points).expect("the points are finite");
    let inputs = body.input_indices();
    let mut kept = inputs.to_vec();
    kept.sort_unstable();
    let place = |v: u32| kept.partition_point(|&k| k < inputs[v as usize]) as u32;
    let mut faces: Vec<Vec<u32>> =
        (0..body.face_count() as u32).map(|f| body.face_vertices(f).map(place).collect()).collect();
    for face in &mut faces {
        let first = (0..face.len()).min_by_key(|&i| face[i]).unwrap_or(0);
        face.rotate_left(first);
    }
    faces.sort_unstable();
    Mesh::new(kept.iter().map(|v| points[v.index()]).collect(), faces)
}

/// The same surface, each polygon cut into a fan of triangles.
fn triangulated(mesh: &Mesh) -> Mesh {
    let fan = |face: &Vec<u32>| {
        let first = face[0];
        face[1..].windows(2).map(|edge| vec![first, edge[0], edge[1]]).collect::<Vec<_>>()
    };
    Mesh::new(mesh.vertices.clone(), mesh.faces.iter().flat_map(fan).collect())
}
