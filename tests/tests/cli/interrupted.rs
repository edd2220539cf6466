//! A program that is killed, or whose disk is full, leaves the old file or none.

use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::files::noise;
use crate::run::Folder;

/// Samples a side of a volume that takes a while.
const SIDE: usize = 96;

/// A folder with a volume that takes a while, and the command that compresses it to `a.wlift`.
fn prepared() -> (Folder, Command) {
    let folder = Folder::new();
    folder.write("in.raw", noise(2 * SIDE.pow(3), 7));
    let mut command = folder.command();
    command.args(["compress", "in.raw", "a.wlift", "--type", "u16", "--wavelet", "cubic", "--brick", "16"]);
    command.args(["--extent", &format!("{SIDE}x{SIDE}x{SIDE}")]).stdout(Stdio::null());
    (folder, command)
}

#[test]
fn a_killed_run_leaves_the_old_file_or_the_new_one() {
    let (folder, mut command) = prepared();
    let start = Instant::now();
    assert!(command.status().unwrap().success());
    let duration = start.elapsed();
    let whole = folder.read("a.wlift");
    for old in [None, Some(b"old".to_vec())] {
        for eighths in 0..8 {
            let _ = std::fs::remove_file(folder.path("a.wlift"));
            old.iter().for_each(|bytes| folder.write("a.wlift", bytes));
            let mut child = command.spawn().unwrap();
            sleep(duration * eighths / 8 + Duration::from_millis(1));
            child.kill().unwrap();
            child.wait().unwrap();
            let found = std::fs::read(folder.path("a.wlift")).ok();
            let as_expected = found == old || found.as_ref() == Some(&whole);
            assert!(
                as_expected,
                "{} bytes after {eighths}/8 of the time",
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
