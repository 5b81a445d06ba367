/*
 * Generated: do not edit. Written beside rotating_link.c (program 23caece1).
 * Self-test of rotating_link.c: the bits that the emitted NumPy module gives, on any compiler and board.
 *
 *   cc -std=c99 -O2 -I.. rotating_link_selftest.c ../rotating_link.c -lm     single precision: -DECCENTRIC_REAL=float
 *
 * Prints "ok" and returns 0, or prints the first deviation and returns 1. -DSECTIONS=1 is for slow boards.
 * Where last digits differ, the compiler takes product and sum in one step: -std=c99 or -ffp-contract=off.
 */
#include "rotating_link.h"

#ifdef ECCENTRIC_LIBM
#error "these are the bits of the polynomials, not of libm: compile without ECCENTRIC_LIBM"
#endif

#include <stdint.h>
#include <stdio.h>
#include <string.h>

typedef ECCENTRIC_REAL real;
#include "rotating_link_vectors.h"

#ifndef SECTIONS
#define SECTIONS 10u /* of 20000 generated samples each */
#endif

static rotating_link_coefficients c;

static void evaluate(unsigned function, const real *x, real *out)
{
    switch (function) {
    case 0: out[0] = rotating_link_coulomb_torque(x[0], x[4], &c); break;
    case 1: out[0] = rotating_link_current(x[0], x[1], x[4], &c); break;
    case 2: out[0] = rotating_link_electrical_residual(x[1], x[2], x[3], &c); break;
    case 3: rotating_link_friction_coefficients(out, &c); break;
    case 4: out[0] = rotating_link_friction_torque(x[0], x[1], x[4], &c); break;
    case 5: rotating_link_friction_torque_gradient(x[0], x[1], x[4], out, &c); break;
    case 6: rotating_link_friction_torque_jacobian(x[0], x[1], x[4], out, &c); break;
    case 7: rotating_link_friction_torque_with_gradient(x[0], x[1], x[4], out, &c); break;
    case 8: out[0] = rotating_link_gravity_torque(x[0], &c); break;
    case 9: out[0] = rotating_link_mechanical_friction_torque(x[0], x[1], x[4], &c); break;
    case 10: out[0] = rotating_link_mechanical_residual(x[0], x[1], x[2], x[4], &c); break;
    case 11: out[0] = rotating_link_normal_force(x[0], x[1], x[4], &c); break;
    case 12: rotating_link_regressor(x[0], x[1], x[4], out, &c); break;
    case 13: out[0] = rotating_link_voltage(x[0], x[1], x[4], &c); break;
    default: break;
    }
}

/* The bits of a value; a NaN has one pattern, since its sign and payload are the processor's own. */
static bits bits_of(real value)
{
    bits word = NOT_A_NUMBER;
    if (value == value) { memcpy(&word, &value, sizeof word); }
    return word;
}

/* Reads a number of WIDTH hexadecimal digits and goes on behind it. */
static bits next_word(const char **text)
{
    bits word = 0;
    for (int digit = 0; digit < WIDTH; ++digit) {
        const char sign = *(*text)++;
        word = (bits)(word << 4) | (bits)((sign <= '9') ? (sign - '0') : (sign - 'a' + 10));
    }
    return word;
}

/* Counter to pseudo-random word: integers only, so that every platform sees the same inputs. */
static uint32_t scrambled(uint32_t x)
{
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}

/* Input k of sample n: around a centre, or (span 0) any bits. A span is a power of two: its product is exact. */
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

/* Digest of section s of each function against the expected one. */
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
                printf("rotating_link: %s deviates within generated samples %lu to %lu\n", functions[f],
                       (unsigned long)(section * 20000u), (unsigned long)((section + 1u) * 20000u - 1u));
                return 0;
            }
        }
    }
    return 1;
}

static void print_bits(const char *name, bits word)
{
    printf(" %s 0x%08lx%08lx", name, (unsigned long)((uint64_t)word >> 32),
           (unsigned long)(word & 0xffffffffu));
}

static int vectors_hold(void)
{
    for (unsigned row = 0; row < VECTORS; ++row) {
        const char *text = vectors[row];
        real x[INPUTS], out[LARGEST_WIDTH];
        for (unsigned k = 0; k < INPUTS; ++k) {
            const bits word = next_word(&text);
            memcpy(&x[k], &word, sizeof word);
        }
        for (unsigned f = 0; f < FUNCTIONS; ++f) {
            evaluate(f, x, out);
            for (unsigned j = 0; j < widths[f]; ++j) {
                const bits expected = next_word(&text);
                if (bits_of(out[j]) != expected) {
                    printf("rotating_link: vector %u, %s, value %u:\n", row, functions[f], j);
                    print_bits("expected", expected);
                    print_bits("got", bits_of(out[j]));
                    for (unsigned k = 0; k < INPUTS; ++k) { print_bits(inputs[k], bits_of(x[k])); }
                    printf("\n");
                    return 0;
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
    rotating_link_prepare(&p, &c);
    if (!vectors_hold() || !stream_holds()) { return 1; }
    printf("rotating_link: ok, %u vectors and %lu generated samples of %u functions, %u-bit reals\n", VECTORS,
           (unsigned long)SECTIONS * 20000, FUNCTIONS, 4u * WIDTH);
    return 0;
}
