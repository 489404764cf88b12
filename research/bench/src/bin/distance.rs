//! `distance`: compares distances and depths with `parry3d-f64`, in one run on the same settings.
//!
//! Bodies have random orientations and a given gap or depth along the normal of their distance. Each query is
//! measured alone, so that caches and branch prediction hold the state left by the other library, or several
//! times in a row. Both libraries answer each setting, in turns. The figures are medians of the times and of
//! the settings' ratios. Parry's answer is *wrong* if it differs from our bounds by more than a share of the
//! gap.

use std::process::ExitCode;

use clap::Args;
use colltrans::{ConvexPolyhedron, Pair, Pose, Tracker};
use colltrans_bench::harness::{self, Run};
use colltrans_bench::parry::{self, ParrySetting};
use colltrans_bench::shapes::Shape;
use colltrans_bench::times::{Clock, Comparison, Times};
use colltrans_testkit::oracle::scene::size;
use colltrans_testkit::random::Random;
use glam::{DQuat, DVec3};
use serde_json::{Value, json};

#[derive(Debug, Args)]
struct OwnArguments {
    /// Run each query N times in a row, and take the mean
    #[arg(long, value_name = "N", default_value_t = 1)]
    repeat: u32,
}

const SIZES: [usize; 5] = [8, 32, 128, 2_000, 20_000];

/// Gaps of the bodies; negative ones are depths.
const GAPS: [f64; 4] = [0.5, 1e-6, 1e-9, -0.1];

/// Parry's answer is wrong if its error exceeds this share of the gap.
const WRONG_SHARE: f64 = 1e-2;

/// Translation, and rotation in radians, between successive settings of a sequence.
const STEP: f64 = 0.01;

fn main() -> ExitCode {
    let about = "Compares distances and depths with parry3d-f64; prints a table";
    harness::run("distance", about, |run, own: &OwnArguments| {
        let columns =
            "vertices:>8; gap:>8.0e; ours ns:>9.0=ours/median_ns; parry ns:>9.0=parry/median_ns;
            ratio:>7.2; wrong:>7; noises:>9.2; coherent:>9.2";
        run.table("", columns);
        for n in run.sizes(&SIZES) {
            for gap in GAPS {
                run.add(measure_row(n, gap, run, Clock::new(own.repeat)));
            }
        }
        Ok(())
    })
}

/// Measures two bodies of a size at a gap, several times.
fn measure_row(n: usize, gap: f64, run: &Run, clock: Clock) -> Value {
    let mut random = run.random(&[n as u64]);
    let pairs: Vec<[ConvexPolyhedron; 2]> = (0..if n > 1_000 { 2 } else { 8 })
        .map(|_| Shape::Ellipsoid.pair(n, &mut random).expect("bodies"))
        .collect();
    let theirs: Vec<_> = pairs
        .iter()
        .map(|pair| pair.each_ref().map(|one| parry::convert_body(one).expect("a body of parry's")))
        .collect();
    let (mut times, mut coherent) = (Comparison::default(), Times::default());
    let (mut wrong, mut widest) = (0_u32, 0.0_f64);
    for index in 0..run.choose(200, 1_000) {
        let which = index % pairs.len();
        let ([p, q], [x, y]) = (&pairs[which], &theirs[which]);
        let Some([a, b]) = poses_at_gap(p, q, gap, &mut random) else { continue };
        let setting = ParrySetting::from_poses([&a, &b], DVec3::X);
        let pair = Pair::new(p.at(a), q.at(b)).expect("a pair");
        let parry = || if gap > 0.0 { setting.distance(x, y) } else { setting.depth(x, y) };
        let us = || {
            let bounds = |d: colltrans::Distance| d.bounds();
            if gap > 0.0 { pair.distance().map(bounds) } else { pair.depth().map(|d| d.bounds()) }
        };
        let (mine, other) = times.compare_query(clock, us, parry);
        let [lower, upper] = mine.expect("an answer");
        wrong +=
            u32::from(other.is_none_or(|other| (other - lower).abs() > WRONG_SHARE * gap.abs()));
        widest = widest.max((upper - lower) / rounding_error(&pair));
        if gap > 0.0 {
            coherent.add(tracked_time_ratio(&pair, clock, &mut random));
        }
    }
    json!({
        "vertices": n, "gap": gap, "ours": times.ours, "parry": times.theirs,
        "ratio": times.ratios.median(), "wrong": wrong, "noises": widest,
        "coherent": coherent.median(),
    })
}
/// Returns the time of a tracked distance after a small change, relative to the same distance from scratch.
fn tracked_time_ratio(pair: &Pair, clock: Clock, random: &mut Random) -> f64 {
    let mut tracker = Tracker::new();
    tracker.distance(pair).expect("an answer");
    let turn = DQuat::from_axis_angle(random.direction(), STEP) * pair.moving_pose().rotation();
    let at = pair.moving_pose().translation() + random.direction() * STEP;
    let moved = Pose::new(turn.normalize(), at).expect("a pose");
    let next = Pair::new(pair.moving().at(moved), pair.fixed().at(pair.fixed_pose()));
    let next = next.expect("a pair");
    // Each repetition has its own tracker, cloned before the clock starts.
    let mut trackers = vec![tracker; clock.repeat as usize];
    let mut last = trackers.iter_mut();
    let (_, tracked) = clock.time(|| last.next().map(|tracker| tracker.distance(&next)));
    clock.time(|| next.distance()).1.recip() * tracked
}

/// Draws poses with random orientations in which the bodies have a gap.
fn poses_at_gap(
    p: &ConvexPolyhedron,
    q: &ConvexPolyhedron,
    gap: f64,
    random: &mut Random,
) -> Option<[Pose; 2]> {
    let far = random.direction() * 4.0;
    let a = Pose::new(random.rotation(), DVec3::ZERO).ok()?;
    let b = Pose::new(random.rotation(), far).ok()?;
    let distance = Pair::new(p.at(a), q.at(b)).ok()?.distance().ok()?;
    let moved = a.translated_by(distance.normal? * (distance.lower - gap)).ok()?;
    Some([moved, b])
}

/// Returns the rounding error that the library states, `32 u S`.
fn rounding_error(pair: &Pair) -> f64 {
    let vertices = [pair.moving().vertices(), pair.fixed().vertices()];
    16.0 * f64::EPSILON * size(vertices, [&pair.moving_pose(), &pair.fixed_pose()])
}
