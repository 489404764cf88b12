//! Checks an answer of the library in exact arithmetic: what its certificate proves, whether that equals the
//! statements of the answer, and whether the linear programme agrees (`truth`).

use std::cell::OnceCell;
use std::fmt;

use colltrans::{Cast, Outcome};
use glam::DVec3;

use self::truth::Truth;
use crate::oracle::scene::Scene;

/// Maximum difference of two computations of the same lateral distance in noises ([`Scene::noise`]): one for
/// each.
const TWO_ROUNDINGS: f64 = 2.0;

/// The properties of a checked proof.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Proof {
    /// Whether outcome and value are proven by the certificate alone, without a rounding error.
    pub exact: bool,
    /// `U - L` in world units, divided by the size of the configuration.
    pub gap_over_size: f64,
    /// `U - L` divided by the tolerance that the certificate states.
    pub gap_over_tolerance: f64,
    /// The residual of the witness points, in noises.
    pub residual_in_noises: f64,
}

impl Proof {
    /// Returns the larger of both values for each number.
    #[must_use]
    pub fn worse(&self, other: &Self) -> Self {
        Self {
            exact: self.exact && other.exact,
            gap_over_size: self.gap_over_size.max(other.gap_over_size),
            gap_over_tolerance: self.gap_over_tolerance.max(other.gap_over_tolerance),
            residual_in_noises: self.residual_in_noises.max(other.residual_in_noises),
        }
    }
}

/// The reason why an answer is wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct Objection(pub String);

impl fmt::Display for Objection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Objection {}

impl From<Objection> for String {
    fn from(objection: Objection) -> Self {
        objection.0
    }
}

/// Returns `Err` with a formatted [`Objection`] unless the condition holds. A comparison with NaN does not
/// hold.
macro_rules! require {
    ($condition:expr, $($text:tt)+) => {
        let holds: bool = $condition;
        if !holds {
            return Err($crate::oracle::check::Objection(format!($($text)+)));
        }
    };
}
pub(crate) use require;

mod certificate;
mod truth;

/// Two bodies, and the data with which an answer about them is compared.
#[derive(Debug)]
pub struct Judge<'a> {
    /// The setting in exact coordinates.
    pub scene: Scene,
    /// The query.
    pub cast: Cast<'a>,
    /// The input points of the bodies, if they are known and are more than the vertices.
    input: Option<Scene>,
    truth: OnceCell<Truth>,
    truth_of_input: OnceCell<Truth>,
}
impl<'a> Judge<'a> {
    /// Builds the judge of a query.
    pub fn new(cast: Cast<'a>) -> Self {
        Self {
            scene: Scene::from_cast(&cast),
            cast,
            input: None,
            truth: OnceCell::new(),
            truth_of_input: OnceCell::new(),
        }
    }

    /// Sets the input points of the bodies.
    #[must_use]
    pub fn with_input(mut self, moving: &[DVec3], fixed: &[DVec3]) -> Self {
        let has_dropped =
            moving.len() > self.scene.moving.len() || fixed.len() > self.scene.fixed.len();
        self.input = has_dropped.then(|| {
            let poses = (self.cast.moving_pose(), self.cast.fixed_pose());
            Scene::new((moving, &poses.0), (fixed, &poses.1), self.cast.direction())
        });
        self
    }

    /// Checks an answer with its proof.
    ///
    /// # Errors
    /// [`Objection`] with the first statement that is false.
    pub fn check(&self, outcome: &Outcome) -> Result<Proof, Objection> {
        match outcome {
            Outcome::Contact(contact) => self.check_contact(contact),
            Outcome::Grazing(grazing) => self.check_grazing(grazing),
            Outcome::Separated(separated) => self.check_separated(separated),
        }
    }

    /// Returns the lateral overlap up to which a contact is grazing.
    fn border(&self) -> f64 {
        self.cast.options().graze_tolerance.max(self.scene.touching)
    }
}

/// Compares two answers to the same query: their outcomes, and their translations up to both tolerances.
///
/// # Errors
/// [`Objection`] with the difference. At the boundary of the shadow both answers may be admissible, which
/// [`Judge::compare_with_oracle`] decides for each.
pub fn compare_answers(first: &Outcome, second: &Outcome) -> Result<(), Objection> {
    let (a, b) = match (first, second) {
        (Outcome::Separated(_), Outcome::Separated(_)) => return Ok(()),
        (Outcome::Contact(a), Outcome::Contact(b)) => (a, b),
        (Outcome::Grazing(a), Outcome::Grazing(b)) => (&a.contact, &b.contact),
        _ => return Err(Objection(format!("{} and {}", kind(first), kind(second)))),
    };
    let (error, tolerance) =
        ((a.translation - b.translation).abs(), a.certificate.rounding + b.certificate.rounding);
    require!(
        error <= tolerance,
        "translations {:e} and {:e}, {error:e} apart (tolerated: {tolerance:e})",
        a.translation,
        b.translation
    );
    Ok(())
}

/// Returns the name of an outcome.
pub fn kind(outcome: &Outcome) -> &'static str {
    match outcome {
        Outcome::Contact(_) => "contact",
        Outcome::Grazing(_) => "grazing",
        Outcome::Separated(_) => "separated",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::settings::{Setting, setting};
    use colltrans::{Certificate, Contact, Separated, Solver, VertexId};

    /// Checks whether the judge rejects an answer.
    fn judge_rejects(setting: &Setting, outcome: &Outcome) -> bool {
        let bodies = setting.bodies().expect("bodies");
        let judge = setting.judge(&bodies);
        judge.check(outcome).and_then(|_| judge.compare_with_oracle(outcome)).is_err()
    }

    fn draw_answers(kind: fn(&Outcome) -> bool) -> Vec<(Setting, Outcome)> {
        let ask = |seed| {
            let setting = setting(["random", "boxes", "peg"][seed as usize % 3], seed);
            let outcome = setting.cast(&setting.bodies().expect("bodies"), Solver::Portal);
            outcome.ok().map(|outcome| (setting, outcome))
        };
        (0..240).filter_map(ask).filter(|(_, outcome)| kind(outcome)).take(20).collect()
    }

    #[test]
    fn changed_contacts_are_rejected() {
        type Change = fn(&mut Contact);
        let changes: [(&str, Change); 8] = [
            ("later", |c| c.translation += 4.0 * c.certificate.rounding),
            ("earlier", |c| c.translation -= 4.0 * c.certificate.rounding),
            ("lower bound", |c| c.certificate.lower += 4.0 * c.certificate.rounding),
            ("upper bound", |c| c.certificate.upper -= 100.0 * c.certificate.rounding),
            ("turned normal", |c| {
                let aside = c.normal.any_orthonormal_vector();
                c.normal = (c.normal + aside * 1e-3).normalize();
                c.certificate.normal = c.normal;
            }),
            ("opposite normal", |c| {
                c.normal = -c.normal;
                c.certificate.normal = c.normal;
            }),
            ("weights", |c| c.certificate.weights = [1.0, -1.0, 1.0]),
            ("vertex", |c| c.certificate.pairs[0].fixed = VertexId(99)),
        ];
        let contacts = draw_answers(|o| matches!(o, Outcome::Contact(_)));
        assert_eq!(contacts.len(), 20);
        let other = |kind: fn(&Outcome) -> bool| draw_answers(kind).swap_remove(0).1;
        let Outcome::Separated(separated) = other(|o| matches!(o, Outcome::Separated(_))) else {
            unreachable!()
        };
        let Outcome::Grazing(grazing) = other(|o| matches!(o, Outcome::Grazing(_))) else {
            unreachable!()
        };
        for (setting, outcome) in contacts {
            assert!(!judge_rejects(&setting, &outcome), "{setting}");
            let Outcome::Contact(contact) = outcome else { unreachable!() };
            for (name, change) in changes {
                let mut changed = contact;
                change(&mut changed);
                assert!(judge_rejects(&setting, &Outcome::Contact(changed)), "{setting}: {name}");
            }
            let Certificate { normal, .. } = contact.certificate;
            let orthogonal = normal.cross(setting.direction).normalize();
            let mut separated = separated;
            separated.certificate = colltrans::Separation { normal: orthogonal, margin: 1e-3 };
            if !orthogonal.is_finite() {
                separated.certificate.normal = setting.direction.any_orthonormal_vector();
            }
            assert!(
                judge_rejects(&setting, &Outcome::Separated(separated)),
                "{setting}: separated"
            );
            let mut grazing = grazing;
            grazing.separating_direction = separated.certificate.normal;
            (grazing.overlap, grazing.contact) = (0.0, contact);
            assert!(judge_rejects(&setting, &Outcome::Grazing(grazing)), "{setting}: grazing");
        }
    }

    #[test]
    fn changed_separations_are_rejected() {
        let separations = draw_answers(|o| matches!(o, Outcome::Separated(_)));
        assert_eq!(separations.len(), 20);
        for (setting, outcome) in separations {
            assert!(!judge_rejects(&setting, &outcome), "{setting}");
            let Outcome::Separated(separated) = outcome else { unreachable!() };
            let changes: [fn(&mut Separated, DVec3); 4] = [
                |s, _| s.certificate.margin += 1e-9,
                |s, _| s.certificate.normal = -s.certificate.normal,
                |s, d| s.certificate.normal = (s.certificate.normal + d * 1e-9).normalize(),
                |s, _| s.certificate.normal *= 1.001,
            ];
            for (index, change) in changes.into_iter().enumerate() {
                let mut changed = separated;
                change(&mut changed, setting.direction.normalize());
                assert!(
                    judge_rejects(&setting, &Outcome::Separated(changed)),
                    "{setting}: {index}"
                );
            }
        }
    }

    #[test]
    fn grazing_is_no_contact() {
        let grazings = draw_answers(|o| matches!(o, Outcome::Grazing(_)));
        assert_eq!(grazings.len(), 20);
        for (setting, outcome) in grazings {
            assert!(!judge_rejects(&setting, &outcome), "{setting}");
            let Outcome::Grazing(grazing) = outcome else { unreachable!() };
            assert!(judge_rejects(&setting, &Outcome::Contact(grazing.contact)), "{setting}");
            let mut aside = grazing;
            aside.overlap -= 1e-3;
            assert!(judge_rejects(&setting, &Outcome::Grazing(aside)), "{setting}: overlap");
        }
    }
}
