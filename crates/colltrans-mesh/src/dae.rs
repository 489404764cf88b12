//! Reads COLLADA (`.dae`) as used in robot packages: the geometry of the nodes in the scene.
//!
//! - Vertices are transformed by their node and its ancestors. Unit and axes are those of the file
//!   ([`Mesh::unit`], [`Mesh::up`]).
//! - Each node with geometry is a group with the name of the node.
//! - Triangles, strips, fans, `polylist` and `polygons` are read. Lines, materials, cameras, lights and
//!   animations are skipped. Skins have their rest shape.
//! - A few lines can place a shape arbitrarily often. Therefore the placed faces and the placed vertices are
//!   limited to one per byte of the file and [`MAX_REPEATED`] more.

use std::collections::HashMap;

use glam::{DAffine3, DMat3, DQuat, DVec3};

use crate::digits::{NumberFormat, Printed, largest_magnitude};
use crate::error::{Fault, Place};
use crate::mesh::Mesh;
use crate::text::{quoted, without_mark};
use crate::xml::Element;

/// Maximum number of placed faces or vertices beyond one per byte.
const MAX_REPEATED: usize = 1 << 23;
/// Maximum number of placed nodes.
const MAX_PLACED: usize = 1 << 16;
/// Maximum depth of nested nodes. Deeper ones are rejected as a possible cycle.
const MAX_DEPTH: usize = 64;

/// Parses a COLLADA file.
pub(crate) fn parse_dae(bytes: &[u8]) -> Result<Mesh, Fault> {
    let text = String::from_utf8_lossy(without_mark(bytes)?);
    let root = Element::parse(&text).map_err(|(place, what)| {
        let line = place.strip_prefix("line ").and_then(|line| line.parse().ok());
        Fault::new(line.map_or(Place::End, Place::Line), what)
    })?;
    if root.name != "COLLADA" {
        return Err(error_at(
            &root,
            format!("the root element is {}, expected COLLADA", quoted(&root.name)),
        ));
    }
    let mut reader = Reader {
        ids: HashMap::new(),
        shapes: HashMap::new(),
        placed: 0,
        faces_left: bytes.len() + MAX_REPEATED,
    };
    reader.index_ids(&root);
    let mut mesh = Mesh::default();
    (mesh.unit, mesh.up) = unit_and_up(&root)?;
    let scene =
        root.first_child("scene").and_then(|scene| scene.first_child("instance_visual_scene"));
    let scene = if let Some(shown) = scene {
        reader.referenced(shown)?
    } else {
        let library = root.first_child("library_visual_scenes");
        let first = library.and_then(|library| library.first_child("visual_scene"));
        first.ok_or_else(|| {
            error_at(
                &root,
                "the file has no scene, so it places no geometry; export it with a scene",
            )
        })?
    };
    for node in scene.children_named("node") {
        reader.add_node(node, DAffine3::IDENTITY, 0, &mut mesh)?;
    }
    mesh.groups = std::mem::take(&mut mesh.groups).unless_single();
    Ok(mesh)
}

/// Builds an error at the line of an element.
fn error_at(element: &Element, what: impl Into<String>) -> Fault {
    Fault::new(Place::Line(element.line), what)
}

/// Returns the unit in metres and the upward axis. Both are `None` without the element `asset`.
fn unit_and_up(root: &Element) -> Result<(Option<f64>, Option<DVec3>), Fault> {
    let Some(asset) = root.first_child("asset") else { return Ok((None, None)) };
    let unit = match asset.first_child("unit") {
        None => None,
        Some(unit) => {
            let metres =
                unit.numbers::<1>("meter").map_err(|e| error_at(unit, e))?.map(|[metres]| metres);
            if metres.is_some_and(|metres| !(metres.is_finite() && metres > 0.0)) {
                return Err(error_at(
                    unit,
                    "invalid unit; accepted: a finite positive number of metres",
                ));
            }
            metres
        }
    };
    let up = match asset.first_child("up_axis").map(|up| (up, up.text.trim())) {
        None | Some((_, "Y_UP")) => DVec3::Y,
        Some((_, "Z_UP")) => DVec3::Z,
        Some((_, "X_UP")) => DVec3::X,
        Some((up, other)) => {
            return Err(error_at(
                up,
                format!("unknown axis {}; accepted: X_UP, Y_UP, Z_UP", quoted(other)),
            ));
        }
    };
    // The defaults are metres and y.
    Ok((unit.or(Some(1.0)), Some(up)))
}

/// The vertices and faces of a geometry.
struct Shape {
    vertices: Vec<DVec3>,
    faces: Vec<Vec<u32>>,
    /// The number format of its coordinates before they are transformed, and the precision that follows.
    format: NumberFormat,
    precision: f64,
}

/// The state of reading a scene.
struct Reader<'a> {
    ids: HashMap<&'a str, &'a Element>,
    shapes: HashMap<*const Element, Shape>,
    placed: usize,
    /// Number of faces or vertices that may still be placed.
    faces_left: usize,
}

impl<'a> Reader<'a> {
    /// Records the ids of an element and its descendants.
    fn index_ids(&mut self, element: &'a Element) {
        if let Some(id) = element.get("id") {
            self.ids.entry(id).or_insert(element);
        }
        element.children.iter().for_each(|child| self.index_ids(child));
    }

    /// Returns the element to which the attribute `url` or `source` refers.
    fn referenced(&self, element: &Element) -> Result<&'a Element, Fault> {
        let name = element.get("url").or_else(|| element.get("source"));
        let name = name.ok_or_else(|| {
            error_at(element, format!("<{}> has neither url nor source", element.name))
        })?;
        let Some(id) = name.strip_prefix('#') else {
            return Err(error_at(
                element,
                format!(
                    "{} refers to another file, which is not supported; embed the geometry",
                    quoted(name)
                ),
            ));
        };
        let found = self.ids.get(id).copied();
        found.ok_or_else(|| error_at(element, format!("unknown id {}", quoted(name))))
    }

    /// Adds the faces of a node and its descendants.
    fn add_node(
        &mut self,
        node: &'a Element,
        above: DAffine3,
        depth: usize,
        mesh: &mut Mesh,
    ) -> Result<(), Fault> {
        self.placed += 1;
        if depth > MAX_DEPTH || self.placed > MAX_PLACED {
            return Err(error_at(
                node,
                format!(
                    "nodes are nested deeper than {MAX_DEPTH}, form a cycle, or are more than {MAX_PLACED}"
                ),
            ));
        }
        let world = above * node_transform(node)?;
        for child in &node.children {
            match child.name.as_str() {
                "instance_geometry" => {
                    let geometry = self.referenced(child)?;
                    self.add_geometry(geometry, child, world, mesh)?;
                }
                "instance_controller" => {
                    let controller = self.referenced(child)?;
                    let inner = controller
                        .children
                        .iter()
                        .find(|c| ["skin", "morph"].contains(&c.name.as_str()));
                    let inner = inner.ok_or_else(|| {
                        error_at(controller, "the controller has neither skin nor morph")
                    })?;
                    self.add_geometry(self.referenced(inner)?, child, world, mesh)?;
                }
                _ => {}
            }
        }
        // The node's own geometry forms its group, before the groups of its children begin.
        let name = node.get("name").or_else(|| node.get("id")).unwrap_or_default();
        mesh.groups.end_group(name, mesh.faces.len());
        for child in &node.children {
            match child.name.as_str() {
                "instance_node" => {
                    self.add_node(self.referenced(child)?, world, depth + 1, mesh)?;
                }
                "node" => self.add_node(child, world, depth + 1, mesh)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// Adds the faces of a geometry, transformed by `world`. The element `asked` is the place for errors.
    fn add_geometry(
        &mut self,
        geometry: &'a Element,
        asked: &Element,
        world: DAffine3,
        mesh: &mut Mesh,
    ) -> Result<(), Fault> {
        let key: *const Element = geometry;
        if !self.shapes.contains_key(&key) {
            let shape = match geometry.first_child("mesh") {
                Some(of) => self.read_shape(of)?,
                None if geometry.name == "geometry" => {
                    return Err(error_at(
                        geometry,
                        "unsupported geometry: not a polygon mesh; export it as polygons",
                    ));
                }
                None => {
                    return Err(error_at(
                        asked,
                        format!("it refers to {}, expected a geometry", quoted(&geometry.name)),
                    ));
                }
            };
            self.shapes.insert(key, shape);
        }
        let Shape { vertices, faces, format, precision } = &self.shapes[&key];
        let count = faces.len().max(vertices.len());
        let too_many = || {
            error_at(
                asked,
                format!(
                    "too many placed faces or vertices; accepted: one per byte and {MAX_REPEATED} more"
                ),
            )
        };
        self.faces_left = self.faces_left.checked_sub(count).ok_or_else(too_many)?;
        let base = u32::try_from(mesh.vertices.len())
            .ok()
            .and_then(|base| base.checked_add(u32::try_from(vertices.len()).ok()?).map(|_| base));
        let base = base.ok_or_else(|| error_at(asked, "more than 4,294,967,295 vertices"))?;
        let columns = [world.x_axis, world.y_axis, world.z_axis].map(DVec3::length);
        let precision = precision * columns.into_iter().fold(0.0, f64::max);
        if precision > mesh.precision {
            (mesh.format, mesh.precision) = (*format, precision);
        }
        mesh.vertices.extend(vertices.iter().map(|&v| world.transform_point3(v)));
        let mirrored = world.matrix3.determinant() < 0.0;
        mesh.faces.extend(faces.iter().map(|face| {
            let mut face: Vec<u32> = face.iter().map(|v| v + base).collect();
            if mirrored {
                face.reverse();
            }
            face
        }));
        Ok(())
    }

    /// Reads the polygons of a mesh.
    fn read_shape(&self, mesh: &'a Element) -> Result<Shape, Fault> {
        let mut shape = Mesh::default();
        let mut bases: HashMap<*const Element, u32> = HashMap::new();
        for of in &mesh.children {
            let kind = of.name.as_str();
            if !["triangles", "trifans", "tristrips", "polylist", "polygons"].contains(&kind) {
                continue;
            }
            let inputs = Inputs::parse(of)?;
            let Some(vertex) = inputs.vertex else {
                return Err(error_at(
                    of,
                    format!("<{kind}> has no input VERTEX, which is required"),
                ));
            };
            let source = self.position_source(vertex)?;
            let key: *const Element = source;
            let base = if let Some(&base) = bases.get(&key) {
                base
            } else {
                let base = shape.vertices.len() as u32;
                let (vectors, printed) = self.source_vectors(source)?;
                shape.vertices.extend(vectors);
                shape.printed.extend(printed);
                bases.insert(key, base);
                base
            };
            let total = shape.vertices.len() as u32 - base;
            for corners in inputs.read_faces(of)? {
                if let Some(beyond) = corners.iter().find(|&&v| v >= total) {
                    return Err(error_at(
                        of,
                        format!(
                            "vertex index {beyond} is out of range; there are {total} vertices"
                        ),
                    ));
                }
                shape.faces.push(corners.iter().map(|v| v + base).collect());
            }
        }
        let format = NumberFormat::of_text(&shape, false);
        let precision = format.precision(largest_magnitude(shape.vertices_in_use()));
        Ok(Shape { vertices: shape.vertices, faces: shape.faces, format, precision })
    }

    /// Returns the source of the positions for an input of vertices.
    fn position_source(&self, vertex: &Element) -> Result<&'a Element, Fault> {
        let vertices = self.referenced(vertex)?;
        let position =
            vertices.children_named("input").find(|i| i.get("semantic") == Some("POSITION"));
        self.referenced(
            position.ok_or_else(|| error_at(vertices, "the vertices have no input POSITION"))?,
        )
    }

    /// Returns the vectors of a source, and their printed forms.
    fn source_vectors(&self, source: &Element) -> Result<(Vec<DVec3>, Vec<[Printed; 3]>), Fault> {
        let accessor =
            source.first_child("technique_common").and_then(|t| t.first_child("accessor"));
        let accessor = accessor.ok_or_else(|| error_at(source, "the source has no accessor"))?;
        let array = self.referenced(accessor)?;
        if array.name != "float_array" {
            return Err(error_at(
                array,
                format!("positions refer to {}, expected a float_array", quoted(&array.name)),
            ));
        }
        let numbers: Vec<f64> = parse_numbers(array)?;
        let printed: Vec<Printed> = array.text.split_whitespace().map(Printed::from_text).collect();
        let [count, stride, offset] =
            ["count", "stride", "offset"].map(|key| parse_integer(accessor, key));
        let (count, stride, offset) =
            (count?.unwrap_or(0), stride?.unwrap_or(1), offset?.unwrap_or(0));
        let named =
            |(k, p): (usize, &Element)| p.get("name").is_some_and(|n| !n.is_empty()).then_some(k);
        let places: Vec<usize> =
            accessor.children_named("param").enumerate().filter_map(named).take(3).collect();
        let [x, y, z] = places[..] else {
            return Err(error_at(accessor, "positions need three named coordinates"));
        };
        // An index that overflows is beyond any array.
        let last =
            |count: usize| (count - 1).checked_mul(stride)?.checked_add(offset)?.checked_add(z);
        let fits = count == 0 || last(count).is_some_and(|last| last < numbers.len());
        if x.max(y).max(z) >= stride || !fits {
            return Err(error_at(
                accessor,
                format!(
                    "{count} positions extend beyond the {} numbers of their array",
                    numbers.len()
                ),
            ));
        }
        let vector = |k: usize| {
            let [x, y, z] = [x, y, z].map(|place| offset + k * stride + place);
            let vector = DVec3::new(numbers[x], numbers[y], numbers[z]);
            (vector, [printed[x], printed[y], printed[z]])
        };
        Ok((0..count).map(vector).unzip())
    }
}

/// The layout of the indices of faces.
struct Inputs<'a> {
    /// Number of indices for each corner.
    stride: usize,
    /// The position of the vertex index among them.
    offset: usize,
    vertex: Option<&'a Element>,
}

impl<'a> Inputs<'a> {
    /// Reads the layout from the elements `input`.
    fn parse(faces: &'a Element) -> Result<Self, Fault> {
        let mut inputs = Self { stride: 1, offset: 0, vertex: None };
        for input in faces.children_named("input") {
            let offset = parse_integer(input, "offset")?.unwrap_or(0);
            if offset > 255 {
                return Err(error_at(
                    input,
                    format!("offset {offset} is out of range; accepted: 0 to 255"),
                ));
            }
            inputs.stride = inputs.stride.max(offset + 1);
            if input.get("semantic") == Some("VERTEX") {
                (inputs.offset, inputs.vertex) = (offset, Some(input));
            }
        }
        Ok(inputs)
    }

    /// Returns the vertex indices of each list of corners.
    fn vertex_lists(&self, of: &Element) -> Result<Vec<Vec<u32>>, Fault> {
        let list = |p: &Element| {
            let indices: Vec<u32> = parse_numbers(p)?;
            if !indices.len().is_multiple_of(self.stride) {
                let what = format!(
                    "{} indices are not a multiple of {}, the number for each corner",
                    indices.len(),
                    self.stride
                );
                return Err(error_at(p, what));
            }
            Ok(indices.into_iter().skip(self.offset).step_by(self.stride).collect())
        };
        of.children_named("p").map(list).collect()
    }

    /// Returns the faces of an element, without those of fewer than three corners.
    fn read_faces(&self, of: &Element) -> Result<Vec<Vec<u32>>, Fault> {
        let lists = self.vertex_lists(of)?;
        let mut faces: Vec<Vec<u32>> = Vec::new();
        match of.name.as_str() {
            "triangles" => {
                for list in lists {
                    if !list.len().is_multiple_of(3) {
                        return Err(error_at(
                            of,
                            format!("{} corners are not a multiple of 3", list.len()),
                        ));
                    }
                    faces.extend(list.chunks_exact(3).map(<[u32]>::to_vec));
                }
            }
            "trifans" => {
                for list in lists {
                    let Some((&middle, rim)) = list.split_first() else { continue };
                    faces.extend(rim.windows(2).map(|e| vec![middle, e[0], e[1]]));
                }
            }
            "tristrips" => {
                for list in lists {
                    faces.extend(list.windows(3).enumerate().map(|(k, t)| {
                        if k % 2 == 0 { t.to_vec() } else { vec![t[1], t[0], t[2]] }
                    }));
                }
            }
            "polylist" => {
                let counts = of
                    .first_child("vcount")
                    .ok_or_else(|| error_at(of, "<polylist> has no vcount, which is required"))?;
                let corners: Vec<u32> = lists.into_iter().flatten().collect();
                let mut rest = &corners[..];
                for count in parse_numbers::<usize>(counts)? {
                    let beyond = || error_at(counts, "vcount has more corners than the lists");
                    let (face, others) = rest.split_at_checked(count).ok_or_else(beyond)?;
                    faces.push(face.to_vec());
                    rest = others;
                }
                if !rest.is_empty() {
                    return Err(error_at(
                        counts,
                        format!("{} corners are not used by vcount", rest.len()),
                    ));
                }
            }
            _ => {
                if let Some(holed) = of.first_child("ph") {
                    return Err(error_at(
                        holed,
                        "polygons with holes are not supported; export triangles",
                    ));
                }
                faces.extend(lists);
            }
        }
        let promised = parse_integer(of, "count")?;
        let is_list = !matches!(of.name.as_str(), "trifans" | "tristrips");
        if let Some(count) = promised.filter(|count| is_list && *count != faces.len()) {
            return Err(error_at(
                of,
                format!("count is {count}, but there are {} faces", faces.len()),
            ));
        }
        faces.retain(|face| face.len() > 2);
        Ok(faces)
    }
}

/// Parses the numbers in an element.
fn parse_numbers<T: std::str::FromStr>(element: &Element) -> Result<Vec<T>, Fault> {
    let number = |word: &str| {
        let refused =
            || error_at(element, format!("invalid number {} in <{}>", quoted(word), element.name));
        word.parse().map_err(|_| refused())
    };
    element.text.split_whitespace().map(number).collect()
}

/// Parses an integer in an attribute; `None` if the attribute is missing.
fn parse_integer(element: &Element, key: &str) -> Result<Option<usize>, Fault> {
    let parsed = element.get(key).map(|text| text.trim().parse::<usize>());
    let refused = |_| {
        error_at(
            element,
            format!("invalid {key} of <{}>; expected a non-negative integer", element.name),
        )
    };
    parsed.transpose().map_err(refused)
}

/// Returns the product of the transforms of a node.
fn node_transform(node: &Element) -> Result<DAffine3, Fault> {
    let mut all = DAffine3::IDENTITY;
    for child in &node.children {
        let own = match child.name.as_str() {
            "matrix" => {
                let [a, b, c, _] = matrix_rows(&exact_numbers::<16>(child)?);
                let matrix = DMat3::from_cols(a.truncate(), b.truncate(), c.truncate()).transpose();
                DAffine3::from_mat3_translation(matrix, DVec3::new(a.w, b.w, c.w))
            }
            "translate" => DAffine3::from_translation(DVec3::from_array(exact_numbers(child)?)),
            "scale" => DAffine3::from_scale(DVec3::from_array(exact_numbers(child)?)),
            "rotate" => {
                let [x, y, z, degrees] = exact_numbers(child)?;
                let axis = DVec3::new(x, y, z).try_normalize();
                let axis = axis.ok_or_else(|| error_at(child, "the axis of a rotation is zero"))?;
                DAffine3::from_quat(DQuat::from_axis_angle(axis, degrees.to_radians()))
            }
            "lookat" | "skew" => {
                return Err(error_at(
                    child,
                    format!("<{}> is not supported; export a matrix", child.name),
                ));
            }
            _ => continue,
        };
        all *= own;
    }
    if all.is_finite() { Ok(all) } else { Err(error_at(node, "the transform is not finite")) }
}

/// Returns the rows of a matrix.
fn matrix_rows(numbers: &[f64; 16]) -> [glam::DVec4; 4] {
    [0, 1, 2, 3].map(|k| glam::DVec4::from_slice(&numbers[4 * k..]))
}

/// Parses exactly `N` numbers in an element.
fn exact_numbers<const N: usize>(element: &Element) -> Result<[f64; N], Fault> {
    let found: Vec<f64> = parse_numbers(element)?;
    let count = found.len();
    found.try_into().map_err(|_| {
        error_at(element, format!("<{}> has {count} numbers, expected {N}", element.name))
    })
}
