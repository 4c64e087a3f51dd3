/* FMI 2.0 for Model Exchange; types as in fmi2TypesPlatform.h and fmi2FunctionTypes.h. */
#include "model.h"

typedef unsigned Reference;
typedef int Boolean;
typedef enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING } Status;
typedef struct {
    Boolean new_discrete_states_needed, terminate_simulation, nominals_changed, states_changed;
    Boolean next_event_time_defined;
    double next_event_time;
} EventInfo;

#define CHECK(expression) return (expression) ? OK : ERROR

EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
EXPORT Status fmi2SetDebugLogging(void *m, Boolean on, size_t n, const char *const categories[]) {
    (void)m, (void)on, (void)n, (void)categories;
    return OK;
}
EXPORT void *fmi2Instantiate(const char *name, int type, const char *token, const char *resources,
                             const void *functions, Boolean visible, Boolean logging) {
    (void)name, (void)resources, (void)functions, (void)visible, (void)logging;
    return type == 0 && token && !strcmp(token, TOKEN) ? create_model() : NULL;
}
EXPORT void fmi2FreeInstance(void *m) { free(m); }
EXPORT Status fmi2SetupExperiment(void *m, Boolean has_tolerance, double tolerance, double start,
                                  Boolean has_stop, double stop) {
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    ((Model *)m)->time = start;
    return OK;
}
EXPORT Status fmi2EnterInitializationMode(void *m) { (void)m; return OK; }
EXPORT Status fmi2ExitInitializationMode(void *m) { (void)m; return OK; }
EXPORT Status fmi2Terminate(void *m) { (void)m; return OK; }
EXPORT Status fmi2Reset(void *m) { reset_model(m); return OK; }

EXPORT Status fmi2GetReal(void *m, const Reference r[], size_t n, double v[]) {
    int known = 1;
    for (size_t k = 0; k < n; k++) known &= get_value(m, r[k], &v[k]);
    CHECK(known);
}
EXPORT Status fmi2SetReal(void *m, const Reference r[], size_t n, const double v[]) {
    int known = 1;
    for (size_t k = 0; k < n; k++) known &= set_value(m, r[k], v[k]);
    CHECK(known);
}
/* There are no variables of other types. */
#define ABSENT(name, type)                                                                 \
    EXPORT Status fmi2Get##name(void *m, const Reference r[], size_t n, type v[]) {        \
        (void)m, (void)r, (void)v;                                                         \
        CHECK(n == 0);                                                                     \
    }                                                                                      \
    EXPORT Status fmi2Set##name(void *m, const Reference r[], size_t n, const type v[]) {  \
        (void)m, (void)r, (void)v;                                                         \
        CHECK(n == 0);                                                                     \
    }
typedef const char *String;
ABSENT(Integer, int)
ABSENT(Boolean, Boolean)
ABSENT(String, String)

EXPORT Status fmi2GetFMUstate(void *m, void **state) {
    if (!*state && !(*state = malloc(sizeof(Model)))) return ERROR;
    memcpy(*state, m, sizeof(Model));
    return OK;
}
EXPORT Status fmi2SetFMUstate(void *m, void *state) {
    memcpy(m, state, sizeof(Model));
    return OK;
}
EXPORT Status fmi2FreeFMUstate(void *m, void **state) {
    (void)m;
    free(*state);
    *state = NULL;
    return OK;
}
EXPORT Status fmi2SerializedFMUstateSize(void *m, void *state, size_t *size) {
    (void)m, (void)state;
    *size = sizeof(Model);
    return OK;
}
EXPORT Status fmi2SerializeFMUstate(void *m, void *state, char bytes[], size_t size) {
    (void)m;
    if (size < sizeof(Model)) return ERROR;
    memcpy(bytes, state, sizeof(Model));
    return OK;
}
EXPORT Status fmi2DeSerializeFMUstate(void *m, const char bytes[], size_t size, void **state) {
    (void)m;
    if (size != sizeof(Model) || (!*state && !(*state = malloc(sizeof(Model))))) return ERROR;
    memcpy(*state, bytes, sizeof(Model));
    return OK;
}
EXPORT Status fmi2GetDirectionalDerivative(void *m, const Reference unknowns[], size_t n_unknowns,
                                           const Reference knowns[], size_t n_knowns,
                                           const double seed[], double sensitivity[]) {
    CHECK(differentiate(m, unknowns, n_unknowns, knowns, n_knowns, seed, sensitivity));
}

EXPORT Status fmi2EnterEventMode(void *m) { (void)m; return OK; }
EXPORT Status fmi2NewDiscreteStates(void *m, EventInfo *info) {
    (void)m;
    memset(info, 0, sizeof *info);
    return OK;
}
EXPORT Status fmi2EnterContinuousTimeMode(void *m) { (void)m; return OK; }
EXPORT Status fmi2CompletedIntegratorStep(void *m, Boolean no_set, Boolean *event, Boolean *end) {
    (void)m, (void)no_set;
    *event = *end = 0;
    return OK;
}
EXPORT Status fmi2SetTime(void *m, double time) {
    ((Model *)m)->time = time;
    return OK;
}
EXPORT Status fmi2SetContinuousStates(void *m, const double x[], size_t n) {
    if (n != N_STATES) return ERROR;
    memcpy(((Model *)m)->given, x, n * sizeof *x);
    return OK;
}
EXPORT Status fmi2GetContinuousStates(void *m, double x[], size_t n) {
    if (n != N_STATES) return ERROR;
    memcpy(x, ((Model *)m)->given, n * sizeof *x);
    return OK;
}
EXPORT Status fmi2GetDerivatives(void *m, double rates[], size_t n) {
    if (n != N_STATES) return ERROR;
    for (size_t k = 0; k < n; k++) rates[k] = multiply(m, (int)k);
    return OK;
}
EXPORT Status fmi2GetEventIndicators(void *m, double indicators[], size_t n) {
    (void)m, (void)indicators;
    CHECK(n == 0);
}
EXPORT Status fmi2GetNominalsOfContinuousStates(void *m, double nominals[], size_t n) {
    (void)m;
    for (size_t k = 0; k < n; k++) nominals[k] = 1.0;
    CHECK(n == N_STATES);
}
