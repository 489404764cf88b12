//! Reads glTF and GLB: each node with a mesh is a part, in metres, with the transforms of the node and its
//! ancestors.
//!
//! Hidden nodes are left out. Files that `colltrans.step` has converted can mark a node whose meshes form one part, and
//! can name the unit of the original file, in which the parts are then returned. Vertices that differ only in normal or
//! texture coordinates are welded, because glTF stores them separately. Textures and animations are ignored. A part has
//! one colour, that of the material of its largest primitive. Offsets, strides and counts are checked against the
//! available bytes before use.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use colltrans_mesh::words::first_named;
use colltrans_mesh::{Mesh, NumberFormat};
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;

use super::files::{Source, decode_percent, decode_uri};
use super::{Budget, Draft, Names, Placed, assemble, contents_error, drafts, json_error_reason};
use crate::error::ReadError;
use colltrans_assembly::Assembly;
use colltrans_assembly::colour::linear_to_srgb;

/// Maximum depth of nested nodes. Deeper ones are rejected as a possible cycle.
const MAX_DEPTH: usize = 256;
/// Prefixes of the names of supported extensions: those without shapes, quantised positions, and hidden nodes.
const SUPPORTED_EXTENSIONS: [&str; 8] = [
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "KHR_lights_",
    "KHR_xmp",
    "KHR_animation_",
    "KHR_mesh_quantization",
    VISIBILITY,
];
/// The extension that hides a node and all nodes below it.
const VISIBILITY: &str = "KHR_node_visibility";

/// Reads the assembly of a glTF or GLB file.
pub(super) fn read_gltf(source: Source, bytes: &[u8]) -> Result<Assembly, ReadError> {
    let path = source.path;
    let refused = |reason: String| contents_error(path, "glTF", reason);
    let (json, binary) = split_chunks(bytes).map_err(refused)?;
    let document: Document =
        serde_json::from_slice(json).map_err(|e| refused(json_error_reason(&e)))?;
    document.check_support().map_err(refused)?;
    let buffers = read_buffers(&source, &document, binary)?;
    let size = bytes.len() + buffers.iter().map(Vec::len).sum::<usize>();
    let scene = document.scenes.get(document.scene.unwrap_or(0));
    let scene =
        scene.ok_or_else(|| contents_error(path, "scenes", "the default scene does not exist"))?;
    let budget = Budget::with_bytes(size);
    let frame = document.asset.extras.original_frame();
    let (shown, left_out) = (Vec::new(), Vec::new());
    let mut reader = Reader { path, document: &document, buffers, budget, shown, left_out };
    for &node in &scene.nodes {
        reader.collect_node(node, frame.world, 0, None)?;
    }
    let (drafts, left_out) = reader.build_drafts(frame.per_metre)?;
    let holds = format!(
        "none of its {} nodes places a mesh of triangles; it has {} meshes",
        document.nodes.len(),
        document.meshes.len()
    );
    let mut assembly = assemble(source, drafts, &holds)?.with_unit(frame.unit).with_up(frame.up);
    for note in document.asset.extras.notes() {
        assembly = assembly.with_note(note);
    }
    let unplaced = document.unplaced_names(scene);
    if !unplaced.is_empty() {
        let named = first_named(&unplaced, drafts::MOST_NAMED);
        assembly =
            assembly.with_note(format!("left out because they are not in the scene: {named}"));
    }
    if !left_out.is_empty() {
        assembly =
            assembly.with_note(format!("left out: {}", first_named(&left_out, drafts::MOST_NAMED)));
    }
    let shaped = document.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let at_rest = shaped.filter(|shape| !shape.targets.is_empty()).count()
        + document.nodes.iter().filter(|node| node.skin.is_some()).count();
    Ok(if at_rest == 0 {
        assembly
    } else {
        assembly.with_note("morph targets and skins are ignored: meshes have their rest shape")
    })
}

/// Returns the JSON text, and the binary chunk of a GLB file if it has one.
fn split_chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), None));
    }
    let word = |at: usize| {
        let word = bytes.get(at..)?.first_chunk::<4>()?;
        Some(u32::from_le_bytes(*word) as usize)
    };
    let short = || "the file is truncated".to_owned();
    let (version, length) = (word(4).ok_or_else(short)?, word(8).ok_or_else(short)?);
    if version != 2 {
        return Err(format!("GLB version {version} is not supported; accepted: 2"));
    }
    if length > bytes.len() {
        return Err(format!("the file is truncated: {} bytes, expected {length}", bytes.len()));
    }
    let chunk = |at: usize| {
        let size = word(at)?;
        let data = bytes.get(at + 8..length)?.get(..size)?;
        Some((bytes.get(at + 4..at + 8)?, data))
    };
    let Some((b"JSON", json)) = chunk(12) else { return Err("the first chunk is not JSON".into()) };
    let next = 12 + 8 + json.len().next_multiple_of(4);
    let binary = match chunk(next) {
        Some((b"BIN\0", data)) => Some(data),
        _ if next + 8 <= length && bytes.get(next + 4..next + 8) == Some(b"BIN\0") => {
            return Err("the binary chunk is truncated".into());
        }
        _ => None,
    };
    Ok((json, binary))
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", expecting = "an object (glTF document)")]
struct Document {
    asset: Asset,
    scene: Option<usize>,
    #[serde(default)]
    scenes: Vec<Scene>,
    #[serde(default)]
    nodes: Vec<Node>,
    #[serde(default)]
    meshes: Vec<Shape>,
    #[serde(default)]
    accessors: Vec<Accessor>,
    #[serde(default)]
    buffer_views: Vec<BufferView>,
    #[serde(default)]
    buffers: Vec<Buffer>,
    #[serde(default)]
    materials: Vec<Value>,
    #[serde(default)]
    extensions_required: Vec<String>,
}

#[derive(Deserialize)]
#[serde(expecting = "an object with a version")]
struct Asset {
    version: String,
    #[serde(default)]
    extras: Extras,
}

/// The data that `colltrans.step` adds to a glTF file (`extras.colltrans`). Data of other writers are ignored.
#[derive(Deserialize, Default)]
#[serde(from = "Value")]
struct Extras(Value);

impl From<Value> for Extras {
    fn from(value: Value) -> Self {
        Self(value.get("colltrans").cloned().unwrap_or_default())
    }
}

/// The frame and unit of the file from which a glTF file was converted. Results are in this frame.
struct Frame {
    world: DAffine3,
    per_metre: f64,
    unit: String,
    up: DVec3,
}

impl Extras {
    /// Returns the frame of the original file, or that of glTF.
    fn original_frame(&self) -> Frame {
        let per_metre = self.0.get("per_metre").and_then(Value::as_f64);
        let unit = self.0.get("unit").and_then(Value::as_str);
        let (Some(per_metre), Some(unit)) = (per_metre.filter(|n| n.is_finite() && *n > 0.0), unit)
        else {
            let (world, unit) = (DAffine3::IDENTITY, "m".to_owned());
            return Frame { world, per_metre: 1.0, unit, up: DVec3::Y };
        };
        let up = match self.0.get("up").and_then(Value::as_str) {
            Some("z") => DVec3::Z,
            _ => DVec3::Y,
        };
        let world = DAffine3::from_scale(DVec3::splat(per_metre));
        Frame { world, per_metre, unit: unit.to_owned(), up }
    }

    /// Returns the notes of the converter.
    fn notes(&self) -> impl Iterator<Item = &str> {
        let notes = self.0.get("notes").and_then(Value::as_array);
        notes.into_iter().flatten().filter_map(Value::as_str)
    }

    /// Checks whether all meshes below a node form one part.
    fn is_part(&self) -> bool {
        self.0.get("part").and_then(Value::as_bool).unwrap_or(false)
    }

    /// Returns the chord error of a node's facets, in metres.
    fn chord_error(&self) -> Option<f64> {
        let error = self.0.get("chord_error").and_then(Value::as_f64)?;
        (error.is_finite() && error >= 0.0).then_some(error)
    }
}

#[derive(Deserialize)]
#[serde(expecting = "an object (scene)")]
struct Scene {
    #[serde(default)]
    nodes: Vec<usize>,
}

#[derive(Deserialize)]
#[serde(expecting = "an object (node)")]
struct Node {
    name: Option<String>,
    mesh: Option<usize>,
    skin: Option<usize>,
    #[serde(default)]
    children: Vec<usize>,
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
    #[serde(default)]
    extensions: serde_json::Map<String, Value>,
    #[serde(default)]
    extras: Extras,
}

#[derive(Deserialize)]
#[serde(expecting = "an object (mesh)")]
struct Shape {
    name: Option<String>,
    primitives: Vec<Primitive>,
}

#[derive(Deserialize)]
#[serde(expecting = "an object (primitive)")]
struct Primitive {
    attributes: Attributes,
    indices: Option<usize>,
    mode: Option<u32>,
    #[serde(default)]
    material: Value,
    #[serde(default)]
    targets: Vec<IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(expecting = "an object (attributes)")]
struct Attributes {
    #[serde(rename = "POSITION")]
    position: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", expecting = "an object (accessor)")]
struct Accessor {
    buffer_view: Option<usize>,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    count: usize,
    #[serde(rename = "type")]
    shape: String,
    #[serde(default)]
    normalized: bool,
    sparse: Option<Sparse>,
}

#[derive(Deserialize)]
#[serde(expecting = "an object (sparse data)")]
struct Sparse {
    count: usize,
    indices: SparseData,
    values: SparseData,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", expecting = "an object with the index of a buffer view")]
struct SparseData {
    buffer_view: usize,
    #[serde(default)]
    byte_offset: usize,
    component_type: Option<u32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", expecting = "an object (buffer view)")]
struct BufferView {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", expecting = "an object (buffer)")]
struct Buffer {
    byte_length: usize,
    uri: Option<String>,
}

impl Document {
    /// Checks the version and the required extensions.
    fn check_support(&self) -> Result<(), String> {
        if !self.asset.version.starts_with("2.") {
            return Err(format!(
                "glTF version {} is not supported; accepted: 2",
                self.asset.version
            ));
        }
        let known =
            |name: &String| SUPPORTED_EXTENSIONS.iter().any(|start| name.starts_with(start));
        match self.extensions_required.iter().find(|name| !known(name)) {
            Some(name) => Err(format!(
                "the required extension {name} is not supported; save the file without it, as plain \
                 meshes"
            )),
            None => Ok(()),
        }
    }
}

/// Returns the contents of all buffers.
fn read_buffers(
    source: &Source,
    document: &Document,
    binary: Option<&[u8]>,
) -> Result<Vec<Vec<u8>>, ReadError> {
    let read = |(k, buffer): (usize, &Buffer)| {
        let refused = |reason: String| contents_error(source.path, format!("buffer {k}"), reason);
        let bytes = match &buffer.uri {
            None if k == 0 => binary.map(<[u8]>::to_vec),
            None => None,
            Some(uri) => {
                if let Some(data) = uri.strip_prefix("data:") {
                    Some(decode_data_uri(data).map_err(refused)?)
                } else {
                    let name = decode_uri(uri).map_err(refused)?;
                    let file = source.open_reference(&name)?;
                    Some(file.ok_or_else(|| refused(format!("file {name} not found")))?.1)
                }
            }
        };
        let bytes = bytes.ok_or_else(|| refused("the binary chunk is missing".into()))?;
        if bytes.len() < buffer.byte_length {
            return Err(refused(format!("{} bytes, expected {}", bytes.len(), buffer.byte_length)));
        }
        Ok(bytes)
    };
    document.buffers.iter().enumerate().map(read).collect()
}

/// Decodes the text of a `data:` URI after `data:`.
fn decode_data_uri(data: &str) -> Result<Vec<u8>, String> {
    let (kind, text) =
        data.split_once(',').ok_or("invalid data URI: expected a comma before the data")?;
    if kind.ends_with(";base64") {
        return STANDARD.decode(text).map_err(|_| "invalid data URI: not base64".into());
    }
    decode_percent(text)
}

/// Reads the meshes of the scene.
struct Reader<'a> {
    path: &'a Path,
    document: &'a Document,
    buffers: Vec<Vec<u8>>,
    budget: Budget,
    shown: Vec<PlacedNode<'a>>,
    /// Names of the nodes that are left out, each with the reason.
    left_out: Vec<String>,
}

impl Document {
    /// Returns the names of the nodes with a mesh that are not in the scene.
    fn unplaced_names(&self, scene: &Scene) -> Vec<String> {
        let mut reached = vec![false; self.nodes.len()];
        let mut open = scene.nodes.clone();
        while let Some(index) = open.pop() {
            if let Some(false) = reached.get(index) {
                reached[index] = true;
                open.extend(&self.nodes[index].children);
            }
        }
        let nodes = self.nodes.iter().enumerate();
        let unplaced = nodes.filter(|(k, node)| node.mesh.is_some() && !reached[*k]);
        unplaced.map(|(k, node)| node.shown_name(k)).collect()
    }

    /// Returns the colour of the largest primitive of some meshes. `None` if its material has a texture or no
    /// base colour.
    fn main_colour(&self, meshes: impl Iterator<Item = usize>) -> Option<[f64; 3]> {
        let count = |accessor: Option<usize>| Some(self.accessors.get(accessor?)?.count);
        let size = |shape: &&Primitive| {
            count(shape.indices).or_else(|| count(shape.attributes.position)).unwrap_or(0)
        };
        let shapes = meshes.flat_map(|mesh| &self.meshes[mesh].primitives);
        // If sizes are equal, the first one.
        let largest = shapes.reduce(|a, b| if size(&b) > size(&a) { b } else { a })?;
        let number = usize::try_from(largest.material.as_u64()?).ok()?;
        let look = self.materials.get(number)?.get("pbrMetallicRoughness")?;
        if look.get("baseColorTexture").is_some() {
            return None;
        }
        let factor = look.get("baseColorFactor")?.as_array()?;
        let channel = |k: usize| Some(linear_to_srgb(factor.get(k)?.as_f64()?.clamp(0.0, 1.0)));
        Some([channel(0)?, channel(1)?, channel(2)?])
    }
}

/// A part: the mesh of a node, or all meshes below it.
struct PlacedNode<'a> {
    node: usize,
    name: Option<&'a str>,
    meshes: Vec<(usize, DAffine3)>,
}

impl Reader<'_> {
    /// Collects the meshes of a node and of all nodes below it. `whole` is the index of the part to which they
    /// belong, if a node above is marked as one part.
    fn collect_node(
        &mut self,
        index: usize,
        above: DAffine3,
        depth: usize,
        mut whole: Option<usize>,
    ) -> Result<(), ReadError> {
        let refused = |reason: String| contents_error(self.path, format!("node {index}"), reason);
        let document = self.document;
        let node = document.nodes.get(index);
        let node = node.ok_or_else(|| refused(unknown("node", index, document.nodes.len())))?;
        if depth > MAX_DEPTH {
            return Err(refused(format!(
                "nodes are nested deeper than {MAX_DEPTH}, or in a cycle"
            )));
        }
        self.budget.count_placed().map_err(refused)?;
        if node.is_hidden() {
            self.left_out.push(format!("{} (hidden)", node.shown_name(index)));
            return Ok(());
        }
        let world = above * node.local_transform().map_err(refused)?;
        if whole.is_none() && node.extras.is_part() {
            whole = Some(self.shown.len());
            self.shown.push(PlacedNode { node: index, name: node.name(), meshes: Vec::new() });
        }
        if let Some(mesh) = node.mesh {
            let shape = document.meshes.get(mesh);
            let shape =
                shape.ok_or_else(|| refused(unknown("mesh", mesh, document.meshes.len())))?;
            if let Some(name) = node.extensions.keys().find(|name| name.contains("instancing")) {
                return Err(refused(format!(
                    "instances of {name} are not supported; save the copies as nodes"
                )));
            }
            if let Some(whole) = whole {
                self.shown[whole].meshes.push((mesh, world));
            } else {
                let name = node.name().or(shape.name.as_deref().filter(|name| is_name(name)));
                self.shown.push(PlacedNode { node: index, name, meshes: vec![(mesh, world)] });
            }
        }
        for &child in &node.children {
            self.collect_node(child, world, depth + 1, whole)?;
        }
        Ok(())
    }

    /// Builds a draft for each part. Each mesh is read once, and all are counted before the first part is
    /// built. Also returns the nodes that are left out.
    fn build_drafts(mut self, per_metre: f64) -> Result<(Vec<Draft>, Vec<String>), ReadError> {
        let mut budget = std::mem::take(&mut self.budget);
        let mut meshes: HashMap<usize, Arc<Mesh>> = HashMap::new();
        let placed = self.shown.iter().flat_map(|s| s.meshes.iter().map(|(m, _)| (s.node, *m)));
        for (node, mesh) in placed {
            let place = || format!("node {node}, mesh {mesh}");
            let refused = |reason| contents_error(self.path, place(), reason);
            if let Some(known) = meshes.get(&mesh) {
                budget.count_facets(known.faces.len()).map_err(refused)?;
            } else {
                let shape = &self.document.meshes[mesh];
                let read = self.read_mesh(shape, &mut budget).map_err(refused)?;
                meshes.insert(mesh, Arc::new(read.weld()));
            }
        }
        let (mut drafts, mut names) = (Vec::new(), Names::default());
        for PlacedNode { node, name, meshes: shown } in std::mem::take(&mut self.shown) {
            let colour = self.document.main_colour(shown.iter().map(|(mesh, _)| *mesh));
            let placed = |(mesh, world)| Placed { mesh: Arc::clone(&meshes[&mesh]), world };
            let pieces: Vec<Placed> = shown.into_iter().map(placed).collect();
            let pieces: Vec<Placed> =
                pieces.into_iter().filter(|placed| !placed.mesh.faces.is_empty()).collect();
            let name = name.map_or(format!("node {node}"), str::to_owned);
            if pieces.is_empty() {
                self.left_out.push(format!("{name} (no triangles)"));
                continue;
            }
            let name = names.unique_name(&name);
            let extras = &self.document.nodes[node].extras;
            let chord_error = extras.chord_error().map(|error| error * per_metre);
            let draft = Draft { chord_error, colour, ..Draft::new(name, pieces) };
            drafts.push(if extras.is_part() { draft.marked_as_one_part() } else { draft });
        }
        Ok((drafts, self.left_out))
    }

    /// Returns the triangles of all primitives of a mesh.
    fn read_mesh(&self, shape: &Shape, budget: &mut Budget) -> Result<Mesh, String> {
        let mut merged = Mesh::default();
        for primitive in &shape.primitives {
            let Some(position) = primitive.attributes.position else { continue };
            let positions = self.accessor_values(position, "positions", "VEC3")?;
            let count = positions.count as u32;
            let indices: Vec<u32> = match primitive.indices {
                None => (0..count).collect(),
                Some(index) => self.accessor_values(index, "indices", "SCALAR")?.integers()?,
            };
            if let Some(beyond) = indices.iter().find(|&&k| k >= count) {
                return Err(format!(
                    "vertex index {beyond} is out of range; there are {count} vertices"
                ));
            }
            let faces = primitive_triangles(primitive.mode.unwrap_or(4), &indices)?;
            budget.count_facets(faces.len())?;
            // Primitives may share vertices. Only the vertices in use are copied, in their order.
            let mut used = indices;
            used.sort_unstable();
            used.dedup();
            let base = merged.vertices.len() as u32;
            let name = |k: u32| base + used.partition_point(|&u| u < k) as u32;
            merged.faces.extend(faces.into_iter().map(|t| t.map(name).to_vec()));
            merged.vertices.extend(used.iter().map(|&k| positions.vector_at(k as usize)));
        }
        Ok(merged.with_format(NumberFormat::Single))
    }

    /// Returns the values of an accessor, after checking that all their bytes exist.
    fn accessor_values(
        &self,
        index: usize,
        what: &'static str,
        shape: &str,
    ) -> Result<AccessorValues<'_>, String> {
        let accessors = &self.document.accessors;
        let missing = || format!("{what}: {}", unknown("accessor", index, accessors.len()));
        let accessor = accessors.get(index).ok_or_else(missing)?;
        if accessor.shape != shape {
            return Err(format!("{what} have type {}, expected {shape}", accessor.shape));
        }
        let kind = ComponentType::from_code(accessor.component_type, what)?;
        let width = if shape == "VEC3" { 3 } else { 1 };
        let size = width * kind.size();
        let count = accessor.count;
        u32::try_from(count)
            .map_err(|_| format!("{count} {what} are too many; accepted: less than 2^32"))?;
        let Some(view) = accessor.buffer_view else {
            return Err(format!("{what} without a buffer view are not supported"));
        };
        let (bytes, stride) = self.element_bytes(view, accessor.byte_offset, count, size, what)?;
        let replaced = match &accessor.sparse {
            Some(sparse) => self.sparse_elements(sparse, count, size, what)?,
            None => Vec::new(),
        };
        let normalized = accessor.normalized;
        Ok(AccessorValues { bytes, stride, count, kind, normalized, replaced, what })
    }

    /// Returns the bytes of a view from an offset on, which contain `count` elements of `size` bytes, and the
    /// stride.
    fn element_bytes(
        &self,
        view: usize,
        offset: usize,
        count: usize,
        size: usize,
        what: &str,
    ) -> Result<(&[u8], usize), String> {
        let views = &self.document.buffer_views;
        let missing = || format!("{what}: {}", unknown("buffer view", view, views.len()));
        let view = views.get(view).ok_or_else(missing)?;
        let stride = view.byte_stride.unwrap_or(size);
        if stride < size {
            return Err(format!(
                "{what} of {size} bytes have a stride of {stride} bytes; accepted: at least {size}"
            ));
        }
        let beyond = || format!("{what} extend beyond their buffer");
        let buffer = self.buffers.get(view.buffer).ok_or_else(beyond)?;
        let of_view = buffer.get(view.byte_offset..).and_then(|rest| rest.get(..view.byte_length));
        let bytes = of_view.and_then(|bytes| bytes.get(offset..)).ok_or_else(beyond)?;
        let needed = match count.checked_sub(1) {
            None => Some(0),
            Some(last) => last.checked_mul(stride).and_then(|bytes| bytes.checked_add(size)),
        };
        needed.filter(|needed| *needed <= bytes.len()).ok_or_else(beyond)?;
        Ok((bytes, stride))
    }

    /// Returns the elements that replace others, in increasing order of their indices.
    fn sparse_elements(
        &self,
        sparse: &Sparse,
        count: usize,
        size: usize,
        what: &'static str,
    ) -> Result<Vec<(u32, &[u8])>, String> {
        let n = sparse.count;
        if n > count {
            return Err(format!("{n} sparse {what} replace only {count} elements"));
        }
        let SparseData { buffer_view, byte_offset, component_type } = sparse.indices;
        let kind = ComponentType::from_code(component_type.unwrap_or(0), what)?;
        let (bytes, stride) = self.element_bytes(buffer_view, byte_offset, n, kind.size(), what)?;
        let (normalized, replaced) = (false, Vec::new());
        let numbers = AccessorValues { bytes, stride, count: n, kind, normalized, replaced, what };
        let numbers = numbers.integers()?;
        if !numbers.is_sorted_by(|a, b| a < b)
            || numbers.last().is_some_and(|&k| k as usize >= count)
        {
            return Err(format!("indices of sparse {what} must be increasing and below {count}"));
        }
        let SparseData { buffer_view, byte_offset, .. } = sparse.values;
        let (bytes, stride) = self.element_bytes(buffer_view, byte_offset, n, size, what)?;
        let value = |(k, number): (usize, u32)| (number, &bytes[k * stride..k * stride + size]);
        Ok(numbers.into_iter().enumerate().map(value).collect())
    }
}

/// Checks whether a name is more than blanks.
fn is_name(name: &str) -> bool {
    !name.trim().is_empty()
}

impl Node {
    /// Returns the name of the node; `None` if it is missing or blank.
    fn name(&self) -> Option<&str> {
        self.name.as_deref().filter(|name| is_name(name))
    }

    /// Returns the name of the node, or its number.
    fn shown_name(&self, index: usize) -> String {
        self.name().map_or(format!("node {index}"), str::to_owned)
    }

    /// Checks whether the file hides the node.
    fn is_hidden(&self) -> bool {
        let visibility = self.extensions.get(VISIBILITY);
        visibility.and_then(|it| it.get("visible")).and_then(Value::as_bool) == Some(false)
    }

    /// Returns the transform of the node relative to its parent.
    fn local_transform(&self) -> Result<DAffine3, String> {
        let transform = if let Some(columns) = &self.matrix {
            DAffine3::from_mat4(DMat4::from_cols_array(columns))
        } else {
            let turn = DQuat::from_array(self.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
            let turn = DMat3::from_quat(turn.normalize());
            let scale = DVec3::from_array(self.scale.unwrap_or([1.0; 3]));
            let at = DVec3::from_array(self.translation.unwrap_or_default());
            DAffine3::from_mat3_translation(turn * DMat3::from_diagonal(scale), at)
        };
        if transform.is_finite() {
            Ok(transform)
        } else {
            Err("its transform is not finite, or its rotation is zero".into())
        }
    }
}

/// The component type of an accessor.
#[derive(Clone, Copy, PartialEq)]
enum ComponentType {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl ComponentType {
    /// Parses the code of a component type.
    fn from_code(code: u32, what: &str) -> Result<Self, String> {
        Ok(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return Err(format!("{what} have the unknown component type {code}")),
        })
    }

    /// Returns the size in bytes.
    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// Returns the largest integer, which represents 1 in normalised values.
    fn largest_value(self) -> f64 {
        match self {
            Self::I8 => f64::from(i8::MAX),
            Self::U8 => f64::from(u8::MAX),
            Self::I16 => f64::from(i16::MAX),
            Self::U16 => f64::from(u16::MAX),
            Self::U32 => f64::from(u32::MAX),
            Self::F32 => 1.0,
        }
    }

    /// Decodes the first number in some bytes.
    fn number(self, bytes: &[u8]) -> f64 {
        match (self, bytes) {
            (Self::I8, [a, ..]) => f64::from(*a as i8),
            (Self::U8, [a, ..]) => f64::from(*a),
            (Self::I16, [a, b, ..]) => f64::from(i16::from_le_bytes([*a, *b])),
            (Self::U16, [a, b, ..]) => f64::from(u16::from_le_bytes([*a, *b])),
            (Self::U32, [a, b, c, d, ..]) => f64::from(u32::from_le_bytes([*a, *b, *c, *d])),
            (Self::F32, [a, b, c, d, ..]) => f64::from(f32::from_le_bytes([*a, *b, *c, *d])),
            // Unreachable: `element_bytes` checked that the bytes exist.
            _ => f64::NAN,
        }
    }
}

/// The values of an accessor, all of whose bytes exist.
struct AccessorValues<'a> {
    bytes: &'a [u8],
    stride: usize,
    count: usize,
    kind: ComponentType,
    normalized: bool,
    /// The elements that replace others, by increasing index.
    replaced: Vec<(u32, &'a [u8])>,
    what: &'static str,
}

impl AccessorValues<'_> {
    /// Returns the bytes from element `k` on.
    fn element_at(&self, k: usize) -> &[u8] {
        match self.replaced.binary_search_by_key(&(k as u32), |r| r.0) {
            Ok(found) => self.replaced[found].1,
            Err(_) => &self.bytes[k * self.stride..],
        }
    }

    /// Returns element `k` as a vector.
    fn vector_at(&self, k: usize) -> DVec3 {
        let element = self.element_at(k);
        let scale = if self.normalized { self.kind.largest_value() } else { 1.0 };
        let number = |j: usize| {
            let number = self.kind.number(&element[j * self.kind.size()..]) / scale;
            if self.normalized { number.max(-1.0) } else { number }
        };
        DVec3::new(number(0), number(1), number(2))
    }

    /// Returns all elements as integers.
    fn integers(&self) -> Result<Vec<u32>, String> {
        if !matches!(self.kind, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) {
            return Err(format!("{} are not unsigned integers", self.what));
        }
        Ok((0..self.count).map(|k| self.kind.number(self.element_at(k)) as u32).collect())
    }
}

/// Returns the triangles of a list, strip or fan. Points and lines have none.
fn primitive_triangles(mode: u32, indices: &[u32]) -> Result<Vec<[u32; 3]>, String> {
    Ok(match mode {
        0..=3 => Vec::new(),
        4 if !indices.len().is_multiple_of(3) => {
            return Err(format!("{} indices are not a multiple of 3", indices.len()));
        }
        4 => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        5 => {
            let turned = |(k, t): (usize, &[u32])| {
                if k % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] }
            };
            indices.windows(3).enumerate().map(turned).collect()
        }
        6 => match indices {
            [center, rim @ ..] => rim.windows(2).map(|e| [*center, e[0], e[1]]).collect(),
            [] => Vec::new(),
        },
        _ => return Err(format!("unknown primitive mode {mode}; accepted: 0 to 6")),
    })
}

/// Returns the message that the document has no object of a kind with an index.
fn unknown(kind: &str, index: usize, count: usize) -> String {
    format!("unknown {kind} {index}; the file has {count}, numbered from 0")
}
