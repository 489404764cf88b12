//! How far a solid can move from where it is.
//!
//! With a tolerance `L` both bodies are shrunk by `L / 2`. If their interiors then share a point, they
//! overlap, and the depth is the least tolerance with which they do not, from above: doubled until
//! there is one, then halved between the two.

mod proof;
#[cfg(feature = "serde")]
mod saved;
mod verify;

use glam::DVec3;

use super::Cast;
use crate::answer::{Bounded, Clearance, Separation};
use crate::body::solid::{AsSolid, Solid};
use crate::body::{Body, Placed, Pose};
use crate::setting::error::QueryError;
use crate::solve::solid::contact::{SolidContact, contact, true_place};
use crate::solve::solid::overlap::{self, Overlap};
use crate::solve::solid::scene::Scene;
use crate::solve::solid::search::{Aim, Found, Search, Workspace};
use crate::solve::solid::separate::separation;
pub use proof::{Claim, Cover, SolidCertificate, StartProof, StopProof};
pub use verify::SolidProof;

/// Default tolerance, in multiples of the rounding error of a coordinate.
const NOISES: f64 = 8.0;
/// The depth is found to this share of itself.
const DEPTH_ACCURACY: f64 = 1e-12;
/// Doublings and halvings of a tolerance.
const MOST_HALVINGS: usize = 128;

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

/// Choices of a query between solids.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SolidOptions {
    /// What an overlap at the start means.
    pub start_overlap: StartOverlap,
    /// Both bodies are shrunk by half of this length. `None` stands for 0 where both poses turn by
    /// quarter turns, and else for what rounding can do to a fit, `256 u S`.
    pub tolerance: Option<f64>,
    /// Contacts at this translation or beyond are of no interest: the best answer so far, where one
    /// body is asked against many.
    pub before: Option<f64>,
    /// Whether the bodies overlap where they are: what [`Cast::overlaps`] has said of the same
    /// bodies, poses and tolerance. Whoever asks one pair along many directions asks once. `None`:
    /// it is looked at, as is an overlap that is the answer, to be named.
    pub overlapping: Option<bool>,
}

/// The overlap of two solids.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SolidOverlap {
    /// One of the places where the bodies, shrunk by half the tolerance each, overlap: facets that
    /// cross, or a shell that is inside.
    pub place: Overlap,
    /// The least tolerance with which they would not overlap, from above; `None` if there is none, as
    /// where what overlaps is an open shell: see [`Cast::depth`].
    pub depth: Option<f64>,
}

impl Body for Solid {
    type Options = SolidOptions;
    type Contact = SolidContact;
    /// A plane between the bodies, parallel to the direction, where there is one that rounding can
    /// tell; not looked for where a query ends at [`SolidOptions::before`].
    type Free = Option<Separation>;
    type Overlap = SolidOverlap;
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
    /// A direction that is zero, not finite or out of range; a point or a segment.
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
    /// let distance = down.clearance().distance().expect("the step is below");
    /// assert!(distance <= 2.0 && distance > 2.0 - 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn between<A: AsSolid, B: AsSolid>(
        moving: Placed<'a, A>,
        fixed: Placed<'a, B>,
        direction: DVec3,
    ) -> Result<Self, QueryError> {
        let (a, b) = (moving.body.as_solid()?, fixed.body.as_solid()?);
        Cast::new(a.at(moving.pose), b.at(fixed.pose), direction)
    }

    /// The same with other choices.
    ///
    /// # Errors
    /// A tolerance that is negative or not finite.
    pub fn with_options(self, options: SolidOptions) -> Result<Self, QueryError> {
        if let Some(tolerance) = options.tolerance
            && !(tolerance.is_finite() && tolerance >= 0.0)
        {
            return Err(QueryError::Tolerance { tolerance });
        }
        Ok(Self { options, ..self })
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
    /// A tolerance that is negative or not finite.
    pub fn with_tolerance(self, tolerance: f64) -> Result<Self, QueryError> {
        self.with_options(SolidOptions { tolerance: Some(tolerance), ..self.options })
    }

    /// The same with another meaning of an overlap at the start.
    #[must_use]
    pub fn with_start_overlap(self, start_overlap: StartOverlap) -> Self {
        Self { options: SolidOptions { start_overlap, ..self.options }, ..self }
    }

    /// The tolerance that is used, as a length.
    pub fn tolerance(&self) -> f64 {
        self.options.tolerance.unwrap_or_else(|| {
            let scene = self.scene(0.0);
            let squared = scene.moving.permutes && scene.fixed.permutes;
            if squared { 0.0 } else { NOISES * scene.noise }
        })
    }

    pub(crate) fn scene(&self, tolerance: f64) -> Scene<'a> {
        Scene::new(&self.setting, [tolerance / 2.0; 2])
    }

    pub(crate) fn asked(&self) -> Scene<'a> {
        self.scene(self.tolerance())
    }

    /// How far the moving body can move from where it is.
    ///
    /// Free says without telling them apart that it slides along, moves away from or never meets the
    /// other body; where a plane lies between the two, it comes with it.
    pub fn clearance(&self) -> Clearance<Solid> {
        self.clearance_in(&mut Workspace::default())
    }

    /// The same with a queue that is kept.
    pub fn clearance_in(&self, workspace: &mut Workspace) -> Clearance<Solid> {
        let scene = self.asked();
        let ignored = self.options.start_overlap == StartOverlap::Ignore;
        let aim = match self.options.overlapping {
            Some(false) => Aim::Stop,
            Some(true) if ignored => Aim::LaterStop,
            _ => match overlap::find(&scene) {
                Some(_) if ignored => Aim::LaterStop,
                Some(place) => {
                    let depth = self.depth();
                    return Clearance::Overlapping(SolidOverlap { place, depth });
                }
                None => Aim::Stop,
            },
        };
        let found = first(&scene, aim, self.limit(&scene), workspace);
        self.answer(&scene, found.as_ref())
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
        Some(contact(&scene, &found, self.moving_pose().translation()))
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

    /// What a search has found, as an answer.
    pub(crate) fn answer(&self, scene: &Scene, found: Option<&Found>) -> Clearance<Solid> {
        match found {
            None if self.options.before.is_none() => Clearance::Free(separation(scene)),
            None => Clearance::Free(None),
            Some(found) => {
                let contact = contact(scene, found, self.moving_pose().translation());
                Clearance::Blocked { distance: contact.translation.lower.max(0.0), contact }
            }
        }
    }

    /// Whether the interiors of the bodies, shrunk by half the tolerance, have a point in common, or open
    /// shells pass through what is there.
    pub fn overlaps(&self) -> bool {
        overlap::find(&self.asked()).is_some()
    }

    /// Where the bodies, shrunk by half the tolerance, overlap, and how deep; `None` if they do not:
    /// what [`Clearance::Overlapping`] tells, and what an answer with [`StartOverlap::Ignore`] has
    /// ignored. It costs some fifty times as much as [`Self::overlaps`], for the depth.
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
    /// assert!(aside.clearance().is_free());
    /// let ignored = aside.start_overlap().expect("the plate is pressed into the table");
    /// assert!(matches!(ignored.place, Overlap::Facets(_, _)));
    /// assert!((ignored.depth.expect("a tolerance") - 0.125).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn start_overlap(&self) -> Option<SolidOverlap> {
        let place = overlap::find(&self.asked())?;
        Some(SolidOverlap { place, depth: self.depth() })
    }

    /// Whether the bodies as they are, as closed sets, have a point in common.
    pub fn intersects(&self) -> bool {
        overlap::touches(&self.scene(0.0))
    }

    /// The least tolerance with which the bodies do not overlap, from above: 0 if they do not, `None`
    /// if there is none up to their size. Nor is there one where they overlap and one of them has open
    /// shells: less of a solid does not free a sheet that passes through it.
    pub fn depth(&self) -> Option<f64> {
        let bare = self.scene(0.0);
        if overlap::find(&bare).is_none() {
            return Some(0.0);
        }
        if !(self.moving().is_closed() && self.fixed().is_closed()) {
            return None;
        }
        let free = |tolerance: f64| {
            let half = tolerance / 2.0;
            overlap::find(&bare.shrunk(half, half)).is_none()
        };
        let (mut low, mut high) = (0.0, bare.noise);
        while !free(high) {
            (low, high) = (high, 2.0 * high);
            if high > bare.size() {
                return None;
            }
        }
        for _ in 0..MOST_HALVINGS {
            let middle = low + 0.5 * (high - low);
            if high - low <= DEPTH_ACCURACY * high || middle <= low || middle >= high {
                break;
            }
            if free(middle) { high = middle } else { low = middle }
        }
        Some(high)
    }

    /// The translation after which the bodies, as they are, never meet again, in multiples of the
    /// direction: the largest gap between a back facet of the moving and a front facet of the fixed
    /// body; `None` if none face each other. Beyond `upper` they are apart for certain.
    pub fn exit(&self) -> Option<Bounded> {
        self.exit_in(&mut Workspace::default())
    }

    /// The same with a queue that is kept.
    pub fn exit_in(&self, workspace: &mut Workspace) -> Option<Bounded> {
        let scene = self.scene(0.0).reversed();
        let found = first(&scene, Aim::Least, f64::INFINITY, workspace)?;
        Some(found.bounded(&scene).negated().clamped())
    }

    /// Pairs of nodes and of leaves that a search for the clearance looks at.
    pub fn steps(&self) -> [u32; 2] {
        let scene = self.asked();
        let mut search = Search::new(&scene, Aim::Stop, f64::INFINITY, |_, _| ());
        search.run(&mut Workspace::default());
        search.steps
    }
}

/// The least gap below a limit.
fn first(scene: &Scene, aim: Aim, limit: f64, workspace: &mut Workspace) -> Option<Found> {
    Search::new(scene, aim, limit, |_, _| ()).run(workspace)
}
