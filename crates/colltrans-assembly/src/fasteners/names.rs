//! Kinds and sizes in the names of parts.
//!
//! A name is divided into words of letters and numbers. A kind is a word of [`WORDS`], or the number of a standard
//! after `iso`, `din` or `en`. A size is `M5` or `M5x20`, with or without spaces and a pitch between.

use super::FastenerKind;

/// Words and the kinds that they name. Longer words that begin with them count, for example `screws`.
const WORDS: [(&str, FastenerKind); 27] = [
    ("screw", FastenerKind::Screw),
    ("bolt", FastenerKind::Screw),
    ("schraube", FastenerKind::Screw),
    ("vis", FastenerKind::Screw),
    ("nut", FastenerKind::Nut),
    ("hexnut", FastenerKind::Nut),
    ("mutter", FastenerKind::Nut),
    ("ecrou", FastenerKind::Nut),
    ("washer", FastenerKind::Washer),
    ("unterlegscheibe", FastenerKind::Washer),
    ("rondelle", FastenerKind::Washer),
    ("dowel", FastenerKind::Dowel),
    ("zylinderstift", FastenerKind::Dowel),
    ("passstift", FastenerKind::Dowel),
    ("goupille", FastenerKind::Dowel),
    ("circlip", FastenerKind::Circlip),
    ("snapring", FastenerKind::Circlip),
    ("sicherungsring", FastenerKind::Circlip),
    ("seegerring", FastenerKind::Circlip),
    ("key", FastenerKind::Key),
    ("passfeder", FastenerKind::Key),
    ("bearing", FastenerKind::Bearing),
    ("ballbearing", FastenerKind::Bearing),
    ("kugellager", FastenerKind::Bearing),
    ("lager", FastenerKind::Bearing),
    ("capscrew", FastenerKind::Screw),
    ("setscrew", FastenerKind::Screw),
];
/// Pairs of words and the kinds that they name.
const PAIRS: [([&str; 2], FastenerKind); 4] = [
    (["snap", "ring"], FastenerKind::Circlip),
    (["retaining", "ring"], FastenerKind::Circlip),
    (["parallel", "pin"], FastenerKind::Dowel),
    (["dowel", "pin"], FastenerKind::Dowel),
];
/// Numbers of ISO, DIN and EN standards.
const STANDARDS: [(u32, FastenerKind); 36] = [
    (4762, FastenerKind::Screw),
    (912, FastenerKind::Screw),
    (7984, FastenerKind::Screw),
    (10642, FastenerKind::Screw),
    (7991, FastenerKind::Screw),
    (7380, FastenerKind::Screw),
    (4014, FastenerKind::Screw),
    (4017, FastenerKind::Screw),
    (931, FastenerKind::Screw),
    (933, FastenerKind::Screw),
    (4026, FastenerKind::Screw),
    (4027, FastenerKind::Screw),
    (913, FastenerKind::Screw),
    (914, FastenerKind::Screw),
    (7045, FastenerKind::Screw),
    (7985, FastenerKind::Screw),
    (963, FastenerKind::Screw),
    (965, FastenerKind::Screw),
    (4032, FastenerKind::Nut),
    (4035, FastenerKind::Nut),
    (934, FastenerKind::Nut),
    (439, FastenerKind::Nut),
    (985, FastenerKind::Nut),
    (7089, FastenerKind::Washer),
    (7090, FastenerKind::Washer),
    (7093, FastenerKind::Washer),
    (125, FastenerKind::Washer),
    (2338, FastenerKind::Dowel),
    (8734, FastenerKind::Dowel),
    (6325, FastenerKind::Dowel),
    (471, FastenerKind::Circlip),
    (472, FastenerKind::Circlip),
    (773, FastenerKind::Key),
    (6885, FastenerKind::Key),
    (625, FastenerKind::Bearing),
    (15, FastenerKind::Bearing),
];
/// Words after that of a fastener which name another part: pieces of bearings, tools, and places.
const OTHERS: [&str; 14] = [
    "hole", "plate", "block", "inner", "outer", "ball", "cage", "race", "housing", "holder",
    "driver", "cover", "head", "cap",
];

/// The kind and the size that a name states.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct NamedFastener {
    /// The kind.
    pub(super) kind: Option<FastenerKind>,
    /// Nominal diameter of a metric thread in millimetres.
    pub(super) diameter: Option<f64>,
}

/// Returns the kind and the size that a name states.
pub(super) fn read_name(name: &str) -> NamedFastener {
    let words = split_words(name);
    let diameter = words.windows(2).find_map(|pair| match pair {
        [m, number] if m == "m" => number.parse().ok().filter(|d| (1.0..=64.0).contains(d)),
        _ => None,
    });
    let standard = words.windows(2).find_map(|pair| {
        let is_standard = ["iso", "din", "en"].contains(&&pair[0][..]);
        let number: u32 = pair[1].parse().ok().filter(|_| is_standard)?;
        STANDARDS.iter().find(|(known, _)| *known == number).map(|(_, kind)| *kind)
    });
    let pair = || {
        let found = |pair: &[String]| {
            PAIRS.iter().find(|(known, _)| known[0] == pair[0] && known[1] == pair[1])
        };
        words.windows(2).find_map(found).map(|(_, kind)| *kind)
    };
    let word = || {
        let is_named =
            |word: &String, known: &str| word == known || word.strip_suffix('s') == Some(known);
        let found = |word: &String| WORDS.iter().find(|(known, _)| is_named(word, known));
        let nouns = words.iter().rev().take_while(|word| !OTHERS.contains(&&word[..]));
        nouns.into_iter().find_map(found).map(|(_, kind)| *kind)
    };
    // `M5x20` is a screw: only screws have a length.
    let sized = || {
        let is_sized = |w: &[String]| w[0] == "m" && w[2] == "x" && w[3].parse::<f64>().is_ok();
        words.windows(4).any(is_sized).then_some(FastenerKind::Screw)
    };
    let kind = standard.or_else(pair).or_else(word).or_else(sized);
    NamedFastener { kind, diameter }
}

/// Splits a name into lower-case words of letters, and numbers with a decimal point.
fn split_words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut last = None;
    for c in name.chars().flat_map(char::to_lowercase) {
        let is_number = c.is_ascii_digit() || (c == '.' && last == Some(true));
        let kind = (is_number || c.is_alphabetic()).then_some(is_number);
        match (kind, words.last_mut()) {
            (Some(_), Some(word)) if kind == last => word.push(c),
            (Some(_), _) => words.push(c.into()),
            (None, _) => (),
        }
        last = kind;
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_state_kinds_and_sizes() {
        use FastenerKind::{Bearing, Circlip, Dowel, Key, Nut, Screw, Washer};
        let cases = [
            ("ISO 4762 M8x1.25 x 30", Some(Screw), Some(8.0)),
            ("DIN912-M5x20", Some(Screw), Some(5.0)),
            ("m5x20_1", Some(Screw), Some(5.0)),
            ("M2.5 nut", Some(Nut), Some(2.5)),
            ("keeper_screw_1", Some(Screw), None),
            ("screw_plate", None, None),
            ("plate_screw", Some(Screw), None),
            ("washer_00", Some(Washer), None),
            ("Nuts", Some(Nut), None),
            ("dowel_2", Some(Dowel), None),
            ("retaining ring", Some(Circlip), None),
            ("keyboard", None, None),
            ("key", Some(Key), None),
            ("bearing_ball_00", None, None),
            ("Bearing 608", Some(Bearing), None),
            ("walnut", None, None),
            ("m5", None, Some(5.0)),
            ("", None, None),
        ];
        for (name, kind, diameter) in cases {
            assert_eq!(read_name(name), NamedFastener { kind, diameter }, "{name}");
        }
    }
}
