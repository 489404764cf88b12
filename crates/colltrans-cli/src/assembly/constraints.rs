//! Applies the constraints of the plan and the roles of pairs of the command line to an assembly.

use std::path::Path;

use colltrans_assembly::Assembly;
use colltrans_assembly::constraints::DEFAULT_FORBIDDEN_DEGREES;
use colltrans_assembly::plan::HandlingTimes;
use colltrans_assembly::roles::{PairFit, Role};

use crate::args::{ConstraintArguments, RoleArguments, direction};
use crate::failure::{Code, Failure};
use crate::inputs::read_text;

/// Returns the assembly with constraints of its plans.
///
/// # Errors
/// An option has an unknown part or a wrong form, or constraints contradict each other.
pub(super) fn with_constraints(
    assembly: Assembly,
    arguments: &ConstraintArguments,
) -> Result<Assembly, Failure> {
    let mut assembly = assembly.with_fixed(&arguments.fixed)?;
    let after =
        name_pairs("--after", &arguments.after)?.into_iter().map(|[later, first]| [first, later]);
    for [first, later] in name_pairs("--before", &arguments.before)?.into_iter().chain(after) {
        assembly = assembly.with_before(&[first], &[later])?;
    }
    for names in &arguments.together {
        let parts: Vec<&str> = names.split(',').collect();
        assembly = assembly.with_together(&parts)?;
    }
    for given in &arguments.subassembly {
        let (name, parts) = split_at_equals("--subassembly", given, "NAME=A,B,...")?;
        let parts: Vec<&str> = parts.split(',').collect();
        assembly = assembly.with_subassembly(name, &parts)?;
    }
    for given in &arguments.never {
        let form = "PART=X,Y,Z or PART=X,Y,Z@DEGREES";
        let (part, cone) = split_at_equals("--never", given, form)?;
        let (axis, degrees) = cone.split_once('@').unwrap_or((cone, ""));
        let refused = |reason: &str| usage_failure(format!("--never {given}: {reason}"));
        let direction = direction(axis).map_err(|reason| refused(&reason))?;
        let degrees = match degrees {
            "" => DEFAULT_FORBIDDEN_DEGREES,
            text => text.trim().parse().map_err(|_| refused(&format!("expected {form}")))?,
        };
        assembly = assembly.with_never(&[part], direction, degrees)?;
    }
    Ok(assembly)
}

/// Returns the assembly with densities in kilograms per cubic metre: of all parts, or of a material or part.
///
/// # Errors
/// A density is not a number or invalid, or neither a material nor a part has the name.
pub(super) fn with_densities(
    mut assembly: Assembly,
    given: &[String],
) -> Result<Assembly, Failure> {
    for text in given {
        let (name, value) = match text.rsplit_once('=') {
            Some(_) => split_at_equals("--density", text, "NAME=RHO")?,
            None => ("*", text.trim()),
        };
        let density = value.parse().map_err(|_| {
            usage_failure(format!(
                "--density {text}: expected RHO or NAME=RHO, in kilograms per cubic metre, such as steel=7850"
            ))
        })?;
        assembly = assembly.with_density(name, density)?;
    }
    Ok(assembly)
}

/// Returns the assembly with roles and tolerances of pairs.
///
/// # Errors
/// An option has an unknown part or a wrong form.
pub(super) fn with_roles(
    assembly: Assembly,
    arguments: &RoleArguments,
) -> Result<Assembly, Failure> {
    let all = [
        ("--pair", None, &arguments.pair),
        ("--press", Some(Role::Press), &arguments.press),
        ("--soft", Some(Role::Soft), &arguments.soft),
        ("--thread", Some(Role::Thread), &arguments.thread),
        ("--snap", Some(Role::Snap), &arguments.snap),
        ("--glued", Some(Role::Glued), &arguments.glued),
    ];
    let mut assembly = assembly;
    for (flag, role, given) in all {
        for value in given {
            let accepts_tolerance = role != Some(Role::Glued);
            let requires_tolerance = matches!(role, None | Some(Role::Snap));
            let (names, tolerance) = match value.rsplit_once('=').filter(|_| accepts_tolerance) {
                Some((names, length)) => {
                    let length = length.trim().parse();
                    let refused = |_| {
                        usage_failure(format!(
                            "{flag} {value}: expected two names and a tolerance, A,B=L"
                        ))
                    };
                    (names, Some(length.map_err(refused)?))
                }
                None if requires_tolerance => {
                    return Err(usage_failure(format!(
                        "{flag} {value}: expected two names and a tolerance, A,B=L"
                    )));
                }
                None => (&value[..], None),
            };
            let [a, b] = name_pair(flag, names)?;
            assembly = assembly.with_pair([&[a], &[b]], PairFit { role, tolerance })?;
        }
    }
    Ok(assembly)
}

/// Reads the table of handling times from a file; returns the default table without one.
///
/// # Errors
/// The file cannot be read, or a time is invalid.
pub(super) fn handling_times(file: Option<&Path>) -> Result<HandlingTimes, Failure> {
    let Some(path) = file else { return Ok(HandlingTimes::default()) };
    let refused =
        |reason: String| Failure::new(Code::Input, format!("{}: {reason}", path.display()));
    let times: HandlingTimes =
        serde_json::from_str(&read_text(path)?).map_err(|e| refused(e.to_string()))?;
    match times.first_invalid() {
        Some((name, seconds)) => {
            Err(refused(format!("{name}: invalid time {seconds}; expected a number of seconds")))
        }
        None => Ok(times),
    }
}

/// Returns the failure of a wrong option.
fn usage_failure(text: String) -> Failure {
    Failure::new(Code::Usage, text)
}

/// Splits a value at its last `=`, because names may contain `=`.
///
/// # Errors
/// There is no `=`, or no name before it. `form` is the expected form for the message.
pub(super) fn split_at_equals<'a>(
    flag: &str,
    given: &'a str,
    form: &str,
) -> Result<(&'a str, &'a str), Failure> {
    let found = given.rsplit_once('=').map(|(a, b)| (a.trim(), b.trim()));
    let found = found.filter(|(name, _)| !name.is_empty());
    found.ok_or_else(|| usage_failure(format!("{flag} {given}: expected {form}")))
}

/// Parses pairs of names, `A,B` each.
pub(super) fn name_pairs<'a>(
    flag: &str,
    given: &'a [String],
) -> Result<Vec<[&'a str; 2]>, Failure> {
    given.iter().map(|given| name_pair(flag, given)).collect()
}

/// Parses a pair of names, `A,B`.
fn name_pair<'a>(flag: &str, given: &'a str) -> Result<[&'a str; 2], Failure> {
    let found = given.split_once(',').map(|(a, b)| [a.trim(), b.trim()]);
    found.ok_or_else(|| {
        usage_failure(format!("{flag} {given}: expected two names, separated by a comma"))
    })
}
