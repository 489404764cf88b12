//! Proofs between solids as files: numbers that read back as the same bits, covers as letters.

use serde::{Deserialize, Serialize};

use super::proof::{Cover, SolidCertificate, StartProof, StopProof};
use crate::cast::CaseError;
use crate::solve::solid::bound::Reason;
use crate::solve::solid::overlap::Overlap;

/// What a file of this version calls itself.
const FORMAT: &str = "colltrans proof of a solid 1";

/// A letter for each reason; a split is [`SPLIT`].
const LETTERS: [(Reason, char); 8] = [
    (Reason::MovingFacesAway, 'm'),
    (Reason::FixedFacesAway, 'f'),
    (Reason::ShadowsApart, 'a'),
    (Reason::Parting, 'p'),
    (Reason::NotBefore, 'n'),
    (Reason::Examined, 'x'),
    (Reason::Disjoint, 'd'),
    (Reason::FaceToFace, 'o'),
];
const SPLIT: char = 's';

impl SolidCertificate {
    /// The proof as a file.
    ///
    /// # Panics
    /// Never: all numbers can be written.
    pub fn to_json(&self) -> String {
        let file = File {
            format: FORMAT.into(),
            tolerance: self.tolerance,
            start: match &self.start {
                StartProof::Assumed => Start::Assumed,
                StartProof::Apart(cover) => Start::Apart(cover.to_letters()),
                StartProof::Overlapping(Overlap::Facets(f, g)) => Start::Facets([*f, *g]),
                StartProof::Overlapping(Overlap::MovingInside(t)) => Start::MovingInside(*t),
                StartProof::Overlapping(Overlap::FixedInside(t)) => Start::FixedInside(*t),
            },
            lower: Some(self.lower).filter(|lower| lower.is_finite()),
            stop: self.stop.map(|s| Stop { distance: s.shrunk_distance, triangles: s.triangles }),
            cover: self.cover.to_letters(),
        };
        serde_json::to_string(&file).expect("numbers and letters")
    }

    /// From what [`Self::to_json`] has written. It is read, not believed.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_json(text: &str) -> Result<Self, CaseError> {
        let file: File = serde_json::from_str(text)?;
        if file.format != FORMAT {
            return Err(CaseError::Format { found: file.format });
        }
        Ok(Self {
            tolerance: file.tolerance,
            start: match file.start {
                Start::Assumed => StartProof::Assumed,
                Start::Apart(letters) => StartProof::Apart(Cover::from_letters(&letters)?),
                Start::Facets([f, g]) => StartProof::Overlapping(Overlap::Facets(f, g)),
                Start::MovingInside(t) => StartProof::Overlapping(Overlap::MovingInside(t)),
                Start::FixedInside(t) => StartProof::Overlapping(Overlap::FixedInside(t)),
            },
            lower: file.lower.unwrap_or(f64::INFINITY),
            stop: file
                .stop
                .map(|s| StopProof { shrunk_distance: s.distance, triangles: s.triangles }),
            cover: Cover::from_letters(&file.cover)?,
        })
    }
}

impl Cover {
    fn to_letters(&self) -> String {
        let letter = |reason: Reason| LETTERS.iter().find(|l| l.0 == reason).map_or(SPLIT, |l| l.1);
        self.0.iter().map(|entry| entry.map_or(SPLIT, letter)).collect()
    }

    fn from_letters(letters: &str) -> Result<Self, CaseError> {
        let entry = |letter: char| match LETTERS.iter().find(|l| l.1 == letter) {
            Some((reason, _)) => Ok(Some(*reason)),
            None if letter == SPLIT => Ok(None),
            None => Err(CaseError::Letter { letter }),
        };
        letters.chars().map(entry).collect::<Result<_, _>>().map(Self)
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: String,
    tolerance: f64,
    start: Start,
    /// Infinite if there is none.
    lower: Option<f64>,
    stop: Option<Stop>,
    cover: String,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Start {
    Assumed,
    Apart(String),
    Facets([u32; 2]),
    MovingInside(u32),
    FixedInside(u32),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stop {
    /// Of the shrunk bodies.
    distance: f64,
    triangles: [u32; 2],
}
