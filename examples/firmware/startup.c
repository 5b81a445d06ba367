/* Start-up of a Cortex-M4F: vector table, memory, floating-point unit, main. */
#include "semihosting.h"

#include <stdint.h>

typedef void (*handler)(void);

/* Set by the linker script; only their addresses mean anything. */
extern uint32_t data_load[], data_start[], data_end[], bss_start[], bss_end[], stack_top[];

int main(void);
void Reset_Handler(void);
void Default_Handler(void);
void SysTick_Handler(void) __attribute__((weak, alias("Default_Handler")));

/* Coprocessor access control register; access to coprocessors 10 and 11 is access to the FPU. */
#define CPACR (*(volatile uint32_t *)0xE000ED88u)
#define CPACR_FPU (0xFu << 20)

/* What the core reads at reset: initial stack pointer, then the system exceptions. This board's interrupts
 * would follow; the example uses none. */
__attribute__((section(".vectors"), used)) static const struct {
    uint32_t *stack;
    handler exceptions[15];
} vectors = {
    stack_top,
    {
        Reset_Handler,
        Default_Handler, /* NMI */
        Default_Handler, /* hard fault */
        Default_Handler, /* memory management fault */
        Default_Handler, /* bus fault */
        Default_Handler, /* usage fault */
        0,
        0,
        0,
        0,
        Default_Handler, /* supervisor call */
        Default_Handler, /* debug monitor */
        0,
        Default_Handler, /* pending supervisor call */
        SysTick_Handler,
    },
};

void Reset_Handler(void)
{
    /* Before any code that the compiler may let use a floating-point register. */
    CPACR |= CPACR_FPU;
    __asm__ volatile("dsb\n\tisb" ::: "memory");

    const uint32_t *from = data_load;
    for (uint32_t *to = data_start; to != data_end; ++to) {
        *to = *from;
        ++from;
    }
    for (uint32_t *to = bss_start; to != bss_end; ++to) {
        *to = 0u;
    }
    semihosting_exit(main());
}

void Default_Handler(void)
{
    for (;;) {
    }
}
