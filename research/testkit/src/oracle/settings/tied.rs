//! Draws ties: faces on faces, edges on edges, vertices on boundaries, exactly or up to the last digits.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use super::Draft;
use super::bodies::{axis, axis_or_any, cloud, octahedron, prism, whole_box};
use crate::random::Random;
use crate::shapes::cuboid;

/// Draws axis-aligned boxes with integer coordinates.
pub(super) fn boxes(rng: &mut Random) -> Draft {
    let direction = if rng.one_in(4) { rng.grid(-1, 1) } else { axis(rng) };
    let direction = if direction == DVec3::ZERO { DVec3::Z } else { direction };
    let at = rng.grid(-3, 3) + direction * rng.whole(-4, 12);
    Draft::new(whole_box(rng), whole_box(rng), at, direction)
}

/// Draws boxes rotated by multiples of 90 or of 45 degrees.
pub(super) fn turned_boxes(rng: &mut Random) -> Draft {
    let step = rng.pick(&[TAU / 4.0, TAU / 8.0]);
    let mut turn = || DQuat::from_axis_angle(axis(rng), step * rng.whole(0, 7));
    let (moving, fixed) = (turn(), turn());
    boxes(rng).turned(moving, fixed)
}

/// Draws prisms with the same number of sides.
pub(super) fn prisms(rng: &mut Random) -> Draft {
    let sides = rng.int(3, 6) as u32;
    let first_rad = rng.pick(&[0.0, TAU / 12.0, 0.3]);
    let mut one = || prism(sides, rng.whole(1, 3), rng.whole(1, 3), first_rad);
    let (moving, fixed) = (one(), one());
    let direction = if rng.one_in(3) { axis_or_any(rng) } else { DVec3::Z };
    let at = DVec3::new(rng.whole(-2, 2), rng.whole(-2, 2), 0.0) + direction * rng.whole(-3, 10);
    Draft::new(moving, fixed, at, direction)
}

/// Draws points on a grid.
pub(super) fn grid(rng: &mut Random) -> Draft {
    let mut body = || {
        let n = rng.int(1, 12);
        (0..n).map(|_| rng.grid(0, 3)).collect()
    };
    let (moving, fixed) = (body(), body());
    let direction = rng.grid(-2, 2);
    let direction = if direction == DVec3::ZERO { DVec3::X } else { direction };
    let at = rng.grid(-2, 2) + direction * rng.whole(-1, 4);
    Draft::new(moving, fixed, at, direction)
}

/// Draws bodies with parallel faces that touch, overlap or are apart.
pub(super) fn face_face(rng: &mut Random) -> Draft {
    let half = rng.grid(1, 3) * 0.25;
    let mut moving = cuboid(half).vertices;
    moving.truncate(rng.pick(&[8, 8, 7, 6]));
    let fixed = prism(rng.int(3, 6) as u32, rng.range(0.3, 2.0), half.z, rng.unit());
    let direction =
        if rng.one_in(2) { DVec3::Z } else { (rng.vector() + DVec3::Z * 2.0).normalize() };
    let any = rng.unit();
    let height = 2.0 * half.z + rng.pick(&[0.0, 0.0, 1.0, any, -0.25]);
    let at = rng.vector() * DVec3::new(1.5, 1.5, 0.0) + DVec3::Z * height;
    Draft::new(moving, fixed, at, direction)
}

/// Draws two roofs with their ridges facing each other.
pub(super) fn edge_edge_parallel(rng: &mut Random) -> Draft {
    let mut roof = |up: f64| {
        let (length, width, height) = (rng.whole(1, 3), rng.whole(1, 3), up * rng.whole(1, 2));
        let ridge = [DVec3::new(-length, 0.0, height), DVec3::new(length, 0.0, height)];
        let base = cuboid(DVec3::new(length, width, 0.0)).vertices;
        ridge.into_iter().chain(base).collect::<Vec<_>>()
    };
    let (moving, fixed) = (roof(1.0), roof(-1.0));
    let lateral = rng.pick(&[DVec3::ZERO, DVec3::Y * 1e-13, DVec3::X, DVec3::X * 0.3, DVec3::Y]);
    let direction =
        if rng.one_in(3) { DVec3::new(0.0, rng.range(-0.4, 0.4), 1.0) } else { DVec3::Z };
    let at = DVec3::Z * rng.whole(0, 9) + lateral;
    Draft::new(moving, fixed, at, direction)
}

/// Draws octahedra and cubes with vertices facing each other.
pub(super) fn vertex_over_vertex(rng: &mut Random) -> Draft {
    let moving = octahedron(rng.whole(1, 3));
    let fixed = if rng.one_in(3) {
        cuboid(DVec3::splat(rng.whole(1, 2))).vertices
    } else {
        octahedron(rng.whole(1, 3))
    };
    let tip = rng.pick(&[DVec3::Z, DVec3::X, DVec3::new(1.0, 1.0, 1.0)]);
    let direction = if rng.one_in(3) { (tip + rng.vector() * 0.2).normalize() } else { tip };
    let at = direction * rng.whole(2, 9) + rng.vector() * rng.pick(&[0.0, 0.0, 1e-15]);
    Draft::new(moving, fixed, at, direction)
}

/// Draws a vertex or an edge that meets the boundary of a face exactly, or slightly inside or outside of it.
pub(super) fn rim(rng: &mut Random) -> Draft {
    let half = rng.grid(1, 3);
    let fixed = cuboid(half).vertices;
    let moving = match rng.int(0, 2) {
        0 => octahedron(rng.whole(1, 2)),
        1 => whole_box(rng),
        _ => vec![DVec3::ZERO],
    };
    let reach = moving.iter().map(|v| v.x).fold(0.0, f64::max);
    let inside = rng.pick(&[0.0, 0.0, 0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-9, -1e-9]);
    let lateral = if rng.one_in(2) { half.x } else { half.x + reach } - inside * half.x;
    let any = rng.unit();
    let along = rng.pick(&[0.0, half.y, any]);
    let at = DVec3::new(lateral, along, rng.whole(-5, 9));
    Draft::new(moving, fixed, at, DVec3::Z)
}

/// Draws two copies of the same body.
pub(super) fn identical(rng: &mut Random) -> Draft {
    let body = if rng.one_in(2) { cloud(rng) } else { whole_box(rng) };
    let direction = axis_or_any(rng);
    let at = match rng.int(0, 3) {
        0 => DVec3::ZERO,
        1 => direction * rng.range(-2.0, 5.0),
        2 => direction * rng.whole(-2, 5),
        _ => body[0] - body[body.len() - 1],
    };
    let rotation = if rng.one_in(2) { rng.rotation() } else { DQuat::IDENTITY };
    Draft::new(body.clone(), body, at, direction).turned(rotation, rotation)
}

/// Draws a peg that slides along a wall with zero, small positive or small negative clearance.
pub(super) fn peg(rng: &mut Random) -> Draft {
    let (peg, wall) = (rng.grid(1, 4) * 0.1, rng.grid(1, 9) * 0.1);
    let clearance = rng.pick(&[0.0, 0.0, 0.0, 1e-6, -1e-6, 1e-13, -1e-13]);
    let lateral = peg.x + wall.x + clearance;
    let at = DVec3::new(lateral, rng.range(-0.1, 0.1), rng.range(-2.0, 4.0));
    let round = rng.one_in(3);
    let moving = if round {
        prism(6, peg.x, peg.z, rng.pick(&[0.0, TAU / 12.0]))
    } else {
        cuboid(peg).vertices
    };
    let draft = Draft::new(moving, cuboid(wall).vertices, at, DVec3::Z);
    Draft { graze_tolerance: rng.pick(&[0.0, 0.0, 1e-9, 1e-5, 1e-3]), ..draft }
}

/// Draws prisms with many sides, coaxial, tangent or side by side.
pub(super) fn cylinders(rng: &mut Random) -> Draft {
    let sides = rng.pick(&[8, 12]);
    let (r, s) = (rng.whole(1, 3), rng.whole(1, 3));
    let moving = prism(sides, r, rng.whole(1, 2), 0.0);
    let fixed = prism(sides, s, rng.whole(1, 2), rng.pick(&[0.0, TAU / f64::from(2 * sides)]));
    let direction = rng.pick(&[DVec3::Z, DVec3::X, DVec3::new(1.0, 1.0, 0.0)]);
    let lateral = rng.pick(&[DVec3::X, DVec3::Y, DVec3::Z]).reject_from(direction);
    let at = direction * rng.whole(2, 8) + lateral * rng.pick(&[0.0, r + s, r - s, s]);
    Draft::new(moving, fixed, at, direction)
}

/// Draws tied settings whose ties are broken in the last digits.
pub(super) fn nearly(rng: &mut Random) -> Draft {
    let mut draft = match rng.int(0, 4) {
        0 => boxes(rng),
        1 => prisms(rng),
        2 => edge_edge_parallel(rng),
        3 => vertex_over_vertex(rng),
        _ => face_face(rng),
    };
    let tilt = rng.pick(&[1e-3, 1e-7, 1e-9, 1e-11, 1e-14]);
    draft.moving_rotation = DQuat::from_axis_angle(rng.direction(), tilt);
    draft.moving_at += rng.vector() * rng.pick(&[0.0, tilt]);
    draft
}
