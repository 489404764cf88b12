//! An interactive view of the plan in the report: the parts as JSON, and a script that draws them.
//!
//! The script `assets/viewer.js` is built from `web/src/viewer.ts` (`npm run viewer` in `web/`). A check
//! there compares it with its source. It reads only the page that contains it.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use colltrans::Aabb;
use colltrans_mesh::plain::escape_control;
use glam::DVec3;
use maud::{Markup, PreEscaped, html};
use serde_json::{Value, json};

use super::{Analysis, direction_name, kinds};
use crate::part::Part;

/// Script of the viewer.
pub(super) const SCRIPT: &str = include_str!("../../assets/viewer.js");
/// Maximum number of triangles in the viewer, which bounds the size of the page.
pub(super) const MAX_TRIANGLES: usize = 400_000;

/// Returns the viewer, or a reference to the animation for large assemblies; empty without parts.
pub(super) fn viewer_section(f: &Analysis) -> Markup {
    let parts = f.bodies.assembly().parts();
    if parts.is_empty() {
        return Markup::default();
    }
    let triangles: usize = parts.iter().map(Part::facet_count).sum();
    if triangles > MAX_TRIANGLES {
        return html! {
            p {
                "With " (triangles) " triangles the assembly is too large to be turned in this page: \
                 disassembly.glb shows the plan."
            }
        };
    }
    html! {
        div id="viewer" {}
        script type="application/json" id="viewer-data" { (script_data(&viewer_data(f))) }
        script { (PreEscaped(SCRIPT)) }
    }
}

/// Returns JSON in which no text can end the surrounding element or begin a comment.
pub(super) fn script_data(data: &Value) -> PreEscaped<String> {
    let text = data.to_string();
    PreEscaped(text.replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026"))
}

/// Returns the data of the viewer: size, unit, parts and steps.
fn viewer_data(f: &Analysis) -> Value {
    let assembly = f.bodies.assembly();
    let Aabb { low, high } = assembly.bounds();
    let (middle, size) = ((low + high) / 2.0, (high - low).length());
    let colours = kinds::part_colours(&f.plan, assembly.parts());
    let parts =
        assembly.parts().iter().zip(colours).map(|(p, colour)| part_data(p, colour, middle));
    let parts: Vec<Value> = parts.collect();
    let steps = f.plan.steps.iter().map(|step| {
        let legs = step
            .displayed_legs(0.35 * size)
            .map(|(leg, motion)| json!({ "parts": leg.parts, "way": motion.to_array() }));
        json!({
            "parts": step.parts,
            "legs": legs.collect::<Vec<_>>(),
            "moves": step.path.len(),
            "along": direction_name(step.direction),
            "travel": step.travel.value,
        })
    });
    json!({
        "unit": assembly.unit().unwrap_or_default(),
        "size": size,
        "parts": parts,
        "steps": steps.collect::<Vec<_>>(),
    })
}

/// Returns a part: its name without characters that are invisible or reverse the text, vertices relative to the middle of
/// the assembly in single precision, and triangles, both in Base64.
pub(super) fn part_data(part: &Part, colour: [f64; 3], middle: DVec3) -> Value {
    let solid = part.solid();
    let places = solid.vertices().iter().flat_map(|v| (*v - middle).as_vec3().to_array());
    let vertices: Vec<u8> = places.flat_map(f32::to_le_bytes).collect();
    let corners = solid.triangles().iter().flatten();
    let triangles: Vec<u8> = corners.flat_map(|v| v.to_le_bytes()).collect();
    json!({
        "name": escape_control(part.name()),
        "colour": colour,
        "fixed": part.is_fixed(),
        "vertices": STANDARD.encode(vertices),
        "triangles": STANDARD.encode(triangles),
    })
}
