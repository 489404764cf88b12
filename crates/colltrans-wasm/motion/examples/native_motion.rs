//! The same answers without a browser: one question a line in, one answer a line out.
//!
//! A line is `FILE<tab>QUESTION` for a question that comes with a file, else the question alone.
//! `cargo run --profile native -p colltrans-wasm-motion --example native_motion < questions > answers`

use std::io::{self, BufRead as _, Write as _};

use colltrans_wasm_motion::State;

fn main() -> io::Result<()> {
    let mut state = State::default();
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
