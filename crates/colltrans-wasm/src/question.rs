//! The questions, as the page writes them: objects with a field `do`.
//!
//! Read by hand: what derived readers add would be a third of the download.

use colltrans::solid::StopProof;
use colltrans::{Certificate, Separation, Solver, VertexPair};
use colltrans_mesh::body::Take;
use glam::DVec3;
use serde_json::Value;

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
    /// What does a search do?
    Search(Search),
    /// The collision translation of pairs of sections.
    Levels(Levels),
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
    /// Between solids: by how much they are shrunk; what the files' precision asks for by default.
    pub(crate) tolerance: Option<f64>,
    /// Between solids: facets that cross at the start do not block.
    pub(crate) ignore_overlaps: bool,
}

/// A proof to check.
#[derive(Debug)]
pub(crate) enum Proof {
    Contact(Certificate),
    Separation(Separation),
    /// Between solids.
    Clearance(Claimed),
}

/// What a proof between solids says; its entries come as the file, a byte each.
#[derive(Debug)]
pub(crate) struct Claimed {
    pub(crate) tolerance: f64,
    /// Infinite where nothing ever stops the body.
    pub(crate) lower: f64,
    pub(crate) stop: Option<StopProof>,
    /// Where they overlap at the start: in which way, and the triangles.
    pub(crate) overlap: Option<(String, Vec<u32>)>,
    /// How many of the entries are about the start.
    pub(crate) start_entries: usize,
}

/// A search to look at.
#[derive(Debug)]
pub(crate) struct Search {
    pub(crate) pair: Pair,
    /// The minimisation starts at the centre of all levels, as in the paper, and ends when its bounds
    /// are this close, as a share of the bodies' extent; else as the library does by default.
    pub(crate) from_center: Option<f64>,
    /// A query asked before, whose answer a tracker starts from.
    pub(crate) after: Option<Pair>,
}

/// A grid of pairs of levels.
#[derive(Debug)]
pub(crate) struct Levels {
    pub(crate) pair: Pair,
    /// Section axes in the world.
    pub(crate) axes: [[f64; 3]; 2],
    /// Levels of the moving and of the fixed body's sections, each in its own frame.
    pub(crate) at: [Vec<f64>; 2],
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
            "verify" => Ok(Self::Verify(fields.pair()?, fields.object("proof")?.proof()?)),
            "search" => fields.search().map(Self::Search),
            "levels" => fields.levels().map(Self::Levels),
            other => Err(format!("nothing is known to do for {other}")),
        }
    }
}

/// A question's fields, as a question reads them.
trait Read {
    fn load(&self) -> Result<Load, String>;
    fn pair(&self) -> Result<Pair, String>;
    fn proof(&self) -> Result<Proof, String>;
    fn claimed(&self) -> Result<Claimed, String>;
    fn search(&self) -> Result<Search, String>;
    fn levels(&self) -> Result<Levels, String>;
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
            tolerance: self.number("tolerance")?,
            ignore_overlaps: self.flag("ignore_overlaps"),
        })
    }

    fn proof(&self) -> Result<Proof, String> {
        if let Ok(given) = self.object("separation") {
            let margin = given.number("margin")?.ok_or("margin is missing")?;
            let normal = DVec3::from_array(given.array("normal")?);
            return Ok(Proof::Separation(Separation { normal, margin }));
        }
        if let Ok(given) = self.object("clearance") {
            return given.claimed().map(Proof::Clearance);
        }
        let given = self.object("contact")?;
        let number = |key: &str| given.number(key)?.ok_or_else(|| format!("{key} is missing"));
        Ok(Proof::Contact(Certificate {
            normal: DVec3::from_array(given.array("normal")?),
            lower: number("lower")?,
            upper: given.number("upper")?.unwrap_or(f64::INFINITY),
            pairs: pairs(given.need("pairs")?).ok_or("pairs are not three pairs of vertices")?,
            weights: given.array("weights")?,
            rounding: number("rounding")?,
        }))
    }

    fn claimed(&self) -> Result<Claimed, String> {
        let triangles = |key: &str, from: &Self| -> Result<Vec<u32>, String> {
            Ok(from.list(key)?.into_iter().map(|x| x as u32).collect())
        };
        let missing = |key: &str| format!("{key} is missing");
        let stop = self.get("stop").is_some().then(|| -> Result<_, String> {
            let stop = self.object("stop")?;
            let shrunk_distance =
                stop.number("shrunk_distance")?.ok_or_else(|| missing("shrunk_distance"))?;
            let two = triangles("triangles", &stop)?.try_into();
            let triangles = two.map_err(|_| "triangles are not two".to_owned())?;
            Ok(StopProof { shrunk_distance, triangles })
        });
        let overlap = self.get("overlap").is_some().then(|| -> Result<_, String> {
            let overlap = self.object("overlap")?;
            Ok((overlap.text("kind")?.to_owned(), triangles("triangles", &overlap)?))
        });
        Ok(Claimed {
            tolerance: self.number("tolerance")?.ok_or_else(|| missing("tolerance"))?,
            lower: self.number("lower")?.unwrap_or(f64::INFINITY),
            stop: stop.transpose()?,
            overlap: overlap.transpose()?,
            start_entries: self.number("start_entries")?.unwrap_or(0.0) as usize,
        })
    }

    fn search(&self) -> Result<Search, String> {
        let after =
            self.get("after").is_some().then(|| self.object("after")?.pair()).transpose()?;
        Ok(Search { pair: self.pair()?, from_center: self.number("from_center")?, after })
    }

    fn levels(&self) -> Result<Levels, String> {
        Ok(Levels {
            pair: self.pair()?,
            axes: [self.array("moving_axis")?, self.array("fixed_axis")?],
            at: [self.list("moving_levels")?, self.list("fixed_levels")?],
        })
    }
}

fn pairs(value: &Value) -> Option<[VertexPair; 3]> {
    let pair = |value: &Value| -> Option<VertexPair> {
        let [moving, fixed] = value.as_array()?.as_slice() else { return None };
        let vertex = |v: &Value| u32::try_from(v.as_u64()?).ok();
        Some(VertexPair { moving: vertex(moving)?, fixed: vertex(fixed)? })
    };
    let [a, b, c] = value.as_array()?.as_slice() else { return None };
    Some([pair(a)?, pair(b)?, pair(c)?])
}
