//! Drops a tilted box onto a floor, and verifies the proof of the answer.
//!
//! `cargo run --release -p colltrans --example fall`

use colltrans::glam::{DQuat, DVec3};
use colltrans::{Cast, ConvexPolyhedron, Outcome, Pose};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let parcel = ConvexPolyhedron::cuboid(DVec3::splat(-0.5), DVec3::splat(0.5))?;
    let floor =
        ConvexPolyhedron::cuboid(DVec3::new(-50.0, -50.0, -1.0), DVec3::new(50.0, 50.0, 1.0))?;
    let start = Pose::new(DQuat::from_rotation_x(0.3), DVec3::new(0.0, 0.0, 10.0))?;

    let cast = Cast::new(parcel.at(start), floor.at(Pose::IDENTITY), DVec3::NEG_Z)?;
    match cast.first_contact()? {
        Outcome::Contact(contact) => {
            let proof = contact.certificate;
            println!("falls {}, normal {}", contact.translation, contact.normal);
            println!("proven: {} <= t <= {}", proof.lower, proof.upper);
            println!("verified, with a gap of {:e}", cast.verify(&proof)?);
        }
        Outcome::Grazing(grazing) => println!("slides past, overlap {}", grazing.overlap),
        Outcome::Separated(separated) => println!("misses by {}", separated.certificate.margin),
    }
    Ok(())
}
