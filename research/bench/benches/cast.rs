//! Measures a few rows of the tables with criterion: `cargo bench -p colltrans-bench`.

use std::hint::black_box;

use colltrans::{Options, Solver, Tracker};
use colltrans_bench::parry::{self, ParrySetting};
use colltrans_bench::shapes::Shape;
use colltrans_lab::settings::{Meeting, Setting};
use colltrans_lab::shapes::Bodies;
use colltrans_testkit::random::Random;
use criterion::{Criterion, criterion_group, criterion_main};

/// Measures casts from scratch, ours and parry's.
fn cast(criterion: &mut Criterion) {
    for (shape, n, meeting, name) in [
        (Shape::Ellipsoid, 8, Meeting::Colliding, "colliding"),
        (Shape::Ellipsoid, 128, Meeting::Colliding, "colliding"),
        (Shape::Ellipsoid, 2_000, Meeting::Colliding, "colliding"),
        (Shape::Ellipsoid, 2_000, Meeting::PassingWithin(0.2), "separated"),
        (Shape::Needle(100.0), 2_000, Meeting::Colliding, "colliding"),
    ] {
        let mut random = Random::stream(1, &[n as u64]);
        let bodies = Bodies::new(shape.pair(n, &mut random).expect("bodies"));
        let [moving, fixed] = &bodies.pair;
        let settings: Vec<_> =
            (0..256).map(|_| Setting::draw(&bodies, meeting, &mut random)).collect();
        let mut group = criterion.benchmark_group(format!("{} {n} {name}", shape.name()));
        for (name, solver) in
            [("cta", Solver::Cta), ("portal", Solver::Portal), ("auto", Solver::Auto)]
        {
            let options = Options::default().with_solver(solver);
            let mut cycle = settings.iter().cycle();
            group.bench_function(name, |bencher| {
                bencher.iter(|| {
                    let s = black_box(cycle.next().expect("endless"));
                    s.cast(&bodies, &options).and_then(|cast| cast.first_contact())
                });
            });
        }
        if let (Some(moving), Some(fixed)) =
            (parry::convert_body(moving), parry::convert_body(fixed))
        {
            let settings: Vec<_> = settings.iter().map(ParrySetting::new).collect();
            let mut cycle = settings.iter().cycle();
            group.bench_function("parry3d-f64", |bencher| {
                bencher.iter(|| black_box(cycle.next().expect("endless")).cast(&moving, &fixed));
            });
        }
        group.finish();
    }
}

/// Measures a repeated sequence, from scratch and tracked.
fn track(criterion: &mut Criterion) {
    for (n, delta) in [(200, 0.01), (2_000, 0.01), (2_000, 0.0013), (20_000, 0.0013)] {
        let mut random = Random::stream(1, &[n as u64]);
        let bodies = Bodies::new(Shape::Ellipsoid.pair(n, &mut random).expect("bodies"));
        let [moving, fixed] = &bodies.pair;
        let settings = Setting::sequence(&bodies, Meeting::Colliding, delta, 1_000, &mut random);
        let options = Options::default();
        let mut tracker = Tracker::new();
        let mut group = criterion.benchmark_group(format!("sequence {n} {}%", 100.0 * delta));
        // Forwards and back, so that there is no jump.
        let mut cycle = settings.iter().chain(settings.iter().rev()).cycle();
        group.bench_function("tracker", |bencher| {
            bencher.iter(|| {
                let s = black_box(cycle.next().expect("endless"));
                s.cast(&bodies, &options).and_then(|cast| tracker.first_contact(&cast))
            });
        });
        group.bench_function("scratch", |bencher| {
            bencher.iter(|| {
                let s = black_box(cycle.next().expect("endless"));
                colltrans::cast(moving, &s.moving, fixed, &s.fixed, s.direction)
            });
        });
        group.finish();
    }
}

criterion_group!(benches, cast, track);
criterion_main!(benches);
