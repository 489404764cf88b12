//! The loop of the minimisation (figure 7 of the paper): solve the planar problem at the centroid, shift to the
//! best point of the cell, end if this point solves the problem, else cut the region and repeat.
//!
//! The paper's shift ends in its cell. Here a shift can continue into neighbouring cells if the remaining
//! levels are a few edges wide and [`MinimisationOptions::keeps_to_cell`] is not set. The exit test names the faces to
//! which the contact passes on where `phi` falls, so that the neighbouring cell is known without a search. Its
//! best point is lower, therefore no cell is crossed twice.

use glam::{DVec2, DVec3};

use super::MAX_STEPS;
use super::bound::{BoundStatus, LowerBound};
use super::cell::{BestPoint, ContactCell};
use super::crossing::Crossing;
use super::exit::{Corners, Descent, ExitResult, ExitTest, HEIGHT_TOLERANCE, SolvedContact};
use super::options::Cuts;
use super::piece::{Affine, LinearPiece};
use super::planar::{self, PlanarAnswer, PlanarHint};
use super::region::{LevelRegion, Neighbourhood};
use super::section_pair::SectionPair;
use super::start::{LEVEL_MARGIN, MinimisationStart};
use crate::setting::Setting;
use crate::solve::observe::{Cut, Observer, Phase, PlanarProblem, SectionContact, Watch};

/// Extent of the remaining levels, in multiples of `SectionedBody::near_distance`, up to which a shift
/// continues into neighbouring cells (measured).
const NARROW_FACTOR: f64 = 8.0;
/// Maximum number of cells that a shift crosses before the next planar problem (measured).
const MAX_CELLS: u32 = 16;

/// Maximum number of planar problems at predicted levels (measured).
const MAX_PREDICTED: u32 = 8;
/// Maximum distance of predicted levels from the centre of the neighbourhood, in half-sides (measured).
const PREDICTED_REACH: f64 = 2.0;
/// Share of the way from the optimum of the lower bound to the centre of the neighbourhood at which the next planar
/// problem is solved (measured).
const OPTIMUM_SHARE: f64 = 0.3;
/// Distance of the next planar problem from separated levels, in multiples of that of the separating line (measured).
const BEYOND_LINE: f64 = 1.5;
/// Least distance of the next planar problem from separated levels, as a share of the half-side of the neighbourhood.
const LEAST_STEP: f64 = 0.05;
/// Distance of predicted levels from the middle, at most, as a share of half their range: the section needs an area.
const INNER_LEVELS: f64 = 1.0 - 2.0 * LEVEL_MARGIN;

/// Options of a minimisation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MinimisationOptions {
    /// First levels.
    pub(crate) start: MinimisationStart,
    /// Difference of the upper and the lower bound at which the minimisation ends, as a share of the extent of
    /// both bodies along the direction.
    pub(crate) gap: f64,
    /// Whether a shift ends in its cell.
    pub(crate) keeps_to_cell: bool,
    /// Level of `phi` at which the region is cut.
    pub(crate) cuts: Cuts,
    /// Whether planar problems start without a hint.
    pub(crate) starts_cold: bool,
}

/// Result of a minimisation.
#[derive(Debug, Clone, Copy)]
pub(crate) enum ContactGuess {
    /// The bodies seem to meet. The contact normal `n` is in the setting frame, with `n . d = 1` instead of
    /// length 1.
    Contact { normal: DVec3 },
    /// The bodies seem never to meet. The direction `u` leads from P to Q, with `u . d = 0` up to rounding.
    Separation { direction: DVec3 },
    /// No guess: rounding hides the sections of a nearly flat body.
    Nothing,
}

/// Two mesh edges of each body, as two pairs of vertices.
type FeatureVertices = [[u32; 4]; 2];

/// Result of a minimisation, with its bounds.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NarrowedSearch {
    pub(crate) guess: ContactGuess,
    /// The two mesh edges of each body nearest to the contact or to the separating plane.
    pub(crate) vertices: FeatureVertices,
    /// Part of the face of the Minkowski difference that contains the line, if the exit test ended the search.
    pub(crate) corners: Option<Corners>,
    /// Least `phi` found, a length: an upper bound of the collision translation. Infinite without a contact.
    #[cfg_attr(
        not(test),
        expect(dead_code, reason = "the finish proves its own bounds; the tests compare")
    )]
    pub(crate) upper: f64,
    /// Lower bound of the collision translation, a length.
    #[cfg_attr(not(test), expect(dead_code, reason = "as `upper`"))]
    pub(crate) lower: f64,
}

impl NarrowedSearch {
    /// Returns the result of a search for which no section was found.
    fn without_sections() -> Self {
        Self {
            guess: ContactGuess::Nothing,
            vertices: FeatureVertices::default(),
            corners: None,
            upper: f64::INFINITY,
            lower: f64::NEG_INFINITY,
        }
    }
}

/// Minimises `phi` for two bodies of dimension 3. Adds the iterations of the planar problems to `watch`.
pub(crate) fn minimise<O: Observer>(
    setting: &Setting,
    options: &MinimisationOptions,
    watch: &mut Watch<O>,
) -> NarrowedSearch {
    let sections = SectionPair::new(setting);
    watch.phase_ended(Phase::Setup);
    let narrowed = sections.minimise_phi(options, watch);
    let inner = sections.sides.each_ref().map(|side| side.iterations.get());
    watch.steps.iterations += inner[0] + inner[1];
    narrowed
}

impl SectionPair<'_> {
    /// Solves the first planar problem, and further ones unless it solves the problem.
    fn minimise_phi<O: Observer>(
        &self,
        options: &MinimisationOptions,
        watch: &mut Watch<O>,
    ) -> NarrowedSearch {
        let initial = self.initial_state(&options.start);
        watch.sections(|| self.observed_sections(initial.neighbourhood));
        let levels = initial.levels.to_array();
        let hint = if options.starts_cold { PlanarHint::NONE } else { initial.hint };
        let first = planar::solve_planar(&self.sides, levels, &hint);
        watch.phase_ended(Phase::Planar);
        let Some(first) = &first else {
            watch.planar_problem(|| PlanarProblem::hidden(levels));
            return match options.start {
                MinimisationStart::Center => NarrowedSearch::without_sections(),
                MinimisationStart::Region(_) => {
                    let center =
                        MinimisationOptions { start: MinimisationStart::Center, ..*options };
                    self.minimise_phi(&center, watch)
                }
            };
        };
        let gap = options.gap * self.extent;
        let mut search = Minimisation {
            sections: self,
            region: None,
            neighbourhood: initial.neighbourhood,
            keeps_to_cell: options.keeps_to_cell,
            cuts: options.cuts,
            starts_cold: options.starts_cold,
            floor: initial.floor,
            bound: None,
            upper: f64::INFINITY,
            best: None,
            solved: None,
            last_separation: None,
            contradiction: None,
            last: (levels, *first),
            watch,
            steps: 1,
            predicted: 0,
            ahead: None,
        };
        if search.apply_answer(initial.levels - self.origin, levels, first) {
            search.solve_planar_problems(gap);
        }
        search.narrowed_search()
    }
}

/// State of a minimisation. Levels are relative to the middle of all levels.
struct Minimisation<'q, 'a, 'o, O> {
    sections: &'q SectionPair<'a>,
    /// Levels that remain. `None` before the first cut: all levels.
    region: Option<LevelRegion>,
    /// Levels that are searched first. They are dropped when the segment from their centre to the centroid of the
    /// region leaves them outside the region (`next_cut_point`).
    neighbourhood: Option<Neighbourhood>,
    keeps_to_cell: bool,
    cuts: Cuts,
    starts_cold: bool,
    /// Lower bound over all levels. `None` before the first cut, because a query that ends in its first step
    /// does not need it.
    bound: Option<LowerBound>,
    /// First piece of the lower bound.
    floor: LinearPiece,
    /// Least `phi` found, without the constant of the section pair.
    upper: f64,
    /// Features of the best contact.
    best: Option<FeatureVertices>,
    /// Contact that the exit test has proven.
    solved: Option<SolvedContact>,
    /// Features and normal of the last separated sections.
    last_separation: Option<(FeatureVertices, DVec3)>,
    /// Normal of the contradiction that ended the search.
    contradiction: Option<DVec3>,
    /// Levels and answer of the last planar problem.
    last: ([f64; 2], PlanarAnswer),
    watch: &'q mut Watch<'o, O>,
    /// Number of planar problems solved.
    steps: u32,
    /// Number of planar problems solved at predicted levels.
    predicted: u32,
    /// Levels predicted by the last answer: across the line that separates the sections, or where a shift could not
    /// enter the next cell.
    ahead: Option<DVec2>,
}

impl SectionPair<'_> {
    /// Returns the corners of a cell around `levels`, for an observer.
    fn cell_corners(&self, cell: &ContactCell, levels: [f64; 2]) -> Vec<DVec2> {
        let at = DVec2::from_array(levels);
        let low = self.origin - self.half - at;
        let mut shape = LevelRegion::from_rectangle(low, low + 2.0 * self.half);
        for side in cell.half_planes() {
            shape.cut_by(-side.gradient, side.value);
        }
        shape.corners().iter().map(|&corner| at + corner).collect()
    }
}

impl<O: Observer> Minimisation<'_, '_, '_, O> {
    /// Solves planar problems until the bounds differ by at most `gap`, the search is over, or [`MAX_STEPS`]
    /// are solved.
    fn solve_planar_problems(&mut self, gap: f64) {
        while self.steps < MAX_STEPS && self.upper - self.lower_bound() > gap {
            let Some(at) = self.next_cut_point() else { break };
            self.watch.phase_ended(Phase::Region);
            let levels = (self.sections.origin + at).to_array();
            let below =
                self.bound.as_ref().map_or(f64::NEG_INFINITY, |bound| bound.lower_bound_at(at));
            let height = below - self.sections.frame.base_height(levels);
            self.steps += 1;
            self.watch.phase_ended(Phase::Bound);
            let sides = &self.sections.sides;
            let (at_last, last) = &self.last;
            let hint = if self.starts_cold {
                PlanarHint::NONE
            } else {
                last.hint_for_levels(*at_last, levels, height)
            };
            let answer = planar::solve_planar(sides, levels, &hint);
            self.watch.phase_ended(Phase::Planar);
            let Some(answer) = &answer else {
                self.watch.planar_problem(|| PlanarProblem::hidden(levels));
                // Elsewhere, the sections may be longer than rounding errors.
                if self.neighbourhood.take().is_some() {
                    continue;
                }
                break;
            };
            self.last = (levels, *answer);
            if !self.apply_answer(at, levels, answer) {
                break;
            }
        }
    }

    /// Returns the lower bound that all pieces prove, or the value of the floor before the first cut.
    fn lower_bound(&self) -> f64 {
        self.bound.as_ref().map_or(self.floor.bound.value, |bound| bound.least_t)
    }

    /// Returns the normal that proves the lower bound; zero before the first cut.
    fn lower_bound_normal(&self) -> DVec3 {
        self.bound.as_ref().map_or(DVec3::ZERO, LowerBound::proven_normal)
    }

    /// Returns the next levels to cut at (the paper, figure 10): the centroid `c` if it is in the
    /// neighbourhood; the point `c*` where the way from the neighbourhood's centre to `c` leaves it, if `c*` is
    /// in the region; else `c`, from then on without the neighbourhood. `None` if the region has no area.
    ///
    /// If shifts do not end in their cells, predicted levels near the neighbourhood come first.
    fn next_cut_point(&mut self) -> Option<DVec2> {
        let centroid = self.region.as_ref()?.centroid()?;
        let Some(neighbourhood) = self.neighbourhood else { return Some(centroid) };
        if !self.keeps_to_cell
            && self.predicted < MAX_PREDICTED
            && let Some(at) = self.predicted_levels(&neighbourhood)
        {
            self.predicted += 1;
            return Some(at);
        }
        let entry = neighbourhood.entry_point(centroid);
        if self.region_contains(entry) {
            return Some(entry);
        }
        self.neighbourhood = None;
        Some(centroid)
    }

    /// Returns levels near the neighbourhood at which the solution probably is: those that the last answer predicts,
    /// else the optimum of the lower bound, moved towards the centre of the neighbourhood. `None` if they are too far
    /// from it or no longer in the region.
    fn predicted_levels(&mut self, neighbourhood: &Neighbourhood) -> Option<DVec2> {
        let center = neighbourhood.center;
        let at = match (self.ahead.take(), &self.bound) {
            (Some(ahead), _) => ahead,
            (None, Some(bound)) => bound.optimum.lerp(center, OPTIMUM_SHARE),
            (None, None) => return None,
        };
        let most = self.sections.half * INNER_LEVELS;
        let at = at.clamp(-most, most);
        let is_near = (at - center).abs().max_element() <= PREDICTED_REACH * neighbourhood.half;
        (is_near && self.region_contains(at)).then_some(at)
    }

    /// Checks whether the levels `at` remain after all cuts.
    fn region_contains(&self, at: DVec2) -> bool {
        self.region.as_ref().is_none_or(|region| region.contains(at))
    }

    /// Shifts to the best point of the answer's cell, cuts the region and raises the bound. Returns `false` if
    /// the search has ended: the exit test has solved the problem, or the pieces contradict each other.
    fn apply_answer(&mut self, at: DVec2, levels: [f64; 2], answer: &PlanarAnswer) -> bool {
        let local = answer.linear_piece(&self.sections.frame, levels);
        self.shift_to_best_point(levels, answer, &local);
        self.watch.phase_ended(Phase::Cell);
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
        if local.weight == 0.0 && self.upper.is_infinite() {
            let Affine { value, gradient } = local.bound;
            let half = self.neighbourhood.map_or(0.0, |neighbourhood| neighbourhood.half);
            // Sections that touch seem to be separated by a distance of zero.
            let least = LEAST_STEP * half / gradient.abs().element_sum();
            let step = (BEYOND_LINE * value / gradient.length_squared()).max(least);
            self.ahead = Some(at - gradient * step);
        }
        let half = self.sections.half;
        let region = self.region.get_or_insert_with(|| LevelRegion::from_rectangle(-half, half));
        region.cut_by(bound.gradient, limit - bound.value);
        let sides = &mut self.watch.steps.region_sides;
        *sides = region.side_count().max(*sides);
        self.watch.phase_ended(Phase::Region);
        let all = self.bound.get_or_insert_with(|| LowerBound::new([-half, half], self.floor));
        let progress = all.add_piece(LinearPiece { bound, ..local });
        let lower = all.least_t;
        let constant = self.sections.constant;
        self.watch.cut(|| Cut {
            origin: self.sections.origin,
            gradient: bound.gradient,
            limit: limit - bound.value,
            lower: lower + constant,
            upper: self.upper + constant,
        });
        self.watch.phase_ended(Phase::Bound);
        if let BoundStatus::Contradiction(normal) = progress {
            self.contradiction = Some(normal);
            return false;
        }
        true
    }

    /// Goes to the best point of the cell and tests it. If the remaining levels are narrow, continues from cell
    /// to cell while the exit test names the faces on which `phi` falls.
    fn shift_to_best_point(
        &mut self,
        levels: [f64; 2],
        answer: &PlanarAnswer,
        local: &LinearPiece,
    ) {
        let sides = &self.sections.sides;
        let mut cell = ContactCell::new();
        if !answer.add_contact_cell(sides, levels, &mut cell) {
            self.last_separation = Some((answer.feature_vertices(), local.normal));
            return self.report_planar_problem(levels, answer, local, &BestPoint::default());
        }
        let best = cell.best_point(local.bound.gradient);
        self.report_planar_problem(levels, answer, local, &best);
        self.watch.cell(|| self.sections.cell_corners(&cell, levels));
        let mut exit = self.test_improvement((levels, answer), local, (&cell, &best));
        let max_cells =
            if !self.keeps_to_cell && self.is_remainder_narrow() { MAX_CELLS } else { 0 };
        for _ in 0..max_cells {
            let ExitResult::Falls(descent) = exit else { break };
            let Some(next) = self.enter_next_cell(&descent) else {
                // At these levels the last problem was solved.
                let is_new = descent.levels != levels;
                self.ahead =
                    is_new.then(|| DVec2::from_array(descent.levels) - self.sections.origin);
                break;
            };
            exit = next;
        }
    }

    /// Checks whether the levels still to be searched are a few edges wide.
    fn is_remainder_narrow(&self) -> bool {
        let size = match self.neighbourhood {
            Some(neighbourhood) => DVec2::splat(2.0 * neighbourhood.half),
            None => {
                self.region.as_ref().map_or(2.0 * self.sections.half, LevelRegion::level_extent)
            }
        };
        let near = DVec2::from_array(self.sections.sides.each_ref().map(|side| side.near_distance));
        size.cmple(near * NARROW_FACTOR).all()
    }

    /// Goes from the boundary of a cell to the best point of its neighbour. Tries both faces of each named edge.
    /// `None` if the edges of the sections on no two of these faces cross there at the height of the best point found,
    /// or `phi` does not fall in their cells.
    fn enter_next_cell(&mut self, descent: &Descent) -> Option<ExitResult> {
        let twin = |body: usize| {
            let topology = self.sections.sides[body].topology;
            topology.half_edge(descent.edges[body]).twin
        };
        let [[p, q], [other_p, other_q]] = [descent.edges, [twin(0), twin(1)]];
        let pairs = [[p, q], [other_p, q], [p, other_q], [other_p, other_q]];
        pairs.into_iter().find_map(|faces| self.enter_cell_on_faces(descent.levels, faces))
    }

    /// Goes to the best point of the cell in which faces touch, given by half-edges. `None` as
    /// [`Self::enter_next_cell`].
    fn enter_cell_on_faces(&mut self, levels: [f64; 2], faces: [u32; 2]) -> Option<ExitResult> {
        let SectionPair { sides, frame, extent, .. } = self.sections;
        let tolerance = HEIGHT_TOLERANCE * extent;
        let answer = planar::solve_on_faces(sides, levels, faces, tolerance)?;
        let local = answer.linear_piece(frame, levels);
        let is_there = (local.bound.value - self.upper).abs() <= tolerance;
        if !is_there {
            return None;
        }
        let mut cell = ContactCell::new();
        if !answer.add_contact_cell(sides, levels, &mut cell) {
            return None;
        }
        let best = cell.best_point(local.bound.gradient);
        if local.bound.value + best.change >= self.upper {
            return None;
        }
        self.last = (levels, answer);
        Some(self.test_improvement((levels, &answer), &local, (&cell, &best)))
    }

    /// Runs the exit test at the best point of a cell, and stores it, if it is lower than all before. Returns
    /// [`ExitResult::Missed`] otherwise.
    fn test_improvement(
        &mut self,
        (levels, answer): ([f64; 2], &PlanarAnswer),
        local: &LinearPiece,
        (cell, best): (&ContactCell, &BestPoint),
    ) -> ExitResult {
        let SectionPair { sides, setting, extent, constant, .. } = self.sections;
        let least = local.bound.value + best.change;
        if least.is_nan() || least >= self.upper {
            return ExitResult::Missed;
        }
        self.upper = least;
        self.best = Some(answer.feature_vertices());
        let test = ExitTest { sides, setting, extent: *extent };
        let at = (DVec2::from_array(levels) + best.offset).to_array();
        let exit = test.test_best_point(answer, (at, &cell.changes_at(best)), least + constant);
        if let ExitResult::Solved(solved) = exit {
            self.solved = Some(solved);
        }
        let hit = self.solved.is_some();
        self.watch.exit_test(|| hit);
        exit
    }

    fn report_planar_problem(
        &mut self,
        levels: [f64; 2],
        answer: &PlanarAnswer,
        local: &LinearPiece,
        best: &BestPoint,
    ) {
        let constant = self.sections.constant;
        self.watch.planar_problem(|| {
            let touch = answer.touch_kind();
            // The separating direction has any length. A distance needs length 1.
            let (unit, constant) = match answer {
                PlanarAnswer::Separated { u, .. } => (1.0 / u.length(), 0.0),
                _ => (1.0, constant),
            };
            let value = local.bound.value * unit + constant;
            PlanarProblem {
                levels,
                value,
                touch,
                gradient: local.bound.gradient * unit,
                best: (DVec2::from_array(levels) + best.offset).to_array(),
                shifted: value + best.change,
            }
        });
    }

    fn narrowed_search(&self) -> NarrowedSearch {
        let constant = self.sections.constant;
        let upper = self.upper + constant;
        if let Some(SolvedContact { normal, vertices, corners }) = self.solved {
            let guess = ContactGuess::Contact { normal };
            return NarrowedSearch { guess, vertices, corners, upper, lower: upper };
        }
        let (guess, vertices) = match (self.best, self.last_separation) {
            (Some(best), _) => (ContactGuess::Contact { normal: self.lower_bound_normal() }, best),
            (None, Some((features, normal))) => {
                let direction = self.contradiction.unwrap_or(normal);
                (ContactGuess::Separation { direction }, features)
            }
            (None, None) => (ContactGuess::Nothing, FeatureVertices::default()),
        };
        let lower = self.lower_bound() + constant;
        NarrowedSearch { guess, vertices, corners: None, upper, lower }
    }
}

impl PlanarAnswer {
    fn touch_kind(&self) -> SectionContact {
        match self {
            Self::Edges { .. } => SectionContact::Edges,
            Self::Vertex { .. } => SectionContact::Vertex,
            Self::Separated { .. } => SectionContact::Separated,
        }
    }

    /// Returns the two mesh edges of each body that determine the answer.
    fn feature_vertices(&self) -> FeatureVertices {
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
