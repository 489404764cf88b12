//! The answers to questions that only solids answer.

use std::collections::HashMap;

use glam::DVec3;

use super::boxes::{self, told_by_boxes};
use super::hulls::{Guessed, Hulls};
use super::proof::least_of_leaves;
use super::tolerance::least_tolerance_from;
use super::{
    Cover, SolidCast, SolidCertificate, SolidFree, SolidOverlap, SolidScene, StartOverlap,
};
use super::{StartProof, StopProof, check_left, default_tolerance, verify};
use crate::body::{AsSolid, Solid};
use crate::solve::bound::Reason;
use crate::solve::contact::{SolidContact, contact, true_place};
use crate::solve::overlap::{self, Overlap};
use crate::solve::scene::{Scene, noise_of, permutes};
use crate::solve::search::{Aim, Found, Search, Workspace, node_rounding};
use crate::solve::separate::separation;
use crate::solve::steps::SolidSteps;
use colltrans_convex::answer::{Bounded, CertificateError, Clearance, Outcome};
use colltrans_convex::body::Placed;
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::error::QueryError;

impl<'a> SolidCast<'a> for Cast<'a, Solid> {
    fn between<A: AsSolid, B: AsSolid>(
        moving: Placed<'a, A>,
        fixed: Placed<'a, B>,
        direction: DVec3,
    ) -> Result<Self, QueryError> {
        let (a, b) = (moving.body.as_surface()?, fixed.body.as_surface()?);
        Cast::new(a.at(moving.pose), b.at(fixed.pose), direction)
    }

    fn with_tolerance(self, tolerance: f64) -> Result<Self, QueryError> {
        self.with_options(self.options.with_tolerance(tolerance))
    }

    fn with_start_overlap(self, start_overlap: StartOverlap) -> Self {
        Self { options: self.options.with_start_overlap(start_overlap), ..self }
    }

    fn tolerance(&self) -> f64 {
        self.options.tolerance.unwrap_or_else(|| {
            let (setting, keep) = (&self.setting, self.options.keep);
            let permuted = permutes(setting.moving_matrix) && permutes(setting.fixed_matrix);
            default_tolerance(permuted, noise_of(setting.scale(), keep).0)
        })
    }

    fn clearance_in(&self, workspace: &mut Workspace) -> Result<Clearance<Solid>, QueryError> {
        let (mut scene, mut steps) = (None, SolidSteps::default());
        let place = match told_at_once(self, &mut scene, &mut steps)? {
            AtOnce::Answer(answer) => return Ok(answer),
            AtOnce::Overlapping(place) => Some(place),
            AtOnce::Nothing => None,
        };
        let scene = scene_once(self, &mut scene)?;
        let ignored = self.options.start_overlap == StartOverlap::Ignore;
        let aim = match self.options.overlapping {
            Some(false) => Aim::Stop,
            Some(true) if ignored => Aim::LaterStop,
            _ => match place.or_else(|| overlap::find(scene, &mut steps)) {
                Some(_) if ignored => Aim::LaterStop,
                Some(place) => return Ok(Clearance::Overlapping(self.overlap_at(place, steps))),
                None => Aim::Stop,
            },
        };
        let found = first(scene, aim, limit(self, scene), workspace, &mut steps);
        Ok(answer(self, scene, found.as_ref(), steps))
    }

    fn certified_clearance(&self) -> Result<(Clearance<Solid>, SolidCertificate), QueryError> {
        let (mut scene, mut steps) = (None, SolidSteps::default());
        let told = told_at_once(self, &mut scene, &mut SolidSteps::default())?;
        let scene = scene_once(self, &mut scene)?;
        let bodies = [self.moving(), self.fixed()];
        let start = self.prove_start(scene, &mut steps);
        let mut certificate = SolidCertificate {
            tolerance: self.tolerance(),
            start,
            lower: 0.0,
            stop: None,
            cover: Cover::default(),
        };
        let aim = match (certificate.aim(self.options()), &certificate.start) {
            (None, &StartProof::Overlapping(place)) => {
                let overlap = self.overlap_at(place, steps);
                return Ok((Clearance::Overlapping(overlap), certificate));
            }
            (aim, _) => aim.unwrap_or(Aim::Stop),
        };
        let mut cuts = HashMap::new();
        let cut = |nodes, reason| {
            cuts.insert(nodes, reason);
        };
        let mut search = Search::new(scene, aim, limit(self, scene), cut);
        let found = search.run(&mut Workspace::default());
        let end = search.limit;
        steps += search.steps;
        certificate.cover = Cover::new(bodies, &cuts);
        let answer = match told {
            AtOnce::Answer(answer) => answer,
            _ => answer(self, scene, found.as_ref(), steps),
        };
        if let Clearance::Blocked { contact, .. } = &answer {
            let shrunk_distance = contact.shrunk_distance.value;
            certificate.stop = Some(StopProof { shrunk_distance, triangles: contact.triangles });
        }
        certificate.lower = proven(scene, aim, end, &certificate.cover) / scene.setting.length;
        if certificate.lower <= 0.0 {
            // Nothing contributes less than 0.
            certificate.lower = 0.0;
            certificate.cover = Cover(vec![Some(Reason::NotBefore)]);
        }
        Ok((answer, certificate))
    }

    fn stop_by(&self, triangles: [u32; 2]) -> Option<SolidContact> {
        if !has(self, triangles) {
            return None;
        }
        let scene = self.asked();
        let later = self.options.overlapping == Some(true)
            && self.options.start_overlap == StartOverlap::Ignore;
        let aim = if later { Aim::LaterStop } else { Aim::Stop };
        let search = Search::new(&scene, aim, limit(self, &scene), |_, _| ());
        let found = search.of_pair(triangles)?;
        // Nothing stops a body before 0.
        Some(contact(&scene, &found, found.bounded(&scene).clamped(), SolidSteps::default()))
    }

    fn true_place(
        &self,
        triangles: [u32; 2],
        shrunk: Bounded,
        normal: DVec3,
        shift: DVec3,
    ) -> Option<Bounded> {
        has(self, triangles).then(|| true_place(&self.scene(0.0), triangles, shrunk, normal, shift))
    }

    fn overlaps(&self) -> bool {
        overlap::find(&self.asked(), &mut SolidSteps::default()).is_some()
    }

    fn start_overlap(&self) -> Option<SolidOverlap> {
        let mut steps = SolidSteps::default();
        let place = place_of_overlap(self, &self.asked(), &mut steps)?;
        Some(self.overlap_at(place, steps))
    }

    fn least_tolerance(&self) -> Option<f64> {
        least_tolerance_from(self, None, &mut SolidSteps::default())
    }

    fn first_contact_in(&self, workspace: &mut Workspace) -> Result<Outcome<Solid>, QueryError> {
        let (scene, mut steps) = (self.scene(0.0), SolidSteps::default());
        let found = first(&scene, Aim::Least, f64::INFINITY, workspace, &mut steps);
        Ok(match found {
            Some(found) => Outcome::Contact(contact(&scene, &found, found.bounded(&scene), steps)),
            None => Outcome::Separated(SolidFree { separation: separation(&scene), steps }),
        })
    }

    fn exit(&self) -> Option<Bounded> {
        self.exit_in(&mut Workspace::default())
    }

    fn exit_in(&self, workspace: &mut Workspace) -> Option<Bounded> {
        let scene = self.reversed().scene(0.0);
        let steps = &mut SolidSteps::default();
        let found = first(&scene, Aim::Least, f64::INFINITY, workspace, steps)?;
        Some(found.bounded(&scene).negated().clamped())
    }
}

impl<'a> SolidScene<'a> for Cast<'a, Solid> {
    #[inline]
    fn scene(&self, tolerance: f64) -> Scene<'a> {
        Scene::new(&self.setting, [tolerance / 2.0; 2], self.options.keep)
    }

    #[inline]
    fn asked(&self) -> Scene<'a> {
        self.scene(self.tolerance())
    }

    #[inline]
    fn asked_of_something(&self) -> Result<Scene<'a>, QueryError> {
        let tolerance = self.tolerance();
        // One that was given was checked then.
        if self.options.tolerance.is_none() {
            check_left(self, tolerance)?;
        }
        Ok(self.scene(tolerance))
    }

    #[inline]
    fn overlap_at(&self, place: Overlap, mut steps: SolidSteps) -> SolidOverlap {
        let least_tolerance = least_tolerance_from(self, Some(place), &mut steps);
        SolidOverlap { place, least_tolerance, steps }
    }

    fn prove_start(&self, scene: &Scene, steps: &mut SolidSteps) -> StartProof {
        // An overlap that is the answer is looked for, to be named.
        let options = self.options();
        let is_answer =
            options.overlapping == Some(true) && options.start_overlap == StartOverlap::Refuse;
        if options.overlapping.is_some() && !is_answer {
            return StartProof::Assumed;
        }
        if let Some(place) = sunk(self, Hulls::of(self).as_ref(), scene, steps) {
            return StartProof::Overlapping(place);
        }
        let mut entries = Vec::new();
        let mut note = |entry| {
            steps.count(entry);
            entries.push(entry);
        };
        match overlap::find_with(scene, &mut note) {
            Some(overlap) => StartProof::Overlapping(overlap),
            None => StartProof::Apart(Cover(entries)),
        }
    }

    fn verify_start(&self, scene: &Scene, start: &StartProof) -> Result<(), CertificateError> {
        verify::verify_start(self, scene, start)
    }
}

/// Returns the length from which on gaps are of no interest.
fn limit(cast: &Cast<'_, Solid>, scene: &Scene) -> f64 {
    cast.options.before.map_or(f64::INFINITY, |t| t * scene.setting.length)
}

/// What is told of a clearance before any search.
enum AtOnce {
    Answer(Clearance<Solid>),
    /// The bodies overlap there.
    Overlapping(Overlap),
    Nothing,
}

/// What is told of the clearance before any search, the same whether a proof is wanted or not: by boxes, then by
/// hulls, then by the facets around the contact of those. The scene is made when it is asked for.
fn told_at_once<'a>(
    cast: &Cast<'a, Solid>,
    scene: &mut Option<Scene<'a>>,
    steps: &mut SolidSteps,
) -> Result<AtOnce, QueryError> {
    let by_boxes = told_by_boxes(cast);
    if let boxes::Told::Passing(answer) = by_boxes {
        return Ok(AtOnce::Answer(answer));
    }
    // Where boxes touch, the bodies' exact places are asked before their hulls; where hulls overlap by little, facets.
    let touching = matches!(by_boxes, boxes::Told::Touching);
    let hulls = if touching { None } else { Hulls::of(cast) };
    let in_doubt = touching || hulls.as_ref().is_some_and(Hulls::are_sunk);
    if !in_doubt && let Some(answer) = hulls.as_ref().and_then(|hulls| hulls.certain(cast)) {
        return Ok(AtOnce::Answer(answer));
    }
    let scene = scene_once(cast, scene)?;
    if touching && overlap::pass(scene, limit(cast, scene)) {
        steps.nodes += 1;
        return Ok(AtOnce::Answer(answer(cast, scene, None, *steps)));
    }
    let hulls = if touching { Hulls::of(cast) } else { hulls };
    if let Some(place) = sunk(cast, hulls.as_ref(), scene, steps) {
        return Ok(AtOnce::Overlapping(place));
    }
    let told = hulls.and_then(|hulls| {
        let certain = if in_doubt { hulls.certain(cast) } else { None };
        certain.or_else(|| guessed_by_hulls(cast, &hulls, scene))
    });
    Ok(told.map_or(AtOnce::Nothing, AtOnce::Answer))
}

/// The bodies shrunk by half the tolerance, which leaves something of them, made once.
fn scene_once<'a, 's>(
    cast: &Cast<'a, Solid>,
    scene: &'s mut Option<Scene<'a>>,
) -> Result<&'s Scene<'a>, QueryError> {
    Ok(match scene {
        Some(scene) => scene,
        None => scene.insert(cast.asked_of_something()?),
    })
}

/// Where the bodies overlap, if they do by little, by what is around a contact of their hulls.
fn sunk(
    cast: &Cast<'_, Solid>,
    hulls: Option<&Hulls>,
    scene: &Scene,
    steps: &mut SolidSteps,
) -> Option<Overlap> {
    if cast.options.overlapping == Some(false) {
        return None;
    }
    hulls?.sunk(scene, &mut steps.leaves)
}

/// Where they overlap.
fn place_of_overlap(
    cast: &Cast<'_, Solid>,
    scene: &Scene,
    steps: &mut SolidSteps,
) -> Option<Overlap> {
    let sunk = sunk(cast, Hulls::of(cast).as_ref(), scene, steps);
    sunk.or_else(|| overlap::find(scene, steps))
}

fn guessed_by_hulls(
    cast: &Cast<'_, Solid>,
    hulls: &Hulls,
    scene: &Scene,
) -> Option<Clearance<Solid>> {
    if let Some(answer) = hulls.touching(cast, scene) {
        return Some(answer);
    }
    let mut steps = SolidSteps::default();
    Some(match hulls.guessed(scene, limit(cast, scene), &mut steps.leaves)? {
        Guessed::Stop(found, least) => {
            let told = hulls.stopped_by(cast, &found, least, steps);
            told.unwrap_or_else(|| answer(cast, scene, Some(&found), steps))
        }
        Guessed::Free => answer(cast, scene, None, steps),
    })
}

/// The least gap that the parts of a cover prove, their rounding taken off, of a search that has ended
/// with a limit.
fn proven(scene: &Scene, aim: Aim, limit: f64, cover: &Cover) -> f64 {
    // A little more, for the roundings of the bound on its way into the proof and out of it.
    let mut lower = limit - 1.0625 * node_rounding(scene);
    if lower <= 0.0 {
        return 0.0;
    }
    let bodies = [scene.moving.solid, scene.fixed.solid];
    let fits = cover.walk(bodies, |_, nodes, reason| {
        if reason == Reason::Examined {
            lower = lower.min(least_of_leaves(scene, aim, nodes, limit));
        }
        true
    });
    if fits.is_ok() { lower } else { 0.0 }
}

/// What a search has found, as an answer.
fn answer(
    cast: &Cast<'_, Solid>,
    scene: &Scene,
    found: Option<&Found>,
    steps: SolidSteps,
) -> Clearance<Solid> {
    let Some(found) = found else {
        let to_the_end = cast.options.before.is_none();
        let separation = to_the_end.then(|| separation(scene)).flatten();
        return Clearance::Free(SolidFree { separation, steps });
    };
    // Nothing stops a body before 0.
    let contact = contact(scene, found, found.bounded(scene).clamped(), steps);
    Clearance::Blocked { distance: contact.translation.lower.max(0.0), contact }
}

fn has(cast: &Cast<'_, Solid>, triangles: [u32; 2]) -> bool {
    let counts = [cast.moving(), cast.fixed()].map(|solid| solid.triangles().len());
    triangles.into_iter().zip(counts).all(|(t, count)| (t as usize) < count)
}

/// The least gap below a limit.
fn first(
    scene: &Scene,
    aim: Aim,
    limit: f64,
    workspace: &mut Workspace,
    steps: &mut SolidSteps,
) -> Option<Found> {
    let mut search = Search::new(scene, aim, limit, |_, _| ());
    let found = search.run(workspace);
    *steps += search.steps;
    found
}
