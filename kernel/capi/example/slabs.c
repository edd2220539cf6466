#include "slabs.h"

#include <stdio.h>
#include <string.h>

#include "golden.h"

#define SCRATCH_LEN 8192
#define SLICES 2 /* in a slab */

static wavelift_codec codec;
static wavelift_training training;
static wavelift_slab_encoder encoder;
static wavelift_slab_decoder decoder;
static int32_t slab[GOLDEN_MAX_SAMPLES], scratch[SCRATCH_LEN];
static int32_t original[GOLDEN_MAX_SAMPLES], samples[GOLDEN_MAX_SAMPLES];
static uint8_t room[GOLDEN_MAX_BYTES], whole[2 * GOLDEN_MAX_BYTES], bytes[2 * GOLDEN_MAX_BYTES];
static const wavelift_lent lent = {slab, GOLDEN_MAX_SAMPLES, scratch, SCRATCH_LEN};

/* The first golden brick. */
static const golden *brick(void)
{
    int i = 0;
    while (i + 1 < GOLDEN_COUNT && goldens[i].plan.extent[2] < 2) {
        i++;
    }
    return &goldens[i];
}

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Slabs of two slices of the brick, under one level. */
static wavelift_plan plan_of(const golden *golden)
{
    wavelift_plan plan = golden->plan;
    plan.extent[2] = SLICES;
    plan.wavelet = WAVELIFT_LINEAR;
    plan.levels = 1;
    return plan;
}

/* What encodes the slabs, and as what. */
static wavelift_error fast(const wavelift_plan *plan)
{
    return wavelift_slab_encoder_begin(&encoder, &codec, NULL, plan, &lent, room, sizeof room);
}

static wavelift_error trained(const wavelift_plan *plan)
{
    return wavelift_slab_encoder_begin(&encoder, &codec, &training, plan, &lent, room, sizeof room);
}

static wavelift_error light(const wavelift_plan *plan)
{
    return wavelift_slab_encoder_begin_light(&encoder, &codec, plan, &lent, room, sizeof room);
}

static wavelift_error tabled(const wavelift_plan *plan)
{
    return wavelift_slab_encoder_begin_tabled(&encoder, &codec, NULL, plan, &lent, room, sizeof room);
}

typedef wavelift_error begin(const wavelift_plan *plan);

static const struct {
    const char *name;
    begin *begin;
} efforts[] = {{"fast", fast}, {"trained", trained}, {"light", light}, {"tabled", tabled}};

/* Encodes `original`, that many samples and bytes at a time: the length of the stream in `into`, or 0. */
static size_t encode(begin *begin, const wavelift_plan *plan, size_t count, size_t piece, uint8_t *into)
{
    size_t taken = 0, given = 0;
    wavelift_step step = {0, 0, WAVELIFT_NEED_INPUT};
    if (begin(plan) != WAVELIFT_OK) {
        return 0;
    }
    while (step.status != WAVELIFT_DONE) {
        size_t input = least(piece, count - taken), left = least(piece, sizeof whole - given);
        if (left == 0 ||
            wavelift_slab_encoder_step(&encoder, original + taken, input, into + given, left, &step) != WAVELIFT_OK) {
            return 0;
        }
        taken += step.consumed;
        given += step.produced;
        if (step.status == WAVELIFT_NEED_INPUT && taken == count &&
            wavelift_slab_encoder_finish(&encoder) != WAVELIFT_OK) {
            return 0;
        }
    }
    return given;
}

/* Decodes to `samples`, that many bytes and samples at a time: how many there are, or 0 if not all is right. */
static size_t decode(const uint8_t *from, size_t len, size_t piece)
{
    wavelift_plan plan;
    size_t taken, given = 0;
    wavelift_step step = {0, 0, WAVELIFT_NEED_INPUT};
    if (wavelift_slab_header_parse(from, len, &plan, &taken) != WAVELIFT_OK ||
        wavelift_slab_decoder_begin(&decoder, &codec, &plan, &lent, room, sizeof room) != WAVELIFT_OK) {
        return 0;
    }
    while (step.status != WAVELIFT_DONE) {
        size_t input = least(piece, len - taken), left = least(piece, GOLDEN_MAX_SAMPLES - given);
        if (wavelift_slab_decoder_step(&decoder, from + taken, input, samples + given, left, &step) != WAVELIFT_OK) {
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

static int slabs_in_pieces(const char *name, begin *begin)
{
    wavelift_plan plan = plan_of(brick());
    size_t count = wavelift_samples_len(&brick()->plan);
    golden_samples(brick(), original);
    size_t len = encode(begin, &plan, count, 4096, whole);
    for (size_t piece = 1; piece < 100; piece += 7) {
        memset(samples, 0, sizeof samples);
        if (len == 0 || encode(begin, &plan, count, piece, bytes) != len || memcmp(bytes, whole, len) != 0 ||
            decode(bytes, len, piece) != count || memcmp(samples, original, count * sizeof samples[0]) != 0) {
            return 0;
        }
    }
    printf("%s slabs of %lu slices: %lu samples, %lu bytes\n", name, (unsigned long)plan.extent[2],
           (unsigned long)count, (unsigned long)len);
    return 1;
}

/* Of every effort. */
static int all_in_pieces(void)
{
    int right = 1;
    for (size_t i = 0; i < sizeof efforts / sizeof efforts[0]; i++) {
        right &= slabs_in_pieces(efforts[i].name, efforts[i].begin);
    }
    return right;
}

/* Cut streams are truncated, damaged ones decode or are at fault, and both end. */
static int damaged_slabs(void)
{
    wavelift_plan plan = plan_of(brick());
    golden_samples(brick(), original);
    size_t len = encode(light, &plan, wavelift_samples_len(&brick()->plan), 4096, whole);
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
static int refused_slabs(void)
{
    wavelift_plan plan = plan_of(brick()), deep = plan;
    wavelift_lent little = lent;
    wavelift_step step;
    deep.levels = 32;
    little.scratch_len = wavelift_scratch_len(&plan) - 1;
    memset(&encoder, 0x5A, sizeof encoder);
    return wavelift_slab_encoder_finish(&encoder) == WAVELIFT_NOT_BEGUN &&
           wavelift_slab_encoder_begin(&encoder, &codec, NULL, &deep, &lent, room, sizeof room) == WAVELIFT_TOO_MANY_LEVELS &&
           wavelift_slab_encoder_begin(&encoder, &codec, NULL, &plan, &lent, (uint8_t *)slab, sizeof slab) ==
               WAVELIFT_OVERLAP &&
           wavelift_slab_encoder_begin_light(&encoder, &codec, &plan, &lent, room, 1) == WAVELIFT_BYTES_TOO_SHORT &&
           trained(&plan) == WAVELIFT_OK &&
           wavelift_slab_encoder_step(&encoder, (int32_t *)&training, 1, bytes, 1, &step) == WAVELIFT_OVERLAP &&
           wavelift_slab_encoder_step(&encoder, slab, 1, bytes, 1, &step) == WAVELIFT_OVERLAP &&
           wavelift_slab_encoder_step(&encoder, original, 1, bytes, 64, NULL) == WAVELIFT_NULL_POINTER &&
           wavelift_slab_encoder_step(&encoder, original, 1, bytes, 64, &step) == WAVELIFT_OK &&
           wavelift_slab_encoder_finish(&encoder) == WAVELIFT_UNFINISHED_ROW &&
           wavelift_slab_encoder_begin(&encoder, &codec, NULL, &plan, &little, room, sizeof room) ==
               WAVELIFT_SCRATCH_TOO_SHORT &&
           wavelift_slab_encoder_finish(&encoder) == WAVELIFT_NOT_BEGUN;
}

int slabs_check(int *tests)
{
    int pieces = all_in_pieces(), damaged = damaged_slabs(), refused = refused_slabs();
    printf("%-15s %s\n", "slabs in pieces", pieces ? "right" : "WRONG");
    printf("%-15s %s\n", "damaged slabs", damaged ? "right" : "WRONG");
    printf("%-15s %s\n", "refused slabs", refused ? "right" : "WRONG");
    *tests += 3;
    return pieces + damaged + refused;
}
