//! Tests which parts fall or tip over after a step, against a computation with rectangles and sampled
//! directions.

use std::f64::consts::TAU;

use colltrans::solid::StartOverlap;
use colltrans_assembly::matrix::ContactMatrix;
use colltrans_assembly::plan::{Plan, PlanOptions, disassemble};
use colltrans_assembly::{Assembly, Bodies, Fit, Watch};
use colltrans_testkit::random::Random;
use glam::{DAffine3, DVec2, DVec3};

use crate::common::{cuboid, turned};

/// Low and high corners of a box.
type Box = [DVec3; 2];

/// Returns a floor and boxes on it, in layers that cross each other.
fn stack(random: &mut Random) -> Vec<Box> {
    let mut boxes = vec![[DVec3::new(-2.0, -2.0, -1.0), DVec3::new(14.0, 14.0, 0.0)]];
    for layer in 0..3 {
        let (shift, cells) = (if layer % 2 == 0 { 0.0 } else { 2.0 }, 3 - layer % 2);
        for cell in 0..cells * cells {
            if random.unit() < 0.25 {
                continue;
            }
            let mut side = |at: usize| {
                let low = 4.0 * at as f64 + shift + 0.25 * random.index(5) as f64;
                (low, low + 1.0 + 0.25 * random.index(8) as f64)
            };
            let ((a, x), (b, y)) = (side(cell % cells), side(cell / cells));
            let z = layer as f64;
            boxes.push([DVec3::new(a, b, z), DVec3::new(x, y, z + 1.0)]);
        }
    }
    boxes
}

/// Returns the corners of the rectangle in which a box rests on another one; `None` if it does not.
fn contact_rectangle(above: Box, below: Box) -> Option<[DVec2; 4]> {
    let low = above[0].truncate().max(below[0].truncate());
    let high = above[1].truncate().min(below[1].truncate());
    let lies = above[0].z == below[1].z && low.x < high.x && low.y < high.y;
    lies.then(|| [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)])
}

/// Returns the distance of a box's centre from the boundary of its support, negative outside; `None` if no
/// remaining box supports it.
fn support_margin(boxes: &[Box], part: usize, left: &[usize]) -> Option<f64> {
    let under = left.iter().filter(|&&k| k != part);
    let corners: Vec<DVec2> =
        under.filter_map(|&k| contact_rectangle(boxes[part], boxes[k])).flatten().collect();
    let middle = ((boxes[part][0] + boxes[part][1]) * 0.5).truncate();
    let extents = (0..7_200).map(|k| {
        let side = DVec2::from_angle(TAU * f64::from(k) / 7_200.0);
        corners.iter().map(|p| (*p - middle).dot(side)).fold(f64::NEG_INFINITY, f64::max)
    });
    (!corners.is_empty()).then(|| extents.fold(f64::INFINITY, f64::min))
}

/// Computes the plan along the axes of the stack.
fn planned(assembly: &Assembly, up: DVec3) -> Plan {
    let bodies = Bodies::new(assembly, Fit::Tolerance(1e-6)).unwrap();
    let (u, v) = up.any_orthonormal_pair();
    let directions = [up, -up, u, -u, v, -v];
    let (all, watch) = (vec![true; bodies.len()], Watch::default());
    let matrix =
        ContactMatrix::new(&bodies, &directions, &all, StartOverlap::Refuse, watch).unwrap();
    let options =
        PlanOptions::default().with_samples(0).with_proofs(false).with_effort(0).with_up(up);
    disassemble(&bodies, &matrix, &[], options, watch).unwrap()
}

/// Builds the assembly of the boxes in a pose; the floor is fixed.
fn assembled(boxes: &[Box], place: DAffine3) -> Assembly {
    let part = |(k, [low, high]): (usize, &Box)| {
        let piece = cuboid(low.to_array(), high.to_array());
        turned(&k.to_string(), &[piece], place).with_fixed(k == 0)
    };
    Assembly::new(boxes.iter().enumerate().map(part).collect()).unwrap()
}

#[test]
fn falling_and_tipping_parts_match_rectangles() {
    let mut random = Random::new(9);
    let (mut falls, mut tips, mut steps, mut near) = (0, 0, 0, 0);
    for round in 0..150 {
        let boxes = stack(&mut random);
        let place = match round % 3 {
            0 => DAffine3::IDENTITY,
            _ => DAffine3::from_quat(random.rotation()),
        };
        let up = place.transform_vector3(DVec3::Z);
        let mut assembly = assembled(&boxes, place);
        let all = 1..boxes.len();
        let pairs = all.clone().flat_map(|a| all.clone().map(move |b| [a, b]));
        let carrying: Vec<[usize; 2]> =
            pairs.filter(|&[a, b]| contact_rectangle(boxes[b], boxes[a]).is_some()).collect();
        for _ in 0..(round % 6).min(carrying.len()) {
            let pair = carrying[random.index(carrying.len())].map(|k| k.to_string());
            if let Ok(next) = assembly.clone().with_before(&pair[..1], &pair[1..]) {
                assembly = next;
            }
        }
        let plan = planned(&assembly, up);
        let mut left: Vec<usize> = (0..boxes.len()).collect();
        for step in plan.steps.iter().filter(|step| step.group_step.is_none()) {
            let before = left.clone();
            left.retain(|part| !step.parts.contains(part));
            let carried = |part: &&usize| {
                let on = |k: &usize| contact_rectangle(boxes[**part], boxes[*k]).is_some();
                step.parts.iter().any(on)
            };
            let (mut fall, mut tip) = (Vec::new(), Vec::new());
            for &part in left.iter().filter(carried) {
                let was = support_margin(&boxes, part, &before).expect("the box is supported");
                match support_margin(&boxes, part, &left) {
                    None => fall.push(part),
                    Some(now) if was.abs() < 1e-4 || now.abs() < 1e-4 => {
                        near += usize::from(step.off_balance.contains(&part));
                    }
                    Some(now) if now < 0.0 && was > 0.0 => tip.push(part),
                    Some(_) => (),
                }
            }
            let reported: Vec<usize> = step.off_balance.clone();
            let sure = |part: &usize| {
                [&before, &left]
                    .into_iter()
                    .all(|left| support_margin(&boxes, *part, left).is_none_or(|m| m.abs() >= 1e-4))
            };
            let reported: Vec<usize> = reported.into_iter().filter(sure).collect();
            assert_eq!(
                (&step.falling, &reported),
                (&fall, &tip),
                "round {round}, {:?}",
                step.parts
            );
            if assembly.constraints().order_pairs().is_empty() {
                assert!(fall.is_empty() && tip.is_empty(), "all boxes can be removed upwards");
            }
            falls += fall.len();
            tips += tip.len();
            steps += 1;
        }
    }
    assert!(falls > 100 && tips > 5 && steps > 2_000, "{falls} {tips} {steps} {near}");
}
