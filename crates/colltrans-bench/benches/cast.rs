//! A few rows of the tables under criterion: `cargo bench -p colltrans-bench`.

use std::hint::black_box;

use colltrans::{Solver, Tracker};
use colltrans_bench::motion::{Motion, sequence};
use colltrans_bench::parry::{self, ParrySetting};
use colltrans_bench::settings::{Meeting, Setting};
use colltrans_bench::shapes::Shape;
use colltrans_oracle::settings::Rng;
use criterion::{Criterion, criterion_group, criterion_main};

fn cast(criterion: &mut Criterion) {
    for (shape, n, meeting) in [
        (Shape::Ellipsoid, 8, Meeting::Colliding),
        (Shape::Ellipsoid, 128, Meeting::Colliding),
        (Shape::Ellipsoid, 2_000, Meeting::Colliding),
        (Shape::Ellipsoid, 2_000, Meeting::Separated),
        (Shape::Needle(100.0), 2_000, Meeting::Colliding),
    ] {
        let mut rng = Rng::new(1);
        let bodies: Vec<_> = (0..4).map(|_| shape.draw(n, &mut rng).expect("a body")).collect();
        let settings: Vec<_> =
            (0..256).map(|_| Setting::draw(&bodies, meeting, &mut rng)).collect();
        let mut group =
            criterion.benchmark_group(format!("{} {n} {}", shape.name(), meeting.name()));
        for (name, solver) in
            [("cta", Solver::Cta), ("portal", Solver::Portal), ("auto", Solver::Auto)]
        {
            let mut cycle = settings.iter().cycle();
            group.bench_function(name, |bencher| {
                bencher.iter(|| black_box(cycle.next().expect("endless")).cast(&bodies, solver));
            });
        }
        let theirs: Option<Vec<_>> = bodies.iter().map(parry::body).collect();
        if let Some(theirs) = theirs {
            let settings: Vec<_> =
                settings.iter().map(|s| (s.moving, s.fixed, ParrySetting::new(s))).collect();
            let mut cycle = settings.iter().cycle();
            group.bench_function("parry3d-f64", |bencher| {
                bencher.iter(|| {
                    let (moving, fixed, setting) = black_box(cycle.next().expect("endless"));
                    setting.cast(&theirs[*moving], &theirs[*fixed])
                });
            });
        }
        group.finish();
    }
}

/// A sequence over and over, from scratch and tracked.
fn track(criterion: &mut Criterion) {
    for (n, delta) in [(200, 0.01), (2_000, 0.01), (2_000, 0.0013), (20_000, 0.0013)] {
        let mut rng = Rng::new(1);
        let bodies: Vec<_> =
            (0..4).map(|_| Shape::Ellipsoid.draw(n, &mut rng).expect("a body")).collect();
        let settings = sequence(&bodies, Meeting::Colliding, Motion::Screw, delta, 1_000, &mut rng);
        let Some(&Setting { moving, fixed, .. }) = settings.first() else { continue };
        let mut tracker = Tracker::new(&bodies[moving], &bodies[fixed]);
        let mut group = criterion.benchmark_group(format!("sequence {n} {}%", 100.0 * delta));
        // Forwards and back, so that there is no jump.
        let mut cycle = settings.iter().chain(settings.iter().rev()).cycle();
        group.bench_function("tracker", |bencher| {
            bencher.iter(|| {
                let setting = black_box(cycle.next().expect("endless"));
                tracker.cast(&setting.moving_pose, &setting.fixed_pose, setting.direction)
            });
        });
        group.bench_function("scratch", |bencher| {
            bencher.iter(|| black_box(cycle.next().expect("endless")).cast(&bodies, Solver::Auto));
        });
        group.finish();
    }
}

criterion_group!(benches, cast, track);
criterion_main!(benches);
