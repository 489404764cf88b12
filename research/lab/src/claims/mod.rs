//! The claims of the paper, fixed before anything is measured: each with its number, its place, and the criteria by
//! which it is judged here.
//!
//! A claim has one or more *criteria*: a measured number and the band of its values for which the claim holds. For a
//! number "about" in the paper, the band is a quarter in either direction; for a range or limit, it is that. A word
//! without a number ("several", "clearly", "sublinear") has a limit of a quarter as well. Criteria without limits are
//! quoted, not judged.
//!
//! The verdict on a criterion depends on the 95 % interval of its number:
//! - *holds*: the interval is in the band, or extends beyond it only on the side that is better for the algorithm.
//! - *better than the paper*: the whole interval is on that side. *Does not hold*: it is outside on the other side.
//! - *undecided*: otherwise. A claim has the verdict of its worst criterion; it is better than the paper if one
//!   criterion is and the others hold.

mod list;

use std::fmt;

use crate::statistics::{Estimate, short};
pub use list::CLAIMS;

/// A claim of the paper.
#[derive(Debug, PartialEq)]
pub struct PaperClaim {
    /// Short name that begins with the number of the figure.
    pub id: &'static str,
    /// The claim.
    pub statement: &'static str,
    /// The paper's number, or its words.
    pub paper: &'static str,
    /// Section and figure; the text of the paper used here has no page numbers.
    pub place: &'static str,
    /// Theme in the summary.
    pub theme: Theme,
    /// Algorithm that the claim is about.
    pub subject: Subject,
    /// Criteria by which the claim is judged.
    pub criteria: &'static [Criterion],
}

/// Theme of claims in the summary, in the paper's order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Theme {
    /// Section III.
    Step,
    /// Section V-A and V-B.
    Scratch,
    /// Section V-C.
    Coherence,
    /// Section V-D, figures 15 to 17.
    Rivals,
    /// Section V-D, figure 18.
    IncrementalRivals,
    /// Section V-E.
    Variable,
}

impl Theme {
    /// All themes, in order.
    pub const ALL: [Self; 6] = [
        Self::Step,
        Self::Scratch,
        Self::Coherence,
        Self::Rivals,
        Self::IncrementalRivals,
        Self::Variable,
    ];
}

impl fmt::Display for Theme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Step => "a step of the minimisation",
            Self::Scratch => "queries from scratch",
            Self::Coherence => "queries with initialisation",
            Self::Rivals => "from scratch, compared with EGJK and PQP",
            Self::IncrementalRivals => "with initialisation, compared with EGJK",
            Self::Variable => "variable coherence, compared with H-Walk",
        })
    }
}

/// Algorithm that a claim is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// The collision translation algorithm, alone or compared with another one.
    Cta,
    /// Another algorithm alone. The summary counts these claims separately.
    Other,
}

/// A number, and the band in which it supports a claim.
#[derive(Debug, PartialEq)]
pub struct Criterion {
    /// Measured quantity.
    pub what: &'static str,
    /// Lower end of the band.
    pub low: f64,
    /// Upper end of the band.
    pub high: f64,
    /// Side of the band on which the algorithm is better than the paper states.
    pub better: Better,
}

/// A side of a band.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Better {
    /// Below.
    Less,
    /// Above.
    More,
    /// Neither.
    Neither,
}

/// Verdict of the data on a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// The claim holds.
    Holds,
    /// The algorithm is better than the paper states.
    Better,
    /// The interval extends over an end of the band.
    Undecided,
    /// The claim does not hold.
    Fails,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Holds => "holds",
            Self::Better => "better than the paper",
            Self::Undecided => "undecided",
            Self::Fails => "does not hold",
        })
    }
}

impl Verdict {
    /// Checks whether the paper's algorithm performs as claimed, or better.
    pub fn is_kept(self) -> bool {
        matches!(self, Self::Holds | Self::Better)
    }
}

impl Criterion {
    /// Returns the verdict on a number.
    pub fn judge(&self, measured: &Estimate) -> Verdict {
        let Estimate { low, high, .. } = *measured;
        let (less, more) = (self.better == Better::Less, self.better == Better::More);
        let is_beyond = (less && high < self.low) || (more && low > self.high);
        let fits_below = less || low >= self.low;
        let fits_above = more || high <= self.high;
        let is_apart = low > self.high || high < self.low;
        if is_beyond {
            Verdict::Better
        } else if fits_below && fits_above {
            Verdict::Holds
        } else if is_apart || measured.value.is_nan() {
            Verdict::Fails
        } else {
            Verdict::Undecided
        }
    }

    /// Returns the band as text.
    pub fn band(&self) -> String {
        let side = match self.better {
            Better::Less if self.low > f64::NEG_INFINITY => ", less is better",
            Better::More if self.high < f64::INFINITY => ", more is better",
            _ => "",
        };
        let [low, high] = [self.low, self.high].map(short);
        match (self.low.is_finite(), self.high.is_finite()) {
            (true, true) => format!("holds from {low} to {high}{side}."),
            (true, false) => format!("holds from {low}{side}."),
            (false, true) => format!("holds up to {high}."),
            (false, false) => "quoted, not judged.".into(),
        }
    }

    /// Checks whether the band has a limit.
    pub fn is_judged(&self) -> bool {
        self.low > f64::NEG_INFINITY || self.high < f64::INFINITY
    }
}

/// Returns the claim with this identifier, judged by one number for each of its criteria. `why` is called
/// unless the claim holds.
///
/// # Panics
/// If the claim does not exist, or the number of criteria differs.
pub(crate) fn judged(
    id: &str,
    measured: Vec<Estimate>,
    details: String,
    why: impl FnOnce() -> Why,
) -> Claim {
    let paper = CLAIMS.iter().find(|claim| claim.id == id).expect("a claim of the list");
    assert_eq!(paper.criteria.len(), measured.len(), "{id}");
    let verdict = paper.judge(&measured);
    let why = (!verdict.is_kept()).then(why);
    Claim { paper, measured, details, verdict, why }
}

/// A claim of the paper, compared with the data.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// The claim, and its criteria.
    pub paper: &'static PaperClaim,
    /// Measured numbers, one for each criterion.
    pub measured: Vec<Estimate>,
    /// Further numbers and circumstances.
    pub details: String,
    /// Verdict from the numbers and the criteria.
    pub verdict: Verdict,
    /// Reason why the claim does not hold or is undecided, as far as the data of this run show; `None` if it
    /// holds.
    pub why: Option<Why>,
}

/// Reason why a claim does not hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Why {
    /// Kind of the reason.
    pub reason: Reason,
    /// The numbers that show it.
    pub text: String,
}

/// Kind of reason why a claim does not hold here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// The paper's sentence: it omits a dependence, or states more than its data show.
    Sentence,
    /// Current machines: caches, or relative costs of instructions.
    Machine,
    /// Our implementation of the paper's algorithm.
    Implementation,
    /// Our implementation of the compared algorithm.
    Rival,
}

impl Reason {
    /// Returns the reason with the numbers that show it.
    pub(crate) fn because(self, text: impl Into<String>) -> Why {
        Why { reason: self, text: text.into() }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Sentence => "the paper's sentence",
            Self::Machine => "today's machine",
            Self::Implementation => "our implementation",
            Self::Rival => "our implementation of the other algorithm",
        })
    }
}

impl PaperClaim {
    /// Returns the verdict on the numbers: the worst one of the criteria.
    pub fn judge(&self, measured: &[Estimate]) -> Verdict {
        let each = self.criteria.iter().zip(measured).map(|(criterion, m)| criterion.judge(m));
        each.max().unwrap_or(Verdict::Undecided)
    }
}

/// Creates a criterion with a band.
const fn band(what: &'static str, [low, high]: [f64; 2], better: Better) -> Criterion {
    Criterion { what, low, high, better }
}

/// Creates a criterion whose band is the paper's number, plus or minus a quarter.
const fn about(what: &'static str, number: f64, better: Better) -> Criterion {
    band(what, [0.75 * number, 1.25 * number], better)
}

/// Creates a criterion with an upper limit.
const fn at_most(what: &'static str, limit: f64) -> Criterion {
    band(what, [f64::NEG_INFINITY, limit], Better::Neither)
}

/// Creates a criterion with a lower limit.
const fn at_least(what: &'static str, limit: f64) -> Criterion {
    band(what, [limit, f64::INFINITY], Better::Neither)
}

/// Creates a criterion that is quoted without a limit.
const fn quoted(what: &'static str) -> Criterion {
    band(what, [f64::NEG_INFINITY, f64::INFINITY], Better::Neither)
}

#[cfg(test)]
mod tests {
    use super::Better::{More, Neither};
    use super::*;

    #[test]
    fn verdict_depends_on_interval_and_band() {
        let at = |low, high| Estimate { value: f64::midpoint(low, high), low, high };
        let ratio = about("", 4.0, More);
        for (low, high, expected) in [
            (3.2, 4.8, Verdict::Holds),
            (4.0, 6.0, Verdict::Holds),
            (5.5, 7.0, Verdict::Better),
            (2.0, 3.5, Verdict::Undecided),
            (1.0, 2.9, Verdict::Fails),
            (2.0, 9.0, Verdict::Undecided),
        ] {
            assert_eq!(ratio.judge(&at(low, high)), expected, "{low} to {high}");
        }
        let neither = about("", 4.0, Neither);
        assert_eq!(neither.judge(&at(4.0, 6.0)), Verdict::Undecided);
        assert_eq!(neither.judge(&at(6.0, 7.0)), Verdict::Fails);
        assert_eq!(at_most("", 1.0).judge(&at(0.5, 0.9)), Verdict::Holds);
        assert_eq!(at_most("", 1.0).judge(&at(f64::NAN, f64::NAN)), Verdict::Fails);
        assert_eq!(quoted("").judge(&at(-9.0, 9.0)), Verdict::Holds);
    }

    #[test]
    fn claim_has_verdict_of_worst_criterion() {
        let claim = CLAIMS.iter().find(|claim| claim.id == "18-range").unwrap();
        let at = |value: f64| Estimate { value, low: 0.99 * value, high: 1.01 * value };
        for (values, expected) in [
            ([10.0, 2.0, 9.0, 9.0], Verdict::Holds),
            ([5.0, 2.0, 9.0, 9.0], Verdict::Better),
            ([5.0, 2.5, 9.0, 9.0], Verdict::Undecided),
            ([20.0, 1.0, 9.0, 9.0], Verdict::Fails),
        ] {
            assert_eq!(claim.judge(&values.map(at)), expected, "{values:?}");
        }
    }

    #[test]
    fn claims_have_unique_ids_and_valid_bands() {
        for (k, claim) in CLAIMS.iter().enumerate() {
            assert!(claim.statement.ends_with('.'), "{}", claim.id);
            assert!(k == 0 || CLAIMS[k - 1].theme <= claim.theme, "{}", claim.id);
            assert!(claim.criteria.iter().any(Criterion::is_judged), "{}", claim.id);
            assert!(CLAIMS[..k].iter().all(|other| other.id != claim.id), "{} twice", claim.id);
            for criterion in claim.criteria {
                assert!(criterion.low < criterion.high, "{}: {}", claim.id, criterion.what);
            }
        }
    }
}
