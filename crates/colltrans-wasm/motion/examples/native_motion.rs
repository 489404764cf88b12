//! The same answers without a browser, a line each ([`lines`]).
//!
//! `cargo run --profile native -p colltrans-wasm-motion --example native_motion < questions > answers`

#[path = "../../examples/lines/mod.rs"]
mod lines;

fn main() -> std::io::Result<()> {
    let mut state = colltrans_wasm_motion::State::default();
    lines::answer(|question, file| state.ask(question, file).text)
}
