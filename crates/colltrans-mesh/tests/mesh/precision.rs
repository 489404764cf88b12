//! Tests the default tolerances: their dependencies, and that they follow the printed digits of a text.

use std::fmt::Write as _;
use std::path::Path;

use colltrans::Pose;
use colltrans::glam::{DQuat, DVec3};
use colltrans::solid::StartOverlap;
use colltrans_mesh::body::{BodyOptions, Note, cast_between, convex, solid};
use colltrans_mesh::{Format, Mesh, NumberFormat, parse};
use colltrans_testkit::random::Random;

/// Returns the prism over a counter-clockwise polygon in the xy plane, between two heights.
fn prism(outline: &[[f64; 2]], [low, high]: [f64; 2]) -> Mesh {
    let n = outline.len() as u32;
    let at = |z: f64| outline.iter().map(move |[x, y]| DVec3::new(*x, *y, z));
    let mut faces = vec![(0..n).rev().collect(), (n..2 * n).collect()];
    faces.extend((0..n).map(|i| vec![i, (i + 1) % n, (i + 1) % n + n, i + n]));
    Mesh::new(at(low).chain(at(high)).collect(), faces)
}

/// Returns a frame with the polygon as its hole and an outer boundary of twice the size.
fn polygon_frame(outline: &[[f64; 2]], [low, high]: [f64; 2]) -> Mesh {
    let n = outline.len() as u32;
    let ring = |z: f64, by: f64| outline.iter().map(move |[x, y]| DVec3::new(x * by, y * by, z));
    let rings = [(low, 1.0), (high, 1.0), (low, 2.0), (high, 2.0)];
    let vertices = rings.into_iter().flat_map(|(z, by)| ring(z, by)).collect();
    let mut faces = Vec::new();
    for i in 0..n {
        let j = (i + 1) % n;
        let [inner, top, outer, above] = [0, n, 2 * n, 3 * n].map(|ring| [ring + i, ring + j]);
        for [a, b] in [[top, inner], [above, top], [outer, above], [inner, outer]] {
            faces.push(vec![a[0], a[1], b[1], b[0]]);
        }
    }
    let mut mesh = Mesh::new(vertices, faces);
    if mesh.signed_volume() < 0.0 {
        mesh.faces.iter_mut().for_each(|face| face.reverse());
    }
    mesh
}

fn transformed(mut mesh: Mesh, by: impl Fn(DVec3) -> DVec3) -> Mesh {
    mesh.vertices.iter_mut().for_each(|v| *v = by(*v));
    mesh
}

/// Writes a mesh in a format, with coordinates printed by `print`, and reads it again.
fn write_and_read(mesh: &Mesh, format: Format, print: &dyn Fn(f64) -> String) -> Mesh {
    let row = |v: DVec3| v.to_array().map(print).join(" ");
    let mut text = String::new();
    match format {
        Format::Obj => {
            mesh.vertices.iter().for_each(|v| writeln!(text, "v {}", row(*v)).unwrap());
            for face in &mesh.faces {
                let corners: Vec<String> = face.iter().map(|v| (v + 1).to_string()).collect();
                writeln!(text, "f {}", corners.join(" ")).unwrap();
            }
        }
        Format::Off | Format::Ply => {
            let (vertices, faces) = (mesh.vertices.len(), mesh.faces.len());
            text = match format {
                Format::Off => format!("OFF\n{vertices} {faces} 0\n"),
                _ => format!(
                    "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty double x\n\
                     property double y\nproperty double z\nelement face {faces}\n\
                     property list uchar int vertex_indices\nend_header\n"
                ),
            };
            mesh.vertices.iter().for_each(|v| writeln!(text, "{}", row(*v)).unwrap());
            for face in &mesh.faces {
                let corners: Vec<String> = face.iter().map(u32::to_string).collect();
                writeln!(text, "{} {}", face.len(), corners.join(" ")).unwrap();
            }
        }
        _ => {
            text.push_str("solid part\n");
            for face in &mesh.faces {
                for k in 1..face.len() - 1 {
                    text.push_str("facet normal 0 0 0\nouter loop\n");
                    for v in [face[0], face[k], face[k + 1]] {
                        writeln!(text, "vertex {}", row(mesh.vertices[v as usize])).unwrap();
                    }
                    text.push_str("endloop\nendfacet\n");
                }
            }
            text.push_str("endsolid part\n");
        }
    }
    parse(format, text.into_bytes(), Path::new("part")).unwrap()
}

/// Writes a mesh as a binary STL file and reads it again.
fn write_and_read_binary(mesh: &Mesh) -> Mesh {
    let triangles: Vec<[u32; 3]> = (mesh.faces.iter())
        .flat_map(|face| (1..face.len() - 1).map(move |k| [face[0], face[k], face[k + 1]]))
        .collect();
    let mut bytes = vec![0; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for corners in triangles {
        bytes.extend([0; 12]);
        for v in corners {
            let at = mesh.vertices[v as usize].to_array();
            bytes.extend(at.iter().flat_map(|c| (*c as f32).to_le_bytes()));
        }
        bytes.extend([0; 2]);
    }
    parse(Format::Stl, bytes, Path::new("part.stl")).unwrap()
}

/// Prints a number like `%.6g`.
fn six_digits(x: f64) -> String {
    format!("{x:.5e}").parse::<f64>().unwrap().to_string()
}

fn six_decimals(x: f64) -> String {
    format!("{x:.6}")
}

/// Checks whether a moving part is free along a direction, with the default tolerance of the files.
fn goes_through(parts: &[Mesh; 2], direction: DVec3) -> bool {
    let loaded = parts.each_ref().map(|mesh| solid(mesh, &BodyOptions::default()).unwrap());
    let [moving, fixed] = loaded.each_ref().map(|part| part.body.at(Pose::IDENTITY));
    let precisions = [loaded[0].precision, loaded[1].precision];
    let refuse = StartOverlap::Refuse;
    let cast = cast_between(moving, fixed, direction, precisions, None, refuse).unwrap();
    cast.clearance().unwrap().is_free()
}

/// A peg has the outline of the hole below it, in random poses. Rounded files make the two overlap.
#[test]
fn peg_with_outline_of_its_hole_fits_after_rounding() {
    let mut random = Random::new(11);
    let mut stuck = 0;
    for _ in 0..12 {
        // A convex outline with six corners. Caps of triangles are flat in a file of any precision.
        let outline: Vec<[f64; 2]> = (0..6)
            .map(|k| {
                let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_3).sin_cos();
                let radius = random.range(7.0, 7.5);
                [radius * cos, radius * sin]
            })
            .collect();
        let (turn, at) = (random.rotation(), random.vector() * 20.0);
        let placed = |mesh| transformed(mesh, |v| turn * v + at);
        let parts =
            [placed(prism(&outline, [3.0, 9.0])), placed(polygon_frame(&outline, [0.0, 2.0]))];
        let through = |parts: [Mesh; 2]| goes_through(&parts, turn * DVec3::NEG_Z);
        assert!(through(parts.each_ref().map(write_and_read_binary)), "binary STL");
        for format in [Format::Stl, Format::Obj, Format::Ply, Format::Off] {
            let text = |print: &dyn Fn(f64) -> String| {
                parts.each_ref().map(|mesh| write_and_read(mesh, format, print))
            };
            assert!(through(text(&six_decimals)), "{format} with six decimals");
            assert!(through(text(&six_digits)), "{format} with six digits");
            // Without a tolerance, the rounding of the same files blocks the peg.
            let exact = text(&six_digits).map(|mut mesh| {
                mesh.precision = 0.0;
                mesh
            });
            stuck += u32::from(!through(exact));
        }
    }
    assert!(stuck > 24, "{stuck}");
}

#[test]
fn number_format_follows_the_printed_digits() {
    let box_of = |size: DVec3| {
        let DVec3 { x, y, z } = size;
        prism(&[[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]], [0.0, z])
    };
    let turn = DQuat::from_euler(colltrans::glam::EulerRot::XYZ, 0.3, 0.7, 0.1);
    let turned = transformed(box_of(DVec3::new(20.0, 30.0, 40.0)), |v| turn * v);
    let all = |x: f64| x.to_string();
    for format in [Format::Stl, Format::Obj, Format::Ply, Format::Off] {
        let is = |mesh: &Mesh, print: &dyn Fn(f64) -> String| {
            let mesh = write_and_read(mesh, format, print);
            (mesh.format, mesh.precision)
        };
        assert_eq!(is(&turned, &six_decimals), (NumberFormat::Decimals(6), 2e-6), "{format}");
        assert_eq!(is(&turned, &six_digits), (NumberFormat::Digits(6), 2e-4), "{format}");
        assert_eq!(is(&turned, &all).0, NumberFormat::Double, "{format}");
        let single = |x: f64| (x as f32).to_string();
        assert_eq!(is(&turned, &single).0, NumberFormat::Single, "{format}");
        // Numbers in single precision, printed with all digits of doubles, nine digits, or eight decimals.
        let singles: [&dyn Fn(f64) -> String; 3] = [
            &|x| f64::from(x as f32).to_string(),
            &|x| format!("{:.8e}", f64::from(x as f32)),
            &|x| format!("{:.8}", f64::from(x as f32)),
        ];
        for print in singles {
            let largest = turned.vertices.iter().fold(0.0_f64, |m, v| m.max(v.abs().max_element()));
            let (found, precision) = is(&turned, print);
            assert_eq!(found, NumberFormat::Single, "{format}");
            assert!((precision * f64::from(1 << 22) / largest - 1.0).abs() < 1e-6, "{precision}");
        }
        // The numbers of a drawing are exact, with or without padding.
        for size in [DVec3::new(12.5, 7.25, 1000.0), DVec3::new(104.775, 25.4, 0.1)] {
            let drawn = box_of(size);
            let doubles = (NumberFormat::Double, size.max_element() / (1_u64 << 48) as f64);
            assert_eq!(is(&drawn, &all), doubles, "{format}");
            assert_eq!(is(&drawn, &six_decimals), doubles, "{format}");
        }
    }
    assert_eq!(write_and_read_binary(&turned).format, NumberFormat::Single);
}

/// Prints a number of a million or more like `%.6g`.
fn six_digits_with_exponent(x: f64) -> String {
    format!("{x:.5e}").replace('e', "e+0")
}

/// Numbers whose values do not show that they are rounded: `4.23511e+07`, `0.300`.
#[test]
fn peg_fits_if_exponents_or_zeros_show_the_rounding() {
    let mut random = Random::new(5);
    for _ in 0..6 {
        let turn = random.rotation();
        let parts = |size: f64| {
            let corner = |k: i32| (f64::from(k) * std::f64::consts::TAU / 24.0).sin_cos();
            let outline: Vec<[f64; 2]> =
                (0..24).map(corner).map(|(sin, cos)| [size * cos, size * sin]).collect();
            let placed = |mesh| transformed(mesh, |v| turn * v);
            let hole = placed(polygon_frame(&outline, [0.0, 2.0 * size]));
            [placed(prism(&outline, [0.0, 2.0 * size])), hole]
        };
        let goes_through = |parts: &[Mesh; 2]| goes_through(parts, turn * DVec3::Z);
        for format in [Format::Stl, Format::Obj, Format::Off, Format::Ply] {
            let read = |size: f64, print: &dyn Fn(f64) -> String| {
                parts(size).each_ref().map(|mesh| write_and_read(mesh, format, print))
            };
            let large = read(5e7, &six_digits_with_exponent);
            assert_eq!(large[0].format, NumberFormat::Digits(6), "{format}");
            assert!(goes_through(&large), "{format} with exponents");
            let small = read(3.0, &|x| format!("{x:.3}"));
            assert_eq!(small[0].format, NumberFormat::Decimals(3), "{format}");
            assert!(goes_through(&small), "{format} with three decimals");
        }
    }
}

/// Coordinates that a PLY file declares as `float`, after another property, with four digits.
#[test]
fn digits_of_text_ply_with_float_are_those_of_the_text() {
    let mut random = Random::new(3);
    let mut text = String::from(
        "ply\nformat ascii 1.0\nelement vertex 60\nproperty int id\nproperty float x\n\
         property float y\nproperty float z\nend_header\n",
    );
    for k in 0..60 {
        let row = (random.vector() * 20.0).to_array().map(|x| format!("{x:.3e}"));
        writeln!(text, "{k} {}", row.join(" ")).unwrap();
    }
    let mesh = parse(Format::Ply, text.into_bytes(), Path::new("part.ply")).unwrap();
    assert_eq!(mesh.format, NumberFormat::Digits(4));
    assert_eq!(mesh.precision, 0.02);
}

/// The nodes of COLLADA transform and scale their geometry, so that its digits are no longer those of the file.
#[test]
fn collada_nodes_scale_the_precision_of_their_text() {
    let turn = DQuat::from_euler(colltrans::glam::EulerRot::XYZ, 0.3, 0.7, 0.1);
    let outline = [[0.0, 0.0], [20.0, 0.0], [20.0, 30.0], [0.0, 30.0]];
    let mesh = transformed(prism(&outline, [0.0, 40.0]), |v| turn * v);
    for (print, found, precision) in [
        (&six_decimals as &dyn Fn(f64) -> String, NumberFormat::Decimals(6), 2e-5),
        (&|x| format!("{:.3}", 0.1 * x), NumberFormat::Decimals(3), 2e-2),
        (&|x| six_digits_with_exponent(1e6 * x), NumberFormat::Digits(6), 2e3),
    ] {
        let read = collada(&mesh, print);
        assert_eq!(read.format, found);
        assert!((read.precision / precision - 1.0).abs() < 1e-12, "{}", read.precision);
    }
}

/// Writes a mesh as a COLLADA file whose only node scales it by 10, and reads it again.
fn collada(mesh: &Mesh, print: &dyn Fn(f64) -> String) -> Mesh {
    let numbers: Vec<String> = mesh.vertices.iter().flat_map(DVec3::to_array).map(print).collect();
    let list =
        |of: &mut dyn Iterator<Item = u32>| of.map(|k| k.to_string()).collect::<Vec<_>>().join(" ");
    let counts = list(&mut mesh.faces.iter().map(|face| face.len() as u32));
    let corners = list(&mut mesh.faces.iter().flatten().copied());
    let text = format!(
        "<?xml version=\"1.0\"?><COLLADA><library_geometries><geometry id=\"g\"><mesh>\
         <source id=\"p\"><float_array id=\"a\" count=\"24\">{}</float_array><technique_common>\
         <accessor source=\"#a\" count=\"8\" stride=\"3\"><param name=\"X\" type=\"float\"/>\
         <param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor></technique_common>\
         </source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>\
         <polylist count=\"6\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>\
         <vcount>{counts}</vcount><p>{corners}</p></polylist></mesh></geometry></library_geometries>\
         <library_visual_scenes><visual_scene id=\"s\"><node><rotate>0 0 1 30</rotate><scale>10 10 10</scale>\
         <instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes>\
         <scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>",
        numbers.join(" ")
    );
    parse(Format::Dae, text.into_bytes(), Path::new("part.dae")).unwrap()
}

/// Returns an L of size 40 at coordinates of the UTM grid.
fn utm_angle() -> Mesh {
    let outline = [[0.0, 0.0], [40.0, 0.0], [40.0, 10.0], [10.0, 10.0], [10.0, 40.0], [0.0, 40.0]];
    transformed(prism(&outline, [0.0, 10.0]), |v| v + DVec3::new(500_000.0, 4_649_776.0, 0.0))
}

/// Returns the mesh with an additional vertex that no face uses.
fn with_stray(mesh: &Mesh, at: DVec3) -> Mesh {
    let mut mesh = mesh.clone();
    mesh.vertices.insert(0, at);
    mesh.faces.iter_mut().flatten().for_each(|v| *v += 1);
    mesh
}

#[test]
fn unused_vertex_does_not_change_tolerances() {
    let angle = utm_angle();
    let refused = convex(&angle, &BodyOptions::default()).unwrap_err();
    for stray in [DVec3::ZERO, DVec3::splat(1e12)] {
        let stray = with_stray(&angle, stray);
        let same = convex(&stray, &BodyOptions::default()).unwrap_err();
        assert_eq!(same.to_string(), refused.to_string(), "not convex");
        assert_eq!((stray.extent(), stray.bounds()), (40.0, angle.bounds()));
        for format in [Format::Obj, Format::Ply, Format::Off] {
            let [with, without] =
                [&stray, &angle].map(|mesh| write_and_read(mesh, format, &|x| x.to_string()));
            assert_eq!(with.precision, without.precision, "{format}");
            assert_eq!(with.merged.tolerance, without.merged.tolerance, "{format}");
        }
    }
}

#[test]
fn hull_excludes_unused_vertices() {
    let options = BodyOptions::default().with_hull(true);
    let angle = utm_angle();
    let plain = convex(&angle, &options).unwrap();
    assert!((plain.body.volume() - 11_500.0).abs() < 1e-3, "{}", plain.body.volume());
    for stray in [DVec3::ZERO, DVec3::splat(1e12)] {
        for format in [Format::Obj, Format::Ply, Format::Off] {
            let mesh = write_and_read(&with_stray(&angle, stray), format, &|x| x.to_string());
            let loaded = convex(&mesh, &options).unwrap();
            assert_eq!(loaded.body.vertices(), plain.body.vertices(), "{format}");
            assert!(loaded.notes.contains(&Note::Stray(1)), "{:?}", loaded.notes);
            assert!(!plain.notes.contains(&Note::Stray(1)));
            // Features refer to the vertices of the file.
            for (vertex, number) in loaded.body.vertices().iter().zip(loaded.body.input_indices()) {
                assert_eq!(mesh.vertices[number.index()], *vertex, "{format}");
            }
        }
    }
    assert_eq!(Note::Stray(2).to_string(), "2 vertices that no face uses are not in the hull");
    // A point cloud has no faces.
    let cloud = Mesh::new(angle.vertices.clone(), Vec::new());
    let loaded = convex(&cloud, &options).unwrap();
    assert_eq!(loaded.body.vertices(), plain.body.vertices());
    assert!(!loaded.notes.iter().any(|note| matches!(note, Note::Stray(_))));
    // A vertex that is NaN is ignored if no face uses it.
    let mut unknown = with_stray(&angle, DVec3::NAN);
    assert_eq!(convex(&unknown, &options).unwrap().body.vertices(), plain.body.vertices());
    unknown.vertices[3] = DVec3::NAN;
    let said = convex(&unknown, &options).unwrap_err().to_string();
    assert!(said.contains("point 3"), "{said}");
}

#[test]
fn body_convex_within_tolerance_reports_its_dent() {
    let outline = [[0.0, 0.0], [40.0, 0.0], [40.0, 40.0], [20.0, 39.9999], [0.0, 40.0]];
    let dented = prism(&outline, [0.0, 10.0]);
    let loaded = convex(&dented, &BodyOptions::default()).unwrap();
    assert!((loaded.body.dent() - 1e-4).abs() < 1e-9, "{}", loaded.body.dent());
    assert_eq!(loaded.notes, [Note::Dented(loaded.body.dent())]);
    let said = loaded.notes[0].to_string();
    assert!(
        said.contains("convex only to within the tolerance") && said.contains("0.0001"),
        "{said}"
    );
    // A depth that the digits of the file explain is not reported.
    let mut coarse = dented.clone();
    coarse.precision = 1e-3;
    assert!(convex(&coarse, &BodyOptions::default()).unwrap().notes.is_empty());
    let straight = prism(&[[0.0, 0.0], [40.0, 0.0], [40.0, 40.0], [0.0, 40.0]], [0.0, 10.0]);
    let loaded = convex(&straight, &BodyOptions::default()).unwrap();
    assert!(loaded.body.dent() == 0.0 && loaded.notes.is_empty());
}
