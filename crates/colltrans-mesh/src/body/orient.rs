//! Facets that are oriented against their neighbours, turned: some exporters leave single ones so.
//!
//! Facets that share an edge must run along it in opposite directions. From one facet of each
//! connected part that is carried on to all; the smaller set is turned. Which side is outside is not
//! decided here.

use crate::Mesh;
use crate::merge::sides;

/// Turns facets until neighbours agree; how many. `None` if they cannot, on a one-sided surface.
pub(super) fn consistent(mesh: &mut Mesh) -> Option<usize> {
    let neighbours = neighbours(mesh);
    let faces = &mut mesh.faces;
    let mut turned: Vec<Option<bool>> = vec![None; faces.len()];
    let mut count = 0;
    for first in 0..faces.len() {
        if turned[first].is_some() {
            continue;
        }
        turned[first] = Some(false);
        let mut part = vec![first];
        let mut next = 0;
        while let Some(&face) = part.get(next) {
            next += 1;
            for &(other, agrees) in &neighbours[face] {
                let wanted = turned[face] == Some(agrees);
                match turned[other] {
                    None => {
                        turned[other] = Some(wanted);
                        part.push(other);
                    }
                    Some(found) if found != wanted => return None,
                    Some(_) => (),
                }
            }
        }
        let against = part.iter().filter(|&&f| turned[f] == Some(true)).count();
        let most = against > part.len() / 2;
        for &face in part.iter().filter(|&&f| turned[f] == Some(!most)) {
            faces[face].reverse();
            count += 1;
        }
    }
    Some(count)
}

/// For each facet those with which it shares an edge that no third one has, and whether they agree.
fn neighbours(mesh: &Mesh) -> Vec<Vec<(usize, bool)>> {
    let (_, faces) = mesh.welded();
    let corners = faces.iter().enumerate();
    let owner: Vec<usize> = corners.flat_map(|(k, face)| face.iter().map(move |_| k)).collect();
    let mut neighbours = vec![Vec::new(); faces.len()];
    for shared in sides(&faces).chunk_by(|(a, _), (b, _)| a == b) {
        if let [(_, x), (_, y)] = *shared {
            let [f, g] = [x, y].map(|side| owner[(side >> 1) as usize]);
            let agree = (x ^ y) & 1 == 1;
            neighbours[f].push((g, agree));
            neighbours[g].push((f, agree));
        }
    }
    neighbours
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::random::Random;
    use colltrans_testkit::shapes::ring_sphere;
    use glam::DVec3;

    use super::*;

    #[test]
    fn facets_turned_at_random_agree_again() {
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
            assert_eq!(consistent(&mut mended), Some(turned));
            assert_eq!(mended.faces, mesh.faces);
        }
        // Moebius' band.
        let band: Vec<DVec3> =
            (0..6).map(|k| DVec3::new(f64::from(k), f64::from(k * k), 1.0)).collect();
        let faces: Vec<Vec<u32>> = vec![vec![0, 1, 3, 2], vec![2, 3, 5, 4], vec![4, 5, 0, 1]];
        assert_eq!(consistent(&mut Mesh::new(band, faces)), None);
    }
}
