//! Checks of statements against their bodies and queries, without a search.

use super::error::{ProofError, ProofFileError};
use super::file::{Placement, Query};
use super::path::PathSetting;
use super::proven::{Proven, Verify};
use super::scene::PlacedScene;
use super::{ProofFile, Statement};
use colltrans_convex::cast::Cast;
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::{check_direction, check_min_gap};
use colltrans_solid::kinds::ByKind;

/// Statement together with its bodies and query.
type Claim<'a> = Box<dyn FnOnce() -> Result<Proven<'a>, ProofError> + 'a>;

fn boxed_claim<'a, S: 'a, V: Verify<'a, S>>(statement: &'a V, about: S) -> Claim<'a> {
    Box::new(move || statement.verify(&about))
}

impl ProofFile {
    /// Checks the proof without a search, like [`Cast::verify`] and [`Pair::verify`].
    ///
    /// # Errors
    /// Returns the first claim that is not proven.
    pub fn check(&self) -> Result<Proven<'_>, ProofError> {
        self.join_claim()?()
    }

    /// Joins the statement with its bodies and query. Returns an error if they do not fit.
    pub(super) fn join_claim(&self) -> Result<Claim<'_>, ProofFileError> {
        use ByKind::{Convex, Solid};
        Ok(match (&self.query, &self.placement, &self.statement) {
            (Query::Cast(along), Placement::Poses(places), statement) => {
                check_direction(along.direction)?;
                check_min_gap(along.min_gap)?;
                match (statement, self.two_placed(places)?) {
                    (Statement::Contacts(of), [Convex(p), Convex(q)])
                        if of.first.or(of.last).is_some() =>
                    {
                        boxed_claim(
                            of,
                            Cast::new(p, q, along.direction)?.with_min_gap(along.min_gap)?,
                        )
                    }
                    (Statement::Separation(of), [Convex(p), Convex(q)]) => boxed_claim(
                        of,
                        Cast::new(p, q, along.direction)?.with_min_gap(along.min_gap)?,
                    ),
                    (Statement::Clearance(of), [Solid(p), Solid(q)]) => {
                        boxed_claim(of, ([p, q], *along))
                    }
                    _ => return Err(ProofFileError::Statement),
                }
            }
            (Query::Pair, Placement::Poses(places), statement) => {
                match (statement, self.two_placed(places)?) {
                    (Statement::Distance(of), [Convex(p), Convex(q)])
                        if of.gap.is_some() || of.near.is_some() =>
                    {
                        boxed_claim(of, Pair::new(p, q)?)
                    }
                    (Statement::Depth(of), [Convex(p), Convex(q)]) => {
                        boxed_claim(of, Pair::new(p, q)?)
                    }
                    (Statement::SolidDistance(of), [Solid(p), Solid(q)]) => {
                        boxed_claim(of, Pair::new(p, q)?)
                    }
                    (Statement::SolidDepth(of), [Solid(p), Solid(q)]) => {
                        boxed_claim(of, Pair::new(p, q)?)
                    }
                    (Statement::SolidCommonPart(of), [Solid(p), Solid(q)]) => {
                        boxed_claim(of, Pair::new(p, q)?)
                    }
                    (Statement::FreeDirections(of), [Solid(p), Solid(q)]) => {
                        boxed_claim(of, [p, q])
                    }
                    _ => return Err(ProofFileError::Statement),
                }
            }
            (Query::Scene(choices), Placement::Poses(places), statement) => {
                let scene = PlacedScene::new(&self.bodies, places, *choices)?;
                match statement {
                    Statement::Nearest(of) => boxed_claim(of, scene),
                    Statement::Within(of) => boxed_claim(of, scene),
                    Statement::SceneClearance(of) => boxed_claim(of, scene),
                    _ => return Err(ProofFileError::Statement),
                }
            }
            (Query::Motions(pair_options), Placement::Motions(movers), Statement::Motions(of)) => {
                boxed_claim(of, self.motion_query(pair_options, movers, of)?)
            }
            (Query::Path(joints), Placement::Robot(robot), Statement::Path(of)) => {
                boxed_claim(of, PathSetting::new(&self.bodies, robot, joints, &of.pairs)?)
            }
            _ => return Err(ProofFileError::Statement),
        })
    }
}
