//! Shared test bodies, plans and checks.

#![allow(dead_code, unreachable_pub, reason = "each test program uses only some of the items")]
#![allow(clippy::format_push_string, reason = "small files, written for people to read")]

use std::io::Write;

use colltrans::motion::{MotionCast, MotionOutcome};
use colltrans::solid::{SolidCast, SolidOptions};
use colltrans::{Cast, Pose, Solid};
use colltrans_assembly::plan::{Plan, PlanOptions, Step};
use colltrans_assembly::suggest::Suggestion;
use colltrans_assembly::{AnalysisRequest, Assembly, Bodies, Part, Piece, Watch};
use colltrans_mesh::Mesh;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::block;
use glam::{DAffine3, DMat3, DVec3};

/// The unit cube as an OFF file.
pub const CUBE: &str = "OFF\n8 6 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n\
    4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n";

/// Returns a box as a piece.
pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Piece {
    let mesh = block(low, high);
    let mesh = Mesh::new(mesh.vertices, mesh.faces);
    Piece { mesh, world_from_piece: DAffine3::IDENTITY }
}

/// Returns the box from the origin to a corner as a mesh element of a 3MF model.
pub fn mesh_of_3mf(corner: [f64; 3]) -> String {
    let mesh = block(DVec3::ZERO, corner);
    let mut text = String::from("<mesh><vertices>");
    for v in &mesh.vertices {
        text += &format!("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>", v.x, v.y, v.z);
    }
    text += "</vertices><triangles>";
    for [a, b, c] in mesh.triangles() {
        text += &format!("<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>");
    }
    text + "</triangles></mesh>"
}

/// Computes the plan along directions that are found automatically.
pub fn planned(bodies: &Bodies, options: PlanOptions) -> Plan {
    let question = AnalysisRequest::default().with_options(options);
    question.analyse(bodies, Watch::default()).unwrap().plan
}

/// Returns the suggestions for overlapping parts.
pub fn suggested(bodies: &Bodies) -> Vec<Suggestion> {
    let options = PlanOptions::default().with_proofs(false).with_effort(0);
    let question = AnalysisRequest::default().with_options(options);
    question.analyse(bodies, Watch::default()).unwrap().suggestions
}

/// Asserts that a step that unscrews parts is free of `others`: the motion has a certificate that verifies,
/// and at samples along both moves the bodies, each shrunk by half of the tolerance, do not overlap.
pub fn turns_freely(assembly: &Assembly, step: &Step, others: &[usize]) {
    let leg = &step.path[0];
    let turn = leg.turn.as_ref().unwrap();
    let tolerance = turn.proof.as_ref().unwrap().tolerance;
    let options = SolidOptions::default().with_tolerance(tolerance);
    let motion = leg.to_motion().unwrap();
    for (moving, fixed) in step.parts.iter().flat_map(|a| others.iter().map(move |b| (a, b))) {
        let [own, other] = [moving, fixed].map(|k| assembly.parts()[*k].solid());
        let cast = MotionCast::new(own.with_motion(&motion), other.at(Pose::IDENTITY)).unwrap();
        let cast = cast.with_tolerance(tolerance).unwrap();
        let MotionOutcome::Free(free) = cast.certified_first_contact().unwrap() else {
            panic!("{moving} meets {fixed}")
        };
        assert_eq!(cast.verify(&free.proof).unwrap(), [1.0, f64::INFINITY]);
        for k in 0..=60 {
            let (share, beyond) = ((f64::from(k) / 45.0).min(1.0), f64::from(k - 45).max(0.0));
            let matrix = DMat3::from_quat(turn.rotation_at(leg, share));
            let by = leg.move_point(DVec3::ZERO, share) + step.direction * 0.3 * beyond;
            let pose = Pose::from_matrix(matrix, by).unwrap();
            let cast = Cast::<Solid>::new(own.at(pose), other.at(Pose::IDENTITY), DVec3::Z);
            let cast = cast.unwrap().with_options(options).unwrap();
            assert!(!cast.overlaps(), "{moving} {fixed} {share} {beyond}");
        }
    }
}

/// Returns files as a ZIP package.
pub fn package<T: AsRef<str>>(files: &[(&str, T)]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut zip = zip::ZipWriter::new(&mut bytes);
    for (name, text) in files {
        zip.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(text.as_ref().as_bytes()).unwrap();
    }
    zip.finish().unwrap();
    bytes.into_inner()
}

/// Returns four walls and a floor around a hole that is open at the top.
pub fn well(low: [f64; 3], high: [f64; 3], wall: f64) -> Vec<Piece> {
    let ([a, b, c], [x, y, z]) = (low, high);
    vec![
        cuboid([a - wall, b - wall, c - wall], [x + wall, y + wall, c]),
        cuboid([a - wall, b - wall, c - wall], [a, y + wall, z]),
        cuboid([x, b - wall, c - wall], [x + wall, y + wall, z]),
        cuboid([a - wall, b - wall, c - wall], [x + wall, b, z]),
        cuboid([a - wall, y, c - wall], [x + wall, y + wall, z]),
    ]
}

/// Builds a part in its own frame.
pub fn part(name: &str, pieces: &[Piece]) -> Part {
    Part::new(name, pieces).unwrap()
}

/// Builds a part with a pose.
pub fn turned(name: &str, pieces: &[Piece], world: DAffine3) -> Part {
    let turned = |p: &Piece| Piece { world_from_piece: world, ..p.clone() };
    Part::new(name, &pieces.iter().map(turned).collect::<Vec<_>>()).unwrap()
}

/// Returns an assembly in which a stud must slide before it comes out: its head is below a plate with an L of
/// two slots that is wide at its end.
pub fn stud() -> Assembly {
    let plate = [
        cuboid([-2.0, -6.0, 0.0], [14.0, -1.0, 2.0]),
        cuboid([-2.0, 1.0, 0.0], [6.0, 6.0, 2.0]),
        cuboid([-6.0, -6.0, 0.0], [-2.0, 6.0, 2.0]),
        cuboid([6.0, 4.0, 0.0], [14.0, 6.0, 2.0]),
        cuboid([12.0, -1.0, 0.0], [14.0, 4.0, 2.0]),
        cuboid([6.0, -6.0, 0.0], [12.0, -4.0, 2.0]),
        cuboid([-6.0, -6.0, -8.0], [14.0, 6.0, -6.0]),
    ];
    let stud =
        [cuboid([-1.0, -1.0, -1.0], [1.0, 1.0, 6.0]), cuboid([-1.9, -2.0, -2.0], [1.9, 2.0, -0.5])];
    Assembly::new(vec![part("plate", &plate), part("stud", &stud)]).unwrap()
}

/// Returns two links of a chain.
pub fn links() -> [Part; 2] {
    let a = [
        cuboid([-2.0, -2.0, -0.5], [-1.0, 2.0, 0.5]),
        cuboid([1.0, -2.0, -0.5], [2.0, 2.0, 0.5]),
        cuboid([-2.0, -2.0, -0.5], [2.0, -1.0, 0.5]),
        cuboid([-2.0, 1.0, -0.5], [2.0, 2.0, 0.5]),
    ];
    let b = [
        cuboid([-0.5, -0.5, -2.5], [0.5, 0.5, 2.5]),
        cuboid([3.0, -0.5, -2.5], [4.0, 0.5, 2.5]),
        cuboid([-0.5, -0.5, -2.5], [4.0, 0.5, -1.5]),
        cuboid([-0.5, -0.5, 1.5], [4.0, 0.5, 2.5]),
    ];
    [part("a", &a), part("b", &b)]
}

/// Returns a core in a box with a lid, without clearance.
pub fn boxed() -> Assembly {
    let parts = vec![
        part("box", &well([0.0; 3], [3.0; 3], 1.0)),
        part("core", &[cuboid([0.0; 3], [3.0, 3.0, 2.5])]),
        part(
            "lid",
            &[cuboid([-1.0, -1.0, 3.0], [4.0, 4.0, 3.5]), cuboid([0.0, 0.0, 2.5], [3.0; 3])],
        ),
    ];
    Assembly::new(parts).unwrap()
}

/// Returns boxes at random places, some of which overlap; with integer coordinates if `snapped`.
pub fn scattered(random: &mut Random, count: usize, snapped: bool) -> Assembly {
    let mut point = |scale: f64| {
        let p = DVec3::from_array([0; 3].map(|_| scale * (random.unit() - 0.5)));
        if snapped { p.round() } else { p }
    };
    let mut parts = Vec::new();
    for k in 0..count {
        let low = point(8.0);
        let high = low + point(3.0).abs() + 1.0;
        parts.push(part(&format!("p{k}"), &[cuboid(low.to_array(), high.to_array())]));
    }
    Assembly::new(parts).unwrap()
}
