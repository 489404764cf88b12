//! How much is looked at for an answer about solids: pairs of nodes, which no machine disturbs.

use colltrans_convex::{Cast, Clearance, Pose};
use colltrans_solid::{Solid, SolidCast};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{Mesh, ring_sphere};
use colltrans_testkit::solids::{bumpy_ball, comb, slab};
use glam::{DQuat, DVec3};

/// The pairs of nodes that an answer about solids took.
fn nodes(clearance: &Clearance<Solid>) -> u32 {
    match clearance {
        Clearance::Free(free) => free.steps.nodes,
        Clearance::Blocked { contact, .. } => contact.steps.nodes,
        Clearance::Overlapping(overlap) => overlap.steps.nodes,
    }
}

/// Which of a node's facets lie in a side of its box says at the root that nothing blocks a body that is lifted
/// off another one.
#[test]
fn flat_faces_part_at_once() {
    let body = slab(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.25), [40, 40, 2]);
    let body = Solid::from_mesh(&body.vertices, &body.faces).expect("a slab");
    let quarter = DQuat::from_rotation_arc(DVec3::Z, DVec3::X);
    for rotation in [DQuat::IDENTITY, quarter] {
        let rotation = Pose::new(rotation, DVec3::ZERO).expect("a pose");
        let at = rotation.transform_vector(DVec3::new(0.125, 0.0625, 0.25));
        let above = Pose::new(rotation.rotation(), at).expect("a pose");
        let cast = |way| Cast::new(body.at(above), body.at(rotation), way).expect("a query");
        let lifted = cast(rotation.transform_vector(DVec3::Z)).clearance().expect("an answer");
        assert!(lifted.is_free() && nodes(&lifted) <= 2, "{lifted:?}");
        let pressed = cast(rotation.transform_vector(DVec3::NEG_Z)).clearance().expect("an answer");
        assert_eq!(pressed.distance(), Some(0.0));
    }
}

/// Returns how many pairs of nodes casts look at between two combs with interlocked teeth.
///
/// The teeth are as wide as the gaps and touch them on both sides. The second comb is also shifted along z. The tips are free,
/// touch the other comb, or are in it; in the last place the teeth overlap.
fn pairs_of_combs(teeth: usize, turned: DQuat, ways: &[DVec3]) -> Vec<u32> {
    let Mesh { vertices, faces } = comb(teeth);
    let comb = Solid::from_mesh(&vertices, &faces).expect("a comb");
    let half_turn = DQuat::from_xyzw(0.0, 0.0, 1.0, 0.0);
    let width = 2.0 * teeth as f64 - 1.0;
    let mut counts = Vec::new();
    for [x, y] in [[1.0, 8.0], [1.0, 6.0], [1.0, 5.9], [0.9, 8.0]] {
        for shift in [0.0, 0.25] {
            let at = turned * DVec3::new(width + x, y, shift);
            let above = comb.at(Pose::new(turned * half_turn, at).expect("a pose"));
            let below = comb.at(Pose::new(turned, DVec3::ZERO).expect("a pose"));
            for way in ways {
                let cast = Cast::new(above, below, turned * *way).expect("a query");
                counts.push(nodes(&cast.clearance().expect("an answer")));
            }
        }
    }
    counts
}

/// Combs move along their teeth and across them; combs that are not turned also move out of their plane and askew.
///
/// Two cases are left out because they take pairs of nodes with the square of the number of teeth: turned combs that move askew
/// within the plane of their caps, and combs with their caps in one plane that move askew out of it.
#[test]
#[ignore = "long: combs of many teeth"]
fn combs_between_each_other_take_pairs_of_nodes_for_each_tooth() {
    let along = [DVec3::X, DVec3::Y, DVec3::NEG_Y];
    let askew = [DVec3::Z, DVec3::new(0.1, 0.3, 0.0), DVec3::new(0.01, -1.0, 0.003)];
    let all = [along, askew].concat();
    let turn = DQuat::from_xyzw(0.1, 0.2, 0.3, 0.9).normalize();
    for (turned, ways) in [(DQuat::IDENTITY, &all[..]), (turn, &along[..])] {
        let [few, many] = [200, 1_000].map(|teeth| pairs_of_combs(teeth, turned, ways));
        println!("{few:?} pairs of nodes of 200 teeth, {many:?} of 1,000");
        for (few, many) in few.into_iter().zip(many) {
            // An overlap is sometimes found early, with few pairs of nodes.
            let most = 15 * few.max(20_000);
            assert!(many < most, "{few} pairs of nodes, {many} of 5 times as many teeth");
        }
    }
}

/// The least tolerance of an overlap takes a few looks at the bodies and at each place, not one for each binary digit.
#[test]
fn least_tolerances_take_a_few_looks() {
    let body = bumpy_ball(4_000);
    let body = Solid::from_mesh(&body.vertices, &body.faces).expect("a ball");
    let mut random = Random::new(5);
    let (mut sunk, mut sum, mut looks) = (0, 0, 0);
    for _ in 0..40 {
        let direction = random.direction();
        let [start, target] = [-direction * 4.0, DVec3::ZERO]
            .map(|at| Pose::new(random.rotation(), at).expect("a pose"));
        let cast = |start| Cast::new(body.at(start), body.at(target), direction).expect("a query");
        let Some(distance) = cast(start).clearance().expect("an answer").distance() else {
            continue;
        };
        let at = start.translation() + direction * (distance + 1e-6);
        let inside = Pose::new(start.rotation(), at).expect("a pose");
        if let Clearance::Overlapping(found) = cast(inside).clearance().expect("an answer") {
            let least = found.least_tolerance.expect("it is small");
            assert!(least > 0.0 && least < 1e-5, "{least}");
            sunk += 1;
            sum += found.steps.nodes;
            looks += found.steps.leaves;
        }
    }
    assert!(sunk > 20, "{sunk} overlaps");
    let [nodes, looks] = [sum, looks].map(|count| f64::from(count) / f64::from(sunk));
    println!("{nodes} pairs of nodes, {looks} looks at places and leaves");
    assert!(nodes < 1000.0 && looks < 60.0, "{nodes} pairs of nodes, {looks} looks");
}

/// So does that of convex bodies deep in each other, which are parted by a plane (some
/// 700,000 pairs of nodes by their trees).
#[test]
fn least_tolerances_of_deep_convex_bodies_take_a_few_looks() {
    let Mesh { vertices, faces } = ring_sphere(25, 20);
    let ball = Solid::from_mesh(&vertices, &faces).expect("a ball");
    let mut random = Random::new(5);
    for depth in [0.25, 0.5, 0.75] {
        let turned = |at| Pose::new(random.rotation(), at).expect("a pose");
        let [p, q] = [DVec3::X * (2.0 - depth), DVec3::ZERO].map(turned);
        let cast = Cast::new(ball.at(p), ball.at(q), DVec3::X).expect("a query");
        let Clearance::Overlapping(found) = cast.clearance().expect("an answer") else {
            panic!("they overlap")
        };
        let least = found.least_tolerance.expect("something is left of both");
        println!("{depth}: {least}, {:?}", found.steps);
        // Chords of balls are nearer than their arcs.
        assert!(least < depth && least > depth - 0.1, "{least} of {depth}");
        assert!(found.steps.nodes < 120_000, "{:?}", found.steps);
        let just = |share| cast.with_tolerance(share * least).expect("a tolerance").overlaps();
        assert!(just(1.0 - 1e-9) && !just(1.0));
    }
}
