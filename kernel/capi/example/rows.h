/* A slice as a stream of rows, both ways. */
#ifndef ROWS_H
#define ROWS_H

/* Runs all tests, adds their number to *tests, and returns how many passed. */
int rows_check(int *tests);

#endif
