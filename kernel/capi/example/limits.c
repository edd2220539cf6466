#include "limits.h"

#include <stdio.h>
#include <string.h>

#include "golden.h"

/* Memory to lend, with guards around it that begin and end as a mark. */
#define GUARD 16
#define MARK 0xA5
#define BRICK (&goldens[0])

static wavelift_codec codec;
static int32_t samples_memory[GOLDEN_MAX_SAMPLES + 2 * GUARD], scratch_memory[2048 + 2 * GUARD];
static uint8_t out_memory[GOLDEN_MAX_BYTES + 2 * GUARD];

static int32_t *const samples = samples_memory + GUARD, *const scratch = scratch_memory + GUARD;
static uint8_t *const out = out_memory + GUARD;

static void mark_all(void)
{
    memset(samples_memory, MARK, sizeof samples_memory);
    memset(scratch_memory, MARK, sizeof scratch_memory);
    memset(out_memory, MARK, sizeof out_memory);
}

/* Whether nothing was written before `memory + GUARD` and from `memory + GUARD + len` on, in bytes. */
static int is_whole(const void *memory, size_t size, size_t guard, size_t len)
{
    const uint8_t *at = memory;
    for (size_t i = 0; i < size; i++) {
        if (at[i] != MARK && (i < guard || i >= guard + len)) {
            return 0;
        }
    }
    return 1;
}

static int all_whole(size_t samples_len, size_t scratch_len, size_t out_len)
{
    return is_whole(samples_memory, sizeof samples_memory, 4 * GUARD, 4 * samples_len) &&
           is_whole(scratch_memory, sizeof scratch_memory, 4 * GUARD, 4 * scratch_len) &&
           is_whole(out_memory, sizeof out_memory, GUARD, out_len);
}

static wavelift_lent lent_for(const golden *golden)
{
    wavelift_lent lent = {samples, wavelift_samples_len(&golden->plan), scratch, wavelift_scratch_len(&golden->plan)};
    return lent;
}

/* Every output that is too short is full, and nothing is written behind it. */
static int short_outputs(void)
{
    wavelift_lent lent = lent_for(BRICK);
    size_t enough = golden_len(BRICK);
    for (size_t room = 0; room <= enough; room += room + 40 < enough ? 23 : 1) {
        size_t len = room;
        mark_all();
        golden_samples(BRICK, samples);
        wavelift_error error = wavelift_encode(&codec, NULL, &BRICK->plan, &lent, out, &len);
        if (error != (room < enough ? WAVELIFT_OUTPUT_FULL : WAVELIFT_OK) || len != room) {
            return 0;
        }
        if (!all_whole(lent.samples_len, lent.scratch_len, room)) {
            return 0;
        }
    }
    return 1;
}

/* Samples and scratch of any other length are refused, both ways. */
static int wrong_lengths(void)
{
    wavelift_lent right = lent_for(BRICK);
    for (int i = 0; i < 4; i++) {
        wavelift_lent lent = right;
        lent.samples_len = i == 0 ? 0 : right.samples_len + (size_t)i - 2;
        lent.scratch_len -= i == 2;
        wavelift_error expected = i == 2 ? WAVELIFT_SCRATCH_TOO_SHORT : WAVELIFT_SAMPLES_LENGTH;
        size_t len = GOLDEN_MAX_BYTES;
        mark_all();
        if (wavelift_encode(&codec, NULL, &BRICK->plan, &lent, out, &len) != expected ||
            wavelift_decode(&codec, BRICK->bytes, golden_len(BRICK), 0, &lent) != expected || !all_whole(0, 0, 0)) {
            return 0;
        }
    }
    return 1;
}

/* Every beginning of a codestream is truncated, and one byte more is too much. */
static int cut_bytes(void)
{
    wavelift_lent lent = lent_for(BRICK);
    size_t whole = golden_len(BRICK);
    for (size_t len = 0; len < whole; len++) {
        if (wavelift_decode(&codec, BRICK->bytes, len, 0, &lent) != WAVELIFT_TRUNCATED) {
            return 0;
        }
    }
    memcpy(out, BRICK->bytes, whole);
    out[whole] = 0;
    return wavelift_decode(&codec, out, whole + 1, 0, &lent) == WAVELIFT_TRAILING_BYTES;
}

/* Every codestream with a bit flipped decodes or is at fault itself, within what is lent. */
static int flipped_bits(void)
{
    wavelift_lent lent = lent_for(BRICK);
    size_t len = golden_len(BRICK);
    mark_all();
    for (size_t bit = 0; bit < 8 * len; bit++) {
        wavelift_level level;
        memcpy(out, BRICK->bytes, len);
        out[bit / 8] ^= (uint8_t)(1u << bit % 8);
        wavelift_error error = wavelift_header_level(out, len, 0, &level);
        if (error == WAVELIFT_OK && level.samples_len == lent.samples_len && level.scratch_len <= lent.scratch_len) {
            error = wavelift_decode(&codec, out, len, 0, &lent);
        }
        if (error >= WAVELIFT_NULL_POINTER && error != WAVELIFT_NEEDS_DENSE && error != WAVELIFT_OTHER_CODEC) {
            return 0;
        }
    }
    return all_whole(lent.samples_len, lent.scratch_len, len);
}

/* Pointers that a call can see are wrong. */
static int wrong_pointers(void)
{
    wavelift_lent lent = lent_for(BRICK), null = lent, odd = lent, twice = lent;
    const wavelift_plan *plan = &BRICK->plan;
    size_t len = GOLDEN_MAX_BYTES;
    null.scratch = NULL;
    odd.samples = (int32_t *)(void *)((uint8_t *)samples + 1);
    twice.scratch = samples + 1;
    return wavelift_encode(NULL, NULL, plan, &lent, out, &len) == WAVELIFT_NULL_POINTER &&
           wavelift_encode(&codec, NULL, NULL, &lent, out, &len) == WAVELIFT_NULL_POINTER &&
           wavelift_encode(&codec, NULL, plan, NULL, out, &len) == WAVELIFT_NULL_POINTER &&
           wavelift_encode(&codec, NULL, plan, &lent, NULL, &len) == WAVELIFT_NULL_POINTER &&
           wavelift_encode(&codec, NULL, plan, &lent, out, NULL) == WAVELIFT_NULL_POINTER &&
           wavelift_encode(&codec, NULL, plan, &null, out, &len) == WAVELIFT_NULL_POINTER &&
           wavelift_encode(&codec, NULL, plan, &odd, out, &len) == WAVELIFT_MISALIGNED &&
           wavelift_encode(&codec, NULL, plan, &twice, out, &len) == WAVELIFT_OVERLAP &&
           wavelift_encode(&codec, NULL, plan, &lent, (uint8_t *)&codec, &len) == WAVELIFT_OVERLAP &&
           wavelift_decode(&codec, (uint8_t *)samples, 64, 0, &lent) == WAVELIFT_OVERLAP &&
           wavelift_decode(&codec, NULL, 0, 0, &lent) == WAVELIFT_TRUNCATED && wavelift_scratch_len(NULL) == 0;
}

/* Plans that are none, and codestreams for another call. */
static int wrong_plans(void)
{
    wavelift_plan plan = BRICK->plan, deep = plan, other = plan, empty = plan;
    const golden *dense = &goldens[3], *near = &goldens[4];
    wavelift_lent lent = lent_for(BRICK);
    deep.levels = (uint8_t)(wavelift_max_levels(11, 13, 14) + 1);
    other.wavelet = 7;
    empty.extent[1] = 0;
    return wavelift_plan_check(&plan) == WAVELIFT_OK && wavelift_plan_check(&deep) == WAVELIFT_TOO_MANY_LEVELS &&
           wavelift_plan_check(&other) == WAVELIFT_UNKNOWN_WAVELET &&
           wavelift_plan_check(&empty) == WAVELIFT_ZERO_EXTENT && wavelift_samples_len(&empty) == 0 &&
           wavelift_decode(&codec, dense->bytes, golden_len(dense), 0, &lent) == WAVELIFT_NEEDS_DENSE &&
           wavelift_decode(&codec, near->bytes, golden_len(near), 0, &lent) == WAVELIFT_OTHER_CODEC &&
           wavelift_decode(&codec, BRICK->bytes, golden_len(BRICK), 9, &lent) == WAVELIFT_LEVEL_OUT_OF_RANGE &&
           strcmp(wavelift_error_name(WAVELIFT_OVERLAP), "WAVELIFT_OVERLAP") == 0 &&
           strcmp(wavelift_error_name(-1), "not an error of wavelift") == 0;
}

typedef struct test {
    const char *name;
    int (*run)(void);
} test;

int limits_check(int *tests)
{
    static const test all[] = {
        {"short outputs", short_outputs}, {"wrong lengths", wrong_lengths},   {"cut bytes", cut_bytes},
        {"flipped bits", flipped_bits},   {"wrong pointers", wrong_pointers}, {"wrong plans", wrong_plans},
    };
    int count = (int)(sizeof all / sizeof all[0]), passed = 0;
    for (int i = 0; i < count; i++) {
        int right = all[i].run();
        printf("%-15s %s\n", all[i].name, right ? "right" : "WRONG");
        passed += right;
    }
    *tests += count;
    return passed;
}
