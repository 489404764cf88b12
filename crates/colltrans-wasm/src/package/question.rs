//! Questions as the package writes them: little-endian doubles, and bytes behind them.

use colltrans::glam::{DMat3, DQuat, DVec3};
use colltrans::{Options, Pose, Solver};

use super::error::{Failure, Fallible};

/// Defines the questions and their numbers.
macro_rules! questions {
    ($($(#[$doc:meta])* $name:ident = $number:literal,)*) => {
        /// A question. Its number is the first one of the list.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Question {
            $($(#[$doc])* $name = $number,)*
        }

        impl Question {
            /// The names and numbers of all questions.
            pub const ALL: &[(&str, u8)] = &[$((stringify!($name), $number)),*];

            fn from_number(number: f64) -> Option<Self> {
                $(if number == f64::from($number) { return Some(Self::$name); })*
                None
            }
        }
    };
}

questions! {
    /// Removes a body.
    Free = 0,
    /// Builds the convex hull of points.
    Hull = 1,
    /// Builds a convex body from a closed convex mesh.
    Mesh = 2,
    /// Builds a box from two corners.
    Cuboid = 3,
    /// Builds a copy of a body, swept by a ball.
    Rounded = 4,
    /// Builds a solid from the polygons of its surface.
    Solid = 5,
    /// Builds the union of bodies.
    Union = 6,
    /// Returns the properties of a body.
    Properties = 7,
    /// Returns the vertices of a body.
    Vertices = 8,
    /// Returns the triangles of a body.
    Triangles = 9,
    /// Computes the first contact along a direction.
    Cast = 10,
    /// Computes the free travel along a direction.
    Clearance = 11,
    /// Computes the first and the last contact along a direction.
    ContactRange = 12,
    /// Checks whether the bodies meet.
    Intersects = 13,
    /// Computes the distance.
    Distance = 14,
    /// Computes the depth of the overlap.
    Depth = 15,
    /// Compares the distance with a length.
    Within = 16,
    /// Computes the first contact of moving bodies.
    Motion = 17,
    /// Returns the pose of a motion at a time.
    PoseAt = 18,
    /// Answers a question for rows of poses and directions.
    Rows = 19,
}

/// Reads the numbers of a question one after the other.
#[derive(Debug, Clone)]
pub(crate) struct Numbers<'a>(&'a [u8]);

/// The form of a pose: the number of its numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) enum PoseForm {
    Identity,
    Translation,
    Quaternion,
    Matrix,
}

impl PoseForm {
    /// Returns the form with this number of numbers.
    pub(crate) fn from_width(width: usize) -> Fallible<Self> {
        Ok(match width {
            0 => Self::Identity,
            3 => Self::Translation,
            7 => Self::Quaternion,
            12 => Self::Matrix,
            _ => return Err(Failure::input("", format_args!("a pose of {width} numbers"))),
        })
    }
}

impl<'a> Numbers<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    pub(crate) fn next(&mut self) -> Fallible<f64> {
        let (first, rest) = self.0.split_first_chunk().ok_or_else(|| short("numbers"))?;
        self.0 = rest;
        Ok(f64::from_le_bytes(*first))
    }

    pub(crate) fn question(&mut self) -> Fallible<Question> {
        Question::from_number(self.next()?)
            .ok_or_else(|| Failure::input("", "unknown question of the package"))
    }

    pub(crate) fn count(&mut self) -> Fallible<usize> {
        Ok(self.next()? as usize)
    }

    pub(crate) fn vector(&mut self) -> Fallible<DVec3> {
        Ok(DVec3::new(self.next()?, self.next()?, self.next()?))
    }

    /// Reads a number that may be absent: NaN.
    pub(crate) fn option(&mut self) -> Fallible<Option<f64>> {
        Ok(Some(self.next()?).filter(|number| !number.is_nan()))
    }

    /// Reads a pose after the number of its numbers.
    pub(crate) fn pose(&mut self, argument: &'static str) -> Fallible<Pose> {
        let form = PoseForm::from_width(self.count()?)?;
        self.pose_in(form).map_err(|error| error.of(argument))
    }

    /// Reads a pose in a form: a position, then a quaternion `x, y, z, w` or the columns of a rotation.
    pub(crate) fn pose_in(&mut self, form: PoseForm) -> Fallible<Pose> {
        if matches!(form, PoseForm::Identity) {
            return Ok(Pose::IDENTITY);
        }
        let position = self.vector()?;
        Ok(match form {
            PoseForm::Quaternion => {
                let [x, y, z, w] = [self.next()?, self.next()?, self.next()?, self.next()?];
                Pose::new(DQuat::from_xyzw(x, y, z, w), position)?
            }
            PoseForm::Matrix => {
                let columns = [self.vector()?, self.vector()?, self.vector()?];
                let [x, y, z] = columns;
                Pose::from_matrix(DMat3::from_cols(x, y, z), position)?
            }
            PoseForm::Identity | PoseForm::Translation => Pose::from_translation(position)?,
        })
    }

    /// Returns the next `count` numbers, and leaves the ones behind them.
    pub(crate) fn split(&mut self, count: usize) -> Fallible<Self> {
        let bytes = count.checked_mul(8).ok_or_else(|| short("rows"))?;
        let (first, rest) = self.0.split_at_checked(bytes).ok_or_else(|| short("rows"))?;
        self.0 = rest;
        Ok(Self(first))
    }

    /// Returns the numbers from the number with this index on.
    pub(crate) fn skip(&self, count: usize) -> Self {
        Self(self.0.get(count.saturating_mul(8)..).unwrap_or_default())
    }
}

/// The options of a question along a direction or a motion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CastOptions {
    pub(crate) graze_tolerance: Option<f64>,
    pub(crate) min_gap: f64,
    pub(crate) solver: Solver,
    pub(crate) tolerance: Option<f64>,
    pub(crate) ignore_start_overlaps: bool,
}

impl CastOptions {
    pub(crate) fn read(numbers: &mut Numbers<'_>) -> Fallible<Self> {
        Ok(Self {
            graze_tolerance: numbers.option()?,
            min_gap: numbers.next()?,
            solver: [Solver::Auto, Solver::Cta, Solver::Portal]
                .into_iter()
                .nth(numbers.count()?)
                .unwrap_or(Solver::Auto),
            tolerance: numbers.option()?,
            ignore_start_overlaps: numbers.next()? != 0.0,
        })
    }

    /// Returns the options of a cast of convex bodies.
    pub(crate) fn convex(&self) -> Options {
        Options::default()
            .with_solver(self.solver)
            .with_graze_tolerance(self.graze_tolerance.unwrap_or_default())
            .with_min_gap(self.min_gap)
    }

    /// Rejects the options of solids.
    pub(crate) fn for_convex(&self) -> Fallible<()> {
        let message = "it is an option for solids; convex bodies have grazeTolerance";
        if self.tolerance.is_some() {
            return Err(Failure::input("tolerance", message));
        }
        if self.ignore_start_overlaps {
            return Err(Failure::input("ignoreStartOverlaps", message));
        }
        Ok(())
    }
}

/// The coordinates and the faces of a mesh, from the bytes behind a question.
#[derive(Debug)]
pub(crate) struct MeshInput {
    pub(crate) points: Vec<DVec3>,
    pub(crate) faces: Vec<Vec<u32>>,
}

impl MeshInput {
    /// Reads a number of points, then the corners of faces: all triangles if `sizes` is 0, otherwise polygons of
    /// that number of sizes, which follow the corners.
    pub(crate) fn read(
        bytes: &[u8],
        points: usize,
        corners: usize,
        sizes: usize,
    ) -> Fallible<Self> {
        let mut numbers = Numbers::new(bytes);
        let coordinates = numbers.split(points.saturating_mul(3))?;
        let points = self::points(coordinates.0);
        let indices: Vec<u32> =
            numbers.0.as_chunks().0.iter().copied().map(u32::from_le_bytes).collect();
        if indices.len() != corners.saturating_add(sizes) {
            return Err(short("indices"));
        }
        let (corners, sizes) = indices.split_at(corners);
        let mut faces = Vec::with_capacity(sizes.len().max(corners.len() / 3));
        if sizes.is_empty() {
            faces.extend(corners.as_chunks::<3>().0.iter().map(|corners| corners.to_vec()));
        }
        let mut rest = corners;
        for &size in sizes {
            let face = rest.split_at_checked(size as usize).ok_or_else(|| short("faces"))?;
            faces.push(face.0.to_vec());
            rest = face.1;
        }
        Ok(Self { points, faces })
    }
}

/// Reads points, three numbers each.
pub(crate) fn points(bytes: &[u8]) -> Vec<DVec3> {
    let number = |bytes: &[u8; 8]| f64::from_le_bytes(*bytes);
    let numbers = bytes.as_chunks().0.as_chunks::<3>().0;
    numbers.iter().map(|[x, y, z]| DVec3::new(number(x), number(y), number(z))).collect()
}

/// Returns the error of a question that is too short. The package never writes one.
fn short(what: &str) -> Failure {
    Failure::input("", format_args!("the question has too few {what}"))
}
