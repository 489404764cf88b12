//! Forged proofs: every claim that both checkers accept is true (`campaign --proofs` tests this at length).

use colltrans_convex::{
    Cast, CertificateError, Clearance, ConvexPolyhedron, Pair, Pose, Separation,
};
use colltrans_motion::{Motion, MotionCast};
use colltrans_proof::ProofFile;
use colltrans_scene::{Obstacles, SceneQuery};
use colltrans_solid::{AsSolid, Solid, SolidOptions, StartOverlap, VolumeOptions};
use colltrans_testkit::bodies::{at_xyz as pose, cube};
use colltrans_testkit::cases;
use colltrans_testkit::oracle::proofs::checkers::{RationalChecker, Verdict, verify};
use colltrans_testkit::oracle::proofs::{Campaign, KINDS, common_parts, solid_depths};
use colltrans_testkit::random::Random;
use colltrans_testkit::tally::Tally;
use glam::{DQuat, DVec3};
use serde_json::{Value, json};

/// Rounding error of one operation.
const U: f64 = 0.5 * f64::EPSILON;

/// Starts `check.py`, if Python is available.
fn start_fractions() -> Option<RationalChecker> {
    RationalChecker::start().ok()
}

/// Returns the verdicts of the library and, if available, of `check.py`.
fn verdicts(file: &Value, fractions: &mut Option<RationalChecker>) -> Vec<Verdict> {
    let text = file.to_string();
    let of_fractions = fractions.as_mut().map(|fractions| fractions.check(&text));
    [verify(&text)].into_iter().chain(of_fractions).collect()
}

fn assert_refused(file: &Value, fractions: &mut Option<RationalChecker>) {
    for verdict in verdicts(file, fractions) {
        assert!(matches!(verdict, Verdict::Refused(_)), "{verdict:?}: {file}");
    }
}

fn assert_holds(file: &Value, fractions: &mut Option<RationalChecker>) {
    for verdict in verdicts(file, fractions) {
        assert_eq!(verdict, Verdict::Holds, "{file}");
    }
}

/// Returns the proof about two unit cubes, the moving one far behind the fixed one, with shadows half a unit
/// apart.
fn separation_from_afar(far: f64) -> Value {
    let (p, q) = (cube(), cube());
    let cast = Cast::new(p.at(pose(0.0, 0.0, -far)), q.at(pose(1.5, 0.0, 0.0)), DVec3::Z);
    let cast = cast.expect("a query");
    let outcome = cast.first_contact().expect("an answer");
    serde_json::from_str(&ProofFile::of_outcome(&cast, &outcome).to_json()).expect("JSON")
}

/// The tree of several pieces has another order than the facets of the file.
#[test]
fn near_points_in_scene_are_in_facets_of_file() {
    let mut fractions = start_fractions();
    let block = |high| ConvexPolyhedron::cuboid(DVec3::ZERO, high).expect("a cuboid");
    let [low, high] = [DVec3::new(4.0, 2.0, 1.0), DVec3::new(2.0, 2.0, 3.0)].map(block);
    for radius in [0.0, 0.25] {
        let step = Solid::from_pieces([&low, &high]).and_then(|step| step.rounded(radius));
        let step = step.expect("a step");
        let mut room = Obstacles::new();
        room.insert(step.clone(), Pose::IDENTITY);
        let query = SceneQuery::new(step.at(pose(3.0, 0.5, 2.0)), &room).expect("a query");
        let nearest = ProofFile::of_nearest(&query).expect("an answer").expect("an obstacle");
        let within = ProofFile::of_within(&query, 1.5).expect("an answer");
        for (file, near) in [(nearest, "nearest/near"), (within, "within/closer/0/1")] {
            let mut file: Value = serde_json::from_str(&file.to_json()).expect("JSON");
            for verdict in verdicts(&file, &mut fractions) {
                assert!(verdict.accepts(), "{verdict:?}: {file}");
            }
            let facet = format!("/statement/{near}/solid/points/triangles/1");
            let facet = file.pointer_mut(&facet).expect("a facet");
            *facet = json!(0);
            assert_refused(&file, &mut fractions);
        }
    }
}

/// A meeting is stated for the facets of the file, in whatever order they are.
#[test]
fn meeting_is_in_facets_of_file() {
    let mut fractions = start_fractions();
    let step = [[4.0, 2.0, 1.0], [2.0, 2.0, 3.0]].map(|high| {
        ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::from_array(high)).expect("a cuboid")
    });
    let step = Solid::from_pieces(&step).expect("a step");
    let pair = Pair::new(step.at(pose(3.5, 0.5, 0.25)), step.at(Pose::IDENTITY)).expect("a pair");
    let proof = ProofFile::of_solid_distance(&pair, [&[&step], &[&step]], None).expect("a proof");
    let file: Value = serde_json::from_str(&proof.to_json()).expect("JSON");
    assert_holds(&file, &mut fractions);
    let named = "/statement/solid_distance/near/meeting/facets";
    let facets = file.pointer(named).and_then(Value::as_array).expect("facets").clone();
    for body in [0, 1] {
        let triangles = format!("/bodies/{body}/pieces/0/triangles");
        let mut other = file.clone();
        let all = other.pointer_mut(&triangles).and_then(Value::as_array_mut).expect("triangles");
        all.reverse();
        let last = all.len() as u64 - 1;
        let number = facets[body].as_u64().expect("a number");
        *other.pointer_mut(&format!("{named}/{body}")).expect("a facet") = json!(last - number);
        assert_holds(&other, &mut fractions);
    }
}

#[test]
fn margin_beyond_shadow_distance_is_rejected_for_tilted_normal() {
    let mut fractions = start_fractions();
    for far in [1e3, 1e6, 1e9] {
        let mut file = separation_from_afar(far);
        assert_holds(&file, &mut fractions);
        // The largest admitted tilt of a normal. The gap along the tilted normal is larger.
        for tilt in [30.0 * U, 31.9 * U] {
            file["statement"]["separation"] = json!({"normal": [1.0, 0.0, tilt], "margin": 0.499});
            assert_holds(&file, &mut fractions);
            for excess in [1e-15, 0.1 * tilt * far, 0.9 * tilt * far] {
                file["statement"]["separation"]["margin"] = json!(0.5 + excess);
                assert_refused(&file, &mut fractions);
            }
        }
        let tilted = json!({"normal": [0.01, 0.0, 0.999_95], "margin": 0.99 * far});
        file["statement"]["separation"] = tilted;
        assert_refused(&file, &mut fractions);
    }
}

#[test]
fn cast_verify_rejects_margin_gained_by_tilt() {
    let (p, q) = (cube(), cube());
    let cast = Cast::new(p.at(pose(0.0, 0.0, -1e9)), q.at(pose(1.5, 0.0, 0.0)), DVec3::Z);
    let cast = cast.expect("a query");
    let normal = DVec3::new(1.0, 0.0, 30.0 * U);
    let refused = cast.verify(&Separation { normal, margin: 0.5 + 1e-6 }).unwrap_err();
    assert!(
        matches!(refused, CertificateError::Bound { proven, .. } if proven <= 0.5),
        "{refused}"
    );
}

#[test]
fn slide_overlap_hidden_by_tilted_normal_is_rejected() {
    let (p, q) = (cube(), cube());
    let cast = Cast::new(p.at(pose(-1e9, 0.0, 1.0)), q.at(pose(0.0, 0.0, 0.0)), DVec3::X);
    let cast = cast.expect("a query").with_graze_tolerance(1e-3).expect("a tolerance");
    let outcome = cast.first_contact().expect("an answer");
    let mut file: Value =
        serde_json::from_str(&ProofFile::of_outcome(&cast, &outcome).to_json()).expect("JSON");
    let mut fractions = start_fractions();
    assert_holds(&file, &mut fractions);
    // The shadows overlap by 1e-6, although the bodies are apart along the tilted normal.
    file["placement"]["poses"][0]["pose"]["translation"][2] = json!(1.0 - 1e-6);
    file["statement"]["contacts"]["slide"] = json!({"normal": [3e-15, 0.0, -1.0], "overlap": 0.0});
    assert_refused(&file, &mut fractions);
    file["statement"]["contacts"]["slide"]["normal"] = json!([-3e-15, 0.0, -1.0]);
    assert_refused(&file, &mut fractions);
}

#[test]
fn both_checkers_reject_values_outside_specification() {
    let mut fractions = start_fractions();
    let (p, q) = (cube(), cube());
    let apart = [p.at(pose(0.0, 0.0, 0.0)), q.at(pose(3.0, 0.25, 0.5))];
    let over = [p.at(pose(0.0, 0.0, 0.0)), q.at(pose(0.7, 0.25, 0.5))];
    let pair = Pair::new(apart[0], apart[1]).expect("a pair");
    let json =
        |proof: ProofFile| -> Value { serde_json::from_str(&proof.to_json()).expect("JSON") };
    let distance = json(ProofFile::of_distance(&pair, &pair.distance().expect("an answer")));
    let pair = Pair::new(over[0], over[1]).expect("a pair");
    let depth = json(ProofFile::of_depth(&pair, &pair.depth().expect("an answer")));
    let cast = Cast::new(apart[0], apart[1], DVec3::new(1.0, 0.125, 0.0)).expect("a query");
    let contacts = cast.contact_range().expect("an answer");
    let contacts = json(ProofFile::of_range(&cast, &contacts));
    for file in [&distance, &depth, &contacts] {
        assert_holds(file, &mut fractions);
    }
    let mut changed = |file: &Value, at: &str, value: Value| {
        let mut file = file.clone();
        *file.pointer_mut(at).expect("a place") = value;
        assert_refused(&file, &mut fractions);
    };
    changed(&distance, "/statement/distance/gap/gap", json!(-1.0));
    changed(&distance, "/statement/distance/near/weights", json!(["a", 0.0, 0.0, 1.0]));
    changed(&distance, "/bodies/0/convex/vertices/0/0", json!(5e-324));
    changed(&distance, "/bodies/0/convex/hull_error", json!(-1e-300));
    changed(&depth, "/statement/depth/enclosure/normals/0", json!([1e-3, 0.0, 0.0]));
    changed(&depth, "/statement/depth/enclosure", Value::Null);
    changed(&depth, "/statement/depth/lower", json!(-1e-300));
    for rounding in [-1e-300, 1.0, 1e300] {
        changed(&contacts, "/statement/contacts/first/rounding", json!(rounding));
    }
    changed(&contacts, "/statement/contacts/first/weights", json!([1.0, 0.0, 0.0, 0.0]));
    let mut file = contacts.clone();
    file["statement"]["contacts"]["first"]["unknown"] = json!(1);
    assert_refused(&file, &mut fractions);
    file = contacts.clone();
    file["statement"]["contacts"]["first"].as_object_mut().expect("fields").remove("rounding");
    assert_refused(&file, &mut fractions);
    file = contacts;
    file["query"]["cast"]["min_gap"] = json!(-1.0);
    assert_refused(&file, &mut fractions);
}

/// A proof of solids holds only for continuous motions, because it tests only at the start whether one contains the
/// other.
#[test]
fn both_checkers_reject_motion_that_jumps() {
    let mut fractions = start_fractions();
    let turned = |x: f64, y: f64, angle: f64| {
        let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 2.0) / 3.0, angle);
        Pose::new(turn, DVec3::new(x, y, 0.25)).expect("a pose")
    };
    let poses = [turned(5.0, 0.0, 0.3), turned(6.0, 1.0, 1.1), turned(5.5, -3.0, -0.4)];
    let (cube, motion) = (cube(), Motion::through_poses(&poses).expect("a motion"));
    let rest = Motion::at_rest(Pose::IDENTITY);
    let cast = MotionCast::new(cube.with_motion(&motion), cube.with_motion(&rest)).expect("a cast");
    let convex = ProofFile::of_motion(&cast, &cast.first_contact().expect("an answer"));
    let cast = MotionCast::between_any(cube.with_motion(&motion), cube.with_motion(&rest));
    let solids = ProofFile::with_solid_motion(&cast.expect("a cast")).expect("a proof").1;
    for file in [convex, solids] {
        let mut file: Value = serde_json::from_str(&file.to_json()).expect("JSON");
        for verdict in verdicts(&file, &mut fractions) {
            assert!(
                matches!(verdict, Verdict::Holds | Verdict::HoldsPartly),
                "{verdict:?}: {file}"
            );
        }
        let piece = file.pointer_mut("/placement/motions/0/0/motion/1").expect("a piece");
        piece["start"]["translation"][0] = json!(6.0 + 1e-10);
        assert_refused(&file, &mut fractions);
    }
}

#[test]
#[ignore = "long: two checkers of every kind of proof"]
fn forged_proofs_have_no_accepted_false_claim() {
    let mut fractions = start_fractions();
    for kind in KINDS {
        let mut tally = Tally::default();
        // Some seeds have no proof.
        for seed in 0..50 {
            if tally.get("proofs") < 2 {
                Campaign::examine(&kind, seed, fractions.as_mut(), &mut tally);
            }
        }
        assert_eq!(tally.disagreements, [""; 0], "{}", kind.name);
        let [mutants, accepted] = ["mutants", "accepted"].map(|name| tally.get(name));
        assert!(mutants > 30 && accepted > 0, "{}: {mutants}", kind.name);
    }
}

/// The triangles of a distance have the indices of the file, independently of the order in a union's tree.
#[test]
fn both_checkers_accept_distance_proof_of_union() {
    let mut fractions = start_fractions();
    let random = &mut Random::new(23);
    let mut any_box = |far: f64| {
        let low = random.vector() * 3.0 + far;
        let size =
            DVec3::new(random.range(0.5, 3.0), random.range(0.5, 3.0), random.range(0.5, 3.0));
        ConvexPolyhedron::cuboid(low, low + size).expect("a box")
    };
    for _ in 0..30 {
        let pieces = [any_box(0.0), any_box(0.0), any_box(0.0)];
        let solids = pieces.each_ref().map(|piece| AsSolid::as_solid(piece).expect("a solid"));
        let union = Solid::from_pieces(solids).expect("a union");
        let other = any_box(12.0);
        let other = AsSolid::as_solid(&other).expect("a solid");
        let origin = pose(0.0, 0.0, 0.0);
        let pair = Pair::new(other.at(origin), union.at(origin)).expect("a pair");
        let proof = ProofFile::of_solid_distance(&pair, [&[other], &solids], None);
        let text = proof.expect("a proof").to_json();
        assert_eq!(verify(&text), Verdict::Holds, "{text}");
        if let Some(fractions) = &mut fractions {
            assert_eq!(fractions.check(&text), Verdict::HoldsPartly, "{text}");
        }
    }
}

/// Both checkers accept proofs of depths, and refuse each changed number. Only the library reads covers.
#[test]
#[ignore = "long: every changed proof is checked in fractions"]
fn changed_depth_proofs_of_solids_are_refused() {
    let mut fractions = start_fractions();
    let (mut proofs, mut with_cores, mut with_enclosure) = (0, 0, 0);
    for seed in 0..cases(160) {
        let Some(text) = (solid_depths::DEPTHS.draw_proof)(seed) else { continue };
        proofs += 1;
        let file: Value = serde_json::from_str(&text).expect("JSON");
        let depth = &file["statement"]["solid_depth"];
        let number = |name: &str| depth[name].as_f64().expect("a number");
        for verdict in verdicts(&file, &mut fractions) {
            assert!(verdict.accepts(), "{seed}: {verdict:?}: {file}");
        }
        let mut changes = vec![("lower", json!(number("lower") * (1.0 + 1e-6) + 1e-9))];
        changes.push(("translation", file["placement"]["poses"][0]["pose"]["translation"].clone()));
        if number("upper") > 0.0 {
            changes.push(("upper", json!(number("upper") * (1.0 - 1e-12))));
        } else {
            changes.pop();
        }
        for (name, value) in changes {
            let mut other = file.clone();
            other["statement"]["solid_depth"][name] = value;
            assert_refused(&other, &mut fractions);
        }
        let mut shorter = file.clone();
        let cover = &mut shorter["statement"]["solid_depth"]["apart"]["cover"];
        *cover = json!(cover.as_str().expect("letters").strip_suffix(char::is_alphabetic));
        assert!(matches!(verify(&shorter.to_string()), Verdict::Refused(_)), "{seed}");
        if let Some(cores) = depth["cores"].as_array().filter(|cores| !cores.is_empty()) {
            with_cores += 1;
            for place in 0..2 {
                let core = format!("/statement/solid_depth/cores/{}/{}", place / 2, place % 2);
                let radius = cores[place / 2][place % 2]["radius"].as_f64().expect("a radius");
                let wide = json!(radius * (1.0 + 1e-6) + 1e-9);
                for (name, value) in [("radius", wide), ("origin", json!([1e3, 1e3, 1e3]))] {
                    let mut other = file.clone();
                    *other.pointer_mut(&format!("{core}/{name}")).expect("a core") = value;
                    assert_refused(&other, &mut fractions);
                }
                // A box that reaches through the surface.
                let mut other = file.clone();
                let wide = other.pointer_mut(&core).expect("a core");
                (wide["size"], wide["radius"]) = (json!([1e3, 1e3, 1e3]), json!(0.0));
                assert_refused(&other, &mut fractions);
            }
        }
        if depth["enclosure"].is_object() {
            with_enclosure += 1;
            let mut other = file.clone();
            let surface = &mut other["statement"]["solid_depth"]["enclosure"];
            for list in ["triangles", "normals"] {
                surface[list].as_array_mut().expect("a list").pop();
            }
            assert_refused(&other, &mut fractions);
        }
        if number("lower") > 0.0 && file["bodies"][0] != file["bodies"][1] {
            let mut swapped = file;
            let poses = &mut swapped["placement"]["poses"];
            (poses[0]["body"], poses[1]["body"]) =
                (poses[1]["body"].clone(), poses[0]["body"].clone());
            assert_refused(&swapped, &mut fractions);
        }
    }
    let few = cases(160) as usize / 8;
    assert!(proofs > 2 * few && with_cores > few && with_enclosure > few / 4, "{proofs}");
}

/// The radii of rounded solids count only if parts of their cores overlap.
#[test]
fn depths_of_cores_apart_are_refused() {
    let mut fractions = start_fractions();
    let round = cube().as_solid().expect("a solid").clone().rounded(0.5).expect("a radius");
    let file = |places: [f64; 2]| -> Value {
        let [moving, fixed] = places.map(|x| round.at(pose(x, 0.0, 0.0)));
        let pair = Pair::new(moving, fixed).expect("a pair");
        let proof = ProofFile::of_solid_depth(&pair, [&[&round], &[&round]]).expect("a proof");
        serde_json::from_str(&proof.to_json()).expect("JSON")
    };
    let core = |x: f64, k: usize| file([x, x])["statement"]["solid_depth"]["cores"][0][k].clone();
    for x in [1.75, 100.0] {
        let mut forged = file([0.0, x]);
        let depth = &mut forged["statement"]["solid_depth"];
        (depth["cores"], depth["lower"]) = (json!([[core(0.0, 0), core(x, 1)]]), json!(0.9));
        depth["upper"] = json!(1.0_f64.max(depth["upper"].as_f64().expect("a number")));
        assert_refused(&forged, &mut fractions);
    }
}

/// Both checkers accept proofs of common parts, and refuse each number, index and cell that claims more.
#[test]
#[ignore = "long: every changed proof is checked in fractions"]
fn changed_common_part_proofs_are_refused() {
    let mut fractions = start_fractions();
    let (mut proofs, mut overlapping) = (0, 0);
    for seed in 0..cases(120) {
        let Some(text) = (common_parts::COMMON_PARTS.draw_proof)(seed) else { continue };
        proofs += 1;
        let file: Value = serde_json::from_str(&text).expect("JSON");
        assert_holds(&file, &mut fractions);
        let part = &file["statement"]["solid_common_part"];
        let [lower, upper] = [0, 1].map(|k| part["volume"][k].as_f64().expect("a number"));
        overlapping += usize::from(lower > 0.0);
        let mut changes = vec![
            ("/volume/0".to_owned(), json!(lower * (1.0 + 1e-9) + 1e-200)),
            ("/volume/0".to_owned(), json!(-1.0)),
            ("/nodes".to_owned(), json!([])),
            ("/root/low".to_owned(), part["root"]["high"].clone()),
            ("/point".to_owned(), json!([1e30, 1e30, 1e30])),
        ];
        if upper > 0.0 {
            changes.push(("/volume/1".to_owned(), json!((upper * (1.0 - 1e-9)).min(lower))));
            changes.push(("/bounds".to_owned(), Value::Null));
            changes.push(("/bounds/low".to_owned(), part["bounds"]["high"].clone()));
            changes.push(("/relation".to_owned(), json!("disjoint")));
        }
        for (k, node) in part["nodes"].as_array().expect("nodes").iter().enumerate().take(24) {
            let other = match node.as_str() {
                Some("both") => json!("outside_fixed"),
                Some("outside_moving" | "outside_fixed") => json!("both"),
                Some(_) => json!("outside"),
                None => json!("undecided"),
            };
            changes.push((format!("/nodes/{k}"), other));
        }
        for (name, value) in changes {
            let mut other = file.clone();
            let at = format!("/statement/solid_common_part{name}");
            match other.pointer_mut(&at) {
                Some(field) => *field = value,
                None => other["statement"]["solid_common_part"]["point"] = value,
            }
            assert_refused(&other, &mut fractions);
        }
    }
    assert!(3 * proofs > cases(120) && 3 * overlapping > proofs, "{overlapping} of {proofs}");
}

/// Returns a box with facets that point outwards, or inwards.
fn piece(low: [f64; 3], high: [f64; 3], is_inverted: bool) -> Value {
    let corner = |k: usize| [0, 1, 2].map(|axis| [low, high][k >> axis & 1][axis]);
    let sides =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let facets = sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    let facets = facets.map(|[a, b, c]| if is_inverted { [a, c, b] } else { [a, b, c] });
    let vertices: Vec<[f64; 3]> = (0..8).map(corner).collect();
    json!({ "vertices": vertices, "triangles": facets.collect::<Vec<[usize; 3]>>() })
}

/// Joins two pieces to one.
fn joined(a: &Value, b: &Value) -> Value {
    let list = |of: &Value, name: &str| of[name].as_array().expect("a list").clone();
    let base = list(a, "vertices").len() as u64;
    let moved = list(b, "triangles")
        .into_iter()
        .map(|facet| json!([0, 1, 2].map(|k| facet[k].as_u64().expect("an index") + base)));
    let vertices = [list(a, "vertices"), list(b, "vertices")].concat();
    let triangles = [list(a, "triangles"), moved.collect()].concat();
    json!({ "vertices": vertices, "triangles": triangles })
}

/// Returns a file about a union of pieces and the box from 0 to 4, with one cell as root.
fn common_file(pieces: &[Value], root: [[f64; 3]; 2], volume: [f64; 2], node: &str) -> Value {
    let pose = json!({ "matrix": [1, 0, 0, 0, 1, 0, 0, 0, 1], "translation": [0, 0, 0] });
    let around = json!({ "low": root[0], "high": root[1] });
    // The library rounds volumes.
    let volume = [volume[0] * (1.0 - 1e-9), volume[1] * (1.0 + 1e-9)];
    let mut part = json!({ "volume": volume, "root": around, "nodes": [node] });
    if node == "both" || node == "undecided" {
        part["bounds"] = around;
    }
    json!({
        "format": "colltrans proof",
        "version": 2,
        "bodies": [{ "pieces": pieces }, { "pieces": [piece([0.0; 3], [4.0; 3], false)] }],
        "placement": { "poses": [{ "body": 0, "pose": pose }, { "body": 1, "pose": pose }] },
        "query": "pair",
        "statement": { "solid_common_part": part },
    })
}

/// What is inside a solid follows the winding numbers of its pieces, in both checkers.
#[test]
fn common_parts_of_unusual_surfaces_have_the_same_verdict_in_both_checkers() {
    let mut fractions = start_fractions();
    let whole = [[0.0; 3], [4.0; 3]];
    let cube = |is_inverted| piece([0.0; 3], [4.0; 3], is_inverted);
    let small = |is_inverted| piece([1.0; 3], [3.0; 3], is_inverted);
    let wide = piece([-1.0; 3], [5.0; 3], false);
    // Pieces that overlap count once.
    for pieces in
        [vec![cube(false)], vec![cube(false), cube(false)], vec![cube(false), wide.clone()]]
    {
        assert_holds(&common_file(&pieces, whole, [64.0, 64.0], "both"), &mut fractions);
        for (volume, node) in [([0.0, 0.0], "outside_moving"), ([128.0, 128.0], "both")] {
            assert_refused(&common_file(&pieces, whole, volume, node), &mut fractions);
        }
    }
    // A piece that is inside out is neither empty nor does it remove others.
    let union = [wide.clone(), cube(true)];
    for pieces in [&[cube(true)][..], &union[..]] {
        for (volume, node) in [([0.0, 0.0], "outside_moving"), ([64.0, 64.0], "both")] {
            assert_refused(&common_file(pieces, whole, volume, node), &mut fractions);
        }
    }
    // A cavity is empty, unless another piece fills it. A second shell of the same piece fills nothing twice.
    let hollow = joined(&wide, &cube(true));
    assert_holds(
        &common_file(std::slice::from_ref(&hollow), whole, [0.0, 0.0], "outside_moving"),
        &mut fractions,
    );
    assert_refused(
        &common_file(std::slice::from_ref(&hollow), whole, [64.0, 64.0], "both"),
        &mut fractions,
    );
    let filled = [hollow, cube(false)];
    assert_holds(&common_file(&filled, whole, [64.0, 64.0], "both"), &mut fractions);
    let doubled = joined(&wide, &cube(false));
    assert_holds(&common_file(&[doubled], whole, [64.0, 64.0], "both"), &mut fractions);
    // Facets in the cell.
    let crossed = [wide.clone(), small(false)];
    for node in ["both", "outside_moving", "outside_fixed"] {
        assert_refused(&common_file(&crossed, whole, [0.0, 64.0], node), &mut fractions);
    }
    assert_holds(&common_file(&crossed, whole, [0.0, 64.0], "undecided"), &mut fractions);
    // A cavity that reaches out of its piece has a negative winding number there.
    let through = joined(&piece([-1.0; 3], [2.0; 3], false), &piece([-0.5; 3], [5.0; 3], true));
    let corner = [[2.0; 3], [4.0; 3]];
    for node in ["both", "outside_moving"] {
        let mut file = common_file(std::slice::from_ref(&through), corner, [0.0, 64.0], node);
        file["statement"]["solid_common_part"]["root"] =
            json!({ "low": [0, 0, 0], "high": [4, 4, 4] });
        assert_refused(&file, &mut fractions);
    }
    // An inverted shell that reaches out of the others is inside out, although a corner of it is inside them.
    let poking = joined(&cube(false), &piece([3.0; 3], [5.0; 3], true));
    let common = [[3.25; 3], [3.75; 3]];
    for node in ["both", "outside_moving"] {
        let file = common_file(std::slice::from_ref(&poking), common, [0.0, 0.125], node);
        assert_refused(&file, &mut fractions);
    }
}

/// A long tree is refused, and a number beyond the range, without a crash.
#[test]
fn common_parts_with_hostile_trees_are_refused() {
    let mut fractions = start_fractions();
    let whole = [[0.0; 3], [4.0; 3]];
    let file = common_file(&[piece([0.0; 3], [4.0; 3], false)], whole, [64.0, 64.0], "both");
    let with = |nodes: Value| {
        let mut file = file.clone();
        file["statement"]["solid_common_part"]["nodes"] = nodes;
        file
    };
    assert_holds(&with(json!([{ "x": 1.0 }, "both", { "y": 2 }, "both", "both"])), &mut fractions);
    let cut = |cut: Value| with(json!([cut, "both", "both"]));
    for number in [0.0, -0.0, 4.0, 5.0, 1e-300, 1e300, 1e61] {
        assert_refused(&cut(json!({ "x": number })), &mut fractions);
    }
    for hostile in [
        json!({ "moving": 0 }),
        json!({ "moving": 12 }),
        json!({ "moving": 4_294_967_295_u32 }),
        json!({ "moving": -1 }),
        json!({ "w": 1.0 }),
        json!({ "x": null }),
        json!({ "x": 1.0, "y": 1.0 }),
        json!("inside"),
        json!("x"),
        json!({ "both": null }),
        json!({ "undecided": {} }),
        json!(null),
        json!([]),
    ] {
        assert_refused(&cut(hostile), &mut fractions);
    }
    assert_refused(&with(json!([{ "both": null }])), &mut fractions);
    for (relation, holds) in [
        (json!("moving_contained"), true),
        (json!({ "moving_contained": null }), false),
        (json!("crossing"), false),
        (json!({ "crossing": null }), false),
    ] {
        let mut file = file.clone();
        file["statement"]["solid_common_part"]["relation"] = relation;
        let check = if holds { assert_holds } else { assert_refused };
        check(&file, &mut fractions);
    }
    let chain = |count: usize| {
        let cuts = (1..=count).map(|k| json!({ "x": 4.0 - 4.0 * k as f64 / (count + 1) as f64 }));
        with(cuts.chain((0..=count).map(|_| json!("both"))).collect())
    };
    assert_holds(&chain(64), &mut fractions);
    assert_refused(&chain(4100), &mut fractions);
    let mut deep = vec![json!({ "x": 2.0 }); 100_000];
    deep.push(json!("both"));
    assert_refused(&with(Value::Array(deep)), &mut fractions);
    // Extreme but admitted coordinates are decided exactly.
    for (low, high) in [(0.0, 2.0_f64.powi(-199)), (2.0_f64.powi(199), 2.0_f64.powi(199) * 1.5)] {
        let box_of = || piece([low; 3], [high; 3], false);
        let volume = (high - low).powi(3);
        let mut file = common_file(&[box_of()], [[low; 3], [high; 3]], [volume; 2], "both");
        file["bodies"][1]["pieces"] = json!([box_of()]);
        file["statement"]["solid_common_part"]["volume"] =
            json!([volume * (1.0 - 1e-12), volume * (1.0 + 1e-12)]);
        assert_holds(&file, &mut fractions);
    }
}

/// Proofs of the library about turned unions hold in both checkers.
#[test]
fn common_parts_of_unions_hold_in_both_checkers() {
    let mut fractions = start_fractions();
    for seed in 0..cases(24) {
        let random = &mut Random::new(seed);
        let any_box = |random: &mut Random| {
            let low = random.vector();
            let made = ConvexPolyhedron::cuboid(low, low + random.vector().abs() + 0.25);
            AsSolid::as_solid(&made.expect("a box")).expect("a solid").clone()
        };
        let pieces = [any_box(random), any_box(random), any_box(random)];
        let union = Solid::from_pieces(&pieces).expect("a union");
        let other = any_box(random);
        let turn = Pose::new(random.rotation(), random.vector() * 0.5).expect("a pose");
        let pair = Pair::new(union.at(turn), other.at(Pose::IDENTITY)).expect("a pair");
        let pieces: Vec<&Solid> = pieces.iter().collect();
        let options = VolumeOptions::default().with_accuracy(0.0).with_max_cells(300);
        let proof = ProofFile::of_solid_common_part(&pair, [&pieces, &[&other]], options);
        let proof = proof.expect("a proof");
        assert!(proof.to_string().contains("interiors"), "{proof}");
        let file: Value = serde_json::from_str(&proof.to_json()).expect("JSON");
        assert_holds(&file, &mut fractions);
    }
}

/// Statements count vertices, therefore both checkers require that all of them are used.
#[test]
fn unused_vertex_of_piece_is_rejected() {
    let mut fractions = start_fractions();
    let (a, b) = (cube(), cube());
    let (p, q) = (a.as_solid().expect("a solid"), b.as_solid().expect("a solid"));
    let cast = Cast::new(p.at(pose(-3.0, 0.25, 0.5)), q.at(pose(0.0, 0.0, 0.0)), DVec3::X);
    let cast = cast.expect("a query");
    let proof = ProofFile::of_solids(&cast, [&[p], &[q]]).expect("a proof");
    let mut file: Value = serde_json::from_str(&proof.to_json()).expect("JSON");
    let verdicts_of = |file: &Value, fractions: &mut Option<RationalChecker>| -> Vec<bool> {
        verdicts(file, fractions).iter().map(|v| !matches!(v, Verdict::Refused(_))).collect()
    };
    assert!(verdicts_of(&file, &mut fractions).iter().all(|holds| *holds));
    let vertices = file["bodies"][1]["pieces"][0]["vertices"].as_array_mut().expect("vertices");
    vertices.push(json!([0.5, 0.5, 0.5]));
    assert_refused(&file, &mut fractions);
}

/// Facets that stop a body after an overlap need not face each other in nominal position, but they meet.
#[test]
fn both_checkers_accept_stops_after_ignored_overlap() {
    let mut fractions = start_fractions();
    let bolt = bolt();
    let random = &mut Random::new(20);
    let mut stopped = 0;
    for k in 0..600 {
        let cube =
            ConvexPolyhedron::cuboid(DVec3::ZERO, random.vector().abs() + 0.2).expect("a box");
        let cube = cube.as_solid().expect("a solid");
        let place = [DVec3::ZERO, random.grid(-2, 2)][k % 2] + 0.25 * random.grid(-2, 2);
        let (p, q) =
            (cube.at(Pose::from_translation(place).expect("a pose")), bolt.at(Pose::IDENTITY));
        let direction = random.pick(&[DVec3::X, DVec3::NEG_Z, DVec3::new(1.0, 0.0, 0.25)]);
        let options = SolidOptions::default()
            .with_start_overlap(StartOverlap::Ignore)
            .with_tolerance(random.pick(&[1e-6, 1e-3, 1e-2]));
        let cast = Cast::new(p, q, direction).expect("a query");
        let cast = cast.with_options(options).expect("a tolerance");
        let Ok(Clearance::Blocked { .. }) = cast.clearance() else { continue };
        stopped += 1;
        let proof = ProofFile::of_solids(&cast, [&[cube], &[&bolt]]).expect("a proof");
        let file: Value = serde_json::from_str(&proof.to_json()).expect("JSON");
        for verdict in verdicts(&file, &mut fractions) {
            assert!(verdict.accepts(), "{verdict:?}: {file}");
        }
    }
    assert!(stopped > 30, "{stopped} casts are blocked");
}

/// Returns a shank with a head and a chamfer, with 12 sides.
fn bolt() -> Solid {
    let rings = [(0.5, -3.0), (0.5, 0.0), (1.0, 0.0), (1.0, 0.5), (0.75, 0.75)];
    let n = 12;
    let mut vertices = Vec::new();
    for (r, z) in rings {
        for k in 0..n {
            let (y, x) = (std::f64::consts::TAU * f64::from(k) / f64::from(n)).sin_cos();
            vertices.push(DVec3::new(r * x, r * y, z));
        }
    }
    let at = |ring: u32, k: u32| ring * n + k % n;
    let mut facets = Vec::new();
    for ring in 0..rings.len() as u32 - 1 {
        for k in 0..n {
            facets.push([at(ring, k), at(ring, k + 1), at(ring + 1, k + 1)]);
            facets.push([at(ring, k), at(ring + 1, k + 1), at(ring + 1, k)]);
        }
    }
    let top = rings.len() as u32 - 1;
    for k in 1..n - 1 {
        facets.push([at(0, 0), at(0, k + 1), at(0, k)]);
        facets.push([at(top, 0), at(top, k), at(top, k + 1)]);
    }
    Solid::from_mesh(&vertices, &facets).expect("a bolt")
}
