//! Casts that published libraries are known to answer wrongly.

use std::collections::HashMap;

use colltrans_convex::{Cast, Contact, ConvexPolyhedron, Outcome, Pose, Solver};
use colltrans_testkit::oracle::check::Judge;
use colltrans_testkit::shapes::{cone, cuboid};
use glam::{DQuat, DVec3};

use crate::common::{at, body};

/// The contact of both solvers, checked against the exact one.
fn contact(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
    direction: DVec3,
    with_oracle: bool,
) -> Contact {
    let cast = Cast::new(moving.at(*moving_pose), fixed.at(*fixed_pose), direction);
    let cast = cast.expect("a query");
    let judge = Judge::new(cast);
    let mut contacts = [Solver::Cta, Solver::Portal].map(|solver| {
        let outcome = cast.with_solver(solver).first_contact().expect("an answer");
        judge.check(&outcome).expect("a certificate that holds");
        if with_oracle {
            judge.compare_with_oracle(&outcome).expect("agreement with the oracle");
        }
        let Outcome::Contact(contact) = outcome else { panic!("{outcome:?}") };
        contact
    });
    contacts.sort_by(|a, b| a.translation.total_cmp(&b.translation));
    let [low, high] = contacts;
    assert!(high.translation - low.translation <= low.certificate.rounding);
    low
}

/// A subdivided icosahedron: its vertices on a sphere around the origin.
fn icosphere(radius: f64, subdivisions: u32) -> Vec<DVec3> {
    let phi = f64::midpoint(1.0, 5.0_f64.sqrt());
    let mut vertices = Vec::new();
    for (a, b) in [(1.0, phi), (1.0, -phi), (-1.0, phi), (-1.0, -phi)] {
        vertices.extend([DVec3::new(0., a, b), DVec3::new(a, b, 0.), DVec3::new(b, 0., a)]);
    }
    let near = |u: DVec3, v: DVec3| u.distance(v) < 2.1;
    let mut triangles = Vec::new();
    for i in 0..12 {
        for j in 0..i {
            for k in 0..j {
                let (a, b, c) = (vertices[i], vertices[j], vertices[k]);
                if near(a, b) && near(b, c) && near(c, a) {
                    triangles.push([i, j, k]);
                }
            }
        }
    }
    assert_eq!(triangles.len(), 20);
    for _ in 0..subdivisions {
        let mut middle = HashMap::new();
        let mut split = |i: usize, j: usize| {
            *middle.entry((i.min(j), i.max(j))).or_insert_with(|| {
                vertices.push((vertices[i].normalize() + vertices[j].normalize()).normalize());
                vertices.len() - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[i, j, k]| {
                let [a, b, c] = [split(i, j), split(j, k), split(k, i)];
                [[i, a, c], [j, b, a], [k, c, b], [a, b, c]]
            })
            .collect();
    }
    vertices.iter().map(|v| v.normalize() * radius).collect()
}

/// parry issue 429: up to 139 mm wrong, the more the larger the floor.
#[test]
fn ball_onto_large_floors() {
    let points = icosphere(0.5166, 2);
    let ball = body(&points);
    assert_eq!(ball.vertices().len(), 162);
    let lowest = points.iter().map(|v| v.y).fold(f64::INFINITY, f64::min);
    for half in [5.0, 50.0, 500.0, 5000.0] {
        let floor = body(&cuboid(DVec3::new(half, 0.5, half)).vertices);
        let floor_pose = at(DVec3::NEG_Y * 0.5);
        for i in 0..400 {
            let height = 1.177 + f64::from(i) * 5e-5;
            let aside = f64::from(i) / 400.0 * 0.9 * half;
            let ball_pose = at(DVec3::new(aside, height, -0.7 * aside));
            let found = contact(&ball, &ball_pose, &floor, &floor_pose, DVec3::NEG_Y, false);
            let error = (found.translation - (height + lowest)).abs();
            assert!(error <= found.certificate.rounding, "floor {half}, step {i}: {error:e} off");
            assert!(found.normal.distance(DVec3::NEG_Y) < 1e-12);
        }
    }
}

/// f32 parry 0.31.1 gives 1.16031.
#[test]
fn turned_box_onto_a_wide_floor() {
    let moving = body(&cuboid(DVec3::new(0.3, 0.5, 0.4)).vertices);
    let floor = body(&cuboid(DVec3::new(500.0, 1.0, 500.0)).vertices);
    let rotation = DQuat::from_xyzw(0.867_532_25, 0.490_253_03, 0.0, -0.083_903_54);
    let pose = Pose::new(rotation, DVec3::new(121.51959, 3.0, 133.5186)).expect("a pose");
    let found = contact(&moving, &pose, &floor, &Pose::IDENTITY, DVec3::NEG_Y, true);
    assert!((found.translation - 1.43397).abs() < 5e-6, "{}", found.translation);
}

/// `PhysX` issue 610 reports 2.9975.
#[test]
fn box_falls_three_units_on_a_box() {
    let cube = body(&cuboid(DVec3::splat(0.5)).vertices);
    let pose = at(DVec3::Y * 4.0);
    let found = contact(&cube, &pose, &cube, &Pose::IDENTITY, DVec3::NEG_Y, true);
    assert!((found.translation - 3.0).abs() <= found.certificate.rounding);
}

/// FCL with its default settings says 0.444.
#[test]
fn box_travels_onto_a_cone() {
    let moving = body(&cuboid(DVec3::new(0.5, 1.0, 1.5)).vertices);
    for sides in [8, 32, 128] {
        // A corner ahead, at exactly -1.
        let cone = cone(sides, [-1.0, 1.0]).mapped(|v| v * DVec3::new(-1.0, 1.0, 1.0));
        let cone = body(&cone.vertices);
        let pose = at(DVec3::X * -10.0);
        let found = contact(&moving, &pose, &cone, &Pose::IDENTITY, DVec3::X * 20.0, sides < 100);
        let error = (found.translation - 0.425).abs();
        assert!(error <= found.certificate.rounding, "{sides} sides: {error:e} off");
    }
}
