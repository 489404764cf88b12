//! Plans with fasteners: what screws and dowels hold, turns of plain threads, and roles that contradict them. The
//! reference solutions are constructed by hand.

use std::f64::consts::TAU;

use colltrans_assembly::fasteners::Fasteners;
use colltrans_assembly::plan::{HandlingTimes, Plan, PlanOptions};
use colltrans_assembly::roles::{PairFit, Role};
use colltrans_assembly::{
    AnalysisRequest, Assembly, AssemblyError, Bodies, Fit, Part, Piece, Watch, record,
};
use colltrans_mesh::Mesh;
use colltrans_testkit::machines::flange;
use glam::{DAffine3, DVec2};

use crate::common::part;

const SIDES: usize = 24;

/// Returns a body of revolution about a vertical axis: rings of radius and height, closed by fans or to a loop.
fn revolved(rings: &[[f64; 2]], at: DVec2, is_loop: bool) -> Piece {
    let mut vertices = Vec::new();
    for [r, z] in rings {
        let corner =
            |k: usize| (at + DVec2::from_angle(TAU * k as f64 / SIDES as f64) * *r).extend(*z);
        vertices.extend((0..SIDES).map(corner));
    }
    let n = SIDES as u32;
    let count = rings.len() as u32;
    let mut faces: Vec<Vec<u32>> = Vec::new();
    for k in 0..if is_loop { count } else { count - 1 } {
        let next = (k + 1) % count;
        for j in 0..n {
            let [a, b] = [j, (j + 1) % n];
            faces.push(vec![k * n + a, k * n + b, next * n + b, next * n + a]);
        }
    }
    if !is_loop {
        faces.push((0..n).rev().collect());
        faces.push(((count - 1) * n..count * n).collect());
    }
    Piece { mesh: Mesh::new(vertices, faces), world_from_piece: DAffine3::IDENTITY }
}

/// Returns a disc with a hole between two heights.
fn disc(hole: f64, rim: f64, [low, high]: [f64; 2]) -> Piece {
    revolved(&[[hole, high], [hole, low], [rim, low], [rim, high]], DVec2::ZERO, true)
}

/// Returns a block of revolution with a blind hole from its top.
fn base(hole: f64, depth: f64) -> Piece {
    let rings = [[40.0, -40.0], [40.0, 0.0], [hole, 0.0], [hole, -depth]];
    revolved(&rings, DVec2::ZERO, false)
}

/// Returns an M8 screw with a cylinder head on top of `seat`, and a tip at `tip`.
fn screw(tip: f64, seat: f64) -> Piece {
    let rings = [[3.6, tip], [4.0, tip + 0.4], [4.0, seat], [6.5, seat], [6.5, seat + 8.0]];
    revolved(&rings, DVec2::ZERO, false)
}

fn planned(assembly: &Assembly) -> Plan {
    let bodies = Bodies::new(assembly, Fit::Tolerance(1e-6)).unwrap();
    crate::common::planned(&bodies, PlanOptions::default())
}

fn removed<'a>(assembly: &'a Assembly, plan: &Plan) -> Vec<Vec<&'a str>> {
    plan.steps.iter().map(|step| assembly.part_names(&step.parts)).collect()
}

/// A lid with a clearance hole on a base with a tight hole, and a screw through both.
fn lidded(name: &str) -> Vec<Part> {
    vec![
        part("base", &[base(4.0, 20.0)]),
        part("lid", &[disc(4.5, 30.0, [0.0, 6.0])]),
        part(name, &[screw(-16.0, 6.0)]),
    ]
}

#[test]
fn plain_screw_is_unscrewed_by_the_length_in_its_hole() {
    let assembly = Assembly::new(lidded("screw")).unwrap().with_unit("mm");
    let plan = planned(&assembly);
    assert_eq!(removed(&assembly, &plan), [["screw"], ["lid"]]);
    let turns = plan.steps[0].unscrewing.expect("turns");
    assert!((turns.length - 16.0).abs() < 1e-9 && turns.pitch == 1.25, "{turns:?}");
    assert_eq!(turns.words(), "unscrewed by 16, 12.8 turns of 1.25, standard pitch of M8");
    let stage = plan.stages()[0].clone();
    let action = plan.describe_fasteners(&assembly, &stage);
    assert_eq!(action.as_deref(), Some("unscrew M8 x 22 (screw)"));
    assert_eq!(plan.describe_fasteners(&assembly, &plan.stages()[1]), None);
    let hold = &plan.fasteners.holds()[0];
    assert_eq!((hold.fastener, &hold.parts[..], hold.seat), (2, &[0, 1][..], 0));
    assert_eq!(plan.steps[1].predecessors, [0]);
    // The moves and their proofs are those of a plan without a recognised screw.
    let unnamed = Assembly::new(lidded("rod")).unwrap().with_unit("mm");
    let other = planned(&unnamed);
    assert!(other.fasteners.is_empty() && other.steps[0].unscrewing.is_none());
    for (a, b) in plan.steps.iter().zip(&other.steps) {
        assert_eq!((&a.path, a.travel, a.direction), (&b.path, b.travel, b.direction));
    }
    let times = HandlingTimes::default();
    let [with, without] = [&plan, &other].map(|plan| times.step_seconds(plan)[0]);
    assert_eq!(with - without, times.thread);
    let csv = plan.to_csv(&assembly, &times);
    let mut lines = csv.lines();
    let heads = "fastener,size,unscrew_length,unscrew_turns,unscrew_pitch,tool,tool_blocked_by";
    assert!(lines.next().unwrap().ends_with(heads));
    let row = lines.next().unwrap();
    assert!(row.contains(",screw,M8 x 22,"), "{row}");
    assert!(row.ends_with(",1.25,hex driver 6 x 150 (socket of ISO 4762),"), "{row}");
    assert!(lines.next().unwrap().ends_with(",,,,,,"));
    assert!(!other.to_csv(&unnamed, &times).contains("fastener"));
    let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-6)).unwrap();
    let json = record::plan_json(&bodies, &plan);
    assert_eq!(json["plan"][0]["unscrew"]["standard"], "M8");
    assert!(json["plan"][1].get("unscrew").is_none());
}

/// Returns an anchor, a lid, a screw with a name, and a base with an open hole, so that it could be pulled down off the
/// screw.
fn pulled_off(name: &str) -> Vec<Part> {
    let through = [[40.0, -10.0], [40.0, 0.0], [4.0, 0.0], [4.0, -10.0]];
    vec![
        part("anchor", &[crate::common::cuboid([-200.0, 60.0, -50.0], [200.0, 100.0, 50.0])]),
        part("base", &[revolved(&through, DVec2::ZERO, true)]),
        part("lid", &[disc(4.5, 30.0, [0.0, 6.0])]),
        part(name, &[screw(-12.0, 6.0)]),
    ]
}

/// A loose shank may leave through the base, away from its head, unless it holds the lid: a cap between head and lid
/// blocks the head, so the base would leave first.
#[test]
fn part_is_not_pulled_off_a_screw_that_holds_it() {
    let assembly = Assembly::new(pulled_off("screw")).unwrap();
    let order = removed(&assembly, &planned(&assembly));
    let at = |name: &str| order.iter().position(|step| step.contains(&name)).unwrap();
    assert!(at("screw") < at("base") && at("screw") < at("lid"), "{order:?}");
    // With a role that contradicts the thread, the screw does not hold the parts.
    let press = PairFit { role: Some(Role::Press), tolerance: Some(0.01) };
    let contradicted = assembly.with_pair([&["screw"], &["base"]], press).unwrap();
    let bodies = Bodies::new(&contradicted, Fit::Tolerance(1e-6)).unwrap();
    let found = Fasteners::with_holds(&bodies).unwrap();
    assert_eq!(found.recognised().count(), 1);
    assert!(found.holds().is_empty(), "{:?}", found.holds());
}

#[test]
fn order_of_fasteners_is_ignored_where_it_permits_no_move() {
    // A roof above the head keeps the screw in: the plan removes the base and the lid from it.
    let through = [[40.0, -10.0], [40.0, 0.0], [4.0, 0.0], [4.0, -10.0]];
    let parts = vec![
        part("roof", &[crate::common::cuboid([-90.0, -90.0, 14.5], [90.0, 90.0, 60.0])]),
        part("base", &[revolved(&through, DVec2::ZERO, true)]),
        part("lid", &[disc(4.5, 30.0, [0.0, 6.0])]),
        part("screw", &[screw(-12.0, 6.0)]),
    ];
    let assembly = Assembly::new(parts).unwrap();
    let assembly = assembly.with_fixed(&["roof", "screw"]).unwrap();
    let plan = planned(&assembly);
    assert!(plan.fasteners.holds()[0].parts == [1, 2]);
    assert_eq!(removed(&assembly, &plan), [["base"], ["lid"]]);
}

#[test]
fn located_part_leaves_before_its_dowel() {
    let rings = [[2.7, -12.0], [3.0, -11.5], [3.0, 7.5], [2.7, 8.0]];
    let parts = vec![
        part("base", &[base(3.0, 12.0)]),
        part("lid", &[disc(3.0, 30.0, [0.0, 10.0])]),
        part("dowel", &[revolved(&rings, DVec2::ZERO, false)]),
    ];
    let assembly = Assembly::new(parts).unwrap();
    let plan = planned(&assembly);
    assert_eq!(plan.fasteners.get(2).map(|f| &f.designation[..]), Some("6 x 20"));
    assert_eq!(removed(&assembly, &plan), [["lid"], ["dowel"]]);
    let hold = &plan.fasteners.holds()[0];
    assert_eq!((hold.seat, &hold.parts[..]), (0, &[0, 1][..]));
}

#[test]
fn bolts_of_a_flange_are_unscrewed_from_their_nuts() {
    let piece = |mesh: colltrans_testkit::shapes::Mesh| Piece {
        mesh: Mesh::new(mesh.vertices, mesh.faces),
        world_from_piece: DAffine3::IDENTITY,
    };
    let parts = flange(4, 16)
        .into_iter()
        .map(|(name, bodies)| part(&name, &bodies.into_iter().map(piece).collect::<Vec<_>>()));
    let assembly = Assembly::new(parts.collect()).unwrap();
    let plan = planned(&assembly);
    let stages = plan.stages();
    let actions: Vec<Option<String>> =
        stages.iter().map(|stage| plan.describe_fasteners(&assembly, stage)).collect();
    assert_eq!(actions[0].as_deref(), Some("unscrew 4 x M6 x 35 (bolt)"));
    assert_eq!(actions[1].as_deref(), Some("4 x washer M6 (washer)"));
    assert_eq!(actions[4].as_deref(), Some("4 x nut M6 (nut)"));
    for step in &plan.steps[..4] {
        // The nut ends 8 above the tip of the bolt.
        let turns = step.unscrewing.expect("turns");
        assert!((turns.length - 8.0).abs() < 1e-9 && turns.standard == Some(6.0), "{turns:?}");
    }
    for hold in plan.fasteners.holds() {
        assert!(assembly.parts()[hold.seat].name().starts_with("nut"), "{hold:?}");
        assert_eq!(hold.parts.len(), 5, "{hold:?}");
    }
}

#[test]
fn different_roles_of_a_pair_are_refused() {
    let assembly = Assembly::new(lidded("screw")).unwrap();
    let role = |role| PairFit { role: Some(role), tolerance: Some(0.01) };
    let first = assembly.with_pair([&["screw"], &["base"]], role(Role::Thread)).unwrap();
    let refused = first.clone().with_pair([&["base"], &["screw"]], role(Role::Press)).unwrap_err();
    assert!(
        matches!(&refused, AssemblyError::ContradictingRoles { roles, .. } if *roles == ["thread", "press"]),
        "{refused}"
    );
    let tolerance = PairFit { role: None, tolerance: Some(0.02) };
    first.clone().with_pair([&["base"], &["screw"]], role(Role::Thread)).unwrap();
    first.with_pair([&["base"], &["screw"]], tolerance).unwrap();
}

#[test]
fn order_with_fasteners_is_deterministic_on_any_number_of_threads() {
    let assembly = Assembly::new(lidded("screw")).unwrap();
    let plans: Vec<Plan> = [1, 3]
        .map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| planned(&assembly))
        })
        .to_vec();
    assert_eq!(plans[0], plans[1]);
}

#[test]
fn screws_of_selected_parts_are_removed_first() {
    let parts = |name: &str| {
        let post = crate::common::cuboid([60.0, -5.0, -50.0], [70.0, 5.0, 50.0]);
        [pulled_off(name), vec![part("post", &[post])]].concat()
    };
    for (name, order) in [("screw", vec![vec!["screw"], vec!["base"]]), ("rod", vec![vec!["base"]])]
    {
        let assembly = Assembly::new(parts(name)).unwrap();
        let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-6)).unwrap();
        let question = AnalysisRequest::default().with_selected(vec![1]);
        let plan = question.analyse(&bodies, Watch::default()).unwrap().plan;
        assert_eq!(removed(&assembly, &plan), order);
        let wanted = plan.selection.as_ref().unwrap();
        let screws = &[3][..order.len() - 1];
        assert_eq!((&wanted.fasteners[..], &wanted.others[..]), (screws, screws));
        assert_eq!((&wanted.base[..], wanted.is_complete), (&[0][..], true));
    }
    // A screw that cannot be removed does not keep the part.
    let held = Assembly::new(parts("screw")).unwrap().with_fixed(&["screw", "anchor"]).unwrap();
    let bodies = Bodies::new(&held, Fit::Tolerance(1e-6)).unwrap();
    let question = AnalysisRequest::default().with_selected(vec![1]);
    let plan = question.analyse(&bodies, Watch::default()).unwrap().plan;
    assert_eq!(removed(&held, &plan), [["base"]]);
    assert!(plan.selection.unwrap().fasteners.is_empty());
}
