//! Generates random numbers for all settings, campaigns, property tests, benchmarks and laboratory experiments.
//!
//! The generator is splitmix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA
//! 2014). It has eight bytes of state and yields the same numbers on every platform. The numbers of a seed must
//! not change, because golden bits, saved cases and recorded campaigns depend on them. [`Random::stream`]
//! yields independent numbers for each purpose, so that an experiment does not depend on which others ran.

use glam::{DQuat, DVec3};

/// A stream of random numbers.
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// Starts the stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Starts the stream of a seed for a purpose, which is identified by a list of numbers.
    pub fn stream(seed: u64, purpose: &[u64]) -> Self {
        purpose.iter().fold(Self(seed), |mut random, part| Self(random.bits() ^ part))
    }

    /// Returns 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number in `[0, 1)`, a multiple of `2^-53`.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * f64::EPSILON / 2.0
    }

    /// Returns a number in `[low, high)`.
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Returns an integer in `low..=high`.
    pub fn int(&mut self, low: i64, high: i64) -> i64 {
        low + (self.bits() % (high - low + 1) as u64) as i64
    }

    /// Returns an integer in `low..=high` as a coordinate.
    pub fn whole(&mut self, low: i64, high: i64) -> f64 {
        self.int(low, high) as f64
    }

    /// Returns an index in `0..count`; `count > 0`.
    pub fn index(&mut self, count: usize) -> usize {
        self.int(0, count as i64 - 1) as usize
    }

    /// Returns `true` with probability `1 / n`.
    pub fn one_in(&mut self, n: u64) -> bool {
        self.bits().is_multiple_of(n)
    }

    /// Returns one of several values.
    pub fn pick<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.index(values.len())]
    }

    /// Returns a vector in the cube from -1 to 1.
    pub fn vector(&mut self) -> DVec3 {
        DVec3::new(self.range(-1.0, 1.0), self.range(-1.0, 1.0), self.range(-1.0, 1.0))
    }

    /// Returns a vector of integers in `low..=high`.
    pub fn grid(&mut self, low: i64, high: i64) -> DVec3 {
        DVec3::new(self.whole(low, high), self.whole(low, high), self.whole(low, high))
    }

    /// Returns a uniformly distributed unit vector.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.vector();
            if (0.01..=1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }

    /// Returns a uniformly distributed rotation.
    pub fn rotation(&mut self) -> DQuat {
        loop {
            let v = [0; 4].map(|_| self.range(-1.0, 1.0));
            let q = DQuat::from_array(v);
            if (0.01..=1.0).contains(&q.length_squared()) {
                return q.normalize();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with the published numbers for the seed 1234567.
    #[test]
    fn generator_is_splitmix64() {
        let mut random = Random::new(1_234_567);
        let published = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ];
        assert_eq!(published.map(|_| random.bits()), published);
    }

    #[test]
    fn streams_are_reproducible_and_differ() {
        let draw = |seed, purpose: &[u64]| Random::stream(seed, purpose).bits();
        assert_eq!(draw(1, &[11, 200]), draw(1, &[11, 200]));
        assert_eq!(draw(1, &[]), Random::new(1).bits());
        let others = [
            draw(2, &[11, 200]),
            draw(1, &[11, 800]),
            draw(1, &[12, 200]),
            draw(1, &[200, 11]),
            draw(1, &[11]),
            draw(1, &[11, 200, 0]),
        ];
        assert!(others.iter().all(|other| *other != draw(1, &[11, 200])));
    }

    #[test]
    fn directions_and_rotations_are_uniform() {
        let mut random = Random::new(3);
        let count = 20_000;
        let mut sums = [DVec3::ZERO; 4];
        for _ in 0..count {
            let turn = random.rotation();
            for (sum, axis) in sums.iter_mut().zip(DVec3::AXES) {
                *sum += turn * axis;
            }
            sums[3] += random.direction();
        }
        // Five standard deviations of the mean of `count` values with variance 1/3.
        let bound = 5.0 * (1.0 / 3.0 / f64::from(count)).sqrt();
        for sum in sums {
            assert!((sum / f64::from(count)).abs().max_element() < bound, "{sum}");
        }
    }
}
