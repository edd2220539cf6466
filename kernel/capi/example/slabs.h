/* A brick as a stream of slabs, both ways. */
#ifndef SLABS_H
#define SLABS_H

/* Runs all tests, adds their number to *tests, and returns how many passed. */
int slabs_check(int *tests);

#endif
