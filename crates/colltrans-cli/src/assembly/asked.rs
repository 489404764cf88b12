//! What is asked of a plan, from the command line to the parts.

use colltrans_assembly::Assembly;
use colltrans_assembly::constraints::WITHIN_DEGREES;

use crate::args::{ConstraintArguments, direction};
use crate::failure::{Code, Failure};

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

fn usage(text: String) -> Failure {
    Failure::new(Code::Usage, text)
}

/// What stands before and after the last `=`: names may hold others.
fn halves<'a>(flag: &str, given: &'a str, form: &str) -> Result<(&'a str, &'a str), Failure> {
    let found = given.rsplit_once('=').map(|(a, b)| (a.trim(), b.trim()));
    let found = found.filter(|(name, _)| !name.is_empty());
    found.ok_or_else(|| usage(format!("{flag} {given}: not {form}")))
}

/// Two names each.
pub(super) fn pairs<'a>(flag: &str, given: &'a [String]) -> Result<Vec<[&'a str; 2]>, Failure> {
    let names = |pair: &'a String| {
        let found = pair.split_once(',').map(|(a, b)| [a.trim(), b.trim()]);
        found.ok_or_else(|| usage(format!("{flag} {pair}: not two names with a comma between")))
    };
    given.iter().map(names).collect()
}
