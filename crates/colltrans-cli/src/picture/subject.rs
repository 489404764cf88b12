//! The content of a picture, taken from the answer.

use colltrans::glam::DVec3;
use colltrans::{Clearance, Contact, ContactRange, FreeReason, Separated};

use super::size::working_size;
use super::solid::Mark;
use super::{CastPicture, PictureBodies, Solid};
use crate::numbers::decade;

/// The features in contact.
#[derive(Clone, Copy)]
pub(super) struct Marks {
    pub(super) moving: Mark,
    pub(super) fixed: Mark,
}

/// The content of a picture.
pub(super) struct Subject {
    /// The origin of the picture's coordinates, in the world.
    pub(super) origin: DVec3,
    /// Length of the translation from the start of the moving body to its stop.
    pub(super) stop: f64,
    /// The contact normal, or the normal of the separating plane.
    pub(super) normal: DVec3,
    /// Whether the bodies touch at the stop; the contact is then the origin.
    pub(super) touches: bool,
    /// The features in contact.
    pub(super) marks: Option<Marks>,
    /// Margin of separated bodies.
    pub(super) margin: Option<f64>,
    /// The ends of the shortest way between the bodies, and its label.
    pub(super) link: Option<([DVec3; 2], String)>,
    /// Whether the origin is a common point of the bodies.
    pub(super) meets: bool,
    /// Whether no translation is drawn.
    pub(super) is_still: bool,
    /// Label of the translation.
    pub(super) way: String,
    pub(super) headline: String,
    pub(super) details: Vec<String>,
}

impl Subject {
    /// Returns the content of the picture of a cast.
    pub(super) fn from_cast(picture: &CastPicture<'_>) -> Self {
        match picture.answer {
            ContactRange::Contact { first, last } => {
                Self::from_contact(picture, [first, last], "Contact", None)
            }
            ContactRange::Grazing { first, last } => {
                let overlap = short(first.overlap);
                let also = format!("the bodies slide along each other, overlapping by {overlap}");
                Self::from_contact(picture, [&first.contact, &last.contact], "Grazing", Some(also))
            }
            ContactRange::Separated(separated) => Self::from_separation(picture, separated),
        }
    }

    /// Returns the content for a contact.
    fn from_contact(
        picture: &CastPicture<'_>,
        [contact, last]: [&Contact; 2],
        name: &str,
        also: Option<String>,
    ) -> Self {
        let length = picture.cast.direction().length();
        let (features, points) =
            (contact.features(picture.cast), contact.witness_points(picture.cast));
        let way = translation_text(contact.translation, length);
        let proof = &contact.certificate;
        let touch = format!(
            "{} of the moving body on {} of the fixed body",
            features.moving.kind(),
            features.fixed.kind()
        );
        let mut details: Vec<String> = also.into_iter().collect();
        details.push(touch);
        let agreement = if proof.upper.is_finite() {
            // A floor, because the gap itself depends on the last bits of a search.
            let within = proof.gap().max(proof.rounding);
            format!("proven lower and upper bound of t agree to {within:.0e}")
        } else {
            "t is a proven lower bound".into()
        };
        details.push(format!("normal n = {}; {agreement}", vector_text(contact.normal)));
        Self {
            origin: points.on_fixed,
            stop: contact.translation * length,
            normal: contact.normal,
            touches: true,
            // Features of rounded bodies are those of their cores, which are not drawn.
            marks: (picture.cast.moving().radius() + picture.cast.fixed().radius() == 0.0).then(
                || Marks {
                    moving: Mark::from_feature(features.moving, picture.cast.moving()),
                    fixed: Mark::from_feature(features.fixed, picture.cast.fixed()),
                },
            ),
            margin: None,
            link: None,
            meets: false,
            is_still: false,
            headline: match (ContactRange::Contact { first: *contact, last: *last }).clearance() {
                Clearance::Overlapping(_) => {
                    format!("{name}: the bodies overlap now, first contact at {way}")
                }
                Clearance::Free(FreeReason::Behind(_)) => format!("{name}: lies behind, at {way}"),
                _ => format!("{name} at {way}"),
            },
            way,
            details,
        }
    }

    /// Returns the content for bodies that pass each other. The stop is where they are side by side.
    fn from_separation(picture: &CastPicture<'_>, separated: &Separated) -> Self {
        let normal = separated.certificate.normal;
        let cast = picture.cast;
        let origin = cast.fixed_pose().transform_point(cast.fixed().vertices()[0]);
        let moving = Solid::new(cast.moving(), &cast.moving_pose(), origin);
        let fixed = Solid::new(cast.fixed(), &cast.fixed_pose(), origin);
        let unit = cast.direction().normalize();
        let ahead = (fixed.support_center(-normal) - moving.support_center(normal)).dot(unit);
        let margin = separated.certificate.margin;
        Self {
            origin,
            stop: ahead.max(0.0),
            normal,
            touches: false,
            marks: None,
            margin: Some(margin),
            link: None,
            meets: false,
            is_still: false,
            way: "d".into(),
            headline: "Separated: the bodies never meet along d".into(),
            details: vec![format!(
                "margin (gap along the normal n) {}, n = {} of the separating plane",
                short(margin),
                vector_text(normal)
            )],
        }
    }

    /// Returns the preferred direction of the view: the normal, or its opposite if only the moving body touches with a
    /// face. A face is visible from its own side, and a vertex or an edge of the other body hides little of it.
    pub(super) fn view_direction(&self) -> DVec3 {
        let is_face = |mark| matches!(mark, Mark::Face(_));
        match self.marks {
            Some(m) if is_face(m.moving) && !is_face(m.fixed) => -self.normal,
            _ => self.normal,
        }
    }

    /// Returns the ends of the gap between separated bodies at the stop, along the normal; `None` for other answers.
    pub(super) fn margin_ends(&self, bodies: &PictureBodies) -> Option<[DVec3; 2]> {
        let from = bodies.stop.support_center(self.normal);
        self.margin.map(|margin| [from, from + margin * self.normal])
    }

    /// Returns the points that must be visible in addition to the bodies.
    pub(super) fn extra_points(&self, bodies: &PictureBodies) -> Vec<DVec3> {
        let link = self.link.iter().flat_map(|(ends, _)| *ends);
        self.plane_corners(bodies).into_iter().flatten().chain(link).collect()
    }

    /// Returns the corners of a square of the separating plane in the middle of the gap; `None` for other answers.
    pub(super) fn plane_corners(&self, bodies: &PictureBodies) -> Option<[DVec3; 4]> {
        let [from, to] = self.margin_ends(bodies)?;
        let along = bodies.way.normalize_or(self.normal.any_orthonormal_vector());
        let across = self.normal.cross(along);
        let half = 1.1
            * working_size(bodies.stop.bounding_sphere().1, bodies.fixed.bounding_sphere().1, 0.0);
        let middle = 0.5 * (from + to);
        let corner = |a: f64, b: f64| middle + a * half * along + b * half * across;
        Some([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)])
    }
}

/// Returns a unit vector as text, with rounding noise as 0.
pub(super) fn vector_text(unit: DVec3) -> String {
    let [x, y, z] = unit.to_array().map(|c| if c.abs() < 1e-12 { 0.0 } else { c }).map(short);
    format!("({x}, {y}, {z})")
}

/// Returns a translation, and its length if the direction does not have length 1.
pub(super) fn translation_text(translation: f64, length: f64) -> String {
    if (length - 1.0).abs() < 1e-12 {
        format!("t = {}", short(translation))
    } else {
        format!("t = {} (length {})", short(translation), short(translation * length))
    }
}

/// Returns a number with at most six digits.
pub(super) fn short(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude == 0.0 {
        return "0".into();
    }
    if !(1e-4..1e6).contains(&magnitude) {
        return format!("{value:.2e}");
    }
    let decimals = (5 - decade(magnitude)).clamp(0, 9) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn numbers_have_at_most_six_digits() {
        let shown = [0.0, -0.0, 2.5, -1.0 / 3.0, 123_456.78, 1e-16, 2e7, 1e-4].map(short);
        assert_eq!(shown, ["0", "0", "2.5", "-0.333333", "123457", "1.00e-16", "2.00e7", "0.0001"]);
    }
}
