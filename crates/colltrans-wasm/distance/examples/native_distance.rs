//! The same answers without a browser, a line each ([`lines`]).
//!
//! `cargo run --profile native -p colltrans-wasm-distance --example native_distance < questions > answers`

#[path = "../../examples/lines/mod.rs"]
mod lines;

fn main() -> std::io::Result<()> {
    let mut state = colltrans_wasm_distance::State::default();
    lines::answer(|question, file| state.ask(question, file).text)
}
