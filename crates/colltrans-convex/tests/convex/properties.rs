//! Properties that hold for every setting, random or tied.

use std::thread;

use colltrans_convex::{
    Clearance, ConvexPolyhedron, FreeReason, Outcome, OverlapAhead, Pose, QueryError, Solver,
};
use colltrans_testkit::cases;
use colltrans_testkit::oracle::scene::Scene;
use colltrans_testkit::oracle::settings::{Bodies, FAMILIES, Setting, setting};
use colltrans_testkit::oracle::shadow::sideways_overlap;
use colltrans_testkit::oracle::simplex::collision_translation;
use colltrans_testkit::random::Random;
use glam::DVec3;
use proptest::prelude::*;

/// Any setting of any family.
fn any_setting() -> impl Strategy<Value = Setting> {
    (0..FAMILIES.len(), any::<u32>())
        .prop_map(|(family, seed)| setting(FAMILIES[family].0, seed.into()))
}

fn scene(setting: &Setting, bodies: &Bodies) -> Scene {
    setting.judge(bodies).scene
}

/// Translation and tolerance, if the bodies meet.
fn value(outcome: &Outcome) -> Option<(f64, f64)> {
    match outcome {
        Outcome::Contact(contact) => Some((contact.translation, contact.certificate.rounding)),
        Outcome::Grazing(_) | Outcome::Separated(_) => None,
    }
}

/// Two answers to what is, up to rounding, the same question.
fn agree(a: &Outcome, b: &Outcome, scene: &Scene, graze_tolerance: f64) -> Result<(), String> {
    if let (Some((s, e)), Some((t, f))) = (value(a), value(b)) {
        let error = (s - t).abs();
        return if error <= e + f {
            Ok(())
        } else {
            Err(format!("{s:e} and {t:e}: {error:e} apart"))
        };
    }
    if std::mem::discriminant(a) == std::mem::discriminant(b) {
        return Ok(());
    }
    // Different kinds only where rounding decides: at the graze tolerance, or at zero overlap.
    let overlap = sideways_overlap(scene).to_f64();
    let band = 4.0 * scene.noise;
    let border = graze_tolerance.max(scene.touching);
    if overlap.abs() <= band + scene.noise || (overlap - border).abs() <= band {
        Ok(())
    } else {
        Err(format!("{a:?} and {b:?}, overlap {overlap:e}"))
    }
}

fn turned_around(setting: &Setting) -> Setting {
    Setting {
        moving: setting.fixed.clone(),
        fixed: setting.moving.clone(),
        moving_pose: setting.fixed_pose,
        fixed_pose: setting.moving_pose,
        direction: -setting.direction,
        ..setting.clone()
    }
}

/// The whole scene moved; its numbers are rounded anew.
fn moved(setting: &Setting, by: &Pose) -> Setting {
    Setting {
        moving_pose: by.compose(&setting.moving_pose).expect("in range"),
        fixed_pose: by.compose(&setting.fixed_pose).expect("in range"),
        direction: by.transform_vector(setting.direction),
        ..setting.clone()
    }
}

fn advanced(setting: &Setting, translation: f64) -> Pose {
    setting.moving_pose.translated_by(setting.direction * translation).expect("in range")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(512), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn both_solvers_agree(setting in any_setting()) {
        let bodies = setting.bodies().unwrap();
        let cta = setting.cast(&bodies, Solver::Cta).unwrap();
        let portal = setting.cast(&bodies, Solver::Portal).unwrap();
        let verdict = agree(&cta, &portal, &scene(&setting, &bodies), setting.graze_tolerance);
        prop_assert!(verdict.is_ok(), "{setting}: {verdict:?}");
    }

    #[test]
    fn the_other_body_moves_back(setting in any_setting()) {
        let bodies = setting.bodies().unwrap();
        let there = setting.cast(&bodies, Solver::Auto).unwrap();
        let other = turned_around(&setting);
        let back = other.cast(&other.bodies().unwrap(), Solver::Auto).unwrap();
        let verdict = agree(&there, &back, &scene(&setting, &bodies), setting.graze_tolerance);
        prop_assert!(verdict.is_ok(), "{setting}: {verdict:?}");
    }

    #[test]
    fn a_rigid_motion_changes_nothing(setting in any_setting(), seed in any::<u64>()) {
        let bodies = setting.bodies().unwrap();
        let mut rng = Random::new(seed);
        let by = Pose::new(rng.rotation(), rng.vector() * 10.0).unwrap();
        let other = moved(&setting, &by);
        let (a, b) = (scene(&setting, &bodies), scene(&other, &bodies));
        // The poses are rounded at the size of the world coordinates; lateral shifts of that size
        // move the value by as much as the contact is inclined.
        let far = setting.moving_pose.translation().length() + setting.fixed_pose.translation().length();
        let rounding = 64.0 * f64::EPSILON * (a.size + far + 20.0);
        let here = setting.cast(&bodies, Solver::Auto).unwrap();
        let there = other.cast(&bodies, Solver::Auto).unwrap();
        match (here, there) {
            (Outcome::Contact(s), Outcome::Contact(t)) => {
                let along = s.normal.dot(setting.direction).min(t.normal.dot(other.direction));
                let error = (s.translation - t.translation).abs();
                // A tie at an edge of the shadow may fall to the face beyond the edge.
                let jump = sideways_overlap(&a).to_f64() <= rounding;
                let tolerance = s.certificate.rounding + t.certificate.rounding + rounding / along;
                prop_assert!(jump || error <= tolerance, "{setting}: {error:e} > {tolerance:e}");
            }
            (s, t) if std::mem::discriminant(&s) == std::mem::discriminant(&t) => {}
            (s, t) => {
                let overlaps = [sideways_overlap(&a).to_f64(), sideways_overlap(&b).to_f64()];
                let border = setting.graze_tolerance.max(a.touching);
                let near = |o: f64| o.abs() <= border + rounding || (o - border).abs() <= rounding;
                prop_assert!(overlaps.into_iter().all(near), "{setting}: {s:?} {t:?} {overlaps:?}");
            }
        }
    }

    #[test]
    fn a_little_less_does_not_touch_and_a_little_more_overlaps(setting in any_setting()) {
        let bodies = setting.bodies().unwrap();
        let Outcome::Contact(found) = setting.cast(&bodies, Solver::Auto).unwrap() else { return Ok(()) };
        let back = Setting { direction: -setting.direction, ..setting.clone() };
        let exit = collision_translation(&scene(&back, &bodies)).map(|t| -t.to_f64());
        let Some(exit) = exit else { return Ok(()) };
        let step = 1e-3 * found.translation.abs();
        let (before, after) = (found.translation - step, found.translation + step);
        // The poses below are rounded, and a tie can depend on that.
        let size = scene(&setting, &bodies).size + setting.direction.length() * found.translation.abs()
            + setting.moving_pose.translation().length();
        let rounding = 64.0 * f64::EPSILON * size / found.normal.dot(setting.direction);
        prop_assume!(step > 4.0 * (found.certificate.rounding + rounding));
        let at = |t: f64| {
            let there = Setting { moving_pose: advanced(&setting, t), ..setting.clone() };
            there.query(&bodies).and_then(|cast| cast.intersects())
        };
        // A plane keeps them apart by so much, and it is as far along the line through the centres. Bodies
        // that are hardly thicker than rounding may meet there within rounding.
        let gap = step * found.normal.dot(setting.direction);
        let there = at(before).unwrap();
        let explained = value(&there.evidence.outcome).is_some_and(|(_, rounding)| rounding >= gap);
        prop_assert!(!there.meets || explained, "{}: before", &setting);
        if after < exit - step {
            prop_assert!(at(after).unwrap().meets, "{}: after", &setting);
        }
    }

    #[test]
    fn clearance_is_what_the_exact_range_says(setting in any_setting()) {
        let bodies = setting.bodies().unwrap();
        let found = setting.query(&bodies).unwrap().clearance().unwrap();
        let here = scene(&setting, &bodies);
        let border = setting.graze_tolerance.max(here.touching);
        let overlap = sideways_overlap(&here).to_f64();
        if overlap <= border + 4.0 * here.noise {
            // Grazing does not block; at its border either answer is right.
            prop_assert!(overlap > border - 4.0 * here.noise || found.is_free(), "{setting}");
            return Ok(());
        }
        let back = Setting { direction: -setting.direction, ..setting.clone() };
        let first = collision_translation(&here).unwrap().to_f64();
        let last = -collision_translation(&scene(&back, &bodies)).unwrap().to_f64();
        let answer = setting.cast(&bodies, Solver::Auto).unwrap();
        let (_, mut tolerance) = value(&answer).expect("contact");
        let back_answer = back.cast(&bodies, Solver::Auto).unwrap();
        tolerance += value(&back_answer).expect("contact").1;
        match found {
            Clearance::Blocked { distance, contact } => {
                prop_assert!(first >= -tolerance, "{setting}: blocked, range {first}..{last}");
                prop_assert!(distance <= first.max(0.0), "{setting}: {distance:e} of {first:e}");
                prop_assert!(first.max(0.0) - distance <= tolerance, "{setting}");
                prop_assert!(distance >= 0.0 && contact.normal.dot(setting.direction) > 0.0);
            }
            Clearance::Overlapping(OverlapAhead { first: enter, last: exit }) => {
                let range = [enter.translation, -exit.translation];
                prop_assert!(first < 0.0 && last > -tolerance, "{setting}: range {first}..{last}");
                prop_assert!((range[0] - first).abs() <= tolerance, "{setting}");
                prop_assert!((range[1] - last).abs() <= tolerance, "{setting}");
            }
            Clearance::Free(FreeReason::Behind(_)) => {
                prop_assert!(last <= tolerance, "{setting}: range {first}..{last}");
            }
            free @ Clearance::Free(_) => prop_assert!(false, "{setting}: {free:?}, range {first}..{last}"),
        }
    }

    #[test]
    fn the_length_of_the_direction_is_the_unit(setting in any_setting(), exponent in -20_i32..20) {
        let bodies = setting.bodies().unwrap();
        let factor = 2.0_f64.powi(exponent);
        let scaled = Setting { direction: setting.direction * factor, ..setting.clone() };
        let (a, b) = (setting.cast(&bodies, Solver::Auto).unwrap(), scaled.cast(&bodies, Solver::Auto).unwrap());
        match (value(&a), value(&b)) {
            (Some((s, e)), Some((t, _))) => prop_assert!((s - t * factor).abs() <= e, "{setting}"),
            (None, None) => {}
            _ => prop_assert!(false, "{setting}: {a:?} {b:?}"),
        }
    }

    #[test]
    fn the_same_bits_every_time(setting in any_setting()) {
        let once = |setting: &Setting| -> Vec<Result<Outcome, QueryError>> {
            let bodies = setting.bodies().unwrap();
            [Solver::Cta, Solver::Portal, Solver::Auto].map(|s| setting.cast(&bodies, s)).to_vec()
        };
        // Debug prints a number so that it reads back as the same bits.
        let expected = format!("{:?}", once(&setting));
        prop_assert_eq!(&expected, &format!("{:?}", once(&setting)));
        let threads: Vec<_> = (0..4).map(|_| {
            let setting = setting.clone();
            thread::spawn(move || format!("{:?}", once(&setting)))
        }).collect();
        for thread in threads {
            prop_assert_eq!(&expected, &thread.join().unwrap());
        }
    }
}

/// One body shared by many threads gives each the same bits.
#[test]
fn bodies_are_shared_between_threads() {
    let settings: Vec<Setting> = (0..64).map(|seed| setting("random", seed)).collect();
    let bodies: Vec<Bodies> = settings.iter().map(|s| s.bodies().unwrap()).collect();
    let all = || -> String {
        let casts = settings.iter().zip(&bodies).map(|(s, b)| s.cast(b, Solver::Auto));
        format!("{:?}", casts.collect::<Vec<_>>())
    };
    let expected = all();
    thread::scope(|scope| {
        let threads: Vec<_> = (0..8).map(|_| scope.spawn(all)).collect();
        for thread in threads {
            assert_eq!(expected, thread.join().unwrap());
        }
    });
}

/// The library's own check accepts what the exact one accepts.
#[test]
fn verify_accepts_every_answer_and_no_other_body() {
    let mut refused = 0;
    for seed in 0..500 {
        let setting = setting("random", seed);
        let bodies = setting.bodies().unwrap();
        let bigger = |body: &ConvexPolyhedron| {
            let points: Vec<DVec3> = body.vertices().iter().map(|v| *v * 1.01).collect();
            ConvexPolyhedron::from_points(&points).unwrap()
        };
        let outcome = setting.cast(&bodies, Solver::Auto).unwrap();
        let verify = |bodies: &Bodies| {
            let cast = setting.query(bodies).unwrap();
            match &outcome {
                Outcome::Contact(c) => cast.verify(&c.certificate),
                Outcome::Grazing(g) => cast.verify(&g.contact.certificate),
                Outcome::Separated(s) => cast.verify(&s.certificate),
            }
        };
        verify(&bodies).unwrap();
        let others = Bodies { moving: bigger(&bodies.moving), fixed: bigger(&bodies.fixed) };
        refused += u32::from(verify(&others).is_err());
    }
    assert!(refused >= 300, "only {refused} of 500 certificates were refused for other bodies");
}
