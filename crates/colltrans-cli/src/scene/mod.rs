//! Queries of one body and a scene (`--scene`): `distance` finds the nearest obstacle, `within` those closer than a length,
//! `clearance` the first obstacle in the way.

mod loaded;
mod text;

use std::path::PathBuf;
use std::slice;

use colltrans::record::{
    Dents, NearestRecord, PairQuestion, SceneClearanceRecord, SceneWithinRecord,
};
use colltrans::solid::{SolidOptions, StartOverlap};
use colltrans::{ObstacleId, Options, Pose, ProofFile, ProofFileError, SceneQuery};
use serde::Serialize;

use crate::args::{ClearanceArguments, PlaceArguments, PlacedArguments};
use crate::driver::{AnswerOutputs, OutputTargets, no_picture};
use crate::failure::{Code, Failure};
use crate::load;
use crate::record::Line;
use loaded::{ReadOptions, Scene};

/// A query with a scene.
struct SceneRequest<'a> {
    moving: &'a PathBuf,
    scene: &'a [PathBuf],
    pose: Pose,
    options: ReadOptions,
    json: bool,
    save_proof: Option<&'a PathBuf>,
}

/// Answers `colltrans distance` and `within` for a scene.
///
/// # Errors
/// The question is a depth, which is defined only for two bodies, or the query fails, or an output cannot be written.
pub(crate) fn answer_placed(
    arguments: &PlacedArguments,
    question: PairQuestion,
) -> Result<(), Failure> {
    if question == PairQuestion::Depth {
        let why = "--scene: a depth needs two bodies; `colltrans distance` reports an obstacle that is met";
        return Err(Failure::new(Code::Usage, why));
    }
    let request = SceneRequest {
        moving: arguments.moving_mesh()?,
        scene: &arguments.scene,
        pose: arguments.places.poses()?[0],
        options: ReadOptions {
            mode: arguments.body_mode()?,
            convex: arguments.body_options(),
            parts: arguments.part_options(),
            body: arguments.body,
        },
        json: arguments.json,
        save_proof: arguments.save_proof.as_ref(),
    };
    let (scene, targets) = request.load(&arguments.places)?;
    let query = SceneQuery::new(scene.moving.body.at(request.pose), &scene.obstacles)?;
    if let PairQuestion::Within(length) = question {
        let mut record = SceneWithinRecord::from_nearby(&query.within(length)?, &query);
        for nearby in record.closer.iter_mut().flatten().chain(&mut record.undecided) {
            nearby.fixed = scene.name(nearby.obstacle);
            nearby.dent = scene.dent(nearby.obstacle);
        }
        let prove = || ProofFile::of_within(&query, length).map(Some);
        let line = scene.line_of(record, None);
        return write_answer(targets, &line, |record| text::within_text(record, length), prove);
    }
    // The scene has a file, and each file at least one obstacle.
    let found = query.nearest()?.ok_or(Failure::new(
        Code::Input,
        "the scene has no obstacles; give at least one mesh with --scene",
    ))?;
    let accuracy = scene.accuracy(request.pose, found.obstacle);
    let mut record = NearestRecord::from_nearest(&found, &query);
    record.fixed = scene.name(found.obstacle);
    let prove = || ProofFile::of_nearest(&query);
    let line = scene.line_of(record, Some(found.obstacle));
    write_answer(targets, &line, |record| text::nearest_text(record, accuracy), prove)
}

/// Answers `colltrans clearance` for a scene.
pub(crate) fn answer_clearance(arguments: &ClearanceArguments) -> Result<(), Failure> {
    let pair = &arguments.pair;
    let Some(direction) = pair.directions.direction else {
        let why = "--scene accepts one --direction; --directions needs two bodies";
        return Err(Failure::new(Code::Usage, why));
    };
    let request = SceneRequest {
        moving: arguments.moving_mesh()?,
        scene: &arguments.scene,
        pose: pair.places.poses()?[0],
        options: ReadOptions {
            mode: arguments.body_mode()?,
            convex: pair.body_options(),
            parts: arguments.part_options(),
            body: pair.body,
        },
        json: pair.json,
        save_proof: pair.save_proof.as_ref(),
    };
    let (scene, targets) = request.load(&pair.places)?;
    let tolerance = match arguments.tolerance {
        None => scene.default_tolerance(request.pose, direction)?,
        given => given,
    };
    let query = scene_query(&scene, &request, arguments, tolerance)?;
    let found = query.clearance(direction)?;
    let mut record = SceneClearanceRecord::from_clearance(&found, &query, direction);
    let obstacle = record.obstacle;
    (record.tolerance, record.fixed) = (tolerance, obstacle.and_then(|id| scene.name(id)));
    let accuracy = obstacle.map(|obstacle| scene.accuracy(request.pose, obstacle));
    let is_default = arguments.tolerance.is_none();
    let graze = arguments.pair.graze_tolerance;
    let answer_text = |record: &_| {
        text::clearance_text(record, direction, accuracy, is_default) + &text::graze_line(graze)
    };
    let prove = || ProofFile::of_scene_clearance(&query, direction).map(Some);
    write_answer(targets, &scene.line_of(record, obstacle), answer_text, prove)
}

/// Returns the query of the moving body and the scene, with the options of the command line.
fn scene_query<'a>(
    scene: &'a Scene,
    request: &SceneRequest<'_>,
    arguments: &ClearanceArguments,
    tolerance: Option<f64>,
) -> Result<SceneQuery<'a>, Failure> {
    let pair = &arguments.pair;
    let ignores = arguments.ignore_start_overlaps;
    let start = if ignores { StartOverlap::Ignore } else { StartOverlap::Refuse };
    let options = Options::default()
        .with_solver(pair.solver)
        .with_graze_tolerance(pair.graze_tolerance)
        .with_min_gap(pair.min_gap);
    let of_solids = SolidOptions::default()
        .with_tolerance(tolerance)
        .with_start_overlap(start)
        .with_min_gap(pair.min_gap);
    let query = SceneQuery::new(scene.moving.body.at(request.pose), &scene.obstacles)?;
    Ok(query.with_options(options)?.with_solid_options(of_solids))
}

impl<'a> SceneRequest<'a> {
    /// Loads the bodies, and prints notes about repairs.
    fn load(&self, places: &PlaceArguments) -> Result<(Scene, OutputTargets<'a>), Failure> {
        let files = [slice::from_ref(self.moving), self.scene];
        let targets =
            OutputTargets::new(self.json, self.save_proof, None, &load::input_paths(files))?;
        let scene = Scene::load(self.moving, self.scene, &self.options)?;
        load::print_notes(places, &scene.notes);
        Ok((scene, targets))
    }
}

impl Scene {
    /// Returns the name of an obstacle; `None` for an unknown one.
    fn name(&self, obstacle: ObstacleId) -> Option<String> {
        self.names.get(obstacle.0 as usize).cloned()
    }

    /// Returns the line of a record, with the dents of the moving body and of an obstacle.
    fn line_of<R>(&self, record: R, obstacle: Option<ObstacleId>) -> Line<R> {
        let fixed = obstacle.and_then(|obstacle| self.dent(obstacle));
        Line { dents: Dents::from_depths([self.moving.dent, fixed]), ..Line::from_record(record) }
    }
}

/// Writes the answer, and the proof that `prove` computes.
fn write_answer<R: Serialize>(
    targets: OutputTargets<'_>,
    line: &Line<R>,
    answer_text: impl FnOnce(&R) -> String,
    prove: impl FnOnce() -> Result<Option<ProofFile>, ProofFileError>,
) -> Result<(), Failure> {
    targets.write_answer(AnswerOutputs {
        record: line,
        text: || answer_text(&line.record),
        proof: || {
            let proof = prove().map_err(|error| Failure::new(Code::Query, error.to_string()))?;
            Ok(proof.map(|proof| proof.to_json()))
        },
        picture: no_picture,
    })
}
