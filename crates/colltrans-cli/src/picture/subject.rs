//! What a picture has to tell, taken from the answer.

use colltrans::glam::DVec3;
use colltrans::{Clearance, Contact, ContactRange, Separated, WhyFree};

use super::size::working_size;
use super::solid::Mark;
use super::{Cast, Scene, Solid};
use crate::numbers::decade;

/// What touches, of either body as it is drawn.
#[derive(Clone, Copy)]
pub(super) struct Marks {
    pub(super) moving: Mark,
    pub(super) fixed: Mark,
}

/// What is shown and said.
pub(super) struct Subject {
    /// The point of the world that coordinates are relative to.
    pub(super) origin: DVec3,
    /// How far the moving body goes from its start until it stops, as a length.
    pub(super) stop: f64,
    /// The contact normal, or that of the separating plane.
    pub(super) normal: DVec3,
    /// Whether the bodies touch where the moving one stops, which is at the origin.
    pub(super) touches: bool,
    /// What touches there.
    pub(super) marks: Option<Marks>,
    pub(super) margin: Option<f64>,
    /// The ends of the shortest way between the bodies, and what it is labelled with.
    pub(super) link: Option<([DVec3; 2], String)>,
    /// Whether both bodies have the origin.
    pub(super) meets: bool,
    /// Whether nothing moves.
    pub(super) is_still: bool,
    /// What the way is labelled with.
    pub(super) way: String,
    pub(super) headline: String,
    pub(super) details: Vec<String>,
}

impl Subject {
    pub(super) fn of(scene: &Scene<'_>) -> Self {
        match scene.answer {
            ContactRange::Contact { first, last } => {
                Self::of_contact(scene, [first, last], "Contact", None)
            }
            ContactRange::Grazing { first, last } => {
                let overlap = short(first.overlap);
                let also = format!("the bodies slide along each other, overlapping by {overlap}");
                Self::of_contact(scene, [&first.contact, &last.contact], "Grazing", Some(also))
            }
            ContactRange::Separated(separated) => Self::of_separated(scene, separated),
        }
    }

    fn of_contact(
        scene: &Scene<'_>,
        [contact, last]: [&Contact; 2],
        name: &str,
        also: Option<String>,
    ) -> Self {
        let length = scene.cast.direction().length();
        let (features, points) = (contact.features(scene.cast), contact.points(scene.cast));
        let way = quantity(contact.translation, length);
        let proof = &contact.certificate;
        let touch = format!(
            "{} of the moving body on {} of the fixed body",
            features.moving.kind(),
            features.fixed.kind()
        );
        let mut details: Vec<String> = also.into_iter().collect();
        details.push(touch);
        let agreement = if proof.upper.is_finite() {
            // The gap itself changes with the last bits of a search.
            let within = proof.gap().max(proof.rounding);
            format!("proven lower and upper bound of t agree to {within:.0e}")
        } else {
            "t is a proven lower bound".into()
        };
        details.push(format!("normal n = {}; {agreement}", components(contact.normal)));
        Self {
            origin: points.on_fixed,
            stop: contact.translation * length,
            normal: contact.normal,
            touches: true,
            marks: Some(Marks {
                moving: Mark::of(features.moving, scene.cast.moving()),
                fixed: Mark::of(features.fixed, scene.cast.fixed()),
            }),
            margin: None,
            link: None,
            meets: false,
            is_still: false,
            headline: match (ContactRange::Contact { first: *contact, last: *last }).clearance() {
                Clearance::Overlapping(_) => {
                    format!("{name}: the bodies overlap now, first contact at {way}")
                }
                Clearance::Free(WhyFree::Behind(_)) => format!("{name}: lies behind, at {way}"),
                _ => format!("{name} at {way}"),
            },
            way,
            details,
        }
    }

    /// The bodies pass each other: shown where they are side by side.
    fn of_separated(scene: &Scene<'_>, separated: &Separated) -> Self {
        let normal = separated.certificate.normal;
        let cast = scene.cast;
        let origin = cast.fixed_pose().transform_point(cast.fixed().vertices()[0]);
        let moving = Solid::new(cast.moving(), &cast.moving_pose(), origin);
        let fixed = Solid::new(cast.fixed(), &cast.fixed_pose(), origin);
        let unit = cast.direction().normalize();
        let ahead = (fixed.support(-normal) - moving.support(normal)).dot(unit);
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
                components(normal)
            )],
        }
    }

    /// The normal, or its opposite where that shows the contact face of the moving body: a face is
    /// seen from its own side, and the body that has only a vertex or an edge there hides less.
    pub(super) fn looked_along(&self) -> DVec3 {
        let is_face = |mark| matches!(mark, Mark::Face(_));
        match self.marks {
            Some(m) if is_face(m.moving) && !is_face(m.fixed) => -self.normal,
            _ => self.normal,
        }
    }

    /// Ends of the gap between separated bodies where the moving one stops, along the normal.
    pub(super) fn gap(&self, cast: &Cast) -> Option<[DVec3; 2]> {
        let from = cast.stop.support(self.normal);
        self.margin.map(|margin| [from, from + margin * self.normal])
    }

    /// What has to be seen besides the bodies.
    pub(super) fn corners(&self, cast: &Cast) -> Vec<DVec3> {
        let link = self.link.iter().flat_map(|(ends, _)| *ends);
        self.plane(cast).into_iter().flatten().chain(link).collect()
    }

    /// A piece of the separating plane, midway in the gap.
    pub(super) fn plane(&self, cast: &Cast) -> Option<[DVec3; 4]> {
        let [from, to] = self.gap(cast)?;
        let along = cast.way.normalize_or(self.normal.any_orthonormal_vector());
        let across = self.normal.cross(along);
        let half = 1.1 * working_size(cast.stop.ball().1, cast.fixed.ball().1, 0.0);
        let middle = 0.5 * (from + to);
        let corner = |a: f64, b: f64| middle + a * half * along + b * half * across;
        Some([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)])
    }
}

/// A unit vector, with rounding noise as 0.
pub(super) fn components(unit: DVec3) -> String {
    let [x, y, z] = unit.to_array().map(|c| if c.abs() < 1e-12 { 0.0 } else { c }).map(short);
    format!("({x}, {y}, {z})")
}

pub(super) fn quantity(translation: f64, length: f64) -> String {
    if (length - 1.0).abs() < 1e-12 {
        format!("t = {}", short(translation))
    } else {
        format!("t = {} (length {})", short(translation), short(translation * length))
    }
}

/// A number in up to six digits.
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
    fn numbers_are_short() {
        let shown = [0.0, -0.0, 2.5, -1.0 / 3.0, 123_456.78, 1e-16, 2e7, 1e-4].map(short);
        assert_eq!(shown, ["0", "0", "2.5", "-0.333333", "123457", "1.00e-16", "2.00e7", "0.0001"]);
    }
}
