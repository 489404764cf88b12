//! Proofs as JSON, and their check.

use std::ffi::{CString, c_char};

use colltrans::record::PairQuestion;
use colltrans::solid::VolumeOptions;
use colltrans::{ByKind, Pair, ProofFile, Solid};

use crate::body::{Body, Pose, bodies, placed};
use crate::cast::{AnyCast, CastOptions, reject};
use crate::error::{Failure, Fallible, OfArgument, Output, Status, array, guard, vector};
use crate::motion::{Motion, motion_cast};
use crate::pair::pair;
use crate::scene::{Scene, SceneArguments};

/// Writes a text, which `colltrans_text_free` frees.
unsafe fn set_text(output: Output<*const c_char>, text: String) -> Fallible<()> {
    let text = CString::new(text).map_err(|what| Failure::new(Status::InternalError, what))?;
    // SAFETY: the caller keeps the invariants of the crate.
    unsafe { output.set(text.into_raw()) };
    Ok(())
}

/// Writes a proof.
unsafe fn prove(json: *mut *const c_char, proof: impl FnOnce() -> Fallible<ProofFile>) -> Status {
    guard(|| unsafe {
        let json = Output::new(json, "json")?;
        set_text(json, proof()?.to_json())
    })
}

/// Reads the arguments of a cast and the pieces of its bodies.
unsafe fn cast_and_pieces<'a>(
    [moving, fixed]: [*const Body; 2],
    [moving_pose, fixed_pose]: [*const Pose; 2],
    direction: *const f64,
    options: *const CastOptions,
) -> Fallible<(AnyCast<'a>, [&'a Body; 2])> {
    // SAFETY: the caller keeps the invariants of the crate.
    unsafe {
        let placed = placed(moving, moving_pose, fixed, fixed_pose)?;
        let direction = vector(direction, "direction")?;
        let cast = CastOptions::read(options)?.cast(&placed, direction)?;
        Ok((cast, bodies(moving, fixed)?))
    }
}

/// Returns the pieces of both bodies.
fn pieces(bodies: [&Body; 2]) -> Fallible<[Vec<&Solid>; 2]> {
    Ok([bodies[0].pieces().of("moving")?, bodies[1].pieces().of("fixed")?])
}

/// Frees a text of the library; null is accepted. The text must be unchanged.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_text_free(text: *const c_char) {
    guard(|| {
        if !text.is_null() {
            // SAFETY: the text is from `set_text`, unchanged, and freed once.
            drop(unsafe { CString::from_raw(text.cast_mut()) });
        }
        Ok(())
    });
}

/// Proves `colltrans_first_contact` of convex bodies. The text has the bodies, the query and the certificate; it is
/// freed by `colltrans_text_free`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_first_contact_proof(
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    direction: *const f64,
    options: *const CastOptions,
    json: *mut *const c_char,
) -> Status {
    let (bodies, poses) = ([moving, fixed], [moving_pose, fixed_pose]);
    unsafe {
        prove(json, || match cast_and_pieces(bodies, poses, direction, options)?.0 {
            ByKind::Convex(cast) => Ok(ProofFile::of_outcome(&cast, &cast.first_contact()?)),
            ByKind::Solid(_) => {
                let what = "first contacts of solids have no proofs; prove their clearance";
                Err(Failure::invalid("moving, fixed", what))
            }
        })
    }
}

/// Proves `colltrans_clearance`, up to infinity. The option `before` is rejected.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_clearance_proof(
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    direction: *const f64,
    options: *const CastOptions,
    json: *mut *const c_char,
) -> Status {
    let (bodies, poses) = ([moving, fixed], [moving_pose, fixed_pose]);
    unsafe {
        prove(json, || {
            let (cast, bodies) = cast_and_pieces(bodies, poses, direction, options)?;
            reject(CastOptions::read(options)?.has_before != 0, "before", "a proof")?;
            match cast {
                ByKind::Convex(cast) => Ok(ProofFile::of_clearance(&cast, &cast.clearance()?)),
                ByKind::Solid(cast) => {
                    let [moving, fixed] = pieces(bodies)?;
                    Ok(ProofFile::of_solids(&cast, [&moving, &fixed])?)
                }
            }
        })
    }
}

/// Proves the answer of a question without a direction.
unsafe fn prove_pair(
    question: PairQuestion,
    [moving, fixed]: [*const Body; 2],
    [moving_pose, fixed_pose]: [*const Pose; 2],
    json: *mut *const c_char,
) -> Status {
    unsafe {
        prove(json, || {
            let pair = pair(&placed(moving, moving_pose, fixed, fixed_pose)?)?;
            let proof = match &pair {
                ByKind::Convex(pair) => question.answer(pair)?.proof(pair),
                ByKind::Solid(pair) => {
                    let [moving, fixed] = pieces(bodies(moving, fixed)?)?;
                    Some(question.prove_solids(pair, [&moving, &fixed])?.1)
                }
            };
            proof.ok_or_else(|| Failure::invalid("moving, fixed", "this answer has no proof"))
        })
    }
}

/// Proves `colltrans_distance`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_distance_proof(
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    json: *mut *const c_char,
) -> Status {
    let (bodies, poses) = ([moving, fixed], [moving_pose, fixed_pose]);
    unsafe { prove_pair(PairQuestion::Distance, bodies, poses, json) }
}

/// Proves `colltrans_within`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_within_proof(
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    length: f64,
    json: *mut *const c_char,
) -> Status {
    let (bodies, poses) = ([moving, fixed], [moving_pose, fixed_pose]);
    unsafe { prove_pair(PairQuestion::Within(length), bodies, poses, json) }
}

/// Proves the depth. For solids the bounds of the proof may be farther apart than those of `colltrans_depth`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_depth_proof(
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    json: *mut *const c_char,
) -> Status {
    let (bodies, poses) = ([moving, fixed], [moving_pose, fixed_pose]);
    unsafe { prove_pair(PairQuestion::Depth, bodies, poses, json) }
}

/// Proves how much of the bodies overlaps: bounds of the volume of their common part, its box, and how the bodies lie to
/// each other. Convex bodies are treated as solids. The bounds differ by at most `accuracy`, a share of the lower one,
/// unless the search ends before, after a limited amount of work.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_common_part_proof(
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
    accuracy: f64,
    json: *mut *const c_char,
) -> Status {
    unsafe {
        prove(json, || {
            if accuracy.is_nan() || accuracy < 0.0 {
                return Err(Failure::invalid("accuracy", "it must be 0 or a positive share"));
            }
            let [p, q] = placed(moving, moving_pose, fixed, fixed_pose)?.solids()?;
            let [moving, fixed] = pieces(bodies(moving, fixed)?)?;
            let options = VolumeOptions::default().with_accuracy(accuracy);
            let pair = Pair::new(p, q)?;
            Ok(ProofFile::of_solid_common_part(&pair, [&moving, &fixed], options)?)
        })
    }
}

/// Proves `colltrans_motion_first_contact`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_motion_proof(
    moving: *const Body,
    moving_motion: *const Motion,
    fixed: *const Body,
    fixed_motion: *const Motion,
    options: *const CastOptions,
    json: *mut *const c_char,
) -> Status {
    unsafe {
        prove(json, || {
            match motion_cast([moving, fixed], [moving_motion, fixed_motion], options)? {
                ByKind::Convex(cast) => Ok(ProofFile::of_motion(&cast, &cast.first_contact()?)),
                ByKind::Solid(cast) => Ok(ProofFile::with_solid_motion(&cast)?.1),
            }
        })
    }
}

/// Proves `colltrans_scene_nearest`. A scene without obstacles has no proof.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_scene_nearest_proof(
    scene: *const Scene,
    body: *const Body,
    pose: *const Pose,
    ignored: *const u64,
    ignored_count: usize,
    json: *mut *const c_char,
) -> Status {
    let arguments = SceneArguments { scene, body, pose, ignored, ignored_count };
    unsafe {
        prove(json, || {
            arguments.query(&CastOptions::DEFAULT, |query| {
                let proof = ProofFile::of_nearest(query)?;
                proof.ok_or_else(|| Failure::invalid("scene", "the scene has no obstacles"))
            })
        })
    }
}

/// Proves `colltrans_scene_clearance`, up to infinity.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_scene_clearance_proof(
    scene: *const Scene,
    body: *const Body,
    pose: *const Pose,
    direction: *const f64,
    options: *const CastOptions,
    ignored: *const u64,
    ignored_count: usize,
    json: *mut *const c_char,
) -> Status {
    let arguments = SceneArguments { scene, body, pose, ignored, ignored_count };
    unsafe {
        prove(json, || {
            let direction = vector(direction, "direction")?;
            let options = CastOptions::read(options)?;
            reject(options.has_before != 0, "before", "a proof")?;
            arguments.query(options, |query| Ok(ProofFile::of_scene_clearance(query, direction)?))
        })
    }
}

/// Checks a proof, of `length` bytes, without a search and without trust in its numbers. Writes the proven statement in
/// words unless `statement` is null; `colltrans_text_free` frees it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_check_proof(
    json: *const c_char,
    length: usize,
    statement: *mut *const c_char,
) -> Status {
    guard(|| unsafe {
        let output =
            if statement.is_null() { None } else { Some(Output::new(statement, "statement")?) };
        let bytes = array(json.cast::<u8>(), length, "json")?;
        let text = std::str::from_utf8(bytes)
            .map_err(|what| Failure::new(Status::NotProven, what))
            .of("json")?;
        // A query that is invalid comes from the text, so it is not an invalid argument.
        let proof = ProofFile::from_json(text)
            .map_err(|what| Failure::new(Status::NotProven, what))
            .of("json")?;
        proof.check()?;
        match output {
            Some(output) => set_text(output, proof.to_string()),
            None => Ok(()),
        }
    })
}
