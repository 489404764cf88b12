//! The slow and obvious planar problem, and the cells made of it, against the library.

use colltrans::observe::SectionContact;
use colltrans_testkit::random::Random;
use glam::DVec2;

use super::planar::{Features, View};
use super::setting::Setting;

fn random_settings(count: usize, seed: u64) -> Vec<Setting> {
    let mut random = Random::new(seed);
    let mut all = Vec::new();
    while all.len() < count {
        let mut of = |most: f64| random.range(-most, most);
        let (at, turn) = ([of(2.0), of(2.0), 5.0], [of(1.0), of(1.0), of(1.0), of(1.0)]);
        let towards = [of(0.5) - at[0] / 5.0, of(0.5) - at[1] / 5.0, -1.0];
        all.extend(Setting::new(at, turn, towards));
    }
    all
}

/// Those of `docs/paper.md` are the ones that are drawn.
#[test]
fn the_documentation_has_these_pictures() {
    for (number, svg) in super::figures().unwrap() {
        let path = format!("../../docs/figures/figure-{number:02}.svg");
        let kept = std::fs::read_to_string(&path).unwrap();
        assert!(kept == svg, "{path}: draw it again, `colltrans-lab pictures`");
    }
}

/// Where sections meet, how, and what the value does as levels change.
#[test]
fn planar_problems_are_those_of_the_library() {
    let mut seen = [0; 3];
    for setting in random_settings(300, 5) {
        let Ok(run) = setting.run() else { continue };
        let view = View::new(&setting, &run.sections);
        for step in &run.steps {
            let at = DVec2::from_array(step.problem.levels);
            let Some(found) = view.instance(at) else { continue };
            assert_eq!(found.touch, step.problem.touch, "{setting:?} {at}");
            if found.touch.intersects() {
                let scale = 1.0 + found.value.abs();
                assert!(
                    (found.value - step.problem.value).abs() < 1e-9 * scale,
                    "{setting:?} {at}"
                );
                let apart = (found.gradient - step.problem.gradient).length();
                assert!(apart < 1e-9 * (1.0 + found.gradient.length()), "{setting:?} {at}");
            }
            seen[match found.touch {
                SectionContact::Edges => 0,
                SectionContact::Vertex => 1,
                _ => 2,
            }] += 1;
        }
    }
    assert!(seen.iter().all(|&count| count > 20), "{seen:?}");
}

/// The library's cell of an edge contact is all of the cell; of a vertex contact it may be a part.
#[test]
fn cells_are_those_of_the_library() {
    let mut told = 0;
    for setting in random_settings(100, 6) {
        let Ok(run) = setting.run() else { continue };
        let view = View::new(&setting, &run.sections);
        for step in run.steps.iter().filter(|step| step.problem.touch.intersects()) {
            let at = DVec2::from_array(step.problem.levels);
            let Some(Features::Touching(faces)) = view.instance(at).map(|found| found.features)
            else {
                continue;
            };
            let whole = view.cell(faces, run.rectangle());
            let reaches = |from: &[DVec2], to: &[DVec2]| {
                from.iter().all(|p| to.iter().any(|q| p.distance(*q) < 1e-6))
            };
            if step.problem.touch == SectionContact::Edges {
                let same = reaches(&step.cell, &whole) && reaches(&whole, &step.cell);
                assert!(same, "{setting:?} {at}: {:?} {whole:?}", step.cell);
            }
            // `phi` is linear over all of it.
            for corner in &whole {
                let near = at.lerp(*corner, 1.0 - 1e-6);
                let Some(found) = view.instance(near) else { continue };
                let linear = step.problem.value + step.problem.gradient.dot(near - at);
                assert!((found.value - linear).abs() < 1e-8, "{setting:?} {near}");
            }
            told += 1;
        }
    }
    assert!(told > 100, "{told}");
}
