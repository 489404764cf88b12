//! 3MF packages: every item of the build is a part, its transform applied, in the file's unit.
//!
//! An object of components becomes one part for each mesh below it. A transform is twelve numbers,
//! the rows of a matrix by which a row vector is multiplied from the right (3MF core specification,
//! 3.3).

use std::collections::HashMap;
use std::io::{Cursor, Read};
use std::path::Path;

use glam::{DAffine3, DMat3, DVec3};
use quick_xml::events::{BytesStart, Event};
use zip::ZipArchive;

use super::{Names, assembled, contents, in_file, io, or_noted, placed_one_more};
use crate::error::ReadError;
use crate::part::{Assembly, Part, Piece};

/// Larger models are refused before they are unpacked.
const LARGEST: u64 = 1 << 32;
/// The units of the core specification, 3.4.
const UNITS: [&str; 6] = ["micron", "millimeter", "centimeter", "inch", "foot", "meter"];
/// Components nested deeper than this are a ring.
const DEEPEST: usize = 64;

pub(super) fn read(path: &Path) -> Result<Assembly, ReadError> {
    let text = model(path)?;
    let mut model = Model { unit: "millimeter".into(), ..Model::default() };
    model.parse(path, &text)?;
    let mut parts = Vec::new();
    let mut names = Names::default();
    let mut placed = 0;
    for (k, (object, transform)) in model.items.iter().enumerate() {
        let place = format!("build item {}", k + 1);
        model.collect(path, &place, object, *transform, 0, &mut |name, piece| {
            placed_one_more(&mut placed).map_err(|e| contents(path, &place, e))?;
            let Some(piece) = piece else { return Ok(()) };
            let part = Part::new(names.unique(name), &[piece]).map_err(in_file(path))?;
            parts.push(part);
            Ok(())
        })?;
    }
    Ok(or_noted(assembled(path, parts, Vec::new())?.with_unit(model.unit)))
}

/// The text of the package's model.
fn model(path: &Path) -> Result<String, ReadError> {
    let bytes = std::fs::read(path).map_err(io(path))?;
    let mut archive =
        ZipArchive::new(Cursor::new(bytes)).map_err(|e| contents(path, "package", e))?;
    let is_model = |n: &str| n.trim_start_matches('/').to_ascii_lowercase().ends_with(".model");
    let mut names: Vec<String> = archive
        .file_names()
        .flatten()
        .map(std::borrow::Cow::into_owned)
        .filter(|n| is_model(n))
        .collect();
    // The root model is 3D/3dmodel.model by custom; parts of the production extension lie deeper.
    names.sort_by_key(|n| (n.matches('/').count(), n.clone()));
    let Some(name) = names.first() else {
        return Err(contents(path, "package", "there is no model in it"));
    };
    let file = archive.by_name(name).map_err(|e| contents(path, name.clone(), e))?;
    if file.size() > LARGEST {
        return Err(contents(path, name.clone(), format!("{} bytes are too many", file.size())));
    }
    let mut text = String::new();
    file.take(LARGEST).read_to_string(&mut text).map_err(|e| contents(path, name.clone(), e))?;
    Ok(text)
}

#[derive(Default)]
struct Object {
    name: Option<String>,
    vertices: Vec<DVec3>,
    faces: Vec<Vec<u32>>,
    components: Vec<(String, DAffine3)>,
}

#[derive(Default)]
struct Model {
    unit: String,
    objects: HashMap<String, Object>,
    items: Vec<(String, DAffine3)>,
}

/// Told of an object, by its name, and its mesh.
type Call<'a> = dyn FnMut(&str, Option<Piece>) -> Result<(), ReadError> + 'a;

impl Model {
    fn parse(&mut self, path: &Path, text: &str) -> Result<(), ReadError> {
        let mut reader = quick_xml::Reader::from_str(text);
        let mut current: Option<String> = None;
        loop {
            let at = reader.buffer_position() as usize;
            let line = || format!("line {}", text[..at.min(text.len())].matches('\n').count() + 1);
            let event = reader.read_event().map_err(|e| contents(path, line(), e))?;
            match event {
                Event::Start(tag) | Event::Empty(tag) => {
                    self.open(&tag, &mut current).map_err(|e| contents(path, line(), e))?;
                }
                Event::End(tag) if tag.local_name().as_ref() == "object" => current = None,
                Event::Eof => return Ok(()),
                _ => (),
            }
        }
    }

    fn open(&mut self, tag: &BytesStart, current: &mut Option<String>) -> Result<(), String> {
        let attributes = attributes(tag)?;
        let get = |key: &str| attributes.get(key).map(String::as_str);
        let need = |key: &str| get(key).ok_or_else(|| format!("attribute {key} is missing"));
        let number = |key: &str| parsed::<f64>(key, need(key)?);
        let index = |key: &str| parsed::<u32>(key, need(key)?);
        match tag.local_name().as_ref() {
            "model" => {
                let unit = get("unit").unwrap_or("millimeter");
                if !UNITS.contains(&unit) {
                    return Err(format!("the unit {unit} is none of {}", UNITS.join(", ")));
                }
                unit.clone_into(&mut self.unit);
            }
            "object" => {
                let id = need("id")?.to_owned();
                let object = Object { name: get("name").map(str::to_owned), ..Object::default() };
                if self.objects.insert(id.clone(), object).is_some() {
                    return Err(format!("a second object has the id {id}"));
                }
                *current = Some(id);
            }
            "item" => {
                self.items.push((need("objectid")?.to_owned(), transform(get("transform"))?));
            }
            name => {
                let id = current.as_deref().unwrap_or_default();
                let Some(object) = self.objects.get_mut(id) else { return Ok(()) };
                match name {
                    "vertex" => {
                        object.vertices.push(DVec3::new(number("x")?, number("y")?, number("z")?));
                    }
                    "triangle" => {
                        object.faces.push(vec![index("v1")?, index("v2")?, index("v3")?]);
                    }
                    "component" => {
                        let child = need("objectid")?.to_owned();
                        object.components.push((child, transform(get("transform"))?));
                    }
                    _ => (),
                }
            }
        }
        Ok(())
    }

    /// Calls with every object below an object, its name, and its mesh if it has one.
    fn collect(
        &self,
        path: &Path,
        place: &str,
        id: &str,
        at: DAffine3,
        depth: usize,
        call: &mut Call,
    ) -> Result<(), ReadError> {
        let object = self
            .objects
            .get(id)
            .ok_or_else(|| contents(path, place, format!("there is no object {id}")))?;
        if depth > DEEPEST {
            return Err(contents(path, place, "components are nested too deep, or in a ring"));
        }
        let name = object.name.clone().unwrap_or_else(|| format!("object_{id}"));
        let mesh = || {
            let (vertices, faces) = (object.vertices.clone(), object.faces.clone());
            Piece { vertices, faces, world_from_piece: at }
        };
        call(&name, (!object.faces.is_empty()).then(mesh))?;
        for (child, transform) in &object.components {
            self.collect(path, place, child, at * *transform, depth + 1, call)?;
        }
        Ok(())
    }
}

fn attributes(tag: &BytesStart) -> Result<HashMap<String, String>, String> {
    let mut all = HashMap::new();
    for attribute in tag.attributes() {
        let attribute = attribute.map_err(|e| e.to_string())?;
        let key = attribute.key.local_name().as_ref().to_owned();
        let value =
            quick_xml::escape::unescape(&attribute.value).map_err(|e| e.to_string())?.into_owned();
        all.insert(key, value);
    }
    Ok(all)
}

fn parsed<T: std::str::FromStr>(key: &str, text: &str) -> Result<T, String> {
    text.trim().parse().map_err(|_| format!("{key}=\"{text}\" is not a number"))
}

fn transform(text: Option<&str>) -> Result<DAffine3, String> {
    let Some(text) = text else { return Ok(DAffine3::IDENTITY) };
    let numbers: Result<Vec<f64>, String> =
        text.split_whitespace().map(|t| parsed("transform", t)).collect();
    let numbers = numbers?;
    if numbers.len() != 12 {
        return Err(format!("transform has {} numbers, not 12", numbers.len()));
    }
    let row = |k: usize| DVec3::from_slice(&numbers[3 * k..]);
    // Rows that multiply a row vector are columns that multiply a column vector.
    let matrix = DMat3::from_cols(row(0), row(1), row(2));
    if matrix.determinant() == 0.0 || !matrix.is_finite() {
        return Err("transform is singular".into());
    }
    Ok(DAffine3::from_mat3_translation(matrix, row(3)))
}
