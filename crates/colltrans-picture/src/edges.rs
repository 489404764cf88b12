//! Finds the edges of triangles.

use std::collections::HashMap;

/// The two vertices of an edge, the lower index first, and the faces at the edge.
pub type Edge = ([u32; 2], Vec<u32>);

/// Returns all edges, in the order of their first occurrence.
pub fn edges(triangles: &[[u32; 3]]) -> Vec<Edge> {
    let mut place = HashMap::with_capacity(triangles.len() * 3 / 2);
    let mut edges: Vec<Edge> = Vec::new();
    for (face, &[a, b, c]) in triangles.iter().enumerate() {
        for [p, q] in [[a, b], [b, c], [c, a]] {
            let ends = [p.min(q), p.max(q)];
            let index = *place.entry(ends).or_insert_with(|| {
                edges.push((ends, Vec::with_capacity(2)));
                edges.len() - 1
            });
            edges[index].1.push(face as u32);
        }
    }
    edges
}
