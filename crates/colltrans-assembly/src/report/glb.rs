//! The plan as an animated binary glTF: one node for each part, the steps one after another. Removed parts
//! stay removed.
//!
//! glTF uses metres and an upward `y`. The root node rotates and scales the assembly accordingly, so that an
//! assembly read from glTF keeps its pose.

use glam::{DQuat, DVec3};
use serde_json::{Value, json};

use super::kinds;
use crate::colour::srgb_to_linear;
use crate::part::{Assembly, Part};
use crate::plan::{Leg, Plan};
use crate::units;
use colltrans::Aabb;

/// Duration of a move in seconds.
const STEP: f64 = 1.6;
/// Pause before a step in seconds.
const PAUSE: f64 = 0.4;
/// Minimum duration of a turn in seconds.
const TURN: f64 = 0.5;
/// Number of keys of a turn.
const KEYS_PER_TURN: f64 = 64.0;
/// Minimum distance of removed parts beyond their travel, as a share of the assembly's size.
const MIN_PARKED_DISTANCE: f64 = 0.35;
/// Maximum number of steps, each of a tenth of the assembly's size, by which removed parts are moved farther
/// away.
const MAX_PARKING_STEPS: usize = 200;

/// Returns the bytes of the file.
pub fn plan_animation(assembly: &Assembly, plan: &Plan) -> Vec<u8> {
    let mut file = File::default();
    let Aabb { low, high } = assembly.bounds();
    let size = (high - low).length();
    // Lengths in an unknown unit are written unchanged.
    let per_unit = assembly.unit().and_then(units::unit_in_metres).unwrap_or(1.0);
    let mut nodes = Vec::new();
    let colours = kinds::part_colours(plan, assembly.parts());
    for (part, colour) in assembly.parts().iter().zip(colours) {
        let mesh = file.add_mesh(part, colour.map(srgb_to_linear));
        nodes.push(json!({ "name": part.name(), "mesh": mesh }));
    }
    let (channels, samplers) = animation_channels(&mut file, assembly, plan, size);
    let root = nodes.len();
    let children: Vec<usize> = (0..root).collect();
    // The upward direction becomes y.
    let turn = DQuat::from_rotation_arc(assembly.up(), DVec3::Y).to_array();
    nodes.push(json!({
        "name": "assembly",
        "children": children,
        "rotation": turn,
        "scale": [per_unit, per_unit, per_unit],
    }));
    if root == 0 {
        nodes[0].as_object_mut().map(|node| node.remove("children"));
    }
    let mut document = json!({
        "asset": { "version": "2.0", "generator": "colltrans" },
        "scene": 0,
        "scenes": [{ "nodes": [root] }],
        "nodes": nodes,
    });
    if !channels.is_empty() {
        document["animations"] =
            json!([{ "name": "disassembly", "channels": channels, "samplers": samplers }]);
    }
    file.finish(document)
}

/// Returns the channels and samplers of the animation: a translation for every part that moves, and a
/// rotation for those that turn.
fn animation_channels(
    file: &mut File,
    assembly: &Assembly,
    plan: &Plan,
    size: f64,
) -> (Vec<Value>, Vec<Value>) {
    let parked = parked_distances(assembly, plan, size);
    let (mut channels, mut samplers) = (Vec::new(), Vec::new());
    for part in 0..assembly.parts().len() {
        let (mut at, mut turned) = (DVec3::ZERO, DQuat::IDENTITY);
        let mut keys = vec![(0.0, at, turned)];
        let mut time = 0.0;
        for (k, step) in plan.steps.iter().enumerate() {
            time += PAUSE;
            for (leg, motion) in step.displayed_legs(parked[k]) {
                let seconds =
                    leg.turn.as_ref().map_or(STEP, |turn| STEP.max(TURN * turn.turns.abs()));
                if leg.parts.contains(&part) {
                    keys.push((time, at, turned));
                    let shares = leg
                        .turn
                        .as_ref()
                        .map_or(1.0, |turn| (KEYS_PER_TURN * turn.turns.abs()).ceil());
                    let before = (at, turned);
                    for share in (1..=shares as usize).map(|n| n as f64 / shares) {
                        (at, turned) = match &leg.turn {
                            None => (before.0 + motion, before.1),
                            Some(turn) => (
                                leg.move_point(before.0, share),
                                turn.rotation_at(leg, share) * before.1,
                            ),
                        };
                        keys.push((time + share * seconds, at, turned));
                    }
                }
                time += seconds;
            }
        }
        if keys.len() == 1 {
            continue;
        }
        let times: Vec<[f32; 1]> = keys.iter().map(|key| [key.0 as f32]).collect();
        let input = file.add_accessor(&times, "SCALAR", None);
        let places: Vec<[f32; 3]> = keys.iter().map(|key| key.1.as_vec3().to_array()).collect();
        let mut outputs = vec![("translation", file.add_accessor(&places, "VEC3", None))];
        if keys.iter().any(|key| key.2 != DQuat::IDENTITY) {
            let turns: Vec<[f32; 4]> = keys.iter().map(|key| key.2.as_quat().to_array()).collect();
            outputs.push(("rotation", file.add_accessor(&turns, "VEC4", None)));
        }
        for (path, output) in outputs {
            channels.push(json!({
                "sampler": samplers.len(),
                "target": { "node": part, "path": path },
            }));
            samplers.push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
        }
    }
    (channels, samplers)
}

/// Returns for each step the distance of its parts beyond their travel, such that parts of different steps
/// are not put in the same place.
fn parked_distances(assembly: &Assembly, plan: &Plan, size: f64) -> Vec<f64> {
    let mut distances = vec![0.0; plan.steps.len()];
    let mut taken: Vec<Aabb> = Vec::new();
    // Parts that are removed last stay nearest, so that no other part passes through them.
    for (k, step) in plan.steps.iter().enumerate().rev() {
        distances[k] = MIN_PARKED_DISTANCE * size;
        let boxes = step.parts.iter().map(|&p| assembly.parts()[p].bounds());
        let Some(group) = boxes.reduce(|a, b| a.union(&b)).filter(|_| step.group_step.is_none())
        else {
            continue;
        };
        // End position of the group's first part. The others end there too, apart from moves back.
        let own = |leg: &&Leg| leg.parts.contains(&step.parts[0]);
        let (last, before) = step.path.split_last().expect("a step has a move");
        let aside: DVec3 = before.iter().filter(own).map(|leg| leg.direction * leg.travel).sum();
        let at = |beyond: f64| {
            let by = aside + last.direction * (last.travel + beyond);
            Aabb { low: group.low + by, high: group.high + by }
        };
        for _ in 0..MAX_PARKING_STEPS {
            let wide = at(distances[k]).expanded(0.02 * size);
            if !taken.iter().any(|other| other.intersects(&wide)) {
                break;
            }
            distances[k] += 0.1 * size;
        }
        taken.push(at(distances[k]));
    }
    distances
}

/// A binary glTF file under construction.
#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
}

/// Target `ARRAY_BUFFER` of a buffer view.
const VERTICES: u32 = 34_962;
/// Component type `FLOAT`, single precision.
const FLOAT: u32 = 5_126;

impl File {
    /// Adds the mesh and material of a part, and returns the index of the mesh. Each triangle has its own
    /// vertices and normals, so that facets are flat.
    fn add_mesh(&mut self, part: &Part, color: [f64; 3]) -> usize {
        let solid = part.solid();
        let (mut places, mut normals) = (Vec::new(), Vec::new());
        for t in solid.triangles() {
            let [a, b, c] = t.map(|v| solid.vertices()[v as usize]);
            let normal = (b - a).cross(c - a).normalize_or(DVec3::Z).as_vec3().to_array();
            for corner in [a, b, c] {
                places.push(corner.as_vec3().to_array());
                normals.push(normal);
            }
        }
        let position = self.add_accessor(&places, "VEC3", Some(VERTICES));
        let normal = self.add_accessor(&normals, "VEC3", Some(VERTICES));
        let [r, g, b] = color;
        self.materials.push(json!({
            "pbrMetallicRoughness": {
                "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.1, "roughnessFactor": 0.7,
            },
            "doubleSided": !solid.is_closed(),
        }));
        let material = self.materials.len() - 1;
        self.meshes.push(json!({
            "name": part.name(),
            "primitives": [{
                "attributes": { "POSITION": position, "NORMAL": normal }, "material": material,
            }],
        }));
        self.meshes.len() - 1
    }

    /// Adds values to the buffer, and returns the index of their accessor.
    fn add_accessor<const N: usize>(
        &mut self,
        values: &[[f32; N]],
        kind: &str,
        target: Option<u32>,
    ) -> usize {
        let offset = self.bytes.len();
        let (mut low, mut high) = ([f32::INFINITY; N], [f32::NEG_INFINITY; N]);
        for value in values {
            for k in 0..N {
                low[k] = low[k].min(value[k]);
                high[k] = high[k].max(value[k]);
                self.bytes.extend(value[k].to_le_bytes());
            }
        }
        let mut view =
            json!({ "buffer": 0, "byteOffset": offset, "byteLength": self.bytes.len() - offset });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.views.push(view);
        self.accessors.push(json!({
            "bufferView": self.views.len() - 1,
            "componentType": FLOAT,
            "count": values.len(),
            "type": kind,
            "min": low.as_slice(),
            "max": high.as_slice(),
        }));
        self.accessors.len() - 1
    }

    /// Returns the bytes of the file: header, JSON chunk and binary chunk, the chunks padded to four bytes.
    fn finish(mut self, mut document: Value) -> Vec<u8> {
        if !self.meshes.is_empty() {
            document["meshes"] = json!(self.meshes);
            document["materials"] = json!(self.materials);
            document["accessors"] = json!(self.accessors);
            document["bufferViews"] = json!(self.views);
            document["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        }
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let binary = if self.bytes.is_empty() { 0 } else { 8 + self.bytes.len() };
        let length = 12 + 8 + text.len() + binary;
        let mut out = Vec::with_capacity(length);
        out.extend(b"glTF");
        out.extend(2_u32.to_le_bytes());
        out.extend((length as u32).to_le_bytes());
        out.extend((text.len() as u32).to_le_bytes());
        out.extend(b"JSON");
        out.extend(text);
        if binary > 0 {
            out.extend((self.bytes.len() as u32).to_le_bytes());
            out.extend(b"BIN\0");
            out.extend(self.bytes);
        }
        out
    }
}
