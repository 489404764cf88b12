//! Two sections and their contact by brute force: all corners of one against all sides of the other. The features in
//! contact yield the contact as an affine function of the two levels, and therefore the complete cell of the mark.
//!
//! As in the library, `a`, `b` are the section axes, `x`, `y` the levels. Shadow coordinates are those of a view
//! along `d`: `g` to the right, `h` upwards.

use std::collections::BTreeMap;

use colltrans::observe::{SectionContact, Sections};
use glam::{DMat4, DVec2, DVec3, DVec4};

use super::setting::{Setting, below};

/// A body in the world, at its start.
#[derive(Debug)]
pub(super) struct Placed {
    pub(super) vertices: Vec<DVec3>,
    /// Faces: unit outward normal, level along it, and corners.
    pub(super) faces: Vec<(DVec3, f64, Vec<usize>)>,
    /// Edges: two vertices and two faces.
    pub(super) edges: Vec<([usize; 2], [usize; 2])>,
}

impl Placed {
    /// Transforms a body of a setting to the world.
    fn new(setting: &Setting, body: usize) -> Self {
        let (whole, pose) = (&setting.bodies[body], &setting.poses[body]);
        let vertices: Vec<DVec3> =
            whole.vertices().iter().map(|&v| pose.transform_point(v)).collect();
        let mut faces = Vec::new();
        for face in 0..whole.face_count() as u32 {
            let corners: Vec<usize> = whole.face_vertices(face).map(|v| v as usize).collect();
            let normal = pose.matrix() * whole.face_normal(face);
            faces.push((normal, normal.dot(vertices[corners[0]]), corners));
        }
        let mut edges: Vec<([usize; 2], [usize; 2])> = Vec::new();
        let mut indices: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        for (face, (.., corners)) in faces.iter().enumerate() {
            for (k, &from) in corners.iter().enumerate() {
                let to = corners[(k + 1) % corners.len()];
                if let Some(&edge) = indices.get(&[to, from]) {
                    edges[edge].1[1] = face;
                } else {
                    indices.insert([from, to], edges.len());
                    edges.push(([from, to], [face, face]));
                }
            }
        }
        Self { vertices, faces, edges }
    }
}

/// A section: corners counter-clockwise in a view along `d`, each on an edge, and the face between each corner and
/// the next one.
#[derive(Debug, Clone)]
pub(super) struct Section {
    pub(super) corners: Vec<DVec3>,
    edges: Vec<usize>,
    faces: Vec<usize>,
}

/// The bodies with their section axes, viewed along the direction.
#[derive(Debug)]
pub(super) struct View {
    pub(super) bodies: [Placed; 2],
    pub(super) direction: DVec3,
    /// Unit vectors to the right and upwards.
    right: DVec3,
    up: DVec3,
    axes: [DVec3; 2],
    origins: [DVec3; 2],
}

/// A face, by its body and its index there.
pub(super) type Face = (usize, usize);

/// Faces in contact, position in the shadow, and kind of contact.
type Lowest = ([Face; 2], DVec2, SectionContact);

/// Side of a section, direction across it, corners that bound the gap, and its width.
type Gap = (Face, DVec2, [usize; 2], f64);

/// Features that determine the contact in a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Features {
    /// Two faces: one of each body, or two of the same body that share an edge.
    Touching([Face; 2]),
    /// Side of a section, by its body and face, along which the gap is widest, and the edge of the other body with
    /// the corner that bounds the gap.
    Apart(Face, usize),
}

/// Two sections with their contact or gap.
#[derive(Debug, Clone)]
pub(super) struct Instance {
    pub(super) sections: [Section; 2],
    pub(super) features: Features,
    pub(super) touch: SectionContact,
    /// `phi`, or the width of the gap.
    pub(super) value: f64,
    /// Gradient of the value with respect to the levels.
    pub(super) gradient: DVec2,
    /// In the shadow: the point of contact, twice; or the two corners that bound the gap.
    pub(super) points: [DVec2; 2],
    /// Direction of the line through these points: across the shadow, or along the gap.
    pub(super) line: DVec2,
}

impl View {
    /// Creates the view of a setting with the section axes of a run.
    pub(super) fn new(setting: &Setting, told: &Sections) -> Self {
        let d = setting.direction;
        let [a, b] = told.axes;
        let up = (a / a.dot(d) - b / b.dot(d)).normalize();
        let bodies = [0, 1].map(|body| Placed::new(setting, body));
        let origins = setting.poses.map(|pose| pose.translation());
        Self { bodies, direction: d, right: d.cross(up), up, axes: told.axes, origins }
    }

    /// Returns the levels of all vertices of a body, ascending.
    pub(super) fn vertex_levels(&self, body: usize) -> Vec<f64> {
        let level = |v: &DVec3| self.axes[body].dot(*v - self.origins[body]);
        let mut levels: Vec<f64> = self.bodies[body].vertices.iter().map(level).collect();
        levels.sort_by(f64::total_cmp);
        levels
    }

    /// Projects a point along the direction.
    pub(super) fn shadow(&self, w: DVec3) -> DVec2 {
        DVec2::new(self.right.dot(w), self.up.dot(w))
    }

    /// Returns the section of a body at a level; `None` if it has no area.
    pub(super) fn section(&self, body: usize, level: f64) -> Option<Section> {
        let Placed { vertices, edges, .. } = &self.bodies[body];
        let height = |v: usize| self.axes[body].dot(vertices[v] - self.origins[body]) - level;
        let mut found = Vec::new();
        for (edge, ([from, to], _)) in edges.iter().enumerate() {
            let [u, v] = [height(*from), height(*to)];
            if (u < 0.0) != (v < 0.0) {
                found.push((edge, vertices[*from].lerp(vertices[*to], u / (u - v))));
            }
        }
        let (&(first, at), count) = (found.first()?, found.len());
        let mut section = Section { corners: vec![at], edges: vec![first], faces: Vec::new() };
        let mut face = edges[first].1[0];
        while section.faces.len() + 1 < count {
            let last = *section.edges.last()?;
            let next =
                found.iter().find(|(edge, _)| *edge != last && edges[*edge].1.contains(&face));
            let &(edge, at) = next?;
            section.faces.push(face);
            section.corners.push(at);
            section.edges.push(edge);
            face = if edges[edge].1[0] == face { edges[edge].1[1] } else { edges[edge].1[0] };
        }
        section.faces.push(face);
        let flat: Vec<DVec2> = section.corners.iter().map(|&w| self.shadow(w)).collect();
        let area: f64 = (0..count).map(|k| flat[k].perp_dot(flat[(k + 1) % count])).sum();
        if count < 3 || area == 0.0 {
            return None;
        }
        if area < 0.0 {
            section.corners.reverse();
            section.edges.reverse();
            section.faces.reverse();
            section.faces.rotate_left(1);
        }
        Some(section)
    }

    /// Solves the planar problem at a pair of levels.
    pub(super) fn instance(&self, levels: DVec2) -> Option<Instance> {
        let sections = [self.section(0, levels.x)?, self.section(1, levels.y)?];
        let flat = sections
            .each_ref()
            .map(|s| s.corners.iter().map(|&w| self.shadow(w)).collect::<Vec<_>>());
        let touching = self.lowest(&sections, &flat);
        let Some((faces, point, touch)) = touching else {
            return self.apart(sections, &flat);
        };
        let contact = self.contact(faces)?;
        Some(Instance {
            sections,
            features: Features::Touching(faces),
            touch,
            value: contact.at(levels).w,
            gradient: contact.gradient(),
            points: [point; 2],
            line: DVec2::X,
        })
    }

    /// Returns the lowest common point and its faces; `None` if the sections do not meet.
    fn lowest(&self, sections: &[Section; 2], flat: &[Vec<DVec2>; 2]) -> Option<Lowest> {
        let side = |body: usize, k: usize| (flat[body][k], flat[body][(k + 1) % flat[body].len()]);
        let mut best: Option<Lowest> = None;
        let mut take = |faces, at: DVec2, touch| {
            if best.is_none_or(|(_, least, _)| at.y < least.y) {
                best = Some((faces, at, touch));
            }
        };
        for body in 0..2 {
            let other = 1 - body;
            for (k, &at) in flat[body].iter().enumerate() {
                let inside = (0..flat[other].len()).all(|m| {
                    let (from, to) = side(other, m);
                    (to - from).perp_dot(at - from) >= 0.0
                });
                if inside {
                    let faces = self.bodies[body].edges[sections[body].edges[k]].1;
                    take(faces.map(|face| (body, face)), at, SectionContact::Vertex);
                }
            }
        }
        for k in 0..flat[0].len() {
            for m in 0..flat[1].len() {
                let ((p, p_to), (q, q_to)) = (side(0, k), side(1, m));
                let (r, s) = (p_to - p, q_to - q);
                let cross = r.perp_dot(s);
                let (u, v) = ((q - p).perp_dot(s) / cross, (q - p).perp_dot(r) / cross);
                if (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v) {
                    take(
                        [(0, sections[0].faces[k]), (1, sections[1].faces[m])],
                        p + r * u,
                        SectionContact::Edges,
                    );
                }
            }
        }
        best
    }

    /// Returns the gap at the side of both sections where it is widest.
    fn apart(&self, sections: [Section; 2], flat: &[Vec<DVec2>; 2]) -> Option<Instance> {
        let mut widest: Option<Gap> = None;
        for body in 0..2 {
            for (k, &from) in flat[body].iter().enumerate() {
                let to = flat[body][(k + 1) % flat[body].len()];
                // From P to Q.
                let outwards = (from - to).perp().normalize();
                let u = if body == 0 { outwards } else { -outwards };
                let extreme = |of: usize, sign: f64| {
                    let far = |k: &usize| sign * u.dot(flat[of][*k]);
                    (0..flat[of].len()).max_by(|a, b| far(a).total_cmp(&far(b)))
                };
                let ends = [extreme(0, 1.0)?, extreme(1, -1.0)?];
                let gap = u.dot(flat[1][ends[1]] - flat[0][ends[0]]);
                if widest.is_none_or(|(.., most)| gap > most) {
                    widest = Some(((body, sections[body].faces[k]), u, ends, gap));
                }
            }
        }
        let (side, u, ends, gap) = widest?;
        let edges = [0, 1].map(|body| sections[body].edges[ends[body]]);
        let rate = |body: usize| {
            let [from, to] =
                self.bodies[body].edges[edges[body]].0.map(|v| self.bodies[body].vertices[v]);
            u.dot(self.shadow(to - from)) / self.axes[body].dot(to - from)
        };
        Some(Instance {
            features: Features::Apart(side, edges[1 - side.0]),
            touch: SectionContact::Separated,
            value: gap,
            gradient: DVec2::new(-rate(0), rate(1)),
            points: [0, 1].map(|body| flat[body][ends[body]]),
            line: u.perp(),
            sections,
        })
    }

    /// Returns the contact on two faces as a function of the levels; `None` if their planes do not determine it.
    pub(super) fn contact(&self, faces: [Face; 2]) -> Option<Contact> {
        let d = self.direction;
        let row = |body: usize, n: DVec3| n.extend(if body == 0 { 0.0 } else { n.dot(d) });
        let plane = |(body, face): Face| {
            let (normal, level, _) = &self.bodies[body].faces[face];
            (row(body, *normal), *level)
        };
        let ((r0, c0), (r1, c1)) = (plane(faces[0]), plane(faces[1]));
        let [a, b] = self.axes;
        let rows = DMat4::from_cols(r0, r1, row(0, a), row(1, b)).transpose();
        if rows.determinant().abs() < 1e-12 {
            return None;
        }
        let back = rows.inverse();
        let origin = back * DVec4::new(c0, c1, a.dot(self.origins[0]), b.dot(self.origins[1]));
        Some(Contact { origin, by: [back.col(2), back.col(3)] })
    }

    /// Returns the complete cell in which two faces are in contact: the levels at which the contact is in both
    /// bodies.
    pub(super) fn cell(&self, faces: [Face; 2], [low, high]: [DVec2; 2]) -> Vec<DVec2> {
        let Some(contact) = self.contact(faces) else { return Vec::new() };
        let mut cell = vec![low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        for body in 0..2 {
            for (face, (normal, level, _)) in self.bodies[body].faces.iter().enumerate() {
                if faces.contains(&(body, face)) {
                    continue;
                }
                let row = normal.extend(if body == 0 { 0.0 } else { normal.dot(self.direction) });
                let gradient = DVec2::from_array(contact.by.map(|by| row.dot(by)));
                cell = below(&cell, gradient, level - row.dot(contact.origin));
            }
        }
        cell
    }
}

/// Contact of two faces: the point of P in the world and the translation of P, affine in the levels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contact {
    origin: DVec4,
    by: [DVec4; 2],
}

impl Contact {
    /// Returns the contact at a pair of levels.
    pub(super) fn at(&self, levels: DVec2) -> DVec4 {
        self.origin + self.by[0] * levels.x + self.by[1] * levels.y
    }

    /// Returns the gradient of `phi`.
    pub(super) fn gradient(&self) -> DVec2 {
        DVec2::new(self.by[0].w, self.by[1].w)
    }
}
