//! The scene to draw, as the page sends it.
//!
//! Points are (x, y, q): pixels of the page, and the inverse of the distance along the view. The attached
//! file is little-endian: the corners of the triangles (nine `f64` each), the ends of the segments (six `f64`
//! each), then as `u32` for each triangle its style and number, for each segment its style and its count of
//! adjacent triangles, and finally the numbers of these triangles.

use colltrans_picture::Facet;
use glam::{DVec2, DVec3};
use serde::Deserialize;

/// Maximum side of a drawing, in pixels.
const LARGEST: f64 = 16_384.0;

#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "lowercase")]
pub(crate) enum Question {
    Draw(Styles),
}

/// The scene without its geometry.
#[derive(Debug, Deserialize)]
pub(crate) struct Styles {
    /// Width and height in pixels.
    pub(crate) size: [f64; 2],
    /// Differences of depth up to this value are ignored.
    pub(crate) slack: f64,
    /// The colour of the ground.
    pub(crate) ground: String,
    /// The colour of words.
    pub(crate) text: String,
    pub(crate) areas: Vec<Area>,
    pub(crate) lines: Vec<Line>,
    pub(crate) words: Vec<Word>,
    triangles: usize,
    segments: usize,
}

/// A style of triangles.
#[derive(Debug, Deserialize)]
pub(crate) struct Area {
    pub(crate) fill: String,
    pub(crate) opacity: f64,
    /// Whether the area is above everything: nothing hides it, and it hides no line.
    pub(crate) above: bool,
}

/// A style of segments.
#[derive(Debug, Deserialize)]
pub(crate) struct Line {
    pub(crate) colour: String,
    pub(crate) opacity: f64,
    /// Length of dashes and of the gaps between them, in pixels.
    pub(crate) dash: Option<f64>,
    /// Whether the line is below all areas.
    pub(crate) below: bool,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Word {
    pub(crate) at: [f64; 2],
    pub(crate) text: String,
}

#[derive(Debug)]
pub(crate) struct Segment {
    pub(crate) ends: [DVec3; 2],
    pub(crate) style: u32,
    /// The triangles of which the segment is an edge.
    pub(crate) adjacent: Vec<u32>,
}

#[derive(Debug)]
pub(crate) struct Scene {
    pub(crate) styles: Styles,
    /// The triangles with their numbers.
    pub(crate) triangles: Vec<(Facet, u32)>,
    pub(crate) segments: Vec<Segment>,
}

impl Scene {
    pub(crate) fn read(styles: Styles, file: &[u8]) -> Result<Self, String> {
        let size = DVec2::from_array(styles.size);
        if !(size.cmpge(DVec2::ONE).all() && size.max_element() <= LARGEST) {
            return Err(format!(
                "a size of {} by {} pixels is out of range; accepted: 1 to {LARGEST}",
                size.x, size.y
            ));
        }
        let scene = Self { triangles: Vec::new(), segments: Vec::new(), styles };
        scene.with_geometry(file).ok_or_else(|| {
            "the file does not match the stated numbers of triangles and lines".to_owned()
        })
    }

    /// Reads the geometry; returns `None` if the file has another size than the counts require.
    fn with_geometry(mut self, file: &[u8]) -> Option<Self> {
        let Styles { triangles, segments, ref areas, ref lines, .. } = self.styles;
        let points = triangles.checked_mul(3)?.checked_add(segments.checked_mul(2)?)?;
        let (floats, integers) = file.split_at_checked(points.checked_mul(24)?)?;
        let (floats, []) = floats.as_chunks::<8>() else { return None };
        let (integers, []) = integers.as_chunks::<4>() else { return None };
        let mut points = floats.chunks_exact(3).map(|p| {
            let [x, y, q] = [p[0], p[1], p[2]].map(f64::from_le_bytes);
            DVec3::new(x, y, q)
        });
        let mut point = || points.next();
        let mut integers = integers.iter().map(|bytes| u32::from_le_bytes(*bytes));
        for _ in 0..triangles {
            let corners = [point()?, point()?, point()?];
            let (style, number) = (integers.next()?, integers.next()?);
            let opaque = areas.get(style as usize)?.opacity >= 1.0;
            self.triangles.push((Facet { corners, style, opaque }, number));
        }
        let mut adjacent = Vec::new();
        for _ in 0..segments {
            let ends = [point()?, point()?];
            let (style, count) = (integers.next()?, integers.next()?);
            lines.get(style as usize)?;
            adjacent.push(count as usize);
            self.segments.push(Segment { ends, style, adjacent: Vec::new() });
        }
        for (segment, count) in self.segments.iter_mut().zip(adjacent) {
            segment.adjacent.extend(integers.by_ref().take(count));
            (segment.adjacent.len() == count).then_some(())?;
        }
        integers.next().is_none().then_some(self)
    }
}
