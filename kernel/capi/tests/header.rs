//! The header says what the library is: the same constants, structs and functions, no more and no fewer.
//!
//! Both sides are brought to one form, declarations of C with a blank between all tokens.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use syn::{Expr, FnArg, Item, Lit, Pat, ReturnType, Type, Visibility};
use wavelift_capi::{
    WAVELIFT_MAX_HEADER_BYTES, WaveliftCodec, WaveliftDense, WaveliftError, WaveliftLattice,
    WaveliftRowCodec, WaveliftRowDecoder, WaveliftRowEncoder, WaveliftSlabDecoder, WaveliftSlabEncoder,
    WaveliftTraining,
};
use wavelift_kernel::{SampleType, Wavelet};

type Declarations = BTreeSet<String>;

fn read(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The tokens of some C, a blank between each two.
fn spaced(text: &str) -> String {
    let mut spaced = String::new();
    let mut in_word = false;
    for letter in text.chars() {
        let is_word = letter.is_alphanumeric() || letter == '_';
        if !(is_word && in_word) {
            spaced.push(' ');
        }
        in_word = is_word;
        spaced.push(letter);
    }
    spaced.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A text without what stands between `/*` and `*/`.
fn without_comments(text: &str) -> String {
    let mut parts = text.split("/*");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |kept, part| kept + part.split_once("*/").expect("the comment ends").1)
}

/// What the header declares.
fn of_header(header: &str) -> Declarations {
    let mut declarations = Declarations::new();
    let (mut open, mut statement) = (0_usize, String::new());
    for line in without_comments(header).lines() {
        if let Some(constant) = line.strip_prefix("#define ") {
            declarations.extend(constant.contains(' ').then(|| spaced(constant)));
        }
        if line.starts_with('#') || line == "extern \"C\" {" || line == "}" {
            continue;
        }
        for letter in line.chars().chain(['\n']) {
            open = open + usize::from(letter == '{') - usize::from(letter == '}');
            if letter == ';' && open == 0 {
                add_statement(&spaced(&statement), &mut declarations);
                statement.clear();
            } else {
                statement.push(letter);
            }
        }
    }
    assert_eq!(statement.trim(), "", "the last declaration ends");
    declarations
}

/// The constants of an `enum` one by one, any other statement as it is.
fn add_statement(statement: &str, declarations: &mut Declarations) {
    match statement.strip_prefix("enum { ").and_then(|rest| rest.strip_suffix(" }")) {
        Some(constants) => {
            declarations.extend(constants.split(" , ").map(|constant| constant.replace("= ", "")))
        }
        None => {
            declarations.insert(statement.to_owned());
        }
    }
}

/// `WaveliftPlan` as `wavelift_plan`.
fn snake(name: &str) -> String {
    let mut snake = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.extend(letter.to_lowercase());
    }
    snake
}

/// The name of a type in C.
fn type_name(rust: &str) -> String {
    match rust {
        "c_char" => "char".to_owned(),
        "usize" => "size_t".to_owned(),
        "u8" | "u16" | "u32" | "u64" => format!("uint{}_t", &rust[1..]),
        "i32" => "int32_t".to_owned(),
        other => snake(other),
    }
}

/// The declaration in C of `name` as of type `ty`.
fn declared(ty: &Type, name: &str) -> String {
    match ty {
        Type::Ptr(pointer) => {
            let of = declared(&pointer.elem, &format!("*{name}"));
            if pointer.mutability.is_some() { of } else { format!("const {of}") }
        }
        Type::Array(array) => declared(&array.elem, &format!("{name}[{}]", integer(&array.len))),
        Type::Path(path) => {
            let segment = path.path.segments.last().expect("a name");
            format!("{} {name}", type_name(&segment.ident.to_string()))
        }
        _ => panic!("{name} is of a type that C has not"),
    }
}

fn integer(expression: &Expr) -> u64 {
    match expression {
        Expr::Lit(literal) => match &literal.lit {
            Lit::Int(int) => int.base10_parse().expect("a number"),
            _ => panic!("not a number"),
        },
        _ => panic!("not a literal"),
    }
}

/// What one item of the library is in C, if C sees it.
fn of_item(item: &Item) -> Vec<String> {
    match item {
        Item::Fn(function) if function.sig.abi.is_some() => {
            let arguments = function.sig.inputs.iter().map(|argument| match argument {
                FnArg::Typed(typed) => match &*typed.pat {
                    Pat::Ident(name) => declared(&typed.ty, &name.ident.to_string()),
                    _ => panic!("an argument without a name"),
                },
                FnArg::Receiver(_) => panic!("a method"),
            });
            let arguments = arguments.collect::<Vec<_>>().join(", ");
            let arguments = if arguments.is_empty() { "void" } else { &arguments };
            let call = format!("{}({arguments})", function.sig.ident);
            match &function.sig.output {
                ReturnType::Type(_, ty) => vec![declared(ty, &call)],
                ReturnType::Default => vec![format!("void {call}")],
            }
        }
        Item::Struct(structure) if matches!(structure.vis, Visibility::Public(_)) => {
            let name = snake(&structure.ident.to_string());
            let fields = structure
                .fields
                .iter()
                .map(|field| declared(&field.ty, &field.ident.as_ref().expect("a name").to_string()) + "; ");
            vec![format!("typedef struct {name} {{ {} }} {name}", fields.collect::<String>())]
        }
        Item::Enum(list) => {
            let constants = list.variants.iter().map(|variant| {
                let (_, value) = variant.discriminant.as_ref().expect("a value");
                format!("WAVELIFT_{} {}", snake(&variant.ident.to_string()).to_uppercase(), integer(value))
            });
            let own = format!("typedef int32_t {}", snake(&list.ident.to_string()));
            constants.chain([own]).collect()
        }
        _ => vec![],
    }
}

/// What the macros of the library declare, which a parser does not see.
fn of_macros() -> Vec<String> {
    let errors =
        WaveliftError::ALL.iter().map(|(code, name)| format!("{} {code}", name.to_str().expect("ASCII")));
    let states = [
        ("codec", WaveliftCodec::WORDS),
        ("training", WaveliftTraining::WORDS),
        ("dense", WaveliftDense::WORDS),
        ("lattice", WaveliftLattice::WORDS),
        ("row_codec", WaveliftRowCodec::WORDS),
        ("row_encoder", WaveliftRowEncoder::WORDS),
        ("row_decoder", WaveliftRowDecoder::WORDS),
        ("slab_encoder", WaveliftSlabEncoder::WORDS),
        ("slab_decoder", WaveliftSlabDecoder::WORDS),
    ];
    let states = states.into_iter().flat_map(|(name, words)| {
        let constant = format!("WAVELIFT_{}_WORDS", name.to_uppercase());
        let state = format!("wavelift_{name}");
        [
            format!("typedef struct {state} {{ uint64_t opaque[{constant}]; }} {state}"),
            format!("{constant} {words}"),
        ]
    });
    errors.chain(states).chain(["typedef int32_t wavelift_error".to_owned()]).collect()
}

/// The numbers of the kernel's own enums, and other constants.
fn of_constants() -> Vec<String> {
    let types = SampleType::ALL.iter().zip(0..).map(|(one, number)| (one.name(), number));
    let wavelets = Wavelet::ALL.iter().zip(1..).map(|(one, number)| (one.name(), number));
    let named = types.chain(wavelets).chain([("no_wavelet", 0)]);
    let constants = named.map(|(name, number)| format!("WAVELIFT_{} {number}", name.to_uppercase()));
    constants.chain([format!("WAVELIFT_MAX_HEADER_BYTES {WAVELIFT_MAX_HEADER_BYTES}")]).collect()
}

/// What the library declares.
fn of_library() -> Declarations {
    let sources = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("src")).expect("the sources");
    let mut declarations = Declarations::new();
    for source in sources {
        let text = fs::read_to_string(source.expect("a file").path()).expect("text");
        let file = syn::parse_file(&text).expect("Rust");
        declarations.extend(file.items.iter().flat_map(of_item).map(|item| spaced(&item)));
    }
    declarations.extend(of_macros().iter().chain(&of_constants()).map(|item| spaced(item)));
    declarations
}

#[test]
fn the_header_declares_what_the_library_has() {
    let (header, library) = (of_header(&read("include/wavelift.h")), of_library());
    let only = |these: &Declarations, those: &Declarations| {
        these.difference(those).map(|one| format!("\n    {one}")).collect::<String>()
    };
    let (in_header, in_library) = (only(&header, &library), only(&library, &header));
    assert!(header == library, "only in the header:{in_header}\nonly in the library:{in_library}\n");
    assert!(header.len() > 60, "{} declarations were compared", header.len());
}

#[test]
fn a_difference_shows() {
    let header = read("include/wavelift.h");
    for (from, to) in [
        ("uint8_t level,", "uint16_t level,"),
        ("WAVELIFT_OVERLAP = 102", "WAVELIFT_OVERLAP = 103"),
        ("    uint8_t levels; ", "    uint8_t depth; "),
        ("const wavelift_plan *plan);", "wavelift_plan *plan);"),
        ("TRAINING_WORDS 1342", "TRAINING_WORDS 1341"),
    ] {
        assert!(header.contains(from), "{from}");
        assert_ne!(of_header(&header.replace(from, to)), of_library(), "{to}");
    }
}

#[test]
fn the_header_and_the_readme_tell_the_bytes_of_states() {
    let states = [
        size_of::<WaveliftCodec>(),
        size_of::<WaveliftTraining>(),
        size_of::<WaveliftDense>(),
        size_of::<WaveliftLattice>(),
        size_of::<WaveliftRowCodec>(),
        size_of::<WaveliftRowEncoder>(),
        size_of::<WaveliftRowDecoder>(),
        size_of::<WaveliftSlabEncoder>(),
        size_of::<WaveliftSlabDecoder>(),
    ];
    for bytes in states {
        let told =
            if bytes < 1000 { bytes.to_string() } else { format!("{},{:03}", bytes / 1000, bytes % 1000) };
        assert!(read("include/wavelift.h").contains(&format!(" {told} bytes. */")), "{told}");
        assert!(read("README.md").contains(&format!("| {told} |")), "{told}");
    }
}
