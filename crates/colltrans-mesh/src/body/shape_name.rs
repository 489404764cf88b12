//! Shapes that a name describes in place of a file: `sphere:R`, `capsule:AX,AY,AZ,BX,BY,BZ,R`, `box:X,Y,Z`,
//! `box:X,Y,Z,R`.

use colltrans::ConvexPolyhedron;
use glam::DVec3;

use super::BodyError;

/// The forms of names, for errors.
const FORMS: &str =
    "sphere:RADIUS, capsule:AX,AY,AZ,BX,BY,BZ,RADIUS, box:X,Y,Z and box:X,Y,Z,RADIUS";

/// Builds the body that a name describes, with all lengths multiplied by `scale`. Returns `None` if the name begins
/// with no known shape, so that it names a file.
///
/// A box has the given edge lengths and its centre at the origin. Its radius rounds it outwards. A sphere has its
/// centre at the origin, and a capsule the given ends of its axis.
///
/// # Errors
/// [`BodyError::ShapeName`] for a malformed shape, and the errors of the body.
pub fn body_of_name(name: &str, scale: f64) -> Option<Result<ConvexPolyhedron, BodyError>> {
    let (shape, numbers) = name.split_once(':')?;
    if !matches!(shape, "sphere" | "capsule" | "box") {
        return None;
    }
    let numbers: Option<Vec<f64>> = numbers
        .split(',')
        .map(|text| text.trim().parse().ok().filter(|x: &f64| x.is_finite()).map(|x| x * scale))
        .collect();
    let built = match (shape, numbers.as_deref()) {
        ("sphere", Some(&[radius])) => ConvexPolyhedron::sphere(DVec3::ZERO, radius),
        ("capsule", Some(&[ax, ay, az, bx, by, bz, radius])) => {
            ConvexPolyhedron::capsule([DVec3::new(ax, ay, az), DVec3::new(bx, by, bz)], radius)
        }
        ("box", Some(&[x, y, z, ref radius @ ..]))
            if radius.len() < 2 && x.min(y).min(z) >= 0.0 =>
        {
            let half = DVec3::new(x, y, z) * 0.5;
            let core = ConvexPolyhedron::cuboid(-half, half);
            core.and_then(|core| core.rounded(radius.first().copied().unwrap_or(0.0)))
        }
        _ => return Some(Err(BodyError::ShapeName { name: name.to_owned(), forms: FORMS })),
    };
    Some(built.map_err(BodyError::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn built(name: &str) -> ConvexPolyhedron {
        body_of_name(name, 2.0).expect("a shape").expect("a body")
    }

    #[test]
    fn names_describe_shapes_and_are_scaled() {
        let ball = built("sphere:0.5");
        assert_eq!((ball.vertices(), ball.radius()), (&[DVec3::ZERO][..], 1.0));
        let capsule = built("capsule:0,0,-1, 0,0,1, 0.25");
        assert_eq!((capsule.vertices().len(), capsule.radius()), (2, 0.5));
        assert_eq!(built("box:1,2,3").volume(), 48.0);
        assert_eq!(built("box:1,2,3,0.125").radius(), 0.25);
    }

    #[test]
    fn other_names_are_files_and_malformed_ones_are_errors() {
        assert!(body_of_name("sphere.stl", 1.0).is_none());
        assert!(body_of_name("C:mesh.stl", 1.0).is_none());
        for name in [
            "sphere:",
            "sphere:-1",
            "sphere:1,2",
            "sphere:nan",
            "capsule:1",
            "box:1,2",
            "box:-1,1,1",
        ] {
            assert!(body_of_name(name, 1.0).expect("a shape").is_err(), "{name}");
        }
    }
}
