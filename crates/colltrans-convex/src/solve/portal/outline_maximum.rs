//! Where two outlines meet: the greatest value of `f`, by Newton's method.
//!
//! Of each body the rims are kept that the maximum is *between*: one, or two that are equally low there, as where a wall
//! between them is met, or three; no more than four of both, as a slope has two coordinates. The step goes to where
//! those are equal and `f` is greatest along what is left, to second order. Multipliers, the *shares* of their
//! gradients in none, tell which rims do not hold the maximum back; the rim that is lowest at a slope is one more
//! of them.
//!
//! `f` is concave, but not smooth, and bent sharply along a rim's axis: a step that leads down is taken anew, half as
//! long, with what was met there and as if `f` were bent more.

use glam::{DMat2, DVec2, DVec3};

use super::normal_of;
use super::outline::{Local, Outline};

/// Steps; the longest, as a share of the normal; and the longest that is the last.
const STEPS: usize = 24;
const LONGEST: f64 = 0.5;
const LAST: f64 = 1e-4;

/// What is added to the curvature after a step that led down, as a share of it; how many times as much after another one;
/// and what is left of that after one that did not (measured).
const DAMPED: f64 = 0.1;
const AGAIN: f64 = 2.0;
const RELAXED: f64 = 0.2;

/// Rims of both bodies that the maximum may be between.
const MOST_ACTIVE: usize = 4;

/// Of a curvature that is less than this in one direction, as a share of that in the other, nothing follows there.
const STRAIGHT: f64 = 1e-9;

/// The rims of a body that the maximum is between, and their shares in the normal there.
#[derive(Clone, Copy, Default)]
struct Active {
    rims: [usize; MOST_ACTIVE],
    shares: [f64; MOST_ACTIVE],
    count: usize,
}

/// Where two outlines are highest together, with a rim of each.
pub(super) enum Highest {
    /// At a slope.
    At(DVec2, [usize; 2]),
    /// Nowhere: all of both lies on one side of the line, along this in the shadow.
    Beyond(DVec2, [usize; 2]),
}

/// Where both outlines together are highest, from a slope near, or the highest that was come to; `None` if that is out of
/// range.
pub(super) fn highest(outlines: &[Outline; 2], near: DVec2) -> Option<Highest> {
    let (mut slope, mut greatest) = (near, f64::NEG_INFINITY);
    let (mut longest, mut damping) = (LONGEST, 0.0);
    let mut active = [Active::default(); 2];
    // The step that is tried, and where it begins.
    let (mut best, mut tried) = (near, DVec2::ZERO);
    for _ in 0..STEPS {
        let lowest = outlines.each_ref().map(|outline| outline.lowest(normal_of(slope)));
        add(&mut active, lowest.map(|(rim, _)| rim));
        let height = lowest[0].1 + lowest[1].1;
        if height >= greatest {
            (best, greatest) = (slope, height);
            (longest, damping) = ((2.0 * longest).min(LONGEST), RELAXED * damping);
        } else {
            longest = 0.5 * (tried.length_squared() / normal_of(best).length_squared()).sqrt();
            damping = (AGAIN * damping).max(DAMPED);
        }
        let normal = normal_of(best);
        tried = step(outlines, &mut active, normal, damping);
        let (square, size) = (tried.length_squared(), normal.length_squared());
        if !square.is_finite() {
            return None;
        }
        let most = longest * longest * size;
        if square > most {
            tried *= (most / square).sqrt();
        }
        slope = best + tried;
        if square <= LAST * LAST * size {
            return Some(Highest::At(slope, active.map(|body| body.rims[0])));
        }
        if square > most
            && let Some(rims) = beyond(outlines, slope)
        {
            return Some(Highest::Beyond(slope, rims));
        }
    }
    Some(Highest::At(best, active.map(|body| body.rims[0])))
}

/// The lowest rims along a direction in the shadow, if all that the outlines make together lies ahead: no slope that way is
/// the highest.
fn beyond(outlines: &[Outline; 2], ahead: DVec2) -> Option<[usize; 2]> {
    let lowest = outlines.each_ref().map(|outline| outline.lowest(ahead.extend(0.0)));
    (lowest[0].1 + lowest[1].1 > 0.0).then(|| lowest.map(|(rim, _)| rim))
}

impl Active {
    fn add(&mut self, rim: usize) {
        if !self.rims[..self.count].contains(&rim) {
            (self.rims[self.count], self.shares[self.count]) = (rim, 0.0);
            self.count += 1;
            if self.count == 1 {
                self.shares[0] = 1.0;
            }
        }
    }

    /// Without a rim, whose share the others take.
    fn remove(&mut self, k: usize) {
        self.count -= 1;
        self.rims[k] = self.rims[self.count];
        self.shares[k] = self.shares[self.count];
        let sum = self.shares[..self.count].iter().sum::<f64>();
        for share in &mut self.shares[..self.count] {
            *share = if sum > 0.0 { *share / sum } else { 1.0 / self.count as f64 };
        }
    }

    /// The rim with the least share.
    fn least(&self) -> (usize, f64) {
        let least =
            (0..self.count).fold(0, |k, j| if self.shares[j] < self.shares[k] { j } else { k });
        (least, self.shares[least])
    }
}

/// Adds the lowest rims, in place of others with the least shares if that makes too many: a slope has two coordinates, so
/// that four rims that are equal by twos, or three of one body and one of the other, are as many as can be.
fn add(active: &mut [Active; 2], lowest: [usize; 2]) {
    for body in 0..2 {
        active[body].add(lowest[body]);
        while active[0].count + active[1].count > MOST_ACTIVE {
            let known = |body: usize| {
                let Active { rims, shares, count } = &active[body];
                let others = (0..*count).filter(move |&k| *count > 1 && rims[k] != lowest[body]);
                others.map(move |k| (body, k, shares[k]))
            };
            let least = known(0).chain(known(1)).reduce(|a, b| if b.2 < a.2 { b } else { a });
            let Some((other, k, _)) = least else { return };
            active[other].remove(k);
        }
    }
}

/// Newton's step to the maximum, after which the rims are those that it is between; as if the curvature were more by a
/// share of it.
fn step(outlines: &[Outline; 2], active: &mut [Active; 2], normal: DVec3, damping: f64) -> DVec2 {
    let mut locals = [[Local::default(); MOST_ACTIVE]; 2];
    for (body, locals) in locals.iter_mut().enumerate() {
        for (local, &rim) in locals.iter_mut().zip(&active[body].rims[..active[body].count]) {
            *local = outlines[body].rims[rim].at(normal);
        }
    }
    loop {
        let gradient = locals[0][0].gradient + locals[1][0].gradient;
        let mut curvature = DMat2::ZERO;
        let mut equal = [Equal::default(); 2];
        let mut count = 0;
        for (body, Active { shares, count: rims, .. }) in active.iter().enumerate() {
            let first = &locals[body][0];
            for (k, rim) in locals[body][..*rims].iter().enumerate() {
                curvature += rim.curvature * shares[k];
                if k > 0 {
                    let across = first.gradient - rim.gradient;
                    equal[count] = Equal { body, k, across, rise: rim.value - first.value };
                    count += 1;
                }
            }
        }
        let more = damping * (curvature.x_axis.x + curvature.y_axis.y);
        curvature += DMat2::from_diagonal(DVec2::splat(more));
        let (step, shares) = match &equal[..count] {
            [] => return alone(gradient, curvature, normal),
            [one] => between(gradient, curvature, one, normal),
            [one, other, ..] => crossing(gradient, curvature, [one, other]),
        };
        if !step.is_finite() {
            return step;
        }
        for body in active.iter_mut() {
            body.shares[0] = 1.0;
        }
        for (&Equal { body, k, .. }, share) in equal[..count].iter().zip(shares) {
            active[body].shares[k] = share;
            active[body].shares[0] -= share;
        }
        let [p, q] = active.each_ref().map(Active::least);
        let (body, (k, share)) = if p.1 <= q.1 { (0, p) } else { (1, q) };
        if share >= 0.0 {
            return step;
        }
        for share in active.iter_mut().flat_map(|body| &mut body.shares) {
            *share = share.max(0.0);
        }
        active[body].remove(k);
        locals[body][k] = locals[body][active[body].count];
    }
}

/// What is to be equal: the first rim of a body and another one.
#[derive(Clone, Copy, Default)]
struct Equal {
    body: usize,
    k: usize,
    /// By how much the first one's gradient is more.
    across: DVec2,
    /// By how much the other one is higher.
    rise: f64,
}

/// To the maximum of a rim of one body with a rim of the other.
fn alone(gradient: DVec2, curvature: DMat2, normal: DVec3) -> DVec2 {
    let [xx, xy, yy] = [curvature.x_axis.x, curvature.x_axis.y, curvature.y_axis.y];
    let (det, trace) = (xx * yy - xy * xy, xx + yy);
    if det > STRAIGHT * trace * trace {
        curvature.inverse() * gradient
    } else {
        gradient * (LONGEST * normal.length() / gradient.length())
    }
}

/// To where two rims of a body are equal, and greatest along the line of that; and the share of the other.
fn between(
    gradient: DVec2,
    curvature: DMat2,
    &Equal { across, rise, .. }: &Equal,
    normal: DVec3,
) -> (DVec2, [f64; 2]) {
    let square = across.length_squared();
    let to_equal = across * (rise / square);
    let along = across.perp();
    let bent = along.dot(curvature * along);
    let ahead = along.dot(gradient - curvature * to_equal);
    let rest = if bent > STRAIGHT * square {
        ahead / bent
    } else {
        (LONGEST * normal.length() / square.sqrt()).copysign(ahead)
    };
    let step = to_equal + along * rest;
    // Of the gradients with their shares nothing is left but what the curvature takes.
    let share = across.dot(gradient - curvature * step) / square;
    (step, [share, 0.0])
}

/// The same of two pairs.
fn crossing(gradient: DVec2, curvature: DMat2, [f, g]: [&Equal; 2]) -> (DVec2, [f64; 2]) {
    let rows = DMat2::from_cols(f.across, g.across);
    let step = rows.transpose().inverse() * DVec2::new(f.rise, g.rise);
    (step, (rows.inverse() * (gradient - curvature * step)).to_array())
}
