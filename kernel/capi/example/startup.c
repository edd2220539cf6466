/* What runs before main on a Cortex-M4F: the table of vectors, memory, and the floating-point unit. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* From the linker script. */
extern uint32_t stack_top;
extern uint8_t data_start, data_end, data_load, bss_start, bss_end;

/* From newlib's semihosting: opens standard output on the host. */
extern void initialise_monitor_handles(void);
extern int main(void);

#define CPACR (*(volatile uint32_t *)0xE000ED88)

void reset(void);

void reset(void)
{
    CPACR |= 0xFu << 20;
    memcpy(&data_start, &data_load, (size_t)(&data_end - &data_start));
    memset(&bss_start, 0, (size_t)(&bss_end - &bss_start));
    initialise_monitor_handles();
    exit(main());
}

/* Any fault ends the program as failed. */
static void fault(void)
{
    abort();
}

/* What C library start files provide, and this program does without. */
void _init(void) {}
void _fini(void) {}

typedef void (*handler)(void);

__attribute__((section(".vectors"), used)) static const struct {
    uint32_t *stack;
    handler handlers[15];
} vectors = {&stack_top, {reset, fault, fault, fault, fault, fault, 0, 0, 0, 0, fault, fault, 0, fault, fault}};
