//! Rows of joint values, as files have them: CSV, or JSON.
//!
//! CSV: numbers with commas between them, a row a line; a first line that has none names the columns, of which one may
//! be `time`. Empty lines and what follows a `#` count for nothing. JSON: a list of rows, or what ROS calls a
//! trajectory, `{"joint_names": [..], "points": [{"positions": [..], "time_from_start": ..}]}`, or what `MoveIt` puts
//! around it, `{"joint_trajectory": {..}}`. Velocities and accelerations of points are not used; [`Table::unused`] names
//! those that a file has.

use serde::Deserialize;
use thiserror::Error;

/// Rows of values.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// The names of the columns, if they have some.
    pub names: Option<Vec<String>>,
    /// The times of the rows, if they have some.
    pub times: Option<Vec<f64>>,
    /// The rows.
    pub rows: Vec<Vec<f64>>,
    /// What a trajectory has besides positions and times, and nothing uses: velocities, accelerations, efforts.
    pub unused: Vec<&'static str>,
}

impl Table {
    /// What is reported of a path whose rows are joined by straight segments although the file has more than rows.
    pub fn straight(&self) -> Option<String> {
        let (last, before) = self.unused.split_last()?;
        let names = match before {
            [] => (*last).to_owned(),
            before => format!("{} and {last}", before.join(", ")),
        };
        Some(format!("along straight segments between the rows; the file's {names} were not used"))
    }
}

/// What is wrong with a file of rows.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{place}: {reason}")]
pub struct TableError {
    /// Where.
    pub place: String,
    /// What.
    pub reason: String,
}

fn wrong(place: impl Into<String>, reason: impl Into<String>) -> TableError {
    TableError { place: place.into(), reason: reason.into() }
}

/// A name that stands there twice.
pub(super) fn twice<T: PartialEq>(names: &[T]) -> Option<&T> {
    (1..names.len()).find(|&k| names[..k].contains(&names[k])).map(|k| &names[k])
}

/// The reason why a trajectory in YAML is refused.
const YAML: &str = "it is YAML, and rows are read from CSV or JSON: write it as JSON, for example with python3 -c \
                    'import json, sys, yaml; json.dump(next(yaml.safe_load_all(sys.stdin)), sys.stdout)'";

/// Names of a column of times.
const TIMES: [&str; 3] = ["time", "t", "time_from_start"];

impl Table {
    /// Of a text in either format, told by how it begins.
    ///
    /// # Errors
    /// What is wrong with it, and where.
    pub fn parse(text: &str) -> Result<Self, TableError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let table = match text.trim_start().chars().next() {
            Some('[' | '{') => Self::json(text)?,
            _ => Self::csv(text)?,
        };
        if table.rows.is_empty() {
            return Err(wrong("end of file", "there are no rows"));
        }
        if let Some(name) = table.names.as_deref().and_then(twice) {
            return Err(wrong("names of columns", format!("`{name}` is there twice")));
        }
        Ok(table)
    }

    fn csv(text: &str) -> Result<Self, TableError> {
        let mut table = Self::default();
        if let Some(reason) = is_yaml(text).then_some(YAML) {
            return Err(wrong("file", reason));
        }
        let mut first: Option<(usize, usize)> = None;
        for (k, line) in text.lines().enumerate() {
            let content = line.split('#').next().unwrap_or_default().trim();
            if content.is_empty() {
                continue;
            }
            let place = format!("line {}", k + 1);
            let fields: Vec<&str> = content.split(',').map(str::trim).collect();
            let numbers: Vec<Option<f64>> = fields.iter().map(|field| field.parse().ok()).collect();
            if first.is_none() && numbers.iter().all(Option::is_none) {
                table.names = Some(fields.iter().map(|name| (*name).to_owned()).collect());
                first = Some((k, fields.len()));
                continue;
            }
            let (_, columns) = *first.get_or_insert((k, fields.len()));
            if fields.len() != columns {
                let reason = format!("it has {} values, where {columns} stand above", fields.len());
                return Err(wrong(place, reason));
            }
            let row: Option<Vec<f64>> = numbers.into_iter().collect();
            let row = row.filter(|row| row.iter().all(|x| x.is_finite()));
            let row = row.ok_or_else(|| wrong(place, format!("`{content}` are not numbers")))?;
            table.rows.push(row);
        }
        table.take_times();
        Ok(table)
    }

    /// The column of times becomes the times.
    fn take_times(&mut self) {
        let Some(names) = &mut self.names else { return };
        let is_time = |name: &String| TIMES.contains(&name.to_ascii_lowercase().as_str());
        let Some(column) = names.iter().position(is_time) else { return };
        names.remove(column);
        self.times = Some(self.rows.iter_mut().map(|row| row.remove(column)).collect());
    }

    fn json(text: &str) -> Result<Self, TableError> {
        // What it is as a whole has no line.
        let place = |e: &serde_json::Error| match e.line() {
            0 => "JSON".into(),
            line => format!("line {line} column {}", e.column()),
        };
        let at = |e: &serde_json::Error| wrong(place(e), crate::plain::plain(e));
        let read: Json =
            serde_json::from_str(text).map_err(|e| wrong_point(text).unwrap_or_else(|| at(&e)))?;
        let Trajectory { joint_names: names, points } = match read {
            Json::Rows(rows) => return Self { rows, ..Self::default() }.even(),
            Json::Trajectory(trajectory) => trajectory,
            Json::Wrapped { joint_trajectory, multi_dof_joint_trajectory: several } => {
                if several.is_some_and(|several| !several.points.is_empty()) {
                    let reason = "joints of several degrees of freedom cannot be followed: only a trajectory \
                                  without points here is accepted";
                    return Err(wrong("multi_dof_joint_trajectory", reason));
                }
                joint_trajectory
            }
        };
        let has = |of: fn(&Point) -> &Option<Vec<f64>>| {
            points.iter().any(|point| of(point).as_ref().is_some_and(|values| !values.is_empty()))
        };
        let fields: [(&'static str, bool); 3] = [
            ("velocities", has(|point| &point.velocities)),
            ("accelerations", has(|point| &point.accelerations)),
            ("efforts", has(|point| &point.effort)),
        ];
        let unused = fields.into_iter().filter(|(_, is_there)| *is_there);
        let unused = unused.map(|(name, _)| name).collect();
        let timed = points.iter().filter(|point| point.time_from_start.is_some()).count();
        let untimed = points.iter().position(|point| point.time_from_start.is_none());
        if let Some(k) = untimed.filter(|_| timed > 0) {
            let reason =
                "it has no time_from_start, which other points have: give it to all or to none";
            return Err(wrong(format!("points[{k}]"), reason));
        }
        let times: Vec<f64> =
            points.iter().filter_map(|point| Some(point.time_from_start?.seconds())).collect();
        let rows: Vec<Vec<f64>> = points.into_iter().map(|point| point.positions).collect();
        if let Some(k) = rows.iter().position(|row| row.len() != names.len()) {
            let (found, wanted) = (rows[k].len(), names.len());
            let reason = format!("it has {found} positions for {wanted} joint_names");
            return Err(wrong(format!("points[{k}]"), reason));
        }
        Self { names: Some(names), times: (timed > 0).then_some(times), rows, unused }.even()
    }

    fn even(self) -> Result<Self, TableError> {
        let columns = self.names.as_ref().map(Vec::len).or(self.rows.first().map(Vec::len));
        match self.rows.iter().position(|row| Some(row.len()) != columns) {
            None => Ok(self),
            Some(k) => {
                let (found, wanted) = (self.rows[k].len(), columns.unwrap_or(0));
                Err(wrong(format!("row {k}"), format!("it has {found} values, not {wanted}")))
            }
        }
    }
}

/// Checks whether a text is a trajectory as ROS prints it, in YAML: its first line is a key of such a message.
fn is_yaml(text: &str) -> bool {
    let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default().trim());
    let first = lines.into_iter().find(|line| !line.is_empty() && *line != "---");
    let key = first.and_then(|line| line.split_once(':')).map(|(key, _)| key);
    key.is_some_and(|key| ["header", "joint_names", "points", "joint_trajectory"].contains(&key))
}

/// Finds the first point of a trajectory that is wrong; `None` in other texts.
fn wrong_point(text: &str) -> Option<TableError> {
    let whole: serde_json::Value = serde_json::from_str(text).ok()?;
    let trajectory = whole.get("joint_trajectory").unwrap_or(&whole);
    let points = trajectory.get("points")?.as_array()?;
    let wrong_one = |point: &serde_json::Value| Point::deserialize(point).err();
    let (k, error) =
        points.iter().enumerate().find_map(|(k, point)| Some((k, wrong_one(point)?)))?;
    Some(wrong(format!("points[{k}]"), crate::plain::plain(&error)))
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "it is neither a list of rows nor {\"joint_names\": [..], \"points\": [..]}, nor that as \
                 \"joint_trajectory\" of an object"
)]
enum Json {
    Rows(Vec<Vec<f64>>),
    Trajectory(Trajectory),
    Wrapped { joint_trajectory: Trajectory, multi_dof_joint_trajectory: Option<MultiDof> },
}

/// A trajectory of joints with several degrees of freedom, such as a floating base.
#[derive(Deserialize)]
struct MultiDof {
    points: Vec<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
struct Trajectory {
    joint_names: Vec<String>,
    points: Vec<Point>,
}

#[derive(Deserialize)]
struct Point {
    positions: Vec<f64>,
    velocities: Option<Vec<f64>>,
    accelerations: Option<Vec<f64>>,
    effort: Option<Vec<f64>>,
    time_from_start: Option<Duration>,
}

/// Seconds, or as ROS has them.
#[derive(Deserialize, Clone, Copy)]
#[serde(untagged)]
enum Duration {
    Seconds(f64),
    Two {
        #[serde(alias = "sec")]
        secs: f64,
        #[serde(alias = "nanosec")]
        nsecs: f64,
    },
}

impl Duration {
    fn seconds(self) -> f64 {
        match self {
            Self::Seconds(seconds) => seconds,
            Self::Two { secs, nsecs } => secs + nsecs * 1e-9,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_read() {
        let plain = Table::parse("0, 1\n# a comment\n\n2,3 # two\n").unwrap();
        assert_eq!(plain, Table { rows: vec![vec![0.0, 1.0], vec![2.0, 3.0]], ..Table::default() });
        let named = Table::parse("time,a,b\n0,1,2\n0.5,3,4\n").unwrap();
        assert_eq!(named.names.as_deref(), Some(&["a".to_owned(), "b".into()][..]));
        assert_eq!(named.times, Some(vec![0.0, 0.5]));
        assert_eq!(named.rows, [[1.0, 2.0], [3.0, 4.0]]);
        assert_eq!(Table::parse("[[0, 1], [2, 3]]").unwrap(), plain);
        let ros = r#"{"joint_names": ["a"], "points": [
            {"positions": [1], "time_from_start": {"sec": 1, "nanosec": 500000000}},
            {"positions": [2], "time_from_start": 2}]}"#;
        let ros = Table::parse(ros).unwrap();
        assert_eq!((ros.times, ros.rows), (Some(vec![1.5, 2.0]), vec![vec![1.0], vec![2.0]]));
    }

    #[test]
    fn velocities_of_a_trajectory_are_named_as_unused() {
        let ros = r#"{"joint_trajectory": {"header": {}, "joint_names": ["a"], "points": [
            {"positions": [1], "velocities": [3], "accelerations": [0], "effort": []},
            {"positions": [2], "velocities": []}]}, "multi_dof_joint_trajectory": {"points": []}}"#;
        let table = Table::parse(ros).unwrap();
        assert_eq!(table.rows, [[1.0], [2.0]]);
        assert_eq!(table.unused, ["velocities", "accelerations"]);
        let said = "along straight segments between the rows; the file's velocities and accelerations were not used";
        assert_eq!(table.straight().as_deref(), Some(said));
        assert_eq!(Table::parse("0,1\n").unwrap().straight(), None);
    }

    #[test]
    fn what_is_wrong_is_told_with_its_place() {
        let told = |text: &str| Table::parse(text).unwrap_err().to_string();
        assert_eq!(told("a,b\n1,2\n1\n"), "line 3: it has 1 values, where 2 stand above");
        assert_eq!(told("1,2\n1,x\n"), "line 2: `1,x` are not numbers");
        assert_eq!(told("a,b\n"), "end of file: there are no rows");
        assert_eq!(told("1,inf\n"), "line 1: `1,inf` are not numbers");
        assert_eq!(told("[[1, 2], [1]]"), "row 1: it has 1 values, not 2");
        assert!(told("{\"points\": []}").contains("it is neither a list of rows nor"));
        assert!(told("[[1, 2").contains("line 1"));
        let point = |point: &str| {
            told(&format!(r#"{{"joint_names": ["a"], "points": [{{"positions": [1]}}, {point}]}}"#))
        };
        let text = point(r#"{"positions": ["x"]}"#);
        assert!(text.starts_with("points[1]: ") && text.contains('x'), "{text}");
        let missing = point(r#"{"velocities": [1]}"#);
        assert!(missing.starts_with("points[1]: ") && missing.contains("positions"), "{missing}");
        let floating = r#"{"joint_trajectory": {"joint_names": ["a"], "points": [{"positions": [1]}]},
            "multi_dof_joint_trajectory": {"joint_names": ["base"], "points": [{"transforms": [{}]}]}}"#;
        assert!(
            told(floating).starts_with("multi_dof_joint_trajectory: joints of several degrees")
        );
        let mixed = r#"{"joint_names": ["a"], "points": [
            {"positions": [1], "time_from_start": 1}, {"positions": [2]}]}"#;
        assert!(told(mixed).starts_with("points[1]: it has no time_from_start"), "{}", told(mixed));
        let short = point(r#"{"positions": [1, 2]}"#);
        assert_eq!(short, "points[1]: it has 2 positions for 1 joint_names");
        for yaml in ["---\njoint_names:\n- a\n", "header:\n  stamp: 0\n", "# ROS\npoints: []\n"] {
            assert!(told(yaml).starts_with("file: it is YAML"), "{}", told(yaml));
        }
    }
}
