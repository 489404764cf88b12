//! Reads the files that slicers add to a 3MF package: names of objects, and bodies that are no parts of the
//! model but instructions for the slicer. These files do not affect shapes; a file that cannot be parsed is
//! ignored.
//!
//! - `Metadata/model_settings.config` has a `part` for each component of an object. Its id is that of the
//!   object that the component places.
//! - `Metadata/Slic3r_PE_model.config` has a `volume` for each run of triangles of an object's mesh.

use std::collections::HashMap;
use std::ops::Range;

use colltrans_mesh::xml::Element;

/// The paths of these files in a package.
pub(super) const FILES: [&str; 2] =
    ["Metadata/model_settings.config", "Metadata/Slic3r_PE_model.config"];

/// The settings of the objects of the root model, by their ids.
#[derive(Default)]
pub(super) struct Told(HashMap<String, Whole>);

/// The settings of an object.
#[derive(Default)]
pub(super) struct Whole {
    pub(super) name: Option<String>,
    /// The settings of its components, by the id of the object that each places.
    pub(super) parts: HashMap<String, Body>,
    /// The ranges of triangles of its mesh that form separate bodies, with their settings.
    pub(super) volumes: Vec<(Range<usize>, Body)>,
}

/// The settings of a body.
#[derive(Clone, Default)]
pub(super) struct Body {
    pub(super) name: Option<String>,
    /// The role of the body if it is not a part of the model.
    pub(super) instead: Option<&'static str>,
}

impl Told {
    /// Adds the settings in a file.
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

    /// Returns the settings of an object by its id; `None` if the files have none.
    pub(super) fn of(&self, id: &str) -> Option<&Whole> {
        self.0.get(id)
    }
}

impl Whole {
    /// Returns the bodies if there are several and their consecutive ranges cover exactly `triangles`
    /// triangles; otherwise `None`.
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
    /// Builds the settings of a body from its element and its kind.
    fn of(element: &Element, kind: Option<&str>) -> Self {
        let instead = match kind {
            Some("negative_part" | "NegativeVolume") => Some("negative"),
            Some("modifier_part" | "ParameterModifier") => Some("modifier"),
            Some("support_blocker" | "support_enforcer" | "SupportBlocker" | "SupportEnforcer") => {
                Some("support region")
            }
            _ => None,
        };
        Self { name: said(element, "name"), instead }
    }
}

/// Returns the value of a `metadata` child with this key; `None` if it is missing or blank.
fn said(element: &Element, key: &str) -> Option<String> {
    let found = element.all("metadata").find(|said| said.get("key") == Some(key));
    let value = found.and_then(|said| said.get("value"));
    value.map(str::trim).filter(|value| !value.is_empty()).map(str::to_owned)
}
