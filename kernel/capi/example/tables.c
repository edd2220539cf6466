#include "tables.h"

#include <stdio.h>
#include <string.h>

#include "wavelift.h"

#define MAX_SAMPLES 16900
#define SCRATCH_LEN 4096

/* In golden.S. */
extern const uint8_t tabled_slice_odd[], tabled_slice_odd_end[];
extern const uint8_t wide_high_u32[], wide_high_u32_end[];

/* A golden codestream of samples that rise and fall in even steps. */
typedef struct ramp {
    const char *name;
    wavelift_plan plan;
    int trained;
    uint32_t start;
    int32_t step[3];
    const uint8_t *bytes, *end;
} ramp;

static const ramp ramps[] = {
    {"slice, tables", {{127, 131, 1}, WAVELIFT_NO_WAVELET, 0, WAVELIFT_I16}, 0, (uint32_t)-3000, {3, -2, 0},
     tabled_slice_odd, tabled_slice_odd_end},
    {"brick, tables", {{26, 25, 26}, WAVELIFT_NO_WAVELET, 0, WAVELIFT_U32}, 1, 4294900000u, {1, 5, 11},
     wide_high_u32, wide_high_u32_end},
};

static wavelift_codec codec;
static wavelift_training training;
static int32_t original[MAX_SAMPLES], samples[MAX_SAMPLES], scratch[SCRATCH_LEN];
static uint8_t bytes[4 * MAX_SAMPLES + 26];

static void fill(const ramp *ramp)
{
    const uint32_t *extent = ramp->plan.extent;
    int32_t *at = original;
    for (uint32_t z = 0; z < extent[2]; z++) {
        for (uint32_t y = 0; y < extent[1]; y++) {
            for (uint32_t x = 0; x < extent[0]; x++) {
                uint32_t rise = x * (uint32_t)ramp->step[0] + y * (uint32_t)ramp->step[1] + z * (uint32_t)ramp->step[2];
                *at++ = (int32_t)(ramp->start + rise);
            }
        }
    }
}

/* Encodes to the golden bytes, and decodes them to the samples. */
static int check(const ramp *ramp)
{
    size_t count = wavelift_samples_len(&ramp->plan), golden_len = (size_t)(ramp->end - ramp->bytes);
    size_t size = count * sizeof original[0], len = sizeof bytes;
    wavelift_lent lent = {samples, count, scratch, wavelift_scratch_len(&ramp->plan)};
    if (count > MAX_SAMPLES || lent.scratch_len > SCRATCH_LEN) {
        return 0;
    }
    fill(ramp);
    memcpy(samples, original, size);
    if (wavelift_encode_tabled(&codec, ramp->trained ? &training : NULL, &ramp->plan, &lent, bytes, &len) !=
            WAVELIFT_OK ||
        len != golden_len || memcmp(bytes, ramp->bytes, len) != 0) {
        return 0;
    }
    return wavelift_decode(&codec, bytes, len, 0, &lent) == WAVELIFT_OK && memcmp(samples, original, size) == 0;
}

int tables_check(int *tests)
{
    int right = 0;
    for (size_t i = 0; i < sizeof ramps / sizeof ramps[0]; i++) {
        int is_right = check(&ramps[i]);
        printf("%-15s %5lu samples, %4lu bytes: %s\n", ramps[i].name,
               (unsigned long)wavelift_samples_len(&ramps[i].plan), (unsigned long)(ramps[i].end - ramps[i].bytes),
               is_right ? "right" : "WRONG");
        right += is_right;
        ++*tests;
    }
    return right;
}
