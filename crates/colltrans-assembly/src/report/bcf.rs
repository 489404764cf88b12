//! The violations of an audit as a BCF file, version 2.1: issues for programs that review building models.
//!
//! - Each pair is a topic with its numbers, a camera in front of a section plane through the place, and a picture.
//! - Parts are components named by `AuthoringToolId`. A name that is an identifier of IFC is also the `IfcGuid`.
//! - Identifiers are UUIDs of version 8 (RFC 9562, 5.8): FNV-1a hashes of the title and of both names, in any order.
//!   Another audit of the same parts has the same identifiers, so that programs can update their topics.
//! - Lengths are in metres, as BCF requires. A source without a unit is taken to be in metres.
//! - The z axis points upwards. Coordinates of files in which another axis does, such as glTF, are rotated.
//!
//! Reference: buildingSMART, BCF-XML 2.1, `markup.xsd` and `visinfo.xsd`.

use std::io::{self, Cursor, Write};
use std::sync::OnceLock;

use colltrans_picture::escape_xml;
use glam::DVec3;
use rayon::prelude::*;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::clashes::{display_names, facts, headline, pair_cut};
use super::cut::Cut;
use super::cut::snapshot::Camera;
use super::lines::SortedLines;
use crate::audit::{Audit, AuditedPair};
use crate::part::{Assembly, Part};
use crate::units::{UNIT_NAMES, unit_in_metres};
use crate::watch::{Stage, Watch};

/// Author of the topics.
const AUTHOR: &str = "colltrans";
/// Angle of view of the camera in degrees, and the sine of half of it.
const FIELD_OF_VIEW: (f64, f64) = (45.0, 0.382_683_432_365_09);
/// Maximum number of topics, the worst. Programs that read BCF files expect fewer than 65,535 files in them.
pub const MAX_TOPICS: usize = 10_000;
/// Number of topics that are drawn at a time.
const TOPICS_AT_A_TIME: usize = 64;
/// First line of XML files.
const XML: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

/// A topic: its identifier and its files.
struct Topic {
    id: String,
    markup: String,
    viewpoint: String,
    snapshot: Vec<u8>,
}

/// Returns the violations of an audit, at most [`MAX_TOPICS`], as the bytes of a BCF file. `seconds` since 1970 is the
/// time of creation in the topics, `title` names the model in the identifiers.
///
/// # Errors
/// - The unit of the assembly is not listed in [`UNIT_NAMES`] ([`io::ErrorKind::InvalidInput`]).
/// - The package would be too large for the ZIP format, or the run is cancelled.
pub fn bcf_file(
    assembly: &Assembly,
    audit: &Audit,
    title: &str,
    seconds: u64,
    watch: Watch,
) -> io::Result<Vec<u8>> {
    let per_unit = metres_per_unit(assembly)
        .map_err(|message| io::Error::new(io::ErrorKind::InvalidInput, message))?;
    let lines: Vec<OnceLock<SortedLines>> =
        assembly.parts().iter().map(|_| OnceLock::new()).collect();
    let all: Vec<&AuditedPair> = audit.violations().take(MAX_TOPICS).collect();
    let tally = watch.start_stage(Stage::Pictures, all.len());
    let mut file = ZipWriter::new(Cursor::new(Vec::new()));
    let mut put = |path: &str, bytes: &[u8]| {
        file.start_file(path, SimpleFileOptions::default())?;
        file.write_all(bytes)
    };
    put(
        "bcf.version",
        format!(
            "{XML}<Version VersionId=\"2.1\"><DetailedVersion>2.1</DetailedVersion></Version>\n"
        )
        .as_bytes(),
    )?;
    for (chunk, pairs) in all.chunks(TOPICS_AT_A_TIME).enumerate() {
        let draw = |(k, pair): (usize, &&AuditedPair)| {
            let index = chunk * TOPICS_AT_A_TIME + k;
            let texts = [title, &utc_text(seconds)];
            let topic = topic((assembly, per_unit), pair, &lines, texts, index);
            tally.finish_item().map(|()| topic)
        };
        let topics: Result<Vec<Topic>, _> = pairs.par_iter().enumerate().map(draw).collect();
        for Topic { id, markup, viewpoint, snapshot } in topics.map_err(io::Error::other)? {
            put(&format!("{id}/markup.bcf"), markup.as_bytes())?;
            put(&format!("{id}/viewpoint.bcfv"), viewpoint.as_bytes())?;
            put(&format!("{id}/snapshot.png"), &snapshot)?;
        }
    }
    Ok(file.finish()?.into_inner())
}

/// Returns the length of the unit of an assembly in metres, which is 1 without a unit.
///
/// # Errors
/// A message if the unit is unknown.
pub fn metres_per_unit(assembly: &Assembly) -> Result<f64, String> {
    let Some(unit) = assembly.unit() else { return Ok(1.0) };
    let accepted = || UNIT_NAMES.join(", ");
    unit_in_metres(unit)
        .ok_or_else(|| format!("unknown unit {unit}; BCF needs one of {}", accepted()))
}

/// Builds the topic of a pair in an assembly, whose unit has this length in metres.
fn topic(
    (assembly, per_unit): (&Assembly, f64),
    pair: &AuditedPair,
    lines: &[OnceLock<SortedLines>],
    [title, date]: [&str; 2],
    index: usize,
) -> Topic {
    let parts = pair.parts.map(|part| assembly.parts()[part].name());
    // Another export may list the parts in another order.
    let [first, second] = [parts[0].min(parts[1]), parts[0].max(parts[1])];
    let [id, view] = ["topic", "viewpoint"].map(|kind| uuid(&[title, kind, first, second]));
    let kind = pair.finding.name();
    let [a, b] = display_names(assembly, pair);
    let heading = format!("{a} and {b}: {kind}, {}", headline(assembly, pair));
    let facts =
        facts(assembly, pair).into_iter().map(|fact| format!("{}: {}", fact.name, fact.value));
    let description = facts.collect::<Vec<_>>().join("\n");
    let [heading, description, date] = [&heading, &description, date].map(escape_xml);
    let markup = format!(
        "{XML}<Markup>\n\
         <Topic Guid=\"{id}\" TopicType=\"Clash\" TopicStatus=\"Open\">\n\
         <Title>{heading}</Title>\n<Index>{index}</Index>\n<Labels>{kind}</Labels>\n\
         <CreationDate>{date}</CreationDate>\n<CreationAuthor>{AUTHOR}</CreationAuthor>\n\
         <Description>{description}</Description>\n</Topic>\n\
         <Viewpoints Guid=\"{view}\">\n<Viewpoint>viewpoint.bcfv</Viewpoint>\n<Snapshot>snapshot.png</Snapshot>\n\
         </Viewpoints>\n</Markup>\n"
    );
    let cut = pair_cut(assembly, pair);
    let solid = |part: usize| Part::solid(&assembly.parts()[part]);
    let solids = pair.parts.map(solid);
    let edges = |part: usize| lines[part].get_or_init(|| SortedLines::new(solid(part)));
    let lines = pair.parts.map(edges);
    Topic {
        id,
        markup,
        viewpoint: viewpoint(parts, &cut, &view, per_unit, assembly.up()),
        snapshot: cut.snapshot(solids, lines),
    }
}

/// Returns the viewpoint file: both parts selected and coloured, a camera, and the section plane. `upwards` is the
/// vertical axis of the model.
fn viewpoint(parts: [&str; 2], cut: &Cut, id: &str, per_unit: f64, upwards: DVec3) -> String {
    let Camera { toward, up, hidden } = cut.camera();
    let away = cut.radius / FIELD_OF_VIEW.1;
    let [a, b] = parts.map(component);
    // Exact rotations, without rounding.
    let written = |v: DVec3| match upwards {
        DVec3::Y => coordinates([v.x, -v.z, v.y]),
        DVec3::X => coordinates([v.y, v.z, v.x]),
        _ => coordinates(v.to_array()),
    };
    let [eye, at] = [(cut.at + toward * away) * per_unit, cut.at * per_unit].map(written);
    let [direction, up, hidden] = [-toward, up, hidden].map(written);
    let angle = FIELD_OF_VIEW.0;
    format!(
        "{XML}<VisualizationInfo Guid=\"{id}\">\n<Components>\n<Selection>\n{a}{b}</Selection>\n\
         <Visibility DefaultVisibility=\"true\"/>\n\
         <Coloring>\n<Color Color=\"6F97D6\">\n{a}</Color>\n<Color Color=\"D9CBB0\">\n{b}</Color>\n</Coloring>\n\
         </Components>\n\
         <PerspectiveCamera>\n<CameraViewPoint>{eye}</CameraViewPoint>\n\
         <CameraDirection>{direction}</CameraDirection>\n<CameraUpVector>{up}</CameraUpVector>\n\
         <FieldOfView>{angle}</FieldOfView>\n</PerspectiveCamera>\n\
         <ClippingPlanes>\n<ClippingPlane><Location>{at}</Location><Direction>{hidden}</Direction></ClippingPlane>\n\
         </ClippingPlanes>\n</VisualizationInfo>\n"
    )
}

/// Returns the element of a part.
fn component(name: &str) -> String {
    let is_ifc = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '$';
    // The first of 22 digits of 6 bits has the first 2 of 128 bits.
    let is_guid =
        name.len() == 22 && name.starts_with(['0', '1', '2', '3']) && name.chars().all(is_ifc);
    let guid = if is_guid { format!(" IfcGuid=\"{name}\"") } else { String::new() };
    let name = escape_xml(name);
    format!(
        "<Component{guid}><OriginatingSystem>{AUTHOR}</OriginatingSystem>\
         <AuthoringToolId>{name}</AuthoringToolId></Component>\n"
    )
}

/// Returns the elements of the coordinates of a vector.
fn coordinates([x, y, z]: [f64; 3]) -> String {
    format!("<X>{x}</X><Y>{y}</Y><Z>{z}</Z>")
}

/// Returns the identifier of a list of texts.
fn uuid(texts: &[&str]) -> String {
    const OFFSET: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
    let hash = texts.iter().fold(OFFSET, |hash, text| {
        // 255 is in no text and separates them.
        let bytes = text.bytes().chain([255]);
        bytes.fold(hash, |hash, byte| (hash ^ u128::from(byte)).wrapping_mul(PRIME))
    });
    let versioned = hash & !(0xf << 76) & !(0b11 << 62) | 0x8 << 76 | 0b10 << 62;
    let digits = format!("{versioned:032x}");
    let group = |from: usize, to: usize| &digits[from..to];
    [group(0, 8), group(8, 12), group(12, 16), group(16, 20), group(20, 32)].join("-")
}

/// Returns a time in seconds since 1970 as a date and a time of day, UTC.
fn utc_text(seconds: u64) -> String {
    let (days, time) = (seconds / 86_400, seconds % 86_400);
    // Days since the first of March of the year 0, in eras of 400 years (Hinnant, "chrono-compatible low-level date
    // algorithms").
    let days = days + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = era * 400 + year + u64::from(month <= 2);
    let [hour, minute, second] = [time / 3_600, time / 60 % 60, time % 60];
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_around_leap_days_are_those_of_the_calendar() {
        // `date -u -d @SECONDS +%FT%TZ`
        for (seconds, text) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (951_868_800, "2000-03-01T00:00:00Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
            (1_796_083_199, "2026-11-30T23:59:59Z"),
        ] {
            assert_eq!(utc_text(seconds), text);
        }
        assert!(utc_text(u64::MAX).ends_with('Z'));
    }

    #[test]
    fn identifiers_depend_on_the_borders_of_texts() {
        let id = uuid(&["ab", "c"]);
        assert_ne!(id, uuid(&["a", "bc"]));
        assert_eq!(id, uuid(&["ab", "c"]));
        let (version, variant) = (id.as_bytes()[14], id.as_bytes()[19]);
        assert!(version == b'8' && b"89ab".contains(&variant), "{id}");
    }
}
