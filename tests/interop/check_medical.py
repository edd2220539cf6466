"""Volumes of NIfTI, MetaImage, NRRD, MRC and NumPy between wavelift and nibabel, SimpleITK, pynrrd, mrcfile and NumPy.

python check_medical.py --wavelift BIN [--data DIR]

Files that those libraries write are read by wavelift and written again; files that wavelift writes are read by them:
values must be equal to the bit, positions to the last digit that the format keeps. Works in a scratch folder; exits
with 1 and a plain message at the first difference. With --data, volumes of that folder's MANIFEST.tsv take part.
"""

import argparse
import csv
import itertools
import subprocess
import sys
import tempfile
from pathlib import Path

import mrcfile
import nibabel
import nrrd
import numpy as np
import SimpleITK as sitk

TYPES = ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8"]
AFFINE = np.array([[-0.6, 0.16, 0.02, 11.5], [0.8, 0.12, -0.01, -7.25], [0.0, 0.3, 2.5, 1e-3], [0, 0, 0, 1]])


class Difference(Exception):
    """What differs."""


def expect(holds, what):
    if not holds:
        raise Difference(what)


class Check:
    def __init__(self, wavelift, folder):
        self.wavelift, self.folder, self.count = wavelift, folder, 0

    def path(self, name):
        return self.folder / name

    def run(self, *words):
        done = subprocess.run([self.wavelift, *map(str, words)], capture_output=True, text=True)
        expect(done.returncode == 0, f"wavelift {' '.join(map(str, words))}: {done.stderr.strip()}")
        self.count += 1
        return done.stderr

    def convert(self, one, other, *options):
        return self.run("convert", self.path(one), self.path(other), *options)


def noise(shape, kind):
    """Numbers of all sizes that the type has, without NaN."""
    random = np.random.default_rng(len(shape) * 100 + TYPES.index(kind))
    if kind[0] == "f":
        return (random.standard_normal(shape) * 10.0 ** random.integers(-20, 20, shape)).astype(kind)
    limits = np.iinfo(kind)
    return random.integers(limits.min, limits.max, shape, dtype=kind, endpoint=True)


def same(found, expected, what):
    found = np.asarray(found)
    expect(found.shape == expected.shape, f"{what}: shape {found.shape}, not {expected.shape}")
    equal = found.astype(expected.dtype.newbyteorder("=")).tobytes() == expected.astype(expected.dtype.newbyteorder("=")).tobytes()
    expect(found.dtype.newbyteorder("=") == expected.dtype.newbyteorder("="), f"{what}: type {found.dtype}")
    expect(equal, f"{what}: values differ")


def raw(image):
    """Values as they are stored, without the scale."""
    return np.asanyarray(image.dataobj.get_unscaled() if hasattr(image.dataobj, "get_unscaled") else image.dataobj)


def nifti_image(version, data, order):
    image = (nibabel.Nifti1Image if version == 1 else nibabel.Nifti2Image)(data, AFFINE, dtype=data.dtype)
    header = image.header
    header.set_xyzt_units("mm", "sec")
    header.set_intent("t test", (12.5,), name="contrast")
    header["descrip"], header["aux_file"] = b"made by nibabel", b"none"
    header["cal_min"], header["cal_max"], header["toffset"] = -3.5, 1e6, 0.25
    header.set_dim_info(0, 1, 2)
    header["slice_code"], header["slice_duration"] = 3, 0.1
    header["scl_slope"], header["scl_inter"] = 0.1, -1024
    image.set_sform(AFFINE, 4)
    rigid = np.diag([0.5, 0.75, 3.0, 1.0])
    rigid[:3, 3] = [1, 2, 3]
    image.set_qform(rigid, 1)
    if data.ndim > 3:
        header["pixdim"][4] = 1.75
    header.extensions.append(nibabel.nifti1.Nifti1Extension("comment", b"of some length"))
    if order == ">":
        swapped = header.as_byteswapped(">")
        image = image.__class__(data, None, swapped)
        image.header["scl_slope"], image.header["scl_inter"] = 0.1, -1024
    return image


def equal_headers(found, expected, what):
    for field in expected.keys():
        if field in ("vox_offset", "magic"):
            continue
        one, other = found[field], expected[field]
        is_equal = np.array_equal(one, other, equal_nan=True) if other.dtype.kind == "f" else np.array_equal(one, other)
        expect(is_equal, f"{what}: field {field} is {one}, not {other}")
    codes = [[(code.get_code(), code.get_content()) for code in header.extensions] for header in (found, expected)]
    expect(codes[0] == codes[1], f"{what}: extensions {codes}")


def check_nifti(check):
    """NIfTI of nibabel through every form back to NIfTI: all fields and extensions are the same."""
    shapes = [(7, 6), (7, 6, 5), (7, 6, 5, 3), (7, 6, 5, 1, 3), (4, 3, 2, 2, 3)]
    forms = itertools.cycle(["b.nii", "b.nii.gz", "b.nrrd", "b.mha", "b.wlift", "b.hdr"])
    for version, order, kind in itertools.product([1, 2], "<>", TYPES):
        for shape in shapes:
            data = noise(shape, kind).astype(np.dtype(order + kind))
            image = nifti_image(version, data, order)
            name = "a.nii.gz" if kind in ("u2", "f4") else "a.nii"
            nibabel.save(image, check.path(name))
            expected = nibabel.load(check.path(name))
            between, what = next(forms), f"NIfTI-{version} {order}{kind} {shape}"
            if between == "b.wlift":
                if len(shape) > 3:
                    between = "b.nii"
                else:
                    check.run("compress", check.path(name), check.path(between))
                    check.run("decompress", check.path(between), check.path("c.nii"))
            if between != "b.wlift":
                check.convert(name, between)
                check.convert(between, "c.nii")
            found = nibabel.load(check.path("c.nii"))
            same(raw(found), raw(expected), f"{what} through {between}")
            equal_headers(found.header, expected.header, f"{what} through {between}")


def check_colours(check):
    for names, shape in [("rgb", (5, 4, 3)), ("rgba", (5, 4, 3))]:
        colour = np.dtype([(name, "u1") for name in {"rgb": "RGB", "rgba": "RGBA"}[names]])
        values = np.random.default_rng(1).integers(0, 256, (*shape, len(names)), dtype="u1")
        data = values.view(colour).reshape(shape)
        nibabel.save(nibabel.Nifti1Image(data, AFFINE), check.path("a.nii"))
        check.convert("a.nii", "b.nrrd")
        found, header = nrrd.read(str(check.path("b.nrrd")))
        same(np.moveaxis(found, 0, -1), values, f"{names} from NIfTI to NRRD")
        expect(header["kinds"][0].upper().startswith(names.upper()), f"{names}: kinds are {header['kinds']}")
        check.convert("b.nrrd", "c.nii.gz")
        found = nibabel.load(check.path("c.nii.gz"))
        same(np.ascontiguousarray(found.dataobj).view("u1").reshape(values.shape), values, f"{names} back in NIfTI")
        check.convert("a.nii", "b.mha")
        found = sitk.GetArrayFromImage(sitk.ReadImage(str(check.path("b.mha"))))
        same(found.transpose(2, 1, 0, 3), values, f"{names} from NIfTI to MetaImage")


def itk_affine(image):
    """Matrix from indices to RAS positions."""
    matrix = np.eye(4)
    direction = np.array(image.GetDirection()).reshape(3, 3)
    matrix[:3, :3], matrix[:3, 3] = direction * np.array(image.GetSpacing()), image.GetOrigin()
    return np.diag([-1, -1, 1, 1]) @ matrix


def itk_image(data, is_vector):
    image = sitk.GetImageFromArray(data, isVector=is_vector)
    if image.GetDimension() == 3:
        turn = sitk.Euler3DTransform((0, 0, 0), 0.3, -0.2, 1.1).GetMatrix()
        image.SetDirection(turn)
        image.SetSpacing((0.7, 0.8, 2.5))
        image.SetOrigin((-12.5, 33.3, 1e-3))
    return image


def check_itk(check):
    """SimpleITK writes and reads MetaImage, NRRD and NIfTI; every pair of formats, compressed or not."""
    extensions = ["mha", "mhd", "nrrd", "nhdr", "nii", "nii.gz"]
    pairs = itertools.cycle(itertools.product(extensions, extensions))
    for kind in TYPES:
        for shape, is_vector in [((6, 5), False), ((4, 6, 5), False), ((4, 6, 5, 3), True), ((2, 4, 6, 5), False)]:
            for _ in range(3):
                data = noise(shape, kind)
                image = itk_image(data, is_vector)
                one, other = next(pairs)
                what = f"{kind} {shape} from {one} of ITK to {other}"
                # A folder of its own for each, since detached samples are never replaced.
                folder = Path(tempfile.mkdtemp(dir=check.folder))
                compress = one != "nii" and kind in ("u2", "f4", "i1")
                sitk.WriteImage(image, str(folder / f"a.{one}"), useCompression=compress)
                packed = ["--gzip"] if other in ("mha", "mhd", "nrrd", "nhdr") and kind in ("i2", "f4") else []
                check.run("convert", folder / f"a.{one}", folder / f"b.{other}", *packed)
                if len(shape) == 2 and one.startswith("nii") and other in ("nrrd", "nhdr"):
                    # A slice that lies in space, which ITK does not read from NRRD.
                    found, _ = nrrd.read(str(folder / f"b.{other}"), index_order="C")
                    same(found, data, what)
                    continue
                found = sitk.ReadImage(str(folder / f"b.{other}"))
                values = sitk.GetArrayFromImage(found)
                if len(shape) == 4 and not is_vector and found.GetNumberOfComponentsPerPixel() > 1:
                    # ITK takes the steps of a `list` for components of the samples.
                    values = np.moveaxis(values, -1, 0)
                expected = sitk.GetArrayFromImage(sitk.ReadImage(str(folder / f"a.{one}")))
                same(values.reshape(expected.shape), expected, what)
                if image.GetDimension() == 3:
                    close = np.allclose(itk_affine(found), itk_affine(image), rtol=1e-5, atol=1e-5)
                    expect(close, f"{what}: positions are\n{itk_affine(found)}\nnot\n{itk_affine(image)}")


def check_nrrd(check):
    """pynrrd writes; wavelift writes again; header and samples are the same, through compressed files too."""
    for kind, order, encoding in itertools.product(TYPES, "<>", ["raw", "gzip", "bzip2", "ascii"]):
        if encoding == "ascii" and kind in ("u8", "i8"):
            continue  # pynrrd writes integers of 64 bits as text in 17 digits, which do not hold them
        data = noise((7, 6, 5), kind).astype(np.dtype(order + kind))
        header = {
            "space": "right-anterior-superior",
            "space directions": AFFINE[:3, :3].T,
            "space origin": AFFINE[:3, 3],
            "kinds": ["domain"] * 3,
            "space units": ["mm"] * 3,
            "encoding": encoding,
            "my key": "a value",
        }
        nrrd.write(str(check.path("a.nrrd")), data, header)
        check.run("compress", check.path("a.nrrd"), check.path("b.wlift"))
        check.run("decompress", check.path("b.wlift"), check.path("b.nrrd"))
        check.convert("a.nrrd", "c.nrrd")
        expected, before = nrrd.read(str(check.path("a.nrrd")))
        for name in ["b.nrrd", "c.nrrd"]:
            found, after = nrrd.read(str(check.path(name)))
            same(found, expected, f"NRRD {order}{kind} {encoding}")
            for field in set(before) - {"encoding", "type", "endian"}:
                expect(np.array_equal(before[field], after[field]), f"NRRD field {field}: {after.get(field)}")
    for sizes, kinds in [
        ((3, 6, 5, 4), ["vector", "domain", "domain", "domain"]),
        ((6, 5, 4, 3), ["domain", "domain", "domain", "time"]),
        ((6, 5, 4, 3), ["domain", "domain", "domain", "3-vector"]),
        ((3, 6, 5, 4, 2), ["3-vector", "domain", "domain", "domain", "list"]),
    ]:
        data = noise(sizes, "i2")
        nrrd.write(str(check.path("a.nrrd")), data, {"kinds": kinds, "encoding": "raw"}, index_order="F")
        check.convert("a.nrrd", "b.nrrd")
        found, header = nrrd.read(str(check.path("b.nrrd")))
        same(found, data, f"NRRD {kinds}")
        expect(header["kinds"] == kinds, f"NRRD kinds {kinds}: {header['kinds']}")


def check_freesurfer(check):
    """nibabel writes ANALYZE and FreeSurfer's volumes: values and, where they are said, positions are those of NIfTI."""
    for kind, shape in itertools.product(["u1", "i2", "i4", "f4"], [(7, 6, 5), (7, 6, 5, 3)]):
        data = noise(shape, kind)
        for name in ["a.mgh", "a.mgz"]:
            nibabel.save(nibabel.MGHImage(data, AFFINE.astype("f4")), check.path(name))
            check.convert(name, "b.nii.gz")
            found, expected = nibabel.load(check.path("b.nii.gz")), nibabel.load(check.path(name))
            same(raw(found), data, f"{name} {kind} {shape}")
            close = np.allclose(found.affine, expected.affine, rtol=1e-5, atol=1e-5)
            expect(close, f"{name}: positions are\n{found.affine}\nnot\n{expected.affine}")
        image = nibabel.AnalyzeImage(data, np.diag([0.5, 0.75, 2.0, 1.0]))
        for order in "<>":
            swapped = nibabel.AnalyzeImage(data, image.affine, image.header.as_byteswapped(order))
            nibabel.save(swapped, check.path("a.img"))
            check.convert("a.img", "c.nii")
            found = nibabel.load(check.path("c.nii"))
            same(raw(found), data, f"ANALYZE {order}{kind} {shape}")
            expect(np.allclose(found.header.get_zooms()[:3], [0.5, 0.75, 2.0]), f"ANALYZE: {found.header.get_zooms()}")
            codes = [int(found.header[code]) for code in ("qform_code", "sform_code")]
            expect(codes == [0, 0], f"ANALYZE says where it lies: {codes}")


def check_mrc(check):
    """mrcfile writes; wavelift writes the same bytes, and files of its own that mrcfile finds nothing wrong with."""
    for kind, order in itertools.product(["i1", "i2", "u2", "f2", "f4", "c8"], "<>"):
        data = noise((5, 6, 7), {"f2": "i1", "c8": "f4"}.get(kind, kind)).astype(order + kind)
        for name, opened in [("a.mrc", mrcfile.new), ("a.map.gz", lambda *all, **more: mrcfile.new(*all, compression="gzip", **more))]:
            with opened(str(check.path(name)), data=data, overwrite=True) as file:
                file.voxel_size = (1.5, 1.5, 2.25)
                file.header.origin = (10, 0, -3)
                file.set_extended_header(np.frombuffer(b"an extended header of any length", dtype="V1"))
                file.add_label("a label")
            check.convert(name, "b.mrc")
            expected = data.astype("f4") if kind == "f2" else data
            with mrcfile.open(check.path("b.mrc")) as found:
                same(found.data, expected, f"MRC {order}{kind}")
                expect(found.voxel_size.tolist() == (1.5, 1.5, 2.25), f"MRC {kind}: voxels are {found.voxel_size}")
                expect(found.header.origin.tolist() == (10, 0, -3), f"MRC {kind}: origin is {found.header.origin}")
            if name == "a.mrc" and kind != "f2":
                kept = check.path("b.mrc").read_bytes() == check.path("a.mrc").read_bytes()
                expect(kept, f"MRC {order}{kind}: other bytes")
    for kind in ["i1", "i2", "u2", "f4"]:
        data = noise((5, 6, 7), kind)
        image = sitk.GetImageFromArray(data)
        image.SetSpacing((0.5, 0.75, 2.0))
        sitk.WriteImage(image, str(check.path("a.nrrd")))
        for name in ["b.mrc", "b.map.gz"]:
            check.convert("a.nrrd", name)
            with mrcfile.open(check.path(name)) as found:
                same(found.data, data, f"NRRD {kind} to MRC")
                expect(found.voxel_size.tolist() == (0.5, 0.75, 2.0), f"NRRD to MRC: voxels are {found.voxel_size}")
    expect(mrcfile.validate(str(check.path("b.mrc"))), "mrcfile finds something wrong with b.mrc")


def check_numpy(check):
    for shape, order in [((5, 4, 3, 2), "C"), ((2, 5, 4, 3, 3), "C"), ((6, 5, 4, 9), "F"), ((4, 3), "F"), ((7,), "C")]:
        for kind in TYPES:
            data = np.asarray(noise(shape, kind), order=order)
            np.save(check.path("a.npy"), data)
            check.convert("a.npy", "b.nrrd")
            check.convert("b.nrrd", "c.npy")
            check.convert("a.npy", "d.npy")
            same(np.load(check.path("d.npy")), data, f"NumPy {kind} {shape} {order}")
            flat = np.load(check.path("c.npy"))
            expect(flat.tobytes(order="C") == data.tobytes(order=order), f"NumPy {kind} {shape} {order} through NRRD")


def check_data(check, folder):
    """Real volumes: raw to every format, read by its own library, and back to the same bytes."""
    with open(folder / "MANIFEST.tsv", newline="") as table:
        rows = [row for row in csv.reader(table, delimiter="\t") if row[2:3] == ["volume"]]
    kinds = {"u8": "u1", "i8": "i1", "u16": "u2", "i16": "i2", "f32": "f4", "f64": "f8", "i32": "i4", "u32": "u4"}
    for name, path, _, extent, kind, *_ in rows:
        file = folder / path
        if kind not in kinds or not file.exists() or file.stat().st_size > 20e6:
            continue
        data = np.fromfile(file, kinds[kind]).reshape([int(axis) for axis in extent.split("x")], order="F")
        layout = ["--extent", extent, "--type", kind]
        for other in ["nii.gz", "nii", "mha", "nrrd"]:
            target = check.path(f"{name}.{other}")
            check.run("convert", file, target, *layout)
            if other == "mha":
                found = sitk.GetArrayFromImage(sitk.ReadImage(str(target))).T
            elif other == "nrrd":
                found, _ = nrrd.read(str(target))
            else:
                found = raw(nibabel.load(target))
            same(found, data, f"{name}.{other}")
            check.run("compress", target, check.path("a.wlift"))
            check.run("decompress", check.path("a.wlift"), check.path("a.raw"))
            expect(check.path("a.raw").read_bytes() == file.read_bytes(), f"{name}.{other} through a compressed file")
            target.unlink()


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--wavelift", required=True, type=Path)
    options.add_argument("--data", type=Path)
    options = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        check = Check(options.wavelift.resolve(), Path(folder))
        try:
            for part in [check_nifti, check_colours, check_freesurfer, check_itk, check_nrrd, check_mrc, check_numpy]:
                before = check.count
                part(check)
                print(f"{part.__name__}: {check.count - before} runs of wavelift agree", flush=True)
            if options.data:
                check_data(check, options.data)
        except Difference as difference:
            sys.exit(f"check_medical: {difference}")
    print(f"check_medical: all {check.count} runs of wavelift agree")


if __name__ == "__main__":
    main()
