//! Answers compared with slow and simple references: boxes whose free travel is an interval, steps walked in small
//! increments, and small machines with known solutions.

use crate::common::*;
use colltrans::solid::{StartOverlap, Workspace};
use colltrans_assembly::plan::{Plan, PlanOptions};
use colltrans_assembly::sphere::Sphere;
use colltrans_assembly::travel::{PartTravel, travel_of_group, travels_of_parts};
use colltrans_assembly::{Assembly, Bodies, Fit, Watch};
use colltrans_testkit::random::Random;
use colltrans_testkit::solids::ROOM_WITH_WINDOW;
use glam::{DAffine3, DVec3};

/// Plans the disassembly with a tolerance and walks all steps. Returns the assembly and the plan.
fn taken_apart(parts: Vec<colltrans_assembly::Part>, tolerance: f64) -> (Assembly, Plan) {
    let assembly = Assembly::new(parts).unwrap();
    let bodies = Bodies::new(&assembly, Fit::Tolerance(tolerance)).unwrap();
    let plan = planned(&bodies, PlanOptions::default());
    walk(&bodies, &plan);
    (assembly.clone(), plan)
}

/// Returns the names of the parts of each step, and last those of the parts that all others leave.
fn names<'a>(assembly: &'a Assembly, plan: &Plan) -> Vec<Vec<&'a str>> {
    let last = Some(&plan.base).filter(|parts| !parts.is_empty());
    let steps = plan.steps.iter().map(|s| &s.parts).chain(last);
    steps.map(|parts| assembly.part_names(parts)).collect()
}

/// Walks every step in small increments and checks that no parts overlap. At the end each part has left once or
/// remains.
fn walk(bodies: &Bodies, plan: &Plan) {
    let mut gone = vec![false; bodies.len()];
    for (k, step) in plan.steps.iter().enumerate() {
        let group: Vec<usize> = match step.group_step {
            None => (0..bodies.len()).filter(|&p| !gone[p]).collect(),
            // The remaining parts of the group that was removed before.
            Some(outer) => {
                let earlier = plan.steps[..k].iter().filter(|s| s.group_step == Some(outer));
                let apart: Vec<usize> = earlier.flat_map(|s| s.parts.clone()).collect();
                let all = plan.steps[outer].parts.iter().copied();
                all.filter(|p| !apart.contains(p)).collect()
            }
        };
        assert!(step.parts.iter().all(|p| group.contains(p)));
        let mut at = vec![DVec3::ZERO; bodies.len()];
        // Each leg, and the return legs after the parts have left.
        for (n, leg) in step.path.iter().chain(&step.return_legs).enumerate() {
            let out = n >= step.path.len();
            let others = group.iter().filter(|p| !leg.parts.contains(p));
            let others: Vec<usize> =
                others.copied().filter(|p| !out || !step.parts.contains(p)).collect();
            for share in 1..=100 {
                let by = leg.direction * (leg.travel * f64::from(share) / 100.0);
                for (&a, &b) in leg.parts.iter().flat_map(|a| others.iter().map(move |b| (a, b))) {
                    let by = at[a] + by - at[b];
                    assert!(!bodies.overlaps_displaced(a, by, b), "step {k}, {a} meets {b}");
                }
            }
            leg.parts.iter().for_each(|&p| at[p] += leg.direction * leg.travel);
        }
        if step.group_step.is_none() {
            step.parts.iter().for_each(|&p| gone[p] = true);
        }
    }
    let left: Vec<usize> = (0..bodies.len()).filter(|&p| !gone[p]).collect();
    assert_eq!(left, [&plan.remaining[..], &plan.base].concat());
}

/// Returns the travel of an open box before it meets another: `None` if it never does, negative if they overlap at
/// the start.
fn room_of_boxes(a: [DVec3; 2], b: [DVec3; 2], d: DVec3) -> Option<f64> {
    let (mut enter, mut exit) = (f64::NEG_INFINITY, f64::INFINITY);
    for k in 0..3 {
        let (low, high) = (b[0][k] - a[1][k], b[1][k] - a[0][k]);
        if d[k] == 0.0 {
            if low >= 0.0 || high <= 0.0 {
                return None;
            }
        } else {
            let (x, y) = (low / d[k], high / d[k]);
            enter = enter.max(x.min(y));
            exit = exit.min(x.max(y));
        }
    }
    (enter < exit && exit > 0.0).then_some(enter)
}

#[test]
fn rooms_of_boxes_equal_interval_arithmetic() {
    let mut random = Random::new(77);
    let (mut free, mut blocked, mut overlapping, mut near) = (0, 0, 0, 0);
    for round in 0..40 {
        let snapped = round % 2 == 0;
        let tolerance = if round % 4 < 2 { 0.0 } else { 0.125 };
        let assembly = scattered(&mut random, 12, snapped);
        let bodies = Bodies::new(&assembly, Fit::Tolerance(tolerance)).unwrap();
        let boxes: Vec<[DVec3; 2]> = assembly
            .parts()
            .iter()
            .map(|p| p.solid().bounds().expanded(-tolerance / 2.0))
            .map(|b| [b.low, b.high])
            .collect();
        let mut directions = vec![DVec3::X, DVec3::NEG_Z];
        // Edges pass edges exactly, because no component is rounded.
        directions.push(DVec3::new(0.75, 0.0, -1.0));
        directions.extend((0..4).map(|_| random.direction()));
        let found =
            travels_of_parts(&bodies, &directions, StartOverlap::Refuse, Watch::default()).unwrap();
        for a in 0..12 {
            for (k, &d) in directions.iter().enumerate() {
                let all = (0..12)
                    .filter(|&b| b != a)
                    .filter_map(|b| room_of_boxes(boxes[a], boxes[b], d));
                match (all.reduce(f64::min), found[a][k]) {
                    (None, PartTravel::Free) => free += 1,
                    (Some(t), PartTravel::Overlapping { .. }) if t < 1e-9 => overlapping += 1,
                    (Some(t), PartTravel::Blocked { stop, by, .. }) => {
                        blocked += 1;
                        assert!(
                            t > -1e-9 && (stop.shrunk_translation.value - t).abs() < 1e-9,
                            "{t}, {stop:?}"
                        );
                        let own = room_of_boxes(boxes[a], boxes[by], d).unwrap();
                        assert!((own - t).abs() < 1e-9, "blocker {by} is at {own}, expected {t}");
                        // The position at which the faces, each moved by half of the tolerance, meet; or, if the edge
                        // on one side is already past it at the start, where another point of its face does.
                        let place = t - tolerance / stop.normal.dot(d);
                        let distance = stop.distance();
                        assert!(
                            distance >= place - 1e-9
                                && distance <= stop.shrunk_translation.lower.max(0.0)
                        );
                        near += usize::from(distance - place.max(0.0) < 1e-9);
                        // Beyond the upper bound the nominal boxes overlap.
                        let as_given = [a, by].map(|k| {
                            let bounds = assembly.parts()[k].solid().bounds();
                            [bounds.low, bounds.high]
                        });
                        let given = room_of_boxes(as_given[0], as_given[1], d).unwrap();
                        assert!(given <= stop.translation.upper, "{given}, {stop:?}");
                    }
                    // Rounding: corners pass corners along a direction that is not an axis.
                    (expected, found) => {
                        let turned = d.to_array().iter().all(|c| *c != 0.0);
                        assert!(!turned && !snapped, "{expected:?}, {found:?} along {d}");
                    }
                }
            }
        }
    }
    assert!(free > 300 && blocked > 300 && overlapping > 300, "{free} {blocked} {overlapping}");
    assert!(near > blocked * 9 / 10, "{near} of {blocked}");
}

#[test]
fn steps_of_box_plans_have_no_overlaps() {
    let mut random = Random::new(31);
    let mut steps = 0;
    for round in 0..12 {
        let assembly = scattered(&mut random, 10, round % 2 == 0);
        for tolerance in [0.0, 0.25] {
            let bodies = Bodies::new(&assembly, Fit::Tolerance(tolerance)).unwrap();
            let plan = planned(&bodies, PlanOptions::default());
            walk(&bodies, &plan);
            steps += plan.steps.len();
        }
    }
    assert!(steps > 100, "{steps}");
}

#[test]
fn drawer_is_removed_with_its_contents() {
    // The cabinet is open towards x, the drawer towards z.
    let cabinet = [
        cuboid([-1.0, -3.0, -1.0], [0.0, 3.0, 4.0]),
        cuboid([-1.0, -3.0, -1.0], [8.0, -2.0, 4.0]),
        cuboid([-1.0, 2.0, -1.0], [8.0, 3.0, 4.0]),
        cuboid([-1.0, -3.0, -1.0], [8.0, 3.0, 0.0]),
        cuboid([-1.0, -3.0, 3.0], [8.0, 3.0, 4.0]),
    ];
    let parts = vec![
        part("cabinet", &cabinet).with_fixed(true),
        part("drawer", &well([0.5, -1.5, 0.5], [7.5, 1.5, 3.0], 0.5)),
        part("cup", &[cuboid([1.0, -0.5, 0.5], [2.0, 0.5, 2.5])]),
    ];
    let (assembly, plan) = taken_apart(parts, 1e-9);
    let order = names(&assembly, &plan);
    assert_eq!(order[0], ["drawer", "cup"]);
    assert_eq!(plan.steps[0].direction, DVec3::X);
    assert!((plan.steps[0].travel.value - 8.0).abs() < 1e-6);
    assert_eq!((order[1].as_slice(), plan.steps[1].group_step), (&["cup"][..], Some(0)));
    assert_eq!(plan.remaining, [0]);
}

#[test]
fn bolt_stops_where_its_head_touches() {
    // A square bolt, 1 above its seat, in a blind hole with 2 below its end.
    let bolt =
        [cuboid([-2.0, -2.0, 1.0], [2.0, 2.0, 2.0]), cuboid([-1.0, -1.0, -4.0], [1.0, 1.0, 1.5])];
    let parts =
        vec![part("bolt", &bolt), part("block", &well([-1.0, -1.0, -6.0], [1.0, 1.0, 0.0], 3.0))];
    let assembly = Assembly::new(parts.clone()).unwrap();
    let bodies = Bodies::new(&assembly, Fit::Tolerance(0.02)).unwrap();
    let room = |d| {
        let start = StartOverlap::Refuse;
        travel_of_group(&bodies, &[0], &[true; 2], d, start, &mut Workspace::default())
    };
    assert!(room(DVec3::Z).is_free());
    let PartTravel::Blocked { stop, .. } = room(DVec3::NEG_Z) else {
        panic!("the head must block it")
    };
    assert!(
        (stop.shrunk_translation.value - 1.02).abs() < 1e-9 && (stop.distance() - 1.0).abs() < 1e-9,
        "{stop:?}"
    );
    assert_eq!(stop.normal, DVec3::NEG_Z);
    assert!((stop.point.z + 0.01).abs() < 1e-9);
    assert!((room(DVec3::X).displaced_distance() - 0.02).abs() < 1e-9);
    let (assembly, plan) = taken_apart(parts, 0.02);
    assert_eq!(names(&assembly, &plan), [["bolt"], ["block"]]);
    assert!((plan.steps[0].travel.value - 4.0).abs() < 0.1);
}

#[test]
fn chain_of_three_links_leaves_its_box_as_one_group() {
    let ring = |x: f64| {
        [
            cuboid([x - 2.0, -2.0, -0.5], [x - 1.0, 2.0, 0.5]),
            cuboid([x + 1.0, -2.0, -0.5], [x + 2.0, 2.0, 0.5]),
            cuboid([x - 2.0, -2.0, -0.5], [x + 2.0, -1.0, 0.5]),
            cuboid([x - 2.0, 1.0, -0.5], [x + 2.0, 2.0, 0.5]),
        ]
    };
    let long = [
        cuboid([-0.5, -0.5, -2.5], [0.5, 0.5, 2.5]),
        cuboid([5.5, -0.5, -2.5], [6.5, 0.5, 2.5]),
        cuboid([-0.5, -0.5, -2.5], [6.5, 0.5, -1.5]),
        cuboid([-0.5, -0.5, 1.5], [6.5, 0.5, 2.5]),
    ];
    let parts = vec![
        part("first", &ring(0.0)),
        part("second", &long),
        part("third", &ring(6.0)),
        part("box", &well([-2.5, -2.5, -3.0], [8.5, 2.5, 5.0], 1.0)).with_fixed(true),
    ];
    let (assembly, plan) = taken_apart(parts, 1e-9);
    assert_eq!(names(&assembly, &plan)[0], ["first", "second", "third"]);
    assert_eq!(plan.steps[0].direction, DVec3::Z);
    assert_eq!(plan.interlocked.len(), 1);
    assert_eq!(plan.interlocked[0].parts, [0, 1, 2]);
    // The ends block each other only through the link between them.
    assert_eq!(plan.interlocked[0].blocking_sets[0].sets[0].0, [1]);
}

#[test]
fn closed_dovetail_is_interlocked() {
    // A dovetail across, closed at both ends: it moves neither up nor along.
    let rail = [
        cuboid([-5.0, -2.0, 0.0], [5.0, 2.0, 1.0]),
        cuboid([-5.0, -2.0, 1.0], [5.0, -1.0, 2.0]),
        cuboid([-5.0, 1.0, 1.0], [5.0, 2.0, 2.0]),
        cuboid([-5.0, -2.0, 2.0], [5.0, -0.5, 3.0]),
        cuboid([-5.0, 0.5, 2.0], [5.0, 2.0, 3.0]),
        cuboid([-6.0, -2.0, 0.0], [-5.0, 2.0, 3.0]),
        cuboid([5.0, -2.0, 0.0], [6.0, 2.0, 3.0]),
    ];
    let slide =
        [cuboid([-1.0, -1.0, 1.0], [1.0, 1.0, 2.0]), cuboid([-1.0, -0.5, 1.5], [1.0, 0.5, 4.0])];
    let (_, plan) = taken_apart(vec![part("rail", &rail), part("slide", &slide)], 1e-9);
    assert!(plan.steps.is_empty());
    assert_eq!((plan.remaining.as_slice(), plan.interlocked.len()), (&[0, 1][..], 1));
    // With one end open, it leaves there.
    let (assembly, plan) = taken_apart(vec![part("rail", &rail[..6]), part("slide", &slide)], 1e-9);
    assert_eq!(names(&assembly, &plan), [["slide"], ["rail"]]);
    assert_eq!(plan.steps[0].direction, DVec3::X);
}

#[test]
fn removal_direction_between_samples_is_found() {
    // A room with a window and a cube inside, which can leave along 0.4 % of the sphere.
    let room = ROOM_WITH_WINDOW.map(|[low, high]| cuboid(low, high));
    let cube = [cuboid([-0.2, -0.2, -0.2], [0.2, 0.2, 0.2])];
    let samples = Sphere::with_directions(PlanOptions::default().samples).directions;
    let mut random = Random::new(5);
    let mut missed = 0;
    for _ in 0..8 {
        let turn = DAffine3::from_rotation_translation(random.rotation(), DVec3::ZERO);
        let parts = vec![turned("cube", &cube, turn), turned("room", &room, turn)];
        let assembly = Assembly::new(parts).unwrap();
        let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-6)).unwrap();
        let found =
            travels_of_parts(&bodies, &samples, StartOverlap::Refuse, Watch::default()).unwrap();
        let plan = planned(&bodies, PlanOptions::default());
        walk(&bodies, &plan);
        assert_eq!(names(&assembly, &plan), [["cube"], ["room"]]);
        let out = turn.inverse().transform_vector3(plan.steps[0].direction);
        assert!((0.38..0.47).contains(&(out.z / out.x)), "{out}");
        if found[0].iter().any(PartTravel::is_free) {
            continue;
        }
        missed += 1;
        // Without the cover and the directions that a proof leaves open, no single move is found, but two moves: to
        // the window, and out.
        let options = PlanOptions::default().with_samples(0).with_proofs(false);
        assert!(planned(&bodies, options.with_effort(0)).steps.is_empty());
        let plan = planned(&bodies, options);
        walk(&bodies, &plan);
        assert_eq!(plan.steps[0].path.len(), 2, "{:?}", plan.steps[0].path);
    }
    assert!(missed > 2, "the samples miss it in {missed} of 8 positions");
}
