//! Merging of vertices with equal coordinates, by a hash table.

use glam::DVec3;

/// Marks an empty slot of the table.
const EMPTY_SLOT: u32 = u32::MAX;

/// Returns the first vertex with the same coordinates for each vertex (`-0` equals `0`).
pub(super) fn first_equal_vertices(vertices: &[DVec3]) -> Vec<u32> {
    let slots = (2 * vertices.len()).next_power_of_two().max(2);
    let mut table = vec![EMPTY_SLOT; slots];
    let mut first = Vec::with_capacity(vertices.len());
    for (v, point) in vertices.iter().enumerate() {
        let mut slot = hash_point(*point) as usize & (slots - 1);
        while table[slot] != EMPTY_SLOT && vertices[table[slot] as usize] != *point {
            slot = (slot + 1) & (slots - 1);
        }
        if table[slot] == EMPTY_SLOT {
            table[slot] = v as u32;
        }
        first.push(table[slot]);
    }
    first
}

/// Returns a hash that is equal for equal coordinates. The upper half of a product depends on all bits of its
/// factors.
fn hash_point(point: DVec3) -> u64 {
    let mix = |h: u64, c: f64| {
        let bits = u128::from(h ^ (c + 0.0).to_bits());
        let wide = bits.wrapping_mul(0x9e37_79b9_7f4a_7c15_f39c_c060_5ced_c835);
        (wide >> 64) as u64 ^ wide as u64
    };
    point.to_array().into_iter().fold(0x243f_6a88_85a3_08d3, mix)
}
