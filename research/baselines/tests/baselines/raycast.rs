//! The GJK ray cast against the exact collision translation, and large bodies against `colltrans`.
//!
//! An answer is correct if it is what the published algorithm promises for its tolerance `e` (a length). A hit is not
//! later than the collision, and earlier by at most `e / n . d`. A miss must be a miss. A contact at the start must
//! be within `e`. In *clear* settings every answer must be correct. Other settings are within `2 e` of a different
//! outcome, or nearly parallel to the contact plane; their results are counted and printed.

use colltrans::{Cast, ConvexPolyhedron, Feature, Outcome, Pose, Solver};
use colltrans_baselines::raycast::{Options, RayCast, RayCastAnswer};
use colltrans_testkit::oracle::distance::{distance_of_bodies, distance_of_point};
use colltrans_testkit::oracle::exact::Ratio;
use colltrans_testkit::oracle::settings::{Bodies, FAMILIES, Setting, setting};
use colltrans_testkit::oracle::shadow::sideways_overlap;
use colltrans_testkit::oracle::simplex::collision_translation;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{cuboid, ring_sphere};
use glam::{DQuat, DVec3};
use std::collections::BTreeMap;

/// How an answer compares with the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Verdict {
    Right,
    Early,
    Late,
    HitOfNothing,
    MissOfSomething,
    ContactOfNothing,
    Exhausted,
}

struct Truth {
    /// The collision translation, if the bodies meet ahead; 0 if they do now.
    ahead: Option<f64>,
    /// Their distance now.
    start: f64,
    /// How far their shadows overlap.
    overlap: f64,
    /// `n . d` of the contact.
    along: f64,
    size: f64,
}

impl Truth {
    fn of(setting: &Setting, bodies: &Bodies) -> Self {
        let scene = setting.judge(bodies).scene;
        let moving = (&bodies.moving, &setting.moving_pose);
        let start = distance_of_bodies(moving, (&bodies.fixed, &setting.fixed_pose));
        let ahead = collision_translation(&scene).filter(|t| *t >= Ratio::from_f64(0.0));
        let along = match setting.cast(bodies, Solver::Auto).unwrap() {
            Outcome::Contact(contact) => contact.normal.dot(setting.direction),
            Outcome::Grazing(grazing) => grazing.contact.normal.dot(setting.direction),
            Outcome::Separated(_) => setting.direction.length(),
        };
        Self {
            ahead: if start.intersects() { Some(0.0) } else { ahead.map(|t| t.to_f64()) },
            start: start.to_f64(),
            overlap: sideways_overlap(&scene).to_f64(),
            along,
            size: scene.size,
        }
    }

    /// Checks whether the setting is at least two tolerances from every other outcome, and not nearly parallel to the
    /// contact plane.
    fn is_clear(&self, tolerance: f64, direction: DVec3) -> bool {
        let near = 2.0 * tolerance * self.size;
        let start_is_clear = self.start == 0.0 || self.start > near;
        self.overlap.abs() > near && start_is_clear && self.along > 0.01 * direction.length()
    }

    fn judge(&self, answer: &RayCastAnswer, tolerance: f64) -> Verdict {
        let noise = 64.0 * f64::EPSILON * self.size;
        let near = tolerance * self.size + noise;
        match (*answer, self.ahead) {
            (RayCastAnswer::InContact { .. }, _) if self.start > near => Verdict::ContactOfNothing,
            (RayCastAnswer::Exhausted { .. }, _) => Verdict::Exhausted,
            (RayCastAnswer::Hit { .. }, None) => Verdict::HitOfNothing,
            (RayCastAnswer::Miss { .. }, Some(_)) => Verdict::MissOfSomething,
            (RayCastAnswer::Hit { translation, .. }, Some(t)) => {
                if translation > t + noise / self.along {
                    Verdict::Late
                } else if translation < t - near / self.along {
                    Verdict::Early
                } else {
                    Verdict::Right
                }
            }
            _ => Verdict::Right,
        }
    }
}

#[test]
fn answers_of_all_families_keep_tolerance() {
    let mut unclear: BTreeMap<(&str, Verdict), u32> = BTreeMap::new();
    let (mut clear, mut right) = (0, 0);
    for (family, _) in FAMILIES {
        for seed in 0..60 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().unwrap();
            let truth = Truth::of(&setting, &bodies);
            for tolerance in [1e-4, Options::default().tolerance, 1e-9] {
                let options = Options { tolerance, ..Options::default() };
                let answer = RayCast::with_options(&bodies.moving, &bodies.fixed, options).cast(
                    &setting.moving_pose,
                    &setting.fixed_pose,
                    setting.direction,
                );
                let verdict = truth.judge(&answer, tolerance);
                check_point(&setting, &bodies, &answer);
                if truth.is_clear(tolerance, setting.direction) {
                    clear += 1;
                    assert_eq!(verdict, Verdict::Right, "{setting}, {tolerance:e}: {answer:?}");
                } else if verdict == Verdict::Right {
                    right += 1;
                } else {
                    *unclear.entry((family, verdict)).or_default() += 1;
                }
            }
        }
    }
    println!("clear: {clear}, all right; others: {right} right and {unclear:?}");
    assert!(clear > 3000, "{clear}");
}

/// Asserts that the contact point belongs to the fixed body.
fn check_point(setting: &Setting, bodies: &Bodies, answer: &RayCastAnswer) {
    if let RayCastAnswer::Hit { on_fixed, .. } | RayCastAnswer::InContact { on_fixed, .. } = *answer
    {
        let off = distance_of_point(on_fixed, (&bodies.fixed, &setting.fixed_pose)).to_f64();
        let size = setting.judge(bodies).scene.size + on_fixed.length();
        assert!(off <= 16.0 * f64::EPSILON * size, "{setting}: {off:e} off the fixed body");
    }
}

/// Returns an ellipsoid with vertices in rings.
fn rings(count: u32, semi_axes: DVec3) -> ConvexPolyhedron {
    let points = ring_sphere(count, count).mapped(|v| v * semi_axes).vertices;
    ConvexPolyhedron::from_points(&points).unwrap()
}

/// Compares with certified answers. The normal is only printed: it is that of the last plane of the ray cast, not
/// that of the face in contact.
#[test]
fn large_bodies() {
    let mut rng = Random::new(1);
    let tolerance = Options::default().tolerance;
    let (mut hits, mut misses, mut exhausted) = (0, 0, 0);
    let mut worst_normal_rad: f64 = 0.0;
    for axes in [DVec3::new(1.2, 0.7, 1.0), DVec3::new(1e-3, 1e-3, 1.0), DVec3::new(1.0, 1.0, 1e-3)]
    {
        let (p, q) = (rings(45, axes), rings(45, axes));
        let mut ray_cast = RayCast::new(&p, &q);
        for case in 0..60 {
            let at = Pose::new(rng.rotation(), rng.direction() * 4.0).unwrap();
            let world = Pose::new(rng.rotation(), DVec3::ZERO).unwrap();
            let direction = -at.translation().normalize() + rng.vector() * 0.3;
            let size = 2.4 + 4.0;
            let name = format!("{axes}, case {case}");
            let question = Cast::new(p.at(at), q.at(world), direction).unwrap();
            let truth = question.first_contact().unwrap();
            match (ray_cast.cast(&at, &world, direction), truth) {
                (RayCastAnswer::Hit { translation, normal, .. }, Outcome::Contact(contact)) => {
                    let along = contact.normal.dot(direction);
                    let early = (contact.translation - translation) * along;
                    assert!((-1e-13..=tolerance * size).contains(&early), "{name}: {early:e}");
                    let features = contact.features(&question);
                    let faces = [features.moving, features.fixed];
                    if faces.iter().any(|f| matches!(f, Feature::Face(_))) {
                        let off_rad = normal.cross(contact.normal).length().asin();
                        worst_normal_rad = worst_normal_rad.max(off_rad);
                    }
                    hits += 1;
                }
                (RayCastAnswer::Miss { .. }, Outcome::Separated(_)) => misses += 1,
                (RayCastAnswer::Exhausted { lower_bound, .. }, Outcome::Contact(contact)) => {
                    assert!(lower_bound <= contact.translation + 1e-12, "{name}: {lower_bound}");
                    exhausted += 1;
                }
                (RayCastAnswer::Exhausted { .. }, _) => exhausted += 1,
                (answer, truth) => panic!("{name}: {answer:?}, {truth:?}"),
            }
        }
    }
    println!("{hits} hits, {misses} misses, {exhausted} exhausted");
    println!("normals of faces: off by up to {worst_normal_rad:.2e} rad");
    assert!(hits > 60 && misses > 20, "{hits} {misses}");
}

fn boxes() -> [ConvexPolyhedron; 2] {
    [0.5, 1.0]
        .map(|half| ConvexPolyhedron::from_points(&cuboid(DVec3::splat(half)).vertices).unwrap())
}

#[test]
fn each_case_has_its_answer() {
    let [p, q] = boxes();
    let mut ray_cast = RayCast::new(&p, &q);
    let mut cast = |x: f64, direction: DVec3| {
        let at = Pose::from_translation(DVec3::new(x, 0.25, 0.125)).unwrap();
        ray_cast.cast(&at, &Pose::IDENTITY, direction)
    };
    let RayCastAnswer::Hit { translation, normal, on_fixed, .. } = cast(-5.0, DVec3::X * 2.0)
    else {
        panic!("a box in the way")
    };
    assert!((translation - 1.75).abs() <= 1e-5 && on_fixed.x == -1.0);
    assert!(normal.distance(DVec3::X) <= 4.0 * f64::EPSILON);
    assert!(matches!(cast(-5.0, DVec3::NEG_X), RayCastAnswer::Miss { .. }));
    assert!(matches!(cast(-5.0, DVec3::Y), RayCastAnswer::Miss { .. }));
    assert!(matches!(cast(-1.25, DVec3::X), RayCastAnswer::InContact { .. }));
    // Face on face, and on the way out: published, but not what one would like.
    assert!(matches!(cast(-1.5, DVec3::NEG_X), RayCastAnswer::InContact { .. }));
}

#[test]
fn exhausted_iterations_are_not_a_hit() {
    let (p, q) = (rings(20, DVec3::ONE), rings(20, DVec3::new(1.0, 0.7, 1.3)));
    let turn = DQuat::from_rotation_x(0.4);
    let at = Pose::new(turn, DVec3::new(-5.0, 0.3, 0.2)).unwrap();
    let truth = colltrans::cast(&p, &at, &q, &Pose::IDENTITY, DVec3::X).unwrap();
    let Outcome::Contact(contact) = truth else { panic!("in the way") };
    let mut last = -1.0;
    for max_iterations in 0..64 {
        let options = Options { max_iterations, ..Options::default() };
        match RayCast::with_options(&p, &q, options).cast(&at, &Pose::IDENTITY, DVec3::X) {
            RayCastAnswer::Exhausted { lower_bound, steps } => {
                assert_eq!(steps.iterations, max_iterations);
                // Translations are estimates; what no lower bound may pass is what is proven.
                assert!(lower_bound >= last && lower_bound <= contact.certificate.upper);
                last = lower_bound;
            }
            RayCastAnswer::Hit { translation, steps, .. } => {
                assert!(translation >= last && steps.iterations <= max_iterations);
                assert!(max_iterations > 2, "too good to be true");
                return;
            }
            answer => panic!("{answer:?}"),
        }
    }
    panic!("never hit");
}

/// The remembered state may save climbing, but not change the answer by more than the tolerance.
#[test]
fn coherence_does_not_change_answers() {
    let (p, q) = (rings(20, DVec3::ONE), rings(20, DVec3::new(1.0, 0.7, 1.3)));
    let mut rng = Random::new(3);
    let mut coherent = RayCast::new(&p, &q);
    for _ in 0..50 {
        let at = Pose::new(rng.rotation(), DVec3::new(-5.0, rng.unit(), rng.unit())).unwrap();
        let translations = [false, true].map(|scratch| {
            if scratch {
                coherent.reset();
            }
            match coherent.cast(&at, &Pose::IDENTITY, DVec3::X) {
                RayCastAnswer::Hit { translation, .. } => translation,
                answer => panic!("{answer:?}"),
            }
        });
        // The tolerance over the sine of an angle that is steep here.
        assert!((translations[0] - translations[1]).abs() <= 1e-6 * 8.0 * 4.0);
    }
}
