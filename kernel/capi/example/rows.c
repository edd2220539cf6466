#include "rows.h"

#include <stdio.h>
#include <string.h>

#include "golden.h"

#define MEMORY_LEN 8192
#define SLICE (&goldens[2])

static wavelift_row_codec codec;
static wavelift_row_encoder encoder;
static wavelift_row_decoder decoder;
static int32_t memory[MEMORY_LEN], original[GOLDEN_MAX_SAMPLES], samples[GOLDEN_MAX_SAMPLES];
static uint8_t whole[GOLDEN_MAX_BYTES], bytes[GOLDEN_MAX_BYTES];

static wavelift_row_plan plan_of(const golden *golden)
{
    wavelift_row_plan plan = {golden->plan.extent[0], 8, golden->plan.wavelet, 3, golden->plan.sample_type};
    return plan;
}

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Encodes `original`, that many samples and bytes at a time: the length of the stream in `into`, or 0. */
static size_t encode(const wavelift_row_plan *plan, size_t count, size_t piece, uint8_t *into)
{
    size_t taken = 0, given = 0;
    wavelift_step step = {0, 0, WAVELIFT_NEED_INPUT};
    if (wavelift_row_encoder_begin(&encoder, &codec, plan, memory, MEMORY_LEN) != WAVELIFT_OK) {
        return 0;
    }
    while (step.status != WAVELIFT_DONE) {
        size_t input = least(piece, count - taken), room = least(piece, GOLDEN_MAX_BYTES - given);
        if (room == 0 ||
            wavelift_row_encoder_step(&encoder, original + taken, input, into + given, room, &step) != WAVELIFT_OK) {
            return 0;
        }
        taken += step.consumed;
        given += step.produced;
        if (step.status == WAVELIFT_NEED_INPUT && taken == count &&
            wavelift_row_encoder_finish(&encoder) != WAVELIFT_OK) {
            return 0;
        }
    }
    return given;
}

/* Decodes to `samples`, that many bytes and samples at a time: how many there are, or 0 if not all is right. */
static size_t decode(const uint8_t *from, size_t len, size_t piece)
{
    wavelift_row_plan plan;
    size_t taken, given = 0;
    wavelift_step step = {0, 0, WAVELIFT_NEED_INPUT};
    if (wavelift_row_header_parse(from, len, &plan, &taken) != WAVELIFT_OK ||
        wavelift_row_decoder_memory_len(&plan) > MEMORY_LEN ||
        wavelift_row_decoder_begin(&decoder, &codec, &plan, memory, MEMORY_LEN) != WAVELIFT_OK) {
        return 0;
    }
    while (step.status != WAVELIFT_DONE) {
        size_t input = least(piece, len - taken), room = least(piece, GOLDEN_MAX_SAMPLES - given);
        if (wavelift_row_decoder_step(&decoder, from + taken, input, samples + given, room, &step) != WAVELIFT_OK) {
            return 0;
        }
        taken += step.consumed;
        given += step.produced;
        if ((step.status == WAVELIFT_NEED_INPUT && taken == len) || (input == 0 && step.produced == 0)) {
            return 0;
        }
    }
    return taken == len ? given : 0;
}

/* Rows come back, and neither way depends on how input and output are cut. */
static int rows_in_pieces(void)
{
    wavelift_row_plan plan = plan_of(SLICE);
    size_t count = wavelift_samples_len(&SLICE->plan);
    golden_samples(SLICE, original);
    size_t len = encode(&plan, count, 4096, whole);
    for (size_t piece = 1; piece < 100; piece += 7) {
        memset(samples, 0, sizeof samples);
        if (len == 0 || encode(&plan, count, piece, bytes) != len || memcmp(bytes, whole, len) != 0 ||
            decode(bytes, len, piece) != count || memcmp(samples, original, count * sizeof samples[0]) != 0) {
            return 0;
        }
    }
    printf("rows of %lu: %lu samples, %lu bytes\n", (unsigned long)plan.width, (unsigned long)count,
           (unsigned long)len);
    return 1;
}

/* Cut streams are truncated, damaged ones decode or are at fault, and both end. */
static int damaged_rows(void)
{
    wavelift_row_plan plan = plan_of(SLICE);
    size_t count = wavelift_samples_len(&SLICE->plan), len;
    golden_samples(SLICE, original);
    len = encode(&plan, count, 4096, whole);
    for (size_t cut = 0; cut < len; cut++) {
        if (decode(whole, cut, 4096) != 0) {
            return 0;
        }
    }
    for (size_t bit = 0; bit < 8 * len; bit++) {
        memcpy(bytes, whole, len);
        bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
        (void)decode(bytes, len, 4096);
    }
    return len > 0;
}

/* What cannot begin, and calls for what did not. */
static int refused_rows(void)
{
    wavelift_row_plan plan = plan_of(SLICE), deep = plan;
    size_t enough = wavelift_row_encoder_memory_len(&plan);
    wavelift_step step;
    deep.levels = 32;
    memset(&encoder, 0x5A, sizeof encoder);
    return wavelift_row_encoder_finish(&encoder) == WAVELIFT_NOT_BEGUN &&
           wavelift_row_encoder_begin(&encoder, &codec, &deep, memory, MEMORY_LEN) == WAVELIFT_TOO_MANY_LEVELS &&
           wavelift_row_encoder_begin(&encoder, &codec, &plan, memory, enough) == WAVELIFT_OK &&
           wavelift_row_encoder_step(&encoder, original, 1, bytes, 0, &step) == WAVELIFT_OK &&
           wavelift_row_encoder_step(&encoder, memory, 1, bytes, 1, &step) == WAVELIFT_OVERLAP &&
           wavelift_row_encoder_step(&encoder, original, 1, (uint8_t *)&codec, 1, &step) == WAVELIFT_OVERLAP &&
           wavelift_row_encoder_step(&encoder, original, 1, bytes, 64, NULL) == WAVELIFT_NULL_POINTER &&
           wavelift_row_encoder_step(&encoder, original, 1, bytes, 64, &step) == WAVELIFT_OK &&
           wavelift_row_encoder_finish(&encoder) == WAVELIFT_UNFINISHED_ROW &&
           wavelift_row_encoder_begin(&encoder, &codec, &plan, memory, enough - 1) == WAVELIFT_SCRATCH_TOO_SHORT &&
           wavelift_row_encoder_finish(&encoder) == WAVELIFT_NOT_BEGUN;
}

int rows_check(int *tests)
{
    int pieces = rows_in_pieces(), damaged = damaged_rows(), refused = refused_rows();
    printf("%-15s %s\n", "rows in pieces", pieces ? "right" : "WRONG");
    printf("%-15s %s\n", "damaged rows", damaged ? "right" : "WRONG");
    printf("%-15s %s\n", "refused rows", refused ? "right" : "WRONG");
    *tests += 3;
    return pieces + damaged + refused;
}
