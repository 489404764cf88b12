//! Tests files as they occur in practice: byte-order marks, line ends, misleading names, truncated files, and
//! corners with different rounding.

use std::fmt::Write as _;
use std::path::Path;

use colltrans_mesh::{Error, Format, Mesh, ReadOptions, parse, parse_with};
use colltrans_mesh::{to_obj, to_off, to_stl};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::block;
use glam::DVec3;

fn read_bytes(format: Format, bytes: impl AsRef<[u8]>) -> Result<Mesh, Error> {
    parse(format, bytes.as_ref().to_vec(), Path::new("part"))
}

fn error_message(format: Format, bytes: impl AsRef<[u8]>) -> String {
    read_bytes(format, bytes).unwrap_err().to_string()
}

/// Returns a cube of triangles or of squares.
fn unit_cube(triangles: bool) -> Mesh {
    let cube = block(DVec3::ZERO, DVec3::ONE);
    let cube = if triangles { cube.triangulated() } else { cube };
    Mesh::new(cube.vertices, cube.faces)
}

/// Returns the cube as text STL, with the corners of facets printed by `corner`.
fn text_stl(mut corner: impl FnMut(DVec3) -> String) -> String {
    let mesh = unit_cube(true);
    let mut text = String::from("solid part\n");
    for face in &mesh.faces {
        text.push_str("facet normal 0 0 0\nouter loop\n");
        for &v in face {
            let _ = writeln!(text, "vertex {}", corner(mesh.vertices[v as usize]));
        }
        text.push_str("endloop\nendfacet\n");
    }
    text + "endsolid part\n"
}

fn coordinates_text(v: DVec3) -> String {
    format!("{} {} {}", v.x, v.y, v.z)
}

fn ply_text(mesh: &Mesh) -> String {
    let (vertices, faces) = (mesh.vertices.len(), mesh.faces.len());
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty double x\nproperty double y\n\
         property double z\nelement face {faces}\nproperty list uchar int vertex_indices\n\
         end_header\n"
    );
    for v in &mesh.vertices {
        let _ = writeln!(text, "{}", coordinates_text(*v));
    }
    for face in &mesh.faces {
        let corners: Vec<String> = face.iter().map(u32::to_string).collect();
        let _ = writeln!(text, "{} {}", corners.len(), corners.join(" "));
    }
    text
}

/// Returns the cube in each text format.
fn text_files() -> [(Format, String); 4] {
    let mesh = unit_cube(false);
    [
        (Format::Stl, text_stl(coordinates_text)),
        (Format::Obj, to_obj(&mesh)),
        (Format::Off, to_off(&mesh)),
        (Format::Ply, ply_text(&mesh)),
    ]
}

#[test]
fn byte_order_marks_and_line_endings_do_not_matter() {
    for (format, text) in text_files() {
        let expected = read_bytes(format, &text).unwrap();
        assert_eq!((expected.vertices.len(), expected.open_edges().len()), (8, 0), "{format}");
        for mark in ["", "\u{feff}"] {
            for end in ["\n", "\r\n", "\r"] {
                let variant = format!("{mark}{}", text.replace('\n', end));
                let found = read_bytes(format, &variant).unwrap();
                assert_eq!(found, expected, "{format} with {mark:?} and {end:?}");
            }
        }
    }
}

#[test]
fn error_line_numbers_count_all_line_endings() {
    for (format, text) in text_files() {
        let text = text.replacen("0 1 0\n", "0 x 0\n", 1);
        let broken = text.lines().position(|l| l.ends_with("0 x 0")).unwrap() + 1;
        for end in ["\n", "\r\n", "\r"] {
            let message = error_message(format, text.replace('\n', end));
            assert!(message.starts_with(&format!("part: line {broken}: ")), "{format}: {message}");
        }
    }
}

#[test]
fn utf16_text_is_rejected() {
    for (format, text) in text_files() {
        let mut bytes = b"\xff\xfe".to_vec();
        bytes.extend(text.encode_utf16().flat_map(u16::to_le_bytes));
        let message = error_message(format, bytes);
        assert!(message.contains("UTF-16"), "{message}");
    }
}

/// In a binary PLY file the header may end in a lone CR, and the data may begin with the byte of LF.
#[test]
fn binary_ply_header_may_have_any_line_ending() {
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n\
        property float y\nproperty float z\nelement face 1\n\
        property list uchar uchar vertex_indices\nend_header\n";
    for end in ["\n", "\r\n", "\r"] {
        let mut bytes = header.replace('\n', end).into_bytes();
        // The first byte of the first number is LF, and CR and LF are among the others.
        let first = f32::from_le_bytes([0x0a, 0x0d, 0x0a, 0x41]);
        for c in [first, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
            bytes.extend(c.to_le_bytes());
        }
        bytes.extend([3, 0, 1, 2]);
        let mesh = read_bytes(Format::Ply, &bytes).unwrap();
        assert_eq!(mesh.vertices[0].x, f64::from(first), "{end:?}");
        assert_eq!(mesh.faces, [[0, 1, 2]]);
    }
}

#[test]
fn contents_must_match_the_extension() {
    let mesh = unit_cube(true);
    let files = [
        (Format::Stl, "a binary STL file", to_stl(&mesh).unwrap()),
        (Format::Stl, "a text STL file", text_stl(coordinates_text).into_bytes()),
        (Format::Obj, "an OBJ file", to_obj(&mesh).into_bytes()),
        (Format::Off, "an OFF file", to_off(&mesh).into_bytes()),
        (Format::Ply, "a PLY file", ply_text(&mesh).into_bytes()),
    ];
    for (is, name, bytes) in &files {
        for format in [Format::Stl, Format::Obj, Format::Off, Format::Ply] {
            if *is == format {
                assert!(read_bytes(format, bytes).is_ok(), "{name}");
            } else {
                let expected = format!(
                    "part: contains {name}, but its extension stands for {format}; rename or convert the file"
                );
                assert_eq!(error_message(format, bytes), expected);
            }
        }
    }
    for (bytes, name) in [
        (&b"PK\x03\x04........"[..], "ZIP"),
        (b"ISO-10303-21;\nHEADER;\n", "STEP"),
        (b"\n <!doctype HTML><html>", "HTML"),
        (b"\xef\xbb\xbf<?xml version=\"1.0\"?>", "XML"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "git lfs pull"),
    ] {
        for format in [Format::Stl, Format::Obj, Format::Off, Format::Ply] {
            let message = error_message(format, bytes);
            assert!(message.contains(name), "{message}");
        }
    }
}

#[test]
fn unknown_obj_keyword_is_rejected() {
    assert!(
        error_message(Format::Obj, "v 0 0 0\nV 1 0 0\n").ends_with("line 2: unknown keyword `V`")
    );
    let curved = error_message(Format::Obj, "v 0 0 0\ncstype bezier\nsurf 0 1 0 1 1\n");
    assert!(curved.contains("line 3: curved surfaces"), "{curved}");
    let junk: Vec<u8> = (0..=255).collect();
    assert!(read_bytes(Format::Obj, junk).is_err());
}

#[test]
fn size_of_binary_stl_with_solid_header_is_checked() {
    let mut bytes = to_stl(&unit_cube(true)).unwrap();
    bytes[..80].fill(b' ');
    bytes[..10].copy_from_slice(b"solid cube");
    let length = bytes.len();
    assert_eq!(read_bytes(Format::Stl, &bytes).unwrap().faces.len(), 12);
    for end in [length - 1, length - 50, length - 51, 84 + 50, 90, 84, 83, 80] {
        let message = error_message(Format::Stl, &bytes[..end]);
        let said = message.contains("truncated: 12 triangles in its header need")
            || end < 84 && message.contains("end of file");
        assert!(said, "{end}: {message}");
    }
    // Zeros, or fewer bytes than a triangle, are accepted as padding; other bytes are not.
    for padding in [vec![0; 2000], vec![b' '; 49], vec![0x1a]] {
        assert_eq!(
            read_bytes(Format::Stl, [bytes.clone(), padding].concat()).unwrap().faces.len(),
            12
        );
    }
    let more = error_message(Format::Stl, [bytes.clone(), vec![1; 50]].concat());
    assert!(more.contains("50 unexpected bytes after the 12 triangles"), "{more}");
}

#[test]
fn truncated_text_stl_is_rejected() {
    let text = text_stl(coordinates_text);
    // Each truncation is rejected, except inside the name after the last keyword.
    for end in 0..text.find("endsolid").unwrap() + "endsolid".len() {
        assert!(read_bytes(Format::Stl, &text[..end]).is_err(), "{:?}", &text[..end]);
    }
    let line = text.find("endsolid").unwrap();
    let cut = error_message(Format::Stl, &text[..line]);
    assert!(cut.contains("the last solid is not closed; the file is truncated"), "{cut}");
    let odd = error_message(Format::Stl, text.replacen("endloop\n", "", 1));
    assert!(odd.contains("line 7: `endfacet` inside a loop that is not closed"), "{odd}");
}

#[test]
fn data_after_the_last_element_is_rejected() {
    let mesh = unit_cube(true);
    let more = error_message(Format::Off, to_off(&mesh) + "\n# blank and comment\n3 0 1 2\n");
    assert!(more.contains("line 25: unexpected text after the 8 vertices and 12 faces"), "{more}");
    assert!(read_bytes(Format::Off, to_off(&mesh) + "\n\n# the end\n").is_ok());
    let more = error_message(Format::Ply, ply_text(&mesh) + "3 0 1 2\n");
    assert!(more.contains("8 unexpected bytes"), "{more}");
    assert!(read_bytes(Format::Ply, ply_text(&mesh) + "\n \n").is_ok());
}

#[test]
fn ply_faces_in_other_properties_are_rejected() {
    let text = ply_text(&unit_cube(true));
    let unnamed = error_message(Format::Ply, text.replace("vertex_indices", "corners"));
    assert!(unnamed.contains("no list `vertex_indices`"), "{unnamed}");
    let strips = error_message(Format::Ply, text.replace("element face", "element tristrips"));
    assert!(strips.contains("triangle strips"), "{strips}");
    for list in ["list float int", "list uchar float"] {
        let odd = error_message(Format::Ply, text.replace("list uchar int", list));
        assert!(odd.contains("must be a list of integers"), "{odd}");
    }
}

/// Zeros with rounding errors, as in computed corners.
#[test]
fn duplicate_vertices_are_merged_and_counted() {
    let mut written = 0;
    let text = text_stl(|v| {
        written += 1;
        let x = if v.x == 0.0 && written % 2 == 0 { 5e-17 } else { v.x };
        coordinates_text(DVec3::new(x, v.y, v.z))
    });
    let mesh = read_bytes(Format::Stl, &text).unwrap();
    assert_eq!((mesh.vertices.len(), mesh.faces.len(), mesh.open_edges().len()), (8, 12, 0));
    assert_eq!(mesh.merged.vertices, 4);
    assert_eq!(mesh.merged.largest_distance, 5e-17);
    assert_eq!((mesh.merged.ambiguous, mesh.merged.dropped_faces), (0, 0));

    let equal_only = ReadOptions::default().with_merge_tolerance(Some(0.0));
    let open = parse_with(Format::Stl, text.into(), Path::new("part"), equal_only).unwrap();
    assert_eq!((open.vertices.len(), open.merged.vertices), (12, 0));
    assert!(!open.open_edges().is_empty());
}

/// In formats with numbered vertices the numbers remain, so that answers refer to those of the file.
#[test]
fn numbered_vertices_keep_their_indices() {
    let square = unit_cube(false);
    let mut soup = Mesh::default();
    for face in &square.faces {
        let first = soup.vertices.len() as u32;
        soup.vertices.extend(face.iter().map(|&v| square.vertices[v as usize]));
        soup.faces.push((first..first + 4).collect());
    }
    soup.vertices[9].z += 1e-16;
    for (format, text) in
        [(Format::Obj, to_obj(&soup)), (Format::Off, to_off(&soup)), (Format::Ply, ply_text(&soup))]
    {
        let mesh = read_bytes(format, text).unwrap();
        assert_eq!(mesh.vertices, soup.vertices, "{format}");
        assert_eq!(mesh.open_edges().len(), 0, "{format}");
        assert_eq!(mesh.faces[0], soup.faces[0], "the first are the ones that stay");
        let mut used: Vec<u32> = mesh.faces.concat();
        used.sort_unstable();
        used.dedup();
        assert_eq!(used.len(), 8);
        assert_eq!(mesh.merged.vertices, 1, "equal ones are not counted");
    }
}

#[test]
fn slivers_between_duplicates_are_removed_and_counted() {
    // A tetrahedron with a doubled edge 0-1: between the two copies is a sliver 0 1 4, open at one side.
    let (a, b, c, d) = (DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z);
    let twin = DVec3::new(1.0, 1e-16, 0.0);
    let faces = vec![vec![0, 2, 1], vec![0, 4, 3], vec![0, 1, 4], vec![1, 2, 3], vec![0, 3, 2]];
    let mesh = read_bytes(Format::Off, to_off(&Mesh::new(vec![a, b, c, d, twin], faces))).unwrap();
    assert_eq!((mesh.faces.len(), mesh.open_edges().len()), (4, 0));
    assert_eq!((mesh.merged.vertices, mesh.merged.dropped_faces), (1, 1));
}

#[test]
fn default_tolerance_follows_the_number_precision() {
    // The distance is one unit in the last place of single precision.
    let ulp = f64::from(f32::EPSILON);
    let mut written = 0;
    let mut shifted = |v: DVec3| {
        written += usize::from(v == DVec3::ONE);
        if v == DVec3::ONE && written % 2 == 0 { v + ulp } else { v }
    };
    let mesh = unit_cube(true);
    let mut soup = Mesh::default();
    for face in &mesh.faces {
        let first = soup.vertices.len() as u32;
        soup.vertices.extend(face.iter().map(|&v| shifted(mesh.vertices[v as usize])));
        soup.faces.push((first..first + 3).collect());
    }
    let closed = |mesh: Result<Mesh, Error>| mesh.unwrap().open_edges().is_empty();
    assert!(closed(read_bytes(Format::Stl, to_stl(&soup).unwrap())), "binary STL is single");
    assert!(!closed(read_bytes(Format::Off, to_off(&soup))), "text may hold doubles");
    assert!(!closed(read_bytes(Format::Ply, ply_text(&soup))), "these are doubles");
    assert!(
        closed(read_bytes(Format::Ply, ply_text(&soup).replace("double", "float"))),
        "these are not"
    );
    let asked = ReadOptions::default().with_merge_tolerance(Some(1e-6));
    let path = Path::new("part");
    assert!(closed(parse_with(Format::Off, to_off(&soup).into(), path, asked)));
    for wrong in [-1.0, f64::NAN, f64::INFINITY] {
        let asked = ReadOptions::default().with_merge_tolerance(Some(wrong));
        let refused = parse_with(Format::Off, to_off(&soup).into(), path, asked);
        assert!(matches!(refused, Err(Error::MergeTolerance { .. })));
    }
}

/// Returns a torus of separate triangles, with random rounding of each corner of each triangle.
fn triangle_torus(around: usize, along: usize) -> Mesh {
    let angle = |i: usize, n: usize| std::f64::consts::TAU * (i % n) as f64 / n as f64;
    let at = |i: usize, j: usize| {
        let (sin_i, cos_i) = angle(i, around).sin_cos();
        let (sin_j, cos_j) = angle(j, along).sin_cos();
        DVec3::new((3.0 + cos_j) * cos_i, (3.0 + cos_j) * sin_i, sin_j)
    };
    let mut random = Random::new(7);
    let mut rounded = |x: f64| {
        let x = x as f32;
        f64::from(if random.one_in(2) { x.next_up() } else { x })
    };
    let mut soup = Mesh::default();
    for i in 0..around {
        for j in 0..along {
            let square = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            for corners in [[0, 1, 2], [0, 2, 3]] {
                let first = soup.vertices.len() as u32;
                soup.faces.push((first..first + 3).collect());
                for c in corners {
                    let corner = square[c].to_array().map(&mut rounded);
                    soup.vertices.push(DVec3::from_array(corner));
                }
            }
        }
    }
    soup
}

#[test]
fn million_facets_are_merged() {
    let (around, along) = (1000, 500);
    let bytes = to_stl(&triangle_torus(around, along)).unwrap();
    let mesh = read_bytes(Format::Stl, bytes).unwrap();
    assert_eq!((mesh.vertices.len(), mesh.faces.len()), (around * along, 2 * around * along));
    assert!(mesh.open_edges().is_empty());
    assert_eq!((mesh.merged.ambiguous, mesh.merged.dropped_faces), (0, 0));
}

/// Checks the invariants of a mesh: indices are valid, and faces are cycles of at least three corners.
fn assert_valid(mesh: &Mesh) {
    let count = mesh.vertices.len();
    for face in &mesh.faces {
        assert!(face.len() >= 3, "{face:?}");
        assert!(face.iter().all(|&v| (v as usize) < count), "{face:?} of {count}");
        assert!(face.iter().zip(face.iter().cycle().skip(1)).all(|(a, b)| a != b), "{face:?}");
    }
    let merged = mesh.merged;
    assert!(merged.largest_distance <= merged.tolerance, "{merged:?}");
}

/// Parts of files are cut out, duplicated, moved and overwritten. The result must be a valid mesh or an error.
#[test]
fn mangled_files_give_valid_meshes_or_errors() {
    let mut files: Vec<(Format, Vec<u8>)> =
        text_files().into_iter().map(|(format, text)| (format, text.into_bytes())).collect();
    files.push((Format::Stl, to_stl(&unit_cube(true)).unwrap()));
    let mut random = Random::new(11);
    let mut random = |below: usize| random.index(below);
    let pieces: [&[u8]; 10] =
        [b"\r", b"\n", b" 0 ", b"-1", b"1e300", b"nan", b"\xef\xbb\xbf", b"\0", b"#", b"\\\n"];
    let mut read_well = 0;
    for round in 0..40_000 {
        let (format, original) = &files[round % files.len()];
        let mut bytes = original.clone();
        for _ in 0..=random(3) {
            let start = random(bytes.len());
            let end = start + random((bytes.len() - start).min(40));
            match random(4) {
                0 => drop(bytes.drain(start..end)),
                1 => {
                    let piece = bytes[start..end].to_vec();
                    let at = random(bytes.len());
                    bytes.splice(at..at, piece);
                }
                2 => drop(bytes.splice(start..end, pieces[random(10)].iter().copied())),
                _ => bytes[start] = random(256) as u8,
            }
        }
        if let Ok(mesh) = read_bytes(*format, &bytes) {
            assert_valid(&mesh);
            read_well += 1;
        }
    }
    assert!((1000..39_000).contains(&read_well), "{read_well}");
}

#[test]
fn empty_files_report_that_they_are_empty() {
    for (format, _) in text_files() {
        assert!(error_message(format, Vec::new()).ends_with("end of file: the file is empty"));
    }
    let header = error_message(Format::Ply, b"ply\nformat ascii 1.0\nend_header\n");
    assert!(header.ends_with("header: the element `vertex` is missing"), "{header}");
}
