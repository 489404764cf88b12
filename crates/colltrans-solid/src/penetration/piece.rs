//! Convex polygons of the plane, and their division.

use glam::DVec2;

/// Width of a polygon up to which a rectangle encloses it, in margins.
const THIN: f64 = 4.0;

/// An oriented line. Points with `normal . p >= offset` are on its inner side.
#[derive(Clone, Copy)]
pub(super) struct Line {
    normal: DVec2,
    offset: f64,
}

impl Line {
    pub(super) const fn new(normal: DVec2, offset: f64) -> Self {
        Self { normal, offset }
    }

    /// Returns the line with the other side as inner side.
    pub(super) fn reversed(self) -> Self {
        Self { normal: -self.normal, offset: -self.offset }
    }

    /// Returns a value that is not negative on the inner side.
    fn value(&self, point: DVec2) -> f64 {
        self.normal.dot(point) - self.offset
    }
}

/// A convex polygon with counter-clockwise corners. It is empty if it has less than three.
#[derive(Clone)]
pub(super) struct Piece {
    corners: Vec<DVec2>,
}

impl Piece {
    pub(super) const fn new(corners: Vec<DVec2>) -> Self {
        Self { corners }
    }

    pub(super) fn corners(&self) -> &[DVec2] {
        &self.corners
    }

    pub(super) fn is_empty(&self) -> bool {
        self.corners.len() < 3
    }

    pub(super) fn area(&self) -> f64 {
        self.triangles().map(|[a, b, c]| 0.5 * (b - a).perp_dot(c - a)).sum()
    }

    /// Iterates over triangles that divide the polygon.
    pub(super) fn triangles(&self) -> impl Iterator<Item = [DVec2; 3]> {
        let rest = self.corners.get(1..).unwrap_or_default();
        rest.windows(2).map(|pair| [self.corners[0], pair[0], pair[1]])
    }

    pub(super) fn circumference(&self) -> f64 {
        let last = self.corners.last().into_iter();
        last.chain(&self.corners).zip(&self.corners).map(|(p, q)| p.distance(*q)).sum()
    }

    /// Returns the mean of the corners.
    pub(super) fn middle(&self) -> DVec2 {
        self.corners.iter().sum::<DVec2>() / self.corners.len() as f64
    }

    /// Returns the line across the middle of the longer side of the box around the polygon.
    pub(super) fn halving_line(&self) -> Line {
        let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (low, high) =
            self.corners.iter().fold(start, |(low, high), p| (low.min(*p), high.max(*p)));
        let sides = high - low;
        let axis = if sides.x >= sides.y { DVec2::X } else { DVec2::Y };
        Line::new(axis, axis.dot(0.5 * (low + high)))
    }

    /// Divides the polygon, and returns the parts on the outer and on the inner side of a line. Both have the same
    /// computed points of the line as corners.
    pub(super) fn split(self, line: &Line) -> [Self; 2] {
        let values: Vec<f64> = self.corners.iter().map(|p| line.value(*p)).collect();
        if values.iter().all(|value| *value >= 0.0) {
            return [Self::new(Vec::new()), self];
        }
        if values.iter().all(|value| *value <= 0.0) {
            return [self, Self::new(Vec::new())];
        }
        let mut parts = [(); 2].map(|()| Vec::with_capacity(values.len() + 1));
        for (i, &p) in self.corners.iter().enumerate() {
            let next = (i + 1) % values.len();
            let [from, to] = [values[i], values[next]];
            if from <= 0.0 {
                parts[0].push(p);
            }
            if from >= 0.0 {
                parts[1].push(p);
            }
            if from.min(to) < 0.0 && 0.0 < from.max(to) {
                let between = p + (self.corners[next] - p) * (from / (from - to));
                for part in &mut parts {
                    part.push(between);
                }
            }
        }
        parts.map(Self::new)
    }
}

/// A convex polygon, as the inner sides of lines.
pub(super) struct Zone {
    pub(super) sides: Vec<Line>,
}

impl Zone {
    /// Builds a polygon around the corners of a convex one, at a distance of `margin` from it; `None` if there are none.
    ///
    /// It is a rectangle along a longest diagonal. If the corners are not near this diagonal, lines along the edges
    /// cut it.
    pub(super) fn around(corners: &[DVec2], margin: f64) -> Option<Self> {
        let first = *corners.first()?;
        let square = |p: &&DVec2| p.distance_squared(first);
        let farthest = corners.iter().max_by(|p, q| square(p).total_cmp(&square(q)))?;
        let along = (*farthest - first).try_normalize().unwrap_or(DVec2::X);
        let side = |normal: DVec2| {
            let least = corners.iter().map(|p| normal.dot(*p)).fold(f64::INFINITY, f64::min);
            Line::new(normal, least - margin)
        };
        let across = corners.iter().map(|p| along.perp_dot(*p - first));
        let [low, high] = across.fold([0.0_f64; 2], |[low, high], v| [low.min(v), high.max(v)]);
        let mut sides = Vec::new();
        if high - low > THIN * margin {
            let turn = |i: usize| (corners[i] - first).perp_dot(corners[i - 1] - first);
            let facing = (2..corners.len()).map(turn).sum::<f64>();
            for (i, &p) in corners.iter().enumerate() {
                let edge = corners[(i + 1) % corners.len()] - p;
                if edge.length() > margin {
                    sides.push(side((edge.perp() * -facing.signum()).normalize()));
                }
            }
        }
        sides.extend([along.perp(), -along.perp(), along, -along].map(side));
        Some(Self { sides })
    }

    /// Checks whether a side of the polygon separates it from another one.
    pub(super) fn is_apart(&self, piece: &Piece) -> bool {
        self.sides.iter().any(|side| piece.corners.iter().all(|p| side.value(*p) <= 0.0))
    }
}
