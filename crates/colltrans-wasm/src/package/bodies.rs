//! The state of the full module: bodies of both kinds, and all questions.

use colltrans::glam::DVec3;
use colltrans::solid::AsSolid as _;
use colltrans::{ByKind, ConvexPolyhedron, Placed, Pose, Solid};

use super::answers::{Encode as _, Found};
use super::error::{Failure, Fallible, Kind};
use super::question::{CastOptions, Numbers, Question};
use super::rows::Rows;
use super::solid::{self, Facets};
use super::store::Store;
use super::{convex, motion, pairs};
use crate::Answers;
use crate::answer::Answer;

/// A body of either kind.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "the store keeps few bodies")]
pub(crate) enum Part {
    Convex(ConvexPolyhedron),
    Solid(Facets),
}

impl Part {
    /// Returns the body as a solid.
    pub(crate) fn surface(&self, argument: &'static str) -> Fallible<&Solid> {
        match self {
            Self::Convex(body) => {
                body.as_surface().map_err(|error| Failure::new(Kind::Build, argument, error))
            }
            Self::Solid(facets) => Ok(&facets.body),
        }
    }

    /// Returns the distance up to which vertices of the input denote the same point.
    pub(crate) fn precision(&self) -> f64 {
        if let Self::Solid(facets) = self { facets.precision } else { 0.0 }
    }

    fn properties(&self) -> Vec<f64> {
        match self {
            Self::Convex(body) => convex::properties(body),
            Self::Solid(facets) => solid::properties(&facets.body),
        }
    }
}

/// Two bodies in their poses.
pub(crate) struct Placement<'a> {
    pub(crate) bodies: [&'a Part; 2],
    pub(crate) poses: [Pose; 2],
}

impl<'a> Placement<'a> {
    /// Returns both bodies as convex bodies, or as solids if one of them is a solid.
    pub(crate) fn placed(&self) -> Fallible<ByKind<[Placed<'a>; 2], [Placed<'a, Solid>; 2]>> {
        let [p, q] = self.poses;
        if let [Part::Convex(moving), Part::Convex(fixed)] = self.bodies {
            return Ok(ByKind::Convex([moving.at(p), fixed.at(q)]));
        }
        let [moving, fixed] = self.bodies;
        Ok(ByKind::Solid([moving.surface("moving")?.at(p), fixed.surface("fixed")?.at(q)]))
    }
}

/// Bodies of both kinds, and all questions about two of them.
#[derive(Debug, Default)]
pub struct Bodies(Store<Part>);

impl Answers for Bodies {
    fn ask(&mut self, question: &[u8], file: Vec<u8>) -> Answer {
        self.answer(&mut Numbers::new(question), &file).unwrap_or_else(Failure::into_answer)
    }
}

impl Bodies {
    fn answer(&mut self, numbers: &mut Numbers<'_>, bytes: &[u8]) -> Fallible<Answer> {
        let question = numbers.question()?;
        if let Some(body) = self.build(question, numbers, bytes)? {
            return Ok(Answer::from_numbers([self.0.insert(body) as f64]));
        }
        Ok(match question {
            Question::Free => {
                self.0.remove(numbers.count()?);
                Answer::default()
            }
            Question::Properties => Answer::from_numbers(self.body(numbers)?.properties()),
            Question::Vertices => Answer::from_points(match self.body(numbers)? {
                Part::Convex(body) => body.vertices(),
                Part::Solid(facets) => facets.body.vertices(),
            }),
            Question::Triangles => match self.body(numbers)? {
                Part::Convex(body) => Answer::from_triangles(&convex::triangles(body)),
                Part::Solid(facets) => Answer::from_triangles(facets.body.triangles()),
            },
            Question::Rows => {
                let (question, bodies) = (numbers.question()?, self.bodies(numbers)?);
                let options = CastOptions::read(numbers)?;
                let length = numbers.next()?;
                Rows::read(numbers, bytes)?.answer(|row| {
                    let poses = [row.moving_pose, row.fixed_pose];
                    answer(question, &Placement { bodies, poses }, row.direction, &options, length)
                })
            }
            Question::PoseAt => {
                let motion = motion::read(numbers, bytes)?;
                Answer::from_numbers(motion::pose_at(&motion, numbers.next()?)?.encode())
            }
            Question::Motion => {
                let bodies = self.bodies(numbers)?;
                let options = CastOptions::read(numbers)?;
                Answer::from_numbers(motion::answer(bodies, numbers, bytes, &options)?.encode())
            }
            _ => {
                let bodies = self.bodies(numbers)?;
                let poses = [numbers.pose("movingPose")?, numbers.pose("fixedPose")?];
                let direction = numbers.vector()?;
                let options = CastOptions::read(numbers)?;
                let length = numbers.next()?;
                let placement = Placement { bodies, poses };
                let found = answer(question, &placement, direction, &options, length)?;
                Answer::from_numbers(found.encode())
            }
        })
    }

    /// Builds the body of a question; `None` if the question does not build one.
    fn build(
        &self,
        question: Question,
        numbers: &mut Numbers<'_>,
        bytes: &[u8],
    ) -> Fallible<Option<Part>> {
        Ok(Some(match question {
            Question::Solid => Part::Solid(Facets::read(numbers, bytes)?),
            Question::Rounded => {
                let (body, radius) = (self.body(numbers)?, numbers.next()?);
                let rejected = |error| Failure::new(Kind::Build, "radius", error);
                match body {
                    Part::Convex(body) => Part::Convex(
                        body.clone()
                            .rounded(radius)
                            .map_err(|error| rejected(error.to_string()))?,
                    ),
                    Part::Solid(Facets { body, precision }) => {
                        let body = body.clone().rounded(radius);
                        let body = body.map_err(|error| rejected(error.to_string()))?;
                        Part::Solid(Facets { body, precision: *precision })
                    }
                }
            }
            Question::Union => {
                let mut pieces = Vec::new();
                for _ in 0..numbers.count()? {
                    pieces.push(self.0.get(numbers.count()?, "pieces")?);
                }
                let surfaces: Fallible<Vec<_>> =
                    pieces.iter().map(|piece| piece.surface("pieces")).collect();
                let body = Solid::from_pieces(surfaces?)
                    .map_err(|error| Failure::new(Kind::Build, "pieces", error))?;
                let precision = pieces.iter().map(|piece| piece.precision()).fold(0.0, f64::max);
                Part::Solid(Facets { body, precision })
            }
            _ => return Ok(convex::build(question, numbers, bytes)?.map(Part::Convex)),
        }))
    }

    fn body(&self, numbers: &mut Numbers<'_>) -> Fallible<&Part> {
        self.0.get(numbers.count()?, "body")
    }

    fn bodies(&self, numbers: &mut Numbers<'_>) -> Fallible<[&Part; 2]> {
        Ok([self.0.get(numbers.count()?, "moving")?, self.0.get(numbers.count()?, "fixed")?])
    }
}

/// Answers a question about two bodies in their poses. A question along a direction uses the direction and the
/// options, the comparison of the distance uses the length.
fn answer(
    question: Question,
    placement: &Placement<'_>,
    direction: DVec3,
    options: &CastOptions,
    length: f64,
) -> Fallible<Found> {
    match question {
        Question::Cast | Question::Clearance | Question::ContactRange | Question::Intersects => {
            match placement.placed()? {
                ByKind::Convex(placed) => {
                    convex::answer(question, &convex::cast(placed, direction, options)?)
                }
                ByKind::Solid(placed) => {
                    let precisions = placement.bodies.map(Part::precision);
                    let cast = solid::cast(placed, direction, precisions, options)?;
                    solid::answer(question, &cast)
                }
            }
        }
        Question::Distance | Question::Depth | Question::Within => {
            pairs::answer(question, placement, length)
        }
        _ => Err(Failure::input("", "the package has no such question")),
    }
}
