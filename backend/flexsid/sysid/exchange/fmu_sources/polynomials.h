/* Derivatives of an aircraft as polynomials of the flight condition, with standard errors.

   data.h defines N_INPUTS, N_TERMS, N_DERIVATIVES, N_FUELS, FUEL_INPUT (-1 without), TOKEN, CENTRE and
   SPAN of the conditions, START, POWERS of the monomials, COEFFICIENTS (by derivative and monomial),
   QUADRATIC (the variance by derivative and pair of monomials), and PREDICTED (by fuel and derivative),
   which is added by linear interpolation over FUELS. Value references: 0 time, then conditions,
   derivatives and their standard errors. */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "data.h"

#define N_STATES 0
#define FIRST_OUTPUT (1 + N_INPUTS)
#define FIRST_ERROR (FIRST_OUTPUT + N_DERIVATIVES)
#define N_VARIABLES (FIRST_ERROR + N_DERIVATIVES)

#if defined _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef struct {
    double time;
    double given[N_INPUTS];
} Model;

static void reset_model(Model *model) {
    model->time = 0.0;
    memcpy(model->given, START, sizeof START);
}

static Model *create_model(void) {
    Model *model = malloc(sizeof *model);
    if (model) reset_model(model);
    return model;
}

static void evaluate_monomials(const Model *model, double terms[N_TERMS]) {
    for (int k = 0; k < N_TERMS; k++) {
        terms[k] = 1.0;
        for (int v = 0; v < N_INPUTS; v++)
            for (int power = 0; power < POWERS[k * N_INPUTS + v]; power++)
                terms[k] *= (model->given[v] - CENTRE[v]) / SPAN[v];
    }
}

static double interpolate_prediction(const Model *model, int derivative) {
    double fuel = FUEL_INPUT < 0 ? 0.0 : model->given[FUEL_INPUT < 0 ? 0 : FUEL_INPUT];
    int k = 1;
    if (N_FUELS == 1 || fuel <= FUELS[0]) return PREDICTED[derivative];
    while (k < N_FUELS - 1 && FUELS[k] < fuel) k++;
    if (fuel >= FUELS[k]) return PREDICTED[k * N_DERIVATIVES + derivative];
    double share = (fuel - FUELS[k - 1]) / (FUELS[k] - FUELS[k - 1]);
    return (1.0 - share) * PREDICTED[(k - 1) * N_DERIVATIVES + derivative] +
           share * PREDICTED[k * N_DERIVATIVES + derivative];
}

static double evaluate(const Model *model, int derivative) {
    double terms[N_TERMS], sum = interpolate_prediction(model, derivative);
    evaluate_monomials(model, terms);
    for (int k = 0; k < N_TERMS; k++) sum += COEFFICIENTS[derivative * N_TERMS + k] * terms[k];
    return sum;
}

static double evaluate_error(const Model *model, int derivative) {
    double terms[N_TERMS], sum = 0.0;
    evaluate_monomials(model, terms);
    for (int i = 0; i < N_TERMS; i++)
        for (int j = 0; j < N_TERMS; j++)
            sum += QUADRATIC[(derivative * N_TERMS + i) * N_TERMS + j] * terms[i] * terms[j];
    return sqrt(sum);
}

/* Each returns 1, or 0 for a value reference without such a value. */
static int get_value(const Model *model, unsigned reference, double *value) {
    if (reference == 0) *value = model->time;
    else if (reference < FIRST_OUTPUT) *value = model->given[reference - 1];
    else if (reference < FIRST_ERROR) *value = evaluate(model, (int)reference - FIRST_OUTPUT);
    else if (reference < N_VARIABLES) *value = evaluate_error(model, (int)reference - FIRST_ERROR);
    else return 0;
    return 1;
}

static int set_value(Model *model, unsigned reference, double value) {
    if (reference == 0 || reference >= FIRST_OUTPUT) return 0;
    model->given[reference - 1] = value;
    return 1;
}

/* There are no states and no directional derivatives. */
static double multiply(const Model *model, int row) {
    (void)model, (void)row;
    return 0.0;
}

static int differentiate(const Model *model, const unsigned *unknowns, size_t n_unknowns,
                         const unsigned *knowns, size_t n_knowns, const double *seed,
                         double *sensitivity) {
    (void)model, (void)unknowns, (void)n_unknowns, (void)knowns, (void)n_knowns, (void)seed;
    (void)sensitivity;
    return 0;
}
