//! Classification of open shells: sided (almost closed) or sheet.
//!
//! The generalised winding number of a shell at a point (Jacobson, Kavan and Sorkine-Hornung, "Robust inside-outside
//! segmentation using generalized winding numbers", ACM Transactions on Graphics 32(4), 2013) is the solid angle that
//! its facets subtend, as a share of the whole sphere. It is 1 inside a closed shell and 0 outside.
//! - Across a facet it decreases by 1 from the inside to the outside. On the facet, without the facet itself, it is
//!   the mean of both sides. Therefore a shell is *sided* where this value is near 1/2: above 0.9 inside and below
//!   0.1 outside.
//! - Samples are centroids of facets, spread evenly over the area.
//! - No library function except the square root is called, so that a shell has the same kind on every platform.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::report::{Shell, ShellKind};
use super::tree;
use super::validate::Surface;

/// Maximum deviation of the winding number on a facet from 1/2 (exclusive).
const MAX_DEVIATION: f64 = 0.1;
/// Reciprocal of the share of samples that may deviate more.
const EXCEPTION_RECIPROCAL: usize = 100;
/// Approximate number of solid angles computed for a shell.
const SOLID_ANGLES: usize = 1 << 22;
/// Minimum and maximum number of samples of a shell.
const SAMPLE_RANGE: [usize; 2] = [64, 512];

/// Finds the sided shells among the open ones, which must all have the kind `Sheet`, and sets the kind of each
/// triangle.
pub(super) fn classify_shells(surface: &mut Surface, shell_of: &[u32], shells: &mut [Shell]) {
    if shells.iter().all(|s| s.kind == ShellKind::Closed) {
        return;
    }
    let mut members = vec![Vec::new(); shells.len()];
    for (t, &shell) in shell_of.iter().enumerate() {
        if shells[shell as usize].kind != ShellKind::Closed {
            let corners = surface.triangles[t].map(|v| surface.vertices[v as usize]);
            members[shell as usize].push(corners);
        }
    }
    for (shell, facets) in shells.iter_mut().zip(&members) {
        if shell.kind != ShellKind::Closed && is_sided(facets) {
            shell.kind = ShellKind::Sided;
        }
    }
    for (kind, &shell) in surface.kinds.iter_mut().zip(shell_of) {
        *kind = shells[shell as usize].kind;
    }
}

/// Checks whether the winding number is near 1/2 at all but a hundredth of the samples.
fn is_sided(facets: &[[DVec3; 3]]) -> bool {
    let area = |f: &[DVec3; 3]| tree::area_vector(*f).0.length();
    let whole: f64 = facets.iter().map(area).sum();
    let count = (SOLID_ANGLES / facets.len()).clamp(SAMPLE_RANGE[0], SAMPLE_RANGE[1]);
    let (mut passed, mut next, mut wrong) = (0.0, 0, 0);
    for (own, facet) in facets.iter().enumerate() {
        passed += area(facet);
        // Number of the evenly spread samples on this facet.
        let mut places = 0;
        while next < count && (next as f64 + 0.5) * whole < passed * count as f64 {
            (next, places) = (next + 1, places + 1);
        }
        if places > 0 && (winding_number(facets, own) - 0.5).abs() >= MAX_DEVIATION {
            wrong += places;
            if wrong * EXCEPTION_RECIPROCAL > count {
                return false;
            }
        }
    }
    true
}

/// Returns the winding number at the centroid of a facet, without the contribution of this facet.
fn winding_number(facets: &[[DVec3; 3]], own: usize) -> f64 {
    let [a, b, c] = facets[own];
    let eye = (a + b + c) / 3.0;
    let others = facets.iter().enumerate().filter(|(k, _)| *k != own);
    others.map(|(_, f)| half_solid_angle(f.map(|v| v - eye))).sum::<f64>() / (2.0 * PI)
}

/// Returns half of the solid angle of a triangle as seen from the origin, positive from behind (Van Oosterom and
/// Strackee, IEEE Transactions on Biomedical Engineering 30(2), 1983).
fn half_solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let [l, m, n] = [a, b, c].map(DVec3::length);
    let volume = a.dot(b.cross(c));
    approximate_angle(volume, l * m * n + a.dot(b) * n + b.dot(c) * l + c.dot(a) * m)
}

/// Returns the angle of `(x, y)`, in radians, with an error of at most 1.2e-5 (Abramowitz and Stegun, section 4.4).
fn approximate_angle(y: f64, x: f64) -> f64 {
    let (low, high) = (y.abs().min(x.abs()), y.abs().max(x.abs()));
    if high == 0.0 {
        return 0.0;
    }
    let t = low / high;
    let s = t * t;
    let series = [0.020_835_1, -0.085_133_0, 0.180_141_0, -0.330_299_5, 0.999_866_0];
    let first = t * series.into_iter().fold(0.0, |sum, c| sum * s + c);
    let steep = if y.abs() > x.abs() { FRAC_PI_2 - first } else { first };
    let angle = if x < 0.0 { PI - steep } else { steep };
    if y < 0.0 { -angle } else { angle }
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::solids::slab;

    use super::*;

    #[test]
    fn approximate_angles_agree_in_all_quadrants() {
        for k in -314..=314 {
            let angle = f64::from(k) / 100.0;
            assert!(
                (approximate_angle(angle.sin(), angle.cos()) - angle).abs() < 1.2e-5,
                "{angle}"
            );
        }
        assert!(approximate_angle(0.0, 0.0) == 0.0);
    }

    /// Returns the triangles of a cube with `n` by `n` squares per side, without the first `missing` triangles.
    fn cube_without(n: usize, missing: usize) -> Vec<[DVec3; 3]> {
        let mesh = slab(DVec3::ZERO, DVec3::ONE, [n; 3]);
        let corners = |triangle: [u32; 3]| triangle.map(|v| mesh.vertices[v as usize]);
        mesh.triangles().map(corners).skip(missing).collect()
    }

    #[test]
    fn nearly_closed_shells_are_sided() {
        assert!(is_sided(&cube_without(8, 0)));
        assert!(is_sided(&cube_without(8, 2)), "a 384th of the area is missing");
        assert!(!is_sided(&cube_without(8, 128)), "a whole side is missing");
        assert!(!is_sided(&cube_without(8, 760)), "four squares");
        let turned: Vec<_> = cube_without(8, 2).into_iter().map(|[a, b, c]| [a, c, b]).collect();
        assert!(!is_sided(&turned), "inside out");
    }
}
