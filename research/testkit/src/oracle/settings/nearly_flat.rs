//! Draws bodies with a thickness of about rounding errors or less, and nearly flat faces.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use super::Draft;
use super::bodies::{cloud, prism};
use crate::random::Random;
use crate::shapes::cuboid;

/// Draws corners on an ellipse, each off its plane by a fraction of the thickness.
pub(super) fn disc(rng: &mut Random, thickness: f64) -> Vec<DVec3> {
    let (sides, width) = (rng.int(5, 24), rng.pick(&[1.0, 1.0, 0.3, 1e-3]));
    let first_rad = rng.pick(&[0.0, 0.3]);
    (0..sides)
        .map(|k| first_rad + TAU * k as f64 / sides as f64)
        .map(|a| DVec3::new(a.cos(), width * a.sin(), thickness * rng.range(-0.5, 0.5)))
        .collect()
}

/// Draws a flat prism over a regular polygon.
pub(super) fn flat_prism(rng: &mut Random, thickness: f64) -> Vec<DVec3> {
    prism(rng.int(3, 16) as u32, 1.0, 0.5 * thickness, rng.pick(&[0.0, 0.3]))
}

/// Draws a box, or points in a box or in a wedge.
pub(super) fn plate(rng: &mut Random, thickness: f64) -> Vec<DVec3> {
    let half = DVec3::new(1.0, rng.pick(&[1.0, 0.5, 1e-2]), 0.5 * thickness);
    match rng.int(0, 2) {
        0 => cuboid(half).vertices,
        1 => (0..rng.int(5, 24)).map(|_| rng.vector() * half).collect(),
        _ => (0..rng.int(5, 24))
            .map(|_| rng.vector() * half)
            .map(|v| v.with_z(v.z * (1.0 + v.x)))
            .collect(),
    }
}

/// Draws points of a grid in a plane, each off the plane by a fraction of the thickness.
pub(super) fn lattice(rng: &mut Random, thickness: f64) -> Vec<DVec3> {
    let [columns, rows] = [0; 2].map(|_| rng.int(2, 5));
    let mut points = Vec::new();
    for i in 0..columns {
        for j in 0..rows {
            points.push(DVec3::new(i as f64, j as f64, thickness * rng.range(-0.5, 0.5)));
        }
    }
    points
}

/// Draws points along an axis, each off the axis by a fraction of the thickness.
pub(super) fn needle(rng: &mut Random, thickness: f64) -> Vec<DVec3> {
    let across = DVec3::new(0.0, thickness, thickness * rng.pick(&[1.0, 1.0, 1e-2, 1e2]));
    (0..rng.int(4, 16)).map(|_| rng.vector() * across + DVec3::X * rng.range(-1.0, 1.0)).collect()
}

/// Draws a nearly flat body of a shape. Its thickness is `1e-16` to `1e-11` or 0. Most are rotated in their
/// frame. Some are modelled far from the origin, and moved back or left there.
fn nearly_flat(rng: &mut Random, shape: fn(&mut Random, f64) -> Vec<DVec3>) -> Vec<DVec3> {
    let some = 10_f64.powf(rng.range(-16.0, -11.0));
    let thickness = if rng.one_in(5) { 0.0 } else { some };
    let mut points = shape(rng, thickness);
    if !rng.one_in(4) {
        let turn = rng.rotation();
        for v in &mut points {
            *v = turn * *v;
        }
    }
    if rng.one_in(2) {
        let far = rng.direction() * 10_f64.powf(rng.range(0.0, 5.0));
        for v in &mut points {
            *v += far;
        }
        let middle = points.iter().sum::<DVec3>() / points.len() as f64;
        let back = rng.pick(&[far, middle, middle, DVec3::ZERO]);
        for v in &mut points {
            *v -= back;
        }
    }
    points
}

/// Draws a point, a cloud or a second nearly flat body that moves onto a point of a nearly flat body, or next
/// to it.
pub(super) fn onto_nearly_flat(
    rng: &mut Random,
    shape: fn(&mut Random, f64) -> Vec<DVec3>,
) -> Draft {
    let fixed = nearly_flat(rng, shape);
    let moving = match rng.int(0, 3) {
        0 => cloud(rng),
        1 => nearly_flat(rng, shape),
        _ => vec![DVec3::ZERO],
    };
    let target = rng.pick(&fixed);
    let middle = fixed.iter().sum::<DVec3>() / fixed.len() as f64;
    let inwards = rng.pick(&[0.0, 1e-15, 1e-12, 1e-6, 0.1, 1.0]);
    // Towards the centre, along the body, or any direction.
    let (rim, any) = ((middle - target).normalize_or(DVec3::Z), rng.direction());
    let side = (rng.pick(&fixed) - rng.pick(&fixed)).normalize_or(any);
    let direction = rng.pick(&[any, any, rim, side]);
    let [moving_turn, fixed_turn] =
        [0; 2].map(|_| if rng.one_in(2) { rng.rotation() } else { DQuat::IDENTITY });
    let start = moving_turn * rng.pick(&moving) + direction * rng.range(-0.5, 5.0);
    let at = start - fixed_turn * target.lerp(middle, inwards);
    Draft::new(moving, fixed, at, direction).turned(moving_turn, fixed_turn)
}

/// Draws rings of a narrow ellipse, with a chamfer and a base below. The corners of the upper rings are off
/// their plane by a few roundings. The result has nearly flat faces with many corners, and edges of very
/// different lengths.
pub fn narrow_rings(rng: &mut Random) -> Vec<DVec3> {
    let ten = |rng: &mut Random, low, high| 10_f64.powf(rng.range(low, high));
    let corners = rng.int(9, 12) as u32;
    let turn = TAU / f64::from(corners);
    let angles: Vec<f64> =
        (0..corners).map(|k| turn * (f64::from(k) + rng.range(-0.3, 0.3))).collect();
    let (width, bump) = (ten(rng, -6.0, 0.0), rng.range(0.0, 200.0) * f64::EPSILON * 0.5);
    let mut slope = ten(rng, -15.0, -6.0);
    let (mut out, mut z, mut points) = (0.0, 0.0, Vec::new());
    for ring in 0..4 {
        let off = if ring < 2 { bump } else { 0.0 };
        points.extend(angles.iter().map(|a| {
            DVec3::new((1.0 + out) * a.cos(), (width + out) * a.sin(), z + rng.range(-off, off))
        }));
        let step = ten(rng, -12.0, 0.0);
        (out, z) = (out + step, z - step * slope);
        slope *= ten(rng, 0.0, 3.0);
    }
    let base = z - ten(rng, -8.0, 1.0);
    points.extend(
        angles.iter().map(|a| DVec3::new((1.0 + out) * a.cos(), (width + out) * a.sin(), base)),
    );
    points
}

/// Draws two bodies of narrow rings with their tops facing each other, slightly tilted. The fixed body may be a
/// cloud.
pub(super) fn nearly_flat_faces(rng: &mut Random) -> Draft {
    let tilt = |rng: &mut Random| {
        let angle = 10_f64.powf(rng.range(-17.0, -1.0));
        let axis = DVec3::new(rng.range(-1.0, 1.0), rng.range(-1.0, 1.0), 0.0);
        DQuat::from_scaled_axis(axis * angle)
    };
    let over = DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0);
    let moving = narrow_rings(rng);
    let fixed = if rng.one_in(4) { cloud(rng) } else { narrow_rings(rng) };
    let tilts = [(); 2].map(|()| if rng.one_in(4) { DQuat::IDENTITY } else { tilt(rng) });
    let spin = DQuat::from_rotation_z(if rng.one_in(2) { 0.0 } else { rng.range(0.0, TAU) });
    let aside = rng.pick(&[0.0, 1e-9, 1e-3, 0.5, 1.0, 2.0]);
    let at = DVec3::new(rng.range(-aside, aside), rng.range(-aside, aside), rng.range(-1.0, 4.0));
    Draft::new(moving, fixed, at, DVec3::Z).turned(tilts[0], tilts[1] * spin * over)
}
