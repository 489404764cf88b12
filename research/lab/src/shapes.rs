//! The bodies of the paper, with vertices on ellipsoids in a regular arrangement (section V), and others.
//! Each is built once in a run.
//!
//! A body has `rings` parallels with `around` vertices each, between two poles. On a unit sphere, edges of
//! meridians have the length `pi / rings`, and edges of parallels `4 / around` on average over all rings. The
//! *stretch* of the faces is the second length over the first.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread;

use colltrans::ConvexPolyhedron;
use colltrans_baselines::hwalk::Hierarchy;
use colltrans_baselines::pqp::Soup;
use colltrans_baselines::vclip::Shell;
use glam::DVec3;

use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{
    Mesh, half_sphere, prism, random_hull, ring_points, ring_sphere, superellipsoid,
};

/// A kind of body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    /// Ellipsoids whose faces are nearly all trapezoids, as long as wide on average.
    Balanced,
    /// Ellipsoids whose faces are nearly all trapezoids, [`THIN`] times as long as wide. Below about a
    /// thousand vertices they are less thin, because there are at least [`FEWEST_AROUND`] meridians. This is
    /// one reading of the paper's "very thin and stretched out".
    Thin,
    /// The other reading: [`MERIDIANS`] meridians for any number of vertices, so that larger bodies have
    /// thinner faces.
    ThinMeridians,
    /// As `Balanced`, with every other ring rotated by half a step: all faces are triangles.
    Triangles,
    /// Two equal unit spheres with balanced faces.
    Spheres,
    /// `|x|^4 + |y|^4 + |z|^4 = 1`, scaled: box-like, with triangles.
    Superellipsoid,
    /// Half ellipsoids with a flat base.
    HalfEllipsoid,
    /// Hulls of random points on ellipsoids: irregular triangles.
    RandomHull,
    /// Prisms over regular polygons: two faces with very many corners.
    Prism,
}

/// Stretch of thin faces.
const THIN: f64 = 100.0;

/// Number of meridians of [`Kind::ThinMeridians`].
const MERIDIANS: f64 = 16.0;

/// Minimum number of meridians; with fewer, a body resembles a prism.
const FEWEST_AROUND: f64 = 8.0;

impl Kind {
    /// Returns the name in legends.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Balanced => "balanced",
            Self::Thin => "thin",
            Self::ThinMeridians => "thin, 16 meridians",
            Self::Triangles => "triangles",
            Self::Spheres => "spheres",
            Self::Superellipsoid => "superellipsoid",
            Self::HalfEllipsoid => "half ellipsoid",
            Self::RandomHull => "random hull",
            Self::Prism => "prism",
        }
    }

    /// Returns the number of vertices around and the number of rings of a body with about `n` vertices.
    fn arrangement(self, n: usize) -> [u32; 2] {
        let inner = n.saturating_sub(2) as f64;
        let even = |stretch: f64| (inner * 4.0 / (PI * stretch)).sqrt().round();
        let around = match self {
            Self::Thin => even(THIN).max(FEWEST_AROUND),
            Self::ThinMeridians => MERIDIANS,
            _ => even(1.0).max(3.0),
        };
        [around as u32, (inner / around).round().max(1.0) as u32]
    }

    /// Builds a body with about `n` vertices and random semi-axes.
    fn build(self, n: usize, random: &mut Random) -> ConvexPolyhedron {
        let semi_axes = match self {
            Self::Spheres => DVec3::ONE,
            _ => DVec3::from_array([0; 3].map(|_| random.range(0.6, 1.4))),
        };
        let [around, rings] = self.arrangement(n);
        let mesh = match self {
            Self::Balanced | Self::Thin | Self::ThinMeridians | Self::Spheres => {
                ring_sphere(around, rings)
            }
            Self::Triangles => Mesh::of_points(ring_points(around, rings, 0.5)),
            Self::Superellipsoid => superellipsoid(n, 4.0),
            Self::HalfEllipsoid => half_sphere(n),
            Self::RandomHull => random_hull(n, random),
            Self::Prism => prism((n / 2).max(3), 0.5),
        };
        let Mesh { vertices, faces } = mesh.mapped(|v| v * semi_axes);
        let built = if faces.is_empty() {
            ConvexPolyhedron::from_points(&vertices)
        } else {
            // The corners of a face are rounded, so that the face is flat to a few units in the last place.
            ConvexPolyhedron::from_mesh(&vertices, &faces, 64.0 * f64::EPSILON)
        };
        built.expect("points of an ellipsoid, and its faces, make a convex body")
    }
}

/// A moving and a fixed body, with the data that solvers compute before any query.
#[derive(Debug)]
pub struct Bodies {
    /// The moving and the fixed body.
    pub pair: [ConvexPolyhedron; 2],
    /// `D`: the mean of both diameters. A diameter is twice the largest distance of a vertex from the centre.
    pub diameter: f64,
    /// Means of the vertices.
    pub(crate) middles: [DVec3; 2],
    soups: OnceLock<[Soup; 2]>,
    hierarchies: OnceLock<[Hierarchy; 2]>,
    shells: OnceLock<[Shell; 2]>,
}

impl Bodies {
    /// Computes the diameter, and the sections that the paper's algorithm needs, so that timed queries do not
    /// include this work.
    pub fn new(pair: [ConvexPolyhedron; 2]) -> Self {
        pair.iter().for_each(ConvexPolyhedron::prepare_sections);
        let mean = |body: &ConvexPolyhedron| {
            body.vertices().iter().sum::<DVec3>() / body.vertices().len() as f64
        };
        let middles = pair.each_ref().map(mean);
        let diameter = pair.iter().zip(middles).map(|(body, middle)| radius(body, middle)).sum();
        let (soups, hierarchies, shells) = (OnceLock::new(), OnceLock::new(), OnceLock::new());
        Self { pair, diameter, middles, soups, hierarchies, shells }
    }

    /// Returns the triangulated bodies with bounding volumes.
    pub(crate) fn soups(&self) -> &[Soup; 2] {
        self.soups.get_or_init(|| compute_both(|i| Soup::of_polyhedron(&self.pair[i])))
    }

    /// Returns the layers of the bodies.
    pub(crate) fn hierarchies(&self) -> &[Hierarchy; 2] {
        self.hierarchies.get_or_init(|| {
            compute_both(|i| Hierarchy::new(&self.pair[i]).expect("an ellipsoid is solid"))
        })
    }

    /// Returns the features of the bodies with their neighbours.
    pub(crate) fn shells(&self) -> &[Shell; 2] {
        self.shells.get_or_init(|| {
            compute_both(|i| Shell::new(&self.pair[i]).expect("an ellipsoid is solid"))
        })
    }

    /// Returns the mean number of vertices.
    pub fn vertices(&self) -> f64 {
        self.pair.iter().map(|body| body.vertices().len() as f64).sum::<f64>() / 2.0
    }
}

/// Computes two values in parallel.
fn compute_both<T: Send>(make: impl Fn(usize) -> T + Sync) -> [T; 2] {
    thread::scope(|scope| {
        let other = scope.spawn(|| make(1));
        let first = make(0);
        // A panic of `make` continues here.
        [first, other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))]
    })
}

/// Key of bodies in a run: seed, kind, size, and number of the pair.
type Key = (u64, Kind, usize, u64);

/// The bodies of an experiment, and smaller ones of the run, which figures share.
static BUILT: Mutex<BTreeMap<Key, Arc<Bodies>>> = Mutex::new(BTreeMap::new());

/// Returns the `which`-th pair of bodies of a kind with about `n` vertices.
pub(crate) fn bodies(seed: u64, kind: Kind, n: usize, which: u64) -> Arc<Bodies> {
    let mut built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
    let build = || {
        let pair = compute_both(|i| {
            let mut random = Random::stream(seed, &[kind as u64, n as u64, which, i as u64]);
            kind.build(n, &mut random)
        });
        Arc::new(Bodies::new(pair))
    };
    Arc::clone(built.entry((seed, kind, n, which)).or_insert_with(build))
}

/// Maximum number of vertices of bodies that are kept between passes. With trees and layers, all bodies of a
/// run would need several gigabytes.
const MOST_KEPT: usize = 5_000;

/// Discards large bodies at the end of a pass.
pub(crate) fn forget_large() {
    let mut built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
    built.retain(|(_, _, n, _), _| *n <= MOST_KEPT);
}

/// Returns the largest distance of a vertex from the mean of all.
fn radius(body: &ConvexPolyhedron, middle: DVec3) -> f64 {
    body.vertices().iter().map(|v| v.distance(middle)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_have_requested_vertices_and_faces() {
        for kind in
            [Kind::Balanced, Kind::Thin, Kind::ThinMeridians, Kind::Triangles, Kind::Spheres]
        {
            for n in [50, 200, 800, 3_200] {
                if kind == Kind::ThinMeridians && n < 800 {
                    continue;
                }
                let bodies = bodies(7, kind, n, 0);
                assert!((bodies.vertices() / n as f64 - 1.0).abs() < 0.06, "{kind:?} {n}");
                for body in &bodies.pair {
                    let corners = |f: usize| body.face_vertices(f as u32).count();
                    let triangles = (0..body.face_count()).filter(|f| corners(*f) == 3).count();
                    let [around, _] = kind.arrangement(n);
                    let expected = match kind {
                        Kind::Triangles => body.face_count(),
                        _ => 2 * around as usize,
                    };
                    assert_eq!(triangles, expected, "{kind:?} {n}");
                }
            }
        }
    }

    #[test]
    fn faces_have_requested_stretch() {
        for (kind, n, expected) in [(Kind::Balanced, 12_800, 1.0), (Kind::Thin, 12_800, 100.0)] {
            let [around, rings] = kind.arrangement(n).map(f64::from);
            let stretch = (4.0 / around) / (PI / rings);
            assert!((stretch / expected - 1.0).abs() < 0.1, "{kind:?}: {stretch}");
        }
    }
}
