//! What the paper claims, before anything is measured: each with its number, its place, and by what it
//! is judged here.
//!
//! A claim has one or more *criteria*: a number to be measured, and the band of its values with which
//! the claim holds. Where the paper gives a number "about", the band is a quarter of it either way; where
//! it gives a range or a limit, the band is that. Criteria without a limit are quoted, not judged.
//!
//! The verdict on a criterion, from the 95 % interval of its number: it *holds* if the interval lies in
//! the band, or beyond it only on the side that is better for the algorithm; it is *better than the
//! paper* if all of the interval lies there; it *does not hold* if the interval has nothing of the
//! band and is not better; else it is *undecided*. A claim is as good as the worst of its criteria,
//! and better than the paper if one of them is and the others hold.
//!
//! Places are sections of the paper: its text carries no page numbers here.

mod list;

use std::fmt;

use crate::statistics::{Estimate, short};
pub use list::CLAIMS;

/// A claim of the paper.
#[derive(Debug, PartialEq)]
pub struct PaperClaim {
    /// Short name, beginning with the number of the figure.
    pub id: &'static str,
    /// What is claimed.
    pub statement: &'static str,
    /// The paper's number, or its words.
    pub paper: &'static str,
    /// Section and figure.
    pub place: &'static str,
    /// By what it is judged.
    pub criteria: &'static [Criterion],
}

/// A number and the band in which it supports a claim.
#[derive(Debug, PartialEq)]
pub struct Criterion {
    /// What is measured.
    pub what: &'static str,
    /// Lower end of the band.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// On which side of the band the algorithm does better than the paper says.
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

/// What the data say about a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// It holds.
    Holds,
    /// The algorithm does better than the paper says.
    Better,
    /// The interval reaches over the edge of the band.
    Undecided,
    /// It does not hold.
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
    /// Whether the paper's algorithm does what it is claimed to do, or better.
    pub fn is_kept(self) -> bool {
        matches!(self, Self::Holds | Self::Better)
    }
}

impl Criterion {
    /// The verdict on a number.
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

    /// The band in words.
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

    /// Whether there is anything to be judged.
    pub fn is_judged(&self) -> bool {
        self.low > f64::NEG_INFINITY || self.high < f64::INFINITY
    }
}

/// The claim with this id, held against numbers, one for each of its criteria.
///
/// # Panics
/// If there is no such claim, or it has more or fewer criteria.
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

/// Something the paper says, held against the data.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// What is claimed, and by what it is judged.
    pub paper: &'static PaperClaim,
    /// What was measured, one number for each of the claim's criteria.
    pub measured: Vec<Estimate>,
    /// More about it: other numbers, and circumstances.
    pub details: String,
    /// Computed from the numbers and the criteria.
    pub verdict: Verdict,
    /// Why it does not hold here, or is undecided, as far as the data of this run tell.
    pub why: Option<Why>,
}

/// Why a claim does not hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Why {
    /// What the reason lies in.
    pub reason: Reason,
    /// The counts that show it.
    pub text: String,
}

/// What the reason lies in that a claim does not hold here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// The paper's sentence: it does not say all that it depends on, or more than follows from its data.
    Sentence,
    /// Today's machines: caches, or what an instruction costs beside another.
    Machine,
    /// Our implementation of the paper's algorithm.
    Implementation,
    /// Our implementation of what it is compared with.
    Rival,
}

impl Reason {
    /// With the counts that show it.
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
    /// The verdict on its numbers.
    pub fn judge(&self, measured: &[Estimate]) -> Verdict {
        let each = self.criteria.iter().zip(measured).map(|(criterion, m)| criterion.judge(m));
        each.max().unwrap_or(Verdict::Undecided)
    }
}

const fn band(what: &'static str, [low, high]: [f64; 2], better: Better) -> Criterion {
    Criterion { what, low, high, better }
}

/// The paper's number, give or take a quarter.
const fn about(what: &'static str, number: f64, better: Better) -> Criterion {
    band(what, [0.75 * number, 1.25 * number], better)
}

const fn at_most(what: &'static str, limit: f64) -> Criterion {
    band(what, [f64::NEG_INFINITY, limit], Better::Neither)
}

const fn at_least(what: &'static str, limit: f64) -> Criterion {
    band(what, [limit, f64::INFINITY], Better::Neither)
}

/// The claims about thin faces come twice, once for each reading of "thin": the same id with one of these
/// endings.
pub const READINGS: [(&str, &str); 2] =
    [("-stretch", "a fixed stretch of 100"), ("-meridians", "16 meridians at any size")];

/// Quoted beside the others.
const fn quoted(what: &'static str) -> Criterion {
    band(what, [f64::NEG_INFINITY, f64::INFINITY], Better::Neither)
}

#[cfg(test)]
mod tests {
    use super::Better::{More, Neither};
    use super::*;

    #[test]
    fn verdicts() {
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
    fn a_claim_is_as_good_as_its_worst_criterion() {
        let claim = CLAIMS.iter().find(|claim| claim.id == "18-range").unwrap();
        let at = |value: f64| Estimate { value, low: 0.99 * value, high: 1.01 * value };
        for (values, expected) in [
            ([10.0, 2.0], Verdict::Holds),
            ([5.0, 2.0], Verdict::Better),
            ([5.0, 2.5], Verdict::Undecided),
            ([20.0, 1.0], Verdict::Fails),
        ] {
            assert_eq!(claim.judge(&values.map(at)), expected, "{values:?}");
        }
    }

    #[test]
    fn the_list_is_sound() {
        for (k, claim) in CLAIMS.iter().enumerate() {
            assert!(claim.statement.ends_with('.'), "{}", claim.id);
            assert!(claim.criteria.iter().any(Criterion::is_judged), "{}", claim.id);
            assert!(CLAIMS[..k].iter().all(|other| other.id != claim.id), "{} twice", claim.id);
            for criterion in claim.criteria {
                assert!(criterion.low < criterion.high, "{}: {}", claim.id, criterion.what);
            }
        }
    }
}
