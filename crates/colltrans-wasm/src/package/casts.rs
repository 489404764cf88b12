//! The state of the small module: convex bodies, and questions along a direction.

use colltrans::ConvexPolyhedron;
use colltrans::glam::DVec3;

use super::answers::Found;
use super::convex;
use super::error::{Failure, Fallible};
use super::question::{CastOptions, Numbers, Question};
use super::rows::Rows;
use super::store::Store;
use crate::Answers;
use crate::answer::Answer;

/// Convex bodies, and questions along a direction.
#[derive(Debug, Default)]
pub struct Casts(Store<ConvexPolyhedron>);

impl Answers for Casts {
    fn ask(&mut self, question: &[u8], file: Vec<u8>) -> Answer {
        self.answer(&mut Numbers::new(question), &file).unwrap_or_else(Failure::into_answer)
    }
}

impl Casts {
    fn answer(&mut self, numbers: &mut Numbers<'_>, bytes: &[u8]) -> Fallible<Answer> {
        let question = numbers.question()?;
        if let Some(body) = convex::build(question, numbers, bytes)? {
            return Ok(Answer::from_numbers([self.0.insert(body) as f64]));
        }
        Ok(match question {
            Question::Free => {
                self.0.remove(numbers.count()?);
                Answer::default()
            }
            Question::Properties => Answer::from_numbers(convex::properties(self.body(numbers)?)),
            Question::Vertices => Answer::from_points(self.body(numbers)?.vertices()),
            Question::Triangles => Answer::from_triangles(&convex::triangles(self.body(numbers)?)),
            Question::Rows => {
                let question = numbers.question()?;
                let bodies = self.bodies(numbers)?;
                let options = CastOptions::read(numbers)?;
                Rows::read(numbers, bytes)?.answer(|row| {
                    let [moving, fixed] = bodies;
                    let placed = [moving.at(row.moving_pose), fixed.at(row.fixed_pose)];
                    along(question, placed, row.direction, &options)
                })
            }
            Question::Cast
            | Question::Clearance
            | Question::ContactRange
            | Question::Intersects => {
                let [moving, fixed] = self.bodies(numbers)?;
                let placed =
                    [moving.at(numbers.pose("movingPose")?), fixed.at(numbers.pose("fixedPose")?)];
                let direction = numbers.vector()?;
                let options = CastOptions::read(numbers)?;
                Answer::from_numbers(along(question, placed, direction, &options)?.encode())
            }
            _ => return Err(unsupported()),
        })
    }

    fn body(&self, numbers: &mut Numbers<'_>) -> Fallible<&ConvexPolyhedron> {
        self.0.get(numbers.count()?, "body")
    }

    fn bodies(&self, numbers: &mut Numbers<'_>) -> Fallible<[&ConvexPolyhedron; 2]> {
        Ok([self.0.get(numbers.count()?, "moving")?, self.0.get(numbers.count()?, "fixed")?])
    }
}

/// Answers a question along a direction.
fn along(
    question: Question,
    placed: [colltrans::Placed<'_>; 2],
    direction: DVec3,
    options: &CastOptions,
) -> Fallible<Found> {
    match question {
        Question::Cast | Question::Clearance | Question::ContactRange | Question::Intersects => {
            convex::answer(question, &convex::cast(placed, direction, options)?)
        }
        _ => Err(unsupported()),
    }
}

/// Returns the error of a question that only the other state answers.
fn unsupported() -> Failure {
    Failure::input(
        "",
        "colltrans/cast has convex polyhedra and questions along a direction: import colltrans",
    )
}
