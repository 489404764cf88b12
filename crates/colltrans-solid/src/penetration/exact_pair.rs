//! Two placed solids with exact coordinates, and the side of each body on which a point lies.
//!
//! - A vertex `v` is at `R v + t`, with the entries of the pose's matrix `R`, without rounding.
//! - The base point is a vertex of the fixed body. Coordinates are multiples of `2^unit`, relative to the base point.
//! - Only closed shells bound a body. The winding number of each of its pieces is counted along a ray upwards, which an
//!   infinitesimal displacement moves off all edges. A point is inside a body if it is inside one of its pieces.

use std::cell::OnceCell;
use std::cmp::Ordering;
use std::rc::Rc;

use glam::DVec3;

use super::cuts::{Corner, Fragment, Plane, Polygon, Vertex};
use crate::body::Solid;
use colltrans_convex::body::Pose;
use colltrans_convex::pair::Pair;
use colltrans_kernel::big::{Big, lowest_exponent};

/// A facet of a closed shell.
pub(super) struct ExactFacet {
    /// Position in [`Solid::triangles`].
    pub(super) triangle: u32,
    piece: usize,
    pub(super) corners: [Rc<Vertex>; 3],
    pub(super) plane: Rc<Plane>,
    /// Box of the rounded corners, enlarged by their errors.
    low: DVec3,
    high: DVec3,
    /// Planes through the edges and the vertical axis; unused if the facet is vertical.
    upright: OnceCell<[Option<Plane>; 3]>,
    /// Planes through the edges and the axis along which the facet is seen best.
    edges: OnceCell<Option<[Rc<Plane>; 3]>>,
}

/// A body: its facets with an area.
pub(super) struct ExactBody {
    pub(super) facets: Vec<ExactFacet>,
    /// Position in `facets` of each triangle of the solid.
    places: Vec<Option<u32>>,
    pieces: usize,
    /// Whether the body has an open shell, which bounds nothing.
    pub(super) has_open_shell: bool,
}

/// Both bodies, the moving one first.
pub(super) struct ExactPair {
    pub(super) unit: i32,
    base: [Big; 3],
    /// Rounded base point.
    pub(super) near_base: DVec3,
    pub(super) bodies: [ExactBody; 2],
    /// Number of bits of the largest coordinate.
    pub(super) bits: u32,
}

/// Reason why the side of a point is not decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NoSide {
    /// The point lies on a facet.
    OnFacet,
    /// A piece has a negative winding number.
    InsideOut,
}

impl ExactFacet {
    /// Checks whether the facet contains a point.
    fn contains(&self, point: &Vertex, unit: i32) -> bool {
        self.plane.side(point) == Ordering::Equal
            && self.edges(unit).is_some_and(|edges| {
                edges.iter().enumerate().all(|(k, edge)| {
                    let inwards = edge.side(&self.corners[(k + 2) % 3]);
                    edge.side(point) != inwards.reverse()
                })
            })
    }

    /// Returns the planes through the edges and the axis of the largest component of the normal.
    fn edges(&self, unit: i32) -> Option<&[Rc<Plane>; 3]> {
        let make = || {
            let axis = self.plane.main_axis();
            let edge = |k: usize| {
                let ends = [&*self.corners[k], &*self.corners[(k + 1) % 3]];
                Plane::of_edge(ends, axis, unit).map(Rc::new)
            };
            Some([edge(0)?, edge(1)?, edge(2)?])
        };
        self.edges.get_or_init(make).as_ref()
    }

    /// Returns the whole facet as a polygon.
    pub(super) fn polygon(&self, unit: i32) -> Option<Polygon> {
        let edges = self.edges(unit)?;
        let ring =
            (0..3).map(|k| Corner { at: Rc::clone(&self.corners[k]), edge: Rc::clone(&edges[k]) });
        Some(Polygon { plane: Rc::clone(&self.plane), ring: ring.collect() })
    }

    /// Returns 1 if the ray upwards from a point leaves through the facet, -1 if it enters, and 0 if it misses the facet.
    fn crossing(&self, point: &Vertex, unit: i32) -> i32 {
        let facing = self.plane.facing(2);
        if facing == Ordering::Equal {
            return 0;
        }
        let upright = self.upright.get_or_init(|| {
            [0, 1, 2]
                .map(|k| Plane::of_edge([&*self.corners[k], &*self.corners[(k + 1) % 3]], 2, unit))
        });
        // The point is displaced by `(e, e^2)` for an infinitesimal `e > 0`.
        let is_passed = |edge: &Option<Plane>| {
            edge.as_ref().is_some_and(|edge| {
                edge.side(point).then_with(|| edge.facing(0)).then_with(|| edge.facing(1)) == facing
            })
        };
        if !upright.iter().all(is_passed) || self.plane.side(point) != facing.reverse() {
            return 0;
        }
        if facing == Ordering::Greater { 1 } else { -1 }
    }
}

impl ExactBody {
    fn new(solid: &Solid, corners: &[Option<Rc<Vertex>>], unit: i32) -> Self {
        let mut facets = Vec::new();
        let mut places = vec![None; solid.triangles().len()];
        for (k, triangle) in solid.triangles().iter().enumerate() {
            let [Some(a), Some(b), Some(c)] = triangle.map(|v| corners[v as usize].clone()) else {
                continue;
            };
            if solid.is_open(k) {
                continue;
            }
            let Some(plane) = Plane::of_triangle([&a, &b, &c], unit) else { continue };
            places[k] = Some(facets.len() as u32);
            let [low, high] = [
                [&a, &b, &c].map(|p| p.lowest()).into_iter().reduce(DVec3::min),
                [&a, &b, &c].map(|p| p.highest()).into_iter().reduce(DVec3::max),
            ]
            .map(Option::unwrap_or_default);
            facets.push(ExactFacet {
                triangle: k as u32,
                piece: solid.piece_of(k),
                corners: [a, b, c],
                plane: Rc::new(plane),
                low,
                high,
                upright: OnceCell::new(),
                edges: OnceCell::new(),
            });
        }
        let pieces = facets.iter().map(|facet| facet.piece + 1).max().unwrap_or(0);
        let has_open_shell = (0..solid.triangles().len()).any(|k| solid.is_open(k));
        Self { facets, places, pieces, has_open_shell }
    }

    /// Returns the facet of a triangle of the solid; `None` if the triangle does not exist, has no area or belongs to an
    /// open shell.
    pub(super) fn facet(&self, triangle: u32) -> Option<&ExactFacet> {
        let place = *self.places.get(triangle as usize)?;
        self.facets.get(place? as usize)
    }

    /// Iterates over the corners of all facets.
    pub(super) fn corners(&self) -> impl Iterator<Item = &Rc<Vertex>> {
        self.facets.iter().flat_map(|facet| &facet.corners)
    }

    /// Returns the facets that have a corner on the inner side of each side of a box, as parts of a cell that contains
    /// them.
    pub(super) fn fragments(&self, sides: &[[Rc<Plane>; 2]; 3], unit: i32) -> Vec<Fragment> {
        let is_beyond = |facet: &ExactFacet, [low, high]: &[Rc<Plane>; 2]| {
            let are_all = |of: &Plane, inwards: Ordering| {
                facet.corners.iter().all(|corner| of.side(corner) != inwards)
            };
            are_all(low, Ordering::Greater) || are_all(high, Ordering::Less)
        };
        let near = self.facets.iter().filter(|of| !sides.iter().any(|axis| is_beyond(of, axis)));
        let whole = near.filter_map(|facet| {
            Some(Fragment { triangle: facet.triangle, polygon: facet.polygon(unit)? })
        });
        whole.collect()
    }

    /// Decides whether a point that lies on no facet is inside.
    pub(super) fn is_inside(&self, point: &Vertex, unit: i32) -> Result<bool, NoSide> {
        let mut windings = vec![0; self.pieces];
        let (low, high) = (point.lowest(), point.highest());
        for facet in &self.facets {
            let is_far = low.z > facet.high.z
                || (0..2).any(|k| low[k] > facet.high[k] || high[k] < facet.low[k]);
            if !is_far {
                windings[facet.piece] += facet.crossing(point, unit);
            }
        }
        match windings.iter().min() {
            Some(least) if *least < 0 => Err(NoSide::InsideOut),
            _ => Ok(windings.iter().any(|winding| *winding > 0)),
        }
    }

    /// Decides whether a point is in the interior, or on the other side of the surface.
    pub(super) fn is_strictly_inside(&self, point: &Vertex, unit: i32) -> Result<bool, NoSide> {
        let (low, high) = (point.lowest(), point.highest());
        let is_near =
            |facet: &&ExactFacet| low.cmple(facet.high).all() && high.cmpge(facet.low).all();
        if self.facets.iter().filter(is_near).any(|facet| facet.contains(point, unit)) {
            return Err(NoSide::OnFacet);
        }
        self.is_inside(point, unit)
    }
}

/// Returns the terms of a coordinate of a placed vertex.
fn terms(pose: &Pose, at: DVec3, row: usize) -> [[f64; 2]; 4] {
    let matrix = pose.matrix();
    let product = |k: usize| [matrix.col(k)[row], at[k]];
    [product(0), product(1), product(2), [pose.translation()[row], 1.0]]
}

impl ExactPair {
    pub(super) fn new(pair: &Pair<'_, Solid>) -> Self {
        let solids = [pair.moving(), pair.fixed()];
        let poses = [pair.moving_pose(), pair.fixed_pose()];
        let used = solids.map(|solid| {
            let mut used = vec![false; solid.vertices().len()];
            let closed = solid.triangles().iter().enumerate().filter(|(k, _)| !solid.is_open(*k));
            closed.flat_map(|(_, corners)| corners).for_each(|v| used[*v as usize] = true);
            used
        });
        let vertices = |k: usize| {
            let all = solids[k].vertices().iter().zip(&used[k]);
            all.filter(|(_, used)| **used).map(|(at, _)| *at)
        };
        let rows = |at: DVec3, k: usize| [0, 1, 2].map(|row| terms(&poses[k], at, row));
        let lowest = |k: usize| {
            let all = vertices(k).flat_map(|at| rows(at, k)).flatten();
            all.filter_map(|[a, b]| lowest_exponent(a, b)).min()
        };
        let unit = [0, 1].into_iter().filter_map(lowest).min().unwrap_or(0);
        let exact = |at: DVec3, k: usize| {
            rows(at, k).map(|terms| {
                let parts = terms.map(|[a, b]| Big::exact_product(a, b, unit));
                parts.iter().fold(Big::default(), |sum, part| &sum + part)
            })
        };
        let first = [1, 0].into_iter().find_map(|k| Some(exact(vertices(k).next()?, k)));
        let base = first.unwrap_or_default();
        let mut bits = 0;
        let bodies = [0, 1].map(|k| {
            let all = solids[k].vertices().iter().zip(&used[k]);
            let corners: Vec<Option<Rc<Vertex>>> = all
                .map(|(at, used)| {
                    let at = used.then(|| exact(*at, k))?;
                    let [x, y, z] = [0, 1, 2].map(|row| &at[row] - &base[row]);
                    bits = bits.max(x.bits()).max(y.bits()).max(z.bits());
                    Some(Rc::new(Vertex::new([x, y, z, Big::power_of_two(0)], unit)))
                })
                .collect();
            ExactBody::new(solids[k], &corners, unit)
        });
        let [x, y, z] = base.clone();
        let near_base = Vertex::new([x, y, z, Big::power_of_two(0)], unit).near;
        Self { unit, base, near_base, bodies, bits }
    }

    /// Returns a point of the world.
    pub(super) fn point(&self, at: DVec3) -> Vertex {
        let numbers = at.to_array();
        let least = numbers.iter().filter_map(|x| lowest_exponent(*x, 1.0)).min();
        let unit = least.map_or(self.unit, |least| least.min(self.unit));
        let finer = (self.unit - unit) as u32;
        let coordinate =
            |k: usize| &Big::exact_product(numbers[k], 1.0, unit) - &self.base[k].shifted(finer);
        let exact = [coordinate(0), coordinate(1), coordinate(2), Big::power_of_two(finer)];
        Vertex::new(exact, self.unit)
    }

    /// Returns the plane of the points with a coordinate on an axis.
    pub(super) fn coordinate_plane(&self, axis: usize, number: f64) -> Option<Rc<Plane>> {
        let mut at = DVec3::ZERO;
        at[axis] = number;
        // Other coordinates of the point do not occur in the equation.
        Plane::of_coordinate(&self.point(at), axis, self.unit).map(Rc::new)
    }
}
