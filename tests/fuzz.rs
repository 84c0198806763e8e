//! The fuzzers' targets on ordinary tests' terms: what the fuzzers once found, texts of the fixtures with bytes changed, and random
//! bytes, as many as `PENUMBRAL_CASES` says from seed `PENUMBRAL_SEED` on. `fuzz/run.sh` runs the fuzzers themselves.

#![expect(clippy::unwrap_used, reason = "a case that is refused fails the test")]

#[expect(dead_code, reason = "other tests take more of it")]
mod common;
#[path = "../fuzz/targets.rs"]
mod targets;

use std::fs;
use std::panic::catch_unwind;
use std::path::Path;

use common::{Random, seeds};
use targets::TARGETS;

fn random_bytes(random: &mut Random) -> Vec<u8> {
    let length = 4 + random.below(150);
    (0..length).map(|_| random.next() as u8).collect()
}

/// A text with some bytes changed, taken out or put in, and pieces of it twice or elsewhere.
fn changed(text: &str, random: &mut Random) -> Vec<u8> {
    const PIECES: [&str; 16] = [
        "-",
        "1e9",
        "1e-9",
        "0",
        ".",
        ",",
        "\"",
        "[",
        "]",
        "{",
        "}",
        "z",
        "A",
        "NaN",
        "null",
        "\u{1f300}",
    ];
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..1 + random.below(4) {
        let at = random.below(bytes.len().max(1));
        let end = (at + random.below(12)).min(bytes.len());
        match random.below(5) {
            0 => drop(bytes.drain(at..end)),
            1 => bytes[at..end]
                .iter_mut()
                .for_each(|byte| *byte = byte.wrapping_add(1)),
            2 => {
                let piece = bytes[at..end].to_vec();
                let to = random.below(bytes.len().max(1));
                bytes.splice(to..to, piece);
            }
            3 => bytes.truncate(at),
            _ => drop(bytes.splice(at..end, random.pick(&PIECES).bytes())),
        }
    }
    bytes
}

/// Small scenes and paths to be changed.
fn texts(name: &str) -> Vec<String> {
    match name {
        "scene_json" => vec![
            r##"{"canvas": [60, 40], "background": "#eee", "scale": 1, "light": {"x": 30, "y": 20, "z": 600, "radius": 800}, "key": 0.2, "ambient": 0.05, "surfaces": [
            {"shape": "rrect", "x": 10, "y": 10, "w": 40, "h": 20, "radius": 4, "elevation": 8, "opacity": 0.9, "fill": "#ff0000"},
            {"shape": "path", "d": "M3 3h20v9a4 4 0 0 1-8 2z", "fill_rule": "evenodd", "elevation": 2}]}"##.to_owned(),
            r#"{"canvas": [99, 9], "light": {"x": 3, "y": 2, "z": 60, "radius": 8}, "surfaces": [
            {"shape": "circle", "cx": 1, "cy": 2, "r": 3, "elevation": 1}, {"shape": "ellipse", "cx": 9, "cy": 5, "rx": 4, "ry": 2, "elevation": 3},
            {"shape": "polygon", "rings": [[[0,0],[9,0],[0,9]],[[1,1],[2,1],[1,2]]], "elevation": 5}]}"#.to_owned(),
        ],
        "svg_path" => {
            let lines = include_str!("../fixtures/icons.tsv").lines();
            lines.map(|line| line.split('\t').nth(1).unwrap().to_owned()).collect()
        }
        _ => Vec::new(),
    }
}

#[test]
fn nothing_that_is_fuzzed_fails() {
    let cases = seeds("each target", 60);
    let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds");
    let mut seeded = 0;
    for (name, target) in TARGETS {
        let kept = seeds.join(name);
        let mut inputs: Vec<Vec<u8>> = Vec::new();
        if kept.exists() {
            let files = fs::read_dir(kept).unwrap();
            inputs.extend(files.map(|file| fs::read(file.unwrap().path()).unwrap()));
            assert!(!inputs.is_empty(), "{name}: no seeds in its folder");
            seeded += 1;
        }
        let texts = texts(name);
        inputs.extend(cases.clone().map(|seed| {
            let mut random = Random::new(seed as u64);
            if texts.is_empty() || random.chance(0.02) {
                random_bytes(&mut random)
            } else {
                let text = &texts[random.below(texts.len())];
                changed(text, &mut random)
            }
        }));
        for input in &inputs {
            let outcome = catch_unwind(|| target(input));
            assert!(outcome.is_ok(), "{name}: {input:?}");
        }
        println!("{name}: {} inputs", inputs.len());
    }
    // None was passed by for being called otherwise than its target.
    assert!(seeded > 0);
    assert_eq!(seeded, fs::read_dir(seeds).unwrap().count());
}
