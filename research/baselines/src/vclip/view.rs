//! The states of V-Clip: the Voronoi regions of one body against a feature of the other body (Mirtich 1998).
//!
//! - `own` is the body with the Voronoi region `VR(X)` of its feature `X`.
//! - The other body's feature is a vertex or an edge `e(l) = tail + l (head - tail)`, `0 <= l <= 1`, in the
//!   own body's frame.
//! - `D(l)` is the distance of `e(l)` from a feature. The sign of its derivative where the edge leaves a
//!   region selects the next feature.
//! - *Flare*: a length (0 as published) by which Voronoi regions are enlarged, so that neighbouring regions
//!   overlap by more than rounding and ties end a walk. The result is then nearest up to about this length.
//!
//! Each function is one half of a state: what it implies for `X`. The other half exchanges the bodies.

use glam::{DMat3, DVec3};

use super::segment::nearest_of_segments;
use crate::features::{Feature, HalfEdge, Shell};

/// A body, and the other one in its frame: `x_own = R x_other + t`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View<'a> {
    pub(crate) own: &'a Shell,
    pub(crate) other: &'a Shell,
    pub(crate) rotation: DMat3,
    pub(crate) translation: DVec3,
    /// Length by which the planes of Voronoi regions are moved outwards.
    pub(crate) flare: f64,
}

/// Relative error of the slope of an edge, which applies if the planes are flared: a few roundings of a
/// rotated normal and of a product.
const SLOPE_ERROR: f64 = 8.0 * f64::EPSILON;

/// Result of a state with a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum FaceVerdict {
    /// The features are closest.
    Stay,
    /// A feature at the boundary of the own face is nearer, or equally near.
    Own(Feature),
    /// A neighbour of the other body's feature is nearer, or equally near.
    Other(Feature),
    /// This point, in the own frame, belongs to both bodies.
    Penetrating(DVec3),
    /// The vertex is below the face, and all its edges lead away from the face.
    LocalMinimum,
}

impl View<'_> {
    /// Returns a vertex of the other body in the own frame.
    pub(crate) fn seen(&self, v: u32) -> DVec3 {
        self.rotation * self.other.vertex(v) + self.translation
    }

    /// Returns an edge of the other body in the own frame.
    fn seen_edge(&self, h: u32) -> Edge {
        let HalfEdge { origin, target, .. } = self.other.half_edge(h);
        Edge { tail: self.seen(origin), head: self.seen(target) }
    }

    /// Returns the rise of the other body's edge along the normal of the own face. It is exactly opposite for
    /// twins.
    fn slope(&self, face: u32, h: u32) -> f64 {
        let [tail, head] = self.other.ends(h);
        (self.rotation.transpose() * self.own.normal(face)).dot(head - tail)
    }

    /// Returns the slope, or 0 if its sign is uncertain and the planes are flared.
    fn certain_slope(&self, face: u32, h: u32) -> f64 {
        let slope = self.slope(face, h);
        if self.flare > 0.0 && slope.abs() <= SLOPE_ERROR * self.other.length(h) {
            0.0
        } else {
            slope
        }
    }

    /// Returns the flare as a value of a Voronoi plane function, whose unit is the length of this edge.
    fn scaled_flare(&self, h: u32) -> f64 {
        if self.flare > 0.0 { self.flare * self.own.length(h) } else { 0.0 }
    }

    /// Returns, for vertex `v` and a vertex of the other body, an edge whose Voronoi plane the other vertex
    /// is beyond; `None` if there is none.
    pub(crate) fn vertex_vertex(&self, v: u32, other: u32) -> Option<Feature> {
        let x = self.seen(other);
        let beyond = |h: &&u32| self.own.beyond_vertex(**h, x) > self.scaled_flare(**h);
        self.own.outgoing(v).iter().find(beyond).map(|&h| self.own.edge(h))
    }

    /// Returns, for vertex `v` and an edge of the other body, an edge at `v` beyond whose Voronoi plane the other edge
    /// is nearer; `None` if its nearest point is in the region of `v`.
    pub(crate) fn vertex_edge(&self, v: u32, other: u32) -> Option<Feature> {
        let edge = self.seen_edge(other);
        let mut clip = Clip::default();
        for &h in self.own.outgoing(v) {
            let lift = self.scaled_flare(h);
            let heights = [edge.tail, edge.head].map(|x| lift - self.own.beyond_vertex(h, x));
            match clip.clip_below(heights, self.own.edge(h)) {
                Cut::Part => {}
                Cut::Excluded => return Some(self.own.edge(h)),
                Cut::Empty => break,
            }
        }
        clip.leave_through(|l, _| self.climb_from(v, edge, l))
    }

    /// Returns a number with the sign of `D'(l)` for the distance from vertex `v`.
    fn climb_from(&self, v: u32, edge: Edge, l: f64) -> f64 {
        let along = edge.along();
        let climb = along.dot(edge.at(l) - self.own.vertex(v));
        if self.flare > 0.0 && climb.abs() <= self.flare * along.length() { 0.0 } else { climb }
    }

    /// Returns, for edge `h` and a vertex of the other body, the neighbour beyond whose plane the vertex is;
    /// `None` if it is in the region.
    pub(crate) fn edge_vertex(&self, h: u32, other: u32) -> Option<Feature> {
        let x = self.seen(other);
        let HalfEdge { origin, target, twin, face } = self.own.half_edge(h);
        let lift = self.scaled_flare(h);
        if self.own.beyond_vertex(h, x) < -lift {
            Some(Feature::Vertex(origin))
        } else if self.own.beyond_vertex(twin, x) < -lift {
            Some(Feature::Vertex(target))
        } else if self.own.inside_edge(h, x) > lift {
            Some(Feature::Face(face))
        } else if self.own.inside_edge(twin, x) > lift {
            Some(Feature::Face(self.own.half_edge(twin).face))
        } else {
            None
        }
    }

    /// Returns, for edge `h` and an edge of the other body, the neighbour of `h` beyond whose Voronoi plane the other
    /// edge is nearer; `None` if its nearest point is in the region of `h`. Tests first the planes of the ends, then
    /// those of the faces.
    pub(crate) fn edge_edge(&self, h: u32, other: u32) -> Option<Feature> {
        let edge = self.seen_edge(other);
        let mut clip = Clip::default();
        let (sides, lift) = ([h, self.own.half_edge(h).twin], self.scaled_flare(h));
        for h in sides {
            let heights = [edge.tail, edge.head].map(|x| lift + self.own.beyond_vertex(h, x));
            let end = Feature::Vertex(self.own.half_edge(h).origin);
            match clip.clip_below(heights, end) {
                Cut::Part => {}
                Cut::Excluded => return Some(end),
                Cut::Empty => break,
            }
        }
        let derivative = |l: f64, at: Feature| match at {
            Feature::Vertex(v) => self.climb_from(v, edge, l),
            Feature::Face(f) => {
                let height = self.own.height(f, edge.at(l));
                if height == 0.0 { 0.0 } else { self.certain_slope(f, other) * height.signum() }
            }
            Feature::Edge(_) => 0.0,
        };
        let end = clip.leave_through(derivative);
        if end.is_some() {
            return end;
        }
        for h in sides {
            let heights = [edge.tail, edge.head].map(|x| lift - self.own.inside_edge(h, x));
            let face = Feature::Face(self.own.half_edge(h).face);
            match clip.clip_below(heights, face) {
                Cut::Part => {}
                Cut::Excluded => return Some(face),
                Cut::Empty => break,
            }
        }
        clip.leave_through(derivative)
    }

    /// Evaluates face `f` and a vertex of the other body.
    pub(crate) fn face_vertex(&self, f: u32, other: u32) -> FaceVerdict {
        let x = self.seen(other);
        let mut lowest = (-self.flare, None);
        for h in self.own.boundary(f) {
            let inside = self.own.inside_edge(h, x);
            if inside < 0.0 {
                let height = inside / self.own.length(h);
                if height < lowest.0 {
                    lowest = (height, Some(h));
                }
            }
        }
        if let Some(h) = lowest.1 {
            return FaceVerdict::Own(self.own.edge(h));
        }
        let height = self.own.height(f, x);
        if height == 0.0 {
            return FaceVerdict::Stay;
        }
        let nearer = |h: &&u32| self.certain_slope(f, **h) * height.signum() < 0.0;
        match self.other.outgoing(other).iter().find(nearer) {
            Some(&h) => FaceVerdict::Other(self.other.edge(h)),
            None if height > 0.0 => FaceVerdict::Stay,
            None => FaceVerdict::LocalMinimum,
        }
    }

    /// Evaluates face `f` and an edge of the other body. They are never closest features unless they cross.
    pub(crate) fn face_edge(&self, f: u32, other: u32) -> FaceVerdict {
        let edge = self.seen_edge(other);
        let mut clip = Clip::default();
        for h in self.own.boundary(f) {
            let lift = self.scaled_flare(h);
            let heights = [edge.tail, edge.head].map(|x| lift + self.own.inside_edge(h, x));
            if clip.clip_below(heights, self.own.edge(h)) != Cut::Part {
                return FaceVerdict::Own(self.nearest_of_border(f, edge));
            }
        }
        let [low, high] = [clip.low, clip.high].map(|l| self.own.height(f, edge.at(l)));
        if low.min(high) <= 0.0 && low.max(high) >= 0.0 {
            let share = if low == high { 0.0 } else { low / (low - high) };
            let at = clip.low + (clip.high - clip.low) * share;
            return FaceVerdict::Penetrating(edge.at(at));
        }
        let HalfEdge { origin, target, .. } = self.other.half_edge(other);
        let (border, end) = if self.slope(f, other) * low.signum() >= 0.0 {
            (clip.low_at, origin)
        } else {
            (clip.high_at, target)
        };
        border.map_or(FaceVerdict::Other(Feature::Vertex(end)), FaceVerdict::Own)
    }

    /// Returns the edge or vertex of a face nearest to an edge outside of the face's region.
    fn nearest_of_border(&self, f: u32, edge: Edge) -> Feature {
        let mut best = (f64::INFINITY, Feature::Face(f));
        for h in self.own.boundary(f) {
            let near = nearest_of_segments(self.own.ends(h), [edge.tail, edge.head]);
            let square = near.first.distance_squared(near.second);
            if square < best.0 {
                let HalfEdge { origin, target, .. } = self.own.half_edge(h);
                let feature = if near.share <= 0.0 {
                    Feature::Vertex(origin)
                } else if near.share >= 1.0 {
                    Feature::Vertex(target)
                } else {
                    self.own.edge(h)
                };
                best = (square, feature);
            }
        }
        best.1
    }

    /// Checks whether a vertex of the other body is in the Voronoi region of the own face.
    pub(crate) fn is_above(&self, face: u32, other: u32) -> bool {
        let x = self.seen(other);
        self.own.height(face, x) > 0.0
            && self.own.boundary(face).all(|h| self.own.inside_edge(h, x) >= 0.0)
    }

    /// Returns the own face above which a vertex of the other body is highest; `None` if it is above no face.
    pub(crate) fn face_below(&self, other: u32) -> Option<u32> {
        let x = self.seen(other);
        let heights = (0..self.own.face_count() as u32).map(|f| (f, self.own.height(f, x)));
        let (face, height) = heights.max_by(|a, b| a.1.total_cmp(&b.1))?;
        (height > 0.0).then_some(face)
    }
}

/// An edge of the other body in the own frame.
#[derive(Debug, Clone, Copy)]
struct Edge {
    tail: DVec3,
    head: DVec3,
}

impl Edge {
    /// Returns the vector from tail to head.
    fn along(&self) -> DVec3 {
        self.head - self.tail
    }

    /// Returns the point at parameter `l`.
    fn at(&self, l: f64) -> DVec3 {
        self.tail.lerp(self.head, l)
    }
}

/// The part of an edge inside some planes of a Voronoi region, and the neighbours beyond the planes at its
/// ends.
#[derive(Debug, Clone, Copy)]
struct Clip {
    low: f64,
    high: f64,
    low_at: Option<Feature>,
    high_at: Option<Feature>,
}

/// Effect of a plane on the part of an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cut {
    /// Something remains.
    Part,
    /// The whole edge is beyond this plane.
    Excluded,
    /// Nothing remains, because of this plane and an earlier one.
    Empty,
}

impl Default for Clip {
    fn default() -> Self {
        Self { low: 0.0, high: 1.0, low_at: None, high_at: None }
    }
}

impl Clip {
    /// Clips the part below a plane, given the heights of tail and head.
    fn clip_below(&mut self, [tail, head]: [f64; 2], neighbour: Feature) -> Cut {
        if tail < 0.0 && head < 0.0 {
            return Cut::Excluded;
        }
        let at = tail / (tail - head);
        if tail < 0.0 && at > self.low {
            (self.low, self.low_at) = (at, Some(neighbour));
        } else if head < 0.0 && at < self.high {
            (self.high, self.high_at) = (at, Some(neighbour));
        }
        if self.low > self.high { Cut::Empty } else { Cut::Part }
    }

    /// Returns the neighbour at an end of the part at which the distance still decreases outwards; `None` if
    /// there is none. If nothing remains of the edge, one end has this property, because the distance is
    /// convex.
    fn leave_through(&self, derivative: impl Fn(f64, Feature) -> f64) -> Option<Feature> {
        let low = self.low_at.filter(|at| derivative(self.low, *at) > 0.0);
        low.or_else(|| self.high_at.filter(|at| derivative(self.high, *at) < 0.0))
    }
}
