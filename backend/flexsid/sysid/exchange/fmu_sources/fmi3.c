/* FMI 3.0 for Model Exchange; types as in fmi3PlatformTypes.h and fmi3FunctionTypes.h. */
#include <stdbool.h>
#include <stdint.h>

#include "model.h"

typedef uint32_t Reference;
typedef enum { OK, WARNING, DISCARD, ERROR, FATAL } Status;

#define CHECK(expression) return (expression) ? OK : ERROR

EXPORT const char *fmi3GetVersion(void) { return "3.0"; }
EXPORT Status fmi3SetDebugLogging(void *m, bool on, size_t n, const char *const categories[]) {
    (void)m, (void)on, (void)n, (void)categories;
    return OK;
}
EXPORT void *fmi3InstantiateModelExchange(const char *name, const char *token,
                                          const char *resources, bool visible, bool logging,
                                          void *environment, void *log) {
    (void)name, (void)resources, (void)visible, (void)logging, (void)environment, (void)log;
    return token && !strcmp(token, TOKEN) ? create_model() : NULL;
}
EXPORT void *fmi3InstantiateCoSimulation(void) { return NULL; }
EXPORT void *fmi3InstantiateScheduledExecution(void) { return NULL; }
EXPORT void fmi3FreeInstance(void *m) { free(m); }
EXPORT Status fmi3EnterInitializationMode(void *m, bool has_tolerance, double tolerance,
                                          double start, bool has_stop, double stop) {
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    ((Model *)m)->time = start;
    return OK;
}
EXPORT Status fmi3ExitInitializationMode(void *m) { (void)m; return OK; }
EXPORT Status fmi3EnterConfigurationMode(void *m) { (void)m; return OK; }
EXPORT Status fmi3ExitConfigurationMode(void *m) { (void)m; return OK; }
EXPORT Status fmi3EnterEventMode(void *m) { (void)m; return OK; }
EXPORT Status fmi3EnterContinuousTimeMode(void *m) { (void)m; return OK; }
EXPORT Status fmi3EnterStepMode(void *m) { (void)m; return ERROR; }
EXPORT Status fmi3Terminate(void *m) { (void)m; return OK; }
EXPORT Status fmi3Reset(void *m) { reset_model(m); return OK; }

EXPORT Status fmi3GetFloat64(void *m, const Reference r[], size_t n, double v[], size_t n_v) {
    int known = n == n_v;
    for (size_t k = 0; known && k < n; k++) known = get_value(m, r[k], &v[k]);
    CHECK(known);
}
EXPORT Status fmi3SetFloat64(void *m, const Reference r[], size_t n, const double v[], size_t n_v) {
    int known = n == n_v;
    for (size_t k = 0; known && k < n; k++) known = set_value(m, r[k], v[k]);
    CHECK(known);
}
/* There are no variables of other types. */
#define ABSENT(name, type)                                                                      \
    EXPORT Status fmi3Get##name(void *m, const Reference r[], size_t n, type v[], size_t n_v) { \
        (void)m, (void)r, (void)v, (void)n_v;                                                   \
        CHECK(n == 0);                                                                          \
    }                                                                                           \
    EXPORT Status fmi3Set##name(void *m, const Reference r[], size_t n, const type v[],         \
                                size_t n_v) {                                                   \
        (void)m, (void)r, (void)v, (void)n_v;                                                   \
        CHECK(n == 0);                                                                          \
    }
typedef const char *String;
ABSENT(Float32, float)
ABSENT(Int8, int8_t)
ABSENT(UInt8, uint8_t)
ABSENT(Int16, int16_t)
ABSENT(UInt16, uint16_t)
ABSENT(Int32, int32_t)
ABSENT(UInt32, uint32_t)
ABSENT(Int64, int64_t)
ABSENT(UInt64, uint64_t)
ABSENT(Boolean, bool)
ABSENT(String, String)
/* Functions of features that the model does not have. */
#define UNSUPPORTED(name) \
    EXPORT Status fmi3##name(void) { return ERROR; }
UNSUPPORTED(GetBinary)
UNSUPPORTED(SetBinary)
UNSUPPORTED(GetClock)
UNSUPPORTED(SetClock)
UNSUPPORTED(GetIntervalDecimal)
UNSUPPORTED(GetIntervalFraction)
UNSUPPORTED(GetShiftDecimal)
UNSUPPORTED(GetShiftFraction)
UNSUPPORTED(SetIntervalDecimal)
UNSUPPORTED(SetIntervalFraction)
UNSUPPORTED(SetShiftDecimal)
UNSUPPORTED(SetShiftFraction)
UNSUPPORTED(GetNumberOfVariableDependencies)
UNSUPPORTED(GetVariableDependencies)
UNSUPPORTED(GetAdjointDerivative)
UNSUPPORTED(GetOutputDerivatives)
UNSUPPORTED(DoStep)
UNSUPPORTED(ActivateModelPartition)

EXPORT Status fmi3EvaluateDiscreteStates(void *m) { (void)m; return OK; }
EXPORT Status fmi3GetFMUState(void *m, void **state) {
    if (!*state && !(*state = malloc(sizeof(Model)))) return ERROR;
    memcpy(*state, m, sizeof(Model));
    return OK;
}
EXPORT Status fmi3SetFMUState(void *m, void *state) {
    memcpy(m, state, sizeof(Model));
    return OK;
}
EXPORT Status fmi3FreeFMUState(void *m, void **state) {
    (void)m;
    free(*state);
    *state = NULL;
    return OK;
}
EXPORT Status fmi3SerializedFMUStateSize(void *m, void *state, size_t *size) {
    (void)m, (void)state;
    *size = sizeof(Model);
    return OK;
}
EXPORT Status fmi3SerializeFMUState(void *m, void *state, uint8_t bytes[], size_t size) {
    (void)m;
    if (size < sizeof(Model)) return ERROR;
    memcpy(bytes, state, sizeof(Model));
    return OK;
}
EXPORT Status fmi3DeserializeFMUState(void *m, const uint8_t bytes[], size_t size, void **state) {
    (void)m;
    if (size != sizeof(Model) || (!*state && !(*state = malloc(sizeof(Model))))) return ERROR;
    memcpy(*state, bytes, sizeof(Model));
    return OK;
}
EXPORT Status fmi3GetDirectionalDerivative(void *m, const Reference unknowns[], size_t n_unknowns,
                                           const Reference knowns[], size_t n_knowns,
                                           const double seed[], size_t n_seed,
                                           double sensitivity[], size_t n_sensitivity) {
    CHECK(n_seed == n_knowns && n_sensitivity == n_unknowns &&
          differentiate(m, unknowns, n_unknowns, knowns, n_knowns, seed, sensitivity));
}
EXPORT Status fmi3UpdateDiscreteStates(void *m, bool *update, bool *terminate, bool *nominals,
                                       bool *states, bool *has_event, double *event) {
    (void)m;
    *update = *terminate = *nominals = *states = *has_event = false;
    *event = 0.0;
    return OK;
}
EXPORT Status fmi3CompletedIntegratorStep(void *m, bool no_set, bool *event, bool *terminate) {
    (void)m, (void)no_set;
    *event = *terminate = false;
    return OK;
}
EXPORT Status fmi3SetTime(void *m, double time) {
    ((Model *)m)->time = time;
    return OK;
}
EXPORT Status fmi3SetContinuousStates(void *m, const double x[], size_t n) {
    if (n != N_STATES) return ERROR;
    memcpy(((Model *)m)->given, x, n * sizeof *x);
    return OK;
}
EXPORT Status fmi3GetContinuousStates(void *m, double x[], size_t n) {
    if (n != N_STATES) return ERROR;
    memcpy(x, ((Model *)m)->given, n * sizeof *x);
    return OK;
}
EXPORT Status fmi3GetContinuousStateDerivatives(void *m, double rates[], size_t n) {
    if (n != N_STATES) return ERROR;
    for (size_t k = 0; k < n; k++) rates[k] = multiply(m, (int)k);
    return OK;
}
EXPORT Status fmi3GetEventIndicators(void *m, double indicators[], size_t n) {
    (void)m, (void)indicators;
    CHECK(n == 0);
}
EXPORT Status fmi3GetNominalsOfContinuousStates(void *m, double nominals[], size_t n) {
    (void)m;
    for (size_t k = 0; k < n; k++) nominals[k] = 1.0;
    CHECK(n == N_STATES);
}
EXPORT Status fmi3GetNumberOfEventIndicators(void *m, size_t *n) {
    (void)m;
    *n = 0;
    return OK;
}
EXPORT Status fmi3GetNumberOfContinuousStates(void *m, size_t *n) {
    (void)m;
    *n = N_STATES;
    return OK;
}
