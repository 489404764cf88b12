//! Exact check whether a surface of triangles between points of `M` winds around the origin.
//!
//! - *Closed*: each directed edge has exactly one opposite.
//! - *Oriented*: each triangle is counter-clockwise as seen from outside, or has no volume with the origin. At least
//!   one has volume. None contains the origin; the caller ensures this.
//!
//! Then the solid angles are not negative and sum to a positive multiple of `4 pi`. Therefore each ray from the origin
//! intersects the surface.

use std::cmp::Ordering;

use glam::DVec3;

use crate::answer::Enclosure;
use crate::setting::TwoBodies;
use colltrans_kernel::volume;

/// Checks whether a surface is closed and winds around the origin, provided that no triangle contains the origin.
pub(crate) fn surrounds_origin(bodies: &TwoBodies, surface: &Enclosure) -> bool {
    let points: Vec<_> = surface.pairs.iter().map(|pair| bodies.difference_point(*pair)).collect();
    is_closed(&surface.triangles) && winds_around_origin(bodies, &points, surface)
}

/// Checks whether a closed surface winds around the origin. `points` are the rounded points of its pairs.
pub(super) fn winds_around_origin(
    bodies: &TwoBodies,
    points: &[DVec3],
    surface: &Enclosure,
) -> bool {
    let size = bodies.size();
    let mut has_volume = false;
    for corners in &surface.triangles {
        let rounded = volume::rounded_origin_side(corners.map(|k| points[k as usize]), size);
        let sign = rounded.unwrap_or_else(|| {
            let [a, b, c] = corners.map(|k| bodies.terms(surface.pairs[k as usize]));
            volume::origin_side([&a, &b, &c], size)
        });
        match sign {
            Ordering::Less => return false,
            Ordering::Equal => {}
            Ordering::Greater => has_volume = true,
        }
    }
    has_volume
}

/// Checks whether each directed edge of the triangles occurs once, and its opposite once.
fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let edges = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut edges_sorted: Vec<[u32; 2]> = edges.collect();
    let mut opposites: Vec<[u32; 2]> = edges_sorted.iter().map(|&[x, y]| [y, x]).collect();
    edges_sorted.sort_unstable();
    opposites.sort_unstable();
    edges_sorted == opposites && edges_sorted.windows(2).all(|pair| pair[0] != pair[1])
}
