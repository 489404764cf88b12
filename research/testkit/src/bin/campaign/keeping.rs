//! Casts that keep a gap: settings as they are drawn, with gaps from rounding errors to many times the bodies,
//! and those at which bodies graze or begin.

use colltrans::{Cast, Clearance, Outcome, Pair, QueryError};
use colltrans_testkit::oracle::check::Objection;
use colltrans_testkit::oracle::keep::Judge;
use colltrans_testkit::oracle::settings::setting;
use colltrans_testkit::random::Random;

/// Bounds that are so many noises over `n.d` apart are counted.
const WIDE: f64 = 6.0;

/// What became of the settings of one family.
#[derive(Debug, Default, Clone)]
pub(crate) struct Tally {
    settings: u64,
    contacts: u64,
    grazing: u64,
    separated: u64,
    blocked: u64,
    nearer: u64,
    /// Without an answer: nothing is claimed of them.
    open: u64,
    /// The most that bounds are apart, in noises over `n.d`.
    widest: f64,
    wide: u64,
    looks: u64,
    most_looks: u32,
    disagreements: Vec<String>,
}

impl crate::Tally for Tally {
    const CHUNK: u64 = 64;

    fn header() -> String {
        let heads = ["settings", "contacts", "grazing", "separated", "blocked", "nearer"];
        let rest = ["widest", "wide", "looks", "most", "open", "wrong"];
        let heads = heads.iter().chain(&rest);
        heads.map(|head| format!("{head:>9} ")).collect::<Vec<_>>().concat()
    }

    fn line(&self) -> String {
        let looks = self.looks as f64 / self.contacts.max(1) as f64;
        let counts =
            [self.settings, self.contacts, self.grazing, self.separated, self.blocked, self.nearer]
                .map(|count| format!("{count:>9} "))
                .concat();
        let Self { widest, wide, most_looks, open, .. } = self;
        let wrong = self.disagreements.len();
        format!(
            "{counts}{widest:>9.2} {wide:>9} {looks:>9.2} {most_looks:>9} {open:>9} {wrong:>9} "
        )
    }

    fn merge(mut self, other: Self) -> Self {
        self.settings += other.settings;
        self.contacts += other.contacts;
        self.grazing += other.grazing;
        self.separated += other.separated;
        self.blocked += other.blocked;
        self.nearer += other.nearer;
        self.open += other.open;
        self.widest = self.widest.max(other.widest);
        self.wide += other.wide;
        self.looks += other.looks;
        self.most_looks = self.most_looks.max(other.most_looks);
        self.disagreements.extend(other.disagreements);
        self
    }

    fn disagreements(&self) -> &[String] {
        &self.disagreements
    }
}

/// Casts the bodies of a setting, and judges the answers.
pub(crate) fn examine(family: &str, seed: u64, tally: &mut Tally) {
    let setting = setting(family, seed);
    tally.settings += 1;
    let Ok(bodies) = setting.bodies() else { return };
    let mut random = Random::new(seed ^ 0x6a9);
    let Ok(cast) = setting.query(&bodies) else { return };
    let gap = gap(&cast, &mut random);
    if let Err(objection) = judge(&cast, gap, tally) {
        tally.disagreements.push(format!("{setting} {gap:e} {objection}"));
    }
}

/// None, of rounding errors, a share or a multiple of the size, or one at which something is tied.
fn gap(cast: &Cast, random: &mut Random) -> f64 {
    let reach = |body: &colltrans::ConvexPolyhedron| {
        body.vertices().iter().map(|v| v.length()).fold(0.0, f64::max)
    };
    let size = (reach(cast.moving()) + reach(cast.fixed())).max(1e-50);
    let gap = match random.index(10) {
        0 => 0.0,
        1 => size * f64::EPSILON * random.range(0.0, 400.0),
        2 => size * 1e-9,
        3 => size * 10.0_f64.powf(random.range(-14.0, 0.0)),
        4 => size * 10.0_f64.powf(random.range(0.0, 4.0)),
        5 => random.pick(&[0.125, 0.25, 0.5, 1.0, 2.0]),
        6 | 7 => size * random.range(0.0, 1.0),
        // That of the shadows, or at the start, and next to it.
        kind => {
            let tied = if kind == 8 {
                Judge::new(*cast).shadows
            } else {
                let pair = Pair::new(
                    cast.moving().at(cast.moving_pose()),
                    cast.fixed().at(cast.fixed_pose()),
                );
                pair.ok().and_then(|pair| pair.distance().ok()).map_or(0.0, |found| found.upper)
            };
            tied * (1.0 + random.pick(&[0.0, 0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-7, -1e-7]))
        }
    };
    gap.clamp(0.0, 1e58)
}

fn judge(cast: &Cast, gap: f64, tally: &mut Tally) -> Result<(), Objection> {
    let error = |e: &dyn std::fmt::Display| Objection(e.to_string());
    let kept = cast.keeping(gap).map_err(|e| error(&e))?;
    if gap == 0.0 && kept.first_contact() != cast.first_contact() {
        return Err(Objection("a gap of 0 is none".into()));
    }
    let judge = Judge::new(kept);
    let (outcome, clearance) = match (kept.first_contact(), kept.clearance()) {
        (Ok(outcome), Ok(clearance)) => (outcome, clearance),
        (Err(QueryError::NotConverged { .. }), _) | (_, Err(QueryError::NotConverged { .. })) => {
            tally.open += 1;
            return Ok(());
        }
        (Err(e), _) | (_, Err(e)) => return Err(error(&e)),
    };
    let noises = judge.check(&outcome)?.noises;
    judge.check_clearance(&clearance)?;
    match &outcome {
        Outcome::Contact(contact) => {
            tally.contacts += 1;
            tally.looks += u64::from(contact.steps.pivots);
            tally.most_looks = tally.most_looks.max(contact.steps.pivots);
            tally.widest = tally.widest.max(noises);
            tally.wide += u64::from(noises > WIDE);
        }
        Outcome::Grazing(_) => tally.grazing += 1,
        Outcome::Separated(_) => tally.separated += 1,
    }
    tally.blocked += u64::from(matches!(clearance, Clearance::Blocked { .. }));
    tally.nearer += u64::from(matches!(clearance, Clearance::Overlapping(_)));
    Ok(())
}
