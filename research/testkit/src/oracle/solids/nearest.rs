//! Judges distances of solids exactly: over all pairs of facets in rational arithmetic, and whether one body is
//! inside the other.
//!
//! The distance of two triangles is that of their corners by [`distance`], which tries all faces of simplices.
//! Pairs are processed in the order of the lower bounds given by enclosing balls, so that few are evaluated. A
//! closed body contains a point if a ray from it in a general direction leaves the body more often than it
//! enters it.

use colltrans::solid::{Apart, Claim, SolidNear, SolidPair};
use colltrans::{ConvexPolyhedron, Distance, Pair, Pose, Solid, Within};
use glam::DVec3;

use super::facets::{Triangle, triangles};
use super::proof::once;
use super::settings as cubes;
use super::sheets;
use crate::oracle::distance::distance;
use crate::oracle::exact::{Dyadic, Ratio, Vector};
use crate::oracle::scene::size;
use crate::oracle::settings as convex;
use crate::random::Random;
use crate::shapes::{Mesh, prism};
use crate::solids::{bumpy_ball, perforated_plate, slab, washer};

/// Maximum difference of the bounds in noises.
const WIDEST: f64 = 5.0;
/// Maximum number of pairs of facets that are counted one by one.
const MOST_PAIRS: usize = 4_000;

/// The families of meshes. The families of [`cubes`], [`sheets`] and convex bodies are available as well.
pub const MESHES: [&str; 4] = ["balls", "hollow", "thin", "mixed"];

/// The outcome, for statistics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum DistanceOutcome {
    /// The surfaces have a common point.
    Touching,
    /// One body is inside the other.
    Inside,
    /// The distance is less than a millionth of the size.
    Near,
    /// The distance is larger.
    Apart,
}

/// Two placed solids.
#[derive(Debug, Clone)]
pub struct Setting {
    /// The moving and the fixed body.
    pub solids: [Solid; 2],
    /// Their poses.
    pub poses: [Pose; 2],
}

impl Setting {
    /// Draws the setting of a family with a seed; `None` for bodies that are not solids.
    ///
    /// # Errors
    /// A message if the family is unknown, or the library rejects a body.
    pub fn draw(family: &str, seed: u64) -> Result<Option<Self>, String> {
        let random = &mut Random::stream(seed, &[family.len() as u64, 0xd157]);
        let Some(drawn) = draw_setting(family, seed, random)? else { return Ok(None) };
        drawn.displaced(random).map(Some)
    }

    /// Leaves the setting, increases the distance, or brings the bodies to a very small distance.
    fn displaced(mut self, random: &mut Random) -> Result<Self, String> {
        let size =
            self.solids.iter().map(|s| s.bounds().side_lengths().length()).fold(0.0, f64::max);
        let little = [1e-15, 1e-13, 1e-10, 1e-7, 1e-3];
        let by = match random.int(0, 5) {
            0 => 0.0,
            1 => size * random.range(0.2, 2.0),
            _ => size * random.pick(&little),
        };
        let way = if random.one_in(2) { random.pick(&DVec3::AXES) } else { random.direction() };
        let way = if random.one_in(2) { way } else { -way };
        self.poses[0] = translated_pose(&self.poses[0], way * by)?;
        if random.one_in(4) {
            self.brought_near(size * random.pick(&little))?;
        }
        Ok(self)
    }

    /// Moves the moving body to a gap from the fixed one, along the normal of their distance.
    fn brought_near(&mut self, gap: f64) -> Result<(), String> {
        let found = self.pair()?.distance().map_err(|e| e.to_string())?;
        if let Some(normal) = found.normal {
            self.poses[0] = translated_pose(&self.poses[0], normal * (found.lower - gap))?;
        }
        Ok(())
    }

    /// Builds the pair.
    ///
    /// # Errors
    /// The message of the library if it rejects the pair.
    pub fn pair(&self) -> Result<Pair<'_, Solid>, String> {
        let [a, b] = &self.solids;
        Pair::new(a.at(self.poses[0]), b.at(self.poses[1])).map_err(|e| e.to_string())
    }

    /// Computes the distance, and judges it.
    ///
    /// # Errors
    /// A description of the first disagreement.
    pub fn examine(&self) -> Result<DistanceOutcome, String> {
        let pair = self.pair()?;
        let placed = [0, 1].map(|k| {
            let (solid, pose) = (&self.solids[k], &self.poses[k]);
            triangles(solid.vertices(), solid.triangles(), (pose.matrix(), pose.translation()))
        });
        let square = surfaces(&placed);
        let inside = !square.is_zero() && self.is_inside(&pair, &placed)?;
        let noise = self.noise();
        // The squared distance of the cores, and the radii.
        let right = if inside { Ratio::from_f64(0.0) } else { square };
        let [r, s] = self.solids.each_ref().map(Solid::radius);
        let swept = &Dyadic::new(r) + &Dyadic::new(s);
        let (found, proof) = pair.certified_distance().map_err(|e| e.to_string())?;
        let plain = pair.distance().map_err(|e| e.to_string())?;
        let say = |what: &str| format!("{what}: {found:?}, not {}", right.sqrt_to_f64());
        pair.verify(&proof).map_err(|e| say(&e.to_string()))?;
        for distance in [&found, &plain] {
            check_bounds(distance, (&right, &swept), noise).map_err(say)?;
        }
        check_points(&found.near, &placed, &swept).map_err(say)?;
        self.check_surface_points(&found, noise).map_err(say)?;
        if found.lower > 0.0 && placed[0].len() * placed[1].len() <= MOST_PAIRS {
            let claims: Vec<Claim<Apart>> =
                proof.cover.claims(&pair).ok_or("the cover does not fit")?;
            once([placed[0].len(), placed[1].len()], &claims)?;
        }
        let length = (right.sqrt_to_f64() - swept.to_f64()).max(0.0);
        for length in [0.0, 0.5 * length, length, 1.5 * length, length + 8.0 * noise] {
            check_within(&pair, length, (&right, &swept)).map_err(say)?;
        }
        let size = noise / (16.0 * f64::EPSILON);
        let meets = right <= square_between_cores(0.0, &swept);
        Ok(match (inside, meets) {
            (true, _) => DistanceOutcome::Inside,
            (_, true) => DistanceOutcome::Touching,
            _ if length < 1e-6 * size => DistanceOutcome::Near,
            _ => DistanceOutcome::Apart,
        })
    }

    /// Returns the size `S` of the setting.
    pub fn reach(&self) -> f64 {
        self.noise() / (16.0 * f64::EPSILON)
    }

    /// Returns the noise, `32 u S`.
    fn noise(&self) -> f64 {
        let vertices = self.solids.each_ref().map(Solid::vertices);
        let radii: f64 = self.solids.each_ref().map(Solid::radius).iter().sum();
        16.0 * f64::EPSILON * (size(vertices, self.poses.each_ref()) + radii)
    }

    /// Returns the setting with rounded solids. A radius is often about the distance of the solids.
    ///
    /// # Errors
    /// The message of the library if it rejects the pair or a radius.
    pub fn rounded(self, random: &mut Random) -> Result<Self, String> {
        let distance = self.pair()?.distance().map_err(|e| e.to_string())?.upper;
        let size =
            self.solids.iter().map(|s| s.bounds().side_lengths().length()).fold(0.0, f64::max);
        let mut radius = || match random.index(5) {
            0 => 0.0,
            1 => distance,
            2 => distance * random.range(0.0, 1.0),
            3 => 0.5 * distance,
            _ => size * 10.0_f64.powf(random.range(-9.0, 0.0)),
        };
        let radii = [radius(), radius()].map(|r| if r < 1e-60 { 0.0 } else { r });
        let Self { solids: [a, b], poses } = self;
        let rounded = |solid: Solid, radius| solid.rounded(radius).map_err(|e| e.to_string());
        Ok(Self { solids: [rounded(a, radii[0])?, rounded(b, radii[1])?], poses })
    }

    /// Checks that the points of an answer are at its distance, and at the radii from the cores.
    fn check_surface_points(
        &self,
        found: &Distance<Solid>,
        noise: f64,
    ) -> Result<(), &'static str> {
        // Points are rounded to coordinates of the world, and those below the range of bodies become zero.
        let points = [found.on_moving, found.on_fixed];
        let largest = points.map(|point| point.abs().max_element()).into_iter().fold(0.0, f64::max);
        let allowed = 64.0 * noise + 4.0 * f64::EPSILON * largest;
        let apart = found.on_moving.distance(found.on_fixed);
        if found.lower > 0.0 && (apart - found.upper).abs() > allowed {
            return Err("points apart");
        }
        let in_range = |x: f64| if x.abs() < 1e-60 { 0.0 } else { x };
        for ((solid, pose), point) in self.solids.iter().zip(&self.poses).zip(points) {
            let point = DVec3::from_array(point.to_array().map(in_range));
            let probe = ConvexPolyhedron::from_points(&[point]).map_err(|_| "point")?;
            let pair =
                Pair::between(probe.at(Pose::IDENTITY), solid.at(*pose)).map_err(|_| "pair")?;
            // The distance of the point from the rounded solid.
            let off = pair.distance().map_err(|_| "probe")?.lower;
            if off > allowed {
                return Err("point off the body");
            }
        }
        Ok(())
    }

    /// Checks whether one of two bodies with disjoint surfaces contains a part of the other.
    fn is_inside(&self, pair: &Pair<Solid>, placed: &[Vec<Triangle>; 2]) -> Result<bool, String> {
        let [a, b] = &self.solids;
        if !(a.is_closed() && b.is_closed()) {
            // The closed part of an open body is determined by the library, which is judged elsewhere.
            let [p, q] = [a.at(pair.moving_pose()), b.at(pair.fixed_pose())];
            let cast = colltrans::Cast::new(p, q, DVec3::X).map_err(|e| e.to_string())?;
            return Ok(cast.intersects().map_err(|e| e.to_string())?.meets);
        }
        Ok([0, 1]
            .into_iter()
            .any(|k| placed[k].iter().any(|corners| holds(&placed[1 - k], &corners[0]))))
    }
}

fn translated_pose(pose: &Pose, by: DVec3) -> Result<Pose, String> {
    // Coordinates below the range of translations become zero.
    let at = (pose.translation() + by).to_array().map(|x| if x.abs() < 1e-60 { 0.0 } else { x });
    Pose::from_matrix(pose.matrix(), DVec3::from_array(at)).map_err(|e| e.to_string())
}

fn draw_setting(family: &str, seed: u64, random: &mut Random) -> Result<Option<Setting>, String> {
    let made = |(vertices, facets): &(Vec<DVec3>, Vec<Vec<u32>>)| {
        Solid::from_mesh(vertices, facets).map_err(|e| e.to_string())
    };
    if let Some(of) = cubes::Setting::draw(family, seed) {
        let solids = [made(&of.surfaces[0])?, made(&of.surfaces[1])?];
        return Ok(Some(Setting { solids, poses: of.poses }));
    }
    if sheets::FAMILIES.contains(&family) {
        let of = sheets::Setting::draw(family, seed)?;
        return Ok(Some(Setting { solids: of.solids, poses: of.poses }));
    }
    if let Some(name) = family.strip_prefix("convex-") {
        let of = convex::setting(name, seed);
        let bodies = of.bodies().map_err(|e| e.to_string())?;
        let solids = [&bodies.moving, &bodies.fixed].map(|body| Solid::from_convex(body).ok());
        let [Some(a), Some(b)] = solids else { return Ok(None) };
        return Ok(Some(Setting { solids: [a, b], poses: [of.moving_pose, of.fixed_pose] }));
    }
    if !MESHES.contains(&family) {
        return Err(format!("no such family: {family}"));
    }
    let solids = [draw_mesh(family, random), draw_mesh(family, random)]
        .map(|mesh| Solid::from_open_mesh(&mesh.vertices, &mesh.faces).map_err(|e| e.to_string()));
    let [a, b] = solids;
    let mut pose = |near: f64| {
        // Sometimes one body is inside the other.
        let near = near * random.pick(&[0.1, 1.0]);
        let rotation = if random.one_in(4) { glam::DQuat::IDENTITY } else { random.rotation() };
        Pose::new(rotation, random.direction() * near).map_err(|e| e.to_string())
    };
    let poses = [pose(1.5)?, pose(0.5)?];
    Ok(Some(Setting { solids: [a?, b?], poses }))
}

fn draw_mesh(family: &str, random: &mut Random) -> Mesh {
    let ball = |random: &mut Random| bumpy_ball(random.pick(&[12, 48, 108]));
    let thin = |random: &mut Random| {
        let thin = 10.0_f64.powf(random.range(-13.0, -1.0));
        match random.int(0, 3) {
            0 => slab(DVec3::NEG_ONE, DVec3::new(1.0, 1.0, thin - 1.0), [2, 3, 1]),
            1 => washer([0.5, 0.5 + thin], [0.0, 1.0], 7),
            2 => perforated_plate([1, 1], thin, 6),
            _ => prism(5, 1.0).mapped(|v| DVec3::new(v.x, v.y * thin, v.z)),
        }
    };
    match (family, random.int(0, 2)) {
        ("balls", _) | ("mixed", 0) => ball(random),
        ("hollow", 0) => {
            let outer = ball(random).mapped(|v| v * 2.5);
            outer.joined(&ball(random).mapped(|v| v * 1.5).reversed())
        }
        ("hollow", _) => ball(random).mapped(|v| v * 0.3),
        ("mixed", 1) => {
            // A closed surface from which facets are removed.
            let mut open = ball(random);
            open.faces.truncate(open.faces.len() * 3 / 4);
            open
        }
        _ => thin(random),
    }
}

/// Returns the squared distance of two surfaces.
///
/// # Panics
/// If a surface has no facets.
pub fn surfaces([moving, fixed]: &[Vec<Triangle>; 2]) -> Ratio {
    let origin = moving[0][0].clone();
    let balls = |all: &[Triangle]| -> Vec<(DVec3, f64)> {
        all.iter()
            .map(|t| {
                let [a, b, c] = t.each_ref().map(|v| v.minus(&origin).to_f64());
                let center = (a + b + c) / 3.0;
                (center, [a, b, c].map(|v| v.distance(center)).into_iter().fold(0.0, f64::max))
            })
            .collect()
    };
    let (p, q) = (balls(moving), balls(fixed));
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (i, (a, r)) in p.iter().enumerate() {
        for (j, (b, s)) in q.iter().enumerate() {
            pairs.push((((a.distance(*b) - r - s).max(0.0)) * (1.0 - 1e-9) - 1e-12, i, j));
        }
    }
    pairs.sort_by(|x, y| x.0.total_cmp(&y.0));
    let mut best: Option<(f64, Ratio)> = None;
    for (least, i, j) in pairs {
        if let Some((length, square)) = &best
            && (least > *length || square.is_zero())
        {
            break;
        }
        let found = distance(&moving[i], &fixed[j]);
        if best.as_ref().is_none_or(|(_, square)| found.square < *square) {
            best = Some((found.to_f64(), found.square));
        }
    }
    best.expect("bodies have facets").1
}

/// Checks whether a closed body contains a point that is not on its surface.
fn holds(body: &[Triangle], point: &Vector) -> bool {
    for way in [[3.0, 5.0, 7.0], [-11.0, 2.0, 13.0], [17.0, -19.0, 3.0], [1.0, 23.0, -29.0]] {
        let way = Vector::new(DVec3::from_array(way));
        let crossings: Option<i32> = body.iter().map(|t| ray_crossing(t, point, &way)).sum();
        if let Some(winding) = crossings {
            return winding > 0;
        }
    }
    // Four directions along edges are extremely improbable.
    false
}

/// Returns 1 if a ray leaves through a facet, -1 if it enters, and 0 if it misses the facet; `None` if it
/// passes an edge.
fn ray_crossing(triangle: &Triangle, point: &Vector, way: &Vector) -> Option<i32> {
    let [a, b, c] = triangle.each_ref().map(|v| v.minus(point));
    let turns = [(&a, &b), (&b, &c), (&c, &a)].map(|(u, v)| u.cross(v).dot(way));
    if turns.iter().any(Dyadic::is_zero) {
        return None;
    }
    let up = turns[0].is_positive();
    if turns.iter().any(|turn| turn.is_positive() != up) {
        return Some(0);
    }
    // The intersection is ahead if the point is on the appropriate side of the facet's plane.
    let ahead = a.cross(&b).dot(&c).is_positive() == up;
    Some(if !ahead {
        0
    } else if up {
        1
    } else {
        -1
    })
}

/// Returns the square of a length plus the radii.
fn square_between_cores(length: f64, swept: &Dyadic) -> Ratio {
    let sum = &Dyadic::new(length) + swept;
    Ratio::new(&sum * &sum, Dyadic::new(1.0))
}

/// Checks that the bounds hold and are close enough, for a squared distance of the cores and the sum of the radii.
fn check_bounds(
    found: &Distance<Solid>,
    (right, swept): (&Ratio, &Dyadic),
    noise: f64,
) -> Result<(), &'static str> {
    let is_rounded = !swept.is_zero();
    if found.lower < 0.0 || found.lower > 0.0 && square_between_cores(found.lower, swept) > *right {
        return Err("lower");
    }
    if *right > square_between_cores(found.upper, swept) {
        return Err("upper");
    }
    let meets = *right <= square_between_cores(0.0, swept);
    if !is_rounded && meets != (found.upper == 0.0) || !meets && found.upper == 0.0 {
        return Err("meeting");
    }
    if found.upper - found.lower > WIDEST * noise {
        return Err("wide");
    }
    Ok(())
}

/// Checks that the points of the cores are at most as far apart as stated.
fn check_points(
    near: &SolidNear,
    placed: &[Vec<Triangle>; 2],
    swept: &Dyadic,
) -> Result<(), &'static str> {
    let SolidNear::Points { triangles, weights, distance } = near else { return Ok(()) };
    let mean = |k: usize| {
        let corners = &placed[k][triangles[k] as usize];
        let weights = weights[k].map(Dyadic::new);
        let sum = &(&weights[0] + &weights[1]) + &weights[2];
        let of = |i: usize| corners[i].times(&weights[i]);
        (of(0).plus(&of(1)).plus(&of(2)), sum)
    };
    let ((p, s), (q, t)) = (mean(0), mean(1));
    let way = q.times(&s).minus(&p.times(&t));
    let whole = &s * &t;
    let square = Ratio::new(way.dot(&way), &whole * &whole);
    if square <= square_between_cores(*distance, swept) { Ok(()) } else { Err("points") }
}

fn check_within(
    pair: &Pair<Solid>,
    length: f64,
    (right, swept): (&Ratio, &Dyadic),
) -> Result<(), &'static str> {
    let square = square_between_cores(length, swept);
    let (said, proof) = pair.certified_within(length).map_err(|_| "within")?;
    let holds = |gap: f64| proof.is_some_and(|p| p.lower == gap && pair.verify(&p).is_ok());
    match said {
        Within::Closer(near) if pair.verify(&near).is_ok() && *right <= square => Ok(()),
        Within::Farther(gap) if gap.gap > length && *right > square && holds(gap.gap) => Ok(()),
        Within::Undecided(found) if found.lower <= length && length <= found.upper => Ok(()),
        _ => Err("within"),
    }
}
