//! Bodies with rims as what they nearly are, hulls of a few ellipses and points; and a face near the line by these.
//!
//! Notation. An *outline* is that of a body: rims, ellipses that many corners lie on, and corners for themselves.
//! Along `n = (a, 1)` the lowest point of a rim is at `c.n - |u.n, v.n|`, with `c` its centre and `u`, `v`
//! semi-diameters, and that of the body is the lowest one of its rims. `f(a)`, what both come to together, is
//! greatest where the bodies meet. Either the line goes through a rim while the other body has its lowest point along
//! the rim's axis: a corner meets a *cap*, whose corners around the line are told by their angles. Or
//! [`mod@super::outline_maximum`] leads there, and the body's own support point is a corner of a face near the line.
//!
//! However many corners the rims have, none but those are looked at. It is a guess: what it leads to is proven, or
//! passed over, as all is that leads to the line.

use glam::{DMat2, DVec2, DVec3};

use super::face_walk::{Followed, OF_RIMS, approach};
use super::outline_maximum::{Highest, highest};
use super::{Context, FirstNormal, Known, Portal, normal_of};
use crate::body::{MOST_RIMS, Rim};
use crate::setting::VertexPair;
use crate::setting::minkowski::{MinkowskiDifference, Point};
use crate::solve::observe::Observer;

/// Rims this near upright, as the cosine of their inclination, have no plane that a corner could meet.
const UPRIGHT: f64 = 1e-3;

/// From a guess of the normal to a face near the line by the outlines; `None` if not both bodies have one, or these are
/// not seen to meet.
#[inline(never)]
pub(crate) fn between_outlines<O: Observer>(
    context: &mut Context<O>,
    start: &FirstNormal,
) -> Option<(Followed, FirstNormal)> {
    let difference = &context.difference;
    let setting = difference.setting;
    if setting.moving.outline().len() == 0 || setting.fixed.outline().len() == 0 {
        return None;
    }
    let mut outlines = [Outline::NONE; 2];
    outlines[0].see_moving(difference);
    outlines[1].see_fixed(difference);
    if let Some(portal) = cap(difference, &outlines) {
        return Some((Followed::Portal(portal, Known::FaceByFace), *start));
    }
    let near = |rims: [usize; 2]| {
        let [moving, fixed] = [0, 1].map(|body| outlines[body].rims[rims[body]].vertex);
        VertexPair::of(moving, fixed)
    };
    Some(match highest(&outlines, start.normal.truncate())? {
        Highest::At(slope, rims) => {
            let guess = FirstNormal { normal: normal_of(slope), near: Some(near(rims)) };
            approach(context, &guess, &OF_RIMS)
        }
        Highest::Beyond(ahead, rims) => {
            (Followed::Rim { outward: -ahead, edge: [near(rims); 2] }, *start)
        }
    })
}

/// A rim of `M` where the other body is one point, in the shadow frame.
#[derive(Clone, Copy)]
pub(super) struct Seen {
    center: DVec3,
    semi_axes: [DVec3; 2],
    vertex: u32,
    is_point: bool,
    /// Whether the body's part of `M` ends at its plane: to the side that [`Self::axis`] points to, and to the other.
    ends: [bool; 2],
}

/// That of one body, by which `M` has it: of P turned over.
pub(super) struct Outline {
    pub(super) rims: [Seen; MOST_RIMS],
    count: usize,
}

/// Height, gradient and downward curvature at a slope.
#[derive(Clone, Copy, Default)]
pub(super) struct Local {
    pub(super) value: f64,
    pub(super) gradient: DVec2,
    pub(super) curvature: DMat2,
}

impl Outline {
    const NONE: Self = Self { rims: [Seen::POINT; MOST_RIMS], count: 0 };

    fn see_moving(&mut self, difference: &MinkowskiDifference) {
        self.see(difference.setting.moving.outline(), |rim| {
            let [to, away] = rim.ends;
            Seen {
                center: -difference.shadow_of_moving(rim.center),
                ends: [away, to],
                ..Seen::of(rim, |axis| difference.shadow_of_moving(axis))
            }
        });
    }

    fn see_fixed(&mut self, difference: &MinkowskiDifference) {
        self.see(difference.setting.fixed.outline(), |rim| Seen {
            center: difference.difference(DVec3::ZERO, rim.center),
            ..Seen::of(rim, |axis| difference.shadow_of_fixed(axis))
        });
    }

    fn see(&mut self, rims: impl ExactSizeIterator<Item = Rim>, seen: impl Fn(&Rim) -> Seen) {
        self.count = rims.len();
        for (place, rim) in self.rims.iter_mut().zip(rims) {
            *place = seen(&rim);
        }
    }

    /// The rim that is lowest along a normal, and its height.
    pub(super) fn lowest(&self, normal: DVec3) -> (usize, f64) {
        let (mut lowest, mut least) = (0, f64::INFINITY);
        for (k, rim) in self.rims[..self.count].iter().enumerate() {
            let height = rim.height(normal);
            if height < least {
                (lowest, least) = (k, height);
            }
        }
        (lowest, least)
    }
}

impl Seen {
    const POINT: Self = Self {
        center: DVec3::ZERO,
        semi_axes: [DVec3::ZERO; 2],
        vertex: 0,
        is_point: true,
        ends: [false; 2],
    };

    /// A body's, but for its centre.
    fn of(rim: &Rim, seen: impl Fn(DVec3) -> DVec3) -> Self {
        let point = Self { vertex: rim.vertex, ..Self::POINT };
        if rim.is_point() {
            return point;
        }
        let semi_axes = rim.semi_axes.map(seen);
        Self { semi_axes, is_point: false, ends: rim.ends, ..point }
    }

    /// Across it, any length.
    fn axis(&self) -> DVec3 {
        self.semi_axes[0].cross(self.semi_axes[1])
    }

    /// Normals of three corners around a place that the line has in the shadow, counter-clockwise about the axis; `None` if
    /// it is outside.
    fn around(&self, line: DVec2) -> Option<[DVec3; 3]> {
        let ([u, v], axis) = (self.semi_axes, self.axis());
        // In coordinates in which the rim is a circle of radius 1.
        let off = line - self.center.truncate();
        let [x, y] = [off.perp_dot(v.truncate()), u.truncate().perp_dot(off)];
        let place = DVec2::new(x, y) / axis.z;
        let distance = place.length();
        if distance >= 1.0 {
            return None;
        }
        // One behind, and two between which the line is half as far from the rim as it is without them.
        let ahead = if distance > 0.0 { place / distance } else { DVec2::X };
        let along = 0.5 * (1.0 + distance);
        let aside = ahead.perp() * (1.0 - along * along).sqrt();
        let corners = [ahead * along - aside, ahead * along + aside, -ahead];
        let [of_x, of_y] = [axis.cross(v), u.cross(axis)];
        Some(corners.map(|corner| of_x * corner.x + of_y * corner.y))
    }

    /// The height of its lowest point along a normal.
    fn height(&self, normal: DVec3) -> f64 {
        let height = self.center.dot(normal);
        if self.is_point {
            return height;
        }
        let [u, v] = self.semi_axes.map(|axis| axis.dot(normal));
        height - (u * u + v * v).sqrt()
    }

    /// Its lowest point along a normal.
    pub(super) fn at(&self, normal: DVec3) -> Local {
        let mut local = Local {
            value: self.center.dot(normal),
            gradient: self.center.truncate(),
            curvature: DMat2::ZERO,
        };
        if self.is_point {
            return local;
        }
        let [u, v] = self.semi_axes;
        let (along_u, along_v) = (u.dot(normal), v.dot(normal));
        let reach = (along_u * along_u + along_v * along_v).sqrt();
        if reach > 0.0 {
            let inverse = 1.0 / reach;
            local.value -= reach;
            local.gradient -= (u * along_u + v * along_v).truncate() * inverse;
            // The curvature of an ellipse has one direction.
            let way = (u * along_v - v * along_u).truncate();
            let bent = way * (inverse * inverse * inverse);
            local.curvature = DMat2::from_cols(way * bent.x, way * bent.y);
        }
        local
    }
}

/// A portal in the face of `M` across a rim, if the line meets it there.
fn cap(difference: &MinkowskiDifference, outlines: &[Outline; 2]) -> Option<Portal> {
    let numbers = |of: usize| (0..outlines[of].count).map(move |k| (of, k));
    numbers(0).chain(numbers(1)).find_map(|(of, k)| {
        let rim = &outlines[of].rims[k];
        if rim.ends == [false; 2] {
            return None;
        }
        let axis = rim.axis();
        let is_lowest = rim.ends[usize::from(axis.z > 0.0)];
        if !is_lowest || axis.z.abs() <= UPRIGHT * axis.length() {
            return None;
        }
        let normal = normal_of(axis.truncate() / axis.z);
        let other = &outlines[1 - of];
        let opposite = &other.rims[other.lowest(normal).0];
        let places = rim.around(-opposite.at(normal).gradient)?;
        let vertices = [rim.vertex, opposite.vertex];
        let mut portal = if of == 0 {
            places.map(|place| corner(difference, vertices, [place, normal]))
        } else {
            let [own, opposite] = vertices;
            places.map(|place| corner(difference, [opposite, own], [normal, place]))
        };
        if axis.z < 0.0 {
            portal.swap(0, 1);
        }
        let [a, b, c] = &portal;
        let is_left = |from, to| difference.is_left_rounded(from, to) == Some(true);
        (is_left(a, b) && is_left(b, c) && is_left(c, a)).then_some(portal)
    })
}

/// The point of `M` of which either body's is the one of its rim that is lowest in `M` along a normal, given a vertex of
/// each rim.
fn corner(
    difference: &MinkowskiDifference,
    [moving, fixed]: [u32; 2],
    [of_moving, of_fixed]: [DVec3; 2],
) -> Point {
    let setting = difference.setting;
    let moving = setting.moving.farthest_on_rim(difference.in_moving(of_moving), moving);
    let fixed = setting.fixed.farthest_on_rim(-difference.in_fixed(of_fixed), fixed);
    difference.vertex(VertexPair::of(moving, fixed))
}
