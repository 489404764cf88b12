//! Reverses facets that are oriented against their neighbours, which some exporters write.
//!
//! 1. Facets that share an edge must run along it in opposite directions. This relation is propagated from
//!    facet to facet over edges with two facets. In each connected part, the smaller set of facets is reversed.
//! 2. The parts are then compared at crowded edges. If both directions occur equally often at an edge, they
//!    remain. Otherwise, if the number of facets is even, inside and outside alternate around the edge, so each
//!    facet must run against the next one. In each set of related facets, the minority is reversed.
//!
//! This module does not determine which side is outside.

use glam::DVec3;

use crate::Mesh;
use crate::edges::{FacetSide, area_normal, facet_sides, has_no_area, sides_by_edge};
use crate::sets::OrientedSets;

/// Reverses facets until neighbours agree, and returns their number. `None` if that is impossible, as on a
/// one-sided surface.
pub(super) fn orient_consistently(mesh: &mut Mesh) -> Option<usize> {
    let (vertices, mut faces) = mesh.welded_copy();
    let counts: Vec<bool> = faces.iter().map(|face| !has_no_area(face)).collect();
    let before = facet_sides(&faces, |k| counts[k]);
    let mut sets = OrientedSets::new(faces.len());
    let mut turned = vec![false; faces.len()];
    for edge in sides_by_edge(&before) {
        if let [a, b] = edge
            && !sets.join(a.face, b.face, a.backward == b.backward)
        {
            return None;
        }
    }
    reverse_minorities(&mut sets, &mut faces, &mut turned);
    // The facets within a part agree now.
    let after = facet_sides(&faces, |k| counts[k]);
    let crowded = || sides_by_edge(&after).filter(|edge| edge.len() > 2);
    let is_balanced =
        |edge: &&[FacetSide]| edge.iter().filter(|used| used.backward).count() * 2 == edge.len();
    let mut sets = OrientedSets::new(faces.len());
    for edge in
        sides_by_edge(&after).filter(|edge| edge.len() == 2).chain(crowded().filter(is_balanced))
    {
        for pair in edge.windows(2) {
            sets.join(pair[0].face, pair[1].face, false);
        }
    }
    for edge in crowded().filter(|edge| edge.len() % 2 == 0 && !is_balanced(edge)) {
        let facets_around_edge = facets_around_edge(&vertices, &faces, edge);
        for pair in facets_around_edge.windows(2) {
            // Relations set by an earlier edge have priority.
            sets.join(pair[0].face, pair[1].face, pair[0].backward == pair[1].backward);
        }
    }
    reverse_minorities(&mut sets, &mut faces, &mut turned);
    for (face, _) in mesh.faces.iter_mut().zip(&turned).filter(|(_, turned)| **turned) {
        face.reverse();
    }
    Some(turned.iter().filter(|turned| **turned).count())
}

/// Reverses the minority of each set. If both orientations occur equally often, those that differ from the
/// first member are reversed.
fn reverse_minorities(sets: &mut OrientedSets, faces: &mut [Vec<u32>], turned: &mut [bool]) {
    let mut counts = vec![[0_usize; 2]; faces.len()];
    for k in 0..faces.len() {
        let (first, other) = sets.root(k);
        counts[first][usize::from(other)] += 1;
    }
    for (k, face) in faces.iter_mut().enumerate() {
        let (first, other) = sets.root(k);
        let [same, against] = counts[first];
        if other == (against <= same) {
            face.reverse();
            turned[k] = !turned[k];
        }
    }
}

/// Returns the facets at an edge in the order of their angles around it.
fn facets_around_edge(
    vertices: &[DVec3],
    faces: &[Vec<u32>],
    edge: &[FacetSide],
) -> Vec<FacetSide> {
    let [low, high] = edge[0].ends().map(|v| vertices[v as usize]);
    let axis = high - low;
    // Points from the edge into the facet, independent of its orientation.
    let inwards = |used: &FacetSide| {
        let into = area_normal(vertices, &faces[used.face]).cross(axis);
        if used.backward { -into } else { into }
    };
    let x = inwards(&edge[0]).normalize_or_zero();
    let y = axis.cross(x).normalize_or_zero();
    let angle = |used: &FacetSide| {
        let into = inwards(used);
        into.dot(y).atan2(into.dot(x))
    };
    let mut sorted = edge.to_vec();
    sorted.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    sorted
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::random::Random;
    use colltrans_testkit::shapes::ring_sphere;
    use glam::DVec3;

    use super::*;

    #[test]
    fn randomly_reversed_facets_are_restored() {
        let mut random = Random::new(6);
        let mesh = ring_sphere(9, 5);
        for _ in 0..50 {
            let mut faces = mesh.faces.clone();
            let mut turned = 0;
            for face in &mut faces {
                if random.unit() < 0.3 {
                    face.reverse();
                    turned += 1;
                }
            }
            let mut mended = Mesh::new(mesh.vertices.clone(), faces);
            assert_eq!(orient_consistently(&mut mended), Some(turned));
            assert_eq!(mended.faces, mesh.faces);
        }
        // A Moebius strip.
        let band: Vec<DVec3> =
            (0..6).map(|k| DVec3::new(f64::from(k), f64::from(k * k), 1.0)).collect();
        let faces: Vec<Vec<u32>> = vec![vec![0, 1, 3, 2], vec![2, 3, 5, 4], vec![4, 5, 0, 1]];
        assert_eq!(orient_consistently(&mut Mesh::new(band, faces)), None);
    }

    /// Four pyramids on one square form two bodies that touch along its sides. One pyramid is inside out.
    #[test]
    fn inverted_pyramid_at_crowded_edges_is_restored() {
        let corners = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y];
        let apexes = [2.0, 1.0, -1.0, -2.0].map(|z| DVec3::Z * z);
        let facet = |apex: u32, k: u32| {
            let (a, b) = if apex.is_multiple_of(2) { (k, (k + 1) % 4) } else { ((k + 1) % 4, k) };
            vec![a, b, 4 + apex]
        };
        let faces: Vec<Vec<u32>> = (0..16).map(|n| facet(n / 4, n % 4)).collect();
        let clean = Mesh::new([corners, apexes].concat(), faces);
        for apex in 0..4 {
            let mut spoilt = clean.clone();
            for face in &mut spoilt.faces[4 * apex..4 * apex + 4] {
                face.reverse();
            }
            assert_eq!(orient_consistently(&mut spoilt), Some(4));
            assert_eq!(spoilt.faces, clean.faces);
            assert!(colltrans::Solid::from_mesh(&spoilt.vertices, &spoilt.faces).is_ok());
        }
    }
}
