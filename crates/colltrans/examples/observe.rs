//! Records the events of a query, and measures the time of its phases.
//!
//! `cargo run --release -p colltrans --example observe`

use colltrans::glam::DVec3;
use colltrans::observe::{Clock, Event, Recording};
use colltrans::{Cast, ConvexPolyhedron, Pose, Solver};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let gem = ConvexPolyhedron::from_points(&[
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        DVec3::new(-0.7, -0.8, -0.9),
        DVec3::new(0.5, -0.9, 0.3),
    ])?;
    let start = Pose::from_translation(DVec3::new(-5.0, 0.1, 0.1))?;
    let cast = Cast::new(gem.at(start), gem.at(Pose::IDENTITY), DVec3::X)?;
    let cast = cast.with_solver(Solver::Cta);

    let mut recording = Recording::default();
    let outcome = cast.first_contact_observed(&mut recording)?;
    println!("{:?}", outcome.steps());
    for event in recording.events() {
        match event {
            Event::Support(support) => {
                println!("support point {} along {}", support.at, support.normal);
            }
            Event::Portal(corners) => println!("portal {corners:?}"),
            Event::PlanarProblem(problem) => println!("planar problem {problem:?}"),
            Event::Cut(cut) => println!("cut {cut:?}"),
            _ => {}
        }
    }

    let mut clock = Clock::new();
    for _ in 0..1000 {
        cast.first_contact_observed(&mut clock)?;
    }
    for (phase, nanoseconds) in clock.profile().phase_times() {
        println!("{phase:<20} {:>6.0} ns", nanoseconds / 1000.0);
    }
    Ok(())
}
