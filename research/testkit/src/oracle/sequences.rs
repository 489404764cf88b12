//! Draws sequences of settings: the same two bodies after each of many changes of poses, direction and graze
//! tolerance.
//!
//! A *walk* is a function of the family's name and a seed, so that `FAMILY:SEED:STEP` in a report suffices to
//! replay it. Each change is drawn with a number of repetitions, so that some parts of a walk are smooth
//! motions and others jump.

use std::f64::consts::TAU;
use std::fmt;

use colltrans::{MIN_MAGNITUDE, Pose};
use glam::{DQuat, DVec3};

use crate::oracle::settings::{Setting, setting};
use crate::random::Random;

/// Maximum number of repetitions of a change.
const LONGEST_RUN: i64 = 8;

/// Offset of the seeds of other configurations of a walk, far from the seeds of walks.
const OTHER_SEEDS: u64 = 1 << 60;

/// Corners of a shadow that are nearer than this fraction of its size count as one.
const SAME: f64 = 1e-9;

/// The poses of the bodies, and the direction.
#[derive(Debug, Clone, Copy)]
struct Configuration {
    moving: Pose,
    fixed: Pose,
    direction: DVec3,
}

/// A change from one setting to the next.
#[derive(Debug, Clone, Copy)]
enum Change {
    /// No change.
    Repeat,
    /// Exchanges the configuration with another one.
    Alternate,
    /// Rotates a body about its centre and translates it.
    Motion { of_moving: bool, turn: DQuat, displacement: DVec3 },
    /// Rotates the direction.
    Turn(DQuat),
    /// Sets the direction.
    Direction(DVec3),
    /// Reverses the direction.
    Reverse,
    /// Sets the poses and the direction of another setting of the family.
    Other(u64),
    /// Moves to a position relative to the fixed body.
    Jump { rotation: DQuat, to: DVec3 },
    /// Moves the moving body laterally so that the shadows touch, or overlap by this length.
    Rim { toward: DVec3, along: f64, overlap: f64 },
    /// Sets the graze tolerance.
    Tolerance(f64),
}

/// A random walk of settings.
#[derive(Debug, Clone)]
pub struct Walk {
    /// The current setting.
    pub setting: Setting,
    /// The number of past changes.
    pub step: u32,
    other: Configuration,
    change: Change,
    /// The number of remaining repetitions of the change.
    left: i64,
    rng: Random,
}

impl fmt::Display for Walk {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.setting, self.step)
    }
}

impl Walk {
    /// Starts with the setting of a family with a seed.
    ///
    /// # Panics
    /// If the family is unknown.
    pub fn new(family: &str, seed: u64) -> Self {
        let setting = setting(family, seed);
        let other = Configuration::of(&setting);
        let rng = Random::new(!seed);
        Self { setting, step: 0, other, change: Change::Repeat, left: 0, rng }
    }

    /// Performs a change.
    pub fn advance(&mut self) {
        if self.left == 0 {
            self.change = self.draw();
            self.left = self.rng.int(1, LONGEST_RUN);
        }
        self.left -= 1;
        self.step += 1;
        self.apply();
    }

    /// Draws a change.
    fn draw(&mut self) -> Change {
        let size = self.size();
        let rng = &mut self.rng;
        match rng.int(0, 15) {
            0 => Change::Repeat,
            1 => Change::Alternate,
            2 => Change::Turn(draw_rotation(rng, [-15.0, -9.0])),
            3 => Change::Turn(draw_rotation(rng, [-3.0, -0.5])),
            4 => Change::Direction(any_direction(rng) * rng.range(-7.0, 7.0).exp()),
            5 => Change::Reverse,
            6 => Change::Other(rng.bits() % OTHER_SEEDS + OTHER_SEEDS),
            7 => Change::Jump { rotation: rng.rotation(), to: rng.vector() * size * 2.0 },
            8 | 9 => {
                let overlap = size * draw_overlap(rng);
                let along = rng.pick(&[0.0, 0.5, rng.clone().unit()]);
                Change::Rim { toward: rng.direction(), along, overlap }
            }
            10 => Change::Tolerance(size * rng.pick(&[0.0, 0.0, 0.0, 1e-9, 1e-4, 1e-2])),
            _ => self.motion(size),
        }
    }

    /// Draws a translation, a rotation, a screw motion or a step on a grid, which is tiny, small, or along the
    /// direction.
    fn motion(&mut self, size: f64) -> Change {
        let setting = &self.setting;
        let rng = &mut self.rng;
        let exponents = rng.pick(&[[-15.0, -9.0], [-3.0, -1.3]]);
        let step = size * ten_to(rng, exponents);
        let (axis, turn) = (rng.direction(), draw_rotation(rng, exponents));
        let (turn, displacement) = match rng.int(0, 5) {
            0 => (DQuat::IDENTITY, axis * step),
            1 => (turn, DVec3::ZERO),
            2 => (turn, rng.direction() * step),
            3 => {
                let along = rng.range(-1.0, 1.0) * size;
                (DQuat::IDENTITY, setting.direction.normalize() * along)
            }
            4 => {
                let quarters = TAU * rng.pick(&[0.25, 0.5, 0.125]);
                (DQuat::from_axis_angle(rng.pick(&DVec3::AXES), quarters), DVec3::ZERO)
            }
            _ => {
                // Steps of powers of two along the axes of the fixed body preserve ties.
                let unit = size.log2().floor().exp2() * rng.pick(&[0.125, 0.25, 1.0]);
                (DQuat::IDENTITY, setting.fixed_pose.matrix() * (rng.grid(-1, 1) * unit))
            }
        };
        Change::Motion { of_moving: !rng.one_in(4), turn, displacement }
    }

    /// Applies the change to the setting.
    fn apply(&mut self) {
        let setting = &mut self.setting;
        match self.change {
            Change::Repeat => {}
            Change::Alternate => {
                let here = Configuration::of(setting);
                std::mem::replace(&mut self.other, here).place(setting);
            }
            Change::Motion { of_moving, turn, displacement } => {
                let (points, pose) = if of_moving {
                    (&setting.moving, &mut setting.moving_pose)
                } else {
                    (&setting.fixed, &mut setting.fixed_pose)
                };
                *pose = moved_pose(points, pose, turn, displacement);
            }
            Change::Turn(turn) => {
                setting.direction = without_tiny_components(turn * setting.direction);
            }
            Change::Direction(direction) => setting.direction = direction,
            Change::Reverse => setting.direction = -setting.direction,
            Change::Other(seed) => {
                self.other = Configuration::of(setting);
                Configuration::of(&crate::oracle::settings::setting(setting.family, seed))
                    .place(setting);
                // Repeating this change has no effect.
                self.left = 0;
            }
            Change::Jump { rotation, to } => {
                self.other = Configuration::of(setting);
                let target = setting.fixed_pose.transform_point(mean_point(&setting.fixed)) + to;
                let at = target - rotation * mean_point(&setting.moving);
                setting.moving_pose =
                    Pose::new(rotation, without_tiny_components(at)).expect("in range");
                self.left = 0;
            }
            Change::Rim { toward, along, overlap } => {
                let displacement = rim_displacement(setting, toward, along, overlap);
                let pose = &setting.moving_pose;
                setting.moving_pose =
                    moved_pose(&setting.moving, pose, DQuat::IDENTITY, displacement);
            }
            Change::Tolerance(tolerance) => setting.graze_tolerance = tolerance,
        }
    }

    /// Returns the larger or the smaller diameter of the bodies, or 1 for two points.
    fn size(&mut self) -> f64 {
        let (moving, fixed) = (diameter(&self.setting.moving), diameter(&self.setting.fixed));
        let (large, small) = (moving.max(fixed), moving.min(fixed));
        if small > 0.0 && self.rng.one_in(2) {
            small
        } else if large > 0.0 {
            large
        } else {
            1.0
        }
    }
}

impl Configuration {
    /// Returns the configuration of a setting.
    fn of(setting: &Setting) -> Self {
        let Setting { moving_pose, fixed_pose, direction, .. } = *setting;
        Self { moving: moving_pose, fixed: fixed_pose, direction }
    }

    /// Sets the configuration of a setting.
    fn place(self, setting: &mut Setting) {
        setting.moving_pose = self.moving;
        setting.fixed_pose = self.fixed;
        setting.direction = self.direction;
    }
}

/// Draws a power of ten with an exponent in a range.
fn ten_to(rng: &mut Random, [low, high]: [f64; 2]) -> f64 {
    10.0_f64.powf(rng.range(low, high))
}

/// Draws a rotation about a random axis, by an angle whose exponent is in a range.
fn draw_rotation(rng: &mut Random, exponents: [f64; 2]) -> DQuat {
    DQuat::from_axis_angle(rng.direction(), ten_to(rng, exponents))
}

/// Draws an axis, a diagonal of the grid, or any direction.
fn any_direction(rng: &mut Random) -> DVec3 {
    let grid = rng.grid(-1, 1);
    let grid = if grid == DVec3::ZERO { DVec3::Z } else { grid };
    let any = rng.direction();
    rng.pick(&[grid, any])
}

/// Draws an overlap of shadows as a fraction of the body's size: zero, a rounding error, or more.
fn draw_overlap(rng: &mut Random) -> f64 {
    let sign = rng.pick(&[1.0, -1.0]);
    let digits = ten_to(rng, [-16.0, -12.0]);
    let little = ten_to(rng, [-12.0, -1.0]);
    sign * rng.pick(&[0.0, digits, digits, little])
}

/// Replaces components below the exact range, which result from rounding, by zero.
fn without_tiny_components(v: DVec3) -> DVec3 {
    DVec3::from_array(v.to_array().map(|c| if c.abs() < MIN_MAGNITUDE { 0.0 } else { c }))
}

/// Returns the mean of points.
fn mean_point(points: &[DVec3]) -> DVec3 {
    points.iter().sum::<DVec3>() / points.len() as f64
}

/// Returns twice the largest distance from the mean.
fn diameter(points: &[DVec3]) -> f64 {
    let middle = mean_point(points);
    2.0 * points.iter().map(|v| v.distance(middle)).fold(0.0, f64::max)
}

/// Returns the pose of a body after a rotation about its centre and a translation.
fn moved_pose(points: &[DVec3], pose: &Pose, turn: DQuat, displacement: DVec3) -> Pose {
    if turn == DQuat::IDENTITY {
        // Without a rotation, a body on a grid remains on it.
        let at = without_tiny_components(pose.translation() + displacement);
        return Pose::new(pose.rotation(), at).expect("in range");
    }
    let middle = mean_point(points);
    let rotation = (turn * pose.rotation()).normalize();
    let at = pose.transform_point(middle) + displacement - rotation * middle;
    Pose::new(rotation, without_tiny_components(at)).expect("in range")
}

/// Returns the translation that moves a boundary point of the shadow of `M = {q - p}` onto the line, or
/// `draw_overlap` beyond it. The point is at the fraction `along` of the side from the corner farthest in the
/// direction `toward` to the next corner.
fn rim_displacement(setting: &Setting, toward: DVec3, along: f64, overlap: f64) -> DVec3 {
    let unit = setting.direction.normalize();
    let place = |points: &[DVec3], pose: &Pose| -> Vec<DVec3> {
        points.iter().map(|v| pose.transform_point(*v).reject_from_normalized(unit)).collect()
    };
    let moving = place(&setting.moving, &setting.moving_pose);
    let fixed = place(&setting.fixed, &setting.fixed_pose);
    let shadows = || fixed.iter().flat_map(|q| moving.iter().map(move |p| *q - *p));
    let farther = |a: DVec3, b: DVec3| if b.dot(toward) > a.dot(toward) { b } else { a };
    let Some(corner) = shadows().reduce(farther) else { return DVec3::ZERO };
    // Other pairs yield the same corner only up to rounding.
    let size = shadows().map(|s| s.distance(corner)).fold(0.0, f64::max);
    let others = shadows().filter(|s| s.distance(corner) > SAME * size);
    // Gift wrapping: all other points are on one side of the line to the next corner.
    let side = |a: DVec3, b: DVec3| (a - corner).cross(b - corner).dot(unit);
    let next = others.reduce(|a, b| if side(a, b) < 0.0 { b } else { a }).unwrap_or(corner);
    let inward = unit.cross(next - corner).normalize_or_zero();
    corner.lerp(next, along) + inward * overlap
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::settings::FAMILIES;
    use crate::oracle::shadow::sideways_overlap;

    #[test]
    fn walk_is_determined_by_its_name() {
        for (family, _) in FAMILIES {
            let mut walks = [0; 2].map(|_| Walk::new(family, 7));
            for _ in 0..50 {
                walks.iter_mut().for_each(Walk::advance);
                assert_eq!(walks[0].setting.dump(), walks[1].setting.dump());
            }
        }
    }

    #[test]
    fn step_to_the_rim_ends_there() {
        for seed in 0..200 {
            let mut setting = setting(["random", "boxes", "prisms"][seed as usize % 3], seed);
            let mut rng = Random::new(seed);
            let wanted = rng.range(-0.1, 0.0);
            let displacement = rim_displacement(&setting, rng.direction(), 0.5, wanted);
            setting.moving_pose =
                setting.moving_pose.translated_by(displacement).expect("in range");
            let judge_bodies = setting.bodies().expect("bodies");
            let scene = setting.judge(&judge_bodies).scene;
            let found = sideways_overlap(&scene).to_f64();
            assert!((found - wanted).abs() < 4.0 * scene.noise, "{setting}: {found} {wanted}");
        }
    }
}
