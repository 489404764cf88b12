//! Serialised form of certificates between solids: a cover is a string with one letter for each entry.

use serde::{Deserialize, Serialize};

use super::proof::{Cover, StartProof};
use crate::solve::bound::Reason;
use crate::solve::nearest::Apart;
use crate::solve::overlap::Overlap;

/// Reasons of covers and their letters. Sealed.
pub trait ReasonLetters: Copy + PartialEq + 'static {
    /// Letter of each reason; [`SPLIT_LETTER`] is a split.
    const LETTERS: &'static [(Self, char)];
}

impl ReasonLetters for Reason {
    const LETTERS: &'static [(Self, char)] = &[
        (Self::MovingFacesAway, 'm'),
        (Self::FixedFacesAway, 'f'),
        (Self::ShadowsApart, 'a'),
        (Self::Parting, 'p'),
        (Self::NotBefore, 'n'),
        (Self::Examined, 'x'),
        (Self::Disjoint, 'd'),
        (Self::FaceToFace, 'o'),
    ];
}

impl ReasonLetters for Apart {
    const LETTERS: &'static [(Self, char)] = &[
        (Self::AxesOfMoving, 'm'),
        (Self::AxesOfFixed, 'f'),
        (Self::SlabOfMoving, 'p'),
        (Self::SlabOfFixed, 'q'),
        (Self::Way, 'w'),
        (Self::NearestPlane, 'n'),
        (Self::Examined, 'x'),
    ];
}

/// Letter of a pair of nodes that was split.
const SPLIT_LETTER: char = 's';

impl<R: ReasonLetters> From<Cover<R>> for String {
    fn from(cover: Cover<R>) -> Self {
        let letter =
            |reason: R| R::LETTERS.iter().find(|l| l.0 == reason).map_or(SPLIT_LETTER, |l| l.1);
        cover.0.iter().map(|entry| entry.map_or(SPLIT_LETTER, letter)).collect()
    }
}

impl<R: ReasonLetters> TryFrom<String> for Cover<R> {
    type Error = String;

    fn try_from(letters: String) -> Result<Self, String> {
        let entry = |letter: char| match R::LETTERS.iter().find(|l| l.1 == letter) {
            Some((reason, _)) => Ok(Some(*reason)),
            None if letter == SPLIT_LETTER => Ok(None),
            None => Err(format!("unknown letter {letter:?} in a cover")),
        };
        letters.chars().map(entry).collect::<Result<_, _>>().map(Self)
    }
}

/// Serialised form of a [`StartProof`].
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum StoredStart {
    Assumed,
    Apart(Cover),
    Facets([u32; 2]),
    MovingInside(u32),
    FixedInside(u32),
}

impl From<StartProof> for StoredStart {
    fn from(start: StartProof) -> Self {
        match start {
            StartProof::Assumed => Self::Assumed,
            StartProof::Apart(cover) => Self::Apart(cover),
            StartProof::Overlapping(Overlap::Facets(f, g)) => Self::Facets([f, g]),
            StartProof::Overlapping(Overlap::MovingInside(t)) => Self::MovingInside(t),
            StartProof::Overlapping(Overlap::FixedInside(t)) => Self::FixedInside(t),
        }
    }
}

impl From<StoredStart> for StartProof {
    fn from(start: StoredStart) -> Self {
        match start {
            StoredStart::Assumed => Self::Assumed,
            StoredStart::Apart(cover) => Self::Apart(cover),
            StoredStart::Facets([f, g]) => Self::Overlapping(Overlap::Facets(f, g)),
            StoredStart::MovingInside(t) => Self::Overlapping(Overlap::MovingInside(t)),
            StoredStart::FixedInside(t) => Self::Overlapping(Overlap::FixedInside(t)),
        }
    }
}

#[cfg(feature = "json")]
mod file {
    use std::borrow::Cow;

    use serde::{Deserialize, Serialize};

    use crate::cast::SolidCertificate;
    use colltrans_convex::cast::CaseError;

    /// Format name in files of this version.
    const FORMAT: &str = "colltrans proof of a solid 1";

    #[derive(Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct ProofFile<'a> {
        format: String,
        #[serde(flatten)]
        certificate: Cow<'a, SolidCertificate>,
    }

    impl SolidCertificate {
        /// Returns the certificate as a file in JSON.
        ///
        /// # Panics
        /// Never: every field can be serialised.
        pub fn to_json(&self) -> String {
            let file = ProofFile { format: FORMAT.into(), certificate: Cow::Borrowed(self) };
            serde_json::to_string(&file).expect("all fields can be serialised")
        }

        /// Reads a certificate that [`Self::to_json`] has written, without verifying it.
        ///
        /// # Errors
        /// The text is not such a file, or has another format name.
        pub fn from_json(text: &str) -> Result<Self, CaseError> {
            let ProofFile { format, certificate } = serde_json::from_str(text)?;
            if format == FORMAT {
                Ok(certificate.into_owned())
            } else {
                Err(CaseError::Format { found: format, known: FORMAT })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn covers_survive_conversion_to_letters() {
        let letters: String = Reason::LETTERS.iter().map(|l| l.1).chain([SPLIT_LETTER]).collect();
        let cover = Cover::<Reason>::try_from(letters.clone()).expect("all are known");
        assert_eq!(String::from(cover), letters);
        let letters: String = Apart::LETTERS.iter().map(|l| l.1).chain([SPLIT_LETTER]).collect();
        let cover = Cover::<Apart>::try_from(letters.clone()).expect("all are known");
        assert_eq!(String::from(cover), letters);
        assert!(Cover::<Apart>::try_from("sz".to_owned()).is_err());
    }
}
