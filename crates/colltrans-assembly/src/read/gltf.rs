//! glTF and GLB: every node with a mesh is a part, in metres, its transform and those above applied.
//!
//! Vertices of one place that differ in normal or texture are welded: glTF stores them apart.

use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use colltrans_mesh::Mesh;
use glam::{DAffine3, DMat4, DVec3, Vec3};
use gltf::buffer::Source;
use gltf::mesh::Mode;
use gltf::{Document, Gltf, Node};

use super::{Names, assembled, contents, in_file, io, or_noted, placed_one_more};
use crate::error::ReadError;
use crate::part::{Assembly, Part, Piece};

#[cfg(feature = "files")]
pub(super) fn read(path: &Path) -> Result<Assembly, ReadError> {
    parse(path, &std::fs::read(path).map_err(io(path))?)
}

pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Assembly, ReadError> {
    let Gltf { document, blob } = Gltf::from_slice(bytes).map_err(|e| contents(path, "glTF", e))?;
    let buffers = buffers(path, &document, blob)?;
    let files = document.buffers().filter_map(|b| file_of(path, &b)).collect();
    let scene = document.default_scene().or_else(|| document.scenes().next());
    let Some(scene) = scene else { return Err(contents(path, "scenes", "there is no scene")) };
    let mut reader =
        Reader { path, buffers, parts: Vec::new(), names: Names::default(), placed: 0 };
    for node in scene.nodes() {
        reader.node(&node, DAffine3::IDENTITY, 0)?;
    }
    Ok(or_noted(assembled(path, reader.parts, files)?.with_unit("m")))
}

/// The file of a buffer that has one of its own.
fn file_of(path: &Path, buffer: &gltf::Buffer) -> Option<PathBuf> {
    let Source::Uri(uri) = buffer.source() else { return None };
    let folder = path.parent().unwrap_or(Path::new("."));
    (!uri.starts_with("data:")).then(|| folder.join(uri))
}

fn buffers(
    path: &Path,
    document: &Document,
    mut blob: Option<Vec<u8>>,
) -> Result<Vec<Vec<u8>>, ReadError> {
    let read = |buffer: gltf::Buffer| {
        let place = format!("buffer {}", buffer.index());
        let bytes = match buffer.source() {
            Source::Bin => {
                blob.take().ok_or_else(|| contents(path, &place, "the binary chunk is missing"))?
            }
            Source::Uri(uri) => {
                if let Some(data) = uri.strip_prefix("data:") {
                    let text = data.split_once(";base64,").map_or(data, |(_, text)| text);
                    STANDARD.decode(text).map_err(|e| contents(path, &place, e))?
                } else {
                    let file = file_of(path, &buffer).unwrap_or_default();
                    std::fs::read(&file).map_err(io(&file))?
                }
            }
        };
        if bytes.len() < buffer.length() {
            let reason = format!("has {} bytes of {}", bytes.len(), buffer.length());
            return Err(contents(path, &place, reason));
        }
        Ok(bytes)
    };
    document.buffers().map(read).collect()
}

/// Nodes nested deeper than this are a ring.
const DEEPEST: usize = 256;

struct Reader<'a> {
    path: &'a Path,
    buffers: Vec<Vec<u8>>,
    parts: Vec<Part>,
    names: Names,
    placed: usize,
}

impl Reader<'_> {
    fn node(&mut self, node: &Node, above: DAffine3, depth: usize) -> Result<(), ReadError> {
        let place = format!("node {}", node.index());
        if depth > DEEPEST {
            return Err(contents(self.path, place, "nodes are nested too deep, or in a ring"));
        }
        placed_one_more(&mut self.placed).map_err(|e| contents(self.path, &place, e))?;
        let columns = node.transform().matrix().map(|c| c.map(f64::from));
        let world = above * DAffine3::from_mat4(DMat4::from_cols_array_2d(&columns));
        if let Some(mesh) = node.mesh() {
            let name = node.name().or(mesh.name()).map_or(place.clone(), str::to_owned);
            let merged = self.mesh(&mesh, &place)?.weld();
            if !merged.faces.is_empty() {
                let name = self.names.unique(&name);
                let Mesh { vertices, faces, .. } = merged;
                let piece = Piece { vertices, faces, world_from_piece: world };
                self.parts.push(Part::new(name, &[piece]).map_err(in_file(self.path))?);
            }
        }
        for child in node.children() {
            self.node(&child, world, depth + 1)?;
        }
        Ok(())
    }

    /// The triangles of all primitives of a mesh.
    fn mesh(&self, mesh: &gltf::Mesh, place: &str) -> Result<Mesh, ReadError> {
        let refused =
            |reason: String| contents(self.path, format!("{place}, mesh {}", mesh.index()), reason);
        let mut merged = Mesh::default();
        for primitive in mesh.primitives() {
            let reader =
                primitive.reader(|buffer| self.buffers.get(buffer.index()).map(Vec::as_slice));
            let Some(accessor) = primitive.get(&gltf::Semantic::Positions) else { continue };
            let short = |what: &str| refused(format!("its {what} lie beyond their buffer"));
            let positions = reader.read_positions().ok_or_else(|| short("positions"))?;
            let base = merged.vertices.len() as u32;
            merged.vertices.extend(positions.map(|p| DVec3::from(Vec3::from(p))));
            let count = merged.vertices.len() as u32 - base;
            if count as usize != accessor.count() {
                return Err(short("positions"));
            }
            let indices: Vec<u32> = if primitive.indices().is_some() {
                let indices = reader.read_indices().ok_or_else(|| short("indices"))?;
                indices.into_u32().collect()
            } else {
                (0..count).collect()
            };
            if let Some(beyond) = indices.iter().find(|&&k| k >= count) {
                return Err(refused(format!("index {beyond} of only {count} vertices")));
            }
            if primitive.mode() == Mode::Triangles && !indices.len().is_multiple_of(3) {
                return Err(refused(format!("{} corners do not make triangles", indices.len())));
            }
            merged.faces.extend(
                triangles(primitive.mode(), &indices)
                    .into_iter()
                    .map(|t| t.map(|k| k + base).to_vec()),
            );
        }
        Ok(merged)
    }
}

/// Triangles, strips and fans; points and lines have no surface.
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::Triangles => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        Mode::TriangleStrip => {
            let turned = |(k, t): (usize, &[u32])| {
                if k % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] }
            };
            indices.windows(3).enumerate().map(turned).collect()
        }
        Mode::TriangleFan => match indices {
            [center, rim @ ..] => rim.windows(2).map(|e| [*center, e[0], e[1]]).collect(),
            [] => Vec::new(),
        },
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => Vec::new(),
    }
}
