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

use std::fmt;

use crate::finding::Claim;
use crate::statistics::{Estimate, short};

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
    why: impl FnOnce() -> String,
) -> Claim {
    let paper = CLAIMS.iter().find(|claim| claim.id == id).expect("a claim of the list");
    assert_eq!(paper.criteria.len(), measured.len(), "{id}");
    let verdict = paper.judge(&measured);
    let why = (!verdict.is_kept()).then(why);
    Claim { paper, measured, details, verdict, why }
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

/// Quoted beside the others.
const fn quoted(what: &'static str) -> Criterion {
    band(what, [f64::NEG_INFINITY, f64::INFINITY], Better::Neither)
}

use Better::{Less, More, Neither};

/// All claims of the paper that are put to the test, in its order.
pub const CLAIMS: &[PaperClaim] = &[
    PaperClaim {
        id: "11-steps",
        statement: "The average number of minimisation steps grows as the logarithm of the number of \
                    vertices.",
        paper: "log n",
        place: "V-A, figure 11",
        criteria: &[about("growth of steps / growth of log n, 200 to 200,000", 1.0, Less)],
    },
    PaperClaim {
        id: "11-few",
        statement: "Polyhedra of about 200,000 faces take fewer than 15 steps on average.",
        paper: "less than 15",
        place: "V-A, figure 11",
        criteria: &[at_most("steps to the end at 200,000 vertices", 15.0)],
    },
    PaperClaim {
        id: "11-time",
        statement: "Query times follow log² n.",
        paper: "log² n",
        place: "V-A, figure 11",
        criteria: &[band("k in time ~ (log n)^k", [1.5, 2.5], Less)],
    },
    PaperClaim {
        id: "11-thin",
        statement: "Thin and stretched faces increase query times by 20 to 80 %.",
        paper: "20 to 80 %",
        place: "V-A",
        criteria: &[band("increase, % (middle of all sizes)", [20.0, 80.0], Less)],
    },
    PaperClaim {
        id: "table-1-planar",
        statement: "Almost half of the time goes into planar problems.",
        paper: "almost half",
        place: "V-A, table I",
        criteria: &[band("share of the time at 12,800 vertices, %", [37.5, 55.0], Neither)],
    },
    PaperClaim {
        id: "table-1-region",
        statement: "The time for the region that contains the minimum is negligible.",
        paper: "negligible",
        place: "V-A, table I",
        criteria: &[at_most("share of the time at most, of three sizes, %", 5.0)],
    },
    PaperClaim {
        id: "12-near",
        statement: "Bodies that pass each other at 0.005 diameters take almost half the time of \
                    bodies that collide.",
        paper: "almost halved",
        place: "V-B, figure 12",
        criteria: &[about("time / time of a collision", 0.5, Less)],
    },
    PaperClaim {
        id: "12-far",
        statement: "When they move far apart, at 1.5 diameters, the time reduces to about a third.",
        paper: "about 1/3",
        place: "V-B, figure 12",
        criteria: &[about("time / time of a collision", 1.0 / 3.0, Less)],
    },
    PaperClaim {
        id: "13-floor",
        statement: "With initialisation, several computations are completed in one minimisation step, \
                    the floor of the plots.",
        paper: "several",
        place: "V-C and V-F, figure 13",
        criteria: &[at_least("queries of one step at a change of 0.25 %, %", 10.0)],
    },
    PaperClaim {
        id: "13-adapts",
        statement: "The algorithm adapts to coherence: fewer steps with initialisation than without, \
                    and fewer at a change of 0.25 % than at 1 %.",
        paper: "gradually",
        place: "V-C, figure 13",
        criteria: &[
            at_most("steps at 1 % / steps from scratch", 1.0),
            at_most("steps at 0.25 % / steps at 1 %", 1.0),
        ],
    },
    PaperClaim {
        id: "13-motion",
        statement: "It does not depend on the type of motion: translation, rotation or screw.",
        paper: "do not depend",
        place: "V-C",
        criteria: &[at_most("steps of the motion with most / with fewest", 1.25)],
    },
    PaperClaim {
        id: "14-regular",
        statement: "The average number of steps decreases regularly as coherence grows (to the end).",
        paper: "decreases regularly",
        place: "I and V-C, figure 14",
        criteria: &[at_most("largest rise from a change to half of it, factor", 1.1)],
    },
    PaperClaim {
        id: "14-one",
        statement: "It gets very close to the smallest possible value, one step (to the end).",
        paper: "very close to 1",
        place: "I, figure 14",
        criteria: &[at_most("steps at a change of 0.0625 %, mean of all sizes", 1.5)],
    },
    PaperClaim {
        id: "14-log",
        statement: "It follows the estimate: linear in the logarithm of the change (to the end).",
        paper: "good accordance",
        place: "III-D and V-C, figure 14",
        criteria: &[at_least("R² of steps against the logarithm of the change", 0.9)],
    },
    PaperClaim {
        id: "14-regular-near",
        statement: "The average number of steps decreases regularly as coherence grows (to a gap of \
                    1 %).",
        paper: "decreases regularly",
        place: "I and V-C, figure 14",
        criteria: &[at_most("largest rise from a change to half of it, factor", 1.1)],
    },
    PaperClaim {
        id: "14-one-near",
        statement: "It gets very close to the smallest possible value, one step (to a gap of 1 %).",
        paper: "very close to 1",
        place: "I, figure 14",
        criteria: &[at_most("steps at a change of 0.0625 %, mean of all sizes", 1.5)],
    },
    PaperClaim {
        id: "15-growth",
        statement: "Balanced: the cost of EGJK grows linearly, that of CTA and of PQP less.",
        paper: "linear; sublinear",
        place: "V-D, figure 15",
        criteria: &[
            about("exponent of EGJK, linear support search, from 3,200 vertices", 1.0, Neither),
            at_most("exponent of CTA", 0.75),
            at_most("exponent of PQP", 0.75),
        ],
    },
    PaperClaim {
        id: "15-egjk",
        statement: "Balanced: time(EGJK)/time(CTA) increases from about 1/5.",
        paper: "1/5, rising",
        place: "V-D, figure 15",
        criteria: &[
            about("ratio at 200 vertices, EGJK with linear support search", 0.2, More),
            at_least("its growth to 200,000 vertices, factor", 1.0),
            quoted("ratio at 200 vertices, EGJK climbing"),
        ],
    },
    PaperClaim {
        id: "15-fastest",
        statement: "Balanced: CTA is the fastest from about 20,000 vertices (EGJK with linear support \
                    search, which grows as the paper's).",
        paper: "20,000",
        place: "V-D, figure 15",
        criteria: &[
            at_least("time(EGJK)/time(CTA) at 51,200", 1.0),
            at_least("time(PQP)/time(CTA) at 51,200", 1.0),
        ],
    },
    PaperClaim {
        id: "15-fastest-climbing",
        statement: "Balanced: CTA is faster than EGJK from about 20,000 vertices (EGJK climbing to \
                    support points).",
        paper: "20,000",
        place: "V-D, figure 15",
        criteria: &[at_least("time(EGJK)/time(CTA) at 51,200", 1.0)],
    },
    PaperClaim {
        id: "15-pqp-trapezoids",
        statement: "Balanced trapezoids: time(PQP)/time(CTA) is in a band between 6.5 and 10.",
        paper: "6.5 to 10",
        place: "V-D, figure 15",
        criteria: &[band("middle of all sizes", [6.5, 10.0], More)],
    },
    PaperClaim {
        id: "15-pqp-triangles",
        statement: "Balanced triangles: time(PQP)/time(CTA) is around 5.5.",
        paper: "5.5",
        place: "V-D, figure 15",
        criteria: &[about("middle of all sizes", 5.5, More)],
    },
    PaperClaim {
        id: "16-egjk",
        statement: "Thin faces: time(EGJK)/time(CTA) rises from about 1/5 to about 14.",
        paper: "1/5 to 14",
        place: "V-D, figure 16",
        criteria: &[
            about("ratio at 200 vertices, EGJK with linear support search", 0.2, More),
            about("ratio at 200,000 vertices", 14.0, More),
            quoted("ratio at 200,000 vertices, EGJK climbing"),
        ],
    },
    PaperClaim {
        id: "16-pqp",
        statement: "Thin faces: time(PQP)/time(CTA) jumps to over 100.",
        paper: "over 100",
        place: "V-D, figure 16",
        criteria: &[at_least("largest ratio of all sizes", 100.0)],
    },
    PaperClaim {
        id: "16-pqp-growth",
        statement: "Thin faces: PQP no longer follows a sublinear trend.",
        paper: "not sublinear",
        place: "V-D, figure 16",
        criteria: &[at_least("exponent of PQP, from 3,200 vertices", 0.9)],
    },
    PaperClaim {
        id: "17-fastest",
        statement: "Thin faces, bodies that pass within 1 % of a diameter: CTA is the fastest (EGJK \
                    with linear support search).",
        paper: "lowest",
        place: "V-D, figure 17",
        criteria: &[
            at_least("time(EGJK)/time(CTA) at 51,200", 1.0),
            at_least("time(PQP)/time(CTA) at 51,200", 1.0),
        ],
    },
    PaperClaim {
        id: "17-fastest-climbing",
        statement: "Thin faces, bodies that pass within 1 % of a diameter: CTA is faster than EGJK \
                    (climbing to support points).",
        paper: "lowest",
        place: "V-D, figure 17",
        criteria: &[at_least("time(EGJK)/time(CTA) at 51,200", 1.0)],
    },
    PaperClaim {
        id: "18-range",
        statement: "Incremental: time(CTA)/time(EGJK) varies from about 10 to 2.",
        paper: "10 to 2",
        place: "V-D, figure 18",
        criteria: &[
            about("largest of all sizes and changes", 10.0, Less),
            about("smallest", 2.0, Less),
        ],
    },
    PaperClaim {
        id: "18-egjk",
        statement: "The ratio keeps favourable to EGJK.",
        paper: "above 1",
        place: "V-D, figure 18",
        criteria: &[band("smallest ratio", [1.0, f64::INFINITY], Less)],
    },
    PaperClaim {
        id: "18-change",
        statement: "The ratio decreases for shorter incremental changes.",
        paper: "decreases",
        place: "V-D, figure 18",
        criteria: &[at_most("ratio at 0.13 % / ratio at 1 %, middle of all sizes", 1.0)],
    },
    PaperClaim {
        id: "18-size",
        statement: "The ratio decreases for more complex polyhedra.",
        paper: "decreases",
        place: "V-D, figure 18",
        criteria: &[at_most("ratio at 51,200 / ratio at 200 vertices, middle of all changes", 1.0)],
    },
    PaperClaim {
        id: "18-faces",
        statement: "Balanced and thin faces do not differ significantly.",
        paper: "no difference",
        place: "V-D, figure 18",
        criteria: &[band("ratio of thin / ratio of balanced", [0.75, 1.25], Less)],
    },
    PaperClaim {
        id: "19-affects",
        statement: "The initialisation parameters clearly affect the performance when coherence is \
                    very high.",
        paper: "clearly",
        place: "V-E, figure 19",
        criteria: &[
            at_least("CTA, worst parameter over the best, up to 0.5°, %", 20.0),
            at_least("H-Walk, the same, %", 20.0),
        ],
    },
    PaperClaim {
        id: "19-strong",
        statement: "Beyond 30 degrees strong initialisation does not significantly improve the \
                    performance, or worsens it.",
        paper: "none",
        place: "V-E, figure 19",
        criteria: &[
            at_least("CTA, strongest over no initialisation", 0.9),
            at_least("H-Walk, the same", 0.9),
        ],
    },
    PaperClaim {
        id: "19-worsening-800",
        statement: "At low coherence, 800 vertices, the parameter worsens CTA by about 35 %, H-Walk \
                    by 65 %: CTA adapts better.",
        paper: "35 % against 65 %",
        place: "V-E, figure 19",
        criteria: &[
            about("CTA, worst parameter over the best, %", 35.0, Less),
            at_most("CTA's / H-Walk's", 1.0),
            quoted("H-Walk, %"),
        ],
    },
    PaperClaim {
        id: "19-worsening-3200",
        statement: "At low coherence, 3,200 vertices, it worsens CTA by about 25 %, H-Walk by 80 %.",
        paper: "25 % against 80 %",
        place: "V-E, figure 19",
        criteria: &[
            about("CTA, worst parameter over the best, %", 25.0, Less),
            at_most("CTA's / H-Walk's", 1.0),
            quoted("H-Walk, %"),
        ],
    },
    PaperClaim {
        id: "19-dispersion-high",
        statement: "At high coherence single runs disperse more with CTA: deviation over mean is about \
                    70 %, with H-Walk 14 %.",
        paper: "70 % against 14 %",
        place: "V-E, figure 19",
        criteria: &[
            about("CTA, %", 70.0, Less),
            band("CTA's / H-Walk's", [1.0, f64::INFINITY], Less),
            quoted("H-Walk, %"),
        ],
    },
    PaperClaim {
        id: "19-dispersion-low",
        statement: "At low coherence it is about 35 % with CTA, 4 % with H-Walk.",
        paper: "35 % against 4 %",
        place: "V-E, figure 19",
        criteria: &[
            about("CTA, %", 35.0, Less),
            band("CTA's / H-Walk's", [1.0, f64::INFINITY], Less),
            quoted("H-Walk, %"),
        ],
    },
];

#[cfg(test)]
mod tests {
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
