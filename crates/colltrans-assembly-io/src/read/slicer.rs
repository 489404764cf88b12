//! Reads the files that slicers add to a 3MF package. They name objects, divide meshes into bodies, and mark the
//! bodies that only instruct the slicer, for example modifiers, which are not parts of the model. A file that cannot
//! be parsed is ignored.
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
pub(super) struct SlicerSettings(HashMap<String, ObjectSettings>);

/// The settings of an object.
#[derive(Default)]
pub(super) struct ObjectSettings {
    pub(super) name: Option<String>,
    /// The settings of its components, by the id of the object that each places.
    pub(super) parts: HashMap<String, BodySettings>,
    /// The ranges of triangles of its mesh that form separate bodies, with their settings.
    pub(super) volumes: Vec<(Range<usize>, BodySettings)>,
}

/// The settings of a body.
#[derive(Clone, Default)]
pub(super) struct BodySettings {
    pub(super) name: Option<String>,
    /// The role of the body if it is not a part of the model.
    pub(super) role: Option<&'static str>,
}

impl SlicerSettings {
    /// Adds the settings in a file.
    pub(super) fn add_file(&mut self, text: &str) {
        let Ok(file) = Element::parse(text) else { return };
        for object in file.children_named("object") {
            let Some(id) = object.get("id") else { continue };
            let whole = self.0.entry(id.to_owned()).or_default();
            whole.name = whole.name.take().or_else(|| metadata_value(object, "name"));
            for part in object.children_named("part") {
                if let Some(id) = part.get("id") {
                    whole.parts.insert(
                        id.to_owned(),
                        BodySettings::from_element(part, part.get("subtype")),
                    );
                }
            }
            for volume in object.children_named("volume") {
                let end = |key| volume.get(key).and_then(|text| text.parse::<usize>().ok());
                if let (Some(first), Some(last)) = (end("firstid"), end("lastid")) {
                    let kind = metadata_value(volume, "volume_type");
                    let body = BodySettings::from_element(volume, kind.as_deref());
                    whole.volumes.push((first..last.saturating_add(1), body));
                }
            }
        }
    }

    /// Returns the settings of an object by its id; `None` if the files have none.
    pub(super) fn object(&self, id: &str) -> Option<&ObjectSettings> {
        self.0.get(id)
    }
}

impl ObjectSettings {
    /// Returns the bodies if there are several and their consecutive ranges cover exactly `triangles`
    /// triangles; otherwise `None`.
    pub(super) fn consecutive_bodies(
        &self,
        triangles: usize,
    ) -> Option<&[(Range<usize>, BodySettings)]> {
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

impl BodySettings {
    /// Builds the settings of a body from its element and its kind.
    fn from_element(element: &Element, kind: Option<&str>) -> Self {
        let role = match kind {
            Some("negative_part" | "NegativeVolume") => Some("negative"),
            Some("modifier_part" | "ParameterModifier") => Some("modifier"),
            Some("support_blocker" | "support_enforcer" | "SupportBlocker" | "SupportEnforcer") => {
                Some("support region")
            }
            _ => None,
        };
        Self { name: metadata_value(element, "name"), role }
    }
}

/// Returns the value of a `metadata` child with this key; `None` if it is missing or blank.
fn metadata_value(element: &Element, key: &str) -> Option<String> {
    let found = element.children_named("metadata").find(|entry| entry.get("key") == Some(key));
    let value = found.and_then(|entry| entry.get("value"));
    value.map(str::trim).filter(|value| !value.is_empty()).map(str::to_owned)
}
