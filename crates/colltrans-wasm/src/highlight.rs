//! Features in contact, as indices of the drawn bodies.

use colltrans::{FaceId, Feature, VertexId};
use serde::Serialize;

/// The features of both bodies in contact.
#[derive(Serialize)]
pub(crate) struct ContactHighlight {
    pub(crate) moving: FeatureHighlight,
    pub(crate) fixed: FeatureHighlight,
}

/// A feature, as indices of the drawn body.
#[derive(Serialize)]
pub(crate) struct FeatureHighlight {
    vertices: Vec<VertexId>,
    #[serde(skip_serializing_if = "Option::is_none")]
    face: Option<FaceId>,
}

impl FeatureHighlight {
    /// Converts a feature of a body.
    pub(crate) fn from_feature<B: colltrans::Body>(feature: Feature, body: &B) -> Self {
        let face = if let Feature::Face(face) = feature { Some(face) } else { None };
        Self { vertices: feature.vertex_positions(body), face }
    }
}
