//! Hashes of the bits of answers, for tests that compare them with known numbers.

use glam::DVec3;

/// The FNV-1a hash (Fowler, Noll and Vo) with 64 bits.
#[derive(Debug)]
pub struct Hash(u64);

impl Default for Hash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Hash {
    /// Adds the bits of a number.
    pub fn number(&mut self, x: f64) {
        self.bits(x.to_bits());
    }

    /// Adds the eight bytes of an integer, the lowest first.
    pub fn bits(&mut self, x: u64) {
        for byte in x.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// Adds the bits of the three coordinates of a vector.
    pub fn vector(&mut self, v: DVec3) {
        for x in v.to_array() {
            self.number(x);
        }
    }

    /// Returns the hash of everything added.
    pub fn finish(&self) -> u64 {
        self.0
    }
}

/// Checks that each family has its known hash.
///
/// # Panics
///
/// If a hash differs. The message contains the lines with the new hashes.
pub fn assert_unchanged(known: &[(&str, u64)], hash_of: impl Fn(&str) -> u64) {
    let line = |&(family, golden): &(&str, u64)| {
        let found = hash_of(family);
        (found != golden).then(|| format!("    (\"{family}\", {found:#018x}),\n"))
    };
    let changed: String = known.iter().filter_map(line).collect();
    assert!(changed.is_empty(), "bits have changed; the new lines are\n{changed}");
}
