//! Generates mostly valid files: each function writes a small body in one format. Some counts, strides,
//! indices, numbers and characters have faults. Arbitrary bytes choose the body and the faults.
//!
//! Readers reject bytes without structure early. These generators reach the code behind the first checks.

use std::fmt::Write as _;

use arbitrary::{Result, Unstructured};

/// One in this many numbers, counts and indices is wrong.
const ONE_IN: u8 = 24;
/// Numbers at the limits of readers.
const NUMBERS: [&str; 18] = [
    "1e300",
    "-1e300",
    "1e999",
    "nan",
    "inf",
    "-inf",
    "-0",
    "5e-324",
    "1e-320",
    "1.7976931348623157e308",
    "0x10",
    "1e",
    "--1",
    "1,5",
    "",
    "3.4028235677973366e38",
    "0.1000000000000000055511151231257827",
    "9007199254740993",
];
/// Counts at the limits of integer types.
const COUNTS: [&str; 13] = [
    "0",
    "1",
    "2",
    "-1",
    "255",
    "65536",
    "2147483647",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551615",
    "18446744073709551616",
    "3.5",
];

type Bytes<'a, 'b> = &'a mut Unstructured<'b>;

/// Whether the next value has a fault.
fn is_wrong(u: Bytes) -> Result<bool> {
    u.ratio(1, ONE_IN)
}

/// Writes a number, rarely one of [`NUMBERS`].
fn number(u: Bytes, value: f64) -> Result<String> {
    Ok(if is_wrong(u)? { (*u.choose(&NUMBERS)?).into() } else { format!("{value}") })
}

/// Writes a count or an index, rarely a close one or one of [`COUNTS`].
fn count(u: Bytes, value: usize) -> Result<String> {
    if !is_wrong(u)? {
        return Ok(value.to_string());
    }
    if u.arbitrary()? {
        return Ok((*u.choose(&COUNTS)?).into());
    }
    Ok((value as i64 + u.int_in_range(-2..=2)?).to_string())
}

/// Returns a count in four bytes, rarely a wrong one.
fn word(u: Bytes, value: usize) -> Result<u32> {
    Ok(if is_wrong(u)? { u.arbitrary()? } else { value as u32 })
}

/// Returns white space, rarely another character than a blank.
fn space(u: Bytes) -> Result<&'static str> {
    Ok(if is_wrong(u)? {
        *u.choose(&["\t", "  ", "\n", "\r\n", "\x0b", "", "\\\n", ","])?
    } else {
        " "
    })
}

/// A closed body: a tetrahedron, a cube of quadrilaterals or a prism with polygonal faces.
struct Shape {
    vertices: Vec<[f64; 3]>,
    faces: Vec<Vec<usize>>,
}

impl Shape {
    /// Draws a body.
    fn any(u: Bytes) -> Result<Self> {
        let sides = u.int_in_range(3..=7_usize)?;
        let size = f64::from(u.int_in_range(-3..=9_i8)?).exp2();
        let mut vertices = Vec::new();
        for height in [0.0, size] {
            for k in 0..sides {
                let (sine, cosine) = (k as f64 * std::f64::consts::TAU / sides as f64).sin_cos();
                vertices.push([size * cosine, size * sine, height]);
            }
        }
        let mut faces = vec![(0..sides).rev().collect(), (sides..2 * sides).collect()];
        faces.extend((0..sides).map(|k| {
            let next = (k + 1) % sides;
            vec![k, next, next + sides, k + sides]
        }));
        if u.arbitrary()? {
            faces = faces.iter().flat_map(|face: &Vec<usize>| fan(face)).collect();
        }
        Ok(Self { vertices, faces })
    }

    /// Returns the faces as triangles.
    fn triangles(&self) -> Vec<Vec<usize>> {
        self.faces.iter().flat_map(|face| fan(face)).collect()
    }

    /// Writes the coordinates of a vertex.
    fn point(&self, u: Bytes, vertex: usize) -> Result<String> {
        let [x, y, z] = self.vertices[vertex];
        Ok(format!("{}{}{}{}{}", number(u, x)?, space(u)?, number(u, y)?, space(u)?, number(u, z)?))
    }
}

/// Returns the triangles around the first corner of a face.
fn fan(face: &[usize]) -> Vec<Vec<usize>> {
    (2..face.len()).map(|k| vec![face[0], face[k - 1], face[k]]).collect()
}

/// Adds a few faults of encoding: bytes that are not UTF-8, NUL, Ctrl-Z, comments, marks, cuts.
fn spoiled(u: Bytes, mut text: Vec<u8>, comment: &str) -> Result<Vec<u8>> {
    const INSERTED: [&[u8]; 10] = [
        b"\0",
        b"\x1a",
        b"\xe9",
        b"\xff\xfe",
        b"\xef\xbb\xbf",
        b"\r",
        b"\n",
        b"\xc3",
        b"\x80",
        b"&#0;",
    ];
    if u.ratio(1, 6)? {
        let line = format!("{comment} Geh\u{e4}use\n").into_bytes();
        let latin: Vec<u8> = line.iter().filter(|&&byte| byte != 0xc3).copied().collect();
        let line = if u.arbitrary()? { line } else { latin };
        text.splice(0..0, line);
    }
    for _ in 0..u.int_in_range(0..=2)? {
        let at = u.int_in_range(0..=text.len())?;
        match u.int_in_range(0..=4)? {
            0 => text.truncate(at),
            1 => text.extend_from_slice(u.choose(&INSERTED)?),
            2 => {
                text.splice(0..0, u.choose(&INSERTED)?.iter().copied());
            }
            3 => {
                text.splice(at..at, u.choose(&INSERTED)?.iter().copied());
            }
            _ => {
                let end = u.int_in_range(at..=text.len())?.min(at + 40);
                let copied = text[at..end].to_vec();
                text.splice(at..at, copied);
            }
        }
    }
    Ok(text)
}

/// Writes an STL file, ASCII or binary.
pub(crate) fn stl(u: Bytes) -> Result<Vec<u8>> {
    let shape = Shape::any(u)?;
    let triangles = shape.triangles();
    if u.arbitrary()? {
        let mut bytes = Vec::new();
        for solid in 0..u.int_in_range(1..=2)? {
            let mut text = format!("solid{}part{solid}\n", space(u)?);
            for face in &triangles {
                let _ = write!(text, "facet normal {} 0 1\nouter loop\n", number(u, 0.0)?);
                for &vertex in face {
                    let _ = writeln!(text, "vertex{}{}", space(u)?, shape.point(u, vertex)?);
                }
                text.push_str(if is_wrong(u)? { "endloop\n" } else { "endloop\nendfacet\n" });
            }
            text.push_str(if is_wrong(u)? { "endsolid" } else { "endsolid part\n" });
            bytes.extend(text.bytes());
        }
        return spoiled(u, bytes, ";");
    }
    let mut bytes = vec![b' '; 80];
    bytes[..5].copy_from_slice(if u.arbitrary()? { b"solid" } else { b"plain" });
    bytes.extend(word(u, triangles.len())?.to_le_bytes());
    for face in &triangles {
        bytes.extend([0; 12]);
        for &vertex in face {
            for value in shape.vertices[vertex] {
                let value =
                    if is_wrong(u)? { f32::from_bits(u.arbitrary()?) } else { value as f32 };
                bytes.extend(value.to_le_bytes());
            }
        }
        bytes.extend(u16::to_le_bytes(u.arbitrary()?));
    }
    spoiled(u, bytes, "")
}

/// Writes an OBJ file.
pub(crate) fn obj(u: Bytes) -> Result<Vec<u8>> {
    let shape = Shape::any(u)?;
    let mut text = String::from("o part\n");
    for vertex in 0..shape.vertices.len() {
        let _ = writeln!(
            text,
            "v {}{}",
            shape.point(u, vertex)?,
            if is_wrong(u)? { " 1 0 0" } else { "" }
        );
    }
    text.push_str("vn 0 0 1\nvt 0 0\n");
    for face in &shape.faces {
        text.push('f');
        for &vertex in face {
            let index = if u.ratio(1, 8)? {
                format!("-{}", count(u, shape.vertices.len() - vertex)?)
            } else {
                count(u, vertex + 1)?
            };
            let rest = *u.choose(&["", "", "/1", "//1", "/1/1", "/", "/9"])?;
            let _ = write!(text, "{}{index}{rest}", space(u)?);
        }
        text.push('\n');
        if is_wrong(u)? {
            text.push_str(u.choose(&[
                "g a\n",
                "usemtl x\n",
                "l 1 2\n",
                "p 1\n",
                "s off\n",
                "surf 1\n",
                "mtllib m\n",
            ])?);
        }
    }
    spoiled(u, text.into_bytes(), "#")
}

/// Writes an OFF file.
pub(crate) fn off(u: Bytes) -> Result<Vec<u8>> {
    let shape = Shape::any(u)?;
    let mut text = (*u.choose(&[
        "OFF\n",
        "OFF\n",
        "OFF ",
        "COFF\n",
        "NOFF\n",
        "STOFF\n",
        "4OFF\n",
        "OFF BINARY\n",
    ])?)
    .to_owned();
    let _ = writeln!(
        text,
        "{} {} {}",
        count(u, shape.vertices.len())?,
        count(u, shape.faces.len())?,
        count(u, 0)?
    );
    for vertex in 0..shape.vertices.len() {
        let _ = writeln!(text, "{}", shape.point(u, vertex)?);
    }
    for face in &shape.faces {
        text.push_str(&count(u, face.len())?);
        for &vertex in face {
            let _ = write!(text, "{}{}", space(u)?, count(u, vertex)?);
        }
        text.push_str(if is_wrong(u)? { " 255 0 0\n" } else { "\n" });
    }
    spoiled(u, text.into_bytes(), "#")
}

/// Writes a PLY file, ASCII or binary.
pub(crate) fn ply(u: Bytes) -> Result<Vec<u8>> {
    let shape = Shape::any(u)?;
    let encoding = *u.choose(&["ascii", "ascii", "binary_little_endian", "binary_big_endian"])?;
    let kinds =
        ["float", "double", "float32", "float64", "int", "uchar", "short", "list uchar float"];
    let kind = if is_wrong(u)? { *u.choose(&kinds)? } else { "double" };
    let list = if is_wrong(u)? { *u.choose(&kinds)? } else { "uchar" };
    let mut text = format!("ply\nformat {encoding} 1.0\n");
    if u.ratio(1, 4)? {
        text.push_str(u.choose(&[
            "comment Geh\u{e4}use\n",
            "obj_info x\n",
            "comment\n",
            "element other 0\n",
        ])?);
    }
    let _ = writeln!(text, "element vertex {}", count(u, shape.vertices.len())?);
    for axis in ["x", "y", "z"] {
        let _ = writeln!(text, "property {kind} {axis}");
    }
    let _ = writeln!(text, "element face {}", count(u, shape.faces.len())?);
    let _ = writeln!(
        text,
        "property list {list} int vertex_ind{}",
        if u.arbitrary()? { "ices" } else { "ex" }
    );
    text.push_str("end_header\n");
    let header = spoiled(u, text.into_bytes(), "comment")?;
    let mut bytes = header;
    if encoding == "ascii" {
        let mut body = String::new();
        for vertex in 0..shape.vertices.len() {
            let _ = writeln!(body, "{}", shape.point(u, vertex)?);
        }
        for face in &shape.faces {
            body.push_str(&count(u, face.len())?);
            for &vertex in face {
                let _ = write!(body, "{}{}", space(u)?, count(u, vertex)?);
            }
            body.push('\n');
        }
        bytes.extend(spoiled(u, body.into_bytes(), "")?);
        return Ok(bytes);
    }
    let is_little = encoding == "binary_little_endian";
    for value in shape.vertices.iter().flatten() {
        let value = if is_wrong(u)? { f64::from_bits(u.arbitrary()?) } else { *value };
        bytes.extend(if is_little { value.to_le_bytes() } else { value.to_be_bytes() });
    }
    for face in &shape.faces {
        bytes.push(word(u, face.len())? as u8);
        for &vertex in face {
            let vertex = word(u, vertex)?;
            bytes.extend(if is_little { vertex.to_le_bytes() } else { vertex.to_be_bytes() });
        }
    }
    spoiled(u, bytes, "")
}

/// Writes a COLLADA file.
pub(crate) fn dae(u: Bytes) -> Result<Vec<u8>> {
    let shape = Shape::any(u)?;
    let mut text = String::from("<?xml version=\"1.0\"?>\n<COLLADA version=\"1.4.1\"><asset>");
    let _ = write!(text, "<unit name=\"m\" meter=\"{}\"/>", number(u, 1.0)?);
    text.push_str("<up_axis>Z_UP</up_axis></asset><library_geometries><geometry id=\"g\"><mesh><source id=\"s\">");
    let _ =
        write!(text, "<float_array id=\"a\" count=\"{}\">", count(u, 3 * shape.vertices.len())?);
    for vertex in 0..shape.vertices.len() {
        let _ = write!(text, "{} ", shape.point(u, vertex)?);
    }
    let _ = write!(
        text,
        "</float_array><technique_common><accessor source=\"#a\" count=\"{}\" stride=\"{}\" offset=\"{}\">\
         <param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/>\
         </accessor></technique_common></source>\
         <vertices id=\"v\"><input semantic=\"POSITION\" source=\"#s\"/></vertices>",
        count(u, shape.vertices.len())?,
        count(u, 3)?,
        count(u, 0)?,
    );
    let kind = *u.choose(&["triangles", "polylist", "polygons", "trifans", "tristrips"])?;
    let inputs = u.int_in_range(1..=2_usize)?;
    let faces = if kind == "triangles" { shape.triangles() } else { shape.faces };
    let _ = write!(text, "<{kind} count=\"{}\">", count(u, faces.len())?);
    let _ = write!(text, "<input semantic=\"VERTEX\" source=\"#v\" offset=\"{}\"/>", count(u, 0)?);
    if inputs == 2 {
        let _ =
            write!(text, "<input semantic=\"NORMAL\" source=\"#s\" offset=\"{}\"/>", count(u, 1)?);
    }
    if kind == "polylist" {
        text.push_str("<vcount>");
        for face in &faces {
            let _ = write!(text, "{} ", count(u, face.len())?);
        }
        text.push_str("</vcount>");
    }
    let is_one = kind == "triangles" || kind == "polylist";
    if is_one {
        text.push_str("<p>");
    }
    for face in &faces {
        if !is_one {
            text.push_str("<p>");
        }
        for &vertex in face {
            for _ in 0..inputs {
                let _ = write!(text, "{} ", count(u, vertex)?);
            }
        }
        if !is_one {
            text.push_str("</p>");
        }
    }
    if is_one {
        text.push_str("</p>");
    }
    let _ = write!(text, "</{kind}></mesh></geometry></library_geometries>");
    text.push_str("<library_visual_scenes><visual_scene id=\"scene\"><node id=\"n\">");
    if u.arbitrary()? {
        text.push_str("<matrix>");
        for k in 0..16 {
            let _ = write!(text, "{} ", number(u, f64::from(k % 5 == 0))?);
        }
        text.push_str("</matrix>");
    }
    if u.arbitrary()? {
        let _ = write!(text, "<rotate>{} 0 1 {}</rotate>", number(u, 0.0)?, number(u, 90.0)?);
        let _ = write!(text, "<scale>{} 1 1</scale>", number(u, 1.0)?);
    }
    text.push_str("<instance_geometry url=\"#g\"/>");
    text.push_str(u.choose(&[
        "",
        "",
        "<instance_node url=\"#n\"/>",
        "<node><instance_geometry url=\"#g\"/></node>",
    ])?);
    text.push_str("</node></visual_scene></library_visual_scenes>");
    text.push_str("<scene><instance_visual_scene url=\"#scene\"/></scene></COLLADA>");
    spoiled(u, text.into_bytes(), "<!-- -->")
}

/// Writes an SRDF file.
pub(crate) fn srdf(u: Bytes) -> Result<Vec<u8>> {
    let mut text = String::from("<?xml version=\"1.0\"?>\n<robot name=\"r\">\n");
    for _ in 0..u.int_in_range(0..=6)? {
        let names = ["link1", "l2", "", "Geh\u{e4}use", "&lt;a&gt;", "link1"];
        let (a, b) = (*u.choose(&names)?, *u.choose(&names)?);
        let element = *u.choose(&[
            "disable_collisions",
            "disable_collisions",
            "enable_collisions",
            "group",
            "disable_default_collisions",
        ])?;
        let _ = match u.int_in_range(0..=5)? {
            0 => writeln!(text, "<{element} link1=\"{a}\"/>"),
            1 => writeln!(text, "<{element} link=\"{a}\"/>"),
            2 => writeln!(text, "<{element} link1='{a}' link2='{b}'>x</{element}>"),
            _ => writeln!(text, "<{element} link1=\"{a}\" link2=\"{b}\" reason=\"Never\"/>"),
        };
    }
    text.push_str("</robot>\n");
    spoiled(u, text.into_bytes(), "<!-- -->")
}

/// Writes a table of joint values.
pub(crate) fn csv(u: Bytes) -> Result<Vec<u8>> {
    let columns = u.int_in_range(1..=4_usize)?;
    let separator = *u.choose(&[",", ",", ";", "\t", " "])?;
    let mut text = String::new();
    if u.arbitrary()? {
        let names =
            ["time", "joint1", "\"j 2\"", "joint1", "t", "", "Geh\u{e4}use", "time_from_start"];
        for k in 0..columns {
            let _ = write!(text, "{}{}", if k > 0 { separator } else { "" }, u.choose(&names)?);
        }
        text.push('\n');
    }
    for row in 0..u.int_in_range(0..=4)? {
        for k in 0..columns + usize::from(is_wrong(u)?) {
            let value = number(u, f64::from(row) + k as f64 / 8.0)?;
            let _ = write!(text, "{}{value}", if k > 0 { separator } else { "" });
        }
        text.push_str(u.choose(&["\n", "\n", "\r\n", "\r", "\n\n"])?);
    }
    spoiled(u, text.into_bytes(), "#")
}

/// Replaces, drops, repeats or slightly changes a few values of a JSON document.
pub(crate) fn json(u: Bytes, seeds: &[String]) -> Result<Vec<u8>> {
    let seed = u.choose(seeds)?;
    let mut document: serde_json::Value = serde_json::from_str(seed).expect("a document");
    for _ in 0..u.int_in_range(0..=3)? {
        change(u, &mut document)?;
    }
    // Numbers that JSON's own type cannot hold are strings between `@` until here.
    let text = document.to_string().replace("\"@", "").replace("@\"", "");
    if u.ratio(1, 8)? { spoiled(u, text.into_bytes(), " ") } else { Ok(text.into_bytes()) }
}

/// Changes one value at a random depth.
fn change(u: Bytes, value: &mut serde_json::Value) -> Result<()> {
    use serde_json::Value;
    match value {
        Value::Array(items) if !items.is_empty() && !u.ratio(1, 8)? => {
            let at = u.int_in_range(0..=items.len() - 1)?;
            match u.int_in_range(0..=15)? {
                0 => drop(items.remove(at)),
                1 => items.insert(at, items[at].clone()),
                2 => items.swap(0, at),
                _ => change(u, &mut items[at])?,
            }
        }
        Value::Object(fields) if !fields.is_empty() && !u.ratio(1, 8)? => {
            let names: Vec<String> = fields.keys().cloned().collect();
            let name = u.choose(&names)?;
            match u.int_in_range(0..=15)? {
                0 => drop(fields.remove(name)),
                1 => {
                    let other = fields[u.choose(&names)?].clone();
                    fields[name] = other;
                }
                _ => change(u, &mut fields[name])?,
            }
        }
        value => {
            let number = value.as_f64();
            *value = match u.int_in_range(0..=7)? {
                0 => Value::Null,
                1 => Value::Array(Vec::new()),
                2 => Value::String("x".into()),
                3 => Value::String(format!("@{}@", u.choose(&COUNTS)?)),
                4 => Value::String(format!("@{}@", u.choose(&NUMBERS)?)),
                5 => number.map_or(Value::Bool(true), |n| (-n).into()),
                6 => f64::from_bits(u.arbitrary()?).into(),
                _ => {
                    let bits = number.unwrap_or(1.0).to_bits();
                    f64::from_bits(bits.wrapping_add_signed(u.int_in_range(-4..=4)?)).into()
                }
            };
        }
    }
    Ok(())
}
