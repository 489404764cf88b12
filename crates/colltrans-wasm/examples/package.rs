//! Describes the answers of the npm package (`--describe`), or answers its questions without WebAssembly.
//!
//! The argument `colltrans` or `colltrans/cast` names the library. A question on the standard input is the length of its
//! numbers and of the arrays behind them, 32 bits each, then both. An answer on the standard output has the same form:
//! text and numbers.
//!
//! `cargo run --profile native --features min-gap --example package -- colltrans < questions > answers`

use std::error::Error;
use std::io::{self, Read, Write as _};

use colltrans_wasm::Answers;
use colltrans_wasm::package::{Bodies, Casts, Question, answers};

fn main() -> Result<(), Box<dyn Error>> {
    match std::env::args().nth(1).as_deref() {
        Some("--describe") => {
            let questions: Vec<String> =
                Question::ALL.iter().map(|(name, number)| format!("{name:?}:{number}")).collect();
            let description = answers::description();
            println!("{{\"questions\":{{{}}},\"answers\":{description}}}", questions.join(","));
            Ok(())
        }
        Some("colltrans") => Ok(answer(Bodies::default())?),
        Some("colltrans/cast") => Ok(answer(Casts::default())?),
        _ => Err("accepted are --describe, colltrans and colltrans/cast".into()),
    }
}

/// Answers the questions of the standard input.
fn answer(mut state: impl Answers) -> io::Result<()> {
    let mut input = Vec::new();
    io::stdin().lock().read_to_end(&mut input)?;
    let mut rest = input.as_slice();
    let mut out = io::BufWriter::new(io::stdout());
    while !rest.is_empty() {
        let mut lengths = [[0; 4]; 2];
        for length in &mut lengths {
            rest.read_exact(length)?;
        }
        let [numbers, arrays] = lengths.map(|length| u32::from_le_bytes(length) as usize);
        let mut question = vec![0; numbers];
        rest.read_exact(&mut question)?;
        let mut file = vec![0; arrays];
        rest.read_exact(&mut file)?;
        let answer = state.ask(&question, file);
        for part in [&answer.text, &answer.numbers] {
            out.write_all(&(part.len() as u32).to_le_bytes())?;
        }
        out.write_all(&answer.text)?;
        out.write_all(&answer.numbers)?;
    }
    out.flush()
}
