//! Proofs of depths: of polycubes with exact depths, of turned and of convex bodies. Every proof holds, and every
//! changed one is refused.

use colltrans_convex::{ConvexPolyhedron, Pair, Pose};
use colltrans_solid::proof::{Cover, DepthCertificate};
use colltrans_solid::{AsSolid, Solid, SolidPenetration};
use colltrans_testkit::cases;
use colltrans_testkit::random::Random;
use glam::DVec3;

use crate::common::{at, cuboid};
use crate::penetration::{Polycube, exact_squared_depth, quarters};

/// Returns a cover without its last entry.
fn shortened<R: Copy>(cover: &Cover<R>) -> Cover<R> {
    let entries = cover.entries();
    Cover::from(entries[..entries.len() - 1].to_vec())
}

/// Returns changed proofs, none of which holds, with a name.
fn changed(proof: &DepthCertificate, start: DVec3) -> Vec<(&'static str, DepthCertificate)> {
    let mut all = Vec::new();
    let mut add = |name, change: &dyn Fn(&mut DepthCertificate)| {
        let mut other = proof.clone();
        change(&mut other);
        all.push((name, other));
    };
    let length = (proof.translation - start).length();
    if length > 0.0 {
        add("a smaller upper bound", &|of| of.upper = length * (1.0 - 1e-12));
        add("half of the translation", &|of| of.translation = start.midpoint(of.translation));
    }
    add("a negative upper bound", &|of| of.upper = -1.0);
    add("no upper bound", &|of| of.upper = f64::NAN);
    add("a larger lower bound", &|of| of.lower = of.lower * (1.0 + 1e-9) + 1e-9);
    add("a lower bound above the upper one", &|of| of.lower = of.upper.next_up() + 1e-9);
    add("no lower bound", &|of| of.lower = f64::NAN);
    add("a shorter cover of the bodies", &|of| of.apart.cover = shortened(&of.apart.cover));
    add("a larger distance", &|of| of.apart.lower = 1.01 * of.apart.near.distance() + 1e-9);
    add("no distance", &|of| of.apart.lower = 0.0);
    for place in 0..2 * proof.cores.len() {
        let (pair, side) = (place / 2, place % 2);
        add("a shorter cover of a core", &|of| {
            let core = &mut of.cores[pair][side];
            core.cover = shortened(&core.cover);
        });
        add("a larger radius", &|of| {
            let core = &mut of.cores[pair][side];
            core.radius = core.radius * (1.0 + 1e-9) + 1e-9;
        });
        add("a core that is far away", &|of| of.cores[pair][side].origin += DVec3::splat(1e3));
        add("a core with a flat box", &|of| {
            of.cores[pair][side].size = DVec3::new(1e-3, 1e-3, 0.0);
        });
    }
    if !proof.cores.is_empty() {
        add("no cores", &|of| of.cores.clear());
    }
    if proof.enclosure.is_some() {
        add("no enclosure", &|of| of.enclosure = None);
        add("a hole in the enclosure", &|of| {
            if let Some(surface) = &mut of.enclosure {
                surface.triangles.pop();
                surface.normals.pop();
            }
        });
        add("another vertex", &|of| {
            if let Some(surface) = &mut of.enclosure {
                surface.pairs[0].moving.0 = u32::MAX;
            }
        });
    }
    all
}

/// Checks that a proof holds, and that changed proofs do not.
fn assert_proven(pair: &Pair<'_, Solid>, name: &str) -> DepthCertificate {
    let proof = pair.certified_depth().expect("a depth");
    let width = pair.verify_depth(&proof).unwrap_or_else(|why| panic!("{name}: {why}: {proof:?}"));
    assert!(width >= 0.0, "{name}");
    for (change, other) in changed(&proof, pair.moving_pose().translation()) {
        assert!(pair.verify_depth(&other).is_err(), "{name}: {change}: {other:?}");
    }
    proof
}

#[test]
fn depth_proofs_of_polycubes_hold_and_enclose_exact_depths() {
    let (mut overlapping, mut tight) = (0, 0);
    for seed in 0..cases(120) {
        let mut random = Random::new(seed);
        let [moving, fixed] = [Polycube::random(&mut random), Polycube::random(&mut random)];
        let by = quarters(&mut random, -18, 18);
        let solids = [moving.drawn_solid(&mut random), fixed.drawn_solid(&mut random)];
        let pair = Pair::new(solids[0].at(at(by)), solids[1].at(Pose::IDENTITY)).expect("a pair");
        let proof = assert_proven(&pair, &format!("{seed}"));
        let square = exact_squared_depth(&moving, &fixed, by);
        let [low, high] = [proof.lower, proof.upper].map(|x| x * x);
        assert!(low <= square && square <= high, "{seed}: {square} {proof:?}");
        overlapping += usize::from(square > 0.0);
        tight += usize::from(square > 0.0 && proof.lower > 0.5 * square.sqrt());
        if square > 0.0 {
            assert!(proof.lower > 0.0, "{seed}");
            let swapped = Pair::new(solids[1].at(at(by)), solids[0].at(Pose::IDENTITY));
            assert!(swapped.expect("a pair").verify_depth(&proof).is_err(), "{seed}");
        }
    }
    assert!(overlapping > cases(40) && 2 * tight > overlapping, "{tight} of {overlapping}");
}

#[test]
fn depth_proofs_of_turned_bodies_hold() {
    for seed in 0..cases(60) {
        let mut random = Random::new(seed);
        let [moving, fixed] = [Polycube::random(&mut random), Polycube::random(&mut random)];
        let pose = Pose::new(random.rotation(), random.vector() * 4.0).expect("a pose");
        let turn = Pose::new(random.rotation(), random.vector()).expect("a pose");
        let pair = Pair::new(moving.solid.at(pose), fixed.solid.at(turn)).expect("a pair");
        assert_proven(&pair, &format!("{seed}"));
    }
}

#[test]
fn depth_proofs_of_convex_bodies_have_enclosures_and_agree_with_hulls() {
    for seed in 0..cases(120) {
        let mut random = Random::new(seed);
        let mut hull = || {
            let points: Vec<DVec3> = (0..20).map(|_| random.vector()).collect();
            ConvexPolyhedron::from_points(&points).expect("a hull")
        };
        let hulls = [hull(), hull()];
        let poses =
            [0, 1].map(|_| Pose::new(random.rotation(), random.vector() * 0.5).expect("a pose"));
        let of_hulls = Pair::new(hulls[0].at(poses[0]), hulls[1].at(poses[1])).expect("a pair");
        let exact = of_hulls.depth().expect("a depth");
        let solids = hulls.each_ref().map(|hull| hull.as_solid().expect("a solid"));
        let pair = Pair::new(solids[0].at(poses[0]), solids[1].at(poses[1])).expect("a pair");
        let proof = assert_proven(&pair, &format!("{seed}"));
        assert!(proof.lower <= exact.upper && exact.lower <= proof.upper, "{seed}");
        if exact.lower > 1e-6 {
            assert!(proof.enclosure.is_some(), "{seed}");
            assert!(proof.upper - proof.lower < 1e-9, "{seed}: {proof:?}");
        }
    }
}

#[test]
fn depth_proofs_of_bodies_that_touch_are_as_small_as_rounding() {
    let cube = cuboid([0.0; 3], [1.0; 3]);
    let apart = [DVec3::new(1.5, 0.0, 0.0), DVec3::new(0.25, 3.0, 0.0)];
    let touching = [
        DVec3::new(1.0, 0.25, 0.0),
        DVec3::new(1.0, 1.0, 0.5),
        DVec3::ONE,
        DVec3::new(0.25, -1.0, 0.25),
    ];
    for by in apart.into_iter().chain(touching) {
        let pair = Pair::new(cube.at(at(by)), cube.at(Pose::IDENTITY)).expect("a pair");
        let proof = assert_proven(&pair, &format!("{by}"));
        assert_eq!(proof.lower, 0.0);
        assert_eq!(proof.upper == 0.0, apart.contains(&by), "{by}: {proof:?}");
        assert!(proof.upper < 1e-12, "{by}: {proof:?}");
    }
}
