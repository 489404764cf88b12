//! Reads an MJCF robot (the XML format of MuJoCo): bodies with geoms, and hinge and slide joints.
//!
//! Reference: `MuJoCo`, *XML Reference*, version 3.
//!
//! - The links are the `world` and all bodies, in the order of the file.
//! - Joints of a body move it one after the other. The frame of a body is that of its last joint, and its origin is the
//!   anchor of that joint. A body without joints has a fixed frame.
//! - An attribute is that of the element, otherwise that of its default class or of the classes around it.
//! - Geoms whose `contype` and `conaffinity` are 0 are for display and are skipped.
//! - Elements that would change the geometry but are not supported are errors.

use std::collections::{HashMap, HashSet};

use colltrans::Pose;
use colltrans::motion::path::{Frame, Joint, Mechanism};
use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::files::Source;
use super::links::{LinkShape, check_hull_names};
use super::shapes::Primitive;
use super::{Budget, Names, assembly_error, contents_error};
use crate::error::ReadError;
use crate::robot::{JointKind, Link, Robot, RobotJoint};
use colltrans_assembly::AssemblyError;
use colltrans_mesh::xml::Element;

/// The name of the class that contains all others.
const MAIN_CLASS: &str = "main";
/// Attributes that define an orientation.
const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "xyaxes", "zaxis", "euler"];

/// Reads a robot from the root element of an MJCF file with this number of bytes.
pub(super) fn read_robot(source: Source, root: &Element, bytes: usize) -> Result<Robot, ReadError> {
    let mut reader = Reader {
        source: &source,
        settings: Settings::read(&source, root)?,
        classes: read_classes(&source, root)?,
        budget: Budget::with_bytes(bytes),
        names: Names::default(),
        taken: HashSet::new(),
        frames: Vec::new(),
        joints: Vec::new(),
        links: vec![Link {
            name: "world".into(),
            frame: None,
            bodies: Vec::new(),
            is_hull: false,
            dent: None,
        }],
        notes: unused_notes(root),
    };
    reader.reserve_names(root);
    let world = Scope { link: 0, frame: None, at: DAffine3::IDENTITY, class: None };
    for section in root.children_named("worldbody") {
        reader.read_children(section, world)?;
    }
    if let Some(found) =
        ["include", "deformable"].into_iter().find_map(|name| root.first_child(name))
    {
        let reason = format!("unsupported element {}; save the compiled model first", found.name);
        return Err(contents_error(source.path, place_of(found), reason));
    }
    let Reader { frames, joints, mut links, notes, .. } = reader;
    if links[0].bodies.is_empty() {
        links.remove(0);
    }
    let names: Vec<&str> = links.iter().map(|link| link.name.as_str()).collect();
    check_hull_names(&source, &names)?;
    if links.iter().all(|link| link.bodies.is_empty()) {
        let holds = format!("none of its {} bodies has a geom that collides", links.len());
        return Err(ReadError::NoParts { path: source.path.into(), holds });
    }
    let mechanism =
        Mechanism::new(frames).map_err(|e| contents_error(source.path, "joints", e.to_string()))?;
    let name = root.get("model").unwrap_or_default().to_owned();
    Ok(Robot { name, links, joints, mechanism, notes, files: source.into_files() })
}

/// Returns the place of an element, for errors.
fn place_of(element: &Element) -> String {
    format!("MJCF: line {}", element.line)
}

/// Returns notes on elements that restrict motions or contacts but are not used.
fn unused_notes(root: &Element) -> Vec<String> {
    let has = |section, element| {
        root.children_named(section).any(|section| section.first_child(element).is_some())
    };
    let equal = has("equality", "joint")
        .then_some("equality constraints of joints are not applied: give values of each joint");
    let excluded = has("contact", "exclude").then_some(
        "exclude elements are not used: give pairs of bodies to leave out, for example with --ignore A,B",
    );
    equal.into_iter().chain(excluded).map(str::to_owned).collect()
}

/// Settings of the compiler element.
struct Settings {
    /// Radians in a unit of angles.
    angle: f64,
    /// The axes of Euler angles; lower case for axes that rotate, upper case for fixed axes.
    euler_axes: Vec<char>,
}

impl Settings {
    fn read(source: &Source, root: &Element) -> Result<Self, ReadError> {
        let mut settings = Self { angle: 1.0_f64.to_radians(), euler_axes: vec!['x', 'y', 'z'] };
        for compiler in root.children_named("compiler") {
            let refused = |name: &str, accepted: &str| {
                let value = compiler.get(name).unwrap_or_default();
                let reason = format!("unsupported {name} \"{value}\"; accepted: {accepted}");
                contents_error(source.path, place_of(compiler), reason)
            };
            match compiler.get("angle") {
                Some("radian") => settings.angle = 1.0,
                Some("degree") => settings.angle = 1.0_f64.to_radians(),
                None => {}
                Some(_) => return Err(refused("angle", "degree, radian")),
            }
            if compiler.get("coordinate").is_some_and(|kind| kind != "local") {
                return Err(refused("coordinate", "local"));
            }
            if let Some(axes) = compiler.get("eulerseq") {
                settings.euler_axes = axes.chars().collect();
                if axes.len() != 3 || !axes.chars().all(|axis| "xyzXYZ".contains(axis)) {
                    return Err(refused("eulerseq", "three of xyzXYZ"));
                }
            }
        }
        Ok(settings)
    }

    /// Returns the rotation of Euler angles.
    fn euler_rotation(&self, angles: [f64; 3]) -> DMat3 {
        let mut rotation = DMat3::IDENTITY;
        for (axis, angle) in self.euler_axes.iter().zip(angles) {
            let angle = angle * self.angle;
            let about = match axis.to_ascii_lowercase() {
                'x' => DMat3::from_rotation_x(angle),
                'y' => DMat3::from_rotation_y(angle),
                _ => DMat3::from_rotation_z(angle),
            };
            rotation = if axis.is_lowercase() { rotation * about } else { about * rotation };
        }
        rotation
    }
}

/// The default elements of each class, the innermost first.
type Classes<'a> = HashMap<&'a str, Vec<&'a Element>>;

/// Reads the default classes of a file.
fn read_classes<'a>(source: &Source, root: &'a Element) -> Result<Classes<'a>, ReadError> {
    let mut classes = HashMap::from([(MAIN_CLASS, Vec::new())]);
    for element in root.children_named("default") {
        classes.entry(MAIN_CLASS).or_default().push(element);
    }
    let main = classes[MAIN_CLASS].clone();
    for element in &main {
        add_nested_classes(source, element, &main, &mut classes)?;
    }
    Ok(classes)
}

/// Adds the classes inside a default element, with the elements around them.
fn add_nested_classes<'a>(
    source: &Source,
    around: &'a Element,
    chain: &[&'a Element],
    classes: &mut Classes<'a>,
) -> Result<(), ReadError> {
    for element in around.children_named("default") {
        let refused = |reason: String| contents_error(source.path, place_of(element), reason);
        let name = element.required("class").map_err(refused)?;
        let chain: Vec<&Element> = std::iter::once(element).chain(chain.iter().copied()).collect();
        add_nested_classes(source, element, &chain, classes)?;
        if classes.insert(name, chain).is_some() {
            return Err(refused(format!("duplicate class {name}; names must be unique")));
        }
    }
    Ok(())
}

/// The attributes of an element, followed by those of its classes.
struct Attributes<'a>(Vec<&'a Element>);

impl<'a> Attributes<'a> {
    /// Returns the first element that has an attribute.
    fn owner(&self, name: &str) -> Option<&'a Element> {
        self.0.iter().copied().find(|element| element.get(name).is_some())
    }

    fn get(&self, name: &str) -> Option<&'a str> {
        self.owner(name)?.get(name)
    }

    /// Parses `N` numbers; `None` if the attribute is missing.
    fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, String> {
        let Some(owner) = self.owner(name) else { return Ok(None) };
        let numbers = owner.numbers::<N>(name)?;
        match numbers.filter(|numbers| numbers.iter().all(|x| x.is_finite())) {
            None => Err(format!("{name} of <{}> is not finite", owner.name)),
            finite => Ok(finite),
        }
    }

    fn vector(&self, name: &str, default: DVec3) -> Result<DVec3, String> {
        Ok(self.numbers::<3>(name)?.map_or(default, DVec3::from_array))
    }

    /// Parses at least `N` numbers and returns the first `N`.
    fn sizes<const N: usize>(&self) -> Result<[f64; N], String> {
        let text = self.get("size").ok_or("missing attribute size")?;
        let numbers: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse::<f64>).collect();
        numbers
            .ok()
            .and_then(|numbers| numbers.first_chunk::<N>().copied())
            .ok_or_else(|| format!("size=\"{text}\" is invalid; expected {N} numbers"))
    }
}

/// The place of elements while they are read.
#[derive(Clone, Copy)]
struct Scope<'a> {
    /// The index of the link.
    link: usize,
    /// The frame that carries the link.
    frame: Option<usize>,
    /// The transformation from the coordinates of the elements to that frame.
    at: DAffine3,
    /// The class of elements that do not name one.
    class: Option<&'a str>,
}

/// The robot while it is read.
struct Reader<'a> {
    source: &'a Source<'a>,
    settings: Settings,
    classes: Classes<'a>,
    budget: Budget,
    names: Names,
    /// The names of bodies and joints so far, with their kinds.
    taken: HashSet<(&'static str, &'a str)>,
    frames: Vec<Frame>,
    joints: Vec<RobotJoint>,
    links: Vec<Link>,
    notes: Vec<String>,
}

impl<'a> Reader<'a> {
    /// Reserves all names of the file, so that elements without a name get other ones.
    fn reserve_names(&mut self, root: &Element) {
        let mut names = vec!["world".to_owned()];
        let mut open = vec![root];
        while let Some(element) = open.pop() {
            names.extend(element.get("name").map(str::to_owned));
            open.extend(&element.children);
        }
        self.names.reserve(names.iter());
    }

    /// Returns an error about an element.
    fn error(&self, element: &Element, reason: impl std::fmt::Display) -> ReadError {
        let name = element.get("name").unwrap_or("without a name");
        let reason = format!("{} {name}: {reason}", element.name);
        contents_error(self.source.path, place_of(element), reason)
    }

    /// Returns the name of a body or joint, or a new name if it has none.
    fn name_of(&mut self, element: &'a Element, kind: &'static str) -> Result<String, ReadError> {
        let Some(name) = element.get("name") else { return Ok(self.names.unique_name(kind)) };
        if !self.taken.insert((kind, name)) || (kind == "body" && name == "world") {
            return Err(self.error(element, "duplicate name; names must be unique"));
        }
        Ok(name.to_owned())
    }

    /// Returns the attributes of an element in a scope.
    fn attributes(
        &self,
        element: &'a Element,
        kind: &'static str,
        class: Option<&str>,
    ) -> Result<Attributes<'a>, ReadError> {
        let class = element.get("class").or(class).unwrap_or(MAIN_CLASS);
        let Some(chain) = self.classes.get(class) else {
            return Err(self.error(element, format!("unknown class {class}")));
        };
        let of_classes = chain.iter().flat_map(|default| default.children_named(kind));
        Ok(Attributes(std::iter::once(element).chain(of_classes).collect()))
    }

    /// Returns the pose that the attributes of an element define.
    fn pose(&self, of: &Attributes) -> Result<DAffine3, String> {
        let position = of.vector("pos", DVec3::ZERO)?;
        Ok(DAffine3::from_mat3_translation(self.rotation(of)?, position))
    }

    fn rotation(&self, of: &Attributes) -> Result<DMat3, String> {
        let is_given =
            |element: &&&Element| ORIENTATIONS.iter().any(|name| element.get(name).is_some());
        let Some(owner) = of.0.iter().find(is_given) else { return Ok(DMat3::IDENTITY) };
        let given: Vec<&str> =
            ORIENTATIONS.into_iter().filter(|name| owner.get(name).is_some()).collect();
        let [form] = given[..] else {
            return Err(format!("several orientations: {}; accepted: one", given.join(", ")));
        };
        let of = Attributes(vec![*owner]);
        let rotation = match form {
            "quat" => of
                .numbers::<4>(form)?
                .map(|[w, x, y, z]| DMat3::from_quat(DQuat::from_xyzw(x, y, z, w).normalize())),
            "axisangle" => of.numbers::<4>(form)?.map(|[x, y, z, angle]| {
                let axis = DVec3::new(x, y, z).normalize();
                DMat3::from_axis_angle(axis, angle * self.settings.angle)
            }),
            "xyaxes" => of.numbers::<6>(form)?.map(|[a, b, c, d, e, f]| {
                let x = DVec3::new(a, b, c).normalize();
                let y = DVec3::new(d, e, f).reject_from_normalized(x).normalize();
                DMat3::from_cols(x, y, x.cross(y))
            }),
            "zaxis" => of.numbers::<3>(form)?.map(|axis| rotation_from_z(DVec3::from_array(axis))),
            _ => of.numbers::<3>(form)?.map(|angles| self.settings.euler_rotation(angles)),
        };
        let rotation = rotation.unwrap_or(DMat3::IDENTITY);
        if rotation.is_finite() {
            Ok(rotation)
        } else {
            let value = owner.get(form).unwrap_or_default();
            Err(format!("{form}=\"{value}\" is not an orientation"))
        }
    }

    /// Reads the geoms and bodies inside an element.
    fn read_children(&mut self, of: &'a Element, scope: Scope<'a>) -> Result<(), ReadError> {
        for child in &of.children {
            match child.name.as_str() {
                "geom" => self.add_geom(child, scope)?,
                "body" => self.add_body(child, scope)?,
                "frame" => {
                    let pose = self.pose(&Attributes(vec![child]));
                    let at = scope.at * pose.map_err(|reason| self.error(child, reason))?;
                    let class = child.get("childclass").or(scope.class);
                    self.read_children(child, Scope { at, class, ..scope })?;
                }
                // Read with the body.
                "joint" | "freejoint" if of.name == "body" => {}
                "inertial" | "site" | "camera" | "light" => {}
                _ => return Err(self.error(child, format!("unsupported in {}", of.name))),
            }
        }
        Ok(())
    }

    /// Adds a body with its joints and its contents.
    fn add_body(&mut self, body: &'a Element, scope: Scope<'a>) -> Result<(), ReadError> {
        let name = self.name_of(body, "body")?;
        self.budget.count_placed().map_err(|reason| self.error(body, reason))?;
        let pose = self.pose(&Attributes(vec![body])).map_err(|reason| self.error(body, reason))?;
        let class = body.get("childclass").or(scope.class);
        let mut inner = Scope { at: scope.at * pose, class, ..scope };
        let mut joints = body
            .children
            .iter()
            .filter(|child| matches!(child.name.as_str(), "joint" | "freejoint"))
            .peekable();
        if joints.peek().is_none() {
            self.add_frame(body, &mut inner, DVec3::ZERO, Joint::Fixed)?;
        }
        for element in joints {
            self.add_joint(element, &mut inner)?;
        }
        inner.link = self.links.len();
        let frame = inner.frame;
        self.links.push(Link { name, frame, bodies: Vec::new(), is_hull: false, dent: None });
        self.read_children(body, inner)
    }

    /// Adds a frame with its origin at an anchor, a point in the coordinates of the scope. The scope is moved into the
    /// new frame.
    fn add_frame(
        &mut self,
        element: &Element,
        scope: &mut Scope<'a>,
        anchor: DVec3,
        joint: Joint,
    ) -> Result<(), ReadError> {
        let DAffine3 { matrix3, translation } = scope.at * DAffine3::from_translation(anchor);
        let origin = Pose::from_matrix(matrix3, translation).map_err(|e| self.error(element, e))?;
        let frame = self.frames.len();
        self.frames.push(Frame { parent: scope.frame, origin, joint });
        scope.frame = Some(frame);
        scope.at = DAffine3::from_translation(-anchor);
        Ok(())
    }

    /// Adds a joint of a body.
    fn add_joint(&mut self, element: &'a Element, scope: &mut Scope<'a>) -> Result<(), ReadError> {
        let name = self.name_of(element, "joint")?;
        let of = self.attributes(element, "joint", scope.class)?;
        let refused = |reason: String| self.error(element, reason);
        let kind =
            if element.name == "freejoint" { "free" } else { of.get("type").unwrap_or("hinge") };
        let axis = of.vector("axis", DVec3::Z).map_err(refused)?;
        if axis == DVec3::ZERO {
            return Err(refused("invalid axis [0.0, 0.0, 0.0]; accepted: not zero".into()));
        }
        let (moves, unit) = match kind {
            "hinge" => (Joint::Turning(axis), self.settings.angle),
            "slide" => (Joint::Sliding(axis), 1.0),
            other => {
                return Err(refused(format!("unsupported type {other}; accepted: hinge, slide")));
            }
        };
        if of.numbers::<1>("ref").map_err(refused)?.is_some_and(|[at]| at != 0.0) {
            return Err(refused("unsupported ref; accepted: 0".into()));
        }
        let anchor = of.vector("pos", DVec3::ZERO).map_err(refused)?;
        let range = of.numbers::<2>("range").map_err(refused)?;
        let limits =
            range.filter(|_| of.get("limited") != Some("false")).map(|x| x.map(|x| x * unit));
        let kind = match (kind, limits) {
            ("slide", _) => JointKind::Prismatic,
            (_, None) => JointKind::Continuous,
            _ => JointKind::Revolute,
        };
        self.add_frame(element, scope, anchor, moves)?;
        let frame = self.frames.len() - 1;
        self.joints.push(RobotJoint { name, frame, kind, limits, mimic: None });
        Ok(())
    }

    /// Adds a geom to its link, unless it is for display.
    fn add_geom(&mut self, element: &'a Element, scope: Scope<'a>) -> Result<(), ReadError> {
        let of = self.attributes(element, "geom", scope.class)?;
        let refused = |reason: String| self.error(element, reason);
        let mask =
            |name: &str| -> Result<f64, String> { Ok(of.numbers::<1>(name)?.map_or(1.0, |[x]| x)) };
        let masks = [mask("contype").map_err(refused)?, mask("conaffinity").map_err(refused)?];
        if masks.iter().all(|mask| *mask == 0.0) {
            return Ok(());
        }
        let (shape, pose) = self.primitive(&of).map_err(refused)?;
        self.budget.count_placed().map_err(|reason| self.error(element, reason))?;
        self.budget
            .count_facets(shape.face_count())
            .map_err(|reason| self.error(element, reason))?;
        let placed = LinkShape::Primitive(shape, scope.at * pose);
        let link = &mut self.links[scope.link];
        let loaded = placed.body(&self.source.options.body_options()).map_err(|e| {
            let part = link.name.clone();
            assembly_error(self.source.path)(AssemblyError::Part { part, source: e })
        })?;
        link.bodies.push(loaded.body);
        let name = &link.name;
        self.notes.extend(shape.replacement_note().map(|said| format!("link {name}: {said}")));
        Ok(())
    }

    /// Returns the shape of a geom and its pose in the coordinates of the geom.
    fn primitive(&self, of: &Attributes) -> Result<(Primitive, DAffine3), String> {
        let ends = of.numbers::<6>("fromto")?;
        let kind =
            of.get("type").unwrap_or(if of.owner("mesh").is_some() { "mesh" } else { "sphere" });
        // The axis of a shape between two points runs to the first one.
        let ends = ends.map(|[a, b, c, d, e, f]| [DVec3::new(a, b, c), DVec3::new(d, e, f)]);
        let ends = ends.filter(|_| kind != "sphere");
        let length = ends.map(|[from, to]| from.distance(to));
        let with_axis = || -> Result<[f64; 2], String> {
            match length {
                Some(length) => Ok([of.sizes::<1>()?[0], length]),
                None => of.sizes::<2>().map(|[radius, half]| [radius, 2.0 * half]),
            }
        };
        let shape = match kind {
            "sphere" => Primitive::Sphere(of.sizes::<1>()?[0]),
            "capsule" => {
                with_axis().map(|[radius, length]| Primitive::Capsule { radius, length })?
            }
            "cylinder" => {
                with_axis().map(|[radius, length]| Primitive::Cylinder { radius, length })?
            }
            "box" => Primitive::Cuboid(match length {
                Some(length) => {
                    let [half] = of.sizes::<1>()?;
                    DVec3::new(2.0 * half, 2.0 * half, length)
                }
                None => DVec3::from_array(of.sizes::<3>()?) * 2.0,
            }),
            other => {
                return Err(format!(
                    "unsupported type {other}; accepted: sphere, capsule, box, cylinder, or any type with contype and \
                     conaffinity 0, which is skipped"
                ));
            }
        };
        let pose = match ends {
            None => self.pose(of)?,
            Some([from, to]) => {
                DAffine3::from_mat3_translation(rotation_from_z(from - to), from.midpoint(to))
            }
        };
        Ok((shape.checked()?, pose))
    }
}

/// Returns the shortest rotation from z to a direction; not finite if that is zero.
fn rotation_from_z(direction: DVec3) -> DMat3 {
    DMat3::from_quat(DQuat::from_rotation_arc(DVec3::Z, direction.normalize()))
}
