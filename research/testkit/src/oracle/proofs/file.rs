//! The bodies of a proof, in exact coordinates.

use colltrans::MIN_MAGNITUDE;
use glam::{DMat3, DVec3};
use serde_json::Value;

use crate::oracle::distance::distance;
use crate::oracle::exact::{Dyadic, Ratio, Vector, place};
use crate::oracle::scene::Scene;
use crate::oracle::shadow::{SignedDistance, sideways_overlap};
use crate::oracle::simplex::collision_translation;
use crate::shapes::reach;

/// Factor that makes a rounded noise an upper bound.
const CERTAIN: f64 = 1.0 + 1e-6;

/// The two bodies of a file.
#[derive(Debug, Clone)]
pub struct Bodies {
    /// The vertices of the moving and of the fixed body in the world.
    pub points: [Vec<Vector>; 2],
    /// The facets of solids, over all pieces.
    pub facets: [Vec<[usize; 3]>; 2],
    /// The direction, if there is one.
    pub direction: Option<DVec3>,
    /// The minimum gap.
    pub min_gap: f64,
    /// The sum of the radii of rounded solids.
    pub radii: Dyadic,
    /// The size `S`.
    pub size: f64,
}

impl Bodies {
    /// Reads the bodies; `None` if the file is invalid.
    pub fn read(file: &Value) -> Option<Self> {
        let (mut points, mut facets) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
        let (mut size, mut origins) = (0.0, [DVec3::ZERO; 2]);
        let mut radii = Dyadic::ZERO;
        for k in 0..2 {
            let at = file.pointer(&format!("/placement/poses/{k}"))?;
            let body = body_at(file, at)?;
            let mut vertices = Vec::new();
            if let Some(convex) = body.get("convex") {
                vertices = vectors(convex.get("vertices")?)?;
            } else {
                radii = &radii + &Dyadic::new(radius_of_solid(body)?);
                for piece in pieces_of_solid(body)? {
                    let base = vertices.len();
                    vertices.append(&mut vectors(piece.get("vertices")?)?);
                    for triangle in piece.get("triangles")?.as_array()? {
                        let [a, b, c] = indices(triangle)?[..] else { return None };
                        facets[k].push([a, b, c].map(|v| v + base));
                    }
                }
            }
            let pose = at.get("pose")?;
            let entries = numbers(pose.get("matrix")?)?;
            let entries: Vec<f64> =
                entries.iter().map(|x| if x.abs() < MIN_MAGNITUDE { 0.0 } else { *x }).collect();
            let matrix = DMat3::from_cols_array(&entries.try_into().ok()?);
            origins[k] = vector(pose.get("translation")?)?;
            size += reach(&vertices);
            points[k] = place(matrix, origins[k], &vertices);
        }
        let direction = file.pointer("/query/cast/direction").map(vector);
        let direction = direction.map_or(Some(None), |d| d.map(Some))?;
        let min_gap = file.pointer("/query/cast/min_gap").map_or(Some(0.0), Value::as_f64)?;
        let size = (size + (origins[1] - origins[0]).length()).max(MIN_MAGNITUDE);
        Some(Self { points, facets, direction, min_gap, radii, size })
    }

    /// Returns the noise, `32 u (S + g)`, where `g` includes the radii of rounded solids.
    pub fn noise(&self) -> f64 {
        16.0 * f64::EPSILON * (self.size + self.min_gap + self.radii.to_f64())
    }

    /// Returns the square of a length plus the radii of rounded solids, exactly.
    pub fn square_between_cores(&self, length: f64) -> Ratio {
        let sum = &Dyadic::new(length) + &self.radii;
        Ratio::new(&sum * &sum, Dyadic::new(1.0))
    }

    /// Returns an upper bound of `count` noises.
    pub fn noises(&self, count: f64) -> f64 {
        count * self.noise() * CERTAIN
    }

    /// Returns the scene of the bodies and a direction.
    pub fn scene(&self, direction: DVec3) -> Scene {
        scene([&self.points[0], &self.points[1]], direction)
    }

    /// Returns the first translation at which the bodies meet; `None` if they never meet.
    pub fn first(&self, direction: DVec3) -> Option<Ratio> {
        collision_translation(&self.scene(direction))
    }

    /// Returns the overlap of the shadows, negative if they are disjoint.
    pub fn overlap_of_shadows(&self, direction: DVec3) -> SignedDistance {
        sideways_overlap(&self.scene(direction))
    }

    /// Returns the squared distance.
    pub fn distance(&self) -> Ratio {
        distance(&self.points[0], &self.points[1]).square
    }

    /// Returns the squared distance after a translation.
    pub fn distance_at(&self, direction: DVec3, t: f64) -> Ratio {
        distance(&moved(&self.points[0], direction, t), &self.points[1]).square
    }

    /// Returns the squared minimum distance over all translations up to `end`. The region that the moving body
    /// sweeps is the hull of both ends. The start is so far away that no smaller distance occurs before it.
    pub fn least_distance_until(&self, direction: DVec3, end: f64) -> Ratio {
        let far = 4.0 * self.size / direction.length();
        let end = end.min(far);
        let mut swept = moved(&self.points[0], direction, end);
        if end > -far {
            swept.extend(moved(&self.points[0], direction, -far));
        }
        distance(&swept, &self.points[1]).square
    }

    /// Returns the corners of a facet in the world.
    pub fn facet(&self, body: usize, facet: usize) -> Option<[Vector; 3]> {
        let corners = self.facets[body].get(facet)?;
        let of = |k: usize| self.points[body].get(corners[k]).cloned();
        Some([of(0)?, of(1)?, of(2)?])
    }

    /// Returns `min_Q n.q - max_P n.p`.
    pub fn along(&self, n: &Vector) -> Dyadic {
        let nearest = self.points[1].iter().map(|q| n.dot(q)).min();
        let farthest = self.points[0].iter().map(|p| n.dot(p)).max();
        &nearest.unwrap_or(Dyadic::ZERO) - &farthest.unwrap_or(Dyadic::ZERO)
    }
}

/// Builds a scene from points in the world and a direction. Its noises are not used.
pub fn scene([moving, fixed]: [&[Vector]; 2], direction: DVec3) -> Scene {
    let mut scene =
        Scene::new((&[], &colltrans::Pose::IDENTITY), (&[], &colltrans::Pose::IDENTITY), direction);
    (scene.moving, scene.fixed) = (moving.to_vec(), fixed.to_vec());
    scene
}

fn moved(points: &[Vector], direction: DVec3, t: f64) -> Vec<Vector> {
    let by = Vector::new(direction).times(&Dyadic::new(t));
    points.iter().map(|p| p.plus(&by)).collect()
}

/// Returns the body of a file to which a placement refers.
pub fn body_at<'a>(file: &'a Value, place: &Value) -> Option<&'a Value> {
    file.get("bodies")?.get(place.get("body")?.as_u64()? as usize)
}

/// Returns the pieces of a solid of a file.
pub fn pieces_of_solid(body: &Value) -> Option<&Vec<Value>> {
    body.get("rounded").unwrap_or(body).get("pieces")?.as_array()
}

/// Returns the radius of a solid of a file.
pub fn radius_of_solid(body: &Value) -> Option<f64> {
    body.pointer("/rounded/radius").map_or(Some(0.0), Value::as_f64)
}

/// Reads a vector.
pub fn vector(value: &Value) -> Option<DVec3> {
    Some(DVec3::from_array(numbers(value)?.try_into().ok()?))
}

/// Reads a list of vectors.
pub fn vectors(value: &Value) -> Option<Vec<DVec3>> {
    value.as_array()?.iter().map(vector).collect()
}

/// Reads a list of numbers.
pub fn numbers(value: &Value) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(Value::as_f64).collect()
}

/// Reads a list of non-negative integers.
pub fn indices(value: &Value) -> Option<Vec<usize>> {
    value.as_array()?.iter().map(|k| Some(k.as_u64()? as usize)).collect()
}

/// Returns `x^2`, exactly.
pub fn square(x: f64) -> Ratio {
    Ratio::from_f64(x).times(&Ratio::from_f64(x))
}

/// Returns the differences `q - p` of pairs of vertices, rounded.
pub fn differences(bodies: &Bodies, pairs: &Value) -> Option<Vec<DVec3>> {
    let of = |pair: &Value| {
        let p = bodies.points[0].get(pair.get("moving")?.as_u64()? as usize)?;
        let q = bodies.points[1].get(pair.get("fixed")?.as_u64()? as usize)?;
        Some(q.minus(p).to_f64())
    };
    pairs.as_array()?.iter().map(of).collect()
}

/// Checks whether the deviation of a number from 1 is at the limit of `32 u`.
pub fn is_at_limit(off: f64) -> bool {
    (30.0..38.0).contains(&(off.abs() / (0.5 * f64::EPSILON)))
}
