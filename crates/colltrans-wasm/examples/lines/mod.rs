//! One question a line in, one answer a line out.
//!
//! A line is `FILE<tab>QUESTION` for a question that comes with a file, else the question alone.

use std::io::{self, BufRead as _, Write as _};

/// Answers all lines; `ask` has the text of an answer.
pub(crate) fn answer(mut ask: impl FnMut(&[u8], Vec<u8>) -> Vec<u8>) -> io::Result<()> {
    let mut out = io::BufWriter::new(io::stdout());
    for line in io::stdin().lock().lines() {
        let line = line?;
        let (file, question) = match line.split_once('\t') {
            Some((path, question)) => (std::fs::read(path)?, question),
            None => (Vec::new(), line.as_str()),
        };
        out.write_all(&ask(question.as_bytes(), file))?;
        out.write_all(b"\n")?;
    }
    out.flush()
}
