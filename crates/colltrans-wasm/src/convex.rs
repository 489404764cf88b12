//! Casts between convex bodies, and the check of their proofs.

use colltrans::{
    Cast, Certificate, Clearance, Contact, ContactRange, Options, Separated, Solver, Steps,
    VertexPair,
};
use glam::DVec3;
use serde::Serialize;
use serde_json::{Value, json};

use crate::body::{Hull, Lit};
use crate::desk::{Answer, Refusal};
use crate::pose::pose;
use crate::question::{self, Pair, Proof};

/// The query that a question asks.
pub(crate) fn query<'a>([moving, fixed]: [&'a Hull; 2], pair: &Pair) -> Result<Cast<'a>, Refusal> {
    let moving = moving.body.at(pose(pair.moving_pose, "moving")?);
    let fixed = fixed.body.at(pose(pair.fixed_pose, "fixed")?);
    let solver = match pair.solver {
        question::Solver::Auto => Solver::Auto,
        question::Solver::Cta => Solver::Cta,
        question::Solver::Portal => Solver::Portal,
    };
    let options = Options { solver, graze_tolerance: pair.graze, ..Options::default() };
    let cast = Cast::new(moving, fixed, DVec3::from_array(pair.direction));
    Ok(cast.and_then(|cast| cast.with_options(options)).map_err(|error| error.to_string())?)
}

#[derive(Debug, Serialize)]
struct Told {
    kind: &'static str,
    outcome: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    first: Option<Touch>,
    /// The last contact, in multiples of the direction.
    #[serde(skip_serializing_if = "Option::is_none")]
    exit: Option<f64>,
    /// How far the shadows overlap, where they graze.
    #[serde(skip_serializing_if = "Option::is_none")]
    overlap: Option<f64>,
    /// Of the separating plane, or the direction along which the shadows graze.
    #[serde(skip_serializing_if = "Option::is_none")]
    sideways: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    margin: Option<f64>,
    clearance: Free,
    steps: Work,
}

/// How far the moving body can go from where it is.
#[derive(Debug, Serialize)]
struct Free {
    kind: &'static str,
    /// In multiples of the direction; nothing stops it if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    distance: Option<f64>,
}

/// The contact, with its proof.
#[derive(Debug, Serialize)]
struct Touch {
    t: f64,
    normal: [f64; 3],
    on_moving: [f64; 3],
    on_fixed: [f64; 3],
    moving: Lit,
    fixed: Lit,
    proof: Proven,
}

#[derive(Debug, Serialize)]
struct Proven {
    normal: [f64; 3],
    lower: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    upper: Option<f64>,
    pairs: [[u32; 2]; 3],
    weights: [f64; 3],
    tolerance: f64,
}

#[derive(Debug, Serialize)]
pub(crate) struct Work {
    solver: &'static str,
    planar_problems: u32,
    supports: u32,
    pivots: u32,
    iterations: u32,
}

impl Work {
    pub(crate) fn of(solver: Solver, steps: &Steps) -> Self {
        Self {
            solver: match solver {
                Solver::Cta => "cta",
                _ => "portal",
            },
            planar_problems: steps.planar_problems,
            supports: steps.supports,
            pivots: steps.pivots,
            iterations: steps.iterations,
        }
    }
}

impl Touch {
    fn of(contact: &Contact, cast: &Cast) -> Self {
        let (points, features) = (contact.points(cast), contact.features(cast));
        let proof = &contact.certificate;
        Self {
            t: contact.translation,
            normal: contact.normal.to_array(),
            on_moving: points.on_moving.to_array(),
            on_fixed: points.on_fixed.to_array(),
            moving: Lit::of_hull(features.moving, cast.moving()),
            fixed: Lit::of_hull(features.fixed, cast.fixed()),
            proof: Proven {
                normal: proof.normal.to_array(),
                lower: proof.lower,
                upper: proof.upper.is_finite().then_some(proof.upper),
                pairs: proof.pairs.map(|pair| [pair.moving, pair.fixed]),
                weights: proof.weights,
                tolerance: proof.tolerance,
            },
        }
    }
}

pub(crate) fn cast(bodies: [&Hull; 2], pair: &Pair) -> Result<Answer, Refusal> {
    let cast = query(bodies, pair)?;
    let range = cast.contact_range().map_err(|error| error.to_string())?;
    let clearance = cast.clearance().map_err(|error| error.to_string())?;
    let exit = range.interval().map(|[_, exit]| exit);
    let free = free(&clearance);
    let told = match range {
        ContactRange::Contact { first, .. } => Told {
            kind: "convex",
            outcome: "contact",
            first: Some(Touch::of(&first, &cast)),
            exit,
            overlap: None,
            sideways: None,
            margin: None,
            clearance: free,
            steps: Work::of(first.solver, &first.steps),
        },
        ContactRange::Grazing { first, .. } => Told {
            kind: "convex",
            outcome: "grazing",
            first: Some(Touch::of(&first.contact, &cast)),
            exit,
            overlap: Some(first.overlap),
            sideways: Some(first.separating_direction.to_array()),
            margin: None,
            clearance: free,
            steps: Work::of(first.contact.solver, &first.contact.steps),
        },
        ContactRange::Separated(separated) => separated_told(&separated, free),
    };
    Ok(Answer::of(&told))
}

fn separated_told(separated: &Separated, clearance: Free) -> Told {
    Told {
        kind: "convex",
        outcome: "separated",
        first: None,
        exit: None,
        overlap: None,
        sideways: Some(separated.certificate.normal.to_array()),
        margin: Some(separated.certificate.margin),
        clearance,
        steps: Work::of(separated.solver, &separated.steps),
    }
}

fn free(clearance: &Clearance) -> Free {
    let kind = match clearance {
        Clearance::Blocked { .. } => "blocked",
        Clearance::Slides(_) => "slides",
        Clearance::Behind(_) => "behind",
        Clearance::Separated(_) => "separated",
        Clearance::Overlapping { .. } => "overlapping",
    };
    Free { kind, distance: clearance.distance().filter(|distance| distance.is_finite()) }
}

/// Checks a proof as it was written, against the two bodies alone.
pub(crate) fn verify(bodies: [&Hull; 2], pair: &Pair, proof: &Proof) -> Result<Answer, Refusal> {
    let cast = query(bodies, pair)?;
    let checked = match proof {
        Proof::Contact(given) => cast.verify(&Certificate {
            normal: DVec3::from_array(given.normal),
            lower: given.lower,
            upper: given.upper.unwrap_or(f64::INFINITY),
            pairs: given.pairs.map(|[moving, fixed]| VertexPair { moving, fixed }),
            weights: given.weights,
            tolerance: given.tolerance,
        }),
        Proof::Separation { normal, margin } => cast
            .verify(&colltrans::Separation { normal: DVec3::from_array(*normal), margin: *margin }),
    };
    let told: Value = match checked {
        Ok(proven) => json!({ "holds": true, "proven": proven }),
        Err(error) => json!({ "holds": false, "because": error.to_string() }),
    };
    Ok(Answer::of(&told))
}
