//! The walk over pairs of features, from any pair to a closest one.
//!
//! Invariant: a step leads to a nearer pair, or to an equally near one with a feature of lower dimension
//! (Mirtich 1998). In exact arithmetic, no pair returns. With rounding, tied pairs can form a cycle. A step
//! depends on the pair alone, therefore a pair that returns once returns forever. The walk is compared with
//! the pair of the last step whose number was a power of two (Brent 1980), which detects every cycle.
//! [`super::proof`] evaluates the result.

use colltrans::Pose;

use super::view::{FaceVerdict, View};
use crate::features::{Feature, Shell};
use crate::placed::Relative;

/// A feature of the moving body and one of the fixed body.
pub(crate) type Pair = [Feature; 2];

/// Two placed bodies, each viewed from the other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scene<'a> {
    /// The view from the moving body's frame, and that from the fixed body's frame.
    pub(crate) views: [View<'a>; 2],
}

/// Result of a walk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum End {
    /// No feature has a nearer neighbour.
    Nearest,
    /// The walk returned to an earlier pair.
    Circle,
    /// The bodies have this common point, in the frame of this body.
    Penetrating(usize, glam::DVec3),
    /// A vertex of one body is below the face of this other body, and so are its neighbours.
    LocalMinimum(usize),
    /// The maximum number of steps was reached.
    OutOfPatience,
}

/// Work of a walk, counted as in the papers.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Work {
    /// Number of pairs of features examined.
    pub(crate) pairs: u32,
    /// Number of scans of all faces of a body.
    pub(crate) scans: u32,
    /// Number of faces examined in these scans.
    pub(crate) scanned: u32,
}

/// Outcome of one step.
enum Step {
    To(Pair),
    End(End),
}

impl<'a> Scene<'a> {
    /// Places two bodies.
    pub(crate) fn new(
        (moving, moving_pose): (&'a Shell, &Pose),
        (fixed, fixed_pose): (&'a Shell, &Pose),
    ) -> Self {
        let Relative { rotation, translation } = Relative::new(moving_pose, fixed_pose);
        let back = rotation.transpose();
        let from_moving = View {
            own: moving,
            other: fixed,
            rotation: back,
            translation: -(back * translation),
            flare: 0.0,
        };
        let from_fixed = View { own: fixed, other: moving, rotation, translation, flare: 0.0 };
        Self { views: [from_moving, from_fixed] }
    }

    /// Returns the scene with other shells in the same poses.
    pub(crate) fn with_shells(&self, moving: &'a Shell, fixed: &'a Shell) -> Self {
        let [from_moving, from_fixed] = self.views;
        Self {
            views: [
                View { own: moving, other: fixed, ..from_moving },
                View { own: fixed, other: moving, ..from_fixed },
            ],
        }
    }

    /// Returns the scene with Voronoi regions enlarged by a length.
    pub(crate) fn with_flare(&self, flare: f64) -> Self {
        Self { views: self.views.map(|view| View { flare, ..view }) }
    }

    /// Walks to a result, over at most `patience` pairs.
    pub(crate) fn walk(&self, pair: &mut Pair, patience: u32, work: &mut Work) -> End {
        let mut kept = *pair;
        for step in 1..=patience {
            work.pairs += 1;
            match self.step(*pair) {
                Step::End(end) => return end,
                Step::To(next) => *pair = next,
            }
            if *pair == kept {
                return End::Circle;
            }
            if step.is_power_of_two() {
                kept = *pair;
            }
        }
        End::OutOfPatience
    }

    /// Continues a walk until its result is not a local minimum. From a local minimum it continues at the
    /// face that the vertex is highest above; if there is none, the vertex is inside. Few scans are needed,
    /// because each one permanently leaves a pair that is farther apart than all earlier pairs. Rounding can
    /// send a walk back; [`MAX_SCANS`] limits that.
    pub(crate) fn walk_on(&self, pair: &mut Pair, mut end: End, work: &mut Work) -> End {
        for _ in 0..MAX_SCANS {
            let End::LocalMinimum(body) = end else { return end };
            let Feature::Vertex(vertex) = pair[1 - body] else { return end };
            work.scans += 1;
            work.scanned += self.views[body].own.face_count() as u32;
            let Some(face) = self.views[body].face_below(vertex) else {
                return End::Penetrating(body, self.views[body].seen(vertex));
            };
            pair[body] = Feature::Face(face);
            end = self.walk(pair, self.patience(), work);
        }
        end
    }

    /// Returns a number of steps that no regular walk needs: one for each feature.
    pub(crate) fn patience(&self) -> u32 {
        self.views.iter().map(|view| 2 * view.own.edge_count() as u32 + 2).sum()
    }

    /// Traverses a cycle once and selects its nearest pair.
    pub(crate) fn settle_in_circle(&self, pair: &mut Pair) {
        let (start, mut best) = (*pair, (self.nearest(*pair).distance, *pair));
        let mut at = start;
        for _ in 0..self.patience() {
            let Step::To(next) = self.step(at) else { break };
            at = next;
            if at == start {
                break;
            }
            let distance = self.nearest(at).distance;
            if distance < best.0 {
                best = (distance, at);
            }
        }
        *pair = best.1;
    }

    /// Computes the next pair.
    fn step(&self, pair: Pair) -> Step {
        use Feature::{Edge, Face, Vertex};
        // The body whose feature has the lower dimension has index `i`.
        let i = usize::from(dimension(pair[0]) > dimension(pair[1]));
        let j = 1 - i;
        let [low, high] = [self.views[i], self.views[j]];
        let moved = match (pair[i], pair[j]) {
            (Vertex(v), Vertex(w)) => {
                let first = low.vertex_vertex(v, w).map(|to| (i, to));
                first.or_else(|| high.vertex_vertex(w, v).map(|to| (j, to)))
            }
            (Vertex(v), Edge(e)) => {
                let first = high.edge_vertex(e, v).map(|to| (j, to));
                first.or_else(|| low.vertex_edge(v, e).map(|to| (i, to)))
            }
            (Edge(e), Edge(f)) => {
                let first = low.edge_edge(e, f).map(|to| (i, to));
                first.or_else(|| high.edge_edge(f, e).map(|to| (j, to)))
            }
            (Vertex(v), Face(f)) => return face_step(pair, i, high.face_vertex(f, v)),
            (Edge(e), Face(f)) => return face_step(pair, i, high.face_edge(f, e)),
            // No state leads to such a pair.
            (first, _) => Some((i, Vertex(low.own.some_vertex(first)))),
        };
        moved.map_or(Step::End(End::Nearest), |(body, to)| Step::To(replaced(pair, body, to)))
    }
}

/// Maximum number of scans. A regular walk leaves a local minimum for good, so more scans result from
/// rounding.
const MAX_SCANS: usize = 8;

/// Returns the dimension of a feature.
fn dimension(feature: Feature) -> u8 {
    match feature {
        Feature::Vertex(_) => 0,
        Feature::Edge(_) => 1,
        Feature::Face(_) => 2,
    }
}

/// Returns the pair with one feature replaced.
fn replaced(mut pair: Pair, body: usize, to: Feature) -> Pair {
    pair[body] = to;
    pair
}

/// Returns the step for a state in which the body other than `i` has a face.
fn face_step(pair: Pair, i: usize, verdict: FaceVerdict) -> Step {
    match verdict {
        FaceVerdict::Stay => Step::End(End::Nearest),
        FaceVerdict::Own(to) => Step::To(replaced(pair, 1 - i, to)),
        FaceVerdict::Other(to) => Step::To(replaced(pair, i, to)),
        FaceVerdict::Penetrating(x) => Step::End(End::Penetrating(1 - i, x)),
        FaceVerdict::LocalMinimum => Step::End(End::LocalMinimum(1 - i)),
    }
}
