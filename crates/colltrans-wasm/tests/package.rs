//! The library of the npm package: answers equal those of the library, and of both modules to the bit.

use colltrans::glam::DVec3;
use colltrans::{Cast, ConvexPolyhedron, Outcome, Pose};
use colltrans_wasm::package::{Bodies, Casts, Question, answers};
use colltrans_wasm::{Answer, Answers};

fn ask(state: &mut impl Answers, numbers: &[f64]) -> Answer {
    let question: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    state.ask(&question, Vec::new())
}

fn numbers(answer: &Answer) -> Vec<f64> {
    answer.numbers.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()
}

const NO_OPTIONS: [f64; 5] = [f64::NAN, 0.0, 0.0, f64::NAN, 0.0];

/// Casts the unit cube, from -3 along x, against itself.
fn cast(state: &mut impl Answers, direction: [f64; 3]) -> Answer {
    let cube = [f64::from(Question::Cuboid as u8), 0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let number = numbers(&ask(state, &cube))[0];
    let head = [f64::from(Question::Cast as u8), number, number, 3.0, -3.0, 0.5, 0.25, 0.0];
    ask(state, &[&head[..], &direction, &NO_OPTIONS, &[0.0]].concat())
}

#[test]
fn casts_equal_those_of_the_library() -> Result<(), Box<dyn std::error::Error>> {
    let direction = [1.0, 0.0625, -0.03];
    let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    let start = Pose::from_translation(DVec3::new(-3.0, 0.5, 0.25))?;
    let query = Cast::new(cube.at(start), cube.at(Pose::IDENTITY), direction.into())?;
    let Outcome::Contact(contact) = query.first_contact()? else { panic!("no contact") };
    let [lower, upper] = contact.bounded().bounds();
    let found = numbers(&cast(&mut Bodies::default(), direction));
    // Number of the answer, value, both bounds, normal.
    let expected = [&[0.0, contact.translation, lower, upper][..], &contact.normal.to_array()];
    assert_eq!(found[..7], expected.concat());
    assert_eq!(
        cast(&mut Casts::default(), direction).numbers,
        cast(&mut Bodies::default(), direction).numbers
    );
    Ok(())
}

#[test]
fn errors_name_their_kind_and_argument() {
    for answer in [cast(&mut Casts::default(), [0.0; 3]), cast(&mut Bodies::default(), [0.0; 3])] {
        let text = String::from_utf8_lossy(&answer.text).into_owned();
        assert!(text.starts_with("QueryError\ndirection\nthe direction [0.0, 0.0, 0.0]"), "{text}");
    }
    // Neither an unknown question nor a short or long one stops the library.
    for question in [&[][..], &[99.0], &[10.0], &[10.0, 5.0, f64::NAN], &[1.0], &[19.0, 10.0, -1.0]]
    {
        let answer = ask(&mut Bodies::default(), question);
        assert!(answer.text.starts_with(b"InputError") || answer.text.starts_with(b"BuildError"));
    }
}

#[test]
fn description_has_all_answers_with_their_fields() -> Result<(), Box<dyn std::error::Error>> {
    let all: serde_json::Value = serde_json::from_str(&answers::description())?;
    let all = all.as_array().ok_or("not a list")?;
    assert_eq!((&all[0]["name"], &all[0]["outcome"]), (&"Contact".into(), &"contact".into()));
    for answer in all {
        assert!(answer["doc"].as_str().is_some_and(|doc| doc.len() > 10), "{answer}");
        let fields = answer["fields"].as_array().ok_or("no fields")?;
        assert!(!fields.is_empty() && fields.iter().all(|field| field["doc"] != ""), "{answer}");
    }
    Ok(())
}
