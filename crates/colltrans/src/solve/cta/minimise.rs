//! The minimisation: solve the planar problem at the centroid, shift to the cell's best point, cut,
//! repeat.

use glam::{DVec2, DVec3};

use super::MAX_STEPS;
use super::bound::{LowerBound, Progress};
use super::cell::{Affine, Frame, Piece};
use super::planar::{self, Near, Planar};
use super::region::Region;
use super::side::{Crossing, Side};
use crate::body::ConvexPolyhedron;
use crate::body::convex::sections::{AXIS_LENGTH, AxisPair};
use crate::setting::Setting;
use crate::solve::observe::{self, Cut, Observer, Phase, PlanarProblem, Watch};

/// What a minimisation starts from.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Origin {
    /// Nothing: the centre of the levels.
    Center,
    /// A guess of the contact.
    Contact(ContactGuess),
    /// The solution of an earlier query.
    Region(RegionFocus),
}

/// A guess of the contact.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactGuess {
    /// Guess of the contact normal, in the setting frame, of any length; `normal . d > 0`.
    pub(crate) normal: DVec3,
    /// The support points of P along it and of Q against it, as vertices.
    pub(crate) supports: [u32; 2],
    /// Guesses of the points of contact, in the frames of P and of Q.
    pub(crate) touching: [DVec3; 2],
}

/// The solution of an earlier query.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RegionFocus {
    /// The points of contact, in the frames of P and of Q.
    pub(crate) touching: [DVec3; 2],
    /// Half-side `delta` of the square around it that is searched first, in units of length.
    pub(crate) half_side: f64,
}

/// Choices of a minimisation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CtaOptions {
    /// Where to start.
    pub(crate) start: Origin,
    /// Planar problems at most (never more than [`MAX_STEPS`]).
    pub(crate) max_steps: u32,
    /// Stops when upper minus lower bound is at most this part of the extent of both bodies along
    /// the direction.
    pub(crate) gap: f64,
}

/// Planar problems after a guess: from there portal refinement is faster (measured).
const STEPS_AFTER_GUESS: u32 = 2;

impl CtaOptions {
    /// As many steps as pay off from a start.
    pub(crate) fn new(start: Origin, gap: f64) -> Self {
        let max_steps = match start {
            Origin::Contact(_) => STEPS_AFTER_GUESS,
            Origin::Center | Origin::Region(_) => MAX_STEPS,
        };
        Self { start, max_steps, gap }
    }
}

/// Where the search was narrowed to.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Guess {
    /// The bodies seem to meet: the contact normal `n`, not of unit length, with `n . d = 1`, in
    /// the setting frame.
    Contact { normal: DVec3 },
    /// The bodies seem never to meet: a direction from P to Q with `u . d = 0` up to rounding.
    Separation { direction: DVec3 },
    /// Nothing was learnt: rounding hides the sections of a nearly flat body.
    Nothing,
}

/// Two mesh edges of each body, as two pairs of vertices.
type Features = [[u32; 4]; 2];

/// The result of a minimisation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Narrowed {
    pub(crate) guess: Guess,
    /// The two mesh edges of each body nearest to the contact or the separating plane, as two pairs
    /// of vertices.
    pub(crate) vertices: Features,
    /// Least `phi` found, an upper bound of the collision translation in units of length; infinite
    /// without a contact.
    #[cfg_attr(
        not(test),
        expect(dead_code, reason = "the finish proves its own bounds; the tests compare")
    )]
    pub(crate) upper: f64,
    /// Lower bound, in units of length.
    #[cfg_attr(not(test), expect(dead_code, reason = "as `upper`"))]
    pub(crate) lower: f64,
}

impl Narrowed {
    /// No section could be found.
    fn nothing() -> Self {
        Self {
            guess: Guess::Nothing,
            vertices: Features::default(),
            upper: f64::INFINITY,
            lower: f64::NEG_INFINITY,
        }
    }
}

/// Narrows the search for the contact of two bodies of dimension 3.
pub(crate) fn minimise<O: Observer>(
    setting: &Setting,
    options: &CtaOptions,
    watch: &mut Watch<O>,
) -> Narrowed {
    let sections = SectionPair::new(setting);
    watch.sections(|| sections.told());
    watch.ended(Phase::Setup);
    let narrowed = sections.minimise(setting, options, watch);
    let inner = sections.sides.each_ref().map(|side| side.iterations.get());
    watch.steps.iterations += inner[0] + inner[1];
    narrowed
}

/// A setting in section coordinates.
pub(super) struct SectionPair<'a> {
    pub(super) sides: [Side<'a>; 2],
    frame: Frame,
    /// `t` at the origin of both levels and `h = 0`.
    constant: f64,
}

impl<'a> SectionPair<'a> {
    pub(super) fn new(setting: &Setting<'a>) -> Self {
        let d = setting.unit;
        let pair = AxisPair::choose(&setting.moving_matrix, &setting.fixed_matrix, d);
        let along = [pair.moving.1.dot(d), pair.fixed.1.dot(d)];
        let axes = [pair.moving.1 / along[0], pair.fixed.1 / along[1]];
        let c = axes[0] - axes[1];
        let frame = Frame { axes, along, shadow: [c, d.cross(c)] };
        let side = |body: &'a ConvexPolyhedron,
                    matrix: glam::DMat3,
                    axis: usize,
                    body_index: usize,
                    offset: DVec3| {
            let to_body = matrix.transpose();
            let shadow = frame.shadow.map(|covector| to_body * covector);
            let constant = DVec2::new(frame.shadow[0].dot(offset), frame.shadow[1].dot(offset));
            Side::new(
                (body.vertices(), body.topology(), body.sections().axis(axis)),
                along[body_index],
                shadow,
                constant,
            )
        };
        Self {
            sides: [
                side(setting.moving, setting.moving_matrix, pair.moving.0, 0, DVec3::ZERO),
                side(setting.fixed, setting.fixed_matrix, pair.fixed.0, 1, setting.offset),
            ],
            frame,
            // Q's levels are measured in its own frame.
            constant: axes[1].dot(setting.offset),
        }
    }

    /// For those who look on.
    fn told(&self) -> observe::Sections {
        let frame = &self.frame;
        observe::Sections {
            axes: [0, 1].map(|body| frame.axes[body] * frame.along[body]),
            ranges: [0, 1].map(|body| self.sides[body].range()),
        }
    }

    fn minimise<O: Observer>(
        &self,
        setting: &Setting,
        options: &CtaOptions,
        watch: &mut Watch<O>,
    ) -> Narrowed {
        let ranges = [self.sides[0].range(), self.sides[1].range()];
        let origin = DVec2::from_array(ranges.map(|r| f64::midpoint(r[0], r[1])));
        let half = DVec2::from_array(ranges.map(|r| 0.5 * (r[1] - r[0])));
        let extent =
            2.0 * (half.x / self.frame.along[0].abs() + half.y / self.frame.along[1].abs());
        let nothing = || {
            let base = self.frame.base(origin.to_array());
            let least = base + self.sides[0].least_height() - extent;
            Piece::constant(least, DVec3::ZERO)
        };
        let begin = match &options.start {
            Origin::Center => Begin { floor: nothing(), at: origin, near: None, square: None },
            Origin::Contact(guess) => self.begin(setting, guess),
            Origin::Region(focus) => {
                let at = self.inner_levels(focus.touching);
                let center = at - origin;
                let half = focus.half_side * AXIS_LENGTH;
                let square = Some(Square { center, half });
                Begin { floor: nothing(), at, near: None, square }
            }
        };
        let gap = options.gap * extent;
        let at = begin.at - origin;
        let levels = begin.at.to_array();
        let first = begin
            .near
            .and_then(|near| planar::solve_near(&self.sides, levels, &near))
            .or_else(|| planar::solve(&self.sides, levels, f64::NEG_INFINITY));
        watch.ended(Phase::Planar);
        let Some(first) = first else {
            watch.planar_problem(|| PlanarProblem::hidden(levels));
            return Narrowed::nothing();
        };
        let guessed = matches!(options.start, Origin::Contact(_));
        if guessed && let Some(confirmed) = self.confirm(&begin, &first, gap, watch) {
            return confirmed;
        }
        let searched = begin.square.map_or([-half, half], |square| square.within(half));
        let mut search = Minimisation {
            sections: self,
            origin,
            half,
            region: Region::rectangle(-half, half),
            square: begin.square,
            floor: begin.floor,
            bound: LowerBound::new(searched, begin.floor),
            upper: f64::INFINITY,
            best: None,
            last_separation: None,
            contradiction: None,
            watch,
            solved: 1,
            guessed,
        };
        if search.learn(at, levels, &first) {
            search.run(options.max_steps.min(MAX_STEPS), gap);
        }
        search.result()
    }

    /// The result if the first planar problem confirms the supporting plane that the search began
    /// with.
    fn confirm<O: Observer>(
        &self,
        begin: &Begin,
        first: &Planar,
        gap: f64,
        watch: &mut Watch<O>,
    ) -> Option<Narrowed> {
        let levels = begin.at.to_array();
        let cell = first.cell(levels)?;
        let bound = first.piece(&self.frame, levels).bound;
        let upper = bound.value + cell.least(bound.gradient);
        let lower = begin.floor.bound.value;
        (upper - lower <= gap).then(|| {
            watch.planar_problem(|| PlanarProblem {
                levels,
                value: bound.value + self.constant,
                meets: true,
                gradient: bound.gradient,
                shifted: upper + self.constant,
            });
            Narrowed {
                guess: Guess::Contact { normal: begin.floor.normal },
                vertices: first.features(),
                upper: upper + self.constant,
                lower: lower + self.constant,
            }
        })
    }

    /// From the supporting plane of a start, at the levels of its touching points.
    fn begin(&self, setting: &Setting, start: &ContactGuess) -> Begin {
        let normal = start.normal / start.normal.dot(setting.unit);
        let p = setting.moving_matrix * setting.moving.vertices()[start.supports[0] as usize];
        let q = setting.fixed_matrix * setting.fixed.vertices()[start.supports[1] as usize];
        let t = normal.dot(q + setting.offset - p) - self.constant;
        let at = self.inner_levels(start.touching);
        let levels = at.to_array();
        let normals = [setting.moving_normal(normal), setting.fixed_normal(normal)];
        let edge = |body: usize| {
            self.sides[body].edge_near(start.supports[body], normals[body], levels[body])
        };
        // In their sections P ends, and Q begins, towards what the normal has besides the axes.
        let in_section = normal - self.frame.axes[0];
        let right = usize::from(in_section.dot(self.frame.shadow[1]) > 0.0);
        let near = edge(0).zip(edge(1)).map(|(p, q)| Near { ups: [p, q], right });
        Begin { floor: Piece::constant(t, normal), at, near, square: None }
    }

    /// The levels of two points in the bodies' frames, or the nearest where a section has an area.
    fn inner_levels(&self, points: [DVec3; 2]) -> DVec2 {
        DVec2::from_array([0, 1].map(|body| {
            let [low, high] = self.sides[body].range();
            let margin = MARGIN * (high - low);
            self.sides[body].level_of(points[body]).clamp(low + margin, high - margin)
        }))
    }
}

/// What a minimisation begins with.
struct Begin {
    floor: Piece,
    /// The first levels.
    at: DVec2,
    /// A guess of the edges that cross there.
    near: Option<Near>,
    /// The levels to search first.
    square: Option<Square>,
}

/// The paper's neighbourhood `N(p)` of a solution `p`; levels are relative to `origin`.
#[derive(Debug, Clone, Copy)]
struct Square {
    center: DVec2,
    half: f64,
}

impl Square {
    /// Its part in the rectangle of all levels.
    fn within(&self, half: DVec2) -> [DVec2; 2] {
        [self.center - self.half, self.center + self.half].map(|corner| corner.clamp(-half, half))
    }

    /// The point `c*` where the way from `c` to the centre enters; `c` itself if that is inside.
    fn entry(&self, c: DVec2) -> DVec2 {
        let way = c - self.center;
        let farther = way.abs().max_element();
        if farther <= self.half { c } else { self.center + way * (self.half / farther) }
    }
}

/// A search does not start nearer to the ends of the levels than this share of their range: a
/// section has to have an area.
const MARGIN: f64 = 0.005;

/// The state of a minimisation; levels are relative to `origin`.
struct Minimisation<'q, 'a, 'o, O> {
    sections: &'q SectionPair<'a>,
    origin: DVec2,
    /// Half the extent of the levels.
    half: DVec2,
    region: Region,
    /// The levels searched first, until cuts leave nothing of them on the way to the centroid.
    square: Option<Square>,
    floor: Piece,
    /// Over the square while there is one, else over all levels.
    bound: LowerBound,
    upper: f64,
    /// Features of the best contact.
    best: Option<Features>,
    last_separation: Option<(Features, DVec3)>,
    contradiction: Option<DVec3>,
    watch: &'q mut Watch<'o, O>,
    /// Planar problems solved.
    solved: u32,
    /// Whether the search began with a supporting plane of the bodies.
    guessed: bool,
}

impl<O: Observer> Minimisation<'_, '_, '_, O> {
    /// One planar problem after the other, at the centroid of what is left or on the way there.
    fn run(&mut self, max_steps: u32, gap: f64) {
        while self.solved < max_steps && self.upper - self.bound.t > gap {
            let Some(at) = self.next() else { break };
            self.watch.ended(Phase::Region);
            let levels = (self.origin + at).to_array();
            let known = self.bound.below(at) - self.sections.frame.base(levels);
            self.solved += 1;
            self.watch.ended(Phase::Bound);
            let answer = planar::solve(&self.sections.sides, levels, known);
            self.watch.ended(Phase::Planar);
            let Some(answer) = answer else {
                self.watch.planar_problem(|| PlanarProblem::hidden(levels));
                break;
            };
            if !self.learn(at, levels, &answer) {
                break;
            }
        }
    }

    /// Where to cut next: at the centroid `c` if it is in the square; where the way to it leaves the
    /// square if that point, `c*`, is still in the region; else at `c`, and without the square from
    /// now on.
    fn next(&mut self) -> Option<DVec2> {
        let centroid = self.region.centroid()?;
        let Some(square) = self.square else { return Some(centroid) };
        let entry = square.entry(centroid);
        if self.region.contains(entry) {
            return Some(entry);
        }
        self.square = None;
        let narrow = self.bound.clone();
        self.bound = LowerBound::new([-self.half, self.half], self.floor);
        for piece in narrow.added() {
            self.bound.add(*piece);
        }
        Some(centroid)
    }

    /// Cuts the region and raises the bound; `false` if there is nothing more to learn.
    fn learn(&mut self, at: DVec2, levels: [f64; 2], answer: &Planar) -> bool {
        let local = answer.piece(&self.sections.frame, levels);
        let bound = Affine {
            value: local.bound.value - local.bound.gradient.dot(at),
            gradient: local.bound.gradient,
        };
        let mut limit = 0.0;
        let mut shifted = local.bound.value;
        if let Some(cell) = answer.cell(levels) {
            let least = local.bound.value + cell.least(bound.gradient);
            shifted = least;
            if least < self.upper {
                self.upper = least;
                self.best = Some(answer.features());
            }
            limit = self.upper;
        } else {
            self.last_separation = Some((answer.features(), local.normal));
        }
        self.watch.ended(Phase::Cell);
        let constant = self.sections.constant;
        self.watch.planar_problem(|| {
            let meets = !matches!(answer, Planar::Separated { .. });
            let base = if meets { constant } else { 0.0 };
            let [value, shifted] = [local.bound.value, shifted].map(|v| v + base);
            PlanarProblem { levels, value, meets, gradient: bound.gradient, shifted }
        });
        self.region.cut(bound.gradient, limit - bound.value);
        self.watch.ended(Phase::Region);
        let progress = self.bound.add(Piece { bound, ..local });
        self.watch.cut(|| Cut {
            origin: self.origin,
            gradient: bound.gradient,
            limit: limit - bound.value,
            lower: self.bound.t + constant,
            upper: self.upper + constant,
        });
        if let Progress::Contradiction(normal) = progress {
            self.contradiction = Some(normal);
            self.watch.ended(Phase::Bound);
            return false;
        }
        self.watch.ended(Phase::Bound);
        true
    }

    fn result(&self) -> Narrowed {
        let (guess, vertices) = match (self.best, self.last_separation) {
            (Some(best), _) => (Guess::Contact { normal: self.bound.normal() }, best),
            // Not all of the levels were searched, but every normal that the bounds combine is one
            // of a supporting plane.
            (None, Some((features, _))) if self.guessed && self.contradiction.is_none() => {
                (Guess::Contact { normal: self.bound.normal() }, features)
            }
            (None, Some((features, normal))) => {
                let direction = self.contradiction.unwrap_or(normal);
                (Guess::Separation { direction }, features)
            }
            (None, None) => (Guess::Nothing, Features::default()),
        };
        Narrowed {
            guess,
            vertices,
            upper: self.upper + self.sections.constant,
            lower: self.bound.t + self.sections.constant,
        }
    }
}

impl Planar {
    /// The two mesh edges of each body that the answer rests on.
    fn features(&self) -> Features {
        let pair = |p: &Crossing, q: &Crossing| {
            [p.vertices[0], p.vertices[1], q.vertices[0], q.vertices[1]]
        };
        match self {
            Self::Vertex { upper, vertex, left, .. } => {
                let (own, other) = (pair(vertex, vertex), pair(&left.low, &left.high));
                if *upper == 0 { [own, other] } else { [other, own] }
            }
            Self::Edges { edges, .. } => edges.each_ref().map(|edge| pair(&edge.low, &edge.high)),
            Self::Separated { supports, .. } => supports.each_ref().map(|s| pair(s, s)),
        }
    }
}
