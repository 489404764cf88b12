//! Queries as files: the same bits again, and no file that is not one.
#![cfg(feature = "json")]

use colltrans::motion::{Motion, MotionCase, MotionCast};
use colltrans::{Case, CaseError, Options, ProofFile, Solver, cta};
use colltrans_testkit::oracle::settings::{FAMILIES, NEARLY_FLAT, setting};

#[test]
fn every_family_comes_back_in_bits() {
    for (family, ..) in FAMILIES {
        for seed in 0..40 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("bodies");
            for solver in [Solver::Portal, Solver::Cta] {
                let cast = setting.query(&bodies).expect("a query").with_solver(solver);
                let saved = cast.to_json();
                let case = Case::from_json(&saved).unwrap_or_else(|e| panic!("{setting}: {e}"));
                let again = case.cast().expect("checked");
                assert_eq!(again.to_json(), saved, "{setting}");
                // Debug prints a number so that it reads back as the same bits.
                let answers = [cast, again].map(|cast| {
                    let range = cast.contact_range().expect("an answer");
                    let outcome = cast.first_contact().expect("an answer");
                    format!("{range:?} {outcome:?}")
                });
                assert_eq!(answers[0], answers[1], "{setting}");
            }
        }
    }
}

/// Their vertices are corners of a hull in which nothing is merged, or little.
#[test]
fn nearly_flat_bodies_come_back() {
    for family in NEARLY_FLAT {
        for seed in 0..1_000 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("bodies");
            let saved = setting.query(&bodies).expect("a query").to_json();
            let case = Case::from_json(&saved).unwrap_or_else(|e| panic!("{setting}: {e}"));
            assert_eq!(case.cast().expect("checked").to_json(), saved, "{setting}");
        }
    }
}

#[test]
fn choices_come_back() {
    let setting = setting("boxes", 3);
    let bodies = setting.bodies().expect("bodies");
    for keeps_to_cell in [false, true] {
        let cuts = if keeps_to_cell { cta::Cuts::Shifted } else { cta::Cuts::Centroid };
        let narrowing = cta::Options::default()
            .with_keeps_to_cell(keeps_to_cell)
            .with_cuts(cuts)
            .with_starts_cold(!keeps_to_cell);
        let options = Options::default().with_narrowing(narrowing);
        let cast = setting.query(&bodies).expect("a query").with_options(options).expect("valid");
        let case = Case::from_json(&cast.to_json()).expect("a case");
        assert_eq!(case.cast().expect("checked").options(), options);
    }
}

#[test]
fn what_is_no_case_is_refused() {
    let setting = setting("boxes", 3);
    let bodies = setting.bodies().expect("bodies");
    let saved = setting.query(&bodies).expect("a query").to_json();
    let refused = |from: &str, to: &str| {
        let changed = saved.replacen(from, to, 1);
        assert_ne!(changed, saved, "{from}");
        Case::from_json(&changed).expect_err(to)
    };
    assert!(matches!(Case::from_json("{}"), Err(CaseError::Syntax(_))));
    assert!(matches!(refused("case 1", "case 2"), CaseError::Format { .. }));
    assert!(matches!(refused("\"faces\":[", "\"faces\":[[0,1,2],"), CaseError::Body { .. }));
    assert!(matches!(refused("\"hull_error\":", "\"hull_error\":-1"), CaseError::Body { .. }));
    assert!(matches!(refused("\"matrix\":[", "\"matrix\":[9"), CaseError::Pose(_)));
    assert!(matches!(
        refused("\"direction\":[", "\"direction\":[1e300,0,0],\"x\":["),
        CaseError::Syntax(_)
    ));
    assert!(matches!(
        refused("\"graze_tolerance\":", "\"graze_tolerance\":-1"),
        CaseError::Query(_)
    ));
}

#[test]
fn motions_come_back_in_bits() {
    for (family, ..) in FAMILIES {
        for seed in 0..10 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("bodies");
            let cast = setting.query(&bodies).expect("a query");
            let (a, b) = (cast.moving_pose(), cast.fixed_pose());
            let x = 0.1 + seed as f64;
            let Ok(turn) = Motion::turn(a, b.translation(), cast.direction(), x) else { continue };
            let Ok(back) = Motion::between(b, a) else { continue };
            let asked = MotionCast::new(cast.moving().along(&turn), cast.fixed().along(&back));
            let asked = asked.expect("a cast");
            let asked = match seed % 3 {
                0 => asked,
                1 => asked.keeping(0.25).expect("a gap"),
                _ => asked.tolerating(0.25).expect("a depth"),
            };
            let saved = MotionCase::of(&asked).to_json();
            let case = MotionCase::from_json(&saved).unwrap_or_else(|e| panic!("{setting}: {e}"));
            let again = case.cast();
            assert_eq!(MotionCase::of(&again).to_json(), saved, "{setting}");
            assert_eq!([again.keep(), again.tolerance()], [asked.keep(), asked.tolerance()]);
            let answers = [&asked, &again].map(|cast| format!("{:?}", cast.first_contact()));
            assert_eq!(answers[0], answers[1], "{setting}");
        }
    }
}

#[test]
fn what_is_no_motion_is_refused() {
    let setting = setting("boxes", 3);
    let bodies = setting.bodies().expect("bodies");
    let cast = setting.query(&bodies).expect("a query");
    let slide = Motion::slide(cast.moving_pose(), cast.direction()).expect("a motion");
    let asked = MotionCast::new(cast.moving().along(&slide), cast.fixed().at(cast.fixed_pose()));
    let asked = asked.expect("a cast");
    let good = MotionCase::of(&asked).to_json();
    let proof = ProofFile::of_motion(&asked, &asked.first_contact().expect("an answer")).to_json();
    for (wrong, why) in [
        ("{}".to_owned(), "not a saved query"),
        (cast.to_json(), "the format is"),
        (proof.clone(), "the format is"),
        (proof.replace("colltrans proof", "colltrans motion case 1"), "unknown field `version`"),
        (good.replace("\"since\":0.0", "\"since\":0.5"), "time"),
        (good.replace("\"rate\":0.0", "\"rate\":1e9"), "angle"),
        (good.replace("\"format\"", "\"keep\":1e70,\"format\""), "gap"),
        (good.replace("\"format\"", "\"keep\":-1e70,\"format\""), "tolerance"),
        (good.replace("\"format\"", "\"keep\":1e999,\"format\""), "larger than any double"),
        (good.replace("\"moving_motion\"", "\"motion\""), "unknown field `motion`"),
    ] {
        let error = MotionCase::from_json(&wrong).expect_err(why).to_string();
        assert!(error.contains(why), "{error}, not {why}");
    }
    let other = good.replace("colltrans motion case 1", "colltrans proof");
    let error = ProofFile::from_json(&other).expect_err("no proof").to_string();
    assert_eq!(error, "the version of the format is missing, not 2");
}
