//! Tests that the default tolerance follows the digits of the files, not the positions of the parts.

use crate::common::*;
use colltrans_assembly::plan::PlanOptions;
use colltrans_assembly::{Assembly, Bodies, Fit};
use colltrans_assembly_io::read::{ReadOptions, read};
use colltrans_testkit::TemporaryFolder;
use glam::DVec3;

/// Outlines of an L and of a block in contact with its inner corner. Both start at the common corner.
const OUTLINES: [&[[f64; 2]]; 2] = [
    &[[1.0, 1.0], [1.0, 2.0], [0.0, 2.0], [0.0, 0.0], [2.0, 0.0], [2.0, 1.0]],
    &[[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]],
];

/// Extrudes an outline by 1 at position `at`: vertices, and triangles of the vertices `0..2 n`.
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

/// Reads both parts at position `at` from files of a format.
fn read_parts(at: DVec3, kind: &str, write: fn(&[DVec3], &[[usize; 3]]) -> Vec<u8>) -> Assembly {
    let folder = TemporaryFolder::new();
    for (k, outline) in OUTLINES.iter().enumerate() {
        let (vertices, faces) = prism(outline, at);
        std::fs::write(folder.path().join(format!("part{k}.{kind}")), write(&vertices, &faces))
            .unwrap();
    }
    read(folder.path(), &ReadOptions::default()).unwrap()
}

/// Writes a mesh as OBJ.
fn obj(vertices: &[DVec3], faces: &[[usize; 3]], print: fn(f64) -> String) -> Vec<u8> {
    let vertices = vertices.iter().map(|v| ["v", &v.to_array().map(print).join(" ")].join(" "));
    let corners = |face: &[usize; 3]| face.map(|v| (v + 1).to_string()).join(" ");
    let faces = faces.iter().map(|face| ["f", &corners(face)].join(" "));
    vertices.chain(faces).collect::<Vec<_>>().join("\n").into_bytes()
}

/// Writes a mesh as OBJ with nine decimals.
fn obj_with_nine_decimals(vertices: &[DVec3], faces: &[[usize; 3]]) -> Vec<u8> {
    obj(vertices, faces, |x| format!("{x:.9}"))
}

/// Writes a mesh as binary STL.
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

/// Checks whether the parts are separated with their default tolerance, and remain whole with it.
fn is_separable(assembly: &Assembly) -> bool {
    let bodies = Bodies::new(assembly, Fit::default_for(assembly)).unwrap();
    let whole = (0..bodies.len()).all(|part| bodies.shrink_defects(part).is_none());
    let plan = planned(&bodies, PlanOptions::default());
    whole && bodies.overlapping_pairs().is_empty() && plan.interlocked.is_empty()
}

#[test]
fn tolerance_at_large_coordinates_follows_digits_of_file() {
    let utm = DVec3::new(500_000.123_456_789, 5_400_000.987_654_321, 100.0);
    let assembly = read_parts(utm, "obj", obj_with_nine_decimals);
    // The rounding of doubles, 4 times 2^-48 of such a coordinate, exceeds nine decimals.
    let digits = 5_400_002.987_654_321 / (1_u64 << 46) as f64;
    assert_eq!(Fit::default_for(&assembly), Fit::Tolerance(digits));
    assert!(is_separable(&assembly));
    // Three decimals correspond to a tolerance of 8 millimetres.
    let coarse = read_parts(utm, "obj", |v, f| obj(v, f, |x| format!("{x:.3}")));
    assert_eq!(Fit::default_for(&coarse), Fit::Tolerance(8e-3));
    assert!(is_separable(&coarse));
}

#[test]
fn default_tolerance_follows_written_digits() {
    let at = DVec3::new(0.123_456_789, 0.987_654_321, 0.0);
    let assembly = read_parts(at, "obj", obj_with_nine_decimals);
    assert_eq!(Fit::default_for(&assembly), Fit::Tolerance(8e-9));
    assert!(is_separable(&assembly));
    // An overlap of `1e-7` exceeds the rounding of such files, but not that of single precision.
    let sunk = |vertices: &[DVec3], faces: &[[usize; 3]]| {
        let by = if vertices.len() == 8 { -1e-7 } else { 0.0 };
        let moved: Vec<DVec3> = vertices.iter().map(|v| *v + DVec3::Y * by).collect();
        obj_with_nine_decimals(&moved, faces)
    };
    let assembly = read_parts(at, "obj", sunk);
    let bodies = Bodies::new(&assembly, Fit::default_for(&assembly)).unwrap();
    assert_eq!(bodies.overlapping_pairs(), [[0, 1]]);
}

#[test]
fn single_precision_tolerance_follows_size_of_assembly() {
    let at = DVec3::new(0.1, 0.2, 0.3);
    for assembly in [
        read_parts(at, "stl", stl),
        read_parts(at, "obj", |v, f| obj(v, f, |x| f64::from(x as f32).to_string())),
    ] {
        let size = f64::from(2.2_f32);
        assert_eq!(Fit::default_for(&assembly), Fit::Tolerance(size / f64::from(1 << 21)));
        assert!(is_separable(&assembly));
    }
    // Single precision resolves only half a metre at these coordinates.
    let utm = read_parts(DVec3::new(500_000.0, 5_400_000.0, 0.0), "stl", stl);
    let Fit::Tolerance(tolerance) = Fit::default_for(&utm) else { panic!("a tolerance") };
    assert!((tolerance - 5_400_002.0 / f64::from(1 << 21)).abs() < 1e-9, "{tolerance}");
}
