//! Conversion between linear colours (glTF) and sRGB (screens). A channel is from 0 to 1.

/// Converts a linear channel to sRGB.
pub fn linear_to_srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Converts an sRGB channel to a linear one.
pub fn srgb_to_linear(on_screen: f64) -> f64 {
    if on_screen <= 0.040_45 { on_screen / 12.92 } else { ((on_screen + 0.055) / 1.055).powf(2.4) }
}
