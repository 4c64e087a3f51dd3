"""Import every public name of the library and the client."""

import flexsid.client
import flexsid.sysid

for module in (flexsid.sysid, flexsid.client):
    # pyrefly: ignore[missing-attribute]
    for name in module.__all__:
        assert getattr(module, name) is not None, name
