//! Progress bars for work that takes long: on standard error, and only where that is a terminal.

use std::io::{self, IsTerminal};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// A bar in a look of its own.
pub(crate) fn bar(length: Option<u64>, template: &str) -> ProgressBar {
    if !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = length.map_or_else(ProgressBar::no_length, ProgressBar::new);
    let style = ProgressStyle::with_template(template);
    bar.set_style(style.unwrap_or(ProgressStyle::default_bar()));
    bar
}

/// A bar over a number of steps, any of which may take long.
pub(crate) fn steps(count: usize, what: &str) -> ProgressBar {
    let template = "{spinner} {msg} {wide_bar} {pos}/{len} {elapsed}";
    let bar = bar(Some(count as u64), template).with_message(what.to_owned());
    bar.enable_steady_tick(Duration::from_millis(120));
    bar
}
