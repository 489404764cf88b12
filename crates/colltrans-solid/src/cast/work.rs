//! How much is looked at of solids, and how that grows.

use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{Mesh, extruded, ring};
use colltrans_testkit::solids::{bumpy_ball, comb, comb_outline, slab, washer};
use glam::{DQuat, DVec3};

use crate::Solid;
use crate::pair::SolidPairSearch;
use colltrans_convex::{Cast, Pair, Pose};
use colltrans_kernel::work::{assert_growth, looks};

fn rotation() -> DQuat {
    Random::new(5).rotation()
}

/// An answer and its proof are of one search, also about bodies that are made once more of the same facets.
#[test]
fn a_proof_takes_no_second_search() {
    let made = |Mesh { vertices, faces }: &Mesh| Solid::from_mesh(vertices, faces).unwrap();
    let meshes = [bumpy_ball(1_000), slab(DVec3::ZERO, DVec3::ONE, [5, 5, 1])];
    let ([ball, plate], again) = (meshes.each_ref().map(made), meshes.each_ref().map(made));
    assert!(ball.has_tree_of(&again[0]) && plate.has_tree_of(&again[1]));
    for far in [0.0, 1.0, 3.0] {
        let pose = Pose::new(rotation(), DVec3::splat(far)).expect("a pose");
        let pair = Pair::new(ball.at(pose), plate.at(Pose::IDENTITY)).expect("a pair");
        let saved = Pair::new(again[0].at(pose), again[1].at(Pose::IDENTITY)).expect("a pair");
        let without = looks(|| drop(pair.distance()));
        let with = looks(|| {
            let (_, found) = pair.ask(true).expect("an answer");
            saved.prove(found).expect("a proof");
        });
        assert!(with == without && without > 0, "{with} and {without} looks, {far}");
        let length = 0.999 * pair.distance().expect("an answer").lower;
        let without = looks(|| drop(pair.within(length)));
        let with = looks(|| {
            let (_, found) = pair.decide(length, true).expect("an answer");
            saved.prove(found).expect("a proof");
        });
        assert_eq!(with, without, "{far}");
    }
}

/// Boxes of thin triangles in one plane overlap by the thousand.
#[test]
fn thin_triangles_of_large_faces() {
    assert_growth("washer", 1_000, |sides| {
        let Mesh { vertices, faces } = washer([1.0, 2.0], [0.0, 1.0], sides);
        let ring = Solid::from_mesh(&vertices, &faces).expect("a washer");
        assert!(ring.shrink_report(1e-4).inverted.is_empty());
    });
}

/// Boxes of the long triangles of a comb's caps overlap those of the walls of all its teeth.
#[test]
fn long_triangles_beside_many_walls() {
    let by_ears = |teeth| extruded(&comb_outline(teeth), [0.0, 1.0]);
    let shrink_looks = |Mesh { vertices, faces }: Mesh| {
        let solid = Solid::from_mesh(&vertices, &faces).expect("a comb");
        looks(|| assert!(solid.shrink_report(1e-4).inverted.is_empty()))
    };
    for (what, counts) in [
        ("fans", [400, 2_000].map(|teeth| shrink_looks(comb(teeth)))),
        ("ears", [200, 1_000].map(|teeth| shrink_looks(by_ears(teeth)))),
    ] {
        let growth = counts[1] as f64 / counts[0] as f64;
        println!("comb of {what}: {counts:?} looks, {growth:.1} times as many");
        assert!(growth < 8.0, "comb of {what}: {growth:.1} times as many looks");
    }
}

#[test]
fn solids_with_faces_of_many_corners() {
    for (what, radii) in [("round", [1.0, 1.0]), ("jagged", [1.0, 0.6])] {
        assert_growth(what, 2_000, |sides| {
            let outline = ring(sides, 1.0, 0.0).enumerate().map(|(k, p)| p * radii[k % 2]);
            let outline: Vec<DVec3> = outline.collect();
            let Mesh { vertices, faces } = extruded(&outline, [0.0, 1.0]);
            let prism = Solid::from_mesh(&vertices, &faces).expect("a prism");
            assert_eq!(prism.triangles().len(), 4 * sides - 4);
        });
    }
}

/// What rounding leaves in doubt of flat bodies that are turned, or of positions that are no round
/// numbers, is told by twice the usual precision: no determinant of whole numbers.
#[test]
fn flat_bodies_need_no_whole_numbers() {
    let Mesh { vertices, faces } = slab(DVec3::new(-1.0, -1.0, 0.0), DVec3::ONE, [4, 4, 1]);
    let plate = Solid::from_mesh(&vertices, &faces).expect("a slab");
    for turn in [DQuat::IDENTITY, rotation()] {
        for (height, way) in [(1.0, DVec3::NEG_Z), (1.001, DVec3::NEG_Z), (2.0, DVec3::NEG_Z)] {
            let at = turn * DVec3::new(0.3, -0.17, height);
            let above = plate.at(Pose::new(turn, at).expect("a pose"));
            let below = plate.at(Pose::new(turn, DVec3::ZERO).expect("a pose"));
            let cast = Cast::new(above, below, turn * way).expect("a direction");
            let ask = || assert!(!cast.clearance().expect("an answer").is_free());
            // The first query makes the hull.
            ask();
            assert_eq!(looks(ask), 0, "{turn} from {height}");
        }
    }
}
