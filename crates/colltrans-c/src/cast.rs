//! Casts: two placed bodies and a direction.

use colltrans::glam::DVec3;
use colltrans::solid::{SolidOptions, StartOverlap};
use colltrans::{ByKind, Cast, Options, Placed, Solid, Solver};

use crate::answer::CastAnswer;
use crate::body::{Body, Placement, Pose, placed};
use crate::error::{Failure, Fallible, Output, Status, found, guard, optional, vector};
use crate::{COLLTRANS_SOLVER_AUTO, COLLTRANS_SOLVER_CTA, COLLTRANS_SOLVER_PORTAL};

/// Options of a cast or a motion. A zeroed struct has the defaults, and so has a null pointer.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct CastOptions {
    /// Minimum gap, a length: the bodies stop when their distance falls to it.
    pub min_gap: f64,
    /// Convex bodies that overlap sideways by at most this length slide along each other.
    pub graze_tolerance: f64,
    /// Solids are shrunk by half of this length each, if `has_tolerance` is not 0. Otherwise the tolerance is that of
    /// rounding. For a motion of convex bodies, the depth to which they may overlap.
    pub tolerance: f64,
    /// End of the clearance of solids and in scenes, if `has_before` is not 0: contacts from this translation on do not
    /// stop the body, and the clearance is at most this translation. Other queries of solids do not use it.
    pub before: f64,
    /// Whether `tolerance` is set.
    pub has_tolerance: u32,
    /// Whether `before` is set.
    pub has_before: u32,
    /// Whether the clearance of solids ignores facets that cross at the start.
    pub ignore_start_overlap: u32,
    /// Solver of convex bodies: `COLLTRANS_SOLVER_AUTO` (0), `COLLTRANS_SOLVER_CTA` or `COLLTRANS_SOLVER_PORTAL`.
    pub solver: u32,
    /// Whether casts of convex bodies compute the features in contact. Those of solids are always computed.
    pub features: u32,
}

/// A cast of two convex bodies or of two solids.
pub(crate) type AnyCast<'a> = ByKind<Cast<'a>, Cast<'a, Solid>>;

/// Rejects an option that the query does not have.
#[inline]
pub(crate) fn reject(is_set: bool, name: &str, query: &str) -> Fallible<()> {
    let what =
        || Failure::invalid(&format!("options.{name}"), format_args!("{query} has no such option"));
    if is_set { Err(what()) } else { Ok(()) }
}

impl CastOptions {
    /// The defaults.
    pub(crate) const DEFAULT: Self = Self {
        min_gap: 0.0,
        graze_tolerance: 0.0,
        tolerance: 0.0,
        before: 0.0,
        has_tolerance: 0,
        has_before: 0,
        ignore_start_overlap: 0,
        solver: 0,
        features: 0,
    };

    /// Reads the options of the argument called `options`.
    #[inline]
    pub(crate) unsafe fn read<'a>(pointer: *const Self) -> Fallible<&'a Self> {
        // SAFETY: the caller keeps the invariants of the crate.
        Ok(unsafe { optional(pointer, "options") }?.unwrap_or(&Self::DEFAULT))
    }

    /// Returns the tolerance, if it is set.
    pub(crate) fn tolerance(&self) -> Fallible<Option<f64>> {
        if self.has_tolerance == 0 {
            return Ok(None);
        }
        if !(self.tolerance >= 0.0 && self.tolerance.is_finite()) {
            let what = format_args!("{} is negative or not finite", self.tolerance);
            return Err(Failure::invalid("options.tolerance", what));
        }
        Ok(Some(self.tolerance))
    }

    /// Returns the end of a clearance, if it is set.
    pub(crate) fn before(&self) -> Fallible<Option<f64>> {
        if self.has_before == 0 {
            return Ok(None);
        }
        if self.before.is_nan() || self.before < 0.0 {
            let what = format_args!("{} is negative or not a number", self.before);
            return Err(Failure::invalid("options.before", what));
        }
        Ok(Some(self.before))
    }

    pub(crate) fn start_overlap(&self) -> StartOverlap {
        if self.ignore_start_overlap == 0 { StartOverlap::Refuse } else { StartOverlap::Ignore }
    }

    /// Returns the options of casts of convex bodies.
    #[inline]
    pub(crate) fn convex(&self) -> Fallible<Options> {
        let solver = match self.solver {
            COLLTRANS_SOLVER_AUTO => Solver::Auto,
            COLLTRANS_SOLVER_CTA => Solver::Cta,
            COLLTRANS_SOLVER_PORTAL => Solver::Portal,
            other => {
                let what = format_args!("unknown solver {other}; accepted: 0, 1 and 2");
                return Err(Failure::invalid("options.solver", what));
            }
        };
        let options = Options::default().with_solver(solver).with_min_gap(self.min_gap);
        Ok(options.with_graze_tolerance(self.graze_tolerance))
    }

    /// Returns the options of casts of solids.
    pub(crate) fn solid(&self) -> Fallible<SolidOptions> {
        let options = SolidOptions::default()
            .with_tolerance(self.tolerance()?)
            .with_before(self.before()?)
            .with_min_gap(self.min_gap);
        Ok(options.with_start_overlap(self.start_overlap()))
    }

    #[cold]
    fn reject_options_of_solids(&self) -> Fallible<()> {
        let convex = "a cast of convex bodies";
        reject(self.has_tolerance != 0, "tolerance", convex)?;
        reject(self.has_before != 0, "before", convex)?;
        reject(self.ignore_start_overlap != 0, "ignore_start_overlap", convex)
    }

    /// Builds the cast of two placed convex bodies.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory costs as much as the call")]
    pub(crate) fn convex_cast<'a>(
        &self,
        [moving, fixed]: [Placed<'a>; 2],
        direction: DVec3,
    ) -> Fallible<Cast<'a>> {
        if self.has_tolerance | self.has_before | self.ignore_start_overlap != 0 {
            self.reject_options_of_solids()?;
        }
        let cast = Cast::new(moving, fixed, direction)?;
        // The defaults are valid, and are set already.
        let is_default = self.min_gap == 0.0 && self.graze_tolerance == 0.0 && self.solver == 0;
        Ok(if is_default { cast } else { cast.with_options(self.convex()?)? })
    }

    /// Builds the cast of two placed bodies. If one of them is a solid, both are treated as solids.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory costs as much as the call")]
    pub(crate) fn cast<'a>(
        &self,
        bodies: &Placement<'a>,
        direction: DVec3,
    ) -> Fallible<AnyCast<'a>> {
        if let Some(bodies) = bodies.convex() {
            return Ok(ByKind::Convex(self.convex_cast(bodies, direction)?));
        }
        let solids = "a cast of solids";
        reject(self.graze_tolerance != 0.0, "graze_tolerance", solids)?;
        reject(self.solver != 0, "solver", solids)?;
        let [moving, fixed] = bodies.solids()?;
        let cast = Cast::new(moving, fixed, direction)?;
        Ok(ByKind::Solid(cast.with_options(self.solid()?)?))
    }
}

/// A query of a cast.
#[derive(Debug, Clone, Copy)]
pub(crate) enum CastQuery {
    FirstContact,
    ContactRange,
    Clearance,
}

impl CastQuery {
    /// Answers the query.
    #[inline]
    pub(crate) unsafe fn answer(
        self,
        cast: &AnyCast<'_>,
        featured: bool,
        to: Output<CastAnswer>,
    ) -> Fallible<()> {
        // SAFETY: the caller passes memory for the answer.
        let none = || unsafe { to.set(CastAnswer::NONE) };
        match (self, cast) {
            (Self::FirstContact, ByKind::Convex(cast)) => {
                let outcome = cast.first_contact();
                let outcome = found(&outcome)?;
                none().set_outcome(outcome, cast, featured);
            }
            (Self::ContactRange, ByKind::Convex(cast)) => {
                let range = cast.contact_range();
                let range = found(&range)?;
                none().set_range(range, cast, featured);
            }
            (Self::Clearance, ByKind::Convex(cast)) => {
                let clearance = cast.clearance();
                let clearance = found(&clearance)?;
                none().set_clearance(clearance, cast, featured);
            }
            (Self::FirstContact, ByKind::Solid(cast)) => {
                let outcome = cast.first_contact();
                let outcome = found(&outcome)?;
                none().set_solid_outcome(outcome, cast);
            }
            (Self::ContactRange, ByKind::Solid(cast)) => {
                let range = cast.contact_range();
                let range = found(&range)?;
                none().set_solid_range(range, cast);
            }
            (Self::Clearance, ByKind::Solid(cast)) => {
                let clearance = cast.clearance();
                let clearance = found(&clearance)?;
                none().set_solid_clearance(clearance, cast);
            }
        }
        Ok(())
    }
}

/// Answers a query about two placed bodies.
#[inline(always)]
#[expect(clippy::inline_always, reason = "the query is a constant of each entry point")]
unsafe fn answer(
    query: CastQuery,
    [moving, fixed]: [*const Body; 2],
    [moving_pose, fixed_pose]: [*const Pose; 2],
    direction: *const f64,
    options: *const CastOptions,
    answer: *mut CastAnswer,
) -> Status {
    guard(move || unsafe {
        let answer = Output::new(answer, "answer")?;
        let bodies = placed(moving, moving_pose, fixed, fixed_pose)?;
        let direction = vector(direction, "direction")?;
        let options = CastOptions::read(options)?;
        let cast = options.cast(&bodies, direction)?;
        query.answer(&cast, options.features != 0, answer)
    })
}

/// Finds the first translation at which the bodies meet. It is negative for a contact behind the moving body or an
/// overlap at the start. Null poses are the identity, null options the defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_first_contact(
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    direction: *const f64,
    options: *const CastOptions,
    answer: *mut CastAnswer,
) -> Status {
    let (bodies, poses) = ([moving, fixed], [moving_pose, fixed_pose]);
    unsafe { self::answer(CastQuery::FirstContact, bodies, poses, direction, options, answer) }
}

/// Finds the first contact and the last one, after which the bodies never meet (`exit`).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_contact_range(
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    direction: *const f64,
    options: *const CastOptions,
    answer: *mut CastAnswer,
) -> Status {
    let (bodies, poses) = ([moving, fixed], [moving_pose, fixed_pose]);
    unsafe { self::answer(CastQuery::ContactRange, bodies, poses, direction, options, answer) }
}

/// Finds how far the moving body can move from its pose, and what stops it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_clearance(
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    direction: *const f64,
    options: *const CastOptions,
    answer: *mut CastAnswer,
) -> Status {
    let (bodies, poses) = ([moving, fixed], [moving_pose, fixed_pose]);
    unsafe { self::answer(CastQuery::Clearance, bodies, poses, direction, options, answer) }
}

/// Checks whether the bodies have a common point in their poses, or are within the minimum gap of the options. Writes 1
/// or 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_intersects(
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    options: *const CastOptions,
    meets: *mut u32,
) -> Status {
    guard(move || unsafe {
        let meets = Output::new(meets, "meets")?;
        let bodies = placed(moving, moving_pose, fixed, fixed_pose)?;
        // The answer does not depend on the direction.
        let meet = match CastOptions::read(options)?.cast(&bodies, DVec3::Z)? {
            ByKind::Convex(cast) => cast.intersects()?.meets,
            ByKind::Solid(cast) => cast.intersects()?.meets,
        };
        meets.set(u32::from(meet));
        Ok(())
    })
}
