//! Pictures of parts: shaded areas and visible edges, as SVG.
//!
//! Parallel projection. Areas are tiles of a raster of depths, edges what of them the raster does not
//! hide ([`colltrans_picture`]). So a picture's size grows with its pixels and lines, not with the
//! facets.

use colltrans_picture::{Frame, Page, Raster, SMOOTH, Stroke, View, edges};
use glam::{DVec2, DVec3};

use super::tint;
use crate::part::Part;

/// A part and where it is drawn.
pub struct Shown<'a> {
    /// The part.
    pub part: &'a Part,
    /// Its colour's number.
    pub color: usize,
    /// How far it is displaced from its place.
    pub by: DVec3,
    /// Whether it is drawn pale.
    pub pale: bool,
}

/// An arrow in the world.
pub struct Arrow {
    /// Where it begins.
    pub from: DVec3,
    /// Where it ends.
    pub to: DVec3,
}

/// The picture's size in pixels.
const SIZE: DVec2 = DVec2::new(400.0, 300.0);
const MARGIN: f64 = 14.0;
const SHADES: usize = 6;
/// Depths, in pixels, may be off by this much.
const SLACK: f64 = 1.5;

/// From the world to the page: from the front, right and above; fits all points.
struct Eye {
    view: View,
    scale: f64,
    offset: DVec2,
}

impl Eye {
    fn fitting(points: impl Iterator<Item = DVec3>) -> Self {
        let view = View::from(DVec3::new(0.65, -0.62, 0.44));
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for p in points {
            let at = view.project(p) * DVec2::new(1.0, -1.0);
            low = low.min(at);
            high = high.max(at);
        }
        let room = SIZE - 2.0 * MARGIN;
        let span = (high - low).max(DVec2::splat(1e-12));
        let scale = (room / span).min_element();
        let offset = DVec2::splat(MARGIN) + (room - span * scale) * 0.5 - low * scale;
        Self { view, scale, offset }
    }

    /// A point on the page, and how near it is, in pixels.
    fn see(&self, p: DVec3) -> DVec3 {
        let flat = self.view.project(p) * DVec2::new(1.0, -1.0) * self.scale + self.offset;
        flat.extend(p.dot(self.view.toward) * self.scale)
    }
}

/// A picture of parts.
pub fn svg(shown: &[Shown], arrows: &[Arrow]) -> String {
    let corners = shown.iter().flat_map(|s| {
        let (part, by) = (s.part, s.by);
        part.solid().vertices().iter().map(move |v| *v + by)
    });
    let eye = Eye::fitting(corners.chain(arrows.iter().flat_map(|a| [a.from, a.to])));
    let window = Frame { low: DVec2::ZERO, high: SIZE };
    let mut raster = Raster::new(window);
    for (k, s) in shown.iter().enumerate() {
        rasterise(&mut raster, s, k * SHADES, &eye);
    }
    let mut page = Page::new(window);
    for (tone, tiles) in raster.tiles().iter().enumerate() {
        let colour = colour(&shown[tone / SHADES], tone % SHADES);
        // A thin rim of its own colour hides the seams between tiles.
        page.tiles(&format!(r#"fill="{colour}" stroke="{colour}" stroke-width="0.3""#), tiles);
    }
    for s in shown {
        let ends = |edge: [DVec3; 2]| edge.map(|p| eye.see(p + s.by));
        let lines = features(s.part, eye.view.toward).into_iter().map(ends);
        let colour = if s.pale { "#9a9a9a" } else { "#222222" };
        let seen = lines.flat_map(|line| {
            let [seen, _] = raster.split(line, SLACK);
            seen
        });
        page.segments(Stroke::solid(colour, 0.7), seen);
    }
    for a in arrows {
        page.arrow("#c02020", 2.5, [a.from, a.to].map(|p| eye.see(p).truncate()));
    }
    page.inline(SIZE)
}

/// Facets that look towards the viewer, and those of surfaces also from behind.
fn rasterise(raster: &mut Raster, s: &Shown, first_tone: usize, eye: &Eye) {
    let solid = s.part.solid();
    for t in solid.triangles() {
        let corners = t.map(|v| solid.vertices()[v as usize] + s.by);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
        let facing = normal.dot(eye.view.toward);
        if solid.is_closed() && facing <= 0.0 {
            continue;
        }
        let lit = eye.view.brightness(normal * facing.signum());
        let shade = (lit * (SHADES as f64 - 0.01)) as usize;
        raster.draw(corners.map(|c| eye.see(c)), (first_tone + shade) as u32);
    }
}

fn colour(s: &Shown, shade: usize) -> String {
    let light = 0.55 + 0.5 * shade as f64 / (SHADES - 1) as f64;
    let [r, g, b] = tint(s.color).map(|c| {
        let c = (c * light).min(1.0);
        let c = if s.pale { 0.25 * c + 0.75 * (0.80 + 0.12 * light) } else { c };
        (c.min(1.0) * 255.0) as u8
    });
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Sharp edges, silhouettes and rims.
fn features(part: &Part, toward: DVec3) -> Vec<[DVec3; 2]> {
    let solid = part.solid();
    let corner = |v: u32| solid.vertices()[v as usize];
    let normal = |face: u32| {
        let [a, b, c] = solid.triangles()[face as usize].map(corner);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let drawn = |faces: &[u32]| {
        // Pairs of facets, in their order, as they meet at an edge that several share.
        faces.chunks(2).any(|pair| match *pair {
            [f, g] => {
                let (m, n) = (normal(f), normal(g));
                let [x, y] = [m, n].map(|n| n.dot(toward) > 0.0);
                (x || y) && (n.dot(m) < SMOOTH || x != y)
            }
            _ => true,
        })
    };
    let all = edges(solid.triangles()).into_iter().filter(|(_, faces)| drawn(faces));
    all.map(|(ends, _)| ends.map(corner)).collect()
}
