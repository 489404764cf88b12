//! Tests machines with a known order of disassembly: default plans find it.

use colltrans_assembly::plan::{Plan, PlanOptions};
use colltrans_assembly::report::html;
use colltrans_assembly::roles::Role;
use colltrans_assembly::suggest::apply_suggestions;
use colltrans_assembly::{Analysis, AnalysisRequest, Assembly, Bodies, Fit, Part, Piece, Watch};
use colltrans_mesh::Mesh;
use colltrans_testkit::machines::{
    NamedPart, TABLE_LEGS, flange, radial_engine, screwed_table, threaded_block,
};
use glam::DAffine3;

/// Builds an assembly.
fn assembled(parts: Vec<NamedPart>) -> Assembly {
    let piece = |mesh: colltrans_testkit::shapes::Mesh| Piece {
        mesh: Mesh::new(mesh.vertices, mesh.faces),
        world_from_piece: DAffine3::IDENTITY,
    };
    let part = |(name, bodies): NamedPart| {
        crate::common::part(&name, &bodies.into_iter().map(piece).collect::<Vec<_>>())
    };
    Assembly::new(parts.into_iter().map(part).collect::<Vec<Part>>()).unwrap()
}

/// Returns the parts that each stage removes, and asserts that the plan is complete and that only `last`
/// remains.
fn stage_texts(assembly: &Assembly, plan: &Plan, last: &str) -> Vec<String> {
    assert!(plan.remaining.is_empty() && plan.interlocked.is_empty(), "{:?}", plan.interlocked);
    assert_eq!(assembly.part_names(&plan.base), [last]);
    plan.stages().iter().map(|stage| plan.describe_stage(assembly, stage)).collect()
}

#[test]
fn flange_plan_removes_bolts_first_and_nuts_last() {
    for bolts in [4, 12] {
        let assembly = assembled(flange(bolts, 16));
        let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
        let plan = crate::common::planned(&bodies, PlanOptions::default());
        let all = |what: &str| format!("{bolts} x {what}");
        let known = [all("bolt"), all("washer"), "upper".into(), "gasket".into(), all("nut")];
        assert_eq!(stage_texts(&assembly, &plan, "lower"), known);
        let nut = plan.steps.last().unwrap();
        assert!(nut.direction.z < -0.999 && nut.travel.value < 9.0, "{nut:?}");
    }
}

#[test]
fn radial_engine_plan_finishes_each_cylinder() {
    let assembly = assembled(radial_engine(5));
    let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
    let plan = crate::common::planned(&bodies, PlanOptions::default());
    let stage_texts = stage_texts(&assembly, &plan, "case");
    let at = |name: &str| {
        let found = stage_texts.iter().position(|step| step == name);
        found.unwrap_or_else(|| panic!("no {name} in {stage_texts:?}"))
    };
    // All heads are removed first, then one cylinder after another. The parts freed by a barrel are removed
    // at once.
    assert!(at("5 x screw") < at("cover") && at("cover") < at("shaft"), "{stage_texts:?}");
    for k in 0..5 {
        let chain = ["barrel", "pin", "piston", "rod"].map(|name| at(&format!("{name}_{k}")));
        assert!(at("5 x head") < chain[0], "{stage_texts:?}");
        assert!(chain.windows(2).all(|pair| pair[1] == pair[0] + 1), "{stage_texts:?}");
    }
    assert_eq!(stage_texts.len(), 4 + 5 * 4, "{stage_texts:?}");
    let repeats = plan.repeated_stages(&plan.stages());
    assert_eq!(repeats.last(), Some(&(4..8, 5)), "{repeats:?}");
    assert_eq!(repeats.len(), 5);
    let findings =
        AnalysisRequest::default().analyse_without_plan(&bodies, Watch::default()).unwrap();
    let page = html::report_page(&Analysis { plan, ..findings }, "engine");
    assert_eq!(page.matches("class=\"sheet step\"").count(), 4 + 4);
    assert!(page.contains("barrel_4") && page.contains("rod_3"));
}

/// Asserts that steps that unscrew parts are proven and free of the remaining parts.
fn assert_unscrewing_is_free(assembly: &Assembly, plan: &Plan, turns: std::ops::Range<f64>) {
    let mut left: Vec<usize> = (0..assembly.parts().len()).collect();
    for step in &plan.steps {
        left.retain(|part| !step.parts.contains(part));
        if let Some(turn) = step.first_turn() {
            assert!(turns.contains(&turn.turns.abs()), "{turn:?}");
            crate::common::turns_freely(assembly, step, &left);
        }
    }
}

/// Threads with clearance, which do not overlap, are suggested, and the plan unscrews them.
#[test]
#[ignore = "long: threads of many facets"]
fn threads_with_clearance_are_suggested_and_unscrewed() {
    let drawn = assembled(threaded_block());
    let fit = Fit::default_for(&drawn);
    let found = crate::common::suggested(&Bodies::new(&drawn, fit).unwrap());
    let pairs: Vec<Vec<&str>> = found.iter().map(|s| drawn.part_names(&s.parts)).collect();
    assert_eq!(pairs, [["base", "screw_0"], ["base", "screw_1"]], "{found:?}");
    assert!(
        found.iter().all(|s| s.fit.role == Some(Role::Thread) && s.reason.ends_with("with play"))
    );
    let assembly = apply_suggestions(drawn.clone(), &found).unwrap();
    let bodies = Bodies::new(&assembly, fit).unwrap();
    let plan = crate::common::planned(&bodies, PlanOptions::default());
    assert_eq!(stage_texts(&assembly, &plan, "base"), ["2 x screw", "cap", "shaft"]);
    assert!(plan.steps[..2].iter().all(|step| step.first_turn().is_some()), "{plan:?}");
    assert_unscrewing_is_free(&assembly, &plan, 1.8..2.3);
}

#[test]
#[ignore = "long: threads of many facets"]
fn legs_overlapping_their_threads_are_rotated_and_unscrewed() {
    let drawn = assembled(screwed_table());
    let fit = Fit::default_for(&drawn);
    let found = crate::common::suggested(&Bodies::new(&drawn, fit).unwrap());
    assert_eq!(found.len(), 4, "{found:?}");
    let assembly = apply_suggestions(drawn.clone(), &found).unwrap();
    let bodies = Bodies::new(&assembly, fit).unwrap();
    let plan = crate::common::planned(&bodies, PlanOptions::default());
    assert_eq!(stage_texts(&assembly, &plan, "top"), ["4 x leg"]);
    for step in &plan.steps {
        let (by, aside) = TABLE_LEGS[step.parts[0] - 1];
        let turn = step.first_turn().unwrap();
        let known = glam::DVec2::from(aside).length();
        assert!(
            turn.proof.as_ref().is_ok_and(|proof| proof.tolerance == fit.tolerance()),
            "{turn:?}"
        );
        // The leg moves down, therefore the rotation is reversed in its direction.
        assert!((turn.initial_turns - by).abs() < 0.1, "{by} {turn:?}");
        assert!((turn.offset.length() - known).abs() < 0.02, "{aside:?} {turn:?}");
    }
    assert_unscrewing_is_free(&assembly, &plan, 1.95..2.1);
}
