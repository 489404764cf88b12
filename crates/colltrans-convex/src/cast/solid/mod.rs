//! How far a solid can move from where it is.
//!
//! With a tolerance `L` both bodies are shrunk by `L / 2`. If their interiors then share a point, they
//! overlap: how much has a file of its own, [`tolerance`].

mod boxes;
mod hulls;
mod proof;
#[cfg(feature = "serde")]
mod saved;
mod tolerance;
mod verify;

use glam::DVec3;

use super::{Cast, common_end};
use crate::answer::{
    Bounded, Clearance, ContactRange, Intersection, Outcome, Separation, SolidSteps,
};
use crate::body::solid::{AsSolid, Solid};
use crate::body::{Body, Placed, Pose};
use crate::setting::check_keep;
use crate::setting::error::QueryError;
use crate::solve::solid::contact::{SolidContact, contact, true_place};
use crate::solve::solid::nearest::{SolidGap, SolidNear};
use crate::solve::solid::overlap::{self, Overlap};
use crate::solve::solid::scene::{Scene, noise_of, permutes};
use crate::solve::solid::search::{Aim, Found, Search, Workspace};
use crate::solve::solid::separate::separation;
use hulls::{Guessed, Hulls};
pub use proof::{Claim, Cover, SolidCertificate, StartProof, StopProof};
pub use verify::SolidProof;

/// Default tolerance, in multiples of the rounding error of a coordinate.
const NOISES: f64 = 8.0;

/// What an overlap at the start means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum StartOverlap {
    /// It is the answer.
    #[default]
    Refuse,
    /// Facets that cross now do not block; contacts that begin later do. [`Cast::start_overlap`] says
    /// what was ignored.
    Ignore,
}

/// Choices of a query between solids. More may be added: begin with the default ones.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SolidOptions {
    /// What an overlap at the start means.
    pub start_overlap: StartOverlap,
    /// Both bodies are shrunk by half of this length. `None` stands for 0 where both poses turn by
    /// quarter turns, and else for what rounding can do to a fit, `256 u S`.
    pub tolerance: Option<f64>,
    /// Contacts at this translation or beyond, of the shrunk bodies, are of no interest: the least `shrunk_distance` so
    /// far, where one body is asked against many. As they are, bodies may meet long before they do shrunk.
    pub before: Option<f64>,
    /// Whether the bodies overlap where they are: what [`Cast::overlaps`] has said of the same
    /// bodies, poses and tolerance. Whoever asks one pair along many directions asks once. `None`:
    /// it is looked at, as is an overlap that is the answer, to be named.
    pub overlapping: Option<bool>,
    /// How near to each other the bodies may come (world units): see
    /// [`Cast::keeping`](crate::Cast#method.keeping-1). `0`, the default: until they touch.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "crate::written::is_zero"))]
    pub keep: f64,
}

impl SolidOptions {
    /// With a meaning of an overlap at the start.
    #[must_use]
    pub const fn with_start_overlap(self, start_overlap: StartOverlap) -> Self {
        Self { start_overlap, ..self }
    }

    /// With a tolerance, a length, or the default one. It is checked where it is used.
    #[must_use]
    pub fn with_tolerance(self, tolerance: impl Into<Option<f64>>) -> Self {
        Self { tolerance: tolerance.into(), ..self }
    }

    /// With an end, or without.
    #[must_use]
    pub fn with_before(self, before: impl Into<Option<f64>>) -> Self {
        Self { before: before.into(), ..self }
    }

    /// With a gap to be kept, a length. It is checked where it is used.
    #[must_use]
    pub const fn with_keep(self, keep: f64) -> Self {
        Self { keep, ..self }
    }

    /// With what is known of an overlap at the start.
    #[must_use]
    pub fn with_overlapping(self, overlapping: impl Into<Option<bool>>) -> Self {
        Self { overlapping: overlapping.into(), ..self }
    }
}

/// The overlap of two solids.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SolidOverlap {
    /// One of the places where the bodies, shrunk by half the tolerance each, overlap: facets that
    /// cross, or a shell that is inside.
    pub place: Overlap,
    /// The least tolerance with which they would not overlap, from above; `None` if there is none, as
    /// where what overlaps is an open shell: see [`Cast::least_tolerance`].
    #[cfg_attr(feature = "serde", serde(rename = "depth"))]
    pub least_tolerance: Option<f64>,
    /// Work done.
    pub steps: SolidSteps,
}

/// Nothing stops the moving body, or it never meets the other one.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SolidFree {
    /// A plane between the bodies, parallel to the direction, where there is one that rounding can
    /// tell; not looked for where a query ends at [`SolidOptions::before`].
    pub separation: Option<Separation>,
    /// Work done.
    pub steps: SolidSteps,
}

/// Whether solids meet where they are.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SolidMeeting {
    /// Two facets with a point in common, or a shell that is inside; `None` if the bodies do not meet.
    pub place: Option<Overlap>,
    /// Work done.
    pub steps: SolidSteps,
}

/// Solids do not graze: shadows that overlap, by however little, make a contact. There is no such value.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum NoGrazing {}

impl Body for Solid {
    type Options = SolidOptions;
    type Contact = SolidContact;
    type Grazing = NoGrazing;
    type Separated = SolidFree;
    type Free = SolidFree;
    type Overlap = SolidOverlap;
    type Evidence = SolidMeeting;
    type Near = SolidNear;
    type Gap = SolidGap;
    type Steps = SolidSteps;
}

/// What is told of a clearance before any search.
enum AtOnce {
    Answer(Clearance<Solid>),
    /// The bodies overlap there.
    Overlapping(Overlap),
    Nothing,
}

impl Solid {
    /// This body in a pose, for a [`Cast`].
    pub fn at(&self, pose: Pose) -> Placed<'_, Self> {
        Placed { body: self, pose }
    }
}

/// Queries between solids.
impl<'a> Cast<'a, Solid> {
    /// Between bodies of either kind, as solids: a solid against a convex polyhedron, say.
    ///
    /// # Errors
    /// A direction that is zero, not finite or out of range.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
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
    pub fn between<A: AsSolid, B: AsSolid>(
        moving: Placed<'a, A>,
        fixed: Placed<'a, B>,
        direction: DVec3,
    ) -> Result<Self, QueryError> {
        let (a, b) = (moving.body.as_surface()?, fixed.body.as_surface()?);
        Cast::new(a.at(moving.pose), b.at(fixed.pose), direction)
    }

    /// The same with other choices.
    ///
    /// # Errors
    /// A tolerance, or a gap to be kept, that is negative or not finite, or a tolerance so large that nothing is left of a closed body
    /// ([`QueryError::NothingLeft`]).
    pub fn with_options(self, options: SolidOptions) -> Result<Self, QueryError> {
        check_keep(options.keep)?;
        if let Some(tolerance) = options.tolerance {
            if !(tolerance.is_finite() && tolerance >= 0.0) {
                return Err(QueryError::Tolerance { tolerance });
            }
            self.check_left(tolerance)?;
        }
        Ok(Self { options, ..self })
    }

    /// Refuses a tolerance that leaves nothing of a body.
    pub(crate) fn check_left(&self, tolerance: f64) -> Result<(), QueryError> {
        for (which, solid) in [("moving", self.moving()), ("fixed", self.fixed())] {
            if solid.vanishes(tolerance / 2.0) {
                let extent = solid.thickness();
                return Err(QueryError::NothingLeft { which, tolerance, extent });
            }
        }
        Ok(())
    }

    /// The same with both bodies shrunk by half of this length. A graze tolerance would depend on how
    /// finely a solid is meshed; there is none:
    ///
    /// ```compile_fail
    /// # use colltrans::{Cast, Solid};
    /// fn graze(cast: Cast<Solid>) {
    ///     cast.with_graze_tolerance(0.5);
    /// }
    /// ```
    ///
    /// # Errors
    /// As [`Self::with_options`].
    pub fn with_tolerance(self, tolerance: f64) -> Result<Self, QueryError> {
        self.with_options(self.options.with_tolerance(tolerance))
    }

    /// The same with a gap to be kept, in world units, as [`Cast::keeping`](crate::Cast#method.keeping) of convex bodies:
    /// all questions are then about how far the bodies, shrunk by half the tolerance where that counts, are *as near as
    /// the gap*, and bodies that start nearer are [`Clearance::Overlapping`], around two facets that are.
    ///
    /// Up to `lower` no two facets come nearer than the gap, but for those that pass each other, or start, at
    /// the gap to within eight noises of the size with the gap (`256 u S`), which do not block; at `upper` two are as
    /// near. [`Self::least_tolerance`] is that with which the bodies are not nearer. A gap of no more than
    /// eight noises is none. Proofs are as without a gap.
    ///
    /// # Errors
    /// A gap that is negative, not finite or more than [`MAX_MAGNITUDE`](crate::MAX_MAGNITUDE); as
    /// [`Self::with_options`].
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::{Cast, Clearance, ConvexPolyhedron, Pose};
    ///
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let start = Pose::from_translation(DVec3::new(-3.0, 0.5, 0.0))?;
    /// let cast = Cast::between(cube.at(start), cube.at(Pose::IDENTITY), DVec3::X)?;
    /// let (clearance, proof) = cast.keeping(0.25)?.certified_clearance()?;
    /// let distance = clearance.distance().expect("they are apart");
    /// assert!(distance <= 1.75 && distance > 1.75 - 1e-12);
    /// assert!(cast.keeping(0.25)?.verify(&proof)? < 1e-12);
    /// assert!(matches!(cast.keeping(2.5)?.clearance()?, Clearance::Overlapping(_)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn keeping(self, gap: f64) -> Result<Self, QueryError> {
        self.with_options(self.options.with_keep(gap))
    }

    /// The same with another meaning of an overlap at the start.
    #[must_use]
    pub fn with_start_overlap(self, start_overlap: StartOverlap) -> Self {
        Self { options: self.options.with_start_overlap(start_overlap), ..self }
    }

    /// The tolerance that is used, as a length.
    pub fn tolerance(&self) -> f64 {
        self.options.tolerance.unwrap_or_else(|| {
            let (setting, keep) = (&self.setting, self.options.keep);
            let permuted = permutes(setting.moving_matrix) && permutes(setting.fixed_matrix);
            default_tolerance(permuted, noise_of(setting.scale(), keep).0)
        })
    }

    #[doc(hidden)]
    #[inline]
    pub fn scene(&self, tolerance: f64) -> Scene<'a> {
        Scene::new(&self.setting, [tolerance / 2.0; 2], self.options.keep)
    }

    /// The bodies shrunk by half the tolerance.
    #[doc(hidden)]
    #[inline]
    pub fn asked(&self) -> Scene<'a> {
        self.scene(self.tolerance())
    }

    /// The same, of bodies that the default tolerance leaves something of.
    #[doc(hidden)]
    #[inline]
    pub fn asked_of_something(&self) -> Result<Scene<'a>, QueryError> {
        let tolerance = self.tolerance();
        // One that was given was checked then.
        if self.options.tolerance.is_none() {
            self.check_left(tolerance)?;
        }
        Ok(self.scene(tolerance))
    }

    /// How far the moving body can move from where it is.
    ///
    /// Free says without telling them apart that it slides along, moves away from or never meets the
    /// other body; where a plane lies between the two, it comes with it.
    ///
    /// # Errors
    /// A body so thin that the default tolerance leaves nothing of it, [`QueryError::NothingLeft`].
    pub fn clearance(&self) -> Result<Clearance<Solid>, QueryError> {
        self.clearance_in(&mut Workspace::default())
    }

    /// The same with a queue that is kept.
    ///
    /// # Errors
    /// As [`Self::clearance`].
    pub fn clearance_in(&self, workspace: &mut Workspace) -> Result<Clearance<Solid>, QueryError> {
        let (mut scene, mut steps) = (None, SolidSteps::default());
        let place = match self.told_at_once(&mut scene, &mut steps)? {
            AtOnce::Answer(answer) => return Ok(answer),
            AtOnce::Overlapping(place) => Some(place),
            AtOnce::Nothing => None,
        };
        let scene = self.scene_once(&mut scene)?;
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
        let found = first(scene, aim, self.limit(scene), workspace, &mut steps);
        Ok(self.answer(scene, found.as_ref(), steps))
    }

    /// At which translation do the bodies, as they are, first meet, if they do? Over all translations,
    /// behind and ahead: for "from here on" see [`Self::clearance`]. The tolerance plays no part.
    ///
    /// # Errors
    /// None at present: every search ends with an answer.
    pub fn first_contact(&self) -> Result<Outcome<Solid>, QueryError> {
        self.first_contact_in(&mut Workspace::default())
    }

    /// The same with a queue that is kept.
    ///
    /// # Errors
    /// As [`Self::first_contact`].
    pub fn first_contact_in(
        &self,
        workspace: &mut Workspace,
    ) -> Result<Outcome<Solid>, QueryError> {
        let (scene, mut steps) = (self.scene(0.0), SolidSteps::default());
        let found = first(&scene, Aim::Least, f64::INFINITY, workspace, &mut steps);
        Ok(match found {
            Some(found) => Outcome::Contact(contact(&scene, &found, found.bounded(&scene), steps)),
            None => Outcome::Separated(SolidFree { separation: separation(&scene), steps }),
        })
    }

    /// Where the bodies, as they are, first and last meet, each with its contact: two searches, along
    /// the direction and against it. In between they may part and meet again. The tolerance plays no
    /// part.
    ///
    /// # Errors
    /// None at present: every search ends with an answer.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::{Cast, ConvexPolyhedron, Pose};
    ///
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let start = Pose::from_translation(DVec3::new(-3.0, 0.5, 0.0))?;
    /// let cast = Cast::between(cube.at(start), cube.at(Pose::IDENTITY), DVec3::X)?;
    /// assert_eq!(cast.contact_range()?.interval(), Some([2.0, 4.0]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn contact_range(&self) -> Result<ContactRange<Solid>, QueryError> {
        let workspace = &mut Workspace::default();
        let first = self.first_contact_in(workspace)?;
        Ok(match (first, self.reversed().first_contact_in(workspace)?) {
            (Outcome::Contact(mut first), Outcome::Contact(mut last)) => {
                if let Some(both) = common_end(first.translation, last.exit()) {
                    (first.translation.value, last.translation.value) = (both, -both);
                }
                ContactRange::Contact { first, last }
            }
            (Outcome::Separated(free), _) | (_, Outcome::Separated(free)) => {
                ContactRange::Separated(free)
            }
        })
    }

    /// Where the moving body would be stopped if these two triangles, by their positions in
    /// [`Solid::triangles`], were all that there is of the bodies; `None` if they do not stop it. What
    /// blocks along one direction often does so along others too: then [`Self::clearance`] is no
    /// larger. Bodies count as overlapping only where [`SolidOptions::overlapping`] says so.
    pub fn stop_by(&self, triangles: [u32; 2]) -> Option<SolidContact> {
        if !self.has(triangles) {
            return None;
        }
        let scene = self.asked();
        let later = self.options.overlapping == Some(true)
            && self.options.start_overlap == StartOverlap::Ignore;
        let aim = if later { Aim::LaterStop } else { Aim::Stop };
        let search = Search::new(&scene, aim, self.limit(&scene), |_, _| ());
        let found = search.of_pair(triangles)?;
        // Nothing stops a body before 0.
        Some(contact(&scene, &found, found.bounded(&scene).clamped(), SolidSteps::default()))
    }

    /// Where two triangles of these bodies, as they are, meet that stop them after
    /// [`Solid::shrunk`]: what [`SolidContact::translation`] is to
    /// [`SolidContact::shrunk_distance`]. `shrunk` is how far the shrunk bodies go, `normal` that of
    /// their contact, and `shift` how far the contact point of the moving body was moved by shrinking,
    /// less that of the fixed body. `None` if there are no such triangles.
    pub fn true_place(
        &self,
        triangles: [u32; 2],
        shrunk: Bounded,
        normal: DVec3,
        shift: DVec3,
    ) -> Option<Bounded> {
        self.has(triangles).then(|| true_place(&self.scene(0.0), triangles, shrunk, normal, shift))
    }

    fn has(&self, triangles: [u32; 2]) -> bool {
        let counts = [self.moving(), self.fixed()].map(|solid| solid.triangles().len());
        triangles.into_iter().zip(counts).all(|(t, count)| (t as usize) < count)
    }

    /// Gaps from here on are of no interest, a length.
    pub(crate) fn limit(&self, scene: &Scene) -> f64 {
        self.options.before.map_or(f64::INFINITY, |t| t * scene.setting.length)
    }

    /// What is told of the clearance before any search, the same whether a proof is wanted or not: by boxes, then by
    /// hulls, then by the facets around the contact of those. The scene is made when it is asked for.
    fn told_at_once(
        &self,
        scene: &mut Option<Scene<'a>>,
        steps: &mut SolidSteps,
    ) -> Result<AtOnce, QueryError> {
        let by_boxes = self.told_by_boxes();
        if let boxes::Told::Passing(answer) = by_boxes {
            return Ok(AtOnce::Answer(answer));
        }
        // Where boxes touch, the bodies' exact places are asked before their hulls; where hulls overlap by little, facets.
        let touching = matches!(by_boxes, boxes::Told::Touching);
        let hulls = if touching { None } else { Hulls::of(self) };
        let in_doubt = touching || hulls.as_ref().is_some_and(Hulls::are_sunk);
        if !in_doubt && let Some(answer) = hulls.as_ref().and_then(|hulls| hulls.certain(self)) {
            return Ok(AtOnce::Answer(answer));
        }
        let scene = self.scene_once(scene)?;
        if touching && overlap::pass(scene, self.limit(scene)) {
            steps.nodes += 1;
            return Ok(AtOnce::Answer(self.answer(scene, None, *steps)));
        }
        let hulls = if touching { Hulls::of(self) } else { hulls };
        if let Some(place) = self.sunk(hulls.as_ref(), scene, steps) {
            return Ok(AtOnce::Overlapping(place));
        }
        let told = hulls.and_then(|hulls| {
            let certain = if in_doubt { hulls.certain(self) } else { None };
            certain.or_else(|| self.guessed_by_hulls(&hulls, scene))
        });
        Ok(told.map_or(AtOnce::Nothing, AtOnce::Answer))
    }

    /// The bodies shrunk by half the tolerance, which leaves something of them, made once.
    fn scene_once<'s>(
        &self,
        scene: &'s mut Option<Scene<'a>>,
    ) -> Result<&'s Scene<'a>, QueryError> {
        Ok(match scene {
            Some(scene) => scene,
            None => scene.insert(self.asked_of_something()?),
        })
    }

    /// Where the bodies overlap, if they do by little, by what is around a contact of their hulls.
    fn sunk(
        &self,
        hulls: Option<&Hulls>,
        scene: &Scene,
        steps: &mut SolidSteps,
    ) -> Option<Overlap> {
        if self.options.overlapping == Some(false) {
            return None;
        }
        hulls?.sunk(scene, &mut steps.leaves)
    }

    /// Where they overlap.
    fn place_of_overlap(&self, scene: &Scene, steps: &mut SolidSteps) -> Option<Overlap> {
        let sunk = self.sunk(Hulls::of(self).as_ref(), scene, steps);
        sunk.or_else(|| overlap::find(scene, steps))
    }

    fn guessed_by_hulls(&self, hulls: &Hulls, scene: &Scene) -> Option<Clearance<Solid>> {
        if let Some(answer) = hulls.touching(self, scene) {
            return Some(answer);
        }
        let mut steps = SolidSteps::default();
        Some(match hulls.guessed(scene, self.limit(scene), &mut steps.leaves)? {
            Guessed::Stop(found, least) => {
                let told = hulls.stopped_by(self, &found, least, steps);
                told.unwrap_or_else(|| self.answer(scene, Some(&found), steps))
            }
            Guessed::Free => self.answer(scene, None, steps),
        })
    }

    /// What a search has found, as an answer.
    pub(crate) fn answer(
        &self,
        scene: &Scene,
        found: Option<&Found>,
        steps: SolidSteps,
    ) -> Clearance<Solid> {
        let Some(found) = found else {
            let to_the_end = self.options.before.is_none();
            let separation = to_the_end.then(|| separation(scene)).flatten();
            return Clearance::Free(SolidFree { separation, steps });
        };
        // Nothing stops a body before 0.
        let contact = contact(scene, found, found.bounded(scene).clamped(), steps);
        Clearance::Blocked { distance: contact.translation.lower.max(0.0), contact }
    }

    #[doc(hidden)]
    #[inline]
    pub fn overlap_at(&self, place: Overlap, mut steps: SolidSteps) -> SolidOverlap {
        let least_tolerance = self.least_tolerance_from(Some(place), &mut steps);
        SolidOverlap { place, least_tolerance, steps }
    }

    /// Whether the interiors of the bodies, shrunk by half the tolerance, have a point in common, or open
    /// shells pass through what is there.
    pub fn overlaps(&self) -> bool {
        overlap::find(&self.asked(), &mut SolidSteps::default()).is_some()
    }

    /// Where the bodies, shrunk by half the tolerance, overlap, and by how much; `None` if they do not:
    /// what [`Clearance::Overlapping`] tells, and what an answer with [`StartOverlap::Ignore`] has
    /// ignored. It costs several times as much as [`Self::overlaps`], for the least tolerance.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::solid::{Overlap, StartOverlap};
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
    pub fn start_overlap(&self) -> Option<SolidOverlap> {
        let mut steps = SolidSteps::default();
        let place = self.place_of_overlap(&self.asked(), &mut steps)?;
        Some(self.overlap_at(place, steps))
    }

    /// Whether the bodies as they are, as closed sets, have a point in common, and where. Neither the
    /// direction nor the tolerance plays a part.
    ///
    /// # Errors
    /// None at present: every search ends with an answer.
    pub fn intersects(&self) -> Result<Intersection<Solid>, QueryError> {
        let mut steps = SolidSteps::default();
        let place = overlap::touch(&self.scene(0.0), &mut steps);
        let evidence = SolidMeeting { place, steps };
        Ok(Intersection { meets: place.is_some(), evidence })
    }

    /// The translation after which the bodies, as they are, never meet again, in multiples of the
    /// direction: the last contact of [`Self::contact_range`] alone, and 0 if it lies behind; `None` if
    /// they never meet. Beyond `upper` they are apart for certain.
    pub fn exit(&self) -> Option<Bounded> {
        self.exit_in(&mut Workspace::default())
    }

    /// The same with a queue that is kept.
    pub fn exit_in(&self, workspace: &mut Workspace) -> Option<Bounded> {
        let scene = self.reversed().scene(0.0);
        let steps = &mut SolidSteps::default();
        let found = first(&scene, Aim::Least, f64::INFINITY, workspace, steps)?;
        Some(found.bounded(&scene).negated().clamped())
    }
}

/// The tolerance of bodies for which none was given, whose matrices permute axes, or not.
fn default_tolerance(permuted: bool, noise: f64) -> f64 {
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
