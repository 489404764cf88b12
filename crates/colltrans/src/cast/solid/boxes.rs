//! What the boxes around two bodies tell of a cast, before anything is searched: that one passes the other, or that they
//! touch, so that nothing but their exact places says more.

use super::{Cast, NOISES, SolidFree};
use crate::answer::{Clearance, Separation, SolidSteps};
use crate::body::solid::Solid;
use crate::number::noise::Noise;
use crate::solve::solid::scene::permutes;
use crate::solve::solid::separate::Boxes;

/// Boxes touch that are apart, or overlap, by so many noises.
const TOUCHING: f64 = 16.0;

impl Cast<'_, Solid> {
    /// That nothing stops the moving body, if a plane along the direction parts the boxes.
    pub(super) fn passing(&self) -> Option<Clearance<Solid>> {
        let (setting, options) = (&self.setting, self.options);
        if options.keep > 0.0 || options.overlapping == Some(true) {
            return None;
        }
        let bodies = [self.moving(), self.fixed()];
        let noise = setting.noise().point();
        // Shrunk, they have more room.
        let slack = TOUCHING * noise + 2.0 * options.tolerance.unwrap_or(NOISES * noise);
        let normal = Boxes::new(setting, &bodies.map(Solid::bounds)).across(slack)?;
        let tolerance = self.tolerance();
        self.check_left(tolerance).ok()?;
        let (boxes, noise) = self.shrunk_boxes(tolerance / 2.0);
        let margin = boxes.margin(normal, noise);
        let separation = options.before.is_none().then_some(Separation { normal, margin });
        let free = SolidFree { separation, steps: SolidSteps::default() };
        (margin > 0.0).then_some(Clearance::Free(free))
    }

    /// Whether the moving body leaves the other one behind, by their boxes, shrunk by an amount.
    pub(super) fn leaves_behind(&self, amount: f64) -> bool {
        let (boxes, noise) = self.shrunk_boxes(amount);
        boxes.are_left_behind(noise)
    }

    /// The boxes of the bodies, shrunk by an amount, and the noise then.
    fn shrunk_boxes(&self, amount: f64) -> (Boxes<'_, '_>, f64) {
        let bodies = [self.moving(), self.fixed()];
        let moved: f64 = bodies.map(|body| body.moved_by(amount)).iter().sum();
        let noise = Noise::of(self.setting.scale() + moved).point();
        (Boxes::new(&self.setting, &bodies.map(|body| body.box_shrunk_by(amount))), noise)
    }

    /// Whether the bodies have the axes of the world, up to signs, and their boxes touch, to within rounding.
    pub(super) fn boxes_touch(&self) -> bool {
        let (setting, options) = (&self.setting, self.options);
        if options.keep > 0.0 || options.overlapping == Some(true) {
            return false;
        }
        let matrices = [&setting.moving_matrix, &setting.fixed_matrix];
        if !matrices.iter().all(|matrix| permutes(**matrix)) {
            return false;
        }
        let boxes = [self.moving(), self.fixed()].map(Solid::bounds);
        let [p, q] = [0, 1].map(|k| *matrices[k] * boxes[k].center());
        let [a, b] = [0, 1].map(|k| (*matrices[k] * (boxes[k].size() * 0.5)).abs());
        let room = ((q + setting.offset - p).abs() - a - b).max_element();
        room.abs() <= TOUCHING * setting.noise().point()
    }
}
