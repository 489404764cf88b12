//! `rounded`: compares casts and distances of spheres, capsules, boxes and hulls with `parry3d-f64`, in one run on the
//! same settings.
//!
//! Bodies have random radii, sides and orientations. Half of the casts are aimed at the fixed body's centre, the others
//! beside it. Both libraries answer each setting, in turns. The figures are medians of the times and of the settings'
//! ratios. Parry's answer is *wrong* if it differs from our bounds by more than a share of the distance.

use std::process::ExitCode;

use clap::Args;
use colltrans::{Cast, ConvexPolyhedron, Outcome, Pair, Pose};
use colltrans_bench::harness::{self, Failure, Run};
use colltrans_bench::parry::{self, ParrySetting};
use colltrans_bench::shapes::Shape;
use colltrans_bench::times::{Clock, Comparison};
use colltrans_testkit::random::Random;
use glam::DVec3;
use parry3d_f64::shape::{Ball, Capsule, Cuboid, SharedShape};
use serde_json::{Value, json};

#[derive(Debug, Args)]
struct OwnArguments {
    /// Run each query N times in a row, and take the mean
    #[arg(long, value_name = "N", default_value_t = 16)]
    repeat: u32,
}

/// Numbers of vertices of hulls.
const SIZES: [usize; 5] = [32, 128, 2_000, 20_000, 200_000];

/// Parry's answer is wrong if its error exceeds this share of the translation or distance.
const WRONG_SHARE: f64 = 1e-6;

/// A kind of body.
#[derive(Debug, Clone, Copy)]
enum Kind {
    Sphere,
    Capsule,
    Box,
    /// A hull with about this many vertices.
    Hull(usize),
}

/// A body and its equivalent in parry's types.
struct Twin {
    body: ConvexPolyhedron,
    shape: SharedShape,
}

impl Kind {
    /// Returns the name in tables.
    fn name(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Capsule => "capsule",
            Self::Box => "box",
            Self::Hull(_) => "hull",
        }
    }

    /// Draws a body.
    fn draw(self, random: &mut Random) -> Result<Twin, Failure> {
        let radius = random.range(0.2, 0.6);
        Ok(match self {
            Self::Sphere => Twin {
                body: ConvexPolyhedron::sphere(DVec3::ZERO, radius)?,
                shape: SharedShape::new(Ball::new(radius)),
            },
            Self::Capsule => {
                let end = random.direction() * random.range(0.4, 1.0);
                let [a, b] = [-end, end].map(parry::convert_vector);
                Twin {
                    body: ConvexPolyhedron::capsule([-end, end], radius)?,
                    shape: SharedShape::new(Capsule::new(a, b, radius)),
                }
            }
            Self::Box => {
                let half = DVec3::from_array([(); 3].map(|()| random.range(0.4, 1.2)));
                Twin {
                    body: ConvexPolyhedron::cuboid(-half, half)?,
                    shape: SharedShape::new(Cuboid::new(parry::convert_vector(half))),
                }
            }
            Self::Hull(n) => {
                let body = Shape::Ellipsoid.draw(n, random)?;
                let shape = parry::convert_body(&body).ok_or("a body that parry rejects")?;
                Twin { body, shape: SharedShape::new(shape) }
            }
        })
    }
}

fn main() -> ExitCode {
    let about = "Compares casts and distances of rounded bodies with parry3d-f64; prints a table";
    harness::run("rounded", about, |run, own: &OwnArguments| {
        let legend = "ns: medians; ratio: parry's time over ours; wrong: answers of parry";
        let columns = "moving:<8; fixed:<8; vertices:>8; cast ns:>8.0=cast/ours/median_ns;
            parry ns:>8.0=cast/parry/median_ns; ratio:>7.2=cast/ratio; wrong:>6=cast/wrong;
            distance ns:>11.0=distance/ours/median_ns; parry ns:>8.0=distance/parry/median_ns;
            ratio:>7.2=distance/ratio; wrong:>6=distance/wrong";
        run.table(legend, columns);
        let hulls = run.sizes(&SIZES).into_iter().map(|n| [Kind::Sphere, Kind::Hull(n)]);
        let simple = [
            [Kind::Sphere, Kind::Sphere],
            [Kind::Sphere, Kind::Capsule],
            [Kind::Capsule, Kind::Capsule],
            [Kind::Sphere, Kind::Box],
            [Kind::Capsule, Kind::Box],
        ];
        for kinds in simple.into_iter().chain(hulls) {
            run.add(measure_row(kinds, run, Clock::new(own.repeat))?);
        }
        Ok(())
    })
}

/// Measures casts and distances of two kinds of bodies.
fn measure_row([p, q]: [Kind; 2], run: &Run, clock: Clock) -> Result<Value, Failure> {
    let vertices = if let Kind::Hull(n) = q { n } else { 0 };
    let mut random = run.random(&[vertices as u64, p.name().len() as u64, q.name().len() as u64]);
    let count = if vertices > 1_000 { 2 } else { 16 };
    let draw = |_| Ok([p.draw(&mut random)?, q.draw(&mut random)?]);
    let pairs = (0..count).map(draw).collect::<Result<Vec<[Twin; 2]>, Failure>>()?;
    let [mut casts, mut distances] = [Comparison::default(), Comparison::default()];
    let mut wrong = [0_u32; 2];
    for index in 0..run.choose(200, 1_000) {
        let [moving, fixed] = &pairs[index % pairs.len()];
        let from = random.direction() * random.range(3.0, 6.0);
        let aside = if index % 2 == 0 { DVec3::ZERO } else { random.direction() };
        let direction = (aside - from).normalize();
        let a = Pose::new(random.rotation(), from)?;
        let b = Pose::new(random.rotation(), DVec3::ZERO)?;
        let setting = ParrySetting::from_poses([&a, &b], direction);
        let (mine, theirs) = casts.compare_query(
            clock,
            || Cast::new(moving.body.at(a), fixed.body.at(b), direction)?.first_contact(),
            || setting.cast(&*moving.shape, &*fixed.shape),
        );
        let agree = match (mine?, theirs) {
            (Outcome::Contact(contact), Some(theirs)) => is_near(theirs, contact.certificate.lower),
            (Outcome::Contact(_), None) | (Outcome::Separated(_), Some(_)) => false,
            (Outcome::Grazing(_), _) | (Outcome::Separated(_), None) => true,
        };
        wrong[0] += u32::from(!agree);
        let (mine, theirs) = distances.compare_query(
            clock,
            || Pair::new(moving.body.at(a), fixed.body.at(b))?.distance(),
            || setting.distance(&*moving.shape, &*fixed.shape),
        );
        let lower = mine?.lower;
        wrong[1] += u32::from(!theirs.is_some_and(|theirs| is_near(theirs, lower)));
    }
    let figures = |compared: &Comparison, wrong: u32| {
        let ratio = compared.ratios.median();
        json!({ "ours": compared.ours, "parry": compared.theirs, "ratio": ratio, "wrong": wrong })
    };
    Ok(json!({
        "moving": p.name(), "fixed": q.name(), "vertices": vertices,
        "cast": figures(&casts, wrong[0]), "distance": figures(&distances, wrong[1]),
    }))
}

/// Checks whether an answer of parry is accurate to a share of the value.
fn is_near(theirs: f64, ours: f64) -> bool {
    (theirs - ours).abs() <= WRONG_SHARE * ours.abs()
}
