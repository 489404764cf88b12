//! Implementation of the queries that only solids answer.
//!
//! The clearance is computed in stages, each of which runs if the earlier ones do not decide:
//!
//! 1. the bounding boxes of both bodies;
//! 2. the certificate of the cast of their hulls, if both bodies are convex;
//! 3. the facets around the contact of the hulls;
//! 4. a test for an overlap, then a best-first search for the least gap.
//!
//! Boxes that touch, and hulls whose contact is slightly behind, change this order, see [`answer_without_search`].

use std::collections::HashMap;

use glam::DVec3;

use super::boxes::{BoxAnswer, answer_by_boxes};
use super::hulls::{ContactGuess, Hulls};
use super::proof::leaf_gap_bound;
use super::tolerance::least_tolerance_from;
use super::{
    Cover, SolidCast, SolidCertificate, SolidFree, SolidOptions, SolidOverlap, SolidScene,
    StartOverlap,
};
use super::{StartProof, StopProof, check_thickness, core_gap, default_tolerance, verify};
use crate::body::{AsSolid, Solid};
use crate::solve::bound::Reason;
use crate::solve::contact::{SolidContact, contact_of_facets, nominal_translation};
use crate::solve::overlap::{self, Overlap};
use crate::solve::scene::{PairFrame, noise_and_gap, permutes_axes};
use crate::solve::search::{Aim, GapSearch, LeastGap, Workspace, node_rounding};
use crate::solve::separate::find_separation;
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
            let (setting, core_gap) = (&self.setting, core_gap(self));
            let permuted =
                permutes_axes(setting.moving_matrix) && permutes_axes(setting.fixed_matrix);
            default_tolerance(permuted, noise_and_gap(setting.size(), core_gap).0)
        })
    }

    fn clearance_in(&self, workspace: &mut Workspace) -> Result<Clearance<Solid>, QueryError> {
        let (mut scene, mut steps) = (None, SolidSteps::default());
        let place = match answer_without_search(self, &mut scene, &mut steps)? {
            EarlyAnswer::Answer(answer) => return Ok(answer),
            EarlyAnswer::Overlapping(place) => Some(place),
            EarlyAnswer::Undecided => None,
        };
        let scene = get_or_build_scene(self, &mut scene)?;
        let ignored = self.options.start_overlap == StartOverlap::Ignore;
        let aim = match self.options.overlapping {
            Some(false) => Aim::Stop,
            Some(true) if ignored => Aim::LaterStop,
            _ => match place.or_else(|| overlap::find_overlap(scene, &mut steps)) {
                Some(_) if ignored => Aim::LaterStop,
                Some(place) => {
                    return Ok(Clearance::Overlapping(self.start_overlap_at(place, steps)));
                }
                None => Aim::Stop,
            },
        };
        let found = search_least_gap(scene, aim, gap_limit(self, scene), workspace, &mut steps);
        Ok(answer_from_search(self, scene, found.as_ref(), steps))
    }

    fn certified_clearance(&self) -> Result<(Clearance<Solid>, SolidCertificate), QueryError> {
        let (mut scene, mut steps) = (None, SolidSteps::default());
        let early = answer_without_search(self, &mut scene, &mut SolidSteps::default())?;
        let scene = get_or_build_scene(self, &mut scene)?;
        let bodies = [self.moving(), self.fixed()];
        let start = self.prove_start(scene, &mut steps);
        let mut certificate = SolidCertificate {
            tolerance: self.tolerance(),
            start,
            lower: 0.0,
            stop: None,
            cover: Cover::default(),
        };
        let aim = match (certificate.search_aim(self.options()), &certificate.start) {
            (None, &StartProof::Overlapping(place)) => {
                let overlap = self.start_overlap_at(place, steps);
                return Ok((Clearance::Overlapping(overlap), certificate));
            }
            (aim, _) => aim.unwrap_or(Aim::Stop),
        };
        let mut cuts = HashMap::new();
        let cut = |nodes, reason| {
            cuts.insert(nodes, reason);
        };
        let mut search = GapSearch::new(scene, aim, gap_limit(self, scene), cut);
        let found = search.find_least_gap(&mut Workspace::default());
        let end = search.limit;
        steps += search.steps;
        certificate.cover = Cover::new(bodies, &cuts);
        let answer = match early {
            EarlyAnswer::Answer(answer) => answer,
            _ => answer_from_search(self, scene, found.as_ref(), steps),
        };
        if let Clearance::Blocked { contact, .. } = &answer {
            let offset_distance = contact.offset_distance.value;
            certificate.stop = Some(StopProof { offset_distance, triangles: contact.triangles });
        }
        certificate.lower = proven_gap(scene, aim, end, &certificate.cover) / scene.setting.length;
        if certificate.lower <= 0.0 {
            // No pair contributes less than 0, so one entry for both roots suffices.
            certificate.lower = 0.0;
            certificate.cover = Cover(vec![Some(Reason::NotBefore)]);
        }
        Ok((answer, certificate))
    }

    fn contact_of_triangles(&self, triangles: [u32; 2]) -> Option<SolidContact> {
        if !contain_triangles(self, triangles) {
            return None;
        }
        let scene = self.query_scene();
        let later = self.options.overlapping == Some(true)
            && self.options.start_overlap == StartOverlap::Ignore;
        let aim = if later { Aim::LaterStop } else { Aim::Stop };
        let search = GapSearch::new(&scene, aim, gap_limit(self, &scene), |_, _| ());
        let found = search.compare_triangles(triangles)?;
        // Distances of contacts are at least 0.
        Some(contact_of_facets(
            &scene,
            &found,
            found.bounded(&scene).clamped_to_nonnegative(),
            SolidSteps::default(),
        ))
    }

    fn nominal_translation(
        &self,
        triangles: [u32; 2],
        shrunk: Bounded,
        normal: DVec3,
        shift: DVec3,
    ) -> Option<Bounded> {
        contain_triangles(self, triangles).then(|| {
            nominal_translation(&self.scene_with_tolerance(0.0), triangles, shrunk, normal, shift)
        })
    }

    fn overlaps(&self) -> bool {
        overlap::find_overlap(&self.query_scene(), &mut SolidSteps::default()).is_some()
    }

    fn start_overlap(&self) -> Option<SolidOverlap> {
        let mut steps = SolidSteps::default();
        let place = find_start_overlap(self, &self.query_scene(), &mut steps)?;
        Some(self.start_overlap_at(place, steps))
    }

    fn least_tolerance(&self) -> Option<f64> {
        least_tolerance_from(self, None, &mut SolidSteps::default())
    }

    fn first_contact_in(&self, workspace: &mut Workspace) -> Result<Outcome<Solid>, QueryError> {
        if let Some(outcome) = hull_first_contact(self) {
            return Ok(outcome);
        }
        let (scene, mut steps) = (self.scene_with_tolerance(0.0), SolidSteps::default());
        let found = search_least_gap(&scene, Aim::Least, f64::INFINITY, workspace, &mut steps);
        Ok(match found {
            Some(found) => {
                Outcome::Contact(contact_of_facets(&scene, &found, found.bounded(&scene), steps))
            }
            None => Outcome::Separated(SolidFree { separation: find_separation(&scene), steps }),
        })
    }

    fn exit(&self) -> Option<Bounded> {
        self.exit_in(&mut Workspace::default())
    }

    fn exit_in(&self, workspace: &mut Workspace) -> Option<Bounded> {
        let reversed = self.reversed();
        match hull_first_contact(&reversed) {
            Some(Outcome::Contact(last)) => return Some(last.exit().clamped_to_nonnegative()),
            Some(_) => return None,
            None => {}
        }
        let scene = reversed.scene_with_tolerance(0.0);
        let steps = &mut SolidSteps::default();
        let found = search_least_gap(&scene, Aim::Least, f64::INFINITY, workspace, steps)?;
        Some(found.bounded(&scene).negated().clamped_to_nonnegative())
    }
}

impl<'a> SolidScene<'a> for Cast<'a, Solid> {
    #[inline]
    fn scene_with_tolerance(&self, tolerance: f64) -> PairFrame<'a> {
        PairFrame::new(&self.setting, [tolerance / 2.0; 2], self.options.min_gap)
    }

    #[inline]
    fn query_scene(&self) -> PairFrame<'a> {
        self.scene_with_tolerance(self.tolerance())
    }

    #[inline]
    fn checked_query_scene(&self) -> Result<PairFrame<'a>, QueryError> {
        let tolerance = self.tolerance();
        // A tolerance in the options was checked when it was set.
        if self.options.tolerance.is_none() {
            check_thickness(self, tolerance)?;
        }
        Ok(self.scene_with_tolerance(tolerance))
    }

    #[inline]
    fn start_overlap_at(&self, place: Overlap, mut steps: SolidSteps) -> SolidOverlap {
        let least_tolerance = least_tolerance_from(self, Some(place), &mut steps);
        SolidOverlap { place, least_tolerance, steps }
    }

    fn prove_start(&self, scene: &PairFrame, steps: &mut SolidSteps) -> StartProof {
        // An overlap that is the answer is searched for, because the answer contains its place.
        let options = self.options();
        let is_answer =
            options.overlapping == Some(true) && options.start_overlap == StartOverlap::Refuse;
        if options.overlapping.is_some() && !is_answer {
            return StartProof::Assumed;
        }
        if let Some(place) = hull_overlap(self, Hulls::of_cast(self).as_ref(), scene, steps) {
            return StartProof::Overlapping(place);
        }
        let mut entries = Vec::new();
        let mut note = |entry| {
            steps.count_pair(entry);
            entries.push(entry);
        };
        match overlap::find_overlap_with(scene, &mut note) {
            Some(overlap) => StartProof::Overlapping(overlap),
            None => StartProof::Apart(Cover(entries)),
        }
    }

    fn verify_start(&self, scene: &PairFrame, start: &StartProof) -> Result<(), CertificateError> {
        verify::verify_start(self, scene, start)
    }
}

/// Returns the length from which on gaps are ignored: the end of the query, or infinity.
fn gap_limit(cast: &Cast<'_, Solid>, scene: &PairFrame) -> f64 {
    cast.options.before.map_or(f64::INFINITY, |t| t * scene.setting.length)
}

/// Result of the stages before a search.
enum EarlyAnswer {
    Answer(Clearance<Solid>),
    /// The offset bodies overlap at this place.
    Overlapping(Overlap),
    Undecided,
}

/// Runs the stages before a search, whether a proof is requested or not, and builds `scene` if a stage needs it.
/// Returns [`EarlyAnswer::Undecided`] if a search is necessary.
fn answer_without_search<'a>(
    cast: &Cast<'a, Solid>,
    scene: &mut Option<PairFrame<'a>>,
    steps: &mut SolidSteps,
) -> Result<EarlyAnswer, QueryError> {
    let by_boxes = answer_by_boxes(cast);
    if let BoxAnswer::Free(answer) = by_boxes {
        return Ok(EarlyAnswer::Answer(answer));
    }
    // If the boxes touch, an exact test of the boxes precedes the hulls. If the contact of the hulls is slightly
    // behind, the facets around it precede the certificate.
    let touching = matches!(by_boxes, BoxAnswer::Touching);
    let hulls = if touching { None } else { Hulls::of_cast(cast) };
    let is_uncertain = touching || hulls.as_ref().is_some_and(Hulls::has_shallow_contact);
    if !is_uncertain
        && let Some(answer) = hulls.as_ref().and_then(|hulls| hulls.transferred_clearance(cast))
    {
        return Ok(EarlyAnswer::Answer(answer));
    }
    let scene = get_or_build_scene(cast, scene)?;
    if touching && overlap::boxes_exclude_contact(scene, gap_limit(cast, scene)) {
        steps.nodes += 1;
        return Ok(EarlyAnswer::Answer(answer_from_search(cast, scene, None, *steps)));
    }
    let hulls = if touching { Hulls::of_cast(cast) } else { hulls };
    if let Some(place) = hull_overlap(cast, hulls.as_ref(), scene, steps) {
        return Ok(EarlyAnswer::Overlapping(place));
    }
    let by_hulls = hulls.and_then(|hulls| {
        let transferred = if is_uncertain { hulls.transferred_clearance(cast) } else { None };
        transferred.or_else(|| answer_by_hull_contact(cast, &hulls, scene))
    });
    Ok(by_hulls.map_or(EarlyAnswer::Undecided, EarlyAnswer::Answer))
}

/// Returns the scene at the tolerance of the query, built by the first call. Returns an error if the tolerance
/// leaves nothing of a body.
fn get_or_build_scene<'a, 's>(
    cast: &Cast<'a, Solid>,
    scene: &'s mut Option<PairFrame<'a>>,
) -> Result<&'s PairFrame<'a>, QueryError> {
    Ok(match scene {
        Some(scene) => scene,
        None => scene.insert(cast.checked_query_scene()?),
    })
}

/// Returns the first contact of the nominal bodies from the contact of their hulls; `None` if this does not prove it.
fn hull_first_contact(cast: &Cast<'_, Solid>) -> Option<Outcome<Solid>> {
    let options = SolidOptions::default().with_tolerance(0.0).with_min_gap(cast.options.min_gap);
    let nominal = Cast { options, ..*cast };
    Hulls::of_cast(&nominal)?.first_contact(&nominal)
}

/// Finds an overlap among the facets around the contact of the hulls. `None` if these show none, if there are no
/// hulls, or if the options state that the bodies do not overlap.
fn hull_overlap(
    cast: &Cast<'_, Solid>,
    hulls: Option<&Hulls>,
    scene: &PairFrame,
    steps: &mut SolidSteps,
) -> Option<Overlap> {
    if cast.options.overlapping == Some(false) {
        return None;
    }
    hulls?.shallow_overlap(scene, &mut steps.leaves)
}

/// Finds a place at which the bodies overlap, first near the contact of their hulls, then by a search.
fn find_start_overlap(
    cast: &Cast<'_, Solid>,
    scene: &PairFrame,
    steps: &mut SolidSteps,
) -> Option<Overlap> {
    let near_contact = hull_overlap(cast, Hulls::of_cast(cast).as_ref(), scene, steps);
    near_contact.or_else(|| overlap::find_overlap(scene, steps))
}

/// Computes the clearance from the facets around the contact of the hulls; `None` if these do not decide it.
fn answer_by_hull_contact(
    cast: &Cast<'_, Solid>,
    hulls: &Hulls,
    scene: &PairFrame,
) -> Option<Clearance<Solid>> {
    if let Some(answer) = hulls.touching_clearance(cast, scene) {
        return Some(answer);
    }
    let mut steps = SolidSteps::default();
    Some(match hulls.guess_at_contact(scene, gap_limit(cast, scene), &mut steps.leaves)? {
        ContactGuess::Stop(found, least) => {
            let transferred = hulls.clearance_by_facets(cast, &found, least, steps);
            transferred.unwrap_or_else(|| answer_from_search(cast, scene, Some(&found), steps))
        }
        ContactGuess::Free => answer_from_search(cast, scene, None, steps),
    })
}

/// Returns the gap (a length) that the entries of a cover prove, less their rounding errors, after a search that
/// ended with `limit`. Returns 0 if the cover proves no positive gap or does not fit the bodies.
fn proven_gap(scene: &PairFrame, aim: Aim, limit: f64, cover: &Cover) -> f64 {
    // The factor is slightly above 1 to cover the rounding of the bound on its way into the proof and out of it.
    let mut lower = limit - 1.0625 * node_rounding(scene);
    if lower <= 0.0 {
        return 0.0;
    }
    let bodies = [scene.moving.solid, scene.fixed.solid];
    let fits = cover.visit_entries(bodies, |_, nodes, reason| {
        if reason == Reason::Examined {
            lower = lower.min(leaf_gap_bound(scene, aim, nodes, limit));
        }
        true
    });
    if fits.is_ok() { lower } else { 0.0 }
}

/// Builds the clearance from the pair of facets that a search has found; it is free if there is none.
fn answer_from_search(
    cast: &Cast<'_, Solid>,
    scene: &PairFrame,
    found: Option<&LeastGap>,
    steps: SolidSteps,
) -> Clearance<Solid> {
    let Some(found) = found else {
        let to_the_end = cast.options.before.is_none();
        let separation = to_the_end.then(|| find_separation(scene)).flatten();
        return Clearance::Free(SolidFree { separation, steps });
    };
    // Distances of contacts are at least 0.
    let contact =
        contact_of_facets(scene, found, found.bounded(scene).clamped_to_nonnegative(), steps);
    Clearance::Blocked { distance: contact.translation.lower.max(0.0), contact }
}

/// Checks whether two triangles, by their positions, exist in the moving and the fixed body.
fn contain_triangles(cast: &Cast<'_, Solid>, triangles: [u32; 2]) -> bool {
    let counts = [cast.moving(), cast.fixed()].map(|solid| solid.triangles().len());
    triangles.into_iter().zip(counts).all(|(t, count)| (t as usize) < count)
}

/// Searches for the pair of facets with the least gap below `limit` (a length); `None` if there is none. Adds the
/// work to `steps`.
fn search_least_gap(
    scene: &PairFrame,
    aim: Aim,
    limit: f64,
    workspace: &mut Workspace,
    steps: &mut SolidSteps,
) -> Option<LeastGap> {
    let mut search = GapSearch::new(scene, aim, limit, |_, _| ());
    let found = search.find_least_gap(workspace);
    *steps += search.steps;
    found
}
