//! Reads a URDF file as an assembly: each link with geometry is a part, in metres, placed by the chain of
//! joints from the root in one configuration.

use std::collections::HashMap;
use std::path::PathBuf;

use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::files::Source;
use super::links::LinkShape;
use super::manifest::rotation_from_rpy;
use super::shapes::Primitive;
use super::{Budget, Draft, Geometry, Placed, assemble, contents_error, parse_mesh};
use crate::error::ReadError;
use colltrans_assembly::{Assembly, Piece};
use colltrans_mesh::words::first_named;
use colltrans_mesh::xml::Element;

/// Maximum number of names that an error lists.
const MAX_NAMES: usize = 12;

/// Reads the parts of a URDF file.
pub(super) fn read_urdf(source: Source) -> Result<Assembly, ReadError> {
    let (robot, bytes) = parse_robot(&source)?;
    let joints = read_joints(&source, &robot)?;
    let places = link_poses(&source, &robot, &joints)?;
    let mut gathered = PartGatherer::new(&source, bytes);
    for link in robot.children_named("link") {
        let name = element_name(&source, link)?;
        gathered.add_link(link, name, places[name])?;
    }
    let PartGatherer { drafts, missing, .. } = gathered;
    if !missing.is_empty() && !source.options.skip_missing {
        return Err(ReadError::MissingMeshes { path: source.path.into(), missing });
    }
    let notes: Vec<String> =
        missing.iter().map(|file| format!("{file} not found; left out")).collect();
    let which = match source.options.geometry {
        Geometry::Collision => "collision",
        Geometry::Visual => "visual",
    };
    let links = robot.children_named("link").count();
    let holds = match missing.len() {
        0 => format!("none of its {links} links has {which} geometry"),
        missing => format!("none of its {missing} referenced meshes was found"),
    };
    let assembly = assemble(source, drafts, &holds)?.with_unit("m");
    Ok(notes.into_iter().fold(assembly, Assembly::with_note))
}

/// Parses the robot of a file. Returns it with the number of bytes of the text.
pub(super) fn parse_robot(source: &Source) -> Result<(Element, usize), ReadError> {
    let (robot, bytes) = parse_root(source)?;
    check_robot(source, &robot)?;
    Ok((robot, bytes))
}

/// Parses a file. Returns its root element with the number of bytes of the text.
pub(super) fn parse_root(source: &Source) -> Result<(Element, usize), ReadError> {
    let text = source.text()?;
    let refused = |(place, reason)| contents_error(source.path, format!("URDF: {place}"), reason);
    Ok((Element::parse(&text).map_err(refused)?, text.len()))
}

/// Checks that an element is a robot without macros.
pub(super) fn check_robot(source: &Source, robot: &Element) -> Result<(), ReadError> {
    if robot.name != "robot" {
        let reason = format!("the root element is {}, expected robot", robot.name);
        return Err(contents_error(source.path, format!("URDF: line {}", robot.line), reason));
    }
    let macros = |e: &&Element| e.name.starts_with("xacro:");
    if let Some(found) = robot.children.iter().find(macros) {
        let reason = format!("unexpanded macro {}; run xacro first", found.name);
        return Err(contents_error(source.path, format!("URDF: line {}", found.line), reason));
    }
    Ok(())
}

/// The parts while they are gathered.
pub(super) struct PartGatherer<'a> {
    source: &'a Source<'a>,
    budget: Budget,
    drafts: Vec<Draft>,
    pub(super) missing: Vec<String>,
}

impl<'a> PartGatherer<'a> {
    pub(super) fn new(source: &'a Source<'a>, bytes: usize) -> Self {
        let (drafts, missing) = (Vec::new(), Vec::new());
        Self { source, budget: Budget::with_bytes(bytes), drafts, missing }
    }

    /// Adds the part of a link, if it has geometry.
    fn add_link(&mut self, link: &Element, name: &str, world: DAffine3) -> Result<(), ReadError> {
        let shapes = self.link_shapes(link, name, world)?;
        if !shapes.is_empty() {
            let refused =
                |reason: String| contents_error(self.source.path, format!("link {name}"), reason);
            self.budget.count_placed().map_err(refused)?;
            let pieces = shapes.into_iter().map(LinkShape::into_piece).map(Placed::from).collect();
            self.drafts.push(Draft::new(name, pieces).marked_as_one_part());
        }
        Ok(())
    }

    /// Reads the geometry of a link whose frame is at `world`.
    pub(super) fn link_shapes(
        &mut self,
        link: &Element,
        name: &str,
        world: DAffine3,
    ) -> Result<Vec<LinkShape>, ReadError> {
        let which = self.geometry_name();
        let mut shapes = Vec::new();
        for shown in link.children_named(which) {
            let refused =
                |reason: String| contents_error(self.source.path, format!("link {name}"), reason);
            let at = world * element_pose(shown).map_err(refused)?;
            let shape = shown.first_child("geometry").and_then(|g| g.children.first());
            let shape =
                shape.ok_or_else(|| refused(format!("a {which} element has no geometry")))?;
            if shape.name == "mesh" {
                let filename = shape.required("filename").map_err(refused)?;
                let scale = shape.numbers::<3>("scale").map_err(refused)?.unwrap_or([1.0; 3]);
                shapes.extend(self.read_mesh(filename, scale, name, at)?.map(LinkShape::Mesh));
            } else {
                let primitive = primitive(shape)
                    .map_err(|reason| refused(format!("line {}: {reason}", shape.line)))?;
                shapes.push(self.primitive_shape(primitive, at).map_err(refused)?);
            }
        }
        Ok(shapes)
    }

    /// Returns the name of the elements with the geometry to read.
    pub(super) const fn geometry_name(&self) -> &'static str {
        match self.source.options.geometry {
            Geometry::Collision => "collision",
            Geometry::Visual => "visual",
        }
    }

    /// Returns a primitive shape of a link at a pose, and counts it.
    pub(super) fn primitive_shape(
        &mut self,
        primitive: Primitive,
        at: DAffine3,
    ) -> Result<LinkShape, String> {
        self.budget.count_placed()?;
        self.budget.count_facets(primitive.face_count())?;
        Ok(LinkShape::Primitive(primitive, at))
    }

    /// Reads a mesh of a link. `None` if the file does not exist, which is recorded.
    pub(super) fn read_mesh(
        &mut self,
        filename: &str,
        scale: [f64; 3],
        link: &str,
        at: DAffine3,
    ) -> Result<Option<Piece>, ReadError> {
        let refused =
            |reason: String| contents_error(self.source.path, format!("link {link}"), reason);
        let Some((file, bytes)) = find_mesh(self.source, filename)? else {
            self.missing.push(filename.to_owned());
            return Ok(None);
        };
        self.budget.count_file(&file, bytes.len());
        let found = parse_mesh(&file, bytes)?;
        self.budget.count_facets(found.faces.len().max(found.vertices.len())).map_err(refused)?;
        // URDF is in metres. The upward axis of a mesh file is ignored.
        let scale = DVec3::from_array(scale) * found.unit.unwrap_or(1.0);
        let world_from_piece = at * DAffine3::from_scale(scale);
        Ok(Some(Piece { mesh: found, world_from_piece }))
    }
}

/// Reads a box, cylinder, sphere or capsule.
fn primitive(shape: &Element) -> Result<Primitive, String> {
    let number = |name: &str| -> Result<f64, String> {
        shape.required(name)?;
        Ok(shape.numbers::<1>(name)?.map_or(0.0, |[x]| x))
    };
    let primitive = match shape.name.as_str() {
        "box" => {
            shape.required("size")?;
            Primitive::Cuboid(DVec3::from_array(shape.numbers::<3>("size")?.unwrap_or_default()))
        }
        "cylinder" => Primitive::Cylinder { radius: number("radius")?, length: number("length")? },
        "sphere" => Primitive::Sphere(number("radius")?),
        "capsule" => Primitive::Capsule { radius: number("radius")?, length: number("length")? },
        other => {
            let accepted = "mesh, box, cylinder, sphere, capsule";
            return Err(format!("unknown geometry {other}; accepted: {accepted}"));
        }
    };
    primitive.checked()
}

/// Returns the name of an element, which must have one.
pub(super) fn element_name<'a>(
    source: &Source,
    element: &'a Element,
) -> Result<&'a str, ReadError> {
    let refused = |e| contents_error(source.path, format!("URDF: line {}", element.line), e);
    element.required("name").map_err(refused)
}

/// Returns the pose of an element, the identity if it has no `origin`.
pub(super) fn element_pose(element: &Element) -> Result<DAffine3, String> {
    let Some(origin) = element.first_child("origin") else { return Ok(DAffine3::IDENTITY) };
    let xyz = origin.numbers::<3>("xyz")?.unwrap_or_default();
    let rpy = origin.numbers::<3>("rpy")?.unwrap_or_default();
    let matrix = match origin.numbers::<4>("quat_xyzw")? {
        Some(quaternion) => DMat3::from_quat(DQuat::from_array(quaternion).normalize()),
        None => rotation_from_rpy(rpy),
    };
    let pose = DAffine3::from_mat3_translation(matrix, DVec3::from_array(xyz));
    if pose.is_finite() {
        Ok(pose)
    } else {
        Err(format!("its origin has xyz {xyz:?}, rpy {rpy:?}; accepted: finite numbers"))
    }
}

/// A joint.
pub(super) struct Joint<'a> {
    pub(super) element: &'a Element,
    pub(super) parent: &'a str,
    pub(super) child: &'a str,
    pub(super) origin: DAffine3,
}

/// Joints by name.
pub(super) type Joints<'a> = HashMap<&'a str, Joint<'a>>;

/// Returns the joints of a robot, and checks the joint positions of the options.
pub(super) fn read_joints<'a>(
    source: &Source,
    robot: &'a Element,
) -> Result<Joints<'a>, ReadError> {
    let mut joints = HashMap::new();
    for element in robot.children_named("joint") {
        let name = element_name(source, element)?;
        let refused = |reason: String| contents_error(source.path, format!("joint {name}"), reason);
        let link = |what: &'static str| {
            let of = element
                .first_child(what)
                .ok_or_else(|| refused(format!("missing element {what}")))?;
            of.required("link").map_err(refused)
        };
        let origin = element_pose(element).map_err(refused)?;
        let joint = Joint { element, parent: link("parent")?, child: link("child")?, origin };
        if joints.insert(name, joint).is_some() {
            return Err(refused("duplicate joint name; names must be unique".into()));
        }
    }
    for (name, value) in &source.options.joints {
        let refused = |reason: String| contents_error(source.path, "joints", reason);
        if !value.is_finite() {
            return Err(refused(format!(
                "invalid position {value} of joint {name}; accepted: a finite number"
            )));
        }
        if !joints.contains_key(name.as_str()) {
            let mut known: Vec<&str> = joints.keys().copied().collect();
            known.sort_unstable();
            return Err(refused(format!(
                "unknown joint {name}; known joints: {}",
                first_named(&known, MAX_NAMES)
            )));
        }
    }
    Ok(joints)
}

/// Returns the pose of each link in the world. Root links are at the origin.
pub(super) fn link_poses<'a>(
    source: &Source,
    robot: &'a Element,
    joints: &Joints<'a>,
) -> Result<HashMap<&'a str, DAffine3>, ReadError> {
    let mut links: HashMap<&str, Option<(&str, &Joint)>> = HashMap::new();
    for link in robot.children_named("link") {
        let name = element_name(source, link)?;
        if links.insert(name, None).is_some() {
            return Err(contents_error(
                source.path,
                format!("link {name}"),
                "duplicate link name; names must be unique",
            ));
        }
    }
    for joint in robot.children_named("joint").filter_map(|joint| joint.get("name")) {
        let refused = |reason| contents_error(source.path, format!("joint {joint}"), reason);
        let Joint { parent, child, .. } = joints[joint];
        for link in [parent, child] {
            if !links.contains_key(link) {
                return Err(refused(format!("unknown link {link}; add a link of this name")));
            }
        }
        if links.insert(child, Some((joint, &joints[joint]))).flatten().is_some() {
            return Err(refused(format!(
                "link {child} already is the child of another joint; a link has one parent"
            )));
        }
    }
    let mut places: HashMap<&str, DAffine3> = HashMap::new();
    let mut positions = HashMap::new();
    for link in robot.children_named("link").filter_map(|link| link.get("name")) {
        // Collects the joints up to a placed link or a root, then places the links downwards.
        let (mut above, mut name) = (Vec::new(), link);
        let mut at = loop {
            if let Some(place) = places.get(name) {
                break *place;
            }
            let Some((joint, found)) = links[name] else {
                places.insert(name, DAffine3::IDENTITY);
                break DAffine3::IDENTITY;
            };
            if above.len() > joints.len() {
                return Err(contents_error(
                    source.path,
                    format!("link {link}"),
                    "its joints form a cycle; they must form a tree",
                ));
            }
            above.push((joint, found));
            name = found.parent;
        };
        for (name, joint) in above.into_iter().rev() {
            let refused = |reason| contents_error(source.path, format!("joint {name}"), reason);
            let position = joint_position(source, joints, name, &mut positions).map_err(refused)?;
            at = at * joint.origin * joint_motion(joint, position).map_err(refused)?;
            places.insert(joint.child, at);
        }
    }
    Ok(places)
}

/// Returns the motion of a joint at a position.
fn joint_motion(joint: &Joint, position: f64) -> Result<DAffine3, String> {
    let kind = joint.element.required("type")?;
    let axis = match joint.element.first_child("axis") {
        Some(axis) => axis.numbers::<3>("xyz")?.unwrap_or([1.0, 0.0, 0.0]),
        None => [1.0, 0.0, 0.0],
    };
    let axis = DVec3::from_array(axis).normalize_or_zero();
    match kind {
        "revolute" | "continuous" if position != 0.0 && axis != DVec3::ZERO => {
            Ok(DAffine3::from_quat(DQuat::from_axis_angle(axis, position)))
        }
        "prismatic" => Ok(DAffine3::from_translation(axis * position)),
        "revolute" | "continuous" | "fixed" | "floating" | "planar" | "spherical" => {
            Ok(DAffine3::IDENTITY)
        }
        other => Err(format!(
            "unknown type {other}; accepted: fixed, revolute, continuous, prismatic, floating, planar, spherical"
        )),
    }
}

/// Returns the position of a joint: the given one, or that computed from the joint that it mimics, or 0. `known` has
/// the positions of joints that mimic others, as far as they were computed. Chains of mimic elements have any length.
///
/// # Errors
/// Returns an error if mimic elements form a cycle, or for an attribute of a mimic element that is missing or invalid.
fn joint_position<'a>(
    source: &Source,
    joints: &Joints<'a>,
    name: &'a str,
    known: &mut HashMap<&'a str, f64>,
) -> Result<f64, String> {
    // Collects the mimicking joints down to one whose position is known, then computes theirs upwards.
    let (mut mimicking, mut at) = (Vec::new(), name);
    let mut position = loop {
        if let Some(position) = source.options.joints.get(at).or_else(|| known.get(at)) {
            break *position;
        }
        let mimic = joints.get(at).and_then(|joint| joint.element.first_child("mimic"));
        let Some(mimic) = mimic else { break 0.0 };
        if mimicking.len() == joints.len() {
            return Err("mimic elements form a cycle".into());
        }
        mimicking.push((at, mimic));
        at = mimic.required("joint")?;
    };
    for (name, mimic) in mimicking.into_iter().rev() {
        let number = |name: &str, default: f64| {
            mimic.numbers::<1>(name).map(|found| found.map_or(default, |[x]| x))
        };
        position = position * number("multiplier", 1.0)? + number("offset", 0.0)?;
        known.insert(name, position);
    }
    Ok(position)
}

/// Opens a mesh by the reference in the robot.
fn find_mesh(source: &Source, name: &str) -> Result<Option<(PathBuf, Vec<u8>)>, ReadError> {
    let package = ["package://", "model://"].into_iter().find_map(|start| name.strip_prefix(start));
    if let Some(rest) = package {
        // Some files have an empty package name, as in `package:///meshes/a.stl`.
        return find_in_packages(source, rest.trim_start_matches('/'));
    }
    let name = name.strip_prefix("file://").unwrap_or(name);
    match source.open_reference(name)? {
        Some(found) => Ok(Some(found)),
        None => find_in_packages(source, name),
    }
}

/// Searches the package roots for a path, then for the path without its leading folders, one by one.
fn find_in_packages(source: &Source, rest: &str) -> Result<Option<(PathBuf, Vec<u8>)>, ReadError> {
    let mut rest = Some(rest);
    while let Some(tail) = rest.filter(|tail| !tail.is_empty()) {
        for root in &source.options.packages {
            if let Some(found) = source.open_relative(root, tail)? {
                return Ok(Some(found));
            }
        }
        rest = tail.split_once('/').map(|(_, tail)| tail);
    }
    Ok(None)
}
