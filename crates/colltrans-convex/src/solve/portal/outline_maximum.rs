//! Maximises `f` over two outlines by a damped active-set Newton method (`docs/theory/normal-guesses.md`).
//!
//! - *Active set*: the rims that attain the minimum of their body at the maximum of `f`, one to three of a body. Both
//!   bodies have at most four, because a slope has two coordinates.
//! - *Step*: to the slope at which the active rims of each body have equal heights and the second-order model of `f`
//!   is greatest.
//! - *Multipliers*: the weights with which the gradients of the active rims cancel. A rim with a negative multiplier
//!   leaves the active set, and the lowest rim at a new slope enters it.
//! - *Damping*: after a step that decreases `f`, the next one starts at the same slope and is at most half as long. It
//!   uses added curvature, and the rims found at the end of the failed step.

use glam::{DMat2, DVec2, DVec3};

use super::normal_of;
use super::outline::{HeightExpansion, Outline};

/// Maximum number of steps.
const MAX_STEPS: usize = 24;
/// Maximum length of a step, relative to the length of the normal.
const MAX_STEP: f64 = 0.5;
/// Length of a step, relative to the normal, at which the iteration has converged.
const CONVERGED_STEP: f64 = 1e-4;

/// Damping after the first step that decreases `f`, as a fraction of the curvature's trace (measured).
const FIRST_DAMPING: f64 = 0.1;
/// Factor of the damping after another step that decreases `f` (measured).
const DAMPING_GROWTH: f64 = 2.0;
/// Factor of the damping after a step that does not decrease `f` (measured).
const DAMPING_DECAY: f64 = 0.2;

/// Maximum number of active rims of both bodies.
const MAX_ACTIVE: usize = 4;

/// Ratio of the curvatures in two directions below which the smaller one counts as zero.
const MIN_CURVATURE_RATIO: f64 = 1e-9;

/// Active set of one body: indices of rims, and their multipliers, which sum to 1.
#[derive(Clone, Copy, Default)]
pub(super) struct ActiveSet {
    rims: [usize; MAX_ACTIVE],
    multipliers: [f64; MAX_ACTIVE],
    count: usize,
}

/// Result of the maximisation.
pub(super) enum Maximum {
    /// The slope of the maximum, and the active set of each body.
    At(DVec2, [ActiveSet; 2]),
    /// `f` has no maximum, because the line misses the outlines: along this lateral direction all of
    /// their difference is at positive coordinates. Contains the direction and the lowest rim of each body along
    /// it.
    Separated(DVec2, [usize; 2]),
}

/// Maximises `f`, starting at the slope `near`.
///
/// Returns the best slope found if the iteration does not converge. `None` if a step is not finite.
pub(super) fn maximise(outlines: &[Outline; 2], near: DVec2) -> Option<Maximum> {
    let (mut slope, mut greatest) = (near, f64::NEG_INFINITY);
    let (mut max_step, mut damping) = (MAX_STEP, 0.0);
    let mut active = [ActiveSet::default(); 2];
    // The best slope found, and the step from there that is evaluated next.
    let (mut best, mut step) = (near, DVec2::ZERO);
    for _ in 0..MAX_STEPS {
        let lowest = outlines.each_ref().map(|outline| outline.lowest(normal_of(slope)));
        add_lowest(&mut active, lowest.map(|(rim, _)| rim));
        let height = lowest[0].1 + lowest[1].1;
        if height >= greatest {
            (best, greatest) = (slope, height);
            (max_step, damping) = ((2.0 * max_step).min(MAX_STEP), DAMPING_DECAY * damping);
        } else {
            max_step = 0.5 * (step.length_squared() / normal_of(best).length_squared()).sqrt();
            damping = (DAMPING_GROWTH * damping).max(FIRST_DAMPING);
        }
        let normal = normal_of(best);
        step = newton_step(outlines, &mut active, normal, damping);
        let (square, size) = (step.length_squared(), normal.length_squared());
        if !square.is_finite() {
            return None;
        }
        let most = max_step * max_step * size;
        if square > most {
            step *= (most / square).sqrt();
        }
        slope = best + step;
        if square <= CONVERGED_STEP * CONVERGED_STEP * size {
            return Some(Maximum::At(slope, active));
        }
        if square > most
            && let Some(rims) = separating_rims(outlines, slope)
        {
            return Some(Maximum::Separated(slope, rims));
        }
    }
    Some(Maximum::At(best, active))
}

/// Returns the lowest rims along the lateral direction `ahead`, if the difference of the outlines lies
/// at positive coordinates along it. Then `f` has no maximum.
fn separating_rims(outlines: &[Outline; 2], ahead: DVec2) -> Option<[usize; 2]> {
    let lowest = outlines.each_ref().map(|outline| outline.lowest(ahead.extend(0.0)));
    (lowest[0].1 + lowest[1].1 > 0.0).then(|| lowest.map(|(rim, _)| rim))
}

impl ActiveSet {
    /// Returns the first active rim.
    pub(super) fn first_rim(&self) -> usize {
        self.rims[0]
    }

    /// Returns the active rims with their multipliers.
    pub(super) fn weighted_rims(&self) -> impl Iterator<Item = (usize, f64)> {
        let rims = self.rims.iter().zip(&self.multipliers).take(self.count);
        rims.map(|(&rim, &multiplier)| (rim, multiplier))
    }

    /// Adds a rim with a multiplier of 0, or of 1 if it is the only one.
    fn add(&mut self, rim: usize) {
        if !self.rims[..self.count].contains(&rim) {
            (self.rims[self.count], self.multipliers[self.count]) = (rim, 0.0);
            self.count += 1;
            if self.count == 1 {
                self.multipliers[0] = 1.0;
            }
        }
    }

    /// Removes the rim at position `k`, and scales the other multipliers to sum 1.
    fn remove(&mut self, k: usize) {
        self.count -= 1;
        self.rims[k] = self.rims[self.count];
        self.multipliers[k] = self.multipliers[self.count];
        let sum = self.multipliers[..self.count].iter().sum::<f64>();
        for multiplier in &mut self.multipliers[..self.count] {
            *multiplier = if sum > 0.0 { *multiplier / sum } else { 1.0 / self.count as f64 };
        }
    }

    /// Returns the position and the value of the smallest multiplier.
    fn smallest_multiplier(&self) -> (usize, f64) {
        let least = (0..self.count)
            .fold(0, |k, j| if self.multipliers[j] < self.multipliers[k] { j } else { k });
        (least, self.multipliers[least])
    }
}

/// Adds the lowest rim of each body to the active sets.
///
/// If these become too large, removes the rim with the smallest multiplier. Two pairs of equal rims,
/// or three rims of one body and one of the other, already determine a slope.
fn add_lowest(active: &mut [ActiveSet; 2], lowest: [usize; 2]) {
    for body in 0..2 {
        active[body].add(lowest[body]);
        while active[0].count + active[1].count > MAX_ACTIVE {
            let known = |body: usize| {
                let ActiveSet { rims, multipliers, count } = &active[body];
                let others = (0..*count).filter(move |&k| *count > 1 && rims[k] != lowest[body]);
                others.map(move |k| (body, k, multipliers[k]))
            };
            let least = known(0).chain(known(1)).reduce(|a, b| if b.2 < a.2 { b } else { a });
            let Some((other, k, _)) = least else { return };
            active[other].remove(k);
        }
    }
}

/// Returns the Newton step to the maximum, and removes rims with negative multipliers.
///
/// `damping` times its trace is added to the diagonal of the curvature.
fn newton_step(
    outlines: &[Outline; 2],
    active: &mut [ActiveSet; 2],
    normal: DVec3,
    damping: f64,
) -> DVec2 {
    let mut locals = [[HeightExpansion::default(); MAX_ACTIVE]; 2];
    for (body, locals) in locals.iter_mut().enumerate() {
        for (local, &rim) in locals.iter_mut().zip(&active[body].rims[..active[body].count]) {
            *local = outlines[body].rims[rim].expansion_at(normal);
        }
    }
    loop {
        let gradient = locals[0][0].gradient + locals[1][0].gradient;
        let mut curvature = DMat2::ZERO;
        let mut constraints = [EqualHeights::default(); 2];
        let mut count = 0;
        for (body, ActiveSet { multipliers, count: rims, .. }) in active.iter().enumerate() {
            let first = &locals[body][0];
            for (k, rim) in locals[body][..*rims].iter().enumerate() {
                curvature += rim.curvature * multipliers[k];
                if k > 0 {
                    let gradient_difference = first.gradient - rim.gradient;
                    constraints[count] = EqualHeights {
                        body,
                        k,
                        gradient_difference,
                        height_difference: rim.value - first.value,
                    };
                    count += 1;
                }
            }
        }
        let more = damping * (curvature.x_axis.x + curvature.y_axis.y);
        curvature += DMat2::from_diagonal(DVec2::splat(more));
        let (step, multipliers) = match &constraints[..count] {
            [] => return step_without_constraint(gradient, curvature, normal),
            [one] => step_on_constraint(gradient, curvature, one, normal),
            [one, other, ..] => step_to_crossing(gradient, curvature, [one, other]),
        };
        if !step.is_finite() {
            return step;
        }
        for body in active.iter_mut() {
            body.multipliers[0] = 1.0;
        }
        for (&EqualHeights { body, k, .. }, multiplier) in
            constraints[..count].iter().zip(multipliers)
        {
            active[body].multipliers[k] = multiplier;
            active[body].multipliers[0] -= multiplier;
        }
        let [p, q] = active.each_ref().map(ActiveSet::smallest_multiplier);
        let (body, (k, multiplier)) = if p.1 <= q.1 { (0, p) } else { (1, q) };
        if multiplier >= 0.0 {
            return step;
        }
        for multiplier in active.iter_mut().flat_map(|body| &mut body.multipliers) {
            *multiplier = multiplier.max(0.0);
        }
        active[body].remove(k);
        locals[body][k] = locals[body][active[body].count];
    }
}

/// Constraint that an active rim is as high as the first active rim of its body.
#[derive(Clone, Copy, Default)]
struct EqualHeights {
    body: usize,
    k: usize,
    /// Gradient of the first rim minus that of this rim.
    gradient_difference: DVec2,
    /// Height of this rim minus that of the first rim.
    height_difference: f64,
}

/// Returns the step to the maximum if each body has one active rim. If the curvature is nearly
/// singular, the step has maximum length and follows the gradient.
fn step_without_constraint(gradient: DVec2, curvature: DMat2, normal: DVec3) -> DVec2 {
    let [xx, xy, yy] = [curvature.x_axis.x, curvature.x_axis.y, curvature.y_axis.y];
    let (det, trace) = (xx * yy - xy * xy, xx + yy);
    if det > MIN_CURVATURE_RATIO * trace * trace {
        curvature.inverse() * gradient
    } else {
        gradient * (MAX_STEP * normal.length() / gradient.length())
    }
}

/// Returns the step to the maximum on the line where two rims of one body have equal heights, and the
/// multiplier of the second rim.
fn step_on_constraint(
    gradient: DVec2,
    curvature: DMat2,
    &EqualHeights { gradient_difference, height_difference, .. }: &EqualHeights,
    normal: DVec3,
) -> (DVec2, [f64; 2]) {
    let square = gradient_difference.length_squared();
    let to_equal = gradient_difference * (height_difference / square);
    let along = gradient_difference.perp();
    let bending = along.dot(curvature * along);
    let ahead = along.dot(gradient - curvature * to_equal);
    let rest = if bending > MIN_CURVATURE_RATIO * square {
        ahead / bending
    } else {
        (MAX_STEP * normal.length() / square.sqrt()).copysign(ahead)
    };
    let step = to_equal + along * rest;
    // At the maximum the weighted gradients balance the curvature term.
    let multiplier = gradient_difference.dot(gradient - curvature * step) / square;
    (step, [multiplier, 0.0])
}

/// Returns the step to the slope at which both constraints hold, and the multipliers of their rims.
fn step_to_crossing(
    gradient: DVec2,
    curvature: DMat2,
    [f, g]: [&EqualHeights; 2],
) -> (DVec2, [f64; 2]) {
    let rows = DMat2::from_cols(f.gradient_difference, g.gradient_difference);
    let step = rows.transpose().inverse() * DVec2::new(f.height_difference, g.height_difference);
    (step, (rows.inverse() * (gradient - curvature * step)).to_array())
}
