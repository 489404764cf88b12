//! V-Clip against the exact distance.

mod walks;

use colltrans_yardsticks::Proximity;
use colltrans_yardsticks::vclip::{Shell, Steps, VClip};
use walks::{Placed, hard_settings, random_settings};

fn from_scratch(placed: &Placed) -> Proximity<Steps> {
    let (moving, fixed) = (Shell::new(&placed.moving).unwrap(), Shell::new(&placed.fixed).unwrap());
    VClip::new(&moving, &fixed).distance(&placed.moving_pose, &placed.fixed_pose)
}

fn report(settings: impl Iterator<Item = Placed>) {
    let mut worst = (0.0, String::new());
    let mut count = 0;
    for placed in settings {
        count += 1;
        let answer = from_scratch(&placed);
        let error = placed.error(answer.distance).max(placed.error_of_points(
            answer.distance,
            answer.on_moving,
            answer.on_fixed,
        ));
        if error > 1e-14 || answer.steps.gave_up || answer.steps.restarts > 0 {
            println!("{}: error {error:e} {answer:?}", placed.name);
        }
        if error > worst.0 {
            worst = (error, placed.name.clone());
        }
    }
    println!("{count} worst {worst:?}");
}

#[test]
fn random() {
    report(random_settings(2000));
}
#[test]
fn hard() {
    report(hard_settings(400));
}
#[test]
fn dbg() {
    let p = hard_settings(400)
        .find(|p| p.name.starts_with(&std::env::var("CASE").unwrap_or("nearly:351".into())[..]))
        .unwrap();
    println!("{:?} {:?}", p.moving.vertices(), p.fixed.vertices());
    println!("{:?}\n{:?}", p.moving_pose, p.fixed_pose);
    println!("{:?}", from_scratch(&p));
}
