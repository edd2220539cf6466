//! The examples run as they are.

#[path = "../examples/array.rs"]
mod array;
#[path = "../examples/convert.rs"]
mod convert;
#[path = "../examples/inspect.rs"]
mod inspect;
#[path = "../examples/picture.rs"]
mod picture;
#[path = "../examples/simulation.rs"]
mod simulation;

#[test]
fn an_array_is_stored_and_read() {
    array::main().unwrap();
}

#[test]
fn a_file_is_inspected() {
    inspect::main().unwrap();
}

#[test]
fn a_file_is_converted() {
    convert::main().unwrap();
}

#[test]
fn pictures_are_drawn() {
    picture::main().unwrap();
}

#[test]
fn time_steps_are_pushed() {
    simulation::main().unwrap();
}
