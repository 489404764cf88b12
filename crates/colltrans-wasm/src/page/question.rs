//! The questions as the page writes them: objects with a field `do`.
//!
//! They are read by hand, except proofs, which the library reads, because derived readers of all of them
//! would add a third to the download.

use colltrans::{Solver, cta};
use colltrans_mesh::body::BodyKind;
use serde::Deserialize;
use serde_json::Value;

use super::record::Proof;
use crate::fields::Fields;

/// A question.
#[derive(Debug)]
pub(crate) enum Question {
    /// Builds a body from the attached file.
    Load(Load),
    /// Computes the contacts, and the clearance of the moving body.
    Cast(Pair),
    /// Builds a proof of the clearance between solids.
    #[cfg(feature = "min-gap")]
    Certify(Pair),
    /// Checks a proof of an earlier answer.
    Verify(Pair, Proof),
}

/// The body of a question.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Slot {
    Moving,
    Fixed,
}

#[derive(Debug)]
pub(crate) struct Load {
    pub(crate) slot: Slot,
    /// The file name, whose extension selects the format.
    pub(crate) name: String,
    pub(crate) take: BodyKind,
}

/// Two placed bodies and a direction. Poses are `x,y,z,qx,qy,qz,qw`.
#[derive(Debug, Clone)]
pub(crate) struct Pair {
    pub(crate) moving_pose: [f64; 7],
    pub(crate) fixed_pose: [f64; 7],
    pub(crate) direction: [f64; 3],
    /// Graze tolerance, for convex bodies.
    pub(crate) graze: f64,
    /// The solver, for convex bodies.
    pub(crate) solver: Solver,
    /// For the solver `cta`: `start` is `center`, `ellipsoids` or `guess`, `until` is `exit` or a gap.
    pub(crate) narrowing: cta::Options,
    /// Tolerance of solids; the default follows from the precision of the files.
    #[cfg_attr(not(feature = "min-gap"), expect(dead_code, reason = "there are no solids"))]
    pub(crate) tolerance: Option<f64>,
    /// Whether facets of solids that cross at the start are ignored.
    #[cfg_attr(not(feature = "min-gap"), expect(dead_code, reason = "there are no solids"))]
    pub(crate) ignore_overlaps: bool,
}

impl Question {
    /// Reads a question from JSON.
    pub(crate) fn read(text: &[u8]) -> Result<Self, String> {
        let value: Value = serde_json::from_slice(text).map_err(|error| error.to_string())?;
        let fields = Fields::from_value(&value)?;
        match fields.text("do")? {
            "load" => fields.load().map(Self::Load),
            "cast" => fields.pair().map(Self::Cast),
            #[cfg(feature = "min-gap")]
            "certify" => fields.pair().map(Self::Certify),
            "verify" => {
                let proof = Proof::deserialize(fields.required("proof")?);
                Ok(Self::Verify(fields.pair()?, proof.map_err(|error| error.to_string())?))
            }
            other => Err(format!("unknown question {other}")),
        }
    }
}

/// Reads parts of a question from its fields.
trait Read {
    fn load(&self) -> Result<Load, String>;
    fn pair(&self) -> Result<Pair, String>;
    fn narrowing(&self) -> Result<cta::Options, String>;
}

impl Read for Fields<'_> {
    fn load(&self) -> Result<Load, String> {
        let slot = match self.text("slot")? {
            "moving" => Slot::Moving,
            "fixed" => Slot::Fixed,
            other => return Err(format!("unknown body {other}; known bodies: moving, fixed")),
        };
        let take = match self.text("take")? {
            "convex" => BodyKind::Convex,
            "hull" => BodyKind::Hull,
            "solid" => BodyKind::Solid,
            "open" => BodyKind::Open,
            other => {
                return Err(format!(
                    "unknown kind of body {other}; known kinds: convex, hull, solid, open"
                ));
            }
        };
        Ok(Load { slot, name: self.text("name")?.to_owned(), take })
    }

    fn pair(&self) -> Result<Pair, String> {
        let solver =
            self.get("solver").and_then(Value::as_str).map_or(Ok(Solver::Auto), str::parse);
        let solver = solver.map_err(|error| error.to_string())?;
        Ok(Pair {
            moving_pose: self.array("moving_pose")?,
            fixed_pose: self.array("fixed_pose")?,
            direction: self.array("direction")?,
            graze: self.number("graze")?.unwrap_or(0.0),
            solver,
            narrowing: self.narrowing()?,
            tolerance: self.number("tolerance")?,
            ignore_overlaps: self.flag("ignore_overlaps"),
        })
    }

    fn narrowing(&self) -> Result<cta::Options, String> {
        let cta::Options { start, until, .. } = cta::Options::default();
        let text = |name| self.get(name).and_then(Value::as_str);
        let start = text("start").map_or(Ok(start), str::parse).map_err(|e| e.to_string())?;
        let until = match self.number("until") {
            Ok(gap) => gap.map_or(until, cta::Until::Gap),
            Err(_) if text("until") == Some("exit") => cta::Until::Exit,
            Err(error) => return Err(error),
        };
        Ok(cta::Options::new(start, until))
    }
}
