//! Pictures of parts: shaded areas and visible edges, as SVG.
//!
//! Parallel projection onto a raster with depths. Areas are the raster's cells, merged along rows;
//! feature edges (a sharp angle, or a silhouette) are cut where the raster says that something is in
//! front of them, and drawn as lines. So a picture's size grows with its pixels and lines, not with
//! the facets.

use std::collections::HashMap;
use std::fmt::Write;

use glam::{DVec2, DVec3, Vec3Swizzles};

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

/// Pixels of the raster; the picture is twice as wide.
const RASTER: [usize; 2] = [400, 300];
const MARGIN: f64 = 14.0;
/// Edges at which facets meet at a larger angle are drawn: its cosine.
const SHARP: f64 = 0.82;
const SHADES: usize = 6;

struct View {
    right: DVec3,
    up: DVec3,
    towards: DVec3,
    scale: f64,
    offset: DVec2,
}

impl View {
    /// From the front, right and above; fits all points.
    fn fitting(points: impl Iterator<Item = DVec3>) -> Self {
        let towards = DVec3::new(0.65, -0.62, 0.44).normalize();
        let right = DVec3::Z.cross(towards).normalize();
        let up = towards.cross(right);
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for p in points {
            let at = DVec2::new(p.dot(right), -p.dot(up));
            low = low.min(at);
            high = high.max(at);
        }
        let room = DVec2::new(RASTER[0] as f64, RASTER[1] as f64) - 2.0 * MARGIN;
        let span = (high - low).max(DVec2::splat(1e-12));
        let scale = (room / span).min_element();
        let offset = DVec2::splat(MARGIN) + (room - span * scale) * 0.5 - low * scale;
        Self { right, up, towards, scale, offset }
    }

    /// Raster coordinates, and the depth, larger towards the viewer.
    fn place(&self, p: DVec3) -> DVec3 {
        let flat = DVec2::new(p.dot(self.right), -p.dot(self.up)) * self.scale + self.offset;
        flat.extend(p.dot(self.towards) * self.scale)
    }
}

/// Which part and shade a cell shows.
#[derive(Clone, Copy, PartialEq)]
struct Cell {
    shown: u32,
    shade: u8,
}

struct Raster {
    depth: Vec<f32>,
    cells: Vec<Option<Cell>>,
}

/// A picture of parts.
pub fn svg(shown: &[Shown], arrows: &[Arrow]) -> String {
    let corners = shown.iter().flat_map(|s| {
        let (part, by) = (s.part, s.by);
        part.solid().vertices().iter().map(move |v| *v + by)
    });
    let view = View::fitting(corners.chain(arrows.iter().flat_map(|a| [a.from, a.to])));
    let raster = rasterised(shown, &view);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        RASTER[0], RASTER[1]
    );
    areas(&mut text, shown, &raster);
    for (k, s) in shown.iter().enumerate() {
        lines(&mut text, s, k, &view, &raster);
    }
    for a in arrows {
        arrow(&mut text, view.place(a.from).xy(), view.place(a.to).xy());
    }
    text.push_str("</svg>\n");
    text
}

fn rasterised(shown: &[Shown], view: &View) -> Raster {
    let cells = RASTER[0] * RASTER[1];
    let mut raster = Raster { depth: vec![f32::NEG_INFINITY; cells], cells: vec![None; cells] };
    let light = (view.towards + view.up * 0.8 - view.right * 0.45).normalize();
    for (k, s) in shown.iter().enumerate() {
        let solid = s.part.solid();
        for t in solid.triangles() {
            let corners = t.map(|v| solid.vertices()[v as usize] + s.by);
            let normal =
                (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
            if solid.is_closed() && normal.dot(view.towards) <= 0.0 {
                continue;
            }
            let lit = (0.5 + 0.5 * normal.dot(light)).clamp(0.0, 1.0);
            let shade = (lit * (SHADES as f64 - 0.01)) as u8;
            raster.fill(corners.map(|c| view.place(c)), Cell { shown: k as u32, shade });
        }
    }
    raster
}

impl Raster {
    /// Cells whose centres lie in a triangle, where it is in front.
    fn fill(&mut self, [a, b, c]: [DVec3; 3], cell: Cell) {
        let area = (b - a).xy().perp_dot((c - a).xy());
        if area == 0.0 {
            return;
        }
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let clip = |x: f64, most: usize| (x.max(0.0) as usize).min(most);
        for row in clip(low.y - 0.5, RASTER[1])..clip(high.y + 1.5, RASTER[1]) {
            for column in clip(low.x - 0.5, RASTER[0])..clip(high.x + 1.5, RASTER[0]) {
                let p = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
                let v = (p - a.xy()).perp_dot((c - a).xy()) / area;
                let w = (b - a).xy().perp_dot(p - a.xy()) / area;
                if v < 0.0 || w < 0.0 || v + w > 1.0 {
                    continue;
                }
                let depth = (a.z + (b.z - a.z) * v + (c.z - a.z) * w) as f32;
                let at = row * RASTER[0] + column;
                if depth > self.depth[at] {
                    (self.depth[at], self.cells[at]) = (depth, Some(cell));
                }
            }
        }
    }

    /// Whether something lies in front of a point, by more than the raster's own error; just beside
    /// it counts as not.
    fn hides(&self, p: DVec3) -> bool {
        let mut farthest = f32::INFINITY;
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
            let (x, y) = (p.x + dx, p.y + dy);
            if x < 0.0 || y < 0.0 || x >= RASTER[0] as f64 || y >= RASTER[1] as f64 {
                return false;
            }
            farthest = farthest.min(self.depth[y as usize * RASTER[0] + x as usize]);
        }
        f64::from(farthest) > p.z + 1.5
    }
}

fn areas(text: &mut String, shown: &[Shown], raster: &Raster) {
    let mut paths: Vec<String> = vec![String::new(); shown.len() * SHADES];
    for row in 0..RASTER[1] {
        let line = &raster.cells[row * RASTER[0]..(row + 1) * RASTER[0]];
        let mut from = 0;
        while from < line.len() {
            let to = (from..line.len()).find(|&k| line[k] != line[from]).unwrap_or(line.len());
            if let Some(cell) = line[from] {
                let path = &mut paths[cell.shown as usize * SHADES + cell.shade as usize];
                let _ = write!(path, "M{from} {row}h{}v1h-{}z", to - from, to - from);
            }
            from = to;
        }
    }
    for (k, path) in paths.iter().enumerate().filter(|(_, path)| !path.is_empty()) {
        let s = &shown[k / SHADES];
        let light = 0.55 + 0.5 * (k % SHADES) as f64 / (SHADES - 1) as f64;
        let [r, g, b] = tint(s.color).map(|c| {
            let c = (c * light).min(1.0);
            let c = if s.pale { 0.25 * c + 0.75 * (0.80 + 0.12 * light) } else { c };
            (c.min(1.0) * 255.0) as u8
        });
        let fill = format!("#{r:02x}{g:02x}{b:02x}");
        // A thin rim of its own colour hides the seams between rows.
        let _ = writeln!(
            text,
            "<path fill=\"{fill}\" stroke=\"{fill}\" stroke-width=\"0.3\" d=\"{path}\"/>"
        );
    }
}

/// The visible pieces of a part's feature edges.
fn lines(text: &mut String, s: &Shown, _k: usize, view: &View, raster: &Raster) {
    let mut path = String::new();
    for [a, b] in features(s.part, view.towards) {
        let (a, b) = (view.place(a + s.by), view.place(b + s.by));
        let pieces = ((b - a).xy().length() / 2.0).ceil().clamp(1.0, 400.0) as usize;
        let at = |k: usize| a + (b - a) * (k as f64 / pieces as f64);
        let mut from: Option<usize> = None;
        for k in 0..=pieces {
            let seen = k < pieces && !raster.hides(at(k).midpoint(at(k + 1)));
            match (seen, from) {
                (true, None) => from = Some(k),
                (false, Some(start)) => {
                    let (p, q) = (at(start), at(k));
                    let _ = write!(path, "M{:.1} {:.1}L{:.1} {:.1}", p.x, p.y, q.x, q.y);
                    from = None;
                }
                _ => (),
            }
        }
    }
    if !path.is_empty() {
        let color = if s.pale { "#9a9a9a" } else { "#222" };
        let _ = writeln!(
            text,
            "<path fill=\"none\" stroke=\"{color}\" stroke-width=\"0.7\" stroke-linecap=\"round\" \
             d=\"{path}\"/>"
        );
    }
}

/// Sharp edges, silhouettes and rims.
fn features(part: &Part, towards: DVec3) -> Vec<[DVec3; 2]> {
    let solid = part.solid();
    let corner = |v: u32| solid.vertices()[v as usize];
    let mut open: HashMap<[u32; 2], DVec3> = HashMap::new();
    let mut found = Vec::new();
    for t in solid.triangles() {
        let [a, b, c] = t.map(corner);
        let n = (b - a).cross(c - a).normalize_or_zero();
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            let key = [a.min(b), a.max(b)];
            let Some(m) = open.remove(&key) else {
                open.insert(key, n);
                continue;
            };
            let (x, y) = (n.dot(towards), m.dot(towards));
            let seen = x > 0.0 || y > 0.0;
            let silhouette = (x > 0.0) != (y > 0.0);
            if seen && (n.dot(m) < SHARP || silhouette) {
                found.push([corner(a), corner(b)]);
            }
        }
    }
    let mut rims: Vec<[u32; 2]> = open.into_keys().collect();
    rims.sort_unstable();
    found.extend(rims.into_iter().map(|e| e.map(corner)));
    found
}

fn arrow(text: &mut String, from: DVec2, to: DVec2) {
    let Some(along) = (to - from).try_normalize() else { return };
    let side = along.perp() * 4.0;
    let neck = to - along * 11.0;
    let (p, q) = (neck + side, neck - side);
    let _ = writeln!(
        text,
        "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"#c02020\" stroke-width=\"2.5\" \
         fill=\"none\"/><path d=\"M{:.1} {:.1}L{:.1} {:.1}L{:.1} {:.1}z\" fill=\"#c02020\"/>",
        from.x, from.y, neck.x, neck.y, to.x, to.y, p.x, p.y, q.x, q.y
    );
}
