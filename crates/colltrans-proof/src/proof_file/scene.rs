//! Proofs about one body among many.
//!
//! Obstacles have the numbers of their places in the file. A body that is at several places is written once.

use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec3;

use super::body::StoredBody;
use super::error::{ProofError, ProofFileError};
use super::file::{Choices, Place, Placement, Query};
use super::proven::{Proven, Verify};
use super::{ProofFile, Statement};
use colltrans_convex::setting::error::QueryError;
use colltrans_convex::solve::options::Options;
use colltrans_scene::{Among, AmongProof, Obstacles};
use colltrans_solid::cast::SolidOptions;
use colltrans_solid::kinds::{AnyBody, AnyPlaced};

/// One body among many, and how it is asked.
#[derive(Debug)]
pub(super) struct Scene<'a> {
    moving: AnyPlaced<'a>,
    obstacles: Obstacles,
    choices: Choices,
}

impl<'a> Scene<'a> {
    /// The moving body is in the first place.
    pub(super) fn new(
        bodies: &'a [StoredBody],
        places: &[Place],
        choices: Choices,
    ) -> Result<Self, ProofFileError> {
        let [moving, fixed @ ..] = places else { return Err(ProofFileError::Statement) };
        let stored = |place: &Place| StoredBody::of(bodies, place.body);
        let placed = |place: &Place| Ok((stored(place)?.body.clone(), place.pose));
        let mut obstacles = Obstacles::new();
        obstacles.insert_all(fixed.iter().map(placed).collect::<Result<Vec<_>, ProofFileError>>()?);
        let scene = Self { moving: stored(moving)?.body.at(moving.pose), obstacles, choices };
        scene.asked()?;
        Ok(scene)
    }

    fn asked(&self) -> Result<Among<'_>, QueryError> {
        let Choices { keep, graze_tolerance, tolerance, start_overlap } = self.choices;
        if let Some(tolerance) = tolerance.filter(|by| !(0.0..f64::INFINITY).contains(by)) {
            return Err(QueryError::Tolerance { tolerance });
        }
        let options = Options::default().with_keep(keep).with_graze_tolerance(graze_tolerance);
        let of_solids = SolidOptions::default().with_keep(keep).with_tolerance(tolerance);
        Ok(Among::new(self.moving, &self.obstacles)?
            .with_options(options)?
            .with_solid_options(of_solids.with_start_overlap(start_overlap)))
    }
}

impl<'s, P> Verify<'_, Scene<'s>> for P
where
    for<'p> AmongProof<'p>: From<&'p P>,
{
    fn verify(&self, scene: &Scene<'s>) -> Result<Proven<'static>, ProofError> {
        scene.asked()?.verify(self)?;
        Ok(Proven::Statement)
    }
}

/// Of questions about one body among many, asked once more of the bodies as they are read back.
///
/// Obstacles have the numbers from 0 on in the order in which they came; those that are ignored are not in it. Of the
/// choices, the gap, both tolerances and what an overlap means count.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::{Among, ConvexPolyhedron, Obstacles, Pose, ProofFile};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let mut room = Obstacles::new();
/// room.insert(cube.clone(), Pose::from_translation(DVec3::X * 9.0)?);
/// room.insert(cube.clone(), Pose::from_translation(DVec3::Y * 4.0)?);
/// let asked = Among::new(cube.at(Pose::IDENTITY), &room)?;
///
/// let saved = ProofFile::of_nearest(&asked)?.expect("there are some").to_json();
/// let proof = ProofFile::from_json(&saved)?;
/// proof.check()?;
/// assert!(proof.to_string().starts_with("of 2 obstacles, obstacle 1 is at most 3.0"));
/// assert!(ProofFile::from_json(&saved.replace("[0.0,4.0,0.0]", "[0.0,4.5,0.0]"))?.check().is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
impl ProofFile {
    /// That no obstacle is nearer than the nearest one, by [`Among::certified_nearest`]; `None` if there are none.
    ///
    /// # Errors
    /// As [`Among::nearest`], and a solid that its own facets do not make once more.
    pub fn of_nearest(among: &Among<'_>) -> Result<Option<Self>, ProofFileError> {
        let stored = StoredScene::of(among)?;
        let proven = stored.scene()?.asked()?.certified_nearest()?;
        Ok(proven.map(|(_, proof)| stored.with(Statement::Nearest(proof))))
    }

    /// Which obstacles are closer than a length, by [`Among::certified_within`].
    ///
    /// # Errors
    /// As [`Among::within`], and a solid that its own facets do not make once more.
    pub fn of_within(among: &Among<'_>, length: f64) -> Result<Self, ProofFileError> {
        let stored = StoredScene::of(among)?;
        let (_, proof) = stored.scene()?.asked()?.certified_within(length)?;
        Ok(stored.with(Statement::Within(proof)))
    }

    /// What stops the moving body, and that nothing does before, by [`Among::certified_clearance`].
    ///
    /// # Errors
    /// As [`Among::clearance`], and a solid that its own facets do not make once more.
    pub fn of_scene_clearance(among: &Among<'_>, direction: DVec3) -> Result<Self, ProofFileError> {
        let stored = StoredScene::of(among)?;
        let (_, proof) = stored.scene()?.asked()?.certified_clearance(direction)?;
        Ok(stored.with(Statement::SceneClearance(proof)))
    }
}

/// A scene as it is read back from a file.
struct StoredScene {
    bodies: Vec<StoredBody>,
    places: Vec<Place>,
    choices: Choices,
}

impl StoredScene {
    fn of(among: &Among<'_>) -> Result<Self, ProofFileError> {
        let mut bodies = vec![StoredBody::again(among.moving(), 0)?];
        let mut places = vec![Place { body: 0, pose: among.moving_pose() }];
        let mut known: HashMap<*const u8, usize> = HashMap::new();
        for (any, pose) in among.asked_in_order() {
            let address = match any {
                AnyBody::Convex(body) => Arc::as_ptr(body).cast(),
                AnyBody::Solid(body) => Arc::as_ptr(body).cast(),
            };
            let body = *known.entry(address).or_insert(bodies.len());
            if body == bodies.len() {
                bodies.push(StoredBody::again(any.at(pose), body)?);
            }
            places.push(Place { body, pose });
        }
        let (options, solid_options) = (among.options(), among.solid_options());
        let choices = Choices {
            keep: options.keep.max(solid_options.keep),
            graze_tolerance: options.graze_tolerance,
            tolerance: solid_options.tolerance,
            start_overlap: solid_options.start_overlap,
        };
        Ok(Self { bodies, places, choices })
    }

    fn scene(&self) -> Result<Scene<'_>, ProofFileError> {
        Scene::new(&self.bodies, &self.places, self.choices)
    }

    fn with(self, statement: Statement) -> ProofFile {
        let (placement, query) = (Placement::Poses(self.places), Query::Scene(self.choices));
        ProofFile { bodies: self.bodies, placement, query, statement }
    }
}
