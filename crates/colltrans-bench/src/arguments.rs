//! The command line of the measuring programs.

use std::process::ExitCode;

/// What to measure, and where to write it.
#[derive(Debug, Clone, PartialEq)]
pub struct Arguments {
    /// Vertices per body.
    pub sizes: Vec<usize>,
    /// Fewer settings.
    pub quick: bool,
    /// A file for the figures, as JSON.
    pub json: Option<String>,
    /// Bodies and settings are drawn from it.
    pub seed: u64,
}

/// Reads the command line and runs a program, or says what is wrong with it.
pub fn start(usage: &str, sizes: &[usize], run: impl Fn(&Arguments) -> ExitCode) -> ExitCode {
    match parse(usage, sizes, std::env::args().skip(1)) {
        Ok(Some(arguments)) => run(&arguments),
        Ok(None) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

/// `None` if only help was asked for.
fn parse(
    usage: &str,
    sizes: &[usize],
    mut words: impl Iterator<Item = String>,
) -> Result<Option<Arguments>, String> {
    let mut arguments = Arguments { sizes: sizes.to_vec(), quick: false, json: None, seed: 1 };
    while let Some(word) = words.next() {
        if word == "--help" || word == "-h" {
            println!("{usage}");
            return Ok(None);
        }
        if word == "--quick" {
            arguments.quick = true;
            continue;
        }
        let value = words.next().ok_or_else(|| format!("{word} needs a value"))?;
        let number = |text: &str| text.parse().map_err(|_| format!("{text} is not a number"));
        match word.as_str() {
            "--sizes" => {
                arguments.sizes = value.split(',').map(number).collect::<Result<_, _>>()?;
            }
            "--seed" => arguments.seed = number(&value)? as u64,
            "--json" => arguments.json = Some(value),
            _ => return Err(format!("unknown option {word}")),
        }
    }
    Ok(Some(arguments))
}
