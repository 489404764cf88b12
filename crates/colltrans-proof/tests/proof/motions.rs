//! Files about motions: queries are read back with the same bits, and proofs of several pairs or of solids
//! hold.

use colltrans_convex::{ConvexPolyhedron, Pose};
use colltrans_motion::{Motion, MotionCast, MotionOutcome, MotionProof};
use colltrans_proof::{MotionCase, ProofFile};
use colltrans_testkit::oracle::settings::{FAMILIES, setting};
use glam::DVec3;

#[test]
fn motion_case_round_trips_exactly() {
    for (family, ..) in FAMILIES {
        for seed in 0..10 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("bodies");
            let cast = setting.query(&bodies).expect("a query");
            let (a, b) = (cast.moving_pose(), cast.fixed_pose());
            let x = 0.1 + seed as f64;
            let Ok(turn) = Motion::rotation_about(a, b.translation(), cast.direction(), x) else {
                continue;
            };
            let Ok(back) = Motion::between_poses(b, a) else { continue };
            let asked =
                MotionCast::new(cast.moving().with_motion(&turn), cast.fixed().with_motion(&back));
            let asked = asked.expect("a cast");
            let asked = match seed % 3 {
                0 => asked,
                1 => asked.with_min_gap(0.25).expect("a gap"),
                _ => asked.with_tolerance(0.25).expect("a depth"),
            };
            let saved = MotionCase::from_cast(&asked).to_json();
            let case = MotionCase::from_json(&saved).unwrap_or_else(|e| panic!("{setting}: {e}"));
            let again = case.cast();
            assert_eq!(MotionCase::from_cast(&again).to_json(), saved, "{setting}");
            assert_eq!([again.min_gap(), again.tolerance()], [asked.min_gap(), asked.tolerance()]);
            let answers = [&asked, &again].map(|cast| format!("{:?}", cast.first_contact()));
            assert_eq!(answers[0], answers[1], "{setting}");
        }
    }
}

#[test]
fn invalid_motion_case_is_rejected_with_reason() {
    let setting = setting("boxes", 3);
    let bodies = setting.bodies().expect("bodies");
    let cast = setting.query(&bodies).expect("a query");
    let slide = Motion::translation(cast.moving_pose(), cast.direction()).expect("a motion");
    let asked =
        MotionCast::new(cast.moving().with_motion(&slide), cast.fixed().at(cast.fixed_pose()));
    let asked = asked.expect("a cast");
    let good = MotionCase::from_cast(&asked).to_json();
    let proof = ProofFile::of_motion(&asked, &asked.first_contact().expect("an answer")).to_json();
    for (wrong, why) in [
        ("{}".to_owned(), "not a saved query"),
        (cast.to_json(), "the format is"),
        (proof.clone(), "the format is"),
        (proof.replace("colltrans proof", "colltrans motion case 1"), "unknown field `version`"),
        (good.replace("\"since\":0.0", "\"since\":0.5"), "time"),
        (good.replace("\"rate\":0.0", "\"rate\":1e9"), "angle"),
        (good.replace("\"format\"", "\"min_gap\":1e70,\"format\""), "gap"),
        (good.replace("\"format\"", "\"min_gap\":-1e70,\"format\""), "tolerance"),
        (good.replace("\"format\"", "\"min_gap\":1e999,\"format\""), "larger than any double"),
        (good.replace("\"moving_motion\"", "\"motion\""), "unknown field `motion`"),
    ] {
        let error = MotionCase::from_json(&wrong).expect_err(why).to_string();
        assert!(error.contains(why), "{error}, not {why}");
    }
    let other = good.replace("colltrans motion case 1", "colltrans proof");
    let error = ProofFile::from_json(&other).expect_err("no proof").to_string();
    assert_eq!(error, "the version of the format is missing, not 2");
}

/// In a file of several pairs, a proof that treats the bodies as solids is stored as one of solids, which
/// `check.py` reads.
#[test]
fn joined_motion_proofs_store_solid_proof_as_solids() {
    let cube = ConvexPolyhedron::cuboid(DVec3::splat(-0.5), DVec3::splat(0.5)).unwrap();
    let turn = Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, 0.5).unwrap();
    let rest = Motion::at_rest(Pose::from_translation(DVec3::X * 1.5).unwrap());
    let cast = MotionCast::new(cube.with_motion(&turn), cube.with_motion(&rest)).unwrap();
    let solids = MotionCast::between_any(cube.with_motion(&turn), cube.with_motion(&rest)).unwrap();
    let solids = solids.with_tolerance(0.0).unwrap().certified_first_contact().unwrap();
    let convex = cast.first_contact().unwrap();
    let MotionOutcome::Free(mut free) = convex.clone() else { panic!("{convex:?}") };
    // Simulate a pair whose planes do not suffice.
    free.proof.spans.clear();
    free.proof.solids = Some(Box::new(solids.proof().clone()));
    let files = [MotionOutcome::Free(free), convex].map(|of| ProofFile::of_motion(&cast, &of));
    let bounds = files.iter().map(|file| file.check().unwrap().time_bounds().unwrap());
    let bounds = bounds.fold([1.0, f64::INFINITY], |all, [lower, upper]| {
        [f64::min(all[0], lower), f64::min(all[1], upper)]
    });
    let saved = ProofFile::of_motions(files.to_vec()).unwrap().to_json();
    for kind in ["\"solids\":{\"parts\"", "\"convex\":{\"spans\""] {
        assert_eq!(saved.matches(kind).count(), 1, "{kind}");
    }
    let read = ProofFile::from_json(&saved).unwrap();
    assert_eq!(read.check().unwrap().time_bounds(), Some(bounds));
    assert_eq!(read.to_json(), saved);
    assert!(read.to_string().starts_with("of 2 pairs of bodies "), "{read}");
    let other = saved.replace("\"solids\":", "\"path\":");
    assert!(other != saved && ProofFile::from_json(&other).is_err());
}

/// A block slides past a cube at distance 5e-4. For bodies with a hull error of 1e-3, which only a file can
/// have, the facets alone prove nothing.
#[test]
fn solid_proof_does_not_cover_hull_error() {
    let block = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).unwrap();
    let beside = Pose::from_translation(DVec3::new(1.0 + 5e-4, -3.0, 0.0)).unwrap();
    let (rest, slide) =
        (Motion::at_rest(Pose::IDENTITY), Motion::translation(beside, DVec3::Y * 6.0));
    let slide = slide.unwrap();
    let cast = MotionCast::new(block.with_motion(&slide), block.with_motion(&rest)).unwrap();
    let solids =
        MotionCast::between_any(block.with_motion(&slide), block.with_motion(&rest)).unwrap();
    let solids = solids.with_tolerance(0.0).unwrap().certified_first_contact().unwrap();
    let mut proof = cast.first_contact().unwrap().proof().clone();
    (proof.spans, proof.meeting) = (Vec::new(), None);
    proof.solids = Some(Box::new(solids.proof().clone()));
    assert_eq!(cast.verify(&proof).unwrap(), [1.0, f64::INFINITY]);
    let text =
        MotionCase::from_cast(&cast).to_json().replace("\"hull_error\":0.0", "\"hull_error\":1e-3");
    let case = MotionCase::from_json(&text).unwrap();
    assert!(case.cast().verify(&proof).is_err(), "{text}");
}

/// The search of solids does not answer queries with a tolerated depth, because [`MotionCast::verify`] rejects such
/// proofs. A depth below the hull error of the bodies is no exception.
#[test]
fn tolerated_depth_below_hull_error_is_not_searched_as_solids() {
    let block = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).unwrap();
    let rest = Motion::at_rest(Pose::IDENTITY);
    let away = Motion::at_rest(Pose::from_translation(DVec3::X * 3.0).unwrap());
    let cast = MotionCast::new(block.with_motion(&away), block.with_motion(&rest)).unwrap();
    let text =
        MotionCase::from_cast(&cast).to_json().replace("\"hull_error\":0.0", "\"hull_error\":1e-3");
    let case = MotionCase::from_json(&text).unwrap();
    let solids = case.cast().as_solid_cast().unwrap().certified_first_contact().unwrap();
    let proof =
        MotionProof { solids: Some(Box::new(solids.proof().clone())), ..MotionProof::default() };
    assert_eq!(case.cast().verify(&proof).unwrap(), [1.0, f64::INFINITY]);
    let tolerant = case.cast().with_tolerance(1e-3).unwrap();
    assert!(tolerant.verify(&proof).is_err());
    assert!(tolerant.as_solid_cast().is_err());
}
