//! Parses the values of options: directions, poses, angles, lengths, factors, names of files, sizes.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use colltrans::glam::{DMat3, DQuat, DVec3};
use colltrans::{Pose, Solver, cta};
use colltrans_assembly::plan::PlanOptions;

/// Parses a direction: three numbers, or the name of an axis.
pub(crate) fn direction(text: &str) -> Result<DVec3, String> {
    if let Some(axis) = axis_by_name(text.trim()) {
        return Ok(axis);
    }
    if !text.contains(|c: char| c == ',' || c.is_ascii_digit()) {
        return Err("expected three numbers (x,y,z) or an axis (x, -x, y, -y, z, -z)".into());
    }
    match parse_numbers(text)?.as_slice() {
        &[x, y, z] => Ok(DVec3::new(x, y, z)),
        other => Err(format!("{} numbers given, expected 3 (x,y,z)", other.len())),
    }
}

/// Returns the unit vector of an axis; `None` for other names.
fn axis_by_name(name: &str) -> Option<DVec3> {
    let (sign, letter) = match name.strip_prefix('-') {
        Some(letter) => (-1.0, letter),
        None => (1.0, name.strip_prefix('+').unwrap_or(name)),
    };
    let axis = match letter {
        "x" | "X" => DVec3::X,
        "y" | "Y" => DVec3::Y,
        "z" | "Z" => DVec3::Z,
        _ => return None,
    };
    // The sum turns -0 into 0.
    Some(axis * sign + DVec3::ZERO)
}

/// Parses three numbers.
pub(crate) fn vector(text: &str) -> Result<DVec3, String> {
    match parse_numbers(text)?.as_slice() {
        &[x, y, z] => Ok(DVec3::new(x, y, z)),
        other => Err(format!("{} numbers given, expected 3 (x,y,z)", other.len())),
    }
}

/// Parses the name of a solver.
pub(crate) fn solver() -> impl TypedValueParser<Value = Solver> {
    let named = |solver: Solver, what| PossibleValue::new(solver.name()).help(what);
    PossibleValuesParser::new([
        named(
            Solver::Auto,
            "The algorithm that was measured to be fastest for bodies of these sizes",
        ),
        named(
            Solver::Cta,
            "The algorithm of Mirolo, Carpin, Pagello 2007 (the paper), over planar sections",
        ),
        named(Solver::Portal, "Minkowski portal refinement (Snethen 2008) along a line"),
    ])
    .try_map(|name| name.parse::<Solver>())
}

/// Reads the name of a field of answers.
pub(crate) fn answer_field() -> PossibleValuesParser {
    PossibleValuesParser::new(crate::record::Line::fields())
}

/// Parses the name of a start of the minimisation.
pub(crate) fn start() -> impl TypedValueParser<Value = cta::Start> {
    let named = |start: cta::Start, what| PossibleValue::new(start.name()).help(what);
    PossibleValuesParser::new([
        named(cta::Start::Center, "At the centre of all sections, as in the paper"),
        named(
            cta::Start::Ellipsoids,
            "Where ellipsoids of inertia would meet: often no section is needed",
        ),
        named(
            cta::Start::Guess,
            "In a neighbourhood of a guessed solution, from a few support points",
        ),
    ])
    .try_map(|name| name.parse::<cta::Start>())
}

/// Parses the value of `phi` at which the region of levels is cut.
pub(crate) fn cuts() -> impl TypedValueParser<Value = cta::Cuts> {
    let named = |cuts: cta::Cuts, what| PossibleValue::new(cuts.name()).help(what);
    PossibleValuesParser::new([
        named(cta::Cuts::Shifted, "At the least value found, as in the paper"),
        named(
            cta::Cuts::Centroid,
            "At the value of the planar problem, as in the method before it",
        ),
    ])
    .try_map(|name| name.parse::<cta::Cuts>())
}

/// A pose of the command line: an optional rotation, then a translation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    pose: Pose,
    has_rotation: bool,
    /// The length of the given quaternion, if it was normalised.
    original_length: Option<f64>,
}

/// Parses a pose: a translation, or a translation and a quaternion.
pub(crate) fn place(text: &str) -> Result<Place, String> {
    let (translation, quaternion) = match parse_numbers(text)?.as_slice() {
        &[x, y, z] => (DVec3::new(x, y, z), None),
        &[x, y, z, qx, qy, qz, qw] => (DVec3::new(x, y, z), Some(DQuat::from_xyzw(qx, qy, qz, qw))),
        other => {
            let count = other.len();
            return Err(format!(
                "{count} numbers given, expected 3 (x,y,z) or 7 (x,y,z,qx,qy,qz,qw)"
            ));
        }
    };
    let (pose, defect) = Pose::from_rounded(quaternion.unwrap_or_default(), translation)
        .map_err(|e| e.to_string())?;
    let original_length = defect.and(quaternion).map(DQuat::length);
    Ok(Place { pose, has_rotation: quaternion.is_some(), original_length })
}

impl Place {
    /// Returns the pose. `angles` take the place of its rotation if they are given.
    ///
    /// # Errors
    /// There are both a quaternion and angles. `option` names the two options in the message.
    pub(crate) fn pose(&self, angles: Option<Angles>, option: &str) -> Result<Pose, String> {
        match angles {
            None => Ok(self.pose),
            Some(_) if self.has_rotation => Err(format!(
                "both {option}-pose and {option}-rpy have a rotation; give one of them"
            )),
            Some(angles) => Pose::from_matrix(angles.matrix(), self.pose.translation())
                .map_err(|e| e.to_string()),
        }
    }

    /// Returns a note about the quaternion if it was normalised.
    pub(crate) fn note(&self, option: &str) -> Option<String> {
        self.original_length.map(|length| normalised_pose_note(option, length))
    }

    /// Returns the length of the given quaternion; `None` if it was not normalised.
    pub(crate) fn original_length(&self) -> Option<f64> {
        self.original_length
    }
}

/// Returns a note about the normalised pose whose quaternion has the length farthest from 1; `None` if no pose was
/// normalised. `lengths` has the original length of each normalised quaternion.
pub(crate) fn normalised_poses_note(place: &str, lengths: &[Option<f64>]) -> Option<String> {
    let rounded = lengths.iter().enumerate().filter_map(|(k, length)| Some((k, (*length)?)));
    let off = |length: f64| (length - 1.0).abs();
    let (k, length) = rounded.clone().max_by(|a, b| off(a.1).total_cmp(&off(b.1)))?;
    let note = normalised_pose_note(&format!("{place}: pose {k}"), length);
    Some(match rounded.count() {
        1 => note,
        count => format!("{note}; {count} poses were normalised"),
    })
}

/// Returns the note that a quaternion of this length was normalised.
pub(crate) fn normalised_pose_note(place: &str, length: f64) -> String {
    let off = (length - 1.0).abs();
    format!(
        "{place}: the quaternion has length {length:.6}, not 1; it was normalised, and a direction may be \
         off by {off:.0e}"
    )
}

/// Roll, pitch and yaw in degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Angles([f64; 3]);

/// Parses roll, pitch and yaw in degrees.
pub(crate) fn angles(text: &str) -> Result<Angles, String> {
    match parse_numbers(text)?.as_slice() {
        &[r, p, y] if [r, p, y].iter().all(|a| a.is_finite()) => Ok(Angles([r, p, y])),
        &[_, _, _] => Err("angles must be finite".into()),
        other => Err(format!("{} numbers given, expected 3 (roll,pitch,yaw)", other.len())),
    }
}

impl Angles {
    /// Returns the rotation about the world's x axis, then y, then z.
    fn matrix(self) -> DMat3 {
        let [[sr, cr], [sp, cp], [sy, cy]] = self.0.map(sin_cos_degrees);
        DMat3::from_cols(
            DVec3::new(cy * cp, sy * cp, -sp),
            DVec3::new(cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr),
            DVec3::new(cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr),
        )
    }
}

/// Returns the sine and the cosine of an angle in degrees, exact at multiples of 90. The bits are the same on all
/// platforms, in contrast to those of `std`.
fn sin_cos_degrees(degrees: f64) -> [f64; 2] {
    let turn = degrees.rem_euclid(360.0);
    let quarter = (turn / 90.0).round();
    let (sin, cos) = libm::sincos((turn - 90.0 * quarter).to_radians());
    match quarter as i64 % 4 {
        0 => [sin, cos],
        1 => [cos, -sin],
        2 => [-sin, -cos],
        _ => [-cos, sin],
    }
}

/// Parses a length: finite and not negative.
pub(crate) fn length(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(length) if length.is_finite() && length >= 0.0 => Ok(length),
        Ok(_) => Err("must be finite and not negative".into()),
        Err(_) => Err("is not a number".into()),
    }
}

/// Parses a factor: finite and positive.
pub(crate) fn factor(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(factor) if factor.is_finite() && factor > 0.0 => Ok(factor),
        Ok(_) => Err("must be finite and positive".into()),
        Err(_) => Err("is not a number".into()),
    }
}

/// Parses the name of a picture, whose extension must be `svg`.
pub(crate) fn picture(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    if extension.eq_ignore_ascii_case("svg") {
        return Ok(path);
    }
    let svg = path.with_extension("svg");
    Err(format!("pictures are SVG files; name it {}", svg.display()))
}

/// Parses the name of a file besides the answer. Rejects `-`, because standard output has the answer.
pub(crate) fn output_file(text: &str) -> Result<PathBuf, String> {
    match text {
        "-" => Err("standard output has the answer; give the name of a file".into()),
        name => Ok(name.into()),
    }
}

/// Parses a number of bytes with an optional unit.
pub(crate) fn bytes(text: &str) -> Result<usize, String> {
    let text = text.trim();
    let digits = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let (number, unit) = text.split_at(digits);
    let factor: f64 = match unit.trim().to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "k" | "kb" => 1e3,
        "m" | "mb" => 1e6,
        "g" | "gb" => 1e9,
        "t" | "tb" => 1e12,
        "kib" => 1024.0,
        "mib" => 1024.0 * 1024.0,
        "gib" => 1024.0 * 1024.0 * 1024.0,
        "tib" => 1024.0 * 1024.0 * 1024.0 * 1024.0,
        _ => {
            return Err(format!(
                "unknown unit of bytes `{}`; accepted: kB, MB, GB, KiB, MiB, GiB",
                unit.trim()
            ));
        }
    };
    let number: f64 =
        number.parse().map_err(|_| "expected a number of bytes, for example 500MB or 2GiB")?;
    // The cast saturates.
    Ok((number * factor).round() as usize)
}

/// Maximum number of threads.
const MAX_THREADS: usize = 1024;

/// Maximum number of sample directions, each of which is a query for every part.
const MAX_SAMPLES: usize = 655_362;

/// Rejects the removed option `--legs`.
pub(crate) fn removed_legs(text: &str) -> Result<u32, String> {
    let default = PlanOptions::DEFAULT_EFFORT;
    Err(format!(
        "the number of moves has no limit any more; give --effort N instead of --legs {text}: the work of each \
         search, {default} by default, 0 for single moves only"
    ))
}

/// Parses a number of sample directions.
pub(crate) fn samples(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(count) if count <= MAX_SAMPLES => Ok(count),
        _ => Err(format!("expected a number from 0 to {MAX_SAMPLES}")),
    }
}

/// Parses a number of threads.
pub(crate) fn threads(text: &str) -> Result<NonZeroUsize, String> {
    match text.parse::<NonZeroUsize>() {
        Ok(count) if count.get() <= MAX_THREADS => Ok(count),
        _ => Err(format!("expected a number from 1 to {MAX_THREADS}")),
    }
}

/// Parses numbers that are separated by commas.
fn parse_numbers(text: &str) -> Result<Vec<f64>, String> {
    text.split(',')
        .map(|word| word.trim().parse().map_err(|_| format!("`{}` is not a number", word.trim())))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_have_three_or_seven_finite_numbers() {
        let pose = |text: &str| place(text)?.pose(None, "--moving");
        assert_eq!(pose("1, -2,3e0").unwrap().translation(), DVec3::new(1.0, -2.0, 3.0));
        assert_eq!(pose("0,0,0,0,0,1,0").unwrap().matrix().x_axis, -DVec3::X);
        for bad in ["", "1,2", "1,2,3,4", "1,2,x", "0,0,0,0,0,0,2", "nan,0,0", "1e300,0,0"] {
            assert!(pose(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn quaternions_of_few_digits_are_normalised_with_a_note() {
        for digits in ["0.71", "0.707", "0.7071"] {
            let place = place(&format!("0,0,0,0,0,{digits},{digits}")).unwrap();
            assert!(place.note("--fixed").unwrap().starts_with("--fixed: the quaternion has"));
            let turned = place.pose(None, "--fixed").unwrap().matrix();
            assert!((turned.x_axis - DVec3::Y).length() < 1e-15, "{turned}");
        }
        assert_eq!(place("0,0,0,0,0,0.70710678,0.70710678").unwrap().note("--fixed"), None);
        assert!(place("0,0,0,0,0,0.6,0.6").is_err());
    }

    #[test]
    fn directions_accept_axis_names() {
        for (name, axis) in
            [("x", DVec3::X), ("+y", DVec3::Y), ("-z", DVec3::NEG_Z), ("Z", DVec3::Z)]
        {
            assert_eq!(direction(name).unwrap(), axis);
            assert!(direction(name).unwrap().to_array().iter().all(|c| c.to_bits() != 1 << 63));
        }
        assert_eq!(direction(" 1, 2,-3").unwrap(), DVec3::new(1.0, 2.0, -3.0));
        for bad in ["w", "--z", "xy", "1,2", ""] {
            assert!(direction(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn roll_pitch_yaw_rotate_about_world_axes_in_order() {
        let matrix = |text: &str| angles(text).unwrap().matrix();
        assert_eq!(matrix("90,0,0"), DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y));
        assert_eq!(matrix("0,90,0").z_axis, DVec3::X);
        assert_eq!(matrix("0,0,-270"), DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z));
        for text in ["10,20,30", "-100,75,260", "450,-90,33"] {
            let [r, p, y] = angles(text).unwrap().0.map(f64::to_radians);
            let turned =
                DQuat::from_rotation_z(y) * DQuat::from_rotation_y(p) * DQuat::from_rotation_x(r);
            for v in [DVec3::X, DVec3::Y, DVec3::Z] {
                assert!((matrix(text) * v - turned * v).length() < 1e-14, "{text}");
            }
        }
        let quarter = place("1,2,3").unwrap().pose(angles("0,0,90").ok(), "--moving").unwrap();
        assert_eq!(quarter.matrix(), DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z));
        let both = place("0,0,0,0,0,0,1").unwrap().pose(angles("1,2,3").ok(), "--moving");
        assert!(both.unwrap_err().contains("give one of them"));
    }

    #[test]
    fn sines_and_cosines_of_degrees_match_golden_bits() {
        for (degrees, bits) in [
            (30.0, [0x3fdf_ffff_ffff_ffff, 0x3feb_b67a_e858_4cab]),
            (-77.25, [0xbfef_3601_191f_a459, 0x3fcc_3fd0_44dd_3d45]),
            (1e-3, [0x3ef2_4d15_2115_36db, 0x3fef_ffff_ffeb_111d]),
            (44.999, [0x3fe6_a084_84bb_5f49, 0x3fe6_a0b8_4825_7db4]),
        ] {
            assert_eq!(sin_cos_degrees(degrees).map(f64::to_bits), bits, "{degrees}");
        }
    }

    #[test]
    fn bytes_accept_decimal_and_binary_units() {
        for (text, expected) in
            [("0", 0), ("1500", 1500), ("2kB", 2000), ("1.5 MiB", 3 << 19), ("2GB", 2_000_000_000)]
        {
            assert_eq!(bytes(text).unwrap(), expected);
        }
        for bad in ["", "GB", "1 apple", "-1", "1.2.3", "nan"] {
            assert!(bytes(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn file_on_standard_output_is_rejected() {
        assert!(output_file("a/b.json").is_ok());
        assert!(output_file("-").unwrap_err().contains("give the name of a file"));
    }

    #[test]
    fn picture_path_requires_svg_extension() {
        assert!(picture("a/b.SVG").is_ok());
        assert!(picture("a/b.png").unwrap_err().ends_with("name it a/b.svg"));
        for bad in ["a", "part.stl", "svg"] {
            assert!(picture(bad).is_err(), "{bad}");
        }
    }
}
