/*
 * Encodes and decodes golden lines, slices and bricks on a host or a microcontroller, and compares every byte.
 *
 * All memory is static, and the same on both. The program prints what it did, and exits with 0 if all was right.
 */
#include <stdio.h>
#include <string.h>

#include "golden.h"
#include "limits.h"
#include "rows.h"
#include "slabs.h"
#include "tables.h"

/* Near-lossless encoding trains with up to 144,000 elements of scratch; the other calls take far less. */
#define SCRATCH_LEN (144000 + 3 * GOLDEN_MAX_SAMPLES)

static wavelift_codec codec;
static wavelift_training training;
static wavelift_dense dense;
static wavelift_lattice lattice;
static int32_t original[GOLDEN_MAX_SAMPLES], samples[GOLDEN_MAX_SAMPLES], scratch[SCRATCH_LEN];
static uint8_t bytes[GOLDEN_MAX_BYTES];

static wavelift_error encode(const golden *golden, const wavelift_lent *lent, size_t *len)
{
    const wavelift_plan *plan = &golden->plan;
    switch (golden->effort) {
    case FAST:
        return wavelift_encode(&codec, NULL, plan, lent, bytes, len);
    case TRAINED:
        return wavelift_encode(&codec, &training, plan, lent, bytes, len);
    case DENSE:
        return wavelift_encode_dense(&codec, &training, &dense, plan, lent, bytes, len);
    default:
        return wavelift_encode_near(&lattice, plan, golden->slack, lent, bytes, len);
    }
}

/* Decodes any codestream, by the call that its header asks for. */
static wavelift_error decode(const uint8_t *from, size_t len, uint8_t level, const wavelift_lent *lent)
{
    wavelift_header header;
    wavelift_error error = wavelift_header_parse(from, len, &header);
    if (error != WAVELIFT_OK) {
        return error;
    }
    switch (header.storage) {
    case WAVELIFT_LATTICE:
        return wavelift_decode_near(&lattice, from, len, level, lent);
    case WAVELIFT_DENSE:
        return wavelift_decode_dense(&codec, &dense, from, len, level, lent);
    default:
        return wavelift_decode(&codec, from, len, level, lent);
    }
}

/* Encodes, and compares with the golden bytes. */
static int encoded_right(const golden *golden)
{
    wavelift_lent lent = {samples, wavelift_samples_len(&golden->plan), scratch, SCRATCH_LEN};
    size_t len = sizeof bytes;
    golden_samples(golden, samples);
    wavelift_error error = encode(golden, &lent, &len);
    if (error != WAVELIFT_OK) {
        printf("%s: %s\n", golden->name, wavelift_error_name(error));
        return 0;
    }
    return len == golden_len(golden) && memcmp(bytes, golden->bytes, len) == 0;
}

/* Decodes the golden bytes, and compares with the samples. */
static int decoded_right(const golden *golden)
{
    size_t count = wavelift_samples_len(&golden->plan);
    wavelift_lent lent = {samples, count, scratch, SCRATCH_LEN};
    wavelift_error error = decode(golden->bytes, golden_len(golden), 0, &lent);
    if (error != WAVELIFT_OK) {
        printf("%s: %s\n", golden->name, wavelift_error_name(error));
        return 0;
    }
    golden_samples(golden, original);
    for (size_t i = 0; i < count; i++) {
        int32_t off = samples[i] - original[i];
        if (off > (int32_t)golden->slack || -off > (int32_t)golden->slack) {
            return 0;
        }
    }
    return 1;
}

/* Decodes each level from as few bytes as it takes, one byte fewer being too few, and returns the levels. */
static int levels_right(const golden *golden)
{
    wavelift_level found;
    uint8_t level = 0;
    while (wavelift_header_level(golden->bytes, golden_len(golden), level, &found) == WAVELIFT_OK) {
        wavelift_lent lent = {samples, found.samples_len, scratch, found.scratch_len};
        size_t len = (size_t)found.bytes;
        if (decode(golden->bytes, len, level, &lent) != WAVELIFT_OK ||
            decode(golden->bytes, len - 1, level, &lent) != WAVELIFT_TRUNCATED) {
            return 0;
        }
        level++;
    }
    return level;
}

static int check(const golden *golden)
{
    int encoded = encoded_right(golden), decoded = decoded_right(golden), levels = levels_right(golden);
    printf("%-15s %5lu samples, %4lu bytes, %d levels: %s\n", golden->name,
           (unsigned long)wavelift_samples_len(&golden->plan), (unsigned long)golden_len(golden), levels - 1,
           encoded && decoded && levels > 0 ? "right" : "WRONG");
    return encoded && decoded && levels > 0;
}

int main(void)
{
    int right = 0, tests = GOLDEN_COUNT;
    for (int i = 0; i < GOLDEN_COUNT; i++) {
        right += check(&goldens[i]);
    }
    right += tables_check(&tests) + rows_check(&tests) + slabs_check(&tests);
    right += limits_check(&tests);
    printf("states: codec %lu, training %lu, dense %lu, lattice %lu bytes\n", (unsigned long)sizeof codec,
           (unsigned long)sizeof training, (unsigned long)sizeof dense, (unsigned long)sizeof lattice);
    printf("%d passed, %d failed\n", right, tests - right);
    return right != tests;
}
