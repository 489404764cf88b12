//! From a first portal to the faces near the line, where the bodies have rims.
//!
//! Notation. A *rim* is an ellipse that many corners of a body lie on, or one corner for itself. Where rim `i` of P
//! and rim `j` of Q are all that there is, `f_ij(a) = c.n - |u_i.n, v_i.n| - |u_j.n, v_j.n|` in the place of
//! `f(a)`, with `n = (a, 1)`, `c` the difference of the centres and `u`, `v` semi-diameters: concave, and smooth
//! but for normals across a rim's plane. The maximum of `f`, where the bodies meet, is that of the least
//! of a few `f_ij`: of one, where two rims meet; of two that are equal there, where a rim meets a wall between two
//! rims; of three, where two walls cross. Which ones is told by the corners of the portal.
//!
//! So a slope is found by Newton's method on these, from the portal's own, in a few steps however many corners
//! the rims have. The portals of [`mod@super::refine`] halve the distance in each of two ways. It is a guess: the
//! bodies' own support point there is the first corner of a face near the line, or it cuts the portal, or the
//! portal's own plane does.

use glam::{DMat2, DVec2, DVec3};

use super::follow::{Followed, OF_RIMS, approach};
use super::refine::{exchange, is_below, plane_normal};
use super::{Context, FirstNormal, Known, Portal, normal_of};
use crate::setting::VertexPair;
use crate::setting::minkowski::MinkowskiDifference;
use crate::solve::observe::{Observer, Support};

/// The number of no rim.
const NONE: u32 = u32::MAX;

/// Portals tried.
const ROUNDS: usize = 12;

/// Newton's steps; the longest, as a share of the normal; and the longest that is the last.
const STEPS: usize = 8;
const LONGEST: f64 = 0.5;
const LAST: f64 = 1e-6;

/// A face near the line, or a smaller portal.
#[inline(never)]
pub(crate) fn along_rims<O: Observer>(
    context: &mut Context<O>,
    mut portal: Portal,
) -> (Portal, Known) {
    let mut newest = 2;
    let mut tried = [[NONE; 2]; 3];
    let rounding = context.difference.noise.plane(false);
    for _ in 0..ROUNDS {
        let Some(plane) = plane_normal(&context.difference, &portal) else { break };
        context.watch.portal(|| portal.map(|p| p.at));
        let near = portal[newest].pair;
        let own = plane.truncate() / plane.z;
        let Some(rims) = rims_of(&context.difference, &portal) else { break };
        let model = || Model::new(&context.difference, &portal, &rims);
        if !is_same(&rims, &tried)
            && let Some(slope) = model().highest(own)
        {
            // What has led nowhere does so again.
            tried = rims;
            let start = FirstNormal { normal: normal_of(slope), near: Some(near) };
            let (followed, reached) = approach(context, &start, &OF_RIMS);
            if let Followed::Portal(portal, known) = followed {
                return (portal, known);
            }
            let cut = context.difference.point(reached.near.unwrap_or(near), start.normal);
            if is_below(&portal, plane, &cut, rounding) {
                newest = exchange(&context.difference, &mut portal, cut);
                continue;
            }
        }
        let cut = context.difference.support_from(plane, near);
        context.watch.support(|| Support::of(plane, &cut));
        if !is_below(&portal, plane, &cut, rounding) {
            break;
        }
        newest = exchange(&context.difference, &mut portal, cut);
    }
    (portal, Known::Around)
}

/// The `f_ij` of a portal's corners.
struct Model {
    pieces: [Piece; 3],
    count: usize,
}

/// One `f_ij`, in the shadow frame.
#[derive(Clone, Copy)]
struct Piece {
    center: DVec3,
    semi_axes: [[DVec3; 2]; 2],
}

/// Its value, gradient and downward curvature at a slope.
#[derive(Clone, Copy)]
struct Local {
    value: f64,
    gradient: DVec2,
    curvature: DMat2,
}

/// The numbers of the rims that the corners of a portal lie on; `None` if one is on no rim.
fn rims_of(difference: &MinkowskiDifference, portal: &Portal) -> Option<[[u32; 2]; 3]> {
    let setting = difference.setting;
    let of = |pair: VertexPair| {
        let moving = setting.moving.rim_of(pair.moving.0)?;
        Some([moving, setting.fixed.rim_of(pair.fixed.0)?])
    };
    let [a, b, c] = portal.each_ref().map(|corner| of(corner.pair));
    Some([a?, b?, c?])
}

/// Whether two portals lie on the same rims.
fn is_same(these: &[[u32; 2]; 3], those: &[[u32; 2]; 3]) -> bool {
    these.iter().all(|rims| those.contains(rims)) && those.iter().all(|rims| these.contains(rims))
}

impl Model {
    fn new(difference: &MinkowskiDifference, portal: &Portal, rims: &[[u32; 2]; 3]) -> Self {
        let piece = |k: usize| Piece::of(difference, portal[k].pair);
        let first = piece(0);
        let mut model = Self { pieces: [first; 3], count: 1 };
        for k in 1..3 {
            if !rims[..k].contains(&rims[k]) {
                model.pieces[model.count] = piece(k);
                model.count += 1;
            }
        }
        model
    }

    /// The slope at which the least of the pieces is greatest, by Newton's method from one near; `None` if that
    /// does not end.
    fn highest(&self, near: DVec2) -> Option<DVec2> {
        let mut slope = near;
        let mut share = 0.5;
        for _ in 0..STEPS {
            let step = match &self.pieces[..self.count] {
                [only] => {
                    let f = only.at(slope);
                    f.curvature.inverse() * f.gradient
                }
                [f, g] => {
                    let step;
                    (step, share) = between(&f.at(slope), &g.at(slope), share);
                    step
                }
                pieces => {
                    let [f, g, h] = [0, 1, 2].map(|k| pieces[k].at(slope));
                    let rows = DMat2::from_cols(f.gradient - g.gradient, f.gradient - h.gradient);
                    rows.transpose().inverse() * DVec2::new(g.value - f.value, h.value - f.value)
                }
            };
            let (square, size) = (step.length_squared(), 1.0 + slope.length_squared());
            if !square.is_finite() {
                return None;
            }
            let longest = LONGEST * LONGEST * size;
            let shorter = if square > longest { (longest / square).sqrt() } else { 1.0 };
            slope += step * shorter;
            if square <= LAST * LAST * size {
                return Some(slope);
            }
        }
        None
    }
}

/// Newton's step to where two pieces are equal, and greatest along the line of that; and the share of the first in
/// the normal there.
fn between(f: &Local, g: &Local, share: f64) -> (DVec2, f64) {
    let curvature = f.curvature * share + g.curvature * (1.0 - share);
    let across = f.gradient - g.gradient;
    let square = across.length_squared();
    let to_equal = across * ((g.value - f.value) / square);
    let along = across.perp();
    let rest = along.dot(g.gradient - curvature * to_equal) / along.dot(curvature * along);
    let step = to_equal + along * rest;
    (step, (across.dot(curvature * step - g.gradient) / square).clamp(0.0, 1.0))
}

impl Piece {
    fn of(difference: &MinkowskiDifference, pair: VertexPair) -> Self {
        let setting = difference.setting;
        let (moving, fixed) = (setting.moving.rim(pair.moving.0), setting.fixed.rim(pair.fixed.0));
        Self {
            center: difference.difference(moving.center, fixed.center),
            semi_axes: [
                moving.semi_axes.map(|axis| difference.shadow_of_moving(axis)),
                fixed.semi_axes.map(|axis| difference.shadow_of_fixed(axis)),
            ],
        }
    }

    fn at(&self, slope: DVec2) -> Local {
        let normal = normal_of(slope);
        let mut local = Local {
            value: self.center.dot(normal),
            gradient: self.center.truncate(),
            curvature: DMat2::ZERO,
        };
        for [u, v] in self.semi_axes {
            let (along_u, along_v) = (u.dot(normal), v.dot(normal));
            let reach = (along_u * along_u + along_v * along_v).sqrt();
            if reach > 0.0 {
                let inverse = 1.0 / reach;
                local.value -= reach;
                local.gradient -= (u * along_u + v * along_v).truncate() * inverse;
                // The curvature of an ellipse has one direction.
                let way = (u * along_v - v * along_u).truncate();
                let bent = way * (inverse * inverse * inverse);
                local.curvature += DMat2::from_cols(way * bent.x, way * bent.y);
            }
        }
        local
    }
}
