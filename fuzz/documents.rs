//! Contains the fuzz targets for JSON documents of the library: lines of batches, proofs, cases.
//!
//! An input begins with a byte. After an even byte, the rest is the text; otherwise [`written::json`] changes a
//! few values of a valid document.

use std::sync::LazyLock;

use arbitrary::Unstructured;
use colltrans::glam::DVec3;
use colltrans::motion::{Motion, MotionCase, MotionCast};
use colltrans::{Case, Cast, ConvexPolyhedron, Pair, Pose, ProofFile};

#[path = "written.rs"]
mod written;

#[path = "batch/mod.rs"]
mod batch;

/// Returns the text after the first byte, or a changed one of `seeds`.
fn text_of(bytes: &[u8], seeds: &[String]) -> Option<String> {
    let (&first, rest) = bytes.split_first()?;
    let text = if first % 2 == 0 {
        rest.to_vec()
    } else {
        written::json(&mut Unstructured::new(rest), seeds).ok()?
    };
    String::from_utf8(text).ok()
}

/// Returns a unit cube.
fn cube() -> ConvexPolyhedron {
    ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).expect("a cube")
}

/// Returns a cast of two cubes along x.
fn cast(cube: &ConvexPolyhedron, start: DVec3) -> Cast<'_> {
    let start = Pose::from_translation(start).expect("a pose");
    Cast::new(cube.at(start), cube.at(Pose::IDENTITY), DVec3::X).expect("a query")
}

/// Runs a function on a cast of a rotating cube.
fn motion(cube: &ConvexPolyhedron, run: impl FnOnce(&MotionCast<'_>) -> String) -> String {
    let turn = Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, 2.0).expect("a turn");
    let fixed = Pose::from_translation(DVec3::X * 1.2).expect("a pose");
    run(&MotionCast::new(cube.with_motion(&turn), cube.at(fixed)).expect("a query"))
}

/// Reads lines of a batch.
pub(crate) fn lines(bytes: &[u8]) {
    static SEEDS: LazyLock<Vec<String>> = LazyLock::new(|| {
        let body = r#"{"points":[[0,0,0],[1,0,0],[0,1,0],[0,0,1]]}"#;
        let pose = r#"{"translation":[6,1,9],"rotation":[0.2,0.3,0.1,0.9273618495495704]}"#;
        vec![
            format!(
                r#"{{"id":"a","moving":{body},"fixed":{{"mesh":"c.off","scale":2}},"moving_pose":{pose},"direction":[-0.3,0.1,-1]}}"#
            ),
            format!(
                r#"{{"id":7,"moving":{body},"fixed":{body},"fixed_pose":{pose},"query":"within","length":0.5,"min_gap":0.25}}"#
            ),
            format!(
                r#"{{"moving":{body},"fixed":{body},"direction":[1,0,0],"solver":"cta","graze_tolerance":1e-9,"until":"exit"}}"#
            ),
        ]
    });
    let Some(text) = text_of(bytes, &SEEDS) else { return };
    batch::check(&text);
}

/// Reads proofs.
pub(crate) fn proofs(bytes: &[u8]) {
    static SEEDS: LazyLock<Vec<String>> = LazyLock::new(|| {
        let cube = cube();
        let mut seeds = Vec::new();
        for start in [[-3.0, 0.3, 0.1], [-3.0, 4.0, 0.0], [-3.0, 1.0, 0.0], [0.25, 0.5, 0.75]] {
            let cast = cast(&cube, start.into());
            if let Ok(outcome) = cast.first_contact() {
                seeds.push(ProofFile::of_outcome(&cast, &outcome).to_json());
            }
            if let Ok(clearance) = cast.clearance() {
                seeds.push(ProofFile::of_clearance(&cast, &clearance).to_json());
            }
            let start = Pose::from_translation(start.into()).expect("a pose");
            let pair = Pair::new(cube.at(start), cube.at(Pose::IDENTITY)).expect("a pair");
            if let Ok(distance) = pair.distance() {
                seeds.push(ProofFile::of_distance(&pair, &distance).to_json());
            }
            if let Ok(depth) = pair.depth() {
                seeds.push(ProofFile::of_depth(&pair, &depth).to_json());
            }
        }
        seeds.push(motion(&cube, |cast| {
            ProofFile::of_motion(cast, &cast.first_contact().expect("an answer")).to_json()
        }));
        seeds
    });
    let Some(text) = text_of(bytes, &SEEDS) else { return };
    if let Ok(proof) = ProofFile::from_json(&text) {
        let checked = proof.check().is_ok();
        let again = ProofFile::from_json(&proof.to_json()).expect("what it has written");
        assert_eq!(again.check().is_ok(), checked);
    }
}

/// Reads cases.
pub(crate) fn cases(bytes: &[u8]) {
    static SEEDS: LazyLock<Vec<String>> = LazyLock::new(|| {
        let cube = cube();
        vec![
            cast(&cube, DVec3::new(-3.1, 0.3, 0.1)).to_json(),
            cast(&cube, DVec3::new(0.5, 0.3, 0.1)).to_json(),
            motion(&cube, |cast| MotionCase::from_cast(cast).to_json()),
        ]
    });
    let Some(text) = text_of(bytes, &SEEDS) else { return };
    if let Ok(case) = Case::from_json(&text) {
        if let Ok(cast) = case.cast() {
            Case::from_json(&cast.to_json()).expect("what it has written");
            let _ = cast.first_contact();
        }
    }
    if let Ok(case) = MotionCase::from_json(&text) {
        let _ = case.cast().first_contact();
    }
}
