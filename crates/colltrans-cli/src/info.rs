//! `colltrans info`: what a mesh file holds.

use std::path::Path;

use colltrans::{BuildError, ConvexPolyhedron};
use colltrans_mesh::body::{self, BodyOptions, Excess, Note};
use colltrans_mesh::{Mesh, NumberFormat, ReadOptions};

use crate::args::InfoArguments;
use crate::failure::{Code, Failure, print};
use crate::numbers::{about, counted, known, six_digits, vector};
use crate::report::push_line;
use crate::solid;
use crate::terminal::shown;

/// Names that are listed.
const MOST_NAMED: usize = 8;

pub(crate) fn run(arguments: &InfoArguments) -> Result<(), Failure> {
    let mut unreadable = Vec::new();
    for path in &arguments.meshes {
        let options = ReadOptions::default().with_merge_tolerance(arguments.merge_tolerance);
        match colltrans_mesh::read_with(path, options) {
            Ok(mesh) if mesh.vertices.is_empty() => {
                unreadable.push(format!("{}: holds no vertices", path.display()));
            }
            Ok(mesh) => {
                let text = describe(path, &mesh, arguments.convex_tolerance);
                print(&text)?;
            }
            Err(error) => unreadable.push(error.to_string()),
        }
    }
    if unreadable.is_empty() { Ok(()) } else { Err(Failure::several(Code::Input, unreadable)) }
}

fn describe(path: &Path, mesh: &Mesh, asked_tolerance: Option<f64>) -> String {
    let mut text = format!("{}\n", shown(path.display()));
    push_line(&mut text, "vertices", &vertices(mesh));
    push_line(&mut text, "faces", &faces(mesh));
    let not_finite = mesh.vertices.iter().position(|v| !v.is_finite());
    let no_number = not_finite.map(|vertex| format!("none: vertex {vertex} is not finite"));
    if let Some(why) = &no_number {
        push_line(&mut text, "extent", why);
    } else if let Some([low, high]) = mesh.bounds() {
        let [x, y, z] = (high - low).to_array().map(|c| known(c, 1e-14 * mesh.extent()));
        push_line(&mut text, "extent", &format!("{x} x {y} x {z}"));
        push_line(&mut text, "", &format!("from {} to {}", vector(low), vector(high)));
    }
    if mesh.format != NumberFormat::Double {
        let what = format!("{}, known to within {}", mesh.format, about(mesh.precision));
        push_line(&mut text, "coordinates", &what);
    }
    if let Some(merged) = Note::merged(mesh) {
        push_line(&mut text, "merged", &merged.to_string());
    }
    if !mesh.faces.is_empty() {
        push_line(&mut text, "surface", &surface(mesh));
    }
    let is_closed = !mesh.faces.is_empty() && mesh.open_edges().is_empty();
    let signed = mesh.signed_volume();
    let volume = match no_number {
        Some(why) if !(is_closed && signed.is_finite()) => why,
        _ if is_closed => computed(signed),
        _ => "none: the faces do not enclose a body".into(),
    };
    push_line(&mut text, "volume", &volume);
    for (name, what) in solid::describe(mesh) {
        push_line(&mut text, name, &what);
    }
    for (name, what) in parts(mesh) {
        push_line(&mut text, name, &what);
    }
    // Tolerance 0 makes the library say how deep the worst face lies, however little.
    match ConvexPolyhedron::from_mesh(&mesh.vertices, &mesh.faces, 0.0) {
        Ok(_) => push_line(&mut text, "convex", "yes, to rounding error"),
        Err(BuildError::NotConvex { face, depth, .. }) => {
            push_line(&mut text, "convex", &not_quite(mesh, face, depth, asked_tolerance));
        }
        Err(error) => push_line(&mut text, "convex", &format!("no: {error}")),
    }
    match body::hull(mesh) {
        Ok(hull) => {
            push_line(&mut text, "hull", &counts(&hull));
            push_line(&mut text, "hull volume", &computed(hull.volume()));
            let excess = Excess::of(mesh, &hull);
            let tolerance = tolerance(mesh, asked_tolerance);
            if !mesh.faces.is_empty() && !excess.is_within(tolerance, mesh.extent()) {
                push_line(&mut text, "hull exceeds", &excess.to_string());
            }
            let error = about(hull.hull_error());
            push_line(
                &mut text,
                "hull error",
                &format!("{error} (no vertex in use is farther from the hull)"),
            );
        }
        Err(error) => push_line(&mut text, "hull", &format!("none: {error}")),
    }
    text
}

/// The parts that `assembly` makes of it, if these are several.
fn parts(mesh: &Mesh) -> Vec<(&'static str, String)> {
    let mut lines = Vec::new();
    let named: Vec<String> = mesh.named().into_iter().map(|(name, _)| name).collect();
    if !named.is_empty() {
        let more = if named.len() > MOST_NAMED { ", ..." } else { "" };
        let first = named[..named.len().min(MOST_NAMED)].join(", ");
        lines.push(("names", format!("{}: {}{more}", named.len(), shown(first))));
    }
    if let Ok(Some(apart)) = body::bodies(mesh, &BodyOptions::default()) {
        let what = format!("{}, apart with `assembly --split bodies`", apart.meshes.len());
        lines.push(("bodies", what));
    }
    lines
}

fn vertices(mesh: &Mesh) -> String {
    match mesh.stray_vertices() {
        0 => mesh.vertices.len().to_string(),
        unused => {
            format!("{}, {unused} of them used by no face", mesh.vertices.len())
        }
    }
}

/// How deep a face may lie below the hull.
fn tolerance(mesh: &Mesh, convex_tolerance: Option<f64>) -> f64 {
    BodyOptions::default().with_convex_tolerance(convex_tolerance).convex_tolerance_of(mesh)
}

fn faces(mesh: &Mesh) -> String {
    let count = mesh.faces.len();
    let triangles = mesh.faces.iter().filter(|f| f.len() == 3).count();
    let largest = mesh.faces.iter().map(Vec::len).max().unwrap_or(0);
    if count == 0 {
        "0 (a cloud of points)".into()
    } else if triangles == count {
        format!("{count}, all triangles")
    } else {
        format!("{count}, {triangles} of them triangles, up to {largest} corners")
    }
}

/// A sum of many products.
fn computed(volume: f64) -> String {
    known(volume, 1e-13 * volume)
}

fn surface(mesh: &Mesh) -> String {
    let open = mesh.open_edges();
    match open.as_slice() {
        [] => "closed".into(),
        [[a, b], ..] => format!(
            "not closed: {} no partner that runs the other way, one of them from vertex {a} to vertex {b}",
            counted(open.len(), "edge has", "edges have")
        ),
    }
}

fn not_quite(mesh: &Mesh, face: usize, depth: f64, asked_tolerance: Option<f64>) -> String {
    let tolerance = tolerance(mesh, asked_tolerance);
    let relative = depth / mesh.extent();
    let verdict = if depth <= tolerance {
        "yes, within tolerance"
    } else {
        "no; `clearance` takes it as it is, --hull takes its hull"
    };
    format!(
        "{verdict}: face {face} lies {} below the hull, {} of the extent (tolerated: {})",
        six_digits(depth),
        about(relative),
        about(tolerance)
    )
}

fn counts(hull: &ConvexPolyhedron) -> String {
    let shape = match hull.dimension() {
        0 => "a point: ",
        1 => "a segment: ",
        2 => "flat: ",
        _ => "",
    };
    format!(
        "{shape}{}, {}, {}",
        counted(hull.vertices().len(), "vertex", "vertices"),
        counted(hull.edge_count(), "edge", "edges"),
        counted(hull.face_count(), "face", "faces")
    )
}
