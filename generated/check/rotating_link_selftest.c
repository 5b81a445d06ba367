/*
 * Generated: do not edit. Belongs to rotating_link.c (program 09c928c4).
 * Self-test: rotating_link.c gives the same bits as the emitted NumPy module, with any compiler and on any board.
 *
 *   cc -std=c99 -O2 -I.. rotating_link_selftest.c ../rotating_link.c -lm     single precision: -DECCENTRIC_REAL=float
 *
 * Prints "ok" and returns 0, or prints the first deviation and returns 1. -DSECTIONS=1 is for slow boards.
 * If only last digits differ, the compiler ignores FP_CONTRACT and fuses products and sums: turn that off.
 */
#include "rotating_link.h"

#if !defined(__cplusplus) && (!defined(__STDC_VERSION__) || (__STDC_VERSION__ < 199901L))
#error "C99 or later is required: compile with -std=c99"
#else /* up to the end of the file, so that this is the only error */

#ifdef ECCENTRIC_LIBM
#error "these are the bits of the polynomials, not of libm: compile without ECCENTRIC_LIBM"
#endif

#include <stdint.h>
#include <stdio.h>
#include <string.h>

typedef ECCENTRIC_REAL real;
#include "rotating_link_vectors.h"

/* The bits of a value; all NaNs get the same pattern, since their sign and payload depend on the processor. */
static bits bits_of(real value)
{
    bits word = NOT_A_NUMBER;
    if (value == value) { memcpy(&word, &value, sizeof word); }
    return word;
}

/* Print a line with a value: its bits and six digits, as integers, since small C libraries have no %g. */
static void print_value(const char *what, real value)
{
    const uint64_t word = bits_of(value);
    printf("  %s 0x", what);
    if (sizeof(real) > 4u) { printf("%08lx", (unsigned long)(word >> 32)); }
    printf("%08lx ", (unsigned long)(word & 0xffffffffu));
    if (value != value) {
        printf("nan\n");
    } else if (value - value != 0) {
        printf("%s\n", (value > 0) ? "inf" : "-inf");
    } else {
        real size = (value < 0) ? -value : value;
        int exponent = 0;
        for (; size >= 10; ++exponent) { size /= 10; }
        for (; size > 0 && size < 1; --exponent) { size *= 10; }
        unsigned long digits = (unsigned long)(size * 100000 + SCALE_HALF);
        if (digits > 999999u) {
            digits /= 10u;
            ++exponent;
        }
        printf("%s%lu.%05lue%d\n", (value < 0) ? "-" : "", digits / 100000u, digits % 100000u, exponent);
    }
}

/* Print a deviation: value j of a function, with its inputs. */
static void print_deviation(const char *ending, unsigned function, unsigned j, const real *x, real came, real required)
{
    printf("rotating_link: %s%s, value %u\n", functions[function], ending, j);
    for (unsigned k = 0; k < INPUTS; ++k) {
        if (((taken[function] >> k) & 1u) != 0u) { print_value(inputs[k], x[k]); }
    }
    print_value("came", came);
    print_value("required", required);
}

#ifndef SECTIONS
#define SECTIONS 10u /* of 20000 generated samples each */
#endif

static rotating_link_coefficients c;

static void evaluate(unsigned function, const real *x, real *out)
{
    (void)x; /* in case no function has an input */
    switch (function) {
    case 0: out[0] = rotating_link_acceleration(x[0], x[1], x[4], x[5], &c); break;
    case 1: rotating_link_breakaway_torque(x[0], out, &c); break;
    case 2: out[0] = rotating_link_current(x[0], x[1], x[4], &c); break;
    case 3: out[0] = rotating_link_electrical_residual(x[1], x[2], x[3], &c); break;
    case 4: rotating_link_friction_budget(x[0], x[1], x[4], out, &c); break;
    case 5: rotating_link_friction_coefficients(out, &c); break;
    case 6: rotating_link_friction_step(x[0], x[1], x[4], x[5], x[6], out, &c); break;
    case 7: out[0] = rotating_link_friction_torque(x[0], x[1], x[4], &c); break;
    case 8: rotating_link_friction_torque_gradient(x[0], x[1], x[4], out, &c); break;
    case 9: rotating_link_friction_torque_jacobian(x[0], x[1], x[4], out, &c); break;
    case 10: rotating_link_friction_torque_with_gradient(x[0], x[1], x[4], out, &c); break;
    case 11: out[0] = rotating_link_gravity_torque(x[0], &c); break;
    case 12: out[0] = rotating_link_mechanical_friction_torque(x[0], x[1], x[4], &c); break;
    case 13: out[0] = rotating_link_mechanical_residual(x[0], x[1], x[2], x[4], &c); break;
    case 14: out[0] = rotating_link_normal_force(x[0], x[1], x[4], &c); break;
    case 15: rotating_link_regressor(x[0], x[1], x[4], out, &c); break;
    case 16: out[0] = rotating_link_voltage(x[0], x[1], x[4], &c); break;
    default: break;
    }
}

/* The constant coefficients, as this compiler reads their decimals and this linker places them. */
static int default_holds(void)
{
    real came[COEFFICIENTS], required[COEFFICIENTS];
    memcpy(came, &rotating_link_default, sizeof came);
    memcpy(required, default_bits, sizeof required);
    for (unsigned k = 0; k < COEFFICIENTS; ++k) {
        if (bits_of(came[k]) != default_bits[k]) {
            printf("rotating_link: rotating_link_default.%s\n", coefficients[k]);
            print_value("came", came[k]);
            print_value("required", required[k]);
            return 0;
        }
    }
    return 1;
}

static int vectors_hold(void)
{
    for (unsigned row = 0; row < VECTORS; ++row) {
        real x[NUMBERS], out[LARGEST_WIDTH];
        memcpy(x, vectors[row], sizeof x);
        const real *required = x + INPUTS;
        for (unsigned f = 0; f < FUNCTIONS; ++f) {
            evaluate(f, x, out);
            for (unsigned j = 0; j < widths[f]; ++j) {
                if (bits_of(out[j]) != bits_of(required[j])) {
                    print_deviation("", f, j, x, out[j], required[j]);
                    return 0;
                }
            }
            required += widths[f];
        }
    }
    return 1;
}

/* A pseudo-random word from a counter: integers only, so that every platform gets the same inputs. */
static uint32_t scrambled(uint32_t x)
{
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}

/* Input k of sample n: around a centre, or (span 0) arbitrary bits. Spans are powers of two: products are exact. */
static real generated(uint32_t n, unsigned k)
{
    const uint32_t high = scrambled(n * 16u + 2u * k), low = scrambled(n * 16u + 2u * k + 1u);
    const unsigned kind = (unsigned)(n % KINDS);
    if (spans[kind][k] == 0) {
        const bits word = (bits)(((uint64_t)low << 32) | high);
        real value;
        memcpy(&value, &word, sizeof value);
        return value;
    }
    const real sum = (real)high * SCALE + (real)low * SCALE * SCALE; /* 0 to 1 */
    return centres[kind][k] + (sum - SCALE_HALF) * spans[kind][k];
}

/* Compare the digest of each section and function with the expected one. */
static int stream_holds(void)
{
    for (uint32_t section = 0; section < SECTIONS; ++section) {
        uint32_t digest[FUNCTIONS] = {0};
        for (uint32_t n = section * 20000u; n < (section + 1u) * 20000u; ++n) {
            real x[INPUTS], out[LARGEST_WIDTH];
            for (unsigned k = 0; k < INPUTS; ++k) { x[k] = generated(n, k); }
            for (unsigned f = 0; f < FUNCTIONS; ++f) {
                evaluate(f, x, out);
                for (unsigned j = 0; j < widths[f]; ++j) {
                    const uint64_t word = bits_of(out[j]);
                    const uint32_t factor = scrambled(n * 16u + j) | 1u;
                    digest[f] += (uint32_t)word * factor + (uint32_t)(word >> 32) * (factor + 2u);
                }
            }
        }
        for (unsigned f = 0; f < FUNCTIONS; ++f) {
            if (digest[f] != digests[section][f]) {
                printf("rotating_link: %s, generated samples %lu to %lu: digest 0x%08lx came, 0x%08lx required\n",
                       functions[f], (unsigned long)(section * 20000u), (unsigned long)((section + 1u) * 20000u - 1u),
                       (unsigned long)digest[f], (unsigned long)digests[section][f]);
                return 0;
            }
        }
    }
    return 1;
}

static real x_n[INPUTS][ARRAY], out_n[ARRAY * LARGEST_WIDTH];

static void evaluate_array(unsigned function)
{
    switch (function) {
    case 0: rotating_link_acceleration_n(ARRAY, x_n[0], x_n[1], x_n[4], x_n[5], out_n, &c); break;
    case 1: rotating_link_breakaway_torque_n(ARRAY, x_n[0], out_n, &c); break;
    case 2: rotating_link_current_n(ARRAY, x_n[0], x_n[1], x_n[4], out_n, &c); break;
    case 3: rotating_link_electrical_residual_n(ARRAY, x_n[1], x_n[2], x_n[3], out_n, &c); break;
    case 4: rotating_link_friction_budget_n(ARRAY, x_n[0], x_n[1], x_n[4], out_n, &c); break;
    case 6: rotating_link_friction_step_n(ARRAY, x_n[0], x_n[1], x_n[4], x_n[5], x_n[6], out_n, &c); break;
    case 7: rotating_link_friction_torque_n(ARRAY, x_n[0], x_n[1], x_n[4], out_n, &c); break;
    case 8: rotating_link_friction_torque_gradient_n(ARRAY, x_n[0], x_n[1], x_n[4], out_n, &c); break;
    case 9: rotating_link_friction_torque_jacobian_n(ARRAY, x_n[0], x_n[1], x_n[4], out_n, &c); break;
    case 10: rotating_link_friction_torque_with_gradient_n(ARRAY, x_n[0], x_n[1], x_n[4], out_n, &c); break;
    case 11: rotating_link_gravity_torque_n(ARRAY, x_n[0], out_n, &c); break;
    case 12: rotating_link_mechanical_friction_torque_n(ARRAY, x_n[0], x_n[1], x_n[4], out_n, &c); break;
    case 13: rotating_link_mechanical_residual_n(ARRAY, x_n[0], x_n[1], x_n[2], x_n[4], out_n, &c); break;
    case 14: rotating_link_normal_force_n(ARRAY, x_n[0], x_n[1], x_n[4], out_n, &c); break;
    case 15: rotating_link_regressor_n(ARRAY, x_n[0], x_n[1], x_n[4], out_n, &c); break;
    case 16: rotating_link_voltage_n(ARRAY, x_n[0], x_n[1], x_n[4], out_n, &c); break;
    default: break;
    }
}

/* Compare array functions with single calls, bit by bit: first on the vectors, then on generated samples. */
static int arrays_hold(void)
{
    for (uint32_t first = 0; first < SECTIONS * ARRAYS * ARRAY; first += ARRAY) {
        for (uint32_t n = 0; n < ARRAY; ++n) {
            for (unsigned k = 0; k < INPUTS; ++k) {
                x_n[k][n] = generated(first + n, k);
                if (first + n < VECTORS) { memcpy(&x_n[k][n], &vectors[first + n][k], sizeof(real)); }
            }
        }
        for (unsigned f = 0; f < FUNCTIONS; ++f) {
            evaluate_array(f);
            for (uint32_t n = 0; taken[f] != 0u && n < ARRAY; ++n) {
                real x[INPUTS], out[LARGEST_WIDTH];
                for (unsigned k = 0; k < INPUTS; ++k) { x[k] = x_n[k][n]; }
                evaluate(f, x, out);
                for (unsigned j = 0; j < widths[f]; ++j) {
                    const real came = out_n[n * widths[f] + j];
                    if (bits_of(came) != bits_of(out[j])) {
                        print_deviation("_n", f, j, x, came, out[j]);
                        return 0;
                    }
                }
            }
        }
    }
    return 1;
}

int main(void)
{
    rotating_link_parameters p = rotating_link_default_parameters;
    p.J_m = 0.0002;
    p.J_l = 0.04;
    p.phi = 0.6;
    if (rotating_link_prepare(&p, &c) != 0) {
        return 1;
    }
    if (!default_holds() || !vectors_hold() || !stream_holds() || !arrays_hold()) {
        return 1;
    }
    printf("rotating_link: ok, %u vectors and %lu generated samples of %u functions, %u-bit reals\n", VECTORS,
           (unsigned long)SECTIONS * 20000, FUNCTIONS, (unsigned)sizeof(real) * 8u);
    return 0;
}

#endif
