//! Free directions of parts of an assembly: cells, areas, work and time, compared with ordinary casts along random
//! directions, half of them in cells.
//!
//! `free SOURCE [--tolerance L] [--parts A,B | --group PREFIX] [--depth N] [--looks N] [--judge N] [--verify 1]`

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use colltrans::removal::directions::{CellKind, FreeDirections, FreeOptions, Verdict};
use colltrans::solid::{StartOverlap, Workspace};
use colltrans_assembly::free::RemovalPair;
use colltrans_assembly::travel::travel_of_group;
use colltrans_assembly::{Bodies, Fit, Part};
use colltrans_assembly_io::read::{ReadOptions, read};
use glam::DVec3;

type Failure = Box<dyn std::error::Error>;

/// Returns the value of a command line option; `None` if it is missing or invalid.
fn option<T: std::str::FromStr>(name: &str) -> Option<T> {
    let words: Vec<String> = std::env::args().collect();
    words.windows(2).find(|w| w[0] == name).and_then(|w| w[1].parse().ok())
}

fn main() -> Result<(), Failure> {
    let source = std::env::args().nth(1).ok_or("a folder or file of parts")?;
    let assembly = read(&source, &ReadOptions::default())?;
    let fit = option("--tolerance").map_or_else(|| Fit::default_for(&assembly), Fit::Tolerance);
    let bodies = Bodies::new(&assembly, fit)?;
    let wanted: Option<String> = option("--parts");
    let options = FreeOptions::default()
        .with_depth(option("--depth").unwrap_or(FreeOptions::DEFAULT.depth))
        .with_looks(option("--looks").unwrap_or(FreeOptions::DEFAULT.looks))
        .with_cones(option("--cones").unwrap_or(FreeOptions::DEFAULT.cones));
    println!("tolerance {}", fit.tolerance());
    let mut all = 0.0;
    let names: Vec<&str> = assembly.parts().iter().map(Part::name).collect();
    let is_wanted = |part: &usize| {
        wanted.as_ref().is_none_or(|list| list.split(',').any(|word| word == names[*part]))
    };
    let groups: Vec<Vec<usize>> = match option::<String>("--group") {
        Some(prefix) => {
            vec![(0..bodies.len()).filter(|&part| names[part].starts_with(&prefix)).collect()]
        }
        None => (0..bodies.len()).filter(is_wanted).map(|part| vec![part]).collect(),
    };
    for group in groups {
        let name = names[group[0]];
        let started = Instant::now();
        match RemovalPair::new(&bodies, &group) {
            Err(error) => println!("{name}: {error}"),
            Ok(removal) => {
                let joined = started.elapsed().as_secs_f64();
                let free = removal.free_directions(options, &AtomicBool::new(false))?;
                let seconds = started.elapsed().as_secs_f64();
                all += seconds;
                print!("{name}: {seconds:.4} s ({joined:.4} joining), ");
                print_summary(&free);
                compare_with_casts(&bodies, &group, &free, option("--judge").unwrap_or(0));
                if option::<u8>("--verify").is_some() {
                    let started = Instant::now();
                    free.verify()?;
                    println!("    verified in {:.4} s", started.elapsed().as_secs_f64());
                }
            }
        }
    }
    println!("{all:.3} s in all");
    Ok(())
}

/// Prints the numbers of cells of each kind, the shares and the work.
fn print_summary(free: &FreeDirections) {
    let count = |kind| free.cells().filter(|cell| cell.kind == kind).count();
    let kinds = [CellKind::Free, CellKind::Blocked, CellKind::Both, CellKind::Undecided].map(count);
    let sphere = 4.0 * std::f64::consts::PI;
    let boxes = free.proof().boxes.map(|boxes| boxes.len());
    let [low, high] = free.free_area().map(|area| area / sphere);
    println!(
        "free/blocked/both/undecided cells {kinds:?}, {boxes:?} boxes inside, share free {low:.6e} (+{:.1e}), undecided {:.2e}, looks {}",
        high - low,
        free.undecided_area() / sphere,
        free.work_counts()[1]
    );
}

/// Compares verdicts with casts along random directions, and prints the numbers of contradictions.
fn compare_with_casts(bodies: &Bodies, group: &[usize], free: &FreeDirections, count: u64) {
    let mut state = 7 + group[0] as u64;
    let mut unit = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let cells: Vec<_> = free.cells().collect();
    let (alive, mut workspace) = (vec![true; bodies.len()], Workspace::default());
    let [mut wrong, mut open, mut silent] = [0; 3];
    for k in 0..count {
        let mut any = || DVec3::new(unit(), unit(), unit());
        let d = if k.is_multiple_of(2) {
            any() * 2.0 - 1.0
        } else {
            let way = any();
            let [a, _, c, _] = cells[(unit() * cells.len() as f64) as usize].corners;
            a + (c - a) * way
        };
        let d = d.normalize();
        let room = travel_of_group(bodies, group, &alive, d, StartOverlap::Refuse, &mut workspace);
        match free.classify(d) {
            Ok(Verdict::Free) => {
                open += 1;
                wrong += u32::from(!room.is_free());
            }
            Ok(Verdict::Blocked(_)) => wrong += u32::from(room.is_free()),
            _ => silent += 1,
        }
    }
    if count > 0 {
        println!("    judged {count}: {open} free, {silent} undecided, {wrong} wrong");
    }
}
