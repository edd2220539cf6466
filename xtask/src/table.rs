//! `cargo xtask size --table`: what every profile takes on a target, and what others publish.

use crate::budget::{self, Budgets, Limit, Run, Stream};
use crate::shell::Failures;
use crate::{device, size};

/// Other coders for small machines, as they publish it.
const OTHERS: &str = "xtask/peers.md";

/// Measures everything and prints the table.
pub(crate) fn run() -> Failures {
    let budgets = match budget::read() {
        Ok(budgets) => budgets,
        Err(error) => return vec![error],
    };
    let mut failures = vec![];
    let (mut rows, mut streams) = (vec![], vec![]);
    for run in &budgets.runs {
        let measured = device::measure(run).and_then(|measures| {
            rows.push(row(&budgets, run, &measures)?);
            streams.extend(
                run.streams.iter().zip(&measures.streams).map(|(stream, of)| stream_row(run, stream, of)),
            );
            Ok(())
        });
        failures.extend(measured.err());
    }
    let others = std::fs::read_to_string(OTHERS).unwrap_or_else(|error| {
        failures.push(format!("{OTHERS}: {error}"));
        String::new()
    });
    println!("\n{HEAD}{}\n{STREAMS_HEAD}{}\n{others}", rows.concat(), streams.concat());
    failures
}

const HEAD: &str = "\
| profile | board | flash, bytes: decoder / encoder / both | state + scratch, bytes | stack, bytes: encode / decode | \
instructions per sample: encode / decode |
| --- | --- | ---: | ---: | ---: | ---: |
";

const STREAMS_HEAD: &str = "\
| stream | profile | board | lent, bytes | stack, bytes: encode / decode | instructions per sample: encode / decode |
| --- | --- | --- | ---: | ---: | ---: |
";

fn stream_row(run: &Run, stream: &Stream, measures: &device::StreamMeasures) -> String {
    format!(
        "| {}, {} | {} | {}, {} | {} | {} / {} | {} / {} |\n",
        stream.kind.replace('_', " "),
        stream.effort,
        run.profile,
        run.board,
        core(&run.target),
        thousands(measures.memory),
        thousands(measures.encode_stack),
        thousands(measures.decode_stack),
        of_goal(measures.encode, stream.encode),
        of_goal(measures.decode, stream.decode),
    )
}

fn row(budgets: &Budgets, run: &Run, measures: &device::Measures) -> Result<String, String> {
    let flash = |binary: &str| {
        let image =
            budgets.images.iter().find(|image| image.profile == run.profile && image.binary == binary);
        image.map_or(Ok("–".to_owned()), |image| size::measure(image).map(thousands))
    };
    let &device::Measures { encode, decode, state, scratch, encode_stack, decode_stack, .. } = measures;
    Ok(format!(
        "| {} | {}, {} | {} / {} / {} | {} + {} | {} / {} | {} / {} |\n",
        run.profile,
        run.board,
        core(&run.target),
        flash("decode")?,
        flash("encode")?,
        flash("both")?,
        thousands(state),
        thousands(scratch),
        thousands(encode_stack),
        thousands(decode_stack),
        of_goal(encode, run.encode),
        of_goal(decode, run.decode),
    ))
}

/// What the processors of a target are called.
fn core(target: &str) -> &str {
    let cores = [("thumbv6m", "Cortex-M0"), ("thumbv7em", "Cortex-M4F"), ("riscv32", "RISC-V")];
    cores.into_iter().find(|(start, _)| target.starts_with(start)).map_or(target, |(_, core)| core)
}

/// A number, and the goal if that is missed.
fn of_goal(number: u64, limit: Limit) -> String {
    match limit.missed() {
        Some(goal) if number > goal => format!("{} (goal {goal})", thousands(number)),
        _ => thousands(number),
    }
}

/// With a comma before every third digit.
fn thousands(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_are_called_by_their_processors() {
        assert_eq!(["thumbv7em-none-eabihf", "avr-none"].map(core), ["Cortex-M4F", "avr-none"]);
    }

    #[test]
    fn commas() {
        assert_eq!(
            [7, 123, 1_234, 12_345, 1_234_567].map(thousands).join(" "),
            "7 123 1,234 12,345 1,234,567"
        );
    }
}
