//! `colltrans motion`: when two convex meshes, of which one turns, first meet.

use colltrans::motion::{Motion, MotionCast, MotionOutcome, MotionProofFile};
use colltrans::record::{Ending, FeaturesRecord, MotionRecord, TimeRecord};

use crate::args::MotionArguments;
use crate::body;
use crate::cast;
use crate::failure::{Code, Failure, note, print, print_json};
use crate::numbers::{counted, known, known_vector, number, unit_vector};
use crate::proof::{self, refuse_proof};
use crate::record::Hulls;
use crate::report::{feature, line};

pub(crate) fn run(arguments: &MotionArguments) -> Result<(), Failure> {
    let files = [&*arguments.moving, &*arguments.fixed];
    refuse_proof(arguments.save_proof.as_deref(), None, &files)?;
    let [start, there] = arguments.places.poses()?;
    let motion = arguments.motion(start)?;
    let parts = cast::load(files, &arguments.body_options());
    let parts = parts.map_err(|error| Failure::new(Code::Input, body::refusal(&error)))?;
    arguments.places.notes().iter().flatten().for_each(|text| note(text));
    parts.iter().flat_map(|part| &part.notes).for_each(|text| note(text));
    if let Some(hulls) = Hulls::of(parts.each_ref()) {
        hulls.named().for_each(|(name, excess)| note(&format!("{name}: {excess}")));
    }
    let cast = MotionCast::new(parts[0].body.along(&motion), parts[1].body.at(there))?;
    let cast = if arguments.tolerance > 0.0 {
        cast.tolerating(arguments.tolerance)?
    } else {
        cast.keeping(arguments.keep)?
    };
    let outcome = cast.first_contact()?;
    let record = MotionRecord::of(&outcome, &cast);
    if arguments.json {
        let written = serde_json::to_string(&record);
        print_json(&format!(
            "{}\n",
            written.map_err(|e| Failure::output("standard output", &e.into()))?
        ))?;
    } else {
        print(&words(&record, &outcome, &motion))?;
    }
    match &arguments.save_proof {
        Some(path) => proof::save_text(path, &MotionProofFile::of(&cast, &outcome).to_json()),
        None => Ok(()),
    }
}

/// The readable answer.
fn words(record: &MotionRecord, outcome: &MotionOutcome, motion: &Motion) -> String {
    let mut text = String::from(match record.outcome {
        Ending::Contact => "contact\n",
        Ending::Grazing => "grazing: the bodies come nearer than rounding can tell\n",
        Ending::Overlapping => "overlapping: the bodies overlap when the motion begins\n",
        _ => "free: the bodies never meet throughout the motion\n",
    });
    if let Some(TimeRecord { lower, upper }) = record.time {
        if let Some(upper) = upper {
            let value = lower + 0.5 * (upper - lower);
            line(&mut text, "time", &format!("{} of the motion", known(value, upper - lower)));
            line(&mut text, "bounds", &format!("{} to {}", number(lower), number(upper)));
        } else {
            line(&mut text, "no earlier", &number(lower));
        }
        if let Ok(pose) = motion.at(lower) {
            let q = pose.rotation();
            let rotation = [q.x, q.y, q.z, q.w].map(|x| known(x, 1e-14)).join(",");
            let place = known_vector(pose.translation(), 1e-14);
            line(&mut text, "pose", &format!("{place},{rotation}"));
        }
    }
    if let Some(point) = record.point {
        line(&mut text, "point", &known_vector(point.into(), 1e-12));
    }
    if let Some(normal) = record.normal {
        line(&mut text, "normal", &unit_vector(normal.into()));
    }
    if let Some(FeaturesRecord { moving, fixed }) = &record.features {
        line(&mut text, "moving", &feature(moving));
        line(&mut text, "fixed", &feature(fixed));
    }
    let looks = counted(outcome.steps().looks as usize, "look", "looks");
    line(
        &mut text,
        "proof",
        &format!("{}, found in {looks}", counted(record.planes, "plane", "planes")),
    );
    text
}
