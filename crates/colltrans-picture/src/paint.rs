//! Colours of bodies, told apart with any colour vision: the moving one is blue, the fixed one sand. The
//! page (`web/src/colours.ts`) and Python (`pictures.py`) have the same.

/// Colours of a body.
#[derive(Debug, Clone, Copy)]
pub struct Paint {
    /// Red, green, blue of a face in the shadow, up to 255.
    pub dark: [f64; 3],
    /// The same in the light.
    pub light: [f64; 3],
    /// Outlines and sharp edges.
    pub line: &'static str,
    /// Lines inside smooth surfaces.
    pub fine: &'static str,
}

/// Of the moving body.
pub const MOVING: Paint = Paint {
    dark: [70.0, 108.0, 168.0],
    light: [214.0, 228.0, 246.0],
    line: "#1f3a68",
    fine: "#5676a8",
};
/// Of the fixed body.
pub const FIXED: Paint = Paint {
    dark: [148.0, 134.0, 112.0],
    light: [248.0, 243.0, 232.0],
    line: "#4a4033",
    fine: "#8d8069",
};
/// Features of the moving body in the contact plane.
pub const MOVING_MARK: &str = "#0b57d0";
/// The same of the fixed body.
pub const FIXED_MARK: &str = "#c2600f";

/// Number of shades: neighbouring faces of dense meshes share a path.
pub const SHADES: usize = 40;
/// Edges that bend less are part of a smooth surface (cosine of 25 degrees).
pub const SMOOTH: f64 = 0.906;

impl Paint {
    /// The colour of one of [`SHADES`], from dark to light.
    pub fn shade(&self, shade: usize) -> String {
        let part = shade as f64 / SHADES as f64;
        let [r, g, b]: [u8; 3] = std::array::from_fn(|i| {
            (self.dark[i] + part * (self.light[i] - self.dark[i])).round() as u8
        });
        format!("#{r:02x}{g:02x}{b:02x}")
    }
}
