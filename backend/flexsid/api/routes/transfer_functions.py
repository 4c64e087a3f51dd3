"""Transfer functions of one input and output of a maneuver."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends

from flexsid.api.context import TheStore
from flexsid.api.parameters import query_as
from flexsid.api.router import make_router
from flexsid.api.serialization import Json
from flexsid.api.submission import add_job_routes
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import TRANSFER_FUNCTION
from flexsid.records.transfer_function import TransferFunction
from flexsid.workflow.measurements.transfer_functions import TransferFunctionQuery

router = make_router(tag="maneuvers")


TheQuery = Annotated[TransferFunctionQuery, Depends(query_as(TransferFunctionQuery))]

add_job_routes(
    *(router, "/transfer-functions", TRANSFER_FUNCTION, "transfer_function"),
    lambda store, query: (
        f"{query.output} over {query.input}, {store.maneuvers.get(query.maneuver_id).label}"
    ),
)


@router.get("/transfer-functions", response_model=TransferFunction)
def get_transfer_function(store: TheStore, query: TheQuery) -> Json:
    """Return the stored transfer function of an output over an input, with standard errors.

    By default the orders are those usual for the output: a short period for pitch rate and pitch
    angle, a roll mode for roll rate and bank angle.
    """
    return Json(get_result(store, TRANSFER_FUNCTION, query).function)
