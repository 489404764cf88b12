//! Robots as URDF describes them: each link with a geometry is a part, in metres, placed by the chain
//! of joints from the root in one configuration.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::{DAffine3, DQuat, DVec3};
use urdf_rs::{Geometry as Shape, Joint, JointType, Link, Robot};

use super::manifest::rpy_matrix;
use super::{Geometry, ReadOptions, assembled, contents, in_file, io, piece, shapes};
use crate::error::ReadError;
use crate::part::{Assembly, Part};

pub(super) fn read(path: &Path, options: &ReadOptions) -> Result<Assembly, ReadError> {
    let text = std::fs::read_to_string(path).map_err(io(path))?;
    let robot = urdf_rs::read_from_string(&text).map_err(|e| contents(path, "URDF", e))?;
    for (name, value) in &options.joints {
        if !value.is_finite() {
            let reason = format!("the position {value} of joint {name} is not finite");
            return Err(contents(path, "joints", reason));
        }
        if robot.joints.iter().all(|j| j.name != *name) {
            return Err(contents(path, "joints", format!("there is no joint {name}")));
        }
    }
    let places = places(path, &robot, options)?;
    let finder = Finder { folder: path.parent().unwrap_or(Path::new(".")), options };
    let (mut parts, mut missing, mut notes) = (Vec::new(), Vec::new(), Vec::new());
    let mut read = Vec::new();
    for link in &robot.links {
        let world = places[link.name.as_str()];
        let mut pieces = Vec::new();
        for (origin, shape) in geometries(link, options.geometry) {
            if let Some(reason) = refused(origin, shape) {
                return Err(contents(path, format!("link {}", link.name), reason));
            }
            let at = world * pose(origin);
            match shape {
                Shape::Mesh { filename, scale } => match finder.find(filename) {
                    Some(file) => {
                        let scale = scale.map_or(DVec3::ONE, |s| DVec3::from_array(s.0));
                        pieces.push(piece(&file, at * DAffine3::from_scale(scale))?);
                        read.push(file);
                    }
                    None => missing.push(filename.clone()),
                },
                Shape::Box { size } => pieces.push(shapes::cuboid(DVec3::from_array(size.0), at)),
                Shape::Cylinder { radius, length } => {
                    pieces.push(shapes::cylinder(*radius, *length, at));
                }
                Shape::Sphere { radius } => pieces.push(shapes::sphere(*radius, at)),
                Shape::Capsule { .. } => {
                    notes.push(format!("link {}: a capsule is left out", link.name));
                }
            }
        }
        if !pieces.is_empty() {
            parts.push(Part::new(&link.name, &pieces).map_err(in_file(path))?);
        }
    }
    if !missing.is_empty() && !options.skip_missing {
        return Err(ReadError::Missing { path: path.into(), missing });
    }
    notes.extend(missing.iter().map(|file| format!("{file} cannot be found and is left out")));
    let assembly = assembled(path, parts, read)?.with_unit("m");
    Ok(notes.into_iter().fold(assembly, Assembly::with_note))
}

/// What is wrong with the numbers of a geometry.
fn refused(origin: &urdf_rs::Pose, shape: &Shape) -> Option<String> {
    let finite = origin.xyz.0.iter().chain(&origin.rpy.0).all(|x| x.is_finite());
    if !finite {
        return Some(format!("its origin {:?}, {:?} is not finite", origin.xyz.0, origin.rpy.0));
    }
    let (what, sizes) = match shape {
        Shape::Box { size } => ("box", size.0.to_vec()),
        Shape::Cylinder { radius, length } => ("cylinder", vec![*radius, *length]),
        Shape::Sphere { radius } => ("sphere", vec![*radius]),
        Shape::Mesh { .. } | Shape::Capsule { .. } => return None,
    };
    let sound = sizes.iter().all(|x| x.is_finite() && *x > 0.0);
    (!sound).then(|| format!("a {what} of {sizes:?}: sizes must be finite and positive"))
}

fn geometries(link: &Link, which: Geometry) -> Vec<(&urdf_rs::Pose, &Shape)> {
    match which {
        Geometry::Collision => link.collision.iter().map(|c| (&c.origin, &c.geometry)).collect(),
        Geometry::Visual => link.visual.iter().map(|v| (&v.origin, &v.geometry)).collect(),
    }
}

fn pose(pose: &urdf_rs::Pose) -> DAffine3 {
    DAffine3::from_mat3_translation(rpy_matrix(pose.rpy.0), DVec3::from_array(pose.xyz.0))
}

/// Where each link is: root links at the world's origin.
fn places<'a>(
    path: &Path,
    robot: &'a Robot,
    options: &ReadOptions,
) -> Result<HashMap<&'a str, DAffine3>, ReadError> {
    let mut joint_to: HashMap<&str, &Joint> = HashMap::new();
    for joint in &robot.joints {
        for link in [&joint.parent.link, &joint.child.link] {
            if robot.links.iter().all(|l| l.name != *link) {
                let reason = format!("there is no link {link}");
                return Err(contents(path, format!("joint {}", joint.name), reason));
            }
        }
        if joint_to.insert(&joint.child.link, joint).is_some() {
            let reason = format!("link {} is the child of a second joint", joint.child.link);
            return Err(contents(path, format!("joint {}", joint.name), reason));
        }
    }
    let mut places = HashMap::new();
    for link in &robot.links {
        let (mut at, mut name) = (DAffine3::IDENTITY, link.name.as_str());
        for _ in 0..=robot.joints.len() {
            let Some(joint) = joint_to.get(name) else { break };
            at = pose(&joint.origin) * motion(robot, joint, options) * at;
            name = &joint.parent.link;
        }
        if joint_to.contains_key(name) {
            return Err(contents(path, format!("link {}", link.name), "its joints form a ring"));
        }
        places.insert(link.name.as_str(), at);
    }
    Ok(places)
}

fn motion(robot: &Robot, joint: &Joint, options: &ReadOptions) -> DAffine3 {
    let position = position(robot, joint, options, 8);
    let axis = DVec3::from_array(joint.axis.xyz.0).normalize_or_zero();
    match joint.joint_type {
        JointType::Revolute | JointType::Continuous if position != 0.0 && axis != DVec3::ZERO => {
            DAffine3::from_quat(DQuat::from_axis_angle(axis, position))
        }
        JointType::Prismatic => DAffine3::from_translation(axis * position),
        _ => DAffine3::IDENTITY,
    }
}

/// The position of a joint: as given, or that of the joint it mimics.
fn position(robot: &Robot, joint: &Joint, options: &ReadOptions, depth: usize) -> f64 {
    if let Some(given) = options.joints.get(&joint.name) {
        return *given;
    }
    let Some(mimic) = joint.mimic.as_ref().filter(|_| depth > 0) else { return 0.0 };
    let Some(other) = robot.joints.iter().find(|j| j.name == mimic.joint) else { return 0.0 };
    let value = position(robot, other, options, depth - 1);
    value * mimic.multiplier.unwrap_or(1.0) + mimic.offset.unwrap_or(0.0)
}

struct Finder<'a> {
    folder: &'a Path,
    options: &'a ReadOptions,
}

impl Finder<'_> {
    fn find(&self, name: &str) -> Option<PathBuf> {
        if let Some(rest) = name.strip_prefix("package://") {
            return self.in_packages(rest);
        }
        let name = name.strip_prefix("file://").unwrap_or(name);
        let file = self.folder.join(name);
        if file.is_file() { Some(file) } else { self.in_packages(name) }
    }

    /// In the given roots: with the package's name, without it, then with fewer leading folders.
    fn in_packages(&self, rest: &str) -> Option<PathBuf> {
        let mut rest = Some(rest);
        while let Some(tail) = rest.filter(|tail| !tail.is_empty()) {
            let found = self.options.packages.iter().map(|root| root.join(tail));
            if let Some(file) = found.into_iter().find(|file| file.is_file()) {
                return Some(file);
            }
            rest = tail.split_once('/').map(|(_, tail)| tail);
        }
        None
    }
}
