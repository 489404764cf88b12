//! Random numbers: `ChaCha8`, whose output is fixed by its definition, seeded by the plan's seed,
//! on a stream of its own for every purpose. So what one experiment draws does not depend on whether
//! another one ran.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng};

/// A stream of random numbers.
#[derive(Debug, Clone)]
pub struct Random(ChaCha8Rng);

impl Random {
    /// The stream for a purpose, told from others by a few numbers.
    pub fn new(seed: u64, purpose: &[u64]) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        // Horner's rule with an odd multiplier: different short lists give different streams.
        let stream = purpose
            .iter()
            .fold(1, |sum: u64, part| sum.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(*part));
        generator.set_stream(stream);
        Self(generator)
    }

    /// Uniform in `[0, 1)`, a multiple of `2^-53`.
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (0.5 * f64::EPSILON)
    }

    /// Uniform in `[low, high)`.
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// One of `0..count`; `count > 0`.
    pub fn index(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count - 1)
    }

    /// A whole number of `low..=high`.
    pub fn int(&mut self, low: i64, high: i64) -> i64 {
        low + self.index((high - low + 1) as usize) as i64
    }

    /// Uniform on the unit sphere (Archimedes: heights are uniform).
    pub fn direction(&mut self) -> DVec3 {
        let height = self.range(-1.0, 1.0);
        let angle_rad = self.range(0.0, TAU);
        let radius = (1.0 - height * height).sqrt();
        DVec3::new(radius * angle_rad.cos(), radius * angle_rad.sin(), height)
    }

    /// Uniform among all rotations (Shoemake, "Uniform random rotations", Graphics Gems III, 1992).
    pub fn rotation(&mut self) -> DQuat {
        let share = self.unit();
        let [a, b] = [self.range(0.0, TAU), self.range(0.0, TAU)];
        let [r, s] = [(1.0 - share).sqrt(), share.sqrt()];
        DQuat::from_xyzw(r * a.sin(), r * a.cos(), s * b.sin(), s * b.cos()).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_are_reproducible_and_differ() {
        let draw = |seed, purpose: &[u64]| Random::new(seed, purpose).0.next_u64();
        assert_eq!(draw(1, &[11, 200]), draw(1, &[11, 200]));
        let others =
            [draw(2, &[11, 200]), draw(1, &[11, 800]), draw(1, &[12, 200]), draw(1, &[11])];
        assert!(others.iter().all(|other| *other != draw(1, &[11, 200])));
    }

    #[test]
    fn directions_and_rotations_favour_nothing() {
        let mut random = Random::new(3, &[]);
        let count = 20_000;
        let mut sums = [DVec3::ZERO; 4];
        for _ in 0..count {
            let turn = random.rotation();
            for (sum, axis) in sums.iter_mut().zip(DVec3::AXES) {
                *sum += turn * axis;
            }
            sums[3] += random.direction();
        }
        // Five standard deviations of a mean of `count` values of variance 1/3.
        let bound = 5.0 * (1.0 / 3.0 / f64::from(count)).sqrt();
        for sum in sums {
            assert!((sum / f64::from(count)).abs().max_element() < bound, "{sum}");
        }
    }
}
