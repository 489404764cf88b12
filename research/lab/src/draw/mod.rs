//! Figures as pictures.
//!
//! `curve` sorts out what can be drawn, `axis` how much of the axes is shown; here the plotting
//! crate is told to draw it. Everything in a picture is computed from the [`Figure`]: the same
//! figure gives the same bytes.

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
use curve::{Curve, Spread};

/// A figure, drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// A complete SVG document, 720 px wide.
    pub svg: String,
    /// The same as PNG, with twice as many pixels.
    pub png: Vec<u8>,
    /// Sentences about what of the data could not be drawn.
    pub notes: Vec<String>,
}

/// Pixels of the SVG.
const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 500.0;
/// Where the label of the vertical axis begins.
const LABEL_AT: [f64; 2] = [16.0, 66.0];
/// Room for the title and that label.
const TOP: f64 = 82.0;
/// Room for the ticks' labels.
const LEFT: f64 = 64.0;
/// Pixels of the PNG for each of the SVG.
const PNG_SCALE: f32 = 2.0;

/// Colours that people with any colour vision can tell apart (Okabe and Ito), and shapes.
const COLOURS: [&str; 7] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#7a5195", "#e69f00", "#56b4e9"];
const SHAPES: [MarkerShape; 7] = [
    MarkerShape::Circle,
    MarkerShape::Square,
    MarkerShape::Triangle,
    MarkerShape::Diamond,
    MarkerShape::TriangleDown,
    MarkerShape::Pentagon,
    MarkerShape::Star,
];
/// Greys and dashes of curves to compare with. In PNG the dashes have pixels for their unit: short
/// ones would flow together.
const GREYS: [(&str, &str); 4] =
    [("#444444", "10 6"), ("#888888", "3 5"), ("#666666", "9 4 2 4"), ("#aaaaaa", "16 4")];

/// Draws a figure.
///
/// # Errors
///
/// The message of the PNG encoder.
pub fn draw(figure: &Figure) -> Result<Picture, String> {
    let (measured, mut notes) = curve::measured(figure);
    let (references, more) = curve::references(figure);
    notes.extend(more);
    let mut scene = scene(figure, &measured, &references, !notes.is_empty());
    lay_down_labels(&mut scene);
    let png = RasterBackend::new().with_scale(PNG_SCALE).render_scene(&scene)?;
    Ok(Picture { svg: svg(figure, &scene), png, notes })
}

/// The label of the vertical axis lies above it. Standing along it, as the plotting crate puts it, the
/// crate's rasteriser (0.6.0) copies it without the soft edges of its letters, so that they look as if
/// they were printed twice.
fn lay_down_labels(scene: &mut Scene) {
    for element in &mut scene.elements {
        if let Primitive::Text { x, y, anchor, rotate, .. } = element
            && rotate.take().is_some()
        {
            (*x, *y, *anchor) = (LABEL_AT[0], LABEL_AT[1], TextAnchor::Start);
        }
    }
}

fn scene(figure: &Figure, measured: &[Curve], references: &[Curve], incomplete: bool) -> Scene {
    let marks = || measured.iter().chain(references).flat_map(Curve::marks);
    let x = axis::range(&figure.x, marks().map(|mark| mark.x));
    let y = axis::range(
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
    for (k, (curve, (&colour, &shape))) in measured.iter().zip(styles()).enumerate() {
        let aside = aside(figure, x, k, measured.len());
        add_measured(&mut plots, &curve.moved(aside), colour, shape, y.0);
        let sign = if curve.is_dense() { LegendShape::Line } else { LegendShape::Marker(shape) };
        legend.push(entry(curve, colour, sign, None));
    }
    for (curve, &(grey, dash)) in references.iter().zip(GREYS.iter().cycle()) {
        legend.push(entry(curve, grey, LegendShape::Line, Some(dash)));
    }
    let mut layout = layout(figure, x, y).with_legend_entries(legend);
    if incomplete {
        layout = layout.with_subtitle("Not all data can be drawn: the report says which, and why.");
    }
    render_multiple(plots, layout)
}

/// Curves with the same places side by side by a few pixels, so that marks and bars of one do not
/// hide those of another. Where the curve is dense its places are the data: it stays.
fn aside(figure: &Figure, x: (f64, f64), k: usize, count: usize) -> impl Fn(f64) -> f64 + use<> {
    const SPREAD: f64 = 0.035;
    let share = SPREAD * ((k as f64 + 0.5) / count as f64 - 0.5);
    let log = figure.x.log;
    move |at| if log { at * (x.1 / x.0).powf(share) } else { at + (x.1 - x.0) * share }
}

fn styles() -> impl Iterator<Item = (&'static &'static str, &'static MarkerShape)> {
    COLOURS.iter().zip(&SHAPES).cycle()
}

fn line(points: impl Iterator<Item = (f64, f64)>, colour: &str, width: f64) -> LinePlot {
    LinePlot::new().with_data(points).with_color(colour).with_stroke_width(width)
}

fn entry(curve: &Curve, colour: &str, shape: LegendShape, dash: Option<&str>) -> LegendEntry {
    let missing = if curve.stretches.is_empty() { " (no points)" } else { "" };
    LegendEntry {
        label: literally(curve.name) + missing,
        color: colour.into(),
        shape,
        dasharray: dash.map(str::to_owned),
    }
}

fn add_reference(plots: &mut Vec<Plot>, curve: &Curve, grey: &str, dash: &str) {
    plots.extend(curve.stretches.iter().map(|stretch| {
        line(stretch.iter().map(|mark| (mark.x, mark.y)), grey, 1.0)
            .with_line_style(LineStyle::Custom(dash.into()))
            .into()
    }));
}

/// A line through the marks with their spreads: bars at each, or a band where there are many.
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
            plots.push(line(points(), colour, 1.5).into());
            continue;
        }
        let dots = ScatterPlot::new().with_data(points()).with_color(colour).with_marker(shape);
        let mut dots = dots.with_size(3.5);
        for ((dot, low), high) in dots.data.iter_mut().zip(low).zip(high) {
            dot.y_err = (low < high).then_some((dot.y - low, high - dot.y));
        }
        plots.push(line(points(), colour, 1.5).into());
        plots.push(dots.into());
    }
}

fn layout(figure: &Figure, x: (f64, f64), y: (f64, f64)) -> Layout {
    let ticks = || TickFormat::Custom(std::sync::Arc::new(axis::label));
    let mut layout = Layout::new(x, y)
        .with_width(WIDTH)
        .with_height(HEIGHT)
        .with_title(literally(&figure.title))
        .with_title_wrap(80)
        .with_title_size(15)
        .with_x_label(literally(&figure.x.label))
        .with_y_label(literally(&figure.y.label))
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
    // Half a label such as `200,000` may stand out beyond the last tick.
    layout.force_margin_right = Some(34.0);
    layout.force_margin_top = Some(TOP);
    layout.force_margin_left = Some(LEFT);
    layout.theme.grid_color = "#e4e4e4".into();
    layout
}

/// A frame around the statement that there is nothing to see.
fn empty_scene(figure: &Figure) -> Scene {
    let nothing = TextAnnotation::new("No point of this figure can be drawn.", 0.5, 0.5);
    let plain = Axis { label: String::new(), log: false };
    let plain = Figure { x: plain.clone(), y: plain, ..figure.clone() };
    let mut layout = layout(&plain, (0.0, 1.0), (0.0, 1.0))
        .with_annotation(nothing.with_font_size(15))
        .with_show_grid(false);
    layout.suppress_x_ticks = true;
    layout.suppress_y_ticks = true;
    render_multiple(vec![ScatterPlot::new().into()], layout)
}

/// Text as it is: between dollars the plotting crate would look for formulas.
fn literally(text: &str) -> String {
    text.replace('$', "\\$")
}

/// The scene as SVG that scales, with the same bytes each time: the plotting crate numbers clipping
/// paths over the whole life of the process.
fn svg(figure: &Figure, scene: &Scene) -> String {
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
