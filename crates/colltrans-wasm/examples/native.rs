//! The same answers without a browser, a line each ([`lines`]).
//!
//! `cargo run --profile native --example native < questions > answers`

mod lines;

fn main() -> std::io::Result<()> {
    let mut state = colltrans_wasm::State::default();
    lines::answer(|question, file| state.ask(question, file).text)
}
