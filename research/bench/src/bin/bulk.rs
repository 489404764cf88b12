//! `bulk`: compares many casts of one pair with fixed rotations, by the faces of the difference, with ordinary
//! casts and the tracker in the same run.
//!
//! Each contestant answers all casts of a set before the next one, several times. The least time of a set,
//! divided by the number of casts, is the figure. It includes the construction of the casts.

use std::hint::black_box;
use std::process::ExitCode;
use std::time::Instant;

use colltrans::{
    BuildError, Cast, ConvexPolyhedron, FixedRotations, Outcome, Pose, QueryError, StartedFrom,
    Tracker,
};
use colltrans_bench::harness::{self, Run, with_name};
use colltrans_bench::shapes::Shape;
use colltrans_testkit::random::Random;
use glam::DVec3;
use serde_json::{Map, Value, json};

const SIZES: [usize; 5] = [8, 16, 32, 64, 128];

/// Number of casts in a set.
const CASTS: usize = 4096;

/// A distribution of places and directions.
#[derive(Debug, Clone, Copy, PartialEq)]
enum CastSet {
    /// Along one direction from many places; about every second cast hits.
    Places,
    /// From one place along many directions; about every second cast hits.
    Rays,
    /// Boxes without rotation, along an axis, from random places.
    EdgeOnFacet,
    /// The same from places on a grid of quarters: mostly ties.
    Tied,
}

impl CastSet {
    fn name(self) -> &'static str {
        match self {
            Self::Places => "places",
            Self::Rays => "rays",
            Self::EdgeOnFacet => "upright",
            Self::Tied => "tied",
        }
    }

    /// Draws the poses and directions of the moving body, and the pose of the fixed one.
    fn draw(self, random: &mut Random) -> (Vec<(Pose, DVec3)>, Pose) {
        let pose = |rotation, at| Pose::new(rotation, at).expect("a rotation");
        let (p, q) = (random.rotation(), random.rotation());
        let (far, along) = (random.direction() * 3.5, random.direction());
        let (side, other) =
            (along.any_orthonormal_vector(), along.cross(along.any_orthonormal_vector()));
        let any = |random: &mut Random| {
            DVec3::from_array([0; 3].map(|_| random.range(-2.4, 2.4))) - DVec3::X * 8.0
        };
        let one = |random: &mut Random| match self {
            Self::Places => {
                let [x, y] = [0; 2].map(|_| random.range(-2.2, 2.2));
                (pose(p, side * x + other * y - along * random.range(2.0, 6.0)), along)
            }
            Self::Rays => {
                let aim = random.direction() * (2.6 * random.unit().cbrt());
                (pose(p, far), aim - far)
            }
            Self::EdgeOnFacet => (Pose::from_translation(any(random)).expect("a place"), DVec3::X),
            Self::Tied => {
                let place = (any(random) * 4.0).round() * 0.25;
                (Pose::from_translation(place).expect("a place"), DVec3::X)
            }
        };
        let casts = (0..CASTS).map(|_| one(random)).collect();
        let still = matches!(self, Self::EdgeOnFacet | Self::Tied);
        (casts, if still { Pose::IDENTITY } else { pose(q, DVec3::ZERO) })
    }
}

/// The contestants.
const CONTESTANTS: [&str; 4] = ["cast", "tracker", "any direction", "one direction"];

fn main() -> ExitCode {
    let about = "Compares bulk casts with fixed rotations with ordinary casts and a tracker; prints a table";
    harness::run("bulk", about, |run, (): &()| {
        let columns = "set:<8; body:<12=shape; n:>4=vertices; hit%:>4.0=hits × 100;
            |cast:>6.0=ns/cast; tracker:>7.0=ns/tracker; any:>6.0=ns/any direction; one:>6.0=ns/one direction;
            |any:>5.2=ns/cast ÷ ns/any direction; one:>5.2=ns/cast ÷ ns/one direction;
            |faces:>6.0=make_ns ÷ 1e3; map:>5.0=map_ns ÷ 1e3; |any:>6.0=pays/0; one:>6.0=pays/1;
            |any:>5.1=left/0 × 100; one:>5.1=left/1 × 100; looks:>5.2";
        let legend = "ns a cast, the least of all turns; times as fast as the ordinary cast; us to make the faces and the map; \
             casts after which they have paid (any direction, one direction); % not answered by the faces";
        run.table(legend, columns);
        let mut sets = Vec::new();
        for set in [CastSet::Places, CastSet::Rays] {
            sets.push((set, Shape::Box, 8));
            for shape in [Shape::RandomHull, Shape::Ellipsoid] {
                sets.extend(run.sizes(&SIZES).into_iter().map(|n| (set, shape, n)));
            }
        }
        sets.extend([CastSet::EdgeOnFacet, CastSet::Tied].map(|set| (set, Shape::Box, 8)));
        for (set, shape, n) in sets {
            let failed = with_name(format!("{} of {n} vertices", shape.name()));
            run.add(measure_set(set, shape, n, run).map_err(failed)?);
        }
        Ok(())
    })
}

/// Draws the bodies of a set.
fn draw_bodies(
    set: CastSet,
    shape: Shape,
    n: usize,
    random: &mut Random,
) -> Result<[ConvexPolyhedron; 2], BuildError> {
    if set == CastSet::Tied {
        let cube = ConvexPolyhedron::cuboid(-DVec3::ONE, DVec3::ONE)?;
        return Ok([cube.clone(), cube]);
    }
    shape.pair(n, random)
}

/// Measures a set.
fn measure_set(set: CastSet, shape: Shape, n: usize, run: &Run) -> Result<Value, BuildError> {
    let mut random = run.random(&[n as u64, set as u64]);
    let [p, q] = draw_bodies(set, shape, n, &mut random)?;
    let (casts, world) = set.draw(&mut random);
    let cast = |(pose, along): &(Pose, DVec3)| Cast::new(p.at(*pose), q.at(world), *along);
    let turns = run.choose(5, 25);
    let (mut make, mut map) = (f64::INFINITY, f64::INFINITY);
    let made = || FixedRotations::new(p.at(casts[0].0), q.at(world));
    let rotations = made();
    let along = || rotations.for_direction(casts[0].1).expect("a direction");
    let approach = along();
    let mut least = [f64::INFINITY; CONTESTANTS.len()];
    let mut answers: [Vec<Result<Outcome, QueryError>>; CONTESTANTS.len()] = Default::default();
    for _ in 0..turns {
        make = make.min(elapsed_seconds(|| drop(black_box(made()))));
        map = map.min(elapsed_seconds(|| drop(black_box(along()))));
        for (who, answers) in answers.iter_mut().enumerate() {
            answers.clear();
            let mut tracker = Tracker::new();
            let spent = elapsed_seconds(|| {
                for of in &casts {
                    // Matched in place: casts and outcomes are large, and moving them takes as long as an
                    // answer.
                    answers.push(match cast(black_box(of)) {
                        Err(error) => Err(error),
                        Ok(cast) => match who {
                            0 => cast.first_contact(),
                            1 => tracker.first_contact(&cast),
                            2 => rotations.first_contact(&cast),
                            _ => approach.first_contact(&cast),
                        },
                    });
                }
            });
            least[who] = least[who].min(spent * 1e9 / CASTS as f64);
        }
    }
    if set == CastSet::Rays {
        least[3] = f64::NAN;
    }
    let share = |who: usize, of: &dyn Fn(&Outcome) -> bool| {
        let count = answers[who].iter().flatten().filter(|outcome| of(outcome)).count();
        count as f64 / CASTS as f64
    };
    let looks: u32 = answers[2].iter().flatten().map(|outcome| outcome.steps().pivots).sum();
    let [make, map] = [make, map].map(|s| s * 1e9);
    let left = |who: usize| share(who, &|o| o.steps().started_from != StartedFrom::Difference);
    let ns = CONTESTANTS.iter().zip(least).map(|(who, ns)| ((*who).into(), json!(ns)));
    Ok(json!({
        "set": set.name(), "shape": shape.name(), "vertices": n,
        "hits": share(0, &|outcome| matches!(outcome, Outcome::Contact(_))),
        "ns": ns.collect::<Map<_, _>>(),
        "make_ns": make, "map_ns": map,
        "pays": [make / (least[0] - least[2]), (make + map) / (least[0] - least[3])],
        "left": [left(2), left(3)],
        "looks": f64::from(looks) / CASTS as f64,
    }))
}

/// Returns the seconds of a run.
fn elapsed_seconds(run: impl FnOnce()) -> f64 {
    let started = Instant::now();
    run();
    started.elapsed().as_secs_f64()
}
