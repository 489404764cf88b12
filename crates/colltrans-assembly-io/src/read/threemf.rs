//! Reads 3MF packages. Each item of the build is a part, with its transform applied, in the unit of the file.
//!
//! - An object of components becomes one part for each mesh below it, or one part in total ([`Split::Never`]).
//!   An object without a name takes the name of the object that contains it.
//! - A transform is twelve numbers, the rows of a matrix that is multiplied by a row vector from the left (core
//!   specification, 3.3).
//! - Objects may be in other model files of the package (`p:path` of the production extension). An object is
//!   identified by its file and its id. Paths may have escapes such as `%20`.
//! - Objects of the types `support`, `solidsupport` and `other` (3.4) are left out with a note. Surfaces are
//!   parts that may be open.
//! - The module `slicer` supplies names, and marks bodies that instruct the slicer. `printable="0"` causes a
//!   note and has no other effect.
//! - A required extension that is unknown and may have shapes is rejected.

use std::collections::{BTreeMap, HashMap, HashSet, VecDeque};
use std::io::{Cursor, Read};
use std::rc::Rc;
use std::sync::Arc;

use colltrans_mesh::Mesh;
use colltrans_mesh::words::first_named;
use glam::{DAffine3, DMat3, DVec3};
use quick_xml::NsReader;
use quick_xml::events::{BytesStart, Event};
use quick_xml::name::NamespaceResolver;
use zip::ZipArchive;

use super::files::{Source, decode_uri};
use super::slicer::{self, ObjectSettings, SlicerSettings};
use super::{Budget, Draft, Names, Split, assemble, contents_error, drafts};
use crate::error::ReadError;
use colltrans_assembly::Assembly;
use colltrans_mesh::xml::{self, Element, Lines};

/// Maximum number of unpacked bytes of all files that are read from a package, and maximum ratio of these bytes to
/// the bytes of the package.
const MAX_BYTES: u64 = 1 << 30;
const MAX_RATIO: u64 = 256;
/// Number of unpacked bytes below which the ratio is not checked.
const UNCHECKED_BYTES: u64 = 1 << 24;
/// Maximum depth of nested components. Deeper ones are rejected as a possible cycle.
const MAX_DEPTH: usize = 64;
/// Maximum depth of nested XML elements.
const MAX_ELEMENT_DEPTH: usize = 64;
/// The units of the core specification, 3.4.
const UNITS: [&str; 6] = ["micron", "millimeter", "centimeter", "inch", "foot", "meter"];

const CORE: &str = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
const PRODUCTION: &str = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06";
/// Extensions without shapes: colours, and names of sets of triangles.
const WITHOUT_SHAPES: [&str; 3] = [
    "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07",
    "http://schemas.microsoft.com/3dmanufacturing/2013/01",
];
/// The type of the relationship to the root model of a package.
const ROOT_MODEL_RELATION: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";

/// Reads the assembly of a package.
pub(super) fn read_package(source: Source) -> Result<Assembly, ReadError> {
    let bytes = source.own_bytes()?;
    let mut budget = Budget::with_bytes(bytes.len());
    let mut package = Package::open(&source, bytes)?;
    let root = package.root_model_path()?;
    let models = read_models(&source, &mut package, &root)?;
    let mut left_out = Vec::new();
    // All placements are counted before the first part is built.
    let mut placed = Vec::new();
    for (k, item) in models.root.items.iter().enumerate() {
        let place = format!("build item {}", k + 1);
        // The name of the object that the item places.
        let mut whole = None;
        let mut visit = |name: &str, object: &Object, context: ObjectContext, world| {
            budget.count_placed()?;
            let whole = whole.get_or_insert_with(|| name.to_owned());
            let never = match object.kind {
                ObjectKind::NotBuilt(kind) => Some(kind),
                ObjectKind::Model => context.role,
            };
            if let Some(kind) = never {
                left_out.push(format!("{name} ({kind})"));
                return Ok(false);
            }
            budget.count_facets(object.mesh.faces.len().max(object.mesh.vertices.len()))?;
            if object.mesh.faces.is_empty() {
                if object.has_mesh {
                    left_out.push(format!("{name} (no triangles)"));
                }
                return Ok(true);
            }
            for (own, mesh) in mesh_bodies(name, object, context, &mut left_out) {
                let name = if source.options.split == Split::Never { whole.clone() } else { own };
                placed.push((k, name, drafts::Placed { mesh, world }));
            }
            Ok(true)
        };
        let refused = |reason: String| contents_error(source.path, &place, reason);
        models.visit_objects(&root, item, &Context::default(), &mut visit).map_err(refused)?;
    }
    let mut drafts: Vec<Draft> = Vec::with_capacity(placed.len());
    let (mut names, mut last) = (Names::default(), None);
    for (k, name, piece) in placed {
        match drafts.last_mut() {
            // With `Split::Never` all pieces of an item form one part.
            Some(draft) if source.options.split == Split::Never && last == Some(k) => {
                draft.pieces.push(piece);
            }
            _ => {
                let place = Some(format!("build item {}", k + 1));
                drafts.push(Draft { place, ..Draft::new(names.unique_name(&name), vec![piece]) });
            }
        }
        last = Some(k);
    }
    let mut notes = item_notes(&models.root.items, &left_out);
    let unplaced = models.unplaced_names(&root);
    if !unplaced.is_empty() {
        let named = first_named(&unplaced, drafts::MOST_NAMED);
        notes.push(format!("left out because no item of the build places them: {named}"));
    }
    let (unit, mut holds) = (models.root.unit.clone(), package.contents_text());
    drop(package);
    if let Some(note) = notes.first().filter(|_| !left_out.is_empty() || !unplaced.is_empty()) {
        holds = format!("{holds}; {note}");
    }
    let assembly = assemble(source, drafts, &holds)?.with_unit(unit);
    Ok(notes.into_iter().fold(assembly, Assembly::with_note))
}

/// Returns the bodies of an object's mesh with their names: the whole mesh, unless the slicer's settings divide
/// it into several bodies.
fn mesh_bodies(
    name: &str,
    object: &Object,
    context: ObjectContext,
    left_out: &mut Vec<String>,
) -> Vec<(String, Arc<Mesh>)> {
    let mesh = &object.mesh;
    let runs = context.whole.and_then(|whole| whole.consecutive_bodies(mesh.faces.len()));
    // An invalid vertex index is rejected later, with its place.
    let is_sound = || mesh.faces.iter().flatten().all(|&v| (v as usize) < mesh.vertices.len());
    let Some(runs) = runs.filter(|_| is_sound()) else {
        return vec![(name.to_owned(), Arc::clone(mesh))];
    };
    let body_of_face = runs.iter().zip(0..).flat_map(|((run, _), k)| run.clone().map(move |_| k));
    let meshes = mesh.split_faces(&body_of_face.collect::<Vec<u32>>(), runs.len());
    let mut found = Vec::new();
    for ((_, body), mesh) in runs.iter().zip(meshes) {
        let name = body.name.as_deref().unwrap_or(name).to_owned();
        match body.role {
            Some(kind) => left_out.push(format!("{name} ({kind})")),
            None => found.push((name, Arc::new(mesh))),
        }
    }
    found
}

/// Returns notes on objects that were left out, and on items that are marked as not printable.
fn item_notes(items: &[Placed], left_out: &[String]) -> Vec<String> {
    let mut notes = Vec::new();
    if !left_out.is_empty() {
        let named = first_named(left_out, drafts::MOST_NAMED);
        notes.push(format!("left out because they are not parts of the model: {named}"));
    }
    let printed = |item: &(usize, &Placed)| item.1.unprinted;
    let unprinted: Vec<String> =
        items.iter().enumerate().filter(printed).map(|(k, _)| (k + 1).to_string()).collect();
    if !unprinted.is_empty() {
        let listed = unprinted.join(", ");
        notes.push(format!(
            "read although marked as not printable (printable=\"0\"): build item {listed}"
        ));
    }
    notes
}

/// The zip archive of a package.
struct Package<'a> {
    source: &'a Source<'a>,
    archive: ZipArchive<Cursor<Vec<u8>>>,
    /// The number of bytes that may still be unpacked.
    left: u64,
}

impl<'a> Package<'a> {
    /// Opens the archive.
    fn open(source: &'a Source<'a>, bytes: Vec<u8>) -> Result<Self, ReadError> {
        let left =
            MAX_BYTES.min((bytes.len() as u64).saturating_mul(MAX_RATIO).max(UNCHECKED_BYTES));
        let archive = ZipArchive::new(Cursor::new(bytes)).map_err(|_| {
            let reason =
                "not a 3MF file: expected a zip archive; the file has another format or is truncated";
            contents_error(source.path, "package", reason)
        })?;
        Ok(Self { source, archive, left })
    }

    /// Returns the names of the files in the archive.
    fn file_names(&self) -> Vec<String> {
        self.archive.file_names().flatten().map(std::borrow::Cow::into_owned).collect()
    }

    /// Describes the contents for the error that there are no parts.
    fn contents_text(&self) -> String {
        format!("its build places no mesh; the package has {} files", self.archive.len())
    }

    /// Returns the name of a file in the archive, found by its path regardless of case; `None` if it does not
    /// exist.
    fn find_file(&self, path: &str) -> Option<String> {
        let wanted = path_key(path);
        self.file_names().into_iter().find(|name| path_key(name) == wanted)
    }

    /// Returns the path of the root model.
    fn root_model_path(&mut self) -> Result<String, ReadError> {
        if let Some(name) = self.find_file("_rels/.rels") {
            let text = self.file_text(&name)?;
            let refused = |(place, reason)| {
                contents_error(self.source.path, format!("{name}: {place}"), reason)
            };
            let relations = Element::parse(&text).map_err(refused)?;
            let model =
                relations.children.iter().find(|r| r.get("Type") == Some(ROOT_MODEL_RELATION));
            if let Some(target) = model.and_then(|r| r.get("Target")) {
                return Ok(target.to_owned());
            }
        }
        if let Some(name) = self.find_file("3D/3dmodel.model") {
            return Ok(name);
        }
        // Packages of the production extension also have models in deeper folders.
        let is_model = |n: &String| n.to_ascii_lowercase().ends_with(".model");
        let mut models: Vec<String> = self.file_names().into_iter().filter(is_model).collect();
        models.sort_by_key(|n| (n.matches('/').count(), n.clone()));
        models.into_iter().next().ok_or_else(|| {
            let reason = format!(
                "not a 3MF file: none of the {} files in this archive is a model (3D/3dmodel.model)",
                self.archive.len()
            );
            contents_error(self.source.path, "package", reason)
        })
    }

    /// Unpacks a file of the package and returns its text.
    fn file_text(&mut self, path: &str) -> Result<String, ReadError> {
        let refused = |reason: String| contents_error(self.source.path, path, reason);
        let name =
            self.find_file(path).ok_or_else(|| refused("the package has no such file".into()))?;
        let file =
            self.archive.by_name(&name).map_err(|e| refused(format!("cannot be unpacked: {e}")))?;
        let mut bytes = Vec::new();
        // The size in the header of the archive is not trusted.
        let limit = self.left;
        file.take(limit + 1)
            .read_to_end(&mut bytes)
            .map_err(|e| refused(format!("cannot be unpacked: {e}")))?;
        if bytes.len() as u64 > limit {
            return Err(refused(format!(
                "the package unpacks to more than the accepted {MAX_RATIO} times its size, or {MAX_BYTES} bytes"
            )));
        }
        self.left -= bytes.len() as u64;
        colltrans_mesh::file::decode_text(bytes).map_err(|e| refused(e.to_string()))
    }
}

/// The purpose of an object.
#[derive(Default, Clone, Copy)]
enum ObjectKind {
    /// A body or a surface: a part of the model.
    #[default]
    Model,
    /// Not a part of the model. The text is the type of the object.
    NotBuilt(&'static str),
}

impl ObjectKind {
    /// Parses a type of the core specification, 3.4.
    fn from_type(kind: Option<&str>) -> Result<Self, String> {
        match kind {
            None | Some("model" | "surface") => Ok(Self::Model),
            Some("support") => Ok(Self::NotBuilt("support")),
            Some("solidsupport") => Ok(Self::NotBuilt("solidsupport")),
            Some("other") => Ok(Self::NotBuilt("other")),
            Some(kind) => Err(format!(
                "unknown type {kind}; accepted: model, surface, support, solidsupport, other"
            )),
        }
    }
}

#[derive(Default)]
struct Object {
    name: Option<String>,
    kind: ObjectKind,
    mesh: Arc<Mesh>,
    components: Vec<Placed>,
    has_mesh: bool,
}

/// A reference to an object, with its transform.
#[derive(Clone)]
struct Placed {
    /// The model file of the object, if it is another one.
    path: Option<String>,
    id: String,
    transform: DAffine3,
    /// Whether the slicer marks the item as not printable.
    unprinted: bool,
}

/// A model file.
struct Model {
    unit: String,
    objects: HashMap<String, Rc<Object>>,
    items: Vec<Placed>,
}

/// All model files that the root model refers to, directly or indirectly.
struct Models {
    root: Rc<Model>,
    /// The models by normalised path ([`path_key`]).
    by_path: HashMap<String, Rc<Model>>,
    settings: SlicerSettings,
}

/// Normalises a path in a package: without the first `/`, in lower case, with escapes decoded.
fn path_key(path: &str) -> String {
    let path = decode_uri(path).unwrap_or_else(|_| path.to_owned());
    path.trim_start_matches('/').to_ascii_lowercase()
}

/// Parses the root model and all models that it refers to, and the settings of slicers.
fn read_models(source: &Source, package: &mut Package, root: &str) -> Result<Models, ReadError> {
    let mut by_path = HashMap::new();
    let mut open = VecDeque::from([root.to_owned()]);
    while let Some(path) = open.pop_front() {
        if by_path.contains_key(&path_key(&path)) {
            continue;
        }
        let text = package.file_text(&path)?;
        let model = Parser::parse_model(&text).map_err(|(place, reason)| {
            contents_error(
                source.path,
                format!("{}: {place}", path.trim_start_matches('/')),
                reason,
            )
        })?;
        let components = model.objects.values().flat_map(|object| &object.components);
        let mut others: Vec<String> =
            components.chain(&model.items).filter_map(|placed| placed.path.clone()).collect();
        others.sort();
        open.extend(others);
        by_path.insert(path_key(&path), Rc::new(model));
    }
    let Some(model) = by_path.get(&path_key(root)).cloned() else {
        return Err(contents_error(source.path, root, "the package has no such file"));
    };
    for (path, other) in &by_path {
        if other.unit != model.unit {
            let reason = format!(
                "its unit is {}, but the unit of the root model is {}; all models must have the same unit",
                other.unit, model.unit
            );
            return Err(contents_error(source.path, path, reason));
        }
    }
    let mut settings = SlicerSettings::default();
    for path in slicer::FILES {
        if let Some(text) = package.find_file(path).and_then(|name| package.file_text(&name).ok()) {
            settings.add_file(&text);
        }
    }
    Ok(Models { root: model, by_path, settings })
}

/// The settings of a slicer for an object.
#[derive(Clone, Copy, Default)]
struct ObjectContext<'a> {
    /// The settings of the object, if an item of the build places it.
    whole: Option<&'a ObjectSettings>,
    /// The role of the object if it is not a part of the model.
    role: Option<&'static str>,
}

/// A visitor of placed objects, with name, settings and transformation to the world. It returns whether the
/// components of the object are visited.
type ObjectVisitor<'a> =
    dyn FnMut(&str, &Object, ObjectContext, DAffine3) -> Result<bool, String> + 'a;

/// The context in which an object is placed.
#[derive(Default)]
struct Context<'a> {
    world: DAffine3,
    depth: usize,
    /// The name for objects without a name.
    name: Option<String>,
    /// The settings of the object that an item of the build places.
    whole: Option<&'a ObjectSettings>,
}

impl Models {
    /// Returns the names of the objects with a mesh that no item of the build places.
    fn unplaced_names(&self, root: &str) -> Vec<String> {
        let at = |from: &str, placed: &Placed| {
            (path_key(placed.path.as_deref().unwrap_or(from)), placed.id.clone())
        };
        let mut reached = HashSet::new();
        let mut open: Vec<_> = self.root.items.iter().map(|item| at(root, item)).collect();
        while let Some(place) = open.pop() {
            let object = self.by_path.get(&place.0).and_then(|model| model.objects.get(&place.1));
            let components = object.iter().flat_map(|object| &object.components);
            let below: Vec<_> = components.map(|component| at(&place.0, component)).collect();
            if reached.insert(place) {
                open.extend(below);
            }
        }
        let mut unplaced = BTreeMap::new();
        for (path, model) in &self.by_path {
            for (id, object) in &model.objects {
                let place = (path.clone(), id.clone());
                if object.has_mesh && !reached.contains(&place) {
                    let name = object.name.clone().unwrap_or_else(|| format!("object_{id}"));
                    unplaced.insert(place, name);
                }
            }
        }
        unplaced.into_values().collect()
    }

    /// Visits an object that the model `from` places, and all objects below it.
    fn visit_objects(
        &self,
        from: &str,
        placed: &Placed,
        above: &Context,
        visit: &mut ObjectVisitor,
    ) -> Result<(), String> {
        let path = placed.path.as_deref().unwrap_or(from);
        let model = self
            .by_path
            .get(&path_key(path))
            .ok_or_else(|| format!("the package has no {path}"))?;
        let id = &placed.id;
        let object = model.objects.get(id).ok_or_else(|| {
            let place = placed.path.as_ref().map_or(String::new(), |path| format!(" in {path}"));
            format!("unknown object id {id}{place}")
        })?;
        if above.depth > MAX_DEPTH {
            return Err(format!("components are nested deeper than {MAX_DEPTH}, or in a cycle"));
        }
        if !object.has_mesh && object.components.is_empty() {
            return Err(format!("object {id} has neither a mesh nor components"));
        }
        let whole = if above.depth == 0 { self.settings.object(id) } else { None };
        let body = above.whole.and_then(|whole| whole.parts.get(id));
        // The name that the slicer shows has priority.
        let name = whole.and_then(|whole| whole.name.as_ref());
        let name = name.or(body.and_then(|body| body.name.as_ref())).or(object.name.as_ref());
        let name = name.or(above.name.as_ref()).filter(|name| !name.trim().is_empty()).cloned();
        let context = ObjectContext { whole, role: body.and_then(|body| body.role) };
        let world = above.world * placed.transform;
        let shown = name.clone().unwrap_or_else(|| format!("object_{id}"));
        if !visit(&shown, object, context, world)? {
            return Ok(());
        }
        let above = Context { world, depth: above.depth + 1, name, whole };
        for child in &object.components {
            self.visit_objects(path, child, &above, visit)?;
        }
        Ok(())
    }
}

/// A model while it is parsed.
struct Parser {
    unit: Option<String>,
    objects: HashMap<String, Rc<Object>>,
    items: Vec<Placed>,
    current: Option<(String, Object, Mesh)>,
}

impl Parser {
    /// Parses a model file.
    fn parse_model(text: &str) -> Result<Model, xml::XmlError> {
        let mut reader = NsReader::from_str(text);
        let mut lines = Lines::new(text);
        let mut parser =
            Self { unit: None, objects: HashMap::new(), items: Vec::new(), current: None };
        let mut depth = 0_usize;
        loop {
            let line = lines.at(reader.buffer_position());
            let place = || format!("line {line}");
            let event = reader.read_event().map_err(|e| (place(), xml::parse_error_reason(&e)))?;
            match event {
                Event::Start(tag) => {
                    depth += 1;
                    if depth > MAX_ELEMENT_DEPTH {
                        let reason = format!(
                            "elements are nested deeper than the accepted {MAX_ELEMENT_DEPTH}"
                        );
                        return Err((place(), reason));
                    }
                    parser.open_element(&tag, reader.resolver()).map_err(|e| (place(), e))?;
                }
                Event::Empty(tag) => {
                    parser.open_element(&tag, reader.resolver()).map_err(|e| (place(), e))?;
                    parser.close_element(tag.local_name().as_ref()).map_err(|e| (place(), e))?;
                }
                Event::End(tag) => {
                    depth = depth.saturating_sub(1);
                    parser.close_element(tag.local_name().as_ref()).map_err(|e| (place(), e))?;
                }
                Event::Eof if depth > 0 => {
                    return Err(("end of file".into(), "the last element is not closed".into()));
                }
                Event::Eof => break,
                _ => (),
            }
        }
        let Some(unit) = parser.unit else {
            return Err(("start of file".into(), "the file has no XML element".into()));
        };
        Ok(Model { unit, objects: parser.objects, items: parser.items })
    }

    /// Handles the start of an element.
    fn open_element(
        &mut self,
        tag: &BytesStart,
        resolver: &NamespaceResolver,
    ) -> Result<(), String> {
        let (space, name) = resolver.resolve_element(tag.name());
        // Elements of extensions are skipped. Some writers use no namespace at all.
        if xml::namespace(&space).is_some_and(|space| space != CORE) {
            return if self.unit.is_none() { Err(not_a_model(tag)) } else { Ok(()) };
        }
        let name = name.as_ref();
        if self.unit.is_none() {
            return if name == "model" { self.open_root(tag) } else { Err(not_a_model(tag)) };
        }
        if !matches!(name, "object" | "item" | "mesh" | "vertex" | "triangle" | "component") {
            return Ok(());
        }
        let attributes = Attributes::parse(tag, resolver)?;
        match name {
            "object" if self.current.is_some() => {
                return Err(
                    "an object is nested in another object; place it beside that one".into()
                );
            }
            "object" => {
                let id = attributes.required("id")?.to_owned();
                let name = attributes.get("name").map(str::to_owned);
                let kind = ObjectKind::from_type(attributes.get("type"))?;
                let object = Object { name, kind, ..Object::default() };
                self.current = Some((id, object, Mesh::default()));
            }
            "item" => self.items.push(attributes.reference()?),
            _ => {
                let Some((_, object, mesh)) = &mut self.current else { return Ok(()) };
                match name {
                    "mesh" => object.has_mesh = true,
                    "vertex" => {
                        let [x, y, z] = ["x", "y", "z"].map(|key| attributes.number(key));
                        mesh.vertices.push(DVec3::new(x?, y?, z?));
                    }
                    "triangle" => {
                        let [a, b, c] = ["v1", "v2", "v3"].map(|key| attributes.number(key));
                        mesh.faces.push(vec![a?, b?, c?]);
                    }
                    _ => object.components.push(attributes.reference()?),
                }
            }
        }
        Ok(())
    }

    /// Handles the end of an element.
    fn close_element(&mut self, name: &str) -> Result<(), String> {
        if name != "object" {
            return Ok(());
        }
        let Some((id, mut object, mesh)) = self.current.take() else { return Ok(()) };
        object.mesh = Arc::new(mesh);
        if self.objects.insert(id.clone(), Rc::new(object)).is_some() {
            return Err(format!("duplicate object id {id}; ids must be unique in a model"));
        }
        Ok(())
    }

    /// Handles the root element.
    fn open_root(&mut self, tag: &BytesStart) -> Result<(), String> {
        let (mut unit, mut required) = ("millimeter".to_owned(), String::new());
        let mut spaces = HashMap::new();
        for attribute in tag.attributes() {
            let attribute = attribute.map_err(|e| e.to_string())?;
            let value = xml::value(&attribute)?;
            match attribute.key.as_ref() {
                "unit" => unit = value,
                "requiredextensions" => required = value,
                key => {
                    if let Some(prefix) = key.strip_prefix("xmlns:") {
                        spaces.insert(prefix.to_owned(), value);
                    }
                }
            }
        }
        if !UNITS.contains(&unit.as_str()) {
            return Err(format!("unknown unit {unit}; accepted: {}", UNITS.join(", ")));
        }
        for prefix in required.split_whitespace() {
            let space = spaces.get(prefix).map_or(prefix, String::as_str);
            if space != CORE && space != PRODUCTION && !WITHOUT_SHAPES.contains(&space) {
                return Err(format!(
                    "the required extension {prefix} ({space}) is not supported; save the model \
                     without it"
                ));
            }
        }
        self.unit = Some(unit);
        Ok(())
    }
}

/// Builds the message for a wrong root element.
fn not_a_model(tag: &BytesStart) -> String {
    format!("not a 3MF model: the root element is {}, expected model", tag.name().as_ref())
}

/// The attributes of an element in the core namespace, and the path of the production extension.
struct Attributes {
    core: HashMap<String, String>,
    path: Option<String>,
}

impl Attributes {
    /// Parses the attributes of an element.
    fn parse(tag: &BytesStart, resolver: &NamespaceResolver) -> Result<Self, String> {
        let mut found = Self { core: HashMap::new(), path: None };
        for attribute in tag.attributes() {
            let attribute = attribute.map_err(|e| e.to_string())?;
            let (space, name) = resolver.resolve_attribute(attribute.key);
            match xml::namespace(&space) {
                None if attribute.key.prefix().is_none() => {
                    found.core.insert(name.as_ref().to_owned(), xml::value(&attribute)?);
                }
                Some(space) if space == PRODUCTION && name.as_ref() == "path" => {
                    found.path = Some(xml::value(&attribute)?);
                }
                _ => (),
            }
        }
        Ok(found)
    }

    /// Returns an attribute of the core namespace, or `None`.
    fn get(&self, key: &str) -> Option<&str> {
        self.core.get(key).map(String::as_str)
    }

    /// Returns an attribute that must exist.
    fn required(&self, key: &str) -> Result<&str, String> {
        self.get(key).ok_or_else(|| format!("missing attribute {key}"))
    }

    /// Parses a number in an attribute that must exist.
    fn number<T: std::str::FromStr>(&self, key: &str) -> Result<T, String> {
        parse_number(key, self.required(key)?)
    }

    /// Parses the reference to an object in an `item` or `component`.
    fn reference(&self) -> Result<Placed, String> {
        let id = self.required("objectid")?.to_owned();
        let (path, transform) = (self.path.clone(), parse_transform(self.get("transform"))?);
        let unprinted = matches!(self.get("printable"), Some("0" | "false"));
        Ok(Placed { path, id, transform, unprinted })
    }
}

/// Parses the number in an attribute.
fn parse_number<T: std::str::FromStr>(key: &str, text: &str) -> Result<T, String> {
    text.trim().parse().map_err(|_| format!("{key}=\"{text}\" is not a valid number"))
}

/// Parses a transform; `None` is the identity.
fn parse_transform(text: Option<&str>) -> Result<DAffine3, String> {
    let Some(text) = text else { return Ok(DAffine3::IDENTITY) };
    let numbers: Result<Vec<f64>, String> =
        text.split_whitespace().map(|t| parse_number("transform", t)).collect();
    let numbers = numbers?;
    if numbers.len() != 12 {
        return Err(format!("transform has {} numbers, expected 12", numbers.len()));
    }
    let row = |k: usize| DVec3::from_slice(&numbers[3 * k..]);
    // The rows for a row vector are the columns for a column vector.
    let matrix = DMat3::from_cols(row(0), row(1), row(2));
    if matrix.determinant() == 0.0 || !matrix.is_finite() {
        return Err("transform is singular or not finite".into());
    }
    Ok(DAffine3::from_mat3_translation(matrix, row(3)))
}
