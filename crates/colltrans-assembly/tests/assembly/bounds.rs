//! Bounds of answers, compared with fractions.

use crate::common::*;
use colltrans::Solid;
use colltrans::solid::StartOverlap;
use colltrans_assembly::candidates::{CandidateOptions, find_candidates};
use colltrans_assembly::liaisons::find_liaisons;
use colltrans_assembly::matrix::ContactMatrix;
use colltrans_assembly::plan::{PlanOptions, disassemble};
use colltrans_assembly::travel::{PartTravel, travels_of_parts};
use colltrans_assembly::{Assembly, Bodies, Fit, Watch};
use colltrans_testkit::oracle::exact::{Dyadic, Vector};
use colltrans_testkit::random::Random;
use glam::{DAffine3, DMat3, DQuat, DVec3};

/// Returns a random pose.
fn pose(random: &mut Random) -> DAffine3 {
    let turn = DQuat::from_axis_angle(random.direction(), 6.0 * random.unit());
    DAffine3::from_mat3_translation(DMat3::from_quat(turn), random.direction() * 100.0)
}

/// Returns six times the volume, exactly.
fn six_volumes(solid: &Solid) -> Dyadic {
    let of = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| Vector::new(solid.vertices()[v as usize]));
        a.dot(&b.cross(&c))
    };
    solid.triangles().iter().map(of).fold(Dyadic::ZERO, |sum, x| &sum + &x)
}

#[test]
fn exact_volume_is_within_volume_bounds() {
    let mut random = Random::new(3);
    for round in 0..200 {
        let side = 10.0_f64.powi(round % 7 - 3);
        let pieces = well([0.0; 3], [1.0, side, 2.0], 0.5);
        let solid = turned("well", &pieces, pose(&mut random)).solid().clone();
        let [low, high] = solid.volume_bounds().unwrap();
        let exact = six_volumes(&solid);
        let six = Dyadic::new(6.0);
        assert!(&Dyadic::new(low) * &six <= exact && exact <= &Dyadic::new(high) * &six);
        assert!(low <= solid.volume() && solid.volume() <= high);
        assert!(high - low < 1e-8 * solid.volume(), "{low} {high}");
    }
    let mut open = cuboid([0.0; 3], [1.0; 3]);
    open.mesh.faces.pop();
    assert_eq!(part("open", &[open]).solid().volume_bounds(), None);
}

/// Bounds of travels of rotated boxes are compared with the exact heights of their corners.
#[test]
fn exact_travel_is_within_travel_bounds() {
    let mut random = Random::new(9);
    for _ in 0..40 {
        let world = pose(&mut random);
        let parts = vec![
            turned("peg", &[cuboid([0.1; 3], [0.9, 0.9, 4.0])], world),
            turned("block", &well([0.0, 0.0, 0.0], [1.0, 1.0, 2.0], 1.0), world),
        ];
        let assembly = Assembly::new(parts).unwrap();
        let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
        let touching = find_liaisons(&bodies, Watch::default()).unwrap();
        let given = vec![world.matrix3.z_axis.normalize()];
        let choice = CandidateOptions::default().with_given(given).with_search(false);
        let found = find_candidates(&bodies, &touching, &choice).unwrap();
        let all = [true; 2];
        let start = StartOverlap::Refuse;
        let matrix =
            ContactMatrix::new(&bodies, &found.directions(), &all, start, Watch::default())
                .unwrap();
        let options = PlanOptions::default().with_samples(0);
        let plan = disassemble(&bodies, &matrix, &[], options, Watch::default()).unwrap();
        let step = &plan.steps[0];
        assert_eq!(step.parts, [0]);
        let heights = |part: usize| {
            let d = Vector::new(step.direction);
            let vertices = assembly.parts()[part].solid().vertices();
            vertices.iter().map(|v| Vector::new(*v).dot(&d)).collect::<Vec<_>>()
        };
        let way = &heights(1).into_iter().max().unwrap() - &heights(0).into_iter().min().unwrap();
        let d = Vector::new(step.direction);
        let length = d.dot(&d);
        let [low, high] = step.travel.bounds().map(|t| &Dyadic::new(t) * &length);
        assert!(low <= way && way <= high, "{:?}", step.travel);
        assert!(step.travel.lower <= step.travel.value && step.travel.value <= step.travel.upper);
        assert!(
            (step.travel.value - 1.9).abs() < 1e-6 && step.travel.upper - step.travel.lower < 1e-12
        );
    }
}

/// A head stops at 7 for every tolerance. Both bounds of its nominal contact are tight, and the lower one is the safe
/// travel.
#[test]
fn safe_travel_is_the_lower_bound_of_the_nominal_contact() {
    let mut random = Random::new(4);
    for round in 0..60 {
        let tolerance = [0.0, 1e-5, 0.02, 0.1][round % 4];
        let world = if round < 8 { DAffine3::IDENTITY } else { pose(&mut random) };
        let bolt = [
            cuboid([-2.0, -2.0, 7.0], [2.0, 2.0, 8.0]),
            cuboid([-1.0, -1.0, 1.0], [1.0, 1.0, 7.5]),
        ];
        let parts = vec![
            turned("bolt", &bolt, world),
            turned("block", &well([-1.2, -1.2, -9.0], [1.2, 1.2, 0.0], 3.0), world),
        ];
        let assembly = Assembly::new(parts).unwrap();
        let bodies = Bodies::new(&assembly, Fit::Tolerance(tolerance)).unwrap();
        let down = -world.matrix3.z_axis.normalize();
        let found =
            travels_of_parts(&bodies, &[down], StartOverlap::Refuse, Watch::default()).unwrap();
        let PartTravel::Blocked { stop, .. } = found[0][0] else { panic!("{found:?}") };
        let [low, high] = stop.translation.bounds();
        assert!(low <= 7.0 + 1e-12 && low > 7.0 - 1e-9 && high >= 7.0 - 1e-12, "{stop:?}");
        // If rounding hides the contact of the nominal facets, the shrunk bodies meet beyond it.
        assert!(high < 7.0 + tolerance + 1e-9, "{stop:?}");
        assert_eq!(stop.distance(), low);
        assert!(low <= stop.shrunk_translation.lower);
        assert!((stop.shrunk_translation.value - 7.0 - tolerance).abs() < 1e-9);
    }
    // With a minimum gap, the safe travel is the lower bound of the expanded parts.
    let parts = vec![
        part("a", &[cuboid([0.0; 3], [1.0; 3])]),
        part("b", &[cuboid([0.0, 0.0, 4.0], [1.0, 1.0, 5.0])]),
    ];
    let assembly = Assembly::new(parts).unwrap();
    let bodies = Bodies::new(&assembly, Fit::MinGap(0.5)).unwrap();
    let found =
        travels_of_parts(&bodies, &[DVec3::Z], StartOverlap::Refuse, Watch::default()).unwrap();
    let PartTravel::Blocked { stop, .. } = found[0][0] else { panic!("{found:?}") };
    assert_eq!(
        (stop.distance(), stop.translation),
        (stop.shrunk_translation.lower, stop.shrunk_translation)
    );
    assert!((stop.distance() - 2.5).abs() < 1e-9);
}
