//! Tests each format: valid files, and the errors of invalid ones.

use std::path::Path;

use colltrans_mesh::{Error, Format, Groups, Mesh, Place, parse, to_obj, to_off, to_stl};
use glam::DVec3;

fn read_bytes(format: Format, text: impl AsRef<[u8]>) -> Result<Mesh, Error> {
    parse(format, text.as_ref().to_vec(), Path::new("part"))
}

fn error_place(format: Format, text: impl AsRef<[u8]>) -> Place {
    match read_bytes(format, text) {
        Err(Error::Syntax { place, what, path }) => {
            assert_eq!(path, Path::new("part"));
            assert!(!what.is_empty() && !what.contains('\n'), "{what:?}");
            place
        }
        other => panic!("expected a syntax error, got {other:?}"),
    }
}

#[test]
fn text_in_ply_file_reports_missing_first_line() {
    let error = read_bytes(Format::Ply, "ply-like words\n").unwrap_err().to_string();
    assert_eq!(
        error,
        "part: line 1: the first line of a PLY file must be `ply`, found `ply-like words`"
    );
}

fn tetrahedron() -> Mesh {
    Mesh::new(
        vec![
            DVec3::ZERO,
            DVec3::new(0.1, 0.0, 0.0),
            DVec3::new(0.0, 1e-17, 0.3),
            DVec3::new(1.0 / 3.0, 2.0, -1e22),
        ],
        vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![0, 3, 2]],
    )
}

#[test]
fn text_formats_round_trip_exactly() {
    let mesh = tetrahedron();
    for back in [read_bytes(Format::Obj, to_obj(&mesh)), read_bytes(Format::Off, to_off(&mesh))] {
        let Mesh { vertices, faces, .. } = back.unwrap();
        assert_eq!((vertices, faces), (mesh.vertices.clone(), mesh.faces.clone()));
    }
}

#[test]
fn binary_stl_returns_single_precision() {
    let mesh = tetrahedron();
    let bytes = to_stl(&mesh).unwrap();
    assert_eq!(bytes.len(), 84 + 50 * 4);
    let read_back = read_bytes(Format::Stl, &bytes).unwrap();
    // Vertices are welded in the order of the faces: 0 2 1, then 3.
    let rounded = |v: usize| mesh.vertices[v].as_vec3().as_dvec3();
    assert_eq!(read_back.vertices, [rounded(0), rounded(2), rounded(1), rounded(3)]);
    assert_eq!(read_back.faces, [[0, 1, 2], [0, 2, 3], [2, 1, 3], [0, 3, 1]]);
    assert_eq!(to_stl(&Mesh::new(mesh.vertices, vec![vec![0, 1, 2, 3]])), None);
}

#[test]
fn binary_stl_may_begin_with_solid() {
    let mut bytes = to_stl(&tetrahedron()).unwrap();
    bytes[..13].copy_from_slice(b"solid by hand");
    assert_eq!(read_bytes(Format::Stl, &bytes).unwrap().faces.len(), 4);
}

#[test]
fn binary_stl_size_must_match_its_header() {
    let bytes = to_stl(&tetrahedron()).unwrap();
    assert_eq!(error_place(Format::Stl, &bytes[..bytes.len() - 1]), Place::End);
    assert_eq!(error_place(Format::Stl, &bytes[..60]), Place::End);
    assert_eq!(error_place(Format::Stl, b""), Place::End);
    let mut lying = bytes.clone();
    lying[80..84].fill(0xff);
    assert_eq!(error_place(Format::Stl, &lying), Place::End);
    let padded = [bytes, vec![0; 7]].concat();
    assert_eq!(read_bytes(Format::Stl, &padded).unwrap().faces.len(), 4);
}

const FACET: &str = "  facet normal 0 0 nan\n    OUTER loop\n vertex 0 0 0\n vertex 1 0 0\n\
    vertex 0 1.00000000000000001E-014 -0\n endloop\n  endfacet\n";

#[test]
fn text_stl_keeps_digits_and_all_solids() {
    let mesh =
        read_bytes(Format::Stl, format!("solid\r\n{FACET}endsolid\n\nsolid b\n{FACET}endsolid b"))
            .unwrap();
    assert_eq!(mesh.faces, [[0, 1, 2], [0, 1, 2]]);
    assert_eq!(mesh.vertices[2], DVec3::new(0.0, 1e-14, 0.0));
}

#[test]
fn text_stl_accepts_padding_comments_and_control_bytes() {
    let text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\nvertex 0 1 0\n\
        endloop\nendfacet\nendsolid a\n";
    let plain = read_bytes(Format::Stl, text).unwrap();
    let commented = text.replacen("outer", "# made by foo\n  ; bar\nouter", 1);
    let inputs: [Vec<u8>; 12] = [
        commented.clone().into_bytes(),
        commented.replace('\n', "\r\n").into_bytes(),
        text.replacen("0.1 0 0", "0.1 0 0 # the second", 1).into_bytes(),
        [text.as_bytes(), b"\x1a"].concat(),
        [text.as_bytes(), b"\0\0\0"].concat(),
        [text.as_bytes(), b"\x1a\0\r\n"].concat(),
        [b"; made by foo\n", text.as_bytes()].concat(),
        [b"# Geh\xe4use\r\n\r\n// x\r\n", text.as_bytes()].concat(),
        text.replacen("solid a", "solid \0a", 1).into_bytes(),
        [b"\0", text.as_bytes()].concat(),
        [b"\x1a", text.as_bytes()].concat(),
        [b"\xef\xbb\xbf\0\0", text.as_bytes(), b"\0"].concat(),
    ];
    for input in inputs {
        assert_eq!(read_bytes(Format::Stl, &input).unwrap().vertices, plain.vertices, "{input:?}");
    }
    let inside = text.replacen("0.1", "0\0.1", 1);
    assert_eq!(error_place(Format::Stl, inside), Place::Line(5));
    // A line that is commented out is missing.
    assert_eq!(error_place(Format::Stl, text.replacen("outer", "; outer", 1)), Place::Line(4));
}

#[test]
fn other_text_in_stl_file_is_rejected_with_line() {
    let text = format!("solid x\n{FACET}endsolid x\n");
    let message = |bytes: Vec<u8>| read_bytes(Format::Stl, bytes).unwrap_err().to_string();
    for (input, line) in [
        (format!("/* made by foo */\n{text}"), "line 1"),
        (format!("\u{feff}# a comment\n\n{}", text.replacen("solid x\n", "", 1)), "line 3"),
        (text.replacen("solid", "sloid", 1) + "\u{1a}", "line 1"),
        ("not a mesh".into(), "line 1"),
    ] {
        let said = message(input.clone().into_bytes());
        assert!(said.contains(line), "{input}: {said}");
        assert!(said.contains("text STL must begin with `solid`, found `"), "{input}: {said}");
    }
    let said = message(b"# a comment\n\n".to_vec());
    assert!(said.contains("text without the line `solid`"), "{said}");
    for more in ["0123456789", "\nsolid y\n", "x\r\n\0"] {
        let said = message(format!("{text}\u{1a}{more}").into_bytes());
        let count = more.trim_end_matches(['\0', '\r', '\n']).len();
        let told = format!("{count} bytes follow Ctrl-Z, which ends the text; delete them");
        assert!(said.contains(&told), "{said}");
    }
}

#[test]
fn text_stl_errors_report_the_line() {
    let broken = |from: &str, to: &str| {
        error_place(Format::Stl, format!("solid x\n{FACET}endsolid").replace(from, to))
    };
    assert_eq!(broken("vertex 1 0 0", "vertex 1 0"), Place::Line(5));
    assert_eq!(broken("vertex 1 0 0", "vertex 1 zero 0"), Place::Line(5));
    assert_eq!(broken(" vertex 1 0 0\n", ""), Place::Line(6));
    assert_eq!(broken(" endloop\n  endfacet\nendsolid", ""), Place::End);
    assert_eq!(broken(" endloop\n", ""), Place::Line(7));
    assert_eq!(broken("  facet", "  faect"), Place::Line(2));
}

#[test]
fn obj_keeps_order_polygons_and_negative_indices() {
    let text = "# a comment\nmtllib none.mtl\no first\nv 9 9 9 # not used\nv 0 0 0 nan nan nan\n\
        vt 0 0\nvn 0 0 1\nv 2 0 0 2\nv 1 \\\n 1 0\nv 0 1 0\n\
        f 5/1/1 4//1 3/1 2\ng second\nusemtl steel\nl 2 3 4\nf -4 -3 -2\n";
    let mesh = read_bytes(Format::Obj, text).unwrap();
    assert_eq!(mesh.vertices.len(), 5);
    assert_eq!(mesh.vertices[2], DVec3::X, "a weight of 2 halves the coordinates");
    assert_eq!(mesh.vertices[3], DVec3::new(1.0, 1.0, 0.0), "a continued line");
    assert_eq!(mesh.faces, [vec![4, 3, 2, 1], vec![1, 2, 3]]);
    let points = read_bytes(Format::Obj, "v 0 0 0\nv 1 0 0\n").unwrap();
    assert_eq!((points.vertices.len(), points.faces.len()), (2, 0));
    assert_eq!(read_bytes(Format::Obj, "# nothing\n").unwrap(), Mesh::default());
    assert!(read_bytes(Format::Obj, "").unwrap_err().to_string().contains("the file is empty"));
}

#[test]
fn obj_errors_report_the_line() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let with = |line: &str| error_place(Format::Obj, format!("{vertices}{line}\nf 1 2 3\n"));
    assert_eq!(with("v 1 2"), Place::Line(4));
    assert_eq!(with("v 1 2 x"), Place::Line(4));
    assert_eq!(with("v 1 2 3 0"), Place::Line(4));
    assert_eq!(with("f 1 2 x"), Place::Line(4));
    assert_eq!(with("f 1 2 4"), Place::Line(4));
    assert_eq!(with("f 1 2 0"), Place::Line(4));
    assert_eq!(with("f 1 2 -4"), Place::Line(4));
    assert_eq!(with("f 1 2 99999999999999999999999"), Place::Line(4));
    assert_eq!(with("f 1 2 -9223372036854775808"), Place::Line(4));
}

#[test]
fn off_accepts_header_variants() {
    let body = "0 0 0\n1 0 0 0.5 0.5 0.5 1\n\n# between\n0 1 0 # after\n3 0 1 2 255 0 0\n";
    for header in ["OFF\n3 1 3\n", "  COFF 3 1 0 # c\n", "OFF3 1 0\n", "# first\n\nSTOFF\n#\n3 1\n"]
    {
        let mesh = read_bytes(Format::Off, format!("{header}{body}")).unwrap();
        assert_eq!(mesh.vertices, [DVec3::ZERO, DVec3::X, DVec3::Y], "{header}");
        assert_eq!(mesh.faces, [[0, 1, 2]]);
    }
}

#[test]
fn off_errors_report_the_line() {
    let vertices = "0 0 0\n1 0 0\n0 1 0\n";
    assert_eq!(error_place(Format::Off, ""), Place::End);
    assert_eq!(error_place(Format::Off, "# only\n"), Place::End);
    assert_eq!(error_place(Format::Off, format!("FOO\n3 1 0\n{vertices}3 0 1 2")), Place::Line(1));
    assert_eq!(error_place(Format::Off, format!("4OFF\n3 1 0\n{vertices}3 0 1 2")), Place::Line(1));
    assert_eq!(error_place(Format::Off, "OFF BINARY\n"), Place::Line(1));
    assert_eq!(error_place(Format::Off, format!("OFF\n3 x 0\n{vertices}")), Place::Line(2));
    assert_eq!(
        error_place(Format::Off, format!("OFF\n4000000000 1 0\n{vertices}")),
        Place::Line(2)
    );
    assert_eq!(error_place(Format::Off, format!("OFF\n4 1 0\n{vertices}")), Place::End);
    assert_eq!(
        error_place(Format::Off, format!("OFF\n3 1 0\n{vertices}3 0 1 3\n")),
        Place::Line(6)
    );
    assert_eq!(error_place(Format::Off, format!("OFF\n3 1 0\n{vertices}3 0 1\n")), Place::Line(6));
    assert_eq!(
        error_place(Format::Off, format!("OFF\n3 1 0\n{vertices}3 0 1 -1\n")),
        Place::Line(6)
    );
    assert_eq!(
        error_place(Format::Off, format!("OFF\n3 1 0\n{vertices}99999999999999 0 1 2\n")),
        Place::Line(6)
    );
}

const PLY: &str = "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 3\nproperty double x\n\
    property double y\nproperty double z\nproperty uchar red\nelement face 1\n\
    property list uchar int vertex_indices\nproperty float quality\nend_header\n\
    0.1 0 0 1\n1 0 0 2\n0 1e-17 0 3\n3 0 1 2 0.5\n";

/// Returns the same file in binary, in either byte order.
fn binary_ply(little: bool) -> Vec<u8> {
    let header = PLY.split_inclusive("end_header\n").next().unwrap();
    let format = if little { "binary_little_endian" } else { "binary_big_endian" };
    let mut bytes = header.replace("ascii", format).into_bytes();
    let double = |v: f64| if little { v.to_le_bytes() } else { v.to_be_bytes() };
    for vertex in [[0.1, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1e-17, 0.0]] {
        for c in vertex {
            bytes.extend(double(c));
        }
        bytes.push(7);
    }
    bytes.push(3);
    for index in 0..3_i32 {
        bytes.extend(if little { index.to_le_bytes() } else { index.to_be_bytes() });
    }
    bytes.extend(0.5_f32.to_bits().to_le_bytes());
    bytes
}

#[test]
fn ply_is_read_in_all_three_encodings() {
    for bytes in [PLY.as_bytes().to_vec(), binary_ply(true), binary_ply(false)] {
        let mesh = read_bytes(Format::Ply, bytes).unwrap();
        assert_eq!(mesh.vertices[0], DVec3::new(0.1, 0.0, 0.0));
        assert_eq!(mesh.vertices[2], DVec3::new(0.0, 1e-17, 0.0));
        assert_eq!(mesh.faces, [[0, 1, 2]]);
    }
}

#[test]
fn ply_comments_may_be_in_any_encoding() {
    for bytes in [PLY.as_bytes().to_vec(), binary_ply(true), binary_ply(false)] {
        let plain = read_bytes(Format::Ply, &bytes).unwrap();
        for line in [
            &b"comment Geh\xe4use\n"[..],
            b"obj_info \xff\xfe\x80\n",
            "comment Gehäuse\n".as_bytes(),
        ] {
            let at = bytes.windows(7).position(|window| window == b"element").unwrap();
            let told = [&bytes[..at], line, &bytes[at..]].concat();
            let mesh = read_bytes(Format::Ply, told).unwrap();
            assert_eq!((mesh.vertices, mesh.faces), (plain.vertices.clone(), plain.faces.clone()));
        }
    }
}

#[test]
fn broken_ply_files_report_line_and_reason() {
    let good = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    assert!(read_bytes(Format::Ply, good).is_ok());
    let types = "char, uchar, short, ushort, int, uint, float, double";
    for (from, to, told) in [
        ("ply\n", "plx\n", "line 1: the first line of a PLY file must be `ply`, found `plx`"),
        (
            "element face",
            "elephant face",
            "line 7: unknown keyword `elephant`; accepted: \
            format, comment, obj_info, element, property, end_header",
        ),
        ("float y", "flot y", &format!("line 5: unknown type `flot`; accepted: {types}")),
        (
            "uchar int",
            "uchar integer",
            &format!("line 8: unknown type `integer`; accepted: {types}"),
        ),
        (
            "float z",
            "float",
            "line 6: expected the type and the name of a property, as in `property float \
            x` or `property list uchar int vertex_indices`",
        ),
        ("vertex 3", "vertex three", "line 3: `three` is not a valid number of elements `vertex`"),
        ("element vertex 3\n", "", "line 3: `property` before the first `element`"),
        (
            "end_header\n",
            "",
            "line 9: a row of numbers in the header; `end_header` is missing \
            before it",
        ),
        (
            "ascii 1.0",
            "asci 1.0",
            "line 2: unknown format `asci`; accepted: ascii, binary_little_endian, \
            binary_big_endian",
        ),
        (
            "ascii 1.0",
            "ascii",
            "line 2: expected the name of a format and its version, as in `format ascii \
            1.0`",
        ),
        ("format ascii 1.0\n", "", "line 8: the header has no line `format`"),
        ("\n1 0 0", "\n1 zero 0", "line 11: `zero` is not a number"),
        ("\n0 1 0", "\n0 1", "line 12: the line ends before the number of `z`"),
        ("3 0 1 2", "3 0 one 2", "line 13: `one` is not an integer from -2147483648 to 2147483647"),
        ("3 0 1 2", "-3 0 1 2", "line 13: `-3` is not an integer from 0 to 255"),
        (
            "3 0 1 2",
            "30 0 1 2",
            "line 13: the line ends before number 4 of the 30 of `vertex_indices`",
        ),
    ] {
        let text = good.replacen(from, to, 1);
        for end in ["\n", "\r\n", "\r"] {
            let error = read_bytes(Format::Ply, text.replace('\n', end)).unwrap_err().to_string();
            assert_eq!(error, format!("part: {told}"), "{end:?}");
        }
    }
    for cut in [5, 40, 60, 100] {
        let error = read_bytes(Format::Ply, &good[..cut]).unwrap_err().to_string();
        assert!(error.starts_with("part: line ") && !error.contains("Couldn't"), "{error}");
    }
    let error =
        read_bytes(Format::Ply, &good[..good.find("property float z").unwrap()]).unwrap_err();
    let told = "part: line 6: the file ends within the header, before `end_header`";
    assert_eq!(error.to_string(), told);
}

#[test]
fn ply_errors_report_the_place() {
    assert_eq!(error_place(Format::Ply, ""), Place::End);
    assert_eq!(error_place(Format::Ply, "ply\n"), Place::Line(2));
    assert_eq!(error_place(Format::Ply, PLY.replace("property double y\n", "")), Place::Header);
    let list = PLY.replace("property double y\n", "property list uchar double y\n");
    assert_eq!(error_place(Format::Ply, list), Place::Header);
    let float = PLY.replace("list uchar int vertex_ind", "list uchar float vertex_ind");
    assert_ne!(float, PLY);
    assert_eq!(error_place(Format::Ply, float), Place::Header);
    assert_eq!(
        error_place(Format::Ply, PLY.replace("vertex 3", "vertex 999999999999")),
        Place::Header
    );
    assert_eq!(error_place(Format::Ply, PLY.replace("1 0 0 2", "1 0 zero 2")), Place::Line(14));
    assert_eq!(error_place(Format::Ply, PLY.replace("3 0 1 2 0.5", "3 0 1 3 0.5")), Place::Face(0));
    assert_eq!(
        error_place(Format::Ply, PLY.replace("3 0 1 2 0.5", "3 0 1 -2 0.5")),
        Place::Face(0)
    );
    assert_eq!(
        error_place(Format::Ply, PLY.replace("3 0 1 2 0.5", "250 0 1 2 0.5")),
        Place::Line(16)
    );
    let binary = binary_ply(true);
    assert_eq!(error_place(Format::Ply, &binary[..binary.len() - 1]), Place::End);
    let empty = "ply\nformat binary_little_endian 1.0\nelement nothing 99999999999\nend_header\n";
    assert_eq!(error_place(Format::Ply, empty), Place::Header);
}

#[test]
fn extension_selects_the_format() {
    assert_eq!(Format::from_path(Path::new("a.b/PART.Stl")).unwrap(), Format::Stl);
    assert_eq!(Format::list_names("or"), "STL, OBJ, PLY, OFF or DAE");
    for path in ["part.step", "part", "stl"] {
        let message = colltrans_mesh::read(path).unwrap_err().to_string();
        assert!(message.contains(path) && message.contains("stl, obj, ply, off, dae"), "{message}");
    }
    let message = colltrans_mesh::read("not/there.obj").unwrap_err().to_string();
    assert!(message.starts_with("not/there.obj: cannot be read"), "{message}");
}

/// No prefix and no single changed byte of a file causes a panic in a reader.
#[test]
fn mutilated_files_do_not_panic() {
    let files = [
        (Format::Stl, to_stl(&tetrahedron()).unwrap()),
        (Format::Stl, format!("solid x\n{FACET}endsolid").into_bytes()),
        (Format::Obj, to_obj(&tetrahedron()).into_bytes()),
        (Format::Off, to_off(&tetrahedron()).into_bytes()),
        (Format::Ply, PLY.as_bytes().to_vec()),
        (Format::Ply, binary_ply(true)),
        (Format::Ply, binary_ply(false)),
    ];
    for (format, bytes) in files {
        for end in 0..bytes.len() {
            let _ = read_bytes(format, &bytes[..end]);
            for change in [0, 0xff, b'9', b'-', b'\n'] {
                let mut changed = bytes.clone();
                changed[end] = change;
                if let Ok(mesh) = read_bytes(format, changed) {
                    let count = mesh.vertices.len();
                    assert!(mesh.faces.iter().flatten().all(|&v| (v as usize) < count));
                }
            }
        }
    }
}

/// Returns the names of the groups with the number of their faces.
fn group_counts(mesh: &Mesh) -> Vec<(&str, usize)> {
    let Groups { names, of_face } = &mesh.groups;
    assert!(of_face.is_empty() || of_face.len() == mesh.faces.len());
    let count = |k: usize| of_face.iter().filter(|&&g| g as usize == k).count();
    names.iter().enumerate().map(|(k, name)| (name.as_str(), count(k))).collect()
}

#[test]
fn obj_objects_and_groups_are_returned() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    let cases: [(&str, &[(&str, usize)]); 7] = [
        ("f 1 2 3\nf 1 3 4\n", &[]),
        ("o a b\nf 1 2 3\ng x\nf 1 3 4\no c\ng\nf 2 3 4\n", &[("a b", 2), ("c", 1)]),
        // Groups of a single object, and a group that is continued later.
        ("o a\ng x\nf 1 2 3\ng y\nf 1 3 4\nf 1 2\nf 1\ng x\nf 2 3 4\n", &[("x", 2), ("y", 1)]),
        // Objects without faces, and faces before the first name.
        ("f 1 2 3\no none\no a\nf 1 3 4\no last\n", &[("", 1), ("a", 1)]),
        ("o a\nf 1 2 3\no a\nf 1 3 4\n", &[]),
        // A face without area is removed.
        ("o a\nf 1 2 1\nf 1 2 3\no b\nf 2 2 3\nf 1 3 4\n", &[("a", 1), ("b", 1)]),
        ("o a # not b\nf 1 2 3\no c\nf 1 3 \\\n4\n", &[("a", 1), ("c", 1)]),
    ];
    for (text, wanted) in cases {
        let mesh = read_bytes(Format::Obj, format!("{vertices}{text}")).unwrap();
        assert_eq!(group_counts(&mesh), wanted, "{text}");
    }
}

#[test]
fn stl_solids_are_returned_as_groups() {
    let facet = "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    let text = format!(
        "solid a 1\n{facet}endsolid a 1\nSOLID\n{facet}{facet}endsolid\nsolid x\nendsolid x\nsolid a 1\n{facet}endsolid\n"
    );
    let mesh = read_bytes(Format::Stl, text).unwrap();
    assert_eq!(group_counts(&mesh), [("a 1", 1), ("", 2), ("a 1", 1)]);
    let mesh = read_bytes(Format::Stl, format!("solid a\n{facet}endsolid a\n")).unwrap();
    assert_eq!(group_counts(&mesh), []);
}

/// Returns a COLLADA file of a square pyramid (five corners), placed by these nodes.
fn dae_text(asset: &str, faces: &str, nodes: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">\n\
         <asset>{asset}</asset>\n<library_geometries><geometry id=\"g\"><mesh>\n\
         <source id=\"p\"><float_array id=\"a\" count=\"15\">0 0 0 1 0 0 1 1 0 0 1 0\n.5 .5 1e0</float_array>\n\
         <technique_common><accessor source=\"#a\" count=\"5\" stride=\"3\"><param name=\"X\"/><param name=\"Y\"/>\
         <param name=\"Z\"/></accessor></technique_common></source>\n\
         <vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>\n{faces}\n</mesh></geometry></library_geometries>\n\
         <library_nodes><node id=\"n\"><instance_geometry url=\"#g\"/></node></library_nodes>\n\
         <library_visual_scenes><visual_scene id=\"s\">{nodes}</visual_scene></library_visual_scenes>\n\
         <scene><instance_visual_scene url=\"#s\"/></scene>\n</COLLADA>\n"
    )
}

const VERTEX: &str = "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>";

/// Returns all five faces, in two kinds of elements, with indices for normals in addition to those for
/// vertices.
fn pyramid_faces() -> String {
    let normal = "<input semantic=\"NORMAL\" source=\"#p\" offset=\"1\"/>";
    format!(
        "<polylist count=\"2\">{VERTEX}{normal}<vcount>4 3</vcount><p>3 0 2 0 1 0 0 0 0 1 1 1 4 1</p></polylist>\
         <triangles count=\"2\">{VERTEX}<p>1 2 4 2 3 4</p></triangles>\
         <polygons count=\"1\">{VERTEX}<p>3 0 4</p></polygons><lines count=\"1\">{VERTEX}<p>0 1</p></lines>"
    )
}

#[test]
fn collada_nodes_are_placed_and_named() {
    let nodes = "<node name=\"a\"><instance_geometry url=\"#g\"/></node>\
        <node id=\"b\"><translate>0 0 5</translate><rotate>0 0 1 90</rotate><scale>2 2 2</scale>\
        <node name=\"c\"><matrix>1 0 0 3 0 1 0 0 0 0 -1 0 0 0 0 1</matrix><instance_node url=\"#n\"/></node></node>";
    let asset = "<unit name=\"centimeter\" meter=\"0.01\"/><up_axis>Z_UP</up_axis>";
    let mesh = read_bytes(Format::Dae, dae_text(asset, &pyramid_faces(), nodes)).unwrap();
    assert_eq!(
        mesh.faces[..5],
        [vec![3, 2, 1, 0], vec![0, 1, 4], vec![1, 2, 4], vec![2, 3, 4], vec![3, 0, 4]]
    );
    assert_eq!((mesh.unit, mesh.up), (Some(0.01), Some(DVec3::Z)));
    assert_eq!(group_counts(&mesh), [("a", 5), ("n", 5)]);
    assert!(mesh.open_edges().is_empty());
    // Mirrored twice, and scaled by 2.
    assert!((mesh.signed_volume() - 3.0).abs() < 1e-12);
    let [_, apex] = [4, 9].map(|k| mesh.vertices[k]);
    // (.5 + 3, .5, -1), scaled by 2, rotated to (-1, 7), raised by 5.
    assert!((apex - DVec3::new(-1.0, 7.0, 3.0)).length() < 1e-12, "{apex}");
    let bare = read_bytes(
        Format::Dae,
        dae_text("", &pyramid_faces(), "<node><instance_geometry url=\"#g\"/></node>"),
    )
    .unwrap();
    assert_eq!((bare.unit, bare.up, group_counts(&bare)), (Some(1.0), Some(DVec3::Y), vec![]));
}

#[test]
fn collada_strips_and_fans_are_read() {
    let faces = format!(
        "<trifans count=\"1\">{VERTEX}<p>4 0 1 2 3 0</p></trifans><tristrips count=\"1\">{VERTEX}<p>3 2 0 1</p></tristrips>"
    );
    let mesh = read_bytes(
        Format::Dae,
        dae_text("", &faces, "<node><instance_geometry url=\"#g\"/></node>"),
    )
    .unwrap();
    assert_eq!(mesh.faces.len(), 6);
    assert!(mesh.open_edges().is_empty());
    assert!((mesh.signed_volume() - 1.0 / 3.0).abs() < 1e-12);
}

#[test]
fn invalid_collada_reports_the_reason() {
    let node = "<node><instance_geometry url=\"#g\"/></node>";
    let list = |what: &str| dae_text("", what, node);
    let triangles =
        |p: &str| list(&format!("<triangles count=\"1\">{VERTEX}<p>{p}</p></triangles>"));
    let ring = "<node id=\"r\"><instance_node url=\"#r\"/></node>";
    let twice = |k: u32| {
        let next = format!("<instance_node url=\"#d{}\"/>", k + 1);
        format!("<node id=\"d{k}\">{next}{next}</node>")
    };
    let doubling = (0..20).map(twice).collect::<Vec<String>>().concat();
    let cases = [
        (triangles("0 1"), "2 corners are not a multiple of 3"),
        (triangles("0 1 5"), "vertex index 5 is out of range"),
        (triangles("0 1 x"), "`x` in <p>"),
        (triangles("0 1 -2"), "`-2` in <p>"),
        (triangles("0 1 2 2 3 0"), "count is 1, but there are 2 faces"),
        (list("<triangles count=\"0\"><p/></triangles>"), "no input VERTEX"),
        (list(&format!("<polylist count=\"1\">{VERTEX}<p>0 1 2</p></polylist>")), "no vcount"),
        (
            list(&format!(
                "<polylist count=\"1\">{VERTEX}<vcount>4</vcount><p>0 1 2</p></polylist>"
            )),
            "more corners",
        ),
        (list(&format!("<polygons count=\"1\">{VERTEX}<ph><p>0 1 2</p></ph></polygons>")), "holes"),
        (
            list(&pyramid_faces()).replace("count=\"5\"", "count=\"6\""),
            "extend beyond the 15 numbers",
        ),
        (
            list(&pyramid_faces()).replace("count=\"5\"", "count=\"99999999999999999999\""),
            "expected a non-negative integer",
        ),
        (list(&pyramid_faces()).replace("url=\"#g\"", "url=\"#h\""), "unknown id `#h`"),
        (list(&pyramid_faces()).replace("url=\"#g\"", "url=\"b.dae#g\""), "refers to another file"),
        (dae_text("<unit meter=\"0\"/>", &pyramid_faces(), node), "invalid unit"),
        (dae_text("<up_axis>W</up_axis>", &pyramid_faces(), node), "unknown axis `W`"),
        (
            dae_text("", &pyramid_faces(), "<node><lookat>0 0 0 1 1 1 0 0 1</lookat></node>"),
            "<lookat> is not supported",
        ),
        (
            dae_text("", &pyramid_faces(), "<node><scale>1 2</scale></node>"),
            "<scale> has 2 numbers, expected 3",
        ),
        (dae_text("", &pyramid_faces(), ring), "form a cycle"),
        (
            dae_text("", &pyramid_faces(), &format!("{doubling}<node id=\"d20\"/>")),
            "more than 65536",
        ),
        ("<?xml version=\"1.0\"?><COLLADA><a></b></COLLADA>".into(), ""),
        ("<?xml version=\"1.0\"?><COLLADA>".into(), "not closed"),
        ("<?xml version=\"1.0\"?><COLLADA/>".into(), "no scene"),
    ];
    for (text, wanted) in cases {
        let error = read_bytes(Format::Dae, &text).unwrap_err();
        assert!(matches!(error, Error::Syntax { .. }), "{error}");
        assert!(error.to_string().contains(wanted), "{error}, not {wanted}");
    }
    let other = read_bytes(Format::Dae, "<?xml version=\"1.0\"?><robot/>").unwrap_err().to_string();
    assert_eq!(
        other,
        "part: contains an XML file, but its extension stands for DAE; rename or convert the file"
    );
    // Each prefix of a file is read, or rejected with an error.
    let whole = dae_text("<unit meter=\"1\"/>", &pyramid_faces(), node);
    for end in 0..whole.len() {
        if let Ok(mesh) = read_bytes(Format::Dae, &whole[..end]) {
            assert_eq!(mesh.faces.len(), 5, "{end}");
        }
    }
}

#[test]
fn overflowing_collada_strides_are_rejected() {
    let nodes = "<node><instance_geometry url=\"#g\"/></node>";
    let file = dae_text("", &pyramid_faces(), nodes);
    assert!(read_bytes(Format::Dae, &file).is_ok());
    let largest = usize::MAX.to_string();
    let accessor = &file[file.find("<accessor").unwrap()..];
    let accessor = &accessor[..=accessor.find('>').unwrap()];
    let source = accessor.split('"').find(|word| word.starts_with('#')).unwrap();
    for (count, stride, offset) in [
        ("3", &*largest, "0"),
        ("3", "9223372036854775808", "0"),
        ("2", "3", &*largest),
        (&*largest, "3", "0"),
        (&*largest, &*largest, &*largest),
        ("1", "3", "18446744073709551614"),
    ] {
        let wild = format!(
            "<accessor source=\"{source}\" count=\"{count}\" stride=\"{stride}\" offset=\"{offset}\">"
        );
        let error =
            read_bytes(Format::Dae, file.replacen(accessor, &wild, 1)).unwrap_err().to_string();
        assert!(error.contains("extend beyond"), "{error}");
    }
}
