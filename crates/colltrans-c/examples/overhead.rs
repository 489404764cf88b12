//! Runs one query many times, by the library or by the C interface, so that their instructions can be counted:
//! `overhead rust|c QUERY CALLS`. `.ci/overhead.py` compares both.
//!
//! Both begin with the numbers of the poses and the direction, and end with the same numbers of the answer.

use std::env;
use std::hint::black_box;
use std::ptr::null;

use colltrans::glam::{DMat3, DQuat, DVec3};
use colltrans::{Cast, ConvexPolyhedron, Outcome, Pair, Pose, Tracker};
use colltrans_c as c;

/// A cube, an icosphere-like body of 42 points, and two poses.
struct Inputs {
    points: [Vec<f64>; 2],
    poses: [c::Pose; 2],
    direction: [f64; 3],
}

fn inputs() -> Inputs {
    let cube = (0..8).flat_map(|k: u32| [k & 1, k >> 1 & 1, k >> 2].map(f64::from)).collect();
    let spiral = (0..42).flat_map(|k| {
        let (z, angle) = (1.0 - (f64::from(k) + 0.5) / 21.0, 2.4 * f64::from(k));
        let radius = (1.0 - z * z).sqrt();
        [radius * angle.cos(), radius * angle.sin(), z]
    });
    let pose = |turn: f64, by: DVec3| {
        let pose = Pose::new(DQuat::from_axis_angle(DVec3::ONE.normalize(), turn), by);
        let pose = pose.expect("a pose");
        c::Pose {
            rotation: pose.matrix().to_cols_array(),
            translation: pose.translation().to_array(),
        }
    };
    Inputs {
        points: [cube, spiral.collect()],
        poses: [pose(0.3, DVec3::new(0.1, 0.2, 5.0)), pose(0.7, DVec3::new(0.3, 0.1, 0.0))],
        direction: [0.1, 0.05, -1.0],
    }
}

fn placed(pose: &c::Pose) -> Pose {
    let matrix = DMat3::from_cols_array(&pose.rotation);
    Pose::from_matrix(matrix, DVec3::from_array(pose.translation)).expect("a pose")
}

/// The numbers of a contact that both interfaces compute.
fn numbers(outcome: &Outcome, cast: &Cast<'_>) -> [f64; 13] {
    let Outcome::Contact(contact) = outcome else { panic!("no contact") };
    let points = contact.witness_points(cast);
    let [n, p, q] = [contact.normal, points.on_moving, points.on_fixed];
    let proof = contact.certificate;
    [
        contact.translation,
        proof.lower,
        proof.upper,
        proof.rounding,
        n.x,
        n.y,
        n.z,
        p.x,
        p.y,
        p.z,
        q.x,
        q.y,
        q.z,
    ]
}

fn by_rust(query: &str, calls: usize) {
    let Inputs { points, poses, direction } = inputs();
    let bodies = points.map(|of| {
        let points: Vec<DVec3> = of.chunks(3).map(DVec3::from_slice).collect();
        ConvexPolyhedron::from_points(&points).expect("a body")
    });
    let mut tracker = Tracker::new();
    for _ in 0..calls {
        let poses = black_box(&poses);
        let [p, q] = [bodies[0].at(placed(&poses[0])), bodies[1].at(placed(&poses[1]))];
        let cast = || Cast::new(p, q, DVec3::from_array(*black_box(&direction))).expect("a cast");
        match query {
            "first_contact" => {
                let cast = cast();
                black_box(numbers(&cast.first_contact().expect("an answer"), &cast));
            }
            "tracked" => {
                let cast = cast();
                black_box(numbers(&tracker.first_contact(&cast).expect("an answer"), &cast));
            }
            "distance" => {
                black_box(Pair::new(p, q).and_then(|pair| pair.distance()).expect("an answer"));
            }
            _ => {
                let pair = Pair::new(p, q).expect("a pair");
                black_box(pair.distance_bounds().expect("an answer"));
            }
        }
    }
}

fn by_c(query: &str, calls: usize) {
    let Inputs { points, poses, direction } = inputs();
    // SAFETY: all pointers are to objects of their types, and the handles live until the end.
    unsafe {
        let bodies = points.map(|of| {
            let mut body = std::ptr::null_mut();
            let status = c::colltrans_convex_from_points(of.as_ptr(), of.len() / 3, &raw mut body);
            assert_eq!(status, c::Status::Ok);
            body
        });
        let mut tracker = std::ptr::null_mut();
        assert_eq!(c::colltrans_tracker_new(&raw mut tracker), c::Status::Ok);
        let mut cast = std::mem::MaybeUninit::<c::CastAnswer>::uninit();
        let mut near = std::mem::MaybeUninit::<c::DistanceAnswer>::uninit();
        let mut bounds = [0.0; 2];
        for _ in 0..calls {
            let [a, b] = [&raw const black_box(&poses)[0], &raw const black_box(&poses)[1]];
            let (p, q, d) = (bodies[0], bodies[1], black_box(&direction).as_ptr());
            let to = cast.as_mut_ptr();
            let status = match query {
                "first_contact" => c::colltrans_first_contact(p, a, q, b, d, null(), to),
                "tracked" => c::colltrans_tracker_first_contact(tracker, p, a, q, b, d, null(), to),
                "distance" => c::colltrans_distance(p, a, q, b, near.as_mut_ptr()),
                _ => c::colltrans_distance_bounds(p, a, q, b, bounds.as_mut_ptr()),
            };
            assert_eq!(status, c::Status::Ok);
            black_box((&cast, &near, &bounds));
        }
        c::colltrans_tracker_free(tracker);
        for body in bodies {
            c::colltrans_body_free(body);
        }
    }
}

fn main() {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [interface, query, calls] = &arguments[..] else {
        panic!("usage: overhead rust|c first_contact|tracked|distance|bounds CALLS")
    };
    let calls = calls.parse().expect("a number of calls");
    if interface == "c" { by_c(query, calls) } else { by_rust(query, calls) }
}
