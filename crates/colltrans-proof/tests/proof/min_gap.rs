//! Proof files of casts with a minimum gap are valid, and not valid for a larger gap.

use colltrans_convex::{Case, Cast, ConvexPolyhedron, Pose};
use colltrans_proof::ProofFile;
use colltrans_solid::Solid;
use colltrans_testkit::bodies::{at_xyz as at, block as cuboid, floor_with_wall as corner};
use glam::DVec3;

fn cube() -> ConvexPolyhedron {
    cuboid(DVec3::splat(-0.5), DVec3::splat(0.5))
}

#[test]
fn proof_of_convex_cast_holds_for_its_minimum_gap_only() {
    let cube = cube();
    let cast = Cast::new(cube.at(at(-3.0, 0.9, 0.0)), cube.at(Pose::IDENTITY), DVec3::X);
    let cast = cast.expect("a query");
    assert!(!cast.to_json().contains("min_gap\""));
    let kept = cast.with_min_gap(0.25).expect("a gap");
    let case = Case::from_json(&kept.to_json()).expect("a case");
    assert_eq!(case.cast().expect("a query").first_contact(), kept.first_contact());
    for gap in [0.25, 1.0, 2.5] {
        let kept = cast.with_min_gap(gap).expect("a gap");
        let clearance = kept.clearance().expect("an answer");
        let saved = ProofFile::of_clearance(&kept, &clearance).to_json();
        let proof = ProofFile::from_json(&saved).expect("a proof");
        proof.check().expect("a right proof");
        assert!(proof.to_string().contains(&format!("{gap:?} apart or nearer")), "{proof}");
        let more = saved
            .replace(&format!("\"min_gap\":{gap:?}"), &format!("\"min_gap\":{:?}", gap * 1.01));
        assert!(more != saved && ProofFile::from_json(&more).expect("a proof").check().is_err());
    }
}

#[test]
fn proof_of_solid_cast_holds_for_its_minimum_gap_only() {
    let (corner, cube) = (corner(), cuboid(DVec3::ZERO, DVec3::ONE));
    let cube = Solid::from_convex(&cube).expect("a box");
    let cast = Cast::new(cube.at(at(-3.0, 0.5, 1.0)), corner.at(Pose::IDENTITY), DVec3::X);
    let kept = cast.expect("a query").with_min_gap(0.25).expect("a gap");
    let saved = ProofFile::of_solids(&kept, [&[&cube], &[&corner]]).expect("a proof").to_json();
    let proof = ProofFile::from_json(&saved).expect("a proof");
    proof.check().expect("a right proof");
    assert!(
        proof.min_gap() == 0.25 && proof.to_string().contains("0.25 apart or nearer"),
        "{proof}"
    );
    let more = saved.replace("\"min_gap\":0.25", "\"min_gap\":0.26");
    assert!(more != saved && ProofFile::from_json(&more).expect("a proof").check().is_err());
}
