"""Use the installed extension template in the process, and find it on the server."""

import json
import os
import urllib.request

from flexsid.importers.formats.readers import load_formats
from flexsid.sysid.model.sensor_models import find_sensor_model

assert find_sensor_model("pitch-acceleration") is not None
assert ".raw" in load_formats()
with urllib.request.urlopen(f"{os.environ['FLEXSID_URL']}/api/v1/live/receivers") as response:
    receivers = json.load(response)
assert "noise" in json.dumps(receivers), receivers
