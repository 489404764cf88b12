//! H-Walk: distance of convex polyhedra by feature walks on a hierarchy of layers. L. Guibas, D. Hsu, L. Zhang,
//! "H-Walk: hierarchical distance computation for moving convex bodies", Proc. 15th ACM Symposium on Computational
//! Geometry, 1999.
//!
//! A walk over pairs of features from those of the last query is fast if they are close. If it exceeds a few steps, a
//! *shortcut* leads to the next coarser layer of the Dobkin-Kirkpatrick hierarchy (`hierarchy`), repeatedly until a
//! walk ends in time. Then it returns layer by layer, with a walk of a few steps on each. [`HWalk`] lists choices
//! that the paper leaves open.

mod hierarchy;

use colltrans::Pose;

pub use crate::features::NotSolid;
pub use hierarchy::Hierarchy;

use crate::features::Feature;
use crate::proximity::Proximity;
use crate::vclip::walk::{End, Pair, Scene, Work};
use crate::vclip::{FIRST_VERTICES, Settled, settle};

/// Default maximum number of steps on a layer before a shortcut.
pub const DEFAULT_PATIENCE: u32 = 16;

/// Work of a query, and its bound on the error.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Steps {
    /// Number of pairs of features examined, on all layers.
    pub pairs: u32,
    /// Number of walks, one each time a layer is entered.
    pub layers: u32,
    /// Number of shortcuts to a coarser layer.
    pub shortcuts: u32,
    /// Number of scans of all faces of a layer, in local minima of the walk.
    pub scans: u32,
    /// Iterations of all loops: pairs of features examined, faces scanned, and layers entered. This includes
    /// layers that are only passed on the way to the start of the walk.
    pub iterations: u32,
    /// Number of times that an unproven result was left for nearer features in its surroundings, or for
    /// another walk.
    pub rescues: u32,
    /// Bound on the error: the distance is at most the reported one, and at least the reported one minus this
    /// gap, up to rounding (world units). It is 0 if the bodies overlap.
    pub gap: f64,
    /// Whether all rescues were used and the gap exceeds rounding.
    pub gave_up: bool,
}

/// Solver for a sequence of distance queries between two bodies.
///
/// Choices that the paper leaves open:
/// - The walk on a layer is that of V-Clip ([`crate::vclip`]). The paper's experiments use Lin and Canny's walk.
/// - A query without a previous one starts at the coarsest layer. Layer `k` of one body is paired with layer `k` of
///   the other, or its last one.
/// - Layers are inside the bodies. Therefore features of any layer that cross prove an overlap; the next query starts
///   on that layer.
/// - The result on layer 0 is proven like that of V-Clip.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::{ConvexPolyhedron, Pose};
/// use colltrans_baselines::hwalk::{HWalk, Hierarchy};
///
/// let corners = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| DVec3::new(
///     f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2),
/// ));
/// let cube = Hierarchy::new(&ConvexPolyhedron::from_points(&corners)?)?;
/// let mut solver = HWalk::new(&cube, &cube).with_patience(10);
/// let offset = Pose::from_translation(DVec3::new(4.0, 5.0, 0.5))?;
/// assert_eq!(solver.distance(&Pose::IDENTITY, &offset).distance, 5.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct HWalk<'a> {
    moving: &'a Hierarchy,
    fixed: &'a Hierarchy,
    patience: u32,
    /// Layer at which a query takes the features of the last one, if it is fixed.
    start_layer: Option<usize>,
    /// Layer at which the last query ended; `pair` holds the features there.
    level: usize,
    pair: Pair,
}

impl<'a> HWalk<'a> {
    /// Creates a solver for two bodies; the first query starts at their coarsest layers.
    pub fn new(moving: &'a Hierarchy, fixed: &'a Hierarchy) -> Self {
        let (patience, start_layer, pair) = (DEFAULT_PATIENCE, None, FIRST_VERTICES);
        let mut solver = Self { moving, fixed, patience, start_layer, level: 0, pair };
        solver.reset();
        solver
    }

    /// Returns the solver with another maximum number of steps on a layer before a shortcut, at least 1.
    #[must_use]
    pub fn with_patience(self, steps: u32) -> Self {
        Self { patience: steps.max(1), ..self }
    }

    /// Returns the solver with a fixed start layer instead of shortcuts: the parameter `l` of the paper.
    /// Layer 0 is the body and initialises best. The coarsest layer, or any larger index, uses little of the
    /// last result.
    #[must_use]
    pub fn with_start_layer(self, layer: usize) -> Self {
        Self { start_layer: Some(layer), ..self }
    }

    /// Discards the closest features of the last query.
    pub fn reset(&mut self) {
        (self.level, self.pair) = (self.coarsest_layer(), FIRST_VERTICES);
    }

    /// Computes the distance of the placed bodies.
    pub fn distance(&mut self, moving_pose: &Pose, fixed_pose: &Pose) -> Proximity<Steps> {
        let body = |hierarchy: &'a Hierarchy| &hierarchy.layer(0).shell;
        let scene = Scene::new((body(self.moving), moving_pose), (body(self.fixed), fixed_pose));
        let mut work = Work::default();
        let mut steps = Steps::default();
        self.move_to_start_layer(&mut steps);
        let end = self.walk_on_coarser_layers(&scene, &mut work, &mut steps);
        let end = self.walk_to_layer_0(&scene, end, &mut work, &mut steps);
        let settled = settle(&self.on_layer(&scene), &mut self.pair, end, &mut work);
        let Settled { gap, rescues, gave_up, .. } = settled;
        let Work { pairs, scans, scanned } = work;
        let iterations = pairs + scanned + steps.layers;
        let steps = Steps { pairs, scans, iterations, rescues, gap, gave_up, ..steps };
        settled.proximity(fixed_pose, steps)
    }

    /// Moves to the layer at which the walk starts. A query whose predecessor ended on a coarser layer starts
    /// there.
    fn move_to_start_layer(&mut self, steps: &mut Steps) {
        let start = self.start_layer.map_or(0, |layer| layer.min(self.coarsest_layer()));
        while self.level < start {
            self.coarsen();
            steps.layers += 1;
        }
    }

    /// Moves to coarser layers until a walk ends in time. Local minima also cause a shortcut, because inner
    /// layers decide more cheaply than a scan whether a vertex is inside.
    fn walk_on_coarser_layers(
        &mut self,
        scene: &Scene<'a>,
        work: &mut Work,
        steps: &mut Steps,
    ) -> End {
        loop {
            let layer = self.on_layer(scene);
            let is_coarsest = self.level == self.coarsest_layer();
            let no_shortcuts = is_coarsest || self.start_layer.is_some();
            let patience = if no_shortcuts { layer.patience() } else { self.patience };
            steps.layers += 1;
            let end = layer.walk(&mut self.pair, patience, work);
            let stuck = matches!(end, End::OutOfPatience | End::LocalMinimum(_));
            if no_shortcuts || !stuck {
                return end;
            }
            steps.shortcuts += 1;
            self.coarsen();
        }
    }

    /// Returns to layer 0, from the closest features of a layer to those of the next, or to the layer on
    /// which the bodies meet.
    fn walk_to_layer_0(
        &mut self,
        scene: &Scene<'a>,
        mut end: End,
        work: &mut Work,
        steps: &mut Steps,
    ) -> End {
        while self.level > 0 {
            let layer = self.on_layer(scene);
            end = layer.walk_on(&mut self.pair, end, work);
            if let End::Penetrating(..) = end {
                return end;
            }
            self.refine(&layer);
            let layer = self.on_layer(scene);
            steps.layers += 1;
            end = layer.walk(&mut self.pair, layer.patience(), work);
        }
        end
    }

    /// Returns the index of the coarsest layer.
    fn coarsest_layer(&self) -> usize {
        self.moving.layer_count().max(self.fixed.layer_count()) - 1
    }

    /// Returns the bodies' shells on the current layer.
    fn on_layer(&self, scene: &Scene<'a>) -> Scene<'a> {
        scene.with_shells(&self.moving.layer(self.level).shell, &self.fixed.layer(self.level).shell)
    }

    /// Moves one layer coarser, to the same vertices or neighbours of them.
    fn coarsen(&mut self) {
        for (feature, body) in self.pair.iter_mut().zip([self.moving, self.fixed]) {
            let layer = body.layer(self.level);
            if self.level + 1 < body.layer_count() {
                let vertex = layer.shell.some_vertex(*feature);
                *feature = Feature::Vertex(layer.coarser[vertex as usize]);
            }
        }
        self.level += 1;
    }

    /// Moves one layer finer, to the vertices of the features nearest to the closest points.
    fn refine(&mut self, layer: &Scene<'a>) {
        let nearest = layer.nearest_vertices(self.pair);
        let bodies = [self.moving, self.fixed];
        for ((feature, vertex), body) in self.pair.iter_mut().zip(nearest).zip(bodies) {
            if self.level < body.layer_count() {
                *feature = Feature::Vertex(body.layer(self.level).finer[vertex as usize]);
            }
        }
        self.level -= 1;
    }
}
