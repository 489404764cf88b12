//! Pictures of parts as SVG: shaded areas and visible edges, in parallel projection.
//!
//! Areas are tiles of a depth raster, and edges are drawn where this raster does not hide them
//! ([`colltrans_picture`]). Therefore the size of a picture grows with its pixels and lines, not with the
//! number of facets. The same rasters decide which view shows the moving parts, and which parts hide them.

use std::collections::BTreeMap;

use colltrans_picture::{
    CONTACT, EDGE_WIDTH, FINE_WIDTH, Frame, GUIDE_WIDTH, INK, Page, QUIET, Raster, Stroke, View,
};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::lines::Lines;
use super::{Analysis, html_colour, kinds};
use crate::part::Part;

/// Style in which a part is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Look {
    /// In its colour.
    Full,
    /// In its colour, as a moving part.
    Moving,
    /// Pale, as a part that stays.
    Pale,
    /// Transparent, because it would hide moving parts.
    Glass,
}

/// A part of a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shown {
    /// Index of the part in the assembly.
    pub part: usize,
    /// Displacement from the part's place.
    pub by: DVec3,
    /// Style.
    pub look: Look,
}

/// An arrow in the world.
#[derive(Debug, Clone)]
pub(super) struct Arrow {
    /// Start.
    pub from: DVec3,
    /// Tip.
    pub to: DVec3,
    /// Text next to the tip.
    pub label: String,
}

/// Content of a picture.
pub(super) struct Scene {
    /// Size in pixels.
    pub size: DVec2,
    pub shown: Vec<Shown>,
    pub arrows: Vec<Arrow>,
    /// Lines along which parts were moved.
    pub traces: Vec<[DVec3; 2]>,
    /// Numbers of kinds, each with the parts of the kind, one of which is labelled.
    pub numbers: Vec<(usize, Vec<usize>)>,
    /// Description for readers who cannot view the picture.
    pub label: String,
}

/// The assembly, prepared for several pictures.
pub(super) struct Studio<'a> {
    parts: &'a [Part],
    lines: Vec<Lines>,
    colours: Vec<[f64; 3]>,
    up: DVec3,
}

/// A view with its name.
#[derive(Debug, Clone, Copy)]
pub(super) struct Viewpoint {
    view: View,
    /// Name of the view, for example "from below"; empty for the default view.
    pub name: &'static str,
}

/// Margin of a picture in pixels.
const MARGIN: f64 = 14.0;
/// Margin on both sides for numbers in pixels.
const NUMBER_MARGIN: f64 = 60.0;
/// Distance of a number from its side of the picture in pixels.
const NUMBER_INSET: f64 = 19.0;
/// Number of shades of a colour.
const SHADES: usize = 6;
/// Tolerance of depths, in pixels.
const DEPTH_TOLERANCE: f64 = 1.5;
/// Scale of the pictures in which visible samples are counted.
const COARSE_SCALE: f64 = 0.25;
/// Minimum visible share of moving parts.
const MIN_VISIBLE_SHARE: f64 = 0.5;
/// Maximum number of parts that are made transparent, one in each round.
const MAX_GLASS_ROUNDS: usize = 16;
/// Minimum width of a picture with axes in pixels.
const MIN_WIDTH_OF_AXES: f64 = 300.0;
/// Width of arrows, which are wider than in pictures of two bodies, in pixels.
const REPORT_ARROW_WIDTH: f64 = 2.5;

/// Views: azimuth and elevation in degrees, a penalty, and the name. The default view is the first one.
const VIEWPOINTS: [(f64, f64, f64, &str); 9] = [
    (-43.6, 26.0, 0.0, ""),
    (-43.6, 60.0, 0.08, "from high above"),
    (46.4, 26.0, 0.1, "from the right"),
    (-133.6, 26.0, 0.1, "from the left"),
    (136.4, 26.0, 0.12, "from behind"),
    (-43.6, -30.0, 0.12, "from below"),
    (46.4, -30.0, 0.16, "from below, from the right"),
    (-133.6, -30.0, 0.16, "from below, from the left"),
    (136.4, -30.0, 0.18, "from below, from behind"),
];

/// Projection from the world to the page.
struct Projection {
    view: View,
    scale: f64,
    offset: DVec2,
}

impl Projection {
    /// Fits the projection of a view to points, with margins.
    fn fit_to_points(
        view: View,
        points: impl Iterator<Item = DVec3>,
        size: DVec2,
        margin: DVec2,
    ) -> Self {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for p in points {
            let at = view.project(p) * DVec2::new(1.0, -1.0);
            low = low.min(at);
            high = high.max(at);
        }
        let room = size - 2.0 * margin;
        let span = (high - low).max(DVec2::splat(1e-12));
        let scale = (room / span).min_element();
        let offset = margin + (room - span * scale) * 0.5 - low * scale;
        Self { view, scale, offset }
    }

    /// Projects a point to the page, with its depth in pixels (larger is nearer) as third coordinate.
    fn project(&self, p: DVec3) -> DVec3 {
        let flat = self.view.project(p) * DVec2::new(1.0, -1.0) * self.scale + self.offset;
        flat.extend(p.dot(self.view.toward) * self.scale)
    }

    /// Returns the projection to a page scaled by a factor.
    fn scaled(&self, factor: f64) -> Self {
        Self { view: self.view, scale: self.scale * factor, offset: self.offset * factor }
    }
}

impl<'a> Studio<'a> {
    /// Finds the drawable edges and the colours of all parts.
    pub(super) fn new(f: &Analysis<'a>) -> Self {
        let parts = f.bodies.assembly().parts();
        let lines = parts.par_iter().map(|part| Lines::new(part.solid())).collect();
        Self { parts, lines, colours: kinds::part_colours(&f.plan, parts), up: f.up }
    }

    /// Returns the default view.
    pub(super) fn default_viewpoint(&self) -> Viewpoint {
        self.viewpoints().next().expect("there are some")
    }

    /// Iterates over the views in the frame of the assembly's upward direction.
    fn viewpoints(&self) -> impl Iterator<Item = Viewpoint> + use<> {
        let up = self.up;
        let turn = glam::DQuat::from_rotation_arc(DVec3::Z, up);
        VIEWPOINTS.iter().map(move |&(azimuth, height, _, name)| {
            let (sin_a, cos_a) = f64::to_radians(azimuth).sin_cos();
            let (sin_h, cos_h) = f64::to_radians(height).sin_cos();
            let toward = turn * DVec3::new(cos_h * cos_a, cos_h * sin_a, sin_h);
            Viewpoint { view: View::looking_along(toward, up), name }
        })
    }

    /// Fits the projection of a view to all parts and arrows of a scene.
    fn projection(&self, scene: &Scene, view: View) -> Projection {
        let corners = scene.shown.iter().flat_map(|s| {
            let vertices = self.parts[s.part].solid().vertices().iter();
            vertices.map(move |v| *v + s.by)
        });
        let arrows = scene.arrows.iter().flat_map(|a| [a.from, a.to]);
        let aside = if scene.numbers.is_empty() { MARGIN } else { NUMBER_MARGIN };
        Projection::fit_to_points(
            view,
            corners.chain(arrows),
            scene.size,
            DVec2::new(aside, MARGIN),
        )
    }

    /// Returns the height in pixels that a scene of given width needs in the default view, between two
    /// bounds.
    pub(super) fn picture_height(&self, scene: &Scene, [least, most]: [f64; 2]) -> f64 {
        let projection = self.projection(scene, self.default_viewpoint().view);
        let corners = scene.shown.iter().flat_map(|s| {
            let vertices = self.parts[s.part].solid().vertices().iter();
            vertices.map(move |v| projection.view.project(*v + s.by))
        });
        let (low, high) = corners.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| {
            (low.min(p), high.max(p))
        });
        let span = high - low;
        let room = scene.size.x - 2.0 * NUMBER_MARGIN;
        (room * span.y / span.x.max(1e-12) + 2.0 * MARGIN).clamp(least, most)
    }

    /// Selects a view of the groups, and makes parts transparent that hide a group in it. The view has the
    /// largest visible share of the least visible group, less its penalty. The first sufficient view ends the
    /// search.
    pub(super) fn choose_viewpoint(&self, scene: &mut Scene, groups: &[Vec<usize>]) -> Viewpoint {
        let mut best = (f64::NEG_INFINITY, self.default_viewpoint());
        for (viewpoint, (_, _, price, _)) in self.viewpoints().zip(VIEWPOINTS) {
            let seen = self.least_visible_share(scene, viewpoint.view, groups);
            if seen - price > best.0 {
                best = (seen - price, viewpoint);
            }
            if best.0 >= MIN_VISIBLE_SHARE {
                break;
            }
        }
        self.make_hiding_parts_glass(scene, best.1.view, groups);
        best.1
    }

    /// Returns the visible share of the least visible group. The whole is the number of samples of the group
    /// drawn alone.
    fn least_visible_share(&self, scene: &Scene, view: View, groups: &[Vec<usize>]) -> f64 {
        let projection = self.projection(scene, view).scaled(COARSE_SCALE);
        let all = sample_counts(&self.index_raster(scene, &projection, |s| s.look != Look::Glass));
        let share = |group: &Vec<usize>| {
            let alone =
                sample_counts(&self.index_raster(scene, &projection, |s| group.contains(&s.part)));
            let [seen, whole] = [&all, &alone]
                .map(|counts| group.iter().filter_map(|part| counts.get(part)).sum::<usize>());
            seen as f64 / whole.max(1) as f64
        };
        groups.par_iter().map(share).reduce(|| 1.0, f64::min)
    }

    /// Makes parts transparent that hide a group, starting with the one that hides most samples, until each
    /// group is sufficiently visible.
    fn make_hiding_parts_glass(&self, scene: &mut Scene, view: View, groups: &[Vec<usize>]) {
        let projection = self.projection(scene, view).scaled(COARSE_SCALE);
        for _ in 0..MAX_GLASS_ROUNDS {
            if self.least_visible_share(scene, view, groups) >= MIN_VISIBLE_SHARE {
                break;
            }
            let all = self.index_raster(scene, &projection, |s| s.look != Look::Glass);
            let moving = self.index_raster(scene, &projection, |s| s.look == Look::Moving);
            let mut hidden_samples = BTreeMap::<usize, usize>::new();
            for ((_, default_viewpoint), (_, behind)) in all.samples().zip(moving.samples()) {
                if let (Some(default_viewpoint), Some(_)) = (default_viewpoint, behind) {
                    *hidden_samples.entry(default_viewpoint as usize).or_default() += 1;
                }
            }
            let stays = |s: &&Shown| s.look == Look::Pale && hidden_samples.contains_key(&s.part);
            let most =
                scene.shown.iter().filter(stays).max_by_key(|s| (hidden_samples[&s.part], s.part));
            let Some(part) = most.map(|s| s.part) else { break };
            for s in scene.shown.iter_mut().filter(|s| s.part == part) {
                s.look = Look::Glass;
            }
        }
    }

    /// Draws part indices on a small raster.
    fn index_raster(
        &self,
        scene: &Scene,
        projection: &Projection,
        drawn: impl Fn(&Shown) -> bool,
    ) -> Raster {
        let high = (scene.size * COARSE_SCALE).ceil();
        let mut raster = Raster::new(Frame { low: DVec2::ZERO, high });
        for s in scene.shown.iter().filter(|s| drawn(s)) {
            self.rasterise(&mut raster, s, projection, |_| s.part as u32);
        }
        raster
    }

    /// Draws the facets of a part that face the viewer, and those of open surfaces from both sides. `tone`
    /// maps the brightness of a facet to its tone.
    fn rasterise(
        &self,
        raster: &mut Raster,
        s: &Shown,
        projection: &Projection,
        tone: impl Fn(f64) -> u32,
    ) {
        let solid = self.parts[s.part].solid();
        for t in solid.triangles() {
            let corners = t.map(|v| solid.vertices()[v as usize] + s.by);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let normal = normal.normalize_or_zero();
            let facing = normal.dot(projection.view.toward);
            if solid.is_closed() && facing <= 0.0 {
                continue;
            }
            let lit = projection.view.brightness(normal * facing.signum());
            raster.draw(corners.map(|c| projection.project(c)), tone(lit));
        }
    }

    /// Draws a scene as SVG.
    pub(super) fn draw_picture(&self, scene: &Scene, viewpoint: Viewpoint) -> String {
        let projection = self.projection(scene, viewpoint.view);
        let window = Frame { low: DVec2::ZERO, high: scene.size };
        let (mut raster, mut glass) = (Raster::new(window), Raster::new(window));
        for (k, s) in scene.shown.iter().enumerate() {
            // Pale parts have half of the shades, so that their pictures have half of the tiles.
            let step = if s.look == Look::Pale { 2 } else { 1 };
            let shade = |lit: f64| (lit * (SHADES as f64 - 0.01)) as usize / step * step;
            let tone = |lit| (k * SHADES + shade(lit)) as u32;
            self.rasterise(
                if s.look == Look::Glass { &mut glass } else { &mut raster },
                s,
                &projection,
                tone,
            );
        }
        glass.keep_in_front_of(&raster);
        let mut page = Page::new(window);
        let traces = scene.traces.iter().map(|ends| ends.map(|p| projection.project(p)));
        let seen = traces.flat_map(|line| raster.split(line, DEPTH_TOLERANCE)[0].clone());
        page.segments(Stroke::dashed(QUIET, EDGE_WIDTH, "7 3 1.5 3"), seen);
        for look in [Look::Full, Look::Pale, Look::Moving] {
            self.draw_parts(&mut page, (scene, look), &raster, &projection);
        }
        self.draw_parts(&mut page, (scene, Look::Glass), &glass, &projection);
        for a in &scene.arrows {
            let [from, to] = [a.from, a.to].map(|p| projection.project(p).truncate());
            page.arrow(CONTACT, REPORT_ARROW_WIDTH, [from, to]);
        }
        let look = format!(r#"font-size="18" font-weight="600" fill="{CONTACT}""#);
        for a in scene.arrows.iter().filter(|a| !a.label.is_empty()) {
            let ends = [a.from, a.to].map(|p| projection.project(p).truncate());
            page.label(label_position(ends, &a.label, scene.size), &look, &a.label);
        }
        draw_numbers(&mut page, scene, &raster);
        let aside = if scene.numbers.is_empty() { 0.0 } else { 2.0 * NUMBER_INSET };
        if scene.size.x >= MIN_WIDTH_OF_AXES {
            draw_axes(&mut page, &projection.view, DVec2::new(36.0 + aside, scene.size.y - 36.0));
        }
        page.inline(scene.size, &scene.label)
    }

    /// Draws all parts of one style, each in a group of its own.
    fn draw_parts(
        &self,
        page: &mut Page,
        (scene, look): (&Scene, Look),
        raster: &Raster,
        projection: &Projection,
    ) {
        let tiles = raster.tiles();
        for (k, s) in scene.shown.iter().enumerate().filter(|(_, s)| s.look == look) {
            let class = match look {
                Look::Full => "full",
                Look::Moving => "moving",
                Look::Pale => "pale",
                Look::Glass => "glass",
            };
            let own = tiles.iter().enumerate().skip(k * SHADES).take(SHADES);
            let mut own = own.filter(|(_, tiles)| !tiles.is_empty()).peekable();
            if own.peek().is_none() {
                continue;
            }
            page.open_group(&format!(r#"class="{class}" data-part="{}""#, s.part));
            if look == Look::Glass {
                let all: Vec<[usize; 4]> =
                    own.flat_map(|(_, tiles)| tiles.iter().copied()).collect();
                page.tiles(r##"fill="#6f8fb5" fill-opacity="0.13""##, &all);
            } else {
                for (tone, tiles) in own {
                    let colour = self.shade_colour(s, tone % SHADES);
                    // A thin outline in the same colour hides the seams between tiles.
                    let look = format!(r#"fill="{colour}" stroke="{colour}" stroke-width="0.3""#);
                    page.tiles(&look, tiles);
                }
            }
            let ends = |edge: [DVec3; 2]| edge.map(|p| projection.project(p + s.by));
            let lines = self.lines[s.part]
                .visible_lines(self.parts[s.part].solid(), projection.view.toward);
            let colour = match look {
                Look::Full | Look::Moving => INK,
                Look::Pale => "#9a9a9a",
                Look::Glass => "#8fa0b4",
            };
            let seen = lines.into_iter().map(ends).flat_map(|line| {
                let [seen, _] = raster.split(line, DEPTH_TOLERANCE);
                seen
            });
            page.segments(Stroke::solid(colour, FINE_WIDTH), seen);
            page.close_group();
        }
    }

    /// Returns the colour of a part in a shade, in HTML notation.
    fn shade_colour(&self, s: &Shown, shade: usize) -> String {
        let light = 0.55 + 0.5 * shade as f64 / (SHADES - 1) as f64;
        let mix =
            |c: f64| if s.look == Look::Pale { 0.2 * c + 0.8 * (0.82 + 0.12 * light) } else { c };
        html_colour(self.colours[s.part].map(|c| mix((c * light).min(1.0))))
    }

    /// Returns the colour of a part.
    pub(super) fn own_colour(&self, part: usize) -> [f64; 3] {
        self.colours[part]
    }
}

/// Width of a letter of a label in pixels.
const LETTER_WIDTH: f64 = 10.8;

/// Counts the visible samples of each part.
fn sample_counts(raster: &Raster) -> BTreeMap<usize, usize> {
    let mut counts = BTreeMap::new();
    for part in raster.samples().filter_map(|(_, part)| part) {
        *counts.entry(part as usize).or_default() += 1;
    }
    counts
}

/// Returns the position of an arrow's label: beyond its tip, within the page.
fn label_position([from, to]: [DVec2; 2], label: &str, size: DVec2) -> DVec2 {
    let along = (to - from).normalize_or(DVec2::NEG_Y);
    let room = DVec2::new(LETTER_WIDTH * label.chars().count() as f64 / 2.0 + 4.0, 14.0);
    (to + along * (4.0 + (along * room).abs().element_sum())).clamp(room, size - room)
}

/// Draws the axes of the world around a point of the page.
fn draw_axes(page: &mut Page, view: &View, origin: DVec2) {
    for (axis, name) in DVec3::AXES.into_iter().zip(["x", "y", "z"]) {
        let along = view.project(axis) * DVec2::new(1.0, -1.0);
        let line = format!(r#"stroke="{QUIET}" stroke-width="{GUIDE_WIDTH}""#);
        page.lines(&line, [[origin, origin + along * 20.0]]);
        let look = format!(r#"font-size="11" fill="{QUIET}""#);
        let at = origin + along * 20.0 + along.normalize_or_zero() * 7.0;
        page.text(at + DVec2::new(0.0, 4.0), "middle", &look, name);
    }
}

/// Draws the numbers of parts at both sides of the page, each with a line to a visible sample of its part.
fn draw_numbers(page: &mut Page, scene: &Scene, raster: &Raster) {
    let mut middles = BTreeMap::<usize, (usize, DVec2)>::new();
    let part = |tone: u32| scene.shown[tone as usize / SHADES].part;
    for (at, tone) in raster.samples() {
        if let Some(tone) = tone {
            let (count, sum) = middles.entry(part(tone)).or_default();
            *count += 1;
            *sum += at;
        }
    }
    // For each part, the sample nearest to the mean of its samples.
    let mut anchors = BTreeMap::<usize, DVec2>::new();
    for (at, tone) in raster.samples() {
        let Some(part) = tone.map(part) else { continue };
        let (count, sum) = middles[&part];
        let middle = sum / count as f64;
        let anchor = anchors.entry(part).or_insert(at);
        if at.distance_squared(middle) < anchor.distance_squared(middle) {
            *anchor = at;
        }
    }
    let anchored = scene.numbers.iter().filter_map(|(number, parts)| {
        let visible = |part: &&usize| middles.get(part).map_or(0, |middle| middle.0);
        let best = parts.iter().max_by_key(visible).filter(|part| visible(part) > 0)?;
        Some((*number, anchors[best]))
    });
    let mut all: Vec<(usize, DVec2)> = anchored.collect();
    all.sort_by(|a, b| a.1.x.total_cmp(&b.1.x));
    let right = all.split_off(all.len() / 2);
    for (column, x) in [(all, NUMBER_INSET), (right, scene.size.x - NUMBER_INSET)] {
        draw_number_column(page, column, x, scene.size.y);
    }
}

/// Draws a column of numbers, each as near to the height of its part as the others permit.
fn draw_number_column(page: &mut Page, mut column: Vec<(usize, DVec2)>, x: f64, height: f64) {
    column.sort_by(|a, b| a.1.y.total_cmp(&b.1.y));
    let pitch = (height / column.len().max(1) as f64).min(40.0);
    let radius = (0.46 * pitch).min(15.0);
    let mut y = f64::NEG_INFINITY;
    for (k, (number, anchor)) in column.iter().enumerate() {
        let below = (column.len() - k) as f64 * pitch;
        y = anchor.y.max(y + pitch).max(0.5 * pitch).min(height - below + 0.5 * pitch);
        let at = DVec2::new(x, y);
        let line = format!(r#"stroke="{QUIET}" stroke-width="{FINE_WIDTH}""#);
        page.lines(&line, [[at, *anchor]]);
        page.dot(*anchor, 1.8, INK, "#ffffff");
        page.dot(at, radius, "#ffffff", INK);
        let size = if number > &99 { 0.95 } else { 1.15 } * radius;
        let look = format!(r#"font-size="{size:.1}" fill="{INK}""#);
        page.text(at + DVec2::new(0.0, 0.4 * size), "middle", &look, &number.to_string());
    }
}
