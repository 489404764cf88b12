//! `colltrans path`: which links of a robot first meet on a path, each other or the scene.

use std::collections::BTreeMap;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use colltrans::motion::path::{
    PathBody, PathCast, PathFileError, PathOutcome, PathProofFile, Place,
};
use colltrans::record::{Ending, PathRecord, TimeRecord};
use colltrans::{AnyBody, Pose};
use colltrans_assembly::read::{self, ReadOptions};
use colltrans_assembly::robot::{Robot, RobotError, Table, body_of};
use colltrans_mesh::body::BodyOptions;

use crate::args::PathArguments;
use crate::body;
use crate::failure::{Code, Failure, note, print, print_json};
use crate::numbers::{counted, known, known_vector, number, unit_vector};
use crate::proof::{self, refuse_proof};
use crate::report::line;

pub(crate) fn run(arguments: &PathArguments) -> Result<(), Failure> {
    let PathArguments { robot, rows, scene, srdf, .. } = arguments;
    let inputs: Vec<&Path> =
        [robot, rows].into_iter().chain(scene).chain(srdf).map(PathBuf::as_path).collect();
    refuse_proof(arguments.save_proof.as_deref(), None, &inputs)?;
    let asked = Asked::read(arguments)?;
    let cast =
        PathCast::new(asked.robot.mechanism(), &asked.path, asked.bodies(), asked.pairs.clone());
    let cast = cast.and_then(|cast| cast.keeping(arguments.keep)).map_err(|e| asked.query(&e))?;
    let outcome = match &arguments.save_proof {
        None => cast.first_contact().map_err(|e| asked.query(&e))?,
        Some(file) => {
            let answered = PathProofFile::answer(&cast, &asked.names);
            let (outcome, saved) = answered.map_err(|e| match e {
                PathFileError::Path(e) => asked.query(&e),
                other => Failure::new(Code::Query, other.to_string()),
            })?;
            proof::save_text(file, &saved.to_json())?;
            outcome
        }
    };
    let record = PathRecord::of(&outcome, &cast, &asked.names);
    if arguments.json {
        let written = serde_json::to_string(&record);
        let written = written.map_err(|e| Failure::output("standard output", &e.into()))?;
        return print_json(&format!("{written}\n"));
    }
    print(&words(&record, &outcome))
}

/// A robot, its path, and what is held against what.
struct Asked {
    robot: Robot,
    path: colltrans::motion::path::JointPath,
    scene: Vec<AnyBody>,
    /// For each body its name: of its link, or of a mesh of the scene.
    names: Vec<String>,
    pairs: Vec<[usize; 2]>,
}

impl Asked {
    fn read(arguments: &PathArguments) -> Result<Self, Failure> {
        let input = |e: &dyn std::fmt::Display| Failure::new(Code::Input, e.to_string());
        let rest = resting(&arguments.joint)?;
        let options = ReadOptions::default()
            .with_packages(arguments.package.clone())
            .with_skip_missing(arguments.skip_missing)
            .with_allow_outside(arguments.allow_outside);
        let robot = read::robot(&arguments.robot, &options).map_err(|e| input(&e))?;
        robot.notes().iter().for_each(|text| note(text));
        let place = arguments.rows.display();
        let table =
            Table::parse(&text(&arguments.rows)?).map_err(|e| input(&format!("{place}: {e}")))?;
        let (path, notes) =
            robot.path(&table, &rest).map_err(|e| input(&format!("{place}: {e}")))?;
        for text in &notes {
            note(text);
        }
        let mut scene = Vec::new();
        for file in &arguments.scene {
            let options = BodyOptions::default().with_scale(arguments.scene_scale);
            let taken =
                colltrans_mesh::body::load(file, &options, |mesh, options| body_of(&mesh, options));
            let (body, notes) = taken.map_err(|e| Failure::new(Code::Input, body::refusal(&e)))?;
            for text in &notes {
                note(&format!("{}: {text}", file.display()));
            }
            scene.push(body);
        }
        let things = Things::of(&robot, &arguments.scene);
        let pairs = things.pairs(&robot, arguments)?;
        let names = things.bodies.iter().map(|(thing, _)| things.names[*thing].clone()).collect();
        Ok(Self { robot, path, scene, names, pairs })
    }

    /// All bodies: those of the links, and the scene.
    fn bodies(&self) -> Vec<PathBody<'_>> {
        let links = self.robot.links().iter();
        let carried = links.flat_map(|link| link.bodies.iter().map(|body| (link.frame, body)));
        let carried =
            carried.map(|(frame, body)| PathBody { frame, placed: body.at(Pose::IDENTITY) });
        let scene = self.scene.iter().map(|body| PathBody::standing(body.at(Pose::IDENTITY)));
        carried.chain(scene).collect()
    }

    fn query(&self, error: &colltrans::motion::path::PathError) -> Failure {
        use colltrans::motion::path::PathError;
        let text = match error {
            PathError::Query { pair, reason } => {
                let [a, b] = pair.map(|k| self.names[k].as_str());
                format!("{a} and {b}: {reason}")
            }
            other => other.to_string(),
        };
        Failure::new(Code::Query, text)
    }
}

/// Links and meshes by their names, and the bodies of each.
struct Things {
    names: Vec<String>,
    links: usize,
    /// For each body whose it is, and its number there.
    bodies: Vec<(usize, usize)>,
}

impl Things {
    fn of(robot: &Robot, scene: &[PathBuf]) -> Self {
        let stem = |file: &PathBuf| {
            file.file_stem().unwrap_or(file.as_os_str()).to_string_lossy().into_owned()
        };
        let links = robot.links();
        let names = links.iter().map(|link| link.name.clone()).chain(scene.iter().map(stem));
        let counts = links.iter().map(|link| link.bodies.len()).chain(scene.iter().map(|_| 1));
        let bodies = counts.enumerate().flat_map(|(k, count)| (0..count).map(move |n| (k, n)));
        Self { names: names.collect(), links: links.len(), bodies: bodies.collect() }
    }

    /// The pairs of bodies that are held against each other; what is not, is said.
    fn pairs(&self, robot: &Robot, arguments: &PathArguments) -> Result<Vec<[usize; 2]>, Failure> {
        let input = |e: RobotError| Failure::new(Code::Input, e.to_string());
        let listed = match &arguments.srdf {
            Some(file) => {
                let listed =
                    read::disabled(file).map_err(|e| Failure::new(Code::Input, e.to_string()))?;
                Some(listed)
            }
            None => None,
        };
        let mut things = robot.pairs(listed.as_deref()).map_err(input)?;
        if listed.is_none() {
            let all = robot.pairs(Some(&[])).map_err(input)?.len();
            let skipped = counted(all - things.len(), "pair of links", "pairs of links");
            note(&format!(
                "{skipped} with one joint between them are not held against each other; --srdf says which \
                 are not"
            ));
        }
        let mut rest = 0;
        for link in 0..self.links {
            let moves = robot.moving_between(link, None) > 0;
            for mesh in self.links..self.names.len() {
                if moves {
                    things.push([link, mesh]);
                } else {
                    rest += usize::from(!robot.links()[link].bodies.is_empty());
                }
            }
        }
        if rest > 0 {
            note("links that no joint moves are not held against the scene");
        }
        for pair in &arguments.ignore {
            let [a, b] = self.named(pair)?;
            let before = things.len();
            things.retain(|[x, y]| !(x == &a && y == &b || x == &b && y == &a));
            if things.len() == before {
                note(&format!("--ignore {pair}: these are not held against each other anyway"));
            }
        }
        let own = |thing: usize| {
            self.bodies.iter().enumerate().filter(move |(_, of)| of.0 == thing).map(|(k, _)| k)
        };
        let of_bodies = things
            .iter()
            .flat_map(|[a, b]| own(*a).flat_map(move |x| own(*b).map(move |y| [x, y])));
        Ok(of_bodies.collect())
    }

    fn named(&self, pair: &str) -> Result<[usize; 2], Failure> {
        let usage = |what: String| Failure::new(Code::Usage, format!("--ignore {pair}: {what}"));
        let Some((a, b)) = pair.split_once(',') else { return Err(usage("not A,B".into())) };
        let find = |name: &str| {
            let found = self.names.iter().position(|known| known == name.trim());
            found.ok_or_else(|| {
                usage(format!("there is no {}; there are {}", name.trim(), self.names.join(", ")))
            })
        };
        Ok([find(a)?, find(b)?])
    }
}

/// The joints that rest.
fn resting(given: &[String]) -> Result<BTreeMap<String, f64>, Failure> {
    let one = |text: &String| {
        let parts = text.split_once('=').and_then(|(n, v)| Some((n, v.trim().parse().ok()?)));
        parts
            .map(|(name, value): (&str, f64)| (name.trim().to_owned(), value))
            .ok_or_else(|| Failure::new(Code::Usage, format!("--joint {text}: not NAME=VALUE")))
    };
    given.iter().map(one).collect()
}

fn text(file: &Path) -> Result<String, Failure> {
    let mut text = String::new();
    let read = if file == Path::new("-") {
        io::stdin().read_to_string(&mut text).map(|_| ())
    } else {
        colltrans_mesh::file::text(file).map(|read| text = read)
    };
    read.map_err(|e| {
        Failure::new(Code::Input, format!("{}: cannot be read: {e}", file.display()))
    })?;
    Ok(text)
}

/// The readable answer.
fn words(record: &PathRecord, outcome: &PathOutcome) -> String {
    let mut text = String::from(match record.outcome {
        Ending::Contact => "contact\n",
        Ending::Grazing => "grazing: two bodies come nearer than rounding can tell\n",
        Ending::Overlapping => "overlapping: two bodies overlap where the path begins\n",
        _ => "free: no two bodies meet on the whole path\n",
    });
    if let Some([a, b]) = &record.pair {
        line(&mut text, "bodies", &format!("{a}, {b}"));
    }
    if let Some(TimeRecord { lower, upper }) = record.time
        && record.outcome != Ending::Overlapping
    {
        if let Some(upper) = upper {
            line(&mut text, "time", &known(lower + 0.5 * (upper - lower), upper - lower));
            line(&mut text, "bounds", &format!("{} to {}", number(lower), number(upper)));
        } else {
            line(&mut text, "no earlier", &number(lower));
        }
        if let Some(Place { row, share }) = record.place {
            let percent = known(100.0 * share, 0.1);
            line(
                &mut text,
                "place",
                &format!("{percent} % of the way from row {row} to the next one"),
            );
        }
    }
    if let Some(point) = record.point {
        line(&mut text, "point", &known_vector(point.into(), 1e-12));
    }
    if let Some(normal) = record.normal {
        line(&mut text, "normal", &unit_vector(normal.into()));
    }
    line(&mut text, "asked", &counted(record.pairs, "pair of bodies", "pairs of bodies"));
    let looks = counted(outcome.steps().looks as usize, "look", "looks");
    let planes = counted(record.planes, "plane", "planes");
    line(&mut text, "proof", &format!("{planes}, found in {looks}"));
    text
}
