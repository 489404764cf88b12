//! Distances of solids against exact arithmetic, and their proofs.

use colltrans_convex::{ConvexPolyhedron, Pair, Pose, QueryError, Within};
use colltrans_solid::proof::{Apart, Cover, DistanceCertificate};
use colltrans_solid::{Solid, SolidNear, SolidPair};
use colltrans_testkit::bodies::hull;
use colltrans_testkit::cases;
use colltrans_testkit::oracle::settings;
use colltrans_testkit::oracle::solids::nearest::{DistanceOutcome, MESHES, Setting};
use colltrans_testkit::oracle::solids::settings::FAMILIES;
use colltrans_testkit::oracle::solids::sheets;
use colltrans_testkit::random::Random;
use colltrans_testkit::solids::bumpy_ball;
use glam::{DMat3, DQuat, DVec3};

use crate::common::{cuboid, solid};

fn place(at: [f64; 3]) -> Pose {
    Pose::from_translation(DVec3::from_array(at)).expect("a place")
}

#[test]
fn distances_agree_with_exact_arithmetic() {
    let convex = settings::FAMILIES.iter().map(|f| format!("convex-{}", f.0));
    let known = FAMILIES.into_iter().chain(sheets::FAMILIES).chain(MESHES);
    let mut seen = [0; 4];
    for family in known.map(str::to_owned).chain(convex) {
        for seed in 0..if MESHES.contains(&family.as_str()) { cases(30) } else { cases(8) } {
            let Some(setting) = Setting::draw(&family, seed).expect("a family") else { continue };
            match setting.examine() {
                Ok(kind) => seen[kind as usize] += 1,
                Err(error) => panic!("{family}:{seed}: {error}"),
            }
        }
    }
    for (kind, least) in [
        (DistanceOutcome::Touching, 20),
        (DistanceOutcome::Inside, 2),
        (DistanceOutcome::Near, 20),
        (DistanceOutcome::Apart, 20),
    ] {
        assert!(seen[kind as usize] > cases(least), "{kind:?} only {} times", seen[kind as usize]);
    }
}

#[test]
fn boxes_whose_distances_are_known() {
    let cube = cuboid([0.0; 3], [1.0; 3]);
    for (gap, lengths) in [(1e-3, 1.0), (1e-9, 1.0), (2.0_f64.powi(-45), 1.0), (1e-60, 1e-50)] {
        let cube = Solid::from_mesh(
            &cube.vertices().iter().map(|v| *v * lengths).collect::<Vec<_>>(),
            cube.triangles(),
        )
        .expect("a box");
        let there = place([lengths + gap, 0.25 * lengths, 0.0]);
        let pair = Pair::new(cube.at(Pose::IDENTITY), cube.at(there)).expect("a pair");
        let found = pair.distance().expect("a distance");
        let exact = (lengths + gap) - lengths;
        assert!(found.lower <= exact && exact <= found.upper, "{found:?} {exact:e}");
        assert!(found.upper - found.lower <= 3e-14 * 4.0 * lengths, "{found:?}");
    }
}

#[test]
fn what_meets_is_zero_apart() {
    let (cube, small) = (cuboid([0.0; 3], [1.0; 3]), cuboid([0.25; 3], [0.5; 3]));
    let turned = Pose::new(DQuat::from_rotation_z(0.1), DVec3::ZERO).expect("a pose");
    for (a, b, pose) in [
        (&cube, &cube, place([1.0, 0.0, 0.0])),
        (&cube, &cube, place([1.0, 1.0, 1.0])),
        (&cube, &cube, place([0.5, 0.5, 0.5])),
        (&cube, &small, Pose::IDENTITY),
        (&small, &cube, Pose::IDENTITY),
        (&cube, &cube, turned),
    ] {
        let pair = Pair::new(a.at(pose), b.at(Pose::IDENTITY)).expect("a pair");
        let (found, proof) = pair.certified_distance().expect("a distance");
        assert_eq!(found.bounds(), [0.0; 2], "{found:?}");
        assert!(matches!(found.near, SolidNear::Meeting(_)) && found.gap.is_none());
        assert!((found.on_moving - found.on_fixed).length() < 1e-14, "{found:?}");
        assert_eq!(pair.verify(&proof), Ok(0.0));
        assert!(matches!(pair.within(0.0), Ok(Within::Closer(SolidNear::Meeting(_)))));
    }
}

#[test]
fn features_and_points_of_boxes() {
    let cube = cuboid([0.0; 3], [1.0; 3]);
    for (at, kinds, length) in [
        ([0.25, 0.25, 3.0], ("face", "face"), 2.0),
        ([4.0, 5.0, 0.25], ("edge", "edge"), 5.0),
        ([2.0, 3.0, 3.0], ("vertex", "vertex"), 3.0),
    ] {
        let pair = Pair::new(cube.at(place(at)), cube.at(Pose::IDENTITY)).expect("a pair");
        let found = pair.distance().expect("a distance");
        let features = found.features.expect("they are apart");
        assert_eq!((features.moving.kind(), features.fixed.kind()), kinds, "{at:?}");
        assert_eq!(pair.closest_features(), Ok(Some(features)));
        let way = found.on_fixed - found.on_moving;
        assert!((way.length() - length).abs() < 1e-13, "{found:?}");
        let normal = found.normal.expect("they are apart");
        assert!((normal * length - way).length() < 1e-13, "{found:?}");
    }
}

#[test]
fn a_convex_body_beside_a_solid() {
    let ball = solid(&bumpy_ball(108));
    let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).expect("a box");
    let there = place([3.0, 0.5, 0.25]);
    let mixed = Pair::between(cube.at(there), ball.at(Pose::IDENTITY)).expect("a pair");
    let own = Solid::from_convex(&cube).expect("a solid");
    let solids = Pair::new(own.at(there), ball.at(Pose::IDENTITY)).expect("a pair");
    assert_eq!(mixed.distance(), solids.distance());
    let point = ConvexPolyhedron::from_points(&[DVec3::ZERO]).expect("a point");
    assert!(Pair::between(point.at(there), ball.at(Pose::IDENTITY)).is_ok());
    for length in [-1.0, f64::NAN] {
        assert!(matches!(mixed.within(length), Err(QueryError::Length { .. })));
    }
    assert!(matches!(mixed.within(f64::INFINITY), Ok(Within::Closer(_))));
}

/// All numbers of a proof with one bit changed.
fn changed(proof: &DistanceCertificate, bit: u32) -> Vec<DistanceCertificate> {
    let flip = |x: f64| f64::from_bits(x.to_bits() ^ (1 << bit));
    let mut all = vec![DistanceCertificate { lower: flip(proof.lower), ..proof.clone() }];
    let SolidNear::Points { triangles, weights, distance } = proof.near else { return all };
    let mut push = |triangles, weights, distance| {
        let near = SolidNear::Points { triangles, weights, distance };
        all.push(DistanceCertificate { near, ..proof.clone() });
    };
    push(triangles, weights, flip(distance));
    for k in 0..2 {
        for i in 0..3 {
            let mut other = weights;
            other[k][i] = flip(other[k][i]);
            // Less than any rounding of so small a weight: the same points.
            if bit > 12 && weights[k][i] != 0.0 {
                push(triangles, other, distance);
            }
        }
        // A corner is one of other triangles, too.
        if weights[k].iter().all(|w| *w > 0.0) {
            let mut other = triangles;
            other[k] ^= 1 << (bit % 32);
            push(other, weights, distance);
        }
    }
    all
}

/// Checks whether a proof has the points of another one and weaker numbers, which hold.
fn claims_less(other: &DistanceCertificate, proof: &DistanceCertificate) -> bool {
    let parts = |near| match near {
        SolidNear::Points { triangles, weights, distance } => Some((triangles, weights, distance)),
        SolidNear::Meeting(_) => None,
    };
    let (Some(other_near), Some(near)) = (parts(other.near), parts(proof.near)) else {
        return false;
    };
    let same_points = (other_near.0, other_near.1) == (near.0, near.1);
    same_points && other.lower <= proof.lower && other_near.2 >= near.2
}

#[test]
fn changed_proofs_are_refused() {
    let (a, b) = (solid(&bumpy_ball(108)), solid(&bumpy_ball(48)));
    let pose = Pose::new(DQuat::from_xyzw(0.1, 0.7, -0.2, 0.3).normalize(), DVec3::X * 2.5);
    let pair = Pair::new(a.at(pose.expect("a pose")), b.at(Pose::IDENTITY)).expect("a pair");
    let (found, proof) = pair.certified_distance().expect("a distance");
    assert!(found.lower > 0.0 && pair.verify(&proof).is_ok());
    for bit in 0..64 {
        for other in changed(&proof, bit).iter().filter(|other| !claims_less(other, &proof)) {
            assert!(pair.verify(other).is_err(), "bit {bit}: {other:?}");
        }
    }
    // Entries: another reason proves less, or as much by itself.
    let entries = proof.cover.entries();
    let reasons = [
        None,
        Some(Apart::AxesOfFixed),
        Some(Apart::AxesOfMoving),
        Some(Apart::SlabOfMoving),
        Some(Apart::SlabOfFixed),
        Some(Apart::Way),
        Some(Apart::NearestPlane),
        Some(Apart::Examined),
    ];
    let mut refused = 0;
    for k in 0..entries.len() {
        for reason in reasons.iter().filter(|r| **r != entries[k]) {
            let mut other = entries.to_vec();
            other[k] = *reason;
            let other = DistanceCertificate { cover: Cover::from(other), ..proof.clone() };
            refused += usize::from(pair.verify(&other).is_err());
        }
    }
    assert!(refused > 4 * entries.len(), "{refused} of {}", 7 * entries.len());
    let short = Cover::from(entries[..entries.len() - 1].to_vec());
    assert!(pair.verify(&DistanceCertificate { cover: short, ..proof.clone() }).is_err());
    // The proof of another place.
    let elsewhere = Pair::new(a.at(place([2.5, 0.0, 0.0])), b.at(Pose::IDENTITY)).expect("a pair");
    assert!(elsewhere.verify(&proof).is_err());
}

/// Convex bodies have a proof of one plane over all vertices. Larger bounds, and planes of other facets, are refused.
#[test]
fn proof_of_convex_solids_is_one_plane() {
    let mut random = Random::new(12);
    let (mut planes, mut refused, mut others) = (0, 0, 0);
    for k in 0..cases(400) {
        let count = [8, 20, 90][k as usize % 3];
        let [p, q] = [(); 2].map(|()| Solid::from_convex(&hull(count, &mut random)));
        let [p, q] = [p.expect("a solid"), q.expect("a solid")];
        let rotation = if k % 4 == 0 { DQuat::IDENTITY } else { random.rotation() };
        let far = random.direction() * random.range(1.2, 4.0);
        let pose = Pose::new(rotation, far).expect("a pose");
        let pair = Pair::new(p.at(pose), q.at(Pose::IDENTITY)).expect("a pair");
        let (found, proof) = pair.certified_distance().expect("a distance");
        assert!(pair.verify(&proof).is_ok(), "{k}");
        if proof.cover.entries() != [Some(Apart::NearestPlane)] {
            continue;
        }
        planes += 1;
        assert!(found.upper - found.lower < 1e-13, "{k}: {found:?}");
        let searched = found.steps.nodes;
        assert_eq!(searched, 0, "{k}");
        let more = DistanceCertificate { lower: proof.lower + 1e-13, ..proof.clone() };
        assert!(pair.verify(&more).is_err(), "{k}");
        let SolidNear::Points { triangles: [f, g], .. } = proof.near else { panic!("{k}") };
        let near = SolidNear::Points {
            triangles: [(f + 1) % p.triangles().len() as u32, g],
            weights: [[1.0, 0.0, 0.0]; 2],
            distance: 1e3,
        };
        others += 1;
        let other = DistanceCertificate { near, ..proof.clone() };
        refused += usize::from(pair.verify(&other).is_err());
    }
    assert!(planes > cases(400) as usize / 2, "{planes}");
    assert!(refused > others / 4, "{refused} of {others}");
}

/// Matrices that are off a rotation place bodies that are stretched: boxes, slabs and what lies along them.
#[test]
fn poses_that_stretch_are_where_their_entries_say() {
    let single = |m: DMat3| DMat3::from_cols_array(&m.to_cols_array().map(|x| f64::from(x as f32)));
    let mut random = Random::new(3);
    let mut apart = 0;
    for k in 0..cases(60) {
        let (a, b) = (solid(&bumpy_ball(48)), solid(&bumpy_ball(108)));
        let mut pose = |at: DVec3| {
            let stretch = 1.0 + random.range(-3e-7, 3e-7);
            let m = single(DMat3::from_quat(random.rotation())) * stretch;
            Pose::from_matrix(m, at).expect("nearly a rotation")
        };
        let poses = [pose(DVec3::X * (1.9 + 0.01 * f64::from(k))), pose(DVec3::ZERO)];
        let setting = Setting { solids: [a, b], poses };
        match setting.examine() {
            Ok(seen) => apart += usize::from(seen == DistanceOutcome::Apart),
            Err(error) => panic!("{k}: {error}"),
        }
    }
    assert!(apart > cases(30), "{apart}");
}

/// A proven answer `Farther` states a distance above the length, however near the length is to the distance.
#[test]
fn farther_with_proof_exceeds_the_length() {
    let mut random = Random::new(71);
    let [a, b] = [cuboid([0.0; 3], [1.0, 0.7, 0.4]), cuboid([0.0; 3], [0.3, 0.9, 1.2])];
    let ball = solid(&bumpy_ball(300));
    for _ in 0..cases(400) {
        let (p, q) = [(&a, &b), (&a, &ball), (&ball, &b)][random.int(0, 2) as usize];
        let turn = DQuat::from_euler(
            glam::EulerRot::ZYX,
            random.range(-3.0, 3.0),
            random.range(-1.5, 1.5),
            random.range(-3.0, 3.0),
        );
        let far = DVec3::new(random.range(-4.0, 4.0), random.range(-4.0, 4.0), 3.5);
        let pair = Pair::new(p.at(Pose::new(turn, far).expect("a pose")), q.at(Pose::IDENTITY))
            .expect("a pair");
        let found = pair.distance().expect("a distance");
        let noise = 32.0 * f64::EPSILON * 6.0;
        let proven = pair.certified_distance().expect("an answer").1.lower;
        let lengths = [found.lower.next_down(), proven, proven.next_up()];
        let spread = (-32..=32).map(|k| found.lower + f64::from(k) * noise / 32.0);
        for length in lengths.into_iter().chain(spread) {
            let (answer, proof) = pair.certified_within(length).expect("an answer");
            match answer {
                Within::Farther(gap) => {
                    assert!(gap.gap > length, "{gap:?} {length:e} {found:?}");
                    assert_eq!(proof.expect("a proof").lower, gap.gap);
                }
                Within::Undecided(of) => {
                    assert!(of.lower <= length && length <= of.upper, "{of:?} {length:e}");
                }
                Within::Closer(near) => assert!(near.distance() <= length),
            }
        }
    }
}
