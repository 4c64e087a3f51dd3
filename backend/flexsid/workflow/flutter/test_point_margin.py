"""The question of flight test: what is the margin of the next point, and how sure is that?"""

from __future__ import annotations

import numpy as np

from flexsid.sysid.stability.prediction import FlutterPrediction
from flexsid.workflow.flutter.flutter_models import Answered


def margin_of(answer: Answered, following: float) -> str:
    """Margin of the next point, and how sure; what stands against it where there is none."""
    best = answer.best.prediction
    at, crossing = f"Next point at {following:.1f} m/s", best.crossing
    if best.refusal:
        return f"{at}: no margin, for no flutter speed can be predicted from these runs."
    if crossing is None:
        first, last = best.locus.airspeed[[0, -1]].tolist()
        if _grows_at(best, first):
            return f"{at}: no margin, for the model is unstable already at {first:.1f} m/s."
        others = [g.prediction.crossing.airspeed for g in answer.groups if g.prediction.crossing]
        if others:
            return (
                f"{at}: no margin is sure, for another structure of the same runs loses stability"
                f" at {min(others):.1f} m/s."
            )
        if following > last:
            return f"{at}: no margin, for the model was looked at up to {last:.1f} m/s only."
        return f"{at}: no instability is in sight up to {last:.1f} m/s."
    margin = f"margin {crossing.airspeed / following - 1.0:+.1%}"
    if best.interval is None:
        return f"{at}: {margin}, how sure is not known."
    low, high = (edge / following - 1.0 for edge in best.interval)
    sure = f"{margin}, between {low:+.1%} and {high:+.1%} with 95 % probability"
    if low > 0.0 and _grows_at(best, following):
        return f"{at}: {sure}; but a root that grows from lower speeds on is unstable there."
    if low > 0.0:
        return f"{at}: {sure}."
    if high < 0.0:
        return f"{at} lies beyond flutter: {sure}."
    return f"{at} may be beyond flutter: {sure}. Fly a slower one first."


def is_safe(answer: Answered, following: float) -> bool:
    """Whether nothing that is known stands against flying the next point."""
    best = answer.best.prediction
    if best.refusal:
        return False
    if best.crossing is None:
        calm = not _grows_at(best, best.locus.airspeed[0])
        alike = all(group.prediction.crossing is None for group in answer.groups)
        return calm and alike and following <= float(best.locus.airspeed[-1])
    sure = best.interval is not None and best.interval[0] > following
    return sure and not _grows_at(best, following)


def _grows_at(prediction: FlutterPrediction, speed: float) -> bool:
    locus = prediction.locus
    near = int(np.argmin(np.abs(locus.airspeed - speed)))
    return bool((np.real(locus.roots[near]) > 0.0).any())
