"""Zarr and VTK files between wavelift and zarr-python, meshio and VTK, both ways: bits and metadata are equal.

    python check_zarr_vtk.py --wavelift target/release/wavelift [--data ../shared/data]

VTK itself is used where its module is installed; it is a large one.
"""

import argparse
import itertools
import json
import pathlib
import subprocess
import sys

import meshio
import numpy as np
import zarr
from numcodecs import Adler32, BZ2, Blosc, FixedScaleOffset, Fletcher32, GZip, Shuffle, Zlib, Zstd

try:
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy
except ImportError:
    vtk = None

TYPES = ["i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"]
WAVELIFT = ""


def convert(source, target, *options):
    run = subprocess.run([WAVELIFT, "convert", str(source), str(target), *options], capture_output=True, text=True)
    if run.returncode:
        sys.exit(f"wavelift convert {source} {target}: {run.stderr}")
    return run.stderr


def equal(what, found, expected):
    found, expected = np.asarray(found), np.asarray(expected)
    same_kind = found.dtype.newbyteorder("=") == expected.dtype.newbyteorder("=")
    if found.shape != expected.shape or not same_kind or not np.array_equal(found, expected):
        sys.exit(f"{what}: {found.dtype}{found.shape} is not the expected {expected.dtype}{expected.shape}")


def close(what, found, expected):
    if not np.allclose(found, expected, rtol=1e-15, atol=0):
        sys.exit(f"{what}: {found}, expected {expected}")


def volume(dtype, shape=(7, 6, 5)):
    numbers = np.random.default_rng(1).integers(0, 256, (*shape, np.dtype(dtype).itemsize), dtype="u1")
    if np.dtype(dtype).kind == "f":
        return np.random.default_rng(1).standard_normal(shape).astype(dtype)
    return numbers.view(dtype).reshape(shape)


def check_zarr_arrays():
    codecs = {
        "blosc": zarr.codecs.BloscCodec(cname="lz4", shuffle="shuffle"),
        "zstd": zarr.codecs.ZstdCodec(),
        "gzip": zarr.codecs.GzipCodec(),
        "none": None,
    }
    for dtype, (codec, order) in zip(TYPES, itertools.cycle(itertools.product(codecs, ["little", "big"]))):
        array = volume(dtype)
        for shards in [None, (4, 6, 6)]:
            serializer = "auto" if array.itemsize == 1 else zarr.codecs.BytesCodec(endian=order)
            made = zarr.create_array("in.zarr", shape=array.shape, dtype=dtype, chunks=(2, 3, 3), shards=shards,
                                     compressors=codecs[codec], serializer=serializer, overwrite=True,
                                     dimension_names=["z", "y", "x"], attributes={"note": [1, 0.1]})
            made[:] = array
            convert("in.zarr", "out.npy")
            equal(f"version 3, {dtype}, {codec}, {order}, {shards}", np.load("out.npy"), array)
            convert("in.zarr", "out.zarr", *(["--gzip"] if codec == "gzip" else []))
            written = zarr.open_array("out.zarr", mode="r")
            equal(f"written, {dtype}", written[:], array)
            if dict(written.attrs) != {"note": [1, 0.1]} or written.metadata.dimension_names != ("z", "y", "x"):
                sys.exit(f"written: attributes {dict(written.attrs)}, axes {written.metadata.dimension_names}")
    old = {"blosc": Blosc(cname="zstd"), "zlib": Zlib(), "gzip": GZip(), "zstd": Zstd(), "bz2": BZ2(), "none": None}
    for (name, codec), order, layout in itertools.product(old.items(), "<>", "CF"):
        array = volume(f"{order}u2")
        made = zarr.create_array("in.zarr", shape=array.shape, dtype=array.dtype, chunks=(2, 3, 4), zarr_format=2,
                                 compressors=codec, order=layout, overwrite=True)
        made[:] = array
        convert("in.zarr", "out.npy")
        equal(f"version 2, {name}, {order}, {layout}", np.load("out.npy"), array)


def check_zarr_filters():
    old = {"u2": [Shuffle(2), Fletcher32()], "f8": [FixedScaleOffset(100, 1000, "f8", "i4")]}
    for (dtype, filters), codec in itertools.product(old.items(), [Zlib(), Adler32(), None]):
        array = (np.random.default_rng(1).integers(0, 60000, (7, 6, 5)) / (100 if dtype == "f8" else 1)).astype(dtype)
        made = zarr.create_array("in.zarr", shape=array.shape, dtype=dtype, chunks=(2, 3, 4), zarr_format=2,
                                 filters=filters, compressors=codec, overwrite=True)
        made[:] = array
        convert("in.zarr", "out.npy")
        equal(f"version 2, {filters}, {codec}", np.load("out.npy"), made[:])
    array = volume("f4")
    made = zarr.create_array("in.zarr", shape=array.shape, dtype="f4", chunks=(2, 3, 4), overwrite=True,
                             filters=[zarr.codecs.numcodecs.BitRound(keepbits=10)],
                             compressors=[zarr.codecs.numcodecs.Shuffle(elementsize=4), zarr.codecs.numcodecs.Fletcher32()])
    made[:] = array
    convert("in.zarr", "out.npy")
    equal("version 3, rounded", np.load("out.npy"), made[:])


def check_ome():
    array = volume("u2", (2, 3, 4, 5, 6))
    group = zarr.create_group("cells.ome.zarr", zarr_format=3, overwrite=True)
    axes = [{"name": "t", "type": "time", "unit": "second"}, {"name": "c", "type": "channel"}]
    axes += [{"name": name, "type": "space", "unit": "micrometer"} for name in "zyx"]
    levels = []
    for level, scale in [("0", 1), ("1", 2)]:
        part = array[..., ::scale, ::scale]
        made = group.create_array(level, shape=part.shape, dtype="u2", chunks=(1, 1, 2, 3, 3))
        made[:] = part
        scales = {"type": "scale", "scale": [2.5, 1.0, 3.0, 0.1 * scale, 0.2 * scale]}
        levels.append({"path": level, "coordinateTransformations": [scales]})
    image = {"name": "cells", "axes": axes, "datasets": levels}
    group.attrs.update({"ome": {"version": "0.5", "multiscales": [image]}})
    convert("cells.ome.zarr", "out.ome.zarr")
    written = zarr.open_group("out.ome.zarr", mode="r")
    equal("OME-Zarr", written["0"][:], array)
    found = written.attrs["ome"]["multiscales"][0]
    if found["axes"] != axes or found["name"] != "cells":
        sys.exit(f"OME-Zarr: axes {found['axes']}")
    close("OME-Zarr: scale", found["datasets"][0]["coordinateTransformations"][0]["scale"], [2.5, 1, 3, 0.1, 0.2])
    # Time goes on into other formats and back.
    convert("cells.ome.zarr", "cells.nrrd")
    head = open("cells.nrrd", "rb").read().split(b"\n\n")[0].decode().split("\n")
    if "spacings: nan nan nan nan 2.5" not in head or 'units: "" "" "" "" "s"' not in head:
        sys.exit(f"OME-Zarr as NRRD: {head}")
    convert("cells.nrrd", "again.ome.zarr")
    found = zarr.open_group("again.ome.zarr", mode="r").attrs["ome"]["multiscales"][0]
    close("OME-Zarr again: scale", found["datasets"][0]["coordinateTransformations"][0]["scale"], [2.5, 1, 3, 0.1, 0.2])
    if found["axes"] != axes:
        sys.exit(f"OME-Zarr again: axes {found['axes']}")
    convert("cells.ome.zarr/1", "level.zarr")
    # A plain array has its components last.
    equal("level 1", zarr.open_array("level.zarr")[:], np.moveaxis(array[..., ::2, ::2], 1, -1))


def check_meshio():
    # meshio does not know the names of VTK that give 64-bit integers their width on every system.
    for dtype in ["i1", "u1", "i2", "u2", "i4", "u4", "f4", "f8"]:
        array = volume(dtype)
        np.save("in.npy", array)
        convert("in.npy", "out.vtk")
        mesh = meshio.read("out.vtk")
        equal(f".vtk to meshio, {dtype}", mesh.point_data["samples"].reshape(array.shape), array)


def image_of(array, components=1, of_cells=False, turned=False):
    depth, height, width = array.shape[:3]
    image = vtk.vtkImageData()
    more = 1 if of_cells else 0
    image.SetExtent(2, 1 + width + more, 0, height - 1 + more, -1, depth - 2 + more)
    image.SetOrigin(1.5, -2, 0.1)
    image.SetSpacing(0.5, 0.25, 1 / 3)
    if turned:
        image.SetDirectionMatrix(0, 1, 0, 1, 0, 0, 0, 0, 1)
    data = numpy_to_vtk(np.ascontiguousarray(array).reshape(-1, components) if components > 1 else array.ravel(), deep=1)
    data.SetName("my data")
    (image.GetCellData() if of_cells else image.GetPointData()).SetScalars(data)
    return image


def vtk_read(path):
    reader = vtk.vtkXMLImageDataReader() if path.endswith(".vti") else vtk.vtkStructuredPointsReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def same_image(what, found, expected, is_placed=True):
    if is_placed:
        for name in ["GetExtent", "GetOrigin", "GetSpacing"]:
            if getattr(found, name)() != getattr(expected, name)():
                sys.exit(f"{what}: {name} {getattr(found, name)()}, expected {getattr(expected, name)()}")
    for name in ["GetPointData", "GetCellData"]:
        one, other = getattr(found, name)().GetScalars(), getattr(expected, name)().GetScalars()
        if (one is None) != (other is None):
            sys.exit(f"{what}: {name}")
        if one is not None:
            equal(what, vtk_to_numpy(one), vtk_to_numpy(other))
            if one.GetName() != other.GetName():
                sys.exit(f"{what}: array {one.GetName()}")


def check_vtk():
    writer = vtk.vtkXMLImageDataWriter()
    for mode, is_packed, is_wide, is_big, encode in itertools.product(["Ascii", "Binary", "Appended"], *[[0, 1]] * 4):
        for dtype, components, of_cells in [("i2", 1, False), ("f4", 3, False), ("u1", 1, True), ("f8", 1, True)]:
            array = volume(dtype, (7, 6, 5, components))
            image = image_of(array, components, of_cells, turned=True)
            writer.SetInputData(image)
            getattr(writer, f"SetDataModeTo{mode}")()
            writer.SetCompressorTypeToZLib() if is_packed else writer.SetCompressorTypeToNone()
            writer.SetHeaderTypeToUInt64() if is_wide else writer.SetHeaderTypeToUInt32()
            writer.SetByteOrderToBigEndian() if is_big else writer.SetByteOrderToLittleEndian()
            writer.SetEncodeAppendedData(encode)
            writer.SetFileName("in.vti")
            writer.Write()
            convert("in.vti", "out.vti", *(["--gzip"] if is_packed else []))
            what = f".vti {mode} {dtype} packed {is_packed} wide {is_wide} big {is_big} base64 {encode}"
            same_image(what, vtk_read("out.vti"), vtk_read("in.vti"))
            found = vtk_read("out.vti").GetDirectionMatrix()
            if [found.GetElement(0, 1), found.GetElement(1, 0)] != [1, 1]:
                sys.exit(f"{what}: direction")
    check_pieces()
    writer = vtk.vtkStructuredPointsWriter()
    for dtype, of_cells in itertools.product(TYPES, [False, True]):
        for is_text in [False, True]:
            image = image_of(volume(dtype), of_cells=of_cells)
            image.SetExtent(0, image.GetDimensions()[0] - 1, 0, image.GetDimensions()[1] - 1, 0, image.GetDimensions()[2] - 1)
            writer.SetInputData(image)
            writer.SetFileTypeToASCII() if is_text else writer.SetFileTypeToBinary()
            writer.SetFileName("in.vtk")
            writer.Write()
            convert("in.vtk", "out.vtk")
            same_image(f".vtk {dtype} text {is_text} cells {of_cells}", vtk_read("out.vtk"), vtk_read("in.vtk"))


def check_pieces():
    source = vtk.vtkRTAnalyticSource()
    source.SetWholeExtent(-3, 8, 0, 7, 2, 9)
    cells = vtk.vtkPointDataToCellData()
    cells.SetInputConnection(source.GetOutputPort())
    for made, mode, ghosts in itertools.product([source, cells], ["Ascii", "Binary", "Appended"], [0, 1]):
        made.UpdateWholeExtent()
        image, of_cells = made.GetOutput(), made is cells
        data = (image.GetCellData() if of_cells else image.GetPointData()).GetArray("RTData")
        array = vtk_to_numpy(data).reshape([count - of_cells for count in image.GetDimensions()[::-1]])
        for name, writer in [("in.vti", vtk.vtkXMLImageDataWriter()), ("in.pvti", vtk.vtkXMLPImageDataWriter())]:
            writer.SetInputConnection(made.GetOutputPort())
            getattr(writer, f"SetDataModeTo{mode}")()
            writer.SetFileName(name)
            writer.SetNumberOfPieces(5)
            if name == "in.pvti":
                writer.SetStartPiece(0)
                writer.SetEndPiece(4)
                writer.SetGhostLevel(ghosts)
            writer.Write()
            if open(name, "rb").read().count(b"<Piece") != 5:
                sys.exit(f"{name} is not in five pieces")
            convert(f"{name}#RTData", "out.npy")
            equal(f"{name} {mode} cells {of_cells} ghosts {ghosts}", np.load("out.npy"), array)


def check_data(data):
    raw = np.fromfile(data / "volumes/headsq_64x64x93_u16.raw", "<u2").reshape(93, 64, 64)
    np.save("head.npy", raw)
    for name in ["head.zarr", "head.ome.zarr", "head.vti", "head.vtk"]:
        convert("head.npy", name)
        convert(name, "again.npy")
        equal(name, np.load("again.npy"), raw)
    equal("head.zarr", zarr.open_array("head.zarr")[:], raw)
    equal("head.ome.zarr", zarr.open_array("head.ome.zarr/0")[:], raw)


def main():
    global WAVELIFT
    parser = argparse.ArgumentParser()
    parser.add_argument("--wavelift", required=True)
    parser.add_argument("--data", type=pathlib.Path)
    arguments = parser.parse_args()
    WAVELIFT = str(pathlib.Path(arguments.wavelift).resolve())
    checks = [check_zarr_arrays, check_zarr_filters, check_ome, check_meshio] + ([check_vtk] if vtk else [])
    for check in checks:
        check()
        print(f"{check.__name__}: equal")
    if not vtk:
        print("VTK is not installed: its files were not checked")
    if arguments.data:
        check_data(arguments.data.resolve())
        print("check_data: equal")


if __name__ == "__main__":
    main()
