// Decodes codestreams of wavelift: kernel/capi as a WebAssembly module. What each call does is said in wavelift.h.

// Offsets in the structs of wavelift.h, where pointers and size_t have 4 bytes.
const PLAN = { extent: 0, wavelet: 12, levels: 13, sampleType: 14 };
const HEADER = { plan: 0, storage: 16, slack: 20, encodedBytes: 24, size: 32 };
const LEVEL = { extent: 0, samplesLen: 12, scratchLen: 16, bytes: 24, size: 32 };
const LENT = { samples: 0, samplesLen: 4, scratch: 8, scratchLen: 12, size: 16 };

const STORAGES = ["coefficients", "dense", "lattice", "stored"];
const LATTICE = 2;
const WAVELETS = ["none", "haar", "quadratic", "duchaineau", "linear", "cubic", "quintic"];
const SAMPLE_TYPES = ["u8", "i8", "u16", "i16", "u32", "i32"];

const PAGE = 65536;

/** What is wrong with a codestream or a call; `name` is that of the error in wavelift.h. */
export class WaveliftError extends Error {
    constructor(name) {
        super(name);
        this.name = name;
    }
}

export class Decoder {
    #module;
    #free = 0;

    /** Bytes of memory that the module may take: a codestream that claims more is refused. */
    limit = 256 * 1024 * 1024;

    /** A decoder from the bytes of the module. */
    static async load(wasm) {
        const { instance } = await WebAssembly.instantiate(wasm);
        return new Decoder(instance.exports);
    }

    constructor(module) {
        this.#module = module;
    }

    /** What a codestream holds. */
    header(bytes) {
        this.#reset();
        const header = this.#take(HEADER.size);
        const from = this.#copy(bytes);
        this.#check(this.#module.wavelift_header_parse(from, bytes.length, header));
        const view = this.#view();
        const plan = header + HEADER.plan;
        return {
            extent: this.#extent(plan + PLAN.extent),
            wavelet: WAVELETS[view.getUint8(plan + PLAN.wavelet)],
            levels: view.getUint8(plan + PLAN.levels),
            sampleType: SAMPLE_TYPES[view.getUint8(plan + PLAN.sampleType)],
            storage: STORAGES[view.getInt32(header + HEADER.storage, true)],
            slack: view.getUint32(header + HEADER.slack, true),
            encodedBytes: Number(view.getBigUint64(header + HEADER.encodedBytes, true)),
        };
    }

    /** The samples per axis of a level, and the bytes that it takes, from the beginning. */
    level(bytes, level) {
        this.#reset();
        const { extent, bytes: count } = this.#level(this.#copy(bytes), bytes.length, level);
        return { extent, bytes: count };
    }

    /** Decodes to a level: samples per axis, and the samples, x fastest. */
    decode(bytes, level) {
        const { storage } = this.header(bytes);
        this.#reset();
        const from = this.#copy(bytes);
        const { extent, samplesLen, scratchLen } = this.#level(from, bytes.length, level);
        const samples = this.#take(4 * samplesLen);
        const lent = this.#lend(samples, samplesLen, this.#take(4 * scratchLen), scratchLen);
        this.#check(this.#decodeAs(STORAGES.indexOf(storage), from, bytes.length, level, lent));
        const count = extent[0] * extent[1] * extent[2];
        return { extent, samples: new Int32Array(this.#module.memory.buffer, samples, count).slice() };
    }

    #decodeAs(storage, from, length, level, lent) {
        const module = this.#module;
        if (storage === LATTICE) {
            const lattice = this.#take(module.wavelift_lattice_size());
            return module.wavelift_decode_near(lattice, from, length, level, lent);
        }
        const codec = this.#take(module.wavelift_codec_size());
        const dense = this.#take(module.wavelift_dense_size());
        return module.wavelift_decode_dense(codec, dense, from, length, level, lent);
    }

    #level(from, length, level) {
        const found = this.#take(LEVEL.size);
        this.#check(this.#module.wavelift_header_level(from, length, level, found));
        const view = this.#view();
        return {
            extent: this.#extent(found + LEVEL.extent),
            samplesLen: view.getUint32(found + LEVEL.samplesLen, true),
            scratchLen: view.getUint32(found + LEVEL.scratchLen, true),
            bytes: Number(view.getBigUint64(found + LEVEL.bytes, true)),
        };
    }

    #lend(samples, samplesLen, scratch, scratchLen) {
        const lent = this.#take(LENT.size);
        const view = this.#view();
        view.setUint32(lent + LENT.samples, samples, true);
        view.setUint32(lent + LENT.samplesLen, samplesLen, true);
        view.setUint32(lent + LENT.scratch, scratch, true);
        view.setUint32(lent + LENT.scratchLen, scratchLen, true);
        return lent;
    }

    #extent(at) {
        const view = this.#view();
        return [0, 4, 8].map((axis) => view.getUint32(at + axis, true));
    }

    #check(error) {
        if (error !== 0) {
            throw new WaveliftError(this.#text(this.#module.wavelift_error_name(error)));
        }
    }

    #text(at) {
        const bytes = new Uint8Array(this.#module.memory.buffer, at);
        return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
    }

    #copy(bytes) {
        const at = this.#take(bytes.length);
        new Uint8Array(this.#module.memory.buffer, at, bytes.length).set(bytes);
        return at;
    }

    /** Gives back what was taken. */
    #reset() {
        this.#free = this.#module.__heap_base.value;
    }

    /** Takes bytes behind what the module itself needs. */
    #take(bytes) {
        const start = Math.ceil(this.#free / 16) * 16;
        const end = start + bytes;
        if (end > this.limit) {
            throw new WaveliftError("MEMORY_LIMIT");
        }
        const missing = Math.ceil((end - this.#module.memory.buffer.byteLength) / PAGE);
        if (missing > 0) {
            this.#module.memory.grow(missing);
        }
        this.#free = end;
        return start;
    }

    #view() {
        return new DataView(this.#module.memory.buffer);
    }
}
