"""Flutter margin of the next test point with its confidence interval."""

from __future__ import annotations

import numpy as np

from flexsid.sysid.stability.flutter_prediction import FlutterPrediction
from flexsid.workflow.flutter.flutter_models import FlutterModels


def describe_margin(models: FlutterModels, next_speed: float) -> str:
    """Describe the margin of the next test point and its interval, or why there is none."""
    best = models.best.prediction
    at, crossing = f"Next point at {next_speed:.1f} m/s", best.crossing
    if best.refusal:
        return f"{at}: no margin, since no flutter speed can be predicted from these runs."
    if crossing is None:
        first, last = best.locus.airspeed[[0, -1]].tolist()
        if _is_unstable_at(best, first):
            return f"{at}: no margin, since the model is unstable already at {first:.1f} m/s."
        others = [g.prediction.crossing.airspeed for g in models.groups if g.prediction.crossing]
        if others:
            return (
                f"{at}: no margin, since another structure of the same runs becomes unstable"
                f" at {min(others):.1f} m/s."
            )
        if next_speed > last:
            return f"{at}: no margin, since the model was evaluated up to {last:.1f} m/s only."
        return f"{at}: no instability is predicted up to {last:.1f} m/s."
    margin = f"margin {crossing.airspeed / next_speed - 1.0:+.1%}"
    if best.interval is None:
        return f"{at}: {margin}, uncertainty unknown."
    low, high = (edge / next_speed - 1.0 for edge in best.interval)
    bounded = f"{margin}, between {low:+.1%} and {high:+.1%} with 95 % probability"
    if low > 0.0 and _is_unstable_at(best, next_speed):
        return (
            f"{at}: {bounded}; but a root that becomes unstable at a lower speed is unstable there."
        )
    if low > 0.0:
        return f"{at}: {bounded}."
    if high < 0.0:
        return f"{at} lies beyond flutter: {bounded}."
    return f"{at} may be beyond flutter: {bounded}. Fly a slower point first."


def is_safe(models: FlutterModels, next_speed: float) -> bool:
    """Return whether the model predicts no instability up to the next point, with 95 %."""
    best = models.best.prediction
    if best.refusal:
        return False
    if best.crossing is None:
        is_stable = not _is_unstable_at(best, best.locus.airspeed[0])
        alike = all(group.prediction.crossing is None for group in models.groups)
        return is_stable and alike and next_speed <= float(best.locus.airspeed[-1])
    bounded = best.interval is not None and best.interval[0] > next_speed
    return bounded and not _is_unstable_at(best, next_speed)


def _is_unstable_at(prediction: FlutterPrediction, speed: float) -> bool:
    locus = prediction.locus
    near = int(np.argmin(np.abs(locus.airspeed - speed)))
    return bool((np.real(locus.roots[near]) > 0.0).any())
