//! Judges lower-dimensional free directions (arcs and isolated directions) in rational arithmetic. Each is the
//! intersection of its planes, is free, and has blocked directions on all sides. Conversely, every isolated
//! free direction must be reported.

use colltrans::removal::directions::{FreeArc, FreeDirections, FreePlane, FreePoint, PlaneFacets};
use colltrans::{Placed, Solid};
use glam::DVec3;

use super::super::facets::{FacetJudge, Triangle};
use super::{facets, is_free_along};
use crate::oracle::exact::{Dyadic, Vector, place};

/// Number of directions of each circle that are judged.
const AROUND: usize = 12;
/// Maximum number of arcs and of isolated directions that are judged of an answer.
const MOST: usize = 12;

/// Two bodies in exact coordinates.
struct World {
    /// The vertices, and the vertex indices of the facets.
    vertices: [Vec<Vector>; 2],
    triangles: [Vec<[u32; 3]>; 2],
    facets: [Vec<Triangle>; 2],
}

/// Judges the arcs and isolated directions of an answer without a tolerance, and checks whether directions of a
/// grid are isolated. Returns the number of judged directions.
///
/// # Errors
/// A description of the first disagreement.
pub fn judge(all: &FreeDirections, bodies: [Placed<'_, Solid>; 2]) -> Result<u64, String> {
    let world = World {
        vertices: bodies.map(|b| place(b.pose.matrix(), b.pose.translation(), b.body.vertices())),
        triangles: bodies.map(|b| b.body.triangles().to_vec()),
        facets: facets(bodies),
    };
    for point in all.points().iter().take(MOST) {
        world.point(point)?;
    }
    for arc in all.arcs().iter().take(MOST) {
        world.arc(arc)?;
    }
    if all.is_complete() {
        for axis in DVec3::AXES {
            world.axis(all, axis)?;
            world.axis(all, -axis)?;
        }
    }
    Ok((all.points().len().min(MOST) + all.arcs().len().min(MOST)) as u64)
}

/// Returns `d` displaced by a very small multiple of a vector.
fn displaced_slightly(d: &Vector, by: &Vector) -> Vector {
    // Both vectors have about the same length.
    let factor = (by.to_f64().length() / d.to_f64().length()).log2().round() as i32 + 40;
    d.times(&Dyadic::new(2.0_f64.powi(factor))).plus(by)
}

fn negated(v: &Vector) -> Vector {
    Vector::new(DVec3::ZERO).minus(v)
}

impl World {
    fn is_free(&self, d: &Vector) -> bool {
        is_free_along(&self.facets, &FacetJudge::along(d.clone()))
    }

    /// Returns the exact normal of a plane.
    fn normal(&self, plane: &FreePlane) -> Result<Vector, String> {
        let Some(PlaneFacets { triangles, vertices }) = plane.of else {
            return Err(format!("{plane:?} is of no facets"));
        };
        let mut places = Vec::new();
        for spot in vertices {
            let body = usize::from(!spot.moving);
            let facet = self.triangles[body].get(triangles[body] as usize);
            if !facet.is_some_and(|facet| facet.contains(&spot.vertex)) {
                return Err(format!("{spot:?} is no vertex of {triangles:?}"));
            }
            places.push(&self.vertices[body][spot.vertex as usize]);
        }
        let normal = places[1].minus(places[0]).cross(&places[2].minus(places[0]));
        let rounded = normal.to_f64();
        if !rounded.normalize().abs_diff_eq(plane.normal, 1e-12) {
            return Err(format!("{plane:?} has the normal {rounded}"));
        }
        Ok(normal)
    }

    /// Returns the direction of an isolated direction with the normals of its planes.
    fn direction(&self, point: &FreePoint) -> Result<[Vector; 3], String> {
        let [a, b] = [self.normal(&point.planes[0])?, self.normal(&point.planes[1])?];
        let d = a.cross(&b);
        let rounded = d.to_f64();
        let off = rounded / rounded.abs().max_element() - point.direction;
        if off.is_nan() || off.abs().max_element() > 1e-14 {
            return Err(format!("{point:?} is {rounded}"));
        }
        Ok([d, a, b])
    }

    fn point(&self, point: &FreePoint) -> Result<(), String> {
        let [d, a, b] = self.direction(point)?;
        if !self.is_free(&d) {
            return Err(format!("{point:?} is blocked"));
        }
        let around = [a.clone(), negated(&a), b.clone(), negated(&b), a.plus(&b), a.minus(&b)];
        match around.iter().find(|by| self.is_free(&displaced_slightly(&d, by))) {
            Some(by) => Err(format!("{point:?} is free beside, too: by {}", by.to_f64())),
            None => Ok(()),
        }
    }

    fn arc(&self, arc: &FreeArc) -> Result<(), String> {
        let n = self.normal(&arc.plane)?;
        let ends = match &arc.ends {
            None => None,
            Some([from, to]) => {
                let ([e, n1, m], [f, n2, k]) = (self.direction(from)?, self.direction(to)?);
                if n1 != n || n2 != n {
                    return Err(format!("{arc:?} ends on another circle"));
                }
                self.end(arc, [&e, &n], &n.cross(&e))?;
                self.end(arc, [&f, &n], &f.cross(&n))?;
                Some([m, k, f])
            }
        };
        // Two orthogonal vectors in the plane.
        let first = DVec3::AXES[n.to_f64().abs().min_position()];
        let p = n.cross(&Vector::new(first));
        let q = n.cross(&p);
        let mut within = 0;
        for k in 0..AROUND {
            let (sine, cosine) = (0.1 + std::f64::consts::TAU * k as f64 / AROUND as f64).sin_cos();
            let part = |v: &Vector, by: f64| v.times(&Dyadic::new(by / v.to_f64().length()));
            let d = part(&p, cosine).plus(&part(&q, sine));
            let is_on = ends.as_ref().is_none_or(|[m, k, f]| {
                let (behind, before) = (!m.dot(&d).is_positive(), !k.dot(&d).is_negative());
                if m.dot(f).is_positive() { behind || before } else { behind && before }
            });
            if !is_on {
                continue;
            }
            within += 1;
            let sides = [displaced_slightly(&d, &n), displaced_slightly(&d, &negated(&n))];
            if !self.is_free(&d) {
                return Err(format!("{arc:?} is blocked along {}", d.to_f64()));
            }
            if sides.iter().any(|side| self.is_free(side)) {
                return Err(format!("{arc:?} is free beside, too, at {}", d.to_f64()));
            }
        }
        if arc.ends.is_none() && within < AROUND { Err("a circle has gaps".into()) } else { Ok(()) }
    }

    /// Checks that an end of an arc is free, and that the circle beyond it is blocked or is the border of a
    /// region.
    fn end(&self, arc: &FreeArc, [e, n]: [&Vector; 2], inwards: &Vector) -> Result<(), String> {
        let beyond = displaced_slightly(e, &negated(inwards));
        let sides = [displaced_slightly(&beyond, n), displaced_slightly(&beyond, &negated(n))];
        if !self.is_free(e) || !self.is_free(&displaced_slightly(e, inwards)) {
            return Err(format!("{arc:?} is blocked at its end {}", e.to_f64()));
        }
        if self.is_free(&beyond) && !sides.iter().any(|side| self.is_free(side)) {
            return Err(format!("{arc:?} goes on behind {}", e.to_f64()));
        }
        Ok(())
    }

    /// Checks that an axis which is free while its surroundings are blocked is reported as an isolated
    /// direction.
    fn axis(&self, all: &FreeDirections, d: DVec3) -> Result<(), String> {
        let exactly = Vector::new(d);
        if !self.is_free(&exactly) {
            return Ok(());
        }
        let (u, v) = d.any_orthonormal_pair();
        let ways = [-2.0, -1.0, -0.3, 0.0, 0.3, 1.0, 2.0].map(|t| [u + v * t, v + u * t]);
        let around = ways.into_iter().flatten().flat_map(|way| [way, -way]);
        let mut around = around.map(|way| displaced_slightly(&exactly, &Vector::new(way)));
        let told = all.points().iter().any(|point| all.is_at_point(point, d) == Ok(true));
        let near = all.arcs().iter().any(|arc| all.is_on_arc(arc, d) == Ok(true));
        if !told && !near && !around.any(|d| self.is_free(&d)) {
            return Err(format!("{d} is free and alone, but not told"));
        }
        Ok(())
    }
}
