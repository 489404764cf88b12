//! Bodies of the tests, from the test kit's meshes.

use colltrans_solid::Solid;
use colltrans_testkit::shapes::Mesh;

pub(crate) fn solid(mesh: &Mesh) -> Solid {
    Solid::from_mesh(&mesh.vertices, &mesh.faces).expect("a closed mesh")
}
