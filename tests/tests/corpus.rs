//! Inputs that once were at fault, and some new ones: each is taken, or told what is wrong with it.
#![allow(clippy::unwrap_used, clippy::panic)]

use fissure_tests::fuzz::{Bench, Target};
use std::path::Path;

/// Truth: `expected.tsv` beside the inputs, written by hand: what each must give.
#[test]
fn inputs_of_the_corpus_give_what_they_must() {
    let bench = Bench::new();
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    let expected = std::fs::read_to_string(corpus.join("expected.tsv")).unwrap();
    let mut wrong = Vec::new();
    for (file, words) in expected.lines().filter_map(|line| line.split_once('\t')) {
        let target = Target::named(file.split('/').next().unwrap()).unwrap();
        let given = match bench.run(target, &std::fs::read(corpus.join(file)).unwrap()) {
            Ok(()) => "accepted".to_owned(),
            Err(refusal) => refusal,
        };
        if !given.contains(words) {
            wrong.push(format!("{file}: {given}, not {words}"));
        }
    }
    let files: usize = std::fs::read_dir(&corpus)
        .unwrap()
        .flatten()
        .filter(|entry| entry.path().is_dir())
        .map(|folder| std::fs::read_dir(folder.path()).unwrap().count())
        .sum();
    assert_eq!(files, expected.lines().count(), "expected.tsv has a line for each input");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Truth: a panic is a mistake, whatever the input. The formats of states and frames change, so inputs for them are
/// made anew.
#[test]
fn new_inputs_are_taken_or_told() {
    let bench = Bench::new();
    for target in Target::ALL {
        for index in 0..150 {
            if let Err(refusal) = bench.run(target, &bench.input(target, 7, index)) {
                assert!(refusal.len() > 5, "{} {index}: {refusal}", target.name());
            }
        }
    }
}
