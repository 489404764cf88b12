//! Answers the page's questions without a browser: reads one question per line and writes one answer per
//! line.
//!
//! A line is `FILE<tab>QUESTION` for a question with a file, otherwise just the question. The argument names
//! the module that answers; the default is `page`.
//!
//! `cargo run --profile native --all-features --example native -- distance < questions > answers`

use std::error::Error;
use std::io::{self, BufRead as _, Write as _};

use colltrans_wasm::{Answers, found, page, picture};

fn main() -> Result<(), Box<dyn Error>> {
    let module = std::env::args().nth(1).unwrap_or_else(|| "page".to_owned());
    match &*module {
        "page" | "all" => answer(page::State::default()),
        "found" => answer(found::State::default()),
        "picture" => answer(picture::State),
        #[cfg(feature = "assembly")]
        "assembly" => answer(colltrans_wasm::assembly::State::default()),
        #[cfg(feature = "min-gap")]
        "motion" => answer(colltrans_wasm::motion::State::default()),
        _ => return Err(format!("{module}: unknown module, or its feature is off").into()),
    }?;
    Ok(())
}

/// Writes the text of the answer to each input line.
fn answer(mut state: impl Answers) -> io::Result<()> {
    let mut out = io::BufWriter::new(io::stdout());
    for line in io::stdin().lock().lines() {
        let line = line?;
        let (file, question) = match line.split_once('\t') {
            Some((path, question)) => (std::fs::read(path)?, question),
            None => (Vec::new(), line.as_str()),
        };
        out.write_all(&state.ask(question.as_bytes(), file).text)?;
        out.write_all(b"\n")?;
    }
    out.flush()
}
