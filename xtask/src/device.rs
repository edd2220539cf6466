//! `cargo xtask device`: firmware in QEMU, compared with the host, and measured against its budgets.

use std::collections::BTreeMap;

use crate::budget::{self, Run, Stream, WORKSPACE};
use crate::shell::{Failures, cargo, cargo_with, output};

/// What a run says of the brick that is measured.
pub(crate) struct Measures {
    /// Instructions per sample.
    pub(crate) encode: u64,
    pub(crate) decode: u64,
    /// Bytes.
    pub(crate) state: u64,
    pub(crate) scratch: u64,
    pub(crate) encode_stack: u64,
    pub(crate) decode_stack: u64,
    /// Golden vectors that came out as they should.
    vectors: u64,
    /// As many as the run has.
    pub(crate) streams: Vec<StreamMeasures>,
}

/// What a run says of a stream.
pub(crate) struct StreamMeasures {
    /// Instructions per sample.
    pub(crate) encode: u64,
    pub(crate) decode: u64,
    /// Bytes lent beside the codec, and of stack.
    pub(crate) memory: u64,
    pub(crate) encode_stack: u64,
    pub(crate) decode_stack: u64,
}

/// Builds and runs firmware for every board.
pub(crate) fn run() -> Failures {
    let runs = match budget::read() {
        Ok(budgets) => budgets.runs,
        Err(error) => return vec![error],
    };
    let mut failures = vec![];
    for run in &runs {
        match measure(run) {
            Ok(measures) => failures.extend(compare(run, &measures)),
            Err(error) => failures.push(error),
        }
    }
    failures
}

/// Runs firmware, which fails unless host and firmware agree.
pub(crate) fn measure(run: &Run) -> Result<Measures, String> {
    let Run { board, target, features, build, .. } = run;
    let features = features.join(",");
    let arguments = ["build", "--quiet", "--manifest-path", WORKSPACE, "--package", "firmware"];
    let selection = ["--target", target, "--profile", build, "--features", &features];
    let mut failures = cargo_with(&[&arguments[..], &selection].concat(), &[("DEFMT_LOG", "info")]);
    let runner = ["build", "--quiet", "--manifest-path", WORKSPACE, "--package", "runner"];
    failures.extend(cargo(&runner));
    if let Some(failure) = failures.pop() {
        return Err(failure);
    }
    let folder = "tests/device/target";
    let firmware = format!("{folder}/{target}/{build}/firmware");
    eprintln!("$ runner {board} {firmware}");
    let log = output(&format!("{folder}/debug/runner"), &[board, &firmware])?;
    print!("{log}");
    read(run, &log)
}

fn compare(run: &Run, measures: &Measures) -> Failures {
    let of = |what: &str| format!("{} ({}), {what}", run.board, run.profile);
    let mut failures = Failures::new();
    if measures.vectors != run.vectors {
        failures.push(format!("{}: {}, not {}", of("golden vectors"), measures.vectors, run.vectors));
    }
    failures.extend(run.encode.check(&of("instructions per sample encoded"), measures.encode));
    failures.extend(run.decode.check(&of("instructions per sample decoded"), measures.decode));
    failures.extend(run.memory.check(&of("bytes of state, scratch and stack"), measures.memory()));
    for (stream, measures) in run.streams.iter().zip(&measures.streams) {
        let of =
            |what: &str| of(&format!("instructions per sample {what}, {} {}", stream.effort, stream.kind));
        failures.extend(stream.encode.check(&of("encoded"), measures.encode));
        failures.extend(stream.decode.check(&of("decoded"), measures.decode));
    }
    failures
}

impl Measures {
    /// Bytes of all but the brick and its codestream.
    pub(crate) fn memory(&self) -> u64 {
        self.state + self.scratch + self.encode_stack.max(self.decode_stack)
    }
}

/// Takes the measures out of a log.
fn read(run: &Run, log: &str) -> Result<Measures, String> {
    let (wavelet, levels, effort) = &run.brick;
    let is_measured = |brick: &&Record<'_>| {
        let levels = levels.to_string();
        let keys = [("wavelet", wavelet), ("levels", &levels), ("effort", effort)];
        keys.into_iter().all(|(key, value)| brick.get(key) == Some(&value.as_str()))
    };
    let (state, vectors, bricks) = (records(log, "state"), records(log, "vectors"), records(log, "brick"));
    let brick = bricks.iter().find(is_measured).ok_or_else(|| format!("no brick of {:?}", run.brick))?;
    let streams = records(log, "stream");
    let side = number(Some(brick), "side")?;
    let per_sample = |key: &str| Ok::<u64, String>(number(Some(brick), key)?.div_ceil(side.pow(3)));
    Ok(Measures {
        encode: per_sample("encode")?,
        decode: per_sample("decode")?,
        state: number(state.first(), "codec")?,
        scratch: number(Some(brick), "scratch")?,
        encode_stack: number(Some(brick), "encode_stack")?,
        decode_stack: number(Some(brick), "decode_stack")?,
        vectors: number(vectors.first(), "passed")?,
        streams: run.streams.iter().map(|stream| read_stream(stream, &streams)).collect::<Result<_, _>>()?,
    })
}

/// Finds a stream among those of a log.
fn read_stream(stream: &Stream, records: &[Record<'_>]) -> Result<StreamMeasures, String> {
    let Stream { kind, effort, .. } = stream;
    let is_measured = |record: &&Record<'_>| {
        record.get("kind") == Some(&kind.as_str()) && record.get("effort") == Some(&effort.as_str())
    };
    let record = records.iter().find(is_measured);
    let samples = number(record, "samples")?.max(1);
    Ok(StreamMeasures {
        encode: number(record, "encode")?.div_ceil(samples),
        decode: number(record, "decode")?.div_ceil(samples),
        memory: number(record, "memory")?,
        encode_stack: number(record, "encode_stack")?,
        decode_stack: number(record, "decode_stack")?,
    })
}

/// A number of a record, if there is one.
fn number(record: Option<&Record<'_>>, key: &str) -> Result<u64, String> {
    let value = record.and_then(|record| record.get(key)?.parse().ok());
    value.ok_or_else(|| format!("the log does not say {key}"))
}

/// The `key=value` pairs of a line.
type Record<'a> = BTreeMap<&'a str, &'a str>;

/// The `key=value` pairs of every line that begins with `word`.
fn records<'a>(log: &'a str, word: &str) -> Vec<Record<'a>> {
    let lines = log.lines().filter_map(|line| line.strip_prefix(word)?.strip_prefix(' '));
    lines.map(|rest| rest.split(' ').filter_map(|pair| pair.split_once('=')).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::Limit;

    const LOG: &str = "vectors passed=7 failed=0\nstate codec=100 training=9\nbrick at [0, 0, 0]\n\
        brick side=2 wavelet=haar levels=1 effort=fast scratch=40 encode=81 encode_stack=9 decode=64 decode_stack=12\n\
        stream kind=rows effort=fast samples=4 memory=50 encode=41 encode_stack=5 decode=80 decode_stack=6\n\
        passed\n";

    fn stream(kind: &str) -> Stream {
        let (encode, decode) = (Limit::Most(11), Limit::Most(20));
        Stream { kind: kind.to_owned(), effort: "fast".to_owned(), encode, decode }
    }

    fn one() -> Run {
        Run {
            profile: "p".to_owned(),
            board: "b".to_owned(),
            target: "t".to_owned(),
            features: vec![],
            build: "release".to_owned(),
            vectors: 7,
            brick: ("haar".to_owned(), 1, "fast".to_owned()),
            encode: Limit::Most(11),
            decode: Limit::Most(8),
            memory: Limit::Most(152),
            streams: vec![stream("rows")],
        }
    }

    #[test]
    fn a_log_is_read_and_compared() {
        let measures = read(&one(), LOG).unwrap();
        assert_eq!((measures.encode, measures.decode, measures.memory()), (11, 8, 152));
        assert_eq!(compare(&one(), &measures), [""; 0]);
        let [ref rows] = measures.streams[..] else { panic!("one stream") };
        assert_eq!((rows.encode, rows.decode, rows.memory), (11, 20, 50));
        let slow = Stream { encode: Limit::Most(10), ..stream("rows") };
        let strict = Run { vectors: 8, encode: Limit::Most(10), streams: vec![slow], ..one() };
        assert_eq!(compare(&strict, &measures).len(), 3);
        assert!(read(&Run { streams: vec![stream("slabs")], ..one() }, LOG).is_err());
        assert!(read(&Run { brick: ("haar".to_owned(), 2, "fast".to_owned()), ..one() }, LOG).is_err());
    }
}
