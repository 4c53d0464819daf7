//! Ends the program in all ways at random moments, lets it go on, and holds what it wrote against a run that nothing
//! befell.
//!
//! ```sh
//! cargo build --release && cargo run --release -p fissure-tests --bin kills -- COUNT SEED
//! ```
//! Ways, in turn: SIGKILL in `run`, SIGKILL in `run` and again in the run that goes on, SIGKILL in `sim`, SIGINT,
//! SIGTERM, SIGKILL in `run --overwrite` over another take, SIGKILL in `post`, and a limit on the length of files in
//! place of a full disk. Prints how each ended and fails when a byte differs or an end has the wrong code. For Unix.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "what it finds is its result")]

use fissure_tests::program::{PLATE, files};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

type Outcome<T> = Result<T, Box<dyn Error>>;

/// How a process is ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Way {
    Kill,
    KillTwice,
    KillSim,
    Interrupt,
    Terminate,
    KillOverwrite,
    KillPost,
    FullDisk,
}

const WAYS: [Way; 8] = [
    Way::Kill,
    Way::KillTwice,
    Way::KillSim,
    Way::Interrupt,
    Way::Terminate,
    Way::KillOverwrite,
    Way::KillPost,
    Way::FullDisk,
];

fn main() -> Outcome<ExitCode> {
    let mut arguments = std::env::args().skip(1);
    let count: u64 = arguments.next().ok_or("usage: kills COUNT SEED")?.parse()?;
    let mut random = Pcg64::seed_from_u64(arguments.next().ok_or("usage: kills COUNT SEED")?.parse()?);
    let place = tempfile::tempdir()?;
    let bench = Bench::new(place.path())?;
    let (mut ends, mut failures) = (BTreeMap::new(), 0);
    for (number, way) in (0..count).zip(WAYS.into_iter().cycle()) {
        match bench.try_one(way, &mut random) {
            Ok(in_time) => *ends.entry((way, in_time)).or_insert(0) += 1,
            Err(error) => {
                failures += 1;
                eprintln!("{number}: {way:?}: {error}");
            }
        }
    }
    for ((way, in_time), count) in &ends {
        let when = if *in_time { "while it worked" } else { "too late" };
        println!("{way:?}: {count} ended {when}, then the same bytes");
    }
    println!("{count} ends, {failures} failures");
    Ok(if failures == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Where it all happens.
struct Bench {
    program: PathBuf,
    folder: PathBuf,
    /// What a run writes that nothing befalls, and how long it takes.
    whole: BTreeMap<PathBuf, Vec<u8>>,
    duration: Duration,
}

impl Bench {
    fn new(folder: &Path) -> Outcome<Self> {
        let program = std::env::current_exe()?.with_file_name("fissure");
        if !program.exists() {
            return Err(format!("`{}` is missing: `cargo build --release` makes it", program.display()).into());
        }
        // It cracks in about half a second.
        let scene = PLATE.replace("particle_spacing = 1.0", "particle_spacing = 0.2").replace("1-12", "1-16");
        std::fs::write(folder.join("plate.toml"), scene)?;
        let mut bench = Self { program, folder: folder.into(), whole: BTreeMap::new(), duration: Duration::ZERO };
        bench.to_end(&bench.arguments("run"))?;
        let start = Instant::now();
        bench.to_end(&[bench.arguments("run"), vec!["--overwrite"]].concat())?;
        bench.duration = start.elapsed();
        bench.whole = files(&folder.join("out"))?;
        Ok(bench)
    }

    fn arguments(&self, command: &'static str) -> Vec<&'static str> {
        vec![command, "plate.toml", "--output", "out"]
    }

    /// Runs the program to its end.
    fn to_end(&self, arguments: &[&str]) -> Outcome<()> {
        let output = Command::new(&self.program).args(arguments).current_dir(&self.folder).output()?;
        if output.status.success() {
            return Ok(());
        }
        Err(format!("{arguments:?}: {}: {}", output.status, String::from_utf8_lossy(&output.stderr)).into())
    }

    fn start(&self, arguments: &[&str]) -> Outcome<Child> {
        let mut command = Command::new(&self.program);
        command
            .args(arguments)
            .current_dir(&self.folder)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        Ok(command.spawn()?)
    }

    /// Starts the program and sends it a signal at a random moment; returns whether that came in time, and the exit
    /// code.
    fn end_within(&self, arguments: &[&str], signal: &str, random: &mut Pcg64) -> Outcome<(bool, Option<i32>)> {
        let mut child = self.start(arguments)?;
        std::thread::sleep(self.duration.mul_f64(1.1 * fraction(random)));
        let in_time = child.try_wait()?.is_none();
        if in_time {
            Command::new("kill").args([signal, &child.id().to_string()]).status()?;
        }
        Ok((in_time, child.wait()?.code()))
    }

    /// One end and what follows; returns whether it came while the program worked.
    fn try_one(&self, way: Way, random: &mut Pcg64) -> Outcome<bool> {
        let out = self.folder.join("out");
        if out.exists() {
            std::fs::remove_dir_all(&out)?;
        }
        let (run, sim) = (self.arguments("run"), self.arguments("sim"));
        let overwrite = [run.clone(), vec!["--overwrite"]].concat();
        let post = ["post", "out/plate.take"];
        let in_time = match way {
            Way::Kill => self.end_within(&run, "-KILL", random)?.0,
            Way::KillTwice => {
                let first = self.end_within(&run, "-KILL", random)?.0;
                first && self.end_within(&run, "-KILL", random)?.0
            }
            Way::KillSim => self.end_within(&sim, "-KILL", random)?.0,
            Way::Interrupt | Way::Terminate => {
                let signal = if way == Way::Interrupt { "-INT" } else { "-TERM" };
                let (in_time, code) = self.end_within(&run, signal, random)?;
                // Without a code: before the program could hear it.
                if !matches!(code, None | Some(0 | 75)) {
                    return Err(format!("ended with {code:?}").into());
                }
                in_time
            }
            Way::KillOverwrite => {
                self.to_end(&[run.clone(), vec!["--set", "growth.bending=2", "--frames", "1-9"]].concat())?;
                let in_time = self.end_within(&overwrite, "-KILL", random)?.0;
                self.to_end(&overwrite)?;
                in_time
            }
            Way::KillPost => {
                self.to_end(&sim)?;
                let in_time = self.end_within(&post, "-KILL", random)?.0;
                self.to_end(&post)?;
                in_time
            }
            Way::FullDisk => self.on_a_full_disk(random)?,
        };
        self.to_end(&run)?;
        let found = files(&out)?;
        let differs = |name: &&PathBuf| found.get(*name) != self.whole.get(*name);
        match found.keys().chain(self.whole.keys()).find(differs) {
            Some(name) => Err(format!("{} differs", name.display()).into()),
            None => Ok(in_time),
        }
    }

    /// Runs the program with a limit on the length of files [blocks of 1024 bytes], which it meets at a file that
    /// depends on the limit.
    fn on_a_full_disk(&self, random: &mut Pcg64) -> Outcome<bool> {
        let limit = (2000.0 * fraction(random)) as u64;
        let command =
            format!("trap '' XFSZ; ulimit -f {limit}; exec '{}' run plate.toml --output out", self.program.display());
        let output = Command::new("bash").args(["-c", &command]).current_dir(&self.folder).output()?;
        match output.status.code() {
            Some(0) => Ok(false),
            Some(3) => Ok(true),
            other => Err(format!("limit {limit}: {other:?}: {}", String::from_utf8_lossy(&output.stderr)).into()),
        }
    }
}

/// From 0 to below 1.
fn fraction(random: &mut Pcg64) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}
