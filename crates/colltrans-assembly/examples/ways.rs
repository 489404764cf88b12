//! Removal paths: `ways SOURCE [tolerance] [legs] [axes]` prints the legs that remove a first part or group. If more
//! axes are requested than the large facets of the parts yield, axes of a cube's edges and diagonals are added, up to
//! 13 in all.

use std::time::Instant;

use colltrans::Pose;
use colltrans::glam::DVec3;
use colltrans::removal::path::{RemovalOptions, RemovalSearch, large_facet_axes};
use colltrans_assembly_io::read::{ReadOptions, read};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let assembly = read(&arguments[0], &ReadOptions::default())?;
    let default = assembly.coordinate_size() / f64::from(1 << 21);
    let tolerance = arguments.get(1).map_or(Ok(default), |text| text.parse())?;
    let legs = arguments.get(2).map_or(Ok(12), |text| text.parse())?;
    let parts = assembly.parts();
    let bodies: Vec<_> = parts.iter().map(|part| part.solid().at(Pose::IDENTITY)).collect();
    let axes = arguments.get(3).map_or(Ok(0), |text| text.parse::<usize>())?;
    let mut options = RemovalOptions::default().with_tolerance(tolerance).with_legs(legs);
    if axes > 0 {
        let own = large_facet_axes(&bodies);
        let more =
            cube_axes().into_iter().filter(|d| own.iter().all(|a| a.cross(*d).length() > 1e-6));
        options = options.with_directions(own.iter().copied().chain(more).take(axes).collect());
    }
    let start = Instant::now();
    let found = RemovalSearch::search_among(&bodies, &[], &options, None)?;
    let seconds = start.elapsed().as_secs_f64();
    match found {
        RemovalSearch::Found(way) => {
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
        RemovalSearch::Proven(proof) => {
            proof.verify(&bodies[0], &bodies[1])?;
            println!("no way: {seconds:.4} s, proven in {} cells", proof.cell_count());
        }
        RemovalSearch::NotFound { searched } => println!("not found: {seconds:.4} s, {searched:?}"),
    }
    Ok(())
}

/// Returns the axes of a cube: of its edges, and of the diagonals of its faces and its volume.
fn cube_axes() -> Vec<DVec3> {
    // The directions with coordinates -1, 0 and 1, of which the second half is used.
    let direction = |k: u32| DVec3::from([k / 9, k / 3 % 3, k % 3].map(f64::from)) - 1.0;
    let mut axes: Vec<DVec3> = (14..27).map(|k| direction(k).normalize()).collect();
    axes.sort_by(|a, b| b.abs().max_element().total_cmp(&a.abs().max_element()));
    axes
}
