//! Answers of C and C++ programs, compared to the bit with those of the library. The expected lines come from the
//! records, which the C interface uses for few queries.

use std::fmt::Write as _;

use colltrans::glam::{DQuat, DVec3};
use colltrans::motion::{Motion, MotionCast};
use colltrans::record::{
    CastRecord, ClearanceRecord, ContactRecord, DepthRecord, DistanceRecord, Ending, FeatureRecord,
    FeaturesRecord, MotionRecord, PairQuestion, Record, SolidClearanceRecord,
};
use colltrans::solid::{SolidCast, SolidPair};
use colltrans::{
    ByKind, Cast, Clearance, ConvexPolyhedron, FixedRotations, ObstacleId, Obstacles, Pair, Pose,
    SceneQuery, Solid, Tracker,
};

use crate::programs::{Language, Link, build, compilers, run};

const CASES: usize = 40;
const POINTS: usize = 16;
const ROWS: usize = 800;

/// The generator of `numbers.h`, and the lines that the programs print.
struct Lines {
    state: u64,
    text: String,
}

impl Lines {
    fn number(&mut self) -> f64 {
        self.state = self
            .state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.state >> 11) as f64 * 2.0_f64.powi(-52) - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::from_array([self.number(), self.number(), self.number()])
    }

    fn body(&mut self) -> ConvexPolyhedron {
        let points: Vec<DVec3> = (0..POINTS).map(|_| self.vector()).collect();
        ConvexPolyhedron::from_points(&points).expect("a body")
    }

    fn pose(&mut self, reach: f64) -> Pose {
        let mut square = 0.0;
        let mut xyzw = [0.0, 0.0, 0.0, 1.5];
        for entry in &mut xyzw {
            *entry += self.number();
            square += *entry * *entry;
        }
        let length = f64::sqrt(square);
        let translation = self.vector() * reach;
        Pose::new(DQuat::from_array(xyzw.map(|entry| entry / length)), translation).expect("a pose")
    }

    fn begin(&mut self, name: &str, outcome: Ending) {
        write!(self.text, "{name} {}", outcome_number(outcome)).unwrap();
    }

    fn end(&mut self) {
        self.text.push('\n');
    }

    fn put(&mut self, number: f64) {
        if number.is_nan() {
            self.text += " nan";
        } else {
            write!(self.text, " {:016x}", number.to_bits()).unwrap();
        }
    }

    fn put_some(&mut self, numbers: &[Option<f64>]) {
        for number in numbers {
            self.put(number.unwrap_or(f64::NAN));
        }
    }

    fn put_vector(&mut self, vector: Option<[f64; 3]>) {
        vector.unwrap_or([f64::NAN; 3]).into_iter().for_each(|number| self.put(number));
    }

    fn put_features(&mut self, features: Option<&FeaturesRecord>) {
        let [moving, fixed] = features
            .map_or([None; 2], |FeaturesRecord { moving, fixed }| [Some(moving), Some(fixed)]);
        for feature in [moving, fixed] {
            let kind = feature.map_or(0, |FeatureRecord { kind, .. }| {
                1 + ["vertex", "edge", "face"].iter().position(|of| of == kind).expect("a kind")
            });
            let vertex = |k: usize| {
                let vertex = feature.and_then(|of| of.vertices.get(k));
                vertex.map_or(-1, |vertex| i64::from(u32::from(*vertex)))
            };
            write!(self.text, " {kind}:{}:{}:{}", vertex(0), vertex(1), vertex(2)).unwrap();
        }
    }

    /// Writes a contact, after the safe travel of a clearance and before the numbers of solids.
    fn contact(&mut self, distance: f64, ways: [Option<f64>; 2], of: &ContactRecord) {
        let [lower, upper] = optional_pair(of.translation_bounds);
        let [first, last] = optional_pair(of.exit_bounds);
        self.put(distance);
        self.put_some(&[of.translation, lower, upper, of.exit, first, last]);
        self.put_some(&[ways[0], ways[1], of.overlap, of.margin, of.rounding, None, None]);
        self.put_vector(of.normal);
        self.put_vector(of.point);
        self.put_features(of.features.as_ref());
        self.end();
    }

    fn cast(&mut self, name: &str, of: &CastRecord) {
        self.begin(name, of.outcome);
        self.contact(f64::NAN, [None; 2], &of.contact);
    }

    fn clearance(&mut self, name: &str, of: &ClearanceRecord, featured: bool) {
        let distance = match of.outcome {
            Ending::Blocked => of.distance.expect("a distance"),
            Ending::Overlapping => f64::NAN,
            _ => f64::INFINITY,
        };
        let mut contact = of.contact.clone();
        contact.features = contact.features.filter(|_| featured);
        self.begin(name, of.outcome);
        self.contact(distance, [of.back, of.on], &contact);
    }

    fn solid_clearance(&mut self, name: &str, of: &SolidClearanceRecord) {
        let [lower, upper] = optional_pair(of.translation_bounds);
        let free = (of.outcome == Ending::Free).then_some(f64::INFINITY);
        let least = of.start_overlaps.first().and_then(|overlap| overlap.least_tolerance);
        self.begin(name, of.outcome);
        self.put_some(&[of.distance.or(free), of.translation, lower, upper]);
        self.put_some(&[None; 8]);
        self.put_some(&[of.tolerance, least]);
        self.put_vector(of.normal);
        self.put_vector(of.point);
        self.put_features(of.features.as_ref());
        self.end();
    }

    fn distance(&mut self, name: &str, of: &DistanceRecord) {
        let [moving, fixed] = of.points.map_or([None; 2], |points| points.map(Some));
        self.begin(name, of.outcome);
        self.put(of.lower.unwrap_or(0.0));
        self.put(of.upper.unwrap_or(f64::INFINITY));
        for vector in [of.normal, moving, fixed] {
            self.put_vector(vector);
        }
        self.put_features(of.features.as_ref());
        self.end();
    }

    fn depth(&mut self, name: &str, of: &DepthRecord) {
        let least = of.start_overlaps.first().and_then(|overlap| overlap.least_tolerance);
        self.begin(name, of.outcome);
        self.put_some(&[of.lower, of.upper, least]);
        self.put_vector(of.direction);
        self.end();
    }

    fn motion(&mut self, name: &str, of: &MotionRecord) {
        let least = of.start_overlaps.first().and_then(|overlap| overlap.least_tolerance);
        let upper = of.time.map(|time| time.upper.unwrap_or(f64::INFINITY));
        self.begin(name, of.outcome);
        self.put_some(&[of.time.map(|time| time.lower), upper, of.tolerance, least]);
        self.put_vector(of.normal);
        self.put_vector(of.point);
        self.put_features(of.features.as_ref());
        self.end();
    }
}

fn optional_pair(pair: Option<[f64; 2]>) -> [Option<f64>; 2] {
    pair.map_or([None; 2], |pair| pair.map(Some))
}

/// Returns the number of an outcome in the header.
fn outcome_number(outcome: Ending) -> usize {
    let all = "error contact grazing separated free blocked slides behind overlapping apart touching \
               meeting closer farther undecided";
    all.split_whitespace().position(|name| name == outcome.name()).expect("an outcome")
}

fn pairs(to: &mut Lines) {
    for _ in 0..CASES {
        let (p, q) = (to.body(), to.body());
        let (a, b) = (to.pose(2.5), to.pose(2.5));
        let direction = to.vector();
        let solid = Solid::from_pieces([&p, &q]).expect("a solid");
        let ball = p.clone().rounded(0.125).expect("a body");

        let cast = Cast::new(p.at(a), q.at(b), direction).expect("a cast");
        let outcome = cast.first_contact().expect("an answer");
        to.cast("first_contact", &CastRecord::of_outcome(&outcome, &cast));
        let range = cast.contact_range().expect("an answer");
        to.cast("contact_range", &CastRecord::of_range(&range, &cast));
        let clearance = cast.clearance().expect("an answer");
        to.clearance("clearance", &ClearanceRecord::from_clearance(&clearance, &cast), true);
        let gap =
            Cast::new(ball.at(a), q.at(b), direction).and_then(|cast| cast.with_min_gap(0.0625));
        let gap = gap.expect("a cast");
        let clearance = gap.clearance().expect("an answer");
        to.clearance("clearance_gap", &ClearanceRecord::from_clearance(&clearance, &gap), true);
        let solids = Cast::between(solid.at(a), q.at(b), direction).expect("a cast");
        let clearance = solids.clearance().expect("an answer");
        let record = SolidClearanceRecord::from_clearance(&clearance, None, &solids);
        to.solid_clearance("clearance_solid", &record);

        let mut tracker = Tracker::new();
        tracker.first_contact(&cast).expect("an answer");
        let back = Cast::new(p.at(b), q.at(a), direction).expect("a cast");
        let outcome = tracker.first_contact(&back).expect("an answer");
        to.cast("tracked", &CastRecord::of_outcome(&outcome, &back));
        let pair = Pair::new(p.at(a), q.at(b)).expect("a pair");
        let distance = tracker.distance(&pair).expect("an answer");
        to.distance("tracked_distance", &DistanceRecord::from_distance(&distance, &pair));
        let cast = Cast::new(p.at(a), q.at(b), DVec3::Z).expect("a cast");
        let meets = u32::from(cast.intersects().expect("an answer").meets);
        writeln!(to.text, "intersects {meets}").unwrap();

        let distance = pair.distance().expect("an answer");
        to.distance("distance", &DistanceRecord::from_distance(&distance, &pair));
        let solids: Pair<'_, Solid> = Pair::between(solid.at(a), q.at(b)).expect("a pair");
        let distance = solids.distance().expect("an answer");
        to.distance("distance_solid", &DistanceRecord::of_solids(&distance, &solids));
        let round = Pair::new(ball.at(a), q.at(b)).expect("a pair");
        to.text += "bounds";
        round.distance_bounds().expect("an answer").into_iter().for_each(|bound| to.put(bound));
        to.end();
        let within = PairQuestion::Within(1.0).answer(&pair).expect("an answer").record(&pair);
        let Record::Distance(within) = within else { panic!("{within:?}") };
        to.distance("within", &within);
        let pair = Pair::new(p.at(Pose::IDENTITY), q.at(b)).expect("a pair");
        to.depth("depth", &DepthRecord::from_depth(&pair.depth().expect("an answer")));
        let solids: Pair<'_, Solid> =
            Pair::between(solid.at(Pose::IDENTITY), q.at(b)).expect("a pair");
        let depth = PairQuestion::Depth.answer_solids(&solids).expect("an answer").record(&solids);
        let Ok(Record::Depth(depth)) = depth else { panic!("{depth:?}") };
        to.depth("depth_solid", &depth);
    }
}

fn motions(to: &mut Lines) {
    for k in 0..CASES {
        let (p, q) = (to.body(), to.body());
        let poses = [to.pose(2.5), to.pose(2.5)];
        let solid = Solid::from_pieces([&p]).expect("a solid");
        let way = Motion::through_poses(&poses).expect("a motion");
        let rest = Motion::at_rest(Pose::IDENTITY);
        let cast = MotionCast::new(p.with_motion(&way), q.with_motion(&rest)).expect("a cast");
        let outcome = cast.first_contact().expect("an answer");
        to.motion("motion", &MotionRecord::from_outcome(&outcome, &cast));
        let clearance = cast.clearance().expect("an answer");
        to.motion("motion_clearance", &MotionRecord::of_clearance(&clearance, &cast));
        if k % 8 == 0 {
            let cast = MotionCast::between_any(solid.with_motion(&way), q.with_motion(&rest));
            let cast = cast.expect("a cast");
            let outcome = cast.first_contact().expect("an answer");
            to.motion("motion_solid", &MotionRecord::of_solids(&outcome, &cast));
        }
    }
}

fn scenes(to: &mut Lines) {
    let hand = to.body();
    let mut scene = Obstacles::new();
    for _ in 0..CASES {
        let body = to.body();
        scene.insert(body, to.pose(9.0));
    }
    for _ in 0..CASES {
        let (pose, direction) = (to.pose(9.0), to.vector());
        let own = |id: ObstacleId| id.0 == 3;
        let all = SceneQuery::new(hand.at(pose), &scene).expect("a query");
        let query = all.ignoring(&own);
        let nearest = query.nearest().expect("an answer").expect("obstacles");
        let ByKind::Convex(distance) = nearest.distance else { panic!("convex bodies") };
        write!(to.text, "{} ", nearest.obstacle.0).unwrap();
        let (body, at) = scene.get(nearest.obstacle).expect("an obstacle");
        let ByKind::Convex(body) = body else { panic!("convex bodies") };
        let pair = Pair::new(hand.at(pose), body.at(at)).expect("a pair");
        let mut record = DistanceRecord::from_distance(&distance, &pair);
        (record.lower, record.features) = (Some(nearest.lower), None);
        to.distance("nearest", &record);

        let found = query.clearance(direction).expect("an answer");
        if let Some((id, ByKind::Convex(clearance))) = &found.stop {
            let (body, at) = scene.get(*id).expect("an obstacle");
            let ByKind::Convex(body) = body else { panic!("convex bodies") };
            let cast = Cast::new(hand.at(pose), body.at(at), direction).expect("a cast");
            let mut record = ClearanceRecord::from_clearance(clearance, &cast);
            if matches!(clearance, Clearance::Blocked { .. }) {
                record.distance = Some(found.lower);
            }
            write!(to.text, "{} ", id.0).unwrap();
            to.clearance("scene_clearance", &record, false);
        } else {
            write!(to.text, "{} ", colltrans_c::COLLTRANS_NO_OBSTACLE).unwrap();
            let record = ClearanceRecord::default();
            to.begin("scene_clearance", Ending::Free);
            to.contact(found.lower, [None; 2], &record.contact);
        }
        let near = all.within(3.0).expect("an answer");
        write!(to.text, "scene_within {} {}", near.closer.len(), near.undecided.len()).unwrap();
        near.closer.iter().for_each(|(id, _)| write!(to.text, " {}", id.0).unwrap());
        to.end();
    }
}

fn many(to: &mut Lines, rotates: bool, direction_count: usize) {
    let (p, q) = (to.body(), to.body());
    let directions: Vec<DVec3> = (0..direction_count).map(|_| to.vector()).collect();
    let mut poses: Vec<Pose> = Vec::new();
    for _ in 0..ROWS {
        let pose = to.pose(3.0);
        let shared = poses.first().filter(|_| !rotates);
        let shared =
            shared.map(|first| first.with_translation(pose.translation()).expect("a pose"));
        poses.push(shared.unwrap_or(pose));
    }
    let world = Pose::IDENTITY;
    let least = FixedRotations::break_even_casts(&p, &q).expect("solid bodies");
    assert!(least <= ROWS, "{least} rows share data");
    let rotations = FixedRotations::new(p.at(poses[0]), q.at(world));
    let map = rotations.for_direction(directions[0]).expect("a direction");
    for (pose, direction) in poses.iter().zip(directions.iter().cycle()) {
        let cast = Cast::new(p.at(*pose), q.at(world), *direction).expect("a cast");
        let answer = match (rotates, direction_count) {
            (true, _) => cast.clearance(),
            (false, 1) => map.clearance(&cast),
            _ => rotations.clearance(&cast),
        };
        let record = ClearanceRecord::from_clearance(&answer.expect("an answer"), &cast);
        let free = (record.outcome != Ending::Overlapping).then_some(f64::INFINITY);
        to.begin("many 0", record.outcome);
        to.put_some(&[record.distance.or(free)]);
        to.put_vector(record.contact.normal);
        to.end();
    }
    for pose in &poses {
        let pair = Pair::new(p.at(*pose), q.at(world)).expect("a pair");
        to.text += "many_distances";
        to.put(pair.distance().expect("an answer").lower);
        to.end();
    }
}

fn expected() -> String {
    let mut lines = Lines { state: 1, text: String::new() };
    pairs(&mut lines);
    motions(&mut lines);
    scenes(&mut lines);
    many(&mut lines, true, 1);
    many(&mut lines, false, 1);
    many(&mut lines, false, ROWS);
    lines.text
}

fn compare(language: Language, link: Link) {
    let expected = expected();
    assert!(expected.lines().count() > 15 * CASES + 4 * ROWS, "too few lines");
    for compiler in compilers(language) {
        let found = run(&build(compiler, language, link, "tests/c_interface/numbers"));
        for (k, (found, expected)) in found.lines().zip(expected.lines()).enumerate() {
            assert_eq!(found, expected, "{compiler}: line {k}");
        }
        assert_eq!(found.len(), expected.len(), "{compiler}");
    }
}

#[test]
fn a_c_program_gets_the_bits_of_the_library() {
    compare(Language::C, Link::Shared);
}

#[test]
#[ignore = "long: compiles C++"]
fn a_cpp_program_gets_the_bits_of_the_library() {
    compare(Language::Cpp, Link::Static);
}
