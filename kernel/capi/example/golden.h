/* Golden codestreams, and the samples that they hold. */
#ifndef GOLDEN_H
#define GOLDEN_H

#include "wavelift.h"

/* How a codestream was encoded. */
typedef enum golden_effort { FAST, TRAINED, DENSE, NEAR } golden_effort;

typedef struct golden {
    const char *name;
    wavelift_plan plan;
    golden_effort effort;
    uint32_t slack;
    /* Bytes of a larger brick of unsigned 8-bit samples, its samples along x and y, and where in it the plan begins. */
    const uint8_t *data;
    size_t data_sides[2];
    size_t corner[3];
    /* The codestream, and its end. */
    const uint8_t *bytes, *end;
} golden;

#define GOLDEN_COUNT 5
/* Samples of the largest, and bytes that suffice for each. */
#define GOLDEN_MAX_SAMPLES 3360
#define GOLDEN_MAX_BYTES (GOLDEN_MAX_SAMPLES + 26)
extern const golden goldens[GOLDEN_COUNT];

/* Writes the samples of a plan, x fastest. */
void golden_samples(const golden *golden, int32_t *samples);

/* Bytes of the codestream. */
size_t golden_len(const golden *golden);

#endif
