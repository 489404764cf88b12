//! The style of all pictures: font, colours and widths of lines. The colours of bodies are distinguishable with
//! any colour vision: the moving body is blue, the fixed body sand.
//!
//! The same style is in `research/lab/src/style.rs` and `figures/sheet.css` (laboratory),
//! `python/src/colltrans/pictures.py` (Python), `site/matplotlibrc` (notebooks and gallery) and
//! `web/src/colours.ts` (page).

/// Fonts in order of preference.
pub const FONT: &str = "Helvetica, Arial, 'Liberation Sans', sans-serif";

/// The colour of text and of translations.
pub const INK: &str = "#1d2733";
/// The colour of leaders, axes and traces.
pub const QUIET: &str = "#6b7785";
/// The colour of contact points and normals, of shortest ways, and of arrows in reports of assemblies.
pub const CONTACT: &str = "#b01657";
/// The colour of separating planes and margins.
pub const PLANE: &str = "#0a8a68";

/// Width of lines inside smooth surfaces, in pixels.
pub const HAIR_WIDTH: f64 = 0.45;
/// Width of hidden lines and of leaders, in pixels.
pub const FINE_WIDTH: f64 = 0.7;
/// Width of sharp edges, in pixels.
pub const EDGE_WIDTH: f64 = 0.9;
/// Width of guides, which are dashed, and of axes, in pixels.
pub const GUIDE_WIDTH: f64 = 1.1;
/// Width of outlines of bodies, in pixels.
pub const OUTLINE_WIDTH: f64 = 1.5;
/// Width of arrows and measured lengths, in pixels.
pub const ARROW_WIDTH: f64 = 2.0;
/// Width of features in contact, in pixels.
pub const MARK_WIDTH: f64 = 2.2;

/// The colours of a body.
#[derive(Debug, Clone, Copy)]
pub struct Paint {
    /// Red, green and blue of a face in shadow, from 0 to 255.
    pub dark: [f64; 3],
    /// Red, green and blue of a face in full light, from 0 to 255.
    pub light: [f64; 3],
    /// The colour of outlines and sharp edges.
    pub line: &'static str,
    /// The colour of lines inside smooth surfaces.
    pub fine: &'static str,
}

/// The colours of the moving body.
pub const MOVING: Paint = Paint {
    dark: [70.0, 108.0, 168.0],
    light: [214.0, 228.0, 246.0],
    line: "#1f3a68",
    fine: "#5676a8",
};
/// The colours of the fixed body.
pub const FIXED: Paint = Paint {
    dark: [148.0, 134.0, 112.0],
    light: [248.0, 243.0, 232.0],
    line: "#4a4033",
    fine: "#8d8069",
};
/// The colour of features of the moving body in the contact plane.
pub const MOVING_MARK: &str = "#0b57d0";
/// The colour of features of the fixed body in the contact plane.
pub const FIXED_MARK: &str = "#c2600f";

/// Number of shades. Neighbouring faces of dense meshes have the same shade and share a path.
pub const SHADES: usize = 40;
/// Minimum cosine of the angle at edges of smooth surfaces (25 degrees).
pub const SMOOTH_COSINE: f64 = 0.906;

impl Paint {
    /// Returns the colour of a shade, from 0 (dark) to [`SHADES`] (light).
    pub fn shade(&self, shade: usize) -> String {
        let part = shade as f64 / SHADES as f64;
        let [r, g, b]: [u8; 3] = std::array::from_fn(|i| {
            (self.dark[i] + part * (self.light[i] - self.dark[i])).round() as u8
        });
        format!("#{r:02x}{g:02x}{b:02x}")
    }
}
