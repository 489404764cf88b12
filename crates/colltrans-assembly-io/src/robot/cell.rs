//! A robot and the bodies of its surroundings: the names of all bodies, and the pairs that a path is checked
//! for.

use std::collections::BTreeMap;

use colltrans::motion::path::{JointPath, PathBody, PathCast, PathError};
use colltrans::{AnyBody, Pose};

use super::table::first_duplicate;
use super::{Robot, RobotError, RobotJoint};

/// A robot together with scene bodies, which are fixed in the world.
#[derive(Debug, Clone)]
pub struct Cell {
    robot: Robot,
    scene: Vec<AnyBody>,
    /// For each body the name of its link or scene body.
    names: Vec<String>,
    pairs: Vec<[usize; 2]>,
    /// Depths of the dents of bodies, by name ([`Self::dents`]).
    dents: BTreeMap<String, f64>,
    notes: Vec<String>,
}

/// The names of the links, followed by those of the scene bodies. Also maps each body to the link or the scene body to
/// which it belongs, called a *thing* in this module. A link has several bodies or none.
struct NamedBodies {
    names: Vec<String>,
    links: usize,
    /// For each body the number of its thing.
    bodies: Vec<usize>,
}

impl Cell {
    /// Builds a cell and selects the pairs of bodies to check.
    ///
    /// Each link that a joint moves is checked against every scene body. Links are checked against each other
    /// according to [`Robot::checked_pairs`].
    ///
    /// # Errors
    /// [`RobotError::Unknown`] if `listed` names a link that does not exist, and [`RobotError::DuplicateName`] if two
    /// links or scene bodies have the same name.
    pub fn new(
        robot: Robot,
        scene: Vec<(String, AnyBody)>,
        listed: Option<&[[String; 2]]>,
    ) -> Result<Self, RobotError> {
        let (scene_names, scene): (Vec<String>, Vec<AnyBody>) = scene.into_iter().unzip();
        let links = robot.links().iter().map(|link| &link.name);
        let around: Vec<&String> = links.chain(&scene_names).collect();
        if let Some(name) = first_duplicate(&around) {
            return Err(RobotError::DuplicateName { name: (*name).clone() });
        }
        let things = NamedBodies::new(&robot, scene_names);
        let mut notes = Vec::new();
        let pairs = things.body_pairs(&robot, listed, &mut notes)?;
        let names = things.bodies.iter().map(|thing| things.names[*thing].clone()).collect();
        let of_links =
            robot.links().iter().filter_map(|link| Some((link.name.clone(), link.dent?)));
        let dents = of_links.collect();
        Ok(Self { robot, scene, names, pairs, dents, notes })
    }

    /// Adds the dents of scene meshes that are convex only to within the tolerance: for each body its name and
    /// the depth of its mesh's surface below the convex hull.
    #[must_use]
    pub fn with_dents(mut self, of_scene: impl IntoIterator<Item = (String, f64)>) -> Self {
        self.dents.extend(of_scene);
        self
    }

    /// Removes pairs of bodies, given by the names of links or scene bodies, from the pairs to check.
    ///
    /// # Errors
    /// [`RobotError::Unknown`] if no link or scene body has one of the names.
    pub fn without_pairs(mut self, pairs: &[[String; 2]]) -> Result<Self, RobotError> {
        for [a, b] in pairs {
            for name in [a, b] {
                if !self.names.contains(name) && self.robot.link_index(name).is_err() {
                    let known = self.known_names().join(", ");
                    return Err(RobotError::Unknown { name: name.clone(), known });
                }
            }
            let before = self.pairs.len();
            let names = &self.names;
            let is_named = |x: usize, y: usize| names[x] == *a && names[y] == *b;
            self.pairs.retain(|[x, y]| !is_named(*x, *y) && !is_named(*y, *x));
            if self.pairs.len() == before {
                self.notes
                    .push(format!("ignoring {a} and {b} has no effect: this pair is not checked"));
            }
        }
        Ok(self)
    }

    /// Returns the names of all links and scene bodies.
    fn known_names(&self) -> Vec<&str> {
        let links = self.robot.links().iter().map(|link| link.name.as_str());
        let around = &self.names[self.names.len() - self.scene.len()..];
        links.chain(around.iter().map(String::as_str)).collect()
    }

    /// Returns the robot.
    pub const fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Returns the name of each body: those of the links first, then those of the scene.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Returns the pairs of bodies to check, as indices of [`Self::names`].
    pub fn pairs(&self) -> &[[usize; 2]] {
        &self.pairs
    }

    /// Returns the names of the links whose meshes are replaced by their convex hulls.
    pub fn hull_links(&self) -> Vec<String> {
        let links =
            self.robot.links().iter().filter(|link| link.is_hull && !link.bodies.is_empty());
        links.map(|link| link.name.clone()).collect()
    }

    /// Returns the names of the bodies whose meshes are convex only to within the tolerance, each with the
    /// depth of its surface below the hull that replaces it. Contains the dents of links and those of
    /// [`Self::with_dents`].
    pub const fn dents(&self) -> &BTreeMap<String, f64> {
        &self.dents
    }

    /// Returns notes on pairs that are not checked although no option excludes them, and on exclusions
    /// without effect.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Returns the cell if it has at least one pair of bodies to check.
    ///
    /// # Errors
    /// [`RobotError::NoPair`] if there is no such pair, because every path would then be free.
    pub fn require_pair(self) -> Result<Self, RobotError> {
        if self.pairs.is_empty() { Err(RobotError::NoPair) } else { Ok(self) }
    }

    /// Builds the query whether the distance of the bodies of a pair falls below `min_gap`, a length, on a path.
    ///
    /// # Errors
    /// The errors of [`PathCast::new`], and [`PathError`] if the gap is invalid.
    pub fn path_cast<'a>(
        &'a self,
        path: &'a JointPath,
        min_gap: f64,
    ) -> Result<PathCast<'a>, PathError> {
        let links = self.robot.links().iter();
        let carried = links.flat_map(|link| link.bodies.iter().map(|body| (link.frame, body)));
        let carried =
            carried.map(|(frame, body)| PathBody { frame, placed: body.at(Pose::IDENTITY) });
        let scene = self.scene.iter().map(|body| PathBody::at_rest(body.at(Pose::IDENTITY)));
        let bodies = carried.chain(scene).collect();
        PathCast::new(self.robot.mechanism(), path, bodies, self.pairs.clone())?
            .with_min_gap(min_gap)
    }

    /// Returns the message of an error with the names of bodies and joints instead of their numbers.
    pub fn error_message(&self, error: &PathError) -> String {
        match error {
            PathError::Query { pair, reason } => {
                let [a, b] = pair.map(|k| self.names[k].as_str());
                format!("{a} and {b}: {reason}")
            }
            PathError::Value { row, frame, value } => {
                let moves = |joint: &&RobotJoint| joint.frame == *frame;
                let name = self.robot.joints().iter().find(moves).map_or("?", |joint| &joint.name);
                format!(
                    "row {row}: invalid value {value} of joint {name}; accepted: finite, at most 1e5 radians"
                )
            }
            other => other.to_string(),
        }
    }
}

impl NamedBodies {
    fn new(robot: &Robot, scene: Vec<String>) -> Self {
        let links = robot.links();
        let counts = links.iter().map(|link| link.bodies.len()).chain(scene.iter().map(|_| 1));
        let bodies = counts.enumerate().flat_map(|(k, count)| std::iter::repeat_n(k, count));
        let bodies = bodies.collect();
        let names = links.iter().map(|link| link.name.clone()).chain(scene).collect();
        Self { names, links: links.len(), bodies }
    }

    fn body_pairs(
        &self,
        robot: &Robot,
        listed: Option<&[[String; 2]]>,
        notes: &mut Vec<String>,
    ) -> Result<Vec<[usize; 2]>, RobotError> {
        let mut things = robot.checked_pairs(listed)?;
        if listed.is_none() {
            let skipped = robot.checked_pairs(Some(&[]))?.len() - things.len();
            let pairs = if skipped == 1 { "pair of links" } else { "pairs of links" };
            if skipped > 0 {
                notes.push(format!(
                    "{skipped} {pairs} with one joint between them are not checked; to check neighbours, give an \
                     SRDF file that lists the pairs to skip"
                ));
            }
        }
        if listed.is_some_and(<[_]>::is_empty) {
            notes.push(
                "the SRDF file has no disable_collisions: all pairs of links are checked".into(),
            );
        }
        let mut rests = false;
        for link in 0..self.links {
            let moves = robot.joints_between(link, None) > 0;
            for mesh in self.links..self.names.len() {
                if moves {
                    things.push([link, mesh]);
                }
                rests |= !moves && !robot.links()[link].bodies.is_empty();
            }
        }
        if rests {
            notes.push("links that no joint moves are not checked against the scene".into());
        }
        let own = |thing: usize| {
            self.bodies.iter().enumerate().filter(move |(_, of)| **of == thing).map(|(k, _)| k)
        };
        Ok(things
            .iter()
            .flat_map(|[a, b]| own(*a).flat_map(move |x| own(*b).map(move |y| [x, y])))
            .collect())
    }
}
