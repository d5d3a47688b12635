/* Measures a function of a robot on an emulated (QEMU) microcontroller: instructions of a call, bytes of stack, and the result, whose
 * sum is compared with that of the host. `ROBOT` is the prefix, `MEASURED` the number of the function; without it nothing is measured. */
#include <stdint.h>

#define JOINED(a, b) a##b
#define NAMED(a, b) JOINED(a, b)
#define FUNCTION(name) NAMED(ROBOT, name)
#include HEADER

enum { CALLS = 100, PAINTED = 16384 };

/* Only the measured function uses all of them. */
float q[NQ], v[NV], a[NV], first[NV * NV], second[NV * NV], third[NV * NV], start[NQ];

#ifndef MEASURED
#define MEASURED 0
#endif
#if MEASURED == 1
#define RESULT NV
static const char name[] = "inverse_dynamics";
static void call(void) {
    FUNCTION(_inverse_dynamics)(q, v, a, first);
}
#elif MEASURED == 2
#define RESULT NV
static const char name[] = "forward_dynamics";
static void call(void) {
    FUNCTION(_forward_dynamics)(q, v, a, first);
}
#elif MEASURED == 3
#define RESULT NV * NV
static const char name[] = "mass_matrix";
static void call(void) {
    FUNCTION(_mass_matrix)(q, first);
}
#elif MEASURED == 4
#define RESULT NV * NV
static const char name[] = "inverse_dynamics_derivatives";
static void call(void) {
    FUNCTION(_inverse_dynamics_derivatives)(q, v, a, first, second);
}
#elif MEASURED == 5
#define RESULT NV * NV
static const char name[] = "forward_dynamics_derivatives";
static void call(void) {
    FUNCTION(_forward_dynamics_derivatives)(q, v, a, first, second, third);
}
#else
#define RESULT 1
static const char name[] = "nothing";
static void call(void) {
    first[0] = q[0];
}
#endif

static void begin(void) {
    FUNCTION(_neutral)(start);
    for (int k = 0; k < NV; ++k) {
        v[k] = 0.1f * (float)(k % 7) - 0.2f;
        a[k] = 0.3f - 0.05f * (float)(k % 5);
    }
    FUNCTION(_integrate)(start, v, q);
}

static float sum(void) {
    float all = 0.0f;
    for (int k = 0; k < RESULT; ++k) {
        all += first[k];
    }
    return all;
}

#ifdef HOST
#include <stdio.h>
int main(void) {
    begin();
    call();
    printf("%s 0 0 %.6g\n", name, (double)sum());
    return 0;
}
#else
static void semihosting(uintptr_t operation, uintptr_t argument) {
#ifdef __riscv
    register uintptr_t a0 __asm__("a0") = operation;
    register uintptr_t a1 __asm__("a1") = argument;
    __asm__ volatile(".balign 16\n.option push\n.option norvc\nslli x0, x0, 0x1f\nebreak\nsrai x0, x0, 7\n.option pop"
                     : "+r"(a0) : "r"(a1) : "memory");
#else
    register uintptr_t r0 __asm__("r0") = operation;
    register uintptr_t r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
#endif
}

static void put(char c) {
    semihosting(3, (uintptr_t)&c);
}

static void put_text(const char *text) {
    while (*text) {
        put(*text++);
    }
}

static void put_number(int32_t number) {
    char digits[12];
    int count = 0;
    uint32_t rest = number < 0 ? (uint32_t)(-number) : (uint32_t)number;
    if (number < 0) {
        put('-');
    }
    do {
        digits[count++] = (char)('0' + rest % 10u);
        rest /= 10u;
    } while (rest);
    while (count) {
        put(digits[--count]);
    }
}

/* Number of executed instructions, by QEMU's `-icount shift=0`. */
#ifdef __riscv
static uint32_t now(void) {
    uint32_t count;
    __asm__ volatile("csrr %0, minstret" : "=r"(count));
    return count;
}
static uint32_t elapsed(uint32_t from, uint32_t to) {
    return to - from;
}
#else
/* SysTick counts down at 25 MHz, with a processor clock of 1 GHz. */
static volatile uint32_t *const systick = (volatile uint32_t *)0xe000e010u;
static uint32_t now(void) {
    return systick[2];
}
static uint32_t elapsed(uint32_t from, uint32_t to) {
    return ((from - to) & 0xffffffu) * 40u;
}
#endif

static void measure(void) {
    unsigned char *const here = (unsigned char *)__builtin_frame_address(0) - 256;
    for (int k = 0; k < PAINTED; ++k) {
        ((volatile unsigned char *)here)[-k] = 0xa5;
    }
    call();
    int deepest = PAINTED - 1;
    while (deepest > 0 && ((volatile unsigned char *)here)[-deepest] == 0xa5) {
        --deepest;
    }
    const uint32_t from = now();
    for (int k = 0; k < CALLS; ++k) {
        call();
    }
    const uint32_t to = now();
    put_text(name);
    put(' ');
    put_number((int32_t)(elapsed(from, to) / CALLS));
    put(' ');
    put_number(deepest ? deepest + 256 : 0);
    put(' ');
    /* Printed in thousandths, which the host's program compares. */
    put_number((int32_t)(sum() * 1000.0f));
    put('\n');
}

void start_here(void) {
#ifndef __riscv
    *(volatile uint32_t *)0xe000ed88u |= 0xfu << 20; /* enables the floating-point unit */
    __asm__ volatile("dsb\nisb");
    systick[1] = 0xffffffu;
    systick[2] = 0;
    systick[0] = 5;
#else
    __asm__ volatile("csrs mstatus, %0" : : "r"(0x2000)); /* enables the floating-point unit */
#endif
    begin();
    measure();
#ifdef __riscv
    static const uintptr_t done[2] = {0x20026, 0};
    semihosting(0x20, (uintptr_t)done);
    semihosting(0x18, (uintptr_t)done);
#else
    semihosting(0x18, 0x20026);
#endif
    for (;;) {
    }
}

#ifdef __riscv
__asm__(".section .vectors,\"ax\"\n.globl begin_here\nbegin_here:\n.option push\n.option norelax\nla sp, stack_top\n.option pop\ncall start_here\n");
#else
extern unsigned char stack_top[];
__attribute__((section(".vectors"), used)) static const void *const vectors[2] = {stack_top, (const void *)start_here};
#endif
#endif
