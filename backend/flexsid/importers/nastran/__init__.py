"""Nastran: modal data and geometry of its files, one reader per kind of file.

Every reader returns the same raw fields, in the units and frames of the file; ``frames``
transforms them to basic coordinates once all files of an import are read, as a deck may define
in one file the coordinate systems that another uses.

    grid/id cp cd (K,), grid/xyz (K, 3)            nodes, in the frames ``cp`` and ``cd``
    frame/id kind reference (C,), frame/points (C, 9)   CORD2R, CORD2C, CORD2S
    frame/by_grid (C, 5)                           CORD1R, CORD1C, CORD1S: id, kind, 3 nodes
    mode/number radians mass (n,)                  real eigenvalues
    shape/number (n,), shape/node (K,), shape/values (n, K, 6)   in the frames ``cd``
"""
