//! How a statement is checked: against what it is about, without a search.

use super::error::{ProofError, ProofFileError};
use super::file::{Placement, Query};
use super::path::PathSetting;
use super::proven::{Proven, Verify};
use super::scene::Scene;
use super::{ProofFile, Statement};
use colltrans_convex::cast::Cast;
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::{check_direction, check_min_gap};
use colltrans_solid::kinds::ByKind;

/// A statement with what it is about.
type Claim<'a> = Box<dyn FnOnce() -> Result<Proven<'a>, ProofError> + 'a>;

fn claim<'a, S: 'a, V: Verify<'a, S>>(statement: &'a V, about: S) -> Claim<'a> {
    Box::new(move || statement.verify(&about))
}

impl ProofFile {
    /// Checks it as [`Cast::verify`] and [`Pair::verify`] do, without a search.
    ///
    /// # Errors
    /// The first thing that is not proven.
    pub fn check(&self) -> Result<Proven<'_>, ProofError> {
        self.claim()?()
    }

    /// Joins the statement with what it is about. Fails if they do not fit.
    pub(super) fn claim(&self) -> Result<Claim<'_>, ProofFileError> {
        use ByKind::{Convex, Solid};
        Ok(match (&self.query, &self.placement, &self.statement) {
            (Query::Cast(along), Placement::Poses(places), statement) => {
                check_direction(along.direction)?;
                check_min_gap(along.keep)?;
                match (statement, self.two(places)?) {
                    (Statement::Contacts(of), [Convex(p), Convex(q)])
                        if of.first.or(of.last).is_some() =>
                    {
                        claim(of, Cast::new(p, q, along.direction)?.keeping(along.keep)?)
                    }
                    (Statement::Separation(of), [Convex(p), Convex(q)]) => {
                        claim(of, Cast::new(p, q, along.direction)?.keeping(along.keep)?)
                    }
                    (Statement::Clearance(of), [Solid(p), Solid(q)]) => claim(of, ([p, q], *along)),
                    _ => return Err(ProofFileError::Statement),
                }
            }
            (Query::Pair, Placement::Poses(places), statement) => {
                match (statement, self.two(places)?) {
                    (Statement::Distance(of), [Convex(p), Convex(q)])
                        if of.gap.is_some() || of.near.is_some() =>
                    {
                        claim(of, Pair::new(p, q)?)
                    }
                    (Statement::Depth(of), [Convex(p), Convex(q)]) => claim(of, Pair::new(p, q)?),
                    (Statement::SolidDistance(of), [Solid(p), Solid(q)]) => {
                        claim(of, Pair::new(p, q)?)
                    }
                    (Statement::FreeDirections(of), [Solid(p), Solid(q)]) => claim(of, [p, q]),
                    _ => return Err(ProofFileError::Statement),
                }
            }
            (Query::Scene(choices), Placement::Poses(places), statement) => {
                let scene = Scene::new(&self.bodies, places, *choices)?;
                match statement {
                    Statement::Nearest(of) => claim(of, scene),
                    Statement::Within(of) => claim(of, scene),
                    Statement::SceneClearance(of) => claim(of, scene),
                    _ => return Err(ProofFileError::Statement),
                }
            }
            (Query::Motions(asked), Placement::Motions(movers), Statement::Motions(of)) => {
                claim(of, self.motions(asked, movers, of)?)
            }
            (Query::Path(joints), Placement::Robot(robot), Statement::Path(of)) => {
                claim(of, PathSetting::new(&self.bodies, robot, joints, &of.pairs)?)
            }
            _ => return Err(ProofFileError::Statement),
        })
    }
}
