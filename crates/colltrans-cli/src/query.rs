//! The library's queries, as the commands ask them.

use colltrans::glam::DVec3;
use colltrans::{
    Cast, Clearance, Contact, ContactRange, ConvexPolyhedron, Options, Pose, QueryError,
};

/// Two placed bodies and a direction.
#[derive(Clone, Copy)]
pub(crate) struct Query<'a> {
    pub(crate) moving: &'a ConvexPolyhedron,
    pub(crate) moving_pose: Pose,
    pub(crate) fixed: &'a ConvexPolyhedron,
    pub(crate) fixed_pose: Pose,
    pub(crate) direction: DVec3,
    pub(crate) options: Options,
}

impl Query<'_> {
    /// As the library sees it.
    pub(crate) fn cast(&self) -> Result<Cast<'_>, QueryError> {
        let (moving, fixed) = (self.moving.at(self.moving_pose), self.fixed.at(self.fixed_pose));
        Cast::new(moving, fixed, self.direction)?.with_options(self.options)
    }

    /// At which translations the bodies first and last meet.
    pub(crate) fn contact_range(&self) -> Result<ContactRange, QueryError> {
        self.cast()?.contact_range()
    }

    /// How far the moving body can go from where it is.
    pub(crate) fn clearance(&self) -> Result<Clearance, QueryError> {
        self.cast()?.clearance()
    }
}

/// Where the contact lies on the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum When {
    /// Ahead, or here: the bodies touch.
    Ahead,
    /// The bodies overlap where they are.
    Now,
    /// The bodies meet only where the moving one has been.
    Behind,
}

/// From the first contact, and the last, which its own cast counts backwards; what is less than
/// rounding can tell is a touch.
pub(crate) fn when(first: &Contact, last: &Contact) -> When {
    if first.translation >= -first.certificate.tolerance {
        When::Ahead
    } else if last.translation < -last.certificate.tolerance {
        When::Now
    } else {
        When::Behind
    }
}

/// The translation of the last contact, which its own cast counts backwards.
pub(crate) fn exit_of(last: &Contact) -> f64 {
    // Not -0.
    0.0 - last.translation
}
