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
//! - The module `slicer` supplies names and bodies that are no parts. `printable="0"` is noted and otherwise
//!   ignored.
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

use super::files::{Source, unescaped};
use super::slicer::{self, Told, Whole};
use super::{Budget, Draft, Names, Split, assembled, contents, drafts};
use crate::error::ReadError;
use colltrans_assembly::Assembly;
use colltrans_mesh::xml::{self, Element, Lines};

/// Maximum number of unpacked bytes of all models of a package, and maximum ratio of unpacked bytes to the
/// bytes of the package.
const LARGEST: u64 = 1 << 30;
const LARGEST_RATIO: u64 = 256;
/// Number of unpacked bytes below which the ratio is not checked.
const SMALL: u64 = 1 << 24;
/// Maximum depth of nested components. Deeper ones are rejected as a possible cycle.
const DEEPEST: usize = 64;
/// Maximum depth of nested XML elements.
const DEEPEST_ELEMENT: usize = 64;
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
const START: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";

/// Reads the assembly of a package.
pub(super) fn read(source: Source) -> Result<Assembly, ReadError> {
    let bytes = source.own()?;
    let mut budget = Budget::of(bytes.len());
    let mut package = Package::open(&source, bytes)?;
    let root = package.root()?;
    let models = models(&source, &mut package, &root)?;
    let mut left_out = Vec::new();
    // All placements are counted before the first part is built.
    let mut placed = Vec::new();
    for (k, item) in models.root.items.iter().enumerate() {
        let place = format!("build item {}", k + 1);
        // The name of the object that the item places.
        let mut whole = None;
        let mut call = |name: &str, object: &Object, told: Said, world| {
            budget.place()?;
            let whole = whole.get_or_insert_with(|| name.to_owned());
            let never = match object.kind {
                Kind::Left(kind) => Some(kind),
                Kind::Model => told.instead,
            };
            if let Some(kind) = never {
                left_out.push(format!("{name} ({kind})"));
                return Ok(false);
            }
            budget.facets(object.mesh.faces.len().max(object.mesh.vertices.len()))?;
            if object.mesh.faces.is_empty() {
                if object.has_mesh {
                    left_out.push(format!("{name} (no triangles)"));
                }
                return Ok(true);
            }
            for (own, mesh) in bodies(name, object, told, &mut left_out) {
                let name = if source.options.split == Split::Never { whole.clone() } else { own };
                placed.push((k, name, drafts::Placed { mesh, world }));
            }
            Ok(true)
        };
        let refused = |reason: String| contents(source.path, &place, reason);
        models.collect(&root, item, &Above::default(), &mut call).map_err(refused)?;
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
                drafts.push(Draft { place, ..Draft::new(names.unique(&name), vec![piece]) });
            }
        }
        last = Some(k);
    }
    let mut notes = notes(&models.root.items, &left_out);
    let unplaced = models.unplaced(&root);
    if !unplaced.is_empty() {
        let named = first_named(&unplaced, drafts::MOST_NAMED);
        notes.push(format!("left out because no item of the build places them: {named}"));
    }
    let (unit, mut holds) = (models.root.unit.clone(), package.holds());
    drop(package);
    if let Some(note) = notes.first().filter(|_| !left_out.is_empty() || !unplaced.is_empty()) {
        holds = format!("{holds}; {note}");
    }
    let assembly = assembled(source, drafts, &holds)?.with_unit(unit);
    Ok(notes.into_iter().fold(assembly, Assembly::with_note))
}

/// Returns the bodies of an object's mesh with their names: the whole mesh, unless the slicer's settings divide
/// it into several bodies.
fn bodies(
    name: &str,
    object: &Object,
    told: Said,
    left_out: &mut Vec<String>,
) -> Vec<(String, Arc<Mesh>)> {
    let mesh = &object.mesh;
    let runs = told.whole.and_then(|whole| whole.bodies(mesh.faces.len()));
    // An invalid vertex index is rejected later, with its place.
    let is_sound = || mesh.faces.iter().flatten().all(|&v| (v as usize) < mesh.vertices.len());
    let Some(runs) = runs.filter(|_| is_sound()) else {
        return vec![(name.to_owned(), Arc::clone(mesh))];
    };
    let body_of_face = runs.iter().zip(0..).flat_map(|((run, _), k)| run.clone().map(move |_| k));
    let meshes = mesh.picked(&body_of_face.collect::<Vec<u32>>(), runs.len());
    let mut found = Vec::new();
    for ((_, body), mesh) in runs.iter().zip(meshes) {
        let name = body.name.as_deref().unwrap_or(name).to_owned();
        match body.instead {
            Some(kind) => left_out.push(format!("{name} ({kind})")),
            None => found.push((name, Arc::new(mesh))),
        }
    }
    found
}

/// Returns notes on objects that were left out, and on items that are marked as not printable.
fn notes(items: &[Placed], left_out: &[String]) -> Vec<String> {
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
        let left = LARGEST.min((bytes.len() as u64).saturating_mul(LARGEST_RATIO).max(SMALL));
        let archive = ZipArchive::new(Cursor::new(bytes)).map_err(|_| {
            let reason =
                "not a 3MF file: expected a zip archive; the file has another format or is truncated";
            contents(source.path, "package", reason)
        })?;
        Ok(Self { source, archive, left })
    }

    /// Returns the names of the files in the archive.
    fn names(&self) -> Vec<String> {
        self.archive.file_names().flatten().map(std::borrow::Cow::into_owned).collect()
    }

    /// Describes the contents for the error that there are no parts.
    fn holds(&self) -> String {
        format!("its build places no mesh; the package has {} files", self.archive.len())
    }

    /// Returns the name of a file in the archive, found by its path regardless of case; `None` if it does not
    /// exist.
    fn find(&self, path: &str) -> Option<String> {
        let wanted = key(path);
        self.names().into_iter().find(|name| key(name) == wanted)
    }

    /// Returns the path of the root model.
    fn root(&mut self) -> Result<String, ReadError> {
        if let Some(name) = self.find("_rels/.rels") {
            let text = self.text(&name)?;
            let refused =
                |(place, reason)| contents(self.source.path, format!("{name}: {place}"), reason);
            let relations = Element::parse(&text).map_err(refused)?;
            let model = relations.children.iter().find(|r| r.get("Type") == Some(START));
            if let Some(target) = model.and_then(|r| r.get("Target")) {
                return Ok(target.to_owned());
            }
        }
        if let Some(name) = self.find("3D/3dmodel.model") {
            return Ok(name);
        }
        // Packages of the production extension also have models in deeper folders.
        let is_model = |n: &String| n.to_ascii_lowercase().ends_with(".model");
        let mut models: Vec<String> = self.names().into_iter().filter(is_model).collect();
        models.sort_by_key(|n| (n.matches('/').count(), n.clone()));
        models.into_iter().next().ok_or_else(|| {
            let reason = format!(
                "not a 3MF file: none of the {} files in this archive is a model (3D/3dmodel.model)",
                self.archive.len()
            );
            contents(self.source.path, "package", reason)
        })
    }

    /// Unpacks a file of the package and returns its text.
    fn text(&mut self, path: &str) -> Result<String, ReadError> {
        let refused = |reason: String| contents(self.source.path, path, reason);
        let name = self.find(path).ok_or_else(|| refused("the package has no such file".into()))?;
        let file =
            self.archive.by_name(&name).map_err(|e| refused(format!("cannot unpack: {e}")))?;
        let mut bytes = Vec::new();
        // The size in the header of the archive is not trusted.
        let limit = self.left;
        file.take(limit + 1)
            .read_to_end(&mut bytes)
            .map_err(|e| refused(format!("cannot unpack: {e}")))?;
        if bytes.len() as u64 > limit {
            return Err(refused(format!(
                "the package unpacks to more than the accepted {LARGEST_RATIO} times its size, or {LARGEST} bytes"
            )));
        }
        self.left -= bytes.len() as u64;
        colltrans_mesh::file::decoded(bytes).map_err(|e| refused(e.to_string()))
    }
}

/// The purpose of an object.
#[derive(Default, Clone, Copy)]
enum Kind {
    /// A body or a surface: a part of the model.
    #[default]
    Model,
    /// Not a part of the model. The text is the type of the object.
    Left(&'static str),
}

impl Kind {
    /// Parses a type of the core specification, 3.4.
    fn of(kind: Option<&str>) -> Result<Self, String> {
        match kind {
            None | Some("model" | "surface") => Ok(Self::Model),
            Some("support") => Ok(Self::Left("support")),
            Some("solidsupport") => Ok(Self::Left("solidsupport")),
            Some("other") => Ok(Self::Left("other")),
            Some(kind) => Err(format!(
                "unknown type {kind}; accepted: model, surface, support, solidsupport, other"
            )),
        }
    }
}

#[derive(Default)]
struct Object {
    name: Option<String>,
    kind: Kind,
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
    /// The models by normalised path ([`key`]).
    by_path: HashMap<String, Rc<Model>>,
    told: Told,
}

/// Normalises a path in a package: without the first `/`, in lower case, with escapes decoded.
fn key(path: &str) -> String {
    let path = unescaped(path).unwrap_or_else(|_| path.to_owned());
    path.trim_start_matches('/').to_ascii_lowercase()
}

/// Parses the root model and all models that it refers to, and the settings of slicers.
fn models(source: &Source, package: &mut Package, root: &str) -> Result<Models, ReadError> {
    let mut by_path = HashMap::new();
    let mut open = VecDeque::from([root.to_owned()]);
    while let Some(path) = open.pop_front() {
        if by_path.contains_key(&key(&path)) {
            continue;
        }
        let text = package.text(&path)?;
        let model = Parser::model(&text).map_err(|(place, reason)| {
            contents(source.path, format!("{}: {place}", path.trim_start_matches('/')), reason)
        })?;
        let components = model.objects.values().flat_map(|object| &object.components);
        let mut others: Vec<String> =
            components.chain(&model.items).filter_map(|placed| placed.path.clone()).collect();
        others.sort();
        open.extend(others);
        by_path.insert(key(&path), Rc::new(model));
    }
    let Some(model) = by_path.get(&key(root)).cloned() else {
        return Err(contents(source.path, root, "the package has no such file"));
    };
    for (path, other) in &by_path {
        if other.unit != model.unit {
            let reason = format!(
                "its unit is {}, but the unit of the root model is {}; all models must have the same unit",
                other.unit, model.unit
            );
            return Err(contents(source.path, path, reason));
        }
    }
    let mut told = Told::default();
    for path in slicer::FILES {
        if let Some(text) = package.find(path).and_then(|name| package.text(&name).ok()) {
            told.add(&text);
        }
    }
    Ok(Models { root: model, by_path, told })
}

/// The settings of a slicer for an object.
#[derive(Clone, Copy, Default)]
struct Said<'a> {
    /// The settings of the object, if an item of the build places it.
    whole: Option<&'a Whole>,
    /// The role of the object if it is not a part of the model.
    instead: Option<&'static str>,
}

/// A visitor of placed objects, with name, settings and transformation to the world. It returns whether the
/// components of the object are visited.
type Call<'a> = dyn FnMut(&str, &Object, Said, DAffine3) -> Result<bool, String> + 'a;

/// The context in which an object is placed.
#[derive(Default)]
struct Above<'a> {
    world: DAffine3,
    depth: usize,
    /// The name for objects without a name.
    name: Option<String>,
    /// The settings of the object that an item of the build places.
    whole: Option<&'a Whole>,
}

impl Models {
    /// Returns the names of the objects with a mesh that no item of the build places.
    fn unplaced(&self, root: &str) -> Vec<String> {
        let at = |from: &str, placed: &Placed| {
            (key(placed.path.as_deref().unwrap_or(from)), placed.id.clone())
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
    fn collect(
        &self,
        from: &str,
        placed: &Placed,
        above: &Above,
        call: &mut Call,
    ) -> Result<(), String> {
        let path = placed.path.as_deref().unwrap_or(from);
        let model =
            self.by_path.get(&key(path)).ok_or_else(|| format!("the package has no {path}"))?;
        let id = &placed.id;
        let object = model.objects.get(id).ok_or_else(|| {
            let place = placed.path.as_ref().map_or(String::new(), |path| format!(" in {path}"));
            format!("unknown object id {id}{place}")
        })?;
        if above.depth > DEEPEST {
            return Err(format!("components are nested deeper than {DEEPEST}, or in a cycle"));
        }
        if !object.has_mesh && object.components.is_empty() {
            return Err(format!("object {id} has neither a mesh nor components"));
        }
        let whole = if above.depth == 0 { self.told.of(id) } else { None };
        let body = above.whole.and_then(|whole| whole.parts.get(id));
        // The name that the slicer shows has priority.
        let name = whole.and_then(|whole| whole.name.as_ref());
        let name = name.or(body.and_then(|body| body.name.as_ref())).or(object.name.as_ref());
        let name = name.or(above.name.as_ref()).filter(|name| !name.trim().is_empty()).cloned();
        let told = Said { whole, instead: body.and_then(|body| body.instead) };
        let world = above.world * placed.transform;
        let shown = name.clone().unwrap_or_else(|| format!("object_{id}"));
        if !call(&shown, object, told, world)? {
            return Ok(());
        }
        let above = Above { world, depth: above.depth + 1, name, whole };
        for child in &object.components {
            self.collect(path, child, &above, call)?;
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
    fn model(text: &str) -> Result<Model, xml::Fault> {
        let mut reader = NsReader::from_str(text);
        let mut lines = Lines::new(text);
        let mut parser =
            Self { unit: None, objects: HashMap::new(), items: Vec::new(), current: None };
        let mut depth = 0_usize;
        loop {
            let line = lines.at(reader.buffer_position());
            let place = || format!("line {line}");
            let event = reader.read_event().map_err(|e| (place(), xml::told(&e)))?;
            match event {
                Event::Start(tag) => {
                    depth += 1;
                    if depth > DEEPEST_ELEMENT {
                        let reason = format!(
                            "elements are nested deeper than the accepted {DEEPEST_ELEMENT}"
                        );
                        return Err((place(), reason));
                    }
                    parser.open(&tag, reader.resolver()).map_err(|e| (place(), e))?;
                }
                Event::Empty(tag) => {
                    parser.open(&tag, reader.resolver()).map_err(|e| (place(), e))?;
                    parser.close(tag.local_name().as_ref()).map_err(|e| (place(), e))?;
                }
                Event::End(tag) => {
                    depth = depth.saturating_sub(1);
                    parser.close(tag.local_name().as_ref()).map_err(|e| (place(), e))?;
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
    fn open(&mut self, tag: &BytesStart, resolver: &NamespaceResolver) -> Result<(), String> {
        let (space, name) = resolver.resolve_element(tag.name());
        // Elements of extensions are skipped. Some writers use no namespace at all.
        if xml::namespace(&space).is_some_and(|space| space != CORE) {
            return if self.unit.is_none() { Err(not_a_model(tag)) } else { Ok(()) };
        }
        let name = name.as_ref();
        if self.unit.is_none() {
            return if name == "model" { self.begin(tag) } else { Err(not_a_model(tag)) };
        }
        if !matches!(name, "object" | "item" | "mesh" | "vertex" | "triangle" | "component") {
            return Ok(());
        }
        let attributes = Attributes::of(tag, resolver)?;
        match name {
            "object" if self.current.is_some() => return Err("nested object elements".into()),
            "object" => {
                let id = attributes.need("id")?.to_owned();
                let name = attributes.get("name").map(str::to_owned);
                let kind = Kind::of(attributes.get("type"))?;
                let object = Object { name, kind, ..Object::default() };
                self.current = Some((id, object, Mesh::default()));
            }
            "item" => self.items.push(attributes.placed()?),
            _ => {
                let Some((_, object, mesh)) = &mut self.current else { return Ok(()) };
                match name {
                    "mesh" => object.has_mesh = true,
                    "vertex" => {
                        let [x, y, z] = ["x", "y", "z"].map(|key| attributes.parsed(key));
                        mesh.vertices.push(DVec3::new(x?, y?, z?));
                    }
                    "triangle" => {
                        let [a, b, c] = ["v1", "v2", "v3"].map(|key| attributes.parsed(key));
                        mesh.faces.push(vec![a?, b?, c?]);
                    }
                    _ => object.components.push(attributes.placed()?),
                }
            }
        }
        Ok(())
    }

    /// Handles the end of an element.
    fn close(&mut self, name: &str) -> Result<(), String> {
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
    fn begin(&mut self, tag: &BytesStart) -> Result<(), String> {
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
    fn of(tag: &BytesStart, resolver: &NamespaceResolver) -> Result<Self, String> {
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
    fn need(&self, key: &str) -> Result<&str, String> {
        self.get(key).ok_or_else(|| format!("missing attribute {key}"))
    }

    /// Parses a number in an attribute that must exist.
    fn parsed<T: std::str::FromStr>(&self, key: &str) -> Result<T, String> {
        parsed(key, self.need(key)?)
    }

    /// Parses the reference to an object in an `item` or `component`.
    fn placed(&self) -> Result<Placed, String> {
        let id = self.need("objectid")?.to_owned();
        let (path, transform) = (self.path.clone(), transform(self.get("transform"))?);
        let unprinted = matches!(self.get("printable"), Some("0" | "false"));
        Ok(Placed { path, id, transform, unprinted })
    }
}

/// Parses the number in an attribute.
fn parsed<T: std::str::FromStr>(key: &str, text: &str) -> Result<T, String> {
    text.trim().parse().map_err(|_| format!("{key}=\"{text}\" is not a valid number"))
}

/// Parses a transform; `None` is the identity.
fn transform(text: Option<&str>) -> Result<DAffine3, String> {
    let Some(text) = text else { return Ok(DAffine3::IDENTITY) };
    let numbers: Result<Vec<f64>, String> =
        text.split_whitespace().map(|t| parsed("transform", t)).collect();
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
