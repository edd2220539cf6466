//! A program that is killed, or whose disk is full, leaves the old file or none.

use std::io::{Read, Write};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::files::noise;
use crate::run::Folder;

/// Samples a side of a volume that takes a while.
const SIDE: usize = 96;

/// Bytes that a pipe holds on most systems.
const FULL: usize = 1 << 16;

/// A folder with a volume that takes a while, and the command that compresses it to `a.wlift`.
fn prepared() -> (Folder, Command) {
    let folder = Folder::new();
    folder.write("in.raw", noise(2 * SIDE.pow(3), 7));
    let mut command = folder.command();
    command.args(["compress", "in.raw", "a.wlift", "--type", "u16", "--wavelet", "cubic", "--brick", "16"]);
    command.args(["--extent", &format!("{SIDE}x{SIDE}x{SIDE}")]).stdout(Stdio::null());
    (folder, command)
}

/// Kills runs at moments from their beginning to their end; `WAVELIFT_KILLS` sets at how many, without an old file and with
/// one.
#[test]
fn a_killed_run_leaves_the_old_file_or_the_new_one() {
    let moments: u32 = std::env::var("WAVELIFT_KILLS").map_or(8, |kills| kills.parse().expect("a number"));
    let (folder, mut command) = prepared();
    let start = Instant::now();
    assert!(command.status().unwrap().success());
    let duration = start.elapsed();
    let whole = folder.read("a.wlift");
    for old in [None, Some(b"old".to_vec())] {
        for moment in 0..moments {
            let _ = std::fs::remove_file(folder.path("a.wlift"));
            old.iter().for_each(|bytes| folder.write("a.wlift", bytes));
            let mut child = command.spawn().unwrap();
            sleep(duration * moment / moments + Duration::from_millis(1));
            child.kill().unwrap();
            child.wait().unwrap();
            let found = std::fs::read(folder.path("a.wlift")).ok();
            let as_expected = found == old || found.as_ref() == Some(&whole);
            assert!(
                as_expected,
                "{} bytes after {moment}/{moments} of the time",
                found.map_or(0, |bytes| bytes.len())
            );
        }
    }
    let hidden = |name: &str| name.starts_with(".wavelift-") && name.ends_with(".part");
    for name in folder.everything().keys() {
        assert!(["in.raw", "a.wlift"].contains(&name.as_str()) || hidden(name), "{name}");
    }
}

#[test]
fn a_file_that_cannot_grow_is_not_left_behind() {
    let (folder, _) = prepared();
    let extent = format!("{SIDE}x{SIDE}x{SIDE}");
    folder.write("old", "old");
    for name in ["new", "old"] {
        let before = folder.everything();
        let command = format!("wavelift compress in.raw {name} --extent {extent} --type u16");
        // Without the signal, a file beyond the limit is an error of the system like a full disk.
        folder.shell(&format!("trap '' XFSZ; ulimit -f 64; {command}")).fails(4, &[name, "cannot write"]);
        assert!(folder.everything() == before, "{name}: something changed");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told_and_left_clean() {
    let (folder, _) = prepared();
    folder
        .run("compress in.raw /dev/full --extent 96x96x96 --type u16")
        .fails(4, &["/dev/full", "No space left"]);
    std::fs::create_dir(folder.path("disk")).unwrap();
    let mount = "mount -t tmpfs -o size=64k none disk";
    // The file system is in a mount namespace of its own, and gone with it.
    let script = |command: &str| format!("unshare --mount --map-root-user sh -c '{mount} && {command}'");
    if folder.shell(&script("true")).stderr() != "" {
        println!("skipped: no file system can be mounted here, so none can be filled");
        return;
    }
    let compress = "wavelift compress in.raw disk/a.wlift --extent 96x96x96 --type u16";
    let outcome =
        folder.shell(&script(&format!("echo old >disk/a.wlift; {compress}; ls -A disk; cat disk/a.wlift")));
    assert_eq!(outcome.stdout(), "a.wlift\nold\n");
    assert!(
        outcome.stderr().starts_with("wavelift: disk/a.wlift: cannot write: No space left"),
        "{}",
        outcome.stderr()
    );
}

/// Sends a signal by its name.
fn send(child: &Child, signal: &str) {
    let mut kill = Command::new("kill");
    assert!(kill.args(["-s", signal, &child.id().to_string()]).status().unwrap().success());
}

/// Waits until the program has taken bytes from a pipe: it listens to signals by then.
fn begun(command: &mut Command) -> Child {
    let mut child = command.stdin(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // More than a pipe holds.
    child.stdin.as_mut().unwrap().write_all(&noise(1 << 20, 3)).unwrap();
    child
}

#[test]
fn a_signal_ends_the_program_and_leaves_no_file() {
    let folder = Folder::new();
    folder.write("old.raw", "old");
    folder.write("old.wlift", "old");
    let before = folder.everything();
    for signal in ["INT", "TERM", "HUP"] {
        for line in [
            "convert /dev/stdin old.raw --extent 2097152 --type u8",
            "convert /dev/stdin new.nhdr --extent 2097152 --type u8 --gzip",
            "compress /dev/stdin old.wlift --extent 2097152 --type u8",
            "compress /dev/stdin new.wlift --extent 2097152 --type u8",
            "tables /dev/stdin --extent 2097152 --type u8 --svg new.svg",
            "preview /dev/stdin new.png --extent 1024x2048 --type u8",
            "surface build /dev/stdin new.wsurf --iso 100 --extent 128x128x128 --type u8",
        ] {
            let mut child = begun(folder.command().args(line.split(' ')));
            send(&child, signal);
            let input = child.stdin.take();
            let output = child.wait_with_output().unwrap();
            drop(input);
            assert_eq!(output.status.code(), Some(130), "{line}, {signal}: {output:?}");
            assert!(output.stderr.is_empty() && folder.everything() == before, "{line}, {signal}");
        }
    }
}

#[test]
fn a_signal_ends_a_program_that_computes_or_waits_for_a_reader() {
    let (folder, mut compress) = prepared();
    assert!(compress.status().unwrap().success());
    folder.write("out.raw", "old");
    folder.run("decompress a.wlift whole.raw").silent();
    for line in [
        "compress whole.raw a.wlift --extent 96x96x96 --type u16",
        "decompress a.wlift out.raw",
        "preview a.wlift a.png --mip x --level 0",
        "surface build whole.raw a.wsurf --iso 30000 --extent 96x96x96 --type u16",
    ] {
        let before = folder.everything();
        let mut child = folder.command().args(line.split(' ')).spawn().unwrap();
        sleep(Duration::from_millis(30));
        send(&child, "INT");
        // On a fast machine it may be done already; not yet listening, it ends without a code.
        match child.wait().unwrap().code() {
            Some(0) => {}
            code => assert!(
                [Some(130), None].contains(&code) && folder.everything() == before,
                "{line}, {code:?}"
            ),
        }
    }
    let mut command = folder.command();
    command.args(["convert", "whole.raw", "/dev/stdout", "--extent", "96x96x96", "--type", "u16"]);
    let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
    child.stdout.as_mut().unwrap().read_exact(&mut [0; 100]).unwrap();
    send(&child, "TERM");
    assert_eq!(child.wait().unwrap().code(), Some(130));
}

/// A program whose output has appeared, and that cannot say so yet, as nobody reads.
#[cfg(unix)]
#[test]
fn a_signal_that_comes_when_the_output_is_whole_ends_nothing() {
    let folder = Folder::new();
    folder.write("in.raw", noise(1 << 20, 3));
    let (mut told, full) = std::io::pipe().unwrap();
    let mut command = folder.command();
    command.args("compress in.raw a.wlift --extent 1048576 --type u8 --json".split(' '));
    command.stdout(full.try_clone().unwrap());
    let filler = std::thread::spawn(move || (&full).write_all(&[b' '; FULL]));
    let mut child = command.spawn().unwrap();
    // What the program says gets into the pipe only if that holds more than is usual.
    drop(command);
    while !folder.path("a.wlift").exists() {
        sleep(Duration::from_millis(1));
    }
    send(&child, "INT");
    sleep(Duration::from_millis(50));
    let mut text = String::new();
    told.read_to_string(&mut text).unwrap();
    filler.join().unwrap().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(0));
    let document: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(document["output"], "a.wlift");
}

#[test]
fn ignored_signals_stay_ignored() {
    let folder = Folder::new();
    folder.write("in.raw", noise(1 << 21, 3));
    let convert = "wavelift convert /dev/stdin out.raw --extent 2097152 --type u8";
    let line =
        format!("trap '' HUP; (head -c 1000000 in.raw; kill -HUP 0; tail -c +1000001 in.raw) | {convert}");
    folder.shell(&format!("setsid --wait sh -c \"{line}\"")).silent();
    assert!(folder.read("out.raw") == folder.read("in.raw"));
}

#[cfg(target_os = "linux")]
#[test]
fn progress_is_shown_at_a_terminal_only() {
    let folder = Folder::new();
    // The second piece of it waits.
    folder.write("in.raw", noise(5 << 20, 3));
    let line = "(cat in.raw; sleep 1) | wavelift convert /dev/stdin out.raw --extent 5242880 --type u8";
    folder.shell(line).silent();
    if !folder.shell("script --version").stderr().is_empty() {
        println!("skipped: no program `script` that makes a terminal");
        return;
    }
    let outcome = folder.shell(&format!("script --quiet --return --command '{line}' /dev/null")).ok();
    for part in ["converting", " 80 %", "B/s", "left"] {
        assert!(outcome.stdout().contains(part), "{part} expected: {}", outcome.stdout());
    }
}

/// A program that copies `in.raw`, three pieces long, to a pipe that nobody reads yet, and has read the first piece.
#[cfg(unix)]
fn waiting(folder: &Folder) -> Child {
    folder.write("in.raw", noise(12 << 20, 3));
    let mut command = folder.command();
    command.args("convert in.raw /dev/stdout --extent 12582912 --type u8".split(' '));
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    child.stdout.as_mut().unwrap().read_exact(&mut [0; 100]).unwrap();
    child
}

#[test]
fn an_input_that_changes_while_it_is_read_is_told() {
    let folder = Folder::new();
    let open = || std::fs::OpenOptions::new().write(true).open(folder.path("in.raw")).unwrap();
    let changes: [(&dyn Fn(), &str); 3] = [
        (&|| open().set_len(6 << 20).unwrap(), "in.raw: has changed while it was read"),
        (&|| open().set_len(13 << 20).unwrap(), "in.raw: has changed while it was read"),
        (&|| open().write_all(&[7; 100]).unwrap(), "in.raw: has changed while it was read"),
    ];
    for (change, told) in changes {
        let child = waiting(&folder);
        change();
        let output = child.wait_with_output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && text.contains(told), "{told} expected: {text}");
    }
}

#[test]
fn a_reader_that_goes_away_and_a_folder_that_vanishes_are_told() {
    let folder = Folder::new();
    let mut child = waiting(&folder);
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(4));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "wavelift: /dev/stdout: cannot write: Broken pipe\n");

    std::fs::create_dir(folder.path("sub")).unwrap();
    let mut command = folder.command();
    command.args("convert /dev/stdin sub/out.raw --extent 1048577 --type u8".split(' '));
    let mut child = begun(&mut command);
    std::fs::remove_dir_all(folder.path("sub")).unwrap();
    child.stdin.take().unwrap().write_all(&[7]).unwrap();
    let output = child.wait_with_output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.code() == Some(4) && text.contains("sub/out.raw: cannot write: No such file"),
        "{text}"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn every_command_that_writes_tells_of_a_full_device() {
    let folder = Folder::new();
    folder.write("in.raw", noise(1 << 20, 3));
    folder.run("compress in.raw a.wlift --extent 1048576 --type u8 --effort fast").silent();
    for line in [
        "convert in.raw /dev/full --extent 1048576 --type u8",
        "decompress a.wlift /dev/full",
        "repair a.wlift /dev/full",
        "preview a.wlift /dev/full",
    ] {
        folder.run(line).fails(4, &["/dev/full: cannot write: No space left"]);
    }
}
