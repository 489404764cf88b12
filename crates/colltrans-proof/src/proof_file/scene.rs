//! A proof about one body among many, with all of them, as one file.
//!
//! Obstacles have the numbers of their places in the file. A body that is at several places is written once. As in
//! the file of two bodies, solids are made of what is written before anything is proven of them.

use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::file::{BodyFile, PieceRecord, convex_body, is_same, said, union};
use colltrans_convex::ConvexPolyhedron;
use colltrans_convex::answer::CertificateError;
use colltrans_convex::body::{ObstacleId, Pose};
use colltrans_convex::cast::CaseError;
use colltrans_convex::cast::replay::BodyRecord;
use colltrans_convex::setting::error::QueryError;
use colltrans_convex::solve::options::Options;
use colltrans_scene::{Among, ClearanceProof, NearbyProof, NearestProof, Obstacles};
use colltrans_solid::Solid;
use colltrans_solid::cast::{SolidOptions, StartOverlap};
use colltrans_solid::kinds::{AnyBody, AnyPlaced, ByKind};

/// What a file of this version calls itself.
const FORMAT: &str = "colltrans scene proof 1";
/// As many obstacles are named in words.
const NAMED: usize = 12;

/// A proof about one body among many that owns all of them: whoever has the file can check what it says,
/// without a search.
///
/// Its obstacles have the numbers from 0 on in the order in which they came; those that are ignored are not in
/// it. Of the choices, the gap, both tolerances and what an overlap means count.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::{Among, ConvexPolyhedron, Obstacles, Pose, SceneProof};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let mut room = Obstacles::new();
/// room.insert(cube.clone(), Pose::from_translation(DVec3::X * 9.0)?);
/// room.insert(cube.clone(), Pose::from_translation(DVec3::Y * 4.0)?);
/// let asked = Among::new(cube.at(Pose::IDENTITY), &room)?;
///
/// let saved = SceneProof::of_nearest(&asked)?.expect("there are some").to_json();
/// let proof = SceneProof::from_json(&saved)?;
/// proof.check()?;
/// assert!(proof.to_string().starts_with("of 2 obstacles, obstacle 1 is at most 3.0"));
/// assert!(SceneProof::from_json(&saved.replace("[0.0,4.0,0.0]", "[0.0,4.5,0.0]"))?.check().is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct SceneProof {
    scene: Scene,
    statement: SceneStatement,
}

/// What a [`SceneProof`] says of its bodies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SceneStatement {
    /// Which obstacle is nearest.
    Nearest(NearestProof),
    /// Which ones are closer than a length.
    Within(NearbyProof),
    /// Which one stops the moving body, and where.
    Clearance(ClearanceProof),
}

/// All bodies, where they are, and how they are asked.
#[derive(Debug, Clone)]
struct Scene {
    bodies: Vec<Written>,
    moving: Place,
    obstacles: Obstacles,
    /// Those of the obstacles, in the order of their numbers.
    places: Vec<Place>,
    choices: Choices,
}

/// A body, made of what is written of it.
#[derive(Debug, Clone)]
pub(crate) struct Written {
    pub(crate) body: AnyBody,
    /// Of a solid.
    pieces: Vec<PieceRecord>,
}

#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Place {
    body: usize,
    pose: Pose,
}

#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Choices {
    #[serde(skip_serializing_if = "colltrans_kernel::written::is_zero")]
    keep: f64,
    #[serde(skip_serializing_if = "colltrans_kernel::written::is_zero")]
    graze_tolerance: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    start_overlap: StartOverlap,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: String,
    bodies: Vec<BodyFile>,
    moving: Place,
    obstacles: Vec<Place>,
    choices: Choices,
    statement: SceneStatement,
}

/// Of questions, asked once more of the bodies as they are read back.
impl SceneProof {
    /// That no obstacle is nearer than the nearest one, by [`Among::certified_nearest`]; `None` if there are none.
    ///
    /// # Errors
    /// As [`Among::nearest`], and a solid that its own facets do not make once more.
    pub fn of_nearest(among: &Among<'_>) -> Result<Option<Self>, CaseError> {
        let scene = Scene::of(among)?;
        let proof = scene.asked()?.certified_nearest()?;
        Ok(proof.map(|(_, proof)| Self { scene, statement: SceneStatement::Nearest(proof) }))
    }

    /// Which obstacles are closer than a length, by [`Among::certified_within`].
    ///
    /// # Errors
    /// As [`Among::within`], and a solid that its own facets do not make once more.
    pub fn of_within(among: &Among<'_>, length: f64) -> Result<Self, CaseError> {
        let scene = Scene::of(among)?;
        let (_, proof) = scene.asked()?.certified_within(length)?;
        Ok(Self { scene, statement: SceneStatement::Within(proof) })
    }

    /// What stops the moving body, and that nothing does before, by [`Among::certified_clearance`].
    ///
    /// # Errors
    /// As [`Among::clearance`], and a solid that its own facets do not make once more.
    pub fn of_clearance(among: &Among<'_>, direction: glam::DVec3) -> Result<Self, CaseError> {
        let scene = Scene::of(among)?;
        let (_, proof) = scene.asked()?.certified_clearance(direction)?;
        Ok(Self { scene, statement: SceneStatement::Clearance(proof) })
    }

    /// What it says; true if [`Self::check`] does not object.
    pub const fn statement(&self) -> &SceneStatement {
        &self.statement
    }

    /// How many obstacles there are.
    pub fn obstacles(&self) -> usize {
        self.scene.places.len()
    }

    /// Checks it as [`Among::verify`] does, without a search.
    ///
    /// # Errors
    /// The first thing that is not proven.
    pub fn check(&self) -> Result<(), CertificateError> {
        let asked = self.scene.asked()?;
        match &self.statement {
            SceneStatement::Nearest(proof) => asked.verify(proof),
            SceneStatement::Within(proof) => asked.verify(proof),
            SceneStatement::Clearance(proof) => asked.verify(proof),
        }
        .map(|_| ())
    }

    /// As a file: numbers that read back as the same bits.
    ///
    /// # Panics
    /// Never: all numbers can be written.
    pub fn to_json(&self) -> String {
        let Scene { bodies, moving, places, choices, .. } = &self.scene;
        let file = File {
            format: FORMAT.into(),
            bodies: bodies.iter().map(Written::file).collect(),
            moving: *moving,
            obstacles: places.clone(),
            choices: *choices,
            statement: self.statement.clone(),
        };
        serde_json::to_string(&file).expect("numbers and names")
    }

    /// From what [`Self::to_json`] has written. It is read, not believed: see [`Self::check`].
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_json(text: &str) -> Result<Self, CaseError> {
        let File { bodies, moving, obstacles: places, choices, statement, .. } =
            serde_json::from_str(said(text, FORMAT)?).map_err(CaseError::Proof)?;
        let bodies = bodies.into_iter().map(Written::of).collect::<Result<_, _>>()?;
        Ok(Self { scene: Scene::new(bodies, moving, places, choices)?, statement })
    }
}

impl Scene {
    /// Of what is asked about.
    fn of(among: &Among<'_>) -> Result<Self, CaseError> {
        let mut bodies = vec![Written::again(&kept(among.moving()), "moving")?];
        let mut known: HashMap<*const u8, usize> = HashMap::new();
        let mut places = Vec::new();
        for (body, pose) in among.asked_in_order() {
            let address = match body {
                ByKind::Convex(body) => Arc::as_ptr(body).cast(),
                ByKind::Solid(body) => Arc::as_ptr(body).cast(),
            };
            let at = *known.entry(address).or_insert(bodies.len());
            if at == bodies.len() {
                bodies.push(Written::again(body, "an obstacle's")?);
            }
            places.push(Place { body: at, pose });
        }
        let (options, solid_options) = (among.options(), among.solid_options());
        let choices = Choices {
            keep: options.keep.max(solid_options.keep),
            graze_tolerance: options.graze_tolerance,
            tolerance: solid_options.tolerance,
            start_overlap: solid_options.start_overlap,
        };
        let moving = Place { body: 0, pose: among.moving_pose() };
        Self::new(bodies, moving, places, choices)
    }

    fn new(
        bodies: Vec<Written>,
        moving: Place,
        places: Vec<Place>,
        choices: Choices,
    ) -> Result<Self, CaseError> {
        let placed = |place: &Place| {
            let Place { body, pose } = *place;
            let known = bodies.len();
            let written = bodies.get(body).ok_or(CaseError::NoBody { body, known })?;
            Ok::<_, CaseError>((written.body.clone(), pose))
        };
        placed(&moving)?;
        let mut obstacles = Obstacles::new();
        obstacles.insert_all(places.iter().map(placed).collect::<Result<Vec<_>, _>>()?);
        Ok(Self { bodies, moving, obstacles, places, choices })
    }

    fn asked(&self) -> Result<Among<'_>, QueryError> {
        let Choices { keep, graze_tolerance, tolerance, start_overlap } = self.choices;
        if let Some(tolerance) = tolerance.filter(|by| !(0.0..f64::INFINITY).contains(by)) {
            return Err(QueryError::Tolerance { tolerance });
        }
        let options = Options::default().with_keep(keep).with_graze_tolerance(graze_tolerance);
        let of_solids = SolidOptions::default().with_keep(keep).with_tolerance(tolerance);
        let Place { body, pose } = self.moving;
        Ok(Among::new(self.bodies[body].body.at(pose), &self.obstacles)?
            .with_options(options)?
            .with_solid_options(of_solids.with_start_overlap(start_overlap)))
    }
}

impl Written {
    /// A body as it is read back from a file.
    pub(crate) fn again(body: &AnyBody, which: &'static str) -> Result<Self, CaseError> {
        let ByKind::Solid(solid) = body else {
            return Ok(Self { body: body.clone(), pieces: Vec::new() });
        };
        let is_it =
            |made: &Self| matches!(&made.body, ByKind::Solid(again) if is_same(again, solid));
        // Of a union whatever hangs together is a piece of its own.
        let whole = Self::solid(vec![PieceRecord::of(solid)]).ok().filter(is_it);
        let parts = || Self::solid(PieceRecord::parts(solid)).ok().filter(is_it);
        whole.or_else(parts).ok_or(CaseError::Changed { which })
    }

    fn solid(pieces: Vec<PieceRecord>) -> Result<Self, CaseError> {
        Ok(Self { body: AnyBody::from(union(&pieces, "one")?), pieces })
    }

    pub(crate) fn of(file: BodyFile) -> Result<Self, CaseError> {
        match file {
            BodyFile::Convex(record) => {
                let body = AnyBody::from(convex_body(&record, "one")?);
                Ok(Self { body, pieces: Vec::new() })
            }
            BodyFile::Pieces(pieces) => Self::solid(pieces),
        }
    }

    pub(crate) fn file(&self) -> BodyFile {
        match &self.body {
            ByKind::Convex(body) => BodyFile::Convex(BodyRecord::of(body)),
            ByKind::Solid(_) => BodyFile::Pieces(self.pieces.clone()),
        }
    }
}

/// The body, to be kept.
pub(crate) fn kept(placed: AnyPlaced<'_>) -> AnyBody {
    match placed {
        ByKind::Convex(placed) => AnyBody::from(ConvexPolyhedron::clone(placed.body)),
        ByKind::Solid(placed) => AnyBody::from(Solid::clone(placed.body)),
    }
}

impl fmt::Display for SceneProof {
    /// Its statement in words, in one line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Choices { keep, tolerance, graze_tolerance, .. } = self.scene.choices;
        write!(f, "of {} obstacles, ", self.obstacles())?;
        if let SceneStatement::Clearance(_) = self.statement {
            if keep > 0.0 {
                write!(f, "counted as met where they are {keep:?} away or nearer, ")?;
            }
            if graze_tolerance > 0.0 {
                write!(
                    f,
                    "passed where they overlap sideways by no more than {graze_tolerance:?}, "
                )?;
            }
            if let Some(tolerance) = tolerance.filter(|by| *by > 0.0) {
                write!(f, "solids shrunk by {:?} each, ", tolerance / 2.0)?;
            }
        }
        self.statement.fmt(f)
    }
}

impl fmt::Display for SceneStatement {
    /// In words; translations in multiples of the direction.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nearest(NearestProof { lower, obstacle, near, .. }) => {
                let upper = near.distance();
                write!(
                    f,
                    "obstacle {obstacle} is at most {upper:?} away, none is nearer than {lower:?}"
                )
            }
            Self::Within(NearbyProof { length, closer, undecided, .. }) => {
                let closer: Vec<ObstacleId> = closer.iter().map(|(id, _)| *id).collect();
                let (which, is) = listed(&closer);
                write!(f, "{which} {is} at most {length:?} away")?;
                if !undecided.is_empty() {
                    write!(f, ", of {} nothing is said", listed(undecided).0)?;
                }
                f.write_str(", all others are farther")
            }
            Self::Clearance(ClearanceProof { stop: None, lower, .. }) if lower.is_infinite() => {
                f.write_str("none ever stops the moving body")
            }
            Self::Clearance(of) => {
                let ClearanceProof { lower, stop, .. } = of;
                let Some(stop) = stop else {
                    return write!(
                        f,
                        "none stops the moving body before a translation of {lower:?}"
                    );
                };
                match of.upper() {
                    upper if upper <= 0.0 => {
                        write!(f, "obstacle {stop} overlaps the moving body, or stops it at once")
                    }
                    upper => write!(
                        f,
                        "none stops the moving body before a translation of {lower:?}, obstacle {stop} does by {upper:?}"
                    ),
                }
            }
        }
    }
}

/// Returns how many, and which, and the verb that they take.
fn listed(of: &[ObstacleId]) -> (String, &'static str) {
    let named: Vec<String> = of.iter().take(NAMED).map(ToString::to_string).collect();
    let more = if of.len() > NAMED { ", ..." } else { "" };
    let (count, is) = (of.len(), if of.len() == 1 { "is" } else { "are" });
    if of.is_empty() {
        ("none".into(), "is")
    } else {
        (format!("{count} ({}{more})", named.join(", ")), is)
    }
}
