//! Draws random bodies, and extreme proportions of sizes, positions, thicknesses and slopes.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use super::Draft;
use super::bodies::{ahead, axis_or_any, cloud, flat_body, octahedron, whole_box};
use super::tied::{boxes, grid, prisms};
use crate::random::Random;
use crate::shapes::cuboid;

/// Draws two random bodies.
pub(super) fn random(rng: &mut Random) -> Draft {
    let direction = axis_or_any(rng);
    let distance = rng.range(-3.0, 6.0);
    let at = ahead(rng, direction, distance, 2.0);
    let draft = Draft::new(cloud(rng), cloud(rng), at, direction);
    draft.turned(rng.rotation(), rng.rotation())
}

/// Draws bodies with a large aspect ratio.
pub(super) fn needle_plate(rng: &mut Random) -> Draft {
    let mut body = || {
        let long = rng.pick(&[100.0, 1000.0]);
        let axes =
            if rng.one_in(2) { DVec3::new(1.0, 1.0, long) } else { DVec3::new(long, long, 1.0) };
        let points: Vec<_> = cloud(rng).into_iter().map(|v| v * axes).collect();
        points
    };
    let (moving, fixed) = (body(), body());
    let direction = axis_or_any(rng);
    let at = ahead(rng, direction, 2000.0, 500.0);
    let draft = Draft::new(moving, fixed, at, direction);
    if rng.one_in(3) { draft } else { draft.turned(rng.rotation(), rng.rotation()) }
}

/// Draws bodies of very different sizes.
pub(super) fn size_ratio(rng: &mut Random) -> Draft {
    let mut draft = if rng.one_in(3) { boxes(rng) } else { random(rng) };
    let factor = rng.pick(&[1e6, 1e-6, 1e3]);
    draft.fixed.iter_mut().for_each(|v| *v *= factor);
    if factor > 1.0 {
        let corner = draft.fixed[0];
        draft.fixed_at +=
            draft.direction * 2.0 * factor - draft.fixed_rotation * corner * rng.pick(&[0.0, 1.0]);
    }
    draft
}

/// Draws bodies far from the origin of their frame, of the world, or of both.
pub(super) fn offset(rng: &mut Random) -> Draft {
    let mut draft = match rng.int(0, 2) {
        0 => boxes(rng),
        1 => grid(rng),
        _ => random(rng),
    };
    let far = rng.pick(&[1e6, 1e3]) * if rng.one_in(2) { rng.grid(-1, 1) } else { rng.vector() };
    if rng.one_in(2) {
        draft.moving_at += far;
        draft.fixed_at += far;
    }
    if rng.one_in(2) {
        draft.moving.iter_mut().for_each(|v| *v += far);
        draft.moving_at -= draft.moving_rotation * far;
    }
    if rng.one_in(2) {
        draft.fixed.iter_mut().for_each(|v| *v -= far);
        draft.fixed_at += draft.fixed_rotation * far;
    }
    draft
}

/// Draws bodies far apart.
pub(super) fn far(rng: &mut Random) -> Draft {
    let mut draft = match rng.int(0, 2) {
        0 => boxes(rng),
        1 => prisms(rng),
        _ => random(rng),
    };
    draft.fixed_at += draft.direction * rng.pick(&[1e4, -1e4, 12345.678]) * 2.0;
    draft
}

/// Draws flat bodies.
pub(super) fn flat(rng: &mut Random) -> Draft {
    let moving = flat_body(rng);
    let fixed = if rng.one_in(2) { flat_body(rng) } else { whole_box(rng) };
    let any = rng.direction();
    let direction = rng.pick(&[DVec3::Z, DVec3::X, DVec3::ONE, any]);
    let at = direction * rng.whole(-2, 6) + rng.grid(-1, 1);
    let draft = Draft::new(moving, fixed, at, direction);
    match rng.int(0, 2) {
        0 => draft,
        1 => draft.turned(DQuat::from_rotation_x(TAU / 4.0), DQuat::IDENTITY),
        _ => draft.turned(rng.rotation(), rng.rotation()),
    }
}

/// Draws points and segments with other bodies.
pub(super) fn segment_point(rng: &mut Random) -> Draft {
    let mut small = || match rng.int(0, 2) {
        0 => vec![rng.grid(-1, 1)],
        1 => vec![rng.grid(-1, 1), rng.grid(-1, 1)],
        _ => vec![rng.vector(), rng.vector()],
    };
    let (first, second) = (small(), small());
    let moving = first;
    let fixed = match rng.int(0, 2) {
        0 => second,
        1 => whole_box(rng),
        _ => flat_body(rng),
    };
    let direction = axis_or_any(rng);
    let at = direction * rng.whole(-1, 5) + rng.grid(-1, 1) * rng.pick(&[0.0, 1.0]);
    let swap = rng.one_in(2);
    let draft = Draft::new(moving, fixed, at, direction);
    if swap { Draft { moving: draft.fixed, fixed: draft.moving, ..draft } } else { draft }
}

/// Draws a block that slides along a slab, slightly downwards. The contact normal is almost orthogonal to the
/// direction.
pub(super) fn shallow(rng: &mut Random) -> Draft {
    let slab =
        cuboid(DVec3::new(rng.whole(2, 9), rng.whole(1, 3), rng.pick(&[0.0, 0.5, 1.0]))).vertices;
    let block = match rng.int(0, 3) {
        0 => octahedron(0.5),
        1 => cloud(rng),
        _ => cuboid(rng.grid(1, 3) * 0.25).vertices,
    };
    let descent = rng.pick(&[0.1, 1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 0.0]);
    let drift = rng.pick(&[0.0, 0.0, 0.3]);
    let direction = DVec3::new(1.0, drift, -descent);
    let start = rng.range(-4.0, 4.0);
    let low = block.iter().map(|v| v.z).fold(f64::INFINITY, f64::min);
    let top = slab[7].z;
    let height = top - low + descent * rng.pick(&[0.0, 1.0, 3.0]);
    let at = DVec3::new(start, rng.range(-1.0, 1.0), -height);
    Draft::new(block, slab, at, direction)
}

/// Draws slabs with a thickness from a thousandth of their width down to zero.
pub(super) fn thin(rng: &mut Random) -> Draft {
    let mut slab = || {
        let thickness = rng.pick(&[1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 1e-17, 0.0]);
        let half = DVec3::new(rng.whole(1, 2), rng.whole(1, 2), thickness);
        let turn = if rng.one_in(2) { rng.rotation() } else { DQuat::IDENTITY };
        cuboid(half).vertices.into_iter().map(|v| turn * v).collect::<Vec<_>>()
    };
    let (moving, fixed) = (slab(), slab());
    let direction = axis_or_any(rng);
    let at = direction * rng.whole(-1, 6) + rng.vector() * rng.pick(&[0.0, 1.0]);
    let draft = Draft::new(moving, fixed, at, direction);
    if rng.one_in(2) { draft } else { draft.turned(rng.rotation(), DQuat::IDENTITY) }
}

/// Draws very small and very large scenes.
pub(super) fn magnitude(rng: &mut Random) -> Draft {
    let mut draft = match rng.int(0, 3) {
        0 => boxes(rng),
        1 => grid(rng),
        2 => flat(rng),
        _ => random(rng),
    };
    let factor = rng.pick(&[1e-50, 1e-30, 1e-9, 1e9, 1e30, 1e50]);
    draft.moving.iter_mut().chain(&mut draft.fixed).for_each(|v| *v *= factor);
    draft.moving_at *= factor;
    draft.fixed_at *= factor;
    draft
}
