//! Convex solids by the cast of their hulls, before any search: nearly all of them are told by it.
//!
//! [`transferred`] takes the answer of that cast as it is, where its certificate is one of the solids as well.
//! [`contact_facets`] only takes a normal and a place on either body from it, and proves those of the solids:
//!
//! - *Nothing is earlier.* A plane with that normal, all of the moving body (shrunk, if there is a tolerance) below it
//!   and all of the fixed one above, bounds all gaps of facets. How far each reaches is told by the vertices that may
//!   be farthest. Where the bound is positive the bodies do not overlap where they are. Boxes that touch along an axis
//!   without rounding bound them by 0, and do not overlap either.
//! - *There is a contact.* The gap of two facets around the place, as the search would take it. If it is above that
//!   bound by no more than the search may leave open, it is the answer of the search, with the bounds of one.
//! - *Nothing is in the way.* A plane that the moving body leaves behind, with the bodies on either side.
//!
//! So it does not matter how the hull was rounded, nor whether the solid is quite as convex as it is taken for. What
//! neither tells is searched.

mod contact_facets;
mod surface;
mod transferred;

use std::cell::OnceCell;

use glam::DVec3;

use crate::body::Solid;
use colltrans_convex::answer::{Contact, Outcome};
use colltrans_convex::body::ConvexPolyhedron;
use colltrans_convex::body::Keepable;
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::Setting;
use colltrans_convex::solve::options::Options;
pub(super) use contact_facets::Guessed;
use surface::{Spot, Surface};

/// A facet may rise so far, as a share of the size, beyond the plane of the next one in a body that counts as convex.
const BENT: f64 = 1e-9;
/// What rounding may take from a height over a plane of a body, as a share of its size.
const HEIGHT: f64 = 16.0 * f64::EPSILON;

/// The convex hulls of the two solids of a query, and their cast.
pub(super) struct Hulls<'a> {
    bodies: [Surface<'a>; 2],
    cast: Cast<'a>,
    /// What it is answered.
    first: Outcome,
    /// Where they meet last, behind, once that has been asked.
    last: OnceCell<Option<Contact>>,
}

impl<'a> Hulls<'a> {
    /// Of convex solids that do not overlap for all that is known, and are to keep no gap.
    pub(super) fn of(cast: &Cast<'a, Solid>) -> Option<Self> {
        let options = cast.options();
        if options.keep > 0.0 || options.overlapping == Some(true) {
            return None;
        }
        let bodies = [Surface::of(cast.moving())?, Surface::of(cast.fixed())?];
        let Setting { direction, length, unit, .. } = cast.setting;
        let held = cast.setting.bodies.holding(bodies.map(|surface| &surface.body.hull));
        let setting = Setting { bodies: held, direction, length, unit };
        let cast = Cast { setting, options: Options::default() };
        Some(Self { bodies, cast, first: cast.first_contact().ok()?, last: OnceCell::new() })
    }

    /// Where the bodies meet last, of such as meet first behind and do not certainly overlap.
    fn last(&self) -> Option<&Contact> {
        let last = || match self.cast.reversed().first_contact().ok()? {
            Outcome::Contact(last) if last.certificate.upper >= 0.0 => Some(last),
            _ => None,
        };
        self.last.get_or_init(last).as_ref()
    }
}

/// Whether both solids of a query are convex.
pub(super) fn are_convex(cast: &Cast<'_, Solid>) -> bool {
    Body::of(cast.moving()).is_some() && Body::of(cast.fixed()).is_some()
}

/// The convex hull of a solid, if that is convex.
#[derive(Debug)]
struct Hull(Option<Body>);

#[derive(Debug)]
struct Body {
    hull: ConvexPolyhedron,
    /// A triangle of the solid at each vertex of the hull.
    at: Vec<u32>,
    /// Whether the solid has no other vertices.
    whole: bool,
    /// What is deeper than this below the surface of the hull is inside the solid.
    dent: f64,
    /// The radius of a ball inside the hull.
    inner: f64,
}

impl Keepable for Hull {
    fn heap_bytes(&self) -> usize {
        self.0
            .as_ref()
            .map_or(0, |body| body.hull.memory_bytes() + body.at.capacity() * size_of::<u32>())
    }
}

impl Hull {
    fn new(solid: &Solid) -> Self {
        Self(is_convex(solid).then(|| Body::new(solid)).flatten())
    }
}

impl Body {
    /// That of a convex solid, made when it is first asked for.
    fn of(solid: &Solid) -> Option<&Self> {
        solid.kept().get_or_make(|| Hull::new(solid))?.0.as_ref()
    }

    fn new(solid: &Solid) -> Option<Self> {
        let hull = ConvexPolyhedron::from_points(solid.vertices()).ok()?.without_input_excess();
        if hull.dimension() < 3 {
            return None;
        }
        let mut triangle = vec![0; solid.vertices().len()];
        for (t, corners) in solid.triangles().iter().enumerate() {
            for &v in corners {
                triangle[v as usize] = t as u32;
            }
        }
        let at = hull.input_indices().iter().map(|v| triangle[v.index()]).collect();
        let whole = hull.vertices().len() == solid.vertices().len();
        let (dent, inner) = (dent(solid, &hull), inner_radius(solid, &hull));
        Some(Self { hull, at, whole, dent, inner })
    }

    /// Number in the solid of a vertex of the hull.
    fn number(&self, vertex: u32) -> u32 {
        self.hull.input_indices()[vertex as usize].0
    }
}

/// Whether a solid is one closed shell that bends outwards at each edge, to within a little.
fn is_convex(solid: &Solid) -> bool {
    let (triangles, vertices) = (solid.triangles(), solid.vertices());
    let place = |v: u32| vertices[v as usize];
    let bends_outwards = |t: usize| {
        let [a, b, c] = triangles[t].map(place);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let mut across = solid.neighbours()[t].iter().flat_map(|&n| triangles[n as usize]);
        across.all(|v| normal.dot(place(v) - a) <= BENT * solid.reach())
    };
    solid.is_closed() && solid.spans().len() == 1 && (0..triangles.len()).all(bends_outwards)
}

/// How far the hull rises above the planes of a convex solid's facets: no point of a facet lies deeper in it.
fn dent(solid: &Solid, hull: &ConvexPolyhedron) -> f64 {
    let above = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|v| solid.vertices()[v as usize]);
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { return f64::INFINITY };
        // A narrow facet's normal may be off.
        let low = [a, b, c].map(|p| normal.dot(p)).into_iter().fold(f64::INFINITY, f64::min);
        normal.dot(hull.vertices()[hull.support(normal).index()]) - low
    };
    let most = solid.triangles().iter().map(above).fold(0.0, f64::max);
    most + hull.hull_error() + HEIGHT * solid.reach()
}

/// The radius of a ball around the mean of the hull's vertices that lies inside it.
fn inner_radius(solid: &Solid, hull: &ConvexPolyhedron) -> f64 {
    let middle = hull.vertices().iter().sum::<DVec3>() / hull.vertices().len() as f64;
    let depth = |face: u32| {
        let on = hull.face_vertices(face).next().map_or(middle, |v| hull.vertices()[v as usize]);
        hull.face_normal(face).dot(on - middle)
    };
    let least = (0..hull.face_count() as u32).map(depth).fold(f64::INFINITY, f64::min);
    least - hull.hull_error() - HEIGHT * solid.reach()
}
