//! Runs the casts of `python/benchmarks/overhead.py` without Python, for comparison.
//!
//! `bare POINTS_A POINTS_B ROWS THREADS REPEATS` reads files of raw doubles, three for a point and ten
//! for a row (a translation and a quaternion of the moving body, a direction). Prints the wall time of
//! a cast in nanoseconds, the minimum of the repeats. The caller measures the CPU time.

use std::error::Error;
use std::time::Instant;

use colltrans::glam::{DQuat, DVec3};
use colltrans::{Cast, ConvexPolyhedron, Outcome, Pose};

type Anything<T = ()> = Result<T, Box<dyn Error + Send + Sync>>;

fn doubles(path: &str) -> std::io::Result<Vec<f64>> {
    let bytes = std::fs::read(path)?;
    Ok(bytes.as_chunks::<8>().0.iter().copied().map(f64::from_ne_bytes).collect())
}

fn body(path: &str) -> Anything<ConvexPolyhedron> {
    let points: Vec<DVec3> =
        doubles(path)?.as_chunks::<3>().0.iter().copied().map(DVec3::from_array).collect();
    Ok(ConvexPolyhedron::from_points(&points)?)
}

/// Answers rows, into as much memory as the columns of Python need.
fn casts(
    bodies: &[ConvexPolyhedron; 2],
    rows: &[[f64; 10]],
    answers: &mut [[f64; 11]],
) -> Anything {
    for (row, answer) in rows.iter().zip(answers) {
        let [at, turn, to] = [&row[..3], &row[3..7], &row[7..]];
        let pose = Pose::new(DQuat::from_slice(turn), DVec3::from_slice(at))?;
        let moving = bodies[0].at(pose);
        let cast = Cast::new(moving, bodies[1].at(Pose::IDENTITY), DVec3::from_slice(to))?;
        if let Outcome::Contact(contact) = cast.first_contact()? {
            let proof = contact.certificate;
            answer[..3].copy_from_slice(&contact.normal.to_array());
            answer[3..6].copy_from_slice(&contact.witness_points(&cast).on_fixed.to_array());
            answer[6..].copy_from_slice(&[
                contact.translation,
                proof.lower,
                proof.upper,
                proof.rounding,
                0.0,
            ]);
        }
    }
    Ok(())
}

fn main() -> Anything {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [a, b, rows, threads, repeats] = arguments.as_slice() else {
        return Err("bare POINTS_A POINTS_B ROWS THREADS REPEATS".into());
    };
    let (bodies, rows) = ([body(a)?, body(b)?], doubles(rows)?);
    let (rows, _) = rows.as_chunks::<10>();
    let share = rows.len().div_ceil(threads.parse()?).max(1);
    let mut least = f64::INFINITY;
    for _ in 0..repeats.parse::<u32>()? {
        let began = Instant::now();
        let mut answers = vec![[0.0; 11]; rows.len()];
        std::thread::scope(|scope| {
            let parts = rows.chunks(share).zip(answers.chunks_mut(share));
            let started: Vec<_> =
                parts.map(|(rows, out)| scope.spawn(|| casts(&bodies, rows, out))).collect();
            started.into_iter().try_for_each(|thread| thread.join().map_err(|_| "a panic")?)
        })?;
        least = least.min(began.elapsed().as_secs_f64());
    }
    println!("{}", least / rows.len() as f64 * 1e9);
    Ok(())
}
