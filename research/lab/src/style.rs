//! Font, colours and widths of lines of all pictures of the laboratory, those of `crates/colltrans-picture`
//! (`src/style.rs`). The sheets of the paper's figures have them in `figures/sheet.css`.

/// Fonts in order of preference.
pub(crate) const FONT: &str = "Helvetica, Arial, 'Liberation Sans', sans-serif";
/// The colour of grids.
pub(crate) const GRID: &str = "#e4e4e4";
/// Colours of curves, distinct for any colour vision: the marks of the moving and of the fixed body, then those of
/// Okabe and Ito.
pub(crate) const CURVES: [&str; 7] =
    ["#0b57d0", "#c2600f", "#009e73", "#cc79a7", "#7a5195", "#e69f00", "#56b4e9"];
/// Greys and dashes of curves for comparison. In the PNG the unit of dashes is a pixel, so that short dashes
/// would merge.
pub(crate) const GREYS: [(&str, &str); 4] =
    [("#444444", "10 6"), ("#888888", "3 5"), ("#666666", "9 4 2 4"), ("#aaaaaa", "16 4")];
/// Width of curves, in pixels: that of outlines.
pub(crate) const CURVE_WIDTH: f64 = 1.5;
