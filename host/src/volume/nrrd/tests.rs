use std::path::Path;

use super::*;
use crate::volume::synthetic::{Kind, generate};
use crate::volume::{
    ElementType, ExtentError, Fault, Found, Volume, WriteOptions, read as read_volume, read_all,
};

/// A header after the examples of the format's definition, in unusual spelling.
const RICH: &str = "NRRD0005\r
# Complete NRRD file format specification at:\r
# http://teem.sourceforge.net/nrrd/format.html\r
Type: Unsigned  Short\r
dimension: 3\r
space: left-posterior-superior\r
sizes: 3 2 1\r
SpaceDirections: (3.2,0,0) (0,3.2,0) (0,0,1.5)\r
kinds: domain domain domain\r
ENDIAN: Big\r
encoding: RAW\r
space origin: (-10.50,1e-3,7)\r
measurement frame: (1,0,0) (0,1,0) (0,0,1)\r
old min: 0\r
labels: \"x\" \"y: z\" \"#\"\r
content: a head: in slices, a:=b\r
number: 6\r
key:=  a value, with \\n and \\\\n and \\t\r
DICOM: 0010:=x: y\r
type:=of the scanner\r
future field: 3\r
#last\r
\r
";

const RICH_SAMPLES: [u8; 12] = [0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6];

fn read_bytes(bytes: &[u8]) -> Result<Volume, ReadError> {
    read_all(Path::new("memory"), Nrrd.open_input(Input::from_bytes(bytes))?)
}

fn fault(header: &str) -> NrrdError {
    match read_bytes(header.as_bytes()).unwrap_err() {
        error @ ReadError::Nrrd { .. } if error.kind() != Fault::Data => panic!("{error}"),
        ReadError::Nrrd { cause, .. } => cause,
        other => panic!("{other}"),
    }
}

fn field(name: &str, value: &str) -> HeaderLine {
    HeaderLine::Field { name: name.to_owned(), value: value.to_owned() }
}

fn pair(key: &str, value: &str) -> HeaderLine {
    HeaderLine::KeyValue { key: key.to_owned(), value: value.to_owned() }
}

fn rich() -> Volume {
    read_bytes(&[RICH.as_bytes(), &RICH_SAMPLES].concat()).unwrap()
}

#[test]
fn every_line_of_a_rich_header_is_understood() {
    let volume = rich();
    assert_eq!((volume.extent, volume.element), ([3, 2, 1], ElementType::U16));
    assert_eq!(volume.samples, [1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0]);
    assert_eq!(volume.metadata.rank(), 3);
    assert_eq!(volume.metadata.source.byte_order, ByteOrder::Big);
    assert_eq!(volume.metadata.spacing(), Some([3.2, 3.2, 1.5]));
    assert_eq!(volume.metadata.origin(), Some(vec![-10.5, 1e-3, 7.0]));
    assert_eq!(
        volume.metadata.lines,
        [
            HeaderLine::Comment(" Complete NRRD file format specification at:".to_owned()),
            HeaderLine::Comment(" http://teem.sourceforge.net/nrrd/format.html".to_owned()),
            field("space", "left-posterior-superior"),
            field("SpaceDirections", "(3.2,0,0) (0,3.2,0) (0,0,1.5)"),
            field("kinds", "domain domain domain"),
            field("space origin", "(-10.50,1e-3,7)"),
            field("measurement frame", "(1,0,0) (0,1,0) (0,0,1)"),
            field("old min", "0"),
            field("labels", "\"x\" \"y: z\" \"#\""),
            field("content", "a head: in slices, a:=b"),
            pair("key", "  a value, with \n and \\n and \\t"),
            pair("DICOM: 0010", "x: y"),
            pair("type", "of the scanner"),
            field("future field", "3"),
            HeaderLine::Comment("last".to_owned()),
        ]
    );
}

#[test]
fn a_written_header_has_every_line_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("b.nrrd");
    let volume = rich();
    assert!(crate::volume::write(&volume, &path, &WriteOptions::default()).unwrap().is_empty());
    let bytes = fs::read(&path).unwrap();
    let start = "NRRD0005\ntype: uint16\ndimension: 3\nsizes: 3 2 1\nendian: big\nencoding: raw\n# Complete";
    assert!(bytes.starts_with(start.as_bytes()));
    assert!(bytes.ends_with(b"future field: 3\n#last\n\n\0\x01\0\x02\0\x03\0\x04\0\x05\0\x06"));
    assert_eq!(read_volume(&path, None).unwrap(), volume);
}

#[test]
fn lines_that_would_break_a_header_are_left_out_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("b.nrrd");
    let mut volume = generate(Kind::Noise, [2, 2, 1], ElementType::U8, 0);
    let good = [field("content", "ok"), pair("a\n", "b\r\nc\\")];
    volume.metadata.source.format = FileFormat::Nrrd;
    volume.metadata.lines = vec![
        field("content", "x\n\nsamples"),
        field("sizes", "9 9"),
        field("content", " blank"),
        HeaderLine::Comment("cut\r".to_owned()),
        pair("type: x", "y"),
        pair("k", "ends in\r"),
        pair("#k", "v"),
    ];
    volume.metadata.lines.extend(good.clone());
    let losses = crate::volume::write(&volume, &path, &WriteOptions::default()).unwrap();
    assert_eq!(losses.len(), 7);
    assert_eq!(losses[3], "comment \"cut\\r\"");
    assert_eq!(losses[1], "sizes");
    volume.metadata.lines = good.to_vec();
    assert_eq!(read_volume(&path, None).unwrap(), volume);
}

#[test]
fn every_type_order_encoding_and_form_comes_back() {
    let mut forms = [("a.nrrd", [5, 4, 3]), ("a.NHDR", [5, 4, 1]), ("a.nhdr", [5, 1, 1])].into_iter().cycle();
    for element in ElementType::ALL {
        for byte_order in [ByteOrder::Little, ByteOrder::Big] {
            for gzip in [false, true] {
                let (name, extent) = forms.next().unwrap();
                let folder = tempfile::tempdir().unwrap();
                let path = folder.path().join(name);
                let mut volume = generate(Kind::Noise, extent, element, 1);
                let options = WriteOptions { byte_order: Some(byte_order), gzip };
                assert!(crate::volume::write(&volume, &path, &options).unwrap().is_empty());
                let byte_order = if element.bytes() == 1 { ByteOrder::Little } else { byte_order };
                volume.metadata.source =
                    Origin { format: FileFormat::Nrrd, byte_order, fortran_order: false };
                assert_eq!(read_volume(&path, None).unwrap(), volume);
                let data = folder.path().join(if gzip { "a.raw.gz" } else { "a.raw" });
                assert_eq!(data.exists(), name != "a.nrrd");
            }
        }
    }
}

#[test]
fn all_names_of_types_are_known() {
    for (element, names) in [
        (ElementType::I8, "signed char,int8,int8_t"),
        (ElementType::U8, "uchar,unsigned char,uint8,uint8_t"),
        (ElementType::I16, "short,short int,signed short,signed short int,int16,int16_t"),
        (ElementType::U16, "ushort,unsigned short,unsigned short int,uint16,uint16_t"),
        (ElementType::I32, "int,signed int,int32,int32_t"),
        (ElementType::U32, "uint,unsigned int,uint32,uint32_t"),
        (
            ElementType::I64,
            "longlong,long long,long long int,signed long long,signed long long int,int64,int64_t",
        ),
        (ElementType::U64, "ulonglong,unsigned long long,unsigned long long int,uint64,uint64_t"),
        (ElementType::F32, "float"),
        (ElementType::F64, "double"),
    ] {
        for name in names.split(',') {
            let header =
                format!("NRRD0001\ntype: {name}\ndimension: 1\nsizes: 1\nendian: little\nencoding: raw\n\n");
            let file = [header.as_bytes(), &vec![1; element.bytes()]].concat();
            assert_eq!(read_bytes(&file).unwrap().element, element, "{name}");
        }
        assert!(names.split(',').any(|name| name == type_name(element)));
    }
}

#[test]
fn detached_samples_are_found_beside_their_header() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nhdr");
    let read_with = |lines: &str, data: &[u8]| {
        fs::write(folder.path().join("my data.bin"), data).unwrap();
        let header =
            format!("NRRD0004\ntype: uchar\ndimension: 2\nsizes: 2 2\n{lines}datafile: ./my data.bin\n");
        fs::write(&path, header).unwrap();
        read_volume(&path, None).map(|volume| volume.samples)
    };
    assert_eq!(read_with("encoding: raw\n", b"abcd").unwrap(), b"abcd");
    assert_eq!(read_with("encoding: raw\nline skip: 2\n", b"P5\n2 2\nabcd").unwrap(), b"abcd");
    assert_eq!(read_with("encoding: raw\nlineskip: 1\nbyte skip: 3\n", b"P5\n123abcd").unwrap(), b"abcd");
    assert_eq!(read_with("encoding: raw\nbyte skip: -1\n", b"some header abcd").unwrap(), b"abcd");

    let gzip = |bytes: &[u8]| {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    };
    assert_eq!(read_with("encoding: gz\nbyteskip: 3\n", &gzip(b"123abcd")).unwrap(), b"abcd");
    let two_members = [b"line\n".to_vec(), gzip(b"ab"), gzip(b"cd")].concat();
    assert_eq!(read_with("encoding: gzip\nline skip: 1\n", &two_members).unwrap(), b"abcd");

    let error =
        read_with("encoding: raw\nline skip: 999999999999\nbyte skip: 99999999999\n", b"abcd").unwrap_err();
    assert!(matches!(error, ReadError::SampleBytes { found: Found::Exactly(0), .. }));
    let error = read_with("encoding: raw\nbyte skip: -1\n", b"abc").unwrap_err();
    assert!(matches!(error, ReadError::SampleBytes { found: Found::Exactly(3), .. }));
    let error = read_with("encoding: gzip\n", &gzip(&[0; 1_000_000])).unwrap_err();
    assert!(matches!(error, ReadError::SampleBytes { found: Found::MoreThan(4), .. }));
    let error = read_with("encoding: gzip\nbyte skip: -1\n", &gzip(b"abcd")).unwrap_err();
    assert!(matches!(error, ReadError::Nrrd { cause: NrrdError::SkipToEnd, .. }));
    fs::remove_file(folder.path().join("my data.bin")).unwrap();
    let error = read_volume(&path, None).unwrap_err();
    assert_eq!(error.kind(), Fault::Io);
    assert!(error.to_string().contains("my data.bin: cannot read: No such file"), "{error}");
}

#[test]
fn samples_in_several_files_are_joined() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nhdr");
    for (index, bytes) in [b"#ab", b"#cd", b"#ef"].iter().enumerate() {
        fs::write(folder.path().join(format!("s{:02}.raw", 2 * index)), bytes).unwrap();
    }
    for (lines, expected) in [
        ("data file: s%02d.raw 0 4 2", b"abcdef"),
        ("data file: s%02d.raw 4 0 -2 2", b"efcdab"),
        ("data file: LIST\ns00.raw\ns04.raw\n./s02.raw\n", b"abefcd"),
    ] {
        let header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 1 3\nencoding: raw\nbyte skip: 1\n";
        fs::write(&path, format!("{header}{lines}")).unwrap();
        assert_eq!(read_volume(&path, None).unwrap().samples, expected);
    }
    fs::remove_file(folder.path().join("s02.raw")).unwrap();
    assert_eq!(read_volume(&path, None).unwrap_err().kind(), Fault::Io);
}

#[test]
fn a_detached_pair_replaces_its_own_files_only() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scan.nhdr");
    let volume = generate(Kind::Noise, [4, 4, 1], ElementType::U8, 1);
    let write = |path: &Path| crate::volume::write(&volume, path, &WriteOptions::default());
    fs::write(folder.path().join("scan.raw"), "the only copy").unwrap();
    let error = write(&path).unwrap_err();
    assert_eq!(error.kind(), Fault::Usage);
    assert!(error.to_string().contains("choose another name"));
    assert!(!path.exists());
    fs::remove_file(folder.path().join("scan.raw")).unwrap();
    write(&path).unwrap();
    write(&path).unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn what_is_no_volume_is_refused_by_name() {
    let header = |lines: &str| fault(&format!("NRRD0004\n{lines}\n\n"));
    let base = "type: float\nendian: little\nencoding: raw\n";
    let value =
        |field, value: &str, expected| NrrdError::Value { field, value: format!("{value:?}"), expected };
    assert_eq!(fault("NRRD0009\n\n"), NrrdError::Magic { found: "\"NRRD0009\"".to_owned() });
    assert_eq!(fault(""), NrrdError::Magic { found: "\"\"".to_owned() });
    assert_eq!(
        fault("NRRD0001\n# fine\nnonsense\u{1b}[31m\n\n"),
        NrrdError::Line { number: 3, text: "\"nonsense\\u{1b}[31m\"".to_owned() }
    );
    assert_eq!(header(""), NrrdError::Missing { field: "dimension" });
    assert_eq!(header("dimension: 0"), NrrdError::Dimension { found: 0 });
    assert_eq!(header("dimension: 17\nsizes: 3"), NrrdError::Dimension { found: 17 });
    assert_eq!(header("dimension: x"), value("dimension", "x", "a number from 1 up"));
    assert_eq!(header("dimension: 2\nDimension: 2"), NrrdError::Repeated { field: "dimension" });
    assert_eq!(header("dimension: 2"), NrrdError::Missing { field: "sizes" });
    let sizes = |sizes: &str| header(&format!("dimension: 2\nsizes: {sizes}\n{base}"));
    assert_eq!(sizes("2 -2"), value("sizes", "2 -2", "a list of whole numbers"));
    assert_eq!(sizes("2"), value("sizes", "2", "as many numbers as `dimension` says"));
    assert_eq!(sizes("2 0"), NrrdError::Extent(ExtentError::ZeroAxis { axis: 'y' }));
    assert_eq!(sizes("4294967296 4294967296"), NrrdError::Extent(ExtentError::TooLarge));
    let lines = |lines: &str| header(&format!("dimension: 1\nsizes: 1\n{lines}"));
    assert_eq!(lines("type: block"), NrrdError::BlockType);
    assert_eq!(lines("type: char"), value("type", "char", "a type of the NRRD format"));
    for encoding in ["zrl", "b64"] {
        let found = format!("{encoding:?}");
        assert_eq!(lines(&format!("type: uchar\nencoding: {encoding}")), NrrdError::Encoding { found });
    }
    assert_eq!(lines("type: float\nencoding: raw"), NrrdError::Missing { field: "endian" });
    assert_eq!(lines("type: float\nencoding: raw\nendian: pdp"), value("endian", "pdp", "`little` or `big`"));
    let files = |files: &str| lines(&format!("{base}data file: {files}"));
    assert_eq!(files("LIST"), NrrdError::Files { count: 0 });
    let pattern =
        |first, last, step| NrrdError::Pattern { found: "\"s%03d.raw\"".to_owned(), first, last, step };
    assert_eq!(files("s%03d.raw 0 10 0"), pattern(0, 10, 0));
    assert_eq!(files("s%03d.raw 10 0 1 2"), pattern(10, 0, 1));
    assert_eq!(files("s%03d.raw 0 1 1"), NrrdError::Files { count: 2 });
    assert_eq!(lines(&format!("{base}line skip: -1")), value("line skip", "-1", "a number from 0 up"));
    assert_eq!(lines(&format!("{base}byte skip: -2")), value("byte skip", "-2", "-1 or a number from 0 up"));
    assert_eq!(fault(&format!("NRRD0001\ndimension: 1\nsizes: 1\n{base}")), NrrdError::NoSamples);
    let endless = format!("NRRD0001\n{}", "#\n".repeat(1 << 20));
    assert_eq!(fault(&endless), NrrdError::HeaderTooLong { limit: 1 << 20 });
    assert_eq!(fault(&endless.replace("\n#", "#")), NrrdError::HeaderTooLong { limit: 1 << 20 });
}

/// A file of 5 x 4 x 3 samples with axes of components and time, whose values count up in the order of the file.
fn file_of_axes(sizes: &str, lines: &str) -> (Vec<u8>, Vec<u8>) {
    let counts = sizes.split(' ').map(|size| size.parse::<usize>().unwrap());
    let header = format!(
        "NRRD0004\ntype: uint8\ndimension: {}\nsizes: {sizes}\nencoding: raw\n{lines}\n",
        sizes.split(' ').count()
    );
    let values: Vec<u8> = (0..counts.product::<usize>()).map(|value| value as u8).collect();
    ([header.as_bytes(), &values].concat(), values)
}

fn read_values(bytes: &[u8]) -> (crate::volume::Header, Vec<u8>) {
    let mut source = Nrrd.open_input(Input::from_bytes(bytes)).unwrap();
    let header = source.header().clone();
    let mut values = vec![0; header.bytes().unwrap() as usize];
    source.read(&mut values).unwrap();
    (header, values)
}

#[test]
fn components_and_time_are_read_and_written_as_they_lie() {
    for (sizes, lines, components, steps, is_canonical) in [
        ("3 5 4", "kinds: RGB-color domain domain\nspacings: nan 0.5 2\n", 3, 1, true),
        ("2 5 4 3", "", 2, 1, true),
        ("5 4 3 2", "", 1, 2, true),
        ("2 5 4 3 2", "labels: \"re im\" \"x\" \"y\" \"z\" \"t\"\n", 2, 2, true),
        ("5 4 3 4", "kinds: domain domain domain 4-color\n", 4, 1, false),
        (
            "5 4 3 3",
            "kinds: space space space list\nspace dimension: 3\nspace directions: (1,0,0) (0,1,0) (0,0,1) none\n",
            1,
            3,
            true,
        ),
        ("4 5 4 3", "kinds: time domain domain domain\n", 1, 4, false),
        ("5 2 4 3 2", "kinds: domain vector domain domain list\n", 2, 2, false),
    ] {
        let (bytes, values) = file_of_axes(sizes, lines);
        let (header, found) = read_values(&bytes);
        assert_eq!((header.components, header.steps), (components, steps), "{sizes}");
        assert_eq!(header.extent, if sizes == "3 5 4" { [5, 4, 1] } else { [5, 4, 3] });
        assert_eq!(found == values, is_canonical, "{sizes}");
        let folder = tempfile::tempdir().unwrap();
        for gzip in [false, true] {
            let path = folder.path().join("b.nrrd");
            let Created { mut sink, losses } =
                crate::volume::create(&path, &header, &WriteOptions { byte_order: None, gzip }).unwrap();
            found.chunks(7).for_each(|piece| sink.write(piece).unwrap());
            sink.finish().unwrap();
            assert!(losses.is_empty());
            let written = fs::read(&path).unwrap();
            assert!(gzip || written == bytes, "{}", String::from_utf8_lossy(&written));
            assert_eq!(read_values(&written), (header.clone(), found.clone()));
        }
    }
}

#[test]
fn axes_that_the_lines_do_not_speak_of_are_filled_in() {
    let mut metadata = Metadata::default();
    metadata.set_field("spacings", "1 2 3");
    let mut header = crate::volume::Header::scalar([5, 4, 3], ElementType::U8, metadata);
    (header.components, header.steps) = (7, 2);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("b.nrrd");
    let mut sink = crate::volume::create(&path, &header, &WriteOptions::default()).unwrap().sink;
    sink.write(&[1; 840]).unwrap();
    sink.finish().unwrap();
    let (found, _) = read_values(&fs::read(&path).unwrap());
    assert_eq!((found.extent, found.components, found.steps), (header.extent, 7, 2));
    let lines = [field("spacings", "nan 1 2 3 nan"), field("kinds", "vector domain domain domain list")];
    assert_eq!(found.metadata.lines, lines);
    assert_eq!(found.metadata.spacing(), Some([1.0, 2.0, 3.0]));
}

#[test]
fn text_in_latin_1_is_read_and_comes_back_as_utf_8() {
    let header = b"NRRD0001\ntype: uchar\ndimension: 1\nsizes: 1\nencoding: raw\nsample units: \xb5m\n\n!";
    assert_eq!(read_bytes(header).unwrap().metadata.field("sampleunits"), Some("µm"));
}

#[test]
fn hostile_files_return() {
    let raw = [RICH.as_bytes(), &RICH_SAMPLES].concat();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nrrd");
    crate::volume::write(&rich(), &path, &WriteOptions { byte_order: None, gzip: true }).unwrap();
    let gzip = fs::read(&path).unwrap();
    for bytes in [raw, gzip] {
        for end in 0..bytes.len() {
            assert_eq!(read_bytes(&bytes[..end]).unwrap_err().kind(), Fault::Data, "{end}");
        }
        for index in 0..bytes.len() {
            for change in 1..=255 {
                let mut changed = bytes.clone();
                changed[index] ^= change;
                if let Ok(volume) = read_bytes(&changed) {
                    assert_eq!(volume.samples.len(), 12);
                }
            }
        }
    }
    let promise = "NRRD0001\ntype: double\nendian: little\ndimension: 3\nsizes: 1000000 1000000 1000000\n";
    for (encoding, expected) in [("raw", Found::Exactly(10)), ("gzip", Found::AtMost(10_320))] {
        let file = format!("{promise}encoding: {encoding}\n\n0123456789");
        match read_bytes(file.as_bytes()).unwrap_err() {
            ReadError::SampleBytes { found, .. } => assert_eq!(found, expected),
            other => panic!("{other}"),
        }
    }
}

/// Made by Python's module bz2 of the twelve bytes of the samples.
const BZIP2: &[u8] = &[
    0x42, 0x5A, 0x68, 0x39, 0x31, 0x41, 0x59, 0x26, 0x53, 0x59, 0x7A, 0xF6, 0x3B, 0x33, 0x00, 0x00, 0x00,
    0xD0, 0x40, 0xE6, 0x00, 0x00, 0x04, 0x40, 0x00, 0x00, 0x01, 0xA0, 0x00, 0x31, 0x0C, 0x08, 0x20, 0x69,
    0xE9, 0x31, 0x87, 0x35, 0x63, 0xFD, 0x82, 0xEE, 0x48, 0xA7, 0x0A, 0x12, 0x0F, 0x5E, 0xC7, 0x66, 0x60,
];

#[test]
fn samples_as_text_and_in_bzip2_are_read() {
    let file = |encoding: &str, samples: &[u8]| {
        let head =
            format!("NRRD0004\ntype: short\ndimension: 2\nsizes: 3 2\nendian: big\nencoding: {encoding}\n\n");
        [head.as_bytes(), samples].concat()
    };
    let values = [1_i16, -2, 300, 4, 5, -32768];
    let expected = values.map(i16::to_le_bytes).concat();
    for (encoding, samples) in [
        ("ascii", &b"1 -2\t300\n4, 5,-32768"[..]),
        ("text", b"1 -2 300 4 5 -32768\n"),
        ("hex", b"0001fffe\n012C0004 00 05 8000\n"),
        ("bzip2", BZIP2),
        ("bz2", BZIP2),
    ] {
        assert_eq!(read_bytes(&file(encoding, samples)).unwrap().samples, expected, "{encoding}");
    }
    for (encoding, samples, told) in [
        ("ascii", &b"1 -2 300 4 5"[..], "the file has 10"),
        ("ascii", b"1 -2 300 4 5 6 7", "the file has more than 12"),
        ("ascii", b"1 -2 300 4 5 40000", "\"40000\" is no i16"),
        ("ascii", &[b'1'; 600], "more than 512 digits"),
        ("hex", b"0001", "the file has 2"),
        ("hex", b"0001fffe012c000400058000 00", "the file has more than 12"),
        ("hex", b"0001ff", "the file has 3"),
        ("hex", b"0001f", "one digit only"),
        ("hex", b"zz", "'z' is no digit"),
        ("bzip2", &BZIP2[..30], "are bzip2, are damaged"),
        ("bzip2", b"BZh9", "are bzip2, are damaged"),
    ] {
        let error = read_bytes(&file(encoding, samples)).unwrap_err();
        assert!(error.kind() == Fault::Data && error.to_string().contains(told), "{encoding}: {error}");
    }
    let several = file("hex\ndata file: a%d.raw 1 2 1", b"");
    assert!(read_bytes(&several).unwrap_err().to_string().contains("in several files"));
}
