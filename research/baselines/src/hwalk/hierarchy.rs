//! The inner Dobkin-Kirkpatrick hierarchy of a convex polyhedron.
//!
//! Layer 0 is the body. Layer `k + 1` is the hull of layer `k` without an *independent set* of vertices of
//! low degree, in which no two vertices are neighbours. Therefore layers are nested, and all neighbours of a
//! removed vertex remain.
//!
//! Invariant: each layer removes a fixed share of the vertices, which yields `O(log n)` layers of `O(n)`
//! features in all. At least half of the vertices of a convex polyhedron have fewer than [`LOW_DEGREE`]
//! neighbours, and a greedy selection contains at least one in [`LOW_DEGREE`] of them.
//!
//! Sources: Dobkin and Kirkpatrick, "Determining the separation of preprocessed polyhedra - a unified
//! approach", ICALP 1990; Guibas, Hsu, Zhang 1999.

use colltrans::ConvexPolyhedron;

use crate::features::{NotSolid, Shell};

/// Maximum number of vertices of the last layer.
const CORE: usize = 12;

/// Vertices with at least this degree stay. The average degree is below 6, therefore fewer than half of the
/// vertices do.
const LOW_DEGREE: usize = 12;

/// A layer with the links of its vertices to the adjacent layers.
#[derive(Debug, Clone)]
pub(crate) struct Layer {
    pub(crate) shell: Shell,
    /// For each vertex, the same vertex in the next finer layer; empty in layer 0.
    pub(crate) finer: Vec<u32>,
    /// For each vertex, the same vertex in the next coarser layer, or a neighbour; empty in the last layer.
    pub(crate) coarser: Vec<u32>,
}

/// A body and increasingly coarse bodies inside it, each with a subset of the vertices of the previous one.
#[derive(Debug, Clone)]
pub struct Hierarchy {
    layers: Vec<Layer>,
}

impl Hierarchy {
    /// Computes the layers of a body, down to about a dozen vertices. Takes the time of a few convex hulls.
    ///
    /// # Errors
    /// [`NotSolid`] for a polygon, a segment or a point.
    pub fn new(body: &ConvexPolyhedron) -> Result<Self, NotSolid> {
        let mut layers = Vec::new();
        let mut last = Layer { shell: Shell::new(body)?, finer: Vec::new(), coarser: Vec::new() };
        let mut coarse = coarser_body(body);
        while let Some((body, finer)) = coarse {
            let shell = Shell::new(&body)?;
            last.coarser = coarser_links(&last.shell, &finer);
            layers.push(std::mem::replace(&mut last, Layer { shell, finer, coarser: Vec::new() }));
            coarse = coarser_body(&body);
        }
        layers.push(last);
        Ok(Self { layers })
    }

    /// Returns the number of layers.
    pub fn layer_count(&self) -> usize {
        self.layers.len()
    }

    /// Returns the number of vertices of a layer; layer 0 is the body.
    ///
    /// # Panics
    /// If the layer does not exist.
    pub fn vertex_count(&self, layer: usize) -> usize {
        self.layers[layer].shell.vertex_count()
    }

    /// Returns the number of bytes that the layers occupy, including the heap.
    pub fn memory_bytes(&self) -> usize {
        let links = |layer: &Layer| 4 * (layer.finer.capacity() + layer.coarser.capacity());
        let layers = self.layers.iter().map(|layer| layer.shell.memory_bytes() + links(layer));
        size_of::<Self>() + layers.sum::<usize>()
    }

    /// Returns a layer, or the last one for a larger index.
    pub(crate) fn layer(&self, index: usize) -> &Layer {
        &self.layers[index.min(self.layers.len() - 1)]
    }
}

/// Returns the hull without an independent set, and for each of its vertices the index in `body`. Returns
/// `None` if the body is small enough, or if the hull is not a solid.
fn coarser_body(body: &ConvexPolyhedron) -> Option<(ConvexPolyhedron, Vec<u32>)> {
    let count = body.vertices().len();
    if count <= CORE {
        return None;
    }
    let taken = independent_set(body);
    let kept: Vec<u32> = (0..count as u32).filter(|&v| !taken[v as usize]).collect();
    let points: Vec<_> = kept.iter().map(|&v| body.vertices()[v as usize]).collect();
    let coarse =
        ConvexPolyhedron::from_points(&points).ok().filter(|body| body.dimension() == 3)?;
    let finer = coarse.input_indices().iter().map(|v| kept[v.index()]).collect();
    (kept.len() < count).then_some((coarse, finer))
}

/// Marks a greedy independent set, starting with the lowest degrees.
fn independent_set(body: &ConvexPolyhedron) -> Vec<bool> {
    let degree = |v: u32| body.neighbours(v).len();
    let mut order: Vec<u32> = (0..body.vertices().len() as u32).collect();
    order.retain(|&v| degree(v) < LOW_DEGREE);
    order.sort_by_key(|&v| degree(v));
    let mut taken = vec![false; body.vertices().len()];
    for v in order {
        if body.neighbours(v).iter().all(|&w| !taken[w as usize]) {
            taken[v as usize] = true;
        }
    }
    taken
}

/// Returns for each vertex of a layer the same vertex in the coarser layer, or the nearest one along edges.
/// This is a neighbour, unless the hull dropped the neighbour too because it is inside a face up to rounding.
fn coarser_links(shell: &Shell, finer: &[u32]) -> Vec<u32> {
    const NONE: u32 = u32::MAX;
    let mut coarser = vec![NONE; shell.vertex_count()];
    let mut reached: Vec<u32> = finer.to_vec();
    for (coarse, &fine) in finer.iter().enumerate() {
        coarser[fine as usize] = coarse as u32;
    }
    let mut next = 0;
    while let Some(&v) = reached.get(next) {
        next += 1;
        for &h in shell.outgoing(v) {
            let w = shell.half_edge(h).target;
            if coarser[w as usize] == NONE {
                coarser[w as usize] = coarser[v as usize];
                reached.push(w);
            }
        }
    }
    coarser
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::Feature;
    use colltrans::glam::DVec3;
    use colltrans_testkit::random::Random;
    use colltrans_testkit::shapes::cuboid;

    fn hierarchy(points: &[DVec3]) -> Hierarchy {
        Hierarchy::new(&ConvexPolyhedron::from_points(points).unwrap()).unwrap()
    }

    #[test]
    fn layers_shrink_and_links_match() {
        let mut rng = Random::new(3);
        for n in [13, 50, 400, 3_000] {
            let points: Vec<DVec3> = (0..n).map(|_| rng.direction()).collect();
            let hierarchy = hierarchy(&points);
            let total: usize = hierarchy.layers.iter().map(|l| l.shell.vertex_count()).sum();
            assert!(total < 6 * n as usize, "{n}: {total}");
            assert!(hierarchy.layers.last().unwrap().shell.vertex_count() <= CORE);
            for pair in hierarchy.layers.windows(2) {
                let [fine, coarse] = pair else { unreachable!() };
                assert!(coarse.shell.vertex_count() < fine.shell.vertex_count());
                for (v, &above) in coarse.finer.iter().enumerate() {
                    assert_eq!(coarse.shell.vertex(v as u32), fine.shell.vertex(above));
                    assert_eq!(fine.coarser[above as usize], v as u32);
                }
                for v in 0..fine.shell.vertex_count() as u32 {
                    let linked = coarse.finer[fine.coarser[v as usize] as usize];
                    let near = |h: &u32| fine.shell.half_edge(*h).target == linked;
                    assert!(linked == v || fine.shell.outgoing(v).iter().any(near));
                }
            }
        }
    }

    #[test]
    fn small_body_has_one_layer() {
        let cube = hierarchy(&cuboid(DVec3::ONE).vertices);
        assert_eq!((cube.layer_count(), cube.vertex_count(0)), (1, 8));
        assert_eq!(cube.layer(7).shell.some_vertex(Feature::Vertex(5)), 5);
        let flat = ConvexPolyhedron::from_points(&[DVec3::ZERO, DVec3::X, DVec3::Y]).unwrap();
        assert_eq!(Hierarchy::new(&flat).unwrap_err().dimension, 2);
    }
}
