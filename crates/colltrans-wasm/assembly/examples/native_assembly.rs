//! The same answers without a browser, a line each ([`lines`]).
//!
//! `cargo run --profile native -p colltrans-wasm-assembly --example native_assembly < questions > answers`

#[path = "../../examples/lines/mod.rs"]
mod lines;

fn main() -> std::io::Result<()> {
    let mut state = colltrans_wasm_assembly::State::default();
    lines::answer(|question, file| state.ask(question, file).text)
}
