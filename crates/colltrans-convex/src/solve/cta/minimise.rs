//! The minimisation: solve the planar problem at the centroid, shift to the cell's best point, end
//! if that solves the problem, else cut and repeat.
//!
//! The paper's shift ends in its cell. Here, where a few edges' width of levels is left, it goes on:
//! the exit test names the faces to which the contact passes on where `phi` falls, so the neighbouring
//! cell is known without a search. Its best point is below, so no cell is crossed twice.

use glam::{DVec2, DVec3};

use super::MAX_STEPS;
use super::bound::{LowerBound, Progress};
use super::cell::{Best, Cell};
use super::crossing::Crossing;
use super::exit::{Beyond, Corners, Exit, ExitTest, SAME_HEIGHT, Solved};
use super::options::Cuts;
use super::piece::{Affine, Piece};
use super::planar::{self, Hint, Planar};
use super::region::{Region, Square};
use super::section_pair::SectionPair;
use super::start::Origin;
use crate::setting::Setting;
use crate::solve::observe::{Cut, Observer, Phase, PlanarProblem, Touch, Watch};

/// Levels to search that are together at most so many times as wide as near ones are apart are
/// crossed from cell to cell: at most so many cells before the next planar problem (both measured).
const NARROW: f64 = 8.0;
const MOST_CELLS: u32 = 16;

/// Choices of a minimisation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CtaOptions {
    /// Where to start.
    pub(crate) start: Origin,
    /// Stops when upper minus lower bound is at most this part of the extent of both bodies along
    /// the direction.
    pub(crate) gap: f64,
    /// The shift ends in its cell.
    pub(crate) keeps_to_cell: bool,
    /// Where cuts go.
    pub(crate) cuts: Cuts,
    /// Planar problems begin with nothing.
    pub(crate) starts_cold: bool,
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
    /// The face of the difference that the line passes, if the exit test ended the search.
    pub(crate) corners: Option<Corners>,
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
            corners: None,
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
    watch.ended(Phase::Setup);
    let narrowed = sections.minimise(options, watch);
    let inner = sections.sides.each_ref().map(|side| side.iterations.get());
    watch.steps.iterations += inner[0] + inner[1];
    narrowed
}

impl SectionPair<'_> {
    fn minimise<O: Observer>(&self, options: &CtaOptions, watch: &mut Watch<O>) -> Narrowed {
        let begin = self.begin(&options.start);
        watch.sections(|| self.told(begin.square));
        let levels = begin.at.to_array();
        let hint = if options.starts_cold { Hint::NONE } else { begin.hint };
        let first = planar::solve(&self.sides, levels, &hint);
        watch.ended(Phase::Planar);
        let Some(first) = first else {
            watch.planar_problem(|| PlanarProblem::hidden(levels));
            return Narrowed::nothing();
        };
        let gap = options.gap * self.extent;
        let mut search = Minimisation {
            sections: self,
            region: Region::rectangle(-self.half, self.half),
            square: begin.square,
            keeps_to_cell: options.keeps_to_cell,
            cuts: options.cuts,
            starts_cold: options.starts_cold,
            floor: begin.floor,
            bound: None,
            upper: f64::INFINITY,
            best: None,
            solved: None,
            last_separation: None,
            contradiction: None,
            last: (levels, first),
            watch,
            steps: 1,
        };
        if search.learn(begin.at - self.origin, levels, &first) {
            search.run(gap);
        }
        search.result()
    }
}

/// The state of a minimisation; levels are relative to the middle of all.
struct Minimisation<'q, 'a, 'o, O> {
    sections: &'q SectionPair<'a>,
    region: Region,
    /// The levels searched first, until cuts leave nothing of them on the way to the centroid.
    square: Option<Square>,
    keeps_to_cell: bool,
    cuts: Cuts,
    starts_cold: bool,
    /// Over all levels; nothing before the first cut: a query that ends in its first step does without.
    bound: Option<LowerBound>,
    /// What it begins with.
    floor: Piece,
    upper: f64,
    /// Features of the best contact.
    best: Option<Features>,
    /// What the exit test found.
    solved: Option<Solved>,
    last_separation: Option<(Features, DVec3)>,
    contradiction: Option<DVec3>,
    /// The last planar problem: its levels and answer.
    last: ([f64; 2], Planar),
    watch: &'q mut Watch<'o, O>,
    /// Planar problems solved.
    steps: u32,
}

impl SectionPair<'_> {
    /// The corners of a cell around these levels, for those who look on.
    fn corners(&self, cell: &Cell, levels: [f64; 2]) -> Vec<DVec2> {
        let at = DVec2::from_array(levels);
        let low = self.origin - self.half - at;
        let mut shape = Region::rectangle(low, low + 2.0 * self.half);
        for side in cell.half_planes() {
            shape.cut(-side.gradient, side.value);
        }
        shape.corners().iter().map(|&corner| at + corner).collect()
    }
}

impl<O: Observer> Minimisation<'_, '_, '_, O> {
    /// One planar problem after the other, at the centroid of what is left or on the way there.
    fn run(&mut self, gap: f64) {
        while self.steps < MAX_STEPS && self.upper - self.lower() > gap {
            let Some(at) = self.next() else { break };
            self.watch.ended(Phase::Region);
            let levels = (self.sections.origin + at).to_array();
            let below = self.bound.as_ref().map_or(f64::NEG_INFINITY, |bound| bound.below(at));
            let height = below - self.sections.frame.base(levels);
            self.steps += 1;
            self.watch.ended(Phase::Bound);
            let sides = &self.sections.sides;
            let (at_last, last) = &self.last;
            let hint =
                if self.starts_cold { Hint::NONE } else { last.hint(*at_last, levels, height) };
            let answer = planar::solve(sides, levels, &hint);
            self.watch.ended(Phase::Planar);
            let Some(answer) = answer else {
                self.watch.planar_problem(|| PlanarProblem::hidden(levels));
                break;
            };
            self.last = (levels, answer);
            if !self.learn(at, levels, &answer) {
                break;
            }
        }
    }

    /// What all pieces prove.
    fn lower(&self) -> f64 {
        self.bound.as_ref().map_or(self.floor.bound.value, |bound| bound.t)
    }

    /// The normal that proves it.
    fn normal(&self) -> DVec3 {
        self.bound.as_ref().map_or(DVec3::ZERO, LowerBound::normal)
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
        Some(centroid)
    }

    /// Cuts the region and raises the bound; `false` if there is nothing more to learn.
    fn learn(&mut self, at: DVec2, levels: [f64; 2], answer: &Planar) -> bool {
        let local = answer.piece(&self.sections.frame, levels);
        self.shift(levels, answer, &local);
        self.watch.ended(Phase::Cell);
        if self.solved.is_some() {
            return false;
        }
        let bound = Affine {
            value: local.bound.value - local.bound.gradient.dot(at),
            gradient: local.bound.gradient,
        };
        let limit = match self.cuts {
            _ if local.weight == 0.0 => 0.0,
            Cuts::Shifted => self.upper,
            Cuts::Centroid => local.bound.value,
        };
        self.region.cut(bound.gradient, limit - bound.value);
        let sides = &mut self.watch.steps.region_sides;
        *sides = self.region.sides().max(*sides);
        self.watch.ended(Phase::Region);
        let half = self.sections.half;
        let all = self.bound.get_or_insert_with(|| LowerBound::new([-half, half], self.floor));
        let progress = all.add(Piece { bound, ..local });
        let lower = all.t;
        let constant = self.sections.constant;
        self.watch.cut(|| Cut {
            origin: self.sections.origin,
            gradient: bound.gradient,
            limit: limit - bound.value,
            lower: lower + constant,
            upper: self.upper + constant,
        });
        self.watch.ended(Phase::Bound);
        if let Progress::Contradiction(normal) = progress {
            self.contradiction = Some(normal);
            return false;
        }
        true
    }

    /// Goes to the best point of the cell, and looks whether it solves the problem. Where little is left
    /// to search, it goes on from cell to cell while the exit test tells where `phi` falls.
    fn shift(&mut self, levels: [f64; 2], answer: &Planar, local: &Piece) {
        let sides = &self.sections.sides;
        let Some(cell) = answer.cell(sides, levels) else {
            self.last_separation = Some((answer.features(), local.normal));
            return self.report(levels, answer, local, &Best::default());
        };
        let best = cell.best(local.bound.gradient);
        self.report(levels, answer, local, &best);
        self.watch.cell(|| self.sections.corners(&cell, levels));
        let mut exit = self.improve((levels, answer), local, (&cell, &best));
        let most = if !self.keeps_to_cell && self.is_narrow() { MOST_CELLS } else { 0 };
        for _ in 0..most {
            let Exit::Falls(beyond) = exit else { break };
            let Some(next) = self.cross(&beyond) else { break };
            exit = next;
        }
    }

    /// Whether the levels to search are a few edges wide.
    fn is_narrow(&self) -> bool {
        let size = match self.square {
            Some(square) => DVec2::splat(2.0 * square.half),
            None => self.region.size(),
        };
        let near = DVec2::from_array(self.sections.sides.each_ref().map(|side| side.near));
        size.cmple(near * NARROW).all()
    }

    /// Crosses a cell from its rim, where the best point of its neighbour is; `None` if the sections
    /// do not meet there as told.
    fn cross(&mut self, beyond: &Beyond) -> Option<Exit> {
        let SectionPair { sides, frame, extent, .. } = self.sections;
        let answer = planar::on_faces(sides, beyond.levels, beyond.faces)?;
        let local = answer.piece(frame, beyond.levels);
        let is_there = (local.bound.value - self.upper).abs() <= SAME_HEIGHT * extent;
        if !is_there {
            return None;
        }
        let cell = answer.cell(sides, beyond.levels)?;
        let best = cell.best(local.bound.gradient);
        Some(self.improve((beyond.levels, &answer), &local, (&cell, &best)))
    }

    /// What the exit test says at the best point of the cell of a contact, if it is the least so far.
    fn improve(
        &mut self,
        (levels, answer): ([f64; 2], &Planar),
        local: &Piece,
        (cell, best): (&Cell, &Best),
    ) -> Exit {
        let SectionPair { sides, setting, extent, constant, .. } = self.sections;
        let least = local.bound.value + best.change;
        if least.is_nan() || least >= self.upper {
            return Exit::Missed;
        }
        self.upper = least;
        self.best = Some(answer.features());
        let test = ExitTest { sides, setting, extent: *extent };
        let at = (DVec2::from_array(levels) + best.at).to_array();
        let exit = test.solves(answer, (at, &cell.ends_at(best)), least + constant);
        if let Exit::Solved(solved) = exit {
            self.solved = Some(solved);
        }
        let hit = self.solved.is_some();
        self.watch.exit_test(|| hit);
        exit
    }

    fn report(&mut self, levels: [f64; 2], answer: &Planar, local: &Piece, best: &Best) {
        let constant = self.sections.constant;
        self.watch.planar_problem(|| {
            let touch = answer.touch();
            // Lines between sections are of any length: a distance needs its unit.
            let (unit, constant) = match answer {
                Planar::Separated { u, .. } => (1.0 / u.length(), 0.0),
                _ => (1.0, constant),
            };
            let value = local.bound.value * unit + constant;
            PlanarProblem {
                levels,
                value,
                touch,
                gradient: local.bound.gradient * unit,
                best: (DVec2::from_array(levels) + best.at).to_array(),
                shifted: value + best.change,
            }
        });
    }

    fn result(&self) -> Narrowed {
        let constant = self.sections.constant;
        let upper = self.upper + constant;
        if let Some(Solved { normal, vertices, corners }) = self.solved {
            let guess = Guess::Contact { normal };
            return Narrowed { guess, vertices, corners, upper, lower: upper };
        }
        let (guess, vertices) = match (self.best, self.last_separation) {
            (Some(best), _) => (Guess::Contact { normal: self.normal() }, best),
            (None, Some((features, normal))) => {
                let direction = self.contradiction.unwrap_or(normal);
                (Guess::Separation { direction }, features)
            }
            (None, None) => (Guess::Nothing, Features::default()),
        };
        let lower = self.lower() + constant;
        Narrowed { guess, vertices, corners: None, upper, lower }
    }
}

impl Planar {
    fn touch(&self) -> Touch {
        match self {
            Self::Edges { .. } => Touch::Edges,
            Self::Vertex { .. } => Touch::Vertex,
            Self::Separated { .. } => Touch::Separated,
        }
    }

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
