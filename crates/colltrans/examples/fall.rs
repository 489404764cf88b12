//! How far does a tilted parcel fall, and what touches then? Its proof is checked.
//!
//! `cargo run --release -p colltrans --example fall`

use colltrans::glam::{DQuat, DVec3};
use colltrans::{Cast, ConvexPolyhedron, Outcome, Pose};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Bodies are built once and asked often, from any thread.
    let parcel = ConvexPolyhedron::cuboid(DVec3::splat(-0.5), DVec3::splat(0.5))?;
    let floor =
        ConvexPolyhedron::cuboid(DVec3::new(-50.0, -50.0, -1.0), DVec3::new(50.0, 50.0, 1.0))?;

    // The floor's top is at z = 1.
    let start = Pose::new(DQuat::from_rotation_x(0.3), DVec3::new(0.0, 0.0, 10.0))?;
    let cast = Cast::new(parcel.at(start), floor.at(Pose::IDENTITY), DVec3::NEG_Z)?;
    match cast.first_contact()? {
        Outcome::Contact(contact) => {
            let (features, points) = (contact.features(&cast), contact.points(&cast));
            println!("falls {}, touches at {}", contact.translation, points.on_fixed);
            println!("its {} on the floor's {}", features.moving.kind(), features.fixed.kind());
            let proof = contact.certificate;
            println!("proven: {} <= t <= {}", proof.lower, proof.upper);
            println!("checked: the gap is {:e}", cast.verify(&proof)?);
        }
        Outcome::Grazing(grazing) => println!("slides by; overlap {}", grazing.overlap),
        Outcome::Separated(separated) => println!("misses by {}", separated.certificate.margin),
    }
    Ok(())
}
