//! Bodies that names describe, such as `sphere:0.5`.

use colltrans::ConvexPolyhedron;
use colltrans_mesh::body;

/// Builds the body that a name describes, such as `sphere:0.5`. Returns `None` if bytes are attached or the name
/// begins with no known shape, so that it names a file.
pub(crate) fn body_of_name(name: &str, file: &[u8]) -> Option<Result<ConvexPolyhedron, String>> {
    let built = if file.is_empty() { body::body_of_name(name, 1.0)? } else { return None };
    Some(built.map_err(|error| error.to_string()))
}
