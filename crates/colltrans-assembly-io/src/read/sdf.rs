//! Reads an SDF robot (the format of Gazebo): a model, or the models of a world, with links, joints and frames.
//!
//! Reference: *`SDFormat` Specification*, version 1.11, and its tutorial *Pose Frame Semantics*.
//!
//! - Models, links, joints and frames have coordinate frames. A pose is relative to the frame that `relative_to` names.
//!   Without it, the pose of a joint is relative to the child of the joint, that of a frame to the frame to which it is
//!   attached, and others to the model or the world around them.
//! - A name refers to the model, or the world, around the element. `a::b` is `b` in the model `a`.
//! - Poses are those at the joint positions 0. The frame of a link is that of the joint above it. Links without a joint
//!   above them, and links of static models, are fixed to the world.
//! - Elements that would change the geometry but are not supported are errors.

use std::collections::HashMap;

use colltrans::Pose;
use colltrans::motion::path::{Frame, Joint, Mechanism};
use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::contents_error;
use super::files::Source;
use super::links::{LinkShape, build_link, check_hull_names, check_links};
use super::manifest::rotation_from_rpy;
use super::shapes::Primitive;
use super::urdf::PartGatherer;
use crate::error::ReadError;
use crate::robot::{JointKind, Robot, RobotJoint};
use colltrans_mesh::xml::Element;

/// Elements that place or move something and are not supported.
const UNSUPPORTED: [&str; 5] = ["include", "actor", "population", "road", "state"];
/// Limits of a joint from this magnitude on stand for no limit. Older files write 1e16.
const NO_LIMIT: f64 = 1e16;
/// The name of the frame of the model around an element.
const MODEL_FRAME: &str = "__model__";

/// Reads a robot from the root element of an SDF file with this number of bytes.
pub(super) fn read_robot(source: Source, root: &Element, bytes: usize) -> Result<Robot, ReadError> {
    let refused = |reason: String| contents_error(source.path, place_of(root), reason);
    let roots: Vec<&Element> =
        root.children.iter().filter(|child| matches!(&*child.name, "model" | "world")).collect();
    let [top] = roots[..] else {
        let reason = format!("{} models and worlds; accepted: one model or one world", roots.len());
        return Err(refused(reason));
    };
    let mut tree = Tree {
        source: &source,
        has_model_axes: version(root).map_err(refused)? < (1, 5),
        scopes: vec![Scope { prefix: String::new(), model: None, is_static: false }],
        nodes: Vec::new(),
        by_name: HashMap::new(),
        placed: Vec::new(),
    };
    if top.name == "world" {
        tree.collect(top, 0)?;
    } else {
        tree.add_model(top, 0, MODEL_FRAME)?;
    }
    let moving = tree.build_frames()?;
    let names: Vec<&str> = moving.links.iter().map(|link| &*tree.nodes[*link].name).collect();
    check_hull_names(&source, &names)?;
    let mut gathered = PartGatherer::new(&source, bytes);
    let (mut links, mut notes) = (Vec::new(), tree.unused_notes());
    for link in &moving.links {
        let (frame, world_from_frame) = moving.frame_of_link[link];
        let shapes = tree.link_shapes(*link, world_from_frame, &mut gathered)?;
        links.push(build_link(&source, &tree.nodes[*link].name, frame, &shapes, &mut notes)?);
    }
    check_links(&source, &links, gathered.missing, &mut notes)?;
    let Moving { frames, joints, .. } = moving;
    let mechanism =
        Mechanism::new(frames).map_err(|e| contents_error(source.path, "joints", e.to_string()))?;
    let name = top.get("name").unwrap_or_default().to_owned();
    Ok(Robot { name, links, joints, mechanism, notes, files: source.into_files() })
}

/// Returns the place of an element, for errors.
fn place_of(element: &Element) -> String {
    format!("SDF: line {}", element.line)
}

/// Returns the version of a file. Files before 1.4 have other elements.
fn version(root: &Element) -> Result<(u32, u32), String> {
    let text = root.required("version")?;
    let parts = text.split_once('.').and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    parts
        .filter(|version| *version >= (1, 4))
        .ok_or_else(|| format!("unsupported version {text}; accepted: from 1.4 on"))
}

/// Parses the numbers in the text of an element.
fn numbers<const N: usize>(element: &Element) -> Result<[f64; N], String> {
    let numbers: Result<Vec<f64>, _> = element.text.split_whitespace().map(str::parse).collect();
    let all = numbers.ok().and_then(|all| <[f64; N]>::try_from(all).ok());
    all.filter(|all| all.iter().all(|x| !x.is_nan())).ok_or_else(|| {
        let text = element.text.trim();
        let accepted = if N == 1 { "a number".into() } else { format!("{N} numbers") };
        format!("<{}> is \"{text}\"; accepted: {accepted}", element.name)
    })
}

/// Parses the numbers in the text of a child element, which must exist.
fn child_numbers<const N: usize>(of: &Element, name: &'static str) -> Result<[f64; N], String> {
    let missing = || format!("<{}> has no element {name}, which is required", of.name);
    numbers(of.first_child(name).ok_or_else(missing)?)
}

/// Checks whether a child element is `true` or 1.
fn is_set(of: &Element, name: &'static str) -> bool {
    of.first_child(name).is_some_and(|flag| matches!(flag.text.trim(), "true" | "1"))
}

/// Returns an attribute; `None` if it is missing or empty.
fn reference<'a>(element: &'a Element, name: &str) -> Option<&'a str> {
    element.get(name).filter(|text| !text.is_empty())
}

/// Returns the pose of an element, the identity if it has none, and the frame that `relative_to` names.
fn element_pose(element: &Element) -> Result<(DAffine3, Option<&str>), String> {
    let Some(pose) = element.first_child("pose") else { return Ok((DAffine3::IDENTITY, None)) };
    let relative = reference(pose, "relative_to");
    if pose.text.trim().is_empty() {
        return Ok((DAffine3::IDENTITY, relative));
    }
    let (position, rotation) = match pose.get("rotation_format") {
        None | Some("euler_rpy") => {
            let [x, y, z, angles @ ..] = numbers::<6>(pose)?;
            let in_degrees = matches!(pose.get("degrees"), Some("true" | "1"));
            let angles = angles.map(|x| if in_degrees { x.to_radians() } else { x });
            ([x, y, z], rotation_from_rpy(angles))
        }
        Some("quat_xyzw") => {
            let [x, y, z, quaternion @ ..] = numbers::<7>(pose)?;
            let quaternion = DQuat::from_array(quaternion).normalize();
            ([x, y, z], DMat3::from_quat(quaternion))
        }
        Some(other) => {
            return Err(format!(
                "unsupported rotation_format {other}; accepted: euler_rpy, quat_xyzw"
            ));
        }
    };
    let pose = DAffine3::from_mat3_translation(rotation, DVec3::from_array(position));
    if pose.is_finite() {
        return Ok((pose, relative));
    }
    Err(format!("its pose is {position:?} with rotation {rotation}; accepted: finite numbers"))
}

/// Returns the inverse of a rigid transformation.
fn inverse_of(pose: DAffine3) -> DAffine3 {
    let back = pose.matrix3.transpose();
    DAffine3::from_mat3_translation(back, back * -pose.translation)
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// A model, with the scope of its elements.
    Model(usize),
    Link,
    Joint,
    Frame,
}

/// An element with a coordinate frame.
struct Node<'a> {
    element: &'a Element,
    kind: Kind,
    /// The name, after those of the models around it, except the model that is the whole file.
    name: String,
    /// The scope in which its references are names.
    scope: usize,
    pose: DAffine3,
    relative_to: Option<&'a str>,
}

/// A model, or the world, whose elements refer to each other by name.
struct Scope {
    /// The names of the models around its elements, each followed by `::`.
    prefix: String,
    /// The node of the model; `None` is the world.
    model: Option<usize>,
    is_static: bool,
}

/// All elements with coordinate frames. A frame is the index of its node, or `None` for the world.
struct Tree<'a> {
    source: &'a Source<'a>,
    /// Whether axes of joints are in the frame of the model by default.
    has_model_axes: bool,
    scopes: Vec<Scope>,
    nodes: Vec<Node<'a>>,
    by_name: HashMap<String, usize>,
    /// The pose of each node in the world; `None` before it is computed.
    placed: Vec<Option<DAffine3>>,
}

/// The links and the frames that carry them.
struct Moving {
    /// The nodes of the links.
    links: Vec<usize>,
    frames: Vec<Frame>,
    joints: Vec<RobotJoint>,
    /// For each link its frame, and the pose of this frame in the world at the joint positions 0.
    frame_of_link: HashMap<usize, (Option<usize>, DAffine3)>,
}

impl<'a> Tree<'a> {
    /// Returns an error about an element.
    fn error(&self, element: &Element, reason: impl std::fmt::Display) -> ReadError {
        let name = element.get("name").unwrap_or("without a name");
        let reason = format!("{} {name}: {reason}", element.name);
        contents_error(self.source.path, place_of(element), reason)
    }

    /// Adds the elements of a model or the world.
    fn collect(&mut self, of: &'a Element, scope: usize) -> Result<(), ReadError> {
        for child in &of.children {
            let kind = match child.name.as_str() {
                "model" => {
                    let name = child.required("name").map_err(|e| self.error(child, e))?;
                    self.add_model(child, scope, name)?;
                    continue;
                }
                "link" => Kind::Link,
                "joint" => Kind::Joint,
                "frame" => Kind::Frame,
                name if UNSUPPORTED.contains(&name) => {
                    return Err(self.error(child, format!("unsupported in {}", of.name)));
                }
                _ => continue,
            };
            let name = child.required("name").map_err(|e| self.error(child, e))?;
            self.add_node(child, kind, scope, name)?;
        }
        Ok(())
    }

    /// Adds a model with its elements. Their names begin with that of the model, unless it is the whole file.
    fn add_model(&mut self, model: &'a Element, scope: usize, name: &str) -> Result<(), ReadError> {
        if let Some(frame) = reference(model, "placement_frame") {
            return Err(self.error(model, format!("unsupported placement_frame {frame}")));
        }
        let is_static = self.scopes[scope].is_static || is_set(model, "static");
        let inner = self.scopes.len();
        let node = self.add_node(model, Kind::Model(inner), scope, name)?;
        let is_file = name == MODEL_FRAME;
        let prefix = if is_file { String::new() } else { format!("{}::", self.nodes[node].name) };
        self.by_name.insert(format!("{prefix}{MODEL_FRAME}"), node);
        self.scopes.push(Scope { prefix, model: Some(node), is_static });
        self.collect(model, inner)
    }

    fn add_node(
        &mut self,
        element: &'a Element,
        kind: Kind,
        scope: usize,
        name: &str,
    ) -> Result<usize, ReadError> {
        let refused = |reason| self.error(element, reason);
        let (pose, relative_to) = element_pose(element).map_err(refused)?;
        let name = format!("{}{name}", self.scopes[scope].prefix);
        let node = self.nodes.len();
        if node >= super::MAX_PLACED {
            return Err(refused(format!("more than {} elements are placed", super::MAX_PLACED)));
        }
        if self.by_name.insert(name.clone(), node).is_some() {
            return Err(self.error(element, "duplicate name; names must be unique in a model"));
        }
        self.nodes.push(Node { element, kind, name, scope, pose, relative_to });
        self.placed.push(None);
        Ok(node)
    }

    /// Returns the frame of a name in a scope.
    fn find(&self, scope: usize, name: &str, of: &Element) -> Result<Option<usize>, ReadError> {
        if name == "world" {
            return Ok(None);
        }
        let found = self.by_name.get(&format!("{}{name}", self.scopes[scope].prefix));
        found.copied().map(Some).ok_or_else(|| self.error(of, format!("unknown frame {name}")))
    }

    /// Returns the frame that a child element of a joint names.
    fn frame_of_joint(&self, joint: usize, end: &'static str) -> Result<Option<usize>, ReadError> {
        let Node { element, scope, .. } = self.nodes[joint];
        let named = element.first_child(end);
        let named = named.ok_or_else(|| self.error(element, format!("missing element {end}")))?;
        self.find(scope, named.text.trim(), element)
    }

    /// Returns the frame to which a node is attached, or to which its pose is relative by default.
    fn frame_around(&self, node: usize) -> Result<Option<usize>, ReadError> {
        let Node { element, kind, scope, .. } = self.nodes[node];
        match (kind, reference(element, "attached_to")) {
            (Kind::Joint, _) => self.frame_of_joint(node, "child"),
            (Kind::Frame, Some(name)) => self.find(scope, name, element),
            _ => Ok(self.scopes[scope].model),
        }
    }

    /// Returns the pose of a frame in the world.
    fn place(&mut self, frame: Option<usize>) -> Result<DAffine3, ReadError> {
        let (mut chain, mut at) = (Vec::new(), frame);
        let mut world = loop {
            let Some(node) = at else { break DAffine3::IDENTITY };
            if let Some(world) = self.placed[node] {
                break world;
            }
            let Node { element, scope, relative_to, .. } = self.nodes[node];
            if chain.len() == self.nodes.len() {
                return Err(self.error(element, "its pose is relative to itself"));
            }
            chain.push(node);
            at = match relative_to {
                Some(name) => self.find(scope, name, element)?,
                None => self.frame_around(node)?,
            };
        };
        for node in chain.into_iter().rev() {
            world *= self.nodes[node].pose;
            self.placed[node] = Some(world);
        }
        Ok(world)
    }

    /// Returns the link that carries a frame; `None` is the world.
    fn link_of(&self, frame: Option<usize>) -> Result<Option<usize>, ReadError> {
        let mut at = frame;
        for _ in 0..=self.nodes.len() {
            let Some(node) = at else { return Ok(None) };
            at = match self.nodes[node].kind {
                Kind::Link => return Ok(Some(node)),
                Kind::Model(inner) => self.canonical_link(node, inner)?,
                Kind::Joint | Kind::Frame => self.frame_around(node)?,
            };
        }
        let element = self.nodes[frame.unwrap_or_default()].element;
        Err(self.error(element, "it is attached to itself"))
    }

    /// Returns what carries the frame of a model: the named link, else the first link, else the first nested model.
    fn canonical_link(&self, model: usize, inner: usize) -> Result<Option<usize>, ReadError> {
        let element = self.nodes[model].element;
        if let Some(name) = reference(element, "canonical_link") {
            return self.find(inner, name, element);
        }
        let first = |is_wanted: fn(Kind) -> bool| {
            let mut nodes = model + 1..self.nodes.len();
            nodes.find(|k| self.nodes[*k].scope == inner && is_wanted(self.nodes[*k].kind))
        };
        let found = first(|kind| kind == Kind::Link)
            .or_else(|| first(|kind| matches!(kind, Kind::Model(_))));
        found.map(Some).ok_or_else(|| self.error(element, "it has no link"))
    }

    /// Returns the nodes of a kind, in the order of the file.
    fn nodes_of(&self, kind: Kind) -> Vec<usize> {
        (0..self.nodes.len()).filter(|node| self.nodes[*node].kind == kind).collect()
    }

    /// Builds the frames of all links.
    fn build_frames(&mut self) -> Result<Moving, ReadError> {
        let (links, joints) = (self.nodes_of(Kind::Link), self.nodes_of(Kind::Joint));
        // For each link the joint above it, and the link above that.
        let mut above: HashMap<usize, (usize, Option<usize>)> = HashMap::new();
        for joint in joints {
            let Node { element, scope, .. } = self.nodes[joint];
            if self.scopes[scope].is_static {
                continue;
            }
            let child = self.link_of(self.frame_of_joint(joint, "child")?)?;
            let child = child.ok_or_else(|| self.error(element, "its child is the world"))?;
            let parent = self.link_of(self.frame_of_joint(joint, "parent")?)?;
            if above.insert(child, (joint, parent)).is_some() {
                let name = &self.nodes[child].name;
                let reason = format!(
                    "link {name} already is the child of another joint; a link has one parent"
                );
                return Err(self.error(element, reason));
            }
        }
        let mut moving = Moving {
            links: links.clone(),
            frames: Vec::new(),
            joints: Vec::new(),
            frame_of_link: HashMap::new(),
        };
        for link in links {
            // Collects the links up to one whose frame is known, then adds their frames downwards.
            let (mut way, mut at) = (Vec::new(), Some(link));
            while let Some(node) = at.filter(|node| !moving.frame_of_link.contains_key(node)) {
                if way.len() == moving.links.len() {
                    let reason = "its joints form a cycle; they must form a tree";
                    return Err(self.error(self.nodes[link].element, reason));
                }
                way.push(node);
                at = above.get(&node).and_then(|(_, parent)| *parent);
            }
            for node in way.into_iter().rev() {
                self.add_frame(node, above.get(&node).copied(), &mut moving)?;
            }
        }
        Ok(moving)
    }

    /// Adds the frame of a link. The frame of the link above it must exist.
    fn add_frame(
        &mut self,
        link: usize,
        above: Option<(usize, Option<usize>)>,
        moving: &mut Moving,
    ) -> Result<(), ReadError> {
        let Some((joint, parent)) = above else {
            moving.frame_of_link.insert(link, (None, DAffine3::IDENTITY));
            return Ok(());
        };
        let world_from_joint = self.place(Some(joint))?;
        let (kind, moves, limits) = self.joint_motion(joint, world_from_joint)?;
        let (parent, world_from_parent) =
            parent.map_or((None, DAffine3::IDENTITY), |link| moving.frame_of_link[&link]);
        let Node { element, ref name, .. } = self.nodes[joint];
        let DAffine3 { matrix3, translation } = inverse_of(world_from_parent) * world_from_joint;
        let origin = Pose::from_matrix(matrix3, translation).map_err(|e| self.error(element, e))?;
        let frame = moving.frames.len();
        moving.frames.push(Frame { parent, origin, joint: moves });
        moving.frame_of_link.insert(link, (Some(frame), world_from_joint));
        if let Some(kind) = kind {
            moving.joints.push(RobotJoint { name: name.clone(), frame, kind, limits, mimic: None });
        }
        Ok(())
    }

    /// Returns the kind of a joint (`None` if fixed), its motion and its limits.
    #[expect(clippy::type_complexity, reason = "the three are used in one place")]
    fn joint_motion(
        &mut self,
        joint: usize,
        world_from_joint: DAffine3,
    ) -> Result<(Option<JointKind>, Joint, Option<[f64; 2]>), ReadError> {
        let Node { element, scope, .. } = self.nodes[joint];
        let kind = element.required("type").map_err(|reason| self.error(element, reason))?;
        if kind == "fixed" {
            return Ok((None, Joint::Fixed, None));
        }
        if !matches!(kind, "revolute" | "continuous" | "prismatic") {
            let reason = format!(
                "unsupported type {kind}; accepted: fixed, revolute, continuous, prismatic"
            );
            return Err(self.error(element, reason));
        }
        let axis = element.first_child("axis");
        let axis = axis.ok_or_else(|| self.error(element, "missing element axis"))?;
        let xyz = axis.first_child("xyz");
        let direction = xyz.map_or(Ok(DVec3::Z), |xyz| numbers(xyz).map(DVec3::from_array));
        let mut direction = direction.map_err(|reason| self.error(element, reason))?;
        let named = xyz.and_then(|xyz| reference(xyz, "expressed_in"));
        let is_of_model = self.has_model_axes || is_set(axis, "use_parent_model_frame");
        let expressed_in = match named {
            Some(name) => Some(self.find(scope, name, element)?),
            None => is_of_model.then_some(self.scopes[scope].model),
        };
        if let Some(frame) = expressed_in {
            let in_world = self.place(frame)?.transform_vector3(direction);
            direction = world_from_joint.matrix3.transpose() * in_world;
        }
        if !(direction.length() > 0.0 && direction.is_finite()) {
            let reason =
                format!("invalid axis {:?}; accepted: finite and not zero", direction.to_array());
            return Err(self.error(element, reason));
        }
        let limits = axis.first_child("limit").map_or(Ok(None), |limit| {
            let end = |name, default: f64| {
                limit.first_child(name).map_or(Ok(default), |end| numbers(end).map(|[x]| x))
            };
            let ends = [end("lower", -f64::INFINITY)?, end("upper", f64::INFINITY)?];
            Ok(Some(ends).filter(|ends| ends.iter().all(|x| x.abs() < NO_LIMIT)))
        });
        let limits = limits.map_err(|reason: String| self.error(element, reason))?;
        Ok(match (kind, limits) {
            ("prismatic", _) => (Some(JointKind::Prismatic), Joint::Sliding(direction), limits),
            ("revolute", Some(_)) => (Some(JointKind::Revolute), Joint::Turning(direction), limits),
            _ => (Some(JointKind::Continuous), Joint::Turning(direction), None),
        })
    }

    /// Reads the geometry of a link, in the frame that carries the link.
    fn link_shapes(
        &mut self,
        link: usize,
        world_from_frame: DAffine3,
        gathered: &mut PartGatherer<'_>,
    ) -> Result<Vec<LinkShape>, ReadError> {
        let Node { element, scope, .. } = self.nodes[link];
        let mut shapes = Vec::new();
        for shown in element.children_named(gathered.geometry_name()) {
            let refused = |reason: String| self.error(shown, reason);
            let (pose, relative_to) = element_pose(shown).map_err(refused)?;
            let shape = shown.first_child("geometry").and_then(|g| g.children.first());
            let shape = shape.ok_or_else(|| refused("it has no geometry".into()))?;
            let frame = match relative_to {
                Some(name) => self.find(scope, name, shown)?,
                None => Some(link),
            };
            let at = inverse_of(world_from_frame) * self.place(frame)? * pose;
            let refused = |reason: String| {
                contents_error(
                    self.source.path,
                    place_of(shape),
                    format!("link {}: {reason}", self.nodes[link].name),
                )
            };
            let name = &self.nodes[link].name;
            match shape.name.as_str() {
                "empty" => {}
                "mesh" => {
                    let (uri, scale) = mesh_reference(shape).map_err(refused)?;
                    let read = gathered.read_mesh(uri, scale, name, at)?;
                    shapes.extend(read.map(LinkShape::Mesh));
                }
                _ => {
                    let primitive = primitive(shape).map_err(refused)?;
                    shapes.push(gathered.primitive_shape(primitive, at).map_err(refused)?);
                }
            }
        }
        Ok(shapes)
    }

    /// Returns notes on elements that restrict motions but are not used.
    fn unused_notes(&self) -> Vec<String> {
        let mimics = |node: &Node| {
            node.kind == Kind::Joint
                && node
                    .element
                    .first_child("axis")
                    .is_some_and(|axis| axis.first_child("mimic").is_some())
        };
        let note = "mimic elements are not applied: give values of each joint";
        let mimic = self.nodes.iter().any(mimics).then(|| note.to_owned());
        let is_end = |limit: &Element, name| {
            let end = limit.first_child(name).map(numbers::<1>);
            end.is_some_and(|end| end.is_ok_and(|[x]| x.abs() < NO_LIMIT))
        };
        let one_sided = self.nodes.iter().filter_map(|node| {
            let limit = node.element.first_child("axis")?.first_child("limit")?;
            (node.kind == Kind::Joint && is_end(limit, "lower") != is_end(limit, "upper"))
                .then(|| format!("joint {}: a limit at one end alone is not applied", node.name))
        });
        mimic.into_iter().chain(one_sided).collect()
    }
}

/// Returns the file of a mesh and its scale.
fn mesh_reference(mesh: &Element) -> Result<(&str, [f64; 3]), String> {
    if mesh.first_child("submesh").is_some() {
        return Err("unsupported element submesh; write it to a file of its own".into());
    }
    let uri = mesh.first_child("uri").ok_or("<mesh> has no element uri, which is required")?;
    let scale = mesh.first_child("scale").map_or(Ok([1.0; 3]), numbers)?;
    Ok((uri.text.trim(), scale))
}

/// Reads a box, cylinder, sphere or capsule.
fn primitive(shape: &Element) -> Result<Primitive, String> {
    let number = |name| child_numbers::<1>(shape, name).map(|[x]| x);
    let primitive = match shape.name.as_str() {
        "box" => Primitive::Cuboid(DVec3::from_array(child_numbers(shape, "size")?)),
        "cylinder" => Primitive::Cylinder { radius: number("radius")?, length: number("length")? },
        "sphere" => Primitive::Sphere(number("radius")?),
        "capsule" => Primitive::Capsule { radius: number("radius")?, length: number("length")? },
        other => {
            let accepted = "mesh, box, cylinder, sphere, capsule";
            return Err(format!("unsupported geometry {other}; accepted: {accepted}"));
        }
    };
    primitive.checked()
}
