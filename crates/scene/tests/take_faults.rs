//! Every moment at which a take can be cut short. Truth: a run that nothing befell, byte for byte.
//!
//! A solver in miniature writes a take on a simulated disk: its state is the number of the frame. At each call of the
//! system in turn the process dies, the power goes or the disk fills up; then the same session runs again.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::take::{frame, provenance, scene};
use fissure_files::{Fault, Folder, SimulatedDisk};
use fissure_scene::{Scene, Start, Take, TakeError, TakeWriter};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const TAKE: &str = "/plate.take";
const LAST: i64 = 5;

fn folder(disk: &SimulatedDisk) -> Folder {
    Folder::on(Arc::new(disk.clone()), TAKE)
}

fn files(disk: &SimulatedDisk) -> BTreeMap<PathBuf, Vec<u8>> {
    disk.files(Path::new(TAKE))
}

/// Writes the frames up to `last` from wherever the take is; a state with every second frame and with the last.
fn session(disk: &SimulatedDisk, scene: &Scene, last: i64) -> Result<(), TakeError> {
    let opened = TakeWriter::open(&folder(disk), scene, provenance(), last)?;
    let first = match opened.start {
        Start::First => 1,
        Start::At(saved) => {
            assert_eq!(saved.bytes, format!("state {}", saved.frame).into_bytes());
            saved.frame
        }
        Start::Complete => return Ok(()),
    };
    write(opened.writer, first..=last)
}

fn write(mut writer: TakeWriter, numbers: std::ops::RangeInclusive<i64>) -> Result<(), TakeError> {
    let last = *numbers.end();
    for number in numbers {
        let state = (number % 2 == 0 || number == last).then(|| format!("state {number}"));
        writer.write_frame(&frame(number), state.as_ref().map(String::as_bytes))?;
    }
    Ok(())
}

/// What a session without a fault writes, and the calls it takes.
fn whole(scene: &Scene) -> (BTreeMap<PathBuf, Vec<u8>>, Vec<String>) {
    let disk = SimulatedDisk::new();
    session(&disk, scene, LAST).unwrap();
    (files(&disk), disk.calls())
}

/// A reader must find a sound take, or be told that there is none yet.
fn assert_readable(disk: &SimulatedDisk, at: &str) {
    match Take::read(&folder(disk)) {
        Ok(take) => {
            for (number, expected) in take.frame_numbers().into_iter().zip(1..) {
                assert_eq!(take.frame(number).unwrap(), frame(expected), "{at}");
            }
        }
        Err(TakeError::NotATake { .. }) => {}
        Err(other) => panic!("{at}: {other}"),
    }
}

/// Runs the session to its end on a disk on which something went wrong, and holds the take against the whole one.
fn assert_goes_on(disk: &SimulatedDisk, scene: &Scene, whole: &BTreeMap<PathBuf, Vec<u8>>, at: &str) {
    disk.set_fault(None);
    assert_readable(disk, at);
    session(disk, scene, LAST).unwrap_or_else(|error| panic!("{at}: {error}"));
    let found = files(disk);
    assert_eq!(found.keys().collect::<Vec<_>>(), whole.keys().collect::<Vec<_>>(), "{at}");
    for (name, bytes) in whole {
        assert!(found[name] == *bytes, "{at}: {} differs", name.display());
    }
}

#[test]
fn a_death_at_any_call_and_another_one_later_leave_what_goes_on() {
    let scene = scene();
    let (whole, calls) = whole(&scene);
    assert!(calls.len() > 60, "{calls:?}");
    for first in 0..calls.len() {
        // The second one in the session after it, which takes other ways the first time than later.
        for second in (0..30).step_by(3).map(|second| (second + first) % 40) {
            let disk = SimulatedDisk::new();
            for at in [first, second] {
                disk.set_fault(Some(Fault::Death(at)));
                let _ = session(&disk, &scene, LAST);
            }
            assert_goes_on(&disk, &scene, &whole, &format!("{first} `{}`, then {second}", calls[first]));
        }
    }
}

#[test]
fn a_power_cut_at_any_call_leaves_what_goes_on() {
    let scene = scene();
    let (whole, calls) = whole(&scene);
    for at in 0..=calls.len() {
        for seed in 0..12 {
            let disk = SimulatedDisk::new();
            disk.set_fault(Some(Fault::Death(at)));
            let listed = |disk: &SimulatedDisk| Take::read(&folder(disk)).map_or(0, |take| take.frames().len());
            let _ = session(&disk, &scene, LAST);
            // What was told to be written outlives the cut.
            let calls_of_a_list = disk.calls().iter().filter(|call| *call == "sync frames.jsonl").count();
            disk.set_fault(None);
            disk.cut_power(seed);
            assert!(listed(&disk) + 1 >= calls_of_a_list, "call {at}, seed {seed}");
            assert_goes_on(&disk, &scene, &whole, &format!("call {at}, seed {seed}"));
        }
    }
}

#[test]
fn a_disk_that_fills_up_at_any_call_leaves_what_goes_on() {
    let scene = scene();
    let (whole, calls) = whole(&scene);
    for at in 0..calls.len() {
        let disk = SimulatedDisk::new();
        disk.set_fault(Some(Fault::Full(at)));
        match session(&disk, &scene, LAST) {
            // The last calls only read and sync.
            Ok(()) => assert!(calls[at..].iter().all(|call| call.starts_with("sync")), "{at}"),
            Err(TakeError::File(error)) => assert!(error.remedy().contains("free some space"), "{at}: {error}"),
            Err(other) => panic!("{at}: {other}"),
        }
        assert_goes_on(&disk, &scene, &whole, &format!("full at {at} `{}`", calls[at]));
    }
}

/// Beginning anew over a take that is there. Truth: the bytes of a take where there was none, and before that a folder
/// that is refused, or goes on as one or the other take.
#[test]
fn a_death_while_a_take_is_replaced_leaves_what_can_be_replaced() {
    let (scene, mut other) = (scene(), scene());
    other.growth.bending = 2.0;
    other.hash = other.simulation_hash();
    let (whole, _) = whole(&other);
    let replace = |disk: &SimulatedDisk| {
        TakeWriter::replace(&folder(disk), &other, provenance()).and_then(|writer| write(writer, 1..=LAST))
    };
    let disk = SimulatedDisk::new();
    session(&disk, &scene, LAST + 3).unwrap();
    disk.set_fault(None);
    replace(&disk).unwrap();
    let calls = disk.calls();
    for (at, call) in calls.iter().enumerate() {
        for seed in [None, Some(1), Some(2), Some(3)] {
            let disk = SimulatedDisk::new();
            session(&disk, &scene, LAST + 3).unwrap();
            disk.set_fault(Some(Fault::Death(at)));
            replace(&disk).unwrap_err();
            disk.set_fault(None);
            if let Some(seed) = seed {
                disk.cut_power(seed);
            }
            // Without being told to replace: the old take is refused, the new one goes on.
            if let Err(error) = session(&disk, &other, LAST) {
                assert!(error.remedy().contains("--overwrite"), "{at} `{call}`, {seed:?}: {error}");
                replace(&disk).unwrap();
            }
            assert!(files(&disk) == whole, "{at} `{call}`, {seed:?}");
        }
    }
}

/// Content before its name, the name before the line, the line before anybody is told.
#[test]
fn calls_come_in_the_order_that_a_power_cut_asks_for() {
    let scene = scene();
    let disk = SimulatedDisk::new();
    let mut writer = TakeWriter::open(&folder(&disk), &scene, provenance(), 9).unwrap().writer;
    disk.set_fault(None);
    writer.write_frame(&frame(1), None).unwrap();
    let expected = [
        "read frame.0001.safetensors",
        "read particles.safetensors",
        "create .frame.0001.safetensors.fissure-part",
        "write .frame.0001.safetensors.fissure-part",
        "sync .frame.0001.safetensors.fissure-part",
        "publish frame.0001.safetensors",
        "create .particles.safetensors.fissure-part",
        "write .particles.safetensors.fissure-part",
        "sync .particles.safetensors.fissure-part",
        "publish particles.safetensors",
        "sync folder plate.take",
        "append tips.csv",
        "append energy.csv",
        "append supports.csv",
        "append frames.jsonl",
        "sync frames.jsonl",
    ];
    assert_eq!(disk.calls(), expected);
}

/// Truth: each frame takes as many calls and bytes as the one before, up to the digits of its number.
#[test]
fn a_frame_costs_the_same_however_many_there_are() {
    let scene = scene();
    let disk = SimulatedDisk::new();
    let mut writer = TakeWriter::open(&folder(&disk), &scene, provenance(), 9_999).unwrap().writer;
    let mut cost = |number: i64| {
        disk.set_fault(None);
        let mut small = frame(1);
        small.number = number;
        writer.write_frame(&small, None).unwrap();
        (disk.calls().len(), disk.written())
    };
    let costs: Vec<_> = (1..=2000).map(&mut cost).collect();
    // The first one has what never changes besides.
    let ((calls, bytes), (last_calls, last_bytes)) = (costs[1], costs[1999]);
    assert_eq!(calls, last_calls);
    assert!(last_bytes.abs_diff(bytes) < 32, "{bytes} bytes for the second frame, {last_bytes} for the last");
}
