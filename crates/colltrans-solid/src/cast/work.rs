//! Number of elements that algorithms on solids visit, and its growth with the size of the input.

use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{Mesh, extruded, ring};
use colltrans_testkit::solids::{bumpy_ball, comb, comb_outline, slab, washer};
use glam::{DQuat, DVec3};

use crate::Solid;
use crate::pair::SolidPairSearch;
use colltrans_convex::{Cast, Pair, Pose};
use colltrans_kernel::visit_counter::{assert_growth, visits_during};

fn rotation() -> DQuat {
    Random::new(5).rotation()
}

/// The certificate comes from the same search as the answer, also for bodies that are built again from the same
/// facets.
#[test]
fn distance_proof_needs_no_second_search() {
    let to_solid = |Mesh { vertices, faces }: &Mesh| Solid::from_mesh(vertices, faces).unwrap();
    let meshes = [bumpy_ball(1_000), slab(DVec3::ZERO, DVec3::ONE, [5, 5, 1])];
    let ([ball, plate], rebuilt) =
        (meshes.each_ref().map(to_solid), meshes.each_ref().map(to_solid));
    assert!(ball.has_same_tree(&rebuilt[0]) && plate.has_same_tree(&rebuilt[1]));
    for far in [0.0, 1.0, 3.0] {
        let pose = Pose::new(rotation(), DVec3::splat(far)).expect("a pose");
        let pair = Pair::new(ball.at(pose), plate.at(Pose::IDENTITY)).expect("a pair");
        let rebuilt_pair =
            Pair::new(rebuilt[0].at(pose), rebuilt[1].at(Pose::IDENTITY)).expect("a pair");
        let without = visits_during(|| drop(pair.distance()));
        let with = visits_during(|| {
            let (_, found) = pair.distance_with_proof_input(true).expect("an answer");
            rebuilt_pair.prove_lower_bound(found).expect("a proof");
        });
        assert!(with == without && without > 0, "{with} and {without} visits at {far}");
        let length = 0.999 * pair.distance().expect("an answer").lower;
        let without = visits_during(|| drop(pair.within(length)));
        let with = visits_during(|| {
            let (_, found) = pair.within_with_proof_input(length, true).expect("an answer");
            rebuilt_pair.prove_lower_bound(found).expect("a proof");
        });
        assert_eq!(with, without, "{far}");
    }
}

/// Bounding boxes of thin triangles in one plane overlap by the thousand.
#[test]
fn shrink_report_of_washer_is_subquadratic() {
    assert_growth("washer", 1_000, |sides| {
        let Mesh { vertices, faces } = washer([1.0, 2.0], [0.0, 1.0], sides);
        let ring = Solid::from_mesh(&vertices, &faces).expect("a washer");
        assert!(ring.shrink_report(1e-4).inverted.is_empty());
    });
}

/// Bounding boxes of the long triangles of a comb's caps overlap those of the walls of all its teeth.
#[test]
fn shrink_report_of_comb_is_subquadratic() {
    let by_ears = |teeth| extruded(&comb_outline(teeth), [0.0, 1.0]);
    let shrink_looks = |Mesh { vertices, faces }: Mesh| {
        let solid = Solid::from_mesh(&vertices, &faces).expect("a comb");
        visits_during(|| assert!(solid.shrink_report(1e-4).inverted.is_empty()))
    };
    for (what, counts) in [
        ("fans", [400, 2_000].map(|teeth| shrink_looks(comb(teeth)))),
        ("ears", [200, 1_000].map(|teeth| shrink_looks(by_ears(teeth)))),
    ] {
        let growth = counts[1] as f64 / counts[0] as f64;
        println!("comb of {what}: {counts:?} visits, growth factor {growth:.1}");
        assert!(growth < 8.0, "comb of {what}: visits grow by a factor of {growth:.1}");
    }
}

#[test]
fn building_prism_of_many_sides_is_subquadratic() {
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

/// Rotated flat bodies, and positions that are not round numbers, leave signs undecided. Twice the usual precision
/// decides them, without determinants of integers.
#[test]
fn clearance_of_flat_bodies_needs_no_exact_integers() {
    let Mesh { vertices, faces } = slab(DVec3::new(-1.0, -1.0, 0.0), DVec3::ONE, [4, 4, 1]);
    let plate = Solid::from_mesh(&vertices, &faces).expect("a slab");
    for turn in [DQuat::IDENTITY, rotation()] {
        for (height, direction) in [(1.0, DVec3::NEG_Z), (1.001, DVec3::NEG_Z), (2.0, DVec3::NEG_Z)]
        {
            let at = turn * DVec3::new(0.3, -0.17, height);
            let above = plate.at(Pose::new(turn, at).expect("a pose"));
            let below = plate.at(Pose::new(turn, DVec3::ZERO).expect("a pose"));
            let cast = Cast::new(above, below, turn * direction).expect("a direction");
            let run_query = || assert!(!cast.clearance().expect("an answer").is_free());
            // The first query builds the hull.
            run_query();
            assert_eq!(visits_during(run_query), 0, "{turn} from {height}");
        }
    }
}
