//! The Dobkin-Kirkpatrick hierarchy: layers of ever fewer vertices, each inside the one before.
//!
//! Layer 0 is the body. From each layer an independent set of vertices of low degree is taken away
//! (no two of them neighbours, so that each leaves a small hole), and the next layer is the convex
//! hull of what is left. A constant share goes at each layer, so there are `O(log n)` layers and
//! `O(n)` features in all.
//!
//! D. P. Dobkin, D. G. Kirkpatrick, "Determining the separation of preprocessed polyhedra: a
//! unified approach", ICALP 1990; inner layers as Guibas, Hsu and Zhang use them.

use colltrans::ConvexPolyhedron;
use glam::DVec3;

use crate::features::{NotSolid, Shell};

/// Vertices with more neighbours than this stay in the layer.
const MOST_NEIGHBOURS: usize = 8;

/// A layer with no more vertices than this is the last.
const CORE: usize = 12;

/// A body with its inner layers, ready for [`HWalk`](super::HWalk).
#[derive(Debug, Clone)]
pub struct Hierarchy {
    pub(super) layers: Vec<Layer>,
}

/// One layer, and its vertices in the layers next to it.
#[derive(Debug, Clone)]
pub(super) struct Layer {
    pub(super) shell: Shell,
    /// Its vertices in the finer layer; empty for the body itself.
    pub(super) finer: Vec<u32>,
    /// Its vertices in the coarser layer, or, of those taken away, a neighbour; empty for the last.
    pub(super) coarser: Vec<u32>,
}

impl Hierarchy {
    /// All layers of a body. Takes the time of building a few bodies of its size.
    ///
    /// # Errors
    /// The body is a polygon, a segment or a point.
    pub fn new(body: &ConvexPolyhedron) -> Result<Self, NotSolid> {
        let mut layers =
            vec![Layer { shell: Shell::new(body)?, finer: Vec::new(), coarser: Vec::new() }];
        let mut next = inner(body);
        while let Some((smaller, finer)) = next {
            let Ok(shell) = Shell::new(&smaller) else { break };
            let last = layers.len() - 1;
            let outer = &layers[last].shell;
            layers[last].coarser = coarser(outer, &finer);
            next = inner(&smaller);
            layers.push(Layer { shell, finer, coarser: Vec::new() });
        }
        Ok(Self { layers })
    }

    /// Number of layers, the body included.
    pub fn layer_count(&self) -> usize {
        self.layers.len()
    }

    /// Number of vertices of all layers together.
    pub fn vertex_count(&self) -> usize {
        self.layers.iter().map(|layer| layer.shell.vertex_count()).sum()
    }

    /// Bytes of memory that the hierarchy occupies, on the heap and in itself.
    pub fn memory_bytes(&self) -> usize {
        let links = |layer: &Layer| 4 * (layer.finer.capacity() + layer.coarser.capacity());
        let bytes = |layer: &Layer| layer.shell.memory_bytes() + links(layer);
        size_of::<Self>() + self.layers.iter().map(bytes).sum::<usize>()
    }

    /// A layer, or the last one if there are not so many.
    pub(super) fn layer(&self, index: usize) -> &Layer {
        &self.layers[index.min(self.layers.len() - 1)]
    }
}

/// The hull of what is left of a layer, with its vertices' places in it. `None` if the layer is the
/// last: small enough, or without vertices that could go.
fn inner(body: &ConvexPolyhedron) -> Option<(ConvexPolyhedron, Vec<u32>)> {
    let vertices = body.vertices();
    if vertices.len() <= CORE {
        return None;
    }
    let mut goes = vec![false; vertices.len()];
    for v in 0..vertices.len() as u32 {
        let neighbours = body.neighbours(v);
        let alone = neighbours.iter().all(|&w| !goes[w as usize]);
        goes[v as usize] = alone && neighbours.len() <= MOST_NEIGHBOURS;
    }
    let kept: Vec<u32> = (0..vertices.len() as u32).filter(|&v| !goes[v as usize]).collect();
    let points: Vec<DVec3> = kept.iter().map(|&v| vertices[v as usize]).collect();
    let smaller = ConvexPolyhedron::from_points(&points).ok()?;
    // The hull may leave out points that lie on its faces up to rounding.
    let finer: Vec<u32> = smaller.input_indices().iter().map(|&i| kept[i as usize]).collect();
    (smaller.dimension() == 3 && finer.len() < vertices.len()).then_some((smaller, finer))
}

/// Where each vertex of a layer is, or has a neighbour, in the coarser one.
fn coarser(outer: &Shell, finer: &[u32]) -> Vec<u32> {
    let mut place = vec![None; outer.vertex_count()];
    for (index, &v) in finer.iter().enumerate() {
        place[v as usize] = Some(index as u32);
    }
    (0..outer.vertex_count() as u32)
        .map(|v| {
            let neighbours = outer.outgoing(v).iter().map(|&h| outer.half_edge(h).target);
            let mut near = [v].into_iter().chain(neighbours);
            near.find_map(|w| place[w as usize]).unwrap_or(0)
        })
        .collect()
}
