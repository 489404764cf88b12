//! `colltrans info`: describes mesh files.

use std::path::Path;

use colltrans::{BuildError, ConvexPolyhedron};
use colltrans_mesh::body::{self, BodyOptions, Excess, Note};
use colltrans_mesh::{Mesh, NumberFormat, ReadOptions};

use crate::args::InfoArguments;
use crate::failure::{Code, Failure, print};
use crate::numbers::{count_text, error_bound, estimate, six_digits, vector};
use crate::report::push_line;
use crate::solid::{self, SolidCheck};
use crate::terminal::escape_line;

/// Maximum number of names that are listed.
const MAX_NAMES: usize = 8;

pub(crate) fn run(arguments: &InfoArguments) -> Result<(), Failure> {
    let mut unreadable = Vec::new();
    for path in &arguments.meshes {
        let options = ReadOptions::default().with_merge_tolerance(arguments.merge_tolerance);
        match colltrans_mesh::read_with(path, options) {
            Ok(mesh) if mesh.vertices.is_empty() => {
                unreadable.push(format!("{}: contains no vertices", path.display()));
            }
            Ok(mesh) => {
                let text = describe_mesh(path, &mesh, arguments.convex_tolerance);
                print(&text)?;
            }
            Err(error) => unreadable.push(error.to_string()),
        }
    }
    if unreadable.is_empty() {
        Ok(())
    } else {
        Err(Failure::with_messages(Code::Input, unreadable))
    }
}

/// Returns the description of a mesh, one property per line.
fn describe_mesh(path: &Path, mesh: &Mesh, convex_tolerance: Option<f64>) -> String {
    let mut text = format!("{}\n", escape_line(path.display()));
    push_line(&mut text, "vertices", &vertex_count(mesh));
    push_line(&mut text, "faces", &face_count(mesh));
    let not_finite = mesh.vertices.iter().position(|v| !v.is_finite());
    let not_finite = not_finite.map(|vertex| format!("none: vertex {vertex} is not finite"));
    if let Some(why) = &not_finite {
        push_line(&mut text, "extent", why);
    } else if let Some([low, high]) = mesh.bounds() {
        let [x, y, z] = (high - low).to_array().map(|c| estimate(c, 1e-14 * mesh.extent()));
        push_line(&mut text, "extent", &format!("{x} x {y} x {z}"));
        push_line(&mut text, "", &format!("from {} to {}", vector(low), vector(high)));
    }
    if mesh.format != NumberFormat::Double {
        let what = format!("{}, known to within {}", mesh.format, error_bound(mesh.precision));
        push_line(&mut text, "coordinates", &what);
    }
    if let Some(merged) = Note::merged(mesh) {
        push_line(&mut text, "merged", &merged.to_string());
    }
    let open_edges = mesh.open_edges();
    if !mesh.faces.is_empty() {
        push_line(&mut text, "surface", &closedness(&open_edges));
    }
    let is_closed = !mesh.faces.is_empty() && open_edges.is_empty();
    let signed = mesh.signed_volume();
    let volume = match not_finite {
        Some(why) if !(is_closed && signed.is_finite()) => why,
        _ if is_closed => volume_text(signed),
        _ => "none: the faces do not enclose a body".into(),
    };
    push_line(&mut text, "volume", &volume);
    let check = body::solid_report(mesh, &BodyOptions::default());
    for (name, what) in solid::description_lines(mesh, &check) {
        push_line(&mut text, name, &what);
    }
    for (name, what) in part_lines(mesh, &check) {
        push_line(&mut text, name, &what);
    }
    // With tolerance 0 the error has the depth of the deepest face.
    match ConvexPolyhedron::from_mesh(&mesh.vertices, &mesh.faces, 0.0) {
        Ok(_) => push_line(&mut text, "convex", "yes, to rounding error"),
        Err(BuildError::NotConvex { face, depth, .. }) => {
            push_line(&mut text, "convex", &convexity_text(mesh, face, depth, convex_tolerance));
        }
        Err(error) => push_line(&mut text, "convex", &format!("no: {error}")),
    }
    match body::hull(mesh) {
        Ok(hull) => {
            push_line(&mut text, "hull", &hull_counts(&hull));
            push_line(&mut text, "hull volume", &volume_text(hull.volume()));
            let excess = Excess::measure(mesh, &hull);
            let tolerance = dent_tolerance(mesh, convex_tolerance);
            if !mesh.faces.is_empty() && !excess.is_within(tolerance, mesh.extent()) {
                push_line(&mut text, "hull exceeds", &excess.to_string());
            }
            let error = error_bound(hull.hull_error());
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

/// Returns lines about the parts into which `assembly` splits the mesh; none if it stays one part. `check` is the report
/// on the mesh as a solid.
fn part_lines(mesh: &Mesh, check: &SolidCheck) -> Vec<(&'static str, String)> {
    let mut lines = Vec::new();
    let named: Vec<String> = mesh.named_parts().into_iter().map(|(name, _)| name).collect();
    if !named.is_empty() {
        let more = if named.len() > MAX_NAMES { ", ..." } else { "" };
        let first = named[..named.len().min(MAX_NAMES)].join(", ");
        lines.push(("names", format!("{}: {}{more}", named.len(), escape_line(first))));
    }
    let is_one_shell = check.as_ref().is_ok_and(|(report, _)| report.shells.len() == 1);
    if !is_one_shell && let Ok(Some(split)) = body::split_bodies(mesh, &BodyOptions::default()) {
        let what = format!("{}, split with `assembly --split bodies`", split.meshes.len());
        lines.push(("bodies", what));
    }
    lines
}

/// Returns the number of vertices, and of those in no face.
fn vertex_count(mesh: &Mesh) -> String {
    match mesh.stray_vertices() {
        0 => mesh.vertices.len().to_string(),
        unused => {
            format!("{}, {unused} of them in no face", mesh.vertices.len())
        }
    }
}

/// Returns the depth below the hull to which a mesh counts as convex.
fn dent_tolerance(mesh: &Mesh, convex_tolerance: Option<f64>) -> f64 {
    BodyOptions::default().with_convex_tolerance(convex_tolerance).convex_tolerance_of(mesh)
}

/// Returns the number of faces, and of triangles among them.
fn face_count(mesh: &Mesh) -> String {
    let count = mesh.faces.len();
    let triangles = mesh.faces.iter().filter(|f| f.len() == 3).count();
    let largest = mesh.faces.iter().map(Vec::len).max().unwrap_or(0);
    if count == 0 {
        "0 (a point cloud)".into()
    } else if triangles == count {
        format!("{count}, all triangles")
    } else {
        format!("{count}, {triangles} of them triangles, up to {largest} corners")
    }
}

/// Returns a volume with the digits that rounding leaves: it is a sum of many products.
fn volume_text(volume: f64) -> String {
    estimate(volume, 1e-13 * volume)
}

/// Describes whether the surface is closed, or one of its open edges.
fn closedness(open: &[[u32; 2]]) -> String {
    match open {
        [] => "closed".into(),
        [[a, b], ..] => format!(
            "not closed: {} no oppositely directed partner, one of them from vertex {a} to vertex {b}",
            count_text(open.len(), "edge has", "edges have")
        ),
    }
}

/// Describes the deepest dent of a mesh.
fn convexity_text(mesh: &Mesh, face: usize, depth: f64, convex_tolerance: Option<f64>) -> String {
    let tolerance = dent_tolerance(mesh, convex_tolerance);
    let relative = depth / mesh.extent();
    let verdict = if depth <= tolerance {
        "yes, within tolerance"
    } else {
        "no; `clearance` accepts it, --hull takes its hull"
    };
    format!(
        "{verdict}: face {face} lies {} below the hull, {} of the extent (tolerated: {})",
        six_digits(depth),
        error_bound(relative),
        error_bound(tolerance)
    )
}

/// Describes the dimension, the vertices, the edges and the faces of a hull.
fn hull_counts(hull: &ConvexPolyhedron) -> String {
    let shape = match hull.dimension() {
        0 => "a point: ",
        1 => "a segment: ",
        2 => "flat: ",
        _ => "",
    };
    format!(
        "{shape}{}, {}, {}",
        count_text(hull.vertices().len(), "vertex", "vertices"),
        count_text(hull.edge_count(), "edge", "edges"),
        count_text(hull.face_count(), "face", "faces")
    )
}
