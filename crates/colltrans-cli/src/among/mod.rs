//! `--among`: one body among many. `distance` says which is nearest, `within` which are closer than a length,
//! `clearance` which one the body meets first.

mod scene;
mod text;

use std::path::PathBuf;
use std::slice;

use colltrans::record::{
    Dents, NearestRecord, PairQuestion, SceneClearanceRecord, SceneWithinRecord,
};
use colltrans::solid::{SolidOptions, StartOverlap};
use colltrans::{Among, ObstacleId, Options, Pose, ProofFile, ProofFileError};
use serde::Serialize;

use crate::args::{ClearanceArguments, PlaceArguments, PlacedArguments};
use crate::driver::{AnswerOutputs, OutputTargets, no_picture};
use crate::failure::{Code, Failure};
use crate::load;
use crate::record::Line;
use scene::{Scene, Ways};

/// What both kinds of questions have in common.
struct Request<'a> {
    moving: &'a PathBuf,
    scene: &'a [PathBuf],
    pose: Pose,
    ways: Ways,
    json: bool,
    save_proof: Option<&'a PathBuf>,
}

/// `colltrans distance` and `within`.
pub(crate) fn placed(arguments: &PlacedArguments, question: PairQuestion) -> Result<(), Failure> {
    if question == PairQuestion::Depth {
        let why = "--among: a depth is of two bodies; `colltrans distance` says which are met";
        return Err(Failure::new(Code::Usage, why));
    }
    let asked = Request {
        moving: arguments.one()?,
        scene: &arguments.among,
        pose: arguments.places.poses()?[0],
        ways: Ways {
            taken: arguments.taken()?,
            convex: arguments.body_options(),
            parts: arguments.part_options(),
            body: arguments.body,
        },
        json: arguments.json,
        save_proof: arguments.save_proof.as_ref(),
    };
    let (scene, targets) = asked.load(&arguments.places)?;
    let among = Among::new(scene.moving.body.at(asked.pose), &scene.obstacles)?;
    if let PairQuestion::Within(length) = question {
        let mut record = SceneWithinRecord::of(&among.within(length)?, &among);
        for one in record.closer.iter_mut().flatten().chain(&mut record.undecided) {
            one.fixed = scene.name(one.obstacle);
            one.dent = scene.dent(one.obstacle);
        }
        let prove = || ProofFile::of_within(&among, length).map(Some);
        let told = scene.told(record, None);
        return write_answer(targets, &told, |record| text::within(record, length), prove);
    }
    // There is a file, and so an obstacle.
    let found = among.nearest()?.ok_or(Failure::new(Code::Input, "no obstacles"))?;
    let error = scene.error(asked.pose, found.obstacle);
    let mut record = NearestRecord::of(&found, &among);
    record.fixed = scene.name(found.obstacle);
    let prove = || ProofFile::of_nearest(&among);
    let told = scene.told(record, Some(found.obstacle));
    write_answer(targets, &told, |record| text::nearest(record, error), prove)
}

/// `colltrans clearance`.
pub(crate) fn clearance(arguments: &ClearanceArguments) -> Result<(), Failure> {
    let pair = &arguments.pair;
    let Some(direction) = pair.directions.direction else {
        let why = "--among takes one --direction; --directions is for two bodies";
        return Err(Failure::new(Code::Usage, why));
    };
    let asked = Request {
        moving: arguments.one()?,
        scene: &arguments.among,
        pose: pair.places.poses()?[0],
        ways: Ways {
            taken: arguments.taken()?,
            convex: pair.body_options(),
            parts: arguments.part_options(),
            body: pair.body,
        },
        json: pair.json,
        save_proof: pair.save_proof.as_ref(),
    };
    let (scene, targets) = asked.load(&pair.places)?;
    let tolerance = match arguments.tolerance {
        None => scene.tolerance(asked.pose, direction)?,
        given => given,
    };
    let among = choose(&scene, &asked, arguments, tolerance)?;
    let found = among.clearance(direction)?;
    let mut record = SceneClearanceRecord::of(&found, &among, direction);
    let obstacle = record.obstacle;
    (record.tolerance, record.fixed) = (tolerance, obstacle.and_then(|id| scene.name(id)));
    let error = obstacle.map_or(0.0, |obstacle| scene.error(asked.pose, obstacle));
    let is_default = arguments.tolerance.is_none();
    let graze = arguments.pair.graze_tolerance;
    let in_words =
        |record: &_| text::clearance(record, direction, error, is_default) + &text::grazed(graze);
    let prove = || ProofFile::of_scene_clearance(&among, direction).map(Some);
    write_answer(targets, &scene.told(record, obstacle), in_words, prove)
}

/// The body among the others, asked as the arguments say.
fn choose<'a>(
    scene: &'a Scene,
    asked: &Request<'_>,
    arguments: &ClearanceArguments,
    tolerance: Option<f64>,
) -> Result<Among<'a>, Failure> {
    let pair = &arguments.pair;
    let ignores = arguments.ignore_start_overlaps;
    let start = if ignores { StartOverlap::Ignore } else { StartOverlap::Refuse };
    let options = Options::default()
        .with_solver(pair.solver)
        .with_graze_tolerance(pair.graze_tolerance)
        .with_keep(pair.keep);
    let of_solids = SolidOptions::default()
        .with_tolerance(tolerance)
        .with_start_overlap(start)
        .with_keep(pair.keep);
    let among = Among::new(scene.moving.body.at(asked.pose), &scene.obstacles)?;
    Ok(among.with_options(options)?.with_solid_options(of_solids))
}

impl<'a> Request<'a> {
    /// Loads the bodies, and reports what was mended.
    fn load(&self, places: &PlaceArguments) -> Result<(Scene, OutputTargets<'a>), Failure> {
        let files = [slice::from_ref(self.moving), self.scene];
        let targets =
            OutputTargets::new(self.json, self.save_proof, None, &load::input_files(files))?;
        let scene = Scene::load(self.moving, self.scene, &self.ways)?;
        load::report_notes(places, &scene.notes);
        Ok((scene, targets))
    }
}

impl Scene {
    fn name(&self, obstacle: ObstacleId) -> Option<String> {
        self.names.get(obstacle.0 as usize).cloned()
    }

    /// Returns the line of a record, with the dents of the moving body and of an obstacle.
    fn told<R>(&self, record: R, obstacle: Option<ObstacleId>) -> Line<R> {
        let fixed = obstacle.and_then(|obstacle| self.dent(obstacle));
        Line { dents: Dents::of([self.moving.dent, fixed]), ..Line::of(record) }
    }
}

/// Writes the answer, and the proof that `prove` makes.
fn write_answer<R: Serialize>(
    targets: OutputTargets<'_>,
    told: &Line<R>,
    in_words: impl FnOnce(&R) -> String,
    prove: impl FnOnce() -> Result<Option<ProofFile>, ProofFileError>,
) -> Result<(), Failure> {
    targets.write_answer(AnswerOutputs {
        record: told,
        words: || in_words(&told.record),
        proof: || {
            let proof = prove().map_err(|error| Failure::new(Code::Query, error.to_string()))?;
            Ok(proof.map(|proof| proof.to_json()))
        },
        picture: no_picture,
    })
}
