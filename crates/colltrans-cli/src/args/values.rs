//! Parses the values of options: what people write behind one, read into what it means.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use colltrans::glam::{DMat3, DQuat, DVec3};
use colltrans::{Pose, Solver, cta};

/// Moves that one step may have.
const MOST_LEGS: usize = 1_000;

/// A direction: three numbers, or an axis by its name.
pub(crate) fn direction(text: &str) -> Result<DVec3, String> {
    if let Some(axis) = axis(text.trim()) {
        return Ok(axis);
    }
    if !text.contains(|c: char| c == ',' || c.is_ascii_digit()) {
        return Err("neither three numbers (x,y,z) nor an axis (x, -x, y, -y, z, -z)".into());
    }
    match numbers(text)?.as_slice() {
        &[x, y, z] => Ok(DVec3::new(x, y, z)),
        other => Err(format!("{} numbers, not 3 (x,y,z)", other.len())),
    }
}

fn axis(name: &str) -> Option<DVec3> {
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
    // Not -0 for 0.
    Some(axis * sign + DVec3::ZERO)
}

/// A solver by its name.
/// Three numbers.
pub(crate) fn vector(text: &str) -> Result<DVec3, String> {
    match numbers(text)?.as_slice() {
        &[x, y, z] => Ok(DVec3::new(x, y, z)),
        other => Err(format!("{} numbers, not 3 (x,y,z)", other.len())),
    }
}

pub(crate) fn solver() -> impl TypedValueParser<Value = Solver> {
    let named = |solver: Solver, what| PossibleValue::new(solver.name()).help(what);
    PossibleValuesParser::new([
        named(Solver::Auto, "Whichever was measured to be fastest for bodies of these sizes"),
        named(Solver::Cta, "The collision translation algorithm, over planar sections (the paper)"),
        named(Solver::Portal, "Portal refinement"),
    ])
    .try_map(|name| name.parse::<Solver>())
}

/// Where a minimisation starts, by its name.
pub(crate) fn start() -> impl TypedValueParser<Value = cta::Start> {
    let named = |start: cta::Start, what| PossibleValue::new(start.name()).help(what);
    PossibleValuesParser::new([
        named(cta::Start::Center, "At the centre of all sections, as the paper"),
        named(cta::Start::Ellipsoids, "Where ellipsoids would meet: often no section is needed"),
    ])
    .try_map(|name| name.parse::<cta::Start>())
}

/// A translation, and perhaps a rotation before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    pose: Pose,
    has_rotation: bool,
    /// The length of the quaternion as it was written, where it was not 1.
    rounded: Option<f64>,
}

pub(crate) fn place(text: &str) -> Result<Place, String> {
    let (translation, written) = match numbers(text)?.as_slice() {
        &[x, y, z] => (DVec3::new(x, y, z), None),
        &[x, y, z, qx, qy, qz, qw] => (DVec3::new(x, y, z), Some(DQuat::from_xyzw(qx, qy, qz, qw))),
        other => {
            let count = other.len();
            return Err(format!("{count} numbers, not 3 (x,y,z) or 7 (x,y,z,qx,qy,qz,qw)"));
        }
    };
    let (pose, defect) =
        Pose::from_rounded(written.unwrap_or_default(), translation).map_err(|e| e.to_string())?;
    let rounded = defect.and(written).map(DQuat::length);
    Ok(Place { pose, has_rotation: written.is_some(), rounded })
}

impl Place {
    /// The pose, with a rotation given by angles instead, if it is.
    pub(crate) fn pose(&self, angles: Option<Angles>, option: &str) -> Result<Pose, String> {
        match angles {
            None => Ok(self.pose),
            Some(_) if self.has_rotation => Err(format!(
                "{option}-pose has a rotation and so has {option}-rpy; give one of them"
            )),
            Some(angles) => Pose::from_matrix(angles.matrix(), self.pose.translation())
                .map_err(|e| e.to_string()),
        }
    }

    /// Returns a note about the quaternion if it was normalised.
    pub(crate) fn note(&self, option: &str) -> Option<String> {
        self.rounded.map(|length| normalised(option, length))
    }

    /// Returns the length of the quaternion as it was written, if it was normalised.
    pub(crate) fn rounded(&self) -> Option<f64> {
        self.rounded
    }
}

/// Returns a note if quaternions of some poses were normalised: about the pose whose length is farthest from 1.
/// `lengths` has the lengths of those that were.
pub(crate) fn normalised_poses(place: &str, lengths: &[Option<f64>]) -> Option<String> {
    let rounded = lengths.iter().enumerate().filter_map(|(k, length)| Some((k, (*length)?)));
    let off = |length: f64| (length - 1.0).abs();
    let (k, length) = rounded.clone().max_by(|a, b| off(a.1).total_cmp(&off(b.1)))?;
    let note = normalised(&format!("{place}: pose {k}"), length);
    Some(match rounded.count() {
        1 => note,
        count => format!("{note}; {count} poses were normalised"),
    })
}

/// Returns the note that a quaternion of this length was normalised.
pub(crate) fn normalised(place: &str, length: f64) -> String {
    let off = (length - 1.0).abs();
    format!(
        "{place}: the quaternion has length {length:.6}, not 1; it was normalised, and a direction may be \
         off by {off:.0e}"
    )
}

/// Roll, pitch and yaw in degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Angles([f64; 3]);

pub(crate) fn angles(text: &str) -> Result<Angles, String> {
    match numbers(text)?.as_slice() {
        &[r, p, y] if [r, p, y].iter().all(|a| a.is_finite()) => Ok(Angles([r, p, y])),
        &[_, _, _] => Err("an angle is not finite".into()),
        other => Err(format!("{} numbers, not 3 (roll,pitch,yaw)", other.len())),
    }
}

impl Angles {
    /// About x, then about y, then about z, all of them axes of the world.
    fn matrix(self) -> DMat3 {
        let [[sr, cr], [sp, cp], [sy, cy]] = self.0.map(sin_cos_degrees);
        DMat3::from_cols(
            DVec3::new(cy * cp, sy * cp, -sp),
            DVec3::new(cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr),
            DVec3::new(cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr),
        )
    }
}

/// Exact at multiples of 90 degrees, and the same bits on every platform, as those of `std` are not.
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

/// A length: finite and not negative.
pub(crate) fn length(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(length) if length.is_finite() && length >= 0.0 => Ok(length),
        Ok(_) => Err("must be finite and not negative".into()),
        Err(_) => Err("is not a number".into()),
    }
}

/// A factor: finite and positive.
pub(crate) fn factor(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(factor) if factor.is_finite() && factor > 0.0 => Ok(factor),
        Ok(_) => Err("must be finite and positive".into()),
        Err(_) => Err("is not a number".into()),
    }
}

/// The name of a picture, which is SVG.
pub(crate) fn picture(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    if extension.eq_ignore_ascii_case("svg") {
        return Ok(path);
    }
    let svg = path.with_extension("svg");
    Err(format!("pictures are written as SVG; call it {}", svg.display()))
}

/// The name of a proof, which is a file: standard output has the answer.
pub(crate) fn proof(text: &str) -> Result<PathBuf, String> {
    match text {
        "-" => Err("standard output has the answer; a proof needs a file".into()),
        name => Ok(name.into()),
    }
}

/// A number of bytes, with a unit or without.
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
                "`{}` is not a unit of bytes (kB, MB, GB, KiB, MiB, GiB)",
                unit.trim()
            ));
        }
    };
    let number: f64 = number.parse().map_err(|_| "is not a number of bytes, like 500MB or 2GiB")?;
    // The cast saturates.
    Ok((number * factor).round() as usize)
}

/// Most threads that make sense to ask for.
const MOST_THREADS: usize = 1024;

/// Samples of the sphere, each asked of every part.
const MOST_SAMPLES: usize = 655_362;

/// How many moves there may be.
pub(crate) fn legs(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if (1..=MOST_LEGS).contains(&count) => Ok(count),
        _ => Err(format!("a number from 1 to {MOST_LEGS} is needed")),
    }
}

pub(crate) fn samples(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(count) if count <= MOST_SAMPLES => Ok(count),
        _ => Err(format!("a number from 0 to {MOST_SAMPLES} is needed")),
    }
}

pub(crate) fn threads(text: &str) -> Result<NonZeroUsize, String> {
    match text.parse::<NonZeroUsize>() {
        Ok(count) if count.get() <= MOST_THREADS => Ok(count),
        _ => Err(format!("a number from 1 to {MOST_THREADS} is needed")),
    }
}

fn numbers(text: &str) -> Result<Vec<f64>, String> {
    text.split(',')
        .map(|word| word.trim().parse().map_err(|_| format!("`{}` is not a number", word.trim())))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses() {
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
    fn axes_have_names() {
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
    fn angles_turn_about_x_then_y_then_z() {
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
    fn angles_have_the_same_bits_everywhere() {
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
    fn bytes_have_units() {
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
    fn proofs_are_files() {
        assert!(proof("a/b.json").is_ok());
        assert!(proof("-").unwrap_err().contains("needs a file"));
    }

    #[test]
    fn pictures_are_svg() {
        assert!(picture("a/b.SVG").is_ok());
        assert!(picture("a/b.png").unwrap_err().ends_with("call it a/b.svg"));
        for bad in ["a", "part.stl", "svg"] {
            assert!(picture(bad).is_err(), "{bad}");
        }
    }
}
