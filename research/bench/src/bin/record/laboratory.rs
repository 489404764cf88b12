//! The claims of the paper with their verdicts, from two runs of the laboratory with different seeds.

use std::fmt::Write as _;

use colltrans_lab::claims::Verdict;
use colltrans_lab::statistics::Estimate;
use serde_json::Value;

use super::{Failure, number, text};

/// The verdicts in the order in which they are counted.
const VERDICTS: [Verdict; 4] =
    [Verdict::Holds, Verdict::Better, Verdict::Undecided, Verdict::Fails];

/// Where the numbers come from, every claim of the first run, and why some do not hold. Runs that were
/// broken off before all claims were tested are refused.
pub(super) fn claims(run: &Value, again: &Value, all: usize) -> Result<String, Failure> {
    let mut page = String::new();
    origin(&mut page, run, again, all)?;
    page.push_str("\n| claim | the paper | here | verdict |\n|---|---|---|---|\n");
    for claim in list(run) {
        writeln!(
            page,
            "| {} (`{}`) | {}; {} | {} | {} |",
            text(claim, "statement"),
            text(claim, "id"),
            text(claim, "paper"),
            text(claim, "place"),
            measured(claim),
            verdict(claim, again),
        )?;
    }
    page.push_str(
        "\nWhy, where a claim does not hold or is undecided, as far as the data tell:\n\n",
    );
    for claim in list(run) {
        if let Some(why) = claim["why"].as_str() {
            writeln!(page, "- `{}`: {why}", text(claim, "id"))?;
        }
    }
    Ok(page)
}

fn list(run: &Value) -> &[Value] {
    run["claims"].as_array().map_or(&[], Vec::as_slice)
}

fn of_again<'v>(claim: &Value, again: &'v Value) -> Option<&'v str> {
    let same = list(again).iter().find(|other| text(other, "id") == text(claim, "id"))?;
    Some(text(same, "verdict"))
}

fn origin(page: &mut String, run: &Value, again: &Value, all: usize) -> Result<(), Failure> {
    for run in [run, again] {
        if list(run).len() < all {
            return Err(
                format!("laboratory: {} of {all} claims were tested", list(run).len()).into()
            );
        }
    }
    let counts = VERDICTS.map(|verdict| verdict.to_string()).map(|verdict| {
        let count = list(run).iter().filter(|claim| text(claim, "verdict") == verdict).count();
        format!("{count} {verdict}")
    });
    let is_same = |claim: &&Value| of_again(claim, again) == Some(text(claim, "verdict"));
    let machine = &run["machine"];
    writeln!(
        page,
        "From a {} run with seed {} ({}) on {} cores of an {}, {}. Of {} claims: {}. A \
         {} run with seed {} gives the same verdict on {}; where it differs, its own is beside it.",
        text(run, "scale"),
        run["seed"],
        text(run, "date"),
        text(machine, "cores"),
        text(machine, "cpu"),
        text(run, "versions"),
        list(run).len(),
        counts.join(", "),
        text(again, "scale"),
        again["seed"],
        list(run).iter().filter(is_same).count(),
    )?;
    Ok(())
}

fn measured(claim: &Value) -> String {
    let numbers = claim["measured"].as_array().map_or(&[][..], Vec::as_slice).iter().map(|one| {
        let [value, low, high] = ["value", "low", "high"].map(|key| number(one, &[key]));
        format!("{} {}", Estimate { value, low, high }, text(one, "what"))
    });
    numbers.collect::<Vec<_>>().join("; ")
}

fn verdict(claim: &Value, again: &Value) -> String {
    let first = text(claim, "verdict");
    match of_again(claim, again) {
        Some(second) if second != first => format!("{first} (again: {second})"),
        _ => first.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn run(verdicts: [&str; 2]) -> Value {
        let claims = verdicts.map(|verdict| {
            json!({
                "id": verdict.len().to_string(), "statement": "It is fast.", "paper": "1/5",
                "place": "V", "verdict": verdict, "why": (verdict != "holds").then_some("It is not."),
                "measured": [{ "what": "ratio", "value": 12.34, "low": 0.5, "high": 345.6 }],
            })
        });
        json!({
            "date": "2026-01-01 10:00 UTC", "scale": "full", "seed": 7, "seconds": 600,
            "machine": { "cpu": "M", "cores": "2", "system": "s" }, "versions": "v",
            "claims": claims,
        })
    }

    #[test]
    fn every_claim_has_a_line_and_other_verdicts_are_said() {
        let page =
            claims(&run(["holds", "undecided"]), &run(["holds", "does not hold"]), 2).unwrap();
        let row = "| It is fast. (`5`) | 1/5; V | 12.3 (0.50 to 346) ratio | holds |\n";
        assert!(page.contains(row), "{page}");
        assert!(page.contains("same verdict on 1;") && page.contains("1 undecided"), "{page}");
        assert!(page.ends_with("\n- `9`: It is not.\n"), "{page}");
        let mut other = run(["holds", "undecided"]);
        other["claims"][1]["verdict"] = "does not hold".into();
        let page = claims(&run(["holds", "undecided"]), &other, 2).unwrap();
        assert!(page.contains("| undecided (again: does not hold) |"), "{page}");
    }

    #[test]
    fn runs_that_were_broken_off_are_refused() {
        let run = run(["holds", "undecided"]);
        assert!(claims(&run, &run, 2).is_ok() && claims(&run, &run, 3).is_err());
    }
}
