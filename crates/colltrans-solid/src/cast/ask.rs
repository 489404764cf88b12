//! The questions that only solids answer, as methods of [`Cast`].

use glam::DVec3;

use super::boxes::{self, told_by_boxes};
use super::hulls::{Guessed, Hulls};
use super::tolerance::least_tolerance_from;
use super::{SolidCertificate, SolidFree, SolidOverlap, StartOverlap, StartProof, proof, verify};
use crate::body::{AsSolid, Solid};
use crate::solve::contact::{SolidContact, contact, true_place};
use crate::solve::overlap::{self, Overlap};
use crate::solve::scene::{Scene, noise_of, permutes};
use crate::solve::search::{Aim, Found, Search, Workspace};
use crate::solve::separate::separation;
use crate::solve::steps::SolidSteps;
use colltrans_convex::answer::{Bounded, CertificateError, Clearance, Outcome};
use colltrans_convex::body::Placed;
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::error::QueryError;

/// Default tolerance, in multiples of the rounding error of a coordinate.
pub(super) const NOISES: f64 = 8.0;

/// Queries that only a [`Cast`] of two [`Solid`]s supports.
pub trait SolidCast<'a>: Sized {
    /// Between bodies of either kind, as solids: a solid against a convex polyhedron, say.
    ///
    /// # Errors
    /// A direction that is zero, not finite or out of range; a convex body whose facets [`Solid::from_mesh`] refuses.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::solid::SolidCast;
    /// use colltrans::{Cast, ConvexPolyhedron, Pose, Solid};
    ///
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let post = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 4.0))?;
    /// let step = Solid::from_pieces([&cube, &post])?;
    /// let above = Pose::from_translation(DVec3::new(0.5, 0.5, 6.0))?;
    /// let down = Cast::between(cube.at(above), step.at(Pose::IDENTITY), DVec3::NEG_Z)?;
    /// let distance = down.clearance()?.distance().expect("the step is below");
    /// assert!(distance <= 2.0 && distance > 2.0 - 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn between<A: AsSolid, B: AsSolid>(
        moving: Placed<'a, A>,
        fixed: Placed<'a, B>,
        direction: DVec3,
    ) -> Result<Self, QueryError>;

    /// Returns the cast with both bodies shrunk by half of this length. Solids have no graze tolerance, since it would
    /// depend on how finely they are meshed:
    ///
    /// ```compile_fail
    /// # use colltrans::{Cast, Solid};
    /// fn graze(cast: Cast<Solid>) {
    ///     cast.with_graze_tolerance(0.5);
    /// }
    /// ```
    ///
    /// # Errors
    /// As [`Cast::with_options`].
    fn with_tolerance(self, tolerance: f64) -> Result<Self, QueryError>;

    /// Returns the cast with another meaning of an overlap at the start.
    #[must_use]
    fn with_start_overlap(self, start_overlap: StartOverlap) -> Self;

    /// The tolerance that is used, as a length.
    fn tolerance(&self) -> f64;

    /// Computes [`Cast::clearance`] and reuses the queue in `workspace`.
    ///
    /// # Errors
    /// As [`Cast::clearance`].
    fn clearance_in(&self, workspace: &mut Workspace) -> Result<Clearance<Solid>, QueryError>;

    /// How far the moving body can move from where it is, as [`Cast::clearance`] says, and the proof
    /// of it. Allocates what the proof takes: a byte for each pair of nodes.
    ///
    /// Of convex bodies every answer carries its proof, which the search ends with anyway. Between solids
    /// it takes a pass over all that the search left out, and as much space: so it is asked for apart.
    ///
    /// # Errors
    /// As [`Cast::clearance`].
    fn certified_clearance(&self) -> Result<(Clearance<Solid>, SolidCertificate), QueryError>;

    /// Where the moving body would be stopped if these two triangles, by their positions in
    /// [`Solid::triangles`], were all that there is of the bodies; `None` if they do not stop it. What
    /// blocks along one direction often does so along others too: then [`Cast::clearance`] is no
    /// larger. Bodies count as overlapping only where [`SolidOptions::overlapping`](super::SolidOptions::overlapping) says so.
    fn stop_by(&self, triangles: [u32; 2]) -> Option<SolidContact>;

    /// Where two triangles of these bodies, as they are, meet that stop them after
    /// [`Solid::shrunk`]: what [`SolidContact::translation`] is to
    /// [`SolidContact::shrunk_distance`]. `shrunk` is how far the shrunk bodies go, `normal` that of
    /// their contact, and `shift` how far the contact point of the moving body was moved by shrinking,
    /// less that of the fixed body. `None` if there are no such triangles.
    fn true_place(
        &self,
        triangles: [u32; 2],
        shrunk: Bounded,
        normal: DVec3,
        shift: DVec3,
    ) -> Option<Bounded>;

    /// Whether the interiors of the bodies, shrunk by half the tolerance, have a point in common, or open
    /// shells pass through what is there.
    fn overlaps(&self) -> bool;

    /// Where the bodies, shrunk by half the tolerance, overlap, and by how much; `None` if they do not:
    /// what [`Clearance::Overlapping`] tells, and what an answer with [`StartOverlap::Ignore`] has
    /// ignored. It costs several times as much as [`Self::overlaps`], for the least tolerance.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::solid::{Overlap, SolidCast, StartOverlap};
    /// use colltrans::{Cast, ConvexPolyhedron, Pose};
    ///
    /// let table = ConvexPolyhedron::cuboid(DVec3::new(-4.0, -4.0, -1.0), DVec3::new(4.0, 4.0, 0.0))?;
    /// let plate = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 1.0))?;
    /// let sunk = Pose::from_translation(DVec3::Z * -0.125)?;
    /// let aside = Cast::between(plate.at(sunk), table.at(Pose::IDENTITY), DVec3::X)?
    ///     .with_start_overlap(StartOverlap::Ignore);
    /// assert!(aside.clearance()?.is_free());
    /// let ignored = aside.start_overlap().expect("the plate is pressed into the table");
    /// assert!(matches!(ignored.place, Overlap::Facets(_, _)));
    /// assert!((ignored.least_tolerance.expect("there is one") - 0.125).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn start_overlap(&self) -> Option<SolidOverlap>;

    /// The least tolerance with which the bodies do not overlap, from above: 0 if they do not, `None`
    /// if there is none that leaves something of both, as of one that lies deep inside the other. Nor is there one
    /// where they overlap and one of them has open
    /// shells: less of a solid does not free a sheet that passes through it. It is more than the least by
    /// `1e-12` of itself or 8 noises (`256 u S`) at most. How far convex bodies have to
    /// go back along a direction is another question: [`Cast::directional_depth`].
    fn least_tolerance(&self) -> Option<f64>;

    /// Computes [`Cast::first_contact`] and reuses the queue in `workspace`.
    ///
    /// # Errors
    /// As [`Cast::first_contact`].
    fn first_contact_in(&self, workspace: &mut Workspace) -> Result<Outcome<Solid>, QueryError>;

    /// The translation after which the bodies, as they are, never meet again, in multiples of the
    /// direction: the last contact of [`Cast::contact_range`] alone, and 0 if it lies behind; `None` if
    /// they never meet. Beyond `upper` they are apart for certain.
    fn exit(&self) -> Option<Bounded>;

    /// Computes [`Self::exit`] and reuses the queue in `workspace`.
    fn exit_in(&self, workspace: &mut Workspace) -> Option<Bounded>;
}

/// The bodies of a query as its searches see them: for the crates that search beside this one.
#[doc(hidden)]
pub trait SolidScene<'a> {
    fn scene(&self, tolerance: f64) -> Scene<'a>;

    /// The bodies shrunk by half the tolerance.
    fn asked(&self) -> Scene<'a>;

    /// Returns the bodies shrunk by half the tolerance, or an error if nothing is left of one.
    fn asked_of_something(&self) -> Result<Scene<'a>, QueryError>;

    fn overlap_at(&self, place: Overlap, steps: SolidSteps) -> SolidOverlap;

    fn prove_start(&self, scene: &Scene, steps: &mut SolidSteps) -> StartProof;

    fn verify_start(&self, scene: &Scene, start: &StartProof) -> Result<(), CertificateError>;
}

impl<'a> SolidCast<'a> for Cast<'a, Solid> {
    fn between<A: AsSolid, B: AsSolid>(
        moving: Placed<'a, A>,
        fixed: Placed<'a, B>,
        direction: DVec3,
    ) -> Result<Self, QueryError> {
        let (a, b) = (moving.body.as_surface()?, fixed.body.as_surface()?);
        Cast::new(a.at(moving.pose), b.at(fixed.pose), direction)
    }

    fn with_tolerance(self, tolerance: f64) -> Result<Self, QueryError> {
        self.with_options(self.options.with_tolerance(tolerance))
    }

    fn with_start_overlap(self, start_overlap: StartOverlap) -> Self {
        Self { options: self.options.with_start_overlap(start_overlap), ..self }
    }

    fn tolerance(&self) -> f64 {
        self.options.tolerance.unwrap_or_else(|| {
            let (setting, keep) = (&self.setting, self.options.keep);
            let permuted = permutes(setting.moving_matrix) && permutes(setting.fixed_matrix);
            default_tolerance(permuted, noise_of(setting.scale(), keep).0)
        })
    }

    fn clearance_in(&self, workspace: &mut Workspace) -> Result<Clearance<Solid>, QueryError> {
        let (mut scene, mut steps) = (None, SolidSteps::default());
        let place = match told_at_once(self, &mut scene, &mut steps)? {
            AtOnce::Answer(answer) => return Ok(answer),
            AtOnce::Overlapping(place) => Some(place),
            AtOnce::Nothing => None,
        };
        let scene = scene_once(self, &mut scene)?;
        let ignored = self.options.start_overlap == StartOverlap::Ignore;
        let aim = match self.options.overlapping {
            Some(false) => Aim::Stop,
            Some(true) if ignored => Aim::LaterStop,
            _ => match place.or_else(|| overlap::find(scene, &mut steps)) {
                Some(_) if ignored => Aim::LaterStop,
                Some(place) => return Ok(Clearance::Overlapping(self.overlap_at(place, steps))),
                None => Aim::Stop,
            },
        };
        let found = first(scene, aim, limit(self, scene), workspace, &mut steps);
        Ok(answer(self, scene, found.as_ref(), steps))
    }

    fn certified_clearance(&self) -> Result<(Clearance<Solid>, SolidCertificate), QueryError> {
        proof::certified_clearance(self)
    }

    fn stop_by(&self, triangles: [u32; 2]) -> Option<SolidContact> {
        if !has(self, triangles) {
            return None;
        }
        let scene = self.asked();
        let later = self.options.overlapping == Some(true)
            && self.options.start_overlap == StartOverlap::Ignore;
        let aim = if later { Aim::LaterStop } else { Aim::Stop };
        let search = Search::new(&scene, aim, limit(self, &scene), |_, _| ());
        let found = search.of_pair(triangles)?;
        // Nothing stops a body before 0.
        Some(contact(&scene, &found, found.bounded(&scene).clamped(), SolidSteps::default()))
    }

    fn true_place(
        &self,
        triangles: [u32; 2],
        shrunk: Bounded,
        normal: DVec3,
        shift: DVec3,
    ) -> Option<Bounded> {
        has(self, triangles).then(|| true_place(&self.scene(0.0), triangles, shrunk, normal, shift))
    }

    fn overlaps(&self) -> bool {
        overlap::find(&self.asked(), &mut SolidSteps::default()).is_some()
    }

    fn start_overlap(&self) -> Option<SolidOverlap> {
        let mut steps = SolidSteps::default();
        let place = place_of_overlap(self, &self.asked(), &mut steps)?;
        Some(self.overlap_at(place, steps))
    }

    fn least_tolerance(&self) -> Option<f64> {
        least_tolerance_from(self, None, &mut SolidSteps::default())
    }

    fn first_contact_in(&self, workspace: &mut Workspace) -> Result<Outcome<Solid>, QueryError> {
        let (scene, mut steps) = (self.scene(0.0), SolidSteps::default());
        let found = first(&scene, Aim::Least, f64::INFINITY, workspace, &mut steps);
        Ok(match found {
            Some(found) => Outcome::Contact(contact(&scene, &found, found.bounded(&scene), steps)),
            None => Outcome::Separated(SolidFree { separation: separation(&scene), steps }),
        })
    }

    fn exit(&self) -> Option<Bounded> {
        self.exit_in(&mut Workspace::default())
    }

    fn exit_in(&self, workspace: &mut Workspace) -> Option<Bounded> {
        let scene = self.reversed().scene(0.0);
        let steps = &mut SolidSteps::default();
        let found = first(&scene, Aim::Least, f64::INFINITY, workspace, steps)?;
        Some(found.bounded(&scene).negated().clamped())
    }
}

impl<'a> SolidScene<'a> for Cast<'a, Solid> {
    #[inline]
    fn scene(&self, tolerance: f64) -> Scene<'a> {
        Scene::new(&self.setting, [tolerance / 2.0; 2], self.options.keep)
    }

    #[inline]
    fn asked(&self) -> Scene<'a> {
        self.scene(self.tolerance())
    }

    #[inline]
    fn asked_of_something(&self) -> Result<Scene<'a>, QueryError> {
        let tolerance = self.tolerance();
        // One that was given was checked then.
        if self.options.tolerance.is_none() {
            check_left(self, tolerance)?;
        }
        Ok(self.scene(tolerance))
    }

    #[inline]
    fn overlap_at(&self, place: Overlap, mut steps: SolidSteps) -> SolidOverlap {
        let least_tolerance = least_tolerance_from(self, Some(place), &mut steps);
        SolidOverlap { place, least_tolerance, steps }
    }

    #[inline]
    fn prove_start(&self, scene: &Scene, steps: &mut SolidSteps) -> StartProof {
        proof::prove_start(self, scene, steps)
    }

    fn verify_start(&self, scene: &Scene, start: &StartProof) -> Result<(), CertificateError> {
        verify::verify_start(self, scene, start)
    }
}

/// Refuses a tolerance that leaves nothing of a body.
pub(super) fn check_left(cast: &Cast<'_, Solid>, tolerance: f64) -> Result<(), QueryError> {
    for (which, solid) in [("moving", cast.moving()), ("fixed", cast.fixed())] {
        if solid.vanishes(tolerance / 2.0) {
            let extent = solid.thickness();
            return Err(QueryError::NothingLeft { which, tolerance, extent });
        }
    }
    Ok(())
}

/// Returns the length from which on gaps are of no interest.
pub(super) fn limit(cast: &Cast<'_, Solid>, scene: &Scene) -> f64 {
    cast.options.before.map_or(f64::INFINITY, |t| t * scene.setting.length)
}

/// What is told of a clearance before any search.
pub(super) enum AtOnce {
    Answer(Clearance<Solid>),
    /// The bodies overlap there.
    Overlapping(Overlap),
    Nothing,
}

/// What is told of the clearance before any search, the same whether a proof is wanted or not: by boxes, then by
/// hulls, then by the facets around the contact of those. The scene is made when it is asked for.
pub(super) fn told_at_once<'a>(
    cast: &Cast<'a, Solid>,
    scene: &mut Option<Scene<'a>>,
    steps: &mut SolidSteps,
) -> Result<AtOnce, QueryError> {
    let by_boxes = told_by_boxes(cast);
    if let boxes::Told::Passing(answer) = by_boxes {
        return Ok(AtOnce::Answer(answer));
    }
    // Where boxes touch, the bodies' exact places are asked before their hulls; where hulls overlap by little, facets.
    let touching = matches!(by_boxes, boxes::Told::Touching);
    let hulls = if touching { None } else { Hulls::of(cast) };
    let in_doubt = touching || hulls.as_ref().is_some_and(Hulls::are_sunk);
    if !in_doubt && let Some(answer) = hulls.as_ref().and_then(|hulls| hulls.certain(cast)) {
        return Ok(AtOnce::Answer(answer));
    }
    let scene = scene_once(cast, scene)?;
    if touching && overlap::pass(scene, limit(cast, scene)) {
        steps.nodes += 1;
        return Ok(AtOnce::Answer(answer(cast, scene, None, *steps)));
    }
    let hulls = if touching { Hulls::of(cast) } else { hulls };
    if let Some(place) = sunk(cast, hulls.as_ref(), scene, steps) {
        return Ok(AtOnce::Overlapping(place));
    }
    let told = hulls.and_then(|hulls| {
        let certain = if in_doubt { hulls.certain(cast) } else { None };
        certain.or_else(|| guessed_by_hulls(cast, &hulls, scene))
    });
    Ok(told.map_or(AtOnce::Nothing, AtOnce::Answer))
}

/// The bodies shrunk by half the tolerance, which leaves something of them, made once.
pub(super) fn scene_once<'a, 's>(
    cast: &Cast<'a, Solid>,
    scene: &'s mut Option<Scene<'a>>,
) -> Result<&'s Scene<'a>, QueryError> {
    Ok(match scene {
        Some(scene) => scene,
        None => scene.insert(cast.asked_of_something()?),
    })
}

/// Where the bodies overlap, if they do by little, by what is around a contact of their hulls.
pub(super) fn sunk(
    cast: &Cast<'_, Solid>,
    hulls: Option<&Hulls>,
    scene: &Scene,
    steps: &mut SolidSteps,
) -> Option<Overlap> {
    if cast.options.overlapping == Some(false) {
        return None;
    }
    hulls?.sunk(scene, &mut steps.leaves)
}

/// Where they overlap.
pub(super) fn place_of_overlap(
    cast: &Cast<'_, Solid>,
    scene: &Scene,
    steps: &mut SolidSteps,
) -> Option<Overlap> {
    let sunk = sunk(cast, Hulls::of(cast).as_ref(), scene, steps);
    sunk.or_else(|| overlap::find(scene, steps))
}

pub(super) fn guessed_by_hulls(
    cast: &Cast<'_, Solid>,
    hulls: &Hulls,
    scene: &Scene,
) -> Option<Clearance<Solid>> {
    if let Some(answer) = hulls.touching(cast, scene) {
        return Some(answer);
    }
    let mut steps = SolidSteps::default();
    Some(match hulls.guessed(scene, limit(cast, scene), &mut steps.leaves)? {
        Guessed::Stop(found, least) => {
            let told = hulls.stopped_by(cast, &found, least, steps);
            told.unwrap_or_else(|| answer(cast, scene, Some(&found), steps))
        }
        Guessed::Free => answer(cast, scene, None, steps),
    })
}

/// What a search has found, as an answer.
pub(super) fn answer(
    cast: &Cast<'_, Solid>,
    scene: &Scene,
    found: Option<&Found>,
    steps: SolidSteps,
) -> Clearance<Solid> {
    let Some(found) = found else {
        let to_the_end = cast.options.before.is_none();
        let separation = to_the_end.then(|| separation(scene)).flatten();
        return Clearance::Free(SolidFree { separation, steps });
    };
    // Nothing stops a body before 0.
    let contact = contact(scene, found, found.bounded(scene).clamped(), steps);
    Clearance::Blocked { distance: contact.translation.lower.max(0.0), contact }
}

fn has(cast: &Cast<'_, Solid>, triangles: [u32; 2]) -> bool {
    let counts = [cast.moving(), cast.fixed()].map(|solid| solid.triangles().len());
    triangles.into_iter().zip(counts).all(|(t, count)| (t as usize) < count)
}

/// The tolerance of bodies for which none was given, whose matrices permute axes, or not.
pub(super) fn default_tolerance(permuted: bool, noise: f64) -> f64 {
    if permuted { 0.0 } else { NOISES * noise }
}

/// The least gap below a limit.
fn first(
    scene: &Scene,
    aim: Aim,
    limit: f64,
    workspace: &mut Workspace,
    steps: &mut SolidSteps,
) -> Option<Found> {
    let mut search = Search::new(scene, aim, limit, |_, _| ());
    let found = search.run(workspace);
    *steps += search.steps;
    found
}
