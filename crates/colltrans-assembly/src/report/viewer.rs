//! The plan to look at from all sides, in the report: the parts as JSON and a script that draws them.
//!
//! The script, `assets/viewer.js`, is built from `web/src/viewer.ts` (`npm run viewer` in `web/`),
//! which also checks that it is what its source makes. It reads nothing but the page it is in.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use colltrans::Aabb;
use glam::DVec3;
use maud::{Markup, PreEscaped, html};
use serde_json::{Value, json};

use super::{Findings, arrow, kinds};
use crate::part::Part;

const SCRIPT: &str = include_str!("../../assets/viewer.js");
/// With more triangles the page would be large; the animation has them all.
const MOST_TRIANGLES: usize = 400_000;

/// A section of the report; empty without parts.
pub(super) fn section(f: &Findings) -> Markup {
    let parts = f.bodies.assembly().parts();
    if parts.is_empty() {
        return Markup::default();
    }
    let triangles: usize = parts.iter().map(Part::facets).sum();
    if triangles > MOST_TRIANGLES {
        return html! {
            p {
                "With " (triangles) " triangles the assembly is too large to be turned in this page: \
                 disassembly.glb shows the plan."
            }
        };
    }
    html! {
        div id="viewer" {}
        script type="application/json" id="viewer-data" { (script_data(&data(f))) }
        script { (PreEscaped(SCRIPT)) }
    }
}

/// JSON in which nothing can end the element that holds it, nor begin a comment there.
fn script_data(data: &Value) -> PreEscaped<String> {
    let text = data.to_string();
    PreEscaped(text.replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026"))
}

fn data(f: &Findings) -> Value {
    let assembly = f.bodies.assembly();
    let Aabb { low, high } = assembly.bounds();
    let (middle, size) = ((low + high) / 2.0, (high - low).length());
    let colours = kinds::colours(&f.plan, assembly.parts());
    let parts = assembly.parts().iter().zip(colours).map(|(p, colour)| part(p, colour, middle));
    let parts: Vec<Value> = parts.collect();
    let steps = f.plan.steps.iter().map(|step| {
        let legs = step
            .shown(0.35 * size)
            .map(|(leg, motion)| json!({ "parts": leg.parts, "way": motion.to_array() }));
        json!({
            "parts": step.parts,
            "legs": legs.collect::<Vec<_>>(),
            "moves": step.path.len(),
            "along": arrow(step.direction),
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

/// Vertices relative to the middle of the assembly, in single precision.
fn part(part: &Part, colour: [f64; 3], middle: DVec3) -> Value {
    let solid = part.solid();
    let places = solid.vertices().iter().flat_map(|v| (*v - middle).as_vec3().to_array());
    let vertices: Vec<u8> = places.flat_map(f32::to_le_bytes).collect();
    let corners = solid.triangles().iter().flatten();
    let triangles: Vec<u8> = corners.flat_map(|v| v.to_le_bytes()).collect();
    json!({
        "name": part.name(),
        "colour": colour,
        "fixed": part.fixed(),
        "vertices": STANDARD.encode(vertices),
        "triangles": STANDARD.encode(triangles),
    })
}
