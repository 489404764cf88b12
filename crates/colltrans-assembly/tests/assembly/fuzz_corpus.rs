//! The corpora of the fuzz targets of readers as ordinary tests. A finding becomes one more file.

use colltrans_testkit::oracle::fuzz::corpus;

#[path = "../../../../fuzz/readers.rs"]
#[allow(dead_code, reason = "documents in JSON are those of other targets")]
mod readers;

/// Numbers that are too large, too small, none.
const NUMBERS: [&[u8]; 4] = [b"18446744073709551615", b"4294967295", b"-1", b"1e999"];

/// The file, cut and changed in one place after another, and each of its numbers replaced.
fn changed(seed: &[u8], mut target: impl FnMut(&[u8])) {
    for at in 0..seed.len() {
        target(&seed[..at]);
        for byte in [seed[at] ^ 0x80, seed[at] ^ 1, b'9', b'<', b'"'] {
            let mut bytes = seed.to_vec();
            bytes[at] = byte;
            target(&bytes);
        }
        let begins = seed[at].is_ascii_digit() && (at == 0 || !seed[at - 1].is_ascii_digit());
        let end = seed[at..].iter().position(|b| !b.is_ascii_digit());
        if let (true, Some(end)) = (begins, end) {
            for number in NUMBERS {
                target(&[&seed[..at], number, &seed[at + end..]].concat());
            }
        }
    }
}

/// Runs a target over every file of its corpus, as it is and changed.
fn replay(name: &str, target: fn(&[u8]), at_least: usize) {
    for seed in corpus(name, at_least) {
        target(&seed);
        if seed.len() < 4_096 {
            changed(&seed, target);
        }
    }
}

#[test]
fn corpora_of_readers() {
    replay("threemf", readers::threemf, 4);
    replay("gltf", readers::gltf, 4);
    replay("urdf", readers::urdf, 3);
    replay("manifest", readers::manifest, 3);
}

type Target = fn(&[u8]);

/// Files that each generator writes from arbitrary bytes, and those that once broke a reader.
#[test]
fn generated_files_of_each_format_are_read_or_refused() {
    let targets: [(&str, Target); 7] = [
        ("stl", readers::stl),
        ("obj", readers::obj),
        ("ply", readers::ply),
        ("off", readers::off),
        ("dae", readers::dae),
        ("srdf", readers::srdf),
        ("csv", readers::csv),
    ];
    for (name, target) in targets {
        let mut state = 1_u64;
        for _ in 0..2_000 {
            let mut bytes = vec![1];
            for _ in 0..96 {
                // Knuth's linear congruential generator.
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                bytes.extend((state >> 32).to_le_bytes()[..4].iter());
            }
            target(&bytes);
        }
        for seed in corpus(name, 1) {
            target(&seed);
        }
    }
}
