//! Reports about parts of a surface that cannot be offset, computed once for all queries.

use std::sync::Mutex;

use colltrans::Solid;

use crate::numbers::count_text;

/// Maximum number of stored reports. Tolerances are few, because they follow from the files or an option.
const MAX_REPORTS: usize = 16;
/// Offsets below this share of the part's largest coordinate only compensate for the rounding of poses.
const ROUNDING_SHARE: f64 = 1.0 / (1_u64 << 32) as f64;

/// Reports of one part by the amount of its offset.
#[derive(Debug, Default)]
pub(super) struct Reports(Mutex<Vec<(f64, Option<String>)>>);

impl Reports {
    /// Describes what cannot be offset by an amount; `None` if all can. The search for walls that pass through each other
    /// costs more than a query, so it runs once for each amount.
    pub(super) fn report(&self, solid: &Solid, amount: f64) -> Option<String> {
        let amount = cache_amount(solid, amount);
        // The lock is held during the search, so that other threads wait instead of repeating it.
        let mut reports = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some((_, report)) = reports.iter().find(|(of, _)| *of == amount) {
            return report.clone();
        }
        let report = offset_report(solid, amount);
        if reports.len() == MAX_REPORTS {
            reports.remove(0);
        }
        reports.push((amount, report.clone()));
        report
    }
}

/// Returns the amount, rounded up to a power of two if it only compensates for rounding, which differs from pose to pose.
fn cache_amount(solid: &Solid, amount: f64) -> f64 {
    let bounds = solid.bounds();
    let size = bounds.low.abs().max(bounds.high.abs()).max_element();
    if amount < ROUNDING_SHARE * size { amount.log2().ceil().exp2() } else { amount }
}

/// Describes what cannot be offset by an amount; `None` if all can.
fn offset_report(solid: &Solid, amount: f64) -> Option<String> {
    let report = solid.shrink_report(amount);
    let mut text = Vec::new();
    if let Some(first) = report.fixed_vertices.first() {
        let (one, many) = ("vertex stays in place", "vertices stay in place");
        let vertices = count_text(report.fixed_vertices.len(), one, many);
        text.push(format!("{vertices}, for example at a saddle (vertex {first})"));
    }
    if let Some(first) = report.inverted.first() {
        let one = "face turns inside out or passes through another";
        let many = "faces turn inside out or pass through others";
        let faces = count_text(report.inverted.len(), one, many);
        text.push(format!(
            "{faces}, because the part is thinner than the tolerance (face {first})"
        ));
    }
    (!text.is_empty()).then(|| text.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use colltrans::ConvexPolyhedron;
    use colltrans::glam::DVec3;

    #[test]
    fn report_is_computed_once_per_amount() {
        let plate = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(8.0, 8.0, 1e-3)).unwrap();
        let plate = Solid::from_convex(&plate).unwrap();
        let reports = Reports::default();
        let count = || reports.0.lock().unwrap().len();
        for _ in 0..100 {
            assert_eq!(reports.report(&plate, 1e-4), None);
            assert!(reports.report(&plate, 1e-3).unwrap().contains("thinner than the tolerance"));
        }
        assert_eq!(count(), 2);
        // Amounts that differ only by the rounding of poses share a report.
        for k in 0..100 {
            assert_eq!(reports.report(&plate, 1.1e-14 + 1e-18 * f64::from(k)), None);
        }
        assert_eq!(count(), 3);
        for k in 0..100 {
            reports.report(&plate, 1e-5 * f64::from(k + 1));
        }
        assert_eq!(count(), MAX_REPORTS);
    }
}
