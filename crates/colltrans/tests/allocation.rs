//! A query allocates nothing on the heap, whatever its outcome and however tied it is.

use colltrans::{Cast, Focus, Region, Solid, Solver, Tracker, Workspace};
use colltrans_testkit::oracle::sequences::Walk;
use colltrans_testkit::oracle::settings::{FAMILIES, setting};
use colltrans_testkit::oracle::solids::settings as solids;

#[test]
fn queries_allocate_nothing() {
    for (family, ..) in FAMILIES {
        for seed in 0..200 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("a body");
            for solver in [Solver::Portal, Solver::Cta] {
                let mut answer = None;
                let count = allocation_counter::measure(|| {
                    answer = Some(setting.cast(&bodies, solver));
                });
                assert!(answer.is_some_and(|a| a.is_ok()), "{family}:{seed} {solver:?}");
                assert_eq!(count.count_total, 0, "{family}:{seed} {solver:?}");
            }
        }
    }
}

#[test]
fn tracked_queries_allocate_nothing() {
    let foci = [
        Focus::default(),
        Focus { features: false, region: Region::Automatic },
        Focus { features: false, region: Region::Fixed(0.1) },
    ];
    for (family, ..) in FAMILIES {
        for seed in 0..4 {
            for (focus, solver) in foci.into_iter().zip([Solver::Auto, Solver::Cta, Solver::Cta]) {
                let mut walk = Walk::new(family, seed);
                let bodies = walk.setting.bodies().expect("a body");
                let tracker = Tracker::new();
                let mut tracker = tracker.with_focus(focus).expect("a focus");
                while walk.step < 40 {
                    let s = &walk.setting;
                    let mut answered = false;
                    let count = allocation_counter::measure(|| {
                        let Ok(cast) = s.query(&bodies) else { return };
                        let cast = cast.with_solver(solver);
                        answered = tracker.first_contact(&cast).is_ok()
                            && tracker.contact_range(&cast).is_ok()
                            && tracker.clearance(&cast).is_ok()
                            && tracker.directional_depth(&cast).is_ok()
                            && tracker.intersects(&cast).is_ok();
                    });
                    assert!(answered, "{walk} {solver:?}");
                    assert_eq!(count.count_total, 0, "{walk} {solver:?}");
                    walk.advance();
                }
            }
        }
    }
}

/// A query between solids allocates nothing once its queue has grown, shells inside each other
/// included; without a queue that is kept it allocates that queue and nothing else.
#[test]
fn queries_between_solids_allocate_their_queue_only() {
    for family in solids::FAMILIES {
        for seed in 0..100 {
            let setting = solids::Setting::draw(family, seed).expect("a family");
            let [a, b] = [0, 1].map(|k| {
                let (vertices, facets) = &setting.surfaces[k];
                Solid::from_mesh(vertices, facets).expect("a closed mesh")
            });
            let cast = Cast::new(a.at(setting.poses[0]), b.at(setting.poses[1]), setting.direction)
                .expect("a direction");
            let mut workspace = Workspace::default();
            let first = (cast.clearance_in(&mut workspace), cast.exit_in(&mut workspace));
            let mut again = None;
            let count = allocation_counter::measure(|| {
                again = Some((cast.clearance_in(&mut workspace), cast.exit_in(&mut workspace)));
            });
            assert_eq!(again, Some(first), "{family}:{seed}");
            assert_eq!(count.count_total, 0, "{family}:{seed}");
            let count = allocation_counter::measure(|| {
                assert!(cast.intersects() || !cast.overlaps());
            });
            assert_eq!(count.count_total, 0, "{family}:{seed}");
        }
    }
}
