//! Claims of proof files about motions and paths that are weaker, or other, than what the file proves.
#![cfg(feature = "json")]

use colltrans::motion::path::{
    Frame, Joint, JointPath, Mechanism, PathBody, PathCast, PathProofFile,
};
use colltrans::motion::{
    Motion, MotionCast, MotionProofFile, MotionProofFiles, SolidMotionProofFile,
};
use colltrans::solid::AsSolid;
use colltrans::{ConvexPolyhedron, Pose, Solid};
use colltrans_testkit::shapes::Mesh;
use colltrans_testkit::solids::turned;
use glam::{DMat3, DQuat, DVec3};
use serde_json::{Value, json};

fn cube() -> ConvexPolyhedron {
    ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).expect("a cube")
}

fn at(x: f64) -> Pose {
    Pose::from_translation(DVec3::X * x).expect("a pose")
}

/// A cube that slides by 4 towards another one, 2 away from it, or keeps a gap.
fn sliding(keep: f64) -> Value {
    let (cube, motion) = (cube(), Motion::slide(Pose::IDENTITY, DVec3::X * 4.0).expect("a motion"));
    let cast = MotionCast::new(cube.along(&motion), cube.at(at(3.0))).expect("a cast");
    let cast = cast.keeping(keep).expect("a gap");
    let outcome = cast.first_contact().expect("an answer");
    serde_json::from_str(&MotionProofFile::of(&cast, &outcome).to_json()).expect("JSON")
}

/// What a proof of a motion says, if it holds.
fn says(file: &Value) -> Result<String, String> {
    let proof = MotionProofFile::from_json(&file.to_string()).map_err(|e| e.to_string())?;
    proof.check().map_err(|e| e.to_string())?;
    Ok(proof.to_string())
}

/// The file without a field, by its place.
fn without(file: &Value, under: &str, name: &str) -> Value {
    let mut less = file.clone();
    let of = less.pointer_mut(under).and_then(Value::as_object_mut).expect("an object");
    of.remove(name).expect("a field");
    less
}

/// The file with another value at a place.
fn with(file: &Value, at: &str, value: Value) -> Value {
    let mut other = file.clone();
    *other.pointer_mut(at).unwrap_or_else(|| panic!("no {at}")) = value;
    other
}

#[test]
fn a_meeting_without_planes_is_not_one_at_the_beginning() {
    let file = sliding(0.0);
    assert!(says(&file).expect("it holds").starts_with("the bodies first meet at a time between"));
    let weaker = says(&with(&file, "/proof/spans", json!([[]]))).expect("it holds");
    assert!(weaker.starts_with("the bodies meet by the time 0.5"), "{weaker}");
}

#[test]
fn a_piece_that_begins_when_the_motion_ends_is_refused() {
    let (cube, motion) = (cube(), Motion::slide(Pose::IDENTITY, DVec3::Y).expect("a motion"));
    let cast = MotionCast::new(cube.along(&motion), cube.at(at(3.0))).expect("a cast");
    let outcome = cast.first_contact().expect("an answer");
    let file = MotionProofFile::of(&cast, &outcome).to_json();
    let mut file: Value = serde_json::from_str(&file).expect("JSON");
    assert_eq!(says(&file).expect("free"), "the bodies never meet throughout the motion");
    // At the time 1 the body would be inside the other one.
    let mut last = file["moving_motion"][0].clone();
    last["since"] = json!(1.0);
    last["start"]["translation"] = json!([3.0, 0.0, 0.0]);
    file["moving_motion"].as_array_mut().expect("pieces").push(last);
    says(&file).expect_err("a piece of no time");
}

#[test]
fn what_may_be_null_has_to_be_there() {
    let file = sliding(0.0);
    says(&without(&file, "/proof", "meeting")).expect_err("no meeting");
    says(&with(&file, "/proof/meeting", Value::Null)).expect("none is claimed");
    let mut more = file.clone();
    more["proof"]["spans"][0][0]["more"] = json!(1);
    says(&more).expect_err("a field that is not known");
}

#[test]
fn pairs_of_one_question_keep_one_gap() {
    let several = |proofs: &[Value]| {
        let file = json!({"format": "colltrans motions proof 1", "proofs": proofs});
        let proofs = MotionProofFiles::from_json(&file.to_string()).map_err(|e| e.to_string())?;
        proofs.check().map_err(|e| e.to_string())?;
        Ok::<_, String>(proofs.to_string())
    };
    let [plain, kept] = [sliding(0.0), sliding(0.25)];
    let said = several(&[kept.clone(), kept.clone()]).expect("it holds");
    assert!(said.starts_with("of 2 pairs of bodies the first come as near as 0.25 at"), "{said}");
    // Of all of them it would be said that they do not come as near as 0.25.
    several(&[kept, plain]).expect_err("two gaps");
    several(&[]).expect_err("no pairs");
}

/// A block that turns into a post, both as solids.
fn turning() -> Value {
    let bar = ConvexPolyhedron::cuboid(DVec3::new(0.0, -0.1, 0.0), DVec3::new(2.0, 0.1, 0.2));
    let bar = Solid::from_convex(&bar.expect("a bar")).expect("a solid");
    let post = ConvexPolyhedron::cuboid(DVec3::splat(-0.1), DVec3::splat(0.3)).expect("a post");
    let post = Solid::from_convex(&post).expect("a solid");
    let turn = Motion::turn(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, std::f64::consts::PI);
    let turn = turn.expect("a turn");
    let still = Motion::still(Pose::from_translation(DVec3::Y * 1.5).expect("a pose"));
    let cast = MotionCast::<Solid>::new(bar.along(&turn), post.along(&still)).expect("a cast");
    let (_, file) = SolidMotionProofFile::answer(&cast).expect("an answer");
    serde_json::from_str(&file.to_json()).expect("JSON")
}

#[test]
fn a_facet_has_three_edges() {
    let file = turning();
    let holds = |file: &Value| {
        SolidMotionProofFile::from_json(&file.to_string()).is_ok_and(|proof| proof.check().is_ok())
    };
    assert!(holds(&file));
    let place = "/proof/meeting/met/crossing/edge";
    let edge = file.pointer(place).and_then(Value::as_u64).expect("an edge");
    assert!(!holds(&with(&file, place, json!(edge + 3))));
    for (under, name) in [("", "parts"), ("/proof", "meeting"), ("/proof", "start")] {
        assert!(!holds(&without(&file, under, name)), "{name}");
    }
}

/// Cubes at the places 3, 5 and 40 on the way of one that slides along x, from row to row.
fn cart(rows: &[f64]) -> Value {
    let cube = cube();
    let frame = Frame { parent: None, origin: Pose::IDENTITY, joint: Joint::Sliding(DVec3::X) };
    let slide = Mechanism::new(vec![frame]).expect("a mechanism");
    let path = JointPath::evenly(rows.iter().map(|x| vec![*x]).collect()).expect("a path");
    let mut bodies = vec![PathBody::carried(0, cube.at(Pose::IDENTITY))];
    bodies.extend([3.0, 5.0, 40.0].map(|x| PathBody::standing(cube.at(at(x)))));
    let pairs = vec![[0, 1], [0, 2], [0, 3]];
    let cast = PathCast::new(&slide, &path, bodies, pairs).expect("a cast");
    let names = ["cart".into(), "stop".into(), "wall".into()];
    let (_, file) = PathProofFile::answer(&cast, &names).expect("an answer");
    serde_json::from_str(&file.to_json()).expect("JSON")
}

/// What a proof of a path says, if it holds.
fn says_of_path(file: &Value) -> Result<String, String> {
    let proof = PathProofFile::from_json(&file.to_string()).map_err(|e| e.to_string())?;
    proof.check().map_err(|e| e.to_string())?;
    Ok(proof.to_string())
}

const PAIRS: &str = "of 3 pairs (cart and stop, cart and wall, cart and body 3)";

#[test]
fn a_path_names_its_pairs() {
    let file = cart(&[0.0, 8.0]);
    let said = says_of_path(&file).expect("it holds");
    assert!(said.starts_with(&format!("{PAIRS} none meet before the time 0.24999")), "{said}");
    assert!(said.contains(", and cart and stop meet by the time 0.25"), "{said}");
    for (place, value) in [
        ("/statement/pairs/0/1", json!("wall of another room")),
        ("/statement/pairs/0/1", json!("cart")),
        ("/statement/pairs", json!([["cart", "stop"]])),
        ("/bodies/1/name", json!("wall")),
        ("/bodies/1/name", json!("")),
    ] {
        says_of_path(&with(&file, place, value)).expect_err(place);
    }
}

#[test]
fn who_meets_later_is_not_said_to_meet_first() {
    // Only of the later contact it is known where it is; nothing is proven of the time before.
    let (one, both) = (cart(&[0.0, 8.0]), cart(&[3.9, 8.0]));
    let mut weak = one.clone();
    weak["proof"]["covers"] = json!([{"steps": []}, {"steps": []}, {"steps": []}]);
    weak["proof"]["meeting"]["pair"] = json!(1);
    weak["proof"]["meeting"]["place"]["share"] = json!(0.51);
    weak["statement"]["lower"] = json!(0.0);
    weak["statement"]["upper"] = json!(0.52);
    // Both cubes are the same; the surface around the origin is one of cubes that are 1/12 deep.
    weak["proof"]["meeting"]["how"] =
        with(&both, "/proof/meeting/pair", json!(1))["proof"]["meeting"]["how"].clone();
    if let Ok(said) = says_of_path(&weak) {
        assert!(!said.contains("first"), "{said}");
        assert!(said.contains("none meet before the time 0, and cart and wall"), "{said}");
    }
    let told = says_of_path(&one).expect("it holds");
    assert!(!told.contains("the first"), "{told}");
}

#[test]
fn a_path_of_one_row_is_free_by_planes_alone() {
    let file = cart(&[0.0]);
    let whole = format!("{PAIRS} none meet on the whole path, up to the time 0");
    assert_eq!(says_of_path(&file).expect("it holds"), whole);
    for k in 0..3 {
        let less = with(&file, &format!("/proof/covers/{k}/steps"), json!([]));
        let said = says_of_path(&less).expect("it says less");
        assert_eq!(said, format!("{PAIRS} nothing is said"));
    }
}

#[test]
fn places_are_on_the_path() {
    let file = cart(&[0.0, 8.0]);
    for (row, share) in [(u64::MAX, 1.0), (u64::MAX, 0.0), (2, 0.0), (1, 0.5), (0, 1.5), (0, -0.5)]
    {
        let place = json!({"row": row, "share": share});
        says_of_path(&with(&file, "/proof/meeting/place", place.clone()))
            .expect_err("off the path");
        let parts = json!([{"parts": {"which": 0, "until": place, "covers": []}}]);
        says_of_path(&with(&file, "/proof/covers/0/steps", parts)).expect_err("off the path");
    }
    for (under, name) in [
        ("/proof", "meeting"),
        ("/frames/0", "parent"),
        ("/bodies/0", "frame"),
        ("/statement", "pairs"),
        ("/statement", "upper"),
    ] {
        says_of_path(&without(&file, under, name)).expect_err(name);
    }
}

#[test]
fn traces_in_axes_are_no_reason_to_refuse() {
    let file = cart(&[0.0, 8.0]);
    let traced = with(&file, "/frames/0/joint/sliding", json!([1.0, 1e-310, 0.0]));
    says_of_path(&traced).expect("it holds");
}

/// Two rings of 14,400 facets that hang in each other: their cover is nested deeper than JSON is read by default.
#[test]
fn a_path_of_bodies_with_many_facets_is_read_back() {
    let profile: Vec<[f64; 2]> = (0..60)
        .map(|k| f64::from(k) * std::f64::consts::TAU / 60.0)
        .map(|a| [0.5 + 0.09 * a.cos(), 0.09 * a.sin()])
        .collect();
    let Mesh { vertices, faces } = turned(&profile, 120);
    let ring = Solid::from_mesh(&vertices, &faces).expect("a ring");
    let frame = Frame { parent: None, origin: Pose::IDENTITY, joint: Joint::Turning(DVec3::Z) };
    let hinge = Mechanism::new(vec![frame]).expect("a mechanism");
    let path = JointPath::evenly(vec![vec![0.0], vec![0.05], vec![0.1]]).expect("a path");
    let upright = DQuat::from_mat3(&DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X));
    let through = Pose::new(upright, DVec3::X * 0.5).expect("a pose");
    let bodies =
        vec![PathBody::carried(0, ring.at(Pose::IDENTITY)), PathBody::standing(ring.at(through))];
    let cast = PathCast::new(&hinge, &path, bodies, vec![[0, 1]]).expect("a cast");
    let (_, file) = PathProofFile::answer(&cast, &[]).expect("an answer");
    let text = file.to_json();
    assert!(serde_json::from_str::<Value>(&text).is_err(), "it is not nested that deep");
    let read = PathProofFile::from_json(&text).expect("a proof");
    assert_eq!(read.check().expect("it holds"), [2.0, f64::INFINITY]);
    let deeper = text.replacen("\"covers\":[", &format!("\"covers\":{}", "[".repeat(500)), 1);
    let refused = PathProofFile::from_json(&deeper).unwrap_err().to_string();
    assert!(refused.contains("nested more than 400 deep"), "{refused}");
}

/// A depth of two cubes that are apart, as a file has it: it proves that they overlap by at least 0.
fn depth_of_nothing(normal: [f64; 3]) -> Value {
    let enclosure = json!({"pairs": [], "triangles": [], "normals": []});
    json!({"deep": {"lower": 0.0, "upper": 0.0, "direction": normal, "enclosure": enclosure}})
}

#[test]
fn a_depth_of_nothing_does_not_prove_that_a_gap_is_used_up() {
    let file = sliding(1.0);
    for normal in [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
        for time in [0.0, 0.1] {
            let meeting = json!({"time": time, "met": depth_of_nothing(normal)});
            let mut forged = with(&file, "/proof/meeting", meeting);
            forged = with(&forged, "/proof/spans", json!([[]]));
            assert!(says(&forged).is_err(), "{:?}", says(&forged));
        }
    }
}

/// Of several pairs it is said that the bodies do not meet: none of them may be shrunk.
#[test]
fn a_pair_of_shrunk_solids_proves_nothing_of_the_bodies() {
    let cube = cube().as_solid().expect("a solid").clone();
    let motion = Motion::slide(Pose::IDENTITY, DVec3::X * 4.0).expect("a motion");
    let there = Pose::from_translation(DVec3::new(2.0, 0.75, 0.0)).expect("a pose");
    let cast = MotionCast::<Solid>::new(cube.along(&motion), cube.at(there)).expect("a cast");
    for (tolerance, holds) in [(0.0, true), (0.6, false)] {
        let cast = cast.clone().tolerating(tolerance).expect("a tolerance");
        let (_, file) = SolidMotionProofFile::answer(&cast).expect("an answer");
        let proof: Value = serde_json::from_str(&file.to_json()).expect("JSON");
        let several = json!({"format": "colltrans motions proof 1", "proofs": [proof]});
        let read = MotionProofFiles::from_json(&several.to_string());
        assert_eq!(read.is_ok(), holds, "{tolerance}");
    }
}
