"""Files as people have them: variants of formats that few writers make on purpose, each read by wavelift.

python check_variants.py --wavelift BIN [--data DIR], in a scratch folder. Ends with a message and not 0 if values differ.
"""

import argparse
import gzip
import io
import pathlib
import struct
import subprocess

import imagecodecs
import nibabel
import numpy as np
import pydicom
import SimpleITK as sitk
import tifffile
import zarr
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.encaps import encapsulate
from pydicom.uid import CTImageStorage, DeflatedExplicitVRLittleEndian, ExplicitVRLittleEndian
from pydicom.uid import JPEG2000Lossless, JPEGLSLossless


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("--wavelift", required=True)
    parser.add_argument("--data")
    return parser.parse_args()


def volume(data):
    """Real samples if there are some: shape (12, 20, 24)."""
    head = pathlib.Path(data or ".") / "volumes" / "headsq_64x64x93_u16.raw"
    if not head.is_file():
        return np.random.default_rng(2).integers(0, 3000, (12, 20, 24)).astype(np.uint16)
    return np.ascontiguousarray(np.fromfile(head, "<u2").reshape(93, 64, 64)[40:52, 20:40, 20:44])


class Check:
    def __init__(self, wavelift):
        self.wavelift = wavelift
        self.count = 0

    def convert(self, source, target, *options):
        words = [self.wavelift, "convert", str(source), str(target), *options]
        return subprocess.run(words, capture_output=True, text=True)

    def read(self, source, expected, *options):
        """The file has these values, whatever the order of its bytes."""
        run = self.convert(source, "read.npy", *options)
        if run.returncode != 0:
            raise SystemExit(f"{source}: {run.stderr}")
        self.same(source, np.load("read.npy"), expected)

    def same(self, source, found, expected):
        kinds = [array.dtype.newbyteorder("=") for array in (found, expected)]
        if kinds[0] != kinds[1] or found.shape != expected.shape or not np.array_equal(found, expected):
            raise SystemExit(f"{source}: {found.dtype} {found.shape} is not as expected, {expected.dtype} {expected.shape}")
        self.count += 1

    def refuse(self, source, message):
        run = self.convert(source, "no.npy")
        if run.returncode not in (2, 3) or message not in run.stderr:
            raise SystemExit(f"{source}: no {message!r} in {run.returncode} {run.stderr!r}")
        self.count += 1


def raw(check, values):
    """Orders of axes, components, headers and gzip of raw files."""
    z, y, x = values.shape
    extent = ["--type", "u16", "--extent", f"{x}x{y}x{z}"]
    values.transpose(2, 1, 0).copy().tofile("z_fastest.raw")
    check.read("z_fastest.raw", values, *extent, "--axes", "zyx")
    three = np.stack([values, values + 1, values + 2])
    three.tofile("three.raw")
    check.read("three.raw", three, *extent, "--steps", "3")
    check.read("three.raw", np.moveaxis(three, 0, -1), *extent, "--components", "3", "--axes", "xyzc")
    pathlib.Path("headed.raw").write_bytes(bytes(512) + values.astype(">u2").tobytes())
    check.read("headed.raw", values, *extent, "--skip", "512", "--byte-order", "big")
    pathlib.Path("packed.raw.gz").write_bytes(gzip.compress(values.tobytes()))
    check.read("packed.raw.gz", values, "--type", "u16", "--extent", f"{x},{y},{z}")


def arrays(check, values):
    """Types of NumPy and Zarr that are read as wider ones."""
    for name, array, expected in [
        ("bool", values > 900, (values > 900).astype(np.uint8)),
        ("half", (values / 7).astype(np.float16), (values / 7).astype(np.float16).astype(np.float32)),
    ]:
        np.save("a.npy", array)
        check.read("a.npy", expected)
        zarr.create_array(store=f"{name}.zarr", data=array, chunks=(5, 8, 8))
        check.read(f"{name}.zarr", expected)
    np.save("a.npy", np.asfortranarray(values.T.astype(">u2")))
    check.read("a.npy", np.asfortranarray(values.T))
    np.save("a.npy", (values + 1j).astype(np.complex64))
    check.read("a.npy", np.stack([values, np.ones_like(values)], -1).astype(np.float32))
    np.save("a.npy", np.zeros(3, dtype=[("a", "u1"), ("b", "f4")]))
    check.refuse("a.npy", "records")
    for save in [np.savez, np.savez_compressed]:
        save("a.npz", values=values)
        check.read("a.npz", values)
        save("a.npz", first=values, second=values + 1)
        check.read("a.npz#second", values + 1)
        check.refuse("a.npz", '"first", "second"')
        check.refuse("a.npz#third", '"first", "second"')
    packed = bytearray(pathlib.Path("a.npz").read_bytes())
    packed[200] ^= 1
    pathlib.Path("damaged.npz").write_bytes(packed)
    check.refuse("damaged.npz#first", "no archive of arrays that can be read")


def tiffs(check, values):
    """Compressions, floats of 16 bits, shapes, and pages that are no slices."""
    grey = {"photometric": "minisblack"}
    half = (values / 7).astype(np.float16)
    for name, array, more in [
        ("zstd", values, {"compression": "zstd"}),
        ("zstd_predicted", values, {"compression": "zstd", "predictor": True, "tile": (16, 16)}),
        ("jpeg2000", values, {"compression": "jpeg2000", "compressionargs": {"level": 0, "reversible": True}}),
        ("half", half, {}),
        ("half_predicted", half, {"compression": "zlib", "predictor": 3}),
        ("series", np.stack([values, values + 1, values + 2]), {}),
    ]:
        tifffile.imwrite(f"{name}.tif", array, **grey, **more)
        check.read(f"{name}.tif", array.astype(np.float32) if array is half else array)
    tifffile.imwrite("channels.tif", np.stack([values, values + 1]), metadata={"axes": "CZYX"}, **grey)
    check.read("channels.tif", np.stack([values, values + 1], -1))
    with tifffile.TiffWriter("overviews.tif") as file:
        file.write(values[0], **grey)
        file.write(values[0, ::2, ::2], subfiletype=1, **grey)
    check.read("overviews.tif", values[0])
    with tifffile.TiffWriter("pyramid.ome.tif") as file:
        file.write(values, subifds=1, tile=(16, 16), metadata={"axes": "ZYX"}, **grey)
        file.write(values[:, ::2, ::2], subfiletype=1, tile=(16, 16), **grey)
    check.read("pyramid.ome.tif", values)
    for axes in ["TCZYX", "ZCTYX", "CZTYX", "ZTCYX"]:
        shape = {"T": 2, "C": 3, "Z": 4, "Y": 5, "X": 6}
        stack = np.arange(720, dtype=np.uint16).reshape([shape[axis] for axis in axes])
        tifffile.imwrite("o.ome.tif", stack, metadata={"axes": axes}, **grey)
        expected = stack.transpose([axes.index(axis) for axis in "TZYXC"])
        check.read("o.ome.tif", expected)
        # Channels of OME's are pages of their own, and a description of others is not kept.
        check.convert("o.ome.tif", "again.ome.tif")
        with tifffile.TiffFile("again.ome.tif") as file:
            order = file.series[0].axes
            check.same(f"{axes} as {order}", file.asarray().transpose([order.index(axis) for axis in "TZYXC"]), expected)


def blocks(check, values):
    """A VTK image in blocks of LZ4, as ParaView writes it."""
    z, y, x = values.shape
    data = values.tobytes()
    pieces = [data[at:at + 5000] for at in range(0, len(data), 5000)]
    packed = [imagecodecs.lz4_encode(piece, header=False) for piece in pieces]
    table = struct.pack(f"<{3 + len(packed)}Q", len(packed), 5000, len(pieces[-1]) % 5000, *map(len, packed))
    extent = f"0 {x - 1} 0 {y - 1} 0 {z - 1}"
    head = f'''<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64" compressor="vtkLZ4DataCompressor">
    <ImageData WholeExtent="{extent}" Origin="0 0 0" Spacing="1 1 1"><Piece Extent="{extent}"><PointData Scalars="v">
    <DataArray type="UInt16" Name="v" format="appended" offset="0"/></PointData></Piece></ImageData>
    <AppendedData encoding="raw">_'''
    file = head.encode() + table + b"".join(packed) + b"</AppendedData></VTKFile>"
    pathlib.Path("lz4.vti").write_bytes(file)
    check.read("lz4.vti", values)
    pathlib.Path("cut.vti").write_bytes(file[:-2000])
    check.refuse("cut.vti", "damaged or cut short")


def spacings(check, values):
    """Distances of samples come from directions in space into formats that have no directions."""
    image = sitk.GetImageFromArray(values)
    image.SetSpacing([0.5, 0.25, 2])
    sitk.WriteImage(image, "placed.nrrd")
    check.convert("placed.nrrd", "placed.tif")
    with tifffile.TiffFile("placed.tif") as file:
        tags = file.pages[0].tags
        found = [tags["XResolution"].value, tags["YResolution"].value, file.imagej_metadata["spacing"]]
    if found != [(2, 1), (4, 1), 2]:
        raise SystemExit(f"placed.tif: distances are {found}")
    check.count += 1


def medical(check, values):
    """Headers of NIfTI, NRRD and MetaImage."""
    signed = values.astype(np.int16)
    image = nibabel.Nifti1Image(signed.T, None)
    image.set_qform(np.diag([0.5, 0.5, 3, 1]), 1)
    image.set_sform(None, 0)
    nibabel.save(image, "q.nii.gz")
    check.read("q.nii.gz", signed)
    pathlib.Path("q.nii.gz").rename("scan")
    check.read("scan", signed)
    nibabel.save(nibabel.Nifti1Image(np.stack([signed.T] * 3, -1), np.eye(4)), "t.nii")
    check.read("t.nii", np.stack([signed] * 3))
    z, y, x = values.shape
    for index, plane in enumerate(values):
        pathlib.Path(f"p{index:03d}.raw").write_bytes(b"HEAD" + plane.astype(">u2").tobytes())
    names = "".join(f"p{index:03d}.raw\n" for index in range(z))
    about = f"NRRD0004\r\ntype: ushort\r\ndimension: 3\r\nsizes: {x} {y} {z}\r\nencoding: raw\r\nendian: big\r\nbyte skip: 4\r\n"
    pathlib.Path("list.nhdr").write_text(about.replace("\r", "") + "data file: LIST 2\n" + names)
    check.read("list.nhdr", values)
    pathlib.Path("numbered.nhdr").write_bytes(f"{about}data file: p%03d.raw 0 {z - 1} 1\r\n".encode())
    check.read("numbered.nhdr", values)
    about = f"ObjectType = Image\nNDims = 3\nBinaryDataByteOrderMSB = True\nHeaderSize = 4\nDimSize = {x} {y} {z}\nElementType = MET_USHORT\n"
    pathlib.Path("list.mhd").write_text(f"{about}ElementDataFile = LIST\n{names}")
    check.read("list.mhd", values)
    vectors = np.stack([signed, signed + 1, signed + 2], -1)
    sitk.WriteImage(sitk.GetImageFromArray(vectors, isVector=True), "v.mha", useCompression=True)
    check.read("v.mha", vectors)


def image_of(plane):
    """A slice of a CT."""
    file = Dataset()
    file.file_meta = FileMetaDataset()
    file.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    file.SOPClassUID = file.file_meta.MediaStorageSOPClassUID = CTImageStorage
    file.SOPInstanceUID = file.file_meta.MediaStorageSOPInstanceUID = pydicom.uid.generate_uid()
    file.SeriesInstanceUID, file.Modality = "1.2.3", "CT"
    file.Rows, file.Columns = plane.shape[-2:]
    file.SamplesPerPixel, file.PhotometricInterpretation = 1, "MONOCHROME2"
    file.BitsAllocated, file.BitsStored, file.HighBit = 16, 16, 15
    file.PixelRepresentation = int(plane.dtype.kind == "i")
    file.PixelSpacing = [0.5, 0.25]
    file.PixelData = plane.tobytes()
    return file


def framed(values, order, repeats=1):
    """Frames in that order, each with its place."""
    file = image_of(values[order])
    file.NumberOfFrames = len(order)
    turned, measures, shared = Dataset(), Dataset(), Dataset()
    turned.ImageOrientationPatient = [1, 0, 0, 0, 1, 0]
    measures.PixelSpacing, measures.SliceThickness = [0.5, 0.25], 2
    shared.PlaneOrientationSequence, shared.PixelMeasuresSequence = [turned], [measures]
    file.SharedFunctionalGroupsSequence = [shared]
    frames = []
    for z in order:
        place, rescale, frame = Dataset(), Dataset(), Dataset()
        place.ImagePositionPatient = [0, 0, 2.0 * (z // repeats)]
        rescale.RescaleIntercept, rescale.RescaleSlope, rescale.RescaleType = z, 1, "US"
        frame.PlanePositionSequence, frame.PixelValueTransformationSequence = [place], [rescale]
        frames.append(frame)
    file.PerFrameFunctionalGroupsSequence = frames
    return file


def dicom(check, values):
    """Frames in any order, JPEG 2000, bits, and files without an extension."""
    signed = values.astype(np.int16) - 1000
    order = [(z * 7) % 12 for z in range(12)]
    framed(signed, order).save_as("frames.dcm", enforce_file_format=True)
    check.read("frames.dcm", signed)
    check.convert("frames.dcm", "frames.nrrd")
    intercepts = "dicom.0028,1052:=" + ";".join(f"{z}.0" for z in range(12))
    if intercepts not in pathlib.Path("frames.nrrd").read_bytes().decode("latin1"):
        raise SystemExit("frames.dcm: intercepts are not in the order of slices")
    # Two time steps of six slices: frames 2 z and 2 z + 1 lie in the same place.
    framed(signed, list(range(12)), repeats=2).save_as("steps.dcm", enforce_file_format=True)
    check.read("steps.dcm", np.stack([signed[::2], signed[1::2]]))
    image_of(values[0]).save_as("IM000001", enforce_file_format=True)
    check.read("IM000001", values[0])
    for syntax, encode, message in [
        (JPEG2000Lossless, lambda plane: imagecodecs.jpeg2k_encode(plane, level=0, codecformat="j2k", reversible=True), None),
        (JPEGLSLossless, imagecodecs.jpegls_encode, "dcmdjpls"),
    ]:
        for array in [values, signed]:
            if message and array is signed:
                continue
            file = image_of(array[0])
            file.NumberOfFrames = len(array)
            file.PixelData = encapsulate([encode(plane) for plane in array])
            file["PixelData"].VR = "OB"
            file.file_meta.TransferSyntaxUID = syntax
            file.save_as("packed.dcm", enforce_file_format=True)
            check.refuse("packed.dcm", message) if message else check.read("packed.dcm", array)
    file = image_of(signed)
    file.NumberOfFrames = len(signed)
    file.file_meta.TransferSyntaxUID = DeflatedExplicitVRLittleEndian
    file.save_as("deflated.dcm", enforce_file_format=True)
    check.read("deflated.dcm", signed)
    damaged = pathlib.Path("deflated.dcm").read_bytes()
    pathlib.Path("cut.dcm").write_bytes(damaged[:len(damaged) // 2])
    check.refuse("cut.dcm", "damaged")
    folder = pathlib.Path("deflated")
    folder.mkdir(exist_ok=True)
    for z, plane in enumerate(signed):
        file = image_of(plane)
        file.ImagePositionPatient, file.ImageOrientationPatient = [0, 0, -z], [1, 0, 0, 0, 1, 0]
        file.file_meta.TransferSyntaxUID = DeflatedExplicitVRLittleEndian
        file.save_as(folder / f"{z}", enforce_file_format=True)
    check.read("deflated", signed[::-1])
    file = image_of(values[0])
    file.SamplesPerPixel, file.PhotometricInterpretation, file.PlanarConfiguration = 3, "YBR_FULL_422", 0
    file.BitsAllocated, file.BitsStored, file.HighBit, file.NumberOfFrames = 8, 8, 7, 3
    file.PixelData = (values[:3] % 251).astype(np.uint8).repeat(2).tobytes()
    file.save_as("halved.dcm", enforce_file_format=True)
    check.read("halved.dcm", pydicom.pixels.pixel_array("halved.dcm", raw=True))
    check.convert("halved.dcm", "whole.dcm")
    if pydicom.dcmread("whole.dcm").PhotometricInterpretation != "YBR_FULL":
        raise SystemExit("whole.dcm: its colours are called others than they are")
    check.read("whole.dcm", pydicom.pixels.pixel_array("halved.dcm", raw=True))
    mask = values[:, :, :23] > 900
    file = image_of(values[0, :, :23])
    file.NumberOfFrames, file.BitsAllocated, file.BitsStored, file.HighBit = len(mask), 1, 1, 0
    bits = np.packbits(mask.ravel(), bitorder="little").tobytes()
    file.PixelData = bits + bytes(len(bits) % 2)
    file.save_as("mask.dcm", enforce_file_format=True)
    check.read("mask.dcm", mask.astype(np.uint8))
    # The same volume gives the same bytes, and another one other identifiers.
    np.save("a.npy", signed)
    np.save("b.npy", signed + 1)
    files = []
    for source, target in [("a.npy", "a1.dcm"), ("a.npy", "a2.dcm"), ("b.npy", "b.dcm")]:
        check.convert(source, target)
        files.append(pathlib.Path(target).read_bytes())
    uids = [pydicom.dcmread(io.BytesIO(file)).SOPInstanceUID for file in files]
    if files[0] != files[1] or uids[0] == uids[2] or len(uids[0]) != 44:
        raise SystemExit(f"identifiers {uids} of equal and other volumes")
    if struct.unpack("<H", files[0][132:134]) != (2,):
        raise SystemExit("a1.dcm does not begin with group 2")


def main():
    given = arguments()
    check = Check(given.wavelift)
    values = volume(given.data)
    for variants in [raw, arrays, tiffs, blocks, spacings, medical, dicom]:
        variants(check, values)
    print(f"variants: {check.count} files right")


main()
