"""Slices and stacks of images, written by Pillow and read by wavelift, and the other way round.

python check_images.py --wavelift BIN [--data DIR], in a scratch folder. Ends with a message and not 0 if values differ.
"""

import argparse
import pathlib
import subprocess

import numpy as np
import pydicom
import tifffile
from PIL import Image, PngImagePlugin
from pydicom.data import get_testdata_file
from pydicom.uid import ExplicitVRBigEndian, ExplicitVRLittleEndian, ImplicitVRLittleEndian, RLELossless


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("--wavelift", required=True)
    parser.add_argument("--data")
    return parser.parse_args()


def same(name, found, expected):
    """Stops unless two arrays have the same type, in either byte order, shape and values."""
    types = [array.dtype.newbyteorder("=") for array in (found, expected)]
    if types[0] != types[1] or found.shape != expected.shape or not np.array_equal(found, expected):
        raise SystemExit(f"{name}: {found.dtype} {found.shape} is not as expected, {expected.dtype} {expected.shape}")


class Check:
    def __init__(self, wavelift):
        self.wavelift = wavelift
        self.count = 0

    def convert(self, source, target):
        subprocess.run([self.wavelift, "convert", str(source), str(target)], check=True)
        self.count += 1

    def refuse(self, source, target, message):
        """wavelift says no, and why."""
        run = subprocess.run([self.wavelift, "convert", str(source), str(target)], capture_output=True, text=True)
        if run.returncode == 0 or message not in run.stderr:
            raise SystemExit(f"{source} to {target}: no {message!r} in {run.returncode} {run.stderr!r}")
        self.count += 1

    def png_slices(self, volume):
        """A stack by pattern, by folder, to NumPy and back to PNG and PGM."""
        folder = pathlib.Path("png")
        folder.mkdir()
        for z, plane in enumerate(volume):
            Image.fromarray(plane).save(folder / f"s{z + 1}.png")
        for number, source in enumerate([folder / "s%d.png", folder / "*.png", folder]):
            self.convert(source, f"from_png{number}.npy")
            same(f"{source}", np.load(f"from_png{number}.npy"), volume)
        for pattern in ["new/out_%03d.png", "new/out_###.pgm"]:
            self.convert("from_png0.npy", pattern)
            extension = pattern[-3:]
            files = sorted(pathlib.Path("new").glob(f"out_*.{extension}"))
            planes = [np.asarray(Image.open(file)).astype(volume.dtype) for file in files]
            same(pattern, np.stack(planes), volume)
        self.refuse("from_png0.npy", "new/out_%03d.png", "there already")
        (folder / "s2.png").unlink()
        self.refuse(folder, "gap.npy", "s2.png")

    def png_metadata(self):
        """Texts and the size of pixels come back."""
        texts = PngImagePlugin.PngInfo()
        texts.add_text("Title", "Größe")
        texts.add_itxt("Author", "Ωmega")
        picture = Image.fromarray(np.arange(60, dtype=np.uint8).reshape(5, 4, 3))
        picture.save("a.png", pnginfo=texts, dpi=(300, 150))
        self.convert("a.png", "b.png")
        with Image.open("a.png") as a, Image.open("b.png") as b:
            same("a.png", np.asarray(b), np.asarray(a))
            if a.info != b.info or "Title" not in a.info:
                raise SystemExit(f"a.png has {a.info}, b.png {b.info}")

    def png_modes(self):
        """Bits, alpha and palettes."""
        grey = np.arange(64, dtype=np.uint8).reshape(8, 8)
        for mode in ["1", "L", "LA", "RGB", "RGBA", "P", "I;16"]:
            picture = Image.fromarray(grey.astype(np.uint16) * 999) if mode == "I;16" else Image.fromarray(grey).convert(mode)
            picture.save("mode.png")
            self.convert("mode.png", "again.png")
            expected = picture.convert("RGB") if mode == "P" else picture
            with Image.open("again.png") as again:
                same(f"mode {mode}", np.asarray(again), np.asarray(expected))

    def tiff_types(self):
        """Every type, byte order and way to store, by way of NumPy."""
        random = np.random.default_rng(3)
        for kind in ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8"]:
            volume = random.integers(0, 100, (5, 33, 47)).astype(kind)
            for order, more in [("<", {}), (">", {}), ("<", {"bigtiff": True}), (">", {"tile": (16, 32)}), ("<", {"rowsperstrip": 5})]:
                tifffile.imwrite("a.tif", volume, byteorder=order, photometric="minisblack", **more)
                self.convert("a.tif", "a.npy")
                same(f"{kind} {more}", np.load("a.npy"), volume)
                self.convert("a.tif", "b.tif")
                same(f"{kind} again", tifffile.imread("b.tif"), volume)
        volume = random.integers(0, 2000, (3, 40, 30), dtype=np.uint16)
        for compression, predictor in [("zlib", None), ("zlib", 2), ("lzw", None), ("lzw", 2), ("packbits", None)]:
            for values in [volume, volume.astype(np.float32) / 7]:
                for tile in [None, (16, 16)]:
                    use = 3 if predictor and values.dtype == np.float32 else predictor
                    try:
                        tifffile.imwrite("a.tif", values, compression=compression, predictor=use, tile=tile, photometric="minisblack")
                    except (ImportError, ValueError) as missing:
                        # Some codecs of tifffile are in a package of their own.
                        if "imagecodecs" not in str(missing):
                            raise
                        continue
                    self.convert("a.tif", "a.npy")
                    same(f"{compression} {use} {tile}", np.load("a.npy"), values)
        for compression in ["tiff_lzw", "packbits", "tiff_adobe_deflate"]:
            Image.fromarray(volume[0]).save("p.tif", compression=compression)
            self.convert("p.tif", "p.npy")
            same(compression, np.load("p.npy"), volume[0])
        for planar in ["contig", "separate"]:
            colors = random.integers(0, 255, (3, 20, 30) if planar == "separate" else (20, 30, 3), dtype=np.uint8)
            tifffile.imwrite("c.tif", colors, photometric="rgb", planarconfig=planar)
            self.convert("c.tif", "c.png")
            expected = np.moveaxis(colors, 0, -1) if planar == "separate" else colors
            same(planar, np.asarray(Image.open("c.png")), expected)

    def hyperstacks(self):
        """Channels, slices, frames, distances and units of ImageJ and OME-TIFF, both ways."""
        stack = np.arange(4 * 3 * 2 * 5 * 6, dtype=np.uint16).reshape(4, 3, 2, 5, 6)
        resolution = (1 / 0.25, 1 / 0.5)
        about = {"spacing": 1.5, "unit": "um", "axes": "TZCYX", "finterval": 0.1}
        tifffile.imwrite("i.tif", stack, imagej=True, resolution=resolution, metadata=about)
        ome = {"axes": "TZCYX", "PhysicalSizeX": 0.25, "PhysicalSizeXUnit": "µm", "PhysicalSizeY": 0.5, "PhysicalSizeZ": 1.5}
        tifffile.imwrite("o.ome.tif", stack, ome=True, photometric="minisblack", metadata=ome)
        for source in ["i.tif", "o.ome.tif"]:
            self.convert(source, f"again_{source}")
            with tifffile.TiffFile(source) as a, tifffile.TiffFile(f"again_{source}") as b:
                same(source, b.series[0].asarray(), a.series[0].asarray())
                if a.series[0].axes != b.series[0].axes or a.ome_metadata != b.ome_metadata:
                    raise SystemExit(f"{source}: axes {a.series[0].axes} became {b.series[0].axes}")
                old, new = a.imagej_metadata or {}, b.imagej_metadata or {}
                for key in set(old) - {"ImageJ"}:
                    if old[key] != new.get(key):
                        raise SystemExit(f"{source}: {key} {old[key]!r} became {new.get(key)!r}")
                if a.pages[0].tags["XResolution"].value != b.pages[0].tags["XResolution"].value:
                    raise SystemExit(f"{source}: another resolution")

    def tiff_slices(self, volume):
        """A file for each slice, and one file of all."""
        folder = pathlib.Path("tiff")
        folder.mkdir()
        for z, plane in enumerate(volume):
            tifffile.imwrite(folder / f"s{z:03d}.tif", plane)
        self.convert(folder, "all.tif")
        same("all.tif", tifffile.imread("all.tif"), volume)
        self.convert("all.tif", "one/s%02d.tif")
        same("one", np.stack([tifffile.imread(file) for file in sorted(pathlib.Path("one").iterdir())]), volume)
        # ImageJ's way beyond 4 GiB: one directory, and the samples of all pages behind it.
        tifffile.imwrite("flat.tif", volume, imagej=True, metadata={"axes": "ZYX"})
        with tifffile.TiffFile("flat.tif") as file:
            page = file.pages[0]
            end = page.offset + 2 + 12 * len(page.tags)
            starts = [page.dataoffsets[0] for page in file.pages]
        if starts != [starts[0] + z * volume[0].nbytes for z in range(len(volume))]:
            raise SystemExit(f"flat.tif: pages at {starts} do not follow each other")
        with open("flat.tif", "r+b") as file:
            file.seek(end)
            file.write(bytes(4))
        self.convert("flat.tif", "flat.npy")
        same("flat.tif", np.load("flat.npy"), volume)

    def dicom_files(self):
        """Files that come with pydicom: both byte orders, implicit and explicit, run lengths, colours, frames."""
        names = """CT_small.dcm MR_small.dcm MR_small_implicit.dcm MR_small_bigendian.dcm MR_small_RLE.dcm
            SC_rgb_rle.dcm SC_rgb_rle_16bit.dcm SC_rgb_rle_2frame.dcm SC_rgb_rle_32bit.dcm emri_small.dcm
            emri_small_RLE.dcm emri_small_big_endian.dcm rtdose.dcm rtdose_rle.dcm SC_rgb.dcm SC_rgb_16bit.dcm
            SC_rgb_expb.dcm SC_rgb_expb_2frame.dcm SC_rgb_32bit_2frame.dcm liver_nonbyte_aligned.dcm""".split()
        found = 0
        for name in names:
            path = get_testdata_file(name, download=False)
            if path is None or pydicom.dcmread(path).get("BitsAllocated") == 1:
                continue
            found += 1
            expected = np.squeeze(pydicom.dcmread(path).pixel_array)
            self.convert(path, "d.tif")
            values = tifffile.imread("d.tif")
            if values.ndim == expected.ndim and values.shape != expected.shape and values.shape[-3] == 3:
                values = np.moveaxis(values, -3, -1)
            same(name, np.squeeze(values), expected)
        if found < 10:
            raise SystemExit(f"only {found} of pydicom's files are there")
        jpeg = get_testdata_file("JPEG2000.dcm", download=False)
        if jpeg:
            # Coded with loss: decoders may round the last step differently.
            self.convert(jpeg, "j.npy")
            apart = np.squeeze(np.load("j.npy")).astype(int) - pydicom.dcmread(jpeg).pixel_array
            if np.abs(apart).max() > 1:
                raise SystemExit(f"JPEG2000.dcm: {np.abs(apart).max()} apart")

    def dicom_written(self):
        """What is written, read by pydicom: a file a slice, and one of all frames."""
        random = np.random.default_rng(11)
        for kind in [np.uint8, np.int16, np.uint16, np.int32]:
            volume = random.integers(0, 250, (7, 5, 9)).astype(kind)
            name = np.dtype(kind).name
            np.save("w.npy", volume)
            self.convert("w.npy", "w.nrrd")
            text = pathlib.Path("w.nrrd").read_bytes().split(b"\n\n", 1)
            lines = [
                b"space: left-posterior-superior", b"space directions: (0,0.5,0) (0.75,0,0) (0,0,-3)",
                b"space origin: (1,2,3)", b"dicom.0008,0016:=1.2.840.10008.5.1.4.1.1.2", b"dicom.0008,0060:=CT",
                b"dicom.0010,0010:=Doe^Jane", b"dicom.0020,000d:=1.2.3", b"dicom.0028,0120 US:=7",
                b"dicom.0028,1052:=-1024", b"dicom.0028,1053:=2",
            ]
            head = [line for line in text[0].split(b"\n") if not line.startswith((b"space", b"units"))]
            pathlib.Path("w.nrrd").write_bytes(b"\n".join(head + lines) + b"\n\n" + text[1])
            folder = pathlib.Path(f"written{name}")
            self.convert("w.nrrd", folder / "s%03d.dcm")
            files = [pydicom.dcmread(file) for file in sorted(folder.iterdir())]
            same(f"slices of {name}", np.stack([file.pixel_array for file in files]), volume)
            for z, file in enumerate(files):
                found = (file.SOPClassUID, str(file.PatientName), file.StudyInstanceUID, file.InstanceNumber,
                         list(file.ImagePositionPatient), list(file.ImageOrientationPatient), list(file.PixelSpacing),
                         file.PixelPaddingValue, file.RescaleIntercept, file.RescaleSlope, file.SOPInstanceUID)
                expected = ("1.2.840.10008.5.1.4.1.1.2", "Doe^Jane", "1.2.3", z + 1, [1, 2, 3 - 3 * z],
                            [0, 1, 0, 1, 0, 0], [0.75, 0.5], 7, -1024, 2, file.file_meta.MediaStorageSOPInstanceUID)
                if found != expected:
                    raise SystemExit(f"{name}, slice {z}: {found} in place of {expected}")
            if len({file.SeriesInstanceUID for file in files}) != 1 or len({file.SOPInstanceUID for file in files}) != 7:
                raise SystemExit(f"{name}: identifiers of slices are not as they should be")
            self.convert("w.nrrd", f"{name}.dcm")
            file = pydicom.dcmread(f"{name}.dcm")
            same(f"frames of {name}", file.pixel_array, volume)
            last = file.PerFrameFunctionalGroupsSequence[6].PlanePositionSequence[0].ImagePositionPatient
            spacing = file.SharedFunctionalGroupsSequence[0].PixelMeasuresSequence[0].PixelSpacing
            if (list(last), list(spacing)) != ([1, 2, -15], [0.75, 0.5]):
                raise SystemExit(f"{name}.dcm: the last frame is at {last}, with {spacing}")
            for written in [folder, f"{name}.dcm"]:
                self.convert(written, "back.npy")
                same(f"{written}, again", np.load("back.npy"), volume)
        colours = random.integers(0, 256, (4, 6, 3)).astype(np.uint8)
        Image.fromarray(colours).save("c.png")
        self.convert("c.png", "c.dcm")
        same("colours", pydicom.dcmread("c.dcm").pixel_array, colours)

    def dicom_series(self):
        """A folder, sorted by position, in every syntax; several series; a slice that is missing."""
        random = np.random.default_rng(5)
        volume = random.integers(-900, 2000, (9, 12, 10)).astype(np.int16)
        template = pydicom.dcmread(get_testdata_file("CT_small.dcm", download=False))
        template.ImageOrientationPatient = [0.6, 0.8, 0, 0, 0, -1]
        template.PixelSpacing = [0.75, 0.5]
        normal = np.cross([0.6, 0.8, 0], [0, 0, -1])
        template.Rows, template.Columns = volume.shape[1:]
        for syntax in [ImplicitVRLittleEndian, ExplicitVRLittleEndian, ExplicitVRBigEndian, RLELossless]:
            folder = pathlib.Path(f"series{syntax[17:]}")
            folder.mkdir()
            for z in random.permutation(len(volume)):
                slice_ = pydicom.Dataset()
                slice_.update(template)
                slice_.file_meta = pydicom.dataset.FileMetaDataset()
                slice_.file_meta.MediaStorageSOPClassUID = template.SOPClassUID
                slice_.InstanceNumber = str(99 - z)
                slice_.ImagePositionPatient = [f"{value:.6f}" for value in 10 + normal * 2.5 * z]
                slice_.RescaleIntercept = "-1024"
                slice_.SOPInstanceUID = slice_.file_meta.MediaStorageSOPInstanceUID = f"1.2.3.{z + 1}"
                is_big = syntax == ExplicitVRBigEndian
                slice_.add_new("PixelData", "OW", volume[z].astype(">i2" if is_big else "<i2").tobytes())
                slice_.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian if syntax == RLELossless else syntax
                if syntax == RLELossless:
                    slice_.compress(RLELossless, generate_instance_uid=False)
                name = folder / f"{random.integers(1 << 60):x}"
                pydicom.dcmwrite(name, slice_, enforce_file_format=True)
            self.convert(folder, "s.npy")
            same(folder, np.load("s.npy"), volume)
        self.convert(folder, "s.nrrd")
        text = pathlib.Path("s.nrrd").read_bytes()
        for line in [b"space: left-posterior-superior", b"(0.3,0.4,0) (0,0,-0.75) (", b"space origin: (10,10,10)", b"0028,1052:=-1024"]:
            if line not in text:
                raise SystemExit(f"{line} is not in the header {text[:900]}")
        self.convert(folder / template.SeriesInstanceUID, "uid.npy")
        same("by series", np.load("uid.npy"), volume)
        other = pydicom.dcmread(name)
        other.SeriesInstanceUID = "1.2.3.4"
        other.save_as(folder / "other.dcm")
        self.refuse(folder, "no.npy", "1.2.3.4: 1 files")
        (folder / "other.dcm").unlink()
        sorted(folder.iterdir(), key=lambda file: np.dot(normal, pydicom.dcmread(file).ImagePositionPatient))[4].unlink()
        self.refuse(folder, "no.npy", "a slice is missing")


def main():
    given = arguments()
    check = Check(given.wavelift)
    random = np.random.default_rng(7)
    check.png_slices(random.integers(0, 65536, (11, 6, 7), dtype=np.uint16))
    check.png_metadata()
    check.png_modes()
    check.tiff_types()
    check.hyperstacks()
    check.tiff_slices(random.integers(0, 65536, (11, 6, 7), dtype=np.uint16))
    check.dicom_files()
    check.dicom_series()
    check.dicom_written()
    print(f"images: {check.count} conversions right")


main()
