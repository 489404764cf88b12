//! V-Clip against the exact distance.

mod walks;

use colltrans_oracle::settings::Rng;
use colltrans_yardsticks::vclip::{Shell, VClip};
use walks::{ACCURACY, Placed, coherent, hard_settings, random_settings, worst_of};

fn solver_error(placed: &Placed) -> f64 {
    let (moving, fixed) = (Shell::new(&placed.moving).unwrap(), Shell::new(&placed.fixed).unwrap());
    let answer = VClip::new(&moving, &fixed).distance(&placed.moving_pose, &placed.fixed_pose);
    placed.verdict(answer.distance, answer.on_moving, answer.on_fixed, answer.steps.gave_up)
}

#[test]
fn random_solids() {
    let (worst, name) = worst_of(random_settings(2_000), solver_error);
    assert!(worst <= ACCURACY, "{name}: {worst:e}");
}

#[test]
fn tied_solids() {
    let (worst, name) = worst_of(hard_settings(150), solver_error);
    assert!(worst <= ACCURACY, "{name}: {worst:e}");
}

#[test]
fn a_coherent_query_is_the_same_and_cheaper() {
    let mut rng = Rng::new(5);
    let (mut warm, mut cold) = (0, 0);
    for placed in random_settings(60).filter(Placed::is_apart) {
        let shells = [&placed.moving, &placed.fixed].map(|body| Shell::new(body).unwrap());
        let mut solver = VClip::new(&shells[0], &shells[1]);
        for (step, at) in coherent(&placed, 2.5e-3, 40, &mut rng).iter().enumerate() {
            let tracked = solver.distance(&at.moving_pose, &at.fixed_pose);
            let fresh =
                VClip::new(&shells[0], &shells[1]).distance(&at.moving_pose, &at.fixed_pose);
            let difference = (tracked.distance - fresh.distance).abs() / at.size();
            assert!(difference <= ACCURACY, "{}: {difference:e}", at.name);
            if step > 0 {
                warm += tracked.steps.pairs;
                cold += fresh.steps.pairs;
            }
        }
    }
    assert!(2 * warm < cold, "{warm} pairs of features tracked, {cold} from scratch");
}
