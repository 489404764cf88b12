//! Progress bars on standard error, if it is a terminal.

use std::io::{self, IsTerminal};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Returns a bar with this template; hidden if standard error is not a terminal. `length` is `None` if it is unknown.
pub(crate) fn bar_with_template(length: Option<u64>, template: &str) -> ProgressBar {
    if !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = length.map_or_else(ProgressBar::no_length, ProgressBar::new);
    let style = ProgressStyle::with_template(template);
    bar.set_style(style.unwrap_or(ProgressStyle::default_bar()));
    bar
}

/// Returns a bar over a number of steps. Its spinner turns during long steps.
pub(crate) fn step_bar(count: usize, what: &str) -> ProgressBar {
    let template = "{spinner} {msg} {wide_bar} {pos}/{len} {elapsed}";
    let bar = bar_with_template(Some(count as u64), template).with_message(what.to_owned());
    bar.enable_steady_tick(Duration::from_millis(120));
    bar
}
