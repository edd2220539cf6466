/* Slices and bricks with tables of frequencies, both ways. */
#ifndef TABLES_H
#define TABLES_H

/* Runs all tests, adds their number to *tests, and returns how many passed. */
int tables_check(int *tests);

#endif
