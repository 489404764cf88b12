//! Proof files hold, and do not hold after a number of a claim is changed.

use colltrans_convex::{
    Cast, CertificateError, ConvexPolyhedron, ObstacleId, Pair, Pose, QueryError,
};
use colltrans_motion::path::{Frame, Joint, JointPath, Mechanism, PathBody, PathCast};
use colltrans_proof::{ProofError, ProofFile, ProofFileError, Statement};
use colltrans_scene::{Obstacles, SceneQuery};
use colltrans_solid::{AsSolid, Solid, SolidCast, SolidOptions, SolidPair, StartOverlap};
use colltrans_testkit::bodies::cuboid;
use colltrans_testkit::oracle::among;
use colltrans_testkit::oracle::settings::{FAMILIES, setting};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::random_hull;
use colltrans_testkit::solids::{bolt, turned, washer};
use glam::{DQuat, DVec3};
use serde_json::{Value, json};

use crate::common::solid;

/// Writes, reads and checks a proof.
fn assert_holds(proof: &ProofFile, of: &str) -> Value {
    let text = proof.to_json();
    let read = ProofFile::from_json(&text).unwrap_or_else(|e| panic!("{of}: {e}: {text}"));
    read.check().unwrap_or_else(|e| panic!("{of}: {e}: {text}"));
    assert_eq!((read.to_json(), read.to_string()), (text.clone(), proof.to_string()));
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn cast_proofs_of_all_families_hold() {
    for (family, ..) in FAMILIES {
        for seed in 0..20 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("bodies");
            let cast = setting.query(&bodies).expect("a query");
            let range = cast.contact_range().expect("an answer");
            assert_holds(&ProofFile::of_range(&cast, &range), family);
            let clearance = cast.clearance().expect("an answer");
            assert_holds(&ProofFile::of_clearance(&cast, &clearance), family);
        }
    }
}

#[test]
fn distance_and_depth_proofs_of_all_families_hold() {
    for (family, ..) in FAMILIES {
        for seed in 0..20 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("bodies");
            let cast = setting.query(&bodies).expect("a query");
            let moving = cast.moving().at(cast.moving_pose());
            let pair = Pair::new(moving, cast.fixed().at(cast.fixed_pose())).expect("a pair");
            let distance = pair.distance().expect("an answer");
            assert_holds(&ProofFile::of_distance(&pair, &distance), family);
            assert_holds(&ProofFile::of_depth(&pair, &pair.depth().expect("an answer")), family);
            for length in [0.5 * distance.lower, 2.0 * distance.upper, distance.lower] {
                let within = pair.within(length).expect("an answer");
                assert_holds(&ProofFile::of_distance(&pair, &within), family);
            }
        }
    }
}

#[test]
fn modified_distance_or_depth_proof_is_rejected() {
    let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).expect("a cube");
    let turn = DQuat::from_rotation_x(0.3) * DQuat::from_rotation_z(0.2);
    let proof = |x: f64| {
        let start = Pose::new(turn, DVec3::new(x, 0.25, 0.1)).expect("a pose");
        let pair = Pair::new(cube.at(start), cube.at(Pose::IDENTITY)).expect("a pair");
        let depth = ProofFile::of_depth(&pair, &pair.depth().expect("an answer"));
        let distance = pair.distance().expect("an answer");
        [ProofFile::of_distance(&pair, &distance), depth].map(|proof| assert_holds(&proof, "cubes"))
    };
    let both: [fn(f64) -> f64; 2] = [|x| x * 1.001 + 1e-3, |x| x * 0.999 - 1e-3];
    let up: [fn(f64) -> f64; 1] = [|x| x + 1e-9];
    let down: [fn(f64) -> f64; 1] = [|x| x - 1e-9];
    let [apart, _] = proof(-3.1);
    for place in ["gap/normal", "near/weights"] {
        let place = format!("/statement/distance/{place}");
        assert_eq!(undetected_changes(&apart, &place, &both), [""; 0], "{place}");
    }
    assert_eq!(undetected_changes(&apart, "/statement/distance/gap/gap", &up), [""; 0]);
    assert_eq!(undetected_changes(&apart, "/statement/distance/near/distance", &down), [""; 0]);
    let [meeting, depth] = proof(-0.3);
    assert_eq!(undetected_changes(&meeting, "/statement/distance/near/distance", &down), [""; 0]);
    assert_eq!(undetected_changes(&depth, "/statement/depth/lower", &up), [""; 0]);
    assert_eq!(undetected_changes(&depth, "/statement/depth/upper", &down), [""; 0]);
    let other: [fn(f64) -> f64; 1] = [|x| x + 0.01];
    assert_eq!(undetected_changes(&depth, "/statement/depth/direction", &other), [""; 0]);
    assert_eq!(undetected_changes(&depth, "/statement/depth/enclosure/normals", &other), [""; 0]);
    assert_eq!(undetected_changes(&depth, "/statement/depth/enclosure/triangles", &other), [""; 0]);
}

/// A distance has no direction, a cast has one, and the bodies have the kind of the statement.
#[test]
fn mismatched_statement_query_or_placement_is_rejected() {
    let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).expect("a cube");
    let start = Pose::from_translation(DVec3::new(-3.0, 0.25, 0.5)).expect("a pose");
    let pair = Pair::new(cube.at(start), cube.at(Pose::IDENTITY)).expect("a pair");
    let proof = ProofFile::of_distance(&pair, &pair.distance().expect("an answer"));
    let file = assert_holds(&proof, "cubes");
    let read = |file: &Value| ProofFile::from_json(&file.to_string());
    let is_refused = |file: &Value| matches!(read(file), Err(ProofFileError::Statement));
    let of = |name: &str, value: Value| {
        let mut other = file.clone();
        other[name] = value;
        other
    };
    let cast = cube_proof(&cube, 0.3);
    for query in [&cast["query"], &json!({"scene": {"start_overlap": "refuse"}})] {
        assert!(is_refused(&of("query", query.clone())), "{query}");
    }
    for query in [json!({"motions": [{"min_gap": 0.0}]}), json!({"motions": []})] {
        assert!(is_refused(&of("query", query)));
    }
    assert!(is_refused(&of("placement", json!({"motions": []}))));
    let mut undirected = cast.clone();
    undirected["query"] = json!("pair");
    assert!(is_refused(&undirected));
    assert!(is_refused(&of("statement", json!({"distance": {}}))));
    assert!(is_refused(&of("statement", json!({"motions": []}))));
    for places in [0, 1, 3] {
        let place = &file["placement"]["poses"][0];
        assert!(is_refused(&of("placement", json!({"poses": vec![place; places]}))), "{places}");
    }
    let mut two = file.clone();
    two["statement"]["separation"] = json!({"normal": [1, 0, 0], "margin": 1});
    let nothing = of("statement", json!({}));
    for choice in [two, nothing, of("query", json!({})), of("placement", json!({}))] {
        assert!(matches!(read(&choice), Err(ProofFileError::Choice(_))), "{:?}", read(&choice));
    }
    for (version, found) in [(json!(1), Some(1)), (json!(3), Some(3)), (Value::Null, None)] {
        let refused = read(&of("version", version)).expect_err("another version");
        assert!(matches!(refused, ProofFileError::Version { found: of } if of == found));
    }
    assert!(read(&of("version", json!(2.0))).is_err() && read(&of("more", json!(1))).is_err());
}

fn is_rejected(file: &Value) -> bool {
    let text = file.to_string();
    ProofFile::from_json(&text).map_or(true, |proof| proof.check().is_err())
}

#[test]
fn scene_proofs_of_all_families_hold() {
    let (mut nearest, mut shared) = (0, 0);
    for family in among::FAMILIES {
        for seed in 0..30 {
            let setting = among::Setting::draw(family, seed).expect("a setting");
            let (direction, length) = setting.questions();
            let own = |id: ObstacleId| id.0 % 4 == 3;
            for asked in
                [setting.asked().expect("a scene")].map(|all| [all, all.ignoring(&own)]).concat()
            {
                let found = ProofFile::of_nearest(&asked).expect("an answer");
                nearest += usize::from(found.is_some());
                for proof in [
                    found,
                    Some(ProofFile::of_within(&asked, length).expect("an answer")),
                    Some(ProofFile::of_scene_clearance(&asked, direction).expect("an answer")),
                ]
                .into_iter()
                .flatten()
                {
                    let file = assert_holds(&proof, family);
                    let count = |of: &Value| of.as_array().expect("a list").len();
                    let places = count(&file["placement"]["poses"]);
                    assert_eq!(proof.obstacle_count(), Some(asked.queried_count()));
                    assert_eq!(places, 1 + asked.queried_count());
                    shared += usize::from(count(&file["bodies"]) + 1 < places);
                }
            }
        }
    }
    assert!(nearest > 200 && shared > 200, "{nearest}, {shared}");
}

/// A row of cubes and a washer, with a cube above the third one. Every change weakens the proof.
#[test]
fn modified_scene_proof_is_rejected() {
    let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).expect("a cube");
    let mut row = Obstacles::new();
    for k in 0..4 {
        let place = DVec3::new(2.5 * f64::from(k), 0.1, 0.2);
        row.insert(cube.clone(), Pose::new(DQuat::from_rotation_x(0.1), place).expect("a pose"));
    }
    row.insert(
        solid(&washer([0.5, 1.0], [0.0, 0.5], 8)),
        Pose::from_translation(DVec3::X * 30.0).expect("a pose"),
    );
    let start = Pose::from_translation(DVec3::new(5.25, 0.1, 4.0)).expect("a pose");
    let asked = SceneQuery::new(cube.at(start), &row).expect("a scene");
    let down = DVec3::new(0.0, 0.01, -1.0);
    let [nearest, within, stop] = [
        ProofFile::of_nearest(&asked).map(|found| found.expect("there are some")),
        ProofFile::of_within(&asked, 3.5),
        ProofFile::of_scene_clearance(&asked, down),
    ]
    .map(|proof| assert_holds(&proof.expect("an answer"), "a row"));
    let up: [fn(f64) -> f64; 1] = [|x| x + 1e-9];
    let down: [fn(f64) -> f64; 1] = [|x| x - 1e-9];
    let far: [fn(f64) -> f64; 1] = [|x| x + 9.0];
    assert_eq!(undetected_changes(&nearest, "/statement/nearest/lower", &up), [""; 0]);
    assert_eq!(
        undetected_changes(&nearest, "/statement/nearest/near/convex/distance", &down),
        [""; 0]
    );
    assert_eq!(undetected_changes(&nearest, "/statement/nearest/obstacle", &far), [""; 0]);
    assert_eq!(undetected_changes(&within, "/statement/within/length", &far), [""; 0]);
    assert_eq!(undetected_changes(&within, "/statement/within/closer/0/0", &far), [""; 0]);
    assert_eq!(undetected_changes(&stop, "/statement/scene_clearance/lower", &up), [""; 0]);
    assert_eq!(undetected_changes(&stop, "/statement/scene_clearance/stop", &far), [""; 0]);
    for file in [&nearest, &within, &stop] {
        // A cube in another place: the nearest one, or one that is now in the way.
        let mut moved = file.clone();
        moved["placement"]["poses"][3] = file["placement"]["poses"][1].clone();
        assert!(is_rejected(&moved));
        let mut near = file.clone();
        near["placement"]["poses"][1]["pose"] = file["placement"]["poses"][0]["pose"].clone();
        assert!(is_rejected(&near), "a cube at the place of the moving one");
        let mut fewer = file.clone();
        fewer["placement"]["poses"].as_array_mut().expect("places").truncate(1);
        assert!(is_rejected(&fewer));
        let mut other = file.clone();
        other["statement"] = json!({"nearest": {}, "within": {}});
        assert!(is_rejected(&other));
    }
    // An obstacle has one claim, a length must be valid, and every claim is checked.
    let false_gap = json!({"convex": {"normal": [1.0, 0.0, 0.0], "gap": 1e9}});
    let mut twice = within.clone();
    let close = within["statement"]["within"]["closer"][0][0].clone();
    twice["statement"]["within"]["apart"] = json!([[close, false_gap]]);
    assert!(is_rejected(&twice));
    let mut open = within.clone();
    open["statement"]["within"]["undecided"] = json!([close]);
    assert!(is_rejected(&open));
    let mut none_closer = within.clone();
    none_closer["statement"]["within"]["closer"] = json!([]);
    none_closer["statement"]["within"]["length"] = json!(-1.0);
    assert!(is_rejected(&none_closer));
    let mut unclaimed = nearest.clone();
    unclaimed["statement"]["nearest"]["lower"] = json!(0.0);
    unclaimed["statement"]["nearest"]["apart"] = json!([[0, false_gap]]);
    assert!(is_rejected(&unclaimed));
    // A weaker bound does not mean that the obstacle stops the body at once or is the nearest one.
    let text_of =
        |file: &Value| ProofFile::from_json(&file.to_string()).expect("a proof").to_string();
    let mut weak = stop.clone();
    weak["statement"]["scene_clearance"]["lower"] = json!(0.0);
    assert!(!is_rejected(&weak) && !text_of(&weak).contains("overlaps"), "{}", text_of(&weak));
    assert!(text_of(&stop).contains("obstacle 2 does by 2."), "{}", text_of(&stop));
    let mut missing = stop.clone();
    missing["statement"]["scene_clearance"].as_object_mut().expect("a claim").remove("stop");
    assert!(is_rejected(&missing));
    let mut far = nearest.clone();
    far["statement"]["nearest"]["lower"] = json!(0.5);
    assert!(text_of(&far).ends_with("none is nearer than 0.5"), "{}", text_of(&far));
    let mut none = nearest;
    none["placement"]["poses"][1]["body"] = json!(7);
    let error = ProofFile::from_json(&none.to_string()).expect_err("there is no such body");
    assert_eq!(
        error.to_string(),
        "a place refers to body 7; the file has 6 bodies, counted from 0"
    );
}

/// Changes every number below a pointer, one at a time. Returns the changes after which the proof still
/// holds.
fn undetected_changes(file: &Value, pointer: &str, changes: &[fn(f64) -> f64]) -> Vec<String> {
    let mut found = Vec::new();
    match file.pointer(pointer).expect("it is there") {
        Value::Object(fields) => {
            for name in fields.keys() {
                found.extend(undetected_changes(file, &format!("{pointer}/{name}"), changes));
            }
        }
        Value::Array(list) => {
            for k in 0..list.len() {
                found.extend(undetected_changes(file, &format!("{pointer}/{k}"), changes));
            }
        }
        Value::Number(number) => {
            let whole = number.is_u64();
            let number = number.as_f64().expect("a number");
            for change in changes {
                let mut wrong = file.clone();
                let changed = change(number);
                *wrong.pointer_mut(pointer).expect("it is there") =
                    if whole { json!(number as u64 + 1) } else { json!(changed) };
                if !is_rejected(&wrong) {
                    found.push(format!("{pointer}: {changed:?} for {number:?}"));
                }
            }
        }
        _ => {}
    }
    found
}

fn cube_proof(body: &ConvexPolyhedron, y: f64) -> Value {
    let turn = DQuat::from_rotation_x(0.3) * DQuat::from_rotation_z(0.2);
    let start = Pose::new(turn, DVec3::new(-3.1, y, 0.1)).expect("a pose");
    let cast = Cast::new(body.at(start), body.at(Pose::IDENTITY), DVec3::new(1.0, 0.1, 0.2))
        .expect("a direction");
    assert_holds(&ProofFile::of_range(&cast, &cast.contact_range().expect("an answer")), "cubes")
}

#[test]
fn modified_cast_proof_is_rejected() {
    let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).expect("a cube");
    let file = cube_proof(&cube, 0.3);
    let both: [fn(f64) -> f64; 2] = [|x| x * 1.001 + 1e-3, |x| x * 0.999 - 1e-3];
    for place in ["/placement/poses/0/pose", "/placement/poses/1/pose", "/query/cast/direction"] {
        assert_eq!(undetected_changes(&file, place, &both), [""; 0], "{place}");
    }
    for end in ["first", "last"] {
        let end = format!("/statement/contacts/{end}");
        for place in ["normal", "pairs", "weights"] {
            assert_eq!(
                undetected_changes(&file, &format!("{end}/{place}"), &both),
                [""; 0],
                "{place}"
            );
        }
        // A weaker claim than the proven one also holds.
        let up: [fn(f64) -> f64; 1] = [|x| x + 1e-9];
        let down: [fn(f64) -> f64; 1] = [|x| x - 1e-9];
        assert_eq!(undetected_changes(&file, &format!("{end}/lower"), &up), [""; 0]);
        assert_eq!(undetected_changes(&file, &format!("{end}/rounding"), &up), [""; 0]);
        assert_eq!(undetected_changes(&file, &format!("{end}/upper"), &down), [""; 0]);
        let weaker: [fn(f64) -> f64; 1] = [|x| x + 0.5];
        assert_eq!(undetected_changes(&file, &format!("{end}/upper"), &weaker).len(), 1);
    }
    let apart = cube_proof(&cube, 3.0);
    let up: [fn(f64) -> f64; 1] = [|x| x + 1e-9];
    assert_eq!(undetected_changes(&apart, "/statement/separation/margin", &up), [""; 0]);
    assert_eq!(undetected_changes(&apart, "/statement/separation/normal", &both), [""; 0]);
}

fn text_of(file: &Value) -> String {
    ProofFile::from_json(&file.to_string()).expect("a proof").to_string()
}

/// Cubes with coplanar sides, and cubes that overlap by less than the graze tolerance.
#[test]
fn sliding_bodies_report_slide() {
    let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).expect("a cube");
    for (y, graze, overlap) in [(1.0, 0.0, 0.0), (0.875, 0.25, 0.125)] {
        let start = Pose::from_translation(DVec3::new(-3.0, y, 0.25)).expect("a pose");
        let cast = Cast::new(cube.at(start), cube.at(Pose::IDENTITY), DVec3::X)
            .and_then(|cast| cast.with_graze_tolerance(graze))
            .expect("a cast");
        let clearance = cast.clearance().expect("an answer");
        let outcome = cast.first_contact().expect("an answer");
        let file = assert_holds(&ProofFile::of_clearance(&cast, &clearance), "a slide");
        assert_eq!(file, assert_holds(&ProofFile::of_outcome(&cast, &outcome), "a slide"));
        let range = cast.contact_range().expect("an answer");
        let both = assert_holds(&ProofFile::of_range(&cast, &range), "a slide");
        assert!(text_of(&both).contains("; the bodies meet "), "{}", text_of(&both));
        let slide = "/statement/contacts/slide";
        let told = file.pointer(&format!("{slide}/overlap")).and_then(Value::as_f64);
        assert!(told.is_some_and(|told| (told - overlap).abs() < 1e-14), "{told:?}");
        let words = "the bodies slide along each other, their shadows overlap by";
        assert!(text_of(&file).starts_with(words), "{}", text_of(&file));
        let less: [fn(f64) -> f64; 1] = [|x| x - 1e-12];
        assert_eq!(undetected_changes(&file, &format!("{slide}/overlap"), &less), [""; 0]);
        let other: [fn(f64) -> f64; 1] = [|x| x + 0.1];
        assert_eq!(undetected_changes(&file, &format!("{slide}/normal"), &other), [""; 0]);
        assert_eq!(undetected_changes(&file, &format!("{slide}/overlap"), &other).len(), 1);
        let mut alone = file;
        alone["statement"]["contacts"].as_object_mut().expect("it").remove("first");
        assert!(ProofFile::from_json(&alone.to_string()).is_err(), "no contact is claimed");
    }
}

/// The moving body is slightly larger.
#[test]
fn proof_with_enlarged_body_is_rejected() {
    let small = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).expect("a cube");
    let file = cube_proof(&small, 0.3);
    let mut wrong = file.clone();
    for k in 0..8 {
        let x = wrong.pointer_mut(&format!("/bodies/0/convex/vertices/{k}/0")).expect("a vertex");
        *x = json!(x.as_f64().expect("a number") * 1.001);
    }
    assert!(is_rejected(&wrong));
}

fn bolt_and_washer() -> [Solid; 2] {
    [solid(&bolt([1.0, 2.0], [-5.0, 8.0, 9.0], 12)), solid(&washer([1.5, 4.0], [0.0, 1.0], 9))]
}

fn bolt_and_washer_proof(
    [a, b]: &[Solid; 2],
    at: DVec3,
    direction: DVec3,
    tolerance: f64,
) -> Value {
    let pose = Pose::from_translation(at).expect("in range");
    let cast = Cast::new(a.at(pose), b.at(Pose::IDENTITY), direction).expect("a direction");
    let cast = cast.with_tolerance(tolerance).expect("a tolerance");
    let proof = ProofFile::of_solids(&cast, [&[a], &[b]]).expect("their own facets");
    let Statement::Clearance(said) = proof.statement() else { panic!("solids") };
    assert_eq!(
        said.stop.is_some(),
        matches!(cast.clearance(), Ok(colltrans_convex::Clearance::Blocked { .. }))
    );
    assert_holds(&proof, "parts")
}

#[test]
fn solid_proofs_hold_and_modified_ones_are_rejected() {
    let parts = bolt_and_washer();
    for tolerance in [0.0, 1e-6] {
        let down =
            bolt_and_washer_proof(&parts, DVec3::new(0.01, 0.02, 0.0), DVec3::NEG_Z, tolerance);
        let far: [fn(f64) -> f64; 1] = [|x| x + 0.01];
        for place in [
            "/placement/poses/0/pose",
            "/placement/poses/1/pose",
            "/query/cast/direction",
            "/statement/clearance/certificate",
        ] {
            // The bolt has lateral play, and the same facets stop it.
            let mut found = undetected_changes(&down, place, &far);
            found.retain(|place| {
                !place.contains("translation/0") && !place.contains("translation/1")
            });
            assert_eq!(found, [""; 0], "{place}");
        }
        assert_eq!(undetected_changes(&down, "/statement/clearance/stop/facets", &far), [""; 0]);
        assert_eq!(
            undetected_changes(&down, "/statement/clearance/stop/translation/lower", &far),
            [""; 0]
        );
        let lost: [fn(f64) -> f64; 1] = [|x| x - 0.01];
        assert_eq!(
            undetected_changes(&down, "/statement/clearance/stop/translation/upper", &lost),
            [""; 0]
        );
        bolt_and_washer_proof(&parts, DVec3::X, DVec3::Z, tolerance);
        let free = bolt_and_washer_proof(&parts, DVec3::X * 9.0, DVec3::Z, tolerance);
        assert!(free.pointer("/statement/clearance/separation").is_some());
        assert_eq!(undetected_changes(&free, "/statement/clearance/separation", &far), [""; 0]);
        let mut wrong = down;
        wrong["statement"]["clearance"].as_object_mut().expect("it").remove("stop");
        assert!(is_rejected(&wrong), "the certificate names a stop");
        let mut wrong = free;
        wrong["statement"]["clearance"]["certificate"]["cover"] = json!("s");
        assert!(is_rejected(&wrong));
    }
}

#[test]
fn missing_and_wrong_bounds_of_stop_are_reported() {
    let place = "/statement/clearance/stop/translation";
    let file =
        bolt_and_washer_proof(&bolt_and_washer(), DVec3::new(0.01, 0.02, 0.0), DVec3::NEG_Z, 0.0);
    let with = |lower: Value, upper: Value| {
        let mut other = file.clone();
        let translation = other.pointer_mut(place).expect("a stop");
        (translation["lower"], translation["upper"]) = (lower, upper);
        ProofFile::from_json(&other.to_string()).expect("a proof")
    };
    let (low, high) = (json!(0.0), json!(9.0));
    for (proof, words) in [
        (
            with(low.clone(), high.clone()),
            "the blocking facets meet in nominal position between 0.0 and 9.0",
        ),
        (with(Value::Null, high), "the blocking facets meet in nominal position by 9.0"),
        (with(low, Value::Null), "the blocking facets meet in nominal position not before 0.0"),
        (
            with(Value::Null, Value::Null),
            "no claim is made where the blocking facets meet in nominal position",
        ),
    ] {
        proof.check().expect("less than is proven");
        assert!(proof.to_string().ends_with(words), "{proof}");
    }
    let mut wrong = file.clone();
    *wrong.pointer_mut(&format!("{place}/value")).expect("a value") = json!(6.5);
    let wrong = ProofFile::from_json(&wrong.to_string()).expect("a proof");
    let told = wrong.check().expect_err("outside").to_string();
    assert!(told.starts_with("the translation 6.5 is not between its bounds, "), "{told}");
}

#[test]
fn inverted_facets_at_default_tolerance_of_scene_are_reported() {
    // A cup that is far smaller than the tolerance of rotated bodies, beside a block.
    let profile = [[0.0, 0.0], [9.0, 0.0], [9.0, 6.0], [7.0, 6.0], [7.0, 1.0], [0.0, 1.0]];
    let cup = turned(&profile.map(|point| point.map(|x| x * 1e-14)), 12);
    let block = cuboid([1.0, 0.0, 0.0], [2.0, 1.0, 1.0]);
    let both = Solid::from_pieces([&solid(&cup), &block]).expect("a solid");
    let mut obstacles = Obstacles::new();
    obstacles.insert(block.clone(), Pose::from_translation(DVec3::Y * 50.0).expect("a pose"));
    let turn = DQuat::from_rotation_z(0.3);
    obstacles.insert(both, Pose::new(turn, DVec3::ZERO).expect("a pose"));
    let place = Pose::from_translation(DVec3::new(0.5, 0.5, 9.0)).expect("a pose");
    let query = |options| {
        let query = SceneQuery::new(block.at(place), &obstacles).expect("a query");
        let query = query.with_solid_options(options);
        ProofFile::of_scene_clearance(&query, DVec3::NEG_Z).expect("a proof")
    };
    let exact = query(SolidOptions::default().with_tolerance(Some(0.0)));
    assert_eq!(exact.inverted_facets(), [0, 0]);
    let default = query(SolidOptions::default());
    let [moving, fixed] = default.inverted_facets();
    assert!(moving == 0 && fixed > 0, "{moving} {fixed}");
    assert!(default.to_string().contains(&format!("and {fixed} of fixed ones are")), "{default}");
}

#[test]
fn inverted_facets_of_offset_bodies_are_reported() {
    let parts = bolt_and_washer();
    let proof = |tolerance| {
        let file =
            bolt_and_washer_proof(&parts, DVec3::new(0.01, 0.02, 40.0), DVec3::NEG_Z, tolerance);
        ProofFile::from_json(&file.to_string()).expect("a proof")
    };
    assert_eq!(proof(0.25).inverted_facets(), [0, 0]);
    assert!(!proof(0.25).to_string().contains("inside out"));
    // The washer of thickness 1 would vanish. The bottom of the cup has the same thickness, but its walls remain.
    let profile = [[0.0, 0.0], [9.0, 0.0], [9.0, 6.0], [7.0, 6.0], [7.0, 1.0], [0.0, 1.0]];
    let parts = [solid(&bolt([1.0, 2.0], [-5.0, 8.0, 9.0], 12)), solid(&turned(&profile, 12))];
    let file = bolt_and_washer_proof(&parts, DVec3::new(0.01, 0.02, 40.0), DVec3::NEG_Z, 1.5);
    let inside_out = ProofFile::from_json(&file.to_string()).expect("a proof");
    let [bolt, cup] = inside_out.inverted_facets();
    assert!(cup > 0, "{cup}");
    let words =
        format!("; at this offset {bolt} facets of moving bodies and {cup} of fixed ones are");
    assert!(inside_out.to_string().contains(&words), "{inside_out}");

    let mut obstacles = Obstacles::new();
    obstacles.insert(parts[1].clone(), Pose::IDENTITY);
    let place = Pose::from_translation(DVec3::new(0.01, 0.02, 40.0)).expect("a pose");
    let options = SolidOptions::default().with_tolerance(Some(1.5));
    let among = SceneQuery::new(parts[0].at(place), &obstacles).expect("a query");
    let file = ProofFile::of_scene_clearance(&among.with_solid_options(options), DVec3::NEG_Z);
    let file = file.expect("a proof");
    assert_eq!(file.inverted_facets(), [bolt, cup]);
    assert!(file.to_string().contains(&words), "{file}");
}

#[test]
fn undecided_obstacles_are_listed_separately() {
    let mut obstacles = Obstacles::new();
    let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).expect("a cube");
    for x in [2.0, 3.0] {
        obstacles.insert(cube.clone(), Pose::from_translation(DVec3::X * x).expect("a pose"));
    }
    let among = SceneQuery::new(cube.at(Pose::IDENTITY), &obstacles).expect("a query");
    let file = ProofFile::of_within(&among, 2.5).expect("a proof");
    assert_eq!(
        file.to_string(),
        "of 2 obstacles, 2 (0, 1) are at most 2.5 away, all others are farther"
    );
    let mut file: Value = serde_json::from_str(&file.to_json()).expect("JSON");
    let claim = &mut file["statement"]["within"];
    claim["closer"].as_array_mut().expect("a list").pop();
    claim["undecided"] = json!([1]);
    let proof = ProofFile::from_json(&file.to_string()).expect("a proof");
    proof.check().expect("it holds");
    let words = "1 (0) is proven to be at most 2.5 away, 1 (1) may be, all others are farther";
    assert_eq!(proof.to_string(), format!("of 2 obstacles, {words}"));
}

#[test]
fn proof_of_vanished_offset_body_is_rejected() {
    let mut file = bolt_and_washer_proof(&bolt_and_washer(), DVec3::Z * 40.0, DVec3::NEG_Z, 0.5);
    file["statement"]["clearance"]["certificate"]["tolerance"] = 2.0.into();
    let proof = ProofFile::from_json(&file.to_string()).expect("a proof");
    let refused = proof.check().expect_err("nothing is left of the washer");
    assert!(
        matches!(
            refused,
            ProofError::Certificate(CertificateError::Query(QueryError::NothingLeft { .. }))
        ),
        "{refused}"
    );
}

#[test]
fn stop_with_other_facets_is_rejected() {
    let mut file = bolt_and_washer_proof(&bolt_and_washer(), DVec3::Z * 40.0, DVec3::NEG_Z, 0.0);
    let stop = &mut file["statement"]["clearance"]["stop"]["facets"][0];
    *stop = (stop.as_u64().expect("a number") + 1).into();
    let proof = ProofFile::from_json(&file.to_string()).expect("a proof");
    let refused = proof.check().expect_err("another facet");
    assert!(
        matches!(refused, ProofError::Certificate(CertificateError::OtherFacets { .. })),
        "{refused}"
    );
}

/// Returns a statement about solids.
fn solid_claim() -> Value {
    bolt_and_washer_proof(&bolt_and_washer(), DVec3::ZERO, DVec3::NEG_Z, 0.0)["statement"].take()
}

/// The default tolerance offsets both bodies, and the bounds of the answer come from their hulls.
#[test]
fn convex_solids_have_proof_with_default_tolerance() {
    let mut random = Random::new(3);
    let mut blocked = 0;
    for _ in 0..200 {
        let [a, b] = [0, 1].map(|_| {
            let count = random.pick(&[4, 8, 20]);
            let hull = ConvexPolyhedron::from_points(&random_hull(count, &mut random).vertices);
            Solid::from_convex(&hull.expect("a body")).expect("closed")
        });
        let mut pose = |at| {
            let turn = if random.one_in(2) { random.rotation() } else { DQuat::IDENTITY };
            Pose::new(turn, at + random.direction() * 0.3).expect("a pose")
        };
        let [start, target] = [DVec3::Z * 5.0, DVec3::ZERO].map(&mut pose);
        let cast = Cast::new(a.at(start), b.at(target), DVec3::NEG_Z).expect("a query");
        let proof = ProofFile::of_solids(&cast, [&[&a], &[&b]]).expect("a proof");
        assert_holds(&proof, "convex bodies");
        blocked +=
            i32::from(matches!(cast.clearance(), Ok(colltrans_convex::Clearance::Blocked { .. })));
    }
    assert!(blocked > 100, "{blocked} contacts");
}

#[test]
fn rotated_unions_have_proof_and_wrong_pieces_are_rejected() {
    let [bolt, washer] = bolt_and_washer();
    let cube = ConvexPolyhedron::cuboid(DVec3::new(-0.5, -0.5, 8.5), DVec3::new(0.5, 0.5, 12.0));
    let cube = Solid::from_convex(&cube.expect("a cube")).expect("closed");
    let union = Solid::from_pieces([&bolt, &cube]).expect("pieces");
    let turn = DQuat::from_rotation_z(0.4) * DQuat::from_rotation_x(0.2);
    for (at, ignore) in [(DVec3::Z * 20.0, false), (DVec3::X, true)] {
        let pose = Pose::new(turn, at).expect("a pose");
        let mut cast = Cast::new(union.at(pose), washer.at(Pose::IDENTITY), DVec3::NEG_Z)
            .expect("a direction");
        if ignore {
            cast = cast.with_start_overlap(StartOverlap::Ignore);
        }
        let proof = ProofFile::of_solids(&cast, [&[&bolt, &cube], &[&washer]]).expect("a proof");
        assert_holds(&proof, "a union");
        let wrong = ProofFile::of_solids(&cast, [&[&bolt], &[&washer]]);
        assert!(matches!(wrong, Err(ProofFileError::Changed { body: 0 })));
    }
}

#[test]
fn invalid_files_are_rejected_with_reason() {
    let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).expect("a cube");
    let file = cube_proof(&cube, 0.3);
    let text = file.to_string();
    let text_of = |text: &str| ProofFile::from_json(text).expect_err("no proof").to_string();
    assert!(text_of(&text[..text.len() / 2]).contains("it ends too early"));
    assert!(text_of("solid cube").contains("it is not JSON"));
    assert!(text_of("{}").contains("a saved proof"));
    assert_eq!(
        text_of(&text.replace("colltrans proof", "colltrans proof 1")),
        "the format is \"colltrans proof 1\", not \"colltrans proof\"; --save-proof writes the files that are accepted"
    );
    let older = text.replace("\"version\":2", "\"version\":1");
    assert_eq!(text_of(&older), "the version of the format is 1, not 2");
    let fit = "the statement must make a claim and fit the query";
    let mut mixed = file.clone();
    mixed["bodies"][0] =
        bolt_and_washer_proof(&bolt_and_washer(), DVec3::Z * 40.0, DVec3::NEG_Z, 0.0)["bodies"][0]
            .take();
    assert!(text_of(&mixed.to_string()).starts_with(fit));
    mixed["bodies"][1] = json!({"pieces": []});
    assert!(text_of(&mixed.to_string()).starts_with("body 1: "));
    let mut both = file["statement"].clone();
    both["separation"] = json!({"normal": [0, 1, 0], "margin": 1});
    for (says, why) in [
        (json!({"contacts": {}}), fit),
        (solid_claim(), fit),
        (json!({}), "not a saved proof: line 1, column "),
        (both, "not a saved proof: line 1, column "),
    ] {
        let mut wrong = file.clone();
        wrong["statement"] = says;
        assert!(text_of(&wrong.to_string()).starts_with(why), "{}", text_of(&wrong.to_string()));
    }
    let large = text.replacen("-3.1", "1e999", 1);
    assert!(text_of(&large).contains("a number is larger than any double"), "{}", text_of(&large));
    let mut open = bolt_and_washer_proof(&bolt_and_washer(), DVec3::ZERO, DVec3::NEG_Z, 0.0);
    let triangles = open.pointer_mut("/bodies/1/pieces/0/triangles").expect("triangles");
    triangles.as_array_mut().expect("a list").pop();
    let told = text_of(&open.to_string());
    assert!(told.starts_with("body 1: the surface is open") && !told.contains("::"), "{told}");
    let mut still = file;
    still["query"]["cast"]["direction"] = json!([0.0, 0.0, 0.0]);
    assert!(text_of(&still.to_string()).contains("direction"));
}

#[test]
fn solid_distance_proofs_hold_and_modified_ones_are_rejected() {
    let [a, b] = bolt_and_washer();
    let place = |z: f64| Pose::from_translation(DVec3::new(0.25, 0.125, z)).expect("in range");
    let far: [fn(f64) -> f64; 1] = [|x| x + 0.01];
    let near: [fn(f64) -> f64; 1] = [|x| x - 0.01];
    for (z, within) in [(12.0, None), (12.0, Some(0.5)), (12.0, Some(100.0)), (0.0, None)] {
        let pair = Pair::new(a.at(place(z)), b.at(Pose::IDENTITY)).expect("a pair");
        let proof = ProofFile::of_solid_distance(&pair, [&[&a], &[&b]], within).expect("an answer");
        let Statement::SolidDistance(said) = proof.statement() else { panic!("solids") };
        assert_eq!(said.cover.is_empty(), within == Some(100.0), "{within:?}");
        let file = assert_holds(&proof, "parts");
        let of = "/statement/solid_distance";
        assert_eq!(undetected_changes(&file, &format!("{of}/lower"), &far), [""; 0]);
        assert_eq!(
            undetected_changes(&file, &format!("{of}/near/points/distance"), &near),
            [""; 0]
        );
        assert_eq!(undetected_changes(&file, &format!("{of}/near/points/weights"), &near), [""; 0]);
    }
    let pair = Pair::new(a.at(place(1.0)), b.at(place(0.0))).expect("a pair");
    let other = ProofFile::of_solid_distance(&pair, [&[&b], &[&b]], None);
    assert!(matches!(other, Err(ProofFileError::Changed { body: 0 })), "{other:?}");
    let negative = ProofFile::of_solid_distance(&pair, [&[&a], &[&b]], Some(-1.0));
    assert!(
        matches!(negative, Err(ProofFileError::Query(QueryError::Length { .. }))),
        "{negative:?}"
    );
}

/// The checker in fractions requires the same.
#[test]
fn path_proof_with_non_unit_axis_is_rejected() {
    let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE).expect("a box");
    let frame = |joint| Frame { parent: None, origin: Pose::IDENTITY, joint };
    for (joint, kind) in
        [(Joint::Sliding(DVec3::X * 3.0), "sliding"), (Joint::Turning(DVec3::Z * 0.1), "turning")]
    {
        // A mechanism accepts an axis of any length.
        let mechanism = Mechanism::new(vec![frame(joint)]).expect("a joint");
        let path = JointPath::at_unit_times(vec![vec![0.0], vec![0.5]]).expect("a path");
        let there = Pose::from_translation(DVec3::X * 4.0).expect("a pose");
        let bodies = vec![
            PathBody::carried_by(0, cube.at(Pose::IDENTITY)),
            PathBody::at_rest(cube.at(there)),
        ];
        let cast = PathCast::new(&mechanism, &path, bodies, vec![[0, 1]]).expect("a cast");
        let (_, file) = ProofFile::with_path(&cast, &[]).expect("an answer");
        let mut file: Value = serde_json::from_str(&file.to_json()).expect("JSON");
        let read = |file: &Value| ProofFile::from_json(&file.to_string());
        assert!(read(&file).expect("a proof").check().is_ok());
        let axis =
            file["placement"]["robot"]["frames"][0]["joint"][kind].as_array_mut().expect("an axis");
        for x in axis {
            *x = Value::from(2.0 * x.as_f64().expect("a number"));
        }
        let refused = read(&file).expect_err("an axis of length 2").to_string();
        assert!(refused.ends_with("of frame 0 is not a unit vector"), "{refused}");
    }
}

#[test]
fn point_and_segment_proofs_hold() {
    let washer = solid(&washer([1.0, 2.0], [0.0, 0.5], 12));
    let below = Pose::from_translation(DVec3::new(0.25, 0.5, -3.0)).expect("a pose");
    let place = |x: f64| Pose::from_translation(DVec3::new(x, 0.25, 3.0)).expect("a pose");
    for (corners, x) in [
        (vec![DVec3::ZERO], 1.5),
        (vec![DVec3::ZERO], 0.0),
        (vec![DVec3::ZERO, DVec3::new(1.0, 0.5, 0.25)], 1.25),
        (vec![DVec3::ZERO, DVec3::Z], 1.5),
    ] {
        let body = ConvexPolyhedron::from_points(&corners).expect("a point or a segment");
        let own = body.as_surface().expect("a facet without area");
        let of = format!("{corners:?} at {x}");
        let down = Cast::between(body.at(place(x)), washer.at(below), DVec3::NEG_Z);
        let down = down.expect("a cast");
        let proof = ProofFile::of_solids(&down, [&[own], &[&washer]]).expect("their facets");
        assert_holds(&proof, &of);
        let pair = Pair::between(washer.at(below), body.at(place(x))).expect("a pair");
        let (_, proof) =
            ProofFile::with_solid_distance(&pair, [&[&washer], &[own]]).expect("their facets");
        assert_holds(&proof, &of);
    }
}
