//! Judges distances and depths of rounded bodies in exact arithmetic. [`super::min_gap`] judges their casts.
//! [`judge_all`] asks all questions about a cast.
//!
//! Notation. `d` is the exact distance of the cores, `R` the exact sum of the radii, `m` the exact depth of the cores.
//! All numbers of an answer are taken as exact.
//!
//! - *Distance.* `lower + R <= d` unless `lower` is 0, and `d <= upper + R`, compared as squares.
//! - *Depth.* `R - d` if `d > 0`, `R + m` if the cores meet.
//! - *Points.* Each is at its body's radius from the core, up to rounding.

use colltrans::{
    Cast, CentralCast, ConvexPolyhedron, Depth, Distance, Grazing, Intersection, Outcome, Pair,
    Pose, QueryError, Tracker, Within, WitnessPoints,
};
use glam::DVec3;

use crate::oracle::check::{Objection, require};
use crate::oracle::distance::{self, distance};
use crate::oracle::exact::{Dyadic, Ratio, Vector, place};
use crate::oracle::min_gap::GapJudge;
use crate::oracle::nearest;

/// Maximum number of noises by which a contact point is off the surface. The bounds of a contact differ by at most 15
/// noises over `n . d`. Therefore the points of the cores are within 15 noises of their supporting planes, and the
/// segment between them is shorter along `n` than the sum of the radii by at most 15 noises.
const CONTACT_NOISES: f64 = 32.0;

/// The exact data of a pair of rounded bodies, with which answers are compared.
#[derive(Debug)]
pub struct RoundedJudge<'a> {
    pair: Pair<'a>,
    moving: Vec<Vector>,
    fixed: Vec<Vector>,
    /// The exact distance of the cores.
    pub cores: distance::Distance,
    /// The exact sum of the radii.
    radii: Dyadic,
    /// The noise `32 u S` of the size of the configuration, with the radii.
    pub noise: f64,
}

impl<'a> RoundedJudge<'a> {
    /// Computes the exact data of a pair.
    pub fn new(pair: Pair<'a>) -> Self {
        let put = |body: &ConvexPolyhedron, pose: Pose| {
            place(pose.matrix(), pose.translation(), body.vertices())
        };
        let moving = put(pair.moving(), pair.moving_pose());
        let fixed = put(pair.fixed(), pair.fixed_pose());
        let cores = distance(&moving, &fixed);
        let [r, s] = [pair.moving().radius(), pair.fixed().radius()];
        let reach = |body: &ConvexPolyhedron, pose: Pose| {
            body.vertices().iter().map(|v| v.length()).fold(0.0, f64::max)
                + pose.translation().length()
        };
        let size =
            reach(pair.moving(), pair.moving_pose()) + reach(pair.fixed(), pair.fixed_pose());
        let size = (size + r + s).max(colltrans::MIN_MAGNITUDE);
        let radii = &Dyadic::new(r) + &Dyadic::new(s);
        Self { pair, moving, fixed, cores, radii, noise: 16.0 * f64::EPSILON * size }
    }

    /// Returns the square of `length + R`.
    fn square_between_cores(&self, length: f64) -> Ratio {
        let sum = &Dyadic::new(length) + &self.radii;
        Ratio::new(&sum * &sum, Dyadic::new(1.0))
    }

    /// Checks a distance with its proof. Returns the difference of its bounds in noises.
    ///
    /// # Errors
    /// [`Objection`] with the first statement that is false.
    pub fn check(&self, answer: &Distance) -> Result<f64, Objection> {
        let [lower, upper] = answer.bounds();
        self.check_bounds([lower, upper])?;
        let verified = |checked: Result<f64, colltrans::CertificateError>| {
            checked.map_err(|error| Objection(error.to_string()))
        };
        require!(verified(self.pair.verify(&answer.near))? <= upper, "the points prove less");
        if let Some(plane) = answer.gap {
            require!(plane.gap == lower && lower > 0.0, "the plane is of another bound");
            require!(verified(self.pair.verify(&plane))? >= lower, "the plane proves less");
        } else {
            require!(lower == 0.0, "a bound without a plane");
        }
        self.check_surface_points([answer.on_moving, answer.on_fixed], upper == 0.0, 4.0)?;
        Ok((upper - lower) / self.noise)
    }

    /// Checks bounds of the distance.
    ///
    /// # Errors
    /// [`Objection`] with the first statement that is false.
    pub fn check_bounds(&self, [lower, upper]: [f64; 2]) -> Result<(), Objection> {
        let truth = self.cores.to_f64() - self.radii.to_f64();
        require!(0.0 <= lower && lower <= upper, "bounds {lower:e} and {upper:e}");
        let square = &self.cores.square;
        require!(
            lower == 0.0 || self.square_between_cores(lower) <= *square,
            "lower bound {lower:e} of {truth:e}"
        );
        require!(self.square_between_cores(upper) >= *square, "upper bound {upper:e} of {truth:e}");
        Ok(())
    }

    /// Checks that two points are on the surfaces of the bodies up to some noises, or in the bodies if `are_common`.
    fn check_surface_points(
        &self,
        points: [DVec3; 2],
        are_common: bool,
        noises: f64,
    ) -> Result<(), Objection> {
        let bodies = [
            (&self.moving, self.pair.moving().radius()),
            (&self.fixed, self.pair.fixed().radius()),
        ];
        for (point, (core, radius)) in points.into_iter().zip(bodies) {
            let off = distance(&[Vector::new(point)], core).to_f64() - radius;
            let most = noises * self.noise;
            let is_there = if are_common { off <= most } else { off.abs() <= most };
            require!(is_there, "a point is {off:e} off the surface");
        }
        Ok(())
    }

    /// Checks the answer whether the bodies are closer than a length.
    ///
    /// # Errors
    /// [`Objection`] with the first statement that is false.
    pub fn check_within(&self, length: f64, answer: &Within) -> Result<(), Objection> {
        let between = self.square_between_cores(length);
        match answer {
            Within::Closer(_) => {
                require!(between >= self.cores.square, "not within {length:e}");
            }
            Within::Farther(_) => {
                require!(between < self.cores.square, "within {length:e}");
            }
            Within::Undecided(distance) => {
                let [lower, upper] = distance.bounds();
                require!(lower <= length && length < upper, "the bounds decide");
                self.check(distance)?;
            }
        }
        Ok(())
    }

    /// Checks the bounds of a depth and their proof. Compares them with the exact depth if the cores are apart, or
    /// if `compares` (for small bodies). Returns the difference of the bounds in noises.
    ///
    /// # Errors
    /// [`Objection`] with the first statement that is false.
    pub fn check_depth(&self, answer: &Depth, compares: bool) -> Result<f64, Objection> {
        let [lower, upper] = answer.bounds();
        require!(0.0 <= lower && lower <= upper, "bounds {lower:e} and {upper:e} of a depth");
        let verified = self.pair.verify(answer).map_err(|e| Objection(format!("depth: {e}")))?;
        require!(verified >= lower, "verified a depth of {verified:e} of {lower:e}");
        let one = || Dyadic::new(1.0);
        // Compares `value` with `R + sign * sqrt(square)`.
        let rest = |value: f64| &Dyadic::new(value) - &self.radii;
        let squared = |x: &Dyadic| Ratio::new(x * x, one());
        if !self.cores.intersects() {
            let square = &self.cores.square;
            let [low, high] = [rest(lower), rest(upper)];
            // lower <= R - d: d <= R - lower.
            let is_below = !low.is_positive() && squared(&low) >= *square;
            require!(lower == 0.0 || is_below, "lower bound {lower:e} of a depth");
            // upper >= R - d: R - upper <= d.
            let is_above = !high.is_negative() || squared(&high) <= *square;
            require!(is_above, "upper bound {upper:e} of a depth");
        } else if compares {
            let square = nearest::depth(&self.moving, &self.fixed, self.noise);
            let [low, high] = [rest(lower), rest(upper)];
            let is_below = !low.is_positive() || squared(&low) <= square;
            require!(is_below, "lower bound {lower:e} of a depth of overlapping cores");
            let is_above = !high.is_negative() && squared(&high) >= square;
            require!(is_above, "upper bound {upper:e} of a depth of overlapping cores");
        }
        Ok((upper - lower) / self.noise)
    }
}

/// Answers of all questions about a cast of rounded bodies.
#[derive(Debug)]
pub struct Answers {
    /// The first contact.
    pub outcome: Outcome,
    /// The distance at the start.
    pub distance: Distance,
    /// The depth at the start.
    pub depth: Depth,
    /// The differences of the bounds of the contact, of the distance and of the depth, in noises.
    pub widths: [f64; 3],
}

/// Asks all questions about a cast, from scratch and by a tracker, and judges the answers: first contact with its
/// points, last contact, clearance, intersection, distance, depth, and whether the bodies are within `length` and
/// within lengths near their distance. See [`RoundedJudge::check_depth`] for `compares`.
///
/// Returns `None` if a search ends without an answer.
///
/// # Errors
/// [`Objection`] with the first answer that is wrong.
pub fn judge_all<'a>(
    cast: &Cast<'a>,
    tracker: &mut Tracker<'a>,
    length: f64,
    compares: bool,
) -> Result<Option<Answers>, Objection> {
    match ask_all(cast, tracker, length, compares) {
        Ok(answers) => Ok(Some(answers)),
        Err(Failure::Open) => Ok(None),
        Err(Failure::Wrong(objection)) => Err(objection),
    }
}

/// Reason for which [`ask_all`] ends early.
enum Failure {
    /// A search ends without an answer.
    Open,
    /// An answer is wrong, or a query is refused.
    Wrong(Objection),
}

impl From<QueryError> for Failure {
    fn from(error: QueryError) -> Self {
        match error {
            QueryError::NotConverged { .. } => Self::Open,
            _ => Self::Wrong(Objection(error.to_string())),
        }
    }
}

impl From<Objection> for Failure {
    fn from(objection: Objection) -> Self {
        Self::Wrong(objection)
    }
}

fn ask_all<'a>(
    cast: &Cast<'a>,
    tracker: &mut Tracker<'a>,
    length: f64,
    compares: bool,
) -> Result<Answers, Failure> {
    let named = |who: &'static str| move |Objection(what)| Objection(format!("{who}: {what}"));
    let judge = GapJudge::new(*cast);
    let outcome = cast.first_contact()?;
    let width = judge.check(&outcome).map_err(named("cast"))?.noises;
    judge.check(&tracker.first_contact(cast)?).map_err(named("tracked cast"))?;
    judge.check_clearance(&cast.clearance()?).map_err(named("clearance"))?;
    judge.check_clearance(&tracker.clearance(cast)?).map_err(named("tracked clearance"))?;
    let back = cast.reversed();
    GapJudge::new(back).check(&back.first_contact()?).map_err(named("last contact"))?;

    let [p, q] = [cast.moving().at(cast.moving_pose()), cast.fixed().at(cast.fixed_pose())];
    let pair = Pair::new(p, q)?;
    let judge = RoundedJudge::new(pair);
    if let (Outcome::Contact(contact), 0.0) = (&outcome, cast.options().min_gap) {
        let WitnessPoints { on_moving, on_fixed } = contact.witness_points(cast);
        judge
            .check_surface_points([on_moving, on_fixed], false, CONTACT_NOISES)
            .map_err(named("contact points"))?;
    }
    for (who, found) in
        [("intersection", cast.intersects()?), ("tracked intersection", tracker.intersects(cast)?)]
    {
        judge.check_intersection(cast, &found).map_err(named(who))?;
    }
    let distance = pair.distance()?;
    let depth = pair.depth()?;
    let widths = [
        width,
        judge.check(&distance).map_err(named("distance"))?,
        judge.check_depth(&depth, compares)?,
    ];
    judge.check_bounds(pair.distance_bounds()?).map_err(named("bounds of the distance"))?;
    judge.check(&tracker.distance(&pair)?).map_err(named("tracked distance"))?;
    let apart = (judge.cores.to_f64() - judge.radii.to_f64()).max(0.0);
    for length in [0.0, apart, apart.next_up(), apart + 4.0 * judge.noise, length] {
        judge.check_within(length, &pair.within(length)?).map_err(named("within"))?;
    }
    Ok(Answers { outcome, distance, depth, widths })
}

impl RoundedJudge<'_> {
    /// Checks the answer whether the bodies intersect now, or are at most the minimum gap apart.
    fn check_intersection(&self, cast: &Cast, found: &Intersection) -> Result<(), Objection> {
        let CentralCast { direction, outcome, .. } = &found.evidence;
        let through = cast.along(*direction).map_err(|e| Objection(e.to_string()))?;
        GapJudge::new(through).check(outcome)?;
        let beyond = self.cores.to_f64() - self.radii.to_f64() - cast.options().min_gap;
        // Bodies that move by less than the rounding of the contact may be reported as meeting.
        let rounding = match outcome {
            Outcome::Contact(contact) | Outcome::Grazing(Grazing { contact, .. }) => {
                contact.certificate.rounding
            }
            Outcome::Separated(_) => 0.0,
        };
        let slack = 16.0 * self.noise.max(f64::EPSILON * cast.options().min_gap);
        let holds = if found.meets { beyond <= rounding + slack } else { beyond >= -slack };
        require!(holds, "meets: {}, and the bodies are {beyond:e} apart", found.meets);
        Ok(())
    }
}
