//! The page of promises names tests that exist.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(file: &str) -> Result<String, String> {
    std::fs::read_to_string(root().join(file)).map_err(|error| format!("{file}: {error}"))
}

/// Rows `(promise, test)` of all tables of a page; a row that does not have these two cells is an error.
fn rows(page: &str) -> Result<Vec<(&str, &str)>, String> {
    let is_row = |line: &&str| line.starts_with('|') && !line.starts_with("|---") && *line != "| promise | test |";
    let row = |line| -> Result<(&str, &str), String> {
        let inner = str::strip_prefix(line, "| ").and_then(|rest| rest.strip_suffix(" |"));
        let cells = inner.and_then(|inner| inner.rsplit_once(" | "));
        let named = cells.and_then(|(promise, test)| Some((promise, test.strip_prefix('`')?.strip_suffix('`')?)));
        named.ok_or_else(|| format!("not a row of a promise and a test in backticks: {line}"))
    };
    page.lines().filter(is_row).map(row).collect()
}

/// Whether `source` defines the test `name`: a function below an attribute `#[test]`, other attributes between them.
fn defines(source: &str, name: &str) -> bool {
    let head = format!("fn {name}(");
    let mut is_test = false;
    source.lines().map(str::trim).any(|line| {
        let found = is_test && line.starts_with(&head);
        is_test = line == "#[test]" || is_test && (line.starts_with("#[") || line.starts_with("//"));
        found
    })
}

/// What is wrong with the test that a promise names.
fn fault(test: &str, ci: &str) -> Option<String> {
    let Some((file, name)) = test.split_once("::") else {
        let script = Path::new(test).file_name().unwrap_or_default().to_string_lossy();
        let called = root().join(test).is_file() && ci.contains(script.as_ref());
        return (!called).then(|| format!("`{test}` is no script that .ci/run calls"));
    };
    match read(file) {
        Ok(source) => (!defines(&source, name)).then(|| format!("{file} has no test `{name}`")),
        Err(error) => Some(error),
    }
}

/// Truth: the sources themselves.
#[test]
fn every_promise_names_a_test_that_exists() {
    let (page, ci) = (read("docs/promises.md").unwrap(), read(".ci/run").unwrap());
    let rows = rows(&page).unwrap();
    assert!(rows.len() > 20, "only {} promises are found on the page", rows.len());
    let faults: Vec<String> = rows.iter().filter_map(|(_, test)| fault(test, &ci)).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn tests_that_do_not_exist_are_found_out() {
    let source =
        "#[test]\nfn there() {}\nfn helper() {}\n#[cfg(unix)]\n#[test]\n#[ignore]\nfn slow() {}\n// fn gone() {}";
    for (name, is_there) in [("there", true), ("slow", true), ("helper", false), ("gone", false), ("the", false)] {
        assert_eq!(defines(source, name), is_there, "{name}");
    }
    assert!(rows("| promise | test |\n|---|---|\n| a | no test |").is_err());
    assert!(fault("pipeline/checks/no_such.py", "no_such.py").is_some());
    assert!(fault("crates/no_such.rs::test", "").is_some());
}
