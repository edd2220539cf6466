use std::fs;

use super::*;
use crate::volume::synthetic::{Kind, generate};
use crate::volume::{ByteOrder, ElementType, HeaderLine, Metadata, create, open};

/// As `vtkXMLImageDataWriter` writes it, shortened; turned axes, an extent that does not begin at 0.
const ASCII: &str = r#"<?xml version="1.0"?>
<!-- a comment -->
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
  <ImageData WholeExtent="2 5 0 2 -1 0" Origin="1.5 -2 0.1" Spacing="0.5 0.25 3" Direction="0 1 0 1 0 0 0 0 1">
  <FieldData>
    <DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii"> 7 </DataArray>
    <Array type="String" Name="note" NumberOfTuples="1" format="ascii"> 65 60 0 </Array>
  </FieldData>
  <Piece Extent="2 5 0 2 -1 0">
    <PointData Scalars="a &lt;b&gt;">
      <DataArray type="Float32" Name="speed" format="ascii"> 1 2 </DataArray>
      <DataArray type="Int16" Name="a &lt;b&gt;" format="ascii" RangeMin="0" RangeMax="23">
        0 -1 2 3 4 5 6 7 8 9 10 11
        12 13 14 15 16 17 18 19 20 21 22 23
        <InformationKey name="L2_NORM_RANGE" location="vtkDataArray" length="1">
          <Value index="0"> 2 </Value>
        </InformationKey>
      </DataArray>
    </PointData>
    <CellData Vectors="v">
      <DataArray type="UInt8" Name="v" NumberOfComponents="3" format="ascii">
        1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18
      </DataArray>
    </CellData>
  </Piece>
  </ImageData>
</VTKFile>
"#;

/// As VTK writes it: an array of 24 shorts, 0 to 23, compressed, with words of 32 bits, both big-endian.
const BASE64: &str = r#"<VTKFile type="ImageData" version="0.1" byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor">
  <ImageData WholeExtent="0 3 0 2 0 1" Origin="0 0 0" Spacing="1 1 1">
  <Piece Extent="0 3 0 2 0 1">
    <PointData Scalars="my data">
      <DataArray type="Int16" Name="my data" format="binary" RangeMin="0" RangeMax="23">
        AQAAAAAAAAAAgAAAAAAAADAAAAAAAAAALAAAAAAAAAA=eF4FwYUBgCAAALBZGIABIv9/6sZgNJktgtVmd4iS7HS5PYrq1Xy6HxIoARU=
      </DataArray>
    </PointData>
  </Piece>
  </ImageData>
</VTKFile>
"#;

/// The same, appended and not compressed: bytes of cells, in base64.
const APPENDED: &str = r#"<?xml version="1.0"?>
<VTKFile type="ImageData" version="0.1" byte_order="BigEndian" header_type="UInt32">
  <ImageData WholeExtent="0 3 0 1 0 0" Origin="0 0 0" Spacing="1 2 4">
    <Piece Extent="0 3 0 1 0 0">
      <CellData>
        <DataArray type="UInt16" Name="c" format="appended" offset="4"/>
      </CellData>
    </Piece>
  </ImageData>
  <AppendedData encoding="base64">
   _AAAAAAAABgABAAIBAw==
  </AppendedData>
</VTKFile>
"#;

const LEGACY: &str = "# vtk DataFile Version 5.1
a title, \u{e9}
ASCII
DATASET STRUCTURED_POINTS
FIELD FieldData 2
TIME 1 1 double
0.5
note 1 1 string
two words
METADATA
INFORMATION 0

DIMENSIONS 3 2 1
aspect_ratio 1 2 1e-3
ORIGIN 0 -1 2
CELL_DATA 2
SCALARS cell int
LOOKUP_TABLE default
7 -8
POINT_DATA 6
NORMALS n float
0 0 1 0 0 1 0 0 1
0 0 1 0 0 1 0 0 1
METADATA
INFORMATION 1
NAME L2_NORM_RANGE LOCATION vtkDataArray
DATA 2 2.23607 121.252

COLOR_SCALARS my%20data 1
0 0.00392157 0.501961 0.498039 0.99607843 1
LOOKUP_TABLE table 1
0 0 0 1
FIELD FieldData 1
f 2 6 vtkTypeUInt64
1 2 3 4 5 6 7 8 9 10 11 18446744073709551615
";

fn values_of(mut source: Box<dyn Source>) -> Result<(Header, Vec<u8>), ReadError> {
    let header = source.header().clone();
    let mut values = Vec::new();
    let row = header.plane_bytes().unwrap() as usize / header.extent[1] as usize;
    while (values.len() as u64) < header.bytes().unwrap() {
        let start = values.len();
        values.resize(start + row, 0);
        source.read(&mut values[start..])?;
    }
    Ok((header, values))
}

fn read(text: &[u8], name: Option<&str>) -> Result<(Header, Vec<u8>), ReadError> {
    let input = Input::from_bytes(text);
    values_of(if text.starts_with(b"# vtk") { legacy::open(input, name)? } else { xml::open(input, name)? })
}

fn written(header: &Header, values: &[u8], name: &str, options: &WriteOptions) -> (Vec<u8>, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    let Created { mut sink, losses } = create(&path, header, options).unwrap();
    let size = header.element.bytes();
    let (first, rest) = values.split_at(values.len() / size / 3 * size);
    sink.write(first).unwrap();
    sink.write(rest).unwrap();
    sink.finish().unwrap();
    assert_eq!(values_of(open(&path, None).unwrap()).unwrap().1, values, "{name}");
    (fs::read(path).unwrap(), losses)
}

fn message(text: &str, name: Option<&str>) -> String {
    match read(text.as_bytes(), name) {
        Err(ReadError::Format { cause, .. }) => cause.to_string(),
        Err(other) => other.to_string(),
        Ok(_) => "no error".to_owned(),
    }
}

fn shorts(values: impl IntoIterator<Item = i16>) -> Vec<u8> {
    values.into_iter().flat_map(i16::to_le_bytes).collect()
}

/// An image of 3 components, for which rows of blocks do not end with blocks.
fn noise(element: ElementType) -> (Header, Vec<u8>) {
    let volume = generate(Kind::Waves, [50, 21, 3 * 7], element, 1);
    let mut metadata = Metadata::default();
    metadata.lines.push(HeaderLine::Field { name: "content".into(), value: "a \"%20\" b\u{e9}".into() });
    (Header { extent: [50, 21, 7], components: 3, steps: 1, element, metadata }, volume.samples)
}

#[test]
fn every_type_order_and_form_comes_back() {
    let orders = [ByteOrder::Little, ByteOrder::Big].into_iter().cycle();
    for (element, order) in ElementType::ALL.into_iter().zip(orders) {
        let (header, values) = noise(element);
        for (name, gzip) in [("a.vtk", false), ("a.VTI", false), ("a.vti", true)] {
            let byte_order = if name == "a.vtk" { None } else { Some(order) };
            let (bytes, losses) = written(&header, &values, name, &WriteOptions { byte_order, gzip });
            assert!(losses.is_empty(), "{losses:?}");
            let (found, again) = read(&bytes, None).unwrap();
            assert!(again == values, "{element} {name}");
            assert_eq!((found.extent, found.components, found.element), (header.extent, 3, element));
            assert_eq!(found.metadata.name(), header.metadata.name());
            let expected = if name == "a.vtk" { ByteOrder::Big } else { order };
            let expected = if element.bytes() == 1 { ByteOrder::Little } else { expected };
            assert_eq!(found.metadata.source.byte_order, expected);
            // Written once more, a file is the same.
            let options = WriteOptions { byte_order: byte_order.filter(|_| element.bytes() == 1), gzip };
            assert!(written(&found, &values, name, &options).0 == bytes);
        }
    }
}

#[test]
fn the_files_of_vtk_are_understood() {
    let (header, values) = read(ASCII.as_bytes(), None).unwrap();
    assert_eq!((header.extent, header.element), ([4, 3, 2], ElementType::I16));
    assert_eq!(values, shorts([0, -1].into_iter().chain(2..24)));
    assert_eq!(header.metadata.name(), Some("a <b>"));
    assert_eq!(header.metadata.spacing(), Some([0.5, 0.25, 3.0]));
    assert_eq!(header.metadata.directions().unwrap()[0], [0.0, 0.5, 0.0]);
    assert_eq!(header.metadata.origin(), Some(vec![1.5, -1.0, -2.9]));
    assert_eq!(header.metadata.key_value("vtk.left_out"), Some("\"speed\", \"v\""));

    let (header, values) = read(BASE64.as_bytes(), None).unwrap();
    assert_eq!((header.extent, values), ([4, 3, 2], shorts(0..24)));
    let (header, values) = read(APPENDED.as_bytes(), None).unwrap();
    assert_eq!((header.extent, values), ([3, 1, 1], shorts([1, 2, 259])));
    assert_eq!(header.metadata.origin(), Some(vec![0.5, 1.0, 0.0]));

    let (header, values) = read(LEGACY.as_bytes(), None).unwrap();
    assert_eq!(
        (header.extent, header.element, values),
        ([3, 2, 1], ElementType::U8, vec![0, 1, 128, 127, 254, 255])
    );
    assert_eq!(header.metadata.name(), Some("my data"));
    assert_eq!(header.metadata.spacing(), Some([1.0, 2.0, 1e-3]));
    assert_eq!(header.metadata.key_value("vtk.title"), Some("a title, \u{e9}"));
    assert_eq!(header.metadata.key_value("vtk.left_out"), Some("\"cell\", \"n\", \"f\""));
}

#[test]
fn any_array_can_be_named() {
    let (header, values) = read(ASCII.as_bytes(), Some("v")).unwrap();
    assert_eq!((header.extent, header.components), ([3, 2, 1], 3));
    assert_eq!(values, (1..19).collect::<Vec<u8>>());
    let (header, values) = read(LEGACY.as_bytes(), Some("cell")).unwrap();
    assert_eq!((header.extent, values), ([2, 1, 1], vec![7, 0, 0, 0, 0xf8, 255, 255, 255]));
    let (header, values) = read(LEGACY.as_bytes(), Some("f")).unwrap();
    assert_eq!((header.components, &values[88..]), (2, &[255; 8][..]));
    assert_eq!(
        message(LEGACY, Some("g")),
        "it has no array \"g\"; there are: \"cell\", \"n\", \"my data\", \"f\""
    );
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.vti"), ASCII).unwrap();
    let path = folder.path().join("a.vti#v");
    assert_eq!(open(&path, None).unwrap().header().components, 3);
    assert_eq!(FileFormat::of_path(&path), FileFormat::VtkXml);
    fs::write(&path, BASE64).unwrap();
    assert_eq!(open(&path, None).unwrap().header().components, 1);
}

#[test]
fn grids_cells_marks_and_titles_are_written_again() {
    for (text, array) in [(ASCII, None), (ASCII, Some("v")), (APPENDED, None), (LEGACY, Some("n"))] {
        for name in ["a.vti", "a.vtk"] {
            let (mut header, values) = read(text.as_bytes(), array).unwrap();
            header
                .metadata
                .lines
                .retain(|line| !matches!(line, HeaderLine::KeyValue { key, .. } if key == "vtk.left_out"));
            let (bytes, losses) = written(&header, &values, name, &WriteOptions::default());
            let (mut found, again) = read(&bytes, None).unwrap();
            assert_eq!(again, values);
            let turned = text == ASCII && name == "a.vtk";
            let lost_title = text == LEGACY && name == "a.vti";
            assert_eq!(losses.len(), usize::from(turned) + usize::from(lost_title), "{losses:?}");
            if turned || lost_title {
                continue;
            }
            found.metadata.source = header.metadata.source;
            assert_eq!(found, header, "{name}");
        }
    }
}

#[test]
fn what_cannot_be_held_is_told() {
    let (mut header, values) = read(ASCII.as_bytes(), None).unwrap();
    header
        .metadata
        .lines
        .push(HeaderLine::Field { name: "space".into(), value: "left-posterior-superior".into() });
    let (_, losses) = written(&header, &values, "a.vti", &WriteOptions::default());
    assert_eq!(losses, ["space", "1 key/value pair"]);
    let folder = tempfile::tempdir().unwrap();
    let refused = |header: &Header, name: &str, byte_order, gzip| {
        let options = WriteOptions { byte_order, gzip };
        create(folder.path().join(name), header, &options).unwrap_err().to_string()
    };
    assert!(
        refused(&header, "a.vtk", Some(ByteOrder::Little), false)
            .contains("cannot hold little-endian samples")
    );
    assert!(refused(&header, "a.vtk", None, true).contains("leave gzip out"));
    header.steps = 2;
    assert!(refused(&header, "a.vti", None, false).contains("2 time steps"));
    header.steps = 1;
    let Created { sink, .. } =
        create(folder.path().join("a.vti"), &header, &WriteOptions::default()).unwrap();
    assert!(matches!(sink.finish(), Err(WriteError::SampleBytes { expected: 48, found: 0, .. })));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// A box of points by the first and the last of each axis, and their values in the image of all: x + 10 y + 100 z.
fn text_piece(ends: [[i64; 2]; 3], source: &str) -> String {
    let extent = ends.map(|[first, last]| format!("{first} {last}")).join(" ");
    if !source.is_empty() {
        return format!("<Piece Extent=\"{extent}\" Source=\"{source}\"/>");
    }
    let [x, y, z] = ends.map(|[first, last]| first..=last);
    let places = z
        .flat_map(|z| y.clone().flat_map(move |y| [(y, z)]))
        .flat_map(|(y, z)| x.clone().map(move |x| [x, y, z]));
    let values: Vec<String> = places.map(|[x, y, z]| (x + 10 * y + 100 * z).to_string()).collect();
    format!(
        "<Piece Extent=\"{extent}\"><PointData><DataArray type=\"Int16\" Name=\"other\"> 1 </DataArray>\
         <DataArray type=\"Int16\" Name=\"n\"> {} </DataArray></PointData></Piece>",
        values.join(" ")
    )
}

/// An image of 5 x 4 x 3 points, the first of which has the number 1 along y.
fn of_pieces(kind: &str, pieces: &[String]) -> String {
    format!(
        "<VTKFile type=\"{kind}\"><{kind} WholeExtent=\"0 4 1 4 0 2\" Spacing=\"1 2 3\">{}</{kind}></VTKFile>",
        pieces.join("\n")
    )
}

/// Reads the image in small slabs, from its middle and from its beginning on.
fn image_at(path: &Path) -> Result<(Header, Vec<u8>), ReadError> {
    let mut source = open(format!("{}#n", path.display()), None)?;
    source.hold_at_most(0);
    source.seek(60)?;
    let mut half = [0; 60];
    source.read(&mut half)?;
    source.seek(0)?;
    let (header, values) = values_of(source)?;
    assert_eq!(half, values[60..]);
    Ok((header, values))
}

fn numbered() -> Vec<u8> {
    shorts((0..60).map(|n| n % 5 + 10 * (1 + n / 5 % 4) + 100 * (n / 20)))
}

#[test]
fn pieces_of_a_file_are_put_together() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vti");
    let told = |pieces: &[[[i64; 2]; 3]]| {
        let pieces: Vec<String> = pieces.iter().map(|&ends| text_piece(ends, "")).collect();
        fs::write(&path, of_pieces("ImageData", &pieces)).unwrap();
        image_at(&path).map_err(|error| error.to_string())
    };
    let pieces = [[[0, 2], [1, 4], [0, 1]], [[0, -1], [0, -1], [0, -1]], [[2, 4], [1, 4], [0, 1]]];
    let last = [[0, 4], [1, 4], [1, 2]];
    let (header, values) = told(&[&pieces[..], &[last]].concat()).unwrap();
    assert_eq!((header.extent, header.metadata.spacing()), ([5, 4, 3], Some([1.0, 2.0, 3.0])));
    assert_eq!(values, numbered());
    assert!(told(&pieces).unwrap_err().ends_with("none of its pieces has the sample at 0, 0, 2"));
    assert!(
        told(&[[[0, 5], [1, 4], [0, 2]]])
            .unwrap_err()
            .ends_with("one of its pieces lies outside of the whole")
    );
    fs::write(&path, of_pieces("ImageData", &[text_piece(last, ""), "<Piece/>".to_owned()])).unwrap();
    assert!(image_at(&path).unwrap_err().to_string().ends_with("the array of one of its pieces is missing"));
    // As much as could be, and nothing there.
    let huge = of_pieces("ImageData", &[text_piece(last, "")]).replace("0 4 1 4", "0 4000000000 1 4");
    fs::write(&path, huge).unwrap();
    assert!(image_at(&path).is_err());
}

#[test]
fn files_of_a_list_are_put_together() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pvti");
    fs::create_dir(folder.path().join("parts")).unwrap();
    // The second file has ghosts, and says that the whole is no more than it.
    let parts = [[[0, 2], [1, 4], [0, 2]], [[1, 4], [1, 4], [0, 2]]];
    for (number, ends) in parts.into_iter().enumerate() {
        let part = of_pieces("ImageData", &[text_piece(ends, "")]).replace("0 4 1 4 0 2", "1 4 1 4 0 2");
        fs::write(folder.path().join(format!("parts/{number}.vti")), part).unwrap();
    }
    let array = "<PPointData Scalars=\"n\"><PDataArray type=\"Int16\" Name=\"n\"/></PPointData>".to_owned();
    let list = |first: [[i64; 2]; 3]| {
        let pieces = [text_piece(first, "parts/0.vti"), text_piece([[2, 4], [1, 4], [0, 2]], "parts/1.vti")];
        of_pieces("PImageData", &[std::slice::from_ref(&array), &pieces[..]].concat())
    };
    fs::write(&path, list(parts[0])).unwrap();
    let (header, values) = image_at(&path).unwrap();
    assert_eq!((header.extent, values), ([5, 4, 3], numbered()));
    assert_eq!(open(&path, None).unwrap().files().len(), 3);
    // The list says more than the file has.
    fs::write(&path, list([[0, 3], [1, 4], [0, 2]])).unwrap();
    let told = image_at(&path).unwrap_err().to_string();
    assert!(told.contains("0.vti: ") && told.contains("a.pvti lists it with"), "{told}");
    fs::remove_file(folder.path().join("parts/1.vti")).unwrap();
    fs::write(&path, list(parts[0])).unwrap();
    assert!(image_at(&path).unwrap_err().to_string().contains("1.vti: cannot read: No such file"));
    let refused = create(&path, &header, &WriteOptions::default()).unwrap_err();
    assert!(refused.to_string().contains("a list of pieces (.pvti) is not written"), "{refused}");
}

#[test]
fn every_place_can_be_gone_to() {
    let (header, values) = noise(ElementType::U32);
    let folder = tempfile::tempdir().unwrap();
    for gzip in [false, true] {
        let (bytes, _) =
            written(&header, &values, "a.vti", &WriteOptions { byte_order: Some(ByteOrder::Big), gzip });
        let path = folder.path().join("a.vti");
        fs::write(&path, bytes).unwrap();
        let mut source = open(&path, None).unwrap();
        assert!(source.is_random());
        let end = values.len() as u64;
        for position in [0, 32768, 32764, 65536 + 8, 4, end - 8, 32768 * 2, end, 100] {
            source.seek(position).unwrap();
            let mut found = vec![0; 4000.min(values.len() - position as usize)];
            source.read(&mut found).unwrap();
            assert!(found == values[position as usize..][..found.len()], "{position}");
        }
        source.seek(end).unwrap();
        assert!(matches!(source.read(&mut [0; 4]), Err(ReadError::BeyondEnd { .. })));
    }
}

#[test]
fn faults_are_named() {
    let lz4 = message(&BASE64.replace("vtkZLibDataCompressor", "vtkLZ4DataCompressor"), None);
    assert!(lz4.contains("its samples are damaged or cut short"), "{lz4}");
    let xml = |from: &str, to: &str| message(&ASCII.replacen(from, to, 9), None);
    assert!(xml("ImageData\"", "PolyData\"").contains("no image on a regular grid"));
    assert!(xml("0.5 0.25 3", "0.5 0.25").contains("Spacing is \"0.5 0.25\""));
    assert!(xml("2 5 0 2", "5 2 0 2").contains("an extent is"));
    assert!(xml("-1 0\"", "-1 9223372036854775807\"").contains("an extent is"));
    assert!(xml("0 2 -1 0\"", "0 3000000000 -1 9223372036\"").contains("64 bits"));
    assert!(message(&APPENDED.replace("UInt16", "Bit"), None).contains("values of type \"Bit\""));
    assert!(xml("0 -1 2", "0 40000 2").contains("\"40000\" is no number of type i16"));
    assert!(
        xml("UInt64", "UInt64\" compressor=\"vtkLZMADataCompressor")
            .contains("vtkLZ4DataCompressor are read")
    );
    assert!(xml("<VTKFile", "<VTK").contains("VTKFile is missing"));
    assert!(
        message(&ASCII.replace("Name=\"v\"", &format!("Name=\"{}\"", "v".repeat(2_000_000))), None)
            .contains("1048576")
    );
    assert!(message(&APPENDED.replace("_AAAAAAAABg", "_AAAAAAAABw"), None).contains("has 7 bytes"));
    assert!(
        message(&BASE64.replace("AQAAAAAAAAAAg", "AgAAAAAAAAAAg"), None)
            .contains("table of its compressed blocks")
    );
    assert!(message(&BASE64.replace("F4FwYUBg", "F4FwYUBh"), None).contains("damaged"));

    let legacy = |from: &str, to: &str| message(&LEGACY.replacen(from, to, 9), None);
    assert!(legacy("STRUCTURED_POINTS", "UNSTRUCTURED_GRID").contains("no image on a regular grid"));
    assert!(legacy("ASCII", "TEXT").contains("BINARY or ASCII was expected"));
    assert!(legacy("3 2 1", "3 3 1").contains("the number after CELL_DATA is 2,"));
    assert!(legacy("3 2 1", "9223372036854775807 9223372036854775807 2").contains("64 bits"));
    assert!(legacy("NORMALS n float", "NORMALS n number").contains("no error"));
    assert!(legacy("LOOKUP_TABLE default", "").contains("LOOKUP_TABLE was expected"));
    assert!(legacy("DIMENSIONS", "SIZES").contains("SIZES 3 2 1"));
}

#[test]
fn hostile_files_return() {
    let (mut header, _) = noise(ElementType::I16);
    header.extent = [5, 4, 3];
    let values = vec![7; 2 * 3 * 60];
    let options = |gzip| WriteOptions { byte_order: None, gzip };
    let mut files: Vec<Vec<u8>> =
        [ASCII, BASE64, APPENDED, LEGACY].map(|text| text.as_bytes().to_vec()).into();
    files.push(written(&header, &values, "a.vti", &options(true)).0);
    files.push(written(&header, &values, "a.vtk", &options(false)).0);
    for file in files {
        let head = file.len().min(1200);
        for at in 0..head {
            let mut flipped = file.clone();
            for change in [1, 0x20, 0x80] {
                flipped[at] = file[at] ^ change;
                let _result = read(&flipped, None);
            }
            if at % 3 == 0 {
                let _result = read(&file[..at], None);
                flipped[at] = b'9';
                flipped.insert(at, b'9');
                let _result = read(&flipped, None);
            }
        }
    }
}
