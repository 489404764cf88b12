//! What slicers say of the objects of a 3MF package beside the model: names, and which bodies only tell the slicer what to do
//! in them. Of a file that cannot be read nothing is known; it says nothing of shapes.
//!
//! Two dialects: `Metadata/model_settings.config` has a `part` for each component of an object, known by the number of the
//! object that it places; `Metadata/Slic3r_PE_model.config` a `volume` for each run of triangles of an object's mesh.

use std::collections::HashMap;
use std::ops::Range;

use colltrans_mesh::xml::Element;

/// Where these files are in a package.
pub(super) const FILES: [&str; 2] =
    ["Metadata/model_settings.config", "Metadata/Slic3r_PE_model.config"];

/// What is said of the objects of the first model, by their numbers.
#[derive(Default)]
pub(super) struct Told(HashMap<String, Whole>);

/// What is said of an object.
#[derive(Default)]
pub(super) struct Whole {
    pub(super) name: Option<String>,
    /// Of its components, by the numbers of what they place.
    pub(super) parts: HashMap<String, Body>,
    /// Of its triangles, if they are of several bodies.
    pub(super) volumes: Vec<(Range<usize>, Body)>,
}

/// What is said of a body.
#[derive(Clone, Default)]
pub(super) struct Body {
    pub(super) name: Option<String>,
    /// What it is instead of a part of the model.
    pub(super) instead: Option<&'static str>,
}

impl Told {
    /// Adds what a file says.
    pub(super) fn add(&mut self, text: &str) {
        let Ok(file) = Element::parse(text) else { return };
        for object in file.all("object") {
            let Some(id) = object.get("id") else { continue };
            let whole = self.0.entry(id.to_owned()).or_default();
            whole.name = whole.name.take().or_else(|| said(object, "name"));
            for part in object.all("part") {
                if let Some(id) = part.get("id") {
                    whole.parts.insert(id.to_owned(), Body::of(part, part.get("subtype")));
                }
            }
            for volume in object.all("volume") {
                let end = |key| volume.get(key).and_then(|text| text.parse::<usize>().ok());
                if let (Some(first), Some(last)) = (end("firstid"), end("lastid")) {
                    let kind = said(volume, "volume_type");
                    let body = Body::of(volume, kind.as_deref());
                    whole.volumes.push((first..last.saturating_add(1), body));
                }
            }
        }
    }

    pub(super) fn of(&self, id: &str) -> Option<&Whole> {
        self.0.get(id)
    }
}

impl Whole {
    /// Its bodies, if they are runs of all of so many triangles, one after another.
    pub(super) fn bodies(&self, triangles: usize) -> Option<&[(Range<usize>, Body)]> {
        let mut end = 0;
        for (run, _) in &self.volumes {
            if run.start != end || run.end <= end {
                return None;
            }
            end = run.end;
        }
        (self.volumes.len() > 1 && end == triangles).then_some(&self.volumes)
    }
}

impl Body {
    fn of(element: &Element, kind: Option<&str>) -> Self {
        let instead = match kind {
            Some("negative_part" | "NegativeVolume") => Some("negative"),
            Some("modifier_part" | "ParameterModifier") => Some("modifier"),
            Some("support_blocker" | "support_enforcer" | "SupportBlocker" | "SupportEnforcer") => {
                Some("where supports are")
            }
            _ => None,
        };
        Self { name: said(element, "name"), instead }
    }
}

/// The value of a `metadata` in an element, if it is more than blanks.
fn said(element: &Element, key: &str) -> Option<String> {
    let found = element.all("metadata").find(|said| said.get("key") == Some(key));
    let value = found.and_then(|said| said.get("value"));
    value.map(str::trim).filter(|value| !value.is_empty()).map(str::to_owned)
}
