//! Random and tied settings against exact arithmetic: a sample of the long campaign.

use colltrans::Solver;
use colltrans_oracle::settings::{FAMILIES, setting};

const SOLVERS: [Solver; 3] = [Solver::Cta, Solver::Portal, Solver::Auto];

/// Settings per family whose certificates are re-verified.
const SETTINGS: u64 = 1_000;
/// One of so many is also solved by the rational linear programme.
const LP_EVERY: u64 = 20;

fn check_family(family: &str) {
    let mut wrong = Vec::new();
    for seed in 0..SETTINGS {
        let setting = setting(family, seed);
        let bodies = setting.bodies().expect("a body");
        let judge = setting.judge(&bodies);
        for solver in SOLVERS {
            let verdict =
                setting.cast(&bodies, solver).map_err(|e| e.to_string()).and_then(|out| {
                    let proof = judge.check(&out).map_err(|e| e.to_string())?;
                    if !proof.exact || seed % LP_EVERY == 0 {
                        judge.compare_with_oracle(&out).map_err(|e| e.to_string())?;
                    }
                    Ok(())
                });
            if let Err(objection) = verdict {
                wrong.push(format!("{setting} {solver:?}: {objection}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{} wrong answers, among them\n{}", wrong.len(), some_of(&wrong));
}

fn some_of(lines: &[String]) -> String {
    lines[..lines.len().min(10)].join("\n")
}

macro_rules! families {
    ($($test:ident => $family:literal,)+) => {
        $(#[test]
        fn $test() {
            check_family($family);
        })+

        #[test]
        fn no_family_is_left_out() {
            let tested = [$($family),+];
            let known: Vec<&str> = FAMILIES.iter().map(|f| f.0).collect();
            assert_eq!(known, tested);
        }
    };
}

families! {
    random => "random",
    boxes => "boxes",
    turned_boxes => "turned-boxes",
    prisms => "prisms",
    grids => "grid",
    face_on_face => "face-face",
    parallel_edges => "edge-edge-parallel",
    vertex_over_vertex => "vertex-over-vertex",
    contact_at_the_rim => "rim",
    identical_bodies => "identical",
    pegs_without_clearance => "peg",
    needles_and_plates => "needle-plate",
    size_ratios => "size-ratio",
    offsets => "offset",
    far_starts => "far",
    flat_bodies => "flat",
    segments_and_points => "segment-point",
    nearly_tied => "nearly",
    shallow_descents => "shallow",
    thin_slabs => "thin",
    cylinders => "cylinders",
    magnitudes => "magnitude",
}
