//! From the bytes of a file to a body, and to what a page draws of it.
//!
//! Numbers of an answer: the vertices (three `f64` each), the triangles (three `u32` each), the face
//! of each triangle (`u32`), the edges to be drawn (two `u32` each). Vertices are those of the body.

use std::collections::HashMap;
use std::path::Path;
use std::sync::OnceLock;

use colltrans::{BuildError, ConvexPolyhedron, Feature, ShellKind, Solid, SolidError};
use colltrans_mesh::{Format, Mesh};
use glam::DVec3;
use serde_json::{Value, json};

use crate::answer::{Answer, Refusal};
use crate::question::Take;

/// How deep a face may lie below the hull, as a part of the mesh's extent: as on the command line.
const CONVEX_TOLERANCE: f64 = 1e-5;
/// Edges of a solid whose faces make a smaller angle are not drawn: its cosine.
const SMOOTH: f64 = 0.94;

/// A body in use.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "there are two, and they stay where they are")]
pub(crate) enum Part {
    Convex(Hull),
    Solid(Facets),
}

/// A convex body.
#[derive(Debug)]
pub(crate) struct Hull {
    pub(crate) body: ConvexPolyhedron,
    /// The same as a solid, made when it is asked about with one.
    solid: OnceLock<Result<Facets, String>>,
}

/// A solid.
#[derive(Debug)]
pub(crate) struct Facets {
    pub(crate) body: Solid,
    /// How far apart vertices may be written that were meant to be one: a length.
    pub(crate) precision: f64,
}

impl Part {
    pub(crate) fn facets(&self) -> Result<&Facets, String> {
        match self {
            Self::Solid(facets) => Ok(facets),
            Self::Convex(hull) => hull
                .solid
                .get_or_init(|| {
                    let solid = Solid::from_convex(&hull.body).map_err(|e| e.to_string())?;
                    Ok(Facets { body: solid, precision: 0.0 })
                })
                .as_ref()
                .map_err(Clone::clone),
        }
    }
}

/// What is said about a body.
#[derive(Debug)]
struct Facts {
    kind: &'static str,
    faces: usize,
    edges: usize,
    dimension: u8,
    closed: bool,
    /// Of a surface, how many shells there are of each kind.
    shells: Option<[usize; 3]>,
    volume: f64,
    bounds: [[f64; 3]; 2],
    /// What was merged, mended or filled.
    notes: Vec<String>,
}

/// What is drawn.
#[derive(Debug, Default)]
struct Drawn {
    triangles: Vec<[u32; 3]>,
    faces: Vec<u32>,
    edges: Vec<[u32; 2]>,
}

pub(crate) fn read(name: &str, file: Vec<u8>) -> Result<Mesh, Refusal> {
    let path = Path::new(name);
    let format = Format::of_path(path).map_err(|error| error.to_string())?;
    colltrans_mesh::parse(format, file, path).map_err(|error| error.to_string().into())
}

pub(crate) fn build(mesh: &Mesh, name: &str, take: Take) -> Result<(Part, Answer), Refusal> {
    let mut notes: Vec<String> = merged(mesh).into_iter().collect();
    match take {
        Take::Convex | Take::Hull => {
            let body = if take == Take::Hull {
                ConvexPolyhedron::from_points(&mesh.vertices)
            } else {
                let tolerance = CONVEX_TOLERANCE * mesh.extent();
                ConvexPolyhedron::from_mesh(&mesh.vertices, &mesh.faces, tolerance)
            };
            let body = body.map_err(|error| refused_hull(name, &error))?;
            if take == Take::Hull {
                notes.extend(filled(mesh, &body));
            }
            let answer = answer(&convex_facts(&body, notes), body.vertices(), &of_hull(&body));
            Ok((Part::Convex(Hull { body, solid: OnceLock::new() }), answer))
        }
        Take::Solid | Take::Open => {
            let body = match Solid::from_mesh(&mesh.vertices, &mesh.faces) {
                Err(SolidError::Open { .. }) if take == Take::Open => {
                    Solid::from_open_mesh(&mesh.vertices, &mesh.faces)
                }
                built => built,
            };
            let body = body.map_err(|error| refused_solid(name, &error))?;
            notes.extend(mended(&body));
            let surface = body.report().surface();
            notes.extend(surface.map(|surface| format!("an open surface: {surface}")));
            let answer = answer(&solid_facts(&body, notes), body.vertices(), &of_solid(&body));
            let precision = mesh.merged.tolerance;
            Ok((Part::Solid(Facets { body, precision }), answer))
        }
    }
}

fn refused_hull(name: &str, error: &BuildError) -> Refusal {
    let instead = match error {
        BuildError::Topology(colltrans::TopologyError::OpenEdge { .. }) => vec!["hull", "open"],
        BuildError::NotConvex { .. } | BuildError::InsideOut { .. } | BuildError::Topology(_) => {
            vec!["solid", "hull"]
        }
        _ => Vec::new(),
    };
    Refusal { instead, ..format!("{name}: {error}").into() }
}

fn refused_solid(name: &str, error: &SolidError) -> Refusal {
    match error {
        SolidError::Open { count, from, to, facet } => {
            let edges = if *count == 1 { "edge has" } else { "edges have" };
            let error = format!(
                "{name}: the surface is not closed: {count} {edges} a face on one side only, the \
                 first runs from vertex {from} to vertex {to} of face {facet}"
            );
            Refusal { instead: vec!["open", "hull"], ..error.into() }
        }
        other => Refusal { instead: vec!["hull"], ..format!("{name}: {other}").into() },
    }
}

/// What was merged when a mesh was read, if anything was.
fn merged(mesh: &Mesh) -> Option<String> {
    let merged = &mesh.merged;
    (merged.vertices > 0).then(|| {
        format!(
            "{} vertices on open edges merged with another, at most {:.1e} away",
            merged.vertices, merged.largest_distance
        )
    })
}

/// What a hull has more than its mesh.
fn filled(mesh: &Mesh, body: &ConvexPolyhedron) -> Option<String> {
    let part = mesh.signed_volume();
    let closed = mesh.open_edges().is_empty();
    let more = body.volume() / part - 1.0;
    (closed && part > 0.0 && more > CONVEX_TOLERANCE)
        .then(|| format!("the hull has {:.1} % more volume than the part", 100.0 * more))
}

/// What was mended when a solid was built.
fn mended(body: &Solid) -> Vec<String> {
    let report = body.report();
    let told = [
        (report.turned(), "shells inside out in the file, turned"),
        (report.facets_without_area, "faces without area left out"),
        (report.slits_closed, "slits without area closed"),
        (report.open_edges, "edges with a face on one side only"),
    ];
    told.iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, what)| format!("{count} {what}"))
        .collect()
}

fn bounds(vertices: &[DVec3]) -> [[f64; 3]; 2] {
    let first = vertices.first().copied().unwrap_or_default();
    let [low, high] = vertices.iter().fold([first; 2], |[low, high], &v| [low.min(v), high.max(v)]);
    [low.to_array(), high.to_array()]
}

fn convex_facts(body: &ConvexPolyhedron, notes: Vec<String>) -> Facts {
    Facts {
        kind: "convex",
        faces: body.face_count(),
        edges: body.edge_count(),
        dimension: body.dimension(),
        closed: true,
        shells: None,
        volume: body.volume(),
        bounds: bounds(body.vertices()),
        notes,
    }
}

fn solid_facts(body: &Solid, notes: Vec<String>) -> Facts {
    let faces = body.facet_indices().iter().max().map_or(0, |last| *last as usize + 1);
    Facts {
        kind: "solid",
        faces,
        edges: 0,
        dimension: 3,
        closed: body.is_closed(),
        shells: (!body.is_closed()).then(|| ShellKind::ALL.map(|kind| body.report().count(kind))),
        volume: body.volume(),
        bounds: bounds(body.vertices()),
        notes,
    }
}

/// Faces as fans; every edge once.
fn of_hull(body: &ConvexPolyhedron) -> Drawn {
    let mut drawn = Drawn::default();
    for face in 0..body.face_count() as u32 {
        let corners: Vec<u32> = body.face_vertices(face).collect();
        for edge in corners.windows(2).skip(1) {
            drawn.triangles.push([corners[0], edge[0], edge[1]]);
            drawn.faces.push(face);
        }
    }
    for v in 0..body.vertices().len() as u32 {
        let later = body.neighbours(v).iter().filter(|w| **w > v);
        drawn.edges.extend(later.map(|w| [v, *w]));
    }
    drawn
}

/// Edges are those between faces that make an angle, and open ones.
fn of_solid(body: &Solid) -> Drawn {
    let vertices = body.vertices();
    let normal = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| vertices[v as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let mut sides: HashMap<[u32; 2], (DVec3, bool)> = HashMap::new();
    for triangle in body.triangles() {
        let n = normal(triangle);
        for k in 0..3 {
            let [a, b] = [triangle[k], triangle[(k + 1) % 3]];
            sides
                .entry([a.min(b), a.max(b)])
                .and_modify(|(other, smooth)| *smooth = other.dot(n) > SMOOTH)
                .or_insert((n, false));
        }
    }
    let sharp = sides.iter().filter(|(_, (_, smooth))| !smooth).map(|(edge, _)| *edge);
    let mut edges: Vec<[u32; 2]> = sharp.collect();
    edges.sort_unstable();
    Drawn { triangles: body.triangles().to_vec(), faces: body.face_numbers().to_vec(), edges }
}

fn answer(facts: &Facts, vertices: &[DVec3], drawn: &Drawn) -> Answer {
    let triangles = drawn.triangles.len();
    let mut answer = Answer::of(&json!({
        "body": {
            "kind": facts.kind,
            "vertices": vertices.len(),
            "triangles": triangles,
            "faces": facts.faces,
            "edges": facts.edges,
            "dimension": facts.dimension,
            "closed": facts.closed,
            "shells": facts.shells.map(|[closed, sided, sheets]| {
                json!({ "closed": closed, "sided": sided, "sheet": sheets })
            }),
            "volume": facts.volume,
            "low": facts.bounds[0],
            "high": facts.bounds[1],
            "notes": facts.notes,
        },
        "edges": drawn.edges.len(),
    }));
    let numbers = &mut answer.numbers;
    numbers.reserve(24 * vertices.len() + 16 * triangles + 8 * drawn.edges.len());
    vertices.iter().flat_map(DVec3::to_array).for_each(|c| numbers.extend(c.to_le_bytes()));
    drawn.triangles.iter().flatten().for_each(|v| numbers.extend(v.to_le_bytes()));
    drawn.faces.iter().for_each(|f| numbers.extend(f.to_le_bytes()));
    drawn.edges.iter().flatten().for_each(|v| numbers.extend(v.to_le_bytes()));
    answer
}

/// A feature: its kind, what to light, and its numbers in the file.
#[derive(Debug)]
pub(crate) struct Lit {
    kind: &'static str,
    /// Vertices of the body as drawn.
    vertices: Vec<u32>,
    /// The face of the body as drawn, for a face.
    face: Option<u32>,
    /// The vertices' numbers in the file.
    file: Vec<u32>,
}

impl Lit {
    pub(crate) fn of<B: colltrans::Body>(feature: Feature, body: &B) -> Self {
        let (vertices, file) = (feature.own_vertices(body), feature.vertices(body));
        let face = if let Feature::Face(face) = feature { Some(face) } else { None };
        Self { kind: feature.kind(), vertices, face, file }
    }

    pub(crate) fn told(&self) -> Value {
        json!({ "kind": self.kind, "vertices": self.vertices, "face": self.face, "file": self.file })
    }
}
