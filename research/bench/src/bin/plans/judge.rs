//! Judges plans without the planner's code: boxes in the frame of each direction for the travel, rays for
//! obstructions. Only the freedom of shorter directions is determined by the library, pair by pair.

use std::collections::HashMap;

use colltrans::Aabb;
use colltrans::solid::{StartOverlap, Workspace};
use colltrans_assembly::sphere::Sphere;
use colltrans_assembly::{Analysis, Bodies, FreeTravel};
use colltrans_testkit::random::Random;
use glam::{DVec2, DVec3};

/// Number of rays of each part of a step.
const RAYS: usize = 200;
/// Number of directions of the sphere checked in addition to those of the plan.
const SAMPLES: usize = 162;
/// Depth of the ray origins below the surface, as a share of the assembly's size, in addition to the tolerance
/// of each pair.
const BELOW: f64 = 1e-6;

/// The result of the judgement.
#[derive(Default)]
pub(crate) struct PlanJudgement {
    /// Sum of the travels of all steps in one straight move.
    pub(crate) travel: f64,
    /// Sum of the least possible travels, over all checked directions.
    pub(crate) least: f64,
    /// The largest ratio of travel to least travel, over steps with a considerable travel.
    pub(crate) worst: f64,
    /// Number of rays from points of moving parts, along their way.
    pub(crate) rays: usize,
    /// For each step, the number of rays that meet the remaining parts.
    pub(crate) crossing: Vec<(usize, usize)>,
}

impl PlanJudgement {
    pub(crate) fn of(found: &Analysis) -> Self {
        let plan = &found.plan;
        let mut directions = found.matrix.directions().to_vec();
        directions.extend(plan.steps.iter().flat_map(|step| [step.direction, -step.direction]));
        directions.extend(Sphere::with_directions(SAMPLES).directions);
        let mut frames = DirectionFrames { bodies: found.bodies, known: HashMap::new() };
        let mut judged = Self::default();
        let mut workspace = Workspace::default();
        let size = found.bodies.assembly().coordinate_size();
        let all: Vec<usize> = (0..found.bodies.len()).collect();
        let mut groups: HashMap<Option<usize>, Vec<usize>> = HashMap::from([(None, all)]);
        for (k, step) in plan.steps.iter().enumerate() {
            let left = groups
                .get_mut(&step.group_step)
                .expect("a group is taken out before it is taken apart");
            left.retain(|part| !step.parts.contains(part));
            let left = left.clone();
            groups.insert(Some(k), step.parts.clone());
            let [leg] = &step.path[..] else { continue };
            if leg.turn.is_some() {
                continue;
            }
            let own = frames.travel(&step.parts, &left, step.direction);
            let mut least = own;
            for &d in &directions {
                let travel = frames.travel(&step.parts, &left, d);
                if travel < least && is_free(found.bodies, &step.parts, &left, d, &mut workspace) {
                    least = travel;
                }
            }
            judged.travel += own;
            judged.least += least;
            // Travels below 1e-3 of the assembly's size do not count.
            if own > 1e-3 * size {
                judged.worst = judged.worst.max(own / least.max(1e-3 * size));
            }
            let crossing = count_crossing_rays(found.bodies, &step.parts, &left, step.direction, k);
            judged.rays += RAYS * step.parts.len();
            if crossing > 0 {
                judged.crossing.push((k, crossing));
            }
        }
        judged
    }
}

/// Whether a group can leave along a direction.
fn is_free(
    bodies: &Bodies,
    group: &[usize],
    left: &[usize],
    d: DVec3,
    workspace: &mut Workspace,
) -> bool {
    let start = StartOverlap::Refuse;
    let mut pairs = group.iter().flat_map(|&a| left.iter().map(move |&b| [a, b]));
    pairs.all(|pair| bodies.free_travel(pair, d, None, start, workspace) == FreeTravel::Free)
}

/// The boxes of all parts in frames whose third axis is a direction.
struct DirectionFrames<'a> {
    bodies: &'a Bodies<'a>,
    known: HashMap<[u64; 3], Vec<Aabb>>,
}

impl DirectionFrames<'_> {
    /// Returns the travel of a group until its boxes are beyond those of the remaining parts that lie in its
    /// way.
    fn travel(&mut self, group: &[usize], left: &[usize], d: DVec3) -> f64 {
        let parts = self.bodies.assembly().parts();
        let boxes = self.known.entry(d.to_array().map(f64::to_bits)).or_insert_with(|| {
            let (u, v) = d.any_orthonormal_pair();
            let seen = |p: &DVec3| DVec3::new(p.dot(u), p.dot(v), p.dot(d));
            let around = |part: &colltrans_assembly::Part| {
                Aabb::from_points(part.solid().vertices().iter().map(seen))
            };
            parts.iter().map(around).collect()
        });
        let mut far = 0.0_f64;
        for (a, b) in group.iter().flat_map(|&a| left.iter().map(move |&b| (a, b))) {
            let (own, other) = (boxes[a], boxes[b]);
            let beside = (0..2).all(|k| own.low[k] <= other.high[k] && other.low[k] <= own.high[k]);
            if beside {
                far = far.max(other.high.z - own.low.z);
            }
        }
        far
    }
}

/// Counts the rays from points below the surface of the moving parts that meet remaining parts. Pairs with an
/// accepted overlap at the start are left out.
fn count_crossing_rays(
    bodies: &Bodies,
    group: &[usize],
    left: &[usize],
    d: DVec3,
    seed: usize,
) -> usize {
    let assembly = bodies.assembly();
    let (u, v) = d.any_orthonormal_pair();
    let flat = |p: DVec3| DVec2::new(p.dot(u), p.dot(v));
    let mut random = Random::new(seed as u64);
    let mut rays: Vec<Vec<ProjectedRay>> = Vec::new();
    for &part in group {
        let solid = assembly.parts()[part].solid();
        let below = BELOW * assembly.coordinate_size() + bodies.fit().tolerance();
        let points = draw_points(solid.vertices(), solid.triangles(), below, &mut random);
        rays.push(
            points.into_iter().map(|p| ProjectedRay { at: flat(p), from: p.dot(d) }).collect(),
        );
    }
    let mut crossing = 0;
    for (&part, rays) in group.iter().zip(&rays) {
        let (low, high) =
            rays.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), ray| {
                (low.min(ray.at), high.max(ray.at))
            });
        let mut met = vec![false; rays.len()];
        for &other in left.iter().filter(|&&b| {
            bodies.tolerated_contacts([part, b]).is_none() && !bodies.overlaps(part, b)
        }) {
            let solid = assembly.parts()[other].solid();
            for corners in solid.triangles() {
                let corners = corners.map(|k| solid.vertices()[k as usize]);
                let seen = corners.map(flat);
                let (least, most) =
                    (seen[0].min(seen[1]).min(seen[2]), seen[0].max(seen[1]).max(seen[2]));
                if least.cmpgt(high).any() || most.cmplt(low).any() {
                    continue;
                }
                for (ray, met) in rays.iter().zip(&mut met) {
                    *met |= ray.meets(corners.map(|p| p.dot(d)), seen);
                }
            }
        }
        crossing += met.into_iter().filter(|met| *met).count();
    }
    crossing
}

/// A point in the projection along a direction, with a ray to infinity.
struct ProjectedRay {
    at: DVec2,
    from: f64,
}

impl ProjectedRay {
    /// Whether the ray meets a triangle.
    fn meets(&self, heights: [f64; 3], [a, b, c]: [DVec2; 3]) -> bool {
        let whole = (b - a).perp_dot(c - a);
        let shares = [
            (c - b).perp_dot(self.at - b),
            (a - c).perp_dot(self.at - c),
            (b - a).perp_dot(self.at - a),
        ]
        .map(|part| part / whole);
        shares.iter().all(|share| *share > 0.0)
            && shares.iter().zip(heights).map(|(share, z)| share * z).sum::<f64>() > self.from
    }
}

/// Draws points below facets, each facet with its area as weight.
fn draw_points(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    below: f64,
    random: &mut Random,
) -> Vec<DVec3> {
    let corners = |t: &[u32; 3]| t.map(|k| vertices[k as usize]);
    let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
    let mut sums = Vec::with_capacity(triangles.len());
    let mut sum = 0.0;
    for t in triangles {
        sum += normal(corners(t)).length();
        sums.push(sum);
    }
    let draw = |_| {
        let at = random.unit() * sum;
        let t = sums.partition_point(|s| *s < at).min(triangles.len() - 1);
        let [a, b, c] = corners(&triangles[t]);
        let (mut x, mut y) = (random.unit(), random.unit());
        if x + y > 1.0 {
            (x, y) = (1.0 - x, 1.0 - y);
        }
        a + (b - a) * x + (c - a) * y - normal([a, b, c]).normalize_or_zero() * below
    };
    (0..RAYS).map(draw).collect()
}
