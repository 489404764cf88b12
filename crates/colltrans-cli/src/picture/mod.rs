//! Pictures of answers as SVG: both bodies at the start, the moving one where it stops, its translation, the contact.
//!
//! Convention: the moving body at its start is solid, where it stops it is a ghost. Only one of them is drawn if both
//! places agree. Notation as in [`View`]; `P` is the moving body, `Q` the fixed one, `n` the unit normal from `P` to `Q`.
//!
//! Hidden surfaces: a convex body hides its own faces exactly where they look away ([`solid`]). Between bodies, a plane
//! that separates them decides: `Q` is nearer if `n.v > 0`. The contact plane separates `Q` from `P` along its whole way
//! (`n.d > 0`), the separating plane of separated bodies as well (`n.d = 0`). Therefore drawing from back to front is
//! exact. [`parts`] uses a depth buffer for parts, [`pair`] for placed bodies, and [`motion`] for bodies that turn.
//!
//! Order: [`subject`] (content), [`viewpoint`], [`layout`] (scale, by [`size`]), [`solid`] and [`notes`] (drawing).

mod layout;
mod motion;
mod notes;
mod pair;
mod parts;
mod size;
mod solid;
mod subject;
mod viewpoint;

use colltrans::ContactRange;
use colltrans::glam::{DVec2, DVec3};
use colltrans_picture::{FINE_WIDTH, FIXED, FIXED_MARK, MOVING, MOVING_MARK, PLANE, Page, View};

use crate::solid::placed_surface;
use layout::Layout;
pub(crate) use motion::{MotionPicture, draw_motion};
use notes::Notes;
pub(crate) use pair::draw_pair;
pub(crate) use parts::draw_solids;
use parts::draw_with_depths;
use solid::Solid;
use subject::Subject;

/// A cast and its answer.
pub(crate) struct CastPicture<'a> {
    pub(crate) cast: &'a colltrans::Cast<'a>,
    pub(crate) answer: &'a ContactRange,
}

/// The vertices of a placed body, relative to a point, and its triangles.
pub(crate) type Surface = (Vec<DVec3>, Vec<[u32; 3]>);

/// Returns the mean of the vertices.
fn vertex_mean((vertices, _): &Surface) -> DVec3 {
    vertices.iter().sum::<DVec3>() / vertices.len().max(1) as f64
}

/// The bodies of a picture.
struct PictureBodies {
    /// P at its start; `None` if it stops there.
    start: Option<Solid>,
    /// P at its stop.
    stop: Solid,
    /// Q.
    fixed: Solid,
    /// P at other times of a motion, with its label in the legend.
    ghosts: Vec<(&'static str, Solid)>,
    /// The drawn translation from `start` to `stop`.
    way: DVec3,
    /// Whether the translation is drawn shorter than it is.
    is_broken: bool,
}

/// Returns the picture of a cast as SVG.
pub(crate) fn draw_cast(picture: &CastPicture<'_>) -> String {
    let subject = Subject::from_cast(picture);
    let bodies = PictureBodies::of_cast(picture, &subject);
    let unit = picture.cast.direction().normalize();
    if subject.stop < 0.0 {
        return draw_contact_behind(picture, &subject, &bodies);
    }
    let view = viewpoint::best_view([&bodies.stop, &bodies.fixed], unit, subject.view_direction());
    let layout = Layout::compute(&bodies, &subject, &view);
    let on_page = |p: DVec3| layout.on_page(view.project(p));
    let mut page = Page::new(layout.window);
    page.open_group(r#"clip-path="url(#window)""#);
    bodies.draw(&mut page, &view, &subject, on_page);
    if let Some(marks) = subject.marks {
        bodies.fixed.mark_hidden(&mut page, marks.fixed, FIXED_MARK, on_page);
        bodies.stop.mark_hidden(&mut page, marks.moving, MOVING_MARK, on_page);
    }
    page.close_group();
    let notes = Notes { bodies: &bodies, subject: &subject, layout: &layout, view: &view };
    notes.draw(&mut page, unit);
    page.finish(layout.size, layout.window, &subject.headline)
}

/// Returns the picture of a cast whose contact lies behind. The start may overlap the fixed body, so that no plane
/// separates them; a depth buffer decides instead.
fn draw_contact_behind(
    picture: &CastPicture<'_>,
    subject: &Subject,
    convex: &PictureBodies,
) -> String {
    let cast = picture.cast;
    let placed = [(cast.moving(), cast.moving_pose()), (cast.fixed(), cast.fixed_pose())];
    let surfaces = placed.map(|(body, pose)| placed_surface(body, &pose, subject.origin));
    let [moving, fixed] = surfaces.each_ref().map(|(v, t)| Solid::from_triangles(v.clone(), t));
    let bodies = PictureBodies::place(&moving, fixed, cast.direction(), subject);
    let triangles = surfaces.each_ref().map(|(_, triangles)| &triangles[..]);
    draw_with_depths(
        &bodies,
        subject,
        cast.direction().normalize(),
        triangles,
        |page, depth_view| {
            let on_page = |p: DVec3| depth_view.layout.on_page(depth_view.view.project(p));
            if let Some(marks) = subject.marks {
                convex.fixed.mark_hidden(page, marks.fixed, FIXED_MARK, on_page);
                convex.stop.mark_hidden(page, marks.moving, MOVING_MARK, on_page);
            }
        },
    )
}

/// Checks whether the fixed body is nearer to the viewer; the plane between the bodies decides.
fn fixed_is_nearer(subject: &Subject, view: &View) -> bool {
    subject.normal.dot(view.toward) > 0.0
}

impl PictureBodies {
    /// Returns the bodies of a cast.
    fn of_cast(picture: &CastPicture<'_>, subject: &Subject) -> Self {
        let cast = picture.cast;
        let fixed = Solid::new(cast.fixed(), &cast.fixed_pose(), subject.origin);
        let moving = Solid::new(cast.moving(), &cast.moving_pose(), subject.origin);
        Self::place(&moving, fixed, cast.direction(), subject)
    }

    /// Returns the bodies with the moving one at its start and its stop.
    fn place(moving: &Solid, fixed: Solid, direction: DVec3, subject: &Subject) -> Self {
        let unit = direction.normalize();
        let stop = moving.translated(unit * subject.stop);
        let size = size::working_size(
            stop.bounding_sphere().1,
            fixed.bounding_sphere().1,
            subject.stop.abs(),
        );
        let longest = 5.0 * size;
        let shown = subject.stop.clamp(-longest, longest);
        let way = unit * shown;
        let start = (shown.abs() > 0.01 * size).then(|| stop.translated(-way));
        let ghosts = Vec::new();
        Self { start, stop, fixed, ghosts, way, is_broken: shown != subject.stop }
    }

    /// Draws the bodies from back to front.
    fn draw(
        &self,
        page: &mut Page,
        view: &View,
        subject: &Subject,
        on_page: impl Fn(DVec3) -> DVec2 + Copy,
    ) {
        let fixed_is_nearer = fixed_is_nearer(subject, view);
        let ghost_is_nearer = self.way.dot(view.toward) > 0.0;
        let draw_ghost = |page: &mut Page| {
            if self.start.is_some() {
                self.stop.draw_ghost(page, view, &MOVING, on_page);
            }
            if let Some(marks) = subject.marks {
                self.stop.mark_visible(page, view, marks.moving, MOVING_MARK, on_page);
            }
        };
        let draw_moving = |page: &mut Page| {
            if self.start.is_some() && !ghost_is_nearer {
                draw_ghost(page);
            }
            self.solid().draw(page, view, &MOVING, on_page);
            if self.start.is_none() || ghost_is_nearer {
                draw_ghost(page);
            }
        };
        let draw_fixed = |page: &mut Page| {
            self.fixed.draw(page, view, &FIXED, on_page);
            if let Some(marks) = subject.marks {
                self.fixed.mark_visible(page, view, marks.fixed, FIXED_MARK, on_page);
            }
        };
        let draw_plane = |page: &mut Page| {
            if let Some(plane) = subject.plane_corners(self) {
                let style = format!(
                    r#"fill="{PLANE}" fill-opacity="0.28" stroke="{PLANE}" stroke-width="{FINE_WIDTH}""#
                );
                page.polygons(&style, [plane.map(on_page).to_vec()]);
            }
        };
        if fixed_is_nearer {
            draw_moving(page);
            draw_plane(page);
            draw_fixed(page);
        } else {
            draw_fixed(page);
            draw_plane(page);
            draw_moving(page);
        }
    }

    /// Returns the solid moving body: at its start, or at its stop if both places agree.
    fn solid(&self) -> &Solid {
        self.start.as_ref().unwrap_or(&self.stop)
    }

    /// Returns the moving body at all places where it is drawn as a ghost.
    fn ghosts(&self) -> impl Iterator<Item = &Solid> {
        let stop = self.start.is_some().then_some(&self.stop);
        stop.into_iter().chain(self.ghosts.iter().map(|(_, ghost)| ghost))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use colltrans::{ConvexPolyhedron, Pose};
    use colltrans_testkit::random::Random;

    /// Returns a random pose with a translation of about `distance`.
    fn random_pose(random: &mut Random, distance: f64) -> Pose {
        Pose::new(random.rotation(), distance * random.vector()).unwrap()
    }

    /// Returns the largest coordinate towards the viewer on the line of sight through a point; `None` if it misses the body.
    fn nearest_depth(solid: &Solid, view: &View, point: DVec3) -> Option<f64> {
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for (face, area) in solid.faces.iter().zip(&solid.areas) {
            let height = area.dot(point - solid.vertices[face[0] as usize]);
            let slope = area.dot(view.toward);
            match slope {
                s if s > 0.0 => high = high.min(-height / s),
                s if s < 0.0 => low = low.max(-height / s),
                _ if height > 0.0 => return None,
                _ => {}
            }
        }
        (low < high).then_some(high)
    }

    /// Compares the order of drawing with depths along random rays.
    #[test]
    fn bodies_are_drawn_back_to_front() {
        let random = &mut Random::new(1);
        let mut comparisons = [0, 0];
        for round in 0..300 {
            let body = |random: &mut Random| {
                let points: Vec<DVec3> = (0..9).map(|_| random.vector()).collect();
                ConvexPolyhedron::from_points(&points).unwrap()
            };
            let (moving, fixed) = (body(random), body(random));
            let moving_pose = random_pose(random, 3.0);
            let fixed_pose = random_pose(random, 1.0);
            let towards = fixed_pose.translation() - moving_pose.translation();
            let direction = towards + 0.7 * random.vector();
            let (moving, fixed) = (moving.at(moving_pose), fixed.at(fixed_pose));
            let question = colltrans::Cast::new(moving, fixed, direction).unwrap();
            let answer = question.contact_range().unwrap();
            let picture = CastPicture { cast: &question, answer: &answer };
            let subject = Subject::from_cast(&picture);
            if subject.stop < 0.0 {
                continue;
            }
            let bodies = PictureBodies::of_cast(&picture, &subject);
            let view = viewpoint::best_view(
                [&bodies.stop, &bodies.fixed],
                direction.normalize(),
                [subject.normal, -subject.normal][round % 2],
            );
            let fixed_is_nearer = fixed_is_nearer(&subject, &view);
            for solid in [Some(&bodies.stop), bodies.start.as_ref()].into_iter().flatten() {
                for _ in 0..400 {
                    let point = 0.8 * random.vector();
                    let depths = [solid, &bodies.fixed].map(|s| nearest_depth(s, &view, point));
                    let [Some(p), Some(q)] = depths else { continue };
                    comparisons[usize::from(fixed_is_nearer)] += 1;
                    let ahead = if fixed_is_nearer { q - p } else { p - q };
                    assert!(ahead > -1e-9, "{ahead} in {:?}", subject.headline);
                }
            }
        }
        assert!(comparisons.iter().all(|&count| count > 1000), "{comparisons:?}");
    }
}
