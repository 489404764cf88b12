//! Distance by the paper's approach (section V-F of Mirolo, Carpin, Pagello 2007): minimises the distance of pairs of
//! planar sections. Counts the steps, and compares the distance with enhanced GJK.
//!
//! ```text
//! cargo run --release -p colltrans-baselines --example section_distance -- [PAIRS] [SEED]
//! ```
//!
//! - `f(x, y)` is the distance of the section of `P` at level `x` and that of `Q` at level `y`. It is convex, because
//!   it is the minimum of a convex function over part of its variables.
//! - A step computes `f` and its gradient at the centroid of the remaining region, from the nearest points of both
//!   sections. These lie on a face, on an edge, or inside of a section.
//! - *Cell*: the distance of the touching features bounds the answer from above. It replaces the paper's best point.
//! - *Exit*: the supporting planes perpendicular to the nearest points of these features prove the distance.
//! - *Cut*: the region is cut where the linear lower bound of `f` exceeds the upper bound.
//!
//! Sections are computed by brute force, so times mean nothing. The steps do not depend on this.

use std::process::ExitCode;

use colltrans::{ConvexPolyhedron, Pose};
use colltrans_baselines::egjk::Egjk;
use colltrans_testkit::bodies::body;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::ring_sphere;
use glam::{DVec2, DVec3};

/// Numbers of vertices around and of rings.
const SIZES: [u32; 4] = [8, 16, 32, 64];

/// Maximum number of steps.
const MAX_STEPS: u32 = 100;

/// Gap between the bounds at which the distance counts as proven.
const PRECISION: f64 = 1e-9;

fn main() -> ExitCode {
    let mut words = std::env::args().skip(1).map(|word| word.parse::<u64>());
    let (Ok(pairs), Ok(seed)) = (words.next().unwrap_or(Ok(100)), words.next().unwrap_or(Ok(1)))
    else {
        eprintln!("section_distance [PAIRS] [SEED]");
        return ExitCode::from(2);
    };
    let mut worst = 0.0_f64;
    for around in SIZES {
        let mut rng = Random::new(seed);
        let [mut steps, mut iterations, mut unproven] = [0; 3];
        for _ in 0..pairs {
            let [p, q] = [0, 1].map(|_| {
                let axes = DVec3::from_array([0; 3].map(|_| rng.range(0.6, 1.4)));
                ring_sphere(around, around).mapped(|v| v * axes)
            });
            let turn = rng.rotation();
            let away = rng.direction() * rng.range(3.0, 6.0);
            let p = body(&p.mapped(|v| turn * v + away).vertices);
            let q = body(&q.vertices);
            let found = minimise([&p, &q], [turn * DVec3::X, DVec3::Y]);
            let exact = nearest(&p, &q);
            let error = (found.distance - exact.distance).abs();
            worst = worst.max(if found.is_proven { error } else { 0.0 });
            steps += if found.is_proven { found.steps } else { 0 };
            iterations += exact.steps;
            unproven += u32::from(!found.is_proven);
        }
        let vertices = around * around + 2;
        let proven = pairs - u64::from(unproven);
        let [steps, iterations] =
            [(steps, proven), (iterations, pairs)].map(|(sum, of)| f64::from(sum) / of as f64);
        println!(
            "{vertices:>6} vertices: {steps:.1} steps on average, {unproven} unproven; enhanced GJK {iterations:.1} \
             iterations"
        );
    }
    println!("largest error of a proven distance: {worst:.1e}");
    if worst <= 2.0 * PRECISION { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Result of a minimisation.
struct Found {
    distance: f64,
    steps: u32,
    is_proven: bool,
}

/// Nearest points of two bodies.
struct Nearest {
    distance: f64,
    points: [DVec3; 2],
    steps: u32,
}

/// Returns the nearest points of two bodies in the world, from scratch.
fn nearest(p: &ConvexPolyhedron, q: &ConvexPolyhedron) -> Nearest {
    let found = Egjk::new(p, q).distance(&Pose::IDENTITY, &Pose::IDENTITY);
    let points = [found.on_moving, found.on_fixed];
    Nearest { distance: found.distance, points, steps: found.steps.iterations }
}

/// Minimises the distance of the sections across two axes.
fn minimise(bodies: [&ConvexPolyhedron; 2], axes: [DVec3; 2]) -> Found {
    let range = |k: usize| {
        let levels = bodies[k].vertices().iter().map(|v| axes[k].dot(*v));
        levels.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)])
    };
    let [[a, b], [c, d]] = [range(0), range(1)];
    let mut region = [[a, c], [b, c], [b, d], [a, d]].map(DVec2::from_array).to_vec();
    let mut best = f64::INFINITY;
    for steps in 1..=MAX_STEPS {
        let Some(levels) = centroid(&region) else { break };
        let sections = [0, 1].map(|k| Section::new(bodies[k], axes[k], levels[k]));
        let [Some(p), Some(q)] = sections else { break };
        let here = nearest(&p.polygon, &q.polygon);
        if here.distance == 0.0 {
            return Found { distance: 0.0, steps, is_proven: true };
        }
        let normal = (here.points[1] - here.points[0]) / here.distance;
        let [on_p, on_q] = [p.touch(here.points[0], normal), q.touch(here.points[1], normal)];
        let cell = nearest(&on_p.feature, &on_q.feature);
        best = best.min(cell.distance);
        if best - lower_bound(bodies, &cell) <= PRECISION {
            return Found { distance: best, steps, is_proven: true };
        }
        let gradient = DVec2::new(-normal.dot(on_p.drift), normal.dot(on_q.drift));
        region = clipped(&region, gradient, gradient.dot(levels) + best - here.distance);
    }
    Found { distance: best, steps: MAX_STEPS, is_proven: false }
}

/// Returns the distance of the supporting planes perpendicular to two nearest points.
fn lower_bound([p, q]: [&ConvexPolyhedron; 2], near: &Nearest) -> f64 {
    let Some(normal) = (near.points[1] - near.points[0]).try_normalize() else { return 0.0 };
    let extreme = |body: &ConvexPolyhedron, along: DVec3| {
        body.vertices().iter().map(|v| along.dot(*v)).fold(f64::NEG_INFINITY, f64::max)
    };
    -extreme(q, -normal) - extreme(p, normal)
}

/// The section of a body at a level.
struct Section<'a> {
    body: &'a ConvexPolyhedron,
    axis: DVec3,
    /// Vertices, each with its edge of the body.
    corners: Vec<(DVec3, [u32; 2])>,
    polygon: ConvexPolyhedron,
}

/// The place of a point of a section on the body.
struct Touch {
    /// The face, the edge, or the whole body if the point is inside the section.
    feature: ConvexPolyhedron,
    /// Motion of the point on the feature, up to a motion across the normal, when the level rises by 1.
    drift: DVec3,
}

impl<'a> Section<'a> {
    /// Computes the section; `None` if it has no area.
    fn new(body: &'a ConvexPolyhedron, axis: DVec3, level: f64) -> Option<Self> {
        let at = |v: u32| body.vertices()[v as usize];
        let mut corners = Vec::new();
        for low in 0..body.vertices().len() as u32 {
            for &high in body.neighbours(low) {
                let [x, y] = [low, high].map(|v| axis.dot(at(v)) - level);
                if x < 0.0 && y >= 0.0 {
                    corners.push((at(low).lerp(at(high), x / (x - y)), [low, high]));
                }
            }
        }
        let points: Vec<_> = corners.iter().map(|(point, _)| *point).collect();
        let polygon = ConvexPolyhedron::from_points(&points).ok()?;
        (points.len() > 2).then_some(Self { body, axis, corners, polygon })
    }

    /// Finds the feature of the body on which a point of the section lies.
    fn touch(&self, point: DVec3, normal: DVec3) -> Touch {
        let near = 1e-9;
        let at = |v: u32| self.body.vertices()[v as usize];
        if let Some((_, edge)) = self.corners.iter().find(|(c, _)| c.distance(point) < near) {
            let along = at(edge[1]) - at(edge[0]);
            let feature = body(&edge.map(at));
            return Touch { feature, drift: along / self.axis.dot(along) };
        }
        let crossed = |face: &u32| {
            let own: Vec<u32> = self.body.face_vertices(*face).collect();
            let ends = self.corners.iter().filter(|(_, edge)| edge.iter().all(|v| own.contains(v)));
            let ends: Vec<_> = ends.map(|(c, _)| *c).collect();
            let [a, b] = ends[..] else { return false };
            let along = (b - a).normalize();
            (point - a).cross(along).length() < near
                && (0.0..=a.distance(b)).contains(&(point - a).dot(along))
        };
        if let Some(face) = (0..self.body.face_count() as u32).find(crossed) {
            let outward = self.body.face_normal(face);
            let climb = self.axis - outward * outward.dot(self.axis);
            let feature = body(&self.body.face_vertices(face).map(at).collect::<Vec<_>>());
            return Touch { feature, drift: climb / self.axis.dot(climb) };
        }
        // Inside, the normal is parallel to the axis.
        let feature = self.body.clone();
        Touch { feature, drift: normal * normal.dot(self.axis).recip() }
    }
}

/// Returns the part of a convex polygon where `g . z <= limit`.
fn clipped(polygon: &[DVec2], gradient: DVec2, limit: f64) -> Vec<DVec2> {
    let mut rest = Vec::new();
    for (k, &a) in polygon.iter().enumerate() {
        let b = polygon[(k + 1) % polygon.len()];
        let [over_a, over_b] = [a, b].map(|z| gradient.dot(z) - limit);
        if over_a <= 0.0 {
            rest.push(a);
        }
        if (over_a < 0.0) != (over_b < 0.0) && over_a != over_b {
            rest.push(a.lerp(b, over_a / (over_a - over_b)));
        }
    }
    rest
}

/// Returns the centroid of a convex polygon; `None` if it has no area.
fn centroid(polygon: &[DVec2]) -> Option<DVec2> {
    let (&first, rest) = polygon.split_first()?;
    let (mut sum, mut area) = (DVec2::ZERO, 0.0);
    for pair in rest.windows(2) {
        let part = (pair[0] - first).perp_dot(pair[1] - first);
        sum += (first + pair[0] + pair[1]) * (part / 3.0);
        area += part;
    }
    (area > 0.0).then(|| sum / area)
}
