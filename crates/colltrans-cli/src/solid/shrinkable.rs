//! What of a part cannot be shrunk as a tolerance asks for, found once for all questions about it.

use std::sync::Mutex;

use colltrans::Solid;

use crate::numbers::counted;

/// Reports that are kept: tolerances are few, because they come from the files or from an option.
const KEPT: usize = 16;
/// Amounts below this share of the part only make up for the rounding of poses.
const ROUNDING: f64 = 1.0 / (1_u64 << 32) as f64;

/// Reports of one part by the amount that it is shrunk by.
#[derive(Debug, Default)]
pub(super) struct Reports(Mutex<Vec<(f64, Option<String>)>>);

impl Reports {
    /// What cannot be shrunk, in words; `None` if all can. The search for walls that pass through each other
    /// costs more than a question, so it is made once for an amount.
    pub(super) fn of(&self, solid: &Solid, amount: f64) -> Option<String> {
        let amount = shared(solid, amount);
        // Held while the report is made: others who ask for it wait instead of making it, too.
        let mut kept = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some((_, report)) = kept.iter().find(|(of, _)| *of == amount) {
            return report.clone();
        }
        let report = report(solid, amount);
        if kept.len() == KEPT {
            kept.remove(0);
        }
        kept.push((amount, report.clone()));
        report
    }
}

/// The amount, or the next power of two where it only makes up for rounding: that differs from pose to pose.
fn shared(solid: &Solid, amount: f64) -> f64 {
    let bounds = solid.bounds();
    let size = bounds.low.abs().max(bounds.high.abs()).max_element();
    if amount < ROUNDING * size { amount.log2().ceil().exp2() } else { amount }
}

fn report(solid: &Solid, amount: f64) -> Option<String> {
    let report = solid.shrink_report(amount);
    let mut text = Vec::new();
    if let Some(first) = report.stuck.first() {
        let (one, many) = ("vertex stays where it is", "vertices stay where they are");
        let vertices = counted(report.stuck.len(), one, many);
        text.push(format!("{vertices}, as in a saddle (vertex {first})"));
    }
    if let Some(first) = report.inverted.first() {
        let one = "face turns inside out or passes through another";
        let many = "faces turn inside out or pass through others";
        let faces = counted(report.inverted.len(), one, many);
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
    fn a_report_is_made_once_for_an_amount() {
        let plate = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(8.0, 8.0, 1e-3)).unwrap();
        let plate = Solid::from_convex(&plate).unwrap();
        let reports = Reports::default();
        let made = || reports.0.lock().unwrap().len();
        for _ in 0..100 {
            assert_eq!(reports.of(&plate, 1e-4), None);
            assert!(reports.of(&plate, 1e-3).unwrap().contains("thinner than the tolerance"));
        }
        assert_eq!(made(), 2);
        // Poses ask for amounts of about the same rounding.
        for k in 0..100 {
            assert_eq!(reports.of(&plate, 1.1e-14 + 1e-18 * f64::from(k)), None);
        }
        assert_eq!(made(), 3);
        for k in 0..100 {
            reports.of(&plate, 1e-5 * f64::from(k + 1));
        }
        assert_eq!(made(), KEPT);
    }
}
