//! The corpora of the fuzz targets of readers as ordinary tests. A finding becomes one more file.

use colltrans_testkit::oracle::fuzz::corpus;

#[path = "../../../../fuzz/readers.rs"]
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
