//! Removal maps as pictures, in the Mollweide projection.
//!
//! The projection preserves areas. The poles `+z` and `-z` are at the top and bottom, `+x` is in the middle. Free
//! directions are drawn from the cover, with exact borders, if it exists.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Write;

use colltrans_picture::{FINE_WIDTH, FONT, INK, QUIET, escape_xml};
use glam::{DVec2, DVec3};

use super::outline::{arc_lines, is_inside, polygon_outlines};
use super::{Cover, RemovalMap};
use crate::travel::PartTravel;

/// Colours of blocked directions, from short travel to long.
const BLOCKED: [[u8; 3]; 8] = [
    [22, 32, 72],
    [30, 55, 110],
    [40, 82, 148],
    [58, 110, 178],
    [90, 141, 200],
    [128, 172, 217],
    [170, 202, 231],
    [211, 228, 243],
];
const FREE: [u8; 3] = [246, 150, 40];
const BORDER: [u8; 3] = [140, 70, 0];
const UNKNOWN: [u8; 3] = [120, 120, 120];
const OVERLAP: [u8; 3] = [150, 60, 60];

/// Returns the direction at a point of the map, an ellipse of semi-axes 2 and 1. Returns `None` outside.
fn direction_at(at: DVec2) -> Option<DVec3> {
    if at.x * at.x / 4.0 + at.y * at.y >= 1.0 {
        return None;
    }
    let theta = at.y.asin();
    let latitude = ((2.0 * theta + (2.0 * theta).sin()) / PI).asin();
    let longitude = PI * at.x / (2.0 * theta.cos());
    let (s, c) = longitude.sin_cos();
    Some(DVec3::new(c * latitude.cos(), s * latitude.cos(), latitude.sin()))
}

/// Returns the point of a direction on the map.
pub(super) fn map_position(d: DVec3) -> DVec2 {
    let latitude = d.z.clamp(-1.0, 1.0).asin();
    let longitude = d.y.atan2(d.x);
    let mut theta = latitude;
    // Newton's method. At the poles the equation has zero slope, and its solution is the latitude.
    for _ in 0..32 {
        let slope = 2.0 + 2.0 * (2.0 * theta).cos();
        if slope < 1e-9 {
            break;
        }
        theta -= (2.0 * theta + (2.0 * theta).sin() - PI * latitude.sin()) / slope;
    }
    let theta = theta.clamp(-FRAC_PI_2, FRAC_PI_2);
    DVec2::new(2.0 * longitude / PI * theta.cos(), theta.sin())
}

impl RemovalMap {
    /// Returns the class of a direction: 0 to 7 blocked, 8 free, 9 overlapping.
    fn direction_class(&self, d: DVec3) -> usize {
        let (t, weights) = self.sphere.locate(d);
        let corners = self.sphere.triangles[t].corners;
        // Free regions of a cover are drawn over this, so the nearest blocked corner decides.
        let hidden = |k: &usize| self.cover.is_ok() && self.travels[corners[*k] as usize].is_free();
        let weight = |k: usize| if hidden(&k) { -1.0 } else { weights[k] };
        let nearest = (1..3).fold(0, |best, k| if weight(k) > weight(best) { k } else { best });
        match self.travels[corners[nearest] as usize] {
            PartTravel::Free if self.cover.is_ok() => BLOCKED.len() - 1,
            PartTravel::Free => 8,
            PartTravel::Overlapping { .. } => 9,
            PartTravel::Blocked { stop, .. } => distance_class(stop.distance() / self.size),
        }
    }
}

/// Returns one of eight classes of distance. Each spans a factor of two, and the last one starts at half the size.
fn distance_class(share: f64) -> usize {
    (8.0 + share.max(1e-9).log2()).floor().clamp(0.0, 7.0) as usize
}

fn class_color(class: usize) -> [u8; 3] {
    match class {
        8 => FREE,
        9 => OVERLAP,
        k => BLOCKED[k],
    }
}

fn hex_color([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Renders the map as a PNG picture of `width` by `width / 2` pixels, transparent outside of the map.
///
/// Isolated directions are white discs with a dark edge. A `width` below 16 is replaced by 16.
pub fn render_png(map: &RemovalMap, width: u32) -> Vec<u8> {
    let (width, height) = (width.max(16), width.max(16) / 2);
    let mut pixels = vec![0_u8; (width * height * 4) as usize];
    let marks: Vec<DVec2> = map.isolated.iter().map(|d| map_position(*d)).collect();
    let over = map
        .cover
        .as_ref()
        .map_or_else(|_| Vec::new(), |cover| cover_pixels(cover, [width, height]));
    for row in 0..height {
        for column in 0..width {
            let at = DVec2::new(
                (f64::from(column) + 0.5) / f64::from(width) * 4.0 - 2.0,
                1.0 - (f64::from(row) + 0.5) / f64::from(height) * 2.0,
            );
            let Some(d) = direction_at(at) else { continue };
            let near = marks.iter().map(|m| m.distance(at)).fold(f64::INFINITY, f64::min);
            let rgb = match near {
                r if r < 0.02 => [255, 255, 255],
                r if r < 0.03 => [20, 20, 20],
                _ => {
                    let known = over.get((row * width + column) as usize).copied().flatten();
                    known.unwrap_or_else(|| class_color(map.direction_class(d)))
                }
            };
            let first = ((row * width + column) * 4) as usize;
            pixels[first..first + 3].copy_from_slice(&rgb);
            pixels[first + 3] = 255;
        }
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    // Writing to memory fails only if the sizes do not match, and they match.
    if let Ok(mut writer) = encoder.write_header() {
        let _ = writer.write_image_data(&pixels);
    }
    bytes
}

/// Half of the width of arcs in a picture with semi-axes 2 and 1.
const HALF_ARC_WIDTH: f64 = 0.009;

/// Returns the colour of the cover at each pixel: free, or undecided (striped), or `None`.
fn cover_pixels(cover: &Cover, [width, height]: [u32; 2]) -> Vec<Option<[u8; 3]>> {
    let mut pixels = vec![None; (width * height) as usize];
    let scale = f64::from(width) / 4.0;
    let mut fill = |outlines: &[Vec<DVec2>], paint: &dyn Fn(u32) -> Option<[u8; 3]>| {
        for outline in outlines {
            let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
            let around = |(low, high): (DVec2, DVec2), p: &DVec2| (low.min(*p), high.max(*p));
            let (low, high) = outline.iter().fold(start, around);
            let [first, last] = [(low.x + 2.0) * scale, (high.x + 2.0) * scale];
            let [top, bottom] = [(1.0 - high.y) * scale, (1.0 - low.y) * scale];
            for row in top.max(0.0) as u32..(bottom.ceil() as u32).min(height) {
                for column in first.max(0.0) as u32..(last.ceil() as u32).min(width) {
                    let at = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5) / scale;
                    if is_inside(outline, DVec2::new(at.x - 2.0, 1.0 - at.y)) {
                        let pixel = &mut pixels[(row * width + column) as usize];
                        *pixel = paint(row + column).or(*pixel);
                    }
                }
            }
        }
    };
    for region in &cover.regions {
        region
            .pieces
            .iter()
            .for_each(|piece| fill(&polygon_outlines(&piece.corners), &|_| Some(FREE)));
    }
    for &[a, b] in &cover.arcs {
        for ends in arc_lines(a, b).iter().flat_map(|part| part.windows(2)) {
            let across = (ends[1] - ends[0]).normalize_or_zero().perp() * HALF_ARC_WIDTH;
            let strip = [ends[0] - across, ends[1] - across, ends[1] + across, ends[0] + across];
            fill(&[strip.to_vec()], &|_| Some(FREE));
        }
    }
    for cell in &cover.undecided {
        fill(&polygon_outlines(cell), &|at| (at % 8 < 4).then_some(UNKNOWN));
    }
    pixels
}

/// Number of cells of the map in each direction.
const COLUMNS: usize = 480;
const ROWS: usize = 240;
/// Scale of the map in the picture, and its centre.
const SCALE: f64 = 170.0;
const MIDDLE: DVec2 = DVec2::new(360.0, 190.0);

/// Renders the map as an SVG picture with axes, marks and a legend.
pub fn render_svg(map: &RemovalMap, title: &str) -> String {
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 -14 720 470\" \
         font-family=\"{FONT}\" fill=\"{INK}\" font-size=\"13\">\n<rect y=\"-14\" width=\"720\" height=\"470\" \
         fill=\"#fff\"/>\n",
    );
    for (class, path) in
        class_runs(map).into_iter().enumerate().filter(|(_, path)| !path.is_empty())
    {
        let _ = writeln!(text, "<path fill=\"{}\" d=\"{path}\"/>", hex_color(class_color(class)));
    }
    if let Ok(cover) = &map.cover {
        draw_cover(&mut text, cover);
    }
    let _ = writeln!(
        text,
        "<ellipse cx=\"{}\" cy=\"{}\" rx=\"{}\" ry=\"{SCALE}\" fill=\"none\" stroke=\"{INK}\"/>",
        MIDDLE.x,
        MIDDLE.y,
        2.0 * SCALE
    );
    draw_graticule(&mut text);
    let dots: Vec<DVec2> =
        map.isolated.iter().map(|d| picture_position(map_position(*d))).collect();
    draw_axis_names(&mut text, &dots);
    for at in &dots {
        let _ = writeln!(
            text,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"5\" fill=\"#fff\" stroke=\"{INK}\" \
             stroke-width=\"2\"/>",
            at.x, at.y
        );
    }
    draw_legend(&mut text, map);
    let _ = writeln!(
        text,
        "<text x=\"360\" y=\"4\" text-anchor=\"middle\" font-weight=\"bold\">{}</text>\n</svg>",
        escape_xml(title)
    );
    text
}

/// Returns the SVG path of closed or open lines.
fn path_data(parts: &[Vec<DVec2>], close: bool) -> String {
    let mut path = String::new();
    for part in parts {
        for (k, at) in part.iter().map(|at| picture_position(*at)).enumerate() {
            let _ = write!(path, "{}{:.2} {:.2}", if k == 0 { "M" } else { "L" }, at.x, at.y);
        }
        path += if close { "z" } else { "" };
    }
    path
}

/// Draws a cover: regions with their borders and centres, arcs, and undecided cells (hatched).
fn draw_cover(text: &mut String, cover: &Cover) {
    let rgb = hex_color(FREE);
    for region in &cover.regions {
        let pieces: String = region
            .pieces
            .iter()
            .map(|piece| path_data(&polygon_outlines(&piece.corners), true))
            .collect();
        let border: String =
            region.border.iter().map(|[a, b]| path_data(&arc_lines(*a, *b), false)).collect();
        let _ = writeln!(
            text,
            "<path fill=\"{rgb}\" stroke=\"{rgb}\" stroke-width=\"0.4\" d=\"{pieces}\"/>\n\
             <path fill=\"none\" stroke=\"{}\" d=\"{border}\"/>",
            hex_color(BORDER)
        );
    }
    let alone: String =
        cover.arcs.iter().map(|[a, b]| path_data(&arc_lines(*a, *b), false)).collect();
    if !alone.is_empty() {
        let _ = writeln!(
            text,
            "<path fill=\"none\" stroke=\"{rgb}\" stroke-width=\"3\" d=\"{alone}\"/>"
        );
    }
    let unknown: String =
        cover.undecided.iter().map(|cell| path_data(&polygon_outlines(cell), true)).collect();
    if !unknown.is_empty() {
        text.push_str(HATCH);
        let _ = writeln!(text, "<path fill=\"url(#unknown)\" d=\"{unknown}\"/>");
    }
    let cross = |at: DVec2| {
        let (x, y) = (at.x, at.y);
        format!("M{:.1} {y:.1}h8M{x:.1} {:.1}v8", x - 4.0, y - 4.0)
    };
    let centers: String = cover
        .regions
        .iter()
        .map(|region| cross(picture_position(map_position(region.center))))
        .collect();
    if !centers.is_empty() {
        let _ = writeln!(text, "<path fill=\"none\" stroke=\"{INK}\" d=\"{centers}\"/>");
    }
}

const HATCH: &str = "<defs><pattern id=\"unknown\" width=\"5\" height=\"5\" \
     patternUnits=\"userSpaceOnUse\" patternTransform=\"rotate(45)\">\
     <rect width=\"2.5\" height=\"5\" fill=\"#787878\"/></pattern></defs>\n";

fn picture_position(at: DVec2) -> DVec2 {
    MIDDLE + DVec2::new(at.x, -at.y) * SCALE
}

/// Returns for each class the SVG path of its cells, as runs along rows.
fn class_runs(map: &RemovalMap) -> Vec<String> {
    let mut paths = vec![String::new(); 10];
    let (w, h) = (4.0 * SCALE / COLUMNS as f64, 2.0 * SCALE / ROWS as f64);
    for row in 0..ROWS {
        let y = 1.0 - (row as f64 + 0.5) / ROWS as f64 * 2.0;
        let class = |column: usize| {
            let x = (column as f64 + 0.5) / COLUMNS as f64 * 4.0 - 2.0;
            direction_at(DVec2::new(x, y)).map(|d| map.direction_class(d))
        };
        let classes: Vec<Option<usize>> = (0..COLUMNS).map(class).collect();
        let mut from = 0;
        while from < COLUMNS {
            let to = (from..COLUMNS).find(|&k| classes[k] != classes[from]).unwrap_or(COLUMNS);
            if let Some(class) = classes[from] {
                let (x, y) =
                    (MIDDLE.x - 2.0 * SCALE + from as f64 * w, MIDDLE.y - SCALE + row as f64 * h);
                let (width, height) = ((to - from) as f64 * w + 0.1, h + 0.1);
                let _ = write!(paths[class], "M{x:.1} {y:.1}h{width:.1}v{height:.1}h-{width:.1}z");
            }
            from = to;
        }
    }
    paths
}

/// Draws meridians and parallels every 30 degrees.
fn draw_graticule(text: &mut String) {
    let line = |points: Vec<DVec3>| {
        let mut path = String::new();
        for (k, d) in points.into_iter().enumerate() {
            let at = picture_position(map_position(d));
            let _ = write!(path, "{}{:.1} {:.1}", if k == 0 { "M" } else { "L" }, at.x, at.y);
        }
        path
    };
    let at = |longitude: f64, latitude: f64| {
        let (s, c) = longitude.to_radians().sin_cos();
        let (z, r) = latitude.to_radians().sin_cos();
        DVec3::new(r * c, r * s, z)
    };
    let mut path = String::new();
    for k in -2..=2 {
        let latitude = f64::from(k) * 30.0;
        path += &line((-60..=60).map(|j| at(f64::from(j) * 2.999, latitude)).collect());
    }
    for k in -5..=5 {
        let longitude = f64::from(k) * 30.0;
        path += &line((-44..=44).map(|j| at(longitude, f64::from(j) * 2.0)).collect());
    }
    let _ = writeln!(
        text,
        "<path d=\"{path}\" fill=\"none\" stroke=\"{QUIET}\" stroke-opacity=\"0.45\" \
         stroke-width=\"{FINE_WIDTH}\"/>"
    );
}

/// Draws the names of the axes, next to dots that they would hide.
fn draw_axis_names(text: &mut String, dots: &[DVec2]) {
    let names = [
        (DVec3::X, "+x"),
        (DVec3::Y, "+y"),
        (DVec3::NEG_Y, "−y"),
        (DVec3::Z, "+z"),
        (DVec3::NEG_Z, "−z"),
    ];
    let mut label = |at: DVec2, name: &str| {
        let hidden = dots.iter().any(|dot| dot.distance(at) < 14.0);
        let at = if hidden { at + DVec2::Y * 16.0 } else { at };
        let _ = writeln!(
            text,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"{INK}\" stroke=\"#fff\" \
             stroke-width=\"3\" paint-order=\"stroke\">{name}</text>",
            at.x,
            at.y + 4.0
        );
    };
    for (d, name) in names {
        // Names of the poles are moved inside.
        label(picture_position(map_position(d)) + DVec2::Y * 12.0 * d.z, name);
    }
    label(picture_position(DVec2::new(-2.0, 0.0)), "−x");
    label(picture_position(DVec2::new(2.0, 0.0)), "−x");
}

fn draw_legend(text: &mut String, map: &RemovalMap) {
    let mut x = 40.0;
    let mut entry = |class: usize, name: &str, width: f64| {
        let _ = writeln!(
            text,
            "<rect x=\"{x}\" y=\"388\" width=\"22\" height=\"14\" fill=\"{}\" stroke=\"{INK}\" \
             stroke-width=\"{FINE_WIDTH}\"/><text x=\"{x}\" y=\"418\" font-size=\"11\">{name}</text>",
            hex_color(class_color(class))
        );
        x += width;
    };
    entry(8, "free", 60.0);
    for k in 0..8 {
        let from = map.size * 2.0_f64.powi(k - 8);
        let name = if k == 0 { "0".to_owned() } else { format_three_digits(from) };
        entry(k as usize, &name, 58.0);
    }
    entry(9, "overlapping", 60.0);
    let summary = match &map.cover {
        Ok(cover) => format!(
            "free: {} % of all directions, exactly. {}",
            format_percent(cover.free_share()),
            match cover.undecided_share() {
                0.0 => "Nothing is undecided".to_owned(),
                share => format!("Undecided, hatched: {} %", format_percent(share)),
            }
        ),
        Err(_) => "free: as sampled, without a proof".to_owned(),
    };
    let cross = map.cover.is_ok() && !map.regions.is_empty();
    let marks = [
        (cross, "A cross is the direction farthest from the border"),
        (
            !map.isolated.is_empty(),
            "A dot is an isolated free direction, or a region too small to be drawn",
        ),
    ];
    let marks: Vec<&str> = marks.into_iter().filter(|mark| mark.0).map(|mark| mark.1).collect();
    let _ = writeln!(
        text,
        "<g font-size=\"11\" fill=\"{QUIET}\"><text x=\"40\" y=\"434\">blocked after, from</text>\n\
         <g text-anchor=\"end\"><text x=\"680\" y=\"434\">{summary}</text>\n\
         <text x=\"680\" y=\"449\">{}</text></g></g>",
        marks.join(". ")
    );
}

/// Formats a fraction as a percentage; small ones with an exponent.
fn format_percent(share: f64) -> String {
    let x = 100.0 * share;
    match x {
        0.0 => "0".to_owned(),
        x if x < 1e-3 => format!("{x:.2e}"),
        x => format_three_digits(x),
    }
}

/// Formats a number with three significant digits.
fn format_three_digits(x: f64) -> String {
    let digits = (2 - x.abs().max(1e-12).log10().floor() as i32).max(0) as usize;
    format!("{x:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn map_position_and_direction_are_inverse() {
        let mut random = colltrans_testkit::random::Random::new(2);
        for _ in 0..1_000 {
            let d = random.direction();
            let back = direction_at(map_position(d)).expect("inside");
            assert!((back - d).length() < 1e-6, "{d} {back}");
        }
    }
}
