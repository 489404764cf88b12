//! Ways out in several moves: `ways SOURCE [tolerance] [legs] [axes]` prints the legs that take a first part or group out.
//! With more axes than the parts' large facets have, up to 13 in all, those of a cube's edges and diagonals are tried.

use std::time::Instant;

use colltrans::Pose;
use colltrans::glam::DVec3;
use colltrans::ways::{WayOptions, WaysOut, of_large_facets};
use colltrans_assembly_io::read::{ReadOptions, read};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let assembly = read(&arguments[0], &ReadOptions::default())?;
    let default = assembly.size() / f64::from(1 << 21);
    let tolerance = arguments.get(1).map_or(Ok(default), |text| text.parse())?;
    let legs = arguments.get(2).map_or(Ok(12), |text| text.parse())?;
    let parts = assembly.parts();
    let bodies: Vec<_> = parts.iter().map(|part| part.solid().at(Pose::IDENTITY)).collect();
    let axes = arguments.get(3).map_or(Ok(0), |text| text.parse::<usize>())?;
    let mut options = WayOptions::default().with_tolerance(tolerance).with_legs(legs);
    if axes > 0 {
        let own = of_large_facets(&bodies);
        let more =
            of_a_cube().into_iter().filter(|d| own.iter().all(|a| a.cross(*d).length() > 1e-6));
        options = options.with_directions(own.iter().copied().chain(more).take(axes).collect());
    }
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

/// Axes of a cube: of its edges, and of the diagonals of its faces and its own.
fn of_a_cube() -> Vec<DVec3> {
    // Of three digits from 0 to 2 those after the middle one.
    let of = |k: u32| DVec3::from([k / 9, k / 3 % 3, k % 3].map(f64::from)) - 1.0;
    let mut axes: Vec<DVec3> = (14..27).map(|k| of(k).normalize()).collect();
    axes.sort_by(|a, b| b.abs().max_element().total_cmp(&a.abs().max_element()));
    axes
}
