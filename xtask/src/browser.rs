//! `cargo xtask browser`: the decoder in WebAssembly, what it weighs, and golden codestreams in Node and in Chromium.

use std::fs;
use std::io::{Cursor, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, mpsc};
use std::thread;
use std::time::Duration;

use flate2::Compression;
use flate2::write::GzEncoder;
use serde::{Deserialize, Serialize};
use tiny_http::{Header, Response, Server};

use crate::capi;
use crate::shell::Failures;

const TARGET: &str = "wasm32-unknown-unknown";

/// Bytes that the module may take, compressed as a server sends it.
const MAX_GZIP_BYTES: usize = 40 * 1024;

/// The files of the page.
const SOURCES: &str = "tests/browser";

/// Where the page is put together.
const SITE: &str = "target/browser";

/// Files of the site, and the type that a browser wants to hear.
const FILES: [(&str, &str); 7] = [
    ("index.html", "text/html"),
    ("page.js", "text/javascript"),
    ("check.js", "text/javascript"),
    ("decoder.js", "text/javascript"),
    ("node.mjs", "text/javascript"),
    ("wavelift.wasm", "application/wasm"),
    ("vectors.json", "application/json"),
];

/// How long Node and Chromium may take.
const SECONDS: u32 = 900;

/// Where the page sends its verdict, if its address asks for that.
const REPORT: &str = "verdict";

pub(crate) fn run() -> Failures {
    // "z" is shorter here; the library for microcontrollers keeps "s".
    let size = "profile.small.opt-level=\"z\"";
    // What is inlined then is somewhat too little: with more the module is 3 % shorter.
    let inlining = format!("target.{TARGET}.rustflags=[\"-Cllvm-args=-inline-threshold=28\"]");
    let options = ["--target", TARGET, "--config", size, "--config", &inlining, "--no-default-features"];
    let failures = capi::build("cdylib", &[&options[..], &["--features", "small,panic-handler"]].concat());
    if !failures.is_empty() {
        return failures;
    }
    match put_together() {
        Ok(()) => [weigh(), node(), chromium()].into_iter().filter_map(Result::err).collect(),
        Err(error) => vec![error],
    }
}

/// The module, the page and the vectors, in one folder.
fn put_together() -> Result<(), String> {
    let site = Path::new(SITE);
    let problem = |error: std::io::Error| format!("{SITE}: {error}");
    fs::create_dir_all(site).map_err(problem)?;
    for (name, _) in FILES {
        let source = Path::new(SOURCES).join(name);
        if source.exists() {
            fs::copy(source, site.join(name)).map_err(problem)?;
        }
    }
    let module = format!("target/{TARGET}/small/wavelift_capi.wasm");
    fs::copy(&module, site.join("wavelift.wasm")).map_err(|error| format!("{module}: {error}"))?;
    let list = serde_json::to_vec(&vectors()?).map_err(|error| error.to_string())?;
    fs::write(site.join("vectors.json"), list).map_err(problem)
}

/// An entry of `vectors/MANIFEST.toml`, as far as the page needs it.
#[derive(Deserialize, Serialize)]
struct Vector {
    id: String,
    expect: toml::Table,
    #[serde(skip_serializing)]
    file: String,
    /// The file in hexadecimal.
    #[serde(skip_deserializing)]
    hex: String,
}

#[derive(Deserialize)]
struct Manifest {
    vector: Vec<Vector>,
}

/// How streams begin, in hexadecimal, "wS", and light codestreams, "wL" and storage 5 of version 2.
const NOT_IN_PAGE: [&str; 2] = ["7753", "774c0205"];

fn vectors() -> Result<Vec<Vector>, String> {
    let folder = Path::new("vectors");
    let manifest = fs::read_to_string(folder.join("MANIFEST.toml"))
        .map_err(|error| error.to_string())
        .and_then(|text| toml::from_str::<Manifest>(&text).map_err(|error| error.to_string()))
        .map_err(|error| format!("vectors/MANIFEST.toml: {error}"))?;
    let mut vectors = manifest.vector;
    for vector in &mut vectors {
        let bytes =
            fs::read(folder.join(&vector.file)).map_err(|error| format!("{}: {error}", vector.file))?;
        vector.hex = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    }
    // The page decodes no streams, and the module is built without what processors for which it is too large encode.
    vectors.retain(|vector| !NOT_IN_PAGE.iter().any(|beginning| vector.hex.starts_with(beginning)));
    Ok(vectors)
}

/// Compares the module with its budget.
fn weigh() -> Result<(), String> {
    let module = fs::read(Path::new(SITE).join("wavelift.wasm")).map_err(|error| error.to_string())?;
    let mut encoder = GzEncoder::new(vec![], Compression::best());
    let packed =
        encoder.write_all(&module).and_then(|()| encoder.finish()).map_err(|error| error.to_string())?;
    println!("wavelift.wasm: {} bytes, {} with gzip, of {MAX_GZIP_BYTES}", module.len(), packed.len());
    if packed.len() <= MAX_GZIP_BYTES {
        Ok(())
    } else {
        Err(format!("wavelift.wasm takes {} bytes with gzip, {MAX_GZIP_BYTES} at most", packed.len()))
    }
}

fn node() -> Result<(), String> {
    let seconds = SECONDS.to_string();
    let verdict =
        standard_output(Command::new("timeout").args([&seconds, "node", "node.mjs"]).current_dir(SITE))?;
    println!("Node: {}", verdict.trim());
    all_passed("Node", verdict.trim())
}

/// Opens the page in headless Chromium and waits for the verdict that it reports.
fn chromium() -> Result<(), String> {
    let server = Arc::new(Server::http("127.0.0.1:0").map_err(|error| format!("no server: {error}"))?);
    let address = format!("http://{}/index.html?{REPORT}", server.server_addr());
    let (report, verdicts) = mpsc::channel();
    let serving = thread::spawn({
        let server = Arc::clone(&server);
        move || serve(&server, &report)
    });
    let verdict = browse(&address, &verdicts);
    server.unblock();
    let missing = serving.join().map_err(|_| "the server stopped".to_owned())?;
    let verdict = verdict?;
    println!("Chromium: {verdict}");
    match missing.as_slice() {
        [] => all_passed("Chromium", &verdict),
        paths => Err(format!("Chromium asked for {}", paths.join(", "))),
    }
}

/// Serves the site until unblocked, and hands on what the page reports; what was asked for and is not there.
fn serve(server: &Server, verdicts: &mpsc::Sender<String>) -> Vec<String> {
    let mut missing = vec![];
    for mut request in server.incoming_requests() {
        let path = request.url().split('?').next().unwrap_or_default().trim_start_matches('/').to_owned();
        let answered = if path == REPORT {
            let mut verdict = String::new();
            let read = request.as_reader().read_to_string(&mut verdict);
            let answered = read.and_then(|_| request.respond(Response::empty(204)));
            // Who waits may have given up.
            drop(verdicts.send(verdict));
            answered
        } else if let Some(response) = file(&path) {
            request.respond(response)
        } else {
            missing.push(path);
            request.respond(Response::empty(404))
        };
        if let Err(error) = answered {
            eprintln!("a browser went away: {error}");
        }
    }
    missing
}

/// A file of the site, as a server sends it.
fn file(path: &str) -> Option<Response<Cursor<Vec<u8>>>> {
    let (name, kind) = FILES.iter().find(|(name, _)| *name == path)?;
    let header = Header::from_bytes("Content-Type", *kind).ok()?;
    Some(Response::from_data(fs::read(Path::new(SITE).join(name)).ok()?).with_header(header))
}

/// Lets headless Chromium show `address` until a verdict comes.
fn browse(address: &str, verdicts: &mpsc::Receiver<String>) -> Result<String, String> {
    let profile = Path::new(SITE).join("profile");
    if profile.exists() {
        fs::remove_dir_all(&profile).map_err(|error| format!("{}: {error}", profile.display()))?;
    }
    let mut chromium = Command::new("chromium")
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
        .args(["--disable-dev-shm-usage", &format!("--user-data-dir={}", profile.display()), address])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .map_err(|error| format!("chromium: {error}"))?;
    let verdict = verdict_of(&mut chromium, verdicts);
    // It may have ended by itself.
    drop(chromium.kill());
    chromium.wait().map_err(|error| format!("chromium: {error}"))?;
    verdict
}

/// The verdict that the page in `chromium` reports.
fn verdict_of(chromium: &mut Child, verdicts: &mpsc::Receiver<String>) -> Result<String, String> {
    for _ in 0..SECONDS {
        if let Ok(verdict) = verdicts.recv_timeout(Duration::from_secs(1)) {
            return Ok(verdict);
        }
        if let Some(status) = chromium.try_wait().map_err(|error| format!("chromium: {error}"))? {
            return Err(format!("chromium ended before the page was done ({status})"));
        }
    }
    Err(format!("the page in chromium was not done after {SECONDS} s"))
}

fn standard_output(command: &mut Command) -> Result<String, String> {
    let output = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .and_then(std::process::Child::wait_with_output)
        .map_err(|error| format!("{command:?}: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() { Ok(text) } else { Err(format!("{command:?} ({})\n{text}", output.status)) }
}

/// Whether a verdict is that some vectors passed and none failed.
fn all_passed(place: &str, verdict: &str) -> Result<(), String> {
    match verdict.split_once(" passed, ") {
        Some((passed, "0 failed")) if passed != "0" => Ok(()),
        _ => Err(format!("{place}: {verdict}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_verdict_passes_if_all_did() {
        assert!(all_passed("x", "149 passed, 0 failed").is_ok());
        assert!(all_passed("x", "148 passed, 1 failed\na: b").is_err());
        assert!(all_passed("x", "0 passed, 0 failed").is_err());
        assert!(all_passed("x", "not yet").is_err());
    }
}
