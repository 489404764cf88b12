//! Answers that serde writes are read back with the same bits, and invalid values are rejected.

use colltrans_convex::{
    Bounded, Cast, Clearance, ContactRange, FaceId, Feature, InputVertex, Intersection, Options,
    Outcome, Pose, Solver, StartedFrom, VertexId, cta,
};
use colltrans_proof::record::{Ending, Question};
use colltrans_solid::proof::SolidCertificate;
use colltrans_solid::{Solid, SolidCast, SolidOptions, StartOverlap};
use colltrans_testkit::oracle::settings::{FAMILIES, setting};
use colltrans_testkit::solids::{bolt, washer};
use glam::{DQuat, DVec3};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::common::solid;

/// Writes a value, reads it back and compares. `Debug` prints numbers so that they read back as the same
/// bits.
fn assert_round_trip<T: Serialize + DeserializeOwned + std::fmt::Debug>(value: &T) -> String {
    let text = serde_json::to_string(value).expect("numbers and names");
    let read: T = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{e}: {text}"));
    assert_eq!(format!("{read:?}"), format!("{value:?}"), "{text}");
    text
}

#[test]
fn convex_answers_round_trip_exactly() {
    for (family, ..) in FAMILIES {
        for seed in 0..10 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("bodies");
            let cast = setting.query(&bodies).expect("a query");
            assert_round_trip::<Outcome>(&cast.first_contact().expect("an answer"));
            assert_round_trip::<ContactRange>(&cast.contact_range().expect("an answer"));
            assert_round_trip::<Clearance>(&cast.clearance().expect("an answer"));
            assert_round_trip::<Intersection>(&cast.intersects().expect("an answer"));
            assert_round_trip::<Options>(&cast.options());
            assert_round_trip::<Pose>(&cast.moving_pose());
        }
    }
}

#[test]
fn solid_answers_round_trip_exactly() {
    let bolt = solid(&bolt([1.0, 2.0], [-5.0, 8.0, 9.0], 12));
    let plate = solid(&washer([1.5, 4.0], [0.0, 1.0], 9));
    for (from, direction) in [
        (DVec3::ZERO, DVec3::NEG_Z),
        (DVec3::ZERO, DVec3::Z),
        (DVec3::X, DVec3::Z),
        (DVec3::X * 9.0, DVec3::Z),
    ] {
        let pose = Pose::from_translation(from).expect("in range");
        let cast = Cast::new(bolt.at(pose), plate.at(Pose::IDENTITY), direction).expect("a query");
        let (answer, certificate) = cast.certified_clearance().expect("an answer");
        assert_round_trip::<Outcome<Solid>>(&cast.first_contact().expect("an answer"));
        assert_round_trip::<ContactRange<Solid>>(&cast.contact_range().expect("an answer"));
        assert_round_trip::<Intersection<Solid>>(&cast.intersects().expect("an answer"));
        assert_round_trip::<Clearance<Solid>>(&answer);
        assert_round_trip::<SolidCertificate>(&certificate);
        assert_round_trip::<SolidOptions>(&cast.options());
    }
}

#[test]
fn infinite_bound_serialises_as_null() {
    let nothing = Bounded { value: 1.0, lower: f64::NEG_INFINITY, upper: f64::INFINITY };
    assert_eq!(assert_round_trip(&nothing), r#"{"value":1.0,"lower":null,"upper":null}"#);
}

#[test]
fn typed_indices_serialise_as_numbers() {
    let ends = [3, 5].map(InputVertex);
    assert_eq!(assert_round_trip(&Feature::Vertex(ends[0])), r#"{"vertex":3}"#);
    assert_eq!(assert_round_trip(&Feature::Edge(ends)), r#"{"edge":[3,5]}"#);
    assert_eq!(assert_round_trip(&Feature::Face(FaceId(7))), r#"{"face":7}"#);
    assert_eq!(format!("{} {:>3}", ends[0], VertexId(4)), "3   4");
}

#[test]
fn invalid_pose_and_options_are_rejected() {
    let turned = Pose::new(DQuat::from_rotation_x(0.3), DVec3::X).expect("a pose");
    let text = assert_round_trip(&turned);
    assert!(serde_json::from_str::<Pose>(&text.replace("matrix\":[1.0", "matrix\":[2.0")).is_err());
    let text = assert_round_trip(&Options::default());
    for (from, to) in
        [("e\":0.0", "e\":-1.0"), ("\"exit\"", "-0.2"), ("exit", "soon"), ("auto", "best")]
    {
        let wrong = text.replace(from, to);
        assert_ne!(wrong, text, "{from}");
        assert!(serde_json::from_str::<Options>(&wrong).is_err(), "{wrong}");
    }
}

#[test]
fn displayed_names_match_serde_and_parse() {
    fn assert_names_match<T>(all: &[T])
    where
        T: Serialize + std::fmt::Display + std::str::FromStr + PartialEq,
    {
        for choice in all {
            let name = choice.to_string();
            assert_eq!(serde_json::to_string(choice).expect("a name"), format!("\"{name}\""));
            assert!(name.parse::<T>().is_ok_and(|read| read == *choice), "{name}");
        }
    }
    assert_names_match(&[Solver::Auto, Solver::Cta, Solver::Portal]);
    assert_names_match(&[
        StartedFrom::Difference,
        StartedFrom::Features,
        StartedFrom::Region,
        StartedFrom::Scratch,
    ]);
    assert_names_match(&[cta::Start::Ellipsoids, cta::Start::Center, cta::Start::Guess]);
    assert_names_match(&[cta::Cuts::Shifted, cta::Cuts::Centroid]);
    for (until, text) in [(cta::Until::Exit, "exit"), (cta::Until::Gap(0.25), "0.25")] {
        assert_eq!((until.to_string().as_str(), text.parse()), (text, Ok(until)));
    }
    for wrong in ["end", "-1", "NaN", ""] {
        let error = wrong.parse::<cta::Until>().expect_err(wrong).to_string();
        let accepted = "`exit`, or a number that is not negative";
        assert_eq!(error, format!("invalid end {wrong:?}; accepted: {accepted}"));
    }
    assert_names_match(&[Question::Contact, Question::Clearance]);
    assert_names_match(&[StartOverlap::Refuse, StartOverlap::Ignore]);
    assert_names_match(&[
        Ending::Contact,
        Ending::Grazing,
        Ending::Separated,
        Ending::Free,
        Ending::Blocked,
    ]);
    assert_names_match(&[Ending::Slides, Ending::Behind, Ending::Overlapping, Ending::Error]);
    let error = "fastest".parse::<Solver>().expect_err("there is none");
    assert_eq!(error.to_string(), "there is no solver \"fastest\"; there are auto, cta, portal");
}
