//! What serde writes of an answer comes back in bits, and what is not one is refused.

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

/// Written and read; Debug prints numbers so that they read back as the same bits.
fn again<T: Serialize + DeserializeOwned + std::fmt::Debug>(value: &T) -> String {
    let text = serde_json::to_string(value).expect("numbers and names");
    let read: T = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{e}: {text}"));
    assert_eq!(format!("{read:?}"), format!("{value:?}"), "{text}");
    text
}

#[test]
fn answers_of_every_family_come_back_in_bits() {
    for (family, ..) in FAMILIES {
        for seed in 0..10 {
            let setting = setting(family, seed);
            let bodies = setting.bodies().expect("bodies");
            let cast = setting.query(&bodies).expect("a query");
            again::<Outcome>(&cast.first_contact().expect("an answer"));
            again::<ContactRange>(&cast.contact_range().expect("an answer"));
            again::<Clearance>(&cast.clearance().expect("an answer"));
            again::<Intersection>(&cast.intersects().expect("an answer"));
            again::<Options>(&cast.options());
            again::<Pose>(&cast.moving_pose());
        }
    }
}

#[test]
fn answers_between_solids_come_back_in_bits() {
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
        again::<Outcome<Solid>>(&cast.first_contact().expect("an answer"));
        again::<ContactRange<Solid>>(&cast.contact_range().expect("an answer"));
        again::<Intersection<Solid>>(&cast.intersects().expect("an answer"));
        again::<Clearance<Solid>>(&answer);
        again::<SolidCertificate>(&certificate);
        again::<SolidOptions>(&cast.options());
    }
}

#[test]
fn an_infinite_bound_is_written_as_nothing() {
    let nothing = Bounded { value: 1.0, lower: f64::NEG_INFINITY, upper: f64::INFINITY };
    assert_eq!(again(&nothing), r#"{"value":1.0,"lower":null,"upper":null}"#);
}

#[test]
fn typed_numbers_are_written_as_numbers() {
    let ends = [3, 5].map(InputVertex);
    assert_eq!(again(&Feature::Vertex(ends[0])), r#"{"vertex":3}"#);
    assert_eq!(again(&Feature::Edge(ends)), r#"{"edge":[3,5]}"#);
    assert_eq!(again(&Feature::Face(FaceId(7))), r#"{"face":7}"#);
    assert_eq!(format!("{} {:>3}", ends[0], VertexId(4)), "3   4");
}

#[test]
fn what_is_no_pose_or_choice_is_refused() {
    let turned = Pose::new(DQuat::from_rotation_x(0.3), DVec3::X).expect("a pose");
    let text = again(&turned);
    assert!(serde_json::from_str::<Pose>(&text.replace("matrix\":[1.0", "matrix\":[2.0")).is_err());
    let text = again(&Options::default());
    for (from, to) in
        [("e\":0.0", "e\":-1.0"), ("\"exit\"", "-0.2"), ("exit", "soon"), ("auto", "best")]
    {
        let wrong = text.replace(from, to);
        assert_ne!(wrong, text, "{from}");
        assert!(serde_json::from_str::<Options>(&wrong).is_err(), "{wrong}");
    }
}

#[test]
fn names_are_those_that_serde_writes() {
    fn named<T>(all: &[T])
    where
        T: Serialize + std::fmt::Display + std::str::FromStr + PartialEq,
    {
        for choice in all {
            let name = choice.to_string();
            assert_eq!(serde_json::to_string(choice).expect("a name"), format!("\"{name}\""));
            assert!(name.parse::<T>().is_ok_and(|read| read == *choice), "{name}");
        }
    }
    named(&[Solver::Auto, Solver::Cta, Solver::Portal]);
    named(&[
        StartedFrom::Difference,
        StartedFrom::Features,
        StartedFrom::Region,
        StartedFrom::Scratch,
    ]);
    named(&[cta::Start::Ellipsoids, cta::Start::Center]);
    for (until, text) in [(cta::Until::Exit, "exit"), (cta::Until::Gap(0.25), "0.25")] {
        assert_eq!((until.to_string().as_str(), text.parse()), (text, Ok(until)));
    }
    for wrong in ["end", "-1", "NaN", ""] {
        let error = wrong.parse::<cta::Until>().expect_err(wrong).to_string();
        let accepted = "`exit`, or a number that is not negative";
        assert_eq!(error, format!("invalid end {wrong:?}; accepted: {accepted}"));
    }
    named(&[Question::Contact, Question::Clearance]);
    named(&[StartOverlap::Refuse, StartOverlap::Ignore]);
    named(&[Ending::Contact, Ending::Grazing, Ending::Separated, Ending::Free, Ending::Blocked]);
    named(&[Ending::Slides, Ending::Behind, Ending::Overlapping, Ending::Error]);
    let error = "fastest".parse::<Solver>().expect_err("there is none");
    assert_eq!(error.to_string(), "there is no solver \"fastest\"; there are auto, cta, portal");
}
