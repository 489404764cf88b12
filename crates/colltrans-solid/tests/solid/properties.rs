//! What holds between solids for every setting, random or tied.

use colltrans_convex::{Cast, Clearance, Pose};
use colltrans_solid::{ShellKind, Solid, SolidCast, SolidOptions};
use colltrans_testkit::oracle::solids::settings::{FAMILIES, Setting};
use colltrans_testkit::oracle::solids::sheets;
use glam::DVec3;
use proptest::prelude::*;

/// Any setting of any family.
fn any_setting() -> impl Strategy<Value = Setting> {
    (0..FAMILIES.len(), any::<u32>())
        .prop_map(|(family, seed)| Setting::draw(FAMILIES[family], seed.into()).expect("a family"))
}

type Mesh = (Vec<DVec3>, Vec<Vec<u32>>);

fn solid((vertices, facets): &Mesh) -> Solid {
    Solid::from_mesh(vertices, facets).expect("a closed mesh")
}

/// What was answered, with numbers: an overlap, a distance (of the shrunk bodies), nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Said {
    Overlapping,
    Free,
    At(f64),
}

fn said(answer: &Clearance<Solid>) -> Said {
    match answer {
        Clearance::Overlapping(_) => Said::Overlapping,
        Clearance::Free(_) => Said::Free,
        Clearance::Blocked { contact, .. } => Said::At(contact.offset_distance.value),
    }
}

fn agree(a: Said, b: Said) -> bool {
    match (a, b) {
        (Said::At(x), Said::At(y)) => (x - y).abs() <= 1e-11 * (1.0 + x.abs()),
        _ => a == b,
    }
}

fn bare() -> SolidOptions {
    SolidOptions::default().with_tolerance(0.0)
}

/// A translation on the way is rounded, and what slides exactly may overlap by as much.
#[expect(clippy::large_types_passed_by_value, reason = "it is turned into another one")]
fn slightly_shrunk(cast: Cast<'_, Solid>) -> Cast<'_, Solid> {
    cast.with_tolerance(1e-9).expect("a tolerance")
}

fn ask_at([a, b]: [&Solid; 2], poses: [Pose; 2], direction: DVec3) -> Said {
    let cast = Cast::new(a.at(poses[0]), b.at(poses[1]), direction).expect("a direction");
    said(&cast.with_options(bare()).expect("choices").clearance().expect("an answer"))
}

fn ask(meshes: [&Mesh; 2], poses: [Pose; 2], direction: DVec3) -> Said {
    let [a, b] = meshes.map(solid);
    ask_at([&a, &b], poses, direction)
}

/// Facets in another order, each beginning with another corner.
fn permuted((vertices, facets): &Mesh, by: usize) -> Mesh {
    let mut facets = facets.clone();
    let count = facets.len();
    facets.rotate_left(by % count);
    if by % 2 == 1 {
        facets.reverse();
    }
    for (k, facet) in facets.iter_mut().enumerate() {
        let corners = facet.len();
        facet.rotate_left((by + k) % corners);
    }
    (vertices.clone(), facets)
}

/// Each triangle, where its corners' mean with weights 1/2, 1/4, 1/4 is exact, split there.
fn subdivided((vertices, facets): &Mesh, by: usize) -> Mesh {
    let mut vertices = vertices.clone();
    let mut finer = Vec::new();
    for (k, facet) in facets.iter().enumerate() {
        let &[a, b, c] = &facet[..] else {
            finer.push(facet.clone());
            continue;
        };
        if (k + by).is_multiple_of(3) {
            finer.push(facet.clone());
            continue;
        }
        let at = |v: u32| vertices[v as usize];
        let middle = at(a) * 0.5 + at(b) * 0.25 + at(c) * 0.25;
        // Whole numbers and a few bits: nothing is rounded.
        assert_eq!(middle * 64.0, (middle * 64.0).round());
        let m = vertices.len() as u32;
        vertices.push(middle);
        finer.extend([vec![a, b, m], vec![b, c, m], vec![c, a, m]]);
    }
    (vertices, finer)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(192))]

    /// A blocked by B along `d` is B blocked by A against it.
    #[test]
    fn blocking_is_mutual(setting in any_setting()) {
        let [a, b] = &setting.surfaces;
        let d = setting.direction;
        let forth = ask([a, b], setting.poses, d);
        let back = ask([b, a], [setting.poses[1], setting.poses[0]], -d);
        prop_assert!(agree(forth, back), "{forth:?} and {back:?}");
    }

    /// Facets may come in any order.
    #[test]
    fn order_plays_no_part(setting in any_setting(), by in 1_usize..1_000) {
        let [a, b] = &setting.surfaces;
        let first = ask([a, b], setting.poses, setting.direction);
        let other = ask(
            [&permuted(a, by), &permuted(b, by / 2 + 1)],
            setting.poses,
            setting.direction,
        );
        prop_assert!(agree(first, other), "{first:?} and {other:?}");
    }

    /// Facets may be split where nothing is rounded.
    #[test]
    fn subdivision_plays_no_part(setting in any_setting(), by in 0_usize..6) {
        let [a, b] = &setting.surfaces;
        let first = ask([a, b], setting.poses, setting.direction);
        let finer = [subdivided(a, by), subdivided(b, by + 1)];
        let other = ask([&finer[0], &finer[1]], setting.poses, setting.direction);
        prop_assert!(agree(first, other), "{first:?} and {other:?}");
    }

    /// Both bodies may be moved together, as far as nothing is rounded.
    #[test]
    fn displacements_play_no_part(setting in any_setting(), by in prop::array::uniform3(-4_096..4_096_i32)) {
        let by = DVec3::from_array(by.map(f64::from)) * 0.25;
        let moved = setting.poses.map(|p| (p.translation() + by, p));
        // In families with rounded translations the sum may round; then it is another setting.
        prop_assume!(moved.iter().all(|(t, p)| *t - by == p.translation()));
        let poses = moved.map(|(t, p)| Pose::from_matrix(p.matrix(), t).expect("in range"));
        prop_assume!(
            poses[1].translation() - poses[0].translation()
                == setting.poses[1].translation() - setting.poses[0].translation()
        );
        let [a, b] = &setting.surfaces;
        let first = ask([a, b], setting.poses, setting.direction);
        let other = ask([a, b], poses, setting.direction);
        prop_assert!(agree(first, other), "{first:?} and {other:?}");
    }

    /// 0.999 of the way nothing overlaps, and from the end on nothing is in the way any more.
    #[test]
    fn the_way_is_free_and_the_exit_final(setting in any_setting()) {
        let bodies = [solid(&setting.surfaces[0]), solid(&setting.surfaces[1])];
        let d = setting.direction;
        let ask_from = |t: f64| {
            let start = setting.poses[0].translated_by(d * t).expect("in range");
            let cast = Cast::new(bodies[0].at(start), bodies[1].at(setting.poses[1]), d);
            cast.and_then(|c| c.with_options(bare())).expect("choices")
        };
        let stuck = |s: &Solid| !s.shrink_report(1e-9).fixed_vertices.is_empty();
        prop_assume!(!stuck(&bodies[0]) && !stuck(&bodies[1]));
        let here = ask_from(0.0);
        if let Said::At(t) = said(&here.clearance().expect("an answer")) && t > 1e-9 {
            prop_assert!(!slightly_shrunk(ask_from(0.999 * t)).overlaps());
            // A sliver that only just blocks may be gone where the translation is rounded.
            let shrunk = said(&slightly_shrunk(here).clearance().expect("an answer"));
            let is_sliver = !matches!(shrunk, Said::At(s) if s < t + 1e-7 * (1.0 + t));
            prop_assert!(is_sliver || ask_from(t + 1e-6 * (1.0 + t)).overlaps());
        }
        let exit = here.exit().map_or(0.0, |exit| exit.upper * (1.0 + 1e-15));
        let beyond = slightly_shrunk(ask_from(exit)).clearance().expect("an answer");
        prop_assert!(beyond.is_free(), "{exit}: {beyond:?}");
    }

    /// With a tolerance the shrunk bodies go no shorter way; what is said of the bodies as they are is
    /// not beyond that, and its bounds are in order.
    #[test]
    fn a_tolerance_lengthens_the_way(setting in any_setting(), tolerance in 1e-6..1e-2_f64) {
        let [a, b] = [solid(&setting.surfaces[0]), solid(&setting.surfaces[1])];
        let cast = Cast::new(a.at(setting.poses[0]), b.at(setting.poses[1]), setting.direction)
            .and_then(|c| c.with_options(bare()))
            .expect("a direction");
        let shrunk = cast.with_tolerance(tolerance).expect("a tolerance").clearance().expect("an answer");
        let stuck = [&a, &b].iter().any(|s| !s.shrink_report(tolerance / 2.0).fixed_vertices.is_empty());
        if let (Said::At(t), Clearance::Blocked { distance, contact }) =
            (said(&cast.clearance().expect("an answer")), &shrunk)
        {
            // A vertex that stays leaves sloping facets around it, which are not inside the body.
            let (place, shrunk) = (contact.translation, contact.offset_distance);
            prop_assert!(stuck || shrunk.value >= t - 1e-11, "{shrunk:?} < {t}");
            for found in [place, shrunk] {
                prop_assert!(found.lower <= found.value && found.value <= found.upper, "{found:?}");
            }
            prop_assert!(place.lower <= shrunk.lower && place.upper <= shrunk.upper, "{contact:?}");
            prop_assert_eq!(*distance, place.lower.max(0.0));
        }
    }

    /// A queue that is kept changes no answer, and an answer that is handed in only cuts off.
    #[test]
    fn best_so_far(setting in any_setting(), part in 0.1..2.0_f64) {
        let [a, b] = [solid(&setting.surfaces[0]), solid(&setting.surfaces[1])];
        let cast = Cast::new(a.at(setting.poses[0]), b.at(setting.poses[1]), setting.direction)
            .and_then(|c| c.with_options(bare()))
            .expect("a direction");
        // A distance that is rounding noise may be 0 for one way of computing it.
        if let Said::At(t) = said(&cast.clearance().expect("an answer"))
            && (t == 0.0 || t > 1e-9)
        {
            let before = bare().with_before(t * part);
            let cut = said(&cast.with_options(before).expect("choices").clearance().expect("an answer"));
            if part < 0.999 || t == 0.0 {
                prop_assert_eq!(cut, Said::Free);
            } else if part > 1.001 {
                prop_assert!(agree(cut, Said::At(t)));
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(192))]

    /// The same of open surfaces; and what is inside out blocks as it did.
    #[test]
    fn open_surfaces_block_mutually_and_from_both_sides(family in 0..3_usize, seed in any::<u32>()) {
        let setting = sheets::Setting::draw(sheets::FAMILIES[family], seed.into());
        let setting = setting.expect("a setting");
        let ([a, b], [s, t], d) = (&setting.solids, setting.poses, setting.direction);
        let forth = ask_at([a, b], [s, t], d);
        let back = ask_at([b, a], [t, s], -d);
        prop_assert!(agree(forth, back), "{forth:?} and {back:?}");
        if a.report().shell_count(ShellKind::Closed) == 0 {
            let facets: Vec<[u32; 3]> = a.triangles().iter().map(|&[p, q, r]| [p, r, q]).collect();
            let over = Solid::from_open_mesh(a.vertices(), &facets).expect("turned over");
            let turned = ask_at([&over, b], [s, t], d);
            prop_assert!(agree(forth, turned), "{forth:?} and turned over {turned:?}");
        }
    }
}
