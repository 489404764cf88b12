//! Judges casts that keep a gap, in exact arithmetic.
//!
//! Notation: `D(t)` is the distance of the bodies after a translation by `t d`, a convex function, from
//! [`distance()`]; `g` is the gap, `m` the distance of the bodies' shadows along `d`, the least `D`. All numbers of an answer and of a
//! proof are taken as exact.
//!
//! - *Contact.* `D(lower) >= g >= D(upper)` and `lower <= upper`: as `D` is convex, the first `t` with `D(t) <= g` lies
//!   between them, and nothing before `lower` has to be looked at.
//! - *Plane.* `min_Q n.q - max_P n.p - lower n.d >= g |n|`, as squares.
//! - *Apart.* `m > g`, and the plane says so.
//! - Which of them it is, is for `m` to say, to within what rounding may decide.

use colltrans::{Cast, Clearance, Contact, Outcome, Separation, WhyFree};
use glam::DVec3;

use crate::oracle::check::Objection;
use crate::oracle::distance::distance;
use crate::oracle::exact::{Dyadic, Ratio, Vector, place};
use crate::oracle::scene::size;

macro_rules! require {
    ($condition:expr, $($text:tt)+) => {
        let holds: bool = $condition;
        if !holds {
            return Err(Objection(format!($($text)+)));
        }
    };
}

/// How many noises rounding may take an outcome from what the shadows say.
const UNSURE: f64 = 12.0;

/// The truth about a cast.
#[derive(Debug)]
pub struct Judge<'a> {
    cast: Cast<'a>,
    keep: f64,
    moving: Vec<Vector>,
    fixed: Vec<Vector>,
    /// The distance of the shadows.
    pub shadows: f64,
    /// What the library states as its rounding error, of the size with the gap.
    pub noise: f64,
}

/// What was seen of a contact's bounds.
#[derive(Debug, Clone, Copy, Default)]
pub struct Width {
    /// How far they are apart, in noises over `n.d`.
    pub noises: f64,
}

impl<'a> Judge<'a> {
    /// Of answers to a cast.
    pub fn new(cast: Cast<'a>) -> Self {
        let [p, q] = [cast.moving_pose(), cast.fixed_pose()];
        let moving = place(p.matrix(), p.translation(), cast.moving().vertices());
        let fixed = place(q.matrix(), q.translation(), cast.fixed().vertices());
        let keep = cast.options().keep;
        let size = size([cast.moving().vertices(), cast.fixed().vertices()], [&p, &q]) + keep;
        let noise = 16.0 * f64::EPSILON * size.max(colltrans::MIN_MAGNITUDE);
        let shadows = shadows(&moving, &fixed, cast.direction());
        Self { cast, keep, moving, fixed, shadows, noise }
    }

    /// Everything that an outcome says; how far apart its bounds are.
    ///
    /// # Errors
    /// The first statement of it that is not true.
    pub fn check(&self, outcome: &Outcome) -> Result<Width, Objection> {
        let (m, g) = (self.shadows, self.keep);
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

    /// The same of a clearance.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn check_clearance(&self, clearance: &Clearance) -> Result<(), Objection> {
        let back = self.cast.reversed();
        let now = self.distance_at(&self.cast, 0.0);
        let gap = square(self.keep);
        match clearance {
            Clearance::Blocked { distance, contact } => {
                self.check_contact(&self.cast, contact)?;
                require!(*distance == contact.certificate.lower.max(0.0), "another distance");
            }
            Clearance::Free(WhyFree::Slides(of)) => {
                self.check_contact(&self.cast, &of.contact)?;
            }
            Clearance::Free(WhyFree::Separated(of)) => self.check_separation(&of.certificate)?,
            Clearance::Free(WhyFree::Behind(last)) => {
                self.check_contact(&back, last)?;
                require!(last.translation >= -last.certificate.rounding, "the end lies ahead");
            }
            Clearance::Overlapping(of) => {
                self.check_contact(&self.cast, &of.first)?;
                self.check_contact(&back, &of.last)?;
                let nearer = now < gap || self.is_slight() && now <= gap;
                require!(nearer, "as far apart as the gap, and nearer is said");
            }
        }
        Ok(())
    }

    fn check_contact(&self, cast: &Cast, contact: &Contact) -> Result<Width, Objection> {
        let proof = contact.certificate;
        let [lower, upper] = [proof.lower, proof.upper];
        let t = contact.translation;
        require!(lower <= t && t <= upper, "{lower:e} <= {t:e} <= {upper:e} does not hold");
        let gap = square(self.keep);
        require!(self.distance_at(cast, lower) >= gap, "nearer than the gap at {lower:e}");
        self.check_plane(cast, proof.normal, lower)?;
        let verified = cast.verify(&proof).map_err(|e| Objection(e.to_string()))?;
        if !upper.is_finite() {
            return Ok(Width::default());
        }
        // Of a slight gap the end is that of the bodies as they are, which thin ones may have left again there.
        let near = self.is_slight() || self.distance_at(cast, upper) <= gap;
        require!(near, "not as near as the gap at {upper:e}");
        require!(verified.is_finite(), "no end is verified");
        let slope = proof.normal.dot(cast.direction());
        Ok(Width { noises: (upper - lower) * slope / self.noise })
    }

    /// Whether rounding leaves no room in the gap: there the upper bound is judged as that of an ordinary cast is.
    fn is_slight(&self) -> bool {
        self.keep <= 8.0 * self.noise
    }

    /// The square of the distance after a translation.
    fn distance_at(&self, cast: &Cast, t: f64) -> Ratio {
        let by = Vector::new(cast.direction()).times(&Dyadic::new(t));
        let moved: Vec<Vector> = self.moving.iter().map(|p| p.plus(&by)).collect();
        distance(&moved, &self.fixed).square
    }

    fn check_plane(&self, cast: &Cast, normal: DVec3, lower: f64) -> Result<(), Objection> {
        let n = Vector::new(normal);
        let along = n.dot(&Vector::new(cast.direction()));
        require!(along.is_positive(), "the normal {normal} is not along the direction");
        let left = &self.along(&n) - &(&along * &Dyadic::new(lower));
        let proven = !left.is_negative() && &left * &left >= &squared(self.keep) * &n.dot(&n);
        require!(proven, "the plane does not prove {lower:e}");
        Ok(())
    }

    fn check_separation(&self, of: &Separation) -> Result<(), Objection> {
        let n = Vector::new(of.normal);
        let along = self.along(&n);
        require!(Dyadic::new(of.margin) <= along, "a margin of {:e}", of.margin);
        let beyond = along.is_positive() && &along * &along > &squared(self.keep) * &n.dot(&n);
        require!(beyond, "a plane no farther off than the gap");
        self.cast.verify(of).map_err(|e| Objection(e.to_string()))?;
        Ok(())
    }

    /// `min_Q n.q - max_P n.p`.
    fn along(&self, n: &Vector) -> Dyadic {
        let nearest = self.fixed.iter().map(|q| n.dot(q)).min();
        let farthest = self.moving.iter().map(|p| n.dot(p)).max();
        &nearest.expect("a body has a point") - &farthest.expect("a body has a point")
    }
}

/// The distance of the shadows along a direction, rounded once.
fn shadows(moving: &[Vector], fixed: &[Vector], direction: DVec3) -> f64 {
    // Of a size near 1, that squares stay in range.
    let scale = 2.0_f64.powi(-(direction.abs().max_element().log2().floor() as i32));
    let d = Vector::new(direction * scale);
    let square = d.dot(&d);
    let flat = |points: &[Vector]| -> Vec<Vector> {
        points.iter().map(|p| p.times(&square).minus(&d.times(&p.dot(&d)))).collect()
    };
    distance(&flat(moving), &flat(fixed)).to_f64() / square.to_f64()
}

fn squared(x: f64) -> Dyadic {
    &Dyadic::new(x) * &Dyadic::new(x)
}

fn square(x: f64) -> Ratio {
    Ratio::from_f64(x).times(&Ratio::from_f64(x))
}
