//! The questions, as the page writes them: objects with a field `do`.
//!
//! Read by hand but for proofs, which the library reads: what derived readers of all of them would add is a
//! third of the download.

use colltrans::{Solver, cta};
use colltrans_mesh::body::Take;
use serde::Deserialize;
use serde_json::Value;

use super::record::Proof;
use crate::fields::Fields;

/// One question.
#[derive(Debug)]
pub(crate) enum Question {
    /// The file that comes with the question becomes a body.
    Load(Load),
    /// When do they meet, and how far can the moving one go?
    Cast(Pair),
    /// A proof of the clearance between solids.
    Certify(Pair),
    /// Is this proof, as an answer had it, one?
    Verify(Pair, Proof),
}

/// Which of the two bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Slot {
    Moving,
    Fixed,
}

#[derive(Debug)]
pub(crate) struct Load {
    pub(crate) slot: Slot,
    /// The file's name; its extension tells the format.
    pub(crate) name: String,
    pub(crate) take: Take,
}

/// Two placed bodies and a direction. Poses are `x,y,z,qx,qy,qz,qw`.
#[derive(Debug, Clone)]
pub(crate) struct Pair {
    pub(crate) moving_pose: [f64; 7],
    pub(crate) fixed_pose: [f64; 7],
    pub(crate) direction: [f64; 3],
    /// Between convex bodies: sideways overlap that counts as grazing.
    pub(crate) graze: f64,
    /// Between convex bodies.
    pub(crate) solver: Solver,
    /// Of `cta`: from `start`, `center` or `ellipsoids`, `until` it ends, `exit` or a gap.
    pub(crate) narrowing: cta::Options,
    /// Between solids: by how much they are shrunk; what the files' precision asks for by default.
    pub(crate) tolerance: Option<f64>,
    /// Between solids: facets that cross at the start do not block.
    pub(crate) ignore_overlaps: bool,
}

impl Question {
    /// From JSON.
    pub(crate) fn read(text: &[u8]) -> Result<Self, String> {
        let value: Value = serde_json::from_slice(text).map_err(|error| error.to_string())?;
        let fields = Fields::of(&value)?;
        match fields.text("do")? {
            "load" => fields.load().map(Self::Load),
            "cast" => fields.pair().map(Self::Cast),
            "certify" => fields.pair().map(Self::Certify),
            "verify" => {
                let proof = Proof::deserialize(fields.need("proof")?);
                Ok(Self::Verify(fields.pair()?, proof.map_err(|error| error.to_string())?))
            }
            other => Err(format!("nothing is known to do for {other}")),
        }
    }
}

/// A question's fields, as a question reads them.
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
            other => return Err(format!("there is no body {other}")),
        };
        let take = match self.text("take")? {
            "convex" => Take::Convex,
            "hull" => Take::Hull,
            "solid" => Take::Solid,
            "open" => Take::Open,
            other => return Err(format!("a mesh cannot be taken as {other}")),
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
