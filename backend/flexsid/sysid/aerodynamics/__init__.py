"""Linear unsteady aerodynamics of lifting surfaces in subsonic flow.

From planform to flutter: trapezia are divided into boxes (``boxes``), of which a vortex lattice
(``vortex_lattice``) and a doublet lattice (``doublet_lattice``) give the influence matrix of half
the aircraft (``influence``). Mode shapes are interpolated to the boxes (``splines``); normal
washes of every motion and surface (``normal_washes``) give coefficients as functions of reduced
frequency (``coefficients``), and these flutter by the p-k method (``pk_flutter``).

Conventions, here and nowhere else: axes X aft, Y right, Z up; time factor exp(+i omega t); any
consistent units; k = omega cbar/2V, while the lattices take omega/V.
"""
