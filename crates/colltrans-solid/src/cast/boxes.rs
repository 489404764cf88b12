//! What the boxes around two bodies tell of a cast, before anything is searched: that one passes the other, or leaves it
//! behind, or that they touch, so that nothing but their exact places says more.

use glam::DVec3;

use super::{NOISES, SolidCast, SolidFree, check_left};
use crate::body::Solid;
use crate::solve::scene::permutes;
use crate::solve::separate::Boxes;
use crate::solve::steps::SolidSteps;
use colltrans_convex::answer::{Clearance, Separation};
use colltrans_convex::cast::Cast;
use colltrans_kernel::noise::Noise;

/// Boxes touch that are apart, or overlap, by so many noises.
const TOUCHING: f64 = 16.0;

/// What the boxes tell.
pub(super) enum Told {
    /// Nothing stops the moving body.
    Passing(Clearance<Solid>),
    /// They touch, to within rounding, and have the axes of the world, up to signs.
    Touching,
    Nothing,
}

/// What the boxes around the bodies tell, unless a gap is to be kept or the bodies are said to overlap.
pub(super) fn told_by_boxes(cast: &Cast<'_, Solid>) -> Told {
    let (setting, options) = (&cast.setting, cast.options);
    if options.keep > 0.0 || options.overlapping == Some(true) {
        return Told::Nothing;
    }
    let noise = setting.noise().point();
    let boxes = Boxes::new(setting, &[cast.moving().bounds(), cast.fixed().bounds()]);
    // Shrunk, they have more room.
    let slack = TOUCHING * noise + 2.0 * options.tolerance.unwrap_or(NOISES * noise);
    if let Some(passing) = boxes.across(slack).and_then(|normal| passing(cast, normal)) {
        return Told::Passing(passing);
    }
    let squared = permutes(setting.moving_matrix) && permutes(setting.fixed_matrix);
    if squared && boxes.touch(TOUCHING * noise) { Told::Touching } else { Told::Nothing }
}

/// That nothing stops the moving body, if a plane along the direction, with a normal, parts the boxes.
fn passing(cast: &Cast<'_, Solid>, normal: DVec3) -> Option<Clearance<Solid>> {
    let tolerance = cast.tolerance();
    check_left(cast, tolerance).ok()?;
    let (boxes, noise) = shrunk_boxes(cast, tolerance / 2.0);
    let margin = boxes.margin(normal, noise);
    let separation = cast.options.before.is_none().then_some(Separation { normal, margin });
    let free = SolidFree { separation, steps: SolidSteps::default() };
    (margin > 0.0).then_some(Clearance::Free(free))
}

/// Whether the moving body leaves the other one behind, by their boxes, shrunk by an amount.
pub(super) fn leaves_behind(cast: &Cast<'_, Solid>, amount: f64) -> bool {
    let (boxes, noise) = shrunk_boxes(cast, amount);
    boxes.are_left_behind(noise)
}

/// The boxes of the bodies, shrunk by an amount, and the noise then.
fn shrunk_boxes<'c>(cast: &'c Cast<'_, Solid>, amount: f64) -> (Boxes<'c, 'c>, f64) {
    let bodies = [cast.moving(), cast.fixed()];
    let moved: f64 = bodies.map(|body| body.max_offset_displacement(amount)).iter().sum();
    let noise = Noise::of(cast.setting.scale() + moved).point();
    (Boxes::new(&cast.setting, &bodies.map(|body| body.offset_bounds(amount))), noise)
}
