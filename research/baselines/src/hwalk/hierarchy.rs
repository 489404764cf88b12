//! Dobkin-Kirkpatrick's inner hierarchy of a convex polyhedron.
//!
//! Notation. Layer 0 is the body; layer `k + 1` is the hull of what is left of the vertices of
//! layer `k` when an *independent set* (no two of them neighbours) of vertices of low degree is
//! taken away. So layers are nested, and a vertex that is taken away leaves all its neighbours
//! behind.
//!
//! Invariant. A fixed share of the vertices goes with each layer, so that there are `O(log n)`
//! layers of `O(n)` features in all. At least half of the vertices of a convex polyhedron have
//! fewer than [`LOW_DEGREE`] neighbours, and a greedy choice takes one in that many of them.
//!
//! Source: Dobkin and Kirkpatrick, "Determining the separation of preprocessed polyhedra - a
//! unified approach", ICALP 1990; Guibas, Hsu, Zhang 1999, on its use here.

use colltrans::ConvexPolyhedron;

use crate::features::{NotSolid, Shell};

/// Layers end when there are no more vertices than this.
const CORE: usize = 12;

/// Vertices with as many neighbours or more stay: the average is below 6, so fewer than half do.
const LOW_DEGREE: usize = 12;

/// A layer and its links to its neighbours, by vertices.
#[derive(Debug, Clone)]
pub(crate) struct Layer {
    pub(crate) shell: Shell,
    /// The same vertex in the next finer layer; empty in layer 0.
    pub(crate) finer: Vec<u32>,
    /// The same vertex in the next coarser layer, or a neighbour; empty in the last layer.
    pub(crate) coarser: Vec<u32>,
}

/// A body and ever coarser bodies inside it, each on some of the vertices of the one before.
#[derive(Debug, Clone)]
pub struct Hierarchy {
    layers: Vec<Layer>,
}

impl Hierarchy {
    /// The layers of a body, down to about a dozen vertices. Takes the time of a few hulls.
    ///
    /// # Errors
    /// The body is a polygon, a segment or a point.
    pub fn new(body: &ConvexPolyhedron) -> Result<Self, NotSolid> {
        let mut layers = Vec::new();
        let mut last = Layer { shell: Shell::new(body)?, finer: Vec::new(), coarser: Vec::new() };
        let mut coarse = coarser_body(body);
        while let Some((body, finer)) = coarse {
            let shell = Shell::new(&body)?;
            last.coarser = links(&last.shell, &finer);
            layers.push(std::mem::replace(&mut last, Layer { shell, finer, coarser: Vec::new() }));
            coarse = coarser_body(&body);
        }
        layers.push(last);
        Ok(Self { layers })
    }

    /// Number of layers.
    pub fn layer_count(&self) -> usize {
        self.layers.len()
    }

    /// Vertices of a layer; layer 0 is the body.
    ///
    /// # Panics
    /// If there is no such layer.
    pub fn vertex_count(&self, layer: usize) -> usize {
        self.layers[layer].shell.vertex_count()
    }

    /// Bytes of memory that the layers occupy, on the heap and in themselves.
    pub fn memory_bytes(&self) -> usize {
        let links = |layer: &Layer| 4 * (layer.finer.capacity() + layer.coarser.capacity());
        let layers = self.layers.iter().map(|layer| layer.shell.memory_bytes() + links(layer));
        size_of::<Self>() + layers.sum::<usize>()
    }

    /// A layer; the last one for all that are coarser.
    pub(crate) fn layer(&self, index: usize) -> &Layer {
        &self.layers[index.min(self.layers.len() - 1)]
    }
}

/// The hull of what is left without an independent set, and where its vertices come from; none if
/// the body is a core, or what is left is no solid.
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

/// Greedy, from the lowest degree.
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

/// For each vertex of a layer the same one in the coarser layer, or the nearest along edges: a
/// neighbour, unless the hull dropped that one as well because it lies in a face to within
/// rounding.
fn links(shell: &Shell, finer: &[u32]) -> Vec<u32> {
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
    fn layers_shrink_and_links_lead_to_the_same_points() {
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
    fn a_core_has_one_layer() {
        let cube = hierarchy(&cuboid(DVec3::ONE).vertices);
        assert_eq!((cube.layer_count(), cube.vertex_count(0)), (1, 8));
        assert_eq!(cube.layer(7).shell.some_vertex(Feature::Vertex(5)), 5);
        let flat = ConvexPolyhedron::from_points(&[DVec3::ZERO, DVec3::X, DVec3::Y]).unwrap();
        assert_eq!(Hierarchy::new(&flat).unwrap_err().dimension, 2);
    }
}
