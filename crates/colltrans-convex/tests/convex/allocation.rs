//! A query allocates nothing on the heap, whatever its outcome and however tied it is. What the paper's
//! algorithm makes of a body, it makes once.

use colltrans_convex::{Focus, Solver, Tracker, cta};
use colltrans_testkit::oracle::sequences::Walk;
use colltrans_testkit::oracle::settings::{Bodies, FAMILIES, Setting, setting};

#[test]
fn queries_allocate_nothing() {
    for (family, ..) in FAMILIES {
        for seed in 0..200 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("a body");
            for solver in [Solver::Portal, Solver::Cta] {
                if solver == Solver::Cta {
                    prepare(&bodies);
                }
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

/// Bodies take nothing for sections until a cast with the paper's algorithm, one-off or tracked, makes
/// them; the next finds them, in a clone too, and answers the same.
#[test]
fn sections_are_made_by_the_first_cast_that_needs_them() {
    let narrowed = |setting: &Setting| {
        let outcome = setting.cast(&setting.bodies().expect("a body"), Solver::Cta);
        outcome.expect("an answer").steps().planar_problems > 0
    };
    let setting =
        (0..100).map(|seed| setting("random", seed)).find(narrowed).expect("one to narrow");
    let bodies = setting.bodies().expect("a body");
    let built = bytes(&bodies);
    setting.cast(&bodies, Solver::Portal).expect("an answer");
    assert_eq!(bytes(&bodies), built, "portal refinement does without");
    let tracked = bodies.clone();
    let cast = |bodies: &Bodies| {
        let mut answer = None;
        let count = allocation_counter::measure(|| answer = setting.cast(bodies, Solver::Cta).ok());
        (answer.expect("an answer"), count.count_total)
    };
    let [first, again, of_clone] = [cast(&bodies), cast(&bodies), cast(&bodies.clone())];
    assert!(first.1 > 0 && (again.1, of_clone.1) == (0, 0), "{first:?} {again:?} {of_clone:?}");
    assert!(first.0 == again.0 && first.0 == of_clone.0);
    let made = bytes(&bodies);
    assert!(built[0] < made[0] && built[1] < made[1], "{built:?} {made:?}");

    let before = bytes(&tracked);
    let query = setting.query(&tracked).expect("a query").with_solver(Solver::Cta);
    Tracker::new().first_contact(&query).expect("an answer");
    let after = bytes(&tracked);
    assert!(before[0] < after[0] && before[1] < after[1], "{before:?} {after:?}");
}

fn prepare(Bodies { moving, fixed }: &Bodies) {
    moving.prepare_sections();
    fixed.prepare_sections();
}

fn bytes(Bodies { moving, fixed }: &Bodies) -> [usize; 2] {
    [moving.memory_bytes(), fixed.memory_bytes()]
}

#[test]
fn tracked_queries_allocate_nothing() {
    let foci = [
        Focus::default(),
        Focus::NONE.with_region(cta::Region::Automatic),
        Focus::NONE.with_region(cta::Region::Fixed(0.1)),
    ];
    for (family, ..) in FAMILIES {
        for seed in 0..4 {
            for (focus, solver) in foci.into_iter().zip([Solver::Auto, Solver::Cta, Solver::Cta]) {
                let mut walk = Walk::new(family, seed);
                let bodies = walk.setting.bodies().expect("a body");
                prepare(&bodies);
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
