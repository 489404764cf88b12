//! How proofs between solids are written: covers as letters.

use serde::{Deserialize, Serialize};

use super::proof::{Cover, StartProof};
use crate::solve::bound::Reason;
use crate::solve::nearest::Apart;
use crate::solve::overlap::Overlap;

/// Reasons of covers. Sealed.
pub trait Letters: Copy + PartialEq + 'static {
    /// A letter for each; a split is [`SPLIT`].
    const LETTERS: &'static [(Self, char)];
}

impl Letters for Reason {
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

impl Letters for Apart {
    const LETTERS: &'static [(Self, char)] = &[
        (Self::AxesOfMoving, 'm'),
        (Self::AxesOfFixed, 'f'),
        (Self::SlabOfMoving, 'p'),
        (Self::SlabOfFixed, 'q'),
        (Self::Way, 'w'),
        (Self::Examined, 'x'),
    ];
}

const SPLIT: char = 's';

impl<R: Letters> From<Cover<R>> for String {
    fn from(cover: Cover<R>) -> Self {
        let letter = |reason: R| R::LETTERS.iter().find(|l| l.0 == reason).map_or(SPLIT, |l| l.1);
        cover.0.iter().map(|entry| entry.map_or(SPLIT, letter)).collect()
    }
}

impl<R: Letters> TryFrom<String> for Cover<R> {
    type Error = String;

    fn try_from(letters: String) -> Result<Self, String> {
        let entry = |letter: char| match R::LETTERS.iter().find(|l| l.1 == letter) {
            Some((reason, _)) => Ok(Some(*reason)),
            None if letter == SPLIT => Ok(None),
            None => Err(format!("the letter {letter:?} stands for nothing in a cover")),
        };
        letters.chars().map(entry).collect::<Result<_, _>>().map(Self)
    }
}

/// A [`StartProof`] as it is written.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Start {
    Assumed,
    Apart(Cover),
    Facets([u32; 2]),
    MovingInside(u32),
    FixedInside(u32),
}

impl From<StartProof> for Start {
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

impl From<Start> for StartProof {
    fn from(start: Start) -> Self {
        match start {
            Start::Assumed => Self::Assumed,
            Start::Apart(cover) => Self::Apart(cover),
            Start::Facets([f, g]) => Self::Overlapping(Overlap::Facets(f, g)),
            Start::MovingInside(t) => Self::Overlapping(Overlap::MovingInside(t)),
            Start::FixedInside(t) => Self::Overlapping(Overlap::FixedInside(t)),
        }
    }
}

#[cfg(feature = "json")]
mod file {
    use std::borrow::Cow;

    use serde::{Deserialize, Serialize};

    use crate::cast::SolidCertificate;
    use colltrans_convex::cast::CaseError;

    /// What a file of this version calls itself.
    const FORMAT: &str = "colltrans proof of a solid 1";

    #[derive(Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct File<'a> {
        format: String,
        #[serde(flatten)]
        certificate: Cow<'a, SolidCertificate>,
    }

    impl SolidCertificate {
        /// The proof as a file.
        ///
        /// # Panics
        /// Never: all numbers can be written.
        pub fn to_json(&self) -> String {
            let file = File { format: FORMAT.into(), certificate: Cow::Borrowed(self) };
            serde_json::to_string(&file).expect("numbers and letters")
        }

        /// From what [`Self::to_json`] has written. It is read, not believed.
        ///
        /// # Errors
        /// What is wrong with it.
        pub fn from_json(text: &str) -> Result<Self, CaseError> {
            let File { format, certificate } = serde_json::from_str(text)?;
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
    fn letters_of_either_cover_come_back() {
        let letters: String = Reason::LETTERS.iter().map(|l| l.1).chain([SPLIT]).collect();
        let cover = Cover::<Reason>::try_from(letters.clone()).expect("all are known");
        assert_eq!(String::from(cover), letters);
        let letters: String = Apart::LETTERS.iter().map(|l| l.1).chain([SPLIT]).collect();
        let cover = Cover::<Apart>::try_from(letters.clone()).expect("all are known");
        assert_eq!(String::from(cover), letters);
        assert!(Cover::<Apart>::try_from("sz".to_owned()).is_err());
    }
}
