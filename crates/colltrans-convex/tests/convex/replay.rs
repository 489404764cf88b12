//! Queries as files: the same bits again, and no file that is not one.

use colltrans_convex::{Case, CaseError, Options, Solver, cta};
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
