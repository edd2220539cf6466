"""Rival codecs on the built-in data: lossless, one thread, least time of several runs, answers checked.

Started by `cargo xtask bench`; needs imagecodecs. Image codecs take a brick slice by slice.
"""

import time
from pathlib import Path

import imagecodecs
import numpy

VECTORS = Path(__file__).parent.parent / "vectors"
RUNS = 3
DATA = {
    "rt_brick64": ("rt_brick64_64x64x64_u8.raw", (64, 64, 64)),
    "rt_slice512": ("rt_slice512_512x512x1_u8.raw", (1, 512, 512)),
}


def jpegxl(effort):
    def encode(image):
        return imagecodecs.jpegxl_encode(image, lossless=True, effort=effort, numthreads=1)

    def decode(data):
        return imagecodecs.jpegxl_decode(data, numthreads=1)

    return encode, decode


def jpeg2000_encode(image):
    return imagecodecs.jpeg2k_encode(image, level=0, reversible=True, codecformat="J2K", numthreads=1)


CODECS = {
    "JPEG-LS": (imagecodecs.jpegls_encode, imagecodecs.jpegls_decode),
    "JPEG 2000": (jpeg2000_encode, imagecodecs.jpeg2k_decode),
    "JPEG XL, effort 1": jpegxl(1),
    "JPEG XL, effort 3": jpegxl(3),
    "JPEG XL, effort 7": jpegxl(7),
    "JPEG XL, effort 9": jpegxl(9),
}


def timed(work):
    start = time.perf_counter()
    result = work()
    return time.perf_counter() - start, result


def measure(encode, decode, slices):
    """Bytes, and least seconds of encoding and decoding all slices."""
    encode_time = decode_time = float("inf")
    for _ in range(RUNS):
        seconds, streams = timed(lambda: [encode(image) for image in slices])
        encode_time = min(encode_time, seconds)
        seconds, decoded = timed(lambda: [decode(stream) for stream in streams])
        decode_time = min(decode_time, seconds)
        for image, result in zip(slices, decoded, strict=True):
            assert numpy.array_equal(image, result), "not lossless"
    return sum(len(stream) for stream in streams), encode_time, decode_time


def main():
    for name, (file, shape) in DATA.items():
        samples = numpy.fromfile(VECTORS / file, dtype=numpy.uint8).reshape(shape)
        print(f"\nRivals, {name}, imagecodecs {imagecodecs.__version__}\n")
        for codec, (encode, decode) in CODECS.items():
            length, encode_time, decode_time = measure(encode, decode, list(samples))
            bits = 8 * length / samples.size
            speeds = [samples.size / seconds / 1e6 for seconds in (encode_time, decode_time)]
            print(f"{codec:<24} {length:>10} {bits:>10.3f} {speeds[0]:>12.1f} {speeds[1]:>12.1f}")


main()
