//! `fuzz TARGET COUNT SEED`: gives `COUNT` inputs of the sequence `SEED` to a target, each within limits of time and
//! memory.
//!
//! The inputs run in a child process. A panic is caught and told; when the child dies, of memory, of an abort, or
//! because an input takes too long, the input is told and a new child goes on after it. Inputs at fault are written to
//! `target/fuzz`. The last line counts; the exit code is 1 when anything was at fault. `fuzz TARGET SECONDS s SEED`
//! runs for a time instead, and `fuzz --again TARGET SEED INDEX` runs one input once more. With `FUZZ_REFUSALS` set,
//! the commonest refusals are listed, each with its number and the first input that gave it.

use cap::Cap;
use fissure_tests::fuzz::{Bench, Target};
use std::alloc::System;
use std::collections::BTreeMap;
use std::io::{Write, stdout};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Memory that one input may take [bytes].
const MEMORY: usize = 500 << 20;
/// Time that one input may take. Nothing takes a tenth of it on an idle machine, and a busy one is slow.
const TIME: Duration = Duration::from_secs(20);
/// Exit code of a child that gave up on an input for its time.
const LATE: i32 = 75;

#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);

/// What a run is asked to do.
#[derive(Debug, Clone, Copy)]
struct Campaign {
    target: Target,
    count: u64,
    seed: u64,
    end: Option<Instant>,
}

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let number = |word: &str| word.parse::<u64>().ok();
    let campaign = |target, count, seed, seconds: Option<&str>| {
        let end = seconds.and_then(number).map(|seconds| Instant::now() + Duration::from_secs(seconds));
        Some(Campaign { target: Target::named(target)?, count, seed: number(seed)?, end })
    };
    let asked = match words.as_slice() {
        ["--child", target, count, seed, from, status] => {
            let (count, from) = (number(count), number(from));
            let campaign = count.and_then(|count| campaign(target, count, seed, None));
            return campaign
                .zip(from)
                .map_or(ExitCode::from(2), |(campaign, from)| child(&campaign, from, Path::new(status)));
        }
        ["--again", target, seed, index] => {
            let campaign = campaign(target, 0, seed, None);
            return campaign.zip(number(index)).map_or(ExitCode::from(2), |(campaign, index)| again(&campaign, index));
        }
        [target, seconds, "s", seed] => campaign(target, u64::MAX, seed, Some(*seconds)),
        [target, count, seed] => number(count).and_then(|count| campaign(target, count, seed, None)),
        _ => None,
    };
    let Some(campaign) = asked else {
        let names: Vec<&str> = Target::ALL.iter().map(|target| target.name()).collect();
        say(&format!("fuzz TARGET COUNT SEED, or fuzz TARGET SECONDS s SEED; targets: {}", names.join(", ")));
        return ExitCode::from(2);
    };
    match watch(&campaign) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            say(&error.to_string());
            ExitCode::from(3)
        }
    }
}

/// Runs one input once more, and keeps it.
fn again(campaign: &Campaign, index: u64) -> ExitCode {
    let bench = Bench::new();
    let input = bench.input(campaign.target, campaign.seed, index);
    if let Ok(file) = keep(campaign, index, &input) {
        say(&file.display().to_string());
    }
    say(&bench.run(campaign.target, &input).err().unwrap_or_else(|| "accepted".to_owned()));
    ExitCode::SUCCESS
}

/// Starts children until all inputs are done; gives whether none was at fault.
fn watch(campaign: &Campaign) -> std::io::Result<bool> {
    let start = Instant::now();
    let folder = working_folder()?;
    let status = folder.path().join("status");
    let mut tally = Tally::default();
    let mut from = 0;
    let (mut aborts, mut late) = (0, 0);
    while from < campaign.count && campaign.end.is_none_or(|end| Instant::now() < end) {
        let count = campaign.end.map_or(campaign.count, |_| from + BATCH);
        let mut child = Command::new(std::env::current_exe()?)
            .args(["--child", campaign.target.name()])
            .args([count.to_string(), campaign.seed.to_string(), from.to_string()])
            .arg(&status)
            // What a child that dies leaves behind goes with our folder.
            .env("TMPDIR", folder.path())
            .spawn()?;
        let end = child.wait()?;
        tally.add(&status.with_extension("tally"));
        if end.success() {
            from = count;
            continue;
        }
        let index = read_index(&status).unwrap_or(from);
        let kind = if end.code() == Some(LATE) { "late" } else { "abort" };
        if kind == "late" {
            late += 1
        } else {
            aborts += 1
        }
        let file = keep(campaign, index, &Bench::new().input(campaign.target, campaign.seed, index))?;
        say(&format!("{kind} ({end}): {}", file.display()));
        tally.done += 1;
        from = index + 1;
    }
    let Tally { done, accepted, panics, slowest: (slowest, slowest_index) } = tally;
    let seconds = start.elapsed().as_secs_f64();
    let name = campaign.target.name();
    say(&format!(
        "{name}: {done} inputs, seed {}, {accepted} accepted, {panics} panics, {aborts} aborts, {late} late, {seconds:.0} s",
        campaign.seed
    ));
    say(&format!("slowest: input {slowest_index}, {slowest} ms"));
    Ok(panics + aborts + late == 0)
}

/// A folder for temporary files: in memory where the system has one there, since a disk is slow to take a file for
/// every input.
fn working_folder() -> std::io::Result<TempDir> {
    tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir())
}

/// Inputs of one child when the time decides.
const BATCH: u64 = 500;

/// What children have done.
#[derive(Debug, Default)]
struct Tally {
    done: u64,
    accepted: u64,
    panics: u64,
    /// Most milliseconds that an input took, and its number.
    slowest: (u64, u64),
}

impl Tally {
    fn add(&mut self, file: &Path) {
        let text = std::fs::read_to_string(file).unwrap_or_default();
        let numbers: Vec<u64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        if let [done, accepted, panics, milliseconds, index] = numbers[..] {
            self.done += done;
            self.accepted += accepted;
            self.panics += panics;
            self.slowest = self.slowest.max((milliseconds, index));
        }
    }
}

/// Runs inputs from number `from` on. The number of the current one is always in the file `status`, what was done in
/// the file beside it.
fn child(campaign: &Campaign, from: u64, status: &Path) -> ExitCode {
    let bench = Bench::new();
    let beginning = Instant::now();
    // Milliseconds since then at which the current input began.
    let begun: &'static AtomicU64 = Box::leak(Box::new(AtomicU64::new(0)));
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(Duration::from_millis(200));
            let since = beginning.elapsed().saturating_sub(Duration::from_millis(begun.load(Ordering::Relaxed)));
            if since > TIME {
                std::process::exit(LATE);
            }
        }
    });
    std::panic::set_hook(Box::new(|panic| say(&format!("panic: {panic}"))));
    let mut tally = Tally::default();
    let mut refusals = BTreeMap::<String, (u64, u64)>::new();
    let keep_tally = |tally: &Tally| {
        let Tally { done, accepted, panics, slowest: (milliseconds, index) } = tally;
        let line = format!("{done} {accepted} {panics} {milliseconds} {index}");
        std::fs::write(status.with_extension("tally"), line)
    };
    for index in from..campaign.count {
        let input = bench.input(campaign.target, campaign.seed, index);
        begun.store(beginning.elapsed().as_millis() as u64, Ordering::Relaxed);
        if std::fs::write(status, index.to_string()).and_then(|()| keep_tally(&tally)).is_err() {
            return ExitCode::from(3);
        }
        // A limit below what is allocated already is refused, and the one before holds.
        let _ = ALLOCATOR.set_limit(ALLOCATOR.allocated() + MEMORY);
        let start = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| bench.run(campaign.target, &input)));
        tally.slowest = tally.slowest.max((start.elapsed().as_millis() as u64, index));
        let _ = ALLOCATOR.set_limit(usize::MAX);
        tally.done += 1;
        match outcome {
            Ok(Ok(())) => tally.accepted += 1,
            Ok(Err(refusal)) => refusals.entry(kind_of(&refusal)).or_insert((0, index)).0 += 1,
            Err(_) => {
                tally.panics += 1;
                if let Ok(file) = keep(campaign, index, &input) {
                    say(&format!("panic: {}", file.display()));
                }
            }
        }
    }
    if std::env::var_os("FUZZ_REFUSALS").is_some() {
        let mut all: Vec<_> = refusals.into_iter().collect();
        all.sort_by_key(|(_, (count, _))| std::cmp::Reverse(*count));
        all.iter().take(60).for_each(|(refusal, (count, first))| say(&format!("{count:8} {first:8} {refusal}")));
    }
    if keep_tally(&tally).is_ok() { ExitCode::SUCCESS } else { ExitCode::from(3) }
}

/// A refusal without its numbers, so that equal ones count together.
fn kind_of(refusal: &str) -> String {
    refusal.chars().filter(|c| !c.is_ascii_digit()).take(100).collect()
}

fn read_index(status: &Path) -> Option<u64> {
    std::fs::read_to_string(status).ok()?.parse().ok()
}

/// Writes an input at fault to `target/fuzz`.
fn keep(campaign: &Campaign, index: u64, input: &[u8]) -> std::io::Result<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../target/fuzz");
    std::fs::create_dir_all(&folder)?;
    let file = folder.join(format!("{}-{}-{index}", campaign.target.name(), campaign.seed));
    std::fs::write(&file, input)?;
    Ok(file)
}

fn say(line: &str) {
    // Nobody is left to tell when the pipe is closed.
    let _ = writeln!(stdout(), "{line}");
}
