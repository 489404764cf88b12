//! Proofs of scene queries.
//!
//! In the list of poses the moving body comes first. Obstacle `k`, counted from 0, has pose `k + 1`. An obstacle
//! that was inserted in several poses as one shared body is stored once. Near points name the facets of the file.

use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec3;

use super::body::StoredBody;
use super::error::{ProofError, ProofFileError};
use super::file::{Choices, Place, Placement, Query};
use super::proven::{Proven, Verify};
use super::statement::{facet_of_triangle, rename_triangles, triangle_of_facet};
use super::{ProofFile, Statement};
use colltrans_convex::answer::CertificateError;
use colltrans_convex::body::ObstacleId;
use colltrans_convex::setting::error::QueryError;
use colltrans_convex::solve::options::Options;
use colltrans_scene::{
    ApartProof, ClearanceProof, NearbyProof, NearestProof, Obstacles, SceneProof, SceneQuery,
};
use colltrans_solid::SolidCast;
use colltrans_solid::body::Solid;
use colltrans_solid::cast::SolidOptions;
use colltrans_solid::kinds::{AnyBody, AnyPlaced, ByKind};
use colltrans_solid::solve::nearest::SolidNear;

/// One body in a scene, with the options of the query.
#[derive(Debug)]
pub(super) struct PlacedScene<'a> {
    moving: AnyPlaced<'a>,
    obstacles: Obstacles,
    choices: Choices,
}

impl<'a> PlacedScene<'a> {
    /// Builds the scene. The moving body is in the first place.
    pub(super) fn new(
        bodies: &'a [StoredBody],
        places: &[Place],
        choices: Choices,
    ) -> Result<Self, ProofFileError> {
        let [moving, fixed @ ..] = places else { return Err(ProofFileError::Statement) };
        let stored = |place: &Place| StoredBody::at_index(bodies, place.body);
        let placed = |place: &Place| Ok((stored(place)?.body.clone(), place.pose));
        let mut obstacles = Obstacles::new();
        obstacles.insert_all(fixed.iter().map(placed).collect::<Result<Vec<_>, ProofFileError>>()?);
        let scene = Self { moving: stored(moving)?.body.at(moving.pose), obstacles, choices };
        scene.checked_query()?;
        Ok(scene)
    }

    /// Returns the tolerance of the cast at each obstacle, in the order of the file. It is 0 for two convex bodies.
    pub(super) fn tolerances(&self, direction: DVec3) -> Result<Vec<f64>, ProofFileError> {
        let query = self.checked_query()?;
        let tolerance_at = |id| match query.cast_with(id, direction) {
            Some(ByKind::Solid(cast)) => cast.tolerance(),
            Some(ByKind::Convex(_)) | None => 0.0,
        };
        let mut ids: Vec<ObstacleId> = self.obstacles.iter().map(|(id, ..)| id).collect();
        ids.sort_unstable();
        Ok(ids.into_iter().map(tolerance_at).collect())
    }

    /// Renames a triangle of the moving body (`which` 0) or of an obstacle (1). The index in a convex body remains: the
    /// file has no facets of it.
    fn renamed_triangle(
        &self,
        obstacle: ObstacleId,
        which: usize,
        triangle: u32,
        rename: RenameTriangle,
    ) -> Option<u32> {
        let solid = match (which, self.moving, self.obstacles.get(obstacle)) {
            (0, ByKind::Solid(placed), _) => placed.body,
            (1, _, Some((ByKind::Solid(body), _))) => body,
            _ => return Some(triangle),
        };
        rename(solid, triangle)
    }

    fn checked_query(&self) -> Result<SceneQuery<'_>, QueryError> {
        let Choices { min_gap, graze_tolerance, tolerance, start_overlap } = self.choices;
        if let Some(tolerance) = tolerance.filter(|by| !(0.0..f64::INFINITY).contains(by)) {
            return Err(QueryError::Tolerance { tolerance });
        }
        let options =
            Options::default().with_min_gap(min_gap).with_graze_tolerance(graze_tolerance);
        let of_solids = SolidOptions::default().with_min_gap(min_gap).with_tolerance(tolerance);
        Ok(SceneQuery::new(self.moving, &self.obstacles)?
            .with_options(options)?
            .with_solid_options(of_solids.with_start_overlap(start_overlap)))
    }
}

/// Translates between a triangle of a solid and a facet of the file.
type RenameTriangle = fn(&Solid, u32) -> Option<u32>;

/// A proof about a scene whose near points are in triangles of solids. A file identifies them by its facets, a query by
/// their positions in the trees of the bodies.
pub(super) trait SceneStatement: Clone
where
    for<'p> SceneProof<'p>: From<&'p Self>,
{
    /// Calls a function for the near points in triangles, with their obstacle.
    fn visit_near_points(&mut self, visit: impl FnMut(ObstacleId, &mut SolidNear));

    /// Returns the proof with other indices of triangles. Returns `None` if an index has no replacement.
    fn with_renamed_triangles(
        &self,
        scene: &PlacedScene<'_>,
        rename: RenameTriangle,
    ) -> Option<Self> {
        let (mut renamed, mut is_known) = (self.clone(), true);
        renamed.visit_near_points(|obstacle, near| {
            match rename_triangles(*near, |k, t| scene.renamed_triangle(obstacle, k, t, rename)) {
                Some(found) => *near = found,
                None => is_known = false,
            }
        });
        is_known.then_some(renamed)
    }
}

impl SceneStatement for NearestProof {
    fn visit_near_points(&mut self, mut visit: impl FnMut(ObstacleId, &mut SolidNear)) {
        if let ByKind::Solid(near) = &mut self.near {
            visit(self.obstacle, near);
        }
        visit_apart(&mut self.apart, visit);
    }
}

impl SceneStatement for NearbyProof {
    fn visit_near_points(&mut self, mut visit: impl FnMut(ObstacleId, &mut SolidNear)) {
        for (obstacle, near) in &mut self.closer {
            if let ByKind::Solid(near) = near {
                visit(*obstacle, near);
            }
        }
        visit_apart(&mut self.apart, visit);
    }
}

impl SceneStatement for ClearanceProof {
    fn visit_near_points(&mut self, _: impl FnMut(ObstacleId, &mut SolidNear)) {}
}

/// Calls a function for the near points of proofs that obstacles are apart.
fn visit_apart(
    apart: &mut [(ObstacleId, ApartProof)],
    mut visit: impl FnMut(ObstacleId, &mut SolidNear),
) {
    for (obstacle, proof) in apart {
        if let ByKind::Solid(certificate) = proof {
            visit(*obstacle, &mut certificate.near);
        }
    }
}

impl<'s, P: SceneStatement> Verify<'_, PlacedScene<'s>> for P
where
    for<'p> SceneProof<'p>: From<&'p P>,
{
    fn verify(&self, scene: &PlacedScene<'s>) -> Result<Proven<'static>, ProofError> {
        let renamed = self.with_renamed_triangles(scene, triangle_of_facet);
        scene.checked_query()?.verify(&renamed.ok_or(CertificateError::StartClaim)?)?;
        Ok(Proven::Statement)
    }
}

/// Proofs of scene queries, which are computed for the bodies that are rebuilt from the file.
///
/// Obstacles have indices from 0 in the order of insertion. Ignored obstacles are not stored. Of the options,
/// the minimum gap, the graze tolerance, the tolerance of solids and the start overlap are used.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::{SceneQuery, ConvexPolyhedron, Obstacles, Pose, ProofFile};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let mut room = Obstacles::new();
/// room.insert(cube.clone(), Pose::from_translation(DVec3::X * 9.0)?);
/// room.insert(cube.clone(), Pose::from_translation(DVec3::Y * 4.0)?);
/// let asked = SceneQuery::new(cube.at(Pose::IDENTITY), &room)?;
///
/// let saved = ProofFile::of_nearest(&asked)?.expect("there are some").to_json();
/// let proof = ProofFile::from_json(&saved)?;
/// proof.check()?;
/// assert!(proof.to_string().starts_with("of 2 obstacles, obstacle 1 is at most 3.0"));
/// assert!(ProofFile::from_json(&saved.replace("[0.0,4.0,0.0]", "[0.0,4.5,0.0]"))?.check().is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
impl ProofFile {
    /// Proves by [`SceneQuery::certified_nearest`] that no obstacle is nearer than the nearest one. Returns `None`
    /// without obstacles.
    ///
    /// # Errors
    /// Returns the errors of [`SceneQuery::nearest`], and an error for a solid that cannot be rebuilt from its own
    /// facets.
    pub fn of_nearest(among: &SceneQuery<'_>) -> Result<Option<Self>, ProofFileError> {
        let stored = StoredScene::of_scene(among)?;
        let proven = stored.placed_scene()?.checked_query()?.certified_nearest()?;
        let Some((_, proof)) = proven else { return Ok(None) };
        stored.with_statement(&proof, Statement::Nearest).map(Some)
    }

    /// Proves by [`SceneQuery::certified_within`] which obstacles are closer than a length.
    ///
    /// # Errors
    /// Returns the errors of [`SceneQuery::within`], and an error for a solid that cannot be rebuilt from its own
    /// facets.
    pub fn of_within(among: &SceneQuery<'_>, length: f64) -> Result<Self, ProofFileError> {
        let stored = StoredScene::of_scene(among)?;
        let (_, proof) = stored.placed_scene()?.checked_query()?.certified_within(length)?;
        stored.with_statement(&proof, Statement::Within)
    }

    /// Proves by [`SceneQuery::certified_clearance`] which obstacle blocks the moving body, and that none blocks
    /// it earlier.
    ///
    /// # Errors
    /// Returns the errors of [`SceneQuery::clearance`], and an error for a solid that cannot be rebuilt from its
    /// own facets.
    pub fn of_scene_clearance(
        among: &SceneQuery<'_>,
        direction: DVec3,
    ) -> Result<Self, ProofFileError> {
        let stored = StoredScene::of_scene(among)?;
        let (_, proof) = stored.placed_scene()?.checked_query()?.certified_clearance(direction)?;
        stored.with_statement(&proof, Statement::SceneClearance)
    }
}

/// Scene with the bodies that are rebuilt from its file.
struct StoredScene {
    bodies: Vec<StoredBody>,
    places: Vec<Place>,
    choices: Choices,
}

impl StoredScene {
    fn of_scene(among: &SceneQuery<'_>) -> Result<Self, ProofFileError> {
        let mut bodies = vec![StoredBody::rebuild(among.moving(), 0)?];
        let mut places = vec![Place { body: 0, pose: among.moving_pose() }];
        let mut known: HashMap<*const u8, usize> = HashMap::new();
        for (any, pose) in among.queried_in_order() {
            let address = match any {
                AnyBody::Convex(body) => Arc::as_ptr(body).cast(),
                AnyBody::Solid(body) => Arc::as_ptr(body).cast(),
            };
            let body = *known.entry(address).or_insert(bodies.len());
            if body == bodies.len() {
                bodies.push(StoredBody::rebuild(any.at(pose), body)?);
            }
            places.push(Place { body, pose });
        }
        let (options, solid_options) = (among.options(), among.solid_options());
        let choices = Choices {
            min_gap: options.min_gap.max(solid_options.min_gap),
            graze_tolerance: options.graze_tolerance,
            tolerance: solid_options.tolerance,
            start_overlap: solid_options.start_overlap,
        };
        Ok(Self { bodies, places, choices })
    }

    fn placed_scene(&self) -> Result<PlacedScene<'_>, ProofFileError> {
        PlacedScene::new(&self.bodies, &self.places, self.choices)
    }

    fn with_statement<P: SceneStatement>(
        self,
        proof: &P,
        statement: impl Fn(P) -> Statement,
    ) -> Result<ProofFile, ProofFileError>
    where
        for<'p> SceneProof<'p>: From<&'p P>,
    {
        let stored = proof.with_renamed_triangles(&self.placed_scene()?, facet_of_triangle);
        let statement = statement(stored.ok_or(ProofFileError::Statement)?);
        let (placement, query) = (Placement::Poses(self.places), Query::Scene(self.choices));
        Ok(ProofFile::new(self.bodies, placement, query, statement))
    }
}
