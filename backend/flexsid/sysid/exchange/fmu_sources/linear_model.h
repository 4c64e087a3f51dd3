/* Linear model of an aircraft: [x'; y] = (M0 + sum of p[k] Mk) [x; u], with parameters p.

   data.h defines N_STATES, N_INPUTS, N_OUTPUTS, N_PARAMETERS, N_SLOPES, TOKEN, BASE (M0 by rows),
   SLOPES (entries of Mk) and START (parameters). Value references: 0 time, then states, their
   derivatives, inputs, outputs and parameters. */
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    int parameter, entry;
    double value;
} Slope;

#include "data.h"

#define N_ROWS (N_STATES + N_OUTPUTS)
#define N_COLUMNS (N_STATES + N_INPUTS)
#define FIRST_STATE 1
#define FIRST_RATE (FIRST_STATE + N_STATES)
#define FIRST_INPUT (FIRST_RATE + N_STATES)
#define FIRST_OUTPUT (FIRST_INPUT + N_INPUTS)
#define FIRST_PARAMETER (FIRST_OUTPUT + N_OUTPUTS)
#define N_VARIABLES (FIRST_PARAMETER + N_PARAMETERS)

#if defined _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef struct {
    double time;
    double given[N_COLUMNS]; /* states, then inputs */
    double parameters[N_PARAMETERS];
    double matrix[N_ROWS * N_COLUMNS];
} Model;

static void assemble(Model *model) {
    memcpy(model->matrix, BASE, sizeof BASE);
    for (int k = 0; k < N_SLOPES; k++)
        model->matrix[SLOPES[k].entry] += SLOPES[k].value * model->parameters[SLOPES[k].parameter];
}

static void reset_model(Model *model) {
    memset(model, 0, sizeof *model);
    memcpy(model->parameters, START, sizeof START);
    assemble(model);
}

static Model *create_model(void) {
    Model *model = malloc(sizeof *model);
    if (model) reset_model(model);
    return model;
}

/* Row of the matrix of a rate or output, else -1. */
static int find_row(unsigned reference) {
    if (reference >= FIRST_RATE && reference < FIRST_INPUT) return (int)reference - FIRST_RATE;
    if (reference >= FIRST_OUTPUT && reference < FIRST_PARAMETER)
        return N_STATES + (int)reference - FIRST_OUTPUT;
    return -1;
}

/* Column of the matrix of a state or input, else -1. */
static int find_column(unsigned reference) {
    if (reference >= FIRST_STATE && reference < FIRST_RATE) return (int)reference - FIRST_STATE;
    if (reference >= FIRST_INPUT && reference < FIRST_OUTPUT)
        return N_STATES + (int)reference - FIRST_INPUT;
    return -1;
}

static double multiply(const Model *model, int row) {
    double sum = 0.0;
    for (int k = 0; k < N_COLUMNS; k++) sum += model->matrix[row * N_COLUMNS + k] * model->given[k];
    return sum;
}

/* Each returns 1, or 0 for a value reference without such a value. */
static int get_value(const Model *model, unsigned reference, double *value) {
    int row = find_row(reference), column = find_column(reference);
    if (reference == 0) *value = model->time;
    else if (row >= 0) *value = multiply(model, row);
    else if (column >= 0) *value = model->given[column];
    else if (reference < N_VARIABLES) *value = model->parameters[reference - FIRST_PARAMETER];
    else return 0;
    return 1;
}

static int set_value(Model *model, unsigned reference, double value) {
    int column = find_column(reference);
    if (column >= 0) model->given[column] = value;
    else if (reference >= FIRST_PARAMETER && reference < N_VARIABLES) {
        model->parameters[reference - FIRST_PARAMETER] = value;
        assemble(model);
    } else return 0;
    return 1;
}

static int differentiate(const Model *model, const unsigned *unknowns, size_t n_unknowns,
                         const unsigned *knowns, size_t n_knowns, const double *seed,
                         double *sensitivity) {
    for (size_t i = 0; i < n_unknowns; i++) {
        int row = find_row(unknowns[i]);
        if (row < 0) return 0;
        sensitivity[i] = 0.0;
        for (size_t j = 0; j < n_knowns; j++) {
            int column = find_column(knowns[j]);
            if (column < 0) return 0;
            sensitivity[i] += model->matrix[row * N_COLUMNS + column] * seed[j];
        }
    }
    return 1;
}
