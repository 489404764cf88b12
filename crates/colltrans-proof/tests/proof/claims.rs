//! Claims of proof files about motions and paths that are weaker than the proof, or different from it.

use colltrans_convex::{ConvexPolyhedron, Pose};
use colltrans_motion::path::{Frame, Joint, JointPath, Mechanism, PathBody, PathCast};
use colltrans_motion::{Motion, MotionCast};
use colltrans_proof::record::{Ending, FreeRecord};
use colltrans_proof::{ProofFile, ProofFileError};
use colltrans_removal::directions::{CellProof, FreeDirections, FreeOptions, FreeProof};
use colltrans_solid::{AsSolid, Solid};
use colltrans_testkit::bodies::cube;
use colltrans_testkit::cases;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::Mesh;
use colltrans_testkit::solids::turned;
use glam::{DMat3, DQuat, DVec3};
use serde_json::{Value, json};

fn at(x: f64) -> Pose {
    Pose::from_translation(DVec3::X * x).expect("a pose")
}

/// Returns the proof of a cube that slides by 4 towards another one at distance 2, with a minimum gap.
fn sliding_cube_proof(min_gap: f64) -> Value {
    let (cube, motion) =
        (cube(), Motion::translation(Pose::IDENTITY, DVec3::X * 4.0).expect("a motion"));
    let cast = MotionCast::new(cube.with_motion(&motion), cube.at(at(3.0))).expect("a cast");
    let cast = cast.with_min_gap(min_gap).expect("a gap");
    let outcome = cast.first_contact().expect("an answer");
    serde_json::from_str(&ProofFile::of_motion(&cast, &outcome).to_json()).expect("JSON")
}

/// Pointers to the proof of a motion, of a motion of solids and of a path, and to the moving body's motion.
const MOTION: &str = "/statement/motions/0/convex";
const SOLIDS: &str = "/statement/motions/0/solids/proof";
const PATH: &str = "/statement/path/proof";
const MOVES: &str = "/placement/motions/0/0/motion";

/// Returns the statement as text if the proof is valid, otherwise the error.
fn statement_text(file: &Value) -> Result<String, String> {
    let proof = ProofFile::from_json(&file.to_string()).map_err(|e| e.to_string())?;
    proof.check().map_err(|e| e.to_string())?;
    Ok(proof.to_string())
}

/// Returns the file without a field.
fn without_field(file: &Value, under: &str, name: &str) -> Value {
    let mut less = file.clone();
    let of = less.pointer_mut(under).and_then(Value::as_object_mut).expect("an object");
    of.remove(name).expect("a field");
    less
}

/// Returns the file with another value at a pointer.
fn with_value(file: &Value, at: &str, value: Value) -> Value {
    let mut other = file.clone();
    *other.pointer_mut(at).unwrap_or_else(|| panic!("no {at}")) = value;
    other
}

#[test]
fn contact_without_planes_claims_only_upper_bound() {
    let file = sliding_cube_proof(0.0);
    assert!(
        statement_text(&file)
            .expect("it holds")
            .starts_with("the bodies first meet at a time between")
    );
    let weaker = statement_text(&with_value(&file, &format!("{MOTION}/spans"), json!([[]])))
        .expect("it holds");
    assert!(weaker.starts_with("the bodies meet by the time 0.5"), "{weaker}");
}

#[test]
fn motion_piece_starting_at_end_is_rejected() {
    let (cube, motion) = (cube(), Motion::translation(Pose::IDENTITY, DVec3::Y).expect("a motion"));
    let cast = MotionCast::new(cube.with_motion(&motion), cube.at(at(3.0))).expect("a cast");
    let outcome = cast.first_contact().expect("an answer");
    let file = ProofFile::of_motion(&cast, &outcome).to_json();
    let mut file: Value = serde_json::from_str(&file).expect("JSON");
    assert_eq!(statement_text(&file).expect("free"), "the bodies never meet throughout the motion");
    // At time 1 the body would be inside the other one.
    let pieces = file.pointer_mut(MOVES).and_then(Value::as_array_mut).expect("pieces");
    let mut last = pieces[0].clone();
    last["since"] = json!(1.0);
    last["start"]["translation"] = json!([3.0, 0.0, 0.0]);
    pieces.push(last);
    statement_text(&file).expect_err("a piece of no time");
}

/// A search of solids tests only at the start whether one contains the other. A body that jumps into a solid would
/// therefore count as free.
#[test]
fn motion_that_jumps_is_rejected() {
    let rest = Motion::through_poses(&[at(3.0); 3]).expect("a motion");
    let value = serde_json::to_value(&rest).expect("JSON");
    assert_eq!(serde_json::from_value::<Motion>(value.clone()).expect("a motion"), rest);
    let jumps = |pointer: &str, new: Value| {
        let read = serde_json::from_value::<Motion>(with_value(&value, pointer, new));
        let message = read.expect_err("a jump").to_string();
        assert!(message.contains("the motion jumps at the time 0.5"), "{message}");
    };
    jumps("/1/start/translation", json!([0.25, 0.25, 0.25]));
    jumps("/1/start/translation", json!([3.0, 1e-9, 0.0]));
    jumps("/1/start/matrix", json!([0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0]));
    jumps("/0/velocity", json!([1.0, 0.0, 0.0]));
    jumps("/0/rate", json!(0.5));
}

#[test]
fn continuous_motions_of_all_magnitudes_are_read() {
    let mut random = Random::new(83);
    for _ in 0..cases(4_000) {
        let length = 10.0_f64.powi(random.int(-30, 30) as i32);
        let small = 10.0_f64.powi(random.int(-17, 0) as i32);
        let (first, start) = (random.rotation(), random.vector() * length);
        // The matrices deviate from rotations by up to 1e-7.
        let stretch = random.pick(&[0.0, 1e-9, 1e-7]);
        let poses: Vec<Pose> = (0..random.int(2, 5))
            .map(|k| {
                let turn =
                    DQuat::from_axis_angle(random.direction(), 3.0 * small * k as f64) * first;
                let stretched =
                    DMat3::from_quat(turn) + DMat3::from_diagonal(random.vector() * stretch);
                let near = start + random.vector() * (length * random.pick(&[1.0, 1e-6, small]));
                Pose::from_matrix(stretched, near).expect("a pose")
            })
            .collect();
        let Ok(motion) = Motion::through_poses(&poses) else { continue };
        let value = serde_json::to_value(&motion).expect("JSON");
        let read = serde_json::from_value::<Motion>(value.clone());
        assert_eq!(read.unwrap_or_else(|e| panic!("{e}: {value}")), motion);
    }
}

#[test]
fn nullable_field_must_be_present_and_unknown_field_is_rejected() {
    let file = sliding_cube_proof(0.0);
    statement_text(&without_field(&file, MOTION, "meeting")).expect_err("no meeting");
    statement_text(&with_value(&file, &format!("{MOTION}/meeting"), Value::Null))
        .expect("none is claimed");
    let mut more = file.clone();
    more["statement"]["motions"][0]["convex"]["spans"][0][0]["more"] = json!(1);
    statement_text(&more).expect_err("a field that is not known");
}

#[test]
fn joined_pairs_need_equal_minimum_gap() {
    let several = |proofs: &[Value]| {
        let proofs =
            proofs.iter().map(|of| ProofFile::from_json(&of.to_string()).expect("a proof"));
        ProofFile::of_motions(proofs.collect())
    };
    let [plain, kept] = [sliding_cube_proof(0.0), sliding_cube_proof(0.25)];
    let both = several(&[kept.clone(), kept.clone()]).expect("one question");
    let file: Value = serde_json::from_str(&both.to_json()).expect("JSON");
    assert_eq!(file["bodies"].as_array().map(Vec::len), Some(1), "a body is written once");
    let said = statement_text(&file).expect("it holds");
    assert!(said.starts_with("of 2 pairs of bodies the first come as near as 0.25 at"), "{said}");
    // The joined statement would claim the gap 0.25 for all pairs.
    assert!(matches!(several(&[kept, plain]), Err(ProofFileError::Pairs { pair: 0 })));
    assert!(matches!(several(&[]), Err(ProofFileError::NoPairs)));
    statement_text(&with_value(&file, "/query/motions/1/min_gap", json!(0.125)))
        .expect_err("two gaps");
    let pair = file["placement"]["motions"][0].clone();
    statement_text(&with_value(&file, "/placement/motions", json!([pair])))
        .expect_err("a pair is missing");
    statement_text(&with_value(&file, "/placement/motions/1/0/body", json!(1)))
        .expect_err("no such body");
    statement_text(&with_value(
        &file,
        "/query/motions/0",
        json!({"min_gap": 0.25, "tolerance": 0.0}),
    ))
    .expect_err("convex bodies have no tolerance");
}

/// Returns the proof of a bar that turns into a post, both as solids.
fn turning_bar_proof() -> Value {
    let bar = ConvexPolyhedron::cuboid(DVec3::new(0.0, -0.1, 0.0), DVec3::new(2.0, 0.1, 0.2));
    let bar = Solid::from_convex(&bar.expect("a bar")).expect("a solid");
    let post = ConvexPolyhedron::cuboid(DVec3::splat(-0.1), DVec3::splat(0.3)).expect("a post");
    let post = Solid::from_convex(&post).expect("a solid");
    let turn = Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, std::f64::consts::PI);
    let turn = turn.expect("a turn");
    let still = Motion::at_rest(Pose::from_translation(DVec3::Y * 1.5).expect("a pose"));
    let cast =
        MotionCast::<Solid>::new(bar.with_motion(&turn), post.with_motion(&still)).expect("a cast");
    let (_, file) = ProofFile::with_solid_motion(&cast).expect("an answer");
    serde_json::from_str(&file.to_json()).expect("JSON")
}

#[test]
fn edge_number_beyond_facet_and_missing_fields_are_rejected() {
    let file = turning_bar_proof();
    let holds = |file: &Value| {
        ProofFile::from_json(&file.to_string()).is_ok_and(|proof| proof.check().is_ok())
    };
    assert!(holds(&file));
    let place = &format!("{SOLIDS}/meeting/met/crossing/edge");
    let edge = file.pointer(place).and_then(Value::as_u64).expect("an edge");
    assert!(!holds(&with_value(&file, place, json!(edge + 3))));
    for (under, name) in
        [("/statement/motions/0/solids", "parts"), (SOLIDS, "meeting"), (SOLIDS, "start")]
    {
        assert!(!holds(&without_field(&file, under, name)), "{name}");
    }
}

/// Returns the proof of a cube that slides along x from row to row, with cubes at 3, 5 and 40.
fn cart_proof(rows: &[f64]) -> Value {
    let cube = cube();
    let frame = Frame { parent: None, origin: Pose::IDENTITY, joint: Joint::Sliding(DVec3::X) };
    let slide = Mechanism::new(vec![frame]).expect("a mechanism");
    let path = JointPath::at_unit_times(rows.iter().map(|x| vec![*x]).collect()).expect("a path");
    let mut bodies = vec![PathBody::carried_by(0, cube.at(Pose::IDENTITY))];
    bodies.extend([3.0, 5.0, 40.0].map(|x| PathBody::at_rest(cube.at(at(x)))));
    let pairs = vec![[0, 1], [0, 2], [0, 3]];
    let cast = PathCast::new(&slide, &path, bodies, pairs).expect("a cast");
    let names = ["cart".into(), "stop".into(), "wall".into()];
    let (_, file) = ProofFile::with_path(&cast, &names).expect("an answer");
    serde_json::from_str(&file.to_json()).expect("JSON")
}

const PAIRS: &str = "of 3 pairs (cart and stop, cart and wall, cart and \"body 3\")";

#[test]
fn path_statement_names_pairs_and_wrong_names_are_rejected() {
    let file = cart_proof(&[0.0, 8.0]);
    let said = statement_text(&file).expect("it holds");
    assert!(said.starts_with(&format!("{PAIRS} none meet before the time 0.24999")), "{said}");
    assert!(said.contains(", and cart and stop meet by the time 0.25"), "{said}");
    for (place, value) in [
        ("/statement/path/pairs/0/1", json!("wall of another room")),
        ("/statement/path/pairs/0/1", json!("cart")),
        ("/statement/path/pairs", json!([["cart", "stop"]])),
        ("/placement/robot/bodies/1/name", json!("wall")),
        ("/placement/robot/bodies/1/name", json!("")),
    ] {
        statement_text(&with_value(&file, place, value)).expect_err(place);
    }
}

#[test]
fn body_name_that_reads_like_sentence_is_quoted() {
    let text = cart_proof(&[0.0, 2.0]).to_string();
    let name = "wall never meet on the whole path, and cart";
    let said = statement_text(&serde_json::from_str(&text.replace("wall", name)).expect("JSON"));
    let said = said.expect("it holds");
    assert!(said.contains(&format!("cart and {name:?}, ")), "{said}");
}

#[test]
fn joined_proofs_report_start_overlap_of_one_pair() {
    let cube = cube().as_solid().expect("a solid").clone();
    let motion = Motion::translation(Pose::IDENTITY, DVec3::X).expect("a motion");
    let proofs = [0.5, 9.0].map(|x| {
        let cast =
            MotionCast::<Solid>::new(cube.with_motion(&motion), cube.at(at(x))).expect("a cast");
        ProofFile::with_solid_motion(&cast.with_tolerance(0.0).expect("a tolerance"))
            .expect("a proof")
            .1
    });
    let alone = proofs[0].to_string();
    assert!(alone.ends_with("overlap when the motion begins"), "{alone}");
    let both = ProofFile::of_motions(proofs.into()).expect("one question");
    assert_eq!(both.check().expect("it holds").time_bounds(), Some([0.0, 0.0]));
    let said = both.to_string();
    assert_eq!(said, "of 2 pairs of bodies those of one meet when the motion begins");
}

#[test]
fn later_contact_is_not_stated_as_first() {
    // The proof locates only the later contact, and claims nothing about the time before it.
    let (one, both) = (cart_proof(&[0.0, 8.0]), cart_proof(&[3.9, 8.0]));
    let how = both.pointer(&format!("{PATH}/meeting/how")).expect("how");
    let mut weak = one.clone();
    let proof = weak.pointer_mut(PATH).expect("a proof");
    proof["covers"] = json!([{"steps": []}, {"steps": []}, {"steps": []}]);
    proof["meeting"]["pair"] = json!(1);
    proof["meeting"]["place"]["share"] = json!(0.51);
    // Both cubes are equal. The surface near the origin belongs to cubes that overlap by 1/12.
    proof["meeting"]["how"] = how.clone();
    weak["statement"]["path"]["lower"] = json!(0.0);
    weak["statement"]["path"]["upper"] = json!(0.52);
    if let Ok(said) = statement_text(&weak) {
        assert!(!said.contains("first"), "{said}");
        assert!(said.contains("none meet before the time 0, and cart and wall"), "{said}");
    }
    let told = statement_text(&one).expect("it holds");
    assert!(!told.contains("the first"), "{told}");
}

#[test]
fn one_row_path_is_free_only_with_planes() {
    let file = cart_proof(&[0.0]);
    let whole = format!("{PAIRS} none meet on the whole path, up to the time 0");
    assert_eq!(statement_text(&file).expect("it holds"), whole);
    for k in 0..3 {
        let less = with_value(&file, &format!("{PATH}/covers/{k}/steps"), json!([]));
        let said = statement_text(&less).expect("it says less");
        assert_eq!(said, format!("{PAIRS} no claim is made"));
    }
}

#[test]
fn place_off_the_path_and_missing_fields_are_rejected() {
    let file = cart_proof(&[0.0, 8.0]);
    for (row, share) in [(u64::MAX, 1.0), (u64::MAX, 0.0), (2, 0.0), (1, 0.5), (0, 1.5), (0, -0.5)]
    {
        let place = json!({"row": row, "share": share});
        statement_text(&with_value(&file, &format!("{PATH}/meeting/place"), place.clone()))
            .expect_err("off the path");
        let parts = json!([{"parts": {"which": 0, "until": place, "covers": []}}]);
        statement_text(&with_value(&file, &format!("{PATH}/covers/0/steps"), parts))
            .expect_err("off the path");
    }
    for (under, name) in [
        (PATH, "meeting"),
        ("/placement/robot/frames/0", "parent"),
        ("/placement/robot/bodies/0", "frame"),
        ("/statement/path", "pairs"),
        ("/statement/path", "upper"),
    ] {
        statement_text(&without_field(&file, under, name)).expect_err(name);
    }
}

#[test]
fn tiny_axis_component_is_accepted() {
    let file = cart_proof(&[0.0, 8.0]);
    let traced =
        with_value(&file, "/placement/robot/frames/0/joint/sliding", json!([1.0, 1e-310, 0.0]));
    statement_text(&traced).expect("it holds");
}

/// Two linked rings of 14,400 facets. Their cover is nested more deeply than the default limit of the JSON
/// reader.
#[test]
fn deeply_nested_path_proof_is_read_back() {
    let profile: Vec<[f64; 2]> = (0..60)
        .map(|k| f64::from(k) * std::f64::consts::TAU / 60.0)
        .map(|a| [0.5 + 0.09 * a.cos(), 0.09 * a.sin()])
        .collect();
    let Mesh { vertices, faces } = turned(&profile, 120);
    let ring = Solid::from_mesh(&vertices, &faces).expect("a ring");
    let frame = Frame { parent: None, origin: Pose::IDENTITY, joint: Joint::Turning(DVec3::Z) };
    let hinge = Mechanism::new(vec![frame]).expect("a mechanism");
    let path = JointPath::at_unit_times(vec![vec![0.0], vec![0.05], vec![0.1]]).expect("a path");
    let upright = DQuat::from_mat3(&DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X));
    let through = Pose::new(upright, DVec3::X * 0.5).expect("a pose");
    let bodies =
        vec![PathBody::carried_by(0, ring.at(Pose::IDENTITY)), PathBody::at_rest(ring.at(through))];
    let cast = PathCast::new(&hinge, &path, bodies, vec![[0, 1]]).expect("a cast");
    let (_, file) = ProofFile::with_path(&cast, &[]).expect("an answer");
    let text = file.to_json();
    assert!(serde_json::from_str::<Value>(&text).is_err(), "the nesting is not deep enough");
    let read = ProofFile::from_json(&text).expect("a proof");
    assert_eq!(read.check().expect("it holds").time_bounds(), Some([2.0, f64::INFINITY]));
    let deeper = text.replacen("\"covers\":[", &format!("\"covers\":{}", "[".repeat(500)), 1);
    let refused = ProofFile::from_json(&deeper).unwrap_err().to_string();
    assert!(refused.contains("nested more than 400 deep"), "{refused}");
}

/// Returns the depth statement of two separate cubes, which proves only an overlap of at least 0.
fn zero_depth(normal: [f64; 3]) -> Value {
    let enclosure = json!({"pairs": [], "triangles": [], "normals": []});
    json!({"deep": {"lower": 0.0, "upper": 0.0, "direction": normal, "enclosure": enclosure}})
}

#[test]
fn zero_depth_does_not_prove_contact_at_minimum_gap() {
    let file = sliding_cube_proof(1.0);
    for normal in [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
        for time in [0.0, 0.1] {
            let meeting = json!({"time": time, "met": zero_depth(normal)});
            let mut forged = with_value(&file, &format!("{MOTION}/meeting"), meeting);
            forged = with_value(&forged, &format!("{MOTION}/spans"), json!([[]]));
            assert!(statement_text(&forged).is_err(), "{:?}", statement_text(&forged));
        }
    }
}

/// The joined statement claims that the bodies do not meet, therefore no pair may have a tolerance.
#[test]
fn joined_pairs_with_tolerance_are_rejected() {
    let cube = cube().as_solid().expect("a solid").clone();
    let motion = Motion::translation(Pose::IDENTITY, DVec3::X * 4.0).expect("a motion");
    let there = Pose::from_translation(DVec3::new(2.0, 0.75, 0.0)).expect("a pose");
    let cast = MotionCast::<Solid>::new(cube.with_motion(&motion), cube.at(there)).expect("a cast");
    for (tolerance, holds) in [(0.0, true), (0.6, false)] {
        let cast = cast.clone().with_tolerance(tolerance).expect("a tolerance");
        let (_, file) = ProofFile::with_solid_motion(&cast).expect("an answer");
        assert!(file.check().is_ok(), "the statement about one pair mentions the offset");
        let read = ProofFile::of_motions(vec![file.clone(), file]);
        assert_eq!(read.is_ok(), holds, "{tolerance}");
    }
}

/// Divides every open cell of a proof that a plane through the origin crosses, down to a depth.
fn divided_along(cells: &[CellProof], normal: DVec3, depth: u32) -> Vec<CellProof> {
    fn copy(
        cells: &mut std::slice::Iter<CellProof>,
        (axis, sign): (usize, f64),
        ([u, v], size): ([f64; 2], f64),
        (normal, depth): (DVec3, u32),
        into: &mut Vec<CellProof>,
    ) {
        let quarter = |k: usize| {
            let half = 0.5 * size;
            ([u + half * (k & 1) as f64, v + half * (k >> 1) as f64], half)
        };
        let heights = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|[a, b]| {
            let mut d = DVec3::ZERO;
            (d[axis], d[(axis + 1) % 3], d[(axis + 2) % 3]) = (sign, u + a * size, v + b * size);
            normal.dot(d)
        });
        let is_crossed = heights.iter().any(|h| *h > 0.0) && heights.iter().any(|h| *h < 0.0);
        let cell = cells.next().expect("a cell");
        match cell {
            CellProof::Cut => {
                into.push(CellProof::Cut);
                for k in 0..4 {
                    copy(cells, (axis, sign), quarter(k), (normal, depth.saturating_sub(1)), into);
                }
            }
            CellProof::Open(_) if is_crossed && depth > 0 => {
                into.push(CellProof::Cut);
                let four = [const { CellProof::Cut }; 4].map(|_| cell.clone());
                for (k, one) in four.iter().enumerate() {
                    let mut one = std::slice::from_ref(one).iter();
                    copy(&mut one, (axis, sign), quarter(k), (normal, depth - 1), into);
                }
            }
            _ => into.push(cell.clone()),
        }
    }
    let (mut cells, mut into) = (cells.iter(), Vec::new());
    for side in 0..6 {
        let sign = if side % 2 == 0 { 1.0 } else { -1.0 };
        copy(&mut cells, (side / 2, sign), ([-1.0; 2], 2.0), (normal, depth), &mut into);
    }
    into
}

/// A plate between two plates is free along a great circle whose directions are rarely representable. In a proof with
/// many cells the arcs of this circle are too many to compare, and none is reported.
#[test]
fn record_without_reported_arcs_is_not_blocked() {
    let normal = DVec3::new(1009.0, 1013.0, 1019.0);
    let [u, v, w] = [DVec3::new(1013.0, -1009.0, 0.0), DVec3::new(1019.0, 0.0, -1009.0), DVec3::X];
    let plate = |size: f64, from: f64| {
        let corner = |k: u32| {
            let sign = |bit: u32| if k >> bit & 1 == 0 { -size } else { size };
            u * sign(0) + v * sign(1) + w * (from + f64::from(k >> 2 & 1))
        };
        let points: Vec<DVec3> = (0..8).map(corner).collect();
        Solid::from_convex(&ConvexPolyhedron::from_points(&points).expect("a plate"))
            .expect("a solid")
    };
    let walls = Solid::from_pieces(&[plate(4.0, -1.0), plate(4.0, 1.0)]).expect("two plates");
    let (middle, here) = (plate(1.0, 0.0), Pose::IDENTITY);
    let options = FreeOptions::default().with_no_tolerance();
    let free =
        FreeDirections::compute(&middle.at(here), &walls.at(here), options).expect("an answer");
    assert!(free.is_complete() && free.arcs().len() == 1 && !free.is_blocked());
    let outcome =
        |free: &FreeDirections| FreeRecord::from_directions(free, |_| [None, None]).outcome;
    assert_eq!(outcome(&free), Ending::Free);
    let proof = free.proof();
    let proof = FreeProof { cells: divided_along(&proof.cells, normal, 10), ..proof };
    let many = FreeDirections::from_trusted_proof(&middle.at(here), &walls.at(here), &proof);
    let many = many.expect("a proof");
    assert!(many.is_complete() && many.arcs().is_empty() && !many.is_blocked());
    assert!(many.free_among_undecided().is_empty() && many.regions().is_empty());
    assert_eq!(outcome(&many), Ending::Free);
}
