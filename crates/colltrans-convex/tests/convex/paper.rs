//! Who asks for `cta` gets the paper: planar problems from the centre of the levels, or from `N(p)`, to the exit
//! test, and then the one portal that makes the certificate. Work is counted, never timed.

use colltrans_convex::{
    Cast, Contact, ContactRange, ConvexPolyhedron, Focus, Options, Outcome, Pose, Solver,
    StartedFrom, Tracker, cta,
};
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{
    Mesh, cone, cuboid, even_rings, half_sphere, prism, random_hull, ring_sphere, superellipsoid,
};
use glam::{DQuat, DVec3};

/// Settings of each kind of bodies.
const SETTINGS: usize = 100;

/// Bodies of about so many vertices, by name.
fn kinds(n: usize) -> Vec<(&'static str, ConvexPolyhedron)> {
    let [around, rings] = even_rings(n);
    let sphere = || ring_sphere(around, rings);
    let meshes = [
        ("sphere", sphere()),
        ("ellipsoid", sphere().mapped(|v| v * DVec3::new(1.0, 0.7, 0.5))),
        ("thin", sphere().mapped(|v| v * DVec3::new(1.0, 0.8, 0.05))),
        ("half sphere", half_sphere(n)),
        ("superellipsoid", superellipsoid(n, 4.0)),
        ("prism", prism(n / 2, 0.7)),
        ("cone", cone(n, [-0.5, 0.8])),
        ("hull", random_hull(n, &mut Random::new(5))),
    ];
    let hull = |Mesh { vertices, .. }| ConvexPolyhedron::from_points(&vertices).expect("a body");
    meshes.map(|(name, mesh)| (name, hull(mesh))).into()
}

fn cast<'a>(body: &'a ConvexPolyhedron, random: &mut Random) -> Cast<'a> {
    let direction = random.direction();
    let aside = random.direction() * random.range(0.0, 0.5);
    let start = Pose::new(random.rotation(), aside - direction * 3.0).expect("a pose");
    let target = Pose::new(random.rotation(), DVec3::ZERO).expect("a pose");
    Cast::new(body.at(start), body.at(target), direction).expect("a query")
}

fn contact(outcome: Outcome) -> Option<Contact> {
    match outcome {
        Outcome::Contact(contact) => Some(contact),
        _ => None,
    }
}

fn with<'a>(cast: &Cast<'a>, narrowing: cta::Options) -> Cast<'a> {
    let options = Options::default().with_solver(Solver::Cta).with_narrowing(narrowing);
    cast.with_options(options).expect("options")
}

#[test]
fn every_contact_is_found_by_planar_problems_and_proven_by_one_portal() {
    for n in [200, 3_200] {
        for (name, body) in kinds(n) {
            let mut random = Random::new(11);
            let (mut problems, mut pivots, mut contacts) = (0, 0, 0);
            for _ in 0..SETTINGS {
                let cast = cast(&body, &mut random);
                let found = cast.with_solver(Solver::Cta).first_contact().expect("an answer");
                let Some(found) = contact(found) else { continue };
                let steps = found.steps;
                assert!(steps.planar_problems > 0 && steps.iterations > 0, "{name}: {steps:?}");
                assert!((3..=8).contains(&steps.region_sides) || steps.planar_problems == 1);
                contacts += 1;
                problems += steps.planar_problems;
                pivots += steps.pivots;
                let known = contact(cast.first_contact().expect("an answer")).expect("it meets");
                let [a, b] = [found.certificate, known.certificate];
                assert!(a.lower <= b.upper && b.lower <= a.upper, "{name}: {a:?} {b:?}");
            }
            let mean = |sum: u32| f64::from(sum) / f64::from(contacts);
            let [problems, pivots] = [mean(problems), mean(pivots)];
            // Faces from end to end, as narrow as edges are many: the exit is seen late.
            let most = if ["prism", "cone"].contains(&name) { 20.0 } else { 14.0 };
            assert!(contacts > 80 && problems > 3.0 && problems < most, "{name} {n}: {problems}");
            // One portal confirms what the exit test has found, but where it misses.
            assert!(pivots < 3.0, "{name} of {n} vertices: {pivots} portals after {problems}");
        }
    }
}

#[test]
fn guessed_solution_saves_planar_problems_but_no_proof() {
    for n in [200, 3_200] {
        for (name, body) in kinds(n) {
            let mut random = Random::new(12);
            // Planar problems and pivots from the centre, in N(p), and in N(p) with shifts across cells.
            let [mut problems, mut pivots] = [[0; 3]; 2];
            let mut contacts = 0;
            for _ in 0..SETTINGS {
                let cast = cast(&body, &mut random);
                let Some(known) = contact(cast.first_contact().expect("an answer")) else {
                    continue;
                };
                contacts += 1;
                let guess = cta::Options::new(cta::Start::Guess, cta::Until::Exit);
                let starts = [cta::Options::default(), guess, guess.with_keeps_to_cell(false)];
                for (k, start) in starts.into_iter().enumerate() {
                    let found = with(&cast, start).first_contact().expect("an answer");
                    let found = contact(found).expect("it meets");
                    let steps = found.steps;
                    // Portal refinement must not answer instead of planar problems.
                    assert!(steps.planar_problems > 0 && steps.iterations > 0, "{name}: {steps:?}");
                    assert_eq!(steps.started_from, StartedFrom::Scratch);
                    problems[k] += steps.planar_problems;
                    pivots[k] += steps.pivots;
                    let [a, b] = [found.certificate, known.certificate];
                    assert!(a.lower <= b.upper && b.lower <= a.upper, "{name}: {a:?} {b:?}");
                }
            }
            let mean = |sum: u32| f64::from(sum) / f64::from(contacts);
            let [center, guess, across] = problems.map(mean);
            assert!(contacts > 80, "{name} {n}: {contacts}");
            assert!(guess < 0.75 * center, "{name} {n}: {guess} of {center}");
            assert!(across < 0.6 * center, "{name} {n}: {across} of {center}");
            for pivots in pivots.map(mean) {
                assert!(pivots < 3.0, "{name} {n}: {pivots} portals");
            }
        }
    }
}

#[test]
fn faces_give_a_guess_that_few_planar_problems_solve() {
    let sides = DVec3::new(1.0, 0.7, 0.5);
    let kinds = [
        ("box", cuboid(sides), 1.3),
        ("prism of 6 sides", prism(6, 0.7), 1.5),
        ("prism of 100 sides", prism(100, 0.7), 1.5),
        ("prism of 1,600 sides", prism(1_600, 0.7), 1.5),
    ];
    for (name, mesh, most) in kinds {
        let body = ConvexPolyhedron::from_points(&mesh.vertices).expect("a body");
        let mut random = Random::new(16);
        let [mut problems, mut pivots, mut contacts] = [0; 3];
        for _ in 0..3 * SETTINGS {
            let cast = cast(&body, &mut random);
            let guess = cta::Options::new(cta::Start::Guess, cta::Until::Exit);
            let guess = with(&cast, guess.with_keeps_to_cell(false));
            let Some(found) = contact(guess.first_contact().expect("an answer")) else { continue };
            assert!(found.steps.planar_problems > 0, "{name}: {:?}", found.steps);
            contacts += 1;
            problems += found.steps.planar_problems;
            pivots += found.steps.pivots;
            let known = contact(cast.first_contact().expect("an answer")).expect("it meets");
            let [a, b] = [found.certificate, known.certificate];
            assert!(a.lower <= b.upper && b.lower <= a.upper, "{name}: {a:?} {b:?}");
        }
        let mean = |sum: u32| f64::from(sum) / f64::from(contacts);
        let [problems, pivots] = [mean(problems), mean(pivots)];
        assert!(contacts > 200 && problems < most, "{name}: {problems} in {contacts}");
        // The exit test sees the vertex of one body on a face of the other, also on a face of many sides.
        assert!(pivots < 1.05, "{name}: {pivots} portals");
    }
}

#[test]
fn last_contact_starts_from_the_first_one() {
    for n in [200, 3_200] {
        for (name, body) in kinds(n) {
            let mut random = Random::new(15);
            let [mut alone, mut after, mut pivots, mut contacts] = [0; 4];
            for _ in 0..SETTINGS {
                let cast = cast(&body, &mut random).with_solver(Solver::Cta);
                let ContactRange::Contact { first, last } = cast.contact_range().expect("a range")
                else {
                    continue;
                };
                let [entry, known] = [cast, cast.reversed()].map(|cast| {
                    contact(cast.first_contact().expect("an answer")).expect("it meets")
                });
                assert_eq!((first.certificate, first.steps), (entry.certificate, entry.steps));
                assert!(last.steps.planar_problems > 0, "{name}: {:?}", last.steps);
                contacts += 1;
                alone += known.steps.planar_problems;
                after += last.steps.planar_problems;
                pivots += last.steps.pivots;
                let [a, b] = [last.certificate, known.certificate];
                assert!(a.lower <= b.upper && b.lower <= a.upper, "{name}: {a:?} {b:?}");
            }
            assert!(contacts > 80 && 4 * after < 3 * alone, "{name} {n}: {after} of {alone}");
            assert!(pivots < 3 * contacts, "{name} {n}: {pivots} portals in {contacts}");
        }
    }
}

#[test]
fn guess_of_passing_bodies_starts_at_the_centre() {
    let (_, body) = kinds(800).swap_remove(1);
    let mut random = Random::new(14);
    for _ in 0..SETTINGS {
        let aside = random.direction().cross(DVec3::X).normalize() * 2.5;
        let start = Pose::new(random.rotation(), aside - DVec3::X * 3.0).expect("a pose");
        let target = Pose::new(random.rotation(), DVec3::ZERO).expect("a pose");
        let cast = Cast::new(body.at(start), body.at(target), DVec3::X).expect("a query");
        let of = |start| {
            let outcome = with(&cast, cta::Options::new(start, cta::Until::Exit)).first_contact();
            let outcome = outcome.expect("an answer");
            assert!(matches!(outcome, Outcome::Separated(_)));
            outcome.steps()
        };
        assert_eq!(of(cta::Start::Guess), of(cta::Start::Center));
    }
}

#[test]
fn a_tracker_begins_in_the_neighbourhood_of_the_last_solution() {
    let (_, body) = kinds(3_200).swap_remove(1);
    let mut random = Random::new(3);
    let (mut scratch, mut tracked, mut queries) = (0, 0, 0);
    for _ in 0..10 {
        let first = cast(&body, &mut random);
        let mut tracker = Tracker::new();
        for step in 0..20 {
            let turn = DQuat::from_axis_angle(DVec3::Z, 1e-3 * f64::from(step));
            let pose = first.moving_pose();
            let turned = DQuat::from_mat3(&pose.matrix()) * turn;
            let pose = Pose::new(turned.normalize(), pose.translation()).expect("a pose");
            let cast = Cast::new(body.at(pose), body.at(first.fixed_pose()), first.direction());
            let cast = cast.expect("a query").with_solver(Solver::Cta);
            let Some(found) = contact(tracker.first_contact(&cast).expect("an answer")) else {
                continue;
            };
            let from = if step == 0 { StartedFrom::Scratch } else { StartedFrom::Region };
            assert_eq!(found.steps.started_from, from);
            let alone = contact(cast.first_contact().expect("an answer")).expect("it meets");
            if step > 0 {
                queries += 1;
                tracked += found.steps.planar_problems;
                scratch += alone.steps.planar_problems;
            }
        }
    }
    assert!(queries > 100 && 2 * tracked < scratch, "{tracked} of {scratch} in {queries}");
}

#[test]
fn starts_ends_and_focus_can_be_chosen() {
    let (_, body) = kinds(800).swap_remove(1);
    let mut random = Random::new(9);
    let (mut of_whole, mut of_part, mut of_rough) = (0, 0, 0);
    for _ in 0..SETTINGS {
        let cast = cast(&body, &mut random);
        let part = cta::Options::new(cta::Start::Center, cta::Until::Gap(0.1));
        let problems = |narrowing| {
            let outcome = with(&cast, narrowing).first_contact().expect("an answer");
            contact(outcome).map_or(0, |contact| contact.steps.planar_problems)
        };
        of_whole += problems(cta::Options::default());
        of_part += problems(part);
        of_rough += problems(cta::Options::ROUGH);
    }
    assert!(of_rough < of_part && 3 * of_part < 2 * of_whole, "{of_rough} {of_part} {of_whole}");
    // Features first, if it is asked for.
    let cast = cast(&body, &mut random).with_solver(Solver::Cta);
    let focus = Focus::default().with_region(cta::Region::Everywhere);
    let mut tracker = Tracker::new().with_focus(focus).expect("a focus");
    for from in [StartedFrom::Scratch, StartedFrom::Features] {
        let outcome = tracker.first_contact(&cast).expect("an answer");
        assert_eq!(outcome.steps().started_from, from);
    }
}
