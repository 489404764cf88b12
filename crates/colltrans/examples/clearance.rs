//! Computes in which directions a drawer can move, how far, and to which position.
//!
//! `cargo run --release -p colltrans --example clearance`

use colltrans::glam::DVec3;
use colltrans::{Cast, Clearance, ConvexPolyhedron, FreeReason, Pose};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let drawer = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(4.0, 5.0, 2.0))?;
    // A floor directly below the drawer, and a wall behind it.
    let walls = [
        ("floor", DVec3::new(-9.0, -9.0, -1.0), DVec3::new(9.0, 9.0, 0.0)),
        ("wall", DVec3::new(-9.0, 7.0, -1.0), DVec3::new(9.0, 8.0, 9.0)),
    ];
    let world = Pose::IDENTITY;
    for (name, min, max) in walls {
        let wall = ConvexPolyhedron::cuboid(min, max)?;
        for direction in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_Z] {
            let cast = Cast::new(drawer.at(world), wall.at(world), direction)?;
            let answer = match cast.clearance()? {
                Clearance::Blocked { distance, contact } => {
                    let there = contact.pose_before(&cast)?.translation();
                    format!("blocked after {distance}, at {there}")
                }
                Clearance::Free(FreeReason::Slides(grazing)) => {
                    format!("slides, overlap {:e}", grazing.overlap)
                }
                Clearance::Free(FreeReason::Behind(_)) => "free, moves away".into(),
                Clearance::Free(FreeReason::Separated(separated)) => {
                    format!("free, passes by {}", separated.certificate.margin)
                }
                Clearance::Overlapping(_) => "overlaps now".into(),
            };
            println!("{name:<6} {direction}: {answer}");
        }
    }
    Ok(())
}
