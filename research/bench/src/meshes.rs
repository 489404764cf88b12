//! Makes or reads pairs of non-convex meshes, for the programs that measure solids.

use std::path::{Path, PathBuf};

use clap::Args;
use colltrans::{Aabb, Solid};
use colltrans_testkit::shapes::Mesh;

/// The folder of meshes, and the selection of pairs.
#[derive(Debug, Args)]
pub struct MeshArguments {
    /// Folder with `trimesh/teapot.stl`, `gearbox/key.stl` and similar files
    #[arg(long, value_name = "DIR", default_value = "../shared/data")]
    data: PathBuf,
    /// Measure only rows whose names contain this text
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
}

impl MeshArguments {
    /// Whether a row with this name is selected.
    pub fn is_selected(&self, name: &str) -> bool {
        self.only.as_ref().is_none_or(|only| name.contains(only.as_str()))
    }

    /// Returns the selected pairs, each mesh centred on its box: first the given ones, then those read from
    /// files. Missing files are skipped, invalid ones with a message.
    pub fn pairs(
        &self,
        made: Vec<(&str, [Mesh; 2])>,
        files: &[[&str; 2]],
    ) -> Vec<(String, [Mesh; 2])> {
        let folder = self.data.join("trimesh");
        let read = |[a, b]: &[&str; 2]| {
            let name = [a, b].map(|file| file.rsplit('/').next().unwrap_or(file)).join(" x ");
            self.is_selected(&name).then(|| {
                Some((
                    name,
                    [read_mesh(&folder.join(a))?, read_mesh(&folder.join(b))?].map(center_on_box),
                ))
            })?
        };
        let made = made.into_iter().filter(|(name, _)| self.is_selected(name));
        let made = made.map(|(name, meshes)| (name.to_owned(), meshes.map(center_on_box)));
        made.chain(files.iter().filter_map(read)).collect()
    }
}

/// Reads a mesh; `None` if it is missing or invalid.
fn read_mesh(path: &Path) -> Option<Mesh> {
    if !path.exists() {
        return None;
    }
    match colltrans_mesh::read(path) {
        Ok(mesh) => Some(Mesh { vertices: mesh.vertices, faces: mesh.faces }),
        Err(error) => {
            eprintln!("{error}");
            None
        }
    }
}

/// Moves the centre of the mesh's box to the origin.
fn center_on_box(mesh: Mesh) -> Mesh {
    let middle = Aabb::from_points(mesh.vertices.iter().copied()).center();
    mesh.translated(-middle)
}

/// Builds a closed solid, or an open surface if the mesh is not closed.
pub fn solid_from_mesh(mesh: &Mesh) -> Option<Solid> {
    Solid::from_mesh(&mesh.vertices, &mesh.faces)
        .or_else(|_| Solid::from_open_mesh(&mesh.vertices, &mesh.faces))
        .map_err(|error| eprintln!("{error}"))
        .ok()
}
