//! Draws settings with exact ties, as between machine parts: aligned, resting, edge over edge, vertex over
//! vertex.
//!
//! Notation. A tied setting is drawn with the direction `-z` in the frame of a *jig*; the [`Placement`] rotates
//! the jig. The identity and quarter turns preserve ties in every bit. A general rotation rounds the entries,
//! so near-ties remain.

use colltrans::{ConvexPolyhedron, Pose};
use colltrans_lab::settings::{Meeting, Setting};
use colltrans_lab::shapes::Bodies;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes;
use glam::{DMat3, DQuat, DVec3};

use crate::shapes::body_from_mesh;

/// A kind of tie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tie {
    /// Boxes with random sides, upright, translated straight down at a random place.
    UprightBoxes,
    /// Unit cubes on a grid of quarters, face on face; one in three exactly centred.
    CubesFaceOnFace,
    /// Two roofs whose ridges cross at right angles.
    EdgesCrossing,
    /// Two roofs, one ridge exactly over the other.
    EdgesLinedUp,
    /// Two octahedra, one vertex exactly over the other.
    VertexOverVertex,
    /// Prisms with 24 sides and equal radii, with aligned sides.
    AlignedPrisms,
    /// A prism with 25 sides (50 vertices) that slides along a wall at zero clearance.
    ZeroClearance,
}

impl Tie {
    /// All ties.
    pub const ALL: [Self; 7] = [
        Self::UprightBoxes,
        Self::CubesFaceOnFace,
        Self::EdgesCrossing,
        Self::EdgesLinedUp,
        Self::VertexOverVertex,
        Self::AlignedPrisms,
        Self::ZeroClearance,
    ];

    /// Returns the name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::UprightBoxes => "upright boxes",
            Self::CubesFaceOnFace => "cubes face on face",
            Self::EdgesCrossing => "edges crossing",
            Self::EdgesLinedUp => "edges lined up",
            Self::VertexOverVertex => "vertex over vertex",
            Self::AlignedPrisms => "aligned prisms",
            Self::ZeroClearance => "zero clearance",
        }
    }

    /// Draws a pair of bodies.
    ///
    /// # Panics
    /// Never, because the meshes are convex.
    pub fn bodies(self, random: &mut Random) -> Bodies {
        let mut half = || DVec3::from_array([0; 3].map(|_| random.range(0.3, 1.0)));
        let cube = || shapes::cuboid(DVec3::splat(0.5));
        let roof = |turn: DMat3| {
            let points =
                [(-1.0, -1.0, -1.0), (1.0, -1.0, -1.0), (1.0, 1.0, -1.0), (-1.0, 1.0, -1.0)];
            let ridge = [(-1.0, 0.0, 0.0), (1.0, 0.0, 0.0)];
            let all = points.into_iter().chain(ridge).map(|(x, y, z)| turn * DVec3::new(x, y, z));
            shapes::Mesh::of_points(all.collect())
        };
        let upside_down = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
        let quarter = DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z);
        let octahedron = || {
            let axes = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
            shapes::Mesh::of_points(axes.collect())
        };
        let pair = match self {
            Self::UprightBoxes => [shapes::cuboid(half()), shapes::cuboid(half())],
            Self::CubesFaceOnFace => [cube(), cube()],
            Self::EdgesCrossing => [roof(upside_down), roof(quarter)],
            Self::EdgesLinedUp => [roof(upside_down), roof(DMat3::IDENTITY)],
            Self::VertexOverVertex => [octahedron(), octahedron()],
            Self::AlignedPrisms => [shapes::prism(24, 0.5), shapes::prism(24, 0.5)],
            Self::ZeroClearance => {
                [shapes::prism(25, 0.5), shapes::cuboid(DVec3::new(0.5, 4.0, 4.0))]
            }
        };
        Bodies::new(pair.map(|mesh| body_from_mesh(&mesh).expect("a convex body")))
    }

    /// Draws the position of the moving body in the jig, before it moves along `-z`.
    fn draw_offset(self, bodies: &Bodies, random: &mut Random) -> DVec3 {
        let ahead = 3.0;
        let quarters = |random: &mut Random| random.int(-3, 3) as f64 * 0.25;
        let (x, y) = match self {
            Self::UprightBoxes => {
                let reach = |k: usize| {
                    let sides = bodies.pair.each_ref().map(|b| half_extent(b, k));
                    0.95 * (sides[0] + sides[1])
                };
                let mut within = |reach: f64| random.range(-reach, reach);
                (within(reach(0)), within(reach(1)))
            }
            Self::CubesFaceOnFace if random.index(3) > 0 => (quarters(random), quarters(random)),
            Self::EdgesCrossing => (quarters(random), quarters(random)),
            Self::EdgesLinedUp => (quarters(random), 0.0),
            Self::CubesFaceOnFace | Self::VertexOverVertex | Self::AlignedPrisms => (0.0, 0.0),
            // The prism's corner on the x axis touches the wall's side.
            Self::ZeroClearance => (-1.5, quarters(random)),
        };
        DVec3::new(x, y, ahead)
    }

    /// Draws a tied setting, or for [`Placement::General`] a setting in which the bodies collide in general position.
    ///
    /// # Panics
    /// Never, because the poses are in range.
    pub fn draw(self, bodies: &Bodies, placement: Placement, random: &mut Random) -> Setting {
        if placement == Placement::General {
            return Setting::draw(bodies, Meeting::Colliding, random);
        }
        let turn = placement.draw_rotation(random);
        let at =
            |offset: DVec3| Pose::new(DQuat::from_mat3(&turn), turn * offset).expect("a rotation");
        let moving = at(self.draw_offset(bodies, random));
        Setting { moving, fixed: at(DVec3::ZERO), direction: turn * DVec3::NEG_Z }
    }
}

/// Returns half the extent along an axis of a body that is symmetric about the origin.
fn half_extent(body: &ConvexPolyhedron, axis: usize) -> f64 {
    body.vertices().iter().map(|v| v[axis]).fold(f64::NEG_INFINITY, f64::max)
}

/// The rotation of a jig in the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Placement {
    /// No rotation.
    Identity,
    /// One of the 24 rotations that permute the axes, exact in every entry.
    QuarterTurns,
    /// A random rotation, with rounded entries.
    Rotated,
    /// No jig: the same bodies in general position, for comparison.
    General,
}

impl Placement {
    /// All placements.
    pub const ALL: [Self; 4] = [Self::Identity, Self::QuarterTurns, Self::Rotated, Self::General];

    /// Returns the name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Identity => "identity",
            Self::QuarterTurns => "quarter turns",
            Self::Rotated => "rotated",
            Self::General => "general position",
        }
    }

    /// Draws the rotation.
    fn draw_rotation(self, random: &mut Random) -> DMat3 {
        match self {
            Self::Identity | Self::General => DMat3::IDENTITY,
            Self::QuarterTurns => {
                let first = random.index(3);
                let second = (first + 1 + random.index(2)) % 3;
                let mut sign = || if random.index(2) == 0 { 1.0 } else { -1.0 };
                let (x, y) = (DVec3::AXES[first] * sign(), DVec3::AXES[second] * sign());
                DMat3::from_cols(x, y, x.cross(y))
            }
            Self::Rotated => DMat3::from_quat(random.rotation()),
        }
    }
}

#[cfg(test)]
mod tests {
    use colltrans::{Outcome, cast};

    use super::*;

    #[test]
    fn tied_settings_have_contacts_of_their_kind() {
        let mut random = Random::new(1);
        for tie in Tie::ALL {
            for placement in [Placement::Identity, Placement::QuarterTurns] {
                for _ in 0..50 {
                    let bodies = tie.bodies(&mut random);
                    let s = tie.draw(&bodies, placement, &mut random);
                    let [p, q] = &bodies.pair;
                    match cast(p, &s.moving, q, &s.fixed, s.direction).unwrap() {
                        Outcome::Contact(contact) => {
                            assert_ne!(tie, Tie::ZeroClearance);
                            let expected = match tie {
                                Tie::CubesFaceOnFace | Tie::AlignedPrisms => Some(2.0),
                                Tie::EdgesLinedUp => Some(3.0),
                                Tie::VertexOverVertex => Some(1.0),
                                _ => None,
                            };
                            let got = contact.translation;
                            assert!(
                                expected.is_none_or(|t| (t - got).abs() < 1e-12),
                                "{tie:?}: {got}"
                            );
                        }
                        Outcome::Grazing(_) => assert_eq!(tie, Tie::ZeroClearance),
                        other @ Outcome::Separated(_) => panic!("{tie:?} {placement:?}: {other:?}"),
                    }
                }
            }
        }
    }
}
