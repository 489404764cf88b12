//! Machines whose right order is known: plans without options come to it.

use colltrans_assembly::plan::{Plan, PlanOptions};
use colltrans_assembly::report::html;
use colltrans_assembly::roles::Role;
use colltrans_assembly::suggest::applied;
use colltrans_assembly::{Assembly, Bodies, Findings, Fit, Part, Piece, Question, Watch};
use colltrans_mesh::Mesh;
use colltrans_testkit::machines::{
    NamedPart, TABLE_LEGS, flange, radial_engine, screwed_table, threaded_block,
};
use glam::DAffine3;

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

/// What is told of a plan, and that it is whole.
fn told(assembly: &Assembly, plan: &Plan, last: &str) -> Vec<String> {
    assert!(plan.left.is_empty() && plan.stuck.is_empty(), "{:?}", plan.stuck);
    assert_eq!(assembly.names(&plan.last), [last]);
    plan.stages().iter().map(|stage| plan.takes(assembly, stage)).collect()
}

#[test]
fn flanges_come_apart_as_a_mechanic_does_it() {
    for bolts in [4, 12] {
        let assembly = assembled(flange(bolts, 16));
        let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
        let plan = crate::common::planned(&bodies, PlanOptions::default());
        let all = |what: &str| format!("{bolts} x {what}");
        let known = [all("bolt"), all("washer"), "upper".into(), "gasket".into(), all("nut")];
        assert_eq!(told(&assembly, &plan, "lower"), known);
        let nut = plan.steps.last().unwrap();
        assert!(nut.direction.z < -0.999 && nut.travel.value < 9.0, "{nut:?}");
    }
}

#[test]
fn a_radial_engine_comes_apart_cylinder_by_cylinder() {
    let assembly = assembled(radial_engine(5));
    let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
    let plan = crate::common::planned(&bodies, PlanOptions::default());
    let told = told(&assembly, &plan, "case");
    let at = |name: &str| {
        let found = told.iter().position(|step| step == name);
        found.unwrap_or_else(|| panic!("no {name} in {told:?}"))
    };
    // All heads first; then one cylinder after another: what its barrel held is taken care of at once.
    assert!(at("5 x screw") < at("cover") && at("cover") < at("shaft"), "{told:?}");
    for k in 0..5 {
        let chain = ["barrel", "pin", "piston", "rod"].map(|name| at(&format!("{name}_{k}")));
        assert!(at("5 x head") < chain[0], "{told:?}");
        assert!(chain.windows(2).all(|pair| pair[1] == pair[0] + 1), "{told:?}");
    }
    assert_eq!(told.len(), 4 + 5 * 4, "{told:?}");
    let repeats = plan.repeats(&plan.stages());
    assert_eq!(repeats.last(), Some(&(4..8, 5)), "{repeats:?}");
    assert_eq!(repeats.len(), 5);
    let findings = Question::default().look(&bodies, Watch::default()).unwrap();
    let page = html::page(&Findings { plan, ..findings }, "engine");
    assert_eq!(page.matches("class=\"sheet step\"").count(), 4 + 4);
    assert!(page.contains("barrel_4") && page.contains("rod_3"));
}

/// Steps that unscrew parts: proven, and looked at against what is left.
fn unscrewed(assembly: &Assembly, plan: &Plan, turns: std::ops::Range<f64>) {
    let mut left: Vec<usize> = (0..assembly.parts().len()).collect();
    for step in &plan.steps {
        left.retain(|part| !step.parts.contains(part));
        if let Some(turn) = step.turn() {
            assert!(turns.contains(&turn.turns.abs()), "{turn:?}");
            crate::common::turns_freely(assembly, step, &left);
        }
    }
}

/// Threads with play, which do not overlap: found where they hold, and taken as suggested.
#[test]
#[ignore = "long: threads of many facets"]
fn screws_in_modelled_threads_are_found_and_unscrewed() {
    let drawn = assembled(threaded_block());
    let fit = Fit::default_for(&drawn);
    let found = crate::common::suggested(&Bodies::new(&drawn, fit).unwrap());
    let pairs: Vec<Vec<&str>> = found.iter().map(|s| drawn.names(&s.parts)).collect();
    assert_eq!(pairs, [["base", "screw_0"], ["base", "screw_1"]], "{found:?}");
    assert!(found.iter().all(|s| s.fit.role == Some(Role::Thread) && s.why.ends_with("with play")));
    let assembly = applied(drawn.clone(), &found).unwrap();
    let bodies = Bodies::new(&assembly, fit).unwrap();
    let plan = crate::common::planned(&bodies, PlanOptions::default());
    assert_eq!(told(&assembly, &plan, "base"), ["2 x screw", "cap", "shaft"]);
    assert!(plan.steps[..2].iter().all(|step| step.turn().is_some()), "{plan:?}");
    unscrewed(&assembly, &plan, 1.8..2.3);
}

#[test]
#[ignore = "long: threads of many facets"]
fn legs_that_run_into_their_threads_are_turned_to_where_they_fit_and_unscrewed() {
    let drawn = assembled(screwed_table());
    let fit = Fit::default_for(&drawn);
    let found = crate::common::suggested(&Bodies::new(&drawn, fit).unwrap());
    assert_eq!(found.len(), 4, "{found:?}");
    let assembly = applied(drawn.clone(), &found).unwrap();
    let bodies = Bodies::new(&assembly, fit).unwrap();
    let plan = crate::common::planned(&bodies, PlanOptions::default());
    assert_eq!(told(&assembly, &plan, "top"), ["4 x leg"]);
    for step in &plan.steps {
        let (by, aside) = TABLE_LEGS[step.parts[0] - 1];
        let turn = step.turn().unwrap();
        let known = glam::DVec2::from(aside).length();
        assert!(
            turn.proof.as_ref().is_ok_and(|proof| proof.tolerance == fit.tolerance()),
            "{turn:?}"
        );
        // The leg goes down: it is turned back, as seen from there.
        assert!((turn.phase - by).abs() < 0.1, "{by} {turn:?}");
        assert!((turn.aside.length() - known).abs() < 0.02, "{aside:?} {turn:?}");
    }
    unscrewed(&assembly, &plan, 1.95..2.1);
}
