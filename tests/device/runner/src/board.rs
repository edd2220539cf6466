//! The boards, as QEMU has them.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A run takes seconds; one that takes this long hangs.
const PATIENCE: Duration = Duration::from_secs(900);

/// Name, program and arguments.
const BOARDS: [(&str, &str, &[&str]); 3] = [
    ("mps2-an386", "qemu-system-arm", &["-machine", "mps2-an386"]),
    ("microbit", "qemu-system-arm", &["-machine", "microbit"]),
    ("virt", "qemu-system-riscv32", &["-machine", "virt", "-bios", "none"]),
];

/// Every instruction takes the same time, and what the firmware says goes to standard output and to files.
const COMMON: [&str; 11] = [
    "-display",
    "none",
    "-monitor",
    "none",
    "-serial",
    "none",
    "-icount",
    "shift=0",
    "-semihosting-config",
    "enable=on,target=native",
    "-kernel",
];

/// What a run left behind.
pub(crate) struct Outcome {
    /// What came from standard output: defmt frames.
    pub(crate) frames: Vec<u8>,
    /// Whether the firmware ended, and said that all went well.
    pub(crate) succeeded: bool,
}

/// The boards there are.
pub(crate) fn names() -> String {
    BOARDS.map(|(name, ..)| name).join("|")
}

/// Runs `firmware`, its files in `folder`.
pub(crate) fn run(name: &str, firmware: &Path, folder: &Path) -> Result<Outcome, String> {
    let board = BOARDS.iter().find(|(board, ..)| *board == name);
    let (_, program, arguments) = board.ok_or_else(|| format!("the boards are {}", names()))?;
    let firmware = firmware.canonicalize().map_err(|error| format!("{}: {error}", firmware.display()))?;
    let output = folder.join("frames");
    let file = std::fs::File::create(&output).map_err(|error| format!("{}: {error}", output.display()))?;
    let mut emulator = Command::new(program)
        .args(*arguments)
        .args(COMMON)
        .arg(firmware)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(file)
        .spawn()
        .map_err(|error| {
            format!("{program}: {error}; Debian has it in qemu-system-arm and qemu-system-misc")
        })?;
    let succeeded = wait(&mut emulator).map_err(|error| format!("{program}: {error}"))?;
    let frames = std::fs::read(&output).map_err(|error| format!("{}: {error}", output.display()))?;
    Ok(Outcome { frames, succeeded })
}

/// Whether the program ended well, before patience did.
fn wait(program: &mut Child) -> std::io::Result<bool> {
    let start = Instant::now();
    while start.elapsed() < PATIENCE {
        if let Some(status) = program.try_wait()? {
            return Ok(status.success());
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    program.kill()?;
    program.wait()?;
    Ok(false)
}
