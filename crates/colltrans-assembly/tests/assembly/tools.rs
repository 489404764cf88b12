//! Hand tools of fasteners in plans. The reference solutions are constructed by hand.

use colltrans_assembly::fasteners::Fasteners;
use colltrans_assembly::plan::{Plan, PlanOptions};
use colltrans_assembly::tools::Tools;
use colltrans_assembly::{AnalysisRequest, Assembly, Bodies, Fit, Part, Watch, record};
use colltrans_mesh::Mesh;
use colltrans_testkit::machines::flange;
use glam::{DAffine3, DVec3};

use crate::common::part;
use colltrans_assembly::Piece;

fn planned(assembly: &Assembly) -> Plan {
    let bodies = Bodies::new(assembly, Fit::Tolerance(1e-6)).unwrap();
    crate::common::planned(&bodies, PlanOptions::default())
}

/// Returns the plate of a flange with one bolt, and a roof above its head. The hole in the roof is wide enough for the
/// head, and has the given radius. The roof begins `gap` above the upper plate.
fn roofed(radius: f64, gap: f64) -> Vec<Part> {
    let mut parts: Vec<Part> = flange(4, 24)
        .into_iter()
        .filter(|(name, _)| !name.contains('_') || name.ends_with("_0"))
        .map(|(name, meshes)| {
            let pieces: Vec<Piece> = meshes
                .into_iter()
                .map(|mesh| Piece {
                    mesh: Mesh::new(mesh.vertices, mesh.faces),
                    world_from_piece: DAffine3::IDENTITY,
                })
                .collect();
            part(&name, &pieces)
        })
        .collect();
    // Four bars around the axis of the bolt, and posts that stand on the plate.
    let (x, low) = (40.0, 14.0 + gap);
    let bars = [
        [[x - 30.0, radius, low], [x + 30.0, radius + 20.0, low + 4.0]],
        [[x - 30.0, -radius - 20.0, low], [x + 30.0, -radius, low + 4.0]],
        [[x - 30.0, -radius, low], [x - radius, radius, low + 4.0]],
        [[x + radius, -radius, low], [x + 30.0, radius, low + 4.0]],
    ];
    let roof: Vec<Piece> =
        bars.into_iter().map(|[low, high]| crate::common::cuboid(low, high)).collect();
    parts.push(part("roof", &roof));
    parts
}

#[test]
fn parts_in_the_way_of_a_tool_leave_first() {
    // The head passes through the hole, and a socket does not. A spanner is too high for the gap.
    let assembly = Assembly::new(roofed(6.5, 8.0)).unwrap().with_unit("mm");
    let plan = planned(&assembly);
    let order: Vec<&str> =
        plan.steps.iter().flat_map(|step| assembly.part_names(&step.parts)).collect();
    let at = |name: &str| order.iter().position(|known| *known == name).unwrap();
    assert!(at("roof") < at("bolt_0"), "{order:?}");
    let step = &plan.steps[at("bolt_0")];
    let reach = step.tool.as_ref().expect("a tool");
    assert!(reach.blockers.is_empty() && reach.tool.starts_with("socket 9.5"), "{reach:?}");
    assert!(step.predecessors.contains(&at("roof")), "{step:?}");
    let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-6)).unwrap();
    let json = record::plan_json(&bodies, &plan);
    assert_eq!(json["plan"][at("bolt_0")]["tool"]["reaches"], true);
    // With a wide hole the order is free, and the tool reaches at once.
    let wide = Assembly::new(roofed(16.0, 8.0)).unwrap().with_unit("mm");
    let fasteners =
        Fasteners::with_holds(&Bodies::new(&wide, Fit::Tolerance(1e-6)).unwrap()).unwrap();
    let bolt = wide.parts().iter().position(|part| part.name() == "bolt_0").unwrap();
    let tools = Tools::find(&wide, &fasteners);
    let found = tools.reach(bolt, DVec3::Z, |_| true).unwrap();
    assert!(found.blockers.is_empty(), "{found:?}");
    // No tool from the other side, or along another direction.
    assert_eq!(tools.reach(bolt, DVec3::X, |_| true), None);
    // A roof that is fixed stays, and the screw leaves without a tool.
    let fixed = Assembly::new(roofed(6.5, 8.0)).unwrap().with_unit("mm");
    let fixed = fixed.with_fixed(&["roof"]).unwrap();
    let plan = planned(&fixed);
    let step = plan.steps.iter().find(|step| fixed.part_names(&step.parts) == ["bolt_0"]).unwrap();
    let reach = step.tool.as_ref().unwrap();
    assert_eq!(fixed.part_names(&reach.blockers), ["roof"]);
    let words = reach.describe(&fixed);
    assert!(words.starts_with("no tool reaches: roof is in the way of "), "{words}");
}

#[test]
fn selected_removal_makes_room_for_tools() {
    let assembly = Assembly::new(roofed(6.5, 8.0)).unwrap().with_unit("mm");
    let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-6)).unwrap();
    let upper = assembly.parts().iter().position(|part| part.name() == "upper").unwrap();
    let request = AnalysisRequest::default().with_selected(vec![upper]);
    let plan = request.analyse(&bodies, Watch::default()).unwrap().plan;
    let chosen = plan.selection.as_ref().unwrap();
    assert!(chosen.is_complete);
    assert_eq!(assembly.part_names(&chosen.fasteners), ["bolt_0"]);
    assert_eq!(assembly.part_names(&chosen.obstacles), ["roof"]);
    let words = chosen.describe(&assembly);
    assert!(words.contains("roof first, to make room for the tools"), "{words}");
}
