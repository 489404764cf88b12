//! What is asked of a plan, and said of pairs, from the command line to the parts.

use std::path::Path;

use colltrans_assembly::Assembly;
use colltrans_assembly::constraints::WITHIN_DEGREES;
use colltrans_assembly::plan::Times;
use colltrans_assembly::roles::{PairFit, Role};

use crate::args::{ConstraintArguments, RoleArguments, direction};
use crate::failure::{Code, Failure};
use crate::inputs::read_text;

/// The assembly with what is asked of its plans.
pub(super) fn constrained(
    assembly: Assembly,
    asked: &ConstraintArguments,
) -> Result<Assembly, Failure> {
    let mut assembly = assembly.with_fixed(&asked.fixed)?;
    let after = pairs("--after", &asked.after)?.into_iter().map(|[later, first]| [first, later]);
    for [first, later] in pairs("--before", &asked.before)?.into_iter().chain(after) {
        assembly = assembly.with_before(&[first], &[later])?;
    }
    for names in &asked.together {
        let parts: Vec<&str> = names.split(',').collect();
        assembly = assembly.with_together(&parts)?;
    }
    for given in &asked.subassembly {
        let (name, parts) = halves("--subassembly", given, "NAME=A,B,...")?;
        let parts: Vec<&str> = parts.split(',').collect();
        assembly = assembly.with_subassembly(name, &parts)?;
    }
    for given in &asked.never {
        let form = "PART=X,Y,Z or PART=X,Y,Z@DEGREES";
        let (part, way) = halves("--never", given, form)?;
        let (way, degrees) = way.split_once('@').unwrap_or((way, ""));
        let refused = |reason: &str| usage(format!("--never {given}: {reason}"));
        let direction = direction(way).map_err(|reason| refused(&reason))?;
        let degrees = match degrees {
            "" => WITHIN_DEGREES,
            text => text.trim().parse().map_err(|_| refused(&format!("not {form}")))?,
        };
        assembly = assembly.with_never(&[part], direction, degrees)?;
    }
    Ok(assembly)
}

/// The assembly with what is said of pairs.
pub(super) fn with_roles(assembly: Assembly, asked: &RoleArguments) -> Result<Assembly, Failure> {
    let all = [
        ("--pair", None, &asked.pair),
        ("--press", Some(Role::Press), &asked.press),
        ("--soft", Some(Role::Soft), &asked.soft),
        ("--thread", Some(Role::Thread), &asked.thread),
        ("--snap", Some(Role::Snap), &asked.snap),
        ("--glued", Some(Role::Glued), &asked.glued),
    ];
    let mut assembly = assembly;
    for (flag, role, given) in all {
        for said in given {
            let takes = role != Some(Role::Glued);
            let needs = matches!(role, None | Some(Role::Snap));
            let (names, tolerance) = match said.rsplit_once('=').filter(|_| takes) {
                Some((names, length)) => {
                    let length = length.trim().parse();
                    let refused = |_| usage(format!("{flag} {said}: not A,B=L"));
                    (names, Some(length.map_err(refused)?))
                }
                None if needs => return Err(usage(format!("{flag} {said}: not A,B=L"))),
                None => (&said[..], None),
            };
            let [a, b] = pair(flag, names)?;
            assembly = assembly.with_pair([&[a], &[b]], PairFit { role, tolerance })?;
        }
    }
    Ok(assembly)
}

/// The table of handling times in a file, or the one that there is.
pub(super) fn times(file: Option<&Path>) -> Result<Times, Failure> {
    let Some(path) = file else { return Ok(Times::default()) };
    let refused =
        |reason: String| Failure::new(Code::Input, format!("{}: {reason}", path.display()));
    let times: Times =
        serde_json::from_str(&read_text(path)?).map_err(|e| refused(e.to_string()))?;
    match times.wrong() {
        Some((name, seconds)) => Err(refused(format!("{name}: {seconds} is no time in seconds"))),
        None => Ok(times),
    }
}

fn usage(text: String) -> Failure {
    Failure::new(Code::Usage, text)
}

/// What stands before and after the last `=`: names may hold others.
pub(super) fn halves<'a>(
    flag: &str,
    given: &'a str,
    form: &str,
) -> Result<(&'a str, &'a str), Failure> {
    let found = given.rsplit_once('=').map(|(a, b)| (a.trim(), b.trim()));
    let found = found.filter(|(name, _)| !name.is_empty());
    found.ok_or_else(|| usage(format!("{flag} {given}: not {form}")))
}

/// Two names each.
pub(super) fn pairs<'a>(flag: &str, given: &'a [String]) -> Result<Vec<[&'a str; 2]>, Failure> {
    given.iter().map(|given| pair(flag, given)).collect()
}

fn pair<'a>(flag: &str, given: &'a str) -> Result<[&'a str; 2], Failure> {
    let found = given.split_once(',').map(|(a, b)| [a.trim(), b.trim()]);
    found.ok_or_else(|| usage(format!("{flag} {given}: not two names with a comma between")))
}
