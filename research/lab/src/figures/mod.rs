//! Figures 1 to 6 and 8 to 10 of the paper, reproduced with two cubes: the steps of the algorithm as reported
//! to an observer. Figure 7 is the pseudocode ([line by line](../../../docs/paper.md)).
//!
//! Modules: `setting` (cubes, and a run of the algorithm), `planar` (two sections and their contact by brute
//! force), `mark` (all cells), `levels` and `instances` (pictures) on a `sheet`. `literal` counts the steps of the
//! pseudocode with the paper's cuts and cells, also for other bodies.

mod instances;
mod levels;
pub(crate) mod literal;
mod mark;
mod planar;
mod setting;
mod sheet;
#[cfg(test)]
mod tests;

use std::path::Path;

use colltrans::observe::SectionContact;
use glam::DVec2;

use crate::LabError;
use mark::Mark;
use planar::{Instance, View};
pub use setting::Error;
pub(crate) use setting::below;
use setting::{Run, Setting, middle};

/// Position of the moving cube; the fixed one is at the origin.
const AT: [f64; 3] = [-1.1, 1.0, 5.0];
/// Orientation of the moving cube.
const TURN: [f64; 4] = [-0.7, -0.3, 0.2, 0.7];
/// Direction of motion.
const TOWARDS: [f64; 3] = [0.42, -0.3, -1.0];
/// Position of the moving cube of figure 10, in which the search leaves the neighbourhood of the last
/// solution.
const AFTER: [f64; 3] = [-1.4, 1.6, 5.0];
/// Previous position of the moving cube of figure 10.
const BEFORE: [f64; 3] = [-1.6, 2.2, 5.0];
/// Orientation of the moving cube of figure 10.
const TURN_AFTER: [f64; 4] = [-0.8, -0.2, -0.4, 0.5];
/// Direction of figure 10.
const TOWARDS_AFTER: [f64; 3] = [0.38, -0.12, -1.0];
/// Half side of `N(p)` of figure 10, a length.
const HALF: f64 = 0.9;

/// A setting, the run of the algorithm, and all cells.
struct Scene {
    run: Run,
    view: View,
    mark: Mark,
}

impl Scene {
    /// Runs the algorithm and finds all cells.
    fn new(setting: &Setting) -> Result<Self, Error> {
        let run = setting.run()?;
        let view = View::new(setting, &run.sections);
        let mark = Mark::new(&view, run.rectangle());
        Ok(Self { run, view, mark })
    }

    /// Returns the planar problem in the largest cell with this kind of contact; `None` if there is none.
    fn sample(&self, touch: SectionContact) -> Option<Instance> {
        let met = self.mark.cells.iter().filter(|cell| cell.touch == touch);
        let size = |corners: &[DVec2]| {
            let pairs = corners.iter().zip(corners.iter().cycle().skip(1));
            pairs.map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
        };
        let largest = met.max_by(|a, b| size(&a.corners).total_cmp(&size(&b.corners)));
        let inside = largest.map(|cell| middle(&cell.corners));
        self.view.instance(inside.or_else(|| self.mark.outside.first().copied())?)
    }
}

/// Draws all figures into a folder, which is created if necessary, and returns a summary.
///
/// # Errors
/// [`LabError`] if a file cannot be written, or if the cubes do not show the expected situations.
pub fn write(folder: &Path) -> Result<String, LabError> {
    let at_folder = |source| LabError::Folder { path: folder.into(), source };
    std::fs::create_dir_all(folder).map_err(at_folder)?;
    let drawn = figures()?;
    for (number, svg) in &drawn {
        let path = folder.join(format!("figure-{number:02}.svg"));
        std::fs::write(&path, svg).map_err(|source| LabError::Write { path, source })?;
    }
    Ok(format!("{} pictures are in {}\n", drawn.len(), folder.display()))
}

/// Returns the figures by number, as SVG documents. They are equal on every machine.
///
/// # Errors
/// [`Error`] if the library's results for the cubes have changed.
pub fn figures() -> Result<Vec<(u32, String)>, Error> {
    let setting = Setting::new(AT, TURN, TOWARDS)?;
    let scene = Scene::new(&setting)?;
    let at = |levels: [f64; 2]| scene.view.instance(DVec2::from_array(levels));
    let first = scene.run.steps.first().and_then(|step| at(step.problem.levels));
    let first = first.ok_or(Error::Missing("first step"))?;
    let edges = scene.sample(SectionContact::Edges).ok_or(Error::Missing("edge contact"))?;
    let vertex = scene.sample(SectionContact::Vertex).ok_or(Error::Missing("vertex contact"))?;
    let apart = scene.sample(SectionContact::Separated).ok_or(Error::Missing("separation"))?;
    let moved = Setting::new(AFTER, TURN_AFTER, TOWARDS_AFTER)?;
    let focused = moved.run_after(&Setting::new(BEFORE, TURN_AFTER, TOWARDS_AFTER)?, HALF)?;
    let seen = |found: &Instance, title| instances::sections_figure(&scene.view, found, title);
    Ok(vec![
        (1, instances::function_figure(&scene, &first)),
        (2, levels::orientation_figure(&scene)),
        (3, seen(&edges, "Edge contact of two sections, seen along d")),
        (4, seen(&vertex, "Vertex contact of two sections, seen along d")),
        (5, seen(&apart, "Two sections that pass each other, seen along d")),
        (6, levels::contact_figure(&scene)),
        (8, instances::reduction_figure(&scene, &first)),
        (9, levels::two_steps(&scene)),
        (10, levels::focus_figure(&Scene::new(&moved)?, &focused, HALF)),
    ])
}
