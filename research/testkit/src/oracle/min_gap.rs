//! Judges casts with a minimum gap, and casts of rounded bodies, in exact arithmetic.
//!
//! Notation. `D(t)` is the distance of the cores of the bodies after a translation by `t d`, a convex function, from
//! [`distance()`]. `g` is the gap of the cores: the minimum gap plus both radii. Bodies that are not rounded are
//! their own cores. `m` the distance of the bodies' shadows along `d`, the minimum of `D`.
//! All numbers of an answer or proof are taken as exact.
//!
//! - *Contact.* `D(lower) >= g >= D(upper)` and `lower <= upper`. Because `D` is convex, the first `t` with
//!   `D(t) <= g` is between them, and no value before `lower` needs to be checked.
//! - *Plane.* `min_Q n.q - max_P n.p - lower n.d >= g |n|`, compared as squares.
//! - *Separation.* `m > g`, and the plane proves it.
//! - `m` determines the outcome, up to what rounding may decide.

use colltrans::{Cast, Clearance, Contact, FreeReason, Outcome, Separation};
use glam::DVec3;

use crate::oracle::check::{Objection, require};
use crate::oracle::distance::{distance, gap_along};
use crate::oracle::exact::{Dyadic, Ratio, Vector, place};
use crate::oracle::scene::size;

/// Maximum number of noises by which rounding may change the outcome given by the shadows.
const UNSURE: f64 = 12.0;

/// The exact data of a cast, with which answers are compared.
#[derive(Debug)]
pub struct GapJudge<'a> {
    cast: Cast<'a>,
    /// The exact gap of the cores.
    gap: Dyadic,
    /// The sum of the radii, exact.
    radii: Dyadic,
    /// The gap of the cores, rounded.
    min_gap: f64,
    moving: Vec<Vector>,
    fixed: Vec<Vector>,
    /// The distance of the shadows.
    pub shadows: f64,
    /// The noise of the library, for the size including the gap.
    pub noise: f64,
}

/// The difference of the bounds of a contact.
#[derive(Debug, Clone, Copy, Default)]
pub struct Width {
    /// The difference of the bounds, in noises over `n.d`.
    pub noises: f64,
}

impl<'a> GapJudge<'a> {
    /// Computes the exact data of a cast.
    pub fn new(cast: Cast<'a>) -> Self {
        let [p, q] = [cast.moving_pose(), cast.fixed_pose()];
        let moving = place(p.matrix(), p.translation(), cast.moving().vertices());
        let fixed = place(q.matrix(), q.translation(), cast.fixed().vertices());
        let [r, s] = [cast.moving(), cast.fixed()].map(|body| Dyadic::new(body.radius()));
        let radii = &r + &s;
        let gap = &Dyadic::new(cast.options().min_gap) + &radii;
        let min_gap = gap.to_f64();
        let size = size([cast.moving().vertices(), cast.fixed().vertices()], [&p, &q]) + min_gap;
        let noise = 16.0 * f64::EPSILON * size.max(colltrans::MIN_MAGNITUDE);
        let shadows = distance_of_shadows(&moving, &fixed, cast.direction());
        Self { cast, gap, radii, min_gap, moving, fixed, shadows, noise }
    }

    /// Checks an outcome with its proof. Returns the difference of its bounds.
    ///
    /// # Errors
    /// [`Objection`] with the first statement that is false.
    pub fn check(&self, outcome: &Outcome) -> Result<Width, Objection> {
        let (m, g) = (self.shadows, self.min_gap);
        let tolerance = self.cast.options().graze_tolerance.max(8.0 * self.noise);
        let unsure = UNSURE * self.noise;
        match outcome {
            Outcome::Contact(contact) => {
                require!(m <= g + unsure, "a contact, and the shadows are {m:e} apart");
                require!(contact.certificate.upper.is_finite(), "a contact without an end");
                self.check_contact(&self.cast, contact)
            }
            Outcome::Grazing(of) => {
                require!(m <= g + unsure, "grazing, and the shadows are {m:e} apart");
                let all = m == 0.0 || m >= g - tolerance - unsure;
                require!(all, "grazing, and the shadows are {m:e} apart");
                self.check_contact(&self.cast, &of.contact).map(|_| Width::default())
            }
            Outcome::Separated(of) => {
                require!(m >= g, "separated, and the shadows are {m:e} apart");
                self.check_separation(&of.certificate)?;
                Ok(Width::default())
            }
        }
    }

    /// Checks a clearance with its proof.
    ///
    /// # Errors
    /// [`Objection`] with the first statement that is false.
    pub fn check_clearance(&self, clearance: &Clearance) -> Result<(), Objection> {
        let back = self.cast.reversed();
        let now = self.distance_at(&self.cast, 0.0);
        let gap = self.square_of_gap();
        match clearance {
            Clearance::Blocked { distance, contact } => {
                self.check_contact(&self.cast, contact)?;
                require!(*distance == contact.certificate.lower.max(0.0), "another distance");
            }
            Clearance::Free(FreeReason::Slides(of)) => {
                self.check_contact(&self.cast, &of.contact)?;
            }
            Clearance::Free(FreeReason::Separated(of)) => self.check_separation(&of.certificate)?,
            Clearance::Free(FreeReason::Behind(last)) => {
                self.check_contact(&back, last)?;
                require!(last.translation >= -last.certificate.rounding, "the end lies ahead");
            }
            Clearance::Overlapping(of) => {
                self.check_contact(&self.cast, &of.first)?;
                self.check_contact(&back, &of.last)?;
                let nearer = now < gap || self.is_slight() && now <= gap;
                require!(nearer, "not nearer than the gap, but reported as nearer");
            }
        }
        Ok(())
    }

    /// Checks a contact with its proof.
    fn check_contact(&self, cast: &Cast, contact: &Contact) -> Result<Width, Objection> {
        let proof = contact.certificate;
        let [lower, upper] = [proof.lower, proof.upper];
        let t = contact.translation;
        require!(lower <= t && t <= upper, "{lower:e} <= {t:e} <= {upper:e} does not hold");
        let gap = self.square_of_gap();
        require!(self.distance_at(cast, lower) >= gap, "nearer than the gap at {lower:e}");
        self.check_plane(cast, proof.normal, lower)?;
        let verified = cast.verify(&proof).map_err(|e| Objection(e.to_string()))?;
        if !upper.is_finite() {
            return Ok(Width::default());
        }
        // For a gap below the noise, the end is that of the nominal bodies, which thin bodies may already have
        // left.
        let near = self.is_slight() || self.distance_at(cast, upper) <= gap;
        require!(near, "not as near as the gap at {upper:e}");
        require!(verified.is_finite(), "no end is verified");
        let slope = proof.normal.dot(cast.direction());
        Ok(Width { noises: (upper - lower) * slope / self.noise })
    }

    /// Checks whether the gap is below the touching distance. Then the upper bound is judged as that of an
    /// ordinary cast.
    fn is_slight(&self) -> bool {
        self.min_gap <= 8.0 * self.noise
    }

    /// Returns the exact square of the gap of the cores.
    fn square_of_gap(&self) -> Ratio {
        Ratio::new(&self.gap * &self.gap, Dyadic::new(1.0))
    }

    /// Returns the squared distance after a translation.
    fn distance_at(&self, cast: &Cast, t: f64) -> Ratio {
        let by = Vector::new(cast.direction()).times(&Dyadic::new(t));
        let moved: Vec<Vector> = self.moving.iter().map(|p| p.plus(&by)).collect();
        distance(&moved, &self.fixed).square
    }

    /// Checks that a plane proves a lower bound.
    fn check_plane(&self, cast: &Cast, normal: DVec3, lower: f64) -> Result<(), Objection> {
        let n = Vector::new(normal);
        let along = n.dot(&Vector::new(cast.direction()));
        require!(along.is_positive(), "the normal {normal} is not along the direction");
        let left = &gap_along([&self.moving, &self.fixed], &n) - &(&along * &Dyadic::new(lower));
        let proven = !left.is_negative() && &left * &left >= &(&self.gap * &self.gap) * &n.dot(&n);
        require!(proven, "the plane does not prove {lower:e}");
        Ok(())
    }

    /// Checks that a plane proves a separation.
    fn check_separation(&self, of: &Separation) -> Result<(), Objection> {
        let n = Vector::new(of.normal);
        let along = gap_along([&self.moving, &self.fixed], &n);
        let square_along = |gap: &Dyadic| &(gap * gap) * &n.dot(&n);
        if self.radii.is_zero() {
            require!(Dyadic::new(of.margin) <= along, "a margin of {:e}", of.margin);
        } else {
            let claimed = square_along(&(&Dyadic::new(of.margin) + &self.radii));
            require!(&along * &along >= claimed, "a margin of {:e}", of.margin);
        }
        require!(of.margin > self.cast.options().min_gap, "a margin that is not above the gap");
        let beyond = along.is_positive() && &along * &along > square_along(&self.gap);
        require!(beyond, "a plane no farther off than the gap");
        self.cast.verify(of).map_err(|e| Objection(e.to_string()))?;
        Ok(())
    }
}

/// Returns the distance of the shadows along a direction, rounded once.
fn distance_of_shadows(moving: &[Vector], fixed: &[Vector], direction: DVec3) -> f64 {
    // Scaled to a length near 1, so that squares are in range.
    let scale = 2.0_f64.powi(-(direction.abs().max_element().log2().floor() as i32));
    let d = Vector::new(direction * scale);
    let square = d.dot(&d);
    let flat = |points: &[Vector]| -> Vec<Vector> {
        points.iter().map(|p| p.times(&square).minus(&d.times(&p.dot(&d)))).collect()
    };
    distance(&flat(moving), &flat(fixed)).to_f64() / square.to_f64()
}
