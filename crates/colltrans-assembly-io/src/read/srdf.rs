//! Reads the pairs of links that an SRDF file excludes from collision checks.

use super::contents_error;
use super::files::Source;
use crate::error::ReadError;
use colltrans_mesh::xml::Element;

/// Returns the pairs of links in `disable_collisions` elements.
pub(super) fn read_disabled_pairs(source: &Source) -> Result<Vec<[String; 2]>, ReadError> {
    let text = source.text()?;
    let refused = |(place, reason)| contents_error(source.path, format!("SRDF: {place}"), reason);
    let robot = Element::parse(&text).map_err(refused)?;
    if robot.name != "robot" {
        let reason = format!("the root element is {}, expected robot", robot.name);
        return Err(contents_error(source.path, format!("SRDF: line {}", robot.line), reason));
    }
    let pair = |element: &Element| {
        let link = |what| {
            let name = element.required(what).map(str::to_owned);
            name.map_err(|e| contents_error(source.path, format!("SRDF: line {}", element.line), e))
        };
        Ok([link("link1")?, link("link2")?])
    };
    robot.children_named("disable_collisions").map(pair).collect()
}
