//! What every report of measurements needs: the clock's own cost, the machine and the date.

use std::fs;
use std::process::ExitCode;
use std::time::{Instant, SystemTime};

use serde_json::{Value, json};

use crate::arguments::Arguments;

/// The least time between two readings of the clock, in nanoseconds.
pub fn clock_cost() -> f64 {
    let once = |_| Instant::now().elapsed().as_nanos();
    (0..64).map(once).min().unwrap_or(0) as f64
}

/// Writes the rows with what they were measured on, if a file was named.
pub fn write(arguments: &Arguments, rows: &[Value]) -> ExitCode {
    let Some(path) = &arguments.json else { return ExitCode::SUCCESS };
    let report =
        json!({ "date": date(), "machine": machine(), "seed": arguments.seed, "rows": rows });
    match fs::write(path, format!("{report:#}\n")) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{path}: {error}");
            ExitCode::FAILURE
        }
    }
}

fn machine() -> Value {
    let cpu = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model =
        cpu.lines().find(|l| l.starts_with("model name")).and_then(|l| l.split(": ").nth(1));
    json!({
        "cpu": model,
        "threads": std::thread::available_parallelism().map_or(1, usize::from),
        "os": std::env::consts::OS,
        "arch": std::env::consts::ARCH,
    })
}

/// Today in UTC, `YYYY-MM-DD` (days to civil date after Howard Hinnant).
fn date() -> String {
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    let days = now.as_secs() / 86_400 + 719_468;
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted_month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted_month + 2) / 5 + 1;
    let month = if shifted_month < 10 { shifted_month + 3 } else { shifted_month - 9 };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    format!("{year}-{month:02}-{day:02}")
}

/// The value below which a share of sorted numbers lies; NaN if there are none.
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    sorted.get((last as f64 * share).round() as usize).copied().unwrap_or(f64::NAN)
}
