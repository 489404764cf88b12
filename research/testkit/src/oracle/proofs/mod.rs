//! Adversarial proofs: files that exhaust the tolerances of both checkers, whose accepted claims are compared
//! with the truth.
//!
//! A [`Kind`] generates proofs, lists their claims, worsens certificates, and finds false claims of accepted
//! files from their bodies alone, exactly ([docs/reference/proofs.md](../../../../../docs/reference/proofs.md)
//! is the specification). [`Campaign::examine`] examines one proof and
//!
//! - [`mutants`]: a number, name or list of the file is changed, or replaced by that of another proof;
//! - mutants of its kind, for example with normals tilted up to the tolerance, each claim of which is then
//!   strengthened from the weakest value up to the limit of a checker.
//!
//! Both [`checkers`] must agree: what the library accepts, `check.py` accepts. Conversely, the library may
//! reject a file within the specified rounding of a limit, and a file that `check.py` has checked only in part.

pub mod casts;
pub mod checkers;
pub mod common_parts;
pub mod file;
pub mod free;
pub mod motions;
pub mod mutants;
pub mod pairs;
pub mod paths;
pub mod scenes;
pub mod solid_depths;
pub mod solids;

use serde_json::Value;

use crate::random::Random;
use crate::tally::Tally;
use checkers::{RationalChecker, Verdict, verify};
use mutants::{number, with};

/// Number of mutants of each proof that do not depend on its meaning.
const BLIND: usize = 30;

/// Number of mutants of each proof with a part of another one.
const GRAFTED: usize = 6;

/// Number of mutants of each proof whose claims are strengthened.
const PUSHED: usize = 4;

/// One claim out of this many is also strengthened up to the limit of `check.py`.
const TO_THE_END: u64 = 3;

/// A number of a proof that is a claim.
#[derive(Debug, Clone)]
pub struct Claim {
    /// The JSON pointer.
    pub pointer: String,
    /// The weakest admissible value.
    pub weakest: f64,
    /// A value that is stronger than any true claim.
    pub strongest: f64,
    /// The margin by which a true claim may be rejected by the library.
    pub band: f64,
}

/// The checker that has accepted a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CheckerKind {
    /// The library, which checks everything.
    Library,
    /// `check.py`, which does not check everything.
    Fractions,
}

/// A kind of proofs.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    /// The name in the campaign.
    pub name: &'static str,
    /// The part of the file that most mutants change, as a JSON pointer.
    pub focus: &'static str,
    /// Returns the proof of an answer of the library; `None` if this seed yields none.
    pub draw_proof: fn(u64) -> Option<String>,
    /// Returns the claims of a proof.
    pub claims: fn(&Value) -> Vec<Claim>,
    /// Worsens a certificate up to the tolerance, or beyond it.
    pub to_limits: fn(&mut Value, &mut Random),
    /// Returns a false claim among those that the checker checks, exactly and from the bodies alone.
    pub find_falsehood: fn(&Value, CheckerKind) -> Option<String>,
    /// Checks whether a number is so close to a limit that the library may reject it.
    pub is_marginal: fn(&Value) -> bool,
}

/// All kinds.
pub const KINDS: [Kind; 13] = [
    casts::CASTS,
    casts::WITH_GAP,
    pairs::DISTANCES,
    pairs::DEPTHS,
    solids::CLEARANCES,
    solids::DISTANCES,
    solid_depths::DEPTHS,
    common_parts::COMMON_PARTS,
    motions::CONVEX,
    motions::SOLIDS,
    paths::PATHS,
    scenes::SCENES,
    free::FREE,
];

/// Columns: numbers of proofs of the library, of files that both checkers judged, of files that only the
/// library judged while a claim was strengthened, of files that both accept, that the library rejects within
/// the specified rounding, that `check.py` checked in part and the library rejects, of claims strengthened to
/// the limit of a checker, of false claims that were accepted, and of files with different verdicts.
pub const COLUMNS: &[&str] =
    &["proofs", "mutants", "steps", "accepted", "rounded", "partly", "ends", "false", "disagree"];

/// The share of a campaign of one thread.
#[derive(Debug)]
pub struct Campaign<'a> {
    kind: &'a Kind,
    /// `check.py`; if `None`, only the library is judged.
    fractions: Option<&'a mut RationalChecker>,
    tally: &'a mut Tally,
    name: String,
}

impl<'a> Campaign<'a> {
    /// Examines one proof of a kind and all its mutants.
    pub fn examine(
        kind: &'a Kind,
        seed: u64,
        fractions: Option<&'a mut RationalChecker>,
        tally: &'a mut Tally,
    ) {
        let Some(text) = (kind.draw_proof)(seed) else { return };
        let name = format!("{}:{seed}", kind.name);
        let mut campaign = Self { kind, fractions, tally, name };
        campaign.tally.count("proofs");
        let random = &mut Random::stream(seed, &[0xf0_26ed]);
        // Also if `check.py` has checked it only in part.
        if !campaign.judge(&text, "as written") || !verify(&text).accepts() {
            let line = format!("{}: a proof is rejected: {text}", campaign.name);
            return campaign.object("disagree", line);
        }
        let Ok(file) = serde_json::from_str::<Value>(&text) else { return };
        for _ in 0..BLIND {
            let mutant = mutants::random(&file, kind.focus, random);
            campaign.judge(&mutant, "blind");
        }
        campaign.push_one(&file, random);
        for _ in 0..PUSHED {
            let mut worst = file.clone();
            (kind.to_limits)(&mut worst, random);
            if random.one_in(3) {
                (kind.to_limits)(&mut worst, random);
            }
            campaign.judge(&worst.to_string(), "worst");
            campaign.push_one(&worst, random);
        }
        let other =
            (kind.draw_proof)(random.bits()).and_then(|text| serde_json::from_str(&text).ok());
        for _ in 0..GRAFTED {
            if let Some(mutant) =
                other.as_ref().and_then(|other| mutants::graft(&file, other, random))
            {
                campaign.judge(&mutant, "grafted");
            }
        }
    }

    fn object(&mut self, column: &'static str, line: String) {
        self.tally.count(column);
        self.tally.disagree(line);
    }

    /// Strengthens one claim of a file, with the weakest values of all others.
    fn push_one(&mut self, file: &Value, random: &mut Random) {
        let claims = (self.kind.claims)(file);
        if claims.is_empty() {
            return;
        }
        let pushed = &claims[random.index(claims.len())];
        let mut file = file.clone();
        if random.one_in(2) {
            for claim in &claims {
                file = with(&file, &claim.pointer, Some(number(claim.weakest)));
            }
        }
        let at = |x: f64| with(&file, &pushed.pointer, Some(number(x))).to_string();
        if !self.judge(&at(pushed.weakest), "weakest") {
            return;
        }
        let mut steps = 0;
        let end = limit(pushed.weakest, pushed.strongest, |x| {
            steps += 1;
            verify(&at(x)).accepts()
        });
        self.tally.add("steps", steps);
        self.tally.count("ends");
        let Some(end) = end else { return };
        self.judge(&at(end), "pushed");
        self.judge(&at(toward(end, pushed.strongest)), "pushed over");
        if random.one_in(TO_THE_END) && self.fractions.is_some() {
            let last = limit_near(end, pushed.strongest, |x| self.judge(&at(x), "pushed on"));
            self.tally.count("ends");
            self.judge(&at(last), "pushed to the end");
        }
    }

    /// Judges a file with both checkers, and compares accepted files with the truth. Returns whether a checker
    /// accepts it.
    fn judge(&mut self, text: &str, what: &str) -> bool {
        self.tally.count("mutants");
        let library = verify(text);
        let fractions = match &mut self.fractions {
            Some(fractions) => fractions.check(text),
            None => library.clone(),
        };
        let file = serde_json::from_str::<Value>(text).ok();
        let failed = |verdict| matches!(verdict, &Verdict::Failed(_));
        let reason = match (library.accepts(), fractions.accepts()) {
            _ if failed(&library) || failed(&fractions) => Some("a checker fails"),
            (true, true) => {
                self.tally.count("accepted");
                None
            }
            (true, false) => Some("check.py alone refuses"),
            (false, true) if fractions == Verdict::HoldsPartly => {
                self.tally.count("partly");
                None
            }
            (false, true)
                if library.is_about_unused_data()
                    || file.as_ref().is_some_and(|file| self.is_rounded(file)) =>
            {
                self.tally.count("rounded");
                None
            }
            (false, true) => Some("the library alone refuses"),
            (false, false) => None,
        };
        let name = self.name.clone();
        if let Some(reason) = reason {
            let line = format!("{name}, {what}: {reason}: {library:?}, {fractions:?}: {text}");
            self.object("disagree", line);
        }
        for (verdict, who) in
            [(&library, CheckerKind::Library), (&fractions, CheckerKind::Fractions)]
        {
            if verdict.accepts() {
                let unreadable = || Some("the file is not JSON".to_owned());
                let found =
                    file.as_ref().map_or_else(unreadable, |f| (self.kind.find_falsehood)(f, who));
                if let Some(why) = found {
                    let line = format!("{name}, {what}: {who:?} accepts: {why}: {text}");
                    self.object("false", line);
                }
            }
        }
        library.accepts() || fractions.accepts()
    }

    /// Checks whether a rejection by the library is due to rounding: it accepts the file after one or all
    /// claims are weakened by the specified margin, or a number is at a limit.
    fn is_rounded(&self, file: &Value) -> bool {
        let claims = (self.kind.claims)(file);
        let accepts = |claims: &[Claim]| {
            let weaker = claims.iter().fold(file.clone(), |file, claim| claim.eased(file));
            verify(&weaker.to_string()).accepts()
        };
        (self.kind.is_marginal)(file)
            || accepts(&claims)
            || claims.iter().any(|claim| accepts(std::slice::from_ref(claim)))
    }
}

impl Claim {
    /// Returns a file with this claim weakened by its margin.
    fn eased(&self, file: Value) -> Value {
        let Some(old) = file.pointer(&self.pointer).and_then(Value::as_f64) else { return file };
        let eased = if self.weakest < self.strongest {
            (old - self.band).max(self.weakest)
        } else {
            (old + self.band).min(self.weakest)
        };
        with(&file, &self.pointer, Some(number(eased)))
    }
}

/// Returns an integer with the order of the number.
fn order(x: f64) -> i64 {
    let bits = x.to_bits() as i64;
    if bits >= 0 { bits } else { i64::MIN.wrapping_sub(bits) }
}

fn of_order(order: i64) -> f64 {
    let bits = if order >= 0 { order } else { i64::MIN.wrapping_sub(order) };
    f64::from_bits(bits as u64)
}

/// Returns the next number towards `end`.
fn toward(x: f64, end: f64) -> f64 {
    of_order(order(x) + order(end).cmp(&order(x)) as i64)
}

/// Returns the accepted number nearest to `strongest`, by bisection; `None` if `weakest` is not accepted.
fn limit(weakest: f64, strongest: f64, mut accepts: impl FnMut(f64) -> bool) -> Option<f64> {
    if !accepts(weakest) {
        return None;
    }
    let (mut low, mut high) = (i128::from(order(weakest)), i128::from(order(strongest)));
    if accepts(strongest) {
        return Some(strongest);
    }
    while (high - low).abs() > 1 {
        let middle = low + (high - low) / 2;
        if accepts(of_order(middle as i64)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(of_order(low as i64))
}

/// Returns the result of [`limit`], starting at an accepted number with growing steps before the bisection.
fn limit_near(from: f64, strongest: f64, mut accepts: impl FnMut(f64) -> bool) -> f64 {
    let (start, end) = (i128::from(order(from)), i128::from(order(strongest)));
    let (mut low, mut step) = (start, (end - start).signum());
    if step == 0 {
        return from;
    }
    let high = loop {
        let next = low + step;
        if (next - end) * step.signum() >= 0 {
            break end;
        }
        if !accepts(of_order(next as i64)) {
            break next;
        }
        (low, step) = (next, step * 4);
    };
    limit(of_order(low as i64), of_order(high as i64), |x| x == of_order(low as i64) || accepts(x))
        .unwrap_or(from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_found_to_the_last_bit() {
        for most in [3.0_f64, -0.25, 1e-300, 0.0] {
            assert_eq!(limit(-1e300, 1e300, |x| x <= most), Some(most));
            assert_eq!(limit(1e300, -1e300, |x| x >= most), Some(most));
        }
        assert_eq!(limit(1.0, 2.0, |_| false), None);
        assert_eq!(limit_near(2.0, 1e300, |x| x <= 2.5), 2.5);
        assert_eq!(limit_near(2.0, -1e300, |x| x >= -2.5), -2.5);
    }
}
