//! Pictures of parts: shaded areas and visible edges, as SVG.
//!
//! Parallel projection. Areas are tiles of a raster of depths, edges what of them the raster does not
//! hide ([`colltrans_picture`]). So a picture's size grows with its pixels and lines, not with the
//! facets. Whatever is looked for, which view shows what moves, and what hides it, is asked of the same rasters.

use std::collections::BTreeMap;

use colltrans_picture::{Frame, Page, Raster, Stroke, View};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::lines::Lines;
use super::{Findings, hexadecimal, kinds};
use crate::part::Part;

/// How a part is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Look {
    /// In its colour.
    Full,
    /// In its colour, as what moves.
    Moving,
    /// Pale, as what stays.
    Pale,
    /// As glass, since it would hide what moves.
    Glass,
}

/// A part and where it is drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shown {
    /// Its position in the assembly.
    pub part: usize,
    /// How far it is displaced from its place.
    pub by: DVec3,
    /// How it is drawn.
    pub look: Look,
}

/// An arrow in the world.
#[derive(Debug, Clone)]
pub(super) struct Arrow {
    /// Where it begins.
    pub from: DVec3,
    /// Where it ends.
    pub to: DVec3,
    /// What is written beside its tip.
    pub label: String,
}

/// What a picture shows.
pub(super) struct Scene {
    /// In pixels.
    pub size: DVec2,
    pub shown: Vec<Shown>,
    pub arrows: Vec<Arrow>,
    /// Lines along which parts were moved.
    pub traces: Vec<[DVec3; 2]>,
    /// Numbers of kinds of parts, each at one of these parts.
    pub numbers: Vec<(usize, Vec<usize>)>,
    /// What is told to who does not see it.
    pub label: String,
}

/// The assembly, made ready to be drawn often.
pub(super) struct Studio<'a> {
    parts: &'a [Part],
    lines: Vec<Lines>,
    colours: Vec<[f64; 3]>,
    up: DVec3,
}

/// A view, and how it is told from the ordinary one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Viewpoint {
    view: View,
    /// "from below", if it is not the ordinary one.
    pub name: &'static str,
}

const MARGIN: f64 = 14.0;
/// The room for numbers at either side.
const MARGIN_OF_NUMBERS: f64 = 60.0;
/// How far from its side of the page a number stands.
const FROM_SIDE: f64 = 19.0;
const SHADES: usize = 6;
/// Depths, in pixels, may be off by this much.
const SLACK: f64 = 1.5;
/// Pictures in which is counted what is seen are smaller by this factor.
const COARSE: f64 = 0.25;
/// What moves is seen well if so much of it is.
const WELL_SEEN: f64 = 0.5;
/// Parts are made glass in so many rounds at most.
const MOST_ROUNDS: usize = 16;
const ARROW: &str = "#c02020";

/// From where it is looked, by azimuth and height in degrees, the ordinary one first; and how good that is as such.
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

/// From the world to the page; fits all points.
struct Eye {
    view: View,
    scale: f64,
    offset: DVec2,
}

impl Eye {
    fn fitting(
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

    /// A point on the page, and how near it is, in pixels.
    fn see(&self, p: DVec3) -> DVec3 {
        let flat = self.view.project(p) * DVec2::new(1.0, -1.0) * self.scale + self.offset;
        flat.extend(p.dot(self.view.toward) * self.scale)
    }

    /// The same on a page that is smaller by a factor.
    fn smaller(&self, factor: f64) -> Self {
        Self { view: self.view, scale: self.scale * factor, offset: self.offset * factor }
    }
}

impl<'a> Studio<'a> {
    pub(super) fn new(f: &Findings<'a>) -> Self {
        let parts = f.bodies.assembly().parts();
        let lines = parts.par_iter().map(|part| Lines::new(part.solid())).collect();
        Self { parts, lines, colours: kinds::colours(&f.plan, parts), up: f.up }
    }

    /// The ordinary view.
    pub(super) fn front(&self) -> Viewpoint {
        self.viewpoints().next().expect("there are some")
    }

    fn viewpoints(&self) -> impl Iterator<Item = Viewpoint> + use<> {
        let up = self.up;
        let turn = glam::DQuat::from_rotation_arc(DVec3::Z, up);
        VIEWPOINTS.iter().map(move |&(azimuth, height, _, name)| {
            let (sin_a, cos_a) = f64::to_radians(azimuth).sin_cos();
            let (sin_h, cos_h) = f64::to_radians(height).sin_cos();
            let toward = turn * DVec3::new(cos_h * cos_a, cos_h * sin_a, sin_h);
            Viewpoint { view: View::upright(toward, up), name }
        })
    }

    fn eye(&self, scene: &Scene, view: View) -> Eye {
        let corners = scene.shown.iter().flat_map(|s| {
            let vertices = self.parts[s.part].solid().vertices().iter();
            vertices.map(move |v| *v + s.by)
        });
        let arrows = scene.arrows.iter().flat_map(|a| [a.from, a.to]);
        let aside = if scene.numbers.is_empty() { MARGIN } else { MARGIN_OF_NUMBERS };
        Eye::fitting(view, corners.chain(arrows), scene.size, DVec2::new(aside, MARGIN))
    }

    /// How high a picture of a scene is whose width is given, between two bounds.
    pub(super) fn height(&self, scene: &Scene, [least, most]: [f64; 2]) -> f64 {
        let eye = self.eye(scene, self.front().view);
        let corners = scene.shown.iter().flat_map(|s| {
            let vertices = self.parts[s.part].solid().vertices().iter();
            vertices.map(move |v| eye.view.project(*v + s.by))
        });
        let (low, high) = corners.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| {
            (low.min(p), high.max(p))
        });
        let span = high - low;
        let room = scene.size.x - 2.0 * MARGIN_OF_NUMBERS;
        (room * span.y / span.x.max(1e-12) + 2.0 * MARGIN).clamp(least, most)
    }

    /// The view from which most of each group is seen, after what hides them was made glass if it has to be.
    pub(super) fn arrange(&self, scene: &mut Scene, groups: &[Vec<usize>]) -> Viewpoint {
        let mut best = (f64::NEG_INFINITY, self.front());
        for (viewpoint, (_, _, price, _)) in self.viewpoints().zip(VIEWPOINTS) {
            let seen = self.least_seen(scene, viewpoint.view, groups);
            if seen - price > best.0 {
                best = (seen - price, viewpoint);
            }
            if best.0 >= WELL_SEEN {
                break;
            }
        }
        self.clear(scene, best.1.view, groups);
        best.1
    }

    /// How much of the group is seen of which least is, of what would be seen of it alone.
    fn least_seen(&self, scene: &Scene, view: View, groups: &[Vec<usize>]) -> f64 {
        let eye = self.eye(scene, view).smaller(COARSE);
        let all = count(&self.coarse(scene, &eye, |s| s.look != Look::Glass));
        let share = |group: &Vec<usize>| {
            let alone = count(&self.coarse(scene, &eye, |s| group.contains(&s.part)));
            let [seen, whole] = [&all, &alone]
                .map(|counts| group.iter().filter_map(|part| counts.get(part)).sum::<usize>());
            seen as f64 / whole.max(1) as f64
        };
        groups.par_iter().map(share).reduce(|| 1.0, f64::min)
    }

    /// Makes glass of what hides a group, those first that hide most, until each group is seen well.
    fn clear(&self, scene: &mut Scene, view: View, groups: &[Vec<usize>]) {
        let eye = self.eye(scene, view).smaller(COARSE);
        for _ in 0..MOST_ROUNDS {
            if self.least_seen(scene, view, groups) >= WELL_SEEN {
                break;
            }
            let all = self.coarse(scene, &eye, |s| s.look != Look::Glass);
            let moving = self.coarse(scene, &eye, |s| s.look == Look::Moving);
            let mut hides = BTreeMap::<usize, usize>::new();
            for ((_, front), (_, behind)) in all.samples().zip(moving.samples()) {
                if let (Some(front), Some(_)) = (front, behind) {
                    *hides.entry(front as usize).or_default() += 1;
                }
            }
            let stays = |s: &&Shown| s.look == Look::Pale && hides.contains_key(&s.part);
            let most = scene.shown.iter().filter(stays).max_by_key(|s| (hides[&s.part], s.part));
            let Some(part) = most.map(|s| s.part) else { break };
            for s in scene.shown.iter_mut().filter(|s| s.part == part) {
                s.look = Look::Glass;
            }
        }
    }

    /// Parts by their positions, on a small page.
    fn coarse(&self, scene: &Scene, eye: &Eye, drawn: impl Fn(&Shown) -> bool) -> Raster {
        let high = (scene.size * COARSE).ceil();
        let mut raster = Raster::new(Frame { low: DVec2::ZERO, high });
        for s in scene.shown.iter().filter(|s| drawn(s)) {
            self.rasterise(&mut raster, s, eye, |_| s.part as u32);
        }
        raster
    }

    /// Facets that look towards the viewer, and those of surfaces also from behind; of each its tone by its brightness.
    fn rasterise(&self, raster: &mut Raster, s: &Shown, eye: &Eye, tone: impl Fn(f64) -> u32) {
        let solid = self.parts[s.part].solid();
        for t in solid.triangles() {
            let corners = t.map(|v| solid.vertices()[v as usize] + s.by);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let normal = normal.normalize_or_zero();
            let facing = normal.dot(eye.view.toward);
            if solid.is_closed() && facing <= 0.0 {
                continue;
            }
            let lit = eye.view.brightness(normal * facing.signum());
            raster.draw(corners.map(|c| eye.see(c)), tone(lit));
        }
    }

    /// The picture of a scene.
    pub(super) fn picture(&self, scene: &Scene, viewpoint: Viewpoint) -> String {
        let eye = self.eye(scene, viewpoint.view);
        let window = Frame { low: DVec2::ZERO, high: scene.size };
        let (mut raster, mut glass) = (Raster::new(window), Raster::new(window));
        for (k, s) in scene.shown.iter().enumerate() {
            // What stays has half of the shades: its picture has half of the tiles.
            let step = if s.look == Look::Pale { 2 } else { 1 };
            let shade = |lit: f64| (lit * (SHADES as f64 - 0.01)) as usize / step * step;
            let tone = |lit| (k * SHADES + shade(lit)) as u32;
            self.rasterise(
                if s.look == Look::Glass { &mut glass } else { &mut raster },
                s,
                &eye,
                tone,
            );
        }
        glass.keep_before(&raster);
        let mut page = Page::new(window);
        let traces = scene.traces.iter().map(|ends| ends.map(|p| eye.see(p)));
        let seen = traces.flat_map(|line| raster.split(line, SLACK)[0].clone());
        page.segments(Stroke::dashed("#7a8896", 0.9, "7 3 1.5 3"), seen);
        for look in [Look::Full, Look::Pale, Look::Moving] {
            self.group(&mut page, (scene, look), &raster, &eye);
        }
        self.group(&mut page, (scene, Look::Glass), &glass, &eye);
        for a in &scene.arrows {
            let [from, to] = [a.from, a.to].map(|p| eye.see(p).truncate());
            page.arrow(ARROW, 2.5, [from, to]);
        }
        for a in scene.arrows.iter().filter(|a| !a.label.is_empty()) {
            let ends = [a.from, a.to].map(|p| eye.see(p).truncate());
            page.label(beyond(ends, &a.label, scene.size), LABEL, &a.label);
        }
        balloons(&mut page, scene, &raster);
        let aside = if scene.numbers.is_empty() { 0.0 } else { 2.0 * FROM_SIDE };
        triad(&mut page, &eye.view, DVec2::new(36.0 + aside, scene.size.y - 36.0));
        page.inline(scene.size, &scene.label)
    }

    /// All parts of one look: each of what moves in a group of its own.
    fn group(&self, page: &mut Page, (scene, look): (&Scene, Look), raster: &Raster, eye: &Eye) {
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
                    let colour = self.colour(s, tone % SHADES);
                    // A thin rim of its own colour hides the seams between tiles.
                    let look = format!(r#"fill="{colour}" stroke="{colour}" stroke-width="0.3""#);
                    page.tiles(&look, tiles);
                }
            }
            let ends = |edge: [DVec3; 2]| edge.map(|p| eye.see(p + s.by));
            let lines = self.lines[s.part].seen(self.parts[s.part].solid(), eye.view.toward);
            let colour = match look {
                Look::Full | Look::Moving => "#222222",
                Look::Pale => "#9a9a9a",
                Look::Glass => "#8fa0b4",
            };
            let seen = lines.into_iter().map(ends).flat_map(|line| {
                let [seen, _] = raster.split(line, SLACK);
                seen
            });
            page.segments(Stroke::solid(colour, 0.7), seen);
            page.close_group();
        }
    }

    fn colour(&self, s: &Shown, shade: usize) -> String {
        let light = 0.55 + 0.5 * shade as f64 / (SHADES - 1) as f64;
        let mix =
            |c: f64| if s.look == Look::Pale { 0.2 * c + 0.8 * (0.82 + 0.12 * light) } else { c };
        hexadecimal(self.colours[s.part].map(|c| mix((c * light).min(1.0))))
    }

    /// The colour of a part.
    pub(super) fn own_colour(&self, part: usize) -> [f64; 3] {
        self.colours[part]
    }
}

const LABEL: &str =
    r##"font-family="system-ui,sans-serif" font-size="18" font-weight="600" fill="#a01515""##;

/// How wide a letter of it is, in pixels.
const LETTER: f64 = 10.8;

/// How many samples are seen of each part.
fn count(raster: &Raster) -> BTreeMap<usize, usize> {
    let mut counts = BTreeMap::new();
    for part in raster.samples().filter_map(|(_, part)| part) {
        *counts.entry(part as usize).or_default() += 1;
    }
    counts
}

/// Where the label of an arrow stands: beyond its tip, on the page.
fn beyond([from, to]: [DVec2; 2], label: &str, size: DVec2) -> DVec2 {
    let along = (to - from).normalize_or(DVec2::NEG_Y);
    let room = DVec2::new(LETTER * label.chars().count() as f64 / 2.0 + 4.0, 14.0);
    (to + along * (4.0 + (along * room).abs().element_sum())).clamp(room, size - room)
}

/// The axes of the world, around a point of the page.
fn triad(page: &mut Page, view: &View, origin: DVec2) {
    for (axis, name) in DVec3::AXES.into_iter().zip(["x", "y", "z"]) {
        let along = view.project(axis) * DVec2::new(1.0, -1.0);
        page.lines(r##"stroke="#6b7785" stroke-width="1.2""##, [[origin, origin + along * 20.0]]);
        let look = r##"font-family="system-ui,sans-serif" font-size="11" fill="#6b7785""##;
        let at = origin + along * 20.0 + along.normalize_or_zero() * 7.0;
        page.text(at + DVec2::new(0.0, 4.0), "middle", look, name);
    }
}

/// Numbers of parts at both sides of the page, each with a line to where most of its part is seen.
fn balloons(page: &mut Page, scene: &Scene, raster: &Raster) {
    let mut middles = BTreeMap::<usize, (usize, DVec2)>::new();
    let part = |tone: u32| scene.shown[tone as usize / SHADES].part;
    for (at, tone) in raster.samples() {
        if let Some(tone) = tone {
            let (count, sum) = middles.entry(part(tone)).or_default();
            *count += 1;
            *sum += at;
        }
    }
    // The sample of each part that is nearest to the middle of all.
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
        let seen = |part: &&usize| middles.get(part).map_or(0, |middle| middle.0);
        let best = parts.iter().max_by_key(seen).filter(|part| seen(part) > 0)?;
        Some((*number, anchors[best]))
    });
    let mut all: Vec<(usize, DVec2)> = anchored.collect();
    all.sort_by(|a, b| a.1.x.total_cmp(&b.1.x));
    let right = all.split_off(all.len() / 2);
    for (column, x) in [(all, FROM_SIDE), (right, scene.size.x - FROM_SIDE)] {
        column_of(page, column, x, scene.size.y);
    }
}

/// Balloons one below the other, as near to the heights of what they are of as they have room.
fn column_of(page: &mut Page, mut column: Vec<(usize, DVec2)>, x: f64, height: f64) {
    column.sort_by(|a, b| a.1.y.total_cmp(&b.1.y));
    let pitch = (height / column.len().max(1) as f64).min(40.0);
    let radius = (0.46 * pitch).min(15.0);
    let mut y = f64::NEG_INFINITY;
    for (k, (number, anchor)) in column.iter().enumerate() {
        let below = (column.len() - k) as f64 * pitch;
        y = anchor.y.max(y + pitch).max(0.5 * pitch).min(height - below + 0.5 * pitch);
        let at = DVec2::new(x, y);
        page.lines(r##"stroke="#445" stroke-width="0.7""##, [[at, *anchor]]);
        page.dot(*anchor, 1.8, "#334", "#ffffff");
        page.dot(at, radius, "#ffffff", "#334");
        let size = if number > &99 { 0.95 } else { 1.15 } * radius;
        let look =
            format!(r##"font-family="system-ui,sans-serif" font-size="{size:.1}" fill="#112""##);
        page.text(at + DVec2::new(0.0, 0.4 * size), "middle", &look, &number.to_string());
    }
}
