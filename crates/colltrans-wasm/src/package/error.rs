//! Errors: a kind, the argument at fault, and a message.

use std::fmt::Display;

use colltrans::{BuildError, PoseError, QueryError};

use crate::answer::Answer;

/// The kind of an error. The package has a class of the same name for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// An argument has the wrong form.
    Input,
    /// Points or facets do not form a body.
    Build,
    /// Numbers do not describe a pose.
    Pose,
    /// A direction, a length or an option is rejected.
    Query,
    /// The search ended without an answer.
    NotConverged,
}

/// A failed question.
#[derive(Debug)]
pub(crate) struct Failure {
    kind: Kind,
    argument: &'static str,
    message: String,
}

pub(crate) type Fallible<T> = Result<T, Failure>;

impl Failure {
    pub(crate) fn new(kind: Kind, argument: &'static str, message: impl Display) -> Self {
        Self { kind, argument, message: message.to_string() }
    }

    /// Builds the error of an argument with the wrong form.
    pub(crate) fn input(argument: &'static str, message: impl Display) -> Self {
        Self::new(Kind::Input, argument, message)
    }

    /// Returns the error for the argument called `argument`.
    pub(crate) fn of(self, argument: &'static str) -> Self {
        Self { argument, ..self }
    }

    /// Returns the kind, the argument and the message, each on a line. Only the message may have further lines.
    pub(crate) fn text(&self) -> String {
        let kind = match self.kind {
            Kind::Input => "InputError",
            Kind::Build => "BuildError",
            Kind::Pose => "PoseError",
            Kind::Query => "QueryError",
            Kind::NotConverged => "NotConvergedError",
        };
        format!("{kind}\n{}\n{}", self.argument, self.message)
    }

    pub(crate) fn into_answer(self) -> Answer {
        Answer { text: self.text().into_bytes(), numbers: Vec::new() }
    }
}

impl From<BuildError> for Failure {
    fn from(error: BuildError) -> Self {
        Self::new(Kind::Build, "", error)
    }
}

impl From<PoseError> for Failure {
    fn from(error: PoseError) -> Self {
        Self::new(Kind::Pose, "", error)
    }
}

impl From<QueryError> for Failure {
    fn from(error: QueryError) -> Self {
        let (kind, argument) = match error {
            QueryError::Direction { .. } => (Kind::Query, "direction"),
            QueryError::GrazeTolerance { .. } => (Kind::Query, "grazeTolerance"),
            QueryError::MinGap { .. } => (Kind::Query, "minGap"),
            QueryError::Length { .. } => (Kind::Query, "length"),
            QueryError::Tolerance { .. } | QueryError::NothingLeft { .. } => {
                (Kind::Query, "tolerance")
            }
            QueryError::NotASolid { .. } => (Kind::Build, ""),
            QueryError::NotConverged { .. } => (Kind::NotConverged, ""),
            _ => (Kind::Query, ""),
        };
        Self::new(kind, argument, error)
    }
}
