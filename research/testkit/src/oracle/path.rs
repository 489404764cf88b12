//! Draws random arms on random paths, and judges the answers at many times.
//!
//! Positions are products of plain matrices with the sine and cosine of the platform, with errors of some 1e-15
//! of the size. The kinematic chains of the library are not used. Before `lower` all pairs must be disjoint. At
//! `upper` the reported pair must overlap.

use std::borrow::Cow;

use colltrans::motion::path::{
    Frame, Joint, JointPath, Mechanism, PathBody, PathCast, PathOutcome, PathPlace,
};
use colltrans::{ConvexPolyhedron, Pair, Pose, Solid};
use glam::{DAffine3, DMat3, DQuat, DVec3};

use crate::oracle::check::Objection;
use crate::random::Random;
use crate::shapes::{Mesh, random_hull};
use crate::solids::{bumpy_ball, washer};

/// Tolerance for the errors of the judge's own positions.
const OFF: f64 = 1e-12;

/// A body of either kind.
#[derive(Debug, Clone)]
#[expect(clippy::large_enum_variant, reason = "a mechanism has few bodies")]
pub enum Body {
    /// A convex body.
    Convex(ConvexPolyhedron),
    /// A solid.
    Solid(Solid),
}

/// A mechanism with bodies, on a path.
#[derive(Debug, Clone)]
pub struct Arm {
    /// The frames with their joints.
    pub frames: Vec<Frame>,
    /// The values of the joints, one row each.
    pub rows: Vec<Vec<f64>>,
    /// The bodies, each with its frame (`None` is the world) and its pose in it.
    pub bodies: Vec<(Option<usize>, Body, Pose)>,
    /// The pairs of bodies to check.
    pub pairs: Vec<[usize; 2]>,
    /// The minimum gap.
    pub min_gap: f64,
}

impl Arm {
    /// Draws an arm of one to seven joints, rotating and sliding, on a path of a few rows through a few
    /// obstacles. With `solids`, bodies may be solids that are not convex.
    ///
    /// # Panics
    /// Never, because all numbers yield valid bodies and poses.
    pub fn random(seed: u64, solids: bool) -> Self {
        let mut random = Random::new(seed ^ 0x0a23_77f1);
        let count = 1 + random.index(7);
        let (mut frames, mut joints): (Vec<Frame>, usize) = (Vec::new(), 0);
        for k in 0..count {
            let axis = if random.one_in(2) { DVec3::Z } else { random.direction() };
            let joint = match random.index(8) {
                0 => Joint::Sliding(axis),
                1 if k > 0 => Joint::Fixed,
                _ => Joint::Turning(axis),
            };
            joints += usize::from(joint != Joint::Fixed);
            let parent = if k > 0 && random.one_in(6) {
                random.index(k).checked_sub(1)
            } else {
                k.checked_sub(1)
            };
            let way = random.direction() * random.range(0.0, 1.0);
            let turn = if random.one_in(2) { DQuat::IDENTITY } else { random.rotation() };
            let origin = Pose::new(turn, if k == 0 { DVec3::ZERO } else { way }).expect("a pose");
            frames.push(Frame { parent, origin, joint });
        }
        let rows = 1 + random.index(4);
        let most = random.pick(&[0.01, 0.3, 2.0, 6.0]);
        let mut row: Vec<f64> = (0..joints).map(|_| random.range(-1.0, 1.0)).collect();
        let mut all = vec![row.clone()];
        for _ in 0..rows {
            for value in &mut row {
                *value += random.range(-most, most);
            }
            all.push(row.clone());
        }
        let mut bodies = Vec::new();
        for frame in 0..count {
            if frame == 0 || !random.one_in(4) {
                let size = random.pick(&[0.05, 0.2, 0.4]);
                let pose = Pose::from_translation(random.vector() * 0.3).expect("a pose");
                bodies.push((Some(frame), draw_body(&mut random, size, solids), pose));
            }
        }
        let carried = bodies.len();
        let mut arm = Self { frames, rows: all, bodies, pairs: Vec::new(), min_gap: 0.0 };
        for _ in 0..=random.index(3) {
            // The obstacle is near a position of a body on the path.
            let size = random.pick(&[0.02, 0.2, 0.5]);
            let place = PathPlace { row: random.index(rows), share: random.unit() };
            let frame = arm.bodies[random.index(carried)].0.unwrap_or(0);
            let by = arm.places(place)[frame].translation;
            let pose =
                Pose::new(random.rotation(), by + random.direction() * random.range(0.2, 1.0));
            arm.bodies.push((None, draw_body(&mut random, size, solids), pose.expect("a pose")));
        }
        let count = arm.bodies.len();
        arm.pairs = (0..carried)
            .flat_map(|a| (a + 1..count).map(move |b| [a, b]))
            .filter(|[a, b]| *b >= carried || *b > *a + 1)
            .collect();
        arm.min_gap = if random.one_in(4) { random.pick(&[1e-6, 0.01, 0.1]) } else { 0.0 };
        arm
    }

    /// Returns the transformation of each frame, by plain matrices.
    pub fn places(&self, place: PathPlace) -> Vec<DAffine3> {
        let rows = &self.rows;
        let next = &rows[(place.row + 1).min(rows.len() - 1)];
        let mut values = rows[place.row].iter().zip(next).map(|(a, b)| a + (b - a) * place.share);
        let mut found: Vec<DAffine3> = Vec::new();
        for frame in &self.frames {
            let origin =
                DAffine3::from_mat3_translation(frame.origin.matrix(), frame.origin.translation());
            let moved = match frame.joint {
                Joint::Fixed => DAffine3::IDENTITY,
                Joint::Turning(axis) => {
                    let turn =
                        DMat3::from_axis_angle(axis.normalize(), values.next().unwrap_or(0.0));
                    DAffine3::from_mat3(turn)
                }
                Joint::Sliding(axis) => {
                    DAffine3::from_translation(axis.normalize() * values.next().unwrap_or(0.0))
                }
            };
            let parent = frame.parent.map_or(DAffine3::IDENTITY, |parent| found[parent]);
            found.push(parent * origin * moved);
        }
        found
    }

    /// Returns the distance of two bodies, or the negative depth if they overlap. For overlapping solids it is
    /// negative infinity.
    ///
    /// # Errors
    /// [`Objection`] if a pose is invalid, or the library has no answer.
    pub fn gap(&self, pair: [usize; 2], place: PathPlace) -> Result<f64, Objection> {
        let places = self.places(place);
        let pose = |k: usize| {
            let (frame, _, pose) = &self.bodies[k];
            let own = DAffine3::from_mat3_translation(pose.matrix(), pose.translation());
            let there = frame.map_or(DAffine3::IDENTITY, |frame| places[frame]) * own;
            Pose::from_matrix(there.matrix3, there.translation)
        };
        let failed = |what: &dyn std::fmt::Display| Objection(format!("no distance: {what}"));
        let [a, b] = pair;
        let [p, q] = [pose(a), pose(b)];
        let (p, q) = (p.map_err(|e| failed(&e))?, q.map_err(|e| failed(&e))?);
        match [&self.bodies[a].1, &self.bodies[b].1] {
            [Body::Convex(x), Body::Convex(y)] => {
                let pair = Pair::new(x.at(p), y.at(q)).map_err(|e| failed(&e))?;
                let distance = pair.distance().map_err(|e| failed(&e))?;
                if distance.lower > 0.0 {
                    return Ok(distance.lower);
                }
                Ok(-pair.depth().map_err(|e| failed(&e))?.lower)
            }
            [x, y] => {
                let (x, y) = (x.solid(), y.solid());
                let pair = Pair::new(x.at(p), y.at(q)).map_err(|e| failed(&e))?;
                let found = pair.distance().map_err(|e| failed(&e))?;
                Ok(if found.upper == 0.0 { f64::NEG_INFINITY } else { found.lower })
            }
        }
    }

    /// Computes the first contact, and judges the answer at `samples` times before it.
    ///
    /// # Errors
    /// [`Objection`] with the first statement that is false.
    pub fn judge(&self, samples: usize) -> Result<PathOutcome, Objection> {
        let object = |what: &dyn std::fmt::Display| Objection(what.to_string());
        let mechanism = Mechanism::new(self.frames.clone()).map_err(|e| object(&e))?;
        let path = JointPath::at_unit_times(self.rows.clone()).map_err(|e| object(&e))?;
        let bodies = self.bodies.iter().map(|(frame, body, pose)| PathBody {
            frame: *frame,
            placed: match body {
                Body::Convex(body) => body.at(*pose).into(),
                Body::Solid(body) => body.at(*pose).into(),
            },
        });
        let cast = PathCast::new(&mechanism, &path, bodies.collect(), self.pairs.clone());
        let cast = cast.and_then(|cast| cast.with_min_gap(self.min_gap)).map_err(|e| object(&e))?;
        let outcome = cast.first_contact().map_err(|e| object(&e))?;
        let checked = cast.verify(outcome.proof()).map_err(|e| object(&e))?;
        let last = self.rows.len() as f64 - 1.0;
        let said = match &outcome {
            PathOutcome::Contact(of) | PathOutcome::Undecided(of) => [of.lower, of.upper],
            PathOutcome::Grazing(of) => [of.lower, f64::INFINITY],
            PathOutcome::Overlapping(_) => [0.0; 2],
            _ => [last, f64::INFINITY],
        };
        if said != checked {
            return Err(Objection(format!("reported {said:?}, proven {checked:?}")));
        }
        for k in 0..samples {
            let time = said[0] * k as f64 / samples as f64;
            let row = (time as usize).min(self.rows.len() - 2);
            let place = PathPlace { row, share: time - row as f64 };
            for pair in &self.pairs {
                let gap = self.gap(*pair, place)?;
                if gap < self.min_gap - OFF && said[1] > 0.0 {
                    return Err(Objection(format!("{pair:?} are {gap:e} apart at {time}")));
                }
            }
        }
        if let PathOutcome::Contact(of) | PathOutcome::Overlapping(of) = &outcome
            && let Some(meeting) = &of.proof.meeting
        {
            let gap = self.gap(of.pair, meeting.place)?;
            if gap > self.min_gap {
                return Err(Objection(format!("{:?} are {gap:e} apart at {}", of.pair, of.upper)));
            }
        }
        Ok(outcome)
    }
}

impl Body {
    /// Returns the body as a solid.
    fn solid(&self) -> Cow<'_, Solid> {
        match self {
            Self::Convex(body) => Cow::Owned(Solid::from_convex(body).expect("a solid")),
            Self::Solid(solid) => Cow::Borrowed(solid),
        }
    }
}

/// Draws a body of about this size.
fn draw_body(random: &mut Random, size: f64, solids: bool) -> Body {
    let mesh: Mesh = match random.index(if solids { 4 } else { 2 }) {
        0 | 1 => {
            let hull = random_hull(random.pick(&[4, 8, 12, 32]), random);
            let flat = DVec3::new(1.0, random.range(0.1, 1.0), random.range(0.1, 1.0)) * size;
            let points: Vec<DVec3> = hull.vertices.iter().map(|v| *v * flat).collect();
            return Body::Convex(ConvexPolyhedron::from_points(&points).expect("a body"));
        }
        2 => bumpy_ball(random.pick(&[80, 200])),
        _ => washer([0.6, 1.0], [-0.2, 0.2], 12),
    };
    let mesh = mesh.mapped(|v| v * size).triangulated();
    Body::Solid(Solid::from_mesh(&mesh.vertices, &mesh.faces).expect("a solid"))
}
