//! The claims of a run as JSON: provenance, and for each claim the paper's words, the measured number with
//! its interval, the verdict and the reason. Numbers that are not finite are `null`.

use serde_json::{Value, json};

use crate::claims::{Claim, Subject};
use crate::report::Report;

/// Returns all claims of a run.
pub(crate) fn claims(report: &Report) -> Value {
    let claims = report.done.iter().flat_map(|done| &done.finding.claims);
    let mut value = report.provenance.to_json();
    value["scale"] = json!(report.plan.scale.name());
    value["seed"] = json!(report.plan.seed);
    value["seconds"] = json!(report.wall.as_secs());
    value["experiments"] = json!({ "done": report.done.len(), "all": report.all });
    value["claims"] = claims.map(claim_json).collect();
    value
}

/// Returns one claim.
fn claim_json(claim: &Claim) -> Value {
    let measured = claim.paper.criteria.iter().zip(&claim.measured).map(|(criterion, measured)| {
        json!({
            "what": criterion.what,
            "value": measured.value,
            "low": measured.low,
            "high": measured.high,
            "judged": criterion.is_judged(),
        })
    });
    json!({
        "id": claim.paper.id,
        "statement": claim.paper.statement,
        "paper": claim.paper.paper,
        "place": claim.paper.place,
        "theme": claim.paper.theme.to_string(),
        "is_about_cta": claim.paper.subject == Subject::Cta,
        "measured": measured.collect::<Vec<_>>(),
        "verdict": claim.verdict.to_string(),
        "reason": claim.why.as_ref().map(|why| why.reason.to_string()),
        "why": claim.why.as_ref().map(|why| &why.text),
    })
}
