//! What touches, by the numbers of the bodies as they are drawn.

use colltrans::{FaceId, Feature, VertexId};
use serde::Serialize;

#[derive(Serialize)]
pub(crate) struct Touching {
    pub(crate) moving: Lit,
    pub(crate) fixed: Lit,
}

/// A feature by the numbers of the body as it is drawn.
#[derive(Serialize)]
pub(crate) struct Lit {
    vertices: Vec<VertexId>,
    #[serde(skip_serializing_if = "Option::is_none")]
    face: Option<FaceId>,
}

impl Lit {
    pub(crate) fn of<B: colltrans::Body>(feature: Feature, body: &B) -> Self {
        let face = if let Feature::Face(face) = feature { Some(face) } else { None };
        Self { vertices: feature.own_vertices(body), face }
    }
}
