//! Campaign of rounded bodies: all questions about settings of all families, whose bodies get radii from below the
//! rounding error to many times their size. Bodies are also put to contact, and radii are those of a tie. The family
//! [`SHAPES`] has spheres, capsules, rounded plates and boxes with coordinates that are multiples of one half.

use colltrans::{Cast, ConvexPolyhedron, Outcome, Pair, Placed, Pose, Tracker};
use colltrans_testkit::oracle::rounded::{Answers, judge_all};
use colltrans_testkit::oracle::settings::setting;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::reach;
use colltrans_testkit::tally::Tally;
use glam::{DQuat, DVec3};

use crate::{Asked, casts};

/// The family of bodies with few vertices at coordinates that are multiples of one half.
pub(crate) const SHAPES: &str = "round-shapes";

/// Number of casts of a setting that share a tracker. Between them the moving body moves a little.
const STEPS: u32 = 3;

/// Maximum number of pairs of vertices for which depths of overlapping cores are compared with the exact one.
const FEW_PAIRS: usize = 64;

/// Columns of the table.
pub(crate) const COLUMNS: &[&str] = &[
    "settings",
    "casts",
    "contact",
    "grazing",
    "separated",
    "apart",
    "deep",
    "compared",
    "widest",
    "widest distance",
    "widest depth",
    "open",
];

/// Two bodies with their poses, and a direction.
struct RoundedSetting {
    bodies: [ConvexPolyhedron; 2],
    poses: [Pose; 2],
    direction: DVec3,
}

impl RoundedSetting {
    fn placed(&self) -> [Placed<'_>; 2] {
        [0, 1].map(|k| self.bodies[k].at(self.poses[k]))
    }

    fn cast(&self) -> Option<Cast<'_>> {
        let [moving, fixed] = self.placed();
        Cast::new(moving, fixed, self.direction).ok()
    }

    fn pair(&self) -> Option<Pair<'_>> {
        let [moving, fixed] = self.placed();
        Pair::new(moving, fixed).ok()
    }

    /// Returns the setting with bodies rounded by these radii; `None` if a radius is out of range.
    fn rounded(self, radii: [f64; 2]) -> Option<Self> {
        let [p, q] = self.bodies;
        let bodies = [p.rounded(radii[0]).ok()?, q.rounded(radii[1]).ok()?];
        Some(Self { bodies, ..self })
    }

    /// Moves the moving body; not if it leaves the accepted range.
    fn move_by(&mut self, by: DVec3) {
        self.poses[0] = self.poses[0].translated_by(by).unwrap_or(self.poses[0]);
    }

    /// Moves the moving body to its first contact, or a little before or beyond it.
    fn move_near_contact(&mut self, size: f64, random: &mut Random) {
        let found = self.cast().and_then(|cast| cast.first_contact().ok());
        if let Some(Outcome::Contact(contact)) = found {
            let off = match random.index(3) {
                0 => 0.0,
                1 => size * 10.0_f64.powf(-random.range(3.0, 15.0)),
                _ => -size * 10.0_f64.powf(-random.range(0.0, 15.0)),
            };
            let back = self.direction.normalize_or_zero() * off;
            self.move_by(self.direction * contact.translation - back);
        }
    }
}

/// Examines all questions about a setting.
pub(crate) fn examine(asked: &Asked<'_>, tally: &mut Tally) -> Result<(), String> {
    let mut random = Random::new(asked.seed ^ 0x0b0d);
    tally.count("settings");
    let Some(mut setting) = draw_setting(asked, &mut random) else { return Ok(()) };
    let size = setting.bodies.iter().map(|body| reach(body.vertices())).fold(1e-50, f64::max);
    let scale = size + setting.bodies[0].radius() + setting.bodies[1].radius();
    if random.one_in(3) {
        setting.move_near_contact(scale, &mut random);
    }
    let gap = match random.index(8) {
        0 => scale * 10.0_f64.powf(random.range(-12.0, 0.5)),
        1 => random.pick(&[0.125, 0.5, 1.0]),
        _ => 0.0,
    };
    let poses = steps_from(setting.poses[0], scale, &mut random);
    let mut tracker = Tracker::new();
    for pose in poses {
        let [moving, fixed] = [setting.bodies[0].at(pose), setting.bodies[1].at(setting.poses[1])];
        let cast = Cast::new(moving, fixed, setting.direction);
        let Ok(cast) = cast.and_then(|cast| cast.with_min_gap(gap.min(1e58))) else { continue };
        judge_cast(&cast, &mut tracker, scale * random.range(0.0, 2.0), &mut random, tally)
            .map_err(|what| format!("{what}: radii {:?}", cast_radii(&cast)))?;
    }
    Ok(())
}

/// Returns the radii of the bodies of a cast and its minimum gap.
fn cast_radii(cast: &Cast) -> [f64; 3] {
    [cast.moving().radius(), cast.fixed().radius(), cast.options().min_gap]
}

/// Judges all questions about a cast.
fn judge_cast<'a>(
    cast: &Cast<'a>,
    tracker: &mut Tracker<'a>,
    length: f64,
    random: &mut Random,
    tally: &mut Tally,
) -> Result<(), String> {
    let pairs = cast.moving().vertices().len() * cast.fixed().vertices().len();
    let compares = pairs <= FEW_PAIRS && random.one_in(4);
    tally.count("casts");
    let found = judge_all(cast, tracker, length, compares).map_err(|e| e.to_string())?;
    let Some(Answers { outcome, distance, depth, widths }) = found else {
        tally.count("open");
        return Ok(());
    };
    tally.count(casts::kind(&outcome));
    tally.count_if("apart", distance.lower > 0.0);
    tally.count_if("deep", depth.lower > 0.0);
    tally.count_if("compared", compares);
    for (name, width) in ["widest", "widest distance", "widest depth"].into_iter().zip(widths) {
        tally.largest(name, width);
    }
    Ok(())
}

/// Returns a pose and others after small displacements and rotations.
fn steps_from(start: Pose, size: f64, random: &mut Random) -> Vec<Pose> {
    let mut poses = vec![start];
    while poses.len() < STEPS as usize {
        let last = poses[poses.len() - 1];
        let share = 10.0_f64.powf(random.range(-9.0, -0.5));
        let turn = DQuat::from_axis_angle(random.direction(), share) * last.rotation();
        let to = last.translation() + random.direction() * (share * size);
        poses.push(Pose::new(turn.normalize(), to).unwrap_or(last));
    }
    poses
}

/// Draws the bodies of a family with radii; `None` if there are none.
fn draw_setting(asked: &Asked<'_>, random: &mut Random) -> Option<RoundedSetting> {
    if asked.family == SHAPES {
        return draw_shapes(random);
    }
    let setting = setting(asked.family, asked.seed);
    let bodies = setting.bodies().ok()?;
    let bodies = [bodies.moving, bodies.fixed];
    let poses = [setting.moving_pose, setting.fixed_pose];
    let plain = RoundedSetting { bodies, poses, direction: setting.direction };
    let size = plain.bodies.iter().map(|body| reach(body.vertices())).fold(1e-3, f64::max);
    let sum = match random.index(8) {
        // The distance of the cores, or that of their shadows, up to rounding: a tie.
        0 => plain.pair()?.distance().ok()?.upper,
        1 => colltrans_testkit::oracle::min_gap::GapJudge::new(plain.cast()?).shadows,
        2 => size * f64::EPSILON * random.range(0.0, 400.0),
        3 => size * 10.0_f64.powf(random.range(0.0, 4.0)),
        _ => size * 10.0_f64.powf(random.range(-12.0, 1.0)),
    };
    let sum = sum * (1.0 + random.pick(&[0.0, 0.0, 1e-15, -1e-15, 1e-9, 0.25]));
    let any = random.unit();
    let share = random.pick(&[0.0, 0.5, 1.0, any]);
    let radii = [share, 1.0 - share].map(|share| sum * share);
    plain.rounded(radii.map(|radius| if (1e-60..1e58).contains(&radius) { radius } else { 0.0 }))
}

/// Draws bodies of [`SHAPES`].
fn draw_shapes(random: &mut Random) -> Option<RoundedSetting> {
    let half = |random: &mut Random, most: i64| random.whole(0, 2 * most) * 0.5;
    let [moving, fixed] = [(); 2].map(|()| {
        let corners = 2_usize.pow(random.index(4) as u32).min(8);
        let side = DVec3::new(half(random, 3), half(random, 3), half(random, 3));
        let low = random.grid(-2, 2) * 0.5;
        let corner = |k: usize| {
            let bit = |n: usize| if k >> n & 1 == 1 { 1.0 } else { 0.0 };
            low + side * DVec3::new(bit(0), bit(1), bit(2))
        };
        ConvexPolyhedron::from_points(&(0..corners).map(corner).collect::<Vec<_>>()).ok()
    });
    let mut pose = |far: i64| {
        let quarter = DQuat::from_xyzw(0.5, 0.5, 0.5, 0.5);
        let turn = match random.index(4) {
            0 => random.rotation(),
            1 => quarter,
            _ => DQuat::IDENTITY,
        };
        Pose::new(turn, random.grid(-far, far) * 0.5).ok()
    };
    let poses = [pose(8)?, pose(0)?];
    let direction = random.grid(-2, 2);
    let radii = [half(random, 2), half(random, 2)];
    let bodies = [moving?, fixed?];
    RoundedSetting { bodies, poses, direction }.rounded(radii)
}
