//! The bodies of a scene: mesh files, and files of obstacles with poses.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use colltrans::glam::DVec3;
use colltrans::record::Fields;
use colltrans::solid::{AsSolid, SolidCast, StartOverlap};
use colltrans::{
    Aabb, AnyBody, AnyPlaced, ByKind, ObstacleId, Obstacles, Placed, Pose, QueryError, Solid,
};
use colltrans_mesh::body::{BodyOptions, cast_between};
use serde::Deserialize;

use crate::args::{BodyArguments, BodyMode};
use crate::batch::{Batch, BodySource, Cache, PoseSource, Shape, syntax_error_message};
use crate::body::{self, can_be_part, convex_bounds, load_error_message};
use crate::distance::Accuracy;
use crate::failure::{Code, Failure};
use crate::inputs::{ReplacedFile, is_obstacle_list, read_text};
use crate::numbers::smaller_extent;
use crate::solid::{Body, solid_bounds};

/// Rounding error of a length, relative to the size of the scene.
const RELATIVE_ROUNDING: f64 = 1e-14;

/// A body of a file, and its precision.
#[derive(Clone)]
pub(super) struct LoadedBody {
    pub(super) body: AnyBody,
    /// Rounding error of the coordinates in the file.
    precision: f64,
    /// As [`Part::dent`](crate::body::Part::dent).
    pub(super) dent: Option<f64>,
}

/// How files are read.
#[derive(Clone, Copy)]
pub(super) struct ReadOptions {
    pub(super) mode: BodyMode,
    /// For the moving body, and for the bodies of the scene.
    pub(super) convex: [BodyOptions; 2],
    pub(super) parts: [BodyOptions; 2],
    pub(super) body: BodyArguments,
}

/// A moving body and all obstacles.
pub(super) struct Scene {
    pub(super) moving: LoadedBody,
    pub(super) obstacles: Obstacles,
    /// Names of the obstacles, by number.
    pub(super) names: Vec<String>,
    precisions: Vec<f64>,
    dents: Vec<Option<f64>>,
    /// Notes about repairs, and about hulls that exceed their meshes.
    pub(super) notes: Vec<String>,
}

/// A line of a file of obstacles.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with an obstacle")]
struct ObstacleSource {
    body: BodySource,
    #[serde(default)]
    pose: PoseSource,
    name: Option<String>,
}

impl Scene {
    /// Reads the moving mesh, and the mesh files and files of obstacles of the scene.
    ///
    /// # Errors
    /// A file cannot be read, or its mesh does not become a body of the required kind.
    pub(super) fn load(
        moving: &Path,
        files: &[PathBuf],
        options: &ReadOptions,
    ) -> Result<Self, Failure> {
        let mut notes = Vec::new();
        let moving = options.read_mesh(moving, 0, &mut notes)?;
        let (mut placed, mut names) = (Vec::new(), Vec::new());
        let (mut precisions, mut dents) = (Vec::new(), Vec::new());
        for file in files {
            let found = if is_obstacle_list(file) {
                options.read_list(file, &mut notes)?
            } else {
                let known = options.read_mesh(file, 1, &mut notes)?;
                vec![(known, Pose::IDENTITY, file.display().to_string())]
            };
            for (LoadedBody { body, precision, dent }, pose, name) in found {
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

    /// Returns the default tolerance: the largest one that follows from the precision and the pose of a pair with a solid.
    /// `None` if all bodies are convex.
    pub(super) fn default_tolerance(
        &self,
        pose: Pose,
        direction: DVec3,
    ) -> Result<Option<f64>, QueryError> {
        let moving = self.moving.body.at(pose);
        let mut largest: Option<f64> = None;
        for (ObstacleId(id), body, obstacle_pose) in self.obstacles.iter() {
            if let (ByKind::Convex(_), AnyBody::Convex(_)) = (moving, body) {
                continue;
            }
            let placed = [as_solid(moving)?, as_solid(body.at(obstacle_pose))?];
            let precisions = [self.moving.precision, self.precisions[id as usize]];
            let refuse = StartOverlap::Refuse;
            let cast = cast_between(placed[0], placed[1], direction, precisions, None, refuse)?;
            largest = Some(largest.unwrap_or_default().max(cast.tolerance()));
        }
        Ok(largest)
    }

    /// Returns the error of lengths about an obstacle: the precision of the files, and rounding. 0 for convex bodies.
    pub(super) fn accuracy(&self, pose: Pose, obstacle: ObstacleId) -> Accuracy {
        let Some((body, obstacle_pose)) = self.obstacles.get(obstacle) else {
            return Accuracy { error: 0.0, extent: 0.0 };
        };
        let extent = smaller_extent([&self.moving.body, body].map(bounds_of));
        if let (AnyBody::Convex(_), AnyBody::Convex(_)) = (&self.moving.body, body) {
            return Accuracy { error: 0.0, extent };
        }
        let size = max_coordinate(&self.moving.body, pose).max(max_coordinate(body, obstacle_pose));
        let precision = self.moving.precision + self.precisions[obstacle.0 as usize];
        Accuracy { error: precision + RELATIVE_ROUNDING * size, extent }
    }
}

impl ReadOptions {
    /// Reads a mesh file as a convex body or as a part.
    fn read_mesh(
        &self,
        file: &Path,
        side: usize,
        notes: &mut Vec<String>,
    ) -> Result<LoadedBody, Failure> {
        let input = |message: String| Failure::new(Code::Input, message);
        if self.mode != BodyMode::Parts {
            match body::load(file, &self.convex[side]) {
                Ok(part) => {
                    notes.extend(part.notes);
                    let excess = part.excess.map(|excess| format!("{}: {excess}", file.display()));
                    notes.extend(excess);
                    return Ok(LoadedBody {
                        body: part.body.into(),
                        precision: part.precision,
                        dent: part.dent,
                    });
                }
                Err(error) if self.mode == BodyMode::Automatic && can_be_part(&error) => {}
                Err(error) => return Err(input(load_error_message(&error))),
            }
        }
        let part = Body::load(&[file.to_owned()], &self.parts[side], || ()).map_err(input)?;
        notes.extend_from_slice(&part.notes);
        Ok(LoadedBody {
            body: part.solid().clone().into(),
            precision: part.precision(),
            dent: None,
        })
    }

    /// Reads a file of obstacles. A body that several lines name is stored once.
    fn read_list(
        &self,
        file: &Path,
        notes: &mut Vec<String>,
    ) -> Result<Vec<(LoadedBody, Pose, String)>, Failure> {
        let input = |what: String| Failure::new(Code::Input, format!("{}: {what}", file.display()));
        let text = read_text(file)?;
        let bodies = Batch {
            folder: file.parent().unwrap_or(Path::new("")).to_owned(),
            hull: self.convex[1].hull,
            body: self.body,
            written: Fields::ALL,
            computed: Fields::ALL,
            cache: Cache::new(usize::MAX),
            replaced_file: ReplacedFile::new(None),
        };
        let mut known = HashMap::new();
        let mut found = Vec::new();
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
        for (number, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
            let line_error = |what: String| input(format!("line {}: {what}", number + 1));
            let ObstacleSource { body, pose, name } = serde_json::from_str(line)
                .map_err(|e| input(syntax_error_message(number as u64 + 1, &e)))?;
            let shape = bodies.build_body(&body).map_err(line_error)?;
            let place = pose.pose().map_err(|what| line_error(format!("pose: {what}")))?;
            notes.extend(pose.note(&format!("{}: line {}: pose", file.display(), number + 1)));
            let file_name = || body.file().map(|path| path.display().to_string());
            let loaded = known.entry(Arc::as_ptr(&shape)).or_insert_with(|| {
                notes.extend_from_slice(shape.notes());
                LoadedBody::from_shape(&shape)
            });
            let name = name.or_else(file_name).unwrap_or_else(|| format!("line {}", number + 1));
            found.push((loaded.clone(), place, name));
        }
        if found.is_empty() {
            return Err(input("contains no obstacles; expected one JSON object per line".into()));
        }
        Ok(found)
    }
}

impl LoadedBody {
    /// Returns the body of a batch with its precision.
    fn from_shape(shape: &Shape) -> Self {
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

/// Returns a placed body as a solid. A convex body becomes its surface.
fn as_solid(placed: AnyPlaced<'_>) -> Result<Placed<'_, Solid>, QueryError> {
    Ok(match placed {
        ByKind::Convex(Placed { body, pose }) => Placed { body: body.as_surface()?, pose },
        ByKind::Solid(placed) => placed,
    })
}

/// Returns the bounding box of a body.
fn bounds_of(body: &AnyBody) -> Aabb {
    match body {
        AnyBody::Convex(body) => convex_bounds(body),
        AnyBody::Solid(body) => solid_bounds(body),
    }
}

/// Returns an upper bound of the coordinates of a placed body.
fn max_coordinate(body: &AnyBody, pose: Pose) -> f64 {
    let Aabb { low, high } = bounds_of(body);
    low.length().max(high.length()) + pose.translation().length()
}
