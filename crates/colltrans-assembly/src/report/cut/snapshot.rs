//! A picture of what is behind a section plane, with the material in the plane, as PNG.
//!
//! - Facets are drawn into a depth raster, without their parts in front of the plane. Edges are drawn where this raster
//!   does not hide them.
//! - Material in the plane covers all of this. A sample is in a body if the outlines of the body have a winding number
//!   there, and in the common part if both have one.

use colltrans::{Aabb, Solid};
use colltrans_picture::{CONTACT, Frame, INK, Raster, SHADES, View};
use glam::{DVec2, DVec3};

use super::{CUT_SHADES, Cut, Outline, PAINTS, SIZE, facets_in, height_range, visible_arrow};
use crate::report::lines::SortedLines;

/// Samples per pixel of a PNG picture, along each axis, as in [`Raster`].
const SAMPLES_PER_PIXEL: usize = 2;
/// Directions of view of PNG pictures relative to the plane: to the right, upwards, and towards the viewer.
const TILT: DVec3 = DVec3::new(0.35, 0.3, 1.0);

/// A camera of a picture, and the plane that clips it.
pub(in crate::report) struct Camera {
    /// Unit vector towards the viewer.
    pub(in crate::report) toward: DVec3,
    /// Unit vector that points up on the picture.
    pub(in crate::report) up: DVec3,
    /// Unit normal of the plane, towards the hidden side.
    pub(in crate::report) hidden: DVec3,
}

impl Cut {
    /// Returns the camera of [`Self::snapshot`].
    pub(in crate::report) fn camera(&self) -> Camera {
        let toward = TILT.x * self.right + TILT.y * self.upward + TILT.z * self.normal;
        let toward = toward.normalize();
        let up = toward.cross(self.upward.cross(toward)).normalize();
        Camera { toward, up, hidden: self.normal }
    }

    /// Returns the point of the plane, relative to the place, with these coordinates.
    fn point(&self, flat: DVec2) -> DVec3 {
        flat.x * self.right + flat.y * self.upward
    }

    /// Draws what is behind the plane, with the outlines in the plane, as PNG.
    pub(in crate::report) fn snapshot(
        &self,
        solids: [&Solid; 2],
        lines: [&SortedLines; 2],
    ) -> Vec<u8> {
        let Camera { toward, up, .. } = self.camera();
        let view = View::looking_along(toward, up);
        let scale = 0.5 * SIZE.y / self.radius;
        let on_page = |by: DVec3| {
            let flat = 0.5 * SIZE + view.project(by) * DVec2::new(1.0, -1.0) * scale;
            flat.extend(by.dot(toward) * scale)
        };
        let window = Frame { low: DVec2::ZERO, high: SIZE };
        let (mut surfaces, mut marks) = (Raster::new(window), Raster::new(window));
        // Directions of the page and their largest coordinates in it, and the plane.
        let right = up.cross(toward);
        let half = 0.5 * SIZE / scale;
        let is_shown = |within: &Aabb| {
            let meets = |axis: DVec3, half: f64| {
                let [low, high] = height_range(within, self.at, axis);
                low <= half && high >= -half
            };
            height_range(within, self.at, self.normal)[0] <= 0.0
                && meets(right, 1.01 * half.x)
                && meets(up, 1.01 * half.y)
        };
        let facets = solids.map(|solid| facets_in(solid, is_shown));
        for (k, solid) in solids.iter().enumerate() {
            for t in facets[k].iter().cloned().flatten() {
                let corners = solid.triangles()[t].map(|v| solid.vertices()[v as usize] - self.at);
                let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
                let normal = normal.normalize_or_zero();
                let facing = normal.dot(toward);
                if facing <= 0.0 && !solid.is_open(t) {
                    continue;
                }
                let lit = view.brightness(normal * facing.signum());
                let tone = k * (SHADES + 1) + (lit * SHADES as f64) as usize;
                let behind = part_below(&corners, self.normal);
                for pair in behind.get(1..).unwrap_or_default().windows(2) {
                    surfaces.draw([behind[0], pair[0], pair[1]].map(on_page), tone as u32);
                }
            }
        }
        for (k, (solid, lines)) in solids.iter().zip(lines).enumerate() {
            let near = |facets| lines.visible_lines_of(solid, toward, facets);
            for edge in facets[k].iter().flat_map(near) {
                let behind = part_below(&edge.map(|end| end - self.at), self.normal);
                if let [from, to, ..] = behind[..] {
                    let [seen, _] = surfaces.split([from, to].map(on_page), 1.5);
                    for ends in seen {
                        draw_line(&mut marks, ends, 0.45, Mark::Edge);
                    }
                }
            }
        }
        let cover = solids.map(|solid| {
            let mut covered = Vec::new();
            for Outline { points, is_closed } in self.outlines(solid) {
                let mut points: Vec<DVec2> =
                    points.iter().map(|p| on_page(self.point(*p)).truncate()).collect();
                points.extend(points.first().copied().filter(|_| is_closed));
                for ends in points.windows(2) {
                    draw_line(&mut marks, [ends[0], ends[1]], 0.6, Mark::Outline);
                }
                if is_closed {
                    covered.push(points);
                }
            }
            covered_samples(&covered)
        });
        if let Some(measure) = &self.measure {
            let ends = measure.ends.map(|end| on_page(end).truncate());
            let [from, to] = if measure.is_arrow { visible_arrow(ends) } else { ends };
            draw_line(&mut marks, [from, to], 2.4, Mark::Halo);
            draw_line(&mut marks, [from, to], 1.2, Mark::Measure);
            if measure.is_arrow {
                let along = (to - from).normalize_or_zero() * 11.0;
                let half = along.perp() * 0.4;
                let head = [to, to - along + half, to - along - half];
                marks.draw(head.map(|p| p.extend(Mark::Measure.depth())), Mark::Measure as u32);
            }
        }
        png_picture(&pixels(&surfaces, &marks, &cover))
    }
}

/// Marks of a PNG picture. Later ones cover earlier ones.
#[derive(Clone, Copy)]
enum Mark {
    Edge,
    Outline,
    Halo,
    Measure,
}

impl Mark {
    fn depth(self) -> f64 {
        f64::from(self as u32)
    }
}

/// Returns the part of a polygon or of a segment below the plane through the origin.
fn part_below(points: &[DVec3], normal: DVec3) -> Vec<DVec3> {
    let mut below = Vec::with_capacity(points.len() + 1);
    for (k, &p) in points.iter().enumerate() {
        let q = points[(k + 1) % points.len()];
        let (from, to) = (normal.dot(p), normal.dot(q));
        if from <= 0.0 {
            below.push(p);
        }
        if (from <= 0.0) != (to <= 0.0) {
            below.push(p.lerp(q, from / (from - to)));
        }
    }
    below
}

/// Draws a line of a half width in pixels.
fn draw_line(raster: &mut Raster, [from, to]: [DVec2; 2], half: f64, mark: Mark) {
    let across = (to - from).normalize_or_zero().perp() * half;
    let [a, b, c, d] =
        [from + across, from - across, to - across, to + across].map(|p| p.extend(mark.depth()));
    raster.draw([a, b, c], mark as u32);
    raster.draw([a, c, d], mark as u32);
}

/// Returns for each sample of a picture, row by row, whether closed outlines have a winding number there. The last
/// point of an outline is its first one.
fn covered_samples(outlines: &[Vec<DVec2>]) -> Vec<bool> {
    let [width, height] = SIZE.to_array().map(|side| side as usize * SAMPLES_PER_PIXEL);
    let mut crossings = vec![Vec::<(f64, i32)>::new(); height];
    for ends in outlines.iter().flat_map(|outline| outline.windows(2)) {
        let [p, q] = [ends[0], ends[1]].map(|p| p * SAMPLES_PER_PIXEL as f64 - 0.5);
        let (low, high, sign) = if p.y < q.y { (p, q, 1) } else { (q, p, -1) };
        let [first, end] = [low.y, high.y].map(|y| y.ceil().clamp(0.0, height as f64) as usize);
        for (row, crossed) in crossings[..end].iter_mut().enumerate().skip(first) {
            let share = (row as f64 - low.y) / (high.y - low.y);
            crossed.push((low.x + share * (high.x - low.x), sign));
        }
    }
    let mut covered = vec![false; width * height];
    for (row, mut crossed) in crossings.into_iter().enumerate() {
        crossed.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut winding = 0;
        for pair in crossed.windows(2) {
            winding += pair[0].1;
            if winding != 0 {
                let [from, to] =
                    [pair[0].0, pair[1].0].map(|x| x.ceil().clamp(0.0, width as f64) as usize);
                covered[row * width + from..row * width + to].fill(true);
            }
        }
    }
    covered
}

/// Returns the channels of a colour in HTML notation.
fn channels(colour: &str) -> [f64; 3] {
    let channel = |k: usize| u8::from_str_radix(colour.get(k..k + 2).unwrap_or_default(), 16);
    [1, 3, 5].map(|k| f64::from(channel(k).unwrap_or_default()))
}

/// Returns the red, green and blue of all pixels, row by row. `cover` has the samples in the material of both parts in
/// the plane.
fn pixels(surfaces: &Raster, marks: &Raster, cover: &[Vec<bool>; 2]) -> Vec<u8> {
    let tones: Vec<[f64; 3]> =
        PAINTS.iter().flat_map(|paint| (0..=SHADES).map(|k| channels(&paint.shade(k)))).collect();
    let cut = [0, 1].map(|k| channels(&PAINTS[k].shade(CUT_SHADES[k])));
    let [ink, contact, white] = [INK, CONTACT, "#ffffff"].map(channels);
    let [width, height] = SIZE.to_array().map(|side| side as usize);
    let mut sums = vec![[0.0; 3]; width * height];
    let samples = surfaces.samples().zip(marks.samples()).enumerate();
    for (sample, ((at, tone), (_, mark))) in samples {
        let inside = [cover[0][sample], cover[1][sample]];
        let colour = match (mark, inside) {
            (Some(mark), _) if mark == Mark::Measure as u32 => contact,
            (Some(mark), _) if mark == Mark::Halo as u32 => white,
            (Some(mark), _) if mark == Mark::Outline as u32 => ink,
            (_, [true, true]) => contact,
            (_, [true, false]) => cut[0],
            (_, [false, true]) => cut[1],
            (Some(_), _) => ink,
            (None, _) => tone.map_or(white, |tone| tones[tone as usize]),
        };
        let sum = &mut sums[at.y as usize * width + at.x as usize];
        (0..3).for_each(|k| sum[k] += colour[k]);
    }
    let count = (SAMPLES_PER_PIXEL * SAMPLES_PER_PIXEL) as f64;
    sums.iter().flatten().map(|sum| (sum / count).round() as u8).collect()
}

/// Returns a picture of [`SIZE`] as PNG.
fn png_picture(pixels: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, SIZE.x as u32, SIZE.y as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    // Writing to memory fails only if the sizes do not match, and they match.
    if let Ok(mut writer) = encoder.write_header() {
        let _ = writer.write_image_data(pixels);
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::super::tests::overlapping_boxes;
    use super::*;
    use crate::part::Part;

    #[test]
    fn picture_shows_both_parts_and_their_common_part() {
        let (parts, cut) = overlapping_boxes();
        let solids = parts.each_ref().map(Part::solid);
        let lines = solids.map(SortedLines::new);
        let png = cut.snapshot(solids, [&lines[0], &lines[1]]);
        let mut reader = png::Decoder::new(std::io::Cursor::new(&png)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        let count = |colour: &str| {
            let colour = channels(colour).map(|c| c as u8);
            pixels.chunks(3).filter(|pixel| **pixel == colour).count()
        };
        let seen = [0, 1].map(|k| count(&PAINTS[k].shade(CUT_SHADES[k])));
        assert!(seen.iter().all(|seen| *seen > 2_000), "{seen:?}");
        assert!(count(CONTACT) > 2_000, "{}", count(CONTACT));
        assert!(count("#ffffff") > 2_000, "{}", count("#ffffff"));
    }
}
