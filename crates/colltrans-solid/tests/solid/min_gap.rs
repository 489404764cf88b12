//! Solids that keep a gap: families judged over all pairs of facets, what is known in closed form, proofs.

use colltrans_convex::{Cast, Clearance, Outcome, Pose, QueryError};
use colltrans_solid::proof::SolidCertificate;
use colltrans_solid::{Solid, SolidCast, StartOverlap};
use colltrans_testkit::bodies::{at_xyz as at, block as cuboid, floor_with_wall as corner};
use colltrans_testkit::cases;
use colltrans_testkit::oracle::settings;
use colltrans_testkit::oracle::solids::min_gap::{GapOutcome, examine};
use colltrans_testkit::oracle::solids::nearest::MESHES;
use colltrans_testkit::oracle::solids::settings::FAMILIES;
use colltrans_testkit::oracle::solids::sheets;
use glam::{DQuat, DVec3};

#[test]
fn all_families_are_right() {
    let convex = settings::FAMILIES.iter().map(|family| format!("convex-{}", family.0));
    let known = FAMILIES.into_iter().chain(sheets::FAMILIES).chain(MESHES).map(str::to_owned);
    let mut counts = [0; 3];
    for family in known.chain(convex) {
        for seed in 0..cases(8) {
            let seen =
                examine(&family, seed, false).unwrap_or_else(|e| panic!("{family}:{seed}: {e}"));
            counts[seen.map_or(0, |seen| seen as usize)] += 1;
        }
    }
    let [_, free, blocked] = counts;
    assert!(
        free >= cases(31) && blocked >= cases(31),
        "{free} {blocked}, {:?}",
        GapOutcome::Blocked
    );
}

#[test]
fn a_box_slides_over_a_floor_and_stops_before_a_wall() {
    let (corner, cube) = (corner(), cuboid(DVec3::ZERO, DVec3::ONE));
    let turn = Pose::new(DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.7), DVec3::ONE * 7.0);
    let turn = turn.expect("a pose");
    for (rotate, tolerance) in [(false, 0.0), (false, 1e-6), (true, 0.0), (true, 1e-6)] {
        let placed = |pose: Pose| if rotate { turn.compose(&pose).expect("a pose") } else { pose };
        let along = |d: DVec3| if rotate { turn.transform_vector(d) } else { d };
        let clearance = |z: f64, gap: f64, d: DVec3| {
            let (a, b) = (cube.at(placed(at(-3.0, 0.0, z))), corner.at(placed(Pose::IDENTITY)));
            let cast = Cast::between(a, b, along(d)).expect("a query");
            let cast = cast.with_tolerance(tolerance).expect("a tolerance");
            let kept = cast.with_min_gap(gap).expect("a gap");
            let (clearance, proof) = kept.certified_clearance().expect("an answer");
            kept.verify(&proof).expect("a proof");
            clearance
        };
        // It stands the gap above the floor; or a little more or less.
        let distance = clearance(0.25, 0.25, DVec3::X).distance().expect("kept");
        assert!((distance - 4.75).abs() < 2e-6, "{rotate} {tolerance}: {distance}");
        let nearer = clearance(0.249, 0.25, DVec3::X);
        assert!(matches!(nearer, Clearance::Overlapping(_)), "{nearer:?}");
        assert!(clearance(0.25, 0.25, DVec3::Z).is_free());
        let down = clearance(1.0, 0.25, DVec3::NEG_Z).distance().expect("kept");
        assert!((down - 0.75).abs() < 2e-6);
        let now = clearance(0.25, 0.25, DVec3::NEG_Z).distance().expect("kept");
        assert!(now <= 2e-6, "{now}");
    }
}

/// Beside a rounded step: past its edge by a corner's way round.
#[test]
fn edges_are_rounded_by_the_gap_and_not_boxed() {
    let (corner, cube) = (corner(), cuboid(DVec3::ZERO, DVec3::ONE));
    let start = at(-8.0, 3.0 - 0.8, -0.5);
    let cast = Cast::between(cube.at(start), corner.at(Pose::IDENTITY), DVec3::X * 2.0);
    let cast = cast.expect("a query").with_min_gap(0.5).expect("a gap");
    let Outcome::Contact(contact) = cast.first_contact().expect("an answer") else {
        panic!("0.2 beside the edge")
    };
    // The edge of the box passes the upright edge of the floor 0.2 beside it.
    let right = (3.0 - (0.25_f64 - 0.04).sqrt()) / 2.0;
    let found = contact.translation;
    assert!(found.lower <= right && right <= found.upper + 1e-15, "{found:?} {right}");
    assert!(found.upper - found.lower < 1e-12);
    let way = contact.point_on_fixed - contact.point_on_moving - DVec3::X * 2.0 * found.value;
    assert!((way.length() - 0.5).abs() < 1e-12 && way.normalize().dot(contact.normal) > 0.999);
    assert!(cast.with_min_gap(0.1).expect("a gap").clearance().expect("an answer").is_free());
    let [first, last] =
        cast.contact_range().expect("an answer").interval().expect("they come near");
    assert!((first - right).abs() < 1e-12 && (last - (8.0 - right - 0.5)).abs() < 4.0);
    assert!(cast.exit().expect("they come near").value > first);
}

#[test]
fn what_is_nearer_at_the_start_may_be_ignored() {
    let (corner, cube) = (corner(), cuboid(DVec3::ZERO, DVec3::ONE));
    let cast = Cast::between(cube.at(at(-3.0, 0.0, 0.1)), corner.at(Pose::IDENTITY), DVec3::X);
    let cast = cast.expect("a query").with_min_gap(0.25).expect("a gap");
    assert!(cast.overlaps() && cast.intersects().expect("an answer").meets);
    let ignored = cast.with_start_overlap(StartOverlap::Ignore);
    let (clearance, proof) = ignored.certified_clearance().expect("an answer");
    ignored.verify(&proof).expect("a proof");
    let distance = clearance.distance().expect("kept");
    assert!((distance - 4.75).abs() < 1e-12, "{distance}");
    assert!(!cast.with_min_gap(0.05).expect("a gap").overlaps());
    // Inside a shell, far from its walls.
    let shell = Solid::from_convex(&cuboid(DVec3::splat(-9.0), DVec3::splat(9.0))).expect("a box");
    let inside = Cast::between(cube.at(Pose::IDENTITY), shell.at(Pose::IDENTITY), DVec3::X);
    let inside = inside.expect("a query").with_min_gap(0.5).expect("a gap");
    assert!(matches!(inside.clearance(), Ok(Clearance::Overlapping(_))));
}

#[test]
fn gaps_that_are_none_are_refused_and_slight_ones_are_none() {
    let (corner, cube) = (corner(), cuboid(DVec3::ZERO, DVec3::ONE));
    let cast = Cast::between(cube.at(at(-3.0, 0.0, 0.0)), corner.at(Pose::IDENTITY), DVec3::X);
    let cast = cast.expect("a query");
    for gap in [-1e-9, f64::NAN, f64::INFINITY, 1e61] {
        assert!(matches!(cast.with_min_gap(gap), Err(QueryError::MinGap { .. })), "{gap}");
    }
    let plain = cast.clearance().expect("an answer");
    for gap in [0.0, 1e-300, 1e-15] {
        assert_eq!(cast.with_min_gap(gap).expect("a gap").clearance().expect("an answer"), plain);
    }
}

#[test]
fn changed_proofs_are_refused() {
    let (corner, cube) = (corner(), cuboid(DVec3::ZERO, DVec3::ONE));
    let cast = Cast::between(cube.at(at(-3.0, 0.5, 1.0)), corner.at(Pose::IDENTITY), DVec3::X);
    let kept = cast.expect("a query").with_min_gap(0.25).expect("a gap");
    let (_, proof) = kept.certified_clearance().expect("an answer");
    assert!(kept.verify(&proof).expect("a proof") < 1e-12);
    let less = SolidCertificate { lower: proof.lower + 1e-9, ..proof.clone() };
    assert!(kept.verify(&less).is_err());
    let mut other = proof.clone();
    if let Some(stop) = &mut other.stop {
        stop.offset_distance -= 1e-6;
    }
    assert!(kept.verify(&other).is_err());
    for entry in 0..proof.cover.entries().len() {
        let mut entries = proof.cover.entries().to_vec();
        entries.remove(entry);
        let changed = SolidCertificate { cover: entries.into(), ..proof.clone() };
        assert!(kept.verify(&changed).is_err(), "without entry {entry}");
    }
    assert!(kept.with_min_gap(0.2501).expect("a gap").verify(&proof).is_err());
}
