//! Answers of a cast by the bounding boxes of the two bodies, before any search.
//!
//! The boxes show that one body passes the other or leaves it behind. They also show that both may touch, in which
//! case only their exact positions decide.

use glam::DVec3;

use super::{DEFAULT_TOLERANCE_NOISES, SolidCast, SolidFree, check_thickness, core_gap};
use crate::body::Solid;
use crate::solve::scene::permutes_axes;
use crate::solve::separate::Boxes;
use crate::solve::steps::SolidSteps;
use colltrans_convex::answer::{Clearance, Separation};
use colltrans_convex::cast::Cast;
use colltrans_kernel::noise::Noise;

/// Maximum gap or overlap of boxes that count as touching, in noises.
const TOUCHING_NOISES: f64 = 16.0;

/// Result of the test of the boxes.
pub(super) enum BoxAnswer {
    /// Nothing blocks the moving body.
    Free(Clearance<Solid>),
    /// The boxes touch to within rounding, and both bodies have the axes of the world up to signs.
    Touching,
    Undecided,
}

/// Tests the boxes of the bodies. Returns [`BoxAnswer::Undecided`] if a minimum gap is set, a body is rounded or the
/// options state an overlap.
pub(super) fn answer_by_boxes(cast: &Cast<'_, Solid>) -> BoxAnswer {
    let (setting, options) = (&cast.setting, cast.options);
    if core_gap(cast) > 0.0 || options.overlapping == Some(true) {
        return BoxAnswer::Undecided;
    }
    let noise = setting.noise().point_error();
    let boxes = Boxes::new(setting, &[cast.moving().bounds(), cast.fixed().bounds()]);
    // The boxes of the offset bodies are smaller.
    let slack = TOUCHING_NOISES * noise
        + 2.0 * options.tolerance.unwrap_or(DEFAULT_TOLERANCE_NOISES * noise);
    if let Some(free) = boxes.widest_normal(slack).and_then(|normal| free_by_boxes(cast, normal)) {
        return BoxAnswer::Free(free);
    }
    let is_axis_aligned =
        permutes_axes(setting.moving_matrix) && permutes_axes(setting.fixed_matrix);
    if is_axis_aligned && boxes.are_touching(TOUCHING_NOISES * noise) {
        BoxAnswer::Touching
    } else {
        BoxAnswer::Undecided
    }
}

/// Returns a free clearance if a plane with this normal, parallel to the direction, separates the boxes of the
/// offset bodies. `None` if its proven margin is not positive or a body would vanish.
fn free_by_boxes(cast: &Cast<'_, Solid>, normal: DVec3) -> Option<Clearance<Solid>> {
    let tolerance = cast.tolerance();
    check_thickness(cast, tolerance).ok()?;
    let (boxes, noise) = offset_boxes(cast, tolerance / 2.0);
    let margin = boxes.margin(normal, noise);
    let separation = cast.options.before.is_none().then_some(Separation { normal, margin });
    let free = SolidFree { separation, steps: SolidSteps::default() };
    (margin > 0.0).then_some(Clearance::Free(free))
}

/// Checks whether the boxes, offset inwards by `amount`, are certainly separated by a side of one of them which the
/// moving body does not approach.
pub(super) fn moves_away(cast: &Cast<'_, Solid>, amount: f64) -> bool {
    let (boxes, noise) = offset_boxes(cast, amount);
    boxes.are_left_behind(noise)
}

/// Returns the boxes of the bodies offset inwards by `amount` (world units), in the bodies' frames, and the noise
/// at the size of the offset bodies.
fn offset_boxes<'c>(cast: &'c Cast<'_, Solid>, amount: f64) -> (Boxes<'c, 'c>, f64) {
    let bodies = [cast.moving(), cast.fixed()];
    let moved: f64 = bodies.map(|body| body.max_offset_displacement(amount)).iter().sum();
    let noise = Noise::for_size(cast.setting.size() + moved).point_error();
    (Boxes::new(&cast.setting, &bodies.map(|body| body.offset_bounds(amount))), noise)
}
