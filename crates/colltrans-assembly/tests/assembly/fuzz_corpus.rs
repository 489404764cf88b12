//! Runs the corpora of the fuzz targets of readers as ordinary tests. Each finding is added as a file.

use colltrans_testkit::oracle::fuzz::corpus;

#[path = "../../../../fuzz/readers.rs"]
#[allow(dead_code, reason = "the JSON documents belong to other targets")]
mod readers;

/// Numbers that are too large, negative, or out of range of a double.
const NUMBERS: [&[u8]; 4] = [b"18446744073709551615", b"4294967295", b"-1", b"1e999"];

/// Calls the target with the file truncated or changed at each byte, and with each of its numbers replaced.
fn run_on_mutations(seed: &[u8], mut target: impl FnMut(&[u8])) {
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

/// Runs a target over every file of its corpus; small files are also mutated.
fn run_on_corpus(name: &str, target: fn(&[u8]), at_least: usize) {
    for seed in corpus(name, at_least) {
        target(&seed);
        if seed.len() < 4_096 {
            run_on_mutations(&seed, target);
        }
    }
}

#[test]
fn readers_handle_corpora_and_mutations() {
    run_on_corpus("threemf", readers::threemf, 4);
    run_on_corpus("gltf", readers::gltf, 4);
    run_on_corpus("urdf", readers::urdf, 3);
    run_on_corpus("manifest", readers::manifest, 3);
}

type Target = fn(&[u8]);

/// Runs generated files from pseudo-random bytes, and files that once broke a reader.
#[test]
fn generated_files_are_read_or_rejected() {
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
