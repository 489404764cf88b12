//! Convex bodies asked as solids: told by their hulls, they are answered as by the search.
//!
//! The judge is the same body twice, as two shells in one place: it is no convex solid, so it is searched.

use colltrans_convex::{Bounded, Cast, Clearance, ConvexPolyhedron, Outcome, Pose};
use colltrans_solid::{Solid, SolidCast, SolidFree, SolidOptions, StartOverlap};
use colltrans_testkit::bodies::solid;
use colltrans_testkit::cases;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{prism, ring_sphere};
use colltrans_testkit::solids::slab;
use glam::{DQuat, DVec3};

/// Cubes, plates, plates of many facets in a plane, prisms, balls of few and many facets.
fn bodies(random: &mut Random) -> Vec<Solid> {
    let (low, high) = (DVec3::new(-1.0, -0.75, -0.25), DVec3::new(1.0, 0.75, 0.25));
    let meshes = [
        slab(DVec3::splat(-0.5), DVec3::splat(0.5), [1, 1, 1]),
        slab(low, high, [1, 1, 1]),
        slab(low, high, [4, 3, 1]),
        prism(9, 0.5),
        ring_sphere(24, 15),
    ];
    let mut all: Vec<Solid> = meshes.iter().map(solid).collect();
    for count in [12, 90] {
        let points: Vec<DVec3> = (0..count).map(|_| random.direction()).collect();
        let hull = ConvexPolyhedron::from_points(&points).expect("a hull");
        all.push(Solid::from_convex(&hull).expect("a solid"));
    }
    all
}

/// The pairs of nodes that an answer took.
fn nodes(clearance: &Clearance<Solid>) -> u32 {
    match clearance {
        Clearance::Free(free) => free.steps.nodes,
        Clearance::Blocked { contact, .. } => contact.steps.nodes,
        Clearance::Overlapping(overlap) => overlap.steps.nodes,
    }
}

/// Two answers of bodies along a unit direction, shrunk by half of a tolerance.
fn assert_same(
    [hulls, search]: [&Clearance<Solid>; 2],
    (direction, tolerance): (DVec3, f64),
    what: &str,
) {
    match (hulls, search) {
        (Clearance::Blocked { contact: a, .. }, Clearance::Blocked { contact: b, .. }) => {
            let width = |x: Bounded| x.upper - x.lower;
            let (x, y) = (a.offset_distance, b.offset_distance);
            assert!((x.value - y.value).abs() < 1e-12, "{what}: {x:?}, but {y:?}");
            assert!(x.lower <= y.upper && y.lower <= x.upper, "{what}: {x:?}, but {y:?}");
            assert!(width(x) < 1e-10, "{what}: {x:?}");
            // Of facets that stop the shrunk bodies at once each pair has a true place of its own.
            let (x, y) = (a.translation, b.translation);
            let most = 1e-12 + width(x) + width(y) + 4.0 * tolerance / a.normal.dot(direction);
            assert!((x.value - y.value).abs() < most, "{what}: {x:?}, but {y:?}");
        }
        (Clearance::Free(a), Clearance::Free(b)) => {
            assert_eq!(a.separation.is_some(), b.separation.is_some(), "{what}");
        }
        _ => panic!("{what}: {hulls:?}, but {search:?}"),
    }
}

/// Beside, before and behind each other, near, touching and overlapping; turned and not; with all tolerances.
#[test]
fn convex_solids_are_answered_as_by_the_search() {
    let mut random = Random::new(31);
    let all = bodies(&mut random);
    let twice: Vec<Solid> =
        all.iter().map(|b| Solid::from_pieces([b, b]).expect("two pieces")).collect();
    let (mut told, mut blocked, mut free) = (0, 0, 0);
    let count = 3_000;
    for round in 0..count {
        let [i, j] = [0, 1].map(|_| random.range(0.0, all.len() as f64) as usize);
        let turned = |random: &mut Random| match round % 3 {
            0 => DQuat::IDENTITY,
            _ => random.rotation(),
        };
        let rotations = [turned(&mut random), turned(&mut random)];
        let direction =
            if round % 6 == 0 { DVec3::AXES[round / 6 % 3] } else { random.direction() };
        let aside = random.direction() * random.range(0.0, 4.0);
        let mut from = aside - direction * random.range(-3.0, 5.0);
        let poses = |from| {
            [(rotations[0], from), (rotations[1], DVec3::ZERO)]
                .map(|(q, at)| Pose::new(q, at).expect("a pose"))
        };
        // With an overlap ignored, if there is one: how deep it is takes long to tell.
        let ask = |bodies: &[Solid], from, options| {
            let [p, q] = poses(from);
            let cast = Cast::new(bodies[i].at(p), bodies[j].at(q), direction).expect("a query");
            let cast = cast.with_options(options).expect("choices");
            if cast.overlaps() {
                let ignoring = cast.with_start_overlap(StartOverlap::Ignore);
                let answer = ignoring.clearance().expect("an answer");
                assert!(nodes(&answer) > 0, "{answer:?} of bodies that overlap");
                return (answer, true);
            }
            let answer = cast.clearance().expect("an answer");
            if let Clearance::Free(SolidFree { separation: Some(plane), .. }) = &answer {
                assert!(cast.verify(plane).expect("a plane between them") >= plane.margin);
            }
            (answer, false)
        };
        let tolerance = [None, Some(0.0), Some(1e-6), Some(0.02)][round / 3 % 4];
        let mut options = SolidOptions::default().with_tolerance(tolerance);
        // Some are put forward until they are near or touch, or a little farther.
        let (answer, overlap) = ask(&twice, from, options);
        let distance = answer.distance().filter(|d| d.is_finite() && !overlap);
        if let Some(distance) = distance.filter(|_| round % 2 == 1) {
            from += direction * (distance - [0.05, 1e-6, 1e-12, 0.0, -1e-6][round % 5]);
        }
        if round % 7 == 0 {
            options = options.with_before(distance.map(|d| d * random.range(0.5, 1.5)));
        }
        let [(hulls, overlap), (search, again)] = [&all, &twice].map(|b| ask(b, from, options));
        assert_eq!(overlap, again, "{round}: {i} and {j}, {options:?}");
        let along = (direction, tolerance.unwrap_or(0.0));
        assert_same([&hulls, &search], along, &format!("{round}: {i} and {j}, {options:?}"));
        if overlap {
            continue;
        }
        told += usize::from(nodes(&hulls) == 0);
        *(if search.is_free() { &mut free } else { &mut blocked }) += 1;
    }
    println!("{told} of {count} told by hulls; {blocked} blocked, {free} free");
    assert!(blocked > count / 5 && free > count / 5 && blocked + free < count);
    assert!(told > count / 3, "{told} of {count} are told by hulls");
}

/// First and last contacts, also behind the start, and common points.
#[test]
fn contacts_of_convex_solids_are_those_of_the_search() {
    let mut random = Random::new(77);
    let all = bodies(&mut random);
    let twice: Vec<Solid> =
        all.iter().map(|b| Solid::from_pieces([b, b]).expect("two pieces")).collect();
    let (mut contacts, mut apart, mut alone) = (0, 0, 0);
    let count = cases(2_000);
    for round in 0..count {
        let [i, j] = [0, 1].map(|_| random.index(all.len()));
        let mut turned = || if round % 3 == 0 { DQuat::IDENTITY } else { random.rotation() };
        let rotations = [turned(), turned()];
        let direction =
            if round % 6 == 0 { DVec3::AXES[round as usize / 6 % 3] } else { random.direction() };
        let from =
            random.direction() * random.range(0.0, 2.5) - direction * random.range(-4.0, 4.0);
        let ask = |bodies: &[Solid]| {
            let [p, q] = [(rotations[0], from), (rotations[1], DVec3::ZERO)]
                .map(|(q, at)| Pose::new(q, at).expect("a pose"));
            let cast = Cast::new(bodies[i].at(p), bodies[j].at(q), direction).expect("a query");
            let meets = cast.intersects().expect("an answer").meets;
            (cast.first_contact().expect("an answer"), cast.exit(), meets)
        };
        let [(first, exit, meets), (searched, last, met)] = [ask(&all), ask(&twice)];
        let what = format!("{round}: {i} and {j}, {from}");
        assert_eq!(meets, met, "{what}");
        let agree = |x: Bounded, y: Bounded| {
            assert!(x.lower <= y.upper && y.lower <= x.upper, "{what}: {x:?}, but {y:?}");
            assert!(x.lower <= x.value && x.value <= x.upper, "{what}: {x:?}");
            assert!(x.upper - x.lower < 1e-10, "{what}: {x:?}");
        };
        match (exit, last) {
            (Some(x), Some(y)) => agree(x, y),
            (None, None) => {}
            _ => panic!("{what}: {exit:?}, but {last:?}"),
        }
        match (&first, &searched) {
            (Outcome::Contact(a), Outcome::Contact(b)) => {
                contacts += 1;
                alone += usize::from(a.steps.nodes == 0);
                agree(a.translation, b.translation);
                assert!(a.normal.dot(direction) > 0.0, "{what}");
            }
            (Outcome::Separated(a), Outcome::Separated(b)) => {
                apart += 1;
                assert_eq!(a.separation.is_some(), b.separation.is_some(), "{what}");
            }
            _ => panic!("{what}: {first:?}, but {searched:?}"),
        }
    }
    println!("{contacts} contacts, {alone} by hulls, {apart} apart, of {count}");
    assert!(contacts > count as usize / 3 && apart > count as usize / 10);
    assert!(alone > contacts / 2, "{alone} of {contacts}");
}

/// Convex solids that are ahead of each other, or pass each other narrowly, are told by their hulls' cast alone, without a
/// pair of facets, whatever they are made of; what is steep or grazes takes a few, and hardly anything a search.
#[test]
fn convex_solids_ahead_are_told_by_their_hulls_alone() {
    let mut random = Random::new(7);
    let all = bodies(&mut random);
    let hull = |body: &Solid| ConvexPolyhedron::from_points(body.vertices()).expect("a hull");
    let hulls: Vec<ConvexPolyhedron> = all.iter().map(hull).collect();
    let (mut asked, mut searched, mut alone, mut blocked, mut passing) = (0, 0, 0, 0, 0);
    for _ in 0..2_000 {
        let [i, j] = [0, 1].map(|_| random.range(0.0, all.len() as f64) as usize);
        let direction = random.direction();
        let start = random.direction() * random.range(0.0, 0.5) - direction * 4.0;
        let rotations = [random.rotation(), random.rotation()];
        let mut ask = |start| {
            let [p, q] = [(rotations[0], start), (rotations[1], DVec3::ZERO)]
                .map(|(q, at)| Pose::new(q, at).expect("a pose"));
            let cast = Cast::new(all[i].at(p), all[j].at(q), direction).expect("a query");
            let answer = cast.clearance().expect("an answer");
            let steps = match &answer {
                Clearance::Free(free) => free.steps,
                Clearance::Blocked { contact, .. } => contact.steps,
                Clearance::Overlapping(overlap) => overlap.steps,
            };
            asked += 1;
            searched += usize::from(steps.nodes > 0);
            alone += usize::from(steps.nodes + steps.leaves == 0);
            // What is proven of the hulls is what is told.
            if let Clearance::Blocked { distance, contact } = &answer
                && steps.leaves == 0
            {
                let cast = Cast::new(hulls[i].at(p), hulls[j].at(q), direction);
                let convex = cast.and_then(|cast| cast.clearance()).expect("an answer");
                let error = hulls[i].hull_error() + hulls[j].hull_error();
                let told = convex.distance().expect("a contact");
                assert!(*distance <= told && told - distance <= 32.0 * error, "{distance}, {told}");
                let (lower, value, upper) = {
                    let place = contact.translation;
                    (place.lower, place.value, place.upper)
                };
                assert!(lower == *distance && lower <= value && value <= upper);
            }
            !answer.is_free()
        };
        if !ask(start) {
            continue;
        }
        blocked += 1;
        let aside = random.direction().reject_from_normalized(direction).normalize();
        let (mut meets, mut misses) = (0.0, 4.0);
        while misses - meets > 0.01 {
            let middle = 0.5 * (meets + misses);
            *(if ask(start + aside * middle) { &mut meets } else { &mut misses }) = middle;
        }
        passing += usize::from(!ask(start + aside * misses));
    }
    println!("{alone} of {asked} told by hulls alone, {searched} searched");
    assert!(blocked > 1_000 && passing == blocked, "{blocked} blocked, {passing} passing");
    assert!(20 * alone > 17 * asked && 20 * searched < asked, "{alone}, {searched} of {asked}");
}

/// A plate on another one, of few facets in each plane or many: told without a look at nodes of the trees, but for the whole
/// bodies where they touch, and by a few facets at most, however many there are.
#[test]
fn plates_on_plates_are_told_without_a_search() {
    let (low, high) = (DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.25));
    // The height of the upper plate, its direction, and how far it goes.
    let cases = [
        (0.25, DVec3::NEG_Z, Some(0.0)),
        (0.25, DVec3::X, None),
        (0.25, DVec3::new(0.6, 0.8, 0.0), None),
        (0.25, DVec3::Z, None),
        (1.25, DVec3::NEG_Z, Some(1.0)),
        (0.251, DVec3::NEG_Z, Some(0.001)),
        (0.250_001, DVec3::X, None),
    ];
    let mut random = Random::new(5);
    let (mut asked, mut looked, mut told) = (0, 0, 0);
    for parts in [[1, 1, 1], [4, 4, 1], [24, 24, 2], [90, 90, 2]] {
        let body = solid(&slab(low, high, parts));
        for (height, direction, goes) in cases {
            for rotation in [DQuat::IDENTITY, random.rotation(), random.rotation()] {
                for _ in 0..8 {
                    let [x, y] = [0, 1].map(|_| random.range(-0.4, 0.4));
                    let [p, q] = [DVec3::new(x, y, height), DVec3::ZERO]
                        .map(|at| Pose::new(rotation, rotation * at).expect("a pose"));
                    let cast = Cast::new(body.at(p), body.at(q), rotation * direction);
                    let cast = cast.expect("a query");
                    let (answer, proof) = cast.certified_clearance().expect("an answer");
                    let gap = cast.verify(&proof).expect("a proof");
                    assert!(gap < 1e-11, "{gap}");
                    let what = format!("{parts:?}, {height}, {direction}: {answer:?}");
                    let leaves = match (cast.clearance().expect("an answer"), goes) {
                        (Clearance::Blocked { distance, contact }, Some(right)) => {
                            let translation = contact.translation;
                            assert!((translation.value - right).abs() < 1e-14, "{what}");
                            assert!(distance <= right + 1e-15 && translation.upper >= right);
                            assert!(translation.upper - translation.lower < 1e-11, "{what}");
                            assert_eq!(contact.moving_feature.kind(), "face", "{what}");
                            assert_eq!(contact.fixed_feature.kind(), "face", "{what}");
                            assert_eq!(contact.steps.nodes, 0, "{what}");
                            contact.steps.leaves
                        }
                        (Clearance::Free(free), None) => {
                            if let Some(plane) = &free.separation {
                                assert!(cast.verify(plane).expect("a plane") >= plane.margin);
                                told += 1;
                            }
                            assert!(free.steps.nodes <= 1 && free.steps.leaves == 0, "{what}");
                            0
                        }
                        _ => panic!("{what}"),
                    };
                    assert!(leaves <= 16, "{what}");
                    asked += 1;
                    looked += usize::from(leaves > 0);
                }
            }
        }
    }
    println!("{asked} plates, {looked} by facets, {told} with a plane between them");
    assert!(50 * looked < asked && 4 * told > asked, "{looked}, {told} of {asked}");
}

/// Sunk into each other by little, convex solids are seen to overlap by facets around the contact of their hulls; the least
/// tolerance is the one of the place that a search finds, and the proof names what the answer does.
/// Plates in different numbers of parts, whose sides and diagonals lie on each other's lines: facets that are said to stop
/// the body do, with more than an edge of their shadows in common.
#[test]
fn facets_of_plates_whose_sides_line_up_stop_the_body() {
    let (low, high) = (DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.25));
    let bodies = [[1, 1, 1], [2, 2, 1], [3, 2, 1], [4, 4, 1], [6, 3, 1]]
        .map(|parts| solid(&slab(low, high, parts)));
    let mut told = 0;
    for (moving, fixed) in bodies.iter().flat_map(|p| bodies.iter().map(move |q| (p, q))) {
        for (i, j) in (-11..=11).flat_map(|i| (-11..=11).map(move |j| (i, j))) {
            for direction in [DVec3::NEG_Z, DVec3::new(1.0, 0.0, -1.0), DVec3::new(1.0, 2.0, -3.0)]
            {
                let up = DVec3::new(f64::from(i) / 6.0, f64::from(j) / 6.0, 1.25);
                let start = Pose::from_translation(up - direction).expect("a pose");
                let cast = Cast::new(moving.at(start), fixed.at(Pose::IDENTITY), direction);
                let cast = cast.expect("a query");
                let (answer, proof) = cast.certified_clearance().expect("an answer");
                cast.verify(&proof).unwrap_or_else(|fault| panic!("{i} {j}: {fault} {answer:?}"));
                told += usize::from(nodes(&answer) == 0);
            }
        }
    }
    assert!(told > 10_000, "{told}");
}

#[test]
fn convex_solids_that_are_sunk_are_seen_to_overlap_at_their_contact() {
    let mut random = Random::new(19);
    let all = bodies(&mut random);
    let (mut asked, mut searched) = (0, 0);
    for round in 0..1_500 {
        let [i, j] = [0, 1].map(|_| random.range(0.0, all.len() as f64) as usize);
        let direction = random.direction();
        let start = random.direction() * random.range(0.0, 0.5) - direction * 4.0;
        let rotations = [random.rotation(), random.rotation()];
        let at = |start| {
            let [p, q] = [(rotations[0], start), (rotations[1], DVec3::ZERO)]
                .map(|(q, at)| Pose::new(q, at).expect("a pose"));
            Cast::new(all[i].at(p), all[j].at(q), direction).expect("a query")
        };
        let Clearance::Blocked { contact, .. } = at(start).clearance().expect("an answer") else {
            continue;
        };
        let by = [1e-9, 1e-6, 1e-4][round % 3];
        let cast = at(start + direction * (contact.translation.value + by));
        let (answer, proof) = cast.certified_clearance().expect("an answer");
        let Clearance::Overlapping(overlap) = answer else { panic!("{round}: {answer:?}") };
        assert_eq!(cast.clearance(), Ok(answer), "{round}");
        assert_eq!(cast.start_overlap(), Some(overlap), "{round}");
        assert_eq!(cast.verify(&proof), Ok(0.0), "{round}");
        let ignoring = cast.with_start_overlap(StartOverlap::Ignore);
        assert!(nodes(&ignoring.clearance().expect("an answer")) > 0, "{round}");
        let least = cast.least_tolerance().expect("a tolerance");
        let told = overlap.least_tolerance.expect("a tolerance");
        assert!((told - least).abs() <= 1e-12 * least + 1e-12, "{round}: {told}, but {least}");
        asked += 1;
        searched += usize::from(overlap.steps.nodes > 0);
    }
    println!("{searched} of {asked} are searched");
    assert!(asked > 1_000 && 20 * searched < asked, "{searched} of {asked}");
}

/// A vertex that rises over its face by so little that the hull is without it: what leaves the hull behind may overlap the
/// solid, and then no answer says that it is free.
#[test]
fn what_a_hull_lacks_is_not_left_behind() {
    const LAST: f64 = f64::EPSILON / 2.0;
    let (mut lacking, mut overlapping) = (0, 0);
    for rise in (10..130).step_by(8) {
        let mut bar = slab(DVec3::new(-0.02, -1.0, -0.02), DVec3::new(0.0, 1.0, 0.02), [1, 2, 2]);
        for v in bar.vertices.iter_mut().filter(|v| **v == DVec3::ZERO) {
            v.x = f64::from(rise) * LAST;
        }
        let bar = bar.triangulated();
        let Ok(bar) = Solid::from_mesh(&bar.vertices, &bar.faces) else { continue };
        let hull = ConvexPolyhedron::from_points(bar.vertices()).expect("a hull");
        lacking += usize::from(hull.vertices().len() < bar.vertices().len());
        let cube = solid(&slab(DVec3::splat(-0.001), DVec3::splat(0.001), [1, 1, 1]));
        for behind in (1..rise).step_by(3) {
            for direction in [DVec3::X, DVec3::new(1.0, 0.3, 0.2), DVec3::new(1.0, 2.0, 0.0)] {
                let place = DVec3::new(0.001 + f64::from(behind) * LAST, 0.0, 0.0);
                let pose = Pose::from_translation(place).expect("a pose");
                let cast = Cast::new(cube.at(pose), bar.at(Pose::IDENTITY), direction);
                let cast = cast.and_then(|cast| cast.with_tolerance(0.0)).expect("a query");
                let answer = cast.clearance().expect("an answer");
                let told = matches!(answer, Clearance::Overlapping(_));
                assert_eq!(told, cast.overlaps(), "{rise} {behind} {direction}: {answer:?}");
                overlapping += usize::from(told);
            }
        }
    }
    assert!(lacking > 2 && overlapping > 100, "{lacking} {overlapping}");
}

/// Plates with vertices off their planes by more than rounding, as files of few digits have them: facets that lean out are
/// not named for what lies over them, and the bounds are as near as those of a search.
#[test]
fn facets_of_dented_plates_stop_the_body() {
    let mut random = Random::new(3);
    for dent in [0.0, 1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 3e-10] {
        for round in 0..cases(400) {
            let mut plate = |parts| loop {
                let mut mesh = slab(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.25), parts);
                for v in &mut mesh.vertices {
                    *v += random.direction() * dent;
                }
                let mesh = mesh.triangulated();
                if let Ok(body) = Solid::from_mesh(&mesh.vertices, &mesh.faces) {
                    break body;
                }
            };
            let (moving, fixed) = (plate([3, 2, 1]), plate([2, 2, 1]));
            let rotation = if round % 2 == 0 { DQuat::IDENTITY } else { random.rotation() };
            let mut aside = |most: f64| random.range(-most, most);
            let direction = rotation * DVec3::new(aside(0.3), aside(0.3), -1.0);
            let above = rotation * DVec3::new(aside(1.0), aside(1.0), 1.25);
            let [p, q] = [above, DVec3::ZERO].map(|at| Pose::new(rotation, at).expect("a pose"));
            let cast = Cast::new(moving.at(p), fixed.at(q), direction).expect("a query");
            let (answer, proof) = cast.certified_clearance().expect("an answer");
            cast.verify(&proof)
                .unwrap_or_else(|fault| panic!("{dent} {round}: {fault} {answer:?}"));
            let Clearance::Blocked { contact, .. } = answer else { panic!("{answer:?}") };
            let bounds = contact.offset_distance;
            assert!(bounds.upper - bounds.lower < 1e-10, "{dent} {round}: {bounds:?}");
            let stop =
                cast.contact_of_triangles(contact.triangles).expect("a stop").offset_distance;
            assert!(
                (stop.value - bounds.value).abs() < 1e-11,
                "{dent} {round}: {stop:?} {bounds:?}"
            );
        }
    }
}
