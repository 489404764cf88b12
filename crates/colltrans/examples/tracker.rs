//! Lowers a rod onto a block while it turns. Each query starts from the last answer.
//!
//! `cargo run --release -p colltrans --example tracker`

use colltrans::glam::{DQuat, DVec3};
use colltrans::{Cast, ConvexPolyhedron, Pose, StartedFrom, Tracker};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let half = DVec3::new(2.0, 0.1, 0.1);
    let rod = ConvexPolyhedron::cuboid(-half, half)?;
    let block = ConvexPolyhedron::cuboid(DVec3::NEG_ONE, DVec3::ONE)?;

    let mut tracker = Tracker::new();
    let (mut least, mut by_features) = (f64::INFINITY, 0);
    for step in 0..1000 {
        let turn = DQuat::from_rotation_z(0.002 * f64::from(step)) * DQuat::from_rotation_y(0.2);
        let pose = Pose::new(turn, DVec3::new(0.001 * f64::from(step), 0.3, 3.0))?;
        let cast = Cast::new(rod.at(pose), block.at(Pose::IDENTITY), DVec3::NEG_Z)?;
        if let Some(distance) = tracker.clearance(&cast)?.distance() {
            least = least.min(distance);
        }
        by_features += usize::from(tracker.steps().started_from == StartedFrom::Features);
    }
    println!("at least {least:.6} of room");
    println!("{by_features} of 1000 answers came from the last contact's features");
    Ok(())
}
