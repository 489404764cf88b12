//! Formats the claims of the paper with their verdicts, from two runs of the laboratory with different seeds.

use std::fmt::Write as _;

use colltrans_lab::claims::{READINGS, Verdict};
use colltrans_lab::statistics::Estimate;
use serde_json::Value;

use super::{Failure, number, string};

/// The verdicts in the order of their counts.
const VERDICTS: [Verdict; 4] =
    [Verdict::Holds, Verdict::Better, Verdict::Undecided, Verdict::Fails];

/// Formats the provenance, every claim of the first run, both readings of "thin", and the reasons where a claim does
/// not hold or is undecided. Rejects runs without results for all claims.
pub(super) fn claims(run: &Value, again: &Value, all: usize) -> Result<String, Failure> {
    let mut page = String::new();
    write_provenance(&mut page, run, again, all)?;
    page.push_str("\n| claim | the paper | here | verdict |\n|---|---|---|---|\n");
    for claim in claim_list(run) {
        writeln!(
            page,
            "| {} (`{}`) | {}; {} | {} | {} |",
            string(claim, "statement"),
            string(claim, "id"),
            string(claim, "paper"),
            string(claim, "place"),
            format_measured(claim),
            format_verdict(claim, again),
        )?;
    }
    write_readings(&mut page, run)?;
    page.push_str(
        "\nWhy, where a claim does not hold or is undecided, as far as the data tell: what the reason lies in, and the \
         counts that show it.\n\n",
    );
    for claim in claim_list(run) {
        if let Some(why) = claim["why"].as_str() {
            writeln!(page, "- `{}`, {}: {why}", string(claim, "id"), string(claim, "reason"))?;
        }
    }
    Ok(page)
}

/// Formats the claims about thin faces, with their results under both readings of "thin".
fn write_readings(page: &mut String, run: &Value) -> Result<(), Failure> {
    let [(first, _), (second, _)] = READINGS;
    let of = |id: &str| claim_list(run).iter().find(|claim| string(claim, "id") == id);
    let pairs: Vec<_> = claim_list(run)
        .iter()
        .filter_map(|claim| {
            let name = string(claim, "id").strip_suffix(first)?;
            Some((name, [claim, of(&format!("{name}{second}"))?]))
        })
        .collect();
    if pairs.is_empty() {
        return Ok(());
    }
    let [one, other] = READINGS.map(|(_, name)| name);
    write!(
        page,
        "\nThe paper says \"very thin and stretched out\", not how thin. Its sentences, with both readings:\n\n\
         | sentence | {one} | {other} |\n|---|---|---|\n"
    )?;
    for (name, claims) in &pairs {
        let [a, b] = claims.map(|claim| {
            let first = claim["measured"].as_array().and_then(|all| all.first());
            format!(
                "{}, {}",
                first.map_or(String::new(), format_estimate),
                string(claim, "verdict")
            )
        });
        writeln!(page, "| `{name}` | {a} | {b} |")?;
    }
    let kept = |which: usize| {
        let holds = [Verdict::Holds, Verdict::Better].map(|verdict| verdict.to_string());
        let is_kept =
            |claims: &[&Value; 2]| holds.contains(&string(claims[which], "verdict").to_owned());
        pairs.iter().filter(|(_, claims)| is_kept(claims)).count()
    };
    let all = pairs.len();
    writeln!(page, "\nWith {one} {} of these {all} hold, with {other} {}.", kept(0), kept(1))?;
    Ok(())
}

/// Returns the claims of a run.
fn claim_list(run: &Value) -> &[Value] {
    run["claims"].as_array().map_or(&[], Vec::as_slice)
}

/// Returns the verdict of the other run.
fn other_verdict<'v>(claim: &Value, again: &'v Value) -> Option<&'v str> {
    let same = claim_list(again).iter().find(|other| string(other, "id") == string(claim, "id"))?;
    Some(string(same, "verdict"))
}

/// Formats the provenance.
fn write_provenance(
    page: &mut String,
    run: &Value,
    again: &Value,
    all: usize,
) -> Result<(), Failure> {
    for run in [run, again] {
        if claim_list(run).len() < all {
            return Err(format!(
                "laboratory: {} of {all} claims were tested",
                claim_list(run).len()
            )
            .into());
        }
    }
    let counts = VERDICTS.map(|verdict| verdict.to_string()).map(|verdict| {
        let count =
            claim_list(run).iter().filter(|claim| string(claim, "verdict") == verdict).count();
        format!("{count} {verdict}")
    });
    let is_same = |claim: &&Value| other_verdict(claim, again) == Some(string(claim, "verdict"));
    let machine = &run["machine"];
    writeln!(
        page,
        "From a {} run with seed {} ({}) on {} cores of an {}, {}. Of {} claims: {}. A \
         {} run with seed {} gives the same verdict on {}; where it differs, its own is beside it. The intervals of \
         both runs overlap in all numbers of {} claims.",
        string(run, "scale"),
        run["seed"],
        string(run, "date"),
        string(machine, "cores"),
        string(machine, "cpu"),
        string(run, "versions"),
        claim_list(run).len(),
        counts.join(", "),
        string(again, "scale"),
        again["seed"],
        claim_list(run).iter().filter(is_same).count(),
        claim_list(run).iter().filter(|claim| intervals_overlap(claim, again)).count(),
    )?;
    Ok(())
}

/// Whether the intervals of a claim's numbers overlap with those of the other run.
fn intervals_overlap(claim: &Value, again: &Value) -> bool {
    let same = claim_list(again).iter().find(|other| string(other, "id") == string(claim, "id"));
    let Some(same) = same else { return false };
    measured_numbers(claim).iter().zip(measured_numbers(same)).all(|(one, other)| {
        let [[a, b], [c, d]] = [one, other].map(|e| ["low", "high"].map(|key| number(e, key)));
        a <= d && c <= b
    })
}

/// Returns the measured numbers of a claim.
fn measured_numbers(claim: &Value) -> &[Value] {
    claim["measured"].as_array().map_or(&[], Vec::as_slice)
}

/// Formats an estimate with its interval.
fn format_estimate(one: &Value) -> String {
    let [value, low, high] = ["value", "low", "high"].map(|key| number(one, key));
    Estimate { value, low, high }.to_string()
}

/// Formats the measured numbers of a claim.
fn format_measured(claim: &Value) -> String {
    let each = measured_numbers(claim)
        .iter()
        .map(|one| format!("{} {}", format_estimate(one), string(one, "what")));
    each.collect::<Vec<_>>().join("; ")
}

/// Formats the verdict, with a deviating one of the other run.
fn format_verdict(claim: &Value, again: &Value) -> String {
    let first = string(claim, "verdict");
    match other_verdict(claim, again) {
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
                "reason": (verdict != "holds").then_some("today's machine"),
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
    fn every_claim_has_a_line_with_deviating_verdicts() {
        let page =
            claims(&run(["holds", "undecided"]), &run(["holds", "does not hold"]), 2).unwrap();
        let row = "| It is fast. (`5`) | 1/5; V | 12.3 (0.50 to 346) ratio | holds |\n";
        assert!(page.contains(row), "{page}");
        assert!(page.contains("same verdict on 1;") && page.contains("1 undecided"), "{page}");
        assert!(page.contains("overlap in all numbers of 1 claims"), "{page}");
        assert!(page.ends_with("\n- `9`, today's machine: It is not.\n"), "{page}");
        let mut other = run(["holds", "undecided"]);
        other["claims"][1]["verdict"] = "does not hold".into();
        let page = claims(&run(["holds", "undecided"]), &other, 2).unwrap();
        assert!(page.contains("| undecided (again: does not hold) |"), "{page}");
    }

    #[test]
    fn readings_of_thin_are_in_one_table() {
        let mut run = run(["holds", "undecided"]);
        for (claim, id) in
            run["claims"].as_array_mut().unwrap().iter_mut().zip(["7-x-stretch", "7-x-meridians"])
        {
            claim["id"] = id.into();
        }
        let page = claims(&run, &run, 2).unwrap();
        let row = "| `7-x` | 12.3 (0.50 to 346), holds | 12.3 (0.50 to 346), undecided |\n";
        assert!(page.contains(row) && page.contains("stretch of 100 1 of these 1 hold"), "{page}");
    }

    #[test]
    fn incomplete_runs_are_rejected() {
        let run = run(["holds", "undecided"]);
        assert!(claims(&run, &run, 2).is_ok() && claims(&run, &run, 3).is_err());
    }
}
