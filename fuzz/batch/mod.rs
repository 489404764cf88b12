//! Includes the sources of the command line that read lines of a batch, and compares the two readers.

#[path = "../../crates/colltrans-cli/src/batch/fast_path.rs"]
pub(crate) mod fast_path;
#[path = "../../crates/colltrans-cli/src/batch/source.rs"]
pub(crate) mod source;

pub(crate) mod motion {
    /// Accepts any value, because motions are not on the fast path.
    #[derive(serde::Deserialize)]
    pub(crate) struct MotionSource(serde::de::IgnoredAny);
}

use serde_json::value::RawValue;

use source::Query;

/// Checks that the fast path reads a line like `serde_json`.
pub(crate) fn check(text: &str) {
    let Some(fast) = fast_path::parse_usual_line(text) else {
        let _ = serde_json::from_str::<Query<'_, source::BodySource>>(text);
        return;
    };
    // The fast path returns bodies as text; a later step rejects bodies that are not JSON.
    let are_bodies =
        [fast.moving, fast.fixed].map(|body| serde_json::from_str::<&RawValue>(body).is_ok());
    let slow: Query<'_, &RawValue> = match serde_json::from_str(text) {
        Ok(slow) => slow,
        Err(error) => {
            assert!(are_bodies.contains(&false), "read by the fast path alone: {error}");
            return;
        }
    };
    assert_eq!(fast.id.map(RawValue::get), slow.id.map(RawValue::get));
    assert_eq!(fast.moving, slow.moving.get());
    assert_eq!(fast.fixed, slow.fixed.get());
    let poses = [[fast.moving_pose, slow.moving_pose], [fast.fixed_pose, slow.fixed_pose]];
    for [a, b] in poses.map(|pose| pose.map(|pose| pose.map(|pose| format!("{pose:?}")))) {
        assert_eq!(a, b);
    }
    let bits = |values: Option<[f64; 3]>| values.map(|values| values.map(f64::to_bits));
    assert_eq!(bits(fast.direction), bits(slow.direction));
    let numbers =
        |a: Option<f64>, b: Option<f64>| assert_eq!(a.map(f64::to_bits), b.map(f64::to_bits));
    numbers(fast.length, slow.length);
    numbers(fast.graze_tolerance, slow.graze_tolerance);
    numbers(fast.min_gap, slow.min_gap);
    assert_eq!(fast.question, slow.question);
}
