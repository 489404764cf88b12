//! The default tolerance follows the numbers that files write, not where the parts are.

use crate::common::*;
use colltrans_assembly::plan::PlanOptions;
use colltrans_assembly::{Assembly, Bodies, Fit};
use colltrans_assembly_io::read::{ReadOptions, read};
use colltrans_testkit::TemporaryFolder;
use glam::DVec3;

/// Outlines of an L and of a block in its corner, which it touches; both from the corner that they share.
const OUTLINES: [&[[f64; 2]]; 2] = [
    &[[1.0, 1.0], [1.0, 2.0], [0.0, 2.0], [0.0, 0.0], [2.0, 0.0], [2.0, 1.0]],
    &[[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]],
];

/// The triangles of an outline that is extruded by 1, of the vertices `0..2 n`.
fn prism(outline: &[[f64; 2]], at: DVec3) -> (Vec<DVec3>, Vec<[usize; 3]>) {
    let n = outline.len();
    let layer = |z: f64| outline.iter().map(move |[x, y]| at + DVec3::new(*x, *y, z));
    let mut faces = Vec::new();
    for k in 1..n - 1 {
        faces.extend([[0, k + 1, k], [n, n + k, n + k + 1]]);
    }
    for k in 0..n {
        let next = (k + 1) % n;
        faces.extend([[k, next, n + next], [k, n + next, n + k]]);
    }
    (layer(0.0).chain(layer(1.0)).collect(), faces)
}

/// Reads both parts from files of a kind in a place.
fn parts(at: DVec3, kind: &str, write: fn(&[DVec3], &[[usize; 3]]) -> Vec<u8>) -> Assembly {
    let folder = TemporaryFolder::new();
    for (k, outline) in OUTLINES.iter().enumerate() {
        let (vertices, faces) = prism(outline, at);
        std::fs::write(folder.path().join(format!("part{k}.{kind}")), write(&vertices, &faces))
            .unwrap();
    }
    read(folder.path(), &ReadOptions::default()).unwrap()
}

fn obj(vertices: &[DVec3], faces: &[[usize; 3]], print: fn(f64) -> String) -> Vec<u8> {
    let vertices = vertices.iter().map(|v| ["v", &v.to_array().map(print).join(" ")].join(" "));
    let corners = |face: &[usize; 3]| face.map(|v| (v + 1).to_string()).join(" ");
    let faces = faces.iter().map(|face| ["f", &corners(face)].join(" "));
    vertices.chain(faces).collect::<Vec<_>>().join("\n").into_bytes()
}

fn nine_decimals(vertices: &[DVec3], faces: &[[usize; 3]]) -> Vec<u8> {
    obj(vertices, faces, |x| format!("{x:.9}"))
}

fn stl(vertices: &[DVec3], faces: &[[usize; 3]]) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((faces.len() as u32).to_le_bytes());
    for face in faces {
        bytes.extend([0; 12]);
        let numbers = face.iter().flat_map(|&v| vertices[v].to_array());
        bytes.extend(numbers.flat_map(|x| (x as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

/// Checks whether the parts come apart with their default tolerance, which leaves each of them whole.
fn come_apart(assembly: &Assembly) -> bool {
    let bodies = Bodies::new(assembly, Fit::default_for(assembly)).unwrap();
    let whole = (0..bodies.len()).all(|part| bodies.remark(part).is_none());
    let plan = planned(&bodies, PlanOptions::default());
    whole && bodies.overlapping().is_empty() && plan.stuck.is_empty()
}

#[test]
fn parts_at_large_coordinates_are_not_shrunk_by_more_than_their_digits() {
    let utm = DVec3::new(500_000.123_456_789, 5_400_000.987_654_321, 100.0);
    let assembly = parts(utm, "obj", nine_decimals);
    // Doubles hold 4 times 2^-48 of such a coordinate, which is more than nine decimals.
    let digits = 5_400_002.987_654_321 / (1_u64 << 46) as f64;
    assert_eq!(Fit::default_for(&assembly), Fit::Tolerance(digits));
    assert!(come_apart(&assembly));
    // Three decimals there are 8 millimetres.
    let coarse = parts(utm, "obj", |v, f| obj(v, f, |x| format!("{x:.3}")));
    assert_eq!(Fit::default_for(&coarse), Fit::Tolerance(8e-3));
    assert!(come_apart(&coarse));
}

#[test]
fn the_default_tolerance_is_that_of_the_written_digits() {
    let at = DVec3::new(0.123_456_789, 0.987_654_321, 0.0);
    let assembly = parts(at, "obj", nine_decimals);
    assert_eq!(Fit::default_for(&assembly), Fit::Tolerance(8e-9));
    assert!(come_apart(&assembly));
    // An overlap of a ten-millionth is no rounding of such files, though it were one in single precision.
    let sunk = |vertices: &[DVec3], faces: &[[usize; 3]]| {
        let by = if vertices.len() == 8 { -1e-7 } else { 0.0 };
        let moved: Vec<DVec3> = vertices.iter().map(|v| *v + DVec3::Y * by).collect();
        nine_decimals(&moved, faces)
    };
    let assembly = parts(at, "obj", sunk);
    let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
    assert_eq!(bodies.overlapping(), [[0, 1]]);
}

#[test]
fn files_in_single_precision_keep_the_tolerance_of_the_assembly() {
    let at = DVec3::new(0.1, 0.2, 0.3);
    for assembly in [
        parts(at, "stl", stl),
        parts(at, "obj", |v, f| obj(v, f, |x| f64::from(x as f32).to_string())),
    ] {
        let size = f64::from(2.2_f32);
        assert_eq!(Fit::default_for(&assembly), Fit::Tolerance(size / f64::from(1 << 21)));
        assert!(come_apart(&assembly));
    }
    // The numbers of such a file know no more of its place than half a metre.
    let utm = parts(DVec3::new(500_000.0, 5_400_000.0, 0.0), "stl", stl);
    let Fit::Tolerance(tolerance) = Fit::default_for(&utm) else { panic!("a tolerance") };
    assert!((tolerance - 5_400_002.0 / f64::from(1 << 21)).abs() < 1e-9, "{tolerance}");
}
