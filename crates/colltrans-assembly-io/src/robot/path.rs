//! Maps the rows of a table to the values of a robot's joints: by column name or by order, with fixed joints
//! and joints that mimic others.

use std::collections::BTreeMap;

use colltrans::motion::path::JointPath;

use super::{JointKind, Robot, RobotError, RobotJoint, Table};

/// The source of a joint's values.
#[derive(Debug, Clone, Copy)]
enum ValueSource {
    Column(usize),
    Rest(f64),
    Follows,
}

impl Robot {
    /// Returns the path of all joints, from a table and from joints fixed by name (`rest`), with notes. The
    /// notes report values beyond the limits, which are used unchanged, and fields of a trajectory that are not
    /// used.
    ///
    /// # Errors
    /// [`RobotError`] if a joint has no values, a column names no independent joint, rows have a wrong length,
    /// or times do not increase.
    pub fn joint_path(
        &self,
        table: &Table,
        rest: &BTreeMap<String, f64>,
    ) -> Result<(JointPath, Vec<String>), RobotError> {
        let sources = self.value_sources(table, rest)?;
        let rows = table.rows.iter().map(|row| self.joint_values(row, &sources)).collect();
        let path = match &table.times {
            Some(times) => JointPath::new(times.clone(), rows)?,
            None => JointPath::at_unit_times(rows)?,
        };
        let beyond = self.joints.iter().enumerate();
        let beyond = beyond.filter_map(|(k, joint)| exceeded_limits_note(joint, k, &path));
        let notes = table.unused_note().into_iter().chain(beyond).collect();
        Ok((path, notes))
    }

    /// Returns the names of the independent joints in their order, without those in `but`.
    fn independent_joint_names(&self, but: &BTreeMap<String, f64>) -> Vec<&str> {
        let own = self.joints.iter().filter(|joint| joint.mimic.is_none());
        own.map(|joint| joint.name.as_str()).filter(|name| !but.contains_key(*name)).collect()
    }

    fn value_sources(
        &self,
        table: &Table,
        rest: &BTreeMap<String, f64>,
    ) -> Result<Vec<ValueSource>, RobotError> {
        let own = self.independent_joint_names(&BTreeMap::new());
        if let Some(joint) = rest.keys().find(|name| !own.contains(&name.as_str())) {
            return Err(RobotError::Joint { joint: joint.clone(), joints: own.join(", ") });
        }
        let given = self.independent_joint_names(rest);
        let columns: Vec<&str> = if let Some(names) = &table.names {
            names.iter().map(String::as_str).collect()
        } else {
            let values = table.rows.first().map_or(0, Vec::len);
            if values != given.len() {
                let (count, joints) = (given.len(), given.join(", "));
                return Err(RobotError::Values { values, count, joints });
            }
            given.clone()
        };
        if let Some(column) = columns.iter().find(|column| !given.contains(column)) {
            return Err(RobotError::Column { column: (*column).into(), joints: given.join(", ") });
        }
        let source = |joint: &RobotJoint| {
            if joint.mimic.is_some() {
                return Ok(ValueSource::Follows);
            }
            if let Some(value) = rest.get(&joint.name) {
                return Ok(ValueSource::Rest(*value));
            }
            let column = columns.iter().position(|column| *column == joint.name);
            column
                .map(ValueSource::Column)
                .ok_or_else(|| RobotError::NoValues { joint: joint.name.clone() })
        };
        self.joints.iter().map(source).collect()
    }

    fn joint_values(&self, row: &[f64], sources: &[ValueSource]) -> Vec<f64> {
        let value = |k: usize| self.joint_value(k, row, sources);
        (0..self.joints.len()).map(value).collect()
    }

    /// Returns the value of a joint in a row. The recursion ends because mimics form no cycle (checked by the
    /// reader).
    fn joint_value(&self, joint: usize, row: &[f64], sources: &[ValueSource]) -> f64 {
        match (sources[joint], self.joints[joint].mimic) {
            (ValueSource::Column(column), _) => row[column],
            (ValueSource::Rest(value), _) => value,
            (ValueSource::Follows, Some(mimic)) => {
                mimic.multiplier * self.joint_value(mimic.joint, row, sources) + mimic.offset
            }
            (ValueSource::Follows, None) => 0.0,
        }
    }
}

/// Returns a note on the values beyond the limits of a joint, or `None` if there are none.
fn exceeded_limits_note(joint: &RobotJoint, column: usize, path: &JointPath) -> Option<String> {
    let [lower, upper] = joint.limits?;
    let beyond = |row: &&Vec<f64>| !(lower..=upper).contains(&row[column]);
    let count = path.rows().iter().filter(beyond).count();
    let first = path.rows().iter().position(|row| beyond(&row))?;
    let unit = if joint.kind == JointKind::Prismatic { "m" } else { "rad" };
    let (value, of) = (path.rows()[first][column], path.rows().len());
    Some(format!(
        "joint {} exceeds its limits, {lower} to {upper} {unit}, in {count} of {of} rows; first: {value} in \
         row {first}",
        joint.name
    ))
}
