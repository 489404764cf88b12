//! H-Walk: the distance of convex polyhedra by walks over features, with shortcuts through inner
//! layers.
//!
//! L. J. Guibas, D. Hsu, L. Zhang, "H-Walk: hierarchical distance computation for moving convex
//! bodies", `SoCG` 1999. As in the algorithm of Lin and Canny, a walk starts from the closest features
//! of the last query. If it gets stuck, or has not ended after some steps (its *patience*), it goes
//! on in the next coarser layer of both bodies' hierarchies ([`Hierarchy`]), where the same way is
//! shorter, and the closest features found there are where it comes back to the finer layer.
//!
//! The walk on a layer is V-Clip's ([`crate::vclip`]), which is Lin and Canny's made safe: the
//! published H-Walk leaves the choice of the walk open. The end is judged as V-Clip's is.

mod hierarchy;

use colltrans::Pose;
use glam::DVec3;

pub use hierarchy::Hierarchy;

use crate::features::Feature;
use crate::proximity::Proximity;
use crate::vclip::walk::{End, Pair, Scene, Work};
use crate::vclip::{FIRST_VERTICES, settle};
pub use crate::vclip::{NotSolid, Shell};
use hierarchy::Layer;

/// Pairs of features that a walk looks at on a layer before it takes a shortcut, unless set
/// otherwise.
const PATIENCE: u32 = 20;

/// The work of a query, counted as the papers do: all pairs of features on all layers.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Steps {
    /// Pairs of features looked at, on all layers.
    pub pairs: u32,
    /// Walks on layers.
    pub layers: u32,
    /// Shortcuts through a coarser layer.
    pub shortcuts: u32,
    /// Scans of all faces of a body, in local minima that shortcuts do not lead out of.
    pub scans: u32,
    /// Walks that started again because the answer was not proven.
    pub restarts: u32,
    /// The distance is at most what is reported and at least that less this gap, up to rounding
    /// (world units); 0 if the bodies overlap.
    pub gap: f64,
    /// Whether all restarts were used up and the gap is more than rounding explains.
    pub gave_up: bool,
}

/// The distance of two bodies that move, query after query.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::{ConvexPolyhedron, Pose};
/// use colltrans_yardsticks::hwalk::{HWalk, Hierarchy};
///
/// let corners = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| DVec3::new(
///     f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2),
/// ));
/// let cube = Hierarchy::new(&ConvexPolyhedron::from_points(&corners)?)?;
/// let mut solver = HWalk::new(&cube, &cube);
/// let aside = Pose::from_translation(DVec3::new(4.0, 5.0, 0.5))?;
/// assert_eq!(solver.distance(&Pose::IDENTITY, &aside).distance, 5.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct HWalk<'a> {
    hierarchies: [&'a Hierarchy; 2],
    patience: u32,
    /// The closest features of the last query.
    pair: Option<Pair>,
}

impl<'a> HWalk<'a> {
    /// A solver for two bodies; its first query starts from their coarsest layers.
    pub fn new(moving: &'a Hierarchy, fixed: &'a Hierarchy) -> Self {
        Self { hierarchies: [moving, fixed], patience: PATIENCE, pair: None }
    }

    /// With another number of pairs of features before a shortcut (the papers' `l`); at least 1.
    #[must_use]
    pub fn with_patience(self, patience: u32) -> Self {
        Self { patience: patience.max(1), ..self }
    }

    /// Forgets the closest features of the last query.
    pub fn reset(&mut self) {
        self.pair = None;
    }

    /// The distance of the bodies in these places.
    pub fn distance(&mut self, moving_pose: &Pose, fixed_pose: &Pose) -> Proximity<Steps> {
        let [moving, fixed] = self.hierarchies.map(|hierarchy| hierarchy.layer(0));
        let scene = Scene::new((&moving.shell, moving_pose), (&fixed.shell, fixed_pose));
        let mut query = Query {
            scene,
            hierarchies: self.hierarchies,
            patience: self.patience,
            work: Work::default(),
            steps: Steps::default(),
        };
        let (mut pair, end) = match self.pair {
            Some(mut pair) => {
                let end = query.walk(0, &mut pair);
                (pair, end)
            }
            None => query.descend(),
        };
        let settled = settle(&scene, &mut pair, end, &mut query.work);
        self.pair = Some(pair);
        let Query { work, steps, .. } = query;
        settled.proximity(
            fixed_pose,
            Steps {
                pairs: work.pairs,
                scans: work.scans,
                restarts: settled.restarts,
                gap: settled.gap,
                gave_up: settled.gave_up,
                ..steps
            },
        )
    }
}

/// A query under way.
struct Query<'a> {
    /// The bodies.
    scene: Scene<'a>,
    hierarchies: [&'a Hierarchy; 2],
    patience: u32,
    work: Work,
    steps: Steps,
}

impl<'a> Query<'a> {
    /// The coarsest layer that is one of either body.
    fn coarsest(&self) -> usize {
        self.hierarchies.iter().map(|h| h.layer_count() - 1).max().unwrap_or(0)
    }

    /// The bodies' layers in place.
    fn on_layer(&self, layer: usize) -> Scene<'a> {
        let [moving, fixed] = self.hierarchies.map(|hierarchy| hierarchy.layer(layer));
        self.scene.with_shells(&moving.shell, &fixed.shell)
    }

    /// From the first vertices of the coarsest layers through all layers to the bodies.
    fn descend(&mut self) -> (Pair, End) {
        let mut pair = FIRST_VERTICES;
        for layer in (1..=self.coarsest()).rev() {
            self.walk_to_the_end(layer, &mut pair);
            pair = self.finer(layer, pair);
        }
        let end = self.walk_patiently(0, &mut pair, u32::MAX);
        (pair, end)
    }

    /// Walks on a layer, by way of coarser ones if need be.
    fn walk(&mut self, layer: usize, pair: &mut Pair) -> End {
        let end = self.walk_patiently(layer, pair, self.patience);
        let stuck = matches!(end, End::OutOfPatience | End::LocalMinimum(_));
        if !stuck || layer == self.coarsest() {
            return if end == End::OutOfPatience {
                self.walk_patiently(layer, pair, u32::MAX)
            } else {
                end
            };
        }
        self.steps.shortcuts += 1;
        let mut coarse = self.coarser(layer, *pair);
        let end = self.walk(layer + 1, &mut coarse);
        self.leave_minimum(layer + 1, &mut coarse, end);
        *pair = self.finer(layer + 1, coarse);
        self.walk_patiently(layer, pair, u32::MAX)
    }

    fn walk_patiently(&mut self, layer: usize, pair: &mut Pair, patience: u32) -> End {
        self.steps.layers += 1;
        let scene = self.on_layer(layer);
        scene.walk(pair, patience.min(scene.patience()), &mut self.work)
    }

    fn walk_to_the_end(&mut self, layer: usize, pair: &mut Pair) {
        let end = self.walk_patiently(layer, pair, u32::MAX);
        self.leave_minimum(layer, pair, end);
    }

    /// Coarse layers are small, so a scan of all faces leads out of their local minima cheaply; on
    /// finer ones the layers below have done so already.
    fn leave_minimum(&mut self, layer: usize, pair: &mut Pair, end: End) {
        if layer == self.coarsest() {
            self.on_layer(layer).walk_on(pair, end, &mut self.work);
        }
    }

    /// The pair, or vertices next to it, on the next coarser layer.
    fn coarser(&self, layer: usize, pair: Pair) -> Pair {
        [0, 1].map(|body| {
            let hierarchy = self.hierarchies[body];
            let Layer { shell, coarser, .. } = hierarchy.layer(layer);
            if layer + 1 >= hierarchy.layer_count() {
                return pair[body];
            }
            Feature::Vertex(coarser[shell.some_vertex(pair[body]) as usize])
        })
    }

    /// The vertices of a pair's features that are next to its nearest points, on the next finer
    /// layer.
    fn finer(&self, layer: usize, pair: Pair) -> Pair {
        let scene = self.on_layer(layer);
        let near = scene.nearest(pair);
        let [from_moving, from_fixed] = &scene.views;
        let places: [(&dyn Fn(u32) -> DVec3, DVec3); 2] = [
            (&|v| from_fixed.seen(v), near.on_moving),
            (&|v| from_fixed.own.vertex(v), near.on_fixed),
        ];
        [0, 1].map(|body| {
            let hierarchy = self.hierarchies[body];
            if layer >= hierarchy.layer_count() {
                return pair[body];
            }
            let shell = [from_moving.own, from_fixed.own][body];
            let (place, point) = places[body];
            let square = |v: &u32| place(*v).distance_squared(point);
            let vertices = shell.vertices_of(pair[body]);
            let nearest = vertices.into_iter().min_by(|v, w| square(v).total_cmp(&square(w)));
            let vertex = nearest.unwrap_or_else(|| shell.some_vertex(pair[body]));
            Feature::Vertex(hierarchy.layer(layer).finer[vertex as usize])
        })
    }
}
