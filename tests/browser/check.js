// Golden codestreams, decoded and compared with what the manifest expects; and with bits flipped.

import { WaveliftError } from "./decoder.js";

/** Bytes of memory that a damaged codestream may claim. */
const DAMAGED_LIMIT = 16 * 1024 * 1024;

/** Flips of each codestream. */
const FLIPS = 24;

/** Bytes of a vector as the list holds them, in hexadecimal. */
export function bytesOf(vector) {
    return Uint8Array.from(vector.hex.match(/../g) ?? [], (digits) => parseInt(digits, 16));
}

/** CRC-32, of zlib and PNG, of samples as little-endian 32-bit numbers: eight hexadecimal digits. */
export function crc32(samples) {
    let crc = ~0;
    for (const sample of samples) {
        for (let shift = 0; shift < 32; shift += 8) {
            crc ^= (sample >>> shift) & 0xff;
            for (let bit = 0; bit < 8; bit++) {
                crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
            }
        }
    }
    return (~crc >>> 0).toString(16).padStart(8, "0");
}

/** The name in C of an error as the manifest has it: "Malformed(Extent)" is WAVELIFT_MALFORMED_EXTENT. */
function nameInC(error) {
    const [, kind, rule] = error.match(/^(\w+)(?:\((\w+)\))?/);
    const words = [kind, rule].filter(Boolean).map((word) => word.replace(/(?<=[a-z])(?=[A-Z])/g, "_"));
    return `WAVELIFT_${words.join("_").toUpperCase()}`.replace("NOT_ACODESTREAM", "NOT_A_CODESTREAM");
}

/** The checksum of a codestream, or the name of what is wrong with it. Any other exception is a fault of ours. */
function outcome(decoder, bytes) {
    try {
        return crc32(decoder.decode(bytes, 0).samples);
    } catch (error) {
        if (error instanceof WaveliftError) {
            return error.name;
        }
        throw error;
    }
}

/** Every level from as few bytes as it takes, one byte fewer being too few; what is wrong, if something is. */
function checkLevels(decoder, bytes) {
    const { levels } = decoder.header(bytes);
    for (let level = 0; level <= levels; level++) {
        const { extent, bytes: enough } = decoder.level(bytes, level);
        const { samples } = decoder.decode(bytes.subarray(0, enough), level);
        if (samples.length !== extent[0] * extent[1] * extent[2]) {
            return `level ${level} has ${samples.length} samples, not ${extent.join("x")}`;
        }
        try {
            decoder.decode(bytes.subarray(0, enough - 1), level);
            return `level ${level} decodes from too few bytes`;
        } catch (error) {
            if (error.name !== "WAVELIFT_TRUNCATED") {
                return `level ${level} from too few bytes: ${error}`;
            }
        }
    }
    return null;
}

/** Flips bits, spread over the codestream: each time an outcome must come back. */
function flip(decoder, bytes) {
    for (let i = 0; i < FLIPS && bytes.length > 0; i++) {
        const bit = (i * 2654435761) % (8 * bytes.length);
        const damaged = bytes.slice();
        damaged[bit >> 3] ^= 1 << (bit & 7);
        outcome(decoder, damaged);
    }
}

function checkVector(decoder, vector) {
    const bytes = bytesOf(vector);
    const expected = vector.expect.crc32 ?? nameInC(vector.expect.error);
    const found = outcome(decoder, bytes);
    if (found !== expected) {
        return `${found}, not ${expected}`;
    }
    flip(decoder, bytes);
    return vector.expect.crc32 ? checkLevels(decoder, bytes) : null;
}

/** Checks every vector of the list: what is wrong, a line each. */
export function check(decoder, vectors) {
    const { limit } = decoder;
    decoder.limit = DAMAGED_LIMIT;
    const problems = [];
    for (const vector of vectors) {
        try {
            const problem = checkVector(decoder, vector);
            problems.push(...(problem ? [`${vector.id}: ${problem}`] : []));
        } catch (error) {
            problems.push(`${vector.id}: ${error}`);
        }
    }
    decoder.limit = limit;
    return problems;
}

/** The verdict in one line, and the problems. */
export function verdict(decoder, vectors) {
    const problems = check(decoder, vectors);
    const right = vectors.length - problems.length;
    return [`${right} passed, ${problems.length} failed`, ...problems].join("\n");
}
