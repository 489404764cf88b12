//! Proofs of common parts: of polycubes with exact volumes, of convex and of turned bodies, of unions and cavities. Every
//! proof holds, and every changed one that claims more is refused.

use colltrans_convex::{ConvexPolyhedron, Pair, Pose};
use colltrans_solid::proof::{
    CommonNode, CommonPartCertificate, CommonPartError, NodeFault, ProvenRelation,
};
use colltrans_solid::{AsSolid, Solid, SolidPenetration, VolumeOptions};
use colltrans_testkit::cases;
use colltrans_testkit::random::Random;
use glam::DVec3;

use crate::common::{at, cuboid};
use crate::penetration::{Polycube, hollow, quarters, square_sheet};

fn options() -> VolumeOptions {
    VolumeOptions::default().with_accuracy(0.0).with_max_cells(4000)
}

fn is_cell(node: CommonNode) -> bool {
    use CommonNode::{Both, OutsideFixed, OutsideMoving, Undecided};
    matches!(node, Both | OutsideMoving | OutsideFixed | Undecided)
}

/// Returns proofs that claim more than a proof, or do not have its form. None of them holds.
fn stronger(proof: &CommonPartCertificate) -> Vec<(String, CommonPartCertificate)> {
    let mut all = Vec::new();
    let mut add = |name: String, change: &dyn Fn(&mut CommonPartCertificate)| {
        let mut other = proof.clone();
        change(&mut other);
        all.push((name, other));
    };
    let [lower, upper] = proof.volume;
    let size = (proof.root.high - proof.root.low).element_product();
    add("a larger lower bound".into(), &|of| of.volume[0] = lower * (1.0 + 1e-9) + 1e-9 * size);
    if upper > 0.0 {
        add("a smaller upper bound".into(), &|of| of.volume[1] = (upper * (1.0 - 1e-9)).min(lower));
    }
    add("no lower bound".into(), &|of| of.volume[0] = f64::NAN);
    add("a negative bound".into(), &|of| of.volume[0] = -1.0);
    add("an infinite bound".into(), &|of| of.volume[1] = f64::INFINITY);
    add("bounds in the wrong order".into(), &|of| of.volume = [upper + 1.0, upper]);
    if proof.bounds.is_some() {
        add("no box".into(), &|of| of.bounds = None);
        for axis in 0..3 {
            let by = (proof.root.high - proof.root.low)[axis] * 1e-6;
            add(format!("a smaller box on axis {axis}"), &|of| {
                if let Some(bounds) = &mut of.bounds {
                    bounds.high[axis] -= by;
                }
            });
        }
    }
    let beyond = proof.root.high + (proof.root.high - proof.root.low);
    add("a point beyond the root".into(), &|of| of.point = Some(beyond));
    add("a point that is no number".into(), &|of| of.point = Some(DVec3::splat(f64::NAN)));
    for number in [f64::NAN, f64::INFINITY, 1e100, 1e-300] {
        add(format!("a side of the root at {number}"), &|of| of.root.high.x = number);
        add(format!("a cut at {number}"), &|of| {
            of.nodes.splice(0..1, [CommonNode::X(number), of.nodes[0], of.nodes[0]]);
        });
    }
    add("an empty root".into(), &|of| of.root.high = of.root.low);
    add("an inverted root".into(), &|of| std::mem::swap(&mut of.root.high, &mut of.root.low));
    add("no nodes".into(), &|of| of.nodes.clear());
    add("a node too few".into(), &|of| of.nodes.truncate(of.nodes.len() - 1));
    add("a node too many".into(), &|of| of.nodes.push(CommonNode::Undecided));
    add("an unknown triangle".into(), &|of| {
        of.nodes.splice(0..1, [CommonNode::Moving(u32::MAX), of.nodes[0], of.nodes[0]]);
    });
    add("a cut beside the root".into(), &|of| {
        let beside = of.root.high.x + 1.0;
        of.nodes.insert(0, CommonNode::X(beside));
        of.nodes.push(CommonNode::OutsideMoving);
    });
    add("a cut in a side of the root".into(), &|of| {
        of.nodes.insert(0, CommonNode::Y(of.root.low.y));
        of.nodes.insert(1, CommonNode::Undecided);
    });
    let step = proof.nodes.len().div_ceil(12).max(1);
    for (k, node) in proof.nodes.iter().enumerate().step_by(step) {
        use CommonNode::{Both, OutsideFixed, OutsideMoving, Undecided};
        let others: &[CommonNode] = match node {
            Both => &[OutsideMoving, OutsideFixed, Undecided],
            OutsideMoving | OutsideFixed => &[Both],
            Undecided => &[Both, OutsideMoving],
            _ => continue,
        };
        for other in others {
            add(format!("{other:?} at node {k}"), &|of| of.nodes[k] = *other);
        }
    }
    all
}

/// Checks that a proof holds, that stronger ones do not, and that a cell without a claim weakens the bounds.
fn assert_proven(pair: &Pair<'_, Solid>, name: &str) -> CommonPartCertificate {
    let proof = pair.certified_common_part(options()).unwrap_or_else(|why| panic!("{name}: {why}"));
    let width = pair.verify_common_part(&proof).unwrap_or_else(|why| panic!("{name}: {why}"));
    assert!(width >= 0.0, "{name}");
    for (change, other) in stronger(&proof) {
        let found = pair.verify_common_part(&other);
        assert!(found.is_err(), "{name}: {change}: {:?}", proof.nodes);
    }
    proof
}

fn assert_contains(proof: &CommonPartCertificate, exact: f64, name: &str) {
    let [lower, upper] = proof.volume;
    assert!(lower <= exact && exact <= upper, "{name}: {exact} {:?}", proof.volume);
}

#[test]
fn proofs_of_polycubes_have_the_exact_volume() {
    let mut seen = [0; 4];
    for seed in 0..cases(40) {
        let mut random = Random::new(seed);
        let [moving, fixed] = [Polycube::random(&mut random), Polycube::random(&mut random)];
        let by = quarters(&mut random, -16, 16);
        let solids = [moving.drawn_solid(&mut random), fixed.drawn_solid(&mut random)];
        let pair = Pair::new(solids[0].at(at(by)), solids[1].at(Pose::IDENTITY)).expect("a pair");
        let proof = assert_proven(&pair, &format!("{seed}"));
        let exact: f64 = moving.lows().map(|low| fixed.common_volumes(low + by, 0.0)).sum();
        assert_contains(&proof, exact, &format!("{seed}"));
        assert!(proof.volume[1] - proof.volume[0] <= 1e-9 * exact, "{seed}: {:?}", proof.volume);
        assert_eq!(proof.relation == Some(ProvenRelation::Disjoint), exact == 0.0, "{seed}");
        assert_eq!(proof.point.is_some(), exact > 0.0, "{seed}");
        if let Some(point) = proof.point {
            assert!(moving.has_inside(point - by) && fixed.has_inside(point), "{seed}: {point}");
        }
        let whole = [moving.lows().count() as f64 == exact, fixed.lows().count() as f64 == exact];
        match proof.relation {
            Some(ProvenRelation::Crossing { only_moving, only_fixed }) => {
                assert!(moving.has_inside(only_moving - by) && !fixed.has_inside(only_moving));
                assert!(fixed.has_inside(only_fixed) && !moving.has_inside(only_fixed - by));
                seen[0] += 1;
            }
            Some(ProvenRelation::MovingContained) => assert!(whole[0], "{seed}"),
            Some(ProvenRelation::FixedContained) => assert!(whole[1], "{seed}"),
            Some(_) => seen[1] += 1,
            None => assert!(exact > 0.0, "{seed}"),
        }
        if exact > 0.0 {
            let swapped = Pair::new(solids[1].at(at(by)), solids[0].at(Pose::IDENTITY));
            let found = swapped.expect("a pair").verify_common_part(&proof);
            assert!(found.is_err() || moving.lows().eq(fixed.lows()), "{seed}");
        }
    }
    assert!(seen[..2].iter().all(|count| *count > 0), "{seen:?}");
}

#[test]
fn proofs_of_turned_bodies_add_up_on_both_sides_of_a_plane() {
    for seed in 0..cases(24) {
        let mut random = Random::new(seed);
        let body = Polycube::random(&mut random);
        let turn = Pose::new(random.rotation(), random.vector()).expect("a pose");
        let high = random.range(-3.0, 3.0);
        let volumes = [(-20.0, high), (high, 20.0)].map(|(low, high)| {
            let half = cuboid([-20.0, -20.0, low], [20.0, 20.0, high]);
            let pair = Pair::new(body.solid.at(turn), half.at(Pose::IDENTITY)).expect("a pair");
            assert_proven(&pair, &format!("{seed}")).volume
        });
        // The rounded rotation changes the volume by some roundoffs.
        let exact = body.lows().count() as f64;
        let [lower, upper] = [0, 1].map(|k| volumes[0][k] + volumes[1][k]);
        assert!(lower <= exact * (1.0 + 1e-12) && exact * (1.0 - 1e-12) <= upper, "{seed}");
    }
}

#[test]
fn proofs_of_convex_bodies_are_exact_and_agree_with_common_parts() {
    let mut overlapping = 0;
    for seed in 0..cases(40) {
        let mut random = Random::new(seed);
        let mut hull = || {
            let points: Vec<DVec3> = (0..12).map(|_| random.vector()).collect();
            ConvexPolyhedron::from_points(&points).expect("a hull")
        };
        let hulls = [hull(), hull()];
        let poses =
            [0, 1].map(|_| Pose::new(random.rotation(), random.vector() * 0.7).expect("a pose"));
        let solids = hulls.each_ref().map(|hull| hull.as_solid().expect("a solid"));
        let pair = Pair::new(solids[0].at(poses[0]), solids[1].at(poses[1])).expect("a pair");
        let proof = assert_proven(&pair, &format!("{seed}"));
        let found = pair.common_part(VolumeOptions::default()).expect("a common part");
        let [lower, upper] = proof.volume;
        assert!(lower <= found.volume[1] && found.volume[0] <= upper, "{seed}: {found:?}");
        assert!(upper - lower <= 1e-9 * upper, "{seed}: {:?}", proof.volume);
        overlapping += usize::from(lower > 0.0);
    }
    assert!(overlapping > cases(12), "{overlapping}");
}

#[test]
fn contained_bodies_and_equal_bodies_are_proven_to_be_contained() {
    let outer = cuboid([0.0; 3], [4.0; 3]);
    for (low, high) in [([1.0; 3], [2.0; 3]), ([0.0; 3], [4.0, 1.0, 1.0]), ([0.0; 3], [4.0; 3])] {
        let inner = cuboid(low, high);
        let pair = Pair::new(inner.at(Pose::IDENTITY), outer.at(Pose::IDENTITY)).expect("a pair");
        let mut proof = assert_proven(&pair, "inside");
        assert_eq!(proof.relation, Some(ProvenRelation::MovingContained));
        let is_equal = low == [0.0; 3] && high == [4.0; 3];
        proof.relation = Some(ProvenRelation::FixedContained);
        assert_eq!(pair.verify_common_part(&proof).is_ok(), is_equal);
        for relation in [
            ProvenRelation::Disjoint,
            ProvenRelation::Crossing { only_moving: DVec3::ONE, only_fixed: DVec3::splat(3.5) },
        ] {
            proof.relation = Some(relation);
            assert!(pair.verify_common_part(&proof).is_err());
        }
    }
}

/// The winding number decides what is inside, as for every other query: pieces that overlap count once, cavities are
/// empty unless another piece fills them, and open surfaces bound nothing.
#[test]
fn unions_cavities_and_sheets_have_their_volume() {
    let cube = cuboid([0.0; 3], [1.0; 3]);
    let twice = Solid::from_pieces([&cube, &cube]).expect("pieces");
    let crossed =
        Solid::from_pieces([&cube, &cuboid([0.5, 0.0, 0.0], [2.0, 1.0, 1.0])]).expect("pieces");
    let wall = hollow([[-1.0; 3], [2.0; 3]], [[0.25; 3], [0.75; 3]]);
    let filled = Solid::from_pieces([&wall, &cuboid([0.0; 3], [0.5; 3])]).expect("pieces");
    let sheet = square_sheet(9.0);
    let with_sheet = Solid::from_pieces([&cube, &sheet]).expect("pieces");
    let expected =
        [(&twice, 1.0), (&crossed, 1.0), (&wall, 0.875), (&filled, 0.890_625), (&with_sheet, 1.0)];
    for (body, exact) in expected {
        for bodies in [[&cube, body], [body, &cube]] {
            let [moving, fixed] = bodies.map(|body| body.at(Pose::IDENTITY));
            let pair = Pair::new(moving, fixed).expect("a pair");
            let proof = assert_proven(&pair, &format!("{exact}"));
            assert_contains(&proof, exact, "a union");
            assert!(proof.volume[1] - proof.volume[0] < 1e-9, "{exact} {:?}", proof.volume);
        }
    }
    for bodies in [[&cube, &sheet], [&sheet, &cube], [&sheet, &sheet]] {
        let [moving, fixed] = bodies.map(|body| body.at(Pose::IDENTITY));
        let proof = assert_proven(&Pair::new(moving, fixed).expect("a pair"), "a sheet");
        assert_eq!(proof.volume[1], 0.0);
        assert_eq!(proof.relation, Some(ProvenRelation::Disjoint));
    }
}

#[test]
fn bodies_far_from_the_origin_and_of_extreme_sizes_have_proofs() {
    let places = [(1.0, 1e9), (1e50, 0.0), (1e-50, 0.0), (2.0_f64.powi(190), 0.0), (1e-9, 1.0)];
    for (size, far) in places {
        let cube = cuboid([0.0; 3], [size; 3]);
        let turn = Pose::new(Random::new(3).rotation(), DVec3::splat(far)).expect("a pose");
        let pair = Pair::new(cube.at(turn), cube.at(at(DVec3::splat(far)))).expect("a pair");
        let proof = assert_proven(&pair, &format!("{size} {far}"));
        let [lower, upper] = proof.volume.map(|volume| volume / size.powi(3));
        assert!(
            lower > 0.01 && upper < 1.0 && upper - lower < 1e-9,
            "{size} {far}: {lower} {upper}"
        );
    }
}

#[test]
fn few_cells_leave_valid_bounds() {
    for seed in 0..cases(20) {
        let mut random = Random::new(seed);
        let [moving, fixed] = [Polycube::random(&mut random), Polycube::random(&mut random)];
        let by = quarters(&mut random, -8, 8);
        let exact: f64 = moving.lows().map(|low| fixed.common_volumes(low + by, 0.0)).sum();
        let pair = Pair::new(moving.solid.at(at(by)), fixed.solid.at(Pose::IDENTITY));
        let pair = pair.expect("a pair");
        for max_cells in [0, 1, 2, 7, 30] {
            let proof = pair.certified_common_part(options().with_max_cells(max_cells));
            let proof = proof.expect("a proof");
            assert!(
                proof.nodes.iter().filter(|node| is_cell(**node)).count() <= 1 + max_cells as usize
            );
            assert_contains(&proof, exact, &format!("{seed}"));
            assert!(pair.verify_common_part(&proof).is_ok());
        }
    }
}

#[test]
fn rounded_bodies_and_long_proofs_are_refused() {
    let cube = cuboid([0.0; 3], [1.0; 3]);
    let round = cube.clone().rounded(0.5).expect("a rounded body");
    let pair = Pair::new(round.at(Pose::IDENTITY), cube.at(Pose::IDENTITY)).expect("a pair");
    let found = pair.certified_common_part(options());
    assert!(matches!(found, Err(CommonPartError::Query(_))), "{found:?}");

    let pair = Pair::new(cube.at(Pose::IDENTITY), cube.at(Pose::IDENTITY)).expect("a pair");
    let proof = pair.certified_common_part(options()).expect("a proof");
    assert!(matches!(pair.verify_common_part(&proof), Ok(width) if width < 1e-9));
    let round = Pair::new(round.at(Pose::IDENTITY), cube.at(Pose::IDENTITY)).expect("a pair");
    assert!(matches!(round.verify_common_part(&proof), Err(CommonPartError::Query(_))));

    // Sums of more volumes have larger errors.
    let proof = CommonPartCertificate { volume: [1.0 - 1e-9, 1.0 + 1e-9], ..proof };
    // A chain of cuts, each of which leaves one cell.
    let chain = |count: usize| {
        let cuts = (1..=count).map(|k| CommonNode::X(1.0 - k as f64 / (count + 1) as f64));
        let nodes = cuts.chain(std::iter::repeat_n(CommonNode::Both, count + 1)).collect();
        CommonPartCertificate { nodes, ..proof.clone() }
    };
    assert!(pair.verify_common_part(&chain(100)).is_ok());
    let found = pair.verify_common_part(&chain(5000));
    assert!(
        matches!(found, Err(CommonPartError::Node { node: 4096, reason: NodeFault::Depth })),
        "{found:?}"
    );
    let grid = |count: u32| {
        // A balanced tree: each node before its children.
        fn add(nodes: &mut Vec<CommonNode>, low: u32, high: u32, count: u32) {
            if high - low == 1 {
                return nodes.push(CommonNode::Both);
            }
            let middle = low.midpoint(high);
            nodes.push(CommonNode::X(f64::from(middle) / f64::from(count)));
            add(nodes, low, middle, count);
            add(nodes, middle, high, count);
        }
        let mut nodes = Vec::new();
        add(&mut nodes, 0, count, count);
        CommonPartCertificate { nodes, ..proof.clone() }
    };
    assert!(pair.verify_common_part(&grid(1000)).is_ok());
    // A verification holds the cells of one path of the tree.
    let most_bytes = |proof: &CommonPartCertificate| {
        let check = || assert!(pair.verify_common_part(proof).is_ok());
        allocation_counter::measure(check).bytes_max
    };
    let [few, many] = [64, 1024].map(|count| most_bytes(&grid(count)));
    assert!(few > 0 && many < 2 * few, "{few} {many}");
}
