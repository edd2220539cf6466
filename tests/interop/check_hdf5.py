"""Files of HDF5 by h5py and of NetCDF by netCDF4 in wavelift: bits, shapes and attributes are equal.

    python check_hdf5.py --wavelift target/release/wavelift
"""

import argparse
import json
import pathlib
import subprocess
import sys

import h5py
import hdf5plugin
import netCDF4
import numpy as np

TYPES = ["i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"]
FORMATS = ["NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA", "NETCDF4", "NETCDF4_CLASSIC"]
WAVELIFT = ""


def run(*words):
    return subprocess.run([WAVELIFT, *map(str, words)], capture_output=True, text=True)


def succeed(*words):
    done = run(*words)
    if done.returncode:
        sys.exit(f"wavelift {words}: {done.stderr}")
    return done


def equal(what, found, expected):
    same_kind = found.dtype.newbyteorder("=") == expected.dtype.newbyteorder("=")
    if found.shape != expected.shape or not same_kind or found.tobytes() != expected.astype(found.dtype).tobytes():
        sys.exit(f"{what}: {found.dtype} {found.shape} is not {expected.dtype} {expected.shape}")


def converted(path):
    succeed("convert", path, "out.npy")
    return np.load("out.npy")


def header_of(path):
    succeed("compress", path, "out.wlift")
    header = json.loads(succeed("info", "out.wlift", "--json").stdout)["header"]
    return {line.get("field", line.get("key")): line["value"] for line in header}


def volume(dtype, shape=(13, 14, 15)):
    values = np.random.default_rng(1).integers(0, 100, shape) + np.arange(shape[-1])
    return values.astype(dtype) - (50 if np.dtype(dtype).kind == "f" else 0)


def check_types():
    ways = [
        {},
        {"chunks": (4, 5, 6)},
        {"chunks": (4, 5, 6), "compression": "gzip", "shuffle": True, "fletcher32": True},
        {"chunks": (13, 2, 15), "compression": "gzip", "maxshape": (None, 14, 15)},
    ]
    for dtype in TYPES:
        for order in "<>":
            for libver in ["earliest", "latest"]:
                array = volume(order + dtype)
                with h5py.File("in.h5", "w", libver=libver) as file:
                    for number, way in enumerate(ways):
                        file.create_dataset(f"group/way{number}", data=array, **way)
                for number, way in enumerate(ways):
                    equal(f"{order}{dtype} {libver} {way}", converted(f"in.h5#group/way{number}"), array)


def check_choice():
    array = volume("f4")
    with h5py.File("in.h5", "w", userblock_size=512) as file:
        file["field"] = array
        file["field"].attrs["units"] = "K"
        file["field"].attrs["steps"] = np.arange(3)
        file["axis"] = np.arange(15.0)
        file["name"] = "a text"
    equal("the only field", converted("in.h5"), array)
    equal("a line", converted("in.h5#axis"), np.arange(15.0))
    found = header_of("in.h5")
    if found != {"content": "field", "sample units": "K", "hdf5.steps": "0 1 2"}:
        sys.exit(f"attributes of HDF5: {found}")
    with h5py.File("two.h5", "w") as file:
        file["a"], file["b"] = array, array
    refused = run("convert", "two.h5", "out.npy")
    if refused.returncode != 3 or '"a", "b"' not in refused.stderr:
        sys.exit(f"two fields: {refused.stderr}")
    with h5py.File("bzip2.h5", "w") as file:
        file.create_dataset("a", data=array, **hdf5plugin.BZip2())
    refused = run("convert", "bzip2.h5", "out.npy")
    if refused.returncode != 3 or "h5repack" not in refused.stderr:
        sys.exit(f"bzip2: {refused.stderr}")


def check_codings():
    ways = [
        {"compression": "lzf"},
        {"compression": "lzf", "shuffle": True, "fletcher32": True},
        {"compression": "szip"},
        {"scaleoffset": 0},
        hdf5plugin.LZ4(),
        hdf5plugin.Blosc(cname="lz4", shuffle=hdf5plugin.Blosc.SHUFFLE),
        hdf5plugin.Blosc(cname="zstd", shuffle=hdf5plugin.Blosc.BITSHUFFLE),
        hdf5plugin.Blosc(cname="blosclz", shuffle=hdf5plugin.Blosc.NOSHUFFLE),
        hdf5plugin.Zstd(),
        hdf5plugin.Bitshuffle(cname="none"),
        hdf5plugin.Bitshuffle(cname="lz4"),
        hdf5plugin.Bitshuffle(cname="lz4", nelems=64),
        hdf5plugin.Bitshuffle(cname="zstd"),
    ]
    for dtype in TYPES:
        # Noise too, which LZF leaves as it is; and chunks of no whole number of bytes of bits.
        for array in [volume(dtype), volume(dtype, (40, 41, 43)), np.random.default_rng(1).permutation(volume(dtype).ravel())]:
            for number, way in enumerate(ways):
                if "scaleoffset" in way and np.dtype(dtype).kind == "f":
                    continue
                with h5py.File("in.h5", "w") as file:
                    file.create_dataset("a", data=array, chunks=tuple(min(count, 19) for count in array.shape), **way)
                equal(f"{dtype} {array.shape} in {dict(way)}", converted("in.h5"), array)


def check_netcdf():
    for form in FORMATS:
        array = volume("i2", (6, 14, 15))
        with netCDF4.Dataset("in.nc", "w", format=form) as file:
            for name, count in [("time", None), ("lat", 14), ("lon", 15), ("ends", 2)]:
                file.createDimension(name, count)
            file.createVariable("time", "f8", ("time",))[:] = np.arange(6)
            file.createVariable("lat", "f4", ("lat",))[:] = np.linspace(-60, 60, 14)
            file.createVariable("lon", "f4", ("lon",))[:] = 0.25 * np.arange(15) + 7
            file["lon"].units = "degrees_east"
            file.createVariable("time_ends", "f8", ("time", "ends"))[:] = np.zeros((6, 2))
            field = file.createVariable("t2m", "i2", ("time", "lat", "lon"))
            field.setncatts({"units": "K", "scale_factor": 0.01, "add_offset": 273.15})
            field.set_auto_scale(False)
            field[:] = array
        equal(form, converted("in.nc"), array)
        found = header_of("in.nc")
        steps = [float(step) for step in found["spacings"].split()]
        if not np.allclose(steps, [0.25, 120 / 13, 1]) or found["axis mins"] != "7 -60 0":
            sys.exit(f"{form}: coordinates are {found}")
        told = succeed("convert", "in.nc", "out.raw").stderr
        if "scale_factor" not in told or "add_offset" not in told:
            sys.exit(f"{form}: what raw samples lose is not told: {told}")


def main():
    global WAVELIFT
    parser = argparse.ArgumentParser()
    parser.add_argument("--wavelift", required=True)
    parser.add_argument("--data")
    WAVELIFT = str(pathlib.Path(parser.parse_args().wavelift).resolve())
    for check in [check_types, check_choice, check_codings, check_netcdf]:
        check()
        print(f"{check.__name__}: equal")


if __name__ == "__main__":
    main()
