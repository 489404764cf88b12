//! The bodies of a scene: mesh files, and files of obstacles with a place each.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use colltrans::glam::DVec3;
use colltrans::solid::{AsSolid, SolidCast, StartOverlap};
use colltrans::{
    Aabb, AnyBody, AnyPlaced, ByKind, ObstacleId, Obstacles, Placed, Pose, QueryError, Solid,
};
use colltrans_mesh::body::{BodyOptions, between};
use serde::Deserialize;

use crate::args::{BodyArguments, Taken};
use crate::batch::{Batch, BodySource, Cache, PoseSource, Shape, syntax_message};
use crate::body::{self, is_part, refusal};
use crate::failure::{Code, Failure};
use crate::inputs::{Watched, is_list, read_text};
use crate::solid::Body;

/// What rounding alone can do to a length, as a part of the scene's size.
const ROUNDING: f64 = 1e-14;

/// A body of either kind, of a file.
#[derive(Clone)]
pub(super) struct Known {
    pub(super) body: AnyBody,
    precision: f64,
    /// As [`Part::dent`](crate::body::Part::dent).
    pub(super) dent: Option<f64>,
}

/// How files are taken.
#[derive(Clone, Copy)]
pub(super) struct Ways {
    pub(super) taken: Taken,
    /// Of the moving body, and of those of the scene.
    pub(super) convex: [BodyOptions; 2],
    pub(super) parts: [BodyOptions; 2],
    pub(super) body: BodyArguments,
}

/// A body, and all others.
pub(super) struct Scene {
    pub(super) moving: Known,
    pub(super) obstacles: Obstacles,
    /// By their numbers.
    pub(super) names: Vec<String>,
    precisions: Vec<f64>,
    dents: Vec<Option<f64>>,
    /// What was mended, and how far hulls exceed their parts.
    pub(super) notes: Vec<String>,
}

/// A line of a file of obstacles.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object that holds an obstacle")]
struct Line {
    body: BodySource,
    #[serde(default)]
    pose: PoseSource,
    name: Option<String>,
}

impl Scene {
    /// Of a mesh file, and of mesh files and files of obstacles.
    pub(super) fn load(moving: &Path, files: &[PathBuf], ways: &Ways) -> Result<Self, Failure> {
        let mut notes = Vec::new();
        let moving = ways.mesh(moving, 0, &mut notes)?;
        let (mut placed, mut names) = (Vec::new(), Vec::new());
        let (mut precisions, mut dents) = (Vec::new(), Vec::new());
        for file in files {
            let found = if is_list(file) {
                ways.list(file, &mut notes)?
            } else {
                let known = ways.mesh(file, 1, &mut notes)?;
                vec![(known, Pose::IDENTITY, file.display().to_string())]
            };
            for (Known { body, precision, dent }, pose, name) in found {
                placed.push((body, pose));
                names.push(name);
                precisions.push(precision);
                dents.push(dent);
            }
        }
        let mut obstacles = Obstacles::new();
        obstacles.insert_all(placed);
        Ok(Self { moving, obstacles, names, precisions, dents, notes })
    }

    /// Returns the depth of an obstacle's dent; `None` if its mesh is convex, or it is a solid.
    pub(super) fn dent(&self, obstacle: ObstacleId) -> Option<f64> {
        self.dents.get(obstacle.0 as usize).copied().flatten()
    }

    /// The tolerance that the files and poses of all solids ask for; none without solids.
    pub(super) fn tolerance(&self, at: Pose, direction: DVec3) -> Result<Option<f64>, QueryError> {
        let moving = self.moving.body.at(at);
        let mut most: Option<f64> = None;
        for (ObstacleId(id), body, pose) in self.obstacles.iter() {
            if let (ByKind::Convex(_), AnyBody::Convex(_)) = (moving, body) {
                continue;
            }
            let placed = [as_solid(moving)?, as_solid(body.at(pose))?];
            let precisions = [self.moving.precision, self.precisions[id as usize]];
            let refuse = StartOverlap::Refuse;
            let cast = between(placed[0], placed[1], direction, precisions, None, refuse)?;
            most = Some(most.unwrap_or_default().max(cast.tolerance()));
        }
        Ok(most)
    }

    /// How far lengths about an obstacle may be off by the precision of the files and by rounding.
    pub(super) fn error(&self, at: Pose, obstacle: ObstacleId) -> f64 {
        let Some((body, pose)) = self.obstacles.get(obstacle) else { return 0.0 };
        if let (AnyBody::Convex(_), AnyBody::Convex(_)) = (&self.moving.body, body) {
            return 0.0;
        }
        let size = size(&self.moving.body, at).max(size(body, pose));
        self.moving.precision + self.precisions[obstacle.0 as usize] + ROUNDING * size
    }
}

impl Ways {
    /// A mesh file, as it is taken.
    fn mesh(&self, file: &Path, side: usize, notes: &mut Vec<String>) -> Result<Known, Failure> {
        let input = |message: String| Failure::new(Code::Input, message);
        if self.taken != Taken::Parts {
            match body::load(file, &self.convex[side]) {
                Ok(part) => {
                    notes.extend(part.notes);
                    let excess = part.excess.map(|excess| format!("{}: {excess}", file.display()));
                    notes.extend(excess);
                    return Ok(Known {
                        body: part.body.into(),
                        precision: part.precision,
                        dent: part.dent,
                    });
                }
                Err(error) if self.taken == Taken::AsTheyAre && is_part(&error) => {}
                Err(error) => return Err(input(refusal(&error))),
            }
        }
        let part = Body::load(&[file.to_owned()], &self.parts[side], || ()).map_err(input)?;
        notes.extend_from_slice(&part.notes);
        Ok(Known { body: part.solid().clone().into(), precision: part.precision(), dent: None })
    }

    /// Reads a file of obstacles. Bodies that occur again are kept once.
    fn list(
        &self,
        file: &Path,
        notes: &mut Vec<String>,
    ) -> Result<Vec<(Known, Pose, String)>, Failure> {
        let input = |what: String| Failure::new(Code::Input, format!("{}: {what}", file.display()));
        let text = read_text(file)?;
        let bodies = Batch {
            folder: file.parent().unwrap_or(Path::new("")).to_owned(),
            hull: self.convex[1].hull,
            body: self.body,
            cache: Cache::new(usize::MAX),
            watched: Watched::new(None),
        };
        let mut known = HashMap::new();
        let mut found = Vec::new();
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
        for (number, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
            let wrong = |what: String| input(format!("line {}: {what}", number + 1));
            let Line { body, pose, name } = serde_json::from_str(line)
                .map_err(|e| input(syntax_message(number as u64 + 1, &e)))?;
            let shape = bodies.body(&body).map_err(wrong)?;
            let place = pose.pose().map_err(|what| wrong(format!("pose: {what}")))?;
            notes.extend(pose.note(&format!("{}: line {}: pose", file.display(), number + 1)));
            let named = || body.file().map(|path| path.display().to_string());
            let one = known.entry(Arc::as_ptr(&shape)).or_insert_with(|| {
                notes.extend_from_slice(shape.notes());
                Known::of(&shape)
            });
            let name = name.or_else(named).unwrap_or_else(|| format!("line {}", number + 1));
            found.push((one.clone(), place, name));
        }
        if found.is_empty() {
            return Err(input("holds no obstacles".into()));
        }
        Ok(found)
    }
}

impl Known {
    fn of(shape: &Shape) -> Self {
        match shape {
            Shape::Convex(part) => {
                Self { body: part.body.clone().into(), precision: part.precision, dent: part.dent }
            }
            Shape::Solid(body) => {
                Self { body: body.solid().clone().into(), precision: body.precision(), dent: None }
            }
        }
    }
}

fn as_solid(placed: AnyPlaced<'_>) -> Result<Placed<'_, Solid>, QueryError> {
    Ok(match placed {
        ByKind::Convex(Placed { body, pose }) => Placed { body: body.as_surface()?, pose },
        ByKind::Solid(placed) => placed,
    })
}

/// The largest coordinate.
fn size(body: &AnyBody, pose: Pose) -> f64 {
    let Aabb { low, high } = match body {
        AnyBody::Convex(body) => {
            body.vertices().iter().fold(Aabb::EMPTY, |all, &v| all.join(&Aabb { low: v, high: v }))
        }
        AnyBody::Solid(body) => body.bounds(),
    };
    low.length().max(high.length()) + pose.translation().length()
}
