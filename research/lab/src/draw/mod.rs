//! Figures as pictures.
//!
//! `curve` selects the drawable points, `axis` the visible ranges. This module passes them to the plotting
//! crate. A picture depends only on the [`Figure`]: equal figures yield equal bytes.

mod axis;
mod curve;

use kuva::backend::raster::RasterBackend;
use kuva::backend::svg::SvgBackend;
use kuva::plot::{
    BandPlot, LegendEntry, LegendPosition, LegendShape, LinePlot, LineStyle, MarkerShape,
    ScatterPlot,
};
use kuva::render::annotations::TextAnnotation;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use kuva::render::render::{Primitive, Scene, TextAnchor, render_multiple};

use crate::finding::{Axis, Figure};
use crate::style::{CURVE_WIDTH, CURVES, FONT, GREYS, GRID};
use curve::{Curve, Spread};

/// A drawn figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// A complete SVG document, 720 px wide.
    pub svg: String,
    /// The same picture as PNG, with twice the resolution.
    pub png: Vec<u8>,
    /// Sentences about points that are not drawn.
    pub notes: Vec<String>,
}

/// Width of the SVG in pixels.
const WIDTH: f64 = 720.0;
/// Height of the SVG in pixels.
const HEIGHT: f64 = 500.0;
/// Position of the label of the vertical axis.
const LABEL_AT: [f64; 2] = [16.0, 66.0];
/// Margin for the title and the label of the vertical axis.
const TOP: f64 = 82.0;
/// Margin for the labels of ticks.
const LEFT: f64 = 64.0;
/// Pixels of the PNG for each pixel of the SVG.
const PNG_SCALE: f32 = 2.0;

/// Shapes of marks.
const SHAPES: [MarkerShape; 7] = [
    MarkerShape::Circle,
    MarkerShape::Square,
    MarkerShape::Triangle,
    MarkerShape::Diamond,
    MarkerShape::TriangleDown,
    MarkerShape::Pentagon,
    MarkerShape::Star,
];

/// Draws a figure.
///
/// # Errors
/// The message of the PNG encoder.
pub fn draw(figure: &Figure) -> Result<Picture, String> {
    let (measured, mut notes) = curve::measured_curves(figure);
    let (references, more) = curve::reference_curves(figure);
    notes.extend(more);
    let mut scene = build_scene(figure, &measured, &references, !notes.is_empty());
    place_vertical_label_above_axis(&mut scene);
    let png = RasterBackend::new().with_scale(PNG_SCALE).render_scene(&scene)?;
    Ok(Picture { svg: render_svg(figure, &scene), png, notes })
}

/// Places the label of the vertical axis above it. The plotting crate draws it rotated along the axis, which
/// its rasteriser (0.6.0) renders without smooth edges.
fn place_vertical_label_above_axis(scene: &mut Scene) {
    for element in &mut scene.elements {
        if let Primitive::Text { x, y, anchor, rotate, .. } = element
            && rotate.take().is_some()
        {
            (*x, *y, *anchor) = (LABEL_AT[0], LABEL_AT[1], TextAnchor::Start);
        }
    }
}

/// Builds the plot of all curves.
fn build_scene(
    figure: &Figure,
    measured: &[Curve],
    references: &[Curve],
    incomplete: bool,
) -> Scene {
    let marks = || measured.iter().chain(references).flat_map(Curve::marks);
    let x = axis::visible_range(&figure.x, marks().map(|mark| mark.x));
    let y = axis::visible_range(
        &figure.y,
        marks().flat_map(|mark| match mark.spread {
            Spread::None => [mark.y; 2],
            Spread::Between(low, high) => [low, high],
            Spread::UpTo(high) => [mark.y, high],
        }),
    );
    let (Some(x), Some(y)) = (x, y) else { return empty_scene(figure) };
    let (mut plots, mut legend) = (Vec::new(), Vec::new());
    // First those that others may cover.
    for (curve, &(grey, dash)) in references.iter().zip(GREYS.iter().cycle()) {
        add_reference(&mut plots, curve, grey, dash);
    }
    for (k, (curve, (&colour, &shape))) in measured.iter().zip(curve_styles()).enumerate() {
        let aside = aside(figure, x, k, measured.len());
        add_measured(&mut plots, &curve.moved(aside), colour, shape, y.0);
        let sign = if curve.is_dense() { LegendShape::Line } else { LegendShape::Marker(shape) };
        legend.push(legend_entry(curve, colour, sign, None));
    }
    for (curve, &(grey, dash)) in references.iter().zip(GREYS.iter().cycle()) {
        legend.push(legend_entry(curve, grey, LegendShape::Line, Some(dash)));
    }
    let mut layout = plot_layout(figure, x, y).with_legend_entries(legend);
    if incomplete {
        layout = layout.with_subtitle("Not all data can be drawn: the report says which, and why.");
    }
    render_multiple(plots, layout)
}

/// Returns a function that shifts positions on the horizontal axis by a few pixels for curve `k` of `count`, so that
/// marks and bars of curves at the same positions do not hide each other.
fn aside(figure: &Figure, x: (f64, f64), k: usize, count: usize) -> impl Fn(f64) -> f64 + use<> {
    const SPREAD: f64 = 0.035;
    let share = SPREAD * ((k as f64 + 0.5) / count as f64 - 0.5);
    let log = figure.x.log;
    move |at| if log { at * (x.1 / x.0).powf(share) } else { at + (x.1 - x.0) * share }
}

/// Iterates over pairs of colours and shapes.
fn curve_styles() -> impl Iterator<Item = (&'static &'static str, &'static MarkerShape)> {
    CURVES.iter().zip(&SHAPES).cycle()
}

/// Returns a line plot.
fn line_plot(points: impl Iterator<Item = (f64, f64)>, colour: &str, width: f64) -> LinePlot {
    LinePlot::new().with_data(points).with_color(colour).with_stroke_width(width)
}

/// Returns the legend entry of a curve.
fn legend_entry(
    curve: &Curve,
    colour: &str,
    shape: LegendShape,
    dash: Option<&str>,
) -> LegendEntry {
    let missing = if curve.stretches.is_empty() { " (no points)" } else { "" };
    LegendEntry {
        label: without_formulas(curve.name) + missing,
        color: colour.into(),
        shape,
        dasharray: dash.map(str::to_owned),
    }
}

/// Adds a curve for comparison.
fn add_reference(plots: &mut Vec<Plot>, curve: &Curve, grey: &str, dash: &str) {
    plots.extend(curve.stretches.iter().map(|stretch| {
        line_plot(stretch.iter().map(|mark| (mark.x, mark.y)), grey, 1.0)
            .with_line_style(LineStyle::Custom(dash.into()))
            .into()
    }));
}

/// Adds a line through the marks with their spreads: bars at each mark, or a band for dense curves.
fn add_measured(
    plots: &mut Vec<Plot>,
    curve: &Curve,
    colour: &str,
    shape: MarkerShape,
    bottom: f64,
) {
    let is_dense = curve.is_dense();
    for stretch in &curve.stretches {
        let points = || stretch.iter().map(|mark| (mark.x, mark.y));
        let (low, high): (Vec<f64>, Vec<f64>) = stretch
            .iter()
            .map(|mark| match mark.spread {
                Spread::None => (mark.y, mark.y),
                Spread::Between(low, high) => (low, high),
                Spread::UpTo(high) => (bottom, high),
            })
            .unzip();
        if is_dense && stretch.len() > 1 {
            let x = points().map(|(x, _)| x);
            plots.push(BandPlot::new(x, low, high).with_color(colour).with_opacity(0.2).into());
            plots.push(line_plot(points(), colour, CURVE_WIDTH).into());
            continue;
        }
        let dots = ScatterPlot::new().with_data(points()).with_color(colour).with_marker(shape);
        let mut dots = dots.with_size(3.5);
        for ((dot, low), high) in dots.data.iter_mut().zip(low).zip(high) {
            dot.y_err = (low < high).then_some((dot.y - low, high - dot.y));
        }
        plots.push(line_plot(points(), colour, CURVE_WIDTH).into());
        plots.push(dots.into());
    }
}

/// Returns the layout for these ranges.
fn plot_layout(figure: &Figure, x: (f64, f64), y: (f64, f64)) -> Layout {
    let ticks = || TickFormat::Custom(std::sync::Arc::new(axis::tick_label));
    let mut layout = Layout::new(x, y)
        .with_width(WIDTH)
        .with_font_family(FONT)
        .with_height(HEIGHT)
        .with_title(without_formulas(&figure.title))
        .with_title_wrap(80)
        .with_title_size(15)
        .with_x_label(without_formulas(&figure.x.label))
        .with_y_label(without_formulas(&figure.y.label))
        .with_x_axis_min(x.0)
        .with_x_axis_max(x.1)
        .with_y_axis_min(y.0)
        .with_y_axis_max(y.1)
        .with_x_tick_format(ticks())
        .with_y_tick_format(ticks())
        .with_legend_position(LegendPosition::OutsideBottomColumns)
        .with_legend_box(false);
    layout.log_x = figure.x.log;
    layout.log_y = figure.y.log;
    // Half of a label such as `200,000` may extend beyond the last tick.
    layout.force_margin_right = Some(34.0);
    layout.force_margin_top = Some(TOP);
    layout.force_margin_left = Some(LEFT);
    layout.theme.grid_color = GRID.into();
    layout
}

/// Returns a frame with the note that there are no points.
fn empty_scene(figure: &Figure) -> Scene {
    let nothing = TextAnnotation::new("No point of this figure can be drawn.", 0.5, 0.5);
    let plain = Axis { label: String::new(), log: false };
    let plain = Figure { x: plain.clone(), y: plain, ..figure.clone() };
    let mut layout = plot_layout(&plain, (0.0, 1.0), (0.0, 1.0))
        .with_annotation(nothing.with_font_size(15))
        .with_show_grid(false);
    layout.suppress_x_ticks = true;
    layout.suppress_y_ticks = true;
    render_multiple(vec![ScatterPlot::new().into()], layout)
}

/// Escapes dollar signs, between which the plotting crate would expect formulas.
fn without_formulas(text: &str) -> String {
    text.replace('$', "\\$")
}

/// Returns a scalable SVG with reproducible bytes. The plotting crate numbers clipping paths globally in the
/// process; these numbers are replaced.
fn render_svg(figure: &Figure, scene: &Scene) -> String {
    const NUMBERED: &str = "kuva-clip-";
    let mut svg = SvgBackend::new().with_pretty(true).render_scene(scene);
    if let Some(at) = svg.find(NUMBERED) {
        let digits = svg[at + NUMBERED.len()..].bytes().take_while(u8::is_ascii_digit).count();
        let id = svg[at..at + NUMBERED.len() + digits].to_owned();
        svg = svg.replace(&id, &format!("{}-clip", figure.id));
    }
    let scalable = format!(r#"<svg viewBox="0 0 {} {}" "#, scene.width, scene.height);
    svg.replacen("<svg ", &scalable, 1)
}
