//! Proofs between solids: they hold, and what is changed in them is refused.

use colltrans_convex::{Cast, CertificateError, Clearance, Pose};
use colltrans_solid::proof::{Reason, SolidCertificate, StartProof};
use colltrans_solid::{Overlap, Solid, SolidCast, SolidFree, SolidOptions, StartOverlap};
use colltrans_testkit::oracle::solids::proof::approve;
use colltrans_testkit::solids::{bolt, bumpy_ball, slab, washer};
use glam::{DQuat, DVec3};

use crate::common::solid;

fn cast<'a>(a: &'a Solid, b: &'a Solid, from: DVec3, direction: DVec3) -> Cast<'a, Solid> {
    let pose = Pose::from_translation(from).expect("in range");
    Cast::new(a.at(pose), b.at(Pose::IDENTITY), direction).expect("a direction")
}

/// Asks, checks, and returns the proof.
fn proven(cast: &Cast<Solid>) -> SolidCertificate {
    let (answer, certificate) = cast.certified_clearance().expect("an answer");
    assert_eq!(answer, cast.clearance().expect("an answer"));
    let gap = cast.verify(&certificate).unwrap_or_else(|e| panic!("{e}: {certificate:?}"));
    assert!(gap < 1e-9);
    certificate
}

fn blocked() -> (Solid, Solid) {
    (solid(&bolt([1.0, 2.0], [-5.0, 8.0, 9.0], 12)), solid(&washer([1.5, 4.0], [0.0, 1.0], 9)))
}

#[test]
fn answers_of_every_kind_are_proven() {
    let (bolt, plate) = blocked();
    let down = proven(&cast(&bolt, &plate, DVec3::ZERO, DVec3::NEG_Z));
    assert!((down.lower - 7.0).abs() < 1e-10 && down.stop.is_some());
    let up = proven(&cast(&bolt, &plate, DVec3::ZERO, DVec3::Z));
    assert!(up.lower == f64::INFINITY && up.stop.is_none());
    let deep = proven(&cast(&bolt, &plate, DVec3::X, DVec3::Z));
    assert!(matches!(deep.start, StartProof::Overlapping(_)));
    let ignore = SolidOptions::default().with_start_overlap(StartOverlap::Ignore);
    proven(&cast(&bolt, &plate, DVec3::X, DVec3::NEG_Z).with_options(ignore).expect("choices"));
    let far = SolidOptions::default().with_before(2.0);
    let short = cast(&bolt, &plate, DVec3::ZERO, DVec3::NEG_Z).with_options(far).expect("choices");
    assert!((proven(&short).lower - 2.0).abs() < 1e-11);
    let turned = Pose::new(DQuat::from_xyzw(0.1, 0.7, -0.2, 0.3).normalize(), DVec3::Z * 20.0);
    let turned =
        Cast::new(bolt.at(turned.expect("a pose")), plate.at(Pose::IDENTITY), DVec3::NEG_Z);
    proven(&turned.expect("a direction"));
}

#[test]
fn a_plane_between_the_bodies_comes_with_free() {
    let (bolt, plate) = blocked();
    let beside = cast(&bolt, &plate, DVec3::new(7.0, 0.5, 3.0), DVec3::NEG_Z);
    let free = beside.clearance().expect("an answer");
    let Clearance::Free(SolidFree { separation: Some(plane), .. }) = free else { panic!("beside") };
    assert!(plane.margin > 0.9 && plane.normal.z.abs() < 1e-15);
    assert!(beside.verify(&plane).expect("a plane") > 0.9);
    let mut wrong = plane;
    wrong.margin += 1e-6;
    assert!(matches!(beside.verify(&wrong), Err(CertificateError::Bound { .. })));
    wrong = plane;
    wrong.normal = DVec3::Z;
    assert!(matches!(beside.verify(&wrong), Err(CertificateError::Normal { .. })));
    // In the hole there is no such plane, and it is free all the same.
    let through = cast(&bolt, &plate, DVec3::ZERO, DVec3::Z).clearance().expect("an answer");
    assert!(matches!(through, Clearance::Free(SolidFree { separation: None, .. })));
}

#[test]
fn every_field_that_is_changed_is_refused() {
    let (bolt, plate) = blocked();
    let ask = cast(&bolt, &plate, DVec3::ZERO, DVec3::NEG_Z);
    let proof = proven(&ask);
    let refused = |change: &dyn Fn(&mut SolidCertificate)| {
        let mut changed = proof.clone();
        change(&mut changed);
        assert_ne!(changed, proof);
        ask.verify(&changed).expect_err("a changed proof")
    };
    assert!(matches!(refused(&|p| p.tolerance = 1e-3), CertificateError::OtherTolerance { .. }));
    assert_eq!(refused(&|p| p.start = StartProof::Assumed), CertificateError::StartClaim);
    let overlapping = StartProof::Overlapping(Overlap::Facets(0, 0));
    assert_eq!(refused(&|p| p.start = overlapping.clone()), CertificateError::StartClaim);
    for inside in [Overlap::MovingInside(0), Overlap::FixedInside(0), Overlap::Facets(9_999, 0)] {
        refused(&|p| p.start = StartProof::Overlapping(inside));
    }
    assert!(matches!(refused(&|p| p.lower += 1e-6), CertificateError::Cover { .. }));
    for less in [1e-3, 7.0, -1.0, f64::NAN] {
        refused(&|p| p.lower -= less);
    }
    refused(&|p| p.lower = f64::INFINITY);
    assert!(matches!(refused(&|p| p.stop = None), CertificateError::Bound { .. }));
    for more in [1e-6, -1e-6, 3.0, f64::NAN] {
        let far =
            |p: &mut SolidCertificate| p.stop.as_mut().expect("a stop").offset_distance += more;
        assert!(matches!(refused(&far), CertificateError::Bound { .. }));
    }
    for triangle in [0, 1, 2, 1_000_000] {
        for side in 0..2 {
            let mut other = proof.clone();
            other.stop.as_mut().expect("a stop").triangles[side] = triangle;
            // Another facet of the head may stop it at the same place.
            if ask.verify(&other).is_ok() {
                approve(&ask, &other, 1e-9).expect("as true as the one that was found");
            }
        }
    }
}

#[test]
fn covers_that_are_changed_are_refused_or_true() {
    let (bolt, plate) = blocked();
    let reasons = [
        None,
        Some(Reason::MovingFacesAway),
        Some(Reason::FixedFacesAway),
        Some(Reason::ShadowsApart),
        Some(Reason::Parting),
        Some(Reason::NotBefore),
        Some(Reason::Examined),
        Some(Reason::Disjoint),
        Some(Reason::FaceToFace),
    ];
    let ask = cast(&bolt, &plate, DVec3::ZERO, DVec3::NEG_Z);
    let proof = proven(&ask);
    approve(&ask, &proof, 1e-9).expect("in fractions");
    let letters = proof.cover.entries().to_vec();
    let (mut refused, mut as_true) = (0, 0);
    for k in 0..letters.len() {
        for reason in reasons.into_iter().filter(|r| *r != letters[k]) {
            let mut changed = proof.clone();
            let mut entries = letters.clone();
            entries[k] = reason;
            changed.cover = entries.into();
            if ask.verify(&changed).is_err() {
                refused += 1;
            } else {
                approve(&ask, &changed, 1e-9).expect("another reason that holds");
                as_true += 1;
            }
        }
        let mut cut = proof.clone();
        cut.cover = letters[..k].to_vec().into();
        assert!(matches!(ask.verify(&cut), Err(CertificateError::Cover { .. })), "{k}");
    }
    assert!(refused > 4 * as_true, "{refused} refused, {as_true} as true");
    let mut longer = proof.clone();
    longer.cover = [&letters[..], &[Some(Reason::Examined)]].concat().into();
    assert_eq!(ask.verify(&longer), Err(CertificateError::Cover { entry: letters.len() }));
    let StartProof::Apart(start) = &proof.start else { panic!("apart") };
    for k in 0..start.len() {
        let mut cut = proof.clone();
        cut.start = StartProof::Apart(start.entries()[..k].to_vec().into());
        assert!(matches!(ask.verify(&cut), Err(CertificateError::Cover { .. })), "{k}");
    }
}

#[test]
fn proofs_are_small() {
    let ball = solid(&bumpy_ball(16_000));
    let proof = proven(&cast(&ball, &ball, DVec3::new(0.3, 0.2, 4.0), DVec3::NEG_Z));
    assert!(proof.cover.len() < 4_000, "{} entries", proof.cover.len());
    // Where it rests there is nothing to be shown below.
    let plate = solid(&slab(DVec3::ZERO, DVec3::ONE, [40, 40, 2]));
    let rests = proven(&cast(&plate, &plate, DVec3::Z, DVec3::NEG_Z));
    assert_eq!((rests.lower, rests.cover.len()), (0.0, 1));
}

#[test]
fn proofs_as_files() {
    let (bolt, plate) = blocked();
    for (from, direction) in [
        (DVec3::ZERO, DVec3::NEG_Z),
        (DVec3::ZERO, DVec3::Z),
        (DVec3::X, DVec3::Z),
        (DVec3::X * 9.0, DVec3::NEG_X),
    ] {
        let ask = cast(&bolt, &plate, from, direction);
        let proof = proven(&ask);
        let text = proof.to_json();
        let read = SolidCertificate::from_json(&text).expect("what was written");
        assert_eq!(read, proof);
        assert_eq!(read.to_json(), text);
        ask.verify(&read).expect("the same proof");
        assert!(SolidCertificate::from_json(&text.replace("solid 1", "solid 2")).is_err());
        assert!(SolidCertificate::from_json(&text.replace("cover\":\"", "cover\":\"?")).is_err());
    }
}
