//! Bodies, answers and proofs of either kind in one type.

use std::sync::Arc;

use glam::DVec3;

use crate::body::Solid;
use crate::solve::nearest::SolidNear;
use colltrans_convex::answer::{Clearance, Distance, NearPoints};
use colltrans_convex::body::{ConvexPolyhedron, Features, Placed, Pose};

/// A body, an answer or a proof of either kind: convex bodies or solids.
///
/// Answers are of the convex kind if both bodies are convex. Those are exact to a few roundings and carry their
/// proofs. Answers for a solid and a convex body are of the solid kind.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum ByKind<C, S> {
    /// The value for convex bodies.
    Convex(C),
    /// The value for solids.
    Solid(S),
}

/// A shared body of either kind; several obstacles may refer to one body.
pub type AnyBody = ByKind<Arc<ConvexPolyhedron>, Arc<Solid>>;

/// A placed body of either kind.
pub type AnyPlaced<'a> = ByKind<Placed<'a>, Placed<'a, Solid>>;

/// The distance of two bodies of either kind.
pub type AnyDistance = ByKind<Distance, Distance<Solid>>;

/// The clearance of a body of either kind: how far it can move before it touches another body.
pub type AnyClearance = ByKind<Clearance, Clearance<Solid>>;

/// Proof of an upper bound on the distance of two bodies of either kind.
pub type AnyNear = ByKind<NearPoints, SolidNear>;

impl AnyBody {
    /// Returns the body in a pose.
    pub fn at(&self, pose: Pose) -> AnyPlaced<'_> {
        match self {
            Self::Convex(body) => ByKind::Convex(body.at(pose)),
            Self::Solid(body) => ByKind::Solid(body.at(pose)),
        }
    }
}

/// Implements getters of [`AnyDistance`] for fields that both kinds have.
macro_rules! impl_distance_getters {
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

impl_distance_getters! {
    /// Returns [`Distance::lower`].
    lower: f64;
    /// Returns [`Distance::upper`].
    upper: f64;
    /// Returns [`Distance::on_moving`].
    on_moving: DVec3;
    /// Returns [`Distance::on_fixed`].
    on_fixed: DVec3;
    /// Returns [`Distance::normal`].
    normal: Option<DVec3>;
    /// Returns [`Distance::features`].
    features: Option<Features>;
}

impl AnyPlaced<'_> {
    /// Returns the pose of the body.
    pub const fn pose(&self) -> Pose {
        match self {
            Self::Convex(placed) => placed.pose,
            Self::Solid(placed) => placed.pose,
        }
    }
}

impl AnyDistance {
    /// Returns the proof of the upper bound.
    pub const fn near(&self) -> AnyNear {
        match self {
            Self::Convex(distance) => ByKind::Convex(distance.near),
            Self::Solid(distance) => ByKind::Solid(distance.near),
        }
    }
}

impl AnyClearance {
    /// Returns [`Clearance::distance`].
    pub fn distance(&self) -> Option<f64> {
        match self {
            Self::Convex(clearance) => clearance.distance(),
            Self::Solid(clearance) => clearance.distance(),
        }
    }

    /// Returns the upper bound of the contact translation: minus infinity if the bodies overlap, infinity if the
    /// motion is free.
    #[doc(hidden)]
    #[inline]
    pub fn upper_bound(&self) -> f64 {
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
    /// Returns the proven upper bound on the distance.
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
