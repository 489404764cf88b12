//! Any figure can be drawn; points that cannot be shown are left out with a note.

use colltrans_lab::csv;
use colltrans_lab::draw::{Picture, draw};
use colltrans_lab::finding::{Figure, Point, Series};

use crate::made_up::{figure, series};
use crate::xml::elements;

/// Draws a figure, and checks the properties of every picture.
fn drawn(figure: &Figure) -> Picture {
    let picture = draw(figure).unwrap();
    assert_eq!(elements(&picture.svg, &[])[0], "svg");
    assert!(picture.svg.contains("viewBox=\"0 0 720 "), "it scales");
    for word in ["NaN", "nan", "inf"] {
        assert!(!picture.svg.contains(word), "{word} in {}", picture.svg);
    }
    assert_eq!(&picture.png[1..4], b"PNG");
    let size = |at: usize| u32::from_be_bytes(picture.png[at..at + 4].try_into().unwrap());
    assert_eq!((size(16), size(20)), (1440, 1000));
    assert_coordinates(&picture.svg);
    picture
}

/// Asserts that coordinates are not far outside the picture, because renderers store them in few bits.
fn assert_coordinates(svg: &str) {
    for name in ["x1", "x2", "y1", "y2", "cx", "cy", "x", "y", "points", "d"] {
        for value in svg.split(&format!(" {name}=\"")).skip(1) {
            let value = value.split('"').next().unwrap();
            let numbers = value.split(|c: char| "MLZ, ".contains(c)).filter(|n| !n.is_empty());
            for number in numbers {
                let place: f64 = number.parse().unwrap();
                assert!((-10.0..=1000.0).contains(&place), "{name}: {number}");
            }
        }
    }
}

#[test]
fn picture_contains_titles_labels_and_legend() {
    let picture = drawn(&figure("figure-12"));
    assert!(picture.notes.is_empty());
    for text in [
        "a &lt; b &amp; &quot;c&quot;",
        "costs $5 or $6",
        "log n",
        "√n",
        "time per query, µs",
        "vertices of each body",
        "100,000",
        "stroke-dasharray",
        "(median; bars from quartile to",
    ] {
        assert!(picture.svg.contains(text), "{text:?}");
    }
}

#[test]
fn equal_figures_yield_equal_bytes() {
    let figure = figure("figure-12");
    let first = draw(&figure).unwrap();
    let other = Figure { id: "other".into(), ..figure.clone() };
    draw(&other).unwrap();
    assert_eq!(first, draw(&figure).unwrap());
    assert_eq!(csv::figure(&figure), csv::figure(&figure.clone()));
}

/// Pictures in one page must not share the names of their clipping paths.
#[test]
fn clipping_paths_of_pictures_have_different_names() {
    let id = |picture: &Picture| picture.svg.split("id=\"").nth(1).unwrap()[..12].to_owned();
    assert_ne!(id(&drawn(&figure("figure-12"))), id(&drawn(&figure("figure-13"))));
}

#[test]
fn all_kinds_of_axes_are_drawn() {
    for (x, y) in [(false, false), (false, true), (true, false), (true, true)] {
        let mut figure = figure("f");
        (figure.x.log, figure.y.log) = (x, y);
        assert!(drawn(&figure).notes.is_empty());
    }
}

/// Marks are at their coordinates: equal factors have equal distances on a logarithmic axis.
#[test]
fn marks_are_at_their_coordinates() {
    let mut figure = figure("f");
    figure.references.clear();
    let point = |x: f64, y: f64| Point { x, y, low: y, high: y, count: 1 };
    let points = vec![point(10.0, 1.0), point(100.0, 3.0), point(1000.0, 5.0)];
    figure.series = vec![Series { name: "s".into(), points }];
    for log in [true, false] {
        figure.x.log = log;
        figure.y.log = false;
        let svg = drawn(&figure).svg;
        let coordinate = |name: &str| -> Vec<f64> {
            let circles = svg.split("<circle ").skip(1).take(3);
            let values = circles.map(|c| c.split(&format!("{name}=\"")).nth(1).unwrap());
            values.map(|value| value.split('"').next().unwrap().parse().unwrap()).collect()
        };
        let (x, y) = (coordinate("cx"), coordinate("cy"));
        let ratio = (x[1] - x[0]) / (x[2] - x[1]);
        let expected = if log { 1.0 } else { 0.1 };
        assert!((ratio - expected).abs() < 1e-3, "{x:?}");
        assert!(((y[0] - y[1]) / (y[1] - y[2]) - 1.0).abs() < 1e-3 && y[0] > y[1], "{y:?}");
    }
}

#[test]
fn empty_figure_is_drawn() {
    let mut nothing = figure("f");
    nothing.series.clear();
    nothing.references.clear();
    assert!(drawn(&nothing).svg.contains("No point of this figure can be drawn."));
    nothing.series = vec![series("negative", |_| -1.0), series("none", |_| f64::NAN)];
    let picture = drawn(&nothing);
    assert!(picture.svg.contains("No point of this figure can be drawn."));
    assert_eq!(picture.notes.len(), 2, "{:?}", picture.notes);
}

#[test]
fn missing_points_are_noted() {
    let mut figure = figure("f");
    figure.series[0].points[3].y = f64::NAN;
    figure.series[0].points[5].x = 0.0;
    figure.series[1].points[4].low = -3.0;
    figure.series[1].points[5].high = 0.0;
    figure.series[1].points[6].low = f64::NAN;
    figure.series[2].points.clear();
    figure.references[0].points.truncate(1);
    let picture = drawn(&figure);
    assert!(picture.svg.contains("Not all data can be drawn"));
    let expected = [
        "a < b & \"c\": 2 of 12 points not drawn",
        "costs $5 or $6: 2 of 12 points without spread",
        "costs $5 or $6: 1 of 12 points with a spread that is cut",
        "linear: no points",
        "log n: 1 of 1 points not drawn: a point alone",
    ];
    assert_eq!(picture.notes.len(), expected.len(), "{:?}", picture.notes);
    for (note, beginning) in picture.notes.iter().zip(expected) {
        assert!(note.starts_with(beginning), "{note:?}");
    }
    assert!(picture.svg.contains("linear (no points)"));
}

/// A single point, equal points, many points, and numbers of any size.
#[test]
fn unusual_data_is_drawn() {
    let one =
        |x, y| Series { name: "s".into(), points: vec![Point { x, y, low: y, high: y, count: 1 }] };
    let extremes = [0.0, 1e-300, 1e-9, 1.0, 1e15, f64::MAX, f64::INFINITY, -1.0];
    for log in [true, false] {
        let mut figure = figure("f");
        (figure.x.log, figure.y.log) = (log, log);
        figure.references.clear();
        for x in extremes {
            for y in extremes {
                figure.series = vec![one(x, y)];
                drawn(&figure);
                figure.series.push(series("s", f64::sqrt));
                drawn(&figure);
            }
        }
        let many = |y: fn(f64) -> f64| Series {
            name: "many".into(),
            points: (0..2000)
                .map(|i| f64::from(i) + 0.5)
                .map(|x| Point { x, y: y(x), low: 0.5 * y(x), high: 2.0 * y(x), count: 3 })
                .collect(),
        };
        figure.series = (0..9).map(|_| many(f64::sqrt)).collect();
        assert!(drawn(&figure).notes.is_empty());
        // A point alone among many has a mark: neither line nor band can show it.
        figure.series.truncate(1);
        figure.series[0].points[999].y = f64::NAN;
        figure.series[0].points[1001].y = f64::NAN;
        assert_eq!(drawn(&figure).svg.matches("<circle ").count(), 1);
    }
}
