//! Colours as glTF has them, linear, and as screens do (sRGB). A channel is from 0 to 1.

/// Returns a linear channel as screens have it.
pub fn on_screen(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Returns a channel of a screen as glTF has it.
pub fn linear(on_screen: f64) -> f64 {
    if on_screen <= 0.040_45 { on_screen / 12.92 } else { ((on_screen + 0.055) / 1.055).powf(2.4) }
}
