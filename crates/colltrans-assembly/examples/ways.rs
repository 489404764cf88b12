//! Ways out in several moves: `ways SOURCE [tolerance] [legs]` prints the legs that take a first part or group out.

use std::time::Instant;

use colltrans::Pose;
use colltrans::ways::{WayOptions, WaysOut};
use colltrans_assembly::read::{ReadOptions, read};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let assembly = read(&arguments[0], &ReadOptions::default())?;
    let default = assembly.size() / f64::from(1 << 21);
    let tolerance = arguments.get(1).map_or(Ok(default), |text| text.parse())?;
    let legs = arguments.get(2).map_or(Ok(12), |text| text.parse())?;
    let parts = assembly.parts();
    let bodies: Vec<_> = parts.iter().map(|part| part.solid().at(Pose::IDENTITY)).collect();
    let options = WayOptions::default().with_tolerance(tolerance).with_legs(legs);
    let start = Instant::now();
    let found = WaysOut::among(&bodies, &[], &options, None)?;
    let seconds = start.elapsed().as_secs_f64();
    match found {
        WaysOut::Found(way) => {
            for leg in &way.legs {
                let names: Vec<&str> = leg.bodies.iter().map(|&k| parts[k].name()).collect();
                println!(
                    "{} along {:?}: {}",
                    names.join(" "),
                    leg.direction.to_array(),
                    leg.travel
                );
            }
            way.verify(&bodies)?;
            println!("{seconds:.4} s, {:?}", way.searched);
        }
        WaysOut::Proven(proof) => {
            proof.verify(&bodies[0], &bodies[1])?;
            println!("no way: {seconds:.4} s, proven in {} cells", proof.cells());
        }
        WaysOut::NotFound { searched } => println!("not found: {seconds:.4} s, {searched:?}"),
    }
    Ok(())
}
