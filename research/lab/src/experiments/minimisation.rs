//! Section III: the effect of a step of the minimisation. Measures the remaining share of the region and its number
//! of sides, whether the new solution is in the neighbourhood of the last one, and the savings of shifted cut lines.
//!
//! The earlier method of the same authors (reference 3 of the paper) cuts through the centroid of the remaining region
//! and searches rectangles of a grid. The paper searches the cells of the *mark*, in each of which the same features
//! touch. Here only the cuts of the earlier method are used ([`colltrans::cta::Cuts::Centroid`]). A search ends, like
//! the paper's, where the best point of a cell solves the problem.

use colltrans::observe::{Cut, Observer, PlanarProblem, SectionContact, Sections};
use colltrans::{Outcome, cta};
use glam::DVec2;

use super::{
    Gathered, against_size, grouped_digits, in_passes, listed_values, new_axis, new_series,
};
use crate::Experiment;
use crate::claims::{Claim, Reason, judged};
use crate::figures::below;
use crate::finding::{Figure, Finding, Point, Table};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::{Bodies, Kind, bodies};
use crate::solvers::{Algorithm, Tracked, Until, centroid_cuts};
use crate::statistics::{Group, Sample, estimate, mean, short};
use colltrans_testkit::random::Random;
use colltrans_testkit::timing::quantile;

pub(super) const SECTION_3: Experiment = Experiment {
    id: "section-3",
    title: "cuts, sides, the neighbourhood of the last solution, and the method before",
    seconds: [5.0, 20.0],
    run,
};

/// Changes from one configuration to the next, in diameters.
const CHANGES: [f64; 5] = [0.001_25, 0.002_5, 0.005, 0.01, 0.02];

/// Observations at one size.
#[derive(Default)]
struct Seen {
    vertices: Vec<f64>,
    /// Of each cut: the share of the area that is left.
    left: Vec<(Group, f64)>,
    /// Of each query: sides of the region at most, planar problems, and those with cuts through the centroid.
    sides: Vec<(Group, f64)>,
    steps: Vec<(Group, f64)>,
    unshifted: Vec<(Group, f64)>,
    /// Of each query, vertex contacts: the paper's `O(log n)` shifts.
    vertex_contacts: Vec<(Group, f64)>,
    /// By change, of each query from the last solution: whether the new one is in `N(p)`.
    inside: [Vec<(Group, f64)>; CHANGES.len()],
}

impl Gathered for Seen {
    fn gather(&mut self, more: Self) {
        self.vertices.extend(more.vertices);
        self.left.extend(more.left);
        self.sides.extend(more.sides);
        self.steps.extend(more.steps);
        self.unshifted.extend(more.unshifted);
        self.vertex_contacts.extend(more.vertex_contacts);
        self.inside.iter_mut().zip(more.inside).for_each(|(all, more)| all.extend(more));
    }
}

/// Looks on at one minimisation.
#[derive(Default)]
struct Watcher {
    region: Vec<DVec2>,
    left: Vec<f64>,
    neighbourhood: Option<(DVec2, f64)>,
    last: Option<PlanarProblem>,
    is_solved: bool,
    vertex_contacts: u32,
}

impl Observer for Watcher {
    fn sections(&mut self, sections: impl FnOnce() -> Sections) {
        let Sections { ranges: [[a, b], [c, d]], neighbourhood, .. } = sections();
        self.region = [[a, c], [b, c], [b, d], [a, d]].map(DVec2::from_array).to_vec();
        self.neighbourhood = neighbourhood;
    }

    fn planar_problem(&mut self, problem: impl FnOnce() -> PlanarProblem) {
        let problem = problem();
        self.vertex_contacts += u32::from(problem.touch == SectionContact::Vertex);
        self.last = Some(problem);
    }

    fn exit_test(&mut self, solved: impl FnOnce() -> bool) {
        self.is_solved = solved();
    }

    fn cut(&mut self, cut: impl FnOnce() -> Cut) {
        let Cut { origin, gradient, limit, .. } = cut();
        let rest = below(&self.region, gradient, gradient.dot(origin) + limit);
        let [before, after] = [&self.region, &rest].map(|polygon| double_area(polygon));
        if before > 0.0 {
            self.left.push(after / before);
        }
        self.region = rest;
    }
}

impl Watcher {
    /// Checks whether the solution is in the neighbourhood of the last one; `None` if either is unknown.
    fn is_inside(&self) -> Option<bool> {
        let (center, half) = self.neighbourhood?;
        let problem = self.last.filter(|_| self.is_solved)?;
        let away = (DVec2::from_array(problem.best) - center).abs().max_element();
        Some(away <= half)
    }
}

/// Returns twice the area of a convex polygon, which suffices for ratios.
fn double_area(polygon: &[DVec2]) -> f64 {
    let Some((&first, rest)) = polygon.split_first() else { return 0.0 };
    rest.windows(2).map(|pair| (pair[0] - first).perp_dot(pair[1] - first)).sum()
}

fn run(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let told = |&n: &usize| (n, format!("{} vertices", grouped_digits(n as f64)));
    let seen =
        in_passes(plan, progress, plan.sizes(), told, |&n, pass| observe_pass(plan, n, pass));
    let claims = vec![
        area_claim(&seen),
        sides_claim(&seen),
        neighbourhood_claim(&seen),
        fewer_steps(&seen),
        fewer_calls(&seen),
    ];
    Finding { figures: vec![steps_figure(&seen)], tables: vec![observations_table(&seen)], claims }
}

/// Observes the queries of a pass at one size.
fn observe_pass(plan: &Plan, n: usize, pass: u32) -> Seen {
    let bodies = bodies(plan.seed, Kind::Balanced, n, u64::from(pass));
    let mut random = Random::stream(plan.seed, &[3, n as u64, u64::from(pass)]);
    let mut seen = Seen { vertices: vec![bodies.vertices()], ..Seen::default() };
    let count = plan.by_scale(20, 150, 200);
    for number in 0..count {
        let group = Group { pass, number };
        let setting = Setting::draw(&bodies, Meeting::Colliding, &mut random);
        observe_query(&bodies, &setting, group, &mut seen);
    }
    let mut tracked = Tracked::in_region(&bodies, cta::Region::Automatic, Until::End.options());
    for (change, found) in CHANGES.iter().zip(&mut seen.inside) {
        for number in 0..count / 2 {
            let pair = Setting::sequence(&bodies, Meeting::Colliding, *change, 2, &mut random);
            tracked.forget();
            let mut watchers = [Watcher::default(), Watcher::default()];
            for (setting, watcher) in pair.iter().zip(&mut watchers) {
                let _ = tracked.watched(setting, watcher);
            }
            let is_inside = watchers[1].is_inside();
            found.extend(is_inside.map(|is| (Group { pass, number }, f64::from(u8::from(is)))));
        }
    }
    seen
}

/// Observes one query from scratch, with both kinds of cuts.
fn observe_query(bodies: &Bodies, setting: &Setting, group: Group, seen: &mut Seen) {
    let mut watcher = Watcher::default();
    let ask = |options, watcher: &mut Watcher| {
        let cast = setting.cast(bodies, &options);
        cast.and_then(|cast| cast.first_contact_observed(watcher))
    };
    let shifted = ask(Until::End.options(), &mut watcher);
    let unshifted = ask(centroid_cuts(), &mut Watcher::default());
    let (Ok(Outcome::Contact(one)), Ok(Outcome::Contact(other))) = (shifted, unshifted) else {
        return;
    };
    seen.left.extend(watcher.left.iter().map(|share| (group, *share)));
    if one.steps.region_sides > 0 {
        seen.sides.push((group, f64::from(one.steps.region_sides)));
    }
    seen.steps.push((group, f64::from(one.steps.planar_problems)));
    seen.unshifted.push((group, f64::from(other.steps.planar_problems)));
    seen.vertex_contacts.push((group, f64::from(watcher.vertex_contacts)));
}

/// Creates a sample.
fn group_sample(values: &[(Group, f64)]) -> Sample {
    Sample::of(values.iter().copied())
}

/// Returns the observations of one kind, by size.
fn samples_by_size(seen: &[Seen], of: impl Fn(&Seen) -> &[(Group, f64)]) -> Vec<Sample> {
    seen.iter().map(|at| group_sample(of(at))).collect()
}

/// Returns means with quartiles, by size.
fn mean_points(seen: &[Seen], of: impl Fn(&Seen) -> &[(Group, f64)]) -> Vec<Point> {
    let point = |at: &Seen| Point::mean(mean(&at.vertices), &group_sample(of(at)).values());
    seen.iter().map(point).collect()
}

fn steps_figure(seen: &[Seen]) -> Figure {
    against_size(
        "section-3-cuts",
        "Minimisation steps with cuts shifted to the best point of the cell, and through the centroid",
        new_axis("steps", false),
        vec![
            new_series("shifted (CTA)", mean_points(seen, |at| &at.steps)),
            new_series("through the centroid", mean_points(seen, |at| &at.unshifted)),
        ],
    )
}

fn observations_table(seen: &[Seen]) -> Table {
    let columns = ["vertices", "left by a cut, %", "most sides, mean", "most sides, of all"]
        .map(String::from)
        .into_iter()
        .chain(CHANGES.map(|change| format!("inside N(p) at {} % D, %", 100.0 * change)));
    let row = |at: &Seen| {
        let sides = group_sample(&at.sides).values();
        let mut row = vec![
            grouped_digits(mean(&at.vertices)),
            short(100.0 * mean(&group_sample(&at.left).values())),
            short(mean(&sides)),
            format!("{}", sides.iter().copied().fold(0.0, f64::max)),
        ];
        row.extend(at.inside.iter().map(|one| short(100.0 * mean(&group_sample(one).values()))));
        row
    };
    Table {
        id: "section-3".into(),
        title: "Steps of the minimisation: bodies that collide, from the centre of the levels, and from N(p)"
            .into(),
        columns: columns.collect(),
        rows: seen.iter().map(row).collect(),
    }
}

fn area_claim(seen: &[Seen]) -> Claim {
    let measured =
        estimate(&samples_by_size(seen, |at| &at.left), |s| mean(&super::sample_means(s)));
    let by_size = listed_values(&mean_points(seen, |at| &at.left), 2);
    let details = format!("The mean over all sizes; by size {by_size}.");
    judged("3-half", vec![measured], details, || {
        Reason::Implementation.because(format!("Shares left by size: {by_size}."))
    })
}

fn sides_claim(seen: &[Seen]) -> Claim {
    let all = samples_by_size(seen, |at| &at.sides);
    let most = estimate(&all, |s| quantile(&s.concat(), 0.99));
    let average = estimate(&all, |s| mean(&s.concat()));
    let details = "Sides that the region had at most during a query. Up to 8 are taken as few.";
    judged("3-sides", vec![most, average], details.into(), || {
        let largest = all.iter().flat_map(Sample::values).fold(0.0, f64::max);
        Reason::Implementation.because(format!("There were up to {largest} sides."))
    })
}

fn neighbourhood_claim(seen: &[Seen]) -> Claim {
    let all: Vec<_> =
        seen.iter().flat_map(|at| at.inside.iter().map(|one| group_sample(one))).collect();
    let measured = estimate(&all, |s| 100.0 * mean(&super::sample_means(s)));
    let shares = all.iter().map(|one| 100.0 * mean(&one.values()));
    let [least, most] = [f64::min, f64::max].map(|f| shares.clone().reduce(f).unwrap_or(f64::NAN));
    let details = format!(
        "The mean over all sizes and changes; from {} to {} %. 75 % is taken as a high probability.",
        short(least),
        short(most)
    );
    judged("3-inside", vec![measured], details, || {
        Reason::Implementation.because(format!(
            "The share is from {} to {} % at the sizes and changes of the table: delta is how far the last points of \
             contact moved apart sideways, and on small bodies a contact goes over an edge into another face.",
            short(least),
            short(most)
        ))
    })
}

/// Estimates the mean over the sizes of a number of shifted and unshifted steps.
fn of_both(seen: &[Seen], number: impl Fn(f64, f64) -> f64) -> crate::statistics::Estimate {
    let all =
        [samples_by_size(seen, |at| &at.steps), samples_by_size(seen, |at| &at.unshifted)].concat();
    estimate(&all, |s| {
        let (shifted, unshifted) = s.split_at(s.len() / 2);
        let each = shifted.iter().zip(unshifted).map(|(a, b)| number(mean(a), mean(b)));
        mean(&each.collect::<Vec<_>>())
    })
}

fn both_by_size(seen: &[Seen]) -> String {
    format!(
        "Steps with shifted cuts {}, through the centroid {}",
        listed_values(&mean_points(seen, |at| &at.steps), 2),
        listed_values(&mean_points(seen, |at| &at.unshifted), 2)
    )
}

fn fewer_steps(seen: &[Seen]) -> Claim {
    let measured = of_both(seen, |shifted, unshifted| 100.0 * (1.0 - shifted / unshifted));
    let details = format!("{}.", both_by_size(seen));
    judged("3-steps", vec![measured], details, || {
        Reason::Sentence.because(format!(
            "The earlier method is another algorithm, with a grid in place of the cells, of which only the cuts are \
             described. {}: the rest of its steps is not of the cuts, as both searches here end where the best point of a \
             cell solves the problem.",
            both_by_size(seen)
        ))
    })
}

fn fewer_calls(seen: &[Seen]) -> Claim {
    let measured = of_both(seen, |shifted, unshifted| unshifted - shifted);
    let vertices = listed_values(&mean_points(seen, |at| &at.vertex_contacts), 2);
    let details = format!(
        "Counted are planar problems. {}. Vertex contacts, in which the paper's shift takes O(log n) and ours does not: \
         {vertices}.",
        both_by_size(seen)
    );
    judged("3-calls", vec![measured], details, || {
        Reason::Sentence.because(format!(
            "Of the calls of the earlier method those on pairs of a polygon and a drum, and of two drums, are not \
             described, nor how many there are. Of planar problems alone: {}.",
            both_by_size(seen)
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_left_by_cuts() {
        let mut watcher = Watcher::default();
        watcher.sections(|| Sections {
            axes: [glam::DVec3::X; 2],
            ranges: [[0.0, 4.0], [1.0, 2.0]],
            neighbourhood: None,
        });
        let cut = |limit| Cut {
            origin: DVec2::new(2.0, 1.5),
            gradient: DVec2::X,
            limit,
            lower: 0.0,
            upper: 1.0,
        };
        watcher.cut(|| cut(1.0));
        watcher.cut(|| cut(-0.5));
        assert_eq!(watcher.left, [0.75, 0.5]);
    }
}
