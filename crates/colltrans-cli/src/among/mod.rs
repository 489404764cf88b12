//! `--among`: one body among many. `distance` says which is nearest, `within` which are closer than a length,
//! `clearance` which one the body meets first.

mod scene;
mod words;

use std::path::{Path, PathBuf};

use colltrans::record::{Dents, PairQuestion, Record};
use colltrans::solid::{SolidOptions, StartOverlap};
use colltrans::{Among, CaseError, ObstacleId, Options, Pose, SceneProof};

use crate::args::{ClearanceArguments, PlacedArguments};
use crate::failure::{Code, Failure, note, print};
use crate::inputs::refuse_proof;
use crate::outputs;
use crate::record::Line;
use scene::{Scene, Ways};

/// What both kinds of questions have in common.
struct Request<'a> {
    moving: &'a Path,
    scene: &'a [PathBuf],
    pose: Pose,
    ways: Ways,
    json: bool,
    save_proof: Option<&'a Path>,
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
        save_proof: arguments.save_proof.as_deref(),
    };
    let scene = asked.load(&arguments.places.notes())?;
    let among = Among::new(scene.moving.body.at(asked.pose), &scene.obstacles)?;
    match question {
        PairQuestion::Within(length) => asked.within(&scene, &among, length),
        _ => asked.nearest(&scene, &among),
    }
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
        save_proof: pair.save_proof.as_deref(),
    };
    let scene = asked.load(&pair.places.notes())?;
    let tolerance = match arguments.tolerance {
        None => scene.tolerance(asked.pose, direction)?,
        given => given,
    };
    let among = choose(&scene, &asked, arguments, tolerance)?;
    let found = among.clearance(direction)?;
    let mut record = Record::of_clearance_among(&found, &among, direction);
    record.tolerance = tolerance;
    let error = record.obstacle.map_or(0.0, |obstacle| scene.error(asked.pose, obstacle));
    let is_default = arguments.tolerance.is_none();
    let graze = arguments.pair.graze_tolerance;
    asked.say(&scene, record, |told| {
        words::clearance(told, direction, error, is_default) + &words::grazed(graze)
    })?;
    asked.save(|| SceneProof::of_clearance(&among, direction).map(Some))
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

impl Request<'_> {
    fn nearest(&self, scene: &Scene, among: &Among<'_>) -> Result<(), Failure> {
        // There is a file, and so an obstacle.
        let found = among.nearest()?.ok_or(Failure::new(Code::Input, "no obstacles"))?;
        let error = scene.error(self.pose, found.obstacle);
        self.say(scene, Record::of_nearest(&found, among), |told| words::nearest(told, error))?;
        self.save(|| SceneProof::of_nearest(among))
    }

    fn within(&self, scene: &Scene, among: &Among<'_>, length: f64) -> Result<(), Failure> {
        let record = Record::of_nearby(&among.within(length)?, among);
        self.say(scene, record, |told| words::within(told, length))?;
        self.save(|| SceneProof::of_within(among, length).map(Some))
    }

    /// The bodies; says what was mended.
    fn load(&self, placed: &[Option<String>; 2]) -> Result<Scene, Failure> {
        let inputs: Vec<&Path> =
            [self.moving].into_iter().chain(self.scene.iter().map(AsRef::as_ref)).collect();
        refuse_proof(self.save_proof, None, &inputs)?;
        let scene = Scene::load(self.moving, self.scene, &self.ways)?;
        placed.iter().flatten().chain(&scene.notes).for_each(|text| note(text));
        Ok(scene)
    }

    /// The answer, with the names and the dents of obstacles.
    fn say(
        &self,
        scene: &Scene,
        mut record: Record,
        in_words: impl FnOnce(&Line) -> String,
    ) -> Result<(), Failure> {
        let name = |id: ObstacleId| scene.names.get(id.0 as usize).cloned();
        record.fixed = record.obstacle.and_then(name);
        let fixed = record.obstacle.and_then(|obstacle| scene.dent(obstacle));
        record.dents = Dents::of([scene.moving.dent, fixed]);
        for one in record.closer.iter_mut().flatten().chain(&mut record.undecided) {
            one.fixed = name(one.obstacle);
            one.dent = scene.dent(one.obstacle);
        }
        let told = Line::from(record);
        print(&if self.json { told.json() } else { in_words(&told) })
    }

    fn save(
        &self,
        prove: impl FnOnce() -> Result<Option<SceneProof>, CaseError>,
    ) -> Result<(), Failure> {
        let Some(path) = self.save_proof else { return Ok(()) };
        let proof = prove().map_err(|error| Failure::new(Code::Query, error.to_string()))?;
        proof.map_or(Ok(()), |proof| outputs::write_proof(path, &proof.to_json()))
    }
}
