/* Random bodies and poses, and the printing of answers to the bit, for numbers.c and numbers.cpp. numbers.rs has the
 * same generator. */
#ifndef NUMBERS_H
#define NUMBERS_H

#include <colltrans.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CASES = 40, POINTS = 16, ROWS = 800 };

static uint64_t state = 1;

/* Returns a number from -1 to 1. */
static double next_number(void) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(state >> 11) * 0x1p-52 - 1.0;
}

static void next_vector(double *to) {
    for (int k = 0; k < 3; ++k) to[k] = next_number();
}

/* Writes a unit quaternion and a translation of at most `reach` in each coordinate. */
static void next_pose(double reach, double *xyzw, double *translation) {
    double square = 0;
    for (int k = 0; k < 4; ++k) {
        xyzw[k] = next_number() + (k == 3 ? 1.5 : 0.0);
        square += xyzw[k] * xyzw[k];
    }
    const double length = sqrt(square);
    for (int k = 0; k < 4; ++k) xyzw[k] /= length;
    for (int k = 0; k < 3; ++k) translation[k] = reach * next_number();
}

static void put(double number) {
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    if (number != number) {
        printf(" nan");
    } else {
        printf(" %016llx", (unsigned long long)bits);
    }
}

static void put_vector(const double *of) {
    for (int k = 0; k < 3; ++k) put(of[k]);
}

static void put_feature(colltrans_feature of) {
    printf(" %d", (int)of.kind);
    for (int k = 0; k < 3; ++k) printf(":%d", (int)of.vertices[k]);
}

static void put_cast(const char *name, const colltrans_cast_answer *of) {
    printf("%s %d", name, (int)of->outcome);
    put(of->distance);
    put(of->translation);
    put(of->translation_lower);
    put(of->translation_upper);
    put(of->exit);
    put(of->exit_lower);
    put(of->exit_upper);
    put(of->back);
    put(of->on);
    put(of->overlap);
    put(of->margin);
    put(of->rounding);
    put(of->tolerance);
    put(of->least_tolerance);
    put_vector(of->normal);
    put_vector(of->point_on_fixed);
    put_feature(of->moving_feature);
    put_feature(of->fixed_feature);
    printf("\n");
}

static void put_distance(const char *name, const colltrans_distance_answer *of) {
    printf("%s %d", name, (int)of->outcome);
    put(of->lower);
    put(of->upper);
    put_vector(of->normal);
    put_vector(of->point_on_moving);
    put_vector(of->point_on_fixed);
    put_feature(of->moving_feature);
    put_feature(of->fixed_feature);
    printf("\n");
}

static void put_depth(const char *name, const colltrans_depth_answer *of) {
    printf("%s %d", name, (int)of->outcome);
    put(of->lower);
    put(of->upper);
    put(of->least_tolerance);
    put_vector(of->direction);
    printf("\n");
}

static void put_motion(const char *name, const colltrans_motion_answer *of) {
    printf("%s %d", name, (int)of->outcome);
    put(of->time_lower);
    put(of->time_upper);
    put(of->tolerance);
    put(of->least_tolerance);
    put_vector(of->normal);
    put_vector(of->point);
    put_feature(of->moving_feature);
    put_feature(of->fixed_feature);
    printf("\n");
}

#endif
