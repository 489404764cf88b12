//! From the bytes of a file, or from a name, to a body, and to the data that the page draws.
//!
//! Numbers of an answer: the points (three `f64` each), the triangles (three `u32` each), the face of each
//! triangle (`u32`), the edges to draw (two `u32` each). The first points are the vertices of the body, with their
//! indices. A rounded body is drawn as a polyhedron on its surface, whose vertices and faces follow.

use std::borrow::Cow;
use std::path::Path;
#[cfg(feature = "min-gap")]
use std::sync::OnceLock;

#[cfg(feature = "min-gap")]
use colltrans::Solid;
#[cfg(feature = "min-gap")]
use colltrans::solid::ShellKind;
use colltrans::{Aabb, ConvexPolyhedron};
#[cfg(feature = "min-gap")]
use colltrans_mesh::body::Loaded;
use colltrans_mesh::body::{self, BodyError, BodyKind, BodyOptions, Note, drawn_body};
#[cfg(feature = "min-gap")]
use colltrans_mesh::sides;
use colltrans_mesh::{Format, Mesh};
use glam::DVec3;
use serde_json::json;

use crate::answer::{Answer, Refusal};

/// Cosine of the angle between faces below which an edge of a solid or of a dense body is not drawn, as in
/// drawings.
const SMOOTH: f64 = 0.906;

/// Number of edges above which a convex body is dense, because all edges together would cover it.
const DENSE: usize = 10_000;

/// A body in use.
#[derive(Debug)]
#[cfg_attr(
    feature = "min-gap",
    expect(clippy::large_enum_variant, reason = "there are two values, which are never moved")
)]
pub(crate) enum Part {
    Convex(Hull),
    #[cfg(feature = "min-gap")]
    Solid(Facets),
}

/// A convex body.
#[derive(Debug)]
pub(crate) struct Hull {
    pub(crate) body: ConvexPolyhedron,
    /// The body as a solid, built on the first query with a solid.
    #[cfg(feature = "min-gap")]
    solid: OnceLock<Result<Facets, String>>,
}

/// A solid.
#[cfg(feature = "min-gap")]
#[derive(Debug)]
pub(crate) struct Facets {
    pub(crate) body: Solid,
    /// Maximum distance of stored vertices that represent the same point.
    pub(crate) precision: f64,
}

#[cfg(feature = "min-gap")]
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

/// The facts about a body that the page shows.
#[derive(Debug)]
struct Facts {
    kind: &'static str,
    /// Number of triangles of the body as a solid.
    triangles: usize,
    faces: usize,
    edges: usize,
    dimension: u8,
    closed: bool,
    /// The radius of the ball that sweeps the body.
    radius: f64,
    /// For a surface the numbers of shells of each kind.
    shells: Option<[usize; 3]>,
    volume: f64,
    bounds: [[f64; 3]; 2],
    /// Descriptions of merged vertices, repairs and filled holes.
    notes: Vec<String>,
}

/// Returns the notes as text.
fn note_texts(notes: &[Note]) -> Vec<String> {
    notes.iter().map(Note::to_string).collect()
}

/// The data to draw.
#[derive(Debug, Default)]
struct Drawn {
    triangles: Vec<[u32; 3]>,
    faces: Vec<u32>,
    edges: Vec<[u32; 2]>,
}

/// Reads a mesh file.
pub(crate) fn read_mesh(name: &str, file: Vec<u8>) -> Result<Mesh, Refusal> {
    let path = Path::new(name);
    let format = Format::from_path(path).map_err(|error| error.to_string())?;
    colltrans_mesh::parse(format, file, path).map_err(|error| error.to_string().into())
}

/// Builds a body from a mesh, and the answer with its drawing.
pub(crate) fn build_body(
    mesh: &Mesh,
    name: &str,
    take: BodyKind,
) -> Result<(Part, Answer), Refusal> {
    let options =
        BodyOptions::default().with_hull(take == BodyKind::Hull).with_open(take == BodyKind::Open);
    match take {
        BodyKind::Convex | BodyKind::Hull => {
            let loaded = body::convex(mesh, &options).map_err(|error| refusal(name, &error))?;
            Ok(convex_part(loaded.body, &loaded.notes))
        }
        #[cfg(not(feature = "min-gap"))]
        BodyKind::Solid | BodyKind::Open => {
            Err(format!("{name}: this module has convex bodies alone").into())
        }
        #[cfg(feature = "min-gap")]
        BodyKind::Solid | BodyKind::Open => {
            let loaded = body::solid(mesh, &options).map_err(|error| refusal(name, &error))?;
            let Loaded { body, precision, notes } = loaded;
            let answer = body_answer(
                &solid_facts(&body, &notes),
                body.vertices(),
                &[],
                &solid_drawing(&body),
            );
            Ok((Part::Solid(Facets { body, precision }), answer))
        }
    }
}

/// Returns the body that a name describes, and the answer with its drawing.
pub(crate) fn shape(
    body: ConvexPolyhedron,
    name: &str,
    take: BodyKind,
) -> Result<(Part, Answer), Refusal> {
    if take == BodyKind::Convex {
        return Ok(convex_part(body, &[]));
    }
    let error = format!("{name} describes a convex body; other uses need a mesh");
    Err(Refusal { instead: vec![take_name(BodyKind::Convex)], ..error.into() })
}

/// Returns a convex body, and the answer with its drawing.
fn convex_part(body: ConvexPolyhedron, notes: &[Note]) -> (Part, Answer) {
    let facts = convex_facts(&body, notes);
    // Without the feature no body is rounded, and the code of the drawing is left out.
    let surface = if cfg!(feature = "min-gap") { drawn_body(&body) } else { Cow::Borrowed(&body) };
    let answer = match surface {
        Cow::Borrowed(_) => body_answer(&facts, body.vertices(), &[], &hull_drawing(&body, 0)),
        Cow::Owned(surface) => {
            let drawn = hull_drawing(&surface, body.vertices().len() as u32);
            body_answer(&facts, body.vertices(), surface.vertices(), &drawn)
        }
    };
    let hull = Hull {
        body,
        #[cfg(feature = "min-gap")]
        solid: OnceLock::new(),
    };
    (Part::Convex(hull), answer)
}

/// Returns the name of a way to use a mesh, as in questions.
fn take_name(take: BodyKind) -> &'static str {
    match take {
        BodyKind::Convex => "convex",
        BodyKind::Hull => "hull",
        BodyKind::Solid => "solid",
        BodyKind::Open => "open",
    }
}

fn refusal(name: &str, error: &BodyError) -> Refusal {
    let instead = error.alternatives().iter().map(|take| take_name(*take)).collect();
    Refusal { instead, ..format!("{name}: {error}").into() }
}

/// Returns the low and the high corner of a box around vertices that a ball of this radius sweeps.
fn bounds(vertices: &[DVec3], radius: f64) -> [[f64; 3]; 2] {
    let Aabb { low, high } = Aabb::from_points(vertices.iter().copied());
    [(low - radius).to_array(), (high + radius).to_array()]
}

fn convex_facts(body: &ConvexPolyhedron, notes: &[Note]) -> Facts {
    Facts {
        kind: "convex",
        triangles: if body.dimension() < 2 { 1 } else { 2 * body.vertices().len() - 4 },
        faces: body.face_count(),
        edges: body.edge_count(),
        dimension: body.dimension(),
        closed: true,
        radius: body.radius(),
        shells: None,
        volume: body.volume(),
        bounds: bounds(body.vertices(), body.radius()),
        notes: note_texts(notes),
    }
}

#[cfg(feature = "min-gap")]
fn solid_facts(body: &Solid, notes: &[Note]) -> Facts {
    let faces = body.facet_indices().iter().max().map_or(0, |last| last.index() + 1);
    Facts {
        kind: "solid",
        triangles: body.triangles().len(),
        faces,
        edges: 0,
        dimension: 3,
        closed: body.is_closed(),
        radius: 0.0,
        shells: (!body.is_closed())
            .then(|| ShellKind::ALL.map(|kind| body.report().shell_count(kind))),
        volume: body.volume(),
        bounds: bounds(body.vertices(), 0.0),
        notes: note_texts(notes),
    }
}

/// Returns faces as fans and every edge once. Edges between nearly coplanar faces are omitted if the body is dense or
/// the surface of a rounded body, which has its vertices after the `first` ones.
fn hull_drawing(body: &ConvexPolyhedron, first: u32) -> Drawn {
    let mut drawn = Drawn::default();
    for face in 0..body.face_count() as u32 {
        let corners: Vec<u32> = body.face_vertices(face).map(|v| first + v).collect();
        for edge in corners.windows(2).skip(1) {
            drawn.triangles.push([corners[0], edge[0], edge[1]]);
            drawn.faces.push(face);
        }
    }
    let all = body.half_edges();
    let is_sharp =
        |face: u32, other: u32| body.face_normal(face).dot(body.face_normal(other)) <= SMOOTH;
    for half in all {
        let twin = &all[half.twin as usize];
        let draws_all = first == 0 && body.edge_count() <= DENSE;
        if half.origin < twin.origin && (draws_all || is_sharp(half.face, twin.face)) {
            drawn.edges.push([first + half.origin, first + twin.origin]);
        }
    }
    drawn
}

/// Returns the triangles, the edges between faces at an angle, and open edges.
#[cfg(feature = "min-gap")]
fn solid_drawing(body: &Solid) -> Drawn {
    let vertices = body.vertices();
    let normal = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| vertices[v as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let triangles = body.triangles();
    let mut edges = Vec::new();
    for around in sides(triangles).chunk_by(|(a, _), (b, _)| a == b) {
        // The number of a side is twice the number of its corner; a triangle has three corners.
        let smooth = match *around {
            [] | [_] => false,
            [(_, first), .., (_, last)] => {
                let [a, b] = [first, last].map(|side| normal(&triangles[(side / 6) as usize]));
                a.dot(b) > SMOOTH
            }
        };
        if !smooth {
            edges.push([(around[0].0 >> 32) as u32, around[0].0 as u32]);
        }
    }
    Drawn { triangles: triangles.to_vec(), faces: body.face_numbers().to_vec(), edges }
}

/// Builds the answer about a body. `surface` has the points of a rounded body's drawing.
fn body_answer(facts: &Facts, vertices: &[DVec3], surface: &[DVec3], drawn: &Drawn) -> Answer {
    let triangles = drawn.triangles.len();
    let mut answer = Answer::from_facts(&json!({
        "body": {
            "kind": facts.kind,
            "vertices": vertices.len(),
            "triangles": facts.triangles,
            "faces": facts.faces,
            "edges": facts.edges,
            "dimension": facts.dimension,
            "closed": facts.closed,
            "radius": facts.radius,
            "shells": facts.shells.map(|[closed, sided, sheets]| {
                json!({ "closed": closed, "sided": sided, "sheet": sheets })
            }),
            "volume": facts.volume,
            "low": facts.bounds[0],
            "high": facts.bounds[1],
            "notes": facts.notes,
        },
        "points": vertices.len() + surface.len(),
        "triangles": triangles,
        "edges": drawn.edges.len(),
    }));
    let numbers = &mut answer.numbers;
    let points = vertices.iter().chain(surface);
    numbers.reserve(24 * (vertices.len() + surface.len()) + 16 * triangles + 8 * drawn.edges.len());
    points.flat_map(DVec3::to_array).for_each(|c| numbers.extend(c.to_le_bytes()));
    drawn.triangles.iter().flatten().for_each(|v| numbers.extend(v.to_le_bytes()));
    drawn.faces.iter().for_each(|f| numbers.extend(f.to_le_bytes()));
    drawn.edges.iter().flatten().for_each(|v| numbers.extend(v.to_le_bytes()));
    answer
}
