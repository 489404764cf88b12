//! Which links of a robot are not held against each other, as SRDF says it.

use super::contents;
use super::files::Source;
use crate::error::ReadError;
use colltrans_mesh::xml::Element;

/// The pairs of `disable_collisions`.
pub(super) fn read(source: &Source) -> Result<Vec<[String; 2]>, ReadError> {
    let text = source.text()?;
    let refused = |(place, reason)| contents(source.path, format!("SRDF: {place}"), reason);
    let robot = Element::parse(&text).map_err(refused)?;
    if robot.name != "robot" {
        let reason = format!("it is not a robot: its first element is {}, not robot", robot.name);
        return Err(contents(source.path, format!("SRDF: line {}", robot.line), reason));
    }
    let pair = |element: &Element| {
        let link = |what| {
            let name = element.need(what).map(str::to_owned);
            name.map_err(|e| contents(source.path, format!("SRDF: line {}", element.line), e))
        };
        Ok([link("link1")?, link("link2")?])
    };
    robot.all("disable_collisions").map(pair).collect()
}
