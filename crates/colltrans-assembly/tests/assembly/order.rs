//! Order of plans, compared with queries of all pairs in each state: free directions, travels, supports, and
//! exchangeable steps.

use colltrans::solid::{StartOverlap, Workspace};
use colltrans_assembly::candidates::{CandidateOptions, find_candidates};
use colltrans_assembly::liaisons::find_liaisons;
use colltrans_assembly::matrix::ContactMatrix;
use colltrans_assembly::plan::{Plan, PlanOptions, Step, disassemble};
use colltrans_assembly::sphere::Sphere;
use colltrans_assembly::{Assembly, Bodies, Fit, FreeTravel, Part, Piece, Watch};
use colltrans_testkit::random::Random;
use glam::{DAffine3, DVec3};

use crate::common::cuboid;

fn planned(bodies: &Bodies, options: PlanOptions) -> (Plan, Vec<DVec3>) {
    let watch = Watch::default();
    let touching = find_liaisons(bodies, watch).unwrap();
    let given = options.up.map_or(Vec::new(), |up| vec![up, -up]);
    let choice = CandidateOptions::default().with_given(given);
    let directions = find_candidates(bodies, &touching, &choice).unwrap().directions();
    let all = vec![true; bodies.len()];
    let matrix = ContactMatrix::new(bodies, &directions, &all, options.start, watch).unwrap();
    (disassemble(bodies, &matrix, &[], options, watch).unwrap(), directions)
}

fn is_free(bodies: &Bodies, group: &[usize], others: &[usize], d: DVec3) -> bool {
    let mut workspace = Workspace::default();
    let mut pairs = group.iter().flat_map(|&a| others.iter().map(move |&b| [a, b]));
    let start = StartOverlap::Refuse;
    pairs.all(|pair| bodies.free_travel(pair, d, None, start, &mut workspace) == FreeTravel::Free)
}

fn travel(bodies: &Bodies, group: &[usize], others: &[usize], d: DVec3) -> f64 {
    let pairs = group.iter().flat_map(|&a| others.iter().map(move |&b| [a, b]));
    pairs.map(|[a, b]| bodies.travel_beyond(a, b, d).value).fold(0.0, f64::max)
}

/// Checks whether a part can move down by more than 1e-3.
fn falls(bodies: &Bodies, part: usize, others: &[usize], up: DVec3) -> bool {
    let mut workspace = Workspace::default();
    let mut rooms = others
        .iter()
        .map(|&b| bodies.free_travel([part, b], -up, None, StartOverlap::Refuse, &mut workspace));
    rooms.all(|room| {
        matches!(room, FreeTravel::Free)
            || matches!(room, FreeTravel::Blocked(s) if s.distance() > 1e-3)
    })
}

/// Returns the steps of the whole assembly, without those of removed groups.
fn main_steps(plan: &Plan) -> Vec<(usize, &Step)> {
    plan.steps.iter().enumerate().filter(|(_, step)| step.group_step.is_none()).collect()
}

/// Checks each main step: it leaves some part, is free, and is about as short as the shortest direction. Returns the
/// number of steps after which no other part falls.
fn check_steps(bodies: &Bodies, plan: &Plan, directions: &[DVec3], up: DVec3) -> usize {
    let mut left: Vec<usize> = (0..bodies.len()).collect();
    let mut kept_up = 0;
    for (k, step) in main_steps(plan) {
        let single = left.len() - 1;
        assert!(step.parts.len() <= single, "step {k} must leave some part");
        let held: Vec<usize> = left
            .iter()
            .copied()
            .filter(|&p| {
                let others: Vec<usize> = left.iter().copied().filter(|&q| q != p).collect();
                !falls(bodies, p, &others, up)
            })
            .collect();
        left.retain(|p| !step.parts.contains(p));
        assert!(is_free(bodies, &step.parts, &left, step.direction), "step {k}");
        let own = travel(bodies, &step.parts, &left, step.direction);
        assert!((own - step.travel.value).abs() < 1e-9);
        let free = directions.iter().filter(|d| is_free(bodies, &step.parts, &left, **d));
        let least = free.map(|d| travel(bodies, &step.parts, &left, *d)).fold(own, f64::min);
        assert!(own <= 1.1 * least + 1e-3, "step {k}: travel {own} exceeds the shortest {least}");
        let ground = |p: &usize| bodies.assembly().parts()[*p].solid().bounds().low.dot(up) < 1e-3;
        let mut kept =
            left.iter().filter(|p| held.contains(p) && !plan.base.contains(p) && !ground(p));
        let dropped = kept.any(|&p| {
            let others: Vec<usize> = left.iter().copied().filter(|&q| q != p).collect();
            falls(bodies, p, &others, up)
        });
        kept_up += usize::from(!dropped);
    }
    kept_up
}

/// Checks that the steps can be performed in random orders that respect `after`.
fn check_exchanges(bodies: &Bodies, plan: &Plan, random: &mut Random) {
    let steps = main_steps(plan);
    for _ in 0..4 {
        let (mut done, mut left) =
            (vec![false; plan.steps.len()], (0..bodies.len()).collect::<Vec<_>>());
        for _ in 0..steps.len() {
            let ready = |(k, step): &&(usize, &Step)| {
                !done[*k] && step.predecessors.iter().all(|&j| done[j])
            };
            let ready: Vec<_> = steps.iter().filter(ready).collect();
            let (k, step) = *ready[random.index(ready.len())];
            left.retain(|p| !step.parts.contains(p));
            assert!(is_free(bodies, &step.parts, &left, step.direction), "step {k} too early");
            done[k] = true;
        }
    }
}

fn boxes(random: &mut Random, count: usize) -> Assembly {
    // A grid of boxes of random sizes that touch or leave a gap, in layers.
    let mut parts = Vec::new();
    for k in 0..count {
        let low = [k % 3, k / 3 % 3, k / 9].map(|x| 2.0 * x as f64);
        let high = low.map(|x| x + [1.0, 1.5, 2.0][random.index(3)]);
        parts.push(Part::new(format!("box {k}"), &[cuboid(low, high)]).unwrap());
    }
    Assembly::new(parts).unwrap()
}

#[test]
fn steps_are_short_and_commute_up_to_precedence() {
    let mut random = Random::new(77);
    let (mut steps, mut kept_up) = (0, 0);
    for round in 0..40 {
        let count = 4 + random.index(20);
        let assembly = boxes(&mut random, count);
        let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-9)).unwrap();
        let (plan, directions) = planned(&bodies, PlanOptions::default().with_samples(0));
        assert!(plan.remaining.is_empty() && plan.base.len() == 1, "round {round}");
        kept_up += check_steps(&bodies, &plan, &directions, DVec3::Z);
        steps += main_steps(&plan).len();
        check_exchanges(&bodies, &plan, &mut random);
    }
    // Some box of a grid can always be removed from above.
    assert_eq!(kept_up, steps, "no part may fall");
}

/// Returns a lower plate, an upper plate, and screws of two kinds through both, each with a washer under its head.
fn joint(place: DAffine3) -> Assembly {
    let mut parts = Vec::new();
    let mut add = |name: String, pieces: &[Piece]| {
        let turned = |piece: &Piece| Piece {
            mesh: piece.mesh.clone(),
            world_from_piece: place * piece.world_from_piece,
        };
        let pieces: Vec<Piece> = pieces.iter().map(turned).collect();
        parts.push(Part::new(name, &pieces).unwrap());
    };
    let plate = |z: f64| -> Vec<Piece> {
        // A grid of 9 x 3 blocks without those of the holes.
        let all = (0..27).map(|k| (k % 9, k / 9)).filter(|(x, y)| *y != 1 || x % 2 == 0);
        let block = |(x, y): (i32, i32)| {
            let [x, y] = [x, y].map(f64::from);
            cuboid([x, y, z], [x + 1.0, y + 1.0, z + 1.0])
        };
        all.map(block).collect()
    };
    add("lower".into(), &plate(0.0));
    add("upper".into(), &plate(1.0));
    for k in 0..4 {
        let x = 1.0 + 2.0 * f64::from(k);
        let long = f64::from(k / 2) * 0.25;
        let shaft = cuboid([x, 1.0, -0.5 - long], [x + 1.0, 2.0, 2.5]);
        let head = cuboid([x - 0.25, 0.75, 2.125], [x + 1.25, 2.25, 2.75]);
        let ring = |low: [f64; 2], high: [f64; 2]| {
            cuboid([low[0], low[1], 2.0], [high[0], high[1], 2.125])
        };
        let washer = [
            ring([x - 0.25, 0.75], [x, 2.25]),
            ring([x + 1.0, 0.75], [x + 1.25, 2.25]),
            ring([x - 0.25, 0.75], [x + 1.25, 1.0]),
            ring([x - 0.25, 2.0], [x + 1.25, 2.25]),
        ];
        add(format!("screw_{k}"), &[shaft, head]);
        add(format!("washer_{k}"), &washer);
    }
    Assembly::new(parts).unwrap()
}

#[test]
fn identical_parts_leave_in_one_stage_and_lower_plate_stays() {
    let mut random = Random::new(8);
    for round in 0..5 {
        let turn =
            if round == 0 { DAffine3::IDENTITY } else { DAffine3::from_quat(random.rotation()) };
        let up = turn.transform_vector3(DVec3::Z);
        let assembly = joint(turn);
        let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-6)).unwrap();
        let (plan, _) = planned(&bodies, PlanOptions::default().with_samples(0).with_up(up));
        let told: Vec<String> =
            plan.stages().iter().map(|stage| plan.describe_stage(&assembly, stage)).collect();
        assert_eq!(told, ["2 x screw", "2 x screw", "4 x washer", "upper"], "round {round}");
        assert_eq!(assembly.part_names(&plan.base), ["lower"]);
        assert!(plan.steps.iter().all(|step| step.direction.dot(up) > 0.999_999));
        let upper = plan.steps.last().unwrap();
        assert_eq!(upper.predecessors.len(), 8, "all screws and washers must precede it");
    }
}

#[test]
fn removal_direction_follows_the_up_option() {
    // Three stacked plates: the lower ones carry the upper ones.
    let part = |name: &str, piece: Piece| Part::new(name, &[piece]).unwrap();
    let assembly = Assembly::new(vec![
        part("a", cuboid([0.0; 3], [2.0, 2.0, 1.0])),
        part("b", cuboid([0.0, 0.0, 1.0], [2.0, 2.0, 2.0])),
        part("c", cuboid([0.0, 0.0, 2.0], [2.0, 2.0, 3.0])),
    ])
    .unwrap();
    let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-9)).unwrap();
    for (up, order) in [(DVec3::Z, ["c", "b"]), (DVec3::NEG_Z, ["a", "b"])] {
        let (plan, _) = planned(&bodies, PlanOptions::default().with_up(up));
        let names: Vec<&str> =
            plan.steps.iter().flat_map(|s| assembly.part_names(&s.parts)).collect();
        assert_eq!(names, order);
        assert!(plan.steps.iter().all(|step| step.direction == up));
    }
    let none = PlanOptions::default().with_up(DVec3::ZERO);
    let watch = Watch::default();
    let matrix = ContactMatrix::on_demand(&bodies, &[], &[true; 3], StartOverlap::Refuse);
    assert!(disassemble(&bodies, &matrix, &[], none, watch).is_err());
}

/// Returns a deep shaft around `x = at`, open at the top, and a block at its bottom. The front wall is open from
/// `gap` on.
fn shaft(at: f64, gap: f64) -> (Vec<Piece>, Piece) {
    let wall = |low: [f64; 2], high: [f64; 2]| {
        cuboid([low[0] + at, low[1], 0.0], [high[0] + at, high[1], 12.0])
    };
    let mut walls = vec![cuboid([at - 2.0, -3.0, -1.0], [at + 2.0, 3.5, 0.0])];
    walls.push(wall([-2.0, -3.0], [-1.5, 3.5]));
    walls.push(wall([1.5, -3.0], [2.0, 3.5]));
    walls.push(wall([-1.5, -3.0], [1.5, -2.5]));
    walls.push(wall([-1.5, 3.0], [gap, 3.5]));
    (walls, cuboid([at - 0.25, -0.25, 0.0], [at + 0.25, 0.25, 0.5]))
}

#[test]
fn shortcut_is_used_only_by_the_part_that_has_one() {
    let [(mut walls, a), (others, b)] = [shaft(0.0, 0.5), shaft(4.0, 1.5)];
    walls.extend(others);
    let part = |name: &str, pieces: &[Piece]| Part::new(name, pieces).unwrap();
    let parts = vec![part("walls", &walls), part("block_a", &[a]), part("block_b", &[b])];
    let assembly = Assembly::new(parts).unwrap();
    let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-9)).unwrap();
    let (plan, directions) = planned(&bodies, PlanOptions::default().with_samples(0));
    let ways: Vec<DVec3> = plan.steps.iter().map(|step| step.direction).collect();
    assert_eq!(ways, [DVec3::Z; 2], "only contact normals are tested");
    for k in [1, 2] {
        let free = directions.iter().filter(|d| is_free(&bodies, &[k], &[0], **d));
        assert_eq!(free.count(), 1);
    }

    let (plan, _) = planned(&bodies, PlanOptions::default());
    let samples = Sphere::with_directions(PlanOptions::default().samples).directions;
    let mut shorter = Vec::new();
    for step in &plan.steps {
        assert!(is_free(&bodies, &step.parts, &[0], step.direction));
        let ways = samples.iter().filter(|d| is_free(&bodies, &step.parts, &[0], **d));
        let ways = ways.map(|d| travel(&bodies, &step.parts, &[0], *d));
        let least = ways.fold(f64::INFINITY, f64::min);
        let own = step.travel.value;
        assert!(own <= 1.5 * least, "travel {own} exceeds the shortest {least}");
        if own < 11.0 {
            shorter.push(assembly.part_names(&step.parts).concat());
        }
    }
    assert_eq!(shorter, ["block_a"]);
    // If the oblique direction is forbidden, the block moves up.
    let never = assembly.clone().with_never(&["block_a"], shorter_way(&plan), 60.0).unwrap();
    let bodies = Bodies::new(&never, Fit::Tolerance(1e-9)).unwrap();
    let (plan, _) = planned(&bodies, PlanOptions::default());
    assert!(plan.steps.iter().all(|step| step.direction == DVec3::Z));
}

fn shorter_way(plan: &Plan) -> DVec3 {
    plan.steps.iter().map(|step| step.direction).find(|d| *d != DVec3::Z).unwrap()
}
