//! Reads a URDF robot with its joints: links with bodies, each in the frame of its link. Other formats have readers of
//! their own.
//!
//! - The frame of a link is that of the joint above it, or the world.
//! - The angles of the file are converted once to matrices, whose entries define the frames from then on.
//! - Spheres and capsules are exact rounded bodies. A cylinder becomes a circumscribed prism, so that a path that is
//!   proven free is free for the true shapes.

use std::collections::HashMap;

use colltrans::Pose;
use colltrans::motion::path::{Frame, Joint, Mechanism};
use glam::{DAffine3, DVec3};

use super::files::Source;
use super::links::{build_link, check_hull_names, check_links};
use super::urdf::{self, PartGatherer};
use super::{contents_error, mjcf, sdf};
use crate::error::ReadError;
use crate::robot::{JointKind, Mimic, Robot, RobotJoint};
use colltrans_mesh::xml::Element;

/// Reads a robot from a URDF, SDF or MJCF file. The root element selects the format.
pub(super) fn read_robot(source: Source) -> Result<Robot, ReadError> {
    let (element, bytes) = urdf::parse_root(&source)?;
    match element.name.as_str() {
        "mujoco" => return mjcf::read_robot(source, &element, bytes),
        "sdf" => return sdf::read_robot(source, &element, bytes),
        _ => {}
    }
    urdf::check_robot(&source, &element)?;
    let joints = urdf::read_joints(&source, &element)?;
    // Rejects cycles, unknown links, and links with two parents.
    urdf::link_poses(&source, &element, &joints)?;
    let mut tree = TreeBuilder {
        source: &source,
        frames: Vec::new(),
        frame_of_link: HashMap::new(),
        joints: Vec::new(),
    };
    let above: HashMap<&str, (&str, &urdf::Joint)> =
        joints.iter().map(|(name, joint)| (joint.child, (*name, joint))).collect();
    let names: Vec<&str> = element
        .children_named("link")
        .map(|link| urdf::element_name(&source, link))
        .collect::<Result<_, _>>()?;
    for name in &names {
        // Collects the links up to one whose frame is known, then adds their frames downwards.
        let mut way = vec![*name];
        while let Some((_, joint)) = above.get(way[way.len() - 1])
            && !tree.frame_of_link.contains_key(joint.parent)
        {
            way.push(joint.parent);
        }
        for link in way.into_iter().rev() {
            tree.add_link(link, above.get(link).copied())?;
        }
    }
    let mechanism = Mechanism::new(tree.frames)
        .map_err(|e| contents_error(source.path, "joints", e.to_string()))?;
    let joints = set_mimics(&source, tree.joints, &joints)?;
    check_hull_names(&source, &names)?;
    let mut gathered = PartGatherer::new(&source, bytes);
    let mut links = Vec::new();
    let mut notes = Vec::new();
    for link in element.children_named("link") {
        let name = urdf::element_name(&source, link)?;
        let shapes = gathered.link_shapes(link, name, DAffine3::IDENTITY)?;
        let frame = tree.frame_of_link[name];
        links.push(build_link(&source, name, frame, &shapes, &mut notes)?);
    }
    check_links(&source, &links, gathered.missing, &mut notes)?;
    let name = element.get("name").unwrap_or_default().to_owned();
    Ok(Robot { name, links, joints, mechanism, notes, files: source.into_files() })
}

/// The kinematic tree while it is built.
struct TreeBuilder<'a> {
    source: &'a Source<'a>,
    frames: Vec<Frame>,
    frame_of_link: HashMap<&'a str, Option<usize>>,
    joints: Vec<RobotJoint>,
}

impl<'a> TreeBuilder<'a> {
    /// Adds the frame of a link. The frame of its parent must exist.
    fn add_link(
        &mut self,
        link: &'a str,
        above: Option<(&str, &urdf::Joint<'a>)>,
    ) -> Result<(), ReadError> {
        if self.frame_of_link.contains_key(link) {
            return Ok(());
        }
        let Some((name, joint)) = above else {
            self.frame_of_link.insert(link, None);
            return Ok(());
        };
        let refused =
            |reason: String| contents_error(self.source.path, format!("joint {name}"), reason);
        let (kind, moves) = joint_motion(joint.element).map_err(refused)?;
        let DAffine3 { matrix3, translation } = joint.origin;
        let origin = Pose::from_matrix(matrix3, translation).map_err(|e| refused(e.to_string()))?;
        let frame = self.frames.len();
        self.frames.push(Frame { parent: self.frame_of_link[joint.parent], origin, joint: moves });
        self.frame_of_link.insert(link, Some(frame));
        if let Some(kind) = kind {
            let limits = joint_limits(joint.element)
                .map_err(refused)?
                .filter(|_| kind != JointKind::Continuous);
            self.joints.push(RobotJoint { name: name.into(), frame, kind, limits, mimic: None });
        }
        Ok(())
    }
}

/// Returns the kind of a joint (`None` if fixed) and its motion.
fn joint_motion(element: &Element) -> Result<(Option<JointKind>, Joint), String> {
    let axis = match element.first_child("axis") {
        Some(axis) => axis.numbers::<3>("xyz")?.unwrap_or([1.0, 0.0, 0.0]),
        None => [1.0, 0.0, 0.0],
    };
    let axis = DVec3::from_array(axis);
    let kind = element.required("type")?;
    if matches!(kind, "revolute" | "continuous" | "prismatic")
        && !(axis.length() > 0.0 && axis.is_finite())
    {
        return Err(format!("invalid axis {:?}; accepted: finite and not zero", axis.to_array()));
    }
    match kind {
        "fixed" => Ok((None, Joint::Fixed)),
        "revolute" => Ok((Some(JointKind::Revolute), Joint::Turning(axis))),
        "continuous" => Ok((Some(JointKind::Continuous), Joint::Turning(axis))),
        "prismatic" => Ok((Some(JointKind::Prismatic), Joint::Sliding(axis))),
        other => Err(format!(
            "unsupported type {other}; accepted: fixed, revolute, continuous, prismatic"
        )),
    }
}

/// Returns the limits of a joint. `None` if there are no limits, or both are 0.
fn joint_limits(element: &Element) -> Result<Option<[f64; 2]>, String> {
    let Some(limit) = element.first_child("limit") else { return Ok(None) };
    let lower = limit.numbers::<1>("lower")?.map_or(0.0, |[x]| x);
    let upper = limit.numbers::<1>("upper")?.map_or(0.0, |[x]| x);
    Ok((lower != 0.0 || upper != 0.0).then_some([lower, upper]))
}

/// Sets the joint that each joint mimics. Rejects unknown joints and cycles.
fn set_mimics(
    source: &Source,
    mut joints: Vec<RobotJoint>,
    elements: &urdf::Joints,
) -> Result<Vec<RobotJoint>, ReadError> {
    let places: HashMap<String, usize> =
        joints.iter().enumerate().map(|(k, joint)| (joint.name.clone(), k)).collect();
    for RobotJoint { name, mimic, .. } in &mut joints {
        let refused = |reason: String| contents_error(source.path, format!("joint {name}"), reason);
        let Some(found) = elements[name.as_str()].element.first_child("mimic") else { continue };
        let of = found.required("joint").map_err(refused)?;
        let place = places.get(of).copied();
        let joint =
            place.ok_or_else(|| refused(format!("it mimics {of}, which is not a moving joint")))?;
        let number = |what: &str, default: f64| {
            let number = found.numbers::<1>(what).map_err(refused)?;
            Ok::<f64, ReadError>(number.map_or(default, |[x]| x))
        };
        let (multiplier, offset) = (number("multiplier", 1.0)?, number("offset", 0.0)?);
        *mimic = Some(Mimic { joint, multiplier, offset });
    }
    for joint in &joints {
        let mut at = joint;
        for _ in 0..joints.len() {
            let Some(mimic) = at.mimic else { break };
            at = &joints[mimic.joint];
        }
        if at.mimic.is_some() {
            let reason = "mimic elements form a cycle";
            return Err(contents_error(source.path, format!("joint {}", joint.name), reason));
        }
    }
    Ok(joints)
}
