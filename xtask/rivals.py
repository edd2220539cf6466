"""Rival codecs on the volumes of a list: one JSON object a line, for `cargo xtask bench`, which starts this.

    rivals.py LIST [--quick]

LIST is what `cargo xtask bench` writes: name, path, extent (x fastest), type and error bounds of every volume.
Needs numpy and imagecodecs; FFV1 is measured too where imageio_ffmpeg is installed. Image codecs take a volume slice
by slice. Every answer is checked. Times are CPU time on one thread, the least of several runs.
"""

import argparse
import json
import multiprocessing
import resource
import subprocess
from pathlib import Path

import imagecodecs
import numpy

try:
    import imageio_ffmpeg
except ImportError:
    imageio_ffmpeg = None

TYPES = {"u8": "u1", "i8": "i1", "u16": "<u2", "i16": "<i2", "u32": "<u4", "i32": "<i4", "f32": "<f4", "f64": "<f8"}

# A codec is measured until it has taken so many seconds, or so often.
SECONDS = 1.0
RUNS = 5

# As printed by an encoder that refuses: a codec that cannot code a type is left out of the volume's row.
REFUSALS = (ValueError, NotImplementedError, RuntimeError, TypeError)


def cpu_seconds():
    """CPU time of this process and of those it waited for."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in used)


def least(work):
    """Least seconds of several runs, and the last result."""
    seconds, spent = [], 0.0
    while len(seconds) < RUNS and spent < SECONDS:
        start = cpu_seconds()
        result = work()
        seconds.append(cpu_seconds() - start)
        spent += seconds[-1]
    return min(seconds), result


def sliced(encode, decode):
    """An image codec on each slice of a volume."""
    return (
        lambda samples: [encode(image) for image in samples],
        lambda streams, like: numpy.stack([decode(stream) for stream in streams]),
    )


def jpegxl(effort):
    return sliced(
        lambda image: imagecodecs.jpegxl_encode(image, lossless=True, effort=effort, numthreads=1),
        lambda stream: imagecodecs.jpegxl_decode(stream, numthreads=1),
    )


def from_bytes(data, like):
    return numpy.frombuffer(data[: like.nbytes], like.dtype).reshape(like.shape)


def ccsds121():
    settings = {"blocksize": 16, "rsi": 64}

    def room(samples):
        # Noise grows, and the last block is whole.
        return bytearray(2 * samples.nbytes + 4096)

    def encode(samples):
        bits = 8 * samples.itemsize
        return bytes(imagecodecs.aec_encode(samples.tobytes(), bitspersample=bits, out=room(samples), **settings))

    def decode(data, like):
        bits = 8 * like.itemsize
        return from_bytes(imagecodecs.aec_decode(data, bitspersample=bits, out=room(like), **settings), like)

    return encode, decode


def blosc2():
    settings = {"level": 9, "compressor": "zstd", "shuffle": "bitshuffle", "numthreads": 1}
    return (
        lambda samples: imagecodecs.blosc2_encode(samples.tobytes(), typesize=samples.itemsize, **settings),
        lambda data, like: from_bytes(imagecodecs.blosc2_decode(data, numthreads=1), like),
    )


def xz():
    return (
        lambda samples: imagecodecs.lzma_encode(samples.tobytes(), level=9),
        lambda data, like: from_bytes(imagecodecs.lzma_decode(data), like),
    )


def pcodec():
    return (
        lambda samples: imagecodecs.pcodec_encode(samples.ravel(), level=8),
        lambda data, like: imagecodecs.pcodec_decode(data, shape=like.shape, dtype=like.dtype),
    )


def zfp(**settings):
    return (
        lambda samples: imagecodecs.zfp_encode(samples, numthreads=1, **settings),
        lambda data, like: imagecodecs.zfp_decode(data, numthreads=1),
    )


def ffmpeg(arguments, data):
    program = [imageio_ffmpeg.get_ffmpeg_exe(), "-loglevel", "error", "-y", "-threads", "1"]
    done = subprocess.run(program + arguments, input=data, capture_output=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.decode(errors="replace"))
    return done.stdout


def ffv1():
    """Version 3, range coder, large contexts, one group of pictures. Its start is not counted: see `measure_ffv1`."""

    def format_of(like):
        return "gray" if like.itemsize == 1 else "gray16le"

    def encode(samples):
        _, height, width = samples.shape
        source = ["-f", "rawvideo", "-pix_fmt", format_of(samples), "-s", f"{width}x{height}", "-i", "-"]
        codec = ["-c:v", "ffv1", "-level", "3", "-coder", "2", "-context", "1", "-g", "100000", "-threads", "1"]
        return ffmpeg(source + codec + ["-f", "nut", "-"], samples.tobytes())

    def decode(data, like):
        return from_bytes(ffmpeg(["-i", "-", "-f", "rawvideo", "-pix_fmt", format_of(like), "-"], data), like)

    return encode, decode


def integer_codecs(samples, quick):
    codecs = {
        "JPEG-LS": sliced(imagecodecs.jpegls_encode, imagecodecs.jpegls_decode),
        "HTJ2K": sliced(lambda image: imagecodecs.htj2k_encode(image, reversible=True), imagecodecs.htj2k_decode),
        "JPEG 2000": sliced(
            lambda image: imagecodecs.jpeg2k_encode(image, level=0, reversible=True, codecformat="J2K", numthreads=1),
            lambda stream: imagecodecs.jpeg2k_decode(stream, numthreads=1),
        ),
        "JPEG XL e1": jpegxl(1),
        "JPEG XL e3": jpegxl(3),
        "CCSDS 121": ccsds121(),
        "Blosc2 zstd": blosc2(),
    }
    if samples.itemsize > 1:
        codecs["pcodec"] = pcodec()
    if not quick:
        codecs |= {"JPEG XL e7": jpegxl(7), "JPEG XL e9": jpegxl(9), "xz -9": xz()}
        if imageio_ffmpeg:
            codecs["FFV1"] = ffv1()
    return codecs


def float_codecs(quick):
    codecs = {"Blosc2 zstd": blosc2(), "pcodec": pcodec(), "zfp": zfp(mode="reversible")}
    return codecs if quick else codecs | {"xz -9": xz()}


def bounded_codecs(bound):
    return {
        "SZ3": (
            lambda samples: imagecodecs.sz3_encode(samples, mode="abs", abs=bound),
            lambda data, like: imagecodecs.sz3_decode(data, like.shape, like.dtype),
        ),
        "zfp": zfp(mode="a", level=bound),
        # Last, for it ends the program on fields whose missing values are huge.
        "SPERR": (
            lambda samples: imagecodecs.sperr_encode(samples, mode="pwe", level=bound, numthreads=1),
            lambda data, like: imagecodecs.sperr_decode(data, numthreads=1).reshape(like.shape),
        ),
    }


def size_of(encoded):
    return sum(map(len, encoded)) if isinstance(encoded, list) else len(encoded)


def start_of_ffmpeg():
    """Seconds that ffmpeg takes for next to nothing, each way."""
    nothing = numpy.zeros((1, 16, 16), numpy.uint8)
    encode, decode = ffv1()
    encode_seconds, data = least(lambda: encode(nothing))
    return encode_seconds, least(lambda: decode(data, nothing))[0]


def measure(codec, samples, bound=None):
    """Bytes and seconds of one codec on one volume."""
    encode, decode = codec
    encode_seconds, encoded = least(lambda: encode(samples))
    decode_seconds, decoded = least(lambda: decode(encoded, samples))
    if bound is None:
        right = decoded.tobytes() == samples.tobytes()
    else:
        error = numpy.abs(decoded.astype(numpy.float64) - samples).max()
        # Codecs compute in the samples' own precision.
        right = bool(error <= bound + numpy.spacing(numpy.abs(samples).max()))
    return {
        "bytes": size_of(encoded),
        "encode_seconds": encode_seconds,
        "decode_seconds": decode_seconds,
        "right": right,
    }


def report(**row):
    print(json.dumps(row), flush=True)


def measure_all(name, task, codecs, samples, bound=None):
    for codec, functions in codecs.items():
        try:
            row = measure(functions, samples, bound)
        except REFUSALS as error:
            report(measure="refused", volume=name, task=task, codec=codec, why=str(error).strip() or repr(error))
            continue
        if codec == "FFV1":
            for key, start in zip(("encode_seconds", "decode_seconds"), start_of_ffmpeg(), strict=True):
                row[key] = max(row[key] - start, 1e-3)
        report(measure="coding", volume=name, task=task, codec=codec, **row)


def unsigned(samples):
    """Samples from 0 on, since image codecs take no signs; the same as they are if they have none."""
    if samples.dtype.kind != "i":
        return samples
    return (samples.astype(numpy.int64) - int(samples.min())).astype(f"<u{samples.itemsize}")


def measure_volume(volume, quick):
    samples = numpy.fromfile(volume["path"], TYPES[volume["type"]]).reshape(volume["extent"][::-1])
    if samples.dtype.kind == "f":
        # Some codecs take a slice for what it is only if it has two axes.
        samples = samples.squeeze()
        measure_all(volume["name"], "lossless floats", float_codecs(quick), samples)
    else:
        samples = unsigned(samples)
        measure_all(volume["name"], "lossless", integer_codecs(samples, quick), samples)
    for bound in volume["bounds"]:
        codecs = bounded_codecs(bound["absolute"])
        measure_all(volume["name"], bound["task"], codecs, samples, bound["absolute"])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("list", type=Path)
    parser.add_argument("--quick", action="store_true")
    arguments = parser.parse_args()
    for volume in json.loads(arguments.list.read_text()):
        # In a process of its own, for there are codecs that end it.
        process = multiprocessing.Process(target=measure_volume, args=(volume, arguments.quick))
        process.start()
        process.join()
        if process.exitcode != 0:
            report(measure="refused", volume=volume["name"], task="", codec="a codec", why="it ends the program")


if __name__ == "__main__":
    main()
