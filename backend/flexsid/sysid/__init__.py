"""The mathematics of flexsid: arrays and frozen values, free of web, database and plots.

The public names are those of ``__init__.pyi``, e.g. ``from flexsid.sysid import maximize``; a
module is loaded on first use of its name.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
