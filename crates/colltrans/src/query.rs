//! The public queries, each a one-off function.

use glam::{DVec2, DVec3};

use crate::answer;
use crate::certificate::VertexPair;
use crate::cta::{self, CtaOptions, CtaStart, Guess};
use crate::error::QueryError;
use crate::minkowski::Difference;
use crate::outcome::{
    Clearance, Contact, ContactRange, Grazing, Outcome, Separated, Solver, Steps,
};
use crate::polyhedron::ConvexPolyhedron;
use crate::portal::{self, Enclosure, Overlap, Refined, Start};
use crate::pose::Pose;
use crate::setting::Setting;

/// Choices of a query; the default is right for almost everyone.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Options {
    /// How the search is narrowed.
    pub solver: Solver,
    /// Sideways overlap (world units) up to which a contact counts as grazing. `0`, the default, stands for the rounding
    /// error of the configuration, which is the least that is ever used.
    pub graze_tolerance: f64,
}

/// How far `moving` can translate along `direction` before it touches `fixed`.
///
/// The poses place both bodies in the world; `direction` is a vector of the world of any length, and translations are in
/// multiples of it.
///
/// # Errors
/// A direction that is zero, not finite or out of range; bounds that could not be closed.
pub fn cast(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
    direction: DVec3,
) -> Result<Outcome, QueryError> {
    cast_with(moving, moving_pose, fixed, fixed_pose, direction, &Options::default())
}

/// [`cast`] with [`Options`].
///
/// # Errors
/// As [`cast`], and a graze tolerance that is negative or not finite.
pub fn cast_with(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
    direction: DVec3,
    options: &Options,
) -> Result<Outcome, QueryError> {
    let tolerance = options.graze_tolerance;
    if !tolerance.is_finite() || tolerance < 0.0 {
        return Err(QueryError::GrazeTolerance { tolerance });
    }
    let setting = Setting::new(moving, moving_pose, fixed, fixed_pose, direction)?;
    let solver = match options.solver {
        Solver::Auto => Solver::Portal,
        solver => solver,
    };
    Cast {
        difference: Difference::new(&setting),
        moving_pose,
        graze_tolerance: tolerance,
        solver,
        steps: Steps::default(),
    }
    .run()
}

/// All translations along `direction` at which the bodies meet.
///
/// # Errors
/// As [`cast_with`].
pub fn contact_range(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
    direction: DVec3,
    options: &Options,
) -> Result<ContactRange, QueryError> {
    let run = |direction| cast_with(moving, moving_pose, fixed, fixed_pose, direction, options);
    let forward = run(direction)?;
    if let Outcome::Separated(separated) = forward {
        return Ok(ContactRange::Separated(separated));
    }
    // Seen backwards the shadows are the same; only the last bits of their overlap may differ.
    Ok(match (forward, run(-direction)?) {
        (_, Outcome::Separated(separated)) => ContactRange::Separated(separated),
        (Outcome::Contact(first), Outcome::Contact(last)) => ContactRange::Contact { first, last },
        (Outcome::Grazing(first), Outcome::Contact(last)) => {
            ContactRange::Grazing { first, last: Grazing { contact: last, ..first } }
        }
        (Outcome::Contact(first), Outcome::Grazing(last)) => {
            ContactRange::Grazing { first: Grazing { contact: first, ..last }, last }
        }
        (Outcome::Grazing(first), Outcome::Grazing(last)) => ContactRange::Grazing { first, last },
        (Outcome::Separated(separated), _) => ContactRange::Separated(separated),
    })
}

/// How far `moving` can move along `direction` from where it is.
///
/// Contacts behind and grazing slides do not block. Bodies that touch now, to within rounding, block each other if
/// the motion would make them overlap, and do not if it takes them apart.
///
/// # Errors
/// As [`cast_with`].
pub fn clearance(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
    direction: DVec3,
    options: &Options,
) -> Result<Clearance, QueryError> {
    let run = |direction| cast_with(moving, moving_pose, fixed, fixed_pose, direction, options);
    let Outcome::Contact(contact) = run(direction)? else { return Ok(Clearance::Free) };
    if contact.translation >= -contact.certificate.tolerance {
        let distance = contact.translation.max(0.0);
        return Ok(Clearance::Blocked { distance, contact });
    }
    Ok(match run(-direction)? {
        Outcome::Contact(last) if last.translation < -last.certificate.tolerance => {
            Clearance::Overlapping { range: [contact.translation, -last.translation] }
        }
        _ => Clearance::Free,
    })
}

/// Whether the bodies, as closed sets and to within rounding error, have a point in common where they are.
///
/// The moving body is cast along the line through both centres, which passes the deepest
/// part of the Minkowski difference, so the answer is as well conditioned as the question.
///
/// # Errors
/// As [`cast`].
pub fn intersects(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
) -> Result<bool, QueryError> {
    let center = |body: &ConvexPolyhedron, pose: &Pose| pose.matrix() * body.measure().center;
    let between = (center(fixed, fixed_pose) - center(moving, moving_pose))
        + (fixed_pose.translation() - moving_pose.translation());
    let Some(direction) = between.try_normalize() else { return Ok(true) };
    Ok(match cast(moving, moving_pose, fixed, fixed_pose, direction)? {
        Outcome::Contact(contact) | Outcome::Grazing(Grazing { contact, .. }) => {
            contact.translation <= contact.certificate.tolerance
        }
        Outcome::Separated(_) => false,
    })
}

/// How far `moving`, where it overlaps `fixed`, has to go back along `-direction` until they only touch, in multiples of
/// `direction`; 0 if they do not overlap.
///
/// # Errors
/// As [`cast_with`].
pub fn directional_depth(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
    direction: DVec3,
    options: &Options,
) -> Result<f64, QueryError> {
    Ok(match clearance(moving, moving_pose, fixed, fixed_pose, direction, options)? {
        Clearance::Overlapping { range } => -range[0],
        Clearance::Free | Clearance::Blocked { .. } => 0.0,
    })
}

/// One cast under way.
struct Cast<'a> {
    difference: Difference<'a>,
    moving_pose: &'a Pose,
    graze_tolerance: f64,
    solver: Solver,
    steps: Steps,
}

impl Cast<'_> {
    fn run(mut self) -> Result<Outcome, QueryError> {
        let start = self.start();
        let noise = self.difference.noise;
        match portal::enclose(&self.difference, &start, &mut self.steps) {
            None => Err(self.not_converged()),
            Some(Enclosure::Portal(first)) => self.contact_or_grazing(first, &start),
            Some(Enclosure::OneSide { normal, margin, .. }) if margin > noise => {
                Ok(Outcome::Separated(self.separated(normal, margin)))
            }
            Some(Enclosure::OneSide { normal, margin, point }) => {
                let found = (normal, margin, point);
                let (normal, margin) =
                    portal::widest_margin(&self.difference, found, &mut self.steps);
                if margin > noise {
                    return Ok(Outcome::Separated(self.separated(normal, margin)));
                }
                self.touching(normal, margin, &start).map(Outcome::Grazing)
            }
        }
    }

    /// The first guess of the contact normal.
    fn start(&mut self) -> Start {
        let setting = self.difference.setting;
        let solid = setting.moving.dimension() == 3 && setting.fixed.dimension() == 3;
        if self.solver != Solver::Cta || !solid {
            return Start::from_ellipsoids(&self.difference);
        }
        let ellipsoids = Start::from_ellipsoids(&self.difference);
        let start = (ellipsoids.normal.z > 0.0).then(|| {
            self.steps.supports += 1;
            let VertexPair { moving, fixed } = self.difference.support(ellipsoids.normal).pair;
            let normal = self.difference.axes * ellipsoids.normal;
            CtaStart { normal, supports: [moving, fixed] }
        });
        let narrowed = cta::minimise(setting, &CtaOptions { start, ..CtaOptions::default() });
        self.steps.planar_problems += narrowed.planar_problems;
        let [moving, fixed] = narrowed.vertices;
        let near = VertexPair { moving: moving[0], fixed: fixed[0] };
        match narrowed.guess {
            Guess::Contact { normal } => self.guess(normal, near),
            Guess::Separation { direction } => {
                let lateral = self.difference.axes.transpose() * direction;
                Start::from_guess(&self.difference, lateral.truncate().extend(0.0), near)
            }
            Guess::Nothing => Start::from_ellipsoids(&self.difference),
        }
    }

    fn guess(&self, normal: DVec3, near: VertexPair) -> Start {
        Start::from_guess(&self.difference, self.difference.axes.transpose() * normal, near)
    }

    fn contact_or_grazing(
        mut self,
        first: portal::Portal,
        start: &Start,
    ) -> Result<Outcome, QueryError> {
        let optimum = match portal::refine(&self.difference, first, &mut self.steps) {
            Some(Refined::Optimum(optimum)) => optimum,
            Some(Refined::Rim { normal, margin }) => {
                return self.touching(normal, margin, start).map(Outcome::Grazing);
            }
            None => return Err(self.not_converged()),
        };
        let tolerance = self.graze_tolerance.max(self.difference.touching());
        let overlap =
            portal::overlap(&self.difference, &optimum.portal, tolerance, &mut self.steps);
        let contact = self.contact(&optimum)?;
        Ok(match overlap {
            Overlap::Ample => Outcome::Contact(contact),
            Overlap::Slight { inward, depth } => {
                Outcome::Grazing(answer::grazing(&self.difference, inward, depth, contact))
            }
        })
    }

    /// The shadow of `M` ends at the line, or misses it by less than rounding can tell: the contact of the bodies widened
    /// sideways by a little more than that.
    fn touching(
        mut self,
        normal: DVec2,
        margin: f64,
        start: &Start,
    ) -> Result<Grazing, QueryError> {
        self.difference = self.difference.widened(margin);
        let Some(Enclosure::Portal(first)) =
            portal::enclose(&self.difference, start, &mut self.steps)
        else {
            return Err(self.not_converged());
        };
        let Some(Refined::Optimum(optimum)) =
            portal::refine(&self.difference, first, &mut self.steps)
        else {
            return Err(self.not_converged());
        };
        let contact = self.contact(&optimum)?;
        Ok(answer::grazing(&self.difference, normal, -margin, contact))
    }

    fn contact(&self, optimum: &portal::Optimum) -> Result<Contact, QueryError> {
        answer::contact(&self.difference, self.moving_pose, optimum, self.solver, self.steps)
    }

    fn separated(&self, normal: DVec2, margin: f64) -> Separated {
        answer::separated(&self.difference, normal, margin, self.solver, self.steps)
    }

    fn not_converged(&self) -> QueryError {
        QueryError::NotConverged {
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            tolerance: self.difference.noise,
        }
    }
}

#[cfg(test)]
mod timing {
    use super::*;
    use crate::polyhedron::testing::ring_ellipsoid;
    use std::time::Instant;
    struct Rng(u64);
    impl Rng {
        fn f(&mut self) -> f64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }
        fn v(&mut self) -> DVec3 {
            DVec3::new(self.f() - 0.5, self.f() - 0.5, self.f() - 0.5)
        }
    }
    #[test]
    fn timing() {
        for n in [8, 8, 32, 128, 512, 2000, 10_000, 50_000, 200_000].into_iter() {
            for solver in [Solver::Portal, Solver::Cta] {
                let mut r = Rng(0x1234_5678_9abc_def1);
                let mut bodies = vec![];
                for _ in 0..4 {
                    let ax = DVec3::new(0.6 + 0.8 * r.f(), 0.6 + 0.8 * r.f(), 0.6 + 0.8 * r.f());
                    bodies.push(ring_ellipsoid(n, ax));
                }
                let mut settings = vec![];
                for i in 0..2000 {
                    let q = |r: &mut Rng| {
                        glam::DQuat::from_xyzw(r.f() - 0.5, r.f() - 0.5, r.f() - 0.5, r.f() - 0.5)
                            .normalize()
                    };
                    let d = r.v().normalize();
                    let lat = r.v().cross(d).normalize() * r.f() * 1.2;
                    let pp = Pose::new(q(&mut r), DVec3::ZERO).unwrap();
                    let pq = Pose::new(q(&mut r), d * 5.0 + lat).unwrap();
                    settings.push((i % 4, (i / 4 + 1 + i) % 4, pp, pq, d));
                }
                let mut sup = vec![];
                let (mut times, mut steps, mut sep) = (vec![], Steps::default(), 0);
                let mut worst = 0.0_f64;
                for pass in 0..(if n == 8 { 60 } else { 5 }) {
                    for (a, b, pp, pq, d) in &settings {
                        let t = Instant::now();
                        let out = cast_with(
                            &bodies[*a],
                            pp,
                            &bodies[*b],
                            pq,
                            *d,
                            &Options { solver, ..Options::default() },
                        );
                        let el = t.elapsed().as_nanos();
                        match out.unwrap() {
                            Outcome::Contact(c) => {
                                times.push(el);
                                sup.push((c.steps.supports, c.steps.pivots));
                                steps.supports += c.steps.supports;
                                steps.pivots += c.steps.pivots;
                                steps.planar_problems += c.steps.planar_problems;
                                worst = worst.max(c.certificate.gap() / c.certificate.tolerance);
                                if pass == 0 {
                                    c.certificate
                                        .verify(&bodies[*a], pp, &bodies[*b], pq, *d)
                                        .unwrap();
                                }
                            }
                            Outcome::Grazing(_) => panic!(),
                            Outcome::Separated(_) => sep += 1,
                        }
                    }
                }
                let t = Instant::now();
                for _ in 0..1000 {
                    std::hint::black_box(Instant::now());
                }
                let clock = t.elapsed().as_nanos() / 1000;
                times.sort_unstable();
                sup.sort_unstable();
                println!(
                    "sup p50 {:?} p90 {:?} p99 {:?} max {:?}",
                    sup[sup.len() / 2],
                    sup[sup.len() * 9 / 10],
                    sup[sup.len() * 99 / 100],
                    sup[sup.len() - 1]
                );
                let k = times.len();
                println!(
                    "n {n:7} {:7} clock {clock} median {:6} p99 {:6} supports {:.2} pivots {:.2} sep {sep} worst {worst:.2} bytes/v {}",
                    bodies[0].vertices().len(),
                    times[k / 2],
                    times[k * 99 / 100],
                    f64::from(steps.supports) / k as f64,
                    f64::from(steps.pivots) / k as f64,
                    bodies[0].memory_bytes() / bodies[0].vertices().len()
                );
                println!("planar {:.2}", f64::from(steps.planar_problems) / k as f64);
            }
        }
    }
}
