//! Writes a query to a file and reads it back, exact in bits.
//!
//! `cargo run --release -p colltrans --features json --example save_and_replay`

use colltrans::glam::{DQuat, DVec3};
use colltrans::{Case, Cast, ConvexPolyhedron, Pose};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    let start = Pose::new(DQuat::from_rotation_x(0.3), DVec3::new(-3.1, 0.3, 0.1))?;
    let cast = Cast::new(cube.at(start), cube.at(Pose::IDENTITY), DVec3::X)?;

    let saved = cast.to_json();
    println!("{saved}");
    // The command line answers the same file: colltrans replay CASE.json
    let case = Case::from_json(&saved)?;
    assert_eq!(case.cast()?.first_contact()?, cast.first_contact()?);
    println!("the same bits");
    Ok(())
}
