//! Bodies, answers and proofs of either kind under one type.

use std::sync::Arc;

use glam::DVec3;

use crate::body::Solid;
use crate::solve::nearest::SolidNear;
use colltrans_convex::answer::{Clearance, Distance, NearPoints};
use colltrans_convex::body::{ConvexPolyhedron, Features, Placed, Pose};

/// Something of convex bodies, or of solids: a body, an answer, a proof.
///
/// Answers are of the first kind if both bodies are convex: those are exact to a few roundings and carry
/// their proofs. Of a solid and a convex body they are those of two solids.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum ByKind<C, S> {
    /// Of convex bodies.
    Convex(C),
    /// Of solids.
    Solid(S),
}

/// A body of either kind that is kept: many obstacles may share one.
pub type AnyBody = ByKind<Arc<ConvexPolyhedron>, Arc<Solid>>;

/// A placed body of either kind.
pub type AnyPlaced<'a> = ByKind<Placed<'a>, Placed<'a, Solid>>;

/// The distance of two bodies.
pub type AnyDistance = ByKind<Distance, Distance<Solid>>;

/// How far a body can move before another one stops it.
pub type AnyClearance = ByKind<Clearance, Clearance<Solid>>;

/// What proves that two bodies are not farther from each other than a number.
pub type AnyNear = ByKind<NearPoints, SolidNear>;

impl AnyBody {
    /// The body in a pose.
    pub fn at(&self, pose: Pose) -> AnyPlaced<'_> {
        match self {
            Self::Convex(body) => ByKind::Convex(body.at(pose)),
            Self::Solid(body) => ByKind::Solid(body.at(pose)),
        }
    }
}

/// Reads a field that both kinds have.
macro_rules! of_both {
    ($($(#[$doc:meta])* $name:ident: $type:ty;)+) => {
        impl AnyDistance {$(
            $(#[$doc])*
            pub const fn $name(&self) -> $type {
                match self {
                    Self::Convex(distance) => distance.$name,
                    Self::Solid(distance) => distance.$name,
                }
            }
        )+}
    };
}

of_both! {
    /// [`Distance::lower`].
    lower: f64;
    /// [`Distance::upper`].
    upper: f64;
    /// [`Distance::on_moving`].
    on_moving: DVec3;
    /// [`Distance::on_fixed`].
    on_fixed: DVec3;
    /// [`Distance::normal`].
    normal: Option<DVec3>;
    /// [`Distance::features`].
    features: Option<Features>;
}

impl AnyPlaced<'_> {
    /// Where the body is.
    pub const fn pose(&self) -> Pose {
        match self {
            Self::Convex(placed) => placed.pose,
            Self::Solid(placed) => placed.pose,
        }
    }
}

impl AnyDistance {
    /// What proves the upper bound.
    pub const fn near(&self) -> AnyNear {
        match self {
            Self::Convex(distance) => ByKind::Convex(distance.near),
            Self::Solid(distance) => ByKind::Solid(distance.near),
        }
    }
}

impl AnyClearance {
    /// [`Clearance::distance`].
    pub fn distance(&self) -> Option<f64> {
        match self {
            Self::Convex(clearance) => clearance.distance(),
            Self::Solid(clearance) => clearance.distance(),
        }
    }

    /// The upper bound of where it stops the body: minus infinity if they overlap, infinite if it does not.
    #[doc(hidden)]
    #[inline]
    pub fn upper(&self) -> f64 {
        match self {
            Self::Convex(Clearance::Blocked { contact, .. }) => contact.certificate.upper,
            Self::Solid(Clearance::Blocked { contact, .. }) => contact.translation.upper,
            Self::Convex(Clearance::Overlapping(_)) | Self::Solid(Clearance::Overlapping(_)) => {
                f64::NEG_INFINITY
            }
            Self::Convex(Clearance::Free(_)) | Self::Solid(Clearance::Free(_)) => f64::INFINITY,
        }
    }
}

impl AnyNear {
    /// The distance that is proven not to be exceeded.
    pub const fn distance(&self) -> f64 {
        match self {
            Self::Convex(near) => near.distance,
            Self::Solid(near) => near.distance(),
        }
    }
}

impl From<ConvexPolyhedron> for AnyBody {
    fn from(body: ConvexPolyhedron) -> Self {
        Self::Convex(Arc::new(body))
    }
}

impl From<Arc<ConvexPolyhedron>> for AnyBody {
    fn from(body: Arc<ConvexPolyhedron>) -> Self {
        Self::Convex(body)
    }
}

impl From<Solid> for AnyBody {
    fn from(body: Solid) -> Self {
        Self::Solid(Arc::new(body))
    }
}

impl From<Arc<Solid>> for AnyBody {
    fn from(body: Arc<Solid>) -> Self {
        Self::Solid(body)
    }
}

impl<'a> From<Placed<'a>> for AnyPlaced<'a> {
    fn from(placed: Placed<'a>) -> Self {
        Self::Convex(placed)
    }
}

impl<'a> From<Placed<'a, Solid>> for AnyPlaced<'a> {
    fn from(placed: Placed<'a, Solid>) -> Self {
        Self::Solid(placed)
    }
}
