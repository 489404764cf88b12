//! Audits: boxes against their closed forms, roles and tolerances, and tables.

use colltrans_assembly::audit::{
    Audit, AuditOptions, AuditedPair, PairFinding, ProofClaim, QUANTITIES, audit, audit_csv,
    audit_json, examine_pair, prove_pairs,
};
use colltrans_assembly::roles::{PairFit, Role};
use colltrans_assembly::{Assembly, AssemblyError, Bodies, Fit, Ignored, Part, Piece, Watch};
use colltrans_mesh::Mesh;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::block;
use glam::{DAffine3, DVec3};

use crate::common::{cuboid, part, scattered, well};

fn within(length: f64) -> AuditOptions {
    AuditOptions::default().with_within(length).unwrap()
}

/// Audits an assembly with a tolerance.
fn audited(assembly: &Assembly, tolerance: f64, options: &AuditOptions) -> Audit {
    let bodies = Bodies::new(assembly, Fit::Tolerance(tolerance)).unwrap();
    audit(&bodies, options, Watch::default()).unwrap()
}

/// Audits two parts. Returns their pair; `None` if it is not reported.
fn pair_of(
    a: &[Piece],
    b: &[Piece],
    tolerance: f64,
    options: &AuditOptions,
) -> Option<AuditedPair> {
    let assembly = Assembly::new(vec![part("a", a), part("b", b)]).unwrap();
    let mut found = audited(&assembly, tolerance, options).pairs;
    assert!(found.len() <= 1);
    found.pop()
}

fn encloses([lower, upper]: [f64; 2], exact: f64, share: f64) -> bool {
    let slack = 1e-12 * exact;
    lower <= exact + slack && exact <= upper + slack && upper - lower <= share * exact + 1e-12
}

/// Proofs of parts that are unions of overlapping pieces contain the pieces.
#[test]
fn parts_of_overlapping_pieces_have_proofs() {
    let union = [cuboid([0.0; 3], [2.0, 1.0, 1.0]), cuboid([1.0, 0.0, 0.0], [2.0, 1.0, 3.0])];
    let post = [cuboid([1.5, 0.25, 2.5], [4.0, 0.75, 4.0])];
    let near = [cuboid([5.0, 0.0, 0.0], [6.0, 1.0, 4.0])];
    let parts = vec![part("union", &union), part("post", &post), part("near", &near)];
    let assembly = Assembly::new(parts).unwrap();
    let mut found = audited(&assembly, 0.0, &within(4.0));
    let files = std::sync::Mutex::new(Vec::new());
    let write = |name: &str, text: &str| {
        files.lock().unwrap().push((name.to_owned(), text.to_owned()));
        Ok::<(), AssemblyError>(())
    };
    let volume = AuditOptions::default().volume;
    prove_pairs(&assembly, &mut found, volume, Watch::default(), write).unwrap();
    let mut files = files.into_inner().unwrap();
    files.sort();
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let listed: Vec<&str> = found.pairs.iter().flat_map(AuditedPair::proof_files).collect();
    assert_eq!(
        names,
        [
            "001-union--post-common_part.json",
            "001-union--post-depth.json",
            "002-post--near-distance.json",
            "003-union--near-distance.json",
        ]
    );
    assert_eq!(listed.len(), names.len());
    for (name, text) in &files {
        let proof = colltrans::ProofFile::from_json(text).unwrap();
        proof.check().unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(text.matches("vertices").count(), if name.contains("union") { 3 } else { 2 });
    }
    let common = found.pairs[0].proofs.iter().find(|of| of.claim == ProofClaim::CommonPart);
    assert!(common.unwrap().file.is_ok());
}

/// Returns the box from `low` to `high` with a cavity.
fn hollow(low: f64, high: f64, cavity: [f64; 2]) -> Piece {
    let outer = block(DVec3::splat(low), DVec3::splat(high));
    let inner = block(DVec3::splat(cavity[0]), DVec3::splat(cavity[1]));
    let first = outer.vertices.len() as u32;
    let reversed = |face: &Vec<u32>| face.iter().rev().map(|v| v + first).collect::<Vec<_>>();
    let faces = outer.faces.iter().cloned().chain(inner.faces.iter().map(reversed)).collect();
    let vertices = [outer.vertices, inner.vertices].concat();
    Piece { mesh: Mesh::new(vertices, faces), world_from_piece: DAffine3::IDENTITY }
}

/// The lengths of two boxes by closed forms.
struct BoxPair {
    /// Distance; 0 if the boxes have a common point.
    distance: f64,
    /// Sides of the common box; negative or 0 along an axis without overlap.
    common: DVec3,
    /// Length of the shortest translation that separates the boxes, if they overlap.
    depth: f64,
    /// Whether the first, or the second, lies inside the other one, without common points of the surfaces.
    inside: [bool; 2],
    /// Distance of the surfaces, if one box lies inside the other.
    wall: f64,
}

impl BoxPair {
    fn new(a: &Part, b: &Part) -> Self {
        let [a, b] = [a, b].map(|part| part.solid().bounds());
        let common = a.high.min(b.high) - a.low.max(b.low);
        let inside = |x: &colltrans::Aabb, y: &colltrans::Aabb| {
            x.low.cmpgt(y.low).all() && x.high.cmplt(y.high).all()
        };
        let wall = |x: &colltrans::Aabb, y: &colltrans::Aabb| {
            (x.low - y.low).min(y.high - x.high).min_element()
        };
        Self {
            distance: (-common).max(DVec3::ZERO).length(),
            common,
            depth: (a.high - b.low).min(b.high - a.low).min_element(),
            inside: [inside(&a, &b), inside(&b, &a)],
            wall: wall(&a, &b).max(wall(&b, &a)),
        }
    }
}

/// Returns 8 boxes at random places, 2 small ones at random places, and 2 within the first two boxes.
fn scattered_with_grains(random: &mut Random, snapped: bool) -> Assembly {
    let mut parts = scattered(random, 8, snapped).parts().to_vec();
    for k in 8..12 {
        let center = if k < 10 {
            DVec3::from_array([0; 3].map(|_| 8.0 * (random.unit() - 0.5)))
        } else {
            parts[k - 10].solid().bounds().center()
        };
        let center = if snapped { (4.0 * center).round() / 4.0 } else { center };
        let (low, high) = ((center - 0.25).to_array(), (center + 0.25).to_array());
        parts.push(part(&format!("p{k}"), &[cuboid(low, high)]));
    }
    Assembly::new(parts).unwrap()
}

#[test]
fn scattered_boxes_have_the_findings_of_closed_forms() {
    let mut random = Random::new(58);
    let mut counts = [0; 4];
    for round in 0..40 {
        let snapped = round % 2 == 0;
        let assembly = scattered_with_grains(&mut random, snapped);
        let (tolerance, length) = ([0.0, 0.3, 0.01][round % 3], [1.0, 0.4, 2.5][round / 2 % 3]);
        let found = audited(&assembly, tolerance, &within(length));
        let parts = assembly.parts();
        let mut reported = 0;
        for (a, b) in (0..12).flat_map(|a| (a + 1..12).map(move |b| (a, b))) {
            let exact = BoxPair::new(&parts[a], &parts[b]);
            let pair = found.pairs.iter().find(|pair| pair.parts == [a, b]);
            reported += usize::from(pair.is_some());
            let overlaps = exact.common.min_element() > tolerance;
            let contains = exact.inside.contains(&true) && exact.depth > tolerance;
            let Some(pair) = pair else {
                let is_far = exact.distance >= length - 1e-12 && exact.distance > tolerance;
                assert!(is_far, "{round}: {a}, {b} at {}", exact.distance);
                continue;
            };
            match &pair.finding {
                PairFinding::Interfering(it) => {
                    assert!(overlaps && !contains, "{round}: {a}, {b}");
                    assert!(encloses(it.depth.bounds(), exact.depth, 1e-9), "{it:?}");
                    let volume = exact.common.element_product();
                    assert!(encloses(it.common.volume, volume, 0.011), "{it:?}");
                    counts[0] += 1;
                }
                PairFinding::Contained { inner, wall, interference: it } => {
                    assert!(contains && exact.inside[usize::from(*inner == b)]);
                    assert!(encloses(wall.distance, exact.wall, 1e-9), "{wall:?}");
                    let [p, q] = wall.points;
                    assert!((p.distance(q) - exact.wall).abs() < 1e-12);
                    assert!(encloses(it.depth.bounds(), exact.depth, 1e-9), "{it:?}");
                    counts[1] += 1;
                }
                PairFinding::Touching(nearest) => {
                    assert!(!overlaps && !contains && exact.distance <= tolerance + 1e-12);
                    assert!(encloses(nearest.distance, exact.distance, 1e-9));
                    assert_eq!(pair.is_violation, nearest.distance[1] < length);
                    counts[2] += 1;
                }
                PairFinding::Apart(nearest) => {
                    assert!(exact.distance > tolerance - 1e-12 && exact.distance < length);
                    assert!(encloses(nearest.distance, exact.distance, 1e-9));
                    let [p, q] = nearest.points;
                    assert!((p.distance(q) - exact.distance).abs() < 1e-12);
                    assert!(pair.is_violation);
                    counts[3] += 1;
                }
            }
        }
        assert_eq!(reported, found.pairs.len(), "each pair once");
        let all = found.counts;
        let sum = all.interfering + all.contained + all.touching + all.near;
        assert_eq!((sum, all.violations), (found.pairs.len(), found.violations().count()));
        assert!(all.examined >= found.pairs.len());
        // The order: kinds, then the deepest or the nearest first.
        let ranks = found.pairs.iter().map(|pair| pair.finding.name());
        let order = ["interfering", "contained", "touching", "apart"];
        assert!(ranks.map(|name| order.iter().position(|known| *known == name)).is_sorted());
        let depths = found.pairs.iter().filter_map(|pair| match &pair.finding {
            PairFinding::Interfering(it) => Some(-it.depth.upper),
            _ => None,
        });
        assert!(depths.is_sorted_by(|x, y| x <= y));
    }
    assert!(counts.iter().all(|count| *count > 5), "{counts:?}");
}

#[test]
fn answers_are_equal_for_all_thread_counts() {
    let assembly = scattered(&mut Random::new(7), 40, false);
    let bodies = Bodies::new(&assembly, Fit::Tolerance(0.01)).unwrap();
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| audit(&bodies, &within(1.0), Watch::default()).unwrap())
    };
    assert_eq!(run(1), run(3));
    assert!(!run(1).pairs.is_empty());
}

#[test]
fn faces_that_touch_are_no_interference() {
    let low = [cuboid([0.0; 3], [1.0, 1.0, 1.0])];
    for overlap in [0.0, 1e-7, -1e-7, 9e-7, -9e-7] {
        let high = [cuboid([0.25, 0.25, 1.0 - overlap], [2.0, 2.0, 2.0])];
        let found = pair_of(&low, &high, 1e-6, &within(0.0)).unwrap();
        assert!(matches!(found.finding, PairFinding::Touching(_)), "{overlap}: {found:?}");
        assert!(!found.is_violation);
        // The same contact violates a clearance, unless contacts are allowed.
        assert!(pair_of(&low, &high, 1e-6, &within(0.5)).unwrap().is_violation);
        let allowed = within(0.5).with_allow_contact(true);
        assert!(!pair_of(&low, &high, 1e-6, &allowed).unwrap().is_violation);
    }
    let high = [cuboid([0.25, 0.25, 1.0 - 2e-6], [2.0, 2.0, 2.0])];
    let found = pair_of(&low, &high, 1e-6, &within(0.0)).unwrap();
    assert!(found.is_violation && found.finding.interference().is_some(), "{found:?}");
}

#[test]
fn gap_equal_to_the_clearance_satisfies_it() {
    let low = [cuboid([0.0; 3], [1.0, 1.0, 1.0])];
    let high = [cuboid([0.25, 0.25, 1.5], [2.0, 2.0, 2.0])];
    assert_eq!(pair_of(&low, &high, 1e-6, &within(0.5)), None);
    assert!(pair_of(&low, &high, 1e-6, &within(0.5 + 1e-9)).unwrap().is_violation);
}

#[test]
fn bodies_in_cavities_are_apart_and_in_walls_contained() {
    let shell = [hollow(0.0, 10.0, [2.0, 8.0])];
    let inside = |low: f64, high: f64| {
        let found = pair_of(&shell, &[cuboid([low; 3], [high; 3])], 1e-6, &within(1.5));
        found.map(|pair| pair.finding)
    };
    assert_eq!(inside(4.0, 6.0), None, "2 from the wall");
    match inside(3.0, 6.0) {
        Some(PairFinding::Apart(found)) => assert!(encloses(found.distance, 1.0, 1e-9)),
        other => panic!("{other:?}"),
    }
    assert!(matches!(inside(2.0, 6.0), Some(PairFinding::Touching(_))));
    match inside(1.5, 6.0) {
        // It moves by 0.5 along all three axes into the cavity.
        Some(PairFinding::Interfering(it)) => {
            let depth = 0.75_f64.sqrt();
            assert!(it.depth.lower <= depth && depth <= it.depth.upper, "{it:?}");
            let volume = 4.5_f64.powi(3) - 4.0_f64.powi(3);
            assert!(encloses(it.common.volume, volume, 0.011), "{it:?}");
        }
        other => panic!("{other:?}"),
    }
    match inside(0.5, 1.5) {
        Some(PairFinding::Contained { inner: 1, wall, interference: it }) => {
            assert!(encloses(it.common.volume, 1.0, 0.011), "{it:?}");
            // The outer surface and the cavity are both 0.5 away.
            assert!(encloses(wall.distance, 0.5, 1e-9), "{wall:?}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn open_surfaces_that_cross_a_part_interfere() {
    let mesh = |z: f64| {
        let corners = [[-1.0, -1.0], [3.0, -1.0], [3.0, 3.0], [-1.0, 3.0]];
        let vertices = corners.map(|[x, y]| DVec3::new(x, y, z)).to_vec();
        Piece {
            mesh: Mesh::new(vertices, vec![vec![0, 1, 2, 3]]),
            world_from_piece: DAffine3::IDENTITY,
        }
    };
    let cube = [cuboid([0.0; 3], [2.0; 3])];
    let found = pair_of(&cube, &[mesh(1.0)], 1e-6, &within(0.0)).unwrap();
    let depth = found.finding.interference().unwrap().depth;
    assert!(
        found.is_violation && depth.lower <= depth.upper && depth.upper.is_finite(),
        "{found:?}"
    );
    let found = pair_of(&cube, &[mesh(2.5)], 1e-6, &within(1.0)).unwrap();
    assert!(encloses(found.finding.nearest().unwrap().distance, 0.5, 1e-9), "{found:?}");
}

/// Returns a pin in a hole that is too narrow by 0.1 on each side, and a lid on top.
fn pressed() -> Assembly {
    Assembly::new(vec![
        part("body", &well([0.0; 3], [2.0; 3], 1.0)),
        part("pin", &[cuboid([-0.1, -0.1, 0.5], [2.1, 2.1, 4.0])]),
        part("lid", &[cuboid([-1.0, -1.0, 4.2], [3.0, 3.0, 5.0])]),
    ])
    .unwrap()
}

#[test]
fn roles_permit_overlaps_and_remove_the_clearance() {
    let press = |tolerance| PairFit { role: Some(Role::Press), tolerance };
    let fits = [
        (press(Some(0.25)), false),
        (press(None), false),
        (press(Some(0.05)), true),
        (PairFit { role: None, tolerance: Some(0.25) }, false),
        (PairFit { role: None, tolerance: Some(0.15) }, false),
    ];
    for (fit, violates) in fits {
        let assembly = pressed().with_pair([&["pin"], &["b*"]], fit).unwrap();
        let found = audited(&assembly, 1e-6, &within(0.1));
        let pair = found.pairs.iter().find(|pair| pair.parts == [0, 1]).unwrap();
        assert_eq!(pair.is_violation, violates, "{pair:?}");
        assert_eq!(pair.clearance, 0.0);
        assert_eq!(found.counts.violations, usize::from(violates));
    }
    assert!(audited(&pressed(), 1e-6, &within(0.1)).violations().count() == 1);
    for ignored in [Ignored::Overlap, Ignored::Always] {
        let assembly = pressed().with_ignored(&[["pin", "body"]], ignored).unwrap();
        let found = audited(&assembly, 1e-6, &within(0.1));
        assert_eq!((found.counts.ignored, found.pairs.len()), (1, 0));
    }
    let glued = PairFit { role: Some(Role::Glued), tolerance: None };
    let assembly = pressed().with_pair([&["pin"], &["body"]], glued).unwrap();
    assert_eq!(audited(&assembly, 1e-6, &within(0.1)).counts.ignored, 1);
}

#[test]
fn levels_of_pairs_with_roles_count_contacts() {
    let fits = [
        PairFit { role: Some(Role::Press), tolerance: Some(0.25) },
        PairFit { role: Some(Role::Press), tolerance: None },
        PairFit { role: None, tolerance: Some(0.25) },
    ];
    for fit in fits {
        let assembly = pressed().with_pair([&["pin"], &["body"]], fit).unwrap();
        let level =
            |name: &str| within(0.1).with_level(&assembly, [&[name], &["body"]], 0.15).unwrap();
        let violations = |options: &AuditOptions| {
            let found = audited(&assembly, 1e-6, options);
            found.violations().map(|pair| (pair.parts, pair.clearance)).collect::<Vec<_>>()
        };
        assert_eq!(violations(&level("p*")), [([0, 1], 0.15)], "{fit:?}");
        assert_eq!(violations(&level("lid")), [], "{fit:?}: another pair");
        assert_eq!(violations(&level("pin").with_allow_contact(true)), [], "{fit:?}");
    }
}

#[test]
fn later_levels_replace_earlier_ones() {
    let assembly = pressed();
    let level = |options: AuditOptions, a: &str, b: &str, length| {
        options.with_level(&assembly, [&[a], &[b]], length).unwrap()
    };
    let near = |options: &AuditOptions| {
        let found = audited(&assembly, 1e-6, options);
        found.violations().map(|pair| (pair.parts, pair.clearance)).collect::<Vec<_>>()
    };
    let pin_and_lid = |length| vec![([0, 1], 0.1), ([1, 2], length)];
    assert_eq!(near(&within(0.1)), vec![([0, 1], 0.1)]);
    let wide = level(within(0.1), "lid", "p*", 5.0);
    assert_eq!(near(&wide), pin_and_lid(5.0));
    assert_eq!(near(&level(wide.clone(), "pin", "lid", 0.3)), pin_and_lid(0.3));
    assert_eq!(near(&level(wide, "*", "lid", 0.1)), vec![([0, 1], 0.1)]);
    let unknown = within(0.0).with_level(&assembly, [&["pin"], &["none"]], 1.0);
    assert!(matches!(unknown, Err(AssemblyError::UnknownPart { .. })));
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let refused = AuditOptions::default().with_within(bad);
        assert!(matches!(refused, Err(AssemblyError::InvalidValue { .. })));
        let refused = AuditOptions::default().with_level(&assembly, [&["pin"], &["lid"]], bad);
        assert!(matches!(refused, Err(AssemblyError::InvalidValue { .. })));
    }
}

#[test]
fn one_pair_has_the_finding_of_the_audit() {
    let assembly = pressed();
    let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-6)).unwrap();
    let options = within(0.3);
    let all = audit(&bodies, &options, Watch::default()).unwrap();
    assert!(all.pairs.len() > 1);
    for pair in &all.pairs {
        let [a, b] = pair.parts;
        assert_eq!(examine_pair(&bodies, [b, a], &options).unwrap(), *pair);
    }
}

#[test]
fn hostile_names_stay_in_their_cells() {
    let names = ["=1+1", "a,\"b\"\n<script>"];
    let parts = [cuboid([0.0; 3], [1.0; 3]), cuboid([0.5; 3], [2.0; 3])];
    let parts =
        names.iter().zip(&parts).map(|(name, piece)| part(name, std::slice::from_ref(piece)));
    let assembly = Assembly::new(parts.collect()).unwrap();
    let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-6)).unwrap();
    let found = audit(&bodies, &within(0.0), Watch::default()).unwrap();
    let table = audit_csv(&assembly, &found);
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines.len(), 2, "{table}");
    assert!(
        lines[1].starts_with("'=1+1,\"a,\"\"b\"\"\\n<script>\",interfering,yes,0,,,0."),
        "{table}"
    );
    // Without a distance, a wall, an inner part, a role, open shells and proofs.
    let empty = ",".repeat(3 + 8 + 4);
    assert!(lines[1].ends_with(&format!(",0.000001{empty}")), "{table}");
    let json = serde_json::to_value(audit_json(&bodies, &within(0.0), &found)).unwrap();
    assert_eq!(json["pairs"][0]["parts"], serde_json::json!(names));
    assert_eq!(json["counts"]["violations"], 1);
}

/// Returns the header and the rows of a table without quotes.
fn table_rows(table: &str) -> (Vec<&str>, Vec<Vec<&str>>) {
    let mut lines = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    (lines.next().unwrap(), lines.collect())
}

#[test]
fn columns_hold_the_numbers_of_the_json() {
    let press = PairFit { role: Some(Role::Press), tolerance: Some(0.05) };
    let mut parts = pressed().parts().to_vec();
    parts.push(part("grain", &[cuboid([0.5, 0.5, 1.0], [0.75, 0.75, 1.25])]));
    let assembly = Assembly::new(parts).unwrap().with_pair([&["pin"], &["body"]], press).unwrap();
    let bodies = Bodies::new(&assembly, Fit::Tolerance(1e-6)).unwrap();
    let options = within(0.1).with_level(&assembly, [&["lid"], &["p*"]], 0.3).unwrap();
    let options = options.with_allow_contact(true);
    let found = audit(&bodies, &options, Watch::default()).unwrap();
    let json = serde_json::to_value(audit_json(&bodies, &options, &found)).unwrap();
    let levels = serde_json::json!([{ "groups": [["lid"], ["p*"]], "length": 0.3 }]);
    assert_eq!((&json["levels"], &json["allow_contact"]), (&levels, &true.into()));
    let table = audit_csv(&assembly, &found);
    let (heads, rows) = table_rows(&table);
    assert_eq!(
        heads[..6],
        ["first", "second", "finding", "violation", "clearance", "distance_lower"]
    );
    assert_eq!(rows.len(), found.pairs.len());
    let mut kinds = std::collections::BTreeSet::new();
    for ((row, pair), json) in rows.iter().zip(&found.pairs).zip(json["pairs"].as_array().unwrap())
    {
        assert_eq!(row.len(), heads.len());
        let cell = |name: &str| row[heads.iter().position(|head| *head == name).unwrap()];
        let text = |name: &str| json[name].as_str().unwrap_or_default();
        assert_eq!(
            (cell("finding"), cell("inner"), cell("role")),
            (text("finding"), text("inner"), text("role"))
        );
        for quantity in &QUANTITIES {
            let cells: Vec<&str> = quantity.columns.iter().map(|column| cell(column)).collect();
            let values: Vec<String> =
                quantity.values(pair).unwrap_or_default().iter().map(f64::to_string).collect();
            let empty = vec![""; quantity.columns.len()];
            assert_eq!(
                cells,
                if values.is_empty() { empty } else { values.iter().map(String::as_str).collect() }
            );
            let known = match quantity.name {
                "point" => json.get("point").unwrap_or_else(|| &json["points"][0]),
                "other_point" => &json["points"][1],
                "wall_point" => &json["wall_points"][0],
                "other_wall_point" => &json["wall_points"][1],
                name => &json[name],
            };
            let numbers: Vec<f64> = match known {
                serde_json::Value::Array(all) => all.iter().map(|x| x.as_f64().unwrap()).collect(),
                other => other.as_f64().into_iter().collect(),
            };
            assert_eq!(numbers, quantity.values(pair).unwrap_or_default(), "{}", quantity.name);
        }
        kinds.insert(pair.finding.name());
    }
    assert_eq!(kinds.into_iter().collect::<Vec<_>>(), ["apart", "contained", "interfering"]);
}

#[test]
fn pairs_that_lack_most_of_their_clearance_come_first() {
    let boxes = [[0.0, 1.0], [1.25, 2.0], [4.0, 5.0]];
    let names = ["a", "b", "c"];
    let parts = names
        .iter()
        .zip(boxes)
        .map(|(name, [low, high])| part(name, &[cuboid([low, 0.0, 0.0], [high, 1.0, 1.0])]));
    let assembly = Assembly::new(parts.collect()).unwrap();
    let options = within(0.5).with_level(&assembly, [&["b"], &["c"]], 10.0).unwrap();
    let found = audited(&assembly, 1e-6, &options);
    assert_eq!(found.pairs.iter().map(|pair| pair.parts).collect::<Vec<_>>(), [[1, 2], [0, 1]]);
}

#[test]
fn empty_assemblies_and_single_parts_have_no_pairs() {
    for parts in [vec![], vec![part("a", &[cuboid([0.0; 3], [1.0; 3])])]] {
        let found = audited(&Assembly::new(parts).unwrap(), 0.0, &within(1e9));
        assert_eq!(found, Audit::default());
    }
}
