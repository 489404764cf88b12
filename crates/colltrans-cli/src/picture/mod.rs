//! A picture of an answer, as one would put it in a paper: both bodies, the moving one at its start
//! (light) and where it stops, the way it goes, the contact.
//!
//! Notation as in [`View`]; `P` is the moving body, `Q` the fixed one, `n` the unit normal from `P`
//! to `Q`.
//!
//! Hidden surfaces. A convex body hides its own parts where they look away ([`solid`]). Between
//! bodies, a plane that separates them tells which is nearer: `Q` if `n.v > 0`. For
//! a contact ahead, the contact plane separates `Q` from `P` not only at the contact but all along
//! its way (`n.d > 0`); for separated bodies, the separating plane does (`n.d = 0`). So
//! drawing from back to front is exact, which for three bodies without such a plane it need not be.
//! Where the contact lies behind, the start may overlap `Q`; it is drawn last, as an outline that
//! hides nothing.
//!
//! Parts that need not be convex have no such order: [`parts`] draws them by a buffer of depths, as
//! [`pair`] does two bodies of any kind where they are, and [`motion`] bodies that turn.
//!
//! Order: [`subject`] (what is to be shown) -> [`viewpoint`] (from where) -> [`layout`]
//! (how large, by [`size`]) -> [`solid`] and [`notes`] (the drawing) -> [`Page`].

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
use colltrans_picture::{FIXED, FIXED_MARK, MOVING, MOVING_MARK, Page, View};

use layout::Layout;
pub(crate) use motion::{Moved, draw_motion};
use notes::Notes;
pub(crate) use pair::draw_pair;
pub(crate) use parts::draw_solids;
use solid::Solid;
use subject::Subject;

/// A query and its answer.
pub(crate) struct Scene<'a> {
    pub(crate) cast: &'a colltrans::Cast<'a>,
    pub(crate) answer: &'a ContactRange,
}

/// Vertices of a body where it is placed, relative to a point, and triangles.
pub(crate) type Surface = (Vec<DVec3>, Vec<[u32; 3]>);

/// Returns the mean of the vertices.
fn middle_of((vertices, _): &Surface) -> DVec3 {
    vertices.iter().sum::<DVec3>() / vertices.len().max(1) as f64
}

/// The bodies as they are drawn.
struct Cast {
    /// P at its start, unless that is where it stops.
    start: Option<Solid>,
    /// P where it stops.
    stop: Solid,
    /// Q.
    fixed: Solid,
    /// P at other times, of a motion.
    ghosts: Vec<(&'static str, Solid)>,
    /// From `start` to `stop`, as drawn.
    way: DVec3,
    /// The way is drawn shorter than it is.
    is_broken: bool,
}

/// The SVG file.
pub(crate) fn draw(scene: &Scene<'_>) -> String {
    let subject = Subject::of(scene);
    let cast = Cast::of(scene, &subject);
    let unit = scene.cast.direction().normalize();
    let view = viewpoint::choose([&cast.stop, &cast.fixed], unit, subject.looked_along());
    let layout = Layout::of(&cast, &subject, &view);
    let on_page = |p: DVec3| layout.on_page(view.project(p));
    let mut page = Page::new(layout.window);
    page.open_group(r#"clip-path="url(#window)""#);
    cast.draw(&mut page, &view, &subject, on_page);
    if let Some(marks) = subject.marks {
        cast.fixed.mark_hidden(&mut page, marks.fixed, FIXED_MARK, on_page);
        cast.stop.mark_hidden(&mut page, marks.moving, MOVING_MARK, on_page);
    }
    page.close_group();
    let notes = Notes { cast: &cast, subject: &subject, layout: &layout, view: &view };
    notes.draw(&mut page, unit);
    page.finish(layout.size, layout.window, &subject.headline)
}

/// Which of the bodies may hide the other; the plane between them decides.
fn fixed_is_nearer(subject: &Subject, view: &View) -> bool {
    subject.normal.dot(view.toward) > 0.0
}

impl Cast {
    fn of(scene: &Scene<'_>, subject: &Subject) -> Self {
        let cast = scene.cast;
        let fixed = Solid::new(cast.fixed(), &cast.fixed_pose(), subject.origin);
        let moving = Solid::new(cast.moving(), &cast.moving_pose(), subject.origin);
        Self::placed(&moving, fixed, cast.direction(), subject)
    }

    /// From where the bodies are.
    fn placed(moving: &Solid, fixed: Solid, direction: DVec3, subject: &Subject) -> Self {
        let unit = direction.normalize();
        let stop = moving.moved(unit * subject.stop);
        let size = size::working_size(stop.ball().1, fixed.ball().1, subject.stop.abs());
        let longest = 5.0 * size;
        let shown = subject.stop.clamp(-longest, longest);
        let way = unit * shown;
        let start = (shown.abs() > 0.01 * size).then(|| stop.moved(-way));
        let ghosts = Vec::new();
        Self { start, stop, fixed, ghosts, way, is_broken: shown != subject.stop }
    }

    /// From back to front.
    fn draw(
        &self,
        page: &mut Page,
        view: &View,
        subject: &Subject,
        on_page: impl Fn(DVec3) -> DVec2 + Copy,
    ) {
        let fixed_is_nearer = fixed_is_nearer(subject, view);
        let stop_is_nearer = self.way.dot(view.toward) > 0.0;
        let is_behind = subject.stop < 0.0;
        let draw_start = |page: &mut Page| {
            if let Some(start) = &self.start {
                start.draw_ghost(page, view, &MOVING, on_page);
            }
        };
        let draw_moving = |page: &mut Page| {
            if stop_is_nearer && !is_behind {
                draw_start(page);
            }
            self.stop.draw(page, view, &MOVING, on_page);
            if let Some(marks) = subject.marks {
                self.stop.mark(page, view, marks.moving, MOVING_MARK, on_page);
            }
            if !stop_is_nearer && !is_behind {
                draw_start(page);
            }
        };
        let draw_fixed = |page: &mut Page| {
            self.fixed.draw(page, view, &FIXED, on_page);
            if let Some(marks) = subject.marks {
                self.fixed.mark(page, view, marks.fixed, FIXED_MARK, on_page);
            }
        };
        let draw_plane = |page: &mut Page| {
            if let Some(plane) = subject.plane(self) {
                let look =
                    r##"fill="#f0b429" fill-opacity="0.28" stroke="#a87600" stroke-width="0.8""##;
                page.polygons(look, [plane.map(on_page).to_vec()]);
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
        if is_behind {
            draw_start(page);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use colltrans::{ConvexPolyhedron, Pose};
    use colltrans_testkit::random::Random;

    fn any_pose(random: &mut Random, distance: f64) -> Pose {
        Pose::new(random.rotation(), distance * random.vector()).unwrap()
    }

    /// How near a solid comes to the viewer on the line of sight through a point.
    fn nearest(solid: &Solid, view: &View, point: DVec3) -> Option<f64> {
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

    /// Against the slow way, ray by ray: what is drawn later is nearer wherever both are seen.
    #[test]
    fn what_is_drawn_later_is_nearer() {
        let random = &mut Random::new(1);
        let mut compared = [0, 0];
        for round in 0..300 {
            let body = |random: &mut Random| {
                let points: Vec<DVec3> = (0..9).map(|_| random.vector()).collect();
                ConvexPolyhedron::from_points(&points).unwrap()
            };
            let (moving, fixed) = (body(random), body(random));
            let moving_pose = any_pose(random, 3.0);
            let fixed_pose = any_pose(random, 1.0);
            let towards = fixed_pose.translation() - moving_pose.translation();
            let direction = towards + 0.7 * random.vector();
            let (moving, fixed) = (moving.at(moving_pose), fixed.at(fixed_pose));
            let question = colltrans::Cast::new(moving, fixed, direction).unwrap();
            let answer = question.contact_range().unwrap();
            let scene = Scene { cast: &question, answer: &answer };
            let subject = Subject::of(&scene);
            if subject.stop < 0.0 {
                continue;
            }
            let cast = Cast::of(&scene, &subject);
            let view = viewpoint::choose(
                [&cast.stop, &cast.fixed],
                direction.normalize(),
                [subject.normal, -subject.normal][round % 2],
            );
            let fixed_is_nearer = fixed_is_nearer(&subject, &view);
            for solid in [Some(&cast.stop), cast.start.as_ref()].into_iter().flatten() {
                for _ in 0..400 {
                    let point = 0.8 * random.vector();
                    let depths = [solid, &cast.fixed].map(|s| nearest(s, &view, point));
                    let [Some(p), Some(q)] = depths else { continue };
                    compared[usize::from(fixed_is_nearer)] += 1;
                    let ahead = if fixed_is_nearer { q - p } else { p - q };
                    assert!(ahead > -1e-9, "{ahead} in {:?}", subject.headline);
                }
            }
        }
        assert!(compared.iter().all(|&count| count > 1000), "{compared:?}");
    }
}
