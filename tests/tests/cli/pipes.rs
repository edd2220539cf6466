//! Pipes and devices in place of files.

use std::io::{BufRead, BufReader};
use std::process::Stdio;

use crate::files::{nrrd, smooth_u16};
use crate::run::Folder;

#[test]
fn volumes_come_and_go_through_pipes() {
    let folder = Folder::new();
    let samples = smooth_u16([20, 13, 6]);
    folder.write("in.raw", &samples);
    let layout = "--extent 20x13x6 --type u16";
    folder.run(&format!("compress in.raw a.wlift {layout}")).silent();
    folder.shell(&format!("cat in.raw | wavelift compress /dev/stdin b.wlift {layout}")).silent();
    assert_eq!(folder.read("b.wlift"), folder.read("a.wlift"));
    folder.shell(&format!("wavelift compress in.raw /dev/stdout {layout} | cat > c.wlift")).silent();
    assert_eq!(folder.read("c.wlift"), folder.read("a.wlift"));
    folder.shell("wavelift decompress a.wlift /dev/stdout | cat > out.raw").silent();
    assert_eq!(folder.read("out.raw"), samples);
    folder.shell(&format!("cat in.raw | wavelift compress - - {layout} | cat > d.wlift")).silent();
    assert_eq!(folder.read("d.wlift"), folder.read("a.wlift"));
}

#[test]
fn a_compressed_file_does_not_come_through_a_pipe() {
    let folder = Folder::new();
    folder.write("in.raw", [7; 8]);
    folder.run("compress in.raw a.wlift --extent 8 --type u8").silent();
    for command in ["info /dev/stdin", "verify /dev/stdin", "decompress /dev/stdin out.raw"] {
        let outcome = folder.shell(&format!("cat a.wlift | wavelift {command}"));
        outcome.fails(4, &["/dev/stdin: a compressed file is read from its end", "through a pipe"]);
    }
    folder.shell("wavelift info /dev/stdin < a.wlift").ok();
    let told = "/dev/stdin: a raw file does not say its extent";
    folder.shell("cat a.wlift | wavelift compress /dev/stdin b.wlift").fails(2, &[told]);
}

#[test]
fn standard_output_takes_one_thing() {
    let folder = Folder::new();
    folder.write("in.raw", [7; 8]);
    folder.run("compress in.raw a.wlift --extent 8 --type u8").silent();
    let told = "wavelift: --json and OUTPUT both go to standard output: leave one out";
    for name in ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"] {
        folder.run(&format!("compress in.raw {name} --extent 8 --type u8 --json")).fails(2, &[told]);
        folder.run(&format!("decompress a.wlift {name} --json")).fails(2, &[told]);
        for json in ["", "--json"] {
            let command = format!("tables in.raw --extent 8 --type u8 --svg {name} {json}");
            folder.run(&command).fails(2, &["the tables and --svg both go to standard output"]);
        }
    }
}

#[test]
fn a_pipe_with_too_few_or_too_many_samples_is_refused() {
    let folder = Folder::new();
    folder.write("in.raw", [0; 100]);
    for extent in ["99", "101"] {
        let outcome = folder
            .shell(&format!("cat in.raw | wavelift compress /dev/stdin a.wlift --extent {extent} --type u8"));
        outcome.fails(2, &["/dev/stdin", extent, "check extent"]);
    }
    assert_eq!(folder.everything().len(), 1);
}

#[test]
fn a_reader_may_go_away() {
    let folder = Folder::new();
    let many = "k:=".to_owned() + &"v".repeat(1 << 19);
    let lines = ["NRRD0004", "type: uint8", "dimension: 1", "sizes: 3", "encoding: raw", &many];
    folder.write("in.nrrd", nrrd(&lines, &[1, 2, 3]));
    folder.run("compress in.nrrd a.wlift").silent();
    for line in ["info a.wlift", "info a.wlift --json"] {
        let mut command = folder.command();
        command.args(line.split(' ')).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let mut first = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut first).unwrap();
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty() && !first.is_empty(), "{output:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn exit_codes_stay_where_standard_error_takes_nothing() {
    let folder = Folder::new();
    let lines = ["NRRD0004", "type: uint8", "dimension: 1", "sizes: 4096", "encoding: raw", "k:=v"];
    folder.write("in.nrrd", nrrd(&lines, &crate::files::noise(4096, 3)));
    folder.run("compress in.nrrd a.wlift").silent();
    let mut damaged = folder.read("a.wlift");
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    folder.write("damaged.wlift", damaged);
    for (command, code) in [
        ("decompress a.wlift out.raw", 0),
        ("info a.wlift --level", 2),
        ("verify damaged.wlift", 3),
        ("info none.wlift", 4),
    ] {
        assert!(!folder.run(command).stderr().is_empty(), "{command} says nothing");
        let outcome = folder.shell(&format!("wavelift {command} 2>/dev/full; echo $?"));
        assert_eq!(outcome.stdout(), format!("{code}\n"), "{command}");
    }
}
