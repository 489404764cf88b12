//! Reads rows of joint values from CSV or JSON.
//!
//! - CSV: comma-separated numbers, one row in each line. If the first line has no numbers, it names the columns,
//!   one of which may be `time`, `t` or `time_from_start`. Empty lines, and text after `#`, are ignored.
//! - JSON: a list of rows, a ROS trajectory `{"joint_names": [..], "points": [{"positions": [..],
//!   "time_from_start": ..}]}`, or the `MoveIt` form `{"joint_trajectory": {..}}`.
//!
//! Velocities, accelerations and efforts of points are not used; [`Table::unused_fields`] names those that a file has.

use serde::Deserialize;
use thiserror::Error;

/// Rows of joint values.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// The names of the columns; `None` if the file has no header line.
    pub names: Option<Vec<String>>,
    /// The times of the rows, in seconds; `None` if the file has no times.
    pub times: Option<Vec<f64>>,
    /// The rows.
    pub rows: Vec<Vec<f64>>,
    /// The fields of a trajectory that are not used: velocities, accelerations, efforts.
    pub unused_fields: Vec<&'static str>,
}

impl Table {
    /// Returns a note that the rows are joined by straight segments, although the file has derivatives as well;
    /// `None` if it has none.
    pub fn unused_note(&self) -> Option<String> {
        let (last, before) = self.unused_fields.split_last()?;
        let names = match before {
            [] => (*last).to_owned(),
            before => format!("{} and {last}", before.join(", ")),
        };
        Some(format!("rows are joined by straight segments; the {names} in the file were not used"))
    }
}

/// An error in a file of rows.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{place}: {reason}")]
pub struct TableError {
    /// The place in the file.
    pub place: String,
    /// The reason.
    pub reason: String,
}

/// Builds an error from a place and a reason.
fn table_error(place: impl Into<String>, reason: impl Into<String>) -> TableError {
    TableError { place: place.into(), reason: reason.into() }
}

/// Returns the first name that occurs a second time; `None` if all differ.
pub(super) fn first_duplicate<T: PartialEq>(names: &[T]) -> Option<&T> {
    (1..names.len()).find(|&k| names[..k].contains(&names[k])).map(|k| &names[k])
}

/// The reason why a trajectory in YAML is rejected.
const YAML: &str = "found YAML, accepted: CSV or JSON; convert the file to JSON, for example with python3 -c \
                    'import json, sys, yaml; json.dump(next(yaml.safe_load_all(sys.stdin)), sys.stdout)'";

/// The accepted names of a column of times.
const TIMES: [&str; 3] = ["time", "t", "time_from_start"];

impl Table {
    /// Parses a text in either format. Texts that begin with `[` or `{` are JSON.
    ///
    /// # Errors
    /// [`TableError`] with the place and the reason.
    pub fn parse(text: &str) -> Result<Self, TableError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let table = match text.trim_start().chars().next() {
            Some('[' | '{') => Self::parse_json(text)?,
            _ => Self::parse_csv(text)?,
        };
        if table.rows.is_empty() {
            return Err(table_error("end of file", "no rows; expected at least one"));
        }
        if let Some(name) = table.names.as_deref().and_then(first_duplicate) {
            return Err(table_error(
                "names of columns",
                format!("duplicate name `{name}`; names must be unique"),
            ));
        }
        Ok(table)
    }

    fn parse_csv(text: &str) -> Result<Self, TableError> {
        let mut table = Self::default();
        if let Some(reason) = is_yaml(text).then_some(YAML) {
            return Err(table_error("file", reason));
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
                let reason =
                    format!("{} values, expected {columns} as in the lines above", fields.len());
                return Err(table_error(place, reason));
            }
            let row: Option<Vec<f64>> = numbers.into_iter().collect();
            let row = row.filter(|row| row.iter().all(|x| x.is_finite()));
            let row = row.ok_or_else(|| {
                table_error(place, format!("`{content}` has a value that is not a finite number"))
            })?;
            table.rows.push(row);
        }
        table.take_times();
        Ok(table)
    }

    /// Moves the column of times, if there is one, to [`Self::times`].
    fn take_times(&mut self) {
        let Some(names) = &mut self.names else { return };
        let is_time = |name: &String| TIMES.contains(&name.to_ascii_lowercase().as_str());
        let Some(column) = names.iter().position(is_time) else { return };
        names.remove(column);
        self.times = Some(self.rows.iter_mut().map(|row| row.remove(column)).collect());
    }

    fn parse_json(text: &str) -> Result<Self, TableError> {
        // Errors about the document as a whole have no line.
        let place = |e: &serde_json::Error| match e.line() {
            0 => "JSON".into(),
            line => format!("line {line} column {}", e.column()),
        };
        let at = |e: &serde_json::Error| table_error(place(e), crate::plain::json_error_reason(e));
        let read: JsonTable = serde_json::from_str(text)
            .map_err(|e| first_invalid_point(text).unwrap_or_else(|| at(&e)))?;
        let Trajectory { joint_names: names, points } = match read {
            JsonTable::Rows(rows) => return Self { rows, ..Self::default() }.check_row_lengths(),
            JsonTable::Trajectory(trajectory) => trajectory,
            JsonTable::Wrapped { joint_trajectory, multi_dof_joint_trajectory: several } => {
                if several.is_some_and(|several| !several.points.is_empty()) {
                    let reason = "joints with several degrees of freedom are not supported; accepted: a trajectory \
                                  without points here";
                    return Err(table_error("multi_dof_joint_trajectory", reason));
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
            let reason = "missing time_from_start, which other points have; give it for all points or for none";
            return Err(table_error(format!("points[{k}]"), reason));
        }
        let times: Vec<f64> =
            points.iter().filter_map(|point| Some(point.time_from_start?.seconds())).collect();
        let rows: Vec<Vec<f64>> = points.into_iter().map(|point| point.positions).collect();
        if let Some(k) = rows.iter().position(|row| row.len() != names.len()) {
            let (found, wanted) = (rows[k].len(), names.len());
            let reason =
                format!("{found} positions, expected {wanted}, one for each of joint_names");
            return Err(table_error(format!("points[{k}]"), reason));
        }
        Self {
            names: Some(names),
            times: (timed > 0).then_some(times),
            rows,
            unused_fields: unused,
        }
        .check_row_lengths()
    }

    /// Returns the table if all rows have the same number of values, which is that of the names if there are
    /// names.
    fn check_row_lengths(self) -> Result<Self, TableError> {
        let columns = self.names.as_ref().map(Vec::len).or(self.rows.first().map(Vec::len));
        match self.rows.iter().position(|row| Some(row.len()) != columns) {
            None => Ok(self),
            Some(k) => {
                let (found, wanted) = (self.rows[k].len(), columns.unwrap_or(0));
                Err(table_error(format!("row {k}"), format!("{found} values, expected {wanted}")))
            }
        }
    }
}

/// Checks whether a text is a ROS trajectory printed as YAML: its first line is a key of such a message.
fn is_yaml(text: &str) -> bool {
    let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default().trim());
    let first = lines.into_iter().find(|line| !line.is_empty() && *line != "---");
    let key = first.and_then(|line| line.split_once(':')).map(|(key, _)| key);
    key.is_some_and(|key| ["header", "joint_names", "points", "joint_trajectory"].contains(&key))
}

/// Finds the first invalid point of a trajectory; `None` if the text is not a trajectory or all points are
/// valid.
fn first_invalid_point(text: &str) -> Option<TableError> {
    let whole: serde_json::Value = serde_json::from_str(text).ok()?;
    let trajectory = whole.get("joint_trajectory").unwrap_or(&whole);
    let points = trajectory.get("points")?.as_array()?;
    let point_error = |point: &serde_json::Value| Point::deserialize(point).err();
    let (k, error) =
        points.iter().enumerate().find_map(|(k, point)| Some((k, point_error(point)?)))?;
    Some(table_error(format!("points[{k}]"), crate::plain::json_error_reason(&error)))
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "neither a list of rows nor {\"joint_names\": [..], \"points\": [..]}, alone or as \
                 \"joint_trajectory\""
)]
enum JsonTable {
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
    time_from_start: Option<RosTime>,
}

/// A time: a number of seconds, or seconds and nanoseconds as ROS writes them.
#[derive(Deserialize, Clone, Copy)]
#[serde(untagged)]
enum RosTime {
    Seconds(f64),
    Two {
        #[serde(alias = "sec")]
        secs: f64,
        #[serde(alias = "nanosec")]
        nsecs: f64,
    },
}

impl RosTime {
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
    fn csv_and_json_rows_are_read() {
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
        assert_eq!(table.unused_fields, ["velocities", "accelerations"]);
        let note = "rows are joined by straight segments; the velocities and accelerations in the file were not used";
        assert_eq!(table.unused_note().as_deref(), Some(note));
        assert_eq!(Table::parse("0,1\n").unwrap().unused_note(), None);
    }

    #[test]
    fn invalid_tables_report_place_and_reason() {
        let error_text = |text: &str| Table::parse(text).unwrap_err().to_string();
        assert_eq!(
            error_text("a,b\n1,2\n1\n"),
            "line 3: 1 values, expected 2 as in the lines above"
        );
        assert_eq!(
            error_text("1,2\n1,x\n"),
            "line 2: `1,x` has a value that is not a finite number"
        );
        assert_eq!(error_text("a,b\n"), "end of file: no rows; expected at least one");
        assert_eq!(
            error_text("1,inf\n"),
            "line 1: `1,inf` has a value that is not a finite number"
        );
        assert_eq!(error_text("[[1, 2], [1]]"), "row 1: 1 values, expected 2");
        assert!(error_text("{\"points\": []}").contains("neither a list of rows nor"));
        assert!(error_text("[[1, 2").contains("line 1"));
        let point = |point: &str| {
            error_text(&format!(
                r#"{{"joint_names": ["a"], "points": [{{"positions": [1]}}, {point}]}}"#
            ))
        };
        let text = point(r#"{"positions": ["x"]}"#);
        assert!(text.starts_with("points[1]: ") && text.contains('x'), "{text}");
        let missing = point(r#"{"velocities": [1]}"#);
        assert!(missing.starts_with("points[1]: ") && missing.contains("positions"), "{missing}");
        let floating = r#"{"joint_trajectory": {"joint_names": ["a"], "points": [{"positions": [1]}]},
            "multi_dof_joint_trajectory": {"joint_names": ["base"], "points": [{"transforms": [{}]}]}}"#;
        assert!(
            error_text(floating)
                .starts_with("multi_dof_joint_trajectory: joints with several degrees")
        );
        let mixed = r#"{"joint_names": ["a"], "points": [
            {"positions": [1], "time_from_start": 1}, {"positions": [2]}]}"#;
        assert!(
            error_text(mixed).starts_with("points[1]: missing time_from_start"),
            "{}",
            error_text(mixed)
        );
        let short = point(r#"{"positions": [1, 2]}"#);
        assert_eq!(short, "points[1]: 2 positions, expected 1, one for each of joint_names");
        for yaml in ["---\njoint_names:\n- a\n", "header:\n  stamp: 0\n", "# ROS\npoints: []\n"] {
            assert!(error_text(yaml).starts_with("file: found YAML"), "{}", error_text(yaml));
        }
    }
}
