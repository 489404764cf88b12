//! Plans with order constraints, subassemblies and forbidden directions, and smallest removal sets, compared with
//! trials of all groups along all directions.

use colltrans::solid::{StartOverlap, Workspace};
use colltrans_assembly::matrix::ContactMatrix;
use colltrans_assembly::plan::{
    PathSearch, Plan, PlanOptions, Step, disassemble, precedence_graph, remove,
};
use colltrans_assembly::{Assembly, AssemblyError, Bodies, Fit, FreeTravel, Watch};
use colltrans_testkit::random::Random;
use glam::DVec3;

use crate::common::{cuboid, part, planned, stud, well};

const AXES: [DVec3; 6] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];

fn options() -> PlanOptions {
    PlanOptions::default().with_samples(0).with_effort(0).with_proofs(false)
}

fn matrix<'a>(bodies: &'a Bodies<'a>) -> ContactMatrix<'a> {
    let all = vec![true; bodies.len()];
    ContactMatrix::new(bodies, &AXES, &all, StartOverlap::Refuse, Watch::default()).unwrap()
}

/// The constraints as bit sets, independent of the assembly.
#[derive(Debug, Default)]
struct Demands {
    before: Vec<[usize; 2]>,
    together: Vec<u32>,
    subassemblies: Vec<u32>,
    never: Vec<(usize, usize)>,
    fixed: u32,
}

/// A reference solution from the contacts of all pairs along all directions.
struct Judge {
    count: usize,
    /// For each direction and part, the parts that block it.
    met: Vec<Vec<u32>>,
    demands: Demands,
}

fn bits(parts: &[usize]) -> u32 {
    parts.iter().map(|&part| 1_u32 << part).sum()
}

impl Judge {
    fn new(bodies: &Bodies, demands: Demands) -> Self {
        let mut workspace = Workspace::default();
        let mut meets = |a: usize, b: usize, d: DVec3| {
            let start = StartOverlap::Refuse;
            a != b && bodies.free_travel([a, b], d, None, start, &mut workspace) != FreeTravel::Free
        };
        let count = bodies.len();
        let met = AXES.map(|d| {
            let row =
                (0..count).map(|a| (0..count).filter(|&b| meets(a, b, d)).map(|b| 1 << b).sum());
            row.collect()
        });
        Self { count, met: met.to_vec(), demands }
    }

    /// Checks whether a set can leave the remaining parts along a direction.
    fn leaves(&self, set: u32, left: u32, k: usize) -> bool {
        let (rest, has) = (left & !set, |part: usize| set >> part & 1 == 1);
        let Demands { before, together, subassemblies, never, fixed } = &self.demands;
        let as_one = |unit: &u32| set & unit == 0 || unit & rest == 0;
        set & fixed == 0
            && (0..self.count).all(|part| !has(part) || self.met[k][part] & rest == 0)
            && before.iter().all(|&[a, b]| !has(b) || rest >> a & 1 == 0)
            && together.iter().all(as_one)
            && subassemblies.iter().all(|unit| left & !unit == 0 || as_one(unit))
            && !never.iter().any(|&(part, d)| has(part) && d == k)
    }

    /// Returns the remaining parts after repeated removal of subsets of `movable`; at least one part remains.
    fn left(&self, mut left: u32, movable: u32) -> u32 {
        loop {
            let leaving = (1..1_u32 << self.count).find(|&set| {
                set & !(left & movable) == 0
                    && set != left
                    && (0..AXES.len()).any(|k| self.leaves(set, left, k))
            });
            match leaving {
                Some(set) => left &= !set,
                None => return left,
            }
        }
    }

    /// Returns the size of a smallest set whose removal takes these parts out.
    fn least(&self, wanted: u32) -> Option<u32> {
        let all = (1_u32 << self.count) - 1;
        let enough =
            |set: &u32| set & wanted == wanted && *set != all && self.left(all, *set) & wanted == 0;
        (1..all).filter(enough).map(u32::count_ones).min()
    }

    fn position(d: DVec3) -> usize {
        AXES.iter().position(|axis| *axis == d).unwrap()
    }

    /// Checks that each step can leave, also in random orders that respect `after`. Returns the remaining parts.
    fn check_walk(&self, plan: &Plan, within: Option<usize>, all: u32, random: &mut Random) -> u32 {
        let own = plan.steps.iter().enumerate().filter(|(_, step)| step.group_step == within);
        let steps: Vec<(usize, &Step)> = own.collect();
        let mut left = all;
        for &(_, step) in &steps {
            let set = bits(&step.parts);
            assert!(self.leaves(set, left, Self::position(step.direction)), "{:?}", step.parts);
            left &= !set;
        }
        for _ in 0..3 {
            let (mut left, mut done) = (all, vec![false; plan.steps.len()]);
            for _ in 0..steps.len() {
                let ready = |(k, step): &&(usize, &Step)| {
                    !done[*k] && step.predecessors.iter().all(|&j| done[j] || Some(j) == within)
                };
                let ready: Vec<_> = steps.iter().filter(ready).collect();
                let &&(k, step) = random_of(&ready, random);
                let set = bits(&step.parts);
                let d = Self::position(step.direction);
                assert!(self.leaves(set, left, d), "{:?} too early", step.parts);
                left &= !set;
                done[k] = true;
            }
        }
        left
    }

    /// Checks the rounds in reverse order, the assembly sequence, and each alternative of the AND/OR graph.
    fn check_assembly(&self, plan: &Plan, ways: &serde_json::Value) {
        let all = (1_u32 << self.count) - 1;
        let main = |k: &usize| plan.steps[*k].group_step.is_none();
        let mut left = all;
        for k in plan
            .parallel_rounds()
            .into_iter()
            .flat_map(|round| round.into_iter().rev())
            .filter(main)
        {
            let step = &plan.steps[k];
            assert!(self.leaves(bits(&step.parts), left, Self::position(step.direction)));
            left &= !bits(&step.parts);
        }
        let order = plan.assembly_sequence();
        for (at, (step, after)) in order.iter().enumerate() {
            assert!(
                after.iter().all(|&k| k < at && plan.steps[order[k].0].predecessors.contains(step))
            );
        }
        for k in order.into_iter().map(|(k, _)| k).filter(main) {
            let set = bits(&plan.steps[k].parts);
            left |= set;
            assert!(self.leaves(set, left, Self::position(plan.steps[k].direction)), "put in");
        }
        assert_eq!(left, all);
        for (name, node) in ways.as_object().unwrap() {
            let part: usize = name.parse().unwrap();
            if self.demands.fixed >> part & 1 == 1 {
                // The base of the reference is not fixed in the graph.
                continue;
            }
            for way in node["or"].as_array().unwrap() {
                let d: Vec<f64> = serde_json::from_value(way["direction"].clone()).unwrap();
                let and: Vec<String> = serde_json::from_value(way["and"].clone()).unwrap();
                let gone: Vec<usize> = and.iter().map(|name| name.parse().unwrap()).collect();
                let (set, k) = (1 << part, Self::position(DVec3::from_slice(&d)));
                assert!(self.leaves(set, all & !bits(&gone), k), "{name}: {way}");
                // No listed part is redundant, except for those for which a subassembly is taken apart last.
                let apart = self.demands.subassemblies.iter().any(|unit| unit >> part & 1 == 1);
                for &one in gone.iter().filter(|_| !apart) {
                    assert!(!self.leaves(set, all & !bits(&gone) | 1 << one, k), "{name}: {way}");
                }
            }
        }
    }
}

fn random_of<'a, T>(all: &'a [T], random: &mut Random) -> &'a T {
    &all[random.index(all.len())]
}

/// Returns boxes that touch, some with a pocket that contains another one.
fn boxes(random: &mut Random) -> Assembly {
    let mut parts = vec![part("0", &[cuboid([0.0, 0.0, -1.0], [6.0, 6.0, 0.0])])];
    let count = 3 + random.index(4);
    for k in 0..count {
        let low = [k % 2, k / 2 % 2, k / 4].map(|x| 3.0 * x as f64);
        let high = low.map(|x| x + [2.0, 2.5, 3.0][random.index(3)]);
        if random.unit() < 0.3 && parts.len() < 7 {
            let inner = [0, 1, 2].map(|i| (low[i] + 0.5, high[i] - 0.5));
            let walls = well(inner.map(|x| x.0), [inner[0].1, inner[1].1, high[2]], 0.5);
            parts.push(part(&parts.len().to_string(), &walls));
            let core = cuboid(inner.map(|x| x.0), inner.map(|x| x.1));
            parts.push(part(&parts.len().to_string(), &[core]));
        } else if parts.len() < 8 {
            parts.push(part(&parts.len().to_string(), &[cuboid(low, high)]));
        }
    }
    Assembly::new(parts).unwrap()
}

/// Adds random constraints that do not contradict each other, to the assembly and to the reference.
fn with_demands(mut assembly: Assembly, random: &mut Random) -> (Assembly, Demands) {
    let count = assembly.parts().len();
    let mut demands = Demands::default();
    if random.unit() < 0.5 {
        assembly = assembly.with_fixed(&["0"]).unwrap();
        demands.fixed = 1;
    }
    let name = |k: usize| k.to_string();
    for _ in 0..random.index(4) {
        let (a, b) = (random.index(count), random.index(count));
        let next =
            if a == b { continue } else { assembly.clone().with_before(&[name(a)], &[name(b)]) };
        if let Ok(next) = next {
            assembly = next;
            demands.before.push([a, b]);
        }
    }
    for apart in [false, true] {
        let unit: Vec<usize> = (0..count).filter(|_| random.unit() < 0.35).collect();
        let names: Vec<String> = unit.iter().map(|&k| name(k)).collect();
        let before = assembly.clone();
        let next = if apart {
            before.with_subassembly("unit", &names)
        } else {
            before.with_together(&names)
        };
        if let Ok(next) = next.map_err(drop) {
            assembly = next;
        }
    }
    for unit in assembly.constraints().units() {
        let which =
            if unit.is_subassembly { &mut demands.subassemblies } else { &mut demands.together };
        which.push(bits(&unit.parts));
    }
    for _ in 0..random.index(4) {
        let (k, d) = (random.index(count), random.index(AXES.len()));
        assembly = assembly.with_never(&[name(k)], AXES[d] * 3.0, 20.0).unwrap();
        demands.never.push((k, d));
    }
    (assembly, demands)
}

#[test]
fn constrained_plans_remove_as_much_as_exhaustive_search() {
    let mut random = Random::new(2);
    let (mut whole, mut held, mut moved) = (0, 0, 0);
    for round in 0..400 {
        let (assembly, demands) = with_demands(boxes(&mut random), &mut random);
        let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-9)).unwrap();
        let mut judge = Judge::new(&bodies, demands);
        let plan =
            disassemble(&bodies, &matrix(&bodies), &[], options(), Watch::default()).unwrap();
        let all = (1_u32 << bodies.len()) - 1;
        let left = judge.check_walk(&plan, None, all, &mut random);
        assert_eq!(left, bits(&plan.remaining) | bits(&plan.base), "round {round}");
        // The plate is the base, unless it must leave before others.
        if judge.demands.fixed == 1 || judge.demands.before.iter().all(|pair| pair[0] != 0) {
            judge.demands.fixed = 1;
            assert_eq!(left, judge.left(all, all), "round {round}");
        }
        for (k, step) in plan.steps.iter().enumerate().filter(|(_, step)| step.parts.len() > 1) {
            judge.check_walk(&plan, Some(k), bits(&step.parts), &mut random);
        }
        judge.check_assembly(&plan, &precedence_graph(&assembly, &matrix(&bodies)));
        whole += usize::from(plan.interlocked.is_empty());
        held += usize::from(!plan.interlocked.is_empty());
        moved += plan.steps.len();
        assert!(
            plan.interlocked
                .iter()
                .filter(|s| s.is_constrained)
                .all(|s| { s.explain(&bodies).contains("Constraints on their order") })
        );
    }
    assert!(whole > 100 && held > 30 && moved > 700, "{whole} {held} {moved}");
}

#[test]
fn smallest_removal_set_equals_exhaustive_search() {
    let mut random = Random::new(5);
    let (mut out, mut alone, mut held) = (0, 0, 0);
    for round in 0..400 {
        let assembly = boxes(&mut random);
        let (assembly, demands) = if round % 2 == 0 {
            (assembly, Demands::default())
        } else {
            with_demands(assembly, &mut random)
        };
        let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-9)).unwrap();
        let wanted: Vec<usize> = match random.index(3) {
            0 => vec![1, bodies.len() - 1],
            _ => vec![random.index(bodies.len())],
        };
        let plan = remove(&bodies, &matrix(&bodies), &[], &wanted, options(), Watch::default());
        if wanted.iter().any(|&part| assembly.parts()[part].is_fixed()) {
            let least = Judge::new(&bodies, demands).least(bits(&wanted));
            assert!(matches!(plan, Err(AssemblyError::FixedAndRemoved { .. })) && least.is_none());
            held += 1;
            continue;
        }
        let plan = plan.unwrap();
        let found = plan.selection.as_ref().unwrap();
        // The base does not move: the fixed parts, or else the largest part that need not leave.
        let base = bits(&found.base);
        if demands.fixed != 0 {
            assert_eq!(base, demands.fixed);
        } else {
            assert!(base.is_power_of_two() && base & bits(&wanted) == 0);
            let volume = |part: usize| {
                assembly.parts()[part].solid().bounds().side_lengths().element_product()
            };
            let is_first = |part: usize| demands.before.iter().any(|pair| pair[0] == part);
            let other = |part: &usize| !wanted.contains(part) && !is_first(*part);
            let largest = (0..bodies.len()).filter(other).map(volume).fold(0.0, f64::max);
            assert!(volume(found.base[0]) >= largest * (1.0 - 1e-6), "round {round}: {found:?}");
        }
        let judge = Judge::new(&bodies, Demands { fixed: base, ..demands });
        let least = judge.least(bits(&wanted));
        // The judge counts a part as out that leaves with another one, even if it stays locked in it.
        let is_wanted = |part: &&usize| wanted.contains(part);
        let is_locked = plan.interlocked.iter().any(|group| {
            let inside = group.parts.iter().filter(is_wanted).count();
            0 < inside && inside < group.parts.len()
        });
        assert_eq!(found.is_complete, least.is_some() && !is_locked, "round {round}: {found:?}");
        if let Some(least) = least.filter(|_| !is_locked) {
            let count = found.parts.len() + found.others.len();
            assert_eq!((count as u32, found.is_minimal), (least, true), "round {round}: {found:?}");
            let all = (1_u32 << bodies.len()) - 1;
            let left = judge.check_walk(&plan, None, all, &mut random);
            assert_eq!(left & bits(&wanted), 0);
            assert_eq!(left, bits(&plan.base), "what remains");
            out += 1;
            alone += usize::from(found.others.is_empty());
        } else {
            held += 1;
        }
    }
    assert!(out > 200 && alone > 50 && out > alone + 50 && held > 20, "{out} {alone} {held}");
}

/// Returns a box with a lid, a core inside, a cup on the lid, and a separate post.
fn closed() -> Assembly {
    let parts = vec![
        part("box", &well([0.0; 3], [3.0; 3], 1.0)),
        part("core", &[cuboid([0.0; 3], [3.0, 3.0, 2.5])]),
        part("lid", &[cuboid([-1.0, -1.0, 3.0], [4.0, 4.0, 3.5])]),
        part("cup", &[cuboid([0.0, 0.0, 3.5], [1.0, 1.0, 5.0])]),
        part("post", &[cuboid([9.0, 0.0, -1.0], [10.0, 1.0, 6.0])]),
    ];
    Assembly::new(parts).unwrap()
}

fn plan_names(assembly: &Assembly, wanted: &[&str]) -> (Vec<Vec<String>>, Plan) {
    let bodies = Bodies::new(assembly, Fit::Tolerance(1e-9)).unwrap();
    let (matrix, watch) = (matrix(&bodies), Watch::default());
    let plan = match wanted {
        [] => disassemble(&bodies, &matrix, &[], options(), watch).unwrap(),
        names => {
            let parts = assembly.parts_named(names).unwrap();
            remove(&bodies, &matrix, &[], &parts, options(), watch).unwrap()
        }
    };
    let names =
        |step: &Step| assembly.part_names(&step.parts).into_iter().map(str::to_owned).collect();
    (plan.steps.iter().map(names).collect(), plan)
}

#[test]
fn removal_of_a_core_takes_only_blocking_parts() {
    let assembly = closed().with_fixed(&["box"]).unwrap();
    let (steps, plan) = plan_names(&assembly, &["core"]);
    assert_eq!(steps, [["cup"], ["lid"], ["core"]]);
    assert_eq!(assembly.part_names(&plan.base), ["box", "post"]);
    let words = plan.selection.unwrap().describe(&assembly);
    assert!(words.starts_with("core: 2 other parts go (lid, cup); no fewer"), "{words}");
    let (steps, plan) = plan_names(&assembly, &["post"]);
    assert_eq!(steps, [["post"]]);
    assert!(plan.selection.unwrap().describe(&assembly).contains("nothing else has to go"));
    let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-9)).unwrap();
    for parts in [vec![], vec![0, 1, 2, 3, 4]] {
        let none = remove(&bodies, &matrix(&bodies), &[], &parts, options(), Watch::default());
        assert!(matches!(none, Err(AssemblyError::InvalidRemoval { of: 5, .. })));
    }
    let fixed = remove(&bodies, &matrix(&bodies), &[], &[0, 1], options(), Watch::default());
    assert!(matches!(fixed, Err(AssemblyError::FixedAndRemoved { name }) if name == "box"));
    let held = closed().with_fixed(&["c*", "box"]).unwrap();
    assert_eq!(held.parts().iter().filter(|part| part.is_fixed()).count(), 3);
    let core = closed().with_fixed(&["box"]).unwrap().with_never(&["core"], DVec3::Z, 179.0);
    let words = plan_names(&core.unwrap(), &["core"]).1.selection.unwrap().describe(&assembly);
    assert!(
        words.ends_with("no removal path was found, although all removable parts were removed")
    );
}

#[test]
fn subassembly_leaves_as_one_and_only_units_stay_together() {
    let plain = closed().with_fixed(&["box"]).unwrap();
    let sub = plain.clone().with_subassembly("top", &["lid", "cup"]).unwrap();
    let (steps, plan) = plan_names(&sub, &[]);
    let at = steps.iter().position(|step| *step == ["lid", "cup"]).unwrap();
    assert_eq!(
        (steps[at + 1].clone(), plan.steps[at + 1].group_step),
        (vec!["cup".into()], Some(at))
    );
    assert_eq!(sub.constraints().group_name(&plan.steps[at].parts), Some("top"));
    let one = plain.clone().with_together(&["lid", "cup"]).unwrap();
    let (steps, plan) = plan_names(&one, &[]);
    assert!(steps.contains(&vec!["lid".into(), "cup".into()]) && steps.len() == 3);
    assert!(plan.interlocked.is_empty() && assembly_left(&one, &plan) == ["box"]);
    // If up is forbidden, the core cannot leave, and the plan reports the constraint.
    let never = plain.with_never(&["co*"], DVec3::Z, 30.0).unwrap();
    let (_, plan) = plan_names(&never, &[]);
    assert_eq!(assembly_left(&never, &plan), ["box", "core"]);
    assert!(plan.interlocked[0].is_constrained);
    let order = closed().with_before(&["box"], &["post", "cup"]).unwrap();
    let (steps, _) = plan_names(&order, &[]);
    let first = |name: &str| steps.iter().position(|step| step[0] == name).unwrap();
    assert!(first("box") < first("cup") && first("box") < first("post"), "{steps:?}");
}

fn assembly_left<'a>(assembly: &'a Assembly, plan: &Plan) -> Vec<&'a str> {
    assembly.part_names(&[&plan.remaining[..], &plan.base].concat())
}

#[test]
fn paths_of_several_moves_obey_constraints() {
    let plan = |assembly: Assembly| {
        let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
        planned(&bodies, PlanOptions::default())
    };
    let plain = plan(stud());
    let [step] = &plain.steps[..] else { panic!("{plain:?}") };
    assert!(step.parts == [1] && step.path.len() > 1, "{step:?}");
    let first = step.path[0].direction;
    // The plate moves in the opposite direction.
    let turned = plan(stud().with_before(&["plate"], &["stud"]).unwrap());
    let [step] = &turned.steps[..] else { panic!("{turned:?}") };
    assert!(step.parts == [0] && step.path.iter().all(|leg| leg.parts == [0]), "{step:?}");
    // Or neither part moves along it.
    let never = stud().with_never(&["stud"], first, 45.0).unwrap();
    for step in &plan(never.clone()).steps {
        let mut own = step.path.iter().filter(|leg| leg.parts.contains(&1));
        assert!(own.all(|leg| leg.direction.dot(first) < 0.7), "{step:?}");
    }
    let held = plan(never.with_fixed(&["plate"]).unwrap());
    assert!(held.steps.is_empty() && held.interlocked[0].is_constrained);
    assert_eq!(held.interlocked[0].path_search, PathSearch::ConstraintsViolated);
    // Parts that leave as one do not move separately.
    let as_one = plan(stud().with_together(&["plate", "stud"]).unwrap());
    assert!(as_one.steps.is_empty(), "{as_one:?}");
}
