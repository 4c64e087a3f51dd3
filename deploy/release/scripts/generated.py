"""Use the client that was generated from the OpenAPI description."""

import os

from generated_client import Client
from generated_client.api.maneuvers import list_maneuvers
from generated_client.api.runs import list_runs

client = Client(os.environ["FLEXSID_URL"])
maneuvers = list_maneuvers.sync(client=client)
assert maneuvers is not None
assert len(maneuvers.items) > 10
assert maneuvers.items[0].label
runs = list_runs.sync(client=client)
assert runs is not None
