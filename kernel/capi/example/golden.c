#include "golden.h"

/* In golden.S. */
extern const uint8_t rt_brick64[], rt_slice512[];
extern const uint8_t linear_brick_crop[], linear_brick_crop_end[];
extern const uint8_t duchaineau_brick_crop[], duchaineau_brick_crop_end[];
extern const uint8_t cubic_slice_crop[], cubic_slice_crop_end[];
extern const uint8_t dense_brick_crop[], dense_brick_crop_end[];
extern const uint8_t lattice_brick_crop[], lattice_brick_crop_end[];

#define BRICK64 rt_brick64, {64, 64}
#define SLICE512 rt_slice512, {512, 512}

const golden goldens[GOLDEN_COUNT] = {
    {"brick, fast", {{11, 13, 14}, WAVELIFT_LINEAR, 3, WAVELIFT_U8}, FAST, 0, BRICK64, {50, 40, 10},
     linear_brick_crop, linear_brick_crop_end},
    {"brick, trained", {{13, 11, 12}, WAVELIFT_DUCHAINEAU, 3, WAVELIFT_U8}, TRAINED, 0, BRICK64, {30, 30, 30},
     duchaineau_brick_crop, duchaineau_brick_crop_end},
    {"slice, trained", {{39, 33, 1}, WAVELIFT_CUBIC, 4, WAVELIFT_U8}, TRAINED, 0, SLICE512, {256, 100, 0},
     cubic_slice_crop, cubic_slice_crop_end},
    {"brick, dense", {{15, 14, 13}, WAVELIFT_NO_WAVELET, 0, WAVELIFT_U8}, DENSE, 0, BRICK64, {20, 10, 30},
     dense_brick_crop, dense_brick_crop_end},
    {"brick, near", {{16, 15, 14}, WAVELIFT_NO_WAVELET, 0, WAVELIFT_U8}, NEAR, 1, BRICK64, {20, 10, 30},
     lattice_brick_crop, lattice_brick_crop_end},
};

void golden_samples(const golden *golden, int32_t *samples)
{
    const uint32_t *extent = golden->plan.extent;
    for (size_t z = 0; z < extent[2]; z++) {
        for (size_t y = 0; y < extent[1]; y++) {
            size_t row = (golden->corner[2] + z) * golden->data_sides[1] + golden->corner[1] + y;
            const uint8_t *from = golden->data + row * golden->data_sides[0] + golden->corner[0];
            for (size_t x = 0; x < extent[0]; x++) {
                *samples++ = from[x];
            }
        }
    }
}

size_t golden_len(const golden *golden)
{
    return (size_t)(golden->end - golden->bytes);
}
