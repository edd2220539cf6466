/*
 * wavelift: integer wavelet coding of lines, slices and bricks of samples, without loss or within a bound.
 *
 * The library allocates nothing, has no globals and calls nobody: all memory is lent by the caller, for the time of a
 * call unless said otherwise, and any number of calls may run at once on memory of their own. Bytes to decode may be
 * anything: what is wrong with them is an error code, and work is bounded by the memory lent.
 *
 * Samples are int32_t in memory whatever their type, x fastest, then y, then z; those of WAVELIFT_U32 are the same 32
 * bits. A line of n samples has the extent {n, 1, 1}, a slice {x, y, 1}. Lengths named `_len` count elements.
 *
 * Of every pointer a call checks what can be checked: NULL (allowed only where said, and for a buffer of length 0),
 * alignment, and that the buffers of one call do not overlap. It cannot check that as much memory as a length says is
 * there, nor that no other thread writes to it meanwhile: that is up to the caller.
 *
 * Levels: level 0 is full resolution, level L has ceil(n / 2^L) samples along each axis.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef WAVELIFT_H
#define WAVELIFT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a call returns: WAVELIFT_OK; from 1 to 99, the data are at fault; from 100 on, the caller is. */
typedef int32_t wavelift_error;

enum {
    WAVELIFT_OK = 0,

    WAVELIFT_TRUNCATED = 1,                /* the bytes end before the codestream, or the level asked for, does */
    WAVELIFT_NOT_A_CODESTREAM = 2,         /* they do not begin like one */
    WAVELIFT_UNSUPPORTED_VERSION = 3,      /* a version of the format that this library does not know */
    WAVELIFT_TRAILING_BYTES = 4,           /* bytes follow the codestream */
    WAVELIFT_MALFORMED_RESERVED = 10,      /* a reserved value in the header */
    WAVELIFT_MALFORMED_NUMBER = 11,        /* a number of the header not in its shortest form */
    WAVELIFT_MALFORMED_EXTENT = 12,        /* an axis without samples, or 2^31 samples or more */
    WAVELIFT_MALFORMED_LEVELS = 13,        /* more levels than the extent allows, or a wavelet without levels */
    WAVELIFT_MALFORMED_STORED_LENGTH = 14, /* stored samples of another length than the extent's */
    WAVELIFT_MALFORMED_SEGMENT = 15,       /* a segment that no encoder writes */
    WAVELIFT_MALFORMED_SAMPLE = 16,        /* a sample outside the declared type */
    WAVELIFT_MALFORMED_SLAB = 17,          /* a slab that is not as its stream says, or is dense or near-lossless */
    WAVELIFT_MALFORMED = 99,               /* a fault of the data that has no code in this header */

    WAVELIFT_NULL_POINTER = 100,           /* a pointer is NULL that must not be */
    WAVELIFT_MISALIGNED = 101,             /* a pointer is not aligned as its type asks */
    WAVELIFT_OVERLAP = 102,                /* two buffers overlap */
    WAVELIFT_TOO_LONG = 103,               /* a buffer is longer than memory can be */
    WAVELIFT_UNKNOWN_WAVELET = 104,        /* no wavelet has this number; or WAVELIFT_NO_WAVELET with levels */
    WAVELIFT_UNKNOWN_SAMPLE_TYPE = 105,    /* no type has this number */
    WAVELIFT_ZERO_EXTENT = 106,            /* an axis has no samples */
    WAVELIFT_EXTENT_TOO_LARGE = 107,       /* 2^31 samples or more */
    WAVELIFT_TOO_MANY_LEVELS = 108,        /* the extent allows fewer: wavelift_max_levels */
    WAVELIFT_SAMPLES_LENGTH = 109,         /* the samples lent are not exactly as many as the call takes */
    WAVELIFT_SCRATCH_TOO_SHORT = 110,      /* the scratch is shorter than the call takes */
    WAVELIFT_SAMPLE_OUT_OF_RANGE = 111,    /* a sample is outside its type */
    WAVELIFT_OUTPUT_FULL = 112,            /* the codestream does not fit the output */
    WAVELIFT_LEVEL_OUT_OF_RANGE = 113,     /* the codestream holds fewer levels */
    WAVELIFT_OTHER_CODEC = 114,            /* a near-lossless codestream, or none where one must be; rows for slabs */
    WAVELIFT_NEEDS_DENSE = 115,            /* a dense codestream: wavelift_decode_dense */
    WAVELIFT_NOT_BEGUN = 116,              /* nothing has begun in this memory */
    WAVELIFT_UNFINISHED_ROW = 117,         /* the last row lacks samples */
    WAVELIFT_NOT_BUILT = 118,              /* the library was built without what this takes */
    WAVELIFT_BYTES_TOO_SHORT = 119,        /* the bytes lent for a slab are too few */
    WAVELIFT_REFUSED = 199                 /* a fault of the call that has no code in this header */
};

/* The name of a code, such as "WAVELIFT_TRUNCATED"; of any other number, "not an error of wavelift". */
const char *wavelift_error_name(int32_t error);

/* Types of samples. */
enum {
    WAVELIFT_U8 = 0,
    WAVELIFT_I8 = 1,
    WAVELIFT_U16 = 2,
    WAVELIFT_I16 = 3,
    WAVELIFT_U32 = 4,
    WAVELIFT_I32 = 5
};

/* Wavelets. */
enum {
    WAVELIFT_NO_WAVELET = 0, /* with 0 levels */
    WAVELIFT_HAAR = 1,
    WAVELIFT_QUADRATIC = 2,
    WAVELIFT_DUCHAINEAU = 3,
    WAVELIFT_LINEAR = 4,
    WAVELIFT_CUBIC = 5,
    WAVELIFT_QUINTIC = 6
};

/* What a codestream holds. */
typedef struct wavelift_plan {
    uint32_t extent[3];  /* samples along x, y, z: at least 1 each, less than 2^31 in all */
    uint8_t wavelet;
    uint8_t levels;      /* of the transform, at most wavelift_max_levels */
    uint8_t sample_type;
} wavelift_plan;

/* Samples and scratch, lent for one call. Scratch means nothing before and after. */
typedef struct wavelift_lent {
    int32_t *samples;
    size_t samples_len; /* exactly as many elements as the call takes */
    int32_t *scratch;
    size_t scratch_len; /* at least as many */
} wavelift_lent;

/*
 * States: memory of fixed size that some calls take. It needs no initialization, means nothing before and after a
 * call, and can lie anywhere; without an initializer a static one takes no room in flash.
 */
#define WAVELIFT_CODEC_WORDS 428
#define WAVELIFT_TRAINING_WORDS 1342
#define WAVELIFT_DENSE_WORDS 9432
#define WAVELIFT_LATTICE_WORDS 2866

/* Models of both directions: 3,424 bytes. */
typedef struct wavelift_codec {
    uint64_t opaque[WAVELIFT_CODEC_WORDS];
} wavelift_codec;

/* For encoding with trained predictors: 10,736 bytes. */
typedef struct wavelift_training {
    uint64_t opaque[WAVELIFT_TRAINING_WORDS];
} wavelift_training;

/* For dense codestreams, both ways: 75,456 bytes. */
typedef struct wavelift_dense {
    uint64_t opaque[WAVELIFT_DENSE_WORDS];
} wavelift_dense;

/* For near-lossless codestreams, both ways: 22,928 bytes. */
typedef struct wavelift_lattice {
    uint64_t opaque[WAVELIFT_LATTICE_WORDS];
} wavelift_lattice;

/* Bytes of each, for languages that do not read this header; all are aligned to 8 bytes. */
size_t wavelift_codec_size(void);
size_t wavelift_training_size(void);
size_t wavelift_dense_size(void);
size_t wavelift_lattice_size(void);

/*
 * What to lend
 */

/* WAVELIFT_OK if there is such a plan, otherwise what is wrong with it. */
wavelift_error wavelift_plan_check(const wavelift_plan *plan);

/* The most levels of an extent of x, y, z samples: one per halving until each axis is 1 long. 0 if there is no such
 * extent. */
uint8_t wavelift_max_levels(uint32_t x, uint32_t y, uint32_t z);

/* Each of these is 0 for NULL, and if what it depends on makes no plan. */

/* Samples of a plan. */
size_t wavelift_samples_len(const wavelift_plan *plan);

/* Bytes that suffice for any codestream of a plan, whatever its samples, encoder, wavelet and levels: the samples as
 * they are, and 26 bytes. 0, too, if they are 4 GiB or more, which no codestream holds. */
size_t wavelift_max_encoded_len(const wavelift_plan *plan);

/* Elements of scratch that wavelift_encode, wavelift_encode_light and wavelift_encode_tabled take, and wavelift_decode
 * of what they encoded. */
size_t wavelift_scratch_len(const wavelift_plan *plan);

/* Elements of scratch that wavelift_encode_dense takes, and wavelift_decode_dense of what it encoded. */
size_t wavelift_dense_scratch_len(const wavelift_plan *plan);

/* Elements of scratch that wavelift_encode_near takes: about two per sample. Decoding takes about one:
 * wavelift_header_level. */
size_t wavelift_near_scratch_len(const wavelift_plan *plan);

/*
 * Encoding
 *
 * `out` has room for *out_len bytes; wavelift_max_encoded_len always suffice. On success *out_len is the length of the
 * codestream at its beginning; after an error it is what it was, and `out` means nothing.
 *
 * Faults: of the plan; WAVELIFT_SAMPLES_LENGTH, WAVELIFT_SCRATCH_TOO_SHORT, WAVELIFT_SAMPLE_OUT_OF_RANGE, with which
 * the samples are untouched; WAVELIFT_OUTPUT_FULL, with which they are what they were; of pointers.
 */

/* Encodes without loss. With memory for training, predictors are trained on the samples; with NULL, coding is faster
 * and the codestream longer. Uses the samples up: afterwards they mean nothing. */
wavelift_error wavelift_encode(wavelift_codec *codec, wavelift_training *training, const wavelift_plan *plan,
                               const wavelift_lent *lent, uint8_t *out, size_t *out_len);

/* Encodes without loss in few instructions a sample, for small processors: the codestream is about as long as that of
 * wavelift_encode without memory for training. Uses the samples up. */
wavelift_error wavelift_encode_light(wavelift_codec *codec, const wavelift_plan *plan, const wavelift_lent *lent,
                                     uint8_t *out, size_t *out_len);

/* Encodes without loss, quickest both ways, slices and bricks with 0 levels of 16,384 samples or more that span at most
 * 19 bits. With memory for training the codestream is nearly as short as that of wavelift_encode with it, and samples
 * span at most 16 bits. Others are encoded as by wavelift_encode. Uses the samples up. */
wavelift_error wavelift_encode_tabled(wavelift_codec *codec, wavelift_training *training, const wavelift_plan *plan,
                                      const wavelift_lent *lent, uint8_t *out, size_t *out_len);

/* Encodes without loss, into the shortest codestream and slowest both ways, plans with 0 levels whose samples span at
 * most 25 bits; other plans as wavelift_encode. Uses the samples up. */
wavelift_error wavelift_encode_dense(wavelift_codec *codec, wavelift_training *training, wavelift_dense *dense,
                                     const wavelift_plan *plan, const wavelift_lent *lent, uint8_t *out,
                                     size_t *out_len);

/* Encodes so that no decoded sample is further than `slack` from its original. Wavelet and levels of the plan do
 * not matter. Leaves the samples as they were. */
wavelift_error wavelift_encode_near(wavelift_lattice *lattice, const wavelift_plan *plan, uint32_t slack,
                                    const wavelift_lent *lent, uint8_t *out, size_t *out_len);

/*
 * Looking at a codestream
 */

/* How a codestream holds its samples, and so which call decodes it. */
typedef int32_t wavelift_storage;

enum {
    WAVELIFT_CODED = 0,   /* as coefficients, light too, or with tables: wavelift_decode or wavelift_decode_dense */
    WAVELIFT_DENSE = 1,   /* densely: wavelift_decode_dense */
    WAVELIFT_LATTICE = 2, /* near-losslessly: wavelift_decode_near */
    WAVELIFT_STORED = 3   /* as they are, whatever the encoder: as WAVELIFT_CODED, and without levels any */
};

typedef struct wavelift_header {
    wavelift_plan plan; /* of a near-lossless codestream, levels without a wavelet */
    wavelift_storage storage;
    uint32_t slack;         /* how far a sample may be from its original: 0, but of near-lossless codestreams */
    uint64_t encoded_bytes; /* of the whole codestream */
} wavelift_header;

/* What it takes to decode a codestream to a level. */
typedef struct wavelift_level {
    uint32_t extent[3]; /* samples along x, y, z at that level */
    size_t samples_len; /* samples to lend, exactly; those of the level come first */
    size_t scratch_len; /* scratch to lend, at least */
    uint64_t bytes;     /* from the beginning of the codestream, that suffice */
} wavelift_level;

/* No header is longer. */
#define WAVELIFT_MAX_HEADER_BYTES 187

/* Reads the header of the codestream at the beginning of `bytes`; what follows the header is not looked at. After an
 * error *header is untouched. */
wavelift_error wavelift_header_parse(const uint8_t *bytes, size_t bytes_len, wavelift_header *header);

/* Reads the header, and says what `level` takes. The numbers are what the bytes claim: check them before memory is
 * taken for them. After an error, such as WAVELIFT_LEVEL_OUT_OF_RANGE, *found is untouched. */
wavelift_error wavelift_header_level(const uint8_t *bytes, size_t bytes_len, uint8_t level, wavelift_level *found);

/*
 * Decoding
 *
 * `bytes` are a whole codestream, or its beginning as far as `level` takes it. The samples of the level, x fastest, are
 * the first of those lent; after an error they mean nothing. Those of a level of a transform are in its scale.
 *
 * Faults: any of the data's; WAVELIFT_LEVEL_OUT_OF_RANGE, WAVELIFT_SAMPLES_LENGTH, WAVELIFT_SCRATCH_TOO_SHORT,
 * WAVELIFT_OTHER_CODEC, WAVELIFT_NEEDS_DENSE; of pointers.
 */

/* Decodes what wavelift_encode, wavelift_encode_light or wavelift_encode_tabled encoded. */
wavelift_error wavelift_decode(wavelift_codec *codec, const uint8_t *bytes, size_t bytes_len, uint8_t level,
                               const wavelift_lent *lent);

/* Decodes what all of them but wavelift_encode_near encoded. */
wavelift_error wavelift_decode_dense(wavelift_codec *codec, wavelift_dense *dense, const uint8_t *bytes,
                                     size_t bytes_len, uint8_t level, const wavelift_lent *lent);

/* Decodes what wavelift_encode_near encoded. Level L is every 2^L-th sample along each axis. */
wavelift_error wavelift_decode_near(wavelift_lattice *lattice, const uint8_t *bytes, size_t bytes_len, uint8_t level,
                                    const wavelift_lent *lent);

/*
 * Streams of rows
 *
 * A slice whose rows come one after another, their number not known before, becomes a stream of bytes in the memory of
 * a few rows, and rows again. Input and output are cut into any pieces, and results do not depend on how.
 *
 * An encoder or decoder begins in memory that is lent to it until its last call: its own, the codec's, and `memory`.
 * Meanwhile nobody writes there. There is no call to end it: one that is no longer used is forgotten.
 */

typedef struct wavelift_row_plan {
    uint32_t width; /* samples of a row: at least 1, less than 2^31 */
    uint16_t strip; /* rows whose bytes are ended together; 0 for as many as suit the width */
    uint8_t wavelet;
    uint8_t levels; /* at most 31 */
    uint8_t sample_type;
} wavelift_row_plan;

/* What is needed to go on. */
typedef int32_t wavelift_status;

enum {
    WAVELIFT_NEED_INPUT = 0,  /* more input: all of it is taken */
    WAVELIFT_NEED_OUTPUT = 1, /* more room for output, or another step */
    WAVELIFT_DONE = 2         /* nothing: the stream is complete */
};

typedef struct wavelift_step {
    size_t consumed; /* elements taken from the beginning of the input */
    size_t produced; /* elements written to the beginning of the output */
    wavelift_status status;
} wavelift_step;

#define WAVELIFT_ROW_CODEC_WORDS 791
#define WAVELIFT_ROW_ENCODER_WORDS 160
#define WAVELIFT_ROW_DECODER_WORDS 256

/* Models of both directions: 6,328 bytes. */
typedef struct wavelift_row_codec {
    uint64_t opaque[WAVELIFT_ROW_CODEC_WORDS];
} wavelift_row_codec;

/* An encoder at work: 1,280 bytes. */
typedef struct wavelift_row_encoder {
    uint64_t opaque[WAVELIFT_ROW_ENCODER_WORDS];
} wavelift_row_encoder;

/* A decoder at work: 2,048 bytes. */
typedef struct wavelift_row_decoder {
    uint64_t opaque[WAVELIFT_ROW_DECODER_WORDS];
} wavelift_row_decoder;

size_t wavelift_row_codec_size(void);
size_t wavelift_row_encoder_size(void);
size_t wavelift_row_decoder_size(void);

/* Elements of `memory` that an encoder and a decoder take, and in which a decoder takes about a quarter less time. 0 for
 * NULL, and if there is no such plan. */
size_t wavelift_row_encoder_memory_len(const wavelift_row_plan *plan);
size_t wavelift_row_decoder_memory_len(const wavelift_row_plan *plan);
size_t wavelift_row_decoder_fast_memory_len(const wavelift_row_plan *plan);

/* Begins to encode. Faults: of the plan, as of a wavelift_plan; WAVELIFT_SCRATCH_TOO_SHORT for `memory`; of pointers.
 * With an error nothing has begun, and what was begun in *encoder before has ended. */
wavelift_error wavelift_row_encoder_begin(wavelift_row_encoder *encoder, wavelift_row_codec *codec,
                                          const wavelift_row_plan *plan, int32_t *memory, size_t memory_len);

/* Takes samples, x fastest, and gives bytes, until one of them is used up, or nothing is left to do.
 * WAVELIFT_SAMPLE_OUT_OF_RANGE if the first sample is outside its type. With an error nothing was taken or given, and
 * *step is untouched. */
wavelift_error wavelift_row_encoder_step(wavelift_row_encoder *encoder, const int32_t *samples, size_t samples_len,
                                         uint8_t *out, size_t out_len, wavelift_step *step);

/* Says that no more rows follow: further steps, without samples, give the rest of the stream. WAVELIFT_UNFINISHED_ROW
 * if samples of the last row are missing; the encoder goes on then. */
wavelift_error wavelift_row_encoder_finish(wavelift_row_encoder *encoder);

/* Reads the header at the beginning of a stream, and how long it is: 21 bytes at most. After an error both are
 * untouched; WAVELIFT_TRUNCATED if `bytes` ends first. */
wavelift_error wavelift_row_header_parse(const uint8_t *bytes, size_t bytes_len, wavelift_row_plan *plan,
                                         size_t *header_len);

/* Begins to decode what follows the header, which said what the plan is. Faults as of wavelift_row_encoder_begin. */
wavelift_error wavelift_row_decoder_begin(wavelift_row_decoder *decoder, wavelift_row_codec *codec,
                                          const wavelift_row_plan *plan, int32_t *memory, size_t memory_len);

/* Takes bytes and gives samples, x fastest, until one of them is used up, or the stream is complete; what follows it is
 * not taken. Where WAVELIFT_NEED_INPUT meets the end of the input, the stream is truncated. What is wrong with the
 * stream is told as soon as all samples before are given, and from then on always; *step is untouched then. */
wavelift_error wavelift_row_decoder_step(wavelift_row_decoder *decoder, const uint8_t *bytes, size_t bytes_len,
                                         int32_t *samples, size_t samples_len, wavelift_step *step);

/*
 * Streams of slabs
 *
 * A volume whose slices come one after another, their number not known before: every few slices are a codestream of
 * their own. A wavelift_plan says what a whole slab is; the last may have fewer slices. What is said of streams of rows
 * holds here too, with slices for rows. An encoder or decoder is lent samples and scratch of at least
 * wavelift_samples_len and wavelift_scratch_len elements, and wavelift_max_encoded_len bytes, all until its last call.
 */

#define WAVELIFT_SLAB_ENCODER_WORDS 44
#define WAVELIFT_SLAB_DECODER_WORDS 40

/* An encoder at work: 352 bytes. */
typedef struct wavelift_slab_encoder {
    uint64_t opaque[WAVELIFT_SLAB_ENCODER_WORDS];
} wavelift_slab_encoder;

/* A decoder at work: 320 bytes. */
typedef struct wavelift_slab_decoder {
    uint64_t opaque[WAVELIFT_SLAB_DECODER_WORDS];
} wavelift_slab_decoder;

size_t wavelift_slab_encoder_size(void);
size_t wavelift_slab_decoder_size(void);

/* Begin to encode every slab as wavelift_encode, wavelift_encode_light or wavelift_encode_tabled encode a brick; memory
 * for training, or NULL, is as there, and is lent as the rest is. Faults: of the plan, of the lengths of what is lent,
 * and of pointers. With an error nothing has begun, and what was begun in *encoder before has ended. */
wavelift_error wavelift_slab_encoder_begin(wavelift_slab_encoder *encoder, wavelift_codec *codec,
                                           wavelift_training *training, const wavelift_plan *plan,
                                           const wavelift_lent *lent, uint8_t *bytes, size_t bytes_len);
wavelift_error wavelift_slab_encoder_begin_light(wavelift_slab_encoder *encoder, wavelift_codec *codec,
                                                 const wavelift_plan *plan, const wavelift_lent *lent, uint8_t *bytes,
                                                 size_t bytes_len);
wavelift_error wavelift_slab_encoder_begin_tabled(wavelift_slab_encoder *encoder, wavelift_codec *codec,
                                                  wavelift_training *training, const wavelift_plan *plan,
                                                  const wavelift_lent *lent, uint8_t *bytes, size_t bytes_len);

/* As wavelift_row_encoder_step and wavelift_row_encoder_finish. */
wavelift_error wavelift_slab_encoder_step(wavelift_slab_encoder *encoder, const int32_t *samples, size_t samples_len,
                                          uint8_t *out, size_t out_len, wavelift_step *step);
wavelift_error wavelift_slab_encoder_finish(wavelift_slab_encoder *encoder);

/* As wavelift_row_header_parse. */
wavelift_error wavelift_slab_header_parse(const uint8_t *bytes, size_t bytes_len, wavelift_plan *plan,
                                          size_t *header_len);

/* Begins to decode what follows the header. Faults as of wavelift_slab_encoder_begin. */
wavelift_error wavelift_slab_decoder_begin(wavelift_slab_decoder *decoder, wavelift_codec *codec,
                                           const wavelift_plan *plan, const wavelift_lent *lent, uint8_t *bytes,
                                           size_t bytes_len);

/* As wavelift_row_decoder_step. */
wavelift_error wavelift_slab_decoder_step(wavelift_slab_decoder *decoder, const uint8_t *bytes, size_t bytes_len,
                                          int32_t *samples, size_t samples_len, wavelift_step *step);

#ifdef __cplusplus
}
#endif

#endif
