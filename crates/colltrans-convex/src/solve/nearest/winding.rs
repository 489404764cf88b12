//! Whether a surface of triangles between points of `M` winds around the origin, exactly.
//!
//! Each directed edge has exactly one opposite, so the surface is closed. Each triangle is counter-clockwise
//! as seen from the origin's other side, or without volume over the origin, and none contains it; some have
//! volume. So the solid angles, none negative, sum to a positive multiple of a whole turn, and each ray from
//! the origin meets the surface.

use std::cmp::Ordering;

use glam::DVec3;

use crate::answer::Enclosure;
use crate::setting::TwoBodies;
use colltrans_kernel::volume;

/// Whether it does, if no triangle contains the origin.
pub(crate) fn surrounds(bodies: &TwoBodies, surface: &Enclosure) -> bool {
    let points: Vec<_> = surface.pairs.iter().map(|pair| bodies.difference(*pair)).collect();
    is_closed(&surface.triangles) && winds(bodies, &points, surface)
}

/// The same of a surface that is closed, with the points of its pairs.
pub(super) fn winds(bodies: &TwoBodies, points: &[DVec3], surface: &Enclosure) -> bool {
    let size = bodies.scale();
    let mut some = false;
    for corners in &surface.triangles {
        let rounded = volume::rounded_sign(corners.map(|k| points[k as usize]), size);
        let sign = rounded.unwrap_or_else(|| {
            let [a, b, c] = corners.map(|k| bodies.terms(surface.pairs[k as usize]));
            volume::sign([&a, &b, &c], size)
        });
        match sign {
            Ordering::Less => return false,
            Ordering::Equal => {}
            Ordering::Greater => some = true,
        }
    }
    some
}

fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let edges = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut there: Vec<[u32; 2]> = edges.collect();
    let mut back: Vec<[u32; 2]> = there.iter().map(|&[x, y]| [y, x]).collect();
    there.sort_unstable();
    back.sort_unstable();
    there == back && there.windows(2).all(|pair| pair[0] != pair[1])
}
