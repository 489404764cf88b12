//! H-Walk: the distance of convex polyhedra by walks on a hierarchy of layers.
//!
//! L. Guibas, D. Hsu, L. Zhang, "H-Walk: hierarchical distance computation for moving convex
//! bodies", Proc. 15th ACM Symposium on Computational Geometry, 1999. A walk over pairs of features
//! from those of the last query is fast if they are near. If it takes more than a few steps, a
//! *shortcut* leads through the layers of the Dobkin-Kirkpatrick hierarchy (`hierarchy`): one
//! layer coarser, where a step goes farther, and again until a walk ends in time, and back layer by
//! layer, with a walk of a few steps on each.
//!
//! What the paper leaves open, and what is done here: the walk on a layer is V-Clip's (see
//! [`crate::vclip`]; the paper's experiments walk as Lin and Canny do); a query without a last one
//! starts at the coarsest layer; layer `k` of one body is paired with layer `k` of the other, or
//! with its last. Layers lie inside the bodies, so features of any layer that cross end the query:
//! the bodies overlap, and the next query starts on that layer. The end on layer 0 is proven as
//! V-Clip's.

mod hierarchy;

use colltrans::Pose;

pub use crate::features::NotSolid;
pub use hierarchy::Hierarchy;

use crate::features::Feature;
use crate::proximity::Proximity;
use crate::vclip::walk::{End, Pair, Scene, Work};
use crate::vclip::{FIRST_VERTICES, Settled, settle};

/// Steps on a layer before a shortcut, unless set.
pub const DEFAULT_PATIENCE: u32 = 16;

/// The work of a query, and what it proves.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Steps {
    /// Pairs of features looked at, on all layers.
    pub pairs: u32,
    /// Walks, one for each layer each time it is entered.
    pub layers: u32,
    /// Times that the walk went to a coarser layer.
    pub shortcuts: u32,
    /// Scans of all faces of a layer, in local minima of the walk.
    pub scans: u32,
    /// Iterations of all loops: pairs of features looked at, faces scanned, and layers entered, also
    /// those that are only passed on the way to the layer where the walk starts.
    pub iterations: u32,
    /// How often an end that was not proven was left for nearer features around, or for a new walk.
    pub rescues: u32,
    /// The distance is at most what is reported and at least that less this gap, up to rounding
    /// (world units); 0 if the bodies overlap.
    pub gap: f64,
    /// Whether all rescues were used up and the gap is more than rounding explains.
    pub gave_up: bool,
}

/// The distance of two bodies that move, query after query.
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
/// let aside = Pose::from_translation(DVec3::new(4.0, 5.0, 0.5))?;
/// assert_eq!(solver.distance(&Pose::IDENTITY, &aside).distance, 5.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct HWalk<'a> {
    moving: &'a Hierarchy,
    fixed: &'a Hierarchy,
    patience: u32,
    /// The layer where a query picks the features of the last one, if that is fixed.
    start_layer: Option<usize>,
    /// Where the last query ended: a layer and a pair of features there.
    level: usize,
    pair: Pair,
}

impl<'a> HWalk<'a> {
    /// A solver for two bodies; its first query starts at their coarsest layers.
    pub fn new(moving: &'a Hierarchy, fixed: &'a Hierarchy) -> Self {
        let (patience, start_layer, pair) = (DEFAULT_PATIENCE, None, FIRST_VERTICES);
        let mut solver = Self { moving, fixed, patience, start_layer, level: 0, pair };
        solver.reset();
        solver
    }

    /// With a limit of steps on a layer before a shortcut, at least 1.
    #[must_use]
    pub fn with_patience(self, steps: u32) -> Self {
        Self { patience: steps.max(1), ..self }
    }

    /// With a fixed layer where a query picks the features of the last one, in place of shortcuts:
    /// the paper's parameter `l`. 0 is the body itself, the strongest initialisation; the coarsest
    /// layer, and any number beyond it, hardly initialises at all.
    #[must_use]
    pub fn with_start_layer(self, layer: usize) -> Self {
        Self { start_layer: Some(layer), ..self }
    }

    /// Forgets the closest features of the last query.
    pub fn reset(&mut self) {
        (self.level, self.pair) = (self.coarsest(), FIRST_VERTICES);
    }

    /// The distance of the bodies in these places.
    pub fn distance(&mut self, moving_pose: &Pose, fixed_pose: &Pose) -> Proximity<Steps> {
        let body = |hierarchy: &'a Hierarchy| &hierarchy.layer(0).shell;
        let scene = Scene::new((body(self.moving), moving_pose), (body(self.fixed), fixed_pose));
        let mut work = Work::default();
        let mut steps = Steps::default();
        self.pick_start(&mut steps);
        let end = self.descend(&scene, &mut work, &mut steps);
        let end = self.ascend(&scene, end, &mut work, &mut steps);
        let settled = settle(&self.on_layer(&scene), &mut self.pair, end, &mut work);
        let Settled { gap, rescues, gave_up, .. } = settled;
        let Work { pairs, scans, scanned } = work;
        let iterations = pairs + scanned + steps.layers;
        let steps = Steps { pairs, scans, iterations, rescues, gap, gave_up, ..steps };
        settled.proximity(fixed_pose, steps)
    }

    /// To the features on the layer where a walk is to start. A query that ended inside starts where
    /// it ended, if that is coarser.
    fn pick_start(&mut self, steps: &mut Steps) {
        let start = self.start_layer.map_or(0, |layer| layer.min(self.coarsest()));
        while self.level < start {
            self.coarsen();
            steps.layers += 1;
        }
    }

    /// To coarser layers until a walk ends in time. In a local minimum as well: the layers inside
    /// say more cheaply than a scan whether a vertex is.
    fn descend(&mut self, scene: &Scene<'a>, work: &mut Work, steps: &mut Steps) -> End {
        loop {
            let layer = self.on_layer(scene);
            let coarsest = self.level == self.coarsest();
            let no_shortcuts = coarsest || self.start_layer.is_some();
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

    /// Back to layer 0, from closest features of a layer to those of the next; or to the layer
    /// where the bodies meet.
    fn ascend(
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

    fn coarsest(&self) -> usize {
        self.moving.layer_count().max(self.fixed.layer_count()) - 1
    }

    fn on_layer(&self, scene: &Scene<'a>) -> Scene<'a> {
        scene.with_shells(&self.moving.layer(self.level).shell, &self.fixed.layer(self.level).shell)
    }

    /// One layer coarser, to vertices that are the same or neighbours.
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

    /// One layer finer, to the vertices of the features that are nearest to where they are closest.
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
