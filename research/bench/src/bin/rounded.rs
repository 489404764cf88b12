//! `rounded`: compares casts and distances of spheres, capsules, boxes, hulls and meshes with `parry3d-f64`, in one run
//! on the same settings. Of meshes, the table has the number of facets in place of that of vertices.
//!
//! Bodies have random radii, sides and orientations. Half of the casts are aimed at the fixed body's centre, the others
//! beside it. Both libraries answer each setting, in turns. *Bounds* are distances without points and proofs, which is
//! what parry returns. The figures are medians of the times and of the settings'
//! ratios. Parry's answer is *wrong* if it differs from our bounds by more than a share of the distance.

use std::process::ExitCode;

use clap::Args;
use colltrans::solid::{SolidCast, SolidContact, SolidPair};
use colltrans::{
    Cast, CastBody, Contact, ConvexPolyhedron, Outcome, Pair, PairBody, Pose, QueryError,
};
use colltrans_bench::harness::{self, Failure, Run, merge_objects};
use colltrans_bench::meshes::solid_from_mesh;
use colltrans_bench::parry::{self, ParrySetting, triangle_mesh};
use colltrans_bench::shapes;
use colltrans_bench::times::{Clock, Comparison};
use colltrans_testkit::random::Random;
use colltrans_testkit::solids::bumpy_ball;
use glam::DVec3;
use parry3d_f64::shape::{Ball, Capsule, Cuboid, Shape, SharedShape};
use serde_json::{Value, json};

#[derive(Debug, Args)]
struct OwnArguments {
    /// Run each query N times in a row, and take the mean
    #[arg(long, value_name = "N", default_value_t = 16)]
    repeat: u32,
}

/// Numbers of vertices of hulls.
const SIZES: [usize; 5] = [32, 128, 2_000, 20_000, 200_000];

/// Numbers of facets of meshes.
const MESH_SIZES: [usize; 2] = [16_000, 1_000_000];

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
                let body = shapes::Shape::Ellipsoid.draw(n, random)?;
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
            ratio:>7.2=distance/ratio; wrong:>6=distance/wrong; bounds ns:>9.0=bounds/ours/median_ns;
            ratio:>7.2=bounds/ratio; wrong:>6=bounds/wrong";
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
        for facets in MESH_SIZES {
            run.add(measure_mesh_row(facets, run, Clock::new(own.repeat))?);
        }
        Ok(())
    })
}

/// Queries of this library about setting `k`.
struct Ours<C, P, L> {
    cast: C,
    pair: P,
    /// Returns the lower bound of the translation at a contact.
    lower: L,
}

/// Measures casts and distances of two kinds of bodies.
fn measure_row([p, q]: [Kind; 2], run: &Run, clock: Clock) -> Result<Value, Failure> {
    let vertices = if let Kind::Hull(n) = q { n } else { 0 };
    let mut random = run.random(&[vertices as u64, p.name().len() as u64, q.name().len() as u64]);
    let count = if vertices > 1_000 { 2 } else { 16 };
    let draw = |_| Ok([p.draw(&mut random)?, q.draw(&mut random)?]);
    let pairs = (0..count).map(draw).collect::<Result<Vec<[Twin; 2]>, Failure>>()?;
    let bodies = |k: usize, poses: [Pose; 2]| {
        let [moving, fixed] = &pairs[k % pairs.len()];
        [moving.body.at(poses[0]), fixed.body.at(poses[1])]
    };
    let ours = Ours {
        cast: |k, poses, direction| {
            let [moving, fixed] = bodies(k, poses);
            Cast::new(moving, fixed, direction)
        },
        pair: |k, poses| {
            let [moving, fixed] = bodies(k, poses);
            Pair::new(moving, fixed)
        },
        lower: |contact: &Contact| contact.certificate.lower,
    };
    let shapes = |k: usize| pairs[k % pairs.len()].each_ref().map(|twin| &*twin.shape);
    let figures = measure_settings(run.choose(200, 1_000), clock, &mut random, shapes, &ours)?;
    let names = json!({ "moving": p.name(), "fixed": q.name(), "vertices": vertices });
    Ok(merge_objects(names, figures))
}

/// Measures casts and distances of spheres and a mesh. Parry's mesh is a `TriMesh`.
fn measure_mesh_row(facets: usize, run: &Run, clock: Clock) -> Result<Value, Failure> {
    let mut random = run.random(&[facets as u64]);
    let mesh = solid_from_mesh(&bumpy_ball(facets)).ok_or("a mesh that is rejected")?;
    let shape = triangle_mesh(mesh.vertices(), mesh.triangles());
    let draw = |_| Kind::Sphere.draw(&mut random);
    let spheres = (0..16).map(draw).collect::<Result<Vec<Twin>, Failure>>()?;
    let sphere = |k: usize| &spheres[k % spheres.len()];
    let ours = Ours {
        cast: |k, [a, b]: [Pose; 2], direction| {
            Cast::between(sphere(k).body.at(a), mesh.at(b), direction)
        },
        pair: |k, [a, b]: [Pose; 2]| Pair::between(sphere(k).body.at(a), mesh.at(b)),
        lower: |contact: &SolidContact| contact.translation.lower,
    };
    let shapes = |k: usize| [&*sphere(k).shape, &shape as &dyn Shape];
    let figures = measure_settings(run.choose(100, 400), clock, &mut random, shapes, &ours)?;
    let count = mesh.triangles().len();
    Ok(merge_objects(json!({ "moving": "sphere", "fixed": "mesh", "vertices": count }), figures))
}

/// Draws settings, and sends each to both libraries.
fn measure_settings<'a, B: CastBody + PairBody + 'a>(
    count: usize,
    clock: Clock,
    random: &mut Random,
    shapes: impl Fn(usize) -> [&'a dyn Shape; 2],
    ours: &Ours<
        impl Fn(usize, [Pose; 2], DVec3) -> Result<Cast<'a, B>, QueryError>,
        impl Fn(usize, [Pose; 2]) -> Result<Pair<'a, B>, QueryError>,
        impl Fn(&B::Contact) -> f64,
    >,
) -> Result<Value, Failure> {
    let [mut casts, mut distances, mut bounds] = [(); 3].map(|()| Comparison::default());
    let mut wrong = [0_u32; 3];
    for k in 0..count {
        let [moving, fixed] = shapes(k);
        let from = random.direction() * random.range(3.0, 6.0);
        let aside = if k % 2 == 0 { DVec3::ZERO } else { random.direction() };
        let direction = (aside - from).normalize();
        let poses =
            [Pose::new(random.rotation(), from)?, Pose::new(random.rotation(), DVec3::ZERO)?];
        let setting = ParrySetting::from_poses(poses.each_ref(), direction);
        let (mine, theirs) = casts.compare_query(
            clock,
            || (ours.cast)(k, poses, direction)?.first_contact(),
            || setting.cast(moving, fixed),
        );
        let agree = match (mine?, theirs) {
            (Outcome::Contact(contact), Some(theirs)) => is_near(theirs, (ours.lower)(&contact)),
            (Outcome::Contact(_), None) | (Outcome::Separated(_), Some(_)) => false,
            (Outcome::Grazing(_), _) | (Outcome::Separated(_), None) => true,
        };
        wrong[0] += u32::from(!agree);
        let (mine, theirs) = distances.compare_query(
            clock,
            || (ours.pair)(k, poses)?.distance(),
            || setting.distance(moving, fixed),
        );
        let is_wrong =
            |theirs: Option<f64>, ours| !theirs.is_some_and(|theirs| is_near(theirs, ours));
        wrong[1] += u32::from(is_wrong(theirs, mine?.lower));
        let (mine, theirs) = bounds.compare_query(
            clock,
            || (ours.pair)(k, poses)?.distance_bounds(),
            || setting.distance(moving, fixed),
        );
        wrong[2] += u32::from(is_wrong(theirs, mine?[0]));
    }
    let figures = |compared: &Comparison, wrong: u32| {
        let ratio = compared.ratios.median();
        json!({ "ours": compared.ours, "parry": compared.theirs, "ratio": ratio, "wrong": wrong })
    };
    Ok(json!({
        "cast": figures(&casts, wrong[0]),
        "distance": figures(&distances, wrong[1]),
        "bounds": figures(&bounds, wrong[2]),
    }))
}

/// Checks whether an answer of parry is accurate to a share of the value.
fn is_near(theirs: f64, ours: f64) -> bool {
    (theirs - ours).abs() <= WRONG_SHARE * ours.abs()
}
