//! Plans, judged by what does not share the planner's code: boxes in the frame of each direction for how far it is, rays for
//! what is in the way. Only whether a shorter direction is free is asked of the library, pair by pair.

use std::collections::HashMap;

use colltrans::Aabb;
use colltrans::solid::{StartOverlap, Workspace};
use colltrans_assembly::sphere::Sphere;
use colltrans_assembly::{Bodies, Findings, Room};
use colltrans_testkit::random::Random;
use glam::{DVec2, DVec3};

/// Rays of each part of a step.
const RAYS: usize = 200;
/// Directions of the sphere that are asked beside those of the plan.
const SAMPLES: usize = 162;
/// How deep below its surface rays of a part begin, as a share of the assembly's size, beside the tolerance of each pair.
const BELOW: f64 = 1e-6;

/// What came of it.
#[derive(Default)]
pub(crate) struct Judged {
    /// Lengths of all steps in one straight move.
    pub(crate) travel: f64,
    /// The least that each of them may be, over all directions asked, added.
    pub(crate) least: f64,
    /// The largest ratio of the two.
    pub(crate) worst: f64,
    /// Rays from points of what moves, along its way.
    pub(crate) rays: usize,
    /// By step, those that meet what is left.
    pub(crate) crossing: Vec<(usize, usize)>,
}

impl Judged {
    pub(crate) fn of(found: &Findings) -> Self {
        let plan = &found.plan;
        let mut directions = found.matrix.directions().to_vec();
        directions.extend(plan.steps.iter().flat_map(|step| [step.direction, -step.direction]));
        directions.extend(Sphere::with_directions(SAMPLES).directions);
        let mut frames = Frames { bodies: found.bodies, known: HashMap::new() };
        let mut judged = Self::default();
        let mut workspace = Workspace::default();
        let size = found.bodies.assembly().size();
        let all: Vec<usize> = (0..found.bodies.len()).collect();
        let mut groups: HashMap<Option<usize>, Vec<usize>> = HashMap::from([(None, all)]);
        for (k, step) in plan.steps.iter().enumerate() {
            let left = groups
                .get_mut(&step.within)
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
            // What is short against all that is there is as good as nothing.
            if own > 1e-3 * size {
                judged.worst = judged.worst.max(own / least.max(1e-3 * size));
            }
            let crossing = crossing(found.bodies, &step.parts, &left, step.direction, k);
            judged.rays += RAYS * step.parts.len();
            if crossing > 0 {
                judged.crossing.push((k, crossing));
            }
        }
        judged
    }
}

fn is_free(
    bodies: &Bodies,
    group: &[usize],
    left: &[usize],
    d: DVec3,
    workspace: &mut Workspace,
) -> bool {
    let start = StartOverlap::Refuse;
    let mut pairs = group.iter().flat_map(|&a| left.iter().map(move |&b| [a, b]));
    pairs.all(|pair| bodies.room(pair, d, None, start, workspace) == Room::Free)
}

/// All parts in frames whose third axis is a direction.
struct Frames<'a> {
    bodies: &'a Bodies<'a>,
    known: HashMap<[u64; 3], Vec<Aabb>>,
}

impl Frames<'_> {
    /// How far a group goes until its boxes are beyond those of all that is left and beside its way.
    fn travel(&mut self, group: &[usize], left: &[usize], d: DVec3) -> f64 {
        let parts = self.bodies.assembly().parts();
        let boxes = self.known.entry(d.to_array().map(f64::to_bits)).or_insert_with(|| {
            let (u, v) = d.any_orthonormal_pair();
            let seen = |p: &DVec3| DVec3::new(p.dot(u), p.dot(v), p.dot(d));
            let around = |part: &colltrans_assembly::Part| {
                Aabb::of_points(part.solid().vertices().iter().map(seen))
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

/// How many rays from points below the surface of what moves meet what is left. Of two parts whose overlap at the start is
/// let pass nothing is asked.
fn crossing(bodies: &Bodies, group: &[usize], left: &[usize], d: DVec3, seed: usize) -> usize {
    let assembly = bodies.assembly();
    let (u, v) = d.any_orthonormal_pair();
    let flat = |p: DVec3| DVec2::new(p.dot(u), p.dot(v));
    let mut random = Random::new(seed as u64);
    let mut rays: Vec<Vec<Ray>> = Vec::new();
    for &part in group {
        let solid = assembly.parts()[part].solid();
        let below = BELOW * assembly.size() + bodies.fit().tolerance();
        let points = points(solid.vertices(), solid.triangles(), below, &mut random);
        rays.push(points.into_iter().map(|p| Ray { at: flat(p), from: p.dot(d) }).collect());
    }
    let mut crossing = 0;
    for (&part, rays) in group.iter().zip(&rays) {
        let (low, high) =
            rays.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), ray| {
                (low.min(ray.at), high.max(ray.at))
            });
        let mut met = vec![false; rays.len()];
        for &other in left
            .iter()
            .filter(|&&b| bodies.tolerated([part, b]).is_none() && !bodies.overlaps(part, b))
        {
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

/// A point as seen along a direction, which goes that way to infinity.
struct Ray {
    at: DVec2,
    from: f64,
}

impl Ray {
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

/// Points below facets, each drawn by its area.
fn points(
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
